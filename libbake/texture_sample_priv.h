/* What the parts of a texture lookup share: the pyramid, and means. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_TEXTURE_SAMPLE_PRIV_H
#define BAKE_TEXTURE_SAMPLE_PRIV_H

#include "texture_sample.h"

enum { SAMPLER_LEVELS = 32, SAMPLER_CHANS = 4 };

struct sampler_level {
	int width, height;
	int step; /* floats from a texel to the next */
	size_t row_stride;
	const float *data;
};

struct bake_sampler {
	int nvalues;    /* of a lookup */
	bool has_alpha; /* the last of them */
	int nlevels;
	struct sampler_level level[SAMPLER_LEVELS];
	float *memory; /* of all levels but the first */
};

/* Sums of weights, and of values by weights. */
struct sampler_sums {
	double w;
	double wc[SAMPLER_CHANS];
	double wac[SAMPLER_CHANS]; /* the same by alpha, too */
};

static inline void
sampler_add(struct sampler_sums *s, double w, const float *p, int n, bool alpha)
{
	s->w += w;
	for (int c = 0; c < n; c++)
		s->wc[c] += w * p[c];
	if (alpha)
		for (int c = 0; c < n - 1; c++)
			s->wac[c] += w * p[n - 1] * p[c];
}

static inline void
sampler_mean(const struct sampler_sums *s, int n, bool alpha, double *value)
{
	for (int c = 0; c < n; c++)
		value[c] = s->wc[c] / s->w;
	if (alpha && s->wc[n - 1] > 0)
		for (int c = 0; c < n - 1; c++)
			value[c] = s->wac[c] / s->wc[n - 1];
}

#endif
