/* The renderer's arithmetic on batches, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#include "march_vec_priv.h"

#include <string.h>

#include "isa.h"
#include "render_priv.h"

/* Lanes are padded: what is beyond a batch's end may be written. */

/* Rays along the surface are taken to go down at least this much per unit of
 * length: they end somewhere. */
static const float steepest = 1e-3F;
/* Rays are followed a little beyond where z is 1, so that rounding does not
 * stop them short of a bottom there (march.h). */
static const float beyond = 1 + 1.0F / (1 << 20);

struct vec3 {
	vec_f x, y, z;
};

static inline vec_f
dot(struct vec3 a, struct vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vec3
scaled(struct vec3 a, vec_f k)
{
	return (struct vec3){ a.x * k, a.y * k, a.z * k };
}

/* a but where that is not above 0: 1 */
static inline vec_f
or_one(vec_f a)
{
	return vec_select(vec_gt(a, vec_set(0)), a, vec_set(1));
}

static inline struct vec3
unit(struct vec3 a)
{
	return scaled(a, vec_set(1) / vec_sqrt(or_one(dot(a, a))));
}

static inline struct vec3
load3(render_lane p[3], int i)
{
	return (struct vec3){ vec_load(p[0] + i), vec_load(p[1] + i),
		vec_load(p[2] + i) };
}

static inline void
store3(render_lane p[3], int i, struct vec3 v)
{
	vec_store(p[0] + i, v.x);
	vec_store(p[1] + i, v.y);
	vec_store(p[2] + i, v.z);
}

/* -- what fragments are on the surface ---------------------------------------
 */

/* The weights of the corners. */
struct weights {
	vec_f w[3];
};

static inline vec_f
mix(const struct weights *w, float a, float b, float c)
{
	return w->w[0] * vec_set(a) + w->w[1] * vec_set(b) +
	       w->w[2] * vec_set(c);
}

static inline struct vec3
mix3(const struct weights *w, float v[3][3])
{
	return (struct vec3){ mix(w, v[0][0], v[1][0], v[2][0]),
		mix(w, v[0][1], v[1][1], v[2][1]),
		mix(w, v[0][2], v[1][2], v[2][2]) };
}

/* The frame: orthonormal, with the Jacobian of the texture. */
static inline void
put_frame(struct render_batch *b, int i, struct render_corners *c,
    const struct weights *w)
{
	const struct vec3 n = unit(mix3(w, c->n));
	const struct vec3 ps = mix3(w, c->ps), pt = mix3(w, c->pt);
	const vec_f hand = vec_set(c->hand);
	struct vec3 t = mix3(w, c->t), bt;
	const vec_f along = dot(t, n);

	t = unit((struct vec3){
	    t.x - along * n.x, t.y - along * n.y, t.z - along * n.z });
	bt = scaled((struct vec3){ n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z,
			n.x * t.y - n.y * t.x },
	    hand);
	store3(b->normal, i, n);
	store3(b->t, i, t);
	store3(b->b, i, bt);
	vec_store(b->jac[0] + i, dot(ps, t));
	vec_store(b->jac[1] + i, dot(ps, bt));
	vec_store(b->jac[2] + i, dot(pt, t));
	vec_store(b->jac[3] + i, dot(pt, bt));
}

static inline void
put_place(struct render_batch *b, int i, const struct render_corners *c,
    const struct weights *w, const struct bake_camera_basis *camera)
{
	struct vec3 p, d;
	vec_f *at[3] = { &p.x, &p.y, &p.z }, *to[3] = { &d.x, &d.y, &d.z };

	for (int k = 0; k < 3; k++) {
		*at[k] = vec_set(c->p[k]) + w->w[1] * vec_set(c->dp[0][k]) +
			 w->w[2] * vec_set(c->dp[1][k]);
		if (camera->orthographic)
			*to[k] = vec_set(-(float)camera->z[k]);
		else
			*to[k] = *at[k] - vec_set((float)camera->eye[k]);
	}
	store3(b->position, i, p);
	store3(b->dir, i, unit(d));
}

void
BAKE_KERNEL(bake_render_place)(struct render_batch *b, int from, int n,
    struct render_corners *c, const struct bake_camera_basis *camera)
{
	const bool impostor = b->object->impostor;
	const bool bent = b->object->quadrics != NULL;

	for (int i = from; i < from + n; i += VEC_LANES) {
		const vec_f b1 = vec_load(b->b1 + i), b2 = vec_load(b->b2 + i);
		const struct weights w = { { vec_set(1) - b1 - b2, b1, b2 } };
		float *const lanes[3] = { b->a + i, b->bb + i, b->c + i };

		put_place(b, i, c, &w, camera);
		if (impostor)
			continue;
		put_frame(b, i, c, &w);
		vec_store(
		    b->u + i, mix(&w, c->uv[0][0], c->uv[1][0], c->uv[2][0]));
		vec_store(
		    b->v + i, mix(&w, c->uv[0][1], c->uv[1][1], c->uv[2][1]));
		for (int k = 0; bent && k < 3; k++)
			vec_store(
			    lanes[k], mix(&w, c->quadric[0][k],
					  c->quadric[1][k], c->quadric[2][k]));
	}
}

/* -- rays --------------------------------------------------------------------
 */

/* A change of u and v from a step along the frame: bake_render_uv_step. */
static inline void
put_step(
    const struct render_batch *b, int i, vec_f x, vec_f y, float *du, float *dv)
{
	const vec_f ut = vec_load(b->jac[0] + i), ub = vec_load(b->jac[1] + i);
	const vec_f vt = vec_load(b->jac[2] + i), vb = vec_load(b->jac[3] + i);
	const vec_f det = ut * vb - vt * ub;

	vec_store(du + i, (x * vb - y * vt) / det);
	vec_store(dv + i, (y * ut - x * ub) / det);
}

/* Only then do batches have quadrics. */
static inline bool
is_bent(const struct bake_render_object *o)
{
	return o->silhouette == BAKE_SILHOUETTE_QUADRIC &&
	       o->quadrics != NULL && !o->impostor;
}

/* By how much the ground bends away along (x, y), over the depth. */
static inline vec_f
bend(const struct render_batch *b, int i, vec_f x, vec_f y, vec_f depth)
{
	return (vec_load(b->a + i) * x * x + vec_load(b->bb + i) * y * y +
		   vec_load(b->c + i) * x * y) /
	       depth;
}

void
BAKE_KERNEL(bake_render_aim)(struct render_batch *b)
{
	const struct bake_render_object *o = b->object;
	const bool bent = is_bent(o);
	const vec_f depth = vec_set((float)o->depth), zero = vec_set(0);

	for (int i = 0; i < b->n; i += VEC_LANES) {
		const struct vec3 d = load3(b->dir, i);
		const vec_f vx = dot(load3(b->t, i), d);
		const vec_f vy = dot(load3(b->b, i), d);
		const vec_f vz = zero - dot(load3(b->normal, i), d);
		vec_f dz = vz / depth, q = zero, t_end, disc;
		unsigned bottom = ~0U;

		put_step(b, i, vx, vy, b->du, b->dv);
		vec_store(
		    b->u + i, vec_load(b->u + i) * vec_set((float)o->tile_u));
		vec_store(
		    b->v + i, vec_load(b->v + i) * vec_set((float)o->tile_v));
		if (bent) {
			/* where z(t) = t dz - t^2 q reaches 1, or returns to 0
			 * before */
			const vec_m in = vec_gt(vz, zero);
			vec_m deep;

			q = bend(b, i, vx, vy, depth);
			disc = dz * dz - vec_set(4) * q;
			deep = vec_ge(disc, zero);
			t_end = vec_select(deep,
			    vec_set(2) / (dz + vec_sqrt(vec_max(disc, zero))),
			    dz / q);
			dz = vec_keep(in, dz);
			t_end = vec_keep(in, t_end);
			bottom = vec_bits(vec_and(in, deep));
		} else {
			dz = vec_max(vz, vec_set(steepest)) / depth;
			t_end = vec_set(beyond) / dz;
		}
		vec_store(b->z + i, zero);
		vec_store(b->q + i, q);
		vec_store(b->dz + i, dz);
		vec_store(b->t_end + i, t_end);
		for (int k = 0; k < VEC_LANES; k++)
			b->ground[i + k] = (signed char)(bottom >> k & 1);
	}
}

void
BAKE_KERNEL(bake_render_aim_at_light)(
    struct render_batch *b, const struct bake_render_light *light)
{
	const struct bake_render_object *o = b->object;
	const bool bent = is_bent(o);
	const vec_f depth = vec_set((float)o->depth), zero = vec_set(0);

	for (int i = 0; i < b->n; i += VEC_LANES) {
		const vec_m hit = vec_ge(vec_load(b->hit + i), zero);
		struct vec3 l = { vec_set((float)light->at[0]),
			vec_set((float)light->at[1]),
			vec_set((float)light->at[2]) };
		const vec_f z = vec_load(b->z_hit + i);
		vec_f lx, ly, lz, q = zero, disc;
		vec_m in;

		if (light->point) {
			const struct vec3 p = load3(b->position, i);

			l = (struct vec3){ l.x - p.x, l.y - p.y, l.z - p.z };
		}
		l = unit(l);
		lx = dot(load3(b->t, i), l);
		ly = dot(load3(b->b, i), l);
		lz = dot(load3(b->normal, i), l) / depth;
		put_step(b, i, lx, ly, b->sdu, b->sdv);
		if (bent)
			q = bend(b, i, lx, ly, depth);
		disc = lz * lz + vec_set(4) * q * z;
		/* the light is behind the surface otherwise */
		in =
		    vec_and(hit, vec_and(vec_gt(lz, zero), vec_gt(disc, zero)));
		vec_store(b->su + i, vec_load(b->u + i));
		vec_store(b->sv + i, vec_load(b->v + i));
		vec_store(b->sz + i, z);
		vec_store(b->sdz + i, zero - lz);
		vec_store(b->sq + i, q);
		vec_store(b->st_end + i,
		    vec_select(in,
			vec_set(2) * z / (lz + vec_sqrt(vec_max(disc, zero))),
			vec_set(-1)));
		vec_store(b->lit + i, vec_keep(in, vec_set(1)));
	}
}

/* -- what is met -------------------------------------------------------------
 */

/* Where to look a texture up: the texels on both sides, and how far between. */
struct places {
	float x0[VEC_LANES], x1[VEC_LANES], y0[VEC_LANES], y1[VEC_LANES];
	float ax[VEC_LANES], ay[VEC_LANES];
};

static inline void
put_sides(vec_f s, int size, bool clamped, float *lo, float *hi, float *share)
{
	const vec_f zero = vec_set(0), one = vec_set(1);
	const vec_f side = vec_set((float)size);
	vec_f x, first, second;

	if (!clamped)
		s = s - vec_floor(s);
	x = vec_min(vec_max(s, zero), one) * side - vec_set(0.5F);
	first = vec_floor(x);
	second = first + one;
	vec_store(share, x - first);
	if (clamped) {
		first = vec_max(first, zero);
		second = vec_min(second, side - one);
	} else {
		first = vec_select(vec_gt(zero, first), side - one, first);
		second = vec_select(vec_ge(second, side), zero, second);
	}
	vec_store(lo, first);
	vec_store(hi, second);
}

typedef float four __attribute__((vector_size(16)));

static inline four
texel(const float *p, float x)
{
	four v;

	memcpy(&v, p + 4 * (size_t)(int)x, sizeof v);
	return v;
}

/* The first three of four channels, bilinear, into the lanes of out. */
static inline void
look_up(const struct bake_image *img, struct bake_wrap wrap, vec_f u, vec_f v,
    vec_f out[3])
{
	struct places p;
	float c[3][VEC_LANES];

	put_sides(u, img->width, wrap.clamp_u, p.x0, p.x1, p.ax);
	put_sides(vec_set(1) - v, img->height, wrap.clamp_v, p.y0, p.y1, p.ay);
	for (int k = 0; k < VEC_LANES; k++) {
		const float *r0 =
		    img->data + (size_t)(int)p.y0[k] * img->row_stride;
		const float *r1 =
		    img->data + (size_t)(int)p.y1[k] * img->row_stride;
		const float x = p.ax[k], y = p.ay[k];
		const four ax = { x, x, x, x }, ay = { y, y, y, y };
		const four a = texel(r0, p.x0[k]), d = texel(r1, p.x0[k]);
		const four top = a + ax * (texel(r0, p.x1[k]) - a);
		const four low = d + ax * (texel(r1, p.x1[k]) - d);
		const four all = top + ay * (low - top);

		for (int j = 0; j < 3; j++)
			c[j][k] = all[j];
	}
	for (int j = 0; j < 3; j++)
		out[j] = vec_load(c[j]);
}

/* Sums over the layers at hits. */
struct blended {
	struct vec3 n;
	vec_f ao;
};

static inline vec_f
rescale(const struct bake_render_layer *l, vec_f ao)
{
	float v[VEC_LANES];

	if (l->ao_scale == 1)
		return ao;
	vec_store(v, ao);
	for (int k = 0; k < VEC_LANES; k++)
		v[k] = bake_ao_rescale(v[k], l->ao_scale);
	return vec_load(v);
}

static inline void
add_layer(struct blended *s, const struct bake_render_object *o,
    const struct bake_render_layer *l, vec_f u, vec_f v)
{
	const vec_f zero = vec_set(0), slope = vec_set((float)l->slope);
	vec_f t[3], nz2, ao;

	look_up(l->texels, l->wrap,
	    u * vec_set((float)l->tile_u) - vec_set((float)l->offset_u),
	    v * vec_set((float)l->tile_v) - vec_set(bake_render_offset_v(l)),
	    t);
	nz2 = vec_max(vec_set(1) - t[0] * t[0] - t[1] * t[1], zero);
	if (o->nlayers > 1 && o->blend == BAKE_RENDER_PD) {
		/* slopes add; z stays 1 */
		const vec_f w =
		    slope / vec_max(vec_sqrt(nz2), vec_set(1.0F / 256));

		s->n.x = s->n.x + w * t[0];
		s->n.y = s->n.y + w * t[1];
		s->n.z = vec_set(1);
	} else {
		/* slopes k times as steep, then a unit normal again */
		const vec_f x = slope * t[0], y = slope * t[1];
		const vec_f r = vec_set((float)l->normal_weight) /
				vec_sqrt(or_one(x * x + y * y + nz2));

		s->n.x = s->n.x + r * x;
		s->n.y = s->n.y + r * y;
		s->n.z = s->n.z + r * vec_sqrt(nz2);
	}
	ao = rescale(l, t[2]);
	if (o->ao_min)
		s->ao = vec_min(ao, s->ao);
	else
		s->ao = s->ao * ao;
}

/* The normal of the bent ground at the hit, in the fragment's frame: that of
 * z = a x^2 + b y^2 + c x y. */
static inline struct vec3
bent_normal(
    const struct render_batch *b, int i, struct vec3 n, vec_f x, vec_f y)
{
	const vec_f two = vec_set(2), c = vec_load(b->c + i);
	const vec_f gx = two * vec_load(b->a + i) * x + c * y;
	const vec_f gy = two * vec_load(b->bb + i) * y + c * x;

	return (struct vec3){ n.x + gx * n.z, n.y + gy * n.z, n.z };
}

void
BAKE_KERNEL(bake_render_look_up)(struct render_batch *b)
{
	const struct bake_render_object *o = b->object;
	const bool bent = is_bent(o);
	const vec_f zero = vec_set(0), one = vec_set(1);

	for (int i = 0; i < b->n; i += VEC_LANES) {
		const vec_f hit = vec_load(b->hit + i);
		const vec_f t = vec_keep(vec_ge(hit, zero), hit);
		const vec_f u = vec_load(b->u + i), v = vec_load(b->v + i);
		const struct vec3 tangent = load3(b->t, i);
		const struct vec3 side = load3(b->b, i);
		const struct vec3 up = load3(b->normal, i);
		const struct vec3 d = load3(b->dir, i);
		const struct vec3 p = load3(b->position, i);
		struct blended s = { { zero, zero, zero }, one };
		struct vec3 n;

		for (int k = 0; k < o->nlayers; k++)
			add_layer(&s, o, &o->layers[k], u, v);
		n = s.n;
		if (bent)
			n = bent_normal(
			    b, i, n, t * dot(tangent, d), t * dot(side, d));
		n = unit(
		    (struct vec3){ n.x * tangent.x + n.y * side.x + n.z * up.x,
			n.x * tangent.y + n.y * side.y + n.z * up.y,
			n.x * tangent.z + n.y * side.z + n.z * up.z });
		vec_store(b->nx + i, n.x);
		vec_store(b->ny + i, n.y);
		vec_store(b->nz + i, n.z);
		vec_store(b->ao + i, s.ao);
		vec_store(b->distance + i, vec_load(b->distance + i) + t);
		store3(b->position, i,
		    (struct vec3){
			p.x + t * d.x, p.y + t * d.y, p.z + t * d.z });
	}
}

void
BAKE_KERNEL(bake_render_meet)(struct render_batch *b)
{
	const vec_f zero = vec_set(0);

	/* the bottom is always there */
	for (int i = 0; i < b->n; i++)
		if (b->hit[i] < 0 && b->ground[i])
			b->hit[i] = b->t_end[i];
	for (int i = 0; i < b->n; i += VEC_LANES) {
		const vec_f hit = vec_load(b->hit + i);
		const vec_f t = vec_keep(vec_ge(hit, zero), hit);

		vec_store(
		    b->u + i, vec_load(b->u + i) + t * vec_load(b->du + i));
		vec_store(
		    b->v + i, vec_load(b->v + i) + t * vec_load(b->dv + i));
		vec_store(b->z_hit + i,
		    vec_load(b->z + i) +
			t * (vec_load(b->dz + i) - t * vec_load(b->q + i)));
	}
}
