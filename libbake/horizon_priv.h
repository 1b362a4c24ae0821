/* Horizons of a height field: the map, the rays, the plain march. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_HORIZON_PRIV_H
#define BAKE_HORIZON_PRIV_H

#include <stddef.h>

#include "image.h"
#include "isa.h"

/*
 * Everything here is in texels and in units of depth: a slope is height over
 * texels, and tan e = slope * S * W. So one march serves every scale.
 */

/*
 * Direction j of n. The ray from texel (x, y), y counted downwards, is at
 * (x + k sign_x, y + k minor) on an x-major ray and at (x + k minor,
 * y + k sign_y) on a y-major one after k steps; its points are 'pitch' texels
 * apart.
 */
struct bake_horizon_dir {
	double cos_phi, sin_phi; /* y up, snapped to 0 */
	double minor;            /* texels of the minor axis a step, |m| <= 1 */
	double pitch;            /* sqrt(1 + m^2) */
	int major;               /* step on the major axis, +1 or -1 */
	bool x_major;
	long nsteps; /* K */
};

/*
 * One sample of a ray: with the texels p0 = t + (dx, dy) and p1 = its
 * neighbour at +1 on the minor axis (right or below),
 *     slope = w0 (h(p0) - h(t)) + w1 (h(p1) - h(t))
 *     w0 = (1 - f) / dist, w1 = f / dist, f the fraction of the position
 * Differences first: where they cancel, the result is exact, and a plane has
 * slope 0.
 */
struct bake_horizon_step {
	long dx, dy;
	float w0, w1;
};

/*
 * Fill in direction j of n, 0 <= j < n. nsteps is periods times the major
 * axis' length, or with radius > 0 (in texture widths) the largest k with
 * k pitch <= radius * width.
 */
void bake_horizon_dir_init(struct bake_horizon_dir *dir, int j, int n,
    int width, int height, double radius, int periods);

/* Fractions of a texel below this are none; a slope changes by as much. */
#define BAKE_HORIZON_SNAP 1e-9

/* Sample k >= 1 of a ray in direction dir; offsets are not wrapped. */
struct bake_horizon_step bake_horizon_step(
    const struct bake_horizon_dir *dir, long k);

/* What the heights are made of a depth: -depth, made harmless. See ao.h. */
static inline float
bake_horizon_height(float depth)
{
	float h = depth > -1e28f ? depth < 1e28f ? depth : 1e28f : -1e28f;

	/* below 1e-20 weights times differences could become denormal and
	 * round differently in a bound than in a sample */
	if (depth != depth || (h < 1e-20f && h > -1e-20f))
		return 0;
	return -h;
}

/*
 * The march as it is defined: the steepest slope from texel (x, y) along dir,
 * or 0 if all is below it.
 *
 *   heights  1 channel, as bake_horizon_height makes them
 *
 * The fast kernel gives the same bits; tests compare the two. Reentrant.
 */
float bake_horizon_march(const struct bake_image *heights,
    struct bake_wrap wrap, const struct bake_horizon_dir *dir, int x, int y);

/*
 * The fast march. Texels are marched in packets of 8 x 4; 8 packets side by
 * side are a strip, 4 strips a tile. The steps of a ray are taken in chunks of
 * 8. A chunk is skipped for a packet when no sample in it can raise a horizon
 * of the packet, which a table of window maxima tells: see
 * horizon_kernel.c. Skipping is safe in floating point, so that the result
 * has the bits of bake_horizon_march.
 */
enum {
	BAKE_CHUNK = 8,
	BAKE_PACKET_WIDTH = 8,
	BAKE_PACKET_HEIGHT = 4,
	BAKE_STRIP_PACKETS = 8,
	BAKE_STRIP_WIDTH = BAKE_STRIP_PACKETS * BAKE_PACKET_WIDTH,
	BAKE_TILE_WIDTH = BAKE_STRIP_WIDTH,
	BAKE_TILE_HEIGHT = 16,
	BAKE_TILE_TEXELS = BAKE_TILE_WIDTH * BAKE_TILE_HEIGHT
};

