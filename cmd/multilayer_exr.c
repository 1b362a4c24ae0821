/* rm-multilayer: all images in one EXR file, of parts or deep. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "cmd_recipe.h"
#include "io_exr.h"
#include "mem.h"
#include "multilayer_tool.h"
#include "output.h"

char *
multilayer_exr_path(const char *prefix)
{
	enum bake_file_type type;
	char *path = NULL;

	if (strcmp(prefix, "-") == 0 ||
	    (bake_file_type_from_path(prefix, &type) && type == BAKE_FILE_EXR))
		return strdup(prefix);
	return asprintf(&path, "%s.exr", prefix) < 0 ? NULL : path;
}

/* Finish, or drop, what was written. */
static bool
close_output(struct cmd *cmd, struct bake_output *out, const char *path,
    enum bake_status rc, struct bake_err *err)
{
	if (rc == BAKE_OK)
		rc = bake_output_commit(out, err);
	else
		bake_output_abort(out);
	if (rc != BAKE_OK) {
		cmd_error(cmd, "%s", err->msg);
		return false;
	}
	cmd_flush_warnings(cmd);
	cmd_list_add(&cmd->written, path);
	return true;
}

/* -- parts -------------------------------------------------------------------
 */

static enum bake_status
write_parts(struct cmd *cmd, const struct multilayer_album *a, FILE *stream,
    const char *path, struct bake_err *err)
{
	const size_t n = (size_t)a->n;
	struct bake_exr_part *part = bake_alloc(n, sizeof *part, err);
	struct bake_exr_channels *channels =
	    bake_alloc(n, sizeof *channels, err);
	struct bake_attrs *attrs = bake_alloc(n, sizeof *attrs, err);
	struct cmd_record record;
	enum bake_status rc = BAKE_ENOMEM;

	if (part != NULL && channels != NULL && attrs != NULL) {
		for (size_t i = 0; i < n; i++) {
			const struct multilayer_image *image = &a->image[i];

			bake_attrs_clear(&attrs[i]);
			bake_relief_meta_to_attrs(&image->meta, &attrs[i]);
			channels[i].px = image->px;
			channels[i].names = NULL;
			part[i].name = image->name;
			part[i].nchannels = 1;
			part[i].channels = &channels[i];
			part[i].attrs = &attrs[i];
		}
		/* one for the file */
		cmd_recipe_attrs(cmd, path, &attrs[0], &record);
		rc = bake_exr_write(
		    part, a->n, cmd->nthreads, stream, path, err);
		if (rc == BAKE_OK)
			rc = cmd_recipe_seal(&record, stream, err);
	}
	free(part);
	free(channels);
	free(attrs);
	return rc;
}

bool
multilayer_write_parts(
    struct cmd *cmd, const struct multilayer_album *a, const char *prefix)
{
	struct bake_output out = BAKE_OUTPUT_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	char *path = multilayer_exr_path(prefix);
	enum bake_status rc;
	bool ok;

	if (path == NULL) {
		cmd_error(cmd, "%s: no memory", prefix);
		return false;
	}
	rc = bake_output_open(&out, path, &err);
	if (rc == BAKE_OK)
		rc = write_parts(cmd, a, out.stream, path, &err);
	ok = close_output(cmd, &out, path, rc, &err);
	free(path);
	return ok;
}

/* -- deep --------------------------------------------------------------------
 */

enum { DEEP_CHANNELS = 9 };

/* A deep image on its way to a file. */
struct deep {
	const struct bake_multilayer *ml;
	const struct bake_view *view;
	bool colors;
	struct bake_deep_writer *writer;
	struct bake_multilayer_stats *stats;
};

static enum bake_status
write_rows(const struct deep *d, const struct bake_deep_rows *rows,
    struct bake_err *err)
{
	static const float one = 1;
	const float range = (float)(d->view->near - d->view->far);
	float *z = bake_alloc(rows->nsamples, sizeof *z, err);
	struct bake_deep_samples samples[DEEP_CHANNELS] = { { z, 1 },
		{ rows->depth, 1 }, { &one, 0 } };
	enum bake_status rc = BAKE_ENOMEM;

