/* Ambient occlusion after the depth scale has changed. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_AO_RESCALE_H
#define BAKE_AO_RESCALE_H

#include "ao.h"
#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The AO that a texel has once its relief is s times as deep,
 *     AO' = AO / (s^2 (1 - AO) + AO)
 * with r^2 = AO the open disc's radius, H^2 = 1 - r^2 the rim's height:
 * R'^2 = (s H)^2 + r^2, AO' = r^2 / R'^2.
 *
 *   ao  0 .. 1; beyond, the nearest of the two; a NaN stays one
 *   s   new depth scale / old one, >= 0; where s^2 underflows, as 0
 *
 * s = 1 is the identity, bit for bit; s = 0 gives 1, also where AO = 0 (0/0 is
 * 1: a plane is open); AO = 1 stays 1; AO = 0 stays 0 for s > 0. In AO it
 * rises, in s it falls. s and then t is s t: rescaling by 1 / s goes back.
 * Computed in double and rounded once: within half a unit in the last place of
 * the formula, and 1 ulp of double.
 *
 * It is exact where the horizon has the same elevation all round, a guess
 * elsewhere: at the foot of a wall so high that half of the sky is gone, AO is
 * 1/2 at every depth scale, and s = 4 gives 1/17 = 0.06. The guess is
 * one-sided: AO' is convex in AO for s > 1 and concave for s < 1, so that of
 * the mean of cos^2 e_j (BAKE_AO_MEAN) it is at most, or at least, the mean of
 * what each direction becomes, by Jensen: too dark where the relief grows
 * deeper, too bright where it grows flatter.
 *
 * The curve's slope lies between s^2 and 1/s^2: half a code lost in the result
 * is as much as half the larger of the two, in codes, on the way back.
 *
 * Reentrant; the same bits on every machine.
 * Source: Limberger, Schetinger, Oliveira, "Meta-Relief Texture Mapping with
 * Dynamic Texture-Space Ambient Occlusion", eq. 4 to 6.
 */
BAKE_API float bake_ao_rescale(float ao, double s);

/*
 * bake_ao_rescale on every texel of one channel, in place; other channels are
 * not touched.
 *
 *   img       any number of channels, 0 <= chan < img->nchans
 *   s         0 .. 1e6
 *   nthreads  0 = all processors
 *
 * BAKE_EINVAL  a parameter out of its range, img has no texels; img unchanged
 *
 * Reentrant; the same bytes for every nthreads.
 */
BAKE_API enum bake_status bake_ao_rescale_image(struct bake_image *img,
    int chan, double s, int nthreads, struct bake_err *err);

/* How the horizons of a texel become one number; as in bake_ao_params. */
struct bake_ao_rescale_params {
	enum bake_ao_estimator estimator;
	enum bake_ao_blur blur;
	double blur_sigma; /* texels, 0 .. 256; 0 is no blur */
	struct bake_wrap wrap;
	int nthreads; /* 0 = all processors */
};
#define BAKE_AO_RESCALE_PARAMS_DEFAULT                                         \
	{                                                                      \
		BAKE_AO_POLYGON, BAKE_AO_BLUR_PAPER, 1.0, { false, false }, 0  \
	}

/*
 * The exact answer, from the horizons of every texel: with e_j the horizon's
 * elevation in direction j,
 *     r_j' = 1 / sqrt(1 + s^2 tan^2 e_j)
 *     polygon: ao = sum_j r_j' r'_(j+1) / n     mean: ao = sum_j r_j'^2 / n
 * and then the blur of bake_ao. Horizons are never blurred but AO maps mostly
 * are: with the parameters that the map was baked with, this is what bake_ao
 * gives at s times the depth scale, but for the rounding of floats (2e-6 with
 * horizons kept as float, 2.5e-4 as half).
 *
 *   horizons  tan e_j, channel j, 3 to 1024 of them, as bake_ao makes them; a
 *             NaN or what is below 0 counts as 0, Inf as a closed direction
 *   s         new depth scale / that of the horizons, 0 .. 1e6; 0 gives 1
 *   ao        out: 1 channel, BAKE_IMAGE_INIT before and on failure, then the
 *             caller's
 *
 * BAKE_EINVAL  a parameter out of its range
 * BAKE_ENOMEM  no memory: 4 bytes a texel for ao, up to 9 more for the blur
 *
 * Reentrant; the same bytes for every nthreads.
 * Source: bake_ao; that a rescaled relief has s tan e is elementary.
 */
BAKE_API enum bake_status bake_ao_rescale_horizons(
    const struct bake_image *horizons, double s,
    const struct bake_ao_rescale_params *params, struct bake_image *ao,
    struct bake_err *err);

/* How far an AO map is from another one: of d = got - want, and |d|. */
struct bake_ao_error {
	double mean, max; /* of |d| */
	double p99;       /* smallest v with |d| <= v at 99 % of the texels */
	double bias;      /* mean of d: above 0, got is too bright */
	int x, y;         /* where max is, the first in reading order */
};

/*
 * The error of got, e.g. bake_ao_rescale_image's, against want, e.g.
 * bake_ao's. Both have 1 channel and are of one size; no value is a NaN.
 * Differences are rounded to float, means summed in double, row by row.
 *
 *   signed_error  out, or NULL: 1 channel, d; BAKE_IMAGE_INIT before and on
 *                 failure, then the caller's
 *
 * BAKE_EDATA   different sizes, or not 1 channel, or no texels
 * BAKE_ENOMEM  no memory: 1 MB, and 4 bytes a texel for signed_error
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_ao_compare(const struct bake_image *got,
    const struct bake_image *want, struct bake_ao_error *error,
    struct bake_image *signed_error, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
