/* Percentiles by counting: exact, and the same for every thread count. */
/* SPDX-License-Identifier: MIT */
#include <omp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "parallel.h"
#include "roughen_priv.h"

enum { BINS = 65536, RANKS = 6 };

/* A float as an integer of the same order. */
static inline uint32_t
key_of(float v)
{
	uint32_t bits;

	memcpy(&bits, &v, sizeof bits);
	return bits ^ (bits >> 31 != 0 ? 0xffffffffu : 0x80000000u);
}

static float
value_of(uint32_t key)
{
	const uint32_t bits =
	    key ^ (key >> 31 != 0 ? 0x80000000u : 0xffffffffu);
	float v;

	memcpy(&v, &bits, sizeof v);
	return v;
}

/* Where percentile q of n values is: between rank and rank + 1. */
struct place {
	size_t rank;
	double frac;
};

static struct place
place_of(double q, size_t n)
{
	const double at = q * (double)(n - 1);
	struct place p = { (size_t)at, 0 };

	p.frac = at - (double)p.rank;
	return p;
}

static const double percentiles[3] = { 0.05, 0.5, 0.95 };

/* What is counted: how many keys have these upper halves, or, among those with
 * one of the given upper halves, these lower ones. */
struct count {
	const struct bake_image *lum;
	int ntops; /* 0: the upper halves */
	uint32_t top[RANKS];
	size_t *bins; /* [nthreads][max(1, ntops)][BINS] */
	int nthreads;
};

static void
count_row(const struct count *c, int y, size_t *bins)
{
	const float *row = bake_image_row(c->lum, y);

	for (int x = 0; x < c->lum->width; x++) {
		const uint32_t key = key_of(row[x]);

		if (c->ntops == 0)
			bins[key >> 16]++;
		for (int i = 0; i < c->ntops; i++)
			if (key >> 16 == c->top[i])
				bins[(size_t)i * BINS + (key & 0xffff)]++;
	}
}

/* Count, and add all threads' counts to the first's. */
static enum bake_status
count_all(struct count *c, struct bake_err *err)
{
	const size_t nbins = (size_t)(c->ntops > 0 ? c->ntops : 1) * BINS;

	c->bins =
	    bake_zalloc(nbins * (size_t)c->nthreads, sizeof *c->bins, err);
	if (c->bins == NULL)
		return BAKE_ENOMEM;
#pragma omp parallel for num_threads(c->nthreads) schedule(static)
	for (int y = 0; y < c->lum->height; y++)
		count_row(c, y, c->bins + nbins * (size_t)omp_get_thread_num());
	for (int t = 1; t < c->nthreads; t++)
		for (size_t i = 0; i < nbins; i++)
			c->bins[i] += c->bins[nbins * (size_t)t + i];
	return BAKE_OK;
}

/* The bin that rank is in; *rank becomes the rank within it. */
static uint32_t
find_bin(const size_t *bins, size_t *rank)
{
	uint32_t i = 0;

	while (i < BINS - 1 && *rank >= bins[i])
		*rank -= bins[i++];
	return i;
}

/* value[i]: the value of that rank. */
static enum bake_status
select_ranks(const struct bake_image *lum, int nthreads, size_t rank[RANKS],
    double value[RANKS], struct bake_err *err)
{
	struct count upper = { .lum = lum }, lower = { .lum = lum };
	int which[RANKS];
	enum bake_status rc;

	upper.nthreads = lower.nthreads = bake_threads(nthreads);
	if ((rc = count_all(&upper, err)) != BAKE_OK)
		goto out;
	for (int i = 0; i < RANKS; i++) {
		const uint32_t top = find_bin(upper.bins, &rank[i]);

		for (which[i] = 0; which[i] < lower.ntops; which[i]++)
			if (lower.top[which[i]] == top)
				break;
		lower.top[which[i]] = top;
		if (which[i] == lower.ntops)
			lower.ntops++;
	}
	if ((rc = count_all(&lower, err)) != BAKE_OK)
		goto out;
	for (int i = 0; i < RANKS; i++) {
		const size_t *bins = lower.bins + (size_t)which[i] * BINS;

		value[i] = value_of(
		    lower.top[which[i]] << 16 | find_bin(bins, &rank[i]));
	}
out:
	free(upper.bins);
	free(lower.bins);
	return rc;
}

