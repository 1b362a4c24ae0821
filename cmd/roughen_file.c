/* rm-roughen: a texture read, remapped and written. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "cmd_maps.h"
#include "roughen_tool.h"

bool
roughen_failed(struct cmd *cmd, const char *path, const struct bake_err *err)
{
	cmd_error(cmd, "%s: %s", path, err->msg);
	return false;
}

/* The space of a file's values: integers are made for displays, half and float
 * are light. */
static const char *
space_of(const struct roughen_job *job, enum bake_data_format format)
{
	if (job->o->space != NULL)
		return job->o->space;
	return bake_data_format_max(format) != 0 ? "sRGB" : "scene_linear";
}

/* The data format that cmd_write will take. */
static enum bake_data_format
output_format(
    const struct cmd *cmd, const char *path, enum bake_data_format deepest)
{
	enum bake_file_type type = cmd->type;

	if (cmd->has_data_format)
		return cmd->data_format;
	if (path == NULL ||
	    (!bake_file_type_from_path(path, &type) && !cmd->has_type))
		return deepest;
	return bake_file_type_nearest(type, deepest);
}

/* Tables pay where there are more texels than codes to try out. */
static bool
tables_pay(const struct roughen_texture *t)
{
	const int max = bake_data_format_max(t->deepest);

	return max != 0 && (double)t->map.img.width * t->map.img.height >
			       (max == 255 ? 65536.0 : 1048576.0);
}

static bool
to_light(struct roughen_job *job, struct roughen_texture *t)
{
	const char *space = space_of(job, t->deepest);
	struct bake_err err = BAKE_ERR_INIT;

	if (job->color == NULL)
		return true;
	if (tables_pay(t) &&
	    bake_tones_open(&t->tones, job->color, space,
		bake_data_format_max(t->deepest), &err) != BAKE_OK)
		return roughen_failed(job->cmd, t->map.path, &err);
	if (t->tones != NULL) {
		bake_tones_to_linear(t->tones, &t->map.img, job->cmd->nthreads);
		return true;
	}
	return bake_color_to_linear(job->color, space, &t->map.img,
		   job->cmd->nthreads, &err) == BAKE_OK ||
	       roughen_failed(job->cmd, t->map.path, &err);
}

static bool
measure(const struct roughen_job *job, struct roughen_texture *t)
{
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_roughen_luminance(&t->map.img, job->o->luma,
		job->cmd->nthreads, &t->lum, &err) != BAKE_OK ||
	    bake_roughen_measure(
		&t->lum, job->cmd->nthreads, &t->stats, &err) != BAKE_OK)
		return roughen_failed(job->cmd, t->map.path, &err);
	if (job->o->median > 0)
		t->stats.p50 = job->o->median;
	cmd_note(job->cmd, "%s: luminance 5 %% %.6g, median %.6g, 95 %% %.6g",
	    t->map.path, t->stats.p05, t->stats.p50, t->stats.p95);
	return true;
}

bool
roughen_open(struct roughen_job *job, const char *path, const char *out_path,
    struct roughen_texture *t)
{
	memset(t, 0, sizeof *t);
	if (!cmd_read(job->cmd, path, &t->map))
		return false;
	if (t->map.img.nchans > 4) {
		cmd_error(job->cmd,
		    "%s: has %d channels, a colour map has at most 4",
		    t->map.path, t->map.img.nchans);
		return false;
	}
	if (t->map.meta.layout != BAKE_LAYOUT_UNKNOWN)
		cmd_warn(job->cmd,
		    "%s: its metadata say that it holds %s, no colours",
		    t->map.path, bake_layout_name(t->map.meta.layout));
	t->deepest = t->map.info.data_format;
	t->out_format = output_format(job->cmd, out_path, t->deepest);
	return to_light(job, t) && measure(job, t);
}

bool
roughen_take(struct roughen_job *job, const char *name, struct bake_image *grey,
    struct roughen_texture *t)
{
	memset(t, 0, sizeof *t);
	t->map.path = name;
	bake_image_swap(&t->map.img, grey);
	t->deepest = BAKE_DATA_UINT8;
	t->out_format = BAKE_DATA_UINT8;
	return measure(job, t);
}

void
roughen_close(struct roughen_texture *t)
{
	cmd_map_free(&t->map);
	bake_image_free(&t->lum);
	bake_tones_close(t->tones);
}

