/* Polygons, welding, adjacency, topology: closed forms and slow oracles. */
/* SPDX-License-Identifier: MIT */
#include "test_mesh.h"

/* -- polygons ------------------------------------------------------------ */

/* The plane of a polygon: two directions at right angles, and a place. */
static const double ex[3] = { 0.36, 0.48, -0.8 };
static const double ey[3] = { -0.8, 0.6, 0.0 };

static void
lift(double x, double y, double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = x * ex[k] + y * ey[k] + 10.0 * (k + 1);
}

static double
signed_area(const double *a, const double *b, const double *c)
{
	return 0.5 *
	       ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

/* Triangulate a polygon of the plane: the areas add up to its own, and none
 * is turned round. Returns the least of them relative to the whole. */
static double
cut(const double (*xy)[2], int n, bool expect_rough)
{
	double(*p)[3] = malloc((size_t)n * sizeof *p);
	int(*t)[3] = malloc((size_t)n * sizeof *t);
	struct bake_err err = BAKE_ERR_INIT;
	double whole = 0.0, sum = 0.0, least = INFINITY;
	bool rough;

	if (p == NULL || t == NULL)
		abort();
	for (int i = 0; i < n; i++) {
		const double *a = xy[i], *b = xy[(i + 1) % n];

		lift(a[0], a[1], p[i]);
		whole += 0.5 * (a[0] * b[1] - a[1] * b[0]);
	}
	CHECK_OK(
	    bake_polygon_triangulate((const double(*)[3])p, n, t, &rough, &err),
	    err);
	CHECK(rough == expect_rough);
	for (int i = 0; i < n - 2; i++) {
		double a;

		for (int k = 0; k < 3; k++)
			if (t[i][k] < 0 || t[i][k] >= n)
				abort();
		a = signed_area(xy[t[i][0]], xy[t[i][1]], xy[t[i][2]]);
		sum += fabs(a);
		least = fmin(least, a);
	}
	/* rounding of n terms of the size of the whole */
	if (!expect_rough)
		CHECK_NEAR(sum, whole, 1e-13 * n * whole);
	free(p);
	free(t);
	return least / whole;
}

static void
convex_polygons_are_fans(void)
{
	enum { N = 100000 };
	static double xy[N][2];
	double p[5][3];
	int t[3][3];
	bool rough;
	struct bake_err err = BAKE_ERR_INIT;

	for (int n = 3; n <= N; n = n < 12 ? n + 1 : n * 10) {
		for (int i = 0; i < n; i++) {
			double a = 2.0 * 3.14159265358979 * i / n;

			xy[i][0] = 3.0 * cos(a);
			xy[i][1] = sin(a);
		}
		CHECK(cut((const double(*)[2])xy, n, false) > 0.0);
	}
	for (int i = 0; i < 5; i++)
		lift(xy[i * 1000][0], xy[i * 1000][1], p[i]);
	CHECK_OK(
	    bake_polygon_triangulate((const double(*)[3])p, 5, t, &rough, &err),
	    err);
	for (int i = 0; i < 3; i++)
		CHECK(t[i][0] == 0 && t[i][1] == i + 1 && t[i][2] == i + 2);
}

static void
star_shaped_polygons_are_covered_once(void)
{
	static double xy[300][2];
	uint64_t seed = 7;

	for (int n = 4; n <= 300; n += n < 40 ? 1 : 13)
		for (int run = 0; run < 20; run++) {
			for (int i = 0; i < n; i++) {
				double a = 2.0 * 3.14159265358979 * i / n;
				double r = 0.1 + chance(&seed);

				xy[i][0] = r * cos(a);
				xy[i][1] = r * sin(a);
			}
			/* turned round: rounding of cross products */
			CHECK(cut((const double(*)[2])xy, n, false) > -1e-15);
		}
}

static void
a_quadrangle_is_cut_at_its_reflex_corner(void)
{
	const double dart[4][2] = { { 0, 0 }, { 2, 0 }, { 0.5, 0.5 },
		{ 0, 2 } };
	double turned[4][2];

	for (int from = 0; from < 4; from++) {
		for (int i = 0; i < 4; i++)
			memcpy(
			    turned[i], dart[(i + from) % 4], sizeof turned[i]);
		CHECK(cut((const double(*)[2])turned, 4, false) > 0.1);
	}
}

static void
combs_spirals_and_holes(void)
{
	enum { TEETH = 500, TURNS = 400 };
	static double comb[4 * TEETH][2], spiral[2 * TURNS][2];
	/* a square with a square hole, by a bridge there and back */
	const double hole[10][2] = { { 0, 0 }, { 4, 0 }, { 4, 4 }, { 0, 4 },
		{ 0, 0 }, { 1, 1 }, { 1, 3 }, { 3, 3 }, { 3, 1 }, { 1, 1 } };

	for (int i = 0; i < 2 * TEETH; i++) {
		comb[i][0] = i;
		comb[i][1] = -1.0;
		comb[4 * TEETH - 1 - i][0] = i + 0.25;
		comb[4 * TEETH - 1 - i][1] = i % 2 == 0 ? 0.0 : 5.0;
	}
	CHECK(cut((const double(*)[2])comb, 4 * TEETH, false) > -1e-15);
	for (int i = 0; i < TURNS; i++) {
		double a = 0.1 * i, r = 1.0 + 0.1 * i;

		spiral[i][0] = r * cos(a);
		spiral[i][1] = r * sin(a);
		spiral[2 * TURNS - 1 - i][0] = (r - 0.3) * cos(a);
		spiral[2 * TURNS - 1 - i][1] = (r - 0.3) * sin(a);
	}
	CHECK(cut((const double(*)[2])spiral, 2 * TURNS, false) > -1e-15);
	CHECK(cut(hole, 10, false) > 0.0);
}

/* More corners than there are tests for: the rest is cut somehow, and soon. */
static void
huge_concave_polygons_end(void)
{
	enum { N = 200000 };
	static double xy[N][2];
	uint64_t seed = 9;

	for (int i = 0; i < N; i++) {
		double a = 2.0 * 3.14159265358979 * i / N;
		double r = 0.1 + chance(&seed);

		xy[i][0] = r * cos(a);
		xy[i][1] = r * sin(a);
	}
	cut((const double(*)[2])xy, N, true);
}

static void
straight_corners_make_no_flat_triangles(void)
{
	const double square[8][2] = { { 0, 0 }, { 1, 0 }, { 2, 0 }, { 2, 1 },
		{ 2, 2 }, { 1, 2 }, { 0, 2 }, { 0, 1 } };
	const double quad[4][2] = { { 0, 0 }, { 1, 0 }, { 2, 0 }, { 1, 1 } };

	CHECK(cut(square, 8, false) > 0.1);
	CHECK(cut(quad, 4, false) > 0.1);
}

static void
crossing_polygons_are_called_rough(void)
{
	const double bow[4][2] = { { 0, 0 }, { 1, 1 }, { 1, 0 }, { 0, 1 } };
	double star[5][2];

	for (int i = 0; i < 5; i++) {
		star[i][0] = cos(4.0 * 3.14159265358979 * i / 5);
		star[i][1] = sin(4.0 * 3.14159265358979 * i / 5);
	}
	cut(bow, 4, true);
	cut((const double(*)[2])star, 5, true);
}

static void
polygons_without_area_do_not_hang(void)
{
	enum { N = 3000 };
	static double p[N][3];
	static int t[N][3];
	struct bake_err err = BAKE_ERR_INIT;
	uint64_t seed = 3;
	bool rough;

	CHECK_OK(
	    bake_polygon_triangulate((const double(*)[3])p, N, t, &rough, &err),
	    err);
	for (int i = 0; i < N; i++)
		p[i][0] = i;
	CHECK_OK(
	    bake_polygon_triangulate((const double(*)[3])p, N, t, &rough, &err),
	    err);
	/* nonsense: points by chance */
	for (int i = 0; i < N; i++)
		for (int k = 0; k < 3; k++)
			p[i][k] = chance(&seed);
	CHECK_OK(
	    bake_polygon_triangulate((const double(*)[3])p, N, t, &rough, &err),
	    err);
	CHECK(rough);
}

/* -- welding ------------------------------------------------------------- */

/* A mesh of points alone. */
static struct bake_mesh
cloud(size_t n)
{
	struct bake_mesh m;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_mesh_alloc(&m, n, 0, 0, 0, &err), err);
	return m;
}

