/* The packed relief texture: layouts, targets, metadata. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_RELIEF_H
#define BAKE_RELIEF_H

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
	BAKE_LAYOUT_HORIZONS,   /* tan of the horizon angle per direction */
	BAKE_LAYOUT_ROUGHEN_LUT /* rm-roughen's remap, see bake_roughen_lut */
};

/* "relief", "normal-relief", "normal" …; "unknown". Static text. */
BAKE_API const char *bake_layout_name(enum bake_layout layout);

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
};
#define BAKE_RELIEF_META_INIT                                                  \
	{                                                                      \
		.layout = BAKE_LAYOUT_UNKNOWN                                  \
	}

/* Metadata to attributes (relief:Layout, Polarity, NormalY, NormalCode,
 * DepthScale, AOScale, Wrap, KeepScale) and back. What is not said is not
 * written; a value that is not understood reads as not said. KeepScale is text,
 * the numbers separated by commas, each with up to 6 digits, or as many as
 * there is room for. */
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
