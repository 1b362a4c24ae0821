/* Filtered texture lookups: constants, ramps, wraps, means, transforms. */
/* SPDX-License-Identifier: MIT */
#include "texture_sample.h"

#include <stdbool.h>

#include "check.h"
#include "test_maps.h"

static const enum bake_tex_wrap wraps[] = { BAKE_TEX_REPEAT, BAKE_TEX_CLAMP,
	BAKE_TEX_MIRROR };

/* By chance, 0 <= x < 1. */
static double
random_unit(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return hash(*state) / 4294967296.0;
}

static struct bake_sampler *
opened(const struct bake_image *img, bool opaque)
{
	struct bake_sampler *s = NULL;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_sampler_open(&s, img, opaque, 2, &err), err);
	if (s == NULL)
		abort();
	return s;
}

/* A lookup at texel coordinates (x, y), pixel centres at whole numbers, with
 * the steps (ax, ay) and (bx, by) in texels, y downwards. */
static struct bake_lookup
place(const struct bake_image *img, double x, double y, double ax, double ay,
    double bx, double by, enum bake_tex_wrap wrap)
{
	const double w = img->width, h = img->height;

	return (struct bake_lookup){ (x + 0.5) / w, 1 - (y + 0.5) / h, ax / w,
		-ay / h, bx / w, -by / h, wrap, wrap };
}

static int
index_of(int i, int n, enum bake_tex_wrap wrap)
{
	if (wrap == BAKE_TEX_CLAMP)
		return i < 0 ? 0 : i >= n ? n - 1 : i;
	while (i < 0)
		i += 2 * n;
	if (wrap == BAKE_TEX_REPEAT)
		return i % n;
	i %= 2 * n;
	return i < n ? i : 2 * n - 1 - i;
}

static double
texel(
    const struct bake_image *img, int i, int j, int c, enum bake_tex_wrap wrap)
{
	i = index_of(i, img->width, wrap);
	j = index_of(j, img->height, wrap);
	return img->data[(size_t)j * img->row_stride +
			 (size_t)i * (size_t)img->nchans + (size_t)c];
}

static double
bilinear(const struct bake_image *img, double x, double y, int c,
    enum bake_tex_wrap wrap)
{
	const int i = (int)floor(x), j = (int)floor(y);
	const double a = x - i, b = y - j;

	return (1 - b) * ((1 - a) * texel(img, i, j, c, wrap) +
			     a * texel(img, i + 1, j, c, wrap)) +
	       b * ((1 - a) * texel(img, i, j + 1, c, wrap) +
		       a * texel(img, i + 1, j + 1, c, wrap));
}

static void
constant_keeps_its_bits(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 5, 3 }, { 64, 64 },
		{ 17, 1 }, { 2, 31 }, { 3, 200 } };
	const float values[4] = { 0.1f, 1.0f / 3, 0.7f, 0.3f };
	uint32_t seed = 1;

	for (int k = 0; k < 6; k++)
		for (int n = 1; n <= 4; n++) {
			struct bake_image img =
			    image(sizes[k][0], sizes[k][1], n);
			struct bake_sampler *s;
			int wrong = 0;

			for (int i = 0; i < img.width * img.height; i++)
				for (int c = 0; c < n; c++)
					img.data[i * n + c] = values[c];
			s = opened(&img, false);
			CHECK(bake_sampler_nchans(s) == n);
			for (int i = 0; i < 3000; i++) {
				const double scale =
				    exp((random_unit(&seed) - 0.3) * 12);
				struct bake_lookup at =
				    place(&img, 50 * random_unit(&seed) - 25,
					50 * random_unit(&seed) - 25,
					scale * (random_unit(&seed) - 0.5),
					scale * (random_unit(&seed) - 0.5),
					random_unit(&seed), random_unit(&seed),
					wraps[i % 3]);
				float got[4];

				bake_sampler_read(s, &at, got);
				wrong += memcmp(got, values,
					     (size_t)n * sizeof *got) != 0;
			}
			CHECK(wrong == 0);
			bake_sampler_close(s);
			bake_image_free(&img);
		}
}

