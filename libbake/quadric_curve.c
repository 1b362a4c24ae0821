/* The points of a mesh along a Morton curve. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "quadric_priv.h"

/* A point's place on the curve: the bits of its cell of a 2^16 cube grid,
 * interleaved. */
struct place {
	uint64_t key;
	int position;
};

enum { CELL_BITS = 16, DIGIT_BITS = 12, DIGITS = 4, DIGIT = 1 << DIGIT_BITS };

/* the 16 bits of v, two apart */
static uint64_t
spread(uint64_t v)
{
	v = (v | v << 16) & 0x0000ff0000ffu;
	v = (v | v << 8) & 0x00f00f00f00fu;
	v = (v | v << 4) & 0x0c30c30c30c3u;
	return (v | v << 2) & 0x249249249249u;
}

/* Radix sort of n places, in an even number of passes between the two arrays:
 * the result is in places again. Stable, so that equal keys stay in the order
 * of positions until their ties are broken. */
static void
sort_places(
    struct place *places, struct place *tmp, size_t n, unsigned (*count)[DIGIT])
{
	struct place *from = places, *to = tmp;

	memset(count, 0, DIGITS * sizeof *count);
	for (size_t i = 0; i < n; i++)
		for (int d = 0; d < DIGITS; d++)
			count[d]
			     [places[i].key >> d * DIGIT_BITS & (DIGIT - 1)]++;
	for (int d = 0; d < DIGITS; d++) {
		unsigned sum = 0;
		struct place *swap = from;

		for (int v = 0; v < DIGIT; v++) {
			unsigned c = count[d][v];

			count[d][v] = sum;
			sum += c;
		}
		for (size_t i = 0; i < n; i++)
			to[count[d][from[i].key >> d * DIGIT_BITS &
				    (DIGIT - 1)]++] = from[i];
		from = to;
		to = swap;
	}
}

/* A point while ties are broken. */
struct tie {
	double p[3];
	struct place place;
};

/* By coordinates, which no two points share unless nothing was welded. */
static int
compare_ties(const void *a, const void *b)
{
	const struct tie *s = a, *t = b;

	for (int i = 0; i < 3; i++)
		if (s->p[i] != t->p[i])
			return s->p[i] < t->p[i] ? -1 : 1;
	return (s->place.position > t->place.position) -
	       (s->place.position < t->place.position);
}

/* Order each run of equal keys. */
static enum bake_status
break_ties(struct place *places, size_t n, const double (*positions)[3],
    struct bake_err *err)
{
	for (size_t i = 0, end; i < n; i = end) {
		struct tie *run;

		for (end = i + 1; end < n && places[end].key == places[i].key;)
			end++;
		if (end == i + 1)
			continue;
		run = bake_alloc(end - i, sizeof *run, err);
		if (run == NULL)
			return BAKE_ENOMEM;
		for (size_t k = i; k < end; k++) {
			run[k - i].place = places[k];
			memcpy(run[k - i].p, positions[places[k].position],
			    sizeof run->p);
		}
		qsort(run, end - i, sizeof *run, compare_ties);
		for (size_t k = i; k < end; k++)
			places[k] = run[k - i].place;
		free(run);
	}
	return BAKE_OK;
}

struct box {
	double lo[3];  /* halved */
	double extent; /* the largest half side */
};

/* Count the points that triangles use, and find their box. */
static enum bake_status
find_points(const struct bake_mesh *mesh, struct bake_quadric_points *pts,
    struct box *box, struct bake_err *err)
{
	double hi[3];

	for (int c = 0; c < 3; c++) {
		box->lo[c] = INFINITY;
		hi[c] = -INFINITY;
	}
	for (size_t v = 0; v < mesh->npositions; v++) {
		const double *p = mesh->positions[v];

		if (pts->of[v] < 0)
			continue;
		pts->n++;
		for (int c = 0; c < 3; c++) {
			if (!isfinite(p[c]))
				return bake_fail(err, BAKE_EDATA,
				    "position %zu is not finite", v);
			/* fmin() and fmax() are calls */
			box->lo[c] = p[c] < box->lo[c] ? p[c] : box->lo[c];
			hi[c] = p[c] > hi[c] ? p[c] : hi[c];
		}
	}
	box->extent = 0;
	for (int c = 0; c < 3 && pts->n > 0; c++) {
		box->lo[c] /= 2;
		hi[c] = hi[c] / 2 - box->lo[c];
		box->extent = hi[c] > box->extent ? hi[c] : box->extent;
	}
	return BAKE_OK;
}

static uint64_t
key_of(const double p[3], const struct box *box, double cells)
{
	uint64_t key = 0;

	for (int c = 0; c < 3; c++)
		key |= spread((uint64_t)((p[c] / 2 - box->lo[c]) * cells)) << c;
	return key;
}

/* Number the points along the curve. */
static enum bake_status
number_points(const struct bake_mesh *mesh, const struct box *box,
    struct place *places, struct place *tmp, struct bake_quadric_points *pts,
    struct bake_err *err)
{
	unsigned(*count)[DIGIT] = bake_alloc(DIGITS, sizeof *count, err);
	/* cells per half length; a box too small for that has one cell */
	double cells = ((1 << CELL_BITS) - 1) / box->extent;
	enum bake_status rc;
	size_t n = 0;

	if (!(cells < 1e300))
		cells = 0;
	if (count == NULL)
		return BAKE_ENOMEM;
	for (size_t v = 0; v < mesh->npositions; v++) {
		if (pts->of[v] < 0)
			continue;
		places[n].key = key_of(mesh->positions[v], box, cells);
		places[n++].position = (int)v;
	}
	sort_places(places, tmp, n, count);
	if ((rc = break_ties(places, n, (const double(*)[3])mesh->positions,
		 err)) != BAKE_OK)
		goto out;
	for (size_t i = 0; i < n; i++) {
		const double *p = mesh->positions[places[i].position];

		pts->of[places[i].position] = (int)i;
		for (int c = 0; c < 3; c++)
			pts->point[i].p[c] = p[c] * pts->scale;
	}
out:
	free(count);
	return rc;
}

/* The power of two that brings the box's larger half side to 0.25 .. 0.5; 1
 * where there is no extent or the power would not be a normal number. */
static double
scale_of(double extent)
{
	int e;

	frexp(extent, &e);
	return extent > 0 && e > -1000 && e < 1000 ? ldexp(1, -e - 1) : 1;
}

enum bake_status
bake_quadric_number(const struct bake_mesh *mesh, void *one, void *two,
    struct bake_quadric_points *pts, struct bake_err *err)
{
	struct box box = { { 0, 0, 0 }, 0 };
	enum bake_status rc = find_points(mesh, pts, &box, err);

	_Static_assert(sizeof(struct place) <= BAKE_QUADRIC_PLACE, "places");
	if (rc != BAKE_OK)
		return rc;
	pts->scale = scale_of(box.extent);
	return number_points(mesh, &box, one, two, pts, err);
}
