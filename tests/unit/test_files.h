/* Image files in memory, for the unit tests that write and read them. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_FILES_H
#define TEST_FILES_H

#include <stdbool.h>
#include <stdio.h>

#include "check.h"
#include "io_image.h"
#include "test_maps.h"

static const struct {
	enum bake_file_type type;
	enum bake_data_format format;
	const char *container, *name; /* a name for reading from memory */
} kinds[] = {
	{ BAKE_FILE_PNG, BAKE_DATA_UINT8, "png", "mem.png" },
	{ BAKE_FILE_PNG, BAKE_DATA_UINT16, "png", "mem.png" },
	{ BAKE_FILE_TGA, BAKE_DATA_UINT8, "targa", "mem.tga" },
	{ BAKE_FILE_TIFF, BAKE_DATA_UINT8, "tiff", "mem.tif" },
	{ BAKE_FILE_TIFF, BAKE_DATA_UINT16, "tiff", "mem.tif" },
	{ BAKE_FILE_TIFF, BAKE_DATA_FLOAT, "tiff", "mem.tif" },
	{ BAKE_FILE_EXR, BAKE_DATA_HALF, "openexr", "mem.exr" },
	{ BAKE_FILE_EXR, BAKE_DATA_FLOAT, "openexr", "mem.exr" },
};
enum { NKINDS = sizeof kinds / sizeof *kinds };

struct bytes {
	unsigned char *p;
	size_t n;
};

static inline struct bake_write_params
params_of(int kind)
{
	struct bake_write_params p;

	memset(&p, 0, sizeof p);
	p.type = kinds[kind].type;
	p.data_format = kinds[kind].format;
	p.png_level = BAKE_PNG_LEVEL;
	return p;
}

static inline struct bytes
encode(const struct bake_image *img, const struct bake_write_params *params)
{
	FILE *f = tmpfile();
	struct bake_err err = BAKE_ERR_INIT;
	struct bytes b = { NULL, 0 };

	CHECK_OK(bake_image_write(img, params, f, "out", NULL, &err), err);
	fseek(f, 0, SEEK_END);
	b.n = (size_t)ftell(f);
	b.p = malloc(b.n + 1);
	rewind(f);
	if (fread(b.p, 1, b.n, f) != b.n)
		abort();
	fclose(f);
	return b;
}

static inline enum bake_status
decode(const struct bytes *b, const char *name, struct bake_image_info *info,
    struct bake_image *img, struct bake_err *err)
{
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	struct bake_reader *r;
	enum bake_status rc;

	*img = (struct bake_image)BAKE_IMAGE_INIT;
	rc = bake_reader_open_memory(&r, b->p, b->n, name, &limits, info, err);
	CHECK((rc == BAKE_OK) == (r != NULL));
	if (rc == BAKE_OK)
		rc = bake_reader_read(r, 0, info->nchans, img, err);
	bake_reader_close(r);
	CHECK((rc == BAKE_OK) == (img->data != NULL));
	return rc;
}

/* Value of a half: the standard's definition. */
static inline float
half_value(unsigned bits)
{
	int exponent = (int)(bits >> 10 & 31), m = (int)(bits & 1023);
	double v = exponent == 0    ? ldexp(m, -24)
		   : exponent == 31 ? m == 0 ? INFINITY : NAN
				    : ldexp(1024 + m, exponent - 25);

	return (float)(bits & 0x8000 ? -v : v);
}

/* A value that the format holds, by chance: any code, any finite half or
 * float, the smallest and the negative ones too. */
static inline float
any_value(enum bake_data_format format, uint32_t seed)
{
	uint32_t h = hash(seed) ^ hash(seed + 99991) << 13;
	float v;

	switch (format) {
	case BAKE_DATA_UINT8:
		return (float)(h & 255) / 255.0f;
	case BAKE_DATA_UINT16:
		return (float)(h & 65535) / 65535.0f;
	case BAKE_DATA_HALF:
		v = half_value(h & 65535);
		break;
	default:
		memcpy(&v, &h, sizeof v);
	}
	return isfinite(v) ? v : -0.0f;
}

/* An image of such values; a third of the texels have 0 in the last channel,
 * where alpha would be. */
static inline struct bake_image
any_image(int w, int h, int nc, enum bake_data_format format)
{
	struct bake_image img = image(w, h, nc);

	for (int i = 0; i < w * h * nc; i++) {
		img.data[i] = any_value(format, (uint32_t)i * 8 + format);
		if (nc > 1 && i % nc == nc - 1 && i / nc % 3 == 0)
			img.data[i] = 0.0f;
	}
	return img;
}

static inline bool
same_texels(const struct bake_image *a, const struct bake_image *b)
{
	size_t row = (size_t)a->width * (size_t)a->nchans * sizeof(float);

	if (a->width != b->width || a->height != b->height ||
	    a->nchans != b->nchans)
		return false;
	for (int y = 0; y < a->height; y++)
		if (memcmp(bake_image_row(a, y), bake_image_row(b, y), row) !=
		    0)
			return false;
	return true;
}

#endif
