/* Multilayer marching: the layers made ready, what is hit, and the searches. */
/* SPDX-License-Identifier: MIT */
#include "multi_march.h"

#include <stdint.h>
#include <stdlib.h>

#include "layer_codes.h"
#include "layer_priv.h"
#include "mem.h"
#include "multi_march_priv.h"
#include "parallel.h"

/* Rays that are searched at a time. */
enum { BATCH = 256 };

static enum bake_status
check_maps(const struct bake_layer_maps *maps, struct bake_err *err)
{
	if (maps->width < 1 || maps->height < 1 ||
	    maps->width > BAKE_MULTI_SIDE_MAX ||
	    maps->height > BAKE_MULTI_SIDE_MAX)
		return bake_fail(err, BAKE_EINVAL,
		    "the layers are %dx%d, their sides may be 1 to %d",
		    maps->width, maps->height, BAKE_MULTI_SIDE_MAX);
	if (maps->nlayers < 1 || maps->nlayers > BAKE_LAYERS_MAX ||
	    (maps->nlayers > 1 && maps->nlayers % 2 != 0))
		return bake_fail(err, BAKE_EINVAL,
		    "%d layers, expected 1 or an even number up to %d",
		    maps->nlayers, BAKE_LAYERS_MAX);
	return BAKE_OK;
}

static size_t
texels(const struct bake_multi_map *map)
{
	return (size_t)map->width * (size_t)map->height;
}

/* Texel k of the map as the images number it, whose row 0 is the top. */
static size_t
image_texel(const struct bake_multi_map *map, size_t k)
{
	const size_t w = (size_t)map->width;

	return ((size_t)map->height - 1 - k / w) * w + k % w;
}

/* The counts, where each texel's layers begin, and how many there are. */
static enum bake_status
count_layers(struct bake_multi_map *map, const struct bake_layer_maps *maps,
    size_t *total, struct bake_err *err)
{
	const size_t n = texels(map);

	*total = 0;
	for (size_t k = 0; k < n; k++) {
		int count =
		    bake_layer_codes_of(maps, image_texel(map, k), NULL);

		if (maps->nlayers > 1)
			count -= count % 2;
		map->count[k] = (uint8_t)count;
		map->first[k] = (uint32_t)*total;
		map->deep = map->deep || count > 4;
		*total += (size_t)count;
		if (*total > UINT32_MAX)
			return bake_fail(err, BAKE_ENOMEM,
			    "more than 2^32 layers are too many to be marched");
	}
	return BAKE_OK;
}

static float
value_of(const struct bake_pixels *px, size_t i)
{
	return bake_layer_value(bake_pixels_code(px, i), px->format);
}

/* A layer moves before those that are deeper, where the depths do not rise. */
static void
put_layer(float *depths, float (*normals)[2], int i, float d, const float n[2])
{
	for (; i > 0 && depths[i - 1] > d; i--) {
		depths[i] = depths[i - 1];
		normals[i][0] = normals[i - 1][0];
		normals[i][1] = normals[i - 1][1];
	}
	depths[i] = d;
	normals[i][0] = n[0];
	normals[i][1] = n[1];
}

static void
fill_texel(
    struct bake_multi_map *map, const struct bake_layer_maps *maps, size_t k)
{
	const size_t t = image_texel(map, k);
	float *depths = map->depths + map->first[k];
	float(*normals)[2] = map->normals + map->first[k];

	for (int i = 0; i < map->count[k]; i++) {
		const size_t at = 4 * t + (size_t)(i % 4);
		const double d =
		    bake_layer_depth((double)value_of(&maps->depth[i / 4], at));
		const float n[2] = { 2 * value_of(&maps->nx[i / 4], at) - 1,
			2 * value_of(&maps->ny[i / 4], at) - 1 };

		put_layer(depths, normals, i, (float)d, n);
	}
	for (int i = 0; i < 4; i++)
		map->quads[k][i] = i < map->count[k] ? depths[i] : INFINITY;
}

/* How far the solid of a block reaches, in depth. */
static void
fill_block(struct bake_multi_map *map, int bx, int by)
{
	const int x0 = bx << BAKE_MULTI_BLOCK, y0 = by << BAKE_MULTI_BLOCK;
	const int size = 1 << BAKE_MULTI_BLOCK;
	struct bake_multi_block b = { INFINITY, -INFINITY };

	for (int y = y0; y < y0 + size && y < map->height; y++)
		for (int x = x0; x < x0 + size && x < map->width; x++) {
			const size_t k =
			    (size_t)y * (size_t)map->width + (size_t)x;
			const int n = map->count[k];
			const float *d = map->depths + map->first[k];

			if (n == 0)
				continue;
			b.low = d[0] < b.low ? d[0] : b.low;
			if (n % 2 != 0)
				b.high = INFINITY;
			else if (d[n - 1] > b.high)
				b.high = d[n - 1];
		}
	map->blocks[(size_t)by * (size_t)map->block_stride + (size_t)bx] = b;
}

