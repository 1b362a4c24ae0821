/* glTF files: reading the JSON and the buffers. */
/* SPDX-License-Identifier: MIT */
#include "gltf.h"

#include <stdlib.h>
#include <string.h>

#include "gltf_priv.h"
#include "mem.h"
#include "mesh_priv.h"

/* Compressed vertices cannot be told from here. */
static enum bake_status
refuse_compression(
    const struct bake_gltf *g, const char *path, struct bake_err *err)
{
	static const char *const names[] = { "KHR_draco_mesh_compression",
		"EXT_meshopt_compression", "KHR_meshopt_compression" };
	json_t *used = json_object_get(g->root, "extensionsUsed"), *name;
	size_t i;

	json_array_foreach(used, i, name)
	{
		for (size_t k = 0; k < sizeof names / sizeof *names; k++)
			if (json_is_string(name) &&
			    strcmp(json_string_value(name), names[k]) == 0)
				return bake_fail(err, BAKE_EDATA,
				    "%s: is compressed (%s): decode it first",
				    path, names[k]);
	}
	return BAKE_OK;
}

bool
bake_gltf_add_file(struct bake_gltf *g, const char *path)
{
	char **files = realloc(g->files, (g->nfiles + 2) * sizeof *g->files);

	if (files == NULL)
		return false;
	g->files = files;
	files[g->nfiles] = strdup(path);
	files[g->nfiles + 1] = NULL;
	return files[g->nfiles] != NULL && ++g->nfiles > 0;
}

static enum bake_status
load_file(struct bake_gltf *g, struct bake_gltf_buffer *b, const char *uri,
    size_t max_bytes, struct bake_err *err)
{
	const char *path = g->files[0];
	char *beside = bake_gltf_path(path, uri, err);
	enum bake_status rc;

	if (beside == NULL)
		return BAKE_ENOMEM;
	b->source = BAKE_GLTF_FILE;
	if (!bake_gltf_add_file(g, beside))
		rc = bake_fail(err, BAKE_ENOMEM, "%s: no memory", path);
	else
		rc = bake_mesh_load_file(
		    beside, max_bytes, &b->bytes.data, &b->bytes.n, err);
	free(beside);
	return rc;
}

static enum bake_status
load_buffer(struct bake_gltf *g, size_t i, struct bake_gltf_span bin,
    size_t max_bytes, struct bake_err *err)
{
	json_t *buffer = json_array_get(json_object_get(g->root, "buffers"), i);
	const char *uri = json_string_value(json_object_get(buffer, "uri"));
	size_t length = bake_gltf_size(buffer, "byteLength", 0);
	struct bake_gltf_buffer *b = &g->buffers[i];
	const char *path = g->files[0];
	enum bake_status rc = BAKE_OK;

	if (uri != NULL && bake_gltf_is_file(uri)) {
		rc = load_file(g, b, uri, max_bytes, err);
	} else if (uri != NULL) {
		b->source = BAKE_GLTF_DATA_URI;
		rc = bake_gltf_decode(
		    path, uri, &b->bytes.data, &b->bytes.n, err);
	} else if (i > 0 || bin.bytes == NULL) {
		rc = bake_fail(
		    err, BAKE_EDATA, "'%s': buffer %zu has no data", path, i);
	} else if (!bake_gltf_append(&b->bytes, bin.bytes, bin.n)) {
		rc = bake_fail(err, BAKE_ENOMEM, "%s: no memory", path);
	}
	if (rc != BAKE_OK)
		return rc;
	if (length > b->bytes.n)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' is truncated: buffer %zu has %zu bytes, expected "
		    "%zu",
		    path, i, b->bytes.n, length);
	b->bytes.n = b->bytes.room = length;
	return BAKE_OK;
}

static enum bake_status
load_buffers(struct bake_gltf *g, struct bake_gltf_span bin, size_t max_bytes,
    struct bake_err *err)
{
	size_t n = json_array_size(json_object_get(g->root, "buffers"));
	enum bake_status rc = BAKE_OK;

	g->buffers = bake_zalloc(n, sizeof *g->buffers, err);
	if (g->buffers == NULL)
		return BAKE_ENOMEM;
	g->nbuffers = n;
	for (size_t i = 0; i < n && rc == BAKE_OK; i++)
		rc = load_buffer(g, i, bin, max_bytes, err);
	return rc;
}

static enum bake_status
read_into(struct bake_gltf *g, const char *path, size_t max_bytes,
    struct bake_err *err)
{
	const char *slash = strrchr(path, '/');
	struct bake_gltf_span file = { NULL, 0 }, bin;
	unsigned char *bytes;
	enum bake_status rc;

	g->folder = slash == NULL ? strdup("")
				  : strndup(path, (size_t)(slash + 1 - path));
	if (g->folder == NULL || !bake_gltf_add_file(g, path))
		return bake_fail(err, BAKE_ENOMEM, "%s: no memory", path);
	rc = bake_mesh_load_file(path, max_bytes, &bytes, &file.n, err);
	if (rc != BAKE_OK)
		return rc;
	file.bytes = bytes;
	/* what is written again keeps its NULs */
	if ((rc = bake_gltf_parse(
		 path, file, JSON_ALLOW_NUL, &g->root, &bin, err)) == BAKE_OK &&
	    (rc = refuse_compression(g, path, err)) == BAKE_OK)
		rc = load_buffers(g, bin, max_bytes, err);
	free(bytes);
	return rc;
}

enum bake_status
bake_gltf_read(const char *path, size_t max_bytes, struct bake_gltf **gltf,
    struct bake_err *err)
{
	struct bake_gltf *g = bake_zalloc(1, sizeof *g, err);
	enum bake_status rc;

	*gltf = NULL;
	if (g == NULL)
		return BAKE_ENOMEM;
	rc = read_into(g, path, max_bytes, err);
	if (rc == BAKE_OK)
		*gltf = g;
	else
		bake_gltf_free(g);
	return rc;
}

void
bake_gltf_free(struct bake_gltf *g)
{
	if (g == NULL)
		return;
	for (size_t i = 0; i < g->nbuffers; i++)
		free(g->buffers[i].bytes.data);
	for (size_t i = 0; i < g->nfiles; i++)
		free(g->files[i]);
	free(g->buffers);
	free(g->files);
	free(g->added.data);
	free(g->folder);
	json_decref(g->root);
	free(g);
}

size_t
bake_gltf_nmeshes(const struct bake_gltf *g)
{
	return json_array_size(json_object_get(g->root, "meshes"));
}

const char *const *
bake_gltf_files(const struct bake_gltf *g, size_t *n)
{
	*n = g->nfiles;
	return (const char *const *)g->files;
}
