/* Relief marching, a vector of rays at a time, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#include "march_vec_priv.h"

#include "isa.h"
#include "march_priv.h"

/* A map as the gather needs it. */
struct ground {
	const float *cells;
	unsigned stride;
	vec_m torus_u, torus_v;
	vec_f width, height;
};

struct lanes {
	vec_f u, v, z, du, dv, dz, q, t_end;
	vec_f n, step, lead;
};

static inline struct ground
find_ground(const struct bake_relief_map *map)
{
	const vec_f zero = vec_set(0), one = vec_set(1);

	return (struct ground){
		map->cells,
		map->stride,
		vec_ge(map->wrap.clamp_u ? zero : one, one),
		vec_ge(map->wrap.clamp_v ? zero : one, one),
		vec_set((float)map->width),
		vec_set((float)map->height),
	};
}

/* as bake_march_place */
static inline vec_f
place(vec_f u, vec_f side, vec_m torus)
{
	vec_f s = u - vec_keep(torus, vec_floor(u));

	s = vec_min(vec_max(s, vec_set(0)), vec_set(1));
	return s * side + vec_set(0.5f);
}

static inline vec_f
depth_at(const struct ground *g, vec_f u, vec_f v)
{
	return vec_bilinear(g->cells, g->stride, place(u, g->width, g->torus_u),
	    place(v, g->height, g->torus_v));
}

static inline vec_f
below(const struct ground *g, const struct lanes *r, vec_f t)
{
	const vec_f z = r->z + t * (r->dz - t * r->q);

	return z - depth_at(g, r->u + t * r->du, r->v + t * r->dv);
}

static inline vec_f
magnitude(vec_f a)
{
	return vec_max(a, vec_set(0) - a);
}

/* TEXEL: steps from one line between texel centres to the next, the first from
 * wherever the ray is. */
static inline void
align_steps(const struct ground *g, struct lanes *r, vec_f least)
{
	const vec_f half = vec_set(0.5f), zero = vec_set(0), one = vec_set(1);
	const vec_f x = r->du * g->width, y = r->dv * g->height;
	const vec_m by_x = vec_ge(magnitude(x), magnitude(y));
	const vec_f speed = magnitude(vec_select(by_x, x, y));
	const vec_f passed = speed * r->t_end;
	const vec_f at =
	    vec_select(by_x, r->u * g->width - half, r->v * g->height - half);
	const vec_f part = at - vec_floor(at);
	const vec_m up = vec_ge(vec_select(by_x, x, y), zero);
	const vec_m enough = vec_and(vec_ge(passed, least),
	    vec_ge(vec_set(BAKE_MARCH_STEPS_MAX - 2), passed));
	const vec_f n = one + (zero - vec_floor(zero - passed));

	r->n = vec_select(enough, n, r->n);
	r->step = vec_select(enough, one / speed, r->step);
	r->lead = vec_select(enough, vec_select(up, part, one - part), r->lead);
}

static inline vec_f
count_steps(const struct ground *g, const struct lanes *r,
    const struct bake_march_params *params)
{
	const vec_f least = vec_set((float)params->nlinear);
	const vec_f zero = vec_set(0);
	vec_f x, y, n;

	if (params->search == BAKE_SEARCH_LINEAR)
		return least;
	x = magnitude(r->du) * g->width;
	y = magnitude(r->dv) * g->height;
	n = zero - vec_floor(zero - vec_max(x, y) * r->t_end);
	return vec_min(vec_max(n, least), vec_set(BAKE_MARCH_STEPS_MAX));
}

static inline struct lanes
get_lanes(const struct ground *g, const struct bake_march_params *params,
    const struct bake_rays *rays, int at)
{
	struct lanes r = {
		.u = vec_load(rays->u + at),
		.v = vec_load(rays->v + at),
		.z = vec_load(rays->z + at),
		.du = vec_load(rays->du + at),
		.dv = vec_load(rays->dv + at),
		.dz = vec_load(rays->dz + at),
		.q = vec_load(rays->q + at),
		.t_end = vec_load(rays->t_end + at),
	};

	r.n = count_steps(g, &r, params);
	r.step = r.t_end / r.n;
	r.lead = vec_set(0);
	if (params->search == BAKE_SEARCH_TEXEL)
		align_steps(g, &r, vec_set((float)params->nlinear));
	return r;
}

/*
 * Rays that are searched together. Each halving waits for the one before, so
 * those of several vectors are done in turns.
 */
enum { BATCH = 4 };

/* Where a ray was above the relief and where below, and how far. */
struct bracket {
	vec_f a, fa, b, fb;
	vec_m at_start, found;
};

