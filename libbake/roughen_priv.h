/* Sines and arc cosines by + - * / and sqrt: the same on every machine. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_ROUGHEN_PRIV_H
#define BAKE_ROUGHEN_PRIV_H

#include <math.h>

#include "roughen.h"

#define BAKE_HALF_PI 1.57079632679489661923
#define BAKE_PI 3.14159265358979323846

/* The Taylor series to x^16 and x^17, for |x| <= pi / 4, where the next term
 * is below 1e-17. */
static inline double
bake_cos_near(double x)
{
	static const double c[9] = { 1, -1.0 / 2, 1.0 / 24, -1.0 / 720,
		1.0 / 40320, -1.0 / 3628800, 1.0 / 479001600,
		-1.0 / 87178291200, 1.0 / 20922789888000 };
	const double z = x * x;
	double v = c[8];

	for (int i = 7; i >= 0; i--)
		v = v * z + c[i];
	return v;
}

static inline double
bake_sin_near(double x)
{
	static const double c[9] = { 1, -1.0 / 6, 1.0 / 120, -1.0 / 5040,
		1.0 / 362880, -1.0 / 39916800, 1.0 / 6227020800,
		-1.0 / 1307674368000, 1.0 / 355687428096000 };
	const double z = x * x;
	double v = c[8];

	for (int i = 7; i >= 0; i--)
		v = v * z + c[i];
	return v * x;
}

/* cos and sin of x, |x| <= pi. */
static inline void
bake_cos_sin(double x, double *c, double *s)
{
	const double a = fabs(x);
	double ca, sa;

	if (a <= BAKE_HALF_PI / 2) {
		ca = bake_cos_near(a);
		sa = bake_sin_near(a);
	} else if (a <= 3 * BAKE_HALF_PI / 2) {
		ca = -bake_sin_near(a - BAKE_HALF_PI);
		sa = bake_cos_near(a - BAKE_HALF_PI);
	} else {
		ca = -bake_cos_near(BAKE_PI - a);
		sa = bake_sin_near(BAKE_PI - a);
	}
	*c = ca;
	*s = x < 0 ? -sa : sa;
}

/*
 * arccos d, d in -1 .. 1: sqrt(1 - |d|) P(|d|), P the polynomial that meets
 * arccos(x) / sqrt(1 - x) at 16 Chebyshev points of 0 .. 1; the nearest
 * singularity, x = -1, makes the error fall by 5.8 with each: 8e-15 at most.
 */
static inline double
bake_acos_poly(double x)
{
	static const double p[16] = { 1.5707963267948886, -0.2146018365984743,
		0.08904862219849122, -0.05079280260837022, 0.03368107159446284,
		-0.02437196245920367, 0.018655054153165932,
		-0.01479832210248183, 0.011891796255298575,
		-0.009333792391343208, 0.00677190513382137,
		-0.004237984673594591, 0.002116596626818905,
		-0.0007696925909019866, 0.00017803435354185626,
		-1.9451313028743098e-05 };
	double v = p[15];

	for (int i = 14; i >= 0; i--)
		v = v * x + p[i];
	return v;
}

static inline double
bake_acos(double d)
{
	const double x = fabs(d), v = bake_acos_poly(x) * sqrt(1 - x);

	return d < 0 ? BAKE_PI - v : v;
}

/* Which side of the median a luminance is on: PAPER jumps there. */
static inline double
bake_roughen_side(const struct bake_roughen *r, double t)
{
	return t > r->median ? 1 : t < r->median ? -1 : 0;
}

/* d of the formulas. */
static inline double
bake_roughen_deviation(const struct bake_roughen *r, double t)
{
	const double x = t - r->median, d = x / (x > 0 ? r->high : r->low);

	return d > -1 ? (d < 1 ? d : 1) : -1;
}

/* cos(theta - Delta) by d and its side, before (.)+; not BLACKSHOT. */
double bake_roughen_facing(const struct bake_roughen *r, double d, double side,
    double cos_theta, double sin_theta);

/* Texels that a kernel takes at once. */
enum { BAKE_ROUGHEN_RUN = 64 };

/* Whether no facet is turned by more than pi / 4, and the model is one of
 * facets: what the kernels are for. */
bool bake_roughen_is_near(const struct bake_roughen *r);

/* bake_roughen_gain of BAKE_ROUGHEN_RUN texels, the same bits. */
void bake_roughen_gains_baseline(const struct bake_roughen *r, const float *t,
    const double *cos_theta, const double *sin_theta, double *g);
void bake_roughen_gains_avx2(const struct bake_roughen *r, const float *t,
    const double *cos_theta, const double *sin_theta, double *g);
void bake_roughen_gains_avx512(const struct bake_roughen *r, const float *t,
    const double *cos_theta, const double *sin_theta, double *g);

/* The sorted values of a 1-channel image: n of them, evenly spaced quantiles
 * where it has more texels. *n is how many; the caller frees them. */
float *bake_roughen_quantiles(
    const struct bake_image *lum, int most, int *n, struct bake_err *err);

/* The percentiles of n sorted values. */
void bake_roughen_sorted_stats(
    const float *sorted, int n, struct bake_roughen_stats *stats);

#endif
