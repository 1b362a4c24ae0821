/* Repair: good texels untouched, planes continued, large holes, all bad. */
/* SPDX-License-Identifier: MIT */
#include "repair.h"

#include "check.h"
#include "test_maps.h"

static size_t
repair(struct bake_image *img, struct bake_wrap wrap, int nt)
{
	struct bake_err err = BAKE_ERR_INIT;
	size_t n = 12345;

	CHECK_OK(bake_repair_nonfinite(img, wrap, nt, &n, &err), err);
	return n;
}

static void
good_image_keeps_its_bits(void)
{
	struct bake_image a = noise(17, 9, 3), b = noise(17, 9, 3);

	a.data[3] = b.data[3] = 9.9e29f;
	a.data[4] = b.data[4] = -0.0f;
	CHECK(repair(&a, torus, 2) == 0);
	CHECK(memcmp(a.data, b.data, nfloats(&a) * 4) == 0);
	bake_image_free(&a);
	bake_image_free(&b);
}

static void
every_kind_of_bad_value_is_found(void)
{
	static const float bad[] = { NAN, -NAN, INFINITY, -INFINITY, 1e30f,
		-1e30f, 3.4e38f };

	for (int i = 0; i < 7; i++)
		for (int c = 0; c < 3; c++) {
			struct bake_image a = noise(8, 8, 3);
			struct bake_image b = noise(8, 8, 3);

			a.data[3 * 27 + c] = bad[i];
			CHECK(repair(&a, torus, 1) == 1);
			for (int k = 0; k < 8 * 8 * 3; k++)
				if (k / 3 == 27)
					/* the mean of the 4 neighbours */
					CHECK_NEAR(a.data[k],
					    (b.data[k - 3] + b.data[k + 3] +
						b.data[k - 24] +
						b.data[k + 24]) /
						4,
					    6e-8);
				else
					CHECK(a.data[k] == b.data[k]);
			bake_image_free(&a);
			bake_image_free(&b);
		}
}

/* A lone hole lies on its neighbours' plane; 2x2 nearly does. */
static void
holes_lie_on_the_plane(void)
{
	struct bake_image a = image(32, 32, 1);

	for (int i = 0; i < 1024; i++)
		a.data[i] = (float)(i % 32 + 2 * (i / 32)) / 128.0f;
	a.data[5 * 32 + 6] = NAN;
	a.data[20 * 32 + 21] = a.data[20 * 32 + 22] = NAN;
	a.data[21 * 32 + 21] = a.data[21 * 32 + 22] = INFINITY;
	CHECK(repair(&a, clamped, 1) == 5);
	CHECK_NEAR(a.data[5 * 32 + 6], 16 / 128.0, 1e-9);
	/* 8 Jacobi steps leave (1/2)^8 of an error of at most two texels' fall
	 */
	for (int y = 20; y < 22; y++)
		for (int x = 21; x < 23; x++)
			CHECK_NEAR(a.data[y * 32 + x], (x + 2 * y) / 128.0,
			    6 / 128.0 / 256);
	bake_image_free(&a);
}

/* The neighbours of a border texel: across the border only on the torus. */
static void
wrap_decides_at_the_border(void)
{
	struct bake_image a = image(8, 8, 1);

	for (int i = 0; i < 64; i++)
		a.data[i] = i % 8 < 4 ? 0 : 1;
	a.data[24] = NAN;
	CHECK(repair(&a, torus, 1) == 1);
	CHECK_NEAR(a.data[24], 0.25, 1e-9);
	a.data[24] = NAN;
	a.data[25] = 1;
	CHECK(repair(&a, clamped, 1) == 1);
	/* three neighbours: the texel is not its own, repeated at the border */
	CHECK_NEAR(a.data[24], 1.0 / 3, 3e-8);
	bake_image_free(&a);
}

/* Half of it missing, only one texel left, odd sizes, lines: in range. */
static void
large_holes_stay_within_the_range(void)
{
	static const int sizes[][2] = { { 64, 64 }, { 37, 53 }, { 1, 19 },
		{ 41, 1 }, { 2, 2 } };

	for (int i = 0; i < 5 * 6; i++) {
		struct bake_image a =
		    noise(sizes[i / 6][0], sizes[i / 6][1], 2);
		const int n = a.width * a.height;
		const struct bake_wrap wrap = i % 2 ? clamped : torus;
		float lo[2] = { 2, 2 }, hi[2] = { -2, -2 };
		size_t nbad = 0;

		for (int k = 0; k < n; k++) {
			const bool keep = i / 2 % 3 == 0   ? k == n / 2
					  : i / 2 % 3 == 1 ? k % 2 == 1
							   : k < n / 2;

			for (int c = 0; c < 2 && keep; c++) {
				lo[c] = fminf(lo[c], a.data[2 * k + c]);
				hi[c] = fmaxf(hi[c], a.data[2 * k + c]);
			}
			if (!keep) {
				a.data[2 * k + k % 2] = NAN;
				nbad++;
			}
		}
		CHECK(repair(&a, wrap, 2) == nbad);
		for (int k = 0; k < 2 * n; k++)
			CHECK(a.data[k] >= lo[k % 2] && a.data[k] <= hi[k % 2]);
		bake_image_free(&a);
	}
}

static void
threads_do_not_show(void)
{
	struct bake_image a, b;

	for (int nt = 2; nt <= 7; nt += 5) {
		a = noise(61, 43, 3);
		b = noise(61, 43, 3);
		for (int k = 0; k < 61 * 43; k++)
			if (hash((uint32_t)k + 99) % 3 == 0)
				a.data[3 * k] = b.data[3 * k] = NAN;
		CHECK(repair(&a, torus, 1) == repair(&b, torus, nt));
		CHECK(memcmp(a.data, b.data, nfloats(&a) * 4) == 0);
		bake_image_free(&a);
		bake_image_free(&b);
	}
}

static void
nothing_to_start_from_is_an_error(void)
{
	struct bake_image a = noise(5, 5, 2), none = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	size_t n = 7;

	for (int k = 0; k < 25; k++)
		a.data[2 * k + k % 2] = NAN;
	CHECK(bake_repair_nonfinite(&a, torus, 1, &n, &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "has no finite texel") == 0);
	CHECK(isnan(a.data[0]) && n == 7);
	err.code = BAKE_OK;
	CHECK(bake_repair_nonfinite(&none, torus, 1, &n, &err) == BAKE_EINVAL);
	bake_image_free(&a);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(good_image_keeps_its_bits),
		CASE(every_kind_of_bad_value_is_found),
		CASE(holes_lie_on_the_plane),
		CASE(wrap_decides_at_the_border),
		CASE(large_holes_stay_within_the_range),
		CASE(threads_do_not_show),
		CASE(nothing_to_start_from_is_an_error),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
