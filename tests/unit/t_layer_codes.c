/* Layer codes: no slab is lost unsaid, and the cap costs little occupancy. */
/* SPDX-License-Identifier: MIT */
#include <stdbool.h>
#include <stdint.h>

#include "check.h"
#include "layer_codes.h"
#include "test_maps.h"

enum { MOST = 64 };

static const enum bake_data_format formats[] = { BAKE_DATA_UINT8,
	BAKE_DATA_UINT16, BAKE_DATA_HALF, BAKE_DATA_FLOAT };

struct rng {
	uint32_t state;
};

/* 0 <= x < 1, 32 bits of it */
static double
uniform(struct rng *r)
{
	r->state = r->state * 1664525u + 1013904223u;
	return (double)hash(r->state) * 0x1p-32;
}

static int
cmp_double(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void
stack_of(struct bake_crossing *c, double *d, int n)
{
	qsort(d, (size_t)n, sizeof *d, cmp_double);
	for (int i = 0; i < n; i++)
		c[i] = (struct bake_crossing){ .depth = d[i],
			.entering = i % 2 == 0,
			.triangle = (unsigned)i };
}

/* A random stack of 2 .. MOST crossings, of a kind that is hard in some way. */
static int
random_stack(struct rng *r, int kind, struct bake_crossing *c)
{
	const int n = 2 + 2 * (int)(uniform(r) * (MOST / 2));
	const double at = uniform(r);
	double d[MOST + 2];

	for (int i = 0; i < n; i++)
		switch (kind) {
		case 0: /* anywhere, some beyond the range */
			d[i] = uniform(r) * 1.2 - 0.1;
			break;
		case 1: /* all within a few codes of 8 bits */
			d[i] = at + uniform(r) * 6 / 253;
			break;
		case 2: /* within a few of 16 bits */
			d[i] = at + uniform(r) * 8 / 65021;
			break;
		case 3: /* crowded at an end of the range */
			d[i] = uniform(r) * 3 / 253;
			d[i] = at < 0.5 ? d[i] : 1 - d[i];
			break;
		case 4: /* equal depths, and codes exactly, and halves */
			d[i] = floor(uniform(r) * 40) / 2 / 253;
			d[i] = at < 0.5 ? d[i] : 1 - d[i];
			break;
		default: /* within a few floats */
			d[i] = at + uniform(r) * 0x1p-22;
			break;
		}
	stack_of(c, d, n);
	return n;
}

static double
clamp01(double d)
{
	return d < 0 ? 0 : d > 1 ? 1 : d;
}

/* What must hold of any texel without a cap. */
static bool
is_sound(const struct bake_crossing *c, int n, const struct bake_layer *l,
    int m, enum bake_data_format f, const struct bake_layer_stats *s)
{
	const uint32_t lo = bake_layer_code(0, f), hi = bake_layer_code(1, f);
	size_t nclamped = 0, ncut = 0;

	for (int i = 0; i + 1 < n; i += 2) {
		if (c[i + 1].depth < 0 || c[i].depth > 1) {
			ncut++;
			continue;
		}
		nclamped += (c[i].depth < 0) + (c[i].depth > 1);
		nclamped += (c[i + 1].depth < 0) + (c[i + 1].depth > 1);
	}
	if (m % 2 != 0 || s->cut != ncut || s->clamped != nclamped ||
	    s->capped != 0 || s->removed != 0)
		return false;
	/* every slab is there, or cut, or merged */
	if ((size_t)n / 2 != (size_t)m / 2 + s->cut + s->merged)
		return false;
	for (int i = 0; i < m; i++) {
		const uint32_t near = bake_layer_code(l[i].depth, f);

		if (l[i].code < lo || l[i].code > hi ||
		    (i > 0 && l[i].code <= l[i - 1].code))
			return false;
		/* parity, order and depth of the crossing it came from */
		if (l[i].crossing < 0 || l[i].crossing >= n ||
		    l[i].crossing % 2 != i % 2 ||
		    (i > 0 && l[i].crossing <= l[i - 1].crossing) ||
		    l[i].depth != clamp01(c[l[i].crossing].depth))
			return false;
		/* widened: entries one earlier, exits one later, or not */
		if (near - l[i].code != (i % 2 == 0 ? 1u : -1u) &&
		    near != l[i].code)
			return false;
	}
	return true;
}

/*
 * Every real slab still touches a slab of the texture, of true depth within a
 * code of it; and every gap with two codes or more between its ends is open.
 */
static bool
nothing_is_lost(const struct bake_crossing *c, int n,
    const struct bake_layer *l, int m, enum bake_data_format f)
{
	for (int i = 0; i + 1 < n; i += 2) {
		const uint32_t a = bake_layer_code(c[i].depth, f);
		const uint32_t b = bake_layer_code(c[i + 1].depth, f);
		bool found = false, open = false;

		if (c[i + 1].depth < 0 || c[i].depth > 1)
			continue;
		for (int j = 0; j < m; j += 2)
			found |= l[j].code <= a && l[j + 1].code >= b;
		if (!found)
			return false;
		if (i + 2 >= n || c[i + 2].depth > 1)
			continue;
		/* both ends may be moved by one code by widening */
		if (bake_layer_code(c[i + 2].depth, f) <= b + 2)
			continue;
		for (int j = 1; j + 1 < m; j += 2)
			open |= l[j].code >= b && l[j].code <= b + 1 &&
				l[j + 1].code > l[j].code;
		if (!open)
			return false;
	}
	return true;
}

static void
random_stacks_lose_nothing(void)
{
	struct rng r = { 1 };

	for (int i = 0; i < 60000; i++) {
		struct bake_crossing c[MOST + 2];
		struct bake_layer l[MOST + 2];
		const struct bake_layer_params p = {
			.format = formats[i % 4],
		};
		struct bake_layer_stats s = BAKE_LAYER_STATS_INIT;
		const int n = random_stack(&r, i / 4 % 6, c);
		const int m = bake_layer_quantize(c, n, &p, l, &s);
		const bool ok = is_sound(c, n, l, m, p.format, &s) &&
				nothing_is_lost(c, n, l, m, p.format);

		if (!ok)
			printf("stack %d: %d crossings, %d layers\n", i, n, m);
		CHECK(ok);
	}
}

/* -- codes ----------------------------------------------------------------- */

static void
codes_are_the_nearest(void)
{
	struct rng r = { 2 };

	for (int f = 0; f < 4; f++) {
		CHECK_NEAR(bake_layer_stored(0), 1 / 255.0, 0);
		CHECK_NEAR(bake_layer_stored(1), 254 / 255.0, 0);
		for (int i = 0; i < 20000; i++) {
			const double d = i == 0 ? 0 : i == 1 ? 1 : uniform(&r);
			const double want = bake_layer_stored(d);
			const uint32_t c = bake_layer_code(d, formats[f]);
			const double off = fabs(
			    (double)bake_layer_value(c, formats[f]) - want);

			for (int k = -1; k <= 1; k += 2)
				CHECK(off <=
				      fabs((double)bake_layer_value(
					       c + (uint32_t)k, formats[f]) -
					   want) +
					  /* values are floats themselves */
					  (f < 2 ? 0x1p-24 : 0));
			/* d' = (1 + 253 d) / 255 and back, by 1/253 */
			CHECK_NEAR(bake_layer_depth(want), d, 1e-15);
		}
	}
	CHECK(bake_layer_code(0, BAKE_DATA_UINT8) == 1);
	CHECK(bake_layer_code(1, BAKE_DATA_UINT8) == 254);
	CHECK(bake_layer_code(0, BAKE_DATA_UINT16) == 257);
	CHECK(bake_layer_code(1, BAKE_DATA_UINT16) == 65278);
	CHECK(bake_layer_code(-3, BAKE_DATA_UINT16) == 257);
	CHECK(bake_layer_code(7, BAKE_DATA_UINT16) == 65278);
	CHECK(bake_layer_code((double)NAN, BAKE_DATA_UINT8) == 1);
}

/* The shader's window, and 1 = no layer, in every format. */
static void
codes_stay_within_the_shaders_window(void)
{
	for (int f = 0; f < 4; f++) {
		const enum bake_data_format t = formats[f];

		CHECK(bake_layer_value(bake_layer_code(0, t), t) > 0.003f);
		CHECK(bake_layer_value(bake_layer_code(1, t), t) < 0.997f);
		for (uint32_t c = bake_layer_code(0, t), k = 0; k < 1000;
		     k++, c++)
			CHECK(bake_layer_value(c, t) <
				  bake_layer_value(c + 1, t) ||
			      f == 0);
	}
}

/* Middles between neighbouring halfs are exact in double: ties to even. */
static void
half_codes_round_once(void)
{
	const uint32_t lo = bake_layer_code(0, BAKE_DATA_HALF);
	const uint32_t hi = bake_layer_code(1, BAKE_DATA_HALF);

	for (uint32_t c = lo + 1; c + 1 < hi; c++) {
		const double a = (double)bake_layer_value(c, BAKE_DATA_HALF);
		const double b =
		    (double)bake_layer_value(c + 1, BAKE_DATA_HALF);
		/* nearer to the tie than half a float */
		const double tie = bake_layer_depth((a + b) / 2);

		CHECK(bake_layer_code(
			  tie * (1 + 1e-12) + 1e-14, BAKE_DATA_HALF) == c + 1);
		CHECK(bake_layer_code(
			  tie * (1 - 1e-12) - 1e-14, BAKE_DATA_HALF) == c);
	}
}

/* -- single cases ---------------------------------------------------------- */

/* Depth of a place on the scale of 8-bit codes. */
static double
at(double code)
{
	return (code - 1) / 253;
}

static int
quantize8(const double *codes, int n, int nlayers, enum bake_cap_policy policy,
    struct bake_layer *l, struct bake_layer_stats *s)
{
	const struct bake_layer_params p = { BAKE_DATA_UINT8, nlayers, policy };
	struct bake_crossing c[MOST];
	double d[MOST];

	for (int i = 0; i < n; i++)
		d[i] = at(codes[i]);
	stack_of(c, d, n);
	*s = (struct bake_layer_stats)BAKE_LAYER_STATS_INIT;
	return bake_layer_quantize(c, n, &p, l, s);
}

static void
thin_slabs_are_widened_towards_the_larger_residual(void)
{
	static const struct {
		double code[6];
		int n;
		uint32_t want[6];
		int nwant;
		size_t widened, merged;
	} t[] = {
		{ { 10.1, 10.3 }, 2, { 10, 11 }, 2, 1, 0 },
		{ { 9.7, 9.9 }, 2, { 9, 10 }, 2, 1, 0 },
		{ { 9.6, 10.2 }, 2, { 9, 10 }, 2, 1, 0 },
		{ { 9.8, 10.4 }, 2, { 10, 11 }, 2, 1, 0 },
		/* the ends of the range */
		{ { 1, 1.2 }, 2, { 1, 2 }, 2, 1, 0 },
		{ { 253.8, 254 }, 2, { 253, 254 }, 2, 1, 0 },
		{ { 254, 254 }, 2, { 253, 254 }, 2, 1, 0 },
		/* the neighbour has that code: the other end */
		{ { 10.1, 10.3, 11.2, 13 }, 4, { 9, 10, 11, 13 }, 4, 1, 0 },
		{ { 5, 8.9, 9.7, 9.9 }, 4, { 5, 9, 10, 11 }, 4, 1, 0 },
		/* neither is free: joined on the better side */
		{ { 5, 9, 10.1, 10.3, 11, 13 }, 6, { 5, 9, 10, 13 }, 4, 0, 1 },
		{ { 5, 9, 9.7, 9.9, 11, 13 }, 6, { 5, 10, 11, 13 }, 4, 0, 1 },
		{ { 1, 1.2, 2, 5 }, 4, { 1, 5 }, 2, 0, 1 },
		{ { 250, 253, 253.8, 254 }, 4, { 250, 254 }, 2, 0, 1 },
		/* no code between */
		{ { 5, 8.6, 9.4, 12 }, 4, { 5, 12 }, 2, 0, 1 },
		{ { 5, 8.6, 9.2, 9.4 }, 4, { 5, 9 }, 2, 0, 1 },
		{ { 9.1, 9.2, 9.3, 9.4 }, 4, { 9, 10 }, 2, 1, 1 },
	};

	for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
		struct bake_layer l[MOST];
		struct bake_layer_stats s;
		const int m =
		    quantize8(t[i].code, t[i].n, 0, BAKE_CAP_SMALLEST, l, &s);

		CHECK(m == t[i].nwant);
		for (int k = 0; k < m && k < t[i].nwant; k++) {
			if (l[k].code != t[i].want[k])
				printf("case %zu, layer %d: %u\n", i, k,
				    l[k].code);
			CHECK(l[k].code == t[i].want[k]);
		}
		CHECK(s.widened == t[i].widened && s.merged == t[i].merged);
	}
}

