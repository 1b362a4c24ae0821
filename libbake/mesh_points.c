/* The points of a mesh, numbered, with their triangles and corners. */
/* SPDX-License-Identifier: MIT */
#include "mesh_points_priv.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"

/* A triangle of points, its corners as in the file; all 0 where two are one
 * point. */
struct triangle {
	unsigned p[3];
};

/*
 * All arrays are in one block, which can have large pages.
 *   one    steps of the curve, then the sorted triangles
 *   two    steps while they are sorted, then the triangles as they come, then
 *          the fit's room
 *   three  where the triangles of each point begin, then what the fit has seen
 */
struct scratch {
	void *one, *two, *three;
};

/* Fetch what the triangle needs that comes a little later in the file: in the
 * time of one from memory, many can come. */
static inline void
fetch_ahead(
    const struct bake_mesh *mesh, const struct bake_place *place, size_t t)
{
	enum { AHEAD = 16 };

	if (t + AHEAD < mesh->ntriangles)
		for (int k = 0; k < 3; k++)
			__builtin_prefetch(
			    &place[mesh->triangles[t + AHEAD][k].v], 1);
}

/* -- which positions ------------------------------------------------------ */

/* What each position is before there are numbers. */
static void
mark_used(const struct bake_mesh *mesh, const struct bake_weld *weld,
    struct bake_place *place)
{
	for (size_t v = 0; v < mesh->npositions; v++)
		place[v] = (struct bake_place){ -1, BAKE_PLACE_UNUSED };
	for (size_t t = 0; t < mesh->ntriangles; t++) {
		fetch_ahead(mesh, place, t);
		for (int k = 0; k < 3; k++) {
			const struct bake_corner *c = &mesh->triangles[t][k];
			struct bake_place *p = &place[c->v];
			int other =
			    p->frame == c->vt ? c->vt : BAKE_PLACE_SEVERAL;

			p->frame =
			    p->frame == BAKE_PLACE_UNUSED ? c->vt : other;
		}
	}
	for (size_t v = 0; v < mesh->npositions; v++)
		if (place[v].frame != BAKE_PLACE_UNUSED)
			place[weld != NULL ? (size_t)weld->first[v] : v].point =
			    0;
}

/* -- triangles ------------------------------------------------------------ */

static int
compare_pairs(const struct bake_frame_pair *a, const struct bake_corner *b)
{
	if (a->v != b->v)
		return a->v < b->v ? -1 : 1;
	return (a->vt > b->vt) - (a->vt < b->vt);
}

/* The frame of a corner whose position has several, by halving. */
static int
find_frame(const struct bake_frame_pair *pairs, size_t npairs, int frame,
    const struct bake_corner *c)
{
	size_t lo = (size_t)(-1 - frame), hi = npairs - 1;

	while (lo < hi) {
		size_t mid = lo + (hi - lo) / 2;

		if (compare_pairs(&pairs[mid], c) < 0)
			lo = mid + 1;
		else
			hi = mid;
	}
	return pairs[lo].frame;
}

/* The mesh's triangles by their points' numbers, and the frames of their
 * corners. */
static void
number_triangles(const struct bake_mesh *mesh, struct bake_points *pts,
    struct bake_frames *frames, const struct bake_frame_pair *pairs,
    size_t npairs, struct triangle *out)
{
	for (size_t t = 0; t < mesh->ntriangles; t++) {
		const struct bake_corner *c = mesh->triangles[t];
		unsigned p[3];

		fetch_ahead(mesh, pts->place, t);
		for (int k = 0; k < 3; k++) {
			const struct bake_place *place = &pts->place[c[k].v];

			p[k] = (unsigned)place->point;
			if (frames == NULL)
				continue;
			frames->frame_of[t][k] = place->frame >= 0
						     ? place->frame
						     : find_frame(pairs, npairs,
							   place->frame, &c[k]);
		}
		if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) {
			out[t] = (struct triangle){ { 0, 0, 0 } };
			continue;
		}
		out[t] = (struct triangle){ { p[0], p[1], p[2] } };
		pts->ntriangles++;
	}
}

