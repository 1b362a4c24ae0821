/* Codes: every code comes back, and rounding is half up in exact arithmetic. */
/* SPDX-License-Identifier: MIT */
#include <stdbool.h>
#include <stdint.h>

#include "check.h"
#include "codes.h"
#include "test_maps.h"

/* One interface to both widths. */
static size_t
to_codes(int *code, const float *value, size_t n, int max)
{
	uint8_t c8[64];
	uint16_t c16[64];
	size_t nclipped = max == 255 ? bake_codes_to_u8(c8, value, n)
				     : bake_codes_to_u16(c16, value, n);

	for (size_t i = 0; i < n; i++)
		code[i] = max == 255 ? c8[i] : c16[i];
	return nclipped;
}

static float
from_code(int code, int max)
{
	uint8_t c8 = (uint8_t)code;
	uint16_t c16 = (uint16_t)code;
	float v;

	if (max == 255)
		bake_codes_from_u8(&v, &c8, 1);
	else
		bake_codes_from_u16(&v, &c16, 1);
	return v;
}

/*
 * floor(value * max + 1/2), clipped, in integers: value = m 2^-s exactly, so
 * it is floor((2 m max + 2^s) / 2^(s + 1)).
 */
static int
code_exact(float value, int max, bool *clipped)
{
	int exponent;
	__int128 m;
	int s;

	*clipped = true;
	if (isnan(value) || value <= -1.0f)
		return 0;
	if (value >= 2.0f)
		return max;
	m = (__int128)ldexp(frexp((double)value, &exponent), 24);
	s = 24 - exponent;
	*clipped = false;
	if (s > 90) /* |value * max| is far below 1/2 */
		return 0;
	m = 2 * m * max + ((__int128)1 << s);
	if (m < 0) {
		*clipped = true;
		return 0;
	}
	m >>= s + 1;
	*clipped = m > max;
	return m > max ? max : (int)m;
}

static void
check_value(float value, int max)
{
	bool clipped;
	int want = code_exact(value, max, &clipped), got;
	size_t n = to_codes(&got, &value, 1, max);

	if (got != want || n != (size_t)clipped)
		printf("value %a, max %d: code %d, expected %d\n",
		    (double)value, max, got, want);
	CHECK(got == want);
	CHECK(n == (size_t)clipped);
}

static const int maxima[] = { 255, 65535 };

static void
every_code_survives(void)
{
	for (int m = 0; m < 2; m++) {
		for (int c = 0; c <= maxima[m]; c++) {
			float v = from_code(c, maxima[m]);
			int back;

			CHECK(to_codes(&back, &v, 1, maxima[m]) == 0);
			CHECK(back == c);
		}
		CHECK(from_code(0, maxima[m]) == 0.0f);
		CHECK(from_code(maxima[m], maxima[m]) == 1.0f);
	}
}

/* v * max has 24 + 16 bits and is exact in double, so that the distance to the
 * code is too: the neighbours of v lie farther off. */
static void
values_are_rounded_correctly(void)
{
	for (int m = 0; m < 2; m++) {
		double max = maxima[m];

		for (int c = 1; c <= maxima[m]; c++) {
			float v = from_code(c, maxima[m]);
			double off = fabs((double)v * max - c);

			CHECK(
			    off <= fabs((double)nextafterf(v, 2.0f) * max - c));
			CHECK(off <=
			      fabs((double)nextafterf(v, -1.0f) * max - c));
		}
	}
}

static void
rounding_is_half_up(void)
{
	for (int m = 0; m < 2; m++) {
		for (int k = -2; k <= maxima[m] + 2; k++) {
			float v = (float)((k + 0.5) / maxima[m]);

			for (int i = 0; i < 3; i++)
				v = nextafterf(v, -2.0f);
			for (int i = 0; i < 7; i++) {
				check_value(v, maxima[m]);
				v = nextafterf(v, 2.0f);
			}
		}
	}
	/* the one tie that a float can hold */
	check_value(0.5f, 255);
	check_value(0.5f, 65535);
	CHECK(code_exact(0.5f, 255, &(bool){ false }) == 128);
	CHECK(code_exact(0.5f, 65535, &(bool){ false }) == 32768);
}

static void
any_float_has_its_code(void)
{
	for (uint32_t i = 0; i < 300000; i++) {
		uint32_t bits = hash(i) ^ hash(i + 0x51ed2701) << 9;
		float v;

		/* a third of them within 0 .. 1, where codes are */
		if (i % 3 == 0)
			bits = (bits & 0x00ffffff) | 0x3e000000;
		memcpy(&v, &bits, sizeof v);
		check_value(v, 255);
		check_value(v, 65535);
	}
}

static void
clipping_is_counted(void)
{
	static const float v[] = { NAN, -NAN, INFINITY, -INFINITY, 1e30f,
		-1e30f, -0.0f, 0.0f, 1.0f, -1e-9f, 1.0000001f, 1e-45f,
		-1e-45f };
	static const int nclipped_want = 6; /* the first six */
	int code[sizeof v / sizeof *v];

	for (int m = 0; m < 2; m++) {
		int max = maxima[m];
		int want[] = { 0, 0, max, 0, max, 0, 0, 0, max, 0, max, 0, 0 };

		CHECK(to_codes(code, v, sizeof v / sizeof *v, max) ==
		      (size_t)nclipped_want);
		for (size_t i = 0; i < sizeof v / sizeof *v; i++)
			CHECK(code[i] == want[i]);
	}
	CHECK(to_codes(code, v, 0, 255) == 0);
	CHECK(to_codes(code, v, 0, 65535) == 0);
}

