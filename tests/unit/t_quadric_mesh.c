/* Frames and quadrics in one go: the same bits as one after the other. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "quadric.h"
#include "test_quadric.h"

/*
 * A torus of SIDE times SIDE quadrangles.
 *   split    each UV has a position of its own, to be welded
 *   vectors  normals, and tangents, of the file: the exact ones, some missing
 *   rough    a position that nothing uses, two triangles that are one, one that
 *            welding collapses, one whose UVs have no area, one without UVs
 *   far      each split position moved by up to 1e-7
 */
struct shape {
	bool split, vectors, rough, far;
	unsigned order;
};

enum { SIDE = 12, UVS = (SIDE + 1) * (SIDE + 1) };

static void
set_corner(struct bake_corner *c, const struct shape *s, int x, int y)
{
	int uv = y * (SIDE + 1) + x;
	int v = s->split ? uv : y % SIDE * SIDE + x % SIDE;

	*c = (struct bake_corner){ v, uv, s->vectors ? uv : -1 };
}

static void
set_point(struct bake_mesh *m, const struct shape *s, int x, int y)
{
	struct bake_corner c;
	struct bake_frame f;
	double *p;

	set_corner(&c, s, x, y);
	p = m->positions[c.v];
	m->uvs[c.vt][0] = (double)x / SIDE;
	m->uvs[c.vt][1] = (double)y / SIDE;
	test_torus_point(p, 2 * test_pi * (x % SIDE) / SIDE,
	    2 * test_pi * (y % SIDE) / SIDE);
	if (s->vectors) {
		test_frame(&f, &test_surfaces[2], p, 0);
		memcpy(m->normals[c.vn], f.normal, sizeof f.normal);
		memcpy(m->tangents[c.vn], f.tangent, sizeof f.tangent);
		m->tangents[c.vn][3] = f.hand;
	}
	p[0] += s->far ? 2e-8 * (c.v % 5) : 0;
}

static void
roughen(struct bake_mesh *m, const struct shape *s)
{
	struct bake_corner(*t)[3] = m->triangles;
	size_t n = m->ntriangles;

	memcpy(t[n - 1], t[5], sizeof *t);
	memcpy(t[n - 2], t[9], sizeof *t);
	/* the seam's two positions of one point */
	set_corner(&t[n - 2][0], s, 0, 3);
	set_corner(&t[n - 2][1], s, SIDE, 3);
	t[20][1].vt = t[20][0].vt;
	for (int k = 0; k < 3; k++)
		t[30][k].vt = -1;
	t[40][1].vt = -1;
	if (s->vectors) {
		memset(m->normals[17], 0, sizeof *m->normals);
		memset(m->tangents[29], 0, sizeof *m->tangents);
		t[50][2].vn = -1;
		/* another than its neighbours have */
		t[61][0].vn = t[70][0].vn;
	}
}

static void
swap_triangles(struct bake_mesh *m, unsigned state)
{
	for (size_t i = m->ntriangles - 1; i > 0; i--) {
		size_t k = (size_t)(test_random(&state) * (double)(i + 1));
		struct bake_corner t[3];

		memcpy(t, m->triangles[i], sizeof t);
		memcpy(m->triangles[i], m->triangles[k], sizeof t);
		memcpy(m->triangles[k], t, sizeof t);
	}
}

static struct bake_mesh
make_torus(const struct shape *s)
{
	size_t npositions = s->split ? UVS : (size_t)SIDE * SIDE;
	size_t n = (size_t)2 * SIDE * SIDE;
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_mesh_alloc(&m, npositions + s->rough, UVS,
		     s->vectors ? UVS : 0, n + (s->rough ? 2 : 0), &err),
	    err);
	if (s->vectors)
		m.tangents = test_calloc(UVS, sizeof *m.tangents);
	for (int y = SIDE; y >= 0; y--)
		for (int x = SIDE; x >= 0; x--)
			set_point(&m, s, x, y);
	for (size_t q = 0; q < n / 2; q++) {
		int x = (int)(q % SIDE), y = (int)(q / SIDE);
		struct bake_corner c[4];

		set_corner(&c[0], s, x, y);
		set_corner(&c[1], s, x + 1, y);
		set_corner(&c[2], s, x + 1, y + 1);
		set_corner(&c[3], s, x, y + 1);
		memcpy(m.triangles[2 * q], c, sizeof *m.triangles);
		m.triangles[2 * q + 1][0] = c[2];
		m.triangles[2 * q + 1][1] = c[3];
		m.triangles[2 * q + 1][2] = c[0];
	}
	if (s->rough) {
		memset(m.positions[npositions], 0, sizeof *m.positions);
		roughen(&m, s);
	}
	if (s->order != 0)
		swap_triangles(&m, s->order);
	return m;
}

