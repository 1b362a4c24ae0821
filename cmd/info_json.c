/* rm-info's reports and comparisons as JSON, one object a line. */
/* SPDX-License-Identifier: MIT */
#include "info.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An object or array that is being filled; ok while memory lasts. */
struct node {
	json_t *json;
	bool ok;
};

/* A value that could not be made is NULL, which jansson refuses. */
static void
put(struct node *object, const char *key, json_t *value)
{
	if (json_object_set_new(object->json, key, value) != 0)
		object->ok = false;
}

static void
append(struct node *array, json_t *value)
{
	if (json_array_append_new(array->json, value) != 0)
		array->ok = false;
}

static json_t *
whole(struct node *n)
{
	if (n->ok)
		return n->json;
	json_decref(n->json);
	return NULL;
}

/* A text that JSON can hold: bytes that are no UTF-8 become '?'. */
static json_t *
text(const char *s)
{
	json_t *j = json_string(s);
	char *plain;

	if (j != NULL || (plain = strdup(s)) == NULL)
		return j;
	for (char *p = plain; *p != '\0'; p++)
		if ((unsigned char)*p > 0x7e)
			*p = '?';
	j = json_string(plain);
	free(plain);
	return j;
}

static json_t *
number(double v)
{
	return isfinite(v) ? json_real(v) : json_null();
}

static json_t *
count(size_t n)
{
	return json_integer((json_int_t)n);
}

/* A value that there is on a condition. */
static json_t *
number_if(bool there, double v)
{
	return there ? number(v) : json_null();
}

/* Print and free the object. */
static bool
print(struct cmd *cmd, const char *file, struct node *object)
{
	json_t *j = whole(object);
	char *line = json_dumps(j, JSON_COMPACT | JSON_REAL_PRECISION(9));
	bool ok = line != NULL;

	if (ok)
		puts(line);
	else
		cmd_error(cmd, "%s: no memory", file);
	free(line);
	json_decref(j);
	return ok;
}

static json_t *
evidence(const struct bake_evidence *e)
{
	struct node n = { NULL, true };

	if (e->scale == 0)
		return json_null();
	n.json = json_object();
	put(&n, "value", number(e->value));
	put(&n, "sigmas", number(e->sigmas));
	put(&n, "share", number(e->share));
	put(&n, "chance", number(e->chance));
	put(&n, "scale", json_integer(e->scale));
	put(&n, "sure", json_boolean(e->verdict != 0));
	return whole(&n);
}

static json_t *
channel(const char *name, const struct bake_channel_range *v)
{
	struct node n = { json_object(), true };

	put(&n, "name", text(name));
	put(&n, "min", number(v->min));
	put(&n, "max", number(v->max));
	put(&n, "mean", number(v->mean));
	put(&n, "nan", count(v->nnan));
	put(&n, "inf", count(v->ninf));
	return whole(&n);
}

static json_t *
channels(const struct info_report *r)
{
	struct node n = { json_array(), true };

	for (int c = 0; c < r->map.img.nchans; c++)
		append(&n, channel(info_channel(&r->map, c), &r->range[c]));
	return whole(&n);
}

/* One number a layer, null where it gives no depth. */
static json_t *
keep_scales(const struct bake_relief_meta *said)
{
	struct node n = { NULL, true };

	if (said->nkeep == 0)
		return json_null();
	n.json = json_array();
	for (int i = 0; i < said->nkeep; i++)
		append(&n, number(said->keep_scale[i]));
	return whole(&n);
}

static json_t *
declared(const struct bake_relief_meta *said)
{
	struct node n = { json_object(), true };

	put(&n, "layout", text(bake_layout_name(said->layout)));
	put(&n, "polarity", text(bake_polarity_name(said->polarity)));
	put(&n, "normal_y", text(bake_normal_y_name(said->normal_y)));
	put(&n, "depth_scale",
	    number_if(said->depth_scale > 0, said->depth_scale));
	put(&n, "ao_scale", number_if(said->has_ao_scale, said->ao_scale));
	put(&n, "keep_scale", keep_scales(said));
	return whole(&n);
}

/* Of a multilayer texture; what it does not say, or has not, is null. */
static json_t *
layers(const struct info_report *r)
{
	const struct bake_layer_meta *m = &r->said.layer;
	const struct bake_layer_check *c = &r->layers;
	struct node n = { json_object(), true }, list;

	put(&n, "texture", json_integer(m->texture > 0 ? m->texture : 1));
	put(&n, "textures", json_integer(m->texture > 0 ? m->ntextures : 1));
	put(&n, "depth_zero", number_if(m->has_range, m->zero));
	put(&n, "depth_one", number_if(m->has_range, m->one));
	put(&n, "axis", m->axis[0] != '\0' ? text(m->axis) : json_null());
	list = (struct node){ json_array(), true };
	for (int i = 0; i < 4; i++)
		append(&list, number(m->region[i]));
	put(&n, "region", m->has_region ? whole(&list) : json_null());
	if (!m->has_region)
		json_decref(list.json);
	put(&n, "mip_level", json_integer(m->mip_level));
	put(&n, "tau", number_if(m->has_tau, m->tau));
	put(&n, "plane", number_if(m->has_plane, m->plane));
	list = (struct node){ json_array(), true };
	for (int i = 0; i <= 4; i++)
		append(&list, count(c->texels[i]));
	put(&n, "texels", r->has_layers ? whole(&list) : json_null());
	if (!r->has_layers)
		json_decref(list.json);
	return whole(&n);
}

