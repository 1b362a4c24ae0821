/* Multilayer relief: bands of rows from crossings to textures. */
/* SPDX-License-Identifier: MIT */
#include "multilayer_priv.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"

/* One thread's scratch: a band, the layers of a texel, and a row of each
 * texture. */
struct worker {
	struct bake_band band;
	struct bake_layer *layer;
	int room;                            /* for layers */
	float *row[3 * BAKE_LAYER_TEXTURES]; /* depth, nx, ny of each */
	float *color[BAKE_LAYERS_MAX];
	float *runs; /* a row of colours, each once */
	struct bake_multilayer_stats stats;
};

void
bake_multilayer_stats_add(struct bake_multilayer_stats *sum,
    const struct bake_multilayer_stats *stats)
{
	sum->rays.open += stats->rays.open;
	sum->rays.inside_out += stats->rays.inside_out;
	sum->rays.united += stats->rays.united;
	sum->rays.crossings += stats->rays.crossings;
	if (stats->rays.most > sum->rays.most)
		sum->rays.most = stats->rays.most;
	bake_layer_stats_add(&sum->codes, &stats->codes);
	for (int i = 0; i <= BAKE_LAYERS_MAX; i++)
		sum->histogram[i] += stats->histogram[i];
	if (stats->nlayers > sum->nlayers)
		sum->nlayers = stats->nlayers;
}

/* -- opening ----------------------------------------------------------------
 */

static enum bake_status
check(const struct bake_multilayer_params *p, struct bake_err *err)
{
	if (p->nlayers < 0 || p->nlayers > BAKE_LAYERS_MAX ||
	    p->nlayers % 2 != 0)
		return bake_fail(err, BAKE_EINVAL,
		    "%d layers, expected an even number of 2 to %d", p->nlayers,
		    BAKE_LAYERS_MAX);
	if (p->ncolors < 0 || (p->nlayers > 0 && p->ncolors > p->nlayers))
		return bake_fail(err, BAKE_EINVAL, "%d colours for %d layers",
		    p->ncolors, p->nlayers);
	return bake_view_check(&p->view, err);
}

enum bake_status
bake_multilayer_open(struct bake_multilayer **ml, const struct bake_mesh *mesh,
    const struct bake_weld *weld, const struct bake_multilayer_params *params,
    struct bake_err *err)
{
	struct bake_multilayer *m;
	enum bake_status rc;

	*ml = NULL;
	if ((rc = check(params, err)) != BAKE_OK)
		return rc;
	if ((m = bake_zalloc(1, sizeof *m, err)) == NULL)
		return BAKE_ENOMEM;
	m->params = *params;
	rc = bake_abuffer_open(
	    &m->rays, mesh, weld, &params->view, &params->rays, err);
	if (rc == BAKE_OK)
		rc = bake_surface_open(&m->surface, mesh, weld, m->rays,
		    &params->view, &params->surface, err);
	if (rc != BAKE_OK) {
		bake_multilayer_close(m);
		return rc;
	}
	*ml = m;
	return BAKE_OK;
}

void
bake_multilayer_close(struct bake_multilayer *ml)
{
	if (ml == NULL)
		return;
	bake_surface_close(ml->surface);
	bake_abuffer_close(ml->rays);
	free(ml);
}

size_t
bake_multilayer_missing_uvs(const struct bake_multilayer *ml)
{
	return bake_surface_missing_uvs(ml->surface);
}

/* -- one texel --------------------------------------------------------------
 */

/* Room for n layers. */
static enum bake_status
reserve(struct worker *w, int n, struct bake_err *err)
{
	struct bake_layer *more;

	if (n <= w->room)
		return BAKE_OK;
	more = bake_alloc((size_t)n * 2, sizeof *more, err);
	if (more == NULL)
		return BAKE_ENOMEM;
	free(w->layer);
	w->layer = more;
	w->room = 2 * n;
	return BAKE_OK;
}