static bool
same_frames(const struct bake_frames *a, const struct bake_frames *b)
{
	if (a->nframes != b->nframes || a->ntriangles != b->ntriangles ||
	    a->normal_none != b->normal_none ||
	    a->tangent_none != b->tangent_none ||
	    a->mirror_mixed != b->mirror_mixed ||
	    a->flat_uv_triangles != b->flat_uv_triangles)
		return false;
	/* neither struct has padding */
	return memcmp(a->frame, b->frame, a->nframes * sizeof *a->frame) == 0 &&
	       memcmp(a->frame_of, b->frame_of,
		   a->ntriangles * sizeof *a->frame_of) == 0;
}

/* One after the other, against all in one. */
static void
compare(const struct bake_mesh *m, double eps,
    const struct bake_frame_params *fp, const struct bake_quadric_params *p)
{
	struct bake_weld weld = BAKE_WELD_INIT;
	struct bake_frames want = BAKE_FRAMES_INIT, got = BAKE_FRAMES_INIT;
	struct bake_quadric *wanted = NULL, *gotten = NULL;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_mesh_weld(m, eps, &weld, &err), err);
	CHECK_OK(bake_mesh_frames(m, &weld, NULL, fp, &want, &err), err);
	wanted = test_calloc(want.nframes, sizeof *wanted);
	CHECK_OK(bake_quadric_fit(m, &weld, &want, p, wanted, &err), err);
	CHECK_OK(
	    bake_quadric_fit_mesh(m, eps, fp, p, &got, &gotten, &err), err);
	CHECK(same_frames(&want, &got));
	CHECK(gotten != NULL &&
	      memcmp(wanted, gotten, want.nframes * sizeof *wanted) == 0);
	free(wanted);
	free(gotten);
	bake_frames_free(&want);
	bake_frames_free(&got);
	bake_weld_free(&weld);
}

static void
one_go_is_one_after_the_other(void)
{
	struct bake_frame_params fp = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;

	for (unsigned i = 0; i < 32; i++) {
		struct shape s = { i & 1, i & 2, i & 4, false, i & 8 ? i : 0 };
		struct bake_mesh m = make_torus(&s);

		fp.tangents = i & 16 ? BAKE_TANGENTS_FILE : BAKE_TANGENTS_UV;
		p.creases = i & 16;
		p.order = i & 8 ? 3 : 2;
		p.nthreads = 1 + (int)(i % 3);
		compare(&m, 0, &fp, &p);
		bake_mesh_free(&m);
	}
}

static void
near_positions_are_welded(void)
{
	const struct bake_frame_params fp = BAKE_FRAME_PARAMS_DEFAULT;
	const struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;
	const struct shape s = { true, false, true, true, 3 };
	struct bake_frames f = BAKE_FRAMES_INIT;
	struct bake_quadric *q = NULL;
	struct bake_mesh m = make_torus(&s);
	struct bake_err err = BAKE_ERR_INIT;

	compare(&m, 1e-6, &fp, &p);
	/* and are not without: a seam is a boundary then */
	CHECK_OK(bake_quadric_fit_mesh(&m, 0, &fp, &p, &f, &q, &err), err);
	CHECK(q != NULL && q[0].flags & BAKE_QUADRIC_BOUNDARY);
	free(q);
	bake_frames_free(&f);
	bake_mesh_free(&m);
}

/* Signs of 0 do not tell positions apart, and no number of UVs at a point is
 * too large: a fan whose corners have each one of their own. */
