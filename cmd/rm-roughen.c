/* rm-roughen: 2 1/2 D texture mapping, a colour texture made to look rough. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "cmd_batch.h"
#include "cmd_recipe.h"
#include "roughen_tool.h"

static bool
check_space(struct roughen_job *job, const char *space)
{
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_color_check(job->color, space, &err) == BAKE_OK)
		return true;
	cmd_error(job->cmd, "%s", err.msg);
	return false;
}

/* Before any work: what the configuration does not know is an error. */
static bool
open_color(struct roughen_job *job)
{
	struct bake_err err = BAKE_ERR_INIT;
	const char *path;

	if (job->o->encoded)
		return true;
	if (bake_color_open(NULL, &job->color, &err) != BAKE_OK) {
		cmd_error(job->cmd, "%s", err.msg);
		return false;
	}
	path = bake_color_path(job->color);
	if (path != NULL)
		cmd_list_add(&job->cmd->read, path);
	return check_space(job, job->o->space != NULL ? job->o->space : "sRGB");
}

static bool
roughen_one(struct roughen_job *job, const char *in)
{
	struct cmd *cmd = job->cmd;
	struct roughen_texture t = { .tones = NULL };
	char *path = NULL;
	bool ok = true;

	job->strength = job->o->strength;
	if (cmd->output != NULL || cmd->output_dir != NULL) {
		path = cmd_output_path(cmd, in, "");
		ok = path != NULL;
	}
	if (ok && in != NULL)
		ok = roughen_open(job, in, path, &t);
	if (ok && job->o->fit != NULL)
		ok = roughen_fit(job, &t);
	if (ok && job->o->fit_depth != NULL)
		ok = roughen_fit_depth(job, &t);
	ok = ok && roughen_prepare(job, &t) && roughen_report(job, &t) &&
	     (path == NULL || roughen_write(job, &t, path));
	roughen_close(&t);
	free(path);
	return ok;
}

static void
plan_outputs(struct cmd *cmd, const struct roughen_opts *o, const char *in)
{
	char *path = NULL;

	if (in != NULL && (cmd->output != NULL || cmd->output_dir != NULL))
		path = cmd_output_path(cmd, in, "");
	cmd_recipe_output(cmd, path, "picture");
	cmd_recipe_output(cmd, o->lut, "lut");
	cmd_recipe_output(cmd, o->plot, "plot");
	cmd_recipe_output(cmd, o->sheet, "sheet");
	cmd_recipe_output(cmd, o->cylinder, "cylinder");
	cmd_recipe_output(cmd, o->render, "render");
	if (!o->encoded)
		cmd_recipe_color(cmd);
	free(path);
}

/* Operand i; without operands, what needs none. */
static int
roughen_operand(struct cmd *cmd, int i, void *arg)
{
	struct roughen_job *job = arg;
	const char *in = cmd->operands.n > 0 ? cmd->operands.item[i] : NULL;

	cmd_recipe_begin(cmd, i);
	plan_outputs(cmd, job->o, in);
	if (cmd_unchanged(cmd))
		return CMD_EXIT_OK;
	return roughen_one(job, in) ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

static int
run(struct cmd *cmd, const struct roughen_opts *o)
{
	struct roughen_job job = { .cmd = cmd, .o = o };
	int status;

	if (!roughen_args_are_clear(cmd, o))
		return CMD_EXIT_USAGE;
	if (!open_color(&job))
		status = CMD_EXIT_FAIL;
	else if (cmd->operands.n == 0)
		status = cmd_one(cmd, roughen_operand, &job);
	else
		status = cmd_batch(cmd, &cmd->operands, roughen_operand, &job);
	bake_color_close(job.color);
	return status;
}

int
main(int argc, char *argv[])
{
	struct roughen_opts o = { .model = BAKE_ROUGHEN_FACET,
		.strength = 0.09,
		.at = 10,
		.luma = { 0.2126, 0.7152, 0.0722 },
		.angles = { 10, 20, 30, 40, 50, 60, 70, 80 },
		.nangles = 8,
		.lut_width = 64,
		.lut_height = 64,
		.depth_scale = -1 };
	struct cmd_tool tool = { "rm-roughen", "IN ... -o OUT",
		"A colour texture, remapped so that it looks rough in the "
		"light.",
		roughen_options,
		CMD_OPTS_OUTPUT | CMD_OPTS_RELIEF | CMD_OPTS_NORMAL,
		roughen_set, &o, main, 48, roughen_marks };
	struct cmd cmd;
	int status;

	if (cmd_parse(&cmd, &tool, argc, argv, &status))
		status = run(&cmd, &o);
	return cmd_finish(&cmd, status);
}
