/* Attributes: kept in order, one line of text and back, hostile text. */
/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include "attrs.h"
#include "check.h"
#include "test_maps.h"

static bool
has(const struct bake_attrs *attrs, const char *name, const char *value)
{
	const char *got = bake_attrs_get(attrs, name);

	return value == NULL ? got == NULL
			     : got != NULL && strcmp(got, value) == 0;
}

static void
fill(char *text, size_t n, char c)
{
	memset(text, c, n);
	text[n] = '\0';
}

static void
set_replaces_in_place(void)
{
	struct bake_attrs a;

	bake_attrs_clear(&a);
	CHECK(a.n == 0 && bake_attrs_get(&a, "Layout") == NULL);
	bake_attrs_set(&a, "Layout", "relief");
	bake_attrs_set(&a, "NormalY", "up");
	bake_attrs_set_number(&a, "Layout", 0.25);
	CHECK(a.n == 2);
	CHECK(has(&a, "Layout", "0.25") && has(&a, "NormalY", "up"));
	CHECK(a.attr[0].number && !a.attr[1].number);
	bake_attrs_set(&a, "Layout", "ao");
	CHECK(a.n == 2 && has(&a, "Layout", "ao") && !a.attr[0].number);
	CHECK(has(&a, "layout", NULL)); /* names have case */
	bake_attrs_clear(&a);
	CHECK(a.n == 0 && has(&a, "Layout", NULL));
}

static void
what_does_not_fit_is_left_out(void)
{
	struct bake_attrs a;
	char name[BAKE_ATTR_NAME + 1], value[BAKE_ATTR_VALUE + 1];

	bake_attrs_clear(&a);
	fill(name, BAKE_ATTR_NAME - 1, 'n');
	fill(value, BAKE_ATTR_VALUE - 1, 'v');
	bake_attrs_set(&a, name, value);
	CHECK(a.n == 1 && has(&a, name, value));
	fill(name, BAKE_ATTR_NAME, 'n');
	bake_attrs_set(&a, name, "x");
	fill(value, BAKE_ATTR_VALUE, 'v');
	bake_attrs_set(&a, "Long", value);
	CHECK(a.n == 1 && has(&a, name, NULL) && has(&a, "Long", NULL));
	/* one that would end the attribute, or the line */
	bake_attrs_set(&a, "Evil", "a; relief:Layout=ao");
	bake_attrs_set(&a, "Evil", "a\nb");
	bake_attrs_set(&a, "Evil", "a\x01");
	bake_attrs_set(&a, "Ev;il", "a");
	bake_attrs_set(&a, "Ev\til", "a");
	bake_attrs_set(&a, "Ev=il", "a");
	bake_attrs_set(&a, "", "a");
	CHECK(a.n == 1);
	/* a value that does not fit leaves the one that was there */
	bake_attrs_set(&a, "Kept", "old");
	bake_attrs_set(&a, "Kept", value);
	bake_attrs_set(&a, "Kept", "new;");
	CHECK(has(&a, "Kept", "old"));
	bake_attrs_set(&a, "Text", "caf\xc3\xa9, a = b: 'c' \"d\"");
	CHECK(has(&a, "Text", "caf\xc3\xa9, a = b: 'c' \"d\""));
}

static void
no_more_than_there_is_room_for(void)
{
	struct bake_attrs a;
	char name[16];

	bake_attrs_clear(&a);
	for (int i = 0; i < BAKE_ATTRS_MAX + 5; i++) {
		snprintf(name, sizeof name, "n%d", i);
		bake_attrs_set(&a, name, "v");
	}
	CHECK(a.n == BAKE_ATTRS_MAX);
	CHECK(has(&a, "n19", "v") && has(&a, "n20", NULL));
	bake_attrs_set(&a, "n3", "w"); /* replacing needs no room */
	CHECK(a.n == BAKE_ATTRS_MAX && has(&a, "n3", "w"));
}

/* The text reads back as the same float, and none of %.1g to %.9g that does is
 * shorter. */
