/* AO after rescaling: Eq. 6, the exact answer from horizons, errors. */
/* SPDX-License-Identifier: MIT */
#include "ao_rescale.h"

#include <float.h>

#include "check.h"
#include "codes.h"
#include "test_maps.h"

static const double factors[] = { 1.0 / 16, 0.25, 0.5, 0.71, 1, 1.4, 2, 2.5, 4,
	16 };
enum { NFACTORS = sizeof factors / sizeof *factors };

/* Eq. 4 to 6 as the paper has them, by way of the two radii. */
static long double
paper(long double ao, long double s)
{
	long double r = sqrtl(ao), h = sqrtl(1 - r * r);
	long double r_new = sqrtl(s * h * (s * h) + r * r);

	return ao / (r_new * r_new);
}

static double
steeper(double s)
{
	return s > 1 ? s * s : 1 / (s * s);
}

static void
every_code_is_eq_6(void)
{
	static const int max[] = { 255, 65535 };

	for (int m = 0; m < 2; m++)
		for (int k = 0; k < NFACTORS; k++) {
			const double s = factors[k];
			double worst = 0;

			for (int c = 0; c <= max[m]; c++) {
				float v = (float)((double)c / max[m]);
				float out = bake_ao_rescale(v, s);
				long double want =
				    paper((long double)c / max[m], s);
				uint16_t code;

				bake_codes_to_u16(&code, &out, 1);
				if (max[m] == 255) {
					uint8_t small;

					bake_codes_to_u8(&small, &out, 1);
					code = small;
				}
				worst = fmax(worst,
				    fabs(code - (double)(want * max[m])));
			}
			/* half a code; v and the result are floats: 2^-25
			 * each, the first grown by the curve's slope */
			CHECK(
			    worst <= 0.5 + max[m] * 0x1p-25 * (1 + steeper(s)));
		}
}

static void
the_limits_are_those_of_the_formula(void)
{
	const double tiny = 0x1p-149;

	for (int c = 0; c <= 65535; c++) {
		float v = (float)(c / 65535.0);

		CHECK(bake_ao_rescale(v, 1) == v);
		CHECK(bake_ao_rescale(v, 0) == 1);
	}
	for (int k = 0; k < NFACTORS; k++) {
		CHECK(bake_ao_rescale(1, factors[k]) == 1);
		CHECK(bake_ao_rescale(0, factors[k]) == 0);
	}
	CHECK(bake_ao_rescale((float)tiny, 1) == (float)tiny);
	CHECK(bake_ao_rescale(0.5f, 1e6) > 0);
	CHECK(bake_ao_rescale(-3, 2) == 0);
	CHECK(bake_ao_rescale(-3, 0) == 1);
	CHECK(bake_ao_rescale(7, 2) == 1);
	CHECK(bake_ao_rescale(INFINITY, 2) == 1);
	CHECK(isnan(bake_ao_rescale(NAN, 2)));
}

static void
it_rises_in_ao_and_falls_in_s(void)
{
	for (int c = 1; c < 1000; c++)
		for (int k = 1; k < NFACTORS; k++) {
			float v = (float)(c / 1000.0);

			CHECK(bake_ao_rescale(v, factors[k]) <
			      bake_ao_rescale(v, factors[k - 1]));
			CHECK(bake_ao_rescale(v, factors[k]) <
			      bake_ao_rescale(v + 0.001f, factors[k]));
		}
}

/* There in 16-bit codes, back in 16-bit codes; between them a float, or
 * (coded) a 16-bit code. Returns the worst difference in codes. */
static int
there_and_back(double s, bool coded)
{
	int worst = 0;

	for (int c = 0; c <= 65535; c++) {
		uint16_t code = (uint16_t)c;
		float v;

		bake_codes_from_u16(&v, &code, 1);
		v = bake_ao_rescale(v, s);
		if (coded) {
			bake_codes_to_u16(&code, &v, 1);
			bake_codes_from_u16(&v, &code, 1);
		}
		v = bake_ao_rescale(v, 1 / s);
		bake_codes_to_u16(&code, &v, 1);
		worst = abs(code - c) > worst ? abs(code - c) : worst;
	}
	return worst;
}

