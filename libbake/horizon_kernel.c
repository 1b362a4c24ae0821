/* The fast march along the rays of a strip, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#define BAKE_VEC_256 /* a packet's row is 8 texels */
#include <stdint.h>

#include "horizon_priv.h"
#include "isa.h"
#include "vec_priv.h"

enum { SEGMENT = 8 }; /* most chunks that are tested before one is marched */
enum { WHOLE_PACKET = 3 }; /* rows from which a packet is cheaper */
/* most live texels for each live packet that are marched one by one */
enum { LONERS_A_PACKET = 4 };
enum { LONERS_MAX = LONERS_A_PACKET * BAKE_STRIP_PACKETS };
_Static_assert(LONERS_MAX == 32, "a bit each in a word");
enum { NEAR_CHUNKS = 2 }; /* most that a far field leaves */

#define INLINE inline __attribute__((always_inline))

struct march {
	const struct bake_horizon *hz;
	const struct bake_horizon_ray *ray;
	int x0, y0;
	const float *base; /* texel (x0, y0) */
	float *slopes;
	unsigned alive;  /* packets that a test may hit */
	unsigned raised; /* packets marched since they were bounded */
	/* the packets' texels, row by row, with a bound below all of the map's
	 * highest when it was last looked at; none of dead packets */
	uint32_t live[BAKE_STRIP_PACKETS];
	float ahead[BAKE_STRIP_PACKETS]; /* bound at the segment's end */
	float floor[BAKE_STRIP_PACKETS]; /* see bound_packets */
	float incline[BAKE_STRIP_PACKETS];
};

/* Where chunk c's origin is: a float in the heights, the packets' windows. */
struct spot {
	const float *texels, *windows;
};

/* Texel (x, y) of a chunk's origin. */
static inline void
find_texel(const struct march *m, const struct bake_horizon_place *place,
    int *x, int *y)
{
	const struct bake_horizon *hz = m->hz;

	*x = bake_horizon_wrap(
	    m->x0 + place->x, hz->heights.width, hz->wrap.clamp_u, hz->left);
	*y = bake_horizon_wrap(
	    m->y0 + place->y, hz->heights.height, hz->wrap.clamp_v, hz->top);
}

static inline const float *
texels_at(const struct bake_horizon *hz, int x, int y)
{
	return hz->heights.data +
	       (ptrdiff_t)y * (ptrdiff_t)hz->heights.row_stride + x;
}

static inline struct spot
find_spot(const struct march *m, const struct bake_horizon_place *place)
{
	const struct bake_horizon *hz = m->hz;
	unsigned px, py;
	int x, y;

	find_texel(m, place, &x, &y);
	px = (unsigned)(x + hz->left) / 2;
	py = (unsigned)(y + hz->top) / 2;
	return (struct spot){
		texels_at(hz, x, y),
		hz->windows.data +
		    ((size_t)py * BAKE_WINDOW_PHASES +
			px % BAKE_WINDOW_PHASES) *
			hz->windows.stride +
		    px / BAKE_WINDOW_PHASES,
	};
}

/* All steps of a chunk for one vector in each row of a packet, the first of
 * them at texels. */
static INLINE void
march_steps(const struct march *m, const struct bake_horizon_chunk *chunk,
    const float *texels, const vec_f here[BAKE_PACKET_HEIGHT],
    vec_f best[BAKE_PACKET_HEIGHT], const bool x_major)
{
	const size_t stride = m->hz->heights.row_stride;
	const size_t minor = x_major ? stride : 1;

	for (int i = 0; i < BAKE_CHUNK; i++) {
		const float *p = texels + chunk->rel[i];
		const vec_f w0 = vec_set(chunk->w0[i]);
		const vec_f w1 = vec_set(chunk->w1[i]);
		vec_f h0, h1 = vec_load(p);

		for (int r = 0; r < BAKE_PACKET_HEIGHT; r++) {
			if (x_major)
				h0 = h1;
			else
				h0 = vec_load(p + (size_t)r * stride);
			h1 = vec_load(p + (size_t)r * stride + minor);
			best[r] = vec_max(
			    w0 * (here[r] - h0) + w1 * (here[r] - h1), best[r]);
		}
	}
}

