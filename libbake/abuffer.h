/* The A-buffer: where the rays through texel centres cross a closed surface. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_ABUFFER_H
#define BAKE_ABUFFER_H

#include <stddef.h>

#include "mesh.h"
#include "view.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * One crossing of the ray through a texel's centre.
 *   depth     d of the view, 0 near .. 1 far; beyond them outside the range
 *   triangle  of the mesh
 *   entering  the ray, going away from the eye, enters the solid here. What
 *             the solid is is decided by the winding number, so that this may
 *             be other than what the triangle's own winding says: of a slab,
 *             of what is inside out, and of what was turned round. There the
 *             surface's normal is the opposite of the triangle's.
 *   tile_x, tile_y  which copy of the mesh it was: the texel's centre is at
 *             (x + tile_x width, y + tile_y height) on the mesh that is not
 *             repeated; 0 without tiling
 */
struct bake_crossing {
	double depth;
	unsigned entering : 1;
	unsigned triangle : 31;
	short tile_x, tile_y;
};

/*
 * How to make it.
 *   solidify  > 0: for open meshes: each crossing, of whatever direction, is
 *             a slab of that thickness along the ray, in mesh units, centred
 *             on the surface; slabs that overlap or touch are one.
 *             0: the mesh is closed, its solid is where the winding number
 *             is not 0
 *   reorient  turn round what is inside out. A part is all triangles that hang
 *             together over welded edges. Where each of its edges is used as
 *             often in one direction as in the other, it is turned as a
 *             whole; otherwise its pieces that hang together over edges of
 *             just two triangles are made of one winding, each by itself.
 *             Turned is what has a negative volume about the mean of its part's
 *             triangles (below 1e-12 of the sum of magnitudes: the smaller
 *             half). So a part that is a cavity in another becomes
 *             solid, too: without reorient it is hollow.
 */
struct bake_abuffer_params {
	double solidify;
	bool reorient;
};
#define BAKE_ABUFFER_PARAMS_DEFAULT                                            \
	{                                                                      \
		0, false                                                       \
	}

struct bake_abuffer; /* a mesh made ready for one view */

/*
 * Make ready. Vertices go to the nearest multiples of 2^-16 texel in x and y
 * (in two steps, by way of 2^-26 texel, halves to the even neighbour: so a
 * vertex that lies on a half but for rounding goes the same way as its copies a
 * period away, its mirror image and itself in another unit), and have depths in
 * double; triangles go into bins of BAKE_BAND_ROWS rows.
 *
 *   ab      out: the caller closes it; NULL on failure
 *   mesh    not modified; must outlive it
 *   weld    of the same mesh; must outlive it. Points are where their first
 *           position is. NULL: every position is a point of its own
 *   view    copied
 *   err     reason on failure; never NULL
 *
 * Triangles of no area after that, among them those that welding made
 * degenerate, are left out, and so are those outside of what is seen.
 *
 * BAKE_EINVAL  view or params are not valid, or weld is of another mesh
 * BAKE_EDATA   no triangle; or one reaches farther than 2^30 texels from the
 *              region's corner, over more than 32767 tiles to a side, or has a
 *              depth above 1e100: the message says which
 * BAKE_ENOMEM  no memory
 *
 * Memory: 24 bytes a position and about 5 a triangle; while it is made 4 more,
 * with reorient 220 more a triangle. One thread; reentrant.
 * [Own derivation; the snapping is that of all graphics hardware.]
 */
BAKE_API enum bake_status bake_abuffer_open(struct bake_abuffer **ab,
    const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_view *view, const struct bake_abuffer_params *params,
    struct bake_err *err);
/* Harmless on NULL. */
BAKE_API void bake_abuffer_close(struct bake_abuffer *ab);

/*
 * What resolving found, in texels: sums over bands are the picture's.
 *   open       whose winding number does not return to 0: the mesh is not
 *              closed there
 *   inside_out whose first stretch of a winding number other than 0, and
 *              thicker than 1e-12 of the range, has one below 0
 *   united     where crossings were dropped because they lie inside the union
 *   crossings  before resolving, all texels together
 *   most       layers of the deepest texel, after resolving
 */
