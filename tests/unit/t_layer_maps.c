/* Layer maps: allocation, counting, and dilation against a slow oracle. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>

#include "check.h"
#include "test_layers.h"
#include "test_maps.h"

static const enum bake_data_format formats[] = { BAKE_DATA_UINT8,
	BAKE_DATA_UINT16, BAKE_DATA_HALF, BAKE_DATA_FLOAT };

static void
new_maps_are_empty(void)
{
	static const uint32_t half_code[] = { 128, 32768, 0x3800, 0x3f000000 };

	for (int f = 0; f < 4; f++) {
		struct bake_layer_maps m =
		    layer_maps(5, 3, 6, formats[f], 2, 4, formats[3 - f]);

		CHECK(m.width == 5 && m.height == 3 && m.nlayers == 6);
		CHECK(m.ntextures == 2 && m.ncolors == 2);
		CHECK(m.color_linear == (3 - f >= 2));
		for (int y = 0; y < 3; y++)
			for (int x = 0; x < 5; x++) {
				CHECK(bake_layer_count(&m, x, y) == 0);
				for (int i = 0; i < 8; i++)
					CHECK(value_at(&m.depth[i / 4], x, y,
						  i % 4) == 1);
				for (int i = 0; i < 8; i++)
					CHECK(value_at(&m.color[i / 4], x, y,
						  i % 4) == 0);
			}
		/* the normal of 'no layer': the code nearest to 1/2 */
		for (int i = 0; i < 8; i++) {
			struct bake_layer_maps n = m;

			n.depth[i / 4] = m.nx[i / 4];
			CHECK(code_at(&n, 4, 2, i) == half_code[f]);
			n.depth[i / 4] = m.ny[i / 4];
			CHECK(code_at(&n, 0, 1, i) == half_code[f]);
		}
		bake_layer_maps_free(&m);
		CHECK(m.width == 0 && m.depth[0].data == NULL);
		bake_layer_maps_free(&m);
	}
}

static void
layers_are_counted_up_to_the_first_that_is_none(void)
{
	const double up[3] = { 0, 0, 1 };

	for (int f = 0; f < 4; f++) {
		struct bake_layer_maps m =
		    layer_maps(2, 2, 6, formats[f], 0, 3, formats[f]);

		for (int n = 0; n <= 6; n++) {
			CHECK(bake_layer_count(&m, 1, 1) == n);
			CHECK(bake_layer_count(&m, 0, 1) == 0);
			if (n < 6)
				set_layer(&m, 1, 1, n, 0.1 * (n + 1), up);
		}
		set_layer(&m, 1, 1, 2, 1, up);
		CHECK(bake_layer_count(&m, 1, 1) == 2);
		if (f >= 2) {
			set_layer(&m, 1, 1, 0, (double)NAN, up);
			CHECK(bake_layer_count(&m, 1, 1) == 0);
			set_layer(&m, 1, 1, 0, 2, up);
			CHECK(bake_layer_count(&m, 1, 1) == 0);
		}
		bake_layer_maps_free(&m);
	}
}

static void
bad_sizes_are_errors(void)
{
	static const struct {
		int w, h, nlayers, ncolors, chans;
		enum bake_status want;
	} t[] = { { 0, 1, 2, 0, 3, BAKE_EINVAL },
		{ 1, -1, 2, 0, 3, BAKE_EINVAL }, { 1, 1, 0, 0, 3, BAKE_EINVAL },
		{ 1, 1, 3, 0, 3, BAKE_EINVAL },
		{ 1, 1, BAKE_LAYERS_MAX + 2, 0, 3, BAKE_EINVAL },
		{ 1, 1, 2, 3, 3, BAKE_EINVAL }, { 1, 1, 2, -1, 3, BAKE_EINVAL },
		{ 1, 1, 2, 1, 2, BAKE_EINVAL }, { 1, 1, 2, 1, 5, BAKE_EINVAL },
		{ INT_MAX, INT_MAX, 4, 0, 3, BAKE_ENOMEM },
		{ 1, 1, 2, 0, 0, BAKE_OK }, { 1, 1, 1, 1, 4, BAKE_OK },
		{ 1, 1, BAKE_LAYERS_MAX, BAKE_LAYERS_MAX, 4, BAKE_OK } };

	for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
		struct bake_layer_maps m;
		struct bake_err err = BAKE_ERR_INIT;

		CHECK(bake_layer_maps_alloc(&m, t[i].w, t[i].h, t[i].nlayers,
			  BAKE_DATA_FLOAT, t[i].ncolors, t[i].chans,
			  BAKE_DATA_FLOAT, &err) == t[i].want);
		CHECK((err.msg[0] != '\0') == (t[i].want != BAKE_OK));
		if (t[i].want != BAKE_OK)
			CHECK(m.width == 0 && m.depth[0].data == NULL &&
			      m.ntextures == 0);
		bake_layer_maps_free(&m);
	}
}

