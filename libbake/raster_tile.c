/* The rasteriser: the fragments of one tile. */
/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "mem.h"
#include "raster_priv.h"

enum { N = BAKE_RASTER_TILE };

/* One thread's memory. Every array is a multiple of 64 bytes long, so all are
 * aligned as the first is. */
struct scratch {
	float b1[RASTER_PADDED], b2[RASTER_PADDED], distance[RASTER_PADDED];
	float length[RASTER_PADDED];
	short index[RASTER_SAMPLES], all[RASTER_SAMPLES];
	struct raster_rows rows;
};

int
bake_raster_ntiles(const struct bake_raster *r)
{
	return r->ntiles;
}

void
bake_raster_tile(
    const struct bake_raster *r, int tile, int *x0, int *y0, int *w, int *h)
{
	*x0 = tile % r->columns * N;
	*y0 = tile / r->columns * N;
	*w = r->width - *x0 < N ? r->width - *x0 : N;
	*h = r->height - *y0 < N ? r->height - *y0 : N;
}

size_t
bake_raster_scratch(void)
{
	return (sizeof(struct scratch) + BAKE_ALIGN - 1) / BAKE_ALIGN *
	       BAKE_ALIGN;
}

/*
 * One end of the rows' runs, exact: floor(n / m) where n changes by `step` from
 * row to row, kept as a quotient and a remainder.
 */
struct bound {
	int64_t q, rem, step_q, step_rem, m;
};

static int64_t
floor_div(int64_t n, int64_t m, int64_t *rem)
{
	int64_t q = n / m, r = n % m;

	*rem = r < 0 ? r + m : r;
	return r < 0 ? q - 1 : q;
}

static void
set_bound(struct bound *b, int64_t n, int64_t step, int64_t m)
{
	b->m = m;
	b->q = floor_div(n, m, &b->rem);
	b->step_q = floor_div(step, m, &b->step_rem);
}

static int64_t
next_bound(struct bound *b)
{
	int64_t q = b->q;

	b->q += b->step_q;
	b->rem += b->step_rem;
	if (b->rem >= b->m) {
		b->rem -= b->m;
		b->q++;
	}
	return q;
}

/*
 * Take from each row what is outside of an edge. E = e + a x >= 0 in a row is
 * x >= ceil(-e / a) = floor((-e + a - 1) / a) where a > 0, and
 * x <= floor(e / -a) where a < 0.
 */
static void
cut_rows(struct raster_rows *r, const struct raster_edge *edge, int64_t e)
{
	const int64_t a = edge->a, b = edge->b;
	struct bound bound;

	if (a == 0) {
		for (int y = r->y0; y <= r->y1; y++, e += b)
			if (e < 0)
				r->end[y] = r->begin[y];
	} else if (a > 0) {
		set_bound(&bound, -e + a - 1, -b, a);
		for (int y = r->y0; y <= r->y1; y++) {
			int64_t x = next_bound(&bound);

			if (x > r->begin[y])
				r->begin[y] = x < N ? (int)x : N;
		}
	} else {
		set_bound(&bound, e, b, -a);
		for (int y = r->y0; y <= r->y1; y++) {
			int64_t x = next_bound(&bound) + 1;

			if (x < r->end[y])
				r->end[y] = x > 0 ? (int)x : 0;
		}
	}
}

/* The runs of a piece in the tile; how many samples they are. */
static int
make_rows(const struct bake_raster *raster, const struct raster_piece *piece,
    int x0, int y0, struct raster_rows *r)
{
	struct raster_box box = bake_raster_bounds(raster, piece);
	struct raster_edge edges[3];
	int begin = box.x0 > x0 ? box.x0 - x0 : 0, n = 0;
	int end = box.x1 < x0 + N - 1 ? box.x1 - x0 + 1 : N;

	r->y0 = box.y0 > y0 ? box.y0 - y0 : 0;
	r->y1 = box.y1 < y0 + N - 1 ? box.y1 - y0 : N - 1;
	for (int y = r->y0; y <= r->y1; y++) {
		r->begin[y] = begin;
		r->end[y] = end;
	}
	bake_raster_edges(piece, edges);
	for (int i = 0; i < 3; i++) {
		const struct raster_edge *e = &edges[i];
		/* at the tile's first sample of row y0, and at its least */
		int64_t at = e->c + e->a * x0 + e->b * (y0 + r->y0);
		int64_t least = at + (e->a > 0 ? 0 : e->a * (N - 1)) +
				(e->b > 0 ? 0 : e->b * (r->y1 - r->y0));

		if (least < 0)
			cut_rows(r, e, at);
	}
	for (int y = r->y0; y <= r->y1; y++)
		n += r->end[y] > r->begin[y] ? r->end[y] - r->begin[y] : 0;
	return n;
}

static void
minus(const double a[3], const double b[3], double c[3])
{
	for (int i = 0; i < 3; i++)
		c[i] = a[i] - b[i];
}

