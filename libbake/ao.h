/* Ambient occlusion, bent normals and horizons of a height field. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_AO_H
#define BAKE_AO_H

#include "image.h"
#include "parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How the horizons of a texel become one number; r_j = cos e_j. */
enum bake_ao_estimator {
	BAKE_AO_POLYGON, /* psa / regular n-gon: sum r_j r_(j+1) / n */
	BAKE_AO_MEAN     /* sum r_j^2 / n */
};

/*
 * How far every sample of a ray is looked at. Exact: all of it. Fast and
 * preview: the first 16 (8) steps as exact does; beyond, segments of doubling
 * length, each represented by its highest sample at one distance.
 */
enum bake_ao_quality { BAKE_AO_EXACT, BAKE_AO_FAST, BAKE_AO_PREVIEW };

/* The low-pass filter; each replaces only texels with a horizon above 0. */
enum bake_ao_blur {
	BAKE_AO_BLUR_NONE,
	BAKE_AO_BLUR_PAPER,   /* Gaussian mean of all, at occluded texels */
	BAKE_AO_BLUR_OCCLUDED /* Gaussian mean of occluded texels, there */
};

enum {
	BAKE_AO_DIRS_MIN = 3,
	BAKE_AO_DIRS_MAX = 1024,
	BAKE_AO_PERIODS_MAX = 64,     /* also the radius, texture widths */
	BAKE_AO_BLUR_SIGMA_MAX = 256, /* texels */
	BAKE_AO_SCALES_MAX = 64
};
#define BAKE_AO_SCALE_MAX 1e6 /* texture widths */

struct bake_ao_params {
	int ndirs;     /* n, directions phi_j = 2 pi j / n, 3 .. 1024 */
	double radius; /* reach in texture widths, <= 64; 0: by periods */
	int periods;   /* reach in periods of the major axis, 1 .. 64 */
	struct bake_wrap wrap;
	enum bake_ao_estimator estimator;
	enum bake_ao_quality quality;
	enum bake_ao_blur blur;
	double blur_sigma; /* texels, 0 .. 256; 0 is no blur */
	int nthreads;      /* 0 = all processors */
	struct bake_progress progress;
};
#define BAKE_AO_PARAMS_DEFAULT                                                 \
	{                                                                      \
		50, 0, 1, { false, false }, BAKE_AO_POLYGON, BAKE_AO_EXACT,    \
		    BAKE_AO_BLUR_PAPER, 1.0, 0,                                \
		{                                                              \
			NULL, NULL                                             \
		}                                                              \
	}

/*
 * Where the results go: arrays of nscales images, each BAKE_IMAGE_INIT before
 * and the caller's after success, all of the depth's size, row 0 at the top.
 * bent and horizons may be NULL: not wanted.
 */
struct bake_ao_result {
	/* 1 channel, 0 (closed) .. 1 (open) */
	struct bake_image *ao;
	/* 3 channels: unit vector x y z, y up (towards row 0), z out of the
	 * surface, never blurred */
	struct bake_image *bent;
	/* ndirs channels: tan e_j, 0 .. 1e18, never blurred */
	struct bake_image *horizons;
};

