/* Meta-relief textures: layers of relief, blended into one. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_COMBINE_H
#define BAKE_COMBINE_H

#include "ao.h"
#include "image.h"
#include "normal.h"
#include "resample.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * How the layers' normals n_i become one. w_i is layer i's normal weight, k_i
 * its repeats in the result (k_u along u, k_v along v), S_i and S the depth
 * scales of the layer and of the result, p_i = -n_i.xy / n_i.z its slopes.
 *   SEED        n = sum w_i n_i / sum w_i, as printed (eq. 1), made unit
 *   PD          slopes S / sum w * sum w_i k_i p_i / S_i: the normals of the
 *               blended depth
 *   RNM, UDN, WHITEOUT
 *               with a_i the normal of slopes w_i k_i p_i, folded from the
 *               first layer to the last, made unit after each step:
 *               RNM       t = a + (0, 0, 1), u = b (-1, -1, 1),
 *                         t (t . u) / t.z - u
 *               UDN       (a.x + b.x, a.y + b.y, a.z)
 *               WHITEOUT  (a.x + b.x, a.y + b.y, a.z b.z)
 *   FROM_DEPTH  bake_normal_from_depth of the blended depth at S
 * Only PD and FROM_DEPTH know the depth scales.
 */
enum bake_normal_blend {
	BAKE_NORMAL_SEED,
	BAKE_NORMAL_PD,
	BAKE_NORMAL_RNM,
	BAKE_NORMAL_UDN,
	BAKE_NORMAL_WHITEOUT,
	BAKE_NORMAL_FROM_DEPTH
};

/* The layers' occlusion: their product, the smallest, or (BAKE) that of the
 * blended depth at S, by bake_ao. */
enum bake_ao_blend { BAKE_AO_MULTIPLY, BAKE_AO_MIN, BAKE_AO_BAKE };

/* Where a layer lies in the result: it is repeated tile times from the upper
 * left corner on, then moved to the right and up by offset repeats. */
struct bake_placement {
	double tile_u, tile_v;     /* repeats over the result, > 0 */
	double offset_u, offset_v; /* in repeats, finite */
};

struct bake_combine_layer {
	double normal_weight, depth_weight; /* >= 0; both 0: no such layer */
	struct bake_placement place;
	double depth_scale; /* S_i, in widths of the layer, > 0 */
	double ao_scale;    /* that its AO belongs to; 0: S_i too */
};

struct bake_combine_params {
	int width, height;   /* of the result, texels */
	double depth_scale;  /* S, in widths of the result, > 0 */
	double normal_total; /* sum of the layers' normal weights */
	double depth_total;  /* sum of their depth weights, > 0 */
	int nnormals;        /* layers of a normal weight above 0; where it is
			      * 1, that layer's codes can be kept */
	enum bake_normal_blend normal_blend;
	enum bake_ao_blend ao_blend;
	bool ao_rescale; /* eq. 6 on each layer's AO first, s as below */
	enum bake_filter filter;
	struct bake_wrap wrap;    /* of the result */
	enum bake_slope_op slope; /* of FROM_DEPTH */
	struct bake_ao_params ao; /* of BAKE; wrap and nthreads are set here */
	int nthreads;             /* 0 = all processors */
};
#define BAKE_COMBINE_PARAMS_DEFAULT                                            \
	{                                                                      \
		.filter = BAKE_FILTER_CATMULL_ROM,                             \
		.ao = BAKE_AO_PARAMS_DEFAULT                                   \
	}

/*
 * The blend, one layer at a time, so that one alone is in memory.
 *
 *     struct bake_combine *c;
 *     bake_combine_open(&c, &params, &err);
 *     for each layer, the base first:
 *             bake_combine_add(c, &layer, &image, &scales, &err);
 *     bake_combine_finish(c, &maps, &err);
 *     bake_combine_close(c);
 *
 * Memory: 20 bytes a texel of the result. Adding a layer takes an image of 16
 * bytes for the result's width by the layer's height more, but what 64 rows of
 * the result need of it at most where that is more than BAKE_RESAMPLE_WHOLE, or
 * nothing where its texels are those of the result; BAKE what bake_ao takes.
 *
 * Depth is sum w_d d_i / sum w_d (eq. 2).
 *
 * BAKE_EINVAL  a parameter out of its range: a size below 1, no depth weight,
 *              no normal weight (unless FROM_DEPTH), a scale that is not above
 *              0 or not finite, an unknown blend
 * BAKE_ENOMEM  no memory; on any failure *c is NULL
 */
struct bake_combine;
BAKE_API enum bake_status bake_combine_open(struct bake_combine **c,
    const struct bake_combine_params *params, struct bake_err *err);

/* What the blend makes of a layer's relief. */
struct bake_layer_scales {
	/* S w k / (S_i sum w), w the depth weight: the layer's relief in the
	 * result has s times its own slopes. The s of eq. 6. */
	double s;
	/* S_i sum w / (w k): at this depth scale of the result the layer has
	 * its own slopes. Infinite where it gives no depth. */
	double keep;
};

/*
 * The two scales. Where the layer's texels are not square in the result, k is
 * the geometric mean of k_u = tile_u and
 *     k_v = tile_v (layer's height / width) / (result's height / width).
 * width and height are the layer's, texels. Reentrant, cannot fail.
 */
