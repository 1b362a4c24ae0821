/* Relief in the curved shell below a mesh: the reference for silhouettes. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_SHELL_MARCH_H
#define BAKE_SHELL_MARCH_H

#include "march.h"
#include "mesh_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The shell of a mesh: the points
 *     X(i, b, z) = sum_k b_k (P_k - z D N_k),  0 <= z <= 1
 * with P_k the corners of triangle i, N_k the unit normals there, D the depth
 * range in mesh units. A relief d(u, v) makes the surface z = d(u, v) in it,
 * with u, v = sum_k b_k (u_k, v_k): the geometry displaced inwards, exactly, on
 * the mesh as it is.
 *
 * The shell of one triangle is a prism, whose sides b_k = 0 are ruled surfaces
 * (bilinear patches). It goes on in the prism of the triangle beyond the edge
 * if just these two have the edge, in opposite directions, and their normals
 * at both of its ends are the same within 1e-3 (length of the difference).
 * Elsewhere, on the mesh's boundary, at creases (a cube with a normal for each
 * face), at edges with three triangles or turned ones, the shell has an end: a
 * wall that is open, through which rays leave without a hit.
 *
 * It is never changed once it is open: any number of threads may use it.
 */
struct bake_shell;

/*
 * Make it: which prisms touch. 12 bytes a triangle; nothing is copied.
 *
 *   shell   out: the caller's, freed by bake_shell_close; NULL on failure
 *   mesh    must outlive the shell, and not change
 *   weld    of the same mesh, must outlive it: points are where their
 *           representative is. NULL: every position is a point of its own
 *   frames  of the same mesh, must outlive it: N_k is the normal of the frame
 *           of triangle i's corner k; nothing else of it is used
 *   depth   D > 0, mesh units. Where it is more than the mesh's radius of
 *           curvature, prisms turn inside out (are folded)
 *   tile_u, tile_v  > 0: how often the relief is repeated over u and v 0 .. 1
 *   nthreads  0: all processors; the same result for each
 *
 * BAKE_EDATA   the mesh has no UVs. Of a mesh with some, corners without have
 *              (0, 0)
 * BAKE_EINVAL  depth or a tile factor is not finite or not above 0; weld or
 *              frames is of another mesh
 * BAKE_ENOMEM  no memory
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_shell_open(struct bake_shell **shell,
    const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_frames *frames, double depth, double tile_u,
    double tile_v, int nthreads, struct bake_err *err);
BAKE_API void bake_shell_close(struct bake_shell *shell); /* NULL: ok */

/*
 * Where a ray meets the relief.
 *   t         from the origin, in lengths of dir; < 0 (-1): nowhere, then
 *             triangle is -1 and the others are 0
 *   triangle, b1, b2  the prism, weights of corners 1 and 2
 *   z         depth there, 0 .. 1
 *   u, v      the relief's: the triangle's UVs times the tile factors
 */
struct bake_shell_hit {
	double t;
	int triangle;
	double b1, b2, z, u, v;
};

/*
 * Follow one ray, origin + t dir, t >= 0, through the shell from where it
 * enters it: on triangle `triangle`, at depth 0. In each prism z and b follow
 * from t; they are found to rounding, so that a hit is on the ray within some
 * 1e-13 of its distance. f = z - d is looked at cell by cell of the map (d is
 * bilinear between texel centres), and its first root is refined to double
 * precision. In a cell f is taken as a parabola to see whether it comes above 0
 * between two borders, which it is where normals are parallel: there the hit is
 * that of bake_march's EXACT. Elsewhere what may be missed is an edge that is
 * touched on much less than a texel.
 *
 * The ray ends
 *   - where f >= 0: a hit, at t = 0 if it starts below the relief. This may be
 *     on a wall, where u, v are not the same on both sides of an edge
 *   - at the bottom, z = 1, which is solid: a hit there, at z = 1. (d <= 1
 *     makes all hits lie on the relief; this is for maps that are deeper)
 *   - where the prism is folded: a hit, the bottom must have been near
 *   - where it leaves through depth 0 again: a miss. If it enters the shell
 *     elsewhere, that is by another triangle that it meets from outside: the
 *     caller's next fragment
 *   - over a boundary or crease, as above: a miss
 *   - after 65536 prisms: a miss. After 2^22 cells of the map, or many more in
 *     one prism than it has, the rest of the way through each prism is looked
 *     at as if it were one cell
 * Triangles without area (less high than 1e-12 of their longest edge) are
 * passed through; a ray cannot start on one.
 *
 *   map       the relief, d(u, v) with the tile factors of the shell
 *   triangle  0 .. ntriangles - 1; else a miss
 *   b1, b2    weights of corners 1 and 2 where the ray enters. They need only
 *             be finite: the place is that of origin
 *   origin    the point there; a rounding to float does no harm
 *   dir       any length but 0, t is in units of it. What is not finite: a miss
 *   hit       out
 *
 * Reentrant. Source: the shell is that of Porumbescu, Budge, Feng and Joy,
 * 'Shell Maps', 2005, in its general form; the solution for z by level
 * triangles is an own derivation, shell_march_priv.h. METHODS 4 and 6.
 */
BAKE_API void bake_shell_march(const struct bake_shell *shell,
    const struct bake_relief_map *map, int triangle, double b1, double b2,
    const double origin[3], const double dir[3], struct bake_shell_hit *hit);

/*
 * Whether a ray that starts in the shell meets the relief before it leaves the
 * shell: shadows. 1 where it is more than 1e-7 of D below the relief anywhere
 * on its way, or reaches the bottom; else 0, also if it leaves through depth 0
 * or over a boundary, or from is no hit.
 *
 *   from  a hit of this shell and map (or any triangle, b1, b2 and z)
 *   dir   towards the light
 *
 * Otherwise as bake_shell_march. Reentrant.
 */
BAKE_API int bake_shell_march_any(const struct bake_shell *shell,
    const struct bake_relief_map *map, const struct bake_shell_hit *from,
    const double dir[3]);

#ifdef __cplusplus
}
#endif

#endif
