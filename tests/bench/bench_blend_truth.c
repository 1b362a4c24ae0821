/* How far the blends are from the blended depth's own normals and AO. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "combine.h"
#include "io_image.h"

/* Usage: bench_blend_truth [FOLDER with the test data; testdata by default] */

enum { SIZE = 1024, TILE = 4, NBASES = 3, NDETAILS = 2, NBLENDS = 5 };

struct texture {
	const char *name;
	double scale;
	struct bake_image maps; /* nx ny ao depth, agreeing at its scale */
};

static void
need(enum bake_status rc, const struct bake_err *err)
{
	if (rc == BAKE_OK)
		return;
	fprintf(stderr, "bench_blend_truth: %s\n", err->msg);
	exit(1);
}

static struct bake_image
read_depth(const char *folder, const char *name)
{
	const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_image_info info;
	struct bake_reader *r;
	char path[1024];

	snprintf(path, sizeof path, "%s/%s_depth.png", folder, name);
	need(bake_reader_open(&r, path, &limits, &info, &err), &err);
	need(bake_reader_read(r, 0, 1, &img, &err), &err);
	bake_reader_close(r);
	return img;
}

/* Normals and AO of the depth at its scale. */
static void
make_texture(struct texture *t, const char *folder)
{
	const struct bake_wrap torus = { false, false };
	struct bake_image depth = read_depth(folder, t->name);
	struct bake_image normal = BAKE_IMAGE_INIT, ao = BAKE_IMAGE_INIT;
	struct bake_ao_params p = BAKE_AO_PARAMS_DEFAULT;
	struct bake_ao_result result = { &ao, NULL, NULL };
	struct bake_err err = BAKE_ERR_INIT;

	need(bake_normal_from_depth(
		 &depth, t->scale, torus, BAKE_SLOPE_CENTRAL, 0, &normal, &err),
	    &err);
	need(bake_ao(&depth, &t->scale, 1, &p, &result, &err), &err);
	need(bake_image_alloc(&t->maps, depth.width, depth.height, 4, &err),
	    &err);
	for (int i = 0; i < depth.width * depth.height; i++) {
		t->maps.data[4 * i] = (normal.data[3 * i] + 1) / 2;
		t->maps.data[4 * i + 1] = (normal.data[3 * i + 1] + 1) / 2;
		t->maps.data[4 * i + 2] = ao.data[i];
		t->maps.data[4 * i + 3] = depth.data[i];
	}
	bake_image_free(&depth);
	bake_image_free(&normal);
	bake_image_free(&ao);
}

static struct bake_image
copy(const struct bake_image *src)
{
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	need(bake_image_alloc(&img, src->width, src->height, src->nchans, &err),
	    &err);
	for (int c = 0; c < src->nchans; c++)
		bake_image_copy_channel(&img, c, src, c);
	return img;
}

static struct bake_combined
blend(const struct texture *base, const struct texture *detail,
    enum bake_normal_blend normals, enum bake_ao_blend ao, bool rescale)
{
	const double weight = 0.3;
	struct bake_combine_params p = BAKE_COMBINE_PARAMS_DEFAULT;
	struct bake_combine_layer layers[2] = { { 1, 1, { 1, 1, 0, 0 },
						    base->scale, 0 },
		{ weight, weight, { TILE, TILE, 0, 0 }, detail->scale, 0 } };
	const struct bake_image *maps[2] = { &base->maps, &detail->maps };
	struct bake_combined out = BAKE_COMBINED_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_combine *c;

	p.width = p.height = SIZE;
	p.depth_scale = base->scale;
	p.normal_total = p.depth_total = 1 + weight;
	p.nnormals = 2;
	p.normal_blend = normals;
	p.ao_blend = ao;
	p.ao_rescale = rescale;
	need(bake_combine_open(&c, &p, &err), &err);
	for (int i = 0; i < 2; i++) {
		struct bake_image used = copy(maps[i]);

		need(bake_combine_add(c, &layers[i], &used, &err), &err);
		bake_image_free(&used);
	}
	need(bake_combine_finish(c, &out, &err), &err);
	bake_combine_close(c);
	return out;
}

