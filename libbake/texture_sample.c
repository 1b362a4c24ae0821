/* Looking a picture up, filtered over an elliptical footprint. */
/* SPDX-License-Identifier: MIT */
#include "texture_sample.h"

#include <math.h>

#include "texture_sample_priv.h"

/* The half axes, in texels of the level that is read: the shorter one at least,
 * the longer one at most; and the most columns that an ellipse of that length
 * covers, its matrix being at most the square of that and 2 - 2/3 more. */
static const double short_axis = 1.5;
static const double long_axis = 24;
enum { MAX_COLUMNS = 64 };

/* -- positions ----------------------------------------------------------- */

/* floor, without a call where the processor has no instruction for it; |x| is
 * below 2^62 */
static inline long
floor_of(double x)
{
	const long i = (long)x;

	return i - (x < (double)i);
}

/* A coordinate in the first period, or near the border where it is clamped. */
static inline double
fold(double u, enum bake_tex_wrap wrap)
{
	const double far = 1e6, most = 1e15;

	if (!(fabs(u) < most)) /* a period has no position within it there */
		u = wrap == BAKE_TEX_CLAMP && u > 0   ? far
		    : wrap == BAKE_TEX_CLAMP && u < 0 ? -far
						      : 0;
	switch (wrap) {
	case BAKE_TEX_CLAMP:
		return u < -far ? -far : u > far ? far : u;
	case BAKE_TEX_MIRROR:
		return u - 2.0 * (double)floor_of(0.5 * u);
	default:
		return u - (double)floor_of(u);
	}
}

/* n indices from first on, each brought into 0 .. size - 1. */
static inline void
wrap_indices(long first, int n, int size, enum bake_tex_wrap wrap, int *index)
{
	const long period = wrap == BAKE_TEX_MIRROR ? 2L * size : size;
	long i = first;

	if (wrap == BAKE_TEX_CLAMP) {
		for (int k = 0; k < n; k++, i++)
			index[k] = i < 0 ? 0 : i >= size ? size - 1 : (int)i;
		return;
	}
	if (i < 0 || i >= period) {
		i %= period;
		i += i < 0 ? period : 0;
	}
	for (int k = 0; k < n; k++) {
		index[k] = (int)(i < size ? i : period - 1 - i);
		if (++i == period)
			i = 0;
	}
}

/* -- reading ------------------------------------------------------------- */

/* Four texels and the weights of the second column and row. */
struct corners {
	const float *p[4];
	double a, b;
};

/* Plain values: what is constant keeps its bits in this form. */
static inline void
mix_plain(const struct corners *q, int n, double *value)
{
	for (int c = 0; c < n; c++) {
		const double top =
		    q->p[0][c] + q->a * ((double)q->p[1][c] - q->p[0][c]);
		const double low =
		    q->p[2][c] + q->a * ((double)q->p[3][c] - q->p[2][c]);

		value[c] = top + q->b * (low - top);
	}
}

static inline void
mix_alpha(const struct corners *q, int n, double *value)
{
	const double a = q->a, b = q->b;
	const double w[4] = { (1 - a) * (1 - b), a * (1 - b), (1 - a) * b,
		a * b };
	struct sampler_sums sums = { 0 };

	for (int k = 0; k < 4; k++)
		sampler_add(&sums, w[k], q->p[k], n, true);
	sampler_mean(&sums, n, true, value);
}

static inline void
bilinear(const struct bake_sampler *s, const struct bake_lookup *at, double u,
    double v, double *value)
{
	const struct sampler_level *l = &s->level[0];
	const double x = u * l->width - 0.5, y = v * l->height - 0.5;
	const long i = floor_of(x), j = floor_of(y);
	struct corners q = { .a = x - (double)i, .b = y - (double)j };
	int col[2], row[2];

	wrap_indices(i, 2, l->width, at->wrap_u, col);
	wrap_indices(j, 2, l->height, at->wrap_v, row);
	for (int k = 0; k < 4; k++)
		q.p[k] = l->data + (size_t)row[k >> 1] * l->row_stride +
			 (size_t)col[k & 1] * (size_t)l->step;
	if (s->nvalues == 3)
		mix_plain(&q, 3, value);
	else if (s->nvalues == 4)
		mix_alpha(&q, 4, value);
	else if (s->has_alpha)
		mix_alpha(&q, 2, value);
	else
		mix_plain(&q, 1, value);
}

