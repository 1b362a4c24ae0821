/* The pipeline of rm-pack: read, convert, derive, write. */
/* SPDX-License-Identifier: MIT */
#include "pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "inspect.h"
#include "integrate.h"
#include "resample.h"

/*
 * What is known of one set while it is being packed. Normals are held as they
 * are stored, code 0 .. 1 and y as in the file, until something has to be
 * computed: a map that needs no change keeps its bits.
 */
struct pack {
	struct cmd *cmd;
	const struct pack_opts *o;
	struct cmd_map normal, relief, ao;
	bool has_normal, has_relief, has_ao;
	enum bake_normal_y normal_y;
	enum bake_polarity polarity;
	enum bake_data_format deepest;
	struct bake_wrap wrap;
	double scale;
};

static const double default_scale = 0.1;

static bool
failed(const struct pack *p, const char *path, const struct bake_err *err)
{
	cmd_error(p->cmd, "%s: %s", path, err->msg);
	return false;
}

/* Signed components with y as stored, or up. */
static enum bake_status
signed_normals(const struct pack *p, bool y_up, struct bake_image *out,
    struct bake_err *err)
{
	const struct bake_image *in = &p->normal.img;
	enum bake_status rc;

	rc = bake_image_alloc(out, in->width, in->height, 3, err);
	if (rc != BAKE_OK)
		return rc;
	for (int c = 0; c < 3; c++)
		bake_image_copy_channel(out, c, in, c);
	bake_normal_decode(out, BAKE_NORMAL_CODE_UNSIGNED,
	    y_up && p->normal_y == BAKE_NORMAL_Y_DOWN);
	return BAKE_OK;
}

/* -- reading ---------------------------------------------------------- */

/* x, y, z into channels 0, 1, 2: by the names R, G, B, else the first three;
 * with two channels, or a packed texture's, z is computed. */
static bool
arrange_normal(struct pack *p)
{
	struct cmd_map *m = &p->normal;
	struct bake_image xyz = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool packed = m->meta.layout == BAKE_LAYOUT_RELIEF;
	int n = packed || m->img.nchans == 2 ? 2 : 3, packed_chan[4];

	if (m->img.nchans < 2) {
		cmd_error(p->cmd,
		    "%s: has 1 channel, a normal map has x, y and z", m->path);
		return false;
	}
	if (bake_image_alloc(&xyz, m->img.width, m->img.height, n, &err) !=
	    BAKE_OK)
		return failed(p, m->path, &err);
	for (int c = 0; c < n; c++) {
		const char letter[2] = { "RGB"[c], '\0' };
		int from = cmd_channel_index(&m->info, letter);

		if (packed && cmd_packed_channels(&m->info, packed_chan))
			from = packed_chan[c];
		bake_image_copy_channel(&xyz, c, &m->img, from < 0 ? c : from);
	}
	bake_image_swap(&xyz, &m->img);
	bake_image_free(&xyz);
	return true;
}

/* Whatever the code, to the unsigned one; z for maps that have none. */
static bool
unify_code(struct pack *p)
{
	struct cmd_map *m = &p->normal;
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_normal_code code = cmd_normal_code(p->cmd, m);
	bool rebuild = m->img.nchans == 2;

	if (!rebuild && code == BAKE_NORMAL_CODE_UNSIGNED)
		return true;
	bake_normal_decode(&m->img, code, false);
	if (rebuild && bake_normal_normalize(
			   &m->img, p->cmd->nthreads, NULL, &err) != BAKE_OK)
		return failed(p, m->path, &err);
	bake_normal_encode(&m->img, false);
	return true;
}

static bool
read_normal(struct pack *p, const char *path)
{
	struct cmd *cmd = p->cmd;

	if (!cmd_read(cmd, path, &p->normal) || !arrange_normal(p) ||
	    !unify_code(p))
		return false;
	p->has_normal = true;
	p->normal_y = cmd->has_normal_y              ? cmd->normal_y
		      : p->normal.meta.normal_y != 0 ? p->normal.meta.normal_y
						     : BAKE_NORMAL_Y_UP;
	return true;
}

static void
note_format(struct pack *p, const struct cmd_map *map)
{
	if (map->info.data_format > p->deepest)
		p->deepest = map->info.data_format;
}

