/* A worker process of a batch: one job after another, as it is told. */
/* SPDX-License-Identifier: MIT */
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <unistd.h>

#include "cmd_batch_priv.h"
#include "cmd_signal.h"

/* This process's part in a batch. A process is a worker from its fork to its
 * end, so there is one. */
static struct {
	bool is;
	int channel;
	bool claimed; /* in this job */
	int nthreads; /* of it */
	double told;  /* when the batch was told how far the job is */
} worker;

bool
cmd_is_worker(void)
{
	return worker.is;
}

int
cmd_worker_threads(void)
{
	return worker.nthreads;
}

static void
tell(enum message_kind kind, int number, double value, const char *text)
{
	struct message m = { .kind = kind, .number = number, .value = value };

	if (text != NULL)
		m.ntext = (int)strnlen(text, MESSAGE_TEXT - 1);
	/* where nobody listens any more there is nobody to work for */
	if (!message_send(worker.channel, &m, text))
		_exit(CMD_EXIT_FAIL);
}

/* -- memory ---------------------------------------------------------------- */

static double
limit_of_group(void)
{
	FILE *fp = fopen("/sys/fs/cgroup/memory.max", "re");
	double bytes = 0;

	if (fp == NULL)
		return 0;
	if (fscanf(fp, "%lf", &bytes) != 1) /* "max": no limit */
		bytes = 0;
	fclose(fp);
	return bytes;
}

