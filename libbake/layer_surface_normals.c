/* Corner normals of a surface: the file's, or weighted by angles. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <math.h>
#include <stdlib.h>

#include "layer_surface_priv.h"
#include "mem.h"
#include "parallel.h"

static const double pi = 3.14159265358979323846;

/* Vertices are moved to multiples of 2^-16 texel: by at most 2^-17 an axis,
 * which changes a triangle's heights by less than 2^-15. */
static const double edge_on_texels = 1.0 / (1 << 14);

/* -- which side ---------------------------------------------------------- */

static int
facing_of(const struct bake_surface *s, const struct bake_corner t[3])
{
	double p[3][3], longest = 0, area;

	for (int k = 0; k < 3; k++)
		bake_surface_place(s, bake_surface_position(s, t[k]), p[k]);
	for (int k = 0; k < 3; k++) {
		const double *a = p[k], *b = p[k == 2 ? 0 : k + 1];
		const double dx = b[0] - a[0], dy = b[1] - a[1];
		const double length2 = dx * dx + dy * dy;

		longest = length2 > longest ? length2 : longest;
	}
	/* y grows downwards */
	area = (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]) -
	       (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]);
	if (!(fabs(area) > edge_on_texels * sqrt(longest)))
		return 0;
	return area > 0 ? 1 : -1;
}

/* -- angles -------------------------------------------------------------- */

/* What a triangle adds at its corners: angle[k] * n. */
struct share {
	double n[3], angle[3];
};

static struct share
share_of(const struct bake_surface *s, const struct bake_corner t[3])
{
	const double *a = bake_surface_position(s, t[0]);
	const double *b = bake_surface_position(s, t[1]);
	const double *c = bake_surface_position(s, t[2]);
	struct share share = { { 0 }, { 0 } };
	double e[3], f[3], g[3], back[3], n[3], length;

	for (int k = 0; k < 3; k++) {
		e[k] = b[k] - a[k];
		f[k] = c[k] - a[k];
		g[k] = c[k] - b[k];
		back[k] = -e[k];
	}
	n[0] = e[1] * f[2] - e[2] * f[1];
	n[1] = e[2] * f[0] - e[0] * f[2];
	n[2] = e[0] * f[1] - e[1] * f[0];
	length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	if (!(length > 0) || !isfinite(length))
		return share;
	for (int k = 0; k < 3; k++)
		share.n[k] = n[k] / length;
	share.angle[0] = bake_angle_rad(e, f);
	share.angle[1] = bake_angle_rad(g, back);
	share.angle[2] = pi - share.angle[0] - share.angle[1];
	return share;
}

/*
 * Sums around points, in the triangles' order. Shares are found by all threads,
 * a chunk at a time, and added by one: adding takes a tenth of the time. Chunks
 * are large, as at the end of each all threads wait for the slowest.
 */
static enum bake_status
add_shares(const struct bake_surface *s, double (*sum)[3], int nthreads,
    struct bake_err *err)
{
	enum { CHUNK = 1 << 17 };
	const struct bake_mesh *m = s->mesh;
	const ptrdiff_t n = (ptrdiff_t)m->ntriangles;
	struct share *share =
	    bake_alloc(n < CHUNK ? (size_t)n : CHUNK, sizeof *share, err);

	if (share == NULL)
		return BAKE_ENOMEM;
	for (ptrdiff_t first = 0; first < n; first += CHUNK) {
		const struct bake_corner(*t)[3] = m->triangles + first;
		const int count = (int)(n - first < CHUNK ? n - first : CHUNK);

#pragma omp parallel for schedule(dynamic, 2048) num_threads(nthreads)
		for (int i = 0; i < count; i++)
			share[i] = share_of(s, t[i]);
		for (int i = 0; i < count; i++)
			for (int c = 0; c < 3; c++) {
				double *to =
				    sum[bake_surface_point(s, t[i][c])];

				for (int k = 0; k < 3; k++)
					to[k] +=
					    share[i].angle[c] * share[i].n[k];
			}
	}
	free(share);
	return BAKE_OK;
}

/* -- tables -------------------------------------------------------------- */