static void
what_is_outside_is_cut_or_clamped(void)
{
	/* wholly before; across the near end; across both; after; and one
	 * that only touches */
	const double d[] = { -0.5, -0.1, -0.05, 0.2, 0.9, 1.5, 1.6, 2 };
	const double touching[] = { -0.5, 0, 1, 1 };
	const struct bake_layer_params p = { .format = BAKE_DATA_UINT16 };
	struct bake_crossing c[8];
	struct bake_layer l[8];
	struct bake_layer_stats s = BAKE_LAYER_STATS_INIT;
	double copy[8];

	memcpy(copy, d, sizeof d);
	stack_of(c, copy, 8);
	CHECK(bake_layer_quantize(c, 8, &p, l, &s) == 4);
	CHECK(s.cut == 2 && s.clamped == 2 && s.merged == 0 && s.widened == 0);
	CHECK(l[0].code == 257 && l[3].code == 65278);
	CHECK(l[0].depth == 0 && l[3].depth == 1);
	CHECK(l[0].crossing == 2 && l[3].crossing == 5);
	/* the codes' spacing is 1/65021, and both ends are codes */
	CHECK(s.max_error <= 0.5 / 65021 + 1e-7);
	memcpy(copy, touching, sizeof touching);
	stack_of(c, copy, 4);
	s = (struct bake_layer_stats)BAKE_LAYER_STATS_INIT;
	CHECK(bake_layer_quantize(c, 4, &p, l, &s) == 4);
	CHECK(s.cut == 0 && s.clamped == 1 && s.widened == 2);
	CHECK(l[0].code == 257 && l[1].code == 258);
	CHECK(l[2].code == 65277 && l[3].code == 65278);
	CHECK(bake_layer_quantize(c, 0, &p, l, &s) == 0);
	CHECK(bake_layer_quantize(c, 3, &p, l, &s) == 2);
}

