/* rm-render: its options. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "cmd_recipe.h"
#include "render_tool.h"

enum {
	KEY_AMBIENT = CMD_KEY_TOOL,
	KEY_AO,
	KEY_AO_BLEND,
	KEY_BACKGROUND,
	KEY_BASE_COLOR,
	KEY_BUFFERS,
	KEY_CAMERA,
	KEY_COLOR,
	KEY_COMPARE,
	KEY_DEPTH,
	KEY_DEPTH_BIAS,
	KEY_DEPTH_WEIGHT,
	KEY_DETAIL,
	KEY_DIFFERENCE,
	KEY_FOV,
	KEY_GROUND,
	KEY_HORIZONS,
	KEY_IMPOSTOR,
	KEY_LAYER_DEPTH_SCALE,
	KEY_LIGHT,
	KEY_LIGHT_SIZE,
	KEY_MODEL,
	KEY_MULTILAYER,
	KEY_NORMAL_BLEND,
	KEY_NORMAL_WEIGHT,
	KEY_OFFSET,
	KEY_ORTHOGRAPHIC,
	KEY_PAINT,
	KEY_POINT_LIGHT,
	KEY_QUADRIC,
	KEY_RELIEF,
	KEY_REPEAT,
	KEY_ROTATE,
	KEY_ROUGHEN,
	KEY_SAMPLES,
	KEY_SCALE,
	KEY_SEARCH,
	KEY_SHADOW,
	KEY_SHAPE,
	KEY_SHININESS,
	KEY_SILHOUETTE,
	KEY_SIZE,
	KEY_SPECULAR,
	KEY_TARGET,
	KEY_TRANSLATE,
	KEY_TURNTABLE,
	KEY_TWO_SIDED
};

const struct cmd_option render_options[] = {
	{ KEY_AMBIENT, "ambient", "A", "light from everywhere (default 0.3)" },
	{ KEY_AO, "ao", "on|off", "the relief's occlusion (on)" },
	{ KEY_AO_BLEND, "ao-blend", "NAME",
	    "of layers: {multiply} (default) or {min}" },
	{ KEY_BACKGROUND, "background", "R,G,B[,A]",
	    "scene-linear (default 0.02,0.02,0.02)" },
	{ KEY_BASE_COLOR, "base-color", "R,G,B",
	    "of the object, scene-linear (default 0.6,0.6,0.6)" },
	{ KEY_BUFFERS, "buffers", "FILE",
	    "EXR of colour, depth, normal, AO, uv and hit mask" },
	{ KEY_CAMERA, "camera", "YAW,PITCH[,DIST]",
	    "degrees, and distance in the scene's radii (30,25,3); or "
	    "EX,EY,EZ,TX,TY,TZ: eye and target" },
	{ KEY_COLOR, "color", "FILE", "the object's colour texture" },
	{ KEY_COMPARE, "compare", "FILE",
	    "against the buffers of another picture: print PSNR, depth "
	    "error, mask IoU" },
	{ KEY_DEPTH, "depth", "D", "depth range of the relief in mesh units" },
	{ KEY_DEPTH_BIAS, "depth-bias", NULL,
	    "multilayer: flatter where it is seen at a slant, as the paper's "
	    "appendix" },
	{ 's', "depth-scale", "S",
	    "depth range / texture width (default: the file's, else 0.1)" },
	{ KEY_DEPTH_WEIGHT, "depth-weight", "W", "of the next layer's depth" },
	{ KEY_DETAIL, "detail", "N",
	    "segments of a built-in shape's side (default 16)" },
	{ KEY_DIFFERENCE, "difference", "FILE",
	    "with --compare: the difference as a picture" },
	{ KEY_FOV, "fov", "DEG", "vertical angle of view (default 40)" },
	{ KEY_GROUND, "ground", "FILE",
	    "multilayer: what is seen through its holes is this colour" },
	{ KEY_HORIZONS, "horizons", "FILE",
	    "of the relief, from rm-aobake: its shadows are soft" },
	{ KEY_IMPOSTOR, "impostor", "PREFIX",
	    "a box filled by what rm-multilayer wrote" },
	{ KEY_LAYER_DEPTH_SCALE, "layer-depth-scale", "S",
	    "that the next layer was made for" },
	{ KEY_LIGHT, "light", "X,Y,Z",
	    "direction to the light (default -1,2,1.5)" },
	{ KEY_LIGHT_SIZE, "light-size", "DEG",
	    "radius of the light, for --horizons (default 5)" },
	{ KEY_MODEL, "model", "NAME",
	    "of --roughen: {paper}, {facet} (default), {blackshot} or {flat}" },
	{ KEY_MULTILAYER, "multilayer", "PREFIX",
	    "on the object: what rm-multilayer wrote" },
	{ KEY_NORMAL_BLEND, "normal-blend", "NAME",
	    "of layers: {pd} (default) or {seed}" },
	{ KEY_NORMAL_WEIGHT, "normal-weight", "W",
	    "of the next layer's normals" },
	{ KEY_OFFSET, "offset", "U,V", "of the next layer, in repeats" },
	{ KEY_ORTHOGRAPHIC, "orthographic", "H",
	    "no perspective; the picture is H mesh units high" },
	{ KEY_PAINT, "paint", "NAME",
	    "the quadrics' {a}, {b} or {mean-curvature} on the mesh" },
	{ KEY_POINT_LIGHT, "point-light", "X,Y,Z", "a light at that place" },
	{ KEY_QUADRIC, "quadric", "NAME",
	    "{auto} (default: computed), {none}, or a {FILE} of rm-quadfit" },
	{ KEY_RELIEF, "relief", "FILE",
	    "a packed texture; more than one are blended" },
	{ KEY_REPEAT, "repeat", "F[xF]",
	    "of relief and colour over the object's UVs (1)" },
	{ KEY_ROTATE, "rotate", "X,Y,Z",
	    "the object, degrees about these axes in turn" },
	{ KEY_ROUGHEN, "roughen", "S",
	    "2.5D texture mapping of its colour, strength S" },
	{ KEY_SAMPLES, "samples", "N", "a pixel: {1} (default), {4} or {16}" },
	{ KEY_SCALE, "scale", "K", "the object" },
	{ KEY_SEARCH, "search", "NAME",
	    "{exact}, {texel} or L,B: linear and binary steps (default 32,6)" },
	{ KEY_SHADOW, "shadow", NULL, "the relief's shadows on itself" },
	{ KEY_SHAPE, "shape", "NAME",
	    "{plane} (default), {cube}, {sphere}, {cylinder}, {torus}, "
	    "{teapot} "
	    "or a {MESH}; begins an object" },
	{ KEY_SHININESS, "shininess", "N",
	    "the highlight's exponent (default 40)" },
	{ KEY_SILHOUETTE, "silhouette", "NAME",
	    "{none} (default), {quadric} or {shell}" },
	{ KEY_SIZE, "size", "WxH", "of the picture (default 640x480)" },
	{ KEY_SPECULAR, "specular", "K", "the highlight (default 0.1)" },
	{ KEY_TARGET, "target", "X,Y,Z",
	    "where the camera looks (default: the scene's middle)" },
	{ 't', "tile", "F[xF]", "repeats of the next layer" },
	{ KEY_TRANSLATE, "translate", "X,Y,Z", "the object" },
	{ KEY_TURNTABLE, "turntable", "N",
	    "N pictures once round: OUT_0001.png …" },
	{ KEY_TWO_SIDED, "two-sided", NULL, "backs of the object are seen" },
	{ 'w', "weight", "W", "of the next layer" },
	{ 0, NULL, NULL, NULL },
};

const struct cmd_mark render_marks[] = {
	{ "buffers", CMD_ARG_NEUTRAL, NULL },
	{ "color", CMD_ARG_INPUT, NULL },
	{ "compare", CMD_ARG_REPORT | CMD_ARG_NEUTRAL, NULL },
	{ "difference", CMD_ARG_NEUTRAL, NULL },
	{ "ground", CMD_ARG_INPUT, NULL },
	{ "horizons", CMD_ARG_INPUT, NULL },
	{ "impostor", CMD_ARG_PREFIX, NULL },
	{ "multilayer", CMD_ARG_PREFIX, NULL },
	{ "quadric", CMD_ARG_INPUT, " auto none " },
	{ "relief", CMD_ARG_INPUT, NULL },
	{ "shape", CMD_ARG_INPUT, " plane cube sphere cylinder torus teapot " },
	{ NULL, 0, NULL },
};

static struct render_object_opts *
object(struct render_opts *o)
{
	return &o->object[o->nobjects - 1];
}

/* -- layers ------------------------------------------------------------------
 */