static void
set_stats(struct bake_roughen_stats *stats, const double value[RANKS],
    const struct place place[3])
{
	double v[3];

	for (int i = 0; i < 3; i++)
		v[i] = value[2 * i] +
		       place[i].frac * (value[2 * i + 1] - value[2 * i]);
	stats->p05 = v[0];
	stats->p50 = v[1];
	stats->p95 = v[2];
}

enum bake_status
bake_roughen_measure(const struct bake_image *lum, int nthreads,
    struct bake_roughen_stats *stats, struct bake_err *err)
{
	const size_t n = (size_t)lum->width * (size_t)lum->height;
	struct place place[3];
	size_t rank[RANKS];
	double value[RANKS];
	enum bake_status rc;

	for (int i = 0; i < 3; i++) {
		place[i] = place_of(percentiles[i], n);
		rank[2 * i] = place[i].rank;
		rank[2 * i + 1] =
		    place[i].rank + 1 < n ? place[i].rank + 1 : n - 1;
	}
	rc = select_ranks(lum, nthreads, rank, value, err);
	if (rc == BAKE_OK)
		set_stats(stats, value, place);
	return rc;
}

void
bake_roughen_sorted_stats(
    const float *sorted, int n, struct bake_roughen_stats *stats)
{
	struct place place[3];
	double value[RANKS];

	for (int i = 0; i < 3; i++) {
		const size_t last = (size_t)n - 1;

		place[i] = place_of(percentiles[i], (size_t)n);
		value[2 * i] = sorted[place[i].rank];
		value[2 * i + 1] =
		    sorted[place[i].rank < last ? place[i].rank + 1 : last];
	}
	set_stats(stats, value, place);
}

/* -- sorting ----------------------------------------------------------------
 */

/* One pass of a radix sort, by 11 bits. */
static void
sort_pass(const uint32_t *from, uint32_t *to, size_t n, int shift)
{
	size_t start[2048] = { 0 }, sum = 0;

	for (size_t i = 0; i < n; i++)
		start[from[i] >> shift & 2047]++;
	for (int b = 0; b < 2048; b++) {
		const size_t count = start[b];

		start[b] = sum;
		sum += count;
	}
	for (size_t i = 0; i < n; i++)
		to[start[from[i] >> shift & 2047]++] = from[i];
}

static void
fill_keys(const struct bake_image *lum, uint32_t *key)
{
	for (int y = 0; y < lum->height; y++) {
		const float *row = bake_image_row(lum, y);

		for (int x = 0; x < lum->width; x++)
			*key++ = key_of(row[x]);
	}
}

float *
bake_roughen_quantiles(
    const struct bake_image *lum, int most, int *n, struct bake_err *err)
{
	const size_t all = (size_t)lum->width * (size_t)lum->height;
	uint32_t *a = bake_alloc(all, sizeof *a, err);
	uint32_t *b = bake_alloc(all, sizeof *b, err);
	float *values = NULL;

	*n = all < (size_t)most ? (int)all : most;
	if (a != NULL && b != NULL)
		values = bake_alloc((size_t)*n, sizeof *values, err);
	if (values != NULL) {
		fill_keys(lum, a);
		sort_pass(a, b, all, 0);
		sort_pass(b, a, all, 11);
		sort_pass(a, b, all, 22);
		/* the middles of n equal parts */
		for (int i = 0; i < *n; i++)
			values[i] = value_of(
			    b[(size_t)(((double)i + 0.5) * (double)all / *n)]);
	}
	free(a);
	free(b);
	return values;
}
