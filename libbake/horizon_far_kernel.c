/* The far field of fast horizons, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#include "horizon_priv.h"
#include "isa.h"
#include "vec_priv.h"

enum {
	GROUP_WIDTH = 2 * VEC_LANES, /* texels */
	NPARTS = 4                   /* texels of a block */
};

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

/* Segments for a group of blocks, whose four texels share what they see. */
static void
march_group(const struct bake_horizon *hz, const struct bake_horizon_span *span,
    size_t block, const float *base, float *slopes)
{
	const struct bake_horizon_segment *segments =
	    hz->far.segments + span->first;
	const size_t stride = hz->heights.row_stride;
	vec_f here[NPARTS], best[NPARTS];

	for (size_t r = 0; r < 2; r++) {
		vec_unzip(base + r * stride, &here[2 * r], &here[2 * r + 1]);
		vec_unzip(slopes + r * BAKE_TILE_WIDTH, &best[2 * r],
		    &best[2 * r + 1]);
	}
	if (!alive(hz, here, best, segments[0].reach))
		return;
	for (int s = 0; s < span->n; s++) {
		const vec_f top = vec_load(span->origin[s] + block);
		const vec_f w = vec_set(segments[s].weight);

		for (int i = 0; i < NPARTS; i++)
			best[i] = vec_max(w * (top - here[i]), best[i]);
	}
	for (size_t r = 0; r < 2; r++)
		vec_zip(
		    slopes + r * BAKE_TILE_WIDTH, best[2 * r], best[2 * r + 1]);
}

void
BAKE_KERNEL(bake_horizon_far_march)(const struct bake_horizon *hz,
    const struct bake_horizon_span *span, const float *base, float *slopes)
{
	for (size_t y = 0; y < BAKE_TILE_HEIGHT; y += 2)
		for (size_t x = 0; x < BAKE_TILE_WIDTH; x += GROUP_WIDTH)
			march_group(hz, span, y / 2 * hz->far.stride + x / 2,
			    base + y * hz->heights.row_stride + x,
			    slopes + y * BAKE_TILE_WIDTH + x);
}
