/* Every allocation fails in turn: failures are reported and leak nothing. */
/* SPDX-License-Identifier: MIT */

/* Each failure leaves the outputs as the headers say. */
#include <unistd.h>

#include "ao.h"
#include "blur.h"
#include "dequantize.h"
#include "detect.h"
#include "inspect.h"
#include "integrate.h"
#include "io_image.h"
#include "normal.h"
#include "output.h"
#include "relief.h"
#include "repair.h"
#include "resample.h"
#include "sheet.h"
#include "test_maps.h"
#include "test_nomem.h"

/* The inputs, made before anything fails: 24x20 texels. */
static struct bake_image depth_map, normal_map, noise3;

static enum bake_status
run_image_alloc(struct bake_err *err)
{
	struct bake_image img = { 1, 2, 3, 4, (float *)err };

	return done(bake_image_alloc(&img, 5, 4, 3, err), &img);
}

static enum bake_status
run_normal_from_depth(struct bake_err *err)
{
	struct bake_image out = BAKE_IMAGE_INIT;

	return done(bake_normal_from_depth(&depth_map, 0.1, torus,
			BAKE_SLOPE_CENTRAL, threads, &out, err),
	    &out);
}

static enum bake_status
run_normal_normalize(struct bake_err *err)
{
	float *data;
	struct bake_image two;
	enum bake_status rc;
	long at = fail_at;

	fail_at = -1; /* the input is not to fail */
	two = noise(6, 5, 2);
	data = two.data;
	nallocs = 0;
	fail_at = at;
	rc = bake_normal_normalize(&two, threads, NULL, err);
	if (rc != BAKE_OK) {
		struct bake_image want;

		fail_at = -1;
		want = noise(6, 5, 2);
		CHECK(two.data == data && two.nchans == 2);
		CHECK(memcmp(data, want.data, nfloats(&want) * 4) == 0);
		bake_image_free(&want);
	} else {
		CHECK(two.nchans == 3);
	}
	bake_image_free(&two);
	return rc;
}

static enum bake_status
run_integrate(struct bake_err *err)
{
	struct bake_integrate_params params = BAKE_INTEGRATE_PARAMS_DEFAULT;
	struct bake_image out = BAKE_IMAGE_INIT;

	params.nthreads = threads;
	return done(
	    bake_integrate(&normal_map, &params, &out, NULL, err), &out);
}

static enum bake_status
run_integrate_clamped(struct bake_err *err)
{
	struct bake_image out = BAKE_IMAGE_INIT;

	return done(bake_depth_from_normal(&normal_map, clamped,
			BAKE_SLOPE_SCHARR, threads, &out, err),
	    &out);
}

static enum bake_status
run_integrate_damping(struct bake_err *err)
{
	struct bake_integrate_params params = BAKE_INTEGRATE_PARAMS_DEFAULT;
	double damping;

	params.nthreads = threads;
	return bake_integrate_damping(&normal_map, &params, &damping, err);
}

static enum bake_status
run_resample(struct bake_err *err)
{
	struct bake_image out = BAKE_IMAGE_INIT;

	return done(bake_resample(&noise3, torus, BAKE_FILTER_CATMULL_ROM, 13,
			31, threads, &out, err),
	    &out);
}

/* What works in place leaves the image as it was. */
static enum bake_status
in_place(enum bake_status (*f)(struct bake_image *img, struct bake_err *err),
    const struct bake_image *start, struct bake_err *err)
{
	static float work[24 * 20 * 3];
	struct bake_image img = *start;
	enum bake_status rc;

	img.data = work;
	memcpy(work, start->data, nfloats(start) * sizeof(float));
	rc = f(&img, err);
	CHECK(img.data == work);
	CHECK((rc == BAKE_OK) !=
	      (memcmp(work, start->data, nfloats(start) * sizeof(float)) == 0));
	return rc;
}

static enum bake_status
repair_a_few(struct bake_image *img, struct bake_err *err)
{
	size_t n;

	return bake_repair_nonfinite(img, torus, threads, &n, err);
}

static enum bake_status
run_repair_nonfinite(struct bake_err *err)
{
	static float holed[24 * 20 * 3];
	struct bake_image img = noise3;

	memcpy(holed, noise3.data, sizeof holed);
	for (int i = 0; i < 24 * 20 * 3; i += 71)
		holed[i] = NAN;
	img.data = holed;
	return in_place(repair_a_few, &img, err);
}

static enum bake_status
dequantize_it(struct bake_image *img, struct bake_err *err)
{
	return bake_dequantize(img, 255, torus, threads, err);
}

static enum bake_status
run_dequantize(struct bake_err *err)
{
	return in_place(dequantize_it, &depth_map, err);
}