struct bake_abuffer_stats {
	size_t open, inside_out, united, crossings;
	int most;
};

/*
 * The crossings of a band of rows, after resolving: those of texel (x, y) are
 *     crossing[start[i]] .. crossing[start[i + 1] - 1],  i = (y - y0) width + x
 * in depths that do not fall, entering and leaving in turns, the first
 * entering: an even number. Arrays are the band's own and grow as they need; a
 * band is used again and again by one thread, and freed by bake_band_free.
 */
struct bake_band {
	int y0, nrows;
	size_t *start; /* [nrows * width + 1] */
	struct bake_crossing *crossing;
	struct bake_abuffer_stats stats; /* of this band */
	struct bake_band_scratch *scratch;
};
#define BAKE_BAND_INIT                                                         \
	{                                                                      \
		.start = NULL                                                  \
	}

enum { BAKE_BAND_ROWS = 64 }; /* rows that are best done together */

/*
 * Fill a band with rows y0 .. y0 + nrows - 1 of the picture.
 *
 * Coverage, with y downwards, in exact integers: of an edge from p to q of a
 * triangle with a positive area, E(c) = (q - p) x (c - p); a texel's centre c
 * is covered where E >= 0 on edges with q_y < p_y or (q_y = p_y and q_x > p_x),
 * and E > 0 on the others. That is where a ray through c + (e, e^2), with e as
 * small as one likes, meets the triangle: it meets no edge and no vertex, so
 * that of every closed surface it enters as often as it leaves, whatever lies
 * on c itself.
 *
 * Depth: that of c's barycentrics, E / area, at the first texel of each row of
 * a triangle, and from there on by the depth's slope along x; exact integers
 * first, then double: within 1e-15 of the corners' largest depth, slivers
 * included. On an edge or a corner it is computed from its ends alone, so
 * that all triangles that meet there agree on every bit.
 *
 * Resolving: crossings are sorted by depth, entering first on ties, then by
 * triangle, then by tile; of the winding number's walk only the changes
 * 0 <-> nonzero stay: overlapping parts are their union. Two sheets that touch
 * but for rounding may leave a slab or a gap between them that has no
 * thickness; entering and leaving alternate all the same. A texel that is open
 * keeps what is whole of it (its last, unmatched entry is dropped) and is
 * counted.
 *
 *   y0, nrows  within the picture; the result does not depend on how rows are
 *              put in bands
 *   band       BAKE_BAND_INIT, or as the last call left it
 *   err        reason on failure; never NULL
 *
 * BAKE_EINVAL  rows that the picture does not have
 * BAKE_ENOMEM  no memory, or more than 2^32 crossings in one row
 * On failure the band is BAKE_BAND_INIT.
 *
 * Threads may fill different bands of one ab at once. Memory: 16 bytes a
 * crossing (two of them with solidify), 8 a texel, 40 a row of a triangle.
 * Sources: Carpenter, 'The A-buffer', SIGGRAPH
 * 1984; Edelsbrunner and Muecke, 'Simulation of Simplicity', 1990, for the
 * rule of edges.
 */
BAKE_API enum bake_status bake_abuffer_rows(const struct bake_abuffer *ab,
    int y0, int nrows, struct bake_band *band, struct bake_err *err);
/* Free all and reset to BAKE_BAND_INIT, on which it is harmless. */
BAKE_API void bake_band_free(struct bake_band *band);

/*
 * The weights of the corners of a crossing's triangle, in the mesh's order, at
 * the centre of texel (x, y) of the crossing's tile: E / area, quotients of
 * exact integers, each 0 .. 1 and within 4e-16; their sum is 1 within 1e-15.
 *
 *   crossing  one of texel (x, y) of a band of this ab
 *
 * Reentrant.
 */
BAKE_API void bake_abuffer_weights(const struct bake_abuffer *ab,
    const struct bake_crossing *crossing, int x, int y, double weight[3]);

#ifdef __cplusplus
}
#endif

#endif
