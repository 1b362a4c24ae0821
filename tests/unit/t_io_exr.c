/* EXR files of several parts and deep ones: every bit comes back. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <unistd.h>

#include "io_exr.h"
#include "test_files.h"

static const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;

/* Pixels of any bits at all, NaNs and infinities among them. */
static struct bake_pixels
any_pixels(int w, int h, int nc, enum bake_data_format format, uint32_t seed)
{
	struct bake_pixels px = BAKE_PIXELS_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	size_t n = (size_t)w * (size_t)h * (size_t)nc;

	CHECK_OK(bake_pixels_alloc(&px, w, h, nc, format, &err), err);
	for (size_t i = 0; i < n; i++) {
		uint32_t bits = hash((uint32_t)i * 7 + seed) ^
				hash((uint32_t)i + seed * 31) << 16;

		if (format == BAKE_DATA_HALF)
			((uint16_t *)px.data)[i] = (uint16_t)bits;
		else
			memcpy((char *)px.data + 4 * i, &bits, 4);
	}
	return px;
}

static struct bytes
take(FILE *f)
{
	struct bytes b;

	fseek(f, 0, SEEK_END);
	b.n = (size_t)ftell(f);
	b.p = malloc(b.n + 1);
	rewind(f);
	if (fread(b.p, 1, b.n, f) != b.n)
		abort();
	fclose(f);
	return b;
}

static struct bytes
encode_parts(const struct bake_exr_part *part, int nparts, int nthreads)
{
	struct bake_err err = BAKE_ERR_INIT;
	FILE *f = tmpfile();

	CHECK_OK(bake_exr_write(part, nparts, nthreads, f, "out", &err), err);
	return take(f);
}

static struct bake_exr *
opened(const struct bytes *b)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_exr *exr;

	CHECK_OK(
	    bake_exr_open_memory(&exr, b->p, b->n, "mem.exr", &limits, &err),
	    err);
	if (exr == NULL)
		exit(1);
	return exr;
}

static bool
same_pixels(const struct bake_pixels *a, const struct bake_pixels *b)
{
	return a->width == b->width && a->height == b->height &&
	       a->nchans == b->nchans && a->format == b->format &&
	       memcmp(a->data, b->data,
		   (size_t)a->width * (size_t)a->height * (size_t)a->nchans *
		       bake_data_format_size(a->format)) == 0;
}

/* A set as rm-multilayer writes it, with parts of several pixels and of
 * different sizes; 133 rows are more than one chunk. */
struct set {
	struct bake_pixels px[4];
	struct bake_attrs attrs[2];
	struct bake_exr_channels channels[4];
	struct bake_exr_part part[3];
};

static void
make_set(struct set *s)
{
	static const char *const normal[] = { "N.x", "N.y" };
	static const char *const deep[] = { "Z" };

	memset(s, 0, sizeof *s);
	s->px[0] = any_pixels(37, 133, 4, BAKE_DATA_HALF, 1);
	s->px[1] = any_pixels(37, 133, 2, BAKE_DATA_HALF, 2);
	s->px[2] = any_pixels(37, 133, 1, BAKE_DATA_FLOAT, 3);
	s->px[3] = any_pixels(5, 1, 3, BAKE_DATA_FLOAT, 4);
	for (int i = 0; i < 4; i++)
		s->channels[i].px = &s->px[i];
	s->channels[1].names = normal;
	s->channels[2].names = deep;
	bake_attrs_set(&s->attrs[0], "Layout", "layer-depth");
	bake_attrs_set_number(&s->attrs[0], "Layers", 4);
	bake_attrs_set(&s->attrs[0], "DepthZero", "1.00395");
	bake_attrs_set(&s->attrs[1], "Layout", "layer-nx");
	s->part[0] =
	    (struct bake_exr_part){ "depth", 1, &s->channels[0], &s->attrs[0] };
	s->part[1] = (struct bake_exr_part){ "normal and z", 2, &s->channels[1],
		&s->attrs[1] };
	s->part[2] =
	    (struct bake_exr_part){ "small", 1, &s->channels[3], NULL };
}

