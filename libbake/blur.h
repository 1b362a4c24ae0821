/* A Gaussian low-pass filter of ambient occlusion, at chosen texels. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_BLUR_H
#define BAKE_BLUR_H

#include <stdbool.h>
#include <stdint.h>

#include "image.h"

/*
 * Replace ao at texels with mask = 1 by a Gaussian mean,
 *     ao'(t) = 1 - sum_i w_i (1 - ao(t + i)) / sum_i w_i
 *     w_(x, y) = g(x) g(y),  g(x) = exp(-x^2 / (2 sigma^2)),
 *     |x|, |y| <= ceil(4 sigma)
 * over all texels, or (masked_only) over those with mask = 1 alone. What is
 * averaged is the occlusion 1 - ao, so that 1 stays exactly 1.
 *
 *   ao           1 channel, 0 .. 1; filtered in place
 *   mask         [height][width] bytes, 0 or 1
 *   sigma        texels, > 0
 *   masked_only  leave texels with mask = 0 out of the mean
 *   wrap         what lies beyond the border, for each axis; the filter may
 *                be wider than the image
 *   nthreads     > 0
 *
 * BAKE_ENOMEM  scratch: 4 bytes a texel, 8 with masked_only; ao unchanged
 *
 * Reentrant; the same bytes for every nthreads.
 */
enum bake_status bake_blur(struct bake_image *ao, const uint8_t *mask,
    double sigma, bool masked_only, struct bake_wrap wrap, int nthreads,
    struct bake_err *err);

#endif
