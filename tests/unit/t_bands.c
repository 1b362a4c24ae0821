/* Large maps in bands: what is read, made or written by rows is the same. */
/* SPDX-License-Identifier: MIT */
#include "combine.h"
#include "normal.h"
#include "resample.h"
#include "test_files.h"

enum { W = 37, H = 150, NC = 4 };

/* Codes of 8 bits, so that every type holds them. */
static struct bake_image
make_map(int nchans)
{
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	uint32_t seed = 1;

	CHECK_OK(bake_image_alloc(&img, W, H, nchans, &err), err);
	for (int i = 0; i < W * H * nchans; i++) {
		seed = seed * 1664525u + 1013904223u;
		img.data[i] = (float)(seed >> 24) / 255.0f;
	}
	return img;
}

struct source {
	const struct bake_image *img;
	int next; /* row that must be asked for */
	int fails_at;
};

static enum bake_status
get_rows(void *arg, int y, int n, float *rows, struct bake_err *err)
{
	struct source *s = arg;
	const size_t row = (size_t)s->img->width * (size_t)s->img->nchans;

	CHECK(y == s->next && n > 0 && n <= s->img->height - y);
	s->next = y + n;
	if (s->fails_at >= y && s->fails_at < y + n)
		return bake_fail(err, BAKE_ENOMEM, "row %d", s->fails_at);
	for (int i = 0; i < n; i++)
		memcpy(rows + row * (size_t)i, bake_image_row(s->img, y + i),
		    row * sizeof *rows);
	return BAKE_OK;
}

/* The whole file of a picture that is made row by row. */
static enum bake_status
write_rows(struct source *s, const struct bake_write_params *p,
    struct bytes *file, struct bake_err *err)
{
	const struct bake_row_source rows = { W, H, s->img->nchans, get_rows,
		s };
	FILE *f = tmpfile();
	enum bake_status rc = bake_rows_write(&rows, p, f, "out", NULL, err);

	fseek(f, 0, SEEK_END);
	file->n = (size_t)ftell(f);
	file->p = malloc(file->n + 1);
	rewind(f);
	if (fread(file->p, 1, file->n, f) != file->n)
		abort();
	fclose(f);
	return rc;
}

static void
rows_give_the_bytes_of_the_image(void)
{
	struct bake_image img = make_map(NC);
	struct bake_err err = BAKE_ERR_INIT;

	for (int k = 0; k < NKINDS; k++) {
		const struct bake_write_params p = params_of(k);
		struct source s = { &img, 0, -1 };
		struct bytes whole = encode(&img, &p), rows = { NULL, 0 };

		CHECK_OK(write_rows(&s, &p, &rows, &err), err);
		CHECK(s.next == H);
		CHECK(
		    rows.n == whole.n && memcmp(rows.p, whole.p, whole.n) == 0);
		free(whole.p);
		free(rows.p);
	}
	bake_image_free(&img);
}

static void
a_row_that_fails_ends_the_file_with_its_reason(void)
{
	struct bake_image img = make_map(NC);

	for (int k = 0; k < NKINDS; k++) {
		const struct bake_write_params p = params_of(k);
		struct source s = { &img, 0, 70 };
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes rows = { NULL, 0 };

		CHECK(write_rows(&s, &p, &rows, &err) == BAKE_ENOMEM);
		CHECK(strcmp(err.msg, "row 70") == 0);
		free(rows.p);
	}
	bake_image_free(&img);
}

static struct bake_image
read_back(const struct bytes *b, const char *name, const int *channel, int n)
{
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_image_info info;
	struct bake_reader *r;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(
	    bake_reader_open_memory(&r, b->p, b->n, name, &limits, &info, &err),
	    err);
	CHECK_OK(bake_reader_read_channels(r, channel, n, &img, &err), err);
	bake_reader_close(r);
	return img;
}

