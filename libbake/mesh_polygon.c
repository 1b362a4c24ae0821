/* Polygons cut into triangles: fans where convex, else ear by ear. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>

#include "mem.h"
#include "mesh.h"

/* Three points whose turn, relative to the lengths, is below this count as on
 * a line. */
#define STRAIGHT 1e-12

/* A polygon in its plane, counterclockwise. */
struct plane_polygon {
	int n;
	const double (*p)[2];
	int *next, *prev;
	int *reflex; /* those that are reflex, nreflex of them, ... */
	int *where;  /* ... and where each is in that list, or -1 */
	int nreflex;
	size_t ntests, max_tests;
};

/* Newell's normal: its direction is that of the polygon's vector area. */
static void
newell(const double (*points)[3], int n, double normal[3])
{
	normal[0] = normal[1] = normal[2] = 0.0;
	for (int i = 0; i < n; i++) {
		const double *a = points[i], *b = points[i + 1 < n ? i + 1 : 0];

		for (int k = 0; k < 3; k++) {
			int k1 = (k + 1) % 3, k2 = (k + 2) % 3;

			/* relative to corner 0, so that a place far from the
			 * origin costs no digits */
			normal[k] +=
			    ((a[k1] - points[0][k1]) -
				(b[k1] - points[0][k1])) *
			    ((a[k2] - points[0][k2]) + (b[k2] - points[0][k2]));
		}
	}
}

/* Drop the axis along which the normal is longest: no rounding. */
static void
project(const double (*points)[3], int n, double (*p)[2])
{
	double normal[3];
	int k = 0, kx, ky;

	newell(points, n, normal);
	for (int i = 1; i < 3; i++)
		if (fabs(normal[i]) > fabs(normal[k]))
			k = i;
	kx = (k + 1) % 3;
	ky = (k + 2) % 3;
	if (normal[k] < 0.0) {
		int swap = kx;

		kx = ky;
		ky = swap;
	}
	for (int i = 0; i < n; i++) {
		p[i][0] = points[i][kx] - points[0][kx];
		p[i][1] = points[i][ky] - points[0][ky];
	}
}

/* Twice the area of a b c: positive where they turn left. */
static double
turn(const double a[2], const double b[2], const double c[2])
{
	return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
}

/* -1, 0, 1: right, straight on, left at b. */
static int
turn_sign(const double a[2], const double b[2], const double c[2])
{
	double t = turn(a, b, c);
	double e0 = b[0] - a[0], e1 = b[1] - a[1];
	double f0 = c[0] - b[0], f1 = c[1] - b[1];
	double ef = sqrt(e0 * e0 + e1 * e1) * sqrt(f0 * f0 + f1 * f1);

	return fabs(t) <= STRAIGHT * ef ? 0 : t > 0.0 ? 1 : -1;
}

/* Left turns only, and once round: a star turns left, too, but has more than
 * two places where x changes its direction. */
static bool
is_convex(const double (*p)[2], int n)
{
	int nchanges = 0, direction = 0, first = 0;

	for (int i = 0; i < n; i++) {
		const double *a = p[i], *b = p[(i + 1) % n],
			     *c = p[(i + 2) % n];
		int d = b[0] > a[0] ? 1 : b[0] < a[0] ? -1 : 0;

		if (turn_sign(a, b, c) <= 0)
			return false;
		if (d == 0)
			continue;
		if (first == 0)
			first = d;
		nchanges += direction != 0 && d != direction;
		direction = d;
	}
	nchanges += direction != first;
	return nchanges <= 2;
}

static void
fan(int n, int from, int (*triangles)[3])
{
	for (int i = 0; i < n - 2; i++) {
		triangles[i][0] = from;
		triangles[i][1] = (from + i + 1) % n;
		triangles[i][2] = (from + i + 2) % n;
	}
}

static bool
same_point(const double a[2], const double b[2])
{
	return a[0] == b[0] && a[1] == b[1];
}

/* Whether q is in the closed triangle a b c, and none of its corners. */
static bool
blocks(
    const double q[2], const double a[2], const double b[2], const double c[2])
{
	return turn(a, b, q) >= 0.0 && turn(b, c, q) >= 0.0 &&
	       turn(c, a, q) >= 0.0 && !same_point(q, a) && !same_point(q, b) &&
	       !same_point(q, c);
}

static int
sign_at(const struct plane_polygon *g, int i)
{
	return turn_sign(g->p[g->prev[i]], g->p[i], g->p[g->next[i]]);
}

/* Whether corner i can be cut off; flat: corners on a line may, too. */
static bool
is_ear(struct plane_polygon *g, int i, bool flat)
{
	int a = g->prev[i], c = g->next[i];
	int sign = sign_at(g, i);

	g->ntests++;
	if (sign < 0 || (sign == 0 && !flat))
		return false;
	if (sign == 0)
		return true;
	for (int k = 0; k < g->nreflex; k++) {
		int r = g->reflex[k];

		g->ntests++;
		if (r != a && r != i && r != c &&
		    blocks(g->p[r], g->p[a], g->p[i], g->p[c]))
			return false;
	}
	return true;
}

