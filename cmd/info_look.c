/* What is in a file, or in a pair of them: maps, conventions, mistakes. */
/* SPDX-License-Identifier: MIT */
#include "info.h"

#include <math.h>
#include <stdlib.h>

#include "mem.h"

void
info_report_free(struct info_report *r)
{
	free(r->range);
	r->range = NULL;
	bake_maps_free(&r->maps);
	cmd_map_free(&r->map);
	cmd_map_free(&r->normal);
}

const char *
info_layout(const struct info_report *r)
{
	return r->pair ? "pair" : bake_layout_name(r->found.layout);
}

const char *
info_channel(const struct cmd_map *map, int channel)
{
	return channel < BAKE_INFO_NAMES ? map->info.names[channel] : "?";
}

/* Metadata, with the options put over them. */
static struct bake_relief_meta
declared(const struct cmd *cmd, const struct info_opts *o,
    const struct info_report *r)
{
	struct bake_relief_meta said = r->map.meta;

	if (cmd->has_polarity)
		said.polarity = cmd->polarity;
	if (cmd->has_normal_y)
		said.normal_y = cmd->normal_y;
	else if (r->pair)
		said.normal_y = r->normal.meta.normal_y;
	if (o->depth_scale > 0)
		said.depth_scale = o->depth_scale;
	return said;
}

/* The channels in R G B A order: by name where all four are found. */
static void
find_rgba(const struct bake_image_info *info, int rgba[4])
{
	if (cmd_packed_channels(info, rgba))
		return;
	for (int c = 0; c < 4; c++)
		rgba[c] = c < info->nchans ? c : 0;
}

/* The relief's channel by --channel or by its name; -1 where neither says. */
static bool
find_relief(struct cmd *cmd, const struct info_opts *o,
    const struct cmd_map *map, int *channel)
{
	if (o->channel == NULL) {
		*channel = cmd_relief_channel(&map->info);
		return true;
	}
	*channel = cmd_channel_index(&map->info, o->channel);
	if (*channel < 0)
		cmd_error(cmd, "%s: has no channel %s (it has %d)", map->path,
		    o->channel, map->info.nchans);
	return *channel >= 0;
}

/*
 * The layout by the metadata, by the relief's name, else by the texels; then
 * relief_channel, which comes in as the named one or -1. A relief named in the
 * place of A may be that of a packed texture, so the texels are asked first;
 * one that --channel names elsewhere is a relief and nothing more.
 */
static enum bake_status
find_layout(const struct info_opts *o, const struct cmd_map *map,
    const int rgba[4], enum bake_normal_code code,
    struct bake_inspection *found, struct bake_err *err)
{
	const int named = found->relief_channel;
	const bool elsewhere =
	    named >= 0 && (map->info.nchans < 4 || named != rgba[3]);
	enum bake_status rc = BAKE_OK;

	found->layout = map->meta.layout;
	if (elsewhere &&
	    (found->layout == BAKE_LAYOUT_UNKNOWN || o->channel != NULL))
		found->layout = BAKE_LAYOUT_DEPTH;
	if (found->layout == BAKE_LAYOUT_UNKNOWN) {
		found->guessed = true;
		rc = bake_layout_guess(
		    &map->img, rgba, code, &found->layout, err);
	}
	if (found->layout == BAKE_LAYOUT_UNKNOWN && named >= 0)
		found->layout = BAKE_LAYOUT_DEPTH;
	if (found->layout == BAKE_LAYOUT_RELIEF ||
	    found->layout == BAKE_LAYOUT_NORMAL_RELIEF)
		found->relief_channel = rgba[3];
	else
		found->relief_channel = named >= 0 ? named : 0;
	return rc;
}

/* The maps in one file, with the layout they have. */
static enum bake_status
open_maps(const struct cmd *cmd, const struct info_opts *o,
    const struct cmd_map *map, struct bake_maps *maps,
    struct bake_inspection *found, struct bake_err *err)
{
	enum bake_normal_code code = cmd_normal_code(cmd, map);
	enum bake_status rc;
	int rgba[4];

	find_rgba(&map->info, rgba);
	rc = find_layout(o, map, rgba, code, found, err);
	if (rc != BAKE_OK)
		return rc;
	return bake_maps_extract(maps, &map->img, rgba, found->layout, code,
	    found->relief_channel, err);
}

