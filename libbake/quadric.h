/* Quadrics that osculate a mesh at its vertices, for relief silhouettes. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_QUADRIC_H
#define BAKE_QUADRIC_H

#include "mesh.h"
#include "mesh_frame.h"
#include "parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is fitted to the neighbours (x, y, z) of a vertex:
 *   FULL  z = d x + e y + a x^2 + c x y + b y^2, and with order 3 the terms
 *         x^3, x^2 y, x y^2, y^3, which are not reported
 *   AB    z = a x^2 + b y^2, the papers' literal fit */
enum bake_quadric_model { BAKE_QUADRIC_FULL, BAKE_QUADRIC_AB };

/* Which way a quadric bends where its coefficients are positive.
 *   DEPTH    z points into the surface: a, b > 0 where it is convex
 *   OUTWARD  z points out of it */
enum bake_quadric_sign { BAKE_QUADRIC_DEPTH, BAKE_QUADRIC_OUTWARD };

enum {
	BAKE_QUADRIC_RING_MAX = 8,
	/* the ring that is grown to where neighbours do not determine a fit */
	BAKE_QUADRIC_RING_GROWN = 4,
	/* neighbours of one vertex, or of one fit, beyond which some are left
	 * out: what keeps a fan of a million triangles linear */
	BAKE_QUADRIC_VALENCE_MAX = 128,
	BAKE_QUADRIC_NEIGHBOURS_MAX = 1024
};

/*
 *   model, sign  see above
 *   order        2 or 3, for FULL
 *   ring         edges from the vertex to the farthest neighbours, 1 ..
 *                BAKE_QUADRIC_RING_MAX; 0 is 2 for FULL, 1 for AB, and with
 *                order 3 it is 3 for vertices of a boundary and their direct
 *                neighbours
 *   depth_scale  S, depth range / texture width, > 0
 *   depth        depth range in mesh units, > 0; 0: S * |dP/ds| at each vertex
 *   creases      find creases, too (BAKE_QUADRIC_CREASE): takes more time
 *   nthreads     0 = all processors
 */
struct bake_quadric_params {
	enum bake_quadric_model model;
	enum bake_quadric_sign sign;
	int order, ring;
	double depth_scale, depth;
	bool creases;
	int nthreads;
	struct bake_progress progress;
};
#define BAKE_QUADRIC_PARAMS_DEFAULT                                            \
	{                                                                      \
		BAKE_QUADRIC_FULL, BAKE_QUADRIC_DEPTH, 2, 0, 0.1, 0, false, 0, \
		{                                                              \
			NULL, NULL                                             \
		}                                                              \
	}

/*
 * Bits of bake_quadric.flags.
 *   BOUNDARY   the point is on an edge of one triangle
 *   CREASE     two triangles at one of the point's edges differ by more than
 *              60 degrees, or frames of the point by more than 1 degree in
 *              their normals (only with params.creases)
 *   GROWN      a larger ring than asked for was needed
 *   LOWERED    fewer terms than asked for could be fitted
 */
enum {
	BAKE_QUADRIC_BOUNDARY = 1,
	BAKE_QUADRIC_CREASE = 2,
	BAKE_QUADRIC_GROWN = 4,
	BAKE_QUADRIC_LOWERED = 8
};

/*
 * The quadric of one frame. With x along the tangent, y along the bitangent
 * hand * (N x T), and z by the sign,
 *     z = a x^2 + b y^2 + c x y                [a, b, c: 1/length of the mesh]
 * in texture coordinates s, t and depth as a share of the depth range D,
 *     z / D = a_tex s^2 + b_tex t^2 + c_tex s t
 *   uvscale    |dP/ds|, |dP/dt|: mesh units per texture width and height
 *   residual   root mean square of z - fit over the neighbours, in mesh units
 *   rank       how many terms were fitted: 9 or 5 (FULL), 2 (AB), 1 (z = a (x^2
 *              + y^2)) or 0 (nothing: a = b = c = 0)
 *   ring       that was used
 *   neighbours that were used
 */
struct bake_quadric {
	double a, b, c;
	double a_tex, b_tex, c_tex;
	double uvscale[2];
	double residual;
	int rank, ring, neighbours, flags;
};

