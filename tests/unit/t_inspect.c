/* Layouts guessed from texels, maps taken out, contradictions found. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "inspect.h"
#include "sheet.h"

enum { N = 96 };
static const int rgba[4] = { 0, 1, 2, 3 };

/* What the channels of a test image are made of. */
enum { NX, NY, NZ, AO, DEPTH, ONE, GREY, RED, NSOURCES };

/* Bumps with depth scale 0.1, y up: stored codes of each source. */
static void
sources(float v[NSOURCES], int x, int y)
{
	double a = 2 * acos(-1) * 3 * x / N, b = 2 * acos(-1) * 4 * y / N;
	double h = 0.5 + 0.2 * cos(a) * cos(b) + 0.2 * sin(a + 2 * b);
	double ha = -0.2 * sin(a) * cos(b) + 0.2 * cos(a + 2 * b);
	double hb = -0.2 * cos(a) * sin(b) + 0.4 * cos(a + 2 * b);
	double p = 0.1 * ha * 2 * acos(-1) * 3;
	double q = -0.1 * hb * 2 * acos(-1) * 4; /* rows run down */
	double len = sqrt(1 + p * p + q * q);

	v[NX] = (float)(0.5 - 0.5 * p / len);
	v[NY] = (float)(0.5 - 0.5 * q / len);
	v[NZ] = (float)(0.5 + 0.5 / len);
	v[AO] = (float)(0.4 + 0.5 * h);
	v[DEPTH] = (float)(1 - h);
	v[ONE] = 1;
	v[GREY] = (float)h;
	v[RED] = (float)(0.2 + 0.1 * h);
}

static struct bake_image
make(const int *source, int nchans)
{
	struct bake_image img;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_image_alloc(&img, N, N, nchans, &err), err);
	for (int y = 0; y < N; y++)
		for (int x = 0; x < N; x++) {
			float v[NSOURCES];

			sources(v, x, y);
			for (int c = 0; c < nchans; c++)
				bake_image_row(&img, y)[x * nchans + c] =
				    v[source[c]];
		}
	return img;
}

static void
layouts_are_guessed(void)
{
	static const struct {
		int nchans, source[4];
		enum bake_layout layout;
	} cases[] = {
		{ 4, { NX, NY, AO, DEPTH }, BAKE_LAYOUT_RELIEF },
		{ 4, { NX, NY, NZ, DEPTH }, BAKE_LAYOUT_NORMAL_RELIEF },
		{ 4, { NX, NY, NZ, ONE }, BAKE_LAYOUT_NORMAL },
		{ 4, { RED, GREY, AO, ONE }, BAKE_LAYOUT_UNKNOWN },
		{ 4, { GREY, GREY, GREY, ONE }, BAKE_LAYOUT_DEPTH },
		{ 3, { NX, NY, NZ, 0 }, BAKE_LAYOUT_NORMAL },
		{ 3, { RED, GREY, AO, 0 }, BAKE_LAYOUT_UNKNOWN },
		{ 3, { GREY, GREY, GREY, 0 }, BAKE_LAYOUT_DEPTH },
		{ 2, { GREY, ONE, 0, 0 }, BAKE_LAYOUT_DEPTH },
		{ 1, { DEPTH, 0, 0, 0 }, BAKE_LAYOUT_DEPTH },
	};
	struct bake_err err = BAKE_ERR_INIT;

	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		struct bake_image img = make(cases[k].source, cases[k].nchans);
		enum bake_layout layout;

		CHECK_OK(bake_layout_guess(&img, rgba,
			     BAKE_NORMAL_CODE_UNSIGNED, &layout, &err),
		    err);
		CHECK(layout == cases[k].layout);
		bake_image_free(&img);
	}
}

/* A packed texture's own conventions are found, and only what is declared
 * otherwise contradicts. */
