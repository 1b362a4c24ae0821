/* Ambient occlusion, bent normals and horizons of a height field. */
/* SPDX-License-Identifier: MIT */
#include "ao.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "ao_priv.h"
#include "blur.h"
#include "horizon_priv.h"
#include "isa.h"
#include "mem.h"

/* What the directions add up to, for one scale: planes of whole tiles, one
 * after the other, because a tile's part is then one piece of memory. */
struct sums {
	float scale; /* slope to tangent */
	float *sum;
	float *prev[2]; /* for the polygon, of each side */
	float *first;   /* for bent */
	float *bent[3];
};

/* One bake. */
struct bake {
	const struct bake_image *depth;
	const double *scales;
	int nscales;
	const struct bake_ao_params *params;
	const struct bake_ao_result *result;
	int nthreads;
	struct bake_horizon horizon;
	size_t stride;               /* of the sums' planes */
	size_t across, down, ntiles; /* tiles, counted row by row */
	struct sums *sums;           /* [nscales] */
	uint64_t *mask; /* [tile] bit per texel: some slope is above 0 */
	int nturns;     /* of the march: all directions, or half of them */
};

enum { TILE_WORDS = BAKE_TILE_TEXELS / 64 };

/* A tile's part inside the map. */
struct tile {
	size_t index;
	int x0, y0, width, height;
};

static bool
within(double v, double lo, double hi)
{
	return v >= lo && v <= hi; /* false for NaN */
}

static enum bake_status
check_params(const struct bake_ao_params *p, struct bake_err *err)
{
	if (p->ndirs < BAKE_AO_DIRS_MIN || p->ndirs > BAKE_AO_DIRS_MAX)
		return bake_fail(err, BAKE_EINVAL,
		    "%d directions, expected %d to %d", p->ndirs,
		    BAKE_AO_DIRS_MIN, BAKE_AO_DIRS_MAX);
	if (!within(p->radius, 0, BAKE_AO_PERIODS_MAX))
		return bake_fail(err, BAKE_EINVAL,
		    "a radius of %g texture widths, expected 0 to %d",
		    p->radius, BAKE_AO_PERIODS_MAX);
	if (p->periods < 1 || p->periods > BAKE_AO_PERIODS_MAX)
		return bake_fail(err, BAKE_EINVAL,
		    "%d periods, expected 1 to %d", p->periods,
		    BAKE_AO_PERIODS_MAX);
	if (p->estimator != BAKE_AO_POLYGON && p->estimator != BAKE_AO_MEAN)
		return bake_fail(err, BAKE_EINVAL, "unknown estimator %d",
		    (int)p->estimator);
	if (p->quality != BAKE_AO_EXACT && p->quality != BAKE_AO_FAST &&
	    p->quality != BAKE_AO_PREVIEW)
		return bake_fail(
		    err, BAKE_EINVAL, "unknown quality %d", (int)p->quality);
	if (p->blur != BAKE_AO_BLUR_NONE && p->blur != BAKE_AO_BLUR_PAPER &&
	    p->blur != BAKE_AO_BLUR_OCCLUDED)
		return bake_fail(
		    err, BAKE_EINVAL, "unknown blur mode %d", (int)p->blur);
	if (!within(p->blur_sigma, 0, BAKE_AO_BLUR_SIGMA_MAX))
		return bake_fail(err, BAKE_EINVAL,
		    "a blur of %g texels, expected 0 to %d", p->blur_sigma,
		    BAKE_AO_BLUR_SIGMA_MAX);
	if (p->nthreads < 0)
		return bake_fail(err, BAKE_EINVAL,
		    "%d threads, expected 0 or more", p->nthreads);
	return BAKE_OK;
}

