/* Many files in one run: jobs are given to worker processes. */
/* SPDX-License-Identifier: MIT */
#include "cmd_batch.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cmd_batch_priv.h"

/* What a job left, kept until those before it have been told. */
struct job {
	bool done;
	int status;
	char *out, *err;
	size_t nout, nerr;
	struct cmd_list read, written;
	double share; /* done of it */
};

struct worker {
	pid_t pid; /* 0: none */
	struct worker_ends ends;
	int job;    /* -1: idle */
	bool fails; /* to start */
	bool waits, decodes;
	long turn; /* of the claim it waits with */
	double claims, granted;
	int nthreads; /* granted */
};

struct batch {
	struct cmd *cmd;
	const struct cmd_list *names;
	cmd_job_fn *fn;
	void *arg;
	struct job *job;
	struct worker *worker;
	int n, nworkers, nthreads;
	int next, told, ndone, nfailed, status;
	long turns;
	double memory, granted;
	struct cmd_progress bar;
	sigset_t unblocked; /* what was blocked before */
};

/* -- signals ------------------------------------------------------------------
 */

/* The signal that ends the batch; a handler can reach nothing else. */
static volatile sig_atomic_t stopped_by;

static void
stop(int sig)
{
	stopped_by = sig;
}

static const int ending[] = { SIGINT, SIGTERM, SIGHUP };
enum { NENDING = sizeof ending / sizeof *ending };

/* Signals come while the batch waits and nowhere else: it ends its workers
 * before it ends. */
static void
hold_signals(struct batch *b, struct sigaction old[NENDING])
{
	struct sigaction sa = { .sa_handler = stop };
	sigset_t set;

	sigemptyset(&set);
	sigemptyset(&sa.sa_mask);
	stopped_by = 0;
	for (int i = 0; i < NENDING; i++) {
		sigaction(ending[i], NULL, &old[i]);
		if (old[i].sa_handler == SIG_IGN)
			continue; /* nohup */
		sigaddset(&set, ending[i]);
		sigaction(ending[i], &sa, NULL);
	}
	sigprocmask(SIG_BLOCK, &set, &b->unblocked);
}

static void
free_signals(const struct batch *b, const struct sigaction old[NENDING])
{
	for (int i = 0; i < NENDING; i++)
		sigaction(ending[i], &old[i], NULL);
	sigprocmask(SIG_SETMASK, &b->unblocked, NULL);
	if (stopped_by != 0)
		raise(stopped_by);
}

/* -- what jobs leave
 * ------------------------------------------------------------ */

/* A file without a name that is written at its end. */
static int
open_ear(void)
{
	int fd = memfd_create("relief-tools", MFD_CLOEXEC);

	if (fd >= 0)
		fcntl(fd, F_SETFL, O_APPEND);
	return fd;
}

/* All that is in it, which it then no longer is; NULL where there is nothing.
 */
static char *
take_ear(int fd, size_t *n)
{
	off_t size = lseek(fd, 0, SEEK_END);
	char *text = size > 0 ? malloc((size_t)size) : NULL;

	*n = 0;
	while (text != NULL && *n < (size_t)size) {
		ssize_t k = pread(fd, text + *n, (size_t)size - *n, (off_t)*n);

		if (k <= 0)
			break;
		*n += (size_t)k;
	}
	if (ftruncate(fd, 0) != 0)
		*n = 0;
	return text;
}

/* Tell what the jobs left, in their order, as far as they are done. */
static void
tell(struct batch *b)
{
	for (; b->told < b->n && b->job[b->told].done; b->told++) {
		struct job *j = &b->job[b->told];

		if (j->nerr > 0 || j->nout > 0)
			cmd_progress_erase(&b->bar);
		if (j->nout > 0)
			fwrite(j->out, 1, j->nout, stdout);
		if (j->nerr > 0)
			fwrite(j->err, 1, j->nerr, b->cmd->err);
		fflush(b->cmd->err);
		cmd_list_move(&b->cmd->read, &j->read);
		cmd_list_move(&b->cmd->written, &j->written);
		free(j->out);
		free(j->err);
	}
}

