/* What a signal that ends the tool does: clean up, and die of it. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_SIGNAL_H
#define CMD_SIGNAL_H

/*
 * Called on the main thread before anything else, and again in a forked
 * process that goes on by itself (a batch's worker).
 *
 * From then on SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2 and SIGXCPU
 * take effect on the main thread alone, whichever thread the system gives them
 * to: it takes the progress bar off the terminal and dies of the signal, so
 * that a shell and make see what happened (130 after ^C). While an output is
 * put in its place (bake_output_commit) that thread has them blocked, so that
 * it is in its place or not begun when the tool dies; the data of an unfinished
 * output have no name, there is nothing to remove. A signal that was ignored
 * from the start (nohup, a background job of a shell) stays ignored.
 *
 * A file larger than the process may write (ulimit -f) is an error of its write
 * from then on, like a full disk, not the end by SIGXFSZ. SIGPIPE is left
 * alone: once nobody reads our standard output the tool ends without a word, as
 * any filter does.
 *
 * Where the process itself crashes - some image libraries abort, or go through
 * a null pointer, where there is no memory - one line says so and the exit
 * status is 1, as for any failure; outputs are as they were. Who allows core
 * dumps (ulimit -c) gets one, and the signal; so does a batch of its worker,
 * which it reports itself.
 */
void cmd_signals_start(void);

/* The tool has said all: an exit() from now on is its own. One before is a
 * library's, and is told. */
void cmd_signals_end(void);

/* Where messages go, also when standard error is silenced. */
void cmd_signals_speak(int fd);

/* Ends the process: 'rm-tool: REASON', exit status 1. */
_Noreturn void cmd_die(const char *reason);

/* A progress bar stands on the last line of the terminal that fd is; -1: on
 * none, any more. */
void cmd_signals_bar(int fd);

#endif
