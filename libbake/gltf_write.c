/* glTF files: writing, as JSON or with all in one file. */
/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "gltf_priv.h"
#include "mesh_priv.h"
#include "quadric_text_priv.h"

/* -- JSON as text -------------------------------------------------------------
 */

/* What the JSON is written to. */
struct sink {
	struct bake_gltf_bytes bytes;
	bool in_string;
};

/* jansson writes 17 digits, whatever the number; each number comes in one
 * call, and a string between two calls of one quotation mark. */
static int
take_text(const char *text, size_t n, void *arg)
{
	struct sink *s = arg;
	char number[BAKE_NUMBER_TEXT + 2], *end;

	if (n == 1 && *text == '"')
		s->in_string = !s->in_string;
	if (!s->in_string && n > 12 && n < 32 && memchr(text, '.', n) != NULL) {
		double v;

		memcpy(number, text, n);
		number[n] = '\0';
		v = strtod(number, &end);
		if (end == number + n && isfinite(v)) {
			end = bake_number_text(number, v);
			/* 3 would be an integer, where there was none */
			*end = '\0';
			if (strpbrk(number, ".e") == NULL)
				end = stpcpy(end, ".0");
			n = (size_t)(end - number);
			text = number;
		}
	}
	return bake_gltf_append(&s->bytes, text, n) ? 0 : -1;
}

static enum bake_status
to_text(const json_t *root, size_t flags, struct bake_gltf_bytes *text,
    struct bake_err *err)
{
	struct sink s = { { NULL, 0, 0 }, false };

	if (json_dump_callback(root, take_text, &s, flags) != 0) {
		free(s.bytes.data);
		return bake_fail(err, BAKE_ENOMEM, "no memory");
	}
	*text = s.bytes;
	return BAKE_OK;
}

/* -- GLB
 * ------------------------------------------------------------------------
 */

static void
put_u32(FILE *fp, size_t v)
{
	for (int i = 0; i < 4; i++)
		putc((int)(v >> 8 * i & 255), fp);
}

enum bake_status
bake_gltf_put_glb(FILE *fp, const json_t *root,
    const struct bake_gltf_bytes *buffer, struct bake_err *err)
{
	struct bake_gltf_bytes text = { NULL, 0, 0 };
	enum bake_status rc = to_text(root, JSON_COMPACT, &text, err);
	size_t whole;

	if (rc != BAKE_OK)
		return rc;
	if (!bake_gltf_pad(&text, ' ')) {
		rc = bake_fail(err, BAKE_ENOMEM, "no memory");
		goto out;
	}
	/* each of the two is in memory: their sum does not overflow */
	whole = 12 + 8 + text.n + (buffer->n > 0 ? 8 + buffer->n : 0);
	if (whole > UINT32_MAX) {
		rc = bake_fail(err, BAKE_EDATA,
		    "%zu bytes are more than a GLB file can have: write .gltf",
		    whole);
		goto out;
	}
	fwrite("glTF", 1, 4, fp);
	put_u32(fp, 2);
	put_u32(fp, whole);
	put_u32(fp, text.n);
	fwrite("JSON", 1, 4, fp);
	fwrite(text.data, 1, text.n, fp);
	if (buffer->n > 0) {
		put_u32(fp, buffer->n);
		fwrite("BIN", 1, 4, fp);
		fwrite(buffer->data, 1, buffer->n, fp);
	}
out:
	free(text.data);
	return rc;
}

/* Move the buffer views of the JSON to the one buffer; base[i] is where buffer
 * i begins in it. */
static bool
move_views(json_t *root, const size_t *base, size_t n)
{
	json_t *view;
	size_t i;

	json_array_foreach(json_object_get(root, "bufferViews"), i, view)
	{
		json_int_t b =
		    json_integer_value(json_object_get(view, "buffer"));
		json_int_t at =
		    json_integer_value(json_object_get(view, "byteOffset"));

		if (b <= 0 || (size_t)b >= n)
			continue;
		if (json_object_set_new(view, "buffer", json_integer(0)) ||
		    json_object_set_new(view, "byteOffset",
			json_integer(at + (json_int_t)base[b])))
			return false;
	}
	return true;
}

