/* Writing what a renderer reads: the files of a target, from whole maps. */
/* SPDX-License-Identifier: MIT */
#include "cmd_target.h"

#include <stdlib.h>
#include <string.h>

#include "cmd_recipe.h"

bool
cmd_set_target(
    struct cmd *cmd, const char *name, const struct bake_target **target)
{
	*target = bake_target_find(name);
	return *target != NULL ||
	       cmd_usage_error(cmd,
		   "--target is '%s', which is none of --list-targets", name);
}

int
cmd_print_targets(void)
{
	int n;
	const struct bake_target *t = bake_targets(&n);

	for (int i = 0; i < n; i++)
		printf("%-11s %s\n", t[i].name, t[i].about);
	return CMD_EXIT_OK;
}

bool
cmd_target_fits(const struct cmd *cmd, const struct bake_target *target)
{
	if (cmd->output != NULL && strcmp(cmd->output, "-") == 0 &&
	    target->nfiles > 1)
		return cmd_usage_error(cmd,
		    "target %s writes %d files, which standard output cannot "
		    "hold",
		    target->name, target->nfiles);
	return true;
}

void
cmd_target_plan(
    struct cmd *cmd, const struct bake_target *target, const char *out)
{
	for (int f = 0; out != NULL && f < target->nfiles; f++) {
		const char *suffix = target->file[f].suffix;
		char *path = cmd_path_derive(out, NULL, suffix, NULL);

		cmd_recipe_output(cmd, path, suffix);
		free(path);
	}
}

void
cmd_target_copy(struct bake_image *band, const struct bake_image *img, int y)
{
	struct bake_image rows = *img;

	rows.data = bake_image_row(img, y);
	for (int c = 0; c < band->nchans; c++)
		bake_image_copy_channel(band, c, &rows, c);
}

/* One file of a target while it is written. */
struct file {
	const struct bake_target_file *to;
	const struct cmd_target_maps *maps;
	bool flip_y, flip_relief;
	struct bake_image normal, ao, relief; /* bands */
};

static bool
uses(const struct bake_target_file *to, enum bake_source from,
    enum bake_source last)
{
	for (int c = 0; c < to->nchans; c++)
		if (to->source[c] >= from && to->source[c] <= last)
			return true;
	return false;
}

/* The band's maps, as high as the first and highest band. */
static enum bake_status
alloc_band(struct file *f, int n, struct bake_err *err)
{
	const int w = f->maps->width;
	enum bake_status rc = BAKE_OK;

	if (uses(f->to, BAKE_SOURCE_NORMAL_X, BAKE_SOURCE_NORMAL_Z))
		rc = bake_image_alloc(&f->normal, w, n, 3, err);
	if (rc == BAKE_OK && uses(f->to, BAKE_SOURCE_AO, BAKE_SOURCE_AO))
		rc = bake_image_alloc(&f->ao, w, n, 1, err);
	if (rc == BAKE_OK &&
	    uses(f->to, BAKE_SOURCE_RELIEF, BAKE_SOURCE_RELIEF))
		rc = bake_image_alloc(&f->relief, w, n, 1, err);
	return rc;
}

static void
fill(struct bake_image *img, int chan, float value)
{
	for (int y = 0; y < img->height; y++) {
		float *v = bake_image_row(img, y) + chan;

		for (int x = 0; x < img->width; x++, v += img->nchans)
			*v = value;
	}
}

static void
put_channel(const struct file *f, struct bake_image *out, int c)
{
	const enum bake_source source = f->to->source[c];

	switch (source) {
	case BAKE_SOURCE_NORMAL_X:
	case BAKE_SOURCE_NORMAL_Y:
	case BAKE_SOURCE_NORMAL_Z:
		bake_image_copy_channel(
		    out, c, &f->normal, (int)(source - BAKE_SOURCE_NORMAL_X));
		break;
	case BAKE_SOURCE_AO:
		bake_image_copy_channel(out, c, &f->ao, 0);
		break;
	case BAKE_SOURCE_RELIEF:
		bake_image_copy_channel(out, c, &f->relief, 0);
		break;
	default:
		fill(out, c,
		    source == BAKE_SOURCE_ONE    ? 1.0f
		    : source == BAKE_SOURCE_HALF ? 0.5f
						 : 0.0f);
	}
}

static enum bake_status
get_rows(void *arg, int y, int n, float *rows, struct bake_err *err)
{
	struct file *f = arg;
	struct bake_image *const maps[] = { &f->normal, &f->ao, &f->relief };
	struct bake_image *there[3];
	struct bake_image out = { f->maps->width, n, f->to->nchans, 0, rows };
	struct cmd_target_band band;
	enum bake_status rc = BAKE_OK;

	out.row_stride = (size_t)out.width * (size_t)out.nchans;
	if (y == 0)
		rc = alloc_band(f, n, err);
	for (int i = 0; i < 3; i++) {
		there[i] = maps[i]->data != NULL ? maps[i] : NULL;
		maps[i]->height = n;
	}
	band = (struct cmd_target_band){ there[0], there[1], there[2] };
	if (rc == BAKE_OK)
		rc = f->maps->get(f->maps->arg, y, &band, err);
	if (rc != BAKE_OK)
		return rc;
	if (f->flip_y && band.normal != NULL)
		bake_relief_flip(band.normal, 1);
	if (f->flip_relief && band.relief != NULL)
		bake_relief_flip(band.relief, 0);
	for (int c = 0; c < out.nchans; c++)
		put_channel(f, &out, c);
	return BAKE_OK;
}

static bool
write_file(struct cmd *cmd, const struct bake_target *target, int i,
    const struct cmd_target_maps *m, const char *out)
{
	static const char *const exr_names[] = { "normal.x", "normal.y", "ao",
		"depth" };
	struct file f = { .to = &target->file[i], .maps = m };
	const struct bake_row_source rows = { m->width, m->height, f.to->nchans,
		get_rows, &f };
	const bool names = m->exr_names && f.to->layout == BAKE_LAYOUT_RELIEF;
	struct bake_relief_meta meta = m->meta;
	char *path = cmd_path_derive(out, NULL, f.to->suffix, NULL);
	bool ok;

	meta.layout = f.to->layout;
	meta.normal_code = BAKE_NORMAL_CODE_UNSIGNED;
	meta.normal_y = cmd->output_normal_y != BAKE_NORMAL_Y_UNSURE
			    ? cmd->output_normal_y
			    : target->normal_y;
	meta.polarity = target->polarity;
	f.flip_y = meta.normal_y != m->meta.normal_y;
	f.flip_relief = meta.polarity != m->meta.polarity;
	ok = cmd_write_rows(
	    cmd, &rows, path, m->deepest, &meta, names ? exr_names : NULL);
	bake_image_free(&f.normal);
	bake_image_free(&f.ao);
	bake_image_free(&f.relief);
	free(path);
	return ok;
}

bool
cmd_write_target(struct cmd *cmd, const struct bake_target *target,
    const struct cmd_target_maps *maps, const char *out)
{
	bool ok = true;

	for (int i = 0; ok && i < target->nfiles; i++)
		ok = write_file(cmd, target, i, maps, out);
	return ok;
}
