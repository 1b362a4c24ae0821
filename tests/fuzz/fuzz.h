/* What the fuzz targets share: more to be guided by than edges of our code. */
/* SPDX-License-Identifier: MIT */
#ifndef FUZZ_H
#define FUZZ_H

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/*
 * The image and mesh libraries are not instrumented: what they make of an
 * input is seen by what they say. Every different text counts as a feature of
 * its own, digits and quoted names apart; libFuzzer keeps inputs with new ones.
 */
enum { FUZZ_NOTES = 1 << 12 };

__attribute__((section("__libfuzzer_extra_counters"), used)) //
static uint8_t fuzz_notes[FUZZ_NOTES];

static inline void
fuzz_note(const char *kind, const char *text)
{
	uint32_t h = 2166136261u;
	int quotes = 0;

	for (const char *p = kind; *p != '\0'; p++)
		h = (h ^ (uint8_t)*p) * 16777619u;
	for (const char *p = text; *p != '\0'; p++) {
		quotes += *p == '\'' || *p == '"';
		if (quotes % 2 == 0 && (*p < '0' || *p > '9'))
			h = (h ^ (uint8_t)*p) * 16777619u;
	}
	fuzz_notes[(h ^ h >> 16) % FUZZ_NOTES] = 1;
}

#endif