static void
s_and_then_1_over_s_returns_the_start(void)
{
	for (int k = 0; k < NFACTORS; k++) {
		const double s = factors[k];

		/* a float of 2^-25 grows by up to 256: half a code at 16 */
		CHECK(there_and_back(s, false) <= (steeper(s) > 100 ? 1 : 0));
		/* half a code between grows by the slope; then rounding */
		CHECK(there_and_back(s, true) <= steeper(s) / 2 + 0.5);
	}
	CHECK(there_and_back(1.4, true) <= 1);
	CHECK(there_and_back(0.71, true) <= 1);
}

static void
two_factors_are_their_product(void)
{
	for (int c = 0; c <= 1000; c++) {
		float v = (float)(c / 1000.0);
		double once = bake_ao_rescale(v, 3.0 * 0.7);
		double twice = bake_ao_rescale(bake_ao_rescale(v, 3), 0.7);

		/* one float rounding between, slope at most 1 / 0.49 */
		CHECK_NEAR(twice, once, 0x1p-24 * (1 + 1 / 0.49));
	}
}

static void
an_image_changes_in_one_channel(void)
{
	struct bake_image img = noise(61, 37, 4), was = noise(61, 37, 4);
	struct bake_image many = noise(61, 37, 4);
	struct bake_err err = BAKE_ERR_INIT;
	int nwrong = 0;

	img.data[4] = was.data[4] = many.data[4] = NAN;
	CHECK_OK(bake_ao_rescale_image(&img, 2, 2.5, 1, &err), err);
	CHECK_OK(bake_ao_rescale_image(&many, 2, 2.5, 7, &err), err);
	for (size_t i = 0; i < nfloats(&img); i++) {
		float want = i % 4 == 2 ? bake_ao_rescale(was.data[i], 2.5)
					: was.data[i];

		nwrong += memcmp(&img.data[i], &want, sizeof want) != 0;
	}
	CHECK(nwrong == 0);
	CHECK(memcmp(img.data, many.data, nfloats(&img) * sizeof(float)) == 0);
	bake_image_free(&img);
	bake_image_free(&was);
	bake_image_free(&many);
}

/* -- horizons ------------------------------------------------------------ */

static struct bake_ao_rescale_params
unblurred(enum bake_ao_estimator estimator)
{
	struct bake_ao_rescale_params p = BAKE_AO_RESCALE_PARAMS_DEFAULT;

	p.blur = BAKE_AO_BLUR_NONE;
	p.estimator = estimator;
	return p;
}

static double
one_texel(const struct bake_image *tans, double s,
    const struct bake_ao_rescale_params *p)
{
	struct bake_image ao = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	double v;

	CHECK_OK(bake_ao_rescale_horizons(tans, s, p, &ao, &err), err);
	CHECK(ao.nchans == 1 && ao.width == tans->width);
	v = ao.data[0];
	bake_image_free(&ao);
	return v;
}

/* A pit of the same rim all round: AO = 1 / (1 + s^2 tan^2 e), by either
 * estimator, and here alone Eq. 6 is exact. */
static void
a_round_pit_is_eq_6(void)
{
	for (int e = 0; e < 2; e++)
		for (int k = 0; k < NFACTORS; k++)
			for (double t = 0.01; t < 30; t *= 1.7) {
				struct bake_ao_rescale_params p =
				    unblurred((enum bake_ao_estimator)e);
				struct bake_image tans = image(1, 1, 50);
				const double s = factors[k];
				double want = 1 / (1 + s * s * t * t), one;

				for (int j = 0; j < 50; j++)
					tans.data[j] = (float)t;
				one = one_texel(&tans, 1, &p);
				/* tan and AO are floats, AO' moves by at most
				 * twice a relative change of tan */
				CHECK_NEAR(
				    one_texel(&tans, s, &p), want, 3 * 0x1p-24);
				CHECK_NEAR(bake_ao_rescale((float)one, s), want,
				    2 * 0x1p-24 * (1 + steeper(s)));
				bake_image_free(&tans);
			}
}