static void
free_set(struct set *s)
{
	for (int i = 0; i < 4; i++)
		bake_pixels_free(&s->px[i]);
}

static void
every_bit_of_every_part_comes_back(void)
{
	static const struct {
		int part, nchans, px;
		const char *names[4];
	} want[] = { { 0, 4, 0, { "R", "G", "B", "A" } },
		{ 1, 2, 1, { "N.x", "N.y" } }, { 1, 1, 2, { "Z" } },
		{ 2, 3, 3, { "R", "G", "B" } } };
	struct set s;
	struct bytes b;
	struct bake_exr *exr;

	make_set(&s);
	for (int nparts = 1; nparts <= 3; nparts++) {
		b = encode_parts(s.part, nparts, 1);
		exr = opened(&b);
		CHECK(bake_exr_nparts(exr) == nparts);
		CHECK(bake_exr_find_part(exr, "depth") == 0);
		CHECK(
		    bake_exr_find_part(exr, "small") == (nparts == 3 ? 2 : -1));
		CHECK(bake_exr_find_part(exr, "") == -1);
		for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
			struct bake_pixels px = BAKE_PIXELS_INIT;
			struct bake_err err = BAKE_ERR_INIT;

			if (want[i].part >= nparts)
				continue;
			CHECK_OK(bake_exr_read(exr, want[i].part, want[i].names,
				     want[i].nchans, &px, &err),
			    err);
			CHECK(same_pixels(&px, &s.px[want[i].px]));
			bake_pixels_free(&px);
		}
		bake_exr_close(exr);
		free(b.p);
	}
	free_set(&s);
}

static void
parts_say_what_they_are(void)
{
	struct set s;
	struct bytes b;
	struct bake_exr *exr;
	const struct bake_exr_part_info *p;

	make_set(&s);
	b = encode_parts(s.part, 3, 1);
	exr = opened(&b);
	p = bake_exr_info(exr, 0);
	CHECK(strcmp(p->name, "depth") == 0 && !p->deep && !p->tiled);
	CHECK(p->info.width == 37 && p->info.height == 133);
	CHECK(p->info.nchans == 4 && p->info.bits == 16);
	CHECK(p->info.data_format == BAKE_DATA_HALF && !p->info.windowed);
	CHECK(strcmp(p->info.names[0], "A") == 0 &&
	      strcmp(p->info.names[3], "R") == 0);
	CHECK(p->info.nsubimages == 3 && p->info.orientation == 1);
	CHECK(strcmp(p->info.container, "openexr") == 0);
	CHECK(p->info.attrs.n == 3);
	for (int i = 0; i < 3; i++) {
		const struct bake_attr *a = &s.attrs[0].attr[i];
		const char *got = bake_attrs_get(&p->info.attrs, a->name);

		CHECK(got != NULL && strcmp(got, a->value) == 0);
	}
	p = bake_exr_info(exr, 1);
	CHECK(strcmp(p->name, "normal and z") == 0 && p->info.nchans == 3);
	CHECK(p->info.data_format == BAKE_DATA_FLOAT && p->info.bits == 32);
	p = bake_exr_info(exr, 2);
	CHECK(
	    p->info.width == 5 && p->info.height == 1 && p->info.attrs.n == 0);
	bake_exr_close(exr);
	bake_exr_close(NULL);
	free(b.p);
	free_set(&s);
}

