/* Normals from depth: closed forms, symmetries, an oracle, unit length. */
/* SPDX-License-Identifier: MIT */
#include "normal.h"

#include "check.h"
#include "test_maps.h"

static const enum bake_slope_op ops[] = { BAKE_SLOPE_CENTRAL,
	BAKE_SLOPE_SCHARR };

/* One rounding of a float of size up to 1. */
static const double float_eps = 6e-8;

static const float *
at(const struct bake_image *img, int x, int y)
{
	return bake_image_row(img, bake_wrap_index(y, img->height, false)) +
	       bake_wrap_index(x, img->width, false) * img->nchans;
}

static struct bake_image
normals(const struct bake_image *depth, double s, struct bake_wrap wrap,
    enum bake_slope_op op, int nt)
{
	struct bake_image n = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_normal_from_depth(depth, s, wrap, op, nt, &n, &err), err);
	if (n.data == NULL)
		abort();
	return n;
}

static void
flat_is_exactly_up(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 1, 7 }, { 7, 1 }, { 2, 2 },
		{ 5, 4 } };
	static const double scales[] = { 0.1, -0.1, 0 };

	for (size_t i = 0; i < 5 * 2 * 2 * 3; i++) {
		struct bake_image d =
		    image(sizes[i / 12][0], sizes[i / 12][1], 1);
		struct bake_image n;

		for (int k = 0; k < d.width * d.height; k++)
			d.data[k] = 0.3f;
		n = normals(&d, scales[i % 3], i / 3 % 2 ? clamped : torus,
		    ops[i / 6 % 2], 1);
		for (int k = 0; k < d.width * d.height; k++) {
			CHECK(n.data[3 * k] == 0 && !signbit(n.data[3 * k]));
			CHECK(n.data[3 * k + 1] == 0 &&
			      !signbit(n.data[3 * k + 1]));
			CHECK(n.data[3 * k + 2] == 1);
		}
		bake_image_free(&d);
		bake_image_free(&n);
	}
}

/* Depth falls to the right (h rises) and grows downwards (h rises upwards). */
static void
plane_has_its_slopes_and_their_signs(void)
{
	const double s = 0.25, a = 1.0 / 64, b = 1.0 / 128;
	struct bake_image d = image(32, 16, 1), n;
	/* all exact but the last rounding: a, b are powers of 2 */
	const double p = 32 * s * a, q = 32 * s * b;
	const double len = sqrt(1 + p * p + q * q);

	for (int y = 0; y < 16; y++)
		for (int x = 0; x < 32; x++)
			d.data[y * 32 + x] = (float)(0.5 - a * x + b * y);
	for (int op = 0; op < 2; op++) {
		n = normals(&d, s, clamped, ops[op], 1);
		for (int y = 1; y < 15; y++)
			for (int x = 1; x < 31; x++) {
				const float *v = at(&n, x, y);

				CHECK_NEAR(v[0], -p / len, float_eps);
				CHECK_NEAR(v[1], -q / len, float_eps);
				CHECK_NEAR(v[2], 1 / len, float_eps);
			}
		/* at a clamped border: half the difference */
		CHECK_NEAR(at(&n, 0, 8)[0] / at(&n, 0, 8)[2], -p / 2, 2e-7);
		CHECK_NEAR(at(&n, 8, 15)[1] / at(&n, 8, 15)[2], -q / 2, 2e-7);
		bake_image_free(&n);
	}
	bake_image_free(&d);
}

/*
 * d = sin(2 pi (k x + l y) / W) / 4 on the torus has slopes within the
 * operators' second-order error of the analytic ones: |h'''| / 6 for central,
 * and with SCHARR's smoothing 3/16 |h'''| on top.
 */
static void
tilted_sine_to_second_order(void)
{
	enum { W = 128 };
	const double s = 0.1, kx = 2, ky = 3;
	struct bake_image d = image(W, W, 1), n;

	for (int y = 0; y < W; y++)
		for (int x = 0; x < W; x++)
			d.data[y * W + x] =
			    (float)(0.5 +
				    0.25 * sin(2 * pi * (kx * x + ky * y) / W));
	for (int op = 0; op < 2; op++) {
		const double w = 2 * pi * ky / W;
		const double amp = 0.25 * s * 2 * pi * ky;
		const double bound =
		    amp * w * w * (1.0 / 6 + op * 3.0 / 16) + W * s * float_eps;

		n = normals(&d, s, torus, ops[op], 1);
		for (int y = 0; y < W; y++)
			for (int x = 0; x < W; x++) {
				const float *v = at(&n, x, y);
				const double c =
				    cos(2 * pi * (kx * x + ky * y) / W);

				/* h = -s d; upwards is -y */
				CHECK_NEAR(-v[0] / v[2],
				    -s * 0.25 * 2 * pi * kx * c, bound);
				CHECK_NEAR(-v[1] / v[2],
				    s * 0.25 * 2 * pi * ky * c, bound);
			}
		bake_image_free(&n);
	}
	bake_image_free(&d);
}

