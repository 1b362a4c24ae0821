/* Colour spaces by tables, for images of codes: as OpenColorIO has it. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "parallel.h"
#include "roughen.h"

enum { PROBES = 4096 };

/* One channel: the light of each code, rising, and the least light that is
 * rounded to a code; start[] finds the code of a light near i / ncells. */
struct curve {
	float *light;    /* [max + 1] */
	float *border;   /* [max + 2], of code 1 .. max; then infinity */
	uint16_t *start; /* [ncells + 1] */
	float low, per_light;
};

struct bake_tones {
	int code_max, ncells;
	float *value; /* [max + 1] code / max */
	struct curve curve[3];
	/* which of them a channel uses: the first where all are alike, which
	 * then stays in the cache */
	int use[3];
};

/* -- making them -----------------------------------------------------------
 */

struct making {
	struct bake_tones *t;
	const struct bake_color *color;
	const char *space;
	struct bake_err *err;
};

/* All codes of a channel as r = g = b, converted. */
static enum bake_status
find_light(const struct making *m)
{
	const struct bake_tones *t = m->t;
	const size_t n = (size_t)t->code_max + 1;
	struct bake_image img = BAKE_IMAGE_INIT;
	enum bake_status rc =
	    bake_image_alloc(&img, t->code_max + 1, 1, 3, m->err);

	if (rc != BAKE_OK)
		return rc;
	for (size_t i = 0; i < 3 * n; i++)
		img.data[i] = t->value[i / 3];
	rc = bake_color_to_linear(m->color, m->space, &img, 1, m->err);
	for (size_t i = 0; rc == BAKE_OK && i < 3 * n; i++)
		t->curve[i % 3].light[i / 3] = img.data[i];
	bake_image_free(&img);
	return rc;
}

static bool
is_rising(const struct curve *c, int max)
{
	for (int i = 0; i < max; i++)
		if (!(c->light[i] < c->light[i + 1]))
			return false;
	return isfinite(c->light[0]) && isfinite(c->light[max]);
}

/* The code that a value is written as, see codes.h. */
static int
code_of(float value, int max)
{
	const double v = (double)value * max + 0.5;

	return v >= 0 ? (v < max + 1.0 ? (int)v : max) : 0;
}

/* Halve the interval of every border at once: a is encoded below the code, b
 * is not. False where no float is between any two. */
static bool
halve(const struct bake_tones *t, const float *a, const float *b,
    struct bake_image *mid)
{
	bool open = false;

	for (size_t i = 0; i < 3 * (size_t)t->code_max; i++) {
		mid->data[i] = a[i] + (b[i] - a[i]) / 2;
		open |= mid->data[i] > a[i] && mid->data[i] < b[i];
	}
	return open;
}

static enum bake_status
bisect(const struct making *m, float *a, float *b)
{
	const struct bake_tones *t = m->t;
	struct bake_image mid = BAKE_IMAGE_INIT, enc = BAKE_IMAGE_INIT;
	enum bake_status rc;

	rc = bake_image_alloc(&mid, t->code_max, 1, 3, m->err);
	if (rc == BAKE_OK)
		rc = bake_image_alloc(&enc, t->code_max, 1, 3, m->err);
	/* between two codes are fewer than 2^32 floats */
	for (int k = 0; k < 40 && rc == BAKE_OK && halve(t, a, b, &mid); k++) {
		memcpy(enc.data, mid.data,
		    3 * (size_t)t->code_max * sizeof(float));
		rc =
		    bake_color_from_linear(m->color, m->space, &enc, 1, m->err);
		for (size_t i = 0; i < 3 * (size_t)t->code_max; i++) {
			const bool below = code_of(enc.data[i], t->code_max) <
					   (int)(i / 3) + 1;

			if (below && mid.data[i] > a[i])
				a[i] = mid.data[i];
			else if (!below && mid.data[i] < b[i])
				b[i] = mid.data[i];
		}
	}
	bake_image_free(&mid);
	bake_image_free(&enc);
	return rc;
}

