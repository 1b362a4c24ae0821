/* rm-combine's command line: options belong to the layer that they precede. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "cmd_recipe.h"
#include "cmd_signal.h"
#include "cmd_target.h"
#include "combine_tool.h"

enum {
	/* a layer's maps */
	KEY_AO = CMD_KEY_TOOL,
	KEY_DEPTH,
	KEY_NORMAL,
	/* its options */
	KEY_COLOR,
	KEY_COLOR_WEIGHT,
	KEY_DEPTH_WEIGHT,
	KEY_LAYER_DEPTH_SCALE,
	KEY_LAYER_NORMAL_CODE,
	KEY_LAYER_NORMAL_Y,
	KEY_LAYER_POLARITY,
	KEY_NORMAL_WEIGHT,
	KEY_OFFSET,
	/* the whole's */
	KEY_AO_BLEND,
	KEY_AO_RESCALE,
	KEY_COLOR_LAYER,
	KEY_COLOR_OUT,
	KEY_COLOR_SIZE,
	KEY_COLOR_SPACE,
	KEY_DEQUANTIZE,
	KEY_EXR_NAMES,
	KEY_FILTER,
	KEY_LIST_TARGETS,
	KEY_NO_CHECK,
	KEY_NORMAL_BLEND,
	KEY_QUALITY,
	KEY_REPEAT,
	KEY_SIZE,
	KEY_SLOPE,
	KEY_TARGET
};

const struct cmd_option combine_options[] = {
	{ KEY_AO, "ao", "FILE",
	    "a layer of plain maps: its AO; {none} is open (default: baked)" },
	{ KEY_AO_BLEND, "ao-blend", "NAME",
	    "{multiply} (default), {min}, or {bake}: of the blended depth" },
	{ KEY_AO_RESCALE, "ao-rescale", NULL,
	    "fit the layers' AO to the depth scale the blend gives them" },
	{ KEY_COLOR, "color", "FILE", "the next layer's colour map" },
	{ KEY_COLOR_LAYER, "color-layer", "N|blend",
	    "the colour of layer N, from 1, or of all (default blend)" },
	{ KEY_COLOR_OUT, "color-out", "FILE", "write the colour map here" },
	{ KEY_COLOR_SIZE, "color-size", "WxH",
	    "its size (default: the result's)" },
	{ KEY_COLOR_SPACE, "color-space", "NAME",
	    "of colour files, read and written (default sRGB)" },
	{ KEY_COLOR_WEIGHT, "color-weight", "W",
	    "the next layer's weight in the colour (default: -w's)" },
	{ KEY_DEPTH, "depth", "FILE", "a layer of plain maps: its depth" },
	{ 's', "depth-scale", "S",
	    "of the result: depth range / texture width (default: the "
	    "base's)" },
	{ KEY_DEPTH_WEIGHT, "depth-weight", "W",
	    "the next layer's weight in the depth (default: -w's)" },
	{ KEY_DEQUANTIZE, "dequantize", NULL,
	    "smooth layers' 8-bit depth within half a code" },
	{ KEY_EXR_NAMES, "exr-names", NULL,
	    "EXR channels normal.x normal.y ao depth, not RGBA" },
	{ KEY_FILTER, "filter", "NAME",
	    "{catmull-rom} (default), {bspline}, {mitchell}, {triangle} or "
	    "{box}" },
	{ KEY_LAYER_DEPTH_SCALE, "layer-depth-scale", "S",
	    "what the next layer was made for (default: its file's, or 0.1)" },
	{ KEY_LAYER_NORMAL_CODE, "layer-normal-code", "CODE",
	    "the next layer's normals: {unsigned}, {signed} or {auto}" },
	{ KEY_LAYER_NORMAL_Y, "layer-normal-y", "up|down",
	    "where the next layer's normals' positive y points" },
	{ KEY_LAYER_POLARITY, "layer-polarity", "NAME",
	    "what the next layer's relief holds: {depth} or {height}" },
	{ KEY_LIST_TARGETS, "list-targets", NULL,
	    "print the targets and what each writes" },
	{ KEY_NO_CHECK, "no-check", NULL,
	    "do not look whether plain maps contradict the options" },
	{ KEY_NORMAL, "normal", "FILE", "a layer of plain maps: its normals" },
	{ KEY_NORMAL_BLEND, "normal-blend", "NAME",
	    "{seed} (default), {pd}, {rnm}, {udn}, {whiteout} or "
	    "{from-depth}" },
	{ KEY_NORMAL_WEIGHT, "normal-weight", "W",
	    "the next layer's weight in the normals (default: -w's)" },
	{ KEY_OFFSET, "offset", "U,V",
	    "move the next layer right and up, in its repeats" },
	{ KEY_QUALITY, "quality", "NAME",
	    "of AO that is baked: {exact} (default), {fast} or {preview}" },
	{ KEY_REPEAT, "repeat", "N",
	    "the result covers N repeats of the base (default 1)" },
	{ KEY_SIZE, "size", "WxH",
	    "the result's size (default: the first layer's, times --repeat)" },
	{ KEY_SLOPE, "slope", "NAME",
	    "{central} (default) or {scharr}, for from-depth" },
	{ KEY_TARGET, "target", "NAME",
	    "what a renderer reads (default relief); see --list-targets" },
	{ 't', "tile", "F[xF]",
	    "repeats of the next layer, along u and v (default 1)" },
	{ 'w', "weight", "W",
	    "the next layer's weight, 0 or more (default 1)" },
	{ 0, NULL, NULL, NULL },
};