static void
stats_are_summed(void)
{
	struct bake_layer_stats a = { 1, 2, 3, 4, 5, 6, 0.25 };
	const struct bake_layer_stats b = { 10, 20, 30, 40, 50, 60, 0.125 };

	bake_layer_stats_add(&a, &b);
	CHECK(a.capped == 11 && a.removed == 22 && a.merged == 33 &&
	      a.widened == 44 && a.clamped == 55 && a.cut == 66);
	CHECK(a.max_error == 0.25);
	a.max_error = 0;
	bake_layer_stats_add(&a, &b);
	CHECK(a.max_error == 0.125);
}

/* -- the cap --------------------------------------------------------------- */

static void
the_smallest_interval_goes_first(void)
{
	/* a thin slab, then a thin gap */
	static const double slab[] = { 10, 30, 60, 61, 80, 100, 130, 160 };
	static const double gap[] = { 10, 30, 32, 60, 80, 100, 130, 160 };
	static const double first[] = { 10, 12, 60, 90, 130, 160 };
	struct bake_layer l[MOST];
	struct bake_layer_stats s;

	CHECK(quantize8(slab, 8, 6, BAKE_CAP_SMALLEST, l, &s) == 6);
	CHECK(l[1].code == 30 && l[2].code == 80);
	CHECK(s.capped == 1 && s.removed == 2);
	CHECK(quantize8(gap, 8, 6, BAKE_CAP_SMALLEST, l, &s) == 6);
	CHECK(l[0].code == 10 && l[1].code == 60 && l[2].code == 80);
	CHECK(quantize8(first, 6, 4, BAKE_CAP_SMALLEST, l, &s) == 4);
	CHECK(l[0].code == 60 && l[3].code == 160);
	CHECK(quantize8(slab, 8, 4, BAKE_CAP_NEAREST, l, &s) == 4);
	CHECK(l[0].code == 10 && l[3].code == 61 && s.removed == 4);
	CHECK(quantize8(slab, 8, 8, BAKE_CAP_SMALLEST, l, &s) == 8);
	CHECK(s.capped == 0 && s.removed == 0);
}

