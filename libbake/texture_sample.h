/* Looking a picture up, filtered over an elliptical footprint. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_TEXTURE_SAMPLE_H
#define BAKE_TEXTURE_SAMPLE_H

#include "image.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

struct bake_sampler; /* a picture and its pyramid */

/*
 * Make a picture ready.
 *
 * Level 0 of the pyramid is the picture itself, W x H; level k + 1 has
 * max(1, floor(w / 2)) x max(1, floor(h / 2)) texels where level k has w x h,
 * down to 1 x 1. Each of its texels is the mean, by area, of the part of level
 * k that it covers: the parts are all of one size and fill the picture without
 * gap or overlap, so that the mean of every level is the picture's, and the
 * pyramid is right for every wrap. (An odd w = 2 m + 1 gives texel x the texels
 * 2 x, 2 x + 1 and 2 x + 2 with weights m - x, m and x + 1 over w.)
 *
 *   img      finite values, 1 to 4 channels; colours in scene-linear light.
 *            The last of 2 or 4 channels is alpha, which is not multiplied into
 *            the others. Must outlive the sampler, and stay as it was
 *   opaque   alpha has no meaning: it is left out, a lookup has 1 or 3 values
 *   nthreads 0 = all processors
 *   sampler  out: the caller closes it; NULL on failure
 *
 * Alpha: in the pyramid as in lookups colours are weighted by alpha as well,
 *     c = sum w a c / sum w a,  a = sum w a / sum w
 * so that what is transparent has no say in the colour; where all alpha is 0
 * (or sum w a is not positive) c is the mean by w alone.
 *
 * Memory: a third of the picture's, in floats.
 *
 * BAKE_EINVAL  no texel, or more than 4 channels
 * BAKE_ENOMEM  no memory
 *
 * The same bytes for every nthreads.
 * Source: Williams, 'Pyramidal parametrics', SIGGRAPH 1983; odd sizes as in
 * Guthe and Heckbert, 'Non-power-of-two mipmap creation', NVIDIA 2005.
 */
BAKE_API enum bake_status bake_sampler_open(struct bake_sampler **sampler,
    const struct bake_image *img, bool opaque, int nthreads,
    struct bake_err *err);
/* Harmless on NULL. */
BAKE_API void bake_sampler_close(struct bake_sampler *sampler);

/* How many values a lookup gives: the picture's channels, without alpha where
 * it is opaque. */
BAKE_API int bake_sampler_nchans(const struct bake_sampler *sampler);

/*
 * Where to look: the point (u, v), and how far (u, v) goes with one texel's
 * step to the right (u_x, v_x) and down (u_y, v_y) in the picture that is being
 * made. (0, 0) is the texture's lower left corner and (1, 1) its upper right
 * one: texel (i, j)'s centre is at ((i + 1/2) / W, 1 - (j + 1/2) / H).
 */
struct bake_lookup {
	double u, v;
	double u_x, v_x, u_y, v_y;
	enum bake_tex_wrap wrap_u, wrap_v;
};

/*
 * Look up. In texels of the picture the footprint is the ellipse of the points
 * J (cos t, sin t), J = (W u_x, W u_y; -H v_x, -H v_y), its half axes R >= r
 * the singular values of J; it takes in one texel's step in every direction.
 *
 *   R <= 1      bilinear interpolation of the 4 nearest texels
 *   R >= 2      the mean with weights (1 - q)^2 over the texels of a level
 *               with q < 1, q = d^T M^-1 d, d from (u, v) to the texel's
 *               centre
 *   between     both, mixed by R - 1
 *
 * (1 - q)^2 on an ellipse with matrix M has the covariance M / 8. M is such
 * that the kernel, the level's boxes and the tent that bilinear interpolation
 * is have together the covariance J J^T / 8 + I / 6, at every level alike:
 *     M = S^-1 (J J^T) S^-1 + 2 S^-2 - 2/3 I,  S = diag(W / w, H / h)
 * for a level of w x h texels, its smaller eigenvalue raised to 4/3 where it is
 * less, so that there is always a texel. So, where the kernel is sampled
 * finely enough, a lookup is the integral of the bilinear texture with weights
 * (1 - |J^-1 d|^2)^2, exactly for pictures that are polynomials of second
 * degree. For a step of one texel that kernel's transform, 48 J_3(k) / k^3, is
 * 0.5 at half the sampling rate and has its first zero (k = 6.38) next to the
 * sampling rate itself (2 pi): what would turn up as a false flat colour is
 * gone.
 *
 * The level is the coarsest with r >= 1.5 of its texels, but coarse enough for
 * R < 24: at most about 250 texels are summed up. Ellipses longer than about
 * 10 times their width are widened (the raised eigenvalue), the picture blurred
 * across them, as far as that takes. Footprints with r of 1.5 times the
 * texture's longer side or more, or that are not finite, give the picture's
 * mean. An axis of which a level has 1 texel is constant along it.
 *
 *   value  out: bake_sampler_nchans values, scene-linear
 *
 * u and v may be anything: NaN and, but for BAKE_TEX_CLAMP, what is beyond 1e15
 * (where doubles are too far apart to tell a place in a period) are taken as
 * some place; beyond +-1e6 is taken as that under BAKE_TEX_CLAMP. A constant
 * picture gives its bits. Arithmetic is in double with +, -, *, / and sqrt
 * alone, in a fixed order: the same bits on every machine. Threads may look up
 * at once.
 *
 * Sources: Greene and Heckbert, 'Creating raster omnimax images from multiple
 * perspective views using the elliptical weighted average filter', IEEE CG&A
 * 1986; Heckbert, 'Fundamentals of texture mapping and image warping', 1989,
 * section 3.5. The kernel and matching the levels' covariances: own derivation
 * (a texel's tent has variance 1/6, the mean of s texels adds (s^2 - 1) / 12).
 */
BAKE_API void bake_sampler_read(const struct bake_sampler *sampler,
    const struct bake_lookup *at, float *value);

#ifdef __cplusplus
}
#endif

#endif
