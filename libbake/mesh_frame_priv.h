/* What the frames' parts share: sums around points. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MESH_FRAME_PRIV_H
#define BAKE_MESH_FRAME_PRIV_H

#include "mesh_frame.h"

/* Heights below this part of the longest edge, areas below this part of the
 * product of the edges: no direction. */
#define FLAT 1e-12

/* What a corner of a triangle adds at its point. */
struct frame_item {
	double wn[3]; /* weight * n; 0 without area */
	double angle; /* 0 without area */
	double area, ee, ff;
	struct bake_frame *frame;
	double ps[3], pt[3];
	double uv[2];
	int has_uv;
	int side; /* +1 or -1, the sign of det; 0 without ps and pt */
	const double *normal, *tangent; /* the file's, or NULL */
};

struct frame_job {
	const struct bake_mesh *mesh;
	const struct bake_weld *weld;
	const struct bake_adjacency *adj;
	const struct bake_frame_params *params;
	struct bake_frames *frames;
	double (*point_normal)[3];
};

/* Scratch of one thread, for the point with most corners. */
struct frame_bench {
	struct frame_item *items, **order;
	double *angle;
};

/* All that is summed around point p: its normal, and the frames' own parts. */
void bake_frame_point(
    const struct frame_job *job, int p, const struct frame_bench *bench);
/* Then each frame: unit length, right angles, what to do without. */
void bake_frame_finish(const struct frame_job *job, struct bake_frame *f);

#endif
