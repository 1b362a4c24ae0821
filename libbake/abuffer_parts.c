/* The A-buffer: parts of a mesh that are inside out. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>

#include "abuffer_priv.h"
#include "mem.h"

/* Less than this share of the sum of its parts is no volume. */
#define FLAT 1e-12

/* Triangle 'triangle' has the edge lo-hi of welded points, from hi to lo if
 * down. */
struct edge {
	int lo, hi;
	unsigned triangle : 31, down : 1;
};

/*
 * Triangles that belong together (Tarjan's union-find, with the parity of the
 * way to the root: whether its winding is the other way than the root's).
 * volume is six times the signed one of a root's set about the middle, absolute
 * the sum of the magnitudes it is the sum of.
 */
struct set {
	int up, rank;
	bool odd, mixed;
	size_t n, nodd;
	double middle[3];
	double volume, absolute;
};

static int
compare(const void *a, const void *b)
{
	const struct edge *e = a, *f = b;

	if (e->lo != f->lo)
		return e->lo < f->lo ? -1 : 1;
	if (e->hi != f->hi)
		return e->hi < f->hi ? -1 : 1;
	return (e->triangle > f->triangle) - (e->triangle < f->triangle);
}

static int
root_of(struct set *set, int i, bool *odd)
{
	int root = i;
	bool parity = false;

	for (; set[root].up != root; root = set[root].up)
		parity ^= set[root].odd;
	*odd = parity;
	while (set[i].up != root && i != root) {
		int up = set[i].up;
		bool own = set[i].odd;

		set[i].up = root;
		set[i].odd = parity;
		parity ^= own;
		i = up;
	}
	return root;
}

/* odd: one of the two is to be turned */
static void
unite(struct set *set, int a, int b, bool odd)
{
	bool odd_a, odd_b;

	a = root_of(set, a, &odd_a);
	b = root_of(set, b, &odd_b);
	if (a == b)
		return;
	if (set[a].rank < set[b].rank) {
		int t = a;

		a = b;
		b = t;
	}
	set[a].rank += set[a].rank == set[b].rank;
	set[b].up = a;
	set[b].odd = odd_a ^ odd_b ^ odd;
}

static void
reset(struct set *set, size_t n)
{
	for (size_t i = 0; i < n; i++)
		set[i] = (struct set){ .up = (int)i };
}

static inline int
point_of(const struct bake_mesh *mesh, const int *first, size_t t, int k)
{
	int v = mesh->triangles[t][k].v;

	return first != NULL ? first[v] : v;
}

/* All edges, those between the same points next to each other. */
static size_t
find_edges(const struct bake_mesh *mesh, const int *first, struct edge *edge)
{
	size_t n = 0;

	for (size_t t = 0; t < mesh->ntriangles; t++)
		for (int k = 0; k < 3; k++) {
			int a = point_of(mesh, first, t, k);
			int b = point_of(mesh, first, t, (k + 1) % 3);

			if (a != b)
				edge[n++] = (struct edge){ a < b ? a : b,
					a < b ? b : a, t & INT32_MAX, a > b };
		}
	qsort(edge, n, sizeof *edge, compare);
	return n;
}

static size_t
same_edge(const struct edge *edge, size_t begin, size_t n)
{
	size_t end = begin + 1;

	while (end < n && edge[end].lo == edge[begin].lo &&
	       edge[end].hi == edge[begin].hi)
		end++;
	return end;
}

/* Parts, and whether each is mixed: some edge of it is not used as often in the
 * one direction as in the other. part[t] is t's part. */
static void
find_parts(const struct edge *edge, size_t nedges, struct set *set, int *part,
    size_t n)
{
	bool odd;

	for (size_t i = 0, end; i < nedges; i = end) {
		end = same_edge(edge, i, nedges);
		for (size_t k = i + 1; k < end; k++)
			unite(set, (int)edge[i].triangle, (int)edge[k].triangle,
			    false);
	}
	for (size_t t = 0; t < n; t++)
		part[t] = root_of(set, (int)t, &odd);
	for (size_t i = 0, end; i < nedges; i = end) {
		long balance = 0;

		end = same_edge(edge, i, nedges);
		for (size_t k = i; k < end; k++)
			balance += edge[k].down ? 1 : -1;
		if (balance != 0)
			set[part[edge[i].triangle]].mixed = true;
	}
}

