/* glTF files: reading the JSON and the buffers. */
/* SPDX-License-Identifier: MIT */
#include "gltf.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "gltf_priv.h"
#include "mem.h"

static uint32_t
get_u32(const unsigned char *p)
{
	return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 |
	       (uint32_t)p[3] << 24;
}

/* The parts of a GLB file. */
struct chunks {
	const unsigned char *json, *bin;
	size_t njson, nbin;
};

static enum bake_status
find_chunks(const char *path, const struct bake_gltf_bytes *file,
    struct chunks *c, struct bake_err *err)
{
	size_t at = 12, end;

	if (file->n < 20 || get_u32(file->data + 4) != 2)
		return bake_fail(
		    err, BAKE_EDATA, "%s: is no glTF 2.0 binary", path);
	end = get_u32(file->data + 8);
	if (end > file->n)
		return bake_fail(err, BAKE_EDATA,
		    "%s: is truncated: %zu bytes of %zu", path, file->n, end);
	for (int i = 0; end - at >= 8 && at < end; i++) {
		size_t n = get_u32(file->data + at);
		uint32_t type = get_u32(file->data + at + 4);

		at += 8;
		if (n > end - at)
			return bake_fail(err, BAKE_EDATA,
			    "%s: chunk %d is of %zu bytes, %zu are left", path,
			    i, n, end - at);
		if (i == 0 && type == 0x4e4f534a) { /* JSON */
			c->json = file->data + at;
			c->njson = n;
		} else if (type == 0x004e4942 && c->bin == NULL) { /* BIN */
			c->bin = file->data + at;
			c->nbin = n;
		}
		at += n;
	}
	if (c->json == NULL)
		return bake_fail(
		    err, BAKE_EDATA, "%s: its first chunk is no JSON", path);
	return BAKE_OK;
}

static enum bake_status
parse(struct bake_gltf *g, const char *path, const struct chunks *c,
    struct bake_err *err)
{
	json_error_t why;
	const char *version;

	g->root =
	    json_loadb((const char *)c->json, c->njson, JSON_ALLOW_NUL, &why);
	if (g->root == NULL)
		return bake_fail(err,
		    json_error_code(&why) == json_error_out_of_memory
			? BAKE_ENOMEM
			: BAKE_EDATA,
		    "%s:%d: %s", path, why.line, why.text);
	version = json_string_value(
	    json_object_get(json_object_get(g->root, "asset"), "version"));
	if (version == NULL || strncmp(version, "2.", 2) != 0)
		return bake_fail(err, BAKE_EDATA,
		    "%s: is of glTF version %s, expected 2.0", path,
		    version != NULL ? version : "unknown");
	return BAKE_OK;
}

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
load_file(struct bake_gltf *g, struct bake_gltf_buffer *b, const char *path,
    const char *uri, size_t max_bytes, struct bake_err *err)
{
	char *beside = bake_gltf_path(g->folder, uri);
	enum bake_status rc;

	b->source = BAKE_GLTF_FILE;
	if (beside == NULL || !bake_gltf_add_file(g, beside))
		rc = bake_fail(err, BAKE_ENOMEM, "%s: no memory", path);
	else
		rc = bake_gltf_load(beside, max_bytes, &b->bytes, NULL, err);
	free(beside);
	return rc;
}

static enum bake_status
load_buffer(struct bake_gltf *g, size_t i, const char *path,
    const struct chunks *c, size_t max_bytes, struct bake_err *err)
{
	json_t *buffer = json_array_get(json_object_get(g->root, "buffers"), i);
	json_t *uri = json_object_get(buffer, "uri");
	json_int_t length =
	    json_integer_value(json_object_get(buffer, "byteLength"));
	struct bake_gltf_buffer *b = &g->buffers[i];
	enum bake_status rc = BAKE_OK;

	if (json_is_string(uri) && bake_gltf_is_file(json_string_value(uri))) {
		rc = load_file(
		    g, b, path, json_string_value(uri), max_bytes, err);
	} else if (json_is_string(uri)) {
		b->source = BAKE_GLTF_DATA_URI;
		rc = bake_gltf_decode(json_string_value(uri), &b->bytes, err);
	} else if (i > 0 || c->bin == NULL) {
		rc = bake_fail(
		    err, BAKE_EDATA, "%s: buffer %zu has no data", path, i);
	} else if (!bake_gltf_append(&b->bytes, c->bin, c->nbin)) {
		rc = bake_fail(err, BAKE_ENOMEM, "%s: no memory", path);
	}
	if (rc != BAKE_OK)
		return rc;
	if (length < 0 || b->bytes.n < (size_t)length)
		return bake_fail(err, BAKE_EDATA,
		    "%s: buffer %zu has %zu bytes, expected "
		    "%" JSON_INTEGER_FORMAT,
		    path, i, b->bytes.n, length);
	b->bytes.n = (size_t)length;
	return BAKE_OK;
}

static enum bake_status
load_buffers(struct bake_gltf *g, const char *path, const struct chunks *c,
    size_t max_bytes, struct bake_err *err)
{
	size_t n = json_array_size(json_object_get(g->root, "buffers"));
	enum bake_status rc = BAKE_OK;

	g->buffers = bake_zalloc(n, sizeof *g->buffers, err);
	if (g->buffers == NULL)
		return BAKE_ENOMEM;
	g->nbuffers = n;
	for (size_t i = 0; i < n && rc == BAKE_OK; i++)
		rc = load_buffer(g, i, path, c, max_bytes, err);
	return rc;
}

static enum bake_status
read_into(struct bake_gltf *g, const char *path, size_t max_bytes,
    struct bake_err *err)
{
	const char *slash = strrchr(path, '/');
	struct bake_gltf_bytes file = { NULL, 0, 0 };
	struct chunks c = { NULL, NULL, 0, 0 };
	enum bake_status rc;

	g->folder = slash == NULL ? strdup("")
				  : strndup(path, (size_t)(slash + 1 - path));
	if (g->folder == NULL || !bake_gltf_add_file(g, path))
		return bake_fail(err, BAKE_ENOMEM, "%s: no memory", path);
	if ((rc = bake_gltf_load(path, max_bytes, &file, NULL, err)) != BAKE_OK)
		goto out;
	if (file.n >= 4 && memcmp(file.data, "glTF", 4) == 0) {
		rc = find_chunks(path, &file, &c, err);
	} else {
		c.json = file.data;
		c.njson = file.n;
	}
	if (rc != BAKE_OK || (rc = parse(g, path, &c, err)) != BAKE_OK ||
	    (rc = refuse_compression(g, path, err)) != BAKE_OK)
		goto out;
	rc = load_buffers(g, path, &c, max_bytes, err);
out:
	free(file.data);
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
