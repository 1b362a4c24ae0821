/* What reading and writing EXR parts share: exceptions as failures. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_IO_EXR_PRIV_HPP
#define BAKE_IO_EXR_PRIV_HPP

#include <ImfPixelType.h>

#include <cstdint>
#include <string>

#include "io_exr.h"

/* To be called in a catch block. code is what an exception of the library is,
 * if nothing else is known. */
enum bake_status bake_exr_fail_exception(
    struct bake_err *err, const std::string &name, enum bake_status code);

/* How the library calls HALF and FLOAT. */
static inline Imf::PixelType
bake_exr_type(enum bake_data_format format)
{
	return format == BAKE_DATA_HALF ? Imf::HALF : Imf::FLOAT;
}

/* The address that a row y0 lies at base from: frame buffers count from row 0,
 * which need not be there. */
static inline char *
bake_exr_row_zero(const void *base, int y0, size_t row)
{
	return (char *)((uintptr_t)base - (uintptr_t)y0 * row);
}

#endif
