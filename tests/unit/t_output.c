/* Output files: whole or not at all, and no litter. */
/* SPDX-License-Identifier: MIT */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"
#include "output.h"

static bool no_tmpfile; /* as on a file system without O_TMPFILE */

/* The library's open(), in this program: it can lack O_TMPFILE. */
int
open(const char *path, int flags, ...)
{
	mode_t mode = 0;

#ifdef O_TMPFILE
	if (no_tmpfile && (flags & O_TMPFILE) == O_TMPFILE) {
		errno = EOPNOTSUPP;
		return -1;
	}
#endif
	if ((flags & O_CREAT) != 0 || (flags & ~O_ACCMODE) != 0) {
		va_list ap;

		va_start(ap, flags);
		mode = (mode_t)va_arg(ap, int);
		va_end(ap);
	}
	return openat(AT_FDCWD, path, flags, mode);
}

/* A folder of our own, to work in; all paths below are relative to it. */
static char folder[] = "/tmp/t_output.XXXXXX";
static int home;

static void
enter(void)
{
	strcpy(folder + sizeof folder - 7, "XXXXXX");
	home = openat(AT_FDCWD, ".", O_RDONLY | O_DIRECTORY);
	if (home < 0 || mkdtemp(folder) == NULL || chdir(folder) != 0) {
		perror(folder);
		exit(1);
	}
}

/* How many entries a folder has. */
static int
nentries(const char *path)
{
	DIR *dir = opendir(path);
	int n = -2; /* . and .. */

	while (readdir(dir) != NULL)
		n++;
	closedir(dir);
	return n;
}

/* Removes all names given, which must be all there are. */
static void
leave(const char *const *names)
{
	for (; *names != NULL; names++)
		CHECK(remove(*names) == 0);
	CHECK(nentries(".") == 0);
	if (fchdir(home) != 0 || rmdir(folder) != 0)
		perror(folder);
	close(home);
}
#define LEAVE(...) leave((const char *const[]){ __VA_ARGS__, NULL })

static void
put(const char *path, const char *text)
{
	FILE *f = fopen(path, "wb");

	if (f == NULL || fputs(text, f) < 0 || fclose(f) != 0) {
		perror(path);
		exit(1);
	}
}

static bool
holds(const char *path, const char *text)
{
	char buf[256];
	FILE *f = fopen(path, "rb");
	size_t n;

	if (f == NULL)
		return false;
	n = fread(buf, 1, sizeof buf - 1, f);
	buf[n] = '\0';
	fclose(f);
	return strcmp(buf, text) == 0;
}

static enum bake_status
write_to(const char *path, const char *text, struct bake_err *err)
{
	struct bake_output out;
	enum bake_status rc;

	*err = (struct bake_err)BAKE_ERR_INIT;
	rc = bake_output_open(&out, path, err);
	if (rc == BAKE_OK) {
		fputs(text, out.stream);
		rc = bake_output_commit(&out, err);
	}
	CHECK(out.stream == NULL && out.path == NULL && out.target == NULL &&
	      out.temp == NULL);
	CHECK((rc == BAKE_OK) == (err->msg[0] == '\0'));
	return rc;
}

/* Nothing is to be seen before the commit, nor anything else after it. */
static void
appears_whole(void)
{
	for (int way = 0; way < 2; way++) {
		struct bake_output out;
		struct bake_err err = BAKE_ERR_INIT;

		no_tmpfile = way == 1;
		enter();
		CHECK_OK(bake_output_open(&out, "a", &err), err);
		fputs("new", out.stream);
		fflush(out.stream);
		CHECK(access("a", F_OK) != 0);
		CHECK(no_tmpfile || nentries(".") == 0);
		CHECK_OK(bake_output_commit(&out, &err), err);
		CHECK(out.stream == NULL);
		CHECK(holds("a", "new") && nentries(".") == 1);
		/* and replaces what was there, at once */
		CHECK_OK(bake_output_open(&out, "a", &err), err);
		fputs("newer", out.stream);
		fflush(out.stream);
		CHECK(holds("a", "new"));
		CHECK_OK(bake_output_commit(&out, &err), err);
		CHECK(holds("a", "newer") && nentries(".") == 1);
		LEAVE("a");
	}
	no_tmpfile = false;
}

