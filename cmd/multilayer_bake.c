/* rm-multilayer: from a mesh or a height field to a set of textures. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cmd_mesh.h"
#include "mesh_textures.h"
#include "multilayer_tool.h"
#include "normal.h"

/* Texels that an impostor keeps free at each side, so that what lies beyond
 * its border is empty. */
enum { IMPOSTOR_MARGIN = 1 };

/* A mesh and all that is needed to sample it. */
struct source {
	const char *path;
	struct bake_mesh mesh;
	struct bake_weld weld;
	struct mesh_textures textures;
	const struct bake_color *color;
};

static bool
failed(struct cmd *cmd, const char *path, const struct bake_err *err)
{
	cmd_error(cmd, "%s: %s", path, err->msg);
	return false;
}

enum bake_data_format
multilayer_format(const struct cmd *cmd, enum bake_data_format deepest)
{
	return cmd->has_data_format
		   ? cmd->data_format
		   : bake_file_type_nearest(cmd->type, deepest);
}

/* -- the view ----------------------------------------------------------------
 */

/* Wider by the margin, about its middle. */
static void
widen(double *lo, double *hi, int n)
{
	double extra =
	    (*hi - *lo) * IMPOSTOR_MARGIN / (n - 2 * IMPOSTOR_MARGIN);

	if (n > 4 * IMPOSTOR_MARGIN) {
		*lo -= extra;
		*hi += extra;
	}
}

static void
set_depth_range(struct cmd *cmd, struct bake_view *view)
{
	view->near = cmd->depth_near;
	view->far = cmd->depth_far;
	if (view->near > view->far)
		return;
	view->near = cmd->depth_far;
	view->far = cmd->depth_near;
	cmd_warn(cmd,
	    "--depth-range %.9g,%.9g is taken as %.9g,%.9g: positions on the "
	    "axis grow towards the eye",
	    view->far, view->near, view->near, view->far);
}

static bool
make_view(struct cmd *cmd, const struct multilayer_opts *o,
    const struct source *s, enum bake_axis axis, struct bake_view *view)
{
	struct bake_err err = BAKE_ERR_INIT;

	memset(view, 0, sizeof *view);
	view->axis = axis;
	view->width = o->width;
	view->height = o->height;
	view->tile_x = o->tile_x;
	view->tile_y = o->tile_y;
	if (bake_view_fit(view, &s->mesh, &err) != BAKE_OK)
		return failed(cmd, s->path, &err);
	/* slabs stand out by half of their thickness */
	view->near += o->solidify / 2;
	view->far -= o->solidify / 2;
	if (o->has_region) {
		view->x0 = o->region[0];
		view->y0 = o->region[1];
		view->x1 = o->region[2];
		view->y1 = o->region[3];
	}
	if (o->impostor) {
		widen(&view->x0, &view->x1, view->width);
		widen(&view->y0, &view->y1, view->height);
	}
	if (cmd->has_depth_range)
		set_depth_range(cmd, view);
	return bake_view_check(view, &err) == BAKE_OK ||
	       failed(cmd, s->path, &err);
}

static struct bake_relief_meta
meta_of(
    const struct multilayer_opts *o, const struct bake_view *view, int nlayers)
{
	struct bake_relief_meta meta = BAKE_RELIEF_META_INIT;
	struct bake_layer_meta *l = &meta.layer;

	meta.normal_y = BAKE_NORMAL_Y_UP;
	meta.polarity = BAKE_POLARITY_DEPTH;
	meta.has_wrap = o->tile_x || o->tile_y;
	meta.wrap.clamp_u = !o->tile_x;
	meta.wrap.clamp_v = !o->tile_y;
	l->nlayers = nlayers;
	bake_layer_meta_set_range(l, view->near, view->far);
	l->has_range = true;
	snprintf(l->axis, sizeof l->axis, "%s", bake_axis_name(view->axis));
	l->has_region = true;
	l->region[0] = view->x0;
	l->region[1] = view->y0;
	l->region[2] = view->x1;
	l->region[3] = view->y1;
	l->has_plane = o->impostor;
	l->plane = 0.5;
	return meta;
}

