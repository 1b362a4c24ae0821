/* rm-multilayer: its options. */
/* SPDX-License-Identifier: MIT */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "cmd_recipe.h"
#include "multilayer_tool.h"

enum {
	KEY_ALL_COLORS = CMD_KEY_TOOL,
	KEY_AXIS,
	KEY_CAP_POLICY,
	KEY_DEEP,
	KEY_DILATE,
	KEY_FLAT,
	KEY_FROM_DEPTH,
	KEY_IMPOSTOR,
	KEY_LAYERS,
	KEY_MIP_LEVELS,
	KEY_MIP_THRESHOLD,
	KEY_MULTI_PART,
	KEY_NO_COLOR,
	KEY_NORMALS,
	KEY_PREVIEW,
	KEY_REGION,
	KEY_REORIENT,
	KEY_SIZE,
	KEY_SOLIDIFY,
	KEY_STATS,
	KEY_TARGET,
	KEY_TEXTURE,
	KEY_TILE,
	KEY_UV_SET,
	KEY_VIEWS,
	KEY_WELD
};

const struct cmd_option multilayer_options[] = {
	{ KEY_ALL_COLORS, "all-colors", NULL,
	    "a colour image for each layer, not for the first alone" },
	{ KEY_AXIS, "axis", "SIDE",
	    "that is seen: {+x}, {-x}, {+y}, {-y}, {+z} (default) or {-z}" },
	{ KEY_CAP_POLICY, "cap-policy", "NAME",
	    "what goes where layers are too many: {smallest} (default), the "
	    "thinnest slabs and gaps, or {nearest} is kept" },
	{ KEY_DEEP, "deep", NULL, "one deep EXR, with every layer there is" },
	{ 's', "depth-scale", "S",
	    "of --from-depth: depth range / texture width (default 0.1)" },
	{ KEY_DILATE, "dilate", "N",
	    "normals and colours into N texels with fewer layers (0; with "
	    "--impostor 8)" },
	{ KEY_FLAT, "flat", NULL, "the triangles' own normals" },
	{ KEY_FROM_DEPTH, "from-depth", "FILE",
	    "a height field in the same layout, instead of a mesh" },
	{ KEY_IMPOSTOR, "impostor", NULL,
	    "fit to the object, its middle at depth 0.5, colour with alpha" },
	{ KEY_LAYERS, "layers", "N",
	    "the most layers of a texel, an even number, or {all} "
	    "(default 4)" },
	{ KEY_MIP_LEVELS, "mip-levels", "[=N]",
	    "N smaller levels, or all, by occupancy" },
	{ KEY_MIP_THRESHOLD, "mip-threshold", "NAME",
	    "solid where: {volume} (default), as much as in the first level; "
	    "{half} of the texels are" },
	{ KEY_MULTI_PART, "multi-part", NULL,
	    "one EXR with a part for each image, as -o NAME.exr does" },
	{ KEY_NO_COLOR, "no-color", NULL, "no colour image" },
	{ KEY_NORMALS, "normals", "NAME",
	    "{auto} (default: the file's, else computed), {file}, {computed}" },
	{ KEY_PREVIEW, "preview", "FILE",
	    "a picture of each layer, side by side" },
	{ KEY_REGION, "region", "X0,Y0,X1,Y1",
	    "the rectangle to sample, as seen (default: that of the mesh)" },
	{ KEY_REORIENT, "reorient", NULL, "turn round what is inside out" },
	{ KEY_SIZE, "size", "WxH", "of the textures (default 256x256)" },
	{ KEY_SOLIDIFY, "solidify", "T",
	    "for open meshes: every surface is a slab of thickness T" },
	{ KEY_STATS, "stats", NULL,
	    "print how many layers there are, and what was lost" },
	{ KEY_TARGET, "target", "NAME",
	    "{relief} (default), or {policarpo}: normal y down" },
	{ KEY_TEXTURE, "texture", "FILE",
	    "the base colour, instead of what the mesh's materials name" },
	{ KEY_TILE, "tile", "x|y|xy|none",
	    "what leaves one side enters at the other (none)" },
	{ KEY_UV_SET, "uv-set", "N", "which UVs, 0 (default) to 7" },
	{ KEY_VIEWS, "views", "N",
	    "3: also from +x and +y, as PREFIX_x, PREFIX_y, PREFIX_z" },
	{ KEY_WELD, "weld", "EPS",
	    "join positions that are so near (default 0: equal ones)" },
	{ 0, NULL, NULL, NULL },
};

