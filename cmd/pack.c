/* The pipeline of rm-pack: read, convert, derive, write. */
/* SPDX-License-Identifier: MIT */
#include "pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd_maps.h"
#include "cmd_target.h"
#include "integrate.h"

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
	bool derives_normal;     /* row by row, when they are written */
	struct bake_image depth; /* what is derived from; may be the relief */
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

static bool
read_normal(struct pack *p, const char *path)
{
	if (!cmd_read_normal(p->cmd, path, &p->normal))
		return false;
	p->has_normal = true;
	p->normal_y = cmd_normal_y(p->cmd, &p->normal);
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
	struct bake_relief_meta said = BAKE_RELIEF_META_INIT;

	if (!p->has_normal || p->o->no_check)
		return true;
	said.normal_y = p->normal_y;
	said.polarity = p->polarity;
	said.depth_scale = p->scale > 0 ? p->scale : default_scale;
	return cmd_warn_contradictions(p->cmd, &p->normal,
	    p->has_relief ? &p->relief : NULL, p->wrap, &said,
	    "--height, --normal-y and -s");
}

/* -- sizes ---------------------------------------------------------------- */

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

	if (p->has_relief && !cmd_resize(p->cmd, &p->relief, p->wrap, w, h))
		return false;
	if (p->has_ao && !cmd_resize(p->cmd, &p->ao, p->wrap, w, h))
		return false;
	if (p->has_normal && !cmd_resize(p->cmd, &p->normal, p->wrap, w, h))
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

/*
 * The relief as depth, with its 8-bit steps smoothed if asked for: what is
 * stored keeps its codes. A copy only where the two differ.
 */
static bool
make_depth(struct pack *p)
{
	const bool smooth =
	    p->o->dequantize && p->relief.info.data_format == BAKE_DATA_UINT8;
	struct bake_err err = BAKE_ERR_INIT;

	if (p->polarity == BAKE_POLARITY_HEIGHT &&
	    p->o->target->polarity == BAKE_POLARITY_DEPTH) {
		bake_relief_flip(&p->relief.img, 0);
		p->polarity = BAKE_POLARITY_DEPTH;
	}
	p->depth = p->relief.img;
	if (smooth || p->polarity == BAKE_POLARITY_HEIGHT) {
		if (bake_image_alloc(&p->depth, p->relief.img.width,
			p->relief.img.height, 1, &err) != BAKE_OK)
			return failed(p, p->relief.path, &err);
		bake_image_copy_channel(&p->depth, 0, &p->relief.img, 0);
	}
	if (p->polarity == BAKE_POLARITY_HEIGHT)
		bake_relief_flip(&p->depth, 0);
	/* an integrated depth has no info, and no steps */
	return p->relief.info.width == 0 ||
	       cmd_smooth_steps(p->cmd, &p->relief, &p->depth, p->scale,
		   p->wrap, p->o->dequantize);
}

static void
free_depth(struct pack *p)
{
	if (p->depth.data != p->relief.img.data)
		bake_image_free(&p->depth);
	p->depth = (struct bake_image)BAKE_IMAGE_INIT;
}

static bool
bake_occlusion(struct pack *p)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_ao_params params = p->o->ao;
	struct bake_ao_result res = { &p->ao.img, NULL, NULL };
	struct cmd_progress bar;
	enum bake_status rc;

	params.wrap = p->wrap;
	params.nthreads = p->cmd->nthreads;
	params.progress = cmd_progress_start(p->cmd, &bar);
	rc = bake_ao(&p->depth, &p->scale, 1, &params, &res, &err);
	cmd_progress_end(&bar);
	p->has_ao = true;
	return rc == BAKE_OK || failed(p, p->relief.path, &err);
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
derive_missing(struct pack *p)
{
	bool want_ao = !p->has_ao && !p->o->no_ao &&
		       uses_source(p->o->target, BAKE_SOURCE_AO);

	if (!p->has_relief && !derive_relief(p))
		return false;
	if (p->scale == 0)
		p->scale = default_scale;
	p->derives_normal = !p->has_normal;
	if (p->derives_normal)
		p->normal_y = BAKE_NORMAL_Y_UP;
	if ((p->derives_normal || want_ao) && !make_depth(p))
		return false;
	return !want_ao || bake_occlusion(p);
}

/* -- writing -------------------------------------------------------------- */

static void
fill_with_one(struct bake_image *band)
{
	for (int y = 0; y < band->height; y++)
		for (int x = 0; x < band->width; x++)
			bake_image_row(band, y)[x] = 1.0f;
}

static enum bake_status
get_band(
    void *arg, int y, const struct cmd_target_band *band, struct bake_err *err)
{
	const struct pack *p = arg;
	enum bake_status rc = BAKE_OK;

	if (band->normal != NULL && p->derives_normal) {
		rc = bake_normal_rows_from_depth(&p->depth, p->scale, p->wrap,
		    p->o->slope, 1, y, band->normal, err);
		if (rc == BAKE_OK)
			bake_normal_encode(band->normal, false);
	} else if (band->normal != NULL) {
		cmd_target_copy(band->normal, &p->normal.img, y);
	}
	if (band->ao != NULL && p->has_ao)
		cmd_target_copy(band->ao, &p->ao.img, y);
	else if (band->ao != NULL)
		fill_with_one(band->ao);
	if (band->relief != NULL)
		cmd_target_copy(band->relief, &p->relief.img, y);
	return rc;
}

static bool
write_all(struct pack *p, const char *out)
{
	struct cmd_target_maps maps = { p->relief.img.width,
		p->relief.img.height, get_band, p, BAKE_RELIEF_META_INIT,
		p->deepest, p->o->exr_names };

	maps.meta.polarity = p->polarity;
	maps.meta.normal_y = p->normal_y;
	maps.meta.depth_scale = p->scale;
	if (bake_relief_meta_ao_scale(&p->ao.meta) > 0)
		bake_relief_meta_set_ao_scale(
		    &maps.meta, bake_relief_meta_ao_scale(&p->ao.meta));
	maps.meta.has_wrap = true;
	maps.meta.wrap = p->wrap;
	return cmd_write_target(p->cmd, p->o->target, &maps, out);
}

bool
pack_set(struct cmd *cmd, const struct pack_opts *o,
    const struct pack_inputs *in, const char *out)
{
	struct pack p = { .cmd = cmd, .o = o };
	bool ok;

	ok = read_maps(&p, in) && check_agreement(&p) && unify_sizes(&p) &&
	     derive_missing(&p) && write_all(&p, out);
	free_depth(&p);
	cmd_map_free(&p.normal);
	cmd_map_free(&p.relief);
	cmd_map_free(&p.ao);
	return ok;
}
