/* 2 1/2 D texture mapping: the remap of a run of texels, vectors at a time. */
/* SPDX-License-Identifier: MIT */
#include "isa.h"
#include "roughen_priv.h"

/*
 * Plain loops of + - * / over short arrays, which the compiler turns into
 * vectors: in each the same operations in the same order as
 * bake_roughen_gain's, so that the bits are the same. |Delta| <= pi / 4
 * (bake_roughen_is_near), where sine and cosine are one polynomial each.
 */
enum { RUN = BAKE_ROUGHEN_RUN };

static void
deviations(const struct bake_roughen *r, const float *t, double *d)
{
	const double m = r->median, low = r->low, high = r->high;

	for (int i = 0; i < RUN; i++) {
		const double x = t[i] - m, v = x / (x > 0 ? high : low);

		d[i] = v > -1 ? (v < 1 ? v : 1) : -1;
	}
}

/* Delta by d, in place. */
static void
facet_turns(const struct bake_roughen *r, double *d)
{
	const double most = r->strength * BAKE_HALF_PI;

	for (int i = 0; i < RUN; i++)
		d[i] = most * d[i];
}

static void
paper_turns(const struct bake_roughen *r, const float *t, double *d)
{
	const double m = r->median, s = r->strength;
	double root[RUN];

	/* apart, since sqrt may set errno and is not made a vector */
	for (int i = 0; i < RUN; i++)
		root[i] = sqrt(1 - fabs(d[i]));
	for (int i = 0; i < RUN; i++) {
		const double v = bake_acos_poly(fabs(d[i])) * root[i];
		const double a = d[i] < 0 ? BAKE_PI - v : v;
		const double above = t[i] > m ? s : 0;
		const double side = t[i] < m ? -s : above;

		d[i] = side * a;
	}
}

void
BAKE_KERNEL(bake_roughen_gains)(const struct bake_roughen *r, const float *t,
    const double *cos_theta, const double *sin_theta, double *g)
{
	double d[RUN];

	deviations(r, t, d);
	if (r->model == BAKE_ROUGHEN_FACET)
		facet_turns(r, d);
	else
		paper_turns(r, t, d);
	for (int i = 0; i < RUN; i++) {
		const double v = cos_theta[i] * bake_cos_near(d[i]) +
				 sin_theta[i] * bake_sin_near(d[i]);

		g[i] = v > 0 ? v : 0;
	}
}
