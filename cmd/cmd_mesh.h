/* Reading meshes for the tools: warnings, standard input, depfile. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_MESH_H
#define CMD_MESH_H

#include "cmd.h"
#include "mesh.h"

/*
 * Read a mesh file; '-' is standard input, where it is OBJ unless its first
 * bytes say PLY or glTF. What was dropped or is not as it should be is a
 * warning; the files read are noted for the depfile. On failure the message is
 * printed and false returned.
 */
bool cmd_read_mesh(struct cmd *cmd, const char *path,
    const struct bake_mesh_params *params, struct bake_mesh *mesh);

#endif
