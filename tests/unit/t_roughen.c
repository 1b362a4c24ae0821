/* The remap: formulas by an oracle, closed forms of the contrast, percentiles.
 */
/* SPDX-License-Identifier: MIT */
#include "test_roughen.h"

static const double pi = 3.14159265358979323846;

/* METHODS 5 word by word, with the C library's functions. */
static double
oracle(enum bake_roughen_model model, double s, double m, double p5, double p95,
    double t, double theta)
{
	const double big = s * pi / 2;
	double d, g = cos(theta);

	switch (model) {
	case BAKE_ROUGHEN_PAPER:
		d = fmax(-1, fmin(1, (t - m) / m));
		if (t != m)
			g = cos(theta - s * (t > m ? 1 : -1) * acos(d));
		break;
	case BAKE_ROUGHEN_FACET:
		d = (t - m) / (t > m ? p95 - m : m - p5);
		g = cos(theta - big * fmax(-1, fmin(1, d)));
		break;
	case BAKE_ROUGHEN_BLACKSHOT:
		if (t * cos(theta) < m * sin(big) * sin(theta))
			g = 0;
		break;
	default:
		break;
	}
	return fmax(0, g);
}

static void
gain_is_the_formula(void)
{
	const struct bake_roughen_stats stats = { 0.3, 0.5, 0.65 };
	const double strengths[] = { 0, 0.09, 0.31, 0.5, 1 };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_roughen r;

	for (int model = 0; model < BAKE_ROUGHEN_MODELS; model++)
		for (int i = 0; i < 5; i++) {
			const double s = strengths[i];

			CHECK_OK(bake_roughen_init(&r,
				     (enum bake_roughen_model)model, s, &stats,
				     &err),
			    err);
			/* odd steps: no texel on blackshot's edge */
			for (double t = -0.1003; t < 1.4; t += 0.00617)
				for (int a = 0; a <= 180; a += 3) {
					double c, sn, want;

					bake_roughen_angle(a, &c, &sn);
					want = oracle(
					    (enum bake_roughen_model)model, s,
					    0.5, 0.3, 0.65, t, a * pi / 180);
					/* 8e-15 of the arc cosine and some
					 * roundings of either side */
					CHECK_NEAR(
					    bake_roughen_gain(&r, t, c, sn),
					    want, 2e-14);
				}
		}
}

static void
gain_is_a_share_whatever_comes(void)
{
	const struct bake_roughen_stats all[] = { { 0.3, 0.5, 0.65 },
		{ 0.5, 0.5, 0.5 }, { 0, 1e-6, 1 }, { 0.2, 0.1, 0.05 } };
	const double t[] = { -1e30, -1, 0, 1e-30, 0.5, 1, 1.0000001, 2, 1e30 };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_roughen r;

	for (int model = 0; model < BAKE_ROUGHEN_MODELS; model++)
		for (int i = 0; i < 4; i++) {
			CHECK_OK(bake_roughen_init(&r,
				     (enum bake_roughen_model)model, 1, &all[i],
				     &err),
			    err);
			for (int k = 0; k < 9; k++)
				for (int a = 0; a <= 180; a += 5) {
					double c, s, g;

					bake_roughen_angle(a, &c, &s);
					g = bake_roughen_gain(&r, t[k], c, s);
					/* one ulp of cos^2 + sin^2 */
					CHECK(g >= 0 && g <= 1 + 1e-15);
				}
		}
}

static void
the_median_itself_has_no_relief(void)
{
	const struct bake_roughen_stats stats = { 0.3, 0.5, 0.65 };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_roughen r;
	double c, s;

	bake_roughen_angle(70, &c, &s);
	for (int model = 0; model < BAKE_ROUGHEN_MODELS; model++) {
		CHECK_OK(bake_roughen_init(&r, (enum bake_roughen_model)model,
			     0.09, &stats, &err),
		    err);
		CHECK(bake_roughen_gain(&r, 0.5, c, s) == c);
	}
}

static void
angles_are_exact_where_they_can_be(void)
{
	double c, s;

	bake_roughen_angle(0, &c, &s);
	CHECK(c == 1 && s == 0);
	bake_roughen_angle(90, &c, &s);
	CHECK(c == 0 && s == 1);
	bake_roughen_angle(180, &c, &s);
	CHECK(c == -1 && s == 0);
	for (double a = 0; a <= 180; a += 0.37) {
		bake_roughen_angle(a, &c, &s);
		/* an ulp of the product a pi / 180 on either side */
		CHECK_NEAR(c, cos(a * pi / 180), 1e-15);
		CHECK_NEAR(s, sin(a * pi / 180), 1e-15);
	}
}

