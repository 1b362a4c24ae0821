/* The renderer: what a triangle's fragments are on the surface. */
/* SPDX-License-Identifier: MIT */
#include "render_priv.h"

static void
to_floats(float *out, const double *in, int n)
{
	for (int i = 0; i < n; i++)
		out[i] = (float)in[i];
}

static void
load_corners(struct render_corners *c, const struct bake_render_object *o,
    const struct bake_mesh *mesh, int triangle)
{
	const struct bake_corner *corner = mesh->triangles[triangle];

	to_floats(c->p, mesh->positions[corner[0].v], 3);
	for (int k = 1; k < 3; k++) {
		const double *p = mesh->positions[corner[k].v];

		for (int i = 0; i < 3; i++)
			c->dp[k - 1][i] =
			    (float)(p[i] - mesh->positions[corner[0].v][i]);
	}
	for (int k = 0; k < 3 && !o->impostor; k++) {
		const int f = o->frames->frame_of[triangle][k];
		const struct bake_frame *frame = &o->frames->frame[f];

		to_floats(c->n[k], frame->normal, 3);
		to_floats(c->t[k], frame->tangent, 3);
		for (int i = 0; i < 3; i++) {
			c->ps[k][i] = (float)(frame->ps[i] / o->tile_u);
			c->pt[k][i] = (float)(frame->pt[i] / o->tile_v);
		}
		c->uv[k][0] = c->uv[k][1] = 0;
		if (corner[k].vt >= 0)
			to_floats(c->uv[k], mesh->uvs[corner[k].vt], 2);
		c->hand = (float)frame->hand;
		if (o->quadrics != NULL) {
			c->quadric[k][0] = (float)o->quadrics[f].a;
			c->quadric[k][1] = (float)o->quadrics[f].b;
			c->quadric[k][2] = (float)o->quadrics[f].c;
		} else
			c->quadric[k][0] = c->quadric[k][1] = c->quadric[k][2] =
			    0;
	}
}

void
bake_render_append(struct render_batch *batch,
    const struct bake_render_object *object, const struct bake_mesh *mesh,
    const struct bake_fragments *f, const struct bake_camera_basis *camera)
{
	struct render_corners c;

	load_corners(&c, object, mesh, f->triangle);
	batch->object = object;
	for (int k = 0; k < f->n; k++) {
		const int i = batch->n + k;

		batch->index[i] = f->index[k];
		batch->triangle[i] = f->triangle;
		batch->distance[i] = f->distance[k];
		batch->b1[i] = f->b1[k];
		batch->b2[i] = f->b2[k];
		batch->back[i] = (signed char)(f->back != 0);
	}
	batch->kernels->place(batch, batch->n, f->n, &c, camera);
	batch->n += f->n;
}
