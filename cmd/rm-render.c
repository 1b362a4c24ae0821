/* rm-render: the reference renderer of what the other tools bake. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd_batch.h"
#include "cmd_recipe.h"
#include "render_tool.h"

/* -- the camera --------------------------------------------------------------
 */

/* How far from the middle anything of an object is. */
static double
reach(const struct render_loaded *l, const double middle[3])
{
	double far2 = 0;

	for (size_t t = 0; t < l->mesh.ntriangles; t++)
		for (int c = 0; c < 3; c++) {
			const int v = l->mesh.triangles[t][c].v;
			double r2 = 0;

			for (int k = 0; k < 3; k++) {
				const double d =
				    l->mesh.positions[v][k] - middle[k];

				r2 += d * d;
			}
			far2 = fmax(far2, r2);
		}
	if (l->mesh.ntriangles == 0) /* an impostor: its box */
		for (int k = 0; k < 3; k++) {
			const double d =
			    fmax(middle[k] - l->lo[k], l->hi[k] - middle[k]);

			far2 += d * d;
		}
	return sqrt(far2);
}

/* A ball around all objects. */
static void
bounds(const struct render_scene *scene, double middle[3], double *radius)
{
	double lo[3] = { INFINITY, INFINITY, INFINITY };
	double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

	for (int i = 0; i < scene->n; i++)
		for (int k = 0; k < 3; k++) {
			lo[k] = fmin(lo[k], scene->loaded[i].lo[k]);
			hi[k] = fmax(hi[k], scene->loaded[i].hi[k]);
		}
	for (int k = 0; k < 3; k++)
		middle[k] = (lo[k] + hi[k]) / 2;
	*radius = 0;
	for (int i = 0; i < scene->n; i++)
		*radius = fmax(*radius, reach(&scene->loaded[i], middle));
	if (!(*radius > 0))
		*radius = 1;
}

/* yaw turns the eye round y, 0 looking along -z; pitch lifts it. */
static struct bake_camera
camera_of(const struct render_opts *o, const struct render_scene *scene,
    double turn_deg)
{
	const double degree = 3.14159265358979323846 / 180;
	struct bake_camera c = o->camera;
	double middle[3], radius, yaw, pitch, distance;

	bounds(scene, middle, &radius);
	c.near = radius * 1e-3;
	if (o->has_camera)
		return c;
	memcpy(c.target, o->has_target ? o->target : middle, sizeof c.target);
	yaw = (o->orbit[0] + turn_deg) * degree;
	pitch = o->orbit[1] * degree;
	distance = o->orbit[2] * radius;
	c.eye[0] = c.target[0] + distance * cos(pitch) * sin(yaw);
	c.eye[1] = c.target[1] + distance * sin(pitch);
	c.eye[2] = c.target[2] + distance * cos(pitch) * cos(yaw);
	if (fabs(o->orbit[1]) > 89.999) {
		/* straight down: what is far is up */
		c.up[0] = -sin(yaw) * (o->orbit[1] > 0 ? 1 : -1);
		c.up[1] = 0;
		c.up[2] = -cos(yaw) * (o->orbit[1] > 0 ? 1 : -1);
	}
	return c;
}

/* -- pictures ----------------------------------------------------------------
 */

static struct bake_render_params
params_of(struct cmd *cmd, const struct render_opts *o)
{
	struct bake_render_params p = { .samples = o->samples,
		.march = o->march,
		.shadow = o->shadow ? BAKE_SHADOW_HARD : BAKE_SHADOW_NONE,
		.ao = o->ao,
		.depth_bias = o->depth_bias,
		.nthreads = cmd->nthreads };

	p.light.radius =
	    (float)sin(o->light_size * (3.14159265358979323846 / 180));
	p.light.point = o->light.point;
	for (int k = 0; k < 3; k++) {
		p.light.at[k] = o->light.at[k];
		p.light.color[k] = 1;
		p.ambient[k] = (float)o->ambient;
	}
	for (int k = 0; k < 4; k++)
		p.background[k] = (float)o->background[k];
	return p;
}

static bool
render_one(struct cmd *cmd, const struct render_opts *o,
    const struct render_scene *scene, double turn_deg, const char *path)
{
	struct bake_render_params p = params_of(cmd, o);
	struct bake_render_buffers buffers = { .want = BAKE_BUFFER_ALL };
	struct bake_err err = BAKE_ERR_INIT;
	struct cmd_progress bar;
	bool ok;

	if (o->buffers == NULL && o->compare == NULL)
		buffers.want = 0;
	p.camera = camera_of(o, scene, turn_deg);
	p.progress = cmd_progress_start(cmd, &bar);
	ok =
	    bake_render(scene->object, scene->n, &p, &buffers, &err) == BAKE_OK;
	cmd_progress_end(&bar);
	if (!ok)
		cmd_error(cmd, "%s", err.msg);
	/* what fails leaves no picture */
	ok = ok &&
	     (o->compare == NULL ||
		 render_compare(cmd, o, scene->color, &buffers)) &&
	     render_write(cmd, o, scene->color, &buffers, path);
	bake_render_buffers_free(&buffers);
	return ok;
}

