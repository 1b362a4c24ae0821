/* The renderer's parts: batches of fragments on their way to a tile. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_RENDER_PRIV_H
#define BAKE_RENDER_PRIV_H

#include <math.h>

#include "ao_rescale.h"
#include "render.h"

enum { RENDER_TILE = BAKE_RASTER_TILE * BAKE_RASTER_TILE };
/* fragments done together; a whole tile fits */
enum { RENDER_BATCH = RENDER_TILE };

/* kernels write whole vectors, at any place */
enum { RENDER_PADDED = RENDER_BATCH + 16 };

typedef float render_lane[RENDER_PADDED] __attribute__((aligned(64)));

struct render_kernels;

/*
 * Fragments of one object, of any of its triangles.
 *   index       of the sample in the tile
 *   distance    of the surface from the eye; after a hit, of the hit
 *   position    of the surface, world; dir: of the ray, unit
 *   t, b, n     the frame: unit tangent, bitangent, normal (out of the surface)
 *   jac         dP/du and dP/dv in (t, b): [u.t, u.b, v.t, v.b], of the
 *               repeated texture's u and v
 *   a, bb, c    the quadric
 *   rays        what is marched; u, v, z at the start
 * After marching:
 *   hit         rays.hit: length from the ray's start; < 0: a miss
 *   nx, ny, nz  normal in world space; ao; u_hit, v_hit, z_hit
 *   uo, vo      the object's own UVs at the hit, for its colour
 */
struct render_batch {
	const struct bake_render_object *object;
	int n;
	short index[RENDER_BATCH];
	int triangle[RENDER_BATCH];
	render_lane b1, b2;
	render_lane distance;
	render_lane position[3], dir[3];
	render_lane t[3], b[3], normal[3];
	render_lane jac[4];
	render_lane a, bb, c;
	render_lane u, v, z, du, dv, dz, q, t_end, hit;
	render_lane su, sv, sz, sdu, sdv, sdz, sq, st_end, shit; /* shadows */
	render_lane nx, ny, nz, ao, z_hit;
	render_lane cu, cv; /* of multilayer hits: the texel of their colour */
	render_lane lit;
	signed char back[RENDER_BATCH];
	signed char ground[RENDER_PADDED];
	const struct render_kernels *kernels;
	struct bake_rays rays, shadow;
};

/* The samples of a tile: what is nearest so far. */
struct render_tile {
	render_lane distance, color[3], normal[3], ao, u, v;
};

/* What a thread needs. */
struct render_worker {
	struct render_batch batch;
	struct render_tile tile;
};

/* A ray's change of u and v per unit of length, from its part (x, y) along the
 * frame: the inverse of the Jacobian. */
static inline void
bake_render_uv_step(
    const struct render_batch *b, int i, float x, float y, float *du, float *dv)
{
	const float ut = b->jac[0][i], ub = b->jac[1][i];
	const float vt = b->jac[2][i], vb = b->jac[3][i];
	const float det = ut * vb - vt * ub;

	*du = (x * vb - y * vt) / det;
	*dv = (y * ut - x * ub) / det;
}

/* A layer's v is v tile_v minus this: repeats begin at the top left, and v
 * grows upwards. */
static inline float
bake_render_offset_v(const struct bake_render_layer *l)
{
	return (float)(l->offset_v + l->tile_v - 1);
}

static inline float
bake_render_dot(render_lane v[3], int i, const float w[3])
{
	return v[0][i] * w[0] + v[1][i] * w[1] + v[2][i] * w[2];
}

/* Attributes of a triangle's fragments, appended; there is room for them. Of an
 * impostor mesh is the box, and the rest is made from that. */
void bake_render_append(struct render_batch *batch,
    const struct bake_render_object *object, const struct bake_mesh *mesh,
    const struct bake_fragments *f, const struct bake_camera_basis *camera);

/* The corners of a triangle, as floats; differences to corner 0. */
struct render_corners {
	float p[3], dp[2][3];
	float n[3][3], t[3][3];
	float ps[3][3], pt[3][3];
	float uv[3][2];
	float quadric[3][3];
	float hand;
};

/*
 * The arithmetic on whole batches, for one instruction set (render_kernel.c).
 *   place         from b1 and b2 of fragments from .. from + n - 1: position,
 *                 dir, frame, jac, u, v, a, bb, c
 *   aim           rays into height fields; ground: whether they end at the
 *                 bottom
 *   meet          from hit: u, v, z_hit there; where the bottom is met, hit
 *   look_up       what layers are like at u, v of the hits; the fragments move
 *                 there
 *   aim_at_light  shadow rays from the hits; lit: 0 where the light is behind
 *                 the surface, and the ray then is none
 */
struct render_kernels {
	void (*place)(struct render_batch *b, int from, int n,
	    struct render_corners *c, const struct bake_camera_basis *camera);
	void (*aim)(struct render_batch *b);
	void (*meet)(struct render_batch *b);
	void (*look_up)(struct render_batch *b);
	void (*aim_at_light)(
	    struct render_batch *b, const struct bake_render_light *light);
};
#define RENDER_DECLARE(isa)                                                    \
	void bake_render_place_##isa(struct render_batch *b, int from, int n,  \
	    struct render_corners *c, const struct bake_camera_basis *camera); \
	void bake_render_aim_##isa(struct render_batch *b);                    \
	void bake_render_meet_##isa(struct render_batch *b);                   \
	void bake_render_look_up_##isa(struct render_batch *b);                \
	void bake_render_aim_at_light_##isa(                                   \
	    struct render_batch *b, const struct bake_render_light *light);
RENDER_DECLARE(baseline)
RENDER_DECLARE(avx2)
RENDER_DECLARE(avx512)
const struct render_kernels *bake_render_pick_kernels(void);

/* Hits of the whole batch: rays are made, marched, normals and AO looked up. */
void bake_render_hit_plain(struct render_batch *batch);
void bake_render_hit_layers(
    struct render_batch *batch, const struct bake_render_params *params);
void bake_render_hit_shell(
    struct render_batch *batch, const struct bake_render_params *params);
void bake_render_hit_multi(
    struct render_batch *batch, const struct bake_render_params *params);

/* First hits of rays, or any, in the object's one layer or in the blend of its
 * layers. */
void bake_render_march_one(const struct bake_render_object *o,
    const struct bake_render_params *params, const struct bake_rays *rays);
void bake_render_march_one_any(const struct bake_render_object *o,
    const struct bake_render_params *params, float bias,
    const struct bake_rays *rays);
void bake_render_march_blend(const struct bake_render_object *o,
    const struct bake_render_params *params, const struct bake_rays *rays);
void bake_render_march_blend_any(const struct bake_render_object *o,
    const struct bake_render_params *params, float bias,
    const struct bake_rays *rays);

/* Shadow rays to the light: batch->lit is 1 or 0. */
void bake_render_shadow(
    struct render_batch *batch, const struct bake_render_params *params);

/* Shadows with a soft edge, from the horizons of one layer: batch->lit is the
 * part of a light of params->light.radius that stands above the horizon. */
void bake_render_soft_shadow(
    struct render_batch *batch, const struct bake_render_params *params);

/* Colours of the hits into the tile, where they are nearer. */
void bake_render_shade(struct render_batch *batch,
    const struct bake_render_params *params, struct render_tile *tile);

/* The direction to the light from a hit, unit. */
void bake_render_to_light(const struct bake_render_params *params,
    const float position[3], float l[3]);

/* Bilinear lookup of nchans channels at (u, v), v up. */
void bake_render_lookup(const struct bake_image *img, struct bake_wrap wrap,
    float u, float v, int nchans, float *out);

#endif
