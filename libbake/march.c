/* Relief marching: the map made ready, and the choice of the search. */
/* SPDX-License-Identifier: MIT */
#include "march.h"

#include <stdint.h>
#include <stdlib.h>

#include "march_priv.h"
#include "mem.h"
#include "parallel.h"

static enum bake_status
check_depth(const struct bake_image *depth, struct bake_err *err)
{
	if (depth->nchans != 1)
		return bake_fail(err, BAKE_EINVAL,
		    "a depth map has 1 channel, not %d", depth->nchans);
	if (depth->width < 1 || depth->height < 1 ||
	    depth->width > BAKE_MARCH_SIDE_MAX ||
	    depth->height > BAKE_MARCH_SIDE_MAX)
		return bake_fail(err, BAKE_EINVAL,
		    "the depth map is %dx%d, its sides may be 1 to %d",
		    depth->width, depth->height, BAKE_MARCH_SIDE_MAX);
	/* cells are numbered in 32 bits */
	if ((uint64_t)(depth->width + 2) * (uint64_t)(depth->height + 1) >
	    UINT32_MAX)
		return bake_fail(err, BAKE_ENOMEM,
		    "the depth map of %dx%d is too large to be marched",
		    depth->width, depth->height);
	for (int y = 0; y < depth->height; y++) {
		const float *row = bake_image_row(depth, y);

		for (int x = 0; x < depth->width; x++)
			if (!isfinite(row[x]))
				return bake_fail(err, BAKE_EDATA,
				    "the depth at (%d, %d) is not finite", x,
				    y);
	}
	return BAKE_OK;
}

/* The row of texels j, counted upwards, beyond the border too. */
static const float *
texel_row(const struct bake_image *depth, int j, bool clamp)
{
	const int up = bake_wrap_index(j, depth->height, clamp);

	return bake_image_row(depth, depth->height - 1 - up);
}

static void
fill_row(struct bake_relief_map *map, const struct bake_image *depth, int j)
{
	const float *under = texel_row(depth, j - 1, map->wrap.clamp_v);
	const float *over = texel_row(depth, j, map->wrap.clamp_v);
	float *out = map->cells + 2 * (size_t)j * map->stride;

	for (int i = 0; i < (int)map->stride; i++) {
		const int x =
		    bake_wrap_index(i - 1, map->width, map->wrap.clamp_u);

		out[2 * i] = under[x];
		out[2 * i + 1] = over[x];
	}
}

static inline float
lower(float a, float b)
{
	return b < a ? b : a;
}

static float
cell_low(const struct bake_relief_map *map, int i, int j)
{
	const float *c = bake_march_cell(map, (unsigned)i, (unsigned)j);

	return lower(lower(c[0], c[1]), lower(c[2], c[3]));
}

static int
blocks(int ncells, int level)
{
	return ((ncells - 1) >> level) + 1;
}

/* Row j of the blocks of a level from those below it. */
static void
fill_lows(struct bake_relief_map *map, int level, int j)
{
	const int nx = blocks(map->width + 1, level - 1);
	const int ny = blocks(map->height + 1, level - 1);
	const int stride = map->low_stride[level - 1];
	float *out =
	    map->lows[level] + (size_t)j * (size_t)map->low_stride[level];

	for (int i = 0; i < map->low_stride[level]; i++) {
		float low = INFINITY;

		for (int y = 2 * j; y < 2 * j + 2 && y < ny; y++)
			for (int x = 2 * i; x < 2 * i + 2 && x < nx; x++)
				low = lower(low,
				    level == 1
					? cell_low(map, x, y)
					: map->lows[level - 1]
						   [(size_t)y * (size_t)stride +
						       (size_t)x]);
		out[i] = low;
	}
}