/* In every kind, in rows and in tiles that the border cuts. */
static void
channels_come_in_the_order_asked_for(void)
{
	static const int lists[][5] = { { 4, 0, 1, 2, 3 }, { 4, 3, 1, 0, 2 },
		{ 2, 2, 0 }, { 1, 3 }, { 3, 1, 2, 3 }, { 2, 1, 1 } };
	struct bake_image img = make_map(NC);

	for (int k = 0; k < 2 * NKINDS; k++) {
		struct bake_write_params p = params_of(k / 2);
		struct bytes file;

		if (k % 2 != 0 && p.type != BAKE_FILE_TIFF &&
		    p.type != BAKE_FILE_EXR)
			continue;
		p.tile = k % 2 * 16;
		file = encode(&img, &p);
		for (size_t l = 0; l < sizeof lists / sizeof *lists; l++) {
			const int n = lists[l][0], *channel = lists[l] + 1;
			struct bake_image got =
			    read_back(&file, kinds[k / 2].name, channel, n);
			int nbad = 0;

			for (int i = 0; i < W * H * n; i++) {
				float want =
				    img.data[i / n * NC + channel[i % n]];

				/* half has 11 bits */
				nbad +=
				    fabsf(got.data[i] - want) >
				    (p.data_format == BAKE_DATA_HALF ? 0x1p-12f
								     : 0);
			}
			CHECK(nbad == 0);
			bake_image_free(&got);
		}
		free(file.p);
	}
	bake_image_free(&img);
}

static void
what_a_type_cannot_hold_is_refused(void)
{
	struct bake_image img = make_map(NC);
	struct source s = { &img, 0, -1 };
	struct bake_row_source wide = { 65536, 1, 1, get_rows, &s };
	struct bake_write_params p = params_of(2), tiles = params_of(0);
	struct bake_err err = BAKE_ERR_INIT;
	FILE *f = tmpfile();

	CHECK(
	    bake_rows_write(&wide, &p, f, "o.tga", NULL, &err) == BAKE_EINVAL);
	CHECK(strcmp(err.msg, "o.tga: tga holds at most 65535 texels a side, "
			      "not 65536x1; tiff and exr hold more") == 0);
	tiles.tile = 16;
	CHECK(bake_image_write(&img, &tiles, f, "o.png", NULL, &err) ==
	      BAKE_EINVAL);
	tiles = params_of(3);
	tiles.tile = 24;
	CHECK(bake_image_write(&img, &tiles, f, "o.tif", NULL, &err) ==
	      BAKE_EINVAL);
	fclose(f);
	bake_image_free(&img);
}

static void
windows_resample_alike(void)
{
	static const struct {
		int width, height;
		double step_v, offset_v;
		bool clamp;
	} cases[] = { { 61, 90, 0, 0, false }, { 20, 400, 0, 0.3, true },
		{ 37, 31, 9.7, -3, false }, { 50, 777, 0.4, 1000.5, false },
		{ 50, 5, 0, 0, true } };
	struct bake_image img = make_map(3);
	struct bake_err err = BAKE_ERR_INIT;

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		for (int rows = 1; rows < 100; rows += 16) {
			struct bake_resample_params p =
			    BAKE_RESAMPLE_PARAMS_DEFAULT;
			struct bake_image whole = BAKE_IMAGE_INIT;
			struct bake_image parts = BAKE_IMAGE_INIT;
			char text[16];
			const size_t n = (size_t)cases[i].width *
					 (size_t)cases[i].height * 3;

			p.step_v = cases[i].step_v;
			p.offset_v = cases[i].offset_v;
			p.wrap.clamp_u = p.wrap.clamp_v = cases[i].clamp;
			p.nthreads = 2;
			unsetenv("BAKE_BAND_ROWS");
			CHECK_OK(bake_resample_mapped(&img, cases[i].width,
				     cases[i].height, &p, &whole, &err),
			    err);
			snprintf(text, sizeof text, "%d", rows);
			setenv("BAKE_BAND_ROWS", text, 1);
			CHECK_OK(bake_resample_mapped(&img, cases[i].width,
				     cases[i].height, &p, &parts, &err),
			    err);
			CHECK(memcmp(whole.data, parts.data,
				  n * sizeof(float)) == 0);
			bake_image_free(&whole);
			bake_image_free(&parts);
		}
	unsetenv("BAKE_BAND_ROWS");
	bake_image_free(&img);
}

