/* Statistics of two fields over blocks: value, jackknife, random shifts. */
/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "detect_priv.h"

enum { NBLOCKS = DETECT_GRID * DETECT_GRID, NSHIFTS = 40 };

double
bake_detect_value(struct detect_sums s, enum detect_kind kind)
{
	double scale =
	    kind == DETECT_CORR ? sqrt(s.aa) * sqrt(s.bb) : 0.5 * (s.aa + s.bb);

	return scale > 0 ? s.ab / scale : 0;
}

static struct detect_sums
sums_add(struct detect_sums a, struct detect_sums b, double sign)
{
	a.aa += sign * b.aa;
	a.ab += sign * b.ab;
	a.bb += sign * b.bb;
	return a;
}

/* Sums over rows y0 .. y1 - 1 and columns x0 .. x1 - 1. */
static struct detect_sums
block_sums(const struct detect_fields *fields, int i, int j, const int rect[4])
{
	struct detect_sums s = { 0, 0, 0 };

	for (int y = rect[1]; y < rect[3]; y++) {
		size_t row = (size_t)y * (size_t)fields->width;
		const float *a = fields->f[i] + row, *b = fields->f[j] + row;

		for (int x = rect[0]; x < rect[2]; x++) {
			double u = (double)a[x], v = (double)b[x];

			s.aa += u * u;
			s.ab += u * v;
			s.bb += v * v;
		}
	}
	return s;
}

/* Blocks along an axis of n texels, none below 3 texels. */
static int
grid(int n)
{
	return n / 3 < DETECT_GRID ? n / 3 : DETECT_GRID;
}

static int
all_blocks(struct detect_sums block[NBLOCKS],
    const struct detect_fields *fields, int i, int j)
{
	int nx = grid(fields->width), ny = grid(fields->height);

	for (int y = 0; y < ny; y++) {
		for (int x = 0; x < nx; x++) {
			const int rect[4] = { (int)((long)fields->width * x /
						    nx),
				(int)((long)fields->height * y / ny),
				(int)((long)fields->width * (x + 1) / nx),
				(int)((long)fields->height * (y + 1) / ny) };

			block[y * nx + x] = block_sums(fields, i, j, rect);
		}
	}
	return nx * ny;
}

/*
 * Delete-one jackknife (Efron and Tibshirani 1993, ch. 11): standard error^2
 * = (n-1)/n sum (T_-b - mean T_-b)^2, T_-b the value without block b.
 */
static double
jackknife(const struct detect_sums *block, int n, struct detect_sums all,
    enum detect_kind kind)
{
	double t[NBLOCKS], mean = 0, sum = 0;

	for (int b = 0; b < n; b++) {
		t[b] = bake_detect_value(sums_add(all, block[b], -1), kind);
		mean += t[b] / n;
	}
	for (int b = 0; b < n; b++)
		sum += (t[b] - mean) * (t[b] - mean);
	return sqrt(sum * (n - 1) / n);
}

struct detect_sums
bake_detect_measure(struct bake_evidence *ev,
    const struct detect_fields *fields, int i, int j, enum detect_kind kind)
{
	struct detect_sums block[NBLOCKS], all = { 0, 0, 0 };
	int n = all_blocks(block, fields, i, j);
	double same = 0, weight = 0, error;

	*ev = (struct bake_evidence){ .chance = 1, .blocks = n };
	for (int b = 0; b < n; b++)
		all = sums_add(all, block[b], 1);
	ev->value = bake_detect_value(all, kind);
	/* an empty field has rounding and nothing else to correlate */
	if (n < 9 || ev->value == 0)
		return all;
	for (int b = 0; b < n; b++) {
		double w = kind == DETECT_CORR
			       ? sqrt(block[b].aa) * sqrt(block[b].bb)
			       : block[b].aa + block[b].bb;

		weight += w;
		if (block[b].ab * ev->value > 0)
			same += w;
	}
	ev->share = weight > 0 ? same / weight : 0;
	error = jackknife(block, n, all, kind);
	/* perfect agreement has no spread: 1e-6 is far below any threshold */
	ev->sigmas = ev->value / fmax(error, 1e-6);
	return all;
}

/* The next number of a 32-bit sequence (Numerical Recipes 3, 7.1). */
static unsigned
next_random(unsigned *state)
{
	*state = *state * 1664525u + 1013904223u;
	return *state >> 8;
}

/* A shift along an axis of n texels, at least an eighth of it either way. */
static int
random_shift(unsigned *state, int n)
{
	int least = n / 8 > 1 ? n / 8 : 1, span = n - 2 * least + 1;

	return span < 1 ? n / 2
			: least + (int)(next_random(state) % (unsigned)span);
}

/* Sum of a(x, y) b(x + dx, y + dy) on the torus, over every step-th row. */
static double
shifted(const struct detect_fields *fields, int i, int j, const int shift[2],
    int step)
{
	int w = fields->width, h = fields->height, dx = shift[0];
	double sum = 0;

	for (int y = 0; y < h; y += step) {
		const float *a = fields->f[i] + (size_t)y * (size_t)w;
		const float *b =
		    fields->f[j] + (size_t)((y + shift[1]) % h) * (size_t)w;

		for (int x = 0; x < w - dx; x++)
			sum += (double)a[x] * (double)b[x + dx];
		for (int x = w - dx; x < w; x++)
			sum += (double)a[x] * (double)b[x + dx - w];
	}
	return sum;
}

void
bake_detect_chance(
    struct bake_evidence *ev, const struct detect_fields *fields, int i, int j)
{
	int w = fields->width, h = fields->height, nlarger = 0;
	int step = (int)((double)w * (double)h / (1 << 16));
	unsigned state = 1;
	double here;

	/* sums of squares do not change with the shift: compare products */
	if (w < 2 || h < 2)
		return;
	step = step < 1 ? 1 : step;
	here = fabs(shifted(fields, i, j, (const int[2]){ 0, 0 }, step));
	for (int k = 0; k < NSHIFTS; k++) {
		int shift[2];

		shift[0] = random_shift(&state, w);
		shift[1] = random_shift(&state, h);
		if (fabs(shifted(fields, i, j, shift, step)) >= here)
			nlarger++;
	}
	ev->chance = (double)nlarger / NSHIFTS;
}
