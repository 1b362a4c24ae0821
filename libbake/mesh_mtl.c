/* The materials of OBJ files: colour, and the picture that goes with it. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_obj_priv.h"

/* Options of a map and the most arguments each takes. */
static const struct {
	const char *name;
	int nwords, nnumbers; /* words, then up to that many numbers */
} map_options[] = {
	{ "-blendu", 1, 0 },
	{ "-blendv", 1, 0 },
	{ "-boost", 0, 1 },
	{ "-bm", 0, 1 },
	{ "-cc", 1, 0 },
	{ "-clamp", 1, 0 },
	{ "-imfchan", 1, 0 },
	{ "-mm", 0, 2 },
	{ "-o", 0, 3 },
	{ "-s", 0, 3 },
	{ "-t", 0, 3 },
	{ "-texres", 0, 1 },
	{ "-type", 1, 0 },
};
enum { NOPTIONS = sizeof map_options / sizeof *map_options };

/* Up to max numbers; what is no number is left for the next to read. */
static int
leading_numbers(struct mesh_text *t, double *x, int max)
{
	int n = 0;

	for (; n < max; n++) {
		struct mesh_text at = *t, word;

		bake_obj_skip_space(&at);
		word = at;
		if (bake_mesh_scan_double(&at, &x[n]) != MESH_NUMBER ||
		    !isfinite(x[n]))
			break;
		/* '2d.png' is no number */
		bake_obj_next_word(&word);
		if (word.p != at.p)
			break;
		t->p = at.p;
		t->line = at.line;
	}
	return n;
}

static void
read_option(struct mesh_text *t, int option, struct bake_texture *texture)
{
	const char *name = map_options[option].name;
	struct obj_word w = { "", 0 };
	double x[3] = { 0.0, 0.0, 0.0 };
	int n;

	for (int i = 0; i < map_options[option].nwords; i++)
		w = bake_obj_next_word(t);
	n = leading_numbers(t, x, map_options[option].nnumbers);
	if (strcmp(name, "-clamp") == 0) {
		texture->wrap_u = texture->wrap_v =
		    bake_obj_is(w, "on") ? BAKE_TEX_CLAMP : BAKE_TEX_REPEAT;
	} else if (strcmp(name, "-s") == 0 && n > 0) {
		texture->uv_matrix[0][0] = x[0];
		texture->uv_matrix[1][1] = n > 1 ? x[1] : x[0];
	} else if (strcmp(name, "-o") == 0 && n > 0) {
		texture->uv_matrix[0][2] = x[0];
		texture->uv_matrix[1][2] = n > 1 ? x[1] : 0.0;
	}
}

/* [options] file name, which may hold spaces. */
static enum bake_status
read_map(struct mesh_text *t, const char *path, struct bake_texture *texture,
    struct bake_err *err)
{
	struct obj_word name;
	int option;

	do {
		struct mesh_text at = *t;
		struct obj_word w = bake_obj_next_word(&at);

		for (option = 0; option < NOPTIONS; option++)
			if (bake_obj_is(w, map_options[option].name))
				break;
		if (option < NOPTIONS) {
			*t = at;
			read_option(t, option, texture);
		}
	} while (option < NOPTIONS);
	name = bake_obj_rest(t);
	if (name.n == 0)
		return BAKE_OK;
	free(texture->path);
	texture->path = bake_mesh_join_path(path, name.p, name.n, err);
	return texture->path != NULL ? BAKE_OK : BAKE_ENOMEM;
}

static double
unit(double x)
{
	return x > 0.0 ? x < 1.0 ? x : 1.0 : 0.0;
}

static void
set_opacity(struct bake_material *mat, double opacity)
{
	mat->color[3] = unit(opacity);
	mat->alpha_mode =
	    mat->color[3] < 1.0 ? BAKE_ALPHA_BLEND : BAKE_ALPHA_OPAQUE;
}

static enum bake_status
read_statement(struct mesh_text *t, const char *path, struct bake_material *mat,
    struct bake_err *err)
{
	struct obj_word w = bake_obj_next_word(t);
	double x[3];
	int n;

	if (bake_obj_is(w, "Kd")) {
		/* 'Kd spectral FILE' and 'Kd xyz X Y Z' are passed over */
		n = leading_numbers(t, x, 3);
		for (int k = 0; k < 3 && n > 0; k++)
			mat->color[k] = unit(x[n == 3 ? k : 0]);
	} else if (bake_obj_is(w, "d") && leading_numbers(t, x, 1) == 1) {
		set_opacity(mat, x[0]);
	} else if (bake_obj_is(w, "Tr") && leading_numbers(t, x, 1) == 1) {
		set_opacity(mat, 1.0 - x[0]);
	} else if (bake_obj_is(w, "map_Kd")) {
		return read_map(t, path, &mat->texture, err);
	}
	return BAKE_OK;
}

/* Exporters write a black Kd beside a picture that is meant to be seen. */
static void
lift_black(struct bake_mesh *m)
{
	for (size_t i = 0; i < m->nmaterials; i++) {
		double *c = m->materials[i].color;

		if (m->materials[i].texture.path != NULL && c[0] == 0.0 &&
		    c[1] == 0.0 && c[2] == 0.0)
			c[0] = c[1] = c[2] = 1.0;
	}
}

enum bake_status
bake_obj_read_materials(struct mesh_builder *b, struct obj_names *names,
    const char *path, const void *bytes, size_t nbytes, struct bake_err *err)
{
	struct mesh_text t;
	int material = -1;
	enum bake_status rc = bake_mesh_text_init(&t, bytes, nbytes, err);

	while (rc == BAKE_OK && t.p < t.end) {
		struct mesh_text at = t;

		if (bake_obj_is(bake_obj_next_word(&at), "newmtl")) {
			t = at;
			rc = bake_obj_material(
			    b, names, bake_obj_rest(&t), &material, err);
		} else if (material >= 0) {
			rc = read_statement(
			    &t, path, &b->mesh->materials[material], err);
		}
		bake_obj_next_line(&t);
	}
	bake_mesh_text_free(&t);
	if (rc == BAKE_OK)
		lift_black(b->mesh);
	return rc;
}