/* At the foot of a high wall half of the sky is gone at every depth. */
static void
half_open_is_half_open_at_any_scale(void)
{
	struct bake_ao_rescale_params mean = unblurred(BAKE_AO_MEAN);
	struct bake_ao_rescale_params polygon = unblurred(BAKE_AO_POLYGON);
	struct bake_image tans = image(1, 1, 50);

	for (int wall = 0; wall < 2; wall++) {
		for (int j = 0; j < 50; j++)
			tans.data[j] = j < 25 ? 0 : wall ? INFINITY : 1e4f;
		/* 1e-8 of light comes over a wall of tan e = 1e4 */
		CHECK_NEAR(one_texel(&tans, 1, &mean), 0.5, 1e-7);
		CHECK_NEAR(one_texel(&tans, 4, &mean), 0.5, 1e-7);
		/* 24 of 50 edges are open; r = 1e-4 on two more */
		CHECK_NEAR(one_texel(&tans, 1, &polygon), 0.48, 5e-6);
		CHECK_NEAR(one_texel(&tans, 4, &polygon), 0.48, 5e-6);
	}
	CHECK_NEAR(bake_ao_rescale(0.5f, 4), 1.0 / 17, 1e-8);
	bake_image_free(&tans);
}

/* Of the mean estimator, by Jensen's inequality. */
static void
eq_6_errs_to_one_side(void)
{
	struct bake_ao_rescale_params p = unblurred(BAKE_AO_MEAN);

	for (int n = 0; n < 200; n++)
		for (int k = 0; k < NFACTORS; k++) {
			struct bake_image tans = image(1, 1, 12);
			const double s = factors[k];
			double guess, truth;

			for (int j = 0; j < 12; j++)
				tans.data[j] =
				    (float)(hash((uint32_t)(12 * n + j)) %
					    1000) /
				    200;
			guess =
			    bake_ao_rescale((float)one_texel(&tans, 1, &p), s);
			truth = one_texel(&tans, s, &p);
			/* but for the rounding of AO to a float */
			CHECK((guess - truth) * (s > 1 ? 1 : -1) <=
			      0x1p-24 * (1 + steeper(s)));
			if (s >= 2)
				CHECK(truth > 1.01 * guess);
			bake_image_free(&tans);
		}
}

static void
odd_horizons_have_their_meaning(void)
{
	struct bake_ao_rescale_params p = unblurred(BAKE_AO_MEAN);
	struct bake_image tans = image(1, 1, 4);

	for (int j = 0; j < 4; j++)
		tans.data[j] = 0;
	tans.data[0] = NAN;
	tans.data[1] = -2;
	CHECK(one_texel(&tans, 3, &p) == 1);
	tans.data[2] = INFINITY;
	CHECK(one_texel(&tans, 3, &p) == 0.75);
	CHECK(one_texel(&tans, 0, &p) == 1);
	p.estimator = BAKE_AO_POLYGON;
	CHECK(one_texel(&tans, 3, &p) == 0.5);
	bake_image_free(&tans);
}

static struct bake_image
bake_at(const struct bake_image *depth, double scale,
    const struct bake_ao_rescale_params *p, struct bake_image *horizons)
{
	struct bake_ao_params q = BAKE_AO_PARAMS_DEFAULT;
	struct bake_image ao = BAKE_IMAGE_INIT;
	struct bake_ao_result res = { &ao, NULL, horizons };
	struct bake_err err = BAKE_ERR_INIT;

	q.estimator = p->estimator;
	q.blur = p->blur;
	q.blur_sigma = p->blur_sigma;
	q.wrap = p->wrap;
	CHECK_OK(bake_ao(depth, &scale, 1, &q, &res, &err), err);
	return ao;
}