/* All steps of a chunk for one packet. */
static INLINE void
march_packet(const struct march *m, const struct bake_horizon_chunk *chunk,
    const float *texels, int packet, const bool x_major)
{
	const size_t stride = m->hz->heights.row_stride;
	const float *base = m->base + packet * BAKE_PACKET_WIDTH;
	float *slopes = m->slopes + packet * BAKE_PACKET_WIDTH;

	texels += packet * BAKE_PACKET_WIDTH;
	for (int v = 0; v < BAKE_PACKET_WIDTH; v += VEC_LANES) {
		vec_f best[BAKE_PACKET_HEIGHT], here[BAKE_PACKET_HEIGHT];

		for (int r = 0; r < BAKE_PACKET_HEIGHT; r++) {
			best[r] = vec_load(slopes + r * BAKE_STRIP_WIDTH + v);
			here[r] = vec_load(base + (size_t)r * stride + v);
		}
		march_steps(m, chunk, texels + v, here, best, x_major);
		for (int r = 0; r < BAKE_PACKET_HEIGHT; r++)
			vec_store(slopes + r * BAKE_STRIP_WIDTH + v, best[r]);
	}
}

/* The same for one of its rows. Both signs are turned, which gives the same
 * bits, because a subtrahend can come straight from memory. */
static INLINE void
march_row(const struct march *m, const struct bake_horizon_chunk *chunk,
    const float *texels, int packet, int row, const bool x_major)
{
	const size_t stride = m->hz->heights.row_stride;
	const size_t minor = x_major ? stride : 1;
	const size_t at =
	    (size_t)packet * BAKE_PACKET_WIDTH + (size_t)row * stride;
	float *slopes =
	    m->slopes + packet * BAKE_PACKET_WIDTH + row * BAKE_STRIP_WIDTH;

	for (int v = 0; v < BAKE_PACKET_WIDTH; v += VEC_LANES) {
		const vec_f here = vec_load(m->base + at + v);
		vec_f best = vec_load(slopes + v);

		for (int i = 0; i < BAKE_CHUNK; i++) {
			const float *p = texels + at + chunk->rel[i] + v;
			vec_f h0 = vec_load(p), h1 = vec_load(p + minor);

			best = vec_max(vec_set(chunk->w0[i]) * (here - h0) +
					   vec_set(chunk->w1[i]) * (here - h1),
			    best);
		}
		vec_store(slopes + v, best);
	}
}

/*
 * The lowest height above the horizons of a packet at distance reach: the
 * least h + slope * reach, rounded down by slack unless the slope is 0.
 * Nothing below it can raise a horizon at that distance. *live: the texels
 * that something may raise there.
 */
static INLINE float
packet_bound(const struct march *m, int packet, float reach, uint32_t *live)
{
	const size_t stride = m->hz->heights.row_stride;
	const vec_f d = vec_set(reach), slack = vec_set(m->hz->slack);
	const vec_f highest = vec_set(m->hz->highest);
	const float *base = m->base + packet * BAKE_PACKET_WIDTH;
	const float *slopes = m->slopes + packet * BAKE_PACKET_WIDTH;
	vec_f low = vec_set(1e38f);

	*live = 0;
	for (int r = 0; r < BAKE_PACKET_HEIGHT; r++)
		for (int v = 0; v < BAKE_PACKET_WIDTH; v += VEC_LANES) {
			vec_f s = vec_load(slopes + r * BAKE_STRIP_WIDTH + v);
			vec_f h = vec_load(base + (size_t)r * stride + v);
			vec_f bound = h + vec_max(s * d - slack, vec_set(0));

			low = vec_min(bound, low);
			*live |= (uint32_t)vec_gt_mask(highest, bound)
				 << (r * BAKE_PACKET_WIDTH + v);
		}
	return vec_lowest(low);
}

