/* Resampling: separable filters, toroidal or clamped, any channel count. */
/* SPDX-License-Identifier: MIT */
#include "resample.h"

#include <math.h>
#include <omp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

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

/* A row in double with t->max texels more at either end, as the border goes
 * on. */
static void
widen_row(double *buf, const float *src, int n, int nchans, int pad, bool clamp)
{
	const size_t nc = (size_t)nchans, row = (size_t)n * nc;
	double *p = buf;

	for (long i = -(long)pad; i < (long)n + pad; i++) {
		const float *s =
		    src + (size_t)bake_wrap_index(i, n, clamp) * nc;

		if (i == 0) {
			for (size_t k = 0; k < row; k++)
				*p++ = src[k];
			i = n - 1;
			continue;
		}
		for (size_t c = 0; c < nc; c++)
			*p++ = s[c];
	}
}

/* One row to t's texels; buf is the widened source. Sums do not begin from 0:
 * -0 and a lone tap of 1 keep their bits. */
static void
resample_row(
    float *dst, int width, int nchans, const struct taps *t, const double *buf)
{
	const size_t nc = (size_t)nchans, pad = (size_t)t->max;

	for (size_t x = 0; x < (size_t)width; x++) {
		const double *w = t->w + x * pad;
		const double *from =
		    buf + (size_t)((long)t->start[x] + t->max) * nc;

		for (size_t c = 0; c < nc; c++) {
			double acc = w[0] * from[c];

			for (int k = 1; k < t->count[x]; k++)
				acc += w[k] * from[(size_t)k * nc + c];
			*dst++ = (float)acc;
		}
	}
}

/* The same for 4 channels, side by side: the same sums in the same order. */
static void
resample_row4(float *dst, int width, const struct taps *t, const double *buf)
{
	for (size_t x = 0; x < (size_t)width; x++, dst += 4) {
		const double *w = t->w + x * (size_t)t->max;
		const double *from =
		    buf + (size_t)((long)t->start[x] + t->max) * 4;
		double a = w[0] * from[0], b = w[0] * from[1];
		double c = w[0] * from[2], d = w[0] * from[3];

		for (int k = 1; k < t->count[x]; k++) {
			from += 4;
			a += w[k] * from[0];
			b += w[k] * from[1];
			c += w[k] * from[2];
			d += w[k] * from[3];
		}
		dst[0] = (float)a;
		dst[1] = (float)b;
		dst[2] = (float)c;
		dst[3] = (float)d;
	}
}

/* Rows from[i] of the source to rows to[i] of dst; NULL: all, i to i. */
struct row_list {
	const int *from, *to;
	int n;
};

static enum bake_status
pass_rows(struct bake_image *dst, const struct bake_image *src,
    const struct row_list *list, const struct taps *t, bool clamp, int nt,
    struct bake_err *err)
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
	for (int i = 0; i < list->n; i++) {
		const int y = list->from != NULL ? list->from[i] : i;
		float *out =
		    bake_image_row(dst, list->to != NULL ? list->to[i] : i);
		double *p = buf + (size_t)omp_get_thread_num() * row;

		widen_row(p, bake_image_row(src, y), src->width, src->nchans,
		    t->max, clamp);
		if (src->nchans == 4)
			resample_row4(out, dst->width, t, p);
		else
			resample_row(out, dst->width, src->nchans, t, p);
	}
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

/* Rows of the result, from the source's rows brought to its width; where each
 * column is one texel of the source, from the source itself. */
struct bake_resampler {
	struct bake_image src; /* a view */
	struct bake_image mid; /* empty where columns are copies */
	struct taps tx, ty;
	struct bake_wrap wrap;
	int width, height;
	bool copies_u, copies_v;
	float *range; /* lowest [nchans], highest [nchans]; NULL: not clamped */
	int nthreads;
	/* where mid holds the rows of one window alone */
	int window_rows; /* of the result; 0: mid has all rows */
	int *slot;       /* [src.height]: the row's place in mid; -1: none */
	int *stamp;      /* [src.height]: the last window that needs it */
	int *held;       /* [mid.height]: the row in that place; -1: none */
	int *from, *to;  /* [mid.height]: what is to be made */
};

