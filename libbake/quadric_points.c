/* The points of a mesh, numbered, and who is next to whom. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "mem.h"
#include "quadric_priv.h"

/*
 * All arrays are in one block: it costs a fault of the system for each page
 * of memory that is touched for the first time, which is as much as the fit
 * itself, but for large pages, and those need large blocks.
 *   one    places, then the sorted triangles
 *   two    places while they are sorted, then the triangles as they come,
 *          then the neighbours
 *   count  numbers of triangles and of corners
 *   seen   see is_closed_fan()
 */
struct scratch {
	void *one, *two;
	unsigned *count, (*seen)[2];
};

/* -- triangles ------------------------------------------------------------ */

/* A triangle of points, the lowest first. */
struct triangle {
	unsigned p[3];
};

static bool
comes_before(const struct triangle *a, const struct triangle *b)
{
	return a->p[1] < b->p[1] || (a->p[1] == b->p[1] && a->p[2] < b->p[2]);
}

static int
compare_triangles(const void *a, const void *b)
{
	const struct triangle *t = a, *u = b;

	return comes_before(t, u) ? -1 : comes_before(u, t);
}

/* The order of triangles that share their lowest point. */
static void
sort_bucket(struct triangle *t, size_t n)
{
	if (n > 16) {
		qsort(t, n, sizeof *t, compare_triangles);
		return;
	}
	for (size_t i = 1; i < n; i++) {
		struct triangle x = t[i];
		size_t k = i;

		for (; k > 0 && comes_before(&x, &t[k - 1]); k--)
			t[k] = t[k - 1];
		t[k] = x;
	}
}

/* The mesh's triangles by their points' numbers, without those that welding
 * collapsed. Returns how many. */
static size_t
number_triangles(
    const struct bake_mesh *mesh, const int *of, struct triangle *out)
{
	size_t n = 0;

	for (size_t t = 0; t < mesh->ntriangles; t++) {
		const struct bake_corner *c = mesh->triangles[t];
		unsigned a = (unsigned)of[c[0].v], b = (unsigned)of[c[1].v];
		unsigned d = (unsigned)of[c[2].v];
		int first = a < b ? (a < d ? 0 : 2) : (b < d ? 1 : 2);

		if (a == b || b == d || d == a)
			continue;
		out[n++] = first == 0   ? (struct triangle){ { a, b, d } }
			   : first == 1 ? (struct triangle){ { b, d, a } }
					: (struct triangle){ { d, a, b } };
	}
	return n;
}

/* Sort them; start is scratch, [npoints + 1]. */
static void
sort_triangles(const struct triangle *in, struct triangle *out, size_t n,
    unsigned *start, size_t npoints)
{
	memset(start, 0, (npoints + 1) * sizeof *start);
	for (size_t t = 0; t < n; t++)
		start[in[t].p[0] + 1]++;
	for (size_t i = 0; i < npoints; i++)
		start[i + 1] += start[i];
	for (size_t t = 0; t < n; t++)
		out[start[in[t].p[0]]++] = in[t];
	/* start[i] is now where the next bucket begins */
	for (size_t i = 0, begin = 0; i < npoints; i++) {
		sort_bucket(out + begin, start[i] - begin);
		begin = start[i];
	}
}

/* -- neighbours ----------------------------------------------------------- */

static int
compare_numbers(const void *a, const void *b)
{
	unsigned x = *(const unsigned *)a, y = *(const unsigned *)b;

	return (x > y) - (x < y);
}

/* Make the n neighbours, each named once for each triangle of its edge,
 * unique; returns how many are left. Any mesh, any number. */
static int
unique_neighbours(unsigned *around, int n, bool *boundary)
{
	int m = 0;

	qsort(around, (size_t)n, sizeof *around, compare_numbers);
	for (int i = 0, end; i < n; i = end) {
		for (end = i + 1; end < n && around[end] == around[i];)
			end++;
		if (end == i + 1)
			*boundary = true;
		around[m++] = around[i];
	}
	return m;
}

/* Each corner names the next point and the one before. Around an inner point
 * of a manifold the two lists hold the same points, each once. */
static bool
is_closed_fan(const unsigned *next, const unsigned *before, int n,
    unsigned point, unsigned (*seen)[2])
{
	bool closed = true;

	for (int k = 0; k < n; k++) {
		closed &= seen[next[k]][0] != point;
		seen[next[k]][0] = point;
	}
	for (int k = 0; k < n; k++) {
		closed &= (seen[before[k]][0] == point) &
			  (seen[before[k]][1] != point);
		seen[before[k]][1] = point;
	}
	return closed;
}

