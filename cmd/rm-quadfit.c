/* rm-quadfit: per-vertex quadric coefficients for relief silhouettes. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cmd_batch.h"
#include "cmd_recipe.h"
#include "quadfit.h"

enum {
	KEY_DEPTH = CMD_KEY_TOOL,
	KEY_FORMAT,
	KEY_FRAME,
	KEY_MODEL,
	KEY_NORMALS,
	KEY_ORDER,
	KEY_RING,
	KEY_SIGN,
	KEY_STATS,
	KEY_UV_SET,
	KEY_WELD
};

static const struct cmd_option options[] = {
	{ KEY_DEPTH, "depth", "D",
	    "depth range in mesh units (default: --depth-scale)" },
	{ 's', "depth-scale", "S",
	    "depth range / texture width, at each vertex (default 0.1)" },
	{ 'M', "depfile", "FILE",
	    "write a Make rule: the outputs and all that was read" },
	{ KEY_FORMAT, "format", "TYPE",
	    "{tsv}, {json}, {ply}, {glb} or {gltf}; default: by the output's "
	    "name" },
	{ KEY_FRAME, "frame", "NAME",
	    "tangents: {uv} (default), {file}, or {auto}: any without UVs" },
	{ KEY_MODEL, "model", "NAME", "{full} (default) or {ab}, the papers'" },
	{ KEY_NORMALS, "normals", "NAME",
	    "{auto} (default: the file's, else computed), {file}, {computed}" },
	{ KEY_ORDER, "order", "N", "{2} (default), or {3}: with cubic terms" },
	{ 'o', "output", "FILE", "output; - is standard output" },
	{ 'O', "output-dir", "DIR",
	    "many inputs: write there, each under its own name" },
	{ KEY_RING, "ring", "N",
	    "edges to the farthest neighbours, 1 to 8 (default 2)" },
	{ KEY_SIGN, "sign", "NAME",
	    "{depth} (default): convex is positive; or {outward}" },
	{ KEY_STATS, "stats", NULL,
	    "print ranges, ranks, fallbacks and residuals" },
	{ KEY_UV_SET, "uv-set", "N", "which UVs, 0 (default) to 7" },
	{ KEY_WELD, "weld", "EPS",
	    "join positions that are so near (default 0: equal ones)" },
	{ 0, NULL, NULL, NULL },
};

static const struct cmd_mark marks[] = {
	{ "stats", CMD_ARG_REPORT | CMD_ARG_NEUTRAL, NULL },
	{ NULL, 0, NULL },
};

const char *const quadfit_types[QUADFIT_NTYPES] = { "tsv", "json", "ply", "glb",
	"gltf" };

/* -- options ----------------------------------------------------------------
 */

static bool
set_name(struct cmd *cmd, struct quadfit_opts *o, int key, const char *arg)
{
	static const char *const frames[] = { "uv", "file", "auto" };
	static const char *const models[] = { "full", "ab" };
	static const char *const normals[] = { "auto", "file", "computed" };
	static const char *const signs[] = { "depth", "outward" };
	int i;

	switch (key) {
	case KEY_FORMAT:
		o->has_type = cmd_choice(
		    cmd, "format", arg, quadfit_types, QUADFIT_NTYPES, &i);
		if (o->has_type)
			o->type = (enum quadfit_type)i;
		return o->has_type;
	case KEY_FRAME:
		if (!cmd_choice(cmd, "frame", arg, frames, 3, &i))
			return false;
		o->frames.tangents = (enum bake_tangent_source)i;
		o->frame = frames[i];
		return true;
	case KEY_MODEL:
		if (!cmd_choice(cmd, "model", arg, models, 2, &i))
			return false;
		o->fit.model = (enum bake_quadric_model)i;
		return true;
	case KEY_NORMALS:
		if (!cmd_choice(cmd, "normals", arg, normals, 3, &i))
			return false;
		o->frames.normals = (enum bake_normal_source)i;
		return true;
	default:
		if (!cmd_choice(cmd, "sign", arg, signs, 2, &i))
			return false;
		o->fit.sign = (enum bake_quadric_sign)i;
		return true;
	}
}

static bool
set_option(struct cmd *cmd, int key, const char *arg)
{
	struct quadfit_opts *o = cmd->tool->opts;

	switch (key) {
	case KEY_DEPTH:
		return cmd_number(
		    cmd, "depth", arg, 1e-30, 1e30, &o->fit.depth);
	case 's':
		return cmd_number(
		    cmd, "depth-scale", arg, 1e-9, 1e6, &o->fit.depth_scale);
	case KEY_ORDER:
		return cmd_int(cmd, "order", arg, 2, 3, &o->fit.order);
	case KEY_RING:
		return cmd_int(
		    cmd, "ring", arg, 1, BAKE_QUADRIC_RING_MAX, &o->fit.ring);
	case KEY_STATS:
		o->stats = o->fit.creases = true;
		return true;
	case KEY_UV_SET:
		return cmd_int(cmd, "uv-set", arg, 0, 7, &o->mesh.uv_set);
	case KEY_WELD:
		return cmd_number(cmd, "weld", arg, 0, 1e30, &o->weld);
	default:
		return set_name(cmd, o, key, arg);
	}
}

