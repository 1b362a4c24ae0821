/* Meta-relief textures: layers of relief, blended into one. */
/* SPDX-License-Identifier: MIT */
#include "combine.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "ao_rescale.h"
#include "combine_priv.h"
#include "mem.h"
#include "parallel.h"
#include "relief.h"

struct bake_combine {
	struct bake_combine_params p;
	struct bake_image normal, ao, depth; /* sums; without data: not kept */
	bool any_normal;                     /* added yet */
	bool copied; /* the normals are one layer's codes */
};

/* -- scales --------------------------------------------------------------- */

static void
repeats(const struct bake_combine_params *p, const struct bake_placement *place,
    int width, int height, double *ku, double *kv)
{
	*ku = place->tile_u;
	*kv = place->tile_v * ((double)height / width) /
	      ((double)p->height / p->width);
}

struct bake_layer_scales
bake_combine_scales(const struct bake_combine_params *params,
    const struct bake_combine_layer *layer, int width, int height)
{
	struct bake_layer_scales scales = { 0, INFINITY };
	double ku, kv, k;

	repeats(params, &layer->place, width, height, &ku, &kv);
	k = ku == kv ? ku : sqrt(ku * kv);
	if (layer->depth_weight > 0) {
		scales.keep = layer->depth_scale * params->depth_total /
			      (layer->depth_weight * k);
		scales.s = params->depth_scale / scales.keep;
	}
	return scales;
}

/* -- the blend --------------------------------------------------------------
 */

static enum bake_status
check_params(const struct bake_combine_params *p, struct bake_err *err)
{
	if (p->width < 1 || p->height < 1)
		return bake_fail(err, BAKE_EINVAL,
		    "a result of %dx%d texels, expected at least 1x1", p->width,
		    p->height);
	if (!(p->depth_scale > 0) || isinf(p->depth_scale))
		return bake_fail(err, BAKE_EINVAL,
		    "a depth scale of %g, expected a number above 0",
		    p->depth_scale);
	if (!(p->depth_total > 0) || isinf(p->depth_total))
		return bake_fail(err, BAKE_EINVAL,
		    "the depth weights' sum is %g, expected a number above 0",
		    p->depth_total);
	if (p->normal_blend != BAKE_NORMAL_FROM_DEPTH &&
	    (!(p->normal_total > 0) || isinf(p->normal_total)))
		return bake_fail(err, BAKE_EINVAL,
		    "the normal weights' sum is %g, expected a number above 0",
		    p->normal_total);
	if ((unsigned)p->normal_blend > BAKE_NORMAL_FROM_DEPTH ||
	    (unsigned)p->ao_blend > BAKE_AO_BAKE)
		return bake_fail(err, BAKE_EINVAL, "%d, %d are no blends",
		    (int)p->normal_blend, (int)p->ao_blend);
	return BAKE_OK;
}

static void
fill(struct bake_image *img, float value)
{
	for (int y = 0; y < img->height; y++) {
		float *row = bake_image_row(img, y);

		for (size_t i = 0; i < img->row_stride; i++)
			row[i] = value;
	}
}

enum bake_status
bake_combine_open(struct bake_combine **combine,
    const struct bake_combine_params *params, struct bake_err *err)
{
	const int w = params->width, h = params->height;
	struct bake_combine *c;
	enum bake_status rc;

	*combine = NULL;
	if ((rc = check_params(params, err)) != BAKE_OK)
		return rc;
	c = bake_zalloc(1, sizeof *c, err);
	if (c == NULL)
		return BAKE_ENOMEM;
	c->p = *params;
	rc = bake_image_alloc(&c->depth, w, h, 1, err);
	if (rc == BAKE_OK && params->ao_blend != BAKE_AO_BAKE)
		rc = bake_image_alloc(&c->ao, w, h, 1, err);
	if (rc == BAKE_OK && params->normal_blend != BAKE_NORMAL_FROM_DEPTH)
		rc = bake_image_alloc(&c->normal, w, h, 3, err);
	if (rc != BAKE_OK) {
		bake_combine_close(c);
		return rc;
	}
	fill(&c->depth, 0);
	if (c->ao.data != NULL)
		fill(&c->ao, 1);
	if (c->normal.data != NULL)
		fill(&c->normal, 0);
	*combine = c;
	return BAKE_OK;
}

void
bake_combine_close(struct bake_combine *c)
{
	if (c == NULL)
		return;
	bake_image_free(&c->normal);
	bake_image_free(&c->ao);
	bake_image_free(&c->depth);
	free(c);
}