static void
formats_have_names_and_maxima(void)
{
	static const struct {
		enum bake_data_format format;
		const char *name;
		int max;
	} want[] = { { BAKE_DATA_UINT8, "uint8", 255 },
		{ BAKE_DATA_UINT16, "uint16", 65535 },
		{ BAKE_DATA_HALF, "half", 0 },
		{ BAKE_DATA_FLOAT, "float", 0 } };

	for (size_t i = 0; i < 4; i++) {
		CHECK(strcmp(bake_data_format_name(want[i].format),
			  want[i].name) == 0);
		CHECK(bake_data_format_max(want[i].format) == want[i].max);
		/* in rising depth */
		CHECK(i == 0 || want[i].format > want[i - 1].format);
	}
}

/* A finite half by the format's definition. */
static double
half_exact(int bits)
{
	const int e = bits >> 10 & 31, m = bits & 1023;
	const double size = e == 0 ? ldexp(m, -24) : ldexp(1024 + m, e - 25);

	return bits & 0x8000 ? -size : size;
}

static int
to_half(float value, size_t *nclipped)
{
	uint16_t bits;

	*nclipped = bake_codes_to_half(&bits, &value, 1);
	return bits;
}

static void
every_half_is_exact_and_survives(void)
{
	for (int h = 0; h < 65536; h++) {
		const uint16_t bits = (uint16_t)h;
		size_t nclipped;
		float v;

		bake_codes_from_half(&v, &bits, 1);
		if ((h & 0x7c00) != 0x7c00) {
			CHECK((double)v == half_exact(h));
			CHECK(!signbit(v) == !(h & 0x8000));
			CHECK(to_half(v, &nclipped) == h);
		} else if ((h & 0x3ff) == 0) {
			CHECK(isinf(v) && !signbit(v) == !(h & 0x8000));
			CHECK(to_half(v, &nclipped) == h);
		} else {
			CHECK(isnan(v));
			CHECK((to_half(v, &nclipped) & 0x7fff) > 0x7c00);
		}
		CHECK(nclipped == 0);
	}
}

/* The middle of two halfs has one bit more than they and is exact. */
static void
halfs_round_to_nearest_even(void)
{
	size_t nclipped;

	for (int h = 0; h < 0x7bff; h++)
		for (int sign = 0; sign < 2; sign++) {
			const int s = sign << 15;
			const float tie = (float)((half_exact(h | s) +
						      half_exact((h + 1) | s)) /
						  2);
			const float far = sign ? -1e6f : 1e6f;

			CHECK(to_half(tie, &nclipped) == (h + h % 2) + s);
			CHECK(to_half(nextafterf(tie, 0), &nclipped) == h + s);
			CHECK(to_half(nextafterf(tie, far), &nclipped) ==
			      h + 1 + s);
		}
}

static void
large_halfs_are_clipped_and_counted(void)
{
	static const struct {
		float value;
		int bits, nclipped;
	} want[] = { { 65504, 0x7bff, 0 }, { 65519.996f, 0x7bff, 0 },
		{ 65520, 0x7bff, 1 }, { -65520, 0xfbff, 1 },
		{ 3e38f, 0x7bff, 1 }, { INFINITY, 0x7c00, 0 },
		{ -INFINITY, 0xfc00, 0 }, { -0.0f, 0x8000, 0 },
		{ 0x1p-25f, 0, 0 }, { 0x1.000002p-25f, 1, 0 },
		{ 1e-45f, 0, 0 } };

	for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
		size_t nclipped;

		CHECK(to_half(want[i].value, &nclipped) == want[i].bits);
		CHECK(nclipped == (size_t)want[i].nclipped);
	}
}

/* Oracle: v in steps of its binade's halfs, a power of two, by rint. */
static void
any_float_has_its_half(void)
{
	for (uint32_t i = 0; i < 300000; i++) {
		uint32_t bits = hash(i) ^ hash(i + 0x2545f491) << 11;
		int e;
		size_t nclipped;
		double step, want;
		float v;

		/* exponents of halfs, and some beyond */
		bits = (bits & 0x807fffff) | (100 + bits % 45) << 23;
		memcpy(&v, &bits, sizeof v);
		frexp((double)v, &e);
		step = ldexp(1, (e < -13 ? -13 : e) - 11);
		want = rint((double)v / step) * step;
		if (fabs(want) > 65504)
			want = copysign(65504, want);
		CHECK(half_exact(to_half(v, &nclipped)) == want);
		CHECK(nclipped == (fabs((double)v) >= 65520));
	}
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(every_code_survives),
		CASE(values_are_rounded_correctly),
		CASE(rounding_is_half_up),
		CASE(any_float_has_its_code),
		CASE(clipping_is_counted),
		CASE(formats_have_names_and_maxima),
		CASE(every_half_is_exact_and_survives),
		CASE(halfs_round_to_nearest_even),
		CASE(large_halfs_are_clipped_and_counted),
		CASE(any_float_has_its_half),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
