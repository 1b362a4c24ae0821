/* Tangent frames of a mesh: which there are, and all of them. */
/* SPDX-License-Identifier: MIT */
#include "mesh_frame.h"

#include <omp.h>
#include <stdlib.h>

#include "isa.h"
#include "mem.h"
#include "mesh_frame_priv.h"
#include "parallel.h"

/* A pair of a position that has more than one UV. */
struct pair {
	int v, vt;
};

static int
by_pair(const void *pa, const void *pb)
{
	const struct pair *a = pa, *b = pb;

	if (a->v != b->v)
		return a->v < b->v ? -1 : 1;
	return (a->vt > b->vt) - (a->vt < b->vt);
}

/* What only[v] holds: a vt (-1: no UV) where v has no other, or one of these.
 */
enum { UNUSED = -2, SEVERAL = -3 };

/* Fill only, and return in how many corners positions with several UVs are. */
static size_t
find_several(const struct bake_mesh *m, int *only)
{
	size_t n = 0;
	bool any = false;

	for (size_t v = 0; v < m->npositions; v++)
		only[v] = UNUSED;
	for (size_t i = 0; i < 3 * m->ntriangles; i++) {
		const struct bake_corner *c = &m->triangles[i / 3][i % 3];

		if (only[c->v] == UNUSED)
			only[c->v] = c->vt;
		else if (only[c->v] != c->vt) {
			only[c->v] = SEVERAL;
			any = true;
		}
	}
	for (size_t i = 0; any && i < 3 * m->ntriangles; i++)
		n += only[m->triangles[i / 3][i % 3].v] == SEVERAL;
	return n;
}

/* The different pairs of such positions, sorted. Returns how many. */
static size_t
list_pairs(const struct bake_mesh *m, const int *only, struct pair *pairs)
{
	size_t n = 0, ndifferent = 0;

	for (size_t i = 0; i < 3 * m->ntriangles; i++) {
		const struct bake_corner *c = &m->triangles[i / 3][i % 3];

		if (only[c->v] == SEVERAL)
			pairs[n++] = (struct pair){ c->v, c->vt };
	}
	qsort(pairs, n, sizeof *pairs, by_pair);
	for (size_t i = 0; i < n; i++)
		if (i == 0 || by_pair(&pairs[i], &pairs[i - 1]) != 0)
			pairs[ndifferent++] = pairs[i];
	return ndifferent;
}

/* The frames in their order; start[v] becomes the first of position v. */
static void
lay_out(const struct bake_mesh *m, const int *only, const struct pair *pairs,
    size_t npairs, struct bake_frames *frames, int *start)
{
	size_t pair = 0, n = 0;

	for (size_t v = 0; v < m->npositions; v++) {
		start[v] = (int)n;
		for (; pair < npairs && pairs[pair].v == (int)v; pair++)
			frames->frame[n++] = (struct bake_frame){
				.v = (int)v, .vt = pairs[pair].vt, .hand = 1
			};
		if (only[v] != SEVERAL && only[v] != UNUSED)
			frames->frame[n++] = (struct bake_frame){
				.v = (int)v, .vt = only[v], .hand = 1
			};
	}
	start[m->npositions] = (int)n;
}

/* The frame of a corner, by halving. */
static int
find_frame(
    const struct bake_frames *frames, const int *start, struct bake_corner c)
{
	int lo = start[c.v], hi = start[c.v + 1] - 1;

	while (lo < hi) {
		int mid = lo + (hi - lo) / 2;

		if (frames->frame[mid].vt < c.vt)
			lo = mid + 1;
		else
			hi = mid;
	}
	return lo;
}

