/* Frames: spheres, cubes, what files say, what is missing. */
/* SPDX-License-Identifier: MIT */
#include "test_frame.h"

/* A sphere by longitude and latitude, u eastwards, v northwards, the seam
 * with two UVs for one position, the poles with one for each triangle. */
static struct bake_mesh
sphere(int nu, int nv, double radius)
{
	struct blob b = { NULL, 0 };
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	int south = nu * (nv - 1) + 1, north = south + 1;

	for (int j = 1; j < nv; j++)
		for (int i = 0; i < nu; i++) {
			double a = 2.0 * pi * i / nu, t = pi * j / nv;

			blob_print(&b, "v %.17g %.17g %.17g\n",
			    radius * sin(t) * cos(a), radius * sin(t) * sin(a),
			    -radius * cos(t));
		}
	blob_print(&b, "v 0 0 %.17g\nv 0 0 %.17g\n", -radius, radius);
	for (int j = 0; j <= nv; j++)
		for (int i = 0; i <= nu; i++)
			blob_print(&b, "vt %.17g %.17g\n", (double)i / nu,
			    (double)j / nv);
	for (int j = 0; j < nv; j++)
		for (int i = 0; i < nu; i++) {
			int p00 = nu * (j - 1) + i + 1,
			    p10 = nu * (j - 1) + (i + 1) % nu + 1;
			int t00 = (nu + 1) * j + i + 1;

			if (j > 0)
				blob_print(&b, "f %d/%d %d/%d %d/%d\n", p00,
				    t00, p10, t00 + 1,
				    j + 1 < nv ? p10 + nu : north,
				    t00 + nu + 2);
			if (j + 1 < nv)
				blob_print(&b, "f %d/%d %d/%d %d/%d\n",
				    j > 0 ? p00 : south, t00, p10 + nu,
				    t00 + nu + 2, p00 + nu, t00 + nu + 1);
		}
	CHECK_OK(read_bytes(b.p, b.n, "sphere.obj", &m, &err), err);
	free(b.p);
	return m;
}

static void
angles_are_angles(void)
{
	/* sines and cosines are rounded to 1e-16, which is the angle's error
	 * where it is small */
	for (int i = 0; i <= 1000; i++) {
		double a = pi * i / 1000;
		const double u[3] = { 3.0, 0.0, 0.0 };
		const double v[3] = { 0.5 * cos(a), 0.5 * sin(a), 0.0 };

		CHECK_NEAR(bake_angle_rad(u, v), a, 8e-16);
	}
	CHECK(bake_angle_rad((const double[3]){ 0, 0, 0 },
		  (const double[3]){ 1, 0, 0 }) == 0.0);
	/* where acos and cross products fail */
	CHECK_NEAR(bake_angle_rad((const double[3]){ 1, 0, 0 },
		       (const double[3]){ 1, 1e-9, 0 }) /
		       1e-9,
	    1.0, 1e-7);
	CHECK_NEAR(bake_angle_rad((const double[3]){ 1e-200, 0, 0 },
		       (const double[3]){ 0, 1e200, 0 }),
	    pi / 2, 4e-16);
}

static void
frames_of_a_sphere(void)
{
	static const enum bake_normal_weight weights[] = { BAKE_WEIGHT_ANGLE,
		BAKE_WEIGHT_AREA, BAKE_WEIGHT_SPHERE };
	const double radius = 2.5;
	struct bake_mesh m = sphere(48, 24, radius);

	for (int w = 0; w < 3; w++) {
		struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
		struct bake_frames f;
		double worst_normal = 0.0, worst_tangent = 0.0;

		p.weight = weights[w];
		f = frames_of(&m, p);
		check_frames(&m, &f);
		CHECK(f.normal_none == 0 && f.tangent_none == 0);
		CHECK(f.mirror_mixed == 0 && f.flat_uv_triangles == 0);
		for (size_t i = 0; i < f.nframes; i++) {
			const struct bake_frame *a = &f.frame[i];
			const double *x = m.positions[a->v];
			double r = sqrt(x[0] * x[0] + x[1] * x[1]);
			double east[3] = { -x[1] / r, x[0] / r, 0.0 };

			worst_normal =
			    fmax(worst_normal, bake_angle_rad(a->normal, x));
			/* v grows to the north: right-handed */
			CHECK(a->hand == 1);
			if (r < 0.5)
				continue;
			worst_tangent = fmax(
			    worst_tangent, bake_angle_rad(a->tangent, east));
			/* |dP/ds| = 2 pi r, |dP/dt| = pi R. A step is
			 * h = 0.131: triangles lie up to half a step nearer to
			 * the pole, 0.075 R; chords are shorter by h^2 / 24,
			 * and their planes are tilted by up to h, whose cosine
			 * the mean keeps: 1 - h^2 / 2 */
			CHECK_NEAR(sqrt(dot(a->ps, a->ps)), 2.0 * pi * r,
			    2.0 * pi * radius * 0.075);
			CHECK_NEAR(sqrt(dot(a->pt, a->pt)), pi * radius,
			    pi * radius * 0.0094);
		}
		/* Max's weights are exact on a sphere: only rounding. Any mean
		 * is within the largest angle between a point and its
		 * triangles' normals, half a diagonal of 0.131 sqrt 2 */
		CHECK(worst_normal < (w == 2 ? 1e-14 : 0.093));
		CHECK(worst_tangent < 0.08);
		bake_frames_free(&f);
	}
	bake_mesh_free(&m);
}

