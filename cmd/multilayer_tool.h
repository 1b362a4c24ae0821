/* rm-multilayer: what its parts share. */
/* SPDX-License-Identifier: MIT */
#ifndef MULTILAYER_TOOL_H
#define MULTILAYER_TOOL_H

#include "cmd_image.h"
#include "mesh.h"
#include "multilayer.h"

enum { MULTILAYER_ALL = -1 };

/* The options. */
struct multilayer_opts {
	struct bake_mesh_params mesh;
	enum bake_axis axis;
	int width, height;
	bool has_region, has_range;
	double region[4], near, far;
	bool tile_x, tile_y;
	int nlayers; /* 0: as many as there are */
	enum bake_cap_policy policy;
	double weld, solidify, depth_scale;
	bool reorient, flat, no_color, all_colors, deep, multi_part, impostor;
	bool stats, policarpo, mip_half;
	enum bake_normal_source normals;
	int nviews;     /* 1 or 3 */
	int mips;       /* levels after the first; MULTILAYER_ALL */
	bool mips_open; /* --mip-levels was given without a number just now */
	int dilate;     /* texels; -1: not given */
	const char *from_depth, *preview, *texture;
};

/* One set of textures on its way to files. */
struct multilayer_set {
	struct bake_layer_maps maps;
	struct bake_relief_meta meta; /* its layer part holds for all files */
};

bool multilayer_set_option(struct cmd *cmd, int key, const char *arg);
extern const struct cmd_option multilayer_options[];
extern const struct cmd_mark multilayer_marks[];

/* Whether the options go together; otherwise a usage error. */
bool multilayer_usage(struct cmd *cmd, const struct multilayer_opts *o);

/* One mesh, or the height field, with all its views, to files whose names
 * begin with prefix. False with the reason printed. */
bool multilayer_mesh(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_color *color, const char *path, const char *prefix);
bool multilayer_height_field(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_color *color, const char *prefix);

/* The data format of the outputs. */
enum bake_data_format multilayer_format(
    const struct cmd *cmd, enum bake_data_format deepest);

/* Say what will be written to files whose names begin with prefix (NULL: no
 * files), and whether --if-changed finds it there. */
bool multilayer_unchanged(
    struct cmd *cmd, const struct multilayer_opts *o, const char *prefix);
/* How many textures of depth, colours and levels after the first a set has:
 * what its files are is told in their records. */
void multilayer_plan_set(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_layer_maps *maps, int nlevels, const char *prefix);
/* NAME.exr, where that is not the name already; '-' stays. To be freed. */
char *multilayer_exr_path(const char *prefix);
/* PREFIX_x …, one of the views of an object; letter 0: PREFIX itself. To be
 * freed; NULL for NULL. */
char *multilayer_view_prefix(const char *prefix, char letter);
/* Where --preview goes for that view. */
char *multilayer_preview_path(const struct multilayer_opts *o, char letter);

/* Write a set: its mip levels, dilated, as many files or as one. */
bool multilayer_write(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_color *color, struct multilayer_set *set,
    const char *prefix);

/* An image of a set, and what it is called. */
enum { MULTILAYER_NAME = 48 };
struct multilayer_image {
	char name[MULTILAYER_NAME]; /* "depth", "nx2", "mip1.ny" … */
	const struct bake_pixels *px;
	struct bake_relief_meta meta;
};

/* A growing list of them; the pixels belong to the sets. */
struct multilayer_album {
	struct multilayer_image *image;
	int n, room;
};

/* Write images as the parts of one file, PREFIX.exr or PREFIX if that is such a
 * name; or a deep image, from the mesh of mesh_path. */
bool multilayer_write_parts(
    struct cmd *cmd, const struct multilayer_album *album, const char *prefix);
bool multilayer_write_deep(struct cmd *cmd, const struct multilayer_opts *o,
    const char *mesh_path, const struct bake_multilayer *ml,
    const struct bake_multilayer_params *p, const struct bake_relief_meta *meta,
    const char *prefix, struct bake_multilayer_stats *stats);

/* Say what was found: errors where the mesh does not close (then false),
 * warnings where something was lost, and with --stats a table. */
bool multilayer_judge(struct cmd *cmd, const struct multilayer_opts *o,
    const char *path, const struct bake_view *view,
    const struct bake_multilayer_stats *stats);
bool multilayer_print_stats(const char *path, const struct bake_view *view,
    enum bake_data_format format, const struct bake_multilayer_stats *stats);

#endif
