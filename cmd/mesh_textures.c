/* The base colours of a mesh's materials, read and made scene-linear. */
/* SPDX-License-Identifier: MIT */
#include "mesh_textures.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cmd_batch.h"
#include "cmd_recipe.h"
#include "mem.h"
#include "repair.h"

static const char encoded[] = "sRGB";

/* What reading one picture needs. */
struct picture {
	struct cmd *cmd;
	const char *mesh_path;
	const struct bake_material *material;
	const struct bake_color *color;
};

void
mesh_textures_free(struct mesh_textures *t)
{
	for (int i = 0; t->image != NULL && i < t->n; i++)
		bake_image_free(&t->image[i]);
	free(t->image);
	free(t->list);
	free(t->factors);
	free(t->vertex_colors);
	*t = (struct mesh_textures)MESH_TEXTURES_INIT;
}

/* Whether two materials have the same picture. */
static bool
is_same(const struct bake_texture *a, const struct bake_texture *b)
{
	if (a->bytes != NULL || b->bytes != NULL)
		return a->bytes != NULL && b->bytes != NULL &&
		       a->nbytes == b->nbytes &&
		       memcmp(a->bytes, b->bytes, a->nbytes) == 0;
	return strcmp(a->path, b->path) == 0;
}

static enum bake_status
open_picture(const struct picture *p, struct bake_reader **reader,
    struct bake_image_info *info, struct bake_err *err)
{
	const struct bake_texture *tx = &p->material->texture;
	const char *path = tx->path;
	char name[BAKE_ERR_MSG / 2];
	enum bake_status rc;

	if (tx->bytes != NULL) {
		/* its extension at the end tells the kind of pictures that
		 * have no mark of their own */
		snprintf(name, sizeof name, "the file's own %.256s",
		    path[0] != '\0' ? path : "picture");
		return bake_reader_open_memory(reader, tx->bytes, tx->nbytes,
		    name, &p->cmd->limits, info, err);
	}
	/* - would be standard input */
	rc = bake_reader_open(reader, strcmp(path, "-") == 0 ? "./-" : path,
	    &p->cmd->limits, info, err);
	if (rc == BAKE_OK)
		cmd_list_add(&p->cmd->read, path);
	return rc;
}

static int
channels_of(const struct bake_image_info *info)
{
	if (info->nchans <= 4)
		return info->nchans;
	return strcasecmp(info->names[3], "A") == 0 ? 4 : 3;
}

/* Into scene-linear light; texels that are no numbers are filled. */
static enum bake_status
make_linear(const struct picture *p, const struct bake_image_info *info,
    struct bake_image *img, struct bake_err *err)
{
	const struct bake_wrap wrap = { false, false };
	enum bake_status rc;
	size_t n = 0;

	if (bake_data_format_max(info->data_format) != 0)
		return bake_color_to_linear(
		    p->color, encoded, img, p->cmd->nthreads, err);
	rc = bake_repair_nonfinite(img, wrap, p->cmd->nthreads, &n, err);
	if (n > 0)
		cmd_warn(p->cmd,
		    "%s: material '%s': %zu texels of its picture are not "
		    "numbers (or beyond 1e30); filled from their neighbours",
		    p->mesh_path, p->material->name, n);
	return rc;
}

static enum bake_status
read_picture(
    const struct picture *p, struct bake_image *img, struct bake_err *err)
{
	struct bake_image_info info;
	struct bake_reader *reader = NULL;
	enum bake_status rc;

	cmd_decode_begin(p->cmd, 1e9);
	rc = open_picture(p, &reader, &info, err);
	if (rc == BAKE_OK)
		rc = bake_reader_read(reader, 0, channels_of(&info), img, err);
	cmd_decode_end(p->cmd);
	if (rc == BAKE_OK)
		rc = make_linear(p, &info, img, err);
	if (rc != BAKE_OK)
		bake_image_free(img);
	bake_reader_close(reader);
	return rc;
}

/* Material i's picture: another's, or read. */
static void
take_picture(struct cmd *cmd, const struct bake_mesh *mesh,
    const char *mesh_path, const struct bake_color *color, int i,
    struct mesh_textures *t)
{
	const struct bake_material *m = &mesh->materials[i];
	const struct picture p = { cmd, mesh_path, m, color };
	struct bake_err err = BAKE_ERR_INIT;

