/* Which pieces touch which tiles. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "mem.h"
#include "raster_priv.h"

/*
 * Visit the tiles of a share of the pieces: count them in at, or, where bins is
 * there, put the pieces into bins at places at[tile]++.
 */
struct visit {
	size_t *at;
	uint32_t *bins;
};

static void
touch(const struct visit *v, int tile, size_t piece)
{
	if (v->bins != NULL)
		v->bins[v->at[tile]] = (uint32_t)piece;
	v->at[tile]++;
}

/* Whether no sample of the box is inside of one of the edges. */
static bool
is_outside(const struct raster_edge edges[3], const struct raster_box *box)
{
	for (int i = 0; i < 3; i++) {
		const struct raster_edge *e = &edges[i];
		int64_t x = e->a > 0 ? box->x1 : box->x0;
		int64_t y = e->b > 0 ? box->y1 : box->y0;

		if (e->c + e->a * x + e->b * y < 0)
			return true;
	}
	return false;
}

static void
visit_piece(const struct bake_raster *r, const struct visit *v, size_t piece)
{
	enum { N = BAKE_RASTER_TILE };
	struct raster_box box = bake_raster_bounds(r, &r->pieces[piece]);
	struct raster_edge edges[3];
	int tx0 = box.x0 / N, ty0 = box.y0 / N;
	int tx1 = box.x1 / N, ty1 = box.y1 / N;

	if (tx0 == tx1 && ty0 == ty1) {
		touch(v, ty0 * r->columns + tx0, piece);
		return;
	}
	bake_raster_edges(&r->pieces[piece], edges);
	for (int ty = ty0; ty <= ty1; ty++)
		for (int tx = tx0; tx <= tx1; tx++) {
			struct raster_box tile = { tx * N, ty * N,
				tx * N + N - 1, ty * N + N - 1 };

			if (!is_outside(edges, &tile))
				touch(v, ty * r->columns + tx, piece);
		}
}

/* Shares of the pieces, in order, so that bins do not depend on who is first.
 */
static void
visit_all(const struct bake_raster *r, int nshares, size_t *at, uint32_t *bins)
{
	const size_t n = r->npieces, shares = (size_t)nshares;

#pragma omp parallel for schedule(static, 1) num_threads(nshares)
	for (size_t s = 0; s < shares; s++) {
		struct visit v = { at + s * (size_t)r->ntiles, bins };

		for (size_t i = n / shares * s;
		     i < (s + 1 == shares ? n : n / shares * (s + 1)); i++)
			visit_piece(r, &v, i);
	}
}

enum bake_status
bake_raster_bin(struct bake_raster *r, int nthreads, struct bake_err *err)
{
	const size_t ntiles = (size_t)r->ntiles;
	/* a share has a counter for each tile: no more of them than pieces */
	const int nshares = r->npieces / ntiles + 1 < (size_t)nthreads
				? (int)(r->npieces / ntiles) + 1
				: nthreads;
	enum bake_status rc = BAKE_ENOMEM;
	size_t *at, sum = 0;

	at = bake_zalloc((size_t)nshares * ntiles, sizeof *at, err);
	if (at == NULL)
		goto out;
	r->start = bake_alloc(ntiles + 1, sizeof *r->start, err);
	if (r->start == NULL)
		goto out;
	visit_all(r, nshares, at, NULL);
	for (size_t i = 0; i < ntiles; i++) {
		r->start[i] = sum;
		for (size_t s = 0; s < (size_t)nshares; s++) {
			size_t count = at[s * ntiles + i];

			at[s * ntiles + i] = sum;
			sum += count;
		}
	}
	r->start[ntiles] = sum;
	if ((r->bins = bake_alloc(sum, sizeof *r->bins, err)) == NULL)
		goto out;
	visit_all(r, nshares, at, r->bins);
	rc = BAKE_OK;
out:
	free(at);
	return rc;
}
