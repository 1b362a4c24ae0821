/* Float images: the one pixel container of libbake. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_IMAGE_H
#define BAKE_IMAGE_H

#include <stdbool.h>
#include <stddef.h>

#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * An image of height rows of width texels of nchans floats, interleaved.
 * Row 0 is the top of the picture. Texel (x, y), channel c:
 *     data[y * row_stride + x * nchans + c]
 * row_stride counts floats and is at least width * nchans. An image that
 * bake_image_alloc made owns its data; one filled in by hand is a view.
 * Integer codes are held as code / code_max, see codes.h.
 */
struct bake_image {
	int width, height, nchans;
	size_t row_stride;
	float *data;
};
#define BAKE_IMAGE_INIT                                                        \
	{                                                                      \
		0, 0, 0, 0, NULL                                               \
	}

/*
 * How a texture goes on beyond its border, for each axis: as a torus (the
 * default, all zero), or with its border texels repeated.
 */
struct bake_wrap {
	bool clamp_u, clamp_v;
};

/*
 * Allocate an image, its texels unspecified. width, height and nchans must be
 * at least 1. *img is overwritten, not freed; on failure it is
 * BAKE_IMAGE_INIT.
 *
 * BAKE_EINVAL  a size below 1
 * BAKE_ENOMEM  no memory, or the size overflows
 */
BAKE_API enum bake_status bake_image_alloc(struct bake_image *img, int width,
    int height, int nchans, struct bake_err *err);

/* Free the texels and reset to BAKE_IMAGE_INIT. Harmless on BAKE_IMAGE_INIT. */
BAKE_API void bake_image_free(struct bake_image *img);

/* Exchange two images, owners included. */
BAKE_API void bake_image_swap(struct bake_image *a, struct bake_image *b);

/*
 * Copy one channel: dst's channel dst_chan becomes src's src_chan. Both
 * images are allocated and of the same size; the channels exist. Reentrant.
 */
BAKE_API void bake_image_copy_channel(struct bake_image *dst, int dst_chan,
    const struct bake_image *src, int src_chan);

/* Row y of the image, 0 <= y < height. */
static inline float *
bake_image_row(const struct bake_image *img, int y)
{
	return img->data + (size_t)y * img->row_stride;
}

/* Index i wrapped into 0 .. n-1: modulo on a torus, else clamped. */
static inline int
bake_wrap_index(long i, int n, bool clamp)
{
	long m;

	if (clamp)
		return i < 0 ? 0 : i >= n ? n - 1 : (int)i;
	m = i % n;
	return (int)(m < 0 ? m + n : m);
}

#ifdef __cplusplus
}
#endif

#endif
