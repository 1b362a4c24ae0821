/* Depth from normals: round trips, optimality against an oracle, scales. */
/* SPDX-License-Identifier: MIT */
#include "integrate.h"

#include "check.h"
#include "test_maps.h"

static const enum bake_slope_op ops[] = { BAKE_SLOPE_CENTRAL,
	BAKE_SLOPE_SCHARR };

static double
wave(int n, bool clamp, int k, int i)
{
	/* clamped: the even mirror's own cosines, so no kink at the border */
	return clamp ? cos(pi * k * (i + 0.5) / n)
		     : sin(2 * pi * k * i / n + 0.7);
}

/*
 * A depth map without the mean's and the checkerboards' frequencies, which no
 * difference sees, and below half the sampling rate otherwise.
 */
static struct bake_image
visible_map(int w, int h, struct bake_wrap wrap)
{
	struct bake_image d = image(w, h, 1);

	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++)
			d.data[y * w + x] =
			    (float)(0.5 +
				    0.2 * wave(w, wrap.clamp_u, 1, x) *
					wave(h, wrap.clamp_v, 2, y) +
				    0.1 * wave(w, wrap.clamp_u, 5, x) +
				    0.1 * wave(h, wrap.clamp_v, 3, y) *
					wave(w, wrap.clamp_u, 4, x));
	return d;
}

static struct bake_image
height_of(const struct bake_image *n, struct bake_wrap wrap,
    enum bake_slope_op op, double damping, int nt)
{
	const struct bake_integrate_params params = { wrap, op, damping, nt };
	struct bake_image h = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_integrate(n, &params, &h, NULL, &err), err);
	if (h.data == NULL)
		abort();
	return h;
}

static double
mean(const struct bake_image *img)
{
	double sum = 0;

	for (size_t i = 0; i < nfloats(img); i++)
		sum += img->data[i];
	return sum / (double)nfloats(img);
}

/* Height -> normals -> height, all wraps, both operators, awkward sizes. */
static void
inverse_of_the_matching_operator(void)
{
	static const int sizes[][2] = { { 64, 64 }, { 63, 40 }, { 31, 37 },
		{ 128, 18 } };
	const double s = 0.1;

	for (int i = 0; i < 4 * 8; i++) {
		const struct bake_wrap wrap = { i % 2, i / 2 % 2 };
		const enum bake_slope_op op = ops[i / 4 % 2];
		struct bake_image d =
		    visible_map(sizes[i / 8][0], sizes[i / 8][1], wrap);
		struct bake_image n = BAKE_IMAGE_INIT, h = BAKE_IMAGE_INIT;
		struct bake_err err = BAKE_ERR_INIT;
		double m = mean(&d), worst = 0;

		CHECK_OK(
		    bake_normal_from_depth(&d, s, wrap, op, 1, &n, &err), err);
		CHECK_OK(
		    bake_depth_from_normal(&n, wrap, op, 1, &h, &err), err);
		for (size_t k = 0; k < nfloats(&d); k++)
			worst =
			    fmax(worst, fabs(h.data[k] - s * (m - d.data[k])));
		/*
		 * Slopes reach W s 0.3 = 4 and are floats to 1e-7 of that; a
		 * texel's worth of them, 1/W, is 3e-9, and the white rest
		 * sums up to a few of these: 1e-6 of the range 0.08
		 */
		CHECK_NEAR(worst, 0, 1e-6 * 0.08);
		CHECK_NEAR(mean(&h), 0, 1e-9);
		bake_image_free(&d);
		bake_image_free(&n);
		bake_image_free(&h);
	}
}

/* Any clamped map comes back whole: only its mean is not seen. */
static void
clamped_noise_comes_back_whole(void)
{
	struct bake_image d = noise(24, 17, 1), n = BAKE_IMAGE_INIT, h;
	struct bake_err err = BAKE_ERR_INIT;
	const double m = mean(&d);

	for (int op = 0; op < 2; op++) {
		CHECK_OK(bake_normal_from_depth(
			     &d, 0.01, clamped, ops[op], 1, &n, &err),
		    err);
		h = height_of(&n, clamped, ops[op], 0, 1);
		for (size_t i = 0; i < nfloats(&d); i++)
			/* float slopes below 1, times 24/pi at the worst
			 * seen frequency, times 1/24 texture widths */
			CHECK_NEAR(h.data[i], 0.01 * (m - d.data[i]), 5e-8);
		bake_image_free(&n);
		bake_image_free(&h);
	}
	bake_image_free(&d);
}

static void
slope_at(const struct bake_image *n, int x, int y, double *p, double *q)
{
	const float *v = bake_image_row(n, y) + 3 * x;

	*p = -(double)v[0] / v[2];
	*q = -(double)v[1] / v[2];
}