static void
end_job(struct batch *b, struct worker *w, int status)
{
	struct job *j = &b->job[w->job];

	j->done = true;
	j->status = status;
	j->share = 1;
	j->out = take_ear(w->ends.out, &j->nout);
	j->err = take_ear(w->ends.err, &j->nerr);
	b->granted -= w->granted;
	w->granted = 0;
	w->nthreads = 0;
	w->waits = w->decodes = false;
	w->job = -1;
	b->ndone++;
	if (status != CMD_EXIT_OK)
		b->nfailed++;
	if (b->status == CMD_EXIT_OK)
		b->status = status;
	tell(b);
}

/* -- workers
 * --------------------------------------------------------------------- */

static void
close_fd(int *fd)
{
	if (*fd >= 0)
		close(*fd);
	*fd = -1;
}

static void
close_worker(struct worker *w)
{
	close_fd(&w->ends.channel);
	close_fd(&w->ends.out);
	close_fd(&w->ends.err);
	w->pid = 0;
}

/* In the child: what belongs to the batch is let go. */
static _Noreturn void
become_worker(struct batch *b, int self, int channel)
{
	struct worker_ends ends = b->worker[self].ends;

	for (int i = 0; i < b->nworkers; i++)
		close_fd(&b->worker[i].ends.channel);
	ends.channel = channel;
	for (int i = 0; i < NENDING; i++)
		signal(ending[i], SIG_DFL);
	sigprocmask(SIG_SETMASK, &b->unblocked, NULL);
	cmd_worker_run(b->cmd, &ends, b->fn, b->arg);
}

static bool
start_worker(struct batch *b, int self)
{
	struct worker *w = &b->worker[self];
	int pair[2] = { -1, -1 };

	w->job = -1;
	w->ends.out = open_ear();
	w->ends.err = open_ear();
	if (w->ends.out >= 0 && w->ends.err >= 0 &&
	    socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) == 0) {
		w->ends.channel = pair[0];
		fflush(stdout); /* not twice */
		fflush(b->cmd->err);
		w->pid = fork();
		if (w->pid == 0)
			become_worker(b, self, pair[1]);
		close(pair[1]);
		if (w->pid > 0)
			return true;
	}
	w->fails = true;
	close_worker(w);
	return false;
}

/* Why a job's process ended before the job. */
static void
tell_crash(struct batch *b, const struct worker *w, int how)
{
	const char *name = b->names->item[w->job];
	int sig = WIFSIGNALED(how) ? WTERMSIG(how) : 0;
	FILE *err = b->cmd->err;

	/* among what the job itself said */
	b->cmd->err = fdopen(dup(w->ends.err), "w");
	if (b->cmd->err == NULL)
		b->cmd->err = err;
	if (sig == SIGXCPU)
		cmd_error(b->cmd,
		    "%s: reading it took too long and was given up", name);
	else if (sig == SIGKILL || sig == SIGTERM)
		cmd_error(b->cmd,
		    "%s: its process was killed, perhaps for want of memory; "
		    "--memory bounds what all may use",
		    name);
	else if (w->decodes)
		cmd_error(b->cmd,
		    "%s: is broken: reading it crashed the library (%s)", name,
		    sig != 0 ? strsignal(sig) : "it ended the process");
	else if (sig != 0)
		cmd_error(b->cmd, "%s: the bake crashed (%s): a bug", name,
		    strsignal(sig));
	else if (lseek(w->ends.err, 0, SEEK_END) == 0)
		cmd_error(b->cmd, "%s: its process ended early", name);
	if (b->cmd->err != err)
		fclose(b->cmd->err);
	b->cmd->err = err;
}

/* A worker is gone: its job has failed, and another takes its place when there
 * is more to do. */
static void
bury_worker(struct batch *b, struct worker *w)
{
	int how = 0;

	/* it may be alive, where the channel failed */
	kill(w->pid, SIGTERM);
	waitpid(w->pid, &how, 0);
	if (w->job >= 0) {
		tell_crash(b, w, how);
		end_job(b, w, CMD_EXIT_FAIL);
	}
	close_worker(w);
}

/* To a worker, which would wait for what does not come. */
static void
say(struct batch *b, struct worker *w, const struct message *m)
{
	if (!message_send(w->ends.channel, m, NULL))
		bury_worker(b, w);
}

static void
end_workers(struct batch *b)
{
	for (int i = 0; i < b->nworkers; i++) {
		struct worker *w = &b->worker[i];

		if (w->pid == 0)
			continue;
		if (stopped_by != 0)
			kill(w->pid, SIGTERM);
		close_fd(&w->ends.channel);
	}
	for (int i = 0; i < b->nworkers; i++) {
		struct worker *w = &b->worker[i];

		if (w->pid == 0)
			continue;
		waitpid(w->pid, NULL, 0);
		close_worker(w);
	}
}