/* Whether each destination texel is one source texel. */
static bool
taps_copy(const struct taps *t, int n)
{
	for (int x = 0; x < n; x++)
		if (t->count[x] != 1 || t->w[(size_t)x * (size_t)t->max] != 1)
			return false;
	return true;
}

static enum bake_status
init_taps(struct bake_resampler *r, const struct bake_resample_params *p,
    struct bake_err *err)
{
	enum bake_status rc;

	rc = taps_init(&r->tx, r->width, r->src.width, p->step_u, p->offset_u,
	    p->filter, p->wrap.clamp_u, err);
	if (rc == BAKE_OK)
		rc = taps_init(&r->ty, r->height, r->src.height, p->step_v,
		    p->offset_v, p->filter, p->wrap.clamp_v, err);
	if (rc != BAKE_OK)
		return rc;
	r->copies_u = taps_copy(&r->tx, r->width);
	r->copies_v = taps_copy(&r->ty, r->height);
	return BAKE_OK;
}

/* The source's k-th row of those that row y of the result is made of. */
static int
source_row(const struct bake_resampler *r, int y, int k)
{
	return bake_wrap_index(
	    (long)r->ty.start[y] + k, r->src.height, r->wrap.clamp_v);
}

/* Stamp the rows that the window from row y on needs; returns how many. */
static int
stamp_rows(struct bake_resampler *r, int y, int stamp)
{
	const int end =
	    y + r->window_rows < r->height ? y + r->window_rows : r->height;
	int n = 0;

	for (; y < end; y++)
		for (int k = 0; k < r->ty.count[y]; k++) {
			int *at = &r->stamp[source_row(r, y, k)];

			n += *at != stamp;
			*at = stamp;
		}
	return n;
}

/* Room for the rows of the window that needs the most. */
static enum bake_status
alloc_window(struct bake_resampler *r, struct bake_err *err)
{
	const size_t h = (size_t)r->src.height;
	int most = 0;
	enum bake_status rc;

	r->slot = bake_alloc(h, sizeof *r->slot, err);
	r->stamp = bake_alloc(h, sizeof *r->stamp, err);
	if (r->slot == NULL || r->stamp == NULL)
		return BAKE_ENOMEM;
	for (size_t i = 0; i < h; i++)
		r->slot[i] = r->stamp[i] = -1;
	for (int y = 0; y < r->height; y += r->window_rows) {
		const int n = stamp_rows(r, y, y);

		most = n > most ? n : most;
	}
	for (size_t i = 0; i < h; i++)
		r->stamp[i] = -1;
	r->held = bake_alloc((size_t)most, sizeof *r->held, err);
	r->from = bake_alloc((size_t)most, sizeof *r->from, err);
	r->to = bake_alloc((size_t)most, sizeof *r->to, err);
	if (r->held == NULL || r->from == NULL || r->to == NULL)
		return BAKE_ENOMEM;
	rc = bake_image_alloc(&r->mid, r->width, most, r->src.nchans, err);
	for (int i = 0; rc == BAKE_OK && i < most; i++)
		r->held[i] = -1;
	return rc;
}

/* Give each row of the window a place that none of its other rows has; rows
 * that are there already stay. Returns how many are to be made. */
static int
place_rows(struct bake_resampler *r, int y)
{
	const int end =
	    y + r->window_rows < r->height ? y + r->window_rows : r->height;
	const int stamp = y;
	int n = 0, place = 0;

	stamp_rows(r, y, stamp);
	for (; y < end; y++)
		for (int k = 0; k < r->ty.count[y]; k++) {
			const int row = source_row(r, y, k);

			if (r->slot[row] >= 0)
				continue;
			while (r->held[place] >= 0 &&
			       r->stamp[r->held[place]] == stamp)
				place++;
			if (r->held[place] >= 0)
				r->slot[r->held[place]] = -1;
			r->held[place] = row;
			r->slot[row] = place;
			r->from[n] = row;
			r->to[n++] = place;
		}
	return n;
}

