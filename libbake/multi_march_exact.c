/* Multilayer marching, exactly: texel by texel, empty blocks at a time. */
/* SPDX-License-Identifier: MIT */
#include "multi_march_priv.h"

#define INLINE inline __attribute__((always_inline))

/*
 * Along each axis, in texels and double: the ray is in texel `cell` of the map,
 * which on a torus lies `off` texels from where it started. The two are whole
 * numbers that move by crossing borders, so that rounding can neither skip a
 * texel nor get stuck between two.
 */
struct axis {
	double start, speed, per_speed; /* at t: start + t speed */
	double off;
	int cell, side;
	bool clamp;
};

struct walk {
	const struct bake_multi_map *map;
	struct axis axis[2];
	double z, dz, q; /* z(t) = z + t (dz - t q) */
	double t, t_end;
	/* the texel before this one, or -1 */
	long before;
	/* out: what was hit */
	long texel;
	int layer;
};

/* A ray that is followed through more texels than this is cut there. */
static const double longest = 1 << 24;

static inline double
depth_of_ray(const struct walk *w, double t)
{
	return w->z + t * (w->dz - t * w->q);
}

static inline double
larger(double a, double b)
{
	return a > b ? a : b;
}

static inline double
smaller(double a, double b)
{
	return a < b ? a : b;
}

/* The ray's least and greatest depth from t = a to b. */
struct range {
	double least, most;
};

static inline struct range
depths_passed(const struct walk *w, double a, double b, double za, double zb)
{
	struct range r = { smaller(za, zb), larger(za, zb) };

	if (w->q != 0) {
		const double turn = w->dz / (2 * w->q);

		if (turn > a && turn < b) {
			const double z = depth_of_ray(w, turn);

			r.least = smaller(r.least, z);
			r.most = larger(r.most, z);
		}
	}
	return r;
}

/* -- texels -------------------------------------------------------------- */

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
	struct axis a = { .clamp = clamp, .side = side };
	double s = place;

	if (!clamp)
		s -= floor(s);
	a.start = s * side;
	a.speed = (double)speed * side;
	a.per_speed = a.speed != 0 ? 1 / a.speed : 0;
	return a;
}

/* Shortens the ray to what is within the borders of a clamped axis; false
 * where nothing is. */
static bool
clip(struct walk *w, const struct axis *a)
{
	double in, out;

	if (!a->clamp)
		return true;
	if (a->speed == 0)
		return a->start >= 0 && a->start <= a->side;
	in = -a->start * a->per_speed;
	out = (a->side - a->start) * a->per_speed;
	w->t = larger(w->t, smaller(in, out));
	w->t_end = smaller(w->t_end, larger(in, out));
	return w->t <= w->t_end;
}

/* The texel at t; on a border that which the ray goes into. */
static void
find_cell(struct axis *a, double t)
{
	const double x = a->start + t * a->speed;
	double cell = floor(x);

	if (a->speed < 0 && cell == x)
		cell--;
	if (!a->clamp) {
		a->off = floor(cell / a->side) * a->side;
		cell -= a->off;
	}
	a->cell = cell_within(cell, 0, a->side - 1);
}

/* False where there is nothing to follow from t = from on. */
static bool
start_walk(struct walk *w, const struct bake_multi_map *map,
    const struct bake_rays *rays, int i, float from)
{
	double cells;

	*w = (struct walk){ .map = map,
		.z = rays->z[i],
		.dz = rays->dz[i],
		.q = rays->q[i],
		.t = from > 0 ? from : 0,
		.t_end = rays->t_end[i],
		.before = -1,
		.texel = -1 };
	if (!(w->t_end >= 0) || !isfinite(w->t_end) || !isfinite(w->z) ||
	    !isfinite(w->dz) || !isfinite(w->q) || !isfinite(rays->u[i]) ||
	    !isfinite(rays->v[i]) || !isfinite(rays->du[i]) ||
	    !isfinite(rays->dv[i]))
		return false;
	w->axis[0] =
	    start_axis(rays->u[i], rays->du[i], map->width, map->wrap.clamp_u);
	w->axis[1] =
	    start_axis(rays->v[i], rays->dv[i], map->height, map->wrap.clamp_v);
	if (!clip(w, &w->axis[0]) || !clip(w, &w->axis[1]) ||
	    !(w->t <= w->t_end))
		return false;
	cells = fmax(fabs(w->axis[0].speed), fabs(w->axis[1].speed)) *
		(w->t_end - w->t);
	if (cells > longest)
		w->t_end = w->t + (w->t_end - w->t) * (longest / cells);
	find_cell(&w->axis[0], w->t);
	find_cell(&w->axis[1], w->t);
	return true;
}

