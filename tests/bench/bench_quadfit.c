/* Times the quadric fit and what it needs, on a torus of many vertices. */
/* SPDX-License-Identifier: MIT */
#include "quadric.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { NRUNS = 5, NSTAGES = 7 };

/* The first four are what 'all' does at once. */
static const char *const stages[NSTAGES] = { "weld", "adjacency", "frames",
	"fit", "fit, order 3", "all", "read PLY" };

static double
seconds(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static unsigned
hash(unsigned z)
{
	z = (z ^ z >> 16) * 0x85ebca6bu;
	z = (z ^ z >> 13) * 0xc2b2ae35u;
	return z ^ z >> 16;
}

static void
die(const struct bake_err *err)
{
	fprintf(stderr, "bench_quadfit: %s\n", err->msg);
	exit(1);
}

/* place[v]: where vertex v goes */
static int *
places(size_t n, bool shuffled)
{
	int *place = malloc(n * sizeof *place);

	if (place == NULL)
		exit(1);
	for (size_t v = 0; v < n; v++)
		place[v] = (int)v;
	for (size_t v = n - 1; shuffled && v > 0; v--) {
		size_t k = ((size_t)hash((unsigned)v) << 16) % (v + 1);
		int t = place[v];

		place[v] = place[k];
		place[k] = t;
	}
	return place;
}

/* n x n quadrangles, vertices moved by up to a quarter of a cell. */
static struct bake_mesh
make_torus(int n, bool shuffled)
{
	size_t side = (size_t)n, count = side * side;
	const double turn = 6.283185307179586 / n;
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	int *place = places(count, shuffled);
	int *order = places(2 * count, shuffled);

	if (bake_mesh_alloc(&m, count, count, 0, 2 * count, &err) != BAKE_OK)
		die(&err);
	for (size_t v = 0; v < count; v++) {
		double du = hash((unsigned)v) / 8589934592.0 - 0.25;
		double dv = hash(~(unsigned)v) / 8589934592.0 - 0.25;
		double a = turn * ((double)(v / side) + du);
		double b = turn * ((double)(v % side) + dv);
		double *p = m.positions[place[v]], *uv = m.uvs[place[v]];

		p[0] = (1 + 0.35 * cos(b)) * cos(a);
		p[1] = (1 + 0.35 * cos(b)) * sin(a);
		p[2] = 0.35 * sin(b);
		uv[0] = a;
		uv[1] = b;
	}
	for (size_t t = 0; t < 2 * count; t++) {
		size_t i = t / 2 / side, k = t / 2 % side;
		size_t i1 = (i + 1) % side, k1 = (k + 1) % side;
		size_t v[2][3] = { { i * side + k, i1 * side + k,
				       i1 * side + k1 },
			{ i * side + k, i1 * side + k1, i * side + k1 } };

		for (int c = 0; c < 3; c++) {
			int p = place[v[t % 2][c]];

			m.triangles[order[t]][c] =
			    (struct bake_corner){ p, p, -1 };
		}
	}
	free(place);
	free(order);
	return m;
}

/* The seconds of each stage. */
static void
run_once(const struct bake_mesh *m, struct bake_quadric *q, double *s)
{
	struct bake_frame_params fp = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_quadric_params qp = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_weld weld = BAKE_WELD_INIT;
	struct bake_adjacency adj = BAKE_ADJACENCY_INIT;
	struct bake_frames frames = BAKE_FRAMES_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_quadric *all;
	double t[NSTAGES];

	fp.nthreads = qp.nthreads = 1;
	t[0] = seconds();
	if (bake_mesh_weld(m, 0, &weld, &err) != BAKE_OK)
		die(&err);
	t[1] = seconds();
	if (bake_mesh_adjacency(m, &weld, false, &adj, &err) != BAKE_OK)
		die(&err);
	t[2] = seconds();
	if (bake_mesh_frames(m, &weld, &adj, &fp, &frames, &err) != BAKE_OK)
		die(&err);
	t[3] = seconds();
	if (bake_quadric_fit(m, &weld, &frames, &qp, q, &err) != BAKE_OK)
		die(&err);
	t[4] = seconds();
	qp.order = 3;
	if (bake_quadric_fit(m, &weld, &frames, &qp, q, &err) != BAKE_OK)
		die(&err);
	t[5] = seconds();
	bake_weld_free(&weld);
	bake_adjacency_free(&adj);
	bake_frames_free(&frames);
	qp.order = 2;
	s[5] = seconds();
	if (bake_quadric_fit_mesh(m, 0, &fp, &qp, &frames, &all, &err) !=
	    BAKE_OK)
		die(&err);
	s[5] = seconds() - s[5];
	for (int i = 0; i < 5; i++)
		s[i] = t[i + 1] - t[i];
	bake_frames_free(&frames);
	free(all);
}

static unsigned char *
put(unsigned char *at, const void *value, size_t n)
{
	memcpy(at, value, n);
	return at + n;
}

/* Reading the same mesh as a binary PLY of doubles. */
static double
read_ply(const struct bake_mesh *m)
{
	struct bake_mesh_params p = BAKE_MESH_PARAMS_DEFAULT;
	struct bake_mesh back = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	unsigned char *file =
	    malloc(512 + 40 * m->npositions + 13 * m->ntriangles);
	unsigned char *at = file, three = 3;
	double s;

	if (file == NULL)
		exit(1);
	at += sprintf((char *)at,
	    "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n"
	    "property double x\nproperty double y\nproperty double z\n"
	    "property double s\nproperty double t\nelement face %zu\n"
	    "property list uchar int vertex_indices\nend_header\n",
	    m->npositions, m->ntriangles);
	for (size_t v = 0; v < m->npositions; v++)
		at = put(put(at, m->positions[v], 24), m->uvs[v], 16);
	for (size_t t = 0; t < m->ntriangles; t++) {
		at = put(at, &three, 1);
		for (int k = 0; k < 3; k++)
			at = put(at, &m->triangles[t][k].v, 4);
	}
	s = seconds();
	if (bake_mesh_read_memory(file, (size_t)(at - file), "bench.ply", &p,
		&back, &err) != BAKE_OK)
		die(&err);
	s = seconds() - s;
	bake_mesh_free(&back);
	free(file);
	return s;
}

static int
compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void
bench(int n, bool shuffled)
{
	struct bake_mesh m = make_torus(n, shuffled);
	struct bake_quadric *q = malloc(m.npositions * sizeof *q);
	double s[NRUNS][NSTAGES], one[NRUNS];

	if (q == NULL)
		exit(1);
	for (int r = 0; r < NRUNS; r++) {
		run_once(&m, q, s[r]);
		s[r][6] = read_ply(&m);
	}
	for (int i = 0; i < NSTAGES; i++) {
		for (int r = 0; r < NRUNS; r++)
			one[r] = s[r][i] / (double)m.npositions * 1e9;
		qsort(one, NRUNS, sizeof *one, compare);
		printf("quadfit %zu%s, %s, ns a vertex\t%.1f\t%.1f\n",
		    m.npositions, shuffled ? " shuffled" : "", stages[i],
		    one[0], one[NRUNS / 2]);
	}
	free(q);
	bake_mesh_free(&m);
}

int
main(int argc, char **argv)
{
	int sizes[] = { 316, 1000 };

	if (argc > 1)
		sizes[0] = atoi(argv[1]);
	for (int i = 0; i < (argc > 1 ? 1 : 2); i++)
		for (int shuffled = 0; shuffled < 2; shuffled++)
			bench(sizes[i], shuffled != 0);
	return 0;
}
