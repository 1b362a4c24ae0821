/* Tangent frames of a mesh: normals, and tangents from UVs. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MESH_FRAME_H
#define BAKE_MESH_FRAME_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The weight of a triangle in the normal of one of its corners, e and f being
 * the edges that leave the corner and n = e x f / |e x f|:
 *   ANGLE  the angle between e and f: what a point's normal is does not depend
 *          on how flat faces are cut into triangles (Thuermer and Wuethrich,
 *          'Computing Vertex Normals from Polygonal Facets', 1998)
 *   AREA   |e x f|
 *   SPHERE |e x f| / (|e|^2 |f|^2), exact where all neighbours lie on a sphere
 *          (Max, 'Weights for Computing Vertex Normals from Facet Normals',
 *          1999)
 */
enum bake_normal_weight {
	BAKE_WEIGHT_ANGLE,
	BAKE_WEIGHT_AREA,
	BAKE_WEIGHT_SPHERE
};

/* Where normals come from. A corner for which the file has none, or (0, 0, 0),
 * gets a computed one under AUTO and FILE. */
enum bake_normal_source {
	BAKE_NORMALS_AUTO,    /* the file's, computed where it has none */
	BAKE_NORMALS_FILE,    /* the same, but an error if it has none at all */
	BAKE_NORMALS_COMPUTED /* from the triangles */
};

/* Where tangents come from. */
enum bake_tangent_source {
	BAKE_TANGENTS_UV,   /* from UVs */
	BAKE_TANGENTS_FILE, /* the file's, from UVs where it has none */
	BAKE_TANGENTS_AUTO  /* from UVs; any where there are none */
};

struct bake_frame_params {
	enum bake_normal_source normals;
	enum bake_tangent_source tangents;
	enum bake_normal_weight weight;
	int nthreads; /* 0 = all processors */
};
#define BAKE_FRAME_PARAMS_DEFAULT                                              \
	{                                                                      \
		BAKE_NORMALS_AUTO, BAKE_TANGENTS_UV, BAKE_WEIGHT_ANGLE, 0      \
	}

/*
 * What is known of one frame; bits of bake_frame.flags.
 *   NORMAL_FILE      the normal is the file's
 *   NORMAL_NONE      no triangle with an area: the normal is (0, 0, 1)
 *   TANGENT_FILE     the tangent is the file's
 *   TANGENT_NONE     no UVs, or no triangle here whose UVs have an area, or
 *                    dP/ds is along the normal: the tangent is any unit vector
 *                    at right angles to the normal, hand +1, ps and pt the
 *                    tangent and bitangent themselves
 *   MIRROR_MIXED     triangles with mirrored and with unmirrored UVs meet here
 */
enum {
	BAKE_FRAME_NORMAL_FILE = 1,
	BAKE_FRAME_NORMAL_NONE = 2,
	BAKE_FRAME_TANGENT_FILE = 4,
	BAKE_FRAME_TANGENT_NONE = 8,
	BAKE_FRAME_MIRROR_MIXED = 16
};

/*
 * The frame of one (position, UV): unit normal, unit tangent at right angles
 * to it, bitangent hand * normal x tangent; ps and pt the angle-weighted means
 * of dP/ds and dP/dt (bake_mesh_frames says of which triangles), in mesh units
 * per unit of u and v, not made orthogonal.
 */
struct bake_frame {
	int v, vt;
	int flags;
	int hand; /* +1 or -1 */
	double normal[3];
	double tangent[3];
	double ps[3], pt[3];
};

/*
 * The frames of a mesh, one for each pair (v, vt) that some triangle uses,
 * ascending by v, then by vt (-1 first).
 *   frame_of  [ntriangles] the frame of each corner
 *   counts of frames with each flag, and of triangles whose UVs have no area
 */
struct bake_frames {
	size_t nframes, ntriangles;
	struct bake_frame *frame;
	int (*frame_of)[3];
	size_t normal_none, tangent_none, mirror_mixed, flat_uv_triangles;
};
#define BAKE_FRAMES_INIT                                                       \
	{                                                                      \
		0                                                              \
	}

