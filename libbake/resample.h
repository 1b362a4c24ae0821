/* Resampling: separable filters, toroidal or clamped, any channel count. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_RESAMPLE_H
#define BAKE_RESAMPLE_H

#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Kernels k(t), t in source texels; all sum to 1 over t + integers.
 *   BOX          the mean over the destination texel's footprint, by area:
 *                nearest texel where magnified
 *   TRIANGLE     1 - |t| on |t| < 1: linear interpolation
 *   CATMULL_ROM  cubic with B = 0, C = 1/2 on |t| < 2: interpolates, so equal
 *                size is the identity; may overshoot
 *   MITCHELL     cubic with B = C = 1/3: a slight blur, little overshoot
 *   BSPLINE      cubic with B = 1, C = 0: a blur, no overshoot, twice
 *                continuously differentiable
 */
enum bake_filter {
	BAKE_FILTER_CATMULL_ROM, /* the default */
	BAKE_FILTER_BOX,
	BAKE_FILTER_TRIANGLE,
	BAKE_FILTER_MITCHELL,
	BAKE_FILTER_BSPLINE
};

/*
 * Which source position a destination texel shows, one axis each:
 *     source = (x + 0.5) * step + offset - 0.5
 * in texels whose centres are whole numbers. A layer of W texels tiled f times
 * over w texels has step = f W / w; offset is in source texels.
 */
struct bake_resample_params {
	struct bake_wrap wrap;
	enum bake_filter filter;
	double step_u, step_v;     /* > 0; 0: source size / destination size */
	double offset_u, offset_v; /* finite */
	bool keep_overshoot;       /* do not clamp to the source's range */
	int nthreads;              /* 0 = all processors */
	int window_rows;           /* see bake_resampler_window; 0: all rows */
};
#define BAKE_RESAMPLE_PARAMS_DEFAULT                                           \
	{                                                                      \
		{ false, false }, BAKE_FILTER_CATMULL_ROM, 0, 0, 0, 0, false,  \
		    0, 0                                                       \
	}

/*
 * Resample an image to width x height texels. Along each axis
 *     dst(x) = sum_i k((i - c) / m) src(i) / sum_i k((i - c) / m)
 * with c the source position of texel x and m = max(step, 1): minified, the
 * kernel is widened by the ratio, so that nothing aliases. Rows first, then
 * columns, both summed in double in ascending order of i; float between.
 *
 * - A constant image keeps its bits.
 * - Equal size (step 1, offset whole) keeps every bit with CATMULL_ROM,
 *   TRIANGLE and BOX.
 * - On a torus, reduction by a whole factor keeps the mean (BOX: any ratio).
 * - Each channel is clamped to its range in the source unless keep_overshoot
 *   is set (then the mean is kept without exception): depth stays in 0..1.
 *   Normals come out shorter than 1: bake_normal_normalize them.
 *
 *   src            any size and channel count, finite; not modified
 *   width, height  of the result, texels
 *   dst            out: [height][width], src's channels; BAKE_IMAGE_INIT
 *                  before, the caller frees it
 *   params         never NULL
 *   err            reason on failure; never NULL
 *
 * BAKE_EINVAL  a size below 1, an unknown filter, a step below 0, or a step
 *              or offset that is not finite or beyond 1e8
 * BAKE_ENOMEM  scratch memory: a float image of width x src->height, or where
 *              that has more than BAKE_RESAMPLE_WHOLE bytes what 64 rows of the
 *              result need of it, and the tables of weights (a destination
 *              texel's reach, 8 bytes each);
 *              on any failure dst stays BAKE_IMAGE_INIT
 *
 * Reentrant. Same bytes for every thread count.
 * Source: Mitchell and Netravali, 'Reconstruction filters in computer
 * graphics', SIGGRAPH 1988, eq. 8 for the cubics.
 */
BAKE_API enum bake_status bake_resample_mapped(const struct bake_image *src,
    int width, int height, const struct bake_resample_params *params,
    struct bake_image *dst, struct bake_err *err);

/* bake_resample_mapped of the whole image to width x height. */
BAKE_API enum bake_status bake_resample(const struct bake_image *src,
    struct bake_wrap wrap, enum bake_filter filter, int width, int height,
    int nthreads, struct bake_image *dst, struct bake_err *err);

/*
 * The same row by row, for results that are used up as they come: what
 * bake_resample_mapped computes, bit for bit, without an image to hold it.
 *
 * bake_resampler_open makes the tables of weights and, unless every column of
 * the result is a single source texel (step_u = 1 at a whole offset, or BOX
 * and TRIANGLE where they hit texels), resamples all rows of the source. Then
 * bake_resampler_row gives row y, 0 <= y < height: width texels of src's
 * channels.
 *
 *   src      must outlive the resampler, and stay as it was
 *   scratch  bake_resampler_scratch(r) doubles, of one thread
 *   row      out: width * src->nchans floats
 *
 * Memory: a float image of width x src->height unless the columns are single
 * texels, and the tables. Errors are those of bake_resample_mapped; on failure
 * *resampler is NULL. Threads may ask one resampler for rows at once.
 */
struct bake_resampler;
BAKE_API enum bake_status bake_resampler_open(struct bake_resampler **resampler,
    const struct bake_image *src, int width, int height,
    const struct bake_resample_params *params, struct bake_err *err);
BAKE_API size_t bake_resampler_scratch(const struct bake_resampler *r);
BAKE_API void bake_resampler_row(
    const struct bake_resampler *r, int y, float *row, double *scratch);
/*
 * With params->window_rows = n > 0 the resampler holds no more of the resampled
 * source than n rows of the result need. Before rows y .. y + n - 1 are asked
 * for they are made ready by bake_resampler_window(r, y), while no thread asks
 * for any. What two windows share is made once where one follows the other.
 *
 * BAKE_ENOMEM  no memory for a row; the resampler is then of no use
 */
BAKE_API enum bake_status bake_resampler_window(
    struct bake_resampler *r, int y, struct bake_err *err);

/* The window_rows to take for a source that is brought to that width: 0 where
 * all of it takes at most BAKE_RESAMPLE_WHOLE bytes, else 64. BAKE_BAND_ROWS=N
 * in the environment makes it N always, for tests. */
#define BAKE_RESAMPLE_WHOLE 0x1p28
BAKE_API int bake_resample_window_rows(const struct bake_image *src, int width);

/* Whether every texel of the result is one texel of the source, bit for bit. */
BAKE_API bool bake_resampler_copies(const struct bake_resampler *r);
/* Harmless on NULL. */
BAKE_API void bake_resampler_close(struct bake_resampler *r);

#ifdef __cplusplus
}
#endif

#endif
