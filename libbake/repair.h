/* Repair of texels that hold no value: NaN, infinities, no-data sentinels. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_REPAIR_H
#define BAKE_REPAIR_H

#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A value this large or larger, of either sign, is a no-data sentinel. */
#define BAKE_NODATA_MIN 1e30f

/*
 * Replace the texels in which any channel is NaN, infinite or of |v| >=
 * BAKE_NODATA_MIN by a smooth continuation of their surroundings, in place;
 * all channels of such a texel are replaced, each from its own channel.
 * The others keep their bits.
 *
 * The fill is push-pull: means of the good texels over 2x2 cells, again and
 * again, until every cell has one; then back down, a bad texel or empty cell
 * taking the linear interpolation of the coarser level; at last a few Jacobi
 * steps of Laplace's equation (mean of the 4 neighbours) on the bad texels, so
 * that a lone one is the mean of its neighbours and lies on their plane.
 * Filled values stay within the range of the good ones of their channel.
 *
 *   img        any size and channel count
 *   wrap       torus, or nothing beyond the border
 *   nthreads   0 = all processors
 *   nrepaired  out: texels replaced; never NULL
 *   err        reason on failure; never NULL
 *
 * BAKE_EINVAL  img is empty
 * BAKE_EDATA   no texel is good: 'has no finite texel'; img is unchanged
 * BAKE_ENOMEM  scratch memory, about 1.4 * channels bytes a texel of the
 *              image and 4 + 4 * channels bytes a bad one; img is unchanged.
 *              Without a bad texel only 8 bytes a row are needed
 *
 * Reentrant. Same bytes for every thread count.
 * Source: Gortler et al., 'The Lumigraph', SIGGRAPH 1996, 3.4.2 (push-pull),
 * with own boundary handling.
 */
BAKE_API enum bake_status bake_repair_nonfinite(struct bake_image *img,
    struct bake_wrap wrap, int nthreads, size_t *nrepaired,
    struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
