/* Solids of known shape as layers, and rays, for multilayer marching. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_MULTI_MARCH_H
#define TEST_MULTI_MARCH_H

#include "multi_march.h"
#include "test_layers.h"
#include "test_march.h"

/* The hits' arrays for n rays. Freed by free(hits.nx). */
static inline struct bake_multi_hits
new_hits(int n)
{
	const size_t m = ((size_t)n + 15) / 16 * 16;
	float *p = calloc(m * 6, sizeof *p);

	if (p == NULL)
		abort();
	return (struct bake_multi_hits){ p, p + m, p + 2 * m,
		(int *)(void *)(p + 3 * m), p + 4 * m, p + 5 * m };
}

static inline struct bake_multi_map *
open_multi(const struct bake_layer_maps *maps, struct bake_wrap wrap)
{
	struct bake_multi_map *map;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_multi_map_open(&map, maps, wrap, 1, &err) != BAKE_OK) {
		fprintf(stderr, "%s\n", err.msg);
		abort();
	}
	return map;
}

/*
 * A solid about the origin, x right, y up, z towards the eye of depth 0, in a
 * box of that half size. distance: to its surface, negative inside, of slope at
 * most `steepest`. slabs: the z of the vertical line's crossings, from the top
 * down; returns how many. normal: out of it, of any length, at its surface.
 */
struct solid {
	double half[3];
	double steepest;
	double (*distance)(const double p[3]);
	int (*slabs)(double x, double y, double *z);
	void (*normal)(const double p[3], double n[3]);
};

/* A torus round the axis of z. */
static const double torus_big = 0.7, torus_tube = 0.3;

static inline double
torus_distance(const double p[3])
{
	return hypot(hypot(p[0], p[1]) - torus_big, p[2]) - torus_tube;
}

static inline int
torus_slabs(double x, double y, double *z)
{
	const double side = hypot(x, y) - torus_big;
	const double zz = torus_tube * torus_tube - side * side;

	if (!(zz > 0))
		return 0;
	z[0] = sqrt(zz);
	z[1] = -z[0];
	return 2;
}

static inline void
torus_normal(const double p[3], double n[3])
{
	const double rho = hypot(p[0], p[1]);

	n[0] = p[0] * (1 - torus_big / rho);
	n[1] = p[1] * (1 - torus_big / rho);
	n[2] = p[2];
}

/*
 * Four strands each way, 1/2 apart, over and under each other; each is a
 * circle of radius weave_tube in the plane across its axis (solid_weave in
 * test_solid.h is the same as a mesh).
 */
enum { STRANDS = 4 };
static const double weave_tube = 0.1, weave_swing = 0.11;

/* The height of strand i, along x or y, at `at` along it. */
static inline double
weave_height(int i, bool along_x, double at)
{
	const double sign = (i + along_x) % 2 == 0 ? 1 : -1;

	return sign * weave_swing * cos(2 * pi * (at + 1) - pi / 2);
}

static inline double
weave_side(int i)
{
	return (i + 0.5) / 2 - 1;
}

static inline double
weave_distance(const double p[3])
{
	double least = INFINITY;

	for (int k = 0; k < 2; k++)
		for (int i = 0; i < STRANDS; i++) {
			const double side = p[1 - k] - weave_side(i);
			const double up = p[2] - weave_height(i, k == 0, p[k]);

			least = fmin(least, hypot(side, up) - weave_tube);
		}
	return least;
}

static inline int
weave_slabs(double x, double y, double *z)
{
	const double p[2] = { x, y };
	int n = 0;

	for (int k = 0; k < 2; k++)
		for (int i = 0; i < STRANDS; i++) {
			const double side = p[1 - k] - weave_side(i);
			const double zz = weave_tube * weave_tube - side * side;
			const double mid = weave_height(i, k == 0, p[k]);

			if (!(zz > 0))
				continue;
			z[n++] = mid + sqrt(zz);
			z[n++] = mid - sqrt(zz);
		}
	/* two strands at most; those that overlap are one */
	if (n == 4 && z[2] > z[0]) {
		const double a = z[0], b = z[1];

		z[0] = z[2], z[1] = z[3], z[2] = a, z[3] = b;
	}
	if (n == 4 && z[2] >= z[1]) {
		z[1] = fmin(z[1], z[3]);
		n = 2;
	}
	return n;
}

/* By differences, of the distance. */
static inline void
weave_normal(const double p[3], double n[3])
{
	for (int k = 0; k < 3; k++) {
		double a[3] = { p[0], p[1], p[2] }, b[3] = { p[0], p[1], p[2] };

		a[k] -= 1e-6;
		b[k] += 1e-6;
		n[k] = weave_distance(b) - weave_distance(a);
	}
}

