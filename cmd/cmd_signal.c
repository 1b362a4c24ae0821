/* What a signal that ends the tool does: clean up, and die of it. */
/* SPDX-License-Identifier: MIT */
#include "cmd_signal.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "cmd.h"

/* A handler has no other way to what it needs. */
static pthread_t main_thread;
static volatile sig_atomic_t bar_fd = -1, err_fd = STDERR_FILENO;
static pid_t first; /* the process that began */
static bool done;   /* the tool leaves by itself */

static void
die_of_it(int sig)
{
	int saved = errno;

	if (!pthread_equal(pthread_self(), main_thread)) {
		/* which may be putting a file in its place just now */
		pthread_kill(main_thread, sig);
	} else {
		/* to a terminal that has gone there is nothing to say */
		if (bar_fd >= 0 && write(bar_fd, "\r\033[K", 4) < 0)
			bar_fd = -1;
		signal(sig, SIG_DFL);
		raise(sig); /* comes when this handler returns */
	}
	errno = saved;
}

/* In a handler there is memcpy and write; one write, because another thread may
 * be telling something, too. */
static size_t
append(char *line, size_t n, size_t room, const char *text)
{
	size_t more = strlen(text);

	more = more < room - n ? more : room - n;
	memcpy(line + n, text, more);
	return n + more;
}

_Noreturn void
cmd_die(const char *reason)
{
	char line[256];
	size_t n = 0;

	n = append(line, n, sizeof line, program_invocation_short_name);
	n = append(line, n, sizeof line, ": ");
	n = append(line, n, sizeof line, reason);
	n = append(line, n, sizeof line, "\n");
	if (write((int)err_fd, line, n) < 0)
		err_fd = STDERR_FILENO; /* nobody can be told */
	_exit(CMD_EXIT_FAIL);
}

/* OpenMP calls exit() where it finds no memory, and its word is silenced. */
static void
tell_early_end(void)
{
	if (!done)
		cmd_die("a library ended the run: no memory?");
}

static void
crash(int sig)
{
	struct rlimit core;

	if (getrlimit(RLIMIT_CORE, &core) == 0 && core.rlim_cur > 0) {
		signal(sig, SIG_DFL);
		raise(sig);
		return;
	}
	cmd_die(sig == SIGABRT ? "a library gave up: no memory?"
			       : "crashed: no memory, or a broken file?");
}

/* Not where a sanitizer sees to it. */
static void
catch_crashes(bool worker)
{
	static const int signals[] = { SIGABRT, SIGBUS, SIGFPE, SIGILL,
		SIGSEGV };
	struct sigaction act = { .sa_handler = crash }, old;

	for (int i = 0; i < (int)(sizeof signals / sizeof *signals); i++) {
		if (sigaction(signals[i], NULL, &old) != 0)
			continue;
		if (worker && old.sa_handler == crash)
			signal(signals[i], SIG_DFL);
		else if (!worker && old.sa_handler == SIG_DFL)
			sigaction(signals[i], &act, NULL);
	}
}

void
cmd_signals_start(void)
{
	static const int signals[] = { SIGHUP, SIGINT, SIGQUIT, SIGTERM,
		SIGUSR1, SIGUSR2, SIGXCPU };
	struct sigaction die = { .sa_handler = die_of_it,
		.sa_flags = SA_RESTART };
	struct sigaction old;

	main_thread = pthread_self();
	bar_fd = -1; /* in a worker: it is the batch's */
	for (int i = 0; i < (int)(sizeof signals / sizeof *signals); i++)
		if (sigaction(signals[i], NULL, &old) == 0 &&
		    old.sa_handler != SIG_IGN)
			sigaction(signals[i], &die, NULL);
	signal(SIGXFSZ, SIG_IGN);
	if (first == 0) {
		first = getpid();
		atexit(tell_early_end);
	}
	done = false;
	catch_crashes(getpid() != first);
}

void
cmd_signals_speak(int fd)
{
	err_fd = fd;
}

void
cmd_signals_end(void)
{
	done = true;
}

void
cmd_signals_bar(int fd)
{
	bar_fd = fd;
}
