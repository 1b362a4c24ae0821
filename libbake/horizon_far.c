/* The far field of fast horizons: maxima over runs of doubling length. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "horizon_priv.h"
#include "mem.h"

/* A segment's origin is on the map or, on a clamped axis, as much as a tile
 * before it or one block beyond it. */
enum { BEYOND = 1 };

static struct bake_horizon_grid
make_grid(const struct bake_horizon *hz, bool x_major, int block)
{
	const int block_width = x_major ? block : 1;
	const int block_height = x_major ? 1 : block;
	struct bake_horizon_grid grid = {
		.block_width = block_width,
		.block_height = block_height,
		.width = (hz->heights.width - 1) / block_width + 1,
		.height = (hz->heights.height - 1) / block_height + 1,
		.columns = BAKE_TILE_WIDTH / block_width,
		.rows = BAKE_TILE_HEIGHT / block_height,
	};

	grid.left = hz->wrap.clamp_u ? grid.columns : 0;
	grid.top = hz->wrap.clamp_v ? grid.rows : 0;
	grid.stride = (size_t)grid.left + (size_t)grid.width +
		      (size_t)grid.columns + BEYOND;
	return grid;
}

static void
set_grids(struct bake_horizon *hz, bool x_major)
{
	hz->far.grid[0] = make_grid(hz, x_major, BAKE_FAR_BLOCK);
	hz->far.grid[1] =
	    make_grid(hz, x_major, BAKE_FAR_BLOCK * BAKE_FAR_MERGE);
}

static const struct bake_horizon_grid *
grid_of(const struct bake_horizon_far *far, int level)
{
	return &far->grid[level >= BAKE_FAR_COARSE];
}

/* One below its last row. */
static int
grid_end(const struct bake_horizon_grid *grid)
{
	return grid->height + grid->rows + BEYOND;
}

/* Complete a row whose values 0 .. width - 1 are there. */
static void
pad_row(const struct bake_horizon_grid *grid, float *row, bool clamp)
{
	const int n = grid->columns + BEYOND;

	for (int x = 1; x <= grid->left; x++)
		row[-x] = row[0];
	for (int x = 0; x < n; x++) /* ever further, from what is there */
		row[grid->width + x] = clamp ? row[grid->width - 1] : row[x];
}

/* Floats before level i. */
static size_t
level_offset(const struct bake_horizon_far *far, int i)
{
	const int fine = i < BAKE_FAR_COARSE ? i : BAKE_FAR_COARSE;

	return (size_t)fine * far->size[0] + (size_t)(i - fine) * far->size[1];
}

/* Value (0, y) of a level; -top <= y. */
static float *
level_row(const struct bake_horizon_far *far, int level, int y)
{
	const struct bake_horizon_grid *grid = grid_of(far, level);

	return far->levels + level_offset(far, level) +
	       (size_t)(y + grid->top) * grid->stride + (size_t)grid->left;
}

/* What row y of level 0 is made of. */
static struct bake_horizon_blocks
find_texels(const struct bake_horizon *hz, int y)
{
	const struct bake_horizon_far *far = &hz->far;
	const struct bake_horizon_grid *grid = &far->grid[0];
	const bool x_major = hz->ray[0].dir.x_major, clamp = hz->wrap.clamp_v;
	const int height = hz->heights.height;
	const int first =
	    grid->block_height * bake_wrap_index(y, grid->height, clamp);
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
	const struct bake_horizon_grid *grid = &hz->far.grid[0];
	struct bake_horizon_blocks blocks = find_texels(hz, y);
	float *out = level_row(&hz->far, 0, y);
	const int most = BAKE_FAR_BLOCK - 1; /* columns to the left */
	int n = 0;

	if (!hz->ray[0].dir.x_major && !hz->wrap.clamp_u) {
		struct bake_horizon_blocks lifted = blocks;

		n = grid->width < most ? grid->width : most;
		for (int lift = 0; lift < most; lift += grid->width)
			move_right(&lifted, grid->width);
		make[hz->isa](out, &lifted, (size_t)n);
		move_right(&blocks, n);
	}
	make[hz->isa](out + n, &blocks, (size_t)(grid->width - n));
	pad_row(grid, out, hz->wrap.clamp_u);
}