/* Count the corners at each point, and set where its list begins: two entries
 * a corner. */
static void
count_corners(struct bake_quadric_points *pts, const struct triangle *t,
    size_t n, unsigned *corners)
{
	unsigned sum = 0;

	memset(corners, 0, pts->n * sizeof *corners);
	for (size_t i = 0; i < n; i++)
		for (int k = 0; k < 3; k++)
			corners[t[i].p[k]]++;
	for (size_t i = 0; i < pts->n; i++) {
		pts->point[i].start = sum;
		sum += 2 * corners[i];
		corners[i] = 0;
	}
	pts->point[pts->n].start = sum;
}

static void
list_neighbours(struct bake_quadric_points *pts, const struct triangle *t,
    size_t n, unsigned *corners, unsigned (*seen)[2])
{
	struct bake_quadric_point *point = pts->point;
	unsigned end = 0;

	count_corners(pts, t, n, corners);
	for (size_t i = 0; i < n; i++)
		for (int k = 0; k < 3; k++) {
			unsigned p = t[i].p[k];
			unsigned at = point[p].start;
			unsigned half = (point[p + 1].start - at) / 2;

			at += corners[p]++;
			pts->around[at] = t[i].p[(k + 1) % 3];
			pts->around[at + half] = t[i].p[(k + 2) % 3];
		}
	memset(seen, 0xff, pts->n * sizeof *seen);
	for (size_t i = 0; i < pts->n; i++) {
		unsigned *around = pts->around + point[i].start;
		int count = (int)corners[i];
		bool boundary = false;

		if (!is_closed_fan(
			around, around + count, count, (unsigned)i, seen))
			count = unique_neighbours(around, 2 * count, &boundary);
		point[i].flags = boundary ? BAKE_QUADRIC_BOUNDARY : 0;
		/* close up; what follows begins behind this one's room */
		for (int k = 0; k < count; k++)
			pts->around[end + (unsigned)k] = around[k];
		point[i].start = end;
		end += (unsigned)count;
	}
	point[pts->n].start = end;
}

/* -- creases --------------------------------------------------------------- */

static void
normal_of(
    double out[3], const struct bake_quadric_point *p, const struct triangle *t)
{
	const double *a = p[t->p[0]].p, *b = p[t->p[1]].p;
	const double *c = p[t->p[2]].p;
	double e[3], f[3], length;

	for (int i = 0; i < 3; i++) {
		e[i] = b[i] - a[i];
		f[i] = c[i] - a[i];
	}
	out[0] = e[1] * f[2] - e[2] * f[1];
	out[1] = e[2] * f[0] - e[0] * f[2];
	out[2] = e[0] * f[1] - e[1] * f[0];
	length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
	for (int i = 0; i < 3; i++)
		out[i] = length > 0 ? out[i] / length : 0;
}

/* One side of an edge: the points at its ends, and the triangle. */
struct side {
	unsigned low, high;
	size_t triangle;
};

static int
compare_sides(const void *a, const void *b)
{
	const struct side *s = a, *t = b;

	if (s->low != t->low)
		return s->low < t->low ? -1 : 1;
	if (s->high != t->high)
		return s->high < t->high ? -1 : 1;
	return 0;
}

/* Mark the ends of edges whose triangles differ by more than 60 degrees; a
 * triangle without an area says nothing. */
static enum bake_status
find_creases(struct bake_quadric_points *pts, const struct triangle *t,
    size_t n, struct bake_err *err)
{
	const struct bake_quadric_point *p = pts->point;
	struct side *s = bake_alloc(3 * n, sizeof *s, err);
	double a[3], b[3];

	if (s == NULL)
		return BAKE_ENOMEM;
	for (size_t i = 0; i < 3 * n; i++) {
		unsigned from = t[i / 3].p[i % 3];
		unsigned to = t[i / 3].p[(i + 1) % 3];

		s[i].low = from < to ? from : to;
		s[i].high = from < to ? to : from;
		s[i].triangle = i / 3;
	}
	qsort(s, 3 * n, sizeof *s, compare_sides);
	for (size_t i = 0; i + 1 < 3 * n; i++) {
		double dot;

		if (compare_sides(&s[i], &s[i + 1]) != 0)
			continue;
		normal_of(a, p, &t[s[i].triangle]);
		normal_of(b, p, &t[s[i + 1].triangle]);
		dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
		if (dot >= 0.5 || (a[0] == 0 && a[1] == 0 && a[2] == 0) ||
		    (b[0] == 0 && b[1] == 0 && b[2] == 0))
			continue;
		pts->point[s[i].low].flags |= BAKE_QUADRIC_CREASE;
		pts->point[s[i].high].flags |= BAKE_QUADRIC_CREASE;
	}
	free(s);
	return BAKE_OK;
}

