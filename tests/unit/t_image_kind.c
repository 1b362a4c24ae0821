/* Kinds of files: marks against names, and claims that cannot be true. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <stdint.h>

#include "check.h"
#include "image_kind.h"
#include "test_maps.h"

/* Marks as the formats' own specifications give them. */
static const struct {
	enum bake_image_kind kind;
	size_t n;
	const char *bytes;
} marks[] = {
	{ BAKE_KIND_PNG, 8, "\x89PNG\r\n\x1a\n" },
	{ BAKE_KIND_EXR, 4, "\x76\x2f\x31\x01" },
	{ BAKE_KIND_JPEG, 4, "\xff\xd8\xff\xe0" },
	{ BAKE_KIND_JPEG, 4, "\xff\xd8\xff\xe1" },
	{ BAKE_KIND_TIFF, 4, "II*\0" },
	{ BAKE_KIND_TIFF, 4, "MM\0*" },
	{ BAKE_KIND_TIFF, 8, "II+\0\x08\0\0\0" },
	{ BAKE_KIND_TIFF, 8, "MM\0+\0\x08\0\0" },
	{ BAKE_KIND_WEBP, 16, "RIFF\x24\0\0\0WEBPVP8L" },
	{ BAKE_KIND_DDS, 4, "DDS " },
	{ BAKE_KIND_HDR, 10, "#?RADIANCE" },
	{ BAKE_KIND_HDR, 6, "#?RGBE" },
	{ BAKE_KIND_PSD, 6, "8BPS\0\1" },
	{ BAKE_KIND_GIF, 6, "GIF87a" },
	{ BAKE_KIND_GIF, 6, "GIF89a" },
	{ BAKE_KIND_DPX, 4, "SDPX" },
	{ BAKE_KIND_DPX, 4, "XPDS" },
	{ BAKE_KIND_CINEON, 4, "\x80\x2a\x5f\xd7" },
	{ BAKE_KIND_FITS, 10, "SIMPLE  = " },
	{ BAKE_KIND_SGI, 2, "\x01\xda" },
	{ BAKE_KIND_IFF, 4, "FOR4" },
	{ BAKE_KIND_ICO, 6, "\0\0\1\0\1\0" },
	{ BAKE_KIND_JPEG2000, 12, "\0\0\0\x0cjP  \r\n\x87\n" },
	{ BAKE_KIND_JPEG2000, 4, "\xff\x4f\xff\x51" },
	{ BAKE_KIND_HEIF, 12,
	    "\0\0\0\x18"
	    "ftypheic" },
	{ BAKE_KIND_PIC, 4, "\x53\x80\xf6\x34" },
	{ BAKE_KIND_BMP, 2, "BM" },
	{ BAKE_KIND_PNM, 3, "P6\n" },
	{ BAKE_KIND_PNM, 3, "P1 " },
	{ BAKE_KIND_PNM, 3, "Pf\r" },
	{ BAKE_KIND_PNM, 3, "PF#" },
};
static const size_t nmarks = sizeof marks / sizeof *marks;

/* A copy on the heap of just n bytes: a sanitizer sees what lies beyond. */
static enum bake_image_kind
kind_of(const char *bytes, size_t n, const char *name)
{
	unsigned char *head = malloc(n + (n == 0));
	enum bake_image_kind kind;

	memcpy(head, bytes, n);
	kind = bake_image_kind_of(head, n, name);
	free(head);
	return kind;
}

static void
content_tells_the_kind(void)
{
	for (size_t i = 0; i < nmarks; i++) {
		enum bake_image_kind kind = marks[i].kind;

		CHECK(kind_of(marks[i].bytes, marks[i].n, "a") == kind);
		CHECK(kind_of(marks[i].bytes, marks[i].n, "a.tga") == kind);
		CHECK(kind_of(marks[i].bytes, marks[i].n, "a.rla") == kind);
		CHECK(kind_of(marks[i].bytes, marks[i].n, "a.txt") == kind);
	}
}

