/* Multilayer relief textures as images: mip levels, dilation, a picture. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_LAYER_MAPS_H
#define BAKE_LAYER_MAPS_H

#include <stdbool.h>
#include <stddef.h>

#include "color.h"
#include "image.h"
#include "pixels.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { BAKE_LAYER_TEXTURES = 16, BAKE_LAYERS_MAX = 4 * BAKE_LAYER_TEXTURES };

/*
 * A set of textures. Texture t, channel c is layer 4 t + c; the layers of a
 * texel are the first ones, in rising depth, entry and exit in turns; those
 * beyond its last have depth 1 and normal 1/2. All of one size and data format,
 * but colour, which may have another format.
 *
 *   nlayers   the most layers of a texel: 1 (a height field), or even
 *   ntextures ceil(nlayers / 4)
 *   depth     4 channels each, d' as layer_codes.h says; 1 = no layer
 *   nx, ny    4 channels each, (n + 1) / 2, y up; 1/2 where there is no layer
 *             (integer formats: code 128 of 255, 32768 of 65535)
 *   color     ncolors images, 3 channels r g b or 4 with the coverage in a;
 *             that of layer i, 0 <= i < ncolors; ncolors may be 0. r g b are
 *             not multiplied by a
 *   color_linear  r g b are scene-linear light; else they are encoded as sRGB
 *
 * Every image is the set's own; images of textures from ntextures on, and
 * colours from ncolors on, are BAKE_PIXELS_INIT.
 */
struct bake_layer_maps {
	int width, height, nlayers, ntextures, ncolors;
	bool color_linear;
	struct bake_pixels depth[BAKE_LAYER_TEXTURES];
	struct bake_pixels nx[BAKE_LAYER_TEXTURES];
	struct bake_pixels ny[BAKE_LAYER_TEXTURES];
	struct bake_pixels color[BAKE_LAYERS_MAX];
};
#define BAKE_LAYER_MAPS_INIT                                                   \
	{                                                                      \
		.width = 0                                                     \
	}

/*
 * Allocate all textures, every texel empty: depth 1, normals 1/2, colour (and
 * coverage) 0. color_linear is set where color_format is half or float; who
 * fills the colours otherwise sets it otherwise.
 *
 *   maps     out: overwritten, not freed; the caller frees it
 *   nlayers  1 or even, up to BAKE_LAYERS_MAX
 *   ncolors  0 .. nlayers; color_chans 3 or 4 (of no matter with ncolors = 0)
 *
 * BAKE_EINVAL  a number outside these, or a side below 1
 * BAKE_ENOMEM  no memory, or the size overflows
 * On any failure maps is BAKE_LAYER_MAPS_INIT.
 */
BAKE_API enum bake_status bake_layer_maps_alloc(struct bake_layer_maps *maps,
    int width, int height, int nlayers, enum bake_data_format format,
    int ncolors, int color_chans, enum bake_data_format color_format,
    struct bake_err *err);
/* Free and reset. Harmless on BAKE_LAYER_MAPS_INIT. */
BAKE_API void bake_layer_maps_free(struct bake_layer_maps *maps);

/* How many layers texel (x, y) has: its depths before the first that is 1 (or
 * more, or no number). */
BAKE_API int bake_layer_count(const struct bake_layer_maps *maps, int x, int y);

/*
 * What bake_layer_mip found, besides the level. tau: the threshold that was
 * taken, a multiple of 2^-16. capped: texels from which pairs were removed.
 * volume, volume0: of the solid in this level and in level 0, as shares of the
 * whole (of all texels, stored depths d' from 0 to 1; of a height field, what
 * lies below the surface).
 */
struct bake_layer_mip {
	double tau;
	size_t capped;
	double volume, volume0;
};

