/* The renderer: marching one layer, or the blend of several as it goes. */
/* SPDX-License-Identifier: MIT */
#include "render_priv.h"

/* -- one layer ---------------------------------------------------------------
 */

/* Rays in the layer's own repeats; place turns them, and back. */
static void
place(const struct bake_render_layer *l, const struct bake_rays *r)
{
	const float tu = (float)l->tile_u, tv = (float)l->tile_v;
	const float ou = (float)l->offset_u, ov = bake_render_offset_v(l);

	for (int i = 0; i < r->n; i++) {
		r->u[i] = r->u[i] * tu - ou;
		r->v[i] = r->v[i] * tv - ov;
		r->du[i] *= tu;
		r->dv[i] *= tv;
	}
}

static void
put_back(const struct bake_render_layer *l, const struct bake_rays *r)
{
	const float tu = (float)l->tile_u, tv = (float)l->tile_v;
	const float ou = (float)l->offset_u, ov = bake_render_offset_v(l);

	for (int i = 0; i < r->n; i++) {
		r->u[i] = (r->u[i] + ou) / tu;
		r->v[i] = (r->v[i] + ov) / tv;
		r->du[i] /= tu;
		r->dv[i] /= tv;
	}
}

static bool
is_placed(const struct bake_render_layer *l)
{
	return l->tile_u == 1 && l->tile_v == 1 && l->offset_u == 0 &&
	       l->offset_v == 0;
}

void
bake_render_march_one(const struct bake_render_object *o,
    const struct bake_render_params *params, const struct bake_rays *rays)
{
	const struct bake_render_layer *l = &o->layers[0];

	if (!is_placed(l))
		place(l, rays);
	bake_march(l->map, &params->march, rays);
	if (!is_placed(l))
		put_back(l, rays);
}

void
bake_render_march_one_any(const struct bake_render_object *o,
    const struct bake_render_params *params, float bias,
    const struct bake_rays *rays)
{
	const struct bake_render_layer *l = &o->layers[0];

	if (!is_placed(l))
		place(l, rays);
	bake_march_any(l->map, &params->march, bias, rays);
	if (!is_placed(l))
		put_back(l, rays);
}

/* -- several -----------------------------------------------------------------
 */

/* Scratch of a search: places, and depths there. */
struct probe {
	render_lane t, u, v, lu, lv, d, sum;
};

/* d of the blend at t of each ray into p->sum. */
static void
sample(const struct bake_render_object *o, const struct bake_rays *r,
    struct probe *p)
{
	double total = 0;

	for (int k = 0; k < o->nlayers; k++)
		total += o->layers[k].depth_weight;
	for (int i = 0; i < r->n; i++) {
		p->u[i] = r->u[i] + p->t[i] * r->du[i];
		p->v[i] = r->v[i] + p->t[i] * r->dv[i];
		p->sum[i] = 0;
	}
	for (int k = 0; k < o->nlayers; k++) {
		const struct bake_render_layer *l = &o->layers[k];
		const float w = (float)(l->depth_weight / total);
		const float tu = (float)l->tile_u, tv = (float)l->tile_v;
		const float ou = (float)l->offset_u,
			    ov = bake_render_offset_v(l);

		for (int i = 0; i < r->n; i++) {
			p->lu[i] = p->u[i] * tu - ou;
			p->lv[i] = p->v[i] * tv - ov;
		}
		bake_relief_map_sample(l->map, r->n, p->lu, p->lv, p->d);
		for (int i = 0; i < r->n; i++)
			p->sum[i] += w * p->d[i];
	}
}

static float
z_at(const struct bake_rays *r, int i, float t)
{
	return r->z[i] + t * (r->dz[i] - t * r->q[i]);
}

/* How many steps: as many as asked for, and for TEXEL and EXACT one for each
 * texel of the finest layer on the longest path (EXACT: 4). */
