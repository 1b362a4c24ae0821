/* Times the ambient-occlusion bake on synthetic maps, and any given maps. */
/* SPDX-License-Identifier: MIT */
#include "ao.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { NRUNS = 5, NDIRS = 50 };
static const double scale = 0.1;

static double
seconds(clockid_t clock)
{
	struct timespec t;

	clock_gettime(clock, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static struct bake_image
new_map(int width, int height)
{
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_image_alloc(&img, width, height, 1, &err) != BAKE_OK) {
		fprintf(stderr, "bench_ao: %s\n", err.msg);
		exit(1);
	}
	return img;
}

static float
random_unit(unsigned *state)
{
	/* a hash of a counter: a linear congruence repeats along columns */
	unsigned z = *state += 0x9e3779b9u;

	z = (z ^ z >> 16) * 0x85ebca6bu;
	z = (z ^ z >> 13) * 0xc2b2ae35u;
	return (float)((z ^ z >> 16) >> 8) / 16777216.0f;
}

static struct bake_image
make_noise(int side)
{
	struct bake_image img = new_map(side, side);
	unsigned seed = 1;

	for (size_t i = 0; i < (size_t)side * (size_t)side; i++)
		img.data[i] = random_unit(&seed);
	return img;
}

/* one brick is 1/8 x 1/16 of the side, joints 1/128, with bevels and grain */
static struct bake_image
make_bricks(int side)
{
	struct bake_image img = new_map(side, side);
	unsigned seed = 2;

	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++) {
			double v = 16.0 * y / side, u = 8.0 * x / side;
			double fu, fv, d;

			u += (int)v % 2 * 0.5;
			fu = 2 * fabs(u - floor(u) - 0.5);
			fv = 2 * fabs(v - floor(v) - 0.5);
			d = fmax((fu - 0.88) / 0.06, (fv - 0.76) / 0.12);
			d = fmin(1, fmax(0, d));
			img.data[(size_t)y * (size_t)side + (size_t)x] =
			    (float)(0.9 * d) + 0.05f * random_unit(&seed);
		}
	return img;
}

/* a sum of waves that tile, wavelengths down to 1/40 of the side */
static struct bake_image
make_smooth(int side)
{
	struct bake_image img = new_map(side, side);
	unsigned seed = 3;
	double waves[24][3];

	for (int i = 0; i < 24; i++) {
		waves[i][0] = floor(80 * random_unit(&seed)) - 40;
		waves[i][1] = floor(80 * random_unit(&seed)) - 40;
		waves[i][2] = 6.28318 * random_unit(&seed);
	}
	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++) {
			double sum = 0;

			for (int i = 0; i < 24; i++)
				sum += sin(
				    6.283185307179586 *
					(waves[i][0] * x + waves[i][1] * y) /
					side +
				    waves[i][2]);
			img.data[(size_t)y * (size_t)side + (size_t)x] =
			    (float)fmin(1, fmax(0, 0.5 + sum / 24));
		}
	return img;
}

static struct bake_image
make_spikes(int side)
{
	struct bake_image img = new_map(side, side);
	unsigned seed = 4;

	for (size_t i = 0; i < (size_t)side * (size_t)side; i++)
		img.data[i] = random_unit(&seed) < 0.001f ? 0 : 1;
	return img;
}

/* a binary PGM of 8 or 16 bits, read as depth; a line a bench can do without
 * the library's readers */
static struct bake_image
read_pgm(const char *path)
{
	struct bake_image img;
	int width, height, max;
	FILE *f = fopen(path, "rb");

	if (f == NULL || fscanf(f, "P5 %d %d %d", &width, &height, &max) != 3 ||
	    fgetc(f) == EOF) {
		fprintf(stderr, "bench_ao: '%s' is no binary PGM\n", path);
		exit(1);
	}
	img = new_map(width, height);
	for (size_t i = 0; i < (size_t)width * (size_t)height; i++) {
		int code = fgetc(f);

		if (max > 255)
			code = code << 8 | fgetc(f);
		img.data[i] = (float)code / (float)max;
	}
	fclose(f);
	return img;
}

static struct bake_image
bake(const struct bake_image *depth, enum bake_ao_quality quality, int nthreads)
{
	struct bake_ao_params params = BAKE_AO_PARAMS_DEFAULT;
	struct bake_image ao = BAKE_IMAGE_INIT;
	struct bake_ao_result result = { &ao, NULL, NULL };
	struct bake_err err = BAKE_ERR_INIT;

	params.ndirs = NDIRS;
	params.quality = quality;
	params.nthreads = nthreads;
	if (bake_ao(depth, &scale, 1, &params, &result, &err) != BAKE_OK) {
		fprintf(stderr, "bench_ao: %s\n", err.msg);
		exit(1);
	}
	return ao;
}