static void
equal_positions_are_one_point(void)
{
	struct bake_mesh m = cloud(6);
	struct bake_weld w = BAKE_WELD_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	const double p[6][3] = { { 1, 2, 3 }, { 0.0, 1, 0 }, { 1, 2, 3 },
		{ -0.0, 1, 0 }, { 1, 2, 3.0000000000000004 }, { 1, 2, 3 } };
	const int expected[6] = { 0, 1, 0, 1, 4, 0 };

	memcpy(m.positions, p, sizeof p);
	CHECK_OK(bake_mesh_weld(&m, 0.0, &w, &err), err);
	CHECK(w.npoints == 3 && w.npositions == 6);
	for (int i = 0; i < 6; i++)
		CHECK(w.first[i] == expected[i]);
	bake_weld_free(&w);
	CHECK_OK(bake_mesh_weld(&m, 1e-15, &w, &err), err);
	CHECK(w.npoints == 2 && w.first[4] == 0);
	bake_weld_free(&w);
	CHECK(bake_mesh_weld(&m, -1.0, &w, &err) == BAKE_EINVAL);
	CHECK(w.first == NULL);
	bake_mesh_free(&m);
}

/* The oracle: join any two near positions until nothing changes. */
static void
weld_slowly(const struct bake_mesh *m, double eps, int *set)
{
	size_t n = m->npositions;
	bool changed = true;

	for (size_t i = 0; i < n; i++)
		set[i] = (int)i;
	while (changed) {
		changed = false;
		for (size_t i = 0; i < n; i++)
			for (size_t j = 0; j < n; j++) {
				const double *a = m->positions[i],
					     *b = m->positions[j];
				double d2 = 0.0;

				for (int k = 0; k < 3; k++)
					d2 += (a[k] - b[k]) * (a[k] - b[k]);
				if (d2 <= eps * eps && set[j] < set[i]) {
					set[i] = set[j];
					changed = true;
				}
			}
	}
}

