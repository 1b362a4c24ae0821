/* What a surface is like where a ray crosses it: normal and colour. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_LAYER_SURFACE_H
#define BAKE_LAYER_SURFACE_H

#include "abuffer.h"
#include "image.h"
#include "mesh_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 *   flat      the triangle's own normal, not the interpolated one
 *   normals   where interpolated normals come from (mesh_frame.h)
 *   textures  [mesh->nmaterials] the base-colour texture of each material in
 *             scene-linear light, 1 to 4 channels (grey, grey and alpha, r g b,
 *             r g b and alpha), finite, alpha not multiplied in; or NULL
 *             entries, or NULL: none. One picture may be given for several
 *             materials. Must outlive the surface
 *   factors   [mesh->nmaterials][4] each material's base colour factor, in
 *             scene-linear light; NULL: all 1
 *   vertex_colors  [mesh->npositions][4] scene-linear; NULL: all 1. Must
 *             outlive the surface
 *   nthreads  0 = all processors
 */
struct bake_surface_params {
	bool flat;
	enum bake_normal_source normals;
	const struct bake_image *const *textures;
	const float (*factors)[4];
	const float (*vertex_colors)[4];
	int nthreads;
};
#define BAKE_SURFACE_PARAMS_DEFAULT                                            \
	{                                                                      \
		false, BAKE_NORMALS_AUTO, NULL, NULL, NULL, 0                  \
	}

struct bake_surface;

/*
 * Make ready: the corners' normals, the triangles' footprints in UV, and the
 * pyramids of the textures (texture_sample.h; one for each picture).
 *
 * A corner's normal is the file's where it has one; else, or if
 * params->normals says COMPUTED, that of its welded point: normalize(sum of
 * angle * n) over the triangles around the point in the mesh's order, n the
 * unit normal of one and angle its angle at the point, triangles that have no
 * area left out. All edges are smooth then: creases are those that the file's
 * normals have.
 *
 *   mesh, weld, ab  must outlive it; ab is of that mesh and view. weld may be
 *                   NULL: each position is a point of its own
 *   view            of ab; copied
 *   surface         out: the caller closes it
 *
 * BAKE_EINVAL  a weld of another mesh, or a texture without texels or with more
 *              than 4 channels
 * BAKE_EDATA   no triangle; BAKE_NORMALS_FILE and the mesh has no normals
 * BAKE_ENOMEM  no memory; on any failure *surface is NULL
 *
 * Memory: 16 bytes a triangle, 12 a normal of the file and, where any has to be
 * computed, 12 a position (36, and up to 6 MiB, while
 * opening); with textures 16 more a triangle,
 * and a third of each texture. The same results for every nthreads.
 */
BAKE_API enum bake_status bake_surface_open(struct bake_surface **surface,
    const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_abuffer *ab, const struct bake_view *view,
    const struct bake_surface_params *params, struct bake_err *err);
BAKE_API void bake_surface_close(struct bake_surface *surface); /* NULL: ok */

/* Triangles of a material with a texture that have a corner without UV: their
 * colour is without the texture's. */
BAKE_API size_t bake_surface_missing_uvs(const struct bake_surface *surface);

/*
 * The unit normal, in the axes of the view (x right, y to the top of the
 * picture, z towards the eye), where crossing is the one at texel (x, y).
 *
 * n = normalize(sum of weight * normal) of the triangle's corners, or the
 * triangle's own normal where params->flat is set or nothing is left of the sum
 * (it is shorter than 1e-6: normals that oppose each other).
 *
 * n is turned round where the crossing is not what the triangle's side says: an
 * entry through its back or an exit through its front, as solidify and
 * reorient of abuffer.h, or parts that are inside out, make them. A triangle
 * seen so nearly edge on that vertices moved by 2^-16 texel could have turned
 * it over has no side, and is left as it is.
 *
 * Then n_z >= 0 where the ray enters and n_z <= 0 where it leaves: the shader
 * takes the sign from the layer's parity. Where n disagrees, n_z = 0 and x, y
 * are made unit length again; where less than 1e-6 is left of x, y they are the
 * triangle's own normal's, and n is (0, 0, 1) or (0, 0, -1) where these are 0,
 * too.
 *
 *   normal  out: unit length within 2e-7
 *
 * Threads may ask at once.
 */
BAKE_API void bake_surface_normal(const struct bake_surface *surface,
    const struct bake_crossing *crossing, int x, int y, float normal[3]);

/*
 * The colour there, r g b a in scene-linear light, not multiplied by a:
 *     factor x vertex colour x texture
 * each channel by itself; vertex colours and UVs are interpolated by the
 * crossing's weights. A triangle without material has factor 1 and no texture.
 *
 * The texture is looked up at the UV that the material's uv_matrix gives, with
 * its wrap modes, filtered over one texel of the view on the plane of the
 * triangle (texture_sample.h): the steps du/dx, dv/dx, du/dy, dv/dy are the
 * same all over a triangle. A step is at most 8 times as long as on a triangle
 * that faces the eye, so that slivers at silhouettes do not take their colour
 * from all over the texture.
 *
 * Alpha, by the material's mode: OPAQUE 1, the texture's alpha having no say;
 * MASK 1 where the product is at least alpha_cutoff, else 0; BLEND, and without
 * material, the product.
 *
 * Threads may ask at once.
 */
BAKE_API void bake_surface_color(const struct bake_surface *surface,
    const struct bake_crossing *crossing, int x, int y, float color[4]);

#ifdef __cplusplus
}
#endif

#endif
