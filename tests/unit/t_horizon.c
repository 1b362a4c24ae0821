/* Horizons: rays, and the fast march against the plain one, bit for bit. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "horizon_priv.h"

#include <limits.h>

static unsigned
next_random(unsigned *state)
{
	/* a hash of a counter: a linear congruence repeats along columns */
	unsigned z = *state += 0x9e3779b9u;

	z = (z ^ z >> 16) * 0x85ebca6bu;
	z = (z ^ z >> 13) * 0xc2b2ae35u;
	return (z ^ z >> 16) >> 8;
}

enum kind { NOISE, CODES, SPIKES, WAVES, HOSTILE, NKINDS };

/* White noise; noise of few codes, where many heights are equal; lone spikes;
 * smooth hills; finite values of any size. */
static struct bake_image
make_map(enum kind kind, int width, int height)
{
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	unsigned seed = 11;

	CHECK_OK(bake_image_alloc(&img, width, height, 1, &err), err);
	for (int i = 0; i < width * height; i++) {
		unsigned r = next_random(&seed);
		float u = (float)r / 16777216.0f;
		float v[NKINDS];

		v[NOISE] = u;
		v[CODES] = (float)(r % 4) / 3.0f;
		v[SPIKES] = r % 300 == 0 ? 0 : 1;
		v[WAVES] = (float)(0.5 + 0.3 * sin(0.11 * (i % width)) +
				   0.2 * cos(0.07 * (i / width)) + 0.001 * u);
		v[HOSTILE] = ldexpf(u - 0.5f, (int)(r % 240) - 120);
		img.data[i] = v[kind];
	}
	return img;
}

struct setup {
	struct bake_wrap wrap;
	double radius;
	int periods, ndirs;
	enum bake_horizon_quality quality; /* exact */
};

/* The height at a texel of the map as it goes on beyond its border. */
static float
height_at(const struct bake_horizon *hz, long x, long y)
{
	const struct bake_image *h = &hz->heights;

	return bake_image_row(
	    h, bake_wrap_index(y, h->height, hz->wrap.clamp_v))[bake_wrap_index(
	    x, h->width, hz->wrap.clamp_u)];
}

/* P_i of ao.h at block u of the major axis, or from i = 4 on at four blocks,
 * and texel v of the minor, as it is written there. */
static float
run_maximum(const struct bake_horizon *hz, int i, long u, long v)
{
	const struct bake_horizon_dir *dir = &hz->ray[0].dir;
	const int width = hz->heights.width, height = hz->heights.height;
	const int length = dir->x_major ? width : height;
	const bool clamp_u = hz->wrap.clamp_u, clamp_v = hz->wrap.clamp_v;
	const bool clamp = dir->x_major ? clamp_u : clamp_v;
	const int size = i < 4 ? 4 : 16;
	const long block =
	    bake_wrap_index(u, (length + size - 1) / size, clamp);
	const long at = bake_wrap_index(
	    v, dir->x_major ? height : width, dir->x_major ? clamp_v : clamp_u);
	float high = -INFINITY;

	if (i > 0) {
		const long run = 1L << (i - 1);
		/* the first of four that the ray meets, where they merge */
		const long begin =
		    i != 4 ? block : 4 * block + (dir->major > 0 ? 0 : 3);
		const long blocks = i <= 4 ? run : run / 4;

		return fmaxf(run_maximum(hz, i - 1, begin, at),
		    run_maximum(hz, i - 1, begin + blocks * dir->major,
			at + (long)floor(4 * (double)run * dir->minor + 0.5)));
	}
	for (int k = 0; k < 4; k++) {
		const long major = 4 * block + (dir->major > 0 ? k : 3 - k);
		double whole = floor(k * dir->minor);
		double frac = k * dir->minor - whole;
		long minor;
		float a, b;

		if (frac > 1 - BAKE_HORIZON_SNAP) {
			whole++;
			frac = 0;
		} else if (frac < BAKE_HORIZON_SNAP) {
			frac = 0;
		}
		minor = at + (long)whole;
		a = dir->x_major ? height_at(hz, major, minor)
				 : height_at(hz, minor, major);
		b = dir->x_major ? height_at(hz, major, minor + 1)
				 : height_at(hz, minor + 1, major);
		high = fmaxf(high, a + (float)frac * (b - a));
	}
	return fminf(high, hz->highest);
}

