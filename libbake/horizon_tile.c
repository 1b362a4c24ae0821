/* Horizons of a height field, tile by tile: the tables of the fast march. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "horizon_priv.h"
#include "mem.h"

/* so that a chunk's offsets, 10 rows at most, fit an int */
enum { SIDE_MAX = 1 << 27 };

/*
 * Border widths. A strip reads at most 64 + 9 columns and 4 + 9 rows from a
 * chunk's origin, which is in 0 .. W - 1 on a torus and, on a clamped axis,
 * moved to -BORDER or W where nothing but the border texels would be read.
 * Windows reach a few texels further. All are even, for the 2 x 2 blocks.
 */
enum { BORDER_X = 80, BORDER_Y = 16, BEYOND_X = 80, BEYOND_Y = 18 };

static float
absolute(float v)
{
	return v < 0 ? -v : v;
}

static enum bake_status
make_heights(struct bake_horizon *hz, const struct bake_image *depth,
    int nthreads, struct bake_err *err)
{
	const int width = depth->width, height = depth->height;
	struct bake_image padded;
	enum bake_status rc;
	float highest = -1e28f, largest = 0;

	hz->left = hz->wrap.clamp_u ? BORDER_X : 0;
	hz->top = hz->wrap.clamp_v ? BORDER_Y : 0;
	if (width > SIDE_MAX || height > SIDE_MAX)
		return bake_fail(err, BAKE_EINVAL,
		    "%dx%d texels, expected at most %d a side", width, height,
		    SIDE_MAX);
	hz->padded_width = hz->left + width + BEYOND_X + width % 2;
	hz->padded_height = hz->top + height + BEYOND_Y + height % 2;
	if ((rc = bake_image_alloc(&padded, hz->padded_width, hz->padded_height,
		 1, err)) != BAKE_OK)
		return rc;
	hz->padded = padded.data;
	hz->heights = padded;
	hz->heights.width = width;
	hz->heights.height = height;
	hz->heights.data += (size_t)hz->top * padded.row_stride + hz->left;
#pragma omp parallel for num_threads(nthreads) schedule(static)                \
    reduction(max                                                              \
	      : highest, largest)
	for (int y = 0; y < hz->padded_height; y++) {
		const float *src =
		    bake_image_row(depth, bake_wrap_index((long)y - hz->top,
					      height, hz->wrap.clamp_v));
		float *dst = bake_image_row(&padded, y);

		for (int x = 0; x < hz->left; x++)
			dst[x] = bake_horizon_height(src[0]);
		for (int x = 0; x < width; x++) {
			float h = bake_horizon_height(src[x]);

			dst[hz->left + x] = h;
			highest = h > highest ? h : highest;
			largest = absolute(h) > largest ? absolute(h) : largest;
		}
		for (int x = width; x < hz->padded_width - hz->left; x++)
			dst[hz->left + x] = bake_horizon_height(
			    src[bake_wrap_index(x, width, hz->wrap.clamp_u)]);
	}
	hz->highest = highest;
	hz->slack = largest * 0x1p-21f;
	return BAKE_OK;
}

/* Row y2 of the blocks; the unused end of a phase repeats its last block. */
static void
make_block_row(const struct bake_horizon *hz, int y2)
{
	const size_t stride = hz->blocks.stride;
	const int n = hz->padded_width / 2;
	const float *a =
	    hz->padded + (size_t)(2 * y2) * (size_t)hz->padded_width;
	const float *b = a + hz->padded_width;
	float *out = bake_horizon_window_row(&hz->blocks, y2);

	for (size_t i = 0; i < stride; i++)
		for (int p = 0; p < BAKE_WINDOW_PHASES; p++) {
			int x = (int)i * BAKE_WINDOW_PHASES + p;
			float u, v;

			x = 2 * (x < n ? x : n - 1);
			u = a[x] > a[x + 1] ? a[x] : a[x + 1];
			v = b[x] > b[x + 1] ? b[x] : b[x + 1];
			out[(size_t)p * stride + i] = u > v ? u : v;
		}
}

/* the lowest row that a strip's chunk starts in is H */
static int
window_nrows(const struct bake_horizon *hz)
{
	return (hz->top + hz->heights.height) / 2 + 1;
}

/* The offset of a chunk, reduced so that x0 + offset needs one wrap at most. */
static int
reduce_offset(long offset, int size, bool clamp)
{
	const long limit = 1L << 29;

	if (!clamp)
		return bake_wrap_index(offset, size, false);
	return (int)(offset < -limit  ? -limit
		     : offset > limit ? limit
				      : offset);
}

