/* Ambient occlusion of a height field from its horizons. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_AO_H
#define BAKE_AO_H

#include "image.h"
#include "parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

enum bake_ao_estimator {
	BAKE_AO_POLYGON, /* psa / regular n-gon: sum r_j r_(j+1) / n */
	BAKE_AO_MEAN	 /* sum r_j^2 / n */
};

enum bake_ao_quality { BAKE_AO_EXACT, BAKE_AO_FAST, BAKE_AO_PREVIEW };

enum bake_ao_blur {
	BAKE_AO_BLUR_NONE,
	BAKE_AO_BLUR_PAPER,   /* Gaussian mean of all, at occluded texels */
	BAKE_AO_BLUR_OCCLUDED /* Gaussian mean of occluded texels, there */
};

struct bake_ao_params {
	int ndirs;	/* directions phi_j = 2 pi j / ndirs, 3 .. 1024 */
	double radius;	/* reach in texture widths; 0: by periods */
	int periods;	/* reach in periods of the ray's major axis, >= 1 */
	struct bake_wrap wrap;
	enum bake_ao_estimator estimator;
	enum bake_ao_quality quality;
	enum bake_ao_blur blur;
	double blur_sigma; /* texels */
	int nthreads;	   /* 0 = all processors */
	struct bake_progress progress;
};
#define BAKE_AO_PARAMS_DEFAULT                                                 \
	{                                                                      \
		50, 0, 1, { false, false }, BAKE_AO_POLYGON, BAKE_AO_EXACT,    \
		    BAKE_AO_BLUR_PAPER, 1.0, 0, { NULL, NULL }                 \
	}

/* Where the results go; each image is BAKE_IMAGE_INIT before and belongs to
 * the caller after success. bent and horizons may be NULL: not wanted. */
struct bake_ao_result {
	struct bake_image *ao;	     /* [nscales], 1 channel, 0 .. 1 */
	struct bake_image *bent;     /* [nscales], 3 channels, unit x y z, y up */
	struct bake_image *horizons; /* [nscales], ndirs channels, tan e_j */
};

BAKE_API enum bake_status bake_ao(const struct bake_image *depth,
    const double *scales, int nscales, const struct bake_ao_params *params,
    const struct bake_ao_result *result, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