/* Such a layer, but for the first, is not read, as in rm-combine. */
static bool
weighs_nothing(const struct render_layer_opts *l)
{
	const double n = l->normal_weight >= 0 ? l->normal_weight : l->weight;
	const double d = l->depth_weight >= 0 ? l->depth_weight : l->weight;

	return n == 0 && d == 0;
}

static bool
end_layer(struct cmd *cmd, struct render_opts *o, const char *path)
{
	const struct render_layer_opts init = RENDER_LAYER_OPTS_INIT;
	struct render_object_opts *obj = object(o);

	if (obj->nlayers == RENDER_MAX_LAYERS)
		return cmd_usage_error(
		    cmd, "more than %d layers", RENDER_MAX_LAYERS);
	o->next.path = path;
	if (obj->nlayers == 0 || !weighs_nothing(&o->next))
		obj->layer[obj->nlayers++] = o->next;
	o->next = init;
	o->pending = NULL;
	return true;
}

/* F or FxF. */
static bool
set_pair(
    struct cmd *cmd, const char *option, const char *arg, double *u, double *v)
{
	const char *x = strchr(arg, 'x');
	char first[64];

	if (x == NULL) {
		if (!cmd_number(cmd, option, arg, 1e-6, 1e6, u))
			return false;
		*v = *u;
		return true;
	}
	snprintf(first, sizeof first, "%.*s", (int)(x - arg), arg);
	return cmd_number(cmd, option, first, 1e-6, 1e6, u) &&
	       cmd_number(cmd, option, x + 1, 1e-6, 1e6, v);
}