static enum bake_status
check_layer(const struct bake_combine_layer *l, const struct bake_image *maps,
    struct bake_err *err)
{
	if (maps->data == NULL || maps->nchans != 4)
		return bake_fail(err, BAKE_EINVAL,
		    "a layer has 4 channels, this image has %d", maps->nchans);
	if (!(l->normal_weight >= 0) || !(l->depth_weight >= 0) ||
	    isinf(l->normal_weight) || isinf(l->depth_weight))
		return bake_fail(err, BAKE_EINVAL,
		    "weights of %g and %g, expected numbers of at least 0",
		    l->normal_weight, l->depth_weight);
	if (!(l->ao_scale >= 0) || isinf(l->ao_scale))
		return bake_fail(err, BAKE_EINVAL,
		    "a layer's AO of depth scale %g, expected 0 or more",
		    l->ao_scale);
	if (!(l->depth_scale > 0) || isinf(l->depth_scale))
		return bake_fail(err, BAKE_EINVAL,
		    "a depth scale of %g, expected a number above 0",
		    l->depth_scale);
	return BAKE_OK;
}

/* How the layer's rows enter the sums; copied: texel by texel. */
static struct bake_combine_op
make_op(const struct bake_combine *c, const struct bake_combine_layer *l,
    const struct bake_image *maps, bool copied)
{
	const struct bake_combine_params *p = &c->p;
	struct bake_combine_op op = { p->normal_blend, p->ao_blend, !copied,
		!c->any_normal, false, 0, 1, 1, 0 };
	double ku, kv;

	repeats(p, &l->place, maps->width, maps->height, &ku, &kv);
	op.depth = l->depth_weight / p->depth_total;
	if (p->normal_blend == BAKE_NORMAL_FROM_DEPTH)
		return op;
	op.normal = l->normal_weight / p->normal_total;
	if (p->normal_blend == BAKE_NORMAL_PD) {
		const double s = p->depth_scale / l->depth_scale * op.normal;

		op.su = s * ku;
		op.sv = s * kv;
	} else if (p->normal_blend != BAKE_NORMAL_SEED) {
		op.su = l->normal_weight * ku;
		op.sv = l->normal_weight * kv;
	}
	op.copy = copied && p->nnormals == 1 && op.normal > 0 && op.su == 1 &&
		  op.sv == 1;
	return op;
}

struct adding {
	struct bake_combine *c;
	const struct bake_combine_op *op;
};

static void
add_row(void *arg, int y, const float *row)
{
	const struct adding *a = arg;
	struct bake_combine *c = a->c;

	bake_combine_row(a->op, row, c->p.width,
	    c->normal.data != NULL ? bake_image_row(&c->normal, y) : NULL,
	    c->ao.data != NULL ? bake_image_row(&c->ao, y) : NULL,
	    bake_image_row(&c->depth, y));
}

static void
project(struct bake_image *maps, int nthreads)
{
#pragma omp parallel for schedule(static) num_threads(bake_threads(nthreads))
	for (int y = 0; y < maps->height; y++)
		bake_combine_project(bake_image_row(maps, y), maps->width);
}

enum bake_status
bake_combine_add(struct bake_combine *c, const struct bake_combine_layer *layer,
    struct bake_image *maps, struct bake_err *err)
{
	const struct bake_combine_params *p = &c->p;
	struct bake_resample_params how;
	struct bake_combine_op op;
	struct adding adding = { c, &op };
	const struct bake_row_sink sink = { add_row, &adding };
	enum bake_status rc;

	if ((rc = check_layer(layer, maps, err)) != BAKE_OK ||
	    (rc = bake_combine_place(p, &layer->place, maps, &how, err)) !=
		BAKE_OK)
		return rc;
	if (layer->normal_weight == 0 && layer->depth_weight == 0)
		return BAKE_OK;
	op = make_op(c, layer, maps, bake_combine_copies(&how));
	if (p->ao_rescale && c->ao.data != NULL) {
		double s =
		    bake_combine_scales(p, layer, maps->width, maps->height).s;

		if (layer->ao_scale > 0)
			s *= layer->depth_scale / layer->ao_scale;
		if ((rc = bake_ao_rescale_image(
			 maps, 2, s, p->nthreads, err)) != BAKE_OK)
			return rc;
	}
	if (op.projected && c->normal.data != NULL)
		project(maps, p->nthreads);
	rc = bake_combine_rows(p, maps, &how, &sink, err);
	c->any_normal |= op.normal > 0;
	c->copied |= op.copy;
	return rc;
}

/* -- the result -------------------------------------------------------------
 */

