/* Colour spaces: linear light, names, $OCIO, what must not be touched. */
/* SPDX-License-Identifier: MIT */
#include "color.h"

#include <unistd.h>

#include "check.h"
#include "codes.h"
#include "test_maps.h"

static const char *const spaces[] = { "sRGB", "Linear Rec.709", "Rec.709",
	"Gamma 1.8 Rec.709", "Gamma 2.2 Rec.709", "Gamma 2.4 Rec.709",
	"Display P3", "Linear P3-D65", "Linear Rec.2020", "ACEScg",
	"ACES2065-1", "Raw" };
enum { NSPACES = sizeof spaces / sizeof *spaces };

static struct bake_color *
open_builtin(void)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_color *color;

	unsetenv("OCIO");
	CHECK_OK(bake_color_open(NULL, &color, &err), err);
	if (color == NULL)
		abort();
	return color;
}

static void
to_linear(
    const struct bake_color *color, const char *space, struct bake_image *img)
{
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_color_to_linear(color, space, img, 0, &err), err);
}

static void
from_linear(
    const struct bake_color *color, const char *space, struct bake_image *img)
{
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_color_from_linear(color, space, img, 0, &err), err);
}

static void
half_black_and_white_is_188(void)
{
	struct bake_color *color = open_builtin();
	struct bake_image img = image(3, 1, 3);
	uint8_t code[9];

	for (int c = 0; c < 3; c++) {
		img.data[c] = 0;
		img.data[3 + c] = 1;
	}
	to_linear(color, "sRGB", &img);
	for (int c = 0; c < 3; c++) {
		CHECK(img.data[c] == 0);
		CHECK(img.data[3 + c] == 1);
		img.data[6 + c] = 0.5f * img.data[c] + 0.5f * img.data[3 + c];
	}
	from_linear(color, "sRGB", &img);
	bake_codes_to_u8(code, img.data, 9);
	for (int c = 0; c < 3; c++) {
		CHECK(code[c] == 0 && code[3 + c] == 255);
		CHECK(code[6 + c] == 188); /* 128 in encoded values */
	}
	bake_image_free(&img);
	bake_color_close(color);
}

/* IEC 61966-2-1 with its rounded constants, which break at 0.04045. */
static double
srgb(double v)
{
	return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static void
srgb_is_the_standard_curve(void)
{
	struct bake_color *color = open_builtin();
	struct bake_image img = image(256, 256, 1);
	double worst = 0;

	for (int i = 0; i < 65536; i++)
		img.data[i] = (float)(i / 65535.0);
	to_linear(color, "sRGB", &img);
	for (int i = 0; i < 65536; i++)
		worst = fmax(worst, fabs(img.data[i] - srgb(i / 65535.0)));
	/* the smooth break's slope is 12.9232: 0.04045 / 12.92 * 2.5e-4 =
	 * 8e-7 at most, and two roundings of floats below 1 */
	CHECK_NEAR(worst, 0, 1e-6);
	bake_image_free(&img);
	bake_color_close(color);
}

/* Powers to an ulp, where the library may have fast ones: the exponent is a
 * float as well. */
static void
powers_are_exact(void)
{
	struct bake_color *color = open_builtin();
	struct bake_image img = image(256, 256, 1);
	double worst = 0;

	for (int i = 0; i < 65536; i++)
		img.data[i] = (float)(i / 65535.0);
	to_linear(color, "Gamma 2.2 Rec.709", &img);
	for (int i = 1; i < 65536; i++) {
		double v = (float)(i / 65535.0), want = pow(v, 2.2f);

		worst = fmax(worst, fabs(img.data[i] - want) / want);
	}
	CHECK_NEAR(worst, 0, 0x1p-23);
	bake_image_free(&img);
	bake_color_close(color);
}

/* Every code in every channel, in triples that are scattered and, for half of
 * them, saturated. */
static void
codes_return(const struct bake_color *color, const char *space, int max)
{
	struct bake_image img = image(256, 2 * (max + 1) / 256, 3);
	const size_t n = nfloats(&img);
	int *code = calloc(n, sizeof *code);
	int nwrong = 0;

	for (size_t i = 0; i < n; i++) {
		uint32_t h = hash((uint32_t)i);
		int at = (int)(i / 3) % (max + 1);

		code[i] = i % 3 == i / 3 % 3 ? at
			  : i < n / 2        ? (int)(h % ((uint32_t)max + 1))
			  : h & 1            ? max
					     : 0;
		img.data[i] = (float)((double)code[i] / max);
	}
	to_linear(color, space, &img);
	from_linear(color, space, &img);
	for (size_t i = 0; i < n; i++)
		nwrong +=
		    (int)floor(img.data[i] * (double)max + 0.5) != code[i];
	if (nwrong != 0)
		printf("%s, %d: %d codes\n", space, max, nwrong);
	CHECK(nwrong == 0);
	free(code);
	bake_image_free(&img);
}

static void
all_codes_return(void)
{
	struct bake_color *color = open_builtin();

	for (int s = 0; s < NSPACES; s++) {
		codes_return(color, spaces[s], 255);
		codes_return(color, spaces[s], 65535);
	}
	bake_color_close(color);
}

static void
white_stays_white(void)
{
	struct bake_color *color = open_builtin();

	for (int s = 0; s < NSPACES; s++) {
		struct bake_image img = image(1, 1, 3);

		for (int c = 0; c < 3; c++)
			img.data[c] = 1;
		to_linear(color, spaces[s], &img);
		/* rows of 13 digits add up to 1; 3 products are rounded */
		for (int c = 0; c < 3; c++)
			CHECK_NEAR(img.data[c], 1, 5e-7);
		bake_image_free(&img);
	}
	bake_color_close(color);
}

/* The chromaticity of linear Rec.709, by the matrix of IEC 61966-2-1. */
static void
chromaticity(const float *rgb, double *x, double *y)
{
	double xyz[3] = { 0.4124 * rgb[0] + 0.3576 * rgb[1] + 0.1805 * rgb[2],
		0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2],
		0.0193 * rgb[0] + 0.1192 * rgb[1] + 0.9505 * rgb[2] };
	double sum = xyz[0] + xyz[1] + xyz[2];

	*x = xyz[0] / sum;
	*y = xyz[1] / sum;
}

