/* The frame that the tools share: the command line, from one option table. */
/* SPDX-License-Identifier: MIT */
#include "cmd.h"

#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cmd_batch_priv.h"
#include "cmd_recipe.h"
#include "cmd_signal.h"

enum {
	KEY_DEPTH_RANGE = CMD_KEY_LONG,
	KEY_EACH,
	KEY_FORMAT,
	KEY_HEIGHT,
	KEY_IF_CHANGED,
	KEY_ISOLATE,
	KEY_MAX_PIXELS,
	KEY_MEMORY,
	KEY_NO_ISOLATE,
	KEY_NORMAL_CODE,
	KEY_NORMAL_Y,
	KEY_OUTPUT_NORMAL_Y,
	KEY_PNG_LEVEL,
	KEY_TILES,
	KEY_WRAP
};

/* Options that several tools have, and the group that each belongs to; group
 * 0 belongs to all. */
static const struct {
	unsigned group;
	struct cmd_option opt;
} common[] = {
	{ CMD_OPTS_OUTPUT,
	    { 'd', "data-format", "FORMAT",
		"{uint8}, {uint16}, {half} or {float}; default: the "
		"inputs' deepest" } },
	{ CMD_OPTS_OUTPUT,
	    { 'M', "depfile", "FILE",
		"write a Make rule: the outputs and all that was read" } },
	{ CMD_OPTS_RELIEF,
	    { KEY_DEPTH_RANGE, "depth-range", "NEAR,FAR",
		"input values of depth 0 and 1, or '{auto}' (default "
		"0,1)" } },
	{ 0, { KEY_EACH, "each", "FILE",
		 "run once for each line of FILE, put where a % stands" } },
	{ CMD_OPTS_OUTPUT, { KEY_FORMAT, "format", "TYPE",
			       "{png}, {tga}, {tiff} or {exr}; default: by the "
			       "output's name" } },
	{ CMD_OPTS_RELIEF,
	    { KEY_HEIGHT, "height", NULL,
		"input relief maps are heights: white is high" } },
	{ 0, { 'h', "help", NULL, "print this and leave" } },
	{ CMD_OPTS_OUTPUT | CMD_OPTS_CHANGED,
	    { KEY_IF_CHANGED, "if-changed", NULL,
		"leave outputs alone that would become what they are" } },
	{ 0, { KEY_ISOLATE, "isolate", NULL,
		 "work in a process apart; many inputs always do" } },
	{ 0, { KEY_MAX_PIXELS, "max-pixels", "N",
		 "refuse larger inputs (default 2^30 texels)" } },
	{ 0, { KEY_MEMORY, "memory", "SIZE",
		 "of all jobs together, as 8G (default: 3/4 of the "
		 "machine's)" } },
	{ 0, { KEY_NO_ISOLATE, "no-isolate", NULL,
		 "many inputs one by one in this process" } },
	{ CMD_OPTS_NORMAL,
	    { KEY_NORMAL_CODE, "normal-code", "CODE",
		"input normals: {unsigned}, {signed} or {auto} (default)" } },
	{ CMD_OPTS_NORMAL,
	    { KEY_NORMAL_Y, "normal-y", "up|down",
		"where input normals' positive y points (default up)" } },
	{ CMD_OPTS_OUTPUT,
	    { 'o', "output", "FILE", "output; - is standard output" } },
	{ CMD_OPTS_OUTPUT,
	    { 'O', "output-dir", "DIR",
		"many inputs: write there, each under its own name" } },
	{ CMD_OPTS_OUTPUT_NORMAL,
	    { KEY_OUTPUT_NORMAL_Y, "output-normal-y", "up|down",
		"the same for output (default: the target's, else up)" } },
	{ CMD_OPTS_OUTPUT, { KEY_PNG_LEVEL, "png-level", "N",
			       "PNG deflate level, 1 to 9 (default 2)" } },
	{ 0, { 'q', "quiet", NULL, "no warnings" } },
	{ 0, { 'j', "threads", "N",
		 "threads, 1 to 1024 (default: all processors)" } },
	{ CMD_OPTS_TILES,
	    { KEY_TILES, "tiles", "N",
		"TIFF and EXR in tiles of NxN texels; 0: rows (default)" } },
	{ 0, { 'v', "verbose", NULL, "say what is being done" } },
	{ 0, { 'V', "version", NULL, "print the version and leave" } },
	{ CMD_OPTS_RELIEF, { KEY_WRAP, "wrap", "MODE",
			       "{tile} (default), {clamp}, {u} or {v} (that "
			       "axis alone tiles)" } },
};

