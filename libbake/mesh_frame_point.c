/* Sums around the points of a mesh, in an order of their values. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_frame_priv.h"

/* While frames are made: file normals or tangents that differ. */
enum { MIXED_NORMALS = 1 << 16, MIXED_TANGENTS = 1 << 17 };

/* -- vectors ------------------------------------------------------------- */

static double
dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void
cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static void
add_scaled(double sum[3], double w, const double x[3])
{
	for (int k = 0; k < 3; k++)
		sum[k] += w * x[k];
}

static double
larger(double a, double b)
{
	return a > b ? a : b;
}

/* To unit length; false, x as it was, where it has no direction. */
static bool
normalize(double x[3])
{
	double scale, length;

	scale = dot(x, x);
	if (scale > 1e-200 && scale < 1e200) {
		/* the usual case: neither under- nor overflow */
		length = sqrt(scale);
		for (int k = 0; k < 3; k++)
			x[k] /= length;
		return true;
	}
	scale = larger(fabs(x[0]), larger(fabs(x[1]), fabs(x[2])));
	if (!(scale > 0.0) || !isfinite(scale))
		return false;
	for (int k = 0; k < 3; k++)
		x[k] /= scale;
	length = sqrt(dot(x, x));
	for (int k = 0; k < 3; k++)
		x[k] /= length;
	return true;
}

/* atan(t) for 0 <= t <= 1: the angle is halved twice, so
 * that t <= tan(pi/16) and 12 terms leave 0.199^24 / 25 < 1e-18 of it. Even and
 * odd powers are summed apart, which halves the wait. */
static inline double
atan_unit(double t)
{
	double x, xx, even, odd;

	t = t / (1.0 + sqrt(1.0 + t * t));
	t = t / (1.0 + sqrt(1.0 + t * t));
	x = t * t;
	xx = x * x;
	even = 1.0 / 21.0 + xx * (1.0 / 25.0);
	odd = 1.0 / 19.0 + xx * (1.0 / 23.0);
	even = 1.0 / 17.0 + xx * even;
	odd = 1.0 / 15.0 + xx * odd;
	even = 1.0 / 13.0 + xx * even;
	odd = 1.0 / 11.0 + xx * odd;
	even = 1.0 / 9.0 + xx * even;
	odd = 1.0 / 7.0 + xx * odd;
	even = 1.0 / 5.0 + xx * even;
	odd = 1.0 / 3.0 + xx * odd;
	return 4.0 * (t + t * (xx * even - x * odd));
}

/* 2 atan(y / x) for y, x >= 0, not both 0. */
static double
twice_atan(double y, double x)
{
	return y <= x ? 2.0 * atan_unit(y / x)
		      : BAKE_FRAME_PI - 2.0 * atan_unit(x / y);
}

double
bake_angle_rad(const double u[3], const double v[3])
{
	double a[3] = { u[0], u[1], u[2] }, b[3] = { v[0], v[1], v[2] };
	double d = 0.0, s = 0.0;

	if (!normalize(a) || !normalize(b))
		return 0.0;
	for (int k = 0; k < 3; k++) {
		d += (a[k] - b[k]) * (a[k] - b[k]);
		s += (a[k] + b[k]) * (a[k] + b[k]);
	}
	return twice_atan(sqrt(d), sqrt(s));
}

/* -- order --------------------------------------------------------------- */

static int
compare_values(const double *a, const double *b, int n)
{
	for (int k = 0; k < n; k++)
		if (a[k] != b[k])
			return a[k] < b[k] ? -1 : 1;
	return 0;
}

static int
compare_file(const double *a, const double *b, int n)
{
	if (a == NULL || b == NULL)
		return (a != NULL) - (b != NULL);
	return compare_values(a, b, n);
}

/* By everything that enters a sum, so that the order of equal ones does not
 * matter. */
static int
compare_items(const struct frame_item *a, const struct frame_item *b)
{
	int c = compare_values(a->wn, b->wn, 3);

	if (c == 0)
		c = compare_values(&a->angle, &b->angle, 1);
	if (c == 0)
		c = compare_values(a->ps, b->ps, 3);
	if (c == 0)
		c = compare_values(a->pt, b->pt, 3);
	if (c == 0)
		c = compare_file(a->normal, b->normal, 3);
	if (c == 0)
		c = compare_file(a->tangent, b->tangent, 4);
	return c;
}

