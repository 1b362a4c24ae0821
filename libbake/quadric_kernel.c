/* Least-squares quadrics of a batch of vertices, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#include "isa.h"
#include "quadric_priv.h"
#include "vecd_priv.h"

/* Monomials x^(d-j) y^j, of degree d from 1, one degree after the other. */
#define MONOMIAL(d, j) ((d) * ((d) + 1) / 2 - 1 + (j))
enum { NMONOMIALS = MONOMIAL(6, 6) + 1 };

/* Degree and power of y of each term, by degree: the terms of FULL are a
 * head of the list. */
static const int degree[9] = { 1, 1, 2, 2, 2, 3, 3, 3, 3 };
static const int power[9] = { 0, 1, 0, 1, 2, 0, 1, 2, 3 };
enum { TERM_X, TERM_Y, TERM_XX, TERM_XY, TERM_YY };
static const int term_ab[2] = { TERM_XX, TERM_YY };
static const int term_full[9] = { 0, 1, 2, 3, 4, 5, 6, 7, 8 };

/* The sums that the normal equations are made of: of monomials up to twice the
 * order, and of z times the terms. */
struct sums {
	vec_d mono[NMONOMIALS];
	vec_d rhs[9];
};

/* Neighbour k of the lanes from l on, turned into the frame. */
static inline void
turn(struct bake_quadric_batch *b, int k, int l, vec_d *x, vec_d *y, vec_d *z)
{
	size_t at = (size_t)k * BAKE_QUADRIC_LANES + (size_t)l;
	vec_d dx = vecd_load(b->x + at), dy = vecd_load(b->y + at),
	      dz = vecd_load(b->z + at);

	*x = vecd_load(&b->frame[0][l]) * dx + vecd_load(&b->frame[1][l]) * dy +
	     vecd_load(&b->frame[2][l]) * dz;
	*y = vecd_load(&b->frame[3][l]) * dx + vecd_load(&b->frame[4][l]) * dy +
	     vecd_load(&b->frame[5][l]) * dz;
	*z = vecd_load(&b->frame[6][l]) * dx + vecd_load(&b->frame[7][l]) * dy +
	     vecd_load(&b->frame[8][l]) * dz;
	vecd_store(b->x + at, *x);
	vecd_store(b->y + at, *y);
	vecd_store(b->z + at, *z);
}

/* The sums of order 2. They live in registers: no loop over them. */
static void
sum_quadratic(struct bake_quadric_batch *b, int l, struct sums *s)
{
	const vec_d zero = vecd_set(0);
	vec_d xx = zero, xy = zero, yy = zero;
	vec_d x3 = zero, x2y = zero, xy2 = zero, y3 = zero;
	vec_d x4 = zero, x3y = zero, x2y2 = zero, xy3 = zero, y4 = zero;
	vec_d zx = zero, zy = zero, zxx = zero, zxy = zero, zyy = zero;

	for (int k = 0; k < b->n; k++) {
		vec_d x, y, z, p, q, r;

		turn(b, k, l, &x, &y, &z);
		p = x * x;
		q = x * y;
		r = y * y;
		xx += p;
		xy += q;
		yy += r;
		x3 += x * p;
		x2y += y * p;
		xy2 += x * r;
		y3 += y * r;
		x4 += p * p;
		x3y += p * q;
		x2y2 += p * r;
		xy3 += q * r;
		y4 += r * r;
		zx += z * x;
		zy += z * y;
		zxx += z * p;
		zxy += z * q;
		zyy += z * r;
	}
	s->mono[MONOMIAL(2, 0)] = xx;
	s->mono[MONOMIAL(2, 1)] = xy;
	s->mono[MONOMIAL(2, 2)] = yy;
	s->mono[MONOMIAL(3, 0)] = x3;
	s->mono[MONOMIAL(3, 1)] = x2y;
	s->mono[MONOMIAL(3, 2)] = xy2;
	s->mono[MONOMIAL(3, 3)] = y3;
	s->mono[MONOMIAL(4, 0)] = x4;
	s->mono[MONOMIAL(4, 1)] = x3y;
	s->mono[MONOMIAL(4, 2)] = x2y2;
	s->mono[MONOMIAL(4, 3)] = xy3;
	s->mono[MONOMIAL(4, 4)] = y4;
	s->rhs[TERM_X] = zx;
	s->rhs[TERM_Y] = zy;
	s->rhs[TERM_XX] = zxx;
	s->rhs[TERM_XY] = zxy;
	s->rhs[TERM_YY] = zyy;
}

/* What order 3 needs beside them. x, y and z are in the frame already. */
static void
sum_cubic(const struct bake_quadric_batch *b, int l, struct sums *s)
{
	const vec_d zero = vecd_set(0);
	vec_d m50 = zero, m41 = zero, m32 = zero, m23 = zero, m14 = zero;
	vec_d m05 = zero, m60 = zero, m51 = zero, m42 = zero, m33 = zero;
	vec_d m24 = zero, m15 = zero, m06 = zero;
	vec_d z30 = zero, z21 = zero, z12 = zero, z03 = zero;

	for (int k = 0; k < b->n; k++) {
		size_t at = (size_t)k * BAKE_QUADRIC_LANES + (size_t)l;
		vec_d x = vecd_load(b->x + at), y = vecd_load(b->y + at);
		vec_d z = vecd_load(b->z + at), xx = x * x, yy = y * y;
		vec_d x3 = x * xx, x2y = y * xx, xy2 = x * yy, y3 = y * yy;

		m50 += xx * x3;
		m41 += xx * x2y;
		m32 += xx * xy2;
		m23 += xx * y3;
		m14 += yy * xy2;
		m05 += yy * y3;
		m60 += x3 * x3;
		m51 += x3 * x2y;
		m42 += x3 * xy2;
		m33 += x3 * y3;
		m24 += x2y * y3;
		m15 += xy2 * y3;
		m06 += y3 * y3;
		z30 += z * x3;
		z21 += z * x2y;
		z12 += z * xy2;
		z03 += z * y3;
	}
	s->mono[MONOMIAL(5, 0)] = m50;
	s->mono[MONOMIAL(5, 1)] = m41;
	s->mono[MONOMIAL(5, 2)] = m32;
	s->mono[MONOMIAL(5, 3)] = m23;
	s->mono[MONOMIAL(5, 4)] = m14;
	s->mono[MONOMIAL(5, 5)] = m05;
	s->mono[MONOMIAL(6, 0)] = m60;
	s->mono[MONOMIAL(6, 1)] = m51;
	s->mono[MONOMIAL(6, 2)] = m42;
	s->mono[MONOMIAL(6, 3)] = m33;
	s->mono[MONOMIAL(6, 4)] = m24;
	s->mono[MONOMIAL(6, 5)] = m15;
	s->mono[MONOMIAL(6, 6)] = m06;
	s->rhs[5] = z30;
	s->rhs[6] = z21;
	s->rhs[7] = z12;
	s->rhs[8] = z03;
}