static void
contradictions_are_those_and_no_others(void)
{
	static const int source[4] = { NX, NY, AO, DEPTH };
	struct bake_image img = make(source, 4);
	struct bake_maps maps;
	struct bake_inspection found = { .layout = BAKE_LAYOUT_RELIEF };
	struct bake_relief_meta said = BAKE_RELIEF_META_INIT;
	struct bake_contradictions bad;
	struct bake_wrap wrap = { false, false };
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_maps_extract(&maps, &img, rgba, BAKE_LAYOUT_RELIEF,
		     BAKE_NORMAL_CODE_UNSIGNED, 0, &err),
	    err);
	CHECK(maps.normal.nchans == 2 && maps.ao.nchans == 1);
	CHECK(maps.relief.data[5] == img.data[4 * 5 + 3]);
	CHECK(maps.ao.data[5] == img.data[4 * 5 + 2]);
	CHECK_OK(bake_inspect_maps(&found, &maps, wrap, &err), err);
	CHECK(found.has_normals && found.has_relief);
	CHECK(found.detection.polarity == BAKE_POLARITY_DEPTH);
	CHECK(found.detection.normal_y == BAKE_NORMAL_Y_UP);
	/* within 1 %: see t_detect, depth_scale_is_found */
	CHECK_NEAR(found.detection.depth_scale, 0.1, 0.001);
	bake_contradictions_find(&bad, &found, &said);
	CHECK(bad.n == 0);
	said.polarity = BAKE_POLARITY_DEPTH;
	said.normal_y = BAKE_NORMAL_Y_UP;
	said.depth_scale = 0.19;
	bake_contradictions_find(&bad, &found, &said);
	CHECK(bad.n == 0);
	said.polarity = BAKE_POLARITY_HEIGHT;
	said.normal_y = BAKE_NORMAL_Y_DOWN;
	said.depth_scale = 0.21;
	found.nbad = 3;
	bake_contradictions_find(&bad, &found, &said);
	CHECK(bad.n == 4);
	CHECK(strcmp(bad.text[0], "3 values are NaN or infinite") == 0);
	CHECK(strcmp(bad.text[1],
		  "polarity: the maps say depth, declared is height") == 0);
	CHECK(strcmp(bad.text[2],
		  "normal y: the maps say up, declared is down") == 0);
	said.depth_scale = 0.04;
	bake_contradictions_find(&bad, &found, &said);
	CHECK(bad.n == 4);
	bake_maps_free(&maps);
	bake_image_free(&img);
}

static void
a_normal_map_of_another_size_is_resampled(void)
{
	static const int normal[3] = { NX, NY, NZ }, depth[1] = { DEPTH };
	struct bake_image n = make(normal, 3), d = make(depth, 1);
	struct bake_image half = BAKE_IMAGE_INIT;
	struct bake_maps maps = BAKE_MAPS_INIT;
	struct bake_inspection found = { .nbad = 0 };
	struct bake_wrap wrap = { false, false };
	struct bake_err err = BAKE_ERR_INIT;

	/* every second column, so that x is coarser and y is not */
	CHECK_OK(bake_image_alloc(&half, N / 2, N, 3, &err), err);
	for (int y = 0; y < N; y++)
		for (int x = 0; x < N / 2; x++)
			for (int c = 0; c < 3; c++)
				bake_image_row(&half, y)[3 * x + c] =
				    2 * bake_image_row(&n, y)[6 * x + c] - 1;
	bake_image_swap(&maps.normal, &half);
	bake_image_swap(&maps.relief, &d);
	CHECK_OK(bake_inspect_maps(&found, &maps, wrap, &err), err);
	CHECK(found.detection.polarity == BAKE_POLARITY_DEPTH);
	CHECK(found.detection.normal_y == BAKE_NORMAL_Y_UP);
	bake_maps_free(&maps);
	bake_image_free(&n);
}

/* Depths 2 .. 6 in the file: v' = (v - 2) / 4; near beyond far turns round. */
static void
relief_values_are_brought_to_a_range(void)
{
	struct bake_maps maps = BAKE_MAPS_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	bake_maps_set_range(&maps, 0, 2); /* no relief: nothing happens */
	CHECK_OK(bake_image_alloc(&maps.relief, 2, 1, 1, &err), err);
	maps.relief.data[0] = 2;
	maps.relief.data[1] = 5;
	bake_maps_set_range(&maps, 2, 6);
	CHECK(maps.relief.data[0] == 0 && maps.relief.data[1] == 0.75f);
	bake_maps_set_range(&maps, 1, 0);
	CHECK(maps.relief.data[0] == 1 && maps.relief.data[1] == 0.25f);
	bake_maps_free(&maps);
}

