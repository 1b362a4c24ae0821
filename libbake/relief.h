/* The packed relief texture: layouts, targets, metadata. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_RELIEF_H
#define BAKE_RELIEF_H

#include <stdbool.h>
#include <stddef.h>

#include "attrs.h"
#include "conventions.h"
#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the channels of a file hold. */
enum bake_layout {
	BAKE_LAYOUT_UNKNOWN = 0,
	BAKE_LAYOUT_RELIEF,        /* R, G = normal x, y; B = AO; A = depth */
	BAKE_LAYOUT_NORMAL_RELIEF, /* R, G, B = normal; A = depth or height */
	BAKE_LAYOUT_NORMAL,        /* R, G, B = normal x, y, z */
	BAKE_LAYOUT_DEPTH, /* one channel, depth or height by the polarity */
	BAKE_LAYOUT_AO,    /* one channel, 1 = open */
	BAKE_LAYOUT_ORM,   /* R = AO, G = roughness, B = metallic */
	BAKE_LAYOUT_MASK, /* R = metallic, G = AO, B = detail, A = smoothness */
	BAKE_LAYOUT_BENT, /* R, G, B = bent normal x, y, z */
	BAKE_LAYOUT_HORIZONS,    /* tan of the horizon angle per direction */
	BAKE_LAYOUT_ROUGHEN_LUT, /* rm-roughen's remap, see bake_roughen_lut */
	/* of a multilayer set (see layer_maps.h): a layer a channel, */
	BAKE_LAYOUT_LAYER_DEPTH, /* its stored depth d', 1 = no layer */
	BAKE_LAYOUT_LAYER_NX,    /* its normal's x */
	BAKE_LAYOUT_LAYER_NY,    /* its normal's y */
	BAKE_LAYOUT_LAYER_COLOR, /* r g b or r g b a of one layer */
	BAKE_LAYOUT_LAYER_DEEP   /* all of these, a deep sample a layer */
};

/* "relief", "normal-relief", "normal" …; "unknown". Static text. */
BAKE_API const char *bake_layout_name(enum bake_layout layout);

/* Whether the layout is that of a texture of a multilayer set. */
BAKE_API bool bake_layout_is_layered(enum bake_layout layout);

enum { BAKE_LAYERS_SAID = 65536 };

/*
 * What the metadata of a multilayer texture say.
 *   nlayers    of the whole set, 1 .. BAKE_LAYERS_SAID; 0: it is no multilayer
 *              texture, or does not say, and nothing else counts
 *   texture    which of the ntextures of its kind the file is, 1 .. ntextures
 *              (colour: which layer's of how many); 0: not said, the only one
 *   zero, one  Z of the stored depths 0 and 1 in the mesh's unit: positions
 *              along the view's axis, which grow towards the eye (view.h), so
 *              that Z = zero + (one - zero) d'
 *   axis       the side of the mesh that is seen, "+x" .. "-z"; "": not said
 *   region     x0 y0 x1 y1 in the view's axes, mesh unit
 *   mip_level  0: the whole picture, or not said
 *   tau        the share of the box that a solid texel of that level has more
 *              than
 *   plane      the depth d of the polygon that an impostor is drawn on
 */
struct bake_layer_meta {
	int nlayers;
	int texture, ntextures;
	bool has_range, has_region, has_tau, has_plane;
	double zero, one;
	char axis[3];
	double region[4];
	int mip_level;
	double tau, plane;
};

/* Set zero and one from the range of real depths d of a view: near is the Z of
 * d = 0 and far that of d = 1, and d' = (1 + 253 d) / 255 is what is stored. */
BAKE_API void bake_layer_meta_set_range(
    struct bake_layer_meta *meta, double near, double far);
/* And back. */
BAKE_API void bake_layer_meta_range(
    const struct bake_layer_meta *meta, double *near, double *far);

enum { BAKE_KEEP_SCALES = 16 };

/* What the metadata of a relief map say; 0 or UNSURE = not said. */
struct bake_relief_meta {
	enum bake_layout layout;
	enum bake_polarity polarity;
	enum bake_normal_y normal_y;
	enum bake_normal_code normal_code;
	double depth_scale; /* depth range / texture width; 0: not said */
	bool has_wrap;
	struct bake_wrap wrap;
	/* the depth scale that the AO belongs to, where that is another one
	 * than the normals' */
	bool has_ao_scale;
	double ao_scale;
	/* of a blend: the depth scale at which each layer, the base first, has
	 * the relief of its own; infinite for one without depth */
	int nkeep; /* 0: not said */
	double keep_scale[BAKE_KEEP_SCALES];
	struct bake_layer_meta layer;
};
#define BAKE_RELIEF_META_INIT                                                  \
	{                                                                      \
		.layout = BAKE_LAYOUT_UNKNOWN                                  \
	}

/* Metadata to attributes (relief:Layout, Polarity, NormalY, NormalCode,
 * DepthScale, AOScale, Wrap, KeepScale) and back. What is not said is not
 * written; a value that is not understood reads as not said. KeepScale is text,
 * the numbers separated by commas, each with up to 6 digits, or as many as
 * there is room for.
 *
 * Of a multilayer texture, after the layout: Layers (a number), Texture
 * ("2/3"), DepthZero and DepthOne (text: decimals that are right to 1e-9 of
 * their difference), Axis, Region ("x0,y0,x1,y1", right to 1e-7 of its longer
 * side), MipLevel, Tau and Plane (numbers). All of them and the layout, NormalY
 * and DepthScale fit into the comment of a TGA file where coordinates have up
 * to 4 digits before the point. */