/* A symmetric matrix (xx xy; xy yy). */
struct form {
	double xx, xy, yy;
};

/* The larger eigenvalue. */
static inline double
larger_eigenvalue(const struct form *m)
{
	const double half = 0.5 * (m->xx - m->yy);

	return 0.5 * (m->xx + m->yy) + sqrt(half * half + m->xy * m->xy);
}

/* Raise the smaller eigenvalue to least; big is the larger one. */
static inline void
widen(struct form *m, double least)
{
	const double big = larger_eigenvalue(m);
	const double small = m->xx + m->yy - big;
	double t;

	if (small >= least)
		return;
	if (!(big > least)) {
		*m = (struct form){ least, 0, least };
		return;
	}
	/* e e^T of its eigenvector = (big I - M) / (big - small) */
	t = (least - small) / (big - small);
	m->xx += t * (big - m->xx);
	m->yy += t * (big - m->yy);
	m->xy -= t * m->xy;
}

/*
 * An ellipse on a level, in the columns and rows of its box: q = ax + dy bx +
 * cy. first is the box's column 0.
 */
struct ellipse {
	double a, b, c, x;
	long first;
	int ncols, nrows;
	double ax[MAX_COLUMNS], bx[MAX_COLUMNS];
	size_t col[MAX_COLUMNS]; /* floats from a row's begin */
	int row[MAX_COLUMNS];
	double dy[MAX_COLUMNS];
};

static inline void
ellipse_place(struct ellipse *e, const struct sampler_level *l,
    const struct bake_lookup *at, double u, double v, const struct form *m)
{
	const double x = u * l->width - 0.5, y = v * l->height - 0.5;
	const double det = m->xx * m->yy - m->xy * m->xy;
	const double reach_x = sqrt(m->xx), reach_y = sqrt(m->yy);
	const long i0 = floor_of(x - reach_x) + 1;
	const long j0 = floor_of(y - reach_y) + 1;
	int index[MAX_COLUMNS];

	e->a = m->yy / det;
	e->b = -m->xy / det;
	e->c = m->xx / det;
	e->first = i0;
	e->ncols = (int)(floor_of(x + reach_x) - i0) + 1;
	e->nrows = (int)(floor_of(y + reach_y) - j0) + 1;
	e->x = x;
	wrap_indices(i0, e->ncols, l->width, at->wrap_u, index);
	wrap_indices(j0, e->nrows, l->height, at->wrap_v, e->row);
	for (int i = 0; i < e->ncols; i++) {
		const double dx = (double)(i0 + i) - x;

		e->ax[i] = e->a * dx * dx;
		e->bx[i] = 2 * e->b * dx;
		e->col[i] = (size_t)index[i] * (size_t)l->step;
	}
	for (int j = 0; j < e->nrows; j++)
		e->dy[j] = (double)(j0 + j) - y;
}

/* The columns of a row that are within; in a small box all, which is faster
 * than to know. */
static inline void
ellipse_span(const struct ellipse *e, double dy, int *first, int *last)
{
	enum { FEW = 8 };
	double by, d, root;
	long i, k;

	*first = 0;
	*last = e->ncols - 1;
	if (e->ncols <= FEW)
		return;
	by = e->b * dy;
	d = by * by - e->a * (e->c * dy * dy - 1);
	if (!(d > 0)) {
		*last = -1;
		return;
	}
	root = sqrt(d);
	i = floor_of(e->x - (by + root) / e->a) + 1 - e->first;
	k = floor_of(e->x + (root - by) / e->a) - e->first;
	*first = i > 0 ? (int)i : 0;
	*last = k < *last ? (int)k : *last;
}

/* The mean over the ellipse of m around (u, v). n and alpha are the sampler's,
 * given by the caller as constants where they are the usual ones. */
