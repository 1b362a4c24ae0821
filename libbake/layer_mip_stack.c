/* The solid in a box of texels: how much of it at each depth, and where it
 * begins and ends at a threshold. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "layer_mip_priv.h"
#include "mem.h"

void
bake_stack_free(struct bake_stack *s)
{
	free(s->end[0]);
	free(s->end[1]);
	free(s->spare);
	free(s->layer);
	free(s->reach);
	*s = (struct bake_stack){ .n = 0 };
}

static enum bake_status
grow(uint32_t **codes, size_t n, size_t room, struct bake_err *err)
{
	uint32_t *more = bake_alloc(room, sizeof *more, err);

	if (more == NULL)
		return BAKE_ENOMEM;
	if (n > 0)
		memcpy(more, *codes, n * sizeof *more);
	free(*codes);
	*codes = more;
	return BAKE_OK;
}

/* Room for at least n slabs. */
static enum bake_status
reserve(struct bake_stack *s, size_t n, struct bake_err *err)
{
	size_t room;

	if (n <= s->room)
		return BAKE_OK;
	room = n + n / 2;
	if (grow(&s->end[0], s->n, room, err) != BAKE_OK ||
	    grow(&s->end[1], s->n, room, err) != BAKE_OK ||
	    grow(&s->spare, 0, room, err) != BAKE_OK)
		return BAKE_ENOMEM;
	s->room = room;
	return BAKE_OK;
}

static void
insertion_sort(uint32_t *code, size_t n)
{
	for (size_t i = 1; i < n; i++) {
		const uint32_t c = code[i];
		size_t k = i;

		for (; k > 0 && code[k - 1] > c; k--)
			code[k] = code[k - 1];
		code[k] = c;
	}
}

/* By one byte, from *code to *spare, which change places; not at all where all
 * have the same byte. */
static void
sort_by_byte(uint32_t **code, uint32_t **spare, size_t n, int shift)
{
	size_t first[257] = { 0 };
	uint32_t *from = *code, *to = *spare;

	for (size_t i = 0; i < n; i++)
		first[(from[i] >> shift & 255) + 1]++;
	for (int b = 0; b < 256; b++) {
		if (first[b + 1] == n)
			return;
		first[b + 1] += first[b];
	}
	for (size_t i = 0; i < n; i++)
		to[first[from[i] >> shift & 255]++] = from[i];
	*code = to;
	*spare = from;
}

static void
sort(uint32_t **code, uint32_t **spare, size_t n)
{
	enum { FEW = 48 };

	if (n <= FEW) {
		insertion_sort(*code, n);
		return;
	}
	for (int shift = 0; shift < 32; shift += 8)
		sort_by_byte(code, spare, n, shift);
}

enum bake_status
bake_stack_gather(struct bake_stack *s, const struct bake_layer_maps *maps,
    struct bake_box box, struct bake_err *err)
{
	const size_t most =
	    (size_t)(box.x1 - box.x0) * (size_t)(maps->nlayers / 2);
	uint32_t code[BAKE_LAYERS_MAX];

	s->format = maps->depth[0].format;
	s->ntexels = bake_box_texels(box);
	s->n = 0;
	for (int y = box.y0; y < box.y1; y++) {
		if (reserve(s, s->n + most, err) != BAKE_OK)
			return BAKE_ENOMEM;
		for (int x = box.x0; x < box.x1; x++) {
			const size_t t =
			    (size_t)y * (size_t)maps->width + (size_t)x;
			const int n = bake_layer_codes_of(maps, t, code);

			for (int i = 0; i + 1 < n; i += 2) {
				if (code[i] >= code[i + 1])
					continue;
				s->end[0][s->n] = code[i];
				s->end[1][s->n++] = code[i + 1];
			}
		}
	}
	sort(&s->end[0], &s->spare, s->n);
	sort(&s->end[1], &s->spare, s->n);
	return BAKE_OK;
}

/* A walk through the depths at which the number of solid texels changes. */
struct walk {
	size_t i, k;    /* entries and exits that are behind */
	uint64_t count; /* solid texels from here on */
	uint32_t code;
};

static bool
walk_on(const struct bake_stack *s, struct walk *w)
{
	/* each entry comes before its exit: there are none after the last */
	if (w->k == s->n)
		return false;
	w->code = s->end[1][w->k];
	if (w->i < s->n && s->end[0][w->i] < w->code)
		w->code = s->end[0][w->i];
	for (; w->i < s->n && s->end[0][w->i] == w->code; w->i++)
		w->count++;
	for (; w->k < s->n && s->end[1][w->k] == w->code; w->k++)
		w->count--;
	return true;
}

