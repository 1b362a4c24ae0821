/* The points of a mesh along a Morton curve. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh_points_priv.h"

/* A point's place on the curve: the bits of its cell of a 2^16 cube grid,
 * interleaved. */
struct step {
	uint64_t key;
	int position;
};

/* how far ahead memory is fetched that lies in the file's order */
enum { AHEAD = 16 };
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

/* Radix sort of n steps, in an even number of passes between the two arrays:
 * the result is in steps again. Stable, so that equal keys stay in the order
 * of positions until their ties are broken. */
static void
sort_steps(
    struct step *steps, struct step *tmp, size_t n, unsigned (*count)[DIGIT])
{
	struct step *from = steps, *to = tmp;

	memset(count, 0, DIGITS * sizeof *count);
	for (size_t i = 0; i < n; i++)
		for (int d = 0; d < DIGITS; d++)
			count[d]
			     [steps[i].key >> d * DIGIT_BITS & (DIGIT - 1)]++;
	for (int d = 0; d < DIGITS; d++) {
		unsigned sum = 0;
		struct step *swap = from;

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
	struct step step;
};

/* By coordinates, which no two points share unless nothing was welded. */
static int
compare_ties(const void *a, const void *b)
{
	const struct tie *s = a, *t = b;

	for (int i = 0; i < 3; i++)
		if (s->p[i] != t->p[i])
			return s->p[i] < t->p[i] ? -1 : 1;
	return (s->step.position > t->step.position) -
	       (s->step.position < t->step.position);
}

/* Order each run of equal keys. */
static enum bake_status
break_ties(struct step *steps, size_t n, const double (*positions)[3],
    struct bake_err *err)
{
	for (size_t i = 0, end; i < n; i = end) {
		struct tie *run;

		for (end = i + 1; end < n && steps[end].key == steps[i].key;)
			end++;
		if (end == i + 1)
			continue;
		run = bake_alloc(end - i, sizeof *run, err);
		if (run == NULL)
			return BAKE_ENOMEM;
		for (size_t k = i; k < end; k++) {
			run[k - i].step = steps[k];
			memcpy(run[k - i].p, positions[steps[k].position],
			    sizeof run->p);
		}
		qsort(run, end - i, sizeof *run, compare_ties);
		for (size_t k = i; k < end; k++)
			steps[k] = run[k - i].step;
		free(run);
	}
	return BAKE_OK;
}

struct box {
	double lo[3];  /* halved */
	double extent; /* the largest half side */
};

/* The box of the positions to be numbered. */
static enum bake_status
find_box(const struct bake_mesh *mesh, const struct bake_place *place,
    struct box *box, struct bake_err *err)
{
	double hi[3];
	size_t n = 0;

	for (int c = 0; c < 3; c++) {
		box->lo[c] = INFINITY;
		hi[c] = -INFINITY;
	}
	for (size_t v = 0; v < mesh->npositions; v++) {
		const double *p = mesh->positions[v];

		if (place[v].point < 0)
			continue;
		n++;
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
	for (int c = 0; c < 3 && n > 0; c++) {
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

static bool
is_same_point(const double a[3], const double b[3])
{
	return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Give numbers along the curve; with exact, one to equal positions, which
 * breaking ties has put next to each other, the first of the file in front. */
static void
give_numbers(const struct bake_mesh *mesh, bool exact, const struct step *steps,
    size_t n, struct bake_points *pts)
{
	const double *last = NULL;

	pts->n = 0;
	for (size_t i = 0; i < n; i++) {
		const double *p = mesh->positions[steps[i].position];
		struct bake_point *to = &pts->point[pts->n];

		if (i + AHEAD < n)
			__builtin_prefetch(
			    mesh->positions[steps[i + AHEAD].position]);
		if (exact && last != NULL && is_same_point(p, last)) {
			pts->place[steps[i].position].point = (int)pts->n - 1;
			continue;
		}
		last = p;
		pts->place[steps[i].position].point = (int)pts->n++;
		for (int c = 0; c < 3; c++)
			to->p[c] = p[c] * pts->scale;
	}
}

/* Number the points along the curve. */
static enum bake_status
number_points(const struct bake_mesh *mesh, bool exact, const struct box *box,
    struct step *steps, struct step *tmp, struct bake_points *pts,
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
		if (pts->place[v].point < 0)
			continue;
		steps[n].key = key_of(mesh->positions[v], box, cells);
		steps[n++].position = (int)v;
	}
	sort_steps(steps, tmp, n, count);
	rc = break_ties(steps, n, (const double(*)[3])mesh->positions, err);
	if (rc == BAKE_OK)
		give_numbers(mesh, exact, steps, n, pts);
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
bake_points_number(const struct bake_mesh *mesh, bool exact, void *one,
    void *two, struct bake_points *pts, struct bake_err *err)
{
	struct box box = { { 0, 0, 0 }, 0 };
	enum bake_status rc = find_box(mesh, pts->place, &box, err);

	_Static_assert(sizeof(struct step) <= BAKE_POINTS_STEP, "steps");
	if (rc != BAKE_OK)
		return rc;
	pts->scale = scale_of(box.extent);
	return number_points(mesh, exact, &box, one, two, pts, err);
}