/* -- giving
 * -------------------------------------------------------------------- */

/* The jobs that are not done, as far as there are workers for them. */
static int
can_run(const struct batch *b)
{
	int left = b->n - b->ndone;

	return left < b->nworkers ? left : b->nworkers;
}

/* The next jobs to workers that have none; false where no worker can be
 * started and none is left. */
static bool
give_jobs(struct batch *b)
{
	bool any = false;

	for (int i = 0; i < b->nworkers; i++) {
		struct worker *w = &b->worker[i];
		struct message m = { .kind = MESSAGE_JOB };

		any = any || (w->pid != 0 && w->job >= 0);
		if (b->next == b->n || (w->pid != 0 && w->job >= 0))
			continue;
		if (w->pid == 0 && (w->fails || !start_worker(b, i)))
			continue;
		any = true;
		w->job = b->next++;
		m.number = w->job;
		m.nthreads = b->nthreads / can_run(b);
		say(b, w, &m);
	}
	return any;
}

/* The worker that has waited longest; NULL: none waits. */
static struct worker *
first_waiting(struct batch *b)
{
	struct worker *first = NULL;

	for (int i = 0; i < b->nworkers; i++) {
		struct worker *w = &b->worker[i];

		if (w->waits && (first == NULL || w->turn < first->turn))
			first = w;
	}
	return first;
}

static int
threads_in_use(const struct batch *b)
{
	int n = 0;

	for (int i = 0; i < b->nworkers; i++)
		n += b->worker[i].nthreads;
	return n;
}

/*
 * Grant claims in their order, as far as memory and threads go. Where memory
 * lets fewer jobs run than there are threads, or fewer are left, each has more
 * threads: small files side by side, large ones within.
 */
static void
grant(struct batch *b)
{
	struct worker *w;

	while ((w = first_waiting(b)) != NULL) {
		struct message m = { .kind = MESSAGE_GRANT, .number = 1 };
		int side_by_side = can_run(b), used = threads_in_use(b);

		/* what no --memory forbids is tried, alone */
		m.number = b->cmd->memory == 0 || w->claims <= b->memory;
		if (w->claims * side_by_side > b->memory)
			side_by_side = (int)(b->memory / w->claims);
		m.nthreads =
		    b->nthreads / (side_by_side > 1 ? side_by_side : 1);
		if (m.number != 0 && used > 0 &&
		    (b->granted + w->claims > b->memory ||
			used + m.nthreads > b->nthreads))
			return;
		w->waits = false;
		if (m.number != 0) {
			w->nthreads = m.nthreads;
			w->granted = w->claims;
			b->granted += w->granted;
		}
		say(b, w, &m);
	}
}

/* -- listening
 * ------------------------------------------------------------------ */

static void
hear(struct batch *b, struct worker *w)
{
	char text[MESSAGE_TEXT];
	struct message m;
	struct job *j;

	if (!message_receive(w->ends.channel, &m, text) || w->job < 0) {
		bury_worker(b, w);
		return;
	}
	j = &b->job[w->job];
	switch (m.kind) {
	case MESSAGE_CLAIM:
		w->waits = true;
		w->turn = b->turns++;
		w->claims = m.value;
		break;
	case MESSAGE_DECODING:
		w->decodes = m.number != 0;
		break;
	case MESSAGE_PROGRESS:
		j->share = m.value;
		break;
	case MESSAGE_READ:
		cmd_list_add(&j->read, text);
		break;
	case MESSAGE_WRITTEN:
		cmd_list_add(&j->written, text);
		break;
	default:
		end_job(b, w, m.number);
		break;
	}
}

static void
show(struct batch *b)
{
	double share = b->ndone;

	for (int i = 0; i < b->nworkers; i++)
		if (b->worker[i].pid != 0 && b->worker[i].job >= 0)
			share += b->job[b->worker[i].job].share;
	cmd_progress_files(&b->bar, share / b->n, b->ndone, b->n);
}