/* A ramp between texel centres, with v growing upwards. */
static void
magnified_ramp_is_reproduced(void)
{
	struct bake_image img = image(9, 6, 1);
	struct bake_sampler *s;
	uint32_t seed = 3;

	for (int j = 0; j < 6; j++)
		for (int i = 0; i < 9; i++)
			img.data[j * 9 + i] = (float)(2 + i * 0.25 - j * 0.5);
	s = opened(&img, false);
	for (int k = 0; k < 500; k++) {
		/* within the outermost texel centres */
		const double u = (0.5 + 8 * random_unit(&seed)) / 9;
		const double v = (0.5 + 5 * random_unit(&seed)) / 6;
		const struct bake_lookup at = { u, v, 0.4 / 9, 0.5 / 6,
			-0.4 / 9, 0.5 / 6, BAKE_TEX_REPEAT, BAKE_TEX_CLAMP };
		float got;

		bake_sampler_read(s, &at, &got);
		/* one rounding to float of a value below 4 */
		CHECK_NEAR(got,
		    2 + (u * 9 - 0.5) * 0.25 - ((1 - v) * 6 - 0.5) * 0.5,
		    1.3e-7 * 2);
	}
	bake_sampler_close(s);
	bake_image_free(&img);
}

static void
magnified_is_bilinear_at_all_borders(void)
{
	struct bake_image img = noise(5, 4, 3);
	struct bake_sampler *s = opened(&img, false);
	uint32_t seed = 7;

	for (int k = 0; k < 3000; k++) {
		const double x = 30 * random_unit(&seed) - 15;
		const double y = 30 * random_unit(&seed) - 15;
		const struct bake_lookup at =
		    place(&img, x, y, 0.7, 0, 0, 0.9, wraps[k % 3]);
		float got[3];

		bake_sampler_read(s, &at, got);
		for (int c = 0; c < 3; c++)
			/* a float's half unit below 1, and the position's own
			 * rounding: 15 texels * 2^-52 * slope 2 */
			CHECK_NEAR(got[c],
			    bilinear(&img, x, y, c, wraps[k % 3]), 6.1e-8);
	}
	bake_sampler_close(s);
	bake_image_free(&img);
}

/* Symmetries that hold for any footprint. Within a float's rounding: sums are
 * in another order. */
static void
wraps_have_their_symmetries(void)
{
	struct bake_image img = noise(12, 10, 1);
	struct bake_sampler *s = opened(&img, false);
	uint32_t seed = 11;

	for (int k = 0; k < 2000; k++) {
		const double scale = k % 2 ? 3.0 / 12 : 0.5 / 12;
		struct bake_lookup at = { random_unit(&seed),
			random_unit(&seed), scale * random_unit(&seed),
			scale * random_unit(&seed), scale * random_unit(&seed),
			-scale * random_unit(&seed), BAKE_TEX_REPEAT,
			BAKE_TEX_REPEAT };
		struct bake_lookup other = at;
		float a, b;

		other.u += 3;
		other.v -= 2;
		bake_sampler_read(s, &at, &a);
		bake_sampler_read(s, &other, &b);
		CHECK_NEAR(b, a, 2e-7);
		at.wrap_u = at.wrap_v = BAKE_TEX_MIRROR;
		other = at;
		other.u = 2 - at.u;
		other.u_x = -at.u_x;
		other.u_y = -at.u_y;
		bake_sampler_read(s, &at, &a);
		bake_sampler_read(s, &other, &b);
		CHECK_NEAR(b, a, 2e-7);
		/* far outside, all is the corner */
		at.wrap_u = at.wrap_v = BAKE_TEX_CLAMP;
		at.u = -4 - at.u;
		at.v = 5 + at.v;
		bake_sampler_read(s, &at, &a);
		if (k % 2 == 0)
			CHECK(a == img.data[0]);
	}
	bake_sampler_close(s);
	bake_image_free(&img);
}

