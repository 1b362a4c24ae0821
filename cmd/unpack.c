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

static bool
write_plane(struct packed *p, int chan, const char *path,
    struct bake_relief_meta meta, bool flip)
{
	struct bake_image one = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	const struct bake_image *img = &p->map.img;
	bool ok;

	if (bake_image_alloc(&one, img->width, img->height, 1, &err) !=
	    BAKE_OK) {
		cmd_error(p->cmd, "%s: %s", path, err.msg);
		return false;
	}
	bake_image_copy_channel(&one, 0, img, p->channel[chan]);
	if (flip)
		bake_relief_flip(&one, 0);
	ok =
	    cmd_write(p->cmd, &one, path, p->map.info.data_format, &meta, NULL);
	bake_image_free(&one);
	return ok;
}

/* z of the stored x, y: sqrt(1 - x^2 - y^2), as the renderer recovers it; x
 * and y keep their bits. */
static bool
rebuild_z(struct packed *p, struct bake_image *n)
{
	struct bake_image xyz = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	ok = bake_image_alloc(&xyz, n->width, n->height, 2, &err) == BAKE_OK;
	for (int c = 0; ok && c < 2; c++)
		bake_image_copy_channel(&xyz, c, n, c);
	if (ok) {
		bake_normal_decode(&xyz, BAKE_NORMAL_CODE_UNSIGNED, false);
		ok = bake_normal_normalize(
			 &xyz, p->cmd->nthreads, NULL, &err) == BAKE_OK;
	}
	if (ok) {
		bake_normal_encode(&xyz, false);
		bake_image_copy_channel(n, 2, &xyz, 2);
	} else {
		cmd_error(p->cmd, "%s: %s", p->map.path, err.msg);
	}
	bake_image_free(&xyz);
	return ok;
}

static bool
write_normal(struct packed *p, const char *path, struct bake_relief_meta meta)
{
	struct cmd *cmd = p->cmd;
	struct bake_image n = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_normal_y from = cmd->has_normal_y ? cmd->normal_y
				  : meta.normal_y != BAKE_NORMAL_Y_UNSURE
				      ? meta.normal_y
				      : BAKE_NORMAL_Y_UP;
	bool ok;

	meta.layout = BAKE_LAYOUT_NORMAL;
	meta.normal_code = BAKE_NORMAL_CODE_UNSIGNED;
	meta.normal_y = cmd->output_normal_y != BAKE_NORMAL_Y_UNSURE
			    ? cmd->output_normal_y
			    : BAKE_NORMAL_Y_UP;
	if (bake_image_alloc(
		&n, p->map.img.width, p->map.img.height, 3, &err) != BAKE_OK) {
		cmd_error(cmd, "%s: %s", path, err.msg);
		return false;
	}
	for (int c = 0; c < 3; c++)
		bake_image_copy_channel(&n, c, &p->map.img, p->channel[c]);
	if (from != meta.normal_y)
		bake_relief_flip(&n, 1);
	ok = (!p->has_ao || rebuild_z(p, &n)) &&
	     cmd_write(cmd, &n, path, p->map.info.data_format, &meta, NULL);
	bake_image_free(&n);
	return ok;
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
