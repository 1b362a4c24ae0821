/* Memory: sizes that are checked for overflow, and aligned arrays. */
/* SPDX-License-Identifier: MIT */
#include "mem.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

bool
bake_mul_size(size_t a, size_t b, size_t *product)
{
	size_t p;

	if (__builtin_mul_overflow(a, b, &p))
		return false;
	*product = p;
	return true;
}

void *
bake_alloc(size_t count, size_t size, struct bake_err *err)
{
	size_t bytes;
	void *p;

	if (!bake_mul_size(count, size, &bytes) ||
	    bytes > PTRDIFF_MAX - BAKE_ALIGN) {
		bake_fail(err, BAKE_ENOMEM,
		    "%zu elements of %zu bytes do not fit in memory", count,
		    size);
		return NULL;
	}
	/* aligned_alloc wants a multiple of the alignment, and not 0 */
	bytes = (bytes + BAKE_ALIGN) / BAKE_ALIGN * BAKE_ALIGN;
	p = aligned_alloc(BAKE_ALIGN, bytes);
	if (p == NULL)
		bake_fail(err, BAKE_ENOMEM, "no memory for %zu bytes", bytes);
	return p;
}

void *
bake_zalloc(size_t count, size_t size, struct bake_err *err)
{
	void *p = bake_alloc(count, size, err);

	if (p != NULL)
		memset(p, 0, count * size);
	return p;
}
