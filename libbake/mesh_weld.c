/* Welding by position, and what meets where in a welded mesh. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh_priv.h"

/* -- equal values -------------------------------------------------------- */

static uint64_t
mix(uint64_t h, uint64_t x)
{
	/* the finalizer of splitmix64 */
	h ^= x;
	h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9u;
	h = (h ^ h >> 27) * 0x94d049bb133111ebu;
	return h ^ h >> 31;
}

static uint64_t
hash_values(const double *x, int dim)
{
	uint64_t h = 0x9e3779b97f4a7c15u;

	for (int k = 0; k < dim; k++) {
		/* -0 + 0 is +0 */
		double v = x[k] + 0.0;
		uint64_t bits;

		memcpy(&bits, &v, sizeof bits);
		h = mix(h, bits);
	}
	return h;
}

static bool
equal_values(const double *a, const double *b, int dim)
{
	for (int k = 0; k < dim; k++)
		if (a[k] != b[k])
			return false;
	return true;
}

/* A power of 2 of slots for n entries, at most half of them full. */
static int *
hash_slots(size_t n, size_t *mask, struct bake_err *err)
{
	size_t size = 16;
	int *slots;

	while (size < 2 * n)
		size *= 2;
	if ((slots = bake_alloc(size, sizeof *slots, err)) == NULL)
		return NULL;
	/* all -1 */
	memset(slots, 0xff, size * sizeof *slots);
	*mask = size - 1;
	return slots;
}

size_t
bake_mesh_first_equal(
    const double *values, size_t n, int dim, int *first, struct bake_err *err)
{
	size_t mask, ndifferent = 0;
	int *slots = hash_slots(n, &mask, err);

	if (slots == NULL)
		return 0;
	for (size_t i = 0; i < n; i++) {
		const double *x = values + i * (size_t)dim;
		size_t s = (size_t)hash_values(x, dim) & mask;

		while (slots[s] >= 0 &&
		       !equal_values(
			   x, values + (size_t)slots[s] * (size_t)dim, dim))
			s = (s + 1) & mask;
		if (slots[s] < 0) {
			slots[s] = (int)i;
			ndifferent++;
		}
		first[i] = slots[s];
	}
	free(slots);
	return ndifferent;
}

/* -- near positions ------------------------------------------------------ */

/* The representative of i, the lowest of its set; paths are halved. */
static int
find_set(int *parent, int i)
{
	while (parent[i] != i) {
		parent[i] = parent[parent[i]];
		i = parent[i];
	}
	return i;
}

static void
join_sets(int *parent, int a, int b)
{
	a = find_set(parent, a);
	b = find_set(parent, b);
	if (a < b)
		parent[b] = a;
	else
		parent[a] = b;
}

/*
 * A grid of cubes so small (side eps / sqrt 3, a little less) that all points
 * of one cube are within eps of each other. Points of two cubes can be only
 * where their indices differ by at most 2.
 */
struct cell {
	double at[3]; /* whole numbers; doubles hold what ints would not */
	int head;     /* its first point, the others by grid.next */
	double lo[3], hi[3];
};
struct grid {
	struct cell *cells;
	size_t ncells, mask;
	int *slots, *next;
};

static size_t
find_slot(const struct grid *g, const double at[3])
{
	size_t s = (size_t)hash_values(at, 3) & g->mask;

	while (
	    g->slots[s] >= 0 && !equal_values(at, g->cells[g->slots[s]].at, 3))
		s = (s + 1) & g->mask;
	return s;
}

static void
put_in_cell(struct grid *g, int *parent, int i, const double p[3], double side)
{
	double at[3];
	size_t s;
	struct cell *c;

	for (int k = 0; k < 3; k++)
		at[k] = floor(p[k] / side);
	s = find_slot(g, at);
	if (g->slots[s] < 0) {
		g->slots[s] = (int)g->ncells;
		c = &g->cells[g->ncells++];
		memcpy(c->at, at, sizeof c->at);
		memcpy(c->lo, p, sizeof c->lo);
		memcpy(c->hi, p, sizeof c->hi);
		c->head = -1;
	}
	c = &g->cells[g->slots[s]];
	for (int k = 0; k < 3; k++) {
		c->lo[k] = fmin(c->lo[k], p[k]);
		c->hi[k] = fmax(c->hi[k], p[k]);
	}
	if (c->head >= 0)
		join_sets(parent, c->head, i);
	g->next[i] = c->head;
	c->head = i;
}

static bool
boxes_near(const struct cell *a, const struct cell *b, double eps)
{
	double d2 = 0.0;

	for (int k = 0; k < 3; k++) {
		double d = fmax(a->lo[k] - b->hi[k], b->lo[k] - a->hi[k]);

		if (d > 0.0)
			d2 += d * d;
	}
	return d2 <= eps * eps;
}

/* Join the sets of two cells if any two of their points are near. */
static void
join_cells(const struct grid *g, int *parent, const double (*p)[3],
    const struct cell *a, const struct cell *b, double eps)
{
	if (find_set(parent, a->head) == find_set(parent, b->head) ||
	    !boxes_near(a, b, eps))
		return;
	for (int i = a->head; i >= 0; i = g->next[i])
		for (int j = b->head; j >= 0; j = g->next[j]) {
			double x = p[i][0] - p[j][0], y = p[i][1] - p[j][1],
			       z = p[i][2] - p[j][2];

			if (x * x + y * y + z * z > eps * eps)
				continue;
			join_sets(parent, i, j);
			return;
		}
}