static void
large_footprint_gives_the_mean(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 13, 7 }, { 64, 32 },
		{ 5, 100 }, { 127, 1 } };

	for (int k = 0; k < 5; k++) {
		struct bake_image img = noise(sizes[k][0], sizes[k][1], 3);
		struct bake_sampler *s = opened(&img, false);
		const size_t n = (size_t)img.width * (size_t)img.height;
		double mean[3] = { 0 };

		for (size_t i = 0; i < n; i++)
			for (int c = 0; c < 3; c++)
				mean[c] += (double)img.data[i * 3 + (size_t)c] /
					   (double)n;
		for (int i = 0; i < 20; i++) {
			const double big = i == 19   ? INFINITY
					   : i == 18 ? NAN
						     : 1.6 * pow(10, i);
			const struct bake_lookup at = { 0.1 * i, 0.3, big * 100,
				0, 0, -big * 100, wraps[i % 2 * 2],
				BAKE_TEX_REPEAT };
			float got[3];

			bake_sampler_read(s, &at, got);
			for (int c = 0; c < 3; c++)
				/* each of up to 7 levels is rounded once */
				CHECK_NEAR(got[c], mean[c], 7 * 6e-8);
		}
		bake_sampler_close(s);
		bake_image_free(&img);
	}
}

/* 48 J_3(x) / x^3: the transform of (1 - r^2)^2 on the unit disc, made 1 at
 * 0. */
static double
kernel_transform(double x)
{
	return x < 1e-3 ? 1 : 48 * jn(3, x) / (x * x * x);
}

static double
sinc(double x)
{
	return x == 0 ? 1 : sin(x) / x;
}

/* A bound of the shorter half axis' square. */
static double
short2(const double j[4])
{
	const double det = j[0] * j[3] - j[1] * j[2];

	return 2 * det * det /
	       (j[0] * j[0] + j[1] * j[1] + j[2] * j[2] + j[3] * j[3]);
}

/*
 * How much of a wave of k radians a texel comes through, found by correlating
 * lookups with it all over a period, against the transform of the kernel and
 * the tent. Both have the same second moments and are means, so that they
 * differ by their fourth moments alone, each at most 3 sigma^4 k^4 / 24 (no
 * part of either has a kurtosis beyond a Gaussian's). Weights at whole texels
 * of a level of size s, made 1 in sum, have a second moment that on the mean
 * over all places is off by up to 0.0024 s^2, the worst for a disc with R^2 >=
 * 4/3, found by trying; s <= r / 1.5 or 1 texel.
 */
static void
minified_wave_has_the_kernels_height(void)
{
	enum { N = 256, STEPS = 1017 };
	static const double footprints[][4] = { { 2, 0, 0, 2 },
		{ 3, 0, 0, 3.2 }, { 5, 1, 0, 3 }, { 6, 0, 0, 2.5 },
		{ 9, 3, -2, 8 }, { 20, 0, 5, 6 }, { 2.2, 0, 0, 0.2 } };

	for (int f = 0; f < 7; f++)
		for (int waves = 1; waves <= 5; waves++) {
			const double *j = footprints[f];
			const double k = 2 * pi * waves / N;
			const double across = hypot(j[0], j[2]) * k;
			const double s2 = fmax(1, short2(j) / 2.25);
			const double var = across * across / 8 + k * k / 6;
			const double want = kernel_transform(across) *
					    sinc(k / 2) * sinc(k / 2);
			struct bake_image img = image(N, 64, 1);
			struct bake_sampler *s;
			double sum = 0;

			for (int i = 0; i < N * 64; i++)
				img.data[i] = (float)cos(k * (i % N));
			s = opened(&img, false);
			for (int i = 0; i < STEPS; i++) {
				const double x = (double)N * i / STEPS;
				const struct bake_lookup at =
				    place(&img, x, x * 0.37, j[0], j[1], j[2],
					j[3], BAKE_TEX_REPEAT);
				float got;

				bake_sampler_read(s, &at, &got);
				sum += got * cos(k * x) * 2 / STEPS;
			}
			/* and the rounding of floats */
			CHECK_NEAR(sum, want,
			    var * var / 4 + 0.0012 * k * k * s2 + 1e-7);
			bake_sampler_close(s);
			bake_image_free(&img);
		}
}

