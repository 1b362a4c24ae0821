/* Multilayer relief textures: what their metadata and their texels say. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "relief_priv.h"

/* How near to its value a written coordinate must be, as a part of the range
 * that it belongs to: far below a step of 65536 texels or of 16-bit depths. */
static const double depth_precision = 1e-9, region_precision = 1e-7;

bool
bake_layout_is_layered(enum bake_layout layout)
{
	return layout >= BAKE_LAYOUT_LAYER_DEPTH &&
	       layout <= BAKE_LAYOUT_LAYER_DEEP;
}

/* near + d (far - near) at d = -1/253 and 254/253, where d' is 0 and 1 */
void
bake_layer_meta_set_range(struct bake_layer_meta *meta, double near, double far)
{
	meta->has_range = true;
	meta->zero = near + (near - far) / 253;
	meta->one = far - (near - far) / 253;
}

void
bake_layer_meta_range(
    const struct bake_layer_meta *meta, double *near, double *far)
{
	*near = meta->zero + (meta->one - meta->zero) / 255;
	*far = meta->one - (meta->one - meta->zero) / 255;
}

enum { DECIMAL = 32 };

/* The shortest decimal that is within tolerance of v. */
static void
format_decimal(char text[DECIMAL], double v, double tolerance)
{
	for (int digits = 1; digits <= 17; digits++) {
		snprintf(text, DECIMAL, "%.*g", digits, v);
		if (fabs(strtod(text, NULL) - v) <= tolerance)
			return;
	}
}

static void
put_range(const struct bake_layer_meta *meta, struct bake_attrs *attrs)
{
	double tolerance = depth_precision * fabs(meta->one - meta->zero);
	char text[DECIMAL];

	format_decimal(text, meta->zero, tolerance);
	bake_attrs_set(attrs, "DepthZero", text);
	format_decimal(text, meta->one, tolerance);
	bake_attrs_set(attrs, "DepthOne", text);
}

static void
put_region(const struct bake_layer_meta *meta, struct bake_attrs *attrs)
{
	const double *r = meta->region;
	double side = fmax(fabs(r[2] - r[0]), fabs(r[3] - r[1]));
	char text[4 * (DECIMAL + 1)] = "";

	for (int i = 0; i < 4; i++) {
		if (i > 0)
			strcat(text, ",");
		format_decimal(
		    text + strlen(text), r[i], region_precision * side);
	}
	bake_attrs_set(attrs, "Region", text);
}

void
bake_layer_meta_to_attrs(
    const struct bake_layer_meta *meta, struct bake_attrs *attrs)
{
	char text[DECIMAL];

	if (meta->nlayers <= 0)
		return;
	bake_attrs_set_number(attrs, "Layers", meta->nlayers);
	if (meta->texture > 0) {
		snprintf(
		    text, sizeof text, "%d/%d", meta->texture, meta->ntextures);
		bake_attrs_set(attrs, "Texture", text);
	}
	if (meta->has_range)
		put_range(meta, attrs);
	if (meta->axis[0] != '\0')
		bake_attrs_set(attrs, "Axis", meta->axis);
	if (meta->has_region)
		put_region(meta, attrs);
	if (meta->mip_level > 0)
		bake_attrs_set_number(attrs, "MipLevel", meta->mip_level);
	if (meta->has_tau)
		bake_attrs_set_number(attrs, "Tau", meta->tau);
	if (meta->has_plane)
		bake_attrs_set_number(attrs, "Plane", meta->plane);
}

/* The n finite numbers that a text is, separated by sep, and nothing else. */
static bool
get_numbers(const char *text, char sep, int n, double *v)
{
	char *end;

	for (int i = 0; i < n; i++) {
		if (text == NULL || *text == '\0')
			return false;
		v[i] = strtod(text, &end);
		if (end == text || !isfinite(v[i]) ||
		    *end != (i < n - 1 ? sep : '\0'))
			return false;
		text = end + 1;
	}
	return true;
}

static bool
get_number(const struct bake_attrs *attrs, const char *name, double *v)
{
	return get_numbers(bake_attrs_get(attrs, name), '\0', 1, v);
}

