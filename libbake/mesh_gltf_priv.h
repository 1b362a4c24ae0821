/* What the glTF reader's parts share: the document and its buffers. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MESH_GLTF_PRIV_H
#define BAKE_MESH_GLTF_PRIV_H

#include "gltf_priv.h"
#include "mesh_priv.h"

struct gltf_buffer {
	const unsigned char *bytes;
	unsigned char *owned;
	size_t n;
	bool loaded;
};

struct gltf {
	struct mesh_builder *b;
	json_t *root;
	struct bake_gltf_span bin; /* the chunk of a .glb, or NULL */
	struct gltf_buffer *buffers;
	size_t nbuffers;
};

/* An accessor's values as doubles, [count][ncomponents]; free values. */
struct gltf_values {
	double *values;
	size_t count;
	int ncomponents;
};

/* root[array][index], an object; NULL and err where it is not there. */
json_t *bake_mesh_gltf_item(const struct gltf *g, const char *array,
    size_t index, struct bake_err *err);
/* Up to n numbers of an array; what is missing stays. */
void bake_mesh_gltf_numbers(
    const json_t *object, const char *key, double *x, size_t n);
double bake_mesh_gltf_number(
    const json_t *object, const char *key, double fallback);

/* A buffer view's bytes; they live as long as g. */
enum bake_status bake_mesh_gltf_view(struct gltf *g, size_t index,
    const unsigned char **bytes, size_t *n, size_t *stride,
    struct bake_err *err);
enum bake_status bake_mesh_gltf_accessor(struct gltf *g, size_t index,
    struct gltf_values *out, struct bake_err *err);
enum bake_status bake_mesh_gltf_materials(struct gltf *g, struct bake_err *err);
enum bake_status bake_mesh_gltf_scene(struct gltf *g, struct bake_err *err);

#endif
