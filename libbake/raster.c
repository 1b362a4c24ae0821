/* The rasteriser: a mesh projected, cut and put into tiles. */
/* SPDX-License-Identifier: MIT */
#include "raster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "parallel.h"
#include "raster_priv.h"

/* Where a position lies; a triangle all of whose corners share one of the
 * first five is not seen. */
enum {
	LEFT = 1,
	RIGHT = 2,
	ABOVE = 4,
	BELOW = 8,
	NEARER = 16,
	FAR_OUT = 32, /* outside the guard band, or nearly */
	UNUSABLE = 64 /* too far for floats */
};
enum { UNSEEN = LEFT | RIGHT | ABOVE | BELOW | NEARER };
/* Triangles are made into pieces by this many at once. */
enum { CHUNK = 4096 };

static const double max_length = 1e30;

struct point {
	int32_t x, y;
};

/* Everything that open needs and close does not. */
struct work {
	struct bake_raster *r;
	struct point *points;
	unsigned char *where;
	size_t nchunks, *first; /* [nchunks + 1] piece of a chunk */
};

/* Only what rounding makes of cut edges at absurd scales is out of range. */
static int32_t
snap(double samples)
{
	const double most = 2 * RASTER_GUARD;

	return (int32_t)floor(
	    RASTER_SUB * fmax(-most, fmin(most, samples)) + 0.5);
}

/* The formula of bake_camera_project, in samples. */
static struct point
project(const struct bake_raster *r, const double q[3], int n)
{
	const struct bake_camera_basis *b = &r->basis;
	double scale = b->orthographic ? b->pixels : b->pixels / q[2];

	return (struct point){ snap(n * (b->cx + scale * q[0])),
		snap(n * (b->cy - scale * q[1])) };
}

static unsigned char
locate(const struct bake_raster *r, const double q[3])
{
	const double h = r->basis.orthographic ? 1 : q[2];
	/* a sample less, so that no rounding has a corner cut off that other
	 * triangles keep */
	const double g = (RASTER_GUARD - 1) * h;
	double left = r->scale * q[0] + r->cx * h;
	double right = (r->width - r->cx) * h - r->scale * q[0];
	double above = r->cy * h - r->scale * q[1];
	double below = (r->height - r->cy) * h + r->scale * q[1];
	int where = 0;

	for (int i = 0; i < 3; i++)
		if (!(fabs(q[i]) <= max_length))
			return UNUSABLE;
	where |= left < 0 ? LEFT : 0;
	where |= right < 0 ? RIGHT : 0;
	where |= above < 0 ? ABOVE : 0;
	where |= below < 0 ? BELOW : 0;
	where |= q[2] < r->basis.near ? NEARER : 0;
	where |=
	    left < -g || right < -g || above < -g || below < -g ? FAR_OUT : 0;
	return (unsigned char)where;
}

static void
see(struct work *w, int samples, size_t v)
{
	struct bake_raster *r = w->r;
	const struct bake_camera_basis *b = &r->basis;
	const double *p = r->mesh->positions[v];
	double *q = r->q[v], from[3];

	for (int i = 0; i < 3; i++)
		from[i] = p[i] - b->eye[i];
	q[0] = from[0] * b->x[0] + from[1] * b->x[1] + from[2] * b->x[2];
	q[1] = from[0] * b->y[0] + from[1] * b->y[1] + from[2] * b->y[2];
	q[2] = -(from[0] * b->z[0] + from[1] * b->z[1] + from[2] * b->z[2]);
	w->where[v] = locate(r, q);
	w->points[v] = (struct point){ 0, 0 };
	if ((w->where[v] & (NEARER | FAR_OUT | UNUSABLE)) == 0)
		w->points[v] = project(r, q, samples);
}

void
bake_raster_edges(const struct raster_piece *p, struct raster_edge edges[3])
{
	for (int i = 0; i < 3; i++) {
		int k = (i + 1) % 3;
		int64_t dx = (int64_t)p->x[k] - p->x[i];
		int64_t dy = (int64_t)p->y[k] - p->y[i];
		bool top_left = dy < 0 || (dy == 0 && dx > 0);

		edges[i].a = -dy * RASTER_SUB;
		edges[i].b = dx * RASTER_SUB;
		edges[i].c = dx * (RASTER_SUB / 2 - p->y[i]) -
			     dy * (RASTER_SUB / 2 - p->x[i]) - !top_left;
	}
}

static int
int_min(int a, int b)
{
	return a < b ? a : b;
}

static int
int_max(int a, int b)
{
	return a > b ? a : b;
}

