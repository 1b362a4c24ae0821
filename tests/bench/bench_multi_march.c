/* Times the searches of multilayer marching. */
/* SPDX-License-Identifier: MIT */
#include <time.h>

#include "../unit/test_multi_march.h"

enum { NRUNS = 7, WIDTH = 640, HEIGHT = 480, SIDE = 256 };

static const struct {
	const char *name;
	struct bake_march_params params;
} methods[] = {
	{ "10,5", { BAKE_SEARCH_LINEAR, 10, 5, false } },
	{ "32,6", { BAKE_SEARCH_LINEAR, 32, 6, false } },
	{ "32,6+s", { BAKE_SEARCH_LINEAR, 32, 6, true } },
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

static void
bench_rays(const char *name, const struct bake_multi_map *map,
    const struct bake_rays *rays)
{
	struct bake_multi_hits hits = new_hits(rays->n);

	for (int m = 0; m < NMETHODS; m++) {
		double first[NRUNS], any[NRUNS];
		int nhits = 0;

		for (int i = 0; i < NRUNS; i++) {
			double start = cpu_ms();

			bake_multi_march_any(map, &methods[m].params, 0, rays);
			any[i] = cpu_ms() - start;
			start = cpu_ms();
			bake_multi_march(map, &methods[m].params, rays, &hits);
			first[i] = cpu_ms() - start;
		}
		for (int i = 0; i < rays->n; i++)
			nhits += rays->hit[i] >= 0;
		qsort(first, NRUNS, sizeof *first, by_size);
		qsort(any, NRUNS, sizeof *any, by_size);
		printf("%-12s %-8s %7.2f %7.2f  %7.2f %7.2f  %5.1f %%\n", name,
		    methods[m].name, first[0], first[NRUNS / 2], any[0],
		    any[NRUNS / 2], 100.0 * nhits / rays->n);
		fflush(stdout);
	}
	free(hits.nx);
}

int
main(void)
{
	static const int elevations[] = { 35, 14 };
	struct bake_layer_maps m =
	    layers_of(&weave_solid, SIDE, BAKE_DATA_UINT8);
	struct bake_multi_map *map = open_multi(&m, torus);
	const struct eye eye = eye_at(&weave_solid, 554, 60, 20);
	struct bake_rays rays;

	printf("weave of %dx%d texels, %dx%d rays, one thread, CPU ms min and\n"
	       "median of %d: first hits, any hit; share of hits\n",
	    SIDE, SIDE, WIDTH, HEIGHT, NRUNS);
	for (int i = 0; i < 2; i++) {
		const struct view view = { WIDTH, HEIGHT, elevations[i], 0.1 };

		rays = rays_of_view(&view);
		bench_rays(i ? "plane, 14" : "plane, 35", map, &rays);
		free(rays.u);
	}
	bake_multi_map_close(map);
	map = open_multi(&m, clamped);
	rays = rays_of_eye(&weave_solid, &eye);
	bench_rays("box, 554^2", map, &rays);
	free(rays.u);
	bake_multi_map_close(map);
	bake_layer_maps_free(&m);
	return 0;
}
