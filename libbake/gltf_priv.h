/* glTF files: what all that reads, edits and writes them shares. */
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

/* -- the container ---------------------------------------------------------
 */

/* Bytes of somebody else's. */
struct bake_gltf_span {
	const unsigned char *bytes;
	size_t n;
};

/*
 * The JSON of a file in memory, and the binary chunk of a .glb, told apart by
 * the first bytes. flags are jansson's.
 *   root  out: the caller's; NULL on failure
 *   bin   out: in the file's bytes; NULL where there is none
 *
 * BAKE_EDATA   truncated, no JSON, or not of version 2
 * BAKE_ENOMEM  no memory
 */
enum bake_status bake_gltf_parse(const char *name, struct bake_gltf_span file,
    size_t flags, json_t **root, struct bake_gltf_span *bin,
    struct bake_err *err);

/* A whole number >= 0; missing is fallback, anything else SIZE_MAX, which no
 * later check lets pass. */
size_t bake_gltf_size(const json_t *object, const char *key, size_t fallback);

/* -- URIs -------------------------------------------------------------------
 */

/* It names a file beside the glTF: no scheme. */
bool bake_gltf_is_file(const char *uri);

bool bake_gltf_is_data(const char *uri);

/* The path that a relative URI means in the folder of the file name, %xx
 * decoded (but %00). The caller's; NULL and err: no memory. */
char *bake_gltf_path(const char *name, const char *uri, struct bake_err *err);

/* The bytes of a base64 data URI of the file name: the caller's, NULL on
 * failure. BAKE_EDATA (what is no base64 data URI), BAKE_ENOMEM. */
enum bake_status bake_gltf_decode(const char *name, const char *uri,
    unsigned char **bytes, size_t *n, struct bake_err *err);

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

/* Types of an accessor's components. */
enum {
	BAKE_GLTF_INT8 = 5120,
	BAKE_GLTF_UINT8 = 5121,
	BAKE_GLTF_INT16 = 5122,
	BAKE_GLTF_UINT16 = 5123,
	BAKE_GLTF_UINT = 5125,
	BAKE_GLTF_FLOAT = 5126
};

/* What a buffer view is for. */
enum { BAKE_GLTF_ARRAY = 34962, BAKE_GLTF_ELEMENTS = 34963 };

/* A GLB of root and one buffer, which root's only buffer is. */
enum bake_status bake_gltf_put_glb(FILE *fp, const json_t *root,
    const struct bake_gltf_bytes *buffer, struct bake_err *err);

/* A copy of the JSON all of whose buffers are one, and that buffer. */
enum bake_status bake_gltf_merge(const struct bake_gltf *gltf, json_t **root,
    struct bake_gltf_bytes *buffer, struct bake_err *err);

#endif
