/* The golden-file comparison: differences of two images, in codes. */
/* SPDX-License-Identifier: MIT */
#include "compare.h"

#include <math.h>

/* |a - b| in codes or in values; +Inf where it has no finite answer. */
static double
difference(float a, float b, double code_max)
{
	double d;

	if (a == b || (isnan(a) && isnan(b)))
		return 0;
	if (!isfinite(a) || !isfinite(b))
		return INFINITY;
	if (code_max > 0)
		d = fabs(
		    round((double)a * code_max) - round((double)b * code_max));
	else
		d = fabs((double)a - (double)b);
	return d;
}

static void
note(struct bake_difference *d, double diff, double tolerance)
{
	if (diff > 0)
		d->ndifferent++;
	if (diff > tolerance)
		d->nbeyond++;
	if (isinf(diff))
		d->nmismatch++;
	else
		d->mean += diff; /* a sum until all are in */
}

static void
note_worst(struct bake_difference *d, double diff, float a, float b,
    const int place[3])
{
	if (!(diff > d->worst))
		return;
	d->worst = diff;
	d->x = place[0];
	d->y = place[1];
	d->channel = place[2];
	d->a = a;
	d->b = b;
}

static enum bake_status
check(const struct bake_image *a, const struct bake_image *b, int code_max,
    double tolerance, struct bake_err *err)
{
	if (code_max < 0 || !(tolerance >= 0))
		return bake_fail(err, BAKE_EINVAL,
		    "cannot compare with %d codes and tolerance %g", code_max,
		    tolerance);
	if (a->width != b->width || a->height != b->height)
		return bake_fail(err, BAKE_EDATA,
		    "one image is %dx%d, the other %dx%d", a->width, a->height,
		    b->width, b->height);
	if (a->nchans != b->nchans)
		return bake_fail(err, BAKE_EDATA,
		    "one image has %d channels, the other %d", a->nchans,
		    b->nchans);
	if (a->nchans > BAKE_COMPARE_CHANNELS)
		return bake_fail(err, BAKE_EDATA,
		    "the images have %d channels, at most %d can be compared",
		    a->nchans, BAKE_COMPARE_CHANNELS);
	return BAKE_OK;
}

/* Sums become means; the channels' counts are added up in all. */
static void
finish(struct bake_comparison *out, size_t texels)
{
	size_t finite = 0;
	double sum = 0;

	for (int c = 0; c < out->nchans; c++) {
		struct bake_difference *d = &out->channel[c];
		size_t n = texels - d->nmismatch;

		out->all.ndifferent += d->ndifferent;
		out->all.nbeyond += d->nbeyond;
		out->all.nmismatch += d->nmismatch;
		sum += d->mean;
		finite += n;
		d->mean = n > 0 ? d->mean / (double)n : 0;
	}
	out->all.mean = finite > 0 ? sum / (double)finite : 0;
}

enum bake_status
bake_compare(const struct bake_image *a, const struct bake_image *b,
    int code_max, double tolerance, struct bake_comparison *out,
    struct bake_err *err)
{
	enum bake_status rc;

	*out = (struct bake_comparison){ .nchans = 0 };
	if ((rc = check(a, b, code_max, tolerance, err)) != BAKE_OK)
		return rc;
	out->nchans = a->nchans;
	for (int c = 0; c < a->nchans; c++)
		out->channel[c].channel = c;
	for (int y = 0; y < a->height; y++) {
		const float *u = bake_image_row(a, y);
		const float *v = bake_image_row(b, y);

		for (int x = 0; x < a->width; x++) {
			for (int c = 0; c < a->nchans; c++, u++, v++) {
				const int place[3] = { x, y, c };
				double d = difference(*u, *v, code_max);

				if (d == 0)
					continue;
				note(&out->channel[c], d, tolerance);
				note_worst(&out->channel[c], d, *u, *v, place);
				note_worst(&out->all, d, *u, *v, place);
			}
		}
	}
	finish(out, (size_t)a->width * (size_t)a->height);
	return BAKE_OK;
}