/* The whole number of the attribute, lo .. hi; 0 where it is none. */
static int
get_whole(const struct bake_attrs *attrs, const char *name, int lo, int hi)
{
	double v;

	if (!get_number(attrs, name, &v) || v < lo || v > hi || v != floor(v))
		return 0;
	return (int)v;
}

static void
get_texture(struct bake_layer_meta *meta, const char *text)
{
	double v[2];

	if (!get_numbers(text, '/', 2, v) || v[0] < 1 || v[0] > v[1] ||
	    v[1] > BAKE_LAYERS_SAID || v[0] != floor(v[0]) ||
	    v[1] != floor(v[1]))
		return;
	meta->texture = (int)v[0];
	meta->ntextures = (int)v[1];
}

static void
get_axis(struct bake_layer_meta *meta, const char *text)
{
	if (text != NULL && strlen(text) == 2 && strchr("+-", text[0]) &&
	    strchr("xyz", text[1]))
		memcpy(meta->axis, text, sizeof meta->axis);
}

void
bake_layer_meta_from_attrs(
    struct bake_layer_meta *meta, const struct bake_attrs *attrs)
{
	double *r = meta->region;

	memset(meta, 0, sizeof *meta);
	meta->nlayers = get_whole(attrs, "Layers", 1, BAKE_LAYERS_SAID);
	if (meta->nlayers == 0)
		return;
	get_texture(meta, bake_attrs_get(attrs, "Texture"));
	meta->has_range = get_number(attrs, "DepthZero", &meta->zero) &&
			  get_number(attrs, "DepthOne", &meta->one) &&
			  meta->zero != meta->one;
	get_axis(meta, bake_attrs_get(attrs, "Axis"));
	meta->has_region =
	    get_numbers(bake_attrs_get(attrs, "Region"), ',', 4, r) &&
	    r[0] < r[2] && r[1] < r[3];
	meta->mip_level = get_whole(attrs, "MipLevel", 1, 30);
	meta->has_tau = get_number(attrs, "Tau", &meta->tau) &&
			meta->tau >= 0 && meta->tau <= 1;
	meta->has_plane = get_number(attrs, "Plane", &meta->plane);
	if (!meta->has_range)
		meta->zero = meta->one = 0;
	if (!meta->has_region)
		memset(r, 0, sizeof meta->region);
	if (!meta->has_tau)
		meta->tau = 0;
	if (!meta->has_plane)
		meta->plane = 0;
}

/* How many layers the texel has, n of its channels at most. */
static int
check_texel(const float *v, int n, double slack, struct bake_layer_check *check)
{
	int count = 0;
	bool ordered = true;

	for (int c = 0; c < n; c++) {
		if (!(v[c] < 1.0f)) {
			/* that is: 1, or no stored value at all */
			check->outside += v[c] != 1.0f;
			continue;
		}
		if (count != c || (c > 0 && !(v[c] > v[c - 1])))
			ordered = false;
		if (v[c] < 1.0 / 255 - slack || v[c] > 254.0 / 255 + slack)
			check->outside++;
		check->min = fmin(check->min, v[c]);
		check->max = fmax(check->max, v[c]);
		count++;
	}
	check->unordered += !ordered;
	return count;
}

void
bake_layer_check(const struct bake_image *img, const int rgba[4], int nlayers,
    int code_max, struct bake_layer_check *check)
{
	double slack = code_max > 0 ? 0.5 / code_max : 0x1p-11;
	int n = img->nchans < 4 ? img->nchans : 4;

	memset(check, 0, sizeof *check);
	check->min = check->max = NAN;
	for (int y = 0; y < img->height; y++) {
		const float *t = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++, t += img->nchans) {
			float v[4] = { 1, 1, 1, 1 };
			int count;

			for (int c = 0; c < n; c++)
				v[c] = t[rgba[c]];
			count = check_texel(v, 4, slack, check);
			check->texels[count]++;
			check->odd += nlayers != 1 && count % 2 != 0;
		}
	}
}