/*
 * Ambient occlusion of a depth map, for several depth scales at once.
 *
 * The surface has height h = (1 - depth) S, S = scale in texture widths, at
 * texels 1/W apart in both directions (W, H: width and height of the map).
 * From texel t, direction phi_j = 2 pi j / n runs along (cos phi_j,
 * sin phi_j) with y up, towards row 0: phi = 0 is right, pi/2 the top of the
 * picture. |cos| or |sin| below 1e-12 count as 0. The ray advances one texel
 * a step on its major axis (x where |cos| >= |sin|): step k = 1 .. K is at
 * major offset +-k and minor offset k m (m = minor / |major|), where the
 * height is interpolated linearly between the two texels of the minor axis,
 * at distance k sqrt(1 + m^2) texels. Then
 *     tan e_j = S W max(0, max_k (h_k - h_t) / dist_k),   h = 1 - depth
 *     r_j = cos e_j = 1 / sqrt(1 + tan^2 e_j)
 *     polygon: ao = sum_j r_j r_(j+1) / n     mean: ao = sum_j r_j^2 / n
 * The polygon is psa_i of the paper, sum_j r_j r_(j+1) sin(2 pi / n) / 2,
 * over the area of the regular n-gon instead of pi, so that a plane is
 * exactly 1. The bent normal is the cosine-weighted mean of the unoccluded
 * directions, normalised:
 *     (x, y) = sum_j cos^3 e_j (cos phi_j, sin phi_j) / 3
 *     z = sum_j (1 - sin^3 e_j) / 3
 * exactly (0, 0, 1) on a plane.
 *
 * K is periods times W or H (of the major axis); with a radius R > 0, the
 * largest k with dist_k <= R W. Beyond the border the map goes on as a torus,
 * or, on a clamped axis, with its border texels repeated; the reach may be
 * longer than the map.
 *
 * Fast and preview take steps 1 .. 16 (1 .. 8) as above, and the rest, its end
 * rounded up to a whole segment, in segments. One that starts at step k has the
 * largest L = 4, 8 .. 1024 steps with 4 L <= k (2 L <= k), or 4. It is made of
 * L / 4 blocks of 4 texels on the major axis and one on the minor; at the map's
 * end a block goes on as the map does. Block (u, v) holds the texels 4 u .. 4 u
 * + 3 of row v (column v, on a y-major ray), and with s = +-1 the ray's step on
 * its major axis, m that on the minor,
 *     P_0(u, v) = max of the ray's samples i = 0 .. 3 in the block, at minor
 *                 position v + i m, where i counts the texels from 4 u on for
 *                 s > 0 and from 4 u + 3 back for s < 0; a sample between
 *                 texels a and b is a + f (b - a), at most the map's highest
 *     P_(i+1)(u, v) = max(P_i(u, v), P_i(u + 2^i s, v + round(4 2^i m)))
 * For texel t in block u_t, texel i of it in the same count, and q = i, or 3/2
 * where L >= 16, the segment's height is
 *     P_log2(L/4)(u_t + s k / 4, v_t + round((k - q) m))
 * at distance (k - q + 0.85 (L - 1)) sqrt(1 + m^2). From L = 64 on four blocks
 * are one: P_4(w, v) is the above for the first block that the ray meets of 4 w
 * .. 4 w + 3, later P_(i+1) go 2^i / 4 of them on, the segment begins at
 * w_t + s k / 16, and q = 15/2. Of an even number of directions the second half
 * goes through the runs of the first half's rays the other way: with s and m
 * its own, and P made for -s and -m, a segment is P(u_t + s (k + L) / 4 - s,
 * v_t + round((k - q + L - 1) m)) (s (k + L) / 16 - s from L = 64 on).
 *
 * Blur: a Gaussian of blur_sigma texels, cut off at ceil(4 sigma), wrapped
 * or clamped as the map. It replaces ao where some tan e_j > 0 (not: where
 * ao < 1): by the mean of all texels (paper), or of those with a horizon
 * alone, over their weights (occluded).
 *
 *   depth    1 channel, 0 = surface, 1 = deepest; not modified. Any finite
 *            value is legal; magnitudes above 1e28 count as 1e28, below
 *            1e-20 as 0, and a NaN as 0
 *   scales   [nscales] S, 0 .. 1e6; all come from the same march
 *   nscales  1 .. 64
 *   params   see above
 *   result   result->ao is not NULL
 *   err      reason on failure; never NULL
 *
 * BAKE_EINVAL  a parameter out of its range, or depth without texels, with
 *              other than 1 channel or with a side above 2^27 texels
 * BAKE_ENOMEM  no memory; on any failure all result images are
 *              BAKE_IMAGE_INIT
 *
 * Accuracy: exact is within 5e-6 of the formulas in real arithmetic up to
 * S W = 256. Fast is off by 5e-4 to 5e-3 on average, on relief, smooth hills
 * and white noise alike, which is about the error of 50 directions
 * themselves; preview by 2e-3 to 1.2e-2, mostly too light, as between thin
 * parallel ridges. Where lone spikes of one texel are all there is to see, they
 * are off by 1.6e-2 and 2.6e-2. A texel that exact leaves open may have a
 * horizon just above 0 in fast, and the blur then replaces it: on rough tops
 * single texels differ much.
 * Same bytes for every thread count and instruction set. On a torus a shifted
 * map gives the shifted result, bit for bit; fast and preview, whose blocks
 * stay where they are, do so for shifts by multiples of 16 of a map whose sides
 * are such.
 *
 * Memory beyond depth, for one scale and ao alone, in bytes: 12.1 a texel for
 * the sums, 8.1 with an odd number of directions; 4 a texel of the map with a
 * border of 80 columns and 18 rows, twice that on a clamped axis; exact 6 more
 * of these; fast (preview) 1.1 for each L below a quarter (half) of the reach,
 * 4 at most, then 0.3. So 23.1 (21.4, 21.7) a texel at 1024 x 1024 and 22.2
 * (21.4) at 16384 x 16384, where fast thus takes 5.8 GB beyond the map's 1.1
 * GB. Each further scale takes 16 more, the bent normal 28, horizons 4 ndirs.
 *
 * Reentrant. progress.report is called on the calling thread alone.
 * Source: Limberger, Schetinger, Oliveira, "Meta-Relief Texture Mapping with
 * Dynamic Texture-Space Ambient Occlusion", section IV.A; Max 1988 for
 * horizons. The normalisation, the bent normal and the occluded blur are our
 * own.
 */
BAKE_API enum bake_status bake_ao(const struct bake_image *depth,
    const double *scales, int nscales, const struct bake_ao_params *params,
    const struct bake_ao_result *result, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
