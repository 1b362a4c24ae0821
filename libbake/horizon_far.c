/* The far field of fast horizons: maxima over runs of doubling length. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "horizon_priv.h"
#include "mem.h"

/* A segment's origin is on the map or, on a clamped axis, as much as a tile
 * before it or one block beyond it. */
enum { BEYOND = 1 };

/* How a direction's levels lie in memory. */
static void
set_layout(struct bake_horizon *hz, bool x_major)
{
	struct bake_horizon_far *far = &hz->far;
	const int width = hz->heights.width, height = hz->heights.height;

	far->block_width = x_major ? BAKE_FAR_BLOCK : 1;
	far->block_height = x_major ? 1 : BAKE_FAR_BLOCK;
	far->width = (width - 1) / far->block_width + 1;
	far->height = (height - 1) / far->block_height + 1;
	far->columns = BAKE_TILE_WIDTH / far->block_width;
	far->rows = BAKE_TILE_HEIGHT / far->block_height;
	far->left = hz->wrap.clamp_u ? far->columns : 0;
	far->top = hz->wrap.clamp_v ? far->rows : 0;
	far->stride = (size_t)far->left + (size_t)far->width +
		      (size_t)far->columns + BEYOND;
}

static size_t
layout_nrows(const struct bake_horizon_far *far)
{
	return (size_t)far->top + (size_t)far->height + (size_t)far->rows +
	       BEYOND;
}

/* Complete a row whose blocks 0 .. width - 1 are there. */
static void
pad_row(const struct bake_horizon_far *far, float *row, bool clamp)
{
	const int n = far->columns + BEYOND;

	for (int x = 1; x <= far->left; x++)
		row[-x] = row[0];
	for (int x = 0; x < n; x++) /* ever further, from what is there */
		row[far->width + x] = clamp ? row[far->width - 1] : row[x];
}

float *
bake_horizon_far_row(const struct bake_horizon_far *far, int level, int y)
{
	return far->levels + (size_t)level * far->level_size +
	       (size_t)(y + far->top) * far->stride + far->left;
}

/* What row y of level 0 is made of. */
static struct bake_horizon_blocks
find_texels(const struct bake_horizon *hz, int y)
{
	const struct bake_horizon_far *far = &hz->far;
	const bool x_major = hz->dir.x_major, clamp = hz->wrap.clamp_v;
	const int height = hz->heights.height;
	const int first =
	    far->block_height * bake_wrap_index(y, far->height, clamp);
	struct bake_horizon_blocks blocks = { .highest = hz->highest,
		.x_major = x_major };

	for (int o = 0; o < BAKE_FAR_BLOCK; o++) {
		const int offset = far->sample[o].offset;
		const int ya = first + (x_major ? offset : o);

		blocks.frac[o] = far->sample[o].frac;
		blocks.a[o] = bake_image_row(
		    &hz->heights, bake_wrap_index(ya, height, clamp));
		blocks.b[o] = bake_image_row(
		    &hz->heights, bake_wrap_index(ya + x_major, height, clamp));
		if (!x_major) {
			blocks.a[o] += offset;
			blocks.b[o] += offset + 1;
		}
	}
	return blocks;
}

static void
move_right(struct bake_horizon_blocks *blocks, int columns)
{
	for (int o = 0; o < BAKE_FAR_BLOCK; o++) {
		blocks->a[o] += columns;
		blocks->b[o] += columns;
	}
}

/*
 * Row y of level 0. What a block reads beyond the map is in its border, except
 * to the left of a torus: whole periods further right it is, too.
 */
static void
make_blocks(const struct bake_horizon *hz, int y)
{
	static void (*const make[])(float *, const struct bake_horizon_blocks *,
	    size_t) = BAKE_KERNEL_TABLE(bake_horizon_far_blocks);
	const struct bake_horizon_far *far = &hz->far;
	struct bake_horizon_blocks blocks = find_texels(hz, y);
	float *out = bake_horizon_far_row(far, 0, y);
	const int most = BAKE_FAR_BLOCK - 1; /* columns to the left */
	int n = 0;

	if (!hz->dir.x_major && !hz->wrap.clamp_u) {
		struct bake_horizon_blocks lifted = blocks;

		n = far->width < most ? far->width : most;
		for (int lift = 0; lift < most; lift += far->width)
			move_right(&lifted, far->width);
		make[hz->isa](out, &lifted, (size_t)n);
		move_right(&blocks, n);
	}
	make[hz->isa](out + n, &blocks, (size_t)(far->width - n));
	pad_row(far, out, hz->wrap.clamp_u);
}

