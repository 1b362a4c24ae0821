/* Tables of quadrics: TSV, JSON and PLY. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_QUADRIC_WRITE_H
#define BAKE_QUADRIC_WRITE_H

#include <stdio.h>

#include "quadric.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A mesh, its frames, and quadrics[frames->nframes]; frame is how the frames
 * were made, 'uv', 'file' or 'auto'. Nothing is modified. */
struct bake_quadric_table {
	const struct bake_mesh *mesh;
	const struct bake_frames *frames;
	const struct bake_quadric *quadrics;
	const struct bake_quadric_params *params;
	const char *frame;
	/* a record (record.h) to stand in JSON and PLY, or NULL; "" is none */
	const char *record, *record_list;
};

/*
 * Write one row for each frame, in the frames' order. The columns are
 *     v vt                      indices into positions and uvs, from 0; -1
 *     x y z                     position
 *     nx ny nz tx ty tz hand    frame
 *     a b c                     1/length of the mesh
 *     uvscale_s uvscale_t       mesh units per unit of s, t
 *     a_tex b_tex c_tex         per unit of s, t squared, in depth ranges
 *     rank residual             terms fitted; root mean square, mesh units
 *
 *   tsv   one line with the names, then one a row; tabs
 *   json  one object: sign, model, order, ring (null: the default), frame,
 *         depth_scale, depth (null: none), relief:Recipe and
 *         relief:RecipeFiles where there is a record, and corners, an array of
 *         objects with the columns as keys, one a line
 *   ply   binary, little-endian: element vertex with the columns as
 *         properties (v, vt int; hand char; rank uchar; all others double),
 *         then s, t where the mesh has UVs; element face with
 *         vertex_indices, rows of the table; sign, model and so on in comments
 * Numbers in text are the shortest decimals that read back as the same double.
 *
 *   fp    written to, from where it stands; its errors are for the caller to
 *         look for (ferror)
 *
 * BAKE_EDATA  ply: more faces or vertices than its counts can tell (2^31 - 1)
 *
 * Reentrant. The locale of the process does not matter.
 */
BAKE_API enum bake_status bake_quadric_write_tsv(
    FILE *fp, const struct bake_quadric_table *table, struct bake_err *err);
BAKE_API enum bake_status bake_quadric_write_json(
    FILE *fp, const struct bake_quadric_table *table, struct bake_err *err);
BAKE_API enum bake_status bake_quadric_write_ply(
    FILE *fp, const struct bake_quadric_table *table, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
