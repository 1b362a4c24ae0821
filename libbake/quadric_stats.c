/* What a set of quadrics is like: ranges, ranks, residual percentiles. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "quadric.h"

const double bake_quadric_percentiles[BAKE_QUADRIC_NPERCENTILES] = { 50, 90, 99,
	99.9, 100 };

static int
compare_doubles(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void
widen(struct bake_quadric_stats *s, int field, double v)
{
	s->lo[field] = v < s->lo[field] ? v : s->lo[field];
	s->hi[field] = v > s->hi[field] ? v : s->hi[field];
}

static void
add(struct bake_quadric_stats *s, const struct bake_quadric *q)
{
	const double v[5] = { q->a, q->b, q->c, q->uvscale[0], q->uvscale[1] };

	for (int i = 0; i < 5; i++)
		widen(s, i, v[i]);
	if (q->rank >= 0 && q->rank < 10)
		s->rank[q->rank]++;
	s->grown += (q->flags & BAKE_QUADRIC_GROWN) != 0;
	s->lowered += (q->flags & BAKE_QUADRIC_LOWERED) != 0;
	s->boundary += (q->flags & BAKE_QUADRIC_BOUNDARY) != 0;
	s->crease += (q->flags & BAKE_QUADRIC_CREASE) != 0;
}

enum bake_status
bake_quadric_count(const struct bake_quadric *q, size_t n,
    struct bake_quadric_stats *stats, struct bake_err *err)
{
	double *residual = bake_alloc(n, sizeof *residual, err);

	memset(stats, 0, sizeof *stats);
	if (residual == NULL)
		return BAKE_ENOMEM;
	stats->n = n;
	for (int i = 0; i < 5 && n > 0; i++) {
		stats->lo[i] = INFINITY;
		stats->hi[i] = -INFINITY;
	}
	for (size_t i = 0; i < n; i++) {
		add(stats, &q[i]);
		residual[i] = q[i].residual;
	}
	qsort(residual, n, sizeof *residual, compare_doubles);
	for (int i = 0; i < BAKE_QUADRIC_NPERCENTILES && n > 0; i++) {
		/* in thousandths: 99.9 % of 1000 is 999, not a little more */
		size_t permille =
		    (size_t)(10 * bake_quadric_percentiles[i] + 0.5);
		size_t at =
		    n / 1000 * permille + (n % 1000 * permille + 999) / 1000;

		stats->residual[i] = residual[at - 1];
	}
	free(residual);
	return BAKE_OK;
}