static void
what_cannot_be_is_an_error(void)
{
	const struct bake_roughen_stats good = { 0.3, 0.5, 0.65 };
	const struct bake_roughen_stats black = { 0, 0, 0.5 };
	const struct bake_roughen_stats nan = { 0, NAN, 0.5 };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_roughen r;

	CHECK(bake_roughen_init(&r, BAKE_ROUGHEN_PAPER, -0.1, &good, &err) ==
	      BAKE_EINVAL);
	CHECK(strstr(err.msg, "-0.1") != NULL);
	CHECK(bake_roughen_init(&r, BAKE_ROUGHEN_PAPER, 1.1, &good, &err) ==
	      BAKE_EINVAL);
	CHECK(bake_roughen_init(&r, BAKE_ROUGHEN_PAPER, NAN, &good, &err) ==
	      BAKE_EINVAL);
	CHECK(bake_roughen_init(&r, (enum bake_roughen_model)9, 0, &good,
		  &err) == BAKE_EINVAL);
	for (int m = 0; m < BAKE_ROUGHEN_MODELS; m++) {
		const enum bake_status want =
		    m == BAKE_ROUGHEN_FLAT ? BAKE_OK : BAKE_EDATA;

		CHECK(bake_roughen_init(&r, (enum bake_roughen_model)m, 0.09,
			  &black, &err) == want);
		CHECK(bake_roughen_init(&r, (enum bake_roughen_model)m, 0.09,
			  &nan, &err) == want);
	}
}

/* -- percentiles ----------------------------------------------------------- */

static int
by_value(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

static double
sorted_percentile(const float *v, size_t n, double q)
{
	const double at = q * (double)(n - 1);
	const size_t k = (size_t)at;
	const double next = k + 1 < n ? v[k + 1] : v[k];

	return v[k] + (at - (double)k) * (next - v[k]);
}

static void
check_percentiles(struct bake_image *img)
{
	const size_t n = (size_t)img->width * (size_t)img->height;
	struct bake_roughen_stats one, many;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_roughen_measure(img, 1, &one, &err), err);
	CHECK_OK(bake_roughen_measure(img, 5, &many, &err), err);
	CHECK(memcmp(&one, &many, sizeof one) == 0);
	qsort(img->data, n, sizeof(float), by_value);
	CHECK(one.p05 == sorted_percentile(img->data, n, 0.05));
	CHECK(one.p50 == sorted_percentile(img->data, n, 0.5));
	CHECK(one.p95 == sorted_percentile(img->data, n, 0.95));
}

static void
percentiles_are_those_of_the_sorted_values(void)
{
	const int sizes[][2] = { { 1, 1 }, { 2, 1 }, { 3, 1 }, { 4, 1 },
		{ 20, 1 }, { 21, 1 }, { 37, 53 }, { 64, 64 } };
	uint32_t state = 3;

	for (int i = 0; i < 8; i++)
		for (int kind = 0; kind < 3; kind++) {
			struct bake_image img =
			    new_image(sizes[i][0], sizes[i][1], 1);

			for (int k = 0; k < img.width * img.height; k++) {
				const double v = test_random(&state);

				img.data[k] = kind == 0 ? (float)v
					      : kind == 1
						  ? (float)(1e3 * v - 500)
						  : (float)floor(8 * v) / 8;
			}
			check_percentiles(&img);
			bake_image_free(&img);
		}
}

static void
the_median_is_the_mean_of_the_two_middle_values(void)
{
	struct bake_image img = new_image(2, 2, 1);
	struct bake_roughen_stats stats;
	struct bake_err err = BAKE_ERR_INIT;
	const float v[4] = { 0.75f, 0.125f, 1, 0.25f };

	memcpy(img.data, v, sizeof v);
	CHECK_OK(bake_roughen_measure(&img, 1, &stats, &err), err);
	CHECK(stats.p50 == 0.5);
	bake_image_free(&img);
}

/* -- contrast ---------------------------------------------------------------
 */

