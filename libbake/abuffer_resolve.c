/* The A-buffer: from all crossings of a ray to the solid's own. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>

#include "abuffer_priv.h"

/* Up to so many are sorted by insertion. */
enum { FEW = 16 };

/* Two sheets so close, in ranges, may be the wrong way round for rounding
 * alone. */
#define TOUCHING 1e-12

static inline bool
is_before(const struct abuffer_raw *a, const struct abuffer_raw *b)
{
	if (a->depth != b->depth)
		return a->depth < b->depth;
	if (a->key != b->key)
		return a->key < b->key;
	if (a->tile_y != b->tile_y)
		return a->tile_y < b->tile_y;
	return a->tile_x < b->tile_x;
}

static int
compare(const void *a, const void *b)
{
	return is_before(b, a) - is_before(a, b);
}

static inline void
sort(struct abuffer_raw *raw, size_t n)
{
	if (n > FEW) {
		qsort(raw, n, sizeof *raw, compare);
		return;
	}
	for (size_t i = 1; i < n; i++) {
		struct abuffer_raw r = raw[i];
		size_t k = i;

		for (; k > 0 && is_before(&r, &raw[k - 1]); k--)
			raw[k] = raw[k - 1];
		raw[k] = r;
	}
}

static inline struct bake_crossing
crossing_of(const struct abuffer_raw *raw, double depth, bool entering)
{
	return (struct bake_crossing){ .depth = depth,
		.entering = entering,
		.triangle = raw->key & ~ABUFFER_LEAVING & INT32_MAX,
		.tile_x = raw->tile_x,
		.tile_y = raw->tile_y };
}

/* The winding number's changes between 0 and others. */
static size_t
walk(const struct abuffer_raw *raw, size_t n, struct bake_crossing *out,
    struct bake_abuffer_stats *stats)
{
	long winding = 0;
	size_t nout = 0;
	bool solid = false, negative = false, inside_out = false;

	for (size_t i = 0; i < n; i++) {
		bool leaving = (raw[i].key & ABUFFER_LEAVING) != 0;
		long before = winding;

		winding += leaving ? -1 : 1;
		if (before != 0 && winding != 0)
			continue;
		out[nout++] = crossing_of(&raw[i], raw[i].depth, before == 0);
		if (before == 0) {
			negative = winding < 0;
		} else if (!solid) {
			double d = raw[i].depth, d0 = out[nout - 2].depth;

			solid = d - d0 > TOUCHING * fmax(1, fabs(d));
			inside_out = solid && negative;
		}
	}
	stats->united += nout < n;
	stats->inside_out += inside_out;
	if (winding != 0) {
		stats->open++;
		nout--;
	}
	return nout;
}

/* Each crossing a slab, and slabs that touch one. */
static size_t
thicken(const struct abuffer_raw *raw, size_t n, double half,
    struct bake_crossing *out, struct bake_abuffer_stats *stats)
{
	size_t nout = 0;

	for (size_t i = 0; i < n; i++) {
		double lo = raw[i].depth - half, hi = raw[i].depth + half;

		if (nout == 0 || lo > out[nout - 1].depth) {
			out[nout] = crossing_of(&raw[i], lo, true);
			nout += 2;
		}
		out[nout - 1] = crossing_of(&raw[i], hi, false);
	}
	stats->united += nout < 2 * n;
	return nout;
}

static size_t
resolve(struct abuffer_raw *raw, size_t n, double half,
    struct bake_crossing *out, struct bake_abuffer_stats *stats)
{
	sort(raw, n);
	return half > 0 ? thicken(raw, n, half, out, stats)
			: walk(raw, n, out, stats);
}

/* Most texels with any layer have two, which are in order or are exchanged;
 * this is what walk makes of them. */
static inline bool
is_plain_pair(struct abuffer_raw *raw)
{
	struct abuffer_raw r = raw[0];

	if (is_before(&raw[1], &raw[0])) {
		raw[0] = raw[1];
		raw[1] = r;
	}
	return (raw[0].key & ABUFFER_LEAVING) == 0 &&
	       (raw[1].key & ABUFFER_LEAVING) != 0;
}

void
bake_abuffer_resolve(struct abuffer_raw *raw, const uint32_t *end, int width,
    double half, size_t *start, struct bake_crossing *out,
    struct bake_abuffer_stats *stats)
{
	size_t begin = 0, nout = start[0], most = 0;

	for (int x = 0; x < width; x++) {
		size_t n = end[x] - begin, before = nout;
		struct bake_crossing *to = out + nout;

		if (n == 2 && half == 0 && is_plain_pair(raw + begin)) {
			const struct abuffer_raw *r = raw + begin;

			to[0] = crossing_of(&r[0], r[0].depth, true);
			to[1] = crossing_of(&r[1], r[1].depth, false);
			nout += 2;
		} else if (n > 0) {
			nout += resolve(raw + begin, n, half, to, stats);
		}
		start[x + 1] = nout;
		begin = end[x];
		most = nout - before > most ? nout - before : most;
	}
	if (most > (size_t)stats->most)
		stats->most = most > INT_MAX ? INT_MAX : (int)most;
	stats->crossings += begin;
}