/* D h at (x, y): right (axis 0) or up (axis 1), times W. */
static double
apply(const double *f, int w, int h, struct bake_wrap wrap, int op, int axis,
    int x, int y)
{
	static const double smooth[2][3] = { { 0, 1, 0 },
		{ 3.0 / 16, 10.0 / 16, 3.0 / 16 } };
	double sum = 0;

	for (int j = -1; j <= 1; j++)
		for (int i = -1; i <= 1; i++) {
			const double c = axis == 0 ? smooth[op][j + 1] * i / 2
						   : -smooth[op][i + 1] * j / 2;

			sum +=
			    c * f[bake_wrap_index(y + j, h, wrap.clamp_v) * w +
				    bake_wrap_index(x + i, w, wrap.clamp_u)];
		}
	return sum * w;
}

/* The gradient of the squared error, D*(D h - slope) + damping, at all. */
static void
residual(double *g, const double *f, const struct bake_image *n,
    struct bake_wrap wrap, int op, double damping)
{
	const int w = n->width, h = n->height;

	for (int i = 0; i < w * h; i++)
		g[i] = 0;
	for (int t = 0; t < w * h; t++) {
		const int x = t % w, y = t / w;
		double p, q, unit[9 * 9] = { 0 };
		double ep, eq, lx, ly;

		slope_at(n, x, y, &p, &q);
		ep = apply(f, w, h, wrap, op, 0, x, y) - p;
		eq = apply(f, w, h, wrap, op, 1, x, y) - q;
		const int l = bake_wrap_index(x - 1, w, wrap.clamp_u);
		const int r = bake_wrap_index(x + 1, w, wrap.clamp_u);
		const int u = bake_wrap_index(y - 1, h, wrap.clamp_v);
		const int d = bake_wrap_index(y + 1, h, wrap.clamp_v);

		lx = damping * w * w / 4 *
		     (f[y * w + l] - 2 * f[t] + f[y * w + r]);
		ly = damping * w * w / 4 *
		     (f[u * w + x] - 2 * f[t] + f[d * w + x]);
		g[y * w + l] += lx;
		g[y * w + r] += lx;
		g[u * w + x] += ly;
		g[d * w + x] += ly;
		g[t] -= 2 * (lx + ly);
		/* the transpose, column by column: the obvious slow way */
		for (int k = 0; k < w * h; k++) {
			unit[k] = 1;
			g[k] += ep * apply(unit, w, h, wrap, op, 0, x, y) +
				eq * apply(unit, w, h, wrap, op, 1, x, y);
			unit[k] = 0;
		}
	}
}

static struct bake_image
noisy_normals(int w, int h)
{
	struct bake_image n = noise(w, h, 3);

	for (int i = 0; i < w * h; i++) {
		n.data[3 * i] -= 0.5f;
		n.data[3 * i + 1] -= 0.4f;
		n.data[3 * i + 2] = 1 + n.data[3 * i + 2];
	}
	return n;
}

/*
 * On normals that no surface has, the result is the least-squares one: the
 * gradient of the error, formed by the operators in space, is 0.
 */
static void
least_squares_on_normals_that_fit_no_surface(void)
{
	static const int sizes[][2] = { { 8, 8 }, { 9, 7 }, { 5, 8 }, { 1, 6 },
		{ 2, 3 } };
	static const double dampings[] = { 0, 0.3, 1 };

	for (int i = 0; i < 5 * 24; i++) {
		const struct bake_wrap wrap = { i % 2, i / 2 % 2 };
		const int op = i / 4 % 2;
		const double damping = dampings[i / 8 % 3];
		const int w = sizes[i / 24][0], h = sizes[i / 24][1];
		struct bake_image n = noisy_normals(w, h);
		struct bake_image got =
		    height_of(&n, wrap, ops[op], damping, 1);
		double f[81], g[81], worst = 0, scale = 0;

		for (int k = 0; k < w * h; k++)
			f[k] = got.data[k];
		residual(g, f, &n, wrap, op, damping);
		for (int k = 0; k < w * h; k++) {
			/* damping acts where D sees something only: h has no
			 * part there, so neither has the gradient */
			worst = fmax(worst, fabs(g[k]));
			scale = fmax(scale, fabs(f[k]));
		}
		/* f is a float, and D*D magnifies its rounding by 4 w^2 */
		CHECK_NEAR(worst, 0, 8 * w * w * scale * 6e-8 + 1e-12);
		bake_image_free(&n);
		bake_image_free(&got);
	}
}

