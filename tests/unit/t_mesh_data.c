/* Real meshes have the counts that their description states. */
/* SPDX-License-Identifier: MIT */
#include <unistd.h>

#include "mesh_frame.h"
#include "test_mesh.h"

/* Of the shared test data: positions, triangles, whether it has UVs on all
 * triangles; boundary and nonmanifold edges, directed edges used twice,
 * components, Euler's characteristic, degenerate faces. */
struct known {
	const char *name;
	size_t npositions, ntriangles;
	bool uvs;
	size_t boundary, nonmanifold, flipped, components;
	long chi;
	size_t degenerate;
};

static const struct known good[] = {
	{ "boombox/boombox.glb", 3644, 6036, true, 194, 0, 0, 14, 18, 0 },
	{ "cube.obj", 8, 12, true, 0, 0, 0, 1, 2, 0 },
	{ "cylinder_open.obj", 576, 1024, true, 128, 0, 0, 1, 0, 0 },
	{ "cylinder_r1_h2.obj", 578, 1152, true, 0, 0, 0, 1, 2, 0 },
	{ "sphere_3holes.obj", 1986, 3292, true, 186, 0, 0, 1, -1, 0 },
	{ "sphere_r1_64x32.obj", 1986, 3968, true, 0, 0, 0, 1, 2, 0 },
	{ "spot.obj", 2930, 5856, true, 0, 0, 0, 1, 2, 0 },
	{ "stanford_bunny.obj", 35947, 69451, false, 223, 0, 0, 1, -3, 0 },
	{ "stanford_dragon_res3.ply", 22998, 47794, false, 0, 2094, 4188, 1,
	    1267, 0 },
	{ "suzanne.obj", 507, 968, false, 42, 1, 2, 1, 1, 0 },
	{ "torus_R1_r035.obj", 4608, 9216, true, 0, 0, 0, 1, 0, 0 },
	{ "torusknot_2_3.obj", 12800, 25600, true, 0, 0, 0, 1, 0, 0 },
	{ "utah_teapot_uv.obj", 12780, 25200, true, 360, 0, 0, 3, 0, 0 },
	{ "weave_6x6.obj", 13992, 27936, true, 0, 0, 0, 12, 24, 0 },
	{ "nasty/bowtie_vertex.obj", 7, 8, false, 0, 0, 0, 1, 3, 0 },
	{ "nasty/concave_ngon.obj", 8, 6, false, 8, 0, 0, 1, 1, 0 },
	/* 579 faces, of which 50 are none */
	{ "nasty/degenerate_triangles.obj", 267, 529, true, 2, 1, 1, 1, 2, 50 },
	{ "nasty/doubled_opposite_faces.obj", 266, 1056, true, 0, 792, 1584, 1,
	    530, 0 },
	{ "nasty/duplicate_faces.obj", 266, 618, true, 0, 162, 270, 1, 92, 0 },
	/* 8 triangles vanish in welding */
	{ "nasty/far_from_origin.obj", 266, 528, true, 0, 0, 0, 1, 2, 0 },
	{ "nasty/flipped_winding_half.obj", 266, 528, true, 0, 0, 696, 1, 2,
	    0 },
	{ "nasty/inside_out_sphere.obj", 266, 528, true, 0, 0, 0, 1, 2, 0 },
	{ "nasty/mesh name with sp\xc3\xa4"
	  "ces \xc3\xbc.obj",
	    266, 528, true, 0, 0, 0, 1, 2, 0 },
	{ "nasty/negative_indices_valid.obj", 3, 1, true, 3, 0, 0, 1, 1, 0 },
	{ "nasty/nonmanifold_edge.obj", 5, 3, false, 6, 1, 1, 1, 1, 0 },
	{ "nasty/partial_uv.obj", 266, 528, false, 0, 0, 0, 1, 2, 0 },
	{ "nasty/self_intersecting_spheres.obj", 532, 1056, true, 0, 0, 0, 2, 4,
	    0 },
	{ "nasty/tiny_scale.obj", 266, 528, true, 0, 0, 0, 1, 2, 0 },
	{ "nasty/uv_overlap_outside.obj", 266, 528, true, 0, 0, 0, 1, 2, 0 },
	{ "nasty/uv_zero_area.obj", 266, 528, true, 0, 0, 0, 1, 2, 0 },
};

static const struct {
	const char *name;
	enum bake_status status;
	const char *reason;
} bad[] = {
	{ "empty.obj", BAKE_EDATA, "is empty" },
	{ "huge_count.ply", BAKE_EDATA, "is truncated: 4000000000 elements" },
	{ "index_out_of_range.obj", BAKE_EDATA,
	    "line 6: index 0 is out of range" },
	{ "missing_buffer.gltf", BAKE_EIO, "nope.bin" },
	{ "nan_inf_vertices.obj", BAKE_EDATA,
	    "line 6: a coordinate is not finite" },
	{ "nan_inf_vertices.ply", BAKE_EDATA, "position 7 is not finite" },
	{ "no_faces.obj", BAKE_EDATA, "has no faces" },
	{ "truncated.glb", BAKE_EDATA, "is truncated" },
	{ "truncated.ply", BAKE_EDATA, "is truncated" },
};

