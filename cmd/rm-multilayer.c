/* rm-multilayer: a closed mesh as a few textures of depth and normals. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "multilayer_tool.h"

/* What the names of an input's outputs begin with; NULL: nothing is written.
 * To be freed. */
static char *
prefix_of(const struct cmd *cmd, const char *input, const void *arg)
{
	(void)arg;
	if (cmd->output != NULL)
		return strdup(cmd->output);
	if (cmd->output_dir == NULL)
		return NULL;
	return cmd_path_derive(input, cmd->output_dir, "", "");
}

static int
run(struct cmd *cmd, const struct multilayer_opts *o)
{
	struct bake_color *color = NULL;
	struct bake_err err = BAKE_ERR_INIT;
	int status = CMD_EXIT_OK;

	if (!multilayer_usage(cmd, o) ||
	    !cmd_paths_differ(cmd, &cmd->operands, prefix_of, NULL))
		return CMD_EXIT_USAGE;
	cmd_silence_libraries(cmd);
	if (bake_color_open(NULL, &color, &err) != BAKE_OK) {
		cmd_error(cmd, "%s", err.msg);
		return CMD_EXIT_FAIL;
	}
	if (bake_color_path(color) != NULL)
		cmd_list_add(&cmd->read, bake_color_path(color));
	if (o->from_depth != NULL) {
		char *prefix = prefix_of(cmd, o->from_depth, NULL);

		if (!multilayer_height_field(cmd, o, color, prefix))
			status = CMD_EXIT_FAIL;
		free(prefix);
	}
	for (int i = 0; i < cmd->operands.n; i++) {
		char *prefix = prefix_of(cmd, cmd->operands.item[i], NULL);

		if (!multilayer_mesh(
			cmd, o, color, cmd->operands.item[i], prefix))
			status = CMD_EXIT_FAIL;
		free(prefix);
	}
	bake_color_close(color);
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
		multilayer_set_option, &o };
	struct cmd cmd;
	int status;

	if (cmd_parse(&cmd, &tool, argc, argv, &status))
		status = run(&cmd, &o);
	return cmd_finish(&cmd, status);
}