/* What is all half is read as half; with a float beside it, as float. */
static void
all_channels_come_in_the_order_of_the_file(void)
{
	static const char *const names[] = { "N.x", "N.y", "Z" };
	struct set s;
	struct bake_pixels px[2] = { BAKE_PIXELS_INIT, BAKE_PIXELS_INIT };
	struct bake_err err = BAKE_ERR_INIT;
	struct bytes b;
	struct bake_exr *exr;

	make_set(&s);
	b = encode_parts(s.part, 3, 1);
	exr = opened(&b);
	CHECK_OK(bake_exr_read(exr, 1, NULL, 0, &px[0], &err), err);
	CHECK_OK(bake_exr_read(exr, 1, names, 3, &px[1], &err), err);
	CHECK(px[0].format == BAKE_DATA_FLOAT && same_pixels(&px[0], &px[1]));
	for (int i = 0; i < 37 * 133; i++) {
		const float *v = (const float *)px[0].data + 3 * i;
		const uint16_t *half = (const uint16_t *)s.px[1].data + 2 * i;
		float x = half_value(half[0]), y = half_value(half[1]);

		CHECK(isnan(x) ? isnan(v[0]) : memcmp(&x, &v[0], 4) == 0);
		CHECK(isnan(y) ? isnan(v[1]) : memcmp(&y, &v[1], 4) == 0);
		CHECK(
		    memcmp(&v[2], (const char *)s.px[2].data + 4 * i, 4) == 0);
	}
	bake_pixels_free(&px[0]);
	bake_pixels_free(&px[1]);
	bake_exr_close(exr);
	free(b.p);
	free_set(&s);
}

static void
same_bytes_for_any_threads_a_second_later(void)
{
	struct set s;
	struct bytes one, many;

	make_set(&s);
	one = encode_parts(s.part, 3, 1);
	usleep(1100000);
	for (int n = 0; n < 8; n += 7) {
		many = encode_parts(s.part, 3, n);
		CHECK(one.n == many.n && memcmp(one.p, many.p, one.n) == 0);
		free(many.p);
	}
	/* nor does the file say who made it, or when */
	CHECK(memmem(one.p, one.n, "capDate", 7) == NULL);
	CHECK(memmem(one.p, one.n, "owner", 5) == NULL);
	free(one.p);
	free_set(&s);
}

/* The image library finds the same values and metadata in the first part. */
static void
the_image_library_reads_them(void)
{
	struct set s;
	struct bytes b;
	struct bake_image_info info;
	struct bake_image img;
	struct bake_err err = BAKE_ERR_INIT;

	make_set(&s);
	b = encode_parts(s.part, 3, 0);
	CHECK_OK(decode(&b, "mem.exr", &info, &img, &err), err);
	CHECK(info.nsubimages == 3 && info.nchans == 4);
	CHECK(info.attrs.n == 3);
	CHECK(strcmp(info.names[0], "R") == 0);
	for (int i = 0; i < 37 * 133 * 4; i++) {
		float want = half_value(((uint16_t *)s.px[0].data)[i]);

		CHECK(isnan(want) ? isnan(img.data[i])
				  : memcmp(&want, &img.data[i], 4) == 0);
	}
	bake_image_free(&img);
	free(b.p);
	free_set(&s);
}