static void
numbers_are_shortest(void)
{
	static const struct {
		double value;
		const char *text;
	} want[] = { { 0.1, "0.1" }, { 0, "0" }, { 1, "1" }, { -0.5, "-0.5" },
		{ 10, "10" }, { 100, "100" }, { 0.25f, "0.25" },
		{ 1e-3, "0.001" }, { 0.1f, "0.1" }, { 1e30, "1e+30" },
		{ 16777216, "16777216" }, { 1.0f / 3, "0.33333334" } };
	struct bake_attrs a;

	bake_attrs_clear(&a);
	for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
		bake_attrs_set_number(&a, "N", want[i].value);
		CHECK(has(&a, "N", want[i].text));
	}
	for (uint32_t i = 0; i < 20000; i++) {
		uint32_t bits = hash(i) ^ hash(i + 77) << 11;
		char other[64];
		const char *text;
		float v;

		memcpy(&v, &bits, sizeof v);
		if (!isfinite(v))
			continue;
		bake_attrs_set_number(&a, "N", (double)v);
		text = bake_attrs_get(&a, "N");
		CHECK(text != NULL && strtof(text, NULL) == v);
		for (int digits = 1; digits <= 9; digits++) {
			snprintf(
			    other, sizeof other, "%.*g", digits, (double)v);
			CHECK(strtof(other, NULL) != v ||
			      strlen(other) >= strlen(text));
		}
	}
}

static void
line_has_all_in_order(void)
{
	struct bake_attrs a;
	char line[256];

	bake_attrs_clear(&a);
	bake_attrs_format(&a, line, sizeof line);
	CHECK(line[0] == '\0');
	bake_attrs_set(&a, "Layout", "relief");
	bake_attrs_set_number(&a, "DepthScale", 0.1);
	bake_attrs_format(&a, line, sizeof line);
	CHECK(strcmp(line, "relief:Layout=relief; relief:DepthScale=0.1") == 0);
}

static void
line_is_cut_to_its_room(void)
{
	struct bake_attrs a;
	char whole[256], line[256];

	bake_attrs_clear(&a);
	bake_attrs_set(&a, "A", "12345");
	bake_attrs_set(&a, "B", "67890");
	bake_attrs_set(&a, "C", "x");
	bake_attrs_format(&a, whole, sizeof whole);
	for (size_t size = 1; size <= strlen(whole) + 2; size++) {
		size_t n = strlen(whole);

		memset(line, '#', sizeof line);
		bake_attrs_format(&a, line, size);
		if (n > size - 1)
			n = size - 1;
		CHECK(strlen(line) == n && memcmp(line, whole, n) == 0);
		for (size_t i = size; i < sizeof line; i++)
			CHECK(line[i] == '#');
	}
}

static void
line_reads_back(void)
{
	struct bake_attrs a, b;
	char line[BAKE_ATTRS_MAX * (BAKE_ATTR_NAME + BAKE_ATTR_VALUE + 16)];
	char name[BAKE_ATTR_NAME], value[BAKE_ATTR_VALUE];

	bake_attrs_clear(&a);
	bake_attrs_clear(&b);
	for (int i = 0; i < BAKE_ATTRS_MAX; i++) {
		fill(name, BAKE_ATTR_NAME - 1, (char)('a' + i));
		for (int k = 0; k < BAKE_ATTR_VALUE - 1; k++)
			value[k] = (char)(' ' + (31 * i + k) % 95);
		value[BAKE_ATTR_VALUE - 1] = '\0';
		for (char *p = value; *p != '\0'; p++)
			if (*p == ';')
				*p = '=';
		bake_attrs_set(&a, name, value);
	}
	bake_attrs_format(&a, line, sizeof line);
	bake_attrs_parse(&b, line);
	CHECK(b.n == BAKE_ATTRS_MAX);
	for (int i = 0; i < b.n; i++) {
		CHECK(strcmp(a.attr[i].name, b.attr[i].name) == 0);
		CHECK(strcmp(a.attr[i].value, b.attr[i].value) == 0);
	}
}