/* The integral of the bilinear texture by the kernel, by 200 x 200 points. */
static double
supersampled(const struct bake_image *img, double x, double y,
    const double j[4], enum bake_tex_wrap wrap)
{
	enum { N = 200 };
	double sum = 0, weight = 0;

	for (int b = 0; b < N; b++)
		for (int a = 0; a < N; a++) {
			const double s = (2 * a + 1.0) / N - 1;
			const double t = (2 * b + 1.0) / N - 1;
			const double q = 1 - s * s - t * t;

			if (q <= 0)
				continue;
			weight += q * q;
			sum += q * q *
			       bilinear(img, x + s * j[0] + t * j[2],
				   y + s * j[1] + t * j[3], 0, wrap);
		}
	return sum / weight;
}

/*
 * Against brute force, place by place. The lookup takes the kernel at whole
 * texels of its level, of size s: its first moment is wrong by at most 0.075 s
 * and its second by 0.16 s^2 (the worst over all offsets of a disc with
 * R^2 >= 4/3, found by trying). So a wave of k is wrong by
 * 0.075 k s + 0.16 (k s)^2 / 2, and by the fourth moments as above.
 */
static void
minified_is_what_supersampling_gives(void)
{
	static const double footprints[][4] = { { 2, 0, 0, 2 }, { 3, 1, -1, 3 },
		{ 7, 0, 0, 3.5 }, { 4, 4, -9, 9 } };
	static const int levels[] = { 0, 1, 1, 1 };
	struct bake_image img = image(64, 64, 1);
	struct bake_sampler *s;
	const double k = 2 * pi / 64;
	uint32_t seed = 5;

	/* waves along both axes and a diagonal, of height 1/3 each */
	for (int i = 0; i < 64 * 64; i++) {
		const int x = i % 64, y = i / 64;

		img.data[i] = (float)((cos(k * x + 1) + cos(k * y) +
					  cos(k * (x + y) + 2)) /
				      3);
	}
	s = opened(&img, false);
	for (int i = 0; i < 40; i++) {
		const double *j = footprints[i % 4];
		const double x = 64 * random_unit(&seed);
		const double y = 64 * random_unit(&seed);
		const enum bake_tex_wrap wrap = BAKE_TEX_REPEAT;
		const struct bake_lookup at =
		    place(&img, x, y, j[0], j[1], j[2], j[3], wrap);
		const double step = k * sqrt(2) * (1 << levels[i % 4]);
		const double long2 =
		    j[0] * j[0] + j[1] * j[1] + j[2] * j[2] + j[3] * j[3];
		const double var = 2 * k * k * (long2 / 8 + 1.0 / 6);
		float got;

		bake_sampler_read(s, &at, &got);
		CHECK_NEAR(got, supersampled(&img, x, y, j, wrap),
		    0.075 * step + 0.08 * step * step + var * var / 4);
	}
	bake_sampler_close(s);
	bake_image_free(&img);
}

/* Stripes one texel wide: a long footprint along them keeps them, one across
 * them gives grey. */
