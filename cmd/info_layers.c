/* What rm-info says of a texture of a multilayer set. */
/* SPDX-License-Identifier: MIT */
#include "info.h"

#include <stdio.h>

void
info_contradict(struct info_report *r, size_t n, const char *what)
{
	struct bake_contradictions *bad = &r->bad;

	if (n == 0 || bad->n == BAKE_CONTRADICTIONS)
		return;
	snprintf(bad->text[bad->n++], BAKE_CONTRADICTION, "%zu %s", n, what);
}

void
info_layers_look(struct info_report *r, const int rgba[4])
{
	const struct bake_layer_check *c = &r->layers;

	if (r->pair || r->found.layout != BAKE_LAYOUT_LAYER_DEPTH)
		return;
	r->has_layers = true;
	bake_layer_check(&r->map.img, rgba, r->said.layer.nlayers,
	    bake_data_format_max(r->map.info.data_format), &r->layers);
	info_contradict(r, c->odd, "texels have an odd number of layers");
	info_contradict(r, c->unordered,
	    "texels have layers that do not lie behind each other");
	info_contradict(
	    r, c->outside, "values are neither a depth nor 'no layer'");
}

static void
placed(const struct bake_layer_meta *said)
{
	double near, far;

	if (said->has_range) {
		bake_layer_meta_range(said, &near, &far);
		printf("  depth range %.9g (near) to %.9g (far), mesh units",
		    near, far);
		printf(
		    said->axis[0] != '\0' ? " along %s\n" : "\n", said->axis);
	}
	if (said->has_region)
		printf("  region      %.9g, %.9g to %.9g, %.9g\n",
		    said->region[0], said->region[1], said->region[2],
		    said->region[3]);
	if (said->has_plane)
		printf("  plane       at depth %.9g\n", said->plane);
	if (said->mip_level > 0)
		printf("  mip level   %d", said->mip_level);
	if (said->mip_level > 0 && said->has_tau)
		printf(", solid above a share of %.4g", said->tau);
	if (said->mip_level > 0)
		putchar('\n');
}

void
info_layers_text(const struct info_report *r)
{
	const struct bake_layer_meta *said = &r->said.layer;
	const char *y = bake_normal_y_name(r->said.normal_y);
	const size_t *n = r->layers.texels;

	if (said->nlayers > 0) {
		printf("  layers      %d", said->nlayers);
		if (said->texture > 0)
			printf(", texture %d of %d", said->texture,
			    said->ntextures);
		putchar('\n');
		placed(said);
	}
	if ((said->nlayers > 0 || bake_layout_is_layered(r->found.layout)) &&
	    r->said.normal_y != BAKE_NORMAL_Y_UNSURE)
		printf("  normal y    %s  (declared)\n", y);
	if (!r->has_layers)
		return;
	printf("  texels      %zu empty", n[0]);
	for (int i = 1; i <= 4; i++)
		if (n[i] > 0)
			printf(", %zu with %d", n[i], i);
	putchar('\n');
}