static bool
read_maps(struct pack *p, const struct pack_inputs *in)
{
	struct cmd *cmd = p->cmd;

	if (in->depth != NULL) {
		if (!cmd_read_channel(
			cmd, in->depth, p->o->depth_channel, &p->relief))
			return false;
		p->has_relief = true;
		p->polarity = cmd_relief_range(cmd, &p->relief);
		note_format(p, &p->relief);
	}
	if (in->normal != NULL) {
		if (!read_normal(p, in->normal))
			return false;
		note_format(p, &p->normal);
	}
	if (in->ao != NULL) {
		if (!cmd_read_channel(cmd, in->ao,
			p->o->ao_channel != NULL ? p->o->ao_channel : "0",
			&p->ao))
			return false;
		p->has_ao = true;
		note_format(p, &p->ao);
	}
	p->wrap = cmd_wrap(cmd, p->has_relief ? &p->relief : &p->normal);
	p->scale = p->o->depth_scale;
	if (p->scale == 0 && p->has_relief)
		p->scale = p->relief.meta.depth_scale;
	if (p->scale == 0 && p->has_normal)
		p->scale = p->normal.meta.depth_scale;
	return true;
}

/* -- agreement ---------------------------------------------------------- */

/* Warn where the maps contradict what was said of them. */
static bool
check_agreement(struct pack *p)
{
	struct bake_maps maps = BAKE_MAPS_INIT;
	struct bake_inspection found = { .layout = BAKE_LAYOUT_UNKNOWN };
	struct bake_contradictions bad;
	struct bake_relief_meta said = BAKE_RELIEF_META_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_status rc;

	if (!p->has_normal || p->o->no_check || p->cmd->quiet)
		return true;
	said.normal_y = p->normal_y;
	said.polarity = p->polarity;
	said.depth_scale = p->scale > 0 ? p->scale : default_scale;
	rc = signed_normals(p, false, &maps.normal, &err);
	if (p->has_relief)
		maps.relief = p->relief.img; /* a view */
	if (rc == BAKE_OK)
		rc = bake_inspect_maps(&found, &maps, p->wrap, &err);
	bake_image_free(&maps.normal);
	if (rc != BAKE_OK)
		return failed(p, p->normal.path, &err);
	bake_contradictions_find(&bad, &found, &said);
	for (int i = 0; i < bad.n; i++)
		cmd_warn(p->cmd, "%s%s%s: %s", p->normal.path,
		    p->has_relief ? " + " : "",
		    p->has_relief ? p->relief.path : "", bad.text[i]);
	if (bad.n > 0)
		cmd_warn(p->cmd,
		    "%s: --height, --normal-y and -s say what the maps are",
		    p->normal.path);
	return true;
}

/* -- sizes ---------------------------------------------------------------- */

static bool
resample_to(struct pack *p, struct cmd_map *map, int width, int height)
{
	struct bake_image out = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	if (map->img.width == width && map->img.height == height)
		return true;
	if ((long)map->img.width * height != (long)map->img.height * width)
		cmd_warn(p->cmd,
		    "%s: %dx%d is stretched to %dx%d, so that its texels are "
		    "no longer square",
		    map->path, map->img.width, map->img.height, width, height);
	if (bake_resample(&map->img, p->wrap, BAKE_FILTER_CATMULL_ROM, width,
		height, p->cmd->nthreads, &out, &err) != BAKE_OK)
		return failed(p, map->path, &err);
	bake_image_swap(&out, &map->img);
	bake_image_free(&out);
	cmd_note(p->cmd, "%s: resampled to %dx%d", map->path, width, height);
	return true;
}

/* Unit length again, in stored code and with y as stored. */
static bool
renormalize(struct pack *p)
{
	struct bake_err err = BAKE_ERR_INIT;

	bake_normal_decode(&p->normal.img, BAKE_NORMAL_CODE_UNSIGNED, false);
	if (bake_normal_normalize(
		&p->normal.img, p->cmd->nthreads, NULL, &err) != BAKE_OK)
		return failed(p, p->normal.path, &err);
	bake_normal_encode(&p->normal.img, false);
	return true;
}