static int
count_steps(const struct bake_render_object *o,
    const struct bake_march_params *m, const struct bake_rays *r)
{
	float most = 0;

	if (m->search == BAKE_SEARCH_LINEAR)
		return m->nlinear;
	for (int k = 0; k < o->nlayers; k++) {
		const struct bake_render_layer *l = &o->layers[k];
		const float w = (float)(l->tile_u * l->texels->width);
		const float h = (float)(l->tile_v * l->texels->height);

		for (int i = 0; i < r->n; i++) {
			const float x = fabsf(r->du[i] * r->t_end[i]) * w;
			const float y = fabsf(r->dv[i] * r->t_end[i]) * h;

			most = x > most ? x : most;
			most = y > most ? y : most;
		}
	}
	most = (m->search == BAKE_SEARCH_EXACT ? 4 : 1) * most + 1;
	most = most < 65536 ? most : 65536;
	return (int)most > m->nlinear ? (int)most : m->nlinear;
}

/* lo and hi bracket the hit of rays whose found is set; halve them. */
static void
refine(const struct bake_render_object *o, const struct bake_march_params *m,
    const struct bake_rays *r, struct probe *p, float *lo, float *hi)
{
	render_lane d_lo, d_hi;

	for (int b = 0; b < m->nbinary; b++) {
		for (int i = 0; i < r->n; i++)
			p->t[i] = 0.5F * (lo[i] + hi[i]);
		sample(o, r, p);
		for (int i = 0; i < r->n; i++)
			if (z_at(r, i, p->t[i]) >= p->sum[i])
				hi[i] = p->t[i];
			else
				lo[i] = p->t[i];
	}
	if (!m->secant && m->search == BAKE_SEARCH_LINEAR)
		return;
	for (int side = 0; side < 2; side++) {
		float *d = side == 0 ? d_lo : d_hi;

		for (int i = 0; i < r->n; i++)
			p->t[i] = side == 0 ? lo[i] : hi[i];
		sample(o, r, p);
		for (int i = 0; i < r->n; i++)
			d[i] = z_at(r, i, p->t[i]) - p->sum[i];
	}
	for (int i = 0; i < r->n; i++) {
		const float f = d_hi[i] - d_lo[i];

		if (d_lo[i] < 0 && d_hi[i] >= 0 && f > 0)
			hi[i] = lo[i] - d_lo[i] * (hi[i] - lo[i]) / f;
	}
}

void
bake_render_march_blend(const struct bake_render_object *o,
    const struct bake_render_params *params, const struct bake_rays *r)
{
	const int steps = count_steps(o, &params->march, r);
	struct probe p;
	render_lane lo, hi;

	for (int i = 0; i < r->n; i++)
		r->hit[i] = -1;
	for (int s = 0; s <= steps; s++) {
		const float share = (float)s / (float)steps;

		for (int i = 0; i < r->n; i++)
			p.t[i] = share * r->t_end[i];
		sample(o, r, &p);
		for (int i = 0; i < r->n; i++) {
			if (r->hit[i] >= 0 || z_at(r, i, p.t[i]) < p.sum[i])
				continue;
			r->hit[i] = hi[i] = p.t[i];
			lo[i] = s == 0 ? 0
				       : (float)(s - 1) / (float)steps *
					     r->t_end[i];
		}
	}
	for (int i = 0; i < r->n; i++)
		if (r->hit[i] < 0)
			lo[i] = hi[i] = 0;
	refine(o, &params->march, r, &p, lo, hi);
	for (int i = 0; i < r->n; i++)
		if (r->hit[i] >= 0)
			r->hit[i] = hi[i];
}

void
bake_render_march_blend_any(const struct bake_render_object *o,
    const struct bake_render_params *params, float bias,
    const struct bake_rays *r)
{
	const int steps = count_steps(o, &params->march, r);
	struct probe p;

	for (int i = 0; i < r->n; i++)
		r->hit[i] = 0;
	for (int s = 1; s <= steps; s++) {
		const float share = (float)s / (float)steps;

		for (int i = 0; i < r->n; i++)
			p.t[i] = share * r->t_end[i];
		sample(o, r, &p);
		for (int i = 0; i < r->n; i++)
			if (z_at(r, i, p.t[i]) > p.sum[i] + bias)
				r->hit[i] = 1;
	}
}
