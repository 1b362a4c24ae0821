/* Memory: sizes that are checked for overflow, and aligned arrays. */
/* SPDX-License-Identifier: MIT */
#include "mem.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/*
 * Each page that is touched for the first time costs a fault of the system,
 * which for much of this library's work is as much as the work itself, and
 * memory in 4 KB pages is slow to find where it is read in any order. So arrays
 * of at least one large page begin on one, and ask for them, where the system
 * has them on request; the last may be in part beyond the array, but not for
 * more than an eighth of it.
 */
enum { LARGE_PAGE = 1 << 21 };

bool
bake_mul_size(size_t a, size_t b, size_t *product)
{
	size_t p;

	if (__builtin_mul_overflow(a, b, &p))
		return false;
	*product = p;
	return true;
}

/* bytes, above LARGE_PAGE, a multiple of BAKE_ALIGN: on large pages as far as
 * that is possible. */
static void *
alloc_large(size_t bytes)
{
#ifdef MADV_HUGEPAGE
	const size_t page = LARGE_PAGE;
	size_t all = (bytes + page - 1) / page * page;
	void *p = aligned_alloc(page, all);

	/* a wish: it does not matter whether it is granted */
	if (p != NULL)
		(void)madvise(p, all - bytes <= bytes / 8 ? all : all - page,
		    MADV_HUGEPAGE);
	return p;
#else
	return aligned_alloc(BAKE_ALIGN, bytes);
#endif
}

void *
bake_alloc(size_t count, size_t size, struct bake_err *err)
{
	size_t bytes;
	void *p;

	if (!bake_mul_size(count, size, &bytes) ||
	    bytes > PTRDIFF_MAX - LARGE_PAGE) {
		bake_fail(err, BAKE_ENOMEM,
		    "%zu elements of %zu bytes do not fit in memory", count,
		    size);
		return NULL;
	}
	/* aligned_alloc wants a multiple of the alignment, and not 0 */
	bytes = (bytes + BAKE_ALIGN) / BAKE_ALIGN * BAKE_ALIGN;
	p = bytes > LARGE_PAGE ? alloc_large(bytes)
			       : aligned_alloc(BAKE_ALIGN, bytes);
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
