/* The remap on images: colours, light maps, tables, fits, renders, tones. */
/* SPDX-License-Identifier: MIT */
#include "test_roughen.h"

#include "roughen_picture.h"

static const double pi = 3.14159265358979323846;
static const double luma[3] = { 0.2126, 0.7152, 0.0722 };

static struct bake_image
colors(int width, int height, int nchans)
{
	struct bake_image img = new_image(width, height, nchans);
	uint32_t state = 11;

	for (int i = 0; i < width * height * nchans; i++)
		img.data[i] = (float)test_random(&state);
	return img;
}

static void
grey_texels_have_their_own_luminance(void)
{
	struct bake_image img = new_image(256, 1, 3), lum = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	for (int i = 0; i < 3 * 256; i++)
		img.data[i] = (float)(i / 3) / 255;
	CHECK_OK(bake_roughen_luminance(&img, luma, 2, &lum, &err), err);
	for (int i = 0; i < 256; i++)
		CHECK(lum.data[i] == (float)i / 255);
	bake_image_free(&img);
	bake_image_free(&lum);
}

static void
colours_keep_their_chromaticity_and_alpha_its_bits(void)
{
	struct bake_image img = colors(37, 23, 4), was = colors(37, 23, 4);
	struct bake_image lum = BAKE_IMAGE_INIT;
	struct bake_roughen_light light = { .cos_map = NULL };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_roughen r;

	bake_roughen_angle(65, &light.cos_theta, &light.sin_theta);
	CHECK_OK(bake_roughen_luminance(&img, luma, 1, &lum, &err), err);
	r = remap_of(BAKE_ROUGHEN_FACET, 0.09, &lum);
	CHECK_OK(bake_roughen_apply(&r, &light, &lum, &img, 3, &err), err);
	for (int i = 0; i < 37 * 23; i++) {
		const float *a = was.data + 4 * i, *b = img.data + 4 * i;
		const double g = bake_roughen_gain(
		    &r, lum.data[i], light.cos_theta, light.sin_theta);

		for (int k = 0; k < 3; k++)
			CHECK(b[k] == (float)(g * a[k]));
		CHECK(memcmp(&a[3], &b[3], sizeof *a) == 0);
	}
	bake_image_free(&img);
	bake_image_free(&was);
	bake_image_free(&lum);
}

/* Under each instruction set: strengths within and beyond what the kernels are
 * for, a width that leaves a rest, values at and around the median. */
static void
kernels_give_the_bits_of_the_plain_function(void)
{
	static const char *const isas[] = { "baseline", "avx2", "avx512" };
	const double strengths[] = { 0, 0.09, 0.25, 0.5, 1 };
	const int n = 3 * 64 + 5;
	struct bake_image lum = colors(n, 2, 1), img = colors(n, 2, 1);
	struct bake_image cosines = colors(n, 2, 1);
	struct bake_roughen_light light = { .cos_map = &cosines };
	struct bake_err err = BAKE_ERR_INIT;

	lum.data[7] = lum.data[8] = 0.5f;
	cosines.data[9] = -0.3f;
	for (int i = 0; i < 3 * 2 * 5; i++) {
		struct bake_roughen r = remap_of(
		    i % 2 == 0 ? BAKE_ROUGHEN_FACET : BAKE_ROUGHEN_PAPER,
		    strengths[i / 2 % 5], &lum);

		setenv("BAKE_ISA", isas[i / 10], 1);
		r.median = 0.5;
		for (int k = 0; k < 2 * n; k++)
			img.data[k] = 1;
		CHECK_OK(
		    bake_roughen_apply(&r, &light, &lum, &img, 1, &err), err);
		for (int k = 0; k < 2 * n; k++) {
			const double c = cosines.data[k];

			CHECK(img.data[k] == (float)bake_roughen_gain(&r,
						 lum.data[k], c,
						 sqrt(1 - c * c)));
		}
	}
	unsetenv("BAKE_ISA");
	bake_image_free(&lum);
	bake_image_free(&img);
	bake_image_free(&cosines);
}