static enum bake_status
blur_all(struct bake_image *img, struct bake_err *err)
{
	uint8_t mask[24 * 20];

	memset(mask, 1, sizeof mask);
	return bake_blur(img, mask, 1, false, torus, threads, err);
}

static enum bake_status
run_blur(struct bake_err *err)
{
	return in_place(blur_all, &depth_map, err);
}

static enum bake_status
blur_some(struct bake_image *img, struct bake_err *err)
{
	uint8_t mask[24 * 20];

	for (int i = 0; i < 24 * 20; i++)
		mask[i] = i % 3 != 0;
	return bake_blur(img, mask, 2.5, true, clamped, threads, err);
}

static enum bake_status
run_blur_masked(struct bake_err *err)
{
	return in_place(blur_some, &depth_map, err);
}

static enum bake_status
run_detect(struct bake_err *err)
{
	struct bake_detection d;
	enum bake_status rc = bake_detect(&normal_map, &depth_map, &d, err);

	if (rc != BAKE_OK) {
		CHECK(d.polarity == BAKE_POLARITY_UNSURE);
		CHECK(d.normal_y == BAKE_NORMAL_Y_UNSURE);
		CHECK(d.pair_y == BAKE_NORMAL_Y_UNSURE);
		CHECK(d.curl_y == BAKE_NORMAL_Y_UNSURE);
	}
	return rc;
}

static enum bake_status
run_seams(struct bake_err *err)
{
	struct bake_seams s;

	return bake_seams(&noise3, 0, 3, &s, err);
}

static enum bake_status
run_maps_extract(struct bake_err *err)
{
	static const int rgba[] = { 0, 1, 2, -1 };
	struct bake_maps maps = BAKE_MAPS_INIT;
	enum bake_status rc = bake_maps_extract(&maps, &noise3, rgba,
	    BAKE_LAYOUT_NORMAL, BAKE_NORMAL_CODE_UNSIGNED, 0, err);

	CHECK(rc == BAKE_OK || is_init(&maps.normal));
	CHECK(is_init(&maps.relief) && is_init(&maps.ao));
	bake_maps_free(&maps);
	return rc;
}

static enum bake_status
run_inspect_maps(struct bake_err *err)
{
	struct bake_inspection found;
	struct bake_maps maps = BAKE_MAPS_INIT;

	memset(&found, 0, sizeof found);
	maps.normal = normal_map;
	maps.relief = depth_map;
	return bake_inspect_maps(&found, &maps, torus, err);
}

static enum bake_status
run_sheet(struct bake_err *err)
{
	struct bake_image row = BAKE_IMAGE_INIT, sheet = BAKE_IMAGE_INIT;
	struct bake_maps maps = BAKE_MAPS_INIT;
	enum bake_status rc;

	maps.normal = normal_map;
	maps.relief = depth_map;
	rc = bake_sheet_row(&maps, false, &row, err);
	CHECK((rc == BAKE_OK) != is_init(&row));
	if (rc == BAKE_OK)
		rc = bake_sheet_stack(&row, 1, &sheet, err);
	bake_image_free(&row);
	return done(rc, &sheet);
}

static enum bake_status
run_relief_pack(struct bake_err *err)
{
	const struct bake_target *t = bake_target_find("relief");
	struct bake_image out = BAKE_IMAGE_INIT;

	return done(bake_relief_pack(&t->file[0], &normal_map, &depth_map,
			&depth_map, &out, err),
	    &out);
}

static enum bake_status
run_reader_read(struct bake_err *err)
{
	static const char pgm[] = "P5 2 2 255\nabcd";
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_image_info info;
	struct bake_reader *r;
	enum bake_status rc;

	rc = bake_reader_open_memory(
	    &r, pgm, sizeof pgm - 1, "a.pgm", &limits, &info, err);
	if (rc == BAKE_OK)
		rc = bake_reader_read(r, 0, 1, &img, err);
	bake_reader_close(r);
	return done(rc, &img);
}

static char folder[] = "/tmp/t_nomem.XXXXXX";

/* Opened, written and put in its place, over a file that is there, through a
 * symbolic link: on any failure the old one stays, and nothing else. */
static enum bake_status
write_over(const char *name, struct bake_err *err)
{
	char path[64], old[64], text[8] = "";
	struct bake_output out;
	enum bake_status rc;
	FILE *f;

	snprintf(path, sizeof path, "%s/%s", folder, name);
	snprintf(old, sizeof old, "%s/old", folder);
	f = fopen(old, "wb");
	fputs("old", f);
	fclose(f);
	rc = bake_output_open(&out, path, err);
	if (rc == BAKE_OK) {
		fputs("new", out.stream);
		rc = bake_output_commit(&out, err);
	}
	CHECK(out.stream == NULL && out.path == NULL && out.target == NULL &&
	      out.temp == NULL);
	f = fopen(old, "rb");
	CHECK(f != NULL && fread(text, 1, 7, f) == 3);
	fclose(f);
	CHECK(strcmp(text, rc == BAKE_OK ? "new" : "old") == 0);
	CHECK(nentries(folder) == 2 + 2); /* . .. old link */
	return rc;
}

