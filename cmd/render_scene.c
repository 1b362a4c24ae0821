/* rm-render: what the options describe, read and made ready. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd_mesh.h"
#include "combine_tool.h"
#include "mem.h"
#include "render_tool.h"

static bool
failed(struct cmd *cmd, const char *what, const struct bake_err *err)
{
	cmd_error(cmd, "%s: %s", what, err->msg);
	return false;
}

static const char *
name_of(const struct render_object_opts *obj)
{
	return obj->shape != NULL ? obj->shape : "plane";
}

/* -- geometry ----------------------------------------------------------------
 */

/* p turned about x, y and z in that order, in degrees. */
static void
rotate(const double degrees[3], double p[3])
{
	for (int axis = 0; axis < 3; axis++) {
		const int i = (axis + 1) % 3, k = (axis + 2) % 3;
		const double a = degrees[axis] * (3.14159265358979323846 / 180);
		const double c = cos(a), s = sin(a);
		const double x = p[i], y = p[k];

		if (degrees[axis] == 0)
			continue;
		p[i] = c * x - s * y;
		p[k] = s * x + c * y;
	}
}

static void
transform(const struct render_object_opts *obj, struct bake_mesh *mesh)
{
	for (size_t v = 0; v < mesh->npositions; v++) {
		double *p = mesh->positions[v];

		for (int k = 0; k < 3; k++)
			p[k] *= obj->scale;
		rotate(obj->rotate_deg, p);
		for (int k = 0; k < 3; k++)
			p[k] += obj->translate[k];
	}
	for (size_t n = 0; n < mesh->nnormals; n++) {
		rotate(obj->rotate_deg, mesh->normals[n]);
		if (mesh->tangents != NULL)
			rotate(obj->rotate_deg, mesh->tangents[n]);
	}
}

static bool
load_mesh(struct cmd *cmd, const struct render_opts *o,
    const struct render_object_opts *obj, struct render_loaded *l)
{
	const struct bake_mesh_params params = BAKE_MESH_PARAMS_DEFAULT;
	struct bake_frame_params frames = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_shape shape;
	bool ok;

	if (bake_shape_from_name(name_of(obj), &shape)) {
		ok = bake_shape_make(shape, o->detail, &l->mesh, &err) ==
			 BAKE_OK ||
		     failed(cmd, name_of(obj), &err);
		/* they have tangents, and poles without a UV area */
		frames.tangents = BAKE_TANGENTS_FILE;
	} else {
		ok = cmd_read_mesh(cmd, obj->shape, &params, &l->mesh);
		frames.tangents = obj->nlayers > 0 || obj->multilayer != NULL
				      ? BAKE_TANGENTS_FILE
				      : BAKE_TANGENTS_AUTO;
	}
	if (!ok)
		return false;
	transform(obj, &l->mesh);
	bake_mesh_bounds(&l->mesh, l->lo, l->hi);
	frames.nthreads = cmd->nthreads;
	return (bake_mesh_weld(&l->mesh, 0, &l->weld, &err) == BAKE_OK &&
		   bake_mesh_frames(&l->mesh, &l->weld, NULL, &frames,
		       &l->frames, &err) == BAKE_OK) ||
	       failed(cmd, name_of(obj), &err);
}

/* The mean width of the texture on the mesh, |dP/ds|, by area in UV. */
static double
texture_width(const struct render_loaded *l)
{
	double sum = 0, weight = 0;

	for (size_t t = 0; t < l->mesh.ntriangles; t++) {
		const struct bake_corner *c = l->mesh.triangles[t];
		double uv[3][2] = { { 0 } }, area;

		for (int k = 0; k < 3; k++)
			if (c[k].vt >= 0)
				memcpy(
				    uv[k], l->mesh.uvs[c[k].vt], sizeof uv[k]);
		area = fabs((uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) -
			    (uv[2][0] - uv[0][0]) * (uv[1][1] - uv[0][1]));
		for (int k = 0; k < 3; k++) {
			const double *ps =
			    l->frames.frame[l->frames.frame_of[t][k]].ps;

			sum += area * sqrt(ps[0] * ps[0] + ps[1] * ps[1] +
					   ps[2] * ps[2]);
			weight += area;
		}
	}
	return weight > 0 ? sum / weight : 1;
}

/* -- quadrics ----------------------------------------------------------------
 */

