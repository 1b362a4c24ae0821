/* Quadrics that osculate a mesh at its vertices: the order of the work. */
/* SPDX-License-Identifier: MIT */
#include "quadric.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "isa.h"
#include "mem.h"
#include "quadric_priv.h"

enum {
	LANES = BAKE_QUADRIC_LANES,
	CHUNK = 32 /* batches that a thread takes at a time */
};

/* -- threads -------------------------------------------------------------- */

static void
free_bench(struct bake_quadric_bench *w)
{
	free(w->seen);
	free(w->list);
	if (w->batch != NULL) {
		free(w->batch->x);
		free(w->batch->y);
		free(w->batch->z);
	}
	free(w->batch);
}

static enum bake_status
make_bench(struct bake_quadric_bench *w, size_t npoints, struct bake_err *err)
{
	const size_t n = (size_t)BAKE_QUADRIC_ROWS * LANES;

	memset(w, 0, sizeof *w);
	w->seen = bake_zalloc(npoints, sizeof *w->seen, err);
	w->list = bake_alloc(BAKE_QUADRIC_ROWS + 1, sizeof *w->list, err);
	w->batch = bake_zalloc(1, sizeof *w->batch, err);
	if (w->seen == NULL || w->list == NULL || w->batch == NULL)
		return BAKE_ENOMEM;
	w->batch->x = bake_alloc(n, sizeof(double), err);
	w->batch->y = bake_alloc(n, sizeof(double), err);
	w->batch->z = bake_alloc(n, sizeof(double), err);
	return w->batch->x == NULL || w->batch->y == NULL || w->batch->z == NULL
		   ? BAKE_ENOMEM
		   : BAKE_OK;
}

static void
report(const struct bake_quadric_job *job, size_t done)
{
	const struct bake_progress *p = &job->params->progress;

	if (p->report != NULL && omp_get_thread_num() == 0)
		p->report(
		    p->arg, (double)done / (double)(job->frames->nframes + 1));
}

static void
work(const struct bake_quadric_job *job, struct bake_quadric_bench *w,
    size_t chunk, size_t *done)
{
	size_t begin = chunk * CHUNK * LANES;
	size_t end = begin + CHUNK * LANES, total;

	if (end > job->frames->nframes)
		end = job->frames->nframes;
	for (size_t i = begin; i < end; i += LANES)
		bake_quadric_fit_batch(job, w, job->sites + i,
		    end - i < LANES ? (int)(end - i) : LANES,
		    job->sites + job->frames->nframes);
#pragma omp atomic capture
	total = *done += end - begin;
	report(job, total);
}

static enum bake_status
run(const struct bake_quadric_job *job, struct bake_err *err)
{
	size_t nchunks =
	    (job->frames->nframes + CHUNK * LANES - 1) / (CHUNK * LANES);
	int nthreads = bake_threads(job->params->nthreads);
	enum bake_status rc = BAKE_OK;
	struct bake_quadric_bench *benches;
	size_t done = 0;

	if ((size_t)nthreads > nchunks)
		nthreads = nchunks > 0 ? (int)nchunks : 1;
	benches = bake_zalloc((size_t)nthreads, sizeof *benches, err);
	if (benches == NULL)
		return BAKE_ENOMEM;
	for (int t = 0; t < nthreads && rc == BAKE_OK; t++)
		rc = make_bench(&benches[t], job->pts.n, err);
#pragma omp parallel for num_threads(nthreads) schedule(dynamic)
	for (size_t c = 0; c < (rc == BAKE_OK ? nchunks : 0); c++)
		work(job, &benches[omp_get_thread_num()], c, &done);
	for (int t = 0; t < nthreads; t++)
		free_bench(&benches[t]);
	free(benches);
	return rc;
}

/* -- the job --------------------------------------------------------------- */

static bool
is_positive(double v)
{
	return v > 0 && isfinite(v);
}

