/* Relief marching: the prepared map, and the parts that march.c calls. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MARCH_PRIV_H
#define BAKE_MARCH_PRIV_H

#include <math.h>

#include "isa.h"
#include "march.h"

/* Sides up to this have their cell and its centre exact in a float. */
enum { BAKE_MARCH_SIDE_MAX = 1 << 22 };
/* Most steps of a linear search: of a ray that passes more texels than that,
 * TEXEL makes longer steps. */
enum { BAKE_MARCH_STEPS_MAX = 1 << 16 };
enum { BAKE_MARCH_LEVELS = 24 };

/*
 * Cell (i, j), 0 <= i <= width, 0 <= j <= height, is the square between the
 * centres of texels i - 1 and i, rows j - 1 and j, rows counted upwards from
 * v = 0. In these units a place is at (u W + 1/2, v H + 1/2); its whole part is
 * its cell. Cells 0 and width are the same on a torus and flat on a border
 * that is repeated, so that after u was brought into 0 .. 1 nothing needs to
 * be wrapped.
 *
 * Rows overlap in memory: the pairs {row j - 1, row j} lie along i, so that the
 * four corners of a cell are four neighbouring floats
 *     d(i-1, j-1), d(i-1, j), d(i, j-1), d(i, j)
 * at cells + 2 (j stride + i): one 128-bit load for 8 bytes a texel.
 */
struct bake_relief_map {
	int width, height;
	struct bake_wrap wrap;
	enum bake_isa isa;
	unsigned stride; /* of cells: pairs in a row, width + 2 */
	float *cells;
	/* the least depth in blocks of 2^level cells, levels 1 .. top */
	int top;
	float *lows[BAKE_MARCH_LEVELS];
	int low_stride[BAKE_MARCH_LEVELS];
};

static inline const float *
bake_march_cell(const struct bake_relief_map *map, unsigned i, unsigned j)
{
	return map->cells + 2 * ((size_t)j * map->stride + i);
}

/* A place along one axis, in cells: what the kernels do lane by lane. A NaN
 * and an infinity give some cell. */
static inline float
bake_march_place(float u, int side, bool clamp)
{
	float s = clamp ? u : u - floorf(u);

	s = s > 0 ? s : 0;
	s = s < 1 ? s : 1;
	return s * (float)side + 0.5f;
}

static inline float
bake_march_depth(const struct bake_relief_map *map, float u, float v)
{
	const float x = bake_march_place(u, map->width, map->wrap.clamp_u);
	const float y = bake_march_place(v, map->height, map->wrap.clamp_v);
	const int i = (int)x, j = (int)y;
	const float fx = x - (float)i, fy = y - (float)j;
	const float *c = bake_march_cell(map, (unsigned)i, (unsigned)j);
	const float left = c[0] + fy * (c[1] - c[0]);
	const float right = c[2] + fy * (c[3] - c[2]);

	return left + fx * (right - left);
}

/* LINEAR and TEXEL, ray by ray: the kernels give the same bits. */
void bake_march_plain(const struct bake_relief_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays);
void bake_march_any_plain(const struct bake_relief_map *map,
    const struct bake_march_params *params, float bias,
    const struct bake_rays *rays);

void bake_march_exact(
    const struct bake_relief_map *map, const struct bake_rays *rays);
void bake_march_any_exact(const struct bake_relief_map *map, float bias,
    const struct bake_rays *rays);

#define BAKE_MARCH_KERNELS(isa)                                                \
	void bake_march_linear_##isa(const struct bake_relief_map *map,        \
	    const struct bake_march_params *params,                            \
	    const struct bake_rays *rays);                                     \
	void bake_march_linear_any_##isa(const struct bake_relief_map *map,    \
	    const struct bake_march_params *params, float bias,                \
	    const struct bake_rays *rays);                                     \
	/* whole vectors only; returns how many places that were */            \
	int bake_march_sample_##isa(const struct bake_relief_map *map, int n,  \
	    const float *u, const float *v, float *d)
BAKE_MARCH_KERNELS(baseline);
BAKE_MARCH_KERNELS(avx2);
BAKE_MARCH_KERNELS(avx512);

#endif
