/* The rasteriser: projected pieces, their bins, and the kernel's rows. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_RASTER_PRIV_H
#define BAKE_RASTER_PRIV_H

#include <stdbool.h>
#include <stdint.h>

#include "isa.h"
#include "raster.h"

/*
 * Positions on the picture are integers of 2^-8 samples. Pieces are cut where
 * they are further than RASTER_GUARD samples outside it, a picture is 2^17
 * samples wide at most, so coordinates are within +-2^27, differences within
 * +-2^28, and sums of two products of these within 64 bits.
 */
enum { RASTER_SUB = 256, RASTER_GUARD = 1 << 18 };

/* A triangle of the mesh, or what clipping left of it: clockwise in y down. */
struct raster_piece {
	int32_t x[3], y[3];
	int32_t triangle; /* of the mesh; ~triangle where its back is seen */
};

/*
 * Of an edge: E = c + a x + b y >= 0 at samples (x, y) on its inner side, with
 * those on the edge itself where it is a top or a left one.
 */
struct raster_edge {
	int64_t a, b, c;
};

/* Samples x0 .. x1, y0 .. y1; none where x0 > x1 or y0 > y1. */
struct raster_box {
	int x0, y0, x1, y1;
};

struct bake_raster {
	const struct bake_mesh *mesh;
	struct bake_camera_basis basis;
	enum bake_cull cull;
	int width, height, columns; /* in samples; tiles in a row */
	int ntiles;
	double scale, cx, cy; /* of basis, in samples */
	double (*q)[3];       /* [npositions] x, y, depth seen from the eye */
	size_t npieces;
	struct raster_piece *pieces;
	size_t *start; /* [ntiles + 1] of a tile in bins */
	uint32_t *bins;
	enum bake_isa isa;
};

void bake_raster_edges(
    const struct raster_piece *piece, struct raster_edge edges[3]);
struct raster_box bake_raster_bounds(
    const struct bake_raster *raster, const struct raster_piece *piece);

enum { RASTER_MAX_PIECES = 6 }; /* a triangle that 5 planes cut has 8 corners */

/*
 * Cut a triangle at the near plane and the guard band.
 *   q       its corners
 *   pieces  out: corners of triangles; how many is returned
 */
int bake_raster_clip(const struct bake_raster *raster, double q[3][3],
    double pieces[RASTER_MAX_PIECES][3][3]);

/* Pieces into the bins of tiles, in their order. */
enum bake_status bake_raster_bin(
    struct bake_raster *raster, int nthreads, struct bake_err *err);

enum {
	RASTER_SAMPLES = BAKE_RASTER_TILE * BAKE_RASTER_TILE,
	RASTER_PADDED = RASTER_SAMPLES + 16 /* vectors may write beyond a run */
};

/*
 * What the kernel fills in. Samples begin[y] .. end[y] - 1 of rows y0 .. y1.
 * A linear function of samples is { at (0, 0), per x, per y }:
 *     b1 = e1 / s,  b2 = e2 / s,  w = w0 + b1 w1 + b2 w2
 * clamped to b1, b2, 1 - b1 - b2 >= 0 and to w >= near; distance is w length.
 */
struct raster_rows {
	int y0, y1;
	int begin[BAKE_RASTER_TILE], end[BAKE_RASTER_TILE];
	double e1[3], e2[3], s[3];
	double w0, w1, w2, near;
	const float *length; /* [32][32], padded */
	float *b1, *b2, *distance;
};
typedef void raster_rows_fn(const struct raster_rows *rows);
raster_rows_fn bake_raster_rows_baseline, bake_raster_rows_avx2,
    bake_raster_rows_avx512;

/* |(x + i dx, y - j dx, 1)| at sample (i, j) of a tile. */
typedef void raster_lengths_fn(float *length, double x, double y, double dx);
raster_lengths_fn bake_raster_lengths_baseline, bake_raster_lengths_avx2,
    bake_raster_lengths_avx512;

#endif
