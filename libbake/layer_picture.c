/* A picture of multilayer textures: each layer, those before it peeled off. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layer_mip_priv.h"
#include "mem.h"

/* Largest side of a panel, the gap around panels, panels in a row, and a side
 * of the checkerboard's squares, in pixels; samples across a pixel. */
enum { PANEL = 512, GAP = 4, COLUMNS = 4, SQUARE = 8, SAMPLES = 4 };

/* In scene-linear light; what is shown is their square root. */
static const float ground = 0.0036f, dark = 0.017f, bright = 0.028f;
static const float entry_albedo[3] = { 0.88f, 0.85f, 0.8f };
static const float exit_albedo[3] = { 0.72f, 0.8f, 0.88f };

struct sum {
	float rgb[3], n, covered;
};

/* A row of panels: layers 4 texture .. 4 texture + 3. */
struct panels {
	const struct bake_layer_maps *maps;
	const struct bake_color *color; /* NULL: nothing to convert */
	struct bake_image *picture;
	int width, height; /* of one */
	int step;          /* from sample to sample, texels */
	int texture;
	float *depth, *nx, *ny, *rgb; /* [W][4], one row */
	struct sum *sum;              /* [4][width] */
};

static int
nlayers_of(const struct panels *p)
{
	const int n = p->maps->nlayers - 4 * p->texture;

	return n < 4 ? n : 4;
}

static float
clip(float v)
{
	return v > 0 ? (v < 1 ? v : 1) : 0; /* NaN is 0 */
}

/* The light of a surface at stored depth, seen from the front. */
static void
shade(float stored, float nx, float ny, bool exit, const float albedo[3],
    struct sum *sum)
{
	/* (-1, 1, 1.2) / |.| */
	const float l[3] = { -0.539164f, 0.539164f, 0.646997f };
	const float x = 2 * nx - 1, y = 2 * ny - 1, side = exit ? -1 : 1;
	const float z = sqrtf(fmaxf(0, 1 - x * x - y * y));
	const float lambert = side * (x * l[0] + y * l[1]) + z * l[2];
	const float near =
	    1 - 0.65f * clip((float)bake_layer_depth((double)stored));
	const float light = near * (0.06f + 0.14f * z + 0.8f * clip(lambert));

	for (int c = 0; c < 3; c++)
		sum->rgb[c] += light * clip(albedo[c]);
	sum->covered++;
}

/* The samples of a row of layer 4 texture + i. */
static void
add_row(struct panels *p, int i, bool colored, int nchans)
{
	const float *plain = i % 2 ? exit_albedo : entry_albedo;
	const int w = p->maps->width;

	for (int x = 0; x < p->width; x++) {
		struct sum *sum =
		    &p->sum[(size_t)i * (size_t)p->width + (size_t)x];
		const int end = bake_box_edge(x + 1, p->width, w);

		for (int k = bake_box_edge(x, p->width, w); k < end;
		     k += p->step) {
			const size_t at = 4 * (size_t)k + (size_t)i;

			sum->n++;
			if (p->depth[at] < 1)
				shade(p->depth[at], p->nx[at], p->ny[at],
				    i % 2 != 0,
				    colored
					? p->rgb + (size_t)k * (size_t)nchans
					: plain,
				    sum);
		}
	}
}

static enum bake_status
read_rows(struct panels *p, int y, struct bake_err *err)
{
	const struct bake_layer_maps *m = p->maps;
	enum bake_status rc = BAKE_OK;

	bake_pixels_get(&m->depth[p->texture], 0, y, m->width, p->depth);
	bake_pixels_get(&m->nx[p->texture], 0, y, m->width, p->nx);
	bake_pixels_get(&m->ny[p->texture], 0, y, m->width, p->ny);
	for (int i = 0; i < nlayers_of(p) && rc == BAKE_OK; i++) {
		const int k = 4 * p->texture + i;
		const int nchans = m->color[k].nchans;
		struct bake_image img = { m->width, 1, nchans,
			(size_t)m->width * (size_t)nchans, p->rgb };

		if (k < m->ncolors) {
			bake_pixels_get(&m->color[k], 0, y, m->width, p->rgb);
			if (p->color != NULL)
				rc = bake_color_to_linear(
				    p->color, "sRGB", &img, 1, err);
		}
		add_row(p, i, k < m->ncolors, nchans);
	}
	return rc;
}

