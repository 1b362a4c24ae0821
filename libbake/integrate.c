/* Depth from normals: least-squares integration by fast transforms. */
/* SPDX-License-Identifier: MIT */
#include "integrate.h"

#include <fftw3.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "parallel.h"

/*
 * Everything is done on real transforms, one axis after the other:
 *   torus    R2HC: cosine coefficients at 0..n/2, sine ones from n-1 downwards
 *   clamped  heights are even about the border: a DCT-II, cos(w (i + 1/2)),
 *            w = pi k / n; their differences are odd: a DST-II, sin(w (i +
 * 1/2)), of which FFTW keeps frequency k at place k - 1 A central difference
 * maps one real coefficient of h onto one of the slope: the torus' cosine k
 * onto sine k and back, the clamped cosine k onto sine k. So its adjoint is a
 * factor and a place: (D* P)[j] = d[j] P[partner[j]] All clamped and torus axes
 * mix, and memory stays at two doubles a texel.
 */
struct axis {
	int n;
	double norm; /* of a transform and its inverse */
	int *partner;
	double *d;      /* adjoint of the central difference */
	double *smooth; /* of the smoothing across, Scharr */
	double *lap4;   /* |second difference|^2 / 4 */
	fftw_r2r_kind even, odd, inverse;
};

/* NO_SIMD: the same bytes on every machine */
static const unsigned plan_flags =
    FFTW_ESTIMATE | FFTW_UNALIGNED | FFTW_NO_SIMD;

static void
axis_free(struct axis *a)
{
	free(a->partner);
	free(a->d);
	free(a->smooth);
	free(a->lap4);
}

/* The transfer functions at frequency k of n, written at coefficient j. */
static void
axis_put(struct axis *a, int j, int partner, double d, double w,
    enum bake_slope_op op)
{
	const double sh = sin(w / 2);

	a->partner[j] = partner;
	a->d[j] = d;
	a->smooth[j] = op == BAKE_SLOPE_SCHARR ? (10 + 6 * cos(w)) / 16 : 1;
	a->lap4[j] = 4 * sh * sh * sh * sh;
}

static enum bake_status
axis_init(struct axis *a, int n, bool clamp, enum bake_slope_op op,
    struct bake_err *err)
{
	const double pi = 3.14159265358979323846;
	const size_t count = (size_t)n;

	*a = (struct axis){ .n = n };
	a->partner = bake_alloc(count, sizeof *a->partner, err);
	a->d = bake_alloc(count, sizeof *a->d, err);
	a->smooth = bake_alloc(count, sizeof *a->smooth, err);
	a->lap4 = bake_alloc(count, sizeof *a->lap4, err);
	if (!a->partner || !a->d || !a->smooth || !a->lap4)
		return BAKE_ENOMEM;
	a->norm = clamp ? 2.0 * n : n;
	a->even = clamp ? FFTW_REDFT10 : FFTW_R2HC;
	a->odd = clamp ? FFTW_RODFT10 : FFTW_R2HC;
	a->inverse = clamp ? FFTW_REDFT01 : FFTW_HC2R;
	axis_put(a, 0, 0, 0, 0, op);
	for (int k = 1; clamp && k < n; k++)
		axis_put(a, k, k - 1, -sin(pi * k / n), pi * k / n, op);
	for (int k = 1; !clamp && 2 * k <= n; k++) {
		const double w = 2 * pi * k / n;

		if (2 * k == n) { /* sin(pi) is 0, not 1e-16 */
			axis_put(a, k, k, 0, w, op);
		} else {
			axis_put(a, k, n - k, sin(w), w, op);
			axis_put(a, n - k, k, -sin(w), w, op);
		}
	}
	return BAKE_OK;
}

/* One plan for transforms of n doubles in place, anywhere in memory. */
static fftw_plan
plan_make(int n, double *any, fftw_r2r_kind kind)
{
	fftw_plan p;

#pragma omp critical(bake_fftw_planner)
	p = fftw_plan_r2r_1d(n, any, any, kind, plan_flags);
	return p;
}

static void
plan_free(fftw_plan p)
{
#pragma omp critical(bake_fftw_planner)
	fftw_destroy_plan(p);
}

/* Columns that are transformed together: one cache line of a row. */
enum { NCOLS = 8 };