/* The march of fast and preview, as it is defined in ao.h. */
static float
march_far(const struct bake_horizon *hz, int side,
    enum bake_horizon_quality quality, int x, int y)
{
	const int near = quality == BAKE_HORIZON_FAST ? 16 : 8;
	const int per_octave = quality == BAKE_HORIZON_FAST ? 4 : 2;
	const float h = bake_image_row(&hz->heights, y)[x];
	const long nsteps = hz->ray[side].dir.nsteps;
	struct bake_horizon_dir dir = hz->ray[side].dir;
	const int u = dir.x_major ? x : y, v = dir.x_major ? y : x;
	const int met = dir.major > 0 ? u % 4 : 3 - u % 4;
	long length;
	float best;

	dir.nsteps = dir.nsteps < near ? dir.nsteps : near;
	best = bake_horizon_march(&hz->heights, hz->wrap, &dir, x, y);
	for (long k = near; k < nsteps; k += length) {
		int i = 0, block;
		double from, enter;
		float high, weight;

		for (length = 4; length < 1024 && 2 * length * per_octave <= k;
		     length *= 2)
			i++;
		from = (double)k - (length < 16      ? met
				       : length < 64 ? 1.5
						     : 7.5);
		/* the opposite ray's segment ends where the run begins */
		enter = side == 0 ? 0 : (double)length - 1;
		block = length < 64 ? 4 : 16;
		high = run_maximum(hz, i,
		    u / block + (k + (long)enter) / block * dir.major,
		    v + (long)floor((from + enter) * dir.minor + 0.5));
		weight = (float)(1 / ((from + 0.85 * (double)(length - 1)) *
					 dir.pitch));
		best = fmaxf(best, weight * (high - h));
	}
	return best;
}

/* The number of texels of a tile where it and the plain march differ. */
static int
count_in_tile(const struct bake_horizon *hz, const struct setup *s, int side,
    int x0, int y0)
{
	static float slopes[BAKE_TILE_TEXELS];
	int ndiffer = 0;

	bake_horizon_tile(hz, side, x0, y0, slopes);
	for (int i = 0; i < BAKE_TILE_TEXELS; i++) {
		int x = x0 + i % BAKE_TILE_WIDTH;
		int y = y0 + i / BAKE_TILE_WIDTH;
		float want;

		if (x >= hz->heights.width || y >= hz->heights.height)
			continue;
		want = s->quality == BAKE_HORIZON_EXACT
			   ? bake_horizon_march(&hz->heights, s->wrap,
				 &hz->ray[side].dir, x, y)
			   : march_far(hz, side, s->quality, x, y);
		ndiffer += memcmp(&want, &slopes[i], sizeof want) != 0;
	}
	return ndiffer;
}

/* The same of a map, in all directions. */
static int
count_differences(const struct bake_image *depth, const struct setup *s)
{
	const int nturns = s->ndirs % 2 == 0 ? s->ndirs / 2 : s->ndirs;
	struct bake_horizon hz;
	struct bake_err err = BAKE_ERR_INIT;
	int ndiffer = 0;

	CHECK_OK(bake_horizon_init(&hz, depth, s->wrap, s->radius, s->periods,
		     s->quality, 1, &err),
	    err);
	for (int j = 0; j < nturns; j++) {
		bake_horizon_aim(&hz, j, s->ndirs);
		CHECK(hz.nrays == s->ndirs / nturns);
		for (int side = 0; side < hz.nrays; side++)
			for (int y = 0; y < depth->height;
			     y += BAKE_TILE_HEIGHT)
				for (int x = 0; x < depth->width;
				     x += BAKE_TILE_WIDTH)
					ndiffer +=
					    count_in_tile(&hz, s, side, x, y);
	}
	bake_horizon_free(&hz);
	return ndiffer;
}

static void
fast_march_equals_plain_march(void)
{
	static const char *const isas[] = { "baseline", "avx2", "avx512" };
	static const struct setup setups[] = {
		{ { false, false }, 0, 1, 10, BAKE_HORIZON_EXACT },
		{ { true, false }, 0, 1, 7, BAKE_HORIZON_EXACT },
		{ { false, true }, 0, 1, 7, BAKE_HORIZON_EXACT },
		{ { true, true }, 0.4, 1, 8, BAKE_HORIZON_EXACT },
		{ { false, false }, 2.3, 1, 5, BAKE_HORIZON_EXACT },
		{ { false, false }, 0, 1, 10, BAKE_HORIZON_FAST },
		{ { true, false }, 0, 3, 7, BAKE_HORIZON_FAST },
		{ { false, true }, 0, 1, 7, BAKE_HORIZON_PREVIEW },
		{ { true, true }, 0.7, 1, 8, BAKE_HORIZON_PREVIEW },
		{ { false, false }, 2.3, 1, 5, BAKE_HORIZON_PREVIEW },
	};
	enum { NSETUPS = sizeof setups / sizeof *setups };

	for (int isa = 0; isa < 3; isa++) {
		setenv("BAKE_ISA", isas[isa], 1);
		for (int kind = 0; kind < NKINDS; kind++)
			for (int i = 0; i < NSETUPS; i++) {
				struct bake_image depth =
				    make_map((enum kind)kind, 90, 61);

				CHECK(
				    count_differences(&depth, &setups[i]) == 0);
				bake_image_free(&depth);
			}
	}
	unsetenv("BAKE_ISA");
}

