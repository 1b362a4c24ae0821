/* Angles and gradients of many corners, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "isa.h"
#include "mesh_frame_priv.h"

#if defined(__AVX512F__)
#include <immintrin.h>
enum { LANES = 8 };
#elif defined(__AVX2__)
#include <immintrin.h>
enum { LANES = 4 };
#else /* any machine: two lanes, which compilers turn into SSE2 or NEON */
enum { LANES = 2 };
#endif

typedef double vec __attribute__((vector_size(8 * LANES)));
/* -1 or 0 in each lane */
typedef long long mask __attribute__((vector_size(8 * LANES)));

static inline vec
root(vec v)
{
#if defined(__AVX512F__)
	return (vec)_mm512_sqrt_pd((__m512d)v);
#elif defined(__AVX2__)
	return (vec)_mm256_sqrt_pd((__m256d)v);
#else
	return (vec){ sqrt(v[0]), sqrt(v[1]) };
#endif
}

static inline vec
load(const double *p)
{
	vec v;

	memcpy(&v, p, sizeof v);
	return v;
}

static inline void
store(double *p, vec v)
{
	memcpy(p, &v, sizeof v);
}

static inline vec
set(double x)
{
	vec v;

	for (int i = 0; i < LANES; i++)
		v[i] = x;
	return v;
}

/* v where m, else 0 */
static inline vec
keep(mask m, vec v)
{
	return (vec)((mask)v & m);
}

static inline vec
choose(mask m, vec a, vec b)
{
	return (vec)(((mask)a & m) | ((mask)b & ~m));
}

static inline vec
larger(vec a, vec b)
{
	return choose((mask)(a > b), a, b);
}

static inline vec
dot(const vec a[3], const vec b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* atan(t) of each lane, 0 <= t <= 1, as bake_angle_rad takes it: there is why
 */
static inline vec
atan_unit(vec t)
{
	const vec one = set(1.0);
	vec x, xx, even, odd;

	t = t / (one + root(one + t * t));
	t = t / (one + root(one + t * t));
	x = t * t;
	xx = x * x;
	even = 1.0 / 21.0 + xx * (1.0 / 25.0);
	odd = 1.0 / 19.0 + xx * (1.0 / 23.0);
	even = 1.0 / 17.0 + xx * even;
	odd = 1.0 / 15.0 + xx * odd;
	even = 1.0 / 13.0 + xx * even;
	odd = 1.0 / 11.0 + xx * odd;
	even = 1.0 / 9.0 + xx * even;
	odd = 1.0 / 7.0 + xx * odd;
	even = 1.0 / 5.0 + xx * even;
	odd = 1.0 / 3.0 + xx * odd;
	return 4.0 * (t + t * (xx * even - x * odd));
}

/* dP/ds, dP/dt and the sign of det, where the corner has an area. */
static inline void
gradients(
    struct frame_batch *b, int l, const vec e[3], const vec f[3], mask has_area)
{
	vec es = load(&b->uv_e[0][l]), et = load(&b->uv_e[1][l]);
	vec fs = load(&b->uv_f[0][l]), ft = load(&b->uv_f[1][l]);
	vec det = es * ft - fs * et;
	vec size = (es * es + et * et) * (fs * fs + ft * ft);
	vec scale = 1.0 / det, ps[3], pt[3], sum;
	mask good = (mask)(det * det > FLAT * FLAT * size) &
		    (mask)(size < set((double)INFINITY)) & has_area;

	for (int k = 0; k < 3; k++) {
		ps[k] = (e[k] * ft - f[k] * et) * scale;
		pt[k] = (f[k] * es - e[k] * fs) * scale;
	}
	sum = dot(ps, ps) + dot(pt, pt);
	good &= (mask)(sum < set((double)INFINITY));
	for (int k = 0; k < 3; k++) {
		store(&b->ps[k][l], keep(good, ps[k]));
		store(&b->pt[k][l], keep(good, pt[k]));
	}
	store(&b->side[l],
	    keep(good, choose((mask)(det > set(0.0)), set(1.0), set(-1.0))));
}

static inline void
corners(struct frame_batch *b, int l)
{
	vec e[3], f[3], n[3], ee, ff, ef, area, area2, longest, t, angle, w;
	mask good, obtuse;

	for (int k = 0; k < 3; k++) {
		e[k] = load(&b->e[k][l]);
		f[k] = load(&b->f[k][l]);
	}
	n[0] = e[1] * f[2] - e[2] * f[1];
	n[1] = e[2] * f[0] - e[0] * f[2];
	n[2] = e[0] * f[1] - e[1] * f[0];
	area2 = dot(n, n);
	ee = dot(e, e);
	ff = dot(f, f);
	ef = dot(e, f);
	longest = larger(ee + ff - 2.0 * ef, larger(ee, ff));
	/* false for what is not finite, too */
	good = (mask)(area2 > FLAT * FLAT * longest * longest) &
	       (mask)(area2 < set((double)INFINITY));
	area = root(area2);
	gradients(b, l, e, f, good);
	/* tan(angle / 2) = sin / (1 + cos), of the acute angle; ee ff is no
	 * smaller than area2, which has not underflowed */
	t = root(ee * ff);
	obtuse = (mask)(ef < set(0.0));
	angle = 2.0 * atan_unit(area / (t + choose(obtuse, -ef, ef)));
	angle = keep(good, choose(obtuse, BAKE_FRAME_PI - angle, angle));
	if (b->weight == BAKE_WEIGHT_AREA)
		w = set(1.0);
	else if (b->weight == BAKE_WEIGHT_SPHERE)
		w = 1.0 / (ee * ff);
	else
		w = angle / area;
	store(&b->angle[l], angle);
	for (int k = 0; k < 3; k++)
		store(&b->wn[k][l], keep(good, n[k] * w));
}

void
BAKE_KERNEL(bake_frame_corners)(struct frame_batch *b, int n)
{
	for (int l = 0; l < n; l += LANES)
		corners(b, l);
}
