/* A mesh in the making: arrays that grow. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh_priv.h"

void
bake_mesh_builder_init(struct mesh_builder *b, struct bake_mesh *mesh,
    const struct mesh_source *src)
{
	memset(b, 0, sizeof *b);
	b->mesh = mesh;
	b->src = src;
}

void
bake_mesh_builder_free(struct mesh_builder *b)
{
	free(b->corner);
	free(b->face_end);
	free(b->face_material);
	memset(b, 0, sizeof *b);
}

void *
bake_mesh_reserve(const struct mesh_builder *b, void *old, size_t used,
    size_t n, size_t *cap, size_t size, const char *what, struct bake_err *err)
{
	size_t max = b->src->params->max_items, want;
	void *p;

	if (n > max || used > max - n) {
		bake_fail(err, BAKE_ELIMIT, "'%s' has more than %zu %s",
		    b->src->name, max, what);
		return NULL;
	}
	if (old != NULL && used + n <= *cap)
		return old;
	/* exactly what is known to come, else twice as many */
	want = n > 1 ? used + n : used < 16 ? 32 : 2 * used;
	if (want > max)
		want = max;
	if ((p = bake_alloc(want, size, err)) == NULL)
		return NULL;
	if (used > 0)
		memcpy(p, old, used * size);
	free(old);
	*cap = want;
	return p;
}

void *
bake_mesh_grow(const struct mesh_builder *b, void *old, size_t used,
    size_t *cap, size_t size, const char *what, struct bake_err *err)
{
	if (used < *cap)
		return old;
	return bake_mesh_reserve(b, old, used, 1, cap, size, what, err);
}

enum bake_status
bake_mesh_add_position(
    struct mesh_builder *b, const double p[3], struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	void *a = bake_mesh_grow(b, m->positions, m->npositions,
	    &b->cap_positions, sizeof *m->positions, "positions", err);

	if (a == NULL)
		return err->code;
	m->positions = a;
	memcpy(m->positions[m->npositions++], p, sizeof *m->positions);
	return BAKE_OK;
}

enum bake_status
bake_mesh_add_uv(
    struct mesh_builder *b, const double uv[2], struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	void *a = bake_mesh_grow(
	    b, m->uvs, m->nuvs, &b->cap_uvs, sizeof *m->uvs, "UVs", err);

	if (a == NULL)
		return err->code;
	m->uvs = a;
	memcpy(m->uvs[m->nuvs++], uv, sizeof *m->uvs);
	return BAKE_OK;
}

enum bake_status
bake_mesh_add_normal(
    struct mesh_builder *b, const double n[3], struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	void *a = bake_mesh_grow(b, m->normals, m->nnormals, &b->cap_normals,
	    sizeof *m->normals, "normals", err);

	if (a == NULL)
		return err->code;
	m->normals = a;
	memcpy(m->normals[m->nnormals++], n, sizeof *m->normals);
	return BAKE_OK;
}

enum bake_status
bake_mesh_set_tangent(struct mesh_builder *b, size_t index, const double t[4],
    struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	size_t used = b->ntangents;

	if (index >= used) {
		void *a =
		    bake_mesh_reserve(b, m->tangents, used, index + 1 - used,
			&b->cap_tangents, sizeof *m->tangents, "tangents", err);

		if (a == NULL)
			return err->code;
		m->tangents = a;
		memset(
		    m->tangents[used], 0, (index - used) * sizeof *m->tangents);
		b->ntangents = index + 1;
	}
	memcpy(m->tangents[index], t, sizeof *m->tangents);
	return BAKE_OK;
}

enum bake_status
bake_mesh_reach_color(
    struct mesh_builder *b, size_t index, struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	void *a;

	while (b->ncolors <= index) {
		a = bake_mesh_grow(b, m->colors, b->ncolors, &b->cap_colors,
		    sizeof *m->colors, "colours", err);
		if (a == NULL)
			return err->code;
		m->colors = a;
		for (int k = 0; k < 4; k++)
			m->colors[b->ncolors][k] = 1.0f;
		b->ncolors++;
	}
	return BAKE_OK;
}

