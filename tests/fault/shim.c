/* A preloaded library that makes the n-th call of a kind fail. */
/* SPDX-License-Identifier: MIT */
/*
 * LD_PRELOAD=fault_shim.so FAULT=KIND:N:ACTION[:MODE] rm-tool ...
 *
 *	KIND    malloc  malloc, calloc, realloc, aligned_alloc … and with them
 *	                operator new and what the C library allocates
 *	        thread  pthread_create
 *	        fork    fork
 *	        a group of system calls, named in the table below: read, write,
 *	        open, …; 'any' is all groups
 *	        tmpfile open with O_TMPFILE
 *	N       which call, from 1; 0 counts and does nothing
 *	ACTION  the errno it fails with, as a number; 'short': a read or a write
 *	        of half the bytes; 'kill9', 'kill15' …: the process sends itself
 *	        that signal before the call
 *	MODE    of letters: f, that call and all later ones (a disk that is full
 *	        stays full); p, only in the process where main began, not in
 *	        those it forks; t, O_TMPFILE is refused besides
 *
 * Only what happens between the start and the end of main counts: before, the
 * loader and the libraries' constructors allocate thousands of times, which
 * would test those. One count goes for a process and all that it forks. What is
 * written to the standard error of the start is left alone: a message that
 * cannot be told is no message.
 *
 * The C library's own system calls (stdio's read and write) are no functions
 * that could be preloaded. So the kernel is asked to trap the calls (seccomp)
 * and a handler of SIGSYS makes them, or does not. The one place that may make
 * them untrapped is raw_call.
 *
 * FAULT_COUNT=FILE holds, mapped, the count, the calls that failed and the
 * number of threads that there were at the start of main.
 *
 * FAULT_SERVER=IN,OUT saves the start of the tool, which loads hundreds of
 * libraries: what is ready to call main waits for lines 'FAULT DIR' on
 * descriptor IN, forks for each, and the child calls main in that folder with
 * its output in DIR/../out and DIR/../err; 'pid N' and, in the end,
 * 'end STATUS COUNT FAILED' are told on descriptor OUT.
 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <ucontext.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

enum kind {
	KIND_NONE,
	KIND_MALLOC,
	KIND_THREAD,
	KIND_FORK,
	KIND_TMPFILE,
	KIND_ANY,
	/* of system calls */
	KIND_READ,
	KIND_WRITE,
	KIND_SYNC,
	KIND_CLOSE,
	KIND_RENAME,
	KIND_UNLINK,
	KIND_OPEN,
	KIND_STAT,
	KIND_SEEK,
	KIND_MMAP,
	KIND_PIPE,
	KIND_DUP
};

static const struct {
	const char *name;
	enum kind kind;
} kinds[] = {
	{ "malloc", KIND_MALLOC },
	{ "thread", KIND_THREAD },
	{ "fork", KIND_FORK },
	{ "tmpfile", KIND_TMPFILE },
	{ "any", KIND_ANY },
	{ "read", KIND_READ },
	{ "write", KIND_WRITE },
	{ "sync", KIND_SYNC },
	{ "close", KIND_CLOSE },
	{ "rename", KIND_RENAME },
	{ "unlink", KIND_UNLINK },
	{ "open", KIND_OPEN },
	{ "stat", KIND_STAT },
	{ "seek", KIND_SEEK },
	{ "mmap", KIND_MMAP },
	{ "pipe", KIND_PIPE },
	{ "dup", KIND_DUP },
};

