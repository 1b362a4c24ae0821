/* The A-buffer: the texels of triangles, row by row, in exact integers. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "abuffer_priv.h"
#include "mem.h"

/* Where rows of one bin are drawn: lo to hi - 1 of the picture. */
struct canvas {
	const struct bake_abuffer *ab;
	struct bake_band_scratch *scratch;
	struct bake_err *err;
	int y0, lo, hi;
};

/*
 * A triangle ready to draw: p0, p1, p2 its corners from top to bottom (from
 * left to right where equally high), so that neither the order of the mesh's
 * corners nor their sense changes a bit of its depths.
 *   x, y    p1 - p0 and p2 - p0
 *   base    the column of p0, which numbers are counted from
 *   grow    (depth of p1 and p2 - depth of p0) / area, and slope: what depth
 *           grows by to the next column; once has_depth
 *   first, columns  those whose centres are in its extent
 *   wide    its extent is not ABUFFER_SMALL
 */
struct triangle {
	const struct abuffer_point *p[3];
	int64_t x[2], y[2];
	int64_t base, first, columns;
	double area, grow[2], slope;
	uint32_t key;
	bool wide, has_depth;
};

/* a x b: its sign is exact. */
static inline double
cross(int64_t ax, int64_t ay, int64_t bx, int64_t by, bool wide)
{
	if (wide)
		return (double)((abuffer_wide)ax * by - (abuffer_wide)ay * bx);
	return (double)(ax * by - ay * bx);
}

/*
 * Where an edge that goes down from p to q crosses the rows' centres: column
 * is the first whose centre is at the crossing or to its right, counted from
 * base. With dx, dy the edge's extent and
 *     m = ceil(((p_x - 2^15) dy + (c - p_y) dx) / 2^16)
 * in the row whose centre is c, this is ceil(m / dy), and m grows by just dx a
 * row, so that column and rest = m + dy - 1 - column dy are carried on without
 * a division.
 */
struct edge {
	int64_t column, rest, dy, step, step_rest;
};

static inline struct edge
edge_start(const struct triangle *t, const struct abuffer_point *p,
    const struct abuffer_point *q, int64_t row)
{
	const int64_t unit = 1 << ABUFFER_BITS;
	struct edge e;
	int64_t dx = q->x - p->x, m;
	int64_t x = p->x - abuffer_centre(t->base);
	int64_t y = abuffer_centre(row) - p->y;

	e.dy = q->y - p->y;
	if (t->wide) {
		abuffer_wide w = (abuffer_wide)x * e.dy + (abuffer_wide)y * dx;

		/* as wide as m may be, its quotient is a column */
		w = ((w + unit - 1) >> ABUFFER_BITS) + e.dy - 1;
		e.column = (int64_t)(w / e.dy);
		e.rest = (int64_t)(w % e.dy);
		e.column -= e.rest < 0;
		e.rest += e.rest < 0 ? e.dy : 0;
	} else {
		m = x * e.dy + y * dx;
		m = ((m + unit - 1) >> ABUFFER_BITS) + e.dy - 1;
		e.column = abuffer_floor_div(m, e.dy);
		e.rest = m - e.column * e.dy;
	}
	/* an edge of one row takes no step */
	e.step = e.step_rest = 0;
	if (q->y - abuffer_centre(row) > unit) {
		e.step = abuffer_floor_div(dx, e.dy);
		e.step_rest = dx - e.step * e.dy;
	}
	return e;
}

static inline void
edge_step(struct edge *e)
{
	e->column += e->step;
	e->rest += e->step_rest;
	if (e->rest >= e->dy) {
		e->rest -= e->dy;
		e->column++;
	}
}

/* Many a small triangle has rows, but no texel's centre: what only spans need
 * waits for the first. */
static void
set_up_depth(struct triangle *t)
{
	const double unit = 1 << ABUFFER_BITS;

	for (int k = 0; k < 2; k++)
		t->grow[k] = (t->p[k + 1]->depth - t->p[0]->depth) / t->area;
	t->slope =
	    ((double)t->y[1] * t->grow[0] - (double)t->y[0] * t->grow[1]) *
	    unit;
	t->has_depth = true;
}