/* Share of 0 .. 1 where two stacks of depths are not both in, or both out. */
static double
occupancy_error(const double *a, int n, const double *b, int m)
{
	double sum = 0, last = 0;
	int i = 0, k = 0;

	while (i < n || k < m) {
		const double next =
		    k >= m || (i < n && a[i] < b[k]) ? a[i] : b[k];

		if (i % 2 != k % 2)
			sum += next - last;
		last = next;
		if (i < n && a[i] == next)
			i++;
		else
			k++;
	}
	return sum;
}

/*
 * The least error that any stack of up to four layers has, by dynamic
 * programming: error[k] is the least up to here with k layers begun. Layers
 * elsewhere than at the given depths are never better.
 */
static double
best_error(const double *d, int n)
{
	double error[5] = { 0, 9, 9, 9, 9 }, best;

	for (int i = 0; i + 1 < n; i++) {
		for (int k = 4; k > 0; k--)
			error[k] = fmin(error[k], error[k - 1]);
		for (int k = 0; k <= 4; k++)
			if (k % 2 != (i + 1) % 2)
				error[k] += d[i + 1] - d[i];
	}
	/* a slab that is open is closed by the last */
	best = error[0];
	for (int k = 1; k <= 4; k++)
		best = fmin(best, error[k]);
	return best;
}

