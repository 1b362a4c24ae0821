/* Ambient occlusion after the depth scale has changed. */
/* SPDX-License-Identifier: MIT */
#include "ao_rescale.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "blur.h"
#include "mem.h"
#include "parallel.h"

static const double max_scale = 1e6;

static float
rescale(double ao, double s2)
{
	double den = s2 * (1 - ao) + ao;

	return (float)(den > 0 ? ao / den : 1);
}

float
bake_ao_rescale(float ao, double s)
{
	if (isnan(ao))
		return ao;
	return rescale(ao < 0 ? 0 : ao > 1 ? 1 : ao, s * s);
}

static enum bake_status
check_scale(double s, int nthreads, struct bake_err *err)
{
	if (!(s >= 0 && s <= max_scale))
		return bake_fail(err, BAKE_EINVAL,
		    "the depth is rescaled by %g, expected 0 to %g", s,
		    max_scale);
	if (nthreads < 0)
		return bake_fail(err, BAKE_EINVAL,
		    "%d threads, expected 0 or more", nthreads);
	return BAKE_OK;
}

enum bake_status
bake_ao_rescale_image(struct bake_image *img, int chan, double s, int nthreads,
    struct bake_err *err)
{
	enum bake_status rc;

	if ((rc = check_scale(s, nthreads, err)) != BAKE_OK)
		return rc;
	if (img->data == NULL || img->width < 1 || img->height < 1)
		return bake_fail(err, BAKE_EINVAL,
		    "the AO map has %dx%d texels, expected some", img->width,
		    img->height);
	if (chan < 0 || chan >= img->nchans)
		return bake_fail(err, BAKE_EINVAL,
		    "AO in channel %d of %d, counted from 0", chan,
		    img->nchans);
#pragma omp parallel for num_threads(bake_threads(nthreads)) schedule(static)
	for (int y = 0; y < img->height; y++) {
		float *v = bake_image_row(img, y) + chan;

		for (int x = 0; x < img->width; x++, v += img->nchans)
			*v = bake_ao_rescale(*v, s);
	}
	return BAKE_OK;
}

/* -- from horizons ------------------------------------------------------- */

static enum bake_status
check_horizons(const struct bake_image *h,
    const struct bake_ao_rescale_params *p, struct bake_err *err)
{
	if (h->data == NULL || h->width < 1 || h->height < 1)
		return bake_fail(err, BAKE_EINVAL,
		    "the horizons have %dx%d texels, expected some", h->width,
		    h->height);
	if (h->nchans < BAKE_AO_DIRS_MIN || h->nchans > BAKE_AO_DIRS_MAX)
		return bake_fail(err, BAKE_EINVAL,
		    "horizons in %d directions, expected %d to %d", h->nchans,
		    BAKE_AO_DIRS_MIN, BAKE_AO_DIRS_MAX);
	if (p->estimator != BAKE_AO_POLYGON && p->estimator != BAKE_AO_MEAN)
		return bake_fail(err, BAKE_EINVAL, "unknown estimator %d",
		    (int)p->estimator);
	if (p->blur != BAKE_AO_BLUR_NONE && p->blur != BAKE_AO_BLUR_PAPER &&
	    p->blur != BAKE_AO_BLUR_OCCLUDED)
		return bake_fail(
		    err, BAKE_EINVAL, "unknown blur mode %d", (int)p->blur);
	if (!(p->blur_sigma >= 0 && p->blur_sigma <= BAKE_AO_BLUR_SIGMA_MAX))
		return bake_fail(err, BAKE_EINVAL,
		    "a blur of %g texels, expected 0 to %d", p->blur_sigma,
		    BAKE_AO_BLUR_SIGMA_MAX);
	return BAKE_OK;
}

/* cos e' of a horizon. s > 0, so that Inf stays one. */
static double
cosine(float tan_e, double s)
{
	double t = tan_e > 0 ? s * tan_e : 0;

	return 1 / sqrt(1 + t * t);
}

static float
ao_of_horizons(const float *tan_e, int n, double s, bool mean)
{
	const double first = cosine(tan_e[0], s);
	double sum = mean ? first * first : 0, prev = first;

	for (int j = 1; j < n; j++) {
		double r = cosine(tan_e[j], s);

		sum += r * (mean ? r : prev);
		prev = r;
	}
	if (!mean)
		sum += first * prev;
	return (float)(sum < n ? sum / n : 1);
}

static bool
any_above(const float *tan_e, int n)
{
	for (int j = 0; j < n; j++)
		if (tan_e[j] > 0)
			return true;
	return false;
}

enum bake_status
bake_ao_rescale_horizons(const struct bake_image *horizons, double s,
    const struct bake_ao_rescale_params *params, struct bake_image *ao,
    struct bake_err *err)
{
	const int width = horizons->width, n = horizons->nchans;
	const bool blur =
	    params->blur != BAKE_AO_BLUR_NONE && params->blur_sigma > 0;
	const int nthreads = bake_threads(params->nthreads);
	uint8_t *mask = NULL;
	enum bake_status rc;

