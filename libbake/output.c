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

/* Whether an output must outlast the loss of power. */
static bool
is_durable(void)
{
	const char *wish = getenv("BAKE_FSYNC");

	return wish != NULL && strcmp(wish, "0") != 0 && wish[0] != '\0';
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

/* What must not come between making a hidden name and taking it away again.
 * Signals that a thread causes itself cannot wait. */
static void
hold_signals(sigset_t *old)
{
	static const int own[] = { SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV,
		SIGSYS, SIGTRAP };
	sigset_t most;

	sigfillset(&most);
	for (size_t i = 0; i < sizeof own / sizeof *own; i++)
		sigdelset(&most, own[i]);
	pthread_sigmask(SIG_BLOCK, &most, old);
}

static void
release_signals(const sigset_t *old)
{
	pthread_sigmask(SIG_SETMASK, old, NULL);
}

/* A new hidden file beside the target: its descriptor, its name in out->temp.
 * -1 with errno. */
static int
open_hidden(struct bake_output *out)
{
	mode_t mask;
	int fd;

	out->temp = hidden_name(out->target, "XXXXXX");
	if (out->temp == NULL)
		return -1;
	fd = mkostemp(out->temp, O_CLOEXEC);
	if (fd < 0) {
		free(out->temp);
		out->temp = NULL;
		return -1;
	}
	mask = umask(0);
	umask(mask);
	fchmod(fd, 0666 & ~mask);
	return fd;
}

static void
drop_temp(struct bake_output *out)
{
	if (out->temp != NULL)
		unlink(out->temp);
	free(out->temp);
	out->temp = NULL;
}

/* A file in the target's folder that has no name any more: what is in it can
 * only be copied. Where the system does not take an open file's name away it
 * keeps it, and will be renamed. */
static int
open_unlinked(struct bake_output *out)
{
	sigset_t old;
	int fd, why;

	hold_signals(&old);
	fd = open_hidden(out);
	why = errno;
	if (fd >= 0 && unlink(out->temp) == 0) {
		free(out->temp);
		out->temp = NULL;
		out->copies = true;
	}
	release_signals(&old);
	errno = why;
	return fd;
}

/* A file without a name in the target's folder. Returns its descriptor, or -1
 * with errno. */
static int
open_beside(struct bake_output *out)
{
#ifdef O_TMPFILE
	/* to give it a name later takes /proc */
	if (access("/proc/self/fd", F_OK) == 0) {
		char *folder = folder_of(out->target);
		int fd = -1;

		if (folder != NULL)
			fd = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
		free(folder);
		if (fd >= 0 ||
		    (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL))
			return fd;
	}
#endif
	return open_unlinked(out);
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

/* All that was written, from the start, to a descriptor. */
static int
copy_to(FILE *from, int fd)
{
	char buf[65536];
	size_t n;

	if (fseeko(from, 0, SEEK_SET) != 0)
		return -1;
	while ((n = fread(buf, 1, sizeof buf, from)) > 0)
		for (size_t done = 0; done < n;) {
			ssize_t k = write(fd, buf + done, n - done);

			if (k < 0 && errno != EINTR)
				return -1;
			if (k > 0)
				done += (size_t)k;
		}
	return ferror(from) ? -1 : 0;
}

/* Copy what was written to a pipe, a device or standard output. */
static int
copy_directly(struct bake_output *out)
{
	int fd = STDOUT_FILENO, rc;

	if (out->target == NULL)
		rc = fflush(stdout);
	else
		rc = fd = open(out->target, O_WRONLY | O_CLOEXEC);
	if (rc < 0)
		return -1;
	rc = copy_to(out->stream, fd);
	if (out->target != NULL && close(fd) != 0)
		rc = -1;
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

/* Copy a file that cannot be named into one that has a hidden name. */
static int
copy_hidden(struct bake_output *out, mode_t mode)
{
	int fd = open_hidden(out), rc;

	if (fd < 0)
		return -1;
	if (mode != 0)
		fchmod(fd, mode);
	rc = copy_to(out->stream, fd);
	if (rc == 0 && is_durable())
		rc = fsync(fd);
	return close(fd) != 0 ? -1 : rc;
}

/* Put the finished file in its place. */
static int
put_in_place(struct bake_output *out)
{
	int fd = fileno(out->stream);
	char fd_path[64];
	struct stat st;
	bool old = stat(out->target, &st) == 0;
	mode_t mode = old ? st.st_mode & 07777 : 0;

	if (out->copies)
		return copy_hidden(out, mode) != 0
			   ? -1
			   : rename(out->temp, out->target);
	if (old)
		fchmod(fd, mode);
	if (is_durable() && fsync(fd) != 0)
		return -1;
	if (out->temp == NULL) {
		snprintf(fd_path, sizeof fd_path, "/proc/self/fd/%d", fd);
		if (linkat(AT_FDCWD, fd_path, AT_FDCWD, out->target,
			AT_SYMLINK_FOLLOW) == 0)
			return 0;
		if (errno != EEXIST || link_hidden(out, fd_path) != 0)
			return -1;
	}
	return rename(out->temp, out->target);
}

/* Make a name's new meaning outlast the loss of power. */
static int
sync_folder(const char *path)
{
	char *folder = folder_of(path);
	int fd, rc, why;

	if (folder == NULL)
		return -1;
	fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	free(folder);
	if (fd < 0)
		return errno == EACCES ? 0 : -1; /* it may be unreadable */
	rc = fsync(fd);
	why = errno;
	close(fd);
	errno = why;
	return rc != 0 && why != EINVAL ? -1 : 0; /* or know no such thing */
}

static int
finish(struct bake_output *out)
{
	sigset_t old;
	int rc, why;

	if (out->direct)
		return copy_directly(out);
	hold_signals(&old);
	rc = put_in_place(out);
	why = errno;
	if (rc == 0) {
		free(out->temp); /* nothing has that name any more */
		out->temp = NULL;
	}
	drop_temp(out);
	release_signals(&old);
	errno = why;
	return rc == 0 && is_durable() ? sync_folder(out->target) : rc;
}

enum bake_status
bake_output_commit(struct bake_output *out, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;

	errno = 0;
	if (fflush(out->stream) != 0 || ferror(out->stream) ||
	    finish(out) != 0) {
		if (errno == 0) /* it was an earlier write that failed */
			errno = EIO;
		rc = fail_errno(err, shown(out));
	}
	bake_output_abort(out);
	return rc;
}

void
bake_output_abort(struct bake_output *out)
{
	if (out->stream != NULL)
		fclose(out->stream);
	drop_temp(out);
	free(out->target);
	free(out->path);
	*out = (struct bake_output)BAKE_OUTPUT_INIT;
}
