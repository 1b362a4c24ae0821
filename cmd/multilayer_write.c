/* rm-multilayer: sets of textures to files. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "multilayer_tool.h"

static bool
failed(struct cmd *cmd, const char *path, const struct bake_err *err)
{
	cmd_error(cmd, "%s: %s", path, err->msg);
	return false;
}

/* -- what a set consists of ---------------------------------------------------
 */

static bool
add_image(struct cmd *cmd, struct multilayer_album *a,
    const struct multilayer_set *set, const struct bake_pixels *px,
    enum bake_layout layout, int i, int n)
{
	static const char *const kinds[] = { "depth", "nx", "ny", "color" };
	const char *kind = kinds[layout - BAKE_LAYOUT_LAYER_DEPTH];
	struct multilayer_image *image;

	if (a->n == a->room) {
		int room = 2 * a->room + 8;
		struct multilayer_image *more =
		    realloc(a->image, (size_t)room * sizeof *more);

		if (more == NULL) {
			cmd_error(cmd, "no memory");
			return false;
		}
		a->image = more;
		a->room = room;
	}
	image = &a->image[a->n++];
	if (i == 0)
		snprintf(image->name, MULTILAYER_NAME, "%s", kind);
	else
		snprintf(image->name, MULTILAYER_NAME, "%s%d", kind, i + 1);
	image->px = px;
	image->meta = set->meta;
	image->meta.layout = layout;
	image->meta.layer.texture = n > 1 ? i + 1 : 0;
	image->meta.layer.ntextures = n > 1 ? n : 0;
	if (layout == BAKE_LAYOUT_LAYER_COLOR ||
	    layout == BAKE_LAYOUT_LAYER_DEPTH)
		image->meta.normal_y = BAKE_NORMAL_Y_UNSURE;
	else
		image->meta.normal_code = BAKE_NORMAL_CODE_UNSIGNED;
	if (layout != BAKE_LAYOUT_LAYER_DEPTH)
		image->meta.polarity = BAKE_POLARITY_UNSURE;
	return true;
}

static bool
add_set(struct cmd *cmd, struct multilayer_album *a,
    const struct multilayer_set *set)
{
	const struct bake_layer_maps *m = &set->maps;
	const struct {
		enum bake_layout layout;
		const struct bake_pixels *px;
		int n;
	} kind[] = { { BAKE_LAYOUT_LAYER_DEPTH, m->depth, m->ntextures },
		{ BAKE_LAYOUT_LAYER_NX, m->nx, m->ntextures },
		{ BAKE_LAYOUT_LAYER_NY, m->ny, m->ntextures },
		{ BAKE_LAYOUT_LAYER_COLOR, m->color, m->ncolors } };

	for (size_t k = 0; k < sizeof kind / sizeof *kind; k++)
		for (int i = 0; i < kind[k].n; i++)
			if (!add_image(cmd, a, set, &kind[k].px[i],
				kind[k].layout, i, kind[k].n))
				return false;
	return true;
}

/* Normals' y as the output wants it. What no layer has put there stays 1/2. */
static void
turn_row(struct bake_layer_maps *m, int t, int y, float *row, float *depth)
{
	bake_pixels_get(&m->ny[t], 0, y, m->width, row);
	bake_pixels_get(&m->depth[t], 0, y, m->width, depth);
	for (int i = 0; i < 4 * m->width; i++)
		if (depth[i] < 1 || fabsf(row[i] - 0.5F) > 0.6F / 255)
			row[i] = 1 - row[i];
	bake_pixels_put(&m->ny[t], 0, y, m->width, row);
}

static bool
turn_y(struct cmd *cmd, struct multilayer_set *set, enum bake_normal_y normal_y)
{
	struct bake_layer_maps *m = &set->maps;
	float *row;

	if (set->meta.normal_y == normal_y)
		return true;
	row = calloc((size_t)m->width, 8 * sizeof *row);
	if (row == NULL) {
		cmd_error(cmd, "no memory");
		return false;
	}
	for (int t = 0; t < m->ntextures; t++)
		for (int y = 0; y < m->height; y++)
			turn_row(m, t, y, row, row + 4 * (size_t)m->width);
	set->meta.normal_y = normal_y;
	free(row);
	return true;
}

/* Dilated, and turned as the renderer wants it. */
static bool
finish_set(struct cmd *cmd, const struct multilayer_opts *o,
    struct multilayer_set *set, const char *prefix)
{
	const enum bake_normal_y y =
	    cmd->output_normal_y != BAKE_NORMAL_Y_UNSURE ? cmd->output_normal_y
	    : o->policarpo                               ? BAKE_NORMAL_Y_DOWN
							 : BAKE_NORMAL_Y_UP;
	const int dilate = o->dilate >= 0 ? o->dilate : o->impostor ? 8 : 0;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_layer_dilate(&set->maps, dilate, o->tile_x, o->tile_y,
		cmd->nthreads, &err) != BAKE_OK)
		return failed(cmd, prefix, &err);
	return turn_y(cmd, set, y);
}

/* -- files --------------------------------------------------------------------
 */

static bool
write_image(
    struct cmd *cmd, const struct multilayer_image *image, const char *prefix)
{
	struct bake_write_params p = { .type = cmd->type,
		.data_format = image->px->format,
		.png_level = cmd->png_level };
	char suffix[MULTILAYER_NAME + 8], *path;
	bool ok;

