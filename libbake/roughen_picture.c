/* Pictures of remapped textures: sheets and cylinders. */
/* SPDX-License-Identifier: MIT */
#include "roughen_picture.h"

#include <stdio.h>

#include "resample.h"
#include "roughen_draw_priv.h"
#include "roughen_priv.h"

enum { GAP = 4, MARGIN = 128, HEADING = 24 };

static const float ground = 0.02f, ink = 1;

/* The r, g, b of a texel. */
static void
color_of(const struct bake_image *img, int x, int y, float rgb[3])
{
	const float *v =
	    bake_image_row(img, y) + (size_t)x * (size_t)img->nchans;

	rgb[0] = v[0];
	rgb[1] = img->nchans < 3 ? v[0] : v[1];
	rgb[2] = img->nchans < 3 ? v[0] : v[2];
}

/* A square of the texture's middle as 3 channels, and its luminance. */
static enum bake_status
crop(const struct bake_image *img, const struct bake_image *lum, int side,
    struct bake_image *rgb, struct bake_image *grey, struct bake_err *err)
{
	const int x0 = (img->width - side) / 2, y0 = (img->height - side) / 2;
	enum bake_status rc = bake_image_alloc(rgb, side, side, 3, err);

	if (rc == BAKE_OK)
		rc = bake_image_alloc(grey, side, side, 1, err);
	for (int y = 0; rc == BAKE_OK && y < side; y++)
		for (int x = 0; x < side; x++) {
			color_of(img, x0 + x, y0 + y,
			    bake_image_row(rgb, y) + 3 * (size_t)x);
			bake_image_row(grey, y)[x] =
			    bake_image_row(lum, y0 + y)[x0 + x];
		}
	return rc;
}

static void
paste(struct bake_image *to, const struct bake_image *from, int x0, int y0)
{
	for (int y = 0; y < from->height; y++)
		for (int x = 0; x < from->width; x++)
			color_of(from, x, y,
			    bake_image_row(to, y0 + y) + 3 * (size_t)(x0 + x));
}

struct sheet {
	struct bake_image rgb, grey; /* the crop */
	int panel;
	struct bake_image *out;
};

/* Columns and rows of panels start here. */
static int
panel_at(const struct sheet *s, int i, int border)
{
	return border + GAP + i * (s->panel + GAP);
}

static enum bake_status
draw_panel(const struct sheet *s, const struct bake_roughen *r, double angle,
    int x0, int y0, struct bake_err *err)
{
	const struct bake_wrap clamp = { true, true };
	struct bake_image lit = BAKE_IMAGE_INIT, small = BAKE_IMAGE_INIT;
	struct bake_roughen_light light = { .cos_map = NULL };
	enum bake_status rc;

	bake_roughen_angle(angle, &light.cos_theta, &light.sin_theta);
	rc = bake_image_alloc(&lit, s->rgb.width, s->rgb.height, 3, err);
	if (rc == BAKE_OK) {
		paste(&lit, &s->rgb, 0, 0);
		rc = bake_roughen_apply(r, &light, &s->grey, &lit, 1, err);
	}
	if (rc == BAKE_OK)
		rc = bake_resample(&lit, clamp, BAKE_FILTER_BOX, s->panel,
		    s->panel, 1, &small, err);
	if (rc == BAKE_OK)
		paste(s->out, &small, x0, y0);
	bake_image_free(&lit);
	bake_image_free(&small);
	return rc;
}

static void
draw_labels(const struct sheet *s, const struct bake_roughen *rows, int nrows,
    const double *angles, int n)
{
	char text[16];

	bake_draw_fill(s->out, ground);
	for (int i = 0; i < nrows; i++)
		bake_draw_text(s->out, 8, panel_at(s, i, HEADING) + 8, 2, ink,
		    bake_roughen_name(rows[i].model));
	for (int i = 0; i < n; i++) {
		snprintf(text, sizeof text, "%.4g", angles[i]);
		bake_draw_text(s->out, panel_at(s, i, MARGIN), 8, 2, ink, text);
	}
}

enum bake_status
bake_roughen_sheet(const struct bake_image *img, const struct bake_image *lum,
    const struct bake_roughen *rows, int nrows, const double *angles, int n,
    struct bake_image *sheet, struct bake_err *err)
{
	struct sheet s = { BAKE_IMAGE_INIT, BAKE_IMAGE_INIT, 0, sheet };
	int side = img->width < img->height ? img->width : img->height;
	enum bake_status rc;

