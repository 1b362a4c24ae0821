/* Tangent frames of a mesh: which there are, and all of them. */
/* SPDX-License-Identifier: MIT */
#include "mesh_frame.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "isa.h"
#include "mem.h"
#include "mesh_frame_priv.h"
#include "parallel.h"

/* -- which there are ------------------------------------------------------- */

static int
by_pair(const void *pa, const void *pb)
{
	const struct bake_frame_pair *a = pa, *b = pb;

	if (a->v != b->v)
		return a->v < b->v ? -1 : 1;
	return (a->vt > b->vt) - (a->vt < b->vt);
}

/* The different pairs of positions that have several, sorted. */
static enum bake_status
list_pairs(const struct bake_mesh *m, const struct bake_place *place,
    struct bake_frame_pair **out, size_t *count, struct bake_err *err)
{
	struct bake_frame_pair *pairs;
	size_t n = 0, ndifferent = 0;

	for (size_t i = 0; i < 3 * m->ntriangles; i++)
		n += place[m->triangles[i / 3][i % 3].v].frame ==
		     BAKE_PLACE_SEVERAL;
	if ((pairs = *out = bake_alloc(n, sizeof *pairs, err)) == NULL)
		return BAKE_ENOMEM;
	n = 0;
	for (size_t i = 0; i < 3 * m->ntriangles; i++) {
		const struct bake_corner *c = &m->triangles[i / 3][i % 3];

		if (place[c->v].frame == BAKE_PLACE_SEVERAL)
			pairs[n++] = (struct bake_frame_pair){ c->v, c->vt, 0 };
	}
	qsort(pairs, n, sizeof *pairs, by_pair);
	for (size_t i = 0; i < n; i++)
		if (i == 0 || by_pair(&pairs[i], &pairs[i - 1]) != 0)
			pairs[ndifferent++] = pairs[i];
	*count = ndifferent;
	return BAKE_OK;
}

/* Frames in their order, each in its point's list: place[].frame, pairs' frame
 * and the sites. */
static void
give_numbers(const struct bake_mesh *m, struct bake_points *pts,
    struct bake_frame_pair *pairs, size_t npairs)
{
	size_t pair = 0;
	int n = 0;

	for (size_t v = 0; v < m->npositions; v++) {
		struct bake_place *place = &pts->place[v];
		int *at;

		if (place->frame == BAKE_PLACE_UNUSED)
			continue;
		at = &pts->first_site[place->point + 1];
		if (place->frame != BAKE_PLACE_SEVERAL) {
			pts->site[(*at)++] = (struct bake_site){ n,
				place->point, (int)v, place->frame };
			place->frame = n++;
			continue;
		}
		place->frame = -1 - (int)pair;
		for (; pair < npairs && pairs[pair].v == (int)v; pair++) {
			pts->site[(*at)++] = (struct bake_site){ n,
				place->point, (int)v, pairs[pair].vt };
			pairs[pair].frame = n++;
		}
	}
}

/* Where the sites of each point go: first_site[p + 1], from zeros. */
static void
count_sites(const struct bake_mesh *m, struct bake_points *pts,
    const struct bake_frame_pair *pairs, size_t npairs)
{
	for (size_t v = 0; v < m->npositions; v++)
		pts->first_site[pts->place[v].point + 2] +=
		    pts->place[v].frame >= -1;
	for (size_t i = 0; i < npairs; i++)
		pts->first_site[pts->place[pairs[i].v].point + 2]++;
	for (size_t p = 0; p < pts->n; p++)
		pts->first_site[p + 2] += pts->first_site[p + 1];
}

/* The UVs of points that have one. */
static void
copy_uvs(const struct bake_mesh *m, struct bake_points *pts)
{
	enum { AHEAD = 16 };
	const size_t nsites = (size_t)pts->first_site[pts->n];

	for (size_t p = 0; p < pts->n; p++) {
		size_t i = (size_t)pts->first_site[p];
		int vt = pts->site[i].vt;
		bool one = pts->first_site[p + 1] == (int)i + 1 && vt >= 0;

		if (i + AHEAD < nsites && pts->site[i + AHEAD].vt >= 0)
			__builtin_prefetch(m->uvs[pts->site[i + AHEAD].vt]);
		for (int k = 0; k < 2; k++)
			pts->uv[p][k] = one ? m->uvs[vt][k] : (double)NAN;
	}
}

enum bake_status
bake_frames_number(const struct bake_mesh *m, struct bake_points *pts,
    struct bake_frames *frames, struct bake_frame_pair **pairs, size_t *npairs,
    struct bake_err *err)
{
	bool several = false;
	enum bake_status rc;
	size_t n = 0;

	*npairs = 0;
	for (size_t v = 0; v < m->npositions; v++) {
		several |= pts->place[v].frame == BAKE_PLACE_SEVERAL;
		n += pts->place[v].frame >= -1;
	}
	if (several &&
	    (rc = list_pairs(m, pts->place, pairs, npairs, err)) != BAKE_OK)
		return rc;
	n += *npairs;
	if ((rc = bake_points_room_for_sites(m, n, pts, err)) != BAKE_OK)
		return rc;
	frames->frame = bake_alloc(n, sizeof *frames->frame, err);
	frames->frame_of =
	    bake_alloc(m->ntriangles, sizeof *frames->frame_of, err);
	if (frames->frame == NULL || frames->frame_of == NULL)
		return BAKE_ENOMEM;
	frames->nframes = n;
	frames->ntriangles = m->ntriangles;
	count_sites(m, pts, *pairs, *npairs);
	give_numbers(m, pts, *pairs, *npairs);
	copy_uvs(m, pts);
	return BAKE_OK;
}

