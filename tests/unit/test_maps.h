/* Small maps for the unit tests of what turns maps into maps. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_MAPS_H
#define TEST_MAPS_H

#include <stdint.h>
#include <stdlib.h>

#include "image.h"

static const double pi = 3.14159265358979323846;
static const struct bake_wrap torus = { false, false };
static const struct bake_wrap clamped = { true, true };

static inline struct bake_image
image(int w, int h, int nc)
{
	struct bake_image img;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_image_alloc(&img, w, h, nc, &err) != BAKE_OK)
		abort();
	return img;
}

static inline uint32_t
hash(uint32_t x)
{
	x = (x ^ 61) ^ (x >> 16);
	x *= 9;
	x ^= x >> 4;
	x *= 0x27d4eb2d;
	return x ^ (x >> 15);
}

/* Noise of 0..1 in steps of 1/256, so that sums of a few are exact. */
static inline struct bake_image
noise(int w, int h, int nc)
{
	struct bake_image img = image(w, h, nc);

	for (int i = 0; i < w * h * nc; i++)
		img.data[i] = (float)(hash((uint32_t)i) % 257) / 256.0f;
	return img;
}

static inline size_t
nfloats(const struct bake_image *img)
{
	return (size_t)img->width * (size_t)img->height * (size_t)img->nchans;
}

#endif
