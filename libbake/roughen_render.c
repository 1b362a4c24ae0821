/* A matte height field lit with cast shadows: the truth that remaps miss. */
/* SPDX-License-Identifier: MIT */
#include "horizon_priv.h"
#include "mem.h"
#include "normal.h"
#include "parallel.h"
#include "roughen_priv.h"

#include <stdlib.h>

/* Steps of the azimuth in a full circle. */
enum { AZIMUTHS = 36000 };

struct render {
	const struct bake_image *depth;
	const struct bake_roughen_scene *scene;
	const double *angles;
	int n;
	struct bake_image *lit;
	struct bake_image normal;
	struct bake_horizon horizon;
	double (*light)[3]; /* of each angle */
};

static enum bake_status
check_scene(const struct bake_image *depth,
    const struct bake_roughen_scene *scene, const double *angles, int n,
    struct bake_err *err)
{
	if (depth->data == NULL || depth->nchans != 1)
		return bake_fail(err, BAKE_EINVAL,
		    "a depth map of %d channels, expected 1", depth->nchans);
	if (!(scene->scale >= 0 && scene->scale <= 1e6))
		return bake_fail(err, BAKE_EINVAL,
		    "a depth scale of %g, expected 0 to 1e6", scene->scale);
	if (!(fabs(scene->azimuth_deg) <= 360))
		return bake_fail(err, BAKE_EINVAL,
		    "an azimuth of %g degrees, expected -360 to 360",
		    scene->azimuth_deg);
	if (n < 1)
		return bake_fail(err, BAKE_EINVAL, "no angle to render");
	for (int i = 0; i < n; i++)
		if (!(angles[i] >= 0 && angles[i] <= 90))
			return bake_fail(err, BAKE_EINVAL,
			    "an angle of %g degrees, expected 0 to 90",
			    angles[i]);
	return BAKE_OK;
}

static int
azimuth_index(const struct bake_roughen_scene *scene)
{
	const int j = (int)lround(scene->azimuth_deg * (AZIMUTHS / 360));

	return (j % AZIMUTHS + AZIMUTHS) % AZIMUTHS;
}

static void
shade_texel(const struct render *r, int x, int y, float slope)
{
	const float *n = bake_image_row(&r->normal, y) + 3 * (size_t)x;
	const double tan_horizon = slope * r->scene->scale * r->depth->width;

	for (int i = 0; i < r->n; i++) {
		const double *l = r->light[i];
		const double across = sqrt(l[0] * l[0] + l[1] * l[1]);
		const double lambert = n[0] * l[0] + n[1] * l[1] + n[2] * l[2];
		const bool hidden = tan_horizon * across > l[2];

		bake_image_row(&r->lit[i], y)[x] =
		    !hidden && lambert > 0 ? (float)lambert : 0;
	}
}

static void
shade_tile(const struct render *r, int x0, int y0)
{
	float slopes[BAKE_TILE_TEXELS];

	bake_horizon_tile(&r->horizon, 0, x0, y0, slopes);
	for (int y = 0; y < BAKE_TILE_HEIGHT && y0 + y < r->depth->height; y++)
		for (int x = 0; x < BAKE_TILE_WIDTH && x0 + x < r->depth->width;
		     x++)
			shade_texel(
			    r, x0 + x, y0 + y, slopes[y * BAKE_TILE_WIDTH + x]);
}

static void
shade_all(struct render *r, int nthreads)
{
	const int across =
	    (r->depth->width + BAKE_TILE_WIDTH - 1) / BAKE_TILE_WIDTH;
	const int down =
	    (r->depth->height + BAKE_TILE_HEIGHT - 1) / BAKE_TILE_HEIGHT;

#pragma omp parallel num_threads(nthreads)
	{
		bake_horizon_aim(
		    &r->horizon, azimuth_index(r->scene), AZIMUTHS);
#pragma omp for collapse(2) schedule(dynamic)
		for (int j = 0; j < down; j++)
			for (int i = 0; i < across; i++)
				shade_tile(r, i * BAKE_TILE_WIDTH,
				    j * BAKE_TILE_HEIGHT);
	}
}

static enum bake_status
prepare(struct render *r, int nthreads, struct bake_err *err)
{
	const double turn = 2 * BAKE_PI / AZIMUTHS * azimuth_index(r->scene);
	enum bake_status rc;

	r->light = bake_alloc((size_t)r->n, sizeof *r->light, err);
	if (r->light == NULL)
		return BAKE_ENOMEM;
	for (int i = 0; i < r->n; i++) {
		double c, s, ca, sa;

		bake_roughen_angle(r->angles[i], &c, &s);
		bake_cos_sin(
		    turn > BAKE_PI ? turn - 2 * BAKE_PI : turn, &ca, &sa);
		r->light[i][0] = s * ca;
		r->light[i][1] = s * sa;
		r->light[i][2] = c;
		rc = bake_image_alloc(
		    &r->lit[i], r->depth->width, r->depth->height, 1, err);
		if (rc != BAKE_OK)
			return rc;
	}
	rc = bake_normal_from_depth(r->depth, r->scene->scale, r->scene->wrap,
	    BAKE_SLOPE_CENTRAL, nthreads, &r->normal, err);
	if (rc == BAKE_OK)
		rc = bake_horizon_init(&r->horizon, r->depth, r->scene->wrap, 0,
		    1, BAKE_HORIZON_EXACT, nthreads, err);
	return rc;
}

enum bake_status
bake_roughen_render(const struct bake_image *depth,
    const struct bake_roughen_scene *scene, const double *angles, int n,
    struct bake_image *lit, struct bake_err *err)
{
	struct render r = { .depth = depth,
		.scene = scene,
		.angles = angles,
		.n = n,
		.lit = lit,
		.normal = BAKE_IMAGE_INIT };
	const int nthreads = bake_threads(scene->nthreads);
	enum bake_status rc = check_scene(depth, scene, angles, n, err);

	if (rc != BAKE_OK)
		return rc;
	if ((rc = prepare(&r, nthreads, err)) == BAKE_OK)
		shade_all(&r, nthreads);
	bake_horizon_free(&r.horizon);
	bake_image_free(&r.normal);
	free(r.light);
	for (int i = 0; rc != BAKE_OK && i < n; i++)
		bake_image_free(&lit[i]);
	return rc;
}
