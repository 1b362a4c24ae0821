/* The arguments of options: strict numbers, sizes and choices. */
/* SPDX-License-Identifier: MIT */
#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "cmd.h"

bool
cmd_int(const struct cmd *cmd, const char *option, const char *text, long lo,
    long hi, int *value)
{
	char *end;
	long v;

	errno = 0;
	v = strtol(text, &end, 10);
	if (end == text || *end != '\0' || errno != 0 || v < lo || v > hi ||
	    isspace((unsigned char)*text))
		return cmd_usage_error(cmd,
		    "--%s is '%s', expected a whole number from %ld to %ld",
		    option, text, lo, hi);
	*value = (int)v;
	return true;
}

/* One number at text, ended by stop or the end; NULL where there is none. The
 * first character keeps out blanks, hexadecimals' x is no stop, nan and inf
 * have no digit. */
static const char *
scan_number(const char *text, char stop, double lo, double hi, double *value)
{
	char *end;

	if (*text == '\0' || strchr("+-.0123456789", *text) == NULL)
		return NULL;
	*value = strtod(text, &end);
	if (end == text || (*end != stop && *end != '\0') ||
	    !(*value >= lo && *value <= hi))
		return NULL;
	return end;
}

bool
cmd_numbers(const struct cmd *cmd, const char *option, const char *text,
    double lo, double hi, double *value, int max, int *n)
{
	const char *p = text;

	for (*n = 0; *n < max;) {
		p = scan_number(p, ',', lo, hi, &value[*n]);
		if (p == NULL)
			break;
		++*n;
		if (*p == '\0')
			return true;
		p++;
	}
	return cmd_usage_error(cmd, "--%s is '%s', expected %s from %g to %g%s",
	    option, text, max == 1 ? "a number" : "numbers", lo, hi,
	    max == 1 ? "" : ", separated by commas");
}

bool
cmd_number(const struct cmd *cmd, const char *option, const char *text,
    double lo, double hi, double *value)
{
	int n;

	return cmd_numbers(cmd, option, text, lo, hi, value, 1, &n);
}

bool
cmd_bytes(
    const struct cmd *cmd, const char *option, const char *text, double *bytes)
{
	static const char units[] = "KMGT";
	const char *unit;
	char *end = NULL;
	double v = 0;

	if (isdigit((unsigned char)*text))
		v = strtod(text, &end);
	if (end != NULL && *end != '\0' &&
	    (unit = strchr(units, toupper((unsigned char)*end))) != NULL) {
		for (const char *u = units; u <= unit; u++)
			v *= 1024;
		end++;
	}
	if (end == NULL || *end != '\0' || !(v >= 1 && v <= 1e18))
		return cmd_usage_error(cmd,
		    "--%s is '%s', expected a size in bytes, such as 512M or "
		    "8G",
		    option, text);
	*bytes = v;
	return true;
}

bool
cmd_size(const struct cmd *cmd, const char *option, const char *text,
    int *width, int *height)
{
	char *end, *end2;
	long w, h = 0;

	w = isdigit((unsigned char)*text) ? strtol(text, &end, 10) : 0;
	if (w > 0 && *end == 'x' && isdigit((unsigned char)end[1])) {
		h = strtol(end + 1, &end2, 10);
		if (*end2 != '\0')
			h = 0;
	}
	if (w < 1 || h < 1 || w > 1 << 20 || h > 1 << 20)
		return cmd_usage_error(cmd,
		    "--%s is '%s', expected WIDTHxHEIGHT in texels", option,
		    text);
	*width = (int)w;
	*height = (int)h;
	return true;
}

bool
cmd_choice(const struct cmd *cmd, const char *option, const char *text,
    const char *const *names, int n, int *index)
{
	char all[512] = "";
	size_t used = 0;

	*index = 0;
	for (int i = 0; i < n; i++) {
		if (strcmp(text, names[i]) == 0) {
			*index = i;
			return true;
		}
		used += (size_t)snprintf(all + used, sizeof all - used, "%s%s",
		    i == 0       ? ""
		    : i == n - 1 ? " or "
				 : ", ",
		    names[i]);
		if (used >= sizeof all)
			used = sizeof all - 1;
	}
	return cmd_usage_error(
	    cmd, "--%s is '%s', expected %s", option, text, all);
}
