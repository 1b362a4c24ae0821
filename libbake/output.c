/* Output files that appear whole or not at all. */
/* SPDX-License-Identifier: MIT */
#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "mem.h"

/* path as a message names it */
static const char *
shown(const struct bake_output *out)
{
	return out->target != NULL ? out->path : "standard output";
}

static enum bake_status
fail_errno(struct bake_err *err, const char *path)
{
	return bake_fail(err, errno == ENOMEM ? BAKE_ENOMEM : BAKE_EIO,
	    "%s: %s", path, strerror(errno));
}

/* The folder of a path, to be freed: "." where it has none. */
static char *
folder_of(const char *path)
{
	const char *slash = strrchr(path, '/');

	if (slash == NULL)
		return strdup(".");
	return slash == path ? strdup("/")
			     : strndup(path, (size_t)(slash - path));
}

/* FOLDER/.NAME.SUFFIX, to be freed. NAME is cut, so that one as long as a name
 * can be leaves room. */
static char *
hidden_name(const char *path, const char *suffix)
{
	const char *slash = strrchr(path, '/');
	int nfolder = slash != NULL ? (int)(slash + 1 - path) : 0;
	char *t;

	if (asprintf(&t, "%.*s.%.200s.%s", nfolder, path, path + nfolder,
		suffix) < 0)
		return NULL;
	return t;
}

/* The path that symbolic links lead to, to be freed; also where nothing is
 * there yet, which realpath() does not tell. NULL with errno. */
static char *
follow_links(const char *path)
{
	char to[PATH_MAX], *at = realpath(path, NULL), *next;

	if (at != NULL || errno == ENOMEM)
		return at;
	at = strdup(path);
	for (int nlinks = 0; at != NULL; nlinks++) {
		ssize_t n = readlink(at, to, sizeof to - 1);
		const char *slash = strrchr(at, '/');
		int nfolder = slash != NULL ? (int)(slash + 1 - at) : 0;

		if (n < 0 || nlinks == 40)
			break; /* stat() tells what is wrong with it */
		to[n] = '\0';
		if (asprintf(&next, "%.*s%s", to[0] == '/' ? 0 : nfolder, at,
			to) < 0)
			next = NULL;
		free(at);
		at = next;
	}
	return at;
}

/* A file without a name in the target's folder; where the system has none,
 * with a hidden one. Returns its descriptor, or -1 with errno. */
static int
open_beside(struct bake_output *out)
{
	char *folder = folder_of(out->target);
	int fd = -1;

	if (folder == NULL)
		return -1;
	errno = EOPNOTSUPP;
#ifdef O_TMPFILE
	/* to give it a name later takes /proc */
	if (access("/proc/self/fd", F_OK) == 0)
		fd = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
	else
		errno = EOPNOTSUPP;
#endif
	free(folder);
	if (fd >= 0 ||
	    (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL))
		return fd;
	out->temp = hidden_name(out->target, "XXXXXX");
	if (out->temp == NULL)
		return -1;
	fd = mkstemp(out->temp);
	if (fd >= 0) {
		mode_t mask = umask(0);

		umask(mask);
		fchmod(fd, 0666 & ~mask);
	} else {
		free(out->temp);
		out->temp = NULL;
	}
	return fd;
}

/* Find the real target, and whether it is to be written directly. */
static enum bake_status
look_at_target(struct bake_output *out, const char *path, struct bake_err *err)
{
	struct stat st;

	if (strcmp(path, "-") == 0) {
		out->direct = true;
		return BAKE_OK;
	}
	out->path = strdup(path);
	if (out->path == NULL || (out->target = follow_links(path)) == NULL)
		return fail_errno(err, path);
	if (stat(out->target, &st) != 0)
		return errno == ENOENT ? BAKE_OK : fail_errno(err, path);
	if (S_ISDIR(st.st_mode))
		return bake_fail(err, BAKE_EIO, "%s: is a folder", path);
	out->direct = !S_ISREG(st.st_mode);
	if (!out->direct && access(out->target, W_OK) != 0)
		return fail_errno(err, path);
	return BAKE_OK;
}

enum bake_status
bake_output_open(
    struct bake_output *out, const char *path, struct bake_err *err)
{
	enum bake_status rc;
	int fd;

