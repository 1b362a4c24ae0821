/* Kinds of image files: their marks, and what size of image one can hold. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_IMAGE_KIND_H
#define BAKE_IMAGE_KIND_H

#include <stddef.h>

#include "err.h"
#include "io_image.h"

#ifdef __cplusplus
extern "C" {
#endif

enum bake_image_kind {
	BAKE_KIND_UNKNOWN = 0,
	BAKE_KIND_BMP,
	BAKE_KIND_CINEON,
	BAKE_KIND_DDS,
	BAKE_KIND_DPX,
	BAKE_KIND_EXR,
	BAKE_KIND_FITS,
	BAKE_KIND_GIF,
	BAKE_KIND_HDR,
	BAKE_KIND_HEIF,
	BAKE_KIND_ICO,
	BAKE_KIND_IFF,
	BAKE_KIND_JPEG,
	BAKE_KIND_JPEG2000,
	BAKE_KIND_PIC,
	BAKE_KIND_PNG,
	BAKE_KIND_PNM,
	BAKE_KIND_PSD,
	BAKE_KIND_RLA,
	BAKE_KIND_SGI,
	BAKE_KIND_TGA,
	BAKE_KIND_TIFF,
	BAKE_KIND_WEBP
};

/* So many bytes of the file's beginning tell its kind. */
enum { BAKE_IMAGE_KIND_BYTES = 16 };

/*
 * The kind of a file, by its first n bytes; where these have no mark that is
 * known, by its name's extension for the kinds that have none (TGA …).
 */
enum bake_image_kind bake_image_kind_of(
    const unsigned char *head, size_t n, const char *name);

/* OpenImageIO's name of the kind; NULL for BAKE_KIND_UNKNOWN. */
const char *bake_image_kind_plugin(enum bake_image_kind kind);

/* What a file claims to hold. */
struct bake_image_claim {
	int width, height, nchans;
	size_t file_size;
};

/*
 * Check a claim against the limits, and against what a file of that kind and
 * size can decode to (own derivation: deflate expands 1032 times at most, a
 * run of RLE 128 samples from two bytes, LZW 4096 from a code of 12 bits; other
 * kinds are taken on trust up to a gigabyte).
 *
 * BAKE_EDATA   no texel, or the file is too small for what it claims
 * BAKE_ELIMIT  beyond the limits
 */
enum bake_status bake_image_claim_check(const struct bake_image_claim *claim,
    enum bake_image_kind kind, const struct bake_read_limits *limits,
    const char *name, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