/*
 * The frames of a mesh.
 *
 * Normal, computed: N = normalize(sum of weight * n) over the triangles with an
 * area around the welded point, so that it is the same for all its UVs.
 * Normal, the file's: the mean of the normals of the corners that share (v,
 * vt), weighted by their angles.
 *
 * dP/ds, dP/dt of a triangle with edges e, f and UV edges (e_s, e_t), (f_s,
 * f_t), where |det| > 1e-12 times the product of the UV edges' lengths:
 *     det = e_s f_t - f_s e_t
 *     dP/ds = (e f_t - f e_t) / det,  dP/dt = (f e_s - e f_s) / det
 * Translating UVs does not change them. So Ps and Pt, their means by the
 * triangles' angles, are taken over all triangles around the welded point whose
 * mapping is the frame's but for a translation; two corners there are of one
 * mapping
 *   - if they have exactly the same UV, whatever index it has in the file, or
 *   - if their triangles share an edge that leaves the point, which these two
 *     alone use, in opposite directions; both dets are of one sign; and the
 *     edge is the same vector in both's UVs, but for a difference of at most
 *     2e-6 max(1, the largest |u|, |v| at its ends), which is what floats and
 *     files of six decimals leave, and at most 1/100 of its length,
 * and as far as a chain of such pairs leads. Hence a seam between charts that
 * go on in each other (u = 0 and 1 round a torus) leaves no trace: its two
 * frames differ in vt only. Where the UVs are turned, scaled or mirrored across
 * the seam, each side has a mean of its own. Where triangles of both
 * handednesses meet in one UV, those of the kind with the larger sum of angles
 * are taken (unmirrored on a tie).
 *
 * T = normalize(Ps - N (N . Ps)); hand = sign of (N x T) . Pt, which for flat
 * charts is that of det. The file's tangent: made orthogonal to N and unit
 * length; hand is the file's.
 *
 *   mesh    not modified
 *   weld    of the same mesh; NULL: every position is a point of its own
 *   adj     NULL; or of the same mesh, which then is checked but not needed
 *   params  see above
 *   frames  out: BAKE_FRAMES_INIT before, the caller frees it
 *   err     reason on failure; never NULL
 *
 * BAKE_EDATA   the mesh has no triangle; a position that a triangle uses is not
 *              finite; BAKE_NORMALS_FILE and it has no
 *              normals; BAKE_TANGENTS_UV or _FILE and it has no UVs at all (nor
 *              tangents, for _FILE): the message says so
 * BAKE_EINVAL  weld or adj is of another mesh
 * BAKE_ENOMEM  no memory; on any failure frames is BAKE_FRAMES_INIT
 *
 * Nothing in the result is NaN or infinite where positions and UVs are below
 * 1e100 in magnitude. Every sum is taken in an order of the values themselves,
 * so that the same geometry with its vertices or triangles in another order, or
 * a triangle's corners rotated, gives the same bits. Angles are computed with
 * sqrt and arithmetic only: same bits on every machine. Points are visited
 * along a Morton curve, so that time hardly depends on the file's order.
 * Memory beside the frames: about 200 bytes a position. Reentrant; same bytes
 * for every thread count.
 */
BAKE_API enum bake_status bake_mesh_frames(const struct bake_mesh *mesh,
    const struct bake_weld *weld, const struct bake_adjacency *adj,
    const struct bake_frame_params *params, struct bake_frames *frames,
    struct bake_err *err);

BAKE_API void bake_frames_free(struct bake_frames *frames);

/*
 * The angle between two vectors, 0 .. pi, in radians: within 4e-16, by sqrt and
 * arithmetic alone. 0 where one of them is 0. Reentrant.
 * Own derivation: 2 atan(|u|v| - v|u|| / |u|v| + v|u||) (Kahan, 'How Futile are
 * Mindless Assessments of Roundoff', 2006, section 12), atan by halving its
 * argument's angle twice and the Taylor series.
 */
BAKE_API double bake_angle_rad(const double u[3], const double v[3]);

#ifdef __cplusplus
}
#endif

#endif
