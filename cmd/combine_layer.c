/* rm-combine's layers: packed textures or plain maps, read into one form. */
/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "ao.h"
#include "cmd_maps.h"
#include "combine_tool.h"
#include "inspect.h"

enum { NX, NY, AO, DEPTH, NCHANS };

static const double default_scale = 0.1;

struct reading {
	struct cmd *cmd;
	const struct combine_opts *o;
	const struct combine_layer *l;
	struct combine_read *r;
	struct bake_relief_meta meta; /* of the depth, else of the normals */
	struct bake_relief_meta said; /* of plain maps, to be checked */
};

static bool
failed(struct cmd *cmd, const char *path, const struct bake_err *err)
{
	cmd_error(cmd, "%s: %s", path, err->msg);
	return false;
}

/* What a layer's own options say goes before what those of the whole say. */
struct said {
	enum bake_polarity polarity;
	bool has_polarity, has_normal_y;
	enum bake_normal_y normal_y;
	enum bake_normal_code normal_code;
};

static struct said
swap_said(struct cmd *cmd, const struct said *now)
{
	const struct said before = { cmd->polarity, cmd->has_polarity,
		cmd->has_normal_y, cmd->normal_y, cmd->normal_code };

	cmd->polarity = now->polarity;
	cmd->has_polarity = now->has_polarity;
	cmd->has_normal_y = now->has_normal_y;
	cmd->normal_y = now->normal_y;
	cmd->normal_code = now->normal_code;
	return before;
}

static struct said
say(struct cmd *cmd, const struct combine_layer *l)
{
	struct said now = { cmd->polarity, cmd->has_polarity, cmd->has_normal_y,
		cmd->normal_y, cmd->normal_code };

	if (l->polarity != BAKE_POLARITY_UNSURE) {
		now.polarity = l->polarity;
		now.has_polarity = true;
	}
	if (l->normal_y != BAKE_NORMAL_Y_UNSURE) {
		now.normal_y = l->normal_y;
		now.has_normal_y = true;
	}
	if (l->normal_code != BAKE_NORMAL_CODE_AUTO)
		now.normal_code = l->normal_code;
	return swap_said(cmd, &now);
}

/* -- what is read ------------------------------------------------------------
 */

/* What no normals, no depth and no occlusion are. */
static void
fill(struct bake_image *maps, int chan, float value)
{
	for (int y = 0; y < maps->height; y++) {
		float *row = bake_image_row(maps, y) + chan;

		for (int x = 0; x < maps->width; x++)
			row[(size_t)x * (size_t)maps->nchans] = value;
	}
}

static void
note_format(struct combine_read *r, const struct cmd_map *map)
{
	if (map->info.data_format > r->deepest)
		r->deepest = map->info.data_format;
}

static double
layer_scale(struct reading *g)
{
	if (g->l->depth_scale > 0)
		return g->l->depth_scale;
	if (g->meta.depth_scale > 0)
		return g->meta.depth_scale;
	if (!combine_is_removed(g->l))
		cmd_warn(g->cmd,
		    "%s: nothing says its depth scale; %g is taken, "
		    "--layer-depth-scale S before it says another",
		    combine_name(g->l), default_scale);
	return default_scale;
}

static bool
derives_from_depth(const struct combine_opts *o)
{
	return o->normal_blend == BAKE_NORMAL_FROM_DEPTH ||
	       o->ao_blend == BAKE_AO_BAKE;
}

/* The relief map as depth, its 8-bit steps smoothed if asked for. */
static bool
settle_depth(struct reading *g, struct cmd_map *map, enum bake_polarity stored)
{
	const struct combine_opts *o = g->o;

	if (stored == BAKE_POLARITY_HEIGHT)
		bake_relief_flip(&map->img, 0);
	return !(derives_from_depth(o) || o->dequantize) ||
	       cmd_smooth_steps(g->cmd, map, &map->img, g->r->depth_scale,
		   g->r->wrap, o->dequantize);
}