BAKE_API struct bake_layer_scales bake_combine_scales(
    const struct bake_combine_params *params,
    const struct bake_combine_layer *layer, int width, int height);

/*
 * Add a layer. Its texel (u, v), in repeats, lies at u = x tile_u - offset_u
 * and, with y from the top, v = y tile_v + offset_v.
 *
 *   maps  the layer's texels, 4 channels: normal x and y as unsigned codes
 *         (n = 2c - 1, y up; z = sqrt(max(0, 1 - x^2 - y^2))), AO, depth (0 =
 *         on the surface). Finite. Used up: what it holds then is unspecified
 *   err   reason on failure; never NULL
 *
 * Where every texel of the result is one of the layer's (tile times size is
 * the result's size, at an offset of whole texels), its values enter the sums
 * as they are; a layer that is alone comes out bit for bit, whatever its data
 * format, but where PD, RNM, UDN or WHITEOUT change its slopes.
 *
 * Else they are resampled, on a torus (on a clamped axis of the result that
 * the layer covers once, clamped). Normals are filtered as (x, y) / (1 + z),
 * the tangent of half their angle to the vertical, and so stay of unit length.
 * Of the ways to do it this one came nearest to the normals of the filtered
 * depth on measured materials, reduced 2 to 8 times: means of unit vectors are
 * up to 1.8 degrees further (being too flat beside steps), means of slopes up
 * to 13 (one steep texel outweighs all others). AO is rescaled, by s S_i / its
 * own scale, before it is filtered. No channel leaves the layer's own range.
 *
 * PD limits slopes to 128, what 16-bit x and y can tell from vertical.
 *
 * BAKE_EINVAL  maps has other than 4 channels, a weight below 0, a tile
 *              factor that is not above 0, an infinite number, a tile factor
 *              that the resampler refuses
 * BAKE_ENOMEM  no memory; after any failure the sums are of no use
 */
BAKE_API enum bake_status bake_combine_add(struct bake_combine *c,
    const struct bake_combine_layer *layer, struct bake_image *maps,
    struct bake_err *err);

/* The result: each of the size asked for, the caller's to free. */
struct bake_combined {
	struct bake_image normal; /* x, y, z as unsigned codes, y up */
	struct bake_image ao;     /* 1 channel */
	struct bake_image depth;  /* 1 channel */
};
#define BAKE_COMBINED_INIT                                                     \
	{                                                                      \
		BAKE_IMAGE_INIT, BAKE_IMAGE_INIT, BAKE_IMAGE_INIT              \
	}

/*
 * The blend of what was added; call it once. Where the sum of SEED is 0 the
 * normal is (0, 0, 1). z is sqrt(1 - x^2 - y^2) of the x and y given.
 *
 *   out  out: BAKE_COMBINED_INIT before; on failure still
 *
 * BAKE_ENOMEM  no memory
 *
 * All of this gives the same bytes for every thread count.
 * Source: Limberger, Schetinger, Oliveira, "Meta-Relief Texture Mapping with
 * Dynamic Texture-Space Ambient Occlusion", eq. 1 and 2; Barre-Brisebois and
 * Hill, "Blending in Detail", 2012, for PD, RNM, UDN and WHITEOUT; the scales
 * are our own derivation: layer i's height w_i (1 - d_i) S / sum w, in result
 * widths, is k_i times as steep as in the layer's own width.
 */
BAKE_API enum bake_status bake_combine_finish(
    struct bake_combine *c, struct bake_combined *out, struct bake_err *err);

/*
 * The same row by row, without a second copy of the result: settle once, after
 * the last layer (the occlusion of BAKE is baked), then any rows as often as
 * they are wanted.
 *
 *   y                  the first row
 *   normal, ao, depth  out: images of the result's width and of some rows, of
 *                      3, 1 and 1 channels, the caller's; NULL: not wanted
 *
 * BAKE_EINVAL  the rows are not all in the result
 * BAKE_ENOMEM  no memory to bake
 */
BAKE_API enum bake_status bake_combine_settle(
    struct bake_combine *c, struct bake_err *err);
BAKE_API enum bake_status bake_combine_get(const struct bake_combine *c, int y,
    struct bake_image *normal, struct bake_image *ao, struct bake_image *depth,
    struct bake_err *err);

/* Free all; harmless on NULL. */
BAKE_API void bake_combine_close(struct bake_combine *c);
BAKE_API void bake_combined_free(struct bake_combined *maps);

/*
 * Add share times a map to a sum of maps, placed and resampled as a layer is:
 * the colour of a blend, in scene-linear light.
 *
 *   sum     3 or 4 channels, r g b and alpha, zero to begin with; any size
 *   map     grey, grey and alpha, rgb, or rgb and alpha; not modified. One
 *           without alpha is opaque
 *   share   the map's weight / the sum of weights, >= 0
 *   params  filter, wrap and nthreads alone are looked at
 *
 * BAKE_EINVAL  channels that do not fit, or as bake_combine_add
 * BAKE_ENOMEM  no memory
 */
BAKE_API enum bake_status bake_combine_add_map(struct bake_image *sum,
    const struct bake_image *map, const struct bake_placement *place,
    double share, const struct bake_combine_params *params,
    struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