static const struct solid torus_solid = { { 1, 1, 0.3 }, 1, torus_distance,
	torus_slabs, torus_normal };
static const struct solid weave_solid = { { 1, 1, 0.21 }, 1.25, weave_distance,
	weave_slabs, weave_normal };

/* The solid's layers, side by side texels, as rm-multilayer samples them. */
static inline struct bake_layer_maps
layers_of(const struct solid *s, int side, enum bake_data_format format)
{
	struct bake_layer_maps m =
	    layer_maps(side, side, 4, format, 0, 0, BAKE_DATA_UINT8);

	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++) {
			double p[3] = { ((x + 0.5) / side * 2 - 1) * s->half[0],
				(1 - (y + 0.5) / side * 2) * s->half[1], 0 };
			double z[4], n[3];
			const int count = s->slabs(p[0], p[1], z);

			for (int i = 0; i < count; i++) {
				double len;

				p[2] = z[i];
				s->normal(p, n);
				len = sqrt(
				    n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
				for (int k = 0; k < 3; k++)
					n[k] /= len;
				set_layer(&m, x, y, i,
				    bake_layer_stored(
					(1 - z[i] / s->half[2]) / 2),
				    n);
			}
		}
	return m;
}

/* An orthographic view of the box, which it looks at from yaw about y, then
 * pitch downwards; 0, 0 is the eye of depth 0. Pixels are square. */
struct eye {
	int side;
	double reach; /* half the picture */
	double dir[3], right[3], up[3];
};

static inline struct eye
eye_at(const struct solid *s, int side, double yaw_deg, double pitch_deg)
{
	const double a = yaw_deg * pi / 180, b = pitch_deg * pi / 180;
	const double *h = s->half;

	return (struct eye){ side,
		sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]),
		{ -sin(a) * cos(b), -sin(b), -cos(a) * cos(b) },
		{ cos(a), 0, -sin(a) },
		{ -sin(a) * sin(b), cos(b), -cos(a) * sin(b) } };
}

/* Where pixel i's line enters and leaves the box; false: it does not. */
static inline bool
through_box(const struct solid *s, const struct eye *e, int i, double from[3],
    double *length)
{
	const double x = ((i % e->side + 0.5) / e->side * 2 - 1) * e->reach;
	const double y = (1 - (i / e->side + 0.5) / e->side * 2) * e->reach;
	double in = -INFINITY, out = INFINITY;

	for (int k = 0; k < 3; k++) {
		from[k] = x * e->right[k] + y * e->up[k];
		if (fabs(e->dir[k]) < 1e-12) {
			if (fabs(from[k]) > s->half[k])
				return false;
			continue;
		}
		const double a = (-s->half[k] - from[k]) / e->dir[k];
		const double b = (s->half[k] - from[k]) / e->dir[k];

		in = fmax(in, fmin(a, b));
		out = fmin(out, fmax(a, b));
	}
	if (in >= out)
		return false;
	for (int k = 0; k < 3; k++)
		from[k] += in * e->dir[k];
	*length = out - in;
	return true;
}

/* Every pixel's ray through the box, t in the solid's unit; t_end < 0 where the
 * box is missed. */
static inline struct bake_rays
rays_of_eye(const struct solid *s, const struct eye *e)
{
	struct bake_rays r = new_rays(e->side * e->side);

	for (int i = 0; i < r.n; i++) {
		double from[3], length;

		r.t_end[i] = -1;
		if (!through_box(s, e, i, from, &length))
			continue;
		r.u[i] = (float)((from[0] / s->half[0] + 1) / 2);
		r.v[i] = (float)((from[1] / s->half[1] + 1) / 2);
		r.z[i] = (float)((1 - from[2] / s->half[2]) / 2);
		r.du[i] = (float)(e->dir[0] / s->half[0] / 2);
		r.dv[i] = (float)(e->dir[1] / s->half[1] / 2);
		r.dz[i] = (float)(-e->dir[2] / s->half[2] / 2);
		r.t_end[i] = (float)length;
	}
	return r;
}

/* Sphere tracing of the solid itself: where it is hit, or -1. */
static inline double
trace(const struct solid *s, const struct eye *e, int i, double hit[3])
{
	double from[3], length, t = 0;

	if (!through_box(s, e, i, from, &length))
		return -1;
	while (t <= length) {
		double d;

		for (int k = 0; k < 3; k++)
			hit[k] = from[k] + t * e->dir[k];
		d = s->distance(hit);
		if (d < 1e-6)
			return t;
		t += d / s->steepest;
	}
	return -1;
}

#endif