static double
contrast_at(const struct bake_roughen *r, const struct bake_image *lum,
    double angle, double *median)
{
	struct bake_roughen_stats stats;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_roughen_lit_stats(r, angle, lum, 2, &stats, &err), err);
	*median = stats.p50;
	return bake_roughen_contrast(&stats);
}

static void
flat_has_the_same_contrast_everywhere(void)
{
	struct bake_image lum = gaussian_texture(128, 128, 0.5, 0.07);
	struct bake_roughen r = remap_of(BAKE_ROUGHEN_FLAT, 0.09, &lum);
	double median, at0 = contrast_at(&r, &lum, 0, &median);

	for (int a = 10; a <= 88; a += 2) {
		/* roundings of t' to float, relative 6e-8 */
		CHECK_NEAR(contrast_at(&r, &lum, a, &median), at0, 1e-6);
		CHECK_NEAR(median / (r.median * cos(a * pi / 180)), 1, 1e-6);
	}
	bake_image_free(&lum);
}

static void
facet_contrast_is_the_closed_form(void)
{
	struct bake_image lum = gaussian_texture(256, 256, 0.5, 0.07);
	struct bake_roughen r = remap_of(BAKE_ROUGHEN_FACET, 0.09, &lum);
	const double p5 = r.median - r.low, p95 = r.median + r.high;
	const double c0 = (p95 - p5) / (2 * r.median), big = 0.09 * pi / 2;
	double median, last = 0, first = 0;

	for (int a = 10; a <= 80; a += 2) {
		const double theta = a * pi / 180;
		const double want = c0 * cos(big) + sin(big) * tan(theta) *
							(p95 + p5) /
							(2 * r.median);
		const double c = contrast_at(&r, &lum, a, &median);

		/* t' rises with t here, so that its percentiles are those of
		 * t but for the gap between two ranks, 1e-5 here, in which d
		 * stops to grow: up to D tan(theta) / (p95 - m) = 7 times
		 * that */
		CHECK_NEAR(c / want, 1, 1e-4);
		CHECK_NEAR(median / (r.median * cos(theta)), 1, 1e-5);
		CHECK(c > last);
		last = c;
		first = a == 10 ? c : first;
	}
	CHECK(contrast_at(&r, &lum, 82, &median) >= 4 * first);
	bake_image_free(&lum);
}

static void
paper_contrast_rises_threefold(void)
{
	struct bake_image lum = gaussian_texture(256, 256, 0.5, 0.07);
	struct bake_roughen r = remap_of(BAKE_ROUGHEN_PAPER, 0.09, &lum);
	double median, last = 0, first = contrast_at(&r, &lum, 10, &median);

	for (int a = 10; a <= 82; a += 2) {
		const double c = contrast_at(&r, &lum, a, &median);

		CHECK(c > last);
		last = c;
	}
	CHECK(last >= 3 * first);
	bake_image_free(&lum);
}

static void
blackshot_darkens_more_texels_towards_the_edge(void)
{
	struct bake_image lum = gaussian_texture(64, 64, 0.5, 0.07);
	struct bake_roughen r = remap_of(BAKE_ROUGHEN_BLACKSHOT, 0.09, &lum);
	int last = 0;

	for (int a = 0; a < 90; a++) {
		double c, s;
		int nblack = 0;

		bake_roughen_angle(a, &c, &s);
		for (int i = 0; i < 64 * 64; i++) {
			const double g =
			    bake_roughen_gain(&r, lum.data[i], c, s);

			CHECK(g == 0 || g == c);
			nblack += g == 0;
		}
		CHECK(nblack >= last);
		last = nblack;
	}
	CHECK(last == 64 * 64);
	bake_image_free(&lum);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = { CASE(gain_is_the_formula),
		CASE(gain_is_a_share_whatever_comes),
		CASE(the_median_itself_has_no_relief),
		CASE(angles_are_exact_where_they_can_be),
		CASE(what_cannot_be_is_an_error),
		CASE(percentiles_are_those_of_the_sorted_values),
		CASE(the_median_is_the_mean_of_the_two_middle_values),
		CASE(flat_has_the_same_contrast_everywhere),
		CASE(facet_contrast_is_the_closed_form),
		CASE(paper_contrast_rises_threefold),
		CASE(blackshot_darkens_more_texels_towards_the_edge) };

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
