/* Maps that several tools read: normals in any code; maps of other sizes. */
/* SPDX-License-Identifier: MIT */
#include "cmd_maps.h"

#include "inspect.h"
#include "normal.h"
#include "resample.h"

static bool
failed(struct cmd *cmd, const struct cmd_map *map, const struct bake_err *err)
{
	cmd_error(cmd, "%s: %s", map->path, err->msg);
	return false;
}

/* Where x, y and z are: by the names R, G, B, else the first three; returns
 * how many, 2 where z is computed. */
static int
normal_channels(const struct cmd_map *m, int channel[3])
{
	const bool packed = m->meta.layout == BAKE_LAYOUT_RELIEF;
	const int n = packed || m->info.nchans == 2 ? 2 : 3;
	int packed_chan[4];

	for (int c = 0; c < n; c++) {
		const char letter[2] = { "RGB"[c], '\0' };
		int from = cmd_channel_index(&m->info, letter);

		if (packed && cmd_packed_channels(&m->info, packed_chan))
			from = packed_chan[c];
		channel[c] = from < 0 ? c : from;
	}
	return n;
}

/* Whatever the code, to the unsigned one; z for maps that have none. */
static bool
unify_code(struct cmd *cmd, struct cmd_map *m)
{
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_normal_code code = cmd_normal_code(cmd, m);
	bool rebuild = m->img.nchans == 2;

	if (!rebuild && code == BAKE_NORMAL_CODE_UNSIGNED)
		return true;
	bake_normal_decode(&m->img, code, false);
	if (rebuild && bake_normal_normalize(
			   &m->img, cmd->nthreads, NULL, &err) != BAKE_OK)
		return failed(cmd, m, &err);
	bake_normal_encode(&m->img, false);
	return true;
}

bool
cmd_read_normal(struct cmd *cmd, const char *path, struct cmd_map *map)
{
	struct bake_reader *reader;
	int channel[3], n;

	if (!cmd_open(cmd, path, map, &reader))
		return false;
	if (map->info.nchans < 2) {
		cmd_error(cmd, "%s: has 1 channel, a normal map has x, y and z",
		    map->path);
		bake_reader_close(reader);
		return false;
	}
	n = normal_channels(map, channel);
	return cmd_load(cmd, reader, channel, n, map) && unify_code(cmd, map);
}

enum bake_normal_y
cmd_normal_y(const struct cmd *cmd, const struct cmd_map *map)
{
	if (cmd->has_normal_y)
		return cmd->normal_y;
	return map->meta.normal_y != BAKE_NORMAL_Y_UNSURE ? map->meta.normal_y
							  : BAKE_NORMAL_Y_UP;
}

bool
cmd_resize(struct cmd *cmd, struct cmd_map *map, struct bake_wrap wrap,
    int width, int height)
{
	struct bake_image out = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	if (map->img.width == width && map->img.height == height)
		return true;
	if ((long)map->img.width * height != (long)map->img.height * width)
		cmd_warn(cmd,
		    "%s: %dx%d is stretched to %dx%d, so that its texels are "
		    "no longer square",
		    map->path, map->img.width, map->img.height, width, height);
	if (bake_resample(&map->img, wrap, BAKE_FILTER_CATMULL_ROM, width,
		height, cmd->nthreads, &out, &err) != BAKE_OK)
		return failed(cmd, map, &err);
	bake_image_swap(&out, &map->img);
	bake_image_free(&out);
	cmd_note(cmd, "%s: resampled to %dx%d", map->path, width, height);
	return true;
}

bool
cmd_warn_contradictions(struct cmd *cmd, const struct cmd_map *normal,
    const struct cmd_map *relief, struct bake_wrap wrap,
    const struct bake_relief_meta *said, const char *options)
{
	struct bake_maps maps = BAKE_MAPS_INIT;
	struct bake_image part;
	struct bake_inspection found = { .layout = BAKE_LAYOUT_UNKNOWN };
	struct bake_contradictions bad;
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_status rc;

	if (cmd->quiet)
		return true;
	part = cmd_look_at(&normal->img);
	rc = bake_image_alloc(&maps.normal, part.width, part.height, 3, &err);
	if (rc == BAKE_OK) {
		for (int c = 0; c < 3; c++)
			bake_image_copy_channel(&maps.normal, c, &part, c);
		bake_normal_decode(
		    &maps.normal, BAKE_NORMAL_CODE_UNSIGNED, false);
		if (relief != NULL)
			maps.relief = cmd_look_at(&relief->img); /* a view */
		rc = bake_inspect_maps(&found, &maps, wrap, &err);
	}
	bake_image_free(&maps.normal);
	if (rc != BAKE_OK)
		return failed(cmd, normal, &err);
	bake_contradictions_find(&bad, &found, said);
	for (int i = 0; i < bad.n; i++)
		cmd_warn(cmd, "%s%s%s: %s", normal->path,
		    relief != NULL ? " + " : "",
		    relief != NULL ? relief->path : "", bad.text[i]);
	if (bad.n > 0)
		cmd_warn(
		    cmd, "%s: %s say what the maps are", normal->path, options);
	return true;
}
