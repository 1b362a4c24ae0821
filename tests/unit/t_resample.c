/* Resampling: identity, constants, means, an oracle, shifts, tiling. */
/* SPDX-License-Identifier: MIT */
#include "resample.h"

#include "check.h"
#include "test_maps.h"

static const enum bake_filter filters[] = { BAKE_FILTER_CATMULL_ROM,
	BAKE_FILTER_BOX, BAKE_FILTER_TRIANGLE, BAKE_FILTER_MITCHELL,
	BAKE_FILTER_BSPLINE };
enum { NFILTERS = 5 };

static struct bake_image
mapped(const struct bake_image *src, int w, int h,
    const struct bake_resample_params *params)
{
	struct bake_image dst = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_resample_mapped(src, w, h, params, &dst, &err), err);
	if (dst.data == NULL)
		abort();
	return dst;
}

static struct bake_image
resampled(const struct bake_image *src, struct bake_wrap wrap,
    enum bake_filter filter, int w, int h)
{
	struct bake_resample_params params = BAKE_RESAMPLE_PARAMS_DEFAULT;

	params.wrap = wrap;
	params.filter = filter;
	params.keep_overshoot = true;
	params.nthreads = 1;
	return mapped(src, w, h, &params);
}

static void
equal_size_keeps_every_bit(void)
{
	struct bake_image src = noise(9, 7, 3);
	struct bake_err err = BAKE_ERR_INIT;

	src.data[5] = -0.0f;
	src.data[7] = 1e-42f; /* denormal */
	src.data[8] = 1.0f / 3;
	for (int f = 0; f < 3; f++)
		for (int c = 0; c < 2; c++) {
			struct bake_image dst = BAKE_IMAGE_INIT;

			CHECK_OK(bake_resample(&src, c ? clamped : torus,
				     filters[f], 9, 7, 2, &dst, &err),
			    err);
			CHECK(memcmp(src.data, dst.data, 9 * 7 * 3 * 4) == 0);
			bake_image_free(&dst);
		}
	bake_image_free(&src);
}

static void
constants_keep_their_bits(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 3, 200 }, { 64, 5 },
		{ 77, 78 }, { 13, 1 } };
	static const float values[] = { 0.1f, 1.0f / 3, 0.7f, 1e-40f, -3e5f };
	struct bake_image src = image(13, 77, 1);

	for (int i = 0; i < 5 * NFILTERS * 2; i++) {
		const float v = values[i % 5];
		struct bake_image dst;

		for (size_t k = 0; k < nfloats(&src); k++)
			src.data[k] = v;
		for (int s = 0; s < 5; s++) {
			dst = resampled(&src, i % 2 ? clamped : torus,
			    filters[i / 10], sizes[s][0], sizes[s][1]);
			for (size_t k = 0; k < nfloats(&dst); k++)
				CHECK(dst.data[k] == v);
			bake_image_free(&dst);
		}
	}
	bake_image_free(&src);
}

static double
mean(const struct bake_image *img)
{
	double sum = 0;

	for (size_t i = 0; i < nfloats(img); i++)
		sum += img->data[i];
	return sum / (double)nfloats(img);
}

static void
whole_factors_keep_the_mean(void)
{
	struct bake_image src = noise(24, 36, 1), dst;

	for (int f = 0; f < NFILTERS; f++)
		for (int k = 1; k <= 4; k++) {
			dst =
			    resampled(&src, torus, filters[f], 24 / k, 36 / k);
			/* each result is a float rounded twice */
			CHECK_NEAR(mean(&dst), mean(&src), 1.2e-7);
			bake_image_free(&dst);
		}
	dst = resampled(&src, torus, BAKE_FILTER_BOX, 17, 7);
	CHECK_NEAR(mean(&dst), mean(&src), 1.2e-7);
	bake_image_free(&dst);
	bake_image_free(&src);
}

/* Written from the definitions, apart from the code: B and C in full. */
static double
oracle_kernel(enum bake_filter f, double t)
{
	double b = 0, c = 0.5;

	t = fabs(t);
	if (f == BAKE_FILTER_TRIANGLE)
		return fmax(0, 1 - t);
	if (f == BAKE_FILTER_MITCHELL)
		b = c = 1.0 / 3;
	if (f == BAKE_FILTER_BSPLINE)
		b = 1, c = 0;
	if (t < 1)
		return ((12 - 9 * b - 6 * c) * pow(t, 3) +
			   (-18 + 12 * b + 6 * c) * pow(t, 2) + 6 - 2 * b) /
		       6;
	if (t < 2)
		return ((-b - 6 * c) * pow(t, 3) + (6 * b + 30 * c) * t * t +
			   (-12 * b - 48 * c) * t + 8 * b + 24 * c) /
		       6;
	return 0;
}

