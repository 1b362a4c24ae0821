/* Dequantising: never beyond half a code, edges kept, sines recovered. */
/* SPDX-License-Identifier: MIT */
#include "dequantize.h"

#include "check.h"
#include "test_maps.h"

static void
dequantize(struct bake_image *img, int code_max, struct bake_wrap wrap, int nt)
{
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_dequantize(img, code_max, wrap, nt, &err), err);
}

static float
coded(double v, int code_max)
{
	return (float)(floor(v * code_max + 0.5) / code_max);
}

/* Everything from noise to lines; codes 0 and code_max stay in 0..1. */
static void
never_beyond_half_a_code(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 1, 40 }, { 40, 1 },
		{ 7, 9 }, { 65, 66 }, { 130, 40 } };
	static const int codes[] = { 1, 3, 15, 255, 65535 };

	for (int i = 0; i < 6 * 5 * 2; i++) {
		const int cm = codes[i % 5];
		struct bake_image a =
		    noise(sizes[i / 10][0], sizes[i / 10][1], 1);
		struct bake_image v;

		for (size_t k = 0; k < nfloats(&a); k++)
			a.data[k] = coded(a.data[k] * a.data[k], cm);
		v = image(a.width, a.height, 1);
		memcpy(v.data, a.data, nfloats(&a) * sizeof(float));
		dequantize(&a, cm, i / 5 % 2 ? clamped : torus, 1);
		for (size_t k = 0; k < nfloats(&a); k++) {
			/* the bound's own rounding to float */
			CHECK_NEAR(a.data[k], v.data[k], 0.5 / cm + 6e-8);
			CHECK(a.data[k] >= 0 && a.data[k] <= 1);
		}
		bake_image_free(&a);
		bake_image_free(&v);
	}
}

/*
 * RMS error of a quantised sine, before / after; least gains. What remains is
 * bound by the wavelength (texels): below about 30 the curvature itself is
 * what a smoother would take for rounding.
 */
static void
sines_come_back(void)
{
	enum { N = 256 };
	static const struct {
		double amp, ku, kv, gain;
	} cases[] = { { 0.4, 1, 1, 3 }, { 0.1, 1, 2, 5 }, { 0.04, 2, 1, 5 },
		{ 0.01, 1, 1, 5 }, { 0.4, 4, 3, 1.4 }, { 0.4, 16, 5, 1.0 } };

	for (int i = 0; i < 6; i++) {
		struct bake_image a = image(N, N, 1);
		double before = 0, after = 0;

		for (int pass = 0; pass < 2; pass++) {
			for (int k = 0; k < N * N; k++) {
				const double f =
				    0.5 + cases[i].amp *
					      sin(2 * pi *
						  (cases[i].ku * (k % N) +
						      cases[i].kv * (k / N)) /
						  N);

				if (pass == 0)
					a.data[k] = coded(f, 255);
				(pass ? (after += pow(a.data[k] - f, 2))
				      : (before += pow(a.data[k] - f, 2)));
			}
			if (pass == 0)
				dequantize(&a, 255, torus, 0);
		}
		if (!(sqrt(before / after) >= cases[i].gain))
			printf("amplitude %g, wave %g,%g: gain %g\n",
			    cases[i].amp, cases[i].ku, cases[i].kv,
			    sqrt(before / after));
		CHECK(sqrt(before / after) >= cases[i].gain);
		bake_image_free(&a);
	}
}

/* A ramp of one code in 12 texels: a staircase before, a slope after. */
static void
staircase_becomes_a_ramp(void)
{
	enum { W = 240, H = 8 };
	struct bake_image a = image(W, H, 1);

	for (int k = 0; k < W * H; k++)
		a.data[k] = coded((100 + (k % W) / 12.0) / 255, 255);
	dequantize(&a, 255, clamped, 0);
	for (int x = 40; x < W - 40; x++) {
		const float *p = a.data + 3 * W + x;

		CHECK_NEAR(p[0] * 255, 100 + x / 12.0, 0.15);
		/* no step is left: the slope is within half of the true one */
		CHECK_NEAR((p[1] - p[0]) * 255, 1 / 12.0, 0.5 / 12);
	}
	bake_image_free(&a);
}

