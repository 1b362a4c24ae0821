/* rm-rescale-ao: ambient occlusion after the depth scale has changed. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "ao_rescale.h"
#include "cmd.h"
#include "cmd_batch.h"
#include "cmd_image.h"
#include "cmd_recipe.h"
#include "rescale.h"

enum {
	KEY_BLUR = CMD_KEY_TOOL,
	KEY_BLUR_MODE,
	KEY_CHANNEL,
	KEY_COMPARE,
	KEY_ERROR_OUT,
	KEY_ESTIMATOR,
	KEY_FROM,
	KEY_HORIZONS,
	KEY_NO_BLUR,
	KEY_SCALE,
	KEY_TO
};

static const struct cmd_option options[] = {
	{ KEY_BLUR, "blur", "SIGMA",
	    "--horizons, --compare: rm-aobake's low-pass (default 1)" },
	{ KEY_BLUR_MODE, "blur-mode", "MODE",
	    "the same: {paper} (default) or {occluded}" },
	{ KEY_CHANNEL, "channel", "NAME",
	    "the AO's channel: {R}, {G}, {B}, {A}, its name or number" },
	{ KEY_COMPARE, "compare", "DEPTHMAP",
	    "bake this at the new scale and print how far the result is" },
	{ KEY_ERROR_OUT, "error-out", "FILE",
	    "with --compare: write the signed error as an image" },
	{ KEY_ESTIMATOR, "estimator", "NAME",
	    "--horizons, --compare: {polygon} (default) or {mean}" },
	{ KEY_FROM, "from", "A",
	    "the depth scale that the AO belongs to (default: the file's)" },
	{ KEY_HORIZONS, "horizons", "FILE",
	    "the exact answer, from what rm-aobake --horizons wrote" },
	{ KEY_NO_BLUR, "no-blur", NULL, "--horizons, --compare: no low-pass" },
	{ KEY_SCALE, "scale", "S", "new depth scale / old depth scale" },
	{ KEY_TO, "to", "B", "the new depth scale, instead of --scale" },
	{ 0, NULL, NULL, NULL },
};

static const struct cmd_mark marks[] = {
	{ "compare", CMD_ARG_REPORT | CMD_ARG_NEUTRAL, NULL },
	{ "error-out", CMD_ARG_NEUTRAL, NULL },
	{ "horizons", CMD_ARG_INPUT, NULL },
	{ NULL, 0, NULL },
};

struct opts {
	double scale, from, to; /* < 0: not given */
	const char *channel, *compare, *error_out, *horizons;
	struct bake_ao_rescale_params bake;
	bool has_bake;
};

static bool
set_bake_option(struct cmd *cmd, struct opts *o, int key, const char *arg)
{
	static const char *const estimators[] = { "polygon", "mean" };
	static const char *const blurs[] = { "paper", "occluded" };
	int i;

	o->has_bake = true;
	switch (key) {
	case KEY_BLUR:
		return cmd_number(cmd, "blur", arg, 0, 64, &o->bake.blur_sigma);
	case KEY_BLUR_MODE:
		if (!cmd_choice(cmd, "blur-mode", arg, blurs, 2, &i))
			return false;
		if (o->bake.blur != BAKE_AO_BLUR_NONE)
			o->bake.blur =
			    i == 0 ? BAKE_AO_BLUR_PAPER : BAKE_AO_BLUR_OCCLUDED;
		return true;
	case KEY_ESTIMATOR:
		if (!cmd_choice(cmd, "estimator", arg, estimators, 2, &i))
			return false;
		o->bake.estimator = (enum bake_ao_estimator)i;
		return true;
	default:
		o->bake.blur = BAKE_AO_BLUR_NONE;
		return true;
	}
}

static bool
set_option(struct cmd *cmd, int key, const char *arg)
{
	struct opts *o = cmd->tool->opts;

	switch (key) {
	case KEY_CHANNEL:
		o->channel = arg;
		return true;
	case KEY_COMPARE:
		o->compare = arg;
		return true;
	case KEY_ERROR_OUT:
		o->error_out = arg;
		return true;
	case KEY_FROM:
		return cmd_number(cmd, "from", arg, 1e-6, 1e6, &o->from);
	case KEY_HORIZONS:
		o->horizons = arg;
		return true;
	case KEY_SCALE:
		return cmd_number(cmd, "scale", arg, 0, 1e6, &o->scale);
	case KEY_TO:
		return cmd_number(cmd, "to", arg, 0, 1e6, &o->to);
	default:
		return set_bake_option(cmd, o, key, arg);
	}
}

