/* Shell marching: the curve of a ray in one prism, and where it leaves it. */
/* SPDX-License-Identifier: MIT */
#include "march_priv.h"
#include "shell_march_priv.h"

/* A triangle less high than this share of its longest edge has no area. */
static const double flat = 1e-12;
/* A ray leaves a prism when it is that far outside, in weights and depth:
 * prisms overlap by it, so that a point near a vertex or an edge is well inside
 * one of them, and walking from one to the next comes to an end. */
static const double overlap = 1e-11;

/* -- setting up --------------------------------------------------------------
 */

static void
set_level(struct shell_prism *p)
{
	double x[3], y[3];

	bake_shell_cross(p->e[0], p->e[1], p->n[0]);
	bake_shell_cross(p->e[0], p->f[1], x);
	bake_shell_cross(p->f[0], p->e[1], y);
	for (int c = 0; c < 3; c++)
		p->n[1][c] = x[c] + y[c];
	bake_shell_cross(p->f[0], p->f[1], p->n[2]);
	for (int k = 0; k < 3; k++) {
		p->h[k] = bake_shell_dot(p->n[k], p->a);
		p->ht[k] = bake_shell_dot(p->n[k], p->d);
	}
	for (int k = 0; k < 3; k++) {
		const double along = bake_shell_dot(p->n[k], p->m);

		if (k < 2)
			p->h[k + 1] -= along;
		else
			p->h[3] = -along;
	}
}

/* The two axes that are left when that of the largest part of n is not. */
static void
set_axes(struct shell_prism *p)
{
	int largest = 0;

	for (int c = 1; c < 3; c++)
		if (fabs(p->n[0][c]) > fabs(p->n[0][largest]))
			largest = c;
	p->i = (largest + 1) % 3;
	p->j = (largest + 2) % 3;
}

static void
set_place(struct shell_prism *p, const struct bake_shell *s,
    const struct bake_relief_map *map, int triangle)
{
	const struct bake_corner *corner = s->mesh->triangles[triangle];
	const int side[2] = { map->width, map->height };
	double most = 0;

	for (int axis = 0; axis < 2; axis++) {
		double x[3];

		for (int k = 0; k < 3; k++) {
			const int vt = corner[k].vt;
			const double u = vt < 0 ? 0 : s->mesh->uvs[vt][axis];

			x[k] = u * s->tile[axis] * side[axis] + 0.5;
			most = fmax(most, fabs(x[k]));
		}
		p->place[axis][0] = x[0];
		p->place[axis][1] = x[1] - x[0];
		p->place[axis][2] = x[2] - x[0];
	}
	p->slack = 1e-9 + 8e-15 * most;
}

bool
bake_shell_prism(struct shell_prism *p, const struct bake_shell *s,
    const struct bake_relief_map *map, int triangle, const double origin[3],
    const double dir[3])
{
	const double *p0 = bake_shell_position(s, triangle, 0);
	const double *n0 = bake_shell_normal(s, triangle, 0);
	double longest = 0, lean = 0;

	for (int c = 0; c < 3; c++) {
		p->a[c] = origin[c] - p0[c];
		p->d[c] = dir[c];
		p->m[c] = -s->depth * n0[c];
	}
	for (int k = 0; k < 2; k++) {
		const double *pk = bake_shell_position(s, triangle, k + 1);
		const double *nk = bake_shell_normal(s, triangle, k + 1);

		for (int c = 0; c < 3; c++) {
			p->e[k][c] = pk[c] - p0[c];
			p->f[k][c] = -s->depth * (nk[c] - n0[c]);
		}
		longest = fmax(longest, bake_shell_dot(p->e[k], p->e[k]));
	}
	for (int c = 0; c < 3; c++)
		lean += (p->e[1][c] - p->e[0][c]) * (p->e[1][c] - p->e[0][c]);
	longest = fmax(longest, lean);
	p->size = sqrt(longest);
	set_level(p);
	set_axes(p);
	/* dh/dz at depth 0 in the middle, -n . (m + (f_1 + f_2) / 3) */
	lean = bake_shell_dot(p->n[0], p->m) +
	       (bake_shell_dot(p->n[0], p->f[0]) +
		   bake_shell_dot(p->n[0], p->f[1])) /
		   3;
	p->sign = lean < 0 ? 1 : -1;
	set_place(p, s, map, triangle);
	return bake_shell_dot(p->n[0], p->n[0]) >
	       flat * flat * longest * longest;
}

