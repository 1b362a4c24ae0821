/* The points of a mesh along a curve: what frames and fits work on. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MESH_POINTS_PRIV_H
#define BAKE_MESH_POINTS_PRIV_H

#include "mesh_frame.h"

/*
 * Whatever the order of a file, work goes along a Morton curve, where what is
 * near in space is near in memory: positions and triangles are put in this
 * order once, for adjacency, frames and fits together, and results go straight
 * to their place in the file's order.
 */

/* A point: two of them fill a cache line. start and flags are the fit's, see
 * quadric_priv.h. */
struct bake_point {
	double p[3]; /* position times scale */
	unsigned start;
	unsigned flags;
};

/*
 * A triangle of points, the lowest first. Four of them fill a cache line.
 *   corner  4 * triangle + k: the corner of the file that p[0] is at
 */
struct bake_point_triangle {
	unsigned p[3], corner;
};

/*
 * What a position is.
 *   point  the number of its point; -1 where no triangle uses it
 *   frame  its frame, or -1 - i where it has several, of which pair[i] is the
 *          first; BAKE_PLACE_SEVERAL, BAKE_PLACE_UNUSED or its vt until frames
 *          are numbered
 */
struct bake_place {
	int point, frame;
};
enum { BAKE_PLACE_UNUSED = -2, BAKE_PLACE_SEVERAL = -3 };

/* A frame, and what it is of; point -1: of none. */
struct bake_site {
	int frame, point, v, vt;
};

/*
 *   n, ntriangles    points that triangles use, numbered along the curve (ties
 *                    by their coordinates, which differ unless nothing was
 *                    welded), and triangles whose points differ, sorted
 *   scale            a power of two that brings half the largest coordinate
 *                    difference to 0.25 .. 0.5
 *   place            [mesh->npositions]
 *   point            [n + 1]
 *   triangle         [ntriangles]
 *   first, corner    the corners at point i: corner[first[i]] ..
 *                    corner[first[i + 1] - 1], each 4 * t + k for triangle[t]
 *   uv               [n] the UV of a point that has one frame, in u; NaN where
 *                    it has several or none
 *   room             [6 * mesh->ntriangles] for the fit
 *   seen             [2 * n] for the fit
 *   first_site, site the frames of point i: site[first_site[i]] ..
 *                    site[first_site[i + 1] - 1], those of no point first of
 *                    all. There is room for one a position
 */
struct bake_points {
	void *block; /* what the arrays but the sites are in */
	size_t n, ntriangles;
	double scale;
	struct bake_place *place;
	struct bake_point *point;
	struct bake_point_triangle *triangle;
	unsigned *first, *corner, *room, *seen;
	double (*uv)[2];
	int *first_site;
	struct bake_site *site;
	struct bake_site *own_sites; /* NULL where they are in the block */
};
#define BAKE_POINTS_INIT                                                       \
	{                                                                      \
		.scale = 1                                                     \
	}

/*
 * Make them.
 *   weld    what is one point; NULL: every position is a point of its own, or,
 *           with exact, those with equal coordinates are
 *   frames  NULL, or out, BAKE_FRAMES_INIT before: the frames there are get
 *           numbers and room, frame_of is filled, and so are the sites
 * On failure, BAKE_EDATA where a position that is used is not finite and
 * BAKE_ENOMEM, the caller frees both.
 */
enum bake_status bake_points_make(const struct bake_mesh *mesh,
    const struct bake_weld *weld, bool exact, struct bake_frames *frames,
    struct bake_points *points, struct bake_err *err);
void bake_points_free(struct bake_points *points);

/* Make room for n sites, and set first_site to 0. */
enum bake_status bake_points_room_for_sites(const struct bake_mesh *mesh,
    size_t n, struct bake_points *points, struct bake_err *err);

/*
 * A part of that: number the points along the curve. Those to be numbered have
 * point = 0, all others -1. Sets n, scale, place[].point, and the points' p.
 * one and two are scratch, each of BAKE_POINTS_STEP bytes for each position.
 */
enum { BAKE_POINTS_STEP = 16 };
enum bake_status bake_points_number(const struct bake_mesh *mesh, bool exact,
    void *one, void *two, struct bake_points *points, struct bake_err *err);

/* Another: list the frames, and give the places and sites their numbers. */
struct bake_frame_pair {
	int v, vt, frame;
};
enum bake_status bake_frames_number(const struct bake_mesh *mesh,
    struct bake_points *points, struct bake_frames *frames,
    struct bake_frame_pair **pairs, size_t *npairs, struct bake_err *err);

#endif
