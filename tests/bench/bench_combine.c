/* Times the blend of relief textures in memory, and files with no blend. */
/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ao_rescale.h"
#include "color.h"
#include "combine.h"
#include "io_image.h"
#include "output.h"

enum { NRUNS = 5, SIDE = 2048, NTHREADS = 1 };

static double
seconds(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void
need(enum bake_status rc, const struct bake_err *err)
{
	if (rc == BAKE_OK)
		return;
	fprintf(stderr, "bench_combine: %s\n", err->msg);
	exit(1);
}

/* -- files alone ---------------------------------------------------------- */

static struct bake_image
read_file(const char *path)
{
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_image_info info;
	struct bake_reader *r;

	need(bake_reader_open(&r, path, &limits, &info, &err), &err);
	need(bake_reader_read(r, 0, info.nchans, &img, &err), &err);
	bake_reader_close(r);
	return img;
}

/* Read all files and write the last one's texels: what a blend that costs
 * nothing would take, given a file like its result as the last one. */
static int
copy_files(int n, char **paths, const char *out)
{
	struct bake_write_params p = { .type = BAKE_FILE_PNG,
		.data_format = BAKE_DATA_UINT16,
		.png_level = BAKE_PNG_LEVEL };
	struct bake_output file = BAKE_OUTPUT_INIT;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	for (int i = 0; i < n; i++) {
		bake_image_free(&img);
		img = read_file(paths[i]);
	}
	need(bake_output_open(&file, out, &err), &err);
	need(bake_image_write(&img, &p, file.stream, out, NULL, &err), &err);
	need(bake_output_commit(&file, &err), &err);
	bake_image_free(&img);
	return 0;
}

/* -- in memory ------------------------------------------------------------ */

static struct bake_image
make_layer(int side, unsigned seed)
{
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	need(bake_image_alloc(&img, side, side, 4, &err), &err);
	for (size_t i = 0; i < (size_t)side * (size_t)side * 4; i++) {
		seed = seed * 1664525u + 1013904223u;
		/* slopes stay below 45 degrees */
		img.data[i] = 0.25f + (float)(seed >> 8) / 33554432.0f;
	}
	return img;
}

/* CPU seconds of one blend of two layers; its second one is side2 wide and
 * repeated `tile` times. */
static double
blend(enum bake_normal_blend normals, int side2, double tile)
{
	struct bake_combine_params p = BAKE_COMBINE_PARAMS_DEFAULT;
	struct bake_combine_layer layer = { .normal_weight = 1,
		.depth_weight = 1,
		.place = { 1, 1, 0, 0 },
		.depth_scale = 0.1 };
	struct bake_image one = make_layer(SIDE, 1);
	struct bake_image two = make_layer(side2, 2);
	struct bake_combined out = BAKE_COMBINED_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_combine *c;
	double start = seconds();

	p.width = p.height = SIDE;
	p.depth_scale = 0.1;
	p.normal_total = p.depth_total = 1.3;
	p.nnormals = 2;
	p.normal_blend = normals;
	p.nthreads = NTHREADS;
	need(bake_combine_open(&c, &p, &err), &err);
	need(bake_combine_add(c, &layer, &one, &err), &err);
	layer.normal_weight = layer.depth_weight = 0.3;
	layer.place.tile_u = layer.place.tile_v = tile;
	need(bake_combine_add(c, &layer, &two, &err), &err);
	need(bake_combine_finish(c, &out, &err), &err);
	start = seconds() - start;
	bake_combine_close(c);
	bake_combined_free(&out);
	bake_image_free(&one);
	bake_image_free(&two);
	return start;
}

static double
rescale(void)
{
	struct bake_image img = make_layer(SIDE, 3);
	struct bake_err err = BAKE_ERR_INIT;
	double start = seconds();

	need(bake_ao_rescale_image(&img, 2, 2.5, NTHREADS, &err), &err);
	start = seconds() - start;
	bake_image_free(&img);
	return start;
}

static double
colour(void)
{
	struct bake_image img = make_layer(SIDE, 4);
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_color *color;
	double start;

	need(bake_color_open(NULL, &color, &err), &err);
	start = seconds();
	need(bake_color_to_linear(color, "sRGB", &img, NTHREADS, &err), &err);
	need(bake_color_from_linear(color, "sRGB", &img, NTHREADS, &err), &err);
	start = seconds() - start;
	bake_color_close(color);
	bake_image_free(&img);
	return start;
}

static int
compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void
report(const char *what, double *t)
{
	qsort(t, NRUNS, sizeof *t, compare);
	printf("%-28s %.3f s  (least %.3f)\n", what, t[NRUNS / 2], t[0]);
	fflush(stdout);
}

int
main(int argc, char **argv)
{
	static const struct {
		const char *what;
		enum bake_normal_blend normals;
		int side;
		double tile;
	} blends[] = {
		{ "blend, seed", BAKE_NORMAL_SEED, SIDE, 1 },
		{ "blend, pd", BAKE_NORMAL_PD, SIDE, 1 },
		{ "blend, 512 texels 4 times", BAKE_NORMAL_SEED, SIDE / 4, 4 },
		{ "blend, 512 texels 5.5 times", BAKE_NORMAL_SEED, SIDE / 4,
		    5.5 },
	};
	double t[NRUNS];

	if (argc > 3 && strcmp(argv[1], "files") == 0)
		return copy_files(argc - 3, argv + 2, argv[argc - 1]);
	printf("two layers into %dx%d, CPU seconds, one thread, median of %d\n",
	    SIDE, SIDE, NRUNS);
	for (size_t k = 0; k < sizeof blends / sizeof *blends; k++) {
		for (int i = 0; i < NRUNS; i++)
			t[i] = blend(
			    blends[k].normals, blends[k].side, blends[k].tile);
		report(blends[k].what, t);
	}
	for (int i = 0; i < NRUNS; i++)
		t[i] = rescale();
	report("AO by Eq. 6", t);
	for (int i = 0; i < NRUNS; i++)
		t[i] = colour();
	report("sRGB to linear and back", t);
	return 0;
}