static void
fast_march_equals_plain_march_on_odd_sizes(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 1, 70 }, { 70, 1 },
		{ 2, 2 }, { 3, 5 }, { 63, 17 }, { 64, 16 }, { 65, 33 },
		{ 129, 4 } };
	struct setup s = { { false, false }, 0, 2, 9, BAKE_HORIZON_EXACT };

	for (int i = 0; i < 9 * 4 * 3; i++) {
		const int *size = sizes[i / 12];
		struct bake_image depth = make_map(NOISE, size[0], size[1]);

		s.wrap.clamp_u = i & 1;
		s.wrap.clamp_v = i >> 1 & 1;
		s.quality = (enum bake_horizon_quality)(i / 4 % 3);
		CHECK(count_differences(&depth, &s) == 0);
		bake_image_free(&depth);
	}
}

/* Directions 0, 1/4, 1/2 and 3/4 of a turn: right, up, left, down. */
static void
axes_have_no_minor_step(void)
{
	static const int steps[][3] = { { true, 1 }, { false, -1 },
		{ true, -1 }, { false, 1 } };

	for (int j = 0; j < 4; j++) {
		struct bake_horizon_dir dir;

		bake_horizon_dir_init(&dir, j, 4, 100, 60, 0, 2);
		CHECK(dir.x_major == (steps[j][0] != 0));
		CHECK(dir.major == steps[j][1]);
		CHECK(dir.minor == 0 && dir.pitch == 1);
		CHECK(dir.nsteps == 2 * (dir.x_major ? 100 : 60));
	}
}

static void
samples_are_on_the_ray(void)
{
	for (int j = 0; j < 50; j++) {
		const double phi = 2 * 3.14159265358979323846 * j / 50;
		struct bake_horizon_dir dir;

		bake_horizon_dir_init(&dir, j, 50, 64, 64, 0, 1);
		for (long k = 1; k <= 64; k++) {
			struct bake_horizon_step st =
			    bake_horizon_step(&dir, k);
			double dist = 1 / ((double)st.w0 + st.w1);
			double f = st.w1 * dist;

			/* float weights: 1e-6 of 64 steps */
			CHECK_NEAR((double)st.dx + (dir.x_major ? 0 : f),
			    dist * cos(phi), 1e-4);
			CHECK_NEAR((double)st.dy + (dir.x_major ? f : 0),
			    -dist * sin(phi), 1e-4);
			CHECK(st.w0 >= 0 && st.w1 >= 0);
		}
	}
}

static void
radius_ends_the_ray(void)
{
	struct bake_horizon_dir dir;

	bake_horizon_dir_init(&dir, 0, 8, 100, 60, 0.25, 1);
	CHECK(dir.nsteps == 25);
	/* 45 degrees: 17 steps are 24.04 texels, 18 are 25.5 */
	bake_horizon_dir_init(&dir, 1, 8, 100, 60, 0.25, 1);
	CHECK(dir.nsteps == 17);
	bake_horizon_dir_init(&dir, 0, 8, 100, 60, 0.001, 1);
	CHECK(dir.nsteps == 0);
}

static void
heights_are_harmless(void)
{
	CHECK(bake_horizon_height(0.25f) == -0.25f);
	CHECK(bake_horizon_height(NAN) == 0);
	CHECK(bake_horizon_height(INFINITY) == -1e28f);
	CHECK(bake_horizon_height(-INFINITY) == 1e28f);
	CHECK(bake_horizon_height(1e-30f) == 0);
}

static void
huge_sides_are_refused(void)
{
	float texel = 0;
	struct bake_image depth = { INT_MAX, 1, 1, 1, &texel };
	struct bake_wrap wrap = { false, false };
	struct bake_horizon hz;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_horizon_init(&hz, &depth, wrap, 0, 1, BAKE_HORIZON_EXACT, 1,
		  &err) == BAKE_EINVAL);
	CHECK(err.msg[0] != 0);
	bake_horizon_free(&hz);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(fast_march_equals_plain_march),
		CASE(fast_march_equals_plain_march_on_odd_sizes),
		CASE(axes_have_no_minor_step),
		CASE(samples_are_on_the_ray),
		CASE(radius_ends_the_ray),
		CASE(heights_are_harmless),
		CASE(huge_sides_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
