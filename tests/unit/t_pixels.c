/* Pixels: what is put is got, in every format, and nothing beside it. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <stdint.h>

#include "check.h"
#include "pixels.h"
#include "test_maps.h"

static const enum bake_data_format formats[] = { BAKE_DATA_UINT8,
	BAKE_DATA_UINT16, BAKE_DATA_HALF, BAKE_DATA_FLOAT };

static void
what_is_put_is_got(void)
{
	enum { W = 7, H = 3, NC = 3 };
	float row[W * NC], back[W * NC];
	struct bake_err err = BAKE_ERR_INIT;

	for (int f = 0; f < 4; f++) {
		struct bake_pixels px = BAKE_PIXELS_INIT;

		CHECK_OK(
		    bake_pixels_alloc(&px, W, H, NC, formats[f], &err), err);
		CHECK(px.width == W && px.height == H && px.nchans == NC &&
		      px.format == formats[f]);
		/* multiples of 1/255 and of 1/65535; halfs by 51 / 255 */
		for (int y = 0; y < H; y++) {
			for (int i = 0; i < W * NC; i++)
				row[i] = (float)((y * W * NC + i) % 6) / 5.0f;
			if (f == 2)
				for (int i = 0; i < W * NC; i++)
					row[i] = (float)(y * 40 + i) / 128.0f;
			bake_pixels_put(&px, 0, y, W, row);
			bake_pixels_get(&px, 0, y, W, back);
			CHECK(memcmp(row, back, sizeof row) == 0);
			bake_pixels_get(&px, 2, y, 4, back);
			CHECK(memcmp(row + 2 * NC, back,
				  4 * NC * sizeof *row) == 0);
		}
		bake_pixels_free(&px);
		CHECK(px.data == NULL && px.width == 0);
		bake_pixels_free(&px);
	}
}

static void
put_changes_only_its_texels(void)
{
	enum { W = 9, H = 4, NC = 2 };
	struct bake_err err = BAKE_ERR_INIT;

	for (int f = 0; f < 4; f++) {
		const size_t texel = NC * bake_data_format_size(formats[f]);
		const float v[4] = { 1, 1, 1, 1 };
		struct bake_pixels px = BAKE_PIXELS_INIT;
		const unsigned char *bytes;

		CHECK_OK(
		    bake_pixels_alloc(&px, W, H, NC, formats[f], &err), err);
		memset(px.data, 0xab, W * H * texel);
		bake_pixels_put(&px, 3, 2, 2, v);
		bake_pixels_put(&px, 0, 0, 0, v);
		bytes = px.data;
		for (size_t i = 0; i < W * H * texel; i++)
			CHECK(
			    (bytes[i] == 0xab) ==
			    (i / texel < 2 * W + 3 || i / texel >= 2 * W + 5 ||
				/* 1.0's high byte comes last */
				(f >= 2 && bytes[i] == 0xab)));
		bake_pixels_free(&px);
	}
}

static void
values_are_rounded_as_codes_are(void)
{
	static const float v[6] = { -1, 0.5f, 2, NAN, 1e6f, 0.3f };
	static const float want8[6] = { 0, 128 / 255.0f, 1, 0, 1,
		77 / 255.0f }; /* 76.5 of a float above 0.3 */
	static const float want16[6] = { 0, 32768 / 65535.0f, 1, 0, 1,
		19661 / 65535.0f };
	struct bake_err err = BAKE_ERR_INIT;
	float back[6];

	for (int f = 0; f < 4; f++) {
		struct bake_pixels px = BAKE_PIXELS_INIT;

		CHECK_OK(
		    bake_pixels_alloc(&px, 6, 1, 1, formats[f], &err), err);
		bake_pixels_put(&px, 0, 0, 6, v);
		bake_pixels_get(&px, 0, 0, 6, back);
		for (int i = 0; i < 6; i++) {
			if (i == 3 && f >= 2)
				CHECK(isnan(back[i]));
			else if (f == 0)
				CHECK(back[i] == want8[i]);
			else if (f == 1)
				CHECK(back[i] == want16[i]);
			else if (f == 3)
				CHECK(back[i] == v[i]);
		}
		if (f == 2) {
			CHECK(back[0] == -1 && back[1] == 0.5f && back[2] == 2);
			CHECK(back[4] == 65504);
			/* 0.3 in steps of 2^-12 */
			CHECK(back[5] == 1229 / 4096.0f);
		}
		bake_pixels_free(&px);
	}
}

static void
bad_sizes_are_errors(void)
{
	static const int bad[][3] = { { 0, 1, 1 }, { 1, 0, 1 }, { 1, 1, 0 },
		{ -5, 1, 1 } };
	struct bake_pixels px;
	struct bake_err err;

	for (int i = 0; i < 4; i++) {
		err = (struct bake_err)BAKE_ERR_INIT;
		CHECK(bake_pixels_alloc(&px, bad[i][0], bad[i][1], bad[i][2],
			  BAKE_DATA_HALF, &err) == BAKE_EINVAL);
		CHECK(px.data == NULL && px.width == 0 && err.msg[0] != '\0');
	}
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_pixels_alloc(&px, INT_MAX, INT_MAX, 4, BAKE_DATA_FLOAT,
		  &err) == BAKE_ENOMEM);
	CHECK(px.data == NULL && px.width == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_pixels_alloc(&px, INT_MAX, INT_MAX, INT_MAX, BAKE_DATA_UINT8,
		  &err) == BAKE_ENOMEM);
	for (int f = 0; f < 4; f++)
		CHECK(bake_data_format_size(formats[f]) == (size_t)(f == 0 ? 1
								    : f == 3
									? 4
									: 2));
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(what_is_put_is_got),
		CASE(put_changes_only_its_texels),
		CASE(values_are_rounded_as_codes_are),
		CASE(bad_sizes_are_errors),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
