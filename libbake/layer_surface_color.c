/* Colours of a surface: factor, vertex colour and texture. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layer_surface_priv.h"
#include "mem.h"
#include "parallel.h"

/* A texel's footprint is no longer than this many times that on a triangle that
 * faces the eye. */
static const double longest_tilt = 8;

/* -- materials ----------------------------------------------------------- */

static const struct surface_material no_material = {
	.factor = { 1, 1, 1, 1 },
	.alpha_mode = BAKE_ALPHA_BLEND,
};

/* The pyramid of material i's texture: that of one before it, or its own. */
static enum bake_status
take_sampler(
    struct bake_surface *s, size_t i, int nthreads, struct bake_err *err)
{
	struct surface_material *to = &s->materials[i];
	const bool opaque = to->alpha_mode == BAKE_ALPHA_OPAQUE;
	enum bake_status rc;

	for (size_t k = 0; k < i; k++) {
		const struct surface_material *m = &s->materials[k];

		if (m->own != NULL && m->texture == to->texture &&
		    (m->alpha_mode == BAKE_ALPHA_OPAQUE) == opaque) {
			to->sampler = m->own;
			return BAKE_OK;
		}
	}
	rc = bake_sampler_open(&to->own, to->texture, opaque, nthreads, err);
	to->sampler = to->own;
	return rc;
}

static enum bake_status
take_material(struct bake_surface *s, size_t i,
    const struct bake_surface_params *params, struct bake_err *err)
{
	const struct bake_material *from = &s->mesh->materials[i];
	struct surface_material *to = &s->materials[i];

	for (int c = 0; c < 4; c++)
		to->factor[c] =
		    params->factors != NULL ? params->factors[i][c] : 1;
	to->alpha_mode = from->alpha_mode;
	to->alpha_cutoff = from->alpha_cutoff;
	memcpy(to->uv_matrix, from->texture.uv_matrix, sizeof to->uv_matrix);
	to->wrap_u = from->texture.wrap_u;
	to->wrap_v = from->texture.wrap_v;
	if (params->textures != NULL)
		to->texture = params->textures[i];
	if (to->texture == NULL)
		return BAKE_OK;
	return take_sampler(s, i, params->nthreads, err);
}

void
bake_surface_free_materials(struct bake_surface *s)
{
	for (size_t i = 0; s->materials != NULL && i < s->nmaterials; i++)
		bake_sampler_close(s->materials[i].own);
	free(s->materials);
	free(s->steps);
}

static inline const struct surface_material *
material_of(const struct bake_surface *s, size_t triangle)
{
	const int i = s->mesh->material_of[triangle];

	return &s->materials[i >= 0 ? (size_t)i : s->nmaterials];
}

static inline bool
has_uvs(const struct bake_corner t[3])
{
	return t[0].vt >= 0 && t[1].vt >= 0 && t[2].vt >= 0;
}

/* -- steps --------------------------------------------------------------- */

/* A triangle's edges from corner 0: in texels of the view, as
 * bake_surface_place has them, and in those of the texture. */
struct edges {
	double e[3], f[3];
	double e_uv[2], f_uv[2];
};

static struct edges
edges_of(const struct bake_surface *s, const struct bake_corner t[3],
    const struct surface_material *mat)
{
	const struct bake_mesh *m = s->mesh;
	const double size[2] = { mat->texture->width, mat->texture->height };
	double p[3][3], uv[3][2];
	struct edges d;

	for (int k = 0; k < 3; k++) {
		const double *from = m->uvs[t[k].vt];

		bake_surface_place(s, bake_surface_position(s, t[k]), p[k]);
		for (int i = 0; i < 2; i++)
			uv[k][i] =
			    size[i] * (mat->uv_matrix[i][0] * from[0] +
					  mat->uv_matrix[i][1] * from[1]);
	}
	for (int k = 0; k < 3; k++) {
		d.e[k] = p[1][k] - p[0][k];
		d.f[k] = p[2][k] - p[0][k];
	}
	for (int i = 0; i < 2; i++) {
		d.e_uv[i] = uv[1][i] - uv[0][i];
		d.f_uv[i] = uv[2][i] - uv[0][i];
	}
	return d;
}

/* The root of the sum of the squares of both gradients in the triangle's own
 * plane: at least the longest step of a triangle that faces the eye. */
static double
facing_step(const struct edges *d)
{
	const double *e = d->e, *f = d->f;
	const double n[3] = { e[1] * f[2] - e[2] * f[1],
		e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0] };
	double sum = 0;

	for (int i = 0; i < 2; i++)
		for (int k = 0; k < 3; k++) {
			const double g = d->e_uv[i] * f[k] - d->f_uv[i] * e[k];

			sum += g * g;
		}
	return sqrt(sum / (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]));
}