static void
name_tells_what_has_no_mark(void)
{
	static const struct {
		const char *name;
		enum bake_image_kind kind;
	} names[] = { { "a.tga", BAKE_KIND_TGA }, { "a.TGA", BAKE_KIND_TGA },
		{ "a.b.vda", BAKE_KIND_TGA }, { "a.icb", BAKE_KIND_TGA },
		{ "a.vst", BAKE_KIND_TGA }, { "a.tpic", BAKE_KIND_TGA },
		{ "a.rla", BAKE_KIND_RLA }, { "tga", BAKE_KIND_UNKNOWN },
		{ "", BAKE_KIND_UNKNOWN }, { "a.", BAKE_KIND_UNKNOWN },
		{ ".", BAKE_KIND_UNKNOWN }, { "a.tg", BAKE_KIND_UNKNOWN },
		{ "a.tgax", BAKE_KIND_UNKNOWN },
		{ "a.tga ", BAKE_KIND_UNKNOWN },
		{ "a.tga vda", BAKE_KIND_UNKNOWN },
		/* these have marks: without one, a name is no evidence */
		{ "a.png", BAKE_KIND_UNKNOWN }, { "a.exr", BAKE_KIND_UNKNOWN },
		{ "a.jpg", BAKE_KIND_UNKNOWN },
		{ "a.tga/b", BAKE_KIND_UNKNOWN } };

	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		const char *name = names[i].name;

		if (kind_of("0123456789abcdef", 16, name) != names[i].kind)
			printf("name '%s'\n", name);
		CHECK(kind_of("0123456789abcdef", 16, name) == names[i].kind);
		CHECK(kind_of("", 0, name) == names[i].kind);
	}
}

/* No mark is recognised, nor read beyond, before it is complete. */
static void
short_beginnings_are_safe(void)
{
	for (size_t i = 0; i < nmarks; i++)
		for (size_t n = 0; n < marks[i].n; n++) {
			enum bake_image_kind kind =
			    kind_of(marks[i].bytes, n, "a.txt");

			CHECK(
			    kind == BAKE_KIND_UNKNOWN || kind == marks[i].kind);
			CHECK(n >= 2 || kind == BAKE_KIND_UNKNOWN);
		}
	CHECK(kind_of("P7\n", 3, "a") == BAKE_KIND_UNKNOWN);
	CHECK(kind_of("P6x", 3, "a") == BAKE_KIND_UNKNOWN);
	CHECK(kind_of("P\0\n", 3, "a") == BAKE_KIND_UNKNOWN);
	CHECK(kind_of("P6\0", 3, "a") == BAKE_KIND_UNKNOWN);
}

static void
every_kind_has_its_plugin(void)
{
	CHECK(bake_image_kind_plugin(BAKE_KIND_UNKNOWN) == NULL);
	for (int k = BAKE_KIND_BMP; k <= BAKE_KIND_WEBP; k++)
		CHECK(bake_image_kind_plugin((enum bake_image_kind)k) != NULL);
	CHECK(strcmp(bake_image_kind_plugin(BAKE_KIND_TGA), "targa") == 0);
	CHECK(strcmp(bake_image_kind_plugin(BAKE_KIND_EXR), "openexr") == 0);
}

static enum bake_status
claim(int w, int h, int nchans, size_t file_size, enum bake_image_kind kind,
    const struct bake_read_limits *limits)
{
	struct bake_image_claim c = { w, h, nchans, file_size };
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_status rc =
	    bake_image_claim_check(&c, kind, limits, "some.file", &err);

	CHECK(err.code == rc);
	CHECK((rc == BAKE_OK) == (err.msg[0] == '\0'));
	CHECK(rc == BAKE_OK || strncmp(err.msg, "some.file: ", 11) == 0);
	return rc;
}

static void
nothing_is_an_error(void)
{
	const struct bake_read_limits d = BAKE_READ_LIMITS_DEFAULT;
	static const int sizes[][3] = { { 0, 1, 1 }, { 1, 0, 1 }, { 1, 1, 0 },
		{ -1, 1, 1 }, { 1, -1, 1 }, { 1, 1, -1 },
		{ INT_MIN, INT_MIN, 1 }, { -1000, -1000, 3 }, { 0, 0, 0 } };

	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
		CHECK(claim(sizes[i][0], sizes[i][1], sizes[i][2], 1000,
			  BAKE_KIND_TIFF, &d) == BAKE_EDATA);
	CHECK(claim(1, 1, 1, 1, BAKE_KIND_TIFF, &d) == BAKE_OK);
}