static void
join_neighbours(
    const struct grid *g, int *parent, const double (*p)[3], double eps)
{
	for (size_t c = 0; c < g->ncells; c++) {
		const struct cell *a = &g->cells[c];

		/* each pair of cells once: the half of the 124 */
		for (int n = 63; n < 125; n++) {
			double at[3] = { a->at[0] + n % 5 - 2,
				a->at[1] + n / 5 % 5 - 2,
				a->at[2] + n / 25 - 2 };
			size_t s = find_slot(g, at);

			if (g->slots[s] >= 0)
				join_cells(g, parent, p, a,
				    &g->cells[g->slots[s]], eps);
		}
	}
}

/* first holds the exact weld on entry. */
static enum bake_status
weld_near(
    const struct bake_mesh *mesh, double eps, int *first, struct bake_err *err)
{
	const double(*p)[3] = (const double(*)[3])mesh->positions;
	size_t n = mesh->npositions;
	struct grid g = { NULL, 0, 0, NULL, NULL };
	enum bake_status rc = BAKE_ENOMEM;

	g.cells = bake_alloc(n, sizeof *g.cells, err);
	g.next = bake_alloc(n, sizeof *g.next, err);
	g.slots = hash_slots(n, &g.mask, err);
	if (g.cells == NULL || g.next == NULL || g.slots == NULL)
		goto out;
	for (size_t i = 0; i < n; i++)
		if (first[i] == (int)i)
			put_in_cell(&g, first, (int)i, p[i], eps * 0.577);
	join_neighbours(&g, first, p, eps);
	for (size_t i = 0; i < n; i++)
		first[i] = find_set(first, (int)i);
	rc = BAKE_OK;
out:
	free(g.cells);
	free(g.next);
	free(g.slots);
	return rc;
}

enum bake_status
bake_mesh_weld(const struct bake_mesh *mesh, double eps, struct bake_weld *weld,
    struct bake_err *err)
{
	size_t n = mesh->npositions;

	*weld = (struct bake_weld)BAKE_WELD_INIT;
	if (!(eps >= 0.0) || !isfinite(eps))
		return bake_fail(err, BAKE_EINVAL,
		    "welding distance %g, expected 0 or more", eps);
	if ((weld->first = bake_alloc(n, sizeof *weld->first, err)) == NULL)
		return BAKE_ENOMEM;
	weld->npositions = n;
	weld->npoints = bake_mesh_first_equal(
	    (const double *)mesh->positions, n, 3, weld->first, err);
	if ((weld->npoints == 0 && n > 0) ||
	    (eps > 0.0 && weld_near(mesh, eps, weld->first, err) != BAKE_OK)) {
		bake_weld_free(weld);
		return BAKE_ENOMEM;
	}
	weld->npoints = 0;
	for (size_t i = 0; i < n; i++)
		weld->npoints += weld->first[i] == (int)i;
	return BAKE_OK;
}

void
bake_weld_free(struct bake_weld *weld)
{
	free(weld->first);
	*weld = (struct bake_weld)BAKE_WELD_INIT;
}

/* -- what meets where ---------------------------------------------------- */

static int
point_of(const struct bake_weld *weld, int v)
{
	return weld != NULL ? weld->first[v] : v;
}

static bool
is_collapsed(const struct bake_mesh *mesh, const struct bake_weld *weld,
    size_t triangle, int p[3])
{
	for (int k = 0; k < 3; k++)
		p[k] = point_of(weld, mesh->triangles[triangle][k].v);
	return p[0] == p[1] || p[1] == p[2] || p[2] == p[0];
}

static enum bake_status
check_weld(const struct bake_mesh *mesh, const struct bake_weld *weld,
    struct bake_err *err)
{
	if (weld == NULL || weld->npositions == mesh->npositions)
		return BAKE_OK;
	return bake_fail(err, BAKE_EINVAL,
	    "a weld of %zu positions for a mesh of %zu", weld->npositions,
	    mesh->npositions);
}

enum bake_status
bake_mesh_adjacency(const struct bake_mesh *mesh, const struct bake_weld *weld,
    bool collapsed, struct bake_adjacency *adj, struct bake_err *err)
{
	size_t n = mesh->npositions;
	int p[3];
	enum bake_status rc;

	*adj = (struct bake_adjacency)BAKE_ADJACENCY_INIT;
	if ((rc = check_weld(mesh, weld, err)) != BAKE_OK)
		return rc;
	adj->start = bake_zalloc(n + 2, sizeof *adj->start, err);
	adj->corner =
	    bake_alloc(mesh->ntriangles, 3 * sizeof *adj->corner, err);
	if (adj->start == NULL || adj->corner == NULL) {
		bake_adjacency_free(adj);
		return BAKE_ENOMEM;
	}
	/* a counting sort: start[p + 2] counts, then start[p + 1] is where the
	 * next corner of p goes, and in the end where p + 1 begins */
	for (size_t t = 0; t < mesh->ntriangles; t++)
		if (!is_collapsed(mesh, weld, t, p) || collapsed)
			for (int k = 0; k < 3; k++)
				adj->start[(size_t)p[k] + 2]++;
	for (size_t i = 0; i < n; i++)
		adj->start[i + 2] += adj->start[i + 1];
	adj->ncorners = (size_t)adj->start[n + 1];
	for (size_t t = 0; t < mesh->ntriangles; t++)
		if (!is_collapsed(mesh, weld, t, p) || collapsed)
			for (int k = 0; k < 3; k++)
				adj->corner[adj->start[(size_t)p[k] + 1]++] =
				    (int)(3 * t) + k;
	adj->npositions = n;
	return BAKE_OK;
}

void
bake_adjacency_free(struct bake_adjacency *adj)
{
	free(adj->start);
	free(adj->corner);
	*adj = (struct bake_adjacency)BAKE_ADJACENCY_INIT;
}