static bool
comes_before(
    const struct bake_point_triangle *a, const struct bake_point_triangle *b)
{
	return a->p[1] < b->p[1] || (a->p[1] == b->p[1] && a->p[2] < b->p[2]);
}

static int
compare_triangles(const void *a, const void *b)
{
	const struct bake_point_triangle *t = a, *u = b;

	return comes_before(t, u) ? -1 : comes_before(u, t);
}

/* The order of triangles that share their lowest point. */
static void
sort_bucket(struct bake_point_triangle *t, size_t n)
{
	if (n > 16) {
		qsort(t, n, sizeof *t, compare_triangles);
		return;
	}
	for (size_t i = 1; i < n; i++) {
		struct bake_point_triangle x = t[i];
		size_t k = i;

		for (; k > 0 && comes_before(&x, &t[k - 1]); k--)
			t[k] = t[k - 1];
		t[k] = x;
	}
}

/* The lowest of three; without branches, for none could be foretold. */
static inline unsigned
lowest(const unsigned p[3])
{
	unsigned low = p[1] < p[0];

	return p[2] < p[low] ? 2 : low;
}

/* Sort them. start is scratch, [n + 1]. */
static void
sort_triangles(const struct triangle *in, size_t n, unsigned *start,
    struct bake_points *pts)
{
	enum { AHEAD = 16, FAR = 32 };

	memset(start, 0, (pts->n + 1) * sizeof *start);
	for (size_t t = 0; t < n; t++) {
		const unsigned *p = in[t].p;

		if (t + AHEAD < n)
			__builtin_prefetch(
			    &start[in[t + AHEAD].p[lowest(in[t + AHEAD].p)] +
				   1],
			    1);
		start[p[lowest(p)] + 1] += p[0] != p[1];
	}
	for (size_t i = 0; i < pts->n; i++)
		start[i + 1] += start[i];
	for (size_t t = 0; t < n; t++) {
		const unsigned *p = in[t].p;
		struct bake_point_triangle *to;
		unsigned first, second, third;

		if (t + FAR < n)
			__builtin_prefetch(
			    &start[in[t + FAR].p[lowest(in[t + FAR].p)]], 1);
		if (t + AHEAD < n) {
			const unsigned *a = in[t + AHEAD].p;

			__builtin_prefetch(
			    &pts->triangle[start[a[lowest(a)]]], 1);
		}
		if (p[0] == p[1])
			continue;
		first = lowest(p);
		second = first + 1 - 3 * (first == 2);
		third = second + 1 - 3 * (second == 2);
		to = &pts->triangle[start[p[first]]++];
		to->p[0] = p[first];
		to->p[1] = p[second];
		to->p[2] = p[third];
		to->corner = (unsigned)(4 * t) + first;
	}
	/* start[i] is now where the next bucket begins */
	for (size_t i = 0, begin = 0; i < pts->n; i++) {
		sort_bucket(pts->triangle + begin, start[i] - begin);
		begin = start[i];
	}
}

/* The corners at each point: a counting sort, as the adjacency's. */
static void
list_corners(struct bake_points *pts)
{
	unsigned *first = pts->first;

	memset(first, 0, (pts->n + 2) * sizeof *first);
	for (size_t t = 0; t < pts->ntriangles; t++)
		for (int k = 0; k < 3; k++)
			first[pts->triangle[t].p[k] + 2]++;
	for (size_t i = 0; i < pts->n; i++)
		first[i + 2] += first[i + 1];
	for (size_t t = 0; t < pts->ntriangles; t++)
		for (unsigned k = 0; k < 3; k++)
			pts->corner[first[pts->triangle[t].p[k] + 1]++] =
			    (unsigned)(4 * t) + k;
}