static double
oracle_weight(enum bake_filter f, double i, double c, double step)
{
	const double m = fmax(step, 1);

	if (f == BAKE_FILTER_BOX)
		return fmax(0,
		    fmin(i + 0.5, c + step / 2) - fmax(i - 0.5, c - step / 2));
	return oracle_kernel(f, (i - c) / m);
}

/* The double sum over a window that is surely wide enough. */
static double
oracle(const struct bake_image *src, struct bake_wrap wrap, enum bake_filter f,
    const double step[2], const double offset[2], int x, int y, int chan)
{
	const double cx = (x + 0.5) * step[0] + offset[0] - 0.5;
	const double cy = (y + 0.5) * step[1] + offset[1] - 0.5;
	const int rx = (int)(2 * fmax(step[0], 1)) + 2;
	const int ry = (int)(2 * fmax(step[1], 1)) + 2;
	double sum = 0, total = 0;

	for (int j = (int)floor(cy) - ry; j <= (int)cy + ry; j++)
		for (int i = (int)floor(cx) - rx; i <= (int)cx + rx; i++) {
			const double w = oracle_weight(f, i, cx, step[0]) *
					 oracle_weight(f, j, cy, step[1]);
			const int yy =
			    bake_wrap_index(j, src->height, wrap.clamp_v);
			const int xx =
			    bake_wrap_index(i, src->width, wrap.clamp_u);

			sum += w *
			       bake_image_row(src, yy)[xx * src->nchans + chan];
			total += w;
		}
	return sum / total;
}

static void
equals_the_double_sum(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 5, 9 }, { 16, 11 },
		{ 31, 6 }, { 40, 50 } };
	struct bake_image src = noise(16, 11, 2);
	const double none[2] = { 0, 0 };

	for (int i = 0; i < 5 * NFILTERS * 4; i++) {
		const struct bake_wrap wrap = { i % 2, i / 2 % 2 };
		const enum bake_filter f = filters[i / 4 % NFILTERS];
		const int w = sizes[i / 20][0], h = sizes[i / 20][1];
		const double step[2] = { 16.0 / w, 11.0 / h };
		struct bake_image dst = resampled(&src, wrap, f, w, h);

		for (int k = 0; k < w * h * 2; k++)
			/* two roundings of values up to 1.3 */
			CHECK_NEAR(dst.data[k],
			    oracle(&src, wrap, f, step, none, k / 2 % w,
				k / 2 / w, k % 2),
			    1.5e-7);
		bake_image_free(&dst);
	}
	bake_image_free(&src);
}

/* Tile factors and offsets, also far outside the source. */
static void
mapping_equals_the_double_sum(void)
{
	static const double maps[][4] = { { 2.75, 3, 0.25, -7.5 },
		{ 0.3, 0.7, 1000.5, -333 }, { 40, 25, 0, 5 } };
	struct bake_image src = noise(8, 5, 1);

	for (int i = 0; i < 3 * NFILTERS * 2; i++) {
		const double *m = maps[i % 3];
		struct bake_resample_params p = BAKE_RESAMPLE_PARAMS_DEFAULT;
		struct bake_image dst;

		p.wrap = i / 3 % 2 ? clamped : torus;
		p.filter = filters[i / 6];
		p.step_u = m[0];
		p.step_v = m[1];
		p.offset_u = m[2];
		p.offset_v = m[3];
		p.keep_overshoot = true;
		dst = mapped(&src, 9, 7, &p);
		for (int k = 0; k < 63; k++)
			CHECK_NEAR(dst.data[k],
			    oracle(&src, p.wrap, p.filter, m, m + 2, k % 9,
				k / 9, 0),
			    1.5e-7);
		bake_image_free(&dst);
	}
	bake_image_free(&src);
}

/* A shift of the torus by whole factors shifts the result, bit for bit. */
static void
shift_moves_the_result(void)
{
	enum { W = 24, H = 16, DX = 3, DY = 5 };
	struct bake_image src = noise(W, H, 1), moved = image(W, H, 1), a, b;

	for (int f = 0; f < NFILTERS; f++)
		for (int k = 1; k <= 2; k++) {
			const int w = W / k, h = H / k;

			for (int i = 0; i < W * H; i++)
				moved.data[(i / W + DY * k) % H * W +
					   (i % W + DX * k) % W] = src.data[i];
			a = resampled(&src, torus, filters[f], w, h);
			b = resampled(&moved, torus, filters[f], w, h);
			for (int i = 0; i < w * h; i++)
				CHECK(b.data[(i / w + DY) % h * w +
					     (i % w + DX) % w] == a.data[i]);
			bake_image_free(&a);
			bake_image_free(&b);
		}
	bake_image_free(&src);
	bake_image_free(&moved);
}

