/* glTF files: vertex attributes added to a file that stays as it was. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_GLTF_H
#define BAKE_GLTF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "err.h"
#include "mesh.h"
#include "mesh_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A glTF 2.0 file in memory: its JSON and its buffers. */
struct bake_gltf;

/*
 * Read path, .gltf or .glb (told apart by the first bytes), with all its
 * buffers: the binary chunk, data URIs and files beside it.
 *
 *   max_bytes  the largest file, each, in bytes
 *   gltf       out: NULL on failure; the caller frees it
 *   err        reason on failure; never NULL
 *
 * BAKE_EIO     a file cannot be opened or read; the message names it
 * BAKE_EDATA   no glTF 2.0, truncated, no JSON, a buffer shorter than it
 *              claims, meshopt or Draco compression
 * BAKE_ELIMIT  a file is larger than max_bytes
 * BAKE_ENOMEM  no memory
 *
 * Reentrant. Source: Khronos, 'glTF 2.0 Specification', 3.6 and 4.
 */
BAKE_API enum bake_status bake_gltf_read(const char *path, size_t max_bytes,
    struct bake_gltf **gltf, struct bake_err *err);

/* Harmless on NULL. */
BAKE_API void bake_gltf_free(struct bake_gltf *gltf);

/* How many meshes it has. Reentrant. */
BAKE_API size_t bake_gltf_nmeshes(const struct bake_gltf *gltf);

/* The paths of the files that were read, the glTF's own first; *n is how many.
 * They live as long as gltf. */
BAKE_API const char *const *bake_gltf_files(
    const struct bake_gltf *gltf, size_t *n);

/*
 * The file's meshes in their own coordinates: a GLB in memory whose scene has
 * one node for each mesh, in the file's order and without a transform, for
 * bake_mesh_read_memory.
 *
 *   bytes   out: *nbytes bytes, the caller frees them with free()
 *
 * BAKE_EDATA   the file has no meshes
 * BAKE_ENOMEM  no memory; on any failure *bytes is NULL
 *
 * Reentrant; gltf is not modified.
 */
BAKE_API enum bake_status bake_gltf_local(const struct bake_gltf *gltf,
    unsigned char **bytes, size_t *nbytes, struct bake_err *err);

/* Whether two primitives of a mesh have the same vertices: the same accessors
 * for the same attributes. */
BAKE_API bool bake_gltf_same_vertices(
    const struct bake_gltf *gltf, int mesh, int primitive, int other);

/* An attribute of vertices that is added.
 *   name     its key, '_QUADRIC'
 *   sign     NULL, or the text of 'sign' in the accessor's extras
 *   values   [n][2] floats, finite
 */
struct bake_gltf_attribute {
	const char *name, *sign;
	const float (*values)[2];
	size_t n;
};

/*
 * Add an attribute (VEC2, float) to a primitive and to all of its mesh that
 * have the same vertices; one of that name is replaced.
 *
 * BAKE_EINVAL  there is no such primitive, or n is not the number of its
 *              positions
 * BAKE_ENOMEM  no memory
 */
BAKE_API enum bake_status bake_gltf_add(struct bake_gltf *gltf, int mesh,
    int primitive, const struct bake_gltf_attribute *attribute,
    struct bake_err *err);

/*
 * A glTF file made of a mesh: one node, mesh and primitive with a vertex for
 * each frame, in the frames' order, and POSITION, NORMAL, TANGENT and, where
 * the mesh has UVs, TEXCOORD_0 (glTF's v grows downwards: 1 - v); triangles in
 * the mesh's order. Values beyond float's range become its largest.
 *
 * BAKE_EDATA   no triangles, or 2^32 - 1 vertices or more
 * BAKE_ENOMEM  no memory; on any failure *gltf is NULL
 */
BAKE_API enum bake_status bake_gltf_make(const struct bake_mesh *mesh,
    const struct bake_frames *frames, struct bake_gltf **gltf,
    struct bake_err *err);

/*
 * Put a record (record.h) into the asset's extras, as 'relief:Recipe' and
 * 'relief:RecipeFiles', in the place of those that were there; an empty or NULL
 * text is none. Extras that are no object stay what they are.
 *
 * BAKE_ENOMEM  no memory
 */
BAKE_API enum bake_status bake_gltf_set_record(struct bake_gltf *gltf,
    const char *text, const char *list, struct bake_err *err);

/* Whether what will be written depends on more than the bytes of
 * bake_gltf_files: on pictures, or (glb false) buffers, that are beside the
 * file and called by names which depend on the folder of the output. */
BAKE_API bool bake_gltf_has_outside(const struct bake_gltf *gltf, bool glb);

/*
 * Write it.
 *   glb   one file: the buffers become the binary chunk, images beside the file
 *         come along. Without it: JSON; buffers beside the file stay where they
 *         are, what was added and a former binary chunk are data URIs
 *   path  where the output will be, '-' for standard output: names of files in
 *         it are relative to the output's folder
 * All that is not said here is written as it was read: members in their order,
 * numbers as the shortest decimals that give the same double.
 *
 * BAKE_EDATA   glb: more than 4 GiB - 1
 * BAKE_EIO     an image is there, but cannot be read (one that is not there
 *              keeps its name); a folder cannot be found
 * BAKE_ENOMEM  no memory
 *
 * fp's own errors are for the caller to look for. Reentrant; gltf's files then
 * include the images that were read.
 */
BAKE_API enum bake_status bake_gltf_write(struct bake_gltf *gltf, FILE *fp,
    bool glb, const char *path, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