/* -- all of them --------------------------------------------------------- */

static size_t
room_for_corners(const struct bake_points *pts)
{
	unsigned most = BAKE_FRAME_BATCH;

	for (size_t p = 0; p < pts->n; p++)
		if (pts->first[p + 1] - pts->first[p] > most)
			most = pts->first[p + 1] - pts->first[p];
	return most;
}

enum bake_status
bake_frame_check(const struct bake_mesh *m,
    const struct bake_frame_params *params, struct bake_err *err)
{
	if (m->ntriangles == 0)
		return bake_fail(err, BAKE_EDATA, "the mesh has no triangles");
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

enum bake_status
bake_frame_start(struct frame_job *job, int nthreads, struct bake_err *err)
{
	static void (*const kernels[])(struct frame_batch *, int) =
	    BAKE_KERNEL_TABLE(bake_frame_corners);
	size_t most = room_for_corners(job->pts);

	job->corners = kernels[bake_isa_pick()];
	job->has_file_vectors =
	    (job->mesh->nnormals > 0 &&
		job->params->normals != BAKE_NORMALS_COMPUTED) ||
	    (job->mesh->tangents != NULL &&
		job->params->tangents == BAKE_TANGENTS_FILE);
	job->benches = bake_zalloc((size_t)nthreads, sizeof *job->benches, err);
	if (job->benches == NULL)
		return BAKE_ENOMEM;
	job->nbenches = nthreads;
	for (int i = 0; i < nthreads; i++) {
		struct frame_bench *b = &job->benches[i];

		b->items = bake_alloc(most, sizeof *b->items, err);
		b->order = bake_alloc(most, sizeof *b->order, err);
		b->spokes = bake_alloc(most, 2 * sizeof *b->spokes, err);
		b->batch = bake_zalloc(1, sizeof *b->batch, err);
		if (b->items == NULL || b->order == NULL || b->spokes == NULL ||
		    b->batch == NULL)
			return BAKE_ENOMEM;
		b->batch->weight = job->params->weight;
	}
	return BAKE_OK;
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

static bool
is_collapsed(const struct bake_place *place, const struct bake_corner t[3])
{
	int a = place[t[0].v].point, b = place[t[1].v].point,
	    c = place[t[2].v].point;

	return a == b || b == c || c == a;
}

void
bake_frame_end(struct frame_job *job)
{
	const struct bake_mesh *m = job->mesh;
	struct bake_frames *frames = job->frames;

	for (int i = 0; i < job->nbenches; i++) {
		struct frame_bench *b = &job->benches[i];

		frames->normal_none += b->normal_none;
		frames->tangent_none += b->tangent_none;
		frames->mirror_mixed += b->mirror_mixed;
		frames->flat_uv_triangles += b->flat_uvs;
		free(b->items);
		free(b->order);
		free(b->spokes);
		free(b->batch);
	}
	free(job->benches);
	/* those that no point's corners are of */
	for (size_t i = 0;
	     job->pts->ntriangles < m->ntriangles && i < m->ntriangles; i++)
		if (is_collapsed(job->pts->place, m->triangles[i]))
			frames->flat_uv_triangles +=
			    has_flat_uvs(m, m->triangles[i]);
}

static enum bake_status
do_points(struct frame_job *job, struct bake_err *err)
{
	/* and points for which another thread pays: about a millisecond */
	enum { CHUNK = 256, ENOUGH = 4096 };
	int nthreads = bake_threads(job->params->nthreads);
	ptrdiff_t n = (ptrdiff_t)job->pts->n;
	enum bake_status rc;

	if (nthreads > n / ENOUGH + 1)
		nthreads = (int)(n / ENOUGH + 1);
	rc = bake_frame_start(job, nthreads, err);
#pragma omp parallel for schedule(dynamic) num_threads(nthreads)
	for (ptrdiff_t i = 0; i < (rc == BAKE_OK ? n : 0); i += CHUNK)
		bake_frame_points(job, (size_t)i,
		    (size_t)(n - i < CHUNK ? n : i + CHUNK),
		    &job->benches[omp_get_thread_num()]);
	bake_frame_end(job);
	return rc;
}

enum bake_status
bake_mesh_frames(const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_adjacency *adj, const struct bake_frame_params *params,
    struct bake_frames *frames, struct bake_err *err)
{
	struct bake_points pts = BAKE_POINTS_INIT;
	struct frame_job job = {
		.mesh = mesh, .pts = &pts, .params = params, .frames = frames
	};
	enum bake_status rc;

	*frames = (struct bake_frames)BAKE_FRAMES_INIT;
	if ((rc = bake_frame_check(mesh, params, err)) != BAKE_OK)
		return rc;
	if ((weld != NULL && weld->npositions != mesh->npositions) ||
	    (adj != NULL && adj->npositions != mesh->npositions))
		return bake_fail(err, BAKE_EINVAL,
		    "a weld or adjacency of another mesh, expected one of "
		    "%zu positions",
		    mesh->npositions);
	if ((rc = bake_points_make(mesh, weld, false, frames, &pts, err)) ==
	    BAKE_OK)
		rc = do_points(&job, err);
	bake_points_free(&pts);
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
