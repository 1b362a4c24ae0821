/* Quadric fits of hard meshes: an oracle, fallbacks, errors, statistics. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "quadric.h"
#include "test_quadric.h"

static enum bake_status
try_fit(const struct bake_mesh *m, const struct bake_frames *f,
    const struct bake_quadric_params *p, struct bake_quadric *q,
    struct bake_err *err)
{
	struct bake_err none = BAKE_ERR_INIT;

	*err = none;
	return bake_quadric_fit(m, NULL, f, p, q, err);
}

/* A mesh of these positions and triangles. */
static struct bake_mesh
make_mesh(size_t npositions, const double (*p)[3], size_t ntriangles,
    const int (*t)[3])
{
	struct bake_mesh m;

	memset(&m, 0, sizeof m);
	m.npositions = npositions;
	m.ntriangles = ntriangles;
	m.positions = test_calloc(npositions, sizeof *m.positions);
	m.triangles = test_calloc(ntriangles, sizeof *m.triangles);
	memcpy(m.positions, p, npositions * sizeof *p);
	for (size_t i = 0; i < ntriangles; i++)
		for (int k = 0; k < 3; k++)
			m.triangles[i][k] =
			    (struct bake_corner){ t[i][k], -1, -1 };
	return m;
}

/* A frame at every position, with this normal and any tangent. */
static struct bake_frames
make_frames(const struct bake_mesh *m, const double (*normal)[3])
{
	struct bake_frames f;

	memset(&f, 0, sizeof f);
	f.nframes = m->npositions;
	f.frame = test_calloc(f.nframes, sizeof *f.frame);
	for (size_t v = 0; v < f.nframes; v++) {
		struct bake_frame *w = &f.frame[v];
		double axis[3] = { 0, 0, 0 };

		w->v = (int)v;
		w->vt = -1;
		w->hand = 1;
		memcpy(w->normal, normal[v], sizeof w->normal);
		test_normalize(w->normal);
		axis[fabs(w->normal[0]) < 0.6 ? 0 : 1] = 1;
		test_cross(w->tangent, w->normal, axis);
		test_normalize(w->tangent);
		memcpy(w->ps, w->tangent, sizeof w->ps);
		test_cross(w->pt, w->normal, w->tangent);
	}
	return f;
}

static bool
is_finite(const struct bake_quadric *q)
{
	return isfinite(q->a + q->b + q->c + q->a_tex + q->b_tex + q->c_tex +
			q->uvscale[0] + q->uvscale[1] + q->residual);
}

/* -- an oracle ----------------------------------------------------------------
 */

/* The terms of the fit, in the order of the headers' list. */
static void
terms(double x, double y, int n, long double t[9])
{
	const long double all[9] = { (long double)x * x, (long double)y * y,
		(long double)x * y, x, y, (long double)x * x * x,
		(long double)x * x * y, (long double)x * y * y,
		(long double)y * y * y };

	memcpy(t, all, (size_t)n * sizeof *t);
}

/* Least squares of rows [m][n + 1], the right side last, by Householder
 * reflections in long double. */
static void
solve(long double *row, int m, int n, long double x[9])
{
	int w = n + 1;

	for (int k = 0; k < n; k++) {
		long double norm = 0, scale;

		for (int i = k; i < m; i++)
			norm += row[i * w + k] * row[i * w + k];
		norm = sqrtl(norm);
		if (row[k * w + k] > 0)
			norm = -norm;
		/* v = column - norm e_k; scale = 2 / v.v */
		row[k * w + k] -= norm;
		scale = -1 / (norm * row[k * w + k]);
		for (int j = k + 1; j < w; j++) {
			long double dot = 0;

			for (int i = k; i < m; i++)
				dot += row[i * w + k] * row[i * w + j];
			for (int i = k; i < m; i++)
				row[i * w + j] -= scale * dot * row[i * w + k];
		}
		row[k * w + k] = norm;
	}
	for (int k = n - 1; k >= 0; k--) {
		x[k] = row[k * w + n];
		for (int j = k + 1; j < n; j++)
			x[k] -= row[k * w + j] * x[j];
		x[k] /= row[k * w + k];
	}
}

