/* Memory: sizes that are checked for overflow, and aligned arrays. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MEM_H
#define BAKE_MEM_H

#include <stdbool.h>
#include <stddef.h>

#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Alignment of every array from bake_alloc, in bytes: one cache line, one
 * AVX-512 register. */
enum { BAKE_ALIGN = 64 };

/*
 * *product = a * b. Returns false, and leaves *product alone, where the
 * product does not fit. Reentrant.
 */
BAKE_API bool bake_mul_size(size_t a, size_t b, size_t *product);

/*
 * An array of count elements of size bytes each, aligned to BAKE_ALIGN, its
 * contents unspecified (bake_zalloc: all zero bits). count * size = 0 gives a
 * valid pointer. The caller frees it with free().
 *
 * Returns NULL and sets err (BAKE_ENOMEM) where the product overflows or the
 * system has no memory. Reentrant.
 */
BAKE_API void *bake_alloc(size_t count, size_t size, struct bake_err *err);
BAKE_API void *bake_zalloc(size_t count, size_t size, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
