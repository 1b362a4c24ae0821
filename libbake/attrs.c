/* Named attributes: kept in order, and written as one line of text. */
/* SPDX-License-Identifier: MIT */
#include "attrs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char prefix[] = "relief:";

void
bake_attrs_clear(struct bake_attrs *attrs)
{
	attrs->n = 0;
}

static struct bake_attr *
find(struct bake_attrs *attrs, const char *name)
{
	for (int i = 0; i < attrs->n; i++)
		if (strcmp(attrs->attr[i].name, name) == 0)
			return &attrs->attr[i];
	return NULL;
}

static bool
fits(const char *text, size_t size)
{
	if (strlen(text) >= size)
		return false;
	for (; *text != '\0'; text++)
		if (*text == ';' || (unsigned char)*text < ' ')
			return false;
	return true;
}

static void
set(struct bake_attrs *attrs, const char *name, const char *value, bool number)
{
	struct bake_attr *a = find(attrs, name);

	if (!fits(name, sizeof a->name) || !fits(value, sizeof a->value) ||
	    name[0] == '\0' || strchr(name, '=') != NULL)
		return;
	if (a == NULL) {
		if (attrs->n == BAKE_ATTRS_MAX)
			return;
		a = &attrs->attr[attrs->n++];
	}
	strcpy(a->name, name);
	strcpy(a->value, value);
	a->number = number;
}

void
bake_attrs_set(struct bake_attrs *attrs, const char *name, const char *value)
{
	set(attrs, name, value, false);
}

void
bake_attrs_set_number(struct bake_attrs *attrs, const char *name, double value)
{
	char text[BAKE_ATTR_VALUE], best[BAKE_ATTR_VALUE];

	/* from 9 digits, which every float reads back from, to fewer; 10 is
	 * shorter than 1e+01 */
	snprintf(best, sizeof best, "%.9g", value);
	for (int digits = 8; digits >= 1; digits--) {
		snprintf(text, sizeof text, "%.*g", digits, value);
		if (strtof(text, NULL) == (float)value &&
		    strlen(text) <= strlen(best))
			strcpy(best, text);
	}
	set(attrs, name, best, true);
}

void
bake_attrs_remove(struct bake_attrs *attrs, const char *name)
{
	int n = 0;

	for (int i = 0; i < attrs->n; i++)
		if (strcmp(attrs->attr[i].name, name) != 0)
			attrs->attr[n++] = attrs->attr[i];
	attrs->n = n;
}

const char *
bake_attrs_get(const struct bake_attrs *attrs, const char *name)
{
	for (int i = 0; i < attrs->n; i++)
		if (strcmp(attrs->attr[i].name, name) == 0)
			return attrs->attr[i].value;
	return NULL;
}

void
bake_attrs_format(const struct bake_attrs *attrs, char *line, size_t size)
{
	size_t used = 0;

	line[0] = '\0';
	for (int i = 0; i < attrs->n && used < size; i++) {
		int n = snprintf(line + used, size - used, "%s%s%s=%s",
		    i > 0 ? "; " : "", prefix, attrs->attr[i].name,
		    attrs->attr[i].value);

		if (n < 0)
			return;
		used += (size_t)n;
	}
}

void
bake_attrs_parse(struct bake_attrs *attrs, const char *line)
{
	char name[BAKE_ATTR_NAME], value[BAKE_ATTR_VALUE];
	const char *p = line;

	while ((p = strstr(p, prefix)) != NULL) {
		size_t nname, nvalue;

		p += sizeof prefix - 1;
		nname = strcspn(p, "=;");
		if (p[nname] != '=' || nname >= sizeof name)
			continue;
		nvalue = strcspn(p + nname + 1, ";\n\r");
		if (nvalue >= sizeof value)
			continue;
		memcpy(name, p, nname);
		name[nname] = '\0';
		memcpy(value, p + nname + 1, nvalue);
		value[nvalue] = '\0';
		set(attrs, name, value, false);
		p += nname + 1 + nvalue;
	}
}