/*
 * A mip level by occupancy, from level 0. Level l >= 1 has w = max(1, W >> l)
 * by h = max(1, H >> l) texels; texel X stands for level 0's columns
 * floor(X W / w) .. floor((X + 1) W / w) - 1, rows likewise: boxes of N whole
 * texels that part the texture. o(d) = the share of the box's N texels that are
 * inside the solid at depth d; the level is solid where o > tau, so that with
 * any tau >= 0 nothing grows where level 0 has nothing. tau is the same all
 * over the level:
 *   half = false  that which keeps the solid's volume V (the sum over the
 *                 level's texels of N times the slabs' lengths). V(tau) falls
 *                 in steps; of the last step with V >= V0 and the first below,
 *                 that with the smaller ratio to V0 is taken, the larger V on a
 *                 tie; and of a step the smallest tau. Ratios, so that V = 0 is
 *                 never nearest: strands one texel wide get thicker, but stay
 *   half = true   1/2: the nearest texel by texel, which eats thin strands
 * Volumes are exact whole numbers of codes (half, float: of 2^-31). The choice
 * is made before the cap, which can change the volume; mip has it after that.
 *
 * Transitions: a texel's layers begin at depths of level-0 layers of the same
 * parity, so that their codes need no rounding. More than nlayers are capped by
 * the smallest interval (which can fill gaps; only there is a level solid where
 * level 0 is not).
 *
 * Normals: in a transition at depth p those level-0 layers of its own parity
 * have a part that lie between the opposite transitions before and after it.
 * Their mean distance to p is m; each has weight max(0, 1 - |d - p| / m), or 1
 * where m = 0. The normal is the weighted mean of theirs, z by the parity, made
 * unit length ((0, 0, +-1) where nothing is left): so steep surfaces have the
 * normals of where the transition is, and other sheets in the box no part.
 *
 * Colour, in scene-linear light: with one colour image the mean of the box's
 * texels that have a layer, whatever is solid in the level: what is seen from
 * afar. With more, image i has the mean by the same weights as the normals, of
 * layers that have a colour; where the texel has no layer i, or none of weight
 * has a colour, the mean of the box's texels that have a layer i. Alpha is the
 * mean of alpha over the whole box, which is its coverage. 0 where no texel of
 * the box has the layer.
 *
 * A height field (nlayers = 1) has a layer where at least half of the box's
 * texels have one; its depth is their mean, and so are its slopes n_x / n_z and
 * n_y / n_z (n_z at least 1/256); tau is 1/2 always.
 *
 * A texel with an odd number of layers (nlayers > 1; none that was closed) is
 * taken without the last.
 *
 *   maps      of one size and format as bake_layer_maps_alloc made it
 *   level     1 .. the first whose sides are both 1
 *   color     converts colours that are not linear, space 'sRGB'; may be NULL
 *             where there are none
 *   nthreads  0 = all processors
 *   out       BAKE_LAYER_MAPS_INIT before, the caller's: the layers, formats
 *             and colours of maps, w by h
 *   mip       out; may be NULL
 *
 * BAKE_EINVAL  level < 1, or both sides are 1 already a level above; colours to
 *              convert and color is NULL, or knows no 'sRGB'
 * BAKE_EDATA   color cannot convert it (color.h)
 * BAKE_ENOMEM  no memory
 * On any failure out is BAKE_LAYER_MAPS_INIT.
 *
 * Memory: for each thread 18 bytes for each slab within a box (all of level 0's
 * in the coarsest), 512 KiB, and a few rows of floats. Reentrant. The same
 * bytes for any number of threads (colours: as far as color.h says).
 *
 * Source: own derivation; the paper (section 6) leaves mip maps open.
 */
BAKE_API enum bake_status bake_layer_mip(const struct bake_layer_maps *maps,
    int level, bool half, const struct bake_color *color, int nthreads,
    struct bake_layer_maps *out, struct bake_layer_mip *mip,
    struct bake_err *err);

/*
 * Dilate normals and colour, never depth, into neighbouring texels with fewer
 * layers, for renderers that sample a texel beside the one they hit (paper,
 * section 3.2): layer i of a texel that has no layer i takes the normal, and
 * the r, g, b of colour i, of the nearest texel that has one: the one at the
 * smallest dx^2 + dy^2 <= n^2; of equally near ones the one with the smallest
 * |dx|, then that on the left, then that above. Codes are copied. Alpha, which
 * is coverage, stays. tile_x, tile_y: distances go across the border.
 *
 *   maps      changed in place
 *   n         0 .. 4096 texels; 0 does nothing
 *   nthreads  0 = all processors
 *
 * BAKE_EINVAL  n outside its range
 * BAKE_ENOMEM  no memory for 2 bytes a texel; maps is then as it was
 *
 * Time: for each texel and layer at most 2 n + 1 looks, fewer the nearer what
 * it finds. The same bytes for any number of threads.
 */
BAKE_API enum bake_status bake_layer_dilate(struct bake_layer_maps *maps, int n,
    bool tile_x, bool tile_y, int nthreads, struct bake_err *err);

/*
 * A picture for people: a panel for each layer, side by side in their order,
 * four to a row, what is seen when those before it are peeled off. Each is lit
 * from the upper left by its normals (those of exits turned towards the
 * viewer), tinted by its colour where there is one, and darker the deeper it
 * lies:
 *     L = albedo (1 - 0.65 d) (0.06 + 0.14 n_z + 0.8 max(0, n . l))
 *     l = (-1, 1, 1.2) / |.|
 * shown as sqrt(L), as in contact sheets (sheet.h). Without a colour, entries
 * are a warm grey and exits a cool one. Empty texels are a dark checkerboard.
 *
 * Textures of more than 512 texels a side are reduced by a whole factor f =
 * ceil(longer side / 512): a panel has max(1, floor(side / f)) pixels, each the
 * mean of L over its box of texels (from f = 8 on, of every floor(f / 4)-th of
 * its rows and columns), empty ones counting as ground. Panels have 4 pixels of
 * ground around them.
 *
 *   color    as in bake_layer_mip
 *   picture  out: 3 channels 0 .. 1; BAKE_IMAGE_INIT before, the caller's
 *
 * BAKE_EINVAL  colours to convert and color is NULL, or knows no 'sRGB'
 * BAKE_EDATA   color cannot convert it (color.h)
 * BAKE_ENOMEM  no memory; picture is then BAKE_IMAGE_INIT
 */
BAKE_API enum bake_status bake_layer_picture(const struct bake_layer_maps *maps,
    const struct bake_color *color, struct bake_image *picture,
    struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