/* A cube of 8 welded corners: angle weights give the diagonals exactly,
 * whichever way its faces are cut. */
static void
normals_of_a_cube_are_its_diagonals(void)
{
	for (int way = 0; way < 64; way++) {
		static const int quads[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 },
			{ 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 4, 6, 2 },
			{ 1, 3, 7, 5 } };
		struct blob b = { NULL, 0 };
		struct bake_mesh m = BAKE_MESH_INIT;
		struct bake_err err;
		struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
		struct bake_frames f;

		p.tangents = BAKE_TANGENTS_AUTO;
		for (int i = 0; i < 8; i++)
			blob_print(
			    &b, "v %d %d %d\n", i & 1, i >> 1 & 1, i >> 2);
		for (int q = 0; q < 6; q++) {
			const int *c = quads[q];
			int s = way >> q & 1;

			blob_print(&b, "f %d %d %d\nf %d %d %d\n", c[s] + 1,
			    c[s + 1] + 1, c[s + 2] + 1, c[s] + 1, c[s + 2] + 1,
			    c[(s + 3) % 4] + 1);
		}
		CHECK_OK(read_bytes(b.p, b.n, "cube.obj", &m, &err), err);
		f = frames_of(&m, p);
		check_frames(&m, &f);
		CHECK(f.nframes == 8 && f.tangent_none == 8);
		for (int i = 0; i < 8; i++)
			for (int k = 0; k < 3; k++)
				CHECK_NEAR(f.frame[i].normal[k],
				    (i >> k & 1 ? 1.0 : -1.0) / sqrt(3.0),
				    4e-16);
		bake_frames_free(&f);
		bake_mesh_free(&m);
		free(b.p);
	}
}

static void
a_linear_map_of_the_plane_is_found_exactly(void)
{
	/* P = 2 + 3 s (1, 0, 0) + t (1, 2, 0) over 4 triangles */
	const char text[] =
	    "v 2 2 0\nv 5 2 0\nv 3 4 0\nv 6 4 0\nv 4 3 0\n"
	    "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nvt 0.5 0.5\n"
	    "f 1/1 2/2 5/5\nf 2/2 4/4 5/5\nf 4/4 3/3 5/5\nf 3/3 1/1 5/5\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_frames f;

	for (int mirrored = 0; mirrored < 2; mirrored++) {
		CHECK_OK(read_text(text, "a.obj", &m, &err), err);
		for (size_t i = 0; i < m.nuvs && mirrored; i++)
			m.uvs[i][0] = 1.0 - m.uvs[i][0];
		f = frames_of(&m, p);
		check_frames(&m, &f);
		for (size_t i = 0; i < f.nframes; i++) {
			const struct bake_frame *a = &f.frame[i];
			double side = mirrored ? -1.0 : 1.0;

			CHECK(a->normal[2] == 1.0 && a->hand == (int)side);
			CHECK_NEAR(a->tangent[0], side, 1e-15);
			CHECK_NEAR(a->ps[0], 3.0 * side, 1e-14);
			CHECK_NEAR(a->ps[1], 0.0, 1e-14);
			CHECK_NEAR(a->pt[0], 1.0, 1e-14);
			CHECK_NEAR(a->pt[1], 2.0, 1e-14);
		}
		bake_frames_free(&f);
		bake_mesh_free(&m);
	}
}

