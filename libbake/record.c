/* The record in an output of what it was made of, and its seal. */
/* SPDX-License-Identifier: MIT */
#include "record.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "mem.h"

static const char mark[] = "rm1:", list_mark[] = "files:|", list_end[] = "|!";

/* Pieces overlap, so that no text is cut. */
enum { PIECE = 1 << 18, OVERLAP = BAKE_RECORD_LIST + BAKE_RECORD_TEXT };

/* A file that is looked through. */
struct look {
	int fd;
	const char *name; /* for messages */
	off_t size;
	char *piece; /* PIECE + OVERLAP bytes */
};

static bool
is_digit(char c)
{
	return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
	       (c >= '0' && c <= '9') || c == '-' || c == '_';
}

static bool
is_item(char c)
{
	return is_digit(c) || (c != '\0' && strchr("./+%=,|", c) != NULL);
}

void
bake_record_text(const struct bake_digest *digest, char text[BAKE_RECORD_TEXT])
{
	char d[BAKE_DIGEST_TEXT];

	bake_digest_text(digest, d);
	snprintf(text, BAKE_RECORD_TEXT, "%s%s:AAAAAAAAAAA", mark, d);
}

/* -- looking ----------------------------------------------------------- */

/* n bytes from `at` on, all of them. */
static enum bake_status
get(const struct look *l, off_t at, void *bytes, size_t n, struct bake_err *err)
{
	for (size_t done = 0; done < n;) {
		ssize_t k = pread(
		    l->fd, (char *)bytes + done, n - done, at + (off_t)done);

		if (k > 0)
			done += (size_t)k;
		else if (k == 0 || errno != EINTR)
			return bake_fail(err, BAKE_EIO, "%s: %s", l->name,
			    k == 0 ? "became shorter while it was read"
				   : strerror(errno));
	}
	return BAKE_OK;
}

/* How long the record is that bytes begin with; 0: none. */
static size_t
record_length(const char *bytes, size_t n)
{
	const size_t colon = sizeof mark - 1 + BAKE_DIGEST_TEXT - 1;

	if (n < BAKE_RECORD_TEXT - 1 || bytes[colon] != ':')
		return 0;
	for (size_t i = sizeof mark - 1; i < BAKE_RECORD_TEXT - 1; i++)
		if (i != colon && !is_digit(bytes[i]))
			return 0;
	return BAKE_RECORD_TEXT - 1;
}

/* The same for a list. */
static size_t
list_length(const char *bytes, size_t n)
{
	size_t i = sizeof list_mark - 1;

	while (i < n && i < BAKE_RECORD_LIST - 2 && is_item(bytes[i]))
		i++;
	return i < n && bytes[i] == list_end[1] && bytes[i - 1] == list_end[0]
		   ? i + 1
		   : 0;
}

/* The first text in n bytes that begins with a mark and is whole; at: out. */
static size_t
find(const char *bytes, size_t n, const char *what,
    size_t (*length)(const char *, size_t), size_t *at)
{
	const size_t nwhat = strlen(what);

	for (size_t i = 0; i + nwhat <= n; i++) {
		const char *p = memmem(bytes + i, n - i, what, nwhat);
		size_t len;

		if (p == NULL)
			return 0;
		i = (size_t)(p - bytes);
		*at = i;
		if ((len = length(p, n - i)) > 0)
			return len;
	}
	return 0;
}

/* Where text stands; -1: nowhere. With text NULL the first record, which is
 * then in record; list as well. */
static enum bake_status
look_through(const struct look *l, const char *text, off_t *where,
    struct bake_record *record, struct bake_err *err)
{
	enum bake_status rc;
	off_t from = 0;

	*where = -1;
	while (from < l->size) {
		size_t left = (size_t)(l->size - from), at, len;
		size_t n = left < PIECE + OVERLAP ? left : PIECE + OVERLAP;
		const char *p;

		if ((rc = get(l, from, l->piece, n, err)) != BAKE_OK)
			return rc;
		if (text != NULL) {
			p = memmem(l->piece, n, text, strlen(text));
			if (p != NULL) {
				*where = from + (p - l->piece);
				return BAKE_OK;
			}
		} else if (*where < 0 &&
			   find(l->piece, n, mark, record_length, &at) > 0) {
			*where = from + (off_t)at;
			memcpy(record->digest, l->piece + at + sizeof mark - 1,
			    BAKE_DIGEST_TEXT - 1);
		}
		if (text == NULL && record->list[0] == '\0' &&
		    (len = find(l->piece, n, list_mark, list_length, &at)) > 0)
			memcpy(record->list, l->piece + at, len);
		from += n < PIECE ? (off_t)n : PIECE;
	}
	return BAKE_OK;
}

