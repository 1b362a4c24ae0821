/* glTF files: what the modules that read, edit and write them share. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_GLTF_PRIV_H
#define BAKE_GLTF_PRIV_H

#include <jansson.h>

#include "gltf.h"

/* Bytes that grow. */
struct bake_gltf_bytes {
	unsigned char *data;
	size_t n, room;
};

/* Where a buffer's bytes came from. */
enum bake_gltf_source { BAKE_GLTF_CHUNK, BAKE_GLTF_DATA_URI, BAKE_GLTF_FILE };

struct bake_gltf_buffer {
	enum bake_gltf_source source;
	struct bake_gltf_bytes bytes;
};

struct bake_gltf {
	char *folder; /* of the file, '' or ending in '/' */
	json_t *root;
	struct bake_gltf_buffer *buffers; /* as the JSON's buffers */
	size_t nbuffers;
	/* what was added: the JSON's buffer views call it buffer nbuffers */
	struct bake_gltf_bytes added;
	char **files;
	size_t nfiles;
};

/* Append n bytes (zeros where data is NULL), or pad to a multiple of 4 with
 * fill. False: no memory. */
bool bake_gltf_append(
    struct bake_gltf_bytes *bytes, const void *data, size_t n);
bool bake_gltf_pad(struct bake_gltf_bytes *bytes, unsigned char fill);

/* Note a file that was read. False: no memory. */
bool bake_gltf_add_file(struct bake_gltf *gltf, const char *path);

/* A whole file. BAKE_EIO where it cannot be read; *missing (may be NULL) tells
 * that it is not there. */
enum bake_status bake_gltf_load(const char *path, size_t max_bytes,
    struct bake_gltf_bytes *bytes, bool *missing, struct bake_err *err);

/* -- URIs -------------------------------------------------------------------
 */

/* It names a file beside the glTF: no scheme. */
bool bake_gltf_is_file(const char *uri);

/* The path that it means in folder, %xx decoded; NULL: no memory. */
char *bake_gltf_path(const char *folder, const char *uri);

/* The bytes of a data URI. */
enum bake_status bake_gltf_decode(
    const char *uri, struct bake_gltf_bytes *bytes, struct bake_err *err);

/* A data URI of these bytes; NULL: no memory. */
char *bake_gltf_encode(const unsigned char *data, size_t n);

/* What leads from the folder of the file out to folder, as the head of a URI:
 * '' where they are the same. To be freed. */
enum bake_status bake_gltf_relative(
    const char *folder, const char *out, char **head, struct bake_err *err);

/* -- JSON ---------------------------------------------------------------------
 */

/* member of object as an array, made where it is missing; NULL: no memory */
json_t *bake_gltf_array(json_t *object, const char *member);

/* Append a buffer view of the bytes that are added next, and return its
 * index; -1: no memory. */
json_int_t bake_gltf_add_view(
    struct bake_gltf *gltf, const void *data, size_t n, int target);

/* Append an accessor of it; its members go into *accessor, borrowed. Returns
 * its index; -1: no memory. */
json_int_t bake_gltf_add_accessor(struct bake_gltf *gltf, json_int_t view,
    int component_type, size_t count, const char *type, json_t **accessor);

enum {
	BAKE_GLTF_FLOAT = 5126,
	BAKE_GLTF_UINT = 5125,
	BAKE_GLTF_ARRAY = 34962,
	BAKE_GLTF_ELEMENTS = 34963
};

/* A GLB of root and one buffer, which root's only buffer is. */
enum bake_status bake_gltf_put_glb(FILE *fp, const json_t *root,
    const struct bake_gltf_bytes *buffer, struct bake_err *err);

/* A copy of the JSON all of whose buffers are one, and that buffer. */
enum bake_status bake_gltf_merge(const struct bake_gltf *gltf, json_t **root,
    struct bake_gltf_bytes *buffer, struct bake_err *err);

#endif