/* rm-quadfit's table: a line of names, then v vt … a b c … */
static bool
read_table(struct cmd *cmd, const char *path, struct render_loaded *l)
{
	FILE *fp = fopen(path, "re");
	struct bake_quadric *q = l->quadrics;
	size_t found = 0, n = 0;
	char line[4096];
	bool ok = fp != NULL && fgets(line, sizeof line, fp) != NULL &&
		  strncmp(line, "v\tvt\tx\t", 7) == 0;

	while (ok && fgets(line, sizeof line, fp) != NULL) {
		int v, vt, used = 0;
		double a, b, c;

		ok = sscanf(line,
			 "%d %d %*f %*f %*f %*f %*f %*f %*f %*f %*f %*f %lf "
			 "%lf %lf%n",
			 &v, &vt, &a, &b, &c, &used) == 5 &&
		     used > 0 && isfinite(a) && isfinite(b) && isfinite(c);
		/* both are ordered by v, then vt */
		while (ok && n < l->frames.nframes &&
		       (l->frames.frame[n].v < v ||
			   (l->frames.frame[n].v == v &&
			       l->frames.frame[n].vt < vt)))
			n++;
		if (ok && n < l->frames.nframes && l->frames.frame[n].v == v &&
		    l->frames.frame[n].vt == vt) {
			q[n].a = a;
			q[n].b = b;
			q[n].c = c;
			found++;
		}
	}
	if (fp != NULL)
		fclose(fp);
	if (!ok || found != l->frames.nframes) {
		cmd_error(cmd,
		    "%s: is no table of rm-quadfit for this mesh (%zu of %zu "
		    "corners)",
		    path, found, l->frames.nframes);
		return false;
	}
	cmd_list_add(&cmd->read, path);
	return true;
}

static bool
load_quadrics(struct cmd *cmd, const struct render_opts *o,
    const struct render_object_opts *obj, struct render_loaded *l)
{
	struct bake_quadric_params fit = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_err err = BAKE_ERR_INIT;

	if (o->silhouette != BAKE_SILHOUETTE_QUADRIC &&
	    o->paint == BAKE_RENDER_PAINT_NONE)
		return true;
	l->quadrics = bake_zalloc(l->frames.nframes, sizeof *l->quadrics, &err);
	if (l->quadrics == NULL)
		return failed(cmd, name_of(obj), &err);
	if (strcmp(obj->quadric, "none") == 0)
		return true;
	if (strcmp(obj->quadric, "auto") != 0)
		return read_table(cmd, obj->quadric, l);
	fit.nthreads = cmd->nthreads;
	return bake_quadric_fit(&l->mesh, &l->weld, &l->frames, &fit,
		   l->quadrics, &err) == BAKE_OK ||
	       failed(cmd, name_of(obj), &err);
}

/* What 95 of 100 corners are within. */
static double
paint_scale(enum bake_render_paint paint, const struct render_loaded *l)
{
	double sum2 = 0;

	for (size_t i = 0; i < l->frames.nframes; i++) {
		const struct bake_quadric *q = &l->quadrics[i];
		double v = (paint != BAKE_RENDER_PAINT_B ? q->a : 0) +
			   (paint != BAKE_RENDER_PAINT_A ? q->b : 0);

		sum2 += v * v;
	}
	/* twice the root mean square */
	sum2 = 2 * sqrt(sum2 / (double)l->frames.nframes);
	return sum2 > 0 ? sum2 : 1;
}

/* -- relief ------------------------------------------------------------------
 */

bool
render_read_color(struct cmd *cmd, const struct bake_color *color,
    const char *path, struct bake_image *img)
{
	struct cmd_map map = CMD_MAP_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok = cmd_read(cmd, path, &map);

	if (ok && map.img.nchans > 4) {
		cmd_error(cmd,
		    "%s: has %d channels, a colour map has at most 4", path,
		    map.img.nchans);
		ok = false;
	}
	if (ok && bake_data_format_max(map.info.data_format) != 0)
		ok = bake_color_to_linear(color, "sRGB", &map.img,
			 cmd->nthreads, &err) == BAKE_OK ||
		     failed(cmd, path, &err);
	if (ok && map.img.nchans < 3) {
		/* grey */
		ok = bake_image_alloc(img, map.img.width, map.img.height, 3,
			 &err) == BAKE_OK ||
		     failed(cmd, path, &err);
		for (int c = 0; ok && c < 3; c++)
			bake_image_copy_channel(img, c, &map.img, 0);
	} else if (ok)
		bake_image_swap(img, &map.img);
	cmd_map_free(&map);
	return ok;
}

