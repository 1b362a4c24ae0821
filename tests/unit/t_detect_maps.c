/* Ranges, normal lengths and seams of one map, on maps known in full. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "detect.h"

static struct bake_image
blank(int width, int height, int nchans)
{
	struct bake_image img;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_image_alloc(&img, width, height, nchans, &err), err);
	memset(img.data, 0, sizeof(float) * (size_t)height * img.row_stride);
	return img;
}

static float *
at(struct bake_image *img, int x, int y)
{
	return bake_image_row(img, y) + (size_t)x * (size_t)img->nchans;
}

static void
range_counts_what_is_not_finite(void)
{
	struct bake_image img = blank(4, 2, 2);
	struct bake_channel_range r;

	for (int i = 0; i < 8; i++)
		img.data[2 * i + 1] = (float)i;
	*(at(&img, 0, 0) + 1) = NAN;
	*(at(&img, 1, 0) + 1) = INFINITY;
	*(at(&img, 2, 0) + 1) = -INFINITY;
	bake_channel_range(&img, 1, &r);
	CHECK(r.min == 3 && r.max == 7 && r.mean == 5);
	CHECK(r.nnan == 1 && r.ninf == 2);
	bake_channel_range(&img, 0, &r);
	CHECK(r.min == 0 && r.max == 0 && r.mean == 0 && r.nnan == 0);
	for (int i = 0; i < 8; i++)
		img.data[2 * i] = NAN;
	bake_channel_range(&img, 0, &r);
	CHECK(isnan(r.min) && isnan(r.max) && isnan(r.mean) && r.nnan == 8);
	bake_image_free(&img);
}

static void
normal_stats_of_known_vectors(void)
{
	const float v[4][3] = { { 0, 0, 1 }, { 0, 0, -0.5f }, { 1.25f, 0, 0 },
		{ NAN, 0, 1 } };
	struct bake_image img = blank(4, 1, 3);
	struct bake_normal_stats s;
	struct bake_err err = BAKE_ERR_INIT;

	memcpy(img.data, v, sizeof v);
	CHECK_OK(bake_normal_stats(&img, &s, &err), err);
	CHECK(s.nfinite == 3);
	/* lengths 1, 1/2, 5/4: exact in binary, a few roundings in double */
	CHECK_NEAR(s.length_mean, 2.75 / 3, 1e-15);
	CHECK_NEAR(s.length_dev * s.length_dev,
	    (1 + 0.25 + 1.5625) / 3 - (2.75 / 3) * (2.75 / 3), 1e-15);
	CHECK_NEAR(s.negative_z, 1.0 / 3, 1e-15);
	CHECK_NEAR(s.outside, 1.0 / 3, 1e-15);
	CHECK_NEAR(s.tilt, 1.25 / 3, 1e-15);
	bake_image_free(&img);
}

static void
normal_stats_of_two_channels(void)
{
	struct bake_image img = blank(2, 1, 2), one = blank(1, 1, 1);
	struct bake_normal_stats s;
	struct bake_err err = BAKE_ERR_INIT;

	img.data[0] = 0.8f;
	img.data[1] = 0.8f;
	CHECK_OK(bake_normal_stats(&img, &s, &err), err);
	CHECK(isnan(s.length_mean) && isnan(s.length_dev));
	CHECK(s.outside == 0.5 && s.negative_z == 0 && s.nfinite == 2);
	CHECK(bake_normal_stats(&one, &s, &err) == BAKE_EINVAL);
	CHECK(strcmp(err.msg,
		  "a normal map has 2 or 3 channels, this one has 1") == 0);
	img.data[0] = img.data[2] = NAN;
	CHECK_OK(
	    bake_normal_stats(&img, &s, &(struct bake_err)BAKE_ERR_INIT), err);
	CHECK(isnan(s.outside) && s.nfinite == 0);
	bake_image_free(&img);
	bake_image_free(&one);
}

/* v = x: inner steps 1, the border's W - 1, on u; along v nothing moves. */
static void
seam_of_a_ramp(void)
{
	struct bake_image img = blank(11, 5, 1);
	struct bake_seams s;
	struct bake_err err = BAKE_ERR_INIT;

	for (int y = 0; y < 5; y++)
		for (int x = 0; x < 11; x++)
			*at(&img, x, y) = (float)x;
	CHECK_OK(bake_seams(&img, 0, 1, &s, &err), err);
	CHECK(s.u == 10 && s.u_peak == 10);
	CHECK(s.v == 0 && s.v_peak == 0);
	bake_image_free(&img);
}

/* A saw of period 4 with its jump at the border too: the border step is 3,
 * the inner steps 1 1 1 3 …, so u stands out and u_peak does not. */
static void
joint_on_the_border_is_no_worse_than_the_others(void)
{
	struct bake_image img = blank(16, 3, 3);
	struct bake_seams s;
	struct bake_err err = BAKE_ERR_INIT;

	for (int y = 0; y < 3; y++)
		for (int x = 0; x < 16; x++)
			at(&img, x, y)[2] = (float)(x % 4);
	CHECK_OK(bake_seams(&img, 2, 1, &s, &err), err);
	/* 15 inner steps: 12 of 1 and 3 of 3 */
	CHECK_NEAR(s.u, 3 / (21.0 / 15), 1e-15);
	CHECK(s.u_peak == 1);
	/* over all three channels both means shrink alike */
	CHECK_OK(bake_seams(&img, 0, 3, &s, &err), err);
	CHECK_NEAR(s.u, 3 / (21.0 / 15), 1e-15);
	bake_image_free(&img);
}

static void
seams_of_degenerate_maps(void)
{
	struct bake_image one = blank(1, 1, 1), row = blank(8, 1, 1);
	struct bake_image pair = blank(2, 1, 1);
	struct bake_seams s;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_seams(&one, 0, 1, &s, &err), err);
	CHECK(isnan(s.u) && isnan(s.v));
	CHECK_OK(bake_seams(&row, 0, 1, &s, &err), err);
	CHECK(s.u == 0 && isnan(s.v));
	pair.data[1] = 1;
	CHECK_OK(bake_seams(&pair, 0, 1, &s, &err), err);
	CHECK(s.u == 1);
	for (int x = 0; x < 8; x++)
		row.data[x] = x == 3 ? NAN : (float)(x % 2);
	CHECK_OK(bake_seams(&row, 0, 1, &s, &err), err);
	CHECK(s.u == 1); /* steps to and from the NaN are left out */
	bake_image_free(&one);
	bake_image_free(&row);
	bake_image_free(&pair);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(range_counts_what_is_not_finite),
		CASE(normal_stats_of_known_vectors),
		CASE(normal_stats_of_two_channels),
		CASE(seam_of_a_ramp),
		CASE(joint_on_the_border_is_no_worse_than_the_others),
		CASE(seams_of_degenerate_maps),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