static enum bake_status
run_output(struct bake_err *err)
{
	return write_over("old", err);
}

static enum bake_status
run_output_link(struct bake_err *err)
{
	return write_over("link", err);
}

static enum bake_status
run_output_device(struct bake_err *err)
{
	struct bake_output out;
	enum bake_status rc = bake_output_open(&out, "/dev/null", err);

	return rc == BAKE_OK ? bake_output_commit(&out, err) : rc;
}

static enum bake_status
bake(enum bake_ao_quality quality, enum bake_ao_blur blurring,
    struct bake_err *err)
{
	static const double scales[] = { 0.1, 0.3 };
	struct bake_ao_params params = BAKE_AO_PARAMS_DEFAULT;
	struct bake_image ao[2] = { BAKE_IMAGE_INIT, BAKE_IMAGE_INIT };
	struct bake_image bent[2] = { BAKE_IMAGE_INIT, BAKE_IMAGE_INIT };
	struct bake_image horizons[2] = { BAKE_IMAGE_INIT, BAKE_IMAGE_INIT };
	const struct bake_ao_result result = { ao, bent, horizons };
	enum bake_status rc;

	params.ndirs = 5;
	params.quality = quality;
	params.blur = blurring;
	params.nthreads = threads;
	rc = bake_ao(&depth_map, scales, 2, &params, &result, err);
	for (int i = 0; i < 2; i++) {
		CHECK((rc == BAKE_OK) != is_init(&ao[i]));
		CHECK((rc == BAKE_OK) != is_init(&bent[i]));
		CHECK((rc == BAKE_OK) != is_init(&horizons[i]));
		bake_image_free(&ao[i]);
		bake_image_free(&bent[i]);
		bake_image_free(&horizons[i]);
	}
	return rc;
}

static enum bake_status
run_ao(struct bake_err *err)
{
	return bake(BAKE_AO_EXACT, BAKE_AO_BLUR_PAPER, err);
}

static enum bake_status
run_ao_fast(struct bake_err *err)
{
	return bake(BAKE_AO_FAST, BAKE_AO_BLUR_OCCLUDED, err);
}

CASE_OF(image_alloc)
CASE_OF(normal_from_depth)
CASE_OF(normal_normalize)
CASE_OF(integrate)
CASE_OF(integrate_clamped)
CASE_OF(integrate_damping)
CASE_OF(resample)
CASE_OF(repair_nonfinite)
CASE_OF(dequantize)
CASE_OF(blur)
CASE_OF(blur_masked)
CASE_OF(detect)
CASE_OF(seams)
CASE_OF(maps_extract)
CASE_OF(inspect_maps)
CASE_OF(sheet)
CASE_OF(relief_pack)
CASE_OF(reader_read)
CASE_OF(output)
CASE_OF(output_link)
CASE_OF(output_device)
CASE_OF(ao)
CASE_OF(ao_fast)

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(image_alloc),
		CASE(normal_from_depth),
		CASE(normal_normalize),
		CASE(integrate),
		CASE(integrate_clamped),
		CASE(integrate_damping),
		CASE(resample),
		CASE(repair_nonfinite),
		CASE(dequantize),
		CASE(blur),
		CASE(blur_masked),
		CASE(detect),
		CASE(seams),
		CASE(maps_extract),
		CASE(inspect_maps),
		CASE(sheet),
		CASE(relief_pack),
		CASE(reader_read),
		CASE(output),
		CASE(output_link),
		CASE(output_device),
		CASE(ao),
		CASE(ao_fast),
	};
	struct bake_err err = BAKE_ERR_INIT;
	char link[64];
	int status;

	if (mkdtemp(folder) == NULL) {
		perror(folder);
		return 1;
	}
	snprintf(link, sizeof link, "%s/link", folder);
	if (symlink("old", link) != 0)
		perror(link);
	depth_map = noise(24, 20, 1);
	noise3 = noise(24, 20, 3);
	if (bake_normal_from_depth(&depth_map, 0.1, torus, BAKE_SLOPE_CENTRAL,
		1, &normal_map, &err) != BAKE_OK)
		return 1;
	status = check_main(argc, argv, cases, sizeof cases / sizeof *cases);
	bake_image_free(&depth_map);
	bake_image_free(&normal_map);
	bake_image_free(&noise3);
	remove(link);
	snprintf(link, sizeof link, "%s/old", folder);
	remove(link);
	rmdir(folder);
	return status;
}