const struct cmd_mark combine_marks[] = {
	{ "ao", CMD_ARG_INPUT, " none " },
	{ "color", CMD_ARG_INPUT, NULL },
	{ "color-out", CMD_ARG_NEUTRAL, NULL },
	{ "depth", CMD_ARG_INPUT, NULL },
	{ "list-targets", CMD_ARG_REPORT, NULL },
	{ "no-check", CMD_ARG_NEUTRAL, NULL },
	{ "normal", CMD_ARG_INPUT, NULL },
	{ NULL, 0, NULL },
};

/* -- layers --------------------------------------------------------------- */

void
combine_end_layer(struct combine_opts *o)
{
	struct combine_layer *more =
	    realloc(o->layer, ((size_t)o->n + 1) * sizeof *o->layer);

	if (more == NULL)
		cmd_die("no memory");
	o->layer = more;
	o->layer[o->n++] = o->next;
	o->next = (struct combine_layer)COMBINE_LAYER_INIT;
	o->has_maps = false;
	o->pending = NULL;
}

static bool
add_packed(struct combine_opts *o, const char *arg)
{
	if (o->has_maps)
		combine_end_layer(o);
	o->next.packed = arg;
	combine_end_layer(o);
	return true;
}

/* A second map of a kind begins another layer. */
static bool
add_map(struct combine_opts *o, int key, const char *arg)
{
	struct combine_layer *l = &o->next;
	bool again = key == KEY_AO      ? l->ao != NULL || l->no_ao
		     : key == KEY_DEPTH ? l->depth != NULL
					: l->normal != NULL;

	if (o->has_maps && again)
		combine_end_layer(o);
	if (key == KEY_DEPTH)
		l->depth = arg;
	else if (key == KEY_NORMAL)
		l->normal = arg;
	else if (strcmp(arg, "none") == 0)
		l->no_ao = true;
	else
		l->ao = arg;
	o->has_maps = true;
	return true;
}

/* -- arguments --------------------------------------------------------------
 */

static bool
set_weight(
    const struct cmd *cmd, const char *option, const char *arg, double *weight)
{
	double w;

	if (!cmd_number(cmd, option, arg, -1e30, 1e6, &w))
		return false;
	if (w < 0)
		return cmd_usage_error(cmd,
		    "--%s is '%s', but weights are not negative; 0 removes a "
		    "layer",
		    option, arg);
	*weight = w;
	return true;
}