static json_t *
contradictions(const struct bake_contradictions *bad)
{
	struct node n = { json_array(), true };

	for (int i = 0; i < bad->n; i++)
		append(&n, text(bad->text[i]));
	return whole(&n);
}

/* The file, and the conventions that its texels follow. */
static void
put_file(struct node *n, const struct info_report *r)
{
	const struct bake_image_info *info = &r->map.info;
	const struct bake_detection *d = &r->found.detection;

	put(n, "file", text(r->file));
	put(n, "width", json_integer(info->width));
	put(n, "height", json_integer(info->height));
	put(n, "channels", json_integer(info->nchans));
	put(n, "format", text(info->container));
	put(n, "data_format", text(bake_data_format_name(info->data_format)));
	put(n, "layout", text(info_layout(r)));
	put(n, "polarity", text(bake_polarity_name(d->polarity)));
	put(n, "normal_y", text(bake_normal_y_name(d->normal_y)));
	put(n, "depth_scale", number(d->depth_scale));
	put(n, "seam_u", number(r->found.seams.u));
	put(n, "seam_v", number(r->found.seams.v));
}

/* What was measured, from which the conventions follow. */
static void
put_evidence(struct node *n, const struct bake_inspection *f)
{
	const struct bake_detection *d = &f->detection;
	bool scale = !isnan(d->depth_scale), normals = f->has_normals;

	put(n, "depth_scale_low", number_if(scale, d->depth_scale_low));
	put(n, "depth_scale_high", number_if(scale, d->depth_scale_high));
	put(n, "seam_u_peak", number(f->seams.u_peak));
	put(n, "seam_v_peak", number(f->seams.v_peak));
	put(n, "layout_guessed", json_boolean(f->guessed));
	put(n, "normal_length_mean",
	    number_if(normals, f->normals.length_mean));
	put(n, "normal_length_dev", number_if(normals, f->normals.length_dev));
	put(n, "normal_negative_z", number_if(normals, f->normals.negative_z));
	put(n, "pair_normal_y", text(bake_normal_y_name(d->pair_y)));
	put(n, "curl_normal_y", text(bake_normal_y_name(d->curl_y)));
	put(n, "corr_x", evidence(&d->x));
	put(n, "corr_y", evidence(&d->y));
	put(n, "curl", evidence(&d->curl));
	put(n, "nonfinite", count(f->nbad));
}

bool
info_json(struct cmd *cmd, const struct info_report *r)
{
	struct node n = { json_object(), true };

	put_file(&n, r);
	put_evidence(&n, &r->found);
	put(&n, "channel_ranges", channels(r));
	put(&n, "declared", declared(&r->said));
	put(&n, "layers",
	    r->said.layer.nlayers > 0 ? json_integer(r->said.layer.nlayers)
				      : json_null());
	put(&n, "parts", json_integer(r->map.info.nsubimages));
	put(&n, "part", r->part != NULL ? text(r->part) : json_null());
	put(&n, "deep", json_boolean(r->deep));
	put(&n, "samples", r->deep ? count(r->nsamples) : json_null());
	put(&n, "layer",
	    r->said.layer.nlayers > 0 || bake_layout_is_layered(r->found.layout)
		? layers(r)
		: json_null());
	put(&n, "contradictions", contradictions(&r->bad));
	if (r->pair) {
		put(&n, "normal_file", text(r->normal.path));
		put(&n, "depth_file", text(r->map.path));
	}
	return print(cmd, r->file, &n);
}

bool
info_json_comparison(struct cmd *cmd, const struct cmd_map map[2],
    const struct bake_comparison *c, int code_max)
{
	const struct bake_difference *d = &c->all;
	struct node n = { json_object(), true };

	put(&n, "file", text(map[0].path));
	put(&n, "other", text(map[1].path));
	put(&n, "code_max", json_integer(code_max));
	put(&n, "worst", number(d->worst));
	put(&n, "mean", number(d->mean));
	put(&n, "channel", text(info_channel(&map[0], d->channel)));
	put(&n, "x", json_integer(d->x));
	put(&n, "y", json_integer(d->y));
	put(&n, "different", count(d->ndifferent));
	put(&n, "beyond", count(d->nbeyond));
	put(&n, "mismatched", count(d->nmismatch));
	return print(cmd, map[0].path, &n);
}