/* The same as a fresh bake at the other scale, blurred as it is. */
static void
horizons_give_the_bake_at_the_new_scale(void)
{
	static const struct {
		enum bake_ao_estimator estimator;
		enum bake_ao_blur blur;
		double sigma, s;
		bool clamp;
	} cases[] = {
		{ BAKE_AO_POLYGON, BAKE_AO_BLUR_NONE, 0, 2.5, false },
		{ BAKE_AO_MEAN, BAKE_AO_BLUR_NONE, 0, 0.3, true },
		{ BAKE_AO_POLYGON, BAKE_AO_BLUR_PAPER, 1, 4, false },
		{ BAKE_AO_POLYGON, BAKE_AO_BLUR_PAPER, 1, 0.25, true },
		{ BAKE_AO_POLYGON, BAKE_AO_BLUR_OCCLUDED, 2, 3, false },
		{ BAKE_AO_MEAN, BAKE_AO_BLUR_OCCLUDED, 1, 0, false },
	};
	struct bake_image depth = noise(48, 33, 1);

	/* a plane, so that some texels are open */
	for (int i = 0; i < 48 * 33 / 2; i++)
		depth.data[i] = 0.25f;
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		struct bake_ao_rescale_params p =
		    BAKE_AO_RESCALE_PARAMS_DEFAULT;
		struct bake_image horizons = BAKE_IMAGE_INIT;
		struct bake_image old, want, got = BAKE_IMAGE_INIT;
		struct bake_err err = BAKE_ERR_INIT;
		struct bake_ao_error e;

		p.estimator = cases[k].estimator;
		p.blur = cases[k].blur;
		p.blur_sigma = cases[k].sigma;
		p.wrap = cases[k].clamp ? clamped : torus;
		old = bake_at(&depth, 0.1, &p, &horizons);
		want = bake_at(&depth, 0.1 * cases[k].s, &p, NULL);
		CHECK_OK(bake_ao_rescale_horizons(
			     &horizons, cases[k].s, &p, &got, &err),
		    err);
		CHECK_OK(bake_ao_compare(&got, &want, &e, NULL, &err), err);
		/* bake_ao sums 50 floats below 1: 50 * 2^-25; and the tans
		 * and r_j are rounded to floats */
		CHECK_NEAR(e.max, 0, 2e-6);
		/* that it is another map than the old one */
		CHECK_OK(bake_ao_compare(&old, &want, &e, NULL, &err), err);
		CHECK(e.max > 0.1);
		bake_image_free(&horizons);
		bake_image_free(&old);
		bake_image_free(&want);
		bake_image_free(&got);
	}
	bake_image_free(&depth);
}

static void
threads_change_no_bit(void)
{
	struct bake_image tans = noise(50, 41, 7);
	struct bake_image one = BAKE_IMAGE_INIT, many = BAKE_IMAGE_INIT;
	struct bake_ao_rescale_params p = BAKE_AO_RESCALE_PARAMS_DEFAULT;
	struct bake_err err = BAKE_ERR_INIT;

	p.nthreads = 1;
	CHECK_OK(bake_ao_rescale_horizons(&tans, 1.7, &p, &one, &err), err);
	p.nthreads = 5;
	CHECK_OK(bake_ao_rescale_horizons(&tans, 1.7, &p, &many, &err), err);
	CHECK(memcmp(one.data, many.data, nfloats(&one) * sizeof(float)) == 0);
	bake_image_free(&tans);
	bake_image_free(&one);
	bake_image_free(&many);
}

/* -- errors ---------------------------------------------------------------- */

static int
by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

static void
errors_are_those_of_a_sorted_list(void)
{
	static const int sides[][2] = { { 1, 1 }, { 9, 11 }, { 10, 10 },
		{ 101, 1 }, { 97, 61 } };

	for (size_t k = 0; k < sizeof sides / sizeof *sides; k++) {
		struct bake_image a = noise(sides[k][0], sides[k][1], 1);
		struct bake_image b = image(sides[k][0], sides[k][1], 1);
		struct bake_image d = BAKE_IMAGE_INIT;
		struct bake_err err = BAKE_ERR_INIT;
		struct bake_ao_error e;
		const size_t n = nfloats(&a);
		float *sorted = calloc(n, sizeof *sorted);
		double sum = 0, bias = 0;
		int nwrong = 0;

		for (size_t i = 0; i < n; i++)
			b.data[i] = a.data[(i * 7 + 3) % n];
		CHECK_OK(bake_ao_compare(&a, &b, &e, &d, &err), err);
		for (size_t i = 0; i < n; i++) {
			sorted[i] = fabsf(a.data[i] - b.data[i]);
			sum += sorted[i];
			bias += a.data[i] - b.data[i];
			nwrong += d.data[i] != a.data[i] - b.data[i];
		}
		qsort(sorted, n, sizeof *sorted, by_value);
		CHECK(nwrong == 0);
		/* sums of n doubles */
		CHECK_NEAR(e.mean, sum / (double)n, 1e-12);
		CHECK_NEAR(e.bias, bias / (double)n, 1e-12);
		CHECK(e.max == sorted[n - 1]);
		CHECK(e.p99 == sorted[(99 * n + 99) / 100 - 1]);
		CHECK(e.max == fabsf(d.data[e.y * d.width + e.x]));
		free(sorted);
		bake_image_free(&a);
		bake_image_free(&b);
		bake_image_free(&d);
	}
}