/* In the axes of the view, of unit length, or 0. */
static void
put_normal(const struct bake_surface *s, const double from[3], float to[3])
{
	double n[3], length;

	bake_axes_project(&s->axes, from, n);
	length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int k = 0; k < 3; k++)
		to[k] = length > 0 ? (float)(n[k] / length) : 0;
}

static bool
has_file_normal(const struct bake_mesh *m, struct bake_corner c)
{
	const double *n = c.vn >= 0 ? m->normals[c.vn] : NULL;

	return n != NULL && (n[0] != 0 || n[1] != 0 || n[2] != 0);
}

/* The corners' indices: into the file's normals, then into the points'. */
static size_t
index_corners(struct bake_surface *s, size_t nfile, int nthreads)
{
	const struct bake_mesh *m = s->mesh;
	const ptrdiff_t n = (ptrdiff_t)m->ntriangles;
	size_t missing = 0;

#pragma omp parallel for schedule(dynamic, 8192) num_threads(nthreads)         \
    reduction(+ : missing)
	for (ptrdiff_t i = 0; i < n; i++) {
		const struct bake_corner *t = m->triangles[i];
		struct surface_triangle *to = &s->triangles[i];

		to->facing = facing_of(s, t);
		for (int k = 0; k < 3; k++) {
			if (nfile > 0 && has_file_normal(m, t[k])) {
				to->normal[k] = t[k].vn;
				continue;
			}
			to->normal[k] =
			    (int)nfile + bake_surface_point(s, t[k]);
			missing++;
		}
	}
	return missing;
}

static enum bake_status
take_corners(
    struct bake_surface *s, size_t nfile, int nthreads, struct bake_err *err)
{
	const struct bake_mesh *m = s->mesh;
	const size_t npoints =
	    index_corners(s, nfile, nthreads) > 0 ? m->npositions : 0;
	double(*sum)[3] = NULL;
	enum bake_status rc = BAKE_ENOMEM;

	if (npoints > (size_t)INT_MAX - nfile)
		return bake_fail(err, BAKE_ENOMEM,
		    "%zu and %zu normals are more than can be counted", nfile,
		    npoints);
	s->normals = bake_alloc(nfile + npoints, sizeof *s->normals, err);
	sum = bake_zalloc(npoints, sizeof *sum, err);
	if (s->normals == NULL || sum == NULL)
		goto out;
	rc = BAKE_OK;
	if (npoints > 0)
		rc = add_shares(s, sum, nthreads, err);
#pragma omp parallel for schedule(static) num_threads(nthreads)
	for (size_t i = 0; i < nfile + npoints; i++)
		put_normal(s, i < nfile ? m->normals[i] : sum[i - nfile],
		    s->normals[i]);
out:
	free(sum);
	return rc;
}

static enum bake_status
take_flat(struct bake_surface *s, int nthreads, struct bake_err *err)
{
	const ptrdiff_t n = (ptrdiff_t)s->mesh->ntriangles;

	s->normals = bake_alloc((size_t)n, sizeof *s->normals, err);
	if (s->normals == NULL)
		return BAKE_ENOMEM;
#pragma omp parallel for schedule(static) num_threads(nthreads)
	for (ptrdiff_t i = 0; i < n; i++) {
		struct surface_triangle *to = &s->triangles[i];
		double flat[3];

		to->facing = facing_of(s, s->mesh->triangles[i]);
		bake_surface_flat_normal(s, (size_t)i, flat);
		for (int k = 0; k < 3; k++) {
			to->normal[k] = (int)i;
			s->normals[i][k] = (float)flat[k];
		}
	}
	return BAKE_OK;
}

enum bake_status
bake_surface_take_normals(struct bake_surface *s,
    enum bake_normal_source source, int nthreads, struct bake_err *err)
{
	const size_t nfile =
	    source == BAKE_NORMALS_COMPUTED ? 0 : s->mesh->nnormals;

	nthreads = bake_threads(nthreads);
	s->triangles =
	    bake_alloc(s->mesh->ntriangles, sizeof *s->triangles, err);
	if (s->triangles == NULL)
		return BAKE_ENOMEM;
	return s->flat ? take_flat(s, nthreads, err)
		       : take_corners(s, nfile, nthreads, err);
}
