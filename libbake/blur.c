/* A Gaussian low-pass filter of ambient occlusion, at chosen texels. */
/* SPDX-License-Identifier: MIT */
#include "blur.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "mem.h"

struct blur {
	struct bake_image *ao;
	const uint8_t *mask;
	struct bake_wrap wrap;
	bool masked_only;
	int radius;
	float *weights; /* [2 radius + 1], sum 1 */
	float *sums;    /* [height][width] occlusion, filtered along x */
	float *norms;   /* the same of the mask; NULL if not masked_only */
};

static enum bake_status
make_weights(struct blur *b, double sigma, struct bake_err *err)
{
	double sum = 0;
	int n;

	b->radius = (int)ceil(4 * sigma);
	n = 2 * b->radius + 1;
	b->weights = bake_alloc((size_t)n, sizeof *b->weights, err);
	if (b->weights == NULL)
		return BAKE_ENOMEM;
	for (int i = -b->radius; i <= b->radius; i++)
		sum += exp(-0.5 * i * i / (sigma * sigma));
	for (int i = -b->radius; i <= b->radius; i++)
		b->weights[i + b->radius] =
		    (float)(exp(-0.5 * i * i / (sigma * sigma)) / sum);
	return BAKE_OK;
}

/* Along x: line is one row of occlusion (or mask) with radius texels of
 * border on both sides. */
static void
filter_line(const struct blur *b, const float *line, float *out)
{
	const int width = b->ao->width;

	for (int x = 0; x < width; x++)
		out[x] = 0;
	for (int i = 0; i <= 2 * b->radius; i++) {
		const float w = b->weights[i];

		for (int x = 0; x < width; x++)
			out[x] += w * line[x + i];
	}
}

static void
filter_row(const struct blur *b, int y, float *line)
{
	const int width = b->ao->width;
	const float *ao = bake_image_row(b->ao, y);
	const uint8_t *mask = b->mask + (size_t)y * (size_t)width;

	for (int i = 0; i < width + 2 * b->radius; i++) {
		int x = bake_wrap_index(
		    (long)i - b->radius, width, b->wrap.clamp_u);

		line[i] = b->masked_only && !mask[x] ? 0 : 1 - ao[x];
	}
	filter_line(b, line, b->sums + (size_t)y * (size_t)width);
	if (b->norms == NULL)
		return;
	for (int i = 0; i < width + 2 * b->radius; i++)
		line[i] = mask[bake_wrap_index(
		    (long)i - b->radius, width, b->wrap.clamp_u)];
	filter_line(b, line, b->norms + (size_t)y * (size_t)width);
}

/* Along y, of one of the two planes, for output row y. */
static void
sum_rows(const struct blur *b, const float *plane, int y, float *out)
{
	const int width = b->ao->width;

	for (int x = 0; x < width; x++)
		out[x] = 0;
	for (int i = 0; i <= 2 * b->radius; i++) {
		const float w = b->weights[i];
		const float *row =
		    plane + (size_t)bake_wrap_index((long)y + i - b->radius,
				b->ao->height, b->wrap.clamp_v) *
				(size_t)width;

		for (int x = 0; x < width; x++)
			out[x] += w * row[x];
	}
}

static void
replace_row(const struct blur *b, int y, float *line)
{
	const int width = b->ao->width;
	const uint8_t *mask = b->mask + (size_t)y * (size_t)width;
	float *ao = bake_image_row(b->ao, y);
	float *norm = line + width;

	sum_rows(b, b->sums, y, line);
	if (b->norms != NULL)
		sum_rows(b, b->norms, y, norm);
	for (int x = 0; x < width; x++) {
		float v;

		if (!mask[x])
			continue;
		/* the texel itself is in the norm, which is thus > 0 */
		v = 1 - (b->norms == NULL ? line[x] : line[x] / norm[x]);
		ao[x] = v < 0 ? 0 : v > 1 ? 1 : v;
	}
}

enum bake_status
bake_blur(struct bake_image *ao, const uint8_t *mask, double sigma,
    bool masked_only, struct bake_wrap wrap, int nthreads, struct bake_err *err)
{
	struct blur b = { .ao = ao, .mask = mask, .wrap = wrap };
	const size_t width = (size_t)ao->width;
	size_t ntexels, nlines;
	float *lines = NULL;
	enum bake_status rc = BAKE_ENOMEM;

	b.masked_only = masked_only;
	if (make_weights(&b, sigma, err) != BAKE_OK)
		goto out;
	if (!bake_mul_size(width, (size_t)ao->height, &ntexels) ||
	    !bake_mul_size(
		2 * width + 2 * (size_t)b.radius, (size_t)nthreads, &nlines)) {
		bake_fail(err, BAKE_ENOMEM, "%dx%d texels do not fit in memory",
		    ao->width, ao->height);
		goto out;
	}
	if ((b.sums = bake_alloc(ntexels, sizeof *b.sums, err)) == NULL ||
	    (lines = bake_alloc(nlines, sizeof *lines, err)) == NULL)
		goto out;
	if (masked_only &&
	    (b.norms = bake_alloc(ntexels, sizeof *b.norms, err)) == NULL)
		goto out;
	rc = BAKE_OK;
#pragma omp parallel num_threads(nthreads)
	{
		float *line = lines + (2 * width + 2 * (size_t)b.radius) *
					  (size_t)omp_get_thread_num();

#pragma omp for schedule(dynamic, 16)
		for (int y = 0; y < ao->height; y++)
			filter_row(&b, y, line);
#pragma omp for schedule(dynamic, 16)
		for (int y = 0; y < ao->height; y++)
			replace_row(&b, y, line);
	}
out:
	free(b.weights);
	free(b.sums);
	free(b.norms);
	free(lines);
	return rc;
}
