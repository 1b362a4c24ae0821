/* Resampling: separable filters, toroidal or clamped, any channel count. */
/* SPDX-License-Identifier: MIT */
#include "resample.h"

#include <math.h>
#include <omp.h>
#include <stdint.h>
#include <stdlib.h>

#include "mem.h"
#include "parallel.h"

static const double max_step = 1e8; /* taps are then still counted by int */

/*
 * What every destination texel x of one axis reads: count[x] source texels
 * from start[x] on, of weights w[x * max ...]. On a torus start is within the
 * source; clamped it may lie up to max texels before it, or just behind it.
 */
struct taps {
	int max;
	int *start, *count;
	double *w;
};

static void
taps_free(struct taps *t)
{
	free(t->start);
	free(t->count);
	free(t->w);
}

/* Mitchell and Netravali's cubic for t >= 0, their eq. 8. */
static double
cubic(double t, double b, double c)
{
	if (t < 1)
		return (((12 - 9 * b - 6 * c) * t + (-18 + 12 * b + 6 * c)) *
			       t * t +
			   6 - 2 * b) /
		       6;
	if (t < 2)
		return (((-b - 6 * c) * t + (6 * b + 30 * c)) * t * t +
			   (-12 * b - 48 * c) * t + (8 * b + 24 * c)) /
		       6;
	return 0;
}

static double
kernel(enum bake_filter filter, double t)
{
	t = fabs(t);
	switch (filter) {
	case BAKE_FILTER_TRIANGLE:
		return t < 1 ? 1 - t : 0;
	case BAKE_FILTER_MITCHELL:
		return cubic(t, 1.0 / 3, 1.0 / 3);
	case BAKE_FILTER_BSPLINE:
		return cubic(t, 1, 0);
	default:
		return cubic(t, 0, 0.5);
	}
}

/* Unnormalised weight of source texel i for a texel at c, by step. */
static double
weight(enum bake_filter filter, double i, double c, double step)
{
	double lo, hi;

	if (filter != BAKE_FILTER_BOX)
		return kernel(filter, (i - c) / (step > 1 ? step : 1));
	lo = fmax(i - 0.5, c - step / 2);
	hi = fmin(i + 0.5, c + step / 2);
	return hi > lo ? hi - lo : 0;
}

static double
reach(enum bake_filter filter, double step)
{
	const double m = step > 1 ? step : 1;

	if (filter == BAKE_FILTER_BOX)
		return step / 2 + 0.5;
	return filter == BAKE_FILTER_TRIANGLE ? m : 2 * m;
}

/* Into the source: the torus' first period, or just beyond a clamped end. */
static int
fold(int64_t start, int n, int max, bool clamp)
{
	if (clamp)
		return (int)(start < -max ? -max : start > n ? n : start);
	start %= n;
	return (int)(start < 0 ? start + n : start);
}

/* The taps of destination texel x at source position c; w has t->max. */
static void
taps_put(struct taps *t, int x, double c, double step, enum bake_filter filter,
    int n, bool clamp)
{
	const double r = reach(filter, step);
	double *w = t->w + (size_t)x * (size_t)t->max;
	int64_t i = (int64_t)ceil(c - r);
	const int64_t last = (int64_t)floor(c + r);
	double sum = 0;
	int count = 0;

	for (; i <= last && weight(filter, (double)i, c, step) == 0; i++)
		;
	for (int k = 0; i + k <= last && k < t->max; k++) {
		w[k] = weight(filter, (double)(i + k), c, step);
		sum += w[k];
		if (w[k] != 0)
			count = k + 1;
	}
	if (!(sum > 0)) { /* a step lost in c's rounding: the nearest texel */
		i = (int64_t)floor(c + 0.5);
		w[0] = sum = 1;
		count = 1;
	}
	for (int k = 0; k < count; k++)
		w[k] /= sum;
	t->count[x] = count;
	t->start[x] = fold(i, n, t->max, clamp);
}

static enum bake_status
taps_init(struct taps *t, int n_dst, int n_src, double step, double offset,
    enum bake_filter filter, bool clamp, struct bake_err *err)
{
	size_t count;