enum { NCOMMON = sizeof common / sizeof *common, MAX_OPTIONS = 96 };

/* The tool's options and the common ones it has, sorted by name. */
struct table {
	struct cmd_option opt[MAX_OPTIONS];
	int n;
};

static int
by_name(const void *a, const void *b)
{
	return strcmp(((const struct cmd_option *)a)->name,
	    ((const struct cmd_option *)b)->name);
}

static void
make_table(struct table *t, const struct cmd_tool *tool)
{
	t->n = 0;
	for (const struct cmd_option *o = tool->options;
	     o->name != NULL && t->n < MAX_OPTIONS - NCOMMON; o++)
		t->opt[t->n++] = *o;
	for (int i = 0; i < NCOMMON; i++)
		if (common[i].group == 0 || (tool->groups & common[i].group))
			t->opt[t->n++] = common[i].opt;
	qsort(t->opt, (size_t)t->n, sizeof *t->opt, by_name);
}

/* The table as it is, for the scripts that make the shells' completions: the
 * operands, then each option with its letter, all apart by tabs. */
static int
print_options(const struct cmd_tool *tool)
{
	const bool in_order = (tool->groups & CMD_IN_ORDER) != 0;
	struct table t;

	make_table(&t, tool);
	printf("%s\t%s\n", in_order ? "in-order" : "any-order", tool->operands);
	for (int i = 0; i < t.n; i++) {
		const struct cmd_option *o = &t.opt[i];

		printf("%c\t%s\t%s\t%s\n", o->key < CMD_KEY_LONG ? o->key : '-',
		    o->name, o->arg ? o->arg : "", o->help);
	}
	return fflush(stdout) == 0 ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

/* Help without the braces around what may be completed. */
static void
put_help(const char *help)
{
	for (; *help != '\0'; help++)
		if (*help != '{' && *help != '}')
			putchar(*help);
	putchar('\n');
}

static void
print_help(const struct cmd_tool *tool)
{
	struct table t;

	make_table(&t, tool);
	printf("usage: %s [options] %s\n", tool->name, tool->operands);
	printf("%s\n\n", tool->about);
	for (int i = 0; i < t.n; i++) {
		const struct cmd_option *o = &t.opt[i];
		char left[64], letter[8] = "   ";

		if (o->key < CMD_KEY_LONG)
			snprintf(letter, sizeof letter, "-%c,", o->key);
		snprintf(left, sizeof left, "%s --%s%s%s", letter, o->name,
		    o->arg && o->arg[0] != '[' ? " " : "",
		    o->arg ? o->arg : "");
		printf("  %-30s ", left);
		put_help(o->help);
	}
	printf("\nSee %s(1) and rm-formats(5).\n", tool->name);
}

/* -- response files -------------------------------------------------- */

bool
cmd_read_lines(struct cmd *cmd, const char *path, struct cmd_list *lines)
{
	FILE *fp = strcmp(path, "-") == 0 ? stdin : fopen(path, "re");
	char *line = NULL;
	size_t size = 0;
	ssize_t n = 0;
	bool ok;

	if (fp == NULL) {
		cmd_error(cmd, "%s: %s", path, strerror(errno));
		return false;
	}
	while ((n = getline(&line, &size, fp)) > 0) {
		while (n > 0 && (line[n - 1] == '\n' || line[n - 1] == '\r'))
			line[--n] = '\0';
		if (n > 0)
			cmd_list_add(lines, line);
	}
	ok = ferror(fp) == 0;
	if (!ok)
		cmd_error(cmd, "%s: %s", path, strerror(errno));
	else if (fp != stdin)
		cmd_list_add(&cmd->read, path);
	free(line);
	if (fp != stdin)
		fclose(fp);
	return ok;
}

/* argv with each @FILE replaced by the lines of FILE, up to a "--". */
static bool
expand(struct cmd *cmd, struct cmd_list *args, int argc, char *argv[])
{
	bool operands_only = false;

	for (int i = 0; i < argc; i++) {
		if (strcmp(argv[i], "--") == 0)
			operands_only = true;
		if (i == 0 || operands_only || argv[i][0] != '@')
			cmd_list_add(args, argv[i]);
		else if (!cmd_read_lines(cmd, argv[i] + 1, args))
			return false;
	}
	return true;
}

/* -- the common options ----------------------------------------------- */

static bool
set_wrap(struct cmd *cmd, const char *arg)
{
	static const char *const names[] = { "tile", "v", "u", "clamp" };
	int i = 0;

	if (!cmd_choice(cmd, "wrap", arg, names, 4, &i))
		return false;
	cmd->wrap.clamp_u = (i & 1) != 0;
	cmd->wrap.clamp_v = (i & 2) != 0;
	cmd->has_wrap = true;
	return true;
}

static bool
set_normal_y(struct cmd *cmd, const char *option, const char *arg,
    enum bake_normal_y *normal_y)
{
	static const char *const names[] = { "up", "down" };
	int i;

	if (!cmd_choice(cmd, option, arg, names, 2, &i))
		return false;
	*normal_y = i == 0 ? BAKE_NORMAL_Y_UP : BAKE_NORMAL_Y_DOWN;
	return true;
}

static bool
set_depth_range(struct cmd *cmd, const char *arg)
{
	double v[2];
	int n;

	cmd->normalize = strcmp(arg, "auto") == 0;
	cmd->has_depth_range = !cmd->normalize;
	if (cmd->normalize)
		return true;
	if (!cmd_numbers(cmd, "depth-range", arg, -1e30, 1e30, v, 2, &n))
		return false;
	if (n != 2 || v[0] == v[1])
		return cmd_usage_error(cmd,
		    "--depth-range is '%s', expected two different numbers",
		    arg);
	cmd->depth_near = v[0];
	cmd->depth_far = v[1];
	return true;
}

static bool
set_tiles(struct cmd *cmd, const char *arg)
{
	if (!cmd_int(cmd, "tiles", arg, 0, 4096, &cmd->tile))
		return false;
	return cmd->tile % 16 == 0 ||
	       cmd_usage_error(
		   cmd, "--tiles is %s, expected a multiple of 16", arg);
}

static bool
set_output_option(struct cmd *cmd, int key, const char *arg)
{
	static const char *const formats[] = { "uint8", "uint16", "half",
		"float" };
	int i;

	switch (key) {
	case 'd':
		if (!cmd_choice(cmd, "data-format", arg, formats, 4, &i))
			return false;
		cmd->data_format = (enum bake_data_format)i;
		cmd->has_data_format = true;
		return true;
	case 'M':
		cmd->depfile = arg;
		return true;
	case KEY_FORMAT:
		cmd->has_type = bake_file_type_from_name(arg, &cmd->type);
		return cmd->has_type ||
		       cmd_usage_error(cmd,
			   "--format is '%s', expected png, tga, tiff or exr",
			   arg);
	case 'o':
		cmd->output = arg;
		return true;
	case 'O':
		cmd->output_dir = arg;
		return true;
	case KEY_TILES:
		return set_tiles(cmd, arg);
	default:
		return cmd_int(cmd, "png-level", arg, 1, 9, &cmd->png_level);
	}
}

static bool
set_common(struct cmd *cmd, int key, const char *arg)
{
	static const char *const codes[] = { "auto", "unsigned", "signed" };
	double texels;
	int i;

	switch (key) {
	case KEY_DEPTH_RANGE:
		return set_depth_range(cmd, arg);
	case KEY_EACH:
		cmd->each = arg;
		return true;
	case KEY_IF_CHANGED:
		cmd->if_changed = true;
		return true;
	case KEY_ISOLATE:
		cmd->isolate = CMD_ISOLATE_YES;
		return true;
	case KEY_MEMORY:
		return cmd_bytes(cmd, "memory", arg, &cmd->memory);
	case KEY_NO_ISOLATE:
		cmd->isolate = CMD_ISOLATE_NO;
		return true;
	case KEY_HEIGHT:
		cmd->polarity = BAKE_POLARITY_HEIGHT;
		cmd->has_polarity = true;
		return true;
	case KEY_MAX_PIXELS:
		if (!cmd_number(cmd, "max-pixels", arg, 1, 1e15, &texels))
			return false;
		cmd->limits.max_texels = (size_t)texels;
		cmd->limits.trust_size = true;
		return true;
	case KEY_NORMAL_CODE:
		if (!cmd_choice(cmd, "normal-code", arg, codes, 3, &i))
			return false;
		cmd->normal_code = (enum bake_normal_code)i;
		return true;
	case KEY_NORMAL_Y:
		cmd->has_normal_y = true;
		return set_normal_y(cmd, "normal-y", arg, &cmd->normal_y);
	case KEY_OUTPUT_NORMAL_Y:
		return set_normal_y(
		    cmd, "output-normal-y", arg, &cmd->output_normal_y);
	case 'q':
		cmd->quiet = true;
		return true;
	case 'j':
		return cmd_int(cmd, "threads", arg, 1, 1024, &cmd->nthreads);
	case 'v':
		cmd->verbose = true;
		return true;
	case KEY_WRAP:
		return set_wrap(cmd, arg);
	default:
		return set_output_option(cmd, key, arg);
	}
}

static bool
is_common(int key)
{
	for (int i = 0; i < NCOMMON; i++)
		if (common[i].opt.key == key)
			return true;
	return false;
}

/* -- parsing ------------------------------------------------------------ */

/* getopt's tables; letters has room for "x:" each and the leading "-:". With
 * in_order operands are not moved behind the options but come as
 * CMD_KEY_OPERAND, which getopt has for them. */
static void
make_getopt(
    const struct table *t, bool in_order, struct option *longs, char *letters)
{
	if (in_order)
		*letters++ = '-';
	*letters++ = ':';
	for (int i = 0; i < t->n; i++) {
		const struct cmd_option *o = &t->opt[i];

		longs[i].name = o->name;
		longs[i].has_arg = o->arg == NULL     ? no_argument
				   : o->arg[0] == '[' ? optional_argument
						      : required_argument;
		longs[i].flag = NULL;
		longs[i].val = o->key;
		if (o->key < CMD_KEY_LONG) {
			*letters++ = (char)o->key;
			if (o->arg)
				*letters++ = ':';
		}
	}
	memset(&longs[t->n], 0, sizeof longs[t->n]);
	*letters = '\0';
}

/* What getopt did not like: a letter is in optopt, a long option's text is the
 * argument just passed. */
static bool
bad_option(const struct cmd *cmd, int c, char *const argv[])
{
	const char *text = argv[optind - 1];

	if (c == ':')
		return cmd_usage_error(
		    cmd, "option %s needs an argument", text);
	if (optopt != 0 && strncmp(text, "--", 2) == 0)
		return cmd_usage_error(
		    cmd, "option %s takes no argument", text);
	if (optopt != 0)
		return cmd_usage_error(cmd, "unknown option -%c", optopt);
	return cmd_usage_error(cmd, "unknown or unclear option %s", text);
}

/* An output's type and data format are known before any work is done. */
static bool
output_is_clear(const struct cmd *cmd)
{
	enum bake_file_type type = cmd->type;
	bool by_name;

	if (cmd->output != NULL && cmd->output_dir != NULL)
		return cmd_usage_error(cmd, "-o and -O exclude each other");
	if (!(cmd->tool->groups & CMD_OPTS_OUTPUT) ||
	    (cmd->tool->groups & CMD_OUTPUT_PREFIX))
		return true; /* the tool knows what it writes */
	by_name =
	    cmd->output != NULL && bake_file_type_from_path(cmd->output, &type);
	if (cmd->output != NULL && !cmd->has_type && !by_name)
		return cmd_usage_error(cmd, CMD_NO_TYPE,
		    strcmp(cmd->output, "-") == 0 ? "standard output"
						  : cmd->output);
	if (by_name && cmd->has_type && type != cmd->type)
		return cmd_usage_error(cmd, "%s: its name says %s, --format %s",
		    cmd->output, bake_file_type_name(type),
		    bake_file_type_name(cmd->type));
	if (cmd->output == NULL && !cmd->has_type)
		return true;
	if (cmd->has_data_format &&
	    !bake_file_type_holds(type, cmd->data_format))
		return cmd_usage_error(cmd,
		    "%s files hold no %s values: choose another -d or type",
		    bake_file_type_name(type),
		    bake_data_format_name(cmd->data_format));
	return true;
}

static bool
add_operand(struct cmd *cmd, const char *arg)
{
	const int n = cmd->operands.n;

	cmd_list_add(&cmd->operands, arg);
	if ((cmd->tool->groups & CMD_IN_ORDER) &&
	    !cmd->tool->set(cmd, CMD_KEY_OPERAND, arg))
		return false;
	if (cmd->operands.n > n)
		cmd_recipe_operand(cmd);
	else /* it was an argument after all */
		cmd_recipe_given(cmd, NULL, arg);
	return true;
}

/* An option's long name, by its key. */
static const char *
name_of(const struct table *t, int key)
{
	for (int i = 0; i < t->n; i++)
		if (t->opt[i].key == key)
			return t->opt[i].name;
	return "";
}

enum parsed { PARSED_RUN, PARSED_DONE, PARSED_BAD };

static enum parsed
parse(struct cmd *cmd, const struct cmd_list *args)
{
	struct option longs[MAX_OPTIONS + 1];
	char letters[2 * MAX_OPTIONS + 3];
	struct table t;
	int c;

	make_table(&t, cmd->tool);
	make_getopt(
	    &t, (cmd->tool->groups & CMD_IN_ORDER) != 0, longs, letters);
	optind = 0; /* from the start, also a second time (--each) */
	opterr = 0;
	while ((c = getopt_long(args->n, args->item, letters, longs, NULL)) !=
	       -1) {
		bool ok;

		if (c == 'h') {
			print_help(cmd->tool);
			return PARSED_DONE;
		}
		if (c == 'V') {
			printf("%s %s\n", cmd->tool->name, RELIEF_VERSION);
			return PARSED_DONE;
		}
		if (c == '?' || c == ':')
			ok = bad_option(cmd, c, args->item);
		else if (c == CMD_KEY_OPERAND)
			ok = add_operand(cmd, optarg);
		else if (is_common(c))
			ok = set_common(cmd, c, optarg);
		else
			ok = cmd->tool->set(cmd, c, optarg);
		if (!ok)
			return PARSED_BAD;
		if (c != CMD_KEY_OPERAND)
			cmd_recipe_given(cmd, name_of(&t, c), optarg);
	}
	for (int i = optind; i < args->n; i++)
		if (!add_operand(cmd, args->item[i]))
			return PARSED_BAD;
	return output_is_clear(cmd) ? PARSED_RUN : PARSED_BAD;
}

/* Our own way to standard error, which stays open when the libraries' is
 * closed. */
static void
open_err(struct cmd *cmd)
{
	int fd = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);

	cmd->err = fd >= 0 ? fdopen(fd, "w") : NULL;
	if (cmd->err == NULL)
		cmd->err = stderr;
	cmd_signals_speak(fileno(cmd->err));
}

