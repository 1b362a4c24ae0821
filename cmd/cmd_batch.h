/* Many files in one run: worker processes, their memory and their threads. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_BATCH_H
#define CMD_BATCH_H

#include "cmd.h"

/* A job: which one, and what the tool gave. Returns an exit status, having
 * printed the reason where it is not CMD_EXIT_OK. */
typedef int cmd_job_fn(struct cmd *cmd, int i, void *arg);

/*
 * Do a job for each of the names. Returns the exit status: the first that is
 * not CMD_EXIT_OK, the other jobs being done all the same and a last line
 * counting the failures.
 *
 * More than one name, or --isolate, is done in worker processes, one job at a
 * time in each, up to as many as there are threads: a job that crashes (a file
 * that a decoder cannot stand) is one failed line, and the start of the tool is
 * paid once. What a job prints to cmd->err and to standard output is held back
 * until the jobs before it are done, so that both read as if they had been run
 * one after another; so are the files that it notes as read and written.
 *
 * Threads and memory are granted to a job when it knows how large it is, by
 * cmd_claim; a small job outside a batch has one thread. --no-isolate, and a
 * job within a worker (--each), bakes in this process, one after another.
 */
int cmd_batch(
    struct cmd *cmd, const struct cmd_list *names, cmd_job_fn *job, void *arg);

/* The same for a tool that does one thing, named after its output. */
int cmd_one(struct cmd *cmd, cmd_job_fn *job, void *arg);

/*
 * Say how much memory a job will need at its peak, and wait for it: within
 * --memory for all jobs together. Sets cmd->nthreads. Called once a job, before
 * the first large allocation; what is asked later in the same job counts no
 * more. False where it is more than --memory allows, the reason printed; what
 * names the file.
 */
bool cmd_claim(struct cmd *cmd, const char *what, double bytes);

/* Between these a file's bytes are in the hands of a library: in a worker, a
 * crash is then told as one of reading. Its processor time is limited.
 * nbytes is the size of the file's content, as far as it is known. */
void cmd_decode_begin(const struct cmd *cmd, double nbytes);
void cmd_decode_end(const struct cmd *cmd);

/* In a worker, the share of its job goes to whoever shows it; false elsewhere.
 */
bool cmd_worker_progress(struct bake_progress *progress);

/* The memory that --memory allows: its argument, or three quarters of the
 * machine's (of the control group's, where that is less). */
double cmd_memory_limit(const struct cmd *cmd);

#endif