static void
normals_of_some_rows_are_those_of_all(void)
{
	struct bake_image depth = make_map(1), all = BAKE_IMAGE_INIT;
	struct bake_image rows = BAKE_IMAGE_INIT;
	const struct bake_wrap wrap = { false, true };
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_normal_from_depth(
		     &depth, 0.2, wrap, BAKE_SLOPE_SCHARR, 2, &all, &err),
	    err);
	CHECK_OK(bake_image_alloc(&rows, W, 50, 3, &err), err);
	for (int y = 0; y + 50 <= H; y += 25) {
		CHECK_OK(bake_normal_rows_from_depth(&depth, 0.2, wrap,
			     BAKE_SLOPE_SCHARR, 2, y, &rows, &err),
		    err);
		CHECK(memcmp(rows.data, bake_image_row(&all, y),
			  (size_t)W * 50 * 3 * sizeof(float)) == 0);
	}
	CHECK(bake_normal_rows_from_depth(&depth, 0.2, wrap, BAKE_SLOPE_SCHARR,
		  2, H - 49, &rows, &err) == BAKE_EINVAL);
	bake_image_free(&rows);
	bake_image_free(&all);
	bake_image_free(&depth);
}

/* The blend of two layers, with the rows taken in pieces and then whole. */
static void
blends_come_by_rows(void)
{
	static const enum bake_normal_blend blends[] = { BAKE_NORMAL_SEED,
		BAKE_NORMAL_PD, BAKE_NORMAL_FROM_DEPTH };
	const struct bake_combine_layer layer = { 1, 1, { 2, 1.5, 0.1, 0 }, 0.1,
		0 };
	struct bake_image normal = BAKE_IMAGE_INIT, ao = BAKE_IMAGE_INIT;
	struct bake_image depth = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_image_alloc(&normal, W, H / 2, 3, &err), err);
	CHECK_OK(bake_image_alloc(&ao, W, H / 2, 1, &err), err);
	CHECK_OK(bake_image_alloc(&depth, W, H / 2, 1, &err), err);
	for (int b = 0; b < 3; b++) {
		struct bake_combine_params p = BAKE_COMBINE_PARAMS_DEFAULT;
		struct bake_combined out = BAKE_COMBINED_INIT;
		struct bake_combine *c[2];

		p.width = W;
		p.height = H;
		p.depth_scale = 0.1;
		p.normal_total = p.depth_total = p.nnormals = 1;
		p.normal_blend = blends[b];
		for (int i = 0; i < 2; i++) {
			struct bake_image maps = make_map(4);

			CHECK_OK(bake_combine_open(&c[i], &p, &err), err);
			CHECK_OK(
			    bake_combine_add(c[i], &layer, &maps, &err), err);
			bake_image_free(&maps);
		}
		CHECK_OK(bake_combine_settle(c[0], &err), err);
		CHECK_OK(bake_combine_finish(c[1], &out, &err), err);
		for (int y = 0; y < H; y += H / 2) {
			const size_t n = (size_t)W * (H / 2) * sizeof(float);

			CHECK_OK(bake_combine_get(
				     c[0], y, &normal, &ao, &depth, &err),
			    err);
			CHECK(memcmp(normal.data,
				  bake_image_row(&out.normal, y), 3 * n) == 0);
			CHECK(memcmp(ao.data, bake_image_row(&out.ao, y), n) ==
			      0);
			CHECK(memcmp(depth.data, bake_image_row(&out.depth, y),
				  n) == 0);
		}
		CHECK(bake_combine_get(c[0], H / 2 + 1, &normal, NULL, NULL,
			  &err) == BAKE_EINVAL);
		bake_combined_free(&out);
		bake_combine_close(c[0]);
		bake_combine_close(c[1]);
	}
	bake_image_free(&normal);
	bake_image_free(&ao);
	bake_image_free(&depth);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(rows_give_the_bytes_of_the_image),
		CASE(a_row_that_fails_ends_the_file_with_its_reason),
		CASE(channels_come_in_the_order_asked_for),
		CASE(what_a_type_cannot_hold_is_refused),
		CASE(windows_resample_alike),
		CASE(normals_of_some_rows_are_those_of_all),
		CASE(blends_come_by_rows),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
