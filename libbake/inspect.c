/* What a texture is: its layout, its maps, and what contradicts its label. */
/* SPDX-License-Identifier: MIT */
#include "inspect.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "resample.h"

void
bake_maps_free(struct bake_maps *maps)
{
	bake_image_free(&maps->normal);
	bake_image_free(&maps->relief);
	bake_image_free(&maps->ao);
}

/* A new image of n of img's channels. */
static enum bake_status
extract(struct bake_image *out, const struct bake_image *img,
    const int *channel, int n, struct bake_err *err)
{
	enum bake_status rc;

	rc = bake_image_alloc(out, img->width, img->height, n, err);
	for (int c = 0; rc == BAKE_OK && c < n; c++)
		bake_image_copy_channel(out, c, img, channel[c]);
	return rc;
}

static enum bake_status
extract_normal(struct bake_image *out, const struct bake_image *img,
    const int *channel, int n, enum bake_normal_code code, struct bake_err *err)
{
	enum bake_status rc = extract(out, img, channel, n, err);

	if (rc == BAKE_OK)
		bake_normal_decode(out, code, false);
	return rc;
}

/* -- guessing the layout --------------------------------------------------- */

/* Mean |z - sqrt(1 - x^2 - y^2)|: how far B is from a unit normal's z. */
static double
z_error(const struct bake_image *normal)
{
	double sum = 0, n = 0;

	for (int y = 0; y < normal->height; y++) {
		const float *v = bake_image_row(normal, y);

		for (int x = 0; x < normal->width; x++, v += 3) {
			double xx = (double)v[0], yy = (double)v[1];
			double d = fabs((double)v[2] -
					sqrt(fmax(0, 1 - xx * xx - yy * yy)));

			if (isfinite(d)) {
				sum += d;
				n++;
			}
		}
	}
	return n > 0 ? sum / n : INFINITY;
}

/* Share of texels whose R, G, B differ by more than 2/255. */
static double
coloured(const struct bake_image *img, const int rgba[4])
{
	double count = 0;

	for (int y = 0; y < img->height; y++) {
		const float *t = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++, t += img->nchans) {
			float r = t[rgba[0]], g = t[rgba[1]], b = t[rgba[2]];

			count += fabsf(r - g) > 2 / 255.0f ||
				 fabsf(g - b) > 2 / 255.0f;
		}
	}
	return count / ((double)img->width * img->height);
}

static enum bake_layout
guess_rgb(const struct bake_image *img, const int rgba[4], bool normals)
{
	if (normals)
		return BAKE_LAYOUT_NORMAL;
	return coloured(img, rgba) == 0 ? BAKE_LAYOUT_DEPTH
					: BAKE_LAYOUT_UNKNOWN;
}

enum bake_status
bake_layout_guess(const struct bake_image *img, const int rgba[4],
    enum bake_normal_code code, enum bake_layout *layout, struct bake_err *err)
{
	struct bake_image rgb = BAKE_IMAGE_INIT, rg = BAKE_IMAGE_INIT;
	struct bake_normal_stats s3, s2;
	struct bake_channel_range a;
	enum bake_status rc = BAKE_OK;

	*layout = img->nchans < 3 ? BAKE_LAYOUT_DEPTH : BAKE_LAYOUT_UNKNOWN;
	if (img->nchans < 3)
		return BAKE_OK;
	if ((rc = extract_normal(&rgb, img, rgba, 3, code, err)) != BAKE_OK ||
	    (rc = bake_normal_stats(&rgb, &s3, err)) != BAKE_OK)
		goto out;
	*layout = guess_rgb(img, rgba, bake_normals_plausible(&s3, 3));
	if (img->nchans < 4)
		goto out;
	bake_channel_range(img, rgba[3], &a);
	if (!(a.min < a.max))
		goto out;
	if (*layout == BAKE_LAYOUT_NORMAL && z_error(&rgb) < 0.05) {
		*layout = BAKE_LAYOUT_NORMAL_RELIEF;
		goto out;
	}
	if ((rc = extract_normal(&rg, img, rgba, 2, code, err)) != BAKE_OK ||
	    (rc = bake_normal_stats(&rg, &s2, err)) != BAKE_OK)
		goto out;
	if (s2.outside <= 0.001 && bake_normals_plausible(&s2, 2) &&
	    coloured(img, rgba) > 0.5)
		*layout = BAKE_LAYOUT_RELIEF;
	else if (*layout == BAKE_LAYOUT_NORMAL)
		*layout = BAKE_LAYOUT_NORMAL_RELIEF;
out:
	bake_image_free(&rgb);
	bake_image_free(&rg);
	return rc;
}

