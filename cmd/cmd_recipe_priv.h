/* What the parts of cmd_recipe.h share. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_RECIPE_PRIV_H
#define CMD_RECIPE_PRIV_H

#include "cmd_recipe.h"

/* An option as it was given, or an operand. */
struct given {
	char *option; /* NULL: an operand */
	char *arg;    /* NULL: a flag */
	bool operand;
};

/* A file of the command line. */
struct input {
	const char *arg;
	unsigned mark;
};

/* What is written. */
struct planned {
	char *path, *label;
};

/* A file that is read because another one names it. */
struct further {
	char *path;
	struct bake_digest digest;
	bool known;
};

struct cmd_recipe {
	struct given *given;
	int ngiven;
	bool reports;

	/* of this job */
	bool begun, none, in_place;
	struct bake_err trouble; /* an input that is there cannot be read */
	char *main;              /* what is known before anything is read */
	size_t nmain;
	long stdin_at; /* where standard input's digest goes; -1: nowhere */
	bool has_stdin;
	struct input *input;
	int ninputs;
	struct planned *planned;
	int nplanned;
	struct further *further;
	int nfurther;
	int nread; /* files that were read before */
	char set[64];
};

/* Room for one more; the array, grown. */
void *cmd_recipe_grow(void *array, int n, size_t size);

/* Made where there is none yet. */
struct cmd_recipe *cmd_recipe_of(struct cmd *cmd);

/* A text with its length before it, so that no two lists are one text. */
void cmd_recipe_put_text(FILE *fp, char kind, const char *text);
void cmd_recipe_put_digest(FILE *fp, char kind, const struct bake_digest *d);

/* The output that was planned at path, or NULL. */
const struct planned *cmd_recipe_find(
    const struct cmd_recipe *r, const char *path);

/* Add the files of a list to the digest in fp, and to names, where these are
 * not NULL. False where one cannot be read. */
bool cmd_recipe_put_list(
    struct cmd_recipe *r, const char *list, FILE *fp, struct cmd_list *names);

/* The digest of what that output is made of; false the same way. */
bool cmd_recipe_digest(struct cmd_recipe *r, const char *label,
    const char *list, struct bake_digest *digest);

#endif