static void
limit_is_exact(void)
{
	struct bake_read_limits l = { 1000, false };

	CHECK(claim(100, 10, 1, 1000, BAKE_KIND_TIFF, &l) == BAKE_OK);
	CHECK(claim(10, 100, 4, 1000, BAKE_KIND_TIFF, &l) == BAKE_OK);
	CHECK(claim(1001, 1, 1, 5000, BAKE_KIND_TIFF, &l) == BAKE_ELIMIT);
	CHECK(claim(143, 7, 1, 5000, BAKE_KIND_TIFF, &l) == BAKE_ELIMIT);
	/* four times as many values */
	CHECK(claim(40, 1, 100, 5000, BAKE_KIND_TIFF, &l) == BAKE_OK);
	CHECK(claim(41, 1, 100, 5000, BAKE_KIND_TIFF, &l) == BAKE_ELIMIT);
	l.trust_size = true; /* of the file, not beyond the limit */
	CHECK(claim(1001, 1, 1, 5000, BAKE_KIND_TIFF, &l) == BAKE_ELIMIT);
	CHECK(claim(41, 1, 100, 5000, BAKE_KIND_TIFF, &l) == BAKE_ELIMIT);
}

/* Files that real encoders can make, at the edge of what their format packs:
 * they must pass; a hundred times more must not. */
static void
claims_must_be_possible(void)
{
	static const struct {
		enum bake_image_kind kind;
		size_t file;
		double texels; /* that so many bytes can hold */
	} most[] = {
		{ BAKE_KIND_PNG, 10000,
		    10000.0 * 1030 * 8 },            /* 1 bit, deflated */
		{ BAKE_KIND_PNM, 10000, 9990 * 8 },  /* P4 */
		{ BAKE_KIND_TGA, 10000, 9900 * 64 }, /* 128 texels in 2 bytes */
		{ BAKE_KIND_SGI, 10000, 9000 / 2 * 127 }, /* 127 samples in 2 */
		{ BAKE_KIND_HDR, 10000, 9900 / 8 * 127 }, /* 127 in 4 * 2 */
		{ BAKE_KIND_BMP, 10000, 9000 / 2 * 255 }, /* 255 in 2 */
		{ BAKE_KIND_DDS, 10000, 9800 * 2 },       /* BC1: 16 in 8 */
		{ BAKE_KIND_JPEG, 10000,
		    9000 * 4 * 64 }, /* 2 bits an 8x8 block */
	};
	const struct bake_read_limits d = BAKE_READ_LIMITS_DEFAULT;
	const struct bake_read_limits trusting = { (size_t)1 << 30, true };

	for (size_t i = 0; i < sizeof most / sizeof *most; i++) {
		int side = (int)sqrt(most[i].texels);
		int w = side * 10, h = side * 10;

		CHECK(claim(side, side, 1, most[i].file, most[i].kind, &d) ==
		      BAKE_OK);
		if ((double)w * h > 1e9)
			h = (int)(1e9 / w);
		if (most[i].kind == BAKE_KIND_JPEG)
			w *= 4; /* its bound is the loosest */
		CHECK(claim(w, h, 1, most[i].file / 10, most[i].kind, &d) ==
		      BAKE_EDATA);
		CHECK(claim(w, h, 1, most[i].file / 10, most[i].kind,
			  &trusting) == BAKE_EDATA);
	}
}

/* Where no bound is known, a gigabyte of floats from next to nothing is a bomb,
 * unless the caller says that it is none. */
static void
bombs_are_refused(void)
{
	struct bake_read_limits l = BAKE_READ_LIMITS_DEFAULT;

	CHECK(claim(16384, 16384, 1, 20000, BAKE_KIND_TIFF, &l) == BAKE_OK);
	CHECK(claim(16384, 16384, 2, 20000, BAKE_KIND_TIFF, &l) == BAKE_ELIMIT);
	CHECK(claim(32000, 32000, 1, 1000, BAKE_KIND_EXR, &l) == BAKE_ELIMIT);
	CHECK(claim(32000, 32000, 1, 1 << 20, BAKE_KIND_EXR, &l) == BAKE_OK);
	l.trust_size = true;
	CHECK(claim(32000, 32000, 1, 1000, BAKE_KIND_EXR, &l) == BAKE_OK);
}