static int
block_count(int side)
{
	return ((side - 1) >> BAKE_MULTI_BLOCK) + 1;
}

static enum bake_status
allocate(struct bake_multi_map *map, const struct bake_layer_maps *maps,
    struct bake_err *err)
{
	enum bake_status rc;
	size_t total, n;

	if (!bake_mul_size((size_t)map->width, (size_t)map->height, &n))
		return bake_fail(err, BAKE_ENOMEM,
		    "layers of %dx%d are too large to be marched", map->width,
		    map->height);
	if ((map->count = bake_alloc(n, sizeof *map->count, err)) == NULL ||
	    (map->first = bake_alloc(n, sizeof *map->first, err)) == NULL ||
	    (map->quads = bake_alloc(n, sizeof *map->quads, err)) == NULL)
		return BAKE_ENOMEM;
	if ((rc = count_layers(map, maps, &total, err)) != BAKE_OK)
		return rc;
	map->block_stride = block_count(map->width);
	n = (size_t)map->block_stride * (size_t)block_count(map->height);
	map->depths = bake_alloc(total, sizeof *map->depths, err);
	map->normals = bake_alloc(total, sizeof *map->normals, err);
	map->blocks = bake_alloc(n, sizeof *map->blocks, err);
	if (map->depths == NULL || map->normals == NULL || map->blocks == NULL)
		return BAKE_ENOMEM;
	return BAKE_OK;
}

enum bake_status
bake_multi_map_open(struct bake_multi_map **map,
    const struct bake_layer_maps *maps, struct bake_wrap wrap, int nthreads,
    struct bake_err *err)
{
	struct bake_multi_map *m;
	enum bake_status rc;

	*map = NULL;
	if ((rc = check_maps(maps, err)) != BAKE_OK)
		return rc;
	m = bake_zalloc(1, sizeof *m, err);
	if (m == NULL)
		return BAKE_ENOMEM;
	m->width = maps->width;
	m->height = maps->height;
	m->wrap = wrap;
	m->isa = bake_isa_pick();
	if ((rc = allocate(m, maps, err)) != BAKE_OK) {
		bake_multi_map_close(m);
		return rc;
	}
#pragma omp parallel for schedule(static) num_threads(bake_threads(nthreads))
	for (int j = 0; j < m->height; j++)
		for (int i = 0; i < m->width; i++)
			fill_texel(
			    m, maps, (size_t)j * (size_t)m->width + (size_t)i);
#pragma omp parallel for schedule(static) num_threads(bake_threads(nthreads))
	for (int j = 0; j < block_count(m->height); j++)
		for (int i = 0; i < m->block_stride; i++)
			fill_block(m, i, j);
	*map = m;
	return BAKE_OK;
}

void
bake_multi_map_size(const struct bake_multi_map *map, int *width, int *height)
{
	*width = map->width;
	*height = map->height;
}

void
bake_multi_map_close(struct bake_multi_map *map)
{
	if (map == NULL)
		return;
	free(map->quads);
	free(map->first);
	free(map->count);
	free(map->depths);
	free(map->normals);
	free(map->blocks);
	free(map);
}

/* -- what was hit -------------------------------------------------------- */

void
bake_multi_put(const struct bake_multi_map *map,
    const struct bake_multi_hits *hits, int i, long texel, int layer)
{
	const float *n = map->normals[map->first[texel] + (uint32_t)layer];
	const float flat = n[0] * n[0] + n[1] * n[1];
	const float scale = flat > 1 ? 1 / sqrtf(flat) : 1;
	const float up = flat < 1 ? sqrtf(1 - flat) : 0;

	hits->nx[i] = n[0] * scale;
	hits->ny[i] = n[1] * scale;
	hits->nz[i] = layer % 2 != 0 ? -up : up;
	if (hits->layer != NULL)
		hits->layer[i] = layer;
	if (hits->u != NULL)
		hits->u[i] =
		    ((float)(texel % map->width) + 0.5f) / (float)map->width;
	if (hits->v != NULL)
		hits->v[i] =
		    ((float)(texel / map->width) + 0.5f) / (float)map->height;
}

