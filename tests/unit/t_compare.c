/* bake_compare: known differences, their places and counts, and the errors. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "compare.h"

enum { W = 7, H = 5 };

static struct bake_image
filled(int width, int height, int nchans, float value)
{
	struct bake_image img;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_image_alloc(&img, width, height, nchans, &err), err);
	for (size_t i = 0; i < (size_t)height * img.row_stride; i++)
		img.data[i] = value;
	return img;
}

static float *
at(struct bake_image *img, int x, int y, int c)
{
	return bake_image_row(img, y) + (size_t)x * (size_t)img->nchans + c;
}

static void
equal_images_have_no_difference(void)
{
	struct bake_image a = filled(W, H, 4, 0.25f);
	struct bake_comparison out;
	struct bake_err err = BAKE_ERR_INIT;

	*at(&a, 3, 2, 1) = NAN;
	*at(&a, 3, 2, 2) = -INFINITY;
	CHECK_OK(bake_compare(&a, &a, 255, 0, &out, &err), err);
	CHECK(out.nchans == 4);
	CHECK(out.all.worst == 0 && out.all.mean == 0);
	CHECK(out.all.ndifferent == 0 && out.all.nbeyond == 0);
	CHECK(out.all.nmismatch == 0);
	bake_image_free(&a);
}

static void
differences_are_counted_in_codes(void)
{
	struct bake_image a = filled(W, H, 2, 100 / 255.0f);
	struct bake_image b = filled(W, H, 2, 100 / 255.0f);
	struct bake_comparison out;
	struct bake_err err = BAKE_ERR_INIT;

	*at(&b, 1, 0, 0) = 101 / 255.0f;
	*at(&b, 6, 4, 1) = 97 / 255.0f;
	*at(&b, 2, 3, 1) = 103 / 255.0f; /* as far, and earlier */
	CHECK_OK(bake_compare(&a, &b, 255, 1, &out, &err), err);
	CHECK(out.all.worst == 3);
	CHECK(out.all.x == 2 && out.all.y == 3 && out.all.channel == 1);
	CHECK(out.all.a == 100 / 255.0f && out.all.b == 103 / 255.0f);
	CHECK(out.all.ndifferent == 3 && out.all.nbeyond == 2);
	/* (1 + 3 + 3) / values: exact sums, one rounding */
	CHECK_NEAR(out.all.mean, 7.0 / (2 * W * H), 1e-15);
	CHECK(out.channel[0].worst == 1 && out.channel[0].nbeyond == 0);
	CHECK(out.channel[0].ndifferent == 1);
	CHECK(out.channel[0].x == 1 && out.channel[0].y == 0);
	CHECK(out.channel[1].worst == 3 && out.channel[1].ndifferent == 2);
	CHECK_NEAR(out.channel[1].mean, 6.0 / (W * H), 1e-15);
	bake_image_free(&a);
	bake_image_free(&b);
}

/* The float of every 16-bit code is its own code again, so one code apart is
 * one code, at both ends of the range. */
static void
every_16_bit_code_is_told_from_the_next(void)
{
	struct bake_image a = filled(65535, 1, 1, 0);
	struct bake_image b = filled(65535, 1, 1, 0);
	struct bake_comparison out;
	struct bake_err err = BAKE_ERR_INIT;

	for (int i = 0; i < 65535; i++) {
		a.data[i] = (float)i / 65535;
		b.data[i] = (float)(i + 1) / 65535;
	}
	CHECK_OK(bake_compare(&a, &b, 65535, 0.5, &out, &err), err);
	CHECK(out.all.worst == 1 && out.all.mean == 1);
	CHECK(out.all.nbeyond == 65535);
	bake_image_free(&a);
	bake_image_free(&b);
}

