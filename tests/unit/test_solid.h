/* Closed meshes of known shape, for the unit tests and benches. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_SOLID_H
#define TEST_SOLID_H

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "mesh.h"

#define SOLID_TURN 6.283185307179586

/* Positions and triangles only; aborts without memory. */
static inline struct bake_mesh
solid_alloc(size_t npositions, size_t ntriangles)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_mesh_alloc(&m, npositions, 0, 0, ntriangles, &err) != BAKE_OK)
		abort();
	return m;
}

static inline void
solid_triangle(struct bake_mesh *m, size_t t, size_t a, size_t b, size_t c)
{
	const size_t v[3] = { a, b, c };

	for (int k = 0; k < 3; k++)
		m->triangles[t][k] = (struct bake_corner){ (int)v[k], -1, -1 };
}

/* The box from lo to hi: corner i is hi where bit x, y, z of i is set. */
static inline struct bake_mesh
solid_box(const double lo[3], const double hi[3])
{
	static const int quad[6][4] = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 },
		{ 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 2, 3, 1 },
		{ 4, 5, 7, 6 } };
	struct bake_mesh m = solid_alloc(8, 12);

	for (int i = 0; i < 8; i++)
		for (int k = 0; k < 3; k++)
			m.positions[i][k] = i >> k & 1 ? hi[k] : lo[k];
	for (size_t f = 0; f < 6; f++) {
		size_t q[4];

		for (int k = 0; k < 4; k++)
			q[k] = (size_t)quad[f][k];
		solid_triangle(&m, 2 * f, q[0], q[1], q[2]);
		solid_triangle(&m, 2 * f + 1, q[0], q[2], q[3]);
	}
	return m;
}

/* Rings of 'sides' points: ring i and i + 1 are joined, with the outside on the
 * right of growing i where side numbers grow counterclockwise about it. The
 * last is joined to the first where closed. Returns the next triangle. */
static inline size_t
solid_join(struct bake_mesh *m, size_t t, size_t first, size_t rings,
    size_t sides, bool closed)
{
	for (size_t i = 0; i + !closed < rings; i++)
		for (size_t k = 0; k < sides; k++) {
			size_t i1 = (i + 1) % rings, k1 = (k + 1) % sides;
			size_t a = first + i * sides + k;
			size_t b = first + i1 * sides + k;
			size_t c = first + i1 * sides + k1;
			size_t d = first + i * sides + k1;

			solid_triangle(m, t++, a, c, b);
			solid_triangle(m, t++, a, d, c);
		}
	return t;
}

/* A sphere about c; its poles are on the axis of z. */
static inline struct bake_mesh
solid_sphere(const double c[3], double r, size_t around, size_t down)
{
	size_t rings = down - 1, n = rings * around, t;
	struct bake_mesh m = solid_alloc(n + 2, 2 * around * rings);

	for (size_t i = 0; i < rings; i++)
		for (size_t k = 0; k < around; k++) {
			double *p = m.positions[i * around + k];
			double a = SOLID_TURN * (double)k / (double)around;
			double b =
			    SOLID_TURN / 2 * (double)(i + 1) / (double)down;

			p[0] = c[0] + r * sin(b) * cos(a);
			p[1] = c[1] + r * sin(b) * sin(a);
			/* upwards, so that sides go counterclockwise */
			p[2] = c[2] - r * cos(b);
		}
	for (int k = 0; k < 3; k++) {
		m.positions[n][k] = c[k] - (k == 2 ? r : 0);
		m.positions[n + 1][k] = c[k] + (k == 2 ? r : 0);
	}
	t = solid_join(&m, 0, 0, rings, around, false);
	for (size_t k = 0; k < around; k++) {
		size_t k1 = (k + 1) % around, last = n - around;

		solid_triangle(&m, t++, n, k1, k);
		solid_triangle(&m, t++, n + 1, last + k, last + k1);
	}
	return m;
}

/* A tube of radius r round the circle of radius big in z = 0. */
static inline struct bake_mesh
solid_torus(double big, double r, size_t around, size_t sides)
{
	struct bake_mesh m = solid_alloc(around * sides, 2 * around * sides);

	for (size_t i = 0; i < around; i++)
		for (size_t k = 0; k < sides; k++) {
			double *p = m.positions[i * sides + k];
			double a = SOLID_TURN * (double)i / (double)around;
			double b = SOLID_TURN * (double)k / (double)sides;

			/* outwards and down is counterclockwise about a */
			p[0] = (big + r * cos(b)) * cos(a);
			p[1] = (big + r * cos(b)) * sin(a);
			p[2] = r * sin(b);
		}
	solid_join(&m, 0, 0, around, sides, true);
	for (size_t t = 0; t < m.ntriangles; t++) {
		struct bake_corner c = m.triangles[t][1];

		m.triangles[t][1] = m.triangles[t][2];
		m.triangles[t][2] = c;
	}
	return m;
}

