/* rm-multilayer: what was found, judged and printed. */
/* SPDX-License-Identifier: MIT */
#include "multilayer_tool.h"

static size_t
texels(const struct bake_view *view)
{
	return (size_t)view->width * (size_t)view->height;
}

static void
warn_losses(struct cmd *cmd, const char *path, const struct bake_view *view,
    const struct bake_multilayer_stats *s)
{
	const struct bake_layer_stats *c = &s->codes;

	if (c->capped > 0)
		cmd_warn(cmd,
		    "%s: %zu of %zu texels have more than %d layers (up to "
		    "%d), %zu were left out; --layers all keeps them",
		    path, c->capped, texels(view), s->nlayers, s->rays.most,
		    c->removed);
	if (c->clamped > 0)
		cmd_warn(cmd,
		    "%s: %zu layers lie outside the depth range and were "
		    "clamped, %zu slabs wholly so were dropped",
		    path, c->clamped, c->cut);
	if (s->rays.inside_out > 0)
		cmd_warn(cmd,
		    "%s: %zu of %zu texels enter the solid through its inside, "
		    "where the mesh crosses itself or a part is inside out; "
		    "they are solid there",
		    path, s->rays.inside_out, texels(view));
	if (c->merged > 0)
		cmd_note(cmd,
		    "%s: %zu slabs are nearer to another than one code and "
		    "became one with it; -d uint16 keeps more",
		    path, c->merged);
	if (s->histogram[0] == texels(view))
		cmd_warn(
		    cmd, "%s: nothing is in the region: all is empty", path);
}

bool
multilayer_judge(struct cmd *cmd, const struct multilayer_opts *o,
    const char *path, const struct bake_view *view,
    const struct bake_multilayer_stats *s)
{
	if (s->rays.open > 0) {
		cmd_error(cmd,
		    "%s: %zu of %zu texels do not close: the mesh is open or "
		    "cracked there; %s--solidify T makes slabs of its surfaces",
		    path, s->rays.open, texels(view),
		    o->weld > 0 ? "" : "--weld EPS joins near vertices, ");
		return false;
	}
	if (2 * s->rays.inside_out > texels(view) - s->histogram[0]) {
		cmd_error(cmd,
		    "%s: %zu of %zu texels enter the solid through its inside: "
		    "the mesh is inside out there; %s",
		    path, s->rays.inside_out, texels(view),
		    o->reorient ? "its parts do not agree, make its winding "
				  "consistent"
				: "--reorient turns it round");
		return false;
	}
	warn_losses(cmd, path, view, s);
	return true;
}

bool
multilayer_print_stats(const char *path, const struct bake_view *view,
    enum bake_data_format format, const struct bake_multilayer_stats *s)
{
	const double range = view->near - view->far;

	printf("file\t%s\nsize\t%dx%d\naxis\t%s\n", path, view->width,
	    view->height, bake_axis_name(view->axis));
	printf("region\t%.9g,%.9g,%.9g,%.9g\n", view->x0, view->y0, view->x1,
	    view->y1);
	printf("depth range\t%.9g,%.9g\n", view->near, view->far);
	for (int i = 0; i <= BAKE_LAYERS_MAX; i++)
		if (s->histogram[i] > 0)
			printf(
			    "texels with %d layers\t%zu\n", i, s->histogram[i]);
	printf("deepest texel\t%d\n", s->rays.most);
	printf("crossings\t%zu\n", s->rays.crossings);
	printf("texels united\t%zu\n", s->rays.united);
	printf("texels capped\t%zu\nlayers left out\t%zu\n", s->codes.capped,
	    s->codes.removed);
	printf("slabs merged\t%zu\nslabs widened\t%zu\n", s->codes.merged,
	    s->codes.widened);
	printf("layers clamped\t%zu\nslabs cut\t%zu\n", s->codes.clamped,
	    s->codes.cut);
	printf("data format\t%s\n", bake_data_format_name(format));
	printf("largest depth error\t%.3g\n", s->codes.max_error * range);
	return true;
}
