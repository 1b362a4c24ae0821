/* Data formats: how a float value becomes a code, and a code a value. */
/* SPDX-License-Identifier: MIT */
#include "codes.h"

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
