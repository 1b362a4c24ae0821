/* A frame from its sums: unit length, right angles; and angles. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "mesh_frame_priv.h"

static void
cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static double
larger(double a, double b)
{
	return a > b ? a : b;
}

bool
bake_frame_normalize(double x[3])
{
	double scale, length;

	scale = frame_dot(x, x);
	if (scale > 1e-200 && scale < 1e200) {
		/* the usual case: neither under- nor overflow */
		length = sqrt(scale);
		for (int k = 0; k < 3; k++)
			x[k] /= length;
		return true;
	}
	scale = larger(fabs(x[0]), larger(fabs(x[1]), fabs(x[2])));
	if (!(scale > 0.0) || !isfinite(scale))
		return false;
	for (int k = 0; k < 3; k++)
		x[k] /= scale;
	length = sqrt(frame_dot(x, x));
	for (int k = 0; k < 3; k++)
		x[k] /= length;
	return true;
}

/* atan(t) for 0 <= t <= 1: the angle is halved twice, so
 * that t <= tan(pi/16) and 12 terms leave 0.199^24 / 25 < 1e-18 of it. Even and
 * odd powers are summed apart, which halves the wait. */
static inline double
atan_unit(double t)
{
	double x, xx, even, odd;

	t = t / (1.0 + sqrt(1.0 + t * t));
	t = t / (1.0 + sqrt(1.0 + t * t));
	x = t * t;
	xx = x * x;
	even = 1.0 / 21.0 + xx * (1.0 / 25.0);
	odd = 1.0 / 19.0 + xx * (1.0 / 23.0);
	even = 1.0 / 17.0 + xx * even;
	odd = 1.0 / 15.0 + xx * odd;
	even = 1.0 / 13.0 + xx * even;
	odd = 1.0 / 11.0 + xx * odd;
	even = 1.0 / 9.0 + xx * even;
	odd = 1.0 / 7.0 + xx * odd;
	even = 1.0 / 5.0 + xx * even;
	odd = 1.0 / 3.0 + xx * odd;
	return 4.0 * (t + t * (xx * even - x * odd));
}

/* 2 atan(y / x) for y, x >= 0, not both 0. */
static double
twice_atan(double y, double x)
{
	return y <= x ? 2.0 * atan_unit(y / x)
		      : BAKE_FRAME_PI - 2.0 * atan_unit(x / y);
}

double
bake_angle_rad(const double u[3], const double v[3])
{
	double a[3] = { u[0], u[1], u[2] }, b[3] = { v[0], v[1], v[2] };
	double d = 0.0, s = 0.0;

	if (!bake_frame_normalize(a) || !bake_frame_normalize(b))
		return 0.0;
	for (int k = 0; k < 3; k++) {
		d += (a[k] - b[k]) * (a[k] - b[k]);
		s += (a[k] + b[k]) * (a[k] + b[k]);
	}
	return twice_atan(sqrt(d), sqrt(s));
}

/* -- one frame ----------------------------------------------------------- */

static bool
make_orthogonal(double x[3], const double normal[3])
{
	double size = sqrt(frame_dot(x, x)), along = frame_dot(x, normal);

	frame_add_scaled(x, -along, normal);
	return sqrt(frame_dot(x, x)) > 1e-9 * size && bake_frame_normalize(x);
}

/* Any direction in the plane: of the axis that is farthest from the normal. */
static void
any_tangent(struct bake_frame *f)
{
	int k = 0;

	for (int i = 1; i < 3; i++)
		if (fabs(f->normal[i]) < fabs(f->normal[k]))
			k = i;
	memset(f->tangent, 0, sizeof f->tangent);
	f->tangent[k] = 1.0;
	make_orthogonal(f->tangent, f->normal);
	f->hand = 1;
	f->flags &= ~BAKE_FRAME_TANGENT_FILE;
	f->flags |= BAKE_FRAME_TANGENT_NONE;
	memcpy(f->ps, f->tangent, sizeof f->ps);
	cross(f->normal, f->tangent, f->pt);
}

void
bake_frame_finish(struct bake_frame *f, const double normal[3])
{
	double b[3], side;
	bool has_gradients = frame_dot(f->ps, f->ps) > 0.0;

	if (!(f->flags & BAKE_FRAME_NORMAL_FILE) ||
	    !bake_frame_normalize(f->normal)) {
		f->flags &= ~BAKE_FRAME_NORMAL_FILE;
		memcpy(f->normal, normal, sizeof f->normal);
	}
	if (!(frame_dot(f->normal, f->normal) > 0.0)) {
		f->flags |= BAKE_FRAME_NORMAL_NONE;
		f->normal[0] = f->normal[1] = 0.0;
		f->normal[2] = 1.0;
	}
	f->flags &= ~(FRAME_MIXED_NORMALS | FRAME_MIXED_TANGENTS);
	if (f->flags & BAKE_FRAME_TANGENT_FILE &&
	    make_orthogonal(f->tangent, f->normal)) {
		if (has_gradients)
			return;
		/* a direction, but no length */
		memcpy(f->ps, f->tangent, sizeof f->ps);
		cross(f->normal, f->tangent, f->pt);
		for (int k = 0; k < 3; k++)
			f->pt[k] *= f->hand;
		return;
	}
	f->flags &= ~BAKE_FRAME_TANGENT_FILE;
	memcpy(f->tangent, f->ps, sizeof f->tangent);
	if (!has_gradients || !make_orthogonal(f->tangent, f->normal)) {
		any_tangent(f);
		return;
	}
	cross(f->normal, f->tangent, b);
	side = frame_dot(b, f->pt);
	if (side != 0.0)
		f->hand = side < 0.0 ? -1 : 1;
}
