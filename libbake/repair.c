/* Repair of texels that hold no value: NaN, infinities, no-data sentinels. */
/* SPDX-License-Identifier: MIT */
#include "repair.h"

#include <math.h>
#include <stdlib.h>

#include "mem.h"
#include "parallel.h"

enum { MAX_LEVELS = 32, JACOBI_STEPS = 8 };

/* The bad texels by row: columns x[row_at[y]] .. x[row_at[y + 1] - 1]. */
struct bad_list {
	size_t *row_at; /* [height + 1] */
	int *x;
};

/* False for NaN too. */
static inline bool
is_good(const float *t, size_t nchans)
{
	for (size_t c = 0; c < nchans; c++)
		if (!(fabsf(t[c]) < BAKE_NODATA_MIN))
			return false;
	return true;
}

static enum bake_status
find_bad(struct bad_list *bad, const struct bake_image *img, int nt,
    struct bake_err *err)
{
	const size_t nc = (size_t)img->nchans;
	const int w = img->width, h = img->height;

	bad->row_at = bake_alloc((size_t)h + 1, sizeof *bad->row_at, err);
	if (bad->row_at == NULL)
		return BAKE_ENOMEM;
	bad->row_at[0] = 0;
#pragma omp parallel for schedule(static) num_threads(nt)
	for (int y = 0; y < h; y++) {
		const float *t = bake_image_row(img, y);
		size_t n = 0;

		for (int x = 0; x < w; x++, t += nc)
			n += !is_good(t, nc);
		bad->row_at[y + 1] = n;
	}
	for (int y = 0; y < h; y++)
		bad->row_at[y + 1] += bad->row_at[y];
	if (bad->row_at[h] == 0)
		return BAKE_OK;
	if (bad->row_at[h] == (size_t)w * (size_t)h)
		return bake_fail(err, BAKE_EDATA, "has no finite texel");
	bad->x = bake_alloc(bad->row_at[h], sizeof *bad->x, err);
	if (bad->x == NULL)
		return BAKE_ENOMEM;
#pragma omp parallel for schedule(static) num_threads(nt)
	for (int y = 0; y < h; y++) {
		const float *t = bake_image_row(img, y);
		size_t at = bad->row_at[y];

		for (int x = 0; x < w; x++, t += nc)
			if (!is_good(t, nc))
				bad->x[at++] = x;
	}
	return BAKE_OK;
}

/* The mean of the good among the (up to) 2x2 texels, or NaN for none. */
static void
pull_cell(float *dst, const struct bake_image *fine, int cx, int cy)
{
	const size_t nc = (size_t)fine->nchans;
	const int x1 = 2 * cx + 1 < fine->width ? 2 : 1;
	const int y1 = 2 * cy + 1 < fine->height ? 2 : 1;
	const float *good[4];
	int n = 0;

	for (int y = 0; y < y1; y++)
		for (int x = 0; x < x1; x++) {
			const float *t = bake_image_row(fine, 2 * cy + y) +
					 (size_t)(2 * cx + x) * nc;

			if (is_good(t, nc))
				good[n++] = t;
		}
	for (size_t c = 0; c < nc; c++) {
		double sum = 0;

		for (int i = 0; i < n; i++)
			sum += good[i][c];
		dst[c] = n > 0 ? (float)(sum / n) : NAN;
	}
}

/* The next coarser level of fine; *holes: it still has empty cells. */
static enum bake_status
pull(struct bake_image *coarse, bool *holes, const struct bake_image *fine,
    int nt, struct bake_err *err)
{
	const int w = (fine->width + 1) / 2, h = (fine->height + 1) / 2;
	const size_t nc = (size_t)fine->nchans;
	int empty = 0;
	enum bake_status rc;

	rc = bake_image_alloc(coarse, w, h, fine->nchans, err);
	if (rc != BAKE_OK)
		return rc;
#pragma omp parallel for schedule(static) reduction(| : empty) num_threads(nt)
	for (int y = 0; y < h; y++) {
		float *row = bake_image_row(coarse, y);

		for (int x = 0; x < w; x++) {
			pull_cell(row + (size_t)x * nc, fine, x, y);
			empty |= !is_good(row + (size_t)x * nc, nc);
		}
	}
	*holes = empty != 0;
	return BAKE_OK;
}

/* Linear interpolation of the coarser level at fine texel (x, y). */
static void
push_texel(float *dst, const struct bake_image *coarse, int x, int y,
    struct bake_wrap wrap)
{
	const size_t nc = (size_t)coarse->nchans;
	/* the own cell's centre is 1/4 cell away, the next one's 3/4 */
	const int x0 = x / 2, y0 = y / 2;
	const int x1 = bake_wrap_index(
	    (long)x0 + (x % 2 ? 1 : -1), coarse->width, wrap.clamp_u);
	const int y1 = bake_wrap_index(
	    (long)y0 + (y % 2 ? 1 : -1), coarse->height, wrap.clamp_v);
	const float *r0 = bake_image_row(coarse, y0);
	const float *r1 = bake_image_row(coarse, y1);
	const size_t i0 = (size_t)x0 * nc, i1 = (size_t)x1 * nc;

