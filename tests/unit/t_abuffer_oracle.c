/* The A-buffer against an oracle that counts in exact rational numbers. */
/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include "test_abuffer.h"
#include "test_mesh.h"

/*
 * The oracle: a mesh of whole numbers (2^-16 texel, y downwards; depths as
 * they are) and a ray that is moved from the texel's centre by (e, e^2) with
 * e = 2^-FINE of a unit, so little that it changes nothing but that it meets
 * no edge and no vertex. So it needs no rule for edges. All triangles are
 * tried at every texel. Numbers: extents are below 2^30.5, so that edge
 * functions of the moved ray, times 2^(2 FINE), are below 2^(62 + 62); twice
 * areas are below 2^61, and with depths below 2^5 products of a depth's
 * numerator and another's denominator below 2^(66 + 61).
 */
enum { FINE = 31, SIDE = 12, MOST = 4096 };
typedef __int128 wide;

struct exact {
	size_t npoints, ntriangles;
	int (*point)[3];
	int (*triangle)[3];
};

/* One crossing: depth = num / den, den > 0; on: bits of the corners that have
 * any weight; first, last: the least and the largest of these points. */
struct hit {
	wide num, den;
	bool entering;
	int triangle, tile_x, tile_y;
	int points[3];
	double weight[3];
};

static wide
edge(const int *a, const int *b, long x, long y, int shift, bool moved)
{
	const wide one = (wide)1 << shift;
	wide px = (x - a[0]) * one, py = (y - a[1]) * one;

	if (moved) {
		px += one >> FINE;
		py += 1;
	}
	return (b[0] - a[0]) * py - (b[1] - a[1]) * px;
}

static bool
meets(const struct exact *m, int t, long x, long y, struct hit *h)
{
	const int *p[3];
	wide e[3];
	int sign = 0;

	for (int k = 0; k < 3; k++)
		p[k] = m->point[m->triangle[t][k]];
	for (int k = 0; k < 3; k++) {
		e[k] =
		    edge(p[(k + 1) % 3], p[(k + 2) % 3], x, y, 2 * FINE, true);
		sign += e[k] > 0 ? 1 : e[k] < 0 ? -1 : 0;
	}
	if (sign != 3 && sign != -3)
		return false;
	h->num = h->den = 0;
	for (int k = 0; k < 3; k++) {
		e[k] = sign / 3 *
		       edge(p[(k + 1) % 3], p[(k + 2) % 3], x, y, 0, false);
		h->num += e[k] * p[k][2];
		h->den += e[k];
		h->points[k] = e[k] != 0 ? m->triangle[t][k] : -1;
	}
	for (int k = 0; k < 3; k++)
		h->weight[k] = (double)e[k] / (double)h->den;
	/* counterclockwise with y upwards is clockwise here */
	h->entering = sign < 0;
	h->triangle = t;
	return true;
}

static int
compare_hits(const void *a, const void *b)
{
	const struct hit *h = a, *g = b;
	wide l = h->num * g->den, r = g->num * h->den;

	if (l != r)
		return l < r ? -1 : 1;
	if (h->entering != g->entering)
		return h->entering ? -1 : 1;
	if (h->triangle != g->triangle)
		return h->triangle < g->triangle ? -1 : 1;
	if (h->tile_y != g->tile_y)
		return h->tile_y < g->tile_y ? -1 : 1;
	return (h->tile_x > g->tile_x) - (h->tile_x < g->tile_x);
}

static bool
shares(const struct hit *a, const struct hit *b)
{
	for (int k = 0; k < 3; k++) {
		bool found = a->points[k] < 0;

		for (int j = 0; j < 3; j++)
			found |= a->points[k] == b->points[j];
		if (!found)
			return false;
	}
	return true;
}

/* Two at one depth that do not meet in one edge or corner there. */
static bool
is_touching(const struct hit *h, int n)
{
	for (int i = 1; i < n; i++)
		if (h[i].num * h[i - 1].den == h[i - 1].num * h[i].den &&
		    (!shares(&h[i], &h[i - 1]) || !shares(&h[i - 1], &h[i])))
			return true;
	return false;
}

