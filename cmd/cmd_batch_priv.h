/* What the two ends of a batch say to each other. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_BATCH_PRIV_H
#define CMD_BATCH_PRIV_H

#include "cmd_batch.h"

enum message_kind {
	/* to a worker */
	MESSAGE_JOB,   /* number: which; nthreads: to begin with */
	MESSAGE_GRANT, /* nthreads; number: 0 means refused */
	/* from a worker */
	MESSAGE_CLAIM,    /* value: bytes */
	MESSAGE_DECODING, /* number: whether it is, from now on */
	MESSAGE_PROGRESS, /* value: share of the job */
	MESSAGE_READ,     /* text: a file that was read */
	MESSAGE_WRITTEN,  /* text */
	MESSAGE_DONE      /* number: the exit status */
};

/* Followed by ntext bytes of text, which are no string. */
struct message {
	enum message_kind kind;
	int number, nthreads, ntext;
	double value;
};

/* Whole or not at all: false where the other end is gone. */
bool message_send(int fd, const struct message *m, const char *text);
/* text: room for a path, ended by a NUL. */
enum { MESSAGE_TEXT = 8192 };
bool message_receive(int fd, struct message *m, char text[MESSAGE_TEXT]);

/* What a worker process is given. */
struct worker_ends {
	int channel;  /* messages */
	int out, err; /* where its standard output and its messages go */
};

/* Do jobs until the channel ends; never returns. */
_Noreturn void cmd_worker_run(struct cmd *cmd, const struct worker_ends *ends,
    cmd_job_fn *job, void *arg);

/* Whether this process is a worker, and how many threads its job has now. */
bool cmd_is_worker(void);
int cmd_worker_threads(void);

/* Do the tool's work once for each name of --each; the exit status. */
int cmd_run_each(struct cmd *cmd);

#endif
