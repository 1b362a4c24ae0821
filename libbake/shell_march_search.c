/* Shell marching: the relief along a ray's curve, cell by cell. */
/* SPDX-License-Identifier: MIT */
#include "march_priv.h"
#include "shell_march_priv.h"

/*
 * In one cell of the map the depth is a bilinear patch, so that f = z - d is
 * smooth along the ray, and in a prism of parallel sides quadratic in t.
 * Unwrapped cell (x, y) = (cell[0], cell[1]) covers places x .. x + 1,
 * y .. y + 1; c are its corners as in march_priv.h.
 */
struct cell {
	const struct shell_prism *prism;
	double cell[2];
	const float *c;
	double bias;
};

static unsigned
wrapped(double cell, int side, bool clamp)
{
	if (clamp)
		return cell > 0 ? cell < side ? (unsigned)cell : (unsigned)side
				: 0;
	cell -= side * floor(cell / side);
	return cell > 0 && cell < side ? (unsigned)cell : 0;
}

static double
place_rate(const struct shell_prism *p, const struct shell_point *q, int axis)
{
	return q->db[1] * p->place[axis][1] + q->db[2] * p->place[axis][2];
}

/* The cell that the ray goes into at q. */
static struct cell
find_cell(const struct shell_prism *p, const struct bake_relief_map *map,
    const struct shell_point *q, double bias)
{
	struct cell c = { .prism = p, .bias = bias };

	for (int k = 0; k < 2; k++) {
		const double x = bake_shell_place(p, q->b, k);

		if (place_rate(p, q, k) < 0)
			c.cell[k] = ceil(x - 2 * p->slack) - 1;
		else
			c.cell[k] = floor(x + 2 * p->slack);
	}
	c.c = bake_march_cell(map,
	    wrapped(c.cell[0], map->width, map->wrap.clamp_u),
	    wrapped(c.cell[1], map->height, map->wrap.clamp_v));
	return c;
}

/* f less the bias. */
static double
below(const struct cell *cell, const struct shell_point *q)
{
	const double x = bake_shell_place(cell->prism, q->b, 0) - cell->cell[0];
	const double y = bake_shell_place(cell->prism, q->b, 1) - cell->cell[1];
	const float *c = cell->c;
	const double left = c[0] + y * ((double)c[1] - c[0]);
	const double right = c[2] + y * ((double)c[3] - c[2]);

	return q->z - (left + x * (right - left)) - cell->bias;
}

/* -- steps -------------------------------------------------------------------
 */

/* How far q is outside of the cell. */
static double
outside(const struct cell *c, const struct shell_point *q)
{
	double most = 0;

	for (int k = 0; k < 2; k++) {
		const double x =
		    bake_shell_place(c->prism, q->b, k) - c->cell[k];

		most = fmax(most, fmax(-x, x - 1));
	}
	return most;
}

/* The border that is reached first if all goes on as at q, and when. */
static int
first_border(const struct cell *c, const struct shell_point *q, double *border,
    double *step)
{
	int first = -1;

	for (int k = 0; k < 2; k++) {
		const double v = place_rate(c->prism, q, k);
		const double x = c->cell[k] + (v > 0 ? 1 : 0);
		const double s = (x - bake_shell_place(c->prism, q->b, k)) / v;

		if (v != 0 && s < *step) {
			*step = s;
			*border = x;
			first = k;
		}
	}
	return first;
}

/*
 * From a to the border of its cell, or to the end of the way. Newton's steps
 * to the border; where the curve turns before it, or leaves over another
 * border, halvings.
 */
static struct shell_point
step_on(const struct cell *c, const struct shell_point *a,
    const struct shell_point *end)
{
	const struct shell_prism *p = c->prism;
	double step = end->t - a->t, border = 0, t;
	const int axis = first_border(c, a, &border, &step);
	struct shell_point b = *end;

	t = axis < 0 ? end->t : a->t + step;
	for (int n = 0; n < 16; n++) {
		double off, v;

		if (t >= end->t)
			b = *end;
		else if (!bake_shell_solve(p, t, a->z + a->dz * (t - a->t), &b))
			return *end;
		if (axis >= 0 && n < 4) {
			off = bake_shell_place(p, b.b, axis) - border;
			v = place_rate(p, &b, axis);
			t = b.t - off / v;
			if (fabs(off) > p->slack && v != 0 &&
			    (t < end->t || b.t < end->t)) {
				if (!(t > a->t))
					t = 0.5 * (a->t + b.t);
				continue;
			}
		}
		if (outside(c, &b) <= 3 * p->slack)
			break;
		t = 0.5 * (a->t + b.t);
	}
	return b;
}

