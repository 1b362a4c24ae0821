/* Times the renderer: a plane that fills the window, and the teapot with
 * shadows and silhouettes. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "io_image.h"
#include "render.h"
#include "shape.h"

enum { NRUNS = 9 };

/*
 * The plane is 8 wide with 4 repeats, seen from 4 away at 35 degrees through a
 * window of 12 degrees; egl_render.cpp draws the same.
 */
struct scene {
	const char *name;
	enum bake_shape shape;
	int detail, width, height;
	double scale, repeat, depth, eye[3], fov_deg;
	enum bake_silhouette silhouette;
	enum bake_shadow shadow;
};

static const struct scene scenes[] = {
	{ "plane 640x480, 32,6", BAKE_SHAPE_PLANE, 1, 640, 480, 4, 4, 0.2,
	    { 0, 2.29430574, 3.27660818 }, 12, BAKE_SILHOUETTE_NONE,
	    BAKE_SHADOW_NONE },
	{ "plane with shadow", BAKE_SHAPE_PLANE, 1, 640, 480, 4, 4, 0.2,
	    { 0, 2.29430574, 3.27660818 }, 12, BAKE_SILHOUETTE_NONE,
	    BAKE_SHADOW_HARD },
	{ "teapot 1920x1080, shadow, quadrics", BAKE_SHAPE_TEAPOT, 16, 1920,
	    1080, 1, 1, 0.05, { 1.2, 1.2, 3 }, 35, BAKE_SILHOUETTE_QUADRIC,
	    BAKE_SHADOW_HARD },
};
enum { NSCENES = sizeof scenes / sizeof *scenes };

/* What a scene needs besides. */
struct loaded {
	struct bake_mesh mesh;
	struct bake_weld weld;
	struct bake_frames frames;
	struct bake_quadric *quadrics;
};

static void
must(enum bake_status rc, const struct bake_err *err)
{
	if (rc == BAKE_OK)
		return;
	fprintf(stderr, "bench_render: %s\n", err->msg);
	exit(1);
}

