/* Errors, checked memory and images: what every other module stands on. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <stdint.h>

#include "check.h"
#include "image.h"
#include "mem.h"
#include "test_maps.h"

static void
first_failure_wins(void)
{
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(err.code == BAKE_OK && err.msg[0] == '\0');
	CHECK(bake_fail(&err, BAKE_EDATA, "'%s' is %dx%d", "a.exr", 3, 4) ==
	      BAKE_EDATA);
	CHECK(err.code == BAKE_EDATA);
	CHECK(strcmp(err.msg, "'a.exr' is 3x4") == 0);
	/* the later one gives its own code and leaves the reason alone */
	CHECK(bake_fail(&err, BAKE_ENOMEM, "later") == BAKE_ENOMEM);
	CHECK(err.code == BAKE_EDATA);
	CHECK(strcmp(err.msg, "'a.exr' is 3x4") == 0);
}

static void
long_message_is_cut(void)
{
	struct {
		struct bake_err err;
		char guard[16];
	} s = { BAKE_ERR_INIT, "untouched" };
	char text[3 * BAKE_ERR_MSG];

	for (size_t i = 0; i < sizeof text; i++)
		text[i] = (char)('a' + i % 26);
	text[sizeof text - 1] = '\0';
	CHECK(bake_fail(&s.err, BAKE_EIO, "%s", text) == BAKE_EIO);
	CHECK(strlen(s.err.msg) == BAKE_ERR_MSG - 1);
	CHECK(memcmp(s.err.msg, text, BAKE_ERR_MSG - 1) == 0);
	CHECK(strcmp(s.guard, "untouched") == 0);
}

static void
product_of_sizes_is_checked(void)
{
	static const size_t at[] = { 0, 1, 2, 3, 0xffff, 0xffffffff,
		(size_t)1 << 32, ((size_t)1 << 32) + 1, SIZE_MAX / 3,
		SIZE_MAX / 2, SIZE_MAX / 2 + 1, SIZE_MAX - 1, SIZE_MAX };
	const size_t n = sizeof at / sizeof *at;

	for (size_t i = 0; i < n * n; i++) {
		size_t a = at[i / n], b = at[i % n], p = 12345;
		unsigned __int128 exact = (unsigned __int128)a * b;

		if (exact <= SIZE_MAX) {
			CHECK(bake_mul_size(a, b, &p));
			CHECK(p == (size_t)exact);
		} else {
			CHECK(!bake_mul_size(a, b, &p));
			CHECK(p == 12345);
		}
	}
}

static void
arrays_are_aligned_and_whole(void)
{
	struct bake_err err = BAKE_ERR_INIT;

	for (size_t n = 0; n < 300; n++) {
		unsigned char *p = bake_alloc(n, 1, &err);
		unsigned char *z = bake_zalloc(n, 3, &err);

		CHECK(p != NULL && z != NULL);
		CHECK((uintptr_t)p % BAKE_ALIGN == 0);
		CHECK((uintptr_t)z % BAKE_ALIGN == 0);
		if (n > 0)
			memset(p, 0xee, n); /* a sanitizer sees a short one */
		for (size_t i = 0; i < 3 * n; i++)
			CHECK(z[i] == 0);
		free(p);
		free(z);
	}
	CHECK(err.code == BAKE_OK);
}

static void
arrays_that_cannot_be(void)
{
	static const size_t sizes[][2] = { { SIZE_MAX, 2 }, { 2, SIZE_MAX },
		{ SIZE_MAX, SIZE_MAX }, { (size_t)1 << 33, (size_t)1 << 33 },
		{ SIZE_MAX, 1 }, { 1, (size_t)PTRDIFF_MAX + 1 },
		{ PTRDIFF_MAX, 1 }, { SIZE_MAX / 4 + 1, 4 } };

	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		struct bake_err err = BAKE_ERR_INIT;

		CHECK(bake_alloc(sizes[i][0], sizes[i][1], &err) == NULL);
		CHECK(err.code == BAKE_ENOMEM && err.msg[0] != '\0');
		err = (struct bake_err)BAKE_ERR_INIT;
		CHECK(bake_zalloc(sizes[i][0], sizes[i][1], &err) == NULL);
		CHECK(err.code == BAKE_ENOMEM && err.msg[0] != '\0');
	}
}

static void
image_has_room_for_its_texels(void)
{
	struct bake_image img;
	struct bake_err err = BAKE_ERR_INIT;

	for (int nc = 1; nc <= 5; nc++) {
		CHECK_OK(bake_image_alloc(&img, 7, 3, nc, &err), err);
		CHECK(img.width == 7 && img.height == 3 && img.nchans == nc);
		CHECK(img.row_stride >= 7u * (size_t)nc);
		for (int y = 0; y < 3; y++)
			for (int i = 0; i < 7 * nc; i++)
				bake_image_row(&img, y)[i] =
				    (float)(y * 99 + i);
		for (int y = 0; y < 3; y++)
			for (int i = 0; i < 7 * nc; i++)
				CHECK(
				    img.data[(size_t)y * img.row_stride +
					     (size_t)i] == (float)(y * 99 + i));
		bake_image_free(&img);
		CHECK(img.data == NULL && img.width == 0 && img.height == 0 &&
		      img.nchans == 0 && img.row_stride == 0);
		bake_image_free(&img); /* harmless */
	}
}

