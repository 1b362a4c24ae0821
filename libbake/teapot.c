/* The Utah teapot as Martin Newell published it, with the bottom added. */
/* SPDX-License-Identifier: MIT */
#include "teapot_priv.h"

#include <string.h>

/*
 * The 306 published points say less than it seems: 24 patches are quarters of
 * surfaces of revolution, and each half of spout and handle mirrors the other.
 *
 * A ring of a quarter is (r, 0), (r, s), (s, r), (0, r) at a height z; it is
 * given as { r, s, z }. Rings go upwards along the profile: from the middle
 * of the bottom over body and rim into the mouth, and up the lid to its knob.
 */
enum { NRINGS = 6, NTUBES = 4 };

static const double rings[NRINGS][4][3] = {
	/* bottom */
	{ { 0, 0, 0 }, { 1.425, 0.798, 0 }, { 1.5, 0.84, 0.075 },
	    { 1.5, 0.84, 0.15 } },
	/* body */
	{ { 1.5, 0.84, 0.15 }, { 1.5, 0.84, 0.225 }, { 2, 1.12, 0.45 },
	    { 2, 1.12, 0.9 } },
	{ { 2, 1.12, 0.9 }, { 2, 1.12, 1.35 }, { 1.75, 0.98, 1.875 },
	    { 1.5, 0.84, 2.4 } },
	/* rim */
	{ { 1.5, 0.84, 2.4 }, { 1.4375, 0.805, 2.53125 },
	    { 1.3375, 0.749, 2.53125 }, { 1.4, 0.784, 2.4 } },
	/* lid */
	{ { 1.3, 0.728, 2.4 }, { 1.3, 0.728, 2.55 }, { 0.4, 0.224, 2.55 },
	    { 0.2, 0.112, 2.7 } },
	/* knob */
	{ { 0.2, 0.112, 2.7 }, { 0, 0, 2.85 }, { 0.8, 0.45, 3.15 },
	    { 0, 0, 3.15 } },
};

/*
 * A cross-section of a tube is (x0, 0, z0), (x0, -w, z0), (x1, -w, z1),
 * (x1, 0, z1) and its mirror image; it is given as { x0, z0, x1, z1, w }.
 * Sections go upwards: from the body to the tip, from the lower end of the
 * handle to the upper; 0 to 1 by -y is counterclockwise seen from the tube's
 * upper end.
 */
static const double tubes[NTUBES][4][5] = {
	/* spout: 0 is its upper side */
	{ { 1.7, 1.425, 1.7, 0.6, 0.66 }, { 2.6, 1.425, 3.1, 0.825, 0.66 },
	    { 2.3, 2.1, 2.4, 2.025, 0.25 }, { 2.7, 2.4, 3.3, 2.4, 0.25 } },
	{ { 2.7, 2.4, 3.3, 2.4, 0.25 }, { 2.8, 2.475, 3.525, 2.49375, 0.25 },
	    { 2.9, 2.475, 3.45, 2.5125, 0.15 }, { 2.8, 2.4, 3.2, 2.4, 0.15 } },
	/* handle: 0 is its outer side */
	{ { -1.9, 0.6, -2, 0.9, 0.3 }, { -2.65, 0.9375, -2.5, 1.125, 0.3 },
	    { -3, 1.35, -2.7, 1.575, 0.3 }, { -3, 1.8, -2.7, 1.8, 0.3 } },
	{ { -3, 1.8, -2.7, 1.8, 0.3 }, { -3, 2.25, -2.7, 2.025, 0.3 },
	    { -2.5, 2.25, -2.3, 2.025, 0.3 },
	    { -1.5, 2.25, -1.6, 2.025, 0.3 } },
};

static void
set_point(double point[3], double x, double y, double z)
{
	point[0] = 0.5 * x;
	point[1] = 0.5 * z - 0.7875;
	point[2] = -0.5 * y;
}

/* Ring { r, s, z } of a quarter, 0 .. 3 counterclockwise from above. */
static void
set_ring(double points[4][3], const double ring[3], int quarter)
{
	const double r = ring[0], s = ring[1];
	const double x[4] = { r, r, s, 0 }, y[4] = { 0, s, r, r };

	for (int i = 0; i < 4; i++) {
		double px = x[i], py = y[i];

		for (int q = 0; q < quarter; q++) {
			double t = px;

			px = -py;
			py = t;
		}
		set_point(points[i], px, py, ring[2]);
	}
}

/* The half of y <= 0, or the other, which goes back from 1 to 0. */
static void
set_section(double points[4][3], const double s[5], bool other)
{
	for (int i = 0; i < 4; i++) {
		int from = other ? 3 - i : i;
		bool edge = from == 0 || from == 3;
		const double *xz = from < 2 ? s : s + 2;

		set_point(points[i], xz[0],
		    edge    ? 0
		    : other ? s[4]
			    : -s[4],
		    xz[1]);
	}
}

void
bake_teapot_patch(int patch, double control[4][4][3], bool pole[2], bool *half)
{
	*half = patch >= 4 * NRINGS;
	for (int k = 0; k < 4; k++) {
		if (*half)
			set_section(control[k],
			    tubes[(patch - 4 * NRINGS) / 2][k], patch % 2);
		else
			set_ring(control[k], rings[patch / 4][k], patch % 4);
	}
	pole[0] = !*half && rings[patch / 4][0][0] == 0;
	pole[1] = !*half && rings[patch / 4][3][0] == 0;
}

/*
 * Bernstein polynomials and their derivatives at t = i / n. i and n - i change
 * places where a border is run through from its other end, so that no 1 - t
 * may occur, and sums add the outer and the inner terms by themselves.
 */
static void
bernstein(int i, int n, double b[4], double d[4])
{
	const double t = (double)i / n, s = (double)(n - i) / n;

	b[0] = s * s * s;
	b[1] = 3 * (s * s) * t;
	b[2] = 3 * (t * t) * s;
	b[3] = t * t * t;
	d[0] = -3 * (s * s);
	d[1] = 3 * (s * s) - 6 * (s * t);
	d[2] = 6 * (s * t) - 3 * (t * t);
	d[3] = 3 * (t * t);
}

static double
sum(const double b[4], const double x[4])
{
	return (b[0] * x[0] + b[3] * x[3]) + (b[1] * x[1] + b[2] * x[2]);
}

void
bake_teapot_eval(const double control[4][4][3], int i, int n, int k, int m,
    struct bake_teapot_point *point)
{
	double bu[4], du[4], bv[4], dv[4];

	bernstein(i, n, bu, du);
	bernstein(k, m, bv, dv);
	for (int c = 0; c < 3; c++) {
		double on[4], along[4];

		for (int row = 0; row < 4; row++) {
			double x[4];

			for (int col = 0; col < 4; col++)
				x[col] = control[row][col][c];
			on[row] = sum(bu, x);
			along[row] = sum(du, x);
		}
		point->p[c] = sum(bv, on);
		point->u[c] = sum(bv, along);
		point->v[c] = sum(dv, on);
		point->uv[c] = sum(dv, along);
	}
}