static bool
unify_sizes(struct pack *p)
{
	const struct bake_image *size =
	    p->has_relief ? &p->relief.img : &p->normal.img;
	int w = p->o->width > 0 ? p->o->width : size->width;
	int h = p->o->height > 0 ? p->o->height : size->height;
	bool stretched = p->has_normal && (p->normal.img.width != w ||
					      p->normal.img.height != h);

	if (p->has_relief && !resample_to(p, &p->relief, w, h))
		return false;
	if (p->has_ao && !resample_to(p, &p->ao, w, h))
		return false;
	if (p->has_normal && !resample_to(p, &p->normal, w, h))
		return false;
	if (p->has_normal && (stretched || p->o->renormalize))
		return renormalize(p);
	return true;
}

/* -- what is missing ------------------------------------------------------ */

/* Heights from the normals, damped as asked for, or as their origin wants. */
static enum bake_status
integrate(struct pack *p, struct bake_err *err)
{
	struct bake_integrate_params params = { p->wrap, p->o->slope,
		p->o->damping, p->cmd->nthreads };
	struct bake_image n = BAKE_IMAGE_INIT;
	enum bake_status rc = signed_normals(p, true, &n, err);

	if (params.damping < 0)
		params.damping = 0;
	if (rc == BAKE_OK && p->o->damping < 0 &&
	    p->normal.info.data_format == BAKE_DATA_UINT8)
		rc = bake_integrate_damping(&n, &params, &params.damping, err);
	if (rc == BAKE_OK)
		rc = bake_integrate(&n, &params, &p->relief.img, NULL, err);
	bake_image_free(&n);
	cmd_note(p->cmd, "%s: integrated with damping %g", p->normal.path,
	    params.damping);
	return rc;
}

static bool
derive_relief(struct pack *p)
{
	struct bake_err err = BAKE_ERR_INIT;
	double scale = p->scale;
	size_t nclipped = 0;

	if (integrate(p, &err) != BAKE_OK ||
	    bake_depth_from_height(&p->relief.img, &scale, &nclipped, &err) !=
		BAKE_OK)
		return failed(p, p->normal.path, &err);
	if (nclipped > 0)
		cmd_warn(p->cmd,
		    "%s: its relief is deeper than the depth scale %.3g; %zu "
		    "texels clipped (without -s the scale is the relief's own)",
		    p->normal.path, scale, nclipped);
	cmd_note(p->cmd, "%s: depth scale %.4g", p->normal.path, scale);
	p->scale = scale;
	p->relief.path = p->normal.path;
	p->polarity = BAKE_POLARITY_DEPTH;
	p->has_relief = true;
	return true;
}

/* A copy of the relief as depth, with its 8-bit steps smoothed if asked for:
 * what is stored keeps its codes. */
static bool
copy_depth(struct pack *p, struct bake_image *depth)
{
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_image_alloc(depth, p->relief.img.width, p->relief.img.height,
		1, &err) != BAKE_OK)
		return failed(p, p->relief.path, &err);
	bake_image_copy_channel(depth, 0, &p->relief.img, 0);
	if (p->polarity == BAKE_POLARITY_HEIGHT)
		bake_relief_flip(depth, 0);
	/* an integrated depth has no info, and no steps */
	return p->relief.info.width == 0 ||
	       cmd_smooth_steps(p->cmd, &p->relief, depth, p->scale, p->wrap,
		   p->o->dequantize);
}

static enum bake_status
bake_normals(
    struct pack *p, const struct bake_image *depth, struct bake_err *err)
{
	enum bake_status rc = bake_normal_from_depth(depth, p->scale, p->wrap,
	    p->o->slope, p->cmd->nthreads, &p->normal.img, err);

	if (rc == BAKE_OK)
		bake_normal_encode(&p->normal.img, false);
	p->normal_y = BAKE_NORMAL_Y_UP;
	p->has_normal = true;
	return rc;
}

static enum bake_status
bake_occlusion(
    struct pack *p, const struct bake_image *depth, struct bake_err *err)
{
	struct bake_ao_params params = p->o->ao;
	struct bake_ao_result res = { &p->ao.img, NULL, NULL };
	struct cmd_progress bar;
	enum bake_status rc;

	params.wrap = p->wrap;
	params.nthreads = p->cmd->nthreads;
	params.progress = cmd_progress_start(p->cmd, &bar);
	rc = bake_ao(depth, &p->scale, 1, &params, &res, err);
	cmd_progress_end(&bar);
	p->has_ao = true;
	return rc;
}

