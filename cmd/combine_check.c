/* Whether what rm-combine was asked for makes sense; the layers' weights. */
/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "cmd_target.h"
#include "combine_tool.h"

static double
weight_of(double own, const struct combine_layer *l)
{
	return own >= 0 ? own : l->weight >= 0 ? l->weight : 1;
}

double
combine_normal_weight(const struct combine_layer *l)
{
	return weight_of(l->normal_weight, l);
}

double
combine_depth_weight(const struct combine_layer *l)
{
	return weight_of(l->depth_weight, l);
}

double
combine_color_weight(const struct combine_layer *l)
{
	return weight_of(l->color_weight, l);
}

bool
combine_is_removed(const struct combine_layer *l)
{
	return combine_normal_weight(l) == 0 && combine_depth_weight(l) == 0;
}

const char *
combine_name(const struct combine_layer *l)
{
	return l->packed != NULL   ? l->packed
	       : l->depth != NULL  ? l->depth
	       : l->normal != NULL ? l->normal
				   : l->ao;
}

static bool
layer_is_whole(const struct cmd *cmd, const struct combine_opts *o, int i)
{
	const struct combine_layer *l = &o->layer[i];
	const bool normal = combine_normal_weight(l) > 0 &&
			    o->normal_blend != BAKE_NORMAL_FROM_DEPTH;

	if (l->packed != NULL)
		return true;
	if (l->depth == NULL &&
	    (combine_depth_weight(l) > 0 || l->normal == NULL))
		return cmd_usage_error(cmd,
		    "layer %d, %s, has no depth: give --depth, or before it "
		    "--depth-weight 0",
		    i + 1, combine_name(l) != NULL ? combine_name(l) : "");
	if (normal && l->normal == NULL)
		return cmd_usage_error(cmd,
		    "layer %d, %s, has no normals: give --normal, or "
		    "--normal-blend from-depth, or pack it with rm-pack",
		    i + 1, combine_name(l));
	return true;
}

static bool
weights_are_clear(const struct cmd *cmd, const struct combine_opts *o)
{
	double normals = 0, depths = 0;

	for (int i = 0; i < o->n; i++) {
		normals += combine_normal_weight(&o->layer[i]);
		depths += combine_depth_weight(&o->layer[i]);
	}
	if (depths == 0)
		return cmd_usage_error(
		    cmd, "all depth weights are 0: no layer is left");
	if (normals == 0 && o->normal_blend != BAKE_NORMAL_FROM_DEPTH)
		return cmd_usage_error(
		    cmd, "all normal weights are 0: no layer is left");
	return true;
}

static bool
colors_are_clear(const struct cmd *cmd, const struct combine_opts *o)
{
	enum bake_file_type type;
	int given = 0, used = 0;

	for (int i = 0; i < o->n; i++) {
		const bool has = o->layer[i].color != NULL;

		given += has;
		used += has && combine_color_weight(&o->layer[i]) > 0;
	}
	if (o->color_out == NULL)
		return given == 0 ||
		       cmd_usage_error(cmd,
			   "--color without --color-out: where to write it?");
	if (!bake_file_type_from_path(o->color_out, &type))
		return cmd_usage_error(cmd, CMD_NO_TYPE, o->color_out);
	if (cmd->output != NULL && strcmp(cmd->output, o->color_out) == 0)
		return cmd_usage_error(
		    cmd, "-o and --color-out both name %s", o->color_out);
	if (o->color_layer > o->n)
		return cmd_usage_error(cmd, "--color-layer is %d of %d layers",
		    o->color_layer, o->n);
	if (o->color_layer > 0 && o->layer[o->color_layer - 1].color == NULL)
		return cmd_usage_error(cmd,
		    "--color-layer is %d, but layer %d has no --color before "
		    "it",
		    o->color_layer, o->color_layer);
	if (given == 0)
		return cmd_usage_error(
		    cmd, "--color-out: no layer has a --color before it");
	if (o->color_layer == 0 && used == 0)
		return cmd_usage_error(
		    cmd, "all colour weights are 0: no colour is left");
	return true;
}

bool
combine_args_are_clear(struct cmd *cmd, struct combine_opts *o)
{
	if (o->has_maps)
		combine_end_layer(o);
	if (o->pending != NULL)
		return cmd_usage_error(cmd,
		    "--%s is followed by no layer: a layer's options stand "
		    "before it",
		    o->pending);
	if (o->n == 0)
		return cmd_usage_error(cmd, "no input");
	if (cmd->output_dir != NULL)
		return cmd_usage_error(cmd,
		    "-O means nothing here: all layers make one texture; "
		    "give -o FILE");
	if (cmd->output == NULL)
		return cmd_usage_error(cmd, "no output: give -o FILE");
	if (!cmd_target_fits(cmd, o->target))
		return false;
	for (int i = 0; i < o->n; i++)
		/* the first is read whatever its weight */
		if ((i == 0 || !combine_is_removed(&o->layer[i])) &&
		    !layer_is_whole(cmd, o, i))
			return false;
	return weights_are_clear(cmd, o) && colors_are_clear(cmd, o);
}
