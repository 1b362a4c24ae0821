/* rm-aobake: ambient occlusion from a depth map or a packed texture. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "ao.h"
#include "cmd.h"
#include "cmd_batch.h"
#include "cmd_image.h"
#include "cmd_recipe.h"

enum {
	KEY_BENT = CMD_KEY_TOOL,
	KEY_BLUR,
	KEY_BLUR_MODE,
	KEY_CHANNEL,
	KEY_DEQUANTIZE,
	KEY_ESTIMATOR,
	KEY_HORIZONS,
	KEY_IN_PLACE,
	KEY_NO_BLUR,
	KEY_PERIODS,
	KEY_QUALITY
};

static const struct cmd_option options[] = {
	{ KEY_BENT, "bent-normal", "FILE",
	    "also write the mean unoccluded direction, as a normal map" },
	{ KEY_BLUR, "blur", "SIGMA",
	    "low-pass of occluded texels, in texels (default 1)" },
	{ KEY_BLUR_MODE, "blur-mode", "MODE",
	    "{paper} (default), or {occluded}: light does not leak into pits" },
	{ KEY_CHANNEL, "channel", "NAME",
	    "the relief's channel: {R}, {G}, {B}, {A}, its name or number" },
	{ 's', "depth-scale", "S[,S...]",
	    "depth range / texture width (default 0.1 or the file's)" },
	{ KEY_DEQUANTIZE, "dequantize", NULL,
	    "smooth an 8-bit map within half a code before baking" },
	{ 'n', "directions", "N",
	    "horizon directions, 3 to 1024 (default 50)" },
	{ KEY_ESTIMATOR, "estimator", "NAME",
	    "{polygon} (default, the paper's) or {mean}" },
	{ KEY_HORIZONS, "horizons", "FILE",
	    "also write tan of the horizon angles, an EXR channel each" },
	{ KEY_IN_PLACE, "in-place-channel", "NAME",
	    "rewrite this channel (B) of a packed input, with -o or in its "
	    "place" },
	{ KEY_NO_BLUR, "no-blur", NULL, "no low-pass" },
	{ KEY_PERIODS, "periods", "N",
	    "reach in periods of the texture, 1 to 64 (default 1)" },
	{ KEY_QUALITY, "quality", "NAME",
	    "{exact} (default), {fast} or {preview}" },
	{ 'r', "radius", "R", "reach in texture widths (default: --periods)" },
	{ 0, NULL, NULL, NULL },
};

static const struct cmd_mark marks[] = {
	{ "bent-normal", CMD_ARG_NEUTRAL, NULL },
	{ "horizons", CMD_ARG_NEUTRAL, NULL },
	{ NULL, 0, NULL },
};

enum { MAX_SCALES = 16 };

struct opts {
	struct bake_ao_params ao;
	double scale[MAX_SCALES];
	int nscales; /* 0: the file's, else 0.1 */
	const char *bent, *horizons, *channel, *in_place;
	bool dequantize;
};

static bool
set_choice(struct cmd *cmd, struct opts *o, int key, const char *arg)
{
	static const char *const estimators[] = { "polygon", "mean" };
	static const char *const qualities[] = { "exact", "fast", "preview" };
	static const char *const blurs[] = { "paper", "occluded" };
	int i;

	switch (key) {
	case KEY_ESTIMATOR:
		if (!cmd_choice(cmd, "estimator", arg, estimators, 2, &i))
			return false;
		o->ao.estimator = (enum bake_ao_estimator)i;
		return true;
	case KEY_QUALITY:
		if (!cmd_choice(cmd, "quality", arg, qualities, 3, &i))
			return false;
		o->ao.quality = (enum bake_ao_quality)i;
		return true;
	default:
		if (!cmd_choice(cmd, "blur-mode", arg, blurs, 2, &i))
			return false;
		if (o->ao.blur != BAKE_AO_BLUR_NONE)
			o->ao.blur =
			    i == 0 ? BAKE_AO_BLUR_PAPER : BAKE_AO_BLUR_OCCLUDED;
		return true;
	}
}

