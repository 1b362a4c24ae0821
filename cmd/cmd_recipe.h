/* The record in every output of what it was made of, and --if-changed. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_RECIPE_H
#define CMD_RECIPE_H

#include "cmd.h"
#include "record.h"

/*
 * Every output of a job carries a record (record.h): the digest of the tool,
 * its version, the options that can change the result, as they were given (in
 * their order where the tool goes by it, CMD_IN_ORDER), the content of every
 * input, which of the job's outputs it is, and of which type. Names of files
 *are no part of it. With --if-changed a job whose outputs are all there with
 *the record that they would get, and whole, is not done.
 *
 *	cmd_recipe_begin(cmd, i);
 *	cmd_recipe_output(cmd, path, "ao");
 *	if (cmd_unchanged(cmd))
 *		return true;
 *	… read, bake, cmd_write(cmd, img, path, …)
 *
 * An option of a tool that names files, or does not change what is written,
 * says so in the tool's marks.
 */
/* An option or an operand was parsed; option NULL: one that belongs to the
 * option before it. */
void cmd_recipe_given(struct cmd *cmd, const char *option, const char *arg);
void cmd_recipe_operand(struct cmd *cmd);
void cmd_recipe_free(struct cmd *cmd);

/* Begin job i of a batch (operand i, or the i-th of each option marked
 * CMD_ARG_EACH); below 0, all operands together. Inputs are read, for their
 * digests. */
void cmd_recipe_begin(struct cmd *cmd, int i);

/* The job will write this: "ao", "bent". A path that is NULL is none. */
void cmd_recipe_output(struct cmd *cmd, const char *path, const char *label);

/*
 * Whether --if-changed was given and the job need not be done: its outputs are
 * whole and up to date. They then got the present time, and are noted, as all
 * that they depend on is, for the depfile.
 */
bool cmd_unchanged(struct cmd *cmd);

/*
 * The same where only a record tells which outputs there are: more is called
 * for each output in turn whose record holds a set, and adds the others with
 * cmd_recipe_output. The set was given to cmd_recipe_set before the output was
 * written: a text of letters, digits and ",".
 */
typedef void cmd_more_fn(
    struct cmd *cmd, const char *label, const char *set, const void *arg);
bool cmd_unchanged_set(struct cmd *cmd, cmd_more_fn *more, const void *arg);
void cmd_recipe_set(struct cmd *cmd, const char *set);

/* The outputs of this job get no record: what they depend on cannot be told. */
void cmd_recipe_none(struct cmd *cmd);
/* The same where $OCIO names a colour configuration, which may read any number
 * of files: for jobs that convert colours. */
void cmd_recipe_color(struct cmd *cmd);

/* Standard input, which was an input, held these bytes. */
void cmd_recipe_stdin(struct cmd *cmd, const struct bake_digest *digest);

/* The two texts of an output's record, to be put into it and sealed by
 * cmd_recipe_seal; false, with empty texts, where it gets none. */
struct cmd_record {
	char text[BAKE_RECORD_TEXT], list[BAKE_RECORD_LIST];
	struct bake_err trouble; /* what cmd_recipe_seal fails with */
};
bool cmd_recipe_record(
    struct cmd *cmd, const char *path, struct cmd_record *record);
/* The same into attributes, as 'Recipe' and 'RecipeFiles'; those that an input
 * left there are dropped. */
void cmd_recipe_attrs(struct cmd *cmd, const char *path,
    struct bake_attrs *attrs, struct cmd_record *record);
enum bake_status cmd_recipe_seal(
    const struct cmd_record *record, FILE *stream, struct bake_err *err);

/* For formats without a place for a record: with --if-changed, whether the
 * file at path holds just the bytes of stream; it then gets the present time.
 */
bool cmd_same_bytes(struct cmd *cmd, FILE *stream, const char *path);

#endif