/*
 * BAKE_CHUNK samples of a ray. A packet whose top left texel is t reads
 * t + (x, y) and the texels right of and below it alone: (x, y) is the least
 * offset of the chunk's samples. Sample i is 'rel[i]' floats further on.
 * Missing samples of the last chunk have no weight.
 */
struct bake_horizon_chunk {
	int rel[BAKE_CHUNK];
	float w0[BAKE_CHUNK], w1[BAKE_CHUNK]; /* negative, see march_row */
	int crest_rel; /* the same of the chunk's entry in 'crests' */
};

/* Where a chunk is, apart from its samples because it is looked at far more
 * often: its origin, reduced modulo the map on an axis that wraps, and the
 * distance of the first sample, a little less. */
struct bake_horizon_place {
	int x, y;
	float reach;
};

/*
 * Maxima over windows of the heights, on every other texel (x, y) of the map
 * and its border, counted from the border's corner. Stored so that windows 8
 * texels apart, as the packets of a strip are, are adjacent:
 *     data[(y / 2 * 4 + x / 2 % 4) * stride + x / 8]
 */
struct bake_horizon_windows {
	float *data;
	size_t stride;
};
enum { BAKE_WINDOW_PHASES = 4 };

/* The row of windows with origins on row 2 y2 of the border. */
static inline float *
bake_horizon_window_row(const struct bake_horizon_windows *w, int y2)
{
	return w->data + (size_t)y2 * BAKE_WINDOW_PHASES * w->stride;
}

/*
 * The far field of a march that is not exact: what lies beyond the first
 * 'near' steps of a ray is taken in segments, each represented by its highest
 * sample at one distance. Blocks are BAKE_FAR_BLOCK texels on the ray's major
 * axis and one texel on the other; P_0(b) is the highest of the samples that
 * the ray, from the middle of the first texel it meets in block b, has there.
 * With u the ray's step from block to block,
 *     P_(i+1)(b) = max(P_i(b), P_i(b + round(2^i u)))
 * A segment is one value of P_i. A texel of a block, counted right or down,
 * has its own place for it and its own distance below BAKE_FAR_SHARED; from
 * that level on the block's middle decides for all four. From BAKE_FAR_COARSE
 * on only one in BAKE_FAR_MERGE blocks has a value, for all texels of that
 * many: the first one that the ray meets.
 */
enum {
	BAKE_FAR_BLOCK = 4,
	BAKE_FAR_LEVELS = 9,
	BAKE_FAR_SHARED = 2,
	BAKE_FAR_COARSE = 4,
	BAKE_FAR_MERGE = 4
};

/* How the values of a level lie in memory, in a direction. */
struct bake_horizon_grid {
	int block_width, block_height; /* texels of a value */
	int width, height;             /* of the map, in values */
	int left, top;                 /* of the border */
	int columns, rows;             /* that a tile reads */
	size_t stride;
};

struct bake_horizon_segment {
	int level; /* i: BAKE_FAR_BLOCK 2^i steps */
	/* from the block of texel o on, for each o; reduced */
	int x[BAKE_FAR_BLOCK], y[BAKE_FAR_BLOCK];
	float weight[BAKE_FAR_BLOCK]; /* 1 / the distance it is put at */
	float reach;                  /* nothing in it or beyond is nearer */
};

struct bake_horizon_far {
	long near;      /* steps, a multiple of a block */
	int per_octave; /* segments */
	double place;   /* in a segment, 0 .. 1 */

	size_t size[2]; /* of a level, fine and coarse */
	int nlevels;
	float *levels; /* P_0, P_1 ... */

	/* the present direction's, see bake_horizon_aim */
	struct bake_horizon_grid grid[2]; /* fine and coarse */
	struct {
		int offset;       /* on the minor axis, rounded down */
		float frac;       /* what is left of it */
	} sample[BAKE_FAR_BLOCK]; /* of texel o of a block */
	int top_level;
	struct {
		int x, y;
	} step[BAKE_FAR_LEVELS]; /* round(2^i u), in values of level i */
};

