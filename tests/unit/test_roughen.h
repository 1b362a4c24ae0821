/* Textures for the tests of the remap. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_ROUGHEN_H
#define TEST_ROUGHEN_H

#include <stdint.h>
#include <stdlib.h>

#include "check.h"
#include "roughen.h"

static inline struct bake_image
new_image(int width, int height, int nchans)
{
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_image_alloc(&img, width, height, nchans, &err) != BAKE_OK)
		abort();
	return img;
}

/* 0 .. 1, the same on every machine. */
static inline double
test_random(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return (*state >> 8) / 16777216.0;
}

/* Nearly normal: mean and standard deviation, by twelve uniform numbers. */
static inline struct bake_image
gaussian_texture(int width, int height, double mean, double sd)
{
	struct bake_image img = new_image(width, height, 1);
	uint32_t state = 7;

	for (int i = 0; i < width * height; i++) {
		double sum = -6;

		for (int k = 0; k < 12; k++)
			sum += test_random(&state);
		img.data[i] = (float)(mean + sd * sum);
	}
	return img;
}

static inline struct bake_roughen
remap_of(enum bake_roughen_model model, double strength,
    const struct bake_image *lum)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_roughen_stats stats;
	struct bake_roughen r;

	CHECK_OK(bake_roughen_measure(lum, 1, &stats, &err), err);
	CHECK_OK(bake_roughen_init(&r, model, strength, &stats, &err), err);
	return r;
}

#endif
