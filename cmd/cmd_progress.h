/* The progress bar: on a terminal only, for work longer than a second. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_PROGRESS_H
#define CMD_PROGRESS_H

#include <stdbool.h>
#include <stdio.h>

#include "parallel.h"

struct cmd;

/* The bar is drawn anew, and told what is new, as seldom as this. */
#define CMD_PROGRESS_SECONDS 0.1

struct cmd_progress {
	FILE *err;
	bool shows; /* whether there is a terminal to see it */
	bool drawn;
	double started, last; /* seconds */
};

/* Seconds of a clock that is never set. */
double cmd_progress_now(void);

/* What a bake reports to; in a worker of a batch, the batch. */
struct bake_progress cmd_progress_start(
    const struct cmd *cmd, struct cmd_progress *bar);
/* The share of all work that is done, and how many files of n, with their rate
 * and the time left. */
void cmd_progress_files(
    struct cmd_progress *bar, double share, int done, int n);
/* Off the line, for another text to be there. */
void cmd_progress_erase(struct cmd_progress *bar);
void cmd_progress_end(struct cmd_progress *bar);

#endif