/* Some segments, and where a tile finds them: the block that
 * goes with its first texel, for each texel of a block. */
enum { BAKE_FAR_SPAN = 32 };
struct bake_horizon_span {
	const struct bake_horizon_segment *segments;
	int n;
	int nseparate; /* below BAKE_FAR_SHARED, which come first */
	int nfine;     /* below BAKE_FAR_COARSE, of all */
	const float *origin[BAKE_FAR_SPAN][BAKE_FAR_BLOCK];
};

/*
 * What n blocks of P_0 are made of: of texel o of each block, heights a and b
 * on either side of the ray, frac of the way from a to b. On an x-major ray
 * texel o of block i is at a[o][BAKE_FAR_BLOCK i + o], else at a[o][i].
 */
struct bake_horizon_blocks {
	const float *a[BAKE_FAR_BLOCK], *b[BAKE_FAR_BLOCK];
	float frac[BAKE_FAR_BLOCK];
	float highest; /* of the map */
	bool x_major;
};

/* How far samples are looked at one by one; see enum bake_ao_quality. */
enum bake_horizon_quality {
	BAKE_HORIZON_EXACT,
	BAKE_HORIZON_FAST,
	BAKE_HORIZON_PREVIEW
};

/* One of the directions that the march is turned to. */
struct bake_horizon_ray {
	struct bake_horizon_dir dir;
	bool opposite; /* to the one that the tables are made for */
	long nchunks;  /* that it is marched in */
	struct bake_horizon_place *places;
	struct bake_horizon_chunk *chunks;
	long nsegments; /* of the far field */
	struct bake_horizon_segment *segments;
};

/* What the marches of one bake share. */
struct bake_horizon {
	/* the heights and, around them, a border of what lies beyond: left
	 * and top on clamped axes alone. heights is a view of (0, 0) on. */
	struct bake_image heights;
	float *padded;
	int left, top, padded_width, padded_height;
	float highest, slack; /* slack: some roundings of the largest height */
	struct bake_wrap wrap;
	enum bake_isa isa;
	double radius;
	int periods;

	/* the present direction and, where there is one, its opposite, which
	 * shares the tables: they hold maxima of pieces of rays, whichever way
	 * one goes through them */
	struct bake_horizon_ray ray[2];
	int nrays;

	/* exact, of ray[0]: the highest height that a chunk with its
	 * origin at (x, y) can read for a packet, columns x rows blocks */
	struct bake_horizon_windows windows;
	int columns, rows;
	struct bake_horizon_windows blocks; /* 2 x 2 texels each */
	/* exact, of ray[0] and each texel of the map and its border,
	 * laid out as padded: the highest texel that a chunk's samples can
	 * touch when its first is between the texel and its neighbour on the
	 * minor axis */
	float *crests;

	bool exact;
	struct bake_horizon_far far; /* else */

	float *scratch; /* [nthreads] rows: 2 of windows, or 1 of a level */
	size_t scratch_row;
};

/* Where a tile or strip finds origin i of an axis, an offset being reduced: on
 * the map, or on a clamped axis up to 'border' before it or just beyond it. */
static inline int
bake_horizon_wrap(int i, int size, bool clamp, int border)
{
	if (clamp)
		return i < -border ? -border : i > size ? size : i;
	return i >= size ? i - size : i;
}

/*
 * Prepare the horizons of depth. *hz is overwritten; free it with
 * bake_horizon_free, also after a failure.
 *
 * BAKE_ENOMEM  no memory, or a size overflows
 */
enum bake_status bake_horizon_init(struct bake_horizon *hz,
    const struct bake_image *depth, struct bake_wrap wrap, double radius,
    int periods, enum bake_horizon_quality quality, int nthreads,
    struct bake_err *err);

void bake_horizon_free(struct bake_horizon *hz);

/*
 * Turn to direction j of n, 0 <= j < n, and, where n is even, to the opposite
 * one, j + n / 2. Called by all threads of an OpenMP team of at most init's
 * nthreads, which share the work; all return when it is done.
 */