static enum bake_status
find_borders(const struct making *m)
{
	struct bake_tones *t = m->t;
	const size_t n = 3 * (size_t)t->code_max;
	float *a = bake_alloc(n, sizeof *a, m->err);
	float *b = bake_alloc(n, sizeof *b, m->err);
	enum bake_status rc = BAKE_ENOMEM;

	if (a == NULL || b == NULL)
		goto out;
	for (size_t i = 0; i < n; i++) {
		a[i] = t->curve[i % 3].light[i / 3];
		b[i] = t->curve[i % 3].light[i / 3 + 1];
	}
	rc = bisect(m, a, b);
	for (size_t i = 0; i < n; i++)
		t->curve[i % 3].border[i / 3 + 1] = b[i];
out:
	free(a);
	free(b);
	return rc;
}

static inline int
cell_of(const struct curve *c, int ncells, float light)
{
	const float at = (light - c->low) * c->per_light;

	return at > 0 ? (at < (float)ncells ? (int)at : ncells) : 0;
}

static void
fill_starts(const struct bake_tones *t, struct curve *c)
{
	int code = 0;

	c->low = c->light[0];
	c->per_light = (float)t->ncells / (c->light[t->code_max] - c->low);
	c->border[0] = -INFINITY;
	c->border[t->code_max + 1] = INFINITY;
	/* a cell starts at the code below the first border in it */
	for (int i = 0; i <= t->ncells; i++) {
		while (code < t->code_max &&
		       cell_of(c, t->ncells, c->border[code + 1]) < i)
			code++;
		c->start[i] = (uint16_t)code;
	}
}

/* -- using them ------------------------------------------------------------
 */

static inline float
encoded(const struct bake_tones *t, const struct curve *c, float light)
{
	int code = c->start[cell_of(c, t->ncells, light)];

	while (light >= c->border[code + 1])
		code++;
	return t->value[code];
}

/* The value of a code, which a float's rounding does not leave. */
static inline float
decoded(const struct bake_tones *t, const struct curve *c, float value)
{
	const float at = value * (float)t->code_max + 0.5f;

	return c
	    ->light[at > 0 ? (at < (float)t->code_max ? (int)at : t->code_max)
			   : 0];
}

/* The curves of the channels that are converted: *n of them. Grey is the g of
 * r = g = b. */
static void
channel_curves(const struct bake_tones *t, const struct bake_image *img,
    const struct curve *c[3], int *n)
{
	*n = img->nchans < 3 ? 1 : 3;
	for (int k = 0; k < 3; k++)
		c[k] = &t->curve[t->use[*n == 1 ? 1 : k]];
}

void
bake_tones_to_linear(
    const struct bake_tones *tones, struct bake_image *img, int nthreads)
{
	const struct curve *c[3];
	int n;

	channel_curves(tones, img, c, &n);
#pragma omp parallel for num_threads(bake_threads(nthreads)) schedule(static)
	for (int y = 0; y < img->height; y++) {
		float *v = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++, v += img->nchans)
			for (int k = 0; k < n; k++)
				v[k] = decoded(tones, c[k], v[k]);
	}
}

void
bake_tones_from_linear(
    const struct bake_tones *tones, struct bake_image *img, int nthreads)
{
	const struct curve *c[3];
	int n;

	channel_curves(tones, img, c, &n);
#pragma omp parallel for num_threads(bake_threads(nthreads)) schedule(static)
	for (int y = 0; y < img->height; y++) {
		float *v = bake_image_row(img, y);

		for (int x = 0; x < img->width; x++, v += img->nchans)
			for (int k = 0; k < n; k++)
				v[k] = encoded(tones, c[k], v[k]);
	}
}

/* -- trying them out -------------------------------------------------------
 */

/* Colours all over the cube, its corners first. */
static void
fill_probes(struct bake_image *img, int max)
{
	uint32_t state = 12345;

	for (size_t i = 0; i < 3 * (size_t)PROBES; i++) {
		state = state * 1664525u + 1013904223u;
		if (i < 24)
			img->data[i] = (float)(i / 3 >> i % 3 & 1);
		else
			img->data[i] =
			    (float)((state >> 8) % (max + 1u)) / (float)max;
	}
}

static bool
same(const struct bake_image *a, const struct bake_image *b, int code_max)
{
	for (size_t i = 0; i < 3 * (size_t)PROBES; i++)
		if (code_max == 0 ? a->data[i] != b->data[i]
				  : code_of(a->data[i], code_max) !=
					code_of(b->data[i], code_max))
			return false;
	return true;
}

