/* Writing what a renderer reads: the files of a target, from whole maps. */
/* SPDX-License-Identifier: MIT */
#include "cmd_target.h"

#include <stdlib.h>
#include <string.h>

bool
cmd_set_target(
    struct cmd *cmd, const char *name, const struct bake_target **target)
{
	*target = bake_target_find(name);
	return *target != NULL ||
	       cmd_usage_error(cmd,
		   "--target is '%s', which is none of --list-targets", name);
}

int
cmd_print_targets(void)
{
	int n;
	const struct bake_target *t = bake_targets(&n);

	for (int i = 0; i < n; i++)
		printf("%-11s %s\n", t[i].name, t[i].about);
	return CMD_EXIT_OK;
}

bool
cmd_target_fits(const struct cmd *cmd, const struct bake_target *target)
{
	if (cmd->output != NULL && strcmp(cmd->output, "-") == 0 &&
	    target->nfiles > 1)
		return cmd_usage_error(cmd,
		    "target %s writes %d files, which standard output cannot "
		    "hold",
		    target->name, target->nfiles);
	return true;
}

/* y and polarity as the output wants them. */
static void
turn(struct cmd_target_maps *m, enum bake_normal_y normal_y,
    enum bake_polarity polarity)
{
	if (m->meta.normal_y != normal_y)
		bake_relief_flip(m->normal, 1);
	if (m->meta.polarity != polarity)
		bake_relief_flip(m->relief, 0);
	m->meta.normal_y = normal_y;
	m->meta.polarity = polarity;
}

static bool
write_file(struct cmd *cmd, const struct bake_target_file *file,
    const struct cmd_target_maps *m, const char *out)
{
	static const char *const exr_names[] = { "normal.x", "normal.y", "ao",
		"depth" };
	struct bake_relief_meta meta = m->meta;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	char *path = cmd_path_derive(out, NULL, file->suffix, NULL);
	bool names = m->exr_names && file->layout == BAKE_LAYOUT_RELIEF;
	bool ok;

	meta.layout = file->layout;
	meta.normal_code = BAKE_NORMAL_CODE_UNSIGNED;
	ok = bake_relief_pack(file, m->normal, m->ao, m->relief, &img, &err) ==
	     BAKE_OK;
	if (!ok)
		cmd_error(cmd, "%s: %s", path, err.msg);
	ok = ok && cmd_write(cmd, &img, path, m->deepest, &meta,
		       names ? exr_names : NULL);
	bake_image_free(&img);
	free(path);
	return ok;
}

bool
cmd_write_target(struct cmd *cmd, const struct bake_target *target,
    struct cmd_target_maps *maps, const char *out)
{
	bool ok = true;

	turn(maps,
	    cmd->output_normal_y != BAKE_NORMAL_Y_UNSURE ? cmd->output_normal_y
							 : target->normal_y,
	    target->polarity);
	for (int f = 0; ok && f < target->nfiles; f++)
		ok = write_file(cmd, &target->file[f], maps, out);
	return ok;
}
