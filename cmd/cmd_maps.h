/* Maps that several tools read: normals in any code; maps of other sizes. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_MAPS_H
#define CMD_MAPS_H

#include "cmd_image.h"

/*
 * Read a normal map, or the normals of a packed texture: x, y, z in channels
 * 0, 1, 2 in the unsigned code, y as stored. By the names R, G, B, else the
 * first three; with two channels, or a packed texture's, z is computed. False
 * with the reason printed.
 */
bool cmd_read_normal(struct cmd *cmd, const char *path, struct cmd_map *map);

/* Where the map's positive y points: by the option, else its metadata, else
 * up. */
enum bake_normal_y cmd_normal_y(
    const struct cmd *cmd, const struct cmd_map *map);

/* Resample a map (by Catmull-Rom); does nothing where it has that size. Warns
 * where texels become oblong. False with the reason printed. */
bool cmd_resize(struct cmd *cmd, struct cmd_map *map, struct bake_wrap wrap,
    int width, int height);

/*
 * Warn where normals in the unsigned code, and a relief map or NULL, contradict
 * what is said of them; options is a list, for people, of those that say it.
 * Nothing is looked at with --quiet. False, the reason printed, where memory
 * runs out.
 */
bool cmd_warn_contradictions(struct cmd *cmd, const struct cmd_map *normal,
    const struct cmd_map *relief, struct bake_wrap wrap,
    const struct bake_relief_meta *said, const char *options);

#endif