/* -- all together -----------------------------------------------------------
 */

/* The next part of the block, of count elements: counted where block is NULL.
 */
static void *
part(unsigned char *block, size_t *at, size_t count, size_t size)
{
	size_t begin = *at;

	*at += (count * size + BAKE_ALIGN - 1) / BAKE_ALIGN * BAKE_ALIGN;
	return block != NULL ? block + begin : NULL;
}

static size_t
larger(size_t a, size_t b)
{
	return a > b ? a : b;
}

/* Returns the size of the block. Counts of a mesh fit in int, so that the sum
 * fits in size_t. */
static size_t
lay_out(unsigned char *block, const struct bake_mesh *mesh,
    struct bake_points *pts, struct scratch *s)
{
	size_t n = mesh->npositions, ntriangles = mesh->ntriangles, at = 0;
	size_t steps = n * BAKE_POINTS_STEP;
	size_t sorted = ntriangles * sizeof *pts->triangle;
	size_t room = 6 * ntriangles * sizeof *pts->room;

	pts->place = part(block, &at, n, sizeof *pts->place);
	pts->point = part(block, &at, n + 1, sizeof *pts->point);
	s->one = part(block, &at, 1, larger(steps, sorted));
	s->two = part(block, &at, 1, larger(steps, room));
	s->three = part(block, &at, 2 * n + 1, sizeof *pts->seen);
	pts->first = part(block, &at, n + 2, sizeof *pts->first);
	pts->uv = part(block, &at, n, sizeof *pts->uv);
	pts->first_site = part(block, &at, n + 2, sizeof *pts->first_site);
	pts->site = part(block, &at, n, sizeof *pts->site);
	pts->corner = part(block, &at, 3 * ntriangles, sizeof *pts->corner);
	pts->triangle = s->one;
	pts->room = s->two;
	pts->seen = s->three;
	return at;
}

enum bake_status
bake_points_make(const struct bake_mesh *mesh, const struct bake_weld *weld,
    bool exact, struct bake_frames *frames, struct bake_points *pts,
    struct bake_err *err)
{
	struct scratch scratch;
	struct bake_frame_pair *pairs = NULL;
	size_t npairs = 0, size = lay_out(NULL, mesh, pts, &scratch);
	enum bake_status rc;

	if ((pts->block = bake_alloc(1, size, err)) == NULL)
		return BAKE_ENOMEM;
	lay_out(pts->block, mesh, pts, &scratch);
	mark_used(mesh, weld, pts->place);
	rc =
	    bake_points_number(mesh, exact, scratch.one, scratch.two, pts, err);
	if (rc != BAKE_OK)
		goto out;
	for (size_t v = 0; weld != NULL && v < mesh->npositions; v++)
		pts->place[v].point = pts->place[weld->first[v]].point;
	if (frames != NULL && (rc = bake_frames_number(mesh, pts, frames,
				   &pairs, &npairs, err)) != BAKE_OK)
		goto out;
	number_triangles(mesh, pts, frames, pairs, npairs, scratch.two);
	sort_triangles(scratch.two, mesh->ntriangles, scratch.three, pts);
	list_corners(pts);
out:
	free(pairs);
	return rc;
}

enum bake_status
bake_points_room_for_sites(const struct bake_mesh *mesh, size_t n,
    struct bake_points *pts, struct bake_err *err)
{
	memset(pts->first_site, 0, (pts->n + 2) * sizeof *pts->first_site);
	if (n <= mesh->npositions)
		return BAKE_OK;
	pts->site = pts->own_sites = bake_alloc(n, sizeof *pts->site, err);
	return pts->site != NULL ? BAKE_OK : BAKE_ENOMEM;
}

void
bake_points_free(struct bake_points *pts)
{
	const struct bake_points empty = BAKE_POINTS_INIT;

	free(pts->block);
	free(pts->own_sites);
	*pts = empty;
}