/* -- PNG ------------------------------------------------------------------- */

static uint32_t
big_endian(const unsigned char *b)
{
	return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 |
	       (uint32_t)b[2] << 8 | b[3];
}

/* A chunk: its type and data from `start` on, its check sum at `sum`. */
struct chunk {
	off_t start, sum;
};

/* The chunk of a PNG file that a place is in; sum is -1 where it is none. */
static enum bake_status
find_chunk(
    const struct look *l, off_t place, struct chunk *c, struct bake_err *err)
{
	static const unsigned char png[8] = { 0x89, 'P', 'N', 'G', '\r', '\n',
		0x1a, '\n' };
	unsigned char head[8];
	enum bake_status rc;
	off_t at = sizeof png;

	c->sum = -1;
	if (l->size < (off_t)sizeof png)
		return BAKE_OK;
	if ((rc = get(l, 0, head, sizeof png, err)) != BAKE_OK ||
	    memcmp(head, png, sizeof png) != 0)
		return rc;
	while (at + 12 <= l->size && at < place) {
		if ((rc = get(l, at, head, sizeof head, err)) != BAKE_OK)
			return rc;
		c->start = at + 4;
		at += 8 + (off_t)big_endian(head);
		if (at > place && at + 4 <= l->size)
			c->sum = at;
		at += 4;
	}
	return BAKE_OK;
}

/* CRC-32 of ISO 3309 as PNG has it (W3C 'PNG', annex D), bit by bit: a chunk of
 * text is short. */
static uint32_t
crc(uint32_t sum, const char *bytes, size_t n)
{
	for (size_t i = 0; i < n; i++) {
		sum ^= (unsigned char)bytes[i];
		for (int k = 0; k < 8; k++)
			sum = sum >> 1 ^ (sum & 1 ? 0xedb88320U : 0);
	}
	return sum;
}

static enum bake_status
chunk_sum(const struct look *l, const struct chunk *c, unsigned char sum[4],
    struct bake_err *err)
{
	uint32_t s = 0xffffffffU;
	enum bake_status rc;

	for (off_t at = c->start; at < c->sum; at += PIECE) {
		size_t left = (size_t)(c->sum - at);
		size_t n = left < PIECE ? left : PIECE;

		if ((rc = get(l, at, l->piece, n, err)) != BAKE_OK)
			return rc;
		s = crc(s, l->piece, n);
	}
	s = ~s;
	for (int i = 0; i < 4; i++)
		sum[i] = (unsigned char)(s >> (24 - 8 * i));
	return BAKE_OK;
}

/* -- seals ----------------------------------------------------------------- */

/* Zero what of the hole [at, at + len) lies in the piece. */
static void
blank(char *piece, off_t from, size_t n, off_t at, size_t len)
{
	for (size_t i = 0; i < len; i++) {
		off_t k = at + (off_t)i - from;

		if (k >= 0 && k < (off_t)n)
			piece[k] = 0;
	}
}

static enum bake_status
seal_of(const struct look *l, off_t seal, const struct chunk *c,
    char text[BAKE_DIGEST_TEXT], struct bake_err *err)
{
	struct bake_digester *d;
	struct bake_digest digest;
	enum bake_status rc = bake_digester_open(&d, err);

	if (rc != BAKE_OK)
		return rc;
	for (off_t from = 0; from < l->size && rc == BAKE_OK; from += PIECE) {
		size_t left = (size_t)(l->size - from);
		size_t n = left < PIECE ? left : PIECE;

		rc = get(l, from, l->piece, n, err);
		if (rc != BAKE_OK)
			break;
		blank(l->piece, from, n, seal, BAKE_RECORD_SEAL);
		if (c->sum >= 0)
			blank(l->piece, from, n, c->sum, 4);
		bake_digester_add(d, l->piece, n);
	}
	digest = bake_digester_end(d);
	bake_digest_text(&digest, text);
	return rc;
}

