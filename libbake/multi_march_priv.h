/* Multilayer marching: the prepared layers, and what multi_march.c calls. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MULTI_MARCH_PRIV_H
#define BAKE_MULTI_MARCH_PRIV_H

#include <math.h>
#include <stdint.h>

#include "isa.h"
#include "multi_march.h"

enum { BAKE_MULTI_SIDE_MAX = 1 << 22 };
enum { BAKE_MULTI_STEPS_MAX = 1 << 16 };
/* Sides of a block, 2^3 texels. */
enum { BAKE_MULTI_BLOCK = 3 };

/* The depths before and behind which a block of texels is empty. */
struct bake_multi_block {
	float low, high;
};

/*
 * Texel (i, j), rows counted upwards from v = 0, is number j width + i. It is
 * the square i .. i + 1, j .. j + 1 of places (u W, v H).
 *
 * Of every texel the first four depths stand in `quads`, those that it does not
 * have infinite: what a search looks at is one 128-bit load. All layers stand
 * one after the other in `depths` and `normals`, those of texel k from
 * first[k] on, count[k] of them.
 */
struct bake_multi_map {
	int width, height;
	struct bake_wrap wrap;
	enum bake_isa isa;
	bool deep; /* a texel has more than four layers */
	float (*quads)[4];
	uint32_t *first;
	uint8_t *count;
	float *depths;
	float (*normals)[2];
	int block_stride;
	struct bake_multi_block *blocks;
};

/* How many layers a texel has; texel -1 is none, outside of a clamped texture.
 */
static inline int
bake_multi_count(const struct bake_multi_map *map, long texel)
{
	return texel < 0 ? 0 : map->count[texel];
}

static inline const float *
bake_multi_depths(const struct bake_multi_map *map, long texel)
{
	return map->depths + map->first[texel];
}

/* The texel at (u, v) of a search, or -1. */
static inline long
bake_multi_texel(const struct bake_multi_map *map, float u, float v)
{
	float x = map->wrap.clamp_u ? u : u - floorf(u);
	float y = map->wrap.clamp_v ? v : v - floorf(v);
	int i, j;

	if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1))
		return -1;
	x *= (float)map->width;
	y *= (float)map->height;
	i = (int)x;
	j = (int)y;
	i = i < map->width ? i : map->width - 1;
	j = j < map->height ? j : map->height - 1;
	return (long)j * map->width + i;
}

/* How many depths of the texel are less than z: odd inside. */
static inline int
bake_multi_above(const struct bake_multi_map *map, long texel, float z)
{
	const float *d = map->quads[texel];
	int n = (z > d[0]) + (z > d[1]) + (z > d[2]) + (z > d[3]);

	if (n == 4 && map->deep) {
		const int count = map->count[texel];

		d = bake_multi_depths(map, texel);
		while (n < count && z > d[n])
			n++;
	}
	return n;
}

/* Layer of a texel: what goes into hit i. */
void bake_multi_put(const struct bake_multi_map *map,
    const struct bake_multi_hits *hits, int i, long texel, int layer);
/* The layer of a texel, which has one, whose depth is nearest to z. */
int bake_multi_nearest(const struct bake_multi_map *map, long texel, double z);

/*
 * LINEAR and TEXEL: rays->hit becomes the last place inside, < 0 where there
 * is none, and `before` [n, padded] the last one outside (0 where hit is 0).
 */
void bake_multi_search_plain(const struct bake_multi_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays,
    float *before);
/* rays->hit: 1 where a step at or beyond `skip` is inside, else 0 */
void bake_multi_any_plain(const struct bake_multi_map *map,
    const struct bake_march_params *params, float skip,
    const struct bake_rays *rays);

void bake_multi_exact(const struct bake_multi_map *map,
    const struct bake_rays *rays, const struct bake_multi_hits *hits);
void bake_multi_any_exact(
    const struct bake_multi_map *map, float skip, const struct bake_rays *rays);

#define BAKE_MULTI_KERNELS(isa)                                                \
	void bake_multi_search_##isa(const struct bake_multi_map *map,         \
	    const struct bake_march_params *params,                            \
	    const struct bake_rays *rays, float *before);                      \
	void bake_multi_any_##isa(const struct bake_multi_map *map,            \
	    const struct bake_march_params *params, float skip,                \
	    const struct bake_rays *rays)
BAKE_MULTI_KERNELS(baseline);
BAKE_MULTI_KERNELS(avx2);
BAKE_MULTI_KERNELS(avx512);

#endif
