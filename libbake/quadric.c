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

enum { LANES = BAKE_QUADRIC_LANES, CHUNK = BAKE_QUADRIC_CHUNK };

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

/* Which points from first to before end have frames whose normals differ by
 * more than a degree. */
static void
find_creased(const struct bake_quadric_job *job, struct bake_quadric_bench *w,
    size_t first, size_t end)
{
	const struct bake_frame *f = job->frames->frame;

	for (size_t p = first; p < end; p++) {
		const struct bake_site *site =
		    job->pts.site + job->pts.first_site[p];
		int n = job->pts.first_site[p + 1] - job->pts.first_site[p];

		w->creased[p - first] = false;
		for (int i = 1; i < n; i++) {
			const double *a = f[site[0].frame].normal;
			const double *b = f[site[i].frame].normal;

			if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] <
			    0.99984769515639124) /* cos 1 degree */
				w->creased[p - first] = true;
		}
	}
}

/* A chunk of points, the first with what is of no point. */
static void
work(const struct bake_quadric_job *job, size_t chunk, size_t *done,
    struct bake_quadric_bench *w)
{
	const int *start = job->pts.first_site;
	const struct bake_site *site = job->pts.site;
	size_t n = job->pts.n, first = chunk * CHUNK;
	size_t end = n - first < CHUNK ? n : first + CHUNK, total;
	int begin = chunk > 0 ? start[first] : 0;

	/* while they are made, the frames are near */
	if (job->frames_first != NULL)
		bake_frame_points(job->frames_first, first, end,
		    &job->frames_first->benches[omp_get_thread_num()]);
	w->first = first;
	if (job->params->creases)
		find_creased(job, w, first, end);
	for (int i = begin; i < start[end]; i += LANES)
		bake_quadric_fit_batch(job, w, site + i,
		    start[end] - i < LANES ? start[end] - i : LANES,
		    site + job->frames->nframes);
#pragma omp atomic capture
	total = *done += (size_t)(start[end] - begin);
	report(job, total);
}

static enum bake_status
run(const struct bake_quadric_job *job, struct bake_err *err)
{
	/* chunks for which another thread pays: about a millisecond */
	enum { ENOUGH = 8 };
	size_t nchunks = (job->pts.n + CHUNK - 1) / CHUNK, done = 0;
	int nthreads = bake_threads(job->params->nthreads);
	enum bake_status rc = BAKE_OK;
	struct bake_quadric_bench *benches;

	/* frames of no point */
	nchunks = nchunks > 0 ? nchunks : 1;
	if ((size_t)nthreads > (nchunks + ENOUGH - 1) / ENOUGH)
		nthreads = (int)((nchunks + ENOUGH - 1) / ENOUGH);
	benches = bake_zalloc((size_t)nthreads, sizeof *benches, err);
	if (benches == NULL)
		return BAKE_ENOMEM;
	if (job->frames_first != NULL)
		rc = bake_frame_start(job->frames_first, nthreads, err);
	for (int t = 0; t < nthreads && rc == BAKE_OK; t++)
		rc = make_bench(&benches[t], job->pts.n, err);
#pragma omp parallel for num_threads(nthreads) schedule(dynamic)
	for (size_t c = 0; c < (rc == BAKE_OK ? nchunks : 0); c++)
		work(job, c, &done, &benches[omp_get_thread_num()]);
	for (int t = 0; t < nthreads; t++)
		free_bench(&benches[t]);
	free(benches);
	if (job->frames_first != NULL)
		bake_frame_end(job->frames_first);
	return rc;
}

/* -- the job --------------------------------------------------------------- */

static bool
is_positive(double v)
{
	return v > 0 && isfinite(v);
}

static enum bake_status
check(const struct bake_quadric_params *p, struct bake_err *err)
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
	return BAKE_OK;
}

