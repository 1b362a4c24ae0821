/* Data formats: how a float value becomes a code, and a code a value. */
/* SPDX-License-Identifier: MIT */
#include "codes.h"

#include <string.h>

const char *
bake_data_format_name(enum bake_data_format format)
{
	static const char *const names[] = { "uint8", "uint16", "half",
		"float" };

	return names[format];
}

int
bake_data_format_max(enum bake_data_format format)
{
	return format == BAKE_DATA_UINT8    ? 255
	       : format == BAKE_DATA_UINT16 ? 65535
					    : 0;
}

void
bake_codes_from_u8(float *value, const uint8_t *code, size_t n)
{
	for (size_t i = 0; i < n; i++)
		value[i] = (float)code[i] / 255.0f;
}

void
bake_codes_from_u16(float *value, const uint16_t *code, size_t n)
{
	for (size_t i = 0; i < n; i++)
		value[i] = (float)code[i] / 65535.0f;
}

/* value * max + 1/2 clipped to [0, max + 1/2]: its integer part is the code.
 * In double, since a float product may round across the half. */
static inline double
scaled(float value, double max, size_t *nclipped)
{
	double v = (double)value * max + 0.5;

	if (!(v >= 0.0)) {
		*nclipped += 1;
		return 0.0;
	}
	if (v >= max + 1.0) {
		*nclipped += 1;
		return max + 0.5;
	}
	return v;
}

size_t
bake_codes_to_u8(uint8_t *code, const float *value, size_t n)
{
	size_t nclipped = 0;

	for (size_t i = 0; i < n; i++)
		code[i] = (uint8_t)(int)scaled(value[i], 255.0, &nclipped);
	return nclipped;
}

size_t
bake_codes_to_u16(uint16_t *code, const float *value, size_t n)
{
	size_t nclipped = 0;

	for (size_t i = 0; i < n; i++)
		code[i] = (uint16_t)(int)scaled(value[i], 65535.0, &nclipped);
	return nclipped;
}

static inline float
half_value(uint32_t half)
{
	const uint32_t sign = (half & 0x8000) << 16, size = half & 0x7fff;
	uint32_t bits;
	float value;

	if (size < 0x400) { /* subnormal: steps of 2^-24 */
		value = (float)size * 0x1p-24f;
		memcpy(&bits, &value, sizeof bits);
	} else if (size < 0x7c00) {
		bits = (size << 13) + (112u << 23);
	} else {
		bits = (size << 13) + (224u << 23);
	}
	bits |= sign;
	memcpy(&value, &bits, sizeof value);
	return value;
}

void
bake_codes_from_half(float *value, const uint16_t *bits, size_t n)
{
	for (size_t i = 0; i < n; i++)
		value[i] = half_value(bits[i]);
}

/* |value|'s half from its bits: to the nearest, ties to even. */
static inline uint32_t
half_size(uint32_t size, size_t *nclipped)
{
	if (size >= 0x38800000) { /* 2^-14: normal */
		if (size > 0x7f800000)
			return 0x7e00 | (size >> 13 & 0x3ff);
		if (size == 0x7f800000)
			return 0x7c00;
		if (size >= 0x477ff000) { /* 65520 */
			*nclipped += 1;
			return 0x7bff;
		}
		size -= 112u << 23;
		return (size + 0xfff + (size >> 13 & 1)) >> 13;
	} else {
		/* the last bit of floats from 1/2 on is worth 2^-24 */
		const float half = 0.5f;
		uint32_t first, bits;
		float value;

		memcpy(&value, &size, sizeof value);
		value += half;
		memcpy(&bits, &value, sizeof bits);
		memcpy(&first, &half, sizeof first);
		return bits - first;
	}
}

size_t
bake_codes_to_half(uint16_t *bits, const float *value, size_t n)
{
	size_t nclipped = 0;

	for (size_t i = 0; i < n; i++) {
		uint32_t v;

		memcpy(&v, &value[i], sizeof v);
		bits[i] = (uint16_t)(half_size(v & 0x7fffffff, &nclipped) |
				     (v >> 16 & 0x8000));
	}
	return nclipped;
}