/* Allocate the cells and all levels up to that of one block. */
static enum bake_status
allocate(struct bake_relief_map *map, struct bake_err *err)
{
	const int longest =
	    (map->width > map->height ? map->width : map->height) + 1;
	size_t n;

	map->stride = (unsigned)map->width + 2;
	if (!bake_mul_size(map->stride, (size_t)map->height + 1, &n))
		return bake_fail(
		    err, BAKE_ENOMEM, "the depth map is too large");
	map->cells = bake_alloc(n, 2 * sizeof *map->cells, err);
	if (map->cells == NULL)
		return BAKE_ENOMEM;
	while (map->top == 0 || blocks(longest, map->top) > 1) {
		const int level = ++map->top;

		map->low_stride[level] = blocks(map->width + 1, level);
		if (!bake_mul_size((size_t)map->low_stride[level],
			(size_t)blocks(map->height + 1, level), &n))
			return bake_fail(
			    err, BAKE_ENOMEM, "the depth map is too large");
		map->lows[level] = bake_alloc(n, sizeof *map->lows[level], err);
		if (map->lows[level] == NULL)
			return BAKE_ENOMEM;
	}
	return BAKE_OK;
}

enum bake_status
bake_relief_map_open(struct bake_relief_map **map,
    const struct bake_image *depth, struct bake_wrap wrap, int nthreads,
    struct bake_err *err)
{
	struct bake_relief_map *m;
	enum bake_status rc;

	*map = NULL;
	if ((rc = check_depth(depth, err)) != BAKE_OK)
		return rc;
	m = bake_zalloc(1, sizeof *m, err);
	if (m == NULL)
		return BAKE_ENOMEM;
	m->width = depth->width;
	m->height = depth->height;
	m->wrap = wrap;
	m->isa = bake_isa_pick();
	if ((rc = allocate(m, err)) != BAKE_OK) {
		bake_relief_map_close(m);
		return rc;
	}
#pragma omp parallel for schedule(static) num_threads(bake_threads(nthreads))
	for (int j = 0; j <= m->height; j++)
		fill_row(m, depth, j);
	for (int level = 1; level <= m->top; level++) {
		const int ny = blocks(m->height + 1, level);

#pragma omp parallel for schedule(static) num_threads(bake_threads(nthreads))
		for (int j = 0; j < ny; j++)
			fill_lows(m, level, j);
	}
	*map = m;
	return BAKE_OK;
}

void
bake_relief_map_close(struct bake_relief_map *map)
{
	if (map == NULL)
		return;
	free(map->cells);
	for (int i = 0; i < BAKE_MARCH_LEVELS; i++)
		free(map->lows[i]);
	free(map);
}

void
bake_relief_map_sample(const struct bake_relief_map *map, int n, const float *u,
    const float *v, float *d)
{
	static int (*const sample[])(const struct bake_relief_map *, int,
	    const float *, const float *, float *) =
	    BAKE_KERNEL_TABLE(bake_march_sample);

	for (int i = sample[map->isa](map, n, u, v, d); i < n; i++)
		d[i] = bake_march_depth(map, u[i], v[i]);
}

static struct bake_march_params
usable(const struct bake_march_params *params)
{
	struct bake_march_params p = *params;

	if (p.nlinear < 1)
		p.nlinear = 1;
	if (p.nlinear > BAKE_MARCH_STEPS_MAX)
		p.nlinear = BAKE_MARCH_STEPS_MAX;
	return p;
}

void
bake_march(const struct bake_relief_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays)
{
	static void (*const march[])(const struct bake_relief_map *,
	    const struct bake_march_params *, const struct bake_rays *) =
	    BAKE_KERNEL_TABLE(bake_march_linear);
	const struct bake_march_params p = usable(params);

	if (p.search == BAKE_SEARCH_EXACT)
		bake_march_exact(map, rays);
	else
		march[map->isa](map, &p, rays);
}

void
bake_march_any(const struct bake_relief_map *map,
    const struct bake_march_params *params, float bias,
    const struct bake_rays *rays)
{
	static void (*const march[])(const struct bake_relief_map *,
	    const struct bake_march_params *, float, const struct bake_rays *) =
	    BAKE_KERNEL_TABLE(bake_march_linear_any);
	const struct bake_march_params p = usable(params);

	if (p.search == BAKE_SEARCH_EXACT)
		bake_march_any_exact(map, bias, rays);
	else
		march[map->isa](map, &p, bias, rays);
}
