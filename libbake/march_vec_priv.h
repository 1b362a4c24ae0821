/* Vectors for marching: masks, floors and the bilinear gather. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MARCH_VEC_PRIV_H
#define BAKE_MARCH_VEC_PRIV_H

/* 8 rays on AVX-512 too: wider vectors end later, and their gather is no
 * faster. */
#ifndef BAKE_VEC_256
#define BAKE_VEC_256
#endif
#include <stddef.h>
#include <stdint.h>

#include "vec_priv.h"

/*
 * vec_m holds a truth value for each lane. The same bits in every width:
 *   vec_floor      greatest whole number not above, floats beyond 2^23 and
 *                  infinities themselves
 *   vec_ge         a >= b, false with a NaN
 *   vec_select     m ? a : b
 *   vec_without    a and not b
 *   vec_bits       bit i: lane i
 *   vec_keep       m ? a : 0
 *   vec_bilinear   at (x, y) >= 0 in cells of march_priv.h
 */
#if defined(__AVX2__)
typedef __m256 vec_m;

static inline vec_f
vec_floor(vec_f a)
{
	return _mm256_floor_ps(a);
}

static inline vec_m
vec_ge(vec_f a, vec_f b)
{
	return _mm256_cmp_ps(a, b, _CMP_GE_OQ);
}

static inline vec_m
vec_gt(vec_f a, vec_f b)
{
	return _mm256_cmp_ps(a, b, _CMP_GT_OQ);
}

static inline vec_f
vec_select(vec_m m, vec_f a, vec_f b)
{
	return _mm256_blendv_ps(b, a, m);
}

static inline vec_f
vec_keep(vec_m m, vec_f a)
{
	return _mm256_and_ps(m, a);
}

static inline vec_m
vec_and(vec_m a, vec_m b)
{
	return _mm256_and_ps(a, b);
}

static inline vec_m
vec_either(vec_m a, vec_m b)
{
	return _mm256_or_ps(a, b);
}

static inline vec_m
vec_without(vec_m a, vec_m b)
{
	return _mm256_andnot_ps(b, a);
}

static inline unsigned
vec_bits(vec_m m)
{
	return (unsigned)_mm256_movemask_ps(m);
}

/* Cells a (lanes 0..3) and b (lanes 4..7). */
static inline __m256
vec_two_cells(const float *a, const float *b)
{
	return _mm256_insertf128_ps(
	    _mm256_castps128_ps256(_mm_loadu_ps(a)), _mm_loadu_ps(b), 1);
}

static inline vec_f
vec_bilinear(const float *cells, unsigned stride, vec_f x, vec_f y)
{
	const __m256i i = _mm256_cvttps_epi32(x), j = _mm256_cvttps_epi32(y);
	const vec_f fx = x - _mm256_cvtepi32_ps(i);
	const vec_f fy = y - _mm256_cvtepi32_ps(j);
	uint32_t at[8] __attribute__((aligned(32)));
	__m256 r[4], lo[2], hi[2];
	vec_f left, right;

	_mm256_store_si256((__m256i *)at,
	    _mm256_add_epi32(
		_mm256_mullo_epi32(j, _mm256_set1_epi32((int)stride)), i));
	/* by way of memory: lane by lane out of the register costs more */
	__asm__("" : "+m"(at));
	for (int k = 0; k < 4; k++)
		r[k] = vec_two_cells(
		    cells + 2 * (size_t)at[k], cells + 2 * (size_t)at[k + 4]);
	/* transposed: {c0, c1} in lo, {c2, c3} in hi */
	for (int k = 0; k < 2; k++) {
		lo[k] = _mm256_unpacklo_ps(r[2 * k], r[2 * k + 1]);
		hi[k] = _mm256_unpackhi_ps(r[2 * k], r[2 * k + 1]);
	}
	r[0] = _mm256_shuffle_ps(lo[0], lo[1], 0x44);
	r[1] = _mm256_shuffle_ps(lo[0], lo[1], 0xee);
	r[2] = _mm256_shuffle_ps(hi[0], hi[1], 0x44);
	r[3] = _mm256_shuffle_ps(hi[0], hi[1], 0xee);
	left = r[0] + fy * (r[1] - r[0]);
	right = r[2] + fy * (r[3] - r[2]);
	return left + fx * (right - left);
}

#elif defined(__SSE2__)
typedef __m128 vec_m;