static void
transform_columns(
    double *a, int w, int h, fftw_plan plan, double *scratch, int nt)
{
	const size_t width = (size_t)w, height = (size_t)h;
	const int nblocks = (w + NCOLS - 1) / NCOLS;

#pragma omp parallel for schedule(static) num_threads(nt)
	for (int b = 0; b < nblocks; b++) {
		double *buf =
		    scratch + (size_t)omp_get_thread_num() * NCOLS * height;
		const size_t x0 = (size_t)b * NCOLS;
		const size_t m = width - x0 < NCOLS ? width - x0 : NCOLS;

		for (size_t y = 0; y < height; y++)
			for (size_t i = 0; i < m; i++)
				buf[i * height + y] = a[y * width + x0 + i];
		for (size_t i = 0; i < m; i++)
			fftw_execute_r2r(
			    plan, buf + i * height, buf + i * height);
		for (size_t y = 0; y < height; y++)
			for (size_t i = 0; i < m; i++)
				a[y * width + x0 + i] = buf[i * height + y];
	}
}

/* Transform a[h][w] in place, rows by kind kx, columns by kind ky. */
static enum bake_status
transform(double *a, int w, int h, fftw_r2r_kind kx, fftw_r2r_kind ky, int nt,
    struct bake_err *err)
{
	double *scratch = NULL;
	fftw_plan px = NULL, py = NULL;
	enum bake_status rc = BAKE_OK;

	/* nt * NCOLS is small: the product with h is what may overflow */
	scratch =
	    bake_alloc((size_t)h, (size_t)nt * NCOLS * sizeof *scratch, err);
	if (scratch == NULL)
		return BAKE_ENOMEM;
	px = plan_make(w, a, kx);
	py = plan_make(h, scratch, ky);
	if (px == NULL || py == NULL) {
		rc = bake_fail(err, BAKE_ENOMEM,
		    "no transform of %dx%d texels could be planned", w, h);
		goto out;
	}
#pragma omp parallel for schedule(static) num_threads(nt)
	for (int y = 0; y < h; y++)
		fftw_execute_r2r(
		    px, a + (size_t)y * (size_t)w, a + (size_t)y * (size_t)w);
	transform_columns(a, w, h, py, scratch, nt);
out:
	if (px != NULL)
		plan_free(px);
	if (py != NULL)
		plan_free(py);
	free(scratch);
	return rc;
}

/* Slopes p to the right and q up; returns 1 where they are not n's own. */
static inline int
slopes(const float *n, double *p, double *q)
{
	const double x = n[0], y = n[1], z = n[2];
	const double floor_z = 1e-3 * sqrt(x * x + y * y + z * z);
	const double nz = z < floor_z ? floor_z : z;

	if (!(z > 0) || !isfinite(floor_z)) {
		*p = *q = 0;
		return 1;
	}
	*p = -x / nz;
	*q = -y / nz;
	return z < floor_z;
}

static size_t
fill_slopes(double *p, double *q, const struct bake_image *normal, int nt)
{
	const size_t w = (size_t)normal->width;
	size_t count = 0;

#pragma omp parallel for schedule(static) reduction(+ : count) num_threads(nt)
	for (int y = 0; y < normal->height; y++) {
		const float *n = bake_image_row(normal, y);
		const size_t at = (size_t)y * w;

		for (size_t x = 0; x < w; x++)
			count +=
			    (size_t)slopes(n + 3 * x, &p[at + x], &q[at + x]);
	}
	return count;
}

/*
 * p becomes the coefficients of h. A row's partners along x lie in the row
 * itself, hence its copy; those along y are in q, which stays.
 */
static void
solve(double *p, const double *q, const struct axis *ax, const struct axis *ay,
    double damping, double *scratch, int nt)
{
	const size_t w = (size_t)ax->n;
	const double norm = ax->norm * ay->norm * ax->n;

#pragma omp parallel for schedule(static) num_threads(nt)
	for (int y = 0; y < ay->n; y++) {
		double *row = p + (size_t)y * w;
		const double *qrow = q + (size_t)ay->partner[y] * w;
		double *t = scratch + (size_t)omp_get_thread_num() * w;

		memcpy(t, row, w * sizeof *t);
		for (size_t x = 0; x < w; x++) {
			const double dx = ax->d[x] * ay->smooth[y];
			/* rows grow downwards, q is the slope upwards */
			const double dy = -ay->d[y] * ax->smooth[x];
			const double den = dx * dx + dy * dy;
			const double num =
			    dx * t[ax->partner[x]] + dy * qrow[x];
			const double damp =
			    damping * (ax->lap4[x] + ay->lap4[y]);

			row[x] = den > 0 ? num / ((den + damp) * norm) : 0;
		}
	}
}

static enum bake_status
check_params(const struct bake_image *normal,
    const struct bake_integrate_params *params, struct bake_err *err)
{
	if (normal->data == NULL || normal->nchans != 3)
		return bake_fail(err, BAKE_EINVAL,
		    "integrating needs normals of 3 channels, this image has "
		    "%d",
		    normal->nchans);
	if (!(params->damping >= 0 && params->damping <= 1))
		return bake_fail(err, BAKE_EINVAL,
		    "damping is %g, expected 0 to 1", params->damping);
	if (params->op != BAKE_SLOPE_CENTRAL && params->op != BAKE_SLOPE_SCHARR)
		return bake_fail(err, BAKE_EINVAL, "%d is no slope operator",
		    (int)params->op);
	return BAKE_OK;
}