static enum bake_status
check_mesh(const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_frames *frames, struct bake_err *err)
{
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
order_frames(const struct bake_mesh *mesh, const struct bake_frames *frames,
    struct bake_points *pts, struct bake_err *err)
{
	const struct bake_frame *f = frames->frame;
	int *start = pts->first_site;
	enum bake_status rc =
	    bake_points_room_for_sites(mesh, frames->nframes, pts, err);

	if (rc != BAKE_OK)
		return rc;
	for (size_t i = 0; i < frames->nframes; i++)
		start[pts->place[f[i].v].point + 2]++;
	for (size_t p = 0; p < pts->n + 1; p++)
		start[p + 1] += start[p];
	for (size_t i = 0; i < frames->nframes; i++) {
		int p = pts->place[f[i].v].point;

		pts->site[start[p + 1]++] =
		    (struct bake_site){ (int)i, p, f[i].v, f[i].vt };
	}
	return BAKE_OK;
}

static struct bake_quadric_job
make_job(const struct bake_mesh *mesh, const struct bake_frames *frames,
    const struct bake_quadric_params *params)
{
	static void (*const solvers[])(struct bake_quadric_batch *) =
	    BAKE_KERNEL_TABLE(bake_quadric_solve);

	return (struct bake_quadric_job){ .mesh = mesh,
		.frames = frames,
		.params = params,
		.pts = BAKE_POINTS_INIT,
		.solve = solvers[bake_isa_pick()],
		.nterms = params->model == BAKE_QUADRIC_AB ? 2
			  : params->order == 3             ? 9
							   : 5,
		.ring = params->ring };
}

static enum bake_status
connect_and_run(struct bake_quadric_job *job, struct bake_err *err)
{
	const struct bake_progress *progress = &job->params->progress;
	enum bake_status rc =
	    bake_quadric_connect(&job->pts, job->params->creases, err);

	if (rc == BAKE_OK)
		rc = run(job, err);
	if (rc == BAKE_OK && progress->report != NULL)
		progress->report(progress->arg, 1);
	return rc;
}

enum bake_status
bake_quadric_fit(const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_frames *frames, const struct bake_quadric_params *params,
    struct bake_quadric *out, struct bake_err *err)
{
	struct bake_quadric_job job = make_job(mesh, frames, params);
	enum bake_status rc;

	job.out = out;
	if ((rc = check(params, err)) == BAKE_OK &&
	    (rc = check_mesh(mesh, weld, frames, err)) == BAKE_OK &&
	    (rc = bake_points_make(mesh, weld, false, NULL, &job.pts, err)) ==
		BAKE_OK &&
	    (rc = order_frames(mesh, frames, &job.pts, err)) == BAKE_OK)
		rc = connect_and_run(&job, err);
	bake_points_free(&job.pts);
	return rc;
}

enum bake_status
bake_quadric_fit_mesh(const struct bake_mesh *mesh, double eps,
    const struct bake_frame_params *frame_params,
    const struct bake_quadric_params *params, struct bake_frames *frames,
    struct bake_quadric **out, struct bake_err *err)
{
	struct bake_weld weld = BAKE_WELD_INIT;
	struct bake_quadric_job job = make_job(mesh, frames, params);
	struct frame_job frame_job = { .mesh = mesh,
		.pts = &job.pts,
		.params = frame_params,
		.frames = frames };
	enum bake_status rc;

	*out = NULL;
	*frames = (struct bake_frames)BAKE_FRAMES_INIT;
	job.frames_first = &frame_job;
	if ((rc = check(params, err)) != BAKE_OK ||
	    (rc = bake_frame_check(mesh, frame_params, err)) != BAKE_OK)
		goto out;
	/* equal positions are found along the curve */
	if (eps != 0 && (rc = bake_mesh_weld(mesh, eps, &weld, err)) != BAKE_OK)
		goto out;
	rc = bake_points_make(
	    mesh, eps != 0 ? &weld : NULL, true, frames, &job.pts, err);
	if (rc != BAKE_OK)
		goto out;
	job.out = *out = bake_alloc(frames->nframes, sizeof **out, err);
	rc = *out != NULL ? connect_and_run(&job, err) : BAKE_ENOMEM;
out:
	bake_weld_free(&weld);
	bake_points_free(&job.pts);
	if (rc != BAKE_OK) {
		bake_frames_free(frames);
		free(*out);
		*out = NULL;
	}
	return rc;
}
