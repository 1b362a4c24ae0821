/* Numbers in text, rounded correctly whatever the locale. */
/* SPDX-License-Identifier: MIT */
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "mesh_priv.h"

/* A decimal of more characters than this is no number anybody wrote. */
enum { MAX_DECIMAL = 1100 };

enum bake_status
bake_mesh_text_init(
    struct mesh_text *t, const void *bytes, size_t nbytes, struct bake_err *err)
{
	t->p = bytes;
	t->end = t->p + nbytes;
	t->line = 1;
	t->c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	if (t->c_locale == NULL)
		return bake_fail(err, BAKE_ENOMEM, "no memory for a locale");
	return BAKE_OK;
}

void
bake_mesh_text_free(struct mesh_text *t)
{
	if (t->c_locale != NULL)
		freelocale((locale_t)t->c_locale);
	t->c_locale = NULL;
}

static bool
is_digit(char c)
{
	return c >= '0' && c <= '9';
}

/* nan, inf, infinity: the characters, or 0. */
static size_t
scan_special(const char *p, const char *end, double *value)
{
	static const struct {
		const char *name;
		size_t length;
	} names[] = { { "infinity", 8 }, { "inf", 3 }, { "nan", 3 } };
	size_t left = (size_t)(end - p);

	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		if (left < names[i].length ||
		    strncasecmp(p, names[i].name, names[i].length) != 0)
			continue;
		*value = i == 2 ? (double)NAN : (double)INFINITY;
		return names[i].length;
	}
	return 0;
}

/* What the quick way cannot do exactly. */
static enum mesh_number
scan_slowly(const struct mesh_text *t, const char *begin, const char *end,
    double *value)
{
	char text[MAX_DECIMAL + 1];
	size_t n = (size_t)(end - begin);

	if (n > MAX_DECIMAL)
		return MESH_NOT_A_NUMBER;
	memcpy(text, begin, n);
	text[n] = '\0';
	*value = strtod_l(text, NULL, (locale_t)t->c_locale);
	return MESH_NUMBER;
}

/* Digits from *p into the mantissa; its first 19 fit. */
static int
scan_digits(const char **p, const char *end, uint64_t *mantissa, int *ndigits)
{
	const char *q = *p;

	for (; q < end && is_digit(*q); q++) {
		if (*ndigits < 19)
			*mantissa = *mantissa * 10 + (uint64_t)(*q - '0');
		/* leading zeros do not count */
		if (*mantissa != 0 && *ndigits < 1000)
			++*ndigits;
	}
	{
		ptrdiff_t n = q - *p;

		*p = q;
		return n > 100000 ? 100000 : (int)n;
	}
}

/* e[+-]digits, where they are complete; 0 where there is none. */
static int
scan_exponent(const char **p, const char *end)
{
	const char *q = *p;
	bool negative = false;
	int e = 0;

	if (q >= end || (*q != 'e' && *q != 'E'))
		return 0;
	q++;
	if (q < end && (*q == '+' || *q == '-'))
		negative = *q++ == '-';
	if (q >= end || !is_digit(*q))
		return 0;
	for (; q < end && is_digit(*q); q++)
		if (e < 100000)
			e = e * 10 + (*q - '0');
	*p = q;
	return negative ? -e : e;
}

enum mesh_number
bake_mesh_scan_double(struct mesh_text *t, double *value)
{
	/* these and integers below 2^53 are doubles, so that one product or
	 * quotient of them is rounded once (Clinger 1990) */
	static const double power[] = { 1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7,
		1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
		1e19, 1e20, 1e21, 1e22 };
	const char *p = t->p, *begin = p;
	bool negative = false;
	uint64_t mantissa = 0;
	int ndigits = 0, nwhole, nfraction = 0, exponent;
	size_t special;

	if (p < t->end && (*p == '+' || *p == '-'))
		negative = *p++ == '-';
	if (p < t->end && !is_digit(*p) && *p != '.' &&
	    (special = scan_special(p, t->end, value)) != 0) {
		t->p = p + special;
		if (negative)
			*value = -*value;
		return MESH_NUMBER;
	}
	nwhole = scan_digits(&p, t->end, &mantissa, &ndigits);
	if (p < t->end && *p == '.') {
		p++;
		nfraction = scan_digits(&p, t->end, &mantissa, &ndigits);
	}
	if (nwhole + nfraction == 0)
		return MESH_NOT_A_NUMBER;
	exponent = scan_exponent(&p, t->end) - nfraction;
	if (ndigits < 19 && mantissa <= (uint64_t)1 << 53 && exponent >= -22 &&
	    exponent <= 22) {
		*value = exponent < 0 ? (double)mantissa / power[-exponent]
				      : (double)mantissa * power[exponent];
		if (negative)
			*value = -*value;
	} else if (scan_slowly(t, begin, p, value) != MESH_NUMBER) {
		return MESH_NOT_A_NUMBER;
	}
	t->p = p;
	return MESH_NUMBER;
}

enum mesh_number
bake_mesh_scan_int(struct mesh_text *t, int64_t *value)
{
	const char *p = t->p;
	bool negative = false;
	int64_t v = 0;

	if (p < t->end && (*p == '+' || *p == '-'))
		negative = *p++ == '-';
	if (p >= t->end || !is_digit(*p))
		return MESH_NOT_A_NUMBER;
	for (; p < t->end && is_digit(*p); p++)
		if (__builtin_mul_overflow(v, 10, &v) ||
		    __builtin_add_overflow(v, *p - '0', &v))
			return MESH_NOT_A_NUMBER;
	*value = negative ? -v : v;
	t->p = p;
	return MESH_NUMBER;
}