static void
bad_parameters_are_refused(void)
{
	static const double bad[] = { -1, 1.1e6, NAN, INFINITY };
	struct bake_image img = noise(8, 8, 4), was = noise(8, 8, 4);
	struct bake_image two = noise(8, 8, 2), ao = BAKE_IMAGE_INIT;
	struct bake_image none = BAKE_IMAGE_INIT, other = noise(8, 7, 1);
	struct bake_ao_rescale_params good = BAKE_AO_RESCALE_PARAMS_DEFAULT;

	for (int k = 0; k < 9; k++) {
		struct bake_err err = BAKE_ERR_INIT;
		enum bake_status rc =
		    bake_ao_rescale_image(k == 4 ? &none : &img,
			k == 5   ? 4
			: k == 6 ? -1
				 : 2,
			k < 4 ? bad[k] : 2, k == 7 ? -1 : 1, &err);

		CHECK(rc == (k == 8 ? BAKE_OK : BAKE_EINVAL));
		CHECK((err.msg[0] != '\0') == (k < 8));
		if (k < 8)
			CHECK(memcmp(img.data, was.data,
				  nfloats(&img) * sizeof(float)) == 0);
	}
	for (int k = 0; k < 12; k++) {
		struct bake_err err = BAKE_ERR_INIT;
		struct bake_ao_rescale_params p = good;
		enum bake_status rc;

		p.estimator = k == 6 ? (enum bake_ao_estimator)9 : p.estimator;
		p.blur = k == 7 ? (enum bake_ao_blur)9 : p.blur;
		p.blur_sigma = k == 8 ? 257 : k == 9 ? NAN : 1;
		p.nthreads = k == 10 ? -1 : 1;
		rc = bake_ao_rescale_horizons(k == 4   ? &none
					      : k == 5 ? &two
						       : &img,
		    k < 4 ? bad[k] : 2, &p, &ao, &err);
		CHECK(rc == (k == 11 ? BAKE_OK : BAKE_EINVAL));
		CHECK((err.msg[0] != '\0') == (k < 11));
		CHECK((ao.data != NULL) == (k == 11));
	}
	for (int k = 0; k < 2; k++) {
		struct bake_err err = BAKE_ERR_INIT;
		struct bake_ao_error e;

		CHECK(bake_ao_compare(&ao, k ? &img : &other, &e, &none,
			  &err) == BAKE_EDATA);
		CHECK(none.data == NULL && err.msg[0] != '\0');
	}
	bake_image_free(&img);
	bake_image_free(&was);
	bake_image_free(&two);
	bake_image_free(&other);
	bake_image_free(&ao);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(every_code_is_eq_6),
		CASE(the_limits_are_those_of_the_formula),
		CASE(it_rises_in_ao_and_falls_in_s),
		CASE(s_and_then_1_over_s_returns_the_start),
		CASE(two_factors_are_their_product),
		CASE(an_image_changes_in_one_channel),
		CASE(a_round_pit_is_eq_6),
		CASE(half_open_is_half_open_at_any_scale),
		CASE(eq_6_errs_to_one_side),
		CASE(odd_horizons_have_their_meaning),
		CASE(horizons_give_the_bake_at_the_new_scale),
		CASE(threads_change_no_bit),
		CASE(errors_are_those_of_a_sorted_list),
		CASE(bad_parameters_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
