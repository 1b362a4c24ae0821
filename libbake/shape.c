/* Built-in shapes: their grids made into one welded mesh. */
/* SPDX-License-Identifier: MIT */
#include "shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "shape_priv.h"

enum { MAX_DETAIL = 1024, DEFAULT_DETAIL = 16 };

static const char *const names[] = { "plane", "cube", "sphere", "cylinder",
	"torus", "teapot" };
enum { NSHAPES = sizeof names / sizeof *names };

const char *
bake_shape_name(enum bake_shape shape)
{
	return (unsigned)shape < NSHAPES ? names[shape] : NULL;
}

bool
bake_shape_from_name(const char *name, enum bake_shape *shape)
{
	for (int i = 0; i < NSHAPES; i++)
		if (strcmp(name, names[i]) == 0) {
			*shape = (enum bake_shape)i;
			return true;
		}
	return false;
}

static bool
is_pole(const struct bake_shape_grid *g, int k)
{
	return (k == 0 && g->pole[0]) || (k == g->nv && g->pole[1]);
}

/* Points of row k. */
static int
row_length(const struct bake_shape_grid *g, int k)
{
	return is_pole(g, k) ? g->nu : g->nu + 1;
}

static size_t
count_points(const struct bake_shape_grid *g)
{
	return (size_t)(g->nv - 1) * (size_t)(g->nu + 1) +
	       (size_t)row_length(g, 0) + (size_t)row_length(g, g->nv);
}

static size_t
count_triangles(const struct bake_shape_grid *g)
{
	return (size_t)(2 * g->nv - g->pole[0] - g->pole[1]) * (size_t)g->nu;
}

static void
cross(const double a[3], const double b[3], double c[3])
{
	c[0] = a[1] * b[2] - a[2] * b[1];
	c[1] = a[2] * b[0] - a[0] * b[2];
	c[2] = a[0] * b[1] - a[1] * b[0];
}

static void
normalize(double v[3])
{
	double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);

	for (int c = 0; c < 3; c++)
		v[c] /= length;
}

/* Every du x dv points outwards: all frames are right-handed. */
static void
set_point(struct bake_mesh *m, size_t i, const struct bake_shape_point *at)
{
	double *tangent = m->tangents[i];

	memcpy(m->positions[i], at->p, sizeof at->p);
	memcpy(m->uvs[i], at->uv, sizeof at->uv);
	memcpy(tangent, at->du, sizeof at->du);
	normalize(tangent);
	tangent[3] = 1;
	cross(tangent, at->dv, m->normals[i]);
	normalize(m->normals[i]);
}

static void
set_points(struct bake_mesh *m, size_t first, const struct bake_shape_grid *g)
{
	for (int k = 0; k <= g->nv; k++) {
		bool pole = is_pole(g, k);
		int n = row_length(g, k);

		for (int i = 0; i < n; i++) {
			struct bake_shape_point at, tip;

			g->point(g, pole ? 2 * i + 1 : 2 * i, k, &at);
			if (pole) {
				g->point(g, 0, k, &tip);
				memcpy(at.p, tip.p, sizeof at.p);
			}
			set_point(m, first + (size_t)i, &at);
		}
		first += (size_t)n;
	}
}

static void
set_triangle(struct bake_mesh *m, size_t t, size_t a, size_t b, size_t c)
{
	const size_t at[3] = { a, b, c };

	for (int k = 0; k < 3; k++) {
		int i = (int)at[k];

		m->triangles[t][k] = (struct bake_corner){ i, i, i };
	}
}

static void
set_triangles(struct bake_mesh *m, size_t first, size_t t,
    const struct bake_shape_grid *g)
{
	for (int k = 0; k < g->nv; k++) {
		size_t n = (size_t)row_length(g, k), a = first, d = first + n;

		for (int i = 0; i < g->nu; i++, a++, d++) {
			if (!is_pole(g, k))
				set_triangle(m, t++, a, a + 1,
				    is_pole(g, k + 1) ? d : d + 1);
			if (!is_pole(g, k + 1))
				set_triangle(m, t++, a, d + 1, d);
		}
		first += n;
	}
}

/* Each point of space gets one position. */
static enum bake_status
weld(struct bake_mesh *m, struct bake_err *err)
{
	struct bake_weld w = BAKE_WELD_INIT;
	enum bake_status rc;
	size_t n = 0;

	if ((rc = bake_mesh_weld(m, 0, &w, err)) != BAKE_OK)
		return rc;
	/* the first of its point comes before all others, so it has its new
	 * place already */
	for (size_t i = 0; i < m->npositions; i++) {
		size_t first = (size_t)w.first[i];

		if (first < i) {
			w.first[i] = w.first[first];
			continue;
		}
		memcpy(m->positions[n], m->positions[i], sizeof *m->positions);
		w.first[i] = (int)n++;
	}
	m->npositions = n;
	for (size_t t = 0; t < m->ntriangles; t++)
		for (int k = 0; k < 3; k++)
			m->triangles[t][k].v = w.first[m->triangles[t][k].v];
	bake_weld_free(&w);
	return BAKE_OK;
}

static enum bake_status
make(const struct bake_shape_grid *grids, int n, struct bake_mesh *m,
    struct bake_err *err)
{
	size_t npoints = 0, ntriangles = 0;
	enum bake_status rc;

	for (int i = 0; i < n; i++) {
		npoints += count_points(&grids[i]);
		ntriangles += count_triangles(&grids[i]);
	}
	if ((rc = bake_mesh_alloc(
		 m, npoints, npoints, npoints, ntriangles, err)) != BAKE_OK)
		return rc;
	m->tangents = bake_alloc(npoints, sizeof *m->tangents, err);
	if (m->tangents == NULL)
		return err->code;
	if ((m->parts = bake_zalloc(1, sizeof *m->parts, err)) == NULL)
		return err->code;
	npoints = ntriangles = 0;
	for (int i = 0; i < n; i++) {
		set_points(m, npoints, &grids[i]);
		set_triangles(m, npoints, ntriangles, &grids[i]);
		npoints += count_points(&grids[i]);
		ntriangles += count_triangles(&grids[i]);
	}
	if ((rc = weld(m, err)) != BAKE_OK)
		return rc;
	m->nparts = 1;
	m->parts[0].npositions = m->npositions;
	m->parts[0].ntriangles = m->ntriangles;
	m->y_up = true;
	return BAKE_OK;
}

enum bake_status
bake_shape_make(enum bake_shape shape, int detail, struct bake_mesh *mesh,
    struct bake_err *err)
{
	struct bake_shape_grid grids[BAKE_SHAPE_MAX_GRIDS];
	enum bake_status rc;
	int n;

	if ((unsigned)shape >= NSHAPES)
		return bake_fail(err, BAKE_EINVAL,
		    "shape %d is none of the %d, 0 to %d", (int)shape, NSHAPES,
		    NSHAPES - 1);
	if (detail < 0 || detail > MAX_DETAIL)
		return bake_fail(err, BAKE_EINVAL,
		    "detail %d of a shape: it is 1 to %d, or 0 for %d", detail,
		    MAX_DETAIL, DEFAULT_DETAIL);
	n = bake_shape_grids(
	    shape, detail == 0 ? DEFAULT_DETAIL : detail, grids);
	if ((rc = make(grids, n, mesh, err)) != BAKE_OK)
		bake_mesh_free(mesh);
	return rc;
}
