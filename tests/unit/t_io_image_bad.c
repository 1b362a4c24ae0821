/* Image files that cannot be written, and bad ones that are refused by name. */
/* SPDX-License-Identifier: MIT */
#include <fcntl.h>
#include <limits.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "test_files.h"

/* What libpng and libtiff say on standard error is not ours to check, while it
 * is quiet: returns the descriptor for loud(). */
static int
quiet(void)
{
	int saved = dup(STDERR_FILENO), fd = open("/dev/null", O_WRONLY);

	fflush(stderr);
	if (fd >= 0) {
		dup2(fd, STDERR_FILENO);
		close(fd);
	}
	return saved;
}

static void
loud(int saved)
{
	fflush(stderr);
	if (saved >= 0) {
		dup2(saved, STDERR_FILENO);
		close(saved);
	}
}

static void
what_a_type_does_not_hold_is_refused(void)
{
	struct bake_image five = any_image(2, 2, 5, BAKE_DATA_UINT8);
	struct bake_image one = any_image(2, 2, 1, BAKE_DATA_UINT8);

	for (int t = 0; t < 4; t++)
		for (int f = 0; f < 4; f++) {
			struct bake_write_params p = params_of(0);
			struct bake_err err = BAKE_ERR_INIT;
			FILE *stream = tmpfile();
			bool holds;

			p.type = (enum bake_file_type)t;
			p.data_format = (enum bake_data_format)f;
			holds = bake_file_type_holds(p.type, p.data_format);
			CHECK(bake_image_write(&one, &p, stream, "a.x", NULL,
				  &err) == (holds ? BAKE_OK : BAKE_EINVAL));
			CHECK(holds || strncmp(err.msg, "a.x: ", 5) == 0);
			CHECK(holds || ftell(stream) == 0);
			err = (struct bake_err)BAKE_ERR_INIT;
			holds =
			    holds && t != BAKE_FILE_PNG && t != BAKE_FILE_TGA;
			CHECK(bake_image_write(&five, &p, stream, "a.x", NULL,
				  &err) == (holds ? BAKE_OK : BAKE_EINVAL));
			fclose(stream);
		}
	bake_image_free(&five);
	bake_image_free(&one);
}

/* Small enough to stay in the stream's buffer until the end, and far larger. */
static void
full_device_is_an_error(void)
{
	static const char *const paths[] = { "/dev/full", "/dev/null" };

	for (int k = 0; k < NKINDS * 4; k++) {
		int kind = k / 4, side = k % 2 == 0 ? 3 : 300;
		const char *path = paths[k / 2 % 2];
		struct bake_write_params params = params_of(kind);
		struct bake_image img =
		    any_image(side, side, 3, kinds[kind].format);
		struct bake_err err = BAKE_ERR_INIT;
		/* the second path, opened for reading, takes nothing either */
		FILE *f = fopen(path, k / 2 % 2 == 0 ? "wb" : "rb");

		if (f != NULL) {
			enum bake_status rc = bake_image_write(
			    &img, &params, f, "o.x", NULL, &err);

			if (rc != BAKE_EIO)
				printf("%s to %s, side %d\n",
				    kinds[kind].container, path, side);
			CHECK(rc == BAKE_EIO);
			CHECK(strncmp(err.msg, "o.x: ", 5) == 0);
			fclose(f);
		}
		bake_image_free(&img);
	}
}

/* Every seventh cut of a file of every kind, and all the last ones. 35 rows are
 * several blocks in TIFF and EXR. */