/* -- roots -------------------------------------------------------------------
 */

/* Regula falsi (Illinois: Dowell and Jarratt, 'A modified regula falsi method',
 * BIT 11, 1971) from a, above, to b, below the relief. */
static struct shell_point
refine(const struct cell *c, struct shell_point a, struct shell_point b)
{
	double fa = below(c, &a), fb = below(c, &b);
	int last = 0;

	for (int n = 0; n < 64 && b.t - a.t > 2e-16 * fabs(b.t) && fb > 0;
	     n++) {
		double t = a.t + (b.t - a.t) * (fa / (fa - fb));
		struct shell_point m;
		double fm;

		/* halve where it creeps */
		if (!(t > a.t && t < b.t) || n % 8 == 7)
			t = 0.5 * (a.t + b.t);
		if (!(t > a.t && t < b.t) ||
		    !bake_shell_solve(c->prism, t, a.z, &m))
			break;
		fm = below(c, &m);
		if (fm >= 0) {
			b = m;
			fb = fm;
			fa *= last > 0 ? 0.5 : 1;
			last = 1;
		} else {
			a = m;
			fa = fm;
			fb *= last < 0 ? 0.5 : 1;
			last = -1;
		}
	}
	return b;
}

/* A point between a and b, both above the relief, that is below it: at the
 * summit of the parabola through f at a, in the middle and at b. */
static bool
find_summit(const struct cell *c, const struct shell_point *a,
    const struct shell_point *b, double fa, double fb, struct shell_point *m)
{
	const double h = b->t - a->t, z = 0.5 * (a->z + b->z);
	double fm, bend, slope, s;

	if (!bake_shell_solve(c->prism, a->t + 0.5 * h, z, m))
		return false;
	fm = below(c, m);
	if (fm >= 0)
		return true;
	bend = 2 * fa - 4 * fm + 2 * fb;
	slope = -3 * fa + 4 * fm - fb;
	/* f(a + s h) = fa + slope s + bend s^2 */
	if (!(bend < 0 && slope > 0 && slope < -2 * bend))
		return false;
	s = slope / (-2 * bend);
	/* where f is no parabola, its summit may be a bit higher */
	if (fa + 0.5 * slope * s < 0.05 * bend)
		return false;
	return bake_shell_solve(c->prism, a->t + s * h, z, m) &&
	       below(c, m) >= 0;
}

static bool
search_cell(const struct cell *c, const struct shell_point *a,
    const struct shell_point *b, bool any, struct shell_point *hit)
{
	const double deepest = a->z > b->z ? a->z : b->z;
	const float *d = c->c;
	struct shell_point m;
	double fa, fb;

	/* the depth along the ray is monotonic in a prism; what is outside of
	 * the cell by rounding is not below its corners by more than that */
	if (deepest - c->bias < d[0] && deepest - c->bias < d[1] &&
	    deepest - c->bias < d[2] && deepest - c->bias < d[3])
		return false;
	fa = below(c, a);
	fb = below(c, b);
	if (fa >= 0)
		m = *a;
	else if (fb >= 0)
		m = *b;
	else if (!find_summit(c, a, b, fa, fb, &m))
		return false;
	*hit = fa >= 0 || any ? m : refine(c, *a, m);
	return true;
}

bool
bake_shell_search(const struct shell_prism *p,
    const struct bake_relief_map *map, const struct shell_point *in,
    const struct shell_point *out, double bias, bool any,
    struct shell_budget *budget, struct shell_point *hit)
{
	struct shell_point a = *in;
	double ncells = 64;

	/* several times those of a straight way: next to a fold the curve may
	 * turn so much that steps come to nothing */
	for (int k = 0; k < 2; k++)
		ncells += 8 * (fabs(p->place[k][1]) + fabs(p->place[k][2]));
	do {
		const struct cell c = find_cell(p, map, &a, bias);
		struct shell_point b = *out;

		if (budget->ncells > 0 && --ncells > 0) {
			budget->ncells--;
			b = step_on(&c, &a, out);
		}
		if (search_cell(&c, &a, &b, any, hit))
			return true;
		a = b;
	} while (a.t < out->t);
	return false;
}