/* With a limit as large as it can be no sum may run over. */
static void
sizes_do_not_run_over(void)
{
	struct bake_read_limits l = { SIZE_MAX, false };
	static const int at[] = { 1 << 16, 1 << 29, 1 << 30, INT_MAX - 1,
		INT_MAX };

	for (size_t i = 0; i < 5 * 5 * 5; i++) {
		int w = at[i % 5], h = at[i / 5 % 5], nc = at[i / 25];

		CHECK(claim(w, h, nc, 1000, BAKE_KIND_TIFF, &l) == BAKE_ELIMIT);
		CHECK(claim(w, h, 1, 1000, BAKE_KIND_TIFF, &l) == BAKE_ELIMIT);
		CHECK(claim(w, h, 4, 1000, BAKE_KIND_TIFF, &l) == BAKE_ELIMIT);
		CHECK(claim(w, h, nc, 1000, BAKE_KIND_PNG, &l) != BAKE_OK);
	}
}

static void
types_hold_their_formats(void)
{
	/* INTERFACE: PNG uint8 uint16, TGA uint8, TIFF all but half, EXR half
	 * and float */
	static const bool holds[4][4] = { { true, true, false, false },
		{ true, false, false, false }, { true, true, false, true },
		{ false, false, true, true } };
	/* itself, else the next deeper one, else the deepest; 16-bit codes do
	 * not fit into EXR's half */
	static const int nearest[4][4] = { { BAKE_DATA_UINT8, BAKE_DATA_UINT16,
					       BAKE_DATA_UINT16,
					       BAKE_DATA_UINT16 },
		{ BAKE_DATA_UINT8, BAKE_DATA_UINT8, BAKE_DATA_UINT8,
		    BAKE_DATA_UINT8 },
		{ BAKE_DATA_UINT8, BAKE_DATA_UINT16, BAKE_DATA_FLOAT,
		    BAKE_DATA_FLOAT },
		{ BAKE_DATA_HALF, BAKE_DATA_FLOAT, BAKE_DATA_HALF,
		    BAKE_DATA_FLOAT } };
	static const enum bake_file_type types[] = { BAKE_FILE_PNG,
		BAKE_FILE_TGA, BAKE_FILE_TIFF, BAKE_FILE_EXR };

	for (int t = 0; t < 4; t++)
		for (int f = 0; f < 4; f++) {
			enum bake_data_format format = (enum bake_data_format)f;

			CHECK(bake_file_type_holds(types[t], format) ==
			      holds[t][f]);
			CHECK((int)bake_file_type_nearest(types[t], format) ==
			      nearest[t][f]);
		}
}

static void
types_have_names(void)
{
	static const struct {
		const char *path;
		int type; /* -1: none */
	} paths[] = { { "a.png", BAKE_FILE_PNG }, { "a.PnG", BAKE_FILE_PNG },
		{ "dir.tga/a.exr", BAKE_FILE_EXR }, { "a.tif", BAKE_FILE_TIFF },
		{ "a.tiff", BAKE_FILE_TIFF }, { "../x/a.b.tga", BAKE_FILE_TGA },
		{ "a", -1 }, { "png", -1 }, { "dir.png/a", -1 }, { "", -1 },
		{ ".", -1 }, { "a.", -1 }, { "a.jpg", -1 }, { "a.png ", -1 },
		{ "a.png/", -1 }, { "a.pn", -1 }, { "-", -1 } };
	static const char *const names[] = { "png", "tga", "tiff", "exr" };
	enum bake_file_type type;

	for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
		bool known = bake_file_type_from_path(paths[i].path, &type);

		CHECK(known == (paths[i].type >= 0));
		CHECK(!known || (int)type == paths[i].type);
	}
	for (int t = 0; t < 4; t++) {
		CHECK(strcmp(bake_file_type_name((enum bake_file_type)t),
			  names[t]) == 0);
		CHECK(bake_file_type_from_name(names[t], &type) &&
		      (int)type == t);
	}
	CHECK(bake_file_type_from_name("TIF", &type) && type == BAKE_FILE_TIFF);
	CHECK(!bake_file_type_from_name(".png", &type));
	CHECK(!bake_file_type_from_name("", &type));
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(content_tells_the_kind),
		CASE(name_tells_what_has_no_mark),
		CASE(short_beginnings_are_safe),
		CASE(every_kind_has_its_plugin),
		CASE(nothing_is_an_error),
		CASE(limit_is_exact),
		CASE(claims_must_be_possible),
		CASE(bombs_are_refused),
		CASE(sizes_do_not_run_over),
		CASE(types_hold_their_formats),
		CASE(types_have_names),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