static void
a_map_of_one_angle_is_that_angle(void)
{
	struct bake_image one = colors(40, 30, 2), map = colors(40, 30, 2);
	struct bake_image many = colors(40, 30, 2);
	struct bake_image lum = BAKE_IMAGE_INIT, angle = new_image(40, 30, 1);
	struct bake_roughen_light light = { .cos_map = NULL };
	struct bake_err err = BAKE_ERR_INIT;

	for (int i = 0; i < 40 * 30; i++)
		angle.data[i] = 60;
	bake_roughen_cos_from_angles(&angle, 2);
	CHECK_OK(bake_roughen_luminance(&one, luma, 1, &lum, &err), err);
	for (int m = 0; m < BAKE_ROUGHEN_MODELS; m++) {
		struct bake_roughen r =
		    remap_of((enum bake_roughen_model)m, 0.2, &lum);

		/* cos 60 = 0.5 in float and in double */
		light.cos_map = NULL;
		light.cos_theta = 0.5;
		light.sin_theta = sqrt(0.75);
		CHECK_OK(
		    bake_roughen_apply(&r, &light, &lum, &one, 1, &err), err);
		light.cos_map = &angle;
		CHECK_OK(
		    bake_roughen_apply(&r, &light, &lum, &map, 1, &err), err);
		CHECK_OK(
		    bake_roughen_apply(&r, &light, &lum, &many, 7, &err), err);
		CHECK(memcmp(one.data, map.data, sizeof(float) * 40 * 30 * 2) ==
		      0);
		CHECK(memcmp(one.data, many.data,
			  sizeof(float) * 40 * 30 * 2) == 0);
	}
	angle.height = 29;
	{
		struct bake_roughen r = remap_of(BAKE_ROUGHEN_FLAT, 0, &lum);

		CHECK(bake_roughen_apply(&r, &light, &lum, &one, 1, &err) ==
		      BAKE_EINVAL);
	}
	bake_image_free(&one);
	bake_image_free(&map);
	bake_image_free(&many);
	bake_image_free(&lum);
	bake_image_free(&angle);
}

static void
normals_and_a_light_give_the_angle_between(void)
{
	struct bake_image n = new_image(5, 1, 3);
	const float v[5][3] = { { 0, 0, 1 }, { 0, 0, 7 }, { 1, 0, 0 },
		{ 0, 0, 0 }, { -3, 0, 4 } };
	const double light[3] = { 3e200, 0, 4e200 };
	const double want[5] = { 0.8, 0.8, 0.6, 0.8, 0.28 };

	memcpy(n.data, v, sizeof v);
	bake_roughen_cos_from_normals(&n, light, 2);
	for (int i = 0; i < 5; i++)
		/* half an ulp of float */
		CHECK_NEAR(n.data[3 * i], want[i], 6e-8);
	bake_image_free(&n);
}

/* -- tables -----------------------------------------------------------------
 */

static void
check_table(
    enum bake_roughen_model model, double s, int width, int height, double most)
{
	const struct bake_roughen_stats stats = { 0.31, 0.5, 0.62 };
	struct bake_image lut = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_roughen r;

	CHECK_OK(bake_roughen_init(&r, model, s, &stats, &err), err);
	CHECK_OK(bake_roughen_lut(&r, width, height, &lut, &err), err);
	for (int i = 0; i < width * height; i++)
		CHECK(lut.data[i] >= 0 && lut.data[i] <= 1);
	for (double t = 0; t <= 1; t += 1.0 / 509)
		for (double a = 0; a <= 180; a += 0.77) {
			double c, sn;

			bake_roughen_angle(a, &c, &sn);
			CHECK_NEAR(t * bake_roughen_lut_gain(&r, &lut, t, c),
			    t * bake_roughen_gain(&r, t, c, sn), most);
		}
	CHECK(bake_roughen_lut_error(&r, &lut, 1) <= most);
	/* the median itself, where the paper's formula jumps */
	CHECK_NEAR(bake_roughen_lut_gain(&r, &lut, 0.5, 0.6), 0.6, most / 0.5);
	bake_image_free(&lut);
}

static void
a_table_gives_what_the_formula_gives(void)
{
	/* the linear filter's error is (step^2 / 8) times the second
	 * derivative, 4 and more in sin(theta / 2), so 2e-4 at 64 rows */
	check_table(BAKE_ROUGHEN_FLAT, 0.09, 64, 64, 6e-4);
	check_table(BAKE_ROUGHEN_FACET, 0.09, 64, 64, 6e-4);
	check_table(BAKE_ROUGHEN_PAPER, 0.09, 64, 64, 6e-4);
	check_table(BAKE_ROUGHEN_FACET, 0.5, 64, 64, 1.0 / 255);
	check_table(BAKE_ROUGHEN_PAPER, 0.5, 64, 64, 1.0 / 255);
	check_table(BAKE_ROUGHEN_PAPER, 0.09, 65, 33, 1.0 / 255);
}