/* -- outputs -----------------------------------------------------------------
 */

static bool
type_of_name(const char *path, enum quadfit_type *type)
{
	const char *dot = strrchr(path, '.');

	for (int i = 0; dot != NULL && i < QUADFIT_NTYPES; i++)
		if (strcasecmp(dot + 1, quadfit_types[i]) == 0) {
			*type = (enum quadfit_type)i;
			return true;
		}
	return false;
}

/* The type of the outputs; --format and the name must agree. */
static bool
choose_type(
    const struct cmd *cmd, const struct quadfit_opts *o, enum quadfit_type *t)
{
	bool by_name = cmd->output != NULL && type_of_name(cmd->output, t);

	if (by_name && o->has_type && *t != o->type)
		return cmd_usage_error(cmd, "%s: its name says %s, --format %s",
		    cmd->output, quadfit_types[*t], quadfit_types[o->type]);
	if (o->has_type)
		*t = o->type;
	else if (cmd->output_dir != NULL)
		*t = QUADFIT_TSV;
	else if (cmd->output != NULL && !by_name)
		return cmd_usage_error(cmd,
		    "%s: its name does not say what to write: end it in .tsv, "
		    ".json, .ply, .glb or .gltf, or use --format",
		    strcmp(cmd->output, "-") == 0 ? "standard output"
						  : cmd->output);
	return true;
}

/* Where the output for an input goes; NULL: nowhere. To be freed. */
static char *
output_path(const struct cmd *cmd, const char *input, const void *arg)
{
	const enum quadfit_type type = *(const enum quadfit_type *)arg;
	char ext[8];

	if (cmd->output != NULL)
		return cmd_copy(cmd->output);
	if (cmd->output_dir == NULL)
		return NULL;
	snprintf(ext, sizeof ext, ".%s", quadfit_types[type]);
	return cmd_path_derive(input, cmd->output_dir, "", ext);
}

static bool
usage_is_right(
    const struct cmd *cmd, const struct quadfit_opts *o, enum quadfit_type *t)
{
	int n = cmd->operands.n;
	bool none = cmd->output == NULL && cmd->output_dir == NULL;

	if (cmd->output != NULL && cmd->output_dir != NULL)
		return cmd_usage_error(cmd, "-o and -O exclude each other");
	if ((!o->stats || !none || n == 0) && !cmd_inputs_fit(cmd, n))
		return false;
	if (o->stats && cmd->output != NULL && strcmp(cmd->output, "-") == 0)
		return cmd_usage_error(cmd,
		    "--stats and the output cannot both be on standard "
		    "output");
	return choose_type(cmd, o, t) &&
	       cmd_paths_differ(cmd, &cmd->operands, output_path, t);
}

struct job {
	const struct quadfit_opts *o;
	enum quadfit_type type;
};

static int
fit_operand(struct cmd *cmd, int i, void *arg)
{
	const struct job *job = arg;
	const char *in = cmd->operands.item[i];
	char *out = output_path(cmd, in, &job->type);
	bool ok;

	cmd_recipe_begin(cmd, i);
	cmd_recipe_output(cmd, out, quadfit_types[job->type]);
	ok =
	    cmd_unchanged(cmd) || quadfit_file(cmd, job->o, in, out, job->type);

	free(out);
	return ok ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

static int
run(struct cmd *cmd, const struct quadfit_opts *o)
{
	struct job job = { o, QUADFIT_TSV };

	if (!usage_is_right(cmd, o, &job.type))
		return CMD_EXIT_USAGE;
	return cmd_batch(cmd, &cmd->operands, fit_operand, &job);
}

int
main(int argc, char *argv[])
{
	struct quadfit_opts o = { .fit = BAKE_QUADRIC_PARAMS_DEFAULT,
		.frames = BAKE_FRAME_PARAMS_DEFAULT,
		.mesh = BAKE_MESH_PARAMS_DEFAULT,
		.frame = "uv" };
	struct cmd_tool tool = { "rm-quadfit", "MESH ... -o OUT",
		"Fit quadrics to a mesh at its vertices, for silhouettes.",
		options, CMD_OPTS_CHANGED, set_option, &o, main, 16, marks };
	struct cmd cmd;
	int status;

	if (cmd_parse(&cmd, &tool, argc, argv, &status))
		status = run(&cmd, &o);
	return cmd_finish(&cmd, status);
}
