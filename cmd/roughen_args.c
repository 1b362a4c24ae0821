/* rm-roughen's command line. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "cmd_recipe.h"
#include "roughen_tool.h"

enum {
	KEY_ANGLE = CMD_KEY_TOOL,
	KEY_ANGLE_MAP,
	KEY_ANGLE_UNIT,
	KEY_ANGLES,
	KEY_AT,
	KEY_AZIMUTH,
	KEY_COLOR_SPACE,
	KEY_CONTRAST,
	KEY_CYLINDER,
	KEY_ENCODED,
	KEY_FIT,
	KEY_FIT_DEPTH,
	KEY_LIGHT,
	KEY_LUMA,
	KEY_LUT,
	KEY_LUT_SIZE,
	KEY_MEDIAN,
	KEY_MODEL,
	KEY_NORMAL_MAP,
	KEY_PLOT,
	KEY_RENDER,
	KEY_SHEET,
	KEY_STRENGTH
};

const struct cmd_option roughen_options[] = {
	{ KEY_ANGLE, "angle", "DEG",
	    "angle of incidence, 0 along the normal, 0 to 180" },
	{ KEY_ANGLE_MAP, "angle-map", "FILE", "the angle at each texel" },
	{ KEY_ANGLE_UNIT, "angle-unit", "NAME",
	    "of its values: {quarter} (default), {degrees} or {cosine}" },
	{ KEY_ANGLES, "angles", "LIST",
	    "of reports, in degrees (default 10,20,30,40,50,60,70,80)" },
	{ KEY_AT, "at", "DEG",
	    "the angle of --fit's reference, or --render's (default 10)" },
	{ KEY_AZIMUTH, "azimuth", "DEG",
	    "--fit-depth: where the light is, from the right (default 0)" },
	{ KEY_COLOR_SPACE, "color-space", "NAME",
	    "of the files (default: sRGB, half and float scene-linear)" },
	{ KEY_CONTRAST, "contrast", NULL,
	    "print percentiles and contrast at each of --angles" },
	{ KEY_CYLINDER, "cylinder", "FILE",
	    "draw four cylinders, as the paper's figure 1" },
	{ 's', "depth-scale", "S",
	    "--fit-depth: depth range / texture width (default 0.1)" },
	{ KEY_ENCODED, "encoded", NULL,
	    "remap the files' values, as the paper, not light" },
	{ KEY_FIT, "fit", "REFERENCE",
	    "find the strength that gives this picture's contrast" },
	{ KEY_FIT_DEPTH, "fit-depth", "DEPTHMAP",
	    "find the strength that is nearest to this relief's contrast" },
	{ KEY_LIGHT, "light", "X,Y,Z",
	    "--normal-map: towards the light; x right, y up, z out" },
	{ KEY_LUMA, "luma", "R,G,B",
	    "weights of luminance (default 0.2126,0.7152,0.0722)" },
	{ KEY_LUT, "lut", "FILE", "write the remap as a table for shaders" },
	{ KEY_LUT_SIZE, "lut-size", "WxH", "of the table (default 64x64)" },
	{ KEY_MEDIAN, "median", "auto|M",
	    "median luminance (default auto: the texture's)" },
	{ KEY_MODEL, "model", "NAME",
	    "{facet} (default), {paper}, {blackshot} or {flat}" },
	{ KEY_NORMAL_MAP, "normal-map", "FILE",
	    "the angle at each texel, by its normal and --light" },
	{ KEY_PLOT, "plot", "FILE", "draw what --contrast prints" },
	{ KEY_RENDER, "render", "FILE",
	    "--fit-depth: write the relief as lit at --at" },
	{ KEY_SHEET, "sheet", "FILE",
	    "draw all models at --angles, as the paper's figure 3" },
	{ KEY_STRENGTH, "strength", "S", "how rough, 0 to 1 (default 0.09)" },
	{ 0, NULL, NULL, NULL },
};

const struct cmd_mark roughen_marks[] = {
	{ "angle-map", CMD_ARG_INPUT, NULL },
	{ "contrast", CMD_ARG_REPORT | CMD_ARG_NEUTRAL, NULL },
	{ "cylinder", CMD_ARG_NEUTRAL, NULL },
	{ "fit", CMD_ARG_INPUT | CMD_ARG_REPORT, NULL },
	{ "fit-depth", CMD_ARG_INPUT | CMD_ARG_REPORT, NULL },
	{ "lut", CMD_ARG_NEUTRAL, NULL },
	{ "normal-map", CMD_ARG_INPUT, NULL },
	{ "plot", CMD_ARG_NEUTRAL, NULL },
	{ "render", CMD_ARG_NEUTRAL, NULL },
	{ "sheet", CMD_ARG_NEUTRAL, NULL },
	{ NULL, 0, NULL },
};

static bool
set_model(struct cmd *cmd, struct roughen_opts *o, const char *arg)
{
	static const char *const names[] = { "facet", "paper", "blackshot",
		"flat" };
	int i;

	if (!cmd_choice(cmd, "model", arg, names, 4, &i))
		return false;
	for (int m = 0; m < BAKE_ROUGHEN_MODELS; m++)
		if (strcmp(names[i],
			bake_roughen_name((enum bake_roughen_model)m)) == 0)
			o->model = (enum bake_roughen_model)m;
	o->has_model = true;
	return true;
}

static bool
set_triple(struct cmd *cmd, const char *option, const char *arg, double lo,
    double hi, double v[3])
{
	int n;

	if (!cmd_numbers(cmd, option, arg, lo, hi, v, 3, &n))
		return false;
	if (n == 3 && (v[0] != 0 || v[1] != 0 || v[2] != 0))
		return true;
	return cmd_usage_error(cmd,
	    "--%s is '%s', expected three numbers, not all 0", option, arg);
}

static bool
set_luma(struct cmd *cmd, struct roughen_opts *o, const char *arg)
{
	double sum;

	if (!set_triple(cmd, "luma", arg, 0, 1e6, o->luma))
		return false;
	o->has_luma = true;
	sum = o->luma[0] + o->luma[1] + o->luma[2];
	for (int c = 0; c < 3; c++)
		o->luma[c] /= sum;
	return true;
}

static bool
set_light(struct cmd *cmd, struct roughen_opts *o, const char *arg)
{
	o->has_light = true;
	return set_triple(cmd, "light", arg, -1e6, 1e6, o->light);
}

static bool
set_unit(struct cmd *cmd, struct roughen_opts *o, const char *arg)
{
	static const char *const units[] = { "quarter", "degrees", "cosine" };
	int i;

	if (!cmd_choice(cmd, "angle-unit", arg, units, 3, &i))
		return false;
	o->unit = (enum roughen_unit)i;
	o->has_unit = true;
	return true;
}

static bool
set_file(struct roughen_opts *o, int key, const char *arg)
{
	switch (key) {
	case KEY_CYLINDER:
		o->cylinder = arg;
		break;
	case KEY_LUT:
		o->lut = arg;
		break;
	case KEY_PLOT:
		o->plot = arg;
		break;
	case KEY_RENDER:
		o->render = arg;
		break;
	case KEY_SHEET:
		o->sheet = arg;
		break;
	case KEY_FIT:
		o->fit = arg;
		break;
	case KEY_FIT_DEPTH:
		o->fit_depth = arg;
		break;
	case KEY_ANGLE_MAP:
		o->angle_map = arg;
		break;
	default:
		o->normal_map = arg;
		break;
	}
	return true;
}

static bool
set_number(struct cmd *cmd, struct roughen_opts *o, int key, const char *arg)
{
	switch (key) {
	case KEY_ANGLE:
		o->has_angle = true;
		return cmd_number(cmd, "angle", arg, 0, 180, &o->angle);
	case KEY_ANGLES:
		o->has_angles = true;
		return cmd_numbers(cmd, "angles", arg, 0, 89.99, o->angles,
		    BAKE_ROUGHEN_ANGLES, &o->nangles);
	case KEY_AT:
		o->has_at = true;
		return cmd_number(cmd, "at", arg, 0, 89.99, &o->at);
	case KEY_AZIMUTH:
		o->has_azimuth = true;
		return cmd_number(cmd, "azimuth", arg, -360, 360, &o->azimuth);
	case KEY_LUT_SIZE:
		o->has_lut_size = true;
		return cmd_size(
		    cmd, "lut-size", arg, &o->lut_width, &o->lut_height);
	case KEY_MEDIAN:
		o->median = 0;
		return strcmp(arg, "auto") == 0 ||
		       cmd_number(cmd, "median", arg, 1e-6, 1e6, &o->median);
	case KEY_STRENGTH:
		o->has_strength = true;
		return cmd_number(cmd, "strength", arg, 0, 1, &o->strength);
	default:
		return cmd_number(
		    cmd, "depth-scale", arg, 0, 1e6, &o->depth_scale);
	}
}

bool
roughen_set(struct cmd *cmd, int key, const char *arg)
{
	struct roughen_opts *o = cmd->tool->opts;

	switch (key) {
	case KEY_ANGLE_UNIT:
		return set_unit(cmd, o, arg);
	case KEY_COLOR_SPACE:
		o->space = arg;
		return true;
	case KEY_CONTRAST:
		o->contrast = true;
		return true;
	case KEY_ENCODED:
		o->encoded = true;
		return true;
	case KEY_LIGHT:
		return set_light(cmd, o, arg);
	case KEY_LUMA:
		return set_luma(cmd, o, arg);
	case KEY_MODEL:
		return set_model(cmd, o, arg);
	case KEY_ANGLE_MAP:
	case KEY_CYLINDER:
	case KEY_FIT:
	case KEY_FIT_DEPTH:
	case KEY_LUT:
	case KEY_NORMAL_MAP:
	case KEY_PLOT:
	case KEY_RENDER:
	case KEY_SHEET:
		return set_file(o, key, arg);
	default:
		return set_number(cmd, o, key, arg);
	}
}

bool
roughen_reports(const struct roughen_opts *o)
{
	return o->contrast || o->lut != NULL || o->plot != NULL ||
	       o->sheet != NULL || o->cylinder != NULL || o->fit != NULL ||
	       o->fit_depth != NULL;
}

/* -- what goes with what --------------------------------------------------- */