/* -- a point of the ray ------------------------------------------------------
 */

/* The weights, and their rates, where depth and its rate are known. */
static bool
set_weights(const struct shell_prism *p, struct shell_point *q)
{
	const int i = p->i, j = p->j;
	const double ai = p->e[0][i] + q->z * p->f[0][i];
	const double aj = p->e[0][j] + q->z * p->f[0][j];
	const double bi = p->e[1][i] + q->z * p->f[1][i];
	const double bj = p->e[1][j] + q->z * p->f[1][j];
	const double per_det = 1 / (ai * bj - aj * bi);
	double ri = p->a[i] + q->t * p->d[i] - q->z * p->m[i];
	double rj = p->a[j] + q->t * p->d[j] - q->z * p->m[j];

	q->b[1] = (ri * bj - rj * bi) * per_det;
	q->b[2] = (ai * rj - aj * ri) * per_det;
	q->b[0] = 1 - q->b[1] - q->b[2];
	/* the ray's direction less what the depth does, m + b f */
	ri = p->d[i] -
	     q->dz * (p->m[i] + q->b[1] * p->f[0][i] + q->b[2] * p->f[1][i]);
	rj = p->d[j] -
	     q->dz * (p->m[j] + q->b[1] * p->f[0][j] + q->b[2] * p->f[1][j]);
	q->db[1] = (ri * bj - rj * bi) * per_det;
	q->db[2] = (ai * rj - aj * ri) * per_det;
	q->db[0] = -q->db[1] - q->db[2];
	return isfinite(q->b[0]) && isfinite(q->db[0]);
}

bool
bake_shell_solve(
    const struct shell_prism *p, double t, double z, struct shell_point *point)
{
	const double c0 = p->h[0] + t * p->ht[0], c1 = p->h[1] + t * p->ht[1];
	const double c2 = p->h[2] + t * p->ht[2], c3 = p->h[3];
	double slope, step;
	int left = 16;

	z = z > -0.5 ? z : -0.5;
	z = z < 1.5 ? z : 1.5;
	do {
		slope = c1 + z * (2 * c2 + z * 3 * c3);
		step = (c0 + z * (c1 + z * (c2 + z * c3))) / slope;
		z -= step;
		/* beyond these nothing is looked for; NaN is neither */
		if (!(slope * p->sign > 0) || !(z > -2 && z < 3))
			return false;
		/* the error that is left is about the square of the step */
	} while (fabs(step) > 1e-8 && --left > 0);
	slope = c1 + z * (2 * c2 + z * 3 * c3);
	if (!(slope * p->sign > 0) || left == 0)
		return false;
	point->t = t;
	point->z = z;
	point->dz = -(p->ht[0] + z * (p->ht[1] + z * p->ht[2])) / slope;
	return set_weights(p, point);
}

/* -- leaving -----------------------------------------------------------------
 */

/* What must not fall below 0 in the prism: weights, z and 1 - z, each less its
 * floor. */
enum { NMARGINS = 5 };
static inline double
margin(const struct shell_point *q, const double floors[NMARGINS], int c)
{
	const double value = c < 3 ? q->b[c] : c == SHELL_TOP ? q->z : 1 - q->z;

	return value - floors[c];
}

static inline double
rate(const struct shell_point *q, int c)
{
	return c < 3 ? q->db[c] : c == SHELL_TOP ? q->dz : -q->dz;
}

/*
 * What is outside and getting nearer, and the side over which the ray came,
 * must not be taken for ways out: the origin is rounded, and normals on both
 * sides of an edge may differ a bit.
 */