static void
parts_that_cannot_be_written_are_told(void)
{
	static const char *const twice[] = { "R", "G", "R", "A" };
	static const char *const empty[] = { "", "G", "B", "A" };
	struct set s;
	struct bake_pixels code = { 1, 1, 1, BAKE_DATA_UINT8, &code };
	struct bake_pixels five = { 1, 1, 5, BAKE_DATA_HALF, &code };
	struct bake_exr_channels bad[5];
	const char *text[] = { "out: no part", "out: a part has no name",
		"out: two parts are called depth", "out: part x has no channel",
		"out: exr holds no uint8 values",
		"out: two channels are called R", "out: a channel has no name",
		"out: a channel has no name",
		"out: pixels of part x are 5x1, expected 37x133" };
	FILE *f = tmpfile();

	make_set(&s);
	bad[0].px = &code;
	bad[0].names = NULL;
	bad[1].px = bad[2].px = &s.px[0];
	bad[1].names = twice;
	bad[2].names = empty;
	bad[3].px = &five;
	bad[3].names = NULL;
	bad[4] = s.channels[3];
	for (int i = 0; i < 9; i++) {
		struct bake_exr_part part[2] = { s.part[0],
			{ "x", 1, i < 4 ? NULL : &bad[i - 4], NULL } };
		struct bake_exr_channels two[2] = { s.channels[0], bad[4] };
		struct bake_err err = BAKE_ERR_INIT;

		if (i == 1 || i == 2)
			part[1].name = i == 1 ? "" : "depth";
		if (i == 1 || i == 2)
			part[1].channels = &s.channels[0];
		if (i == 3)
			part[1].nchannels = 0;
		if (i == 8) {
			part[1].nchannels = 2;
			part[1].channels = two;
		}
		CHECK(bake_exr_write(part, i == 0 ? 0 : 2, 1, f, "out", &err) ==
		      BAKE_EINVAL);
		if (strcmp(err.msg, text[i]) != 0)
			printf("'%s', not '%s'\n", err.msg, text[i]);
		CHECK(strcmp(err.msg, text[i]) == 0);
	}
	fclose(f);
	if ((f = fopen("/dev/full", "w")) != NULL) {
		struct bake_err err = BAKE_ERR_INIT;

		CHECK(bake_exr_write(s.part, 3, 1, f, "out", &err) == BAKE_EIO);
		CHECK(strcmp(err.msg, "out: No space left on device") == 0);
		fclose(f);
	}
	free_set(&s);
}

/* -- deep images -------------------------------------------------------- */

enum { DEEP_W = 11, DEEP_H = 23, DEEP_CHANS = 3 };

static const struct bake_deep_channel deep_channels[DEEP_CHANS] = {
	{ "Z", BAKE_DATA_FLOAT }, { "A", BAKE_DATA_HALF },
	{ "depth", BAKE_DATA_FLOAT }
};

/* Up to 9 samples, none in a third of the texels; the last row has none. */
static size_t
make_counts(unsigned count[DEEP_W * DEEP_H])
{
	size_t n = 0;

	for (int i = 0; i < DEEP_W * DEEP_H; i++) {
		count[i] = i % 3 == 0 || i >= DEEP_W * (DEEP_H - 1)
			       ? 0
			       : hash((uint32_t)i) % 10;
		n += count[i];
	}
	return n;
}

static struct bytes
encode_deep(const float *value, size_t n, int band, int nthreads)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_deep_writer *w;
	struct bake_attrs attrs;
	unsigned count[DEEP_W * DEEP_H];
	FILE *f = tmpfile();
	size_t at = 0;

	make_counts(count);
	bake_attrs_clear(&attrs);
	bake_attrs_set(&attrs, "Layout", "layer-depth");
	CHECK_OK(bake_deep_writer_open(&w, f, "out", DEEP_W, DEEP_H,
		     deep_channels, DEEP_CHANS, &attrs, nthreads, &err),
	    err);
	for (int y = 0; y < DEEP_H; y += band) {
		int rows = band < DEEP_H - y ? band : DEEP_H - y;
		/* the first channel with a stride of 2, others of 1 */
		struct bake_deep_samples s[DEEP_CHANS] = { { value + 2 * at,
							       2 },
			{ value + 2 * n + at, 1 }, { value + 3 * n + at, 1 } };

		CHECK_OK(
		    bake_deep_writer_rows(w, rows, count + y * DEEP_W, s, &err),
		    err);
		for (int i = 0; i < rows * DEEP_W; i++)
			at += count[y * DEEP_W + i];
	}
	CHECK_OK(bake_deep_writer_close(w, &err), err);
	return take(f);
}

static float *
make_samples(size_t n)
{
	float *v = malloc((4 * n + 1) * sizeof *v);

	for (size_t i = 0; i < 4 * n; i++)
		/* A's are halves; the others any finite floats */
		v[i] = any_value(
		    i / n == 2 ? BAKE_DATA_HALF : BAKE_DATA_FLOAT, (uint32_t)i);
	return v;
}