static bool
bake_missing_ao(struct reading *g, const struct bake_image *depth, double scale,
    struct bake_image *ao)
{
	struct bake_ao_params params = BAKE_AO_PARAMS_DEFAULT;
	struct bake_ao_result result = { ao, NULL, NULL };
	struct bake_err err = BAKE_ERR_INIT;
	struct cmd_progress bar;
	enum bake_status rc;

	cmd_note(
	    g->cmd, "%s: has no occlusion; it is baked", combine_name(g->l));
	params.quality = g->o->quality;
	params.wrap = g->r->wrap;
	params.nthreads = g->cmd->nthreads;
	params.progress = cmd_progress_start(g->cmd, &bar);
	rc = bake_ao(depth, &scale, 1, &params, &result, &err);
	cmd_progress_end(&bar);
	return rc == BAKE_OK || failed(g->cmd, combine_name(g->l), &err);
}

/* The AO into its channel: a map's first, else baked where it is used. */
static bool
put_ao(struct reading *g, const struct bake_image *depth,
    const struct bake_image *given)
{
	struct bake_image ao = BAKE_IMAGE_INIT;

	if (given != NULL) {
		bake_image_copy_channel(&g->r->maps, AO, given, 0);
		return true;
	}
	if (g->l->no_ao || g->o->ao_blend == BAKE_AO_BAKE || depth == NULL ||
	    combine_is_removed(g->l)) {
		fill(&g->r->maps, AO, 1);
		return true;
	}
	if (!bake_missing_ao(g, depth, g->r->depth_scale, &ao))
		return false;
	bake_image_copy_channel(&g->r->maps, AO, &ao, 0);
	bake_image_free(&ao);
	return true;
}

/* How far rounding takes a normal's length from 1. */
static double
length_tolerance(enum bake_data_format format)
{
	const int max = bake_data_format_max(format);

	return max > 0 ? sqrt(3) / max : format == BAKE_DATA_HALF ? 2e-3 : 1e-6;
}

/* x and y of stored normals, in channels 0 to 2, as those of unit normals: they
 * stay as they are where the length is 1 but for rounding. Vectors into the
 * surface become horizontal. Returns how many did. */
static size_t
unit_xy(struct bake_image *normal, double tolerance)
{
	size_t ninward = 0;

	for (int y = 0; y < normal->height; y++) {
		float *n = bake_image_row(normal, y);

		for (int x = 0; x < normal->width; x++, n += normal->nchans) {
			double u = 2.0 * n[0] - 1, v = 2.0 * n[1] - 1;
			double w = 2.0 * n[2] - 1, len;

			ninward += w < -tolerance;
			w = w < 0 ? 0 : w;
			len = sqrt(u * u + v * v + w * w);
			if (fabs(len - 1) <= tolerance)
				continue;
			n[0] = (float)(len > 0 ? (u / len + 1) / 2 : 0.5);
			n[1] = (float)(len > 0 ? (v / len + 1) / 2 : 0.5);
		}
	}
	return ninward;
}

/* -- plain maps --------------------------------------------------------------
 */

static bool
read_plain_depth(struct reading *g, struct cmd_map *depth)
{
	if (g->l->depth == NULL)
		return true;
	if (!cmd_read_channel(g->cmd, g->l->depth, NULL, depth))
		return false;
	g->meta = depth->meta;
	note_format(g->r, depth);
	g->r->wrap = cmd_wrap(g->cmd, depth);
	return true;
}