	*t = (struct taps){ 0 };
	if (step == 0)
		step = (double)n_src / n_dst;
	if (!(step > 0 && step <= max_step) || !(fabs(offset) <= max_step))
		return bake_fail(err, BAKE_EINVAL,
		    "resampling by a step of %g texels at offset %g, expected "
		    "at most %g",
		    step, offset, max_step);
	t->max = (int)(2 * reach(filter, step)) + 2;
	if (!bake_mul_size((size_t)n_dst, (size_t)t->max, &count))
		return bake_fail(err, BAKE_ENOMEM,
		    "the weights of %d texels by %d do not fit in memory",
		    n_dst, t->max);
	t->w = bake_alloc(count, sizeof *t->w, err);
	t->start = bake_alloc((size_t)n_dst, sizeof *t->start, err);
	t->count = bake_alloc((size_t)n_dst, sizeof *t->count, err);
	if (!t->w || !t->start || !t->count)
		return BAKE_ENOMEM;
	for (int x = 0; x < n_dst; x++)
		taps_put(t, x, (x + 0.5) * step + offset - 0.5, step, filter,
		    n_src, clamp);
	return BAKE_OK;
}

/* One row to t's texels. buf holds src's width + 2 t->max texels in double. */
static void
resample_row(float *dst, int width, const float *src, int n, int nchans,
    const struct taps *t, bool clamp, double *buf)
{
	const size_t nc = (size_t)nchans, pad = (size_t)t->max;
	double *p = buf;

	for (long i = -(long)t->max; i < (long)n + t->max; i++) {
		const float *s =
		    src + (size_t)bake_wrap_index(i, n, clamp) * nc;

		for (size_t c = 0; c < nc; c++)
			*p++ = s[c];
	}
	for (size_t x = 0; x < (size_t)width; x++) {
		const double *w = t->w + x * pad;
		const double *from =
		    buf + (size_t)((long)t->start[x] + t->max) * nc;

		for (size_t c = 0; c < nc; c++) {
			/* not from 0: -0 and a lone tap of 1 keep their bits */
			double acc = w[0] * from[c];

			for (int k = 1; k < t->count[x]; k++)
				acc += w[k] * from[(size_t)k * nc + c];
			*dst++ = (float)acc;
		}
	}
}

static enum bake_status
pass_rows(struct bake_image *dst, const struct bake_image *src,
    const struct taps *t, bool clamp, int nt, struct bake_err *err)
{
	size_t row;
	double *buf;

	if (!bake_mul_size((size_t)src->width + 2 * (size_t)t->max,
		(size_t)src->nchans, &row))
		return bake_fail(err, BAKE_ENOMEM,
		    "a row of %d texels does not fit in memory", src->width);
	buf = bake_alloc(row, (size_t)nt * sizeof *buf, err);
	if (buf == NULL)
		return BAKE_ENOMEM;
#pragma omp parallel for schedule(static) num_threads(nt)
	for (int y = 0; y < src->height; y++)
		resample_row(bake_image_row(dst, y), dst->width,
		    bake_image_row(src, y), src->width, src->nchans, t, clamp,
		    buf + (size_t)omp_get_thread_num() * row);
	free(buf);
	return BAKE_OK;
}

/* [nchans] lowest and highest values of the source's channels. */
static void
ranges(const struct bake_image *src, float *lo, float *hi)
{
	const int nc = src->nchans;

	for (int c = 0; c < nc; c++)
		lo[c] = hi[c] = src->data[c];
	for (int y = 0; y < src->height; y++) {
		const float *p = bake_image_row(src, y);

		for (int x = 0; x < src->width; x++)
			for (int c = 0; c < nc; c++, p++) {
				lo[c] = *p < lo[c] ? *p : lo[c];
				hi[c] = *p > hi[c] ? *p : hi[c];
			}
	}
}

static void
clamp_row(float *p, int width, int nchans, const float *lo, const float *hi)
{
	for (int x = 0; x < width; x++)
		for (int c = 0; c < nchans; c++, p++)
			*p = *p < lo[c] ? lo[c] : *p > hi[c] ? hi[c] : *p;
}