static bool
set_layer(struct cmd *cmd, struct render_opts *o, int key, const char *arg)
{
	struct render_layer_opts *l = &o->next;
	double v[2];
	int n;

	switch (key) {
	case 'w':
		o->pending = "--weight";
		return cmd_number(cmd, "weight", arg, 0, 1e6, &l->weight);
	case KEY_NORMAL_WEIGHT:
		o->pending = "--normal-weight";
		return cmd_number(
		    cmd, "normal-weight", arg, 0, 1e6, &l->normal_weight);
	case KEY_DEPTH_WEIGHT:
		o->pending = "--depth-weight";
		return cmd_number(
		    cmd, "depth-weight", arg, 0, 1e6, &l->depth_weight);
	case KEY_LAYER_DEPTH_SCALE:
		o->pending = "--layer-depth-scale";
		return cmd_number(
		    cmd, "layer-depth-scale", arg, 1e-9, 1e6, &l->depth_scale);
	case 't':
		o->pending = "--tile";
		return set_pair(cmd, "tile", arg, &l->tile_u, &l->tile_v);
	default:
		o->pending = "--offset";
		if (!cmd_numbers(cmd, "offset", arg, -1e6, 1e6, v, 2, &n))
			return false;
		l->offset_u = v[0];
		l->offset_v = v[1];
		return n == 2 || cmd_usage_error(cmd,
				     "--offset is '%s', expected U,V", arg);
	}
}

/* -- objects -----------------------------------------------------------------
 */

static const struct render_object_opts plain_object = { .quadric = "auto",
	.repeat_u = 1,
	.repeat_v = 1,
	.scale = 1,
	.base = { 0.6, 0.6, 0.6 } };

/* Options before the first --shape are of that object. */
static bool
begin_object(struct cmd *cmd, struct render_opts *o, const char *shape)
{
	if (object(o)->shape != NULL) {
		if (o->nobjects == RENDER_MAX_OBJECTS)
			return cmd_usage_error(
			    cmd, "more than %d objects", RENDER_MAX_OBJECTS);
		o->nobjects++;
		*object(o) = plain_object;
	}
	object(o)->shape = shape;
	return true;
}

