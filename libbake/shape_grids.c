/* The built-in shapes as surfaces of two parameters. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "shape_priv.h"
#include "teapot_priv.h"

#define QUARTER 1.57079632679489661923

static const double torus_radius = 1, tube_radius = 0.4;

/*
 * Cosine and sine of k / (4 n) of a turn, k >= 0: k and k + 4 n give the same
 * bits, quarters of a turn exactly 0 and +-1, so that seams close.
 */
static void
turn(int k, int n, double *c, double *s)
{
	double a = QUARTER * (k % n) / n, x = cos(a), y = sin(a);

	switch (k / n % 4) {
	case 0:
		*c = x;
		*s = y;
		break;
	case 1:
		*c = -y;
		*s = x;
		break;
	case 2:
		*c = -x;
		*s = -y;
		break;
	default:
		*c = y;
		*s = -x;
		break;
	}
}

/* k / n of the way from -1 to 1, the same from either end */
static double
both(int k, int n)
{
	return (double)(2 * k - n) / n;
}

static void
set(double v[3], double x, double y, double z)
{
	v[0] = x;
	v[1] = y;
	v[2] = z;
}

static void
set_uv(const struct bake_shape_grid *g, int half, int k,
    struct bake_shape_point *at)
{
	at->uv[0] = (double)half / (2 * g->nu);
	at->uv[1] = (double)k / g->nv;
}

/* The plane is the cube's upper side, in the middle. */
static void
plane_point(const struct bake_shape_grid *g, int half, int k,
    struct bake_shape_point *at)
{
	set(at->p, both(half, 2 * g->nu), 0, -both(k, g->nv));
	set(at->du, 2, 0, 0);
	set(at->dv, 0, 0, -2);
	set_uv(g, half, k, at);
}

static void
cube_point(const struct bake_shape_grid *g, int half, int k,
    struct bake_shape_point *at)
{
	/* u and v of each face; u x v is the side that it is on */
	static const double axes[6][2][3] = {
		{ { 0, 0, -1 }, { 0, 1, 0 } },
		{ { 0, 0, 1 }, { 0, 1, 0 } },
		{ { 1, 0, 0 }, { 0, 0, -1 } },
		{ { 1, 0, 0 }, { 0, 0, 1 } },
		{ { 1, 0, 0 }, { 0, 1, 0 } },
		{ { -1, 0, 0 }, { 0, 1, 0 } },
	};
	const double u = both(half, 2 * g->nu), v = both(k, g->nv);
	const double side = g->which % 2 == 0 ? 1 : -1;

	for (int c = 0; c < 3; c++) {
		at->du[c] = 2 * axes[g->which][0][c];
		at->dv[c] = 2 * axes[g->which][1][c];
		at->p[c] = 0.5 * (u * at->du[c] + v * at->dv[c]) +
			   (c == g->which / 2 ? side : 0);
	}
	set_uv(g, half, k, at);
}

/* u goes from -z by -x, so that u = 1/2 is in front. */
static void
sphere_point(const struct bake_shape_grid *g, int half, int k,
    struct bake_shape_point *at)
{
	double c, s, y, r;

	turn(half, g->nu / 2, &c, &s);
	turn(k, g->nv / 2, &y, &r);
	set(at->p, -r * s, -y, -r * c);
	set(at->du, -c, 0, s);
	set(at->dv, -y * s, r, -y * c);
	set_uv(g, half, k, at);
}

static void
side_point(const struct bake_shape_grid *g, int half, int k,
    struct bake_shape_point *at)
{
	double c, s;

	turn(half, g->nu / 2, &c, &s);
	set(at->p, -s, both(k, g->nv), -c);
	set(at->du, -c, 0, s);
	set(at->dv, 0, 1, 0);
	set_uv(g, half, k, at);
}

/* Upper cap: v inwards; lower: outwards. The picture lies flat on them. */
static void
cap_point(const struct bake_shape_grid *g, int half, int k,
    struct bake_shape_point *at)
{
	const double up = g->which;
	double r = (double)(up > 0 ? g->nv - k : k) / g->nv, c, s;