enum bake_status
bake_resampler_window(struct bake_resampler *r, int y, struct bake_err *err)
{
	struct row_list list = { r->from, r->to, 0 };

	if (r->copies_u || r->window_rows == 0)
		return BAKE_OK;
	list.n = place_rows(r, y);
	return pass_rows(
	    &r->mid, &r->src, &list, &r->tx, r->wrap.clamp_u, r->nthreads, err);
}

/* What does not depend on the row. */
static enum bake_status
prepare(struct bake_resampler *r, const struct bake_resample_params *p,
    struct bake_err *err)
{
	const struct bake_image *src = &r->src;
	const struct row_list all = { NULL, NULL, src->height };
	enum bake_status rc = init_taps(r, p, err);

	if (rc != BAKE_OK)
		return rc;
	if (!p->keep_overshoot && !(r->copies_u && r->copies_v)) {
		r->range =
		    bake_alloc((size_t)src->nchans, 2 * sizeof(float), err);
		if (r->range == NULL)
			return BAKE_ENOMEM;
		ranges(src, r->range, r->range + src->nchans);
	}
	if (r->copies_u)
		return BAKE_OK;
	if (r->window_rows > 0)
		return alloc_window(r, err);
	rc = bake_image_alloc(&r->mid, r->width, src->height, src->nchans, err);
	return rc != BAKE_OK ? rc
			     : pass_rows(&r->mid, src, &all, &r->tx,
				   p->wrap.clamp_u, r->nthreads, err);
}

enum bake_status
bake_resampler_open(struct bake_resampler **resampler,
    const struct bake_image *src, int width, int height,
    const struct bake_resample_params *params, struct bake_err *err)
{
	struct bake_resampler *r;
	enum bake_status rc;

	*resampler = NULL;
	if (src->data == NULL || width < 1 || height < 1)
		return bake_fail(err, BAKE_EINVAL,
		    "cannot resample %dx%d texels to %dx%d", src->width,
		    src->height, width, height);
	if ((unsigned)params->filter > BAKE_FILTER_BSPLINE)
		return bake_fail(
		    err, BAKE_EINVAL, "%d is no filter", (int)params->filter);
	r = bake_zalloc(1, sizeof *r, err);
	if (r == NULL)
		return BAKE_ENOMEM;
	r->src = *src;
	r->wrap = params->wrap;
	r->width = width;
	r->height = height;
	r->nthreads = bake_threads(params->nthreads);
	r->window_rows = params->window_rows > 0 ? params->window_rows : 0;
	rc = prepare(r, params, err);
	if (rc == BAKE_OK)
		*resampler = r;
	else
		bake_resampler_close(r);
	return rc;
}

void
bake_resampler_close(struct bake_resampler *r)
{
	if (r == NULL)
		return;
	bake_image_free(&r->mid);
	taps_free(&r->tx);
	taps_free(&r->ty);
	free(r->range);
	free(r->slot);
	free(r->stamp);
	free(r->held);
	free(r->from);
	free(r->to);
	free(r);
}

bool
bake_resampler_copies(const struct bake_resampler *r)
{
	return r->copies_u && r->copies_v;
}

/* One row of the source's width or the result's, in double. */
size_t
bake_resampler_scratch(const struct bake_resampler *r)
{
	const struct bake_image *from = r->copies_u ? &r->src : &r->mid;

	return (size_t)from->width * (size_t)from->nchans;
}

/* The texel of a row that column x of the result copies: on a torus start is
 * within the row. */
static size_t
column(const struct bake_resampler *r, int x)
{
	const int i = r->tx.start[x];

	return (size_t)(r->wrap.clamp_u ? bake_wrap_index(i, r->src.width, true)
					: i) *
	       (size_t)r->src.nchans;
}

/* Row i of what the columns pass left: of the source where they are copies. */
static const float *
wide_row(const struct bake_resampler *r, int i)
{
	if (r->copies_u)
		return bake_image_row(&r->src, i);
	return bake_image_row(&r->mid, r->slot != NULL ? r->slot[i] : i);
}

