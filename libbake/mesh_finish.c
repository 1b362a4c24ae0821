/* A mesh that is read: checks of all values, and triangles of its faces. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh_priv.h"

static bool
all_finite(const double *x, int n)
{
	for (int k = 0; k < n; k++)
		if (!isfinite(x[k]))
			return false;
	return true;
}

/* x to unit length; all 0, and false, where it has no direction. */
static bool
normalize(double x[3])
{
	double scale, length;

	scale = fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
	if (!all_finite(x, 3) || !(scale > 0.0)) {
		x[0] = x[1] = x[2] = 0.0;
		return false;
	}
	for (int k = 0; k < 3; k++)
		x[k] /= scale;
	length = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
	for (int k = 0; k < 3; k++)
		x[k] /= length;
	return true;
}

static enum bake_status
check_values(struct mesh_builder *b, struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;

	for (size_t i = 0; i < m->npositions; i++)
		if (!all_finite(m->positions[i], 3))
			return bake_fail(err, BAKE_EDATA,
			    "'%s': position %zu is not finite", b->src->name,
			    i);
	for (size_t i = 0; i < m->nuvs; i++)
		if (!all_finite(m->uvs[i], 2))
			return bake_fail(err, BAKE_EDATA,
			    "'%s': UV %zu is not finite", b->src->name, i);
	for (size_t i = 0; i < m->nnormals; i++)
		m->dropped.bad_normals += !normalize(m->normals[i]);
	for (size_t i = 0; m->tangents != NULL && i < m->nnormals; i++) {
		double *t = m->tangents[i];
		bool absent = t[0] == 0.0 && t[1] == 0.0 && t[2] == 0.0;

		if (!normalize(t) || !(t[3] == t[3]) || t[3] == 0.0) {
			m->dropped.bad_tangents += !absent;
			memset(t, 0, sizeof m->tangents[i]);
		} else {
			t[3] = t[3] > 0.0 ? 1.0 : -1.0;
		}
	}
	return BAKE_OK;
}

static enum bake_status
check_index(const struct mesh_builder *b, int index, int lowest, size_t n,
    const char *what, struct bake_err *err)
{
	if (index >= lowest && (index < 0 || (size_t)index < n))
		return BAKE_OK;
	return bake_fail(err, BAKE_EDATA,
	    "'%s': a face uses %s %d, the file has %zu", b->src->name, what,
	    index, n);
}

static enum bake_status
check_indices(const struct mesh_builder *b, struct bake_err *err)
{
	const struct bake_mesh *m = b->mesh;
	enum bake_status rc;

	for (size_t i = 0; i < b->ncorners; i++) {
		const struct bake_corner *c = &b->corner[i];

		if ((rc = check_index(b, c->v, 0, m->npositions, "position",
			 err)) != BAKE_OK ||
		    (rc = check_index(b, c->vt, -1, m->nuvs, "UV", err)) !=
			BAKE_OK ||
		    (rc = check_index(
			 b, c->vn, -1, m->nnormals, "normal", err)) != BAKE_OK)
			return rc;
	}
	for (size_t i = 0; i < b->nfaces; i++)
		if ((rc = check_index(b, b->face_material[i], -1, m->nmaterials,
			 "material", err)) != BAKE_OK)
			return rc;
	return BAKE_OK;
}

/* Scratch for one polygon. */
struct polygon {
	double (*points)[3];
	int (*cut)[3];
};

static void
polygon_free(struct polygon *p)
{
	free(p->points);
	free(p->cut);
}

/* Leave out corners with the same position as the one before. */
static int
drop_repeated(struct bake_corner *c, int n)
{
	int kept = 0;

	for (int i = 0; i < n; i++)
		if (kept == 0 || c[i].v != c[kept - 1].v)
			c[kept++] = c[i];
	while (kept > 1 && c[kept - 1].v == c[0].v)
		kept--;
	return kept;
}

static void
emit(struct mesh_builder *b, const struct bake_corner *t0,
    const struct bake_corner *t1, const struct bake_corner *t2, int material)
{
	struct bake_mesh *m = b->mesh;
	struct bake_corner t[3] = { *t0, *t1, *t2 };

	if (t[0].v == t[1].v || t[1].v == t[2].v || t[2].v == t[0].v) {
		m->dropped.degenerate_faces++;
		return;
	}
	memcpy(m->triangles[m->ntriangles], t, sizeof t);
	m->material_of[m->ntriangles++] = material;
}

static enum bake_status
emit_face(struct mesh_builder *b, struct polygon *p, struct bake_corner *c,
    int n, int material, struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	enum bake_status rc;
	bool rough;

	n = drop_repeated(c, n);
	if (n < 3) {
		m->dropped.degenerate_faces++;
		return BAKE_OK;
	}
	if (n == 3) {
		emit(b, &c[0], &c[1], &c[2], material);
		return BAKE_OK;
	}
	for (int i = 0; i < n; i++)
		memcpy(p->points[i], m->positions[c[i].v], sizeof *p->points);
	rc = bake_polygon_triangulate(
	    (const double(*)[3])p->points, n, p->cut, &rough, err);
	if (rc != BAKE_OK)
		return rc;
	m->dropped.rough_faces += rough;
	for (int i = 0; i < n - 2; i++)
		emit(b, &c[p->cut[i][0]], &c[p->cut[i][1]], &c[p->cut[i][2]],
		    material);
	return BAKE_OK;
}

/* The most triangles that the faces can make. */
static size_t
count_cuts(const struct mesh_builder *b)
{
	size_t n = 0, at = 0;

	for (size_t f = 0; f < b->nfaces; f++) {
		size_t end = (size_t)b->face_end[f];

		n += end - at > 2 ? end - at - 2 : 0;
		at = end;
	}
	return n;
}

