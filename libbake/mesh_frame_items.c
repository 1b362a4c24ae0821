/* Sums around one point of a mesh, whatever it is, in an order of values. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "mesh_frame_priv.h"

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

/* -- one point ---------------------------------------------------------- */

/* The file's vectors of a frame: as they are where all its corners have the
 * same, else their mean by angles. Not yet of unit length then. */
void
bake_frame_take_file(
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
			f->flags |= FRAME_MIXED_NORMALS;
		}
		if (tangents && ft != NULL &&
		    !(f->flags & BAKE_FRAME_TANGENT_FILE)) {
			memcpy(f->tangent, ft, sizeof f->tangent);
			f->hand = ft[3] < 0.0 ? -1 : 1;
			f->flags |= BAKE_FRAME_TANGENT_FILE;
		} else if (tangents && ft != NULL &&
			   compare_values(f->tangent, ft, 3) != 0) {
			f->flags |= FRAME_MIXED_TANGENTS;
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

			if (it->normal != NULL &&
			    f->flags & FRAME_MIXED_NORMALS) {
				if (pass == 0)
					memset(f->normal, 0, sizeof f->normal);
				else
					frame_add_scaled(
					    f->normal, it->angle, it->normal);
			}
			if (it->tangent != NULL &&
			    f->flags & FRAME_MIXED_TANGENTS) {
				if (pass == 0)
					memset(
					    f->tangent, 0, sizeof f->tangent);
				else
					frame_add_scaled(
					    f->tangent, it->angle, it->tangent);
			}
		}
}

/* Items of one group: their mean gradients, into all their frames. */
static void
take_gradients(
    const struct frame_job *job, struct frame_item *const *items, int n)
{
	double weight[2] = { 0.0, 0.0 }, ps[3] = { 0.0 }, pt[3] = { 0.0 };
	double unit = 1.0 / job->pts->scale;
	int side, flags = 0;

	for (int i = 0; i < n; i++)
		if (items[i]->side != 0)
			weight[items[i]->side < 0] += items[i]->angle;
	side = weight[1] > weight[0] ? -1 : 1;
	for (int i = 0; i < n; i++) {
		if (items[i]->side != side)
			continue;
		frame_add_scaled(ps, items[i]->angle, items[i]->ps);
		frame_add_scaled(pt, items[i]->angle, items[i]->pt);
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

			f->ps[k] = w > 0.0 ? ps[k] / w * unit : 0.0;
			f->pt[k] = w > 0.0 ? pt[k] / w * unit : 0.0;
		}
	}
}

void
bake_frame_items(const struct frame_job *job, int n,
    const struct frame_bench *bench, double normal[3])
{
	struct frame_item **order = bench->order, *items = bench->items;
	bool one_uv = true;
	int mixed = 0;

	memset(normal, 0, 3 * sizeof *normal);
	for (int i = 0; i < n; i++) {
		order[i] = &items[i];
		one_uv = one_uv && bake_frame_compare_uv(&items[i], items) == 0;
	}
	bake_frame_sort(order, n, by_value);
	for (int i = 0; i < n; i++)
		frame_add_scaled(normal, 1.0, order[i]->wn);
	bake_frame_normalize(normal);
	bake_frame_take_file(job, order, n);
	for (int i = 0; i < n; i++)
		mixed |= order[i]->frame->flags;
	if (mixed & (FRAME_MIXED_NORMALS | FRAME_MIXED_TANGENTS))
		mix_file_vectors(order, n);
	if (one_uv) {
		take_gradients(job, order, n);
		return;
	}
	bake_frame_group(order, n, bench->spokes);
	bake_frame_sort(order, n, by_group);
	for (int i = 0, end; i < n; i = end) {
		for (end = i + 1; end < n && order[i]->head == order[end]->head;
		     end++)
			;
		take_gradients(job, order + i, end - i);
	}
}
