/* glTF files: the names of files, data URIs, and bytes that grow. */
/* SPDX-License-Identifier: MIT */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "gltf_priv.h"
#include "mem.h"
#include "mesh_priv.h"

/* -- bytes ----------------------------------------------------------------- */

bool
bake_gltf_append(struct bake_gltf_bytes *bytes, const void *data, size_t n)
{
	if (n > bytes->room - bytes->n) {
		size_t room = bytes->room + bytes->room / 2 + 4096;
		unsigned char *grown;

		if (n > SIZE_MAX / 2 - bytes->n)
			return false;
		if (room < bytes->n + n)
			room = bytes->n + n;
		grown = realloc(bytes->data, room);
		if (grown == NULL)
			return false;
		bytes->data = grown;
		bytes->room = room;
	}
	if (data != NULL && n > 0)
		memcpy(bytes->data + bytes->n, data, n);
	else if (n > 0)
		memset(bytes->data + bytes->n, 0, n);
	bytes->n += n;
	return true;
}

bool
bake_gltf_pad(struct bake_gltf_bytes *bytes, unsigned char fill)
{
	while (bytes->n % 4 != 0)
		if (!bake_gltf_append(bytes, &fill, 1))
			return false;
	return true;
}

/* -- names of files -----------------------------------------------------------
 */

bool
bake_gltf_is_file(const char *uri)
{
	const char *p = uri;

	/* RFC 3986: a scheme is a letter, then letters, digits, + - . */
	if (!isalpha((unsigned char)*p))
		return true;
	while (
	    isalnum((unsigned char)*p) || *p == '+' || *p == '-' || *p == '.')
		p++;
	return *p != ':';
}

