/* The packed relief texture: metadata, and planes into channels. */
/* SPDX-License-Identifier: MIT */
#include "relief.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "relief_priv.h"

static const char *const layout_names[] = { "unknown", "relief",
	"normal-relief", "normal", "depth", "ao", "orm", "mask", "bent",
	"horizons", "roughen-lut", "layer-depth", "layer-nx", "layer-ny",
	"layer-color", "layer-deep" };
static const char *const wrap_names[] = { "tile", "clamp-u", "clamp-v",
	"clamp" };

const char *
bake_layout_name(enum bake_layout layout)
{
	return layout_names[layout];
}

/* The numbers with so many digits each; false where they have no room. */
static bool
format_list(char *text, size_t size, const double *v, int n, int digits)
{
	size_t used = 0;

	for (int i = 0; i < n && used < size; i++)
		used += (size_t)snprintf(text + used, size - used, "%s%.*g",
		    i > 0 ? "," : "", digits, v[i]);
	return used < size;
}

static void
set_list(struct bake_attrs *attrs, const char *name, const double *v, int n)
{
	char text[128];

	for (int digits = 6; digits >= 3; digits--)
		if (format_list(text, sizeof text, v, n, digits)) {
			bake_attrs_set(attrs, name, text);
			return;
		}
}

void
bake_relief_meta_to_attrs(
    const struct bake_relief_meta *meta, struct bake_attrs *attrs)
{
	if (meta->layout != BAKE_LAYOUT_UNKNOWN)
		bake_attrs_set(attrs, "Layout", layout_names[meta->layout]);
	bake_layer_meta_to_attrs(&meta->layer, attrs);
	if (meta->polarity != BAKE_POLARITY_UNSURE)
		bake_attrs_set(
		    attrs, "Polarity", bake_polarity_name(meta->polarity));
	if (meta->normal_y != BAKE_NORMAL_Y_UNSURE)
		bake_attrs_set(
		    attrs, "NormalY", bake_normal_y_name(meta->normal_y));
	if (meta->normal_code != BAKE_NORMAL_CODE_AUTO)
		bake_attrs_set(attrs, "NormalCode",
		    bake_normal_code_name(meta->normal_code));
	if (meta->depth_scale > 0)
		bake_attrs_set_number(attrs, "DepthScale", meta->depth_scale);
	if (meta->has_wrap)
		bake_attrs_set(attrs, "Wrap",
		    wrap_names[meta->wrap.clamp_u + 2 * meta->wrap.clamp_v]);
	if (meta->has_ao_scale)
		bake_attrs_set_number(attrs, "AOScale", meta->ao_scale);
	if (meta->nkeep > 0)
		set_list(attrs, "KeepScale", meta->keep_scale, meta->nkeep);
}

static const char *
layout_text(int i)
{
	return layout_names[i];
}

static const char *
polarity_text(int i)
{
	return bake_polarity_name((enum bake_polarity)i);
}

static const char *
normal_y_text(int i)
{
	return bake_normal_y_name((enum bake_normal_y)i);
}

static const char *
normal_code_text(int i)
{
	return bake_normal_code_name((enum bake_normal_code)i);
}

static const char *
wrap_text(int i)
{
	return wrap_names[i];
}

/* Which of n names the attribute holds; `missing` where it holds none. */
static int
name_index(const struct bake_attrs *attrs, const char *attr,
    const char *(*name)(int), int n, int missing)
{
	const char *value = bake_attrs_get(attrs, attr);

	for (int i = 0; value != NULL && i < n; i++)
		if (strcmp(value, name(i)) == 0)
			return i;
	return missing;
}

/* The number that a text is, all of it; 0 where it is no positive one. */
static double
positive(const char *text)
{
	char *end;
	double v;

	if (text == NULL)
		return 0;
	v = strtod(text, &end);
	return *end == '\0' && v > 0 && v <= FLT_MAX ? v : 0;
}

/* Positive numbers, inf among them, separated by commas; *n is 0 where a text
 * is anything else. */
static void
get_list(const char *text, double *v, int max, int *n)
{
	char *end;

	for (*n = 0; text != NULL && *n < max;) {
		v[*n] = strtod(text, &end);
		if (end == text || !(v[*n] > 0) ||
		    (*end != ',' && *end != '\0'))
			break;
		++*n;
		if (*end == '\0')
			return;
		text = end + 1;
	}
	*n = 0;
}

void
bake_relief_meta_from_attrs(
    struct bake_relief_meta *meta, const struct bake_attrs *attrs)
{
	int wrap = name_index(attrs, "Wrap", wrap_text, 4, -1);

	meta->layout = (enum bake_layout)name_index(attrs, "Layout",
	    layout_text, sizeof layout_names / sizeof *layout_names, 0);
	meta->polarity = (enum bake_polarity)name_index(
	    attrs, "Polarity", polarity_text, 3, 0);
	meta->normal_y = (enum bake_normal_y)name_index(
	    attrs, "NormalY", normal_y_text, 3, 0);
	meta->normal_code = (enum bake_normal_code)name_index(
	    attrs, "NormalCode", normal_code_text, 3, 0);
	meta->depth_scale = positive(bake_attrs_get(attrs, "DepthScale"));
	meta->has_wrap = wrap >= 0;
	meta->wrap.clamp_u = wrap >= 0 && (wrap & 1) != 0;
	meta->wrap.clamp_v = wrap >= 0 && (wrap & 2) != 0;
	meta->has_ao_scale = false;
	meta->ao_scale = 0;
	if (bake_attrs_get(attrs, "AOScale") != NULL) {
		meta->ao_scale = positive(bake_attrs_get(attrs, "AOScale"));
		meta->has_ao_scale = true;
	}
	get_list(bake_attrs_get(attrs, "KeepScale"), meta->keep_scale,
	    BAKE_KEEP_SCALES, &meta->nkeep);
	bake_layer_meta_from_attrs(&meta->layer, attrs);
}

