/* What the fuzz targets of whole tools share. */
/* SPDX-License-Identifier: MIT */
#ifndef FUZZ_TOOLS_H
#define FUZZ_TOOLS_H

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "fuzz.h"
#include "image.h"
#include "mem.h"

/* Each tool's main under a name of its own; the Makefile renames them. */
int rm_aobake_main(int argc, char *argv[]);
int rm_combine_main(int argc, char *argv[]);
int rm_info_main(int argc, char *argv[]);
int rm_multilayer_main(int argc, char *argv[]);
int rm_pack_main(int argc, char *argv[]);
int rm_quadfit_main(int argc, char *argv[]);
int rm_render_main(int argc, char *argv[]);
int rm_rescale_ao_main(int argc, char *argv[]);
int rm_roughen_main(int argc, char *argv[]);

struct fuzz_tool {
	const char *name;
	int (*main)(int argc, char *argv[]);
};

static const struct fuzz_tool fuzz_tools[] = {
	{ "rm-aobake", rm_aobake_main },
	{ "rm-combine", rm_combine_main },
	{ "rm-info", rm_info_main },
	{ "rm-multilayer", rm_multilayer_main },
	{ "rm-pack", rm_pack_main },
	{ "rm-quadfit", rm_quadfit_main },
	{ "rm-render", rm_render_main },
	{ "rm-rescale-ao", rm_rescale_ao_main },
	{ "rm-roughen", rm_roughen_main },
};
enum { FUZZ_NTOOLS = sizeof fuzz_tools / sizeof *fuzz_tools };

/* -- no work worth speaking of ------------------------------------------------
 * The targets are linked with --wrap of these: a tool that would begin to work
 * on much gets no memory, and none starts a process. */

static size_t fuzz_most_bytes = SIZE_MAX; /* of one array */

void *__real_bake_alloc(size_t count, size_t size, struct bake_err *err);
void *__real_bake_zalloc(size_t count, size_t size, struct bake_err *err);
enum bake_status __real_bake_image_alloc(struct bake_image *img, int width,
    int height, int nchans, struct bake_err *err);
void *__wrap_bake_alloc(size_t count, size_t size, struct bake_err *err);
void *__wrap_bake_zalloc(size_t count, size_t size, struct bake_err *err);
enum bake_status __wrap_bake_image_alloc(struct bake_image *img, int width,
    int height, int nchans, struct bake_err *err);
pid_t __wrap_fork(void);
void __wrap_cmd_signals_start(void);

static int
fuzz_is_much(size_t a, size_t b)
{
	size_t n;

	return __builtin_mul_overflow(a, b, &n) || n > fuzz_most_bytes;
}

void *
__wrap_bake_alloc(size_t count, size_t size, struct bake_err *err)
{
	return __real_bake_alloc(
	    fuzz_is_much(count, size) ? SIZE_MAX : count, size, err);
}

void *
__wrap_bake_zalloc(size_t count, size_t size, struct bake_err *err)
{
	return __real_bake_zalloc(
	    fuzz_is_much(count, size) ? SIZE_MAX : count, size, err);
}

enum bake_status
__wrap_bake_image_alloc(struct bake_image *img, int width, int height,
    int nchans, struct bake_err *err)
{
	if (width > 0 && height > 0 && nchans > 0 &&
	    fuzz_is_much(
		(size_t)width * (size_t)height, (size_t)nchans * sizeof(float)))
		width = height = nchans = INT32_MAX;
	return __real_bake_image_alloc(img, width, height, nchans, err);
}

pid_t
__wrap_fork(void)
{
	errno = EAGAIN;
	return -1;
}

/* Crashes are libFuzzer's to see. */
void
__wrap_cmd_signals_start(void)
{
}

/* -- running one --------------------------------------------------------------
 */

static int fuzz_home = -1, fuzz_jail = -1;

/* Standard input is empty, standard output and error go nowhere (libFuzzer
 * keeps a copy of its own with -close_fd_mask=3). */
static inline void
fuzz_open_jail(int jail)
{
	int null = open("/dev/null", O_RDONLY | O_CLOEXEC);

	fuzz_home = open(".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	fuzz_jail = jail;
	if (null < 0 || fuzz_home < 0 || jail < 0 || dup2(null, 0) < 0)
		abort();
}

/* A new folder among those for temporary files. */
static inline char *
fuzz_make_folder(void)
{
	const char *tmp = getenv("TMPDIR");
	char *path;

	if (asprintf(&path, "%s/relief-fuzz.XXXXXX",
		tmp != NULL ? tmp : "/tmp") < 0 ||
	    mkdtemp(path) == NULL)
		abort();
	return path;
}

/* Run it where the jail is. */
static inline int
fuzz_run(int (*tool)(int argc, char *argv[]), int argc, char *argv[])
{
	int status;

	if (fchdir(fuzz_jail) != 0)
		abort();
	status = tool(argc, argv);
	if (fchdir(fuzz_home) != 0 || status < 0 || status > 2)
		abort();
	return status;
}

#endif