static enum bake_status
try_out(const struct making *m, bool *alike)
{
	struct bake_image ours = BAKE_IMAGE_INIT, theirs = BAKE_IMAGE_INIT;
	enum bake_status rc;

	rc = bake_image_alloc(&ours, PROBES, 1, 3, m->err);
	if (rc == BAKE_OK)
		rc = bake_image_alloc(&theirs, PROBES, 1, 3, m->err);
	if (rc != BAKE_OK)
		goto out;
	fill_probes(&ours, m->t->code_max);
	fill_probes(&theirs, m->t->code_max);
	bake_tones_to_linear(m->t, &ours, 1);
	rc = bake_color_to_linear(m->color, m->space, &theirs, 1, m->err);
	*alike = rc == BAKE_OK && same(&ours, &theirs, 0);
	if (!*alike)
		goto out;
	/* and back, made darker as remapped light is */
	for (size_t i = 24; i < 3 * (size_t)PROBES; i++)
		ours.data[i] *= (float)(i % 97) / 97;
	memcpy(theirs.data, ours.data, 3 * (size_t)PROBES * sizeof(float));
	bake_tones_from_linear(m->t, &ours, 1);
	rc = bake_color_from_linear(m->color, m->space, &theirs, 1, m->err);
	*alike = rc == BAKE_OK && same(&ours, &theirs, m->t->code_max);
out:
	bake_image_free(&ours);
	bake_image_free(&theirs);
	return rc;
}

static enum bake_status
alloc_tones(struct bake_tones **tones, int code_max, struct bake_err *err)
{
	const size_t n = (size_t)code_max + 2;
	struct bake_tones *t = bake_zalloc(1, sizeof *t, err);

	*tones = t;
	if (t == NULL)
		return BAKE_ENOMEM;
	t->code_max = code_max;
	t->ncells = code_max == 255 ? 1 << 14 : 1 << 18;
	t->value = bake_alloc(n, sizeof(float), err);
	for (int k = 0; k < 3; k++) {
		struct curve *c = &t->curve[k];

		c->light = bake_alloc(n, sizeof(float), err);
		c->border = bake_alloc(n, sizeof(float), err);
		c->start =
		    bake_alloc((size_t)t->ncells + 1, sizeof *c->start, err);
		if (c->light == NULL || c->border == NULL || c->start == NULL)
			return BAKE_ENOMEM;
	}
	if (t->value == NULL)
		return BAKE_ENOMEM;
	for (int i = 0; i <= code_max; i++)
		t->value[i] = (float)i / (float)code_max;
	return BAKE_OK;
}

static void
share_curves(struct bake_tones *t)
{
	const size_t size = ((size_t)t->code_max + 1) * sizeof(float);
	bool alike = true;

	for (int k = 1; k < 3; k++)
		alike &=
		    memcmp(t->curve[0].light, t->curve[k].light, size) == 0 &&
		    memcmp(t->curve[0].border + 1, t->curve[k].border + 1,
			size - sizeof(float)) == 0;
	for (int k = 0; k < 3; k++)
		t->use[k] = alike ? 0 : k;
}

enum bake_status
bake_tones_open(struct bake_tones **tones, const struct bake_color *color,
    const char *space, int code_max, struct bake_err *err)
{
	struct making m = { NULL, color, space, err };
	enum bake_status rc = alloc_tones(tones, code_max, err);
	bool alike = true;

	m.t = *tones;
	if (rc == BAKE_OK)
		rc = find_light(&m);
	for (int k = 0; k < 3 && rc == BAKE_OK; k++)
		alike &= is_rising(&m.t->curve[k], code_max);
	if (rc == BAKE_OK && alike)
		rc = find_borders(&m);
	for (int k = 0; k < 3 && rc == BAKE_OK && alike; k++)
		fill_starts(m.t, &m.t->curve[k]);
	if (rc == BAKE_OK && alike)
		share_curves(m.t);
	if (rc == BAKE_OK && alike)
		rc = try_out(&m, &alike);
	if (rc != BAKE_OK || !alike) {
		bake_tones_close(*tones);
		*tones = NULL;
	}
	return rc;
}

void
bake_tones_close(struct bake_tones *tones)
{
	if (tones == NULL)
		return;
	for (int k = 0; k < 3; k++) {
		free(tones->curve[k].light);
		free(tones->curve[k].border);
		free(tones->curve[k].start);
	}
	free(tones->value);
	free(tones);
}
