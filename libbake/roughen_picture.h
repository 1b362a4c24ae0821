/* Pictures of remapped textures: sheets, cylinders, contrast curves. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_ROUGHEN_PICTURE_H
#define BAKE_ROUGHEN_PICTURE_H

#include <stdio.h>

#include "roughen.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The texture under some remaps (rows) at some angles (columns), with the
 * models' names and the angles beside, as in the paper's figure 3. Each panel
 * shows the middle of the texture, a square of at most
 * BAKE_ROUGHEN_CROP texels, remapped and then reduced by whole factors to at
 * most BAKE_ROUGHEN_PANEL pixels.
 *
 *   img     the texture, 1 to 4 channels, in the values that are remapped;
 *           alpha is not shown
 *   lum     its luminance
 *   sheet   out: 3 channels in the same values, text in 0 and 1;
 *           BAKE_IMAGE_INIT before, the caller's
 *
 * BAKE_EINVAL  no row or no column, or more than 64
 * BAKE_ENOMEM  no memory; sheet stays BAKE_IMAGE_INIT
 * Reentrant.
 */
enum { BAKE_ROUGHEN_CROP = 640, BAKE_ROUGHEN_PANEL = 160 };
BAKE_API enum bake_status bake_roughen_sheet(const struct bake_image *img,
    const struct bake_image *lum, const struct bake_roughen *rows, int nrows,
    const double *angles, int n, struct bake_image *sheet,
    struct bake_err *err);

/*
 * The paper's figure 1: four upright cylinders with the texture laid around
 * them, seen and lit orthogonally. The first is not lit; the others are
 * remapped by three[0 .. 2]. The light comes from the left, 65 degrees off the
 * viewer: texel column at angle a from the viewer has theta = |a + 65 deg|, so
 * that the shadow edge is at 25 degrees to the right. One texel is one pixel
 * at the middle; the texture tiles.
 *
 * Arguments and errors as above.
 */
BAKE_API enum bake_status bake_roughen_cylinders(const struct bake_image *img,
    const struct bake_image *lum, const struct bake_roughen three[3],
    struct bake_image *picture, struct bake_err *err);

/* Percentiles at angles in rising order. */
struct bake_roughen_curve {
	int n;
	double angle_deg[BAKE_ROUGHEN_ANGLES];
	struct bake_roughen_stats stats[BAKE_ROUGHEN_ANGLES];
};

/*
 * The curves at the right of the paper's figure 3: above, the median (black)
 * and the 5 % and 95 % points (grey) over the angle; below, the contrast
 * (grey) against the median (black), each on a scale of its own, whose ends
 * are written beside. A contrast that is not finite is left out.
 *
 *   title  is written above; letters that it has no glyph for are blank
 *   img    out: 1 channel, 0 .. 1 as a display shows it
 *
 * BAKE_ENOMEM  no memory; img stays BAKE_IMAGE_INIT
 */
BAKE_API enum bake_status bake_roughen_plot(
    const struct bake_roughen_curve *curve, const char *title,
    struct bake_image *img, struct bake_err *err);
/* The same as SVG; the stream tells whether it could be written. */
BAKE_API void bake_roughen_plot_svg(
    const struct bake_roughen_curve *curve, const char *title, FILE *stream);

#ifdef __cplusplus
}
#endif

#endif
