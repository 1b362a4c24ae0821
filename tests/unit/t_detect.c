/* bake_detect on surfaces with known conventions. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "test_detect.h"

static void
all_conventions_are_told_apart(void)
{
	struct surface s[3] = { rough(128, 128, 12, 1), rough(200, 96, 20, 2),
		bricks(192, 192, 3, 6, 0) };

	for (int k = 0; k < 3; k++) {
		for (int bits = 0; bits < 16; bits++) {
			struct maps m = MAPS_DEFAULT;

			m.depth = bits & 1;
			m.y_down = bits & 2;
			m.nchans = bits & 4 ? 2 : 3;
			m.normal_codes = m.relief_codes = bits & 8 ? 255 : 0;
			m.scale = k == 2 ? 0.01 : 0.1;
			check_right(&s[k], &m);
		}
		surface_free(&s[k]);
	}
}

/* RMS slope 0.004 is half a code of 8 bits: noise in both maps, and no
 * wrong answer; with 16 bits the answer is there. */
static void
very_low_relief_is_not_wrong(void)
{
	struct surface s = rough(256, 256, 24, 3);
	struct maps m = MAPS_DEFAULT;
	struct bake_detection d;

	for (int bits = 0; bits < 4; bits++) {
		m.depth = bits & 1;
		m.y_down = bits & 2;
		m.scale = 0.001;
		m.normal_codes = m.relief_codes = 255;
		d = detect_maps(&s, &m);
		check_not_wrong(&d, &m);
		m.normal_codes = 65535;
		check_right(&s, &m);
	}
	surface_free(&s);
}

/*
 * The operators on both maps have the same blur: sin t / t against (2 + cos t)
 * / 3 at t = 2 pi f / W texels, t^4 / 180 apart; t = 8 * 2 pi / 256 at the
 * finest scale and at most 16 times that where energy is left, which is 1e-3
 * while t < 0.65. 1 % leaves room for one scale more.
 */
static void
depth_scale_is_found(void)
{
	struct surface s = rough(256, 256, 8, 4);
	struct maps m = MAPS_DEFAULT;
	const double scales[] = { 0.02, 0.1, 0.25 };

	for (int k = 0; k < 6; k++) {
		struct bake_detection d;

		m.scale = scales[k % 3];
		m.depth = k >= 3;
		d = detect_maps(&s, &m);
		CHECK_NEAR(d.depth_scale / m.scale, 1, 0.01);
		CHECK(d.depth_scale_low <= d.depth_scale);
		CHECK(d.depth_scale <= d.depth_scale_high);
		/* 8 bits in both: steps of 1/255 in v against slopes of some
		 * 0.01 a texel, averaged over many texels at coarse scales */
		m.normal_codes = m.relief_codes = 255;
		d = detect_maps(&s, &m);
		CHECK_NEAR(d.depth_scale / m.scale, 1, 0.03);
		m.normal_codes = m.relief_codes = 0;
	}
	surface_free(&s);
}

/* v = 2 h on a texture twice as wide as high: S is per texture width and
 * per unit of v, so half. */
static void
depth_scale_is_per_width_and_per_value(void)
{
	struct surface s = rough(256, 128, 6, 5);
	struct maps m = MAPS_DEFAULT;
	struct bake_image normal, relief;
	struct bake_detection d;

	make_maps(&s, &m, &normal, &relief);
	for (size_t k = 0; k < 256 * 128; k++)
		relief.data[k] *= 2;
	d = detect(&normal, &relief);
	CHECK_NEAR(d.depth_scale, 0.05, 0.05 * 0.02);
	bake_image_free(&normal);
	bake_image_free(&relief);
	surface_free(&s);
}

/* White noise on the normals only: the direct regression is not touched, the
 * inverse one is too high, and the truth lies between. */
static void
noise_widens_the_interval_around_the_depth_scale(void)
{
	struct surface s = rough(128, 128, 12, 6);
	struct maps m = MAPS_DEFAULT;
	struct bake_detection d;

	m.noise = 0.1;
	d = detect_maps(&s, &m);
	CHECK(d.depth_scale_low < m.scale * 1.01);
	CHECK(d.depth_scale_high > m.scale * 0.99);
	CHECK_NEAR(d.depth_scale / m.scale, 1, 0.1);
	surface_free(&s);
}

/* f(x) + g(y) is a gradient with y up and with y down: no curl evidence, but
 * the pair tells. Diagonal stripes tell by both. */
