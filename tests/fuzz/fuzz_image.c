/* Fuzz target: any bytes as an image file of any kind. */
/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <stdlib.h>

#include "io_image.h"
#include "relief.h"
#include "repair.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static const char *const names[] = { "x", "x.tga", "x.dds", "x.hdr" };

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	/* small enough that an honest large picture is no time-out */
	struct bake_read_limits limits = { 1 << 16, false };
	struct bake_reader *reader = NULL;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_relief_meta meta = BAKE_RELIEF_META_INIT;
	struct bake_wrap wrap = { false, false };
	struct bake_image_info info;
	size_t nrepaired;

	/* the name's extension counts only where the bytes have no mark */
	if (bake_reader_open_memory(&reader, bytes, size,
		names[size % (sizeof names / sizeof *names)], &limits, &info,
		&err) != BAKE_OK)
		goto out;
	bake_relief_meta_from_attrs(&meta, &info.attrs);
	if (bake_reader_read(reader, 0, info.nchans, &img, &err) != BAKE_OK)
		goto out;
	if (img.width != info.width || img.height != info.height ||
	    img.nchans != info.nchans)
		abort();
	bake_repair_nonfinite(&img, wrap, 1, &nrepaired, &err);
out:
	if ((err.code == BAKE_OK) != (err.msg[0] == '\0'))
		abort();
	bake_image_free(&img);
	bake_reader_close(reader);
	return 0;
}