/* Interpolating: every second texel of a doubled... at odd factors exact. */
static void
magnified_keeps_the_texels_it_hits(void)
{
	struct bake_image src = noise(6, 5, 1), dst;

	for (int f = 0; f < 3; f++) {
		dst = resampled(&src, torus, filters[f], 18, 15);
		for (int i = 0; i < 30; i++)
			/* 1/3 is no double: the centre is hit to 1e-15 */
			CHECK_NEAR(
			    dst.data[(i / 6 * 3 + 1) * 18 + i % 6 * 3 + 1],
			    src.data[i], 6e-8);
		bake_image_free(&dst);
	}
	bake_image_free(&src);
}

/* Cubics of degree 2 and lines of degree 1 come back inside the border. */
static void
catmull_rom_reproduces_parabolas(void)
{
	struct bake_image src = image(32, 1, 1), dst;

	for (int x = 0; x < 32; x++)
		src.data[x] = (float)(x * x) / 1024.0f;
	dst = resampled(&src, clamped, BAKE_FILTER_CATMULL_ROM, 80, 1);
	for (int x = 10; x < 70; x++) {
		const double c = (x + 0.5) * 0.4 - 0.5;

		CHECK_NEAR(dst.data[x], c * c / 1024, 6e-8);
	}
	bake_image_free(&src);
	bake_image_free(&dst);
}

static void
range_is_kept_unless_asked(void)
{
	struct bake_image src = image(16, 1, 2), dst = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	float hi = 0;

	for (int x = 0; x < 16; x++) {
		src.data[2 * x] = x < 8 ? 0 : 1;
		src.data[2 * x + 1] = x < 8 ? -5 : -4;
	}
	CHECK_OK(bake_resample(&src, torus, BAKE_FILTER_CATMULL_ROM, 50, 3, 1,
		     &dst, &err),
	    err);
	for (size_t i = 0; i < nfloats(&dst); i += 2) {
		CHECK(dst.data[i] >= 0 && dst.data[i] <= 1);
		CHECK(dst.data[i + 1] >= -5 && dst.data[i + 1] <= -4);
	}
	bake_image_free(&dst);
	dst = resampled(&src, torus, BAKE_FILTER_CATMULL_ROM, 50, 3);
	for (size_t i = 0; i < nfloats(&dst); i += 2)
		hi = fmaxf(hi, dst.data[i]);
	CHECK(hi > 1.01f);
	bake_image_free(&src);
	bake_image_free(&dst);
}

/* Nothing aliases: the finest stripes become grey when minified. */
static void
minified_stripes_turn_grey(void)
{
	struct bake_image src = image(512, 1, 1), dst;

	for (int x = 0; x < 512; x++)
		src.data[x] = (float)(x % 2);
	for (int f = 0; f < NFILTERS; f++) {
		dst = resampled(&src, torus, filters[f], 64, 1);
		for (int x = 0; x < 64; x++)
			CHECK_NEAR(dst.data[x], 0.5, 0.01);
		bake_image_free(&dst);
	}
	bake_image_free(&src);
}

static void
threads_do_not_show(void)
{
	struct bake_image src = noise(33, 41, 4);

	for (int f = 0; f < NFILTERS; f++) {
		struct bake_resample_params p = BAKE_RESAMPLE_PARAMS_DEFAULT;
		struct bake_image a, b;

		p.filter = filters[f];
		p.nthreads = 1;
		a = mapped(&src, 50, 20, &p);
		for (p.nthreads = 2; p.nthreads <= 7; p.nthreads += 5) {
			b = mapped(&src, 50, 20, &p);
			CHECK(memcmp(a.data, b.data, nfloats(&a) * 4) == 0);
			bake_image_free(&b);
		}
		bake_image_free(&a);
	}
	bake_image_free(&src);
}

