/* Kinds of image files: their marks, and what size of image one can hold. */
/* SPDX-License-Identifier: MIT */
#include "image_kind.h"

#include <stdint.h>
#include <string.h>
#include <strings.h>

struct mark {
	enum bake_image_kind kind;
	size_t offset, size;
	const char *bytes;
};

static const struct mark marks[] = {
	{ BAKE_KIND_PNG, 0, 4, "\x89PNG" },
	{ BAKE_KIND_EXR, 0, 4, "\x76\x2f\x31\x01" },
	{ BAKE_KIND_JPEG, 0, 3, "\xff\xd8\xff" },
	{ BAKE_KIND_TIFF, 0, 4, "II*\0" },
	{ BAKE_KIND_TIFF, 0, 4, "MM\0*" },
	{ BAKE_KIND_TIFF, 0, 4, "II+\0" },
	{ BAKE_KIND_TIFF, 0, 4, "MM\0+" },
	{ BAKE_KIND_WEBP, 8, 4, "WEBP" },
	{ BAKE_KIND_DDS, 0, 4, "DDS " },
	{ BAKE_KIND_HDR, 0, 2, "#?" },
	{ BAKE_KIND_PSD, 0, 4, "8BPS" },
	{ BAKE_KIND_GIF, 0, 4, "GIF8" },
	{ BAKE_KIND_DPX, 0, 4, "SDPX" },
	{ BAKE_KIND_DPX, 0, 4, "XPDS" },
	{ BAKE_KIND_CINEON, 0, 4, "\x80\x2a\x5f\xd7" },
	{ BAKE_KIND_FITS, 0, 9, "SIMPLE  =" },
	{ BAKE_KIND_SGI, 0, 2, "\x01\xda" },
	{ BAKE_KIND_IFF, 0, 4, "FOR4" },
	{ BAKE_KIND_ICO, 0, 4, "\0\0\1\0" },
	{ BAKE_KIND_JPEG2000, 4, 4, "jP  " },
	{ BAKE_KIND_JPEG2000, 0, 4, "\xff\x4f\xff\x51" },
	{ BAKE_KIND_HEIF, 4, 4, "ftyp" },
	{ BAKE_KIND_PIC, 0, 4, "\x53\x80\xf6\x34" },
	{ BAKE_KIND_BMP, 0, 2, "BM" },
};

struct kind_name {
	enum bake_image_kind kind;
	const char *plugin;
	const char *extensions; /* space-separated, for kinds without a mark */
};

static const struct kind_name kinds[] = {
	{ BAKE_KIND_BMP, "bmp", "" },
	{ BAKE_KIND_CINEON, "cineon", "" },
	{ BAKE_KIND_DDS, "dds", "" },
	{ BAKE_KIND_DPX, "dpx", "" },
	{ BAKE_KIND_EXR, "openexr", "" },
	{ BAKE_KIND_FITS, "fits", "" },
	{ BAKE_KIND_GIF, "gif", "" },
	{ BAKE_KIND_HDR, "hdr", "" },
	{ BAKE_KIND_HEIF, "heif", "" },
	{ BAKE_KIND_ICO, "ico", "" },
	{ BAKE_KIND_IFF, "iff", "" },
	{ BAKE_KIND_JPEG, "jpeg", "" },
	{ BAKE_KIND_JPEG2000, "jpeg2000", "" },
	{ BAKE_KIND_PIC, "softimage", "" },
	{ BAKE_KIND_PNG, "png", "" },
	{ BAKE_KIND_PNM, "pnm", "" },
	{ BAKE_KIND_PSD, "psd", "" },
	{ BAKE_KIND_RLA, "rla", "rla" },
	{ BAKE_KIND_SGI, "sgi", "" },
	{ BAKE_KIND_TGA, "targa", "tga tpic vda icb vst" },
	{ BAKE_KIND_TIFF, "tiff", "" },
	{ BAKE_KIND_WEBP, "webp", "" },
};

static bool
is_pnm(const unsigned char *head, size_t n)
{
	return n >= 3 && head[0] == 'P' &&
	       memchr("123456Ff", head[1], 8) != NULL &&
	       memchr(" \t\r\n#", head[2], 5) != NULL;
}