static const struct {
	enum kind kind;
	long nr;
} calls[] = {
	{ KIND_READ, SYS_read },
	{ KIND_READ, SYS_pread64 },
	{ KIND_READ, SYS_readv },
	{ KIND_READ, SYS_preadv },
	{ KIND_WRITE, SYS_write },
	{ KIND_WRITE, SYS_pwrite64 },
	{ KIND_WRITE, SYS_writev },
	{ KIND_WRITE, SYS_pwritev },
	{ KIND_SYNC, SYS_fsync },
	{ KIND_SYNC, SYS_fdatasync },
	{ KIND_CLOSE, SYS_close },
#ifdef SYS_rename
	{ KIND_RENAME, SYS_rename },
	{ KIND_RENAME, SYS_link },
	{ KIND_UNLINK, SYS_unlink },
	{ KIND_OPEN, SYS_open },
	{ KIND_OPEN, SYS_creat },
	{ KIND_STAT, SYS_stat },
	{ KIND_STAT, SYS_access },
	{ KIND_STAT, SYS_readlink },
	{ KIND_PIPE, SYS_pipe },
	{ KIND_DUP, SYS_dup2 },
#endif
#ifdef SYS_renameat
	{ KIND_RENAME, SYS_renameat },
#endif
	{ KIND_RENAME, SYS_renameat2 },
	{ KIND_RENAME, SYS_linkat },
	{ KIND_UNLINK, SYS_unlinkat },
	{ KIND_OPEN, SYS_openat },
	{ KIND_STAT, SYS_newfstatat },
	{ KIND_STAT, SYS_fstat },
	{ KIND_STAT, SYS_statx },
	{ KIND_STAT, SYS_faccessat },
	{ KIND_STAT, SYS_readlinkat },
	{ KIND_STAT, SYS_fchmod },
	{ KIND_SEEK, SYS_lseek },
	{ KIND_MMAP, SYS_mmap },
	{ KIND_MMAP, SYS_mremap },
	{ KIND_MMAP, SYS_brk },
	{ KIND_PIPE, SYS_pipe2 },
	{ KIND_PIPE, SYS_socketpair },
	{ KIND_DUP, SYS_dup },
	{ KIND_DUP, SYS_dup3 },
	{ KIND_DUP, SYS_fcntl },
};
enum { NCALLS = sizeof calls / sizeof *calls };

enum action { FAIL, SHORT, KILL };

/* What to do, and since when. */
static struct {
	enum kind kind;
	long n;
	enum action action;
	int number; /* errno or signal */
	bool forever, first_process, no_tmpfile;
	pid_t pid;
	dev_t err_dev;
	ino_t err_ino;
	atomic_bool armed;
} fault;

/* Shared with forked processes and whoever started us. */
static struct tally {
	atomic_long count, failed, nthreads;
} own_tally, *tally = &own_tally;

/* -- system calls ------------------------------------------------------------
 */

long raw_call(long nr, const long a[6]) __attribute__((visibility("hidden")));
extern char raw_call_done[] __attribute__((visibility("hidden")));

#if defined(__x86_64__)
__asm__(".text\n"
	".type raw_call, @function\n"
	"raw_call:\n"
	"mov %rdi, %rax\n"
	"mov %rsi, %r11\n"
	"mov 0(%r11), %rdi\n"
	"mov 8(%r11), %rsi\n"
	"mov 16(%r11), %rdx\n"
	"mov 24(%r11), %r10\n"
	"mov 32(%r11), %r8\n"
	"mov 40(%r11), %r9\n"
	"syscall\n"
	"raw_call_done:\n"
	"ret\n"
	".size raw_call, .-raw_call\n");
#define NATIVE_ARCH 0xc000003eu
#define REG(u, i)                                                              \
	((u)->uc_mcontext.gregs[(const int[]){                                 \
	    REG_RDI, REG_RSI, REG_RDX, REG_R10, REG_R8, REG_R9, REG_RAX }[i]])
#elif defined(__aarch64__)
__asm__(".text\n"
	".type raw_call, %function\n"
	"raw_call:\n"
	"mov x8, x0\n"
	"mov x9, x1\n"
	"ldp x0, x1, [x9]\n"
	"ldp x2, x3, [x9, #16]\n"
	"ldp x4, x5, [x9, #32]\n"
	"svc #0\n"
	"raw_call_done:\n"
	"ret\n"
	".size raw_call, .-raw_call\n");
#define NATIVE_ARCH 0xc00000b7u
#define REG(u, i) ((u)->uc_mcontext.regs[(i) == 6 ? 0 : (i)])
#else
#error "fault shim: only for x86-64 and AArch64"
#endif

static long
raw(long nr, long a, long b, long c)
{
	const long args[6] = { a, b, c, 0, 0, 0 };

	return raw_call(nr, args);
}

