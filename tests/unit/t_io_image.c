/* Image files: every bit comes back, with its names and metadata. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <unistd.h>

#include "pixels.h"
#include "relief.h"
#include "test_files.h"

static void
check_info(const struct bake_image_info *info, int kind, int w, int h, int nc)
{
	static const char *const names[4][4] = { { "Y" }, { "Y", "A" },
		{ "R", "G", "B" }, { "R", "G", "B", "A" } };
	static const int bits[] = { 8, 16, 16, 32 };

	CHECK(info->width == w && info->height == h && info->nchans == nc);
	CHECK(info->data_format == kinds[kind].format);
	CHECK(info->bits == bits[kinds[kind].format]);
	CHECK(!info->is_signed && !info->windowed);
	CHECK(info->orientation == 1 && info->nsubimages == 1);
	CHECK(strcmp(info->container, kinds[kind].container) == 0);
	CHECK(info->attrs.n == 0);
	if (nc >= 3)
		for (int c = 0; c < nc; c++)
			CHECK(strcmp(info->names[c], names[nc - 1][c]) == 0);
}

/* All kinds, 1 to 4 channels; 130 rows are more than two bands. */
static void
every_bit_comes_back(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 7, 5 }, { 3, 130 },
		{ 65, 2 } };

	for (int k = 0; k < NKINDS * 4 * 4; k++) {
		int kind = k / 16, nc = k / 4 % 4 + 1;
		int w = sizes[k % 4][0], h = sizes[k % 4][1];
		struct bake_write_params params = params_of(kind);
		struct bake_image img = any_image(w, h, nc, kinds[kind].format);
		struct bake_image back;
		struct bake_image_info info;
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes b = encode(&img, &params);

		CHECK_OK(decode(&b, kinds[kind].name, &info, &back, &err), err);
		check_info(&info, kind, w, h, nc);
		if (!same_texels(&img, &back))
			printf("%s, %s, %d channels, %dx%d\n",
			    kinds[kind].container,
			    bake_data_format_name(kinds[kind].format), nc, w,
			    h);
		CHECK(same_texels(&img, &back));
		bake_image_free(&img);
		bake_image_free(&back);
		free(b.p);
	}
}

static void
every_code_comes_back(void)
{
	for (int kind = 0; kind < NKINDS; kind++) {
		int max = bake_data_format_max(kinds[kind].format);
		struct bake_write_params params = params_of(kind);
		struct bake_image img = image(256, max > 255 ? 256 : 1, 1);
		struct bake_image back;
		struct bake_image_info info;
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes b;

		for (int c = 0; c <= max; c++)
			img.data[c] = (float)c / (float)max;
		if (max > 0) {
			b = encode(&img, &params);
			CHECK_OK(
			    decode(&b, kinds[kind].name, &info, &back, &err),
			    err);
			CHECK(same_texels(&img, &back));
			bake_image_free(&back);
			free(b.p);
		}
		bake_image_free(&img);
	}
}

static void
every_half_comes_back(void)
{
	struct bake_write_params params = params_of(6);
	struct bake_image img = image(256, 256, 1), back;
	struct bake_image_info info;
	struct bake_err err = BAKE_ERR_INIT;
	struct bytes b;

	for (unsigned i = 0; i < 65536; i++)
		img.data[i] = half_value(i);
	b = encode(&img, &params);
	CHECK_OK(decode(&b, "a.exr", &info, &back, &err), err);
	CHECK(info.data_format == BAKE_DATA_HALF);
	for (unsigned i = 0; i < 65536; i++)
		CHECK(isnan(img.data[i])
			  ? isnan(back.data[i])
			  : memcmp(&img.data[i], &back.data[i], 4) == 0);
	bake_image_free(&img);
	bake_image_free(&back);
	free(b.p);
}

/* A view whose rows lie apart is written as if they did not. */
static void
views_are_written_row_by_row(void)
{
	float wide[4 * 11];
	struct bake_image view = { 3, 4, 2, 11, wide }, back;
	struct bake_image_info info;
	struct bake_err err = BAKE_ERR_INIT;

	for (int i = 0; i < 44; i++)
		wide[i] = (float)i / 255.0f;
	for (int kind = 0; kind < NKINDS; kind++) {
		struct bake_write_params params = params_of(kind);
		struct bytes b;

		if (kinds[kind].format == BAKE_DATA_UINT16 ||
		    kinds[kind].format == BAKE_DATA_HALF)
			continue; /* these round */
		b = encode(&view, &params);
		CHECK_OK(decode(&b, kinds[kind].name, &info, &back, &err), err);
		CHECK(same_texels(&view, &back));
		bake_image_free(&back);
		free(b.p);
	}
}

