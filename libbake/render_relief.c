/* The renderer: rays into height fields, and what they meet there. */
/* SPDX-License-Identifier: MIT */
#include "isa.h"
#include "render_priv.h"

/* How far below the map a shadow ray's start may be, in depth: what is left of
 * the last step of a search. */
static float
shadow_bias(const struct bake_march_params *m)
{
	return m->secant || m->search == BAKE_SEARCH_EXACT ? 1e-4F : 1e-3F;
}

void
bake_render_lookup(const struct bake_image *img, struct bake_wrap wrap, float u,
    float v, int nchans, float *out)
{
	const float x = u * (float)img->width - 0.5F;
	const float y = (1 - v) * (float)img->height - 0.5F;
	const float fx = floorf(x), fy = floorf(y);
	const float ax = x - fx, ay = y - fy;
	const int x0 = bake_wrap_index((long)fx, img->width, wrap.clamp_u);
	const int x1 = bake_wrap_index((long)fx + 1, img->width, wrap.clamp_u);
	const float *r0 = bake_image_row(
	    img, bake_wrap_index((long)fy, img->height, wrap.clamp_v));
	const float *r1 = bake_image_row(
	    img, bake_wrap_index((long)fy + 1, img->height, wrap.clamp_v));
	const int n = img->nchans;

	for (int c = 0; c < nchans; c++) {
		const float a = r0[x0 * n + c], b = r0[x1 * n + c];
		const float d = r1[x0 * n + c], e = r1[x1 * n + c];
		const float top = a + ax * (b - a), low = d + ax * (e - d);

		out[c] = top + ay * (low - top);
	}
}

/* -- hits --------------------------------------------------------------------
 */

void
bake_render_hit_plain(struct render_batch *b)
{
	for (int i = 0; i < b->n; i++) {
		const float sign = b->back[i] ? -1 : 1;

		b->hit[i] = 0;
		b->nx[i] = sign * b->normal[0][i];
		b->ny[i] = sign * b->normal[1][i];
		b->nz[i] = sign * b->normal[2][i];
		b->ao[i] = 1;
		b->z_hit[i] = 0;
		b->u[i] *= (float)b->object->tile_u;
		b->v[i] *= (float)b->object->tile_v;
	}
}

void
bake_render_hit_layers(
    struct render_batch *b, const struct bake_render_params *params)
{
	const struct bake_render_object *o = b->object;

	b->kernels->aim(b);
	b->rays.n = b->n;
	if (o->nlayers == 1)
		bake_render_march_one(o, params, &b->rays);
	else
		bake_render_march_blend(o, params, &b->rays);
	b->kernels->meet(b);
	b->kernels->look_up(b);
}

/* -- shadows -----------------------------------------------------------------
 */

/* Shadow rays on multilayer relief begin two texels on: nearest texels make
 * stairs of a slope, which would shade itself. */
static void
lift_off(struct render_batch *b)
{
	int width, height;

	bake_multi_map_size(b->object->multi, &width, &height);
	for (int i = 0; i < b->n; i++) {
		const float x = fabsf(b->sdu[i]) * (float)width;
		const float y = fabsf(b->sdv[i]) * (float)height;
		const float most = x > y ? x : y;
		float t = most > 0 ? 2 / most : 0;

		t = t < b->st_end[i] ? t : b->st_end[i];
		if (!(t > 0))
			continue;
		b->su[i] += t * b->sdu[i];
		b->sv[i] += t * b->sdv[i];
		b->sz[i] += t * (b->sdz[i] - t * b->sq[i]);
		b->sdz[i] -= 2 * t * b->sq[i];
		b->st_end[i] -= t;
	}
}

/* An impostor has no surface with the light behind it: each shadow ray leaves
 * the box, by whichever side. */
static void
aim_out_of_box(struct render_batch *b)
{
	const struct bake_render_object *o = b->object;
	const float deep = (float)(o->box[1][2] - o->box[0][2]);

	for (int i = 0; i < b->n; i++) {
		const float at[3] = { b->su[i], b->sv[i], b->sz[i] };
		float step[3] = { b->sdu[i], b->sdv[i], b->sdz[i] };
		float t = INFINITY;

		if (b->hit[i] < 0)
			continue;
		/* it was made for a relief of depth o->depth */
		step[2] *= (float)o->depth / deep;
		for (int k = 0; k < 3; k++)
			if (step[k] > 0)
				t = fminf(t, (1 - at[k]) / step[k]);
			else if (step[k] < 0)
				t = fminf(t, -at[k] / step[k]);
		b->sdz[i] = step[2];
		b->sq[i] = 0;
		b->st_end[i] = t > 0 ? t : 0;
		b->lit[i] = 1;
	}
}

void
bake_render_shadow(
    struct render_batch *b, const struct bake_render_params *params)
{
	const struct bake_render_object *o = b->object;
	const float bias = shadow_bias(&params->march);

	b->kernels->aim_at_light(b, &params->light);
	b->shadow.n = b->n;
	if (o->impostor)
		aim_out_of_box(b);
	if (o->multi != NULL) {
		lift_off(b);
		bake_multi_march_any(o->multi, &params->march, 0, &b->shadow);
	} else if (o->nlayers == 1)
		bake_render_march_one_any(o, params, bias, &b->shadow);
	else
		bake_render_march_blend_any(o, params, bias, &b->shadow);
	for (int i = 0; i < b->n; i++)
		if (b->st_end[i] >= 0 && b->shit[i] > 0)
			b->lit[i] = 0;
}

/* -- the kernels -------------------------------------------------------------
 */

#define KERNELS(isa)                                                           \
	{                                                                      \
		bake_render_place_##isa, bake_render_aim_##isa,                \
		    bake_render_meet_##isa, bake_render_look_up_##isa,         \
		    bake_render_aim_at_light_##isa                             \
	}

const struct render_kernels *
bake_render_pick_kernels(void)
{
#if defined(__x86_64__)
	static const struct render_kernels kernels[] = { KERNELS(baseline),
		KERNELS(avx2), KERNELS(avx512) };
#else
	static const struct render_kernels kernels[] = { KERNELS(baseline),
		KERNELS(baseline), KERNELS(baseline) };
#endif

	return &kernels[bake_isa_pick()];
}