static enum bake_status
check_input(const struct bake *b, struct bake_err *err)
{
	const struct bake_image *depth = b->depth;

	if (depth->data == NULL || depth->width < 1 || depth->height < 1)
		return bake_fail(err, BAKE_EINVAL,
		    "the depth map has %dx%d texels, expected some",
		    depth->width, depth->height);
	if (depth->nchans != 1)
		return bake_fail(err, BAKE_EINVAL,
		    "the depth map has %d channels, expected 1", depth->nchans);
	if (b->nscales < 1 || b->nscales > BAKE_AO_SCALES_MAX)
		return bake_fail(err, BAKE_EINVAL,
		    "%d depth scales, expected 1 to %d", b->nscales,
		    BAKE_AO_SCALES_MAX);
	for (int i = 0; i < b->nscales; i++)
		if (!within(b->scales[i], 0, BAKE_AO_SCALE_MAX))
			return bake_fail(err, BAKE_EINVAL,
			    "a depth scale of %g, expected 0 to %g",
			    b->scales[i], BAKE_AO_SCALE_MAX);
	return check_params(b->params, err);
}

static enum bake_status
alloc_horizons(const struct bake *b, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;

	for (int i = 0;
	     b->result->horizons != NULL && i < b->nscales && rc == BAKE_OK;
	     i++)
		rc = bake_image_alloc(&b->result->horizons[i], b->depth->width,
		    b->depth->height, b->params->ndirs, err);
	return rc;
}

static void
free_results(const struct bake *b)
{
	const struct bake_ao_result *r = b->result;
	struct bake_image *const lists[] = { r->ao, r->bent, r->horizons };

	for (int l = 0; l < 3; l++)
		for (int i = 0; lists[l] != NULL && i < b->nscales; i++)
			bake_image_free(&lists[l][i]);
}

static enum bake_status
alloc_sums(struct bake *b, struct bake_err *err)
{
	const bool bent = b->result->bent != NULL;
	const bool polygon = b->params->estimator == BAKE_AO_POLYGON;
	const bool pairs = b->params->ndirs % 2 == 0;
	size_t ntexels;

	b->across =
	    ((size_t)b->depth->width + BAKE_TILE_WIDTH - 1) / BAKE_TILE_WIDTH;
	b->down = ((size_t)b->depth->height + BAKE_TILE_HEIGHT - 1) /
		  BAKE_TILE_HEIGHT;
	if (!bake_mul_size(b->across, b->down, &b->ntiles) ||
	    !bake_mul_size(b->ntiles, BAKE_TILE_TEXELS, &ntexels))
		return bake_fail(err, BAKE_ENOMEM,
		    "%dx%d texels do not fit in memory", b->depth->width,
		    b->depth->height);
	b->mask = bake_zalloc(ntexels / 64, sizeof *b->mask, err);
	b->sums = bake_zalloc((size_t)b->nscales, sizeof *b->sums, err);
	if (b->mask == NULL || b->sums == NULL)
		return BAKE_ENOMEM;
	for (int i = 0; i < b->nscales; i++) {
		struct sums *s = &b->sums[i];
		float **const planes[] = { &s->sum, &s->prev[0], &s->prev[1],
			&s->first, &s->bent[0], &s->bent[1], &s->bent[2] };
		const bool wanted[] = { true, polygon, polygon && pairs, bent,
			bent, bent, bent };

		s->scale = (float)(b->scales[i] * b->depth->width);
		for (int p = 0; p < 7; p++)
			if (wanted[p] && (*planes[p] = bake_alloc(ntexels,
					      sizeof(float), err)) == NULL)
				return BAKE_ENOMEM;
	}
	return BAKE_OK;
}

static void
free_sums(struct bake *b)
{
	for (int i = 0; b->sums != NULL && i < b->nscales; i++) {
		free(b->sums[i].sum);
		free(b->sums[i].first);
		free(b->sums[i].prev[0]);
		free(b->sums[i].prev[1]);
		for (int c = 0; c < 3; c++)
			free(b->sums[i].bent[c]);
	}
	free(b->sums);
	b->sums = NULL;
}