/* The vertices within ring edges of v, found by looking at all triangles. */
static int
find_ring(const struct bake_mesh *m, int v, int ring, bool *in)
{
	int n = -1;

	memset(in, 0, m->npositions);
	in[v] = true;
	for (int r = 0; r < ring; r++) {
		bool *was = test_calloc(m->npositions, 1);

		memcpy(was, in, m->npositions);
		for (size_t t = 0; t < m->ntriangles; t++)
			for (int k = 0; k < 3; k++)
				for (int j = 0; j < 3; j++)
					in[m->triangles[t][j].v] |=
					    was[m->triangles[t][k].v];
		free(was);
	}
	for (size_t i = 0; i < m->npositions; i++)
		n += in[i];
	return n;
}

static void
check_against_oracle(const struct bake_mesh *m, const struct bake_frame *f,
    const struct bake_quadric *q)
{
	int n = q->rank, w = n + 1, m_rows = 0;
	bool *in = test_calloc(m->npositions, 1);
	int count = find_ring(m, f->v, q->ring, in);
	long double *row = test_calloc((size_t)count * (size_t)w, sizeof *row);
	long double c[9] = { 0 }, term[9] = { 0 }, a, b, g, d2, e2;
	double bitangent[3];

	CHECK(count == q->neighbours);
	test_cross(bitangent, f->normal, f->tangent);
	for (size_t i = 0; i < m->npositions; i++) {
		double d[3];

		if (!in[i] || (int)i == f->v)
			continue;
		for (int k = 0; k < 3; k++)
			d[k] = m->positions[i][k] - m->positions[f->v][k];
		terms(test_dot(d, f->tangent), test_dot(d, bitangent), n, term);
		memcpy(row + m_rows * w, term, (size_t)n * sizeof *row);
		row[m_rows++ * w + n] = -test_dot(d, f->normal);
	}
	solve(row, m_rows, n, c);
	d2 = n > 2 ? c[3] * c[3] : 0;
	e2 = n > 2 ? c[4] * c[4] : 0;
	g = 1 / sqrtl(1 + d2 + e2);
	a = c[0] * g / (1 + d2);
	b = c[1] * g / (1 + e2);
	/* double normal equations against long double reflections: figures of
	 * 1 to 10, pivots down to 1e-3 or so */
	CHECK_NEAR(q->a, (double)a, 1e-10);
	CHECK_NEAR(q->b, (double)b, 1e-10);
	if (n > 2)
		CHECK_NEAR(q->c,
		    (double)(c[2] * g / sqrtl((1 + d2) * (1 + e2))), 1e-10);
	free(row);
	free(in);
}

static void
an_oracle_agrees(void)
{
	static const struct {
		enum bake_quadric_model model;
		int order, ring;
	} kinds[] = { { BAKE_QUADRIC_FULL, 2, 0 }, { BAKE_QUADRIC_FULL, 3, 0 },
		{ BAKE_QUADRIC_AB, 2, 0 }, { BAKE_QUADRIC_FULL, 2, 4 },
		{ BAKE_QUADRIC_AB, 2, 2 } };

	for (int i = 0; i < 5; i++)
		for (int s = 0; s < 5; s++) {
			struct bake_quadric_params p =
			    BAKE_QUADRIC_PARAMS_DEFAULT;
			struct bake_err err = BAKE_ERR_INIT;
			struct bake_mesh m;
			struct bake_frames f;
			struct bake_quadric *q;

			p.model = kinds[i].model;
			p.order = kinds[i].order;
			p.ring = kinds[i].ring;
			test_patch(&m, &test_surfaces[s], 9, 0.3);
			test_frames(&f, &m, &test_surfaces[s], 0.7);
			q = test_calloc(f.nframes, sizeof *q);
			CHECK_OK(try_fit(&m, &f, &p, q, &err), err);
			for (size_t v = 0; v < f.nframes; v++)
				check_against_oracle(&m, &f.frame[v], &q[v]);
			free(q);
			free(f.frame);
			test_mesh_free(&m);
		}
}