/*
 * The rows of the packet with a texel that chunk c may raise, by the crest of
 * each texel's own ray.
 */
static INLINE unsigned
packet_hit(const struct march *m, int packet, long c, const struct spot *spot)
{
	const struct bake_horizon *hz = m->hz;
	const size_t stride = hz->heights.row_stride;
	const vec_f d = vec_set(m->ray->places[c].reach);
	const size_t at = (size_t)packet * BAKE_PACKET_WIDTH;
	const float *crest = hz->crests + (spot->texels - hz->padded) +
			     m->ray->chunks[c].crest_rel + at;
	const float *here = m->base + at, *slopes = m->slopes + at;
	unsigned rows = 0;

	for (int r = 0; r < BAKE_PACKET_HEIGHT; r++) {
		unsigned hit = 0;

		for (int v = 0; v < BAKE_PACKET_WIDTH; v += VEC_LANES) {
			hit |= vec_gt_mask(
			    vec_load(crest + v) - vec_load(here + v),
			    vec_load(slopes + v) * d);
		}
		rows |= (unsigned)(hit != 0) << r;
		crest += stride;
		here += stride;
		slopes += BAKE_STRIP_WIDTH;
	}
	return rows;
}

/*
 * The bound of a packet is a concave function of distance (the least of
 * rising lines), so between two distances it is above its chord
 * floor + incline * (d - from). A packet whose bound is above all of the map
 * is done.
 */
static void
bound_packets(struct march *m, float from, float to)
{
	for (int p = 0; p < BAKE_STRIP_PACKETS; p++) {
		uint32_t live;
		float a, b;

		if (!(m->alive >> p & 1))
			continue;
		/* an older bound, at a smaller distance, holds as well */
		a = m->raised >> p & 1 ? packet_bound(m, p, from, &m->live[p])
				       : m->ahead[p];
		if (a >= m->hz->highest) {
			m->alive &= ~(1u << p);
			m->live[p] = 0;
			m->floor[p] = 3e38f;
			m->incline[p] = 0;
			continue;
		}
		b = to > from ? packet_bound(m, p, to, &live) : a;
		m->floor[p] = a;
		m->ahead[p] = b;
		m->incline[p] = to > from ? (b - a) / (to - from) : 0;
	}
	m->raised = 0;
}

/* The packets that chunk c may raise, by its windows against the chords. */
static INLINE unsigned
test_chunk(const struct march *m, const float *windows, float ahead)
{
	const vec_f x = vec_set(ahead);
	unsigned hits = 0;

	for (int v = 0; v < BAKE_STRIP_PACKETS; v += VEC_LANES)
		hits |=
		    vec_gt_mask(vec_load(windows + v) - vec_load(m->floor + v),
			vec_load(m->incline + v) * x)
		    << v;
	return hits;
}

/* March the packets of 'hits' through chunk c, except rows that the chunk's
 * window cannot raise. */
static INLINE void
march_hits(const struct march *m, long c, const struct spot *spot,
    unsigned hits, const bool x_major)
{
	for (; hits != 0; hits &= hits - 1) {
		const int p = __builtin_ctz(hits);
		unsigned rows = packet_hit(m, p, c, spot);

		if (__builtin_popcount(rows) >= WHOLE_PACKET) {
			march_packet(
			    m, &m->ray->chunks[c], spot->texels, p, x_major);
			continue;
		}
		for (; rows != 0; rows &= rows - 1)
			march_row(m, &m->ray->chunks[c], spot->texels, p,
			    __builtin_ctz(rows), x_major);
	}
}

/* Chunk c for all packets. */
static INLINE void
march_dense(const struct march *m, long c, const bool x_major)
{
	int x, y;

	/* the near field has no windows */
	find_texel(m, &m->ray->places[c], &x, &y);
	for (int p = 0; p < BAKE_STRIP_PACKETS; p++)
		march_packet(
		    m, &m->ray->chunks[c], texels_at(m->hz, x, y), p, x_major);
}