/* One input's way from its old depth scale to the new one. */
struct change {
	double s;        /* for Eq. 6 */
	double horizons; /* for the horizons */
	double to;       /* < 0: not known */
};

/* horizons: their depth scale; < 0: not said. */
static bool
find_change(struct cmd *cmd, const struct opts *o, const struct rescale_file *f,
    double horizons, struct change *c)
{
	double from = o->from >= 0 ? o->from : f->scale, s;

	if (o->from >= 0 && f->scale > 0 && (float)o->from != (float)f->scale)
		cmd_warn(cmd,
		    "%s: its metadata say depth scale %.6g, --from %.6g is "
		    "taken",
		    f->map.path, f->scale, o->from);
	if (from < 0)
		from = horizons;
	if (horizons < 0)
		horizons = from;
	if (o->scale < 0 && from < 0) {
		cmd_error(cmd,
		    "%s: does not say which depth scale its AO belongs to; "
		    "give --from A",
		    f->map.path);
		return false;
	}
	c->to = o->to >= 0 ? o->to : from >= 0 ? from * o->scale : -1;
	c->s = o->scale >= 0 ? o->scale : o->to / from;
	c->horizons = horizons > 0 ? c->to / horizons : c->s;
	/* nothing is left of AO at depth scale 0 to tell another from */
	if ((o->horizons == NULL ? from : horizons) == 0 && c->s != 1) {
		cmd_error(cmd,
		    "%s: belongs to depth scale 0, where all is open; "
		    "rm-aobake -s S bakes it anew",
		    o->horizons == NULL ? f->map.path : o->horizons);
		return false;
	}
	s = o->horizons == NULL ? c->s : c->horizons;
	if (s > 1e6)
		cmd_error(cmd, "%s: rescaled by %.6g, expected 0 to 1e6",
		    f->map.path, s);
	return s <= 1e6;
}

/* -- the exact answer ---------------------------------------------------- */

static bool
read_horizons(struct cmd *cmd, const char *path, struct cmd_map *map)
{
	bool tans = true;

	if (!cmd_read_raw(cmd, path, map))
		return false;
	for (int c = 0; c < map->info.nchans && c < BAKE_INFO_NAMES; c++) {
		char name[16];

		snprintf(name, sizeof name,
		    map->info.nchans > 100 ? "tan.%03d" : "tan.%02d", c);
		tans &= strcmp(map->info.names[c], name) == 0;
	}
	if (!tans) {
		cmd_error(cmd,
		    "%s: holds no horizons (channels tan.00, tan.01 ...); "
		    "rm-aobake --horizons FILE writes them",
		    map->path);
		cmd_map_free(map);
	}
	return tans;
}

static bool
from_horizons(struct cmd *cmd, const struct opts *o,
    const struct rescale_file *f, const struct cmd_map *horizons, double s,
    struct bake_image *ao)
{
	struct bake_ao_rescale_params p = o->bake;
	struct bake_err err = BAKE_ERR_INIT;

	if (horizons->info.width != f->map.info.width ||
	    horizons->info.height != f->map.info.height) {
		cmd_error(cmd, "%s: is %dx%d, expected %dx%d as %s",
		    horizons->path, horizons->info.width, horizons->info.height,
		    f->map.info.width, f->map.info.height, f->map.path);
		return false;
	}
	p.wrap = cmd_wrap(cmd, horizons);
	p.nthreads = cmd->nthreads;
	if (bake_ao_rescale_horizons(&horizons->img, s, &p, ao, &err) ==
	    BAKE_OK)
		return true;
	cmd_error(cmd, "%s: %s", horizons->path, err.msg);
	return false;
}

/* -- how far from the truth ---------------------------------------------- */

