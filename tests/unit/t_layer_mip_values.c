/* Mip levels: normals, height fields and colours. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "test_layers.h"
#include "test_maps.h"

static const enum bake_data_format formats[] = { BAKE_DATA_UINT8,
	BAKE_DATA_UINT16, BAKE_DATA_HALF, BAKE_DATA_FLOAT };
static const double up[3] = { 0, 0, 1 };

static struct bake_layer_maps
level_of(const struct bake_layer_maps *m, int level, bool half,
    struct bake_layer_mip *mip)
{
	struct bake_layer_maps out;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_layer_mip(m, level, half, NULL, 1, &out, mip, &err), err);
	return out;
}

/* -- normals --------------------------------------------------------------- */

static double
angle_deg(const double a[3], const double b[3])
{
	const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

	return acos(dot > 1 ? 1 : dot) * 180 / pi;
}

/* A plate tilted in depth: every normal of every level is the plane's, to what
 * codes of 8 bits hold: half a code is 0.22 degrees here, twice rounded, and z
 * comes of x and y at a slope of 1/0.8. */
static void
planes_keep_their_normals(void)
{
	const double n[3] = { 0.48, -0.36, 0.8 };

	for (int f = 0; f < 4; f++) {
		struct bake_layer_maps m =
		    layer_maps(32, 32, 2, formats[f], 0, 3, formats[f]);

		for (int y = 0; y < 32; y++)
			for (int x = 0; x < 32; x++) {
				/* n . p = 0, z = (d0 - d) 64 texels deep */
				const double z =
				    -(n[0] * (x - 16) - n[1] * (y - 16)) / n[2];
				const double back[3] = { -n[0], -n[1], -n[2] };

				set_layer(&m, x, y, 0,
				    bake_layer_stored(0.4 - z / 64), n);
				set_layer(&m, x, y, 1,
				    bake_layer_stored(0.6 - z / 64), back);
			}
		for (int level = 1; level <= 3; level++) {
			struct bake_layer_maps out =
			    level_of(&m, level, false, NULL);
			double worst = 0;

			for (int i = 0; i < 2 * out.width * out.height; i++) {
				const int t = i / 2;
				const double s = i % 2 ? -1 : 1;
				const double want[3] = { s * n[0], s * n[1],
					s * n[2] };
				double got[3], a;

				CHECK(bake_layer_count(&out, t % out.width,
					  t / out.width) == 2);
				normal_at(&out, t % out.width, t / out.width,
				    i % 2, got);
				a = angle_deg(got, want);
				worst = a > worst ? a : worst;
			}
			CHECK(worst < (f == 0 ? 0.8 : 0.1));
			bake_layer_maps_free(&out);
		}
		bake_layer_maps_free(&m);
	}
}

/*
 * A ball of 60 texels. Where the level has the whole ball in its box, the
 * normal is within half a box of the analytic one at the box's middle: a box of
 * 2^l texels is asin(2^l / 60 / n_z) wide in angle, and the ball's rim, n_z <
 * 0.5, where it is many boxes deep, is left out.
 */
static void
balls_have_their_own_normals(void)
{
	struct bake_layer_maps m =
	    layer_maps(128, 128, 2, BAKE_DATA_UINT16, 0, 3, BAKE_DATA_UINT8);

	draw_ball(&m, 64, 64, 60, 128);
	for (int level = 1; level <= 3; level++) {
		struct bake_layer_maps out = level_of(&m, level, false, NULL);
		double worst = 0, sum = 0;
		int n = 0;

		for (int i = 0; i < 2 * out.width * out.height; i++) {
			const int x = i / 2 % out.width, y = i / 2 / out.width;
			const double dx = ((x + 0.5) * (1 << level) - 64) / 60;
			const double dy = (64 - (y + 0.5) * (1 << level)) / 60;
			const double zz = 1 - dx * dx - dy * dy;
			const double z =
			    (i % 2 ? -1 : 1) * sqrt(zz > 0 ? zz : 0);
			double got[3], a;

			if (zz < 0.25)
				continue;
			CHECK(bake_layer_count(&out, x, y) == 2);
			normal_at(&out, x, y, i % 2, got);
			a = angle_deg(got, (double[3]){ dx, dy, z });
			worst = a > worst ? a : worst;
			sum += a;
			n++;
		}
		printf("ball, level %d: normals off by %.2f degrees, at most "
		       "%.2f\n",
		    level, sum / n, worst);
		CHECK(worst < (1 << level) / 2.0 / 60 / 0.5 * 180 / pi);
		bake_layer_maps_free(&out);
	}
	bake_layer_maps_free(&m);
}

/* Half the box is one thick slab, half a thin one within its depths: each
 * transition has the normals of the layers that are there. */