/* The depth at a point of the edge from p to q: from p and q alone, so that all
 * triangles that share it agree on every bit. */
static double
depth_on_edge(const struct abuffer_point *p, const struct abuffer_point *q,
    int64_t x, int64_t y)
{
	int64_t all = q->y - p->y, part = y - p->y;

	if (all == 0) {
		all = q->x - p->x;
		part = x - p->x;
	}
	if (part == all)
		return q->depth;
	return p->depth + (double)part / (double)all * (q->depth - p->depth);
}

/*
 * The depth at a point of a triangle, with u its place from p0:
 *     d0 + (e1 (d1 - d0) + e2 (d2 - d0)) / area
 * with the exact edge functions e1 = u x (p2 - p0) and e2 = (p1 - p0) x u. They
 * are between 0 and the area, so that nothing cancels in slivers, whose
 * gradients are huge.
 */
static inline double
depth_at(const struct triangle *t, int64_t x, int64_t y)
{
	const struct abuffer_point *const *p = t->p;
	int64_t ux = x - p[0]->x, uy = y - p[0]->y;
	double e1 = cross(ux, uy, t->x[1], t->y[1], t->wide);
	double e2 = cross(t->x[0], t->y[0], ux, uy, t->wide);

	if (e2 == 0)
		return depth_on_edge(p[0], p[1], x, y);
	if (e1 == 0)
		return depth_on_edge(p[0], p[2], x, y);
	if (cross(x - p[1]->x, y - p[1]->y, t->x[1] - t->x[0],
		t->y[1] - t->y[0], t->wide) == 0)
		return depth_on_edge(p[1], p[2], x, y);
	return p[0]->depth + (e1 * t->grow[0] + e2 * t->grow[1]);
}

/* Room for n + 1 elements at *old where *room is n or less: half as many again.
 * NULL: no memory, old is as it was. */
static void *
grow(void *old, size_t n, size_t *room, size_t size, struct bake_err *err)
{
	size_t more = n < 4096 ? 4096 : n + n / 2;
	void *p = bake_alloc(more, size, err);

	if (p == NULL)
		return NULL;
	if (n > 0)
		memcpy(p, old, n * size);
	free(old);
	*room = more;
	return p;
}

static bool
more_spans(struct bake_band_scratch *s, struct bake_err *err)
{
	const size_t n = s->nspans;
	size_t room = 0;
	void *p;

	if (n == UINT32_MAX) {
		bake_fail(err, BAKE_ENOMEM, "%zu spans in one band of rows", n);
		return false;
	}
	if ((p = grow(s->row_of, n, &room, sizeof *s->row_of, err)) == NULL)
		return false;
	s->row_of = p;
	if ((p = grow(s->span, n, &s->spans, sizeof *s->span, err)) == NULL)
		return false;
	s->span = p;
	return true;
}

/* Columns begin to end - 1 of a row, all in one tile. */
static enum bake_status
add_span(const struct canvas *c, struct triangle *t, int64_t row, int64_t begin,
    int64_t end, int tile_x, int tile_y)
{
	struct bake_band_scratch *s = c->scratch;
	const struct bake_view *view = &c->ab->view;
	int64_t local = row - (int64_t)tile_y * view->height - c->y0;
	struct abuffer_span *span;

	if (s->nspans == s->spans && !more_spans(s, c->err))
		return BAKE_ENOMEM;
	if (!t->has_depth)
		set_up_depth(t);
	span = &s->span[s->nspans];
	span->depth = depth_at(t, abuffer_centre(begin), abuffer_centre(row));
	span->slope = t->slope;
	span->x = (uint32_t)(begin - (int64_t)tile_x * view->width);
	span->n = (uint32_t)(end - begin);
	span->key = t->key;
	span->tile_x = (int16_t)tile_x;
	span->tile_y = (int16_t)tile_y;
	s->row_of[s->nspans++] = (uint32_t)local;
	s->row[local + 1]++;
	s->total += span->n;
	return BAKE_OK;
}