/* The first sample at or after a position, and the last at or before it. */
static int
first_sample(int32_t at)
{
	return (at + (RASTER_SUB / 2 - 1)) >> 8;
}

static int
last_sample(int32_t at)
{
	return (at - RASTER_SUB / 2) >> 8;
}

struct raster_box
bake_raster_bounds(const struct bake_raster *r, const struct raster_piece *p)
{
	int x0 = int_min(p->x[0], int_min(p->x[1], p->x[2]));
	int x1 = int_max(p->x[0], int_max(p->x[1], p->x[2]));
	int y0 = int_min(p->y[0], int_min(p->y[1], p->y[2]));
	int y1 = int_max(p->y[0], int_max(p->y[1], p->y[2]));

	return (struct raster_box){ int_max(first_sample(x0), 0),
		int_max(first_sample(y0), 0),
		int_min(last_sample(x1), r->width - 1),
		int_min(last_sample(y1), r->height - 1) };
}

/* Turned clockwise; false where it is not seen. */
static bool
make_piece(const struct bake_raster *r, const struct point corner[3],
    size_t triangle, struct raster_piece *piece)
{
	int64_t area = ((int64_t)corner[1].x - corner[0].x) *
			   ((int64_t)corner[2].y - corner[0].y) -
		       ((int64_t)corner[1].y - corner[0].y) *
			   ((int64_t)corner[2].x - corner[0].x);
	/* y goes down: what is counterclockwise has a negative area */
	bool back = area > 0;
	struct raster_box box;

	if (area == 0 || (back && r->cull == BAKE_CULL_BACK) ||
	    (!back && r->cull == BAKE_CULL_FRONT))
		return false;
	for (int i = 0; i < 3; i++) {
		const struct point *c = &corner[back ? i : 2 - i];

		piece->x[i] = c->x;
		piece->y[i] = c->y;
	}
	piece->triangle = back ? ~(int)triangle : (int)triangle;
	box = bake_raster_bounds(r, piece);
	return box.x0 <= box.x1 && box.y0 <= box.y1;
}

/* The pieces of a triangle: how many. */
static int
make_pieces(const struct work *w, int samples, size_t triangle,
    struct raster_piece *pieces)
{
	const struct bake_raster *r = w->r;
	const struct bake_corner *t = r->mesh->triangles[triangle];
	double q[3][3], cut[RASTER_MAX_PIECES][3][3];
	struct point corner[3];
	int all = UNSEEN, any = 0, n = 0, ncut;

	for (int k = 0; k < 3; k++) {
		all &= w->where[t[k].v];
		any |= w->where[t[k].v];
		corner[k] = w->points[t[k].v];
	}
	if (all != 0 || (any & UNUSABLE))
		return 0;
	if ((any & (NEARER | FAR_OUT)) == 0)
		return make_piece(r, corner, triangle, pieces);
	for (int k = 0; k < 3; k++)
		memcpy(q[k], r->q[t[k].v], sizeof q[k]);
	ncut = bake_raster_clip(r, q, cut);
	for (int i = 0; i < ncut; i++) {
		for (int k = 0; k < 3; k++)
			corner[k] = project(r, cut[i][k], samples);
		n += make_piece(r, corner, triangle, &pieces[n]);
	}
	return n;
}

/* The pieces of a chunk of triangles, counted only where out is NULL. */
static size_t
make_chunk(
    const struct work *w, int samples, size_t chunk, struct raster_piece *out)
{
	const size_t begin = chunk * CHUNK, all = w->r->mesh->ntriangles;
	const size_t end = all - begin < CHUNK ? all : begin + CHUNK;
	size_t n = 0;

	for (size_t t = begin; t < end; t++) {
		struct raster_piece pieces[RASTER_MAX_PIECES];
		size_t m = (size_t)make_pieces(w, samples, t, pieces);

		if (out != NULL)
			memcpy(out + n, pieces, m * sizeof *pieces);
		n += m;
	}
	return n;
}

static enum bake_status
make_all(struct work *w, int samples, int nthreads, struct bake_err *err)
{
	struct bake_raster *r = w->r;

#pragma omp parallel for schedule(static) num_threads(nthreads)
	for (size_t v = 0; v < r->mesh->npositions; v++)
		see(w, samples, v);
#pragma omp parallel for schedule(dynamic) num_threads(nthreads)
	for (size_t i = 0; i < w->nchunks; i++)
		w->first[i + 1] = make_chunk(w, samples, i, NULL);
	for (size_t i = 0; i < w->nchunks; i++)
		w->first[i + 1] += w->first[i];
	/* a triangle has at most 6, and 3 triangles fit in an int */
	r->npieces = w->first[w->nchunks];
	r->pieces = bake_alloc(r->npieces, sizeof *r->pieces, err);
	if (r->pieces == NULL)
		return err->code;
#pragma omp parallel for schedule(dynamic) num_threads(nthreads)
	for (size_t i = 0; i < w->nchunks; i++)
		make_chunk(w, samples, i, r->pieces + w->first[i]);
	return BAKE_OK;
}