uint64_t
bake_stack_histogram(const struct bake_stack *s, uint64_t *hist)
{
	struct walk w = { 0 };
	uint64_t last = 0, count = 0, volume = 0;

	while (walk_on(s, &w)) {
		const uint64_t place = bake_layer_place(w.code, s->format);
		const uint64_t bin =
		    (count * BAKE_TAU_ONE + s->ntexels - 1) / s->ntexels;

		volume += (place - last) * count;
		/* empty depths are bin 0, which no threshold keeps */
		hist[bin] += (place - last) * s->ntexels;
		last = place;
		count = w.count;
	}
	return volume;
}

uint32_t
bake_tau_choose(const uint64_t *hist, uint64_t volume)
{
	uint64_t v = 0, above;
	uint32_t t = 0, t_above = 0;

	if (volume == 0)
		return BAKE_TAU_ONE / 2;
	for (int i = 1; i <= BAKE_TAU_ONE; i++)
		v += hist[i];
	above = v;
	/* v falls from >= volume (all that is solid anywhere) to 0 */
	while (v >= volume) {
		if (v != above) {
			above = v;
			t_above = t;
		}
		t++;
		v -= hist[t];
	}
	return (unsigned __int128)above * v <=
		       (unsigned __int128)volume * volume
		   ? t_above
		   : t;
}

static bool
is_solid(const struct bake_stack *s, uint64_t count, uint32_t t)
{
	return count * BAKE_TAU_ONE > t * s->ntexels;
}

/* How many layers there are at threshold t, and, if layer is not NULL, them. */
static size_t
find_layers(const struct bake_stack *s, uint32_t t, struct bake_layer *layer)
{
	struct walk w = { 0 };
	size_t n = 0;

	while (walk_on(s, &w)) {
		if (is_solid(s, w.count, t) != (n % 2 != 0)) {
			if (layer != NULL)
				layer[n] = (struct bake_layer){ w.code, 0,
					(double)bake_layer_place(
					    w.code, s->format) };
			n++;
		}
	}
	return n;
}

/* The first of n codes that is >= code. */
static size_t
lower_bound(const uint32_t *codes, size_t n, uint32_t code)
{
	size_t first = 0;

	while (n > 0) {
		if (codes[first + n / 2] < code) {
			first += n / 2 + 1;
			n -= n / 2 + 1;
		} else {
			n /= 2;
		}
	}
	return first;
}

/* The mean distance of the ends that have a part in layer i. */
static double
reach_of(const struct bake_stack *s, size_t i)
{
	const uint32_t *codes = s->end[i % 2];
	const uint64_t place = bake_layer_place(s->layer[i].code, s->format);
	size_t a = 0, b = s->n;
	uint64_t sum = 0;

	if (i > 0)
		a = lower_bound(codes, s->n, s->layer[i - 1].code);
	if (i + 1 < s->nlayers)
		b = lower_bound(codes, s->n, s->layer[i + 1].code);
	for (size_t k = a; k < b; k++) {
		const uint64_t p = bake_layer_place(codes[k], s->format);

		sum += p > place ? p - place : place - p;
	}
	/* the layer's own end is one of them */
	return (double)sum / (double)(b - a);
}

enum bake_status
bake_stack_solve(
    struct bake_stack *s, uint32_t t, int most, struct bake_err *err)
{
	const size_t n = find_layers(s, t, NULL);

	if (n > s->layer_room) {
		free(s->layer);
		free(s->reach);
		s->layer_room = 0;
		s->layer = bake_alloc(n, sizeof *s->layer, err);
		s->reach = bake_alloc((size_t)n, sizeof *s->reach, err);
		if (s->layer == NULL || s->reach == NULL)
			return BAKE_ENOMEM;
		s->layer_room = n;
	}
	find_layers(s, t, s->layer);
	s->capped = n > (size_t)most;
	s->nlayers = n;
	if (bake_layer_cap_many(s->layer, &s->nlayers, (size_t)most, err) !=
	    BAKE_OK)
		return BAKE_ENOMEM;
	for (size_t i = 0; i < s->nlayers; i++)
		s->reach[i] = reach_of(s, i);
	return BAKE_OK;
}
