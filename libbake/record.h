/* The record in an output of what it was made of, and its seal. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_RECORD_H
#define BAKE_RECORD_H

#include <stdbool.h>
#include <stdio.h>

#include "attrs.h"
#include "digest.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A record is a text that stands in an output file as it is, whatever the
 * file's format: an attribute of an image, a comment, a string of JSON.
 *     rm1:DDDDDDDDDDDDDDDDDDDDDD:SSSSSSSSSSS
 * D are the 22 characters of the digest of what the output was made of
 * (bake_digest_text); S the seal, the first 11 characters of the digest of the
 * file itself, with the seal (and in a PNG file the check sum of the chunk that
 * it is in) as zero bytes. So a file that was cut, damaged or edited is told
 * from one that is as it was written. A second text beside it, with the same
 * fate in all formats, lists what the record depends on:
 *     files:|ITEM|ITEM|!
 * with items of the characters A-Z a-z 0-9 . _ / + - % = , only. Each text is
 * looked for anywhere in the file; the first that is whole counts.
 */
enum {
	BAKE_RECORD_SEAL = 11,
	BAKE_RECORD_TEXT = 4 + BAKE_DIGEST_TEXT + BAKE_RECORD_SEAL + 1,
	BAKE_RECORD_LIST = BAKE_ATTR_VALUE
};

/* The text of a record that is not sealed yet: its seal is eleven 'A's. */
BAKE_API void bake_record_text(
    const struct bake_digest *digest, char text[BAKE_RECORD_TEXT]);

/*
 * Seal what was written to a stream (that can be read, as bake_output's can):
 * text, which must be in it, gets its seal in place. Where the stream does not
 * hold it (a format that had no room) nothing happens. The stream then stands
 * at its end.
 *
 * BAKE_EIO     the stream cannot be read or written
 * BAKE_ENOMEM  no memory
 */
BAKE_API enum bake_status bake_record_seal(
    FILE *stream, const char *text, struct bake_err *err);

/* What a file says. Plain data. */
struct bake_record {
	char digest[BAKE_DIGEST_TEXT]; /* "" where there is no record */
	bool whole;                    /* the seal is the file's */
	char list[BAKE_RECORD_LIST];   /* "" where there is none */
};

/*
 * Read a file's record and check its seal; the file is read twice, from start
 * to end, in pieces.
 *
 * BAKE_EIO     it cannot be opened or read, or is no regular file
 * BAKE_ENOMEM  no memory
 */
BAKE_API enum bake_status bake_record_read(
    const char *path, struct bake_record *record, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
