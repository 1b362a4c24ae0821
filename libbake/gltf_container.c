/* glTF 2.0: the JSON and the binary chunk of a file, and numbers in JSON. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "gltf_priv.h"

static uint32_t
little32(const unsigned char *p)
{
	return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 |
	       (uint32_t)p[3] << 24;
}

/* The chunks of a .glb; others than these two are passed over. */
static enum bake_status
split_glb(const char *name, struct bake_gltf_span file,
    struct bake_gltf_span *text, struct bake_gltf_span *bin,
    struct bake_err *err)
{
	enum { HEADER = 12, CHUNK = 8, JSON = 0x4e4f534a, BIN = 0x004e4942 };
	const unsigned char *p = file.bytes;
	size_t length, at = HEADER;

	if (file.n < HEADER)
		return bake_fail(err, BAKE_EDATA, "'%s' is truncated", name);
	if (little32(p + 4) != 2)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' is binary glTF of version %u, expected 2", name,
		    (unsigned)little32(p + 4));
	length = little32(p + 8);
	if (length > file.n)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' is truncated: it has %zu bytes, expected %zu", name,
		    file.n, length);
	while (length >= CHUNK && at <= length - CHUNK) {
		size_t n = little32(p + at), type = little32(p + at + 4);

		at += CHUNK;
		if (n > length - at)
			return bake_fail(err, BAKE_EDATA,
			    "'%s' has a chunk of %zu bytes, %zu are left", name,
			    n, length - at);
		if (type == JSON && text->bytes == NULL)
			*text = (struct bake_gltf_span){ p + at, n };
		else if (type == BIN && bin->bytes == NULL)
			*bin = (struct bake_gltf_span){ p + at, n };
		at += n;
	}
	return text->bytes != NULL
		   ? BAKE_OK
		   : bake_fail(err, BAKE_EDATA, "'%s' has no JSON chunk", name);
}

enum bake_status
bake_gltf_parse(const char *name, struct bake_gltf_span file, size_t flags,
    json_t **root, struct bake_gltf_span *bin, struct bake_err *err)
{
	struct bake_gltf_span text = { NULL, 0 };
	const char *version;
	json_error_t why;
	enum bake_status rc;

	*root = NULL;
	*bin = text;
	if (file.n < 4 || memcmp(file.bytes, "glTF", 4) != 0)
		text = file;
	else if ((rc = split_glb(name, file, &text, bin, err)) != BAKE_OK)
		return rc;
	*root = json_loadb((const char *)text.bytes, text.n, flags, &why);
	if (*root == NULL)
		return bake_fail(err,
		    json_error_code(&why) == json_error_out_of_memory
			? BAKE_ENOMEM
			: BAKE_EDATA,
		    "'%s' line %d: %s", name, why.line, why.text);
	version = json_string_value(
	    json_object_get(json_object_get(*root, "asset"), "version"));
	if (version != NULL && strncmp(version, "2.", 2) == 0)
		return BAKE_OK;
	rc = bake_fail(err, BAKE_EDATA,
	    "'%s' is glTF of version %s, expected 2.0", name,
	    version != NULL ? version : "unknown");
	json_decref(*root);
	*root = NULL;
	return rc;
}

size_t
bake_gltf_size(const json_t *object, const char *key, size_t fallback)
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
