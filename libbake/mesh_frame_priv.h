/* What the frames' parts share: sums around points. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MESH_FRAME_PRIV_H
#define BAKE_MESH_FRAME_PRIV_H

#include "mesh_frame.h"
#include "mesh_points_priv.h"

/* Heights below this part of the longest edge, areas below this part of the
 * product of the edges: no direction. */
#define FLAT 1e-12

#define BAKE_FRAME_PI 3.14159265358979323846

/* While frames are made: file normals or tangents that differ. */
enum { FRAME_MIXED_NORMALS = 1 << 16, FRAME_MIXED_TANGENTS = 1 << 17 };

static inline double
frame_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void
frame_add_scaled(double sum[3], double w, const double x[3])
{
	for (int k = 0; k < 3; k++)
		sum[k] += w * x[k];
}

/* To unit length; false, x as it was, where it has no direction. */
bool bake_frame_normalize(double x[3]);

/*
 * Corners side by side, for the kernel.
 *   e, f, uv_e, uv_f  edges to the next and to the previous corner, in space
 *                     and in UVs (all 0 where there are none)
 *   wn, angle, ps, pt, side  out, as in frame_item
 *   flat_uv           out: 1 where UVs have no area, else 0
 */
enum { BAKE_FRAME_BATCH = 64 }; /* a multiple of every set's lanes */
struct frame_batch {
	double e[3][BAKE_FRAME_BATCH], f[3][BAKE_FRAME_BATCH];
	double uv_e[2][BAKE_FRAME_BATCH], uv_f[2][BAKE_FRAME_BATCH];
	/* a few more than there are, for who reads some at a time */
	double wn[3][BAKE_FRAME_BATCH + 8], angle[BAKE_FRAME_BATCH];
	double ps[3][BAKE_FRAME_BATCH], pt[3][BAKE_FRAME_BATCH];
	double side[BAKE_FRAME_BATCH], flat_uv[BAKE_FRAME_BATCH];
	enum bake_normal_weight weight;
};

/* The first n corners, up to n rounded up to the lanes of the set. */
void bake_frame_corners_baseline(struct frame_batch *b, int n);
void bake_frame_corners_avx2(struct frame_batch *b, int n);
void bake_frame_corners_avx512(struct frame_batch *b, int n);

/* What a corner of a triangle adds at its point. */
struct frame_item {
	double wn[3]; /* weight * n; 0 without area */
	double angle; /* 0 without area */
	struct bake_frame *frame;
	double ps[3], pt[3];
	const double *uv;                /* NULL without */
	const double *uv_next, *uv_prev; /* set where side is */
	int next, prev;                  /* the points of the edges' ends */
	int has_uv;
	int side; /* +1 or -1, the sign of det; 0 without ps and pt */
	const double *normal, *tangent; /* the file's, or NULL */
	struct frame_item *head; /* of its group, while there are groups */
};

/* An edge that leaves the point, of an item: to its next or previous point. */
struct frame_spoke {
	int other;
	bool is_next;
	struct frame_item *item;
};

/* What a thread works with: scratch for the point with most corners, or for a
 * batch of points; and counts. */
struct frame_bench {
	struct frame_item *items, **order;
	struct frame_spoke *spokes; /* two for each corner */
	struct frame_batch *batch;
	size_t normal_none, tangent_none, mirror_mixed, flat_uvs;
};

struct frame_job {
	const struct bake_mesh *mesh;
	const struct bake_points *pts; /* with sites */
	const struct bake_frame_params *params;
	struct bake_frames *frames;
	/* set by bake_frame_start */
	bool has_file_vectors;
	void (*corners)(struct frame_batch *b, int n);
	int nbenches;
	struct frame_bench *benches;
};

enum bake_status bake_frame_check(const struct bake_mesh *mesh,
    const struct bake_frame_params *params, struct bake_err *err);
/* Scratch for so many threads; whatever it returns, bake_frame_end frees it and
 * adds the counts. */
enum bake_status bake_frame_start(
    struct frame_job *job, int nthreads, struct bake_err *err);
void bake_frame_end(struct frame_job *job);
/* All frames of the points from first to before end. */
void bake_frame_points(const struct frame_job *job, size_t first, size_t end,
    struct frame_bench *bench);
/* The sums of a point from the n items of bench, in an order of their values,
 * into all their frames, but for what bake_frame_finish does; normal is out. */
void bake_frame_items(const struct frame_job *job, int n,
    const struct frame_bench *bench, double normal[3]);
/* What the file says of the frames of these items. */
void bake_frame_take_file(
    const struct frame_job *job, struct frame_item *const *items, int n);
/*
 * Group the items of one point: those of one UV, and those whose mapping goes
 * on in each other but for a translation. head is the same for all of a group;
 * items comes back in another order.
 */
void bake_frame_group(
    struct frame_item **items, int n, struct frame_spoke *spokes);
int bake_frame_compare_uv(
    const struct frame_item *a, const struct frame_item *b);
void bake_frame_sort(struct frame_item **items, int n,
    int (*compare)(const void *, const void *));
/* Then each frame: unit length, right angles, what to do without. normal is the
 * point's. */
void bake_frame_finish(struct bake_frame *f, const double normal[3]);

#endif