/* Wait for what workers say; b->nworkers polls are there to be used. */
static void
listen_to(struct batch *b, struct pollfd *poll)
{
	const struct timespec tick = { 0, 200000000 };
	int n;

	for (int i = 0; i < b->nworkers; i++) {
		poll[i].fd = b->worker[i].pid != 0 && b->worker[i].job >= 0
				 ? b->worker[i].ends.channel
				 : -1;
		poll[i].events = POLLIN;
		poll[i].revents = 0;
	}
	n = ppoll(poll, (nfds_t)b->nworkers, b->bar.shows ? &tick : NULL,
	    &b->unblocked);
	for (int i = 0; n > 0 && i < b->nworkers; i++)
		if (poll[i].revents != 0)
			hear(b, &b->worker[i]);
	if (b->bar.shows)
		show(b);
}

static void
run_workers(struct batch *b, struct pollfd *poll)
{
	while (b->ndone < b->n && stopped_by == 0) {
		if (!give_jobs(b)) {
			cmd_error(b->cmd,
			    "no process can be started; --no-isolate needs "
			    "none");
			b->status = CMD_EXIT_FAIL;
			break;
		}
		grant(b);
		listen_to(b, poll);
	}
}

static void
run_batch(struct batch *b, struct pollfd *poll)
{
	struct sigaction old[NENDING];

	hold_signals(b, old);
	cmd_progress_start(b->cmd, &b->bar);
	run_workers(b, poll);
	end_workers(b);
	cmd_progress_end(&b->bar);
	b->nfailed += b->n - b->ndone;
	/* where the batch was ended, what had come out of turn */
	for (int i = b->told; i < b->n; i++)
		b->job[i].done = true;
	tell(b);
	free_signals(b, old);
}

static int
in_processes(
    struct cmd *cmd, const struct cmd_list *names, cmd_job_fn *fn, void *arg)
{
	struct batch b = { .cmd = cmd,
		.names = names,
		.fn = fn,
		.arg = arg,
		.n = names->n,
		.nthreads = bake_threads(cmd->nthreads),
		.memory = cmd_memory_limit(cmd) };
	struct pollfd *poll;

	b.nworkers = b.nthreads < b.n ? b.nthreads : b.n;
	b.job = calloc((size_t)b.n, sizeof *b.job);
	b.worker = calloc((size_t)b.nworkers, sizeof *b.worker);
	poll = calloc((size_t)b.nworkers, sizeof *poll);
	if (b.job != NULL && b.worker != NULL && poll != NULL) {
		for (int i = 0; i < b.nworkers; i++)
			b.worker[i].ends = (struct worker_ends){ -1, -1, -1 };
		run_batch(&b, poll);
	} else {
		cmd_error(cmd, "no memory");
		b.status = CMD_EXIT_FAIL;
	}
	if (b.nfailed > 0 && b.n > 1)
		cmd_error(cmd, "%d of %d failed", b.nfailed, b.n);
	free(b.job);
	free(b.worker);
	free(poll);
	return b.status;
}

/* -- here
 * ----------------------------------------------------------------------- */

static int
in_this_process(
    struct cmd *cmd, const struct cmd_list *names, cmd_job_fn *fn, void *arg)
{
	int status = CMD_EXIT_OK, nfailed = 0;

	for (int i = 0; i < names->n; i++) {
		int rc = fn(cmd, i, arg);

		cmd_flush_warnings(cmd);
		if (rc != CMD_EXIT_OK)
			nfailed++;
		if (status == CMD_EXIT_OK)
			status = rc;
	}
	if (nfailed > 0 && names->n > 1)
		cmd_error(cmd, "%d of %d failed", nfailed, names->n);
	return status;
}

int
cmd_batch(
    struct cmd *cmd, const struct cmd_list *names, cmd_job_fn *job, void *arg)
{
	bool apart = cmd->isolate == CMD_ISOLATE_YES ||
		     (cmd->isolate == CMD_ISOLATE_BATCH && names->n > 1);

	return apart && !cmd_is_worker()
		   ? in_processes(cmd, names, job, arg)
		   : in_this_process(cmd, names, job, arg);
}

int
cmd_one(struct cmd *cmd, cmd_job_fn *job, void *arg)
{
	struct cmd_list names = { NULL, 0 };
	int status;

	cmd_list_add(&names, cmd->output != NULL ? cmd->output : "the work");
	status = cmd_batch(cmd, &names, job, arg);
	cmd_list_free(&names);
	return status;
}