static enum bake_status
to_image(struct bake_image *height, const double *a, int w, int h, int nt,
    struct bake_err *err)
{
	struct bake_image out = BAKE_IMAGE_INIT;
	enum bake_status rc;

	if ((rc = bake_image_alloc(&out, w, h, 1, err)) != BAKE_OK)
		return rc;
#pragma omp parallel for schedule(static) num_threads(nt)
	for (int y = 0; y < h; y++) {
		float *row = bake_image_row(&out, y);

		for (int x = 0; x < w; x++)
			row[x] = (float)a[(size_t)y * (size_t)w + (size_t)x];
	}
	*height = out;
	return BAKE_OK;
}

enum bake_status
bake_integrate(const struct bake_image *normal,
    const struct bake_integrate_params *params, struct bake_image *height,
    size_t *nlimited, struct bake_err *err)
{
	const int w = normal->width, h = normal->height;
	const int nt = bake_threads(params->nthreads);
	struct axis ax = { 0 }, ay = { 0 };
	double *p = NULL, *q = NULL, *scratch = NULL;
	size_t count, texels;
	enum bake_status rc;

	if ((rc = check_params(normal, params, err)) != BAKE_OK)
		return rc;
	if (!bake_mul_size((size_t)w, (size_t)h, &texels))
		return bake_fail(err, BAKE_ENOMEM,
		    "%dx%d texels do not fit in memory", w, h);
	rc = axis_init(&ax, w, params->wrap.clamp_u, params->op, err);
	if (rc != BAKE_OK)
		goto out;
	rc = axis_init(&ay, h, params->wrap.clamp_v, params->op, err);
	if (rc != BAKE_OK)
		goto out;
	p = bake_alloc(texels, sizeof *p, err);
	q = bake_alloc(texels, sizeof *q, err);
	scratch = bake_alloc((size_t)w, (size_t)nt * sizeof *scratch, err);
	if (p == NULL || q == NULL || scratch == NULL) {
		rc = BAKE_ENOMEM;
		goto out;
	}
	count = fill_slopes(p, q, normal, nt);
	if ((rc = transform(p, w, h, ax.odd, ay.even, nt, err)) != BAKE_OK ||
	    (rc = transform(q, w, h, ax.even, ay.odd, nt, err)) != BAKE_OK)
		goto out;
	solve(p, q, &ax, &ay, params->damping, scratch, nt);
	free(q);
	q = NULL;
	if ((rc = transform(p, w, h, ax.inverse, ay.inverse, nt, err)) !=
		BAKE_OK ||
	    (rc = to_image(height, p, w, h, nt, err)) != BAKE_OK)
		goto out;
	if (nlimited != NULL)
		*nlimited = count;
out:
	free(p);
	free(q);
	free(scratch);
	axis_free(&ax);
	axis_free(&ay);
	return rc;
}

enum bake_status
bake_depth_from_normal(const struct bake_image *normal, struct bake_wrap wrap,
    enum bake_slope_op op, int nthreads, struct bake_image *height,
    struct bake_err *err)
{
	const struct bake_integrate_params params = { wrap, op, 0, nthreads };

	return bake_integrate(normal, &params, height, NULL, err);
}

enum bake_status
bake_depth_from_height(struct bake_image *img, double *scale, size_t *nclipped,
    struct bake_err *err)
{
	double lo = INFINITY, hi = -INFINITY;
	size_t clipped = 0;

	if (img->data == NULL || img->nchans != 1)
		return bake_fail(err, BAKE_EINVAL,
		    "a height map has 1 channel, this image has %d",
		    img->nchans);
	if (!(*scale >= 0 && isfinite(*scale)))
		return bake_fail(err, BAKE_EINVAL,
		    "the depth scale is %g, expected 0 or more", *scale);
	for (int y = 0; y < img->height; y++) {
		const float *row = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++) {
			if (!isfinite(row[x]))
				return bake_fail(err, BAKE_EDATA,
				    "the height at texel %d, %d is not finite",
				    x, y);
			lo = row[x] < lo ? row[x] : lo;
			hi = row[x] > hi ? row[x] : hi;
		}
	}
	if (*scale == 0)
		*scale = hi - lo;
	for (int y = 0; y < img->height; y++) {
		float *row = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++) {
			const double d = hi - row[x];

			clipped += d > *scale;
			/* first, so that a flat map does not divide by 0 */
			row[x] = d == 0        ? 0
				 : d >= *scale ? 1
					       : (float)(d / *scale);
		}
	}
	if (nclipped != NULL)
		*nclipped = clipped;
	return BAKE_OK;
}
