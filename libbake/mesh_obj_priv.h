/* What the OBJ reader and its material reader share. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MESH_OBJ_PRIV_H
#define BAKE_MESH_OBJ_PRIV_H

#include "mesh_priv.h"

/* Material numbers by name: open addressing, at most half full. */
struct obj_names {
	int *slots;
	size_t size, used;
};

/* A statement: its first word. */
struct obj_word {
	const char *p;
	size_t n;
};

/* The number of the material of that name; a new one where there is none. */
enum bake_status bake_obj_material(struct mesh_builder *b,
    struct obj_names *names, struct obj_word name, int *index,
    struct bake_err *err);

/* Space and continued lines. */
void bake_obj_skip_space(struct mesh_text *t);
/* End of the statement: of the line, or a comment. */
bool bake_obj_at_end(const struct mesh_text *t);
/* To the beginning of the next line that is no continuation. */
void bake_obj_next_line(struct mesh_text *t);
/* The next word; empty at the end of the statement. */
struct obj_word bake_obj_next_word(struct mesh_text *t);
/* The rest of the line without space around it. */
struct obj_word bake_obj_rest(struct mesh_text *t);
bool bake_obj_is(struct obj_word word, const char *text);
/* Up to max numbers, up to the end of the statement. Returns how many, or -1
 * where something else stands there. */
int bake_obj_numbers(struct mesh_text *t, double *x, int max);

/* Materials of one file's text. */
enum bake_status bake_obj_read_materials(struct mesh_builder *b,
    struct obj_names *names, const char *path, const void *bytes, size_t nbytes,
    struct bake_err *err);

#endif