static void
set_reflex(struct plane_polygon *g, int i, bool reflex)
{
	if (reflex && g->where[i] < 0) {
		g->where[i] = g->nreflex;
		g->reflex[g->nreflex++] = i;
	} else if (!reflex && g->where[i] >= 0) {
		int last = g->reflex[--g->nreflex];

		g->reflex[g->where[i]] = last;
		g->where[last] = g->where[i];
		g->where[i] = -1;
	}
}

static void
cut(struct plane_polygon *g, int i, int triangle[3])
{
	int a = g->prev[i], c = g->next[i];

	triangle[0] = a;
	triangle[1] = i;
	triangle[2] = c;
	g->next[a] = c;
	g->prev[c] = a;
	set_reflex(g, i, false);
	/* a corner that is straight can still be in the way of an ear */
	set_reflex(g, a, sign_at(g, a) <= 0);
	set_reflex(g, c, sign_at(g, c) <= 0);
}

/* Returns whether all of it went by the rules. */
static bool
cut_ears(struct plane_polygon *g, int (*triangles)[3])
{
	int left = g->n, i = 0, lap = 0;
	bool clean = true, flat = false;

	for (i = 0; i < g->n; i++)
		set_reflex(g, i, sign_at(g, i) <= 0);
	i = 0;
	while (left > 3) {
		bool hopeless =
		    (flat && lap > left) || g->ntests > g->max_tests;

		if (!hopeless && !is_ear(g, i, flat)) {
			i = g->next[i];
			if (++lap > left && !flat) {
				flat = true;
				lap = 0;
			}
			continue;
		}
		clean = clean && !hopeless;
		cut(g, i, triangles[g->n - left]);
		/* a new ear can only be beside the old one */
		i = g->prev[i];
		left--;
		lap = 0;
		flat = false;
	}
	triangles[g->n - 3][0] = g->prev[i];
	triangles[g->n - 3][1] = i;
	triangles[g->n - 3][2] = g->next[i];
	return clean && sign_at(g, i) >= 0;
}

static enum bake_status
cut_polygon(const double (*p)[2], int n, int (*triangles)[3], bool *rough,
    struct bake_err *err)
{
	struct plane_polygon g = { .n = n, .p = p };
	int *links = bake_alloc((size_t)n, 4 * sizeof *links, err);

	if (links == NULL)
		return BAKE_ENOMEM;
	g.next = links;
	g.prev = links + n;
	g.reflex = links + 2 * (size_t)n;
	g.where = links + 3 * (size_t)n;
	for (int i = 0; i < n; i++) {
		g.next[i] = i + 1 < n ? i + 1 : 0;
		g.prev[i] = i > 0 ? i - 1 : n - 1;
		g.where[i] = -1;
	}
	g.max_tests = (size_t)n * 1024;
	if (g.max_tests < (size_t)1 << 20)
		g.max_tests = (size_t)1 << 20;
	if (g.max_tests > (size_t)1 << 28)
		g.max_tests = (size_t)1 << 28;
	*rough = !cut_ears(&g, triangles);
	free(links);
	return BAKE_OK;
}

/* The corner to cut a quadrangle at: its reflex one, else a straight one; -1
 * where two are reflex, so that it crosses itself. */
static int
quad_corner(const double (*p)[2])
{
	int nreflex = 0, reflex = 0, straight = 0;

	for (int i = 0; i < 4; i++) {
		int sign = turn_sign(p[i], p[(i + 1) % 4], p[(i + 2) % 4]);

		if (sign < 0) {
			reflex = (i + 1) % 4;
			nreflex++;
		} else if (sign == 0) {
			straight = (i + 1) % 4;
		}
	}
	return nreflex > 1 ? -1 : nreflex == 1 ? reflex : straight;
}

enum bake_status
bake_polygon_triangulate(const double (*points)[3], int n, int (*triangles)[3],
    bool *rough, struct bake_err *err)
{
	enum { FEW = 64 };
	double few[FEW][2];
	double(*p)[2] = few;
	enum bake_status rc = BAKE_OK;
	int corner;

	*rough = false;
	if (n == 3) {
		fan(n, 0, triangles);
		return BAKE_OK;
	}
	if (n > FEW && (p = bake_alloc((size_t)n, sizeof *p, err)) == NULL)
		return BAKE_ENOMEM;
	project(points, n, p);
	if (is_convex((const double(*)[2])p, n)) {
		fan(n, 0, triangles);
	} else if (n == 4 &&
		   (corner = quad_corner((const double(*)[2])p)) >= 0) {
		fan(n, corner, triangles);
	} else {
		rc = cut_polygon(
		    (const double(*)[2])p, n, triangles, rough, err);
	}
	if (p != few)
		free(p);
	return rc;
}