static void
extraction_needs_the_channels(void)
{
	static const int source[3] = { NX, NY, NZ };
	struct bake_image img = make(source, 3);
	struct bake_maps maps;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_maps_extract(&maps, &img, rgba, BAKE_LAYOUT_RELIEF,
		  BAKE_NORMAL_CODE_UNSIGNED, 0, &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "layout relief needs 4 channels, there are 3") ==
	      0);
	CHECK(maps.normal.data == NULL && maps.relief.data == NULL);
	bake_image_free(&img);
}

/* Flat normals, AO 1/2, depth 1/4: every panel's value in closed form. */
static void
sheet_shows_known_values(void)
{
	struct bake_maps maps = BAKE_MAPS_INIT;
	struct bake_image row[2], sheet;
	struct bake_err err = BAKE_ERR_INIT;
	int panel = BAKE_SHEET_PANEL + BAKE_SHEET_GAP;
	/* l_z = 1.2 / sqrt(1 + 1 + 1.44) */
	double lit = sqrt((0.2 + 0.8 * 1.2 / sqrt(3.44)) * 0.5);
	const double want[4][3] = { { 0.5, 0.5, 1 }, { 0.5, 0.5, 0.5 },
		{ 0.25, 0.25, 0.25 }, { lit, lit, lit } };

	CHECK(bake_sheet_row(&maps, false, &row[0], &err) == BAKE_EINVAL);
	CHECK(bake_sheet_stack(row, 0, &sheet, &err) == BAKE_EINVAL);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK_OK(bake_image_alloc(&maps.normal, 1024, 32, 2, &err), err);
	CHECK_OK(bake_image_alloc(&maps.ao, 1024, 32, 1, &err), err);
	CHECK_OK(bake_image_alloc(&maps.relief, 1024, 32, 1, &err), err);
	for (int k = 0; k < 1024 * 32; k++) {
		maps.normal.data[2 * k] = maps.normal.data[2 * k + 1] = 0;
		maps.ao.data[k] = 0.5f;
		maps.relief.data[k] = 0.25f;
	}
	CHECK_OK(bake_sheet_row(&maps, false, &row[0], &err), err);
	CHECK(row[0].width == 4 * panel + BAKE_SHEET_GAP);
	CHECK(row[0].height == 16 + 2 * BAKE_SHEET_GAP);
	for (int k = 0; k < 4; k++)
		for (int c = 0; c < 3; c++)
			/* float arithmetic on values below 1; l is rounded
			 * to 6 digits */
			CHECK_NEAR(bake_image_row(
				       &row[0], 10)[3 * (k * panel + 100) + c],
			    want[k][c], 1e-5);
	bake_image_free(&maps.ao);
	CHECK_OK(bake_sheet_row(&maps, true, &row[1], &err), err);
	CHECK_NEAR(bake_image_row(&row[1], 10)[3 * (3 * panel + 100)],
	    lit * sqrt(2), 1e-5);
	CHECK_OK(bake_sheet_stack(row, 2, &sheet, &err), err);
	CHECK(sheet.height == row[0].height + row[1].height);
	CHECK(bake_image_row(&sheet, row[0].height + 10)[300] ==
	      bake_image_row(&row[1], 10)[300]);
	bake_image_free(&sheet);
	bake_image_free(&row[0]);
	bake_image_free(&row[1]);
	bake_maps_free(&maps);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(layouts_are_guessed),
		CASE(contradictions_are_those_and_no_others),
		CASE(a_normal_map_of_another_size_is_resampled),
		CASE(relief_values_are_brought_to_a_range),
		CASE(extraction_needs_the_channels),
		CASE(sheet_shows_known_values),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