static void
primaries_are_the_published_ones(void)
{
	static const struct {
		const char *space;
		double xy[3][2];
	} d65[] = {
		{ "Linear P3-D65",
		    { { 0.680, 0.320 }, { 0.265, 0.690 }, { 0.150, 0.060 } } },
		{ "Display P3",
		    { { 0.680, 0.320 }, { 0.265, 0.690 }, { 0.150, 0.060 } } },
		{ "Linear Rec.2020",
		    { { 0.708, 0.292 }, { 0.170, 0.797 }, { 0.131, 0.046 } } },
	};
	/* ACES, AP1 to Rec.709 with Bradford's adaptation, columns */
	static const double ap1[9] = { 1.70505, -0.13026, -0.02400, -0.62179,
		1.14080, -0.12897, -0.08326, -0.01055, 1.15297 };
	struct bake_color *color = open_builtin();
	struct bake_image img = image(3, 1, 3);

	for (size_t s = 0; s < 3; s++) {
		for (int i = 0; i < 9; i++)
			img.data[i] = i % 4 == 0;
		to_linear(color, d65[s].space, &img);
		for (int p = 0; p < 3; p++) {
			double x, y;

			chromaticity(img.data + 3 * p, &x, &y);
			/* the matrix above has 4 digits */
			CHECK_NEAR(x, d65[s].xy[p][0], 5e-4);
			CHECK_NEAR(y, d65[s].xy[p][1], 5e-4);
		}
	}
	for (int i = 0; i < 9; i++)
		img.data[i] = i % 4 == 0;
	to_linear(color, "ACEScg", &img);
	for (int i = 0; i < 9; i++)
		CHECK_NEAR(img.data[i], ap1[i], 6e-6);
	bake_image_free(&img);
	bake_color_close(color);
}