static double
seconds(clockid_t clock)
{
	struct timespec t;

	clock_gettime(clock, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int
by_size(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static struct bake_image
read_image(const char *path)
{
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	struct bake_image_info info;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_reader *reader = NULL;
	struct bake_err err = BAKE_ERR_INIT;

	must(bake_reader_open(&reader, path, &limits, &info, &err), &err);
	must(bake_reader_read(reader, 0, info.nchans, &img, &err), &err);
	bake_reader_close(reader);
	return img;
}

/* Normal x and y, occlusion (1), depth. */
static struct bake_image
read_relief(void)
{
	struct bake_image normal = read_image("testdata/stone_normal.png");
	struct bake_image depth = read_image("testdata/stone_depth.png");
	struct bake_image relief = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	must(bake_image_alloc(&relief, depth.width, depth.height, 4, &err),
	    &err);
	for (int y = 0; y < depth.height; y++)
		for (int x = 0; x < depth.width; x++) {
			const float *n = bake_image_row(&normal, y) +
					 (size_t)normal.nchans * (size_t)x;
			float *out = bake_image_row(&relief, y) + 4 * (size_t)x;

			out[0] = 2 * n[0] - 1;
			out[1] = 2 * n[1] - 1;
			out[2] = 1;
			out[3] = bake_image_row(
			    &depth, y)[(size_t)depth.nchans * (size_t)x];
		}
	bake_image_free(&normal);
	bake_image_free(&depth);
	return relief;
}

/* The same in bytes, rows from the bottom, for egl_render. */
static void
write_relief(const struct bake_image *relief, const char *path)
{
	FILE *f = fopen(path, "wb");

	for (int y = relief->height - 1; f != NULL && y >= 0; y--)
		for (int i = 0; i < 4 * relief->width; i++) {
			const float v = bake_image_row(relief, y)[i];

			putc((int)(255 * (i % 4 < 2 ? (v + 1) / 2 : v) + 0.5f),
			    f);
		}
	if (f == NULL || fclose(f) != 0) {
		perror(path);
		exit(1);
	}
}

static void
load(struct loaded *l, const struct scene *s)
{
	struct bake_frame_params how = BAKE_FRAME_PARAMS_DEFAULT;
	const struct bake_quadric_params fit = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_err err = BAKE_ERR_INIT;

	memset(l, 0, sizeof *l);
	how.tangents = BAKE_TANGENTS_FILE;
	must(bake_shape_make(s->shape, s->detail, &l->mesh, &err), &err);
	for (size_t v = 0; v < l->mesh.npositions; v++)
		for (int k = 0; k < 3; k++)
			l->mesh.positions[v][k] *= s->scale;
	must(bake_mesh_weld(&l->mesh, 0, &l->weld, &err), &err);
	must(bake_mesh_frames(&l->mesh, &l->weld, NULL, &how, &l->frames, &err),
	    &err);
	if (s->silhouette != BAKE_SILHOUETTE_QUADRIC)
		return;
	l->quadrics = calloc(l->frames.nframes, sizeof *l->quadrics);
	if (l->quadrics == NULL)
		exit(1);
	must(bake_quadric_fit(
		 &l->mesh, &l->weld, &l->frames, &fit, l->quadrics, &err),
	    &err);
}

static void
unload(struct loaded *l)
{
	free(l->quadrics);
	bake_frames_free(&l->frames);
	bake_weld_free(&l->weld);
	bake_mesh_free(&l->mesh);
}

/* Milliseconds of NRUNS pictures, sorted. */
static void
measure(const struct bake_render_object *o, struct bake_render_params *p,
    int nthreads, clockid_t clock, double ms[NRUNS])
{
	struct bake_err err = BAKE_ERR_INIT;

	p->nthreads = nthreads;
	for (int i = 0; i < NRUNS; i++) {
		struct bake_render_buffers b = { .want = 0 };
		const double start = seconds(clock);

		must(bake_render(o, 1, p, &b, &err), &err);
		ms[i] = 1e3 * (seconds(clock) - start);
		bake_render_buffers_free(&b);
	}
	qsort(ms, NRUNS, sizeof *ms, by_size);
}

static void
bench(const struct scene *s, const struct bake_relief_map *map,
    const struct bake_image *texels)
{
	const struct bake_render_layer layer = { .map = map,
		.texels = texels,
		.tile_u = 1,
		.tile_v = 1,
		.normal_weight = 1,
		.depth_weight = 1,
		.slope = 1,
		.ao_scale = 1 };
	struct loaded l;
	struct bake_render_object o = { .mesh = &l.mesh,
		.frames = &l.frames,
		.silhouette = s->silhouette,
		.depth = s->depth,
		.tile_u = s->repeat,
		.tile_v = s->repeat,
		.layers = &layer,
		.nlayers = 1,
		.material = { .base = { 0.6f, 0.6f, 0.6f },
		    .specular = 0.1f,
		    .shininess = 40 } };
	struct bake_render_params p = {
		.camera = { .eye = { s->eye[0], s->eye[1], s->eye[2] },
		    .up = { 0, 1, 0 },
		    .fov_deg = s->fov_deg,
		    .near = 0.01,
		    .width = s->width,
		    .height = s->height },
		.samples = 1,
		.march = BAKE_MARCH_PARAMS_DEFAULT,
		.light = { .at = { -1, 2, 1.5 }, .color = { 1, 1, 1 } },
		.ambient = { 0.3f, 0.3f, 0.3f },
		.background = { 0, 0, 0, 1 },
		.shadow = s->shadow,
		.ao = true
	};
	double one[NRUNS], cpu[NRUNS], two[NRUNS];

	load(&l, s);
	o.quadrics = l.quadrics;
	measure(&o, &p, 1, CLOCK_THREAD_CPUTIME_ID, cpu);
	measure(&o, &p, 1, CLOCK_MONOTONIC, one);
	measure(&o, &p, 2, CLOCK_MONOTONIC, two);
	printf("%s, CPU of one thread, ms\t%.2f\t%.2f\n", s->name, cpu[0],
	    cpu[NRUNS / 2]);
	printf("%s, two threads, elapsed ms\t%.2f\t%.2f\t%.2f\n", s->name,
	    two[0], two[NRUNS / 2], one[0] / two[0]);
	unload(&l);
}

/* bench_render [SCENE]: all, or that one; --write FILE: the relief, as bytes */
int
main(int argc, char **argv)
{
	const struct bake_wrap torus = { false, false };
	struct bake_image relief = read_relief(), depth = BAKE_IMAGE_INIT;
	struct bake_relief_map *map;
	struct bake_err err = BAKE_ERR_INIT;

	if (argc == 3 && strcmp(argv[1], "--write") == 0) {
		write_relief(&relief, argv[2]);
		bake_image_free(&relief);
		return 0;
	}
	must(bake_image_alloc(&depth, relief.width, relief.height, 1, &err),
	    &err);
	bake_image_copy_channel(&depth, 0, &relief, 3);
	must(bake_relief_map_open(&map, &depth, torus, 1, &err), &err);
	for (int i = 0; i < NSCENES; i++)
		if (argc < 2 || atoi(argv[1]) == i)
			bench(&scenes[i], map, &relief);
	bake_relief_map_close(map);
	bake_image_free(&depth);
	bake_image_free(&relief);
	return 0;
}