static enum bake_status
finish_normals(struct bake_combine *c, struct bake_err *err)
{
	const struct bake_combine_params *p = &c->p;
	enum bake_status rc;

	if (p->normal_blend == BAKE_NORMAL_FROM_DEPTH) {
		rc = bake_normal_from_depth(&c->depth, p->depth_scale, p->wrap,
		    p->slope, p->nthreads, &c->normal, err);
		if (rc == BAKE_OK)
			bake_normal_encode(&c->normal, false);
		return rc;
	}
#pragma omp parallel for schedule(static) num_threads(bake_threads(p->nthreads))
	for (int y = 0; y < p->height; y++)
		bake_combine_unit(p->normal_blend, c->copied,
		    bake_image_row(&c->normal, y), p->width);
	return BAKE_OK;
}

enum bake_status
bake_combine_settle(struct bake_combine *c, struct bake_err *err)
{
	struct bake_ao_params ao = c->p.ao;
	struct bake_ao_result result = { &c->ao, NULL, NULL };

	if (c->p.ao_blend != BAKE_AO_BAKE)
		return BAKE_OK;
	ao.wrap = c->p.wrap;
	ao.nthreads = c->p.nthreads;
	return bake_ao(&c->depth, &c->p.depth_scale, 1, &ao, &result, err);
}

/* Rows y … of an image. */
static void
copy_rows(struct bake_image *dst, const struct bake_image *src, int y)
{
	const size_t row = (size_t)src->width * (size_t)src->nchans;

	for (int i = 0; i < dst->height; i++)
		memcpy(bake_image_row(dst, i), bake_image_row(src, y + i),
		    row * sizeof(float));
}

/* Threads for a band: those that a team has done with spin for some
 * milliseconds before they sleep, which few rows are not worth. */
static int
band_threads(const struct bake_combine_params *p, int rows)
{
	return (size_t)p->width * (size_t)rows < (size_t)1 << 20
		   ? 1
		   : bake_threads(p->nthreads);
}

static enum bake_status
get_normals(const struct bake_combine *c, int y, struct bake_image *normal,
    struct bake_err *err)
{
	const struct bake_combine_params *p = &c->p;
	const int nt = band_threads(p, normal->height);
	enum bake_status rc;

	if (p->normal_blend == BAKE_NORMAL_FROM_DEPTH) {
		rc = bake_normal_rows_from_depth(&c->depth, p->depth_scale,
		    p->wrap, p->slope, nt, y, normal, err);
		if (rc == BAKE_OK)
			bake_normal_encode(normal, false);
		return rc;
	}
#pragma omp parallel for schedule(static) num_threads(nt)
	for (int i = 0; i < normal->height; i++) {
		float *row = bake_image_row(normal, i);

		memcpy(row, bake_image_row(&c->normal, y + i),
		    (size_t)p->width * 3 * sizeof *row);
		bake_combine_unit(p->normal_blend, c->copied, row, p->width);
	}
	return BAKE_OK;
}

static bool
is_band(const struct bake_combine *c, int y, const struct bake_image *band,
    int nchans)
{
	return band == NULL ||
	       (band->width == c->p.width && band->nchans == nchans && y >= 0 &&
		   band->height <= c->p.height - y);
}

enum bake_status
bake_combine_get(const struct bake_combine *c, int y, struct bake_image *normal,
    struct bake_image *ao, struct bake_image *depth, struct bake_err *err)
{
	if (!is_band(c, y, normal, 3) || !is_band(c, y, ao, 1) ||
	    !is_band(c, y, depth, 1))
		return bake_fail(err, BAKE_EINVAL,
		    "rows from %d on do not fit a result of %dx%d", y,
		    c->p.width, c->p.height);
	if (ao != NULL)
		copy_rows(ao, &c->ao, y);
	if (depth != NULL)
		copy_rows(depth, &c->depth, y);
	return normal != NULL ? get_normals(c, y, normal, err) : BAKE_OK;
}

enum bake_status
bake_combine_finish(
    struct bake_combine *c, struct bake_combined *out, struct bake_err *err)
{
	enum bake_status rc = finish_normals(c, err);

	if (rc == BAKE_OK)
		rc = bake_combine_settle(c, err);
	if (rc != BAKE_OK)
		return rc;
	bake_image_swap(&out->normal, &c->normal);
	bake_image_swap(&out->ao, &c->ao);
	bake_image_swap(&out->depth, &c->depth);
	return BAKE_OK;
}

void
bake_combined_free(struct bake_combined *maps)
{
	bake_image_free(&maps->normal);
	bake_image_free(&maps->ao);
	bake_image_free(&maps->depth);
}