static void
two_values_keep_their_bits(void)
{
	static const int heights[] = { 5, 60, 255 };

	for (int i = 0; i < 6; i++) {
		struct bake_image a = noise(50, 40, 1), b = noise(50, 40, 1);

		for (int k = 0; k < 2000; k++) {
			const bool high =
			    i % 2 ? a.data[k] > 0.5f : k % 50 % 17 < 3;

			a.data[k] = b.data[k] =
			    (float)(high ? heights[i / 2] : 0) / 255;
		}
		dequantize(&a, 255, torus, 1);
		CHECK(memcmp(a.data, b.data, 2000 * 4) == 0);
		bake_image_free(&a);
		bake_image_free(&b);
	}
}

/* Bricks with softly domed tops: the joint's edge keeps its height. */
static void
bricks_keep_their_edges(void)
{
	enum { N = 128 };
	struct bake_image a = image(N, N, 1), v = image(N, N, 1);

	for (int k = 0; k < N * N; k++) {
		const int x = k % N % 32, y = k / N % 16;
		const double dome = 0.02 * cos((x - 16) * 0.09);

		a.data[k] = v.data[k] =
		    coded(x < 3 || y < 2 ? 0.8 : 0.3 - dome, 255);
	}
	dequantize(&a, 255, torus, 1);
	for (int k = 0; k < N * N - 1; k++) {
		const float step = v.data[k + 1] - v.data[k];

		if (fabsf(step) * 255 > 50) /* half a code off on each side */
			CHECK(fabsf(a.data[k + 1] - a.data[k]) >=
			      fabsf(step) - 1.0f / 255 - 1e-6f);
		if (v.data[k] > 0.7f) /* the joint is flat, and stays so */
			CHECK(a.data[k] == v.data[k]);
	}
	bake_image_free(&a);
	bake_image_free(&v);
}

static void
shift_and_threads_do_not_show(void)
{
	enum { W = 70, H = 50, DX = 23, DY = 41 };
	struct bake_image a = image(W, H, 1), b = image(W, H, 1);
	struct bake_image s = image(W, H, 1);

	for (int k = 0; k < W * H; k++) {
		const double f = 0.5 + 0.2 * sin(2 * pi * (k % W) / W) *
					   cos(2 * pi * 2 * (k / W) / H);

		a.data[k] = b.data[k] = coded(f, 255);
		s.data[(k / W + DY) % H * W + (k % W + DX) % W] = a.data[k];
	}
	dequantize(&a, 255, torus, 1);
	dequantize(&b, 255, torus, 7);
	dequantize(&s, 255, torus, 2);
	CHECK(memcmp(a.data, b.data, W * H * 4) == 0);
	for (int k = 0; k < W * H; k++)
		CHECK(s.data[(k / W + DY) % H * W + (k % W + DX) % W] ==
		      a.data[k]);
	bake_image_free(&a);
	bake_image_free(&b);
	bake_image_free(&s);
}

static void
measure_counts_single_steps(void)
{
	struct bake_image a = image(10, 4, 1);
	double step = 0, share = 0;

	/* codes 0 0 1 1 2 2 9 9 9 9: two single steps in ten columns */
	static const int row[] = { 0, 0, 1, 1, 2, 2, 9, 9, 9, 9 };

	for (int k = 0; k < 40; k++)
		a.data[k] = (float)row[k % 10] / 255;
	bake_quantization_matters(&a, 255, 0.25, &step, &share);
	CHECK_NEAR(step, 0.25 * 10 / 255, 1e-15);
	CHECK_NEAR(share, 0.2, 1e-15);
	bake_quantization_matters(&a, 65535, -0.25, &step, &share);
	CHECK_NEAR(step, 0.25 * 10 / 65535, 1e-15);
	CHECK(share == 0);
	bake_image_free(&a);
}

static void
bad_arguments_are_told(void)
{
	struct bake_image two = noise(4, 4, 2), one = noise(4, 4, 1);
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_dequantize(&two, 255, torus, 1, &err) == BAKE_EINVAL);
	CHECK(strstr(err.msg, "1 channel, this image has 2") != NULL);
	err.code = BAKE_OK;
	CHECK(bake_dequantize(&one, 0, torus, 1, &err) == BAKE_EINVAL);
	err.code = BAKE_OK;
	CHECK(bake_dequantize(&one, 65536, torus, 1, &err) == BAKE_EINVAL);
	CHECK(strstr(err.msg, "65536, expected 1 to 65535") != NULL);
	bake_image_free(&two);
	bake_image_free(&one);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(never_beyond_half_a_code),
		CASE(sines_come_back),
		CASE(staircase_becomes_a_ramp),
		CASE(two_values_keep_their_bits),
		CASE(bricks_keep_their_edges),
		CASE(shift_and_threads_do_not_show),
		CASE(measure_counts_single_steps),
		CASE(bad_arguments_are_told),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
