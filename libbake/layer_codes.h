/* Multilayer depth as codes: quantising and capping lose no slab unsaid. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_LAYER_CODES_H
#define BAKE_LAYER_CODES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "abuffer.h"
#include "codes.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * What a depth texture stores of a real depth d, in every data format:
 *     d' = (1 + 253 d) / 255
 * since the papers' shader discards what it finds below 0.003 and above 0.997;
 * 8 bits: codes 1 .. 254, 16 bits: 257 .. 65278. 1 is 'no layer'.
 */
BAKE_API double bake_layer_stored(double d);
/* And back; 1 (no layer) gives 254 / 253. */
BAKE_API double bake_layer_depth(double stored);

/*
 * Codes are ordered whole numbers: the integer code of uint8 and uint16, the
 * bits of half and float (positive values: bits rise with the value). So 'the
 * next code' is code + 1 in every format.
 *
 * The code of a depth d, clamped to 0 .. 1 before (NaN as 0): the nearest, of
 * two equally near ones the higher (integers), the even one (half, float).
 *     uint8   1 .. 254, floor(253 d + 3/2)
 *     uint16  257 .. 65278, floor(65021 d + 257 + 1/2)
 */
BAKE_API uint32_t bake_layer_code(double d, enum bake_data_format format);
/* The stored value d' of a code. */
BAKE_API float bake_layer_value(uint32_t code, enum bake_data_format format);

/* How more crossings than there are layers are made fewer.
 *   SMALLEST  remove the adjacent pair, slab or gap, with the smallest
 *             interval, again and again
 *   NEAREST   keep the slabs nearest to the eye
 */
enum bake_cap_policy { BAKE_CAP_SMALLEST, BAKE_CAP_NEAREST };

struct bake_layer_params {
	enum bake_data_format format;
	int nlayers; /* even, >= 2; 0: no cap */
	enum bake_cap_policy policy;
};

/* One layer of a texel. */
struct bake_layer {
	uint32_t code;
	int crossing; /* which of the texel's crossings it is, for its normal */
	double depth; /* that one's d, clamped to 0 .. 1 */
};

/* Texels are counted, and slabs; sums over texels are the picture's (max_error
 * is the largest).
 *   capped      texels from which pairs were removed by the cap
 *   removed     layers so removed
 *   merged      slabs that became one with a neighbour, since no code was
 *               between
 *   widened     slabs that are thinner than a code and were widened
 *   clamped     crossings outside 0 .. 1, of slabs that are not cut
 *   cut         slabs that lie outside 0 .. 1 wholly, and are dropped
 *   max_error   the largest |depth of the code - d| of a layer that is left, d
 *               clamped, in units of d
 */
struct bake_layer_stats {
	size_t capped, removed, merged, widened, clamped, cut;
	double max_error;
};
#define BAKE_LAYER_STATS_INIT                                                  \
	{                                                                      \
		0                                                              \
	}
BAKE_API void bake_layer_stats_add(
    struct bake_layer_stats *sum, const struct bake_layer_stats *stats);

/*
 * The layers of one texel: codes strictly increasing, even in number, entry and
 * exit in turns. Without a cap their slabs are those of the crossings, one for
 * one, but for those that are counted as cut and merged.
 *
 * 1. Slabs wholly outside 0 .. 1 are dropped (what touches the range's end is
 *    not outside); depths are clamped to 0 .. 1.
 * 2. Each is rounded to its nearest code. Where a slab's entry is then not
 *    behind the exit before it, no code is between and the two become one.
 * 3. In rising depth: a slab whose ends have the same code c is widened by one
 *    code at the end with the larger residual: (c, c + 1) where the residuals
 *    depth - depth(c) of both ends sum to >= 0, else (c - 1, c). Where that
 *    code is beyond the range's last, or is a neighbour's end, at the other
 *    end. Where that is not free either, it becomes one with the neighbour on
 *    the better side.
 * 4. Only then, where there are more than nlayers, pairs are removed by the
 *    policy. SMALLEST compares the true depths (clamped), and takes the first
 *    of equal ones.
 *
 *   crossing  [n] of one texel in rising depth, as bake_abuffer_rows resolved
 *             them; without the last, where n is odd
 *   layer     out: room for n
 *   stats     added to
 *   return    how many layers there are
 *
 * Time: n, and n for each pair that is removed. Reentrant.
 * Source: own derivation.
 */
BAKE_API int bake_layer_quantize(const struct bake_crossing *crossing, int n,
    const struct bake_layer_params *params, struct bake_layer *layer,
    struct bake_layer_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
