/* Multilayer search, a vector of rays at a time, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#include "march_vec_priv.h"

#include "isa.h"
#include "multi_march_priv.h"

/* Rays that are searched together, so that halvings do not wait. */
enum { BATCH = 4 };

struct ground {
	const struct bake_multi_map *map;
	vec_m torus_u, torus_v;
	vec_f width, height;
};

struct lanes {
	vec_f u, v, z, du, dv, dz, q, t_end;
	vec_f n, step;
};

static inline struct ground
find_ground(const struct bake_multi_map *map)
{
	const vec_f zero = vec_set(0), one = vec_set(1);

	return (struct ground){ map,
		vec_ge(map->wrap.clamp_u ? zero : one, one),
		vec_ge(map->wrap.clamp_v ? zero : one, one),
		vec_set((float)map->width), vec_set((float)map->height) };
}

/* The depths of texels at[], of quads: depth i of all of them in d[i]. */
static inline void
gather(const struct bake_multi_map *map, const uint32_t *at, vec_f d[4])
{
#if defined(__AVX2__)
	__m256 r[4], lo[2], hi[2];

	for (int k = 0; k < 4; k++)
		r[k] = vec_two_cells(map->quads[at[k]], map->quads[at[k + 4]]);
	for (int k = 0; k < 2; k++) {
		lo[k] = _mm256_unpacklo_ps(r[2 * k], r[2 * k + 1]);
		hi[k] = _mm256_unpackhi_ps(r[2 * k], r[2 * k + 1]);
	}
	d[0] = _mm256_shuffle_ps(lo[0], lo[1], 0x44);
	d[1] = _mm256_shuffle_ps(lo[0], lo[1], 0xee);
	d[2] = _mm256_shuffle_ps(hi[0], hi[1], 0x44);
	d[3] = _mm256_shuffle_ps(hi[0], hi[1], 0xee);
#else
	float column[4][VEC_LANES];

	for (int k = 0; k < VEC_LANES; k++)
		for (int i = 0; i < 4; i++)
			column[i][k] = map->quads[at[k]][i];
	for (int i = 0; i < 4; i++)
		d[i] = vec_load(column[i]);
#endif
}

/* Lanes whose texels have more than the four depths, all above the ray. */
static inline vec_m
correct_deep(const struct bake_multi_map *map, const uint32_t *at, vec_f z,
    unsigned below, vec_m in)
{
	float depth[VEC_LANES], odd[VEC_LANES];

	vec_store(depth, z);
	vec_store(odd, vec_keep(in, vec_set(1)));
	for (int k = 0; k < VEC_LANES; k++)
		if (below >> k & 1)
			odd[k] = (float)(bake_multi_above(
					     map, (long)at[k], depth[k]) %
					 2);
	return vec_ge(vec_load(odd), vec_set(1));
}

static inline vec_f
place(vec_f u, vec_m torus)
{
	return u - vec_keep(torus, vec_floor(u));
}

static inline vec_m
within(vec_f s)
{
	return vec_and(vec_ge(s, vec_set(0)), vec_ge(vec_set(1), s));
}

/* as bake_multi_texel and bake_multi_above */
static inline vec_m
is_inside(const struct ground *g, const struct lanes *r, vec_f t)
{
	const vec_f zero = vec_set(0), one = vec_set(1);
	const vec_f z = r->z + t * (r->dz - t * r->q);
	vec_f x = place(r->u + t * r->du, g->torus_u);
	vec_f y = place(r->v + t * r->dv, g->torus_v);
	const vec_m there = vec_and(within(x), within(y));
	float xs[VEC_LANES], ys[VEC_LANES];
	uint32_t at[VEC_LANES];
	vec_f d[4];
	vec_m over, in;

	x = vec_min(vec_max(x, zero), one) * g->width;
	y = vec_min(vec_max(y, zero), one) * g->height;
	/* the last texel's end; whole numbers are exact */
	x = vec_min(vec_floor(x), g->width - one);
	y = vec_min(vec_floor(y), g->height - one);
	vec_store(xs, x);
	vec_store(ys, y);
	for (int k = 0; k < VEC_LANES; k++)
		at[k] = (uint32_t)(int)ys[k] * (uint32_t)g->map->width +
			(uint32_t)(int)xs[k];
	gather(g->map, at, d);
	over = vec_gt(z, d[3]);
	/* they rise: between the first and second, or third and fourth */
	in = vec_either(vec_without(vec_gt(z, d[0]), vec_gt(z, d[1])),
	    vec_without(vec_gt(z, d[2]), over));
	if (g->map->deep && vec_bits(over) != 0)
		in = correct_deep(g->map, at, z, vec_bits(over), in);
	return vec_and(there, in);
}

