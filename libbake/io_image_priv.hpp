/* What reading and writing images share: messages, exceptions, bands. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_IO_IMAGE_PRIV_HPP
#define BAKE_IO_IMAGE_PRIV_HPP

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <string>

#include "io_image.h"

/* Rows that are converted at a time: small enough to stay in cache. */
enum { BAKE_IO_BAND_ROWS = 64 };

/* OpenImageIO's message on one line. */
std::string bake_io_one_line(std::string text);

/* To be called in a catch block: the exception as a failure. */
enum bake_status bake_io_fail_exception(
    struct bake_err *err, const std::string &name);

#endif