static void
alpha_and_data_keep_their_bits(void)
{
	struct bake_color *color = open_builtin();
	struct bake_image img = noise(31, 7, 6), was = noise(31, 7, 6);

	img.data[3] = was.data[3] = NAN;
	img.data[9] = was.data[9] = -INFINITY;
	to_linear(color, "ACEScg", &img);
	for (size_t i = 0; i < nfloats(&img); i++)
		if (i % 6 > 2)
			CHECK(memcmp(&img.data[i], &was.data[i],
				  sizeof(float)) == 0);
	CHECK(img.data[6] != was.data[6]);
	bake_image_free(&img);

	img = noise(31, 7, 6);
	img.data[0] = was.data[0] = NAN;
	img.data[1] = was.data[1] = -7;
	img.data[3] = NAN;
	img.data[9] = -INFINITY;
	to_linear(color, "raw", &img);
	from_linear(color, "data", &img);
	to_linear(color, "linear", &img);
	CHECK(memcmp(img.data, was.data, nfloats(&img) * sizeof(float)) == 0);
	bake_image_free(&img);
	bake_image_free(&was);
	bake_color_close(color);
}

static void
grey_is_r_g_b_alike(void)
{
	struct bake_color *color = open_builtin();

	for (int s = 0; s < NSPACES; s++) {
		struct bake_image one = noise(16, 16, 1);
		struct bake_image two = image(16, 16, 2);
		struct bake_image rgb = image(16, 16, 3);

		for (int i = 0; i < 256; i++) {
			two.data[2 * i] = one.data[i];
			two.data[2 * i + 1] = 0.25f;
			for (int c = 0; c < 3; c++)
				rgb.data[3 * i + c] = one.data[i];
		}
		to_linear(color, spaces[s], &one);
		to_linear(color, spaces[s], &two);
		to_linear(color, spaces[s], &rgb);
		for (int i = 0; i < 256; i++) {
			CHECK(one.data[i] == rgb.data[3 * i + 1]);
			CHECK(two.data[2 * i] == rgb.data[3 * i + 1]);
			CHECK(two.data[2 * i + 1] == 0.25f);
		}
		bake_image_free(&one);
		bake_image_free(&two);
		bake_image_free(&rgb);
	}
	bake_color_close(color);
}

static void
beyond_0_and_1_goes_there_and_back(void)
{
	static const float values[] = { -4, -0.5f, -0.001f, 1.5f, 16, 1000 };
	struct bake_color *color = open_builtin();

	for (int s = 0; s < NSPACES; s++) {
		struct bake_image img = image(6, 1, 1);

		memcpy(img.data, values, sizeof values);
		to_linear(color, spaces[s], &img);
		for (int i = 1; i < 6; i++)
			CHECK(img.data[i] > img.data[i - 1]);
		CHECK(img.data[2] < 0 && img.data[3] > 1);
		from_linear(color, spaces[s], &img);
		/* a power of 2.4 and its root: some roundings each */
		for (int i = 0; i < 6; i++)
			CHECK_NEAR(img.data[i], values[i],
			    2e-6 * fabs((double)values[i]));
		bake_image_free(&img);
	}
	bake_color_close(color);
}

static void
a_nan_stays_in_its_texel(void)
{
	struct bake_color *color = open_builtin();

	for (int s = 0; s < NSPACES; s++) {
		struct bake_image img = noise(17, 9, 4), bad = noise(17, 9, 4);
		int nwrong = 0;

		bad.data[4 * 40] = NAN;
		bad.data[4 * 60 + 1] = INFINITY;
		bad.data[4 * 61 + 2] = -INFINITY;
		to_linear(color, spaces[s], &img);
		to_linear(color, spaces[s], &bad);
		for (int i = 0; i < 17 * 9; i++)
			if (i != 40 && i != 60 && i != 61)
				nwrong +=
				    memcmp(img.data + 4 * i, bad.data + 4 * i,
					4 * sizeof(float)) != 0;
		CHECK(nwrong == 0);
		bake_image_free(&img);
		bake_image_free(&bad);
	}
	bake_color_close(color);
}

