/* The A-buffer: bands of rows, from spans to sorted crossings. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "abuffer_priv.h"
#include "mem.h"

/* Room for n elements, whose old contents may go: the array, which has room for
 * *room, or another. NULL: no memory, and none is left. */
static void *
renew(void *old, size_t *room, size_t n, size_t size, struct bake_err *err)
{
	if (n <= *room && old != NULL)
		return old;
	free(old);
	*room = n;
	if ((old = bake_alloc(n, size, err)) == NULL)
		*room = 0;
	return old;
}

/* Spans by row. They stay where they are, but their addresses are known far
 * ahead, as in lists they are not. */
static enum bake_status
sort_spans(struct bake_band_scratch *s, int nrows, struct bake_err *err)
{
	uint32_t *order =
	    renew(s->order, &s->orders, s->nspans, sizeof *order, err);
	uint32_t sum = 0;

	s->order = order;
	if (order == NULL)
		return BAKE_ENOMEM;
	/* row[y + 1], how many, becomes where y begins, and then where it ends,
	 * which is where y + 1 begins */
	for (int y = 0; y < nrows; y++) {
		uint32_t n = s->row[y + 1];

		s->row[y + 1] = sum;
		sum += n;
	}
	for (uint32_t i = 0; i < s->nspans; i++)
		order[s->row[s->row_of[i] + 1]++] = i;
	return BAKE_OK;
}

/* Fill raw with the row's crossings; those of texel x end before at[x], where
 * those of x + 1 begin. */
static enum bake_status
fill_row(struct bake_band_scratch *s, int row, int width, struct bake_err *err)
{
	uint32_t *at = s->at, layers = 0, sum = 0;
	struct abuffer_raw *raw;
	size_t total = 0;

	memset(at, 0, ((size_t)width + 1) * sizeof *at);
	/* at[x]: how many more there are than at x - 1, modulo 2^32 */
	for (uint32_t i = s->row[row]; i < s->row[row + 1]; i++) {
		const struct abuffer_span *p = &s->span[s->order[i]];

		if (i + ABUFFER_AHEAD < s->row[row + 1])
			__builtin_prefetch(
			    &s->span[s->order[i + ABUFFER_AHEAD]]);
		at[p->x]++;
		at[p->x + p->n]--;
		total += p->n;
	}
	if (total > UINT32_MAX)
		return bake_fail(err, BAKE_ENOMEM,
		    "%zu crossings in one row of %d texels", total, width);
	raw = s->raw = renew(s->raw, &s->raws, total, sizeof *raw, err);
	if (raw == NULL)
		return BAKE_ENOMEM;
	for (int x = 0; x < width; x++) {
		layers += at[x];
		at[x] = sum;
		sum += layers;
	}
	for (uint32_t i = s->row[row]; i < s->row[row + 1]; i++) {
		const struct abuffer_span p = s->span[s->order[i]];

		for (uint32_t k = 0; k < p.n; k++)
			raw[at[p.x + k]++] =
			    (struct abuffer_raw){ p.depth + k * p.slope, p.key,
				    p.tile_x, p.tile_y };
	}
	return BAKE_OK;
}

static enum bake_status
resolve_row(const struct bake_abuffer *ab, struct bake_band *band, int row,
    struct bake_err *err)
{
	struct bake_band_scratch *s = band->scratch;
	const int width = ab->view.width;
	size_t *start = band->start + (size_t)row * (size_t)width;
	enum bake_status rc;

	if (s->row[row] == s->row[row + 1]) {
		for (int x = 1; x <= width; x++)
			start[x] = start[0];
		return BAKE_OK;
	}
	if ((rc = fill_row(s, row, width, err)) == BAKE_OK)
		bake_abuffer_resolve(s->raw, s->at, width, ab->half, start,
		    band->crossing, &band->stats);
	return rc;
}

/* -- bands --------------------------------------------------------------- */

static enum bake_status
make_room(const struct bake_abuffer *ab, int nrows, struct bake_band *band,
    struct bake_err *err)
{
	struct bake_band_scratch *s = band->scratch;
	size_t texels, width = (size_t)ab->view.width;

	if (s == NULL)
		s = band->scratch = bake_zalloc(1, sizeof *s, err);
	if (s == NULL)
		return BAKE_ENOMEM;
	if (!bake_mul_size(width, (size_t)nrows, &texels))
		texels = SIZE_MAX - 1;
	band->start = renew(
	    band->start, &s->starts, texels + 1, sizeof *band->start, err);
	s->row =
	    renew(s->row, &s->rows, (size_t)nrows + 1, sizeof *s->row, err);
	s->at = renew(s->at, &s->ats, width + 1, sizeof *s->at, err);
	return band->start != NULL && s->row != NULL && s->at != NULL
		   ? BAKE_OK
		   : BAKE_ENOMEM;
}

static enum bake_status
fill_band(const struct bake_abuffer *ab, int y0, int nrows,
    struct bake_band *band, struct bake_err *err)
{
	struct bake_band_scratch *s;
	enum bake_status rc;
	size_t n;

	if ((rc = make_room(ab, nrows, band, err)) != BAKE_OK)
		return rc;
	s = band->scratch;
	if ((rc = bake_abuffer_draw(ab, y0, nrows, s, err)) != BAKE_OK)
		return rc;
	if ((rc = sort_spans(s, nrows, err)) != BAKE_OK)
		return rc;
	/* a slab has two ends */
	if (!bake_mul_size(s->total, ab->half > 0 ? 2 : 1, &n))
		n = SIZE_MAX;
	band->crossing =
	    renew(band->crossing, &s->out, n, sizeof *band->crossing, err);
	if (band->crossing == NULL)
		return BAKE_ENOMEM;
	band->stats = (struct bake_abuffer_stats){ 0 };
	band->start[0] = 0;
	for (int y = 0; y < nrows; y++)
		if ((rc = resolve_row(ab, band, y, err)) != BAKE_OK)
			return rc;
	band->y0 = y0;
	band->nrows = nrows;
	return BAKE_OK;
}

enum bake_status
bake_abuffer_rows(const struct bake_abuffer *ab, int y0, int nrows,
    struct bake_band *band, struct bake_err *err)
{
	enum bake_status rc;

	if (y0 < 0 || nrows < 1 || nrows > ab->view.height - y0)
		rc = bake_fail(err, BAKE_EINVAL,
		    "%d rows from row %d on of a picture of %d", nrows, y0,
		    ab->view.height);
	else
		rc = fill_band(ab, y0, nrows, band, err);
	if (rc != BAKE_OK)
		bake_band_free(band);
	return rc;
}

void
bake_band_free(struct bake_band *band)
{
	struct bake_band_scratch *s = band->scratch;

	if (s != NULL) {
		free(s->span);
		free(s->row_of);
		free(s->order);
		free(s->row);
		free(s->at);
		free(s->raw);
		free(s);
	}
	free(band->start);
	free(band->crossing);
	*band = (struct bake_band)BAKE_BAND_INIT;
}
