/* glTF 2.0: the container and its buffers. */
/* SPDX-License-Identifier: MIT */
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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

size_t
bake_mesh_gltf_size(const json_t *object, const char *key, size_t fallback)
{
	const json_t *x = json_object_get(object, key);
	double v;

	if (x == NULL)
		return fallback;
	if (!json_is_number(x))
		return SIZE_MAX;
	v = json_number_value(x);
	return v >= 0.0 && v <= 9007199254740992.0 && v == floor(v) ? (size_t)v
								    : SIZE_MAX;
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

/* -- URIs ---------------------------------------------------------------- */

static int
base64_digit(char c)
{
	static const char digits[] =
	    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	const char *p = c != '\0' ? strchr(digits, c) : NULL;

	return p != NULL ? (int)(p - digits) : -1;
}

enum bake_status
bake_mesh_gltf_data_uri(const struct gltf *g, const char *uri,
    unsigned char **bytes, size_t *n, struct bake_err *err)
{
	const char *p = strstr(uri, ";base64,");
	unsigned bits = 0;
	int nbits = 0;

	*n = 0;
	*bytes = NULL;
	if (p == NULL || strchr(uri, ',') < p)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' has a data URI that is not base64", g->b->src->name);
	p += strlen(";base64,");
	if ((*bytes = bake_alloc(strlen(p) / 4 * 3 + 3, 1, err)) == NULL)
		return BAKE_ENOMEM;
	for (; *p != '\0' && *p != '='; p++) {
		int digit = base64_digit(*p);

		if (digit < 0) {
			free(*bytes);
			*bytes = NULL;
			return bake_fail(err, BAKE_EDATA,
			    "'%s' has a data URI that is not base64",
			    g->b->src->name);
		}
		bits = (bits << 6 | (unsigned)digit) & 0xffffff;
		nbits += 6;
		if (nbits >= 8) {
			nbits -= 8;
			(*bytes)[(*n)++] = (unsigned char)(bits >> nbits);
		}
	}
	return BAKE_OK;
}

static int
hex_digit(char c)
{
	return c >= '0' && c <= '9'   ? c - '0'
	       : c >= 'a' && c <= 'f' ? c - 'a' + 10
	       : c >= 'A' && c <= 'F' ? c - 'A' + 10
				      : -1;
}

char *
bake_mesh_gltf_path(const struct gltf *g, const char *uri, struct bake_err *err)
{
	char *text = bake_mesh_copy_text(uri, strlen(uri), err), *to = text,
	     *path;

	if (text == NULL)
		return NULL;
	for (const char *p = uri; *p != '\0'; p++) {
		int hi = *p == '%' ? hex_digit(p[1]) : -1;
		int lo = hi >= 0 ? hex_digit(p[2]) : -1;

		if (lo >= 0 && hi * 16 + lo != 0) {
			*to++ = (char)(hi * 16 + lo);
			p += 2;
		} else {
			*to++ = *p;
		}
	}
	path = bake_mesh_join_path(
	    g->b->src->name, text, (size_t)(to - text), err);
	free(text);
	return path;
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

	if (strncasecmp(uri, "data:", 5) == 0) {
		rc = bake_mesh_gltf_data_uri(
		    g, uri, &buffer->owned, &buffer->n, err);
		buffer->bytes = buffer->owned;
		return rc;
	}
	if (!src->params->side_files)
		return bake_fail(err, BAKE_EDATA, "'%s' needs the file '%s'",
		    src->name, uri);
	if ((path = bake_mesh_gltf_path(g, uri, err)) == NULL)
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
	length = bake_mesh_gltf_size(object, "byteLength", SIZE_MAX);
	if (uri != NULL) {
		if ((rc = load_uri(g, buffer, uri, err)) != BAKE_OK)
			return rc;
	} else if (index == 0 && g->bin != NULL) {
		buffer->bytes = g->bin;
		buffer->n = g->nbin;
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
	buffer = bake_mesh_gltf_size(view, "buffer", SIZE_MAX);
	if ((rc = load_buffer(g, buffer, err)) != BAKE_OK)
		return rc;
	offset = bake_mesh_gltf_size(view, "byteOffset", 0);
	*n = bake_mesh_gltf_size(view, "byteLength", SIZE_MAX);
	*stride = bake_mesh_gltf_size(view, "byteStride", 0);
	if (offset > g->buffers[buffer].n ||
	    *n > g->buffers[buffer].n - offset || *stride > 252)
		return bake_fail(err, BAKE_EDATA,
		    "'%s': bufferView %zu is beyond the %zu bytes of its "
		    "buffer",
		    g->b->src->name, index, g->buffers[buffer].n);
	*bytes = g->buffers[buffer].bytes + offset;
	return BAKE_OK;
}

/* -- the container ------------------------------------------------------- */

static uint32_t
little32(const unsigned char *p)
{
	return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 |
	       (uint32_t)p[3] << 24;
}

/* The chunks of a .glb. */
static enum bake_status
split_glb(struct gltf *g, const unsigned char **text, size_t *ntext,
    struct bake_err *err)
{
	enum { HEADER = 12, CHUNK = 8, JSON = 0x4e4f534a, BIN = 0x004e4942 };
	const struct mesh_source *src = g->b->src;
	const unsigned char *p = src->bytes;
	size_t length, at = HEADER;

	if (src->nbytes < HEADER)
		return bake_fail(
		    err, BAKE_EDATA, "'%s' is truncated", src->name);
	if (little32(p + 4) != 2)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' is binary glTF of version %u, expected 2", src->name,
		    (unsigned)little32(p + 4));
	length = little32(p + 8);
	if (length > src->nbytes)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' is truncated: it has %zu bytes, expected %zu",
		    src->name, src->nbytes, length);
	*text = NULL;
	while (length >= CHUNK && at <= length - CHUNK) {
		size_t n = little32(p + at), type = little32(p + at + 4);

		at += CHUNK;
		if (n > length - at)
			return bake_fail(err, BAKE_EDATA,
			    "'%s' has a chunk of %zu bytes, %zu are left",
			    src->name, n, length - at);
		if (type == JSON && *text == NULL) {
			*text = p + at;
			*ntext = n;
		} else if (type == BIN && g->bin == NULL) {
			g->bin = p + at;
			g->nbin = n;
		}
		at += n;
	}
	if (*text == NULL)
		return bake_fail(
		    err, BAKE_EDATA, "'%s' has no JSON chunk", src->name);
	return BAKE_OK;
}

static enum bake_status
parse(struct gltf *g, struct bake_err *err)
{
	const struct mesh_source *src = g->b->src;
	const unsigned char *text = src->bytes;
	size_t ntext = src->nbytes;
	json_error_t why;
	const char *version;
	enum bake_status rc;

	if (ntext >= 4 && memcmp(text, "glTF", 4) == 0 &&
	    (rc = split_glb(g, &text, &ntext, err)) != BAKE_OK)
		return rc;
	g->root = json_loadb((const char *)text, ntext, 0, &why);
	if (g->root == NULL)
		return bake_fail(err, BAKE_EDATA, "'%s' line %d: %s", src->name,
		    why.line, why.text);
	version = json_string_value(
	    json_object_get(json_object_get(g->root, "asset"), "version"));
	if (version == NULL || strncmp(version, "2.", 2) != 0)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' is glTF of version %s, expected 2.0", src->name,
		    version != NULL ? version : "unknown");
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