/* -- dilation -------------------------------------------------------------- */

/* Random numbers of layers, with normals and colours that name their texel. */
static struct bake_layer_maps
named_maps(int w, int h, int share, enum bake_data_format format)
{
	struct bake_layer_maps m =
	    layer_maps(w, h, 4, format, 2, 4, BAKE_DATA_UINT8);

	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			const uint32_t r = hash((uint32_t)(y * w + x + w * h));
			const int n = (int)(r % 100) < share
					  ? 2 + (int)(r / 100 % 2) * 2
					  : 0;

			for (int i = 0; i < n; i++) {
				set_layer(&m, x, y, i, 0.2 * (i + 1),
				    (double[3]){
					2.0 * x / w - 1, 2.0 * y / h - 1, 0 });
				if (i < 2)
					for (int c = 0; c < 4; c++)
						set_value(&m.color[i], x, y, c,
						    (float)((x + 16 * y +
								8 * c) %
							    256) /
							255);
			}
		}
	return m;
}

/* The texel whose normals and colours (x, y) takes for layer i: all within n
 * tried, the ones that the header prefers first. */
static bool
find_source(const struct bake_layer_maps *m, int i, int n, const bool tile[2],
    const int at[2], int source[2])
{
	long best = LONG_MAX;

	for (int ax = 0; ax <= n; ax++)
		for (int side = -1; side <= 1; side += 2)
			for (int dy = -n; dy <= n; dy++) {
				const int dx = side * ax;
				const long d = (long)dx * dx + (long)dy * dy;
				int x = at[0] + dx, y = at[1] + dy;

				if (tile[0])
					x = bake_wrap_index(x, m->width, false);
				if (tile[1])
					y = bake_wrap_index(
					    y, m->height, false);
				if (x < 0 || x >= m->width || y < 0 ||
				    y >= m->height || d > (long)n * n ||
				    d >= best || bake_layer_count(m, x, y) <= i)
					continue;
				best = d;
				source[0] = x;
				source[1] = y;
			}
	return best < LONG_MAX;
}

static bool
took_from(const struct bake_layer_maps *m, const struct bake_layer_maps *old,
    int i, int x, int y, const int s[2])
{
	bool ok = value_at(&m->nx[0], x, y, i) ==
		      value_at(&old->nx[0], s[0], s[1], i) &&
		  value_at(&m->ny[0], x, y, i) ==
		      value_at(&old->ny[0], s[0], s[1], i);

	for (int c = 0; c < 3 && i < m->ncolors; c++)
		ok = ok && value_at(&m->color[i], x, y, c) ==
			       value_at(&old->color[i], s[0], s[1], c);
	/* coverage stays */
	if (i < m->ncolors)
		ok = ok && value_at(&m->color[i], x, y, 3) ==
			       value_at(&old->color[i], x, y, 3);
	return ok;
}

static void
check_dilation(int w, int h, int share, int n, const bool tile[2],
    enum bake_data_format format)
{
	struct bake_layer_maps m = named_maps(w, h, share, format);
	struct bake_layer_maps old = named_maps(w, h, share, format);
	struct bake_layer_maps many = named_maps(w, h, share, format);
	struct bake_err err = BAKE_ERR_INIT;
	int nbad = 0;