static bool
set_option(struct cmd *cmd, int key, const char *arg)
{
	struct opts *o = cmd->tool->opts;

	switch (key) {
	case KEY_BENT:
		o->bent = arg;
		return true;
	case KEY_BLUR:
		return cmd_number(cmd, "blur", arg, 0, 64, &o->ao.blur_sigma);
	case KEY_CHANNEL:
		o->channel = arg;
		return true;
	case 's':
		return cmd_numbers(cmd, "depth-scale", arg, 0, 1e6, o->scale,
		    MAX_SCALES, &o->nscales);
	case KEY_DEQUANTIZE:
		o->dequantize = true;
		return true;
	case 'n':
		return cmd_int(cmd, "directions", arg, 3, 1024, &o->ao.ndirs);
	case KEY_HORIZONS:
		o->horizons = arg;
		return true;
	case KEY_IN_PLACE:
		o->in_place = arg;
		return true;
	case KEY_NO_BLUR:
		o->ao.blur = BAKE_AO_BLUR_NONE;
		return true;
	case KEY_PERIODS:
		return cmd_int(cmd, "periods", arg, 1, 64, &o->ao.periods);
	case 'r':
		return cmd_number(cmd, "radius", arg, 1e-6, 64, &o->ao.radius);
	default:
		return set_choice(cmd, o, key, arg);
	}
}

/* The file for scale k of several: with the scale's value before the
 * extension; *path is freed and replaced. */
static void
add_scale_suffix(char **path, double scale, int nscales)
{
	char suffix[48];
	char *with;

	if (nscales < 2)
		return;
	snprintf(suffix, sizeof suffix, "_s%.9g", scale);
	with = cmd_path_derive(*path, NULL, suffix, NULL);
	free(*path);
	*path = with;
}

/* In place means over the input. */
static char *
output_path(const struct cmd *cmd, const char *in)
{
	return cmd->output == NULL && cmd->output_dir == NULL
		   ? cmd_path_derive(in, NULL, "", NULL)
		   : cmd_output_path(cmd, in, "");
}

static void
plan_output(
    struct cmd *cmd, const struct opts *o, char *path, const char *what, int k)
{
	char label[64];

	add_scale_suffix(&path, o->scale[k], o->nscales);
	snprintf(label, sizeof label, "%s %.9g", what,
	    o->nscales > 1 ? o->scale[k] : 0);
	cmd_recipe_output(cmd, path, label);
	free(path);
}

/* Say what will be written: one of each where the file tells the scale. */
static void
plan_outputs(struct cmd *cmd, const struct opts *o, const char *in)
{
	for (int k = 0; k == 0 || k < o->nscales; k++) {
		plan_output(cmd, o, output_path(cmd, in), "ao", k);
		if (o->bent != NULL)
			plan_output(cmd, o,
			    cmd_path_derive(o->bent, NULL, "", NULL), "bent",
			    k);
		if (o->horizons != NULL)
			plan_output(cmd, o,
			    cmd_path_derive(o->horizons, NULL, "", NULL),
			    "horizons", k);
	}
}

static bool
write_bent(struct cmd *cmd, const struct opts *o, const struct cmd_map *map,
    struct bake_image *bent, const struct bake_relief_meta *ao_meta, int k)
{
	struct bake_relief_meta meta = *ao_meta;
	bool down = cmd->output_normal_y == BAKE_NORMAL_Y_DOWN;
	char *path = cmd_path_derive(o->bent, NULL, "", NULL);
	bool ok;

	add_scale_suffix(&path, o->scale[k], o->nscales);
	meta.layout = BAKE_LAYOUT_BENT;
	meta.normal_y = down ? BAKE_NORMAL_Y_DOWN : BAKE_NORMAL_Y_UP;
	meta.normal_code = BAKE_NORMAL_CODE_UNSIGNED;
	bake_normal_encode(bent, down);
	ok = cmd_write(cmd, bent, path, map->info.data_format, &meta, NULL);
	free(path);
	return ok;
}