static void
tables_that_cannot_be_are_errors(void)
{
	const struct bake_roughen_stats stats = { 0.31, 0.5, 0.62 };
	struct bake_image lut = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_roughen r;

	CHECK_OK(
	    bake_roughen_init(&r, BAKE_ROUGHEN_BLACKSHOT, 0.09, &stats, &err),
	    err);
	CHECK(bake_roughen_lut(&r, 64, 64, &lut, &err) == BAKE_EINVAL);
	r.model = BAKE_ROUGHEN_FACET;
	CHECK(bake_roughen_lut(&r, 7, 64, &lut, &err) == BAKE_EINVAL);
	CHECK(bake_roughen_lut(&r, 64, 4097, &lut, &err) == BAKE_EINVAL);
	CHECK(lut.data == NULL);
}

/* -- fits -------------------------------------------------------------------
 */

static void
a_fit_finds_the_strength_that_made_the_contrasts(void)
{
	struct bake_image lum = gaussian_texture(200, 150, 0.5, 0.05);
	struct bake_roughen_target target = { .n = 8 };
	const enum bake_roughen_model models[] = { BAKE_ROUGHEN_FACET,
		BAKE_ROUGHEN_PAPER };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_roughen_stats stats;
	double error, contrast[8];

	for (int m = 0; m < 2; m++) {
		struct bake_roughen r = remap_of(models[m], 0.137, &lum);

		for (int i = 0; i < 8; i++) {
			target.angle_deg[i] = 10 * (i + 1);
			CHECK_OK(bake_roughen_lit_stats(&r, target.angle_deg[i],
				     &lum, 1, &stats, &err),
			    err);
			target.contrast[i] = bake_roughen_contrast(&stats);
		}
		target.contrast[3] = INFINITY;
		r.strength = 0;
		CHECK_OK(bake_roughen_fit(
			     &r, &lum, &target, 1, &error, contrast, &err),
		    err);
		/* 2048 quantiles know the percentiles, and so the contrast,
		 * within about 1 / 2048 of the ranks */
		CHECK_NEAR(r.strength, 0.137, 1e-3);
		CHECK_NEAR(contrast[7] / target.contrast[7], 1, 1e-2);
		CHECK(error < 1e-2);
	}
	bake_image_free(&lum);
}

static void
a_fit_needs_a_contrast(void)
{
	struct bake_image lum = gaussian_texture(20, 20, 0.5, 0.05);
	struct bake_roughen r = remap_of(BAKE_ROUGHEN_FACET, 0.1, &lum);
	struct bake_roughen_target target = { .n = 2,
		.contrast = { INFINITY, 0 } };
	struct bake_err err = BAKE_ERR_INIT;
	double error;

	CHECK(bake_roughen_fit(&r, &lum, &target, 1, &error, NULL, &err) ==
	      BAKE_EDATA);
	bake_image_free(&lum);
}

/* -- renders ----------------------------------------------------------------
 */

static void
a_plane_is_lit_by_the_cosine(void)
{
	struct bake_image depth = new_image(70, 20, 1), lit[2];
	struct bake_roughen_scene scene = { .scale = 0.3, .azimuth_deg = 33 };
	const double angles[2] = { 0, 60 };
	struct bake_err err = BAKE_ERR_INIT;

	for (int i = 0; i < 70 * 20; i++)
		depth.data[i] = 0.4f;
	lit[0] = lit[1] = (struct bake_image)BAKE_IMAGE_INIT;
	CHECK_OK(
	    bake_roughen_render(&depth, &scene, angles, 2, lit, &err), err);
	for (int i = 0; i < 70 * 20; i++) {
		CHECK(lit[0].data[i] == 1);
		CHECK_NEAR(lit[1].data[i], 0.5, 6e-8);
	}
	for (int i = 0; i < 2; i++)
		bake_image_free(&lit[i]);
	bake_image_free(&depth);
}

/* A wall across the map, high on columns 100 to 119: lit from the left at
 * theta, its shadow is height tan(theta) long. */
