/* rm-pack: normal, AO and depth into one relief texture, and back. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "cmd_batch.h"
#include "cmd_recipe.h"
#include "cmd_target.h"
#include "pack.h"

enum {
	KEY_AO = CMD_KEY_TOOL,
	KEY_AO_CHANNEL,
	KEY_AO_OUT,
	KEY_DAMPING,
	KEY_DEPTH,
	KEY_DEPTH_CHANNEL,
	KEY_DEPTH_OUT,
	KEY_DEQUANTIZE,
	KEY_EXR_NAMES,
	KEY_LIST_TARGETS,
	KEY_NO_CHECK,
	KEY_NORMAL,
	KEY_NORMAL_OUT,
	KEY_OUTPUT_HEIGHT,
	KEY_QUALITY,
	KEY_RENORMALIZE,
	KEY_SIZE,
	KEY_SLOPE,
	KEY_TARGET,
	KEY_UNPACK
};

static const struct cmd_option options[] = {
	{ KEY_AO, "ao", "FILE", "AO map; {none} writes 1; default: baked" },
	{ KEY_AO_CHANNEL, "ao-channel", "NAME",
	    "the AO's channel (default: the first)" },
	{ KEY_AO_OUT, "ao-out", "FILE", "with --unpack: write the AO" },
	{ KEY_DAMPING, "damping", "L",
	    "of an integrated depth, 0 to 1 (default: by the normals)" },
	{ KEY_DEPTH, "depth", "FILE",
	    "depth map; default: integrated from the normals" },
	{ KEY_DEPTH_CHANNEL, "depth-channel", "NAME",
	    "the relief's channel: {R}, {G}, {B}, {A}, its name or number" },
	{ KEY_DEPTH_OUT, "depth-out", "FILE",
	    "with --unpack: write the depth" },
	{ 's', "depth-scale", "S",
	    "depth range / texture width (default 0.1 or the file's)" },
	{ KEY_DEQUANTIZE, "dequantize", NULL,
	    "smooth 8-bit depth within half a code for what is derived" },
	{ KEY_EXR_NAMES, "exr-names", NULL,
	    "EXR channels normal.x normal.y ao depth, not RGBA" },
	{ KEY_LIST_TARGETS, "list-targets", NULL,
	    "print the targets and what each writes" },
	{ KEY_NO_CHECK, "no-check", NULL,
	    "do not look whether the maps contradict the options" },
	{ KEY_NORMAL, "normal", "FILE",
	    "normal map; default: derived from the depth" },
	{ KEY_NORMAL_OUT, "normal-out", "FILE",
	    "with --unpack: write the normals" },
	{ KEY_OUTPUT_HEIGHT, "output-height", NULL,
	    "with --unpack: write height, white is high, not depth" },
	{ KEY_QUALITY, "quality", "NAME",
	    "of a baked AO: {exact} (default), {fast} or {preview}" },
	{ KEY_RENORMALIZE, "renormalize", NULL,
	    "bring normals to unit length (codes change)" },
	{ KEY_SIZE, "size", "WxH", "output size (default: the depth's)" },
	{ KEY_SLOPE, "slope", "NAME",
	    "{central} (default) or {scharr}: how depth and normals relate" },
	{ KEY_TARGET, "target", "NAME",
	    "what a renderer reads (default relief); see --list-targets" },
	{ KEY_UNPACK, "unpack", "FILE", "take a packed texture apart" },
	{ 0, NULL, NULL, NULL },
};

static const struct cmd_mark marks[] = {
	{ "ao", CMD_ARG_EACH, " none " },
	{ "ao-out", CMD_ARG_NEUTRAL, NULL },
	{ "depth", CMD_ARG_EACH, NULL },
	{ "depth-out", CMD_ARG_NEUTRAL, NULL },
	{ "list-targets", CMD_ARG_REPORT, NULL },
	{ "no-check", CMD_ARG_NEUTRAL, NULL },
	{ "normal", CMD_ARG_EACH, NULL },
	{ "normal-out", CMD_ARG_NEUTRAL, NULL },
	{ "unpack", CMD_ARG_EACH, NULL },
	{ NULL, 0, NULL },
};

struct opts {
	struct pack_opts pack;
	struct cmd_list normals, depths, aos, unpacks;
	struct unpack_outputs out;
	bool list_targets;
};

static bool
set_ao(struct opts *o, const char *arg)
{
	o->pack.no_ao = strcmp(arg, "none") == 0;
	if (!o->pack.no_ao)
		cmd_list_add(&o->aos, arg);
	return true;
}

static bool
set_how(struct cmd *cmd, struct opts *o, int key, const char *arg)
{
	static const char *const qualities[] = { "exact", "fast", "preview" };
	static const char *const slopes[] = { "central", "scharr" };
	int i;

	switch (key) {
	case 's':
		return cmd_number(
		    cmd, "depth-scale", arg, 1e-9, 1e6, &o->pack.depth_scale);
	case KEY_DAMPING:
		return cmd_number(cmd, "damping", arg, 0, 1, &o->pack.damping);
	case KEY_QUALITY:
		if (!cmd_choice(cmd, "quality", arg, qualities, 3, &i))
			return false;
		o->pack.ao.quality = (enum bake_ao_quality)i;
		return true;
	case KEY_SIZE:
		return cmd_size(
		    cmd, "size", arg, &o->pack.width, &o->pack.height);
	case KEY_SLOPE:
		if (!cmd_choice(cmd, "slope", arg, slopes, 2, &i))
			return false;
		o->pack.slope = (enum bake_slope_op)i;
		return true;
	default:
		return cmd_set_target(cmd, arg, &o->pack.target);
	}
}

static bool
set_option(struct cmd *cmd, int key, const char *arg)
{
	struct opts *o = cmd->tool->opts;

	switch (key) {
	case KEY_AO:
		return set_ao(o, arg);
	case KEY_AO_CHANNEL:
		o->pack.ao_channel = arg;
		return true;
	case KEY_AO_OUT:
		o->out.ao = arg;
		return true;
	case KEY_DEPTH:
		cmd_list_add(&o->depths, arg);
		return true;
	case KEY_DEPTH_CHANNEL:
		o->pack.depth_channel = arg;
		return true;
	case KEY_DEPTH_OUT:
		o->out.depth = arg;
		return true;
	case KEY_DEQUANTIZE:
		o->pack.dequantize = true;
		return true;
	case KEY_EXR_NAMES:
		o->pack.exr_names = true;
		return true;
	case KEY_LIST_TARGETS:
		o->list_targets = true;
		return true;
	case KEY_NO_CHECK:
		o->pack.no_check = true;
		return true;
	case KEY_NORMAL:
		cmd_list_add(&o->normals, arg);
		return true;
	case KEY_NORMAL_OUT:
		o->out.normal = arg;
		return true;
	case KEY_OUTPUT_HEIGHT:
		o->out.height = true;
		return true;
	case KEY_RENORMALIZE:
		o->pack.renormalize = true;
		return true;
	case KEY_UNPACK:
		cmd_list_add(&o->unpacks, arg);
		return true;
	default:
		return set_how(cmd, o, key, arg);
	}
}

/* -- packing ------------------------------------------------------------ */