/* -- baking ------------------------------------------------------------------
 */

static struct bake_multilayer_params
params_of(struct cmd *cmd, const struct multilayer_opts *o,
    const struct source *s, const struct bake_view *view)
{
	struct bake_multilayer_params p = { .view = *view,
		.rays = BAKE_ABUFFER_PARAMS_DEFAULT,
		.surface = BAKE_SURFACE_PARAMS_DEFAULT,
		.format = multilayer_format(cmd, BAKE_DATA_UINT8),
		.policy = o->policy,
		.nlayers = o->nlayers,
		.coverage = o->impostor,
		.color = s->color,
		.nthreads = cmd->nthreads };

	p.rays.solidify = o->solidify;
	p.rays.reorient = o->reorient;
	p.surface.flat = o->flat;
	p.surface.normals = o->normals;
	p.surface.textures = s->textures.list;
	p.surface.factors = (const float(*)[4])s->textures.factors;
	p.surface.vertex_colors = (const float(*)[4])s->textures.vertex_colors;
	p.surface.nthreads = cmd->nthreads;
	p.ncolors = o->no_color ? 0
		    : o->all_colors
			? o->nlayers == 0 ? BAKE_LAYERS_MAX : o->nlayers
			: 1;
	return p;
}

static bool
bake_set(struct cmd *cmd, const struct multilayer_opts *o,
    const struct source *s, struct bake_multilayer *ml,
    const struct bake_view *view, const char *prefix,
    struct bake_multilayer_stats *stats)
{
	struct multilayer_set set = { .maps = BAKE_LAYER_MAPS_INIT };
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	ok = bake_multilayer_maps(ml, &set.maps, stats, &err) == BAKE_OK ||
	     failed(cmd, s->path, &err);
	ok = ok && multilayer_judge(cmd, o, s->path, view, stats);
	if (ok && prefix != NULL) {
		set.meta = meta_of(o, view, set.maps.nlayers);
		ok = multilayer_write(cmd, o, s->color, &set, prefix);
	}
	bake_layer_maps_free(&set.maps);
	return ok;
}

static bool
bake_view_of(struct cmd *cmd, const struct multilayer_opts *o,
    const struct source *s, enum bake_axis axis, const char *prefix)
{
	struct bake_multilayer_stats stats = { .nlayers = 0 };
	struct bake_multilayer_params p;
	struct bake_multilayer *ml;
	struct bake_err err = BAKE_ERR_INIT;
	struct cmd_progress bar;
	struct bake_view view;
	bool ok;

	if (!make_view(cmd, o, s, axis, &view))
		return false;
	p = params_of(cmd, o, s, &view);
	p.progress = cmd_progress_start(cmd, &bar);
	ok = bake_multilayer_open(&ml, &s->mesh, &s->weld, &p, &err) ==
		 BAKE_OK ||
	     failed(cmd, s->path, &err);
	if (ok && bake_multilayer_missing_uvs(ml) > 0)
		cmd_warn(cmd,
		    "%s: %zu triangles have a texture and no UVs: their "
		    "material's colour is taken",
		    s->path, bake_multilayer_missing_uvs(ml));
	if (ok && o->deep && prefix != NULL) {
		struct bake_relief_meta meta = meta_of(o, &view, 0);

		meta.layout = BAKE_LAYOUT_LAYER_DEEP;
		ok = bake_multilayer_deepest(ml, &meta.layer.nlayers, &err) ==
			 BAKE_OK ||
		     failed(cmd, s->path, &err);
		ok = ok && multilayer_write_deep(
			       cmd, o, s->path, ml, &p, &meta, prefix, &stats);
	} else if (ok)
		ok = bake_set(cmd, o, s, ml, &view, prefix, &stats);
	cmd_progress_end(&bar);
	if (ok && o->stats)
		multilayer_print_stats(s->path, &view,
		    o->deep ? BAKE_DATA_FLOAT : p.format, &stats);
	bake_multilayer_close(ml);
	return ok;
}