const struct cmd_mark multilayer_marks[] = {
	{ "from-depth", CMD_ARG_INPUT, NULL },
	{ "preview", CMD_ARG_NEUTRAL, NULL },
	{ "stats", CMD_ARG_REPORT | CMD_ARG_NEUTRAL, NULL },
	{ "texture", CMD_ARG_INPUT, NULL },
	{ NULL, 0, NULL },
};

static bool
set_axis(struct cmd *cmd, struct multilayer_opts *o, const char *arg)
{
	for (int i = BAKE_AXIS_POS_X; i <= BAKE_AXIS_NEG_Z; i++) {
		const char *name = bake_axis_name((enum bake_axis)i);

		/* x is +x */
		if (strcmp(arg, name) == 0 ||
		    (name[0] == '+' && strcmp(arg, name + 1) == 0)) {
			o->axis = (enum bake_axis)i;
			return true;
		}
	}
	return cmd_usage_error(
	    cmd, "--axis is '%s', expected +x, -x, +y, -y, +z or -z", arg);
}

static bool
set_region(struct cmd *cmd, struct multilayer_opts *o, const char *arg)
{
	int n;

	if (!cmd_numbers(cmd, "region", arg, -1e30, 1e30, o->region, 4, &n))
		return false;
	o->has_region = n == 4 && o->region[0] < o->region[2] &&
			o->region[1] < o->region[3];
	return o->has_region ||
	       cmd_usage_error(cmd,
		   "--region is '%s', expected X0,Y0,X1,Y1 with X0 < X1 and "
		   "Y0 < Y1",
		   arg);
}

static bool
set_layers(struct cmd *cmd, struct multilayer_opts *o, const char *arg)
{
	if (strcmp(arg, "all") == 0) {
		o->nlayers = 0;
		return true;
	}
	if (!cmd_int(cmd, "layers", arg, 2, BAKE_LAYERS_MAX, &o->nlayers))
		return false;
	return o->nlayers % 2 == 0 ||
	       cmd_usage_error(cmd,
		   "--layers is %d: layers come in pairs, give an even number",
		   o->nlayers);
}

static bool
set_mips(struct cmd *cmd, struct multilayer_opts *o, const char *arg)
{
	o->mips_open = arg == NULL;
	o->mips = MULTILAYER_ALL;
	return arg == NULL || strcmp(arg, "all") == 0 ||
	       cmd_int(cmd, "mip-levels", arg, 0, 31, &o->mips);
}

/* A number behind a bare --mip-levels is its argument. */
static bool
take_operand(struct cmd *cmd, struct multilayer_opts *o, const char *arg)
{
	struct cmd_list *operands = &cmd->operands;
	bool number = o->mips_open && *arg != '\0' &&
		      strspn(arg, "0123456789") == strlen(arg);

	o->mips_open = false;
	if (!number)
		return true;
	if (!set_mips(cmd, o, arg))
		return false;
	free(operands->item[--operands->n]);
	return true;
}

