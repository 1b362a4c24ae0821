/* Fuzz target: any text as an image's description with metadata in it. */
/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "attrs.h"
#include "relief.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* All that fit: names, values and what stands between them. */
enum { LINE = BAKE_ATTRS_MAX * (BAKE_ATTR_NAME + BAKE_ATTR_VALUE + 16) };

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	struct bake_attrs attrs, again;
	struct bake_relief_meta meta = BAKE_RELIEF_META_INIT;
	char line[LINE], line_again[LINE];
	char *text;

	if ((text = malloc(size + 1)) == NULL)
		return 0;
	memcpy(text, bytes, size);
	text[size] = '\0';
	bake_attrs_clear(&attrs);
	bake_attrs_clear(&again);
	bake_attrs_parse(&attrs, text);
	bake_relief_meta_from_attrs(&meta, &attrs);

	/* what was understood is written so that it is understood again */
	bake_attrs_format(&attrs, line, sizeof line);
	bake_attrs_parse(&again, line);
	bake_attrs_format(&again, line_again, sizeof line_again);
	if (strcmp(line, line_again) != 0)
		abort();
	free(text);
	return 0;
}