/* Clamped, where only the mean is free, CG on D*D gives the same answer. */
static void
equals_conjugate_gradients(void)
{
	enum { W = 8, H = 8, N = W * H };
	struct bake_image n = noisy_normals(W, H), zero = image(W, H, 3), got;
	double x[N] = { 0 }, r[N], d[N], a[N], rr = 0;

	for (int i = 0; i < N; i++) { /* flat normals: g is then D*D f */
		zero.data[3 * i] = zero.data[3 * i + 1] = 0;
		zero.data[3 * i + 2] = 1;
	}
	residual(r, x, &n, clamped, 0, 0);
	for (int i = 0; i < N; i++) {
		d[i] = r[i] = -r[i];
		rr += r[i] * r[i];
	}
	for (int it = 0; it < 400 && rr > 1e-24; it++) {
		double da = 0, rr1 = 0, alpha;

		residual(a, d, &zero, clamped, 0, 0);
		for (int i = 0; i < N; i++)
			da += d[i] * a[i];
		alpha = rr / da;
		for (int i = 0; i < N; i++) {
			x[i] += alpha * d[i];
			r[i] -= alpha * a[i];
			rr1 += r[i] * r[i];
		}
		for (int i = 0; i < N; i++)
			d[i] = r[i] + rr1 / rr * d[i];
		rr = rr1;
	}
	got = height_of(&n, clamped, BAKE_SLOPE_CENTRAL, 0, 1);
	for (int i = 0; i < N; i++)
		CHECK_NEAR(got.data[i], x[i], 1e-7); /* float, |h| < 1 */
	bake_image_free(&n);
	bake_image_free(&zero);
	bake_image_free(&got);
}

/* On the torus a shift of the normals is a shift of the heights. */
static void
shift_moves_the_heights(void)
{
	enum { W = 12, H = 10, DX = 5, DY = 7 };
	struct bake_image n = noisy_normals(W, H), m = image(W, H, 3);
	struct bake_image a, b;

	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++)
			memcpy(bake_image_row(&m, (y + DY) % H) +
				   3 * ((x + DX) % W),
			    bake_image_row(&n, y) + 3 * x, 3 * sizeof(float));
	a = height_of(&n, torus, BAKE_SLOPE_CENTRAL, 0, 1);
	b = height_of(&m, torus, BAKE_SLOPE_CENTRAL, 0, 1);
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) /* doubles, then one rounding */
			CHECK_NEAR(
			    bake_image_row(&b, (y + DY) % H)[(x + DX) % W],
			    bake_image_row(&a, y)[x], 2e-8);
	bake_image_free(&n);
	bake_image_free(&m);
	bake_image_free(&a);
	bake_image_free(&b);
}

/*
 * The pattern next to the checkerboard, of which the operator sees little, is
 * what 8-bit normals put in: damping must take it out and leave the shape.
 */
static void
damping_quiets_eight_bit_normals(void)
{
	enum { N = 128 };
	struct bake_image d = visible_map(N, N, torus), n = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	double rough[2] = { 0, 0 }, error[2] = { 0, 0 };

	CHECK_OK(bake_normal_from_depth(
		     &d, 0.1, torus, BAKE_SLOPE_CENTRAL, 1, &n, &err),
	    err);
	for (size_t i = 0; i < nfloats(&n); i++)
		n.data[i] =
		    (float)(floor((n.data[i] + 1) / 2 * 255 + 0.5) / 255 * 2 -
			    1);
	for (int k = 0; k < 2; k++) {
		struct bake_image h =
		    height_of(&n, torus, BAKE_SLOPE_CENTRAL, 0.03 * k, 1);
		const double m = mean(&d);

		for (size_t i = 0; i < nfloats(&d); i++) {
			const size_t r = i % N + 1 < N ? i + 1 : i + 1 - N;
			const double e = h.data[i] - 0.1 * (m - d.data[i]);
			const double er = h.data[r] - 0.1 * (m - d.data[r]);

			error[k] += e * e / (N * N);
			rough[k] += (e - er) * (e - er) / (N * N);
		}
		bake_image_free(&h);
	}
	/* at least a quarter of the roughness goes, and the shape gains */
	CHECK(sqrt(rough[1]) < 0.75 * sqrt(rough[0]));
	CHECK(error[1] < error[0]);
	bake_image_free(&d);
	bake_image_free(&n);
}

