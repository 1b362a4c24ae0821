/* Relief marching ray by ray: what the kernels must agree with, bit by bit. */
/* SPDX-License-Identifier: MIT */
#include "march_priv.h"

/* One ray, and the length and number of its steps. */
struct ray {
	const struct bake_relief_map *map;
	float u, v, z, du, dv, dz, q, t_end;
	float n, step, lead;
};

/* How far below the relief the ray is at t; negative: above. */
static float
below(const struct ray *r, float t)
{
	const float z = r->z + t * (r->dz - t * r->q);

	return z - bake_march_depth(r->map, r->u + t * r->du, r->v + t * r->dv);
}

/* Texels passed along the faster axis, at least nlinear. */
static float
count_steps(const struct ray *r, const struct bake_march_params *params)
{
	const float least = (float)params->nlinear;
	float x = fabsf(r->du) * (float)r->map->width;
	float y = fabsf(r->dv) * (float)r->map->height;
	float n;

	if (params->search == BAKE_SEARCH_LINEAR)
		return least;
	n = ceilf((x > y ? x : y) * r->t_end);
	n = n > least ? n : least;
	return n < BAKE_MARCH_STEPS_MAX ? n : BAKE_MARCH_STEPS_MAX;
}

/* TEXEL: steps from one line between texel centres to the next, the first from
 * wherever the ray is: so much of a step lies behind the start. */
static void
align_steps(struct ray *r, float least)
{
	const float x = r->du * (float)r->map->width;
	const float y = r->dv * (float)r->map->height;
	const bool by_x = fabsf(x) >= fabsf(y);
	const float speed = by_x ? fabsf(x) : fabsf(y);
	const float passed = speed * r->t_end;
	const float at = by_x ? r->u * (float)r->map->width - 0.5f
			      : r->v * (float)r->map->height - 0.5f;
	const float part = at - floorf(at);

	if (!(passed >= least) || !(BAKE_MARCH_STEPS_MAX - 2 >= passed))
		return;
	r->n = 1 + ceilf(passed);
	r->step = 1 / speed;
	r->lead = (by_x ? x : y) >= 0 ? part : 1 - part;
}

static struct ray
get_ray(const struct bake_relief_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays, int i)
{
	struct ray r = {
		.map = map,
		.u = rays->u[i],
		.v = rays->v[i],
		.z = rays->z[i],
		.du = rays->du[i],
		.dv = rays->dv[i],
		.dz = rays->dz[i],
		.q = rays->q[i],
		.t_end = rays->t_end[i],
	};

	r.n = count_steps(&r, params);
	r.step = r.t_end / r.n;
	r.lead = 0;
	if (params->search == BAKE_SEARCH_TEXEL)
		align_steps(&r, (float)params->nlinear);
	return r;
}

static float
step_end(const struct ray *r, int k)
{
	const float t = ((float)k - r->lead) * r->step;

	if ((float)k >= r->n || t >= r->t_end)
		return r->t_end;
	return t > 0 ? t : 0;
}

/* Between a, above the relief by -fa, and b, below it by fb. */
static float
refine(const struct ray *r, const struct bake_march_params *params, float a,
    float fa, float b, float fb)
{
	float t;

	for (int k = 0; k < params->nbinary; k++) {
		float f;

		t = 0.5f * (a + b);
		f = below(r, t);
		if (f >= 0) {
			b = t;
			fb = f;
		} else {
			a = t;
			fa = f;
		}
	}
	if (!params->secant)
		return b;
	/* fa < 0 <= fb: the divisor is never 0, but both may be infinite */
	t = a + (b - a) * (fa / (fa - fb));
	t = t > a ? t : a;
	return t < b ? t : b;
}

static float
first_hit(const struct ray *r, const struct bake_march_params *params)
{
	float a = 0, fa;

	if (!(r->t_end >= 0))
		return -1;
	fa = below(r, 0);
	if (fa >= 0)
		return 0;
	for (int k = 1; (float)(k - 1) < r->n; k++) {
		const float b = step_end(r, k), fb = below(r, b);

		if (fb >= 0)
			return refine(r, params, a, fa, b, fb);
		a = b;
		fa = fb;
	}
	return -1;
}

static bool
is_hidden(const struct ray *r, float bias)
{
	if (!(r->t_end >= 0))
		return false;
	for (int k = 0; (float)(k - 1) < r->n; k++)
		if (below(r, step_end(r, k)) > bias)
			return true;
	return false;
}

void
bake_march_plain(const struct bake_relief_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays)
{
	for (int i = 0; i < rays->n; i++) {
		const struct ray r = get_ray(map, params, rays, i);

		rays->hit[i] = first_hit(&r, params);
	}
}

void
bake_march_any_plain(const struct bake_relief_map *map,
    const struct bake_march_params *params, float bias,
    const struct bake_rays *rays)
{
	for (int i = 0; i < rays->n; i++) {
		const struct ray r = get_ray(map, params, rays, i);

		rays->hit[i] = is_hidden(&r, bias) ? 1 : 0;
	}
}