static struct surface_step
step_of(const struct edges *d, const struct bake_image *texture)
{
	const double det = d->e[0] * d->f[1] - d->f[0] * d->e[1];
	const double limit = longest_tilt * facing_step(d);
	double step[2][2]; /* along x and y, of u and v */

	if (!isfinite(limit))
		return (struct surface_step){ 0 };
	for (int i = 0; i < 2; i++) {
		step[0][i] =
		    (d->e_uv[i] * d->f[1] - d->f_uv[i] * d->e[1]) / det;
		step[1][i] =
		    (d->f_uv[i] * d->e[0] - d->e_uv[i] * d->f[0]) / det;
	}
	for (int a = 0; a < 2; a++) {
		const double length =
		    sqrt(step[a][0] * step[a][0] + step[a][1] * step[a][1]);

		if (!isfinite(length)) {
			/* seen edge on: no direction either */
			step[a][a] = limit;
			step[a][1 - a] = 0;
		} else if (length > limit) {
			step[a][0] *= limit / length;
			step[a][1] *= limit / length;
		}
	}
	return (struct surface_step){ (float)(step[0][0] / texture->width),
		(float)(step[0][1] / texture->height),
		(float)(step[1][0] / texture->width),
		(float)(step[1][1] / texture->height) };
}

static enum bake_status
take_steps(struct bake_surface *s, int nthreads, struct bake_err *err)
{
	const ptrdiff_t n = (ptrdiff_t)s->mesh->ntriangles;
	size_t missing = 0;

	s->steps = bake_alloc((size_t)n, sizeof *s->steps, err);
	if (s->steps == NULL)
		return BAKE_ENOMEM;
#pragma omp parallel for schedule(static) num_threads(nthreads)               \
    reduction(+ : missing)
	for (ptrdiff_t i = 0; i < n; i++) {
		const struct bake_corner *t = s->mesh->triangles[i];
		const struct surface_material *mat = material_of(s, (size_t)i);
		struct edges d;

		s->steps[i] = (struct surface_step){ 0 };
		if (mat->sampler == NULL)
			continue;
		if (!has_uvs(t)) {
			missing++;
			continue;
		}
		d = edges_of(s, t, mat);
		s->steps[i] = step_of(&d, mat->texture);
	}
	s->missing_uvs = missing;
	return BAKE_OK;
}

enum bake_status
bake_surface_take_materials(struct bake_surface *s,
    const struct bake_surface_params *params, struct bake_err *err)
{
	const size_t n = s->mesh->nmaterials;
	enum bake_status rc = BAKE_OK;
	bool textured = false;

	s->materials = bake_zalloc(n + 1, sizeof *s->materials, err);
	if (s->materials == NULL)
		return BAKE_ENOMEM;
	s->nmaterials = n;
	s->materials[n] = no_material;
	for (size_t i = 0; i < n && rc == BAKE_OK; i++) {
		rc = take_material(s, i, params, err);
		textured |= s->materials[i].sampler != NULL;
	}
	if (rc == BAKE_OK && textured)
		rc = take_steps(s, bake_threads(params->nthreads), err);
	return rc;
}

/* -- one texel ----------------------------------------------------------- */

static inline void
mul_vertex_colors(const struct bake_surface *s, const struct bake_corner t[3],
    const double w[3], double color[4])
{
	const float *a = s->vertex_colors[t[0].v];
	const float *b = s->vertex_colors[t[1].v];
	const float *c = s->vertex_colors[t[2].v];

	for (int k = 0; k < 4; k++)
		color[k] *= w[0] * a[k] + w[1] * b[k] + w[2] * c[k];
}

static inline void
mul_texture(const struct bake_surface *s, const struct surface_material *mat,
    size_t triangle, const double w[3], double color[4])
{
	const struct bake_corner *t = s->mesh->triangles[triangle];
	const struct surface_step *step = &s->steps[triangle];
	struct bake_lookup at = { 0, 0, step->u_x, step->v_x, step->u_y,
		step->v_y, mat->wrap_u, mat->wrap_v };
	const int n = bake_sampler_nchans(mat->sampler);
	double uv[2] = { 0, 0 };
	float value[4];

	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 2; i++)
			uv[i] += w[k] * s->mesh->uvs[t[k].vt][i];
	at.u = mat->uv_matrix[0][0] * uv[0] + mat->uv_matrix[0][1] * uv[1] +
	       mat->uv_matrix[0][2];
	at.v = mat->uv_matrix[1][0] * uv[0] + mat->uv_matrix[1][1] * uv[1] +
	       mat->uv_matrix[1][2];
	bake_sampler_read(mat->sampler, &at, value);
	for (int k = 0; k < 3; k++)
		color[k] *= value[n >= 3 ? k : 0];
	if (n % 2 == 0)
		color[3] *= value[n - 1];
}

void
bake_surface_color(const struct bake_surface *s,
    const struct bake_crossing *crossing, int x, int y, float color[4])
{
	const size_t triangle = crossing->triangle;
	const struct bake_corner *t = s->mesh->triangles[triangle];
	const struct surface_material *mat = material_of(s, triangle);
	const bool textured = mat->sampler != NULL && has_uvs(t);
	double w[3], c[4];

	memcpy(c, mat->factor, sizeof c);
	if (textured || s->vertex_colors != NULL)
		bake_abuffer_weights(s->ab, crossing, x, y, w);
	if (s->vertex_colors != NULL)
		mul_vertex_colors(s, t, w, c);
	if (textured)
		mul_texture(s, mat, triangle, w, c);
	if (mat->alpha_mode == BAKE_ALPHA_OPAQUE)
		c[3] = 1;
	else if (mat->alpha_mode == BAKE_ALPHA_MASK)
		c[3] = c[3] >= mat->alpha_cutoff;
	for (int k = 0; k < 4; k++)
		color[k] = (float)c[k];
}