/* A make that runs jobs side by side has divided the processors already. */
static bool
under_parallel_make(void)
{
	const char *flags = getenv("MAKEFLAGS");

	return flags != NULL && strstr(flags, "--jobserver") != NULL;
}

bool
cmd_parse(struct cmd *cmd, const struct cmd_tool *tool, int argc, char *argv[],
    int *exit_status)
{
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	enum parsed parsed = PARSED_DONE;

	cmd_signals_start();
	memset(cmd, 0, sizeof *cmd);
	cmd->tool = tool;
	open_err(cmd);
	cmd->png_level = BAKE_PNG_LEVEL;
	cmd->limits = limits;
	cmd->polarity = BAKE_POLARITY_DEPTH;
	cmd->normal_y = BAKE_NORMAL_Y_UP;
	cmd->depth_far = 1;
	if (argc == 2 && strcmp(argv[1], "--print-options") == 0) {
		*exit_status = print_options(tool);
		return false;
	}
	if (!expand(cmd, &cmd->args, argc, argv)) {
		*exit_status = CMD_EXIT_FAIL;
		return false;
	}
	parsed = parse(cmd, &cmd->args);
	*exit_status = parsed == PARSED_BAD ? CMD_EXIT_USAGE : CMD_EXIT_OK;
	if (cmd_is_worker())
		cmd->nthreads = cmd_worker_threads();
	else if (cmd->nthreads == 0 && under_parallel_make())
		cmd->nthreads = 1;
	if (parsed == PARSED_RUN && cmd->each != NULL) {
		*exit_status = cmd_run_each(cmd);
		return false;
	}
	return parsed == PARSED_RUN;
}
