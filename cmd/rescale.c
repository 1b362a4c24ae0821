/* rm-rescale-ao: where a file keeps its AO, and writing it back. */
/* SPDX-License-Identifier: MIT */
#include "rescale.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "inspect.h"
#include "repair.h"

/* -- finding it ---------------------------------------------------------- */

/* Layouts that hold no AO, and the way out. */
static const char *
way_out(enum bake_layout layout)
{
	switch (layout) {
	case BAKE_LAYOUT_NORMAL:
		return "is a normal map, which does not depend on AO; give the "
		       "AO map, or --channel NAME";
	case BAKE_LAYOUT_NORMAL_RELIEF:
		return "holds normals and a relief but no AO; give the AO map, "
		       "or --channel NAME";
	case BAKE_LAYOUT_DEPTH:
		return "is a relief map; rm-aobake -s S bakes its AO";
	case BAKE_LAYOUT_BENT:
		return "is a bent normal map, which Eq. 6 cannot rescale; "
		       "rm-aobake -s S --bent-normal FILE bakes it anew";
	case BAKE_LAYOUT_HORIZONS:
		return "is a file of horizons; give it as --horizons, and the "
		       "AO map as input";
	default:
		return NULL;
	}
}

static int
named_channel(const struct bake_image_info *info)
{
	static const char *const names[] = { "ao", "occlusion",
		"ambientocclusion", "ambient_occlusion" };

	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		for (int c = 0; c < info->nchans && c < BAKE_INFO_NAMES; c++)
			if (strcasecmp(info->names[c], names[i]) == 0)
				return c;
	return -1;
}

/* Whether the first three channels are one grey, but for the noise of a
 * conversion; they are then all taken for it. */
static bool
is_grey(struct cmd *cmd, const struct rescale_file *f)
{
	const struct bake_image *img = &f->map.img;
	const float noise = 2 / 255.0f;
	size_t ndiffer = 0;

	for (int y = 0; y < img->height; y++) {
		const float *v = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++, v += img->nchans) {
			if (!(fabsf(v[0] - v[1]) <= noise &&
				fabsf(v[0] - v[2]) <= noise))
				return false;
			ndiffer += v[0] != v[1] || v[0] != v[2];
		}
	}
	if (ndiffer > 0)
		cmd_warn(cmd,
		    "%s: is grey but for %zu texels; R is taken for all three "
		    "channels",
		    f->map.path, ndiffer);
	return true;
}

/* Three or four channels of which nothing tells. */
static bool
guess(struct cmd *cmd, struct rescale_file *f)
{
	enum bake_layout layout = BAKE_LAYOUT_UNKNOWN;
	struct bake_err err = BAKE_ERR_INIT;
	int rgba[4] = { 0, 1, 2, 3 };
	const char *out;

	if (f->map.info.nchans <= 4 && is_grey(cmd, f)) {
		f->n = 3;
		return true;
	}
	cmd_packed_channels(&f->map.info, rgba);
	if (bake_layout_guess(&f->map.img, rgba, BAKE_NORMAL_CODE_UNSIGNED,
		&layout, &err) != BAKE_OK) {
		cmd_error(cmd, "%s: %s", f->map.path, err.msg);
		return false;
	}
	if (layout == BAKE_LAYOUT_RELIEF) {
		cmd_warn(cmd,
		    "%s: read as a packed texture, with the AO in B; --channel "
		    "NAME takes another",
		    f->map.path);
		f->first = rgba[2];
		f->has_normals = true;
		return true;
	}
	out =
	    layout == BAKE_LAYOUT_NORMAL || layout == BAKE_LAYOUT_NORMAL_RELIEF
		? way_out(layout)
		: NULL;
	cmd_error(cmd, "%s: %s", f->map.path,
	    out != NULL ? out
			: "its channels differ and nothing says which one "
			  "holds AO; say --channel R (glTF, Unreal, Godot), G "
			  "(Unity's mask) or another");
	return false;
}

static bool
find_channel(struct cmd *cmd, const char *channel, struct rescale_file *f)
{
	const struct bake_image_info *info = &f->map.info;
	const enum bake_layout layout = f->map.meta.layout;
	const char *no_ao = way_out(layout);
	int rgba[4], named = named_channel(info);
	bool packed = cmd_packed_channels(info, rgba);

	if (channel != NULL) {
		f->first = cmd_channel_index(info, channel);
		if (f->first < 0)
			cmd_error(cmd, "%s: has no channel %s (it has %d)",
			    f->map.path, channel, info->nchans);
		return f->first >= 0;
	}
	if (no_ao != NULL) {
		cmd_error(cmd, "%s: %s", f->map.path, no_ao);
		return false;
	}
	if (layout == BAKE_LAYOUT_RELIEF && packed)
		f->first = rgba[2];
	else if (layout == BAKE_LAYOUT_ORM)
		f->first = 0;
	else if (layout == BAKE_LAYOUT_MASK && info->nchans > 1)
		f->first = cmd_channel_index(info, "G");
	else if (named >= 0)
		f->first = named;
	else if (info->nchans > 2 && layout == BAKE_LAYOUT_AO)
		f->n = is_grey(cmd, f) ? 3 : 1;
	else if (info->nchans > 2)
		return guess(cmd, f);
	return true;
}

