/* Error values: the first failure's message is kept. */
/* SPDX-License-Identifier: MIT */
#include "err.h"

#include <stdarg.h>
#include <stdio.h>

enum bake_status
bake_fail(struct bake_err *err, enum bake_status code, const char *fmt, ...)
{
	va_list ap;

	if (err->code != BAKE_OK)
		return code;
	err->code = code;
	va_start(ap, fmt);
	vsnprintf(err->msg, sizeof err->msg, fmt, ap);
	va_end(ap);
	return code;
}