static void
make_chunk(
    const struct bake_horizon *hz, const struct bake_horizon_ray *ray, long c)
{
	const struct bake_horizon_dir *dir = &ray->dir;
	struct bake_horizon_chunk *chunk = &ray->chunks[c];
	struct bake_horizon_step steps[BAKE_CHUNK];
	const long stride = (long)hz->heights.row_stride;
	const long first = c * BAKE_CHUNK + 1;
	/* the sample that is the first one for the crests */
	const long end = ray->opposite ? first + BAKE_CHUNK - 1 : first;
	const long minor =
	    (long)floor((double)end * dir->minor + BAKE_HORIZON_SNAP);
	long x = LONG_MAX, y = LONG_MAX;

	for (int i = 0; i < BAKE_CHUNK; i++) {
		steps[i] = bake_horizon_step(dir, first + i);
		if (first + i > dir->nsteps)
			steps[i].w0 = steps[i].w1 = 0;
		x = steps[i].dx < x ? steps[i].dx : x;
		y = steps[i].dy < y ? steps[i].dy : y;
	}
	for (int i = 0; i < BAKE_CHUNK; i++) {
		chunk->rel[i] =
		    (int)((steps[i].dy - y) * stride + steps[i].dx - x);
		chunk->w0[i] = -steps[i].w0;
		chunk->w1[i] = -steps[i].w1;
	}
	chunk->crest_rel =
	    dir->x_major ? (int)((minor - y) * stride + end * dir->major - x)
			 : (int)((end * dir->major - y) * stride + minor - x);
	ray->places[c] = (struct bake_horizon_place){
		reduce_offset(x, hz->heights.width, hz->wrap.clamp_u),
		reduce_offset(y, hz->heights.height, hz->wrap.clamp_v),
		(float)((double)first * dir->pitch * (1 - 0x1p-19)),
	};
}

static long
count_chunks(const struct bake_horizon *hz, long nsteps)
{
	const long n = (nsteps + BAKE_CHUNK - 1) / BAKE_CHUNK;
	const long near = hz->far.near / BAKE_CHUNK;

	return hz->exact || n < near ? n : near;
}

/*
 * Set up the rays, without the tables. 8 steps run over ceil(7 |m|)
 * texels of the minor axis at most; interpolation reads one more, and so does
 * a window that serves the odd texels as well.
 */
static void
set_direction(struct bake_horizon *hz, int j, int n)
{
	const struct bake_horizon_dir *dir = &hz->ray[0].dir;
	int major = BAKE_CHUNK - 1, minor;

	hz->nrays = n % 2 == 0 ? 2 : 1;
	for (int side = 0; side < hz->nrays; side++) {
		struct bake_horizon_ray *ray = &hz->ray[side];

		bake_horizon_dir_init(&ray->dir, (j + side * (n / 2)) % n, n,
		    hz->heights.width, hz->heights.height, hz->radius,
		    hz->periods);
		ray->nchunks = count_chunks(hz, ray->dir.nsteps);
	}
	minor = (int)ceil(fabs(dir->minor) * (BAKE_CHUNK - 1)) + 1;
	hz->columns =
	    (BAKE_PACKET_WIDTH + 1 + (dir->x_major ? major : minor) + 1) / 2;
	hz->rows =
	    (BAKE_PACKET_HEIGHT + 1 + (dir->x_major ? minor : major) + 1) / 2;
}

void
bake_horizon_aim(struct bake_horizon *hz, int j, int n)
{
	static void (*const crest_row[])(const struct bake_horizon *, int) =
	    BAKE_KERNEL_TABLE(bake_horizon_crest_row);
	static void (*const windows_row[])(const struct bake_horizon *, int,
	    float *) = BAKE_KERNEL_TABLE(bake_horizon_windows_row);

#pragma omp single
	set_direction(hz, j, n);
	for (int side = 0; side < hz->nrays; side++)
#pragma omp for schedule(static) nowait
		for (long c = 0; c < hz->ray[side].nchunks; c++)
			make_chunk(hz, &hz->ray[side], c);
	if (!hz->exact) {
		bake_horizon_far_aim(hz);
		return;
	}
#pragma omp for schedule(static) nowait
	for (int y2 = 0; y2 < window_nrows(hz); y2++)
		windows_row[hz->isa](hz, y2,
		    hz->scratch +
			hz->scratch_row * (size_t)omp_get_thread_num());
#pragma omp for schedule(static)
	for (int y = 0; y < hz->padded_height; y++)
		crest_row[hz->isa](hz, y - hz->top);
}

/* What tells the exact march which chunks to skip. */
static enum bake_status
alloc_tables(struct bake_horizon *hz, int nthreads, struct bake_err *err)
{
	const size_t nblock_rows = (size_t)hz->padded_height / 2;
	size_t nwindows, nscratch;

	hz->windows.stride = hz->blocks.stride =
	    (size_t)hz->padded_width / 8 + 1;
	hz->scratch_row = 2 * hz->windows.stride * BAKE_WINDOW_PHASES;
	if (!bake_mul_size(hz->windows.stride * BAKE_WINDOW_PHASES, nblock_rows,
		&nwindows) ||
	    !bake_mul_size(hz->scratch_row, (size_t)nthreads, &nscratch))
		return bake_fail(err, BAKE_ENOMEM,
		    "%dx%d texels do not fit in memory", hz->heights.width,
		    hz->heights.height);
	hz->windows.data = bake_alloc(nwindows, sizeof(float), err);
	hz->blocks.data = bake_alloc(nwindows, sizeof(float), err);
	hz->scratch = bake_alloc(nscratch, sizeof *hz->scratch, err);
	hz->crests =
	    bake_alloc((size_t)hz->padded_width * (size_t)hz->padded_height,
		sizeof *hz->crests, err);
	if (hz->windows.data == NULL || hz->blocks.data == NULL ||
	    hz->scratch == NULL || hz->crests == NULL)
		return BAKE_ENOMEM;
#pragma omp parallel for num_threads(nthreads) schedule(static)
	for (int y2 = 0; y2 < hz->padded_height / 2; y2++)
		make_block_row(hz, y2);
	return BAKE_OK;
}