/* Whether this call of the kind is one that fails; or dies here. */
static bool
fails_now(enum kind kind)
{
	long n;

	if (!atomic_load(&fault.armed) ||
	    (kind != fault.kind &&
		(fault.kind != KIND_ANY || kind == KIND_MALLOC)) ||
	    (fault.first_process && raw(SYS_getpid, 0, 0, 0) != fault.pid))
		return false;
	n = atomic_fetch_add(&tally->count, 1) + 1;
	if (fault.n == 0 || n < fault.n || (n > fault.n && !fault.forever))
		return false;
	atomic_fetch_add(&tally->failed, 1);
	if (fault.action != KILL)
		return true;
	raw(SYS_kill, raw(SYS_getpid, 0, 0, 0), fault.number, 0);
	return false;
}

static bool
is_standard_error(int fd)
{
	struct stat st;

#ifdef SYS_fstat
	if (raw(SYS_fstat, fd, (long)&st, 0) != 0)
		return false;
#endif
	return st.st_dev == fault.err_dev && st.st_ino == fault.err_ino;
}

static enum kind
kind_of(long nr)
{
	for (int i = 0; i < NCALLS; i++)
		if (calls[i].nr == nr)
			return calls[i].kind;
	return KIND_NONE;
}

static bool
is_tmpfile(long nr, const long a[6])
{
	return nr == SYS_openat && (a[2] & O_TMPFILE) == O_TMPFILE;
}

/* The call, as it comes out. */
static long
answer(long nr, long a[6])
{
	enum kind kind = kind_of(nr);

	if (is_tmpfile(nr, a) && atomic_load(&fault.armed)) {
		if (fault.no_tmpfile)
			return -EOPNOTSUPP;
		if (fault.kind == KIND_TMPFILE)
			kind = KIND_TMPFILE;
	}
	if ((kind == KIND_WRITE && is_standard_error((int)a[0])) ||
	    !fails_now(kind))
		return raw_call(nr, a);
	if (fault.action == SHORT) {
		if (a[2] > 1)
			a[2] /= 2;
		return raw_call(nr, a);
	}
	if (nr == SYS_close) /* it is closed all the same */
		raw_call(nr, a);
	if (nr == SYS_brk) /* tells of failure in its own way */
		return raw(SYS_brk, 0, 0, 0);
	return -fault.number;
}

static void
on_trap(int sig, siginfo_t *info, void *context)
{
	ucontext_t *u = context;
	int saved = errno;
	long a[6];

	(void)sig;
	for (int i = 0; i < 6; i++)
		a[i] = (long)REG(u, i);
	REG(u, 6) = answer(info->si_syscall, a);
	errno = saved;
}

/* Trap the calls that are wanted, but for raw_call's. */
static void
trap_calls(void)
{
	const uint64_t gate = (uint64_t)(uintptr_t)raw_call_done;
	struct sock_filter f[2 * NCALLS + 16];
	struct sigaction sa = { .sa_flags = SA_SIGINFO | SA_NODEFER };
	unsigned short n = 0;
	struct sock_fprog prog;

#define AT(field) ((unsigned)offsetof(struct seccomp_data, field))
#define ADD(...) f[n++] = (struct sock_filter)__VA_ARGS__
	ADD(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, AT(arch)));
	ADD(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, NATIVE_ARCH, 1, 0));
	ADD(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
	ADD(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, AT(instruction_pointer)));
	ADD(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)gate, 0, 3));
	ADD(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, AT(instruction_pointer) + 4));
	ADD(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)(gate >> 32), 0, 1));
	ADD(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
	ADD(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, AT(nr)));
	for (int i = 0; i < NCALLS; i++) {
		bool wanted =
		    fault.kind == KIND_ANY || calls[i].kind == fault.kind ||
		    ((fault.no_tmpfile || fault.kind == KIND_TMPFILE) &&
			calls[i].nr == SYS_openat);

		if (!wanted)
			continue;
		ADD(BPF_JUMP(
		    BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)calls[i].nr, 0, 1));
		ADD(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP));
	}
	ADD(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
	prog = (struct sock_fprog){ n, f };
	sa.sa_sigaction = on_trap;
	if (sigaction(SIGSYS, &sa, NULL) != 0 ||
	    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
	    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &prog) != 0) {
		fputs("fault shim: no seccomp\n", stderr);
		_exit(77);
	}
}

/* -- functions ----------------------------------------------------------------
 */

