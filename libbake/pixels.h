/* Images in the data format of a file: what is large is held only once. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_PIXELS_H
#define BAKE_PIXELS_H

#include <stddef.h>

#include "codes.h"
#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * height rows of width texels of nchans values, interleaved, row 0 the top, as
 * uint8_t, uint16_t, half (uint16_t bits of IEEE binary16) or float.
 */
struct bake_pixels {
	int width, height, nchans;
	enum bake_data_format format;
	void *data;
};
#define BAKE_PIXELS_INIT                                                       \
	{                                                                      \
		0, 0, 0, BAKE_DATA_UINT8, NULL                                 \
	}

/*
 * Allocate, contents unspecified; *px is overwritten, not freed; on failure it
 * is BAKE_PIXELS_INIT.
 *
 * BAKE_EINVAL  a size below 1
 * BAKE_ENOMEM  no memory, or the size overflows
 */
BAKE_API enum bake_status bake_pixels_alloc(struct bake_pixels *px, int width,
    int height, int nchans, enum bake_data_format format, struct bake_err *err);
/* Free and reset to BAKE_PIXELS_INIT. Harmless on BAKE_PIXELS_INIT. */
BAKE_API void bake_pixels_free(struct bake_pixels *px);

/* Bytes of one value: 1, 2, 2, 4. */
BAKE_API size_t bake_data_format_size(enum bake_data_format format);

/*
 * n texels of row y, columns x .. x + n - 1, as floats, n * nchans of them:
 * integer codes as code / max (see codes.h), half and float as they are. And
 * back, rounded as codes.h says: integer codes half up and clipped to 0 .. 1,
 * half to the nearest, ties to even, finite values that are too large for it to
 * its largest.
 *
 * All of it lies within the image; n = 0 does nothing. What was put is got
 * back; what was got and is put gives the same bytes (but for a NaN's).
 * Threads may put different texels at once.
 */
BAKE_API void bake_pixels_get(
    const struct bake_pixels *px, int x, int y, int n, float *values);
BAKE_API void bake_pixels_put(
    struct bake_pixels *px, int x, int y, int n, const float *values);

#ifdef __cplusplus
}
#endif

#endif
