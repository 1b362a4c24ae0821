/* 2 1/2 D texture mapping: the models, and a texture remapped by them. */
/* SPDX-License-Identifier: MIT */
#include "roughen.h"

#include <omp.h>
#include <string.h>

#include "isa.h"
#include "parallel.h"
#include "roughen_priv.h"

const char *
bake_roughen_name(enum bake_roughen_model model)
{
	static const char *const names[] = { "paper", "facet", "blackshot",
		"flat" };

	return names[model];
}

double
bake_roughen_contrast(const struct bake_roughen_stats *stats)
{
	return stats->p50 > 0 ? (stats->p95 - stats->p05) / (2 * stats->p50)
			      : INFINITY;
}

enum bake_status
bake_roughen_init(struct bake_roughen *r, enum bake_roughen_model model,
    double strength, const struct bake_roughen_stats *stats,
    struct bake_err *err)
{
	const double m = stats->p50;

	if ((int)model < 0 || (int)model >= BAKE_ROUGHEN_MODELS)
		return bake_fail(
		    err, BAKE_EINVAL, "unknown model %d", (int)model);
	if (!(strength >= 0 && strength <= 1))
		return bake_fail(err, BAKE_EINVAL,
		    "a strength of %g, expected 0 to 1", strength);
	if (!(m > 0) && model != BAKE_ROUGHEN_FLAT)
		return bake_fail(err, BAKE_EDATA,
		    "its median luminance is %g, expected more than 0: there "
		    "is no grey to tell relief from",
		    m);
	r->model = model;
	r->strength = strength;
	r->median = m;
	r->low = r->high = m > 0 ? m : 1;
	if (model == BAKE_ROUGHEN_FACET) {
		const double least = m / 1048576;

		r->low = m - stats->p05 > least ? m - stats->p05 : least;
		r->high = stats->p95 - m > least ? stats->p95 - m : least;
	}
	return BAKE_OK;
}

double
bake_roughen_facing(const struct bake_roughen *r, double d, double side,
    double cos_theta, double sin_theta)
{
	double delta = 0, c, s;

	if (r->model == BAKE_ROUGHEN_PAPER)
		delta = r->strength * side * bake_acos(d);
	else if (r->model == BAKE_ROUGHEN_FACET)
		delta = r->strength * BAKE_HALF_PI * d;
	if (delta == 0)
		return cos_theta;
	bake_cos_sin(delta, &c, &s);
	return cos_theta * c + sin_theta * s;
}

/* Whether blackshot puts a texel into shadow. */
static bool
in_shadow(const struct bake_roughen *r, double t, double c, double s)
{
	double cos_d, sin_d;

	bake_cos_sin(r->strength * BAKE_HALF_PI, &cos_d, &sin_d);
	return t * c < r->median * sin_d * s;
}

double
bake_roughen_gain(
    const struct bake_roughen *r, double t, double cos_theta, double sin_theta)
{
	double g = cos_theta;

	if (r->model == BAKE_ROUGHEN_PAPER || r->model == BAKE_ROUGHEN_FACET)
		g = bake_roughen_facing(r, bake_roughen_deviation(r, t),
		    bake_roughen_side(r, t), cos_theta, sin_theta);
	else if (r->model == BAKE_ROUGHEN_BLACKSHOT &&
		 in_shadow(r, t, cos_theta, sin_theta))
		return 0;
	return g > 0 ? g : 0;
}

void
bake_roughen_angle(double angle_deg, double *c, double *s)
{
	const double degree = BAKE_PI / 180;
	const double near = angle_deg > 90 ? 180 - angle_deg : angle_deg;

	/* the function of the angle that is the smaller of it and 90 - it */
	if (near > 45) {
		*c = bake_sin_near((90 - near) * degree);
		*s = bake_cos_near((90 - near) * degree);
	} else {
		*c = bake_cos_near(near * degree);
		*s = bake_sin_near(near * degree);
	}
	if (angle_deg > 90)
		*c = -*c;
}