/* OUT_0001.png … */
static char *
turn_path(const struct cmd *cmd, int i)
{
	char suffix[16];

	snprintf(suffix, sizeof suffix, "_%04d", i + 1);
	return cmd_path_derive(cmd->output, NULL, suffix, NULL);
}

/* Once round. */
static bool
render_turntable(struct cmd *cmd, const struct render_opts *o,
    const struct render_scene *scene)
{
	bool ok = true;

	for (int i = 0; ok && i < o->turntable; i++) {
		char *path = turn_path(cmd, i);

		ok = render_one(cmd, o, scene, 360.0 * i / o->turntable, path);
		free(path);
	}
	return ok;
}

static void
plan_outputs(struct cmd *cmd, const struct render_opts *o)
{
	for (int i = 0; i < o->turntable; i++) {
		char *path = turn_path(cmd, i), label[24];

		snprintf(label, sizeof label, "turn %d", i + 1);
		cmd_recipe_output(cmd, path, label);
		free(path);
	}
	if (o->turntable == 0)
		cmd_recipe_output(cmd, cmd->output, "picture");
	cmd_recipe_output(cmd, o->buffers, "buffers");
	cmd_recipe_color(cmd);
}

static int
render(struct cmd *cmd, int i, void *opts)
{
	struct render_opts *o = opts;
	struct render_scene *scene;
	struct bake_color *color = NULL;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	(void)i;
	cmd_recipe_begin(cmd, -1);
	plan_outputs(cmd, o);
	if (cmd_unchanged(cmd))
		return CMD_EXIT_OK;
	cmd_silence_libraries(cmd);
	if (bake_color_open(NULL, &color, &err) != BAKE_OK) {
		cmd_error(cmd, "%s", err.msg);
		return CMD_EXIT_FAIL;
	}
	if (bake_color_path(color) != NULL)
		cmd_list_add(&cmd->read, bake_color_path(color));
	scene = calloc(1, sizeof *scene);
	ok = scene != NULL;
	if (!ok)
		cmd_error(cmd, "no memory");
	if (ok) {
		scene->color = color;
		ok = render_scene_load(cmd, o, scene);
		cmd_flush_warnings(cmd);
		if (ok)
			ok = o->turntable > 0
				 ? render_turntable(cmd, o, scene)
				 : render_one(cmd, o, scene, 0, cmd->output);
		render_scene_free(scene);
	}
	free(scene);
	bake_color_close(color);
	return ok ? CMD_EXIT_OK : CMD_EXIT_FAIL;
}

static int
run(struct cmd *cmd, struct render_opts *o)
{
	return render_usage(cmd, o) ? cmd_one(cmd, render, o) : CMD_EXIT_USAGE;
}

int
main(int argc, char *argv[])
{
	struct render_opts o = { .next = RENDER_LAYER_OPTS_INIT,
		.camera = { .up = { 0, 1, 0 },
		    .fov_deg = 40,
		    .width = 640,
		    .height = 480 },
		.orbit = { 30, 25, 3 },
		.light = { .at = { -1, 2, 1.5 } },
		.ambient = 0.3,
		.specular = 0.1,
		.light_size = 5,
		.shininess = 40,
		.samples = 1,
		.detail = 16,
		.march = BAKE_MARCH_PARAMS_DEFAULT,
		.ao = true,
		.blend = BAKE_RENDER_PD,
		.roughen = -1,
		.roughen_model = BAKE_ROUGHEN_FACET,
		.background = { 0.02, 0.02, 0.02, 1 } };
	const struct cmd_tool tool = { "rm-render", "[LAYER ...] -o OUT",
		"Render relief on meshes: the reference of what the tools "
		"bake.",
		render_options,
		CMD_OPTS_OUTPUT | CMD_OPTS_RELIEF | CMD_OPTS_NORMAL |
		    CMD_IN_ORDER,
		render_set_option, &o, main, 48, render_marks };
	struct cmd cmd;
	int status;

	if (cmd_parse(&cmd, &tool, argc, argv, &status))
		status = run(&cmd, &o);
	return cmd_finish(&cmd, status);
}
