/* Rays, views and maps for the tests and the bench of relief marching. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_MARCH_H
#define TEST_MARCH_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io_image.h"
#include "march.h"
#include "mem.h"
#include "test_maps.h"

enum { RAY_ARRAYS = 9 };

/* n rays, all zero, t_end = 1, dz = 1. Freed by free(rays.u). */
static inline struct bake_rays
new_rays(int n)
{
	struct bake_err err = BAKE_ERR_INIT;
	const size_t padded = ((size_t)n + 15) / 16 * 16;
	float *p = bake_zalloc(padded * RAY_ARRAYS, sizeof *p, &err);
	float **a[RAY_ARRAYS];
	struct bake_rays r = { .n = n };

	if (p == NULL)
		abort();
	a[0] = &r.u, a[1] = &r.v, a[2] = &r.z;
	a[3] = &r.du, a[4] = &r.dv, a[5] = &r.dz;
	a[6] = &r.q, a[7] = &r.t_end, a[8] = &r.hit;
	for (int i = 0; i < RAY_ARRAYS; i++)
		*a[i] = p + (size_t)i * padded;
	for (int i = 0; i < n; i++)
		r.dz[i] = r.t_end[i] = 1;
	return r;
}

/* Every search. */
static const struct bake_march_params searches[] = {
	{ BAKE_SEARCH_LINEAR, 32, 6, true },
	{ BAKE_SEARCH_LINEAR, 10, 5, false },
	{ BAKE_SEARCH_LINEAR, 7, 0, true },
	{ BAKE_SEARCH_TEXEL, 1, 0, true },
	{ BAKE_SEARCH_TEXEL, 8, 6, false },
	{ BAKE_SEARCH_EXACT, 0, 0, false },
};
enum { NSEARCHES = sizeof searches / sizeof *searches };

/* Rays of all directions over the map, all starting at depth z. */
static inline struct bake_rays
fan(int n, float z)
{
	struct bake_rays r = new_rays(n);

	for (int i = 0; i < n; i++) {
		r.u[i] = (float)(hash((uint32_t)i) % 4096) / 1024 - 2;
		r.v[i] = (float)(hash((uint32_t)i + 7777) % 4096) / 1024 - 2;
		r.z[i] = z;
		r.du[i] = (float)(0.4 * cos(0.7 * i));
		r.dv[i] = (float)(0.4 * sin(0.7 * i));
	}
	return r;
}

static inline struct bake_relief_map *
open_map(const struct bake_image *depth, struct bake_wrap wrap)
{
	struct bake_relief_map *map;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_relief_map_open(&map, depth, wrap, 1, &err) != BAKE_OK) {
		fprintf(stderr, "%s\n", err.msg);
		abort();
	}
	return map;
}

/*
 * A pinhole above the plane z = 0, two texture widths from its point
 * (1/2, 1/2), at which it looks from that elevation; 12 degrees high. The rays
 * begin on the plane and end below depth 1 of a relief `scale` deep: t is the
 * depth. Nothing but plane is seen for elevations above 7 degrees.
 */
struct view {
	int width, height;
	double elevation_deg, scale;
};

static inline struct bake_rays
rays_of_view(const struct view *v)
{
	struct bake_rays r = new_rays(v->width * v->height);
	const double a = v->elevation_deg * pi / 180, dist = 2;
	const double half = tan(6 * pi / 180);
	/* towards the plane, right and up, x right, y away, z up */
	const double f[3] = { 0, cos(a), -sin(a) }, up[2] = { sin(a), cos(a) };

	for (int y = 0; y < v->height; y++)
		for (int x = 0; x < v->width; x++) {
			const int i = y * v->width + x;
			double sx = half * (2 * x + 1 - v->width) / v->height;
			double sy = half * (v->height - 2 * y - 1) / v->height;
			double d[3] = { sx, f[1] + sy * up[0],
				f[2] + sy * up[1] };
			double to_plane = dist * sin(a) / -d[2];

			r.u[i] = (float)(0.5 + to_plane * d[0]);
			r.v[i] = (float)(0.5 - dist * cos(a) + to_plane * d[1]);
			r.du[i] = (float)(d[0] / -d[2] * v->scale);
			r.dv[i] = (float)(d[1] / -d[2] * v->scale);
			r.t_end[i] = 1 + 0x1p-20f;
		}
	return r;
}

/* One channel of a file as depth, 0 .. 1 of what it holds; BAKE_IMAGE_INIT
 * where it cannot be read. */
static inline struct bake_image
read_depth(const char *path, bool is_height)
{
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	struct bake_image_info info;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_reader *reader = NULL;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_reader_open(&reader, path, &limits, &info, &err) != BAKE_OK ||
	    bake_reader_read(reader, 0, 1, &img, &err) != BAKE_OK)
		fprintf(stderr, "%s\n", err.msg);
	bake_reader_close(reader);
	if (is_height && img.data != NULL)
		for (size_t i = 0; i < nfloats(&img); i++)
			img.data[i] = 1 - img.data[i];
	return img;
}

/* A sum of waves that tile, of wavelengths down to 1/12 of the side. */
static inline struct bake_image
smooth_map(int side)
{
	struct bake_image img = image(side, side, 1);

	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++) {
			const double u = 2 * pi * x / side,
				     v = 2 * pi * y / side;
			double d = sin(3 * u + v) + sin(2 * v - 5 * u + 1) +
				   sin(9 * u + 7 * v) + sin(12 * v - 4 * u);

			img.data[y * side + x] = (float)(0.5 + 0.125 * d);
		}
	return img;
}

/* Walls: plateaus at depth 0 and 0.2, joints at 1, one texel steep. */
static inline struct bake_image
brick_map(int side)
{
	struct bake_image img = image(side, side, 1);

	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++) {
			const int row = y * 8 / side;
			const int at = x * 8 + row % 2 * side / 2;
			const bool joint = at % (2 * side) < side / 4 ||
					   y * 8 % side < side / 8;

			img.data[y * side + x] =
			    joint ? 1.0f : 0.2f * (float)(at / (2 * side) % 2);
		}
	return img;
}

#endif
