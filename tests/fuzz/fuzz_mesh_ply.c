/* Fuzz target: any bytes as a PLY file. */
/* SPDX-License-Identifier: MIT */
#include "fuzz_mesh.h"

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	fuzz_mesh(bytes, size, "x.ply", false);
	return 0;
}
