/* The renderer: rays into multilayer relief, on surfaces and in boxes. */
/* SPDX-License-Identifier: MIT */
#include "render_priv.h"

static const float steepest = 1e-3F;

/*
 * The ray of fragment i on a surface. Seen from the front it goes in at depth
 * 0; seen from behind it came through the relief before it met the surface: it
 * starts as far back as depth 1 and comes out at depth 0. Returns how far
 * before the surface it starts.
 */
static float
aim_at_surface(
    struct render_batch *b, int i, const struct bake_render_params *params)
{
	const struct bake_render_object *o = b->object;
	const float d[3] = { b->dir[0][i], b->dir[1][i], b->dir[2][i] };
	const float vx = bake_render_dot(b->t, i, d),
		    vy = bake_render_dot(b->b, i, d);
	const float vz = -bake_render_dot(b->normal, i, d);
	const bool bent =
	    o->silhouette == BAKE_SILHOUETTE_QUADRIC && o->quadrics != NULL;
	const float steep = fabsf(vz) > steepest ? fabsf(vz) : steepest;
	float depth = (float)o->depth, back, disc;

	if (params->depth_bias)
		depth *= 2 * steep - steep * steep;
	bake_render_uv_step(b, i, vx, vy, &b->du[i], &b->dv[i]);
	b->u[i] *= (float)o->tile_u;
	b->v[i] *= (float)o->tile_v;
	b->q[i] =
	    bent
		? (b->a[i] * vx * vx + b->bb[i] * vy * vy + b->c[i] * vx * vy) /
		      depth
		: 0;
	b->dz[i] = (vz < 0 ? -steep : steep) / depth;
	b->z[i] = 0;
	disc = b->dz[i] * b->dz[i] - 4 * b->q[i];
	b->ground[i] = (signed char)(disc >= 0);
	if (!b->back[i] && vz > 0) {
		b->t_end[i] = disc >= 0 ? 2 / (b->dz[i] + sqrtf(disc))
					: b->dz[i] / b->q[i];
		return 0;
	}
	/* z(-s) = 1, or the other place where it is 0 */
	back = disc >= 0 ? 2 / (sqrtf(disc) - b->dz[i]) : -b->dz[i] / b->q[i];
	b->u[i] -= back * b->du[i];
	b->v[i] -= back * b->dv[i];
	b->z[i] = -back * (b->dz[i] + back * b->q[i]);
	b->dz[i] += 2 * back * b->q[i];
	b->t_end[i] = back;
	b->ground[i] = 0;
	return back;
}

/* Through a box: both ends from its planes. */
static float
aim_through_box(struct render_batch *b, int i)
{
	const struct bake_render_object *o = b->object;
	float start[3], step[3], t_end = INFINITY;

	for (int k = 0; k < 3; k++) {
		const double *axis = o->box_axes[k];
		const double size = o->box[1][k] - o->box[0][k];
		double at = -o->box[0][k], along = 0;

		for (int c = 0; c < 3; c++) {
			at += axis[c] * (double)b->position[c][i];
			along += axis[c] * (double)b->dir[c][i];
		}
		start[k] = (float)(at / size);
		step[k] = (float)(along / size);
		start[k] = start[k] < 0 ? 0 : start[k] > 1 ? 1 : start[k];
		if (step[k] > 0)
			t_end = fminf(t_end, (1 - start[k]) / step[k]);
		else if (step[k] < 0)
			t_end = fminf(t_end, -start[k] / step[k]);
	}
	b->u[i] = start[0];
	b->v[i] = start[1];
	b->z[i] = 1 - start[2]; /* depth 0 is nearest to the view's eye */
	b->du[i] = step[0];
	b->dv[i] = step[1];
	b->dz[i] = -step[2];
	b->q[i] = 0;
	b->t_end[i] = t_end;
	b->ground[i] = 0;
	for (int k = 0; k < 3; k++) {
		b->t[k][i] = (float)o->box_axes[0][k];
		b->b[k][i] = (float)o->box_axes[1][k];
		b->normal[k][i] = (float)o->box_axes[2][k];
	}
	b->jac[0][i] = (float)(o->box[1][0] - o->box[0][0]);
	b->jac[3][i] = (float)(o->box[1][1] - o->box[0][1]);
	b->jac[1][i] = b->jac[2][i] = 0;
	return 0;
}

/* What hit i is like: position, normal in world space, the texel's UV. */
static void
put_hit(struct render_batch *b, int i, float back)
{
	const float t = b->hit[i];
	const float n[3] = { b->nx[i], b->ny[i], b->nz[i] };
	float world[3];

	b->z_hit[i] = b->z[i] + t * (b->dz[i] - t * b->q[i]);
	for (int k = 0; k < 3; k++) {
		b->position[k][i] += (t - back) * b->dir[k][i];
		world[k] = n[0] * b->t[k][i] + n[1] * b->b[k][i] +
			   n[2] * b->normal[k][i];
	}
	b->distance[i] += t - back;
	b->nx[i] = world[0];
	b->ny[i] = world[1];
	b->nz[i] = world[2];
	b->ao[i] = 1;
}

/* Where a ray missed but went through the bottom: plain ground there. */
static void
put_ground(struct render_batch *b, int i)
{
	b->hit[i] = b->t_end[i];
	b->u[i] += b->t_end[i] * b->du[i];
	b->v[i] += b->t_end[i] * b->dv[i];
	b->cu[i] = b->u[i];
	b->cv[i] = b->v[i];
	b->nx[i] = 0;
	b->ny[i] = 0;
	b->nz[i] = 1;
	put_hit(b, i, 0);
	b->ground[i] = 2;
}

void
bake_render_hit_multi(
    struct render_batch *b, const struct bake_render_params *params)
{
	const struct bake_render_object *o = b->object;
	const struct bake_multi_hits hits = { b->nx, b->ny, b->nz, NULL, b->cu,
		b->cv };
	render_lane back;

	for (int i = 0; i < b->n; i++)
		back[i] = o->impostor ? aim_through_box(b, i)
				      : aim_at_surface(b, i, params);
	b->rays.n = b->n;
	bake_multi_march(o->multi, &params->march, &b->rays, &hits);
	for (int i = 0; i < b->n; i++) {
		if (b->hit[i] >= 0) {
			b->u[i] += b->hit[i] * b->du[i];
			b->v[i] += b->hit[i] * b->dv[i];
			b->ground[i] = 0;
			put_hit(b, i, back[i]);
		} else if (o->ground != NULL && b->ground[i] != 0)
			put_ground(b, i);
	}
}
