/* The fast march along the rays of a strip, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#define BAKE_VEC_256 /* a packet's row is 8 texels */
#include <math.h>
#include <string.h>

#include "horizon_priv.h"
#include "isa.h"
#include "vec_priv.h"

enum { SEGMENT = 8 }; /* most chunks that are tested before one is marched */
enum { WHOLE_PACKET = 3 }; /* rows from which a packet is cheaper */
enum { NVECS = BAKE_PACKET_WIDTH / VEC_LANES }; /* vectors in a row */
enum { NEAR_CHUNKS = 2 }; /* most that a far field leaves */

/* this far right of a clamped map, nothing but its border is looked at */
enum { ALL_BORDER = 40 };

#define INLINE inline __attribute__((always_inline))

struct march {
	const struct bake_horizon *hz;
	const struct bake_horizon_ray *ray;
	int x0, y0;
	const float *base; /* texel (x0, y0) */
	float *slopes;
	unsigned alive;  /* packets that a test may hit */
	unsigned raised; /* packets marched since they were bounded */
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
 * Nothing below it can raise a horizon at that distance.
 */
static INLINE float
packet_bound(const struct march *m, int packet, float reach)
{
	const size_t stride = m->hz->heights.row_stride;
	const vec_f d = vec_set(reach), slack = vec_set(m->hz->slack);
	const float *base = m->base + packet * BAKE_PACKET_WIDTH;
	const float *slopes = m->slopes + packet * BAKE_PACKET_WIDTH;
	vec_f low = vec_set(1e38f);

	for (int r = 0; r < BAKE_PACKET_HEIGHT; r++)
		for (int v = 0; v < NVECS; v++) {
			vec_f s = vec_load(
			    slopes + r * BAKE_STRIP_WIDTH + v * VEC_LANES);
			vec_f h =
			    vec_load(base + (size_t)r * stride + v * VEC_LANES);

			low = vec_min(
			    h + vec_max(s * d - slack, vec_set(0)), low);
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
		float a, b;

		if (!(m->alive >> p & 1))
			continue;
		/* an older bound, at a smaller distance, holds as well */
		a = m->raised >> p & 1 ? packet_bound(m, p, from) : m->ahead[p];
		if (a >= m->hz->highest) {
			m->alive &= ~(1u << p);
			m->floor[p] = 3e38f;
			m->incline[p] = 0;
			continue;
		}
		b = to > from ? packet_bound(m, p, to) : a;
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

static INLINE void
march_strip(struct march *m, const bool x_major)
{
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

/* What a crest is made of: for each step a row of the map, dx being the least
 * of their offsets. */
struct taps {
	int dx;
	ptrdiff_t minor;
	const float *at[BAKE_CHUNK];
};

/* The taps for row y. */
static struct taps
find_taps(const struct bake_horizon *hz, int y)
{
	const struct bake_horizon_dir *dir = &hz->ray[0].dir;
	const ptrdiff_t stride = (ptrdiff_t)hz->heights.row_stride;
	struct taps taps = { .minor = dir->x_major ? stride : 1 };
	int dx[BAKE_CHUNK];

	for (int i = 0; i < BAKE_CHUNK; i++) {
		const int minor =
		    (int)floor(i * dir->minor + BAKE_HORIZON_SNAP);
		const int dy = dir->x_major ? minor : i * dir->major;
		const int row = hz->wrap.clamp_v
				    ? bake_horizon_wrap(y + dy,
					  hz->heights.height, true, hz->top)
				    : bake_wrap_index((long)y + dy,
					  hz->heights.height, false);

		dx[i] = dir->x_major ? i * dir->major : minor;
		taps.dx = dx[i] < taps.dx ? dx[i] : taps.dx;
		taps.at[i] = hz->heights.data + row * stride;
	}
	for (int i = 0; i < BAKE_CHUNK; i++)
		taps.at[i] += dx[i] - taps.dx;
	return taps;
}

/* The highest texel that any ray through the chunk can meet, wherever
 * between two texels it starts. */
static INLINE vec_f
crest_at(const struct taps *taps, ptrdiff_t x)
{
	vec_f high = vec_load(taps->at[0] + x);

	for (int i = 0; i < BAKE_CHUNK; i++) {
		const float *p = taps->at[i] + x;

		high = vec_max(vec_max(vec_load(p), vec_load(p + taps->minor)),
		    vec_max(vec_load(p + 2 * taps->minor), high));
	}
	return high;
}

void
BAKE_KERNEL(bake_horizon_crest_row)(const struct bake_horizon *hz, int y)
{
	const struct taps taps = find_taps(hz, y);
	const int width = hz->heights.width;
	const int left = hz->left, n = hz->padded_width;
	const bool clamp = hz->wrap.clamp_u;
	float *out =
	    hz->crests + (size_t)(y + hz->top) * hz->heights.row_stride;
	int px = bake_wrap_index(taps.dx, width, false);

	for (int x = 0; x < n; x += VEC_LANES) {
		/* where all is border, anywhere there will do */
		const int at = clamp ? bake_horizon_wrap(x - left + taps.dx,
					   width + ALL_BORDER, true, left)
				     : px;
		vec_f high = crest_at(&taps, at);
		float rest[VEC_LANES];

		for (px += VEC_LANES; px >= width;)
			px -= width;
		if (x + VEC_LANES <= n) {
			vec_store(out + x, high);
			continue;
		}
		vec_store(rest, high);
		for (int i = 0; x + i < n; i++)
			out[x + i] = rest[i];
	}
}

/* dst(x) = max of src(x) and src(x + add) for one row of windows; beyond the
 * last origin windows are cut short, and not used. */
static void
widen_row(float *dst, const float *src, size_t stride, int add)
{
	for (int p = 0; p < BAKE_WINDOW_PHASES; p++) {
		const size_t skip = (size_t)(p + add) / BAKE_WINDOW_PHASES;
		const float *a = src + (size_t)p * stride;
		const float *b =
		    src + (size_t)(p + add) % BAKE_WINDOW_PHASES * stride +
		    skip;
		float *out = dst + (size_t)p * stride;

		for (size_t i = 0; i < stride - skip; i++)
			out[i] = a[i] > b[i] ? a[i] : b[i];
		for (size_t i = stride - skip; i < stride; i++)
			out[i] = a[i];
	}
}

void
BAKE_KERNEL(bake_horizon_windows_row)(
    const struct bake_horizon *hz, int y2, float *scratch)
{
	const size_t stride = hz->windows.stride;
	const size_t n = stride * BAKE_WINDOW_PHASES;
	float *from = scratch, *to = scratch + n;
	int last = 1;

	memcpy(
	    from, bake_horizon_window_row(&hz->blocks, y2), n * sizeof *from);
	for (int i = 1; i < hz->rows; i++) {
		const float *src = bake_horizon_window_row(&hz->blocks, y2 + i);

		for (size_t x = 0; x < n; x++)
			from[x] = src[x] > from[x] ? src[x] : from[x];
	}
	/* windows of 2, 4, 8 columns and then two that overlap */
	while (last < hz->columns) {
		int add = last < hz->columns - last ? last : hz->columns - last;
		float *t = from;

		widen_row(to, from, stride, add);
		from = to;
		to = t;
		last += add;
	}
	memcpy(
	    bake_horizon_window_row(&hz->windows, y2), from, n * sizeof *from);
}