static void
abort_leaves_nothing(void)
{
	for (int way = 0; way < 2; way++) {
		struct bake_output out = BAKE_OUTPUT_INIT;
		struct bake_err err = BAKE_ERR_INIT;

		no_tmpfile = way == 1;
		enter();
		bake_output_abort(&out); /* harmless */
		put("a", "old");
		CHECK_OK(bake_output_open(&out, "a", &err), err);
		fputs("new", out.stream);
		bake_output_abort(&out);
		CHECK(out.stream == NULL && holds("a", "old"));
		CHECK_OK(bake_output_open(&out, "b", &err), err);
		bake_output_abort(&out);
		bake_output_abort(&out);
		LEAVE("a");
	}
	no_tmpfile = false;
}

/* The stream can seek and be read back, as the image writers do. */
static void
stream_can_seek(void)
{
	struct bake_output out;
	struct bake_err err = BAKE_ERR_INIT;
	char c;

	enter();
	CHECK_OK(bake_output_open(&out, "./a", &err), err);
	fputs("hello", out.stream);
	CHECK(fseek(out.stream, 0, SEEK_SET) == 0);
	CHECK(fread(&c, 1, 1, out.stream) == 1 && c == 'h');
	CHECK(fseek(out.stream, 0, SEEK_SET) == 0);
	fputs("J", out.stream);
	CHECK(fseek(out.stream, 8, SEEK_SET) == 0);
	fputs("!", out.stream);
	CHECK_OK(bake_output_commit(&out, &err), err);
	{
		char buf[16];
		FILE *f = fopen("a", "rb");

		CHECK(fread(buf, 1, sizeof buf, f) == 9);
		CHECK(memcmp(buf, "Jello\0\0\0!", 9) == 0);
		fclose(f);
	}
	LEAVE("a");
}

static void
permission_bits_are_kept(void)
{
	static const mode_t modes[] = { 0600, 0640, 0644, 0755, 0666, 04711 };
	struct bake_err err;
	struct stat st;

	for (int way = 0; way < 2; way++) {
		no_tmpfile = way == 1;
		enter();
		for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
			put("a", "old");
			CHECK(chmod("a", modes[i]) == 0);
			CHECK_OK(write_to("a", "new", &err), err);
			CHECK(stat("a", &st) == 0 &&
			      (st.st_mode & 07777) == modes[i]);
			CHECK(holds("a", "new"));
			remove("a");
		}
		/* a new file has what the umask leaves */
		for (int i = 0; i < 2; i++) {
			mode_t mask = i == 0 ? 022 : 077;
			mode_t old = umask(mask);

			CHECK_OK(write_to("b", "new", &err), err);
			CHECK(stat("b", &st) == 0 &&
			      (st.st_mode & 07777) == (0666 & ~mask));
			CHECK(umask(old) == mask);
			remove("b");
		}
		LEAVE(NULL);
	}
	no_tmpfile = false;
}

