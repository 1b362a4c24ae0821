/* The frame that the tools share: options, messages, files, exit codes. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_H
#define CMD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "cmd_progress.h"
#include "conventions.h"
#include "io_image.h"
#include "parallel.h"
#include "relief.h"

enum { CMD_EXIT_OK = 0, CMD_EXIT_FAIL = 1, CMD_EXIT_USAGE = 2 };

/* Keys of options that have no letter begin here. An operand has a key where
 * the tool asks for them in order (CMD_IN_ORDER). */
enum { CMD_KEY_OPERAND = 1, CMD_KEY_LONG = 256, CMD_KEY_TOOL = 512 };

/*
 * One option. Usage text, getopt and the shell's completion come from this
 * table; keep it sorted by the long name.
 */
struct cmd_option {
	int key;          /* its letter, or CMD_KEY_TOOL + n */
	const char *name; /* long name, without the dashes */
	const char *arg;  /* what its argument is called; NULL: a flag;
			   * "[=N]": may be left out (long names only) */
	const char *help; /* one line; {word} is a value that it may have,
			   * {FILE}, {MESH}: so may a file's name; --help
			   * prints it without the braces */
};

/* Groups of options that several tools have. */
enum {
	CMD_OPTS_OUTPUT = 1,        /* -o -O -d -M --format --png-level */
	CMD_OPTS_RELIEF = 2,        /* --height --wrap --depth-range */
	CMD_OPTS_NORMAL = 4,        /* --normal-y --normal-code */
	CMD_OPTS_OUTPUT_NORMAL = 8, /* --output-normal-y */
	/* no options: set is called with CMD_KEY_OPERAND for each operand,
	 * between the options before it and those after it */
	CMD_IN_ORDER = 16,
	/* -o is what the names of several outputs begin with */
	CMD_OUTPUT_PREFIX = 32,
	CMD_OPTS_CHANGED = 64, /* --if-changed, which CMD_OPTS_OUTPUT has */
	CMD_OPTS_TILES = 128   /* --tiles */
};

/* An output whose type nothing says; %s is its name. */
#define CMD_NO_TYPE                                                            \
	"%s: its name does not say what to write: end it in .png, .tga, "      \
	".tiff or .exr, or use --format"

struct cmd;
struct cmd_recipe;

/* What an option is to the record of outputs (cmd_recipe.h); one that is not
 * marked counts with the text of its argument. */
enum {
	CMD_ARG_INPUT = 1,  /* a file that is read: its content counts; a pipe's
			     * cannot be known, which leaves the record out */
	CMD_ARG_EACH = 2,   /* the same; given once for each job of a batch */
	CMD_ARG_PREFIX = 4, /* the same; or what names of inputs begin with */
	CMD_ARG_NEUTRAL = 8, /* changes no output, or names one */
	CMD_ARG_REPORT = 16  /* prints: a job is never left out */
};
struct cmd_mark {
	const char *name; /* of the option */
	unsigned mark;
	const char *words; /* arguments that are no files: " none auto "; or
			    * NULL */
};

struct cmd_tool {
	const char *name;
	const char *operands;             /* for the usage line: "IN …" */
	const char *about;                /* what it does, one line */
	const struct cmd_option *options; /* its own, ended by .name = NULL */
	unsigned groups;
	/* take one of its own options; false: wrong usage, the reason printed
	 * by cmd_usage_error */
	bool (*set)(struct cmd *cmd, int key, const char *arg);
	void *opts;                          /* the tool's own state, for set */
	int (*main)(int argc, char *argv[]); /* the tool, for --each */
	/* what a job needs at its peak, in bytes for each texel of the first
	 * image that it reads (or, of a mesh, for each byte of its file) */
	double texel_bytes;
	/* what its options are to the record of outputs (cmd_recipe.h), ended
	 * by .name = NULL */
	const struct cmd_mark *marks;
};

/* Where jobs are done: in processes apart where there are several, always,
 * never. */
enum cmd_isolate { CMD_ISOLATE_BATCH = 0, CMD_ISOLATE_YES, CMD_ISOLATE_NO };

/* A growing list of texts. */
struct cmd_list {
	char **item;
	int n;
};

/* What was asked for: the common options, and the operands. */
struct cmd {
	const struct cmd_tool *tool;
	FILE *err;            /* standard error, for our messages alone */
	struct cmd_list args; /* response files expanded */
	struct cmd_list operands;
	const char *output, *output_dir, *depfile;
	bool has_data_format, has_type, has_wrap;
	enum bake_data_format data_format;
	enum bake_file_type type;
	int png_level;
	int tile; /* side of the outputs' tiles; 0: none */
	int nthreads;
	double memory; /* of all jobs, bytes; 0: not said */
	enum cmd_isolate isolate;
	const char *each; /* the file of names; NULL: none */
	bool quiet, verbose, if_changed;
	struct cmd_recipe *recipe; /* cmd_recipe.h */
	struct bake_read_limits limits;
	enum bake_polarity polarity; /* of every input relief map */
	bool has_polarity;
	struct bake_wrap wrap;
	enum bake_normal_y normal_y; /* of input; UP by default */
	bool has_normal_y;
	enum bake_normal_y output_normal_y; /* UNSURE: the target's, or up */
	enum bake_normal_code normal_code;
	bool normalize; /* --depth-range auto */
	bool has_depth_range;
	double depth_near, depth_far; /* --depth-range NEAR,FAR */
	struct cmd_list read;         /* files read, for the depfile */
	struct cmd_list written;
	struct cmd_list warnings; /* held back */
};

