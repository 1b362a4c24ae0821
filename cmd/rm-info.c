/* rm-info: what textures are, whether their maps agree, how far two differ. */
/* SPDX-License-Identifier: MIT */
#include "cmd_batch.h"
#include "info.h"

#include "io_exr.h"

enum {
	KEY_CHANNEL = CMD_KEY_TOOL,
	KEY_CHECK,
	KEY_COMPARE,
	KEY_DEPTH,
	KEY_JSON,
	KEY_NORMAL,
	KEY_SHEET,
	KEY_TOLERANCE
};

static const struct cmd_option options[] = {
	{ KEY_CHANNEL, "channel", "NAME",
	    "the relief's channel: {R}, {G}, {B}, {A}, its name or number" },
	{ KEY_CHECK, "check", NULL,
	    "print what contradicts and nothing else; then exit 1" },
	{ KEY_COMPARE, "compare", NULL,
	    "how far two files differ; exit 1 beyond the tolerance" },
	{ KEY_DEPTH, "depth", "FILE", "the relief map of a pair" },
	{ 's', "depth-scale", "S",
	    "the declared depth scale, in texture widths" },
	{ KEY_JSON, "json", NULL, "one JSON object a line" },
	{ KEY_NORMAL, "normal", "FILE", "the normal map of a pair" },
	{ KEY_SHEET, "sheet", "OUT",
	    "draw a contact sheet of the files instead" },
	{ KEY_TOLERANCE, "tolerance", "CODES",
	    "for --compare; values for float files (default 0)" },
	{ 0, NULL, NULL, NULL },
};

static bool
set_option(struct cmd *cmd, int key, const char *arg)
{
	struct info_opts *o = cmd->tool->opts;

	switch (key) {
	case KEY_CHANNEL:
		o->channel = arg;
		return true;
	case KEY_CHECK:
		o->check = true;
		return true;
	case KEY_COMPARE:
		o->compare = true;
		return true;
	case KEY_DEPTH:
		o->depth = arg;
		return true;
	case 's':
		return cmd_number(
		    cmd, "depth-scale", arg, 0, 1e6, &o->depth_scale);
	case KEY_JSON:
		o->json = true;
		return true;
	case KEY_NORMAL:
		o->normal = arg;
		return true;
	case KEY_SHEET:
		o->sheet = arg;
		return true;
	default:
		return cmd_number(
		    cmd, "tolerance", arg, 0, 1e30, &o->tolerance);
	}
}

/* Whether it could be printed and, with --check, nothing contradicts. */
static bool
print_report(
    struct cmd *cmd, const struct info_opts *o, const struct info_report *r)
{
	if (o->json) {
		if (!info_json(cmd, r))
			return false;
	} else if (!o->check || cmd->verbose) {
		info_text(r);
	}
	for (int i = 0; o->check && !o->json && i < r->bad.n; i++)
		printf("%s%s%s: %s\n", r->file, r->part != NULL ? ", " : "",
		    r->part != NULL ? r->part : "", r->bad.text[i]);
	return !o->check || r->bad.n == 0;
}

/* One file, or the relief map of a pair. */
static bool
info_file(struct cmd *cmd, const struct info_opts *o, const char *path)
{
	struct info_report r = INFO_REPORT_INIT;
	bool ok;

	r.file = path;
	r.pair = o->normal != NULL;
	ok = (!r.pair || cmd_read_raw(cmd, o->normal, &r.normal)) &&
	     cmd_read_raw(cmd, path, &r.map) && info_look(cmd, o, &r) &&
	     print_report(cmd, o, &r);
	info_report_free(&r);
	return ok;
}

/* Each part of an EXR file that has several, or is deep. */
static bool
info_parts(struct cmd *cmd, const struct info_opts *o, const char *path,
    struct bake_exr *exr)
{
	bool ok = exr != NULL;

	for (int i = 0; exr != NULL && i < bake_exr_nparts(exr); i++) {
		struct info_report r = INFO_REPORT_INIT;

		r.file = path;
		if (!info_exr_look(cmd, o, exr, i, &r) ||
		    !print_report(cmd, o, &r))
			ok = false;
		info_report_free(&r);
	}
	bake_exr_close(exr);
	return ok;
}

/* What is said of one file comes before what is said of the next, on either
 * stream. */
static int
info_operand(struct cmd *cmd, int i, void *opts)
{
	const struct info_opts *o = opts;
	const char *path = cmd->operands.item[i];
	struct bake_exr *exr;
	bool ok = info_exr_open(cmd, path, &exr) ? info_parts(cmd, o, path, exr)
						 : info_file(cmd, o, path);

	fflush(stdout); /* cmd_finish sees a failure */
	return ok ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

/* What is said of several files together. */
static int
info_together(struct cmd *cmd, int i, void *opts)
{
	const struct info_opts *o = opts;
	bool ok;

	(void)i;
	if (o->normal != NULL)
		ok = info_file(cmd, o, o->depth);
	else if (o->compare)
		ok = info_compare(
		    cmd, o, (const char *const *)cmd->operands.item);
	else
		ok = info_sheet(cmd, o);
	return ok ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

static bool
usage_is_right(const struct cmd *cmd, const struct info_opts *o)
{
	int n = cmd->operands.n;

	if ((o->normal == NULL) != (o->depth == NULL))
		return cmd_usage_error(
		    cmd, "a pair needs both --normal and --depth");
	if (o->normal != NULL && (n > 0 || o->compare || o->sheet != NULL))
		return cmd_usage_error(
		    cmd, "--normal and --depth take no further file");
	if (o->compare && n != 2)
		return cmd_usage_error(
		    cmd, "--compare takes 2 files, not %d", n);
	if (o->normal == NULL && n == 0)
		return cmd_usage_error(cmd, "no input");
	return true;
}

static int
run(struct cmd *cmd, struct info_opts *o)
{
	if (!usage_is_right(cmd, o))
		return CMD_EXIT_USAGE;
	if (o->normal != NULL || o->compare || o->sheet != NULL)
		return cmd_one(cmd, info_together, o);
	return cmd_batch(cmd, &cmd->operands, info_operand, o);
}

int
main(int argc, char *argv[])
{
	struct info_opts o = { .tolerance = 0 };
	struct cmd_tool tool = { "rm-info", "FILE ...",
		"Tell what textures are and whether their maps agree.", options,
		CMD_OPTS_RELIEF | CMD_OPTS_NORMAL, set_option, &o, main, 60,
		NULL };
	struct cmd cmd;
	int status;

	if (cmd_parse(&cmd, &tool, argc, argv, &status))
		status = run(&cmd, &o);
	return cmd_finish(&cmd, status);
}