	for (int k = 0; k < i; k++)
		if (t->image[k].data != NULL &&
		    is_same(&m->texture, &mesh->materials[k].texture)) {
			t->list[i] = &t->image[k];
			return;
		}
	if (read_picture(&p, &t->image[i], &err) == BAKE_OK) {
		t->list[i] = &t->image[i];
		return;
	}
	cmd_recipe_none(cmd); /* it may be there the next time */
	cmd_warn(cmd, "%s: material '%s' is without its picture: %s%s",
	    mesh_path, m->name, err.msg,
	    err.code == BAKE_ELIMIT ? "; --max-pixels N allows it" : "");
}

/* n colours that are encoded. */
static enum bake_status
colors_to_linear(struct cmd *cmd, const struct bake_color *color,
    float (*rgba)[4], size_t n, struct bake_err *err)
{
	/* in rows, which threads share */
	enum { ROW = 1024 };
	struct bake_image img = { ROW, (int)(n / ROW), 4, 4 * ROW, rgba[0] };
	enum bake_status rc = BAKE_OK;

	if (img.height > 0)
		rc = bake_color_to_linear(
		    color, encoded, &img, cmd->nthreads, err);
	img.data += (size_t)img.height * img.row_stride;
	img.width = (int)(n % ROW);
	img.height = 1;
	if (rc == BAKE_OK && img.width > 0)
		rc = bake_color_to_linear(
		    color, encoded, &img, cmd->nthreads, err);
	return rc;
}

static enum bake_status
take_factors(struct cmd *cmd, const struct bake_mesh *mesh,
    const struct bake_color *color, struct mesh_textures *t,
    struct bake_err *err)
{
	enum bake_status rc;

	for (int pass = 0; pass < 2; pass++) {
		for (int i = 0; i < t->n; i++) {
			const struct bake_material *m = &mesh->materials[i];

			if (pass == 1 && !m->linear)
				continue;
			for (int c = 0; c < 4; c++)
				t->factors[i][c] = (float)m->color[c];
		}
		/* all of them; then those that were linear again */
		if (pass == 0 && (rc = colors_to_linear(cmd, color, t->factors,
				      (size_t)t->n, err)) != BAKE_OK)
			return rc;
	}
	return BAKE_OK;
}

static enum bake_status
take_vertex_colors(struct cmd *cmd, const struct bake_mesh *mesh,
    const struct bake_color *color, struct mesh_textures *t,
    struct bake_err *err)
{
	const size_t n = mesh->npositions;

	t->vertex_colors = bake_alloc(n, sizeof *t->vertex_colors, err);
	if (t->vertex_colors == NULL)
		return BAKE_ENOMEM;
	memcpy(t->vertex_colors, mesh->colors, n * sizeof *t->vertex_colors);
	if (mesh->colors_linear)
		return BAKE_OK;
	return colors_to_linear(cmd, color, t->vertex_colors, n, err);
}

bool
mesh_textures_read(struct cmd *cmd, const struct bake_mesh *mesh,
    const char *mesh_path, const struct bake_color *color,
    struct mesh_textures *t)
{
	const size_t n = mesh->nmaterials;
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_status rc = BAKE_ENOMEM;

	if (strcmp(mesh_path, "-") == 0)
		mesh_path = "standard input";
	cmd_silence_libraries(cmd);
	t->image = bake_zalloc(n, sizeof *t->image, &err);
	t->list = bake_zalloc(n, sizeof *t->list, &err);
	t->factors = bake_alloc(n, sizeof *t->factors, &err);
	if (t->image != NULL && t->list != NULL && t->factors != NULL) {
		t->n = (int)n;
		rc = take_factors(cmd, mesh, color, t, &err);
	}
	if (rc == BAKE_OK && mesh->colors != NULL)
		rc = take_vertex_colors(cmd, mesh, color, t, &err);
	if (rc != BAKE_OK) {
		cmd_error(cmd, "%s: %s", mesh_path, err.msg);
		return false;
	}
	for (int i = 0; i < t->n; i++)
		if (mesh->materials[i].texture.path != NULL)
			take_picture(cmd, mesh, mesh_path, color, i, t);
	return true;
}
