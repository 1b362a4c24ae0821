/* rm-combine: layers of relief into one meta-relief texture. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd_batch.h"
#include "cmd_recipe.h"
#include "cmd_target.h"
#include "combine_tool.h"

/* What is known of the blend while layers are added. */
struct job {
	struct cmd *cmd;
	const struct combine_opts *o;
	struct bake_combine_params params;
	struct bake_combine *blend;
	enum bake_data_format deepest;
	struct bake_relief_meta meta;
	struct bake_color *color;
	struct bake_image color_map;
	enum bake_data_format color_deepest;
};

static bool
failed(const struct job *job, const char *what, const struct bake_err *err)
{
	cmd_error(job->cmd, "%s: %s", what, err->msg);
	return false;
}

/* -- the whole --------------------------------------------------------------
 */

/* Where the layer lies in the result, which may cover several repeats. */
static struct bake_placement
placement(const struct combine_opts *o, const struct combine_layer *l)
{
	struct bake_placement p = l->place;

	p.tile_u *= o->repeat;
	p.tile_v *= o->repeat;
	return p;
}

static bool
is_whole(double v)
{
	return fabs(v - floor(v + 0.5)) < 1e-9 * v;
}

/* Whether n repeats of the base end where all layers do. */
static bool
tiles_at(const struct combine_opts *o, struct bake_wrap wrap, int n)
{
	for (int i = 0; i < o->n; i++) {
		const struct bake_placement *p = &o->layer[i].place;

		if (combine_is_removed(&o->layer[i]))
			continue;
		if ((!wrap.clamp_u && !is_whole(p->tile_u * n)) ||
		    (!wrap.clamp_v && !is_whole(p->tile_v * n)))
			return false;
	}
	return true;
}

static void
warn_of_seam(const struct job *job)
{
	enum { MAX = 64 };
	const struct combine_opts *o = job->o;
	int n = 1;

	if (tiles_at(o, job->params.wrap, o->repeat))
		return;
	while (n <= MAX && !tiles_at(o, job->params.wrap, n))
		n++;
	if (n <= MAX)
		cmd_warn(job->cmd,
		    "%s: a fractional tile factor leaves a seam at its border; "
		    "--repeat %d makes it tile",
		    job->cmd->output, n);
	else
		cmd_warn(job->cmd,
		    "%s: a fractional tile factor leaves a seam at its border, "
		    "and no --repeat up to %d makes it tile",
		    job->cmd->output, MAX);
}

static bool
size_is_allowed(struct job *job, long width, long height)
{
	const size_t max = job->cmd->limits.max_texels;

	if (width > 1 << 20 || height > 1 << 20 ||
	    (size_t)(width * height) > max) {
		cmd_error(job->cmd,
		    "%s: the result would have %ldx%ld texels; --max-pixels N "
		    "allows more than 2^30, up to 2^20 a side",
		    job->cmd->output, width, height);
		return false;
	}
	job->params.width = (int)width;
	job->params.height = (int)height;
	return true;
}

static void
sum_weights(struct job *job)
{
	struct bake_combine_params *p = &job->params;

	for (int i = 0; i < job->o->n; i++) {
		p->nnormals += combine_normal_weight(&job->o->layer[i]) > 0;
		p->normal_total += combine_normal_weight(&job->o->layer[i]);
		p->depth_total += combine_depth_weight(&job->o->layer[i]);
	}
}

/* What the first layer settles: the size, the scale, the border. */
static bool
begin(struct job *job, const struct combine_read *first)
{
	const struct combine_opts *o = job->o;
	struct bake_combine_params *p = &job->params;
	struct bake_err err = BAKE_ERR_INIT;

	if (!size_is_allowed(job,
		o->width > 0 ? o->width : (long)first->maps.width * o->repeat,
		o->height > 0 ? o->height
			      : (long)first->maps.height * o->repeat))
		return false;
	p->depth_scale = o->depth_scale > 0 ? o->depth_scale
					    : first->depth_scale / o->repeat;
	p->normal_blend = o->normal_blend;
	p->ao_blend = o->ao_blend;
	p->ao_rescale = o->ao_rescale;
	p->filter = o->filter;
	p->slope = o->slope;
	p->ao.quality = o->quality;
	p->wrap = first->wrap;
	p->nthreads = job->cmd->nthreads;
	sum_weights(job);
	warn_of_seam(job);
	return bake_combine_open(&job->blend, p, &err) == BAKE_OK ||
	       failed(job, job->cmd->output, &err);
}

