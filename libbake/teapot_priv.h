/* The Utah teapot's patches, as the built-in shape is made from them. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_TEAPOT_PRIV_H
#define BAKE_TEAPOT_PRIV_H

#include <stdbool.h>

enum { BAKE_TEAPOT_NPATCHES = 32 };

/*
 * Patch 0 .. 31 of the teapot, standing on +y, its body of radius 1, centred:
 * published (x, y, z), z up, becomes (x / 2, z / 2 - 63/80, -y / 2).
 *
 *   control  out: [v][u] points of the bicubic Bezier patch, du x dv outwards
 *   pole     out: all points of v = 0 or of v = 1 are one
 *   half     out: u goes half round a tube (spout, handle), not a quarter
 */
void bake_teapot_patch(
    int patch, double control[4][4][3], bool pole[2], bool *half);

/*
 * A point of a patch and its derivatives.
 *   i, n  u = i / n, 0 <= i <= n
 *   k, m  v = k / m, 0 <= k <= m
 *   uv    the mixed derivative
 * Borders that two patches share, in either direction, give the same bits.
 */
struct bake_teapot_point {
	double p[3], u[3], v[3], uv[3];
};
void bake_teapot_eval(const double control[4][4][3], int i, int n, int k, int m,
    struct bake_teapot_point *point);

#endif
