/* Quadric fits: the points in their order, and the kernel. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_QUADRIC_PRIV_H
#define BAKE_QUADRIC_PRIV_H

#include "quadric.h"

/* Fits that are solved side by side; the arrays' innermost dimension,
 * whatever the width of the machine's vectors. */
enum { BAKE_QUADRIC_LANES = 8 };

/* a fit counts as determined where no pivot is below this share of its
 * diagonal element */
#define BAKE_QUADRIC_PIVOT_MIN 1e-6

/* rows that a batch has room for: one list may pass the limit by one point's
 * neighbours before it is noticed */
enum {
	BAKE_QUADRIC_ROWS =
	    BAKE_QUADRIC_NEIGHBOURS_MAX + BAKE_QUADRIC_VALENCE_MAX
};

/*
 * One fit in each lane. A lane with fewer neighbours than n is filled up with
 * zeros, which add exactly nothing to any sum: a lane's result depends neither
 * on the other lanes nor on the vectors' width.
 *
 *   x, y, z    [n][lanes] in: q - p; out: the same in the frame, z as fitted
 *   frame      rows T, B and the direction of z, x y z each
 *   out:
 *   a, b, c    after the slope correction
 *   pivot      the smallest ratio of a pivot to its diagonal element
 *   residual2  sum of squares of what the fit leaves
 *   radius2    sum of x^2 + y^2
 * A lane that is not determined may hold anything, NaN included.
 */
struct bake_quadric_batch {
	int n, nterms; /* nterms 2, 5 or 9 */
	double *x, *y, *z;
	double frame[9][BAKE_QUADRIC_LANES] __attribute__((aligned(64)));
	double a[BAKE_QUADRIC_LANES];
	double b[BAKE_QUADRIC_LANES];
	double c[BAKE_QUADRIC_LANES];
	double pivot[BAKE_QUADRIC_LANES];
	double residual2[BAKE_QUADRIC_LANES];
	double radius2[BAKE_QUADRIC_LANES];
};

void bake_quadric_solve_baseline(struct bake_quadric_batch *batch);
void bake_quadric_solve_avx2(struct bake_quadric_batch *batch);
void bake_quadric_solve_avx512(struct bake_quadric_batch *batch);

/* A point: two of them fill a cache line. */
struct bake_quadric_point {
	double p[3]; /* position times scale */
	unsigned start;
	unsigned flags; /* BAKE_QUADRIC_BOUNDARY, BAKE_QUADRIC_CREASE */
};

/*
 * The points that triangles use, numbered along a Morton curve (ties by their
 * coordinates, which differ), and their neighbours.
 *
 *   scale   a power of two that brings half the largest coordinate difference
 *           to 0.25 .. 0.5
 *   of      [mesh->npositions] number of the point, -1 where none uses it
 *   point   [n + 1], the last for its start alone
 *   around  neighbours of i: around[point[i].start] .. around[point[i +
 *           1].start - 1], each once, in an order that follows from the
 *           geometry
 */
struct bake_quadric_points {
	void *block; /* what the arrays are in */
	size_t n;
	double scale;
	int *of;
	struct bake_quadric_point *point;
	unsigned *around;
};
#define BAKE_QUADRIC_POINTS_INIT                                               \
	{                                                                      \
		NULL, 0, 1, NULL, NULL, NULL                                   \
	}

enum bake_status bake_quadric_points(const struct bake_mesh *mesh,
    const struct bake_weld *weld, bool creases,
    struct bake_quadric_points *points, struct bake_err *err);
void bake_quadric_points_free(struct bake_quadric_points *points);

/*
 * The first part of that: find the points, whose representatives have of[] = 0
 * and all other positions -1, and number them along the curve; sets n, scale,
 * of[] of the representatives, and the points' p. one and two are scratch, each
 * of BAKE_QUADRIC_PLACE bytes for each position.
 */
enum { BAKE_QUADRIC_PLACE = 16 };
enum bake_status bake_quadric_number(const struct bake_mesh *mesh, void *one,
    void *two, struct bake_quadric_points *points, struct bake_err *err);

/* A frame and its point; -1: none. */
struct bake_quadric_site {
	int frame, point;
};

/* The whole computation. */
struct bake_quadric_job {
	const struct bake_mesh *mesh;
	const struct bake_frames *frames;
	const struct bake_quadric_params *params;
	struct bake_quadric *out;
	struct bake_quadric_points pts;
	struct bake_quadric_site
	    *sites; /* [nframes] in the order of their points */
	void (*solve)(struct bake_quadric_batch *batch);
	int nterms, ring; /* what is asked for */
};

/* What a thread works with. */
struct bake_quadric_bench {
	unsigned *seen; /* [points] the latest gathering that met it */
	unsigned gathering;
	unsigned *list; /* [BAKE_QUADRIC_ROWS + 1] neighbours, by rings */
	struct bake_quadric_batch *batch;
};

/* The fits of up to BAKE_QUADRIC_LANES sites, into job->out; end is that of all
 * sites. */
void bake_quadric_fit_batch(const struct bake_quadric_job *job,
    struct bake_quadric_bench *bench, const struct bake_quadric_site *site,
    int count, const struct bake_quadric_site *end);

#endif
