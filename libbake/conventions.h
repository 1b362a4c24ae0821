/* The conventions in which maps differ: polarity, normal Y, normal code. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_CONVENTIONS_H
#define BAKE_CONVENTIONS_H

#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a relief map's values mean: depth, 0 = on the surface and 1 = deepest
 * (the papers), or height, white = high. */
enum bake_polarity {
	BAKE_POLARITY_UNSURE = 0,
	BAKE_POLARITY_DEPTH,
	BAKE_POLARITY_HEIGHT
};

/* Where a positive normal y points: up, to the image's top, where v grows
 * (OpenGL), or down (DirectX). */
enum bake_normal_y {
	BAKE_NORMAL_Y_UNSURE = 0,
	BAKE_NORMAL_Y_UP,
	BAKE_NORMAL_Y_DOWN
};

/* How a normal's component n is stored as a value c: unsigned, n = 2c - 1, or
 * signed, n = c (float files only); auto looks at the values. */
enum bake_normal_code {
	BAKE_NORMAL_CODE_AUTO = 0,
	BAKE_NORMAL_CODE_UNSIGNED,
	BAKE_NORMAL_CODE_SIGNED
};

/* "depth", "height", "unsure". Static text. */
BAKE_API const char *bake_polarity_name(enum bake_polarity polarity);
/* "up", "down", "unsure". Static text. */
BAKE_API const char *bake_normal_y_name(enum bake_normal_y normal_y);
/* "auto", "unsigned", "signed". Static text. */
BAKE_API const char *bake_normal_code_name(enum bake_normal_code code);

#ifdef __cplusplus
}
#endif

#endif