static bool
read_plain_normal(struct reading *g, struct cmd_map *normal)
{
	size_t ninward;

	if (g->l->normal == NULL)
		return true;
	if (!cmd_read_normal(g->cmd, g->l->normal, normal))
		return false;
	ninward =
	    unit_xy(&normal->img, length_tolerance(normal->info.data_format));
	if (ninward > 0)
		cmd_warn(g->cmd,
		    "%s: %zu normals point into the surface; they are taken "
		    "as horizontal",
		    normal->path, ninward);
	g->said.normal_y = cmd_normal_y(g->cmd, normal);
	note_format(g->r, normal);
	if (g->l->depth == NULL)
		g->r->wrap = cmd_wrap(g->cmd, normal);
	if (g->meta.depth_scale == 0)
		g->meta.depth_scale = normal->meta.depth_scale;
	return true;
}

/* Warn where the maps say other things of themselves than was said of them.
 * Large ones are not looked at for a warning's sake: that takes 40 bytes a
 * texel. */
static bool
check_agreement(struct reading *g, const struct cmd_map *normal,
    const struct cmd_map *depth)
{
	const long large = 1L << 24;

	if (g->o->no_check || normal->img.data == NULL ||
	    (long)normal->img.width * normal->img.height > large)
		return true;
	g->said.depth_scale = g->r->depth_scale;
	return cmd_warn_contradictions(g->cmd, normal,
	    depth->img.data != NULL ? depth : NULL, g->r->wrap, &g->said,
	    "--layer-polarity, --layer-normal-y and --layer-depth-scale");
}

/* Depth and normals into the four channels, each map gone as soon as it is
 * there; the depth stays where an occlusion is to be baked from it. */
static bool
put_maps(struct reading *g, struct cmd_map *normal, struct cmd_map *depth,
    bool keep_depth)
{
	struct bake_image *maps = &g->r->maps;
	struct bake_err err = BAKE_ERR_INIT;
	const struct bake_image *size =
	    depth->img.data != NULL ? &depth->img : &normal->img;

	if (bake_image_alloc(maps, size->width, size->height, NCHANS, &err) !=
	    BAKE_OK)
		return failed(g->cmd, combine_name(g->l), &err);
	for (int c = NX; c <= NY; c++)
		if (normal->img.data != NULL)
			bake_image_copy_channel(maps, c, &normal->img, c);
		else
			fill(maps, c, 0.5f);
	bake_image_free(&normal->img);
	if (depth->img.data != NULL)
		bake_image_copy_channel(maps, DEPTH, &depth->img, 0);
	else
		fill(maps, DEPTH, 0);
	if (!keep_depth)
		bake_image_free(&depth->img);
	return true;
}

/* All into the four channels, at the depth's size, else the normals'. */
static bool
assemble(struct reading *g, struct cmd_map *normal, struct cmd_map *depth,
    struct cmd_map *ao)
{
	const struct bake_image *size =
	    depth->img.data != NULL ? &depth->img : &normal->img;
	const int w = size->width, h = size->height;
	const bool has_ao = ao->img.data != NULL;
	struct combine_read *r = g->r;

	if ((normal->img.data != NULL &&
		!cmd_resize(g->cmd, normal, r->wrap, w, h)) ||
	    (has_ao && !cmd_resize(g->cmd, ao, r->wrap, w, h)))
		return false;
	r->depth_scale = layer_scale(g);
	r->ao_scale = bake_relief_meta_ao_scale(&ao->meta);
	if (depth->img.data != NULL)
		g->said.polarity = cmd_relief_range(g->cmd, depth);
	if (!check_agreement(g, normal, depth) ||
	    (depth->img.data != NULL &&
		!settle_depth(g, depth, g->said.polarity)))
		return false;
	if (g->said.normal_y == BAKE_NORMAL_Y_DOWN)
		bake_relief_flip(&normal->img, 1);
	return put_maps(g, normal, depth, !has_ao) &&
	       put_ao(g, depth->img.data != NULL ? &depth->img : NULL,
		   has_ao ? &ao->img : NULL);
}

