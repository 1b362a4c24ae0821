// The shortest decimals of a number that read back as the same number.
// SPDX-License-Identifier: MIT
#include <charconv>

#include "quadric_text_priv.h"

extern "C" char *
bake_number_text(char *out, double v) noexcept
{
	// 24 is the longest: -2.2250738585072014e-308
	return std::to_chars(out, out + BAKE_NUMBER_TEXT, v).ptr;
}
