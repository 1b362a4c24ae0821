/* What one map says by itself: ranges, normal lengths, seams. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>

#include "detect.h"
#include "mem.h"

void
bake_channel_range(
    const struct bake_image *img, int chan, struct bake_channel_range *out)
{
	double lo = INFINITY, hi = -INFINITY, sum = 0;
	size_t count = 0;

	*out = (struct bake_channel_range){ 0 };
	for (int y = 0; y < img->height; y++) {
		const float *row = bake_image_row(img, y) + chan;
		double row_sum = 0;

		for (int x = 0; x < img->width; x++) {
			float v = row[(size_t)x * (size_t)img->nchans];

			if (isnan(v)) {
				out->nnan++;
			} else if (isinf(v)) {
				out->ninf++;
			} else {
				lo = fmin(lo, (double)v);
				hi = fmax(hi, (double)v);
				row_sum += (double)v;
				count++;
			}
		}
		sum += row_sum;
	}
	out->min = count > 0 ? lo : NAN;
	out->max = count > 0 ? hi : NAN;
	out->mean = count > 0 ? sum / (double)count : NAN;
}

enum bake_status
bake_normal_stats(const struct bake_image *normal,
    struct bake_normal_stats *out, struct bake_err *err)
{
	/* 2/255: half a code of 8 bits in x and in y, and some */
	const double disc = (1 + 2.0 / 255) * (1 + 2.0 / 255);
	double sum = 0, sum2 = 0, sx = 0, sy = 0;
	size_t noutside = 0, nnegative = 0, n = 0;
	int nchans = normal->nchans;

	*out = (struct bake_normal_stats){ NAN, NAN, NAN, NAN, NAN, 0 };
	if (nchans != 2 && nchans != 3)
		return bake_fail(err, BAKE_EINVAL,
		    "a normal map has 2 or 3 channels, this one has %d",
		    nchans);
	for (int y = 0; y < normal->height; y++) {
		const float *v = bake_image_row(normal, y);

		for (int x = 0; x < normal->width; x++, v += nchans) {
			double z = nchans == 3 ? (double)v[2] : 0;
			double xy2 = (double)v[0] * (double)v[0] +
				     (double)v[1] * (double)v[1];
			double len2 = xy2 + z * z;

			if (!isfinite(len2))
				continue;
			n++;
			sum += sqrt(len2);
			sum2 += len2;
			sx += (double)v[0];
			sy += (double)v[1];
			noutside += xy2 > disc;
			nnegative += z < 0;
		}
	}
	out->nfinite = n;
	if (n == 0)
		return BAKE_OK;
	out->outside = (double)noutside / (double)n;
	out->tilt = sqrt(sx * sx + sy * sy) / (double)n;
	out->negative_z = (double)nnegative / (double)n;
	if (nchans == 3) {
		out->length_mean = sum / (double)n;
		out->length_dev = sqrt(fmax(
		    0, sum2 / (double)n - out->length_mean * out->length_mean));
	}
	return BAKE_OK;
}

/* Steps along one axis: sum and number of each of the n places. */
struct steps {
	double *sum;
	double *count;
	int n;
};

static void
step_add(struct steps *s, int place, float a, float b)
{
	double d = fabs((double)a - (double)b);

	if (isfinite(d)) {
		s->sum[place] += d;
		s->count[place] += 1;
	}
}

/* Last place against the mean and the maximum of the others. */
static void
step_ratios(const struct steps *s, double *mean_ratio, double *max_ratio)
{
	double inner = 0, count = 0, peak = 0, border;
	int last = s->n - 1;

	*mean_ratio = *max_ratio = NAN;
	for (int i = 0; i < last; i++) {
		if (s->count[i] > 0)
			peak = fmax(peak, s->sum[i] / s->count[i]);
		inner += s->sum[i];
		count += s->count[i];
	}
	if (count == 0 || s->count[last] == 0)
		return;
	border = s->sum[last] / s->count[last];
	*mean_ratio = border > 0 ? border / (inner / count) : 0;
	*max_ratio = border > 0 ? border / peak : 0;
}

static void
add_row(struct steps *u, struct steps *v, const struct bake_image *img, int y,
    int chan)
{
	const float *row = bake_image_row(img, y) + chan;
	const float *below = bake_image_row(img, (y + 1) % img->height) + chan;
	size_t n = (size_t)img->nchans;

	for (int x = 0; x < img->width; x++) {
		int right = (x + 1) % img->width;

		step_add(u, x, row[(size_t)x * n], row[(size_t)right * n]);
		step_add(v, y, row[(size_t)x * n], below[(size_t)x * n]);
	}
}

enum bake_status
bake_seams(const struct bake_image *img, int first_chan, int nchans,
    struct bake_seams *out, struct bake_err *err)
{
	struct steps u = { NULL, NULL, img->width };
	struct steps v = { NULL, NULL, img->height };
	size_t w = (size_t)img->width, h = (size_t)img->height;
	enum bake_status rc = BAKE_ENOMEM;

	*out = (struct bake_seams){ NAN, NAN, NAN, NAN };
	if ((u.sum = bake_zalloc(w, sizeof *u.sum, err)) == NULL ||
	    (u.count = bake_zalloc(w, sizeof *u.count, err)) == NULL ||
	    (v.sum = bake_zalloc(h, sizeof *v.sum, err)) == NULL ||
	    (v.count = bake_zalloc(h, sizeof *v.count, err)) == NULL)
		goto out;
	for (int c = first_chan; c < first_chan + nchans; c++)
		for (int y = 0; y < img->height; y++)
			add_row(&u, &v, img, y, c);
	step_ratios(&u, &out->u, &out->u_peak);
	step_ratios(&v, &out->v, &out->v_peak);
	rc = BAKE_OK;
out:
	free(u.sum);
	free(u.count);
	free(v.sum);
	free(v.count);
	return rc;
}