static void
cut_files_are_refused_or_whole(void)
{
	int saved = quiet();

	for (int kind = 0; kind < NKINDS; kind++) {
		struct bake_write_params params = params_of(kind);
		struct bake_image img = any_image(5, 35, 2, kinds[kind].format);
		struct bytes b;

		bake_attrs_set(&params.attrs, "Layout", "relief");
		b = encode(&img, &params);
		for (size_t n = 0; n < b.n; n += n + 8 < b.n ? 7 : 1) {
			struct bytes cut = { malloc(n + (n == 0)), n };
			struct bake_image back;
			struct bake_image_info info;
			struct bake_err err = BAKE_ERR_INIT;
			enum bake_status rc;

			memcpy(cut.p, b.p, n);
			rc = decode(&cut, kinds[kind].name, &info, &back, &err);
			if (rc == BAKE_OK && !same_texels(&img, &back))
				printf("%s %s cut to %zu of %zu reads\n",
				    kinds[kind].container,
				    bake_data_format_name(kinds[kind].format),
				    n, b.n);
			CHECK(rc == BAKE_OK ? same_texels(&img, &back)
					    : strncmp(err.msg, "mem.", 4) == 0);
			CHECK(rc == BAKE_OK || rc == BAKE_EDATA ||
			      rc == BAKE_ELIMIT);
			bake_image_free(&back);
			free(cut.p);
		}
		bake_image_free(&img);
		free(b.p);
	}
	loud(saved);
}

static void
put_bytes(struct bytes *b, const void *p, size_t n)
{
	b->p = realloc(b->p, b->n + n + 1);
	memcpy(b->p + b->n, p, n);
	b->n += n;
}

static void
put_u32(struct bytes *b, uint32_t v)
{
	const unsigned char p[4] = { (unsigned char)(v >> 24),
		(unsigned char)(v >> 16), (unsigned char)(v >> 8),
		(unsigned char)v };

	put_bytes(b, p, 4);
}

/* The checksum of PNG (ISO 15948, annex D), bit by bit. */
static uint32_t
crc32_of(const unsigned char *p, size_t n)
{
	uint32_t crc = 0xffffffff;

	for (size_t i = 0; i < n; i++) {
		crc ^= p[i];
		for (int k = 0; k < 8; k++)
			crc = crc & 1 ? crc >> 1 ^ 0xedb88320 : crc >> 1;
	}
	return ~crc;
}

static void
put_chunk(struct bytes *b, const char *type, const struct bytes *data)
{
	size_t at = b->n + 4;

	put_u32(b, (uint32_t)data->n);
	put_bytes(b, type, 4);
	put_bytes(b, data->p != NULL ? data->p : (const void *)"", data->n);
	put_u32(b, crc32_of(b->p + at, b->n - at));
}

/* A PNG whose filtered rows are `rows`, not compressed (one stored block). */
static struct bytes
make_png(uint32_t w, uint32_t h, int bits, int color, const unsigned char *rows,
    size_t n)
{
	struct bytes b = { NULL, 0 }, ihdr = { NULL, 0 }, idat = { NULL, 0 };
	const struct bytes iend = { NULL, 0 };
	const unsigned char tail[5] = { (unsigned char)bits,
		(unsigned char)color, 0, 0, 0 };
	const unsigned char head[7] = { 0x78, 1, 1, (unsigned char)n,
		(unsigned char)(n >> 8), (unsigned char)~n,
		(unsigned char)(~n >> 8) };
	uint32_t s1 = 1, s2 = 0;

	for (size_t i = 0; i < n; i++) {
		s1 = (s1 + rows[i]) % 65521;
		s2 = (s2 + s1) % 65521;
	}
	put_u32(&ihdr, w);
	put_u32(&ihdr, h);
	put_bytes(&ihdr, tail, 5);
	put_bytes(&idat, head, 7);
	put_bytes(&idat, rows, n);
	put_u32(&idat, s2 << 16 | s1);
	put_bytes(&b, "\x89PNG\r\n\x1a\n", 8);
	put_chunk(&b, "IHDR", &ihdr);
	put_chunk(&b, "IDAT", &idat);
	put_chunk(&b, "IEND", &iend);
	free(ihdr.p);
	free(idat.p);
	return b;
}

/* Uncompressed TGA, 8 bits a channel, of any size it may claim. */
static struct bytes
make_tga(int w, int h, int nchans, bool from_top, const void *texels, size_t n)
{
	struct bytes b = { NULL, 0 };
	unsigned char head[18] = { 0 };

	head[2] = nchans == 1 ? 3 : 2;
	head[12] = (unsigned char)w;
	head[13] = (unsigned char)(w >> 8);
	head[14] = (unsigned char)h;
	head[15] = (unsigned char)(h >> 8);
	head[16] = (unsigned char)(8 * nchans);
	head[17] =
	    (unsigned char)((from_top ? 0x20 : 0) | (nchans == 4 ? 8 : 0));
	put_bytes(&b, head, 18);
	put_bytes(&b, texels, n);
	return b;
}

