/* Mip levels of multilayer textures by occupancy: threshold, and the level. */
/* SPDX-License-Identifier: MIT */
#include <omp.h>
#include <stdlib.h>

#include "layer_mip_priv.h"
#include "mem.h"
#include "parallel.h"

/* The failure of the first of the rows that failed. */
struct failure {
	int row;
	struct bake_err err;
};

static void
note_failure(struct failure *first, int row, const struct bake_err *err)
{
#pragma omp critical(bake_layer_mip_failure)
	if (first->err.code == BAKE_OK || row < first->row) {
		first->row = row;
		first->err = *err;
	}
}

/* -- the threshold --------------------------------------------------------- */

static enum bake_status
row_histogram(const struct bake_mip *m, struct bake_stack *s, int y,
    uint64_t *hist, uint64_t *volume, struct bake_err *err)
{
	for (int x = 0; x < m->out->width; x++) {
		if (bake_stack_gather(s, m->maps, bake_mip_box(m, x, y), err) !=
		    BAKE_OK)
			return BAKE_ENOMEM;
		*volume += bake_stack_histogram(s, hist);
	}
	return BAKE_OK;
}

/* Level 0's volume, and the threshold that keeps it. */
static enum bake_status
find_tau(struct bake_mip *m, int nt, uint64_t *volume, struct bake_err *err)
{
	enum { BINS = BAKE_TAU_ONE + 1 };
	uint64_t *hist = bake_zalloc((size_t)nt * BINS, sizeof *hist, err);
	struct failure first = { 0, BAKE_ERR_INIT };
	uint64_t sum = 0;

	if (hist == NULL)
		return BAKE_ENOMEM;
#pragma omp parallel num_threads(nt) reduction(+ : sum)
	{
		struct bake_stack s = { .n = 0 };
		uint64_t *own = hist + (size_t)omp_get_thread_num() * BINS;

#pragma omp for schedule(dynamic)
		for (int y = 0; y < m->out->height; y++) {
			struct bake_err e = BAKE_ERR_INIT;

			if (row_histogram(m, &s, y, own, &sum, &e) != BAKE_OK)
				note_failure(&first, y, &e);
		}
		bake_stack_free(&s);
	}
	for (int i = 1; i < nt; i++)
		for (size_t b = 0; b < BINS; b++)
			hist[b] += hist[(size_t)i * BINS + b];
	*volume = sum;
	m->t = bake_tau_choose(hist, sum);
	free(hist);
	return first.err.code == BAKE_OK
		   ? BAKE_OK
		   : bake_fail(err, first.err.code, "%s", first.err.msg);
}

/* What lies below a height field's surface. */
static uint64_t
height_volume(const struct bake_mip *m, int nt)
{
	const struct bake_layer_maps *maps = m->maps;
	const uint64_t whole =
	    bake_layer_place(bake_layer_none(m->format), m->format);
	uint64_t sum = 0;

#pragma omp parallel for schedule(static) num_threads(nt) reduction(+ : sum)
	for (int y = 0; y < maps->height; y++)
		for (int x = 0; x < maps->width; x++) {
			const size_t t =
			    (size_t)y * (size_t)maps->width + (size_t)x;
			uint32_t code[1];

			if (bake_layer_codes_of(maps, t, code) > 0)
				sum += whole -
				       bake_layer_place(code[0], m->format);
		}
	return sum;
}

/* -- the level ------------------------------------------------------------- */

static enum bake_status
make_rows(const struct bake_mip *m, int nt, uint64_t *volume, size_t *capped,
    struct bake_err *err)
{
	struct failure first = { 0, BAKE_ERR_INIT };
	uint64_t v = 0, c = 0;

#pragma omp parallel num_threads(nt) reduction(+ : v, c)
	{
		struct bake_mip_row row;
		struct bake_err none = BAKE_ERR_INIT;
		const bool ready =
		    bake_mip_row_alloc(&row, m, &none) == BAKE_OK;

#pragma omp for schedule(dynamic)
		for (int y = 0; y < m->out->height; y++) {
			struct bake_err e = none;

			if (!ready ||
			    bake_mip_row_make(&row, m, y, &e) != BAKE_OK)
				note_failure(&first, y, &e);
		}
		v += row.volume;
		c += row.capped;
		bake_mip_row_free(&row);
	}
	*volume = v;
	*capped = (size_t)c;
	return first.err.code == BAKE_OK
		   ? BAKE_OK
		   : bake_fail(err, first.err.code, "%s", first.err.msg);
}

static int
side_of(int size, int level)
{
	return level < 31 && size >> level > 0 ? size >> level : 1;
}

static enum bake_status
check(const struct bake_layer_maps *maps, int level,
    const struct bake_color *color, struct bake_err *err)
{
	if (level < 1)
		return bake_fail(err, BAKE_EINVAL,
		    "mip level %d, expected 1 or more", level);
	if (side_of(maps->width, level - 1) == 1 &&
	    side_of(maps->height, level - 1) == 1)
		return bake_fail(err, BAKE_EINVAL,
		    "mip level %d of %dx%d texels: level %d is 1x1 already",
		    level, maps->width, maps->height, level - 1);
	if (maps->ncolors == 0 || maps->color_linear)
		return BAKE_OK;
	if (color == NULL)
		return bake_fail(err, BAKE_EINVAL,
		    "encoded colours and no colour configuration");
	return bake_color_check(color, "sRGB", err);
}

enum bake_status
bake_layer_mip(const struct bake_layer_maps *maps, int level, bool half,
    const struct bake_color *color, int nthreads, struct bake_layer_maps *out,
    struct bake_layer_mip *mip, struct bake_err *err)
{
	struct bake_mip m = { maps, out, NULL, maps->depth[0].format,
		BAKE_TAU_ONE / 2 };
	const uint64_t one =
	    bake_layer_place(bake_layer_none(m.format), m.format);
	const double whole =
	    (double)maps->width * (double)maps->height * (double)one;
	uint64_t volume = 0, volume0 = 0;
	size_t capped = 0;
	enum bake_status rc = check(maps, level, color, err);

	if (rc != BAKE_OK)
		return rc;
	nthreads = bake_threads(nthreads);
	if (nthreads > side_of(maps->height, level))
		nthreads = side_of(maps->height, level);
	if (maps->ncolors > 0 && !maps->color_linear)
		m.color = color;
	rc = bake_layer_maps_alloc(out, side_of(maps->width, level),
	    side_of(maps->height, level), maps->nlayers, m.format,
	    maps->ncolors, maps->ncolors > 0 ? maps->color[0].nchans : 3,
	    maps->color[0].format, err);
	out->color_linear = maps->color_linear;
	if (rc == BAKE_OK && maps->nlayers == 1)
		volume0 = height_volume(&m, nthreads);
	else if (rc == BAKE_OK)
		rc = find_tau(&m, nthreads, &volume0, err);
	if (half)
		m.t = BAKE_TAU_ONE / 2;
	if (rc == BAKE_OK)
		rc = make_rows(&m, nthreads, &volume, &capped, err);
	if (rc != BAKE_OK)
		bake_layer_maps_free(out);
	if (mip != NULL && rc == BAKE_OK)
		*mip =
		    (struct bake_layer_mip){ (double)m.t / BAKE_TAU_ONE, capped,
			    (double)volume / whole, (double)volume0 / whole };
	return rc;
}