static const double tile_min = 1e-3, tile_max = 1e4;

/* F, or FxF. */
static bool
set_tile(const struct cmd *cmd, const char *arg, struct bake_placement *p)
{
	const char *x = strchr(arg, 'x');
	char first[64];

	if (x == NULL) {
		if (!cmd_number(
			cmd, "tile", arg, tile_min, tile_max, &p->tile_u))
			return false;
		p->tile_v = p->tile_u;
		return true;
	}
	snprintf(first, sizeof first, "%.*s", (int)(x - arg), arg);
	return cmd_number(cmd, "tile", first, tile_min, tile_max, &p->tile_u) &&
	       cmd_number(cmd, "tile", x + 1, tile_min, tile_max, &p->tile_v);
}

static bool
set_offset(const struct cmd *cmd, const char *arg, struct bake_placement *p)
{
	double v[2];
	int n;

	if (!cmd_numbers(cmd, "offset", arg, -1e6, 1e6, v, 2, &n))
		return false;
	if (n != 2)
		return cmd_usage_error(
		    cmd, "--offset is '%s', expected U,V", arg);
	p->offset_u = v[0];
	p->offset_v = v[1];
	return true;
}

static bool
set_layer_maps(
    struct cmd *cmd, struct combine_layer *l, int key, const char *arg)
{
	static const char *const codes[] = { "auto", "unsigned", "signed" };
	static const char *const ys[] = { "up", "down" };
	static const char *const polarities[] = { "depth", "height" };
	int i;

	switch (key) {
	case KEY_LAYER_NORMAL_CODE:
		if (!cmd_choice(cmd, "layer-normal-code", arg, codes, 3, &i))
			return false;
		l->normal_code = (enum bake_normal_code)i;
		return true;
	case KEY_LAYER_NORMAL_Y:
		if (!cmd_choice(cmd, "layer-normal-y", arg, ys, 2, &i))
			return false;
		l->normal_y = i == 0 ? BAKE_NORMAL_Y_UP : BAKE_NORMAL_Y_DOWN;
		return true;
	default:
		if (!cmd_choice(cmd, "layer-polarity", arg, polarities, 2, &i))
			return false;
		l->polarity =
		    i == 0 ? BAKE_POLARITY_DEPTH : BAKE_POLARITY_HEIGHT;
		return true;
	}
}

/* An option of the next layer; true in *mine where it is one. */
static bool
set_layer_option(
    struct cmd *cmd, struct combine_opts *o, int key, const char *arg)
{
	struct combine_layer *l = &o->next;

	switch (key) {
	case KEY_COLOR:
		l->color = arg;
		return true;
	case KEY_COLOR_WEIGHT:
		return set_weight(cmd, "color-weight", arg, &l->color_weight);
	case KEY_DEPTH_WEIGHT:
		return set_weight(cmd, "depth-weight", arg, &l->depth_weight);
	case KEY_LAYER_DEPTH_SCALE:
		return cmd_number(
		    cmd, "layer-depth-scale", arg, 1e-9, 1e6, &l->depth_scale);
	case KEY_NORMAL_WEIGHT:
		return set_weight(cmd, "normal-weight", arg, &l->normal_weight);
	case KEY_OFFSET:
		return set_offset(cmd, arg, &l->place);
	case 't':
		return set_tile(cmd, arg, &l->place);
	case 'w':
		return set_weight(cmd, "weight", arg, &l->weight);
	default:
		return set_layer_maps(cmd, l, key, arg);
	}
}

static const char *
layer_option_name(int key)
{
	const struct cmd_option *o = combine_options;

	if (key != 't' && key != 'w' && (key < KEY_COLOR || key > KEY_OFFSET))
		return NULL;
	while (o->key != key)
		o++;
	return o->name;
}