/* The truth: a bake at the new scale, as the options of the blur say. */
static bool
bake_truth(struct cmd *cmd, const struct opts *o, double scale, int ndirs,
    struct bake_image *truth)
{
	struct bake_ao_params p = BAKE_AO_PARAMS_DEFAULT;
	struct bake_ao_result res = { truth, NULL, NULL };
	struct bake_err err = BAKE_ERR_INIT;
	struct cmd_map depth = CMD_MAP_INIT;
	struct cmd_progress bar;
	enum bake_status rc;

	if (!cmd_read_channel(cmd, o->compare, NULL, &depth))
		return false;
	p.wrap = cmd_wrap(cmd, &depth);
	cmd_to_depth(cmd, &depth);
	cmd_smooth_steps(cmd, &depth, &depth.img, scale, p.wrap, false);
	p.ndirs = ndirs > 0 ? ndirs : p.ndirs;
	p.estimator = o->bake.estimator;
	p.blur = o->bake.blur;
	p.blur_sigma = o->bake.blur_sigma;
	p.nthreads = cmd->nthreads;
	p.progress = cmd_progress_start(cmd, &bar);
	rc = bake_ao(&depth.img, &scale, 1, &p, &res, &err);
	cmd_progress_end(&bar);
	if (rc != BAKE_OK)
		cmd_error(cmd, "%s: %s", depth.path, err.msg);
	cmd_map_free(&depth);
	return rc == BAKE_OK;
}

static bool
write_error(struct cmd *cmd, const char *path, struct bake_image *error)
{
	struct cmd out = *cmd;
	enum bake_file_type type;
	enum bake_data_format format;
	bool ok;

	if (!bake_file_type_from_path(path, &type)) {
		cmd_error(cmd, CMD_NO_TYPE, path);
		return false;
	}
	out.has_type = out.has_data_format = false;
	format = bake_file_type_nearest(type, BAKE_DATA_UINT16);
	/* codes have no sign: no error is a half */
	for (int y = 0; bake_data_format_max(format) != 0 && y < error->height;
	     y++)
		for (int x = 0; x < error->width; x++)
			bake_image_row(error, y)[x] =
			    0.5f + 0.5f * bake_image_row(error, y)[x];
	ok = cmd_write(&out, error, path, format, NULL, NULL);
	cmd->written = out.written;
	cmd->warnings = out.warnings;
	return ok;
}

static bool
compare(struct cmd *cmd, const struct opts *o, const struct rescale_file *f,
    const struct bake_image *ao, double scale, int ndirs)
{
	struct bake_image truth = BAKE_IMAGE_INIT, error = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_ao_error e;
	bool ok;

	if (scale < 0) {
		cmd_error(cmd,
		    "%s: does not say which depth scale its AO belongs to; "
		    "give --from A",
		    f->map.path);
		return false;
	}
	ok = bake_truth(cmd, o, scale, ndirs, &truth);
	if (ok && bake_ao_compare(ao, &truth, &e, o->error_out ? &error : NULL,
		      &err) != BAKE_OK) {
		cmd_error(
		    cmd, "%s: %s of %s", f->map.path, err.msg, o->compare);
		ok = false;
	}
	if (ok)
		printf("%s: depth scale %.6g: mean error %.4f, 99 %% within "
		       "%.4f, largest %.4f at %d,%d, bias %+.4f\n",
		    f->map.path, scale, e.mean, e.p99, e.max, e.x, e.y, e.bias);
	if (ok && o->error_out != NULL)
		ok = write_error(cmd, o->error_out, &error);
	bake_image_free(&truth);
	bake_image_free(&error);
	return ok;
}

/* -- files --------------------------------------------------------------- */

static bool
rescale_ao(struct cmd *cmd, const struct opts *o, const struct rescale_file *f,
    const struct cmd_map *horizons, const struct change *c,
    struct bake_image *ao)
{
	struct bake_err err = BAKE_ERR_INIT;

	if (horizons != NULL)
		return from_horizons(cmd, o, f, horizons, c->horizons, ao);
	if (!rescale_take(cmd, f, ao))
		return false;
	if (bake_ao_rescale_image(ao, 0, c->s, cmd->nthreads, &err) == BAKE_OK)
		return true;
	cmd_error(cmd, "%s: %s", f->map.path, err.msg);
	return false;
}