/* Which pairs (v, vt) there are, and which each corner has. */
static enum bake_status
number_frames(
    const struct bake_mesh *m, struct bake_frames *frames, struct bake_err *err)
{
	int *only = bake_alloc(m->npositions, sizeof *only, err);
	int *start = bake_alloc(m->npositions + 1, sizeof *start, err);
	struct pair *pairs = NULL;
	size_t npairs, total = 0;
	enum bake_status rc = BAKE_ENOMEM;

	frames->frame_of =
	    bake_alloc(m->ntriangles, sizeof *frames->frame_of, err);
	if (only == NULL || start == NULL || frames->frame_of == NULL)
		goto out;
	npairs = find_several(m, only);
	if ((pairs = bake_alloc(npairs, sizeof *pairs, err)) == NULL)
		goto out;
	if (npairs > 0)
		npairs = list_pairs(m, only, pairs);
	for (size_t v = 0; v < m->npositions; v++)
		total += only[v] != SEVERAL && only[v] != UNUSED;
	total += npairs;
	frames->frame = bake_alloc(total, sizeof *frames->frame, err);
	if (frames->frame == NULL)
		goto out;
	frames->nframes = total;
	frames->ntriangles = m->ntriangles;
	lay_out(m, only, pairs, npairs, frames, start);
	for (size_t i = 0; i < m->ntriangles; i++)
		for (int k = 0; k < 3; k++)
			frames->frame_of[i][k] =
			    find_frame(frames, start, m->triangles[i][k]);
	rc = BAKE_OK;
out:
	free(only);
	free(start);
	free(pairs);
	return rc;
}

/* -- all of them --------------------------------------------------------- */

static int
room_for_corners(const struct bake_adjacency *adj)
{
	int most = BAKE_FRAME_BATCH;

	for (size_t i = 0; i < adj->npositions; i++)
		if (adj->start[i + 1] - adj->start[i] > most)
			most = adj->start[i + 1] - adj->start[i];
	return most;
}

static enum bake_status
check(const struct bake_mesh *m, const struct bake_weld *weld,
    const struct bake_adjacency *adj, const struct bake_frame_params *params,
    struct bake_err *err)
{
	if (m->ntriangles == 0)
		return bake_fail(err, BAKE_EDATA, "the mesh has no triangles");
	if ((weld != NULL && weld->npositions != m->npositions) ||
	    (adj != NULL && adj->npositions != m->npositions))
		return bake_fail(err, BAKE_EINVAL,
		    "a weld or adjacency of another mesh, expected one of "
		    "%zu positions",
		    m->npositions);
	if (params->normals == BAKE_NORMALS_FILE && m->nnormals == 0)
		return bake_fail(
		    err, BAKE_EDATA, "the mesh has no normals of its own");
	if (params->tangents == BAKE_TANGENTS_FILE && m->nuvs == 0 &&
	    m->tangents == NULL)
		return bake_fail(
		    err, BAKE_EDATA, "the mesh has neither tangents nor UVs");
	if (params->tangents == BAKE_TANGENTS_UV && m->nuvs == 0)
		return bake_fail(err, BAKE_EDATA, "the mesh has no UVs");
	return BAKE_OK;
}

static enum bake_status
do_points(struct frame_job *job, struct bake_err *err)
{
	enum { CHUNK = 256 };
	static void (*const kernels[])(struct frame_batch *, int) =
	    BAKE_KERNEL_TABLE(bake_frame_corners);
	int nthreads = bake_threads(job->params->nthreads);
	size_t most = (size_t)room_for_corners(job->adj);
	size_t total = (size_t)nthreads * most;
	const struct frame_bench all = { bake_alloc(
					     total, sizeof *all.items, err),
		bake_alloc(total, sizeof *all.order, err),
		bake_alloc(total, 2 * sizeof *all.spokes, err),
		bake_zalloc((size_t)nthreads, sizeof *all.batch, err) };
	ptrdiff_t n = (ptrdiff_t)job->mesh->npositions;
	enum bake_status rc = BAKE_OK;

	if (all.items == NULL || all.order == NULL || all.spokes == NULL ||
	    all.batch == NULL) {
		rc = BAKE_ENOMEM;
		goto out;
	}
	job->corners = kernels[bake_isa_pick()];
	for (int i = 0; i < nthreads; i++)
		all.batch[i].weight = job->params->weight;
#pragma omp parallel for schedule(dynamic) num_threads(nthreads)
	for (ptrdiff_t i = 0; i < n; i += CHUNK) {
		size_t thread = (size_t)omp_get_thread_num();
		size_t at = thread * most;
		const struct frame_bench bench = { all.items + at,
			all.order + at, all.spokes + 2 * at,
			all.batch + thread };

		bake_frame_points(
		    job, (int)i, (int)(n - i < CHUNK ? n : i + CHUNK), &bench);
	}
	n = (ptrdiff_t)job->frames->nframes;
#pragma omp parallel for schedule(static) num_threads(nthreads)
	for (ptrdiff_t i = 0; i < n; i++)
		bake_frame_finish(job, &job->frames->frame[i]);
out:
	free(all.items);
	free(all.order);
	free(all.spokes);
	free(all.batch);
	return rc;
}