static void
no_instruction_set_changes_a_bit(void)
{
	static const char *const isas[] = { "baseline", "avx2", "avx512" };
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;

	for (int w = BAKE_WEIGHT_ANGLE; w <= BAKE_WEIGHT_SPHERE; w++) {
		/* the poles have more corners than the kernel takes at once */
		struct bake_mesh m = sphere(150, 6, 2.5);
		struct bake_frames f[3];

		p.weight = (enum bake_normal_weight)w;
		for (int i = 0; i < 3; i++) {
			setenv("BAKE_ISA", isas[i], 1);
			f[i] = frames_of(&m, p);
			check_frames(&m, &f[i]);
			CHECK(f[i].nframes == f[0].nframes);
			CHECK(memcmp(f[i].frame, f[0].frame,
				  f[0].nframes * sizeof *f[0].frame) == 0);
		}
		unsetenv("BAKE_ISA");
		for (int i = 0; i < 3; i++)
			bake_frames_free(&f[i]);
		bake_mesh_free(&m);
	}
}

static void
the_files_vectors_are_kept(void)
{
	/* the first vertex has the same normal twice, the second two */
	const char text[] =
	    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
	    "vt 0 1\nvn 0.6 0 0.8\nvn 0 0 1\nvn 0 1 0\nvn 0 0 0\n"
	    "f 1/1/1 2/2/2 3/3/2\nf 1/1/1 3/3/3 4/4/4\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_frames f;
	double tangents[4][4] = { { 0.8, 0, -0.6, -1 }, { 0, 1, 0, 1 },
		{ 1, 0, 0, 1 }, { 0, 0, 0, 0 } };

	CHECK_OK(read_text(text, "a.obj", &m, &err), err);
	f = frames_of(&m, p);
	check_frames(&m, &f);
	CHECK(f.frame[0].normal[0] == m.normals[0][0]);
	CHECK(f.frame[0].normal[2] == m.normals[0][2]);
	CHECK(f.frame[0].flags == BAKE_FRAME_NORMAL_FILE);
	/* dP/ds = (1, 0, 0) made orthogonal to it: (0.8, 0, -0.6) */
	CHECK_NEAR(f.frame[0].tangent[0], 0.8, 1e-15);
	CHECK_NEAR(f.frame[0].tangent[2], -0.6, 1e-15);
	/* both triangles have 45 degrees at the third vertex */
	CHECK_NEAR(f.frame[2].normal[1], sqrt(0.5), 1e-15);
	CHECK_NEAR(f.frame[2].normal[2], sqrt(0.5), 1e-15);
	/* (0, 0, 0) is none: computed */
	CHECK(f.frame[3].normal[2] == 1.0 && f.frame[3].flags == 0);
	bake_frames_free(&f);

	m.tangents = malloc(sizeof tangents);
	if (m.tangents == NULL)
		abort();
	memcpy(m.tangents, tangents, sizeof tangents);
	p.tangents = BAKE_TANGENTS_FILE;
	f = frames_of(&m, p);
	check_frames(&m, &f);
	CHECK(f.frame[0].hand == -1 &&
	      f.frame[0].flags ==
		  (BAKE_FRAME_NORMAL_FILE | BAKE_FRAME_TANGENT_FILE));
	CHECK(f.frame[1].tangent[1] == 1.0 && f.frame[1].hand == 1);
	CHECK(!(f.frame[3].flags & BAKE_FRAME_TANGENT_FILE));
	CHECK_NEAR(f.frame[0].ps[0], 1.0, 1e-15);
	bake_frames_free(&f);

	p.normals = BAKE_NORMALS_COMPUTED;
	p.tangents = BAKE_TANGENTS_UV;
	f = frames_of(&m, p);
	for (int i = 0; i < 4; i++)
		CHECK(f.frame[i].normal[2] == 1.0 && f.frame[i].flags == 0);
	bake_frames_free(&f);
	bake_mesh_free(&m);
}

