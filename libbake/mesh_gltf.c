/* glTF 2.0: a mesh file and its buffers. */
/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <stdlib.h>

#include "mem.h"
#include "mesh_gltf_priv.h"

/* -- JSON ---------------------------------------------------------------- */

json_t *
bake_mesh_gltf_item(
    const struct gltf *g, const char *array, size_t index, struct bake_err *err)
{
	json_t *list = json_object_get(g->root, array);
	json_t *item = json_array_get(list, index);

	if (!json_is_object(item)) {
		bake_fail(err, BAKE_EDATA,
		    "'%s': %s %zu is used, the file has %zu", g->b->src->name,
		    array, index, json_array_size(list));
		return NULL;
	}
	return item;
}

double
bake_mesh_gltf_number(const json_t *object, const char *key, double fallback)
{
	const json_t *x = json_object_get(object, key);

	return json_is_number(x) ? json_number_value(x) : fallback;
}

void
bake_mesh_gltf_numbers(
    const json_t *object, const char *key, double *x, size_t n)
{
	const json_t *list = json_object_get(object, key);

	for (size_t i = 0; i < n && i < json_array_size(list); i++)
		if (json_is_number(json_array_get(list, i)))
			x[i] = json_number_value(json_array_get(list, i));
}

/* -- buffers ------------------------------------------------------------- */

static enum bake_status
load_uri(struct gltf *g, struct gltf_buffer *buffer, const char *uri,
    struct bake_err *err)
{
	const struct mesh_source *src = g->b->src;
	struct bake_err why = BAKE_ERR_INIT;
	char *path;
	enum bake_status rc;

	if (bake_gltf_is_data(uri)) {
		rc = bake_gltf_decode(
		    src->name, uri, &buffer->owned, &buffer->n, err);
		buffer->bytes = buffer->owned;
		return rc;
	}
	if (!src->params->side_files)
		return bake_fail(err, BAKE_EDATA, "'%s' needs the file '%s'",
		    src->name, uri);
	if ((path = bake_gltf_path(src->name, uri, err)) == NULL)
		return BAKE_ENOMEM;
	rc = bake_mesh_load_file(
	    path, src->params->max_bytes, &buffer->owned, &buffer->n, &why);
	buffer->bytes = buffer->owned;
	if (rc != BAKE_OK)
		bake_fail(err, rc, "'%s': %s", src->name, why.msg);
	else
		rc = bake_mesh_add_file(g->b, path, err);
	free(path);
	return rc;
}

static enum bake_status
load_buffer(struct gltf *g, size_t index, struct bake_err *err)
{
	json_t *object = bake_mesh_gltf_item(g, "buffers", index, err);
	struct gltf_buffer *buffer;
	const char *uri;
	size_t length;
	enum bake_status rc;

	if (object == NULL)
		return BAKE_EDATA;
	buffer = &g->buffers[index];
	if (buffer->loaded)
		return BAKE_OK;
	uri = json_string_value(json_object_get(object, "uri"));
	length = bake_gltf_size(object, "byteLength", SIZE_MAX);
	if (uri != NULL) {
		if ((rc = load_uri(g, buffer, uri, err)) != BAKE_OK)
			return rc;
	} else if (index == 0 && g->bin.bytes != NULL) {
		buffer->bytes = g->bin.bytes;
		buffer->n = g->bin.n;
	}
	if (length > buffer->n)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' is truncated: buffer %zu has %zu bytes, expected "
		    "%zu",
		    g->b->src->name, index, buffer->n, length);
	buffer->n = length;
	buffer->loaded = true;
	return BAKE_OK;
}

enum bake_status
bake_mesh_gltf_view(struct gltf *g, size_t index, const unsigned char **bytes,
    size_t *n, size_t *stride, struct bake_err *err)
{
	json_t *view = bake_mesh_gltf_item(g, "bufferViews", index, err);
	size_t buffer, offset;
	enum bake_status rc;

	if (view == NULL)
		return BAKE_EDATA;
	if (json_object_get(json_object_get(view, "extensions"),
		"EXT_meshopt_compression") != NULL)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' is compressed by meshopt, which cannot be read: "
		    "export it without",
		    g->b->src->name);
	buffer = bake_gltf_size(view, "buffer", SIZE_MAX);
	if ((rc = load_buffer(g, buffer, err)) != BAKE_OK)
		return rc;
	offset = bake_gltf_size(view, "byteOffset", 0);
	*n = bake_gltf_size(view, "byteLength", SIZE_MAX);
	*stride = bake_gltf_size(view, "byteStride", 0);
	if (offset > g->buffers[buffer].n ||
	    *n > g->buffers[buffer].n - offset || *stride > 252)
		return bake_fail(err, BAKE_EDATA,
		    "'%s': bufferView %zu is beyond the %zu bytes of its "
		    "buffer",
		    g->b->src->name, index, g->buffers[buffer].n);
	*bytes = g->buffers[buffer].bytes + offset;
	return BAKE_OK;
}

static enum bake_status
parse(struct gltf *g, struct bake_err *err)
{
	const struct mesh_source *src = g->b->src;
	const struct bake_gltf_span file = { src->bytes, src->nbytes };
	enum bake_status rc =
	    bake_gltf_parse(src->name, file, 0, &g->root, &g->bin, err);

	if (rc != BAKE_OK)
		return rc;
	g->nbuffers = json_array_size(json_object_get(g->root, "buffers"));
	g->buffers = bake_zalloc(g->nbuffers, sizeof *g->buffers, err);
	return g->buffers != NULL ? BAKE_OK : BAKE_ENOMEM;
}

enum bake_status
bake_mesh_read_gltf(struct mesh_builder *b, struct bake_err *err)
{
	struct gltf g = { .b = b };
	enum bake_status rc;

	b->mesh->y_up = b->mesh->colors_linear = true;
	if ((rc = parse(&g, err)) == BAKE_OK &&
	    (rc = bake_mesh_gltf_materials(&g, err)) == BAKE_OK)
		rc = bake_mesh_gltf_scene(&g, err);
	for (size_t i = 0; g.buffers != NULL && i < g.nbuffers; i++)
		free(g.buffers[i].owned);
	free(g.buffers);
	json_decref(g.root);
	return rc;
}