/* Whether no gradient can be taken from the triangle's UVs. */
static bool
has_flat_uvs(const struct bake_mesh *m, const struct bake_corner t[3])
{
	const double *a, *b, *c;
	double e[2], f[2], det;

	if (t[0].vt < 0 || t[1].vt < 0 || t[2].vt < 0)
		return false;
	a = m->uvs[t[0].vt];
	b = m->uvs[t[1].vt];
	c = m->uvs[t[2].vt];
	for (int k = 0; k < 2; k++) {
		e[k] = b[k] - a[k];
		f[k] = c[k] - a[k];
	}
	det = e[0] * f[1] - f[0] * e[1];
	return !(det * det > FLAT * FLAT * (e[0] * e[0] + e[1] * e[1]) *
				 (f[0] * f[0] + f[1] * f[1]));
}

static void
count(const struct bake_mesh *m, struct bake_frames *frames)
{
	for (size_t i = 0; i < frames->nframes; i++) {
		int flags = frames->frame[i].flags;

		frames->normal_none += (flags & BAKE_FRAME_NORMAL_NONE) != 0;
		frames->tangent_none += (flags & BAKE_FRAME_TANGENT_NONE) != 0;
		frames->mirror_mixed += (flags & BAKE_FRAME_MIRROR_MIXED) != 0;
	}
	for (size_t i = 0; i < m->ntriangles; i++)
		frames->flat_uv_triangles += has_flat_uvs(m, m->triangles[i]);
}

/* In the order the mesh has. */
static enum bake_status
do_frames(struct frame_job *job, struct bake_err *err)
{
	struct bake_adjacency own = BAKE_ADJACENCY_INIT;
	const struct bake_mesh *m = job->mesh;
	enum bake_status rc = BAKE_OK;

	if (job->adj == NULL) {
		rc = bake_mesh_adjacency(m, job->weld, false, &own, err);
		if (rc != BAKE_OK)
			return rc;
		job->adj = &own;
	}
	job->point_normal =
	    bake_alloc(m->npositions, sizeof *job->point_normal, err);
	if (job->point_normal == NULL)
		rc = BAKE_ENOMEM;
	else if ((rc = number_frames(m, job->frames, err)) == BAKE_OK &&
		 (rc = do_points(job, err)) == BAKE_OK)
		count(m, job->frames);
	free(job->point_normal);
	bake_adjacency_free(&own);
	return rc;
}

/* In an order where what is near in space is near in memory. The result is
 * the same in any order: only the time is not. */
static enum bake_status
do_copy(const struct frame_job *job, struct bake_err *err)
{
	struct frame_copy copy;
	struct bake_frames frames = BAKE_FRAMES_INIT;
	struct frame_job local = { &copy.mesh, &copy.weld, NULL, job->params,
		&frames, NULL, NULL };
	enum bake_status rc;

	if ((rc = bake_frame_copy(job->mesh, job->weld, &copy, err)) ==
		BAKE_OK &&
	    (rc = do_frames(&local, err)) == BAKE_OK)
		rc = bake_frame_put_back(&copy, &frames, job->frames, err);
	bake_frames_free(&frames);
	bake_frame_copy_free(&copy);
	return rc;
}

enum bake_status
bake_mesh_frames(const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_adjacency *adj, const struct bake_frame_params *params,
    struct bake_frames *frames, struct bake_err *err)
{
	struct frame_job job = { mesh, weld, adj, params, frames, NULL, NULL };
	enum bake_status rc;

	*frames = (struct bake_frames)BAKE_FRAMES_INIT;
	if ((rc = check(mesh, weld, adj, params, err)) == BAKE_OK)
		rc = bake_frame_is_local(mesh) ? do_frames(&job, err)
					       : do_copy(&job, err);
	if (rc != BAKE_OK)
		bake_frames_free(frames);
	return rc;
}

void
bake_frames_free(struct bake_frames *frames)
{
	free(frames->frame);
	free(frames->frame_of);
	*frames = (struct bake_frames)BAKE_FRAMES_INIT;
}