static bool
read_plain(struct reading *g)
{
	struct cmd_map normal = CMD_MAP_INIT, depth = CMD_MAP_INIT;
	struct cmd_map ao = CMD_MAP_INIT;
	bool ok = read_plain_depth(g, &depth) && read_plain_normal(g, &normal);

	if (ok && g->l->ao != NULL) {
		ok = cmd_read_channel(g->cmd, g->l->ao, "0", &ao);
		if (ok)
			note_format(g->r, &ao);
	}
	ok = ok && assemble(g, &normal, &depth, &ao);
	cmd_map_free(&normal);
	cmd_map_free(&depth);
	cmd_map_free(&ao);
	return ok;
}

/* -- packed textures ---------------------------------------------------------
 */

/* Whether the file says that it is a packed texture, or nothing; and where its
 * channels are. */
static bool
find_packed(struct reading *g, const struct cmd_map *map, int rgba[4])
{
	const enum bake_layout layout = map->meta.layout;

	if (layout != BAKE_LAYOUT_UNKNOWN && layout != BAKE_LAYOUT_RELIEF &&
	    layout != BAKE_LAYOUT_NORMAL_RELIEF) {
		cmd_error(g->cmd,
		    "%s: its layout is %s, not a packed texture's: give maps "
		    "with --normal, --depth and --ao",
		    map->path, bake_layout_name(layout));
		return false;
	}
	if (!cmd_packed_channels(&map->info, rgba)) {
		cmd_error(g->cmd,
		    "%s: has %d channels, a packed texture has 4: give maps "
		    "with --normal, --depth and --ao",
		    map->path, map->info.nchans);
		return false;
	}
	return true;
}

/* RELIEF or NORMAL_RELIEF, by the metadata, else by the texels. */
static bool
packed_layout(
    struct reading *g, const struct cmd_map *map, enum bake_layout *layout)
{
	static const int rgba[4] = { 0, 1, 2, 3 };
	const struct bake_image part = cmd_look_at(&map->img);
	struct bake_err err = BAKE_ERR_INIT;

	*layout = map->meta.layout;
	if (*layout != BAKE_LAYOUT_UNKNOWN)
		return true;
	if (bake_layout_guess(&part, rgba, cmd_normal_code(g->cmd, map), layout,
		&err) != BAKE_OK)
		return failed(g->cmd, map->path, &err);
	if (*layout == BAKE_LAYOUT_NORMAL_RELIEF)
		cmd_warn(g->cmd,
		    "%s: read as normals in R, G, B and relief in A, by its "
		    "texels",
		    map->path);
	else
		*layout = BAKE_LAYOUT_RELIEF;
	return true;
}

/* The relief on its own, for what looks at one channel. */
static bool
take_relief(
    struct reading *g, struct cmd_map *map, int chan, struct cmd_map *relief)
{
	struct bake_err err = BAKE_ERR_INIT;

	*relief = *map;
	relief->img = (struct bake_image)BAKE_IMAGE_INIT;
	if (bake_image_alloc(&relief->img, map->img.width, map->img.height, 1,
		&err) != BAKE_OK)
		return failed(g->cmd, map->path, &err);
	bake_image_copy_channel(&relief->img, 0, &map->img, chan);
	return true;
}

/* Signed components to the unsigned code. */
static void
encode(struct bake_image *img, int chan)
{
	for (int y = 0; y < img->height; y++) {
		float *v = bake_image_row(img, y) + chan;

		for (int x = 0; x < img->width; x++, v += img->nchans)
			*v = (*v + 1) * 0.5f;
	}
}

/* x and y in the unsigned code. */
static void
unify_code(struct reading *g, struct cmd_map *map, enum bake_layout layout)
{
	if (cmd_normal_code(g->cmd, map) == BAKE_NORMAL_CODE_SIGNED)
		for (int c = 0; c < (layout == BAKE_LAYOUT_RELIEF ? 2 : 3); c++)
			encode(&map->img, c);
}