static void
every_sample_comes_back(void)
{
	static const char *const names[] = { "depth", "Z", "A" };
	unsigned count[DEEP_W * DEEP_H];
	size_t n = make_counts(count);
	float *v = make_samples(n);
	struct bytes b = encode_deep(v, n, 5, 1);
	struct bake_exr *exr = opened(&b);
	const struct bake_exr_part_info *p = bake_exr_info(exr, 0);
	struct bake_deep_image deep = BAKE_DEEP_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	size_t sum = 0;

	CHECK(bake_exr_nparts(exr) == 1 && p->deep && p->info.nchans == 3);
	CHECK(p->info.width == DEEP_W && p->info.height == DEEP_H);
	CHECK(bake_attrs_get(&p->info.attrs, "Layout") != NULL);
	CHECK_OK(bake_exr_read_deep(exr, 0, names, 3, &deep, &err), err);
	CHECK(deep.nsamples == n && deep.nchans == 3);
	for (int i = 0; i < DEEP_W * DEEP_H; i++) {
		CHECK(deep.start[i] == sum);
		sum += count[i];
	}
	CHECK(deep.start[DEEP_W * DEEP_H] == n);
	for (size_t i = 0; deep.nsamples == n && i < n; i++) {
		CHECK(memcmp(&deep.value[i], &v[3 * n + i], 4) == 0);
		CHECK(memcmp(&deep.value[n + i], &v[2 * i], 4) == 0);
		CHECK(memcmp(&deep.value[2 * n + i], &v[2 * n + i], 4) == 0);
	}
	bake_deep_image_free(&deep);
	/* all, in the file's order */
	CHECK_OK(bake_exr_read_deep(exr, 0, NULL, 0, &deep, &err), err);
	for (size_t i = 0; i < n; i++)
		CHECK(memcmp(&deep.value[i], &v[2 * n + i], 4) == 0);
	bake_deep_image_free(&deep);
	bake_exr_close(exr);
	free(v);
	free(b.p);
}

/* In bands of any height and on any number of threads. */
static void
deep_files_have_the_same_bytes(void)
{
	unsigned count[DEEP_W * DEEP_H];
	size_t n = make_counts(count);
	float *v = make_samples(n);
	struct bytes one = encode_deep(v, n, DEEP_H, 1);

	for (int k = 0; k < 4; k++) {
		struct bytes b =
		    encode_deep(v, n, k % 2 == 0 ? 1 : 7, k < 2 ? 1 : 4);

		CHECK(one.n == b.n && memcmp(one.p, b.p, b.n) == 0);
		free(b.p);
	}
	free(one.p);
	free(v);
}

static void
half_samples_round_and_clip(void)
{
	const float v[] = { 1.0f / 3, 65504, 1e6f, -1e6f, 0x1p-25f, 0 };
	/* a third to 11 bits; half of the smallest half is a tie, to even */
	const float want[] = { 1365.0f / 4096, 65504, 65504, -65504, 0, 0 };
	const struct bake_deep_channel channel = { "A", BAKE_DATA_HALF };
	const struct bake_deep_samples s = { v, 1 };
	const unsigned count = 6;
	struct bake_deep_image deep = BAKE_DEEP_IMAGE_INIT;
	struct bake_deep_writer *w;
	struct bake_err err = BAKE_ERR_INIT;
	FILE *f = tmpfile();
	struct bytes b;
	struct bake_exr *exr;

	CHECK_OK(bake_deep_writer_open(
		     &w, f, "out", 1, 1, &channel, 1, NULL, 1, &err),
	    err);
	CHECK_OK(bake_deep_writer_rows(w, 1, &count, &s, &err), err);
	CHECK_OK(bake_deep_writer_close(w, &err), err);
	b = take(f);
	exr = opened(&b);
	CHECK_OK(bake_exr_read_deep(exr, 0, NULL, 0, &deep, &err), err);
	CHECK(deep.nsamples == 6 && memcmp(deep.value, want, 24) == 0);
	bake_deep_image_free(&deep);
	bake_exr_close(exr);
	free(b.p);
}

