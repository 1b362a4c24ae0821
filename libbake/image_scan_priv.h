/* A look at an image file before its decoder believes it. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_IMAGE_SCAN_PRIV_H
#define BAKE_IMAGE_SCAN_PRIV_H

#include "exr_scan_priv.h"
#include "image_kind.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Refuse what a decoder would set memory aside for, and fill it, without a
 * look at how much the file can hold: attributes of EXR, texts of PNG, the
 * canvas of GIF and BMP, the user's data of DPX. A file of a few hundred bytes
 * takes 2 GB there. And DDS of no bits a texel, over which it never ends. Other
 * kinds pass.
 *
 * BAKE_EDATA   a part that is longer than what is left of the file; a canvas
 *              that it cannot hold; for EXR also what bake_exr_scan refuses
 * BAKE_ELIMIT  EXR, GIF or BMP beyond the limits
 *
 * Sources: W3C, 'Portable Network Graphics Specification', section 5.3;
 * CompuServe, 'GIF89a Specification', section 18; Microsoft,
 * BITMAPINFOHEADER; SMPTE ST 268, table 1;
 * exr_scan_priv.h.
 */
enum bake_status bake_image_scan(enum bake_image_kind kind,
    const struct bake_exr_source *source, const struct bake_read_limits *limits,
    const char *name, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