/* -- layers ------------------------------------------------------------------
 */

static void
note_keep_scale(struct job *job, int i, double keep)
{
	if (job->o->n > BAKE_KEEP_SCALES)
		return;
	job->meta.keep_scale[i] = keep;
	job->meta.nkeep = i + 1;
}

static void
warn_of_oblong(const struct job *job, const struct combine_layer *l,
    const struct combine_read *r)
{
	const struct bake_combine_params *p = &job->params;
	const double u = l->place.tile_u * r->maps.width / p->width;
	const double v = l->place.tile_v * r->maps.height / p->height;

	if (fabs(u / v - 1) > 1e-6 && l->place.tile_u == l->place.tile_v)
		cmd_warn(job->cmd,
		    "%s: %dx%d texels are stretched over %dx%d, so that they "
		    "are no longer square; -t UxV tiles each way on its own",
		    combine_name(l), r->maps.width, r->maps.height, p->width,
		    p->height);
}

static bool
add_layer(struct job *job, int i)
{
	const struct combine_layer *l = &job->o->layer[i];
	const struct bake_combine_layer layer = { combine_normal_weight(l),
		combine_depth_weight(l), placement(job->o, l), 1, 0 };
	struct bake_combine_layer own = layer;
	struct combine_read r = { .deepest = BAKE_DATA_UINT8 };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_layer_scales scales;
	bool ok;

	if (i > 0 && combine_is_removed(l)) {
		note_keep_scale(job, i, INFINITY);
		return true;
	}
	ok = combine_read_layer(job->cmd, job->o, l, &r) &&
	     (i > 0 || begin(job, &r));
	if (ok) {
		own.depth_scale = r.depth_scale;
		own.ao_scale = r.ao_scale;
		scales = bake_combine_scales(
		    &job->params, &own, r.maps.width, r.maps.height);
		note_keep_scale(job, i, scales.keep);
		cmd_note(job->cmd,
		    "%s: %dx%d, depth scale %.4g, appears with %.4g times its "
		    "relief; keeps it at depth scale %.4g",
		    combine_name(l), r.maps.width, r.maps.height, r.depth_scale,
		    scales.s, scales.keep);
	}
	if (ok && !combine_is_removed(l)) {
		warn_of_oblong(job, l, &r);
		if (r.deepest > job->deepest)
			job->deepest = r.deepest;
		ok = bake_combine_add(job->blend, &own, &r.maps, &err) ==
			 BAKE_OK ||
		     failed(job, combine_name(l), &err);
	}
	bake_image_free(&r.maps);
	return ok;
}

static bool
blend_layers(struct job *job)
{
	struct bake_err err = BAKE_ERR_INIT;
	bool ok = true;

	for (int i = 0; ok && i < job->o->n; i++)
		ok = add_layer(job, i);
	if (!ok)
		return false;
	if (job->o->n > BAKE_KEEP_SCALES)
		cmd_warn(job->cmd,
		    "%s: has no room for the keep scales of %d layers",
		    job->cmd->output, job->o->n);
	return bake_combine_settle(job->blend, &err) == BAKE_OK ||
	       failed(job, job->cmd->output, &err);
}

/* -- colour ------------------------------------------------------------------
 */