/* -- the maps -------------------------------------------------------------- */

static int
channels_needed(enum bake_layout layout)
{
	switch (layout) {
	case BAKE_LAYOUT_RELIEF:
	case BAKE_LAYOUT_NORMAL_RELIEF:
		return 4;
	case BAKE_LAYOUT_NORMAL:
		return 2;
	default:
		return 1;
	}
}

enum bake_status
bake_maps_extract(struct bake_maps *maps, const struct bake_image *img,
    const int rgba[4], enum bake_layout layout, enum bake_normal_code code,
    int relief_channel, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;

	*maps = (struct bake_maps)BAKE_MAPS_INIT;
	if (img->nchans < channels_needed(layout))
		return bake_fail(err, BAKE_EDATA,
		    "layout %s needs %d channels, there are %d",
		    bake_layout_name(layout), channels_needed(layout),
		    img->nchans);
	switch (layout) {
	case BAKE_LAYOUT_RELIEF:
	case BAKE_LAYOUT_NORMAL_RELIEF: {
		bool packed = layout == BAKE_LAYOUT_RELIEF;

		rc = extract_normal(
		    &maps->normal, img, rgba, packed ? 2 : 3, code, err);
		if (rc == BAKE_OK && packed)
			rc = extract(&maps->ao, img, rgba + 2, 1, err);
		if (rc == BAKE_OK)
			rc = extract(&maps->relief, img, rgba + 3, 1, err);
		break;
	}
	case BAKE_LAYOUT_NORMAL:
		rc = extract_normal(&maps->normal, img, rgba,
		    img->nchans < 3 ? 2 : 3, code, err);
		break;
	case BAKE_LAYOUT_DEPTH:
		rc = extract(&maps->relief, img, &relief_channel, 1, err);
		break;
	case BAKE_LAYOUT_AO:
		rc = extract(&maps->ao, img, rgba, 1, err);
		break;
	default:
		break;
	}
	if (rc != BAKE_OK)
		bake_maps_free(maps);
	return rc;
}

void
bake_maps_set_range(struct bake_maps *maps, double near, double far)
{
	struct bake_image *img = &maps->relief;

	if (img->data == NULL)
		return;
	for (int y = 0; y < img->height; y++) {
		float *row = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++)
			row[x] =
			    (float)(((double)row[x] - near) / (far - near));
	}
}

static bool
there(const struct bake_image *img)
{
	return img->data != NULL;
}

/* The normal map as large as the relief map; *resized owns a copy. */
static enum bake_status
fit_normal(const struct bake_image **normal, struct bake_image *resized,
    const struct bake_maps *maps, struct bake_wrap wrap, struct bake_err *err)
{
	const struct bake_image *r = &maps->relief;

	*normal = there(&maps->normal) ? &maps->normal : NULL;
	if (*normal == NULL || !there(r) ||
	    (r->width == maps->normal.width &&
		r->height == maps->normal.height))
		return BAKE_OK;
	*normal = resized;
	return bake_resample(&maps->normal, wrap, BAKE_FILTER_CATMULL_ROM,
	    r->width, r->height, 1, resized, err);
}

