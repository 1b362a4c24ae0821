/* The rasteriser: which triangles a picture's samples see, and where. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_RASTER_H
#define BAKE_RASTER_H

#include <stddef.h>

#include "camera.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Samples a side of a tile; a pixel has 1, 4, 9 or 16 samples: a grid of n by n
 * inside the pixel. The picture in samples is width n by height n; sample (x,
 * y) is at ((x + 1/2) / n, (y + 1/2) / n) in pixels.
 */
enum { BAKE_RASTER_TILE = 32 };

/* Which side of triangles is left out. The front is where the corners go
 * counterclockwise. */
enum bake_cull { BAKE_CULL_BACK, BAKE_CULL_FRONT, BAKE_CULL_NONE };

/* A mesh made ready for one camera. */
struct bake_raster;

/*
 * Make ready: triangles are clipped at the near plane, projected, and put into
 * the bins of the tiles that they touch, in their order.
 *
 * A corner that bake_camera_project puts at the pixel p is at
 *     floor(256 n p + 1/2) / 256
 * samples. A triangle covers the samples that are inside of all of its edges,
 * exactly; one on an edge from a to b (inside on the right in y down, as the
 * picture is) is covered where the edge goes up, or to the right and level: the
 * top-left rule. So, of triangles that share an edge's two corners, or
 * positions that are equal, one covers each sample next to it, none is missed
 * or seen twice, and each sample meets as many fronts as backs of a closed
 * mesh that the near plane does not cut. That holds for triangles of any size:
 * what is more than 2^18 samples outside the picture is cut off, at the same
 * point for both triangles of an edge, and so is what is nearer than near.
 *
 * A triangle is not seen where its corners are on one line on that grid
 * or one of them is more than 1e30 from the eye along one of the camera's axes.
 * Which side is seen is decided on the grid, too: of a triangle some
 * 1 / 256 of a sample wide it may not be the side that the eye is on.
 *
 *   raster    out: NULL on failure; to be closed
 *   mesh      must outlive it; only positions and triangles are used; may be
 *             empty
 *   samples   n: n x n samples a pixel, 1 .. 4
 *   nthreads  of this call; 0: all
 *
 * BAKE_EINVAL  samples, cull or nthreads out of range; a camera that
 *              bake_camera_basis refuses; more than INT_MAX / 3 triangles
 * BAKE_ENOMEM  no memory: 33 bytes a position, 28 for each triangle that the
 *              picture sees (some more where they are cut), 4 for each tile
 *              that each of these touches, 16 a tile and thread
 *
 * Reentrant. The result is the same for every thread count.
 * Sources: Pineda, 'A Parallel Algorithm for Polygon Rasterization', 1988;
 * Sutherland and Hodgman, 'Reentrant Polygon Clipping', 1974.
 */
BAKE_API enum bake_status bake_raster_open(struct bake_raster **raster,
    const struct bake_mesh *mesh, const struct bake_camera *camera, int samples,
    enum bake_cull cull, int nthreads, struct bake_err *err);
BAKE_API void bake_raster_close(struct bake_raster *raster); /* NULL: ok */

/* How many tiles there are, in rows from the top. Reentrant. */
BAKE_API int bake_raster_ntiles(const struct bake_raster *raster);

/*
 * The samples of a tile: columns x0 .. x0 + w - 1, rows y0 .. y0 + h - 1. w and
 * h are BAKE_RASTER_TILE but for the last column and row of tiles, which may
 * have less. Reentrant.
 */
BAKE_API void bake_raster_tile(const struct bake_raster *raster, int tile,
    int *x0, int *y0, int *w, int *h);

/*
 * A run of fragments of one triangle: samples that it covers in one tile, at
 * most BAKE_RASTER_TILE^2, rows from the top, each from the left.
 *   triangle  of the mesh
 *   n         how many, > 0
 *   back      1: its back is seen, 0: its front
 *   index     [n] of the sample in the tile: (y - y0) * BAKE_RASTER_TILE + x -
 * x0 b1, b2    [n] perspective-correct weights of the mesh's corners 1 and 2
 * (that of corner 0 is 1 - b1 - b2, which may be -2^-23), of the corners before
 * clipping, too distance  [n] from the eye along the sample's ray
 * (orthographic: from the plane through the eye), in the mesh's unit
 *
 * Weights and distance are those of the point where the sample's ray meets the
 * triangle's plane, worked out in double from the mesh's own positions:
 *     p, p + u, p + v  the corners seen from the eye, d the ray
 *     s = d . (u x v),  b1 = d . (v x p) / s,  b2 = d . (p x u) / s
 *     distance = |d| (p.w + b1 u.w + b2 v.w),  d.w = 1
 * Rounded to float weights are within 2^-25, distances within 2^-22 of their
 * value (and what double lost to triangles seen edge-on or very small for their
 * distance). A sample that is covered only since corners were moved to the grid
 * may lie outside the triangle, by 2^-8 samples: its weights are clamped to b1,
 * b2 >= 0, b1 + b2 <= 1, its distance to near at least. All are finite.
 *
 * The arrays are in the scratch memory and may be changed. Each array is
 * aligned to 64 bytes if scratch is and may be read up to the next multiple of
 * 16 values; what is beyond n has no meaning.
 */
struct bake_fragments {
	int triangle, n;
	int back;
	short *index;
	float *b1, *b2, *distance;
};

/*
 * Call take for each triangle of a tile that covers samples, in the mesh's
 * order, culled ones left out; a triangle that the near plane or the guard band
 * cut may come in up to 6 runs one after the other, of different samples.
 * Fragments are not tested against each other by their distance: a relief
 * moves them.
 *
 *   tile     0 .. bake_raster_ntiles() - 1
 *   take     called on the caller's thread; the run is valid during the call
 *   scratch  bake_raster_scratch() bytes, aligned to 64, of one thread; need
 * not be initialised
 *
 * Threads may do different tiles at once. What is given to take is the same
 * bytes for every thread count and instruction set.
 */
BAKE_API size_t bake_raster_scratch(void);
BAKE_API void bake_raster_fragments(const struct bake_raster *raster, int tile,
    void (*take)(void *arg, const struct bake_fragments *fragments), void *arg,
    void *scratch);

#ifdef __cplusplus
}
#endif

#endif