char *
multilayer_view_prefix(const char *prefix, char letter)
{
	const char suffix[3] = { '_', letter, '\0' };

	if (prefix == NULL)
		return NULL;
	return cmd_path_derive(
	    prefix, NULL, letter != '\0' ? suffix : "", NULL);
}

static bool
bake_views(struct cmd *cmd, const struct multilayer_opts *o,
    const struct source *s, const char *prefix)
{
	static const enum bake_axis three[] = { BAKE_AXIS_POS_X,
		BAKE_AXIS_POS_Y, BAKE_AXIS_POS_Z };
	bool ok = true;

	if (o->nviews == 1)
		return bake_view_of(cmd, o, s, o->axis, prefix);
	for (int i = 0; i < 3 && ok; i++) {
		char *one = multilayer_view_prefix(prefix, "xyz"[i]);

		ok = bake_view_of(cmd, o, s, three[i], one);
		free(one);
	}
	return ok;
}

/* One material for the whole mesh, with that picture. */
static bool
give_texture(struct cmd *cmd, const char *picture, const char *path,
    struct bake_mesh *mesh)
{
	static const struct bake_material plain = { .color = { 1, 1, 1, 1 },
		.linear = true,
		.texture = { .uv_matrix = { { 1, 0, 0 }, { 0, 1, 0 } } } };
	struct bake_material *more =
	    realloc(mesh->materials, (mesh->nmaterials + 1) * sizeof *more);
	struct bake_material *own;

	if (more == NULL) {
		cmd_error(cmd, "%s: no memory", path);
		return false;
	}
	mesh->materials = more;
	for (size_t i = 0; i < mesh->nmaterials; i++) {
		free(more[i].texture.path);
		more[i].texture.path = NULL;
	}
	own = &more[mesh->nmaterials];
	*own = plain;
	own->name = strdup("--texture");
	own->texture.path = strdup(picture);
	mesh->nmaterials++;
	for (size_t t = 0; t < mesh->ntriangles; t++)
		mesh->material_of[t] = (int)mesh->nmaterials - 1;
	return own->name != NULL && own->texture.path != NULL;
}

bool
multilayer_mesh(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_color *color, const char *path, const char *prefix)
{
	struct source s = { path, BAKE_MESH_INIT, BAKE_WELD_INIT,
		MESH_TEXTURES_INIT, color };
	struct bake_err err = BAKE_ERR_INIT;
	bool ok = cmd_read_mesh(cmd, path, &o->mesh, &s.mesh);

	if (ok && o->texture != NULL)
		ok = give_texture(cmd, o->texture, path, &s.mesh);
	if (ok && !o->no_color)
		ok = mesh_textures_read(cmd, &s.mesh, path, color, &s.textures);
	if (ok && o->texture != NULL &&
	    s.textures.list[s.mesh.nmaterials - 1] == NULL) {
		cmd_error(cmd, "%s: cannot be read", o->texture);
		ok = false;
	}
	if (ok)
		ok = bake_mesh_weld(&s.mesh, o->weld, &s.weld, &err) ==
			 BAKE_OK ||
		     failed(cmd, path, &err);
	ok = ok && bake_views(cmd, o, &s, prefix);
	mesh_textures_free(&s.textures);
	bake_weld_free(&s.weld);
	bake_mesh_free(&s.mesh);
	return ok;
}

/* -- height fields -----------------------------------------------------------
 */