enum bake_status
bake_roughen_luminance(const struct bake_image *img, const double weight[3],
    int nthreads, struct bake_image *lum, struct bake_err *err)
{
	enum bake_status rc;

	rc = bake_image_alloc(lum, img->width, img->height, 1, err);
	if (rc != BAKE_OK)
		return rc;
#pragma omp parallel for num_threads(bake_threads(nthreads)) schedule(static)
	for (int y = 0; y < img->height; y++) {
		const float *in = bake_image_row(img, y);
		float *out = bake_image_row(lum, y);

		if (img->nchans < 3) {
			for (int x = 0; x < img->width; x++, in += img->nchans)
				out[x] = in[0];
			continue;
		}
		for (int x = 0; x < img->width; x++, in += img->nchans)
			out[x] = (float)(weight[0] * in[0] + weight[1] * in[1] +
					 weight[2] * in[2]);
	}
	return BAKE_OK;
}

static double
clamp_cos(double c)
{
	return c > -1 ? (c < 1 ? c : 1) : -1; /* NaN is -1 */
}

bool
bake_roughen_is_near(const struct bake_roughen *r)
{
	/* arccos is up to pi, the facets' d up to 1 */
	return (r->model == BAKE_ROUGHEN_FACET && r->strength <= 0.5) ||
	       (r->model == BAKE_ROUGHEN_PAPER && r->strength <= 0.25);
}

/* One run of texels: up to BAKE_ROUGHEN_RUN of a row. */
struct run {
	int n;
	float t[BAKE_ROUGHEN_RUN];
	double c[BAKE_ROUGHEN_RUN], s[BAKE_ROUGHEN_RUN];
	double g[BAKE_ROUGHEN_RUN];
};

static void
fill_run(const struct bake_roughen_light *light, const struct bake_image *lum,
    int x0, int y, struct run *run)
{
	const float *t = bake_image_row(lum, y) + x0;
	const struct bake_image *map = light->cos_map;

	for (int i = 0; i < run->n; i++)
		run->t[i] = t[i];
	for (int i = 0; map != NULL && i < run->n; i++) {
		const double c = clamp_cos(bake_image_row(
		    map, y)[(size_t)(x0 + i) * (size_t)map->nchans]);

		run->c[i] = c;
		run->s[i] = sqrt(1 - c * c);
	}
}

static void
find_gains(const struct bake_roughen *r, enum bake_isa isa, struct run *run)
{
	static void (*const gains[])(const struct bake_roughen *, const float *,
	    const double *, const double *, double *) =
	    BAKE_KERNEL_TABLE(bake_roughen_gains);

	if (run->n == BAKE_ROUGHEN_RUN && bake_roughen_is_near(r)) {
		gains[isa](r, run->t, run->c, run->s, run->g);
		return;
	}
	for (int i = 0; i < run->n; i++)
		run->g[i] =
		    bake_roughen_gain(r, run->t[i], run->c[i], run->s[i]);
}

static void
apply_row(const struct bake_roughen *r, const struct bake_roughen_light *light,
    const struct bake_image *lum, enum bake_isa isa, struct bake_image *img,
    int y)
{
	const int ncolors = img->nchans < 3 ? 1 : 3;
	float *out = bake_image_row(img, y);
	struct run run;

	for (int i = 0; i < BAKE_ROUGHEN_RUN; i++) {
		run.c[i] = light->cos_theta;
		run.s[i] = light->sin_theta;
	}
	for (int x0 = 0; x0 < img->width; x0 += BAKE_ROUGHEN_RUN) {
		run.n = img->width - x0 < BAKE_ROUGHEN_RUN ? img->width - x0
							   : BAKE_ROUGHEN_RUN;
		fill_run(light, lum, x0, y, &run);
		find_gains(r, isa, &run);
		for (int i = 0; i < run.n; i++, out += img->nchans)
			for (int k = 0; k < ncolors; k++)
				out[k] = (float)(run.g[i] * out[k]);
	}
}