	*out = (struct bake_output)BAKE_OUTPUT_INIT;
	if ((rc = look_at_target(out, path, err)) != BAKE_OK)
		goto out;
	if (out->direct) {
		out->stream = tmpfile();
	} else {
		fd = open_beside(out);
		if (fd >= 0 && (out->stream = fdopen(fd, "w+b")) == NULL)
			close(fd);
	}
	if (out->stream == NULL)
		rc = fail_errno(err, path);
out:
	if (rc != BAKE_OK)
		bake_output_abort(out);
	return rc;
}

/* Copy what was written to a pipe, a device or standard output. */
static enum bake_status
copy_directly(struct bake_output *out, struct bake_err *err)
{
	char buf[65536];
	FILE *to = out->target != NULL ? fopen(out->target, "wb") : stdout;
	enum bake_status rc = BAKE_OK;
	size_t n;

	if (to == NULL)
		return fail_errno(err, shown(out));
	rewind(out->stream);
	while (
	    rc == BAKE_OK && (n = fread(buf, 1, sizeof buf, out->stream)) > 0)
		if (fwrite(buf, 1, n, to) != n)
			rc = fail_errno(err, shown(out));
	if (rc == BAKE_OK && ferror(out->stream))
		rc = fail_errno(err, shown(out));
	if (fflush(to) != 0 && rc == BAKE_OK)
		rc = fail_errno(err, shown(out));
	if (to != stdout && fclose(to) != 0 && rc == BAKE_OK)
		rc = fail_errno(err, shown(out));
	return rc;
}

/* Give a nameless file a hidden name beside its target. */
static int
link_hidden(struct bake_output *out, const char *fd_path)
{
	for (int tries = 0; tries < 1000; tries++) {
		char suffix[32];

		free(out->temp);
		snprintf(
		    suffix, sizeof suffix, "%ld-%d", (long)getpid(), tries);
		out->temp = hidden_name(out->target, suffix);
		if (out->temp == NULL)
			return -1;
		if (linkat(AT_FDCWD, fd_path, AT_FDCWD, out->temp,
			AT_SYMLINK_FOLLOW) == 0)
			return 0;
		if (errno != EEXIST)
			break;
	}
	free(out->temp);
	out->temp = NULL;
	return -1;
}

/* Move the finished file to its place. */
static int
put_in_place(struct bake_output *out)
{
	char fd_path[64];
	struct stat st;

	if (stat(out->target, &st) == 0)
		fchmod(fileno(out->stream), st.st_mode & 07777);
	if (out->temp == NULL) {
		snprintf(fd_path, sizeof fd_path, "/proc/self/fd/%d",
		    fileno(out->stream));
		if (linkat(AT_FDCWD, fd_path, AT_FDCWD, out->target,
			AT_SYMLINK_FOLLOW) == 0)
			return 0;
		if (errno != EEXIST || link_hidden(out, fd_path) != 0)
			return -1;
	}
	if (rename(out->temp, out->target) != 0)
		return -1;
	free(out->temp);
	out->temp = NULL;
	return 0;
}

enum bake_status
bake_output_commit(struct bake_output *out, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;
	sigset_t all, old;

	errno = 0;
	if (fflush(out->stream) != 0 || ferror(out->stream)) {
		if (errno == 0) /* it was an earlier write that failed */
			errno = EIO;
		rc = fail_errno(err, shown(out));
	} else if (out->direct) {
		rc = copy_directly(out, err);
	} else {
		/* a signal between link and rename would leave litter */
		sigfillset(&all);
		pthread_sigmask(SIG_BLOCK, &all, &old);
		if (put_in_place(out) != 0)
			rc = fail_errno(err, shown(out));
		pthread_sigmask(SIG_SETMASK, &old, NULL);
	}
	bake_output_abort(out);
	return rc;
}

void
bake_output_abort(struct bake_output *out)
{
	if (out->stream != NULL)
		fclose(out->stream);
	if (out->temp != NULL)
		unlink(out->temp);
	free(out->temp);
	free(out->target);
	free(out->path);
	*out = (struct bake_output)BAKE_OUTPUT_INIT;
}
