/* Digests of bytes: the only module that knows xxHash. */
/* SPDX-License-Identifier: MIT */
#include "digest.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "mem.h"

enum { PIECE = 1 << 18 };

static struct bake_digest
canonical(XXH128_hash_t hash)
{
	XXH128_canonical_t c;
	struct bake_digest d;

	XXH128_canonicalFromHash(&c, hash);
	memcpy(d.byte, c.digest, sizeof d.byte);
	return d;
}

enum bake_status
bake_digester_open(struct bake_digester **digester, struct bake_err *err)
{
	XXH3_state_t *state = XXH3_createState();

	*digester = (struct bake_digester *)state;
	if (state == NULL)
		return bake_fail(err, BAKE_ENOMEM, "no memory");
	XXH3_128bits_reset(state);
	return BAKE_OK;
}

void
bake_digester_add(struct bake_digester *digester, const void *bytes, size_t n)
{
	if (n > 0)
		XXH3_128bits_update((XXH3_state_t *)digester, bytes, n);
}

struct bake_digest
bake_digester_end(struct bake_digester *digester)
{
	XXH3_state_t *state = (XXH3_state_t *)digester;
	struct bake_digest d = canonical(XXH3_128bits_digest(state));

	XXH3_freeState(state);
	return d;
}

struct bake_digest
bake_digest_of(const void *bytes, size_t n)
{
	return canonical(XXH3_128bits(bytes, n));
}

static enum bake_status
add_file(struct bake_digester *d, int fd, const char *path, char *piece,
    struct bake_err *err)
{
	ssize_t n;

	while ((n = read(fd, piece, PIECE)) != 0) {
		if (n > 0)
			bake_digester_add(d, piece, (size_t)n);
		else if (errno != EINTR)
			return bake_fail(
			    err, BAKE_EIO, "%s: %s", path, strerror(errno));
	}
	return BAKE_OK;
}

enum bake_status
bake_digest_file(
    const char *path, struct bake_digest *digest, struct bake_err *err)
{
	struct bake_digester *d = NULL;
	enum bake_status rc = BAKE_ENOMEM;
	struct stat st;
	char *piece;
	int fd;

	/* to open a pipe would wait for its writer */
	if (stat(path, &st) != 0)
		return bake_fail(
		    err, BAKE_EIO, "%s: %s", path, strerror(errno));
	if (!S_ISREG(st.st_mode))
		return bake_fail(err, BAKE_EIO, "%s: is no regular file", path);
	fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return bake_fail(
		    err, BAKE_EIO, "%s: %s", path, strerror(errno));
	piece = bake_alloc(PIECE, 1, err);
	if (piece != NULL && (rc = bake_digester_open(&d, err)) == BAKE_OK)
		rc = add_file(d, fd, path, piece, err);
	if (d != NULL)
		*digest = bake_digester_end(d);
	free(piece);
	close(fd);
	return rc;
}

void
bake_digest_text(const struct bake_digest *digest, char text[BAKE_DIGEST_TEXT])
{
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
				     "abcdefghijklmnopqrstuvwxyz0123456789-_";
	unsigned bits = 0;
	int nbits = 0;

	for (int i = 0; i < BAKE_DIGEST_BYTES; i++) {
		bits = bits << 8 | digest->byte[i];
		for (nbits += 8; nbits >= 6; nbits -= 6)
			*text++ = digits[bits >> (nbits - 6) & 63];
	}
	/* two bits are left */
	*text++ = digits[bits << (6 - nbits) & 63];
	*text = '\0';
}
