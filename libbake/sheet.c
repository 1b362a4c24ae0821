/* Contact sheets: relief textures as pictures for people to look at. */
/* SPDX-License-Identifier: MIT */
#include "sheet.h"

#include <math.h>

#include "resample.h"

enum { PANELS = 4 };
static const float ground = 0.15f, missing = 0.4f;

static float
clip(float v)
{
	return v > 0 ? (v < 1 ? v : 1) : 0; /* NaN is 0 */
}

/* The map at the panels' size, or an empty image where there is none. */
static enum bake_status
fit(struct bake_image *out, const struct bake_image *map, int width, int height,
    struct bake_err *err)
{
	const struct bake_wrap tile = { false, false };

	if (map->data == NULL)
		return BAKE_OK;
	return bake_resample(
	    map, tile, BAKE_FILTER_BOX, width, height, 1, out, err);
}

/* Component c of the unit normal at v. */
static void
unit_normal(float n[3], const float *v, int nchans)
{
	float xy2 = v[0] * v[0] + v[1] * v[1], len;

	n[0] = v[0];
	n[1] = v[1];
	n[2] = nchans > 2 ? v[2] : sqrtf(fmaxf(0, 1 - xy2));
	len = sqrtf(xy2 + n[2] * n[2]);
	for (int c = 0; len > 0 && c < 3; c++)
		n[c] /= len;
}

static float
lit(const float n[3], bool y_down, float ao)
{
	const float l[3] = { -0.539164f, 0.539164f, 0.646997f };
	float y = y_down ? -n[1] : n[1];
	float lambert = n[0] * l[0] + y * l[1] + n[2] * l[2];

	return sqrtf(clip((0.2f + 0.8f * fmaxf(0, lambert)) * ao));
}

static void
put(float *pixel, float r, float g, float b)
{
	pixel[0] = clip(r);
	pixel[1] = clip(g);
	pixel[2] = clip(b);
}

/* The four panels' pixels of one texel; step apart. */
static void
draw_texel(float *pixel, size_t step, const float *normal, int nchans,
    const float *ao, const float *relief, bool y_down)
{
	float n[3];

	for (int k = 0; k < PANELS; k++)
		put(pixel + (size_t)k * step, missing, missing, missing);
	if (ao != NULL)
		put(pixel + step, *ao, *ao, *ao);
	if (relief != NULL)
		put(pixel + 2 * step, *relief, *relief, *relief);
	if (normal != NULL) {
		float shade;

		unit_normal(n, normal, nchans);
		put(pixel, (n[0] + 1) / 2, (n[1] + 1) / 2, (n[2] + 1) / 2);
		shade = lit(n, y_down, ao != NULL ? *ao : 1);
		put(pixel + 3 * step, shade, shade, shade);
	}
}

static void
fill(struct bake_image *img, float v)
{
	for (int y = 0; y < img->height; y++)
		for (size_t k = 0; k < (size_t)img->width * 3; k++)
			bake_image_row(img, y)[k] = v;
}

static const float *
row_of(const struct bake_image *img, int y)
{
	return img->data != NULL ? bake_image_row(img, y) : NULL;
}

static void
draw(struct bake_image *row, const struct bake_maps *m, int width, int height,
    bool y_down)
{
	size_t step = 3 * (size_t)(width + BAKE_SHEET_GAP);
	size_t nn = (size_t)m->normal.nchans;

	fill(row, ground);
	for (int y = 0; y < height; y++) {
		float *pixel = bake_image_row(row, y + BAKE_SHEET_GAP) +
			       3 * BAKE_SHEET_GAP;
		const float *n = row_of(&m->normal, y);
		const float *ao = row_of(&m->ao, y);
		const float *r = row_of(&m->relief, y);

		for (size_t x = 0; x < (size_t)width; x++)
			draw_texel(pixel + 3 * x, step,
			    n != NULL ? n + x * nn : NULL, (int)nn,
			    ao != NULL ? ao + x : NULL,
			    r != NULL ? r + x : NULL, y_down);
	}
}

enum bake_status
bake_sheet_row(const struct bake_maps *maps, bool y_down,
    struct bake_image *row, struct bake_err *err)
{
	const struct bake_image *of = maps->relief.data != NULL ? &maps->relief
				      : maps->normal.data != NULL
					  ? &maps->normal
					  : &maps->ao;
	struct bake_maps m = BAKE_MAPS_INIT;
	int w = of->width, h = of->height;
	enum bake_status rc;

	*row = (struct bake_image)BAKE_IMAGE_INIT;
	if (of->data == NULL)
		return bake_fail(err, BAKE_EINVAL, "no map to show");
	if (w > BAKE_SHEET_PANEL) {
		h = (int)((double)h * BAKE_SHEET_PANEL / w + 0.5);
		h = h < 1 ? 1 : h;
		w = BAKE_SHEET_PANEL;
	}
	if ((rc = fit(&m.normal, &maps->normal, w, h, err)) != BAKE_OK ||
	    (rc = fit(&m.ao, &maps->ao, w, h, err)) != BAKE_OK ||
	    (rc = fit(&m.relief, &maps->relief, w, h, err)) != BAKE_OK)
		goto out;
	rc = bake_image_alloc(row,
	    PANELS * (w + BAKE_SHEET_GAP) + BAKE_SHEET_GAP,
	    h + 2 * BAKE_SHEET_GAP, 3, err);
	if (rc == BAKE_OK)
		draw(row, &m, w, h, y_down);
out:
	bake_maps_free(&m);
	return rc;
}

enum bake_status
bake_sheet_stack(const struct bake_image *row, int n, struct bake_image *sheet,
    struct bake_err *err)
{
	int width = 0;
	long height = 0;
	enum bake_status rc;

	*sheet = (struct bake_image)BAKE_IMAGE_INIT;
	for (int k = 0; k < n; k++) {
		width = row[k].width > width ? row[k].width : width;
		height += row[k].height;
	}
	if (n < 1)
		return bake_fail(err, BAKE_EINVAL, "no row to show");
	if (height > 1 << 30)
		return bake_fail(err, BAKE_ENOMEM,
		    "a contact sheet %ld pixels high is too large", height);
	rc = bake_image_alloc(sheet, width, (int)height, 3, err);
	if (rc != BAKE_OK)
		return rc;
	fill(sheet, ground);
	for (int k = 0, y = 0; k < n; k++)
		for (int i = 0; i < row[k].height; i++, y++) {
			float *d = bake_image_row(sheet, y);
			const float *s = bake_image_row(&row[k], i);

			for (size_t x = 0; x < (size_t)row[k].width * 3; x++)
				d[x] = s[x];
		}
	return BAKE_OK;
}