/* Whether the relief is depth in codes, and nothing is asked of it. */
static bool
depth_is_settled(
    const struct reading *g, const struct cmd_map *map, enum bake_layout layout)
{
	const struct cmd *cmd = g->cmd;
	const enum bake_polarity said =
	    cmd->has_polarity ? cmd->polarity : map->meta.polarity;

	return layout == BAKE_LAYOUT_RELIEF && said != BAKE_POLARITY_HEIGHT &&
	       !cmd->has_depth_range && !cmd->normalize && !g->o->dequantize &&
	       (map->info.data_format == BAKE_DATA_UINT16 ||
		   (map->info.data_format == BAKE_DATA_UINT8 &&
		       !derives_from_depth(g->o)));
}

/* Whether something has to look at the relief on its own. */
static bool
wants_relief(
    const struct reading *g, const struct cmd_map *map, enum bake_layout layout)
{
	return layout == BAKE_LAYOUT_NORMAL_RELIEF ||
	       ((derives_from_depth(g->o) || g->o->dequantize) &&
		   map->info.data_format == BAKE_DATA_UINT8);
}

/* What is left to do once the channels are in order. */
static bool
settle_packed(struct reading *g, struct cmd_map *map, enum bake_layout layout)
{
	struct combine_read *r = g->r;
	struct cmd_map relief = CMD_MAP_INIT;
	bool ok = true;

	r->depth_scale = layer_scale(g);
	r->ao_scale = map->meta.has_ao_scale ? map->meta.ao_scale : 0;
	if (depth_is_settled(g, map, layout)) {
		/* as it is */
	} else if (wants_relief(g, map, layout)) {
		ok =
		    take_relief(g, map, DEPTH, &relief) &&
		    settle_depth(g, &relief, cmd_relief_range(g->cmd, &relief));
		if (ok)
			bake_image_copy_channel(
			    &map->img, DEPTH, &relief.img, 0);
	} else if (cmd_relief_range_of(g->cmd, map, DEPTH) ==
		   BAKE_POLARITY_HEIGHT) {
		bake_relief_flip(&map->img, DEPTH);
	}
	bake_image_swap(&r->maps, &map->img);
	if (ok && layout == BAKE_LAYOUT_NORMAL_RELIEF) {
		/* z is where the AO goes */
		unit_xy(&r->maps, length_tolerance(map->info.data_format));
		ok = put_ao(g, &relief.img, NULL);
	}
	if (ok && cmd_normal_y(g->cmd, map) == BAKE_NORMAL_Y_DOWN)
		bake_relief_flip(&r->maps, NY);
	cmd_map_free(&relief);
	return ok;
}

static bool
read_packed(struct reading *g)
{
	struct cmd_map map = CMD_MAP_INIT;
	enum bake_layout layout = BAKE_LAYOUT_UNKNOWN;
	struct bake_reader *reader;
	int rgba[NCHANS];
	bool ok;

	if (!cmd_open(g->cmd, g->l->packed, &map, &reader))
		return false;
	if (!find_packed(g, &map, rgba)) {
		bake_reader_close(reader);
		return false;
	}
	if (!cmd_load(g->cmd, reader, rgba, NCHANS, &map))
		return false;
	g->meta = map.meta;
	g->r->wrap = cmd_wrap(g->cmd, &map);
	note_format(g->r, &map);
	ok = packed_layout(g, &map, &layout);
	if (ok) {
		unify_code(g, &map, layout);
		ok = settle_packed(g, &map, layout);
	}
	cmd_map_free(&map);
	return ok;
}

bool
combine_read_layer(struct cmd *cmd, const struct combine_opts *o,
    const struct combine_layer *l, struct combine_read *r)
{
	struct reading g = { cmd, o, l, r, BAKE_RELIEF_META_INIT,
		BAKE_RELIEF_META_INIT };
	const struct said said = say(cmd, l);
	bool ok = l->packed != NULL ? read_packed(&g) : read_plain(&g);

	swap_said(cmd, &said);
	if (!ok)
		bake_image_free(&r->maps);
	return ok;
}
