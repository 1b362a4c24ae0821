/* Output files that appear whole or not at all. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_OUTPUT_H
#define BAKE_OUTPUT_H

#include <stdbool.h>
#include <stdio.h>

#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A file being written beside its place. The data go to stream, which can
 * seek; bake_output_commit puts the whole file in its place with one rename,
 * so that nobody ever sees half of it and a file that was there stays as it
 * was until then. A process that is killed leaves nothing behind: the data
 * have no name until they are whole (O_TMPFILE; on a file system without it,
 * a hidden file beside the target).
 *
 * path "-" is standard output. That, and a target that exists and is no
 * regular file (a pipe, a device), is written directly, on commit. A symbolic
 * link is followed: what it points to is replaced, or made. An existing file
 * keeps its permission bits.
 */
struct bake_output {
	FILE *stream; /* write here */
	char *path;   /* as it was given, for messages */
	char *target; /* the real path; NULL for standard output */
	char *temp;   /* its hidden name, if it has one */
	bool direct;
};
#define BAKE_OUTPUT_INIT                                                       \
	{                                                                      \
		NULL, NULL, NULL, NULL, false                                  \
	}

/*
 * BAKE_EIO     the folder or the target cannot be written; err says why
 * BAKE_ENOMEM  no memory
 */
BAKE_API enum bake_status bake_output_open(
    struct bake_output *out, const char *path, struct bake_err *err);

/*
 * Finish: flush, check, rename. On failure the old file is as it was. In
 * either case the output is closed and *out is BAKE_OUTPUT_INIT again.
 *
 * BAKE_EIO  the data could not be written whole (no space …)
 */
BAKE_API enum bake_status bake_output_commit(
    struct bake_output *out, struct bake_err *err);

/* Drop what was written. Harmless on BAKE_OUTPUT_INIT. */
BAKE_API void bake_output_abort(struct bake_output *out);

#ifdef __cplusplus
}
#endif

#endif
