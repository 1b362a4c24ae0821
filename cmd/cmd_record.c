/* Records: what an output was made of, as a digest and a list of files. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "cmd_recipe_priv.h"

/* -- files that inputs name ------------------------------------------------ */

static struct further *
further(struct cmd_recipe *r, const char *path)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct further *f;

	for (int i = 0; i < r->nfurther; i++)
		if (strcmp(r->further[i].path, path) == 0)
			return &r->further[i];
	r->further =
	    cmd_recipe_grow(r->further, r->nfurther, sizeof *r->further);
	f = &r->further[r->nfurther++];
	f->path = cmd_copy(path);
	f->known = bake_digest_file(path, &f->digest, &err) == BAKE_OK;
	return f;
}

static int
folder_length(const char *path)
{
	const char *slash = strrchr(path, '/');

	return slash != NULL ? (int)(slash + 1 - path) : 0;
}

/* The name of a file in a record: N/REST is beside input N, N+REST has a name
 * that begins with it. False where no input leads to it. */
static bool
put_item(const struct cmd_recipe *r, const char *path, FILE *fp)
{
	static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
				    "abcdefghijklmnopqrstuvwxyz0123456789._/-";

	for (int i = 0; i < r->ninputs; i++) {
		const char *arg = r->input[i].arg;
		bool prefix = (r->input[i].mark & CMD_ARG_PREFIX) != 0;
		size_t n = prefix ? strlen(arg) : (size_t)folder_length(arg);

		if (strncmp(path, arg, n) != 0 || path[n] == '/')
			continue;
		fprintf(fp, "%d%c", i, prefix ? '+' : '/');
		for (const char *p = path + n; *p != '\0'; p++)
			if (strchr(plain, *p) != NULL)
				putc(*p, fp);
			else
				fprintf(fp, "%%%02x", (unsigned char)*p);
		putc('|', fp);
		return true;
	}
	return false;
}

static bool
is_main(const struct cmd_recipe *r, const char *path)
{
	for (int i = 0; i < r->ninputs; i++)
		if (strcmp(r->input[i].arg, path) == 0)
			return true;
	return false;
}

static bool
came_before(const struct cmd *cmd, int from, int to)
{
	for (int i = from; i < to; i++)
		if (strcmp(cmd->read.item[i], cmd->read.item[to]) == 0)
			return true;
	return false;
}

/* The list of what was read beside the inputs; "" where there is nothing to
 * say. False where it cannot be told, or is too long. */
static bool
make_list(struct cmd *cmd, struct cmd_recipe *r, char list[BAKE_RECORD_LIST])
{
	char *text = NULL;
	size_t n = 0, nothing;
	FILE *fp = cmd_need(open_memstream(&text, &n));
	bool ok = true;

	fputs("files:|", fp);
	if (r->set[0] != '\0')
		fprintf(fp, "set=%s|", r->set);
	for (int i = r->nread; ok && i < cmd->read.n; i++)
		if (!is_main(r, cmd->read.item[i]) &&
		    !came_before(cmd, r->nread, i))
			ok = put_item(r, cmd->read.item[i], fp);
	putc('!', fp);
	if (fclose(fp) != 0) /* glibc tells of no memory by text alone */
		cmd_need(NULL);
	cmd_need(text);
	nothing = strlen("files:|!");
	ok = ok && n < BAKE_RECORD_LIST;
	if (ok)
		strcpy(list, n > nothing ? text : "");
	free(text);
	return ok;
}

/* The path that an item of a list says, to be freed; NULL: none. */
static char *
item_path(const struct cmd_recipe *r, const char *item, size_t n)
{
	char *end, *path, *to;
	long i = strtol(item, &end, 10);
	const char *arg;
	size_t first;

	if (end == item || i < 0 || i >= r->ninputs ||
	    (*end != '/' && *end != '+'))
		return NULL;
	arg = r->input[i].arg;
	first = *end == '+' ? strlen(arg) : (size_t)folder_length(arg);
	path = to = cmd_need(malloc(first + n + 1));
	memcpy(path, arg, first);
	to += first;
	for (const char *p = end + 1; p < item + n; p++) {
		unsigned c;

		if (*p == '%' && sscanf(p + 1, "%2x", &c) == 1) {
			*to++ = (char)c;
			p += 2;
		} else {
			*to++ = *p;
		}
	}
	*to = '\0';
	return path;
}

/* -- the digest ------------------------------------------------------------ */

/* Add the files of a list to the digest in fp, and to names if that is not
 * NULL. False where one cannot be read. */
bool
cmd_recipe_put_list(
    struct cmd_recipe *r, const char *list, FILE *fp, struct cmd_list *names)
{
	const char *item = strchr(list, '|');

	while (item != NULL && *++item != '!' && *item != '\0') {
		size_t n = strcspn(item, "|");
		char *path;
		struct further *f;

		if (strncmp(item, "set=", 4) != 0) {
			path = item_path(r, item, n);
			f = path != NULL ? further(r, path) : NULL;
			if (f != NULL && f->known && names != NULL)
				cmd_list_add(names, path);
			if (f != NULL && f->known && fp != NULL)
				cmd_recipe_put_digest(fp, 'f', &f->digest);
			free(path);
			if (f == NULL || !f->known)
				return false;
		}
		item += n;
	}
	return true;
}

bool
cmd_recipe_digest(struct cmd_recipe *r, const char *label, const char *list,
    struct bake_digest *digest)
{
	char *text = NULL;
	size_t n = 0;
	FILE *fp = cmd_need(open_memstream(&text, &n));
	bool ok;

	fwrite(r->main, 1, r->nmain, fp);
	cmd_recipe_put_text(fp, 'l', label);
	cmd_recipe_put_text(fp, 's', list);
	ok = cmd_recipe_put_list(r, list, fp, NULL);
	if (fclose(fp) != 0) /* glibc tells of no memory by text alone */
		cmd_need(NULL);
	cmd_need(text);
	*digest = bake_digest_of(text, n);
	free(text);
	return ok;
}

bool
cmd_recipe_record(struct cmd *cmd, const char *path, struct cmd_record *record)
{
	struct cmd_recipe *r = cmd_recipe_of(cmd);
	const struct planned *p = cmd_recipe_find(r, path);
	struct bake_digest digest;

	memset(record, 0, sizeof *record);
	record->trouble = r->trouble;
	if (p == NULL || r->none || (r->stdin_at >= 0 && !r->has_stdin) ||
	    !make_list(cmd, r, record->list) ||
	    !cmd_recipe_digest(r, p->label, record->list, &digest)) {
		record->list[0] = '\0';
		return false;
	}
	bake_record_text(&digest, record->text);
	return true;
}

void
cmd_recipe_attrs(struct cmd *cmd, const char *path, struct bake_attrs *attrs,
    struct cmd_record *record)
{
	bake_attrs_remove(attrs, "Recipe");
	bake_attrs_remove(attrs, "RecipeFiles");
	if (!cmd_recipe_record(cmd, path, record))
		return;
	bake_attrs_set(attrs, "Recipe", record->text);
	if (record->list[0] != '\0')
		bake_attrs_set(attrs, "RecipeFiles", record->list);
}

enum bake_status
cmd_recipe_seal(
    const struct cmd_record *record, FILE *stream, struct bake_err *err)
{
	if (record->trouble.code != BAKE_OK) {
		*err = record->trouble;
		return err->code;
	}
	return record->text[0] == '\0'
		   ? BAKE_OK
		   : bake_record_seal(stream, record->text, err);
}