static void
names_are_those_that_users_expect(void)
{
	static const char *const names[][2] = { { "sRGB", "srgb" },
		{ "sRGB", "SRGB" }, { "sRGB", "sRGB - Texture" },
		{ "sRGB", "srgb_texture" },
		{ "sRGB", "Utility - sRGB - Texture" },
		{ "Linear Rec.709", "Linear" },
		{ "Linear Rec.709", "lin_rec709" },
		{ "Linear Rec.709", "lin_srgb" },
		{ "Linear Rec.709", "scene_linear" },
		{ "Gamma 2.2 Rec.709", "gamma22" },
		{ "Gamma 2.2 Rec.709", "g22_rec709" }, { "Rec.709", "rec709" },
		{ "ACEScg", "acescg" }, { "ACEScg", "lin_ap1" },
		{ "ACES2065-1", "lin_ap0" }, { "Raw", "Non-Color" },
		{ "Raw", "data" } };
	struct bake_color *color = open_builtin();
	struct bake_err err = BAKE_ERR_INIT;

	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		struct bake_image a = noise(8, 8, 3), b = noise(8, 8, 3);

		CHECK_OK(bake_color_check(color, names[i][1], &err), err);
		to_linear(color, names[i][0], &a);
		to_linear(color, names[i][1], &b);
		CHECK(memcmp(a.data, b.data, nfloats(&a) * sizeof(float)) == 0);
		bake_image_free(&a);
		bake_image_free(&b);
	}
	bake_color_close(color);
}

static void
an_unknown_space_is_answered_with_a_list(void)
{
	struct bake_color *color = open_builtin();
	struct bake_image img = noise(4, 4, 3), was = noise(4, 4, 3);
	struct bake_image empty = BAKE_IMAGE_INIT;

	for (int k = 0; k < 3; k++) {
		struct bake_err err = BAKE_ERR_INIT;
		enum bake_status rc =
		    k == 0 ? bake_color_check(color, "sRBG", &err)
		    : k == 1
			? bake_color_to_linear(color, "sRBG", &img, 1, &err)
			: bake_color_from_linear(color, "sRBG", &img, 1, &err);

		CHECK(rc == BAKE_EINVAL);
		CHECK(strstr(err.msg, "'sRBG' is no colour space") != NULL);
		for (int s = 0; s < NSPACES; s++)
			CHECK(strstr(err.msg, spaces[s]) != NULL);
	}
	CHECK(memcmp(img.data, was.data, nfloats(&img) * sizeof(float)) == 0);
	for (int k = 0; k < 2; k++) {
		struct bake_err err = BAKE_ERR_INIT;

		CHECK(bake_color_to_linear(color, "sRGB", k ? &img : &empty,
			  k ? -1 : 1, &err) == BAKE_EINVAL);
		CHECK(err.msg[0] != '\0');
	}
	bake_image_free(&img);
	bake_image_free(&was);
	bake_color_close(color);
}

static void
threads_and_bands_change_no_bit(void)
{
	struct bake_color *color = open_builtin();

	for (int s = 0; s < NSPACES; s++) {
		struct bake_image one = noise(67, 33, 3);
		struct bake_image many = noise(67, 33, 3);
		struct bake_image bands = noise(67, 33, 3);
		const size_t n = nfloats(&one) * sizeof(float);
		struct bake_err err = BAKE_ERR_INIT;

		CHECK_OK(
		    bake_color_to_linear(color, spaces[s], &one, 1, &err), err);
		CHECK_OK(bake_color_to_linear(color, spaces[s], &many, 7, &err),
		    err);
		/* one color, used by several threads, on parts */
#pragma omp parallel for num_threads(4)
		for (int x = 0; x < 67; x++) {
			struct bake_image column = bands;
			struct bake_err e = BAKE_ERR_INIT;

			column.data += 3 * x;
			column.width = 1;
			bake_color_to_linear(color, spaces[s], &column, 1, &e);
		}
		CHECK(memcmp(one.data, many.data, n) == 0);
		CHECK(memcmp(one.data, bands.data, n) == 0);
		bake_image_free(&one);
		bake_image_free(&many);
		bake_image_free(&bands);
	}
	bake_color_close(color);
}

/* -- configurations ----------------------------------------------------- */

/* Values are squared; not strict, so that the library by itself would take
 * its default space for an unknown one. */
static const char squares[] = "ocio_profile_version: 1\n"
			      "strictparsing: false\n"
			      "roles:\n"
			      "  default: squared\n"
			      "%s"
			      "displays:\n"
			      "  d:\n"
			      "    - !<View> {name: v, colorspace: squared}\n"
			      "colorspaces:\n"
			      "  - !<ColorSpace>\n"
			      "    name: light\n"
			      "  - !<ColorSpace>\n"
			      "    name: squared\n"
			      "    to_reference: !<ExponentTransform> "
			      "{value: [2, 2, 2, 1]}\n"
			      "  - !<ColorSpace>\n"
			      "    name: tabled\n"
			      "    to_reference: !<FileTransform> "
			      "{src: not_there.spi1d, interpolation: linear}\n";

