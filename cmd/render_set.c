/* rm-render: reading what rm-multilayer wrote. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io_exr.h"
#include "render_tool.h"

/* Where the images of a set come from: files, or the parts of one. */
struct source {
	struct cmd *cmd;
	const char *prefix, *ext; /* files */
	struct bake_exr *exr;     /* parts */
};

static bool
failed(struct cmd *cmd, const char *path, const struct bake_err *err)
{
	cmd_error(cmd, "%s: %s", path, err->msg);
	return false;
}

/* "depth", "depth2" … */
static void
name_of(char *name, size_t size, const char *kind, int i)
{
	if (i == 0)
		snprintf(name, size, "%s", kind);
	else
		snprintf(name, size, "%s%d", kind, i + 1);
}

static char *
path_of(const struct source *s, const char *name)
{
	char *path;

	return asprintf(&path, "%s_%s.%s", s->prefix, name, s->ext) < 0 ? NULL
									: path;
}

static bool
has_image(const struct source *s, const char *name)
{
	char *path;
	bool has;

	if (s->exr != NULL)
		return bake_exr_find_part(s->exr, name) >= 0;
	path = path_of(s, name);
	has = path != NULL && access(path, F_OK) == 0;
	free(path);
	return has;
}

/* A part as a map. */
static bool
read_part(const struct source *s, const char *name, struct cmd_map *map)
{
	const int part = bake_exr_find_part(s->exr, name);
	struct bake_pixels px = BAKE_PIXELS_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	if (part < 0) {
		cmd_error(s->cmd, "%s: has no part '%s'", s->prefix, name);
		return false;
	}
	map->info = bake_exr_info(s->exr, part)->info;
	bake_relief_meta_from_attrs(&map->meta, &map->info.attrs);
	ok = bake_exr_read(s->exr, part, NULL, 0, &px, &err) == BAKE_OK &&
	     bake_image_alloc(
		 &map->img, px.width, px.height, px.nchans, &err) == BAKE_OK;
	for (int y = 0; ok && y < px.height; y++)
		bake_pixels_get(
		    &px, 0, y, px.width, bake_image_row(&map->img, y));
	bake_pixels_free(&px);
	return ok || failed(s->cmd, s->prefix, &err);
}

static bool
read_image(const struct source *s, const char *name, struct cmd_map *map)
{
	char *path;
	bool ok;

	if (s->exr != NULL)
		return read_part(s, name, map);
	path = path_of(s, name);
	ok = path != NULL && cmd_read(s->cmd, path, map);
	map->path = s->prefix; /* for messages; path goes */
	free(path);
	return ok;
}

/* Which channel of the file is layer c of R, G, B, A. */
static bool
channel_order(const struct source *s, const char *name,
    const struct cmd_map *map, int rgba[4])
{
	if (map->img.nchans == 4 && cmd_packed_channels(&map->info, rgba))
		return true;
	cmd_error(s->cmd, "%s: %s has %d channels, expected R, G, B and A",
	    s->prefix, name, map->img.nchans);
	return false;
}

/* One image into the pixels of the maps; mirrored where y is down. */
static bool
put_image(const struct source *s, const char *kind, int t,
    struct bake_layer_maps *maps, struct bake_pixels *px,
    struct bake_relief_meta *meta)
{
	struct cmd_map map = CMD_MAP_INIT;
	char name[32];
	int rgba[4];
	bool ok, flip;

	name_of(name, sizeof name, kind, t);
	ok = read_image(s, name, &map) && channel_order(s, name, &map, rgba);
	if (ok &&
	    (map.img.width != maps->width || map.img.height != maps->height)) {
		cmd_error(s->cmd, "%s: %s is %dx%d, depth is %dx%d", s->prefix,
		    name, map.img.width, map.img.height, maps->width,
		    maps->height);
		ok = false;
	}
	flip =
	    strcmp(kind, "ny") == 0 && map.meta.normal_y == BAKE_NORMAL_Y_DOWN;
	for (int y = 0; ok && y < maps->height; y++)
		for (int x = 0; x < maps->width; x++) {
			const float *in = bake_image_row(&map.img, y) + 4 * x;
			float out[4];

			for (int c = 0; c < 4; c++)
				out[c] = flip ? 1 - in[rgba[c]] : in[rgba[c]];
			bake_pixels_put(px, x, y, 1, out);
		}
	if (t == 0 && meta != NULL)
		*meta = map.meta;
	cmd_map_free(&map);
	return ok;
}

static bool
read_maps(const struct source *s, struct render_layer_set *set)
{
	struct cmd_map first = CMD_MAP_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	int n = 0, nlayers;
	char name[32];
	bool ok = read_image(s, "depth", &first);

	do
		name_of(name, sizeof name, "depth", ++n);
	while (n < BAKE_LAYER_TEXTURES && has_image(s, name));
	/* a height field is solid below its one depth */
	nlayers = n == 1 && first.meta.layer.nlayers == 1 ? 1 : 4 * n;
	ok = ok && (bake_layer_maps_alloc(&set->maps, first.img.width,
			first.img.height, nlayers, BAKE_DATA_FLOAT, 0, 3,
			BAKE_DATA_FLOAT, &err) == BAKE_OK ||
		       failed(s->cmd, s->prefix, &err));
	cmd_map_free(&first);
	for (int t = 0; ok && t < n; t++)
		ok =
		    put_image(s, "depth", t, &set->maps, &set->maps.depth[t],
			&set->meta) &&
		    put_image(s, "nx", t, &set->maps, &set->maps.nx[t], NULL) &&
		    put_image(s, "ny", t, &set->maps, &set->maps.ny[t], NULL);
	return ok;
}

static bool
read_color(const struct source *s, const struct bake_color *color,
    struct render_layer_set *set)
{
	struct cmd_map map = CMD_MAP_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	if (!has_image(s, "color"))
		return true;
	ok = read_image(s, "color", &map);
	if (ok && bake_data_format_max(map.info.data_format) != 0)
		ok = bake_color_to_linear(color, "sRGB", &map.img,
			 s->cmd->nthreads, &err) == BAKE_OK ||
		     failed(s->cmd, s->prefix, &err);
	if (ok)
		bake_image_swap(&set->color, &map.img);
	cmd_map_free(&map);
	return ok;
}

/* Which type the set's files are of; false where there is none. */
static bool
find_type(struct source *s)
{
	static const char *const types[] = { "png", "tga", "tiff", "tif",
		"exr" };

	for (int i = 0; i < 5; i++) {
		s->ext = types[i];
		if (has_image(s, "depth"))
			return true;
	}
	cmd_error(s->cmd, "%s: there is no %s_depth.png, .tga, .tiff or .exr",
	    s->prefix, s->prefix);
	return false;
}

bool
render_read_set(struct cmd *cmd, const struct bake_color *color,
    const char *prefix, struct render_layer_set *set)
{
	struct source s = { cmd, prefix, NULL, NULL };
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_file_type type;
	bool ok;

	if (bake_file_type_from_path(prefix, &type) && type == BAKE_FILE_EXR) {
		ok = bake_exr_open(&s.exr, prefix, &cmd->limits, &err) ==
		     BAKE_OK;
		if (!ok)
			cmd_error(cmd, "%s", err.msg);
		else
			cmd_list_add(&cmd->read, prefix);
	} else
		ok = find_type(&s);
	ok = ok && read_maps(&s, set) && read_color(&s, color, set);
	bake_exr_close(s.exr);
	return ok;
}
