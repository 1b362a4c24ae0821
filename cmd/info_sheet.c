/* rm-info --sheet: the maps of some files as one picture. */
/* SPDX-License-Identifier: MIT */
#include "info.h"

#include <stdlib.h>

#include "mem.h"
#include "sheet.h"

/* The conventions that are declared win over those that are found: a sheet
 * shows what a renderer would. */
static bool
draw_row(struct cmd *cmd, const struct info_report *r, struct bake_image *row)
{
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_normal_y y = r->said.normal_y;

	if (y == BAKE_NORMAL_Y_UNSURE)
		y = r->found.detection.normal_y;
	if (bake_sheet_row(&r->maps, y == BAKE_NORMAL_Y_DOWN, row, &err) ==
	    BAKE_OK)
		return true;
	cmd_error(cmd, "%s: %s", r->file, err.msg);
	return false;
}

static bool
add_row(struct cmd *cmd, const struct info_opts *o, const char *path,
    struct bake_image *row)
{
	struct info_report r = INFO_REPORT_INIT;
	bool ok;

	r.file = path;
	ok = cmd_read(cmd, path, &r.map) && info_look(cmd, o, &r) &&
	     draw_row(cmd, &r, row);
	info_report_free(&r);
	return ok;
}

static bool
write_sheet(struct cmd *cmd, const char *path, const struct bake_image *row)
{
	struct bake_image sheet = BAKE_IMAGE_INIT;
	struct bake_relief_meta meta = BAKE_RELIEF_META_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok =
	    bake_sheet_stack(row, cmd->operands.n, &sheet, &err) == BAKE_OK;

	if (ok)
		ok = cmd_write(cmd, &sheet, path, BAKE_DATA_UINT8, &meta, NULL);
	else
		cmd_error(cmd, "%s: %s", path, err.msg);
	bake_image_free(&sheet);
	return ok;
}

bool
info_sheet(struct cmd *cmd, const struct info_opts *o)
{
	const struct cmd_list *in = &cmd->operands;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_image *row = bake_zalloc((size_t)in->n, sizeof *row, &err);
	bool ok = row != NULL;

	if (!ok)
		cmd_error(cmd, "%s: %s", o->sheet, err.msg);
	for (int i = 0; ok && i < in->n; i++)
		ok = add_row(cmd, o, in->item[i], &row[i]);
	ok = ok && write_sheet(cmd, o->sheet, row);
	for (int i = 0; row != NULL && i < in->n; i++)
		bake_image_free(&row[i]);
	free(row);
	return ok;
}
