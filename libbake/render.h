/* The reference renderer: reliefs on meshes, as pictures and as buffers. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_RENDER_H
#define BAKE_RENDER_H

#include <stdbool.h>

#include "camera.h"
#include "image.h"
#include "march.h"
#include "mesh_frame.h"
#include "multi_march.h"
#include "parallel.h"
#include "quadric.h"
#include "raster.h"
#include "roughen.h"
#include "shell_march.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a renderer does where a ray leaves the relief sideways.
 *   NONE     the ground is taken as flat: each fragment shows something
 *   QUADRIC  rays bend with the vertices' quadrics; those that leave are
 *            discarded (Oliveira and Policarpo 2005)
 *   SHELL    the curved shell is marched (shell_march.h): the reference
 */
enum bake_silhouette {
	BAKE_SILHOUETTE_NONE,
	BAKE_SILHOUETTE_QUADRIC,
	BAKE_SILHOUETTE_SHELL
};

/*
 * One layer of relief on a surface; several are blended at every sample: a live
 * meta-relief (meta-relief paper, Eq. 1, 2).
 *   map     its depth
 *   texels  [H][W] 4 channels: normal x, y (signed, y up), AO, and depth
 *   tile_u, tile_v  repeats over the object's UVs (times the object's own)
 *   offset_u, offset_v  in repeats, to the right and up; without them a repeat
 *           begins at the texture's top left corner, as in bake_combine_add
 *   normal_weight, depth_weight  shares w_n, w_d; their sums over the layers
 *           are divided by
 *   slope   s: by how much the layer's slopes are steeper than its normals say
 *           (bake_combine_scales); 1 for a single layer
 *   ao_scale  s of Eq. 6 for its AO
 */
struct bake_render_layer {
	const struct bake_relief_map *map;
	const struct bake_image *texels;
	struct bake_wrap wrap;
	double tile_u, tile_v, offset_u, offset_v;
	double normal_weight, depth_weight, slope, ao_scale;
};

/* How the layers' normals become one (see rm-combine): the weighted mean of
 * unit normals, or the weighted sum of slopes. */
enum bake_render_blend { BAKE_RENDER_SEED, BAKE_RENDER_PD };

/* How an object is shaded besides Lambert's law and Blinn and Phong's
 * highlight: 2 1/2 D texture mapping of its colour where roughen is set. */
struct bake_render_material {
	const struct bake_image
	    *color; /* r g b (a), scene-linear; NULL: none */
	struct bake_wrap color_wrap;
	double color_tile_u, color_tile_v; /* over the relief's repeats */
	float base[3];                     /* times that, scene-linear */
	float specular;
	int shininess; /* the exponent, a whole number: 0 .. 4096 */
	const struct bake_roughen *roughen; /* NULL: none */
};

/* The quadrics in a diverging map, blue below 0, white, red above: where they
 * are +-paint_scale the colour is full. */
enum bake_render_paint {
	BAKE_RENDER_PAINT_NONE,
	BAKE_RENDER_PAINT_A,
	BAKE_RENDER_PAINT_B,
	BAKE_RENDER_PAINT_MEAN /* a + b, the mean curvature */
};

/*
 * An object: a mesh with what is on it. Of layers, multi and impostor at most
 * one is set; none: plain geometry.
 *
 *   frames      of the mesh; frames->frame_of are the corners
 *   quadrics    [frames->nframes]; needed for SILHOUETTE_QUADRIC
 *   shell       needed for SILHOUETTE_SHELL
 *   depth       D, the relief's depth range in mesh units, > 0
 *   tile_u, tile_v  repeats of the relief over u and v 0 .. 1
 *   horizons    of a single layer, as bake_ao gives them: a channel for each
 *               direction; its shadows are then soft. NULL: marched, and hard
 *   horizon_slope  the slopes of the relief as it is seen, to those that the
 *               horizons were baked for
 *   multi       multilayer relief mapped onto the mesh, seen from both sides
 *   ground      where rays miss the multilayer relief: NULL: nothing is there;
 *               else the bottom of the relief has that material's colour
 *   impostor    the mesh is not used (NULL): multi fills the box with the
 *               corners box[0] and box[1] in the axes of the multilayer view,
 *               box_axes, row by row, in world space
 */