/* -- fallbacks ----------------------------------------------------------------
 */

/* A pyramid: four neighbours of the top, all at one distance and depth. */
static void
few_neighbours_make_a_ball(void)
{
	static const double p[5][3] = { { 0, 0, 1 }, { 2, 0, 0 }, { 0, 2, 0 },
		{ -2, 0, 0 }, { 0, -2, 0 } };
	static const int t[4][3] = { { 0, 1, 2 }, { 0, 2, 3 }, { 0, 3, 4 },
		{ 0, 4, 1 } };
	struct bake_mesh m = make_mesh(5, p, 4, t);
	struct bake_frames f = make_frames(&m, p);
	struct bake_quadric_params params = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_quadric q[5];
	struct bake_err err;

	for (int order = 2; order <= 3; order++) {
		params.order = order;
		CHECK_OK(try_fit(&m, &f, &params, q, &err), err);
		/* sum z r^2 / sum r^4 = 1 * 4 / 16 */
		CHECK(q[0].rank == 1);
		CHECK_NEAR(q[0].a, 0.25, 1e-15);
		CHECK_NEAR(q[0].b, 0.25, 1e-15);
		CHECK(q[0].c == 0);
		CHECK(q[0].residual < 1e-15);
		CHECK(q[0].flags == BAKE_QUADRIC_LOWERED);
		for (int v = 1; v < 5; v++) {
			CHECK(is_finite(&q[v]));
			CHECK(q[v].flags & BAKE_QUADRIC_BOUNDARY);
		}
	}
	free(f.frame);
	test_mesh_free(&m);
}

static void
rings_grow_where_they_are_too_small(void)
{
	struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_err err;
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_quadric *q;

	/* the corners of a grid have 2 or 3 direct neighbours */
	test_patch(&m, &test_surfaces[0], 8, 0.2);
	test_frames(&f, &m, &test_surfaces[0], 0.1);
	q = test_calloc(f.nframes, sizeof *q);
	p.ring = 1;
	CHECK_OK(try_fit(&m, &f, &p, q, &err), err);
	CHECK(q[0].rank == 5 && q[0].ring == 2);
	CHECK(q[0].flags == (BAKE_QUADRIC_GROWN | BAKE_QUADRIC_BOUNDARY));
	CHECK(q[40].rank == 5 && q[40].ring == 1 && q[40].flags == 0);
	CHECK(q[40].neighbours == 6);
	p.ring = 0;
	p.order = 3;
	CHECK_OK(try_fit(&m, &f, &p, q, &err), err);
	CHECK(q[0].rank == 9 && q[0].ring == 3);
	CHECK(q[0].flags == BAKE_QUADRIC_BOUNDARY);
	CHECK(q[40].ring == 2 && q[40].neighbours == 18);
	free(q);
	free(f.frame);
	test_mesh_free(&m);
}

/* Order 3 needs 9 neighbours; a patch of 8 has 7 about each of its vertices. */
static void
order_is_lowered_before_all_is(void)
{
	static const double p[8][3] = { { 0, 0, 0 }, { 1, 0.1, -0.2 },
		{ 0.4, 0.9, -0.1 }, { -0.6, 0.8, 0 }, { -1, 0, -0.3 },
		{ -0.5, -0.9, 0 }, { 0.5, -0.8, -0.1 }, { 1.4, 1, -0.5 } };
	static const int t[7][3] = { { 0, 1, 2 }, { 0, 2, 3 }, { 0, 3, 4 },
		{ 0, 4, 5 }, { 0, 5, 6 }, { 0, 6, 1 }, { 1, 7, 2 } };
	static const double up[8][3] = { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 },
		{ 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 },
		{ 0, 0, 1 } };
	struct bake_mesh m = make_mesh(8, p, 7, t);
	struct bake_frames f = make_frames(&m, up);
	struct bake_quadric_params params = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_quadric q[8], two[8];
	struct bake_err err;

	CHECK_OK(try_fit(&m, &f, &params, two, &err), err);
	params.order = 3;
	CHECK_OK(try_fit(&m, &f, &params, q, &err), err);
	CHECK(q[0].rank == 5 && (q[0].flags & BAKE_QUADRIC_LOWERED));
	CHECK(q[0].a == two[0].a && q[0].b == two[0].b);
	CHECK(!(two[0].flags & BAKE_QUADRIC_LOWERED));
	free(f.frame);
	test_mesh_free(&m);
}