static enum bake_status
check(const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_frames *frames, const struct bake_quadric_params *p,
    struct bake_err *err)
{
	if (p->model != BAKE_QUADRIC_FULL && p->model != BAKE_QUADRIC_AB)
		return bake_fail(
		    err, BAKE_EINVAL, "unknown model %d", (int)p->model);
	if (p->order != 2 && p->order != 3)
		return bake_fail(
		    err, BAKE_EINVAL, "order %d, expected 2 or 3", p->order);
	if (p->ring < 0 || p->ring > BAKE_QUADRIC_RING_MAX)
		return bake_fail(err, BAKE_EINVAL, "ring %d, expected 0 to %d",
		    p->ring, BAKE_QUADRIC_RING_MAX);
	if (!is_positive(p->depth_scale))
		return bake_fail(err, BAKE_EINVAL,
		    "a depth scale of %g, expected a positive number",
		    p->depth_scale);
	if (p->depth != 0 && !is_positive(p->depth))
		return bake_fail(err, BAKE_EINVAL,
		    "a depth of %g, expected a positive number", p->depth);
	if (weld != NULL && weld->npositions != mesh->npositions)
		return bake_fail(err, BAKE_EINVAL,
		    "the weld is of %zu positions, the mesh has %zu",
		    weld->npositions, mesh->npositions);
	for (size_t i = 0; i < frames->nframes; i++)
		if (frames->frame[i].v < 0 ||
		    (size_t)frames->frame[i].v >= mesh->npositions)
			return bake_fail(err, BAKE_EINVAL,
			    "frame %zu is of position %d, the mesh has %zu", i,
			    frames->frame[i].v, mesh->npositions);
	return BAKE_OK;
}

/* Frames by the numbers of their points; those of no point first. */
static enum bake_status
order_frames(struct bake_quadric_job *job, struct bake_err *err)
{
	size_t n = job->frames->nframes, npoints = job->pts.n;
	const struct bake_frame *f = job->frames->frame;
	int *start = bake_zalloc(npoints + 2, sizeof *start, err);

	job->sites = bake_alloc(n, sizeof *job->sites, err);
	if (start == NULL || job->sites == NULL) {
		free(start);
		return BAKE_ENOMEM;
	}
	for (size_t i = 0; i < n; i++)
		start[job->pts.of[f[i].v] + 2]++;
	for (size_t k = 1; k < npoints + 2; k++)
		start[k] += start[k - 1];
	for (size_t i = 0; i < n; i++) {
		int p = job->pts.of[f[i].v];

		job->sites[start[p + 1]++] =
		    (struct bake_quadric_site){ (int)i, p };
	}
	free(start);
	return BAKE_OK;
}

/* Frames of one point whose normals differ by more than a degree. */
static void
mark_creases(const struct bake_quadric_job *job)
{
	const struct bake_frame *f = job->frames->frame;
	size_t n = job->frames->nframes;

	for (size_t i = 0, first = 0; i < n; i++) {
		const double *a = f[job->sites[first].frame].normal;
		const double *b = f[job->sites[i].frame].normal;
		int p = job->sites[i].point;

		if (p != job->sites[first].point)
			first = i;
		else if (p >= 0 && a[0] * b[0] + a[1] * b[1] + a[2] * b[2] <
				       0.99984769515639124) /* cos 1 degree */
			job->pts.point[p].flags |= BAKE_QUADRIC_CREASE;
	}
}

enum bake_status
bake_quadric_fit(const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_frames *frames, const struct bake_quadric_params *params,
    struct bake_quadric *out, struct bake_err *err)
{
	static void (*const solvers[])(struct bake_quadric_batch *) =
	    BAKE_KERNEL_TABLE(bake_quadric_solve);
	struct bake_quadric_job job = { .mesh = mesh,
		.frames = frames,
		.params = params,
		.out = out,
		.pts = BAKE_QUADRIC_POINTS_INIT,
		.sites = NULL,
		.solve = solvers[bake_isa_pick()],
		.nterms = params->model == BAKE_QUADRIC_AB ? 2
			  : params->order == 3             ? 9
							   : 5,
		.ring = params->ring };
	enum bake_status rc;

	if ((rc = check(mesh, weld, frames, params, err)) != BAKE_OK ||
	    (rc = bake_quadric_points(
		 mesh, weld, params->creases, &job.pts, err)) != BAKE_OK ||
	    (rc = order_frames(&job, err)) != BAKE_OK)
		goto out;
	if (params->creases)
		mark_creases(&job);
	rc = run(&job, err);
	if (rc == BAKE_OK && params->progress.report != NULL)
		params->progress.report(params->progress.arg, 1);
out:
	free(job.sites);
	bake_quadric_points_free(&job.pts);
	return rc;
}
