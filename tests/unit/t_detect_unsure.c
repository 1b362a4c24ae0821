/* bake_detect on maps that say nothing, or lie: unsure, and never wrong. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "test_detect.h"

static void
stripes_say_nothing_about_the_other_axis(void)
{
	for (int bits = 0; bits < 8; bits++) {
		struct surface s = surface_new(128, 128);
		struct maps m = MAPS_DEFAULT;
		struct bake_detection d;

		m.depth = bits & 1;
		m.y_down = bits & 2;
		m.normal_codes = m.relief_codes = bits & 4 ? 255 : 0;
		for (int f = 3; f < 20; f += 4)
			add_wave(&s, f, 0, 0.2 / f, f);
		d = detect_maps(&s, &m);
		CHECK(d.polarity == polarity_of(&m));
		CHECK(d.normal_y == BAKE_NORMAL_Y_UNSURE);
		surface_free(&s);
		s = surface_new(128, 128);
		for (int f = 3; f < 20; f += 4)
			add_wave(&s, 0, f, 0.2 / f, f);
		d = detect_maps(&s, &m);
		CHECK_UNSURE(d);
		surface_free(&s);
	}
}

/* cos x cos y, and one round bump: symmetric, yet gradients. */
static void
symmetric_reliefs_are_not_wrong(void)
{
	struct surface egg = surface_new(128, 128);
	struct surface bump = surface_new(128, 128);

	add_wave(&egg, 5, 5, 0.1, 0);
	add_wave(&egg, 5, -5, 0.1, 0);
	for (int i = -6; i <= 6; i++)
		for (int j = -6; j <= 6; j++)
			add_wave(
			    &bump, i, j, 0.02 * exp(-(i * i + j * j) / 9.0), 0);
	for (int bits = 0; bits < 8; bits++) {
		struct maps m = MAPS_DEFAULT;
		struct bake_detection d;

		m.depth = bits & 1;
		m.y_down = bits & 2;
		m.normal_codes = m.relief_codes = bits & 4 ? 255 : 0;
		d = detect_maps(&egg, &m);
		check_not_wrong(&d, &m);
		d = detect_maps(&bump, &m);
		check_not_wrong(&d, &m);
	}
	surface_free(&egg);
	surface_free(&bump);
}

/* The k-th of some surfaces of different make. */
static struct surface
other_surface(int k, int width, int height)
{
	if (k % 3 == 2)
		return bricks(
		    width, height, 1 + k % 5, 2 * (1 + k % 4), 0.137 * k);
	return rough(width, height, 2 + k % 11, (unsigned)k);
}

/* Normals of one surface with another's relief: no polarity, no Y of the
 * pair; what the normals say by themselves still holds. */
static void
unrelated_maps_are_unsure(void)
{
	enum { N = 12 };
	struct bake_image normal[N], relief[N];
	struct maps m = MAPS_DEFAULT;

	for (int k = 0; k < N; k++) {
		struct surface s = other_surface(k, 96, 96);

		m.scale = k % 3 == 2 ? 0.02 : 0.1;
		make_maps(&s, &m, &normal[k], &relief[k]);
		surface_free(&s);
	}
	for (int i = 0; i < N; i++) {
		for (int j = 0; j < N; j++) {
			struct bake_detection d;

			if (i == j)
				continue;
			d = detect(&normal[i], &relief[j]);
			CHECK(d.polarity == BAKE_POLARITY_UNSURE);
			CHECK(d.pair_y == BAKE_NORMAL_Y_UNSURE);
			CHECK(d.normal_y != BAKE_NORMAL_Y_DOWN);
			CHECK(isnan(d.depth_scale));
		}
	}
	for (int k = 0; k < N; k++) {
		bake_image_free(&normal[k]);
		bake_image_free(&relief[k]);
	}
}

static void
noise_is_unsure(void)
{
	unsigned state = 5;

	for (int n = 0; n < 24; n++) {
		int size = n % 3 == 0 ? 17 : n % 3 == 1 ? 40 : 128;
		struct bake_image normal = image(size, size, 2 + n % 2);
		struct bake_image relief = image(size, size, 1);
		struct bake_detection d;

		for (size_t k = 0; k < (size_t)size * normal.row_stride; k++)
			normal.data[k] = 0.4f * (random_unit(&state) - 0.5f);
		for (size_t k = 0; n % 2 && k < (size_t)(size * size); k++)
			normal.data[3 * k + 2] = 1;
		for (size_t k = 0; k < (size_t)(size * size); k++)
			relief.data[k] = random_unit(&state);
		d = detect(&normal, &relief);
		CHECK(d.plausible_normals);
		CHECK_UNSURE(d);
		bake_image_free(&normal);
		bake_image_free(&relief);
	}
}