/* -- degenerate meshes --------------------------------------------------------
 */

static void
degenerate_meshes_give_finite_values(void)
{
	/* a triangle, one without area, one of one point (unwelded), a point
	 * that nothing uses */
	static const double p[10][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 },
		{ 0, 0, 5 }, { 1, 0, 5 }, { 3, 0, 5 }, { 7, 7, 7 }, { 7, 7, 7 },
		{ 7, 7, 7 }, { 9, 9, 9 } };
	static const int t[3][3] = { { 0, 1, 2 }, { 3, 4, 5 }, { 6, 7, 8 } };
	static const double up[10][3] = { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 },
		{ 0, 0, 1 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 }, { 0, 0, 1 },
		{ 0, 0, 1 }, { 0, 0, 1 } };

	for (int i = 0; i < 6; i++) {
		struct bake_mesh m = make_mesh(10, p, 3, t);
		struct bake_frames f = make_frames(&m, up);
		struct bake_quadric_params params = BAKE_QUADRIC_PARAMS_DEFAULT;
		struct bake_quadric q[10];
		struct bake_err err;

		params.order = 2 + i % 2;
		params.model = i < 2 ? BAKE_QUADRIC_AB : BAKE_QUADRIC_FULL;
		params.creases = i < 4;
		memset(f.frame[1].normal, 0, sizeof f.frame[1].normal);
		f.frame[2].tangent[1] = NAN;
		f.frame[4].flags = BAKE_FRAME_NORMAL_NONE;
		memset(f.frame[5].ps, 0, sizeof f.frame[5].ps);
		CHECK_OK(try_fit(&m, &f, &params, q, &err), err);
		for (int v = 0; v < 10; v++)
			CHECK(is_finite(&q[v]));
		CHECK(q[0].a == 0 && q[0].b == 0);
		CHECK(q[1].rank == 0 && q[2].rank == 0 && q[4].rank == 0);
		CHECK(q[6].rank == 0 && q[9].rank == 0);
		CHECK(q[5].uvscale[0] == 0);
		free(f.frame);
		test_mesh_free(&m);
	}
}

static void
positions_that_are_no_numbers_are_an_error(void)
{
	struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_err err;
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_quadric q[26];

	test_patch(&m, &test_surfaces[0], 4, 0);
	test_frames(&f, &m, &test_surfaces[0], 0);
	m.positions[7][1] = NAN;
	CHECK(try_fit(&m, &f, &p, q, &err) == BAKE_EDATA);
	CHECK(strstr(err.msg, "position 7") != NULL);
	m.positions[7][1] = INFINITY;
	CHECK(try_fit(&m, &f, &p, q, &err) == BAKE_EDATA);
	free(f.frame);
	test_mesh_free(&m);
}

static void
huge_extents_do_not_overflow(void)
{
	struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_err err;
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_quadric q[25];

	test_patch(&m, &test_surfaces[0], 4, 0);
	test_frames(&f, &m, &test_surfaces[0], 0);
	for (int i = 0; i < 4; i++) {
		static const double factor[4] = { 1e300, 1e-8, 1e-300, 1e-300 };

		for (size_t v = 0; v < m.npositions; v++)
			for (int c = 0; c < 3; c++)
				m.positions[v][c] *= factor[i];
		CHECK_OK(try_fit(&m, &f, &p, q, &err), err);
		for (size_t v = 0; v < m.npositions; v++)
			CHECK(is_finite(&q[v]));
	}
	free(f.frame);
	test_mesh_free(&m);
}

/* Each rim vertex has the hub next to it, and so all others in its second
 * ring: without a limit this takes n^2 steps. */