/*
 * Where few of a packet's texels are live, as the tops of grain are, they are
 * marched one by one.
 */
struct loners {
	int n;
	int at[LONERS_MAX]; /* in heights and crests, from the strip's first */
	int slot[LONERS_MAX]; /* in slopes */
	float here[LONERS_MAX], slope[LONERS_MAX];
};

/* Whether the live texels are few, and which. */
static bool
find_loners(const struct march *m, struct loners *l)
{
	const int stride = (int)m->hz->heights.row_stride;
	int nlive = 0;

	for (int p = 0; p < BAKE_STRIP_PACKETS; p++)
		nlive += __builtin_popcount(m->live[p]);
	if (nlive > LONERS_A_PACKET * __builtin_popcount(m->alive))
		return false;
	l->n = 0;
	for (int p = 0; p < BAKE_STRIP_PACKETS; p++)
		for (uint32_t live = m->live[p]; live != 0; live &= live - 1) {
			const int t = __builtin_ctz(live);
			const int x =
			    p * BAKE_PACKET_WIDTH + t % BAKE_PACKET_WIDTH;
			const int y = t / BAKE_PACKET_WIDTH;

			l->at[l->n] = y * stride + x;
			l->slot[l->n] = y * BAKE_STRIP_WIDTH + x;
			l->here[l->n] = m->base[l->at[l->n]];
			l->slope[l->n] = m->slopes[l->slot[l->n]];
			l->n++;
		}
	return true;
}

/* Keep those that something at this distance or beyond may raise, by
 * packet_bound's rule. */
static void
drop_loners(const struct march *m, struct loners *l, float reach)
{
	int n = 0;

	for (int i = 0; i < l->n; i++) {
		const float rise = l->slope[i] * reach - m->hz->slack;

		if (l->here[i] + (rise > 0 ? rise : 0) >= m->hz->highest)
			continue;
		l->at[n] = l->at[i];
		l->slot[n] = l->slot[i];
		l->here[n] = l->here[i];
		l->slope[n++] = l->slope[i];
	}
	l->n = n;
}

/* Those that chunk c may raise, as packet_hit finds them. */
static INLINE uint32_t
test_loners(const struct loners *l, const float *crest, float reach)
{
	uint32_t hits = 0;

	for (int i = 0; i < l->n; i++)
		hits |= (uint32_t)(crest[l->at[i]] - l->here[i] >
				   l->slope[i] * reach)
			<< i;
	return hits;
}

/* march_packet for one texel. */
static INLINE float
march_texel(const struct bake_horizon_chunk *chunk, const float *texel,
    size_t minor, float here, float best)
{
	for (int i = 0; i < BAKE_CHUNK; i++) {
		const float *p = texel + chunk->rel[i];
		const float slope = chunk->w0[i] * (here - p[0]) +
				    chunk->w1[i] * (here - p[minor]);

		best = slope > best ? slope : best;
	}
	return best;
}

/* Chunk c and all after it. */
static INLINE void
march_loners(
    const struct march *m, struct loners *l, long c, const bool x_major)
{
	const struct bake_horizon *hz = m->hz;
	const struct bake_horizon_ray *ray = m->ray;
	const size_t minor = x_major ? hz->heights.row_stride : 1;

	for (; c < ray->nchunks; c++) {
		const struct bake_horizon_chunk *chunk = &ray->chunks[c];
		const float *texels;
		int x, y;

		if (c % SEGMENT == 0)
			drop_loners(m, l, ray->places[c].reach);
		if (l->n == 0)
			return;
		find_texel(m, &ray->places[c], &x, &y);
		texels = texels_at(hz, x, y);
		for (uint32_t hits = test_loners(l,
			 hz->crests + (texels - hz->padded) + chunk->crest_rel,
			 ray->places[c].reach);
		     hits != 0; hits &= hits - 1) {
			const int i = __builtin_ctz(hits);

			l->slope[i] = march_texel(chunk, texels + l->at[i],
			    minor, l->here[i], l->slope[i]);
			m->slopes[l->slot[i]] = l->slope[i];
		}
	}
}