static void
set_floors(const struct shell_point *in, int entered, double floors[NMARGINS])
{
	for (int c = 0; c < NMARGINS; c++) {
		floors[c] = 0;
		if (c == entered || rate(in, c) >= 0) {
			const double value = margin(in, floors, c);

			floors[c] = value < 0 ? value : 0;
		}
		floors[c] -= overlap;
	}
}

/* The way out that is reached first if all goes on as at q, and the step to
 * there, negative if it is passed; -1 if there is none. */
static int
first_out(
    const struct shell_point *q, const double floors[NMARGINS], double *step)
{
	int first = -1;

	*step = INFINITY;
	for (int c = 0; c < NMARGINS; c++) {
		const double r = rate(q, c);

		if (r < 0 && margin(q, floors, c) < *step * -r) {
			*step = margin(q, floors, c) / -r;
			first = c;
		}
	}
	return first;
}

static double
least_margin(const struct shell_point *q, const double floors[NMARGINS], int *c)
{
	double least = INFINITY;

	for (int k = 0; k < NMARGINS; k++)
		if (margin(q, floors, k) < least) {
			least = margin(q, floors, k);
			*c = k;
		}
	return least;
}

/*
 * Newton's steps to the nearest way out, within lo, which is inside, and hi,
 * which is not; halvings where they lead elsewhere.
 */
int
bake_shell_leave(const struct shell_prism *p, const struct shell_point *in,
    int entered, struct shell_point *out)
{
	double floors[NMARGINS], lo = in->t, hi = INFINITY, step;
	double reach = p->size;
	struct shell_point at = *in, to;
	int side = SHELL_FOLD;

	set_floors(in, entered, floors);
	*out = *in;
	if (least_margin(in, floors, &side) < 0)
		return side;
	for (int n = 0; n < 128 && hi - lo > 1e-15 * (fabs(lo) + reach); n++) {
		const int c = first_out(&at, floors, &step);
		double t = at.t + step;

		if (!(t > lo && t < hi) || (n > 16 && hi < INFINITY)) {
			t = hi < INFINITY ? 0.5 * (lo + hi) : lo + reach;
			reach *= 2;
		}
		if (!bake_shell_solve(p, t, at.z + at.dz * (t - at.t), &to)) {
			hi = t;
			at = *out;
			continue;
		}
		at = to;
		if (least_margin(&at, floors, &side) >= 0) {
			lo = t;
			*out = at;
		} else
			hi = t;
		if (c >= 0 && side == c &&
		    fabs(margin(&at, floors, c)) <= 1e-2 * overlap) {
			*out = at;
			return c;
		}
	}
	return least_margin(out, floors, &side) < 1e-6 ? side : SHELL_FOLD;
}

/* -- triangles without area --------------------------------------------------
 */

/* How far the foot of p on the line a b is outside of it, in its lengths. */
static double
beyond(const double a[3], const double b[3], const double p[3])
{
	double ab[3], ap[3], x, l;

	for (int c = 0; c < 3; c++) {
		ab[c] = b[c] - a[c];
		ap[c] = p[c] - a[c];
	}
	l = bake_shell_dot(ab, ab);
	x = l > 0 ? bake_shell_dot(ab, ap) / l : 0;
	return x < 0 ? -x : x > 1 ? x - 1 : 0;
}

int
bake_shell_pass(const struct bake_shell *s, int triangle, int entered,
    const double point[3], double z)
{
	const int i = (entered + 1) % 3, j = (entered + 2) % 3;
	double q[3][3];

	for (int k = 0; k < 3; k++) {
		const double *p = bake_shell_position(s, triangle, k);
		const double *n = bake_shell_normal(s, triangle, k);

		for (int c = 0; c < 3; c++)
			q[k][c] = p[c] - z * s->depth * n[c];
	}
	/* side i is between corners j and entered */
	return beyond(q[j], q[entered], point) <=
		       beyond(q[i], q[entered], point)
		   ? i
		   : j;
}