static bool
write_result(struct cmd *cmd, struct rescale_file *f,
    const struct bake_image *ao, double scale, const char *in)
{
	char *path;
	bool ok;

	if (cmd->output == NULL && cmd->output_dir == NULL)
		return true; /* --compare alone */
	path = cmd_output_path(cmd, in, "");
	ok = path != NULL && rescale_write(cmd, f, ao, scale, path);
	free(path);
	return ok;
}

static bool
rescale_one(struct cmd *cmd, const struct opts *o, const char *in)
{
	struct cmd_map horizons = CMD_MAP_INIT;
	struct bake_image ao = BAKE_IMAGE_INIT;
	const bool exact = o->horizons != NULL;
	struct rescale_file f;
	struct change c;
	bool ok;

	ok = rescale_open(cmd, in, o->channel, &f) &&
	     (!exact || read_horizons(cmd, o->horizons, &horizons)) &&
	     find_change(cmd, o, &f,
		 horizons.meta.depth_scale > 0 ? horizons.meta.depth_scale : -1,
		 &c) &&
	     rescale_ao(cmd, o, &f, exact ? &horizons : NULL, &c, &ao) &&
	     (o->compare == NULL ||
		 compare(cmd, o, &f, &ao, c.to, horizons.info.nchans)) &&
	     write_result(cmd, &f, &ao, c.to, in);
	bake_image_free(&ao);
	cmd_map_free(&horizons);
	rescale_close(&f);
	return ok;
}

/* What goes with what; false with a usage error. */
static bool
opts_agree(const struct cmd *cmd, const struct opts *o)
{
	const int n = cmd->operands.n;

	if (o->scale < 0 && o->to < 0)
		return cmd_usage_error(
		    cmd, "by how much? give --scale S or --to B");
	if (o->scale >= 0 && o->to >= 0)
		return cmd_usage_error(
		    cmd, "--scale and --to exclude each other");
	if (o->has_bake && o->horizons == NULL && o->compare == NULL)
		return cmd_usage_error(cmd,
		    "--blur, --blur-mode, --estimator and --no-blur go with "
		    "--horizons or --compare");
	if (o->error_out != NULL && o->compare == NULL)
		return cmd_usage_error(
		    cmd, "--error-out goes with --compare DEPTHMAP");
	if (n > 1 && (o->horizons != NULL || o->compare != NULL))
		return cmd_usage_error(
		    cmd, "--horizons and --compare take one input");
	if (o->compare != NULL && cmd->output != NULL &&
	    strcmp(cmd->output, "-") == 0)
		return cmd_usage_error(cmd,
		    "--compare prints to standard output, which cannot hold "
		    "the image as well");
	if (n == 1 && o->compare != NULL && cmd->output == NULL &&
	    cmd->output_dir == NULL)
		return true;
	return cmd_inputs_fit(cmd, n) &&
	       cmd_outputs_differ(cmd, &cmd->operands);
}

static int
rescale_operand(struct cmd *cmd, int i, void *opts)
{
	const char *in = cmd->operands.item[i];
	char *path = NULL;

	if (cmd->output != NULL || cmd->output_dir != NULL)
		path = cmd_output_path(cmd, in, "");
	cmd_recipe_begin(cmd, i);
	cmd_recipe_output(cmd, path, "ao");
	free(path);
	return cmd_unchanged(cmd) || rescale_one(cmd, opts, in) ? CMD_EXIT_OK
								: CMD_EXIT_FAIL;
}

static int
run(struct cmd *cmd, struct opts *o)
{
	return opts_agree(cmd, o)
		   ? cmd_batch(cmd, &cmd->operands, rescale_operand, o)
		   : CMD_EXIT_USAGE;
}

int
main(int argc, char *argv[])
{
	struct opts o = { .scale = -1,
		.from = -1,
		.to = -1,
		.bake = BAKE_AO_RESCALE_PARAMS_DEFAULT };
	struct cmd_tool tool = { "rm-rescale-ao", "IN ... -o OUT",
		"Ambient occlusion after its relief was made deeper or "
		"flatter.",
		options, CMD_OPTS_OUTPUT | CMD_OPTS_RELIEF | CMD_OPTS_TILES,
		set_option, &o, main, 48, marks };
	struct cmd cmd;
	int status;

	if (cmd_parse(&cmd, &tool, argc, argv, &status))
		status = run(&cmd, &o);
	return cmd_finish(&cmd, status);
}
