/* --if-changed: outputs that would become what they are. */
/* SPDX-License-Identifier: MIT */
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cmd_recipe_priv.h"

/* -- --if-changed ---------------------------------------------------------- */

/* Whether the output is there, whole, and made of what it would be made of. */
static bool
is_current(struct cmd *cmd, struct cmd_recipe *r, const struct planned *p,
    struct bake_record *record)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_digest digest;
	char text[BAKE_DIGEST_TEXT];

	if (strcmp(p->path, "-") == 0 ||
	    bake_record_read(p->path, record, &err) != BAKE_OK ||
	    record->digest[0] == '\0' ||
	    !cmd_recipe_digest(r, p->label, record->list, &digest))
		return false;
	bake_digest_text(&digest, text);
	if (strcmp(text, record->digest) != 0)
		return false;
	if (!record->whole)
		cmd_note(cmd, "%s: was changed since it was written", p->path);
	return record->whole;
}

static void
take_set(const struct bake_record *record, char *set, size_t size)
{
	const char *at = strstr(record->list, "|set=");

	set[0] = '\0';
	if (at != NULL)
		snprintf(set, size, "%.*s", (int)strcspn(at + 5, "|"), at + 5);
}

/* All outputs have the present time, or none matters. */
static bool
renew_times(const struct cmd_recipe *r)
{
	for (int i = 0; i < r->nplanned; i++)
		if (utimensat(AT_FDCWD, r->planned[i].path, NULL, 0) != 0)
			return false;
	return true;
}

bool
cmd_unchanged_set(struct cmd *cmd, cmd_more_fn *more, const void *arg)
{
	struct cmd_recipe *r = cmd_recipe_of(cmd);
	struct cmd_list names = { NULL, 0 };
	bool ok = cmd->if_changed && !r->none && !r->in_place && !r->reports &&
		  r->stdin_at < 0 && r->nplanned > 0;

	for (int i = 0; ok && i < r->nplanned; i++) {
		struct bake_record record;
		char set[64];

		ok = is_current(cmd, r, &r->planned[i], &record) &&
		     cmd_recipe_put_list(r, record.list, NULL, &names);
		take_set(&record, set, sizeof set);
		/* the label without its type */
		if (ok && more != NULL && set[0] != '\0') {
			char *label = cmd_copy(r->planned[i].label);

			*strrchr(label, ' ') = '\0';
			more(cmd, label, set, arg);
			free(label);
		}
	}
	ok = ok && !r->none && !r->in_place && renew_times(r);
	if (ok) {
		cmd_note(cmd, "%s: up to date", r->planned[0].path);
		for (int i = 0; i < r->ninputs; i++)
			if (!(r->input[i].mark & CMD_ARG_PREFIX) ||
			    access(r->input[i].arg, F_OK) == 0)
				cmd_list_add(&cmd->read, r->input[i].arg);
		for (int i = 0; i < r->nplanned; i++)
			cmd_list_add(&cmd->written, r->planned[i].path);
		cmd_list_move(&cmd->read, &names);
	}
	cmd_list_free(&names);
	/* what was hashed now may change until it is read */
	for (int i = 0; i < r->nfurther; i++)
		free(r->further[i].path);
	r->nfurther = 0;
	return ok;
}

bool
cmd_unchanged(struct cmd *cmd)
{
	return cmd_unchanged_set(cmd, NULL, NULL);
}

/* -- formats without a record ---------------------------------------------- */

static bool
same_content(FILE *a, FILE *b)
{
	char x[16384], y[16384];
	size_t n;

	rewind(a);
	do {
		n = fread(x, 1, sizeof x, a);
		if (fread(y, 1, sizeof y, b) != n || memcmp(x, y, n) != 0)
			return false;
	} while (n == sizeof x);
	return !ferror(a) && !ferror(b);
}

bool
cmd_same_bytes(struct cmd *cmd, FILE *stream, const char *path)
{
	struct stat st;
	FILE *fp;
	bool same;

	if (!cmd->if_changed || strcmp(path, "-") == 0 || fflush(stream) != 0 ||
	    stat(path, &st) != 0 || !S_ISREG(st.st_mode) ||
	    (fp = fopen(path, "rbe")) == NULL)
		return false;
	same =
	    same_content(stream, fp) && utimensat(AT_FDCWD, path, NULL, 0) == 0;
	fclose(fp);
	if (same)
		cmd_note(cmd, "%s: up to date", path);
	else if (fseeko(stream, 0, SEEK_END) != 0)
		return false;
	return same;
}
