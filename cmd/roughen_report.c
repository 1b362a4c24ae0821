/* rm-roughen: tables and pictures of the remap. */
/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"
#include "roughen_picture.h"
#include "roughen_tool.h"

/* -- the table for shaders ------------------------------------------------- */

static void
set_decode(struct bake_attrs *attrs, const struct bake_image *lut)
{
	const int m = lut->width / 2 - 1;
	char line[2 * BAKE_ATTR_VALUE];

	bake_attrs_set(attrs, "Decode1",
	    "d = clamp((t - Median) / (t > Median ? High : Low), -1, 1)");
	snprintf(line, sizeof line,
	    "uv = (vec2(%d + sign(d) * (1 + %d * (1 - sqrt(1 - abs(d)))), "
	    "%d * sqrt(0.5 - 0.5 * c)) + 0.5) / vec2(%d, %d)",
	    m, m - 1, lut->height - 1, lut->width, lut->height);
	bake_attrs_set(attrs, "Decode2", line);
	bake_attrs_set(
	    attrs, "Decode3", "rgb *= max(0, 2 * texture(lut, uv).r - 1)");
}

static void
set_attrs(struct bake_attrs *attrs, const struct roughen_job *job,
    const struct roughen_texture *t, const struct bake_image *lut)
{
	const struct bake_roughen *r = &t->remap;

	bake_attrs_clear(attrs);
	bake_attrs_set(
	    attrs, "Layout", bake_layout_name(BAKE_LAYOUT_ROUGHEN_LUT));
	bake_attrs_set(attrs, "Model", bake_roughen_name(r->model));
	bake_attrs_set_number(attrs, "Strength", r->strength);
	bake_attrs_set(attrs, "Luminance",
	    job->color != NULL ? "scene-linear" : "encoded");
	bake_attrs_set_number(attrs, "Median", r->median);
	bake_attrs_set_number(attrs, "Low", r->low);
	bake_attrs_set_number(attrs, "High", r->high);
	set_decode(attrs, lut);
}

/* What a table's own step in g is, of codes. */
static double
rounding(enum bake_data_format format)
{
	const int max = bake_data_format_max(format);

	return max != 0 ? 1.0 / max : format == BAKE_DATA_HALF ? 1.0 / 2048 : 0;
}

bool
roughen_write_lut(
    const struct roughen_job *job, const struct roughen_texture *t)
{
	const struct roughen_opts *o = job->o;
	struct bake_write_params p = { .png_level = job->cmd->png_level };
	struct bake_image lut = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	double error;
	bool ok;

	if (!bake_file_type_from_path(o->lut, &p.type)) {
		cmd_error(job->cmd,
		    "%s: its name does not say what to write: end it in .png, "
		    ".tga, .tiff or .exr",
		    o->lut);
		return false;
	}
	p.data_format = bake_file_type_nearest(p.type, BAKE_DATA_FLOAT);
	if (bake_roughen_lut(
		&t->remap, o->lut_width, o->lut_height, &lut, &err) != BAKE_OK)
		return roughen_failed(job->cmd, o->lut, &err);
	set_attrs(&p.attrs, job, t, &lut);
	error = bake_roughen_lut_error(&t->remap, &lut, 1) +
		rounding(p.data_format);
	cmd_note(job->cmd, "%s: reproduces the remap within %.2g of white",
	    o->lut, error);
	if (error > 1.0 / 255)
		cmd_warn(job->cmd,
		    "%s: reproduces the remap within %.2g of white only; more "
		    "entries (--lut-size) or 16 bits do better",
		    o->lut, error);
	ok = cmd_write_as(job->cmd, &lut, o->lut, &p);
	bake_image_free(&lut);
	return ok;
}

/* -- the table of contrasts ------------------------------------------------ */

static bool
measure_curve(const struct roughen_job *job, const struct roughen_texture *t,
    struct bake_roughen_curve *curve)
{
	const struct roughen_opts *o = job->o;
	struct bake_err err = BAKE_ERR_INIT;

	if (!(t->stats.p50 > 0)) {
		cmd_error(job->cmd,
		    "%s: its median luminance is 0, and so its contrast is "
		    "none",
		    t->map.path);
		return false;
	}
	curve->n = o->nangles;
	for (int i = 0; i < o->nangles; i++) {
		curve->angle_deg[i] = o->angles[i];
		if (bake_roughen_lit_stats(&t->remap, o->angles[i], &t->lum,
			job->cmd->nthreads, &curve->stats[i], &err) != BAKE_OK)
			return roughen_failed(job->cmd, t->map.path, &err);
	}
	return true;
}

static void
print_curve(const struct bake_roughen_curve *curve)
{
	puts("angle\tp05\tp50\tp95\tcontrast");
	for (int i = 0; i < curve->n; i++) {
		const struct bake_roughen_stats *s = &curve->stats[i];

		printf("%.6g\t%.6g\t%.6g\t%.6g\t%.6g\n", curve->angle_deg[i],
		    s->p05, s->p50, s->p95, bake_roughen_contrast(s));
	}
}

