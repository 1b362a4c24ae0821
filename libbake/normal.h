/* Normals from a depth map, and normals brought to unit length. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_NORMAL_H
#define BAKE_NORMAL_H

#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The difference operators, in units of one texel pitch, f(i, j) with i to
 * the right and j upwards:
 *   CENTRAL  Dx f = (f(i+1, j) - f(i-1, j)) / 2, and Dy alike
 *   SCHARR   the same, smoothed across by [3 10 3] / 16:
 *            Dx f = (3 Dc(j-1) + 10 Dc(j) + 3 Dc(j+1)) / 16, Dc the central
 *            difference; nearly the same error in all directions
 * Both are exact on planes and of second order.
 */
enum bake_slope_op { BAKE_SLOPE_CENTRAL, BAKE_SLOPE_SCHARR };

/*
 * Unit normals of the surface h = (1 - depth) * depth_scale, in texture
 * widths, on texels of pitch 1/W in both directions:
 *     p = W Dx h,  q = W Dy h,  n = (-p, -q, 1) / sqrt(1 + p^2 + q^2)
 *
 *   depth        [H][W], 1 channel, 0 = on the surface, 1 = deepest; any size
 *                from 1x1; finite; values outside 0..1 are taken as they are
 *   depth_scale  depth range / texture width, finite; negative turns the
 *                relief inside out
 *   wrap         beyond the border: torus, or the border texel repeated (there
 *                the operator sees a half difference; it is the operator of
 *                the evenly mirrored map)
 *   op           the difference operator
 *   nthreads     0 = all processors
 *   normal       out: [H][W] 3 channels x, y, z, signed, y towards the image's
 *                top (row 0); BAKE_IMAGE_INIT before, the caller frees it
 *   err          reason on failure; never NULL
 *
 * A flat neighbourhood gives exactly (0, 0, 1): no -0.
 *
 * BAKE_EINVAL  depth is empty or not of 1 channel, depth_scale is not finite,
 *              or op is none of the above
 * BAKE_ENOMEM  no memory; on any failure normal stays BAKE_IMAGE_INIT
 *
 * Reentrant. Same bytes for every thread count.
 * Source: METHODS 1 for h; weights [3 10 3]: Scharr, 'Optimale Operatoren in
 * der Digitalen Bildverarbeitung', 2000.
 */
BAKE_API enum bake_status bake_normal_from_depth(const struct bake_image *depth,
    double depth_scale, struct bake_wrap wrap, enum bake_slope_op op,
    int nthreads, struct bake_image *normal, struct bake_err *err);

/*
 * The same of some rows: row i of `rows`, an image of depth's width and 3
 * channels that is the caller's, becomes row first + i of the map's normals.
 *
 * BAKE_EINVAL  as above, or the rows are not all in the map
 */
BAKE_API enum bake_status bake_normal_rows_from_depth(
    const struct bake_image *depth, double depth_scale, struct bake_wrap wrap,
    enum bake_slope_op op, int nthreads, int first, struct bake_image *rows,
    struct bake_err *err);

/*
 * Bring a map of signed normals to unit length, in place.
 *   3 channels  n / |n|; a vector that is zero, or so short or long that its
 *               direction is not known (|n| outside 1e-18 .. 1e18, or not
 *               finite), becomes (0, 0, 1) and is counted
 *   2 channels  a third is added: z = sqrt(max(0, 1 - x^2 - y^2)); x and y
 *               keep their bits where x^2 + y^2 <= 1, are scaled to length 1
 *               where it is more (z = 0, counted), and become 0 where they
 *               are not finite (z = 1, counted)
 *
 *   normal     [H][W] of 2 or 3 channels, signed; 3 channels on return. Must
 *              own its memory where it has 2: it is replaced
 *   nthreads   0 = all processors
 *   nreplaced  out: texels whose vector had no direction or did not fit into
 *              the unit circle, as above; may be NULL
 *   err        reason on failure; never NULL
 *
 * BAKE_EINVAL  normal has neither 2 nor 3 channels; unchanged
 * BAKE_ENOMEM  no memory for the third channel; unchanged
 *
 * Reentrant. Same bytes for every thread count. Own derivation.
 */
BAKE_API enum bake_status bake_normal_normalize(struct bake_image *normal,
    int nthreads, size_t *nreplaced, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