int
bake_multi_nearest(const struct bake_multi_map *map, long texel, double z)
{
	const float *d = bake_multi_depths(map, texel);
	int best = 0;

	for (int i = 1; i < map->count[texel]; i++)
		if (fabs(z - (double)d[i]) < fabs(z - (double)d[best]))
			best = i;
	return best;
}

/*
 * Where between t = a, outside, and t = b, inside texel `in`, the ray comes to
 * a depth of that texel; b where it comes in through its wall.
 */
static float
secant(const struct bake_multi_map *map, const struct bake_rays *rays, int i,
    float a, long in)
{
	const float b = rays->hit[i], dz = rays->dz[i], q = rays->q[i];
	const float za = rays->z[i] + a * (dz - a * q);
	const float zb = rays->z[i] + b * (dz - b * q);
	const int k = bake_multi_above(map, in, zb);
	const float *d = bake_multi_depths(map, in);
	float level, t;

	if (za <= d[k - 1])
		level = d[k - 1];
	else if (k < map->count[in] && za > d[k])
		level = d[k];
	else
		return b;
	t = a + (b - a) * ((level - za) / (zb - za));
	t = t > a ? t : a;
	t = t < b ? t : b;
	return bake_multi_texel(map, rays->u[i] + t * rays->du[i],
		   rays->v[i] + t * rays->dv[i]) == in
		   ? t
		   : b;
}

/* Section 3.2: of the last texels outside and inside, that with more layers. */
static void
put_searched(const struct bake_multi_map *map, const struct bake_rays *rays,
    const struct bake_multi_hits *hits, int i, float before, bool refined)
{
	float t = rays->hit[i], z;
	const long in = bake_multi_texel(
	    map, rays->u[i] + t * rays->du[i], rays->v[i] + t * rays->dv[i]);
	const long out =
	    bake_multi_texel(map, rays->u[i] + before * rays->du[i],
		rays->v[i] + before * rays->dv[i]);
	const bool more =
	    bake_multi_count(map, out) > bake_multi_count(map, in);
	const long texel = more ? out : in;

	if (refined && t > 0)
		rays->hit[i] = t = secant(map, rays, i, before, in);
	z = rays->z[i] + t * (rays->dz[i] - t * rays->q[i]);
	bake_multi_put(
	    map, hits, i, texel, bake_multi_nearest(map, texel, (double)z));
}

/* -- the searches -------------------------------------------------------- */

static struct bake_march_params
usable(const struct bake_march_params *params)
{
	struct bake_march_params p = *params;

	if (p.nlinear < 1)
		p.nlinear = 1;
	if (p.nlinear > BAKE_MULTI_STEPS_MAX)
		p.nlinear = BAKE_MULTI_STEPS_MAX;
	return p;
}

/* Rays first .. first + n - 1. */
static struct bake_rays
part(const struct bake_rays *rays, int first, int n)
{
	return (struct bake_rays){ n, rays->u + first, rays->v + first,
		rays->z + first, rays->du + first, rays->dv + first,
		rays->dz + first, rays->q + first, rays->t_end + first,
		rays->hit + first };
}

void
bake_multi_march(const struct bake_multi_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays,
    const struct bake_multi_hits *hits)
{
	static void (*const search[])(const struct bake_multi_map *,
	    const struct bake_march_params *, const struct bake_rays *,
	    float *) = BAKE_KERNEL_TABLE(bake_multi_search);
	const struct bake_march_params p = usable(params);

	if (p.search == BAKE_SEARCH_EXACT) {
		bake_multi_exact(map, rays, hits);
		return;
	}
	for (int at = 0; at < rays->n; at += BATCH) {
		const int left = rays->n - at;
		const struct bake_rays some =
		    part(rays, at, left < BATCH ? left : BATCH);
		float before[BATCH];

		search[map->isa](map, &p, &some, before);
		for (int i = 0; i < some.n; i++)
			if (some.hit[i] >= 0)
				put_searched(map, rays, hits, at + i, before[i],
				    p.secant);
	}
}

void
bake_multi_march_any(const struct bake_multi_map *map,
    const struct bake_march_params *params, float skip,
    const struct bake_rays *rays)
{
	static void (*const any[])(const struct bake_multi_map *,
	    const struct bake_march_params *, float, const struct bake_rays *) =
	    BAKE_KERNEL_TABLE(bake_multi_any);
	const struct bake_march_params p = usable(params);

	if (p.search == BAKE_SEARCH_EXACT)
		bake_multi_any_exact(map, skip, rays);
	else
		any[map->isa](map, &p, skip, rays);
}