static bool
has_ending(const char *path, const char *ending)
{
	const size_t n = strlen(path), k = strlen(ending);

	return n >= k && strcmp(path + n - k, ending) == 0;
}

static bool
write_svg(struct cmd *cmd, const char *path,
    const struct bake_roughen_curve *curve, const char *title)
{
	struct bake_output out = BAKE_OUTPUT_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_output_open(&out, path, &err) != BAKE_OK)
		return roughen_failed(cmd, path, &err);
	bake_roughen_plot_svg(curve, title, out.stream);
	if (bake_output_commit(&out, &err) != BAKE_OK)
		return roughen_failed(cmd, path, &err);
	cmd_flush_warnings(cmd);
	cmd_list_add(&cmd->written, path);
	return true;
}

/* A plot is no texture: its greys are those of a display. */
static bool
write_plot(const struct roughen_job *job, const char *path,
    const struct bake_roughen_curve *curve, const char *title)
{
	struct roughen_job plain = *job;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	if (has_ending(path, ".svg"))
		return write_svg(job->cmd, path, curve, title);
	plain.color = NULL;
	if (bake_roughen_plot(curve, title, &img, &err) != BAKE_OK)
		return roughen_failed(job->cmd, path, &err);
	ok = roughen_write_picture(&plain, &img, path);
	bake_image_free(&img);
	return ok;
}

static bool
report_contrast(const struct roughen_job *job, const struct roughen_texture *t)
{
	struct bake_roughen_curve curve;
	char title[64];

	if (!job->o->contrast && job->o->plot == NULL)
		return true;
	if (!measure_curve(job, t, &curve))
		return false;
	if (job->o->contrast)
		print_curve(&curve);
	snprintf(title, sizeof title, "%s, strength %.3g",
	    bake_roughen_name(t->remap.model), t->remap.strength);
	return job->o->plot == NULL ||
	       write_plot(job, job->o->plot, &curve, title);
}

/* -- pictures -------------------------------------------------------------- */

/* All models at the job's strength. */
static bool
all_remaps(const struct roughen_job *job, const struct roughen_texture *t,
    struct bake_roughen remaps[BAKE_ROUGHEN_MODELS])
{
	struct bake_err err = BAKE_ERR_INIT;

	for (int m = 0; m < BAKE_ROUGHEN_MODELS; m++)
		if (bake_roughen_init(&remaps[m], (enum bake_roughen_model)m,
			job->strength, &t->stats, &err) != BAKE_OK)
			return roughen_failed(job->cmd, t->map.path, &err);
	return true;
}

static bool
draw_sheet(const struct roughen_job *job, const struct roughen_texture *t)
{
	static const enum bake_roughen_model order[] = { BAKE_ROUGHEN_FLAT,
		BAKE_ROUGHEN_BLACKSHOT, BAKE_ROUGHEN_FACET,
		BAKE_ROUGHEN_PAPER };
	struct bake_roughen all[BAKE_ROUGHEN_MODELS];
	struct bake_roughen rows[BAKE_ROUGHEN_MODELS];
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	if (!all_remaps(job, t, all))
		return false;
	for (int m = 0; m < BAKE_ROUGHEN_MODELS; m++)
		rows[m] = all[order[m]];
	ok = bake_roughen_sheet(&t->map.img, &t->lum, rows, BAKE_ROUGHEN_MODELS,
		 job->o->angles, job->o->nangles, &img, &err) == BAKE_OK ||
	     roughen_failed(job->cmd, job->o->sheet, &err);
	ok = ok && roughen_write_picture(job, &img, job->o->sheet);
	bake_image_free(&img);
	return ok;
}

static bool
draw_cylinders(const struct roughen_job *job, const struct roughen_texture *t)
{
	const enum bake_roughen_model last = job->o->model;
	struct bake_roughen all[BAKE_ROUGHEN_MODELS];
	struct bake_roughen three[3];
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	if (!all_remaps(job, t, all))
		return false;
	three[0] = all[BAKE_ROUGHEN_FLAT];
	three[1] = all[BAKE_ROUGHEN_BLACKSHOT];
	three[2] = all[last == BAKE_ROUGHEN_PAPER ? last : BAKE_ROUGHEN_FACET];
	ok = bake_roughen_cylinders(&t->map.img, &t->lum, three, &img, &err) ==
		 BAKE_OK ||
	     roughen_failed(job->cmd, job->o->cylinder, &err);
	ok = ok && roughen_write_picture(job, &img, job->o->cylinder);
	bake_image_free(&img);
	return ok;
}

bool
roughen_report(struct roughen_job *job, struct roughen_texture *t)
{
	const struct roughen_opts *o = job->o;

	return report_contrast(job, t) &&
	       (o->lut == NULL || roughen_write_lut(job, t)) &&
	       (o->sheet == NULL || draw_sheet(job, t)) &&
	       (o->cylinder == NULL || draw_cylinders(job, t));
}