static bool
write_horizons(struct cmd *cmd, const struct opts *o,
    const struct bake_image *horizons, const struct bake_relief_meta *ao_meta,
    int k)
{
	struct bake_relief_meta meta = *ao_meta;
	char *path = cmd_path_derive(o->horizons, NULL, "", NULL);
	char text[1024][12];
	const char *names[1024];
	struct cmd exr = *cmd;
	bool ok;

	for (int c = 0; c < horizons->nchans; c++) {
		snprintf(text[c], sizeof text[c],
		    horizons->nchans > 100 ? "tan.%03d" : "tan.%02d", c);
		names[c] = text[c];
	}
	add_scale_suffix(&path, o->scale[k], o->nscales);
	meta.layout = BAKE_LAYOUT_HORIZONS;
	exr.has_type = true;
	exr.type = BAKE_FILE_EXR;
	exr.has_data_format =
	    cmd->has_data_format && cmd->data_format == BAKE_DATA_HALF;
	ok = cmd_write(&exr, horizons, path, BAKE_DATA_FLOAT, &meta, names);
	cmd->written = exr.written;
	free(path);
	return ok;
}

/* The packed input once more, with one channel replaced by the AO. */
static bool
write_in_place(struct cmd *cmd, const struct opts *o, const char *in,
    const struct bake_image *ao, const char *path, double scale)
{
	struct cmd_map map = CMD_MAP_INIT;
	const char *names[BAKE_INFO_NAMES];
	bool quiet = cmd->quiet;
	int c;
	bool ok;

	cmd->quiet = true; /* its warnings have been seen */
	ok = cmd_read_raw(cmd, in, &map);
	cmd->quiet = quiet;
	if (!ok)
		return false;
	c = cmd_channel_index(&map.info, o->in_place);
	if (c < 0 || map.info.nchans > BAKE_INFO_NAMES) {
		cmd_error(
		    cmd, "%s: has no channel %s to rewrite", in, o->in_place);
		cmd_map_free(&map);
		return false;
	}
	bake_image_copy_channel(&map.img, c, ao, 0);
	/* the normals' scale stays what it was */
	if (map.meta.depth_scale == 0)
		map.meta.depth_scale = scale;
	bake_relief_meta_set_ao_scale(&map.meta, scale);
	for (int i = 0; i < map.info.nchans; i++)
		names[i] = map.info.names[i];
	ok = cmd_write(
	    cmd, &map.img, path, map.info.data_format, &map.meta, names);
	cmd_map_free(&map);
	return ok;
}

static bool
write_results(struct cmd *cmd, const struct opts *o, const char *in,
    const struct cmd_map *map, const struct bake_ao_result *res,
    struct bake_wrap wrap)
{
	struct bake_relief_meta meta = BAKE_RELIEF_META_INIT;
	bool ok = true;

	meta.layout = BAKE_LAYOUT_AO;
	meta.has_wrap = true;
	meta.wrap = wrap;
	for (int k = 0; ok && k < o->nscales; k++) {
		char *path = output_path(cmd, in);

		add_scale_suffix(&path, o->scale[k], o->nscales);
		meta.depth_scale = o->scale[k];
		if (o->in_place != NULL)
			ok = write_in_place(
			    cmd, o, in, &res->ao[k], path, o->scale[k]);
		else
			ok = cmd_write(cmd, &res->ao[k], path,
			    map->info.data_format, &meta, NULL);
		if (ok && o->bent != NULL)
			ok = write_bent(cmd, o, map, &res->bent[k], &meta, k);
		if (ok && o->horizons != NULL)
			ok =
			    write_horizons(cmd, o, &res->horizons[k], &meta, k);
		free(path);
	}
	return ok;
}

static bool
bake(struct cmd *cmd, const struct opts *o, struct cmd_map *map,
    struct bake_wrap wrap, const struct bake_ao_result *res)
{
	struct bake_ao_params p = o->ao;
	struct bake_err err = BAKE_ERR_INIT;
	struct cmd_progress bar;
	enum bake_status rc;

	p.wrap = wrap;
	p.nthreads = cmd->nthreads;
	p.progress = cmd_progress_start(cmd, &bar);
	rc = bake_ao(&map->img, o->scale, o->nscales, &p, res, &err);
	cmd_progress_end(&bar);
	if (rc != BAKE_OK)
		cmd_error(cmd, "%s: %s", map->path, err.msg);
	return rc == BAKE_OK;
}