	for (int i = 0; i < 3; i++) {
		samples[3 + i].value = rows->normal[0] + i;
		samples[3 + i].stride = 3;
	}
	for (int i = 0; i < 3 && d->colors; i++) {
		samples[6 + i].value = rows->color[0] + i;
		samples[6 + i].stride = 4;
	}
	if (z != NULL) {
		for (size_t i = 0; i < rows->nsamples; i++)
			z[i] = rows->depth[i] * range;
		rc = bake_deep_writer_rows(
		    d->writer, rows->nrows, rows->count, samples, err);
	}
	free(z);
	return rc;
}

static enum bake_status
write_bands(const struct deep *d, struct bake_err *err)
{
	const struct bake_deep_rows init = BAKE_DEEP_ROWS_INIT;
	const int height = d->view->height;
	enum bake_status rc = BAKE_OK;

	for (int y = 0; y < height && rc == BAKE_OK; y += BAKE_BAND_ROWS) {
		int nrows =
		    height - y < BAKE_BAND_ROWS ? height - y : BAKE_BAND_ROWS;
		struct bake_deep_rows rows = init;

		rc =
		    bake_multilayer_deep(d->ml, y, nrows, &rows, d->stats, err);
		if (rc == BAKE_OK)
			rc = write_rows(d, &rows, err);
		bake_deep_rows_free(&rows);
	}
	return rc;
}

static enum bake_status
write_image(struct cmd *cmd, struct deep *d,
    const struct bake_relief_meta *meta, FILE *stream, const char *path,
    struct bake_err *err)
{
	static const struct bake_deep_channel channel[DEEP_CHANNELS] = {
		{ "Z", BAKE_DATA_FLOAT }, { "depth", BAKE_DATA_FLOAT },
		{ "A", BAKE_DATA_HALF }, { "N.x", BAKE_DATA_HALF },
		{ "N.y", BAKE_DATA_HALF }, { "N.z", BAKE_DATA_HALF },
		{ "R", BAKE_DATA_HALF }, { "G", BAKE_DATA_HALF },
		{ "B", BAKE_DATA_HALF }
	};
	struct bake_err ignored = BAKE_ERR_INIT;
	struct bake_attrs attrs;
	struct cmd_record record;
	enum bake_status rc;

	bake_attrs_clear(&attrs);
	bake_relief_meta_to_attrs(meta, &attrs);
	cmd_recipe_attrs(cmd, path, &attrs, &record);
	rc = bake_deep_writer_open(&d->writer, stream, path, d->view->width,
	    d->view->height, channel,
	    d->colors ? DEEP_CHANNELS : DEEP_CHANNELS - 3, &attrs,
	    cmd->nthreads, err);
	if (rc != BAKE_OK)
		return rc;
	rc = write_bands(d, err);
	if (rc != BAKE_OK) {
		bake_deep_writer_close(d->writer, &ignored);
		return rc;
	}
	rc = bake_deep_writer_close(d->writer, err);
	return rc == BAKE_OK ? cmd_recipe_seal(&record, stream, err) : rc;
}

bool
multilayer_write_deep(struct cmd *cmd, const struct multilayer_opts *o,
    const char *mesh_path, const struct bake_multilayer *ml,
    const struct bake_multilayer_params *p, const struct bake_relief_meta *meta,
    const char *prefix, struct bake_multilayer_stats *stats)
{
	struct deep d = { ml, &p->view, p->ncolors > 0, NULL, stats };
	struct bake_output out = BAKE_OUTPUT_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	char *path = multilayer_exr_path(prefix);
	enum bake_status rc;
	bool ok;

	if (path == NULL) {
		cmd_error(cmd, "%s: no memory", prefix);
		return false;
	}
	rc = bake_output_open(&out, path, &err);
	if (rc == BAKE_OK)
		rc = write_image(cmd, &d, meta, out.stream, path, &err);
	if (rc == BAKE_OK &&
	    !multilayer_judge(cmd, o, mesh_path, &p->view, stats)) {
		bake_output_abort(&out);
		ok = false;
	} else
		ok = close_output(cmd, &out, path, rc, &err);
	free(path);
	return ok;
}