static void
other_text_is_passed_over(void)
{
	static const char *const nothing[] = { "",
		"relief:", "relief:=", "relief:=x", "relief:Layout",
		"relief:Layout;", "relief", ";=;=", "Relief:Layout=ao",
		"relief:;Layout=ao", "relief:a\nb=c", "relief:relief:relief:" };
	struct bake_attrs a;

	for (size_t i = 0; i < sizeof nothing / sizeof *nothing; i++) {
		bake_attrs_clear(&a);
		bake_attrs_parse(&a, nothing[i]);
		if (a.n != 0)
			printf("'%s' gave an attribute\n", nothing[i]);
		CHECK(a.n == 0);
	}
	bake_attrs_clear(&a);
	bake_attrs_parse(&a, "made by hand, relief:Layout=relief;relief:A=;"
			     "junk relief:Wrap=tile\nsecond line relief:B=2");
	CHECK(a.n == 4);
	CHECK(has(&a, "Layout", "relief") && has(&a, "A", "") &&
	      has(&a, "Wrap", "tile") && has(&a, "B", "2"));
}

static void
hostile_text_is_harmless(void)
{
	struct bake_attrs a;
	char line[4096];
	size_t n;

	/* duplicated: the last one counts, as with bake_attrs_set */
	bake_attrs_clear(&a);
	bake_attrs_parse(&a, "relief:S=1; relief:S=2; relief:S=3");
	CHECK(a.n == 1 && has(&a, "S", "3"));
	/* too long names and values are left out, what follows is read */
	for (int over = 0; over < 2; over++) {
		bake_attrs_clear(&a);
		n = (size_t)snprintf(line, sizeof line, "relief:");
		memset(line + n, 'N', BAKE_ATTR_NAME - 1 + (size_t)over);
		n += BAKE_ATTR_NAME - 1 + (size_t)over;
		n += (size_t)snprintf(
		    line + n, sizeof line - n, "=1; relief:V=");
		memset(line + n, 'V', BAKE_ATTR_VALUE - 1 + (size_t)over);
		n += BAKE_ATTR_VALUE - 1 + (size_t)over;
		snprintf(line + n, sizeof line - n, "; relief:Z=z");
		bake_attrs_parse(&a, line);
		CHECK(a.n == (over ? 1 : 3));
		CHECK(has(&a, "Z", "z"));
	}
	/* more than fit */
	bake_attrs_clear(&a);
	n = 0;
	for (int i = 0; i < 100; i++)
		n += (size_t)snprintf(
		    line + n, sizeof line - n, "relief:n%d=%d; ", i, i);
	bake_attrs_parse(&a, line);
	CHECK(a.n == BAKE_ATTRS_MAX && has(&a, "n19", "19"));
	/* control characters */
	bake_attrs_clear(&a);
	bake_attrs_parse(&a, "relief:A=a\x1b[31m; relief:B=b");
	CHECK(a.n == 1 && has(&a, "B", "b"));
	/* any bytes: the sanitizers look on */
	for (uint32_t i = 0; i < 20000; i++) {
		static const char *const parts[] = { "relief:", "=", ";", "\n",
			"x", "Layout", "\xff", " " };

		line[0] = '\0';
		for (uint32_t k = 0; k < i % 24; k++)
			strcat(line, parts[hash(i * 31 + k) % 8]);
		bake_attrs_clear(&a);
		bake_attrs_parse(&a, line);
		CHECK(a.n >= 0 && a.n <= BAKE_ATTRS_MAX);
		for (int k = 0; k < a.n; k++)
			CHECK(strpbrk(a.attr[k].value, ";\n") == NULL);
	}
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(set_replaces_in_place),
		CASE(what_does_not_fit_is_left_out),
		CASE(no_more_than_there_is_room_for),
		CASE(numbers_are_shortest),
		CASE(line_has_all_in_order),
		CASE(line_is_cut_to_its_room),
		CASE(line_reads_back),
		CASE(other_text_is_passed_over),
		CASE(hostile_text_is_harmless),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