static inline void
ellipse_mean(const struct sampler_level *l, const struct bake_lookup *at,
    double u, double v, const struct form *m, int n, bool alpha, double *value)
{
	struct ellipse e;
	struct sampler_sums sums = { 0 };

	ellipse_place(&e, l, at, u, v, m);
	for (int j = 0; j < e.nrows; j++) {
		const double dy = e.dy[j], cy = 1 - e.c * dy * dy;
		const float *p = l->data + (size_t)e.row[j] * l->row_stride;
		int i, last;

		ellipse_span(&e, dy, &i, &last);
		for (; i <= last; i++) {
			double t = cy - (e.ax[i] + dy * e.bx[i]);

			t = t > 0 ? t : 0;
			sampler_add(&sums, t * t, p + e.col[i], n, alpha);
		}
	}
	sampler_mean(&sums, n, alpha, value);
}

/* The level for an ellipse with half axes whose squares these are. */
static int
level_of(const struct bake_sampler *s, double big, double small)
{
	double size2 = 1;
	int k = 0;

	while (k < s->nlevels - 1 &&
	       (small >= 4 * size2 * short_axis * short_axis ||
		   !(big < size2 * long_axis * long_axis))) {
		size2 *= 4;
		k++;
	}
	return k;
}

/* big is the larger eigenvalue of p = J J^T. */
static void
filtered(const struct bake_sampler *s, const struct bake_lookup *at, double u,
    double v, const struct form *p, double big, double *value)
{
	const struct sampler_level *top = &s->level[0];
	const double det = p->xx * p->yy - p->xy * p->xy;
	const struct sampler_level *l =
	    &s->level[level_of(s, big, det > 0 ? det / big : 0)];
	const double sx = (double)top->width / l->width;
	const double sy = (double)top->height / l->height;
	struct form m = { (p->xx + 2) / (sx * sx) - 2.0 / 3, p->xy / (sx * sy),
		(p->yy + 2) / (sy * sy) - 2.0 / 3 };

	if (l->width == 1 && l->height == 1) {
		for (int c = 0; c < s->nvalues; c++)
			value[c] = l->data[c];
		return;
	}
	if (l->width == 1 || l->height == 1)
		m.xy = 0;
	if (l->width == 1) {
		m.xx = 4.0 / 3;
		u = 0.5;
	}
	if (l->height == 1) {
		m.yy = 4.0 / 3;
		v = 0.5;
	}
	widen(&m, 4.0 / 3);
	if (s->nvalues == 3)
		ellipse_mean(l, at, u, v, &m, 3, false, value);
	else if (s->nvalues == 4)
		ellipse_mean(l, at, u, v, &m, 4, true, value);
	else
		ellipse_mean(l, at, u, v, &m, s->nvalues, s->has_alpha, value);
}

void
bake_sampler_read(
    const struct bake_sampler *s, const struct bake_lookup *at, float *value)
{
	const struct sampler_level *top = &s->level[0];
	const double xx = at->u_x * top->width, xy = at->u_y * top->width;
	const double yx = at->v_x * top->height, yy = at->v_y * top->height;
	/* rows grow downwards, as 1 - v does */
	const struct form p = { xx * xx + xy * xy, -(xx * yx + xy * yy),
		yx * yx + yy * yy };
	const double u = fold(at->u, at->wrap_u);
	const double v = fold(1 - at->v, at->wrap_v);
	/* magnified, most often: no larger than the trace */
	const double trace = p.xx + p.yy;
	const double big = trace <= 1 ? trace : larger_eigenvalue(&p);
	double near[SAMPLER_CHANS], wide[SAMPLER_CHANS], t = 0;

	if (big > 1 || isnan(big)) {
		const struct sampler_level *last = &s->level[s->nlevels - 1];

		t = sqrt(big) - 1;
		if (big < 1e30)
			filtered(s, at, u, v, &p, big, wide);
		else
			for (int c = 0; c < s->nvalues; c++)
				wide[c] = last->data[c];
	}
	if (t >= 1 || isnan(t)) {
		for (int c = 0; c < s->nvalues; c++)
			value[c] = (float)wide[c];
		return;
	}
	bilinear(s, at, u, v, near);
	for (int c = 0; c < s->nvalues; c++)
		value[c] = (float)(t > 0 ? near[c] + t * (wide[c] - near[c])
					 : near[c]);
}