static void
constant_maps_are_unsure(void)
{
	struct surface s = rough(64, 64, 6, 8);
	struct maps m = MAPS_DEFAULT;
	struct bake_image normal, relief, flat = image(64, 64, 3);
	struct bake_image grey = image(64, 64, 1);
	struct bake_detection d;

	for (size_t k = 0; k < 64 * 64; k++) {
		flat.data[3 * k] = flat.data[3 * k + 1] = 1 / 255.0f;
		flat.data[3 * k + 2] = 1;
		grey.data[k] = 0.7f;
	}
	make_maps(&s, &m, &normal, &relief);
	d = detect(&flat, &grey);
	CHECK_UNSURE(d);
	d = detect(&flat, &relief);
	CHECK_UNSURE(d);
	d = detect(&normal, &grey);
	CHECK(d.polarity == BAKE_POLARITY_UNSURE);
	CHECK(d.normal_y == BAKE_NORMAL_Y_UP); /* by its curl */
	d = detect(NULL, &relief);
	CHECK_UNSURE(d);
	bake_image_free(&normal);
	bake_image_free(&relief);
	bake_image_free(&flat);
	bake_image_free(&grey);
	surface_free(&s);
}

static void
tiny_maps_are_not_wrong(void)
{
	const int size[][2] = { { 1, 1 }, { 2, 2 }, { 1, 64 }, { 64, 1 },
		{ 8, 8 }, { 10, 300 }, { 16, 16 }, { 13, 13 }, { 33, 14 } };

	for (size_t k = 0; k < sizeof size / sizeof *size; k++) {
		for (unsigned seed = 0; seed < 8; seed++) {
			struct surface s =
			    rough(size[k][0], size[k][1], 4, seed);
			struct maps m = MAPS_DEFAULT;
			struct bake_detection d;

			m.y_down = seed & 1;
			m.depth = seed & 2;
			m.normal_codes = m.relief_codes = seed & 4 ? 255 : 0;
			d = detect_maps(&s, &m);
			if (size[k][0] < 13 || size[k][1] < 13)
				CHECK_UNSURE(d);
			else
				check_not_wrong(&d, &m);
			surface_free(&s);
		}
	}
}

static void
swapped_x_and_y_are_unsure(void)
{
	struct surface s[2] = { rough(128, 128, 12, 9),
		bricks(128, 128, 3, 6, 0) };

	for (int k = 0; k < 4; k++) {
		struct maps m = MAPS_DEFAULT;
		struct bake_image normal, relief;
		struct bake_detection d;

		m.y_down = k & 2;
		m.scale = k & 1 ? 0.01 : 0.1;
		make_maps(&s[k & 1], &m, &normal, &relief);
		for (size_t i = 0; i < 128 * 128; i++) {
			float t = normal.data[3 * i];

			normal.data[3 * i] = normal.data[3 * i + 1];
			normal.data[3 * i + 1] = t;
		}
		d = detect(&normal, &relief);
		CHECK_UNSURE(d);
		CHECK(d.curl_y == BAKE_NORMAL_Y_UNSURE);
		bake_image_free(&normal);
		bake_image_free(&relief);
	}
	surface_free(&s[0]);
	surface_free(&s[1]);
}

/* A grey picture, a picture's colours, object-space normals. */
static void
what_is_no_normal_map_is_unsure(void)
{
	struct surface s = rough(96, 96, 12, 10);
	struct bake_image normal = image(96, 96, 3), relief = image(96, 96, 1);

	for (int kind = 0; kind < 3; kind++) {
		struct bake_detection d;

		for (size_t k = 0; k < 96 * 96; k++) {
			float h = s.h[k], *n = normal.data + 3 * k;

			n[0] = 2 * h - 1;
			n[1] = kind == 0 ? n[0] : kind == 1 ? n[0] - 0.1f : h;
			n[2] = kind == 2 ? s.hx[k] : n[0] - 0.2f * (float)kind;
			relief.data[k] = h;
		}
		d = detect(&normal, &relief);
		CHECK(!d.plausible_normals);
		CHECK_UNSURE(d);
	}
	bake_image_free(&normal);
	bake_image_free(&relief);
	surface_free(&s);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(stripes_say_nothing_about_the_other_axis),
		CASE(symmetric_reliefs_are_not_wrong),
		CASE(unrelated_maps_are_unsure),
		CASE(noise_is_unsure),
		CASE(constant_maps_are_unsure),
		CASE(tiny_maps_are_not_wrong),
		CASE(swapped_x_and_y_are_unsure),
		CASE(what_is_no_normal_map_is_unsure),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
