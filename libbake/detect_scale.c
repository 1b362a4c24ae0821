/* The blur scales of a pair of maps: slopes, boxes, halving. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>

#include "detect_priv.h"
#include "mem.h"

/* Slopes above this (79 degrees) are scaled down to it: the few texels where
 * z is almost 0 would outweigh all others in every sum. */
static const float slope_max = 5.0f;

enum bake_status
bake_detect_scale_alloc(struct detect_scale *s, int width, int height,
    bool normals, bool relief, struct bake_err *err)
{
	size_t n;

	*s = (struct detect_scale)DETECT_SCALE_INIT;
	if (!bake_mul_size((size_t)width, (size_t)height, &n))
		return bake_fail(err, BAKE_ENOMEM,
		    "%dx%d texels do not fit in memory", width, height);
	s->width = width;
	s->height = height;
	if (normals && ((s->p = bake_alloc(n, sizeof *s->p, err)) == NULL ||
			   (s->q = bake_alloc(n, sizeof *s->q, err)) == NULL))
		goto fail;
	if (relief && (s->v = bake_alloc(n, sizeof *s->v, err)) == NULL)
		goto fail;
	return BAKE_OK;
fail:
	bake_detect_scale_free(s);
	return BAKE_ENOMEM;
}

void
bake_detect_scale_free(struct detect_scale *s)
{
	free(s->p);
	free(s->q);
	free(s->v);
	*s = (struct detect_scale)DETECT_SCALE_INIT;
}

/* Slopes of one vector; false where it has none. */
static bool
slopes(const float *n, int nchans, float *p, float *q)
{
	float x = n[0], y = n[1], z, xy2 = x * x + y * y, len2, steep2;

	if (nchans >= 3)
		z = n[2];
	else
		z = sqrtf(fmaxf(0.0f, 1.0f - xy2));
	len2 = xy2 + z * z;
	if (!isfinite(len2) || len2 < 1e-12f)
		return false;
	steep2 = slope_max * slope_max;
	if (z > 0.0f && xy2 <= steep2 * z * z) {
		*p = -x / z;
		*q = -y / z;
	} else {
		float xy = sqrtf(xy2);

		/* straight down: a vector with no direction sideways */
		if (!(xy > 0.0f))
			return false;
		*p = -x / xy * slope_max;
		*q = -y / xy * slope_max;
	}
	return true;
}

/*
 * Which texels of the map the finest scale holds along one axis: all, or
 * DETECT_GRID windows spread evenly. The last texel of a window is marked as
 * missing, so that no gradient reaches from one window into the next.
 */
struct axis {
	int total, kept;
};

/* Texel of the map at i, -1 where missing. */
static int
axis_at(struct axis a, int i)
{
	int side = a.kept / DETECT_GRID, window, first;

	if (a.kept == a.total)
		return i;
	window = i / side;
	if (i % side == side - 1)
		return -1;
	first = (int)((long)a.total * window / DETECT_GRID) +
		(a.total - a.kept) / (2 * DETECT_GRID);
	return first + i % side;
}

/* Texels to keep of both axes: at most DETECT_TEXELS, windows of 128 where
 * both are long. */
static void
choose_axes(struct axis *u, struct axis *v)
{
	const int side = 1024; /* its square is DETECT_TEXELS */

	u->kept = u->total < side ? u->total : side;
	v->kept = DETECT_TEXELS / u->kept;
	if (v->kept >= v->total) {
		v->kept = v->total;
		u->kept = DETECT_TEXELS / v->kept;
		if (u->kept >= u->total)
			u->kept = u->total;
	}
	if (u->kept < u->total)
		u->kept -= u->kept % DETECT_GRID;
	if (v->kept < v->total)
		v->kept -= v->kept % DETECT_GRID;
}

static void
load_row(struct detect_scale *s, int y, const float *n, int nchans,
    const float *v, struct axis u)
{
	size_t at = (size_t)y * (size_t)s->width;

	for (int x = 0; x < s->width; x++, at++) {
		int k = axis_at(u, x);
		float p = NAN, q = NAN;

		if (n != NULL) {
			if (k >= 0)
				slopes(n + (size_t)k * (size_t)nchans, nchans,
				    &p, &q);
			s->p[at] = p;
			s->q[at] = q;
		}
		if (v != NULL)
			s->v[at] = k >= 0 && isfinite(v[k]) ? v[k] : NAN;
	}
}

static void
clear_row(struct detect_scale *s, int y)
{
	size_t at = (size_t)y * (size_t)s->width;

	for (int x = 0; x < s->width; x++, at++) {
		if (s->p != NULL)
			s->p[at] = s->q[at] = NAN;
		if (s->v != NULL)
			s->v[at] = NAN;
	}
}

enum bake_status
bake_detect_scale_load(struct detect_scale *s, const struct bake_image *normal,
    const struct bake_image *relief, struct bake_err *err)
{
	const struct bake_image *any = normal != NULL ? normal : relief;
	struct axis u = { any->width, 0 }, v = { any->height, 0 };
	enum bake_status rc;

	choose_axes(&u, &v);
	if ((rc = bake_detect_scale_alloc(s, u.kept, v.kept, normal != NULL,
		 relief != NULL, err)) != BAKE_OK)
		return rc;
	s->texels = 1;
	for (int y = 0; y < s->height; y++) {
		int k = axis_at(v, y);

		if (k < 0)
			clear_row(s, y);
		else
			load_row(s, y,
			    normal != NULL ? bake_image_row(normal, k) : NULL,
			    normal != NULL ? normal->nchans : 0,
			    relief != NULL ? bake_image_row(relief, k) : NULL,
			    u);
	}
	return BAKE_OK;
}

/* Taps at 2x - 1 .. 2x + 2 for texel x. A 2x2 box would let a fine regular
 * pattern through as a coarse one with its slopes reversed. */
static const float tent[4] = { 0.125f, 0.375f, 0.375f, 0.125f };

static void
halve_plane(float *dst, const float *src, int width, int height, int src_width,
    int src_height)
{
	for (int y = 0; y < height; y++) {
		const float *row[4];

		for (int j = 0; j < 4; j++)
			row[j] =
			    src + (size_t)src_width *
				      (size_t)bake_wrap_index(
					  2L * y - 1 + j, src_height, true);
		for (int x = 0; x < width; x++) {
			float sum = 0;

			for (int i = 0; i < 4; i++) {
				int k = bake_wrap_index(
				    2L * x - 1 + i, src_width, true);

				sum += tent[i] * (tent[0] * row[0][k] +
						     tent[1] * row[1][k] +
						     tent[2] * row[2][k] +
						     tent[3] * row[3][k]);
			}
			dst[(size_t)y * (size_t)width + (size_t)x] = sum;
		}
	}
}

enum bake_status
bake_detect_scale_halve(struct detect_scale *coarse,
    const struct detect_scale *fine, struct bake_err *err)
{
	enum bake_status rc;
	int w = fine->width / 2, h = fine->height / 2;

	if ((rc = bake_detect_scale_alloc(coarse, w, h, fine->p != NULL,
		 fine->v != NULL, err)) != BAKE_OK)
		return rc;
	coarse->texels = 2 * fine->texels;
	if (fine->p != NULL) {
		halve_plane(
		    coarse->p, fine->p, w, h, fine->width, fine->height);
		halve_plane(
		    coarse->q, fine->q, w, h, fine->width, fine->height);
	}
	if (fine->v != NULL)
		halve_plane(
		    coarse->v, fine->v, w, h, fine->width, fine->height);
	return BAKE_OK;
}