/* A picture without a single layer is a file, too. */
static void
deep_images_may_be_empty(void)
{
	const struct bake_deep_samples s[DEEP_CHANS] = { { NULL, 1 },
		{ NULL, 1 }, { NULL, 1 } };
	unsigned count[6] = { 0 };
	struct bake_deep_image deep = BAKE_DEEP_IMAGE_INIT;
	struct bake_deep_writer *w;
	struct bake_err err = BAKE_ERR_INIT;
	FILE *f = tmpfile();
	struct bytes b;
	struct bake_exr *exr;

	CHECK_OK(bake_deep_writer_open(&w, f, "out", 3, 2, deep_channels,
		     DEEP_CHANS, NULL, 1, &err),
	    err);
	CHECK_OK(bake_deep_writer_rows(w, 2, count, s, &err), err);
	CHECK_OK(bake_deep_writer_close(w, &err), err);
	b = take(f);
	exr = opened(&b);
	CHECK_OK(bake_exr_read_deep(exr, 0, NULL, 0, &deep, &err), err);
	CHECK(deep.nsamples == 0 && deep.width == 3 && deep.height == 2);
	bake_deep_image_free(&deep);
	bake_exr_close(exr);
	free(b.p);
}

static void
deep_images_that_cannot_be_written_are_told(void)
{
	static const struct bake_deep_channel twice[] = {
		{ "Z", BAKE_DATA_FLOAT }, { "Z", BAKE_DATA_HALF }
	};
	static const struct bake_deep_channel code = { "Z", BAKE_DATA_UINT16 };
	const float v[4] = { 0 };
	const struct bake_deep_samples s[3] = { { v, 1 }, { v, 1 }, { v, 1 } };
	unsigned count[4] = { 1, 1, 1, 1 };
	struct bake_deep_writer *w;
	struct bake_err err = BAKE_ERR_INIT;
	FILE *f = tmpfile();

	CHECK(bake_deep_writer_open(&w, f, "out", 0, 1, deep_channels, 3, NULL,
		  1, &err) == BAKE_EINVAL);
	CHECK(w == NULL);
	CHECK(bake_deep_writer_open(&w, f, "out", 1, 1, deep_channels, 0, NULL,
		  1, &err) == BAKE_EINVAL);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_deep_writer_open(
		  &w, f, "out", 1, 1, twice, 2, NULL, 1, &err) == BAKE_EINVAL);
	CHECK(strcmp(err.msg, "out: two channels are called Z") == 0);
	CHECK(bake_deep_writer_open(
		  &w, f, "out", 1, 1, &code, 1, NULL, 1, &err) == BAKE_EINVAL);
	CHECK(w == NULL);
	CHECK(bake_deep_writer_close(NULL, &err) == BAKE_OK);

	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK_OK(bake_deep_writer_open(
		     &w, f, "out", 2, 2, deep_channels, 3, NULL, 1, &err),
	    err);
	CHECK(bake_deep_writer_rows(w, 3, count, s, &err) == BAKE_EINVAL);
	CHECK(bake_deep_writer_rows(w, 0, count, s, &err) == BAKE_EINVAL);
	err = (struct bake_err)BAKE_ERR_INIT;
	count[0] = UINT_MAX;
	CHECK(bake_deep_writer_rows(w, 1, count, s, &err) == BAKE_EINVAL);
	CHECK(strstr(err.msg, "samples in a row") != NULL);
	err = (struct bake_err)BAKE_ERR_INIT;
	count[0] = 1;
	CHECK_OK(bake_deep_writer_rows(w, 1, count, s, &err), err);
	CHECK(bake_deep_writer_close(w, &err) == BAKE_EINVAL);
	CHECK(strcmp(err.msg, "out: only 1 of 2 rows were written") == 0);
	fclose(f);
	if ((f = fopen("/dev/full", "w")) == NULL)
		return;
	setvbuf(f, NULL, _IONBF, 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_deep_writer_open(&w, f, "out", 2, 2, deep_channels, 3, NULL,
		  1, &err) == BAKE_EIO);
	CHECK(strcmp(err.msg, "out: No space left on device") == 0);
	fclose(f);
}

