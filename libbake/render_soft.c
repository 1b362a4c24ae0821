/* The renderer: soft shadows from horizons. */
/* SPDX-License-Identifier: MIT */
#include "render_priv.h"

static const double two_pi = 6.28318530717958647692;

/* The horizon's tangent at hit i in the direction (x, y) of the texture,
 * between the two nearest of the directions that were baked. */
static float
horizon(const struct render_batch *b, int i, float x, float y)
{
	static const double right[3] = { 1, 0, 0 };
	const struct bake_render_object *o = b->object;
	const struct bake_render_layer *l = &o->layers[0];
	const double d[3] = { (double)x, (double)y, 0 };
	/* by sqrt and arithmetic alone: the same bits on every machine */
	const double angle = bake_angle_rad(right, d);
	const double turn = (y < 0 ? two_pi - angle : angle) / two_pi;
	const int n = o->horizons->nchans;
	const double at = turn * n;
	const int j = (int)at < n ? (int)at : n - 1;
	const float part = (float)(at - j);
	struct bake_image channel = *o->horizons;
	float tangent[2];

	for (int k = 0; k < 2; k++) {
		channel.data = o->horizons->data + (j + k) % n;
		bake_render_lookup(&channel, l->wrap,
		    b->u[i] * (float)l->tile_u - (float)l->offset_u,
		    b->v[i] * (float)l->tile_v - bake_render_offset_v(l), 1,
		    &tangent[k]);
	}
	return tangent[0] + part * (tangent[1] - tangent[0]);
}

void
bake_render_soft_shadow(
    struct render_batch *b, const struct bake_render_params *params)
{
	const float slope = (float)b->object->horizon_slope;
	const float radius = params->light.radius;

	for (int i = 0; i < b->n; i++) {
		const float at[3] = { b->position[0][i], b->position[1][i],
			b->position[2][i] };
		float l[3], x, y, up, flat, tangent, above;

		if (b->hit[i] < 0)
			continue;
		bake_render_to_light(params, at, l);
		x = bake_render_dot(b->t, i, l);
		y = bake_render_dot(b->b, i, l);
		up = bake_render_dot(b->normal, i, l);
		flat = sqrtf(x * x + y * y);
		tangent = flat > 0 ? slope * horizon(b, i, x, y) : 0;
		/* the sine of the light's elevation over the horizon */
		above = (up - flat * tangent) / sqrtf(1 + tangent * tangent);
		above = 0.5F + 0.5F * above / radius;
		b->lit[i] = above < 0 ? 0 : above > 1 ? 1 : above;
	}
}