/* The obvious double loop over the 3x3 window. */
static void
oracle(const struct bake_image *d, double s, struct bake_wrap wrap, int op,
    int x, int y, double n[3])
{
	static const double smooth[2][3] = { { 0, 1, 0 },
		{ 3.0 / 16, 10.0 / 16, 3.0 / 16 } };
	double p = 0, q = 0, len;

	for (int j = -1; j <= 1; j++)
		for (int i = -1; i <= 1; i++) {
			const int yy =
			    bake_wrap_index(y + j, d->height, wrap.clamp_v);
			const int xx =
			    bake_wrap_index(x + i, d->width, wrap.clamp_u);
			const double h =
			    s * (1 - bake_image_row(d, yy)[xx]) * d->width;

			p += smooth[op][j + 1] * i * h / 2;
			q -= smooth[op][i + 1] * j * h / 2;
		}
	len = sqrt(1 + p * p + q * q);
	n[0] = -p / len;
	n[1] = -q / len;
	n[2] = 1 / len;
}

static void
equals_the_obvious_loop(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 1, 5 }, { 2, 3 }, { 3, 2 },
		{ 16, 9 } };

	for (int i = 0; i < 5 * 8; i++) {
		struct bake_image d =
		    noise(sizes[i / 8][0], sizes[i / 8][1], 1);
		const struct bake_wrap wrap = { i % 2, i / 2 % 2 };
		const int op = i / 4 % 2;
		struct bake_image n = normals(&d, 0.2, wrap, ops[op], 1);

		for (int y = 0; y < d.height; y++)
			for (int x = 0; x < d.width; x++) {
				double want[3];

				oracle(&d, 0.2, wrap, op, x, y, want);
				for (int c = 0; c < 3; c++)
					CHECK_NEAR(at(&n, x, y)[c], want[c],
					    float_eps);
			}
		bake_image_free(&d);
		bake_image_free(&n);
	}
}

static void
shift_and_flip_move_the_normals(void)
{
	enum { W = 13, H = 10, DX = 5, DY = 3 };
	struct bake_image d = noise(W, H, 1), shifted = image(W, H, 1);
	struct bake_image flipped = image(W, H, 1), n, ns, nf;

	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			shifted.data[y * W + x] = *at(&d, x - DX, y - DY);
			flipped.data[y * W + x] = *at(&d, W - 1 - x, H - 1 - y);
		}
	for (int op = 0; op < 2; op++) {
		n = normals(&d, 0.1, torus, ops[op], 1);
		ns = normals(&shifted, 0.1, torus, ops[op], 1);
		nf = normals(&flipped, 0.1, torus, ops[op], 1);
		for (int y = 0; y < H; y++)
			for (int x = 0; x < W; x++) {
				const float *f = at(&nf, x, y);
				const float *v = at(&n, W - 1 - x, H - 1 - y);

				CHECK(memcmp(at(&ns, x, y),
					  at(&n, x - DX, y - DY),
					  3 * sizeof(float)) == 0);
				CHECK(f[0] == -v[0] && f[1] == -v[1] &&
				      f[2] == v[2]);
			}
		bake_image_free(&n);
		bake_image_free(&ns);
		bake_image_free(&nf);
	}
	bake_image_free(&d);
	bake_image_free(&shifted);
	bake_image_free(&flipped);
}

static void
slopes_are_linear_in_the_scale(void)
{
	struct bake_image d = noise(12, 12, 1), a, b, c;

	a = normals(&d, 0.01, torus, BAKE_SLOPE_SCHARR, 1);
	b = normals(&d, 0.02, torus, BAKE_SLOPE_SCHARR, 1);
	c = normals(&d, -0.01, torus, BAKE_SLOPE_SCHARR, 1);
	for (int i = 0; i < 144; i++) {
		const float *p = a.data + 3 * i, *q = b.data + 3 * i;

		/* two floats' ratio each side, slopes below 1 */
		CHECK_NEAR(q[0] / q[2], 2.0 * p[0] / p[2], 4 * float_eps);
		CHECK_NEAR(q[1] / q[2], 2.0 * p[1] / p[2], 4 * float_eps);
		CHECK(c.data[3 * i] == -p[0] && c.data[3 * i + 1] == -p[1]);
	}
	bake_image_free(&a);
	bake_image_free(&b);
	bake_image_free(&c);
	bake_image_free(&d);
}