static void
clipped_values_are_counted(void)
{
	float v[] = { -1.0f, -0.001f, 0.0f, 1.0f, 1.001f, 2.0f, NAN, INFINITY };
	struct bake_image img = { 4, 2, 1, 4, v };
	static const struct {
		int kind;
		size_t nclipped;
	} want[] = { { 0, 4 }, { 1, 6 }, { 2, 4 }, { 3, 4 }, { 4, 6 }, { 5, 0 },
		{ 7, 0 } };

	for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
		struct bake_write_params params = params_of(want[i].kind);
		struct bake_err err = BAKE_ERR_INIT;
		FILE *f = tmpfile();
		size_t n = 99;

		CHECK_OK(
		    bake_image_write(&img, &params, f, "x", &n, &err), err);
		CHECK(n == want[i].nclipped);
		fclose(f);
	}
}

/* TIFF and EXR hold any number of channels; EXR brings them back sorted by
 * name, so that numbered names keep their order. */
static void
many_channels_come_back(void)
{
	static const int counts[] = { 5, 12, 50, 70 };

	for (int k = 0; k < 4 * 3; k++) {
		int nc = counts[k / 3], kind = k % 3 == 0 ? 5 : 7;
		bool named = k % 3 == 1;
		char text[70][16];
		const char *names[70];
		struct bake_write_params params = params_of(kind);
		struct bake_image img = any_image(3, 2, nc, kinds[kind].format);
		struct bake_image back;
		struct bake_image_info info;
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes b;

		for (int c = 0; c < nc; c++) {
			snprintf(text[c], sizeof text[c], "tan.%02d", c);
			names[c] = text[c];
		}
		params.names = named ? names : NULL;
		b = encode(&img, &params);
		CHECK_OK(decode(&b, kinds[kind].name, &info, &back, &err), err);
		CHECK(info.nchans == nc);
		CHECK(same_texels(&img, &back));
		for (int c = 0; named && c < nc && c < BAKE_INFO_NAMES; c++)
			CHECK(strcmp(info.names[c], names[c]) == 0);
		bake_image_free(&img);
		bake_image_free(&back);
		free(b.p);
	}
}

/* Whatever the order, a channel keeps its name. */
static void
names_stay_with_their_channels(void)
{
	static const char *const names[] = { "normal.x", "normal.y", "ao",
		"depth" };
	struct bake_write_params params = params_of(7);
	struct bake_image img = any_image(5, 3, 4, BAKE_DATA_FLOAT), back;
	struct bake_image_info info;
	struct bake_err err = BAKE_ERR_INIT;
	struct bytes b;

	params.names = names;
	b = encode(&img, &params);
	CHECK_OK(decode(&b, "a.exr", &info, &back, &err), err);
	for (int c = 0; c < 4; c++) {
		int at = 0;

		while (at < 3 && strcmp(info.names[at], names[c]) != 0)
			at++;
		CHECK(strcmp(info.names[at], names[c]) == 0);
		for (int i = 0; i < 15; i++)
			CHECK(memcmp(&img.data[4 * i + c],
				  &back.data[4 * i + at], 4) == 0);
	}
	bake_image_free(&img);
	bake_image_free(&back);
	free(b.p);
}

