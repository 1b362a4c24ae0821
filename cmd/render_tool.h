/* rm-render: what its parts share. */
/* SPDX-License-Identifier: MIT */
#ifndef RENDER_TOOL_H
#define RENDER_TOOL_H

#include "cmd_image.h"
#include "color.h"
#include "mesh.h"
#include "render.h"
#include "shape.h"
#include "view.h"

enum { RENDER_MAX_OBJECTS = 16, RENDER_MAX_LAYERS = 16 };

/* A layer of relief as the command line has it: a packed texture. */
struct render_layer_opts {
	const char *path;
	double weight, normal_weight, depth_weight; /* < 0: not given */
	double tile_u, tile_v, offset_u, offset_v;
	double depth_scale; /* 0: the file's */
};
#define RENDER_LAYER_OPTS_INIT                                                 \
	{                                                                      \
		NULL, -1, -1, -1, 1, 1, 0, 0, 0                                \
	}

/* An object as the command line has it. */
struct render_object_opts {
	const char *shape; /* a name or a file; NULL: the plane */
	const char *multilayer, *impostor, *color, *ground;
	const char *horizons;
	const char *quadric; /* "auto", "none" or a file */
	struct render_layer_opts layer[RENDER_MAX_LAYERS];
	int nlayers;
	double repeat_u, repeat_v; /* --repeat */
	double depth_scale, depth; /* 0: not given */
	double translate[3], rotate_deg[3], scale;
	double base[3]; /* --base-color */
	bool two_sided;
};

/* The options. */
struct render_opts {
	struct render_object_opts object[RENDER_MAX_OBJECTS];
	int nobjects;
	struct render_layer_opts next; /* being put together */
	const char *pending; /* the layer option given last, or NULL */
	struct bake_camera camera;
	bool has_camera, has_target, has_depth_range;
	double orbit[3];  /* yaw and pitch in degrees, distance in radii */
	double target[3]; /* with orbit; the scene's middle unless given */
	struct bake_light_opts {
		bool point;
		double at[3];
	} light;
	double ambient, specular, light_size;
	int shininess, samples, detail, turntable;
	struct bake_march_params march;
	enum bake_silhouette silhouette;
	bool has_silhouette, shadow, ao, depth_bias, ao_min;
	enum bake_render_blend blend;
	enum bake_shadow soft;
	double roughen; /* < 0: not asked for */
	enum bake_roughen_model roughen_model;
	double background[4];
	enum bake_render_paint paint;
	const char *buffers, *compare, *difference;
};

/* An object with all that belongs to it. */
struct render_loaded {
	struct bake_mesh mesh;
	struct bake_weld weld;
	struct bake_frames frames;
	struct bake_quadric *quadrics;
	struct bake_shell *shell;
	struct bake_image texels[RENDER_MAX_LAYERS];
	struct bake_relief_map *maps[RENDER_MAX_LAYERS];
	struct bake_render_layer layers[RENDER_MAX_LAYERS];
	struct bake_multi_map *multi;
	struct bake_image color, ground, horizons;
	struct bake_render_material ground_material;
	struct bake_roughen roughen;
	double lo[3], hi[3]; /* its box in the world */
};

struct render_scene {
	const struct bake_color *color;
	struct render_loaded loaded[RENDER_MAX_OBJECTS];
	struct bake_render_object object[RENDER_MAX_OBJECTS];
	int n;
};

extern const struct cmd_option render_options[];
extern const struct cmd_mark render_marks[];
bool render_set_option(struct cmd *cmd, int key, const char *arg);
/* All is whole and goes together; otherwise a usage error. */
bool render_usage(struct cmd *cmd, struct render_opts *o);

/* Read and derive all that the options ask for. False with the reason printed;
 * render_scene_free either way. */
bool render_scene_load(
    struct cmd *cmd, const struct render_opts *o, struct render_scene *scene);
void render_scene_free(struct render_scene *scene);
/* A colour texture in scene-linear light. */
bool render_read_color(struct cmd *cmd, const struct bake_color *color,
    const char *path, struct bake_image *img);
/* Multilayer relief as rm-multilayer wrote it, PREFIX or NAME.exr; color stays
 * empty where there is none. */
struct render_layer_set {
	struct bake_layer_maps maps;
	struct bake_image color;
	struct bake_relief_meta meta;
};
bool render_read_set(struct cmd *cmd, const struct bake_color *color,
    const char *prefix, struct render_layer_set *set);

/* The picture, and what else was asked for. */
bool render_write(struct cmd *cmd, const struct render_opts *o,
    const struct bake_color *color, const struct bake_render_buffers *buffers,
    const char *path);
/* Print how far buffers are from those of o->compare. */
bool render_compare(struct cmd *cmd, const struct render_opts *o,
    const struct bake_color *color, const struct bake_render_buffers *buffers);

#endif
