/* Triangles cut at the near plane and far outside the picture. */
/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "raster_priv.h"

enum { NPLANES = 5, MAX_CORNERS = 3 + NPLANES };

/* f(q) = n . q + d >= 0 is kept. */
struct plane {
	double n[3], d;
};

static void
set_planes(const struct bake_raster *r, struct plane planes[NPLANES])
{
	const double left = r->cx + RASTER_GUARD, top = r->cy + RASTER_GUARD;
	const double right = r->width - r->cx + RASTER_GUARD,
		     bottom = r->height - r->cy + RASTER_GUARD;
	const double depth = r->basis.orthographic ? 0 : 1, fix = 1 - depth;
	const double s = r->scale;

	planes[0] = (struct plane){ { 0, 0, 1 }, -r->basis.near };
	planes[1] = (struct plane){ { s, 0, left * depth }, left * fix };
	planes[2] = (struct plane){ { -s, 0, right * depth }, right * fix };
	planes[3] = (struct plane){ { 0, -s, top * depth }, top * fix };
	planes[4] = (struct plane){ { 0, s, bottom * depth }, bottom * fix };
}

static double
side(const struct plane *p, const double q[3])
{
	return p->n[0] * q[0] + p->n[1] * q[1] + p->n[2] * q[2] + p->d;
}

static bool
comes_before(const double a[3], const double b[3])
{
	for (int i = 0; i < 3; i++)
		if (a[i] != b[i])
			return a[i] < b[i];
	return false;
}

/* Where an edge meets a plane: the same bits from either of its ends, so that
 * the two triangles that share it are cut at one point. */
static void
cut(const struct plane *p, const double a[3], const double b[3], double q[3])
{
	double fa, fb, t;

	if (comes_before(b, a)) {
		const double *c = a;

		a = b;
		b = c;
	}
	fa = side(p, a);
	fb = side(p, b);
	t = fa / (fa - fb);
	for (int i = 0; i < 3; i++)
		q[i] = a[i] + t * (b[i] - a[i]);
}

/* Sutherland and Hodgman 1974. Returns the number of corners left. */
static int
clip(const struct plane *p, int n, double from[MAX_CORNERS][3],
    double to[MAX_CORNERS][3])
{
	int m = 0;

	for (int i = 0; i < n; i++) {
		const double *a = from[i], *b = from[(i + 1) % n];
		bool in = side(p, a) >= 0;

		if (in)
			memcpy(to[m++], a, sizeof *to);
		if (in != (side(p, b) >= 0))
			cut(p, a, b, to[m++]);
	}
	return m;
}

int
bake_raster_clip(const struct bake_raster *raster, double q[3][3],
    double pieces[RASTER_MAX_PIECES][3][3])
{
	struct plane planes[NPLANES];
	double polygon[2][MAX_CORNERS][3];
	int n = 3, now = 0;

	set_planes(raster, planes);
	memcpy(polygon[0], q, 3 * sizeof *q);
	for (int i = 0; i < NPLANES && n > 0; i++, now ^= 1) {
		n = clip(&planes[i], n, polygon[now], polygon[!now]);
		/* the plane itself, not what rounding made of it */
		for (int k = 0; i == 0 && k < n; k++)
			if (polygon[!now][k][2] < raster->basis.near)
				polygon[!now][k][2] = raster->basis.near;
	}
	for (int i = 0; i + 2 < n; i++) {
		memcpy(pieces[i][0], polygon[now][0], sizeof pieces[i][0]);
		memcpy(
		    pieces[i][1], polygon[now][i + 1], 2 * sizeof pieces[i][1]);
	}
	return n < 3 ? 0 : n - 2;
}