enum bake_status
bake_roughen_apply(const struct bake_roughen *r,
    const struct bake_roughen_light *light, const struct bake_image *lum,
    struct bake_image *img, int nthreads, struct bake_err *err)
{
	const struct bake_image *cosines =
	    light->cos_map != NULL ? light->cos_map : lum;
	const enum bake_isa isa = bake_isa_pick();

	if (lum->width != img->width || lum->height != img->height ||
	    cosines->width != img->width || cosines->height != img->height)
		return bake_fail(err, BAKE_EINVAL,
		    "a luminance of %dx%d and angles of %dx%d for %dx%d texels",
		    lum->width, lum->height, cosines->width, cosines->height,
		    img->width, img->height);
#pragma omp parallel for num_threads(bake_threads(nthreads)) schedule(static)
	for (int y = 0; y < img->height; y++)
		apply_row(r, light, lum, isa, img, y);
	return BAKE_OK;
}

enum bake_status
bake_roughen_lit_stats(const struct bake_roughen *r, double angle_deg,
    const struct bake_image *lum, int nthreads,
    struct bake_roughen_stats *stats, struct bake_err *err)
{
	struct bake_image lit = BAKE_IMAGE_INIT;
	struct bake_roughen_light light = { .cos_map = NULL };
	enum bake_status rc;

	bake_roughen_angle(angle_deg, &light.cos_theta, &light.sin_theta);
	rc = bake_image_alloc(&lit, lum->width, lum->height, 1, err);
	if (rc != BAKE_OK)
		return rc;
	bake_image_copy_channel(&lit, 0, lum, 0);
	rc = bake_roughen_apply(r, &light, lum, &lit, nthreads, err);
	if (rc == BAKE_OK)
		rc = bake_roughen_measure(&lit, nthreads, stats, err);
	bake_image_free(&lit);
	return rc;
}

/* -- cos theta at each texel ---------------------------------------------- */

static float
cos_between(const float *n, const double light[3], double light_length)
{
	const double nx = n[0], ny = n[1], nz = n[2];
	const double length = sqrt(nx * nx + ny * ny + nz * nz);

	if (!(length > 1e-18))
		return (float)(light[2] / light_length);
	return (float)clamp_cos(
	    (nx * light[0] + ny * light[1] + nz * light[2]) /
	    (length * light_length));
}

void
bake_roughen_cos_from_normals(
    struct bake_image *normal, const double light[3], int nthreads)
{
	/* scaled first: the squares of a very short or long light would not
	 * be numbers */
	const double most =
	    fmax(fabs(light[0]), fmax(fabs(light[1]), fabs(light[2])));
	const double l[3] = { light[0] / most, light[1] / most,
		light[2] / most };
	const double length = sqrt(l[0] * l[0] + l[1] * l[1] + l[2] * l[2]);

#pragma omp parallel for num_threads(bake_threads(nthreads)) schedule(static)
	for (int y = 0; y < normal->height; y++) {
		float *n = bake_image_row(normal, y);

		for (int x = 0; x < normal->width; x++, n += normal->nchans)
			n[0] = cos_between(n, l, length);
	}
}

void
bake_roughen_cos_from_angles(struct bake_image *angle, int nthreads)
{
#pragma omp parallel for num_threads(bake_threads(nthreads)) schedule(static)
	for (int y = 0; y < angle->height; y++) {
		float *a = bake_image_row(angle, y);

		for (int x = 0; x < angle->width; x++, a += angle->nchans) {
			const double deg =
			    a[0] > 0 ? (a[0] < 180 ? a[0] : 180) : 0;
			double c, s;

			bake_roughen_angle(deg, &c, &s);
			a[0] = (float)c;
		}
	}
}
