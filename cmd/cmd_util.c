/* Messages, lists, paths, progress and the depfile of the tools. */
/* SPDX-License-Identifier: MIT */
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cmd.h"
#include "output.h"

/* One line, with no control character from a file's name in it. */
static void
put_line(const struct cmd *cmd, const char *line)
{
	fprintf(cmd->err, "%s: ", cmd->tool->name);
	for (; *line != '\0'; line++)
		putc((unsigned char)*line < ' ' || *line == 0x7f ? '?' : *line,
		    cmd->err);
	putc('\n', cmd->err);
	fflush(cmd->err);
}

static void
message(const struct cmd *cmd, const char *fmt, va_list ap)
{
	char text[2 * BAKE_ERR_MSG];

	vsnprintf(text, sizeof text, fmt, ap);
	put_line(cmd, text);
}

void
cmd_error(struct cmd *cmd, const char *fmt, ...)
{
	va_list ap;

	cmd_list_free(&cmd->warnings);
	va_start(ap, fmt);
	message(cmd, fmt, ap);
	va_end(ap);
}

void
cmd_warn(struct cmd *cmd, const char *fmt, ...)
{
	char text[2 * BAKE_ERR_MSG];
	va_list ap;

	if (cmd->quiet)
		return;
	va_start(ap, fmt);
	vsnprintf(text, sizeof text, fmt, ap);
	va_end(ap);
	cmd_list_add(&cmd->warnings, text);
}

void
cmd_flush_warnings(struct cmd *cmd)
{
	for (int i = 0; i < cmd->warnings.n; i++)
		put_line(cmd, cmd->warnings.item[i]);
	cmd_list_free(&cmd->warnings);
}

void
cmd_note(const struct cmd *cmd, const char *fmt, ...)
{
	va_list ap;

	if (!cmd->verbose)
		return;
	va_start(ap, fmt);
	message(cmd, fmt, ap);
	va_end(ap);
}

bool
cmd_usage_error(const struct cmd *cmd, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	message(cmd, fmt, ap);
	va_end(ap);
	fprintf(cmd->err, "usage: %s [options] %s\n", cmd->tool->name,
	    cmd->tool->operands);
	return false;
}

bool
cmd_inputs_fit(const struct cmd *cmd, int n)
{
	if (n == 0)
		return cmd_usage_error(cmd, "no input");
	if (cmd->output == NULL && cmd->output_dir == NULL)
		return cmd_usage_error(
		    cmd, "no output: give -o FILE or -O DIR");
	if (n > 1 && cmd->output_dir == NULL)
		return cmd_usage_error(
		    cmd, "%d inputs and one output: give -O DIR", n);
	return true;
}

bool
cmd_paths_differ(const struct cmd *cmd, const struct cmd_list *in,
    char *(*path_of)(const struct cmd *cmd, const char *input, const void *arg),
    const void *arg)
{
	bool differ = true;

	for (int i = 0; differ && cmd->output_dir != NULL && i < in->n; i++) {
		char *a = path_of(cmd, in->item[i], arg);

		for (int k = 0; differ && a != NULL && k < i; k++) {
			char *b = path_of(cmd, in->item[k], arg);

			if (b != NULL && strcmp(a, b) == 0)
				differ = cmd_usage_error(cmd,
				    "%s and %s would both be written to %s",
				    in->item[k], in->item[i], a);
			free(b);
		}
		free(a);
	}
	return differ;
}

void
cmd_silence_libraries(const struct cmd *cmd)
{
	int fd;

	if (cmd->verbose || cmd->err == stderr)
		return;
	fd = open("/dev/null", O_WRONLY | O_CLOEXEC);
	if (fd < 0)
		return;
	dup2(fd, STDERR_FILENO);
	close(fd);
}

/* Memory for a few words of text: where that fails, nothing else will work. */
static void *
need(void *p)
{
	if (p != NULL)
		return p;
	fputs("relief-tools: no memory\n", stderr);
	exit(CMD_EXIT_FAIL);
}

void
cmd_list_add(struct cmd_list *list, const char *text)
{
	if ((list->n & (list->n - 1)) == 0) {
		size_t room = list->n == 0 ? 1 : 2 * (size_t)list->n;

		list->item =
		    need(realloc(list->item, (room + 1) * sizeof(char *)));
	}
	list->item[list->n++] = need(strdup(text));
	list->item[list->n] = NULL; /* as argv ends */
}

void
cmd_list_free(struct cmd_list *list)
{
	for (int i = 0; i < list->n; i++)
		free(list->item[i]);
	free(list->item);
	list->item = NULL;
	list->n = 0;
}