/* The same in as many tiles as they are in; of a row whose centres are on the
 * triangle's upper edge each texel by itself, for depth_on_edge. */
static inline enum bake_status
add_columns(const struct canvas *c, struct triangle *t, int64_t row,
    int64_t begin, int64_t end, int tile_y)
{
	const int64_t width = c->ab->view.width;
	const bool on_edge = t->y[0] == 0 && t->p[0]->y == abuffer_centre(row);
	enum bake_status rc = BAKE_OK;
	int64_t tile = 0, stop;

	if (!c->ab->view.tile_x) {
		begin = begin < 0 ? 0 : begin;
		end = end > width ? width : end;
	}
	for (; rc == BAKE_OK && begin < end; begin = stop) {
		stop = end;
		if (c->ab->view.tile_x) {
			tile = abuffer_floor_div(begin, width);
			stop = (tile + 1) * width;
			stop = stop < end ? stop : end;
		}
		if (on_edge)
			stop = begin + 1;
		rc = add_span(c, t, row, begin, stop, (int)tile, tile_y);
	}
	return rc;
}

/* Rows begin to end - 1. A row whose centre is at a corner, or along an edge,
 * belongs to what is below; columns to what is on the right. */
static enum bake_status
draw_rows(const struct canvas *c, struct triangle *t, int64_t begin,
    int64_t end, int tile_y)
{
	const struct abuffer_point *const *p = t->p;
	const int64_t middle = abuffer_ceil(p[1]->y);
	const bool long_left = t->area > 0;
	struct edge full = edge_start(t, p[0], p[2], begin), half;
	enum bake_status rc = BAKE_OK;

	if (begin < middle)
		half = edge_start(t, p[0], p[1], begin);
	else
		half = edge_start(t, p[1], p[2], begin);
	for (int64_t row = begin; rc == BAKE_OK;) {
		int64_t l = long_left ? full.column : half.column;
		int64_t r = long_left ? half.column : full.column;

		if (l < r)
			rc = add_columns(
			    c, t, row, t->base + l, t->base + r, tile_y);
		if (++row == end)
			break;
		edge_step(&full);
		if (row == middle)
			half = edge_start(t, p[1], p[2], row);
		else
			edge_step(&half);
	}
	return rc;
}

/* The column of struct edge, of the two that a triangle has: no division. */
static inline int64_t
narrow_column(const struct triangle *t, const struct abuffer_point *p,
    const struct abuffer_point *q, int64_t row)
{
	int64_t dy = q->y - p->y;
	int64_t n = (p->x - abuffer_centre(t->first)) * dy +
		    (abuffer_centre(row) - p->y) * (q->x - p->x);

	return t->first + (n > 0) + (n > dy * (1 << ABUFFER_BITS));
}

/* draw_rows for one or two columns, as most triangles of fine meshes have. */
static enum bake_status
draw_narrow(const struct canvas *c, struct triangle *t, int64_t begin,
    int64_t end, int tile_y)
{
	const struct abuffer_point *const *p = t->p;
	const int64_t middle = abuffer_ceil(p[1]->y);
	enum bake_status rc = BAKE_OK;

	for (int64_t row = begin; rc == BAKE_OK && row < end; row++) {
		int64_t l = narrow_column(t, p[0], p[2], row);
		int64_t r = row < middle ? narrow_column(t, p[0], p[1], row)
					 : narrow_column(t, p[1], p[2], row);

		if (t->area < 0) {
			int64_t swap = l;

			l = r;
			r = swap;
		}
		if (l < r)
			rc = add_columns(c, t, row, l, r, tile_y);
	}
	return rc;
}

