/* Times the A-buffer: ready, and all bands, on one core. */
/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <time.h>

#include "../unit/test_solid.h"
#include "abuffer.h"

/*
 * Usage: bench_multilayer [weave|torus]    the two meshes of the goal, or one
 *        bench_multilayer FILE SIDE AXIS         another one; AXIS is +x to -z
 *        bench_multilayer --write weave|torus FILE.obj   for other programs
 *
 * Prints, tab-separated: what, minimum and median of the runs' CPU seconds.
 */
enum { NRUNS = 5 };

static double
seconds(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void
die(const struct bake_err *err)
{
	fprintf(stderr, "bench_multilayer: %s\n", err->msg);
	exit(1);
}

/* 65,536 triangles of weave, tiled; 1.3 million of a torus that stands. */
static struct bake_mesh
make(int n, struct bake_view *view)
{
	const double turn[3][3] = { { 1, 0, 0 }, { 0, 0.6, -0.8 },
		{ 0, 0.8, 0.6 } };
	const double zero[3] = { 0, 0, 0 };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_mesh m;

	*view = (struct bake_view){ .axis = BAKE_AXIS_POS_Z };
	if (n == 0) {
		m = solid_weave(8, 129, 16, 0.25, 0.3);
		view->width = view->height = 4096;
		view->x1 = view->y1 = 8;
		view->near = 0.6;
		view->far = -0.6;
		view->tile_x = view->tile_y = true;
		return m;
	}
	m = solid_torus(1, 0.35, 1140, 570);
	solid_map(&m, turn, zero);
	view->width = view->height = 1024;
	if (bake_view_fit(view, &m, &err) != BAKE_OK)
		die(&err);
	return m;
}

static int
compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void
report(const char *what, const char *stage, double *t)
{
	qsort(t, NRUNS, sizeof *t, compare);
	printf("multilayer %s, %s, s\t%.3f\t%.3f\n", what, stage, t[0],
	    t[NRUNS / 2]);
}

/* What a normal or a colour needs first: the weights of every crossing. */
static void
bench_weights(
    const struct bake_mesh *m, const struct bake_view *view, const char *what)
{
	const struct bake_abuffer_params params = BAKE_ABUFFER_PARAMS_DEFAULT;
	struct bake_abuffer *ab;
	struct bake_band band = BAKE_BAND_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	double t[NRUNS] = { 0 }, sum = 0;

	if (bake_abuffer_open(&ab, m, NULL, view, &params, &err) != BAKE_OK)
		die(&err);
	for (int y = 0; y < view->height; y++) {
		if (bake_abuffer_rows(ab, y, 1, &band, &err) != BAKE_OK)
			die(&err);
		for (int r = 0; r < NRUNS; r++) {
			double start = seconds();

			for (int x = 0; x < view->width; x++)
				for (size_t i = band.start[x];
				     i < band.start[x + 1]; i++) {
					double w[3];

					bake_abuffer_weights(
					    ab, &band.crossing[i], x, y, w);
					sum += w[0];
				}
			t[r] += seconds() - start;
		}
	}
	report(what, "weights", t);
	if (!(sum > 0))
		printf("  no weight\n");
	bake_band_free(&band);
	bake_abuffer_close(ab);
}

static void
bench(const struct bake_mesh *m, const struct bake_view *view, const char *name)
{
	const struct bake_abuffer_params params = BAKE_ABUFFER_PARAMS_DEFAULT;
	struct bake_band band = BAKE_BAND_INIT;
	struct bake_abuffer_stats sum;
	struct bake_err err = BAKE_ERR_INIT;
	double weld_s[NRUNS], open_s[NRUNS], rows_s[NRUNS], both[NRUNS];
	char what[256];
	size_t layers = 0;

	snprintf(what, sizeof what, "%s, %zu triangles at %dx%d", name,
	    m->ntriangles, view->width, view->height);
	for (int r = 0; r < NRUNS; r++) {
		struct bake_weld weld = BAKE_WELD_INIT;
		struct bake_abuffer *ab;
		double t[4];

		layers = 0;
		sum = (struct bake_abuffer_stats){ 0 };
		t[0] = seconds();
		if (bake_mesh_weld(m, 0, &weld, &err) != BAKE_OK)
			die(&err);
		t[1] = seconds();
		if (bake_abuffer_open(&ab, m, &weld, view, &params, &err) !=
		    BAKE_OK)
			die(&err);
		t[2] = seconds();
		for (int y = 0; y < view->height; y += BAKE_BAND_ROWS) {
			int n = view->height - y;

			n = n < BAKE_BAND_ROWS ? n : BAKE_BAND_ROWS;
			if (bake_abuffer_rows(ab, y, n, &band, &err) != BAKE_OK)
				die(&err);
			layers += band.start[(size_t)n * (size_t)view->width];
			sum.open += band.stats.open;
			sum.crossings += band.stats.crossings;
		}
		t[3] = seconds();
		weld_s[r] = t[1] - t[0];
		open_s[r] = t[2] - t[1];
		rows_s[r] = t[3] - t[2];
		both[r] = t[3] - t[1];
		bake_abuffer_close(ab);
		bake_weld_free(&weld);
		/* each run starts as the first */
		bake_band_free(&band);
	}
	report(what, "weld", weld_s);
	report(what, "ready", open_s);
	report(what, "rows", rows_s);
	report(what, "coverage and depth", both);
	bench_weights(m, view, what);
	printf("  %zu crossings, %zu layers, %zu texels open\n", sum.crossings,
	    layers, sum.open);
}

static int
write_obj(const struct bake_mesh *m, const char *path)
{
	FILE *f = fopen(path, "w");

	if (f == NULL)
		return 1;
	for (size_t v = 0; v < m->npositions; v++)
		fprintf(f, "v %.17g %.17g %.17g\n", m->positions[v][0],
		    m->positions[v][1], m->positions[v][2]);
	for (size_t t = 0; t < m->ntriangles; t++)
		fprintf(f, "f %d %d %d\n", m->triangles[t][0].v + 1,
		    m->triangles[t][1].v + 1, m->triangles[t][2].v + 1);
	return fclose(f) != 0;
}

static enum bake_axis
axis_of(const char *name)
{
	int a = BAKE_AXIS_POS_X;

	while (a < BAKE_AXIS_NEG_Z &&
	       strcmp(name, bake_axis_name((enum bake_axis)a)) != 0)
		a++;
	return (enum bake_axis)a;
}

static void
read_mesh(char **argv, struct bake_mesh *m, struct bake_view *view)
{
	const struct bake_mesh_params p = BAKE_MESH_PARAMS_DEFAULT;
	struct bake_err err = BAKE_ERR_INIT;

	*view = (struct bake_view){ .axis = axis_of(argv[3]),
		.width = atoi(argv[2]),
		.height = atoi(argv[2]) };
	if (bake_mesh_read(argv[1], &p, m, &err) != BAKE_OK ||
	    bake_view_fit(view, m, &err) != BAKE_OK)
		die(&err);
}

int
main(int argc, char **argv)
{
	static const char *const names[] = { "weave", "torus" };
	const bool file = argc == 4;
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_view view;
	int rc = 0;

	if (file && strcmp(argv[1], "--write") == 0) {
		m = make(strcmp(argv[2], names[0]) == 0 ? 0 : 1, &view);
		rc = write_obj(&m, argv[3]);
		bake_mesh_free(&m);
		return rc;
	}
	for (int i = 0; i < (file ? 1 : 2); i++) {
		struct rusage before, after;

		if (argc == 2 && strcmp(argv[1], names[i]) != 0)
			continue;
		if (file)
			read_mesh(argv, &m, &view);
		else
			m = make(i, &view);
		getrusage(RUSAGE_SELF, &before);
		bench(&m, &view, file ? argv[1] : names[i]);
		getrusage(RUSAGE_SELF, &after);
		printf("  at most %.1f MiB more than before\n",
		    (double)(after.ru_maxrss - before.ru_maxrss) / 1024);
		bake_mesh_free(&m);
	}
	return rc;
}