static INLINE void
march_strip(struct march *m, const bool x_major)
{
	struct loners loners;
	const struct bake_horizon_ray *ray = m->ray;
	long c = 0, length = 1;

	if (c < ray->nchunks)
		march_dense(m, c++, x_major);
	m->alive = m->raised = (1u << BAKE_STRIP_PACKETS) - 1;
	while (c < ray->nchunks) {
		const long end =
		    c + length < ray->nchunks ? c + length : ray->nchunks;
		const float from = ray->places[c].reach;
		struct spot spots[SEGMENT];
		unsigned hits[SEGMENT], any = 0;

		bound_packets(m, from, ray->places[end - 1].reach);
		if (m->alive == 0)
			return;
		if (find_loners(m, &loners)) {
			march_loners(m, &loners, c, x_major);
			return;
		}
		for (int i = 0; i < end - c; i++) {
			spots[i] = find_spot(m, &ray->places[c + i]);
			hits[i] = test_chunk(m, spots[i].windows,
			    (ray->places[c + i].reach - from) * (1 - 0x1p-18f));
			any |= hits[i];
			m->raised |= hits[i];
		}
		for (int i = 0; any != 0 && c < end; i++, c++)
			march_hits(m, c, &spots[i], hits[i], x_major);
		c = end;
		length = length < SEGMENT ? 2 * length : SEGMENT;
	}
}

static inline struct march
start_march(
    const struct bake_horizon *hz, int side, int x0, int y0, float *slopes)
{
	return (struct march){
		.hz = hz,
		.ray = &hz->ray[side],
		.x0 = x0,
		.y0 = y0,
		.base = bake_image_row(&hz->heights, y0) + x0,
		.slopes = slopes,
	};
}

void
BAKE_KERNEL(bake_horizon_strip)(
    const struct bake_horizon *hz, int side, int x0, int y0, float *slopes)
{
	struct march m = start_march(hz, side, x0, y0, slopes);

	/* two clones, each with its branches decided */
	if (m.ray->dir.x_major)
		march_strip(&m, true);
	else
		march_strip(&m, false);
}

/* The chunks before the far field for one packet, from slopes 0 on. */
static INLINE void
near_packet(const struct march *m, const float *const texels[NEAR_CHUNKS],
    int packet, const bool x_major)
{
	const size_t stride = m->hz->heights.row_stride;
	const size_t at = (size_t)packet * BAKE_PACKET_WIDTH;

	for (int v = 0; v < BAKE_PACKET_WIDTH; v += VEC_LANES) {
		vec_f best[BAKE_PACKET_HEIGHT], here[BAKE_PACKET_HEIGHT];

		for (int r = 0; r < BAKE_PACKET_HEIGHT; r++) {
			best[r] = vec_set(0);
			here[r] =
			    vec_load(m->base + at + v + (size_t)r * stride);
		}
		for (long c = 0; c < m->ray->nchunks; c++)
			march_steps(m, &m->ray->chunks[c], texels[c] + at + v,
			    here, best, x_major);
		for (int r = 0; r < BAKE_PACKET_HEIGHT; r++)
			vec_store(
			    m->slopes + at + v + r * BAKE_STRIP_WIDTH, best[r]);
	}
}

static INLINE void
march_near(const struct march *m, const bool x_major)
{
	const float *texels[NEAR_CHUNKS];
	int x, y;

	for (long c = 0; c < m->ray->nchunks; c++) {
		find_texel(m, &m->ray->places[c], &x, &y);
		texels[c] = texels_at(m->hz, x, y);
	}
	for (int p = 0; p < BAKE_STRIP_PACKETS; p++)
		near_packet(m, texels, p, x_major);
}

void
BAKE_KERNEL(bake_horizon_near)(
    const struct bake_horizon *hz, int side, int x0, int y0, float *slopes)
{
	struct march m = start_march(hz, side, x0, y0, slopes);

	if (m.ray->dir.x_major)
		march_near(&m, true);
	else
		march_near(&m, false);
}
