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
 * have no name until they are whole (O_TMPFILE). On a file system without that
 * (NFS) they are in a file beside the target whose name is gone as soon as it
 * is open, and bake_output_commit copies them: for that time there is room
 * taken twice, and SIGKILL then, or between link and rename where an old file
 * is replaced, leaves a hidden .NAME.XXXXXX.
 *
 * Signals are held back from the thread that commits while a hidden name is
 * there. In a process of several threads a handler should end it from that
 * thread only (cmd_signal.h in the sources shows how): otherwise the system may
 * choose another thread to die in.
 *
 * path "-" is standard output. That, and a target that exists and is no
 * regular file (a pipe, a device), is written directly, on commit. A symbolic
 * link is followed: what it points to is replaced, or made. An existing file
 * keeps its permission bits.
 *
 * No fsync, as with compilers and other tools of a build: what is lost with the
 * power is made again, and to wait for the disk costs more than a small bake.
 * But a file system may then hold a new name and no data, which make takes for
 * done; who must rule that out sets BAKE_FSYNC=1 in the environment: the data
 * are on the disk before they have their name, and the name is when the
 * function returns.
 */
struct bake_output {
	FILE *stream; /* write here */
	char *path;   /* as it was given, for messages */
	char *target; /* the real path; NULL for standard output */
	char *temp;   /* its hidden name, if it has one */
	bool direct;  /* copied to its target on commit */
	bool copies;  /* has lost its name, and is copied beside it */
};
#define BAKE_OUTPUT_INIT                                                       \
	{                                                                      \
		NULL, NULL, NULL, NULL, false, false                           \
	}

/*
 * BAKE_EIO     the folder or the target cannot be written; err says why
 * BAKE_ENOMEM  no memory
 */
BAKE_API enum bake_status bake_output_open(
    struct bake_output *out, const char *path, struct bake_err *err);

/*
 * Finish: flush, check, rename. On failure the old file is as it was (but
 * where it is only the fsync of the folder that fails: then the new one is
 * there). In either case the output is closed and *out is BAKE_OUTPUT_INIT
 * again.
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