void *__libc_malloc(size_t n);
void *__libc_calloc(size_t n, size_t size);
void *__libc_realloc(void *p, size_t n);
void *__libc_memalign(size_t align, size_t n);

static bool
no_memory(void)
{
	if (!fails_now(KIND_MALLOC))
		return false;
	errno = ENOMEM;
	return true;
}

EXPORT void *
malloc(size_t n)
{
	return no_memory() ? NULL : __libc_malloc(n);
}

EXPORT void *
calloc(size_t n, size_t size)
{
	return no_memory() ? NULL : __libc_calloc(n, size);
}

EXPORT void *
realloc(void *p, size_t n)
{
	return no_memory() ? NULL : __libc_realloc(p, n);
}

EXPORT void *
memalign(size_t align, size_t n)
{
	return no_memory() ? NULL : __libc_memalign(align, n);
}

EXPORT void *
aligned_alloc(size_t align, size_t n)
{
	return memalign(align, n);
}

EXPORT int
posix_memalign(void **p, size_t align, size_t n)
{
	void *q = memalign(align, n);

	if (q == NULL)
		return ENOMEM;
	*p = q;
	return 0;
}

EXPORT pid_t
fork(void)
{
	pid_t (*real)(void) = (pid_t(*)(void))dlsym(RTLD_NEXT, "fork");

	if (fails_now(KIND_FORK)) {
		errno = fault.number;
		return -1;
	}
	return real();
}

EXPORT int
pthread_create(pthread_t *thread, const pthread_attr_t *attr,
    void *(*start)(void *), void *arg)
{
	int (*real)(pthread_t *, const pthread_attr_t *, void *(*)(void *),
	    void *) = (int (*)(pthread_t *, const pthread_attr_t *,
	    void *(*)(void *), void *))dlsym(RTLD_NEXT, "pthread_create");

	return fails_now(KIND_THREAD) ? fault.number
				      : real(thread, attr, start, arg);
}

/* -- main
 * ---------------------------------------------------------------------- */

static void
parse(const char *spec)
{
	char name[32] = "", action[32] = "5", mode[32] = "";

	fault.kind = KIND_NONE;
	if (sscanf(spec, "%31[a-z]:%ld:%31[a-z0-9]:%31[a-z]", name, &fault.n,
		action, mode) < 2)
		goto bad;
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (strcmp(name, kinds[i].name) == 0)
			fault.kind = kinds[i].kind;
	if (fault.kind == KIND_NONE)
		goto bad;
	fault.action = strcmp(action, "short") == 0      ? SHORT
		       : strncmp(action, "kill", 4) == 0 ? KILL
							 : FAIL;
	fault.number = atoi(action + (fault.action == KILL ? 4 : 0));
	fault.forever = strchr(mode, 'f') != NULL;
	fault.first_process = strchr(mode, 'p') != NULL;
	fault.no_tmpfile = strchr(mode, 't') != NULL;
	return;
bad:
	fprintf(stderr, "fault shim: FAULT is '%s'\n", spec);
	_exit(77);
}

static void
arm(void)
{
	struct stat st;

	fault.pid = getpid();
	if (fstat(STDERR_FILENO, &st) == 0) {
		fault.err_dev = st.st_dev;
		fault.err_ino = st.st_ino;
	}
	if (fault.kind >= KIND_TMPFILE || fault.no_tmpfile)
		trap_calls();
	atomic_store(&fault.armed, true);
}

static void
redirect(int fd, const char *dir, const char *name)
{
	char path[1024];
	int to;

	snprintf(path, sizeof path, "%s/../%s", dir, name);
	to = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
	if (to < 0 || dup2(to, fd) < 0)
		_exit(77);
	close(to);
}

static bool served; /* in a child of the server */

