/* Times the searches of relief marching, and measures their errors. */
/* SPDX-License-Identifier: MIT */
#include <time.h>

#include "../unit/test_march.h"

enum { NRUNS = 7, WIDTH = 640, HEIGHT = 480 };

struct method {
	const char *name;
	struct bake_march_params params;
};

static const struct method methods[] = {
	{ "10,5", { BAKE_SEARCH_LINEAR, 10, 5, false } },
	{ "32,6", { BAKE_SEARCH_LINEAR, 32, 6, false } },
	{ "32,6+s", { BAKE_SEARCH_LINEAR, 32, 6, true } },
	{ "texel", { BAKE_SEARCH_TEXEL, 1, 0, true } },
	{ "texel,6", { BAKE_SEARCH_TEXEL, 1, 6, true } },
	{ "exact", { BAKE_SEARCH_EXACT, 1, 0, false } },
};
enum { NMETHODS = sizeof methods / sizeof *methods };

static double
cpu_ms(void)
{
	struct timespec t;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static int
by_size(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

struct timing {
	double least, median;
};

static struct timing
time_march(const struct bake_relief_map *map, const struct method *m, bool any,
    const struct bake_rays *rays)
{
	double t[NRUNS];

	for (int i = 0; i < NRUNS; i++) {
		const double start = cpu_ms();

		if (any)
			bake_march_any(map, &m->params, 1e-4f, rays);
		else
			bake_march(map, &m->params, rays);
		t[i] = cpu_ms() - start;
	}
	qsort(t, NRUNS, sizeof *t, by_size);
	return (struct timing){ t[0], t[NRUNS / 2] };
}

/* Depth errors against `truth`: on the same feature, and how many are not. */
static void
print_errors(const struct bake_rays *rays, const float *truth)
{
	double *e = malloc((size_t)rays->n * sizeof *e), sum = 0;
	int nwrong = 0, n = 0;

	for (int i = 0; i < rays->n; i++) {
		const double d = fabs((double)rays->hit[i] - truth[i]);

		if (d > 1e-2) {
			nwrong++;
		} else {
			e[n++] = d;
			sum += d * d;
		}
	}
	qsort(e, (size_t)n, sizeof *e, by_size);
	printf("  %8.4f %%  %.1e  %.1e  %.1e", 100.0 * nwrong / rays->n,
	    e[n / 2], e[(size_t)n * 99 / 100], sqrt(sum / n));
	free(e);
}

/* Rays from the hits up to a light 30 degrees above the horizon. */
static struct bake_rays
shadow_rays(const struct bake_rays *rays, double scale)
{
	struct bake_rays s = new_rays(rays->n);

	for (int i = 0; i < rays->n; i++) {
		const float t = rays->hit[i];

		s.u[i] = rays->u[i] + t * rays->du[i];
		s.v[i] = rays->v[i] + t * rays->dv[i];
		s.z[i] = t;
		s.dz[i] = -1;
		s.du[i] = (float)(0.6 * sqrt(3) * scale);
		s.dv[i] = (float)(0.8 * sqrt(3) * scale);
		s.t_end[i] = t;
	}
	return s;
}

static void
bench_view(const char *name, const struct bake_image *depth, double elevation)
{
	const struct view view = { WIDTH, HEIGHT, elevation, 0.1 };
	struct bake_relief_map *map = open_map(depth, torus);
	struct bake_rays rays = rays_of_view(&view), up;
	float *truth = malloc((size_t)rays.n * sizeof *truth);

	bake_march(map, &methods[NMETHODS - 1].params, &rays);
	memcpy(truth, rays.hit, (size_t)rays.n * sizeof *truth);
	up = shadow_rays(&rays, view.scale);
	for (int m = 0; m < NMETHODS; m++) {
		struct timing t = time_march(map, &methods[m], false, &rays);

		printf("%-10.10s %4d %2.0f  %-8s %7.2f %7.2f", name,
		    depth->width, elevation, methods[m].name, t.least,
		    t.median);
		print_errors(&rays, truth);
		t = time_march(map, &methods[m], true, &up);
		printf("  %7.2f %7.2f\n", t.least, t.median);
		fflush(stdout);
	}
	free(truth);
	free(rays.u);
	free(up.u);
	bake_relief_map_close(map);
}

static void
bench_map(const char *name, struct bake_image *depth)
{
	if (depth->data == NULL)
		exit(1);
	bench_view(name, depth, 35);
	bench_view(name, depth, 14);
	bake_image_free(depth);
}

/* Without arguments: maps that are made here and the project's own; else
 * depth maps (a name that begins with '-': heights) */
int
main(int argc, char **argv)
{
	struct bake_image img;

	printf("march: %dx%d rays, one thread, CPU ms min and median of %d;\n"
	       "pixels on another feature, errors of depth on the same one:\n"
	       "median, 99th percentile, RMS; shadow rays' ms\n",
	    WIDTH, HEIGHT, NRUNS);
	for (int i = 1; i < argc; i++) {
		const bool height = argv[i][0] == '-';
		const char *slash = strrchr(argv[i], '/');

		img = read_depth(argv[i] + height, height);
		bench_map(slash ? slash + 1 : argv[i], &img);
	}
	if (argc > 1)
		return 0;
	img = smooth_map(1024);
	bench_map("smooth", &img);
	img = brick_map(1024);
	bench_map("walls", &img);
	img = read_depth("testdata/stone_depth.png", false);
	bench_map("stone", &img);
	img = read_depth("testdata/bricks_depth.png", false);
	bench_map("bricks", &img);
	return 0;
}
