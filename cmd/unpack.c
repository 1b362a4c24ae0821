/* rm-pack --unpack: a packed texture back into its maps. */
/* SPDX-License-Identifier: MIT */
#include "normal.h"
#include "pack.h"

struct packed {
	struct cmd *cmd;
	struct cmd_map map;
	int channel[4];
	bool has_ao; /* the third channel is AO, not normal z */
};

/* One of the outputs while it is written. */
struct plane {
	const struct packed *p;
	int first; /* of the packed texture's channels in their order */
	bool flip; /* the relief, or the normals' y */
};

/* Rows y … of the plane's channels as they are stored. */
static void
take_rows(const struct plane *plane, int y, struct bake_image *band)
{
	struct bake_image rows = plane->p->map.img;

	rows.data = bake_image_row(&plane->p->map.img, y);
	for (int c = 0; c < band->nchans; c++)
		bake_image_copy_channel(
		    band, c, &rows, plane->p->channel[plane->first + c]);
}

static enum bake_status
get_plane(void *arg, int y, int n, float *rows, struct bake_err *err)
{
	const struct plane *plane = arg;
	const int w = plane->p->map.img.width;
	struct bake_image band = { w, n, 1, (size_t)w, rows };

	(void)err;
	take_rows(plane, y, &band);
	if (plane->flip)
		bake_relief_flip(&band, 0);
	return BAKE_OK;
}

/* z of the stored x, y: sqrt(1 - x^2 - y^2), as the renderer recovers it; x
 * and y keep their bits. */
static enum bake_status
rebuild_z(struct bake_image *n, struct bake_err *err)
{
	struct bake_image xyz = BAKE_IMAGE_INIT;
	enum bake_status rc;

	rc = bake_image_alloc(&xyz, n->width, n->height, 2, err);
	for (int c = 0; rc == BAKE_OK && c < 2; c++)
		bake_image_copy_channel(&xyz, c, n, c);
	if (rc == BAKE_OK) {
		bake_normal_decode(&xyz, BAKE_NORMAL_CODE_UNSIGNED, false);
		rc = bake_normal_normalize(&xyz, 1, NULL, err);
	}
	if (rc == BAKE_OK) {
		bake_normal_encode(&xyz, false);
		bake_image_copy_channel(n, 2, &xyz, 2);
	}
	bake_image_free(&xyz);
	return rc;
}

static enum bake_status
get_normal(void *arg, int y, int n, float *rows, struct bake_err *err)
{
	const struct plane *plane = arg;
	const int w = plane->p->map.img.width;
	struct bake_image band = { w, n, 3, (size_t)w * 3, rows };

	take_rows(plane, y, &band);
	if (plane->flip)
		bake_relief_flip(&band, 1);
	return plane->p->has_ao ? rebuild_z(&band, err) : BAKE_OK;
}

static bool
write_plane(struct packed *p, int chan, const char *path,
    struct bake_relief_meta meta, bool flip)
{
	struct plane plane = { .p = p, .first = chan, .flip = flip };
	const struct bake_row_source rows = { p->map.img.width,
		p->map.img.height, 1, get_plane, &plane };

	return cmd_write_rows(
	    p->cmd, &rows, path, p->map.info.data_format, &meta, NULL);
}

static bool
write_normal(struct packed *p, const char *path, struct bake_relief_meta meta)
{
	struct cmd *cmd = p->cmd;
	struct plane plane = { .p = p };
	const struct bake_row_source rows = { p->map.img.width,
		p->map.img.height, 3, get_normal, &plane };
	enum bake_normal_y from = cmd->has_normal_y ? cmd->normal_y
				  : meta.normal_y != BAKE_NORMAL_Y_UNSURE
				      ? meta.normal_y
				      : BAKE_NORMAL_Y_UP;

	meta.layout = BAKE_LAYOUT_NORMAL;
	meta.normal_code = BAKE_NORMAL_CODE_UNSIGNED;
	meta.normal_y = cmd->output_normal_y != BAKE_NORMAL_Y_UNSURE
			    ? cmd->output_normal_y
			    : BAKE_NORMAL_Y_UP;
	plane.flip = from != meta.normal_y;
	return cmd_write_rows(
	    cmd, &rows, path, p->map.info.data_format, &meta, NULL);
}

static bool
look_at_packed(struct packed *p, bool want_ao)
{
	const struct cmd_map *m = &p->map;

	if (!cmd_packed_channels(&m->info, p->channel)) {
		cmd_error(p->cmd,
		    "%s: has %d channel%s, a packed texture has 4", m->path,
		    m->info.nchans, m->info.nchans == 1 ? "" : "s");
		return false;
	}
	p->has_ao = m->meta.layout != BAKE_LAYOUT_NORMAL_RELIEF;
	if (want_ao && !p->has_ao) {
		cmd_error(p->cmd, "%s: holds no AO: its blue is the normals' z",
		    m->path);
		return false;
	}
	return true;
}

bool
unpack_file(struct cmd *cmd, const char *in, const struct unpack_outputs *out)
{
	struct packed p = { .cmd = cmd };
	struct bake_relief_meta meta;
	bool height, ok;

	if (!cmd_read(cmd, in, &p.map))
		return false;
	ok = look_at_packed(&p, out->ao != NULL);
	meta = p.map.meta;
	meta.has_ao_scale = false;
	height = cmd->has_polarity ? cmd->polarity == BAKE_POLARITY_HEIGHT
				   : meta.polarity == BAKE_POLARITY_HEIGHT;
	if (ok && out->normal != NULL)
		ok = write_normal(&p, out->normal, meta);
	meta.normal_y = BAKE_NORMAL_Y_UNSURE;
	meta.normal_code = BAKE_NORMAL_CODE_AUTO;
	meta.polarity = BAKE_POLARITY_UNSURE;
	meta.layout = BAKE_LAYOUT_AO;
	meta.depth_scale = bake_relief_meta_ao_scale(&p.map.meta);
	if (ok && out->ao != NULL)
		ok = write_plane(&p, 2, out->ao, meta, false);
	meta.depth_scale = p.map.meta.depth_scale;
	meta.polarity =
	    out->height ? BAKE_POLARITY_HEIGHT : BAKE_POLARITY_DEPTH;
	meta.layout = BAKE_LAYOUT_DEPTH;
	if (ok && out->depth != NULL)
		ok =
		    write_plane(&p, 3, out->depth, meta, height != out->height);
	cmd_map_free(&p.map);
	return ok;
}
