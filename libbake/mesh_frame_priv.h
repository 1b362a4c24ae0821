/* What the frames' parts share: sums around points. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MESH_FRAME_PRIV_H
#define BAKE_MESH_FRAME_PRIV_H

#include "mesh_frame.h"

/* Heights below this part of the longest edge, areas below this part of the
 * product of the edges: no direction. */
#define FLAT 1e-12

#define BAKE_FRAME_PI 3.14159265358979323846

/*
 * Corners side by side, for the kernel.
 *   e, f, uv_e, uv_f  edges to the next and to the previous corner, in space
 *                     and in UVs (all 0 where there are none)
 *   wn, angle, ps, pt, side  out, as in frame_item
 */
enum { BAKE_FRAME_BATCH = 64 }; /* a multiple of every set's lanes */
struct frame_batch {
	double e[3][BAKE_FRAME_BATCH], f[3][BAKE_FRAME_BATCH];
	double uv_e[2][BAKE_FRAME_BATCH], uv_f[2][BAKE_FRAME_BATCH];
	double wn[3][BAKE_FRAME_BATCH], angle[BAKE_FRAME_BATCH];
	double ps[3][BAKE_FRAME_BATCH], pt[3][BAKE_FRAME_BATCH];
	double side[BAKE_FRAME_BATCH];
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

struct frame_job {
	const struct bake_mesh *mesh;
	const struct bake_weld *weld;
	const struct bake_adjacency *adj;
	const struct bake_frame_params *params;
	struct bake_frames *frames;
	double (*point_normal)[3];
	void (*corners)(struct frame_batch *b, int n);
};

/* Scratch of one thread: for the point with most corners, or for a batch of
 * points. */
struct frame_bench {
	struct frame_item *items, **order;
	struct frame_spoke *spokes; /* two for each corner */
	struct frame_batch *batch;
};

/*
 * A mesh in another order: positions along Morton's curve, triangles by their
 * first position, UVs by their first use; and where each was in the file.
 */
struct frame_copy {
	struct bake_mesh mesh; /* normals and tangents are the file's */
	struct bake_weld weld;
	int *position, *uv, *triangle;
};

/* Whether a mesh, most of it, has near each other what is used together. */
bool bake_frame_is_local(const struct bake_mesh *m);
/* On failure, too, the caller frees it. */
enum bake_status bake_frame_copy(const struct bake_mesh *m,
    const struct bake_weld *weld, struct frame_copy *to, struct bake_err *err);
void bake_frame_copy_free(struct frame_copy *c);
/* From the copy's frames, whose v and vt change, to the file's. */
enum bake_status bake_frame_put_back(const struct frame_copy *c,
    struct bake_frames *from, struct bake_frames *to, struct bake_err *err);

/* All that is summed around points from first to before end: their normals,
 * and the frames' own parts. */
void bake_frame_points(const struct frame_job *job, int first, int end,
    const struct frame_bench *bench);
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
/* Then each frame: unit length, right angles, what to do without. */
void bake_frame_finish(const struct frame_job *job, struct bake_frame *f);

#endif
