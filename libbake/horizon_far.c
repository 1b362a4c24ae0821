/* The far field of fast horizons: maxima over runs of doubling length. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "horizon_priv.h"
#include "mem.h"

/* A tile reads 32 x 8 blocks from a segment's origin, which is on the map or,
 * on a clamped axis, as much as a tile before it or one block beyond it. */
enum {
	TILE_COLUMNS = BAKE_TILE_WIDTH / 2,
	TILE_ROWS = BAKE_TILE_HEIGHT / 2,
	BEYOND = 1
};

/* Complete a row whose blocks 0 .. width - 1 are there. */
static void
pad_row(const struct bake_horizon_far *far, float *row, bool clamp)
{
	const int n = TILE_COLUMNS + BEYOND;

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

/* Row y of level 0, the highest of each 2 x 2 texels. At an odd end of the
 * map a block is half beyond it, which adds nothing. */
static void
make_blocks(const struct bake_horizon *hz, int y)
{
	const struct bake_horizon_far *far = &hz->far;
	const int width = hz->heights.width, height = hz->heights.height;
	const int y0 = 2 * bake_wrap_index(y, far->height, hz->wrap.clamp_v);
	const int y1 = y0 + 1 < height ? y0 + 1 : y0;
	const float *a = bake_image_row(&hz->heights, y0);
	const float *b = bake_image_row(&hz->heights, y1);
	float *out = bake_horizon_far_row(far, 0, y);

	for (int x = 0; x < far->width; x++) {
		const int x0 = 2 * x, x1 = x0 + 1 < width ? x0 + 1 : x0;
		const float u = a[x0] > a[x1] ? a[x0] : a[x1];
		const float v = b[x0] > b[x1] ? b[x0] : b[x1];

		out[x] = u > v ? u : v;
	}
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

/* blocks per block of the major axis, that far along the ray */
static double
minor_offset(const struct bake_horizon_dir *dir, long major)
{
	return floor((double)major * dir->minor + 0.5);
}

static void
make_segments(struct bake_horizon *hz)
{
	struct bake_horizon_far *far = &hz->far;
	const struct bake_horizon_dir *dir = &hz->dir;
	long start = far->near;
	int level = 0;

	far->nsegments = 0;
	far->top_level = 0;
	while (start < dir->nsteps) {
		struct bake_horizon_segment *seg =
		    &far->segments[far->nsegments++];
		const long major = start / 2 * dir->major;
		const double minor = minor_offset(dir, start / 2);
		long length;

		while (level + 1 < far->nlevels &&
		       far->per_octave * (4L << level) <= start)
			level++;
		length = 2L << level;
		seg->level = level;
		seg->x = reduce(dir->x_major ? (double)major : minor,
		    far->width, hz->wrap.clamp_u);
		seg->y = reduce(dir->x_major ? minor : (double)major,
		    far->height, hz->wrap.clamp_v);
		seg->reach =
		    (float)(((double)start - 1) * dir->pitch * (1 - 0x1p-19));
		seg->weight =
		    (float)(1 / (((double)start - 0.5 +
				     far->place * (double)(length - 1)) *
				    dir->pitch));
		start += length;
	}
	far->top_level = level;
	for (int m = 0; m < level; m++) {
		const long major = 1L << m;
		const int minor = (int)minor_offset(dir, major);

		far->step[m].x = dir->x_major ? (int)major * dir->major : minor;
		far->step[m].y = dir->x_major ? minor : (int)major * dir->major;
	}
}

void
bake_horizon_far_aim(struct bake_horizon *hz)
{
	struct bake_horizon_far *far = &hz->far;
	const int last = far->height + TILE_ROWS + BEYOND;

#pragma omp single
	make_segments(hz);
	for (int m = 0; m < far->top_level; m++)
#pragma omp for schedule(static)
		for (int y = -far->top; y < last; y++)
			make_level_row(hz, m, y);
}

static const float *
find_origin(const struct bake_horizon *hz, const struct bake_horizon_segment *s,
    int x0, int y0)
{
	const struct bake_horizon_far *far = &hz->far;
	const int x = bake_horizon_wrap(
	    x0 / 2 + s->x, far->width, hz->wrap.clamp_u, far->left);
	const int y = bake_horizon_wrap(
	    y0 / 2 + s->y, far->height, hz->wrap.clamp_v, far->top);

	return far->levels + (size_t)s->level * far->level_size +
	       (size_t)(y + far->top) * far->stride + (size_t)(x + far->left);
}

/* Fetch into the cache what a tile reads from an origin on. */
static void
fetch(const struct bake_horizon_far *far, const float *origin)
{
	for (size_t y = 0; y < TILE_ROWS; y++)
		for (size_t x = 0; x < TILE_COLUMNS + 15; x += 16)
			__builtin_prefetch(origin + y * far->stride + x);
}

long
bake_horizon_far_span(const struct bake_horizon *hz, int x0, int y0, long first,
    struct bake_horizon_span *span)
{
	const struct bake_horizon_far *far = &hz->far;
	const long left = far->nsegments - first;

	span->first = first;
	span->n = left < BAKE_FAR_SPAN ? (int)left : BAKE_FAR_SPAN;
	for (int s = 0; s < span->n; s++) {
		span->origin[s] =
		    find_origin(hz, &far->segments[first + s], x0, y0);
		fetch(far, span->origin[s]);
	}
	return first + span->n;
}

enum bake_status
bake_horizon_far_init(
    struct bake_horizon *hz, int nthreads, struct bake_err *err)
{
	struct bake_horizon_far *far = &hz->far;
	const int width = hz->heights.width, height = hz->heights.height;
	const long longest =
	    hz->radius > 0
		? (long)(hz->radius * width)
		: (long)hz->periods * (width > height ? width : height);
	size_t nrows, nfloats;
	long nsegments = 0, length = 2;

	far->width = width / 2 + width % 2;
	far->height = height / 2 + height % 2;
	far->left = hz->wrap.clamp_u ? TILE_COLUMNS : 0;
	far->top = hz->wrap.clamp_v ? TILE_ROWS : 0;
	far->stride =
	    (size_t)far->left + (size_t)far->width + TILE_COLUMNS + BEYOND;
	nrows = (size_t)far->top + (size_t)far->height + TILE_ROWS + BEYOND;
	for (long start = far->near; start < longest; start += length) {
		while (far->nlevels < BAKE_FAR_LEVELS &&
		       far->per_octave * (2L << far->nlevels) <= start)
			far->nlevels++;
		if (far->nlevels == 0)
			far->nlevels = 1;
		length = 2L << (far->nlevels - 1);
		nsegments++;
	}
	if (nsegments == 0)
		return BAKE_OK;
	if (!bake_mul_size(far->stride, nrows, &far->level_size) ||
	    !bake_mul_size(far->level_size, (size_t)far->nlevels, &nfloats))
		return bake_fail(err, BAKE_ENOMEM,
		    "%dx%d texels do not fit in memory", width, height);
	far->levels = bake_alloc(nfloats, sizeof *far->levels, err);
	far->segments =
	    bake_alloc((size_t)nsegments, sizeof *far->segments, err);
	if (far->levels == NULL || far->segments == NULL)
		return BAKE_ENOMEM;
#pragma omp parallel for num_threads(nthreads) schedule(static)
	for (int y = -far->top; y < far->height + TILE_ROWS + BEYOND; y++)
		make_blocks(hz, y);
	return BAKE_OK;
}

void
bake_horizon_far_free(struct bake_horizon_far *far)
{
	free(far->levels);
	free(far->segments);
	*far = (struct bake_horizon_far){ .levels = NULL };
}
