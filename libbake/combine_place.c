/* Where a layer's texels lie in the result, row by row. */
/* SPDX-License-Identifier: MIT */
#include "combine_priv.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "mem.h"
#include "parallel.h"

/* -- placement --------------------------------------------------------------
 */

static bool
is_whole(double v)
{
	return v == floor(v);
}

/* Rounding in tile * size / size must not cost a copy its exactness. */
static double
snap(double v, double tolerance)
{
	const double whole = floor(v + 0.5);

	return fabs(v - whole) <= tolerance ? whole : v;
}

enum bake_status
bake_combine_place(const struct bake_combine_params *p,
    const struct bake_placement *at, const struct bake_image *map,
    struct bake_resample_params *r, struct bake_err *err)
{
	const struct bake_resample_params start = BAKE_RESAMPLE_PARAMS_DEFAULT;
	const double shift_u = at->offset_u - floor(at->offset_u);
	const double shift_v = at->offset_v - floor(at->offset_v);

	if (!(at->tile_u > 0) || !(at->tile_v > 0) || isinf(at->tile_u) ||
	    isinf(at->tile_v))
		return bake_fail(err, BAKE_EINVAL,
		    "a tile factor of %gx%g, expected numbers above 0",
		    at->tile_u, at->tile_v);
	if (!isfinite(shift_u) || !isfinite(shift_v))
		return bake_fail(err, BAKE_EINVAL,
		    "an offset of %g,%g, expected finite numbers", at->offset_u,
		    at->offset_v);
	*r = start;
	r->filter = p->filter;
	r->nthreads = p->nthreads;
	r->step_u = snap(at->tile_u * map->width / p->width, 1e-12);
	r->step_v = snap(at->tile_v * map->height / p->height, 1e-12);
	r->offset_u = -snap(shift_u * map->width, 1e-9);
	r->offset_v = snap(shift_v * map->height, 1e-9);
	r->wrap.clamp_u = p->wrap.clamp_u && at->tile_u == 1 && shift_u == 0;
	r->wrap.clamp_v = p->wrap.clamp_v && at->tile_v == 1 && shift_v == 0;
	return BAKE_OK;
}

bool
bake_combine_copies(const struct bake_resample_params *r)
{
	return r->step_u == 1 && r->step_v == 1 && is_whole(r->offset_u) &&
	       is_whole(r->offset_v) && r->filter != BAKE_FILTER_MITCHELL &&
	       r->filter != BAKE_FILTER_BSPLINE;
}

/* What the threads take turns in. */
struct turns {
	struct bake_resampler *r;
	const struct bake_row_sink *sink;
	size_t n, row; /* doubles, floats of one thread */
	double *scratch;
	float *rows;
	int nthreads;
};

static void
give_rows(const struct turns *t, int first, int end)
{
#pragma omp parallel for schedule(static) num_threads(t->nthreads)
	for (int y = first; y < end; y++) {
		const size_t i = (size_t)omp_get_thread_num();
		float *row = t->rows + i * t->row;

		bake_resampler_row(t->r, y, row, t->scratch + i * t->n);
		t->sink->take(t->sink->arg, y, row);
	}
}

enum bake_status
bake_combine_rows(const struct bake_combine_params *p,
    const struct bake_image *map, const struct bake_resample_params *how,
    const struct bake_row_sink *sink, struct bake_err *err)
{
	const int window = bake_resample_window_rows(map, p->width);
	const int step = window > 0 ? window : p->height;
	struct bake_resample_params in_windows = *how;
	struct turns t = { .sink = sink,
		.nthreads = bake_threads(p->nthreads) };
	enum bake_status rc;

	in_windows.window_rows = window;
	rc = bake_resampler_open(
	    &t.r, map, p->width, p->height, &in_windows, err);
	if (rc != BAKE_OK)
		return rc;
	t.n = bake_resampler_scratch(t.r);
	t.row = (size_t)p->width * (size_t)map->nchans;
	t.scratch = bake_alloc(t.n, (size_t)t.nthreads * sizeof(double), err);
	t.rows = bake_alloc(t.row, (size_t)t.nthreads * sizeof(float), err);
	if (t.scratch == NULL || t.rows == NULL)
		rc = BAKE_ENOMEM;
	for (int y = 0; rc == BAKE_OK && y < p->height;
	     y += step < p->height - y ? step : p->height - y) {
		rc = bake_resampler_window(t.r, y, err);
		if (rc == BAKE_OK)
			give_rows(
			    &t, y, step < p->height - y ? y + step : p->height);
	}
	free(t.rows);
	free(t.scratch);
	bake_resampler_close(t.r);
	return rc;
}

struct adding {
	struct bake_image *sum;
	double share;
	int from[4]; /* the map's channel for each of the sum's; -1: 1 */
	int nchans;  /* of the map */
};

static void
add_row(void *arg, int y, const float *row)
{
	const struct adding *a = arg;
	float *sum = bake_image_row(a->sum, y);

	for (int x = 0; x < a->sum->width; x++, row += a->nchans)
		for (int c = 0; c < a->sum->nchans; c++, sum++) {
			const double v = a->from[c] < 0 ? 1 : row[a->from[c]];

			*sum = (float)(*sum + a->share * v);
		}
}

enum bake_status
bake_combine_add_map(struct bake_image *sum, const struct bake_image *map,
    const struct bake_placement *at, double share,
    const struct bake_combine_params *params, struct bake_err *err)
{
	const bool grey = map->nchans < 3, alpha = map->nchans % 2 == 0;
	struct adding adding = { sum, share,
		{ 0, grey ? 0 : 1, grey ? 0 : 2, alpha ? map->nchans - 1 : -1 },
		map->nchans };
	const struct bake_row_sink sink = { add_row, &adding };
	struct bake_combine_params p = *params;
	struct bake_resample_params how;
	enum bake_status rc;

	if (map->data == NULL || map->nchans < 1 || map->nchans > 4 ||
	    (sum->nchans != 3 && sum->nchans != 4))
		return bake_fail(err, BAKE_EINVAL,
		    "a map of %d channels does not go into one of %d",
		    map->nchans, sum->nchans);
	if (!(share >= 0) || isinf(share))
		return bake_fail(err, BAKE_EINVAL,
		    "a share of %g, expected a number of at least 0", share);
	p.width = sum->width;
	p.height = sum->height;
	rc = bake_combine_place(&p, at, map, &how, err);
	return rc == BAKE_OK ? bake_combine_rows(&p, map, &how, &sink, err)
			     : rc;
}