struct bake_render_object {
	const struct bake_mesh *mesh;
	const struct bake_frames *frames;
	const struct bake_quadric *quadrics;
	const struct bake_shell *shell;
	enum bake_silhouette silhouette;
	double depth, tile_u, tile_v;
	const struct bake_render_layer *layers;
	int nlayers;
	enum bake_render_blend blend;
	const struct bake_image *horizons;
	double horizon_slope;
	bool ao_min; /* the least of the layers' AO, not their product */
	const struct bake_multi_map *multi;
	const struct bake_render_material *ground;
	bool impostor;
	double box[2][3], box_axes[3][3];
	bool two_sided; /* plain geometry and reliefs: backs are seen as well */
	enum bake_render_paint paint; /* instead of the material's colour */
	double paint_scale;
	struct bake_render_material material;
};

/* A light: from a direction (towards it, any length) or at a point. radius: the
 * sine of the angle that it is seen under, halved; for soft shadows, > 0 there.
 */
struct bake_render_light {
	bool point;
	double at[3];
	float color[3];
	float radius;
};

enum bake_shadow { BAKE_SHADOW_NONE, BAKE_SHADOW_HARD };

struct bake_render_params {
	struct bake_camera camera;
	int samples; /* n x n a pixel, 1 .. 4 */
	struct bake_march_params march;
	struct bake_render_light light;
	float ambient[3], background[4]; /* r g b and alpha, scene-linear */
	enum bake_shadow shadow;
	bool ao;
	bool
	    depth_bias; /* the appendix's d (2 v_z - v_z^2), multilayer alone */
	int nthreads;
	struct bake_progress progress;
};

/*
 * The picture, each [height][width]; those that are not wanted are left out by
 * want. A pixel with several samples: color and mask are their mean, the others
 * the mean of those that hit something.
 *   color     4: r g b scene-linear, multiplied by a: the mean of the samples,
 *             the background's colour times its alpha where nothing is hit
 *   distance  1: from the eye along the ray, mesh units; +infinity: nothing
 *   normal    3: in world space
 *   ao        1
 *   uv        2: of the texture, where the relief was hit
 *   mask      1: the share of samples that hit
 */
enum {
	BAKE_BUFFER_DISTANCE = 1,
	BAKE_BUFFER_NORMAL = 2,
	BAKE_BUFFER_AO = 4,
	BAKE_BUFFER_UV = 8,
	BAKE_BUFFER_MASK = 16,
	BAKE_BUFFER_ALL = 31
};
struct bake_render_buffers {
	int want;
	struct bake_image color, distance, normal, ao, uv, mask;
};
BAKE_API void bake_render_buffers_free(struct bake_render_buffers *buffers);

/*
 * Render. Every fragment of every object is followed into its relief; what is
 * nearest is seen, so that reliefs interpenetrate each other and plain
 * geometry; of equally near ones the first object's, then the first triangle's.
 *
 *   objects  [nobjects], in the order in which ties are decided
 *   buffers  want in; the images BAKE_IMAGE_INIT before, the caller's to free
 *
 * BAKE_EINVAL  a parameter outside its range, an object that is not whole
 * BAKE_ENOMEM  no memory; buffers are then empty
 *
 * The same bytes for any number of threads and instruction set. Reentrant.
 * Source: Policarpo, Oliveira and Comba 2005; Oliveira and Policarpo 2005;
 * Policarpo and Oliveira 2006; see the members.
 */
BAKE_API enum bake_status bake_render(const struct bake_render_object *objects,
    int nobjects, const struct bake_render_params *params,
    struct bake_render_buffers *buffers, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
