/* The base colours of a mesh's materials, read and made scene-linear. */
/* SPDX-License-Identifier: MIT */
#ifndef MESH_TEXTURES_H
#define MESH_TEXTURES_H

#include "cmd.h"
#include "color.h"
#include "mesh.h"

/*
 * What bake_surface_open and others take, all in scene-linear light.
 *   n         the mesh's nmaterials
 *   image     [n] the pictures that were read; empty where material i has none,
 *             or has one that a material before it has
 *   list      [n] material i's picture, or NULL
 *   factors   [n][4] base colour factors
 *   vertex_colors  [mesh->npositions][4], NULL where the mesh has none
 */
struct mesh_textures {
	int n;
	struct bake_image *image;
	const struct bake_image **list;
	float (*factors)[4];
	float (*vertex_colors)[4];
};
#define MESH_TEXTURES_INIT                                                     \
	{                                                                      \
		.n = 0                                                         \
	}

/*
 * Read every material's base-colour picture, from its file or from the bytes
 * inside the mesh's, each once, within cmd->limits. Pictures are sRGB, those of
 * half or float scene-linear; of more than 4 channels the first 4 are taken (3
 * where the fourth is not called A). Files read are noted for the depfile. A
 * picture that cannot be read is a warning that names it and the material,
 * whose factor then stands alone.
 *
 *   mesh_path  names the mesh in messages
 *   color      knows sRGB (bake_color_check)
 *   t          MESH_TEXTURES_INIT before; mesh_textures_free frees it, also
 *              after a failure
 *
 * False, with the reason printed, where there is no memory or colours cannot be
 * converted.
 */
bool mesh_textures_read(struct cmd *cmd, const struct bake_mesh *mesh,
    const char *mesh_path, const struct bake_color *color,
    struct mesh_textures *t);
void mesh_textures_free(struct mesh_textures *t);

#endif
