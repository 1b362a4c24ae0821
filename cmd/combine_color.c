/* rm-combine's colour maps: blended in scene-linear light. */
/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "combine_tool.h"

static bool
failed(struct cmd *cmd, const char *path, const struct bake_err *err)
{
	cmd_error(cmd, "%s: %s", path, err->msg);
	return false;
}

static const char *
space_of(const struct combine_opts *o)
{
	return o->color_space != NULL ? o->color_space : "sRGB";
}

/* A layer's share of the colour; 0 where it has none. */
static double
share_of(const struct combine_opts *o, int i)
{
	double total = 0;

	if (o->layer[i].color == NULL)
		return 0;
	if (o->color_layer > 0)
		return i == o->color_layer - 1;
	for (int k = 0; k < o->n; k++)
		if (o->layer[k].color != NULL)
			total += combine_color_weight(&o->layer[k]);
	return combine_color_weight(&o->layer[i]) / total;
}

struct blend {
	struct cmd *cmd;
	const struct combine_opts *o;
	const struct bake_color *color;
	const struct bake_combine_params *params;
	struct bake_image sum; /* r g b alpha */
	enum bake_data_format deepest;
	bool alpha; /* a map has it */
};

static bool
add_color(struct blend *b, const struct combine_layer *l, double share)
{
	struct bake_placement place = l->place;
	struct cmd_map map = CMD_MAP_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	place.tile_u *= b->o->repeat;
	place.tile_v *= b->o->repeat;
	if (!cmd_read(b->cmd, l->color, &map))
		return false;
	if (map.info.data_format > b->deepest)
		b->deepest = map.info.data_format;
	b->alpha |= map.img.nchans == 2 || map.img.nchans == 4;
	ok = map.img.nchans <= 4;
	if (!ok)
		cmd_error(b->cmd,
		    "%s: has %d channels, a colour map has at most 4", map.path,
		    map.img.nchans);
	ok = ok && ((bake_color_to_linear(b->color, space_of(b->o), &map.img,
			 b->cmd->nthreads, &err) == BAKE_OK &&
			bake_combine_add_map(&b->sum, &map.img, &place, share,
			    b->params, &err) == BAKE_OK) ||
		       failed(b->cmd, map.path, &err));
	cmd_map_free(&map);
	return ok;
}

/* r, g, b alone. */
static enum bake_status
drop_alpha(struct bake_image *img, struct bake_err *err)
{
	struct bake_image rgb = BAKE_IMAGE_INIT;
	enum bake_status rc =
	    bake_image_alloc(&rgb, img->width, img->height, 3, err);

	if (rc != BAKE_OK)
		return rc;
	for (int c = 0; c < 3; c++)
		bake_image_copy_channel(&rgb, c, img, c);
	bake_image_swap(&rgb, img);
	bake_image_free(&rgb);
	return BAKE_OK;
}

static enum bake_status
new_sum(struct blend *b, struct bake_err *err)
{
	const struct combine_opts *o = b->o;
	const bool own = o->color_width > 0;
	enum bake_status rc;

	rc = bake_image_alloc(&b->sum, own ? o->color_width : b->params->width,
	    own ? o->color_height : b->params->height, 4, err);
	if (rc == BAKE_OK)
		for (int y = 0; y < b->sum.height; y++)
			memset(bake_image_row(&b->sum, y), 0,
			    b->sum.row_stride * sizeof(float));
	return rc;
}

bool
combine_colors(struct cmd *cmd, const struct combine_opts *o,
    const struct bake_color *color, const struct bake_combine_params *params,
    struct bake_image *out, enum bake_data_format *deepest)
{
	struct blend b = { cmd, o, color, params, BAKE_IMAGE_INIT,
		BAKE_DATA_UINT8, false };
	struct bake_err err = BAKE_ERR_INIT;
	bool ok =
	    new_sum(&b, &err) == BAKE_OK || failed(cmd, o->color_out, &err);

	for (int i = 0; ok && i < o->n; i++) {
		const double share = share_of(o, i);

		if (share > 0)
			ok = add_color(&b, &o->layer[i], share);
	}
	if (ok && !b.alpha)
		ok = drop_alpha(&b.sum, &err) == BAKE_OK ||
		     failed(cmd, o->color_out, &err);
	ok = ok && (bake_color_from_linear(color, space_of(o), &b.sum,
			cmd->nthreads, &err) == BAKE_OK ||
		       failed(cmd, o->color_out, &err));
	if (ok)
		bake_image_swap(out, &b.sum);
	*deepest = b.deepest;
	bake_image_free(&b.sum);
	return ok;
}
