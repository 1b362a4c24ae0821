/* The record in every output of what it was made of, and --if-changed. */
/* SPDX-License-Identifier: MIT */
#include "cmd_recipe_priv.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cmd_signal.h"

/* To be raised whenever the same inputs and options give other outputs than
 * they did, within one version of the tools. */
enum { RECIPE_VERSION = 2 };

enum { ALL = CMD_ARG_INPUT | CMD_ARG_EACH | CMD_ARG_PREFIX };

/* Room for one more; the array, grown. */
void *
cmd_recipe_grow(void *array, int n, size_t size)
{
	return cmd_need(realloc(array, ((size_t)n + 1) * size));
}

struct cmd_recipe *
cmd_recipe_of(struct cmd *cmd)
{
	if (cmd->recipe == NULL)
		cmd->recipe = cmd_need(calloc(1, sizeof *cmd->recipe));
	return cmd->recipe;
}

static unsigned
mark_of(const struct cmd *cmd, const char *option, const char *arg)
{
	/* of the common options */
	static const char neutral[] = " depfile each format if-changed isolate "
				      "max-pixels memory no-isolate output "
				      "output-dir quiet threads verbose ";
	char word[64];

	snprintf(word, sizeof word, " %.60s ", option);
	if (strstr(neutral, word) != NULL)
		return CMD_ARG_NEUTRAL;
	for (const struct cmd_mark *m = cmd->tool->marks;
	     m != NULL && m->name != NULL; m++) {
		if (strcmp(m->name, option) != 0)
			continue;
		snprintf(word, sizeof word, " %.60s ", arg ? arg : "");
		return m->words != NULL && strstr(m->words, word) != NULL
			   ? m->mark & ~(unsigned)ALL
			   : m->mark;
	}
	return 0;
}

/* The last option given goes to those of its name, in the order of names: where
 * the order does not matter to the tool, it must not to the record. */
static void
sort_in(struct cmd_recipe *r)
{
	for (int k = r->ngiven - 1; k > 0; k--) {
		struct given *g = &r->given[k], swap = g[-1];

		if (!swap.operand && strcmp(swap.option, g->option) <= 0)
			return;
		g[-1] = *g;
		*g = swap;
	}
}

void
cmd_recipe_given(struct cmd *cmd, const char *option, const char *arg)
{
	struct cmd_recipe *r = cmd_recipe_of(cmd);
	unsigned mark = option != NULL ? mark_of(cmd, option, arg) : 0;

	if (mark & CMD_ARG_REPORT)
		r->reports = true;
	if (mark & CMD_ARG_NEUTRAL)
		return;
	r->given = cmd_recipe_grow(r->given, r->ngiven, sizeof *r->given);
	r->given[r->ngiven++] =
	    (struct given){ cmd_copy(option != NULL ? option : ""),
		    cmd_copy(arg), false };
	if (!(cmd->tool->groups & CMD_IN_ORDER))
		sort_in(r);
}

void
cmd_recipe_operand(struct cmd *cmd)
{
	struct cmd_recipe *r = cmd_recipe_of(cmd);

	r->given = cmd_recipe_grow(r->given, r->ngiven, sizeof *r->given);
	r->given[r->ngiven++] = (struct given){ NULL, NULL, true };
}

static void
end_job(struct cmd_recipe *r)
{
	for (int i = 0; i < r->nplanned; i++) {
		free(r->planned[i].path);
		free(r->planned[i].label);
	}
	for (int i = 0; i < r->nfurther; i++)
		free(r->further[i].path);
	free(r->planned);
	free(r->further);
	free(r->input);
	free(r->main);
	r->planned = NULL;
	r->further = NULL;
	r->input = NULL;
	r->main = NULL;
	r->nplanned = r->nfurther = r->ninputs = 0;
	r->trouble = (struct bake_err)BAKE_ERR_INIT;
	r->begun = r->none = r->in_place = r->has_stdin = false;
	r->stdin_at = -1;
	r->set[0] = '\0';
}

void
cmd_recipe_free(struct cmd *cmd)
{
	struct cmd_recipe *r = cmd->recipe;

	if (r == NULL)
		return;
	end_job(r);
	for (int i = 0; i < r->ngiven; i++) {
		free(r->given[i].option);
		free(r->given[i].arg);
	}
	free(r->given);
	free(r);
	cmd->recipe = NULL;
}

/* -- inputs ------------------------------------------------------------ */

/* A text with its length before it, so that no two lists are one text. */
void
cmd_recipe_put_text(FILE *fp, char kind, const char *text)
{
	fprintf(fp, "%c%zu:%s", kind, strlen(text), text);
}

void
cmd_recipe_put_digest(FILE *fp, char kind, const struct bake_digest *d)
{
	char text[BAKE_DIGEST_TEXT];

	bake_digest_text(d, text);
	cmd_recipe_put_text(fp, kind, text);
}

/* A file of the command line: its content. */
static void
put_input(struct cmd_recipe *r, FILE *fp, const char *arg, unsigned mark)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_digest d = { { 0 } };
	enum bake_status rc;
	struct stat st;

	r->input = cmd_recipe_grow(r->input, r->ninputs, sizeof *r->input);
	r->input[r->ninputs++] = (struct input){ arg, mark };
	if ((mark & CMD_ARG_PREFIX) &&
	    (stat(arg, &st) != 0 || !S_ISREG(st.st_mode))) {
		cmd_recipe_put_text(fp, 'p', "");
		return;
	}
	if (strcmp(arg, "-") == 0) {
		/* after the "d22:" */
		fflush(fp);
		r->stdin_at = ftell(fp) + 4;
	} else if ((rc = bake_digest_file(arg, &d, &err)) != BAKE_OK) {
		if (rc == BAKE_ENOMEM)
			cmd_die("no memory");
		r->none = true;
		/* what is no file, or is not there, is the bake's to judge */
		if (stat(arg, &st) == 0 && S_ISREG(st.st_mode))
			r->trouble = err;
	}
	cmd_recipe_put_digest(fp, 'd', &d);
}