static int
compare(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

struct distance {
	double mean, p99, bias;
};

/* Of SIZE * SIZE values, which it sorts by magnitude. */
static struct distance
distance_of(float *v)
{
	const int n = SIZE * SIZE;
	struct distance d = { 0, 0, 0 };

	for (int i = 0; i < n; i++) {
		d.bias += v[i] / n;
		v[i] = fabsf(v[i]);
		d.mean += v[i] / n;
	}
	qsort(v, (size_t)n, sizeof *v, compare);
	d.p99 = v[n / 100 * 99];
	return d;
}

static struct distance
ao_distance(
    const struct bake_image *got, const struct bake_image *truth, float *v)
{
	for (int i = 0; i < SIZE * SIZE; i++)
		v[i] = got->data[i] - truth->data[i];
	return distance_of(v);
}

/* Degrees. */
static struct distance
angle_distance(
    const struct bake_image *got, const struct bake_image *truth, float *v)
{
	const double degrees = 180 / 3.14159265358979323846;

	for (int i = 0; i < SIZE * SIZE; i++) {
		const float *a = got->data + 3 * i, *b = truth->data + 3 * i;
		double d2 = 0;

		for (int c = 0; c < 3; c++)
			d2 += pow(2.0 * (a[c] - b[c]), 2);
		v[i] = (float)(2 * asin(fmin(1, sqrt(d2) / 2)) * degrees);
	}
	return distance_of(v);
}

static void
add(struct distance *sum, struct distance d)
{
	sum->mean += d.mean / (NBASES * NDETAILS);
	sum->p99 += d.p99 / (NBASES * NDETAILS);
	sum->bias += d.bias / (NBASES * NDETAILS);
}

/* One pair: AO by its four ways, then normals by all blends. */
static void
measure(const struct texture *base, const struct texture *detail, float *v,
    struct distance *ao, struct distance *angle)
{
	struct bake_combined truth =
	    blend(base, detail, BAKE_NORMAL_FROM_DEPTH, BAKE_AO_BAKE, false);

	printf("%s + %s:", base->name, detail->name);
	for (int k = 0; k < 4; k++) {
		struct bake_combined got = blend(base, detail, BAKE_NORMAL_SEED,
		    k % 2 == 0 ? BAKE_AO_MULTIPLY : BAKE_AO_MIN, k >= 2);
		struct distance d = ao_distance(&got.ao, &truth.ao, v);

		printf("  %.4f %.3f", d.mean, d.p99);
		add(&ao[k], d);
		bake_combined_free(&got);
	}
	printf("\n");
	for (int k = 0; k < NBLENDS; k++) {
		struct bake_combined got = blend(base, detail,
		    (enum bake_normal_blend)k, BAKE_AO_MIN, false);

		add(&angle[k], angle_distance(&got.normal, &truth.normal, v));
		bake_combined_free(&got);
	}
	bake_combined_free(&truth);
}

int
main(int argc, char **argv)
{
	static const char *const aos[] = { "multiply", "min",
		"multiply, --ao-rescale", "min, --ao-rescale" };
	static const char *const normals[] = { "seed", "pd", "rnm", "udn",
		"whiteout" };
	struct texture base[NBASES] = { { "stone", 0.08, BAKE_IMAGE_INIT },
		{ "bricks", 0.04, BAKE_IMAGE_INIT },
		{ "cushion", 0.1, BAKE_IMAGE_INIT } };
	struct texture detail[NDETAILS] = { { "woven", 0.05, BAKE_IMAGE_INIT },
		{ "jeans", 0.02, BAKE_IMAGE_INIT } };
	struct distance ao[4] = { { 0, 0, 0 } },
			angle[NBLENDS] = { { 0, 0, 0 } };
	const char *folder = argc > 1 ? argv[1] : "testdata";
	float *v = malloc(sizeof *v * SIZE * SIZE);

	if (v == NULL)
		return 1;
	for (int i = 0; i < NBASES; i++)
		make_texture(&base[i], folder);
	for (int i = 0; i < NDETAILS; i++)
		make_texture(&detail[i], folder);
	printf("detail of weight 0.3, %d times, %dx%d; against the AO and the "
	       "normals of the blended depth\n",
	    TILE, SIZE, SIZE);
	for (int i = 0; i < NBASES; i++)
		for (int k = 0; k < NDETAILS; k++)
			measure(&base[i], &detail[k], v, ao, angle);
	for (int k = 0; k < 4; k++)
		printf("AO %-24s mean %.4f, p99 %.3f, bias %+.4f\n", aos[k],
		    ao[k].mean, ao[k].p99, ao[k].bias);
	for (int k = 0; k < NBLENDS; k++)
		printf("normals %-19s mean %.2f, p99 %.2f degrees\n",
		    normals[k], angle[k].mean, angle[k].p99);
	free(v);
	for (int i = 0; i < NBASES; i++)
		bake_image_free(&base[i].maps);
	for (int i = 0; i < NDETAILS; i++)
		bake_image_free(&detail[i].maps);
	return 0;
}
