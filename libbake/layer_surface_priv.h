/* What the parts of a surface share: its tables. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_LAYER_SURFACE_PRIV_H
#define BAKE_LAYER_SURFACE_PRIV_H

#include "layer_surface.h"
#include "texture_sample.h"

/*
 * A triangle of the mesh.
 *   normal  its corners' indices into surface.normals
 *   facing  +1 it is surely seen from its front, -1 from its back, 0 edge on
 */
struct surface_triangle {
	int normal[3];
	int facing;
};

/* A material as it is needed for one texel. sampler: its own or another's. */
struct surface_material {
	double factor[4];
	const struct bake_sampler *sampler; /* NULL: no texture */
	struct bake_sampler *own;           /* to be closed, or NULL */
	const struct bake_image *texture;
	double uv_matrix[2][3];
	enum bake_tex_wrap wrap_u, wrap_v;
	enum bake_alpha_mode alpha_mode;
	double alpha_cutoff;
};

/* du/dx, dv/dx, du/dy and dv/dy of a triangle; x, y in texels of the view, y
 * downwards. */
struct surface_step {
	float u_x, v_x, u_y, v_y;
};

/*
 *   scale      texels of the view per unit of X, Y and Z
 *   normals    unit length or 0, in the axes of the view
 *   materials  [nmaterials + 1], the last for triangles without
 *   steps      [ntriangles], NULL where no material has a texture
 */
struct bake_surface {
	const struct bake_mesh *mesh;
	const struct bake_weld *weld; /* may be NULL */
	const struct bake_abuffer *ab;
	struct bake_view view;
	struct bake_axes axes;
	double scale[3];
	bool flat;
	struct surface_triangle *triangles;
	float (*normals)[3];
	size_t nmaterials;
	struct surface_material *materials;
	struct surface_step *steps;
	const float (*vertex_colors)[4];
	size_t missing_uvs;
};

/* The point that a corner is, and its position. */
static inline int
bake_surface_point(const struct bake_surface *s, struct bake_corner c)
{
	return s->weld != NULL ? s->weld->first[c.v] : c.v;
}

static inline const double *
bake_surface_position(const struct bake_surface *s, struct bake_corner c)
{
	return s->mesh->positions[bake_surface_point(s, c)];
}

/* A position of the mesh in texels of the view: x to the right, y downwards
 * from the view's corner; z towards the eye, by the mean of both scales. */
void bake_surface_place(
    const struct bake_surface *s, const double p[3], double q[3]);

/* The triangle's own normal in the axes of the view, of unit length; false, n
 * then 0, where it has no area. */
bool bake_surface_flat_normal(
    const struct bake_surface *s, size_t triangle, double n[3]);

/* Fill normals and triangles, in s->normals and s->triangles. */
enum bake_status bake_surface_take_normals(struct bake_surface *s,
    enum bake_normal_source source, int nthreads, struct bake_err *err);

/* Fill what colours need; on failure bake_surface_free_materials frees it. */
enum bake_status bake_surface_take_materials(struct bake_surface *s,
    const struct bake_surface_params *params, struct bake_err *err);
void bake_surface_free_materials(struct bake_surface *s);

#endif
