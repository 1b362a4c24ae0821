/* The damping for 8-bit normals: whether the operator itself made them. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "integrate.h"
#include "test_maps.h"

/*
 * Depth of a few waves that tile, of at least W/8 texels each, and of bumps of
 * about 2 texels where `fine`, which operators see differently.
 */
static struct bake_image
waves(int w, int h, bool fine)
{
	struct bake_image img = image(w, h, 1);

	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			double u = 2 * pi * x / w, v = 2 * pi * y / h;
			double d = 0.5 + 0.15 * sin(2 * u + v) +
				   0.1 * cos(3 * v - u) + 0.05 * sin(5 * u);

			if (fine)
				d += 0.05 *
				     ((double)(hash((uint32_t)(y * w + x)) %
					       256) /
					     255 -
					 0.5);
			img.data[y * w + x] = (float)d;
		}
	return img;
}

static void
round_to_8_bits(struct bake_image *normal)
{
	for (size_t i = 0; i < nfloats(normal); i++)
		normal->data[i] =
		    floorf((normal->data[i] + 1) * 127.5f + 0.5f) / 127.5f - 1;
}

static double
damping_of(const struct bake_image *normal, struct bake_wrap wrap,
    enum bake_slope_op op)
{
	struct bake_integrate_params params = BAKE_INTEGRATE_PARAMS_DEFAULT;
	struct bake_err err = BAKE_ERR_INIT;
	double damping = -1;

	params.wrap = wrap;
	params.op = op;
	params.damping = 7; /* not looked at */
	CHECK_OK(bake_integrate_damping(normal, &params, &damping, &err), err);
	return damping;
}

static struct bake_image
normals_of(const struct bake_image *depth, struct bake_wrap wrap,
    enum bake_slope_op op)
{
	struct bake_image normal = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_normal_from_depth(depth, 0.1, wrap, op, 0, &normal, &err),
	    err);
	return normal;
}

static const int sizes[][2] = { { 64, 64 }, { 63, 41 }, { 128, 32 } };

/* The operator's own normals, in float and rounded to 8 bits, of any length. */
static void
own_normals_get_little(void)
{
	for (int k = 0; k < 3 * 2 * 2 * 2; k++) {
		struct bake_wrap wrap = k / 3 % 2 == 0 ? torus : clamped;
		enum bake_slope_op op =
		    k / 6 % 2 == 0 ? BAKE_SLOPE_CENTRAL : BAKE_SLOPE_SCHARR;
		struct bake_image depth =
		    waves(sizes[k % 3][0], sizes[k % 3][1], k / 12 != 0);
		struct bake_image normal = normals_of(&depth, wrap, op);

		CHECK(damping_of(&normal, wrap, op) == 0.03);
		round_to_8_bits(&normal);
		CHECK(damping_of(&normal, wrap, op) == 0.03);
		for (size_t i = 0; i < nfloats(&normal); i++)
			normal.data[i] *= 0.25f; /* only directions count */
		CHECK(damping_of(&normal, wrap, op) == 0.03);
		bake_image_free(&depth);
		bake_image_free(&normal);
	}
}

/* Normals of texel-sized bumps by forward differences: no map has them as its
 * central differences, or as Scharr's. */
static void
foreign_normals_get_more(void)
{
	for (int k = 0; k < 3 * 2; k++) {
		int w = sizes[k % 3][0], h = sizes[k % 3][1];
		enum bake_slope_op op =
		    k / 3 == 0 ? BAKE_SLOPE_CENTRAL : BAKE_SLOPE_SCHARR;
		struct bake_image depth = waves(w, h, true);
		struct bake_image normal = image(w, h, 3);

		for (int y = 0; y < h; y++)
			for (int x = 0; x < w; x++) {
				double at = depth.data[y * w + x];
				double right = depth.data[y * w + (x + 1) % w];
				double up = depth.data[(y + h - 1) % h * w + x];
				double p = 0.1 * w * (at - right);
				double q = 0.1 * w * (at - up);
				double len = sqrt(1 + p * p + q * q);
				float *n = &normal.data[3 * (y * w + x)];

				n[0] = (float)(-p / len);
				n[1] = (float)(-q / len);
				n[2] = (float)(1 / len);
			}
		CHECK(damping_of(&normal, torus, op) == 0.3);
		round_to_8_bits(&normal);
		CHECK(damping_of(&normal, torus, op) == 0.3);
		bake_image_free(&depth);
		bake_image_free(&normal);
	}
}

/* A twist, p = y and q = -x, is nobody's gradient. */
static void
no_gradient_gets_more(void)
{
	struct bake_image normal = image(32, 32, 3);

	for (int i = 0; i < 32 * 32; i++) {
		normal.data[3 * i] = (float)((i / 32 - 15.5) / 16);
		normal.data[3 * i + 1] = (float)((i % 32 - 15.5) / 16);
		normal.data[3 * i + 2] = 1;
	}
	CHECK(damping_of(&normal, clamped, BAKE_SLOPE_CENTRAL) == 0.3);
	bake_image_free(&normal);
}

/* Texels without a direction are left out; a map of nothing else is flat. */
static void
texels_without_direction_are_left_out(void)
{
	struct bake_image flat = image(16, 16, 3), depth = waves(64, 64, false);
	struct bake_image normal =
	    normals_of(&depth, torus, BAKE_SLOPE_CENTRAL);
	static const float none[] = { 0, NAN, INFINITY };

	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < 16 * 16 * 3; i++)
			flat.data[i] = none[k];
		CHECK(damping_of(&flat, torus, BAKE_SLOPE_CENTRAL) == 0.03);
	}
	for (int i = 0; i < 16 * 16 * 3; i++)
		flat.data[i] = i % 3 == 2;
	CHECK(damping_of(&flat, clamped, BAKE_SLOPE_SCHARR) == 0.03);
	/* one in 4096: what is wrong around it does not turn the mean */
	for (int c = 0; c < 3; c++)
		normal.data[3 * 1234 + c] = NAN;
	CHECK(damping_of(&normal, torus, BAKE_SLOPE_CENTRAL) == 0.03);
	bake_image_free(&flat);
	bake_image_free(&depth);
	bake_image_free(&normal);
}

static void
wrong_maps_are_refused(void)
{
	struct bake_integrate_params params = BAKE_INTEGRATE_PARAMS_DEFAULT;
	double damping;

	for (int nc = 1; nc <= 4; nc++) {
		struct bake_image img = noise(8, 8, nc);
		struct bake_err err = BAKE_ERR_INIT;

		CHECK(bake_integrate_damping(&img, &params, &damping, &err) ==
		      (nc == 3 ? BAKE_OK : BAKE_EINVAL));
		CHECK((nc == 3) == (err.msg[0] == '\0'));
		bake_image_free(&img);
	}
	{
		struct bake_image img = noise(8, 8, 3);
		struct bake_err err = BAKE_ERR_INIT;

		params.op = (enum bake_slope_op)9;
		CHECK(bake_integrate_damping(&img, &params, &damping, &err) ==
		      BAKE_EINVAL);
		bake_image_free(&img);
	}
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(own_normals_get_little),
		CASE(foreign_normals_get_more),
		CASE(no_gradient_gets_more),
		CASE(texels_without_direction_are_left_out),
		CASE(wrong_maps_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