static enum bake_status
fill(struct bake_raster *r, int samples, int nthreads, struct bake_err *err)
{
	const struct bake_mesh *m = r->mesh;
	struct work w = { r, NULL, NULL, (m->ntriangles + CHUNK - 1) / CHUNK,
		NULL };
	enum bake_status rc = BAKE_ENOMEM;

	/* waking a thread costs more than a chunk */
	if ((size_t)nthreads > w.nchunks)
		nthreads = w.nchunks > 0 ? (int)w.nchunks : 1;
	if ((r->q = bake_alloc(m->npositions, sizeof *r->q, err)) == NULL ||
	    (w.points = bake_alloc(m->npositions, sizeof *w.points, err)) ==
		NULL ||
	    (w.where = bake_alloc(m->npositions, 1, err)) == NULL ||
	    (w.first = bake_zalloc(w.nchunks + 1, sizeof *w.first, err)) ==
		NULL)
		goto out;
	if ((rc = make_all(&w, samples, nthreads, err)) != BAKE_OK)
		goto out;
	rc = bake_raster_bin(r, nthreads, err);
out:
	free(w.points);
	free(w.where);
	free(w.first);
	return rc;
}

static enum bake_status
check(const struct bake_mesh *mesh, int samples, enum bake_cull cull,
    int nthreads, struct bake_err *err)
{
	if (samples < 1 || samples > 4)
		return bake_fail(err, BAKE_EINVAL,
		    "%d x %d samples a pixel: it is 1 to 4 each way", samples,
		    samples);
	if ((unsigned)cull > BAKE_CULL_NONE)
		return bake_fail(err, BAKE_EINVAL,
		    "culling %d is none of the three, 0 to 2", (int)cull);
	if (nthreads < 0)
		return bake_fail(
		    err, BAKE_EINVAL, "%d threads: it is 0 or more", nthreads);
	/* the limit of mesh.h, on which the numbers of pieces rely */
	if (mesh->ntriangles > INT32_MAX / 3)
		return bake_fail(err, BAKE_EINVAL,
		    "a mesh of %zu triangles: it is %d at most",
		    mesh->ntriangles, INT32_MAX / 3);
	return BAKE_OK;
}

enum bake_status
bake_raster_open(struct bake_raster **raster, const struct bake_mesh *mesh,
    const struct bake_camera *camera, int samples, enum bake_cull cull,
    int nthreads, struct bake_err *err)
{
	struct bake_raster *r = NULL;
	struct bake_camera_basis basis;
	enum bake_status rc;

	*raster = NULL;
	if ((rc = check(mesh, samples, cull, nthreads, err)) != BAKE_OK ||
	    (rc = bake_camera_basis(camera, &basis, err)) != BAKE_OK)
		return rc;
	if ((r = bake_zalloc(1, sizeof *r, err)) == NULL)
		return err->code;
	r->mesh = mesh;
	r->basis = basis;
	r->cull = cull;
	/* a vector of 8 doubles divides no faster than two of 4, and wastes
	 * more of short rows: 640x480 of a plane takes 0.80 ms against 0.67 */
	r->isa = bake_isa_pick();
	if (r->isa > BAKE_ISA_AVX2)
		r->isa = BAKE_ISA_AVX2;
	r->width = camera->width * samples;
	r->height = camera->height * samples;
	r->columns = (r->width + BAKE_RASTER_TILE - 1) / BAKE_RASTER_TILE;
	r->ntiles = r->columns *
		    ((r->height + BAKE_RASTER_TILE - 1) / BAKE_RASTER_TILE);
	r->scale = samples * basis.pixels;
	r->cx = samples * basis.cx;
	r->cy = samples * basis.cy;
	if ((rc = fill(r, samples, bake_threads(nthreads), err)) != BAKE_OK) {
		bake_raster_close(r);
		return rc;
	}
	*raster = r;
	return BAKE_OK;
}

void
bake_raster_close(struct bake_raster *r)
{
	if (r == NULL)
		return;
	free(r->q);
	free(r->pieces);
	free(r->start);
	free(r->bins);
	free(r);
}
