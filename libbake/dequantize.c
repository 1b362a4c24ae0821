/* Dequantising: a smooth map within half a code of a quantised one. */
/* SPDX-License-Identifier: MIT */
#include "dequantize.h"

#include <math.h>
#include <string.h>

#include "mem.h"
#include "parallel.h"

/*
 * One smoothing step along both axes at a spacing s, all bounds in codes. The
 * fourth difference
 *     D f = f(-2s) - 4 f(-s) + 6 f - 4 f(s) + f(2s)
 * is 0 on cubics, so that u -= D u / 16 takes noise away and leaves slopes,
 * curvature and rounded tops alone, which a plain average would flatten. It is
 * done where
 *   |D v| <= bend_v  of the codes: on a smooth map, rounding alone makes it
 *                    2.4 on average (rms), an edge of H codes H, 3H or more;
 *                    the 4.01 stops at every edge of 5 codes or more
 *   |D u| <= bend_u  of the map so far: what finer spacings left over is shape
 *   |v(2s) - v(-2s)| <= span: the widest spacing is for near-flat ground only,
 *                    whose plateaus are wider than the others reach
 * The .01 leaves room for rounding in codes / code_max.
 */
struct step {
	int spacing;
	float bend_v, bend_u, span;
};

static const float any = 1e30f;
static const struct step schedule[] = {
	{ 1, 4.01f, 9.0f, any },
	{ 1, 4.01f, 9.0f, any },
	{ 2, 4.01f, 2.0f, any },
	{ 2, 4.01f, 2.0f, any },
	{ 4, 4.01f, 2.0f, any },
	{ 4, 4.01f, 2.0f, any },
	{ 8, 4.01f, 2.0f, any },
	{ 8, 4.01f, 2.0f, any },
	{ 16, 4.01f, 3.0f, 8.01f },
	{ 16, 4.01f, 3.0f, 8.01f },
	{ 8, 4.01f, 2.0f, any },
	{ 4, 4.01f, 2.0f, any },
	{ 2, 4.01f, 2.0f, any },
	{ 1, 4.01f, 2.0f, any },
};

/* The five texels of a difference, each the first of a run of n. */
struct five {
	const float *f[5];
};

/* out -= D u / 16 over n texels, where D u and D v are within the bounds. */
static void
subtract(float *restrict out, const struct five *u, const struct five *v,
    size_t n, const struct step *s)
{
	const float *u0 = u->f[0], *u1 = u->f[1], *u2 = u->f[2];
	const float *u3 = u->f[3], *u4 = u->f[4];
	const float *v0 = v->f[0], *v1 = v->f[1], *v2 = v->f[2];
	const float *v3 = v->f[3], *v4 = v->f[4];
	const float bend_u = s->bend_u, bend_v = s->bend_v, span = s->span;

	for (size_t x = 0; x < n; x++) {
		const float du =
		    (u0[x] + u4[x]) - 4 * (u1[x] + u3[x]) + 6 * u2[x];
		const float dv =
		    (v0[x] + v4[x]) - 4 * (v1[x] + v3[x]) + 6 * v2[x];
		const float across = v4[x] - v0[x];
		/* a factor 0 or 1: no branch, so that this becomes SIMD */
		const int smooth = (fabsf(dv) <= bend_v) &
				   (fabsf(du) <= bend_u) &
				   (fabsf(across) <= span);

		out[x] -= du * (0.0625f * (float)smooth);
	}
}

/* The step along a row of w texels; its ends look round the border. */
static void
subtract_row(float *out, const float *u, const float *v, int w, bool clamp,
    const struct step *s)
{
	const int reach = 2 * s->spacing;
	const int from = reach < w ? reach : w;
	const int to = w - reach > from ? w - reach : from;
	struct five fu, fv;

	for (int x = 0; x < w; x = x + 1 == from ? to : x + 1) {
		for (int k = 0; k < 5; k++) {
			const int at = bake_wrap_index(
			    (long)x + (k - 2) * s->spacing, w, clamp);

			fu.f[k] = u + at;
			fv.f[k] = v + at;
		}
		subtract(out + x, &fu, &fv, 1, s);
	}
	if (from == to)
		return;
	for (int k = 0; k < 5; k++) {
		fu.f[k] = u + k * s->spacing;
		fv.f[k] = v + k * s->spacing;
	}
	subtract(out + from, &fu, &fv, (size_t)(to - from), s);
}