/* Row y of level m + 1 from level m. */
static void
make_level_row(const struct bake_horizon *hz, int m, int y)
{
	static void (*const higher[])(float *, const float *, const float *,
	    size_t) = BAKE_KERNEL_TABLE(bake_horizon_higher);
	const struct bake_horizon_far *far = &hz->far;
	const struct bake_wrap wrap = hz->wrap;
	const int width = far->width;
	const int y0 = bake_wrap_index(y, far->height, wrap.clamp_v);
	const int y1 = bake_wrap_index(
	    (long)y0 + far->step[m].y, far->height, wrap.clamp_v);
	const float *a = bake_horizon_far_row(far, m, y0);
	const float *b = bake_horizon_far_row(far, m, y1);
	float *out = bake_horizon_far_row(far, m + 1, y);
	const int dx = far->step[m].x;

	if (!wrap.clamp_u) {
		const int x = bake_wrap_index(dx, width, false);

		higher[hz->isa](out, a, b + x, (size_t)(width - x));
		higher[hz->isa](out + width - x, a + width - x, b, (size_t)x);
	} else {
		const int n = dx < width && dx > -width ? width - abs(dx) : 0;
		const int from = dx < 0 ? width - n : 0;
		const float edge = b[dx < 0 ? 0 : width - 1];

		higher[hz->isa](out + from, a + from, b + from + dx, (size_t)n);
		for (int x = 0; x < width; x++)
			if (x < from || x >= from + n)
				out[x] = a[x] > edge ? a[x] : edge;
	}
	pad_row(far, out, wrap.clamp_u);
}

/* The offset of a segment's origin, reduced so that one wrap is enough. */
static int
reduce(double offset, int size, bool clamp)
{
	const double limit = 1 << 29;

	if (!clamp)
		return bake_wrap_index((long)offset, size, false);
	return (int)(offset < -limit  ? -limit
		     : offset > limit ? limit
				      : offset);
}

/* the minor axis' offset after k steps, to the nearest texel */
static double
minor_offset(const struct bake_horizon_dir *dir, double k)
{
	return floor(k * dir->minor + 0.5);
}

/* Texel o of a block is this many steps after the first one that a ray meets
 * there. */
static int
steps_into_block(const struct bake_horizon_dir *dir, int o)
{
	return dir->major > 0 ? o : BAKE_FAR_BLOCK - 1 - o;
}

static struct bake_horizon_segment
make_segment(const struct bake_horizon *hz, int level, long start)
{
	const struct bake_horizon_far *far = &hz->far;
	const struct bake_horizon_dir *dir = &hz->dir;
	struct bake_horizon_segment seg = { .level = level };
	const double major =
	    (double)(start / BAKE_FAR_BLOCK) * (double)dir->major;
	const double place =
	    far->place * (double)((BAKE_FAR_BLOCK << level) - 1);

	for (int o = 0; o < BAKE_FAR_BLOCK; o++) {
		const double k =
		    (double)start - (level < BAKE_FAR_SHARED
					    ? steps_into_block(dir, o)
					    : 0.5 * (BAKE_FAR_BLOCK - 1));
		const double minor = minor_offset(dir, k);

		seg.x[o] = reduce(
		    dir->x_major ? major : minor, far->width, hz->wrap.clamp_u);
		seg.y[o] = reduce(dir->x_major ? minor : major, far->height,
		    hz->wrap.clamp_v);
		seg.weight[o] = (float)(1 / ((k + place) * dir->pitch));
	}
	/* less than k + place is for the last of a block's texels */
	seg.reach = (float)(((double)start - 1) * dir->pitch * (1 - 0x1p-19));
	return seg;
}

static void
make_segments(struct bake_horizon *hz)
{
	struct bake_horizon_far *far = &hz->far;
	long start = far->near;
	int level = 0;

	far->nsegments = 0;
	while (start < hz->dir.nsteps) {
		while (
		    level + 1 < far->nlevels &&
		    far->per_octave * (2L * BAKE_FAR_BLOCK << level) <= start)
			level++;
		far->segments[far->nsegments++] =
		    make_segment(hz, level, start);
		start += (long)BAKE_FAR_BLOCK << level;
	}
	far->top_level = level;
}

static void
set_direction(struct bake_horizon *hz)
{
	struct bake_horizon_far *far = &hz->far;
	const struct bake_horizon_dir *dir = &hz->dir;

	set_layout(hz, dir->x_major);
	for (int o = 0; o < BAKE_FAR_BLOCK; o++) {
		const double at = steps_into_block(dir, o) * dir->minor;
		const double whole = floor(at + BAKE_HORIZON_SNAP);
		const double frac = at - whole;

		far->sample[o].offset = (int)whole;
		far->sample[o].frac =
		    frac < BAKE_HORIZON_SNAP ? 0 : (float)frac;
	}
	make_segments(hz);
	for (int i = 0; i < far->top_level; i++) {
		const int major = dir->major * (1 << i);
		const int minor = (int)minor_offset(dir, BAKE_FAR_BLOCK << i);

		far->step[i].x = dir->x_major ? major : minor;
		far->step[i].y = dir->x_major ? minor : major;
	}
}