static void
near_positions_are_one_point(void)
{
	enum { N = 300 };
	struct bake_mesh m = cloud(N);
	struct bake_weld w = BAKE_WELD_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	int set[N];
	uint64_t seed = 11;

	for (int run = 0; run < 8; run++) {
		double eps = 0.01 * (1 << run) / 2;

		for (int i = 0; i < N; i++)
			for (int k = 0; k < 3; k++)
				m.positions[i][k] =
				    (k == 2 ? 0.05 : 1.0) * chance(&seed) - 0.5;
		weld_slowly(&m, eps, set);
		CHECK_OK(bake_mesh_weld(&m, eps, &w, &err), err);
		CHECK(memcmp(w.first, set, sizeof set) == 0);
		bake_weld_free(&w);
	}
	bake_mesh_free(&m);
}

/* -- adjacency and topology ---------------------------------------------- */

static void
adjacency_lists_each_corner_once(void)
{
	const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 1 1 0\n"
			    "v 9 9 9\nf 1 2 3\nf 4 3 2\nf 2 5 3\nf 1 4 2\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_weld w = BAKE_WELD_INIT;
	struct bake_adjacency adj = BAKE_ADJACENCY_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	const int at0[] = { 0, 3 }, at1[] = { 1, 5, 6 };

	CHECK_OK(read_text(text, "a.obj", &m, &err), err);
	CHECK_OK(bake_mesh_weld(&m, 0.0, &w, &err), err);
	CHECK_OK(bake_mesh_adjacency(&m, &w, false, &adj, &err), err);
	/* the last triangle has both 1 and 4, which are one point */
	CHECK(adj.ncorners == 9 && adj.start[6] == 9);
	CHECK(adj.start[1] - adj.start[0] == 2 && adj.start[0] == 0);
	CHECK(memcmp(adj.corner, at0, sizeof at0) == 0);
	CHECK(adj.start[2] - adj.start[1] == 3);
	CHECK(memcmp(adj.corner + adj.start[1], at1, sizeof at1) == 0);
	CHECK(adj.start[4] == adj.start[3]); /* a copy of the first */
	CHECK(adj.start[6] == adj.start[5]); /* in no triangle */
	bake_adjacency_free(&adj);
	CHECK_OK(bake_mesh_adjacency(&m, &w, true, &adj, &err), err);
	CHECK(adj.ncorners == 12);
	bake_adjacency_free(&adj);
	CHECK_OK(bake_mesh_adjacency(&m, NULL, false, &adj, &err), err);
	CHECK(adj.ncorners == 12 && adj.start[4] - adj.start[3] == 2);
	bake_adjacency_free(&adj);
	w.npositions = 5;
	CHECK(bake_mesh_adjacency(&m, &w, true, &adj, &err) == BAKE_EINVAL);
	CHECK(adj.start == NULL);
	bake_weld_free(&w);
	bake_mesh_free(&m);
}