static bool
set_triple(struct cmd *cmd, const char *option, const char *arg, double v[3])
{
	int n;

	return cmd_numbers(cmd, option, arg, -1e9, 1e9, v, 3, &n) &&
	       (n == 3 ||
		   cmd_usage_error(cmd, "--%s is '%s', expected three numbers",
		       option, arg));
}

static bool
set_object(struct cmd *cmd, struct render_opts *o, int key, const char *arg)
{
	struct render_object_opts *obj = object(o);

	switch (key) {
	case KEY_SHAPE:
		return begin_object(cmd, o, arg);
	case KEY_BASE_COLOR:
		return set_triple(cmd, "base-color", arg, obj->base);
	case KEY_COLOR:
		obj->color = arg;
		return true;
	case KEY_GROUND:
		obj->ground = arg;
		return true;
	case KEY_DEPTH:
		return cmd_number(cmd, "depth", arg, 1e-30, 1e30, &obj->depth);
	case 's':
		return cmd_number(
		    cmd, "depth-scale", arg, 1e-9, 1e6, &obj->depth_scale);
	case KEY_HORIZONS:
		obj->horizons = arg;
		return true;
	case KEY_IMPOSTOR:
		if (!begin_object(cmd, o, "box"))
			return false;
		object(o)->impostor = arg;
		return true;
	case KEY_MULTILAYER:
		obj->multilayer = arg;
		return true;
	case KEY_QUADRIC:
		obj->quadric = arg;
		return true;
	case KEY_REPEAT:
		return set_pair(
		    cmd, "repeat", arg, &obj->repeat_u, &obj->repeat_v);
	case KEY_ROTATE:
		return set_triple(cmd, "rotate", arg, obj->rotate_deg);
	case KEY_SCALE:
		return cmd_number(cmd, "scale", arg, 1e-9, 1e9, &obj->scale);
	case KEY_TRANSLATE:
		return set_triple(cmd, "translate", arg, obj->translate);
	default:
		obj->two_sided = true;
		return true;
	}
}

/* -- the picture -------------------------------------------------------------
 */

static bool
set_camera(struct cmd *cmd, struct render_opts *o, const char *arg)
{
	double v[6];
	int n;

	if (!cmd_numbers(cmd, "camera", arg, -1e9, 1e9, v, 6, &n))
		return false;
	if (n == 6) {
		memcpy(o->camera.eye, v, sizeof o->camera.eye);
		memcpy(o->camera.target, v + 3, sizeof o->camera.target);
		o->has_camera = true;
		return true;
	}
	if (n < 2 || n > 3 || v[1] < -90 || v[1] > 90 || (n == 3 && v[2] <= 0))
		return cmd_usage_error(cmd,
		    "--camera is '%s', expected YAW,PITCH[,DISTANCE] or "
		    "EX,EY,EZ,TX,TY,TZ",
		    arg);
	o->has_camera = false;
	memcpy(o->orbit, v, (size_t)n * sizeof *v);
	return true;
}

static bool
set_search(struct cmd *cmd, struct render_opts *o, const char *arg)
{
	double v[2];
	int n;

	if (strcmp(arg, "exact") == 0 || strcmp(arg, "texel") == 0) {
		o->march.search =
		    *arg == 'e' ? BAKE_SEARCH_EXACT : BAKE_SEARCH_TEXEL;
		return true;
	}
	if (!cmd_numbers(cmd, "search", arg, 0, 4096, v, 2, &n))
		return false;
	if (n != 2 || v[0] < 1 || v[0] != (int)v[0] || v[1] != (int)v[1] ||
	    v[1] > 64)
		return cmd_usage_error(cmd,
		    "--search is '%s', expected exact, texel, or L,B with 1 to "
		    "4096 and 0 to 64 steps",
		    arg);
	o->march.search = BAKE_SEARCH_LINEAR;
	o->march.nlinear = (int)v[0];
	o->march.nbinary = (int)v[1];
	return true;
}

static bool
set_background(struct cmd *cmd, struct render_opts *o, const char *arg)
{
	int n;

	if (!cmd_numbers(cmd, "background", arg, 0, 1e6, o->background, 4, &n))
		return false;
	if (n == 3)
		o->background[3] = 1;
	return n >= 3 || cmd_usage_error(cmd,
			     "--background is '%s', expected R,G,B[,A]", arg);
}

