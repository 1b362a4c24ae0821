/* Fuzz target: any command line of any tool, up to where work begins. */
/* SPDX-License-Identifier: MIT */
#include "fuzz_tools.h"

int LLVMFuzzerInitialize(int *argc, char ***argv);

/*
 * The first byte is the tool, from 'a' on; every line after it an argument. A
 * line that ends in '@' ("@", "--each=@") gets the path of a file put there,
 * which holds all lines that follow.
 */
enum { MAX_ARGS = 64 };

struct line {
	int argc;
	char *argv[MAX_ARGS + 2];
	int fd; /* of the file; -1: none */
};

int
LLVMFuzzerInitialize(int *argc, char ***argv)
{
	char *folder = fuzz_make_folder(), *inner;
	int jail;

	/* in a folder that is gone nothing can be read or written, nor in the
	 * one above */
	(void)argc, (void)argv;
	if (asprintf(&inner, "%s/x", folder) < 0 || mkdir(inner, 0700) != 0)
		abort();
	jail = open(inner, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (rmdir(inner) != 0 || rmdir(folder) != 0)
		abort();
	free(inner);
	free(folder);
	fuzz_open_jail(jail);
	return 0;
}

static int
is_digit(char c)
{
	return c >= '0' && c <= '9';
}

/* No path leads out: a '/' is left between digits alone. */
static void
tame(char *text, size_t n)
{
	for (size_t i = 0; i < n; i++)
		if (text[i] == '/' && (i == 0 || !is_digit(text[i - 1]) ||
					  !is_digit(text[i + 1])))
			text[i] = ':';
}

static char *
file_of(struct line *l, const char *arg, const char *rest)
{
	char *text;

	l->fd = memfd_create("fuzz", MFD_CLOEXEC);
	if (l->fd < 0 ||
	    write(l->fd, rest, strlen(rest)) != (ssize_t)strlen(rest) ||
	    asprintf(&text, "%.*s/proc/self/fd/%d",
		(int)strlen(arg) - (strcmp(arg, "@") != 0), arg, l->fd) < 0)
		abort();
	return text;
}

static void
split(struct line *l, const char *tool, char *text)
{
	l->argv[l->argc++] = strdup(tool);
	while (text != NULL && l->argc < MAX_ARGS && l->fd < 0) {
		char *arg = strsep(&text, "\n");
		size_t n = strlen(arg);

		l->argv[l->argc++] =
		    n > 0 && arg[n - 1] == '@'
			? file_of(l, arg, text != NULL ? text : "")
			: strdup(arg);
	}
}

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	struct line l = { .argc = 0, .fd = -1 };
	char *text;

	if (size < 2 || bytes[0] < 'a' || bytes[0] >= 'a' + FUZZ_NTOOLS ||
	    bytes[1] != '\n' || size > 4096)
		return -1;
	if ((text = malloc(size - 1)) == NULL)
		return 0;
	memcpy(text, bytes + 2, size - 2);
	text[size - 2] = '\0';
	tame(text, size - 2);
	split(&l, fuzz_tools[bytes[0] - 'a'].name, text);
	fuzz_most_bytes = 1 << 14;
	fuzz_run(fuzz_tools[bytes[0] - 'a'].main, l.argc, l.argv);
	fuzz_most_bytes = SIZE_MAX;
	for (int i = 0; i < l.argc; i++)
		free(l.argv[i]);
	if (l.fd >= 0)
		close(l.fd);
	free(text);
	return 0;
}