/* The list of buffers becomes the first of them, without a URI. */
static bool
one_buffer(json_t *root, size_t length)
{
	json_t *buffers = bake_gltf_array(root, "buffers"), *first;

	if (length == 0)
		return json_object_del(root, "buffers") == 0;
	while (json_array_size(buffers) > 1)
		json_array_remove(buffers, 1);
	if (json_array_size(buffers) == 0 &&
	    json_array_append_new(buffers, json_object()) != 0)
		return false;
	first = json_array_get(buffers, 0);
	json_object_del(first, "uri");
	return json_object_set_new(
		   first, "byteLength", json_integer((json_int_t)length)) == 0;
}

enum bake_status
bake_gltf_merge(const struct bake_gltf *g, json_t **root,
    struct bake_gltf_bytes *buffer, struct bake_err *err)
{
	size_t *base = calloc(g->nbuffers + 1, sizeof *base);
	bool ok = base != NULL;

	*root = json_deep_copy(g->root);
	for (size_t i = 0; i <= g->nbuffers && ok; i++) {
		const struct bake_gltf_bytes *b =
		    i < g->nbuffers ? &g->buffers[i].bytes : &g->added;

		base[i] = buffer->n;
		/* base 0 leaves offsets that are missing as they are */
		ok = bake_gltf_append(buffer, b->data, b->n) &&
		     bake_gltf_pad(buffer, 0);
	}
	ok = ok && *root != NULL && move_views(*root, base, g->nbuffers + 1) &&
	     one_buffer(*root, buffer->n);
	free(base);
	return ok ? BAKE_OK : bake_fail(err, BAKE_ENOMEM, "no memory");
}

/* -- images -------------------------------------------------------------------
 */

/* The MIME type of a picture's bytes; NULL where glTF knows none. */
static const char *
mime_type(const struct bake_gltf_bytes *b)
{
	static const struct {
		const char *mime, *magic;
		size_t at, n;
	} types[] = {
		{ "image/png", "\x89PNG", 0, 4 },
		{ "image/jpeg", "\xff\xd8\xff", 0, 3 },
		{ "image/webp", "WEBP", 8, 4 },
		{ "image/ktx2", "\xabKTX 20\xbb", 0, 8 },
		{ "image/vnd-ms.dds", "DDS ", 0, 4 },
	};

	for (size_t i = 0; i < sizeof types / sizeof *types; i++)
		if (b->n >= types[i].at + types[i].n &&
		    memcmp(b->data + types[i].at, types[i].magic, types[i].n) ==
			0)
			return types[i].mime;
	return NULL;
}

/* Put a picture's bytes into the buffer, and name them in its JSON. */
static bool
embed(json_t *root, json_t *image, const struct bake_gltf_bytes *file,
    const char *mime, struct bake_gltf_bytes *buffer)
{
	json_t *views = bake_gltf_array(root, "bufferViews");
	json_t *view = json_object();
	size_t at = buffer->n;

	if (views == NULL || json_array_append_new(views, view) != 0 ||
	    !bake_gltf_append(buffer, file->data, file->n) ||
	    !bake_gltf_pad(buffer, 0) ||
	    json_object_set_new(view, "buffer", json_integer(0)) ||
	    json_object_set_new(
		view, "byteOffset", json_integer((json_int_t)at)) ||
	    json_object_set_new(
		view, "byteLength", json_integer((json_int_t)file->n)) ||
	    json_object_set_new(image, "bufferView",
		json_integer((json_int_t)json_array_size(views) - 1)) ||
	    json_object_set_new(image, "mimeType", json_string(mime)))
		return false;
	json_object_del(image, "uri");
	return true;
}

/* Lead to the same file from where the output will be. */
static bool
move_uri(json_t *object, const char *head)
{
	const char *uri = json_string_value(json_object_get(object, "uri"));
	char *moved;
	bool ok;

	if (uri == NULL || !bake_gltf_is_file(uri) || *uri == '/' ||
	    *head == '\0')
		return true;
	if (asprintf(&moved, "%s%s", head, uri) < 0)
		return false;
	ok = json_object_set_new(object, "uri", json_string(moved)) == 0;
	free(moved);
	return ok;
}