bool
roughen_prepare(const struct roughen_job *job, struct roughen_texture *t)
{
	struct bake_err err = BAKE_ERR_INIT;

	return bake_roughen_init(&t->remap, job->o->model, job->strength,
		   &t->stats, &err) == BAKE_OK ||
	       roughen_failed(job->cmd, t->map.path, &err);
}

/* -- the light ------------------------------------------------------------- */

static bool
cos_by_normals(const struct roughen_job *job, const struct roughen_texture *t,
    struct cmd_map *n)
{
	const struct roughen_opts *o = job->o;
	struct cmd *cmd = job->cmd;

	if (!cmd_read_normal(cmd, o->normal_map, n) ||
	    !cmd_resize(cmd, n, cmd_wrap(cmd, n), t->lum.width, t->lum.height))
		return false;
	bake_normal_decode(&n->img, BAKE_NORMAL_CODE_UNSIGNED,
	    cmd_normal_y(cmd, n) == BAKE_NORMAL_Y_DOWN);
	bake_roughen_cos_from_normals(&n->img, o->light, cmd->nthreads);
	return true;
}

static bool
cos_by_angles(const struct roughen_job *job, const struct roughen_texture *t,
    struct cmd_map *a)
{
	const struct roughen_opts *o = job->o;
	struct cmd *cmd = job->cmd;

	if (!cmd_read(cmd, o->angle_map, a) ||
	    !cmd_resize(cmd, a, cmd_wrap(cmd, a), t->lum.width, t->lum.height))
		return false;
	if (a->img.nchans > 2)
		cmd_warn(cmd, "%s: has %d channels; the first is read", a->path,
		    a->img.nchans);
	for (int y = 0; o->unit == ROUGHEN_QUARTER && y < a->img.height; y++)
		for (int x = 0; x < a->img.width; x++)
			bake_image_row(&a->img, y)[x * a->img.nchans] *= 90;
	if (o->unit != ROUGHEN_COSINE)
		bake_roughen_cos_from_angles(&a->img, cmd->nthreads);
	return true;
}

static bool
find_light(const struct roughen_job *job, const struct roughen_texture *t,
    struct cmd_map *map, struct bake_roughen_light *light)
{
	const struct roughen_opts *o = job->o;

	light->cos_map = o->has_angle ? NULL : &map->img;
	if (o->has_angle) {
		bake_roughen_angle(
		    o->angle, &light->cos_theta, &light->sin_theta);
		return true;
	}
	return o->normal_map != NULL ? cos_by_normals(job, t, map)
				     : cos_by_angles(job, t, map);
}

/* -- out ------------------------------------------------------------------- */

static bool
from_light(
    const struct roughen_job *job, struct roughen_texture *t, const char *path)
{
	struct bake_err err = BAKE_ERR_INIT;

	if (job->color == NULL)
		return true;
	if (t->tones != NULL && t->out_format == t->deepest) {
		bake_tones_from_linear(
		    t->tones, &t->map.img, job->cmd->nthreads);
		return true;
	}
	return bake_color_from_linear(job->color, space_of(job, t->out_format),
		   &t->map.img, job->cmd->nthreads, &err) == BAKE_OK ||
	       roughen_failed(job->cmd, path, &err);
}

bool
roughen_write(
    const struct roughen_job *job, struct roughen_texture *t, const char *path)
{
	struct bake_roughen_light light = { .cos_map = NULL };
	struct cmd_map map = CMD_MAP_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok = find_light(job, t, &map, &light);

	if (ok)
		ok = bake_roughen_apply(&t->remap, &light, &t->lum, &t->map.img,
			 job->cmd->nthreads, &err) == BAKE_OK ||
		     roughen_failed(job->cmd, t->map.path, &err);
	ok = ok && from_light(job, t, path) &&
	     cmd_write(job->cmd, &t->map.img, path, t->deepest, NULL, NULL);
	cmd_map_free(&map);
	return ok;
}

bool
roughen_write_picture(
    const struct roughen_job *job, struct bake_image *img, const char *path)
{
	struct cmd out = *job->cmd;
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_data_format format;
	bool ok = true;

	out.has_type = out.has_data_format = false;
	format = output_format(&out, path, BAKE_DATA_UINT8);
	if (job->color != NULL)
		ok = bake_color_from_linear(job->color, space_of(job, format),
			 img, out.nthreads, &err) == BAKE_OK ||
		     roughen_failed(job->cmd, path, &err);
	ok = ok && cmd_write(&out, img, path, BAKE_DATA_UINT8, NULL, NULL);
	job->cmd->written = out.written;
	job->cmd->warnings = out.warnings;
	return ok;
}
