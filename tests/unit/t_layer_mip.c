/* Mip levels: occupancy, threshold and cap against slow oracles. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "test_layers.h"
#include "test_maps.h"

static const enum bake_data_format formats[] = { BAKE_DATA_UINT8,
	BAKE_DATA_UINT16, BAKE_DATA_HALF, BAKE_DATA_FLOAT };
static const double up[3] = { 0, 0, 1 };

static struct bake_layer_maps
level_of(const struct bake_layer_maps *m, int level, bool half,
    struct bake_layer_mip *mip)
{
	struct bake_layer_maps out;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_layer_mip(m, level, half, NULL, 1, &out, mip, &err), err);
	return out;
}

/* -- an oracle at 8 bits ----------------------------------------------------
 */

enum { CODES = 256 };

/* How many texels of level texel (x, y)'s box are solid from code c to c + 1;
 * returns how many there are. */
static int
count_box(const struct bake_layer_maps *m, const struct bake_layer_maps *out,
    int x, int y, int count[CODES])
{
	int n = 0;

	memset(count, 0, CODES * sizeof *count);
	for (int v = y * m->height / out->height;
	     v < (y + 1) * m->height / out->height; v++)
		for (int u = x * m->width / out->width;
		     u < (x + 1) * m->width / out->width; u++) {
			n++;
			for (int i = 0; i + 1 < bake_layer_count(m, u, v);
			     i += 2)
				for (uint32_t c = code_at(m, u, v, i);
				     c < code_at(m, u, v, i + 1); c++)
					count[c]++;
		}
	return n;
}

/* The volume at a threshold, in texels times codes; level 0's below 0. */
static long
volume_at(const struct bake_layer_maps *m, const struct bake_layer_maps *out,
    double tau)
{
	long sum = 0;
	int count[CODES];

	for (int y = 0; y < out->height; y++)
		for (int x = 0; x < out->width; x++) {
			const int n = count_box(m, out, x, y, count);

			for (int c = 0; c < CODES; c++)
				sum += tau < 0              ? count[c]
				       : count[c] > tau * n ? n
							    : 0;
		}
	return sum;
}

/* By trial of every share that there is (of boxes up to 200 texels, steps of
 * shares are farther apart than 2^-16): of the last volume >= v0 and the next,
 * the nearer by ratio. */
static double
best_tau(const struct bake_layer_maps *m, const struct bake_layer_maps *out)
{
	const double v0 = (double)volume_at(m, out, -1);
	double above = 0, v_above = (double)volume_at(m, out, 0);
	double last = v_above;

	if (v0 == 0)
		return 0.5;
	for (int k = 1; k <= 65536; k++) {
		const double tau = k / 65536.0;
		bool step = false;
		double v;

		/* only where some box's share is stepped over */
		for (int w = 1; w <= 200 && !step; w++)
			step = floor(tau * w) != floor((k - 1) / 65536.0 * w);
		if (!step)
			continue;
		v = (double)volume_at(m, out, tau);
		if (v == last)
			continue;
		last = v;
		if (v < v0)
			return v > 0 && v_above / v0 > v0 / v ? tau : above;
		above = tau;
		v_above = v;
	}
	return above;
}

/* The layers at tau. */
static int
oracle_layers(const int count[CODES], int n, double tau, uint32_t *code)
{
	int m = 0;

	for (int c = 0; c < CODES; c++) {
		const bool solid = count[c] > tau * n;

		if (solid != (m % 2 != 0))
			code[m++] = (uint32_t)c;
	}
	return m;
}

/* Pairs nearest in code removed; the first of equal ones. */
static int
oracle_cap(uint32_t *code, int n, int most)
{
	while (n > most) {
		int least = 0;

		for (int i = 1; i + 1 < n; i++)
			if (code[i + 1] - code[i] <
			    code[least + 1] - code[least])
				least = i;
		for (int i = least; i + 2 < n; i++)
			code[i] = code[i + 2];
		n -= 2;
	}
	return n;
}

/* Random slabs; sparse ones leave most depths empty. */
static struct bake_layer_maps
random_maps(int w, int h, int nlayers, uint32_t seed)
{
	struct bake_layer_maps m =
	    layer_maps(w, h, nlayers, BAKE_DATA_UINT8, 0, 3, BAKE_DATA_UINT8);

	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			uint32_t r = hash(seed * 7919 + (uint32_t)(y * w + x));
			const int n =
			    2 * (int)(r % (uint32_t)(nlayers / 2 + 1));
			int code = 1 + (int)(r >> 8) % 60;

			for (int i = 0; i < n; i++) {
				set_layer(&m, x, y, i, code / 255.0, up);
				r = hash(r + (uint32_t)i);
				code += 1 + (int)(r % (190u / (uint32_t)n));
			}
		}
	return m;
}

