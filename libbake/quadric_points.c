/* Who is next to whom, and where a mesh is creased. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "quadric_priv.h"

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

static void
list_neighbours(struct bake_points *pts)
{
	unsigned(*seen)[2] = (unsigned(*)[2])pts->seen;
	unsigned end = 0;

	memset(seen, 0xff, pts->n * sizeof *seen);
	for (size_t i = 0; i < pts->n; i++) {
		const unsigned *corner = pts->corner + pts->first[i];
		int count = (int)(pts->first[i + 1] - pts->first[i]);
		unsigned *around = pts->room + end;
		bool boundary = false;

		/* what is behind the list is still free: two for each corner */
		for (int k = 0; k < count; k++) {
			const unsigned *p = pts->triangle[corner[k] / 4].p;
			unsigned c = corner[k] % 4;

			around[k] = p[c == 2 ? 0 : c + 1];
			around[count + k] = p[c == 0 ? 2 : c - 1];
		}
		if (!is_closed_fan(
			around, around + count, count, (unsigned)i, seen))
			count = unique_neighbours(around, 2 * count, &boundary);
		pts->point[i].flags = boundary ? BAKE_QUADRIC_BOUNDARY : 0;
		pts->point[i].start = end;
		end += (unsigned)count;
	}
	pts->point[pts->n].start = end;
}

/* -- creases --------------------------------------------------------------- */

static void
normal_of(double out[3], const struct bake_point *p,
    const struct bake_point_triangle *t)
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
find_creases(struct bake_points *pts, const struct bake_point_triangle *t,
    size_t n, struct bake_err *err)
{
	const struct bake_point *p = pts->point;
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

enum bake_status
bake_quadric_connect(
    struct bake_points *pts, bool creases, struct bake_err *err)
{
	list_neighbours(pts);
	return creases && pts->ntriangles > 0
		   ? find_creases(pts, pts->triangle, pts->ntriangles, err)
		   : BAKE_OK;
}