static void
metadata_come_back(void)
{
	for (int kind = 0; kind < NKINDS; kind++) {
		struct bake_write_params params = params_of(kind);
		struct bake_image img = any_image(4, 4, 4, kinds[kind].format);
		struct bake_image back;
		struct bake_image_info info;
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes b;

		/* all that a relief map says, at its longest: it is longer
		 * than one 80-character line of TGA's comment */
		bake_attrs_set(&params.attrs, "Layout", "normal-relief");
		bake_attrs_set(&params.attrs, "Polarity", "height");
		bake_attrs_set(&params.attrs, "NormalY", "down");
		bake_attrs_set(&params.attrs, "NormalCode", "unsigned");
		bake_attrs_set_number(&params.attrs, "DepthScale", 0.012345678);
		bake_attrs_set(&params.attrs, "Wrap", "clamp-u");
		b = encode(&img, &params);
		CHECK_OK(decode(&b, kinds[kind].name, &info, &back, &err), err);
		CHECK(info.attrs.n == params.attrs.n);
		for (int i = 0; i < params.attrs.n; i++) {
			const struct bake_attr *a = &params.attrs.attr[i];
			const char *got = bake_attrs_get(&info.attrs, a->name);

			if (got == NULL || strcmp(got, a->value) != 0)
				printf("%s: %s = %s, not %s\n",
				    kinds[kind].container, a->name,
				    got != NULL ? got : "nothing", a->value);
			CHECK(got != NULL && strcmp(got, a->value) == 0);
		}
		CHECK(same_texels(&img, &back));
		bake_image_free(&img);
		bake_image_free(&back);
		free(b.p);
	}
}

/* Where more is said than a file holds, an attribute is left out whole: half a
 * number would be another number. */
static void
metadata_are_never_cut(void)
{
	for (int kind = 0; kind < NKINDS; kind++) {
		struct bake_write_params params = params_of(kind);
		struct bake_image img = any_image(2, 2, 1, kinds[kind].format);
		struct bake_image back;
		struct bake_image_info info;
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes b;

		for (int i = 0; i < BAKE_ATTRS_MAX; i++) {
			char name[16], value[BAKE_ATTR_VALUE];

			snprintf(name, sizeof name, "N%d", i);
			memset(value, 'a' + i, sizeof value);
			value[40 + 3 * i] = '\0';
			bake_attrs_set(&params.attrs, name, value);
		}
		b = encode(&img, &params);
		CHECK_OK(decode(&b, kinds[kind].name, &info, &back, &err), err);
		for (int i = 0; i < info.attrs.n; i++) {
			const struct bake_attr *a = &info.attrs.attr[i];
			const char *want =
			    bake_attrs_get(&params.attrs, a->name);

			CHECK(want != NULL && strcmp(a->value, want) == 0);
		}
		CHECK(info.attrs.n == BAKE_ATTRS_MAX ||
		      kinds[kind].type == BAKE_FILE_TGA);
		bake_image_free(&img);
		bake_image_free(&back);
		free(b.p);
	}
}

/* What a multilayer texture says, with all coordinates long: a TGA's comment
 * has room for it. */
static void
layer_metadata_come_back(void)
{
	static const char *const must[] = { "Layout", "Layers", "Texture",
		"DepthZero", "DepthOne", "Axis", "Region", "MipLevel", "Tau",
		"NormalY", "DepthScale" };

	for (int kind = 0; kind < NKINDS; kind++) {
		struct bake_write_params params = params_of(kind);
		struct bake_relief_meta meta = BAKE_RELIEF_META_INIT;
		struct bake_image img = any_image(4, 4, 4, kinds[kind].format);
		struct bake_image back;
		struct bake_image_info info;
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes b;

		meta.layout = BAKE_LAYOUT_LAYER_DEPTH;
		meta.normal_y = BAKE_NORMAL_Y_DOWN;
		meta.depth_scale = 0.12345678;
		meta.layer = (struct bake_layer_meta){ .nlayers = 64,
			.texture = 16,
			.ntextures = 16,
			.axis = "-x",
			.has_region = true,
			.region = { -1234.56789, -2345.67891, 3456.78912,
			    4567.89123 },
			.mip_level = 12,
			.has_tau = true,
			.tau = 0.43219876 };
		bake_layer_meta_set_range(
		    &meta.layer, 1234.56789012, -2345.67890123);
		bake_relief_meta_to_attrs(&meta, &params.attrs);
		b = encode(&img, &params);
		CHECK_OK(decode(&b, kinds[kind].name, &info, &back, &err), err);
		for (size_t i = 0; i < sizeof must / sizeof *must; i++) {
			const char *got = bake_attrs_get(&info.attrs, must[i]);

			if (got == NULL)
				printf("%s: no %s\n", kinds[kind].container,
				    must[i]);
			CHECK(got != NULL &&
			      strcmp(got,
				  bake_attrs_get(&params.attrs, must[i])) == 0);
		}
		bake_image_free(&img);
		bake_image_free(&back);
		free(b.p);
	}
}