/* The layers of texel x of row y of the band, and their crossings. */
static enum bake_status
layers_of(struct worker *w, const struct bake_multilayer *ml, int x, int y,
    const struct bake_layer_params *layers, const struct bake_crossing **c,
    int *n, struct bake_err *err)
{
	const struct bake_band *band = &w->band;
	size_t i =
	    (size_t)(y - band->y0) * (size_t)ml->params.view.width + (size_t)x;
	int ncrossings = (int)(band->start[i + 1] - band->start[i]);
	int counted;
	enum bake_status rc = reserve(w, ncrossings, err);

	if (rc != BAKE_OK)
		return rc;
	*c = band->crossing + band->start[i];
	*n = bake_layer_quantize(
	    *c, ncrossings, layers, w->layer, &w->stats.codes);
	counted = *n < BAKE_LAYERS_MAX ? *n : BAKE_LAYERS_MAX;
	w->stats.histogram[counted]++;
	return BAKE_OK;
}

static void
put_texel(struct worker *w, const struct bake_multilayer *ml,
    const struct bake_crossing *crossing, int n, int x, int y)
{
	for (int i = 0; i < n; i++) {
		const struct bake_crossing *c = crossing + w->layer[i].crossing;
		size_t at = 4 * (size_t)x + (size_t)(i % 4);
		float **row = w->row + 3 * (i / 4);
		float normal[3];

		bake_surface_normal(ml->surface, c, x, y, normal);
		row[0][at] =
		    bake_layer_value(w->layer[i].code, ml->params.format);
		row[1][at] = (normal[0] + 1) / 2;
		row[2][at] = (normal[1] + 1) / 2;
	}
}

static void
put_colors(struct worker *w, const struct bake_multilayer *ml,
    const struct bake_crossing *crossing, int n, int ncolors, int x, int y)
{
	const int chans = ml->params.coverage ? 4 : 3;

	for (int i = 0; i < n && i < ncolors; i++) {
		float rgba[4];

		bake_surface_color(
		    ml->surface, crossing + w->layer[i].crossing, x, y, rgba);
		rgba[3] = 1; /* coverage: what is there is opaque */
		memcpy(w->color[i] + (size_t)x * (size_t)chans, rgba,
		    (size_t)chans * sizeof *rgba);
	}
}

/* -- rows to textures -------------------------------------------------------
 */

static void
free_worker(struct worker *w)
{
	bake_band_free(&w->band);
	free(w->layer);
	for (int i = 0; i < 3 * BAKE_LAYER_TEXTURES; i++)
		free(w->row[i]);
	for (int i = 0; i < BAKE_LAYERS_MAX; i++)
		free(w->color[i]);
	free(w->runs);
}

static enum bake_status
make_worker(
    struct worker *w, const struct bake_layer_maps *maps, struct bake_err *err)
{
	const struct bake_band band = BAKE_BAND_INIT;

	memset(w, 0, sizeof *w);
	w->band = band;
	for (int i = 0; i < 3 * maps->ntextures; i++)
		if ((w->row[i] = bake_alloc(
			 (size_t)maps->width, 4 * sizeof(float), err)) == NULL)
			return BAKE_ENOMEM;
	if (maps->ncolors > 0 && (w->runs = bake_alloc((size_t)maps->width,
				      4 * sizeof(float), err)) == NULL)
		return BAKE_ENOMEM;
	for (int i = 0; i < maps->ncolors; i++)
		if ((w->color[i] = bake_alloc(
			 (size_t)maps->width, 4 * sizeof(float), err)) == NULL)
			return BAKE_ENOMEM;
	return BAKE_OK;
}

static void
clear_rows(struct worker *w, const struct bake_layer_maps *maps)
{
	const size_t n = 4 * (size_t)maps->width;

	for (int i = 0; i < 3 * maps->ntextures; i++)
		for (size_t k = 0; k < n; k++)
			w->row[i][k] = i % 3 == 0 ? 1 : 0.5F;
	for (int i = 0; i < maps->ncolors; i++)
		memset(w->color[i], 0, n * sizeof(float));
}

/*
 * Encode a row of colours, run by run of equal ones: what has one colour all
 * over, as most of what has no texture does, is converted once.
 */
