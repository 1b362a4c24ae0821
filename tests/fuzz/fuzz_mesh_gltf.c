/* Fuzz target: any bytes as a glTF file, text or binary. */
/* SPDX-License-Identifier: MIT */
#include "fuzz_mesh.h"

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	fuzz_mesh(bytes, size, "x.gltf", false);
	return 0;
}
