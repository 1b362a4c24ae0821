/* A look at an image file before its decoder believes it. */
/* SPDX-License-Identifier: MIT */
#include "image_scan_priv.h"

#include <stdint.h>
#include <string.h>

enum { PNG_MARK = 8, CHUNK_HEAD = 8, CHUNK_CRC = 4 };

/*
 * Chunk by chunk: a length, a type, the data, a checksum. The texels (IDAT)
 * are decoded as they come, which tells better that they end early.
 */
static enum bake_status
scan_png(const struct bake_exr_source *source, const char *name,
    struct bake_err *err)
{
	size_t at = PNG_MARK;

	while (at < source->size && source->size - at >= CHUNK_HEAD) {
		unsigned char head[CHUNK_HEAD];
		size_t size, left = source->size - at - CHUNK_HEAD;

		if (!source->read(source->context, at, head, sizeof head))
			return BAKE_OK; /* the decoder says why */
		size = (size_t)head[0] << 24 | (size_t)head[1] << 16 |
		       (size_t)head[2] << 8 | head[3];
		if (size > left)
			return memcmp(head + 4, "IDAT", 4) == 0
				   ? BAKE_OK
				   : bake_fail(err, BAKE_EDATA,
					 "%s: a chunk of %zu bytes where the "
					 "file has %zu left",
					 name, size, left);
		at += CHUNK_HEAD + size + CHUNK_CRC;
	}
	return BAKE_OK;
}

static enum bake_status
scan_gif(const struct bake_exr_source *source,
    const struct bake_read_limits *limits, const char *name,
    struct bake_err *err)
{
	struct bake_image_claim claim = { .nchans = 4,
		.file_size = source->size };
	unsigned char b[4];

	if (!source->read(source->context, 6, b, sizeof b))
		return BAKE_OK;
	claim.width = b[0] | b[1] << 8;
	claim.height = b[2] | b[3] << 8;
	return bake_image_claim_check(&claim, BAKE_KIND_GIF, limits, name, err);
}

static uint32_t
little(const unsigned char b[4])
{
	return (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 |
	       (uint32_t)b[1] << 8 | b[0];
}

/* Runs are decoded, to the size that the header claims, when it is opened; and
 * texels are looked for before the file where they begin beyond 2 GB. */
static enum bake_status
scan_bmp(const struct bake_exr_source *source,
    const struct bake_read_limits *limits, const char *name,
    struct bake_err *err)
{
	enum { TEXELS = 10, INFO = 14, OLD_INFO_SIZE = 12 };
	struct bake_image_claim claim = { .nchans = 4,
		.file_size = source->size };
	unsigned char b[12];
	int32_t height;

	if (source->read(source->context, TEXELS, b, 4) &&
	    little(b) > source->size)
		return bake_fail(err, BAKE_EDATA,
		    "%s: its texels begin at byte %u of %zu", name, little(b),
		    source->size);
	if (!source->read(source->context, INFO, b, sizeof b))
		return BAKE_OK;
	if (little(b) == OLD_INFO_SIZE) {
		claim.width = b[4] | b[5] << 8;
		claim.height = b[6] | b[7] << 8;
	} else {
		/* a negative height is that of rows from the top */
		height = (int32_t)little(b + 8);
		claim.width = (int32_t)little(b + 4);
		claim.height =
		    height > INT32_MIN && height < 0 ? -height : height;
	}
	return bake_image_claim_check(&claim, BAKE_KIND_BMP, limits, name, err);
}

/* The length of the user's data; all ones where the field is not used. */
static enum bake_status
scan_dpx(const struct bake_exr_source *source, const char *name,
    struct bake_err *err)
{
	enum { USER_SIZE = 32 };
	unsigned char mark, b[4];
	uint32_t size;

	if (!source->read(source->context, 0, &mark, 1) ||
	    !source->read(source->context, USER_SIZE, b, sizeof b))
		return BAKE_OK;
	if (mark == 'S')
		size = (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 |
		       (uint32_t)b[2] << 8 | b[3];
	else
		size = little(b);
	if (size != UINT32_MAX && size > source->size)
		return bake_fail(err, BAKE_EDATA,
		    "%s: %u bytes of user data in a file of %zu", name, size,
		    source->size);
	return BAKE_OK;
}

/* Colour table and resources, each after its length. */
static enum bake_status
scan_psd(const struct bake_exr_source *source, const char *name,
    struct bake_err *err)
{
	size_t at = 26;

	for (int i = 0; i < 2; i++) {
		unsigned char b[4];
		size_t size;

		if (!source->read(source->context, at, b, sizeof b))
			return BAKE_OK;
		at += sizeof b;
		size = (size_t)b[0] << 24 | (size_t)b[1] << 16 |
		       (size_t)b[2] << 8 | b[3];
		if (size > source->size - at)
			return bake_fail(err, BAKE_EDATA,
			    "%s: a section of %zu bytes in a file of %zu", name,
			    size, source->size);
		at += size;
	}
	return BAKE_OK;
}

/* Plain texels of no bits are decoded without end. */
static enum bake_status
scan_dds(const struct bake_exr_source *source, const char *name,
    struct bake_err *err)
{
	enum { FLAGS = 80, BITS = 88, FOURCC = 4 };
	unsigned char flags, b[4];

	if (source->read(source->context, FLAGS, &flags, 1) &&
	    source->read(source->context, BITS, b, sizeof b) &&
	    !(flags & FOURCC) &&
	    (b[0] < 1 || b[0] > 32 || b[1] || b[2] || b[3]))
		return bake_fail(err, BAKE_EDATA,
		    "%s: the DDS header has texels of no or too many bits",
		    name);
	return BAKE_OK;
}

enum bake_status
bake_image_scan(enum bake_image_kind kind, const struct bake_exr_source *source,
    const struct bake_read_limits *limits, const char *name,
    struct bake_err *err)
{
	switch (kind) {
	case BAKE_KIND_BMP:
		return scan_bmp(source, limits, name, err);
	case BAKE_KIND_DDS:
		return scan_dds(source, name, err);
	case BAKE_KIND_DPX:
		return scan_dpx(source, name, err);
	case BAKE_KIND_EXR:
		return bake_exr_scan(source, limits, name, err);
	case BAKE_KIND_GIF:
		return scan_gif(source, limits, name, err);
	case BAKE_KIND_PNG:
		return scan_png(source, name, err);
	case BAKE_KIND_PSD:
		return scan_psd(source, name, err);
	default:
		return BAKE_OK;
	}
}
