/* Fuzz target: any bytes as an image file of any kind. */
/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz.h"
#include "io_image.h"
#include "relief.h"
#include "repair.h"

/* The name's extension counts only where the bytes have no mark, which TGA and
 * RLA have not. */
static const char *
name_of(const uint8_t *bytes, size_t size)
{
	return size >= 28 && bytes[26] == 0xff && bytes[27] == 0xfe ? "x.rla"
								    : "x.tga";
}

static void
note(const struct bake_image_info *info, const char *text)
{
	char kind[128];

	snprintf(kind, sizeof kind, "%s %d %d %d %d", info->container,
	    info->nchans < 5 ? info->nchans : 5, info->data_format, info->bits,
	    info->nsubimages > 1);
	fuzz_note(kind, text);
}

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

	memset(&info, 0, sizeof info);
	if (bake_reader_open_memory(&reader, bytes, size, name_of(bytes, size),
		&limits, &info, &err) != BAKE_OK)
		goto out;
	bake_relief_meta_from_attrs(&meta, &info.attrs);
	if (bake_reader_read(reader, 0, info.nchans, &img, &err) != BAKE_OK)
		goto out;
	if (img.width != info.width || img.height != info.height ||
	    img.nchans != info.nchans)
		abort();
	bake_repair_nonfinite(&img, wrap, 1, &nrepaired, &err);
out:
	note(&info, err.msg);
	if ((err.code == BAKE_OK) != (err.msg[0] == '\0'))
		abort();
	bake_image_free(&img);
	bake_reader_close(reader);
	return 0;
}