static double
capped_error(const double *d, int n, int nlayers, enum bake_cap_policy policy)
{
	const struct bake_layer_params p = { BAKE_DATA_FLOAT, nlayers, policy };
	struct bake_layer_stats s = BAKE_LAYER_STATS_INIT;
	struct bake_crossing c[MOST];
	struct bake_layer l[MOST];
	double left[MOST];
	int m;

	for (int i = 0; i < n; i++)
		c[i] = (struct bake_crossing){ .depth = d[i] };
	m = bake_layer_quantize(c, n, &p, l, &s);
	CHECK(m == (n < nlayers ? n : nlayers));
	for (int i = 0; i < m; i++)
		left[i] = l[i].depth;
	return occupancy_error(d, n, left, m);
}

/*
 * Against the best of all: with one pair too many it is exactly that, since
 * each pair's error is its interval. With more, removing greedily may lose a
 * little. Keeping the nearest loses several times as much.
 */
static void
the_smallest_interval_is_near_the_best(void)
{
	enum { STACKS = 3000 };
	struct rng r = { 3 };

	for (int n = 6; n <= 30; n += n < 10 ? 2 : 10) {
		double smallest = 0, nearest = 0, best = 0;

		for (int i = 0; i < STACKS; i++) {
			double d[MOST], s, b;

			for (int k = 0; k < n; k++)
				d[k] = uniform(&r);
			qsort(d, (size_t)n, sizeof *d, cmp_double);
			s = capped_error(d, n, 4, BAKE_CAP_SMALLEST);
			b = best_error(d, n);
			if (n == 6)
				CHECK_NEAR(s, b, 1e-12);
			CHECK(s >= b - 1e-12);
			smallest += s / STACKS;
			best += b / STACKS;
			nearest +=
			    capped_error(d, n, 4, BAKE_CAP_NEAREST) / STACKS;
		}
		printf("4 of %d layers: mean occupancy error %.4f, best %.4f, "
		       "nearest %.4f\n",
		    n, smallest, best, nearest);
		CHECK(smallest <= 1.05 * best);
		CHECK(n > 10 || smallest < nearest / 2);
	}
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(codes_are_the_nearest),
		CASE(codes_stay_within_the_shaders_window),
		CASE(half_codes_round_once),
		CASE(thin_slabs_are_widened_towards_the_larger_residual),
		CASE(what_is_outside_is_cut_or_clamped),
		CASE(stats_are_summed),
		CASE(random_stacks_lose_nothing),
		CASE(the_smallest_interval_goes_first),
		CASE(the_smallest_interval_is_near_the_best),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