static struct tile
tile_at(const struct bake *b, size_t index)
{
	struct tile tile = { .index = index };
	int right, below;

	tile.x0 = (int)(index % b->across) * BAKE_TILE_WIDTH;
	tile.y0 = (int)(index / b->across) * BAKE_TILE_HEIGHT;
	right = b->depth->width - tile.x0;
	below = b->depth->height - tile.y0;
	tile.width = right < BAKE_TILE_WIDTH ? right : BAKE_TILE_WIDTH;
	tile.height = below < BAKE_TILE_HEIGHT ? below : BAKE_TILE_HEIGHT;
	return tile;
}

static float *
in_tile(float *plane, const struct tile *tile)
{
	return plane == NULL ? NULL : plane + tile->index * BAKE_TILE_TEXELS;
}

/* Turn j, one side of one tile: add its slopes to the sums of scale i. */
static void
add_slopes(const struct bake *b, const struct tile *tile, const float *slopes,
    int i, int j, int side)
{
	static void (*const add[])(const struct bake_ao_add *) =
	    BAKE_KERNEL_TABLE(bake_ao_add);
	const struct bake_horizon_dir *dir = &b->horizon.ray[side].dir;
	const struct sums *s = &b->sums[i];
	struct bake_ao_add a = {
		.n = BAKE_TILE_TEXELS,
		.slopes = slopes,
		.scale = s->scale,
		.mean = b->params->estimator == BAKE_AO_MEAN,
		.start = j == 0 && side == 0,
		.open = j == 0,
		.cos_phi = (float)dir->cos_phi,
		.sin_phi = (float)dir->sin_phi,
		.sum = in_tile(s->sum, tile),
		.first = in_tile(s->first, tile),
		.prev = in_tile(s->prev[side], tile),
	};

	for (int c = 0; c < 3 && j < b->nturns; c++)
		a.bent[c] = in_tile(s->bent[c], tile);
	add[b->horizon.isa](&a);
}

static void
store_horizons(const struct bake *b, const struct tile *tile,
    const float *slopes, int i, int j)
{
	const struct bake_image *img = &b->result->horizons[i];
	const size_t nchans = (size_t)img->nchans;

	for (int y = 0; y < tile->height; y++) {
		float *out = bake_image_row(img, tile->y0 + y) +
			     (size_t)tile->x0 * nchans + j;

		for (int x = 0; x < tile->width; x++) {
			float v =
			    slopes[y * BAKE_TILE_WIDTH + x] * b->sums[i].scale;

			out[(size_t)x * nchans] =
			    v < BAKE_AO_TAN_MAX ? v : BAKE_AO_TAN_MAX;
		}
	}
}

/* Fetch a tile's part of a plane into the cache. */
static void
fetch(const float *part)
{
	for (size_t t = 0; part != NULL && t < BAKE_TILE_TEXELS; t += 16)
		__builtin_prefetch(part + t, 1, 2);
}

static void
bake_tile(const struct bake *b, int j, size_t index)
{
	static void (*const add_mask[])(uint64_t *, const float *, size_t) =
	    BAKE_KERNEL_TABLE(bake_ao_mask);
	const struct tile tile = tile_at(b, index);
	float slopes[BAKE_TILE_TEXELS];

	/* while the march goes on */
	fetch(in_tile(b->sums[0].sum, &tile));
	fetch(in_tile(b->sums[0].prev[0], &tile));
	fetch(in_tile(b->sums[0].prev[1], &tile));
	for (int side = 0; side < b->horizon.nrays; side++) {
		bake_horizon_tile(&b->horizon, side, tile.x0, tile.y0, slopes);
		add_mask[b->horizon.isa](
		    b->mask + index * TILE_WORDS, slopes, BAKE_TILE_TEXELS);
		for (int i = 0; i < b->nscales; i++) {
			add_slopes(b, &tile, slopes, i, j, side);
			if (b->result->horizons != NULL && j < b->nturns)
				store_horizons(
				    b, &tile, slopes, i, j + side * b->nturns);
		}
	}
}

static void
store_ao(const struct bake *b, const struct tile *tile, int i)
{
	const float *sum = in_tile(b->sums[i].sum, tile);
	const float n = (float)b->params->ndirs;

	for (int y = 0; y < tile->height; y++) {
		float *out =
		    bake_image_row(&b->result->ao[i], tile->y0 + y) + tile->x0;

		for (int x = 0; x < tile->width; x++) {
			const int t = y * BAKE_TILE_WIDTH + x;
			const float v = sum[t] / n;

			out[x] = v < 1 ? v : 1;
		}
	}
}