int
bake_frame_compare_uv(const struct frame_item *a, const struct frame_item *b)
{
	if (a->has_uv != b->has_uv)
		return a->has_uv - b->has_uv;
	return a->has_uv ? compare_values(a->uv, b->uv, 2) : 0;
}

static int
by_value(const void *a, const void *b)
{
	return compare_items(
	    *(struct frame_item *const *)a, *(struct frame_item *const *)b);
}

/* Groups apart, in no order of their own: no sum is over two of them. */
static int
by_group(const void *a, const void *b)
{
	const struct frame_item *x = *(struct frame_item *const *)a;
	const struct frame_item *y = *(struct frame_item *const *)b;

	if (x->head != y->head)
		return x->head < y->head ? -1 : 1;
	return compare_items(x, y);
}

void
bake_frame_sort(struct frame_item **items, int n,
    int (*compare)(const void *, const void *))
{
	enum { FEW = 24 };

	if (n > FEW) {
		qsort(items, (size_t)n, sizeof *items, compare);
		return;
	}
	for (int i = 1; i < n; i++) {
		struct frame_item *it = items[i];
		int k = i;

		for (; k > 0 && compare(&items[k - 1], &it) > 0; k--)
			items[k] = items[k - 1];
		items[k] = it;
	}
}

/* -- one corner ---------------------------------------------------------- */

static int
point_of(const struct frame_job *job, const struct bake_corner *c)
{
	return job->weld != NULL ? job->weld->first[c->v] : c->v;
}

/* What the file says of a corner. */
static void
take_file_item(const struct bake_mesh *m, const struct bake_corner *c,
    struct frame_item *it)
{
	if (c->vn >= 0) {
		const double *fn = m->normals[c->vn];

		if (dot(fn, fn) > 0.0)
			it->normal = fn;
		if (m->tangents != NULL && m->tangents[c->vn][3] != 0.0)
			it->tangent = m->tangents[c->vn];
	}
	it->has_uv = c->vt >= 0;
	it->uv = it->has_uv ? m->uvs[c->vt] : NULL;
}

/* A corner: its item, but for what the kernel finds, and the kernel's input. */
static void
take_corner(const struct frame_job *job, int corner, struct frame_item *it,
    struct frame_batch *b, int l)
{
	const struct bake_mesh *m = job->mesh;
	int triangle = corner / 3, k0 = corner - 3 * triangle;
	const struct bake_corner *t = m->triangles[triangle], *c = &t[k0];
	const struct bake_corner *next = &t[k0 == 2 ? 0 : k0 + 1];
	const struct bake_corner *prev = &t[k0 == 0 ? 2 : k0 - 1];
	const double *p = m->positions[point_of(job, c)], *pn, *pp;
	bool has_uvs = c->vt >= 0 && next->vt >= 0 && prev->vt >= 0;

	it->normal = it->tangent = NULL;
	it->frame = &job->frames->frame[job->frames->frame_of[triangle][k0]];
	take_file_item(m, c, it);
	it->next = point_of(job, next);
	it->prev = point_of(job, prev);
	pn = m->positions[it->next];
	pp = m->positions[it->prev];
	for (int k = 0; k < 3; k++) {
		b->e[k][l] = pn[k] - p[k];
		b->f[k][l] = pp[k] - p[k];
	}
	it->uv_next = has_uvs ? m->uvs[next->vt] : NULL;
	it->uv_prev = has_uvs ? m->uvs[prev->vt] : NULL;
	for (int k = 0; k < 2; k++) {
		b->uv_e[k][l] = has_uvs ? it->uv_next[k] - it->uv[k] : 0.0;
		b->uv_f[k][l] = has_uvs ? it->uv_prev[k] - it->uv[k] : 0.0;
	}
}

/* n corners of the adjacency, n at most a batch. */
static void
take_corners(const struct frame_job *job, const int *corner, int n,
    struct frame_item *items, struct frame_batch *b)
{
	for (int l = 0; l < n; l++)
		take_corner(job, corner[l], &items[l], b, l);
	job->corners(b, n);
	for (int l = 0; l < n; l++) {
		struct frame_item *it = &items[l];

		for (int k = 0; k < 3; k++) {
			it->wn[k] = b->wn[k][l];
			it->ps[k] = b->ps[k][l];
			it->pt[k] = b->pt[k][l];
		}
		it->angle = b->angle[l];
		it->side = (int)b->side[l];
	}
}