static void
symbolic_links_are_followed(void)
{
	struct bake_err err;
	struct stat st;
	char absolute[PATH_MAX];

	for (int way = 0; way < 2; way++) {
		no_tmpfile = way == 1;
		enter();
		mkdir("d", 0755);
		put("d/real", "old");
		snprintf(absolute, sizeof absolute, "%s/d/real", folder);
		CHECK(symlink("d/real", "relative") == 0);
		CHECK(symlink(absolute, "absolute") == 0);
		CHECK(symlink("relative", "chain") == 0);
		CHECK(symlink("../hanging", "d/link") == 0);
		CHECK(symlink("d/link", "dangling") == 0);
		CHECK(symlink("loop", "loop") == 0);
		CHECK_OK(write_to("relative", "one", &err), err);
		CHECK(holds("d/real", "one"));
		CHECK_OK(write_to("absolute", "two", &err), err);
		CHECK(holds("d/real", "two"));
		CHECK_OK(write_to("chain", "three", &err), err);
		CHECK(holds("d/real", "three"));
		/* what a dangling one points to is made, as open() does */
		CHECK_OK(write_to("dangling", "four", &err), err);
		CHECK(holds("hanging", "four"));
		CHECK(lstat("dangling", &st) == 0 && S_ISLNK(st.st_mode));
		CHECK(lstat("d/link", &st) == 0 && S_ISLNK(st.st_mode));
		CHECK(lstat("chain", &st) == 0 && S_ISLNK(st.st_mode));
		CHECK(write_to("loop", "x", &err) == BAKE_EIO);
		CHECK(lstat("loop", &st) == 0 && S_ISLNK(st.st_mode));
		CHECK(nentries("d") == 2);
		LEAVE("d/real", "d/link", "d", "relative", "absolute", "chain",
		    "dangling", "hanging", "loop");
	}
	no_tmpfile = false;
}

/* A name as long as a file system takes has no room for a suffix. */
static void
long_names_have_room(void)
{
	struct bake_err err;
	char name[NAME_MAX + 2];

	for (int way = 0; way < 2; way++) {
		no_tmpfile = way == 1;
		enter();
		memset(name, 'n', NAME_MAX);
		name[NAME_MAX] = '\0';
		CHECK_OK(write_to(name, "one", &err), err);
		CHECK_OK(write_to(name, "two", &err), err);
		CHECK(holds(name, "two"));
		remove(name);
		memset(name, 'n', NAME_MAX + 1);
		name[NAME_MAX + 1] = '\0';
		CHECK(write_to(name, "x", &err) == BAKE_EIO);
		LEAVE(NULL);
	}
	no_tmpfile = false;
}

static void
impossible_targets_are_named(void)
{
	static const char *const paths[] = { "d", "d/", ".", "..", "no/such",
		"no/such/", "file/x", "", "/dev/null/x", "d/x/" };
	struct bake_err err;

	for (int way = 0; way < 2; way++) {
		no_tmpfile = way == 1;
		enter();
		mkdir("d", 0755);
		put("file", "old");
		for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
			enum bake_status rc = write_to(paths[i], "x", &err);

			if (rc != BAKE_EIO)
				printf("'%s': status %d\n", paths[i], rc);
			CHECK(rc == BAKE_EIO);
			CHECK(
			    strncmp(err.msg, paths[i], strlen(paths[i])) == 0);
		}
		CHECK(nentries("d") == 0 && holds("file", "old"));
		LEAVE("d", "file");
	}
	no_tmpfile = false;
}

/* Runs f in a process of its own, so that it may give rights away. Its checks
 * count here. */