static void
store_bent(const struct bake *b, const struct tile *tile, int i)
{
	const float *bx = in_tile(b->sums[i].bent[0], tile);
	const float *by = in_tile(b->sums[i].bent[1], tile);
	const float *bz = in_tile(b->sums[i].bent[2], tile);

	for (int y = 0; y < tile->height; y++) {
		float *out = bake_image_row(&b->result->bent[i], tile->y0 + y) +
			     (size_t)tile->x0 * 3;

		for (int x = 0; x < tile->width; x++, out += 3) {
			const int t = y * BAKE_TILE_WIDTH + x;
			/* the floor makes a closed texel (0, 0, 1) */
			float z = bz[t] > 1e-15f ? bz[t] : 1e-15f;
			float len =
			    sqrtf(bx[t] * bx[t] + by[t] * by[t] + z * z);

			out[0] = bx[t] / len;
			out[1] = by[t] / len;
			out[2] = z / len;
		}
	}
}

static void
report(const struct bake_progress *progress, double done)
{
	if (progress->report != NULL)
		progress->report(progress->arg, done);
}

/*
 * The tile to bake as number t, 0 <= t < ntiles. A ray's texels are far apart
 * in memory, so one tile after the other is taken along the ray: the next one
 * reads what the last one read, which is still in the cache. Such a run ends
 * after RUN texels, for the run beside it reads the same rows.
 */
enum { RUN = 512 };

static size_t
tile_in_order(const struct bake *b, size_t t)
{
	const struct bake_horizon_dir *dir = &b->horizon.ray[0].dir;
	const double slope = dir->minor * dir->major;
	const size_t length = dir->x_major ? b->across : b->down;
	const size_t breadth = dir->x_major ? b->down : b->across;
	const double aspect = dir->x_major
				  ? (double)BAKE_TILE_WIDTH / BAKE_TILE_HEIGHT
				  : (double)BAKE_TILE_HEIGHT / BAKE_TILE_WIDTH;
	const size_t most =
	    RUN / (dir->x_major ? BAKE_TILE_WIDTH : BAKE_TILE_HEIGHT);
	const size_t first = t / (most * breadth) * most;
	const size_t run = length - first < most ? length - first : most;
	const size_t rest = t - first * breadth;
	const size_t along = first + rest % run;
	const long shift = (long)floor((double)along * slope * aspect);
	const size_t aside = (size_t)bake_wrap_index(
	    (long)(rest / run) + shift, (int)breadth, false);

	return dir->x_major ? aside * b->across + along
			    : along * b->across + aside;
}

/*
 * An even number of directions is taken in pairs: turn j is directions j and
 * j + n / 2, as two runs of directions that go half round each. One turn more
 * closes the polygon, both runs where the other one began, which is cheaper
 * than to keep how they began in memory.
 */
static void
bake_directions(struct bake *b)
{
	const int ndirs = b->params->ndirs;
	const int nturns =
	    b->nturns + (b->params->estimator == BAKE_AO_POLYGON);

#pragma omp parallel num_threads(b->nthreads)
	for (int j = 0; j < nturns; j++) {
		bake_horizon_aim(&b->horizon, j % ndirs, ndirs);
#pragma omp for schedule(dynamic, 8)
		for (size_t t = 0; t < b->ntiles; t++)
			bake_tile(b, j, tile_in_order(b, t));
#pragma omp master
		report(&b->params->progress, (j + 1.0) / nturns);
	}
}

/* The sums into images. ao is allocated this late because the march's tables
 * are gone by now. */
