/* Weights and distances of a triangle's samples, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#include "isa.h"
#include "raster_priv.h"
#include "vec_priv.h"
#include "vecd_priv.h"

typedef float vec_half __attribute__((vector_size(4 * VECD_LANES)));

static inline void
store(float *p, vec_d v)
{
	vec_half f = __builtin_convertvector(v, vec_half);

	memcpy(p, &f, sizeof f);
}

/* p = v by factor, in floats */
static inline void
store_product(float *p, vec_d v, const float *factor)
{
	vec_half f = __builtin_convertvector(v, vec_half), g;

	memcpy(&g, factor, sizeof g);
	f *= g;
	memcpy(p, &f, sizeof f);
}

/* x < lo ? lo : x, and lo where x is NaN */
static inline vec_d
at_least(vec_d x, double lo)
{
	return -vecd_min(-x, vecd_set(-lo));
}

static inline vec_d
linear(const double f[3], vec_d x, double y)
{
	return vecd_set(f[0] + f[2] * y) + vecd_set(f[1]) * x;
}

void
BAKE_KERNEL(bake_raster_rows)(const struct raster_rows *r)
{
	const vec_d one = vecd_set(1);
	vec_d lane;
	size_t n = 0;

	for (int i = 0; i < VECD_LANES; i++)
		lane[i] = i;
	for (int y = r->y0; y <= r->y1; y++) {
		const float *length = r->length + y * BAKE_RASTER_TILE;

		for (int x0 = r->begin[y]; x0 < r->end[y]; x0 += VECD_LANES) {
			size_t at = n + (size_t)(x0 - r->begin[y]);
			vec_d x = vecd_set(x0) + lane;
			vec_d inv = one / linear(r->s, x, y);
			vec_d b1 = linear(r->e1, x, y) * inv;
			vec_d b2 = linear(r->e2, x, y) * inv;
			vec_d w;

			b1 = vecd_min(at_least(b1, 0), one);
			b2 = vecd_min(at_least(b2, 0), one - b1);
			w = vecd_set(r->w0) + b1 * vecd_set(r->w1) +
			    b2 * vecd_set(r->w2);
			store(r->b1 + at, b1);
			store(r->b2 + at, b2);
			store_product(r->distance + at, at_least(w, r->near),
			    length + x0);
		}
		if (r->end[y] > r->begin[y])
			n += (size_t)(r->end[y] - r->begin[y]);
	}
}

void
BAKE_KERNEL(bake_raster_lengths)(float *length, double x, double y, double dx)
{
	float xx[BAKE_RASTER_TILE];

	for (int i = 0; i < BAKE_RASTER_TILE; i++)
		xx[i] = (float)((x + i * dx) * (x + i * dx));
	for (int j = 0; j < BAKE_RASTER_TILE; j++) {
		vec_f yy = vec_set((float)(1 + (y - j * dx) * (y - j * dx)));

		for (int i = 0; i < BAKE_RASTER_TILE; i += VEC_LANES)
			vec_store(length + j * BAKE_RASTER_TILE + i,
			    vec_sqrt(vec_load(xx + i) + yy));
	}
}