/* One row of a height field: layer 0 alone. */
static void
put_field_row(struct bake_layer_maps *maps, const struct bake_image *depth,
    const struct bake_image *normal, int y, float *row)
{
	struct bake_pixels *px[3] = { &maps->depth[0], &maps->nx[0],
		&maps->ny[0] };
	const float *d = bake_image_row(depth, y);
	const float *n = bake_image_row(normal, y);

	for (int i = 0; i < 3; i++) {
		for (int x = 0; x < maps->width; x++) {
			float *texel = row + 4 * (size_t)x;
			double clamped = d[x] < 0 ? 0 : d[x] > 1 ? 1 : d[x];

			for (int c = 1; c < 4; c++)
				texel[c] = i == 0 ? 1 : 0.5F;
			texel[0] =
			    i == 0 ? (float)bake_layer_stored(clamped)
				   : (n[3 * (size_t)x + (size_t)i - 1] + 1) / 2;
		}
		bake_pixels_put(px[i], 0, y, maps->width, row);
	}
}

static enum bake_status
field_to_maps(struct cmd *cmd, const struct multilayer_opts *o,
    const struct cmd_map *map, struct bake_layer_maps *maps,
    struct bake_err *err)
{
	const struct bake_image *depth = &map->img;
	struct bake_image normal = BAKE_IMAGE_INIT;
	float *row = NULL;
	enum bake_status rc;

	rc = bake_normal_from_depth(depth, o->depth_scale, cmd_wrap(cmd, map),
	    BAKE_SLOPE_CENTRAL, cmd->nthreads, &normal, err);
	if (rc == BAKE_OK)
		rc = bake_layer_maps_alloc(maps, depth->width, depth->height, 1,
		    multilayer_format(cmd, map->info.data_format), 0, 3,
		    BAKE_DATA_UINT8, err);
	if (rc == BAKE_OK) {
		row = calloc((size_t)depth->width, 4 * sizeof *row);
		rc = row != NULL ? BAKE_OK
				 : bake_fail(err, BAKE_ENOMEM, "no memory");
	}
	for (int y = 0; y < depth->height && rc == BAKE_OK; y++)
		put_field_row(maps, depth, &normal, y, row);
	free(row);
	bake_image_free(&normal);
	return rc;
}

/* Whether the depth image would take the place of the map itself, which a
 * second run would then read. */
static bool
replaces_input(const struct cmd *cmd, const char *map, const char *prefix)
{
	struct stat a, b;
	char *path;
	bool same;

	if (asprintf(&path, "%s_depth.%s", prefix,
		bake_file_type_name(cmd->type)) < 0)
		return false;
	same = stat(map, &a) == 0 && stat(path, &b) == 0 &&
	       a.st_dev == b.st_dev && a.st_ino == b.st_ino;
	free(path);
	return same;
}

bool
multilayer_height_field(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_color *color, const char *prefix)
{
	struct multilayer_set set = { .maps = BAKE_LAYER_MAPS_INIT,
		.meta = BAKE_RELIEF_META_INIT };
	struct cmd_map map = CMD_MAP_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	if (!o->multi_part && replaces_input(cmd, o->from_depth, prefix)) {
		cmd_error(cmd,
		    "%s: would be replaced by what is made of it: choose "
		    "another PREFIX than %s",
		    o->from_depth, prefix);
		return false;
	}
	ok = cmd_read_channel(cmd, o->from_depth, NULL, &map);

	if (ok) {
		cmd_to_depth(cmd, &map);
		ok = field_to_maps(cmd, o, &map, &set.maps, &err) == BAKE_OK ||
		     failed(cmd, o->from_depth, &err);
	}
	if (ok) {
		set.meta.normal_y = BAKE_NORMAL_Y_UP;
		set.meta.polarity = BAKE_POLARITY_DEPTH;
		set.meta.depth_scale = o->depth_scale;
		set.meta.has_wrap = true;
		set.meta.wrap = cmd_wrap(cmd, &map);
		set.meta.layer.nlayers = 1;
		ok = multilayer_write(cmd, o, color, &set, prefix);
	}
	bake_layer_maps_free(&set.maps);
	cmd_map_free(&map);
	return ok;
}