/*
 * Fit a quadric to the surface around every frame.
 *
 * Neighbours are points of space, found across UV seams by their welded
 * positions: all but the point itself within ring edges. x = T . (q - p),
 * y = B . (q - p), z = -N . (q - p); unit weights, least squares. From the fit
 * of FULL follow the normal curvatures of the fitted surface in the directions
 * of x and y, halved, whatever its slope d, e at p: with
 * g = (1 + d^2 + e^2)^-1/2
 *     a <- a g / (1 + d^2),  b <- b g / (1 + e^2),
 *     c <- c g / sqrt((1 + d^2) (1 + e^2))
 * so that errors of N, which are of first order, leave a and b alone. A sphere
 * of radius R has a = b = 1/(2R), c = 0.
 *
 * The normal equations are solved as L D L^T in double, in coordinates relative
 * to p and scaled by a power of two; a fit counts as determined where every
 * pivot is at least 1e-6 of its diagonal element, i.e. no term is explained by
 * those before it to more than 1 part in 1000: then the solution has 9 digits
 * at the least, and 13 on ordinary meshes. Else the ring grows up to
 * BAKE_QUADRIC_RING_GROWN; then, with order 3, the cubic terms go and the ring
 * begins anew; then z = a (x^2 + y^2), a = sum z r^2 / sum r^4; then 0. A frame
 * without a normal (BAKE_FRAME_NORMAL_NONE) gets 0. Heights that are below the
 * rounding of the coordinates, |a| r^2 < 2^-47 max(|p|, r) with r^2 the mean of
 * x^2 + y^2, count as 0, so that a plane in any position gives exactly 0.
 * Nothing in the result is NaN or infinite.
 *
 *   a_tex etc.: Q_t = J^T Q J / D with J = [Ps.T Pt.T; Ps.B Pt.B], Q = [a c/2;
 *   c/2 b], D = depth or depth_scale * |Ps|. For orthogonal UVs that is
 *   a |Ps|^2 / D and b |Pt|^2 / D.
 *
 *   mesh    not modified
 *   weld    of the same mesh; NULL: every position is a point of its own
 *   frames  of the same mesh (bake_mesh_frames), or made by hand: any number,
 *           in any order
 *   out     out: [frames->nframes], caller's memory
 *   err     reason on failure; never NULL
 *
 * BAKE_EINVAL  params out of range; weld is of another mesh; a frame's v is not
 *              a position
 * BAKE_EDATA   a position that a triangle uses is not finite
 * BAKE_ENOMEM  no memory; on any failure out is unspecified
 *
 * Points are visited along a Morton curve, and neighbours in an order that
 * follows from positions alone: the same geometry with its vertices or
 * triangles in another order gives the same bits, as do any number of threads
 * and any instruction set. Memory: about 200 bytes a position and 4 more a
 * thread. Reentrant.
 *
 * Sources: Oliveira and Policarpo, 'An Efficient Representation for Surface
 * Details', UFRGS RP-351, 2005 (the two-term fit); Cazals and Pouget,
 * 'Estimating differential quantities using polynomial fitting of osculating
 * jets', 2003 (orders of convergence); the slope correction is the second
 * fundamental form over the first, do Carmo 3.3.
 */
BAKE_API enum bake_status bake_quadric_fit(const struct bake_mesh *mesh,
    const struct bake_weld *weld, const struct bake_frames *frames,
    const struct bake_quadric_params *params, struct bake_quadric *out,
    struct bake_err *err);

/*
 * The frames of a mesh and a quadric for each, in one go: the same, bit for
 * bit, as bake_mesh_weld(eps), bake_mesh_frames and bake_quadric_fit one after
 * the other, but the mesh is put in order once, for all of them.
 *
 *   mesh    not modified
 *   eps     welding distance, as for bake_mesh_weld
 *   frame_params  as for bake_mesh_frames; its nthreads does not count, that of
 *           params does
 *   frames  out: BAKE_FRAMES_INIT before, the caller frees it
 *   out     out: [frames->nframes], the caller frees it with free()
 *   err     reason on failure; never NULL
 *
 * BAKE_EINVAL, BAKE_EDATA, BAKE_ENOMEM as these three have it; on any failure
 * frames is BAKE_FRAMES_INIT and *out NULL
 *
 * Reentrant; same bytes for any number of threads. Memory beside the results:
 * about 200 bytes a position, and 4 more a thread.
 */
BAKE_API enum bake_status bake_quadric_fit_mesh(const struct bake_mesh *mesh,
    double eps, const struct bake_frame_params *frame_params,
    const struct bake_quadric_params *params, struct bake_frames *frames,
    struct bake_quadric **out, struct bake_err *err);

enum { BAKE_QUADRIC_NPERCENTILES = 5 };

/*
 * What a set of quadrics is like.
 *   lo, hi    ranges of a, b, c (fields 0 .. 2) and of uvscale (3, 4)
 *   rank      how many have rank r
 *   residual  the 50th, 90th, 99th and 99.9th percentile, and the largest: the
 *             value at index ceil(p n) - 1 of the sorted residuals
 */
struct bake_quadric_stats {
	size_t n;
	double lo[5], hi[5];
	size_t rank[10];
	size_t grown, lowered, boundary, crease;
	double residual[BAKE_QUADRIC_NPERCENTILES];
};

/* The percentiles, as they are printed: 50, 90, 99, 99.9, 100. */
BAKE_API extern const double
    bake_quadric_percentiles[BAKE_QUADRIC_NPERCENTILES];

/*
 * Count them. Of no quadrics, all is 0.
 *
 * BAKE_ENOMEM  no memory to sort the residuals; stats is all 0
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_quadric_count(const struct bake_quadric *q,
    size_t n, struct bake_quadric_stats *stats, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
