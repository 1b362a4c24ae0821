/* Angles and gradients of many corners, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#include "isa.h"
#include "mesh_frame_priv.h"
#include "vecd_priv.h"

/* v where m, else 0 */
static inline vec_d
keep(vec_mask m, vec_d v)
{
	return (vec_d)((vec_mask)v & m);
}

static inline vec_d
larger(vec_d a, vec_d b)
{
	return vecd_choose((vec_mask)(a > b), a, b);
}

static inline vec_d
dot(const vec_d a[3], const vec_d b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* atan(t) of each lane, 0 <= t <= 1, as bake_angle_rad takes it: there is why
 */
static inline vec_d
atan_unit(vec_d t)
{
	const vec_d one = vecd_set(1.0);
	vec_d x, xx, even, odd;

	t = t / (one + vecd_sqrt(one + t * t));
	t = t / (one + vecd_sqrt(one + t * t));
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
gradients(struct frame_batch *b, int l, const vec_d e[3], const vec_d f[3],
    vec_mask has_area)
{
	vec_d es = vecd_load(&b->uv_e[0][l]), et = vecd_load(&b->uv_e[1][l]);
	vec_d fs = vecd_load(&b->uv_f[0][l]), ft = vecd_load(&b->uv_f[1][l]);
	vec_d det = es * ft - fs * et;
	vec_d size = (es * es + et * et) * (fs * fs + ft * ft);
	vec_d scale = 1.0 / det, ps[3], pt[3], sum;
	vec_mask has_uv_area = (vec_mask)(det * det > FLAT * FLAT * size);
	vec_mask good = has_uv_area &
			(vec_mask)(size < vecd_set((double)INFINITY)) &
			has_area;

	vecd_store(&b->flat_uv[l], keep(~has_uv_area, vecd_set(1.0)));
	for (int k = 0; k < 3; k++) {
		ps[k] = (e[k] * ft - f[k] * et) * scale;
		pt[k] = (f[k] * es - e[k] * fs) * scale;
	}
	sum = dot(ps, ps) + dot(pt, pt);
	good &= (vec_mask)(sum < vecd_set((double)INFINITY));
	for (int k = 0; k < 3; k++) {
		vecd_store(&b->ps[k][l], keep(good, ps[k]));
		vecd_store(&b->pt[k][l], keep(good, pt[k]));
	}
	vecd_store(
	    &b->side[l], keep(good, vecd_choose((vec_mask)(det > vecd_set(0.0)),
					vecd_set(1.0), vecd_set(-1.0))));
}

static inline void
corners(struct frame_batch *b, int l)
{
	vec_d e[3], f[3], n[3], ee, ff, ef, area, area2, longest, t, angle, w;
	vec_mask good, obtuse;

	for (int k = 0; k < 3; k++) {
		e[k] = vecd_load(&b->e[k][l]);
		f[k] = vecd_load(&b->f[k][l]);
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
	good = (vec_mask)(area2 > FLAT * FLAT * longest * longest) &
	       (vec_mask)(area2 < vecd_set((double)INFINITY));
	area = vecd_sqrt(area2);
	gradients(b, l, e, f, good);
	/* tan(angle / 2) = sin / (1 + cos), of the acute angle; ee ff is no
	 * smaller than area2, which has not underflowed */
	t = vecd_sqrt(ee * ff);
	obtuse = (vec_mask)(ef < vecd_set(0.0));
	angle = 2.0 * atan_unit(area / (t + vecd_choose(obtuse, -ef, ef)));
	angle = keep(good, vecd_choose(obtuse, BAKE_FRAME_PI - angle, angle));
	if (b->weight == BAKE_WEIGHT_AREA)
		w = vecd_set(1.0);
	else if (b->weight == BAKE_WEIGHT_SPHERE)
		w = 1.0 / (ee * ff);
	else
		w = angle / area;
	vecd_store(&b->angle[l], angle);
	for (int k = 0; k < 3; k++)
		vecd_store(&b->wn[k][l], keep(good, n[k] * w));
}

void
BAKE_KERNEL(bake_frame_corners)(struct frame_batch *b, int n)
{
	for (int l = 0; l < n; l += VECD_LANES)
		corners(b, l);
}