static int
compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static double
median_time(const struct bake_image *depth, enum bake_ao_quality quality,
    int nthreads, clockid_t clock, int nruns)
{
	double t[NRUNS];

	for (int i = 0; i < nruns; i++) {
		double start = seconds(clock);
		struct bake_image ao = bake(depth, quality, nthreads);

		t[i] = seconds(clock) - start;
		bake_image_free(&ao);
	}
	qsort(t, (size_t)nruns, sizeof *t, compare);
	return t[nruns / 2];
}

static void
print_error(const char *label, const struct bake_image *depth,
    enum bake_ao_quality quality, const struct bake_image *exact)
{
	struct bake_image ao = bake(depth, quality, 0);
	double sum = 0, bias = 0, worst = 0;
	size_t n = (size_t)ao.width * (size_t)ao.height;

	for (size_t i = 0; i < n; i++) {
		double d = (double)ao.data[i] - exact->data[i];

		sum += fabs(d);
		bias += d;
		worst = fmax(worst, fabs(d));
	}
	printf("  %s error %.2e (bias %+.2e, max %.3f)", label, sum / (double)n,
	    bias / (double)n, worst);
	bake_image_free(&ao);
}

/* CPU seconds on one thread at each quality, and the errors */
static void
bench_map(const char *name, const struct bake_image *depth)
{
	static const char *const labels[] = { "exact", "fast", "preview" };
	struct bake_image exact = bake(depth, BAKE_AO_EXACT, 0);

	printf("%-12.12s %dx%d ", name, depth->width, depth->height);
	for (int q = 0; q < 3; q++)
		printf(" %s %.3f s", labels[q],
		    median_time(depth, (enum bake_ao_quality)q, 1,
			CLOCK_PROCESS_CPUTIME_ID, NRUNS));
	for (int q = 1; q < 3; q++)
		print_error(labels[q], depth, (enum bake_ao_quality)q, &exact);
	printf("\n");
	fflush(stdout);
	bake_image_free(&exact);
}

typedef struct bake_image make_map(int side);

static void
bench_growth(const char *name, make_map *make)
{
	static const char *const labels[] = { "exact", "fast", "preview" };

	for (int q = 0; q < 3; q++) {
		double last = 0;

		printf("%-8s %-8s", name, labels[q]);
		for (int side = 512; side <= 2048; side *= 2) {
			struct bake_image depth = make(side);
			double t = median_time(&depth, (enum bake_ao_quality)q,
			    1, CLOCK_PROCESS_CPUTIME_ID, side < 2048 ? 3 : 1);

			printf("  %d: %.3f s", side, t);
			if (last > 0)
				printf(" (x%.2f)", t / last);
			last = t;
			bake_image_free(&depth);
		}
		printf("\n");
		fflush(stdout);
	}
}

static void
bench_threads(const struct bake_image *depth)
{
	double one = median_time(depth, BAKE_AO_EXACT, 1, CLOCK_MONOTONIC, 5);
	double two = median_time(depth, BAKE_AO_EXACT, 2, CLOCK_MONOTONIC, 5);

	printf("threads  exact   1: %.3f s  2: %.3f s wall (x%.2f)\n", one, two,
	    one / two);
}

int
main(int argc, char **argv)
{
	static const struct {
		const char *name;
		make_map *make;
	} maps[] = { { "noise", make_noise }, { "bricks", make_bricks },
		{ "smooth", make_smooth }, { "spikes", make_spikes } };
	const char *only = getenv("BENCH_ONLY"); /* maps: skip the growth */

	printf("%d directions, CPU seconds, one thread, median of %d\n", NDIRS,
	    NRUNS);
	for (int i = 0; i < 4; i++) {
		struct bake_image depth = maps[i].make(1024);

		bench_map(maps[i].name, &depth);
		if (i == 1 && only == NULL)
			bench_threads(&depth);
		bake_image_free(&depth);
	}
	for (int i = 1; i < argc; i++) {
		const char *slash = strrchr(argv[i], '/');
		struct bake_image depth = read_pgm(argv[i]);

		bench_map(slash ? slash + 1 : argv[i], &depth);
		bake_image_free(&depth);
	}
	for (int i = 0; i < 3 && only == NULL; i++)
		bench_growth(maps[i].name, maps[i].make);
	return 0;
}