static enum bake_status
encode_row(const struct bake_color *color, float *row, float *runs, int width,
    int chans, struct bake_err *err)
{
	const size_t size = (size_t)chans * sizeof *row;
	struct bake_image img = { 0, 1, chans, 0, runs };
	enum bake_status rc;
	int run = 0;

	for (int x = 0; x < width; x++)
		if (x == 0 ||
		    memcmp(row + (size_t)x * (size_t)chans,
			row + (size_t)(x - 1) * (size_t)chans, size) != 0)
			memcpy(runs + (size_t)img.width++ * (size_t)chans,
			    row + (size_t)x * (size_t)chans, size);
	img.row_stride = (size_t)img.width * (size_t)chans;
	rc = bake_color_from_linear(color, "sRGB", &img, 1, err);
	for (int x = 0; x < width && rc == BAKE_OK; x++) {
		float *texel = row + (size_t)x * (size_t)chans;
		/* this texel is overwritten when its neighbour was looked at */
		bool last =
		    x + 1 == width || memcmp(texel, texel + chans, size) != 0;

		memcpy(texel, runs + (size_t)run * (size_t)chans, size);
		run += last;
	}
	return rc;
}

static enum bake_status
put_rows(const struct worker *w, const struct bake_multilayer *ml,
    struct bake_layer_maps *maps, int y, struct bake_err *err)
{
	const int chans = ml->params.coverage ? 4 : 3;
	enum bake_status rc = BAKE_OK;

	for (int t = 0; t < maps->ntextures; t++) {
		bake_pixels_put(
		    &maps->depth[t], 0, y, maps->width, w->row[3 * t]);
		bake_pixels_put(
		    &maps->nx[t], 0, y, maps->width, w->row[3 * t + 1]);
		bake_pixels_put(
		    &maps->ny[t], 0, y, maps->width, w->row[3 * t + 2]);
	}
	for (int i = 0; i < maps->ncolors && rc == BAKE_OK; i++) {
		if (!maps->color_linear)
			rc = encode_row(ml->params.color, w->color[i], w->runs,
			    maps->width, chans, err);
		if (rc == BAKE_OK)
			bake_pixels_put(
			    &maps->color[i], 0, y, maps->width, w->color[i]);
	}
	return rc;
}

static enum bake_status
do_band(struct worker *w, const struct bake_multilayer *ml,
    struct bake_layer_maps *maps, int y0, struct bake_err *err)
{
	const struct bake_layer_params layers = { ml->params.format,
		maps->nlayers, ml->params.policy };
	int nrows = maps->height - y0 < BAKE_BAND_ROWS ? maps->height - y0
						       : BAKE_BAND_ROWS;
	enum bake_status rc =
	    bake_abuffer_rows(ml->rays, y0, nrows, &w->band, err);
	struct bake_multilayer_stats found = { .rays = w->band.stats };

	if (rc == BAKE_OK)
		bake_multilayer_stats_add(&w->stats, &found);
	for (int y = y0; y < y0 + nrows && rc == BAKE_OK; y++) {
		clear_rows(w, maps);
		for (int x = 0; x < maps->width && rc == BAKE_OK; x++) {
			const struct bake_crossing *c;
			int n = 0;

			rc = layers_of(w, ml, x, y, &layers, &c, &n, err);
			if (rc != BAKE_OK || n == 0)
				continue;
			put_texel(w, ml, c, n, x, y);
			put_colors(w, ml, c, n, maps->ncolors, x, y);
		}
		if (rc == BAKE_OK)
			rc = put_rows(w, ml, maps, y, err);
	}
	return rc;
}

/* -- all bands --------------------------------------------------------------
 */

/* What the threads share: the next band, the first failure. */
struct job {
	const struct bake_multilayer *ml;
	struct bake_layer_maps *maps; /* NULL: only count */
	struct bake_multilayer_stats *stats;
	struct bake_err *err;
	enum bake_status rc;
	int nbands, done;
};

static void
finish_worker(struct job *job, struct worker *w, enum bake_status rc,
    const struct bake_err *err)
{
#pragma omp critical(bake_multilayer)
	{
		if (rc != BAKE_OK && job->rc == BAKE_OK) {
			job->rc = rc;
			*job->err = *err;
		}
		bake_multilayer_stats_add(job->stats, &w->stats);
	}
	free_worker(w);
}