static inline vec_m
vec_ge(vec_f a, vec_f b)
{
	return _mm_cmpge_ps(a, b);
}

static inline vec_m
vec_gt(vec_f a, vec_f b)
{
	return _mm_cmpgt_ps(a, b);
}

static inline vec_f
vec_select(vec_m m, vec_f a, vec_f b)
{
	return _mm_or_ps(_mm_and_ps(m, a), _mm_andnot_ps(m, b));
}

static inline vec_f
vec_keep(vec_m m, vec_f a)
{
	return _mm_and_ps(m, a);
}

static inline vec_m
vec_and(vec_m a, vec_m b)
{
	return _mm_and_ps(a, b);
}

static inline vec_m
vec_either(vec_m a, vec_m b)
{
	return _mm_or_ps(a, b);
}

static inline vec_m
vec_without(vec_m a, vec_m b)
{
	return _mm_andnot_ps(b, a);
}

static inline unsigned
vec_bits(vec_m m)
{
	return (unsigned)_mm_movemask_ps(m);
}

static inline vec_f
vec_floor(vec_f a)
{
	const vec_f whole = _mm_cvtepi32_ps(_mm_cvttps_epi32(a));
	const vec_f down = whole - vec_keep(vec_gt(whole, a), vec_set(1));
	const vec_f size = vec_max(a, vec_set(0) - a);

	/* what has no fraction may not fit in an int */
	return vec_select(vec_gt(vec_set(0x1p23f), size), down, a);
}

static inline vec_f
vec_bilinear(const float *cells, unsigned stride, vec_f x, vec_f y)
{
	const __m128i i = _mm_cvttps_epi32(x), j = _mm_cvttps_epi32(y);
	const vec_f fx = x - _mm_cvtepi32_ps(i), fy = y - _mm_cvtepi32_ps(j);
	uint32_t ii[4] __attribute__((aligned(16)));
	uint32_t jj[4] __attribute__((aligned(16)));
	vec_f r[4], left, right;

	_mm_store_si128((__m128i *)ii, i);
	_mm_store_si128((__m128i *)jj, j);
	for (int k = 0; k < 4; k++)
		r[k] = vec_load(cells + 2 * ((size_t)jj[k] * stride + ii[k]));
	_MM_TRANSPOSE4_PS(r[0], r[1], r[2], r[3]);
	left = r[0] + fy * (r[1] - r[0]);
	right = r[2] + fy * (r[3] - r[2]);
	return left + fx * (right - left);
}

#else /* any other machine */
typedef int32_t vec_m __attribute__((vector_size(16)));

static inline vec_m
vec_ge(vec_f a, vec_f b)
{
	return a >= b;
}

static inline vec_m
vec_gt(vec_f a, vec_f b)
{
	return a > b;
}

static inline vec_f
vec_select(vec_m m, vec_f a, vec_f b)
{
	return (vec_f)((m & (vec_m)a) | (~m & (vec_m)b));
}

static inline vec_f
vec_keep(vec_m m, vec_f a)
{
	return (vec_f)(m & (vec_m)a);
}

static inline vec_m
vec_and(vec_m a, vec_m b)
{
	return a & b;
}

static inline vec_m
vec_either(vec_m a, vec_m b)
{
	return a | b;
}

static inline vec_m
vec_without(vec_m a, vec_m b)
{
	return a & ~b;
}

static inline unsigned
vec_bits(vec_m m)
{
	unsigned bits = 0;

	for (int i = 0; i < VEC_LANES; i++)
		bits |= (unsigned)(m[i] & 1) << i;
	return bits;
}

static inline vec_f
vec_floor(vec_f a)
{
	vec_f v;

	for (int i = 0; i < VEC_LANES; i++)
		v[i] = floorf(a[i]);
	return v;
}

static inline vec_f
vec_bilinear(const float *cells, unsigned stride, vec_f x, vec_f y)
{
	vec_f d;

	for (int k = 0; k < VEC_LANES; k++) {
		const unsigned i = (unsigned)x[k], j = (unsigned)y[k];
		const float fx = x[k] - (float)i, fy = y[k] - (float)j;
		const float *c = cells + 2 * ((size_t)j * stride + i);
		const float left = c[0] + fy * (c[1] - c[0]);
		const float right = c[2] + fy * (c[3] - c[2]);

		d[k] = left + fx * (right - left);
	}
	return d;
}
#endif

#endif
