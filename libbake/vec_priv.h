/* Float vectors of the instruction set a kernel is compiled for. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_VEC_PRIV_H
#define BAKE_VEC_PRIV_H

/*
 * struct-free thin names over the compiler's vectors: + - * / work lane by
 * lane on vec_f; what the C dialect lacks for vectors (maximum, square root,
 * comparison) is named here. All operations are IEEE single precision
 * and give the same bits in every width. vec_max(a, b) is a > b ? a : b, so
 * that a NaN in a is dropped and -0 against 0 yields b.
 *
 * vec_unzip parts e0 o0 e1 o1 ..., which begins in a and ends in b, into e and
 * o; vec_zip puts it together again. vec_spread loads p0 p0 p0 p0 p1 ...
 */
#if defined(__AVX512F__) && !defined(BAKE_VEC_256)
#include <immintrin.h>
enum { VEC_LANES = 16 };
typedef __m512 vec_f;

static inline vec_f
vec_load(const float *p)
{
	return _mm512_loadu_ps(p);
}

static inline void
vec_store(float *p, vec_f v)
{
	_mm512_storeu_ps(p, v);
}

static inline vec_f
vec_set(float x)
{
	return _mm512_set1_ps(x);
}

static inline vec_f
vec_max(vec_f a, vec_f b)
{
	return _mm512_max_ps(a, b);
}

static inline vec_f
vec_min(vec_f a, vec_f b)
{
	return _mm512_min_ps(a, b);
}

static inline vec_f
vec_sqrt(vec_f a)
{
	return _mm512_sqrt_ps(a);
}

/* bit i: lane i of a is greater than that of b */
static inline unsigned
vec_gt_mask(vec_f a, vec_f b)
{
	return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ);
}

static inline float
vec_lowest(vec_f a)
{
	return _mm512_reduce_min_ps(a);
}

static inline vec_f
vec_spread(const float *p)
{
	return _mm512_permutexvar_ps(
	    _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3),
	    _mm512_castps128_ps512(_mm_loadu_ps(p)));
}

static inline void
vec_unzip(vec_f a, vec_f b, vec_f *even, vec_f *odd)
{
	const __m512i e = _mm512_setr_epi32(
	    0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
	const __m512i o = _mm512_setr_epi32(
	    1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);

	*even = _mm512_permutex2var_ps(a, e, b);
	*odd = _mm512_permutex2var_ps(a, o, b);
}

static inline void
vec_zip(vec_f even, vec_f odd, vec_f *a, vec_f *b)
{
	const __m512i lo = _mm512_setr_epi32(
	    0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
	const __m512i hi = _mm512_setr_epi32(
	    8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);

	*a = _mm512_permutex2var_ps(even, lo, odd);
	*b = _mm512_permutex2var_ps(even, hi, odd);
}

#elif defined(__AVX2__)
#include <immintrin.h>
enum { VEC_LANES = 8 };
typedef __m256 vec_f;

static inline vec_f
vec_load(const float *p)
{
	return _mm256_loadu_ps(p);
}

static inline void
vec_store(float *p, vec_f v)
{
	_mm256_storeu_ps(p, v);
}

static inline vec_f
vec_set(float x)
{
	return _mm256_set1_ps(x);
}

static inline vec_f
vec_max(vec_f a, vec_f b)
{
	return _mm256_max_ps(a, b);
}

static inline vec_f
vec_min(vec_f a, vec_f b)
{
	return _mm256_min_ps(a, b);
}

static inline vec_f
vec_sqrt(vec_f a)
{
	return _mm256_sqrt_ps(a);
}

static inline unsigned
vec_gt_mask(vec_f a, vec_f b)
{
	return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_GT_OQ));
}

static inline float
vec_lowest(vec_f a)
{
	__m128 m =
	    _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));

	m = _mm_min_ps(m, _mm_movehl_ps(m, m));
	return _mm_cvtss_f32(_mm_min_ss(m, _mm_shuffle_ps(m, m, 1)));
}

static inline vec_f
vec_spread(const float *p)
{
	return _mm256_insertf128_ps(
	    _mm256_castps128_ps256(_mm_set1_ps(p[0])), _mm_set1_ps(p[1]), 1);
}

static inline vec_f
vec_middle_swapped(vec_f a)
{
	return _mm256_castpd_ps(
	    _mm256_permute4x64_pd(_mm256_castps_pd(a), 0xd8));
}

static inline void
vec_unzip(vec_f a, vec_f b, vec_f *even, vec_f *odd)
{
	*even = vec_middle_swapped(_mm256_shuffle_ps(a, b, 0x88));
	*odd = vec_middle_swapped(_mm256_shuffle_ps(a, b, 0xdd));
}

