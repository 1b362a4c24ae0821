/* Analytic surfaces as meshes with exact frames, for the quadric tests. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_QUADRIC_H
#define TEST_QUADRIC_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mesh.h"
#include "mesh_frame.h"
#include "quadric.h"

static const double test_pi = 3.14159265358979323846;

/*
 * A surface F = 0 with its parametrisation over 0 .. 1 squared. With
 * N = grad F / |grad F|, which points outwards, and H the Hessian, the normal
 * curvature in a tangent direction t is t H t / |grad F|, positive where it is
 * convex: half of it is what a quadric's a is.
 */
struct test_surface {
	const char *name;
	void (*point)(double p[3], double u, double v);
	void (*gradient)(double g[3], double h[3][3], const double p[3]);
};

/* x^2 w0 + y^2 w1 + z^2 w2 = 1: sphere, cylinder and ellipsoid */
static inline void
test_quadratic_form(
    double g[3], double h[3][3], const double p[3], const double w[3])
{
	memset(h, 0, 9 * sizeof(double));
	for (int c = 0; c < 3; c++) {
		g[c] = 2 * w[c] * p[c];
		h[c][c] = 2 * w[c];
	}
}

/* longitude and latitude, in radians */
static inline void
test_sphere_point(double p[3], double u, double v)
{
	p[0] = cos(v) * cos(u);
	p[1] = cos(v) * sin(u);
	p[2] = sin(v);
}

static inline void
test_sphere_gradient(double g[3], double h[3][3], const double p[3])
{
	static const double w[3] = { 1, 1, 1 };

	test_quadratic_form(g, h, p, w);
}

static inline void
test_cylinder_point(double p[3], double u, double v)
{
	p[0] = sin(u);
	p[1] = v;
	p[2] = cos(u);
}

static inline void
test_cylinder_gradient(double g[3], double h[3][3], const double p[3])
{
	static const double w[3] = { 1, 0, 1 };

	test_quadratic_form(g, h, p, w);
}

enum { TEST_TORUS_PERMILLE = 350 };

static inline void
test_torus_point(double p[3], double u, double v)
{
	const double r = TEST_TORUS_PERMILLE / 1000.0;

	p[0] = (1 + r * cos(v)) * cos(u);
	p[1] = (1 + r * cos(v)) * sin(u);
	p[2] = r * sin(v);
}

static inline void
test_torus_gradient(double g[3], double h[3][3], const double p[3])
{
	double rho = sqrt(p[0] * p[0] + p[1] * p[1]), k = (rho - 1) / rho;

	memset(h, 0, 9 * sizeof(double));
	for (int i = 0; i < 2; i++) {
		g[i] = 2 * k * p[i];
		for (int j = 0; j < 2; j++)
			h[i][j] = 2 * (p[i] * p[j] / (rho * rho) * (1 - k) +
					  (i == j ? k : 0));
	}
	g[2] = 2 * p[2];
	h[2][2] = 2;
}

static inline void
test_saddle_point(double p[3], double u, double v)
{
	p[0] = u;
	p[1] = v;
	p[2] = (u * u - v * v) / 2;
}

static inline void
test_saddle_gradient(double g[3], double h[3][3], const double p[3])
{
	memset(h, 0, 9 * sizeof(double));
	g[0] = -p[0];
	g[1] = p[1];
	g[2] = 1;
	h[0][0] = -1;
	h[1][1] = 1;
}

static const double test_axes[3] = { 1, 0.8, 0.6 };

static inline void
test_ellipsoid_point(double p[3], double u, double v)
{
	p[0] = test_axes[0] * cos(v) * cos(u);
	p[1] = test_axes[1] * cos(v) * sin(u);
	p[2] = test_axes[2] * sin(v);
}

static inline void
test_ellipsoid_gradient(double g[3], double h[3][3], const double p[3])
{
	double w[3];

	for (int c = 0; c < 3; c++)
		w[c] = 1 / (test_axes[c] * test_axes[c]);
	test_quadratic_form(g, h, p, w);
}

static const struct test_surface test_surfaces[] = {
	{ "sphere", test_sphere_point, test_sphere_gradient },
	{ "cylinder", test_cylinder_point, test_cylinder_gradient },
	{ "torus", test_torus_point, test_torus_gradient },
	{ "saddle", test_saddle_point, test_saddle_gradient },
	{ "ellipsoid", test_ellipsoid_point, test_ellipsoid_gradient },
};

static inline double
test_random(unsigned *state)
{
	unsigned z = *state += 0x9e3779b9u;

	z = (z ^ z >> 16) * 0x85ebca6bu;
	z = (z ^ z >> 13) * 0xc2b2ae35u;
	return (double)((z ^ z >> 16) >> 8) / 16777216.0;
}