enum bake_status
bake_mesh_set_color(struct mesh_builder *b, size_t index, const float rgba[4],
    struct bake_err *err)
{
	enum bake_status rc = bake_mesh_reach_color(b, index, err);

	if (rc != BAKE_OK)
		return rc;
	for (int k = 0; k < 4; k++) {
		float c = rgba[k];

		/* the comparison is false for NaN */
		b->mesh->colors[index][k] =
		    c >= 0.0f ? c < 1.0f ? c : 1.0f : 0.0f;
	}
	return BAKE_OK;
}

enum bake_status
bake_mesh_add_corner(
    struct mesh_builder *b, struct bake_corner c, struct bake_err *err)
{
	void *a = bake_mesh_grow(b, b->corner, b->ncorners, &b->cap_corners,
	    sizeof *b->corner, "corners of faces", err);

	if (a == NULL)
		return err->code;
	b->corner = a;
	b->corner[b->ncorners++] = c;
	return BAKE_OK;
}

enum bake_status
bake_mesh_end_face(struct mesh_builder *b, int material, struct bake_err *err)
{
	size_t n = b->ncorners - b->face_start;
	void *a = bake_mesh_grow(b, b->face_end, b->nfaces, &b->cap_face_end,
	    sizeof *b->face_end, "faces", err);

	if (a == NULL)
		return err->code;
	b->face_end = a;
	a = bake_mesh_grow(b, b->face_material, b->nfaces,
	    &b->cap_face_material, sizeof *b->face_material, "faces", err);
	if (a == NULL)
		return err->code;
	b->face_material = a;
	b->face_end[b->nfaces] = (int)b->ncorners;
	b->face_material[b->nfaces++] = material;
	b->face_start = b->ncorners;
	if (n > b->max_face)
		b->max_face = n;
	return BAKE_OK;
}

enum bake_status
bake_mesh_add_material(struct mesh_builder *b, const char *name, size_t length,
    int *index, struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	struct bake_material *mat;
	void *a = bake_mesh_grow(b, m->materials, m->nmaterials,
	    &b->cap_materials, sizeof *m->materials, "materials", err);

	if (a == NULL)
		return err->code;
	m->materials = a;
	mat = &m->materials[m->nmaterials];
	memset(mat, 0, sizeof *mat);
	for (int k = 0; k < 4; k++)
		mat->color[k] = 1.0;
	mat->alpha_cutoff = 0.5;
	mat->texture.uv_matrix[0][0] = mat->texture.uv_matrix[1][1] = 1.0;
	if ((mat->name = bake_mesh_copy_text(name, length, err)) == NULL)
		return err->code;
	*index = (int)m->nmaterials++;
	return BAKE_OK;
}

enum bake_status
bake_mesh_begin_part(struct mesh_builder *b, int node, int mesh, int primitive,
    struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	void *a = bake_mesh_grow(b, m->parts, m->nparts, &b->cap_parts,
	    sizeof *m->parts, "parts", err);

	if (a == NULL)
		return err->code;
	m->parts = a;
	/* bake_mesh_finish turns faces into triangles and counts */
	m->parts[m->nparts++] = (struct bake_mesh_part){ node, mesh, primitive,
		m->npositions, 0, b->nfaces, 0 };
	return BAKE_OK;
}

enum bake_status
bake_mesh_add_file(
    struct mesh_builder *b, const char *path, struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	void *a = bake_mesh_grow(b, m->files, m->nfiles, &b->cap_files,
	    sizeof *m->files, "files", err);

	if (a == NULL)
		return err->code;
	m->files = a;
	if ((m->files[m->nfiles] =
		    bake_mesh_copy_text(path, strlen(path), err)) == NULL)
		return err->code;
	m->nfiles++;
	return BAKE_OK;
}
