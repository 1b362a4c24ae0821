/* The progress bar: on a terminal only, for work longer than a second. */
/* SPDX-License-Identifier: MIT */
#include "cmd_progress.h"

#include <time.h>
#include <unistd.h>

#include "cmd_batch.h"
#include "cmd_signal.h"

double
cmd_progress_now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* "3 s", "12 min", "2.5 h" */
static void
duration(double seconds, char text[32])
{
	if (seconds < 100)
		snprintf(text, 32, "%.0f s", seconds);
	else if (seconds < 6000)
		snprintf(text, 32, "%.0f min", seconds / 60);
	else
		snprintf(text, 32, "%.1f h", seconds / 3600);
}

/* Whether it is time to draw: after a second, ten times a second. */
static bool
is_due(struct cmd_progress *bar)
{
	double t = cmd_progress_now();

	if (!bar->shows || t - bar->started < 1 ||
	    t - bar->last < CMD_PROGRESS_SECONDS)
		return false;
	bar->last = t;
	return true;
}

static void
draw(struct cmd_progress *bar, double share, const char *more)
{
	enum { WIDTH = 30 };
	int filled = (int)(share * WIDTH);
	double spent = bar->last - bar->started;
	char left[32] = "";

	if (share > 0.01)
		duration(spent * (1 - share) / share, left);
	/* before: a signal may come as soon as it is drawn */
	cmd_signals_bar(fileno(bar->err));
	fprintf(bar->err, "\r[%-*.*s] %3d %%%s%s%s\033[K", WIDTH, filled,
	    "##############################", (int)(share * 100), more,
	    left[0] != '\0' ? ", left: " : "", left);
	fflush(bar->err);
	bar->drawn = true;
}

static void
report(void *arg, double done)
{
	struct cmd_progress *bar = arg;

	if (is_due(bar))
		draw(bar, done, "");
}

struct bake_progress
cmd_progress_start(const struct cmd *cmd, struct cmd_progress *bar)
{
	struct bake_progress progress = { NULL, NULL };

	*bar = (struct cmd_progress){ .err = cmd->err,
		.started = cmd_progress_now() };
	if (cmd_worker_progress(&progress))
		return progress;
	bar->shows = !cmd->quiet && isatty(fileno(cmd->err));
	if (bar->shows) {
		progress.report = report;
		progress.arg = bar;
	}
	return progress;
}

void
cmd_progress_files(struct cmd_progress *bar, double share, int done, int n)
{
	char text[80];

	if (!is_due(bar))
		return;
	snprintf(text, sizeof text, "  %d of %d, %.3g a second", done, n,
	    done / (bar->last - bar->started));
	draw(bar, share, text);
}

void
cmd_progress_erase(struct cmd_progress *bar)
{
	if (!bar->drawn)
		return;
	fputs("\r\033[K", bar->err);
	fflush(bar->err);
	bar->drawn = false;
	cmd_signals_bar(-1);
}

void
cmd_progress_end(struct cmd_progress *bar)
{
	cmd_progress_erase(bar);
}