	if (nrows < 1 || n < 1 || nrows > BAKE_ROUGHEN_ANGLES ||
	    n > BAKE_ROUGHEN_ANGLES)
		return bake_fail(err, BAKE_EINVAL,
		    "a sheet of %d rows and %d columns, expected 1 to %d",
		    nrows, n, BAKE_ROUGHEN_ANGLES);
	side = side < BAKE_ROUGHEN_CROP ? side : BAKE_ROUGHEN_CROP;
	/* whole factors alone, so that no moire is added */
	s.panel = side;
	for (int k = 2; s.panel > BAKE_ROUGHEN_PANEL; k++)
		s.panel = side / k;
	if (side > BAKE_ROUGHEN_PANEL)
		side -= side % s.panel;
	rc = crop(img, lum, side, &s.rgb, &s.grey, err);
	if (rc == BAKE_OK)
		rc = bake_image_alloc(sheet, panel_at(&s, n, MARGIN),
		    panel_at(&s, nrows, HEADING), 3, err);
	if (rc == BAKE_OK)
		draw_labels(&s, rows, nrows, angles, n);
	for (int y = 0; y < nrows; y++)
		for (int x = 0; x < n && rc == BAKE_OK; x++)
			rc = draw_panel(&s, &rows[y], angles[x],
			    panel_at(&s, x, MARGIN), panel_at(&s, y, HEADING),
			    err);
	bake_image_free(&s.rgb);
	bake_image_free(&s.grey);
	if (rc != BAKE_OK)
		bake_image_free(sheet);
	return rc;
}

/* -- cylinders --------------------------------------------------------------
 */

enum { RADIUS = 120, TALL = 400, SHINE_DEG = 65 };

struct cylinder {
	const struct bake_image *img, *lum;
	const struct bake_roughen *remap; /* NULL: not lit */
	double texels;                    /* a pixel at the middle */
};

/* One pixel: the texel at arc length a R around from the middle. */
static void
shade(const struct cylinder *c, double a, int y, float rgb[3])
{
	const double light = SHINE_DEG * BAKE_PI / 180;
	const int tx = bake_wrap_index(
	    (long)floor(c->img->width / 2 + a * RADIUS * c->texels),
	    c->img->width, false);
	const int ty =
	    bake_wrap_index((long)floor(y * c->texels), c->img->height, false);
	double g = 1, cos_t, sin_t;

	color_of(c->img, tx, ty, rgb);
	if (c->remap != NULL) {
		bake_cos_sin(a + light, &cos_t, &sin_t);
		g = bake_roughen_gain(c->remap, bake_image_row(c->lum, ty)[tx],
		    cos_t, fabs(sin_t));
	}
	for (int k = 0; k < 3; k++)
		rgb[k] = (float)(g * rgb[k]);
}

/* Supersampled, as the texture is squeezed towards the sides. */
static void
draw_cylinder(struct bake_image *out, int x0, const struct cylinder *c)
{
	enum { SAMPLES = 8 };

	for (int x = 0; x < 2 * RADIUS; x++)
		for (int y = 0; y < TALL; y++) {
			float *to =
			    bake_image_row(out, GAP + y) + 3 * (size_t)(x0 + x);
			double sum[3] = { 0, 0, 0 };

			for (int k = 0; k < SAMPLES; k++) {
				const double across =
				    (x + (k + 0.5) / SAMPLES) / RADIUS - 1;
				float rgb[3];

				shade(c, BAKE_HALF_PI - bake_acos(across), y,
				    rgb);
				for (int i = 0; i < 3; i++)
					sum[i] += rgb[i];
			}
			for (int i = 0; i < 3; i++)
				to[i] = (float)(sum[i] / SAMPLES);
		}
}

enum bake_status
bake_roughen_cylinders(const struct bake_image *img,
    const struct bake_image *lum, const struct bake_roughen three[3],
    struct bake_image *picture, struct bake_err *err)
{
	struct cylinder c = { img, lum, NULL, 1 };
	enum bake_status rc;

	rc = bake_image_alloc(picture, 4 * (2 * RADIUS + 4 * GAP) + 4 * GAP,
	    TALL + 2 * GAP, 3, err);
	if (rc != BAKE_OK)
		return rc;
	bake_draw_fill(picture, ground);
	for (int i = 0; i < 4; i++) {
		c.remap = i > 0 ? &three[i - 1] : NULL;
		draw_cylinder(
		    picture, 4 * GAP + i * (2 * RADIUS + 4 * GAP), &c);
	}
	return BAKE_OK;
}