/* -- files that are no good --------------------------------------------- */

static enum bake_status
read_whatever(const unsigned char *p, size_t n,
    const struct bake_read_limits *lim, struct bake_err *err)
{
	struct bake_exr *exr;
	enum bake_status rc =
	    bake_exr_open_memory(&exr, p, n, "bad.exr", lim, err);

	CHECK((rc == BAKE_OK) == (exr != NULL));
	for (int i = 0; rc == BAKE_OK && i < bake_exr_nparts(exr); i++) {
		struct bake_pixels px = BAKE_PIXELS_INIT;
		struct bake_deep_image deep = BAKE_DEEP_IMAGE_INIT;

		if (bake_exr_info(exr, i)->deep)
			rc = bake_exr_read_deep(exr, i, NULL, 0, &deep, err);
		else
			rc = bake_exr_read(exr, i, NULL, 0, &px, err);
		CHECK(rc == BAKE_OK || (px.data == NULL && deep.value == NULL));
		bake_pixels_free(&px);
		bake_deep_image_free(&deep);
	}
	bake_exr_close(exr);
	CHECK((rc == BAKE_OK) == (err->msg[0] == '\0'));
	CHECK(rc == BAKE_OK || strncmp(err->msg, "bad.exr: ", 9) == 0);
	return rc;
}

/* Cut anywhere, it is no whole file. */
static void
truncated_files_are_told(void)
{
	unsigned count[DEEP_W * DEEP_H];
	size_t n = make_counts(count);
	float *v = make_samples(n);
	struct set s;
	struct bytes b[2];

	make_set(&s);
	b[0] = encode_parts(s.part, 3, 1);
	b[1] = encode_deep(v, n, 5, 1);
	for (int k = 0; k < 2; k++) {
		size_t step = b[k].n / 150 + 1;

		for (size_t cut = 0; cut < b[k].n; cut += step) {
			struct bake_err err = BAKE_ERR_INIT;
			/* of its own, so that a read beyond is seen */
			unsigned char *p = malloc(cut + (cut == 0));

			memcpy(p, b[k].p, cut);
			CHECK(
			    read_whatever(p, cut, &limits, &err) == BAKE_EDATA);
			free(p);
		}
		free(b[k].p);
	}
	free_set(&s);
	free(v);
}

/* With any byte another one, it is read or refused, never worse. */
static void
corrupt_files_are_no_danger(void)
{
	const struct bake_read_limits small = { 1 << 16, false };
	unsigned count[DEEP_W * DEEP_H];
	size_t n = make_counts(count);
	float *v = make_samples(n);
	struct set s;
	struct bytes b[2];

	make_set(&s);
	b[0] = encode_parts(s.part + 2, 1, 1);
	b[1] = encode_deep(v, n, 5, 1);
	for (int k = 0; k < 2; k++) {
		/* all of the header and the tables, some of the rest */
		for (size_t i = 0; i < b[k].n; i += i < 700 ? 1 : 41) {
			struct bake_err err = BAKE_ERR_INIT;
			unsigned char was = b[k].p[i];

			b[k].p[i] = (unsigned char)(hash((uint32_t)i) % 3 == 0
							? 0xff
							: was ^ 0x80);
			read_whatever(b[k].p, b[k].n, &small, &err);
			b[k].p[i] = was;
		}
		free(b[k].p);
	}
	free_set(&s);
	free(v);
}

