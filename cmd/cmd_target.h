/* Writing what a renderer reads: the files of a target, from whole maps. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_TARGET_H
#define CMD_TARGET_H

#include "cmd_image.h"

/* The maps of one texture as they are stored, and what is to be said of them;
 * the maps belong to the caller. */
struct cmd_target_maps {
	struct bake_image *normal; /* x, y, z in the unsigned code */
	struct bake_image *ao, *relief;
	struct bake_relief_meta meta;  /* with normal_y and polarity of these;
					* layout and code are set here */
	enum bake_data_format deepest; /* of what they were made of */
	bool exr_names;
};

/* --target NAME, and its listing on standard output; an exit status. */
bool cmd_set_target(
    struct cmd *cmd, const char *name, const struct bake_target **target);
int cmd_print_targets(void);

/* Whether standard output can take the target; otherwise a usage error. */
bool cmd_target_fits(const struct cmd *cmd, const struct bake_target *target);

/*
 * Write all files of the target, out and those beside it. Normal y and
 * polarity are turned in place, as --output-normal-y and the target have
 * them. False with the reason printed.
 */
bool cmd_write_target(struct cmd *cmd, const struct bake_target *target,
    struct cmd_target_maps *maps, const char *out);

#endif
