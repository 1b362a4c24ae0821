/* A look at an EXR file's headers before the EXR library believes them. */
/* SPDX-License-Identifier: MIT */
#include "exr_scan_priv.h"

#include <stdint.h>
#include <string.h>

#include "image_kind.h"

enum { NAME_MAX_BYTES = 256, MULTIPART = 0x1000 };
/* the rows of the largest chunk, DWAB's */
enum { CHUNK_ROWS = 256 };

struct scan {
	const struct bake_exr_source *source;
	const struct bake_read_limits *limits;
	const char *name;
	size_t at;
	/* of the header that is being read */
	bool has_window;
	int32_t window[4];
	uint32_t tile[2], nchunks;
};

static enum bake_status
corrupt(const struct scan *s, struct bake_err *err)
{
	return bake_fail(
	    err, BAKE_EDATA, "%s: the EXR header is corrupt", s->name);
}

static uint32_t
little(const unsigned char b[4])
{
	return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 |
	       (uint32_t)b[3] << 24;
}

static bool
get(struct scan *s, void *bytes, size_t n)
{
	if (n > s->source->size - s->at ||
	    !s->source->read(s->source->context, s->at, bytes, n))
		return false;
	s->at += n;
	return true;
}

/* A text and its end; false where it is too long. */
static bool
get_text(struct scan *s, char text[NAME_MAX_BYTES])
{
	for (int i = 0; i < NAME_MAX_BYTES; i++) {
		if (!get(s, &text[i], 1))
			return false;
		if (text[i] == '\0')
			return true;
	}
	return false;
}

/*
 * Whether an attribute's value has the size that its type has: the library
 * reads what the type takes, whatever the size says, and would go on at another
 * place than we. A preview says itself how large it is.
 */
static bool
fits_type(struct scan *s, const char *type, size_t size)
{
	static const struct {
		const char *type;
		size_t size;
	} fixed[] = {
		{ "box2f", 16 },
		{ "box2i", 16 },
		{ "chromaticities", 32 },
		{ "compression", 1 },
		{ "double", 8 },
		{ "envmap", 1 },
		{ "float", 4 },
		{ "int", 4 },
		{ "keycode", 28 },
		{ "lineOrder", 1 },
		{ "m33d", 72 },
		{ "m33f", 36 },
		{ "m44d", 128 },
		{ "m44f", 64 },
		{ "rational", 8 },
		{ "tiledesc", 9 },
		{ "timecode", 8 },
		{ "v2d", 16 },
		{ "v2f", 8 },
		{ "v2i", 8 },
		{ "v3d", 24 },
		{ "v3f", 12 },
		{ "v3i", 12 },
	};
	unsigned char b[8];

	for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++)
		if (strcmp(type, fixed[i].type) == 0)
			return size == fixed[i].size;
	if (strcmp(type, "preview") != 0)
		return true;
	return size >= sizeof b &&
	       s->source->read(s->source->context, s->at, b, sizeof b) &&
	       (uint64_t)little(b) * little(b + 4) == (size - sizeof b) / 4;
}

/* The attributes that say how much there is. */
static bool
note_attribute(struct scan *s, const char *name, size_t size)
{
	unsigned char b[16];
	size_t n = strcmp(name, "dataWindow") == 0   ? 16
		   : strcmp(name, "tiles") == 0      ? 8
		   : strcmp(name, "chunkCount") == 0 ? 4
						     : 0;

	if (n == 0 || size < n)
		return true; /* the library refuses what is too short */
	if (!s->source->read(s->source->context, s->at, b, n))
		return false;
	if (n == 16) {
		s->has_window = true;
		for (int i = 0; i < 4; i++)
			s->window[i] = (int32_t)little(b + 4 * i);
	} else if (n == 8) {
		s->tile[0] = little(b);
		s->tile[1] = little(b + 4);
	} else {
		s->nchunks = little(b);
	}
	return true;
}

/* Whether the table of the part's chunks, 8 bytes each, fits into the file. */
static bool
table_fits(const struct scan *s, uint64_t width, uint64_t height)
{
	uint64_t n = (height + CHUNK_ROWS - 1) / CHUNK_ROWS;

	if (s->tile[0] > 0 && s->tile[1] > 0)
		n = ((width + s->tile[0] - 1) / s->tile[0]) *
		    ((height + s->tile[1] - 1) / s->tile[1]);
	if (s->nchunks > n)
		n = s->nchunks;
	return n <= s->source->size / 8;
}

static enum bake_status
check_part(const struct scan *s, struct bake_err *err)
{
	int64_t w = (int64_t)s->window[2] - s->window[0] + 1;
	int64_t h = (int64_t)s->window[3] - s->window[1] + 1;
	struct bake_image_claim claim = { .nchans = 1,
		.file_size = s->source->size };

	if (!s->has_window || w < 1 || h < 1 || w > INT32_MAX || h > INT32_MAX)
		return corrupt(s, err);
	claim.width = (int)w;
	claim.height = (int)h;
	if (!table_fits(s, (uint64_t)w, (uint64_t)h))
		return bake_fail(err, BAKE_EDATA,
		    "%s: claims %dx%d texels, for whose chunks its %zu bytes "
		    "have no room",
		    s->name, claim.width, claim.height, claim.file_size);
	return bake_image_claim_check(
	    &claim, BAKE_KIND_EXR, s->limits, s->name, err);
}

/* One header; *empty: it has no attribute, which ends those of a multi-part
 * file. */
static enum bake_status
scan_header(struct scan *s, bool *empty, struct bake_err *err)
{
	char name[NAME_MAX_BYTES], type[NAME_MAX_BYTES];
	unsigned char b[4];

	*empty = true;
	s->has_window = false;
	s->tile[0] = s->tile[1] = s->nchunks = 0;
	for (;;) {
		size_t size;

		if (!get_text(s, name))
			return corrupt(s, err);
		if (name[0] == '\0')
			return *empty ? BAKE_OK : check_part(s, err);
		*empty = false;
		if (!get_text(s, type) || !get(s, b, sizeof b))
			return corrupt(s, err);
		size = little(b);
		if (size > s->source->size - s->at ||
		    !fits_type(s, type, size) || !note_attribute(s, name, size))
			return corrupt(s, err);
		s->at += size;
	}
}

enum bake_status
bake_exr_scan(const struct bake_exr_source *source,
    const struct bake_read_limits *limits, const char *name,
    struct bake_err *err)
{
	static const unsigned char mark[] = { 0x76, 0x2f, 0x31, 0x01 };
	struct scan s = { .source = source, .limits = limits, .name = name };
	unsigned char b[8];
	enum bake_status rc = BAKE_OK;
	bool empty = false;

	if (!get(&s, b, sizeof b) || memcmp(b, mark, sizeof mark) != 0)
		return bake_fail(err, BAKE_EDATA, "%s: not an EXR file", name);
	if ((little(b + 4) & MULTIPART) == 0) {
		rc = scan_header(&s, &empty, err);
		return rc == BAKE_OK && empty ? corrupt(&s, err) : rc;
	}
	for (int n = 0; rc == BAKE_OK && !empty; n++) {
		if (n > BAKE_EXR_PARTS)
			return bake_fail(err, BAKE_ELIMIT,
			    "%s: more than %d parts", name, BAKE_EXR_PARTS);
		rc = scan_header(&s, &empty, err);
		if (rc == BAKE_OK && empty && n == 0)
			return corrupt(&s, err);
	}
	return rc;
}
