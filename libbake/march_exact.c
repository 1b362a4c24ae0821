/* Relief marching, exactly: bilinear patch by patch, blocks at a time. */
/* SPDX-License-Identifier: MIT */
#include "march_priv.h"

#define INLINE inline __attribute__((always_inline))

/*
 * The ray in cells (march_priv.h), in double. Along each axis it is in cell
 * `cell` of the map, which on a torus lies `off` cells from where it started:
 * its place is cell + off + fraction. The two together are held as whole
 * numbers and move by crossing borders, so that rounding can neither skip a
 * cell nor get stuck between two.
 */
struct axis {
	double start, speed, per_speed; /* at t: start + t speed */
	double off;
	int cell, ncells;
	bool clamp;
};

struct walk {
	const struct bake_relief_map *map;
	struct axis axis[2];
	double z, dz, q; /* z(t) = z + t (dz - t q) */
	double per_dz;   /* 1 / dz on flat rays that go down, else 0 */
	double t, t_end;
};

/* A ray that is followed through more cells than this is cut there. */
static const double longest = 1 << 24;

/* Where the tests begin: from the top, each ray would have to come down. */
enum { START = 4 };

static inline double
depth_of_ray(const struct walk *w, double t)
{
	return w->z + t * (w->dz - t * w->q);
}

/* The greatest depth of the ray from t = a to b, za and zb being those there.
 */
static inline double
deepest(const struct walk *w, double a, double b, double za, double zb)
{
	const double most = za > zb ? za : zb;

	/* the summit at t = dz / (2 q) */
	if (w->q > 0 && w->dz > 2 * a * w->q && w->dz < 2 * b * w->q)
		return w->z + w->dz * w->dz / (4 * w->q);
	return most;
}

/* floor(x) as a cell of the range first .. last. */
static inline int
cell_within(double x, int first, int last)
{
	if (!(x > first))
		return first;
	return x >= last ? last : (int)x;
}

static struct axis
start_axis(float place, float speed, int side, bool clamp)
{
	struct axis a = { .clamp = clamp, .ncells = clamp ? side + 1 : side };
	double s = place;

	if (!clamp)
		s -= floor(s);
	a.start = s * side + 0.5;
	a.speed = (double)speed * side;
	a.per_speed = a.speed != 0 ? 1 / a.speed : 0;
	/* a torus' cell `side` is its cell 0 */
	if (!clamp && a.start >= side)
		a.start -= side;
	a.cell = cell_within(a.start, 0, a.ncells - 1);
	return a;
}

/* False where there is nothing to follow. */
static bool
start_walk(struct walk *w, const struct bake_relief_map *map,
    const struct bake_rays *rays, int i)
{
	double cells;

	*w = (struct walk){
		.map = map, .z = rays->z[i], .t_end = rays->t_end[i]
	};
	w->dz = rays->dz[i];
	w->q = rays->q[i];
	if (!(w->t_end >= 0) || !isfinite(w->t_end) || !isfinite(w->z) ||
	    !isfinite(w->dz) || !isfinite(w->q) || !isfinite(rays->u[i]) ||
	    !isfinite(rays->v[i]) || !isfinite(rays->du[i]) ||
	    !isfinite(rays->dv[i]))
		return false;
	w->per_dz = w->q == 0 && w->dz > 0 ? 1 / w->dz : 0;
	w->axis[0] =
	    start_axis(rays->u[i], rays->du[i], map->width, map->wrap.clamp_u);
	w->axis[1] =
	    start_axis(rays->v[i], rays->dv[i], map->height, map->wrap.clamp_v);
	cells = fmax(fabs(w->axis[0].speed), fabs(w->axis[1].speed)) * w->t_end;
	if (cells > longest)
		w->t_end *= longest / cells;
	return true;
}

/* The cells of a block along one axis, and the t where the ray leaves them. */
struct span {
	int first, last;
	double leave;
};

static inline struct span
find_span(const struct axis *a, int level)
{
	struct span s;
	int edge;

	s.first = a->cell >> level << level;
	s.last = s.first + (1 << level) - 1;
	if (s.last >= a->ncells)
		s.last = a->ncells - 1;
	s.leave = INFINITY;
	if (a->speed == 0)
		return s;
	edge = a->speed > 0 ? s.last + 1 : s.first;
	/* the outermost cells of a repeated border have no end */
	if (!a->clamp || (edge != 0 && edge != a->ncells))
		s.leave = (edge + a->off - a->start) * a->per_speed;
	return s;
}

/* Into the next block along the axis; whether that is in another block of the
 * level above. */
static inline bool
cross(struct axis *a, const struct span *s, int level)
{
	if (a->speed > 0) {
		a->cell = s->last + 1;
		if (a->cell == a->ncells) {
			a->cell = 0;
			a->off += a->ncells;
		}
		return (a->cell >> level & 1) == 0;
	} else {
		a->cell = s->first - 1;
		if (a->cell < 0) {
			a->cell = a->ncells - 1;
			a->off -= a->ncells;
			return true;
		}
		return (a->cell >> level & 1) != 0;
	}
}

/* The cell at t, which is in the span. */
static inline void
move_within(struct axis *a, const struct span *s, double t)
{
	a->cell =
	    cell_within(a->start + t * a->speed - a->off, s->first, s->last);
}

/* The ray's height below the patch, f0 + f1 s + f2 s^2, s = t - t0. */
struct patch {
	double f0, f1, f2;
};