static void
impossible_normals_are_limited_and_counted(void)
{
	static const float bad[][3] = { { 0, 0, -1 }, { NAN, 0, 1 },
		{ 0, 0, 0 }, { 1, 0, 1e-6f }, { -1, -1, -1 },
		{ 0, INFINITY, 1 } };
	const struct bake_integrate_params params =
	    BAKE_INTEGRATE_PARAMS_DEFAULT;
	struct bake_image n = image(8, 8, 3), h = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	size_t count = 99;

	for (int i = 0; i < 64; i++) {
		n.data[3 * i] = n.data[3 * i + 1] = 0;
		n.data[3 * i + 2] = 1;
	}
	memcpy(n.data + 30, bad, sizeof bad);
	CHECK_OK(bake_integrate(&n, &params, &h, &count, &err), err);
	CHECK(count == 6);
	for (int i = 0; i < 64; i++) /* the limit of 1000, over a pitch 1/8 */
		CHECK(fabsf(h.data[i]) <= 1000.0f / 8);
	bake_image_free(&h);
	memcpy(n.data + 39, bad[0], sizeof bad[0]); /* no steep one: flat */
	CHECK_OK(bake_integrate(&n, &params, &h, &count, &err), err);
	CHECK(count == 6);
	for (int i = 0; i < 64; i++)
		CHECK(h.data[i] == 0);
	bake_image_free(&n);
	bake_image_free(&h);
}

static void
threads_do_not_show(void)
{
	struct bake_image n = noisy_normals(45, 31);
	const struct bake_wrap mixed = { false, true };
	struct bake_image a = height_of(&n, mixed, BAKE_SLOPE_SCHARR, 0, 1);

	for (int nt = 2; nt <= 7; nt += 5) {
		struct bake_image b =
		    height_of(&n, mixed, BAKE_SLOPE_SCHARR, 0, nt);

		CHECK(memcmp(a.data, b.data, nfloats(&a) * 4) == 0);
		bake_image_free(&b);
	}
	bake_image_free(&a);
	bake_image_free(&n);
}

static void
height_to_depth(void)
{
	static const float in[] = { 0.3f, 0.1f, 0.2f, -0.1f };
	struct bake_image h = image(4, 1, 1);
	struct bake_err err = BAKE_ERR_INIT;
	double scale = 0;
	size_t nclipped = 99;

	memcpy(h.data, in, sizeof in);
	CHECK_OK(bake_depth_from_height(&h, &scale, &nclipped, &err), err);
	CHECK_NEAR(scale, 0.4, 1e-7);
	CHECK(nclipped == 0 && h.data[0] == 0 && h.data[3] == 1);
	CHECK_NEAR(h.data[1], 0.5, 1e-7);
	CHECK_NEAR(h.data[2], 0.25, 1e-7);

	memcpy(h.data, in, sizeof in);
	scale = 0.15;
	CHECK_OK(bake_depth_from_height(&h, &scale, &nclipped, &err), err);
	CHECK(scale == 0.15 && nclipped == 2);
	CHECK(h.data[0] == 0 && h.data[1] == 1 && h.data[3] == 1);
	CHECK_NEAR(h.data[2], 0.1 / 0.15, 2e-7);

	for (int i = 0; i < 4; i++)
		h.data[i] = 0.7f;
	scale = 0;
	CHECK_OK(bake_depth_from_height(&h, &scale, NULL, &err), err);
	CHECK(scale == 0 && h.data[0] == 0 && h.data[3] == 0);
	bake_image_free(&h);
}

static void
bad_arguments_are_told(void)
{
	struct bake_integrate_params params = BAKE_INTEGRATE_PARAMS_DEFAULT;
	struct bake_image two = image(3, 3, 2), n = noisy_normals(3, 3);
	struct bake_image h = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	double scale = -1;

	CHECK(bake_integrate(&two, &params, &h, NULL, &err) == BAKE_EINVAL);
	CHECK(strstr(err.msg, "3 channels, this image has 2") != NULL);
	err.code = BAKE_OK;
	params.damping = NAN;
	CHECK(bake_integrate(&n, &params, &h, NULL, &err) == BAKE_EINVAL);
	CHECK(h.data == NULL);
	err.code = BAKE_OK;
	CHECK(bake_depth_from_height(&two, &scale, NULL, &err) == BAKE_EINVAL);
	bake_image_free(&two);
	two = noise(3, 3, 1);
	err.code = BAKE_OK;
	CHECK(bake_depth_from_height(&two, &scale, NULL, &err) == BAKE_EINVAL);
	CHECK(strstr(err.msg, "-1") != NULL);
	two.data[4] = NAN;
	err.code = BAKE_OK;
	scale = 0;
	CHECK(bake_depth_from_height(&two, &scale, NULL, &err) == BAKE_EDATA);
	CHECK(strstr(err.msg, "texel 1, 1 is not finite") != NULL);
	CHECK(scale == 0);
	bake_image_free(&two);
	bake_image_free(&n);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(inverse_of_the_matching_operator),
		CASE(clamped_noise_comes_back_whole),
		CASE(least_squares_on_normals_that_fit_no_surface),
		CASE(equals_conjugate_gradients),
		CASE(shift_moves_the_heights),
		CASE(damping_quiets_eight_bit_normals),
		CASE(impossible_normals_are_limited_and_counted),
		CASE(threads_do_not_show),
		CASE(height_to_depth),
		CASE(bad_arguments_are_told),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