static bool
sets_are_clear(const struct cmd *cmd, const struct opts *o, int n)
{
	if (cmd->operands.n > 0)
		return cmd_usage_error(cmd,
		    "%s: maps are given with --normal, --depth and --ao",
		    cmd->operands.item[0]);
	if (n == 0)
		return cmd_usage_error(
		    cmd, "no input: give --normal, --depth or both");
	if ((o->normals.n != 0 && o->normals.n != n) ||
	    (o->depths.n != 0 && o->depths.n != n) ||
	    (o->aos.n != 0 && o->aos.n != n))
		return cmd_usage_error(cmd,
		    "%d normals, %d depths and %d AOs do not pair",
		    o->normals.n, o->depths.n, o->aos.n);
	if (!cmd_target_fits(cmd, o->pack.target))
		return false;
	if (o->out.normal != NULL || o->out.ao != NULL || o->out.depth != NULL)
		return cmd_usage_error(cmd,
		    "--normal-out, --ao-out and --depth-out go with --unpack");
	return cmd_inputs_fit(cmd, n);
}

/* The maps that the sets are named after. */
static const struct cmd_list *
named_maps(const struct opts *o)
{
	return o->depths.n > 0 ? &o->depths : &o->normals;
}

static int
pack_ith(struct cmd *cmd, int i, void *opts)
{
	const struct opts *o = opts;
	struct pack_inputs in = {
		o->normals.n > 0 ? o->normals.item[i] : NULL,
		o->depths.n > 0 ? o->depths.item[i] : NULL,
		o->aos.n > 0 ? o->aos.item[i] : NULL,
	};
	char *out = cmd_output_path(cmd, named_maps(o)->item[i], "");
	bool ok;

	cmd_recipe_begin(cmd, i);
	cmd_target_plan(cmd, o->pack.target, out);
	ok = cmd_unchanged(cmd) || pack_set(cmd, &o->pack, &in, out);
	free(out);
	return ok ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

static int
pack_all(struct cmd *cmd, struct opts *o)
{
	const struct cmd_list *named = named_maps(o);

	if (!sets_are_clear(cmd, o, named->n) ||
	    !cmd_outputs_differ(cmd, named))
		return CMD_EXIT_USAGE;
	return cmd_batch(cmd, named, pack_ith, o);
}

/* -- unpacking ------------------------------------------------------------ */

static bool
unpack_is_clear(const struct cmd *cmd, const struct opts *o)
{
	bool named =
	    o->out.normal != NULL || o->out.ao != NULL || o->out.depth != NULL;

	if (cmd->operands.n > 0)
		return cmd_usage_error(cmd,
		    "%s: inputs are given with --unpack",
		    cmd->operands.item[0]);
	if (o->normals.n + o->depths.n + o->aos.n > 0)
		return cmd_usage_error(
		    cmd, "--unpack does not go with --normal, --depth or --ao");
	if (cmd->output != NULL)
		return cmd_usage_error(cmd,
		    "--unpack writes --normal-out, --ao-out and --depth-out, "
		    "not -o");
	if (named == (cmd->output_dir != NULL))
		return cmd_usage_error(cmd,
		    "--unpack needs --normal-out, --ao-out or --depth-out, or "
		    "-O DIR for all three");
	if (named && o->unpacks.n > 1)
		return cmd_usage_error(
		    cmd, "%d inputs to unpack: give -O DIR", o->unpacks.n);
	return true;
}

static int
unpack_ith(struct cmd *cmd, int i, void *opts)
{
	const struct opts *o = opts;
	const char *in = o->unpacks.item[i];
	char *made[3] = { NULL, NULL, NULL };
	struct unpack_outputs out = o->out;
	bool ok;

	if (cmd->output_dir != NULL) {
		out.normal = made[0] = cmd_output_path(cmd, in, "_normal");
		out.ao = made[1] = cmd_output_path(cmd, in, "_ao");
		out.depth = made[2] = cmd_output_path(cmd, in, "_depth");
	}
	cmd_recipe_begin(cmd, i);
	cmd_recipe_output(cmd, out.normal, "normal");
	cmd_recipe_output(cmd, out.ao, "ao");
	cmd_recipe_output(cmd, out.depth, "depth");
	ok = cmd_unchanged(cmd) || unpack_file(cmd, in, &out);
	for (int k = 0; k < 3; k++)
		free(made[k]);
	return ok ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

static int
unpack_all(struct cmd *cmd, struct opts *o)
{
	if (!unpack_is_clear(cmd, o) || !cmd_outputs_differ(cmd, &o->unpacks))
		return CMD_EXIT_USAGE;
	return cmd_batch(cmd, &o->unpacks, unpack_ith, o);
}

int
main(int argc, char *argv[])
{
	struct opts o = { .pack = {
			      .ao = BAKE_AO_PARAMS_DEFAULT, .damping = -1 } };
	struct cmd_tool tool = { "rm-pack",
		"[--normal N] [--depth D] [--ao A] -o OUT\n"
		"       rm-pack [options] --unpack IN [--normal-out N] "
		"[--ao-out A] [--depth-out D]",
		"Pack normal, AO and depth into one relief texture, or unpack "
		"it.",
		options,
		CMD_OPTS_OUTPUT | CMD_OPTS_RELIEF | CMD_OPTS_NORMAL |
		    CMD_OPTS_OUTPUT_NORMAL | CMD_OPTS_TILES,
		set_option, &o, main, 48, marks };
	struct cmd cmd;
	int status;

	o.pack.target = bake_target_find("relief");
	if (cmd_parse(&cmd, &tool, argc, argv, &status))
		status = o.list_targets    ? cmd_print_targets()
			 : o.unpacks.n > 0 ? unpack_all(&cmd, &o)
					   : pack_all(&cmd, &o);
	cmd_list_free(&o.normals);
	cmd_list_free(&o.depths);
	cmd_list_free(&o.aos);
	cmd_list_free(&o.unpacks);
	return cmd_finish(&cmd, status);
}