/*
 * Faces become triangles. Where none has more than 3 corners, the corners'
 * own array becomes the triangles', in place: a face is read before it is
 * written.
 */
static enum bake_status
make_triangles(struct mesh_builder *b, struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	struct polygon p = { NULL, NULL };
	struct bake_corner *corner = b->corner;
	size_t at = 0, part = 0, max_triangles = count_cuts(b);
	enum bake_status rc = BAKE_OK;

	m->material_of = bake_alloc(max_triangles, sizeof *m->material_of, err);
	if (m->material_of == NULL)
		return BAKE_ENOMEM;
	if (b->max_face <= 3) {
		m->triangles = (struct bake_corner(*)[3])(void *)b->corner;
		b->corner = NULL;
	} else {
		m->triangles =
		    bake_alloc(max_triangles, sizeof *m->triangles, err);
		p.points = bake_alloc(b->max_face, sizeof *p.points, err);
		p.cut = bake_alloc(b->max_face, sizeof *p.cut, err);
		if (m->triangles == NULL || p.points == NULL || p.cut == NULL)
			rc = BAKE_ENOMEM;
	}
	for (size_t f = 0; rc == BAKE_OK && f < b->nfaces; f++) {
		size_t end = (size_t)b->face_end[f];

		for (; part < m->nparts && m->parts[part].first_triangle == f;
		     part++)
			m->parts[part].first_triangle = m->ntriangles;
		rc = emit_face(b, &p, corner + at, (int)(end - at),
		    b->face_material[f], err);
		at = end;
	}
	for (; part < m->nparts; part++)
		m->parts[part].first_triangle = m->ntriangles;
	polygon_free(&p);
	return rc;
}

/* Whether the triangle's height is at most 1e-12 of its longest edge. */
static bool
is_flat(const struct bake_mesh *m, const struct bake_corner t[3])
{
	const double *a = m->positions[t[0].v], *b = m->positions[t[1].v],
		     *c = m->positions[t[2].v];
	double e[3], f[3], longest = 0.0, n2 = 0.0;

	for (int k = 0; k < 3; k++) {
		e[k] = b[k] - a[k];
		f[k] = c[k] - a[k];
		longest = fmax(longest, fmax(fabs(e[k]), fabs(f[k])));
	}
	if (!(longest > 0.0))
		return true;
	for (int k = 0; k < 3; k++) {
		e[k] /= longest;
		f[k] /= longest;
	}
	longest = 0.0;
	for (int k = 0; k < 3; k++) {
		int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
		double n = e[k1] * f[k2] - e[k2] * f[k1];

		n2 += n * n;
	}
	for (int edge = 0; edge < 3; edge++) {
		double l2 = 0.0;

		for (int k = 0; k < 3; k++) {
			double d = edge == 0   ? e[k]
				   : edge == 1 ? f[k]
					       : f[k] - e[k];

			l2 += d * d;
		}
		longest = fmax(longest, l2);
	}
	return n2 <= 1e-24 * longest * longest;
}

static void
count_triangles(struct bake_mesh *m)
{
	for (size_t i = 0; i < m->ntriangles; i++) {
		const struct bake_corner *t = m->triangles[i];

		m->dropped.flat_triangles += is_flat(m, t);
		m->dropped.missing_uvs +=
		    t[0].vt < 0 || t[1].vt < 0 || t[2].vt < 0;
		m->dropped.missing_normals +=
		    t[0].vn < 0 || t[1].vn < 0 || t[2].vn < 0;
	}
	for (size_t i = 0; i < m->nparts; i++) {
		bool last = i + 1 == m->nparts;

		m->parts[i].npositions =
		    (last ? m->npositions : m->parts[i + 1].first_position) -
		    m->parts[i].first_position;
		m->parts[i].ntriangles =
		    (last ? m->ntriangles : m->parts[i + 1].first_triangle) -
		    m->parts[i].first_triangle;
	}
}

enum bake_status
bake_mesh_finish(struct mesh_builder *b, struct bake_err *err)
{
	static const double no_tangent[4] = { 0.0, 0.0, 0.0, 0.0 };
	struct bake_mesh *m = b->mesh;
	enum bake_status rc;

	if (b->nfaces == 0)
		return bake_fail(
		    err, BAKE_EDATA, "'%s' has no faces", b->src->name);
	if (b->ncorners > INT_MAX)
		return bake_fail(err, BAKE_ELIMIT,
		    "'%s' has more than %d corners of faces", b->src->name,
		    INT_MAX);
	if (b->ncorners == 0)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' has no faces but degenerate ones, %zu of them",
		    b->src->name, b->nfaces);
	if (m->colors != NULL && m->npositions > 0 &&
	    (rc = bake_mesh_reach_color(b, m->npositions - 1, err)) != BAKE_OK)
		return rc;
	if (m->tangents != NULL && b->ntangents < m->nnormals &&
	    (rc = bake_mesh_set_tangent(b, m->nnormals - 1, no_tangent, err)) !=
		BAKE_OK)
		return rc;
	if ((rc = check_values(b, err)) != BAKE_OK ||
	    (rc = check_indices(b, err)) != BAKE_OK ||
	    (rc = make_triangles(b, err)) != BAKE_OK)
		return rc;
	if (m->ntriangles == 0)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' has no faces but degenerate ones, %zu of them",
		    b->src->name, m->dropped.degenerate_faces);
	count_triangles(m);
	return BAKE_OK;
}