/* A row of pixels of all four panels. */
static void
put_row(const struct panels *p, int y)
{
	for (int i = 0; i < nlayers_of(p); i++)
		for (int x = 0; x < p->width; x++) {
			const struct sum *s =
			    &p->sum[(size_t)i * (size_t)p->width + (size_t)x];
			const float empty =
			    (x / SQUARE + y / SQUARE) % 2 ? bright : dark;
			float *v =
			    bake_image_row(p->picture,
				GAP + p->texture * (p->height + GAP) + y) +
			    3 * (size_t)(GAP + i * (p->width + GAP) + x);

			for (int c = 0; c < 3; c++)
				v[c] = sqrtf(clip(
				    (s->rgb[c] + (s->n - s->covered) * empty) /
				    s->n));
		}
}

static enum bake_status
draw(struct panels *p, struct bake_err *err)
{
	const int h = p->maps->height;
	enum bake_status rc = BAKE_OK;

	for (int y = 0; y < p->height; y++) {
		const int end = bake_box_edge(y + 1, p->height, h);

		memset(p->sum, 0, 4 * (size_t)p->width * sizeof *p->sum);
		for (int k = bake_box_edge(y, p->height, h);
		     k < end && rc == BAKE_OK; k += p->step)
			rc = read_rows(p, k, err);
		if (rc != BAKE_OK)
			return rc;
		put_row(p, y);
	}
	return BAKE_OK;
}

static enum bake_status
make_picture(struct panels *p, struct bake_err *err)
{
	const struct bake_layer_maps *m = p->maps;
	const int columns = m->nlayers < COLUMNS ? m->nlayers : COLUMNS;
	const size_t row = 4 * (size_t)m->width;
	const int longest = m->width > m->height ? m->width : m->height;
	const int factor = (longest - 1) / PANEL + 1;
	enum bake_status rc;

	p->width = m->width > factor ? m->width / factor : 1;
	p->height = m->height > factor ? m->height / factor : 1;
	p->step = factor > SAMPLES ? factor / SAMPLES : 1;
	rc = bake_image_alloc(p->picture, GAP + columns * (p->width + GAP),
	    GAP + m->ntextures * (p->height + GAP), 3, err);
	p->depth = bake_alloc(row, 4 * sizeof *p->depth, err);
	p->sum = bake_alloc((size_t)p->width, 4 * sizeof *p->sum, err);
	if (rc != BAKE_OK || p->depth == NULL || p->sum == NULL)
		return BAKE_ENOMEM;
	p->nx = p->depth + row;
	p->ny = p->nx + row;
	p->rgb = p->ny + row;
	for (int y = 0; y < p->picture->height; y++)
		for (size_t i = 0; i < p->picture->row_stride; i++)
			bake_image_row(p->picture, y)[i] = sqrtf(ground);
	for (; p->texture < m->ntextures && rc == BAKE_OK; p->texture++)
		rc = draw(p, err);
	return rc;
}

enum bake_status
bake_layer_picture(const struct bake_layer_maps *maps,
    const struct bake_color *color, struct bake_image *picture,
    struct bake_err *err)
{
	struct panels p = { .maps = maps, .picture = picture };
	enum bake_status rc;

	if (maps->ncolors > 0 && !maps->color_linear) {
		if (color == NULL)
			return bake_fail(err, BAKE_EINVAL,
			    "encoded colours and no colour configuration");
		rc = bake_color_check(color, "sRGB", err);
		if (rc != BAKE_OK)
			return rc;
		p.color = color;
	}
	rc = make_picture(&p, err);
	free(p.depth);
	free(p.sum);
	if (rc != BAKE_OK)
		bake_image_free(picture);
	return rc;
}
