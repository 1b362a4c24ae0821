/* Digests, and the records of outputs: sealed, found again, and not when any
 * byte of the file is another. */
/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <unistd.h>

#include "check.h"
#include "digest.h"
#include "record.h"

/* A file of the test's own; gone at its end. */
static char path[64];

static void
write_file(const void *bytes, size_t n)
{
	FILE *fp;

	snprintf(path, sizeof path, "/tmp/t_digest.%ld", (long)getpid());
	fp = fopen(path, "wb");
	CHECK(fp != NULL && fwrite(bytes, 1, n, fp) == n);
	CHECK(fp != NULL && fclose(fp) == 0);
}

static size_t
read_file(char *bytes, size_t room)
{
	FILE *fp = fopen(path, "rb");
	size_t n = fp != NULL ? fread(bytes, 1, room, fp) : 0;

	CHECK(fp != NULL && fclose(fp) == 0);
	return n;
}

static bool
same(const struct bake_digest *a, const struct bake_digest *b)
{
	return memcmp(a->byte, b->byte, sizeof a->byte) == 0;
}

/* The value that xxHash's own tests have for no bytes (XXH128, seed 0). */
static void
digest_of_nothing_is_the_published_one(void)
{
	static const unsigned char want[] = { 0x99, 0xaa, 0x06, 0xd3, 0x01,
		0x47, 0x98, 0xd8, 0x60, 0x01, 0xc3, 0x24, 0x46, 0x8d, 0x49,
		0x7f };
	struct bake_digest d = bake_digest_of("", 0);

	CHECK(memcmp(d.byte, want, sizeof want) == 0);
}

static void
text_is_six_bits_a_character(void)
{
	/* RFC 4648: 0 is 'A'; 0xff ... is '_' and its last two bits 'w' */
	struct bake_digest d = { { 0 } };
	char text[BAKE_DIGEST_TEXT];

	bake_digest_text(&d, text);
	CHECK(strcmp(text, "AAAAAAAAAAAAAAAAAAAAAA") == 0);
	memset(d.byte, 0xff, sizeof d.byte);
	bake_digest_text(&d, text);
	CHECK(strcmp(text, "_____________________w") == 0);
	/* 'Man' is TWFu, the usual example */
	memset(d.byte, 0, sizeof d.byte);
	memcpy(d.byte, "Man", 3);
	bake_digest_text(&d, text);
	CHECK(strcmp(text, "TWFuAAAAAAAAAAAAAAAAAA") == 0);
}

static void
pieces_and_files_have_the_digest_of_the_whole(void)
{
	static unsigned char bytes[600000];
	struct bake_digest whole, pieces, file;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_digester *d;

	for (size_t i = 0; i < sizeof bytes; i++)
		bytes[i] = (unsigned char)(i * 2654435761U >> 13);
	whole = bake_digest_of(bytes, sizeof bytes);
	for (size_t step = 1; step < sizeof bytes; step = step * 7 + 3) {
		CHECK_OK(bake_digester_open(&d, &err), err);
		for (size_t i = 0; i < sizeof bytes; i += step)
			bake_digester_add(d, bytes + i,
			    sizeof bytes - i < step ? sizeof bytes - i : step);
		pieces = bake_digester_end(d);
		CHECK(same(&whole, &pieces));
	}
	write_file(bytes, sizeof bytes);
	CHECK_OK(bake_digest_file(path, &file, &err), err);
	CHECK(same(&whole, &file));
	bytes[300000] ^= 1;
	pieces = bake_digest_of(bytes, sizeof bytes);
	CHECK(!same(&whole, &pieces));
	unlink(path);
}

static void
what_is_no_file_has_no_digest(void)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_record record;
	struct bake_digest d;

	CHECK(bake_digest_file("/nonexistent", &d, &err) == BAKE_EIO);
	CHECK(strstr(err.msg, "/nonexistent") != NULL);
	CHECK(bake_digest_file("/tmp", &d, &err) == BAKE_EIO);
	CHECK(bake_digest_file("/dev/null", &d, &err) == BAKE_EIO);
	CHECK(bake_record_read("/nonexistent", &record, &err) == BAKE_EIO);
	CHECK(bake_record_read("/tmp", &record, &err) == BAKE_EIO);
}

/* `before` bytes, the text of a record, and `after` bytes, sealed. */
static void
make_sealed(
    size_t before, size_t after, const char *list, char text[BAKE_RECORD_TEXT])
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_digest d = bake_digest_of("recipe", 6);
	FILE *fp;

	write_file("", 0);
	fp = fopen(path, "w+b");
	if (fp == NULL)
		return;
	bake_record_text(&d, text);
	for (size_t i = 0; i < before; i++)
		putc((int)(i * 7 & 255), fp);
	fprintf(fp, "%s;%s", text, list);
	for (size_t i = 0; i < after; i++)
		putc((int)(i * 11 & 255), fp);
	CHECK_OK(bake_record_seal(fp, text, &err), err);
	CHECK(fclose(fp) == 0);
}