static void
cross(const double a[3], const double b[3], double c[3])
{
	c[0] = a[1] * b[2] - a[2] * b[1];
	c[1] = a[2] * b[0] - a[0] * b[2];
	c[2] = a[0] * b[1] - a[1] * b[0];
}

/* n . d as a function of the sample, d = (x + i dx, y - j dx, 1). */
static void
along_rays(const double n[3], double x, double y, double dx, double f[3])
{
	f[0] = n[0] * x + n[1] * y + n[2];
	f[1] = n[0] * dx;
	f[2] = -n[1] * dx;
}

/*
 * Corners p, p + u, p + v; the ray t d meets their plane where t d = p + b1 u +
 * b2 v. Multiplied by v x d and by u x d this is
 *     b1 = d . (v x p) / d . (u x v),  b2 = d . (p x u) / d . (u x v).
 * Orthographic rays are d = (0, 0, 1) from o, and p is p - o: b1 and b2 are
 * linear in o, and u x v is the only term with d.
 */
static void
make_weights(const struct bake_raster *raster, int triangle, int x0, int y0,
    struct raster_rows *r)
{
	const struct bake_corner *t = raster->mesh->triangles[triangle];
	const double *p = raster->q[t[0].v], dx = 1 / raster->scale;
	const double x = (x0 + 0.5 - raster->cx) * dx;
	const double y = (raster->cy - (y0 + 0.5)) * dx;
	double u[3], v[3], vp[3], pu[3], uv[3];

	minus(raster->q[t[1].v], p, u);
	minus(raster->q[t[2].v], p, v);
	cross(u, v, uv);
	r->w0 = p[2];
	r->w1 = u[2];
	r->w2 = v[2];
	if (raster->basis.orthographic) {
		const double gx = p[0] - x, gy = p[1] - y;
		const double e1[3] = { v[0] * gy - v[1] * gx, v[1] * dx,
			v[0] * dx };
		const double e2[3] = { gx * u[1] - gy * u[0], -u[1] * dx,
			-u[0] * dx };
		const double s[3] = { uv[2], 0, 0 };

		memcpy(r->e1, e1, sizeof e1);
		memcpy(r->e2, e2, sizeof e2);
		memcpy(r->s, s, sizeof s);
		return;
	}
	cross(v, p, vp);
	cross(p, u, pu);
	along_rays(vp, x, y, dx, r->e1);
	along_rays(pu, x, y, dx, r->e2);
	along_rays(uv, x, y, dx, r->s);
}

static void
make_index(const struct raster_rows *r, const short *all, short *index)
{
	for (int y = r->y0; y <= r->y1; y++) {
		if (r->begin[y] >= r->end[y])
			continue;
		size_t n = (size_t)(r->end[y] - r->begin[y]);

		memcpy(index, all + y * N + r->begin[y], n * sizeof *index);
		index += n;
	}
}

static void
prepare(const struct bake_raster *r, int x0, int y0, struct scratch *s)
{
	static raster_lengths_fn *const lengths[] =
	    BAKE_KERNEL_TABLE(bake_raster_lengths);

	for (int i = 0; i < RASTER_SAMPLES; i++)
		s->all[i] = (short)i;
	memset(s->length + RASTER_SAMPLES, 0,
	    (RASTER_PADDED - RASTER_SAMPLES) * sizeof *s->length);
	s->rows.near = r->basis.near;
	s->rows.length = s->length;
	s->rows.b1 = s->b1;
	s->rows.b2 = s->b2;
	s->rows.distance = s->distance;
	if (r->basis.orthographic)
		for (int i = 0; i < RASTER_SAMPLES; i++)
			s->length[i] = 1;
	else
		lengths[r->isa](s->length, (x0 + 0.5 - r->cx) / r->scale,
		    (r->cy - (y0 + 0.5)) / r->scale, 1 / r->scale);
}

void
bake_raster_fragments(const struct bake_raster *r, int tile,
    void (*take)(void *arg, const struct bake_fragments *fragments), void *arg,
    void *scratch)
{
	static raster_rows_fn *const kernels[] =
	    BAKE_KERNEL_TABLE(bake_raster_rows);
	struct scratch *s = scratch;
	const int x0 = tile % r->columns * N, y0 = tile / r->columns * N;

	if (r->start[tile] == r->start[tile + 1])
		return;
	prepare(r, x0, y0, s);
	for (size_t i = r->start[tile]; i < r->start[tile + 1]; i++) {
		const struct raster_piece *p = &r->pieces[r->bins[i]];
		struct bake_fragments f = { .back = p->triangle < 0,
			.index = s->index,
			.b1 = s->b1,
			.b2 = s->b2,
			.distance = s->distance };

		f.triangle = f.back ? ~p->triangle : p->triangle;
		f.n = make_rows(r, p, x0, y0, &s->rows);
		if (f.n == 0)
			continue;
		make_weights(r, f.triangle, x0, y0, &s->rows);
		make_index(&s->rows, s->all, s->index);
		kernels[r->isa](&s->rows);
		take(arg, &f);
	}
}