static bool
bake_file(struct cmd *cmd, const struct opts *given, const char *in)
{
	struct opts o = *given;
	struct bake_image ao[MAX_SCALES] = { BAKE_IMAGE_INIT };
	struct bake_image bent[MAX_SCALES] = { BAKE_IMAGE_INIT };
	struct bake_image horizons[MAX_SCALES] = { BAKE_IMAGE_INIT };
	struct bake_ao_result res = { ao, o.bent ? bent : NULL,
		o.horizons ? horizons : NULL };
	struct cmd_map map = CMD_MAP_INIT;
	struct bake_wrap wrap;
	bool ok;

	if (!cmd_read_channel(cmd, in,
		o.channel == NULL && o.in_place != NULL ? "A" : o.channel,
		&map))
		return false;
	wrap = cmd_wrap(cmd, &map);
	if (o.nscales == 0) {
		o.nscales = 1;
		o.scale[0] =
		    map.meta.depth_scale > 0 ? map.meta.depth_scale : 0.1;
	}
	cmd_to_depth(cmd, &map);
	ok = cmd_smooth_steps(
		 cmd, &map, &map.img, o.scale[0], wrap, o.dequantize) &&
	     bake(cmd, &o, &map, wrap, &res) &&
	     write_results(cmd, &o, in, &map, &res, wrap);
	for (int k = 0; k < o.nscales; k++) {
		bake_image_free(&ao[k]);
		bake_image_free(&bent[k]);
		bake_image_free(&horizons[k]);
	}
	cmd_map_free(&map);
	return ok;
}

static int
bake_operand(struct cmd *cmd, int i, void *opts)
{
	cmd_recipe_begin(cmd, i);
	plan_outputs(cmd, opts, cmd->operands.item[i]);
	/* in place of its input a record would make each run's bytes new */
	if (cmd->output == NULL && cmd->output_dir == NULL)
		cmd_recipe_none(cmd);
	if (cmd_unchanged(cmd))
		return CMD_EXIT_OK;
	return bake_file(cmd, opts, cmd->operands.item[i]) ? CMD_EXIT_OK
							   : CMD_EXIT_FAIL;
}

static int
run(struct cmd *cmd, struct opts *o)
{
	int n = cmd->operands.n;

	/* in place means over the input where no output is given */
	if (!(o->in_place != NULL && n > 0 && cmd->output == NULL &&
		o->nscales < 2) &&
	    !cmd_inputs_fit(cmd, n))
		return CMD_EXIT_USAGE;
	if (o->nscales > 1 && cmd->output != NULL &&
	    strcmp(cmd->output, "-") == 0) {
		cmd_usage_error(cmd,
		    "%d depth scales make %d files, which standard output "
		    "cannot hold",
		    o->nscales, o->nscales);
		return CMD_EXIT_USAGE;
	}
	if (n > 1 && (o->bent != NULL || o->horizons != NULL)) {
		cmd_usage_error(
		    cmd, "--bent-normal and --horizons take one input");
		return CMD_EXIT_USAGE;
	}
	if (!cmd_outputs_differ(cmd, &cmd->operands))
		return CMD_EXIT_USAGE;
	return cmd_batch(cmd, &cmd->operands, bake_operand, o);
}

int
main(int argc, char *argv[])
{
	struct opts o = { .ao = BAKE_AO_PARAMS_DEFAULT };
	struct cmd_tool tool = { "rm-aobake", "IN ... -o OUT",
		"Bake ambient occlusion from depth maps or packed textures.",
		options,
		CMD_OPTS_OUTPUT | CMD_OPTS_RELIEF | CMD_OPTS_OUTPUT_NORMAL |
		    CMD_OPTS_TILES,
		set_option, &o, main, 28, marks };
	struct cmd cmd;
	int status;

	if (cmd_parse(&cmd, &tool, argc, argv, &status))
		status = run(&cmd, &o);
	return cmd_finish(&cmd, status);
}