double
cmd_memory_limit(const struct cmd *cmd)
{
	double machine =
	    (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
	double group = limit_of_group();

	if (cmd->memory > 0)
		return cmd->memory;
	return 0.75 * (group > 0 && group < machine ? group : machine);
}

static bool
refuse(struct cmd *cmd, const char *what, double bytes)
{
	cmd_error(cmd,
	    "%s: needs about %.3g MB of memory, more than the %.3g MB that "
	    "are allowed; --memory sets it",
	    what, bytes / 1e6, cmd_memory_limit(cmd) / 1e6);
	return false;
}

bool
cmd_claim(struct cmd *cmd, const char *what, double bytes)
{
	char text[MESSAGE_TEXT];
	struct message m;

	if (!worker.is) {
		/* threads wait for each other longer than they work */
		if (cmd->nthreads == 0 && bytes < 16e6)
			cmd->nthreads = 1;
		return cmd->memory == 0 || bytes <= cmd->memory ||
		       refuse(cmd, what, bytes);
	}
	if (worker.claimed)
		return true;
	worker.claimed = true;
	tell(MESSAGE_CLAIM, 0, bytes, NULL);
	if (!message_receive(worker.channel, &m, text))
		_exit(CMD_EXIT_FAIL);
	if (m.number == 0)
		return refuse(cmd, what, bytes);
	cmd->nthreads = worker.nthreads = m.nthreads;
	return true;
}

/* No more address space than what is there now and what a job may be granted,
 * with room for the heaps and stacks of its threads: a decoder that asks for
 * all there is gets an error and not the whole machine. */
static void
limit_memory(const struct cmd *cmd, int nthreads)
{
	FILE *fp = fopen("/proc/self/statm", "re");
	double pages = 0, bytes;
	struct rlimit lim;

	if (fp == NULL)
		return;
	if (fscanf(fp, "%lf", &pages) == 1 && getrlimit(RLIMIT_AS, &lim) == 0) {
		bytes = pages * (double)sysconf(_SC_PAGESIZE) + 1e9 +
			160e6 * nthreads +
			(cmd->memory > 0 ? 1 : 4. / 3) * cmd_memory_limit(cmd);
		if (lim.rlim_max == RLIM_INFINITY ||
		    bytes < (double)lim.rlim_max) {
			lim.rlim_cur = (rlim_t)bytes;
			setrlimit(RLIMIT_AS, &lim);
		}
	}
	fclose(fp);
}

/* -- decoding ---------------------------------------------------------------
 */

/* What the process was allowed before a decoder was limited. */
static struct rlimit allowed;

static void
limit_seconds(double more)
{
	struct rlimit lim;
	struct rusage use;

	if (getrlimit(RLIMIT_CPU, &allowed) != 0 ||
	    getrusage(RUSAGE_SELF, &use) != 0)
		return;
	lim = allowed;
	more += (double)(use.ru_utime.tv_sec + use.ru_stime.tv_sec) + 1;
	if (allowed.rlim_cur == RLIM_INFINITY ||
	    more < (double)allowed.rlim_cur)
		lim.rlim_cur = (rlim_t)more;
	setrlimit(RLIMIT_CPU, &lim);
}

static void
give_up(int sig)
{
	(void)sig;
	cmd_die("reading a file took too long and was given up: is it broken?");
}

void
cmd_decode_begin(const struct cmd *cmd, double nbytes)
{
	(void)cmd;
	/* the slowest of decoders write a megabyte a second */
	limit_seconds(60 + nbytes / 1e6);
	/* a worker dies of it, and the batch tells */
	signal(SIGXCPU, worker.is ? SIG_DFL : give_up);
	if (worker.is)
		tell(MESSAGE_DECODING, 1, 0, NULL);
}

void
cmd_decode_end(const struct cmd *cmd)
{
	(void)cmd;
	setrlimit(RLIMIT_CPU, &allowed);
	signal(SIGXCPU, SIG_DFL);
	if (worker.is)
		tell(MESSAGE_DECODING, 0, 0, NULL);
}

/* -- progress ---------------------------------------------------------------
 */

/* As often as a bar is drawn: a message costs as much as a bake of some
 * thousand texels. */
static void
report(void *arg, double done)
{
	double *told = arg, t = cmd_progress_now();

	if (t < *told + CMD_PROGRESS_SECONDS)
		return;
	*told = t;
	tell(MESSAGE_PROGRESS, 0, done, NULL);
}

bool
cmd_worker_progress(struct bake_progress *progress)
{
	if (!worker.is)
		return false;
	progress->report = report;
	progress->arg = &worker.told;
	return true;
}

/* -- jobs --------------------------------------------------------------------
 */

/* Die with the batch, leave no core behind, and speak into its ears. */
static void
settle(struct cmd *cmd, const struct worker_ends *ends)
{
	struct rlimit none = { 0, 0 };
	int err = dup(ends->err);

	worker.is = true;
	worker.channel = ends->channel;
	cmd_signals_start();
#ifdef __linux__
	prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
	setrlimit(RLIMIT_CORE, &none);
	dup2(ends->out, STDOUT_FILENO);
	cmd->err = err >= 0 ? fdopen(err, "w") : NULL;
	if (cmd->err == NULL)
		_exit(CMD_EXIT_FAIL);
	cmd_signals_speak(fileno(cmd->err));
}

/* Tell the texts of a list that were added in the job, and forget them. */
static void
tell_list(enum message_kind kind, struct cmd_list *list, int from)
{
	for (int i = from; i < list->n; i++)
		tell(kind, 0, 0, list->item[i]);
	cmd_list_cut(list, from);
}

_Noreturn void
cmd_worker_run(
    struct cmd *cmd, const struct worker_ends *ends, cmd_job_fn *job, void *arg)
{
	char text[MESSAGE_TEXT];
	struct message m;
	int nread = cmd->read.n, nwritten = cmd->written.n;

	settle(cmd, ends);
	limit_memory(cmd, bake_threads(cmd->nthreads));
	while (message_receive(worker.channel, &m, text)) {
		int status;

		/* the libraries may have been silenced in the job before */
		dup2(ends->err, STDERR_FILENO);
		worker.claimed = false;
		worker.told = cmd_progress_now();
		cmd->nthreads = worker.nthreads = m.nthreads;
		status = job(cmd, m.number, arg);
		cmd_flush_warnings(cmd);
		fflush(cmd->err);
		if (fflush(stdout) != 0)
			status = CMD_EXIT_FAIL;
		tell_list(MESSAGE_READ, &cmd->read, nread);
		tell_list(MESSAGE_WRITTEN, &cmd->written, nwritten);
		tell(MESSAGE_DONE, status, 0, NULL);
	}
	_exit(CMD_EXIT_OK);
}