	turn(half, g->nu / 2, &c, &s);
	set(at->p, -r * s, up, -r * c);
	set(at->du, 2, 0, 0);
	set(at->dv, 0, 0, -2 * up);
	at->uv[0] = 0.5 * (1 + at->p[0]);
	at->uv[1] = 0.5 * (1 - up * at->p[2]);
}

/* v goes round the tube from its inner side, v = 1/2 is the outer. */
static void
torus_point(const struct bake_shape_grid *g, int half, int k,
    struct bake_shape_point *at)
{
	double c, s, tc, ts, r;

	turn(half, g->nu / 2, &c, &s);
	turn(k, g->nv / 4, &tc, &ts);
	r = torus_radius - tube_radius * tc;
	set(at->p, -r * s, -tube_radius * ts, -r * c);
	set(at->du, -c, 0, s);
	set(at->dv, -ts * s, -tc, -ts * c);
	set_uv(g, half, k, at);
}

static void
teapot_point(const struct bake_shape_grid *g, int half, int k,
    struct bake_shape_point *at)
{
	const double(*control)[4][3] = g->control;
	struct bake_teapot_point point;

	bake_teapot_eval(control, half, 2 * g->nu, k, g->nv, &point);
	memcpy(at->p, point.p, sizeof at->p);
	memcpy(at->du, point.u, sizeof at->du);
	memcpy(at->dv, point.v, sizeof at->dv);
	/* du is 0 at a pole; near it, v -+ times its derivative by v */
	for (int c = 0; c < 3; c++) {
		if (k == 0 && g->pole[0])
			at->du[c] = point.uv[c];
		if (k == g->nv && g->pole[1])
			at->du[c] = -point.uv[c];
	}
	set_uv(g, half, k, at);
}

static int
teapot_grids(int detail, struct bake_shape_grid *grids)
{
	for (int i = 0; i < BAKE_TEAPOT_NPATCHES; i++) {
		struct bake_shape_grid *g = &grids[i];
		bool half;

		bake_teapot_patch(i, g->control, g->pole, &half);
		g->nu = half ? 2 * detail : detail;
		g->nv = detail;
		g->point = teapot_point;
	}
	return BAKE_TEAPOT_NPATCHES;
}

static int
cylinder_grids(int detail, struct bake_shape_grid *grids)
{
	for (int i = 0; i < 3; i++) {
		grids[i].nu = 4 * detail;
		grids[i].nv = detail;
		grids[i].point = i == 0 ? side_point : cap_point;
	}
	grids[1].which = 1;
	grids[1].pole[1] = true;
	grids[2].which = -1;
	grids[2].pole[0] = true;
	return 3;
}

static int
one_grid(struct bake_shape_grid *grid, int nu, int nv,
    void (*point)(
	const struct bake_shape_grid *, int, int, struct bake_shape_point *))
{
	grid->nu = nu;
	grid->nv = nv;
	grid->point = point;
	return 1;
}

int
bake_shape_grids(enum bake_shape shape, int detail,
    struct bake_shape_grid grids[BAKE_SHAPE_MAX_GRIDS])
{
	const int d = detail;

	memset(grids, 0, BAKE_SHAPE_MAX_GRIDS * sizeof *grids);
	switch (shape) {
	case BAKE_SHAPE_PLANE:
		return one_grid(grids, d, d, plane_point);
	case BAKE_SHAPE_CUBE:
		for (int i = 0; i < 6; i++) {
			one_grid(&grids[i], d, d, cube_point);
			grids[i].which = i;
		}
		return 6;
	case BAKE_SHAPE_SPHERE:
		grids[0].pole[0] = grids[0].pole[1] = true;
		return one_grid(grids, 4 * d, 2 * d, sphere_point);
	case BAKE_SHAPE_CYLINDER:
		return cylinder_grids(d, grids);
	case BAKE_SHAPE_TORUS:
		/* a quarter turn is 2.5 times as long as one of the tube */
		return one_grid(
		    grids, 4 * ((5 * d + 1) / 2), 4 * d, torus_point);
	case BAKE_SHAPE_TEAPOT:
		return teapot_grids(d, grids);
	}
	return 0;
}