void
bake_horizon_far_aim(struct bake_horizon *hz)
{
	struct bake_horizon_far *far = &hz->far;
	int last;

#pragma omp single
	set_direction(hz);
	if (far->nsegments == 0)
		return;
	last = far->height + far->rows + BEYOND;
#pragma omp for schedule(static)
	for (int y = -far->top; y < last; y++)
		make_blocks(hz, y);
	for (int i = 0; i < far->top_level; i++)
#pragma omp for schedule(static)
		for (int y = -far->top; y < last; y++)
			make_level_row(hz, i, y);
}

/* Where a tile finds a segment for texel o of its blocks. */
static const float *
find_origin(const struct bake_horizon *hz, const struct bake_horizon_segment *s,
    int o, int x0, int y0)
{
	const struct bake_horizon_far *far = &hz->far;
	const int x = bake_horizon_wrap(x0 / far->block_width + s->x[o],
	    far->width, hz->wrap.clamp_u, far->left);
	const int y = bake_horizon_wrap(y0 / far->block_height + s->y[o],
	    far->height, hz->wrap.clamp_v, far->top);

	return bake_horizon_far_row(far, s->level, y) + x;
}

/* Fetch into the cache what a tile reads from an origin on. */
static void
fetch(const struct bake_horizon_far *far, const float *origin)
{
	for (int y = 0; y < far->rows; y++)
		for (int x = 0; x < far->columns + 15; x += 16)
			__builtin_prefetch(
			    origin + (size_t)y * far->stride + x);
}

long
bake_horizon_far_span(const struct bake_horizon *hz, int x0, int y0, long first,
    struct bake_horizon_span *span)
{
	const struct bake_horizon_far *far = &hz->far;
	const long left = far->nsegments - first;

	span->first = first;
	span->n = left < BAKE_FAR_SPAN ? (int)left : BAKE_FAR_SPAN;
	span->nseparate = 0;
	for (int s = 0; s < span->n; s++) {
		const struct bake_horizon_segment *seg =
		    &far->segments[first + s];
		const bool separate = seg->level < BAKE_FAR_SHARED;

		for (int o = 0; o < (separate ? BAKE_FAR_BLOCK : 1); o++)
			span->origin[s][o] = find_origin(hz, seg, o, x0, y0);
		span->nseparate += separate;
		fetch(far, span->origin[s][0]);
	}
	return first + span->n;
}

/* A level has room for either layout. */
static bool
set_level_size(struct bake_horizon *hz)
{
	struct bake_horizon_far *far = &hz->far;

	for (int x_major = 0; x_major < 2; x_major++) {
		size_t size;

		set_layout(hz, x_major);
		if (!bake_mul_size(far->stride, layout_nrows(far), &size))
			return false;
		if (size > far->level_size)
			far->level_size = size;
	}
	return true;
}

enum bake_status
bake_horizon_far_init(struct bake_horizon *hz, struct bake_err *err)
{
	struct bake_horizon_far *far = &hz->far;
	const int width = hz->heights.width, height = hz->heights.height;
	const long longest =
	    hz->radius > 0
		? (long)(hz->radius * width)
		: (long)hz->periods * (width > height ? width : height);
	size_t nfloats;
	long nsegments = 0, length;

	for (long start = far->near; start < longest; start += length) {
		while (
		    far->nlevels < BAKE_FAR_LEVELS &&
		    far->per_octave * ((long)BAKE_FAR_BLOCK << far->nlevels) <=
			start)
			far->nlevels++;
		length = (long)BAKE_FAR_BLOCK << (far->nlevels - 1);
		nsegments++;
	}
	if (nsegments == 0)
		return BAKE_OK;
	if (!set_level_size(hz) ||
	    !bake_mul_size(far->level_size, (size_t)far->nlevels, &nfloats))
		return bake_fail(err, BAKE_ENOMEM,
		    "%dx%d texels do not fit in memory", width, height);
	far->levels = bake_alloc(nfloats, sizeof *far->levels, err);
	far->segments =
	    bake_alloc((size_t)nsegments, sizeof *far->segments, err);
	return far->levels != NULL && far->segments != NULL ? BAKE_OK
							    : BAKE_ENOMEM;
}

void
bake_horizon_far_free(struct bake_horizon_far *far)
{
	free(far->levels);
	free(far->segments);
	*far = (struct bake_horizon_far){ .levels = NULL };
}
