/* The far field of fast horizons, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#include "horizon_priv.h"
#include "isa.h"
#include "vec_priv.h"

#define INLINE inline __attribute__((always_inline))

enum { NPARTS = BAKE_FAR_BLOCK };
_Static_assert(NPARTS == 4, "two unzips part a block's texels");

/* v[o] takes what is at 4 i + o of the vectors v[0] .. v[3]. */
static INLINE void
part(vec_f v[NPARTS])
{
	vec_f e0, o0, e1, o1;

	vec_unzip(v[0], v[1], &e0, &o0);
	vec_unzip(v[2], v[3], &e1, &o1);
	vec_unzip(e0, e1, &v[0], &v[2]);
	vec_unzip(o0, o1, &v[1], &v[3]);
}

static INLINE void
join(vec_f v[NPARTS])
{
	vec_f e0, o0, e1, o1;

	vec_zip(v[0], v[2], &e0, &e1);
	vec_zip(v[1], v[3], &o0, &o1);
	vec_zip(e0, o0, &v[0], &v[1]);
	vec_zip(e1, o1, &v[2], &v[3]);
}

/* Texel o of as many blocks as a vector has lanes. */
static INLINE vec_f
texels(const float *p, size_t i, int o, const bool x_major)
{
	vec_f v[NPARTS];

	if (!x_major)
		return vec_load(p + i);
	for (int k = 0; k < NPARTS; k++)
		v[k] = vec_load(p + NPARTS * i + (size_t)k * VEC_LANES);
	part(v);
	return v[o];
}

static INLINE void
make_blocks(float *dst, const struct bake_horizon_blocks *blocks, size_t n,
    const bool x_major)
{
	const vec_f highest = vec_set(blocks->highest);

	for (size_t i = 0; i < n; i += VEC_LANES) {
		vec_f high = vec_set(-1e38f);

		for (int o = 0; o < NPARTS; o++) {
			const vec_f a = texels(blocks->a[o], i, o, x_major);
			const vec_f b = texels(blocks->b[o], i, o, x_major);
			const vec_f v = a + vec_set(blocks->frac[o]) * (b - a);

			high = vec_max(v, high);
		}
		vec_store(dst + i, vec_min(high, highest));
	}
}

void
BAKE_KERNEL(bake_horizon_far_blocks)(
    float *dst, const struct bake_horizon_blocks *blocks, size_t n)
{
	if (blocks->x_major)
		make_blocks(dst, blocks, n, true);
	else
		make_blocks(dst, blocks, n, false);
}

void
BAKE_KERNEL(bake_horizon_higher)(
    float *dst, const float *a, const float *b, size_t n)
{
	for (size_t i = 0; i < n; i++)
		dst[i] = a[i] > b[i] ? a[i] : b[i];
}

/* Whether anything at that distance or beyond may raise a horizon. */
static inline bool
alive(const struct bake_horizon *hz, const vec_f here[NPARTS],
    const vec_f best[NPARTS], float reach)
{
	const vec_f d = vec_set(reach), slack = vec_set(hz->slack);
	vec_f low = vec_set(1e38f);

	for (int i = 0; i < NPARTS; i++)
		low = vec_min(
		    here[i] + vec_max(best[i] * d - slack, vec_set(0)), low);
	return vec_lowest(low) < hz->highest;
}

/* The texels of a group of blocks: texel o of each in v[o]. */
static INLINE void
load_group(vec_f v[NPARTS], const float *p, size_t stride, const bool x_major)
{
	for (int o = 0; o < NPARTS; o++)
		v[o] = vec_load(p + (size_t)o * (x_major ? VEC_LANES : stride));
	if (x_major)
		part(v);
}

static INLINE void
store_group(vec_f v[NPARTS], float *p, size_t stride, const bool x_major)
{
	if (x_major)
		join(v);
	for (int o = 0; o < NPARTS; o++)
		vec_store(p + (size_t)o * (x_major ? VEC_LANES : stride), v[o]);
}

/* One segment that all texels of a block share. */
static INLINE void
raise_group(
    vec_f best[NPARTS], const vec_f here[NPARTS], vec_f top, float weight)
{
	const vec_f w = vec_set(weight);

	for (int o = 0; o < NPARTS; o++)
		best[o] = vec_max(w * (top - here[o]), best[o]);
}

/* Segments for a group of blocks, the first 'fine' floats from the tile's, or
 * 'coarse'. */
static INLINE void
march_group(const struct bake_horizon *hz, const struct bake_horizon_span *span,
    size_t fine, size_t coarse, const float *base, float *slopes,
    const bool x_major)
{
	const struct bake_horizon_segment *segments = span->segments;
	vec_f here[NPARTS], best[NPARTS];

	load_group(here, base, hz->heights.row_stride, x_major);
	load_group(best, slopes, BAKE_TILE_WIDTH, x_major);
	if (!alive(hz, here, best, segments[0].reach))
		return;
	for (int s = 0; s < span->nseparate; s++)
		for (int o = 0; o < NPARTS; o++) {
			const vec_f top = vec_load(span->origin[s][o] + fine);
			const vec_f w = vec_set(segments[s].weight[o]);

			best[o] = vec_max(w * (top - here[o]), best[o]);
		}
	for (int s = span->nseparate; s < span->nfine; s++)
		raise_group(best, here, vec_load(span->origin[s][0] + fine),
		    segments[s].weight[0]);
	for (int s = span->nfine; s < span->n; s++)
		raise_group(best, here,
		    x_major ? vec_spread(span->origin[s][0] + coarse)
			    : vec_load(span->origin[s][0] + coarse),
		    segments[s].weight[0]);
	store_group(best, slopes, BAKE_TILE_WIDTH, x_major);
}

static INLINE void
march_tile(const struct bake_horizon *hz, const struct bake_horizon_span *span,
    const float *base, float *slopes, const bool x_major)
{
	const struct bake_horizon_grid *fine = &hz->far.grid[0];
	const struct bake_horizon_grid *coarse = &hz->far.grid[1];
	const size_t width = x_major ? NPARTS : 1,
		     height = x_major ? 1 : NPARTS;

	for (size_t y = 0; y < BAKE_TILE_HEIGHT; y += height)
		for (size_t x = 0; x < BAKE_TILE_WIDTH; x += width * VEC_LANES)
			march_group(hz, span,
			    y / height * fine->stride + x / width,
			    y / (size_t)coarse->block_height * coarse->stride +
				x / (size_t)coarse->block_width,
			    base + y * hz->heights.row_stride + x,
			    slopes + y * BAKE_TILE_WIDTH + x, x_major);
}

void
BAKE_KERNEL(bake_horizon_far_march)(const struct bake_horizon *hz,
    const struct bake_horizon_span *span, const float *base, float *slopes)
{
	if (hz->ray[0].dir.x_major)
		march_tile(hz, span, base, slopes, true);
	else
		march_tile(hz, span, base, slopes, false);
}