static inline struct patch
find_patch(const struct walk *w)
{
	const struct axis *ax = &w->axis[0], *ay = &w->axis[1];
	const float *c =
	    bake_march_cell(w->map, (unsigned)ax->cell, (unsigned)ay->cell);
	const double x = ax->start + w->t * ax->speed - ax->off - ax->cell;
	const double y = ay->start + w->t * ay->speed - ay->off - ay->cell;
	const double d = c[0], along_y = c[1] - d, along_x = c[2] - d;
	const double twist = c[3] - d - along_x - along_y;
	const double slope_x = along_x + twist * y;
	const double slope_y = along_y + twist * x;

	return (struct patch){
		depth_of_ray(w, w->t) - (d + along_y * y + slope_x * x),
		w->dz - 2 * w->q * w->t - slope_x * ax->speed -
		    slope_y * ay->speed,
		-w->q - twist * ax->speed * ay->speed,
	};
}

/*
 * The first s in 0 .. h where f >= 0, or -1. With f0 < 0 the least positive
 * root is -2 f0 / (f1 + sqrt(f1^2 - 4 f2 f0)) whatever the sign of f2; where
 * f1 < 0 the sum would cancel, and the other form of it is used.
 */
static inline double
first_root(const struct patch *p, double h)
{
	const double end = p->f0 + h * (p->f1 + h * p->f2);
	double d, s;

	if (p->f0 >= 0)
		return 0;
	/* below 0 at the end, and no summit in between */
	if (end < 0 && (p->f2 >= 0 || p->f1 <= 0 || p->f1 + 2 * p->f2 * h >= 0))
		return -1;
	d = p->f1 * p->f1 - 4 * p->f2 * p->f0;
	if (d < 0)
		return end >= 0 ? h : -1;
	d = sqrt(d);
	if (p->f1 >= 0)
		s = -2 * p->f0 / (p->f1 + d);
	else
		s = (d - p->f1) / (2 * p->f2);
	/* 0 / 0: f is 0 but for rounding */
	return s >= 0 && s < h ? s : h;
}

/* Whether f > bias somewhere in 0 .. h. */
static inline bool
is_above(const struct patch *p, double h, double bias)
{
	if (p->f0 > bias || p->f0 + h * (p->f1 + h * p->f2) > bias)
		return true;
	if (p->f2 >= 0 || p->f1 <= 0 || p->f1 + 2 * p->f2 * h >= 0)
		return false;
	return p->f0 - p->f1 * p->f1 / (4 * p->f2) > bias;
}

static inline float
block_low(const struct walk *w, int level)
{
	return w->map->lows[level][(size_t)(w->axis[1].cell >> level) *
				       (size_t)w->map->low_stride[level] +
				   (size_t)(w->axis[0].cell >> level)];
}

/*
 * Whether all of the ray from w->t to `to` is above the block's least depth.
 * If not, a ray that is straight in z goes on to where it is that deep.
 */
static INLINE bool
is_over(struct walk *w, int level, const struct span *x, const struct span *y,
    double to, double bias)
{
	const double low = (double)block_low(w, level) + bias;
	const double za = depth_of_ray(w, w->t), zb = depth_of_ray(w, to);
	double t;

	if (deepest(w, w->t, to, za, zb) < low)
		return true;
	if (!(za < low) || !(w->per_dz > 0))
		return false;
	/* not beyond it by rounding */
	t = (low - w->z) * w->per_dz * (1 - 0x1p-40);
	if (t > w->t) {
		w->t = t < to ? t : to;
		move_within(&w->axis[0], x, w->t);
		move_within(&w->axis[1], y, w->t);
	}
	return false;
}

/* Where the ray meets the patch before `to`, or -1; any: where it has come
 * deeper than the bias below it, as far as that is known. */
static INLINE double
meet_patch(const struct walk *w, double to, const bool any, double bias)
{
	const struct patch p = find_patch(w);
	double s;

	if (any)
		return is_above(&p, to - w->t, bias) ? to : -1;
	s = first_root(&p, to - w->t);
	return s >= 0 ? w->t + s : -1;
}

/*
 * The t of the first hit, or -1; any: not less than 0 where anything is hit.
 * After a block that the ray passes above, the next test is of a block twice
 * as large where a new one of those begins; else of one half as large.
 */
static INLINE double
follow(struct walk *w, const bool any, double bias)
{
	int level = w->map->top < START ? w->map->top : START;

	while (w->t <= w->t_end) {
		const struct span x = find_span(&w->axis[0], level);
		const struct span y = find_span(&w->axis[1], level);
		const double leave = x.leave < y.leave ? x.leave : y.leave;
		double to = leave < w->t_end ? leave : w->t_end;
		bool up;

		/* on a border, by rounding */
		if (to < w->t)
			to = w->t;
		if (level == 0) {
			const double hit = meet_patch(w, to, any, bias);

			if (hit >= 0)
				return hit;
		} else if (!is_over(w, level, &x, &y, to, bias)) {
			level--;
			continue;
		}
		if (!(leave < w->t_end))
			break;
		w->t = to;
		if (x.leave <= y.leave) {
			up = cross(&w->axis[0], &x, level);
			move_within(&w->axis[1], &y, w->t);
		} else {
			up = cross(&w->axis[1], &y, level);
			move_within(&w->axis[0], &x, w->t);
		}
		if (up && level < w->map->top)
			level++;
	}
	return -1;
}

void
bake_march_exact(
    const struct bake_relief_map *map, const struct bake_rays *rays)
{
	struct walk w;

	for (int i = 0; i < rays->n; i++)
		rays->hit[i] = start_walk(&w, map, rays, i)
				   ? (float)follow(&w, false, 0)
				   : -1;
}

void
bake_march_any_exact(
    const struct bake_relief_map *map, float bias, const struct bake_rays *rays)
{
	struct walk w;

	for (int i = 0; i < rays->n; i++)
		rays->hit[i] =
		    start_walk(&w, map, rays, i) && follow(&w, true, bias) >= 0
			? 1
			: 0;
}