static bool
has_extension(const char *extensions, const char *ext)
{
	size_t n = strlen(ext);

	while (*extensions != '\0') {
		size_t len = strcspn(extensions, " ");

		if (len == n && strncasecmp(extensions, ext, n) == 0)
			return true;
		extensions += len + (extensions[len] == ' ');
	}
	return false;
}

enum bake_image_kind
bake_image_kind_of(const unsigned char *head, size_t n, const char *name)
{
	const char *dot = strrchr(name, '.');

	for (size_t i = 0; i < sizeof marks / sizeof *marks; i++) {
		const struct mark *m = &marks[i];

		if (n >= m->offset + m->size &&
		    memcmp(head + m->offset, m->bytes, m->size) == 0)
			return m->kind;
	}
	if (is_pnm(head, n))
		return BAKE_KIND_PNM;
	for (size_t i = 0; dot != NULL && i < sizeof kinds / sizeof *kinds; i++)
		if (has_extension(kinds[i].extensions, dot + 1))
			return kinds[i].kind;
	return BAKE_KIND_UNKNOWN;
}

const char *
bake_image_kind_plugin(enum bake_image_kind kind)
{
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (kinds[i].kind == kind)
			return kinds[i].plugin;
	return NULL;
}

/* How many texels one byte of a file can stand for; 0 where no bound is known.
 * The least a texel takes before packing: a bit in PNG, PNM and PSD. */
static uint64_t
texels_per_byte(enum bake_image_kind kind)
{
	switch (kind) {
	case BAKE_KIND_PNG:
	case BAKE_KIND_PSD:
		return 8 * 1032;
	case BAKE_KIND_PNM:
		return 8;
	case BAKE_KIND_TGA:
	case BAKE_KIND_HDR:
	case BAKE_KIND_SGI:
		return 64;
	case BAKE_KIND_BMP:
		return 128;
	case BAKE_KIND_DDS:
		return 16;
	case BAKE_KIND_GIF:
	case BAKE_KIND_JPEG:
		return 4096;
	default:
		return 0;
	}
}

/* A gigabyte of floats from a file this much smaller is taken for a bomb. */
static const uint64_t bomb_bytes = (uint64_t)1 << 30;
static const uint64_t bomb_ratio = 8192;

enum bake_status
bake_image_claim_check(const struct bake_image_claim *claim,
    enum bake_image_kind kind, const struct bake_read_limits *limits,
    const char *name, struct bake_err *err)
{
	uint64_t texels, values, per_byte = texels_per_byte(kind);
	uint64_t file = claim->file_size;

	if (claim->width < 1 || claim->height < 1 || claim->nchans < 1)
		return bake_fail(err, BAKE_EDATA,
		    "%s: an image of %dx%d texels with %d channels holds "
		    "nothing",
		    name, claim->width, claim->height, claim->nchans);
	texels = (uint64_t)claim->width * (uint64_t)claim->height;
	if (texels > limits->max_texels)
		return bake_fail(err, BAKE_ELIMIT,
		    "%s: %dx%d is more than the limit of %zu texels", name,
		    claim->width, claim->height, limits->max_texels);
	if (__builtin_mul_overflow(texels, (uint64_t)claim->nchans, &values) ||
	    values / 4 > limits->max_texels)
		return bake_fail(err, BAKE_ELIMIT,
		    "%s: %d channels of %dx%d are more than the limit of %zu "
		    "texels",
		    name, claim->nchans, claim->width, claim->height,
		    limits->max_texels);
	if (per_byte != 0 && texels / per_byte > file)
		return bake_fail(err, BAKE_EDATA,
		    "%s: claims %dx%d texels, which its %zu bytes cannot hold",
		    name, claim->width, claim->height, claim->file_size);
	/* bytes are 4 times the values, which may be more than fit */
	if (!limits->trust_size && values > bomb_bytes / 4 &&
	    values / (bomb_ratio / 4) > file)
		return bake_fail(err, BAKE_ELIMIT,
		    "%s: claims %dx%d texels in %zu bytes, as a decompression "
		    "bomb does",
		    name, claim->width, claim->height, claim->file_size);
	return BAKE_OK;
}