/* A layer's texels: normals signed, as the marcher and shading want them. */
static bool
load_layer(struct cmd *cmd, const struct render_layer_opts *lo,
    struct render_loaded *l, int i, struct combine_read *r)
{
	struct combine_opts copts = { .n = 0 };
	struct combine_layer layer = COMBINE_LAYER_INIT;
	struct bake_image depth = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	layer.packed = lo->path;
	layer.depth_scale = lo->depth_scale;
	if (!combine_read_layer(cmd, &copts, &layer, r))
		return false;
	ok = bake_image_alloc(&depth, r->maps.width, r->maps.height, 1, &err) ==
	     BAKE_OK;
	if (ok) {
		bake_image_copy_channel(&depth, 0, &r->maps, 3);
		ok = bake_relief_map_open(&l->maps[i], &depth, r->wrap,
			 cmd->nthreads, &err) == BAKE_OK;
	}
	bake_image_free(&depth);
	for (int y = 0; ok && y < r->maps.height; y++) {
		float *v = bake_image_row(&r->maps, y);

		for (int x = 0; x < r->maps.width; x++, v += 4) {
			v[0] = 2 * v[0] - 1;
			v[1] = 2 * v[1] - 1;
		}
	}
	bake_image_swap(&l->texels[i], &r->maps);
	bake_image_free(&r->maps);
	return ok || failed(cmd, lo->path, &err);
}

static double
weight_of(double own, double both)
{
	return own >= 0 ? own : both >= 0 ? both : 1;
}

/* All layers, and the depth scale of the whole: the base's unless given. */
static bool
load_layers(struct cmd *cmd, const struct render_object_opts *obj,
    enum bake_render_blend blend, struct render_loaded *l, double *scale)
{
	double made_for[RENDER_MAX_LAYERS], baked_for[RENDER_MAX_LAYERS];
	double total = 0;

	for (int i = 0; i < obj->nlayers; i++) {
		const struct render_layer_opts *lo = &obj->layer[i];
		struct combine_read r = { .maps = BAKE_IMAGE_INIT };
		struct bake_render_layer *layer = &l->layers[i];

		if (!load_layer(cmd, lo, l, i, &r))
			return false;
		made_for[i] = r.depth_scale;
		baked_for[i] = r.ao_scale > 0 ? r.ao_scale : r.depth_scale;
		layer->map = l->maps[i];
		layer->texels = &l->texels[i];
		layer->wrap = r.wrap;
		layer->tile_u = lo->tile_u;
		layer->tile_v = lo->tile_v;
		layer->offset_u = lo->offset_u;
		layer->offset_v = lo->offset_v;
		layer->normal_weight = weight_of(lo->normal_weight, lo->weight);
		layer->depth_weight = weight_of(lo->depth_weight, lo->weight);
		total += layer->depth_weight;
	}
	if (!(total > 0)) {
		cmd_error(cmd, "%s: no layer has a depth weight above 0",
		    name_of(obj));
		return false;
	}
	*scale = obj->depth_scale > 0 ? obj->depth_scale : made_for[0];
	for (int i = 0; i < obj->nlayers; i++) {
		struct bake_render_layer *layer = &l->layers[i];
		const double share =
		    layer->tile_u * layer->depth_weight / total;
		const bool mean = obj->nlayers > 1 && blend == BAKE_RENDER_SEED;

		layer->slope = mean ? 1 : *scale * share / made_for[i];
		/* a blend's AO is that of its layers, as in rm-combine */
		layer->ao_scale =
		    obj->nlayers > 1 ? 1 : *scale * share / baked_for[i];
	}
	return true;
}

/* The horizons of the one layer, and how much steeper it is than they say. */
static bool
load_horizons(struct cmd *cmd, const struct render_object_opts *obj,
    double scale, struct bake_render_object *out, struct render_loaded *l)
{
	struct cmd_map map = CMD_MAP_INIT;
	bool ok = cmd_read(cmd, obj->horizons, &map);

	if (ok &&
	    (map.meta.layout != BAKE_LAYOUT_HORIZONS || map.img.nchans < 3)) {
		cmd_error(cmd, "%s: holds no horizons of rm-aobake --horizons",
		    obj->horizons);
		ok = false;
	}
	if (ok) {
		out->horizon_slope =
		    map.meta.depth_scale > 0
			? scale * obj->layer[0].tile_u / map.meta.depth_scale
			: 1;
		bake_image_swap(&l->horizons, &map.img);
		out->horizons = &l->horizons;
	}
	cmd_map_free(&map);
	return ok;
}

/* -- multilayer relief -------------------------------------------------------
 */