static void
anisotropy_tells_along_from_across(void)
{
	enum { N = 128 };

	for (int turn = 0; turn < 2; turn++) {
		struct bake_image img = image(N, N, 1);
		struct bake_sampler *s;
		double lo = 1, hi = 0;

		/* columns alternate; rows where turned */
		for (int i = 0; i < N * N; i++)
			img.data[i] = (float)((turn ? i / N : i % N) % 2);
		s = opened(&img, false);
		for (int i = 0; i < 64; i++) {
			const double at_x = 40 + 0.25 * i, at_y = 50 + 0.25 * i;
			struct bake_lookup at =
			    place(&img, at_x, at_y, 10 * !turn, 10 * turn,
				0.9 * turn, 0.9 * !turn, BAKE_TEX_REPEAT);
			float got;

			/* across them: the transform at pi is below
			 * 43 / (10 pi)^3.5, as |J_3(x)| sqrt(x) < 0.9 */
			bake_sampler_read(s, &at, &got);
			CHECK_NEAR(got, 0.5, 1e-3);
			at = place(&img, at_x, at_y, 8 * turn, 8 * !turn,
			    0.3 * !turn, 0.3 * turn, BAKE_TEX_REPEAT);
			bake_sampler_read(s, &at, &got);
			lo = got < lo ? got : lo;
			hi = got > hi ? got : hi;
		}
		/* R^2 = 4/3 + 0.09: at a texel's centre its row of texels has
		 * most of the weight */
		CHECK(lo < 0.2 && hi > 0.8);
		CHECK_NEAR(lo + hi, 1, 1e-6);
		bake_sampler_close(s);
		bake_image_free(&img);
	}
}

/* No jump where bilinear begins to give way, nor where it has done so. */
static void
scales_meet_without_a_jump(void)
{
	struct bake_image img = noise(32, 32, 1);
	struct bake_sampler *s = opened(&img, false);
	uint32_t seed = 9;

	for (int i = 0; i < 200; i++) {
		const double x = 32 * random_unit(&seed);
		const double y = 32 * random_unit(&seed);

		for (int edge = 1; edge <= 2; edge++) {
			float got[2];

			for (int k = 0; k < 2; k++) {
				const double r = edge + (k ? 1e-7 : -1e-7);
				const struct bake_lookup at = place(&img, x, y,
				    r, 0, 0, r / 2, BAKE_TEX_REPEAT);

				bake_sampler_read(s, &at, &got[k]);
			}
			/* the mixing weight moves by 2e-7 at most, and the
			 * kernel's own slope is of order 1 */
			CHECK_NEAR(got[1], got[0], 2e-6);
		}
	}
	bake_sampler_close(s);
	bake_image_free(&img);
}

static void
transparent_texels_have_no_say_in_the_colour(void)
{
	struct bake_image img = image(16, 16, 4);
	struct bake_sampler *s;
	float got[4];

	/* left half red and opaque, right half green and transparent */
	for (int i = 0; i < 256; i++) {
		const bool left = i % 16 < 8;
		const float rgba[4] = { left, !left, 0.25f, left };

		memcpy(img.data + i * 4, rgba, sizeof rgba);
	}
	s = opened(&img, false);
	for (int k = 0; k < 40; k++) {
		struct bake_lookup at = place(&img, 0.31 * k, 5, 0.2 + 0.5 * k,
		    0, 0, 0.3 * k, BAKE_TEX_CLAMP);

		bake_sampler_read(s, &at, got);
		CHECK(got[3] >= 0 && got[3] <= 1);
		if (got[3] > 0) {
			CHECK(got[0] == 1 && got[1] == 0);
		} else {
			CHECK(got[0] == 0 && got[1] == 1);
		}
		CHECK(got[2] == 0.25f);
	}
	bake_sampler_close(s);
	/* without alpha it is plain colour */
	s = opened(&img, true);
	CHECK(bake_sampler_nchans(s) == 3);
	bake_sampler_read(s,
	    &(struct bake_lookup){
		0.5, 0.5, 90, 0, 0, 90, BAKE_TEX_REPEAT, BAKE_TEX_REPEAT },
	    got);
	CHECK(got[0] == 0.5f && got[1] == 0.5f && got[2] == 0.25f);
	bake_sampler_close(s);
	/* all transparent: the plain mean */
	for (int i = 0; i < 256; i++)
		img.data[i * 4 + 3] = 0;
	s = opened(&img, false);
	bake_sampler_read(s,
	    &(struct bake_lookup){
		0.5, 0.5, 90, 0, 0, 90, BAKE_TEX_REPEAT, BAKE_TEX_REPEAT },
	    got);
	CHECK(got[0] == 0.5f && got[1] == 0.5f && got[3] == 0);
	bake_sampler_close(s);
	bake_image_free(&img);
}