/* Before any work: what the configuration does not know is an error. */
static bool
open_color(struct job *job)
{
	const struct combine_opts *o = job->o;
	struct bake_err err = BAKE_ERR_INIT;
	const char *path;

	if (o->color_out == NULL)
		return true;
	if (bake_color_open(NULL, &job->color, &err) != BAKE_OK ||
	    bake_color_check(job->color,
		o->color_space != NULL ? o->color_space : "sRGB",
		&err) != BAKE_OK) {
		cmd_error(job->cmd, "%s", err.msg);
		return false;
	}
	path = bake_color_path(job->color);
	if (path != NULL)
		cmd_list_add(&job->cmd->read, path);
	return true;
}

static bool
write_color(struct job *job)
{
	struct cmd color = *job->cmd;
	bool ok;

	color.has_type = false;
	color.has_data_format = false;
	ok = cmd_write(&color, &job->color_map, job->o->color_out,
	    job->color_deepest, NULL, NULL);
	job->cmd->written = color.written;
	job->cmd->warnings = color.warnings;
	return ok;
}

/* -- the run ------------------------------------------------------------------
 */

static enum bake_status
get_band(
    void *arg, int y, const struct cmd_target_band *band, struct bake_err *err)
{
	const struct job *job = arg;

	return bake_combine_get(
	    job->blend, y, band->normal, band->ao, band->relief, err);
}

static bool
write_all(struct job *job)
{
	struct cmd_target_maps out = { job->params.width, job->params.height,
		get_band, job, job->meta, job->deepest, job->o->exr_names };

	out.meta.polarity = BAKE_POLARITY_DEPTH;
	out.meta.normal_y = BAKE_NORMAL_Y_UP;
	out.meta.depth_scale = job->params.depth_scale;
	out.meta.has_wrap = true;
	out.meta.wrap = job->params.wrap;
	if (!cmd_write_target(job->cmd, job->o->target, &out, job->cmd->output))
		return false;
	return job->color == NULL || write_color(job);
}

static int
combine(struct cmd *cmd, int i, void *opts)
{
	struct combine_opts *o = opts;
	struct job job = { .cmd = cmd,
		.o = o,
		.params = BAKE_COMBINE_PARAMS_DEFAULT,
		.meta = BAKE_RELIEF_META_INIT };
	bool ok;

	(void)i;
	cmd_recipe_begin(cmd, -1);
	cmd_target_plan(cmd, o->target, cmd->output);
	cmd_recipe_output(cmd, o->color_out, "color");
	if (o->color_out != NULL)
		cmd_recipe_color(cmd);
	if (cmd_unchanged(cmd))
		return CMD_EXIT_OK;
	ok = open_color(&job) && blend_layers(&job);
	if (ok && job.color != NULL)
		ok = combine_colors(cmd, o, job.color, &job.params,
		    &job.color_map, &job.color_deepest);
	ok = ok && write_all(&job);
	bake_combine_close(job.blend);
	bake_image_free(&job.color_map);
	bake_color_close(job.color);
	return ok ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

static int
run(struct cmd *cmd, struct combine_opts *o)
{
	if (o->list_targets)
		return cmd_print_targets();
	if (!combine_args_are_clear(cmd, o))
		return CMD_EXIT_USAGE;
	return cmd_one(cmd, combine, o);
}

int
main(int argc, char *argv[])
{
	struct combine_opts o = { .next = COMBINE_LAYER_INIT, .repeat = 1 };
	struct cmd_tool tool = { "rm-combine",
		"[layer options] LAYER ... -o OUT",
		"Blend layers of relief into one meta-relief texture.",
		combine_options,
		CMD_OPTS_OUTPUT | CMD_OPTS_RELIEF | CMD_OPTS_NORMAL |
		    CMD_OPTS_OUTPUT_NORMAL | CMD_OPTS_TILES | CMD_IN_ORDER,
		combine_set, &o, main, 60, combine_marks };
	struct cmd cmd;
	int status;

	o.target = bake_target_find("relief");
	if (cmd_parse(&cmd, &tool, argc, argv, &status))
		status = run(&cmd, &o);
	free(o.layer);
	return cmd_finish(&cmd, status);
}