static void
threads_do_not_show(void)
{
	struct bake_image d = noise(37, 29, 1);
	struct bake_image a = normals(&d, 0.3, torus, BAKE_SLOPE_SCHARR, 1);

	for (int nt = 2; nt <= 7; nt += 5) {
		struct bake_image b =
		    normals(&d, 0.3, torus, BAKE_SLOPE_SCHARR, nt);

		CHECK(memcmp(a.data, b.data, 37 * 29 * 3 * 4) == 0);
		bake_image_free(&b);
	}
	bake_image_free(&a);
	bake_image_free(&d);
}

static void
normalize_three_channels(void)
{
	static const float in[][3] = { { 0, 0, 0 }, { 3, 0, 4 }, { NAN, 0, 1 },
		{ 0, INFINITY, 1 }, { 1e-30f, 0, 0 }, { -1, -2, -2 },
		{ 1e30f, 0, 0 } };
	static const float want[][3] = { { 0, 0, 1 }, { 0.6f, 0, 0.8f },
		{ 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 },
		{ -1 / 3.0f, -2 / 3.0f, -2 / 3.0f }, { 0, 0, 1 } };
	struct bake_image n = image(7, 1, 3);
	struct bake_err err = BAKE_ERR_INIT;
	size_t count = 99;

	memcpy(n.data, in, sizeof in);
	CHECK_OK(bake_normal_normalize(&n, 2, &count, &err), err);
	CHECK(count == 5);
	for (int i = 0; i < 21; i++)
		CHECK_NEAR(n.data[i], (&want[0][0])[i], float_eps);
	bake_image_free(&n);
}

static void
normalize_adds_the_third_channel(void)
{
	static const float in[][2] = { { 0, 0 }, { 0.6f, 0 }, { 3, 4 },
		{ NAN, 0 }, { 0, -1 } };
	static const float want[][3] = { { 0, 0, 1 }, { 0.6f, 0, 0.8f },
		{ 0.6f, 0.8f, 0 }, { 0, 0, 1 }, { 0, -1, 0 } };
	struct bake_image n = image(5, 1, 2);
	struct bake_err err = BAKE_ERR_INIT;
	size_t count = 99;

	memcpy(n.data, in, sizeof in);
	CHECK_OK(bake_normal_normalize(&n, 1, &count, &err), err);
	CHECK(count == 2);
	CHECK(n.nchans == 3 && n.width == 5 && n.height == 1);
	for (int i = 0; i < 15; i++)
		CHECK_NEAR(n.data[i], (&want[0][0])[i], float_eps);
	CHECK(n.data[3] == 0.6f);
	bake_image_free(&n);
}

static void
bad_arguments_are_told(void)
{
	struct bake_image d = image(4, 4, 2), n = BAKE_IMAGE_INIT;
	struct bake_image one = image(4, 4, 1);
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_normal_from_depth(&d, 0.1, torus, BAKE_SLOPE_CENTRAL, 1, &n,
		  &err) == BAKE_EINVAL);
	CHECK(strstr(err.msg, "this image has 2") != NULL);
	err.code = BAKE_OK;
	CHECK(bake_normal_from_depth(&one, NAN, torus, BAKE_SLOPE_CENTRAL, 1,
		  &n, &err) == BAKE_EINVAL);
	err.code = BAKE_OK;
	CHECK(bake_normal_from_depth(&one, 0.1, torus, (enum bake_slope_op)7, 1,
		  &n, &err) == BAKE_EINVAL);
	CHECK(strstr(err.msg, "7 is no slope operator") != NULL);
	err.code = BAKE_OK;
	CHECK(bake_normal_normalize(&one, 1, NULL, &err) == BAKE_EINVAL);
	CHECK(n.data == NULL);
	bake_image_free(&d);
	bake_image_free(&one);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(flat_is_exactly_up),
		CASE(plane_has_its_slopes_and_their_signs),
		CASE(tilted_sine_to_second_order),
		CASE(equals_the_obvious_loop),
		CASE(shift_and_flip_move_the_normals),
		CASE(slopes_are_linear_in_the_scale),
		CASE(threads_do_not_show),
		CASE(normalize_three_channels),
		CASE(normalize_adds_the_third_channel),
		CASE(bad_arguments_are_told),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