static int
hex(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	if (c >= 'a' && c <= 'f')
		return c - 'a' + 10;
	return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

char *
bake_gltf_path(const char *name, const char *uri, struct bake_err *err)
{
	char *text = bake_mesh_copy_text(uri, strlen(uri), err), *to = text;
	char *path;

	if (text == NULL)
		return NULL;
	for (; *uri != '\0'; uri++) {
		int hi = *uri == '%' ? hex(uri[1]) : -1;
		int lo = hi >= 0 ? hex(uri[2]) : -1;

		/* a NUL cannot be in a name */
		if (lo >= 0 && hi * 16 + lo != 0) {
			*to++ = (char)(hi * 16 + lo);
			uri += 2;
		} else {
			*to++ = *uri;
		}
	}
	path = bake_mesh_join_path(name, text, (size_t)(to - text), err);
	free(text);
	return path;
}

/* Append a path's text to a URI, with %xx for what a URI cannot hold. */
static char *
put_escaped(char *at, const char *text, size_t n)
{
	static const char digits[] = "0123456789ABCDEF";

	for (size_t i = 0; i < n; i++) {
		unsigned char c = (unsigned char)text[i];

		if (isalnum(c) || strchr("-._~/!$&'()*+,;=@", c) != NULL) {
			*at++ = (char)c;
		} else {
			*at++ = '%';
			*at++ = digits[c >> 4];
			*at++ = digits[c & 15];
		}
	}
	return at;
}

/* The real path of the folder that a file is in, ending in '/'. */
static char *
real_folder(const char *path)
{
	const char *slash = strrchr(path, '/');
	char *name = slash == NULL ? strdup("./")
				   : strndup(path, (size_t)(slash + 1 - path));
	char *real = name != NULL ? realpath(name, NULL) : NULL, *whole = NULL;

	if (real != NULL &&
	    asprintf(&whole, "%s%s", real, strcmp(real, "/") ? "/" : "") < 0)
		whole = NULL;
	free(name);
	free(real);
	return whole;
}

enum bake_status
bake_gltf_relative(
    const char *folder, const char *out, char **head, struct bake_err *err)
{
	char *from = real_folder(strcmp(out, "-") == 0 ? "./" : out);
	/* errno is the first failure's */
	char *to = from != NULL ? real_folder(folder) : NULL;
	enum bake_status rc = BAKE_OK;
	size_t same = 0, nup = 0;
	char *at;

	*head = NULL;
	if (from == NULL || to == NULL) {
		rc = bake_fail(err, errno == ENOMEM ? BAKE_ENOMEM : BAKE_EIO,
		    "%s: %s", from == NULL ? out : folder, strerror(errno));
		goto out;
	}
	for (size_t i = 0; from[i] != '\0' && from[i] == to[i]; i++)
		if (from[i] == '/')
			same = i + 1;
	for (const char *p = from + same; *p != '\0'; p++)
		nup += *p == '/';
	*head = at = malloc(3 * (nup + strlen(to)) + 1);
	if (at == NULL) {
		rc = bake_fail(err, BAKE_ENOMEM, "%s: no memory", out);
		goto out;
	}
	for (size_t i = 0; i < nup; i++)
		at = stpcpy(at, "../");
	at = put_escaped(at, to + same, strlen(to + same));
	*at = '\0';
out:
	free(from);
	free(to);
	return rc;
}

/* -- data URIs ----------------------------------------------------------------
 */

static const char base64[] =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

bool
bake_gltf_is_data(const char *uri)
{
	return strncasecmp(uri, "data:", 5) == 0;
}

/* Returns false where the text is no base64 (RFC 4648, its padding may be
 * missing); out has room for 3 bytes for each 4 letters begun. */
static bool
decode_base64(const char *text, unsigned char *out, size_t *n)
{
	signed char value[256];
	unsigned bits = 0, nbits = 0;

	memset(value, -1, sizeof value);
	for (int i = 0; i < 64; i++)
		value[(unsigned char)base64[i]] = (signed char)i;
	for (; *text != '\0' && *text != '='; text++) {
		int v = value[(unsigned char)*text];

		if (v < 0)
			return false;
		bits = (bits << 6 | (unsigned)v) & 0xffffff;
		nbits += 6;
		if (nbits < 8)
			continue;
		nbits -= 8;
		out[(*n)++] = (unsigned char)(bits >> nbits);
	}
	return strspn(text, "=") == strlen(text) && nbits < 6;
}

enum bake_status
bake_gltf_decode(const char *name, const char *uri, unsigned char **bytes,
    size_t *n, struct bake_err *err)
{
	const char *comma = strchr(uri, ',');

	*n = 0;
	*bytes = NULL;
	if (bake_gltf_is_data(uri) && comma != NULL && comma - uri >= 12 &&
	    strncmp(comma - 7, ";base64", 7) == 0) {
		*bytes = bake_alloc(strlen(comma) / 4 * 3 + 3, 1, err);
		if (*bytes == NULL)
			return BAKE_ENOMEM;
		if (decode_base64(comma + 1, *bytes, n))
			return BAKE_OK;
		free(*bytes);
		*bytes = NULL;
		*n = 0;
	}
	return bake_fail(
	    err, BAKE_EDATA, "'%s' has a data URI that is not base64", name);
}

char *
bake_gltf_encode(const unsigned char *data, size_t n)
{
	static const char head[] = "data:application/octet-stream;base64,";
	char *uri, *at;

	if (n > SIZE_MAX / 2)
		return NULL;
	uri = malloc(sizeof head + n / 3 * 4 + 8);
	if (uri == NULL)
		return NULL;
	at = stpcpy(uri, head);
	for (size_t i = 0; i < n; i += 3) {
		size_t left = n - i;
		unsigned v = (unsigned)data[i] << 16 |
			     (left > 1 ? (unsigned)data[i + 1] << 8 : 0) |
			     (left > 2 ? data[i + 2] : 0);

		*at++ = base64[v >> 18];
		*at++ = base64[v >> 12 & 63];
		*at++ = left > 1 ? base64[v >> 6 & 63] : '=';
		*at++ = left > 2 ? base64[v & 63] : '=';
	}
	*at = '\0';
	return uri;
}