static void
check_codes(struct bytes b, const char *name, int w, int h, int nc, int max,
    const int *want)
{
	struct bake_image img;
	struct bake_image_info info;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(decode(&b, name, &info, &img, &err), err);
	CHECK(img.width == w && img.height == h && img.nchans == nc);
	for (int i = 0; img.data != NULL && i < w * h * nc; i++)
		CHECK(img.data[i] == (float)want[i] / (float)max);
	bake_image_free(&img);
	free(b.p);
}

/* Files made here, byte by byte, from the formats' definitions: the reader is
 * not only the writer's inverse. Row 0 is the top, and A = 0 hides nothing. */
static void
files_of_known_bytes(void)
{
	static const unsigned char rgba[] = { 0, 200, 100, 50, 0, 1, 2, 3, 255,
		0, 7, 8, 9, 128, 0, 255, 254, 0 };
	static const int rgba_want[] = { 200, 100, 50, 0, 1, 2, 3, 255, 7, 8, 9,
		128, 0, 255, 254, 0 };
	static const unsigned char grey16[] = { 0, 0x12, 0x34, 0xff, 0xfe, 0,
		0x80, 0x00, 0x00, 0x01 };
	static const int grey16_want[] = { 0x1234, 0xfffe, 0x8000, 1 };
	static const int pgm_want[] = { 0x1234, 0x7ffe, 0x8000, 1 };
	static const unsigned char bgra[] = { 50, 100, 200, 0, 3, 2, 1, 255, 9,
		8, 7, 128, 254, 255, 0, 0 };
	static const int upside_down[] = { 7, 8, 9, 128, 0, 255, 254, 0, 200,
		100, 50, 0, 1, 2, 3, 255 };
	static const unsigned char grey[] = { 1, 2, 3, 4 };
	static const int grey_want[] = { 1, 2, 3, 4 };
	struct bytes pgm = { NULL, 0 };

	check_codes(make_png(2, 2, 8, 6, rgba, sizeof rgba), "a.png", 2, 2, 4,
	    255, rgba_want);
	check_codes(make_png(2, 2, 16, 0, grey16, sizeof grey16), "a.png", 2, 2,
	    1, 65535, grey16_want);
	check_codes(make_tga(2, 2, 4, true, bgra, sizeof bgra), "a.tga", 2, 2,
	    4, 255, rgba_want);
	check_codes(make_tga(2, 2, 4, false, bgra, sizeof bgra), "a.tga", 2, 2,
	    4, 255, upside_down);
	check_codes(make_tga(2, 2, 1, true, grey, sizeof grey), "a.tga", 2, 2,
	    1, 255, grey_want);
	/* OpenImageIO 2.4 takes 1 from 16-bit PNM codes above 0x8000: an
	 * integer runs over inside it */
	put_bytes(&pgm, "P5\n2 2\n65535\n\x12\x34\x7f\xfe\x80\x00\x00\x01", 21);
	check_codes(pgm, "a", 2, 2, 1, 65535, pgm_want);
}

/* The status of opening, which must come without an allocation of the claimed
 * size: memory is limited to 200 MB more than there is now (not below a
 * sanitizer, which reserves terabytes: there the resident set must not grow
 * by that much). */