static void
sheets_do_not_mix_their_normals(void)
{
	const double left[3] = { -0.6, 0, 0.8 }, right[3] = { 0.6, 0, 0.8 };
	struct bake_layer_maps m =
	    layer_maps(4, 4, 2, BAKE_DATA_FLOAT, 0, 3, BAKE_DATA_UINT8);
	struct bake_layer_maps out;
	double n[3];

	for (int i = 0; i < 16; i++) {
		set_layer(&m, i % 4, i / 4, 0, i % 4 < 2 ? 0.1 : 0.7,
		    i % 4 < 2 ? left : right);
		set_layer(&m, i % 4, i / 4, 1, i % 4 < 2 ? 0.9 : 0.8, up);
	}
	out = level_of(&m, 2, true, NULL);
	CHECK(bake_layer_count(&out, 0, 0) == 2);
	CHECK(value_at(&out.depth[0], 0, 0, 0) == 0.7f);
	CHECK(value_at(&out.depth[0], 0, 0, 1) == 0.8f);
	normal_at(&out, 0, 0, 0, n);
	CHECK_NEAR(angle_deg(n, right), 0, 0.01);
	bake_layer_maps_free(&out);
	bake_layer_maps_free(&m);
}

/* -- height fields --------------------------------------------------------- */

static void
height_fields_have_the_mean_of_depths_and_slopes(void)
{
	/* slopes n_x / n_z of 3/4 and 0, of -3/4 and 0 the other way */
	const double a[3] = { 0.6, 0, 0.8 };
	const double mean[3] = { 0.375, 0, 1 };
	struct bake_layer_maps m =
	    layer_maps(4, 2, 1, BAKE_DATA_FLOAT, 0, 3, BAKE_DATA_UINT8);
	struct bake_layer_mip mip;
	struct bake_layer_maps out;
	double n[3];

	for (int i = 0; i < 4; i++)
		set_layer(
		    &m, i % 2, i / 2, 0, 0.25 * (1 + i % 2), i % 2 ? up : a);
	/* of the other box, one of four texels; then two */
	set_layer(&m, 2, 0, 0, 0.5, up);
	out = level_of(&m, 1, false, &mip);
	CHECK(bake_layer_count(&out, 0, 0) == 1);
	CHECK(value_at(&out.depth[0], 0, 0, 0) == 0.375f);
	for (int c = 1; c < 4; c++)
		CHECK(value_at(&out.depth[0], 0, 0, c) == 1);
	normal_at(&out, 0, 0, 0, n);
	CHECK_NEAR(n[0] / n[2], mean[0], 1e-6);
	CHECK_NEAR(n[1] / n[2], mean[1], 1e-6);
	CHECK(bake_layer_count(&out, 1, 0) == 0);
	CHECK(value_at(&out.nx[0], 1, 0, 0) == 0.5f);
	CHECK(mip.tau == 0.5 && mip.capped == 0);
	CHECK_NEAR(mip.volume0, (4 * 0.625 + 0.5) / 8, 1e-9);
	CHECK_NEAR(mip.volume, 4 * 0.625 / 8, 1e-9);
	bake_layer_maps_free(&out);
	set_layer(&m, 3, 1, 0, 0.75, up);
	out = level_of(&m, 1, false, &mip);
	CHECK(value_at(&out.depth[0], 1, 0, 0) == 0.625f);
	bake_layer_maps_free(&out);
	bake_layer_maps_free(&m);
}

/* -- colours --------------------------------------------------------------- */

static void
fill_colors(struct bake_layer_maps *m, int image, const float (*rgba)[4])
{
	for (int i = 0; i < m->width * m->height; i++)
		bake_pixels_put(
		    &m->color[image], i % m->width, i / m->width, 1, rgba[i]);
}

/* Half black, half white is 0.5 in linear light: code 188 of sRGB. */
static void
colors_are_averaged_in_linear_light(void)
{
	static const float checker[4][4] = { { 0, 0, 0, 1 }, { 1, 1, 1, 1 },
		{ 1, 1, 1, 1 }, { 0, 0, 0, 1 } };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_color *color;
	struct bake_layer_maps out;

	CHECK_OK(bake_color_open(NULL, &color, &err), err);
	for (int f = 0; f < 4; f++) {
		const float want = f < 2 ? 188 / 255.0f : 0.5f;
		struct bake_layer_maps m =
		    layer_maps(2, 2, 2, BAKE_DATA_UINT8, 1, 4, formats[f]);

		for (int i = 0; i < 8; i++)
			set_layer(&m, i / 2 % 2, i / 4, i % 2,
			    0.2 + 0.2 * (i % 2), up);
		fill_colors(&m, 0, checker);
		CHECK_OK(
		    bake_layer_mip(&m, 1, false, color, 2, &out, NULL, &err),
		    err);
		CHECK(out.color_linear == (f >= 2));
		for (int c = 0; c < 3; c++)
			CHECK_NEAR(value_at(&out.color[0], 0, 0, c), want,
			    f == 1 ? 1.0 / 255 : 0);
		CHECK(value_at(&out.color[0], 0, 0, 3) == 1);
		bake_layer_maps_free(&out);
		bake_layer_maps_free(&m);
	}
	bake_color_close(color);
}