	snprintf(suffix, sizeof suffix, "_%s.%s", image->name,
	    bake_file_type_name(cmd->type));
	if (asprintf(&path, "%s%s", prefix, suffix) < 0) {
		cmd_error(cmd, "%s: no memory", prefix);
		return false;
	}
	bake_relief_meta_to_attrs(&image->meta, &p.attrs);
	ok = cmd_write_pixels(cmd, image->px, path, &p);
	free(path);
	return ok;
}

/* A set as files of its own. */
static bool
write_files(
    struct cmd *cmd, const struct multilayer_set *set, const char *prefix)
{
	struct multilayer_album a = { NULL, 0, 0 };
	bool ok = add_set(cmd, &a, set);

	for (int i = 0; ok && i < a.n; i++)
		ok = write_image(cmd, &a.image[i], prefix);
	free(a.image);
	return ok;
}

static bool
write_preview(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_color *color, const struct multilayer_set *set)
{
	struct bake_image picture = BAKE_IMAGE_INIT;
	struct bake_write_params p = { .type = BAKE_FILE_PNG,
		.data_format = BAKE_DATA_UINT8,
		.png_level = cmd->png_level };
	struct bake_err err = BAKE_ERR_INIT;
	char *path = multilayer_preview_path(o, set->meta.layer.axis[1]);
	bool ok;

	(void)bake_file_type_from_path(path, &p.type);
	p.data_format = bake_file_type_nearest(p.type, BAKE_DATA_UINT8);
	ok = bake_layer_picture(&set->maps, color, &picture, &err) == BAKE_OK ||
	     failed(cmd, path, &err);
	ok = ok && cmd_write_as(cmd, &picture, path, &p);
	bake_image_free(&picture);
	free(path);
	return ok;
}

/* -- levels -------------------------------------------------------------------
 */

static int
count_levels(const struct multilayer_opts *o, const struct bake_layer_maps *m)
{
	int side = m->width > m->height ? m->width : m->height, n = 0;

	while (side > 1) {
		side >>= 1;
		n++;
	}
	return o->mips == MULTILAYER_ALL || o->mips > n ? n : o->mips;
}

static bool
make_level(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_color *color, const struct multilayer_set *first,
    int level, const char *prefix, struct multilayer_set *set)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_layer_mip mip;

	set->meta = first->meta;
	if (bake_layer_mip(&first->maps, level, o->mip_half, color,
		cmd->nthreads, &set->maps, &mip, &err) != BAKE_OK)
		return failed(cmd, prefix, &err);
	cmd_note(cmd,
	    "%s: level %d is solid where more than %.4g of a texel is, volume "
	    "%.6g of %.6g",
	    prefix, level, mip.tau, mip.volume, mip.volume0);
	set->meta.layer.mip_level = level;
	set->meta.layer.has_tau = set->maps.nlayers > 1;
	set->meta.layer.tau = mip.tau;
	return true;
}

/* The first level and those that follow, each finished; those that follow are
 * made before the first is turned. */
static bool
make_levels(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_color *color, struct multilayer_set *level, int n,
    const char *prefix)
{
	bool ok = true;

	for (int i = 1; ok && i <= n; i++)
		ok = make_level(cmd, o, color, &level[0], i, prefix, &level[i]);
	for (int i = 0; ok && i <= n; i++)
		ok = finish_set(cmd, o, &level[i], prefix);
	return ok;
}

/* All levels as parts of one file; those of level 1 are called mip1.depth … */
static bool
write_one_file(struct cmd *cmd, const struct multilayer_set *level, int n,
    const char *prefix)
{
	struct multilayer_album a = { NULL, 0, 0 };
	bool ok = true;

	for (int i = 0; ok && i <= n; i++) {
		int first = a.n;

		ok = add_set(cmd, &a, &level[i]);
		for (int k = first; ok && i > 0 && k < a.n; k++) {
			char name[MULTILAYER_NAME];

			snprintf(name, sizeof name, "mip%d.%.20s", i,
			    a.image[k].name);
			strcpy(a.image[k].name, name);
		}
	}
	ok = ok && multilayer_write_parts(cmd, &a, prefix);
	free(a.image);
	return ok;
}

static bool
write_levels(struct cmd *cmd, const struct multilayer_opts *o,
    struct multilayer_set *level, int n, const char *prefix)
{
	bool ok = true;

	if (o->multi_part)
		return write_one_file(cmd, level, n, prefix);
	for (int i = 0; ok && i <= n; i++) {
		char *name = NULL;

		if (i == 0)
			name = cmd_copy(prefix);
		else if (asprintf(&name, "%s_mip%d", prefix, i) < 0)
			cmd_need(NULL);
		ok = write_files(cmd, &level[i], name);
		free(name);
	}
	return ok;
}

bool
multilayer_write(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_color *color, struct multilayer_set *set,
    const char *prefix)
{
	const int n = count_levels(o, &set->maps);
	struct multilayer_set *level = calloc((size_t)n + 1, sizeof *level);
	bool ok = level != NULL;

	if (!ok)
		cmd_error(cmd, "%s: no memory", prefix);
	multilayer_plan_set(cmd, o, &set->maps, n, prefix);
	/* before its normals are turned */
	ok = ok && (o->preview == NULL || write_preview(cmd, o, color, set));
	if (ok) {
		level[0] = *set;
		ok = make_levels(cmd, o, color, level, n, prefix) &&
		     write_levels(cmd, o, level, n, prefix);
		for (int i = 1; i <= n; i++)
			bake_layer_maps_free(&level[i].maps);
		*set = level[0];
	}
	free(level);
	return ok;
}