/* Those of its rows that are in [lo, hi) of the picture. */
static enum bake_status
draw_bin(const struct canvas *c, struct triangle *t)
{
	const int64_t height = c->ab->view.height;
	int64_t first = abuffer_ceil(t->p[0]->y);
	int64_t last = abuffer_ceil(t->p[2]->y);
	int64_t tile = 0, stop = 0;
	enum bake_status rc = BAKE_OK;

	if (c->ab->view.tile_y) {
		tile = abuffer_floor_div(first, height);
		stop = abuffer_floor_div(last - 1, height);
	}
	for (; rc == BAKE_OK && tile <= stop; tile++) {
		int64_t begin = c->lo + tile * height;
		int64_t end = c->hi + tile * height;

		begin = begin > first ? begin : first;
		end = end < last ? end : last;
		if (begin < end)
			rc = !t->wide && t->columns <= 2
				 ? draw_narrow(c, t, begin, end, (int)tile)
				 : draw_rows(c, t, begin, end, (int)tile);
	}
	return rc;
}

static inline bool
is_above(const struct abuffer_point *a, const struct abuffer_point *b)
{
	return a->y < b->y || (a->y == b->y && a->x < b->x);
}

static inline void
exchange(
    const struct abuffer_point **a, const struct abuffer_point **b, bool *odd)
{
	const struct abuffer_point *t = *a;

	*a = *b;
	*b = t;
	*odd = !*odd;
}

/* Make a triangle ready; false where it has no area. */
static bool
set_up(const struct bake_abuffer *ab, uint32_t index, struct triangle *t)
{
	bool odd = ab->turned != NULL && ab->turned[index] != 0;
	int64_t lo, hi;

	abuffer_corners(ab, index, t->p);
	if (is_above(t->p[1], t->p[0]))
		exchange(&t->p[0], &t->p[1], &odd);
	if (is_above(t->p[2], t->p[1]))
		exchange(&t->p[1], &t->p[2], &odd);
	if (is_above(t->p[1], t->p[0]))
		exchange(&t->p[0], &t->p[1], &odd);
	for (int k = 0; k < 2; k++) {
		t->x[k] = t->p[k + 1]->x - t->p[0]->x;
		t->y[k] = t->p[k + 1]->y - t->p[0]->y;
	}
	lo = t->x[0] < t->x[1] ? t->x[0] : t->x[1];
	hi = t->x[0] > t->x[1] ? t->x[0] : t->x[1];
	lo = lo < 0 ? lo : 0;
	hi = hi > 0 ? hi : 0;
	t->first = abuffer_ceil(t->p[0]->x + lo);
	t->columns = abuffer_ceil(t->p[0]->x + hi) - t->first;
	t->wide = hi - lo >= ABUFFER_SMALL || t->y[1] >= ABUFFER_SMALL;
	t->area = cross(t->x[0], t->y[0], t->x[1], t->y[1], t->wide);
	if (t->area == 0)
		return false;
	/* y is downwards: counterclockwise, as outsides are, is below 0 */
	t->key = index | ((t->area > 0) != odd ? ABUFFER_LEAVING : 0);
	t->base = t->p[0]->x >> ABUFFER_BITS;
	t->grow[0] = t->grow[1] = t->slope = 0;
	t->has_depth = false;
	return true;
}

enum bake_status
bake_abuffer_draw(const struct bake_abuffer *ab, int y0, int nrows,
    struct bake_band_scratch *s, struct bake_err *err)
{
	struct canvas c = { ab, s, err, y0, 0, 0 };
	const int end = y0 + nrows;
	enum bake_status rc = BAKE_OK;

	s->nspans = s->total = 0;
	memset(s->row, 0, ((size_t)nrows + 1) * sizeof *s->row);
	for (int b = y0 / BAKE_BAND_ROWS; b * BAKE_BAND_ROWS < end; b++) {
		c.lo = b * BAKE_BAND_ROWS;
		c.hi = c.lo + BAKE_BAND_ROWS;
		c.lo = c.lo > y0 ? c.lo : y0;
		c.hi = c.hi < end ? c.hi : end;
		for (size_t i = ab->bin[b]; rc == BAKE_OK && i < ab->bin[b + 1];
		     i++) {
			struct triangle t;

			if (i + ABUFFER_AHEAD < ab->bin[b + 1])
				__builtin_prefetch(
				    &ab->mesh->triangles
					 [ab->item[i + ABUFFER_AHEAD]]);
			if (set_up(ab, ab->item[i], &t))
				rc = draw_bin(&c, &t);
		}
	}
	return rc;
}