static inline void
vec_zip(vec_f even, vec_f odd, vec_f *a, vec_f *b)
{
	const vec_f e = vec_middle_swapped(even), o = vec_middle_swapped(odd);

	*a = _mm256_unpacklo_ps(e, o);
	*b = _mm256_unpackhi_ps(e, o);
}

#elif defined(__SSE2__)
#include <emmintrin.h>
enum { VEC_LANES = 4 };
typedef __m128 vec_f;

static inline vec_f
vec_load(const float *p)
{
	return _mm_loadu_ps(p);
}

static inline void
vec_store(float *p, vec_f v)
{
	_mm_storeu_ps(p, v);
}

static inline vec_f
vec_set(float x)
{
	return _mm_set1_ps(x);
}

static inline vec_f
vec_max(vec_f a, vec_f b)
{
	return _mm_max_ps(a, b);
}

static inline vec_f
vec_min(vec_f a, vec_f b)
{
	return _mm_min_ps(a, b);
}

static inline vec_f
vec_sqrt(vec_f a)
{
	return _mm_sqrt_ps(a);
}

static inline unsigned
vec_gt_mask(vec_f a, vec_f b)
{
	return (unsigned)_mm_movemask_ps(_mm_cmpgt_ps(a, b));
}

static inline float
vec_lowest(vec_f a)
{
	a = _mm_min_ps(a, _mm_movehl_ps(a, a));
	return _mm_cvtss_f32(_mm_min_ss(a, _mm_shuffle_ps(a, a, 1)));
}

static inline vec_f
vec_spread(const float *p)
{
	return _mm_set1_ps(p[0]);
}

static inline void
vec_unzip(vec_f a, vec_f b, vec_f *even, vec_f *odd)
{
	*even = _mm_shuffle_ps(a, b, 0x88);
	*odd = _mm_shuffle_ps(a, b, 0xdd);
}

static inline void
vec_zip(vec_f even, vec_f odd, vec_f *a, vec_f *b)
{
	*a = _mm_unpacklo_ps(even, odd);
	*b = _mm_unpackhi_ps(even, odd);
}

#else /* any other machine: four lanes, which compilers turn into NEON */
#include <math.h>
#include <string.h>
enum { VEC_LANES = 4 };
typedef float vec_f __attribute__((vector_size(16)));

static inline vec_f
vec_load(const float *p)
{
	vec_f v;

	memcpy(&v, p, sizeof v);
	return v;
}

static inline void
vec_store(float *p, vec_f v)
{
	memcpy(p, &v, sizeof v);
}

static inline vec_f
vec_set(float x)
{
	return (vec_f){ x, x, x, x };
}

static inline vec_f
vec_max(vec_f a, vec_f b)
{
	vec_f v;

	for (int i = 0; i < VEC_LANES; i++)
		v[i] = a[i] > b[i] ? a[i] : b[i];
	return v;
}

static inline vec_f
vec_min(vec_f a, vec_f b)
{
	vec_f v;

	for (int i = 0; i < VEC_LANES; i++)
		v[i] = a[i] < b[i] ? a[i] : b[i];
	return v;
}

static inline vec_f
vec_sqrt(vec_f a)
{
	vec_f v;

	for (int i = 0; i < VEC_LANES; i++)
		v[i] = sqrtf(a[i]);
	return v;
}

static inline unsigned
vec_gt_mask(vec_f a, vec_f b)
{
	unsigned mask = 0;

	for (int i = 0; i < VEC_LANES; i++)
		mask |= (unsigned)(a[i] > b[i]) << i;
	return mask;
}

static inline float
vec_lowest(vec_f a)
{
	float low = a[0];

	for (int i = 1; i < VEC_LANES; i++)
		low = a[i] < low ? a[i] : low;
	return low;
}

static inline vec_f
vec_spread(const float *p)
{
	return vec_set(p[0]);
}

static inline void
vec_unzip(vec_f a, vec_f b, vec_f *even, vec_f *odd)
{
	for (int i = 0; i < VEC_LANES; i++) {
		const int k = 2 * i;

		(*even)[i] = k < VEC_LANES ? a[k] : b[k - VEC_LANES];
		(*odd)[i] = k < VEC_LANES ? a[k + 1] : b[k + 1 - VEC_LANES];
	}
}

static inline void
vec_zip(vec_f even, vec_f odd, vec_f *a, vec_f *b)
{
	for (int i = 0; i < VEC_LANES; i++) {
		(*a)[i] = i % 2 ? odd[i / 2] : even[i / 2];
		(*b)[i] = i % 2 ? odd[(VEC_LANES + i) / 2]
				: even[(VEC_LANES + i) / 2];
	}
}
#endif

#endif