static int
find_hits(const struct exact *m, int x, int y, int tiles, struct hit *h)
{
	int n = 0;

	for (int t = 0; t < (int)m->ntriangles; t++)
		for (int j = -tiles; j <= tiles; j++)
			for (int i = -tiles; i <= tiles; i++) {
				h[n].tile_x = i;
				h[n].tile_y = j;
				if (meets(m, t, (x + i * SIDE) * 65536L + 32768,
					(y + j * SIDE) * 65536L + 32768, &h[n]))
					n++;
				if (n == MOST)
					abort();
			}
	qsort(h, (size_t)n, sizeof *h, compare_hits);
	return n;
}

/* Those that stay, in place; returns how many. */
static int
walk_hits(struct hit *h, int n, struct bake_abuffer_stats *stats)
{
	int winding = 0, nout = 0;

	stats->crossings += (size_t)n;
	for (int i = 0; i < n; i++) {
		int before = winding;

		winding += h[i].entering ? 1 : -1;
		if ((before == 0) != (winding == 0))
			h[nout++] = h[i];
	}
	stats->united += nout < n;
	if (winding != 0) {
		stats->open++;
		nout--;
	}
	if (nout > stats->most)
		stats->most = nout;
	return nout;
}

static struct bake_mesh
mesh_of(const struct exact *e)
{
	struct bake_mesh m = solid_alloc(e->npoints, e->ntriangles);

	for (size_t v = 0; v < e->npoints; v++) {
		m.positions[v][0] = e->point[v][0] / 65536.0;
		m.positions[v][1] = SIDE - e->point[v][1] / 65536.0;
		m.positions[v][2] = -e->point[v][2];
	}
	for (size_t t = 0; t < e->ntriangles; t++)
		solid_triangle(&m, t, (size_t)e->triangle[t][0],
		    (size_t)e->triangle[t][1], (size_t)e->triangle[t][2]);
	return m;
}

/* depth = -Z, from 0 on; a range of 1. */
static const struct bake_view plain = { BAKE_AXIS_POS_Z, SIDE, SIDE, 0, 0, SIDE,
	SIDE, 0, -1, false, false };

static size_t
count_wrong_weights(const struct bake_abuffer *ab,
    const struct bake_crossing *c, const struct hit *h, int x, int y)
{
	size_t bad = 0;
	double w[3];

	bake_abuffer_weights(ab, c, x, y, w);
	/* a quotient of numbers rounded to 53 bits: 3 half units at most */
	for (int k = 0; k < 3; k++)
		bad += !(fabs(w[k] - h->weight[k]) <= 4e-16);
	return bad + !(fabs(w[0] + w[1] + w[2] - 1) <= 1e-15);
}

/* Compare a whole picture; returns how many texels were left out because
 * sheets touch there: no arithmetic but exact can tell which is first. */