/* In the child this returns; in the server never. */
static void
serve(const char *ends)
{
	char spec[128], dir[512];
	int from = -1, to = -1;
	FILE *in;

	if (sscanf(ends, "%d,%d", &from, &to) != 2)
		_exit(77);
	in = fdopen(from, "r");

	while (in != NULL && fscanf(in, "%127s %511s", spec, dir) == 2) {
		int status = 0;
		pid_t pid;

		atomic_store(&tally->count, 0);
		atomic_store(&tally->failed, 0);
		pid = fork();
		if (pid == 0) {
			fclose(in);
			close(to);
			setpgid(0, 0);
			redirect(STDOUT_FILENO, dir, "out");
			redirect(STDERR_FILENO, dir, "err");
			if (chdir(dir) != 0)
				_exit(77);
			parse(spec);
			served = true;
			return;
		}
		setpgid(pid, pid);
		dprintf(to, "pid %ld\n", (long)pid);
		if (pid < 0 || waitpid(pid, &status, 0) != pid)
			break;
		dprintf(to, "end %d %ld %ld\n", status, (long)tally->count,
		    (long)tally->failed);
	}
	_exit(0);
}

static int (*tools_main)(int, char **, char **);

static int
count_threads(void)
{
	char line[256];
	FILE *fp = fopen("/proc/self/status", "r");
	int n = 0;

	while (fp != NULL && fgets(line, sizeof line, fp) != NULL)
		if (sscanf(line, "Threads: %d", &n) == 1)
			break;
	if (fp != NULL)
		fclose(fp);
	return n;
}

static void
share_tally(void)
{
	const char *path = getenv("FAULT_COUNT");
	int fd = path != NULL ? open(path, O_RDWR | O_CREAT, 0666) : -1;
	int flags = MAP_SHARED | (fd < 0 ? MAP_ANONYMOUS : 0);
	void *p;

	if (fd >= 0 && ftruncate(fd, 4096) != 0)
		_exit(77);
	p = mmap(NULL, 4096, PROT_READ | PROT_WRITE, flags, fd, 0);
	if (p == MAP_FAILED)
		_exit(77);
	tally = p;
	if (fd >= 0)
		close(fd);
	atomic_store(&tally->nthreads, count_threads());
}

static int
main_between(int argc, char **argv, char **envp)
{
	const char *spec = getenv("FAULT");
	const char *server = getenv("FAULT_SERVER");
	int rc;

	share_tally();
	if (server != NULL)
		serve(server);
	else if (spec != NULL)
		parse(spec);
	if (fault.kind != KIND_NONE)
		arm();
	rc = tools_main(argc, argv, envp);
	exit(rc);
}

int __cxa_atexit(void (*fn)(void *), void *arg, void *dso);

static void (*tools_atexit)(void *); /* what the tool itself gave to atexit */

/* Behind atexit, which is no function of the shared C library. */
EXPORT int
__cxa_atexit(void (*fn)(void *), void *arg, void *dso)
{
	int (*real)(void (*)(void *), void *, void *) = (int (*)(
	    void (*)(void *), void *, void *))dlsym(RTLD_NEXT, "__cxa_atexit");
	Dl_info of_fn, of_main;

	if (served && arg == NULL && dladdr((void *)fn, &of_fn) != 0 &&
	    dladdr((void *)tools_main, &of_main) != 0 &&
	    of_fn.dli_fbase == of_main.dli_fbase)
		tools_atexit = fn;
	return real(fn, arg, dso);
}

/* What destructors do is not counted; and in a server's child they would wait
 * for threads that the fork has not taken along. */
EXPORT void
exit(int status)
{
	void (*real)(int) = (void (*)(int))dlsym(RTLD_NEXT, "exit");

	atomic_store(&fault.armed, false);
	if (served) {
		if (tools_atexit != NULL)
			tools_atexit(NULL);
		fflush(NULL);
		_exit(status);
	}
	real(status);
	_exit(status);
}

int __libc_start_main(int (*main_fn)(int, char **, char **), int argc,
    char **argv, void (*init)(void), void (*fini)(void),
    void (*rtld_fini)(void), void *stack_end);

EXPORT int
__libc_start_main(int (*main_fn)(int, char **, char **), int argc, char **argv,
    void (*init)(void), void (*fini)(void), void (*rtld_fini)(void),
    void *stack_end)
{
	int (*real)(int (*)(int, char **, char **), int, char **,
	    void (*)(void), void (*)(void), void (*)(void), void *) =
	    (int (*)(int (*)(int, char **, char **), int, char **,
		void (*)(void), void (*)(void), void (*)(void),
		void *))dlsym(RTLD_NEXT, "__libc_start_main");

	tools_main = main_fn;
	return real(main_between, argc, argv, init, fini, rtld_fini, stack_end);
}
