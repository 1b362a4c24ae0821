/* Dequantising: a smooth map within half a code of a quantised one. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_DEQUANTIZE_H
#define BAKE_DEQUANTIZE_H

#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Replace a quantised map v by a smooth one u with |u - v| <= 1/2 code, 0..1.
 * u starts as v; steps at spacings s = 1 1 2 2 4 4 8 8 16 16 8 4 2 1 texels do,
 * along both axes at once,
 *     u <- clamp(u - (Dx u + Dy u) / 16),  to v - 1/2 code .. v + 1/2 code
 *     D f = f(-2s) - 4 f(-s) + 6 f - 4 f(s) + f(2s)
 * with D u left out where the codes bend too much for mere rounding (|D v| > 4
 * codes), where finer steps have left a bend that is the map's own (|D u| > 2
 * codes; 9 for the first two, 3 at s = 16) and, at s = 16, where the map is not
 * near flat (|v(2s) - v(-2s)| > 8 codes). D is 0 on cubics: slopes and tops
 * stay. An edge of 5 codes or more stays an edge; two-valued maps that far
 * apart keep their bits. How much is gained depends on the map: see the tests
 * (RMS error / 3 on a sine of 180 texels, hardly any on detail of 16).
 *
 *   img       [H][W], 1 channel, values code / code_max in 0..1; in place
 *   code_max  largest code: 255 for 8 bits; 1 .. 65535
 *   wrap      torus, or the border texels repeated
 *   nthreads  0 = all processors
 *   err       reason on failure; never NULL
 *
 * BAKE_EINVAL  img is not of 1 channel, or code_max out of range
 * BAKE_ENOMEM  scratch memory, 8 bytes a texel; img is unchanged
 *
 * Reentrant. Same bytes for every thread count. Own derivation.
 */
BAKE_API enum bake_status bake_dequantize(struct bake_image *img, int code_max,
    struct bake_wrap wrap, int nthreads, struct bake_err *err);

/*
 * Whether quantisation tilts the horizons of a depth map; cheap.
 *
 *   img          [H][W]; channel 0 is looked at, values 0..1
 *   code_max     largest code, > 0
 *   depth_scale  depth range / texture width
 *   step_texels  out: height of one code in texels, |depth_scale| W / code_max:
 *                the slope that one code makes between neighbouring texels
 *   share        out: share of texels, 0..1, with a right or lower neighbour
 *                exactly one code away (to 1/1000 code): the texels at which
 *                that slope stands
 *
 * step_texels * share is the mean slope that is an artefact, if all of it is.
 * Reentrant; cannot fail. Own derivation.
 */
BAKE_API void bake_quantization_matters(const struct bake_image *img,
    int code_max, double depth_scale, double *step_texels, double *share);

#ifdef __cplusplus
}
#endif

#endif
