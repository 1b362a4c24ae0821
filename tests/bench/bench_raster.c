/* Times the rasteriser: a plane that fills 640x480, and meshes of many
 * triangles at 1920x1080. */
/* SPDX-License-Identifier: MIT */
#include "raster.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "shape.h"

enum { NRUNS = 9 };

struct scene {
	const char *name;
	enum bake_shape shape;
	int detail, width, height, samples;
	double eye[3];
};

static const struct scene scenes[] = {
	/* half the height at a distance of 0.7: the picture is all plane */
	{ "plane, 640x480", BAKE_SHAPE_PLANE, 1, 640, 480, 1, { 0, 0.7, 0.1 } },
	{ "plane, 640x480, 16 samples", BAKE_SHAPE_PLANE, 1, 640, 480, 4,
	    { 0, 0.7, 0.1 } },
	{ "teapot, detail 36, 1920x1080", BAKE_SHAPE_TEAPOT, 36, 1920, 1080, 1,
	    { 1, 1.5, 3 } },
	{ "sphere, detail 80, 1920x1080", BAKE_SHAPE_SPHERE, 80, 1920, 1080, 1,
	    { 0, 0, 2.6 } },
	{ "sphere, detail 80, 192x108", BAKE_SHAPE_SPHERE, 80, 192, 108, 1,
	    { 0, 0, 2.6 } },
};
enum { NSCENES = sizeof scenes / sizeof *scenes };

/* One thread is timed by its own clock, which others do not disturb. */
static double
seconds(int nthreads)
{
	struct timespec t;

	clock_gettime(
	    nthreads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void
die(const struct bake_err *err)
{
	fprintf(stderr, "bench_raster: %s\n", err->msg);
	exit(1);
}

static void
count(void *arg, const struct bake_fragments *f)
{
	*(size_t *)arg += (size_t)f->n;
}

/* Times of opening and of all tiles; returns the number of fragments. */
static size_t
run(const struct scene *s, const struct bake_mesh *m, int nthreads,
    double *open, double *tiles)
{
	struct bake_camera c = { .eye = { s->eye[0], s->eye[1], s->eye[2] },
		.up = { 0, 1, 0.001 },
		.fov_deg = 50,
		.near = 0.01,
		.width = s->width,
		.height = s->height };
	struct bake_raster *r;
	struct bake_err err = BAKE_ERR_INIT;
	size_t size = (bake_raster_scratch() + 63) / 64 * 64, n = 0;
	double start = seconds(nthreads);

	if (bake_raster_open(&r, m, &c, s->samples, BAKE_CULL_BACK, nthreads,
		&err) != BAKE_OK)
		die(&err);
	*open = seconds(nthreads) - start;
	start = seconds(nthreads);
#pragma omp parallel num_threads(nthreads) reduction(+ : n)
	{
		void *scratch = aligned_alloc(64, size);

		if (scratch == NULL)
			abort();
#pragma omp for schedule(dynamic)
		for (int t = 0; t < bake_raster_ntiles(r); t++)
			bake_raster_fragments(r, t, count, &n, scratch);
		free(scratch);
	}
	*tiles = seconds(nthreads) - start;
	bake_raster_close(r);
	return n;
}

static int
compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void
bench(const struct scene *s, const struct bake_mesh *m, int nthreads)
{
	double open[NRUNS], tiles[NRUNS];
	size_t n = 0;

	for (int i = 0; i < NRUNS; i++)
		n = run(s, m, nthreads, &open[i], &tiles[i]);
	qsort(open, NRUNS, sizeof *open, compare);
	qsort(tiles, NRUNS, sizeof *tiles, compare);
	printf("%-29s %d thread%s %7zu triangles %8zu fragments, ms min/median:"
	       " open %.2f/%.2f tiles %.2f/%.2f\n",
	    s->name, nthreads, nthreads == 1 ? " " : "s", m->ntriangles, n,
	    1e3 * open[0], 1e3 * open[NRUNS / 2], 1e3 * tiles[0],
	    1e3 * tiles[NRUNS / 2]);
}

int
main(void)
{
	for (int i = 0; i < NSCENES; i++) {
		struct bake_mesh m = BAKE_MESH_INIT;
		struct bake_err err = BAKE_ERR_INIT;

		if (bake_shape_make(
			scenes[i].shape, scenes[i].detail, &m, &err) != BAKE_OK)
			die(&err);
		for (int nthreads = 1; nthreads <= 2; nthreads++)
			bench(&scenes[i], &m, nthreads);
		bake_mesh_free(&m);
	}
	return 0;
}