char *
cmd_path_derive(
    const char *path, const char *dir, const char *suffix, const char *ext)
{
	const char *slash = strrchr(path, '/');
	const char *base = slash != NULL ? slash + 1 : path;
	const char *dot = strrchr(base, '.');
	int nstem =
	    dot != NULL && dot != base ? (int)(dot - base) : (int)strlen(base);
	int nfolder = (int)(base - path);
	char *out = NULL;

	if (ext == NULL)
		ext = base + nstem;
	if (dir != NULL) {
		if (asprintf(
			&out, "%s/%.*s%s%s", dir, nstem, base, suffix, ext) < 0)
			out = NULL;
	} else if (asprintf(&out, "%.*s%.*s%s%s", nfolder, path, nstem, base,
		       suffix, ext) < 0) {
		out = NULL;
	}
	return need(out);
}

/* -- progress ------------------------------------------------------------ */

static double
now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void
report(void *arg, double done)
{
	enum { WIDTH = 40 };
	struct cmd_progress *p = arg;
	double t = now();
	int filled = (int)(done * WIDTH);

	if (t - p->started < 1 || t - p->shown < 0.1)
		return;
	p->shown = t;
	p->drawn = true;
	fprintf(p->err, "\r[%-*.*s] %3d %%", WIDTH, filled,
	    "########################################", (int)(done * 100));
	fflush(p->err);
}

struct bake_progress
cmd_progress_start(const struct cmd *cmd, struct cmd_progress *state)
{
	struct bake_progress none = { NULL, NULL };
	struct bake_progress bar = { report, state };

	state->err = cmd->err;
	state->started = now();
	state->shown = 0;
	state->drawn = false;
	return !cmd->quiet && isatty(fileno(cmd->err)) ? bar : none;
}

void
cmd_progress_end(struct cmd_progress *state)
{
	if (state->drawn)
		fprintf(state->err, "\r%50s\r", "");
	state->drawn = false;
}

/* -- leaving --------------------------------------------------------------- */

/* A path as Make reads it: blanks, '#' and '$' escaped. */
static void
put_make_path(FILE *fp, const char *path)
{
	for (; *path != '\0'; path++) {
		if (*path == ' ' || *path == '#' || *path == '\\')
			putc('\\', fp);
		else if (*path == '$')
			putc('$', fp);
		putc(*path, fp);
	}
}

static bool
seen_before(const struct cmd_list *list, int i)
{
	for (int k = 0; k < i; k++)
		if (strcmp(list->item[k], list->item[i]) == 0)
			return true;
	return false;
}

static bool
write_depfile(struct cmd *cmd)
{
	struct bake_output out = BAKE_OUTPUT_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_output_open(&out, cmd->depfile, &err) != BAKE_OK) {
		cmd_error(cmd, "%s", err.msg);
		return false;
	}
	for (int i = 0; i < cmd->written.n; i++) {
		if (i > 0)
			putc(' ', out.stream);
		put_make_path(out.stream, cmd->written.item[i]);
	}
	putc(':', out.stream);
	for (int i = 0; i < cmd->read.n; i++) {
		if (seen_before(&cmd->read, i))
			continue;
		fputs(" \\\n  ", out.stream);
		put_make_path(out.stream, cmd->read.item[i]);
	}
	putc('\n', out.stream);
	/* a rule without prerequisites for each, so that a file that is gone
	 * does not stop make */
	for (int i = 0; i < cmd->read.n; i++) {
		if (seen_before(&cmd->read, i))
			continue;
		put_make_path(out.stream, cmd->read.item[i]);
		fputs(":\n", out.stream);
	}
	if (bake_output_commit(&out, &err) != BAKE_OK) {
		cmd_error(cmd, "%s", err.msg);
		return false;
	}
	return true;
}

int
cmd_finish(struct cmd *cmd, int status)
{
	cmd_flush_warnings(cmd);
	if (status == CMD_EXIT_OK && cmd->depfile != NULL &&
	    cmd->written.n > 0 && !write_depfile(cmd))
		status = CMD_EXIT_FAIL;
	if ((fflush(stdout) != 0 || ferror(stdout)) && status == CMD_EXIT_OK) {
		cmd_error(cmd, "standard output: cannot be written");
		status = CMD_EXIT_FAIL;
	}
	cmd_list_free(&cmd->args);
	cmd_list_free(&cmd->operands);
	cmd_list_free(&cmd->read);
	cmd_list_free(&cmd->written);
	if (cmd->err != stderr)
		fclose(cmd->err);
	return status;
}
