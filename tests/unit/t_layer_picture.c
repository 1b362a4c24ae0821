/* Pictures of layers: panels, light, tint, and what is empty. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "test_layers.h"
#include "test_maps.h"

enum { GAP = 4 };

static const double up[3] = { 0, 0, 1 };

static struct bake_image
picture_of(const struct bake_layer_maps *m, const struct bake_color *color)
{
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_layer_picture(m, color, &img, &err), err);
	return img;
}

/* Pixel (x, y) of the panel in that column and row, panels w x h. */
static const float *
pixel(const struct bake_image *img, int column, int row, int w, int h, int x,
    int y)
{
	return bake_image_row(img, GAP + row * (h + GAP) + y) +
	       3 * (size_t)(GAP + column * (w + GAP) + x);
}

static void
panels_are_four_to_a_row(void)
{
	static const int t[][4] = { { 1, 1, 1, 0 }, { 2, 2, 1, 0 },
		{ 4, 4, 1, 0 }, { 6, 4, 2, 0 }, { 64, 4, 16, 0 } };

	for (int i = 0; i < 5; i++) {
		struct bake_layer_maps m = layer_maps(
		    20, 10, t[i][0], BAKE_DATA_UINT8, 0, 3, BAKE_DATA_UINT8);
		struct bake_image img = picture_of(&m, NULL);

		CHECK(img.nchans == 3);
		CHECK(img.width == GAP + t[i][1] * (20 + GAP));
		CHECK(img.height == GAP + t[i][2] * (10 + GAP));
		bake_image_free(&img);
		bake_layer_maps_free(&m);
	}
}

static void
large_textures_are_reduced_by_whole_factors(void)
{
	static const int t[][4] = { { 512, 3, 512, 3 }, { 513, 4, 256, 2 },
		{ 1, 1025, 1, 341 }, { 4096, 9, 512, 1 } };

	for (int i = 0; i < 4; i++) {
		struct bake_layer_maps m = layer_maps(t[i][0], t[i][1], 2,
		    BAKE_DATA_UINT8, 0, 3, BAKE_DATA_UINT8);
		struct bake_image img = picture_of(&m, NULL);

		CHECK(img.width == 3 * GAP + 2 * t[i][2]);
		CHECK(img.height == 2 * GAP + t[i][3]);
		bake_image_free(&img);
		bake_layer_maps_free(&m);
	}
}

/* What the header says of a surface that faces the viewer, of albedo 1. */
static double
facing(double d)
{
	return (1 - 0.65 * d) * (0.2 + 0.8 * 1.2 / sqrt(1 + 1 + 1.2 * 1.2));
}

static void
a_white_plate_is_as_bright_as_the_formula(void)
{
	const float white[3] = { 1, 1, 1 };

	for (int f = 0; f < 2; f++) { /* 1 and 16 texels a pixel */
		const int side = f ? 2048 : 16;
		struct bake_layer_maps m = layer_maps(
		    side, 8, 2, BAKE_DATA_FLOAT, 2, 3, BAKE_DATA_FLOAT);
		struct bake_image img;

		for (int i = 0; i < 16 * side; i++) {
			const int x = i / 2 % side, y = i / 2 / side;

			set_layer(&m, x, y, i % 2,
			    bake_layer_stored(i % 2 ? 0.75 : 0.25), up);
			bake_pixels_put(&m.color[i % 2], x, y, 1, white);
		}
		img = picture_of(&m, NULL);
		for (int i = 0; i < 2; i++)
			for (int c = 0; c < 3; c++)
				/* floats, a few operations */
				CHECK_NEAR(pixel(&img, i, 0, f ? 512 : 16,
					       f ? 2 : 8, 5, 1)[c],
				    sqrt(facing(i ? 0.75 : 0.25)), 1e-6);
		bake_image_free(&img);
		bake_layer_maps_free(&m);
	}
}

/* The front is bright at the upper left; of the back, seen from within, the
 * lower right is turned to the light. */
static void
balls_are_lit_from_the_upper_left(void)
{
	struct bake_layer_maps m =
	    layer_maps(64, 64, 2, BAKE_DATA_UINT16, 0, 3, BAKE_DATA_UINT8);
	struct bake_image img;

	draw_ball(&m, 32, 32, 30, 1000);
	img = picture_of(&m, NULL);
	for (int i = 0; i < 2; i++) {
		const float *a = pixel(&img, i, 0, 64, 64, 18, 18);
		const float *b = pixel(&img, i, 0, 64, 64, 45, 45);
		const float *c = pixel(&img, i, 0, 64, 64, 18, 45);
		const float *d = pixel(&img, i, 0, 64, 64, 45, 18);

		CHECK((a[1] > 1.2f * b[1]) == (i == 0));
		CHECK((b[1] > 1.2f * a[1]) == (i == 1));
		/* the same across the light */
		CHECK_NEAR(c[1], d[1], 0.01);
	}
	bake_image_free(&img);
	bake_layer_maps_free(&m);
}

static void
empty_texels_are_a_checkerboard(void)
{
	struct bake_layer_maps m =
	    layer_maps(32, 32, 2, BAKE_DATA_UINT8, 0, 3, BAKE_DATA_UINT8);
	struct bake_image img = picture_of(&m, NULL);
	const float *a = pixel(&img, 1, 0, 32, 32, 0, 0);
	const float *b = pixel(&img, 1, 0, 32, 32, 8, 0);

	CHECK(a[0] > 0.05f && b[0] > a[0] && b[0] < a[0] + 0.1f);
	for (int y = 0; y < 32; y++)
		for (int x = 0; x < 32; x++)
			for (int i = 0; i < 2; i++)
				CHECK(memcmp(pixel(&img, i, 0, 32, 32, x, y),
					  (x / 8 + y / 8) % 2 ? b : a,
					  3 * sizeof *a) == 0);
	bake_image_free(&img);
	bake_layer_maps_free(&m);
}

/* Code 188 of sRGB is half of the light of 255. */
static void
colors_are_decoded(void)
{
	const float v[3] = { 1, 188 / 255.0f, 0 };
	struct bake_layer_maps m =
	    layer_maps(8, 8, 2, BAKE_DATA_FLOAT, 1, 3, BAKE_DATA_UINT8);
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_color *color;
	const float *p;

	CHECK_OK(bake_color_open(NULL, &color, &err), err);
	set_layer(&m, 3, 3, 0, bake_layer_stored(0.5), up);
	bake_pixels_put(&m.color[0], 3, 3, 1, v);
	img = picture_of(&m, color);
	p = pixel(&img, 0, 0, 8, 8, 3, 3);
	CHECK_NEAR(p[0], sqrt(facing(0.5)), 1e-5);
	/* the code is within half of 1/255 of it */
	CHECK_NEAR(p[1] * p[1] / (p[0] * p[0]), 0.5, 0.005);
	CHECK(p[2] == 0);
	bake_image_free(&img);
	CHECK(bake_layer_picture(&m, NULL, &img, &err) == BAKE_EINVAL);
	CHECK(img.data == NULL && err.msg[0] != '\0');
	bake_color_close(color);
	bake_layer_maps_free(&m);
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(panels_are_four_to_a_row),
		CASE(large_textures_are_reduced_by_whole_factors),
		CASE(a_white_plate_is_as_bright_as_the_formula),
		CASE(balls_are_lit_from_the_upper_left),
		CASE(empty_texels_are_a_checkerboard),
		CASE(colors_are_decoded),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