static enum bake_status
alloc_chunks(struct bake_horizon *hz, struct bake_err *err)
{
	const long longer = hz->heights.width > hz->heights.height
				? hz->heights.width
				: hz->heights.height;
	size_t n =
	    (size_t)(hz->radius > 0 ? hz->radius * hz->heights.width
				    : (double)hz->periods * (double)longer) /
		BAKE_CHUNK +
	    1;

	for (int side = 0; side < 2; side++) {
		struct bake_horizon_ray *ray = &hz->ray[side];

		ray->opposite = side == 1;
		ray->places = bake_alloc(n, sizeof *ray->places, err);
		ray->chunks = bake_alloc(n, sizeof *ray->chunks, err);
		if (ray->places == NULL || ray->chunks == NULL)
			return BAKE_ENOMEM;
	}
	return BAKE_OK;
}

enum bake_status
bake_horizon_init(struct bake_horizon *hz, const struct bake_image *depth,
    struct bake_wrap wrap, double radius, int periods,
    enum bake_horizon_quality quality, int nthreads, struct bake_err *err)
{
	static const struct bake_horizon_far far[] = {
		[BAKE_HORIZON_FAST] = { .near = 16,
		    .per_octave = 4,
		    .place = 0.85 },
		[BAKE_HORIZON_PREVIEW] = { .near = 8,
		    .per_octave = 2,
		    .place = 0.85 },
	};
	enum bake_status rc;

	*hz = (struct bake_horizon){ .wrap = wrap,
		.isa = bake_isa_pick(),
		.radius = radius,
		.periods = periods,
		.exact = quality == BAKE_HORIZON_EXACT };
	if (!hz->exact)
		hz->far = far[quality];
	if ((rc = make_heights(hz, depth, nthreads, err)) != BAKE_OK ||
	    (rc = alloc_chunks(hz, err)) != BAKE_OK)
		return rc;
	return hz->exact ? alloc_tables(hz, nthreads, err)
			 : bake_horizon_far_init(hz, nthreads, err);
}

void
bake_horizon_free(struct bake_horizon *hz)
{
	free(hz->padded);
	for (int side = 0; side < 2; side++) {
		free(hz->ray[side].places);
		free(hz->ray[side].chunks);
		free(hz->ray[side].segments);
	}
	free(hz->windows.data);
	free(hz->blocks.data);
	free(hz->scratch);
	free(hz->crests);
	bake_horizon_far_free(&hz->far);
	*hz = (struct bake_horizon){ .padded = NULL };
}

static void
march_fast(const struct bake_horizon *hz, int side, int x0, int y0, int nrows,
    float *slopes)
{
	static void (*const near[])(const struct bake_horizon *, int, int, int,
	    float *) = BAKE_KERNEL_TABLE(bake_horizon_near);
	static void (*const far[])(const struct bake_horizon *,
	    const struct bake_horizon_span *, const float *, float *) =
	    BAKE_KERNEL_TABLE(bake_horizon_far_march);
	struct bake_horizon_span span;
	long next;

	for (int y = 0; y < nrows; y += BAKE_PACKET_HEIGHT)
		near[hz->isa](
		    hz, side, x0, y0 + y, slopes + y * BAKE_TILE_WIDTH);
	next = bake_horizon_far_span(hz, side, x0, y0, 0, &span);
	while (span.n > 0) {
		far[hz->isa](
		    hz, &span, bake_image_row(&hz->heights, y0) + x0, slopes);
		next = bake_horizon_far_span(hz, side, x0, y0, next, &span);
	}
}

void
bake_horizon_tile(const struct bake_horizon *hz, int side, int x0, int y0,
    float slopes[BAKE_TILE_TEXELS])
{
	static void (*const strip[])(const struct bake_horizon *, int, int, int,
	    float *) = BAKE_KERNEL_TABLE(bake_horizon_strip);
	const int left = hz->heights.height - y0;
	const int nrows = left < BAKE_TILE_HEIGHT ? left : BAKE_TILE_HEIGHT;

	for (int t = hz->exact ? 0 : nrows * BAKE_TILE_WIDTH;
	     t < BAKE_TILE_TEXELS; t++)
		slopes[t] = 0;
	if (!hz->exact) {
		march_fast(hz, side, x0, y0, nrows, slopes);
		return;
	}
	for (int y = 0; y < nrows; y += BAKE_PACKET_HEIGHT)
		strip[hz->isa](
		    hz, side, x0, y0 + y, slopes + y * BAKE_TILE_WIDTH);
}
