/* Multilayer search ray by ray: what the kernels must agree with, bit by bit.
 */
/* SPDX-License-Identifier: MIT */
#include "multi_march_priv.h"

/* One ray, and the length and number of its steps. */
struct ray {
	const struct bake_multi_map *map;
	float u, v, z, du, dv, dz, q, t_end;
	float n, step;
};

static bool
is_inside(const struct ray *r, float t)
{
	const float z = r->z + t * (r->dz - t * r->q);
	const long texel =
	    bake_multi_texel(r->map, r->u + t * r->du, r->v + t * r->dv);

	return texel >= 0 && bake_multi_above(r->map, texel, z) % 2 != 0;
}

/* Texels passed along the faster axis, at least nlinear. */
static float
count_steps(const struct ray *r, const struct bake_march_params *params)
{
	const float least = (float)params->nlinear;
	const float x = fabsf(r->du) * (float)r->map->width;
	const float y = fabsf(r->dv) * (float)r->map->height;
	float n;

	if (params->search == BAKE_SEARCH_LINEAR)
		return least;
	n = ceilf((x > y ? x : y) * r->t_end);
	n = n > least ? n : least;
	return n < BAKE_MULTI_STEPS_MAX ? n : BAKE_MULTI_STEPS_MAX;
}

static struct ray
get_ray(const struct bake_multi_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays, int i)
{
	struct ray r = { map, rays->u[i], rays->v[i], rays->z[i], rays->du[i],
		rays->dv[i], rays->dz[i], rays->q[i], rays->t_end[i], 0, 0 };

	r.n = count_steps(&r, params);
	r.step = r.t_end / r.n;
	return r;
}

static float
step_end(const struct ray *r, int k)
{
	return (float)k >= r->n ? r->t_end : (float)k * r->step;
}

static float
first_hit(
    const struct ray *r, const struct bake_march_params *params, float *before)
{
	float a = 0, b;

	*before = 0;
	if (!(r->t_end >= 0))
		return -1;
	if (is_inside(r, 0))
		return 0;
	for (int k = 1; (float)(k - 1) < r->n; k++, a = b) {
		b = step_end(r, k);
		if (!is_inside(r, b))
			continue;
		for (int i = 0; i < params->nbinary; i++) {
			const float t = 0.5f * (a + b);

			*(is_inside(r, t) ? &b : &a) = t;
		}
		*before = a;
		return b;
	}
	return -1;
}

/* What the ray is inside of at `skip` does not count until it has left it. */
static bool
is_hidden(const struct ray *r, float skip)
{
	bool left = false;

	if (!(r->t_end >= 0))
		return false;
	for (int k = 0; (float)(k - 1) < r->n; k++) {
		const float t = step_end(r, k);

		if (!(t >= skip))
			continue;
		if (!is_inside(r, t))
			left = true;
		else if (left)
			return true;
	}
	return false;
}

void
bake_multi_search_plain(const struct bake_multi_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays,
    float *before)
{
	for (int i = 0; i < rays->n; i++) {
		const struct ray r = get_ray(map, params, rays, i);

		rays->hit[i] = first_hit(&r, params, &before[i]);
	}
}

void
bake_multi_any_plain(const struct bake_multi_map *map,
    const struct bake_march_params *params, float skip,
    const struct bake_rays *rays)
{
	for (int i = 0; i < rays->n; i++) {
		const struct ray r = get_ray(map, params, rays, i);

		rays->hit[i] = is_hidden(&r, skip) ? 1 : 0;
	}
}