static enum bake_status
move_or_embed(struct bake_gltf *g, json_t *root, json_t *image,
    const char *head, struct bake_gltf_bytes *buffer, struct bake_err *err)
{
	const char *uri = json_string_value(json_object_get(image, "uri"));
	struct bake_gltf_bytes file = { NULL, 0, 0 };
	enum bake_status rc = BAKE_OK;
	const char *mime = NULL;
	bool missing, ok;
	char *path;

	if (uri == NULL || !bake_gltf_is_file(uri))
		return BAKE_OK;
	if (buffer != NULL) {
		path = bake_gltf_path(g->folder, uri, err);
		if (path == NULL)
			return BAKE_ENOMEM;
		missing = access(path, F_OK) != 0 && errno == ENOENT;
		if (!missing)
			rc = bake_mesh_load_file(
			    path, UINT32_MAX, &file.data, &file.n, err);
		if (rc == BAKE_OK && !missing && !bake_gltf_add_file(g, path))
			rc = bake_fail(err, BAKE_ENOMEM, "no memory");
		free(path);
		mime = mime_type(&file);
	}
	if (rc != BAKE_OK)
		goto out;
	ok = mime != NULL ? embed(root, image, &file, mime, buffer)
			  : move_uri(image, head);
	rc = ok ? BAKE_OK : bake_fail(err, BAKE_ENOMEM, "no memory");
out:
	free(file.data);
	return rc;
}

/* buffer is the GLB's; NULL: pictures stay where they are. */
static enum bake_status
move_images(struct bake_gltf *g, json_t *root, const char *head,
    struct bake_gltf_bytes *buffer, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;
	json_t *image;
	size_t i;

	json_array_foreach(
	    json_object_get(root, "images"), i, image) if (rc == BAKE_OK) rc =
	    move_or_embed(g, root, image, head, buffer, err);
	return rc;
}

/* -- all together -----------------------------------------------------------
 */

static enum bake_status
write_glb(struct bake_gltf *g, FILE *fp, const char *head, struct bake_err *err)
{
	struct bake_gltf_bytes buffer = { NULL, 0, 0 };
	json_t *root = NULL;
	enum bake_status rc = bake_gltf_merge(g, &root, &buffer, err);

	if (rc == BAKE_OK)
		rc = move_images(g, root, head, &buffer, err);
	if (rc == BAKE_OK && !one_buffer(root, buffer.n))
		rc = bake_fail(err, BAKE_ENOMEM, "no memory");
	if (rc == BAKE_OK)
		rc = bake_gltf_put_glb(fp, root, &buffer, err);
	json_decref(root);
	free(buffer.data);
	return rc;
}

static bool
set_data_uri(json_t *buffer, const struct bake_gltf_bytes *bytes)
{
	char *uri = bake_gltf_encode(bytes->data, bytes->n);
	bool ok = uri != NULL &&
		  json_object_set_new(buffer, "byteLength",
		      json_integer((json_int_t)bytes->n)) == 0 &&
		  json_object_set_new(buffer, "uri", json_string(uri)) == 0;

	free(uri);
	return ok;
}

static bool
move_buffers(const struct bake_gltf *g, json_t *root, const char *head)
{
	json_t *buffers = json_object_get(root, "buffers"), *added;

	for (size_t i = 0; i < g->nbuffers; i++) {
		json_t *b = json_array_get(buffers, i);

		if (g->buffers[i].source == BAKE_GLTF_CHUNK
			? !set_data_uri(b, &g->buffers[i].bytes)
			: !move_uri(b, head))
			return false;
	}
	if (g->added.n == 0)
		return true;
	buffers = bake_gltf_array(root, "buffers");
	added = json_object();
	return buffers != NULL && json_array_append_new(buffers, added) == 0 &&
	       set_data_uri(added, &g->added);
}

static enum bake_status
write_json(
    struct bake_gltf *g, FILE *fp, const char *head, struct bake_err *err)
{
	struct bake_gltf_bytes text = { NULL, 0, 0 };
	json_t *root = json_deep_copy(g->root);
	enum bake_status rc;

	if (root == NULL || !move_buffers(g, root, head))
		rc = bake_fail(err, BAKE_ENOMEM, "no memory");
	else if ((rc = move_images(g, root, head, NULL, err)) == BAKE_OK)
		rc = to_text(root, JSON_INDENT(2), &text, err);
	if (rc == BAKE_OK) {
		fwrite(text.data, 1, text.n, fp);
		putc('\n', fp);
	}
	json_decref(root);
	free(text.data);
	return rc;
}

enum bake_status
bake_gltf_write(struct bake_gltf *g, FILE *fp, bool glb, const char *path,
    struct bake_err *err)
{
	char *head;
	enum bake_status rc = bake_gltf_relative(g->folder, path, &head, err);

	if (rc == BAKE_OK)
		rc = glb ? write_glb(g, fp, head, err)
			 : write_json(g, fp, head, err);
	free(head);
	return rc;
}