static void
sums_of_stripes_need_the_pair(void)
{
	for (int bits = 0; bits < 8; bits++) {
		struct surface s = surface_new(128, 128);
		struct maps m = MAPS_DEFAULT;
		struct bake_detection d;

		m.depth = bits & 1;
		m.y_down = bits & 2;
		m.normal_codes = m.relief_codes = bits & 4 ? 255 : 0;
		for (int f = 3; f < 20; f += 4) {
			add_wave(&s, f, 0, 0.2 / f, f);
			add_wave(&s, 0, f + 1, 0.2 / f, 2 * f);
		}
		d = detect_maps(&s, &m);
		CHECK(d.polarity == polarity_of(&m));
		CHECK(d.pair_y == y_of(&m) && d.normal_y == y_of(&m));
		CHECK(d.curl_y == BAKE_NORMAL_Y_UNSURE);
		surface_free(&s);
		s = surface_new(128, 128);
		add_wave(&s, 7, bits & 1 ? -9 : 9, 0.1, 1);
		d = detect_maps(&s, &m);
		CHECK(d.polarity == polarity_of(&m));
		CHECK(d.pair_y == y_of(&m) && d.normal_y == y_of(&m));
		surface_free(&s);
	}
}

/* 1 % of the texels NaN or infinite in either map. */
static void
missing_texels_are_left_out(void)
{
	struct surface s = rough(128, 128, 6, 11);
	struct maps m = MAPS_DEFAULT;
	struct bake_image normal, relief;
	struct bake_detection d;
	unsigned state = 3;

	m.depth = true;
	make_maps(&s, &m, &normal, &relief);
	for (int k = 0; k < 80; k++) {
		size_t at = (size_t)(random_unit(&state) * 128 * 128);

		normal.data[3 * at + (size_t)k % 3] = k % 2 ? NAN : INFINITY;
		at = (size_t)(random_unit(&state) * 128 * 128);
		relief.data[at] = k % 2 ? NAN : -INFINITY;
	}
	d = detect(&normal, &relief);
	CHECK(d.polarity == BAKE_POLARITY_DEPTH);
	CHECK(d.normal_y == BAKE_NORMAL_Y_UP);
	CHECK_NEAR(d.depth_scale, 0.1, 0.001);
	for (size_t k = 0; k < 128 * 128; k++)
		relief.data[k] = NAN;
	d = detect(&normal, &relief);
	CHECK(d.polarity == BAKE_POLARITY_UNSURE);
	bake_image_free(&normal);
	bake_image_free(&relief);
	surface_free(&s);
}

/* More than 2^20 texels: windows; fine pattern, and a strip. */
static void
large_maps_are_sampled(void)
{
	const int size[][2] = { { 1300, 1100 }, { 40, 30000 }, { 9000, 130 } };

	for (int k = 0; k < 3; k++) {
		struct surface s = surface_new(size[k][0], size[k][1]);
		struct maps m = MAPS_DEFAULT;
		int f = size[k][0] / 9, g = size[k][1] / 11;

		m.y_down = k & 1;
		m.depth = true;
		m.scale = 0.001;
		add_wave(&s, f, g, 0.2, 1);
		add_wave(&s, -f / 2, g, 0.2, 2);
		check_right(&s, &m);
		surface_free(&s);
	}
}

static void
wrong_maps_are_refused(void)
{
	struct bake_image a = image(4, 4, 3), b = image(5, 4, 1);
	struct bake_image c = image(4, 4, 4);
	struct bake_detection d;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_detect(&a, &b, &d, &err) == BAKE_EDATA);
	CHECK(
	    strcmp(err.msg, "the normal map is 4x4, the relief map 5x4") == 0);
	CHECK_UNSURE(d);
	CHECK(bake_detect(NULL, NULL, &d, &err) == BAKE_EINVAL);
	CHECK(bake_detect(&c, NULL, &d, &err) == BAKE_EINVAL);
	CHECK(bake_detect(&b, NULL, &d, &err) == BAKE_EINVAL);
	CHECK(bake_detect(NULL, &a, &d, &err) == BAKE_EINVAL);
	bake_image_free(&a);
	bake_image_free(&b);
	bake_image_free(&c);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(all_conventions_are_told_apart),
		CASE(very_low_relief_is_not_wrong),
		CASE(depth_scale_is_found),
		CASE(depth_scale_is_per_width_and_per_value),
		CASE(noise_widens_the_interval_around_the_depth_scale),
		CASE(sums_of_stripes_need_the_pair),
		CASE(missing_texels_are_left_out),
		CASE(large_maps_are_sampled),
		CASE(wrong_maps_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
