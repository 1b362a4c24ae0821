/* The work of a batch of occlusion bakes, with nothing around it. */
/* SPDX-License-Identifier: MIT */
/*
 *	bench_batch DIR FILE ...
 *
 * Reads, bakes and writes each FILE to DIR, in one process, on one thread.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ao.h"
#include "io_image.h"
#include "output.h"

static void
need(enum bake_status rc, const struct bake_err *err)
{
	if (rc == BAKE_OK)
		return;
	fprintf(stderr, "bench_batch: %s\n", err->msg);
	exit(1);
}

static void
read_map(const char *path, struct bake_image *img)
{
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_image_info info;
	struct bake_reader *r;

	need(bake_reader_open(&r, path, &limits, &info, &err), &err);
	need(bake_reader_read(r, 0, 1, img, &err), &err);
	bake_reader_close(r);
}

static void
write_map(const char *path, const struct bake_image *img)
{
	const struct bake_write_params p = { .type = BAKE_FILE_PNG,
		.data_format = BAKE_DATA_UINT16,
		.png_level = BAKE_PNG_LEVEL };
	struct bake_output file = BAKE_OUTPUT_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	need(bake_output_open(&file, path, &err), &err);
	need(bake_image_write(img, &p, file.stream, path, NULL, &err), &err);
	need(bake_output_commit(&file, &err), &err);
}

static void
bake(const char *in, const char *out)
{
	struct bake_ao_params p = BAKE_AO_PARAMS_DEFAULT;
	struct bake_image depth = BAKE_IMAGE_INIT, ao = BAKE_IMAGE_INIT;
	const struct bake_ao_result result = { &ao, NULL, NULL };
	const double scale = 0.1;
	struct bake_err err = BAKE_ERR_INIT;

	p.nthreads = 1;
	p.quality = BAKE_AO_FAST;
	read_map(in, &depth);
	need(bake_ao(&depth, &scale, 1, &p, &result, &err), &err);
	write_map(out, &ao);
	bake_image_free(&depth);
	bake_image_free(&ao);
}

int
main(int argc, char *argv[])
{
	for (int i = 2; i < argc; i++) {
		const char *slash = strrchr(argv[i], '/');
		char out[4096];

		snprintf(out, sizeof out, "%s/%s", argv[1],
		    slash != NULL ? slash + 1 : argv[i]);
		bake(argv[i], out);
	}
	return 0;
}
