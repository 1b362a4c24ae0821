/* Data formats: how a float value becomes a code, and a code a value. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_CODES_H
#define BAKE_CODES_H

#include <stddef.h>
#include <stdint.h>

#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

/* In rising depth, so that the deepest of several is their maximum. */
enum bake_data_format {
	BAKE_DATA_UINT8 = 0,
	BAKE_DATA_UINT16,
	BAKE_DATA_HALF,
	BAKE_DATA_FLOAT
};

/* "uint8", "uint16", "half", "float": static text. */
BAKE_API const char *bake_data_format_name(enum bake_data_format format);

/* The largest code, 255 or 65535; 0 for half and float. */
BAKE_API int bake_data_format_max(enum bake_data_format format);

/*
 * Integer codes to values: value = code / max, correctly rounded, so that
 * the way back gives the same code. max is 255 or 65535. Reentrant.
 */
BAKE_API void bake_codes_from_u8(float *value, const uint8_t *code, size_t n);
BAKE_API void bake_codes_from_u16(float *value, const uint16_t *code, size_t n);

/*
 * Values to integer codes: code = floor(value * max + 1/2), computed in
 * double; values below 0 or above 1 (and NaN, as 0) are clipped. Returns how
 * many values were clipped by more than half a code. Reentrant.
 */
BAKE_API size_t bake_codes_to_u8(uint8_t *code, const float *value, size_t n);
BAKE_API size_t bake_codes_to_u16(uint16_t *code, const float *value, size_t n);

/*
 * Half bits (IEEE 754 binary16) to values: exact, subnormal numbers,
 * infinities and NaN too. Reentrant.
 */
BAKE_API void bake_codes_from_half(
    float *value, const uint16_t *bits, size_t n);

/*
 * Values to half bits: the nearest half, of two equally near ones that with an
 * even last bit. A finite value that would round to infinity (|value| >= 65520)
 * is clipped to the largest half, 65504, with its sign; infinities stay, and
 * NaN stays NaN (quiet). Returns how many values were clipped. Reentrant, in
 * the default rounding mode.
 */
BAKE_API size_t bake_codes_to_half(
    uint16_t *bits, const float *value, size_t n);

#ifdef __cplusplus
}
#endif

#endif
