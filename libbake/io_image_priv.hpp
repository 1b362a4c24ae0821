/* What reading and writing images share: messages, exceptions, bands. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_IO_IMAGE_PRIV_HPP
#define BAKE_IO_IMAGE_PRIV_HPP

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <atomic>
#include <new>
#include <string>

#include "io_image.h"

/* Rows that are read or written at a time: small enough to stay in cache.
 * BAKE_BAND_ROWS=N in the environment sets another number, for tests. */
int bake_io_band_rows(void);

/* OpenImageIO's message on one line. */
std::string bake_io_one_line(std::string text);

/* Before an EXR of so many bytes is opened: threads of the library's own only
 * where they pay. Where a task for them cannot be queued for want of memory,
 * OpenEXR 3.1 waits for it forever. */
void bake_io_set_exr_threads(size_t nbytes);

enum bake_status bake_io_no_memory(struct bake_err *err, const char *name);

/* To be called in a catch block: the exception as a failure. */
enum bake_status bake_io_fail_exception(struct bake_err *err, const char *name);

/*
 * Whether an allocation failed meanwhile. OpenImageIO passes over some that do,
 * and writes a file that lacks an attribute, or reads one without.
 */
class BakeMemoryWatch
{
      public:
	BakeMemoryWatch() : before(std::set_new_handler(note))
	{
		seen = false;
	}
	~BakeMemoryWatch()
	{
		std::set_new_handler(before);
	}
	bool
	failed() const
	{
		return seen;
	}

      private:
	static inline std::atomic<bool> seen{ false };
	std::new_handler before;

	[[noreturn]] static void
	note()
	{
		seen = true;
		throw std::bad_alloc();
	}
};

#endif