static int
open_with_little_memory(const struct bytes *b, const char *name)
{
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	struct rusage before, after;
	struct bake_image_info info;
	struct bake_reader *r;
	struct bake_err err = BAKE_ERR_INIT;
	int status;
	pid_t pid;

	fflush(NULL);
	pid = fork();
	if (pid == 0) {
		enum bake_status rc;
		long npages = 0;
		FILE *f = fopen("/proc/self/statm", "r");

		if (f != NULL && fscanf(f, "%ld", &npages) == 1 &&
		    npages < 1 << 22) {
			rlim_t most = (rlim_t)npages * 4096 + 200000000;
			const struct rlimit limit = { most, most };

			setrlimit(RLIMIT_AS, &limit);
		}
		getrusage(RUSAGE_SELF, &before);
		rc = bake_reader_open_memory(
		    &r, b->p, b->n, name, &limits, &info, &err);
		getrusage(RUSAGE_SELF, &after);
		if (r != NULL || strncmp(err.msg, name, strlen(name)) != 0 ||
		    after.ru_maxrss - before.ru_maxrss > 200000)
			_exit(100);
		_exit((int)rc);
	}
	if (pid < 0 || waitpid(pid, &status, 0) != pid || !WIFEXITED(status))
		return -1;
	return WEXITSTATUS(status);
}

static void
bombs_are_refused_unopened(void)
{
	static const unsigned char little[100] = { 0 };
	struct {
		const char *name;
		struct bytes b;
	} bombs[] = {
		{ "a.png", make_png(60000, 60000, 16, 6, little, 100) },
		{ "b.png", make_png(INT_MAX, INT_MAX, 8, 6, little, 100) },
		{ "c.png", make_png(1, INT_MAX, 8, 0, little, 100) },
		{ "d.png", make_png(30000, 30000, 1, 0, little, 100) },
		{ "e.png", make_png(0, 0, 8, 0, little, 100) },
		{ "f.png",
		    make_png(0xffffffff, 0xffffffff, 8, 6, little, 100) },
		{ "a.tga", make_tga(65535, 65535, 4, true, little, 100) },
		{ "b.tga", make_tga(30000, 30000, 4, true, little, 100) },
		{ "c.tga", make_tga(0, 0, 4, true, little, 100) },
		{ "a.ppm", { NULL, 0 } },
		{ "b.ppm", { NULL, 0 } },
		{ "a.bmp", { NULL, 0 } },
		{ "runs.bmp", { NULL, 0 } }, /* decoded by open() */
		{ "a.hdr", { NULL, 0 } },
	};
	unsigned char bmp[100] = "BM";
	const int n = sizeof bombs / sizeof *bombs, saved = quiet();

	put_bytes(&bombs[n - 5].b, "P6 50000 50000 255\n", 19);
	put_bytes(&bombs[n - 4].b, "P6 2147483647 2147483647 255\n", 29);
	bmp[2] = 100; /* file size; then where the texels are, header size */
	bmp[10] = 54;
	bmp[14] = 40;
	memcpy(bmp + 18, "\x50\xc3\0\0\x50\xc3\0\0\x01\0\x18\0", 12);
	put_bytes(&bombs[n - 3].b, bmp, sizeof bmp);
	memcpy(bmp + 18, "\x20\x4e\0\0\x20\x4e\0\0\x01\0\x08\0\x01", 13);
	bmp[10] = 70; /* after four colours */
	bmp[46] = bmp[50] = 4;
	put_bytes(&bombs[n - 2].b, bmp, sizeof bmp);
	put_bytes(&bombs[n - 1].b,
	    "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 50000 +X 50000\n", 53);
	for (int i = 0; i < n; i++) {
		int rc = open_with_little_memory(&bombs[i].b, bombs[i].name);

		if (rc != BAKE_EDATA && rc != BAKE_ELIMIT)
			printf("%s: status %d\n", bombs[i].name, rc);
		CHECK(rc == BAKE_EDATA || rc == BAKE_ELIMIT);
		free(bombs[i].b.p);
	}
	loud(saved);
}