static void
bad_arguments_are_told(void)
{
	struct bake_resample_params p = BAKE_RESAMPLE_PARAMS_DEFAULT;
	struct bake_image src = noise(4, 4, 1), dst = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_resample_mapped(&src, 0, 4, &p, &dst, &err) == BAKE_EINVAL);
	CHECK(strstr(err.msg, "4x4 texels to 0x4") != NULL);
	err.code = BAKE_OK;
	p.filter = (enum bake_filter)9;
	CHECK(bake_resample_mapped(&src, 4, 4, &p, &dst, &err) == BAKE_EINVAL);
	err.code = BAKE_OK;
	p.filter = BAKE_FILTER_BOX;
	p.step_v = -1;
	CHECK(bake_resample_mapped(&src, 4, 4, &p, &dst, &err) == BAKE_EINVAL);
	err.code = BAKE_OK;
	p.step_v = 0;
	p.offset_u = NAN;
	CHECK(bake_resample_mapped(&src, 4, 4, &p, &dst, &err) == BAKE_EINVAL);
	CHECK(dst.data == NULL);
	bake_image_free(&src);
}

static struct bake_image
transposed(const struct bake_image *src)
{
	const int nc = src->nchans;
	struct bake_image t = image(src->height, src->width, nc);

	for (int y = 0; y < src->height; y++)
		for (int x = 0; x < src->width; x++)
			memcpy(bake_image_row(&t, x) + y * nc,
			    bake_image_row(src, y) + x * nc,
			    (size_t)nc * sizeof(float));
	return t;
}

/* One axis copied, moved by whole texels, the other resampled: columns and rows
 * take different ways to the same bits; 4 channels have a way of their own. */
static void
columns_and_rows_are_alike(void)
{
	for (int i = 0; i < 16; i++) {
		struct bake_image src = noise(9, 7, i & 4 ? 4 : 3);
		struct bake_image turned = transposed(&src), a, b, back;
		struct bake_resample_params p = BAKE_RESAMPLE_PARAMS_DEFAULT;

		p.wrap = i & 1 ? clamped : torus;
		p.step_u = 1;
		p.offset_u = i & 2 ? -4 : 11;
		p.step_v = i & 8 ? 0.37 : 2.3;
		p.offset_v = 0.2;
		a = mapped(&src, 13, 10, &p);
		p.step_u = p.step_v;
		p.step_v = 1;
		p.offset_v = p.offset_u;
		p.offset_u = 0.2;
		b = mapped(&turned, 10, 13, &p);
		back = transposed(&b);
		CHECK(memcmp(a.data, back.data, nfloats(&a) * 4) == 0);
		bake_image_free(&src);
		bake_image_free(&turned);
		bake_image_free(&a);
		bake_image_free(&b);
		bake_image_free(&back);
	}
}

static void
copies_are_told(void)
{
	struct bake_image src = noise(5, 4, 2);
	struct bake_resample_params p = BAKE_RESAMPLE_PARAMS_DEFAULT;
	struct bake_err err = BAKE_ERR_INIT;
	static const struct {
		double step_u, offset_u;
		enum bake_filter filter;
		bool copies;
	} cases[] = { { 1, 0, BAKE_FILTER_CATMULL_ROM, true },
		{ 1, -7, BAKE_FILTER_TRIANGLE, true },
		{ 1, 0.5, BAKE_FILTER_CATMULL_ROM, false },
		{ 1, 0, BAKE_FILTER_BSPLINE, false },
		{ 0.5, 0, BAKE_FILTER_BOX, true },
		{ 0.5, 0, BAKE_FILTER_CATMULL_ROM, false } };

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct bake_resampler *r = NULL;

		p.step_u = cases[i].step_u;
		p.step_v = 1;
		p.offset_u = cases[i].offset_u;
		p.filter = cases[i].filter;
		CHECK_OK(bake_resampler_open(&r, &src, 10, 4, &p, &err), err);
		CHECK(bake_resampler_copies(r) == cases[i].copies);
		bake_resampler_close(r);
	}
	bake_resampler_close(NULL);
	bake_image_free(&src);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(equal_size_keeps_every_bit),
		CASE(constants_keep_their_bits),
		CASE(whole_factors_keep_the_mean),
		CASE(equals_the_double_sum),
		CASE(mapping_equals_the_double_sum),
		CASE(shift_moves_the_result),
		CASE(magnified_keeps_the_texels_it_hits),
		CASE(catmull_rom_reproduces_parabolas),
		CASE(range_is_kept_unless_asked),
		CASE(minified_stripes_turn_grey),
		CASE(threads_do_not_show),
		CASE(columns_and_rows_are_alike),
		CASE(copies_are_told),
		CASE(bad_arguments_are_told),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