/* Where triangles' corners are on average. */
static void
find_middles(const struct bake_mesh *mesh, struct set *set, const int *part)
{
	for (size_t t = 0; t < mesh->ntriangles; t++) {
		struct set *s = &set[part[t]];

		s->n++;
		for (int k = 0; k < 3; k++)
			s->middle[k] +=
			    mesh->positions[mesh->triangles[t][0].v][k];
	}
	for (size_t t = 0; t < mesh->ntriangles; t++)
		for (int k = 0; set[t].n > 0 && k < 3; k++)
			set[t].middle[k] /= (double)set[t].n;
}

/* Pieces of one winding: whole parts that are not mixed. */
static void
find_pieces(const struct edge *edge, size_t nedges, const struct set *whole,
    const int *part, struct set *piece)
{
	for (size_t i = 0, end; i < nedges; i = end) {
		bool mixed = whole[part[edge[i].triangle]].mixed;

		end = same_edge(edge, i, nedges);
		if (mixed && end - i != 2)
			continue;
		for (size_t k = i + 1; k < end; k++)
			unite(piece, (int)edge[i].triangle,
			    (int)edge[k].triangle,
			    mixed && edge[i].down == edge[k].down);
	}
}

static double
volume_of(const struct bake_mesh *mesh, const int *first, size_t t,
    const double middle[3])
{
	double e[3][3];

	for (int k = 0; k < 3; k++)
		for (int c = 0; c < 3; c++)
			e[k][c] =
			    mesh->positions[point_of(mesh, first, t, k)][c] -
			    middle[c];
	return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
	       e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
	       e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

static void
turn_pieces(const struct bake_mesh *mesh, const int *first,
    const struct set *whole, const int *part, struct set *piece,
    unsigned char *turned)
{
	bool odd;

	for (size_t t = 0; t < mesh->ntriangles; t++) {
		struct set *s = &piece[root_of(piece, (int)t, &odd)];
		double v = volume_of(mesh, first, t, whole[part[t]].middle);

		s->volume += odd ? -v : v;
		s->absolute += fabs(v);
		s->n++;
		s->nodd += odd;
	}
	for (size_t t = 0; t < mesh->ntriangles; t++) {
		const struct set *s = &piece[root_of(piece, (int)t, &odd)];
		bool turn = s->volume < 0;

		/* what has no volume stays as most of it is */
		if (!(fabs(s->volume) > FLAT * s->absolute))
			turn = 2 * s->nodd > s->n;
		turned[t] = turn ^ odd;
	}
}

enum bake_status
bake_abuffer_turn(const struct bake_mesh *mesh, const int *first,
    unsigned char *turned, struct bake_err *err)
{
	const size_t n = mesh->ntriangles;
	enum bake_status rc = BAKE_ENOMEM;
	struct edge *edge = bake_alloc(3 * n, sizeof *edge, err);
	struct set *whole = bake_alloc(n, sizeof *whole, err);
	struct set *piece = bake_alloc(n, sizeof *piece, err);
	int *part = bake_alloc(n, sizeof *part, err);
	size_t nedges;

	if (edge == NULL || whole == NULL || piece == NULL || part == NULL)
		goto out;
	nedges = find_edges(mesh, first, edge);
	reset(whole, n);
	reset(piece, n);
	find_parts(edge, nedges, whole, part, n);
	find_middles(mesh, whole, part);
	find_pieces(edge, nedges, whole, part, piece);
	turn_pieces(mesh, first, whole, part, piece, turned);
	rc = BAKE_OK;
out:
	free(edge);
	free(whole);
	free(piece);
	free(part);
	return rc;
}