static bool
angle_is_clear(const struct cmd *cmd, const struct roughen_opts *o)
{
	const int n =
	    o->has_angle + (o->angle_map != NULL) + (o->normal_map != NULL);

	if (n > 1)
		return cmd_usage_error(cmd,
		    "--angle, --angle-map and --normal-map exclude each other");
	if (o->has_light != (o->normal_map != NULL))
		return cmd_usage_error(
		    cmd, "--normal-map FILE and --light X,Y,Z go together");
	if (o->has_unit && o->angle_map == NULL)
		return cmd_usage_error(
		    cmd, "--angle-unit goes with --angle-map FILE");
	if (n == 0 && (cmd->output != NULL || cmd->output_dir != NULL))
		return cmd_usage_error(cmd,
		    "lit from where? give --angle DEG, --angle-map FILE or "
		    "--normal-map FILE --light X,Y,Z");
	if (n > 0 && cmd->output == NULL && cmd->output_dir == NULL)
		return cmd_usage_error(
		    cmd, "no output: give -o FILE or -O DIR");
	return true;
}

static bool
fit_is_clear(const struct cmd *cmd, const struct roughen_opts *o)
{
	if (o->fit != NULL && o->fit_depth != NULL)
		return cmd_usage_error(
		    cmd, "--fit and --fit-depth exclude each other");
	if (o->fit != NULL && !o->has_at)
		return cmd_usage_error(
		    cmd, "--fit REFERENCE needs --at DEG, its angle");
	if (o->has_at && o->fit == NULL && o->fit_depth == NULL)
		return cmd_usage_error(
		    cmd, "--at goes with --fit or --fit-depth");
	if ((o->depth_scale >= 0 || o->has_azimuth || o->render != NULL) &&
	    o->fit_depth == NULL)
		return cmd_usage_error(cmd,
		    "--azimuth, --depth-scale and --render go with "
		    "--fit-depth D");
	if (o->has_strength && (o->fit != NULL || o->fit_depth != NULL))
		return cmd_usage_error(
		    cmd, "--strength is what --fit and --fit-depth find");
	if (o->fit != NULL && o->model == BAKE_ROUGHEN_FLAT)
		return cmd_usage_error(
		    cmd, "--model flat has no strength to fit");
	return true;
}