	CHECK_OK(bake_layer_dilate(&m, n, tile[0], tile[1], 1, &err), err);
	CHECK_OK(bake_layer_dilate(&many, n, tile[0], tile[1], 3, &err), err);
	CHECK(same_maps(&m, &many));
	CHECK(same_pixels(&m.depth[0], &old.depth[0]));
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++)
			for (int i = 0; i < 4; i++) {
				const int at[2] = { x, y };
				int s[2] = { x, y };

				if (bake_layer_count(&old, x, y) <= i &&
				    !find_source(&old, i, n, tile, at, s)) {
					s[0] = x;
					s[1] = y;
				}
				nbad += !took_from(&m, &old, i, x, y, s);
			}
	if (nbad > 0)
		printf("%dx%d, %d %%, n %d, tile %d %d: %d wrong\n", w, h,
		    share, n, tile[0], tile[1], nbad);
	CHECK(nbad == 0);
	bake_layer_maps_free(&m);
	bake_layer_maps_free(&old);
	bake_layer_maps_free(&many);
}

static void
dilation_takes_the_nearest(void)
{
	static const int sizes[][2] = { { 16, 12 }, { 13, 1 }, { 1, 9 },
		{ 1, 1 }, { 31, 7 } };

	for (int k = 0; k < 5; k++)
		for (int n = 0; n <= 12; n += n < 3 ? 1 : 3)
			for (int t = 0; t < 4; t++) {
				const bool tile[2] = { t & 1, t >> 1 };
				const int share =
				    (int[3]){ 3, 15, 60 }[(k + n + t) % 3];

				check_dilation(sizes[k][0], sizes[k][1], share,
				    n, tile, formats[(n + t) % 4]);
			}
	/* larger than the texture, several times round */
	check_dilation(
	    5, 4, 10, 40, (const bool[2]){ true, true }, BAKE_DATA_UINT8);
	check_dilation(
	    5, 4, 0, 40, (const bool[2]){ true, false }, BAKE_DATA_UINT8);
}

static void
dilation_commutes_with_moving_a_tile(void)
{
	enum { W = 20, H = 14, DX = 7, DY = 5 };
	struct bake_layer_maps a = named_maps(W, H, 12, BAKE_DATA_UINT8);
	struct bake_layer_maps b =
	    layer_maps(W, H, 4, BAKE_DATA_UINT8, 0, 3, BAKE_DATA_UINT8);
	struct bake_pixels *from[3] = { a.depth, a.nx, a.ny };
	struct bake_pixels *to[3] = { b.depth, b.nx, b.ny };
	struct bake_err err = BAKE_ERR_INIT;
	float v[4], u[4];

	for (int k = 0; k < 3; k++)
		for (int i = 0; i < W * H; i++) {
			bake_pixels_get(from[k], i % W, i / W, 1, v);
			bake_pixels_put(
			    to[k], (i % W + DX) % W, (i / W + DY) % H, 1, v);
		}
	CHECK_OK(bake_layer_dilate(&a, 6, true, true, 2, &err), err);
	CHECK_OK(bake_layer_dilate(&b, 6, true, true, 2, &err), err);
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < W * H; i++) {
			bake_pixels_get(from[k], i % W, i / W, 1, v);
			bake_pixels_get(
			    to[k], (i % W + DX) % W, (i / W + DY) % H, 1, u);
			CHECK(memcmp(u, v, sizeof u) == 0);
		}
	bake_layer_maps_free(&a);
	bake_layer_maps_free(&b);
}

static void
bad_reaches_are_errors(void)
{
	struct bake_layer_maps m = named_maps(4, 4, 50, BAKE_DATA_HALF);
	struct bake_layer_maps old = named_maps(4, 4, 50, BAKE_DATA_HALF);
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_layer_dilate(&m, -1, true, true, 1, &err) == BAKE_EINVAL);
	CHECK(strstr(err.msg, "-1") != NULL);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_layer_dilate(&m, 4097, true, true, 1, &err) == BAKE_EINVAL);
	CHECK(same_maps(&m, &old));
	bake_layer_maps_free(&m);
	bake_layer_maps_free(&old);
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(new_maps_are_empty),
		CASE(layers_are_counted_up_to_the_first_that_is_none),
		CASE(bad_sizes_are_errors),
		CASE(dilation_takes_the_nearest),
		CASE(dilation_commutes_with_moving_a_tile),
		CASE(bad_reaches_are_errors),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
