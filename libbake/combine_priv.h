/* The blends of a row of layers' texels; combine.c makes the rows. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_COMBINE_PRIV_H
#define BAKE_COMBINE_PRIV_H

#include "combine.h"

/* How a layer's row enters the sums. */
struct bake_combine_op {
	enum bake_normal_blend normal_blend;
	enum bake_ao_blend ao_blend;
	bool projected; /* channels 0, 1 are n.xy / (1 + n.z), not codes */
	bool first;     /* no normals before it */
	bool copy;      /* keep its codes of normal x, y: it is alone */
	double normal;  /* SEED: share of the sum; 0: no normals here */
	double su, sv;  /* PD: factors of the tangents; RNM …: w k */
	double depth;   /* share of the sum */
};

/* Tangents beyond this are not told from vertical by 16-bit codes. */
#define BAKE_TANGENT_MAX 128.0

/*
 * Codes of normal x, y in channels 0, 1 to n.xy / (1 + n.z), in place; row:
 * [width][4]. The form that layers are filtered in: the projection of the
 * sphere from its lower pole, whose length is the tangent of half the angle.
 */
void bake_combine_project(float *row, int width);

/* Add a row [width][4] to the sums: normal [width][3], or NULL; ao [width], or
 * NULL; depth [width]. */
void bake_combine_row(const struct bake_combine_op *op, const float *row,
    int width, float *normal, float *ao, float *depth);

/* Sums of normals to unsigned codes of unit normals, in place; copied: x and y
 * are codes already. */
void bake_combine_unit(
    enum bake_normal_blend blend, bool copied, float *normal, int width);

/* The resampling that places a map in a result of p's size. */
enum bake_status bake_combine_place(const struct bake_combine_params *p,
    const struct bake_placement *at, const struct bake_image *map,
    struct bake_resample_params *r, struct bake_err *err);

/* Whether each texel of the result is then one of the map's. */
bool bake_combine_copies(const struct bake_resample_params *r);

/* A call for each row of a map as it lies in the result, on any thread. */
struct bake_row_sink {
	void (*take)(void *arg, int y, const float *row);
	void *arg;
};
enum bake_status bake_combine_rows(const struct bake_combine_params *p,
    const struct bake_image *map, const struct bake_resample_params *how,
    const struct bake_row_sink *sink, struct bake_err *err);

#endif
