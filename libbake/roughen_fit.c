/* 2 1/2 D texture mapping: the strength that meets given contrasts. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "mem.h"
#include "roughen_priv.h"

enum { QUANTILES = 2048, GRID = 64, REFINEMENTS = 40 };

struct fit {
	struct bake_roughen r;
	const struct bake_roughen_target *target;
	const float *lum; /* sorted quantiles */
	float *lit;
	int n;
};

static int
by_value(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

static double
contrast_at(const struct fit *f, double angle_deg)
{
	struct bake_roughen_stats stats;
	double c, s;

	bake_roughen_angle(angle_deg, &c, &s);
	for (int i = 0; i < f->n; i++)
		f->lit[i] = (float)(bake_roughen_gain(&f->r, f->lum[i], c, s) *
				    f->lum[i]);
	/* the paper's jump changes the order, and so do facets that are
	 * turned to beyond the light */
	qsort(f->lit, (size_t)f->n, sizeof *f->lit, by_value);
	bake_roughen_sorted_stats(f->lit, f->n, &stats);
	return bake_roughen_contrast(&stats);
}

static bool
counts(double contrast)
{
	return isfinite(contrast) && contrast > 0;
}

/* The mean relative error at a strength; a median of 0 is as bad as can be. */
static double
error_at(struct fit *f, double strength)
{
	double sum = 0;
	int n = 0;

	f->r.strength = strength;
	for (int i = 0; i < f->target->n; i++) {
		const double want = f->target->contrast[i];

		if (!counts(want))
			continue;
		sum +=
		    fabs(contrast_at(f, f->target->angle_deg[i]) - want) / want;
		n++;
	}
	return sum / n;
}

/* The grid's best point, then golden section between its neighbours. */
static double
search(struct fit *f, double *error)
{
	const double golden = (sqrt(5) - 1) / 2;
	double best = 0, least = error_at(f, 0), lo, hi;

	for (int i = 1; i <= GRID; i++) {
		const double e = error_at(f, (double)i / GRID);

		if (e < least) {
			least = e;
			best = (double)i / GRID;
		}
	}
	lo = best - 1.0 / GRID > 0 ? best - 1.0 / GRID : 0;
	hi = best + 1.0 / GRID < 1 ? best + 1.0 / GRID : 1;
	for (int i = 0; i < REFINEMENTS; i++) {
		const double a = hi - golden * (hi - lo);
		const double b = lo + golden * (hi - lo);
		const double ea = error_at(f, a), eb = error_at(f, b);

		if (ea <= eb)
			hi = b;
		else
			lo = a;
		if (ea < least || eb < least) {
			best = ea <= eb ? a : b;
			least = ea <= eb ? ea : eb;
		}
	}
	*error = least;
	return best;
}

static enum bake_status
check_target(const struct bake_roughen_target *target, struct bake_err *err)
{
	for (int i = 0; i < target->n; i++)
		if (counts(target->contrast[i]))
			return BAKE_OK;
	return bake_fail(err, BAKE_EDATA,
	    "it has no contrast to be met: no angle, or medians or contrasts "
	    "of 0");
}

enum bake_status
bake_roughen_fit(struct bake_roughen *r, const struct bake_image *lum,
    const struct bake_roughen_target *target, int nthreads, double *error,
    double *contrast, struct bake_err *err)
{
	struct fit f = { .r = *r, .target = target };
	struct bake_roughen_stats stats;
	float *quantiles = NULL;
	enum bake_status rc;

	if ((rc = check_target(target, err)) != BAKE_OK)
		return rc;
	rc = BAKE_ENOMEM;
	quantiles = bake_roughen_quantiles(lum, QUANTILES, &f.n, err);
	f.lum = quantiles;
	if (quantiles != NULL)
		f.lit = bake_alloc((size_t)f.n, sizeof *f.lit, err);
	if (f.lit == NULL)
		goto out;
	rc = BAKE_OK;
	if (r->model == BAKE_ROUGHEN_FLAT) {
		*error = error_at(&f, 0);
		r->strength = 0;
	} else {
		r->strength = search(&f, error);
	}
	for (int i = 0; contrast != NULL && i < target->n && rc == BAKE_OK;
	     i++) {
		rc = bake_roughen_lit_stats(
		    r, target->angle_deg[i], lum, nthreads, &stats, err);
		if (rc == BAKE_OK)
			contrast[i] = bake_roughen_contrast(&stats);
	}
out:
	free(quantiles);
	free(f.lit);
	return rc;
}