static void
a_record_is_found_wherever_it_stands(void)
{
	/* pieces are 2^18 bytes: across the end of each, too */
	static const size_t before[] = { 0, 1, 1000, (1 << 18) - 1,
		(1 << 18) - 20, (1 << 18) + 3, (1 << 19) - 30, 900000 };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_record r;
	char text[BAKE_RECORD_TEXT], digest[BAKE_DIGEST_TEXT];
	struct bake_digest d = bake_digest_of("recipe", 6);

	bake_digest_text(&d, digest);
	for (size_t i = 0; i < sizeof before / sizeof *before; i++) {
		make_sealed(before[i], before[i] % 1000,
		    "files:|0/a.mtl|1+_x%20y.png|!", text);
		CHECK_OK(bake_record_read(path, &r, &err), err);
		CHECK(strcmp(r.digest, digest) == 0);
		CHECK(r.whole);
		CHECK(strcmp(r.list, "files:|0/a.mtl|1+_x%20y.png|!") == 0);
	}
	unlink(path);
}

static void
no_byte_can_change(void)
{
	struct bake_err err = BAKE_ERR_INIT;
	char text[BAKE_RECORD_TEXT], bytes[1024], digest[BAKE_DIGEST_TEXT];
	struct bake_digest d = bake_digest_of("recipe", 6);
	struct bake_record r;
	size_t n;

	bake_digest_text(&d, digest);
	make_sealed(100, 100, "files:|0/a|!", text);
	n = read_file(bytes, sizeof bytes);
	CHECK(n == 100 + BAKE_RECORD_TEXT + 12 + 100);
	for (size_t i = 0; i < n; i++) {
		bytes[i] ^= 4;
		write_file(bytes, n);
		CHECK_OK(bake_record_read(path, &r, &err), err);
		CHECK(!r.whole || strcmp(r.digest, digest) != 0);
		bytes[i] ^= 4;
	}
	for (size_t cut = 0; cut < n; cut++) {
		write_file(bytes, cut);
		CHECK_OK(bake_record_read(path, &r, &err), err);
		CHECK(!r.whole);
	}
	bytes[n] = 0;
	write_file(bytes, n + 1);
	CHECK_OK(bake_record_read(path, &r, &err), err);
	CHECK(!r.whole);
	unlink(path);
}

static void
what_looks_like_a_record_is_none(void)
{
	static const char *const texts[] = { "",
		"rm1:", "rm1:rm1:rm1:", "rm1:AAAAAAAAAAAAAAAAAAAAAA:AAAAAAAAAA",
		"rm1:AAAAAAAAAAAAAAAAAAAAA!:AAAAAAAAAAA",
		"rm1:AAAAAAAAAAAAAAAAAAAAAA AAAAAAAAAAA", "files:|",
		"files:|a|", "files:|a b|!", "files:|a!" };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_record r;

	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		write_file(texts[i], strlen(texts[i]));
		CHECK_OK(bake_record_read(path, &r, &err), err);
		CHECK(r.digest[0] == '\0' && r.list[0] == '\0' && !r.whole);
	}
	/* one that is whole comes after one that is not */
	write_file("rm1:rm1:AAAAAAAAAAAAAAAAAAAAAA:BBBBBBBBBBB", 42);
	CHECK_OK(bake_record_read(path, &r, &err), err);
	CHECK(strcmp(r.digest, "AAAAAAAAAAAAAAAAAAAAAA") == 0 && !r.whole);
	unlink(path);
}

/* A PNG file's chunks are walked as far as they go. */
static void
hostile_chunks_do_no_harm(void)
{
	unsigned char bytes[200];
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_record r;

	for (unsigned len = 0; len < 256; len++) {
		memset(bytes, 0, sizeof bytes);
		memcpy(bytes, "\x89PNG\r\n\x1a\n", 8);
		memset(bytes + 8, (int)len, 4);
		memcpy(
		    bytes + 60, "rm1:AAAAAAAAAAAAAAAAAAAAAA:BBBBBBBBBBB", 38);
		write_file(bytes, sizeof bytes);
		CHECK_OK(bake_record_read(path, &r, &err), err);
		CHECK(!r.whole);
	}
	unlink(path);
}

static void
a_stream_without_the_text_stays_as_it_is(void)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_digest d = bake_digest_of("recipe", 6);
	char text[BAKE_RECORD_TEXT], bytes[16];
	FILE *fp = tmpfile();

	bake_record_text(&d, text);
	CHECK(fp != NULL);
	if (fp == NULL)
		return;
	fputs("nothing", fp);
	CHECK_OK(bake_record_seal(fp, text, &err), err);
	rewind(fp);
	CHECK(fread(bytes, 1, sizeof bytes, fp) == 7);
	CHECK(memcmp(bytes, "nothing", 7) == 0);
	fclose(fp);
	/* one that cannot be read */
	fp = fopen("/dev/full", "wb");
	if (fp == NULL)
		return;
	fputs(text, fp);
	CHECK(bake_record_seal(fp, text, &err) == BAKE_EIO);
	fclose(fp);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(digest_of_nothing_is_the_published_one),
		CASE(text_is_six_bits_a_character),
		CASE(pieces_and_files_have_the_digest_of_the_whole),
		CASE(what_is_no_file_has_no_digest),
		CASE(a_record_is_found_wherever_it_stands),
		CASE(no_byte_can_change),
		CASE(what_looks_like_a_record_is_none),
		CASE(hostile_chunks_do_no_harm),
		CASE(a_stream_without_the_text_stays_as_it_is),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