static void
limits_are_exact(void)
{
	for (int kind = 0; kind < NKINDS; kind++) {
		struct bake_write_params params = params_of(kind);
		struct bake_image img =
		    any_image(20, 10, 4, kinds[kind].format);
		struct bytes b = encode(&img, &params);

		for (int over = 0; over < 2; over++) {
			struct bake_read_limits limits = { 200 - (size_t)over,
				false };
			struct bake_image_info info;
			struct bake_reader *r;
			struct bake_err err = BAKE_ERR_INIT;

			CHECK(bake_reader_open_memory(&r, b.p, b.n,
				  kinds[kind].name, &limits, &info,
				  &err) == (over ? BAKE_ELIMIT : BAKE_OK));
			CHECK((r == NULL) == (over == 1));
			CHECK(!over || (strstr(err.msg, "20x10") != NULL &&
					   strstr(err.msg, "199") != NULL));
			bake_reader_close(r);
		}
		bake_image_free(&img);
		free(b.p);
	}
}

static void
what_is_no_image_is_named(void)
{
	static const struct {
		const char *name, *text;
	} files[] = { { "empty.png", "" }, { "empty.tga", "" },
		{ "a.txt", "hello" }, { "a.png", "hello, I am no PNG at all" },
		{ "x", "\x89PNG" }, { "a.tga", "hello" },
		{ "a.exr", "\x76\x2f\x31\x01" }, { "a.tif", "II*" },
		{ "noext", "0123456789abcdef0123456789" } };

	int saved = quiet();

	for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
		size_t n = strlen(files[i].text);
		struct bytes b = { malloc(n + 1), n };
		struct bake_image img;
		struct bake_image_info info;
		struct bake_err err = BAKE_ERR_INIT;

		memcpy(b.p, files[i].text, n);
		CHECK(
		    decode(&b, files[i].name, &info, &img, &err) == BAKE_EDATA);
		CHECK(strncmp(err.msg, files[i].name, strlen(files[i].name)) ==
		      0);
		CHECK(strchr(err.msg, '\n') == NULL);
		free(b.p);
	}
	loud(saved);
}

/* By path: the same texels as from memory, from standard input too; and what
 * the system refuses. */
static void
files_are_read_by_path(void)
{
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	static const char *const bad[] = { "no/such.png", "", "/tmp" };
	char path[] = "/tmp/t_io_image_bad.XXXXXX";
	int fd = mkstemp(path), in = dup(STDIN_FILENO);

	for (int kind = 0; fd >= 0 && kind < 2 * NKINDS; kind++) {
		struct bake_write_params params = params_of(kind / 2);
		struct bake_image img =
		    any_image(9, 70, 3, kinds[kind / 2].format);
		struct bake_image back = BAKE_IMAGE_INIT;
		struct bake_image_info info;
		struct bake_reader *r;
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes b = encode(&img, &params);
		const char *name = kind % 2 == 0 ? path : "-";

		/* TGA is known by its name alone */
		if (params.type != BAKE_FILE_TGA) {
			CHECK(ftruncate(fd, 0) == 0);
			CHECK(pwrite(fd, b.p, b.n, 0) == (ssize_t)b.n);
			lseek(fd, 0, SEEK_SET);
			if (kind % 2 != 0) {
				dup2(fd, STDIN_FILENO);
				clearerr(stdin);
			}
			CHECK_OK(
			    bake_reader_open(&r, name, &limits, &info, &err),
			    err);
			CHECK(r != NULL && bake_reader_read(r, 0, 3, &back,
					       &err) == BAKE_OK);
			CHECK(back.data != NULL && same_texels(&img, &back));
			bake_reader_close(r);
		}
		bake_image_free(&img);
		bake_image_free(&back);
		free(b.p);
	}
	dup2(in, STDIN_FILENO);
	close(in);
	close(fd);
	remove(path);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct bake_image_info info;
		struct bake_reader *r;
		struct bake_err err = BAKE_ERR_INIT;

		CHECK(bake_reader_open(&r, bad[i], &limits, &info, &err) ==
		      BAKE_EIO);
		CHECK(r == NULL);
		CHECK(strncmp(err.msg, bad[i], strlen(bad[i])) == 0);
	}
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(what_a_type_does_not_hold_is_refused),
		CASE(full_device_is_an_error),
		CASE(cut_files_are_refused_or_whole),
		CASE(files_of_known_bytes),
		CASE(bombs_are_refused_unopened),
		CASE(limits_are_exact),
		CASE(what_is_no_image_is_named),
		CASE(files_are_read_by_path),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
