/* Writing what a renderer reads: the files of a target, from whole maps. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_TARGET_H
#define CMD_TARGET_H

#include "cmd_image.h"

/* Rows of the maps, or NULL where a map is not wanted. */
struct cmd_target_band {
	struct bake_image *normal; /* x, y, z in the unsigned code */
	struct bake_image *ao, *relief;
};

/* The maps of one texture as they are stored, and what is to be said of
 * them. */
struct cmd_target_maps {
	int width, height;
	/* Fill in rows y .. y + normal->height - 1 of the maps, all of the same
	 * height. For each file they are asked for in order, once. */
	enum bake_status (*get)(void *arg, int y,
	    const struct cmd_target_band *band, struct bake_err *err);
	void *arg;
	struct bake_relief_meta meta;  /* with normal_y and polarity of these;
					* layout and code are set here */
	enum bake_data_format deepest; /* of what they were made of */
	bool exr_names;
};

/* Rows y … of an image, as many as the band has, into all channels that the
 * band has. */
void cmd_target_copy(
    struct bake_image *band, const struct bake_image *img, int y);

/* --target NAME, and its listing on standard output; an exit status. */
bool cmd_set_target(
    struct cmd *cmd, const char *name, const struct bake_target **target);
int cmd_print_targets(void);

/* Whether standard output can take the target; otherwise a usage error. */
bool cmd_target_fits(const struct cmd *cmd, const struct bake_target *target);

/* Say that all files of the target will be written (cmd_recipe_output). */
void cmd_target_plan(
    struct cmd *cmd, const struct bake_target *target, const char *out);

/*
 * Write all files of the target, out and those beside it, a band of rows in
 * memory at a time, with normal y and polarity turned as --output-normal-y and
 * the target have them. False with the reason printed.
 */
bool cmd_write_target(struct cmd *cmd, const struct bake_target *target,
    const struct cmd_target_maps *maps, const char *out);

#endif
