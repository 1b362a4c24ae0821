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
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
