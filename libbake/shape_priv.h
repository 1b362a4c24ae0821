/* Grids of points on surfaces, of which the built-in shapes are sewn. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_SHAPE_PRIV_H
#define BAKE_SHAPE_PRIV_H

#include <stdbool.h>

#include "shape.h"

/* A point of a surface: du x dv points outwards. At a pole du is the limit of
 * its direction. */
struct bake_shape_point {
	double p[3], du[3], dv[3], uv[2];
};

/*
 * A grid of nu by nv quadrangles. point gives the one at u = half / (2 nu),
 * v = k / nv. Where a side in v is a pole its quadrangles are triangles, their
 * tips at odd 'half'; its position is that of half = 0.
 */
struct bake_shape_grid {
	int nu, nv;
	bool pole[2];
	void (*point)(const struct bake_shape_grid *grid, int half, int k,
	    struct bake_shape_point *point);
	int which;               /* face of the cube, cap of the cylinder */
	double control[4][4][3]; /* of the teapot's patch */
};

enum { BAKE_SHAPE_MAX_GRIDS = 32 };

/* The grids of a shape: how many there are. */
int bake_shape_grids(enum bake_shape shape, int detail,
    struct bake_shape_grid grids[BAKE_SHAPE_MAX_GRIDS]);

#endif