static void
check_level(const struct bake_layer_maps *m, int level, bool half)
{
	const double whole = 255.0 * m->width * m->height;
	struct bake_layer_mip mip;
	struct bake_layer_maps out = level_of(m, level, half, &mip);
	const double tau = half ? 0.5 : best_tau(m, &out);
	size_t ncapped = 0;
	double volume = 0;

	if (mip.tau != tau)
		printf("%dx%d level %d: tau %g, expected %g\n", m->width,
		    m->height, level, mip.tau, tau);
	CHECK(mip.tau == tau);
	for (int y = 0; y < out.height; y++)
		for (int x = 0; x < out.width; x++) {
			int count[CODES];
			uint32_t code[CODES];
			const int box = count_box(m, &out, x, y, count);
			int n = oracle_layers(count, box, mip.tau, code);

			ncapped += n > m->nlayers;
			/* no skin: where no texel is solid, it is not */
			for (int i = 0; i < n && n <= m->nlayers; i += 2)
				for (uint32_t c = code[i]; c < code[i + 1]; c++)
					CHECK(count[c] > 0);
			n = oracle_cap(code, n, m->nlayers);
			CHECK(bake_layer_count(&out, x, y) == n);
			for (int i = 0; i < n; i++) {
				CHECK(code_at(&out, x, y, i) == code[i]);
				volume += (i % 2 ? 1.0 : -1.0) * code[i] * box;
			}
		}
	CHECK(mip.capped == ncapped);
	/* whole numbers, divided once */
	CHECK_NEAR(mip.volume, volume / whole, 1e-15);
	CHECK_NEAR(mip.volume0, (double)volume_at(m, &out, -1) / whole, 1e-15);
	bake_layer_maps_free(&out);
}

static void
levels_are_those_of_the_oracle(void)
{
	static const int sizes[][3] = { { 8, 8, 3 }, { 7, 5, 2 }, { 1, 9, 3 },
		{ 13, 1, 3 }, { 6, 11, 3 }, { 2, 2, 1 }, { 5, 16, 4 } };

	for (uint32_t k = 0; k < 7; k++)
		for (int level = 1; level <= sizes[k][2]; level++)
			for (int nlayers = 2; nlayers <= 6; nlayers += 2) {
				struct bake_layer_maps m = random_maps(
				    sizes[k][0], sizes[k][1], nlayers, k);

				check_level(&m, level, true);
				check_level(&m, level, false);
				bake_layer_maps_free(&m);
			}
}

/* -- shapes ---------------------------------------------------------------- */

static void
sizes_are_halved_down_to_one(void)
{
	struct bake_layer_maps m = random_maps(11, 3, 4, 1);

	for (int level = 1; level <= 3; level++) {
		struct bake_layer_maps out = level_of(&m, level, false, NULL);

		CHECK(out.width == 11 >> level && out.height == 1);
		CHECK(out.nlayers == 4 && out.ntextures == 1);
		bake_layer_maps_free(&out);
	}
	bake_layer_maps_free(&m);
}

/* What is the same in every texel is the same in every level. */
static void
a_plate_stays_as_it_is(void)
{
	const double n[4][3] = { { 0.6, 0, 0.8 }, { 0, -0.6, -0.8 },
		{ 0.48, 0.6, 0.64 }, { 0, 0, -1 } };

	for (int f = 0; f < 4; f++) {
		struct bake_layer_maps m =
		    layer_maps(12, 10, 4, formats[f], 0, 3, formats[f]);

		for (int y = 0; y < 10; y++)
			for (int x = 0; x < 12; x++)
				for (int i = 0; i < 4; i++)
					set_layer(
					    &m, x, y, i, 0.1 + 0.2 * i, n[i]);
		for (int level = 1; level <= 3; level++) {
			struct bake_layer_mip mip;
			struct bake_layer_maps out =
			    level_of(&m, level, false, &mip);

			CHECK(mip.volume == mip.volume0 && mip.capped == 0);
			for (int i = 0; i < 4; i++) {
				double got[3];

				CHECK(code_at(&out, 0, 0, i) ==
				      code_at(&m, 0, 0, i));
				normal_at(&out, 0, 0, i, got);
				/* one rounding at level 0, one here: two
				 * half codes of 2/255, 2/2047 for half */
				for (int c = 0; c < 2; c++)
					CHECK_NEAR(got[c], n[i][c],
					    f == 0   ? 2.0 / 255
					    : f == 2 ? 2.0 / 2047
						     : 1e-4);
			}
			bake_layer_maps_free(&out);
		}
		bake_layer_maps_free(&m);
	}
}