static void
seams_mirrors_and_holes_in_uvs(void)
{
	/* a strip of two quads, the UVs mirrored at the middle; the same UV
	 * under another number is the same; then a triangle without UVs, and
	 * one whose UVs have no area */
	const char text[] =
	    "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 0 2 0\n"
	    "v 2 2 0\nvt 0 0\nvt 1 0\nvt 0 0\nvt 0 1\nvt 1 1\nvt 0 1\n"
	    "vt 1 0\n"
	    "f 1/1 2/2 5/5\nf 1/1 5/5 4/4\nf 2/7 3/3 6/6\nf 2/7 6/6 5/5\n"
	    "f 4 5 7\nf 5/1 6/1 8/1\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_frames f;

	CHECK_OK(read_text(text, "a.obj", &m, &err), err);
	f = frames_of(&m, p);
	check_frames(&m, &f);
	for (size_t i = 0; i < f.nframes; i++) {
		const struct bake_frame *a = &f.frame[i];

		if (a->v == 0) {
			CHECK(a->hand == 1 && a->flags == 0);
		} else if (a->v == 1) {
			/* vt 2 and 7 are one UV, 90 degrees of either side:
			 * unmirrored wins */
			CHECK(a->flags == BAKE_FRAME_MIRROR_MIXED);
			CHECK(a->hand == 1);
			CHECK_NEAR(a->ps[0], 1.0, 1e-15);
		} else if (a->v == 2) {
			CHECK(a->hand == -1);
			CHECK_NEAR(a->tangent[0], -1.0, 1e-15);
		} else if (a->vt < 0 || a->vt == 0) {
			CHECK(a->flags == BAKE_FRAME_TANGENT_NONE);
			CHECK(a->hand == 1);
		}
	}
	CHECK(f.flat_uv_triangles == 1 && f.tangent_none == 6);
	CHECK(f.mirror_mixed == 3);
	bake_frames_free(&f);
	bake_mesh_free(&m);
}

static void
nothing_becomes_nan(void)
{
	/* flat triangles, huge and tiny ones, UVs without size */
	const char text[] =
	    "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 1e90 0 0\nv 0 1e90 0\nv 1e-90 0 0\n"
	    "v 0 1e-90 0\nv 0 0 1\nvt 0 0\nvt 1e200 0\nvt 0 1e200\n"
	    "vt 1e-300 0\nvt 0 1e-300\nf 1/1 2/2 3/3\nf 1/1 4/2 5/3\n"
	    "f 1/1 6/4 7/5\nf 1/4 2/4 8/4\nf 1/4 8/5 5/1\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;

	CHECK_OK(read_text(text, "a.obj", &m, &err), err);
	for (int w = BAKE_WEIGHT_ANGLE; w <= BAKE_WEIGHT_SPHERE; w++) {
		struct bake_frames f;

		p.weight = (enum bake_normal_weight)w;
		f = frames_of(&m, p);
		check_frames(&m, &f);
		CHECK(f.normal_none > 0 && f.tangent_none > 0);
		bake_frames_free(&f);
	}
	bake_mesh_free(&m);
}

static void
errors_say_what_is_missing(void)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_frames f = BAKE_FRAMES_INIT;
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_weld w = BAKE_WELD_INIT;

	CHECK(bake_mesh_frames(&m, NULL, NULL, &p, &f, &err) == BAKE_EDATA);
	CHECK_OK(read_text(
		     "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj", &m, &err),
	    err);
	CHECK(bake_mesh_frames(&m, NULL, NULL, &p, &f, &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "the mesh has no UVs") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	p.tangents = BAKE_TANGENTS_FILE;
	CHECK(bake_mesh_frames(&m, NULL, NULL, &p, &f, &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "the mesh has neither tangents nor UVs") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	p.tangents = BAKE_TANGENTS_AUTO;
	p.normals = BAKE_NORMALS_FILE;
	CHECK(bake_mesh_frames(&m, NULL, NULL, &p, &f, &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "the mesh has no normals of its own") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	p.normals = BAKE_NORMALS_AUTO;
	CHECK(bake_mesh_frames(&m, &w, NULL, &p, &f, &err) == BAKE_EINVAL);
	CHECK(f.frame == NULL && f.nframes == 0);
	bake_mesh_free(&m);
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(angles_are_angles),
		CASE(frames_of_a_sphere),
		CASE(normals_of_a_cube_are_its_diagonals),
		CASE(a_linear_map_of_the_plane_is_found_exactly),
		CASE(no_instruction_set_changes_a_bit),
		CASE(the_files_vectors_are_kept),
		CASE(seams_mirrors_and_holes_in_uvs),
		CASE(nothing_becomes_nan),
		CASE(errors_say_what_is_missing),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
