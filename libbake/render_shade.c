/* The renderer: light on what was hit. */
/* SPDX-License-Identifier: MIT */
#include "render_priv.h"

void
bake_render_to_light(const struct bake_render_params *params,
    const float position[3], float l[3])
{
	const struct bake_render_light *light = &params->light;
	float length2 = 0;

	for (int k = 0; k < 3; k++) {
		l[k] = (float)light->at[k] - (light->point ? position[k] : 0);
		length2 += l[k] * l[k];
	}
	length2 = 1 / sqrtf(length2 > 0 ? length2 : 1);
	for (int k = 0; k < 3; k++)
		l[k] *= length2;
}

/* x^n by squaring: the same bits on every machine, unlike powf. */
static float
power(float x, int n)
{
	float p = 1;

	for (; n > 0; n >>= 1) {
		if (n & 1)
			p *= x;
		x *= x;
	}
	return p;
}

/* The quadric at hit i as a colour. */
static void
paint(const struct render_batch *b, int i, float albedo[3])
{
	const enum bake_render_paint p = b->object->paint;
	const float value = (p != BAKE_RENDER_PAINT_B ? b->a[i] : 0) +
			    (p != BAKE_RENDER_PAINT_A ? b->bb[i] : 0);
	float x = value / (float)b->object->paint_scale;

	x = x < -1 ? -1 : x > 1 ? 1 : x;
	albedo[0] = x < 0 ? 1 + 0.95F * x : 1 - 0.2F * x;
	albedo[1] = 1 - 0.85F * (x < 0 ? -x : x);
	albedo[2] = x < 0 ? 1 + 0.2F * x : 1 - 0.95F * x;
}

/* The material's colour at hit i. */
static void
albedo_of(const struct render_batch *b, int i,
    const struct bake_render_material *m, float albedo[3])
{
	const bool multi = b->object->multi != NULL;
	const float u = multi ? b->cu[i] : b->u[i];
	const float v = multi ? b->cv[i] : b->v[i];
	float texel[3] = { 1, 1, 1 };

	if (b->object->paint != BAKE_RENDER_PAINT_NONE) {
		paint(b, i, albedo);
		return;
	}
	if (m->color != NULL)
		bake_render_lookup(m->color, m->color_wrap,
		    u * (float)m->color_tile_u, v * (float)m->color_tile_v, 3,
		    texel);
	for (int k = 0; k < 3; k++)
		albedo[k] = m->base[k] * texel[k];
}

/* How much of the light a surface of that colour gives back where it falls in
 * at cos: Lambert's law, or the 2 1/2 D remap of the texture's luminance. */
static float
diffuse_of(
    const struct bake_render_material *m, const float albedo[3], float cosine)
{
	double luminance, sine;

	if (m->roughen == NULL || cosine <= 0)
		return cosine > 0 ? cosine : 0;
	luminance = 0.2126 * (double)albedo[0] + 0.7152 * (double)albedo[1] +
		    0.0722 * (double)albedo[2];
	sine = 1 - (double)cosine * (double)cosine;
	return (float)bake_roughen_gain(
	    m->roughen, luminance, (double)cosine, sqrt(sine > 0 ? sine : 0));
}

static void
shade(const struct render_batch *b, int i,
    const struct bake_render_params *params, float color[3])
{
	const struct bake_render_material *m =
	    b->ground[i] == 2 ? b->object->ground : &b->object->material;
	const float at[3] = { b->position[0][i], b->position[1][i],
		b->position[2][i] };
	const float n[3] = { b->nx[i], b->ny[i], b->nz[i] };
	float l[3], h[3], albedo[3], cosine = 0, length2 = 0, gloss = 0;
	float ao = params->ao ? b->ao[i] : 1, diffuse;

	albedo_of(b, i, m, albedo);
	bake_render_to_light(params, at, l);
	for (int k = 0; k < 3; k++) {
		h[k] = l[k] - b->dir[k][i];
		cosine += n[k] * l[k];
		length2 += h[k] * h[k];
	}
	diffuse = b->lit[i] * diffuse_of(m, albedo, cosine);
	if (m->specular > 0 && cosine > 0 && length2 > 0) {
		for (int k = 0; k < 3; k++)
			gloss += n[k] * h[k];
		gloss /= sqrtf(length2);
		gloss = gloss > 0 ? b->lit[i] * m->specular *
					power(gloss, m->shininess)
				  : 0;
	}
	for (int k = 0; k < 3; k++)
		color[k] = albedo[k] * (params->ambient[k] * ao +
					   params->light.color[k] * diffuse) +
			   params->light.color[k] * gloss;
}

void
bake_render_shade(struct render_batch *b,
    const struct bake_render_params *params, struct render_tile *tile)
{
	for (int i = 0; i < b->n; i++) {
		const int s = b->index[i];
		float color[3];

		/* as the one before in the same place: the first wins a tie */
		if (b->hit[i] < 0 || !(b->distance[i] < tile->distance[s]))
			continue;
		shade(b, i, params, color);
		tile->distance[s] = b->distance[i];
		for (int k = 0; k < 3; k++)
			tile->color[k][s] = color[k];
		tile->normal[0][s] = b->nx[i];
		tile->normal[1][s] = b->ny[i];
		tile->normal[2][s] = b->nz[i];
		tile->ao[s] = b->ao[i];
		tile->u[s] = b->u[i];
		tile->v[s] = b->v[i];
	}
}