static void
sum_rows(const struct bake_resampler *r, int y, double *acc)
{
	const size_t row = bake_resampler_scratch(r);
	const struct taps *t = &r->ty;
	const double *w = t->w + (size_t)y * (size_t)t->max;

	for (int k = 0; k < t->count[y]; k++) {
		const float *s = wide_row(r, source_row(r, y, k));

		for (size_t i = 0; i < row; i++)
			acc[i] = k == 0 ? w[0] * s[i] : acc[i] + w[k] * s[i];
	}
}

void
bake_resampler_row(
    const struct bake_resampler *r, int y, float *row, double *scratch)
{
	const int nc = r->src.nchans, w = r->width;
	const float *s = wide_row(r, source_row(r, y, 0));

	if (!r->copies_v)
		sum_rows(r, y, scratch);
	if (r->copies_u)
		for (int x = 0; x < w; x++) {
			const size_t at = column(r, x);

			for (int c = 0; c < nc; c++)
				row[(size_t)x * (size_t)nc + (size_t)c] =
				    r->copies_v
					? s[at + (size_t)c]
					: (float)scratch[at + (size_t)c];
		}
	else if (r->copies_v)
		memcpy(row, s, (size_t)w * (size_t)nc * sizeof *row);
	else
		for (size_t i = 0; i < (size_t)w * (size_t)nc; i++)
			row[i] = (float)scratch[i];
	if (r->range != NULL)
		clamp_row(row, w, nc, r->range, r->range + nc);
}

int
bake_resample_window_rows(const struct bake_image *src, int width)
{
	const char *wish = getenv("BAKE_BAND_ROWS");
	const int rows = wish != NULL ? (int)strtol(wish, NULL, 10) : 0;
	const double bytes =
	    (double)width * src->height * src->nchans * sizeof(float);

	if (rows > 0)
		return rows;
	return bytes > BAKE_RESAMPLE_WHOLE ? 64 : 0;
}

static enum bake_status
make_rows(struct bake_resampler *r, struct bake_image *out, double *scratch,
    struct bake_err *err)
{
	const int step = r->window_rows > 0 ? r->window_rows : r->height;
	const size_t n = bake_resampler_scratch(r);
	enum bake_status rc = BAKE_OK;

	for (int y0 = 0; rc == BAKE_OK && y0 < r->height; y0 += step) {
		const int end = step < r->height - y0 ? y0 + step : r->height;

		rc = bake_resampler_window(r, y0, err);
		if (rc != BAKE_OK)
			break;
#pragma omp parallel for schedule(static) num_threads(r->nthreads)
		for (int y = y0; y < end; y++)
			bake_resampler_row(r, y, bake_image_row(out, y),
			    scratch + (size_t)omp_get_thread_num() * n);
	}
	return rc;
}

enum bake_status
bake_resample_mapped(const struct bake_image *src, int width, int height,
    const struct bake_resample_params *params, struct bake_image *dst,
    struct bake_err *err)
{
	struct bake_resample_params p = *params;
	struct bake_resampler *r;
	struct bake_image out = BAKE_IMAGE_INIT;
	double *scratch = NULL;
	enum bake_status rc;

	p.window_rows = bake_resample_window_rows(src, width);
	rc = bake_resampler_open(&r, src, width, height, &p, err);
	if (rc != BAKE_OK)
		return rc;
	rc = bake_image_alloc(&out, width, height, src->nchans, err);
	if (rc != BAKE_OK)
		goto out;
	scratch = bake_alloc(bake_resampler_scratch(r),
	    (size_t)r->nthreads * sizeof *scratch, err);
	if (scratch == NULL) {
		rc = BAKE_ENOMEM;
		goto out;
	}
	rc = make_rows(r, &out, scratch, err);
	if (rc == BAKE_OK)
		bake_image_swap(dst, &out);
out:
	free(scratch);
	bake_image_free(&out);
	bake_resampler_close(r);
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
