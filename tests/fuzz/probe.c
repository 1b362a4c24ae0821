/* Compiles and links where clang has libFuzzer and OpenMP: make asks. */
/* SPDX-License-Identifier: MIT */
#include <omp.h>
#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	return bytes != NULL && size > 0 && omp_get_max_threads() < 0;
}