static void
a_point_can_have_many_frames(void)
{
	enum { N = 300 };
	const struct bake_frame_params fp = BAKE_FRAME_PARAMS_DEFAULT;
	const struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_mesh_alloc(&m, N + 2, 3 * N, 0, N, &err), err);
	for (int i = 0; i < N + 2; i++) {
		double a = 2 * test_pi * i / N;

		m.positions[i][0] = i < N ? cos(a) : i == N ? 0.0 : -0.0;
		m.positions[i][1] = i < N ? sin(a) : 0.0;
		m.positions[i][2] = i < N ? 0.1 * sin(3 * a) : 0.0;
	}
	for (int t = 0; t < N; t++)
		for (int k = 0; k < 3; k++) {
			int v = k == 0 ? N + t % 2 : (t + k - 1) % N;

			m.triangles[t][k] =
			    (struct bake_corner){ v, 3 * t + k, -1 };
			m.uvs[3 * t + k][0] = k == 1 ? 1 + 0.01 * t : 0;
			m.uvs[3 * t + k][1] = k == 2;
		}
	compare(&m, 0, &fp, &p);
	bake_mesh_free(&m);
}

/* Small meshes get one thread, whatever is asked for: this one does not. */
static void
threads_change_nothing(void)
{
	struct bake_frame_params fp = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_frames f[3] = { BAKE_FRAMES_INIT };
	struct bake_quadric *q[3] = { NULL };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_mesh m;

	test_patch(&m, &test_surfaces[2], 90, 0.25);
	fp.tangents = BAKE_TANGENTS_AUTO;
	for (int i = 0; i < 3; i++) {
		fp.nthreads = p.nthreads = 1 + 2 * i;
		CHECK_OK(
		    bake_quadric_fit_mesh(&m, 0, &fp, &p, &f[i], &q[i], &err),
		    err);
		CHECK(same_frames(&f[0], &f[i]));
		CHECK(memcmp(q[0], q[i], f[0].nframes * sizeof *q[0]) == 0);
		compare(&m, 0, &fp, &p);
	}
	for (int i = 0; i < 3; i++) {
		bake_frames_free(&f[i]);
		free(q[i]);
	}
	test_mesh_free(&m);
}

static void
errors_leave_nothing(void)
{
	const struct bake_frame_params fp = BAKE_FRAME_PARAMS_DEFAULT;
	const struct shape s = { false, false, false, false, 0 };
	struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_frames f = BAKE_FRAMES_INIT;
	struct bake_quadric *q = NULL;
	struct bake_mesh m = make_torus(&s);
	struct bake_err err[5];

	memset(err, 0, sizeof err);
	CHECK(bake_quadric_fit_mesh(&m, -1, &fp, &p, &f, &q, &err[0]) ==
	      BAKE_EINVAL);
	p.order = 4;
	CHECK(bake_quadric_fit_mesh(&m, 0, &fp, &p, &f, &q, &err[1]) ==
	      BAKE_EINVAL);
	p.order = 2;
	m.positions[7][1] = NAN;
	CHECK(bake_quadric_fit_mesh(&m, 0, &fp, &p, &f, &q, &err[2]) ==
	      BAKE_EDATA);
	m.nuvs = 0;
	CHECK(bake_quadric_fit_mesh(&m, 0, &fp, &p, &f, &q, &err[3]) ==
	      BAKE_EDATA);
	m.ntriangles = 0;
	CHECK(bake_quadric_fit_mesh(&m, 0, &fp, &p, &f, &q, &err[4]) ==
	      BAKE_EDATA);
	for (int i = 0; i < 5; i++)
		CHECK(err[i].msg[0] != '\0');
	CHECK(q == NULL && f.frame == NULL && f.frame_of == NULL &&
	      f.nframes == 0);
	bake_mesh_free(&m);
}

static const struct check_case cases[] = {
	CASE(one_go_is_one_after_the_other),
	CASE(near_positions_are_welded),
	CASE(a_point_can_have_many_frames),
	CASE(threads_change_nothing),
	CASE(errors_leave_nothing),
};

int
main(int argc, char **argv)
{
	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