/* Strands one texel wide, every 8 texels: all there at every level, where 1/2
 * has lost them. */
static void
strands_survive(void)
{
	enum { SIDE = 32 };
	struct bake_layer_maps m =
	    layer_maps(SIDE, SIDE, 4, BAKE_DATA_UINT16, 0, 3, BAKE_DATA_UINT8);

	for (int y = 0; y < SIDE; y++)
		for (int x = 3; x < SIDE; x += 8) {
			set_layer(&m, x, y, 0, 0.3, up);
			set_layer(&m, x, y, 1, 0.4, up);
		}
	for (int level = 1; level <= 5; level++) {
		struct bake_layer_mip mip;
		struct bake_layer_maps out = level_of(&m, level, false, &mip);
		int n = 0;

		for (int y = 0; y < out.height; y++)
			for (int x = 0; x < out.width; x++)
				n += bake_layer_count(&out, x, y) == 2;
		CHECK(n == (out.width < 4 ? out.width : 4) * out.height);
		CHECK(mip.tau == 0);
		bake_layer_maps_free(&out);
		out = level_of(&m, level, true, &mip);
		CHECK(mip.volume == 0 && mip.tau == 0.5);
		bake_layer_maps_free(&out);
	}
	bake_layer_maps_free(&m);
}

/* Bent round strands, 3.2 texels wide: the level's texels lie on them in all
 * ways, so that volumes come in small steps, but for level 1, where a box has
 * just four texels. */
static void
the_volume_of_bent_strands_is_kept(void)
{
	enum { SIDE = 128 };
	struct bake_layer_maps m =
	    layer_maps(SIDE, SIDE, 4, BAKE_DATA_UINT16, 0, 3, BAKE_DATA_UINT8);

	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++) {
			const double at = hypot(x + 40.3, y + 31.7);
			const double off = at - 16 * floor(at / 16) - 8;
			const double zz = 1.6 * 1.6 - off * off;

			for (int i = 0; i < 2 && zz > 0; i++)
				set_layer(&m, x, y, i,
				    bake_layer_stored(
					0.2 + 0.004 * y +
					(i ? 0.05 : -0.05) * sqrt(zz)),
				    up);
		}
	for (int level = 1; level <= 5; level++) {
		struct bake_layer_mip mip, half;
		struct bake_layer_maps out = level_of(&m, level, false, &mip);
		struct bake_layer_maps eaten = level_of(&m, level, true, &half);

		printf("strands, level %d: tau %.3f, %.3f of the volume; 1/2, "
		       "%.3f\n",
		    level, mip.tau, mip.volume / mip.volume0,
		    half.volume / mip.volume0);
		CHECK_NEAR(
		    mip.volume / mip.volume0, 1, level == 1 ? 0.3 : 0.06);
		CHECK(level < 3 || half.volume < 0.1 * half.volume0);
		bake_layer_maps_free(&out);
		bake_layer_maps_free(&eaten);
	}
	bake_layer_maps_free(&m);
}

/* -- very many layers ------------------------------------------------------ */

