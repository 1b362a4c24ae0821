/* Allocations that fail in turn, for the tests of what is then reported. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_NOMEM_H
#define TEST_NOMEM_H

/*
 * A test that includes this is linked with --wrap for the functions below
 * (Makefile), so that they see every call of libbake's own code, not those
 * inside other libraries, which allocate by themselves.
 */
#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "check.h"
#include "image.h"

/* The allocation to fail, counted from 0, or -1; whether those after it fail
 * too; how many there were; and the blocks that are live. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static long fail_at = -1, nallocs;
static bool all_after, has_failed;
static void *live[4096];
static int nlive;

static bool
fails_now(void)
{
	bool fails;

	pthread_mutex_lock(&lock);
	fails = fail_at >= 0 &&
		(nallocs == fail_at || (all_after && nallocs > fail_at));
	nallocs++;
	has_failed = has_failed || fails;
	pthread_mutex_unlock(&lock);
	if (fails)
		errno = ENOMEM;
	return fails;
}

static void *
note(void *p)
{
	pthread_mutex_lock(&lock);
	if (p != NULL && nlive < (int)(sizeof live / sizeof *live))
		live[nlive++] = p;
	pthread_mutex_unlock(&lock);
	return p;
}

void *__real_aligned_alloc(size_t align, size_t size);
void __real_free(void *p);
char *__real_strdup(const char *text);
char *__real_strndup(const char *text, size_t n);
char *__real_realpath(const char *path, char *out);
void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t size);
FILE *__real_fdopen(int fd, const char *mode);
FILE *__real_tmpfile(void);
void *__wrap_aligned_alloc(size_t align, size_t size);
void __wrap_free(void *p);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t size);
char *__wrap_strdup(const char *text);
char *__wrap_strndup(const char *text, size_t n);
char *__wrap_realpath(const char *path, char *out);
int __wrap_asprintf(char **out, const char *format, ...);
FILE *__wrap_fdopen(int fd, const char *mode);
FILE *__wrap_tmpfile(void);

void *
__wrap_aligned_alloc(size_t align, size_t size)
{
	return fails_now() ? NULL : note(__real_aligned_alloc(align, size));
}

void *
__wrap_malloc(size_t size)
{
	return fails_now() ? NULL : note(__real_malloc(size));
}

void *
__wrap_calloc(size_t n, size_t size)
{
	return fails_now() ? NULL : note(__real_calloc(n, size));
}

static void
forget(const void *p)
{
	pthread_mutex_lock(&lock);
	for (int i = 0; p != NULL && i < nlive; i++)
		if (live[i] == p) {
			live[i] = live[--nlive];
			break;
		}
	pthread_mutex_unlock(&lock);
}

void *
__wrap_realloc(void *p, size_t size)
{
	if (fails_now())
		return NULL;
	forget(p);
	return note(__real_realloc(p, size));
}

void
__wrap_free(void *p)
{
	forget(p);
	__real_free(p);
}

#if SIZE_MAX > 0xffffffff
/* C++'s operator new, new[] and what throws std::bad_alloc, as they are called
 * in object code. What they make is freed by delete, which is not seen here:
 * the leak sanitizer looks after it. */
void *__real__Znwm(size_t size);
void *__real__Znam(size_t size);
void *__wrap__Znwm(size_t size);
void *__wrap__Znam(size_t size);
_Noreturn void _ZSt17__throw_bad_allocv(void);

void *
__wrap__Znwm(size_t size)
{
	if (fails_now())
		_ZSt17__throw_bad_allocv();
	return __real__Znwm(size);
}

void *
__wrap__Znam(size_t size)
{
	if (fails_now())
		_ZSt17__throw_bad_allocv();
	return __real__Znam(size);
}
#endif

char *
__wrap_strdup(const char *text)
{
	return fails_now() ? NULL : note(__real_strdup(text));
}

char *
__wrap_strndup(const char *text, size_t n)
{
	return fails_now() ? NULL : note(__real_strndup(text, n));
}

char *
__wrap_realpath(const char *path, char *out)
{
	return fails_now() ? NULL : note(__real_realpath(path, out));
}

int
__wrap_asprintf(char **out, const char *format, ...)
{
	va_list ap;
	int n;

	if (fails_now())
		return -1;
	va_start(ap, format);
	n = vasprintf(out, format, ap);
	va_end(ap);
	if (n >= 0)
		note(*out);
	return n;
}

FILE *
__wrap_fdopen(int fd, const char *mode)
{
	return fails_now() ? NULL : __real_fdopen(fd, mode);
}

FILE *
__wrap_tmpfile(void)
{
	return fails_now() ? NULL : __real_tmpfile();
}

static int
nentries(const char *path)
{
	DIR *dir = opendir(path);
	int n = 0;

	if (dir == NULL)
		return 0;
	while (readdir(dir) != NULL)
		n++;
	closedir(dir);
	return n;
}

static int threads; /* for the run, which takes no parameters of its own */

/* run() does its work once, checks the outputs where it failed and frees them
 * where it did not. */
static inline void
fail_each(enum bake_status (*run)(struct bake_err *err), const char *what)
{
	static const int nthreads[] = { 1, 3 };

	for (int way = 0; way < 4; way++) {
		long n = 0;

		threads = nthreads[way / 2];
		for (;; n++) {
			struct bake_err err = BAKE_ERR_INIT;
			int nlive_before = nlive;
			int nfds = nentries("/proc/self/fd");
			enum bake_status rc;

			all_after = way % 2 == 1;
			nallocs = 0;
			has_failed = false;
			fail_at = n;
			rc = run(&err);
			fail_at = -1;
			if (nlive != nlive_before)
				printf("%s: allocation %ld leaks\n", what, n);
			CHECK(nlive == nlive_before);
			CHECK(nentries("/proc/self/fd") == nfds);
			CHECK(err.code == rc);
			if (!has_failed) {
				CHECK_OK(rc, err);
				break;
			}
			if (rc != BAKE_ENOMEM)
				printf("%s: allocation %ld fails, status %d\n",
				    what, n, rc);
			CHECK(rc == BAKE_ENOMEM);
			CHECK((rc == BAKE_OK) == (err.msg[0] == '\0'));
			if (n > 1000) /* it does not come to an end */
				break;
		}
		CHECK(n > 0 && n <= 1000); /* there was something to fail */
	}
}

static inline bool
is_init(const struct bake_image *img)
{
	return img->data == NULL && img->width == 0 && img->height == 0 &&
	       img->nchans == 0 && img->row_stride == 0;
}

/* Either a whole result, to be freed, or none. */
static inline enum bake_status
done(enum bake_status rc, struct bake_image *out)
{
	CHECK((rc == BAKE_OK) != is_init(out));
	bake_image_free(out);
	return rc;
}

/* A case for run_NAME, and its name. */
#define CASE_OF(f)                                                             \
	static void f(void)                                                    \
	{                                                                      \
		fail_each(run_##f, #f);                                        \
	}

#endif
