/* Fewer layers by the smallest interval: for a few, and for very many. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "layer_priv.h"
#include "mem.h"

size_t
bake_layer_cap(struct bake_layer *layer, size_t n, size_t nlayers)
{
	while (n > nlayers) {
		size_t least = 0;

		for (size_t i = 1; i + 1 < n; i++)
			if (layer[i + 1].depth - layer[i].depth <
			    layer[least + 1].depth - layer[least].depth)
				least = i;
		memmove(&layer[least], &layer[least + 2],
		    (n - least - 2) * sizeof *layer);
		n -= 2;
	}
	return n;
}

/* The interval from a layer to the next that is left. */
struct interval {
	double length;
	size_t first;
};

/* A heap of intervals, the smallest at its top, and the layers that are left as
 * a list. Intervals that are no more stay in the heap until they come up. */
struct cap {
	struct bake_layer *layer;
	struct interval *heap;
	size_t nheap, n;
	size_t *before, *after; /* n: none */
	bool *gone;
};

static bool
is_smaller(struct interval a, struct interval b)
{
	return a.length < b.length ||
	       (a.length == b.length && a.first < b.first);
}

static void
push(struct cap *c, size_t first)
{
	const struct interval v = {
		c->layer[c->after[first]].depth - c->layer[first].depth, first
	};
	size_t i = c->nheap++;

	for (; i > 0 && is_smaller(v, c->heap[(i - 1) / 2]); i = (i - 1) / 2)
		c->heap[i] = c->heap[(i - 1) / 2];
	c->heap[i] = v;
}

static struct interval
pop(struct cap *c)
{
	const struct interval top = c->heap[0], v = c->heap[--c->nheap];
	size_t i = 0;

	for (;;) {
		size_t k = 2 * i + 1;

		if (k + 1 < c->nheap && is_smaller(c->heap[k + 1], c->heap[k]))
			k++;
		if (k >= c->nheap || !is_smaller(c->heap[k], v))
			break;
		c->heap[i] = c->heap[k];
		i = k;
	}
	c->heap[i] = v;
	return top;
}

/* Remove the pair at the top, if it is one still. */
static bool
remove_smallest(struct cap *c)
{
	const struct interval v = pop(c);
	const size_t a = v.first, b = c->after[a];
	size_t before, after;

	if (c->gone[a] || b == c->n ||
	    c->layer[b].depth - c->layer[a].depth != v.length)
		return false;
	c->gone[a] = c->gone[b] = true;
	before = c->before[a];
	after = c->after[b];
	if (after < c->n)
		c->before[after] = before;
	if (before < c->n) {
		c->after[before] = after;
		if (after < c->n)
			push(c, before);
	}
	return true;
}

static size_t
cap_with(struct cap *c, size_t nlayers)
{
	size_t left = c->n, m = 0;

	for (size_t i = 0; i < c->n; i++) {
		c->before[i] = i > 0 ? i - 1 : c->n;
		c->after[i] = i + 1;
		c->gone[i] = false;
	}
	for (size_t i = 0; i + 1 < c->n; i++)
		push(c, i);
	while (left > nlayers)
		if (remove_smallest(c))
			left -= 2;
	for (size_t i = 0; i < c->n; i++)
		if (!c->gone[i])
			c->layer[m++] = c->layer[i];
	return m;
}

enum bake_status
bake_layer_cap_many(
    struct bake_layer *layer, size_t *n, size_t nlayers, struct bake_err *err)
{
	enum { FEW = 64 };
	struct cap c = { .layer = layer, .n = *n };
	enum bake_status rc = BAKE_ENOMEM;

	if (*n <= FEW || *n <= nlayers) {
		*n = bake_layer_cap(layer, *n, nlayers);
		return BAKE_OK;
	}
	/* each pair that is removed adds at most one interval */
	c.heap = bake_alloc(*n, 2 * sizeof *c.heap, err);
	c.before = bake_alloc(*n, sizeof *c.before, err);
	c.after = bake_alloc(*n, sizeof *c.after, err);
	c.gone = bake_alloc(*n, sizeof *c.gone, err);
	if (c.heap != NULL && c.before != NULL && c.after != NULL &&
	    c.gone != NULL) {
		*n = cap_with(&c, nlayers);
		rc = BAKE_OK;
	}
	free(c.heap);
	free(c.before);
	free(c.after);
	free(c.gone);
	return rc;
}
