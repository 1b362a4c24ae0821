/* Digests of bytes, which tell whether two files hold the same. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_DIGEST_H
#define BAKE_DIGEST_H

#include <stddef.h>

#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A digest of 128 bits, the same for the same bytes on every machine: XXH3
 * with seed 0, in its canonical (big-endian) order. Of n different contents
 * two share one with probability n^2 / 2^129, as long as nobody means to: it is
 * no defence against contents that were made to collide.
 *
 * Source: Y. Collet, 'xxHash fast digest algorithm', XXH3_128bits.
 */
enum { BAKE_DIGEST_BYTES = 16, BAKE_DIGEST_TEXT = 23 };
struct bake_digest {
	unsigned char byte[BAKE_DIGEST_BYTES];
};

/* A digest in the making. */
struct bake_digester;

/* BAKE_ENOMEM  no memory; *digester is NULL then */
BAKE_API enum bake_status bake_digester_open(
    struct bake_digester **digester, struct bake_err *err);
/* The next n bytes. */
BAKE_API void bake_digester_add(
    struct bake_digester *digester, const void *bytes, size_t n);
/* The digest of all that was added; frees the digester. */
BAKE_API struct bake_digest bake_digester_end(struct bake_digester *digester);

/* The digest of n bytes in memory. Reentrant. */
BAKE_API struct bake_digest bake_digest_of(const void *bytes, size_t n);

/*
 * The digest of a regular file's content, read once in pieces.
 *
 * BAKE_EIO     it cannot be opened or read, or is no regular file (a pipe's
 *              bytes can be read only once, and are left to whoever needs
 *              them); err names it
 * BAKE_ENOMEM  no memory
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_digest_file(
    const char *path, struct bake_digest *digest, struct bake_err *err);

/* 22 characters of A-Z a-z 0-9 - _, six bits each, the first byte's highest
 * first (RFC 4648, 5), and a NUL. */
BAKE_API void bake_digest_text(
    const struct bake_digest *digest, char text[BAKE_DIGEST_TEXT]);

#ifdef __cplusplus
}
#endif

#endif