static size_t
compare_with_oracle(const struct exact *e, int tiles)
{
	const struct bake_abuffer_params p = BAKE_ABUFFER_PARAMS_DEFAULT;
	static struct hit hit[MOST];
	struct bake_mesh m = mesh_of(e);
	struct bake_view view = plain;
	struct bake_abuffer_stats stats = { 0 };
	struct bake_abuffer *ab = NULL;
	struct bake_err err = BAKE_ERR_INIT;
	struct layers l;
	size_t touching = 0, counts = 0, order = 0, depths = 0, weights = 0;

	view.tile_x = view.tile_y = tiles > 0;
	l = layers_make(&m, &view, &p, 5);
	CHECK_OK(bake_abuffer_open(&ab, &m, NULL, &view, &p, &err), err);
	for (int i = 0; i < SIDE * SIDE; i++) {
		const struct bake_crossing *c;
		int n = find_hits(e, i % SIDE, i / SIDE, tiles, hit);
		bool vague = is_touching(hit, n);

		n = walk_hits(hit, n, &stats);
		touching += vague;
		if (layers_at(&l, (size_t)i, &c) != (size_t)n) {
			counts += !vague;
			continue;
		}
		for (int k = 0; k < n && !vague; k++) {
			double d = (double)hit[k].num / (double)hit[k].den;

			/* depths are up to 64, a dozen roundings */
			depths += !(fabs(c[k].depth - d) <= 1e-13);
			order += c[k].triangle != (unsigned)hit[k].triangle ||
				 c[k].tile_x != hit[k].tile_x ||
				 c[k].tile_y != hit[k].tile_y;
			weights += count_wrong_weights(
			    ab, &c[k], &hit[k], i % SIDE, i / SIDE);
		}
	}
	CHECK(counts == 0);
	CHECK(order == 0);
	CHECK(depths == 0);
	CHECK(weights == 0);
	CHECK(l.stats.crossings == stats.crossings);
	CHECK(l.stats.open == stats.open);
	if (touching == 0) {
		CHECK(l.stats.united == stats.united);
		CHECK(l.stats.most == stats.most);
	}
	bake_abuffer_close(ab);
	layers_free(&l);
	bake_mesh_free(&m);
	return touching;
}

static struct exact
exact_alloc(size_t npoints, size_t ntriangles)
{
	struct exact e = { npoints, ntriangles, NULL, NULL };

	e.point = layers_grow(NULL, npoints, sizeof *e.point);
	e.triangle = layers_grow(NULL, ntriangles, sizeof *e.triangle);
	return e;
}

static void
exact_free(struct exact *e)
{
	free(e->point);
	free(e->triangle);
}

/* The surface of a torus, n x n points in any places: a multiple of step from
 * lo to hi (in 2^-16 texel), depths of 1 to deep. */
static struct exact
crumpled(int n, int step, int lo, int hi, int deep, uint64_t *seed)
{
	struct exact e = exact_alloc((size_t)(n * n), (size_t)(2 * n * n));

	for (int v = 0; v < n * n; v++) {
		for (int k = 0; k < 2; k++)
			e.point[v][k] =
			    lo +
			    step * (int)(chance(seed) * ((hi - lo) / step + 1));
		e.point[v][2] = 1 + (int)(chance(seed) * deep);
	}
	for (int i = 0; i < n; i++)
		for (int k = 0; k < n; k++) {
			int a = i * n + k, b = (i + 1) % n * n + k;
			int c = (i + 1) % n * n + (k + 1) % n;
			int d = i * n + (k + 1) % n;
			int q[2][3] = { { a, b, c }, { a, c, d } };

			memcpy(e.triangle[2 * a], q, sizeof q);
		}
	return e;
}

static void
crumpled_surfaces_on_texel_centres(void)
{
	uint64_t seed = 1;
	size_t left_out = 0;

	/* vertices on centres and corners of texels, edges through both; depths
	 * far apart, so that sheets touch but seldom */
	for (int i = 0; i < 60; i++) {
		int n = 3 + i % 4;
		struct exact e = crumpled(
		    n, 32768, -65536, (SIDE + 1) * 65536, 1 << 20, &seed);

		for (size_t v = 0; v < e.npoints; v++)
			e.point[v][2] %= 64;
		left_out += compare_with_oracle(&e, 0);
		exact_free(&e);
	}
	CHECK(left_out < 60 * SIDE * SIDE / 50);
}

static void
crumpled_surfaces_anywhere(void)
{
	uint64_t seed = 2;
	size_t left_out = 0;

	for (int i = 0; i < 40; i++) {
		struct exact e = crumpled(3 + i % 4, 1 + i % 3 * 4095, -65536,
		    (SIDE + 1) * 65536, 64, &seed);

		left_out += compare_with_oracle(&e, 0);
		exact_free(&e);
	}
	CHECK(left_out == 0);
}