static void
image_that_cannot_be(void)
{
	static const struct {
		int w, h, nc;
		enum bake_status status;
	} cases[] = { { 0, 1, 1, BAKE_EINVAL }, { 1, 0, 1, BAKE_EINVAL },
		{ 1, 1, 0, BAKE_EINVAL }, { -1, 1, 1, BAKE_EINVAL },
		{ 1, INT_MIN, 1, BAKE_EINVAL }, { -3, -3, 1, BAKE_EINVAL },
		{ INT_MAX, INT_MAX, INT_MAX, BAKE_ENOMEM },
		{ INT_MAX, INT_MAX, 4, BAKE_ENOMEM },
		{ INT_MAX, INT_MAX, 1, BAKE_ENOMEM } };

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct bake_err err = BAKE_ERR_INIT;
		/* overwritten, not freed */
		struct bake_image img = { 1, 2, 3, 4, (float *)&err };

		CHECK(bake_image_alloc(&img, cases[i].w, cases[i].h,
			  cases[i].nc, &err) == cases[i].status);
		CHECK(err.code == cases[i].status && err.msg[0] != '\0');
		CHECK(img.data == NULL && img.width == 0 && img.height == 0 &&
		      img.nchans == 0 && img.row_stride == 0);
	}
}

static void
swap_exchanges_all(void)
{
	struct bake_image a = image(3, 2, 1), b = BAKE_IMAGE_INIT;
	float *data = a.data;

	bake_image_swap(&a, &b);
	CHECK(a.data == NULL && a.width == 0 && a.row_stride == 0);
	CHECK(b.data == data && b.width == 3 && b.height == 2 &&
	      b.nchans == 1 && b.row_stride == 3);
	bake_image_free(&b);
}

/* Views with a stride of their own, so that a row's end is not the next one's
 * beginning. */
static void
copy_channel_touches_that_channel_only(void)
{
	float from[3 * 20], to[3 * 30];
	struct bake_image src = { 5, 3, 3, 20, from };
	struct bake_image dst = { 5, 3, 4, 30, to };

	for (int sc = 0; sc < 3; sc++) {
		for (int dc = 0; dc < 4; dc++) {
			for (int i = 0; i < 60; i++)
				from[i] = (float)i;
			for (int i = 0; i < 90; i++)
				to[i] = (float)-i - 1;
			bake_image_copy_channel(&dst, dc, &src, sc);
			for (int i = 0; i < 90; i++) {
				int y = i / 30, x = i % 30 / 4, c = i % 30 % 4;
				float want = x < 5 && c == dc
						 ? (float)(y * 20 + x * 3 + sc)
						 : (float)-i - 1;

				CHECK(to[i] == want);
			}
		}
	}
}

/* walks to the index one step at a time */
static int
wrapped_slowly(long i, int n, bool clamp)
{
	int at = 0;

	for (; i > 0; i--)
		at = at + 1 < n ? at + 1 : clamp ? n - 1 : 0;
	for (; i < 0; i++)
		at = at > 0 ? at - 1 : clamp ? 0 : n - 1;
	return at;
}

static void
wrap_index_walks_the_torus(void)
{
	for (int n = 1; n <= 9; n++)
		for (long i = -40; i <= 40; i++) {
			CHECK(bake_wrap_index(i, n, false) ==
			      wrapped_slowly(i, n, false));
			CHECK(bake_wrap_index(i, n, true) ==
			      wrapped_slowly(i, n, true));
		}
	/* LONG_MAX = 2^63 - 1 = 7 mod 10, LONG_MIN = -8 mod 10 */
	CHECK(bake_wrap_index(LONG_MAX, 10, false) == 7);
	CHECK(bake_wrap_index(LONG_MIN, 10, false) == 2);
	CHECK(bake_wrap_index(LONG_MAX, INT_MAX, true) == INT_MAX - 1);
	CHECK(bake_wrap_index(LONG_MIN, INT_MAX, true) == 0);
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(first_failure_wins),
		CASE(long_message_is_cut),
		CASE(product_of_sizes_is_checked),
		CASE(arrays_are_aligned_and_whole),
		CASE(arrays_that_cannot_be),
		CASE(image_has_room_for_its_texels),
		CASE(image_that_cannot_be),
		CASE(swap_exchanges_all),
		CASE(copy_channel_touches_that_channel_only),
		CASE(wrap_index_walks_the_torus),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