	for (size_t c = 0; c < nc; c++)
		dst[c] = (float)((9.0 * r0[i0 + c] + 3.0 * r0[i1 + c] +
				     3.0 * r1[i0 + c] + r1[i1 + c]) /
				 16);
}

static void
push_level(struct bake_image *fine, const struct bake_image *coarse,
    struct bake_wrap wrap, int nt)
{
	const size_t nc = (size_t)fine->nchans;

#pragma omp parallel for schedule(static) num_threads(nt)
	for (int y = 0; y < fine->height; y++) {
		float *t = bake_image_row(fine, y);

		for (int x = 0; x < fine->width; x++, t += nc)
			if (!is_good(t, nc))
				push_texel(t, coarse, x, y, wrap);
	}
}

/*
 * The means of the neighbours of row y's bad texels, dst[.][nchans]. At a
 * clamped border, and along an axis of one texel, a neighbour is missing.
 */
static void
relax_row(float *dst, const struct bake_image *img, int y,
    const struct bad_list *bad, struct bake_wrap wrap)
{
	const int w = img->width;
	const size_t nc = (size_t)img->nchans;
	const int yu = bake_wrap_index((long)y - 1, img->height, wrap.clamp_v);
	const int yd = bake_wrap_index((long)y + 1, img->height, wrap.clamp_v);
	const float *up = bake_image_row(img, yu);
	const float *down = bake_image_row(img, yd);
	const float *row = bake_image_row(img, y);

	for (size_t i = bad->row_at[y]; i < bad->row_at[y + 1]; i++) {
		const int x = bad->x[i];
		const int l =
		    x > 0 ? x - 1 : bake_wrap_index(-1, w, wrap.clamp_u);
		const int r =
		    x < w - 1 ? x + 1 : bake_wrap_index(w, w, wrap.clamp_u);
		const float *near[4];
		int n = 0;

		if (yu != y)
			near[n++] = up + (size_t)x * nc;
		if (yd != y)
			near[n++] = down + (size_t)x * nc;
		if (l != x)
			near[n++] = row + (size_t)l * nc;
		if (r != x)
			near[n++] = row + (size_t)r * nc;
		for (size_t c = 0; c < nc; c++) {
			double sum = 0;

			for (int k = 0; k < n; k++)
				sum += near[k][c];
			*dst++ = (float)(sum / n);
		}
	}
}

/* All new values are formed before any is stored: no order can matter. */
static void
relax(struct bake_image *img, const struct bad_list *bad, float *scratch,
    struct bake_wrap wrap, int nt)
{
	const size_t nc = (size_t)img->nchans;

	for (int step = 0; step < JACOBI_STEPS; step++) {
#pragma omp parallel for schedule(dynamic, 16) num_threads(nt)
		for (int y = 0; y < img->height; y++)
			relax_row(
			    scratch + bad->row_at[y] * nc, img, y, bad, wrap);
#pragma omp parallel for schedule(dynamic, 16) num_threads(nt)
		for (int y = 0; y < img->height; y++) {
			float *row = bake_image_row(img, y);

			for (size_t i = bad->row_at[y]; i < bad->row_at[y + 1];
			     i++)
				for (size_t c = 0; c < nc; c++)
					row[(size_t)bad->x[i] * nc + c] =
					    scratch[i * nc + c];
		}
	}
}

/* Everything is allocated before the image is touched. */
static enum bake_status
fill(struct bake_image *img, const struct bad_list *bad, struct bake_wrap wrap,
    int nt, struct bake_err *err)
{
	struct bake_image level[MAX_LEVELS + 1];
	const size_t nc = (size_t)img->nchans;
	float *scratch = NULL;
	bool holes = true;
	int top = 0;
	enum bake_status rc = BAKE_OK;

	level[0] = *img;
	while (holes) {
		rc = pull(&level[top + 1], &holes, &level[top], nt, err);
		if (rc != BAKE_OK)
			goto out;
		top++;
	}
	scratch =
	    bake_alloc(bad->row_at[img->height], nc * sizeof *scratch, err);
	if (scratch == NULL) {
		rc = BAKE_ENOMEM;
		goto out;
	}
	for (int l = top; l > 0; l--)
		push_level(&level[l - 1], &level[l], wrap, nt);
	relax(img, bad, scratch, wrap, nt);
out:
	for (int l = 1; l <= top; l++)
		bake_image_free(&level[l]);
	free(scratch);
	return rc;
}

enum bake_status
bake_repair_nonfinite(struct bake_image *img, struct bake_wrap wrap,
    int nthreads, size_t *nrepaired, struct bake_err *err)
{
	const int nt = bake_threads(nthreads);
	struct bad_list bad = { NULL, NULL };
	enum bake_status rc;

	if (img->data == NULL)
		return bake_fail(err, BAKE_EINVAL, "an image without texels");
	rc = find_bad(&bad, img, nt, err);
	if (rc == BAKE_OK && bad.row_at[img->height] > 0)
		rc = fill(img, &bad, wrap, nt, err);
	if (rc == BAKE_OK)
		*nrepaired = bad.row_at[img->height];
	free(bad.row_at);
	free(bad.x);
	return rc;
}
