/* The A-buffer: the snapped mesh, its bins, and arithmetic on texel centres. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_ABUFFER_PRIV_H
#define BAKE_ABUFFER_PRIV_H

#include <limits.h>
#include <stdint.h>

#include "abuffer.h"

/*
 * Positions in the picture are integers, 2^16 to a texel, x to the right and y
 * downwards; the centre of texel (x, y) is at (x + 1/2, y + 1/2) 2^16. Here x
 * and y, too, may be anywhere: the mesh is not repeated, a view is.
 */
enum { ABUFFER_BITS = 16, ABUFFER_HALF = 1 << 15 };

/* The farthest that a vertex may be from the region's corner: 2^30 texels. */
#define ABUFFER_FARTHEST ((int64_t)1 << 46)
/* x of a vertex that is farther, or whose depth is out of all measure */
#define ABUFFER_TOO_FAR INT64_MAX
/* Below this extent all products of differences fit in int64_t. */
#define ABUFFER_SMALL ((int64_t)1 << 30)
/* The largest depth, in ranges. */
#define ABUFFER_DEEPEST 1e100

typedef __int128 abuffer_wide;

struct abuffer_point {
	int64_t x, y;
	double depth;
};

/*
 * A mesh made ready.
 *   point   [mesh->npositions], filled in for welded points only
 *   turned  NULL, or [mesh->ntriangles] 1: its winding is turned round
 *   bin     [nbins + 1]; the triangles that have rows in bin b, which is
 *           BAKE_BAND_ROWS rows of the picture, are item[bin[b]] to
 *           item[bin[b + 1] - 1], rising
 *   half    half a slab's thickness as a depth; 0: the mesh is closed
 */
struct bake_abuffer {
	const struct bake_mesh *mesh;
	const int *first;
	struct bake_view view;
	double half;
	struct abuffer_point *point;
	unsigned char *turned;
	int nbins;
	size_t *bin;
	uint32_t *item;
};

/*
 * A triangle's texels in one row: n from column x on. depth is at the first of
 * them, slope what it grows by to the next; key is the triangle and
 * ABUFFER_LEAVING. 32 bytes: no more than that of a cache line.
 */
struct abuffer_span {
	double depth, slope;
	uint32_t x, n;
	uint32_t key;
	int16_t tile_x, tile_y;
};

/* A crossing before it is resolved. key is the triangle, and ABUFFER_LEAVING
 * where the ray goes out of its outside's back. */
struct abuffer_raw {
	double depth;
	uint32_t key;
	int16_t tile_x, tile_y;
};
#define ABUFFER_LEAVING ((uint32_t)1 << 31)

/*
 * What a band needs while it is filled; each array with its capacity.
 *   span, row_of  [nspans], and the row of the band that each is in
 *   order         [nspans] the spans of the first row, those of the second ...
 *   row           [band's rows + 1] where each row's begin in order
 *   at            [width + 1] where each texel's next crossing goes
 *   raw           one row's crossings, those of a texel together
 *   out, starts   the capacities of the band's own arrays
 *   total         crossings of all spans
 */
struct bake_band_scratch {
	struct abuffer_span *span;
	uint32_t *row_of, *order, *row, *at;
	struct abuffer_raw *raw;
	size_t nspans, spans, orders, rows, ats, raws, out, starts;
	size_t total;
};

/* What is wanted from memory in so many steps is asked for now. */
enum { ABUFFER_AHEAD = 16 };

static inline void
abuffer_corners(const struct bake_abuffer *ab, size_t triangle,
    const struct abuffer_point *corner[3])
{
	for (int k = 0; k < 3; k++) {
		int v = ab->mesh->triangles[triangle][k].v;

		corner[k] = &ab->point[ab->first != NULL ? ab->first[v] : v];
	}
}

/* The first row or column whose centre is at v or beyond. */
static inline int64_t
abuffer_ceil(int64_t v)
{
	return (v + ABUFFER_HALF - 1) >> ABUFFER_BITS;
}

/* Where row or column i has its centres. */
static inline int64_t
abuffer_centre(int64_t i)
{
	return i * (1 << ABUFFER_BITS) + ABUFFER_HALF;
}

/* floor(a / b), b > 0 */
static inline int64_t
abuffer_floor_div(int64_t a, int64_t b)
{
	int64_t q = a / b;

	return q - (a % b < 0);
}

/*
 * Find the triangles whose winding is to be turned round, so that every part
 * of the mesh is the right way out.
 *
 *   turned  out: [mesh->ntriangles] 1 where it is
 *
 * Two triangles with a welded edge in common belong to one part. Where every
 * edge of a part is used as often in the one direction as in the other, the
 * part is closed and of one winding, and is turned as a whole. Otherwise pieces
 * of it that hang together over edges of just two triangles are made of one
 * winding first, and each is turned by itself. Turned is what has a negative
 * volume about the middle of its part.
 *
 * BAKE_ENOMEM  no memory
 */
enum bake_status bake_abuffer_turn(const struct bake_mesh *mesh,
    const int *first, unsigned char *turned, struct bake_err *err);

/*
 * The spans of all triangles in rows y0 to y0 + nrows - 1: span, row_of, nspans
 * and total of s; row[1 + y] is how many row y has, row[0] is 0. s->row has
 * room for them.
 *
 * BAKE_ENOMEM  no memory, or 2^32 spans
 */
enum bake_status bake_abuffer_draw(const struct bake_abuffer *ab, int y0,
    int nrows, struct bake_band_scratch *s, struct bake_err *err);

/*
 * One row: sort each texel's crossings and write those that stay to out.
 *
 *   raw    those of texel x are end[x - 1] (0 for the first) to end[x] - 1;
 *          they are sorted in place
 *   half   half a slab's thickness as a depth; 0: a closed mesh
 *   start  [width + 1]; start[0] is where out goes on, the others are set
 *   out    has room for as many as raw after start[0], for slabs for twice as
 *          many
 *   stats  is added to
 */
void bake_abuffer_resolve(struct abuffer_raw *raw, const uint32_t *end,
    int width, double half, size_t *start, struct bake_crossing *out,
    struct bake_abuffer_stats *stats);

#endif