enum bake_status
bake_inspect_maps(struct bake_inspection *out, const struct bake_maps *maps,
    struct bake_wrap wrap, struct bake_err *err)
{
	struct bake_image resized = BAKE_IMAGE_INIT;
	const struct bake_image *normal;
	const struct bake_image *relief =
	    there(&maps->relief) ? &maps->relief : NULL;
	enum bake_status rc = BAKE_OK;

	out->has_normals = there(&maps->normal);
	out->has_relief = relief != NULL;
	if (out->has_normals && (rc = bake_normal_stats(&maps->normal,
				     &out->normals, err)) != BAKE_OK)
		return rc;
	if (relief != NULL)
		rc = bake_seams(relief, 0, 1, &out->seams, err);
	else if (out->has_normals)
		rc = bake_seams(
		    &maps->normal, 0, maps->normal.nchans, &out->seams, err);
	if (rc != BAKE_OK || (relief == NULL && !out->has_normals))
		return rc;
	rc = fit_normal(&normal, &resized, maps, wrap, err);
	if (rc == BAKE_OK)
		rc = bake_detect(normal, relief, &out->detection, err);
	bake_image_free(&resized);
	return rc;
}

/* -- contradictions -------------------------------------------------------- */

static void __attribute__((format(printf, 2, 3)))
add(struct bake_contradictions *list, const char *fmt, ...)
{
	va_list ap;

	if (list->n == BAKE_CONTRADICTIONS)
		return;
	va_start(ap, fmt);
	vsnprintf(list->text[list->n++], BAKE_CONTRADICTION, fmt, ap);
	va_end(ap);
}

static void
check_normals(
    struct bake_contradictions *out, const struct bake_normal_stats *s)
{
	if (s->nfinite == 0)
		return;
	if (s->negative_z > 0.05)
		add(out,
		    "%.1f %% of the normals point into the surface (z < 0)",
		    100 * s->negative_z);
	if (s->outside > 0.05)
		add(out, "%.1f %% of the normals have x, y beyond unit length",
		    100 * s->outside);
	if (s->length_mean < 0.5 || s->length_mean > 1.5)
		add(out, "the normals' mean length is %.3f, expected 1",
		    s->length_mean);
}

void
bake_contradictions_find(struct bake_contradictions *out,
    const struct bake_inspection *found, const struct bake_relief_meta *said)
{
	const struct bake_detection *d = &found->detection;

	out->n = 0;
	if (found->nbad > 0)
		add(out, "%zu values are NaN or infinite", found->nbad);
	if (found->has_normals)
		check_normals(out, &found->normals);
	if (!found->has_normals)
		return;
	if (d->polarity != BAKE_POLARITY_UNSURE &&
	    said->polarity != BAKE_POLARITY_UNSURE &&
	    d->polarity != said->polarity)
		add(out, "polarity: the maps say %s, declared is %s",
		    bake_polarity_name(d->polarity),
		    bake_polarity_name(said->polarity));
	if (d->normal_y != BAKE_NORMAL_Y_UNSURE &&
	    said->normal_y != BAKE_NORMAL_Y_UNSURE &&
	    d->normal_y != said->normal_y)
		add(out, "normal y: the maps say %s, declared is %s",
		    bake_normal_y_name(d->normal_y),
		    bake_normal_y_name(said->normal_y));
	if (d->pair_y != BAKE_NORMAL_Y_UNSURE &&
	    d->curl_y != BAKE_NORMAL_Y_UNSURE && d->pair_y != d->curl_y)
		add(out,
		    "the relief says normal y %s, the normals alone say %s: "
		    "they do not belong together",
		    bake_normal_y_name(d->pair_y),
		    bake_normal_y_name(d->curl_y));
	if (said->depth_scale > 0 &&
	    (said->depth_scale * BAKE_DEPTH_SCALE_FACTOR < d->depth_scale_low ||
		said->depth_scale >
		    d->depth_scale_high * BAKE_DEPTH_SCALE_FACTOR))
		add(out,
		    "depth scale: the normals imply %.4g, declared is %.4g",
		    d->depth_scale, said->depth_scale);
}