/*
 * Parse the command line. Returns true where the tool should run; else
 * *exit_status is what to leave with (help, version, wrong usage).
 *
 *	int
 *	main(int argc, char *argv[])
 *	{
 *		struct opts o = {…};
 *		struct cmd_tool tool = {…, .set = set_option, .opts = &o };
 *		struct cmd cmd;
 *		int status;
 *
 *		if (cmd_parse(&cmd, &tool, argc, argv, &status))
 *			status = run(&cmd, &o);
 *		return cmd_finish(&cmd, status);
 *	}
 */
bool cmd_parse(struct cmd *cmd, const struct cmd_tool *tool, int argc,
    char *argv[], int *exit_status);

/* Write the depfile where status is CMD_EXIT_OK, flush standard output
 * (failing where that fails), free all; returns the final exit status. */
int cmd_finish(struct cmd *cmd, int status);

/*
 * One line on stderr: 'rm-tool: …'; control characters are replaced. cmd_warn
 * is silent with --quiet, cmd_note without --verbose.
 *
 * Warnings are held back until cmd_flush_warnings, which cmd_write and
 * cmd_finish call: a file that fails after all is reported by its error alone,
 * which drops what was held.
 */
void cmd_error(struct cmd *cmd, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));
void cmd_warn(struct cmd *cmd, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));
void cmd_note(const struct cmd *cmd, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));
void cmd_flush_warnings(struct cmd *cmd);
/* The reason, then the usage line; returns false, so that a setter can
 * return it. */
bool cmd_usage_error(const struct cmd *cmd, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));

/* From now on only our own messages reach standard error: image libraries
 * print there too. With --verbose they may. */
void cmd_silence_libraries(const struct cmd *cmd);

/* Whether n inputs go with the outputs that were asked for: at least one, and
 * one only with -o; otherwise a usage error. */
bool cmd_inputs_fit(const struct cmd *cmd, int n);

/* Strict numbers: the whole text, within lo .. hi; otherwise a usage error
 * that names the option, and false. */
bool cmd_int(const struct cmd *cmd, const char *option, const char *text,
    long lo, long hi, int *value);
bool cmd_number(const struct cmd *cmd, const char *option, const char *text,
    double lo, double hi, double *value);
/* A comma-separated list of 1 .. max numbers; *n is how many. */
bool cmd_numbers(const struct cmd *cmd, const char *option, const char *text,
    double lo, double hi, double *value, int max, int *n);
/* A size in bytes: a number, with K, M, G or T for powers of 1024. */
bool cmd_bytes(
    const struct cmd *cmd, const char *option, const char *text, double *bytes);
/* WxH in texels. */
bool cmd_size(const struct cmd *cmd, const char *option, const char *text,
    int *width, int *height);
/* One of n names; *index is which. */
bool cmd_choice(const struct cmd *cmd, const char *option, const char *text,
    const char *const *names, int n, int *index);

/* p; where it is NULL, memory for a few words of text, nothing else would work
 * either: the process ends with an error. */
void *cmd_need(void *p);
/* A copy of the text, to be freed; NULL of NULL. */
char *cmd_copy(const char *text);

/* Append a copy of the text. */
void cmd_list_add(struct cmd_list *list, const char *text);
void cmd_list_free(struct cmd_list *list);
/* Drop all items from the n-th on. */
void cmd_list_cut(struct cmd_list *list, int n);
/* Append all of from, which is empty then. */
void cmd_list_move(struct cmd_list *list, struct cmd_list *from);

/* The lines of a file, empty ones passed over, "-" being standard input; it is
 * noted as read. False with the reason printed. */
bool cmd_read_lines(struct cmd *cmd, const char *path, struct cmd_list *lines);

/* PATH with suffix put before its extension, and another extension where ext
 * (with its dot) is given; in dir instead of its own folder where dir is not
 * NULL. Caller frees. */
char *cmd_path_derive(
    const char *path, const char *dir, const char *suffix, const char *ext);

/* Whether path_of gives each input another path (NULL counts as none) where
 * -O is used; otherwise a usage error that names two that share one. What it
 * returns is freed. */
bool cmd_paths_differ(const struct cmd *cmd, const struct cmd_list *inputs,
    char *(*path_of)(const struct cmd *cmd, const char *input, const void *arg),
    const void *arg);

#endif