static void
a_wall_casts_a_shadow_of_its_height_times_tan(void)
{
	const int width = 256;
	struct bake_image depth = new_image(width, 4, 1);
	struct bake_image lit = BAKE_IMAGE_INIT;
	/* 20 texels high */
	struct bake_roughen_scene scene = { .scale = 20.0 / 256,
		.azimuth_deg = 180 };
	const double angle = 60;
	const int length = (int)(20 * tan(angle * pi / 180)); /* 34 */
	struct bake_err err = BAKE_ERR_INIT;

	for (int i = 0; i < width * 4; i++)
		depth.data[i] = i % width >= 100 && i % width < 120 ? 0 : 1;
	CHECK_OK(
	    bake_roughen_render(&depth, &scene, &angle, 1, &lit, &err), err);
	for (int x = 121; x < width; x++) {
		const bool shadow = x - 119 <= length;

		CHECK_NEAR(lit.data[x], shadow ? 0 : 0.5, 1e-7);
	}
	for (int x = 0; x < 99; x++)
		CHECK_NEAR(lit.data[x], 0.5, 1e-7);
	bake_image_free(&lit);
	bake_image_free(&depth);
}

static void
scenes_that_cannot_be_are_errors(void)
{
	struct bake_image depth = new_image(8, 8, 1), lit = BAKE_IMAGE_INIT;
	struct bake_roughen_scene scene = { .scale = -1 };
	double angle = 30;
	struct bake_err err = BAKE_ERR_INIT;

	memset(depth.data, 0, 64 * sizeof(float));
	CHECK(bake_roughen_render(&depth, &scene, &angle, 1, &lit, &err) ==
	      BAKE_EINVAL);
	scene.scale = 0.1;
	angle = 91;
	CHECK(bake_roughen_render(&depth, &scene, &angle, 1, &lit, &err) ==
	      BAKE_EINVAL);
	angle = 30;
	CHECK(bake_roughen_render(&depth, &scene, &angle, 0, &lit, &err) ==
	      BAKE_EINVAL);
	scene.azimuth_deg = NAN;
	CHECK(bake_roughen_render(&depth, &scene, &angle, 1, &lit, &err) ==
	      BAKE_EINVAL);
	CHECK(lit.data == NULL);
	bake_image_free(&depth);
}

/* -- tones ------------------------------------------------------------------
 */

/* Whether tables and OpenColorIO agree, there and back, dimmed in between. */
static void
compare_tones(const struct bake_tones *tones, const struct bake_color *color,
    const char *space, int max, int nchans)
{
	struct bake_image a = new_image(300, 7, nchans);
	struct bake_image b = new_image(300, 7, nchans);
	const size_t n = (size_t)(300 * 7 * nchans);
	struct bake_err err = BAKE_ERR_INIT;
	uint32_t state = 5;

	for (size_t i = 0; i < n; i++)
		a.data[i] = b.data[i] =
		    (float)floor(test_random(&state) * (max + 1)) / (float)max;
	bake_tones_to_linear(tones, &a, 2);
	CHECK_OK(bake_color_to_linear(color, space, &b, 1, &err), err);
	CHECK(memcmp(a.data, b.data, n * sizeof(float)) == 0);
	for (size_t i = 0; i < n; i++)
		if (nchans > 2 ? i % (size_t)nchans < 3
			       : i % (size_t)nchans == 0)
			a.data[i] = b.data[i] *= (float)test_random(&state);
	bake_tones_from_linear(tones, &a, 2);
	CHECK_OK(bake_color_from_linear(color, space, &b, 1, &err), err);
	for (size_t i = 0; i < n; i++)
		CHECK(floor(a.data[i] * (double)max + 0.5) ==
		      floor(b.data[i] * (double)max + 0.5));
	bake_image_free(&a);
	bake_image_free(&b);
}

static void
tables_of_tones_are_opencolorio(void)
{
	static const char *const spaces[] = { "sRGB", "Gamma 2.2 Rec.709",
		"scene_linear", "Rec.709" };
	struct bake_color *color;
	struct bake_tones *tones;
	struct bake_err err = BAKE_ERR_INIT;

	unsetenv("OCIO");
	CHECK_OK(bake_color_open(NULL, &color, &err), err);
	for (int i = 0; i < 4; i++)
		for (int max = 255; max <= 65535; max += 65280) {
			CHECK_OK(bake_tones_open(
				     &tones, color, spaces[i], max, &err),
			    err);
			CHECK(tones != NULL);
			for (int n = 1; tones != NULL && n <= 4; n++)
				compare_tones(tones, color, spaces[i], max, n);
			bake_tones_close(tones);
		}
	/* a matrix mixes the channels */
	CHECK_OK(bake_tones_open(&tones, color, "Display P3", 255, &err), err);
	CHECK(tones == NULL);
	CHECK(bake_tones_open(&tones, color, "no such", 255, &err) ==
	      BAKE_EINVAL);
	CHECK(tones == NULL);
	bake_color_close(color);
}

