/* The renderer: rays through the curved shell, one by one. */
/* SPDX-License-Identifier: MIT */
#include "render_priv.h"

/* The normal of the shell at a hit: of its triangle's corners. */
static void
put_frame(struct render_batch *b, int i, const struct bake_shell_hit *hit)
{
	const struct bake_render_object *o = b->object;
	const double w[3] = { 1 - hit->b1 - hit->b2, hit->b1, hit->b2 };
	double n[3] = { 0, 0, 0 }, t[3] = { 0, 0, 0 }, along = 0, nn = 0,
	       tt = 0;
	float hand = 1;

	for (int k = 0; k < 3; k++) {
		const struct bake_frame *f =
		    &o->frames->frame[o->frames->frame_of[hit->triangle][k]];

		hand = (float)f->hand;
		for (int c = 0; c < 3; c++) {
			n[c] += w[k] * f->normal[c];
			t[c] += w[k] * f->tangent[c];
		}
	}
	for (int c = 0; c < 3; c++)
		nn += n[c] * n[c];
	nn = 1 / sqrt(nn > 0 ? nn : 1);
	for (int c = 0; c < 3; c++) {
		n[c] *= nn;
		along += n[c] * t[c];
	}
	for (int c = 0; c < 3; c++) {
		t[c] -= along * n[c];
		tt += t[c] * t[c];
	}
	tt = 1 / sqrt(tt > 0 ? tt : 1);
	for (int c = 0; c < 3; c++) {
		b->normal[c][i] = (float)n[c];
		b->t[c][i] = (float)(t[c] * tt);
	}
	for (int c = 0; c < 3; c++) {
		const int c1 = (c + 1) % 3, c2 = (c + 2) % 3;

		b->b[c][i] = hand * (b->normal[c1][i] * b->t[c2][i] -
					b->normal[c2][i] * b->t[c1][i]);
	}
}

/* Whether hits see the light. */
static void
put_shadows(struct render_batch *b, const struct bake_render_params *params,
    const struct bake_shell_hit *hits)
{
	const struct bake_render_object *o = b->object;

	for (int i = 0; i < b->n; i++) {
		const float at[3] = { b->position[0][i], b->position[1][i],
			b->position[2][i] };
		float l[3];
		double to[3];

		if (b->hit[i] < 0)
			continue;
		bake_render_to_light(params, at, l);
		for (int k = 0; k < 3; k++)
			to[k] = (double)l[k];
		if (bake_shell_march_any(
			o->shell, o->layers[0].map, &hits[i], to))
			b->lit[i] = 0;
	}
}

void
bake_render_hit_shell(
    struct render_batch *b, const struct bake_render_params *params)
{
	const struct bake_render_object *o = b->object;
	struct bake_shell_hit hits[RENDER_BATCH];

	for (int i = 0; i < b->n; i++) {
		struct bake_shell_hit *hit = &hits[i];
		double origin[3], dir[3];

		for (int k = 0; k < 3; k++) {
			origin[k] = (double)b->position[k][i];
			dir[k] = (double)b->dir[k][i];
		}
		bake_shell_march(o->shell, o->layers[0].map, b->triangle[i],
		    (double)b->b1[i], (double)b->b2[i], origin, dir, hit);
		b->hit[i] = (float)hit->t;
		b->lit[i] = 1;
		if (hit->t < 0)
			continue;
		put_frame(b, i, hit);
		b->u[i] = (float)hit->u;
		b->v[i] = (float)hit->v;
		b->z_hit[i] = (float)hit->z;
	}
	b->kernels->look_up(b);
	if (params->shadow != BAKE_SHADOW_NONE)
		put_shadows(b, params, hits);
}
