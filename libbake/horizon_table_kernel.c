/* What tells the exact march which chunks to skip, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#define BAKE_VEC_256 /* as the march, which reads these tables */
#include <math.h>
#include <string.h>

#include "horizon_priv.h"
#include "isa.h"
#include "vec_priv.h"

/* this far right of a clamped map, nothing but its border is looked at */
enum { ALL_BORDER = 40 };

/* What a crest is made of: for each step a row of the map, dx being the least
 * of their offsets. */
struct taps {
	int dx;
	ptrdiff_t minor;
	const float *at[BAKE_CHUNK];
};

/* The taps for row y. */
static struct taps
find_taps(const struct bake_horizon *hz, int y)
{
	const struct bake_horizon_dir *dir = &hz->ray[0].dir;
	const ptrdiff_t stride = (ptrdiff_t)hz->heights.row_stride;
	struct taps taps = { .minor = dir->x_major ? stride : 1 };
	int dx[BAKE_CHUNK];

	for (int i = 0; i < BAKE_CHUNK; i++) {
		const int minor =
		    (int)floor(i * dir->minor + BAKE_HORIZON_SNAP);
		const int dy = dir->x_major ? minor : i * dir->major;
		const int row = hz->wrap.clamp_v
				    ? bake_horizon_wrap(y + dy,
					  hz->heights.height, true, hz->top)
				    : bake_wrap_index((long)y + dy,
					  hz->heights.height, false);

		dx[i] = dir->x_major ? i * dir->major : minor;
		taps.dx = dx[i] < taps.dx ? dx[i] : taps.dx;
		taps.at[i] = hz->heights.data + row * stride;
	}
	for (int i = 0; i < BAKE_CHUNK; i++)
		taps.at[i] += dx[i] - taps.dx;
	return taps;
}

/* The highest texel that any ray through the chunk can meet, wherever
 * between two texels it starts. */
static inline vec_f
crest_at(const struct taps *taps, ptrdiff_t x)
{
	vec_f high = vec_load(taps->at[0] + x);

	for (int i = 0; i < BAKE_CHUNK; i++) {
		const float *p = taps->at[i] + x;

		high = vec_max(vec_max(vec_load(p), vec_load(p + taps->minor)),
		    vec_max(vec_load(p + 2 * taps->minor), high));
	}
	return high;
}

void
BAKE_KERNEL(bake_horizon_crest_row)(const struct bake_horizon *hz, int y)
{
	const struct taps taps = find_taps(hz, y);
	const int width = hz->heights.width;
	const int left = hz->left, n = hz->padded_width;
	const bool clamp = hz->wrap.clamp_u;
	float *out =
	    hz->crests + (size_t)(y + hz->top) * hz->heights.row_stride;
	int px = bake_wrap_index(taps.dx, width, false);

	for (int x = 0; x < n; x += VEC_LANES) {
		/* where all is border, anywhere there will do */
		const int at = clamp ? bake_horizon_wrap(x - left + taps.dx,
					   width + ALL_BORDER, true, left)
				     : px;
		vec_f high = crest_at(&taps, at);
		float rest[VEC_LANES];

		for (px += VEC_LANES; px >= width;)
			px -= width;
		if (x + VEC_LANES <= n) {
			vec_store(out + x, high);
			continue;
		}
		vec_store(rest, high);
		for (int i = 0; x + i < n; i++)
			out[x + i] = rest[i];
	}
}

/* dst(x) = max of src(x) and src(x + add) for one row of windows; beyond the
 * last origin windows are cut short, and not used. */
static void
widen_row(float *dst, const float *src, size_t stride, int add)
{
	for (int p = 0; p < BAKE_WINDOW_PHASES; p++) {
		const size_t skip = (size_t)(p + add) / BAKE_WINDOW_PHASES;
		const float *a = src + (size_t)p * stride;
		const float *b =
		    src + (size_t)(p + add) % BAKE_WINDOW_PHASES * stride +
		    skip;
		float *out = dst + (size_t)p * stride;

		for (size_t i = 0; i < stride - skip; i++)
			out[i] = a[i] > b[i] ? a[i] : b[i];
		for (size_t i = stride - skip; i < stride; i++)
			out[i] = a[i];
	}
}

void
BAKE_KERNEL(bake_horizon_windows_row)(
    const struct bake_horizon *hz, int y2, float *scratch)
{
	const size_t stride = hz->windows.stride;
	const size_t n = stride * BAKE_WINDOW_PHASES;
	float *from = scratch, *to = scratch + n;
	int last = 1;

	memcpy(
	    from, bake_horizon_window_row(&hz->blocks, y2), n * sizeof *from);
	for (int i = 1; i < hz->rows; i++) {
		const float *src = bake_horizon_window_row(&hz->blocks, y2 + i);

		for (size_t x = 0; x < n; x++)
			from[x] = src[x] > from[x] ? src[x] : from[x];
	}
	/* windows of 2, 4, 8 columns and then two that overlap */
	while (last < hz->columns) {
		int add = last < hz->columns - last ? last : hz->columns - last;
		float *t = from;

		widen_row(to, from, stride, add);
		from = to;
		to = t;
		last += add;
	}
	memcpy(
	    bake_horizon_window_row(&hz->windows, y2), from, n * sizeof *from);
}