static enum bake_status
store_results(const struct bake *b, struct bake_err *err)
{
	const int width = b->depth->width, height = b->depth->height;
	const bool bent = b->result->bent != NULL;
	enum bake_status rc = BAKE_OK;

	for (int i = 0; i < b->nscales && rc == BAKE_OK; i++) {
		rc = bake_image_alloc(&b->result->ao[i], width, height, 1, err);
		if (rc == BAKE_OK && bent)
			rc = bake_image_alloc(
			    &b->result->bent[i], width, height, 3, err);
		if (rc != BAKE_OK)
			break;
#pragma omp parallel for num_threads(b->nthreads) schedule(static)
		for (size_t t = 0; t < b->ntiles; t++) {
			const struct tile tile = tile_at(b, t);

			store_ao(b, &tile, i);
			if (bent)
				store_bent(b, &tile, i);
		}
	}
	return rc;
}

/* The mask by rows, a byte a texel, as the blur wants it. */
static void
unpack_mask(const struct bake *b, uint8_t *mask)
{
#pragma omp parallel for num_threads(b->nthreads) schedule(static)
	for (size_t i = 0; i < b->ntiles; i++) {
		const struct tile tile = tile_at(b, i);

		for (int y = 0; y < tile.height; y++) {
			const uint64_t bits =
			    b->mask[i * TILE_WORDS +
				    (size_t)y * BAKE_TILE_WIDTH / 64];
			uint8_t *row =
			    mask +
			    (size_t)(tile.y0 + y) * (size_t)b->depth->width +
			    tile.x0;

			for (int x = 0; x < tile.width; x++)
				row[x] = bits >> x & 1;
		}
	}
}
_Static_assert(BAKE_TILE_WIDTH == 64, "a row of a tile is one word of mask");

static enum bake_status
blur_results(const struct bake *b, struct bake_err *err)
{
	const struct bake_ao_params *p = b->params;
	enum bake_status rc = BAKE_OK;
	uint8_t *mask;

	if (p->blur == BAKE_AO_BLUR_NONE || !(p->blur_sigma > 0))
		return BAKE_OK;
	mask = bake_alloc(b->ntiles, BAKE_TILE_TEXELS, err);
	if (mask == NULL)
		return BAKE_ENOMEM;
	unpack_mask(b, mask);
	for (int i = 0; i < b->nscales && rc == BAKE_OK; i++)
		rc = bake_blur(&b->result->ao[i], mask, p->blur_sigma,
		    p->blur == BAKE_AO_BLUR_OCCLUDED, p->wrap, b->nthreads,
		    err);
	free(mask);
	return rc;
}

enum bake_status
bake_ao(const struct bake_image *depth, const double *scales, int nscales,
    const struct bake_ao_params *params, const struct bake_ao_result *result,
    struct bake_err *err)
{
	static const enum bake_horizon_quality qualities[] = {
		[BAKE_AO_EXACT] = BAKE_HORIZON_EXACT,
		[BAKE_AO_FAST] = BAKE_HORIZON_FAST,
		[BAKE_AO_PREVIEW] = BAKE_HORIZON_PREVIEW,
	};
	struct bake b = {
		.depth = depth,
		.scales = scales,
		.nscales = nscales,
		.params = params,
		.result = result,
		.nthreads = bake_threads(params->nthreads),
		.nturns =
		    params->ndirs % 2 == 0 ? params->ndirs / 2 : params->ndirs,
	};
	enum bake_status rc;

	if ((rc = check_input(&b, err)) != BAKE_OK)
		return rc;
	if ((rc = alloc_horizons(&b, err)) != BAKE_OK ||
	    (rc = bake_horizon_init(&b.horizon, depth, params->wrap,
		 params->radius, params->periods, qualities[params->quality],
		 b.nthreads, err)) != BAKE_OK ||
	    (rc = alloc_sums(&b, err)) != BAKE_OK)
		goto out;
	bake_directions(&b);
	bake_horizon_free(&b.horizon);
	if ((rc = store_results(&b, err)) != BAKE_OK)
		goto out;
	free_sums(&b); /* room for the blur's scratch */
	rc = blur_results(&b, err);
out:
	bake_horizon_free(&b.horizon);
	free_sums(&b);
	free(b.mask);
	if (rc != BAKE_OK)
		free_results(&b);
	return rc;
}
