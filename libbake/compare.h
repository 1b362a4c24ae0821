/* The golden-file comparison: how far apart two images are. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_COMPARE_H
#define BAKE_COMPARE_H

#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { BAKE_COMPARE_CHANNELS = 64 };

/*
 * The difference of one channel, or of all (channel -1). A difference is in
 * codes where code_max was given, rounded to the whole codes that the values
 * stand for, else in the values' own unit.
 *   worst       largest |a - b|; +Inf where one value is NaN or infinite and
 *               the other is not the same
 *   x, y        its place, the first in reading order (rows from the top);
 *               channel: the channel there
 *   a, b        the two values there, as stored in the images
 *   mean        of |a - b| over the values where it is finite; 0 where none
 *   ndifferent  values that differ at all
 *   nbeyond     values that differ by more than the tolerance
 *   nmismatch   values where the difference is not finite
 */
struct bake_difference {
	double worst, mean;
	int x, y, channel;
	float a, b;
	size_t ndifferent, nbeyond, nmismatch;
};

struct bake_comparison {
	struct bake_difference all;
	struct bake_difference channel[BAKE_COMPARE_CHANNELS];
	int nchans;
};

/*
 * Compare two images value by value. Where code_max > 0, values are codes /
 * code_max (255, 65535) and the difference is that of the nearest codes;
 * where it is 0, they are compared as floats, in double. NaN equals NaN and
 * nothing else, an infinity its own sign's; -0 equals 0.
 *
 *   tolerance  codes, or the value's unit: what counts as nbeyond, >= 0
 *   out        overwritten
 *
 * BAKE_EINVAL  code_max or tolerance below 0 or not a number
 * BAKE_EDATA   different sizes or channel counts, or more than
 *              BAKE_COMPARE_CHANNELS channels
 * After a failure *out is all zero. Reentrant.
 */
BAKE_API enum bake_status bake_compare(const struct bake_image *a,
    const struct bake_image *b, int code_max, double tolerance,
    struct bake_comparison *out, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