/* The cells of a block along one axis, and the t where the ray leaves them. */
struct span {
	int first, last;
	double leave;
};

static INLINE struct span
find_span(const struct axis *a, const int level)
{
	struct span s;

	s.first = a->cell >> level << level;
	s.last = s.first + (1 << level) - 1;
	if (s.last >= a->side)
		s.last = a->side - 1;
	s.leave = INFINITY;
	if (a->speed != 0)
		s.leave = ((a->speed > 0 ? s.last + 1 : s.first) + a->off -
			      a->start) *
			  a->per_speed;
	return s;
}

/* How a step ended. */
enum passage { OUT, SAME_BLOCK, NEW_BLOCK };

/* Into the next cell behind the span. */
static INLINE enum passage
cross(struct axis *a, const struct span *s)
{
	const int mask = (1 << BAKE_MULTI_BLOCK) - 1;

	if (a->speed > 0) {
		a->cell = s->last + 1;
		if (a->cell == a->side) {
			if (a->clamp)
				return OUT;
			a->cell = 0;
			a->off += a->side;
		}
		return (a->cell & mask) == 0 ? NEW_BLOCK : SAME_BLOCK;
	}
	a->cell = s->first - 1;
	if (a->cell < 0) {
		if (a->clamp)
			return OUT;
		a->cell = a->side - 1;
		a->off -= a->side;
		return NEW_BLOCK;
	}
	return (a->cell & mask) == mask ? NEW_BLOCK : SAME_BLOCK;
}

static inline long
texel_of(const struct walk *w)
{
	return (long)w->axis[1].cell * w->map->width + w->axis[0].cell;
}

/* -- slabs --------------------------------------------------------------- */

/*
 * How long after t the ray's depth first comes to `level`, from above (sign 1)
 * or from below (-1), within `len`, given that it does: the first root of
 * f0 + f1 s + f2 s^2 with f0 <= 0 that rises.
 */
static double
time_to(const struct walk *w, double t, double len, double level, double sign)
{
	const double f0 = smaller(sign * (depth_of_ray(w, t) - level), 0);
	const double f1 = sign * (w->dz - 2 * w->q * t);
	const double f2 = -sign * w->q;
	const double disc = f1 * f1 - 4 * f0 * f2;
	const double root = disc > 0 ? sqrt(disc) : 0;
	double s = 0;

	if (f1 >= 0) {
		if (f1 + root > 0)
			s = -2 * f0 / (f1 + root);
	} else if (f2 > 0)
		s = (root - f1) / (2 * f2);
	return smaller(s, len);
}

/* The part of the ray in a texel. */
struct step {
	double t, to, z, z_to;
};

/*
 * Where the ray, which is in the gap before depth d[k], first enters a slab: at
 * d[k], if it goes deeper, or at d[k - 1]. -1 where it does not.
 */
