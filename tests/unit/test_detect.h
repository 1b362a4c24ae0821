/* Surfaces with known slopes, and the maps that bake_detect is tested on. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_DETECT_H
#define TEST_DETECT_H

#include "check.h"
#include "detect.h"
#include "test_maps.h"

/* A surface on the torus: height and its slopes, y up, per texture width. */
struct surface {
	int width, height;
	float *h, *hx, *hy;
};

static inline float
random_unit(unsigned *state)
{
	*state = *state * 1664525u + 1013904223u;
	return (float)(*state >> 8) / (float)(1 << 24);
}

static inline struct surface
surface_new(int width, int height)
{
	struct surface s = { width, height, NULL, NULL, NULL };
	size_t n = (size_t)width * (size_t)height;

	s.h = calloc(n, sizeof *s.h);
	s.hx = calloc(n, sizeof *s.hx);
	s.hy = calloc(n, sizeof *s.hy);
	if (s.h == NULL || s.hx == NULL || s.hy == NULL)
		abort();
	return s;
}

static inline void
surface_free(struct surface *s)
{
	free(s->h);
	free(s->hx);
	free(s->hy);
}

/* Add amp cos(2 pi (i u + j v) + phase), u = x/W, v = 1 - row/W up. */
static inline void
add_wave(struct surface *s, int i, int j, double amp, double phase)
{
	double aspect = (double)s->width / s->height;

	for (int y = 0; y < s->height; y++) {
		for (int x = 0; x < s->width; x++) {
			size_t k = (size_t)y * (size_t)s->width + (size_t)x;
			double a = 2 * pi *
				       ((double)i * x / s->width -
					   (double)j * y / s->height) +
				   phase;
			double slope = -2 * pi * amp * sin(a);

			s->h[k] += (float)(amp * cos(a));
			s->hx[k] += (float)(i * slope);
			s->hy[k] += (float)(j * aspect * slope);
		}
	}
}

/* Random waves up to most per side, amplitude falling as 1/|frequency|,
 * height within about 0 .. 1. */
static inline struct surface
rough(int width, int height, int most, unsigned seed)
{
	struct surface s = surface_new(width, height);
	unsigned state = seed * 7919u + 1u;

	for (int n = 0; n < 40; n++) {
		int i =
		    (int)(random_unit(&state) * (float)(2 * most + 1)) - most;
		int j = 1 + (int)(random_unit(&state) * (float)most);
		double f = sqrt((double)(i * i + j * j));

		add_wave(&s, i, j, 0.15 / f, 2 * pi * random_unit(&state));
	}
	for (size_t k = 0; k < (size_t)width * (size_t)height; k++)
		s.h[k] += 0.5f;
	return s;
}

/* Bricks in running bond with bevels as tanh: nx by ny of them, the pattern
 * moved by offset of a brick. */
static inline struct surface
bricks(int width, int height, int nx, int ny, double offset)
{
	struct surface s = surface_new(width, height);
	const double steep = 30;

	for (int y = 0; y < height; y++) {
		for (int x = 0; x < width; x++) {
			size_t k = (size_t)y * (size_t)width + (size_t)x;
			double v = (double)ny * (y + 0.5) / height + offset;
			double u = (double)nx * (x + 0.5) / width +
				   0.5 * ((int)v % 2) + offset;
			double a = u - floor(u), b = v - floor(v);
			double da = a < 0.5 ? a : 1 - a,
			       db = b < 0.5 ? b : 1 - b;
			double fa = tanh(steep * da / nx * 2);
			double fb = tanh(steep * db / ny * 2);
			double ga = 2 * steep * (1 - fa * fa);
			double gb = 2 * steep * (1 - fb * fb) * width / height;

			s.h[k] = (float)(fa * fb);
			s.hx[k] = (float)((a < 0.5 ? ga : -ga) * fb);
			s.hy[k] = (float)((b < 0.5 ? -gb : gb) * fa);
		}
	}
	return s;
}