/* The box of an impostor in the world, in the axes it was seen in. */
static bool
place_box(struct cmd *cmd, const struct render_object_opts *obj,
    const struct bake_layer_meta *meta, struct bake_render_object *out,
    struct render_loaded *l)
{
	enum bake_axis axis = BAKE_AXIS_POS_X;
	struct bake_axes axes;
	double near, far;

	if (!meta->has_range || !meta->has_region || meta->axis[0] == '\0') {
		cmd_error(cmd,
		    "%s: does not say which box it fills (its metadata are "
		    "gone): put it on a --shape with --multilayer",
		    obj->impostor);
		return false;
	}
	while (axis < BAKE_AXIS_NEG_Z &&
	       strcmp(bake_axis_name(axis), meta->axis) != 0)
		axis = (enum bake_axis)(axis + 1);
	axes = bake_axis_axes(axis);
	bake_layer_meta_range(meta, &near, &far);
	for (int k = 0; k < 3; k++) {
		double shift = 0;

		memset(out->box_axes[k], 0, sizeof out->box_axes[k]);
		out->box_axes[k][axes.index[k]] = axes.sign[k];
		rotate(obj->rotate_deg, out->box_axes[k]);
		for (int c = 0; c < 3; c++)
			shift += obj->translate[c] * out->box_axes[k][c];
		out->box[0][k] =
		    obj->scale * (k == 2 ? far : meta->region[k]) + shift;
		out->box[1][k] =
		    obj->scale * (k == 2 ? near : meta->region[k + 2]) + shift;
	}
	for (int c = 0; c < 3; c++) {
		l->lo[c] = l->hi[c] = 0;
		for (int k = 0; k < 3; k++) {
			const double a = out->box[0][k] * out->box_axes[k][c];
			const double b = out->box[1][k] * out->box_axes[k][c];

			l->lo[c] += a < b ? a : b;
			l->hi[c] += a < b ? b : a;
		}
	}
	return true;
}

static bool
load_multi(struct cmd *cmd, const struct bake_color *color,
    const struct render_object_opts *obj, struct bake_render_object *out,
    struct render_loaded *l, double *scale)
{
	const char *prefix =
	    obj->impostor != NULL ? obj->impostor : obj->multilayer;
	struct render_layer_set set = { .maps = BAKE_LAYER_MAPS_INIT,
		.meta = BAKE_RELIEF_META_INIT };
	struct bake_err err = BAKE_ERR_INIT;
	const struct bake_layer_meta *meta = &set.meta.layer;
	struct bake_wrap wrap = { obj->impostor != NULL,
		obj->impostor != NULL };
	bool ok = render_read_set(cmd, color, prefix, &set);

	ok = ok && (bake_multi_map_open(&l->multi, &set.maps, wrap,
			cmd->nthreads, &err) == BAKE_OK ||
		       failed(cmd, prefix, &err));
	if (ok && obj->impostor != NULL)
		ok = place_box(cmd, obj, meta, out, l);
	if (ok) {
		double near = 0, far = 0;

		*scale = set.meta.depth_scale > 0 ? set.meta.depth_scale : 0.1;
		if (meta->has_range && meta->has_region) {
			bake_layer_meta_range(meta, &near, &far);
			*scale =
			    (near - far) / (meta->region[2] - meta->region[0]);
		}
		if (obj->depth_scale > 0)
			*scale = obj->depth_scale;
		if (l->color.data == NULL)
			bake_image_swap(&l->color, &set.color);
	}
	bake_image_free(&set.color);
	bake_layer_maps_free(&set.maps);
	return ok;
}

/* -- materials ---------------------------------------------------------------
 */

static struct bake_render_material
material_of(const struct render_opts *o, const struct render_object_opts *obj,
    const struct bake_image *color)
{
	struct bake_render_material m = { .color_tile_u = 1,
		.color_tile_v = 1,
		.specular = (float)o->specular,
		.shininess = o->shininess };

	m.color = color->data != NULL ? color : NULL;
	for (int k = 0; k < 3; k++)
		m.base[k] = m.color != NULL ? 1 : (float)obj->base[k];
	return m;
}

/* 2 1/2 D texture mapping by the colour's own statistics. */
static bool
load_roughen(
    struct cmd *cmd, const struct render_opts *o, struct render_loaded *l)
{
	static const double rec709[3] = { 0.2126, 0.7152, 0.0722 };
	struct bake_image lum = BAKE_IMAGE_INIT;
	struct bake_roughen_stats stats;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	ok = bake_roughen_luminance(
		 &l->color, rec709, cmd->nthreads, &lum, &err) == BAKE_OK &&
	     bake_roughen_measure(&lum, cmd->nthreads, &stats, &err) ==
		 BAKE_OK &&
	     bake_roughen_init(&l->roughen, o->roughen_model, o->roughen,
		 &stats, &err) == BAKE_OK;
	bake_image_free(&lum);
	return ok || failed(cmd, "--roughen", &err);
}