/* The normals of a pair, whatever else their file holds. */
static enum bake_status
open_normals(const struct cmd *cmd, struct info_report *r, struct bake_err *err)
{
	const struct cmd_map *map = &r->normal;
	bool packed =
	    map->info.nchans >= 4 && map->meta.layout == BAKE_LAYOUT_RELIEF;
	enum bake_status rc;
	int rgba[4];

	find_rgba(&map->info, rgba);
	rc = bake_maps_extract(&r->maps, &map->img, rgba,
	    packed ? BAKE_LAYOUT_RELIEF : BAKE_LAYOUT_NORMAL,
	    cmd_normal_code(cmd, map), 0, err);
	bake_image_free(&r->maps.relief);
	bake_image_free(&r->maps.ao);
	return rc;
}

/* The relief of a pair: the first channel of a file that seems to have none.
 * The layout of the one file is not that of the pair. */
static enum bake_status
open_relief(const struct cmd *cmd, const struct info_opts *o,
    struct info_report *r, struct bake_err *err)
{
	struct bake_maps maps = BAKE_MAPS_INIT;
	struct bake_inspection found = r->found;
	enum bake_status rc = open_maps(cmd, o, &r->map, &maps, &found, err);

	if (rc == BAKE_OK && maps.relief.data == NULL) {
		static const int rgba[4] = { 0, 0, 0, 0 }; /* not asked for */

		bake_maps_free(&maps);
		rc = bake_maps_extract(&maps, &r->map.img, rgba,
		    BAKE_LAYOUT_DEPTH, BAKE_NORMAL_CODE_UNSIGNED,
		    o->channel != NULL ? found.relief_channel : 0, err);
	}
	bake_image_swap(&r->maps.relief, &maps.relief);
	bake_maps_free(&maps);
	r->found.relief_channel = found.relief_channel;
	return rc;
}

static enum bake_status
open_report(const struct cmd *cmd, const struct info_opts *o,
    struct info_report *r, struct bake_err *err)
{
	enum bake_status rc;

	if (!r->pair)
		return open_maps(cmd, o, &r->map, &r->maps, &r->found, err);
	rc = open_normals(cmd, r, err);
	return rc == BAKE_OK ? open_relief(cmd, o, r, err) : rc;
}

/* Values that are no numbers; range, where not NULL, gets each channel's. */
static size_t
count_bad(const struct cmd_map *map, struct bake_channel_range *range)
{
	size_t n = 0;

	for (int c = 0; c < map->img.nchans; c++) {
		struct bake_channel_range r;

		bake_channel_range(&map->img, c, &r);
		n += r.nnan + r.ninf;
		if (range != NULL)
			range[c] = r;
	}
	return n;
}

/* --depth-range: the relief's values as depths; with auto, to 0 .. 1. */
static void
apply_depth_range(const struct cmd *cmd, struct info_report *r)
{
	struct bake_channel_range range;

	if (r->maps.relief.data == NULL)
		return;
	if (cmd->has_depth_range) {
		bake_maps_set_range(&r->maps, cmd->depth_near, cmd->depth_far);
		r->said.polarity = BAKE_POLARITY_DEPTH;
		return;
	}
	bake_channel_range(&r->maps.relief, 0, &range);
	if (cmd->normalize && range.min < range.max)
		bake_maps_set_range(&r->maps, range.min, range.max);
}

static enum bake_status
inspect(const struct cmd *cmd, const struct info_opts *o, struct info_report *r,
    struct bake_err *err)
{
	struct bake_inspection *f = &r->found;
	const struct bake_image *img = &r->map.img;
	enum bake_status rc;

	r->range = bake_alloc((size_t)img->nchans, sizeof *r->range, err);
	if (r->range == NULL)
		return BAKE_ENOMEM;
	f->nbad = count_bad(&r->map, r->range);
	if (r->pair)
		f->nbad += count_bad(&r->normal, NULL);
	f->seams = (struct bake_seams){ NAN, NAN, NAN, NAN };
	f->detection.depth_scale = NAN;
	rc = open_report(cmd, o, r, err);
	if (rc != BAKE_OK)
		return rc;
	apply_depth_range(cmd, r);
	rc = bake_inspect_maps(f, &r->maps, cmd_wrap(cmd, &r->map), err);
	if (rc == BAKE_OK && !f->has_normals && !f->has_relief)
		rc = bake_seams(img, 0, img->nchans, &f->seams, err);
	return rc;
}

bool
info_look(struct cmd *cmd, const struct info_opts *o, struct info_report *r)
{
	struct bake_err err = BAKE_ERR_INIT;
	int rgba[4];

	r->said = declared(cmd, o, r);
	if (!find_relief(cmd, o, &r->map, &r->found.relief_channel))
		return false;
	if (inspect(cmd, o, r, &err) != BAKE_OK) {
		cmd_error(cmd, "%s: %s", r->file, err.msg);
		return false;
	}
	bake_contradictions_find(&r->bad, &r->found, &r->said);
	find_rgba(&r->map.info, rgba);
	info_layers_look(r, rgba);
	return true;
}