static int
cmp_float(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

/* Thin slabs at random depths, one for each texel of one box: thousands of
 * layers before the cap, which the oracle takes off one by one. */
static void
thousands_of_layers_are_capped_as_few_are(void)
{
	enum { SIDE = 48, N = SIDE * SIDE };
	static float d[2 * N];
	struct bake_layer_maps m =
	    layer_maps(SIDE, SIDE, 4, BAKE_DATA_FLOAT, 0, 3, BAKE_DATA_UINT8);
	struct bake_layer_maps out = BAKE_LAYER_MAPS_INIT;
	struct bake_layer_mip mip;
	struct bake_err err = BAKE_ERR_INIT;
	int n = 2 * N;

	/* in cells of their own, so that none overlaps another */
	for (int i = 0; i < N; i++) {
		const double r = hash((uint32_t)i) * 0x1p-32;
		const double s = hash((uint32_t)(i + N)) * 0x1p-32;
		const double at = 0.01 + 0.98 * (i * 7 % N + 0.4 * r) / N;

		set_layer(&m, i % SIDE, i / SIDE, 0, at, up);
		set_layer(&m, i % SIDE, i / SIDE, 1, at + 0.5 * s / N, up);
		for (int k = 0; k < 2; k++)
			d[2 * i + k] =
			    value_at(&m.depth[0], i % SIDE, i / SIDE, k);
	}
	/* the nearest ratio: all of it, or nothing */
	CHECK_OK(bake_layer_mip(&m, 5, false, NULL, 1, &out, &mip, &err), err);
	CHECK(out.width == 1 && out.height == 1 && mip.tau == 0);
	CHECK(mip.capped == 1);
	qsort(d, (size_t)n, sizeof *d, cmp_float);
	while (n > 4) {
		int least = 0;

		for (int i = 1; i + 1 < n; i++)
			if ((double)d[i + 1] - (double)d[i] <
			    (double)d[least + 1] - (double)d[least])
				least = i;
		memmove(&d[least], &d[least + 2],
		    (size_t)(n - least - 2) * sizeof *d);
		n -= 2;
	}
	CHECK(bake_layer_count(&out, 0, 0) == 4);
	for (int i = 0; i < 4; i++)
		CHECK(value_at(&out.depth[0], 0, 0, i) == d[i]);
	bake_layer_maps_free(&out);
	bake_layer_maps_free(&m);
}

/* -- the rest -------------------------------------------------------------- */

static void
many_threads_give_the_same_bytes(void)
{
	struct bake_layer_maps m =
	    layer_maps(67, 129, 4, BAKE_DATA_HALF, 1, 4, BAKE_DATA_UINT8);
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_color *color;

	CHECK_OK(bake_color_open(NULL, &color, &err), err);
	draw_ball(&m, 33, 60, 31, 80);
	for (int i = 0; i < 67 * 129; i++)
		for (int c = 0; c < 4; c++)
			set_value(&m.color[0], i % 67, i / 67, c,
			    (float)(hash((uint32_t)(4 * i + c)) % 256) / 255);
	for (int level = 1; level <= 7; level++) {
		struct bake_layer_maps one, many;
		struct bake_layer_mip a, b;

		CHECK_OK(
		    bake_layer_mip(&m, level, false, color, 1, &one, &a, &err),
		    err);
		CHECK_OK(
		    bake_layer_mip(&m, level, false, color, 5, &many, &b, &err),
		    err);
		CHECK(same_maps(&one, &many));
		CHECK(memcmp(&a, &b, sizeof a) == 0);
		bake_layer_maps_free(&one);
		bake_layer_maps_free(&many);
	}
	bake_color_close(color);
	bake_layer_maps_free(&m);
}

static void
bad_levels_are_errors(void)
{
	static const struct {
		int w, h, level;
		bool ok;
	} t[] = { { 4, 4, 0, false }, { 4, 4, -1, false }, { 4, 4, 2, true },
		{ 4, 4, 3, false }, { 1, 1, 1, false }, { 1, 8, 3, true },
		{ 9, 1, 3, true }, { 9, 1, 4, false }, { 4, 4, 100, false } };

	for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
		struct bake_layer_maps m = layer_maps(
		    t[i].w, t[i].h, 2, BAKE_DATA_UINT8, 0, 3, BAKE_DATA_UINT8);
		struct bake_layer_maps out = BAKE_LAYER_MAPS_INIT;
		struct bake_err err = BAKE_ERR_INIT;

		CHECK(bake_layer_mip(&m, t[i].level, false, NULL, 1, &out, NULL,
			  &err) == (t[i].ok ? BAKE_OK : BAKE_EINVAL));
		CHECK((err.msg[0] == '\0') == t[i].ok);
		CHECK((out.width > 0) == t[i].ok);
		bake_layer_maps_free(&out);
		bake_layer_maps_free(&m);
	}
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(levels_are_those_of_the_oracle),
		CASE(sizes_are_halved_down_to_one),
		CASE(a_plate_stays_as_it_is),
		CASE(strands_survive),
		CASE(the_volume_of_bent_strands_is_kept),
		CASE(thousands_of_layers_are_capped_as_few_are),
		CASE(many_threads_give_the_same_bytes),
		CASE(bad_levels_are_errors),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