static bool
set_name(struct cmd *cmd, struct multilayer_opts *o, int key, const char *arg)
{
	static const char *const policies[] = { "smallest", "nearest" };
	static const char *const thresholds[] = { "volume", "half" };
	static const char *const normals[] = { "auto", "file", "computed" };
	static const char *const targets[] = { "relief", "policarpo" };
	static const char *const tiles[] = { "none", "x", "y", "xy" };
	int i;

	switch (key) {
	case KEY_CAP_POLICY:
		if (!cmd_choice(cmd, "cap-policy", arg, policies, 2, &i))
			return false;
		o->policy = (enum bake_cap_policy)i;
		return true;
	case KEY_MIP_THRESHOLD:
		if (!cmd_choice(cmd, "mip-threshold", arg, thresholds, 2, &i))
			return false;
		o->mip_half = i == 1;
		return true;
	case KEY_NORMALS:
		if (!cmd_choice(cmd, "normals", arg, normals, 3, &i))
			return false;
		o->normals = (enum bake_normal_source)i;
		return true;
	case KEY_TARGET:
		if (!cmd_choice(cmd, "target", arg, targets, 2, &i))
			return false;
		o->policarpo = i == 1;
		return true;
	default:
		if (!cmd_choice(cmd, "tile", arg, tiles, 4, &i))
			return false;
		o->tile_x = (i & 1) != 0;
		o->tile_y = (i & 2) != 0;
		return true;
	}
}

static bool
set_flag(struct multilayer_opts *o, int key)
{
	bool *const flag = key == KEY_ALL_COLORS   ? &o->all_colors
			   : key == KEY_DEEP       ? &o->deep
			   : key == KEY_FLAT       ? &o->flat
			   : key == KEY_IMPOSTOR   ? &o->impostor
			   : key == KEY_MULTI_PART ? &o->multi_part
			   : key == KEY_NO_COLOR   ? &o->no_color
			   : key == KEY_REORIENT   ? &o->reorient
						   : &o->stats;

	*flag = true;
	return true;
}

static bool
set_value(struct cmd *cmd, struct multilayer_opts *o, int key, const char *arg)
{
	switch (key) {
	case KEY_AXIS:
		return set_axis(cmd, o, arg);
	case 's':
		return cmd_number(
		    cmd, "depth-scale", arg, 1e-9, 1e6, &o->depth_scale);
	case KEY_DILATE:
		return cmd_int(cmd, "dilate", arg, 0, 4096, &o->dilate);
	case KEY_FROM_DEPTH:
		o->from_depth = arg;
		return true;
	case KEY_LAYERS:
		return set_layers(cmd, o, arg);
	case KEY_MIP_LEVELS:
		return set_mips(cmd, o, arg);
	case KEY_PREVIEW:
		o->preview = arg;
		return true;
	case KEY_REGION:
		return set_region(cmd, o, arg);
	case KEY_SIZE:
		return cmd_size(cmd, "size", arg, &o->width, &o->height);
	case KEY_SOLIDIFY:
		return cmd_number(
		    cmd, "solidify", arg, 1e-30, 1e30, &o->solidify);
	case KEY_TEXTURE:
		o->texture = arg;
		return true;
	case KEY_UV_SET:
		return cmd_int(cmd, "uv-set", arg, 0, 7, &o->mesh.uv_set);
	case KEY_VIEWS:
		return cmd_int(cmd, "views", arg, 1, 3, &o->nviews) &&
		       (o->nviews != 2 || cmd_usage_error(cmd,
					      "--views is 2, expected 1 or 3"));
	default:
		return cmd_number(cmd, "weld", arg, 0, 1e30, &o->weld);
	}
}

bool
multilayer_set_option(struct cmd *cmd, int key, const char *arg)
{
	struct multilayer_opts *o = cmd->tool->opts;

	if (key == CMD_KEY_OPERAND)
		return take_operand(cmd, o, arg);
	o->mips_open = false;
	switch (key) {
	case KEY_ALL_COLORS:
	case KEY_DEEP:
	case KEY_FLAT:
	case KEY_IMPOSTOR:
	case KEY_MULTI_PART:
	case KEY_NO_COLOR:
	case KEY_REORIENT:
	case KEY_STATS:
		return set_flag(o, key);
	case KEY_CAP_POLICY:
	case KEY_MIP_THRESHOLD:
	case KEY_NORMALS:
	case KEY_TARGET:
	case KEY_TILE:
		return set_name(cmd, o, key, arg);
	default:
		return set_value(cmd, o, key, arg);
	}
}