/* Alpha is coverage; r g b those of the covered texels, not multiplied. */
static void
colors_of_empty_texels_do_not_bleed(void)
{
	static const float rgba[4][4] = { { 0.25f, 0.5f, 0.75f, 1 },
		{ 9, 9, 9, 0 }, { 9, 9, 9, 0 }, { 9, 9, 9, 0 } };
	struct bake_layer_maps m =
	    layer_maps(4, 2, 2, BAKE_DATA_UINT8, 1, 4, BAKE_DATA_FLOAT);
	struct bake_layer_maps out;

	set_layer(&m, 0, 0, 0, 0.2, up);
	set_layer(&m, 0, 0, 1, 0.4, up);
	for (int i = 0; i < 4; i++)
		bake_pixels_put(&m.color[0], i % 2, i / 2, 1, rgba[i]);
	for (int half = 0; half < 2; half++) {
		out = level_of(&m, 1, half, NULL);
		/* with 1/2 there is no layer, but the colour and coverage */
		CHECK(bake_layer_count(&out, 0, 0) == (half ? 0 : 2));
		for (int c = 0; c < 3; c++)
			CHECK(value_at(&out.color[0], 0, 0, c) == rgba[0][c]);
		CHECK(value_at(&out.color[0], 0, 0, 3) == 0.25f);
		for (int c = 0; c < 4; c++)
			CHECK(value_at(&out.color[0], 1, 0, c) == 0);
		CHECK(value_at(&out.nx[0], 1, 0, 0) == 128 / 255.0f);
		bake_layer_maps_free(&out);
	}
	bake_layer_maps_free(&m);
}

/* With a colour for each layer, a transition has those of its own sheet, where
 * it is in other places of the stack. */
static void
colors_follow_their_sheets(void)
{
	static const float red[4] = { 1, 0, 0, 1 }, blue[4] = { 0, 0, 1, 1 };
	struct bake_layer_maps m =
	    layer_maps(2, 1, 4, BAKE_DATA_FLOAT, 4, 3, BAKE_DATA_FLOAT);
	struct bake_layer_maps out;

	/* a red sheet in the left texel only, a blue one in both behind */
	for (int i = 0; i < 4; i++) {
		set_layer(&m, 0, 0, i, 0.2 + 0.15 * i, up);
		bake_pixels_put(&m.color[i], 0, 0, 1, i < 2 ? red : blue);
	}
	for (int i = 0; i < 2; i++) {
		set_layer(&m, 1, 0, i, 0.5 + 0.15 * i, up);
		bake_pixels_put(&m.color[i], 1, 0, 1, blue);
	}
	out = level_of(&m, 1, false, NULL);
	CHECK(bake_layer_count(&out, 0, 0) == 4);
	for (int i = 0; i < 4; i++)
		for (int c = 0; c < 3; c++)
			CHECK(value_at(&out.color[i], 0, 0, c) ==
			      (i < 2 ? red : blue)[c]);
	bake_layer_maps_free(&out);
	/* 1/2 has the blue one only, and two layers more that are none */
	out = level_of(&m, 1, true, NULL);
	CHECK(bake_layer_count(&out, 0, 0) == 2);
	for (int c = 0; c < 3; c++)
		CHECK(value_at(&out.color[0], 0, 0, c) == blue[c]);
	bake_layer_maps_free(&out);
	bake_layer_maps_free(&m);
}

static void
encoded_colors_want_a_configuration(void)
{
	struct bake_layer_maps m =
	    layer_maps(4, 4, 2, BAKE_DATA_UINT8, 1, 3, BAKE_DATA_UINT8);
	struct bake_layer_maps out = BAKE_LAYER_MAPS_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_layer_mip(&m, 1, false, NULL, 1, &out, NULL, &err) ==
	      BAKE_EINVAL);
	CHECK(out.width == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	m.color_linear = true;
	CHECK_OK(bake_layer_mip(&m, 1, false, NULL, 1, &out, NULL, &err), err);
	CHECK(out.color_linear);
	bake_layer_maps_free(&out);
	bake_layer_maps_free(&m);
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(planes_keep_their_normals),
		CASE(balls_have_their_own_normals),
		CASE(sheets_do_not_mix_their_normals),
		CASE(height_fields_have_the_mean_of_depths_and_slopes),
		CASE(colors_are_averaged_in_linear_light),
		CASE(colors_of_empty_texels_do_not_bleed),
		CASE(colors_follow_their_sheets),
		CASE(encoded_colors_want_a_configuration),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
