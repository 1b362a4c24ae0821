/* Gradients and slopes of one blur scale, and the statistics on them. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>

#include "detect_priv.h"
#include "mem.h"

/*
 * Taps of the 5x5 operators, across[column + 2] * down[row + 2]: a blur
 * [1 2 1] / 4 of both maps on both axes, and then the Sobel gradient of v, or
 * the slope's mean that goes with it. The central difference of v is the mean
 * of its slope over two texels, which Simpson's rule takes from three samples
 * of the slope: sin t / t against (2 + cos t) / 3 at t radians a texel, within
 * 5 % up to t = pi / 2; the blur leaves little above.
 */
enum { TAPS = 5, MARGIN = TAPS / 2 };
static const float binomial[TAPS] = { 1 / 16.0f, 4 / 16.0f, 6 / 16.0f,
	4 / 16.0f, 1 / 16.0f };
static const float simpson[TAPS] = { 1 / 24.0f, 6 / 24.0f, 10 / 24.0f,
	6 / 24.0f, 1 / 24.0f };
static const float difference[TAPS] = { -1 / 8.0f, -2 / 8.0f, 0, 2 / 8.0f,
	1 / 8.0f };

/* line[x] = column x's rows y .. y + 4 of src, weighted by down. */
static void
convolve_down(float *line, const float *src, const struct detect_scale *s,
    int y, const float down[TAPS])
{
	size_t w = (size_t)s->width;
	const float *r = src + (size_t)y * w;

	for (size_t x = 0; x < w; x++)
		line[x] = down[0] * r[x] + down[1] * r[x + w] +
			  down[2] * r[x + 2 * w] + down[3] * r[x + 3 * w] +
			  down[4] * r[x + 4 * w];
}

/* dst (the interior) = src convolved with across x down, minus its own mean;
 * 0 where a texel is missing. line is scratch, one row of src. */
static void
convolve(float *dst, const float *src, const struct detect_scale *s,
    float *line, const float across[TAPS], const float down[TAPS])
{
	int w = s->width - 2 * MARGIN, h = s->height - 2 * MARGIN;
	double sum = 0;
	size_t count = 0;
	float mean;

	for (int y = 0; y < h; y++) {
		float *d = dst + (size_t)y * (size_t)w;

		convolve_down(line, src, s, y, down);
		for (int x = 0; x < w; x++) {
			const float *t = line + x;

			d[x] = across[0] * t[0] + across[1] * t[1] +
			       across[2] * t[2] + across[3] * t[3] +
			       across[4] * t[4];
			if (isfinite(d[x])) {
				sum += (double)d[x];
				count++;
			}
		}
	}
	mean = count > 0 ? (float)(sum / (double)count) : 0.0f;
	for (size_t k = 0; k < (size_t)w * (size_t)h; k++)
		dst[k] = isfinite(dst[k]) ? dst[k] - mean : 0.0f;
}

static double
square(double v)
{
	return v * v;
}

/* Mean of a^2 + b^2 over the fields' texels. */
static double
energy(struct detect_sums s, const struct detect_fields *fields)
{
	return (s.aa + s.bb) / ((double)fields->width * fields->height);
}

static void
negate(float *f, const struct detect_fields *fields)
{
	for (size_t k = 0; k < (size_t)fields->width * (size_t)fields->height;
	     k++)
		f[k] = -f[k];
}

/* x, y, straight, crossed: gradients against slopes. */
static void
measure_pair(struct detect_result *out, struct detect_fields *fields,
    const struct detect_scale *s, float *line)
{
	struct bake_evidence e;
	double t = s->texels;

	convolve(fields->f[0], s->v, s, line, difference, binomial);
	convolve(fields->f[1], s->v, s, line, binomial, difference);
	negate(fields->f[1], fields); /* rows run down, y up */
	out->gain_x = bake_detect_measure(&out->x, fields, 0, 2, DETECT_CORR);
	out->gain_y = bake_detect_measure(&out->y, fields, 1, 3, DETECT_CORR);
	bake_detect_chance(&out->x, fields, 0, 2);
	bake_detect_chance(&out->y, fields, 1, 3);
	out->straight = 0.5 * (square(out->x.value) + square(out->y.value));
	bake_detect_measure(&e, fields, 0, 3, DETECT_CORR);
	out->crossed = 0.5 * square(e.value);
	bake_detect_measure(&e, fields, 1, 2, DETECT_CORR);
	out->crossed += 0.5 * square(e.value);
	out->x.scale = out->y.scale = s->texels;
	out->gradient_energy = (out->gain_x.aa + out->gain_y.aa) /
			       ((double)fields->width * fields->height * t * t);
}

/* curl, twist: the slopes alone. */
static void
measure_curl(struct detect_result *out, struct detect_fields *fields,
    const struct detect_scale *s, float *line)
{
	struct detect_sums curl, twist;
	struct bake_evidence e;
	double both;

	convolve(fields->f[0], s->p, s, line, binomial, difference);
	convolve(fields->f[1], s->q, s, line, difference, binomial);
	convolve(fields->f[2], s->p, s, line, difference, binomial);
	convolve(fields->f[3], s->q, s, line, binomial, difference);
	curl = bake_detect_measure(&out->curl, fields, 0, 1, DETECT_BALANCE);
	bake_detect_chance(&out->curl, fields, 0, 1);
	out->curl.value = -out->curl.value;
	out->curl.sigmas = -out->curl.sigmas;
	out->curl.scale = s->texels;
	twist = bake_detect_measure(&e, fields, 2, 3, DETECT_BALANCE);
	out->twist = fabs(e.value);
	both = energy(curl, fields) + energy(twist, fields);
	out->curl_energy = both > 0 ? energy(curl, fields) / both : 0;
}

enum bake_status
bake_detect_scale_measure(struct detect_result *out,
    const struct detect_scale *scale, struct bake_err *err)
{
	struct detect_fields fields = { scale->width - 2 * MARGIN,
		scale->height - 2 * MARGIN, { NULL } };
	size_t n = (size_t)fields.width * (size_t)fields.height;
	float *line = bake_alloc((size_t)scale->width, sizeof *line, err);
	enum bake_status rc = line != NULL ? BAKE_OK : BAKE_ENOMEM;

	*out = (struct detect_result){ .texels = scale->texels };
	for (int i = 0; i < 4; i++) {
		fields.f[i] = bake_alloc(n, sizeof *fields.f[i], err);
		if (fields.f[i] == NULL)
			rc = BAKE_ENOMEM;
	}
	if (rc != BAKE_OK)
		goto out;
	if (scale->p != NULL) {
		struct bake_evidence e;

		convolve(fields.f[2], scale->p, scale, line, simpson, binomial);
		convolve(fields.f[3], scale->q, scale, line, binomial, simpson);
		out->slope_energy =
		    energy(bake_detect_measure(&e, &fields, 2, 3, DETECT_CORR),
			&fields);
		if (scale->v != NULL)
			measure_pair(out, &fields, scale, line);
		measure_curl(out, &fields, scale, line);
	}
out:
	for (int i = 0; i < 4; i++)
		free(fields.f[i]);
	free(line);
	return rc;
}
