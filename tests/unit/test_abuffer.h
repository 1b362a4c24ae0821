/* A-buffers of whole pictures, for the tests of them. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_ABUFFER_H
#define TEST_ABUFFER_H

#include "abuffer.h"
#include "check.h"
#include "test_solid.h"

/* A picture: all bands as one. */
struct layers {
	size_t n;
	size_t *start; /* [width * height + 1] */
	struct bake_crossing *crossing;
	struct bake_abuffer_stats stats;
};

static inline void *
layers_grow(void *p, size_t n, size_t size)
{
	p = realloc(p, (n + 1) * size);
	if (p == NULL)
		abort();
	return p;
}

/* Whether a texel's crossings are as abuffer.h promises. */
static inline bool
is_balanced(const struct bake_crossing *c, size_t n)
{
	for (size_t i = 0; i < n; i++)
		if (c[i].entering != (i % 2 == 0) || !isfinite(c[i].depth) ||
		    (i > 0 && c[i].depth < c[i - 1].depth))
			return false;
	return n % 2 == 0;
}

/* All rows, rows_at_once each; the mesh is welded at distance 0. */
static inline struct layers
layers_make(const struct bake_mesh *m, const struct bake_view *view,
    const struct bake_abuffer_params *params, int rows_at_once)
{
	struct layers l = { 0, NULL, NULL, { 0 } };
	struct bake_weld weld = BAKE_WELD_INIT;
	struct bake_band band = BAKE_BAND_INIT;
	struct bake_abuffer *ab = NULL;
	struct bake_err err = BAKE_ERR_INIT;
	size_t width = (size_t)view->width, texels = 0, bad = 0;

	CHECK_OK(bake_mesh_weld(m, 0, &weld, &err), err);
	CHECK_OK(bake_abuffer_open(&ab, m, &weld, view, params, &err), err);
	l.start =
	    layers_grow(NULL, width * (size_t)view->height, sizeof(size_t));
	l.start[0] = 0;
	for (int y = 0; ab != NULL && y < view->height; y += rows_at_once) {
		int n = view->height - y;
		size_t count;

		n = n < rows_at_once ? n : rows_at_once;
		CHECK_OK(bake_abuffer_rows(ab, y, n, &band, &err), err);
		if (band.nrows != n || band.y0 != y || band.start[0] != 0)
			abort();
		count = band.start[(size_t)n * width];
		l.crossing =
		    layers_grow(l.crossing, l.n + count, sizeof *l.crossing);
		memcpy(l.crossing + l.n, band.crossing,
		    count * sizeof *l.crossing);
		for (size_t i = 0; i < (size_t)n * width; i++) {
			l.start[++texels] = l.n + band.start[i + 1];
			bad += !is_balanced(band.crossing + band.start[i],
			    band.start[i + 1] - band.start[i]);
		}
		l.n += count;
		l.stats.open += band.stats.open;
		l.stats.inside_out += band.stats.inside_out;
		l.stats.united += band.stats.united;
		l.stats.crossings += band.stats.crossings;
		if (band.stats.most > l.stats.most)
			l.stats.most = band.stats.most;
	}
	CHECK(bad == 0);
	bake_band_free(&band);
	bake_abuffer_close(ab);
	bake_weld_free(&weld);
	return l;
}

static inline void
layers_free(struct layers *l)
{
	free(l->start);
	free(l->crossing);
}

/* Crossings of texel i. */
static inline size_t
layers_at(const struct layers *l, size_t i, const struct bake_crossing **c)
{
	*c = l->crossing + l->start[i];
	return l->start[i + 1] - l->start[i];
}

static inline bool
same_crossing(const struct bake_crossing *a, const struct bake_crossing *b)
{
	return a->depth == b->depth && a->entering == b->entering &&
	       a->triangle == b->triangle && a->tile_x == b->tile_x &&
	       a->tile_y == b->tile_y;
}

#endif
