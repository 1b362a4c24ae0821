/* Double vectors of the instruction set a kernel is compiled for. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_VECD_PRIV_H
#define BAKE_VECD_PRIV_H

/*
 * As vec_priv.h has floats: + - * / and comparisons work lane by lane on the
 * compiler's own vectors, IEEE double precision, the same bits in every width.
 * vecd_min(a, b) is a < b ? a : b, so b where either is NaN.
 */
#include <math.h>
#include <string.h>

#if defined(__AVX512F__)
#include <immintrin.h>
enum { VECD_LANES = 8 };
#elif defined(__AVX2__)
#include <immintrin.h>
enum { VECD_LANES = 4 };
#else /* any machine: two lanes, which compilers turn into SSE2 or NEON */
enum { VECD_LANES = 2 };
#endif

typedef double vec_d __attribute__((vector_size(8 * VECD_LANES)));
/* -1 or 0 in each lane */
typedef long long vec_mask __attribute__((vector_size(8 * VECD_LANES)));

static inline vec_d
vecd_load(const double *p)
{
	vec_d v;

	memcpy(&v, p, sizeof v);
	return v;
}

static inline void
vecd_store(double *p, vec_d v)
{
	memcpy(p, &v, sizeof v);
}

static inline vec_d
vecd_set(double x)
{
	vec_d v;

	for (int i = 0; i < VECD_LANES; i++)
		v[i] = x;
	return v;
}

static inline vec_d
vecd_sqrt(vec_d v)
{
#if defined(__AVX512F__)
	return (vec_d)_mm512_sqrt_pd((__m512d)v);
#elif defined(__AVX2__)
	return (vec_d)_mm256_sqrt_pd((__m256d)v);
#else
	return (vec_d){ sqrt(v[0]), sqrt(v[1]) };
#endif
}

/* a where m, else b */
static inline vec_d
vecd_choose(vec_mask m, vec_d a, vec_d b)
{
	return (vec_d)(((vec_mask)a & m) | ((vec_mask)b & ~m));
}

static inline vec_d
vecd_min(vec_d a, vec_d b)
{
#if defined(__AVX512F__)
	return (vec_d)_mm512_min_pd((__m512d)a, (__m512d)b);
#elif defined(__AVX2__)
	return (vec_d)_mm256_min_pd((__m256d)a, (__m256d)b);
#else
	return vecd_choose((vec_mask)(a < b), a, b);
#endif
}

#endif