/* -- what goes together ------------------------------------------------------
 */

static bool
excludes(const struct cmd *cmd, bool a, const char *name_a, bool b,
    const char *name_b)
{
	return !(a && b) || cmd_usage_error(cmd, "%s and %s exclude each other",
				name_a, name_b);
}

/* Whether the name ends in an image type's extension; which. */
static bool
output_type(const struct cmd *cmd, enum bake_file_type *type)
{
	return cmd->output != NULL &&
	       bake_file_type_from_path(cmd->output, type);
}

/* One file or several, and of which type: known before any work is done. */
static bool
output_fits(struct cmd *cmd, struct multilayer_opts *o)
{
	enum bake_file_type type = BAKE_FILE_PNG;
	bool named = output_type(cmd, &type);
	bool standard = cmd->output != NULL && strcmp(cmd->output, "-") == 0;

	if (named && type != BAKE_FILE_EXR)
		return cmd_usage_error(cmd,
		    "%s: -o is what the names of several files begin with: "
		    "give -o %.*s --format %s",
		    cmd->output, (int)(strrchr(cmd->output, '.') - cmd->output),
		    cmd->output, bake_file_type_name(type));
	o->multi_part |= named || (standard && !o->deep);
	if (o->multi_part || o->deep) {
		if (cmd->has_type && cmd->type != BAKE_FILE_EXR)
			return cmd_usage_error(cmd,
			    "one file for all images is EXR, not %s",
			    bake_file_type_name(cmd->type));
		cmd->type = BAKE_FILE_EXR;
	} else if (!cmd->has_type)
		cmd->type = BAKE_FILE_PNG;
	if (standard && (o->mips != 0 || o->nviews > 1))
		return cmd_usage_error(cmd,
		    "standard output holds one set: no --mip-levels "
		    "and no --views there");
	return !cmd->has_data_format ||
	       bake_file_type_holds(cmd->type, cmd->data_format) ||
	       cmd_usage_error(cmd,
		   "%s files hold no %s values: choose another -d or --format",
		   bake_file_type_name(cmd->type),
		   bake_data_format_name(cmd->data_format));
}

bool
multilayer_usage(struct cmd *cmd, const struct multilayer_opts *o)
{
	const bool field = o->from_depth != NULL;

	if (field && cmd->operands.n > 0)
		return cmd_usage_error(cmd,
		    "%s: --from-depth makes the textures of a height field, "
		    "without a mesh",
		    cmd->operands.item[0]);
	if (!field && o->stats && cmd->output == NULL &&
	    cmd->output_dir == NULL && cmd->operands.n > 0)
		return true; /* the table alone */
	if (!cmd_inputs_fit(cmd, field ? 1 : cmd->operands.n))
		return false;
	if (cmd->output == NULL && cmd->output_dir == NULL)
		return cmd_usage_error(
		    cmd, "no output: give -o PREFIX, -o NAME.exr or -O DIR");
	return excludes(cmd, o->deep, "--deep", o->mips != 0, "--mip-levels") &&
	       excludes(
		   cmd, o->deep, "--deep", o->multi_part, "--multi-part") &&
	       excludes(cmd, o->deep, "--deep", o->dilate > 0, "--dilate") &&
	       excludes(
		   cmd, o->deep, "--deep", o->preview != NULL, "--preview") &&
	       excludes(cmd, field, "--from-depth", o->deep, "--deep") &&
	       excludes(cmd, o->no_color, "--no-color", o->all_colors,
		   "--all-colors") &&
	       excludes(
		   cmd, o->impostor, "--impostor", o->has_region, "--region") &&
	       excludes(cmd, o->preview != NULL, "--preview",
		   cmd->operands.n > 1, "many meshes") &&
	       output_fits(cmd, cmd->tool->opts);
}
