/* Fuzz target: any bytes as an EXR file of several parts, or a deep one. */
/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <stdlib.h>

#include "io_exr.h"
#include "relief.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* Every part by all its channels; what is read has the sizes it was said to
 * have. */
static void
read_part(struct bake_exr *exr, int part, struct bake_err *err)
{
	const struct bake_exr_part_info *p = bake_exr_info(exr, part);
	struct bake_relief_meta meta = BAKE_RELIEF_META_INIT;
	struct bake_deep_image deep = BAKE_DEEP_IMAGE_INIT;
	struct bake_pixels px = BAKE_PIXELS_INIT;
	size_t n = (size_t)p->info.width * (size_t)p->info.height;

	bake_relief_meta_from_attrs(&meta, &p->info.attrs);
	if (p->deep) {
		if (bake_exr_read_deep(exr, part, NULL, 0, &deep, err) ==
			BAKE_OK &&
		    (deep.nchans != p->info.nchans ||
			deep.start[n] != deep.nsamples))
			abort();
	} else if (bake_exr_read(exr, part, NULL, 0, &px, err) == BAKE_OK) {
		if (px.width != p->info.width || px.height != p->info.height ||
		    px.nchans != p->info.nchans ||
		    px.format != p->info.data_format)
			abort();
	}
	bake_deep_image_free(&deep);
	bake_pixels_free(&px);
}

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	/* small enough that an honest large picture is no time-out */
	const struct bake_read_limits limits = { 1 << 16, false };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_exr *exr;

	if (bake_exr_open_memory(&exr, bytes, size, "x.exr", &limits, &err) ==
	    BAKE_OK)
		for (int i = 0; i < bake_exr_nparts(exr); i++)
			read_part(exr, i, &err);
	if ((err.code == BAKE_OK) != (err.msg[0] == '\0'))
		abort();
	bake_exr_close(exr);
	return 0;
}