static INLINE double
leave_gap(struct walk *w, const struct step *s, const float *d, int n, int k)
{
	const struct range r = depths_passed(w, s->t, s->to, s->z, s->z_to);
	double best = -1;

	if (k < n && r.most > (double)d[k]) {
		best = time_to(w, s->t, s->to - s->t, (double)d[k], 1);
		w->layer = k;
	}
	if (k > 0 && r.least <= (double)d[k - 1]) {
		const double t =
		    time_to(w, s->t, s->to - s->t, (double)d[k - 1], -1);

		if (best < 0 || t < best) {
			best = t;
			w->layer = k - 1;
		}
	}
	return best < 0 ? -1 : s->t + best;
}

/*
 * The layer of what the ray runs into sideways, at depth z: between the depths
 * p and r of this texel's slab, while the texel before it has a gap there from
 * lo to hi. The surface is not the wall: it joins layers of the two texels.
 * Where the slab goes on behind the gap, in the texel before, the ray came
 * through the sheet that falls from p to hi; where it goes on before the gap,
 * through that from r up to lo; where both, through the bottom of the gap,
 * which the texel before alone has (paper, figure 6a); where neither, over the
 * rim of a slab that ends here (figure 6b). Of the two layers that remain the
 * nearer in depth.
 */
static void
hit_wall(struct walk *w, long texel, int k, double z)
{
	const struct bake_multi_map *map = w->map;
	const float *b = bake_multi_depths(map, texel);
	const int nb = map->count[texel], na = bake_multi_count(map, w->before);
	const float *a = na > 0 ? bake_multi_depths(map, w->before) : NULL;
	const double p = (double)b[k - 1];
	const double r = k < nb ? (double)b[k] : INFINITY;
	double lo = -INFINITY, hi = INFINITY;
	bool behind, ahead;
	int ka = 0;

	while (ka < na && z > (double)a[ka])
		ka++;
	if (ka % 2 == 0) {
		lo = ka > 0 ? (double)a[ka - 1] : -INFINITY;
		hi = ka < na ? (double)a[ka] : INFINITY;
	}
	behind = hi < r;
	ahead = lo > p;
	w->texel = behind == ahead ? (behind ? w->before : texel) : texel;
	if (behind && ahead)
		w->layer = z - lo < hi - z ? ka - 1 : ka;
	else if (behind && hi - z < z - p) {
		w->texel = w->before;
		w->layer = ka;
	} else if (ahead && z - lo < r - z) {
		w->texel = w->before;
		w->layer = ka - 1;
	} else if (behind || ahead)
		w->layer = behind ? k - 1 : k;
	else
		w->layer = z - p <= r - z ? k - 1 : k;
}

static INLINE int
depths_above(const float *d, int n, double z)
{
	int k = 0;

	while (k < n && z > (double)d[k])
		k++;
	return k;
}

/* First hits: the t, and what is there in w, or -1. */
static INLINE double
meet(struct walk *w, const struct step *s)
{
	const long texel = texel_of(w);
	const int n = w->map->count[texel];
	const float *d =
	    n <= 4 ? w->map->quads[texel] : bake_multi_depths(w->map, texel);
	const int k = depths_above(d, n, s->z);

	if (k % 2 != 0) {
		hit_wall(w, texel, k, s->z);
		return s->t;
	}
	w->texel = texel;
	return leave_gap(w, s, d, n, k);
}

/*
 * Shadows: *left is whether the ray was outside already. What it is inside of
 * before that, it leaves first; and then it is looked at only which slab comes
 * next in the direction in which it left.
 */
static INLINE bool
is_met(struct walk *w, const struct step *s, bool *left)
{
	const long texel = texel_of(w);
	const int n = w->map->count[texel];
	const float *d = bake_multi_depths(w->map, texel);
	const int k = depths_above(d, n, s->z);
	const struct range r = depths_passed(w, s->t, s->to, s->z, s->z_to);

	if (k % 2 == 0) {
		*left = true;
		return leave_gap(w, s, d, n, k) >= 0;
	}
	if (*left)
		return true;
	if (r.least <= (double)d[k - 1]) {
		*left = true;
		return k > 1 && r.least <= (double)d[k - 2];
	}
	if (k < n && r.most > (double)d[k]) {
		*left = true;
		return k + 1 < n && r.most > (double)d[k + 1];
	}
	return false;
}