/* -- one point ----------------------------------------------------------- */

/* The file's vectors of a frame: as they are where all its corners have the
 * same, else their mean by angles. Not yet of unit length then. */
static void
take_file_vectors(
    const struct frame_job *job, struct frame_item *const *items, int n)
{
	bool tangents = job->params->tangents == BAKE_TANGENTS_FILE;
	bool normals = job->params->normals != BAKE_NORMALS_COMPUTED;

	for (int i = 0; i < n; i++) {
		struct bake_frame *f = items[i]->frame;
		const double *fn = items[i]->normal, *ft = items[i]->tangent;

		if (normals && fn != NULL &&
		    !(f->flags & BAKE_FRAME_NORMAL_FILE)) {
			memcpy(f->normal, fn, sizeof f->normal);
			f->flags |= BAKE_FRAME_NORMAL_FILE;
		} else if (normals && fn != NULL &&
			   compare_values(f->normal, fn, 3) != 0) {
			f->flags |= MIXED_NORMALS;
		}
		if (tangents && ft != NULL &&
		    !(f->flags & BAKE_FRAME_TANGENT_FILE)) {
			memcpy(f->tangent, ft, sizeof f->tangent);
			f->hand = ft[3] < 0.0 ? -1 : 1;
			f->flags |= BAKE_FRAME_TANGENT_FILE;
		} else if (tangents && ft != NULL &&
			   compare_values(f->tangent, ft, 3) != 0) {
			f->flags |= MIXED_TANGENTS;
		}
	}
}

static void
mix_file_vectors(struct frame_item *const *items, int n)
{
	for (int pass = 0; pass < 2; pass++)
		for (int i = 0; i < n; i++) {
			struct bake_frame *f = items[i]->frame;
			const struct frame_item *it = items[i];

			if (it->normal != NULL && f->flags & MIXED_NORMALS) {
				if (pass == 0)
					memset(f->normal, 0, sizeof f->normal);
				else
					add_scaled(
					    f->normal, it->angle, it->normal);
			}
			if (it->tangent != NULL && f->flags & MIXED_TANGENTS) {
				if (pass == 0)
					memset(
					    f->tangent, 0, sizeof f->tangent);
				else
					add_scaled(
					    f->tangent, it->angle, it->tangent);
			}
		}
}

/* Items of one group: their mean gradients, into all their frames. */
static void
take_gradients(struct frame_item *const *items, int n)
{
	double weight[2] = { 0.0, 0.0 }, ps[3] = { 0.0 }, pt[3] = { 0.0 };
	int side, flags = 0;

	for (int i = 0; i < n; i++)
		if (items[i]->side != 0)
			weight[items[i]->side < 0] += items[i]->angle;
	side = weight[1] > weight[0] ? -1 : 1;
	for (int i = 0; i < n; i++) {
		if (items[i]->side != side)
			continue;
		add_scaled(ps, items[i]->angle, items[i]->ps);
		add_scaled(pt, items[i]->angle, items[i]->pt);
	}
	if (weight[0] > 0.0 && weight[1] > 0.0)
		flags |= BAKE_FRAME_MIRROR_MIXED;
	for (int i = 0; i < n; i++) {
		struct bake_frame *f = items[i]->frame;

		f->flags |= flags;
		if (!(f->flags & BAKE_FRAME_TANGENT_FILE))
			f->hand = side;
		for (int k = 0; k < 3; k++) {
			/* stays 0 where there is no weight */
			double w = weight[side < 0];

			f->ps[k] = w > 0.0 ? ps[k] / w : 0.0;
			f->pt[k] = w > 0.0 ? pt[k] / w : 0.0;
		}
	}
}