static void
limit_row(float *restrict out, const float *v, size_t n, float half)
{
	for (size_t x = 0; x < n; x++) {
		const float lo = v[x] - half > 0 ? v[x] - half : 0;
		const float hi = v[x] + half < 1 ? v[x] + half : 1;
		const float t = out[x] < lo ? lo : out[x];

		out[x] = t > hi ? hi : t;
	}
}

static void
step_image(struct bake_image *out, const struct bake_image *u,
    const struct bake_image *v, const struct step *s, struct bake_wrap wrap,
    float half, int nt)
{
	const size_t w = (size_t)u->width;

#pragma omp parallel for schedule(static) num_threads(nt)
	for (int y = 0; y < u->height; y++) {
		const float *vrow = bake_image_row(v, y);
		float *row = bake_image_row(out, y);
		struct five fu, fv;

		memcpy(row, bake_image_row(u, y), w * sizeof *row);
		subtract_row(
		    row, bake_image_row(u, y), vrow, u->width, wrap.clamp_u, s);
		for (int k = 0; k < 5; k++) {
			const int at =
			    bake_wrap_index((long)y + (k - 2) * s->spacing,
				u->height, wrap.clamp_v);

			fu.f[k] = bake_image_row(u, at);
			fv.f[k] = bake_image_row(v, at);
		}
		subtract(row, &fu, &fv, w, s);
		limit_row(row, vrow, w, half);
	}
}

static void
copy_image(struct bake_image *dst, const struct bake_image *src)
{
	for (int y = 0; y < src->height; y++)
		memcpy(bake_image_row(dst, y), bake_image_row(src, y),
		    (size_t)src->width * sizeof *src->data);
}

enum bake_status
bake_dequantize(struct bake_image *img, int code_max, struct bake_wrap wrap,
    int nthreads, struct bake_err *err)
{
	enum { NSTEPS = sizeof schedule / sizeof *schedule };
	struct bake_image v = BAKE_IMAGE_INIT, other = BAKE_IMAGE_INIT;
	struct bake_image *u = img, *out = &other, *t;
	const int nt = bake_threads(nthreads);
	const float code = 1 / (float)code_max;
	enum bake_status rc;

	if (img->data == NULL || img->nchans != 1)
		return bake_fail(err, BAKE_EINVAL,
		    "dequantising takes 1 channel, this image has %d",
		    img->nchans);
	if (code_max < 1 || code_max > 65535)
		return bake_fail(err, BAKE_EINVAL,
		    "the largest code is %d, expected 1 to 65535", code_max);
	if ((rc = bake_image_alloc(&v, img->width, img->height, 1, err)) !=
		BAKE_OK ||
	    (rc = bake_image_alloc(&other, img->width, img->height, 1, err)) !=
		BAKE_OK)
		goto out;
	copy_image(&v, img);
	for (int i = 0; i < NSTEPS; i++) {
		const struct step s = { schedule[i].spacing,
			schedule[i].bend_v * code, schedule[i].bend_u * code,
			schedule[i].span * code };

		step_image(out, u, &v, &s, wrap, 0.5f * code, nt);
		t = u;
		u = out;
		out = t;
	}
	if (u != img)
		copy_image(img, u);
out:
	bake_image_free(&v);
	bake_image_free(&other);
	return rc;
}

void
bake_quantization_matters(const struct bake_image *img, int code_max,
    double depth_scale, double *step_texels, double *share)
{
	const size_t nc = (size_t)img->nchans;
	size_t count = 0;

	for (int y = 0; y < img->height; y++) {
		const float *row = bake_image_row(img, y);
		/* beyond the last row and column lies no step */
		const float *below =
		    y + 1 < img->height ? bake_image_row(img, y + 1) : row;

		for (int x = 0; x < img->width; x++) {
			const size_t i = (size_t)x * nc;
			const size_t r = x + 1 < img->width ? i + nc : i;
			const double dx = fabs((double)row[r] - row[i]);
			const double dy = fabs((double)below[i] - row[i]);

			count += fabs(dx * code_max - 1) < 1e-3 ||
				 fabs(dy * code_max - 1) < 1e-3;
		}
	}
	*step_texels = fabs(depth_scale) * img->width / code_max;
	*share = (double)count / ((double)img->width * (double)img->height);
}