static void
any_thread_count_gives_the_same_bits(void)
{
	struct bake_image img = noise(131, 77, 4);
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_sampler *s[2];
	uint32_t seed = 21;
	int differ = 0;

	CHECK_OK(bake_sampler_open(&s[0], &img, false, 1, &err), err);
	CHECK_OK(bake_sampler_open(&s[1], &img, false, 5, &err), err);
	for (int i = 0; i < 2000; i++) {
		const double r = 40 * random_unit(&seed);
		const struct bake_lookup at =
		    place(&img, 131 * random_unit(&seed),
			77 * random_unit(&seed), r, r * random_unit(&seed),
			r / 2, -r * random_unit(&seed), wraps[i % 3]);
		float a[4], b[4];

		bake_sampler_read(s[0], &at, a);
		bake_sampler_read(s[1], &at, b);
		differ += memcmp(a, b, sizeof a) != 0;
	}
	CHECK(differ == 0);
	bake_sampler_close(s[0]);
	bake_sampler_close(s[1]);
	bake_image_free(&img);
}

static void
anything_may_be_asked_for(void)
{
	static const double odd[] = { 0, 1, -1, 1e9, -1e9, 1e300, -1e300,
		1e-310, INFINITY, -INFINITY, NAN, 0.5 };
	enum { N = sizeof odd / sizeof *odd };
	struct bake_image img = noise(7, 5, 3);
	struct bake_sampler *s = opened(&img, false);
	uint32_t seed = 2;
	int wrong = 0;

	for (int i = 0; i < 20000; i++) {
		double v[6];
		struct bake_lookup at;
		float got[3];

		for (int k = 0; k < 6; k++)
			v[k] = odd[(int)(N * random_unit(&seed)) % N];
		at = (struct bake_lookup){ v[0], v[1], v[2], v[3], v[4], v[5],
			wraps[i % 3], wraps[i / 3 % 3] };
		bake_sampler_read(s, &at, got);
		for (int c = 0; c < 3; c++)
			wrong += !(got[c] >= 0 && got[c] <= 1);
	}
	CHECK(wrong == 0);
	bake_sampler_close(s);
	bake_sampler_close(NULL);
	bake_image_free(&img);
}

static void
bad_pictures_are_refused(void)
{
	struct bake_image none = BAKE_IMAGE_INIT, five = image(2, 2, 5);
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_sampler *s = (struct bake_sampler *)&err;

	CHECK(bake_sampler_open(&s, &none, false, 1, &err) == BAKE_EINVAL);
	CHECK(s == NULL);
	CHECK(strstr(err.msg, "0x0") != NULL);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_sampler_open(&s, &five, false, 1, &err) == BAKE_EINVAL);
	CHECK(s == NULL);
	CHECK(strstr(err.msg, "5 channels") != NULL);
	bake_image_free(&five);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(constant_keeps_its_bits),
		CASE(magnified_ramp_is_reproduced),
		CASE(magnified_is_bilinear_at_all_borders),
		CASE(wraps_have_their_symmetries),
		CASE(large_footprint_gives_the_mean),
		CASE(minified_wave_has_the_kernels_height),
		CASE(minified_is_what_supersampling_gives),
		CASE(anisotropy_tells_along_from_across),
		CASE(scales_meet_without_a_jump),
		CASE(transparent_texels_have_no_say_in_the_colour),
		CASE(any_thread_count_gives_the_same_bits),
		CASE(anything_may_be_asked_for),
		CASE(bad_pictures_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