/* -- pictures ---------------------------------------------------------------
 */

static void
pictures_show_the_remap(void)
{
	struct bake_image img = colors(200, 160, 3), lum = BAKE_IMAGE_INIT;
	struct bake_image sheet = BAKE_IMAGE_INIT;
	struct bake_roughen three[3];
	const double angles[2] = { 0, 90 };
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_roughen_luminance(&img, luma, 1, &lum, &err), err);
	three[0] = remap_of(BAKE_ROUGHEN_FLAT, 0.09, &lum);
	three[1] = remap_of(BAKE_ROUGHEN_BLACKSHOT, 0.09, &lum);
	three[2] = remap_of(BAKE_ROUGHEN_PAPER, 0.09, &lum);
	CHECK_OK(
	    bake_roughen_sheet(&img, &lum, three, 1, angles, 2, &sheet, &err),
	    err);
	/* flat at 0 degrees is the middle of the texture, at 90 black */
	CHECK(sheet.height == 24 + 4 + 160 + 4);
	CHECK(memcmp(bake_image_row(&sheet, 28) + 3 * (128 + 4),
		  bake_image_row(&img, 0) + 3 * 20,
		  160 * 3 * sizeof(float)) == 0);
	CHECK(bake_image_row(&sheet, 100)[3 * (128 + 4 + 164 + 80)] == 0);
	bake_image_free(&sheet);
	CHECK(bake_roughen_sheet(&img, &lum, three, 0, angles, 2, &sheet,
		  &err) == BAKE_EINVAL);
	CHECK_OK(bake_roughen_cylinders(&img, &lum, three, &sheet, &err), err);
	/* memory that was used before shows nowhere */
	CHECK(sheet.nchans == 3);
	for (int y = 0; y < sheet.height; y++)
		for (int x = 0; x < 3 * 16; x++)
			CHECK(bake_image_row(&sheet, y)[x] == 0.02f);
	bake_image_free(&sheet);
	bake_image_free(&img);
	bake_image_free(&lum);
}

static void
plots_leave_out_what_is_no_number(void)
{
	struct bake_roughen_curve curve = { .n = 3,
		.angle_deg = { 10, 50, 80 },
		.stats = {
		    { 0.3, 0.5, 0.7 }, { 0.1, 0.3, 0.4 }, { 0, 0, 0.1 } } };
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	char text[65536] = "";
	FILE *fp = fmemopen(text, sizeof text, "w");

	CHECK_OK(bake_roughen_plot(&curve, "a <b>", &img, &err), err);
	for (int i = 0; i < img.width * img.height; i++)
		CHECK(img.data[i] >= 0 && img.data[i] <= 1);
	bake_roughen_plot_svg(&curve, "a <b>", fp);
	fclose(fp);
	CHECK(strstr(text, "</svg>") != NULL);
	CHECK(strstr(text, "a &lt;b>") != NULL);
	CHECK(strstr(text, "inf") == NULL && strstr(text, "nan") == NULL);
	bake_image_free(&img);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(grey_texels_have_their_own_luminance),
		CASE(colours_keep_their_chromaticity_and_alpha_its_bits),
		CASE(kernels_give_the_bits_of_the_plain_function),
		CASE(a_map_of_one_angle_is_that_angle),
		CASE(normals_and_a_light_give_the_angle_between),
		CASE(a_table_gives_what_the_formula_gives),
		CASE(tables_that_cannot_be_are_errors),
		CASE(a_fit_finds_the_strength_that_made_the_contrasts),
		CASE(a_fit_needs_a_contrast),
		CASE(a_plane_is_lit_by_the_cosine),
		CASE(a_wall_casts_a_shadow_of_its_height_times_tan),
		CASE(scenes_that_cannot_be_are_errors),
		CASE(tables_of_tones_are_opencolorio),
		CASE(pictures_show_the_remap),
		CASE(plots_leave_out_what_is_no_number)
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
