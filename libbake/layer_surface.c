/* What a surface is like where a ray crosses it: normal and colour. */
/* SPDX-License-Identifier: MIT */
#include "layer_surface.h"

#include <math.h>
#include <stdlib.h>

#include "layer_surface_priv.h"
#include "mem.h"

/* Shorter than this a sum of unit vectors in float is but rounding. */
static const double nothing = 1e-6;

void
bake_surface_place(const struct bake_surface *s, const double p[3], double q[3])
{
	bake_axes_project(&s->axes, p, q);
	q[0] = (q[0] - s->view.x0) * s->scale[0];
	q[1] = (s->view.y1 - q[1]) * s->scale[1];
	q[2] *= s->scale[2];
}

bool
bake_surface_flat_normal(
    const struct bake_surface *s, size_t triangle, double n[3])
{
	const struct bake_corner *t = s->mesh->triangles[triangle];
	double p[3][3], length;

	for (int k = 0; k < 3; k++)
		bake_axes_project(
		    &s->axes, bake_surface_position(s, t[k]), p[k]);
	for (int k = 0; k < 3; k++) {
		p[1][k] -= p[0][k];
		p[2][k] -= p[0][k];
	}
	n[0] = p[1][1] * p[2][2] - p[1][2] * p[2][1];
	n[1] = p[1][2] * p[2][0] - p[1][0] * p[2][2];
	n[2] = p[1][0] * p[2][1] - p[1][1] * p[2][0];
	length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	if (!(length > 0) || !isfinite(length)) {
		n[0] = n[1] = n[2] = 0;
		return false;
	}
	for (int k = 0; k < 3; k++)
		n[k] /= length;
	return true;
}

enum bake_status
bake_surface_open(struct bake_surface **surface, const struct bake_mesh *mesh,
    const struct bake_weld *weld, const struct bake_abuffer *ab,
    const struct bake_view *view, const struct bake_surface_params *params,
    struct bake_err *err)
{
	struct bake_surface *s;
	enum bake_status rc;

	*surface = NULL;
	if (mesh->ntriangles == 0)
		return bake_fail(err, BAKE_EDATA, "the mesh has no triangles");
	if (weld != NULL && weld->npositions != mesh->npositions)
		return bake_fail(err, BAKE_EINVAL,
		    "a weld of %zu positions, the mesh has %zu",
		    weld->npositions, mesh->npositions);
	if (!params->flat && params->normals == BAKE_NORMALS_FILE &&
	    mesh->nnormals == 0)
		return bake_fail(
		    err, BAKE_EDATA, "the mesh has no normals of its own");
	if ((s = bake_zalloc(1, sizeof *s, err)) == NULL)
		return BAKE_ENOMEM;
	s->mesh = mesh;
	s->weld = weld;
	s->ab = ab;
	s->view = *view;
	s->axes = bake_axis_axes(view->axis);
	s->scale[0] = view->width / (view->x1 - view->x0);
	s->scale[1] = view->height / (view->y1 - view->y0);
	s->scale[2] = sqrt(s->scale[0] * s->scale[1]);
	s->flat = params->flat;
	s->vertex_colors = params->vertex_colors;
	rc = bake_surface_take_normals(
	    s, params->normals, params->nthreads, err);
	if (rc == BAKE_OK)
		rc = bake_surface_take_materials(s, params, err);
	if (rc != BAKE_OK) {
		bake_surface_close(s);
		s = NULL;
	}
	*surface = s;
	return rc;
}

void
bake_surface_close(struct bake_surface *s)
{
	if (s == NULL)
		return;
	bake_surface_free_materials(s);
	free(s->triangles);
	free(s->normals);
	free(s);
}

size_t
bake_surface_missing_uvs(const struct bake_surface *s)
{
	return s->missing_uvs;
}

/* n to unit length; false where it is too short. */
static inline bool
normalize(double n[3])
{
	const double length2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
	double scale;

	if (!(length2 >= nothing * nothing))
		return false;
	scale = 1 / sqrt(length2);
	for (int k = 0; k < 3; k++)
		n[k] *= scale;
	return true;
}

/* A unit normal that is on the wrong side: into the plane of the picture. */
static void
flatten(const struct bake_surface *s, const struct bake_crossing *crossing,
    double turn, double n[3])
{
	double length = sqrt(n[0] * n[0] + n[1] * n[1]);

	if (!(length >= nothing)) {
		bake_surface_flat_normal(s, crossing->triangle, n);
		n[0] *= turn;
		n[1] *= turn;
		length = sqrt(n[0] * n[0] + n[1] * n[1]);
	}
	if (length > 0) {
		n[0] /= length;
		n[1] /= length;
		n[2] = 0;
	} else {
		n[2] = crossing->entering ? 1 : -1;
	}
}

void
bake_surface_normal(const struct bake_surface *s,
    const struct bake_crossing *crossing, int x, int y, float normal[3])
{
	const struct surface_triangle *t = &s->triangles[crossing->triangle];
	const double turn =
	    t->facing != 0 && (t->facing > 0) != crossing->entering ? -1 : 1;
	const float *a = s->normals[t->normal[0]], *b, *c;
	double w[3], n[3];

	if (s->flat) {
		for (int k = 0; k < 3; k++)
			n[k] = turn * a[k];
	} else {
		b = s->normals[t->normal[1]];
		c = s->normals[t->normal[2]];
		bake_abuffer_weights(s->ab, crossing, x, y, w);
		for (int k = 0; k < 3; k++)
			n[k] = turn * (w[0] * a[k] + w[1] * b[k] + w[2] * c[k]);
	}
	if (!normalize(n)) {
		bake_surface_flat_normal(s, crossing->triangle, n);
		for (int k = 0; k < 3; k++)
			n[k] *= turn;
	}
	if (crossing->entering ? !(n[2] > 0) : !(n[2] < 0))
		flatten(s, crossing, turn, n);
	for (int k = 0; k < 3; k++)
		normal[k] = (float)n[k];
}
