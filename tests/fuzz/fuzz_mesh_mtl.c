/* Fuzz target: any bytes as the MTL file of an OBJ file. */
/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fuzz_mesh.h"

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	int fd = memfd_create("fuzz", MFD_CLOEXEC), n;
	char obj[256];

	/* a file without a name: the folder of the OBJ file is where it is */
	if (fd < 0 || write(fd, bytes, size) != (ssize_t)size)
		abort();
	n = snprintf(obj, sizeof obj,
	    "mtllib %d\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
	    "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 2/2 3/3\n"
	    "usemtl c d\nf 1/1 2/2 3/3\n",
	    fd);
	fuzz_mesh((const uint8_t *)obj, (size_t)n, "/proc/self/fd/x.obj", true);
	close(fd);
	return 0;
}
