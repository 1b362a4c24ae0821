/* Which corners around a point belong to one parametrisation. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>

#include "mesh_frame_priv.h"

/* UV edges that differ by no more than what decimals or floats leave of a UV
 * of size 1 are equal, if that is no more than this part of their length. */
#define UV_ROUNDING 2e-6
#define UV_PART 0.01

static int
by_uv(const void *pa, const void *pb)
{
	const struct frame_item *a = *(struct frame_item *const *)pa;
	const struct frame_item *b = *(struct frame_item *const *)pb;

	return bake_frame_compare_uv(a, b);
}

static int
by_other(const void *pa, const void *pb)
{
	const struct frame_spoke *a = pa, *b = pb;

	return (a->other > b->other) - (a->other < b->other);
}

/* The first of an item's group, which its head leads to; the way is halved. */
static struct frame_item *
find_head(struct frame_item *it)
{
	while (it->head != it) {
		it->head = it->head->head;
		it = it->head;
	}
	return it;
}

/* Items are in one array: the lower address heads. */
static void
join(struct frame_item *a, struct frame_item *b)
{
	a = find_head(a);
	b = find_head(b);
	if (a < b)
		b->head = a;
	else
		a->head = b;
}

/* Whether the mapping of a to the UVs goes on, but for a translation, in b,
 * which has a's next edge as its previous one. */
static bool
goes_on(const struct frame_item *a, const struct frame_item *b)
{
	double aa = 0.0, bb = 0.0, dd = 0.0, size = 1.0, limit, part;

	if (a->side == 0 || a->side != b->side)
		return false;
	for (int k = 0; k < 2; k++) {
		double x = a->uv_next[k] - a->uv[k],
		       y = b->uv_prev[k] - b->uv[k];

		aa += x * x;
		bb += y * y;
		dd += (x - y) * (x - y);
		size = fmax(size, fmax(fabs(a->uv[k]), fabs(a->uv_next[k])));
		size = fmax(size, fmax(fabs(b->uv[k]), fabs(b->uv_prev[k])));
	}
	limit = UV_ROUNDING * size;
	part = UV_PART * sqrt(fmin(aa, bb));
	return sqrt(dd) <= fmin(limit, part);
}

static void
sort_spokes(struct frame_spoke *spokes, int n)
{
	enum { FEW = 48 };

	if (n > FEW) {
		qsort(spokes, (size_t)n, sizeof *spokes, by_other);
		return;
	}
	for (int i = 1; i < n; i++) {
		struct frame_spoke s = spokes[i];
		int k = i;

		for (; k > 0 && spokes[k - 1].other > s.other; k--)
			spokes[k] = spokes[k - 1];
		spokes[k] = s;
	}
}

/* Join items across the edges that leave the point, where two triangles use
 * one, in opposite directions. */
static void
walk(struct frame_item **items, int n, struct frame_spoke *spokes)
{
	int end;

	for (int i = 0; i < n; i++) {
		spokes[2 * i] =
		    (struct frame_spoke){ items[i]->next, true, items[i] };
		spokes[2 * i + 1] =
		    (struct frame_spoke){ items[i]->prev, false, items[i] };
	}
	sort_spokes(spokes, 2 * n);
	for (int i = 0; i < 2 * n; i = end) {
		const struct frame_spoke *s = &spokes[i];

		for (end = i + 1; end < 2 * n && spokes[end].other == s->other;
		     end++)
			;
		if (end != i + 2 || s[0].is_next == s[1].is_next)
			continue;
		if (s[0].is_next ? goes_on(s[0].item, s[1].item)
				 : goes_on(s[1].item, s[0].item))
			join(s[0].item, s[1].item);
	}
}

void
bake_frame_group(struct frame_item **items, int n, struct frame_spoke *spokes)
{
	for (int i = 0; i < n; i++)
		items[i]->head = items[i];
	bake_frame_sort(items, n, by_uv);
	for (int i = 1; i < n; i++)
		if (bake_frame_compare_uv(items[i - 1], items[i]) == 0)
			join(items[i - 1], items[i]);
	walk(items, n, spokes);
	for (int i = 0; i < n; i++)
		items[i]->head = find_head(items[i]);
}
