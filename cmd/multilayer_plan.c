/* rm-multilayer: which files a run writes, for the record in each. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "cmd_recipe.h"
#include "multilayer_tool.h"

/* What only the bake tells, or a file's record: how many textures of depth and
 * of colour a set has, and levels after the first. */
struct counts {
	int ntextures, ncolors, nlevels;
};

char *
multilayer_preview_path(const struct multilayer_opts *o, char letter)
{
	const char suffix[3] = { '_', letter, '\0' };

	return cmd_path_derive(
	    o->preview, NULL, o->nviews > 1 ? suffix : "", NULL);
}

/* PREFIX_mip2_nx.png, PREFIX_nx2.png … */
static void
plan_file(struct cmd *cmd, const char *prefix, const char *view, int level,
    const char *kind, int i)
{
	char mip[16] = "", number[16] = "", label[64], *path;

	if (level > 0)
		snprintf(mip, sizeof mip, "_mip%d", level);
	if (i > 0)
		snprintf(number, sizeof number, "%d", i + 1);
	snprintf(label, sizeof label, "%s%s_%s%s", view, mip, kind, number);
	if (asprintf(&path, "%s%s_%s%s.%s", prefix, mip, kind, number,
		bake_file_type_name(cmd->type)) < 0)
		cmd_need(NULL);
	cmd_recipe_output(cmd, path, label);
	free(path);
}

static void
plan_files(struct cmd *cmd, const char *prefix, const char *view,
    const struct counts *n)
{
	static const char *const kinds[] = { "depth", "nx", "ny", "color" };

	for (int level = 0; level <= n->nlevels; level++)
		for (int k = 0; k < 4; k++)
			for (int i = 0; i < (k < 3 ? n->ntextures : n->ncolors);
			     i++)
				plan_file(
				    cmd, prefix, view, level, kinds[k], i);
}

void
multilayer_plan_set(struct cmd *cmd, const struct multilayer_opts *o,
    const struct bake_layer_maps *maps, int nlevels, const char *prefix)
{
	const struct counts n = { maps->ntextures, maps->ncolors, nlevels };
	const size_t len = strlen(prefix);
	char set[48], view[3] = "";

	if (o->multi_part)
		return;
	/* _x, as multilayer_view_prefix made it */
	if (o->nviews > 1 && len > 2)
		memcpy(view, prefix + len - 2, 2);
	snprintf(set, sizeof set, "%d,%d,%d", n.ntextures, n.ncolors, nlevels);
	cmd_recipe_set(cmd, set);
	plan_files(cmd, prefix, view, &n);
}

/* What is known beforehand of a view's files. */
static void
plan_view(struct cmd *cmd, const struct multilayer_opts *o, const char *prefix,
    char letter)
{
	char *one = multilayer_view_prefix(prefix, letter), *path;
	const char view[3] = { letter != '\0' ? '_' : '\0', letter, '\0' };

	if (one == NULL)
		return;
	if (o->multi_part || o->deep) {
		path = multilayer_exr_path(one);
		cmd_recipe_output(cmd, path, view);
		free(path);
	} else {
		plan_file(cmd, one, view, 0, "depth", 0);
	}
	if (o->preview != NULL) {
		char label[16];

		snprintf(label, sizeof label, "%s preview", view);
		path = multilayer_preview_path(o, letter);
		cmd_recipe_output(cmd, path, label);
		free(path);
	}
	free(one);
}

struct prefix {
	const struct multilayer_opts *o;
	const char *text;
};

/* The first file of a view tells of the others. */
static void
plan_more(struct cmd *cmd, const char *label, const char *set, const void *arg)
{
	const struct prefix *p = arg;
	const char *rest = strstr(label, "_depth");
	struct counts n;
	char view[3] = "", *one;

	if (rest == NULL || strcmp(rest, "_depth") != 0 || rest - label > 2 ||
	    sscanf(set, "%d,%d,%d", &n.ntextures, &n.ncolors, &n.nlevels) != 3)
		return;
	memcpy(view, label, (size_t)(rest - label));
	one = multilayer_view_prefix(p->text, view[0] != '\0' ? view[1] : '\0');
	if (one != NULL)
		plan_files(cmd, one, view, &n);
	free(one);
}

bool
multilayer_unchanged(
    struct cmd *cmd, const struct multilayer_opts *o, const char *prefix)
{
	const struct prefix p = { o, prefix };

	if (prefix == NULL)
		return false;
	for (int i = 0; i < o->nviews; i++)
		plan_view(cmd, o, prefix, o->nviews > 1 ? "xyz"[i] : '\0');
	if (!o->no_color)
		cmd_recipe_color(cmd);
	return cmd_unchanged_set(cmd, plan_more, &p);
}