/* -- the way ------------------------------------------------------------- */

static inline void
move_within(struct axis *a, const struct span *s, double t)
{
	a->cell =
	    cell_within(a->start + t * a->speed - a->off, s->first, s->last);
}

/* Whether nothing of the block that the ray is in reaches its depths there; it
 * has then gone to its end. */
static INLINE bool
pass_block(struct walk *w, enum passage *end)
{
	struct axis *ax = &w->axis[0], *ay = &w->axis[1];
	const struct bake_multi_block b =
	    w->map->blocks[(size_t)(ay->cell >> BAKE_MULTI_BLOCK) *
			       (size_t)w->map->block_stride +
			   (size_t)(ax->cell >> BAKE_MULTI_BLOCK)];
	const struct span x = find_span(ax, BAKE_MULTI_BLOCK);
	const struct span y = find_span(ay, BAKE_MULTI_BLOCK);
	const double leave = smaller(x.leave, y.leave);
	const double to = larger(smaller(leave, w->t_end), w->t);
	const struct range r = depths_passed(
	    w, w->t, to, depth_of_ray(w, w->t), depth_of_ray(w, to));

	if (r.most > (double)b.low && r.least <= (double)b.high)
		return false;
	w->t = to;
	*end = OUT;
	if (!(leave < w->t_end))
		return true;
	if (x.leave <= y.leave) {
		move_within(ay, &y, to);
		ax->cell = ax->speed > 0 ? x.last : x.first;
		w->before = texel_of(w);
		*end = cross(ax, &x);
	} else {
		move_within(ax, &x, to);
		ay->cell = ay->speed > 0 ? y.last : y.first;
		w->before = texel_of(w);
		*end = cross(ay, &y);
	}
	return true;
}

/* Texel by texel; the t of the first hit, or -1; any: 0 where one is. */
static INLINE double
follow(struct walk *w, const bool any)
{
	enum passage now = NEW_BLOCK;
	bool first = true, left = false;

	while (now != OUT) {
		struct axis *ax = &w->axis[0], *ay = &w->axis[1];
		struct span x, y;
		struct step s;
		double leave;

		if (now == NEW_BLOCK && pass_block(w, &now)) {
			left = true;
			first = false;
			continue;
		}
		x = find_span(ax, 0);
		y = find_span(ay, 0);
		leave = smaller(x.leave, y.leave);
		s.t = w->t;
		s.to = larger(smaller(leave, w->t_end), w->t);
		/* a corner is passed without the texels beside it */
		if (s.to > s.t || first) {
			s.z = depth_of_ray(w, s.t);
			s.z_to = depth_of_ray(w, s.to);
			if (any) {
				if (is_met(w, &s, &left))
					return 0;
			} else {
				const double t = meet(w, &s);

				if (t >= 0)
					return t;
			}
			w->before = texel_of(w);
		}
		first = false;
		if (!(leave < w->t_end))
			break;
		w->t = s.to;
		now = x.leave <= y.leave ? cross(ax, &x) : cross(ay, &y);
	}
	return -1;
}

void
bake_multi_exact(const struct bake_multi_map *map, const struct bake_rays *rays,
    const struct bake_multi_hits *hits)
{
	struct walk w;

	for (int i = 0; i < rays->n; i++) {
		double t = -1;

		if (start_walk(&w, map, rays, i, 0))
			t = follow(&w, false);
		rays->hit[i] = (float)t;
		if (t >= 0)
			bake_multi_put(map, hits, i, w.texel, w.layer);
	}
}

void
bake_multi_any_exact(
    const struct bake_multi_map *map, float skip, const struct bake_rays *rays)
{
	struct walk w;

	for (int i = 0; i < rays->n; i++)
		rays->hit[i] =
		    start_walk(&w, map, rays, i, skip) && follow(&w, true) >= 0
			? 1
			: 0;
}
