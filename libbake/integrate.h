/* Depth from normals: least-squares integration by fast transforms. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_INTEGRATE_H
#define BAKE_INTEGRATE_H

#include "image.h"
#include "normal.h"

#ifdef __cplusplus
extern "C" {
#endif

struct bake_integrate_params {
	struct bake_wrap wrap;
	enum bake_slope_op op;
	double damping; /* lambda below, 0 .. 1; 0 = the exact inverse */
	int nthreads;   /* 0 = all processors */
};
#define BAKE_INTEGRATE_PARAMS_DEFAULT                                          \
	{                                                                      \
		{ false, false }, BAKE_SLOPE_CENTRAL, 0, 0                     \
	}

/*
 * The height map h, in texture widths, whose slopes fit a normal map's best:
 * with p = -nx/nz, q = -ny/nz and the operators Dx, Dy of
 * bake_normal_from_depth it minimises, over all texels,
 *     sum |W Dx h - p|^2 + |W Dy h - q|^2 + lambda W^2/4 (|Lx h|^2 + |Ly h|^2)
 * where Lx, Ly are the second differences f(i-1) - 2 f(i) + f(i+1). In the
 * basis of the (co)sine transforms, with Dx, Dy, Lx, Ly the transfer
 * functions of these operators, not of d/dx:
 *     H = (Dx* P + Dy* Q) / (W (|Dx|^2 + |Dy|^2 + lambda/4 (|Lx|^2 + |Ly|^2)))
 * Frequencies that neither Dx nor Dy sees (the mean; on a torus of even size
 * the checkerboards too) are 0, so h has mean 0. At lambda = 0 the normals of
 * a height map give that map back to rounding, up to those frequencies.
 *
 * Lambda: central differences hardly see the frequencies next to the
 * checkerboard, so at lambda = 0 the rounding noise of 8-bit normals comes out
 * there magnified, as a mesh pattern of texel size. lambda = 1 is the compact
 * Poisson equation (Simchony et al. 1990; forward differences of h against
 * averaged slopes), which never magnifies a high frequency but blurs details
 * of 2 to 4 texels. Take 0 for float or 16-bit normals made by the operator;
 * 0.03 for 8-bit ones made by it (on smooth relief it halves the roughness and
 * lowers the error too; edges of 2 texels lose 1 %); 0.3 for normals of unknown
 * origin, which as a rule another operator made: at 0 these show the mesh, up
 * to twice the relief's own range, at 0.3 they do not.
 *
 *   normal    [H][W] of 3 channels x, y, z, signed, y up; their length does
 *             not matter. z < 1e-3 |n| is raised to that, which limits slopes
 *             to 1000; z <= 0 or a value that is not finite cannot be a height
 *             field's and counts as flat
 *   params    never NULL. wrap: torus, or clamped per axis: the map is then
 *             continued as an even mirror image about the border (half-sample
 *             symmetric), which is what the clamped Dx, Dy mean, so that the
 *             inverse is exact up to the border
 *   height    out: [H][W], 1 channel, in texture widths, up is positive, mean
 *             0 to rounding; BAKE_IMAGE_INIT before, the caller frees it
 *   nlimited  out: texels whose slope was limited or taken as flat; may be
 *             NULL
 *   err       reason on failure; never NULL
 *
 * BAKE_EINVAL  normal is not of 3 channels, damping not in 0..1, unknown op
 * BAKE_ENOMEM  scratch memory, 16 bytes a texel beyond normal; on any failure
 *              height stays BAKE_IMAGE_INIT
 *
 * Should FFTW itself run out of memory for a plan, it ends the process: that
 * is a few rows' worth.
 *
 * Reentrant (FFTW's planner is entered under a lock that all callers of this
 * function share; a program that plans with FFTW elsewhere at the same time
 * must hold it off). Same bytes for every thread count and instruction set:
 * FFTW is kept to its plain code, no wisdom is read or left behind.
 * Source: Frankot and Chellappa, 'A method for enforcing integrability in
 * shape from shading algorithms', PAMI 1988, eq. 21, with the discrete
 * operators' transfer functions; lambda and the mirror: own derivation.
 */
BAKE_API enum bake_status bake_integrate(const struct bake_image *normal,
    const struct bake_integrate_params *params, struct bake_image *height,
    size_t *nlimited, struct bake_err *err);

/*
 * The damping for normals of 8 bits: 0.03 where they are within a degree, on
 * average, of the normals of their own integral at lambda = 0, so that the
 * operator of params made them; 0.3 where another did (see above). Costs one
 * integration; params->damping is not looked at.
 *
 *   damping  out: unspecified on failure
 *
 * Errors, memory and threads as bake_integrate, with 16 bytes a texel more.
 */
BAKE_API enum bake_status bake_integrate_damping(
    const struct bake_image *normal, const struct bake_integrate_params *params,
    double *damping, struct bake_err *err);

/* bake_integrate with lambda = 0, nothing counted. */
BAKE_API enum bake_status bake_depth_from_normal(
    const struct bake_image *normal, struct bake_wrap wrap,
    enum bake_slope_op op, int nthreads, struct bake_image *height,
    struct bake_err *err);

/*
 * Turn a height map into a depth map, in place: depth = (max h - h) / scale,
 * so that the highest texel lies on the surface.
 *
 *   img      [H][W], 1 channel, finite; heights in texture widths before,
 *            depth 0 .. 1 after
 *   scale    in: 0 asks for the map's own scale: set to max h - min h, and
 *            the deepest texel is exactly 1. A flat map gets depth 0 and
 *            scale stays 0: the caller decides. In: > 0 is taken, and what
 *            would lie deeper than 1 is clipped to 1
 *   nclipped out: texels clipped; may be NULL
 *   err      reason on failure; never NULL
 *
 * BAKE_EINVAL  img is not of 1 channel, or *scale is negative or not finite
 * BAKE_EDATA   a height is not finite; on any failure img is unchanged
 *
 * Reentrant. Own derivation (METHODS 1 for h).
 */
BAKE_API enum bake_status bake_depth_from_height(struct bake_image *img,
    double *scale, size_t *nclipped, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
