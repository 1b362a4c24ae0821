/* What the mesh readers share: a mesh in the making, and scanning of text. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MESH_PRIV_H
#define BAKE_MESH_PRIV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "mesh.h"

/* A file in memory. */
struct mesh_source {
	const char *name; /* for messages, and the folder of side files */
	const unsigned char *bytes;
	size_t nbytes;
	const struct bake_mesh_params *params;
};

/*
 * A mesh that grows. Readers add elements in any order; faces are corners that
 * are added one by one and closed by bake_mesh_end_face. bake_mesh_finish
 * checks all of it and makes the triangles.
 */
struct mesh_builder {
	struct bake_mesh *mesh;
	const struct mesh_source *src;
	struct bake_corner *corner; /* of all faces, one after another */
	size_t ncorners, face_start, max_face;
	int *face_end, *face_material;
	size_t nfaces, ncolors, ntangents;
	size_t cap_positions, cap_uvs, cap_normals, cap_tangents, cap_colors;
	size_t cap_corners, cap_face_end, cap_face_material, cap_materials;
	size_t cap_parts, cap_files;
};

void bake_mesh_builder_init(struct mesh_builder *b, struct bake_mesh *mesh,
    const struct mesh_source *src);
/* Frees what is not the mesh's. */
void bake_mesh_builder_free(struct mesh_builder *b);

/*
 * An array with room for one more element than used: old itself, or a larger
 * copy (old is freed). NULL on failure, old is kept. what names the elements
 * in the message when there are more than params.max_items.
 */
void *bake_mesh_grow(const struct mesh_builder *b, void *old, size_t used,
    size_t *cap, size_t size, const char *what, struct bake_err *err);
/* Room for n elements at once, where that many are known to come. */
void *bake_mesh_reserve(const struct mesh_builder *b, void *old, size_t used,
    size_t n, size_t *cap, size_t size, const char *what, struct bake_err *err);

enum bake_status bake_mesh_add_position(
    struct mesh_builder *b, const double p[3], struct bake_err *err);
enum bake_status bake_mesh_add_uv(
    struct mesh_builder *b, const double uv[2], struct bake_err *err);
enum bake_status bake_mesh_add_normal(
    struct mesh_builder *b, const double n[3], struct bake_err *err);
/* The tangent of normal index; those before it that have none become 0. */
enum bake_status bake_mesh_set_tangent(struct mesh_builder *b, size_t index,
    const double t[4], struct bake_err *err);
/* Room for colours up to index; white where there was none. */
enum bake_status bake_mesh_reach_color(
    struct mesh_builder *b, size_t index, struct bake_err *err);
/* The colour of position index; those before it that have none become white. */
enum bake_status bake_mesh_set_color(struct mesh_builder *b, size_t index,
    const float rgba[4], struct bake_err *err);
enum bake_status bake_mesh_add_corner(
    struct mesh_builder *b, struct bake_corner c, struct bake_err *err);
enum bake_status bake_mesh_end_face(
    struct mesh_builder *b, int material, struct bake_err *err);
/* A new default material of that name (copied). *index is its number. */
enum bake_status bake_mesh_add_material(struct mesh_builder *b,
    const char *name, size_t length, int *index, struct bake_err *err);
/* A part that begins with the next position and the next face. */
enum bake_status bake_mesh_begin_part(struct mesh_builder *b, int node,
    int mesh, int primitive, struct bake_err *err);
/* Note a file that was read. */
enum bake_status bake_mesh_add_file(
    struct mesh_builder *b, const char *path, struct bake_err *err);

enum bake_status bake_mesh_finish(struct mesh_builder *b, struct bake_err *err);

/* Readers: the mesh is complete but for bake_mesh_finish. */
enum bake_status bake_mesh_read_obj(
    struct mesh_builder *b, struct bake_err *err);
enum bake_status bake_mesh_read_ply(
    struct mesh_builder *b, struct bake_err *err);
enum bake_status bake_mesh_read_gltf(
    struct mesh_builder *b, struct bake_err *err);
enum bake_status bake_mesh_read_assimp(
    struct mesh_builder *b, const char *extension, struct bake_err *err);

/*
 * A whole file. *bytes is the caller's, with a NUL behind the last byte.
 * BAKE_EIO, BAKE_ELIMIT, BAKE_ENOMEM.
 */
enum bake_status bake_mesh_load_file(const char *path, size_t max_bytes,
    unsigned char **bytes, size_t *nbytes, struct bake_err *err);

/* name's folder and a path relative to it, backslashes made slashes; the
 * caller frees it. */
char *bake_mesh_join_path(const char *name, const char *relative, size_t length,
    struct bake_err *err);

/* A copy of length bytes with a NUL behind them. */
char *bake_mesh_copy_text(
    const char *text, size_t length, struct bake_err *err);

/*
 * For the n elements of dim doubles each: first[i] is the lowest index
 * with equal values (-0 = 0; NaN equals nothing). Returns how many are
 * different; 0 and err on failure. n fits in an int.
 */
size_t bake_mesh_first_equal(
    const double *values, size_t n, int dim, int *first, struct bake_err *err);

/* -- transforms ---------------------------------------------------------- */

/* x' = m x + m[.][3]; and what goes with it for directions. */
struct mesh_affine {
	double m[3][4];
	double cofactor[3][3]; /* det * inverse transpose, sign(det) put in */
	bool mirrored;         /* det < 0 */
};

/* a * b, b first, of 3 rows and 4 columns. */
void bake_mesh_affine_multiply(
    double out[3][4], const double a[3][4], const double b[3][4]);
/* cofactor and mirrored, from m. */
void bake_mesh_affine_prepare(struct mesh_affine *a);
void bake_mesh_affine_point(
    const struct mesh_affine *a, const double p[3], double out[3]);
/* Not of unit length; bake_mesh_finish normalizes. */
void bake_mesh_affine_normal(
    const struct mesh_affine *a, const double n[3], double out[3]);
void bake_mesh_affine_tangent(
    const struct mesh_affine *a, const double t[4], double out[4]);
/* Three corners of a triangle; turned round where a mirrors. */
enum bake_status bake_mesh_add_triangle(struct mesh_builder *b,
    const struct mesh_affine *a, struct bake_corner c0, struct bake_corner c1,
    struct bake_corner c2, int material, struct bake_err *err);

/* -- text ---------------------------------------------------------------- */

struct mesh_text {
	const char *p, *end;
	size_t line;    /* of p, from 1 */
	void *c_locale; /* a locale_t, which C11 alone does not know */
};

/* BAKE_ENOMEM; bake_mesh_text_free is harmless after a failure. */
enum bake_status bake_mesh_text_init(struct mesh_text *t, const void *bytes,
    size_t nbytes, struct bake_err *err);
void bake_mesh_text_free(struct mesh_text *t);

enum mesh_number { MESH_NUMBER, MESH_NOT_A_NUMBER };
/*
 * A decimal at t->p, no space before it: [+-]digits[.digits][e[+-]digits], or
 * nan, inf, infinity in any case; rounded correctly, whatever the locale.
 * t->p is behind it, on success only. What follows is the caller's to check.
 */
enum mesh_number bake_mesh_scan_double(struct mesh_text *t, double *value);
/* [+-]digits that fit in an int64_t. */
enum mesh_number bake_mesh_scan_int(struct mesh_text *t, int64_t *value);

#endif
