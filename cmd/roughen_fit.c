/* rm-roughen: the strength that fits a photograph or a relief. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "roughen_tool.h"

/* Degrees that the steepest facets are turned by. */
static double
deviation(double strength)
{
	return 90 * strength;
}

/* A fit at the end of its range has not met what it was to meet. */
static void
warn_unmet(struct cmd *cmd, const char *path, const struct bake_roughen *r,
    double error)
{
	if (error > 0.01)
		cmd_warn(cmd,
		    "%s: %s meets the contrast within %.0f %% only, at "
		    "strength %.4g",
		    path, bake_roughen_name(r->model), 100 * error,
		    r->strength);
}

bool
roughen_fit(struct roughen_job *job, struct roughen_texture *t)
{
	const struct roughen_opts *o = job->o;
	struct bake_roughen_target target = { .n = 1, .angle_deg = { o->at } };
	struct roughen_texture ref;
	struct bake_err err = BAKE_ERR_INIT;
	double error, contrast;
	bool ok = roughen_open(job, o->fit, NULL, &ref);

	target.contrast[0] = ok ? bake_roughen_contrast(&ref.stats) : 0;
	roughen_close(&ref);
	ok = ok && roughen_prepare(job, t);
	if (!ok)
		return false;
	if (!isfinite(target.contrast[0]) || target.contrast[0] <= 0) {
		cmd_error(job->cmd,
		    "%s: has a contrast of %g, nothing can be fitted to it",
		    o->fit, target.contrast[0]);
		return false;
	}
	if (bake_roughen_fit(&t->remap, &t->lum, &target, job->cmd->nthreads,
		&error, &contrast, &err) != BAKE_OK)
		return roughen_failed(job->cmd, o->fit, &err);
	error = fabs(contrast - target.contrast[0]) / target.contrast[0];
	job->strength = t->remap.strength;
	printf("model\tstrength\tdeviation\tangle\treference\tcontrast\t"
	       "error\n%s\t%.6g\t%.6g\t%.6g\t%.6g\t%.6g\t%.6g\n",
	    bake_roughen_name(t->remap.model), job->strength,
	    deviation(job->strength), o->at, target.contrast[0], contrast,
	    error);
	warn_unmet(job->cmd, t->map.path, &t->remap, error);
	return true;
}

/* -- the relief itself -----------------------------------------------------
 */

/* The relief at --angles, and last at --at. */
struct relief {
	struct cmd_map depth;
	struct bake_roughen_scene scene;
	struct bake_image lit[BAKE_ROUGHEN_ANGLES + 1];
	struct bake_roughen_target target;
};

static bool
render(struct roughen_job *job, struct relief *rel)
{
	const struct roughen_opts *o = job->o;
	struct cmd *cmd = job->cmd;
	struct bake_roughen_stats stats;
	struct bake_err err = BAKE_ERR_INIT;
	double angles[BAKE_ROUGHEN_ANGLES + 1];

	if (!cmd_read_channel(cmd, o->fit_depth, NULL, &rel->depth))
		return false;
	rel->scene.scale = o->depth_scale >= 0 ? o->depth_scale
			   : rel->depth.meta.depth_scale > 0
			       ? rel->depth.meta.depth_scale
			       : 0.1;
	rel->scene.azimuth_deg = o->azimuth;
	rel->scene.wrap = cmd_wrap(cmd, &rel->depth);
	rel->scene.nthreads = cmd->nthreads;
	cmd_to_depth(cmd, &rel->depth);
	cmd_smooth_steps(cmd, &rel->depth, &rel->depth.img, rel->scene.scale,
	    rel->scene.wrap, false);
	memcpy(angles, o->angles, (size_t)o->nangles * sizeof *angles);
	angles[o->nangles] = o->at;
	if (bake_roughen_render(&rel->depth.img, &rel->scene, angles,
		o->nangles + 1, rel->lit, &err) != BAKE_OK)
		return roughen_failed(cmd, rel->depth.path, &err);
	rel->target.n = o->nangles;
	for (int i = 0; i < o->nangles; i++) {
		if (bake_roughen_measure(
			&rel->lit[i], cmd->nthreads, &stats, &err) != BAKE_OK)
			return roughen_failed(cmd, rel->depth.path, &err);
		rel->target.angle_deg[i] = o->angles[i];
		rel->target.contrast[i] = bake_roughen_contrast(&stats);
	}
	return true;
}

static void
print_row(const char *name, double strength, double error, int n,
    const double *contrast)
{
	printf(
	    "%s\t%.6g\t%.6g\t%.6g", name, strength, deviation(strength), error);
	for (int i = 0; i < n; i++)
		printf("\t%.6g", contrast[i]);
	putchar('\n');
}

/* The mean of |c - c_relief| / c_relief. */
static double
mean_error(const struct bake_roughen_target *target, const double *contrast)
{
	double sum = 0;
	int n = 0;

	for (int i = 0; i < target->n; i++) {
		const double want = target->contrast[i];

		if (isfinite(want) && want > 0) {
			sum += fabs(contrast[i] - want) / want;
			n++;
		}
	}
	return sum / n;
}

static bool
fit_models(struct roughen_job *job, struct roughen_texture *t,
    const struct bake_roughen_target *target)
{
	static const enum bake_roughen_model order[] = { BAKE_ROUGHEN_FLAT,
		BAKE_ROUGHEN_BLACKSHOT, BAKE_ROUGHEN_PAPER,
		BAKE_ROUGHEN_FACET };
	double contrast[BAKE_ROUGHEN_ANGLES], error;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_roughen r;

	printf("model\tstrength\tdeviation\terror");
	for (int i = 0; i < target->n; i++)
		printf("\t%.6g", target->angle_deg[i]);
	putchar('\n');
	print_row("relief", 0, 0, target->n, target->contrast);
	for (int m = 0; m < BAKE_ROUGHEN_MODELS; m++) {
		if (bake_roughen_init(&r, order[m], 0, &t->stats, &err) !=
			BAKE_OK ||
		    bake_roughen_fit(&r, &t->lum, target, job->cmd->nthreads,
			&error, contrast, &err) != BAKE_OK)
			return roughen_failed(job->cmd, t->map.path, &err);
		print_row(bake_roughen_name(r.model), r.strength,
		    mean_error(target, contrast), target->n, contrast);
		if (r.model == job->o->model)
			job->strength = r.strength;
	}
	return true;
}

bool
roughen_fit_depth(struct roughen_job *job, struct roughen_texture *t)
{
	const struct roughen_opts *o = job->o;
	struct relief *rel;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_image picture = BAKE_IMAGE_INIT;
	bool ok;

	rel = bake_zalloc(1, sizeof *rel, &err);
	if (rel == NULL)
		return roughen_failed(job->cmd, o->fit_depth, &err);
	ok = render(job, rel);
	if (ok && o->render != NULL) {
		ok = bake_image_alloc(&picture, rel->depth.img.width,
			 rel->depth.img.height, 1, &err) == BAKE_OK ||
		     roughen_failed(job->cmd, o->render, &err);
		if (ok)
			bake_image_copy_channel(
			    &picture, 0, &rel->lit[o->nangles], 0);
		ok = ok && roughen_write_picture(job, &picture, o->render);
	}
	if (ok && t->lum.data == NULL)
		ok = roughen_take(
		    job, rel->depth.path, &rel->lit[o->nangles], t);
	ok = ok && fit_models(job, t, &rel->target);
	bake_image_free(&picture);
	for (int i = 0; i <= o->nangles; i++)
		bake_image_free(&rel->lit[i]);
	cmd_map_free(&rel->depth);
	free(rel);
	return ok;
}
