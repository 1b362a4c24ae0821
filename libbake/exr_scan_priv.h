/* A look at an EXR file's headers before the EXR library believes them. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_EXR_SCAN_PRIV_H
#define BAKE_EXR_SCAN_PRIV_H

#include <stdbool.h>
#include <stddef.h>

#include "io_image.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { BAKE_EXR_PARTS = 1024 };

/* A file's bytes. read copies those from `at` on: false where they end before,
 * or cannot be read. */
struct bake_exr_source {
	void *context;
	size_t size;
	bool (*read)(void *context, size_t at, void *bytes, size_t n);
};

/*
 * Walk over the headers, whose sizes the library would allocate as they say.
 *
 * BAKE_EDATA   no EXR file; an attribute longer than the file, or of another
 *              size than its type has; a window or tiles whose table of chunks
 *              the file has no room for
 * BAKE_ELIMIT  more texels than the limits; more than BAKE_EXR_PARTS parts
 *
 * Source: 'OpenEXR File Layout', openexr.com, sections 'Header' and 'Offset
 * Tables'.
 */
enum bake_status bake_exr_scan(const struct bake_exr_source *source,
    const struct bake_read_limits *limits, const char *name,
    struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
