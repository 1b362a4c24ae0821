/* The conventions in which maps differ: their names. */
/* SPDX-License-Identifier: MIT */
#include "conventions.h"

const char *
bake_polarity_name(enum bake_polarity polarity)
{
	static const char *const names[] = { "unsure", "depth", "height" };

	return names[polarity];
}

const char *
bake_normal_y_name(enum bake_normal_y normal_y)
{
	static const char *const names[] = { "unsure", "up", "down" };

	return names[normal_y];
}

const char *
bake_normal_code_name(enum bake_normal_code code)
{
	static const char *const names[] = { "auto", "unsigned", "signed" };

	return names[code];
}