static void
report(struct job *job)
{
	const struct bake_progress *p = &job->ml->params.progress;
	int done;

#pragma omp atomic capture
	done = ++job->done;
	if (p->report != NULL && omp_get_thread_num() == 0)
		p->report(p->arg, (double)done / job->nbands);
}

/* Each band's texels and counts are its own, so that it does not matter which
 * thread does which. */
static enum bake_status
do_bands(struct job *job)
{
	const struct bake_multilayer *ml = job->ml;

	job->nbands =
	    (ml->params.view.height + BAKE_BAND_ROWS - 1) / BAKE_BAND_ROWS;
#pragma omp parallel num_threads(bake_threads(ml->params.nthreads))
	{
		struct bake_layer_maps none = BAKE_LAYER_MAPS_INIT;
		struct bake_layer_maps *maps = job->maps;
		struct bake_err err = BAKE_ERR_INIT;
		struct worker w;
		enum bake_status rc =
		    make_worker(&w, maps != NULL ? maps : &none, &err);

#pragma omp for schedule(dynamic, 1)
		for (int b = 0; b < job->nbands; b++) {
			int y0 = b * BAKE_BAND_ROWS;
			int left = ml->params.view.height - y0;

			if (rc != BAKE_OK)
				continue;
			if (maps != NULL)
				rc = do_band(&w, ml, maps, y0, &err);
			else
				rc = bake_abuffer_rows(ml->rays, y0,
				    left < BAKE_BAND_ROWS ? left
							  : BAKE_BAND_ROWS,
				    &w.band, &err);
			if (maps == NULL &&
			    w.band.stats.most > w.stats.rays.most)
				w.stats.rays.most = w.band.stats.most;
			report(job);
		}
		finish_worker(job, &w, rc, &err);
	}
	return job->rc;
}

enum bake_status
bake_multilayer_deepest(
    struct bake_multilayer *ml, int *nlayers, struct bake_err *err)
{
	struct bake_multilayer_stats stats = { .nlayers = 0 };
	struct job job = { .ml = ml, .stats = &stats, .err = err };
	enum bake_status rc = do_bands(&job);

	*nlayers = stats.rays.most;
	return rc;
}

/* nlayers, or as many as the deepest texel has. */
static enum bake_status
count_layers(struct bake_multilayer *ml, int *nlayers, struct bake_err *err)
{
	enum bake_status rc;

	*nlayers = ml->params.nlayers;
	if (*nlayers != 0)
		return BAKE_OK;
	if ((rc = bake_multilayer_deepest(ml, nlayers, err)) != BAKE_OK)
		return rc;
	if (*nlayers > BAKE_LAYERS_MAX)
		return bake_fail(err, BAKE_ELIMIT,
		    "a texel has %d layers, textures hold %d at most: cap "
		    "them, or write a deep image",
		    *nlayers, BAKE_LAYERS_MAX);
	*nlayers = *nlayers > 2 ? *nlayers : 2;
	return BAKE_OK;
}

enum bake_status
bake_multilayer_maps(struct bake_multilayer *ml, struct bake_layer_maps *maps,
    struct bake_multilayer_stats *stats, struct bake_err *err)
{
	const struct bake_multilayer_params *p = &ml->params;
	struct job job = { .ml = ml, .maps = maps, .stats = stats, .err = err };
	int nlayers;
	enum bake_status rc = count_layers(ml, &nlayers, err);

	memset(stats, 0, sizeof *stats);
	if (rc == BAKE_OK)
		rc = bake_layer_maps_alloc(maps, p->view.width, p->view.height,
		    nlayers, p->format,
		    p->ncolors < nlayers ? p->ncolors : nlayers,
		    p->coverage ? 4 : 3, p->format, err);
	if (rc != BAKE_OK)
		return rc;
	maps->color_linear = bake_data_format_max(p->format) == 0;
	rc = do_bands(&job);
	stats->nlayers = nlayers;
	if (rc != BAKE_OK)
		bake_layer_maps_free(maps);
	return rc;
}
