/* Marching multilayer relief: where rays meet a solid of slabs per texel. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MULTI_MARCH_H
#define BAKE_MULTI_MARCH_H

#include "layer_maps.h"
#include "march.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The depths and normals of a multilayer set made ready for marching. It is
 * never changed once it is open: any number of threads may use it.
 *
 * They are sampled at the nearest texel, as the paper does (section 6): texel
 * (x, y), row 0 at the top, is a square of places, x <= u W < x + 1 and
 * H - 1 - y <= v H < H - y, throughout which its depths hold. Between texels
 * the solid has walls.
 */
struct bake_multi_map;

/*
 * Copy a set: 22 bytes a texel, 12 for each layer.
 *
 *   map   out: the caller's, freed by bake_multi_map_close; NULL on failure
 *   maps  of which depth, nx and ny are read. Real depths d are marched, see
 *         bake_layer_depth; a texel's layers end as bake_layer_count says. Of
 *         an odd number (nlayers > 1; none that was closed) the last is left
 *         out; a height field (nlayers = 1) is solid from its layer on. Layers
 *         whose depths do not rise are put in order (equal depths stay as
 *         they are), and are counted in that order in what is hit
 *   wrap  beyond 0 .. 1: a torus; clamped: nothing is there
 *
 * The kernels' instruction set (isa.h) is chosen here.
 *
 * BAKE_EINVAL  nlayers is neither 1 nor even, or a side is outside 1 .. 2^22
 * BAKE_ENOMEM  no memory, or more than 2^32 layers
 *
 * Reentrant. The same for every nthreads (0: all processors).
 */
BAKE_API enum bake_status bake_multi_map_open(struct bake_multi_map **map,
    const struct bake_layer_maps *maps, struct bake_wrap wrap, int nthreads,
    struct bake_err *err);
/* Its size in texels. */
BAKE_API void bake_multi_map_size(
    const struct bake_multi_map *map, int *width, int *height);
BAKE_API void bake_multi_map_close(struct bake_multi_map *map); /* NULL: ok */

/*
 * What was hit, arrays [n] of any alignment, written where rays->hit >= 0 and
 * left alone elsewhere.
 *   nx, ny, nz  the layer's unit normal in the texture's frame, z towards depth
 *               0: as stored, z = +-sqrt(max(0, 1 - x^2 - y^2)), >= 0 for
 *               entries (even layers), <= 0 for exits
 *   layer       which layer, from 0; may be NULL
 *   u, v        the centre of the texel whose layer that is, 0 < u, v < 1, for
 *               looking up its colour; may be NULL. It can be a neighbour of
 *               that in which the hit lies, so it is not where the hit is
 */
struct bake_multi_hits {
	float *nx, *ny, *nz;
	int *layer;
	float *u, *v;
};

/*
 * First hits. A point is inside where an odd number of its texel's depths are
 * less than z (the product of z - d_i over all layers, 4 at a time in the
 * shader, is < 0 there; on an exit's depth itself it is 0, but inside).
 *
 *   rays    as in march.h; dz < 0 for those that come from behind. hit: t, in
 *           0 .. t_end, of the first place inside, as the search finds it; 0
 *           where the ray starts inside; -1 where there is none
 *   params  as in march.h, with these differences:
 *
 *   LINEAR  the paper's: t = 0, then n = nlinear equal steps of t up to the
 *           first that is inside, then nbinary halvings. Where `secant` is set
 *           and the ray came in through a depth of the texel inside, and not
 *           through its wall, hit is where a chord between the last places
 *           outside and inside reaches that depth; else it is the place
 *           inside. Misses what lies between two steps.
 *           Of the two texels the one with more layers (section 3.2; else that
 *           inside) gives the normal: of its layer that is nearest in depth.
 *   TEXEL   the same with n = the texels that the ray passes along its faster
 *           axis, rounded up, at least nlinear and at most 65536. A steep ray
 *           passes few: nlinear must still suit the thinnest slab
 *   EXACT   every texel that the ray passes in turn, in double, rounded to
 *           float: where the ray is inside when it enters the texel (its
 *           wall, or t = 0), else where it first comes to a depth. Blocks of
 *           8 x 8 texels are passed at once where the ray is before or behind
 *           all that they hold. A ray along a border is in the texel on its
 *           right, or above; one through a corner does not meet the two texels
 *           beside it. One that passes more than 2^24 texels is cut there. The
 *           other parameters are not used.
 *           A depth has its own layer's normal. A wall stands for a surface
 *           that joins layers of both texels, at depths p and r (the slab that
 *           is hit) and lo and hi (the gap before it, in the texel the ray
 *           came from):
 *             the slab goes on below hi  p or hi, the nearer to z
 *             it goes on above lo        r or lo, the nearer
 *             both                       lo or hi: a gap ends here, and only
 *                                        the other texel has its sides
 *             neither                    p or r: the slab ends here
 *           (two slabs go on in each other where they overlap in depth). So the
 *           more layers of section 3.2 decide where numbers differ, and no
 *           steep sheet takes the normal of its back. Starts inside, and walls
 *           at a clamped border, count as the last.
 *
 * Errors of the sampling: texels that stick out are all seen in a silhouette,
 * and EXACT sees every one. IoU of masks of 256 x 256 pixels with the solid
 * itself, through a box of 256 x 256 texels at yaw 0 .. 180 degrees in steps of
 * 15: torus 0.990 or more with EXACT, 0.992 with LINEAR 32,6; weave of 4 x 4
 * strands 0.982 and 0.991. What is too much is in proportion to a texel, and to
 * the outline's length over the area: 512 x 512 texels give the weave 0.991
 * with EXACT.
 *
 * Runs on the calling thread alone; threads may march different rays of one
 * map at once. The same bits for every instruction set, and for every way in
 * which rays are shared out among calls.
 *
 * Source: Policarpo and Oliveira, 'Relief Mapping of Non-Height-Field Surface
 * Details', 2006, sections 3.1 and 3.2, appendix A; EXACT and its walls: own
 * derivation.
 */
BAKE_API void bake_multi_march(const struct bake_multi_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays,
    const struct bake_multi_hits *hits);

/*
 * Whether anything is between t = skip and t_end (shadows). rays->hit: 1 where
 * one of the places that the search looks at (EXACT: any) is inside, else 0.
 * What the ray is inside of at the first of them does not count until it has
 * left it, so that rounding of its start does not put it in its own shadow.
 *
 *   skip  t up to which nothing counts; 0 or more. A smooth surface has stairs
 *         in the map, so that a ray along its slope runs into the next ones;
 *         a way of about two texels,
 *             skip = 2 / max(|du| W, |dv| H),
 *         keeps most of that away
 *
 * nbinary and secant are not used. Otherwise as bake_multi_march.
 * Source: the paper, section 3.1, light rays.
 */
BAKE_API void bake_multi_march_any(const struct bake_multi_map *map,
    const struct bake_march_params *params, float skip,
    const struct bake_rays *rays);

#ifdef __cplusplus
}
#endif

#endif
