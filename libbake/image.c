/* Float images: allocation and ownership. */
/* SPDX-License-Identifier: MIT */
#include "image.h"

#include <stdlib.h>

#include "mem.h"

enum bake_status
bake_image_alloc(struct bake_image *img, int width, int height, int nchans,
    struct bake_err *err)
{
	size_t row, count;

	*img = (struct bake_image)BAKE_IMAGE_INIT;
	if (width < 1 || height < 1 || nchans < 1)
		return bake_fail(err, BAKE_EINVAL,
		    "an image of %dx%d texels with %d channels cannot be",
		    width, height, nchans);
	if (!bake_mul_size((size_t)width, (size_t)nchans, &row) ||
	    !bake_mul_size(row, (size_t)height, &count))
		return bake_fail(err, BAKE_ENOMEM,
		    "%dx%d texels with %d channels do not fit in memory", width,
		    height, nchans);
	img->data = bake_alloc(count, sizeof *img->data, err);
	if (img->data == NULL)
		return BAKE_ENOMEM;
	img->width = width;
	img->height = height;
	img->nchans = nchans;
	img->row_stride = row;
	return BAKE_OK;
}

void
bake_image_free(struct bake_image *img)
{
	free(img->data);
	*img = (struct bake_image)BAKE_IMAGE_INIT;
}

void
bake_image_swap(struct bake_image *a, struct bake_image *b)
{
	struct bake_image t = *a;

	*a = *b;
	*b = t;
}

void
bake_image_copy_channel(struct bake_image *dst, int dst_chan,
    const struct bake_image *src, int src_chan)
{
	for (int y = 0; y < dst->height; y++) {
		const float *s = bake_image_row(src, y) + src_chan;
		float *d = bake_image_row(dst, y) + dst_chan;

		for (int x = 0; x < dst->width; x++)
			d[(size_t)x * (size_t)dst->nchans] =
			    s[(size_t)x * (size_t)src->nchans];
	}
}
