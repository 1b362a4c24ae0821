/* Colour spaces: the only module that knows OpenColorIO. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_COLOR_H
#define BAKE_COLOR_H

#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Colour maps are filtered and blended in scene-linear light, never in the
 * values that a file holds: half of black and white is 0.5 linear, code 188 of
 * 255 in sRGB. Depth, normals and AO are data and never come here.
 */
struct bake_color; /* an OpenColorIO configuration */

/*
 * Open a configuration: the file at path or, with path NULL, the one that the
 * environment variable OCIO names or, where that is not set or empty, a small
 * one of our own. The built-in one's scene-linear space is linear Rec.709 with
 * a D65 white, and it knows, upper and lower case alike:
 *     sRGB                 the piecewise curve; also 'sRGB - Texture',
 *                          srgb_texture, srgb_tx
 *     Linear Rec.709       also linear, lin_rec709, lin_srgb, 'Linear sRGB'
 *     Rec.709              the camera curve of BT.709
 *     Gamma 1.8 Rec.709, Gamma 2.2 Rec.709, Gamma 2.4 Rec.709
 *                          pure powers; also gamma18, gamma22, g22_rec709 …
 *     Display P3, Linear P3-D65, Linear Rec.2020
 *     ACEScg, ACES2065-1   also lin_ap1 and lin_ap0
 *     Raw                  no conversion; also data, none, 'Non-Color'
 * and the names that the ACES configurations, Blender and OpenImageIO have for
 * the same. White stays white: matrices adapt by Bradford.
 *
 *   color  out: the caller closes it with bake_color_close; NULL on failure
 *
 * BAKE_EIO     the file cannot be read; err names it
 * BAKE_EDATA   it is no configuration, or it has no role scene_linear
 * BAKE_ENOMEM  no memory
 *
 * Reentrant, as far as getenv is.
 */
BAKE_API enum bake_status bake_color_open(
    const char *path, struct bake_color **color, struct bake_err *err);

/* Close and free; harmless on NULL. */
BAKE_API void bake_color_close(struct bake_color *color);

/* The file that the configuration came from, for a depfile; NULL where it is
 * the built-in one. Belongs to color. */
BAKE_API const char *bake_color_path(const struct bake_color *color);

/*
 * Whether the configuration can convert between `space` (a colour space, an
 * alias or a role) and scene-linear light both ways: to be asked before any
 * work is done.
 *
 * BAKE_EINVAL  it knows no such space; the message lists those it knows, as
 *              many as there is room for
 * BAKE_EDATA   it knows the space and cannot convert (a table is missing …)
 */
BAKE_API enum bake_status bake_color_check(
    const struct bake_color *color, const char *space, struct bake_err *err);

/*
 * Convert an image in place, from `space` to scene-linear light or back.
 *
 *   img       encoded values as in a file, code / code_max: the first three
 *             channels are r, g, b. An image of 1 or 2 channels is grey: it is
 *             converted as r = g = b, and g is kept. Further channels (alpha)
 *             keep their bits, and so does all where both spaces are the same
 *             or `space` is data.
 *   space     as in bake_color_check
 *   nthreads  0 = all processors
 *
 * Values outside 0 .. 1 are legal and are not clipped by the built-in
 * configuration: its curves with a linear piece go on as that line below 0 and
 * the others mirrored (f(-x) = -f(x)), above 1 all by their formula; so that
 * the way back returns the start. A texel with a NaN or Inf gives NaN or Inf
 * or some number, and has no influence on another texel.
 *
 * Accuracy: float arithmetic with the library's exact powers, not its fast
 * approximations, unless its own variable OCIO_OPTIMIZATION_FLAGS says so. All
 * codes of 8 and 16 bits in any space of the built-in configuration return to
 * themselves by way of scene-linear light.
 *
 * BAKE_EINVAL  as bake_color_check; or an image without texels
 * BAKE_EDATA   as bake_color_check
 * BAKE_ENOMEM  no memory; on any failure img is as it was
 *
 * The same bytes for every nthreads and however the image is cut into rows or
 * bands. Across machines the last bit of a float can differ where libm's powf
 * does, as can OpenColorIO's releases: colour is exempt from the rule that
 * data maps keep.
 * Thread safety: one color may be used by many threads at once, on different
 * images; nothing in it is changed that OpenColorIO does not lock.
 */
BAKE_API enum bake_status bake_color_to_linear(const struct bake_color *color,
    const char *space, struct bake_image *img, int nthreads,
    struct bake_err *err);
BAKE_API enum bake_status bake_color_from_linear(const struct bake_color *color,
    const char *space, struct bake_image *img, int nthreads,
    struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