static void
a_huge_fan_is_done_at_once(void)
{
	enum { N = 200000 };
	struct bake_quadric_params params = BAKE_QUADRIC_PARAMS_DEFAULT;
	double(*p)[3] = test_calloc(N + 1, sizeof *p);
	double(*normal)[3] = test_calloc(N + 1, sizeof *normal);
	int(*t)[3] = test_calloc(N, sizeof *t);
	struct bake_quadric *q = test_calloc(N + 1, sizeof *q);
	struct bake_err err;
	struct bake_mesh m;
	struct bake_frames f;

	for (int i = 0; i < N; i++) {
		double a = 2 * test_pi * i / N;

		p[i + 1][0] = cos(a);
		p[i + 1][1] = sin(a);
		p[i + 1][2] = -0.3;
		t[i][0] = 0;
		t[i][1] = i + 1;
		t[i][2] = (i + 1) % N + 1;
	}
	for (int i = 0; i <= N; i++)
		normal[i][2] = 1;
	m = make_mesh(N + 1, (const double(*)[3])p, N, (const int(*)[3])t);
	f = make_frames(&m, (const double(*)[3])normal);
	CHECK_OK(try_fit(&m, &f, &params, q, &err), err);
	for (int i = 0; i <= N; i++)
		CHECK(is_finite(&q[i]));
	/* the hub's neighbours that were chosen are from all round: they lie
	 * on the circle, where x^2 + y^2 = 1 and only the sum counts */
	CHECK_NEAR(q[0].a, 0.3, 1e-9);
	CHECK_NEAR(q[0].b, 0.3, 1e-9);
	CHECK(q[0].neighbours >= BAKE_QUADRIC_VALENCE_MAX &&
	      q[0].neighbours <=
		  BAKE_QUADRIC_NEIGHBOURS_MAX + BAKE_QUADRIC_VALENCE_MAX);
	free(p);
	free(normal);
	free(t);
	free(q);
	free(f.frame);
	test_mesh_free(&m);
}

/* -- boundaries, creases, statistics -------------------------------------- */

/* A cube's eight corners, each with the normal of its diagonal. */
static const double cube[8][3] = { { -1, -1, -1 }, { 1, -1, -1 }, { 1, 1, -1 },
	{ -1, 1, -1 }, { -1, -1, 1 }, { 1, -1, 1 }, { 1, 1, 1 }, { -1, 1, 1 } };
static const int cube_faces[12][3] = { { 0, 2, 1 }, { 0, 3, 2 }, { 4, 5, 6 },
	{ 4, 6, 7 }, { 0, 1, 5 }, { 0, 5, 4 }, { 2, 3, 7 }, { 2, 7, 6 },
	{ 1, 2, 6 }, { 1, 6, 5 }, { 3, 0, 4 }, { 3, 4, 7 } };

static void
boundaries_and_creases_are_named(void)
{
	struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_mesh m = make_mesh(8, cube, 12, cube_faces);
	struct bake_frames f = make_frames(&m, cube);
	struct bake_quadric_stats s;
	struct bake_quadric q[8], *grid;
	struct bake_err err;

	CHECK_OK(try_fit(&m, &f, &p, q, &err), err);
	for (int v = 0; v < 8; v++)
		CHECK(!(q[v].flags & BAKE_QUADRIC_CREASE));
	p.creases = true;
	CHECK_OK(try_fit(&m, &f, &p, q, &err), err);
	for (int v = 0; v < 8; v++) {
		CHECK(q[v].flags & BAKE_QUADRIC_CREASE);
		CHECK(!(q[v].flags & BAKE_QUADRIC_BOUNDARY));
		CHECK(q[v].a > 0 && q[v].b > 0); /* convex */
	}
	/* without its top it has a boundary of four */
	m.ntriangles = 10;
	CHECK_OK(try_fit(&m, &f, &p, q, &err), err);
	CHECK_OK(bake_quadric_count(q, 8, &s, &err), err);
	CHECK(s.boundary == 4 && s.crease == 8 && s.n == 8);
	free(f.frame);
	test_mesh_free(&m);

	/* smooth, but two frames of one point differ in their normals */
	test_patch(&m, &test_surfaces[0], 6, 0);
	test_frames(&f, &m, &test_surfaces[0], 0);
	f.frame[0] = f.frame[24];
	f.frame[0].normal[0] += 0.05;
	test_normalize(f.frame[0].normal);
	grid = test_calloc(f.nframes, sizeof *grid);
	CHECK_OK(try_fit(&m, &f, &p, grid, &err), err);
	CHECK_OK(bake_quadric_count(grid, f.nframes, &s, &err), err);
	CHECK(s.crease == 2);
	CHECK(s.boundary == 24 - 1); /* frame 0 is now of an inner point */
	free(grid);
	free(f.frame);
	test_mesh_free(&m);
}