/* out = the values of row y of P_(i+1), y on the map, by those of P_i. */
static void
raise_row(const struct bake_horizon *hz, int i, int y, float *out)
{
	static void (*const higher[])(float *, const float *, const float *,
	    size_t) = BAKE_KERNEL_TABLE(bake_horizon_higher);
	const struct bake_horizon_far *far = &hz->far;
	const struct bake_horizon_grid *grid = grid_of(far, i);
	const int width = grid->width, dx = far->step[i].x;
	const int y1 = bake_wrap_index(
	    (long)y + far->step[i].y, grid->height, hz->wrap.clamp_v);
	const float *a = level_row(far, i, y);
	const float *b = level_row(far, i, y1);

	if (!hz->wrap.clamp_u) {
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
	pad_row(grid, out, hz->wrap.clamp_u);
}

/* Row y of the first coarse level; first: of BAKE_FAR_MERGE blocks the one
 * that the ray meets first. */
static void
make_coarse_row(const struct bake_horizon *hz, int y, int first)
{
	const struct bake_horizon_far *far = &hz->far;
	const struct bake_horizon_grid *grid = &far->grid[1];
	const int i = BAKE_FAR_COARSE - 1;
	float *out = level_row(far, BAKE_FAR_COARSE, y);
	float *fine = hz->scratch +
		      (size_t)omp_get_thread_num() * hz->scratch_row +
		      far->grid[0].left;

	y = bake_wrap_index(y, grid->height, hz->wrap.clamp_v);
	if (!hz->ray[0].dir.x_major) {
		raise_row(hz, i,
		    bake_wrap_index((long)y * BAKE_FAR_MERGE + first,
			far->grid[0].height, hz->wrap.clamp_v),
		    out);
		return;
	}
	raise_row(hz, i, y, fine);
	for (int x = 0; x < grid->width; x++)
		out[x] = fine[x * BAKE_FAR_MERGE + first];
	pad_row(grid, out, hz->wrap.clamp_u);
}

/* Row y of level i + 1. */
static void
make_level_row(const struct bake_horizon *hz, int i, int y)
{
	const struct bake_horizon_far *far = &hz->far;
	const int first = hz->ray[0].dir.major > 0 ? 0 : BAKE_FAR_MERGE - 1;

	if (i + 1 == BAKE_FAR_COARSE)
		make_coarse_row(hz, y, first);
	else
		raise_row(hz, i,
		    bake_wrap_index(
			y, grid_of(far, i)->height, hz->wrap.clamp_v),
		    level_row(far, i + 1, y));
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

/* The steps from a ray's first texel in the block of its start, or in as many
 * as a coarse level merges, to texel o of a block. */
static double
steps_into(const struct bake_horizon_dir *dir, int level, int o)
{
	if (level < BAKE_FAR_SHARED)
		return steps_into_block(dir, o);
	if (level < BAKE_FAR_COARSE)
		return 0.5 * (BAKE_FAR_BLOCK - 1);
	return 0.5 * (BAKE_FAR_BLOCK * BAKE_FAR_MERGE - 1);
}

static struct bake_horizon_segment
make_segment(const struct bake_horizon *hz, const struct bake_horizon_ray *ray,
    int level, long start)
{
	const struct bake_horizon_far *far = &hz->far;
	const struct bake_horizon_grid *grid = grid_of(far, level);
	const struct bake_horizon_dir *dir = &ray->dir;
	const int block = dir->x_major ? grid->block_width : grid->block_height;
	struct bake_horizon_segment seg = { .level = level };
	const int last = (BAKE_FAR_BLOCK << level) - 1;
	/* steps to where the levels' ray enters the run */
	const int enter = ray->opposite ? last : 0;
	const double major =
	    (double)((start + enter) / block) * (double)dir->major;
	const double place = far->place * (double)last;

	for (int o = 0; o < BAKE_FAR_BLOCK; o++) {
		const double k = (double)start - steps_into(dir, level, o);
		const double minor = minor_offset(dir, k + enter);

		seg.x[o] = reduce(dir->x_major ? major : minor, grid->width,
		    hz->wrap.clamp_u);
		seg.y[o] = reduce(dir->x_major ? minor : major, grid->height,
		    hz->wrap.clamp_v);
		seg.weight[o] = (float)(1 / ((k + place) * dir->pitch));
	}
	/* less than k + place is for the last of a block's texels */
	seg.reach = (float)(((double)start - 1) * dir->pitch * (1 - 0x1p-19));
	return seg;
}

static void
make_segments(struct bake_horizon *hz, struct bake_horizon_ray *ray)
{
	struct bake_horizon_far *far = &hz->far;
	long start = far->near;
	int level = 0;

	ray->nsegments = 0;
	while (start < ray->dir.nsteps) {
		while (
		    level + 1 < far->nlevels &&
		    far->per_octave * (2L * BAKE_FAR_BLOCK << level) <= start)
			level++;
		ray->segments[ray->nsegments++] =
		    make_segment(hz, ray, level, start);
		start += (long)BAKE_FAR_BLOCK << level;
	}
	far->top_level = level;
}

static void
set_direction(struct bake_horizon *hz)
{
	struct bake_horizon_far *far = &hz->far;
	const struct bake_horizon_dir *dir = &hz->ray[0].dir;

	set_grids(hz, dir->x_major);
	for (int o = 0; o < BAKE_FAR_BLOCK; o++) {
		const double at = steps_into_block(dir, o) * dir->minor;
		const double whole = floor(at + BAKE_HORIZON_SNAP);
		const double frac = at - whole;

		far->sample[o].offset = (int)whole;
		far->sample[o].frac =
		    frac < BAKE_HORIZON_SNAP ? 0 : (float)frac;
	}
	for (int side = 0; side < hz->nrays; side++)
		make_segments(hz, &hz->ray[side]);
	for (int i = 0; i < far->top_level; i++) {
		const int blocks =
		    i < BAKE_FAR_COARSE ? 1 << i : (1 << i) / BAKE_FAR_MERGE;
		const int major = dir->major * blocks;
		const int minor = (int)minor_offset(dir, BAKE_FAR_BLOCK << i);

		far->step[i].x = dir->x_major ? major : minor;
		far->step[i].y = dir->x_major ? minor : major;
	}
}

void
bake_horizon_far_aim(struct bake_horizon *hz)
{
	const struct bake_horizon_far *far = &hz->far;

#pragma omp single
	set_direction(hz);
	if (hz->ray[0].nsegments == 0)
		return;
#pragma omp for schedule(static)
	for (int y = -far->grid[0].top; y < grid_end(&far->grid[0]); y++)
		make_blocks(hz, y);
	for (int i = 0; i < far->top_level; i++) {
		const struct bake_horizon_grid *grid = grid_of(far, i + 1);

#pragma omp for schedule(static)
		for (int y = -grid->top; y < grid_end(grid); y++)
			make_level_row(hz, i, y);
	}
}

/* Where a tile finds a segment for texel o of its blocks. */
static const float *
find_origin(const struct bake_horizon *hz, const struct bake_horizon_segment *s,
    int o, int x0, int y0)
{
	const struct bake_horizon_grid *grid = grid_of(&hz->far, s->level);
	const int x = bake_horizon_wrap(x0 / grid->block_width + s->x[o],
	    grid->width, hz->wrap.clamp_u, grid->left);
	const int y = bake_horizon_wrap(y0 / grid->block_height + s->y[o],
	    grid->height, hz->wrap.clamp_v, grid->top);

	return level_row(&hz->far, s->level, y) + x;
}

long
bake_horizon_far_span(const struct bake_horizon *hz, int side, int x0, int y0,
    long first, struct bake_horizon_span *span)
{
	const struct bake_horizon_ray *ray = &hz->ray[side];
	const long left = ray->nsegments - first;

	*span = (struct bake_horizon_span){ .n = 0 };
	if (left == 0)
		return first;
	span->segments = ray->segments + first;
	span->n = left < BAKE_FAR_SPAN ? (int)left : BAKE_FAR_SPAN;
	for (int s = 0; s < span->n; s++) {
		const struct bake_horizon_segment *seg = &span->segments[s];
		const bool separate = seg->level < BAKE_FAR_SHARED;

		for (int o = 0; o < (separate ? BAKE_FAR_BLOCK : 1); o++)
			span->origin[s][o] = find_origin(hz, seg, o, x0, y0);
		span->nseparate += separate;
		span->nfine += seg->level < BAKE_FAR_COARSE;
	}
	return first + span->n;
}

/* A level has room for either kind of direction. */
static bool
set_sizes(struct bake_horizon *hz)
{
	struct bake_horizon_far *far = &hz->far;

	for (int i = 0; i < 4; i++) {
		const int coarse = i % 2;
		const struct bake_horizon_grid *grid = &far->grid[coarse];
		size_t size;

		set_grids(hz, i / 2);
		if (!bake_mul_size(grid->stride,
			(size_t)(grid->top + grid_end(grid)), &size))
			return false;
		if (size > far->size[coarse])
			far->size[coarse] = size;
		if (grid->stride > hz->scratch_row)
			hz->scratch_row = grid->stride;
	}
	return true;
}

/* The levels that a march as long as the longest needs, and its segments. */
static long
count_segments(struct bake_horizon *hz)
{
	struct bake_horizon_far *far = &hz->far;
	const int width = hz->heights.width, height = hz->heights.height;
	const long longest =
	    hz->radius > 0
		? (long)(hz->radius * width)
		: (long)hz->periods * (width > height ? width : height);
	long n = 0, length;

	for (long start = far->near; start < longest; start += length) {
		while (
		    far->nlevels < BAKE_FAR_LEVELS &&
		    far->per_octave * ((long)BAKE_FAR_BLOCK << far->nlevels) <=
			start)
			far->nlevels++;
		length = (long)BAKE_FAR_BLOCK << (far->nlevels - 1);
		n++;
	}
	return n;
}

enum bake_status
bake_horizon_far_init(
    struct bake_horizon *hz, int nthreads, struct bake_err *err)
{
	struct bake_horizon_far *far = &hz->far;
	const size_t nsegments = (size_t)count_segments(hz);
	size_t nscratch;

	if (nsegments == 0)
		return BAKE_OK;
	/* a coarse level is no larger than a fine one */
	if (!set_sizes(hz) ||
	    !bake_mul_size(far->size[0], BAKE_FAR_LEVELS, &nscratch) ||
	    !bake_mul_size(hz->scratch_row, (size_t)nthreads, &nscratch))
		return bake_fail(err, BAKE_ENOMEM,
		    "%dx%d texels do not fit in memory", hz->heights.width,
		    hz->heights.height);
	far->levels = bake_alloc(
	    level_offset(far, far->nlevels), sizeof *far->levels, err);
	hz->scratch = bake_alloc(nscratch, sizeof *hz->scratch, err);
	for (int side = 0; side < 2; side++)
		hz->ray[side].segments =
		    bake_alloc(nsegments, sizeof *hz->ray[side].segments, err);
	return far->levels != NULL && hz->scratch != NULL &&
		       hz->ray[0].segments != NULL &&
		       hz->ray[1].segments != NULL
		   ? BAKE_OK
		   : BAKE_ENOMEM;
}

void
bake_horizon_far_free(struct bake_horizon_far *far)
{
	free(far->levels);
	*far = (struct bake_horizon_far){ .levels = NULL };
}