/* n bytes to a place in the file. */
static enum bake_status
put(const struct look *l, off_t at, const void *bytes, size_t n,
    struct bake_err *err)
{
	for (size_t done = 0; done < n;) {
		ssize_t k = pwrite(l->fd, (const char *)bytes + done, n - done,
		    at + (off_t)done);

		if (k > 0)
			done += (size_t)k;
		else if (k == 0 || errno != EINTR)
			return bake_fail(err, BAKE_EIO, "%s: %s", l->name,
			    k == 0 ? "cannot be written" : strerror(errno));
	}
	return BAKE_OK;
}

static enum bake_status
seal(const struct look *l, const char *text, struct bake_err *err)
{
	char digest[BAKE_DIGEST_TEXT];
	unsigned char sum[4];
	struct chunk c;
	off_t at;
	enum bake_status rc = look_through(l, text, &at, NULL, err);

	if (rc != BAKE_OK || at < 0)
		return rc;
	at += BAKE_RECORD_TEXT - 1 - BAKE_RECORD_SEAL;
	if ((rc = find_chunk(l, at, &c, err)) == BAKE_OK &&
	    (rc = seal_of(l, at, &c, digest, err)) == BAKE_OK)
		rc = put(l, at, digest, BAKE_RECORD_SEAL, err);
	if (rc == BAKE_OK && c.sum >= 0 &&
	    (rc = chunk_sum(l, &c, sum, err)) == BAKE_OK)
		rc = put(l, c.sum, sum, sizeof sum, err);
	return rc;
}

enum bake_status
bake_record_seal(FILE *stream, const char *text, struct bake_err *err)
{
	struct look l = { .name = "the file that is written" };
	enum bake_status rc;

	if (fflush(stream) != 0 || fseeko(stream, 0, SEEK_END) != 0 ||
	    (l.size = ftello(stream)) < 0)
		return bake_fail(
		    err, BAKE_EIO, "%s: %s", l.name, strerror(errno));
	l.fd = fileno(stream);
	l.piece = bake_alloc(PIECE + OVERLAP, 1, err);
	if (l.piece == NULL)
		return BAKE_ENOMEM;
	rc = seal(&l, text, err);
	free(l.piece);
	return rc;
}

static enum bake_status
check(const struct look *l, struct bake_record *record, struct bake_err *err)
{
	char digest[BAKE_DIGEST_TEXT], own[BAKE_RECORD_SEAL];
	unsigned char sum[4], own_sum[4];
	struct chunk c;
	off_t at;
	enum bake_status rc = look_through(l, NULL, &at, record, err);

	if (rc != BAKE_OK || at < 0)
		return rc;
	at += BAKE_RECORD_TEXT - 1 - BAKE_RECORD_SEAL;
	if ((rc = get(l, at, own, sizeof own, err)) != BAKE_OK ||
	    (rc = find_chunk(l, at, &c, err)) != BAKE_OK ||
	    (rc = seal_of(l, at, &c, digest, err)) != BAKE_OK)
		return rc;
	record->whole = memcmp(own, digest, sizeof own) == 0;
	/* the seal does not cover the check sum */
	if (record->whole && c.sum >= 0 &&
	    (rc = chunk_sum(l, &c, sum, err)) == BAKE_OK &&
	    (rc = get(l, c.sum, own_sum, sizeof own_sum, err)) == BAKE_OK)
		record->whole = memcmp(sum, own_sum, sizeof sum) == 0;
	return rc;
}

enum bake_status
bake_record_read(
    const char *path, struct bake_record *record, struct bake_err *err)
{
	struct look l = { .name = path };
	enum bake_status rc = BAKE_ENOMEM;
	struct stat st;

	memset(record, 0, sizeof *record);
	if (stat(path, &st) != 0)
		return bake_fail(
		    err, BAKE_EIO, "%s: %s", path, strerror(errno));
	if (!S_ISREG(st.st_mode))
		return bake_fail(err, BAKE_EIO, "%s: is no regular file", path);
	l.fd = open(path, O_RDONLY | O_CLOEXEC);
	if (l.fd < 0)
		return bake_fail(
		    err, BAKE_EIO, "%s: %s", path, strerror(errno));
	l.size = st.st_size;
	l.piece = bake_alloc(PIECE + OVERLAP, 1, err);
	if (l.piece != NULL)
		rc = check(&l, record, err);
	free(l.piece);
	close(l.fd);
	return rc;
}
