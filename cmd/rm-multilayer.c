/* rm-multilayer: a closed mesh as a few textures of depth and normals. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "cmd_batch.h"
#include "cmd_recipe.h"
#include "multilayer_tool.h"

/* What the names of an input's outputs begin with; NULL: nothing is written.
 * To be freed. */
static char *
prefix_of(const struct cmd *cmd, const char *input, const void *arg)
{
	(void)arg;
	if (cmd->output != NULL)
		return cmd_copy(cmd->output);
	if (cmd->output_dir == NULL)
		return NULL;
	return cmd_path_derive(input, cmd->output_dir, "", "");
}

struct job {
	const struct multilayer_opts *o;
	struct bake_color *color;
};

static int
bake_mesh(struct cmd *cmd, int i, void *arg)
{
	const struct job *job = arg;
	const char *in = cmd->operands.item[i];
	char *prefix = prefix_of(cmd, in, NULL);
	bool ok;

	cmd_recipe_begin(cmd, i);
	ok = multilayer_unchanged(cmd, job->o, prefix) ||
	     multilayer_mesh(cmd, job->o, job->color, in, prefix);
	free(prefix);
	return ok ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

/* --from-depth */
static int
bake_height_field(struct cmd *cmd, int i, void *arg)
{
	const struct job *job = arg;
	char *prefix = prefix_of(cmd, job->o->from_depth, NULL);
	bool ok;

	(void)i;
	cmd_recipe_begin(cmd, -1);
	ok = multilayer_unchanged(cmd, job->o, prefix) ||
	     multilayer_height_field(cmd, job->o, job->color, prefix);
	free(prefix);
	return ok ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

static int
run(struct cmd *cmd, const struct multilayer_opts *o)
{
	struct job job = { o, NULL };
	struct bake_err err = BAKE_ERR_INIT;
	int status;

	if (!multilayer_usage(cmd, o) ||
	    !cmd_paths_differ(cmd, &cmd->operands, prefix_of, NULL))
		return CMD_EXIT_USAGE;
	cmd_silence_libraries(cmd);
	if (bake_color_open(NULL, &job.color, &err) != BAKE_OK) {
		cmd_error(cmd, "%s", err.msg);
		return CMD_EXIT_FAIL;
	}
	if (bake_color_path(job.color) != NULL)
		cmd_list_add(&cmd->read, bake_color_path(job.color));
	status = o->from_depth != NULL
		     ? cmd_one(cmd, bake_height_field, &job)
		     : cmd_batch(cmd, &cmd->operands, bake_mesh, &job);
	bake_color_close(job.color);
	return status;
}

int
main(int argc, char *argv[])
{
	struct multilayer_opts o = { .mesh = BAKE_MESH_PARAMS_DEFAULT,
		.axis = BAKE_AXIS_POS_Z,
		.width = 256,
		.height = 256,
		.nlayers = 4,
		.depth_scale = 0.1,
		.nviews = 1,
		.dilate = -1 };
	const struct cmd_tool tool = { "rm-multilayer", "MESH ... -o PREFIX",
		"A closed mesh as textures: up to four depths a texel, normals "
		"and colour.",
		multilayer_options,
		CMD_OPTS_OUTPUT | CMD_OPTS_RELIEF | CMD_OPTS_OUTPUT_NORMAL |
		    CMD_IN_ORDER | CMD_OUTPUT_PREFIX,
		multilayer_set_option, &o, main, 24, multilayer_marks };
	struct cmd cmd;
	int status;

	if (cmd_parse(&cmd, &tool, argc, argv, &status))
		status = run(&cmd, &o);
	return cmd_finish(&cmd, status);
}
