/* Fuzz target: any bytes as a glTF file that attributes are added to. */
/* SPDX-License-Identifier: MIT */
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "gltf.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* A file without a name: buffers beside it are looked for in /proc/self/fd. */
static int
make_file(const uint8_t *bytes, size_t size, char path[64])
{
	int fd = memfd_create("fuzz", MFD_CLOEXEC);

	if (fd < 0 || write(fd, bytes, size) != (ssize_t)size)
		abort();
	snprintf(path, 64, "/proc/self/fd/%d", fd);
	return fd;
}

/* What was written must be read again. */
static void
write_and_read(struct bake_gltf *g, bool glb)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_gltf *again = NULL;
	char *out = NULL, path[64];
	size_t n = 0;
	FILE *fp = open_memstream(&out, &n);
	int fd;

	if (fp == NULL)
		abort();
	if (bake_gltf_write(g, fp, glb, "-", &err) == BAKE_OK) {
		fclose(fp);
		fd = make_file((const uint8_t *)out, n, path);
		err.code = BAKE_OK;
		if (bake_gltf_read(path, 1 << 24, &again, &err) != BAKE_OK &&
		    glb) {
			fprintf(stderr, "%s\n", err.msg);
			abort();
		}
		close(fd);
	} else {
		fclose(fp);
	}
	bake_gltf_free(again);
	free(out);
}

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	static const float values[64][2];
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_gltf *g = NULL;
	unsigned char *local = NULL;
	char path[64];
	size_t nlocal;
	int fd = make_file(bytes, size, path);

	if (bake_gltf_read(path, 1 << 24, &g, &err) == BAKE_OK) {
		bake_gltf_local(g, &local, &nlocal, &err);
		for (size_t n = 0; n < 64; n++) {
			const struct bake_gltf_attribute a = { "_QUADRIC",
				"depth", values, n };

			if (bake_gltf_add(g, 0, 0, &a, &err) == BAKE_OK)
				break;
		}
		bake_gltf_set_record(g, "record", size % 2 ? "list" : "", &err);
		write_and_read(g, true);
		write_and_read(g, false);
	}
	close(fd);
	free(local);
	bake_gltf_free(g);
	return 0;
}
