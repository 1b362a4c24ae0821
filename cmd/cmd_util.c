/* Messages, lists, paths, progress and the depfile of the tools. */
/* SPDX-License-Identifier: MIT */
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cmd.h"
#include "cmd_recipe.h"
#include "cmd_signal.h"
#include "output.h"

void *
cmd_need(void *p)
{
	if (p != NULL)
		return p;
	cmd_die("no memory");
}

char *
cmd_copy(const char *text)
{
	return text != NULL ? cmd_need(strdup(text)) : NULL;
}

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

/* A text of a list, where it stood, and for an input the output that it makes.
 */
struct pair {
	const char *input;
	char *path;
	int i;
};

static int
by_path(const void *a, const void *b)
{
	const struct pair *p = a, *q = b;
	int order = strcmp(p->path, q->path);

	return order != 0 ? order : p->i - q->i;
}

/* Two neighbours of sorted pairs that share a path. */
static bool
neighbours_differ(const struct cmd *cmd, const struct pair *p, int n)
{
	for (int k = 1; k < n; k++)
		if (strcmp(p[k - 1].path, p[k].path) == 0)
			return cmd_usage_error(cmd,
			    "%s and %s would both be written to %s",
			    p[k - 1].input, p[k].input, p[k].path);
	return true;
}

bool
cmd_paths_differ(const struct cmd *cmd, const struct cmd_list *in,
    char *(*path_of)(const struct cmd *cmd, const char *input, const void *arg),
    const void *arg)
{
	struct pair *pairs;
	bool differ;
	int n = 0;

	if (cmd->output_dir == NULL || in->n < 2)
		return true;
	pairs = cmd_need(calloc((size_t)in->n, sizeof *pairs));
	for (int i = 0; i < in->n; i++) {
		char *path = path_of(cmd, in->item[i], arg);

		if (path != NULL)
			pairs[n++] = (struct pair){ in->item[i], path, i };
	}
	qsort(pairs, (size_t)n, sizeof *pairs, by_path);
	differ = neighbours_differ(cmd, pairs, n);
	for (int k = 0; k < n; k++)
		free(pairs[k].path);
	free(pairs);
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

void
cmd_list_add(struct cmd_list *list, const char *text)
{
	if ((list->n & (list->n - 1)) == 0) {
		size_t room = list->n == 0 ? 1 : 2 * (size_t)list->n;

		list->item =
		    cmd_need(realloc(list->item, (room + 1) * sizeof(char *)));
	}
	list->item[list->n++] = cmd_copy(text);
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

void
cmd_list_cut(struct cmd_list *list, int n)
{
	while (list->n > n)
		free(list->item[--list->n]);
	if (list->item != NULL)
		list->item[list->n] = NULL;
}

void
cmd_list_move(struct cmd_list *list, struct cmd_list *from)
{
	for (int i = 0; i < from->n; i++)
		cmd_list_add(list, from->item[i]);
	cmd_list_free(from);
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
	return cmd_need(out);
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

static int
by_text_and_place(const void *a, const void *b)
{
	const struct pair *p = a, *q = b;
	int order = strcmp(p->input, q->input);

	return order != 0 ? order : p->i - q->i;
}

/* Which of a list's texts stand there for the first time; to be freed. */
static bool *
first_of_each(const struct cmd_list *list)
{
	size_t n = (size_t)list->n;
	bool *first = cmd_need(calloc(n + 1, sizeof *first));
	struct pair *at = cmd_need(calloc(n + 1, sizeof *at));

	for (int i = 0; i < list->n; i++)
		at[i] = (struct pair){ list->item[i], NULL, i };
	qsort(at, n, sizeof *at, by_text_and_place);
	for (size_t k = 0; k < n; k++)
		first[at[k].i] =
		    k == 0 || strcmp(at[k - 1].input, at[k].input) != 0;
	free(at);
	return first;
}

static bool
write_depfile(struct cmd *cmd)
{
	struct bake_output out = BAKE_OUTPUT_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool *first;

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
	first = first_of_each(&cmd->read);
	for (int i = 0; i < cmd->read.n; i++) {
		if (!first[i])
			continue;
		fputs(" \\\n  ", out.stream);
		put_make_path(out.stream, cmd->read.item[i]);
	}
	putc('\n', out.stream);
	/* a rule without prerequisites for each, so that a file that is gone
	 * does not stop make */
	for (int i = 0; i < cmd->read.n; i++) {
		if (!first[i])
			continue;
		put_make_path(out.stream, cmd->read.item[i]);
		fputs(":\n", out.stream);
	}
	free(first);
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
	cmd_signals_end();
	cmd_recipe_free(cmd);
	cmd_list_free(&cmd->args);
	cmd_list_free(&cmd->operands);
	cmd_list_free(&cmd->read);
	cmd_list_free(&cmd->written);
	cmd_signals_speak(STDERR_FILENO);
	if (cmd->err != stderr)
		fclose(cmd->err);
	return status;
}
