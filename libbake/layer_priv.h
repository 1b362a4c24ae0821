/* Layers inside libbake: codes in textures, and the smallest-interval rule. */
/* SPDX-License-Identifier: MIT */
#ifndef LAYER_PRIV_H
#define LAYER_PRIV_H

#include <stdint.h>
#include <string.h>

#include "layer_codes.h"
#include "layer_maps.h"
#include "pixels.h"

/* The code of 'no layer': of the stored value 1. */
static inline uint32_t
bake_layer_none(enum bake_data_format format)
{
	static const uint32_t one[] = { 255, 65535, 0x3c00, 0x3f800000 };

	return one[format];
}

/* The code of value i of an image, counted from its beginning. */
static inline uint32_t
bake_pixels_code(const struct bake_pixels *px, size_t i)
{
	uint32_t bits;

	switch (px->format) {
	case BAKE_DATA_UINT8:
		return ((const uint8_t *)px->data)[i];
	case BAKE_DATA_UINT16:
	case BAKE_DATA_HALF:
		return ((const uint16_t *)px->data)[i];
	default:
		memcpy(&bits, (const float *)px->data + i, sizeof bits);
		return bits;
	}
}

static inline void
bake_pixels_set_code(struct bake_pixels *px, size_t i, uint32_t code)
{
	switch (px->format) {
	case BAKE_DATA_UINT8:
		((uint8_t *)px->data)[i] = (uint8_t)code;
		break;
	case BAKE_DATA_UINT16:
	case BAKE_DATA_HALF:
		((uint16_t *)px->data)[i] = (uint16_t)code;
		break;
	default:
		memcpy((float *)px->data + i, &code, sizeof code);
		break;
	}
}

/* How many layers texel t (row by row) has; their codes, if code is not NULL:
 * room for nlayers. */
int bake_layer_codes_of(
    const struct bake_layer_maps *maps, size_t t, uint32_t *code);

/*
 * Remove pairs of neighbours, those nearest in depth first (of equally near
 * ones the first), until nlayers are left: slabs (both their ends) and gaps
 * (which joins two slabs). Returns how many are left. n and nlayers are even.
 */
size_t bake_layer_cap(struct bake_layer *layer, size_t n, size_t nlayers);

/* The same for any number, in time n log n: *n becomes how many are left.
 * BAKE_ENOMEM: no memory, layer is as it was. */
enum bake_status bake_layer_cap_many(
    struct bake_layer *layer, size_t *n, size_t nlayers, struct bake_err *err);

#endif