static bool
reports_are_clear(const struct cmd *cmd, const struct roughen_opts *o)
{
	const bool prints =
	    o->contrast || o->fit != NULL || o->fit_depth != NULL;

	if (prints && cmd->output != NULL && strcmp(cmd->output, "-") == 0)
		return cmd_usage_error(cmd,
		    "--contrast, --fit and --fit-depth print to standard "
		    "output, which cannot hold the image as well");
	if (o->contrast && (o->fit != NULL || o->fit_depth != NULL))
		return cmd_usage_error(cmd,
		    "--contrast prints a table, and so do --fit and "
		    "--fit-depth: one at a time");
	if (o->lut != NULL && o->model == BAKE_ROUGHEN_BLACKSHOT)
		return cmd_usage_error(cmd,
		    "--model blackshot has an edge that moves with the angle, "
		    "which no --lut holds; rm-roughen(1) has its one line of "
		    "shader code");
	if (o->has_lut_size && o->lut == NULL)
		return cmd_usage_error(cmd, "--lut-size goes with --lut FILE");
	if (o->lut_width < BAKE_ROUGHEN_LUT_MIN ||
	    o->lut_height < BAKE_ROUGHEN_LUT_MIN ||
	    o->lut_width > BAKE_ROUGHEN_LUT_MAX ||
	    o->lut_height > BAKE_ROUGHEN_LUT_MAX)
		return cmd_usage_error(cmd,
		    "--lut-size is %dx%d, expected %d to %d each way",
		    o->lut_width, o->lut_height, BAKE_ROUGHEN_LUT_MIN,
		    BAKE_ROUGHEN_LUT_MAX);
	if (o->encoded && o->space != NULL)
		return cmd_usage_error(cmd,
		    "--encoded leaves the values as they are: no "
		    "--color-space");
	return true;
}

bool
roughen_args_are_clear(const struct cmd *cmd, const struct roughen_opts *o)
{
	const int n = cmd->operands.n;
	const bool to_file = cmd->output != NULL || cmd->output_dir != NULL;

	if (!angle_is_clear(cmd, o) || !fit_is_clear(cmd, o) ||
	    !reports_are_clear(cmd, o))
		return false;
	if (n == 0 && o->fit_depth != NULL && !to_file)
		return true;
	if (!roughen_reports(o))
		return cmd_inputs_fit(cmd, n) &&
		       cmd_outputs_differ(cmd, &cmd->operands);
	if (n == 0)
		return cmd_usage_error(cmd, "no input");
	if (n > 1)
		return cmd_usage_error(
		    cmd, "%d inputs: tables, pictures and fits are of one", n);
	return true;
}