static void
write_config(char *path, const char *text, const char *roles)
{
	FILE *f;

	strcpy(path, "/tmp/t_color.XXXXXX");
	f = fdopen(mkstemp(path), "w");
	if (f == NULL)
		abort();
	fprintf(f, text, roles);
	fclose(f);
}

static void
the_environments_configuration_counts(void)
{
	struct bake_color *color;
	struct bake_err err = BAKE_ERR_INIT, bad = BAKE_ERR_INIT;
	struct bake_err table = BAKE_ERR_INIT;
	struct bake_image img = noise(16, 16, 3), was = noise(16, 16, 3);
	char path[64];

	write_config(path, squares, "  scene_linear: light\n");
	setenv("OCIO", path, 1);
	CHECK_OK(bake_color_open(NULL, &color, &err), err);
	CHECK(strcmp(bake_color_path(color), path) == 0);
	to_linear(color, "squared", &img);
	for (size_t i = 0; i < nfloats(&img); i++)
		/* one power, correctly rounded but for an ulp */
		CHECK_NEAR(img.data[i], was.data[i] * was.data[i], 1.2e-7);
	CHECK(bake_color_check(color, "sRGB", &bad) == BAKE_EINVAL);
	CHECK(strstr(bad.msg, "light, squared, tabled") != NULL);
	CHECK(strstr(bad.msg, path) != NULL);
	CHECK(bake_color_check(color, "tabled", &table) == BAKE_EDATA);
	CHECK(strstr(table.msg, "not_there.spi1d") != NULL);
	CHECK(strchr(table.msg, '\n') == NULL);
	bake_color_close(color);

	/* a path that is given comes before it; empty is not set */
	setenv("OCIO", "/nonexistent/config.ocio", 1);
	CHECK_OK(bake_color_open(path, &color, &err), err);
	bake_color_close(color);
	setenv("OCIO", "", 1);
	CHECK_OK(bake_color_open(NULL, &color, &err), err);
	CHECK(bake_color_path(color) == NULL);
	CHECK_OK(bake_color_check(color, "sRGB", &err), err);
	bake_color_close(color);
	unsetenv("OCIO");
	remove(path);
	bake_image_free(&img);
	bake_image_free(&was);
}

static void
a_broken_configuration_is_named(void)
{
	static const struct {
		const char *text, *roles, *says;
	} bad[] = {
		{ "%s", "this: is\n  not: [a config\n", "" },
		{ "%s", "", "" },
		{ squares, "", "scene_linear" },
	};
	struct bake_color *color;

	for (int k = 0; k < 3; k++) {
		struct bake_err err = BAKE_ERR_INIT;
		char path[64];

		write_config(path, bad[k].text, bad[k].roles);
		setenv("OCIO", path, 1);
		CHECK(bake_color_open(NULL, &color, &err) == BAKE_EDATA);
		CHECK(color == NULL);
		CHECK(strstr(err.msg, path) != NULL);
		CHECK(strstr(err.msg, bad[k].says) != NULL);
		CHECK(strchr(err.msg, '\n') == NULL);
		remove(path);
	}
	for (int k = 0; k < 2; k++) {
		struct bake_err err = BAKE_ERR_INIT;
		const char *path = k ? "/nonexistent/config.ocio" : "/tmp";

		setenv("OCIO", path, 1);
		CHECK(bake_color_open(NULL, &color, &err) == BAKE_EIO);
		CHECK(strstr(err.msg, path) != NULL);
	}
	unsetenv("OCIO");
	bake_color_close(NULL);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(half_black_and_white_is_188),
		CASE(srgb_is_the_standard_curve),
		CASE(powers_are_exact),
		CASE(all_codes_return),
		CASE(white_stays_white),
		CASE(primaries_are_the_published_ones),
		CASE(alpha_and_data_keep_their_bits),
		CASE(grey_is_r_g_b_alike),
		CASE(beyond_0_and_1_goes_there_and_back),
		CASE(a_nan_stays_in_its_texel),
		CASE(names_are_those_that_users_expect),
		CASE(an_unknown_space_is_answered_with_a_list),
		CASE(threads_and_bands_change_no_bit),
		CASE(the_environments_configuration_counts),
		CASE(a_broken_configuration_is_named),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
