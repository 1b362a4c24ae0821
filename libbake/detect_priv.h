/* Inside detect: blur scales of a pair of maps and the statistics on them. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_DETECT_PRIV_H
#define BAKE_DETECT_PRIV_H

#include "detect.h"

/* Largest number of texels at the finest scale, blocks per axis, scales; and
 * the least side of a scale: 3 blocks of 3 texels within a margin of 2. */
enum {
	DETECT_TEXELS = 1 << 20,
	DETECT_GRID = 8,
	DETECT_SCALES = 12,
	DETECT_LEAST = 13
};

/*
 * One blur scale: slopes p, q and relief value v, [height][width] floats,
 * NaN where missing; p and q, or v, NULL where that map was not given.
 * texels: how many texels of the map one texel covers.
 */
struct detect_scale {
	int width, height, texels;
	float *p, *q, *v;
};
#define DETECT_SCALE_INIT                                                      \
	{                                                                      \
		0, 0, 0, NULL, NULL, NULL                                      \
	}

enum bake_status bake_detect_scale_alloc(struct detect_scale *s, int width,
    int height, bool normals, bool relief, struct bake_err *err);
void bake_detect_scale_free(struct detect_scale *s);

/* The finest scale of the maps: slopes of limited steepness; of a map with
 * more than DETECT_TEXELS, windows spread evenly. s is DETECT_SCALE_INIT. */
enum bake_status bake_detect_scale_load(struct detect_scale *s,
    const struct bake_image *normal, const struct bake_image *relief,
    struct bake_err *err);

/* coarse = fine low-passed and halved; missing where any of the 4x4 texels
 * that enter is. An odd last row or column is left out. */
enum bake_status bake_detect_scale_halve(struct detect_scale *coarse,
    const struct detect_scale *fine, struct bake_err *err);

/* Sums of products of two fields a, b over one block. */
struct detect_sums {
	double aa, ab, bb;
};

/* The fields of a scale's interior, [height][width], centred, 0 = missing. */
struct detect_fields {
	int width, height;
	float *f[4];
};

/* value of a pair of fields: correlation, or 2 ab / (aa + bb) */
enum detect_kind { DETECT_CORR, DETECT_BALANCE };

double bake_detect_value(struct detect_sums s, enum detect_kind kind);

/* Value, jackknife, block share of fields i and j; verdict and chance are
 * left 0 and 1. Returns the sums of all blocks. */
struct detect_sums bake_detect_measure(struct bake_evidence *ev,
    const struct detect_fields *fields, int i, int j, enum detect_kind kind);

/* ev->chance: how often a shift of field j against i does as well. */
void bake_detect_chance(
    struct bake_evidence *ev, const struct detect_fields *fields, int i, int j);

/*
 * All statistics of one scale. gain_*: sums of (gradient, slope) along x and
 * y, for regressions; slope_energy, gradient_energy: mean p^2 + q^2, and mean
 * |grad v|^2 per texel of the map; curl_energy: E[a^2 + b^2] of the curl test
 * over that of all four derivatives of p and q.
 */
struct detect_result {
	int texels;
	struct bake_evidence x, y, curl;
	struct detect_sums gain_x, gain_y;
	double twist, straight, crossed;
	double slope_energy, gradient_energy, curl_energy;
};

enum bake_status bake_detect_scale_measure(struct detect_result *out,
    const struct detect_scale *scale, struct bake_err *err);

/* Conclude from n scales, finest first. width: of the map. */
void bake_detect_decide(struct bake_detection *out,
    const struct detect_result *result, int n, int width);

#endif