BAKE_API void bake_relief_meta_to_attrs(
    const struct bake_relief_meta *meta, struct bake_attrs *attrs);
BAKE_API void bake_relief_meta_from_attrs(
    struct bake_relief_meta *meta, const struct bake_attrs *attrs);

/* Say that the AO beside normals of meta->depth_scale is of `scale`, > 0: kept
 * apart where the two differ as floats. */
BAKE_API void bake_relief_meta_set_ao_scale(
    struct bake_relief_meta *meta, double scale);
/* The scale of the AO: its own, else depth_scale. */
BAKE_API double bake_relief_meta_ao_scale(const struct bake_relief_meta *meta);

/*
 * What the texels of a LAYER_DEPTH texture say.
 *   texels     by their number of layers, 0 .. 4
 *   odd        whose number of layers is odd: the solid is not closed there
 *              (not in a height field, which has 1 layer)
 *   unordered  whose depths do not strictly increase, or that have a layer
 *              after an empty channel
 *   outside    values that are no stored depth: below 1/255 or between 254/255
 *              and 1, beyond half a code (2^-11 for half and float); NaN
 *   min, max   of the stored depths of layers; NaN where there is none
 */
struct bake_layer_check {
	size_t texels[5];
	size_t odd, unordered, outside;
	double min, max;
};

/*
 * Look at img: rgba are the places of up to 4 layers in their order, nlayers
 * what the metadata say (1: a height field; 0: not said). code_max: 255, 65535,
 * or 0 for float. Reentrant, cannot fail.
 */
BAKE_API void bake_layer_check(const struct bake_image *img, const int rgba[4],
    int nlayers, int code_max, struct bake_layer_check *check);

/* Where a channel of an output comes from. */
enum bake_source {
	BAKE_SOURCE_NORMAL_X,
	BAKE_SOURCE_NORMAL_Y,
	BAKE_SOURCE_NORMAL_Z,
	BAKE_SOURCE_AO,
	BAKE_SOURCE_RELIEF, /* depth or height, as the target wants */
	BAKE_SOURCE_ZERO,
	BAKE_SOURCE_HALF,
	BAKE_SOURCE_ONE
};

enum { BAKE_TARGET_FILES = 3 };

/*
 * What one renderer reads: up to three files. The first is the output itself;
 * the others stand beside it, with suffix put before the extension. See
 * CONVENTIONS, 'Renderers', and rm-formats(5).
 */
struct bake_target {
	const char *name;
	const char *about;
	enum bake_polarity polarity;
	enum bake_normal_y normal_y;
	int nfiles;
	struct bake_target_file {
		const char *suffix; /* "" for the output itself */
		enum bake_layout layout;
		int nchans;
		enum bake_source source[4];
	} file[BAKE_TARGET_FILES];
};

/* The targets, "relief" first; *n is their number. Static. */
BAKE_API const struct bake_target *bake_targets(int *n);
/* The target of that name; NULL where there is none. */
BAKE_API const struct bake_target *bake_target_find(const char *name);

/*
 * Put one file of a target together from planes of codes as they are stored
 * (0 .. 1), so that a channel that needs no change keeps its bits.
 *
 *   file    whose channels to make
 *   normal  3 channels: stored x, y, z with y already as the target wants it
 *   ao      1 channel
 *   relief  1 channel, in the target's polarity
 *           each of them may be NULL where the file does not use it; all of
 *           one size
 *   out     out: BAKE_IMAGE_INIT before; the caller's to free
 *
 * BAKE_EINVAL  a plane that the file needs is NULL or has too few channels, or
 *              sizes differ
 * BAKE_ENOMEM  no memory
 */
BAKE_API enum bake_status bake_relief_pack(const struct bake_target_file *file,
    const struct bake_image *normal, const struct bake_image *ao,
    const struct bake_image *relief, struct bake_image *out,
    struct bake_err *err);

/* Mirror stored values of one channel: v := 1 - v, which turns depth into
 * height and normal y up into down, and maps code c to max - c exactly. */
BAKE_API void bake_relief_flip(struct bake_image *img, int chan);

/*
 * Stored normals to components -1 .. 1, in place, in the first three channels
 * (or the two that there are): n = 2c - 1 for the unsigned code (and AUTO),
 * n = c for the signed one. flip_y negates y.
 */
BAKE_API void bake_normal_decode(
    struct bake_image *img, enum bake_normal_code code, bool flip_y);
/* And back: c = (n + 1) / 2. */
BAKE_API void bake_normal_encode(struct bake_image *img, bool flip_y);

/*
 * Which code float normals are stored in: signed if an x or y is below -0.01,
 * else whichever of the two readings comes nearer to unit length. img has at
 * least 2 channels; with 2, only the sign tells. Never AUTO.
 */
BAKE_API enum bake_normal_code bake_normal_code_of(
    const struct bake_image *img);

#ifdef __cplusplus
}
#endif

#endif