/* The path of a shared mesh; NULL, and a line that says so, where it is not
 * there. */
static const char *
path_of(const char *folder, const char *name)
{
	static char path[1024];
	const char *data = getenv("RELIEF_DATA");

	snprintf(path, sizeof path, "%s/meshes/%s%s",
	    data != NULL ? data : "../shared/data", folder, name);
	if (access(path, R_OK) == 0)
		return path;
	printf("skip t_mesh_data: the shared mesh %s is not there\n", name);
	return NULL;
}

static void
check_known(const struct known *k, const struct bake_mesh *m)
{
	struct bake_weld w = BAKE_WELD_INIT;
	struct bake_topology t;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(is_valid(m) && m->npositions == k->npositions);
	CHECK(m->ntriangles == k->ntriangles);
	CHECK((m->dropped.missing_uvs == 0) == k->uvs);
	CHECK(m->dropped.degenerate_faces == k->degenerate);
	CHECK(m->dropped.rough_faces == 0 && m->dropped.bad_normals == 0);
	CHECK_OK(bake_mesh_weld(m, 0.0, &w, &err), err);
	CHECK_OK(bake_mesh_topology(m, &w, &t, &err), err);
	CHECK(t.boundary == k->boundary && t.nonmanifold == k->nonmanifold);
	CHECK(t.flipped == k->flipped && t.components == k->components);
	CHECK((long)(t.points - t.isolated + t.triangles) - (long)t.edges ==
	      k->chi);
	bake_weld_free(&w);
}

/* Frames of all of them are finite and of unit length. */
static void
check_frames(const struct bake_mesh *m)
{
	struct bake_weld w = BAKE_WELD_INIT;
	struct bake_frames f = BAKE_FRAMES_INIT;
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_err err = BAKE_ERR_INIT;
	size_t nbad = 0;

	p.tangents = BAKE_TANGENTS_AUTO;
	CHECK_OK(bake_mesh_weld(m, 0.0, &w, &err), err);
	CHECK_OK(bake_mesh_frames(m, &w, NULL, &p, &f, &err), err);
	for (size_t i = 0; i < f.nframes; i++) {
		double n2 = 0.0, t2 = 0.0, nt = 0.0;

		for (int k = 0; k < 3; k++) {
			n2 += f.frame[i].normal[k] * f.frame[i].normal[k];
			t2 += f.frame[i].tangent[k] * f.frame[i].tangent[k];
			nt += f.frame[i].normal[k] * f.frame[i].tangent[k];
			nbad += !isfinite(f.frame[i].ps[k]);
			nbad += !isfinite(f.frame[i].pt[k]);
		}
		nbad += !(fabs(n2 - 1.0) < 4e-15 && fabs(t2 - 1.0) < 4e-15 &&
			  fabs(nt) < 4e-15);
	}
	CHECK(nbad == 0);
	bake_frames_free(&f);
	bake_weld_free(&w);
}

static void
known_meshes_have_their_counts(void)
{
	const struct bake_mesh_params p = BAKE_MESH_PARAMS_DEFAULT;

	for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
		struct bake_mesh m = BAKE_MESH_INIT;
		struct bake_err err = BAKE_ERR_INIT;
		const char *path = path_of("", good[i].name);
		int before = check_nfailed_here;

		if (path == NULL)
			continue;
		CHECK_OK(bake_mesh_read(path, &p, &m, &err), err);
		check_known(&good[i], &m);
		check_frames(&m);
		if (check_nfailed_here != before)
			printf("this is %s\n", good[i].name);
		bake_mesh_free(&m);
	}
}

static void
broken_meshes_are_refused(void)
{
	const struct bake_mesh_params p = BAKE_MESH_PARAMS_DEFAULT;

	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct bake_mesh m = BAKE_MESH_INIT;
		struct bake_err err = BAKE_ERR_INIT;
		const char *path = path_of("nasty/", bad[i].name);

		if (path == NULL)
			continue;
		CHECK(bake_mesh_read(path, &p, &m, &err) == bad[i].status);
		CHECK(m.ntriangles == 0 && m.positions == NULL);
		CHECK(strstr(err.msg, bad[i].name) != NULL);
		if (strstr(err.msg, bad[i].reason) == NULL) {
			printf("'%s', expected '%s'\n", err.msg, bad[i].reason);
			CHECK(0);
		}
	}
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(known_meshes_have_their_counts),
		CASE(broken_meshes_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
