/* The A-buffer of real meshes: closed ones close at every texel. */
/* SPDX-License-Identifier: MIT */
#include <unistd.h>

#include "test_abuffer.h"

/*
 * Of the shared test data. CLOSED: every edge is used as often in the one
 * direction as in the other, so that no texel is open. REVERSED: and the
 * outside is inside, of some part. TORN: it is open at some texel from any
 * side.
 */
enum kind { CLOSED, REVERSED, TORN };
static const struct {
	const char *name;
	enum kind kind;
} meshes[] = {
	{ "cube.obj", CLOSED },
	{ "cylinder_r1_h2.obj", CLOSED },
	{ "sphere_3holes.obj", TORN },
	{ "sphere_r1_64x32.obj", CLOSED },
	{ "spot.obj", CLOSED },
	{ "stanford_bunny.obj", TORN },
	{ "torus_R1_r035.obj", CLOSED },
	{ "torusknot_2_3.obj", CLOSED },
	{ "utah_teapot_uv.obj", TORN },
	{ "weave_6x6.obj", CLOSED },
	{ "nasty/bowtie_vertex.obj", REVERSED },
	{ "nasty/doubled_opposite_faces.obj", CLOSED },
	{ "nasty/far_from_origin.obj", CLOSED },
	{ "nasty/flipped_winding_half.obj", TORN },
	{ "nasty/inside_out_sphere.obj", REVERSED },
	{ "nasty/self_intersecting_spheres.obj", CLOSED },
	{ "nasty/tiny_scale.obj", CLOSED },
};

static const char *
data_dir(void)
{
	const char *d = getenv("RELIEF_DATA");

	return d != NULL ? d : "../shared/data";
}

static void
check_mesh(
    const struct bake_mesh *m, enum kind kind, const char *path, int side)
{
	const struct bake_abuffer_params p = BAKE_ABUFFER_PARAMS_DEFAULT;

	for (int a = 0; a<6; a += side> 256 ? 4 : 1) {
		struct bake_view v = {
			.axis = (enum bake_axis)a, .width = side, .height = side
		};
		struct bake_err err = BAKE_ERR_INIT;
		struct layers l;

		CHECK_OK(bake_view_fit(&v, m, &err), err);
		l = layers_make(m, &v, &p, BAKE_BAND_ROWS);
		/* layers_make has looked at each texel's balance */
		if ((l.stats.open != 0) != (kind == TORN) ||
		    (kind != TORN &&
			(l.stats.inside_out != 0) != (kind == REVERSED)) ||
		    l.stats.crossings == 0) {
			printf("%s, %s, %d texels: %zu open, %zu inside out\n",
			    path, bake_axis_name(v.axis), side, l.stats.open,
			    l.stats.inside_out);
			CHECK(!"as it is known to be");
		}
		layers_free(&l);
	}
}

static void
real_meshes_close(void)
{
	const struct bake_mesh_params p = BAKE_MESH_PARAMS_DEFAULT;

	for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
		struct bake_mesh m = BAKE_MESH_INIT;
		struct bake_err err = BAKE_ERR_INIT;
		char path[4096];

		snprintf(path, sizeof path, "%s/meshes/%s", data_dir(),
		    meshes[i].name);
		if (access(path, R_OK) != 0) {
			printf("skip %s: it is not there\n", path);
			continue;
		}
		CHECK_OK(bake_mesh_read(path, &p, &m, &err), err);
		for (int side = 64; side <= 1024; side *= 4)
			check_mesh(&m, meshes[i].kind, path, side);
		bake_mesh_free(&m);
	}
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(real_meshes_close),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