	if ((rc = check_scale(s, params->nthreads, err)) != BAKE_OK ||
	    (rc = check_horizons(horizons, params, err)) != BAKE_OK ||
	    (rc = bake_image_alloc(ao, width, horizons->height, 1, err)) !=
		BAKE_OK)
		return rc;
	if (blur && (mask = bake_alloc(
			 (size_t)width * (size_t)ao->height, 1, err)) == NULL) {
		rc = BAKE_ENOMEM;
		goto out;
	}
#pragma omp parallel for num_threads(nthreads) schedule(dynamic, 8)
	for (int y = 0; y < ao->height; y++) {
		const float *t = bake_image_row(horizons, y);
		float *out = bake_image_row(ao, y);

		for (int x = 0; x < width; x++, t += n) {
			out[x] = s > 0 ? ao_of_horizons(t, n, s,
					     params->estimator == BAKE_AO_MEAN)
				       : 1;
			if (blur)
				mask[(size_t)y * (size_t)width + (size_t)x] =
				    any_above(t, n);
		}
	}
	if (blur)
		rc = bake_blur(ao, mask, params->blur_sigma,
		    params->blur == BAKE_AO_BLUR_OCCLUDED, params->wrap,
		    nthreads, err);
out:
	free(mask);
	if (rc != BAKE_OK)
		bake_image_free(ao);
	return rc;
}

/* -- errors -------------------------------------------------------------- */

static float
difference(
    const struct bake_image *got, const struct bake_image *want, int x, int y)
{
	return bake_image_row(got, y)[x] - bake_image_row(want, y)[x];
}

static void
add_means(const struct bake_image *got, const struct bake_image *want,
    struct bake_ao_error *e)
{
	const double n = (double)got->width * got->height;

	memset(e, 0, sizeof *e);
	for (int y = 0; y < got->height; y++) {
		double sum = 0, bias = 0;

		for (int x = 0; x < got->width; x++) {
			const double d = difference(got, want, x, y);

			sum += fabs(d);
			bias += d;
			if (fabs(d) > e->max) {
				e->max = fabs(d);
				e->x = x;
				e->y = y;
			}
		}
		e->mean += sum / n;
		e->bias += bias / n;
	}
}

/* |d| as an integer that is ordered as it is. */
static uint32_t
magnitude_bits(float d)
{
	uint32_t bits;

	d = fabsf(d);
	memcpy(&bits, &d, sizeof bits);
	return bits;
}

enum { HALF_BITS = 1 << 16 };

/* Count the upper halves of all |d| or, of those whose upper half is `upper`,
 * the lower ones. */
static void
count_bits(const struct bake_image *got, const struct bake_image *want,
    bool lower, uint32_t upper, size_t *count)
{
	memset(count, 0, HALF_BITS * sizeof *count);
	for (int y = 0; y < got->height; y++)
		for (int x = 0; x < got->width; x++) {
			uint32_t bits =
			    magnitude_bits(difference(got, want, x, y));

			if (!lower)
				count[bits >> 16]++;
			else if (bits >> 16 == upper)
				count[bits & (HALF_BITS - 1)]++;
		}
}

/* The bin that holds the rank-th value, counted from 1; *rank becomes that
 * within it. */
static uint32_t
bin_of(const size_t *count, size_t *rank)
{
	uint32_t bin = 0;

	while (bin < HALF_BITS - 1 && *rank > count[bin])
		*rank -= count[bin++];
	return bin;
}

static double
percentile(
    const struct bake_image *got, const struct bake_image *want, size_t *count)
{
	const size_t n = (size_t)got->width * (size_t)got->height;
	size_t rank = n - n / 100;
	uint32_t bits;
	float v;

	count_bits(got, want, false, 0, count);
	bits = bin_of(count, &rank);
	count_bits(got, want, true, bits, count);
	bits = bits << 16 | bin_of(count, &rank);
	memcpy(&v, &bits, sizeof v);
	return v;
}

enum bake_status
bake_ao_compare(const struct bake_image *got, const struct bake_image *want,
    struct bake_ao_error *error, struct bake_image *signed_error,
    struct bake_err *err)
{
	enum bake_status rc;
	size_t *count;

	if (got->width != want->width || got->height != want->height)
		return bake_fail(err, BAKE_EDATA,
		    "AO of %dx%d texels against %dx%d", got->width, got->height,
		    want->width, want->height);
	if (got->nchans != 1 || want->nchans != 1 || got->width < 1 ||
	    got->height < 1)
		return bake_fail(err, BAKE_EDATA,
		    "AO maps of %d and %d channels, expected 1 and texels",
		    got->nchans, want->nchans);
	count = bake_alloc(HALF_BITS, sizeof *count, err);
	if (count == NULL)
		return BAKE_ENOMEM;
	add_means(got, want, error);
	error->p99 = percentile(got, want, count);
	free(count);
	if (signed_error == NULL)
		return BAKE_OK;
	rc = bake_image_alloc(signed_error, got->width, got->height, 1, err);
	for (int y = 0; rc == BAKE_OK && y < got->height; y++)
		for (int x = 0; x < got->width; x++)
			bake_image_row(signed_error, y)[x] =
			    difference(got, want, x, y);
	return rc;
}