static inline vec_f
magnitude(vec_f a)
{
	return vec_max(a, vec_set(0) - a);
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
	return vec_min(vec_max(n, least), vec_set(BAKE_MULTI_STEPS_MAX));
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
	return r;
}

/* The last places outside and inside. */
struct bracket {
	vec_f a, b;
	vec_m at_start, found;
};

static inline void
search(const struct ground *g, const struct lanes *r, struct bracket *s)
{
	const vec_f zero = vec_set(0);
	const vec_m valid = vec_ge(r->t_end, zero);
	vec_m alive;

	s->at_start = vec_and(valid, is_inside(g, r, zero));
	s->found = vec_without(valid, valid);
	s->a = s->b = zero;
	alive = vec_without(valid, s->at_start);
	for (int k = 1; vec_bits(alive) != 0; k++) {
		const vec_f kf = vec_set((float)k);
		const vec_m last = vec_ge(kf, r->n);
		const vec_f t = vec_select(last, r->t_end, kf * r->step);
		const vec_m in = vec_and(alive, is_inside(g, r, t));

		alive = vec_without(alive, in);
		s->found = vec_either(s->found, in);
		s->b = vec_select(in, t, s->b);
		s->a = vec_select(alive, t, s->a);
		alive = vec_without(alive, last);
	}
}

static inline void
halve(const struct ground *g, const struct lanes *r, struct bracket *s)
{
	const vec_f t = vec_set(0.5f) * (s->a + s->b);
	const vec_m in = is_inside(g, r, t);

	s->b = vec_select(in, t, s->b);
	s->a = vec_select(in, s->a, t);
}

void
BAKE_KERNEL(bake_multi_search)(const struct bake_multi_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays,
    float *before)
{
	const struct ground g = find_ground(map);
	const vec_f zero = vec_set(0);

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
		for (int i = 0; i < n; i++) {
			const vec_f none =
			    vec_select(s[i].at_start, zero, vec_set(-1));

			vec_store(rays->hit + at + i * VEC_LANES,
			    vec_select(s[i].found, s[i].b, none));
			vec_store(before + at + i * VEC_LANES,
			    vec_keep(s[i].found, s[i].a));
		}
	}
}

static inline vec_f
hidden(const struct ground *g, const struct lanes *r, vec_f skip)
{
	const vec_m valid = vec_ge(r->t_end, vec_set(0));
	const vec_m none = vec_without(valid, valid);
	vec_m alive = valid, found = none, left = none;

	for (int k = 0; vec_bits(alive) != 0; k++) {
		const vec_f kf = vec_set((float)k);
		const vec_m last = vec_ge(kf, r->n);
		const vec_f t = vec_select(last, r->t_end, kf * r->step);
		const vec_m counts = vec_and(alive, vec_ge(t, skip));
		const vec_m in = is_inside(g, r, t);

		found = vec_either(found, vec_and(vec_and(counts, in), left));
		left = vec_either(left, vec_without(counts, in));
		alive = vec_without(vec_without(alive, found), last);
	}
	return vec_keep(found, vec_set(1));
}

void
BAKE_KERNEL(bake_multi_any)(const struct bake_multi_map *map,
    const struct bake_march_params *params, float skip,
    const struct bake_rays *rays)
{
	const struct ground g = find_ground(map);

	for (int at = 0; at < rays->n; at += VEC_LANES) {
		const struct lanes r = get_lanes(&g, params, rays, at);

		vec_store(rays->hit + at, hidden(&g, &r, vec_set(skip)));
	}
}
