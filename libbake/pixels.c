/* Images in the data format of a file: allocation, and values in and out. */
/* SPDX-License-Identifier: MIT */
#include "pixels.h"

#include <stdlib.h>
#include <string.h>

#include "mem.h"

size_t
bake_data_format_size(enum bake_data_format format)
{
	static const size_t sizes[] = { 1, 2, 2, 4 };

	return sizes[format];
}

enum bake_status
bake_pixels_alloc(struct bake_pixels *px, int width, int height, int nchans,
    enum bake_data_format format, struct bake_err *err)
{
	size_t row, count;

	*px = (struct bake_pixels)BAKE_PIXELS_INIT;
	if (width < 1 || height < 1 || nchans < 1)
		return bake_fail(err, BAKE_EINVAL,
		    "an image of %dx%d texels with %d channels cannot be",
		    width, height, nchans);
	if (!bake_mul_size((size_t)width, (size_t)nchans, &row) ||
	    !bake_mul_size(row, (size_t)height, &count))
		return bake_fail(err, BAKE_ENOMEM,
		    "%dx%d texels with %d channels do not fit in memory", width,
		    height, nchans);
	px->data = bake_alloc(count, bake_data_format_size(format), err);
	if (px->data == NULL)
		return BAKE_ENOMEM;
	px->width = width;
	px->height = height;
	px->nchans = nchans;
	px->format = format;
	return BAKE_OK;
}

void
bake_pixels_free(struct bake_pixels *px)
{
	free(px->data);
	*px = (struct bake_pixels)BAKE_PIXELS_INIT;
}

/* Which value texel (x, y) begins with. */
static size_t
first_value(const struct bake_pixels *px, int x, int y)
{
	return ((size_t)y * (size_t)px->width + (size_t)x) * (size_t)px->nchans;
}

void
bake_pixels_get(
    const struct bake_pixels *px, int x, int y, int n, float *values)
{
	const size_t at = first_value(px, x, y);
	const size_t count = (size_t)n * (size_t)px->nchans;

	switch (px->format) {
	case BAKE_DATA_UINT8:
		bake_codes_from_u8(
		    values, (const uint8_t *)px->data + at, count);
		break;
	case BAKE_DATA_UINT16:
		bake_codes_from_u16(
		    values, (const uint16_t *)px->data + at, count);
		break;
	case BAKE_DATA_HALF:
		bake_codes_from_half(
		    values, (const uint16_t *)px->data + at, count);
		break;
	case BAKE_DATA_FLOAT:
		memcpy(values, (const float *)px->data + at,
		    count * sizeof *values);
		break;
	}
}

void
bake_pixels_put(
    struct bake_pixels *px, int x, int y, int n, const float *values)
{
	const size_t at = first_value(px, x, y);
	const size_t count = (size_t)n * (size_t)px->nchans;

	switch (px->format) {
	case BAKE_DATA_UINT8:
		bake_codes_to_u8((uint8_t *)px->data + at, values, count);
		break;
	case BAKE_DATA_UINT16:
		bake_codes_to_u16((uint16_t *)px->data + at, values, count);
		break;
	case BAKE_DATA_HALF:
		bake_codes_to_half((uint16_t *)px->data + at, values, count);
		break;
	case BAKE_DATA_FLOAT:
		memcpy((float *)px->data + at, values, count * sizeof *values);
		break;
	}
}
