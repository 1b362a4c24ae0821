/* --each: one command line for many names, '%' standing for each. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cmd_batch.h"
#include "cmd_batch_priv.h"

struct each {
	struct cmd_list names;
};

/* Text with each % replaced by the name, and %% by one %. */
static char *
put_name(const char *text, const char *name)
{
	size_t n = strlen(text), nname = strlen(name), room = 1;
	char *out, *to;

	for (size_t i = 0; i < n; i++)
		room += text[i] == '%' ? nname + 1 : 1;
	out = to = malloc(room);
	if (out == NULL)
		return NULL;
	for (size_t i = 0; i < n; i++) {
		if (text[i] != '%') {
			*to++ = text[i];
		} else if (text[i + 1] == '%') {
			*to++ = '%';
			i++;
		} else {
			memcpy(to, name, nname);
			to += nname;
		}
	}
	*to = '\0';
	return out;
}

static bool
has_place(const char *text)
{
	for (; *text != '\0'; text++)
		if (text[0] == '%' && *++text != '%')
			return true;
	return false;
}

/* Whether an argument is, or ends in, that of --each; getopt moves arguments,
 * their texts stay where they are. */
static bool
names_each(const struct cmd *cmd, int i)
{
	const char *arg = i < cmd->args.n ? cmd->args.item[i] : NULL;

	return arg != NULL && cmd->each >= arg &&
	       cmd->each <= arg + strlen(arg);
}

/* The command line of one name, without the --each. */
static bool
args_of(const struct cmd *cmd, const char *name, struct cmd_list *args)
{
	for (int i = 0; i < cmd->args.n; i++) {
		char *text;

		if (names_each(cmd, i) ||
		    (i + 1 < cmd->args.n && cmd->each == cmd->args.item[i + 1]))
			continue;
		text = put_name(cmd->args.item[i], name);
		if (text == NULL)
			return false;
		cmd_list_add(args, text);
		free(text);
	}
	return true;
}

static int
run_name(struct cmd *cmd, int i, void *arg)
{
	const struct each *each = arg;
	struct cmd_list args = { NULL, 0 };
	int status = CMD_EXIT_FAIL;

	/* the run before may have silenced the libraries */
	dup2(fileno(cmd->err), STDERR_FILENO);
	if (args_of(cmd, each->names.item[i], &args))
		status = cmd->tool->main(args.n, args.item);
	else
		cmd_error(cmd, "no memory");
	cmd_list_free(&args);
	return status;
}

int
cmd_run_each(struct cmd *cmd)
{
	struct each each = { { NULL, 0 } };
	int status = CMD_EXIT_USAGE;

	if (cmd->output != NULL && !has_place(cmd->output))
		cmd_usage_error(cmd,
		    "%s: with --each the output's name needs a %%, which "
		    "stands for each name",
		    cmd->output);
	else if (cmd->depfile != NULL && !has_place(cmd->depfile))
		cmd_usage_error(cmd,
		    "%s: with --each the depfile's name needs a %%",
		    cmd->depfile);
	else if (!cmd_read_lines(cmd, cmd->each, &each.names))
		status = CMD_EXIT_FAIL;
	else
		status = cmd_batch(cmd, &each.names, run_name, &each);
	cmd_list_free(&each.names);
	return status;
}