static struct bytes
encode_pixels(
    const struct bake_pixels *px, const struct bake_write_params *params)
{
	FILE *f = tmpfile();
	struct bake_err err = BAKE_ERR_INIT;
	struct bytes b = { NULL, 0 };
	size_t nclipped = 99;

	CHECK_OK(bake_pixels_write(px, params, f, "out", &nclipped, &err), err);
	CHECK(nclipped == 0);
	fseek(f, 0, SEEK_END);
	b.n = (size_t)ftell(f);
	b.p = malloc(b.n + 1);
	rewind(f);
	if (fread(b.p, 1, b.n, f) != b.n)
		abort();
	fclose(f);
	return b;
}

/* Pixels of every format into every kind of file: the bytes are those of the
 * same values as an image. 130 rows are more than two bands. */
static void
pixels_are_written_as_images_are(void)
{
	for (int k = 0; k < NKINDS * 4 * 4; k++) {
		int kind = k / 16, nc = k % 4 + 1;
		enum bake_data_format format =
		    (enum bake_data_format)(k / 4 % 4);
		struct bake_write_params params = params_of(kind);
		struct bake_image img = image(9, 130, nc);
		struct bake_pixels px = BAKE_PIXELS_INIT;
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes a, b;

		CHECK_OK(bake_pixels_alloc(&px, 9, 130, nc, format, &err), err);
		for (int y = 0; y < 130; y++) {
			float *row = bake_image_row(&img, y);

			/* within 0 .. 1, so that nothing clips, and what the
			 * pixels hold */
			for (int i = 0; i < 9 * nc; i++)
				row[i] = any_value(
				    BAKE_DATA_UINT16, (uint32_t)(y * 64 + i));
			bake_pixels_put(&px, 0, y, 9, row);
			bake_pixels_get(&px, 0, y, 9, row);
		}
		a = encode(&img, &params);
		b = encode_pixels(&px, &params);
		CHECK(a.n == b.n && memcmp(a.p, b.p, a.n) == 0);
		bake_image_free(&img);
		bake_pixels_free(&px);
		free(a.p);
		free(b.p);
	}
}

/* Every half, with all its NaNs, goes through as it is. */
static void
half_pixels_are_not_touched(void)
{
	struct bake_write_params params = params_of(6);
	struct bake_pixels px = BAKE_PIXELS_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_image back;
	struct bake_image_info info;
	struct bytes b;
	uint16_t *bits;

	CHECK_OK(
	    bake_pixels_alloc(&px, 256, 256, 1, BAKE_DATA_HALF, &err), err);
	bits = px.data;
	for (unsigned i = 0; i < 65536; i++)
		bits[i] = (uint16_t)i;
	b = encode_pixels(&px, &params);
	CHECK_OK(decode(&b, "a.exr", &info, &back, &err), err);
	for (unsigned i = 0; i < 65536; i++) {
		uint32_t got;
		float want = half_value(i);

		memcpy(&got, &back.data[i], 4);
		/* a NaN's payload goes to a float's highest bits */
		CHECK(isnan(want) ? (got >> 13 & 0x3ff) == (i & 0x3ff)
				  : memcmp(&want, &got, 4) == 0);
	}
	bake_pixels_free(&px);
	bake_image_free(&back);
	free(b.p);
}

static void
pixels_need_a_file_that_holds_them(void)
{
	uint16_t data[6] = { 0 };
	struct bake_pixels px = { 1, 1, 6, BAKE_DATA_HALF, data };
	struct bake_write_params params = params_of(0);
	struct bake_err err = BAKE_ERR_INIT;
	FILE *f = tmpfile();

	CHECK(
	    bake_pixels_write(&px, &params, f, "x", NULL, &err) == BAKE_EINVAL);
	CHECK(strcmp(err.msg, "x: png holds 4 channels, not 6") == 0);
	params.data_format = BAKE_DATA_HALF;
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(
	    bake_pixels_write(&px, &params, f, "x", NULL, &err) == BAKE_EINVAL);
	CHECK(strcmp(err.msg, "x: png holds no half values") == 0);
	fclose(f);
	f = fopen("/dev/full", "w");
	if (f == NULL)
		return;
	err = (struct bake_err)BAKE_ERR_INIT;
	params = params_of(6);
	CHECK(bake_pixels_write(&px, &params, f, "x", NULL, &err) == BAKE_EIO);
	CHECK(err.msg[0] != '\0');
	fclose(f);
}