/*
 * Solve the n normal equations of the given terms as L D L^T, which needs no
 * scaling of the columns: pivots relative to the diagonal, and the solution,
 * do not depend on it. Returns the smallest such ratio.
 */
static inline __attribute__((always_inline)) vec_d
solve(const struct sums *s, const int *term, int n, vec_d coef[9])
{
	vec_d low[9][9], inverse[9], ratio = vecd_set(1);

	for (int j = 0; j < n; j++) {
		int dj = degree[term[j]], pj = power[term[j]];
		vec_d diagonal = s->mono[MONOMIAL(2 * dj, 2 * pj)];
		vec_d pivot = diagonal;

		/* low[i][j] holds L D until its column is done */
		for (int i = 0; i < j; i++) {
			vec_d l = low[j][i] * inverse[i];

			pivot = pivot - l * low[j][i];
			coef[j] = i == 0 ? s->rhs[term[j]] - l * coef[0]
					 : coef[j] - l * coef[i];
		}
		if (j == 0)
			coef[0] = s->rhs[term[0]];
		ratio = vecd_min(pivot / diagonal, ratio);
		inverse[j] = vecd_set(1) / pivot;
		for (int i = j + 1; i < n; i++) {
			int di = degree[term[i]], pi = power[term[i]];
			vec_d v = s->mono[MONOMIAL(di + dj, pi + pj)];

			for (int k = 0; k < j; k++)
				v = v - low[i][k] * (low[j][k] * inverse[k]);
			low[i][j] = v;
		}
	}
	for (int j = n - 1; j >= 0; j--) {
		vec_d v = coef[j];

		for (int i = j + 1; i < n; i++)
			v = v - low[i][j] * coef[i];
		coef[j] = v * inverse[j];
	}
	return ratio;
}

static inline void
write_residual(
    struct bake_quadric_batch *b, int l, const vec_d f[9], bool cubic)
{
	vec_d sum = vecd_set(0);

	for (int k = 0; k < b->n; k++) {
		size_t at = (size_t)k * BAKE_QUADRIC_LANES + (size_t)l;
		vec_d x = vecd_load(b->x + at), y = vecd_load(b->y + at);
		vec_d r = vecd_load(b->z + at);

		r = r - x * (f[TERM_X] + x * f[TERM_XX] + y * f[TERM_XY]) -
		    y * (f[TERM_Y] + y * f[TERM_YY]);
		if (cubic)
			r = r - x * x * (x * f[5] + y * f[6]) -
			    y * y * (x * f[7] + y * f[8]);
		sum += r * r;
	}
	vecd_store(&b->residual2[l], sum);
}

/* From the coefficients in the frame to halved normal curvatures. */
static inline void
write_curvatures(struct bake_quadric_batch *b, int l, const vec_d f[9])
{
	const vec_d one = vecd_set(1);
	vec_d d = one + f[TERM_X] * f[TERM_X], e = one + f[TERM_Y] * f[TERM_Y];
	vec_d g = one / vecd_sqrt(d + f[TERM_Y] * f[TERM_Y]);

	vecd_store(&b->a[l], f[TERM_XX] * g / d);
	vecd_store(&b->b[l], f[TERM_YY] * g / e);
	vecd_store(&b->c[l], f[TERM_XY] * g / vecd_sqrt(d * e));
}

/* The lanes from l on. */
static inline void
fit(struct bake_quadric_batch *b, int l)
{
	struct sums s;
	vec_d f[9], ab[9], ratio;

	sum_quadratic(b, l, &s);
	vecd_store(
	    &b->radius2[l], s.mono[MONOMIAL(2, 0)] + s.mono[MONOMIAL(2, 2)]);
	if (b->nterms == 9) {
		sum_cubic(b, l, &s);
		ratio = solve(&s, term_full, 9, f);
	} else if (b->nterms == 5) {
		ratio = solve(&s, term_full, 5, f);
	} else {
		ratio = solve(&s, term_ab, 2, ab);
		f[TERM_X] = f[TERM_Y] = f[TERM_XY] = vecd_set(0);
		f[TERM_XX] = ab[0];
		f[TERM_YY] = ab[1];
	}
	vecd_store(&b->pivot[l], ratio);
	write_residual(b, l, f, b->nterms == 9);
	write_curvatures(b, l, f);
}

void
BAKE_KERNEL(bake_quadric_solve)(struct bake_quadric_batch *batch)
{
	for (int l = 0; l < BAKE_QUADRIC_LANES; l += VECD_LANES)
		fit(batch, l);
}