void
bake_relief_meta_set_ao_scale(struct bake_relief_meta *meta, double scale)
{
	meta->has_ao_scale = (float)scale != (float)meta->depth_scale;
	meta->ao_scale = meta->has_ao_scale ? scale : 0;
}

double
bake_relief_meta_ao_scale(const struct bake_relief_meta *meta)
{
	return meta->has_ao_scale ? meta->ao_scale : meta->depth_scale;
}

/* The plane and channel that a source names; NULL for a constant, whose value
 * is then in *constant. */
static const struct bake_image *
plane_of(enum bake_source source, const struct bake_image *normal,
    const struct bake_image *ao, const struct bake_image *relief, int *chan,
    float *constant)
{
	*chan = 0;
	*constant = source == BAKE_SOURCE_ONE    ? 1.0f
		    : source == BAKE_SOURCE_HALF ? 0.5f
						 : 0.0f;
	switch (source) {
	case BAKE_SOURCE_NORMAL_X:
	case BAKE_SOURCE_NORMAL_Y:
	case BAKE_SOURCE_NORMAL_Z:
		*chan = (int)(source - BAKE_SOURCE_NORMAL_X);
		return normal;
	case BAKE_SOURCE_AO:
		return ao;
	case BAKE_SOURCE_RELIEF:
		return relief;
	default:
		return NULL;
	}
}

static void
fill_channel(struct bake_image *img, int chan, float value)
{
	for (int y = 0; y < img->height; y++) {
		float *row = bake_image_row(img, y) + chan;

		for (int x = 0; x < img->width; x++)
			row[(size_t)x * (size_t)img->nchans] = value;
	}
}

enum bake_status
bake_relief_pack(const struct bake_target_file *file,
    const struct bake_image *normal, const struct bake_image *ao,
    const struct bake_image *relief, struct bake_image *out,
    struct bake_err *err)
{
	const struct bake_image *size = normal != NULL   ? normal
					: relief != NULL ? relief
							 : ao;
	struct bake_image img = BAKE_IMAGE_INIT;
	enum bake_status rc;

	if (size == NULL)
		return bake_fail(err, BAKE_EINVAL, "no map to pack");
	rc = bake_image_alloc(
	    &img, size->width, size->height, file->nchans, err);
	for (int c = 0; rc == BAKE_OK && c < file->nchans; c++) {
		const struct bake_image *plane;
		enum bake_source source = file->source[c];
		float constant;
		int chan;

		plane = plane_of(source, normal, ao, relief, &chan, &constant);
		if (plane == NULL && source < BAKE_SOURCE_ZERO)
			rc = bake_fail(err, BAKE_EINVAL,
			    "channel %d needs a map that is not there", c);
		else if (plane == NULL)
			fill_channel(&img, c, constant);
		else if (plane->nchans <= chan)
			rc = bake_fail(err, BAKE_EINVAL,
			    "a map has %d channels, expected at least %d",
			    plane->nchans, chan + 1);
		else if (plane->width != img.width ||
			 plane->height != img.height)
			rc = bake_fail(err, BAKE_EINVAL,
			    "a map is %dx%d, expected %dx%d", plane->width,
			    plane->height, img.width, img.height);
		else
			bake_image_copy_channel(&img, c, plane, chan);
	}
	if (rc == BAKE_OK)
		bake_image_swap(out, &img);
	bake_image_free(&img);
	return rc;
}

void
bake_relief_flip(struct bake_image *img, int chan)
{
	for (int y = 0; y < img->height; y++) {
		float *row = bake_image_row(img, y) + chan;

		for (int x = 0; x < img->width; x++) {
			float *v = &row[(size_t)x * (size_t)img->nchans];

			*v = 1.0f - *v;
		}
	}
}

void
bake_normal_decode(
    struct bake_image *img, enum bake_normal_code code, bool flip_y)
{
	int nchans = img->nchans < 3 ? img->nchans : 3;

	for (int y = 0; y < img->height; y++) {
		float *n = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++, n += img->nchans) {
			if (code != BAKE_NORMAL_CODE_SIGNED)
				for (int c = 0; c < nchans; c++)
					n[c] = 2.0f * n[c] - 1.0f;
			if (flip_y)
				n[1] = -n[1];
		}
	}
}

void
bake_normal_encode(struct bake_image *img, bool flip_y)
{
	int nchans = img->nchans < 3 ? img->nchans : 3;

	for (int y = 0; y < img->height; y++) {
		float *n = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++, n += img->nchans) {
			if (flip_y)
				n[1] = -n[1];
			for (int c = 0; c < nchans; c++)
				n[c] = (n[c] + 1.0f) * 0.5f;
		}
	}
}

enum bake_normal_code
bake_normal_code_of(const struct bake_image *img)
{
	double off_signed = 0, off_unsigned = 0;

	for (int y = 0; y < img->height; y++) {
		const float *n = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++, n += img->nchans) {
			double s = 0, u = 0;

			if (n[0] < -0.01f || n[1] < -0.01f)
				return BAKE_NORMAL_CODE_SIGNED;
			for (int c = 0; c < 3 && c < img->nchans; c++) {
				double v = 2.0 * n[c] - 1.0;

				s += (double)n[c] * n[c];
				u += v * v;
			}
			off_signed += fabs(s - 1.0);
			off_unsigned += fabs(u - 1.0);
		}
	}
	return img->nchans >= 3 && off_signed < off_unsigned
		   ? BAKE_NORMAL_CODE_SIGNED
		   : BAKE_NORMAL_CODE_UNSIGNED;
}