static bool
set_choice(struct cmd *cmd, struct combine_opts *o, int key, const char *arg)
{
	static const char *const normals[] = { "seed", "pd", "rnm", "udn",
		"whiteout", "from-depth" };
	static const char *const aos[] = { "multiply", "min", "bake" };
	static const char *const qualities[] = { "exact", "fast", "preview" };
	static const char *const slopes[] = { "central", "scharr" };
	/* in the order of enum bake_filter */
	static const char *const filters[] = { "catmull-rom", "box", "triangle",
		"mitchell", "bspline" };
	int i;
	bool ok = true;

	if (key == KEY_NORMAL_BLEND) {
		ok = cmd_choice(cmd, "normal-blend", arg, normals, 6, &i);
		o->normal_blend = (enum bake_normal_blend)i;
	} else if (key == KEY_AO_BLEND) {
		ok = cmd_choice(cmd, "ao-blend", arg, aos, 3, &i);
		o->ao_blend = (enum bake_ao_blend)i;
	} else if (key == KEY_QUALITY) {
		ok = cmd_choice(cmd, "quality", arg, qualities, 3, &i);
		o->quality = (enum bake_ao_quality)i;
	} else if (key == KEY_SLOPE) {
		ok = cmd_choice(cmd, "slope", arg, slopes, 2, &i);
		o->slope = (enum bake_slope_op)i;
	} else {
		ok = cmd_choice(cmd, "filter", arg, filters, 5, &i);
		o->filter = (enum bake_filter)i;
	}
	return ok;
}

static bool
set_color(struct cmd *cmd, struct combine_opts *o, int key, const char *arg)
{
	switch (key) {
	case KEY_COLOR_LAYER:
		if (strcmp(arg, "blend") == 0) {
			o->color_layer = 0;
			return true;
		}
		return cmd_int(
		    cmd, "color-layer", arg, 1, 1 << 20, &o->color_layer);
	case KEY_COLOR_OUT:
		o->color_out = arg;
		return true;
	case KEY_COLOR_SIZE:
		return cmd_size(
		    cmd, "color-size", arg, &o->color_width, &o->color_height);
	default:
		o->color_space = arg;
		return true;
	}
}

static bool
set_whole(struct cmd *cmd, struct combine_opts *o, int key, const char *arg)
{
	switch (key) {
	case KEY_AO_RESCALE:
		o->ao_rescale = true;
		return true;
	case KEY_COLOR_LAYER:
	case KEY_COLOR_OUT:
	case KEY_COLOR_SIZE:
	case KEY_COLOR_SPACE:
		return set_color(cmd, o, key, arg);
	case KEY_DEQUANTIZE:
		o->dequantize = true;
		return true;
	case KEY_EXR_NAMES:
		o->exr_names = true;
		return true;
	case KEY_LIST_TARGETS:
		o->list_targets = true;
		return true;
	case KEY_NO_CHECK:
		o->no_check = true;
		return true;
	case KEY_REPEAT:
		return cmd_int(cmd, "repeat", arg, 1, 1024, &o->repeat);
	case KEY_SIZE:
		return cmd_size(cmd, "size", arg, &o->width, &o->height);
	case KEY_TARGET:
		return cmd_set_target(cmd, arg, &o->target);
	case 's':
		return cmd_number(
		    cmd, "depth-scale", arg, 1e-9, 1e6, &o->depth_scale);
	default:
		return set_choice(cmd, o, key, arg);
	}
}

bool
combine_set(struct cmd *cmd, int key, const char *arg)
{
	struct combine_opts *o = cmd->tool->opts;
	const char *name = layer_option_name(key);

	if (key == CMD_KEY_OPERAND)
		return add_packed(o, arg);
	if (key == KEY_AO || key == KEY_DEPTH || key == KEY_NORMAL)
		return add_map(o, key, arg);
	if (name == NULL)
		return set_whole(cmd, o, key, arg);
	if (o->has_maps)
		combine_end_layer(o);
	o->pending = name;
	return set_layer_option(cmd, o, key, arg);
}