/*
 * A plain weave on 0 <= x, y <= strands, which must be even: strands along x at
 * y = j + 1/2 and along y at x = j + 1/2, with z = +-amplitude cos(pi x), of
 * radius r: open tubes that close when the square is a tile, rings of the two
 * ends being equal but for the period.
 */
static inline struct bake_mesh
solid_weave(
    size_t strands, size_t rings, size_t sides, double r, double amplitude)
{
	const double length = (double)strands;
	size_t n = rings * sides, t = 0;
	struct bake_mesh m =
	    solid_alloc(2 * strands * n, 4 * strands * (rings - 1) * sides);

	for (size_t s = 0; s < 2 * strands; s++) {
		bool along_x = s % 2 == 0;
		double side = (double)(s / 2) + 0.5;
		double sign = (s / 2 + s) % 2 == 0 ? 1 : -1;

		for (size_t i = 0; i < n; i++) {
			double *p = m.positions[s * n + i];
			size_t ring = i / sides;
			double at = length * (double)ring / (double)(rings - 1);
			double b =
			    SOLID_TURN * (double)(i % sides) / (double)sides;
			/* the last ring just as the first */
			double phase = ring + 1 == rings ? 0 : at;
			double z = sign * amplitude *
				   cos(SOLID_TURN / 2 * (phase - 0.5));

			/* counterclockwise about +x, clockwise about +y */
			p[!along_x] = at;
			p[along_x] = side + r * cos(b);
			p[2] = z + r * sin(b);
		}
		size_t begin = t;

		t = solid_join(&m, t, s * n, rings, sides, false);
		for (; !along_x && begin < t; begin++) {
			struct bake_corner c = m.triangles[begin][1];

			m.triangles[begin][1] = m.triangles[begin][2];
			m.triangles[begin][2] = c;
		}
	}
	return m;
}

/* Adds b's positions and triangles to a's; b is freed. */
static inline void
solid_add(struct bake_mesh *a, struct bake_mesh *b)
{
	struct bake_mesh m = solid_alloc(
	    a->npositions + b->npositions, a->ntriangles + b->ntriangles);

	memcpy(m.positions, a->positions, a->npositions * sizeof *m.positions);
	memcpy(m.positions + a->npositions, b->positions,
	    b->npositions * sizeof *m.positions);
	memcpy(m.triangles, a->triangles, a->ntriangles * sizeof *m.triangles);
	for (size_t t = 0; t < b->ntriangles; t++)
		for (int k = 0; k < 3; k++) {
			struct bake_corner c = b->triangles[t][k];

			c.v += (int)a->npositions;
			m.triangles[a->ntriangles + t][k] = c;
		}
	bake_mesh_free(a);
	bake_mesh_free(b);
	*a = m;
}

/* p becomes matrix p + shift */
static inline void
solid_map(struct bake_mesh *m, const double matrix[3][3], const double shift[3])
{
	for (size_t v = 0; v < m->npositions; v++) {
		double *p = m->positions[v], q[3];

		for (int k = 0; k < 3; k++)
			q[k] = matrix[k][0] * p[0] + matrix[k][1] * p[1] +
			       matrix[k][2] * p[2] + shift[k];
		memcpy(p, q, sizeof q);
	}
}

/* Turn every n-th triangle's winding round. */
static inline void
solid_turn(struct bake_mesh *m, size_t n)
{
	for (size_t t = 0; t < m->ntriangles; t += n) {
		struct bake_corner c = m->triangles[t][1];

		m->triangles[t][1] = m->triangles[t][2];
		m->triangles[t][2] = c;
	}
}

/* Six times the volume. */
static inline double
solid_volume6(const struct bake_mesh *m)
{
	double sum = 0;

	for (size_t t = 0; t < m->ntriangles; t++) {
		const double *a = m->positions[m->triangles[t][0].v];
		const double *b = m->positions[m->triangles[t][1].v];
		const double *c = m->positions[m->triangles[t][2].v];

		sum += a[0] * (b[1] * c[2] - b[2] * c[1]) +
		       a[1] * (b[2] * c[0] - b[0] * c[2]) +
		       a[2] * (b[0] * c[1] - b[1] * c[0]);
	}
	return sum;
}

#endif