static inline void
test_cross(double out[3], const double a[3], const double b[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double
test_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void
test_normalize(double a[3])
{
	double length = sqrt(test_dot(a, a));

	for (int c = 0; c < 3; c++)
		a[c] /= length;
}

/* The exact quadric at p in the frame (T, hand * N x T). */
static inline void
test_exact(const struct test_surface *s, const double p[3],
    const struct bake_frame *f, double abc[3])
{
	double g[3], h[3][3], b[3], ht[3], hb[3], length;

	s->gradient(g, h, p);
	length = sqrt(test_dot(g, g));
	test_cross(b, f->normal, f->tangent);
	for (int c = 0; c < 3; c++)
		b[c] *= f->hand;
	for (int c = 0; c < 3; c++) {
		ht[c] = test_dot(h[c], f->tangent);
		hb[c] = test_dot(h[c], b);
	}
	abc[0] = 0.5 * test_dot(f->tangent, ht) / length;
	abc[1] = 0.5 * test_dot(b, hb) / length;
	abc[2] = test_dot(f->tangent, hb) / length;
}

/* A frame with the exact normal at p, its tangent turned by angle from the
 * projection of the x axis. */
static inline void
test_frame(struct bake_frame *f, const struct test_surface *s,
    const double p[3], double angle)
{
	static const double x[3] = { 1, 0, 0 }, y[3] = { 0, 1, 0 };
	double h[3][3], t[3], b[3], along;
	const double *axis = x;

	memset(f, 0, sizeof *f);
	s->gradient(f->normal, h, p);
	test_normalize(f->normal);
	if (fabs(f->normal[0]) > 0.8)
		axis = y;
	along = test_dot(axis, f->normal);
	for (int c = 0; c < 3; c++)
		t[c] = axis[c] - along * f->normal[c];
	test_normalize(t);
	test_cross(b, f->normal, t);
	for (int c = 0; c < 3; c++)
		f->tangent[c] = cos(angle) * t[c] + sin(angle) * b[c];
	f->hand = 1;
	test_cross(b, f->normal, f->tangent);
	for (int c = 0; c < 3; c++) {
		f->ps[c] = f->tangent[c];
		f->pt[c] = b[c];
	}
}

static inline void *
test_calloc(size_t n, size_t size)
{
	void *p = calloc(n > 0 ? n : 1, size);

	if (p == NULL) {
		fprintf(stderr, "no memory\n");
		exit(1);
	}
	return p;
}

/* Triangles of a grid of n x n cells, (n + 1)^2 vertices row by row. */
static inline void
test_grid(struct bake_mesh *m, int n)
{
	size_t side = (size_t)n + 1;

	memset(m, 0, sizeof *m);
	m->npositions = side * side;
	m->ntriangles = 2 * (size_t)n * (size_t)n;
	m->positions = test_calloc(m->npositions, sizeof *m->positions);
	m->triangles = test_calloc(m->ntriangles, sizeof *m->triangles);
	for (size_t t = 0; t < m->ntriangles; t++) {
		size_t cell = t / 2, row = cell / (size_t)n;
		size_t at = row * side + cell % (size_t)n;
		size_t v[2][3] = { { at, at + 1, at + side + 1 },
			{ at, at + side + 1, at + side } };

		for (int k = 0; k < 3; k++) {
			m->triangles[t][k].v = (int)v[t % 2][k];
			m->triangles[t][k].vt = -1;
			m->triangles[t][k].vn = -1;
		}
	}
}

static inline void
test_mesh_free(struct bake_mesh *m)
{
	free(m->positions);
	free(m->triangles);
	memset(m, 0, sizeof *m);
}

/* The surface over a grid of n x n cells, inner vertices moved by up to jitter
 * cells. */
static inline void
test_patch(
    struct bake_mesh *m, const struct test_surface *s, int n, double jitter)
{
	unsigned seed = 7;

	test_grid(m, n);
	for (int i = 0; i <= n; i++)
		for (int k = 0; k <= n; k++) {
			bool inner = i > 0 && i < n && k > 0 && k < n;
			double du = jitter * (2 * test_random(&seed) - 1);
			double dv = jitter * (2 * test_random(&seed) - 1);

			s->point(m->positions[i * (n + 1) + k],
			    (k + inner * du) / n, (i + inner * dv) / n);
		}
}

/* Exact frames, one for each position. */
static inline void
test_frames(struct bake_frames *f, const struct bake_mesh *m,
    const struct test_surface *s, double angle)
{
	memset(f, 0, sizeof *f);
	f->nframes = m->npositions;
	f->frame = test_calloc(f->nframes, sizeof *f->frame);
	for (size_t v = 0; v < m->npositions; v++) {
		test_frame(&f->frame[v], s, m->positions[v], angle);
		f->frame[v].v = (int)v;
		f->frame[v].vt = (int)v;
	}
}

#endif
