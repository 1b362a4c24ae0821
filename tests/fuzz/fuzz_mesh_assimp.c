/* Fuzz target: a line with an extension, then any bytes as a file of it. */
/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "fuzz_mesh.h"

enum { EXTENSION = 15 };

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	static const char *const ours[] = { "obj", "ply", "gltf", "glb" };
	const uint8_t *end = size > 0 ? memchr(bytes, '\n', size) : NULL;
	char name[2 + EXTENSION + 1];
	size_t n;

	if (end == NULL || end - bytes > EXTENSION)
		return -1;
	n = (size_t)(end - bytes);
	snprintf(name, sizeof name, "x.%.*s", (int)n, (const char *)bytes);
	for (size_t i = 0; i < sizeof ours / sizeof *ours; i++)
		if (strcasecmp(name + 2, ours[i]) == 0)
			return -1; /* with targets of their own */
	fuzz_note(name, "");
	fuzz_mesh(end + 1, size - n - 1, name, false);
	return 0;
}
