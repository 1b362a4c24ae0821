/* Lines and letters on an image. */
/* SPDX-License-Identifier: MIT */
#include "roughen_draw_priv.h"

#include <math.h>

/* Rows from the top, 5 dots each, the left one the highest bit. */
static const struct glyph {
	char letter;
	unsigned char row[BAKE_GLYPH_HEIGHT];
} glyphs[] = {
	{ '%', { 24, 25, 2, 4, 8, 19, 3, 0, 0 } },
	{ '+', { 0, 4, 4, 31, 4, 4, 0, 0, 0 } },
	{ ',', { 0, 0, 0, 0, 0, 12, 12, 4, 8 } },
	{ '-', { 0, 0, 0, 31, 0, 0, 0, 0, 0 } },
	{ '.', { 0, 0, 0, 0, 0, 12, 12, 0, 0 } },
	{ '0', { 14, 17, 19, 21, 25, 17, 14, 0, 0 } },
	{ '1', { 4, 12, 4, 4, 4, 4, 14, 0, 0 } },
	{ '2', { 14, 17, 1, 2, 4, 8, 31, 0, 0 } },
	{ '3', { 31, 2, 4, 2, 1, 17, 14, 0, 0 } },
	{ '4', { 2, 6, 10, 18, 31, 2, 2, 0, 0 } },
	{ '5', { 31, 16, 30, 1, 1, 17, 14, 0, 0 } },
	{ '6', { 6, 8, 16, 30, 17, 17, 14, 0, 0 } },
	{ '7', { 31, 1, 2, 4, 8, 8, 8, 0, 0 } },
	{ '8', { 14, 17, 17, 14, 17, 17, 14, 0, 0 } },
	{ '9', { 14, 17, 17, 15, 1, 2, 12, 0, 0 } },
	{ 'a', { 0, 0, 14, 1, 15, 17, 15, 0, 0 } },
	{ 'b', { 16, 16, 30, 17, 17, 17, 30, 0, 0 } },
	{ 'c', { 0, 0, 14, 16, 16, 17, 14, 0, 0 } },
	{ 'd', { 1, 1, 15, 17, 17, 17, 15, 0, 0 } },
	{ 'e', { 0, 0, 14, 17, 31, 16, 14, 0, 0 } },
	{ 'f', { 6, 9, 8, 28, 8, 8, 8, 0, 0 } },
	{ 'g', { 0, 0, 15, 17, 17, 17, 15, 1, 14 } },
	{ 'h', { 16, 16, 22, 25, 17, 17, 17, 0, 0 } },
	{ 'i', { 4, 0, 12, 4, 4, 4, 14, 0, 0 } },
	{ 'j', { 2, 0, 6, 2, 2, 2, 2, 18, 12 } },
	{ 'k', { 16, 16, 18, 20, 24, 20, 18, 0, 0 } },
	{ 'l', { 12, 4, 4, 4, 4, 4, 14, 0, 0 } },
	{ 'm', { 0, 0, 26, 21, 21, 17, 17, 0, 0 } },
	{ 'n', { 0, 0, 22, 25, 17, 17, 17, 0, 0 } },
	{ 'o', { 0, 0, 14, 17, 17, 17, 14, 0, 0 } },
	{ 'p', { 0, 0, 30, 17, 17, 17, 30, 16, 16 } },
	{ 'q', { 0, 0, 15, 17, 17, 17, 15, 1, 1 } },
	{ 'r', { 0, 0, 22, 25, 16, 16, 16, 0, 0 } },
	{ 's', { 0, 0, 15, 16, 14, 1, 30, 0, 0 } },
	{ 't', { 8, 8, 28, 8, 8, 9, 6, 0, 0 } },
	{ 'u', { 0, 0, 17, 17, 17, 19, 13, 0, 0 } },
	{ 'v', { 0, 0, 17, 17, 17, 10, 4, 0, 0 } },
	{ 'w', { 0, 0, 17, 17, 21, 21, 10, 0, 0 } },
	{ 'x', { 0, 0, 17, 10, 4, 10, 17, 0, 0 } },
	{ 'y', { 0, 0, 17, 17, 17, 17, 15, 1, 14 } },
	{ 'z', { 0, 0, 31, 2, 4, 8, 31, 0, 0 } },
};

static void
blend(struct bake_image *img, int x, int y, float grey, float share)
{
	float *v;

	if (x < 0 || y < 0 || x >= img->width || y >= img->height)
		return;
	v = bake_image_row(img, y) + (size_t)x * (size_t)img->nchans;
	for (int c = 0; c < img->nchans; c++)
		v[c] += share * (grey - v[c]);
}

void
bake_draw_fill(struct bake_image *img, float grey)
{
	for (int y = 0; y < img->height; y++) {
		float *row = bake_image_row(img, y);

		for (int i = 0; i < img->width * img->nchans; i++)
			row[i] = grey;
	}
}

/* Distance of (x, y) to the line. */
static double
distance(const double from[2], const double to[2], double x, double y)
{
	const double ux = to[0] - from[0], uy = to[1] - from[1];
	const double length2 = ux * ux + uy * uy;
	double at = 0, dx, dy;

	if (length2 > 0)
		at = ((x - from[0]) * ux + (y - from[1]) * uy) / length2;
	at = at > 0 ? (at < 1 ? at : 1) : 0;
	dx = x - from[0] - at * ux;
	dy = y - from[1] - at * uy;
	return sqrt(dx * dx + dy * dy);
}

void
bake_draw_line(struct bake_image *img, const double from[2], const double to[2],
    double width, float grey)
{
	const double reach = width / 2 + 1;
	const int x0 = (int)floor(fmin(from[0], to[0]) - reach);
	const int x1 = (int)ceil(fmax(from[0], to[0]) + reach);
	const int y0 = (int)floor(fmin(from[1], to[1]) - reach);
	const int y1 = (int)ceil(fmax(from[1], to[1]) + reach);

	for (int y = y0; y <= y1; y++)
		for (int x = x0; x <= x1; x++) {
			const double share =
			    width / 2 + 0.5 - distance(from, to, x, y);

			if (share > 0)
				blend(img, x, y, grey,
				    share < 1 ? (float)share : 1);
		}
}

static void
draw_glyph(struct bake_image *img, int x0, int y0, int scale, float grey,
    const struct glyph *g)
{
	for (int y = 0; y < BAKE_GLYPH_HEIGHT * scale; y++)
		for (int x = 0; x < 5 * scale; x++)
			if (g->row[y / scale] >> (4 - x / scale) & 1)
				blend(img, x0 + x, y0 + y, grey, 1);
}

void
bake_draw_text(struct bake_image *img, int x, int y, int scale, float grey,
    const char *text)
{
	const int n = (int)(sizeof glyphs / sizeof *glyphs);

	for (; *text != '\0'; text++, x += BAKE_GLYPH_WIDTH * scale)
		for (int i = 0; i < n; i++)
			if (glyphs[i].letter == *text)
				draw_glyph(img, x, y, scale, grey, &glyphs[i]);
}
