/* Shell marching: one prism of the shell, and a ray's way through it. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_SHELL_MARCH_PRIV_H
#define BAKE_SHELL_MARCH_PRIV_H

#include <math.h>
#include <stdbool.h>

#include "shell_march.h"

struct bake_shell {
	const struct bake_mesh *mesh;
	const int *first; /* the weld's, or NULL */
	const struct bake_frames *frames;
	double depth, tile[2];
	/* [ntriangles]: what is beyond side k, the one without corner k, as
	 * 3 * triangle + its side; -1: nothing */
	int (*next)[3];
};

static inline double
bake_shell_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void
bake_shell_cross(const double a[3], const double b[3], double c[3])
{
	c[0] = a[1] * b[2] - a[2] * b[1];
	c[1] = a[2] * b[0] - a[0] * b[2];
	c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline const double *
bake_shell_position(const struct bake_shell *s, int triangle, int k)
{
	const int v = s->mesh->triangles[triangle][k].v;

	return s->mesh->positions[s->first != NULL ? s->first[v] : v];
}

static inline const double *
bake_shell_normal(const struct bake_shell *s, int triangle, int k)
{
	return s->frames->frame[s->frames->frame_of[triangle][k]].normal;
}

/*
 * The level triangle of depth z has the corners Q_k(z) = P_k - z D N_k: with
 *     a = o - P_0, m = -D N_0,
 *     A(z) = e_1 + z f_1, B(z) = e_2 + z f_2  its edges from corner 0,
 *     n(z) = A x B = n_0 + z n_1 + z^2 n_2
 * the ray's point o + t d lies in its plane where
 *     h(z, t) = n(z) . (a + t d - z m) = 0,
 * a cubic in z, linear in t. Where the prism is not folded its level triangles
 * do not meet each other, so that dh/dz has one sign in it, and z is monotonic
 * along the ray. The weights then follow in the plane, seen along the axis in
 * which n is largest.
 */
struct shell_prism {
	double a[3], d[3], m[3], e[2][3], f[2][3];
	double h[4], ht[3]; /* h's powers of z, at t = 0 and by t */
	double n[3][3];
	double sign; /* of dh/dz */
	double size; /* the longest edge */
	int i, j;    /* the axes of the weights' plane */
	/* place in the map's cells (march_priv.h): at corner 0, and how it
	 * changes to corners 1 and 2; and what counts as rounding of it */
	double place[2][3], slack;
};

/* A point of the ray: weights of the corners, depth; and their rates by t. */
struct shell_point {
	double t, b[3], z;
	double db[3], dz;
};

/* False where the triangle has no area to speak of. */
bool bake_shell_prism(struct shell_prism *p, const struct bake_shell *s,
    const struct bake_relief_map *map, int triangle, const double origin[3],
    const double dir[3]);

/* The point at t, sought from depth z. False where there is none nearby: the
 * prism is folded there, or t far from it. */
bool bake_shell_solve(
    const struct shell_prism *p, double t, double z, struct shell_point *point);

/* How a ray leaves a prism: over side 0 .. 2, or */
enum { SHELL_TOP = 3, SHELL_BOTTOM, SHELL_FOLD };

/* From `in`, where it came over side `entered` (-1: it starts here), to the
 * last point in the prism. */
int bake_shell_leave(const struct shell_prism *p, const struct shell_point *in,
    int entered, struct shell_point *out);

/* The side over which a ray leaves a triangle without area, that it entered
 * over another at depth z in the point o + t d. */
int bake_shell_pass(const struct bake_shell *s, int triangle, int entered,
    const double point[3], double z);

/* Cells that are still to be gone through. */
struct shell_budget {
	long ncells;
};

/*
 * The first point from in to out where the ray is below the relief: f >= bias,
 * f = z - d. any: it is enough to know that there is one.
 */
bool bake_shell_search(const struct shell_prism *p,
    const struct bake_relief_map *map, const struct shell_point *in,
    const struct shell_point *out, double bias, bool any,
    struct shell_budget *budget, struct shell_point *hit);

static inline double
bake_shell_place(const struct shell_prism *p, const double b[3], int axis)
{
	const double *c = p->place[axis];

	return c[0] + b[1] * c[1] + b[2] * c[2];
}

#endif
