/* Sets of multilayer textures for the unit tests. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_LAYERS_H
#define TEST_LAYERS_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "layer_codes.h"
#include "layer_maps.h"

static inline struct bake_layer_maps
layer_maps(int w, int h, int nlayers, enum bake_data_format format, int ncolors,
    int chans, enum bake_data_format color_format)
{
	struct bake_layer_maps m;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_layer_maps_alloc(&m, w, h, nlayers, format, ncolors, chans,
		color_format, &err) != BAKE_OK)
		abort();
	return m;
}

/* One value of an image, as codes.h gives it, and in. */
static inline float
value_at(const struct bake_pixels *px, int x, int y, int c)
{
	float v[4];

	bake_pixels_get(px, x, y, 1, v);
	return v[c];
}

static inline void
set_value(struct bake_pixels *px, int x, int y, int c, float value)
{
	float v[4];

	bake_pixels_get(px, x, y, 1, v);
	v[c] = value;
	bake_pixels_put(px, x, y, 1, v);
}

/* The code of layer i: what its stored value is the value of. */
static inline uint32_t
code_at(const struct bake_layer_maps *m, int x, int y, int i)
{
	const struct bake_pixels *px = &m->depth[i / 4];
	const size_t at =
	    4 * ((size_t)y * (size_t)m->width + (size_t)x) + (size_t)(i % 4);
	uint32_t bits;

	if (px->format == BAKE_DATA_UINT8)
		return ((const uint8_t *)px->data)[at];
	if (px->format != BAKE_DATA_FLOAT)
		return ((const uint16_t *)px->data)[at];
	memcpy(&bits, (const float *)px->data + at, sizeof bits);
	return bits;
}

/* Layer i at stored depth d', with a normal. */
static inline void
set_layer(struct bake_layer_maps *m, int x, int y, int i, double stored,
    const double normal[3])
{
	set_value(&m->depth[i / 4], x, y, i % 4, (float)stored);
	set_value(&m->nx[i / 4], x, y, i % 4, (float)((normal[0] + 1) / 2));
	set_value(&m->ny[i / 4], x, y, i % 4, (float)((normal[1] + 1) / 2));
}

/* The normal of layer i; z by its parity. */
static inline void
normal_at(const struct bake_layer_maps *m, int x, int y, int i, double n[3])
{
	double zz;

	n[0] = 2 * (double)value_at(&m->nx[i / 4], x, y, i % 4) - 1;
	n[1] = 2 * (double)value_at(&m->ny[i / 4], x, y, i % 4) - 1;
	zz = 1 - n[0] * n[0] - n[1] * n[1];
	n[2] = zz > 0 ? sqrt(zz) : 0;
	n[2] = i % 2 ? -n[2] : n[2];
}

/* Whether two images hold the same bytes. */
static inline bool
same_pixels(const struct bake_pixels *a, const struct bake_pixels *b)
{
	return a->width == b->width && a->height == b->height &&
	       a->nchans == b->nchans && a->format == b->format &&
	       memcmp(a->data, b->data,
		   (size_t)a->width * (size_t)a->height * (size_t)a->nchans *
		       bake_data_format_size(a->format)) == 0;
}

static inline bool
same_maps(const struct bake_layer_maps *a, const struct bake_layer_maps *b)
{
	bool same = a->nlayers == b->nlayers && a->ncolors == b->ncolors;

	for (int i = 0; i < a->ntextures && same; i++)
		same = same_pixels(&a->depth[i], &b->depth[i]) &&
		       same_pixels(&a->nx[i], &b->nx[i]) &&
		       same_pixels(&a->ny[i], &b->ny[i]);
	for (int i = 0; i < a->ncolors && same; i++)
		same = same_pixels(&a->color[i], &b->color[i]);
	return same;
}

/*
 * A ball of the given radius, in texels, in the middle of depth; centre
 * (cx, cy) in texels, texel centres at + 1/2. `deep` texels are the range.
 */
static inline void
draw_ball(
    struct bake_layer_maps *m, double cx, double cy, double radius, double deep)
{
	for (int y = 0; y < m->height; y++)
		for (int x = 0; x < m->width; x++) {
			const double dx = x + 0.5 - cx, dy = cy - (y + 0.5);
			const double zz = radius * radius - dx * dx - dy * dy;

			if (!(zz > 0))
				continue;
			for (int i = 0; i < 2; i++) {
				const double z = i ? -sqrt(zz) : sqrt(zz);

				set_layer(m, x, y, i,
				    bake_layer_stored(0.5 - z / deep),
				    (double[3]){
					dx / radius, dy / radius, z / radius });
			}
		}
}

#endif