/* -- all together -----------------------------------------------------------
 */

static enum bake_status
connect(const struct bake_mesh *mesh, bool creases,
    const struct scratch *scratch, struct bake_quadric_points *pts,
    struct bake_err *err)
{
	struct triangle *t = scratch->two, *sorted = scratch->one;
	size_t n = number_triangles(mesh, pts->of, t);

	sort_triangles(t, sorted, n, scratch->count, pts->n);
	pts->around = scratch->two;
	list_neighbours(pts, sorted, n, scratch->count, scratch->seen);
	return creases && n > 0 ? find_creases(pts, sorted, n, err) : BAKE_OK;
}

/* of[v] = 0 for representatives of points that triangles use, else -1. */
static void
mark_used(const struct bake_mesh *mesh, const struct bake_weld *weld, int *of)
{
	memset(of, 0xff, mesh->npositions * sizeof *of);
	for (size_t t = 0; t < mesh->ntriangles; t++)
		for (int k = 0; k < 3; k++)
			of[mesh->triangles[t][k].v] = 0;
	/* first[v] <= v: it has been passed already */
	for (size_t v = 0; weld != NULL && v < mesh->npositions; v++)
		if (of[v] == 0 && (size_t)weld->first[v] != v) {
			of[weld->first[v]] = 0;
			of[v] = -1;
		}
}

/* The next part of the block, of count elements: counted where block is NULL.
 */
static void *
part(unsigned char *block, size_t *at, size_t count, size_t size)
{
	size_t begin = *at;

	*at += (count * size + BAKE_ALIGN - 1) / BAKE_ALIGN * BAKE_ALIGN;
	return block != NULL ? block + begin : NULL;
}

/* Returns the size of the block. Counts of a mesh fit in int, so that the sum
 * fits in size_t. */
static size_t
lay_out(unsigned char *block, const struct bake_mesh *mesh,
    struct bake_quadric_points *pts, struct scratch *s)
{
	size_t n = mesh->npositions, at = 0;
	size_t places = n * BAKE_QUADRIC_PLACE;
	size_t triangles = mesh->ntriangles * sizeof(struct triangle);
	size_t around = 6 * mesh->ntriangles * sizeof *pts->around;

	pts->of = part(block, &at, n, sizeof *pts->of);
	pts->point = part(block, &at, n + 1, sizeof *pts->point);
	s->one = part(block, &at, 1, places > triangles ? places : triangles);
	s->two = part(block, &at, 1, places > around ? places : around);
	s->count = part(block, &at, n + 1, sizeof *s->count);
	s->seen = part(block, &at, n, sizeof *s->seen);
	return at;
}

static enum bake_status
make_block(const struct bake_mesh *mesh, struct bake_quadric_points *pts,
    struct scratch *s, struct bake_err *err)
{
	size_t size = lay_out(NULL, mesh, pts, s);

	pts->block = bake_alloc(1, size, err);
	if (pts->block == NULL)
		return BAKE_ENOMEM;
#ifdef MADV_HUGEPAGE
	if (size >= (size_t)1 << 22) {
		size_t page = (size_t)sysconf(_SC_PAGESIZE);
		size_t skip = page - (uintptr_t)pts->block % page;

		/* a wish: it does not matter whether it is granted */
		(void)madvise((unsigned char *)pts->block + skip,
		    (size - skip) / page * page, MADV_HUGEPAGE);
	}
#endif
	lay_out(pts->block, mesh, pts, s);
	return BAKE_OK;
}

enum bake_status
bake_quadric_points(const struct bake_mesh *mesh, const struct bake_weld *weld,
    bool creases, struct bake_quadric_points *pts, struct bake_err *err)
{
	struct scratch scratch;
	enum bake_status rc = make_block(mesh, pts, &scratch, err);

	if (rc != BAKE_OK)
		goto out;
	mark_used(mesh, weld, pts->of);
	rc = bake_quadric_number(mesh, scratch.one, scratch.two, pts, err);
	if (rc != BAKE_OK)
		goto out;
	for (size_t v = 0; weld != NULL && v < mesh->npositions; v++)
		pts->of[v] = pts->of[weld->first[v]];
	rc = connect(mesh, creases, &scratch, pts, err);
out:
	if (rc != BAKE_OK)
		bake_quadric_points_free(pts);
	return rc;
}

void
bake_quadric_points_free(struct bake_quadric_points *pts)
{
	const struct bake_quadric_points empty = BAKE_QUADRIC_POINTS_INIT;

	free(pts->block);
	*pts = empty;
}