/* Columns of src to dst; range is lo[nchans], hi[nchans], or NULL. */
static enum bake_status
pass_columns(struct bake_image *dst, const struct bake_image *src,
    const struct taps *t, bool clamp, const float *range, int nt,
    struct bake_err *err)
{
	const size_t row = (size_t)src->width * (size_t)src->nchans;
	double *buf = bake_alloc(row, (size_t)nt * sizeof *buf, err);

	if (buf == NULL)
		return BAKE_ENOMEM;
#pragma omp parallel for schedule(static) num_threads(nt)
	for (int y = 0; y < dst->height; y++) {
		double *acc = buf + (size_t)omp_get_thread_num() * row;
		const double *w = t->w + (size_t)y * (size_t)t->max;
		float *d = bake_image_row(dst, y);

		for (int k = 0; k < t->count[y]; k++) {
			const float *s = bake_image_row(
			    src, bake_wrap_index((long)t->start[y] + k,
				     src->height, clamp));

			for (size_t i = 0; i < row; i++)
				acc[i] =
				    k == 0 ? w[0] * s[i] : acc[i] + w[k] * s[i];
		}
		for (size_t i = 0; i < row; i++)
			d[i] = (float)acc[i];
		if (range != NULL)
			clamp_row(d, dst->width, dst->nchans, range,
			    range + dst->nchans);
	}
	free(buf);
	return BAKE_OK;
}

enum bake_status
bake_resample_mapped(const struct bake_image *src, int width, int height,
    const struct bake_resample_params *params, struct bake_image *dst,
    struct bake_err *err)
{
	const int nt = bake_threads(params->nthreads);
	struct bake_image mid = BAKE_IMAGE_INIT, out = BAKE_IMAGE_INIT;
	struct taps tx = { 0 }, ty = { 0 };
	float *range = NULL;
	enum bake_status rc;

	if (src->data == NULL || width < 1 || height < 1)
		return bake_fail(err, BAKE_EINVAL,
		    "cannot resample %dx%d texels to %dx%d", src->width,
		    src->height, width, height);
	if ((unsigned)params->filter > BAKE_FILTER_BSPLINE)
		return bake_fail(
		    err, BAKE_EINVAL, "%d is no filter", (int)params->filter);
	if ((rc = taps_init(&tx, width, src->width, params->step_u,
		 params->offset_u, params->filter, params->wrap.clamp_u,
		 err)) != BAKE_OK ||
	    (rc = taps_init(&ty, height, src->height, params->step_v,
		 params->offset_v, params->filter, params->wrap.clamp_v,
		 err)) != BAKE_OK ||
	    (rc = bake_image_alloc(
		 &mid, width, src->height, src->nchans, err)) != BAKE_OK ||
	    (rc = bake_image_alloc(&out, width, height, src->nchans, err)) !=
		BAKE_OK)
		goto out;
	if (!params->keep_overshoot) {
		range = bake_alloc((size_t)src->nchans, 2 * sizeof *range, err);
		if (range == NULL) {
			rc = BAKE_ENOMEM;
			goto out;
		}
		ranges(src, range, range + src->nchans);
	}
	if ((rc = pass_rows(&mid, src, &tx, params->wrap.clamp_u, nt, err)) !=
		BAKE_OK ||
	    (rc = pass_columns(&out, &mid, &ty, params->wrap.clamp_v, range, nt,
		 err)) != BAKE_OK)
		goto out;
	bake_image_swap(dst, &out);
out:
	free(range);
	bake_image_free(&mid);
	bake_image_free(&out);
	taps_free(&tx);
	taps_free(&ty);
	return rc;
}

enum bake_status
bake_resample(const struct bake_image *src, struct bake_wrap wrap,
    enum bake_filter filter, int width, int height, int nthreads,
    struct bake_image *dst, struct bake_err *err)
{
	struct bake_resample_params params = BAKE_RESAMPLE_PARAMS_DEFAULT;

	params.wrap = wrap;
	params.filter = filter;
	params.nthreads = nthreads;
	return bake_resample_mapped(src, width, height, &params, dst, err);
}