static void
limits_hold(void)
{
	struct bake_read_limits few = { 37 * 133 - 1, false };
	struct set s;
	struct bytes b;
	struct bake_err err = BAKE_ERR_INIT;

	make_set(&s);
	b = encode_parts(s.part, 3, 1);
	CHECK(read_whatever(b.p, b.n, &few, &err) == BAKE_ELIMIT);
	few.max_texels++;
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(read_whatever(b.p, b.n, &few, &err) == BAKE_OK);
	free(b.p);
	free_set(&s);
}

static void
what_is_not_there_is_told(void)
{
	static const char *const none[] = { "R", "Q" };
	struct set s;
	struct bytes b;
	struct bake_exr *exr;
	struct bake_pixels px;
	struct bake_deep_image deep;
	struct bake_err err = BAKE_ERR_INIT;

	make_set(&s);
	b = encode_parts(s.part, 3, 1);
	exr = opened(&b);
	CHECK(bake_exr_read(exr, 3, NULL, 0, &px, &err) == BAKE_EINVAL);
	CHECK(bake_exr_read(exr, -1, NULL, 0, &px, &err) == BAKE_EINVAL);
	CHECK(bake_exr_read(exr, 0, none, 0, &px, &err) == BAKE_EINVAL);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_exr_read(exr, 0, none, 2, &px, &err) == BAKE_EINVAL);
	CHECK(strcmp(err.msg, "mem.exr: part 0 has no channel Q") == 0);
	CHECK(px.data == NULL);
	CHECK(bake_exr_read_deep(exr, 0, NULL, 0, &deep, &err) == BAKE_EDATA);
	CHECK(deep.start == NULL);
	bake_exr_close(exr);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_exr_open(&exr, "no such file", &limits, &err) == BAKE_EIO);
	CHECK(exr == NULL);
	CHECK(strcmp(err.msg, "no such file: No such file or directory") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_exr_open_memory(&exr, "PNG and so on", 13, "x.png", &limits,
		  &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "x.png: not an EXR file") == 0);
	free(b.p);
	free_set(&s);
}

/* Single-part files of the image library: windows are images of their own. */
static void
files_of_the_image_library_are_read(void)
{
	for (int kind = 6; kind < NKINDS; kind++) {
		struct bake_write_params params = params_of(kind);
		struct bake_image img =
		    any_image(21, 40, 3, kinds[kind].format);
		static const char *const names[] = { "R", "G", "B" };
		struct bake_pixels px;
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes b;
		struct bake_exr *exr;
		float row[21 * 3];

		bake_attrs_set_number(&params.attrs, "DepthScale", 0.1);
		b = encode(&img, &params);
		exr = opened(&b);
		CHECK(strcmp(bake_attrs_get(&bake_exr_info(exr, 0)->info.attrs,
				 "DepthScale"),
			  "0.1") == 0);
		CHECK_OK(bake_exr_read(exr, 0, names, 3, &px, &err), err);
		CHECK(px.format == kinds[kind].format);
		for (int y = 0; y < 40; y++) {
			bake_pixels_get(&px, 0, y, 21, row);
			CHECK(memcmp(row, bake_image_row(&img, y),
				  sizeof row) == 0);
		}
		bake_pixels_free(&px);
		bake_exr_close(exr);
		bake_image_free(&img);
		free(b.p);
	}
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(every_bit_of_every_part_comes_back),
		CASE(parts_say_what_they_are),
		CASE(all_channels_come_in_the_order_of_the_file),
		CASE(same_bytes_for_any_threads_a_second_later),
		CASE(the_image_library_reads_them),
		CASE(parts_that_cannot_be_written_are_told),
		CASE(every_sample_comes_back),
		CASE(deep_files_have_the_same_bytes),
		CASE(half_samples_round_and_clip),
		CASE(deep_images_may_be_empty),
		CASE(deep_images_that_cannot_be_written_are_told),
		CASE(truncated_files_are_told),
		CASE(corrupt_files_are_no_danger),
		CASE(limits_hold),
		CASE(what_is_not_there_is_told),
		CASE(files_of_the_image_library_are_read),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
