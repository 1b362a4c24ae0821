/* Lines and letters on an image. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_ROUGHEN_DRAW_PRIV_H
#define BAKE_ROUGHEN_DRAW_PRIV_H

#include "image.h"

/* A letter's advance and height in units of its scale; two rows of the height
 * are below the line. */
enum { BAKE_GLYPH_WIDTH = 6, BAKE_GLYPH_HEIGHT = 9 };

/* All channels of all texels. */
void bake_draw_fill(struct bake_image *img, float grey);

/* A line between two points, in pixels, width wide; its edges are smooth. */
void bake_draw_line(struct bake_image *img, const double from[2],
    const double to[2], double width, float grey);

/* Text with its top left corner at (x, y), each dot scale pixels. Letters a to
 * z, digits, blank . , % - + have glyphs; others are blank. */
void bake_draw_text(struct bake_image *img, int x, int y, int scale, float grey,
    const char *text);

#endif