static void
apart(void (*f)(void))
{
	int status = -1;
	pid_t pid;

	fflush(NULL);
	pid = fork();
	if (pid == 0) {
		check_nfailed_here = 0;
		f();
		fflush(stdout);
		_exit(check_nfailed_here != 0);
	}
	CHECK(pid > 0 && waitpid(pid, &status, 0) == pid);
	CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* As somebody who is not root, for whom permissions count. */
static void
write_where_it_is_forbidden(void)
{
	struct bake_err err;

	if (geteuid() == 0 && setuid(65534) != 0) {
		printf("skipped: cannot give root's rights away\n");
		return;
	}
	for (int way = 0; way < 2; way++) {
		no_tmpfile = way == 1;
		CHECK(write_to("locked/new", "x", &err) == BAKE_EIO);
		CHECK(strstr(err.msg, "locked/new: ") == err.msg);
		CHECK(write_to("locked/old", "x", &err) == BAKE_EIO);
		CHECK(write_to("open/kept", "x", &err) == BAKE_EIO);
		CHECK(write_to("shut/x", "x", &err) == BAKE_EIO);
		CHECK_OK(write_to("open/new", "x", &err), err);
	}
}

static void
forbidden_places_are_left_alone(void)
{
	enter();
	mkdir("locked", 0755);
	mkdir("open", 0755);
	mkdir("shut", 0755);
	put("locked/old", "old");
	put("open/kept", "old");
	chmod("open/kept", 0444);
	chmod("open", 0777);
	chmod("locked", 0555);
	chmod("shut", 0);
	chmod(".", 0755);
	apart(write_where_it_is_forbidden);
	CHECK(holds("locked/old", "old") && nentries("locked") == 1);
	CHECK(holds("open/kept", "old") && nentries("open") == 2);
	chmod("locked", 0755);
	chmod("shut", 0755);
	LEAVE("locked/old", "locked", "open/kept", "open/new", "open", "shut");
}

static void
full_device_is_an_error(void)
{
	struct bake_err err;
	struct bake_output out;
	static char much[200000];

	if (access("/dev/full", W_OK) != 0) {
		printf("skipped: no /dev/full\n");
		return;
	}
	CHECK(write_to("/dev/full", "x", &err) == BAKE_EIO);
	CHECK(strstr(err.msg, "/dev/full: No space left") == err.msg);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK_OK(bake_output_open(&out, "/dev/full", &err), err);
	CHECK(fwrite(much, 1, sizeof much, out.stream) == sizeof much);
	CHECK(bake_output_commit(&out, &err) == BAKE_EIO);
	CHECK_OK(write_to("/dev/null", "x", &err), err);
}

/* A limit of file size stands for a full disc. */
static void
write_too_much(void)
{
	const struct rlimit small = { 10000, 10000 };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_output out;

	signal(SIGXFSZ, SIG_IGN);
	CHECK(setrlimit(RLIMIT_FSIZE, &small) == 0);
	for (int i = 0; i < 4; i++) {
		no_tmpfile = i / 2 == 1;
		err = (struct bake_err)BAKE_ERR_INIT;
		CHECK_OK(bake_output_open(&out, "a", &err), err);
		for (int k = 0; k < (i % 2 == 0 ? 20001 : 11000); k++)
			putc('x', out.stream);
		CHECK(bake_output_commit(&out, &err) == BAKE_EIO);
		CHECK(strstr(err.msg, "a: File too large") == err.msg);
		CHECK(out.stream == NULL);
		CHECK(nentries(".") == 1 && holds("a", "old"));
	}
}

static void
no_space_leaves_the_old_file(void)
{
	enter();
	put("a", "old");
	apart(write_too_much);
	CHECK(holds("a", "old"));
	LEAVE("a");
}

static void
pipe_is_written_directly(void)
{
	struct bake_err err;
	char buf[8] = "";
	int status, fds[2];
	pid_t pid;

	enter();
	CHECK(mkfifo("fifo", 0600) == 0 && pipe(fds) == 0);
	fflush(NULL);
	if ((pid = fork()) == 0) {
		int fd = open("fifo", O_RDONLY, 0);
		ssize_t n = read(fd, buf, sizeof buf);

		_exit(n != 4 || memcmp(buf, "pipe", 4) != 0 ||
		      read(fd, buf, 1) != 0);
	}
	CHECK_OK(write_to("fifo", "pipe", &err), err);
	CHECK(waitpid(pid, &status, 0) == pid && status == 0);
	/* standard output, here a pipe too */
	fflush(NULL);
	if ((pid = fork()) == 0) {
		dup2(fds[1], STDOUT_FILENO);
		_exit(write_to("-", "stdout", &err) != BAKE_OK);
	}
	CHECK(waitpid(pid, &status, 0) == pid && status == 0);
	CHECK(read(fds[0], buf, sizeof buf) == 6 &&
	      memcmp(buf, "stdout", 6) == 0);
	close(fds[0]);
	close(fds[1]);
	LEAVE("fifo");
}

static void
full_stdout_is_an_error(void)
{
	int status, fd = open("/dev/full", O_WRONLY, 0);
	pid_t pid;

	if (fd < 0)
		return;
	fflush(NULL);
	if ((pid = fork()) == 0) {
		struct bake_err err;
		bool good;

		dup2(fd, STDOUT_FILENO);
		good = write_to("-", "x", &err) == BAKE_EIO &&
		       strstr(err.msg, "standard output: ") == err.msg;
		_exit(!good);
	}
	CHECK(waitpid(pid, &status, 0) == pid && status == 0);
	close(fd);
}

/* An output that is also an input: whoever reads on reads the old bytes. */
static void
input_may_be_output(void)
{
	struct bake_output out;
	struct bake_err err = BAKE_ERR_INIT;
	FILE *in;

	enter();
	put("a", "old bytes");
	in = fopen("a", "rb");
	CHECK_OK(bake_output_open(&out, "a", &err), err);
	for (int c; (c = getc(in)) != EOF;) {
		putc(c == ' ' ? '_' : c, out.stream);
		fflush(out.stream);
	}
	CHECK_OK(bake_output_commit(&out, &err), err);
	rewind(in);
	CHECK(
	    getc(in) == 'o' && fseek(in, 3, SEEK_SET) == 0 && getc(in) == ' ');
	fclose(in);
	CHECK(holds("a", "old_bytes"));
	LEAVE("a");
}

static void
two_at_once_do_not_mix(void)
{
	for (int way = 0; way < 2; way++) {
		struct bake_output one, two;
		struct bake_err err = BAKE_ERR_INIT;

		no_tmpfile = way == 1;
		enter();
		CHECK_OK(bake_output_open(&one, "a", &err), err);
		CHECK_OK(bake_output_open(&two, "a", &err), err);
		fputs("one", one.stream);
		fputs("second", two.stream);
		CHECK_OK(bake_output_commit(&two, &err), err);
		CHECK(holds("a", "second"));
		CHECK_OK(bake_output_commit(&one, &err), err);
		CHECK(holds("a", "one"));
		LEAVE("a");
	}
	no_tmpfile = false;
}

/* A target that becomes a folder meanwhile: no rename, and no litter. */
static void
failed_rename_leaves_nothing(void)
{
	for (int way = 0; way < 2; way++) {
		struct bake_output out;
		struct bake_err err = BAKE_ERR_INIT;

		no_tmpfile = way == 1;
		enter();
		CHECK_OK(bake_output_open(&out, "a", &err), err);
		fputs("x", out.stream);
		mkdir("a", 0755);
		CHECK(bake_output_commit(&out, &err) == BAKE_EIO);
		CHECK(strncmp(err.msg, "a: ", 3) == 0);
		CHECK(out.stream == NULL);
		LEAVE("a");
	}
	no_tmpfile = false;
}

static void
killed_leaves_nothing(void)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_output out;
	int status;
	pid_t pid;

	enter();
	put("a", "old");
	fflush(NULL);
	if ((pid = fork()) == 0) {
		if (bake_output_open(&out, "a", &err) == BAKE_OK) {
			fputs("new", out.stream);
			fflush(out.stream);
			/* without O_TMPFILE the hidden file has to stay */
			if (out.temp == NULL)
				raise(SIGKILL);
			bake_output_abort(&out);
		}
		_exit(0);
	}
	CHECK(waitpid(pid, &status, 0) == pid);
	if (!WIFSIGNALED(status))
		printf("skipped: no O_TMPFILE here\n");
	CHECK(holds("a", "old"));
	LEAVE("a");
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(appears_whole),
		CASE(abort_leaves_nothing),
		CASE(stream_can_seek),
		CASE(permission_bits_are_kept),
		CASE(symbolic_links_are_followed),
		CASE(long_names_have_room),
		CASE(impossible_targets_are_named),
		CASE(forbidden_places_are_left_alone),
		CASE(full_device_is_an_error),
		CASE(no_space_leaves_the_old_file),
		CASE(pipe_is_written_directly),
		CASE(full_stdout_is_an_error),
		CASE(input_may_be_output),
		CASE(two_at_once_do_not_mix),
		CASE(failed_rename_leaves_nothing),
		CASE(killed_leaves_nothing),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
