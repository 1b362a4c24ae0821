/* Multilayer relief: rows of a deep image, every layer kept. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "mem.h"
#include "multilayer_priv.h"

void
bake_deep_rows_free(struct bake_deep_rows *rows)
{
	const struct bake_deep_rows init = BAKE_DEEP_ROWS_INIT;

	free(rows->count);
	free(rows->depth);
	free(rows->normal);
	free(rows->color);
	*rows = init;
}

static enum bake_status
alloc_rows(struct bake_deep_rows *rows, size_t ntexels, size_t room,
    bool colors, struct bake_err *err)
{
	rows->count = bake_alloc(ntexels, sizeof *rows->count, err);
	rows->depth = bake_alloc(room, sizeof *rows->depth, err);
	rows->normal = bake_alloc(room, sizeof *rows->normal, err);
	if (colors)
		rows->color = bake_alloc(room, sizeof *rows->color, err);
	return rows->count != NULL && rows->depth != NULL &&
		       rows->normal != NULL && (!colors || rows->color != NULL)
		   ? BAKE_OK
		   : BAKE_ENOMEM;
}

/* Append the layers of texel (x, y). */
static void
put_texel(const struct bake_multilayer *ml, struct bake_deep_rows *rows,
    const struct bake_crossing *crossing, const struct bake_layer *layer, int n,
    int x, int y)
{
	for (int i = 0; i < n; i++) {
		const struct bake_crossing *c = crossing + layer[i].crossing;
		size_t s = rows->nsamples++;

		rows->depth[s] = (float)bake_layer_depth(
		    (double)bake_layer_value(layer[i].code, BAKE_DATA_FLOAT));
		bake_surface_normal(ml->surface, c, x, y, rows->normal[s]);
		if (rows->color != NULL)
			bake_surface_color(
			    ml->surface, c, x, y, rows->color[s]);
	}
}

/* The most crossings of a texel of the band. */
static size_t
most_crossings(const struct bake_band *band, size_t ntexels)
{
	size_t most = 0;

	for (size_t i = 0; i < ntexels; i++)
		if (band->start[i + 1] - band->start[i] > most)
			most = band->start[i + 1] - band->start[i];
	return most;
}

static void
put_rows(const struct bake_multilayer *ml, const struct bake_band *band,
    struct bake_layer *layer, struct bake_deep_rows *rows,
    struct bake_multilayer_stats *stats)
{
	const struct bake_layer_params uncapped = { BAKE_DATA_FLOAT, 0,
		BAKE_CAP_SMALLEST };
	const size_t width = (size_t)ml->params.view.width;

	for (size_t i = 0; i < width * (size_t)rows->nrows; i++) {
		const struct bake_crossing *c = band->crossing + band->start[i];
		int n = bake_layer_quantize(c,
		    (int)(band->start[i + 1] - band->start[i]), &uncapped,
		    layer, &stats->codes);

		rows->count[i] = (unsigned)n;
		stats->histogram[n < BAKE_LAYERS_MAX ? n : BAKE_LAYERS_MAX]++;
		if (n > stats->nlayers)
			stats->nlayers = n;
		put_texel(ml, rows, c, layer, n, (int)(i % width),
		    rows->y0 + (int)(i / width));
	}
}

enum bake_status
bake_multilayer_deep(const struct bake_multilayer *ml, int y0, int nrows,
    struct bake_deep_rows *rows, struct bake_multilayer_stats *stats,
    struct bake_err *err)
{
	const size_t ntexels = (size_t)ml->params.view.width * (size_t)nrows;
	struct bake_band band = BAKE_BAND_INIT;
	struct bake_layer *layer = NULL;
	enum bake_status rc =
	    bake_abuffer_rows(ml->rays, y0, nrows, &band, err);

	rows->y0 = y0;
	rows->nrows = nrows;
	if (rc == BAKE_OK)
		rc = alloc_rows(rows, ntexels, band.start[ntexels],
		    ml->params.ncolors > 0, err);
	if (rc == BAKE_OK) {
		layer = bake_alloc(
		    most_crossings(&band, ntexels), sizeof *layer, err);
		rc = layer != NULL ? BAKE_OK : BAKE_ENOMEM;
	}
	if (rc == BAKE_OK) {
		struct bake_multilayer_stats found = { .rays = band.stats };

		put_rows(ml, &band, layer, rows, &found);
		bake_multilayer_stats_add(stats, &found);
	} else
		bake_deep_rows_free(rows);
	free(layer);
	bake_band_free(&band);
	return rc;
}
