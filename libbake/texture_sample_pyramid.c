/* The pyramid of a texture: every level the mean of the one before. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "mem.h"
#include "parallel.h"
#include "texture_sample_priv.h"

/* Texel x of half the size covers n texels of the whole, from 2 x on. */
static int
half_weights(int size, int x, double w[3])
{
	const int m = size / 2;

	if (size == 1) {
		w[0] = 1;
		return 1;
	}
	if (size % 2 == 0) {
		w[0] = w[1] = 0.5;
		return 2;
	}
	w[0] = (double)(m - x) / size;
	w[1] = (double)m / size;
	w[2] = (double)(x + 1) / size;
	return 3;
}

static void
reduce_row(const struct bake_sampler *s, const struct sampler_level *from,
    int y, int width, float *to)
{
	double wx[3], wy[3], mean[SAMPLER_CHANS];
	const int ny = half_weights(from->height, y, wy);

	for (int x = 0; x < width; x++, to += s->nvalues) {
		const int nx = half_weights(from->width, x, wx);
		struct sampler_sums sums = { 0 };

		for (int j = 0; j < ny; j++) {
			const float *p =
			    from->data +
			    (size_t)(2 * y + j) * from->row_stride +
			    (size_t)(2 * x) * (size_t)from->step;

			for (int i = 0; i < nx; i++, p += from->step)
				sampler_add(&sums, wx[i] * wy[j], p, s->nvalues,
				    s->has_alpha);
		}
		sampler_mean(&sums, s->nvalues, s->has_alpha, mean);
		for (int c = 0; c < s->nvalues; c++)
			to[c] = (float)mean[c];
	}
}

static void
reduce(const struct bake_sampler *s, const struct sampler_level *from,
    const struct sampler_level *to, float *data, int nthreads)
{
#pragma omp parallel for schedule(static) num_threads(nthreads)
	for (int y = 0; y < to->height; y++)
		reduce_row(
		    s, from, y, to->width, data + (size_t)y * to->row_stride);
}

static int
halved(int size)
{
	return size > 1 ? size / 2 : 1;
}

/* The levels' sizes; *total floats are needed beside the first's. */
static bool
lay_out(struct bake_sampler *s, size_t *total)
{
	*total = 0;
	for (s->nlevels = 1;; s->nlevels++) {
		const struct sampler_level *a = &s->level[s->nlevels - 1];
		struct sampler_level *b = &s->level[s->nlevels];
		size_t n;

		if (a->width == 1 && a->height == 1)
			return true;
		b->width = halved(a->width);
		b->height = halved(a->height);
		b->step = s->nvalues;
		if (!bake_mul_size(
			(size_t)b->width, (size_t)b->step, &b->row_stride) ||
		    !bake_mul_size(b->row_stride, (size_t)b->height, &n) ||
		    n > (size_t)-1 - *total)
			return false;
		*total += n;
	}
}

enum bake_status
bake_sampler_open(struct bake_sampler **sampler, const struct bake_image *img,
    bool opaque, int nthreads, struct bake_err *err)
{
	struct bake_sampler *s;
	size_t total;
	float *p;

	*sampler = NULL;
	if (img->width < 1 || img->height < 1 || img->nchans < 1 ||
	    img->nchans > SAMPLER_CHANS)
		return bake_fail(err, BAKE_EINVAL,
		    "a texture of %dx%d texels and %d channels, expected at "
		    "least one texel of 1 to 4 channels",
		    img->width, img->height, img->nchans);
	if ((s = bake_zalloc(1, sizeof *s, err)) == NULL)
		return BAKE_ENOMEM;
	s->has_alpha = !opaque && img->nchans % 2 == 0;
	s->nvalues = img->nchans - (opaque && img->nchans % 2 == 0);
	s->level[0] = (struct sampler_level){ img->width, img->height,
		img->nchans, img->row_stride, img->data };
	if (!lay_out(s, &total)) {
		free(s);
		return bake_fail(err, BAKE_ENOMEM,
		    "the pyramid of a texture of %dx%d texels does not fit in "
		    "memory",
		    img->width, img->height);
	}
	if ((p = s->memory = bake_alloc(total, sizeof *p, err)) == NULL) {
		free(s);
		return BAKE_ENOMEM;
	}
	for (int k = 1; k < s->nlevels; k++) {
		struct sampler_level *to = &s->level[k];

		reduce(s, to - 1, to, p, bake_threads(nthreads));
		to->data = p;
		p += to->row_stride * (size_t)to->height;
	}
	*sampler = s;
	return BAKE_OK;
}

void
bake_sampler_close(struct bake_sampler *s)
{
	if (s == NULL)
		return;
	free(s->memory);
	free(s);
}

int
bake_sampler_nchans(const struct bake_sampler *s)
{
	return s->nvalues;
}
