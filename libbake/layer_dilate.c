/* Dilation of normals and colours into texels with fewer layers. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "layer_priv.h"
#include "mem.h"
#include "parallel.h"

enum { FARTHEST = 4096, NONE = INT16_MAX };

struct dilation {
	struct bake_layer_maps *maps;
	int n, layer;
	bool tile_x, tile_y;
	/* [height][width] dy to the nearest texel of the column that has the
	 * layer, the one above of two; NONE: none within n */
	int16_t *dy;
};

static bool
has_layer(const struct dilation *d, size_t texel)
{
	return bake_layer_codes_of(d->maps, texel, NULL) > d->layer;
}

/* One step of a column's sweep: how far behind the last one is that has the
 * layer. */
static int
one_farther(int distance, int n)
{
	return distance < n ? distance + 1 : NONE;
}

/*
 * Columns x0 .. x1 - 1, swept down for what lies above and up for what lies
 * below. On a torus the sweep begins with n rows of the other side, so that
 * what comes before the first row is known.
 */
static void
sweep_columns(const struct dilation *d, int x0, int x1, int16_t *away)
{
	const int h = d->maps->height, n = d->n;
	const int before = !d->tile_y ? 0 : n < h ? n : h;
	const size_t w = (size_t)d->maps->width;

	for (int x = x0; x < x1; x++)
		away[x] = NONE;
	for (int i = -before; i < h; i++) {
		int16_t *row = d->dy + (size_t)(i < 0 ? i + h : i) * w;

		for (int x = x0; x < x1; x++) {
			/* the first time round, rows are as they were marked */
			away[x] =
			    row[x] == 0 ? 0 : (int16_t)one_farther(away[x], n);
			if (i >= 0 && away[x] != NONE)
				row[x] = (int16_t)-away[x];
		}
	}
	for (int x = x0; x < x1; x++)
		away[x] = NONE;
	for (int i = h + before - 1; i >= 0; i--) {
		int16_t *row = d->dy + (size_t)(i >= h ? i - h : i) * w;

		for (int x = x0; x < x1; x++) {
			away[x] =
			    row[x] == 0 ? 0 : (int16_t)one_farther(away[x], n);
			if (i < h && away[x] < abs(row[x]))
				row[x] = away[x];
		}
	}
}

/* Returns whether the row has any texel with the layer. */
static bool
mark_row(const struct dilation *d, int y)
{
	const size_t first = (size_t)y * (size_t)d->maps->width;
	bool any = false;

	for (int x = 0; x < d->maps->width; x++) {
		const bool has = has_layer(d, first + (size_t)x);

		any = any || has;
		d->dy[first + (size_t)x] = has ? 0 : NONE;
	}
	return any;
}

/* Whether any column of row y has a texel with the layer within n. */
static bool
is_near_any(const struct dilation *d, int y)
{
	const int16_t *row = d->dy + (size_t)y * (size_t)d->maps->width;

	for (int x = 0; x < d->maps->width; x++)
		if (row[x] != NONE)
			return true;
	return false;
}

/* Column x + dx, or -1 where there is none. */
static int
column_at(const struct dilation *d, int x, int dx)
{
	const int w = d->maps->width;

	x += dx;
	if (x >= 0 && x < w)
		return x;
	return d->tile_x ? bake_wrap_index(x, w, false) : -1;
}

/* The nearest texel to (x, y) that has the layer; false: none within n. Columns
 * are tried from the middle outwards, as long as they can be nearer. */
static bool
find_nearest(const struct dilation *d, int x, int y, size_t *source)
{
	const int w = d->maps->width, h = d->maps->height;
	const int16_t *row = d->dy + (size_t)y * (size_t)w;
	const int most = d->n < w ? d->n : w;
	long best = (long)d->n * d->n + 1;
	bool found = false;

	for (int a = 0; a <= most && (long)a * a < best; a++)
		for (int side = -1; side <= 1; side += 2) {
			const int at = column_at(d, x, side * a);
			long dy, off;

			if (at < 0 || row[at] == NONE)
				continue;
			dy = row[at];
			off = (long)a * a + dy * dy;
			if (off >= best)
				continue;
			best = off;
			found = true;
			*source = (size_t)bake_wrap_index(y + dy, h, false) *
				      (size_t)w +
				  (size_t)at;
		}
	return found;
}

/* Values first .. first + n - 1 of a texel become those of another. */
static void
copy_values(const struct bake_pixels *px, size_t to, size_t from, size_t first,
    size_t n)
{
	const size_t size = bake_data_format_size(px->format);
	const size_t nchans = (size_t)px->nchans;
	char *data = px->data;

	memcpy(data + (to * nchans + first) * size,
	    data + (from * nchans + first) * size, n * size);
}

/* Sources have the layer and targets have not: no texel is both. */
static void
fill_row(const struct dilation *d, int y)
{
	const struct bake_layer_maps *m = d->maps;
	const size_t first = (size_t)y * (size_t)m->width;
	const int t = d->layer / 4;

	if (!is_near_any(d, y))
		return;
	for (int x = 0; x < m->width; x++) {
		const size_t to = first + (size_t)x;
		size_t from;

		if (d->dy[to] == 0 || !find_nearest(d, x, y, &from))
			continue;
		copy_values(&m->nx[t], to, from, (size_t)(d->layer % 4), 1);
		copy_values(&m->ny[t], to, from, (size_t)(d->layer % 4), 1);
		if (d->layer < m->ncolors)
			copy_values(&m->color[d->layer], to, from, 0, 3);
	}
}

static void
dilate_layer(const struct dilation *d, int nthreads, int16_t *away)
{
	enum { COLUMNS = 64 };
	const int w = d->maps->width, h = d->maps->height;
	int nrows = 0;

#pragma omp parallel for schedule(static) num_threads(nthreads)                \
    reduction(+ : nrows)
	for (int y = 0; y < h; y++)
		nrows += mark_row(d, y);
	if (nrows == 0)
		return;
#pragma omp parallel num_threads(nthreads)
	{
#pragma omp for schedule(static)
		for (int b = 0; b <= (w - 1) / COLUMNS; b++) {
			const int x0 = b * COLUMNS;
			const int x1 = w - x0 < COLUMNS ? w : x0 + COLUMNS;

			sweep_columns(d, x0, x1, away);
		}
#pragma omp for schedule(dynamic, 16)
		for (int y = 0; y < h; y++)
			fill_row(d, y);
	}
}

enum bake_status
bake_layer_dilate(struct bake_layer_maps *maps, int n, bool tile_x, bool tile_y,
    int nthreads, struct bake_err *err)
{
	struct dilation d = { maps, n, 0, tile_x, tile_y, NULL };
	const size_t w = (size_t)maps->width, h = (size_t)maps->height;
	int16_t *away;

	if (n < 0 || n > FARTHEST)
		return bake_fail(err, BAKE_EINVAL,
		    "dilation by %d texels, expected 0 to %d", n, FARTHEST);
	if (n == 0)
		return BAKE_OK;
	away = bake_alloc(w, sizeof *away, err);
	d.dy = bake_alloc(h, w * sizeof *d.dy, err);
	if (away != NULL && d.dy != NULL)
		for (d.layer = 0; d.layer < maps->nlayers; d.layer++)
			dilate_layer(&d, bake_threads(nthreads), away);
	free(away);
	free(d.dy);
	return away != NULL && d.dy != NULL ? BAKE_OK : BAKE_ENOMEM;
}