void bake_horizon_aim(struct bake_horizon *hz, int j, int n);

/*
 * slopes[row][column] of the texels (x0 + column, y0 + row) of one tile along
 * hz->ray[side], x0 and y0 multiples of the tile's size. Values of texels
 * beyond the map are unspecified, but finite. Reentrant.
 */
void bake_horizon_tile(const struct bake_horizon *hz, int side, int x0, int y0,
    float slopes[BAKE_TILE_TEXELS]);

/* The windows with origins on row 2 y2 of the border, from the blocks;
 * scratch: two rows. */
void bake_horizon_windows_row_baseline(
    const struct bake_horizon *hz, int y2, float *scratch);
void bake_horizon_windows_row_avx2(
    const struct bake_horizon *hz, int y2, float *scratch);
void bake_horizon_windows_row_avx512(
    const struct bake_horizon *hz, int y2, float *scratch);

/* Row y of the crests, -top <= y < padded_height - top. */
void bake_horizon_crest_row_baseline(const struct bake_horizon *hz, int y);
void bake_horizon_crest_row_avx2(const struct bake_horizon *hz, int y);
void bake_horizon_crest_row_avx512(const struct bake_horizon *hz, int y);

/* One strip, its first texel (x0, y0), along hz->ray[side]; slopes[4][64] are
 * raised. */
void bake_horizon_strip_baseline(
    const struct bake_horizon *hz, int side, int x0, int y0, float *slopes);
void bake_horizon_strip_avx2(
    const struct bake_horizon *hz, int side, int x0, int y0, float *slopes);
void bake_horizon_strip_avx512(
    const struct bake_horizon *hz, int side, int x0, int y0, float *slopes);

/* The same, dense, for the chunks before the far field. */
void bake_horizon_near_baseline(
    const struct bake_horizon *hz, int side, int x0, int y0, float *slopes);
void bake_horizon_near_avx2(
    const struct bake_horizon *hz, int side, int x0, int y0, float *slopes);
void bake_horizon_near_avx512(
    const struct bake_horizon *hz, int side, int x0, int y0, float *slopes);

/* Make the far field of a horizon whose heights are there, turn it to the
 * present rays (by a team, as bake_horizon_aim), free it. */
enum bake_status bake_horizon_far_init(
    struct bake_horizon *hz, int nthreads, struct bake_err *err);
void bake_horizon_far_aim(struct bake_horizon *hz);
void bake_horizon_far_free(struct bake_horizon_far *far);

/* dst = max(a, b) */
void bake_horizon_higher_baseline(
    float *dst, const float *a, const float *b, size_t n);
void bake_horizon_higher_avx2(
    float *dst, const float *a, const float *b, size_t n);
void bake_horizon_higher_avx512(
    float *dst, const float *a, const float *b, size_t n);

/*
 * dst[i] = max over o of min(a + frac (b - a), highest), 0 <= i < n. Up to 15
 * more are written, and read where dst goes on.
 */
void bake_horizon_far_blocks_baseline(
    float *dst, const struct bake_horizon_blocks *blocks, size_t n);
void bake_horizon_far_blocks_avx2(
    float *dst, const struct bake_horizon_blocks *blocks, size_t n);
void bake_horizon_far_blocks_avx512(
    float *dst, const struct bake_horizon_blocks *blocks, size_t n);

/* The next segments of hz->ray[side] for the tile at (x0, y0); returns the
 * first of those after them. */
long bake_horizon_far_span(const struct bake_horizon *hz, int side, int x0,
    int y0, long first, struct bake_horizon_span *span);

/* Raise the slopes of one tile, its first texel at base, by these segments. */
void bake_horizon_far_march_baseline(const struct bake_horizon *hz,
    const struct bake_horizon_span *span, const float *base, float *slopes);
void bake_horizon_far_march_avx2(const struct bake_horizon *hz,
    const struct bake_horizon_span *span, const float *base, float *slopes);
void bake_horizon_far_march_avx512(const struct bake_horizon *hz,
    const struct bake_horizon_span *span, const float *base, float *slopes);

#endif