static bool
derive_from_depth(struct pack *p, bool want_normal, bool want_ao)
{
	struct bake_image depth = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok = copy_depth(p, &depth);

	if (ok && want_normal)
		ok = bake_normals(p, &depth, &err) == BAKE_OK ||
		     failed(p, p->relief.path, &err);
	if (ok && want_ao)
		ok = bake_occlusion(p, &depth, &err) == BAKE_OK ||
		     failed(p, p->relief.path, &err);
	bake_image_free(&depth);
	return ok;
}

static bool
uses_source(const struct bake_target *target, enum bake_source source)
{
	for (int f = 0; f < target->nfiles; f++)
		for (int c = 0; c < target->file[f].nchans; c++)
			if (target->file[f].source[c] == source)
				return true;
	return false;
}

static bool
fill_with_one(struct pack *p)
{
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_image_alloc(&p->ao.img, p->relief.img.width,
		p->relief.img.height, 1, &err) != BAKE_OK)
		return failed(p, p->relief.path, &err);
	for (int y = 0; y < p->ao.img.height; y++)
		for (int x = 0; x < p->ao.img.width; x++)
			bake_image_row(&p->ao.img, y)[x] = 1.0f;
	p->has_ao = true;
	return true;
}

static bool
derive_missing(struct pack *p)
{
	bool want_ao = !p->has_ao && !p->o->no_ao &&
		       uses_source(p->o->target, BAKE_SOURCE_AO);

	if (!p->has_relief && !derive_relief(p))
		return false;
	if (p->scale == 0)
		p->scale = default_scale;
	if ((!p->has_normal || want_ao) &&
	    !derive_from_depth(p, !p->has_normal, want_ao))
		return false;
	return p->has_ao || fill_with_one(p);
}

/* -- writing -------------------------------------------------------------- */

/* y and polarity as the output wants them. */
static void
turn(struct pack *p, enum bake_normal_y normal_y)
{
	if (p->normal_y != normal_y)
		bake_relief_flip(&p->normal.img, 1);
	if (p->polarity != p->o->target->polarity)
		bake_relief_flip(&p->relief.img, 0);
	p->normal_y = normal_y;
	p->polarity = p->o->target->polarity;
}

static bool
write_file(struct pack *p, const struct bake_target_file *file, const char *out)
{
	static const char *const exr_names[] = { "normal.x", "normal.y", "ao",
		"depth" };
	struct bake_relief_meta meta = BAKE_RELIEF_META_INIT;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	char *path = cmd_path_derive(out, NULL, file->suffix, NULL);
	bool ok;

	meta.layout = file->layout;
	meta.polarity = p->polarity;
	meta.normal_y = p->normal_y;
	meta.normal_code = BAKE_NORMAL_CODE_UNSIGNED;
	meta.depth_scale = p->scale;
	meta.has_wrap = true;
	meta.wrap = p->wrap;
	ok = bake_relief_pack(file, &p->normal.img, &p->ao.img, &p->relief.img,
		 &img, &err) == BAKE_OK ||
	     failed(p, path, &err);
	ok = ok && cmd_write(p->cmd, &img, path, p->deepest, &meta,
		       p->o->exr_names && file->layout == BAKE_LAYOUT_RELIEF
			   ? exr_names
			   : NULL);
	bake_image_free(&img);
	free(path);
	return ok;
}

bool
pack_set(struct cmd *cmd, const struct pack_opts *o,
    const struct pack_inputs *in, const char *out)
{
	struct pack p = { .cmd = cmd, .o = o };
	enum bake_normal_y y = cmd->output_normal_y != BAKE_NORMAL_Y_UNSURE
				   ? cmd->output_normal_y
				   : o->target->normal_y;
	bool ok;

	ok = read_maps(&p, in) && check_agreement(&p) && unify_sizes(&p) &&
	     derive_missing(&p);
	if (ok)
		turn(&p, y);
	for (int f = 0; ok && f < o->target->nfiles; f++)
		ok = write_file(&p, &o->target->file[f], out);
	cmd_map_free(&p.normal);
	cmd_map_free(&p.relief);
	cmd_map_free(&p.ao);
	return ok;
}