/* One or two columns, and rows. */
static void
small_triangles(void)
{
	uint64_t seed = 6;

	for (int i = 0; i < 60; i++) {
		int lo = 65536 * 5 + 16384 * (i % 4);
		struct exact e = crumpled(3 + i % 4, i % 3 ? 16384 : 1, lo,
		    lo + 65536 * (1 + i % 2), 64, &seed);

		compare_with_oracle(&e, i % 5 == 0);
		exact_free(&e);
	}
}

/* Above and below the extent from which products need 128 bits. */
static void
huge_triangles(void)
{
	uint64_t seed = 7;
	size_t left_out = 0;

	for (int i = 0; i < 30; i++) {
		struct exact e = crumpled(3 + i % 4, i % 2 ? 32768 : 1,
		    -700000000, 700000000, 31, &seed);

		left_out += compare_with_oracle(&e, 0);
		exact_free(&e);
	}
	/* some triangles are level, two of them at one depth */
	CHECK(left_out < 30 * SIDE * SIDE / 10);
}

static void
crumpled_surfaces_over_several_tiles(void)
{
	uint64_t seed = 3;

	for (int i = 0; i < 20; i++) {
		struct exact e = crumpled(3 + i % 2, i % 2 ? 32768 : 1,
		    -2 * SIDE * 65536, 3 * SIDE * 65536, 64, &seed);

		compare_with_oracle(&e, 3);
		exact_free(&e);
	}
}

static void
holes_are_counted(void)
{
	uint64_t seed = 4;

	for (int i = 0; i < 20; i++) {
		struct exact e =
		    crumpled(4, 16384, -65536, (SIDE + 1) * 65536, 64, &seed);

		e.ntriangles -= 1 + (size_t)i % 3;
		compare_with_oracle(&e, 0);
		exact_free(&e);
	}
}

/* A sheet of every texel centre a vertex, twice: above and below, which meet
 * in their border; the diagonals of the two go either way. */
static struct exact
pillow(uint64_t *seed)
{
	const int n = SIDE - 1, side = SIDE;
	struct exact e =
	    exact_alloc((size_t)(2 * side * side), (size_t)(4 * n * n));
	size_t t = 0;

	for (int v = 0; v < 2 * side * side; v++) {
		int x = v / 2 % side, y = v / 2 / side;
		bool border = x == 0 || y == 0 || x == n || y == n;

		e.point[v][0] = x * 65536 + 32768;
		e.point[v][1] = y * 65536 + 32768;
		e.point[v][2] =
		    border ? 32 : (v % 2 ? 33 : 1) + (int)(chance(seed) * 30);
	}
	for (int v = 0; v < n * n; v++)
		for (int below = 0; below < 2; below++) {
			int x = v % n, y = v / n;
			int at[4] = { y * side + x, (y + 1) * side + x,
				(y + 1) * side + x + 1, y * side + x + 1 };
			int turn = chance(seed) < 0.5;
			int q[4];

			for (int k = 0; k < 4; k++) {
				int w = at[below ? (8 - k - turn) % 4
						 : (k + turn) % 4];
				int wx = w % side, wy = w / side;
				bool border =
				    wx == 0 || wy == 0 || wx == n || wy == n;

				q[k] = 2 * w + (below && !border);
			}
			for (int h = 0; h < 2; h++, t++)
				for (int k = 0; k < 3; k++)
					e.triangle[t][k] =
					    q[k == 0 ? 0 : k + h];
		}
	return e;
}

static void
vertices_on_all_centres(void)
{
	uint64_t seed = 5;

	for (int i = 0; i < 10; i++) {
		struct exact e = pillow(&seed);

		CHECK(compare_with_oracle(&e, 0) == 0);
		exact_free(&e);
	}
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(vertices_on_all_centres),
		CASE(crumpled_surfaces_on_texel_centres),
		CASE(crumpled_surfaces_anywhere),
		CASE(crumpled_surfaces_over_several_tiles),
		CASE(small_triangles),
		CASE(huge_triangles),
		CASE(holes_are_counted),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