static void
topology_of_a_tetrahedron_and_a_fan(void)
{
	const char closed[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
			      "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
	const char fan[] = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv -1 0 0\nv 0 0 1\n"
			   "v 5 5 5\nf 1 2 3\nf 2 1 4\nf 1 2 5\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_topology t;
	struct bake_err err;

	CHECK_OK(read_text(closed, "a.obj", &m, &err), err);
	CHECK_OK(bake_mesh_topology(&m, NULL, &t, &err), err);
	CHECK(t.points == 4 && t.triangles == 4 && t.edges == 6);
	CHECK(t.boundary == 0 && t.nonmanifold == 0 && t.flipped == 0);
	CHECK(t.isolated == 0 && t.components == 1 && t.collapsed == 0);
	bake_mesh_free(&m);
	CHECK_OK(read_text(fan, "a.obj", &m, &err), err);
	CHECK_OK(bake_mesh_topology(&m, NULL, &t, &err), err);
	CHECK(t.edges == 7 && t.boundary == 6 && t.nonmanifold == 1);
	CHECK(t.flipped == 1 && t.isolated == 1 && t.components == 1);
	bake_mesh_free(&m);
}

static void
bounds_are_of_used_positions(void)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	double lo[3], hi[3];

	bake_mesh_bounds(&m, lo, hi);
	CHECK(lo[0] == (double)INFINITY && hi[2] == -(double)INFINITY);
	CHECK_OK(read_text("v -1 2 3\nv 4 -5 6\nv 7 8 -9\nv 99 99 99\n"
			   "f 1 2 3\n",
		     "a.obj", &m, &err),
	    err);
	bake_mesh_bounds(&m, lo, hi);
	CHECK(lo[0] == -1.0 && lo[1] == -5.0 && lo[2] == -9.0);
	CHECK(hi[0] == 7.0 && hi[1] == 8.0 && hi[2] == 6.0);
	bake_mesh_free(&m);
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(convex_polygons_are_fans),
		CASE(star_shaped_polygons_are_covered_once),
		CASE(a_quadrangle_is_cut_at_its_reflex_corner),
		CASE(combs_spirals_and_holes),
		CASE(huge_concave_polygons_end),
		CASE(straight_corners_make_no_flat_triangles),
		CASE(crossing_polygons_are_called_rough),
		CASE(polygons_without_area_do_not_hang),
		CASE(equal_positions_are_one_point),
		CASE(near_positions_are_one_point),
		CASE(adjacency_lists_each_corner_once),
		CASE(topology_of_a_tetrahedron_and_a_fan),
		CASE(bounds_are_of_used_positions),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