static bool
set_name(struct cmd *cmd, struct render_opts *o, int key, const char *arg)
{
	static const char *const on[] = { "off", "on" };
	static const char *const ao[] = { "multiply", "min" };
	static const char *const models[] = { "paper", "facet", "blackshot",
		"flat" };
	static const char *const blends[] = { "seed", "pd" };
	static const char *const paints[] = { "a", "b", "mean-curvature" };
	static const char *const silhouettes[] = { "none", "quadric", "shell" };
	int i;

	switch (key) {
	case KEY_AO:
		if (!cmd_choice(cmd, "ao", arg, on, 2, &i))
			return false;
		o->ao = i == 1;
		return true;
	case KEY_AO_BLEND:
		if (!cmd_choice(cmd, "ao-blend", arg, ao, 2, &i))
			return false;
		o->ao_min = i == 1;
		return true;
	case KEY_MODEL:
		if (!cmd_choice(cmd, "model", arg, models, 4, &i))
			return false;
		o->roughen_model = (enum bake_roughen_model)i;
		return true;
	case KEY_NORMAL_BLEND:
		if (!cmd_choice(cmd, "normal-blend", arg, blends, 2, &i))
			return false;
		o->blend = (enum bake_render_blend)i;
		return true;
	case KEY_PAINT:
		if (!cmd_choice(cmd, "paint", arg, paints, 3, &i))
			return false;
		o->paint = (enum bake_render_paint)(i + 1);
		return true;
	default:
		if (!cmd_choice(cmd, "silhouette", arg, silhouettes, 3, &i))
			return false;
		o->silhouette = (enum bake_silhouette)i;
		return true;
	}
}

static bool
set_light(struct cmd *cmd, struct render_opts *o, int key, const char *arg)
{
	const char *name = key == KEY_LIGHT ? "light" : "point-light";

	o->light.point = key == KEY_POINT_LIGHT;
	if (!set_triple(cmd, name, arg, o->light.at))
		return false;
	return o->light.point || o->light.at[0] != 0 || o->light.at[1] != 0 ||
	       o->light.at[2] != 0 ||
	       cmd_usage_error(
		   cmd, "--light is '%s', which is no direction", arg);
}

static bool
set_samples(struct cmd *cmd, struct render_opts *o, const char *arg)
{
	static const char *const counts[] = { "1", "4", "16" };
	int i;

	if (!cmd_choice(cmd, "samples", arg, counts, 3, &i))
		return false;
	o->samples = 1 << i;
	return true;
}

static bool
set_picture(struct cmd *cmd, struct render_opts *o, int key, const char *arg)
{
	switch (key) {
	case KEY_AMBIENT:
		return cmd_number(cmd, "ambient", arg, 0, 1e6, &o->ambient);
	case KEY_BACKGROUND:
		return set_background(cmd, o, arg);
	case KEY_BUFFERS:
		o->buffers = arg;
		return true;
	case KEY_CAMERA:
		return set_camera(cmd, o, arg);
	case KEY_COMPARE:
		o->compare = arg;
		return true;
	case KEY_DEPTH_BIAS:
		o->depth_bias = true;
		return true;
	case KEY_DETAIL:
		return cmd_int(cmd, "detail", arg, 1, 1024, &o->detail);
	case KEY_DIFFERENCE:
		o->difference = arg;
		return true;
	case KEY_FOV:
		return cmd_number(cmd, "fov", arg, 1, 170, &o->camera.fov_deg);
	case KEY_LIGHT:
	case KEY_POINT_LIGHT:
		return set_light(cmd, o, key, arg);
	case KEY_LIGHT_SIZE:
		return cmd_number(
		    cmd, "light-size", arg, 0.01, 60, &o->light_size);
	case KEY_ORTHOGRAPHIC:
		o->camera.fov_deg = 0;
		return cmd_number(cmd, "orthographic", arg, 1e-9, 1e9,
		    &o->camera.height_world);
	case KEY_ROUGHEN:
		return cmd_number(cmd, "roughen", arg, 0, 1, &o->roughen);
	case KEY_SAMPLES:
		return set_samples(cmd, o, arg);
	case KEY_SEARCH:
		return set_search(cmd, o, arg);
	case KEY_SHADOW:
		o->shadow = true;
		return true;
	case KEY_SHININESS:
		return cmd_int(cmd, "shininess", arg, 0, 4096, &o->shininess);
	case KEY_SIZE:
		return cmd_size(
		    cmd, "size", arg, &o->camera.width, &o->camera.height);
	case KEY_SPECULAR:
		return cmd_number(cmd, "specular", arg, 0, 1e6, &o->specular);
	case KEY_TARGET:
		o->has_target = true;
		return set_triple(cmd, "target", arg, o->target);
	default:
		return cmd_int(cmd, "turntable", arg, 1, 9999, &o->turntable);
	}
}