static void
same_bytes_a_second_later(void)
{
	struct bake_image img[NKINDS];
	struct bytes first[NKINDS];

	for (int kind = 0; kind < NKINDS; kind++) {
		struct bake_write_params params = params_of(kind);

		img[kind] = any_image(31, 67, 4, kinds[kind].format);
		bake_attrs_set(&params.attrs, "Layout", "relief");
		first[kind] = encode(&img[kind], &params);
	}
	usleep(1100000);
	for (int kind = 0; kind < NKINDS; kind++) {
		struct bake_write_params params = params_of(kind);
		struct bytes b;

		bake_attrs_set(&params.attrs, "Layout", "relief");
		b = encode(&img[kind], &params);
		CHECK(b.n == first[kind].n);
		CHECK(memcmp(b.p, first[kind].p, b.n) == 0);
		/* nor does the file say who made it */
		CHECK(memmem(b.p, b.n, "OpenImageIO", 11) == NULL);
		bake_image_free(&img[kind]);
		free(first[kind].p);
		free(b.p);
	}
}

static void
channels_are_read_apart(void)
{
	static const int bad[][2] = { { -1, 1 }, { 0, 0 }, { 0, 5 }, { 4, 1 },
		{ 3, 2 }, { 0, -1 }, { INT_MAX, 1 }, { 0, INT_MAX },
		{ 2, INT_MAX }, { INT_MIN, 1 }, { 1, INT_MIN },
		{ INT_MAX, INT_MAX } };
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;

	for (int kind = 0; kind < NKINDS; kind++) {
		struct bake_write_params params = params_of(kind);
		struct bake_image img = any_image(5, 66, 4, kinds[kind].format);
		struct bake_image_info info;
		struct bake_reader *r;
		struct bake_err err = BAKE_ERR_INIT;
		struct bytes b = encode(&img, &params);

		CHECK_OK(bake_reader_open_memory(&r, b.p, b.n, kinds[kind].name,
			     &limits, &info, &err),
		    err);
		for (int i = 0; r != NULL && i < 16; i++) {
			int first = i / 4, n = i % 4 + 1;
			struct bake_image part = BAKE_IMAGE_INIT;

			if (first + n > 4)
				continue;
			CHECK_OK(
			    bake_reader_read(r, first, n, &part, &err), err);
			CHECK(part.width == 5 && part.height == 66 &&
			      part.nchans == n);
			for (int k = 0; k < 5 * 66 * n; k++)
				CHECK(memcmp(&part.data[k],
					  &img.data[k / n * 4 + first + k % n],
					  4) == 0);
			bake_image_free(&part);
		}
		for (size_t i = 0; r != NULL && i < sizeof bad / sizeof *bad;
		     i++) {
			struct bake_image part = BAKE_IMAGE_INIT;

			err = (struct bake_err)BAKE_ERR_INIT;
			CHECK(bake_reader_read(r, bad[i][0], bad[i][1], &part,
				  &err) == BAKE_EINVAL);
			CHECK(part.data == NULL);
			CHECK(strncmp(err.msg, kinds[kind].name,
				  strlen(kinds[kind].name)) == 0);
		}
		bake_reader_close(r);
		bake_image_free(&img);
		free(b.p);
	}
	bake_reader_close(NULL); /* harmless */
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(every_bit_comes_back),
		CASE(every_code_comes_back),
		CASE(every_half_comes_back),
		CASE(views_are_written_row_by_row),
		CASE(clipped_values_are_counted),
		CASE(many_channels_come_back),
		CASE(names_stay_with_their_channels),
		CASE(metadata_come_back),
		CASE(metadata_are_never_cut),
		CASE(layer_metadata_come_back),
		CASE(pixels_are_written_as_images_are),
		CASE(half_pixels_are_not_touched),
		CASE(pixels_need_a_file_that_holds_them),
		CASE(same_bytes_a_second_later),
		CASE(channels_are_read_apart),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