static inline void
search(const struct ground *g, const struct lanes *r, struct bracket *s)
{
	const vec_f zero = vec_set(0);
	const vec_f start = below(g, r, zero);
	const vec_m valid = vec_ge(r->t_end, zero);
	vec_m alive;

	s->at_start = vec_and(valid, vec_ge(start, zero));
	s->found = vec_without(valid, valid);
	s->a = s->b = zero;
	s->fa = s->fb = start;
	alive = vec_without(valid, s->at_start);
	for (int k = 1; vec_bits(alive) != 0; k++) {
		const vec_f kf = vec_set((float)k);
		const vec_f ahead = vec_max((kf - r->lead) * r->step, zero);
		const vec_m last =
		    vec_either(vec_ge(kf, r->n), vec_ge(ahead, r->t_end));
		const vec_f t = vec_select(last, r->t_end, ahead);
		const vec_f f = below(g, r, t);
		const vec_m in = vec_and(alive, vec_ge(f, zero));

		/* not in branches, which would be guessed wrong */
		alive = vec_without(alive, in);
		s->found = vec_either(s->found, in);
		s->b = vec_select(in, t, s->b);
		s->fb = vec_select(in, f, s->fb);
		s->a = vec_select(alive, t, s->a);
		s->fa = vec_select(alive, f, s->fa);
		alive = vec_without(alive, last);
	}
}

static inline void
halve(const struct ground *g, const struct lanes *r, struct bracket *s)
{
	const vec_f t = vec_set(0.5f) * (s->a + s->b);
	const vec_f f = below(g, r, t);
	const vec_m in = vec_ge(f, vec_set(0));

	s->b = vec_select(in, t, s->b);
	s->fb = vec_select(in, f, s->fb);
	s->a = vec_select(in, s->a, t);
	s->fa = vec_select(in, s->fa, f);
}

static inline vec_f
hits(const struct bracket *s, bool secant)
{
	const vec_f missed = vec_select(s->at_start, vec_set(0), vec_set(-1));
	vec_f t = s->b;

	if (secant) {
		t = s->a + (s->b - s->a) * (s->fa / (s->fa - s->fb));
		t = vec_min(vec_max(t, s->a), s->b);
	}
	return vec_select(s->found, t, missed);
}

void
BAKE_KERNEL(bake_march_linear)(const struct bake_relief_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays)
{
	const struct ground g = find_ground(map);

	for (int at = 0; at < rays->n; at += BATCH * VEC_LANES) {
		const int left = (rays->n - at + VEC_LANES - 1) / VEC_LANES;
		const int n = left < BATCH ? left : BATCH;
		struct lanes r[BATCH];
		struct bracket s[BATCH];

		for (int i = 0; i < n; i++) {
			r[i] = get_lanes(&g, params, rays, at + i * VEC_LANES);
			search(&g, &r[i], &s[i]);
		}
		for (int k = 0; k < params->nbinary; k++)
			for (int i = 0; i < n; i++)
				halve(&g, &r[i], &s[i]);
		for (int i = 0; i < n; i++)
			vec_store(rays->hit + at + i * VEC_LANES,
			    hits(&s[i], params->secant));
	}
}

static inline vec_f
hidden(const struct ground *g, const struct lanes *r, vec_f bias)
{
	const vec_m valid = vec_ge(r->t_end, vec_set(0));
	vec_m alive = valid, in, found = vec_without(valid, valid);

	for (int k = 0; vec_bits(alive) != 0; k++) {
		const vec_f kf = vec_set((float)k);
		const vec_f ahead =
		    vec_max((kf - r->lead) * r->step, vec_set(0));
		const vec_m last =
		    vec_either(vec_ge(kf, r->n), vec_ge(ahead, r->t_end));
		const vec_f t = vec_select(last, r->t_end, ahead);

		in = vec_and(alive, vec_gt(below(g, r, t), bias));
		found = vec_either(found, in);
		alive = vec_without(vec_without(alive, in), last);
	}
	return vec_keep(found, vec_set(1));
}

void
BAKE_KERNEL(bake_march_linear_any)(const struct bake_relief_map *map,
    const struct bake_march_params *params, float bias,
    const struct bake_rays *rays)
{
	const struct ground g = find_ground(map);

	for (int at = 0; at < rays->n; at += VEC_LANES) {
		const struct lanes r = get_lanes(&g, params, rays, at);

		vec_store(rays->hit + at, hidden(&g, &r, vec_set(bias)));
	}
}

int
BAKE_KERNEL(bake_march_sample)(const struct bake_relief_map *map, int n,
    const float *u, const float *v, float *d)
{
	const struct ground g = find_ground(map);
	int at = 0;

	for (; n - at >= VEC_LANES; at += VEC_LANES)
		vec_store(
		    d + at, depth_at(&g, vec_load(u + at), vec_load(v + at)));
	return at;
}