static void
statistics_are_what_was_counted(void)
{
	struct bake_quadric q[1000];
	struct bake_quadric_stats s;
	struct bake_err err = BAKE_ERR_INIT;

	memset(q, 0, sizeof q);
	for (int i = 0; i < 1000; i++) {
		q[i].a = i - 500;
		q[i].residual = (i * 7) % 1000 + 1; /* 1 .. 1000, mixed */
		q[i].rank = i < 10 ? 1 : 5;
		q[i].flags = i < 3 ? BAKE_QUADRIC_GROWN : 0;
	}
	CHECK_OK(bake_quadric_count(q, 1000, &s, &err), err);
	CHECK(s.lo[0] == -500 && s.hi[0] == 499 && s.lo[1] == 0);
	CHECK(s.rank[1] == 10 && s.rank[5] == 990 && s.grown == 3);
	CHECK(s.residual[0] == 500 && s.residual[1] == 900);
	CHECK(s.residual[2] == 990 && s.residual[3] == 999);
	CHECK(s.residual[4] == 1000);
	CHECK_OK(bake_quadric_count(q, 0, &s, &err), err);
	CHECK(s.n == 0 && s.hi[0] == 0 && s.residual[4] == 0);
}

static void
params_out_of_range_are_refused(void)
{
	const struct bake_quadric_params good = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_quadric_params p[8];
	struct bake_weld weld = BAKE_WELD_INIT;
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_quadric q[25];
	struct bake_err err;

	for (int i = 0; i < 8; i++)
		p[i] = good;
	p[0].order = 1;
	p[1].order = 4;
	p[2].ring = -1;
	p[3].ring = BAKE_QUADRIC_RING_MAX + 1;
	p[4].depth_scale = 0;
	p[5].depth_scale = NAN;
	p[6].depth = -1;
	p[7].model = (enum bake_quadric_model)2;
	test_patch(&m, &test_surfaces[0], 4, 0);
	test_frames(&f, &m, &test_surfaces[0], 0);
	for (int i = 0; i < 8; i++) {
		CHECK(try_fit(&m, &f, &p[i], q, &err) == BAKE_EINVAL);
		CHECK(err.msg[0] != '\0');
	}
	f.frame[3].v = 25;
	CHECK(try_fit(&m, &f, &good, q, &err) == BAKE_EINVAL);
	f.frame[3].v = 3;
	weld.npositions = 24;
	CHECK(bake_quadric_fit(&m, &weld, &f, &good, q, &err) == BAKE_EINVAL);
	/* nothing to do is no error */
	f.nframes = 0;
	CHECK_OK(try_fit(&m, &f, &good, q, &err), err);
	m.ntriangles = 0;
	f.nframes = 25;
	CHECK_OK(try_fit(&m, &f, &good, q, &err), err);
	CHECK(q[7].rank == 0);
	free(f.frame);
	test_mesh_free(&m);
}

static const struct check_case cases[] = {
	CASE(an_oracle_agrees),
	CASE(few_neighbours_make_a_ball),
	CASE(rings_grow_where_they_are_too_small),
	CASE(order_is_lowered_before_all_is),
	CASE(degenerate_meshes_give_finite_values),
	CASE(positions_that_are_no_numbers_are_an_error),
	CASE(huge_extents_do_not_overflow),
	CASE(a_huge_fan_is_done_at_once),
	CASE(boundaries_and_creases_are_named),
	CASE(statistics_are_what_was_counted),
	CASE(params_out_of_range_are_refused),
};

int
main(int argc, char **argv)
{
	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