/* How a surface becomes two maps. */
struct maps {
	double scale;                   /* S: slopes are S times those of h */
	bool depth, y_down;             /* conventions */
	int normal_codes, relief_codes; /* 0: float */
	int nchans;                     /* of the normal map */
	double noise;                   /* on normal components, uniform, +- */
};
#define MAPS_DEFAULT                                                           \
	{                                                                      \
		0.1, false, false, 0, 0, 3, 0                                  \
	}

static inline float
coded(double v, int codes)
{
	return codes == 0 ? (float)v : (float)(round(v * codes) / codes);
}

static inline void
make_maps(const struct surface *s, const struct maps *m,
    struct bake_image *normal, struct bake_image *relief)
{
	unsigned state = 77;

	*normal = image(s->width, s->height, m->nchans);
	*relief = image(s->width, s->height, 1);
	for (size_t k = 0; k < (size_t)s->width * (size_t)s->height; k++) {
		double n[3] = { -m->scale * (double)s->hx[k],
			-m->scale * (double)s->hy[k], 1 };
		double len = sqrt(n[0] * n[0] + n[1] * n[1] + 1);
		double h = (double)s->h[k];

		if (m->y_down)
			n[1] = -n[1];
		for (int c = 0; c < m->nchans; c++) {
			double v = n[c] / len +
				   m->noise * (2 * random_unit(&state) - 1);

			normal->data[k * (size_t)m->nchans + (size_t)c] =
			    2 * coded(0.5 * (v + 1), m->normal_codes) - 1;
		}
		relief->data[k] = coded(m->depth ? 1 - h : h, m->relief_codes);
	}
}

static inline struct bake_detection
detect(const struct bake_image *normal, const struct bake_image *relief)
{
	struct bake_detection d;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_detect(normal, relief, &d, &err), err);
	return d;
}

static inline struct bake_detection
detect_maps(const struct surface *s, const struct maps *m)
{
	struct bake_image normal, relief;
	struct bake_detection d;

	make_maps(s, m, &normal, &relief);
	d = detect(&normal, &relief);
	bake_image_free(&normal);
	bake_image_free(&relief);
	return d;
}

#define CHECK_UNSURE(d)                                                        \
	do {                                                                   \
		CHECK((d).polarity == BAKE_POLARITY_UNSURE);                   \
		CHECK((d).pair_y == BAKE_NORMAL_Y_UNSURE);                     \
		CHECK((d).normal_y == BAKE_NORMAL_Y_UNSURE);                   \
		CHECK(isnan((d).depth_scale));                                 \
	} while (0)

static inline enum bake_polarity
polarity_of(const struct maps *m)
{
	return m->depth ? BAKE_POLARITY_DEPTH : BAKE_POLARITY_HEIGHT;
}

static inline enum bake_normal_y
y_of(const struct maps *m)
{
	return m->y_down ? BAKE_NORMAL_Y_DOWN : BAKE_NORMAL_Y_UP;
}

/* Nothing that is said contradicts the truth. */
static inline void
check_not_wrong(const struct bake_detection *d, const struct maps *m)
{
	CHECK(d->polarity == BAKE_POLARITY_UNSURE ||
	      d->polarity == polarity_of(m));
	CHECK(d->normal_y == BAKE_NORMAL_Y_UNSURE || d->normal_y == y_of(m));
	CHECK(d->pair_y == BAKE_NORMAL_Y_UNSURE || d->pair_y == y_of(m));
	CHECK(d->curl_y == BAKE_NORMAL_Y_UNSURE || d->curl_y == y_of(m));
}

static inline void
check_right(const struct surface *s, const struct maps *m)
{
	struct bake_detection d = detect_maps(s, m);

	CHECK(d.polarity == polarity_of(m));
	CHECK(d.normal_y == y_of(m));
	CHECK(d.pair_y == y_of(m));
	CHECK(d.curl_y == y_of(m));
	CHECK(d.plausible_normals);
}

#endif