static bool
load_materials(struct cmd *cmd, const struct render_opts *o,
    const struct bake_color *color, const struct render_object_opts *obj,
    struct bake_render_object *out, struct render_loaded *l)
{
	out->material = material_of(o, obj, &l->color);
	if (o->roughen >= 0 && l->color.data != NULL) {
		if (!load_roughen(cmd, o, l))
			return false;
		out->material.roughen = &l->roughen;
	}
	if (obj->ground == NULL)
		return true;
	if (!render_read_color(cmd, color, obj->ground, &l->ground))
		return false;
	l->ground_material = material_of(o, obj, &l->ground);
	out->ground = &l->ground_material;
	return true;
}

/* -- objects -----------------------------------------------------------------
 */

static bool
load_object(struct cmd *cmd, const struct render_opts *o,
    const struct bake_color *color, const struct render_object_opts *obj,
    struct bake_render_object *out, struct render_loaded *l)
{
	struct bake_err err = BAKE_ERR_INIT;
	double scale = obj->depth_scale > 0 ? obj->depth_scale : 0.1;
	bool ok = true;

	out->silhouette = obj->nlayers > 0 || obj->multilayer != NULL
			      ? o->silhouette
			      : BAKE_SILHOUETTE_NONE;
	out->blend = o->blend;
	out->ao_min = o->ao_min;
	out->two_sided = obj->two_sided;
	out->tile_u = obj->repeat_u;
	out->tile_v = obj->repeat_v;
	if (obj->color != NULL)
		ok = render_read_color(cmd, color, obj->color, &l->color);
	if (ok && obj->impostor == NULL)
		ok = load_mesh(cmd, o, obj, l) && load_quadrics(cmd, o, obj, l);
	if (ok && obj->nlayers > 0)
		ok = load_layers(cmd, obj, o->blend, l, &scale);
	if (ok && obj->horizons != NULL)
		ok = load_horizons(cmd, obj, scale, out, l);
	if (ok && (obj->multilayer != NULL || obj->impostor != NULL))
		ok = load_multi(cmd, color, obj, out, l, &scale);
	if (!ok || !load_materials(cmd, o, color, obj, out, l))
		return false;
	out->multi = l->multi;
	out->impostor = obj->impostor != NULL;
	out->layers = l->layers;
	out->nlayers = obj->nlayers;
	out->depth = 1;
	if (out->impostor)
		return true;
	out->mesh = &l->mesh;
	out->frames = &l->frames;
	out->quadrics = l->quadrics;
	out->depth = obj->depth > 0 ? obj->depth
				    : scale * texture_width(l) / obj->repeat_u;
	if (o->paint != BAKE_RENDER_PAINT_NONE) {
		out->paint = o->paint;
		out->paint_scale = paint_scale(o->paint, l);
	}
	if (out->silhouette == BAKE_SILHOUETTE_SHELL && out->nlayers == 1)
		ok = bake_shell_open(&l->shell, &l->mesh, &l->weld, &l->frames,
			 out->depth, obj->repeat_u * obj->layer[0].tile_u,
			 obj->repeat_v * obj->layer[0].tile_v, cmd->nthreads,
			 &err) == BAKE_OK ||
		     failed(cmd, name_of(obj), &err);
	out->shell = l->shell;
	return ok;
}

bool
render_scene_load(
    struct cmd *cmd, const struct render_opts *o, struct render_scene *scene)
{
	for (int i = 0; i < o->nobjects; i++) {
		scene->n++;
		if (!load_object(cmd, o, scene->color, &o->object[i],
			&scene->object[i], &scene->loaded[i]))
			return false;
	}
	return true;
}

void
render_scene_free(struct render_scene *scene)
{
	for (int i = 0; i < scene->n; i++) {
		struct render_loaded *l = &scene->loaded[i];

		bake_shell_close(l->shell);
		for (int k = 0; k < RENDER_MAX_LAYERS; k++) {
			bake_relief_map_close(l->maps[k]);
			bake_image_free(&l->texels[k]);
		}
		bake_multi_map_close(l->multi);
		bake_image_free(&l->color);
		bake_image_free(&l->ground);
		bake_image_free(&l->horizons);
		free(l->quadrics);
		bake_frames_free(&l->frames);
		bake_weld_free(&l->weld);
		bake_mesh_free(&l->mesh);
	}
	scene->n = 0;
}
