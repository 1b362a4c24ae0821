/* From horizons to ambient occlusion: the inner kernel. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_AO_PRIV_H
#define BAKE_AO_PRIV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Tangents beyond this count as this: tan^2 stays finite, cos e is 1e-18. */
#define BAKE_AO_TAN_MAX 1e18f

/*
 * Add one direction's horizons of n texels, a multiple of 64, to their sums;
 * formulas: bake_ao.
 *
 *   slopes       [n] >= 0, in units of depth per texel; tan e = slope * scale
 *   start        this is direction 0: the sums begin
 *   open         the first of a run of directions: prev begins
 *   sum          [n] of r_j r_(j-1) up to this direction, or of r_j^2
 *   prev         [n] r of direction j - 1, then j; NULL with the mean
 *   first        [n] r of direction 0; NULL without bent
 *   bent         x, y, z: [n] each, or NULL
 */
struct bake_ao_add {
	size_t n;
	const float *slopes;
	float scale;
	bool mean, start, open;
	float cos_phi, sin_phi;
	float *sum, *first, *prev;
	float *bent[3];
};

void bake_ao_add_baseline(const struct bake_ao_add *add);
void bake_ao_add_avx2(const struct bake_ao_add *add);
void bake_ao_add_avx512(const struct bake_ao_add *add);

/* Set bit t % 64 of mask[t / 64] where slopes[t] > 0, t < n. */
void bake_ao_mask_baseline(uint64_t *mask, const float *slopes, size_t n);
void bake_ao_mask_avx2(uint64_t *mask, const float *slopes, size_t n);
void bake_ao_mask_avx512(uint64_t *mask, const float *slopes, size_t n);

#endif
