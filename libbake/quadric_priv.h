/* Quadric fits: the points in their order, and the kernel. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_QUADRIC_PRIV_H
#define BAKE_QUADRIC_PRIV_H

#include "mesh_frame_priv.h"
#include "mesh_points_priv.h"
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

/*
 * Who is next to whom: neighbours of point i are room[point[i].start] ..
 * room[point[i + 1].start - 1], each once, in an order that follows from the
 * geometry; and point[i].flags becomes BAKE_QUADRIC_BOUNDARY and, where it is
 * asked for, BAKE_QUADRIC_CREASE.
 */
enum bake_status bake_quadric_connect(
    struct bake_points *pts, bool creases, struct bake_err *err);

/* The whole computation. */
struct bake_quadric_job {
	const struct bake_mesh *mesh;
	const struct bake_frames *frames;
	const struct bake_quadric_params *params;
	struct bake_quadric *out;
	struct bake_points pts;         /* with sites */
	struct frame_job *frames_first; /* frames still to be made, or NULL */
	void (*solve)(struct bake_quadric_batch *batch);
	int nterms, ring; /* what is asked for */
};

/*
 * What a thread works with: a chunk of points at a time, from first on.
 *   creased  which of them have frames whose normals differ by more than a
 *            degree
 */
enum { BAKE_QUADRIC_CHUNK = 256 };
struct bake_quadric_bench {
	size_t first;
	bool creased[BAKE_QUADRIC_CHUNK];
	unsigned *seen; /* [points] the latest gathering that met it */
	unsigned gathering;
	unsigned *list; /* [BAKE_QUADRIC_ROWS + 1] neighbours, by rings */
	struct bake_quadric_batch *batch;
};

/* The fits of up to BAKE_QUADRIC_LANES sites, into job->out; end is that of all
 * sites. */
void bake_quadric_fit_batch(const struct bake_quadric_job *job,
    struct bake_quadric_bench *bench, const struct bake_site *site, int count,
    const struct bake_site *end);

#endif