/* The AO's own scale where the file has one, else that of all its maps. */
static double
scale_of(const struct bake_attrs *attrs)
{
	const char *value = bake_attrs_get(attrs, "AOScale");
	char *end;
	double v;

	if (value == NULL)
		value = bake_attrs_get(attrs, "DepthScale");
	if (value == NULL)
		return -1;
	v = strtod(value, &end);
	return *end == '\0' && v >= 0 && v <= 1e6 ? v : -1;
}

bool
rescale_open(struct cmd *cmd, const char *path, const char *channel,
    struct rescale_file *f)
{
	memset(f, 0, sizeof *f);
	f->n = 1;
	if (!cmd_read_raw(cmd, path, &f->map))
		return false;
	f->scale = scale_of(&f->map.info.attrs);
	f->has_normals = f->map.meta.layout == BAKE_LAYOUT_RELIEF ||
			 f->map.meta.layout == BAKE_LAYOUT_NORMAL_RELIEF ||
			 f->map.meta.layout == BAKE_LAYOUT_NORMAL ||
			 f->map.meta.layout == BAKE_LAYOUT_DEPTH ||
			 cmd_channel_index(&f->map.info, "normal.x") >= 0;
	if (f->map.info.nchans > BAKE_INFO_NAMES) {
		cmd_error(cmd, "%s: has %d channels, expected at most %d",
		    f->map.path, f->map.info.nchans, BAKE_INFO_NAMES);
		return false;
	}
	if (!find_channel(cmd, channel, f))
		return false;
	if (f->map.info.nchans == 4 &&
	    cmd_packed_channels(&f->map.info, f->rgba))
		for (int c = 0; c < 4; c++)
			f->has_order |= f->rgba[c] != c;
	return true;
}

void
rescale_close(struct rescale_file *f)
{
	cmd_map_free(&f->map);
}

/* -- the values ---------------------------------------------------------- */

bool
rescale_take(
    struct cmd *cmd, const struct rescale_file *f, struct bake_image *ao)
{
	const struct bake_image *img = &f->map.img;
	struct bake_err err = BAKE_ERR_INIT;
	size_t nbad = 0, nbeyond = 0;

	if (bake_image_alloc(ao, img->width, img->height, 1, &err) != BAKE_OK)
		goto fail;
	bake_image_copy_channel(ao, 0, img, f->first);
	if (bake_repair_nonfinite(ao, cmd_wrap(cmd, &f->map), cmd->nthreads,
		&nbad, &err) != BAKE_OK)
		goto fail;
	for (int y = 0; y < ao->height; y++) {
		float *v = bake_image_row(ao, y);

		for (int x = 0; x < ao->width; x++) {
			nbeyond += v[x] < -1e-6f || v[x] > 1 + 1e-6f;
			v[x] = v[x] < 0 ? 0 : v[x] > 1 ? 1 : v[x];
		}
	}
	if (nbad > 0)
		cmd_warn(cmd,
		    "%s: %zu texels of AO are not numbers (or beyond 1e30); "
		    "filled from their neighbours",
		    f->map.path, nbad);
	if (nbeyond > 0)
		cmd_warn(cmd,
		    "%s: %zu texels of AO lie outside 0 to 1; the nearest of "
		    "the two is taken",
		    f->map.path, nbeyond);
	return true;
fail:
	cmd_error(cmd, "%s: %s", f->map.path, err.msg);
	bake_image_free(ao);
	return false;
}

/* -- writing it back ----------------------------------------------------- */

/*
 * DepthScale is the scale that normals agree with: where there are some it
 * stays, and AOScale says that the AO belongs to another one. A file of AO
 * alone has one scale.
 */
static void
set_scale(struct bake_attrs *attrs, const struct rescale_file *f, double scale)
{
	const bool same = (float)scale == (float)f->map.meta.depth_scale;

	bake_attrs_remove(attrs, "AOScale");
	if (!f->has_normals)
		bake_attrs_remove(attrs, "DepthScale");
	if (scale >= 0 && !(f->has_normals && same))
		bake_attrs_set_number(
		    attrs, f->has_normals ? "AOScale" : "DepthScale", scale);
}

/* The channels in R G B A order: only EXR files have names to tell. */
static bool
reorder(struct cmd *cmd, struct rescale_file *f)
{
	struct bake_image out = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_image_alloc(&out, f->map.img.width, f->map.img.height, 4,
		&err) != BAKE_OK) {
		cmd_error(cmd, "%s: %s", f->map.path, err.msg);
		return false;
	}
	for (int c = 0; c < 4; c++)
		bake_image_copy_channel(&out, c, &f->map.img, f->rgba[c]);
	bake_image_swap(&out, &f->map.img);
	bake_image_free(&out);
	f->has_order = false;
	return true;
}

bool
rescale_write(struct cmd *cmd, struct rescale_file *f,
    const struct bake_image *ao, double scale, const char *path)
{
	const struct bake_image_info *info = &f->map.info;
	struct bake_attrs attrs = info->attrs;
	enum bake_file_type type = cmd->type;
	const char *names[BAKE_INFO_NAMES];

	for (int c = 0; c < f->n; c++)
		bake_image_copy_channel(&f->map.img, f->first + c, ao, 0);
	for (int c = 0; c < info->nchans; c++)
		names[c] = info->names[c];
	bake_file_type_from_path(path, &type);
	if (type != BAKE_FILE_EXR && f->has_order && !reorder(cmd, f))
		return false;
	set_scale(&attrs, f, scale);
	return cmd_write_attrs(cmd, &f->map.img, path, info->data_format,
	    &attrs, type == BAKE_FILE_EXR ? names : NULL);
}