static void
do_point(const struct frame_job *job, int p, struct frame_item *items, int n,
    const struct frame_bench *bench)
{
	struct frame_item **order = bench->order;
	double *normal = job->point_normal[p];
	bool one_uv = true;
	int mixed = 0;

	memset(normal, 0, sizeof job->point_normal[p]);
	for (int i = 0; i < n; i++) {
		order[i] = &items[i];
		one_uv = one_uv && bake_frame_compare_uv(&items[i], items) == 0;
	}
	bake_frame_sort(order, n, by_value);
	for (int i = 0; i < n; i++)
		add_scaled(normal, 1.0, order[i]->wn);
	normalize(normal);
	take_file_vectors(job, order, n);
	for (int i = 0; i < n; i++)
		mixed |= order[i]->frame->flags;
	if (mixed & (MIXED_NORMALS | MIXED_TANGENTS))
		mix_file_vectors(order, n);
	if (one_uv) {
		take_gradients(order, n);
		return;
	}
	bake_frame_group(order, n, bench->spokes);
	bake_frame_sort(order, n, by_group);
	for (int i = 0, end; i < n; i = end) {
		for (end = i + 1; end < n && order[i]->head == order[end]->head;
		     end++)
			;
		take_gradients(order + i, end - i);
	}
}

void
bake_frame_points(const struct frame_job *job, int first, int end,
    const struct frame_bench *bench)
{
	const int *start = job->adj->start;

	while (first < end) {
		int last = first + 1, n;

		/* whole points, as many as there is room for */
		while (last < end &&
		       start[last + 1] - start[first] <= BAKE_FRAME_BATCH)
			last++;
		n = start[last] - start[first];
		for (int i = 0; i < n; i += BAKE_FRAME_BATCH)
			take_corners(job, job->adj->corner + start[first] + i,
			    n - i < BAKE_FRAME_BATCH ? n - i : BAKE_FRAME_BATCH,
			    bench->items + i, bench->batch);
		for (int p = first; p < last; p++)
			do_point(job, p,
			    bench->items + (start[p] - start[first]),
			    start[p + 1] - start[p], bench);
		first = last;
	}
}

/* -- one frame ----------------------------------------------------------- */

static bool
make_orthogonal(double x[3], const double normal[3])
{
	double size = sqrt(dot(x, x)), along = dot(x, normal);

	add_scaled(x, -along, normal);
	return sqrt(dot(x, x)) > 1e-9 * size && normalize(x);
}

/* Any direction in the plane: of the axis that is farthest from the normal. */
static void
any_tangent(struct bake_frame *f)
{
	int k = 0;

	for (int i = 1; i < 3; i++)
		if (fabs(f->normal[i]) < fabs(f->normal[k]))
			k = i;
	memset(f->tangent, 0, sizeof f->tangent);
	f->tangent[k] = 1.0;
	make_orthogonal(f->tangent, f->normal);
	f->hand = 1;
	f->flags &= ~BAKE_FRAME_TANGENT_FILE;
	f->flags |= BAKE_FRAME_TANGENT_NONE;
	memcpy(f->ps, f->tangent, sizeof f->ps);
	cross(f->normal, f->tangent, f->pt);
}

void
bake_frame_finish(const struct frame_job *job, struct bake_frame *f)
{
	int p = job->weld != NULL ? job->weld->first[f->v] : f->v;
	double b[3], side;
	bool has_gradients = dot(f->ps, f->ps) > 0.0;

	if (!(f->flags & BAKE_FRAME_NORMAL_FILE) || !normalize(f->normal)) {
		f->flags &= ~BAKE_FRAME_NORMAL_FILE;
		memcpy(f->normal, job->point_normal[p], sizeof f->normal);
	}
	if (!(dot(f->normal, f->normal) > 0.0)) {
		f->flags |= BAKE_FRAME_NORMAL_NONE;
		f->normal[0] = f->normal[1] = 0.0;
		f->normal[2] = 1.0;
	}
	f->flags &= ~(MIXED_NORMALS | MIXED_TANGENTS);
	if (f->flags & BAKE_FRAME_TANGENT_FILE &&
	    make_orthogonal(f->tangent, f->normal)) {
		if (has_gradients)
			return;
		/* a direction, but no length */
		memcpy(f->ps, f->tangent, sizeof f->ps);
		cross(f->normal, f->tangent, f->pt);
		for (int k = 0; k < 3; k++)
			f->pt[k] *= f->hand;
		return;
	}
	f->flags &= ~BAKE_FRAME_TANGENT_FILE;
	memcpy(f->tangent, f->ps, sizeof f->tangent);
	if (!has_gradients || !make_orthogonal(f->tangent, f->normal)) {
		any_tangent(f);
		return;
	}
	cross(f->normal, f->tangent, b);
	side = dot(b, f->pt);
	if (side != 0.0)
		f->hand = side < 0.0 ? -1 : 1;
}