static void
float_images_differ_in_their_own_unit(void)
{
	struct bake_image a = filled(W, H, 1, 1000.5f);
	struct bake_image b = filled(W, H, 1, 1000.5f);
	struct bake_comparison out;
	struct bake_err err = BAKE_ERR_INIT;

	*at(&b, 4, 1, 0) = 1000.25f;
	*at(&a, 0, 0, 0) = 0.0f;
	*at(&b, 0, 0, 0) = -0.0f;
	CHECK_OK(bake_compare(&a, &b, 0, 0.25, &out, &err), err);
	CHECK(out.all.worst == 0.25);
	CHECK(out.all.ndifferent == 1 && out.all.nbeyond == 0);
	CHECK(out.all.x == 4 && out.all.y == 1);
	CHECK_OK(bake_compare(&a, &b, 0, 0.2, &out, &err), err);
	CHECK(out.all.nbeyond == 1);
	bake_image_free(&a);
	bake_image_free(&b);
}

static void
nan_equals_nan_only(void)
{
	const float pair[][2] = { { NAN, 0 }, { 1, NAN }, { NAN, INFINITY },
		{ INFINITY, -INFINITY }, { INFINITY, 1 } };
	struct bake_comparison out;
	struct bake_err err = BAKE_ERR_INIT;

	for (size_t i = 0; i < sizeof pair / sizeof *pair; i++) {
		for (int code_max = 0; code_max <= 255; code_max += 255) {
			struct bake_image a = filled(2, 1, 1, pair[i][0]);
			struct bake_image b = filled(2, 1, 1, pair[i][1]);

			b.data[0] = a.data[0];
			CHECK_OK(
			    bake_compare(&a, &b, code_max, 1e30, &out, &err),
			    err);
			CHECK(isinf(out.all.worst) && out.all.x == 1);
			CHECK(out.all.nmismatch == 1);
			CHECK(out.all.nbeyond == 1);
			CHECK(out.all.mean == 0);
			bake_image_free(&a);
			bake_image_free(&b);
		}
	}
}

static void
padding_between_rows_is_not_compared(void)
{
	struct bake_image a = filled(W, H, 1, 0.5f), view = a;
	struct bake_image b = filled(W - 2, H, 1, 0.5f);
	struct bake_comparison out;
	struct bake_err err = BAKE_ERR_INIT;

	view.width = W - 2;
	for (int y = 0; y < H; y++)
		*at(&a, W - 1, y, 0) = 0.75f;
	CHECK_OK(bake_compare(&view, &b, 0, 0, &out, &err), err);
	CHECK(out.all.worst == 0);
	bake_image_free(&a);
	bake_image_free(&b);
}

static void
wrong_shapes_name_both_numbers(void)
{
	struct bake_image a = filled(W, H, 1, 0), b = filled(W + 1, H, 1, 0);
	struct bake_image c = filled(W, H, 3, 0), many = filled(1, 1, 65, 0);
	struct bake_comparison out;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_compare(&a, &b, 255, 0, &out, &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "one image is 7x5, the other 8x5") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_compare(&a, &c, 255, 0, &out, &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "one image has 1 channels, the other 3") == 0);
	CHECK(bake_compare(&many, &many, 0, 0, &out, &err) == BAKE_EDATA);
	CHECK(bake_compare(&a, &a, -1, 0, &out, &err) == BAKE_EINVAL);
	CHECK(bake_compare(&a, &a, 255, -1, &out, &err) == BAKE_EINVAL);
	CHECK(bake_compare(&a, &a, 255, NAN, &out, &err) == BAKE_EINVAL);
	CHECK(out.nchans == 0);
	bake_image_free(&a);
	bake_image_free(&b);
	bake_image_free(&c);
	bake_image_free(&many);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(equal_images_have_no_difference),
		CASE(differences_are_counted_in_codes),
		CASE(every_16_bit_code_is_told_from_the_next),
		CASE(float_images_differ_in_their_own_unit),
		CASE(nan_equals_nan_only),
		CASE(padding_between_rows_is_not_compared),
		CASE(wrong_shapes_name_both_numbers),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