bool
render_set_option(struct cmd *cmd, int key, const char *arg)
{
	struct render_opts *o = cmd->tool->opts;

	if (o->nobjects == 0) {
		o->nobjects = 1;
		*object(o) = plain_object;
	}
	switch (key) {
	case CMD_KEY_OPERAND:
	case KEY_RELIEF:
		return end_layer(cmd, o, arg);
	case 'w':
	case 't':
	case KEY_NORMAL_WEIGHT:
	case KEY_DEPTH_WEIGHT:
	case KEY_LAYER_DEPTH_SCALE:
	case KEY_OFFSET:
		return set_layer(cmd, o, key, arg);
	case 's':
	case KEY_SHAPE:
	case KEY_BASE_COLOR:
	case KEY_COLOR:
	case KEY_GROUND:
	case KEY_DEPTH:
	case KEY_HORIZONS:
	case KEY_IMPOSTOR:
	case KEY_MULTILAYER:
	case KEY_QUADRIC:
	case KEY_REPEAT:
	case KEY_ROTATE:
	case KEY_SCALE:
	case KEY_TRANSLATE:
	case KEY_TWO_SIDED:
		return set_object(cmd, o, key, arg);
	case KEY_AO:
	case KEY_AO_BLEND:
	case KEY_MODEL:
	case KEY_NORMAL_BLEND:
	case KEY_PAINT:
	case KEY_SILHOUETTE:
		return set_name(cmd, o, key, arg);
	default:
		return set_picture(cmd, o, key, arg);
	}
}

bool
render_usage(struct cmd *cmd, struct render_opts *o)
{
	if (o->nobjects == 0) {
		o->nobjects = 1;
		*object(o) = plain_object;
	}
	if (o->pending != NULL)
		return cmd_usage_error(
		    cmd, "%s is for a layer, and none follows", o->pending);
	if (cmd->output_dir != NULL)
		return cmd_usage_error(cmd,
		    "-O means nothing here: all objects make one picture; "
		    "give -o FILE");
	if (cmd->output == NULL && o->buffers == NULL && o->compare == NULL)
		return cmd_usage_error(
		    cmd, "no output: give -o FILE, --buffers or --compare");
	if (o->compare != NULL && cmd->output != NULL &&
	    strcmp(cmd->output, "-") == 0)
		return cmd_usage_error(
		    cmd, "--compare and -o - both want standard output");
	if (o->difference != NULL && o->compare == NULL)
		return cmd_usage_error(
		    cmd, "--difference is for --compare FILE");
	if (o->turntable > 0 &&
	    (cmd->output == NULL || strcmp(cmd->output, "-") == 0 ||
		o->buffers != NULL || o->compare != NULL))
		return cmd_usage_error(cmd,
		    "--turntable needs -o FILE, without --buffers and "
		    "--compare");
	for (int i = 0; i < o->nobjects; i++) {
		const struct render_object_opts *obj = &o->object[i];
		int kinds = (obj->nlayers > 0) + (obj->multilayer != NULL) +
			    (obj->impostor != NULL);

		if (kinds > 1)
			return cmd_usage_error(cmd,
			    "--relief, --multilayer and --impostor exclude "
			    "each other on one object");
		if (obj->horizons != NULL && obj->nlayers != 1)
			return cmd_usage_error(
			    cmd, "--horizons takes one layer of relief");
		if (obj->nlayers > 1 && o->silhouette == BAKE_SILHOUETTE_SHELL)
			return cmd_usage_error(cmd,
			    "--silhouette shell takes one layer of relief");
	}
	return true;
}
