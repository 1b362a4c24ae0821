/* Mip levels inside libbake: the solid in a box of texels, depth by depth. */
/* SPDX-License-Identifier: MIT */
#ifndef LAYER_MIP_PRIV_H
#define LAYER_MIP_PRIV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "layer_priv.h"

/* Thresholds are t / BAKE_TAU_ONE. */
enum { BAKE_TAU_ONE = 65536 };

/* Texels x0 .. x1 - 1 by y0 .. y1 - 1 of level 0. */
struct bake_box {
	int x0, y0, x1, y1;
};

/* Where box i of n on size texels begins. */
static inline int
bake_box_edge(int i, int n, int size)
{
	return (int)((int64_t)i * size / n);
}

static inline uint64_t
bake_box_texels(struct bake_box b)
{
	return (uint64_t)(b.x1 - b.x0) * (uint64_t)(b.y1 - b.y0);
}

/* The place of a code on the depth axis, in whole numbers: floats are at least
 * 2^-8, so that 2^-31 is their smallest step; halfs' is larger. */
static inline uint64_t
bake_layer_place(uint32_t code, enum bake_data_format format)
{
	if (format == BAKE_DATA_UINT8 || format == BAKE_DATA_UINT16)
		return code;
	return (uint64_t)((double)bake_layer_value(code, format) * 0x1p31);
}

/*
 * The slabs of a box's texels, taken apart: which codes they begin and end at,
 * each in rising order. One thread's, used again and again.
 *
 *   end    [2][n]: entries, exits; room for room slabs
 *   layer  [nlayers] of the level's texel, after bake_stack_solve; depth is the
 *          place, crossing is not used
 *   reach  [nlayers] the mean distance of the slabs' ends that have a part in
 *          it from a layer's own place
 */
struct bake_stack {
	enum bake_data_format format;
	uint64_t ntexels;
	size_t n, room;
	uint32_t *end[2], *spare;
	size_t nlayers, layer_room;
	struct bake_layer *layer;
	double *reach;
	bool capped;
};

void bake_stack_free(struct bake_stack *s);

/* Gather the slabs of a box, sorted. BAKE_ENOMEM: no memory. */
enum bake_status bake_stack_gather(struct bake_stack *s,
    const struct bake_layer_maps *maps, struct bake_box box,
    struct bake_err *err);

/*
 * Add to hist[ceil(o BAKE_TAU_ONE)] the lengths at which the share o of the box
 * is solid, times its texels: what a threshold t = 0 .. BAKE_TAU_ONE - 1 leaves
 * is the sum of hist[i], i > t. Returns the box's solid volume.
 */
uint64_t bake_stack_histogram(const struct bake_stack *s, uint64_t *hist);

/* The threshold that keeps volume (layer_maps.h says how), of the sum of all
 * boxes' histograms. */
uint32_t bake_tau_choose(const uint64_t *hist, uint64_t volume);

/* The layers at threshold t, capped to most; their codes, places and reach.
 * BAKE_ENOMEM: no memory. */
enum bake_status bake_stack_solve(
    struct bake_stack *s, uint32_t t, int most, struct bake_err *err);

/* What all threads read. */
struct bake_mip {
	const struct bake_layer_maps *maps;
	struct bake_layer_maps *out;
	const struct bake_color *color; /* NULL: nothing to convert */
	enum bake_data_format format;
	uint32_t t; /* threshold */
};

/* Of one layer of one texel of the level: what takes part in it. */
struct bake_layer_sum {
	uint32_t code;
	double reach;
	double normal[3];
	double rgb[3], weight;
};

/* Of one colour image at one texel of the level, over the whole box. */
struct bake_color_sum {
	double rgb[3], alpha;
	uint64_t n;
};

/* Of a texel of a height field's level. */
struct bake_height_sum {
	double depth, slope[2];
	uint64_t n;
};

/* One thread's, for a row of the level. */
struct bake_mip_row {
	struct bake_stack stack;
	int *n;                         /* [w] layers of the texels */
	struct bake_layer_sum *layer;   /* [w][nlayers] */
	struct bake_color_sum *color;   /* [w][ncolors] */
	struct bake_height_sum *height; /* [w] */
	float *texels;                  /* [2 ntextures + ncolors][W][4] */
	uint64_t volume, capped;        /* sums over the rows */
};

static inline struct bake_box
bake_mip_box(const struct bake_mip *m, int x, int y)
{
	return (
	    struct bake_box){ bake_box_edge(x, m->out->width, m->maps->width),
		bake_box_edge(y, m->out->height, m->maps->height),
		bake_box_edge(x + 1, m->out->width, m->maps->width),
		bake_box_edge(y + 1, m->out->height, m->maps->height) };
}

enum bake_status bake_mip_row_alloc(
    struct bake_mip_row *row, const struct bake_mip *m, struct bake_err *err);
void bake_mip_row_free(struct bake_mip_row *row);

/* Row y of the level, whole. BAKE_ENOMEM, and what color.h says. */
enum bake_status bake_mip_row_make(struct bake_mip_row *row,
    const struct bake_mip *m, int y, struct bake_err *err);

#endif