/* Whether the k-th use of an option marked CMD_ARG_EACH is job i's. */
static bool
is_jobs(const struct cmd *cmd, const struct cmd_recipe *r, int k, int i)
{
	int before = 0;

	for (int g = 0; g < k; g++)
		before += r->given[g].option != NULL &&
			  strcmp(r->given[g].option, r->given[k].option) == 0 &&
			  (mark_of(cmd, r->given[g].option, r->given[g].arg) &
			      CMD_ARG_EACH);
	return before == i;
}

static void
put_given(struct cmd *cmd, struct cmd_recipe *r, FILE *fp, int i)
{
	int operand = 0;

	for (int k = 0; k < r->ngiven; k++) {
		const struct given *g = &r->given[k];
		unsigned mark;

		if (g->operand) {
			if (i < 0 && operand < cmd->operands.n)
				put_input(r, fp, cmd->operands.item[operand++],
				    CMD_ARG_INPUT);
			continue;
		}
		mark = mark_of(cmd, g->option, g->arg);
		if ((mark & CMD_ARG_EACH) && !is_jobs(cmd, r, k, i))
			continue;
		cmd_recipe_put_text(fp, 'o', g->option);
		if (mark & ALL)
			put_input(r, fp, g->arg, mark);
		else if (g->arg != NULL)
			cmd_recipe_put_text(fp, 'v', g->arg);
	}
	/* a batch's operand counts alone, wherever it stood */
	if (i >= 0 && i < cmd->operands.n)
		put_input(r, fp, cmd->operands.item[i], CMD_ARG_INPUT);
}

void
cmd_recipe_begin(struct cmd *cmd, int i)
{
	struct cmd_recipe *r = cmd_recipe_of(cmd);
	char version[16];
	FILE *fp;

	end_job(r);
	fp = cmd_need(open_memstream(&r->main, &r->nmain));
	snprintf(version, sizeof version, "%d", RECIPE_VERSION);
	cmd_recipe_put_text(fp, 't', cmd->tool->name);
	cmd_recipe_put_text(fp, 't', RELIEF_VERSION);
	cmd_recipe_put_text(fp, 't', version);
	put_given(cmd, r, fp, i);
	if (fclose(fp) != 0) /* glibc tells of no memory by main alone */
		cmd_need(NULL);
	cmd_need(r->main);
	r->begun = true;
	r->nread = cmd->read.n;
}

void
cmd_recipe_stdin(struct cmd *cmd, const struct bake_digest *digest)
{
	struct cmd_recipe *r = cmd_recipe_of(cmd);
	char text[BAKE_DIGEST_TEXT];

	if (r->stdin_at < 0 || !r->begun)
		return;
	bake_digest_text(digest, text);
	memcpy(r->main + r->stdin_at, text, BAKE_DIGEST_TEXT - 1);
	r->has_stdin = true;
}

void
cmd_recipe_none(struct cmd *cmd)
{
	cmd_recipe_of(cmd)->none = true;
}

void
cmd_recipe_color(struct cmd *cmd)
{
	const char *config = getenv("OCIO");

	if (config != NULL && config[0] != '\0')
		cmd_recipe_none(cmd);
}

void
cmd_recipe_set(struct cmd *cmd, const char *set)
{
	struct cmd_recipe *r = cmd_recipe_of(cmd);

	snprintf(r->set, sizeof r->set, "%s", set);
}

/* -- outputs --------------------------------------------------------------- */

/* An output that takes an input's place changes what it was made of: it gets
 * the record that it would get elsewhere, but is never up to date. */
static bool
is_input(const struct cmd_recipe *r, const char *path)
{
	struct stat a, b;

	if (stat(path, &a) != 0)
		return false;
	for (int i = 0; i < r->ninputs; i++)
		if (stat(r->input[i].arg, &b) == 0 && a.st_dev == b.st_dev &&
		    a.st_ino == b.st_ino)
			return true;
	return false;
}

const struct planned *
cmd_recipe_find(const struct cmd_recipe *r, const char *path)
{
	for (int i = 0; i < r->nplanned; i++)
		if (strcmp(r->planned[i].path, path) == 0)
			return &r->planned[i];
	return NULL;
}

void
cmd_recipe_output(struct cmd *cmd, const char *path, const char *label)
{
	struct cmd_recipe *r = cmd_recipe_of(cmd);
	enum bake_file_type type = cmd->type;
	bool typed, standard;
	char *text;

	if (path == NULL || !r->begun || cmd_recipe_find(r, path) != NULL)
		return;
	standard = strcmp(path, "-") == 0;
	typed = (!standard && bake_file_type_from_path(path, &type)) ||
		cmd->has_type || (cmd->tool->groups & CMD_OUTPUT_PREFIX);
	if (asprintf(&text, "%s %s", label,
		typed ? bake_file_type_name(type) : "") < 0)
		cmd_need(NULL);
	if (!standard && is_input(r, path))
		r->in_place = true;
	r->planned =
	    cmd_recipe_grow(r->planned, r->nplanned, sizeof *r->planned);
	r->planned[r->nplanned++] = (struct planned){ cmd_copy(path), text };
}
