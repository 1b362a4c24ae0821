/* Ambient occlusion: closed forms, invariants, the oracle, errors. */
/* SPDX-License-Identifier: MIT */
#include "ao.h"
#include "check.h"

#include "../oracle/ao_oracle.h"

/*
 * Tolerance against the oracle: one r is off by at most 0.385 times the error
 * of its tangent, whose own is about 3 roundings of S W slope; the sum of 50
 * adds as many roundings of 2^-25. 5e-6 is the contract of ao.h.
 */
static const double tol = 5e-6;

static unsigned
next_random(unsigned *state)
{
	/* a hash of a counter: a linear congruence repeats along columns */
	unsigned z = *state += 0x9e3779b9u;

	z = (z ^ z >> 16) * 0x85ebca6bu;
	z = (z ^ z >> 13) * 0xc2b2ae35u;
	return (z ^ z >> 16) >> 8;
}

static float
random_unit(unsigned *state)
{
	return (float)next_random(state) / 16777216.0f;
}

static struct bake_image
make_map(int width, int height, float value)
{
	struct bake_image img = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_image_alloc(&img, width, height, 1, &err), err);
	for (int i = 0; i < width * height; i++)
		img.data[i] = value;
	return img;
}

static struct bake_image
make_noise(int width, int height, unsigned seed)
{
	struct bake_image img = make_map(width, height, 0);

	for (int i = 0; i < width * height; i++)
		img.data[i] = random_unit(&seed);
	return img;
}

/* flat bricks at 0 with joints at 1, and a little grain */
static struct bake_image
make_bricks(int width, int height)
{
	struct bake_image img = make_map(width, height, 0);
	unsigned seed = 7;

	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			int joint =
			    y % 12 < 2 || (x + y / 12 % 2 * 10) % 20 < 2;

			img.data[y * width + x] =
			    joint
				? 1
				: (x % 3 == 0 ? 0.05f * random_unit(&seed) : 0);
		}
	return img;
}

static struct bake_image
make_spikes(int width, int height)
{
	struct bake_image img = make_map(width, height, 1);
	unsigned seed = 3;

	for (int i = 0; i < width * height; i++)
		if (next_random(&seed) % 200 == 0)
			img.data[i] = random_unit(&seed);
	return img;
}

static struct bake_ao_params
raw_params(void)
{
	struct bake_ao_params p = BAKE_AO_PARAMS_DEFAULT;

	p.blur = BAKE_AO_BLUR_NONE;
	return p;
}

static struct bake_image
bake_one(const struct bake_image *depth, double scale,
    const struct bake_ao_params *params)
{
	struct bake_image ao = BAKE_IMAGE_INIT;
	struct bake_ao_result result = { &ao, NULL, NULL };
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_ao(depth, &scale, 1, params, &result, &err), err);
	return ao;
}

static struct ao_oracle
oracle_for(const struct bake_image *depth, double scale,
    const struct bake_ao_params *p)
{
	struct ao_oracle o = { depth->data, depth->width, depth->height,
		p->wrap.clamp_u, p->wrap.clamp_v, p->ndirs, scale, p->radius,
		p->periods };

	return o;
}

/* The largest difference from the oracle over all texels, at three scales
 * from one march; frees the map. */
static double
oracle_error(struct bake_image depth, const struct bake_ao_params *p)
{
	static const double scales[] = { 0.05, 0.1, 0.25 };
	struct bake_image ao[3] = { BAKE_IMAGE_INIT };
	struct bake_ao_result result = { ao, NULL, NULL };
	struct bake_err err = BAKE_ERR_INIT;
	double worst = 0, tans[1024], scaled[1024];
	struct ao_oracle o = oracle_for(&depth, 1, p);

	CHECK_OK(bake_ao(&depth, scales, 3, p, &result, &err), err);
	for (int i = 0; i < depth.width * depth.height; i++) {
		ao_oracle_tans(&o, i % depth.width, i / depth.width, tans);
		for (int s = 0; s < 3; s++) {
			double want;

			for (int j = 0; j < p->ndirs; j++)
				scaled[j] = scales[s] * tans[j];
			want = ao_oracle_ao(
			    &o, scaled, p->estimator == BAKE_AO_MEAN);
			worst = fmax(worst, fabs(ao[s].data[i] - want));
		}
	}
	for (int s = 0; s < 3; s++)
		bake_image_free(&ao[s]);
	bake_image_free(&depth);
	return worst;
}

static void
equals_the_oracle(void)
{
	struct bake_ao_params p = raw_params();

	CHECK_NEAR(oracle_error(make_noise(64, 64, 1), &p), 0, tol);
	CHECK_NEAR(oracle_error(make_bricks(100, 72), &p), 0, tol);
	CHECK_NEAR(oracle_error(make_spikes(96, 80), &p), 0, tol);
	p.estimator = BAKE_AO_MEAN;
	p.ndirs = 8;
	CHECK_NEAR(oracle_error(make_noise(40, 56, 2), &p), 0, tol);
	p.ndirs = 3;
	CHECK_NEAR(oracle_error(make_spikes(64, 64), &p), 0, tol);
}

static void
equals_the_oracle_at_any_size(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 1, 37 }, { 41, 1 },
		{ 2, 3 }, { 5, 4 }, { 7, 90 }, { 33, 17 }, { 31, 64 },
		{ 67, 19 } };
	struct bake_ao_params p = raw_params();

	for (int i = 0; i < 9; i++)
		for (int clamp = 0; clamp < 4; clamp++) {
			p.wrap.clamp_u = clamp & 1;
			p.wrap.clamp_v = clamp >> 1;
			CHECK_NEAR(
			    oracle_error(
				make_noise(sizes[i][0], sizes[i][1], 5), &p),
			    0, tol);
		}
}

static void
equals_the_oracle_at_any_reach(void)
{
	static const double radii[] = { 0.01, 0.3, 1, 2.7 };
	struct bake_ao_params p = raw_params();

	for (int clamp = 0; clamp < 2; clamp++) {
		p.wrap.clamp_u = clamp;
		for (int i = 0; i < 4; i++) {
			p.radius = radii[i];
			CHECK_NEAR(
			    oracle_error(make_spikes(45, 30), &p), 0, tol);
		}
		p.radius = 0;
		p.periods = 2;
		CHECK_NEAR(oracle_error(make_spikes(45, 30), &p), 0, tol);
		p.periods = 1;
	}
}

static void
plane_is_exactly_open(void)
{
	static const float levels[] = { 0, 0.3f, 1 };
	struct bake_ao_params p = BAKE_AO_PARAMS_DEFAULT;

	for (int q = 0; q < 3; q++)
		for (int i = 0; i < 3; i++) {
			struct bake_image depth = make_map(70, 45, levels[i]);
			struct bake_image ao;

			p.quality = (enum bake_ao_quality)q;
			ao = bake_one(&depth, 0.25, &p);
			for (int t = 0; t < 70 * 45; t++)
				CHECK(ao.data[t] == 1);
			bake_image_free(&ao);
			bake_image_free(&depth);
		}
}

/* One texel sunk into a plane: along every ray its first sample is the plane,
 * one step away. */
static void
pit_has_its_closed_form(void)
{
	const double scale = 0.1, drop = 0.6;
	struct bake_ao_params p = raw_params();
	struct bake_image depth = make_map(80, 64, 0.25f);
	struct bake_image ao;
	double r[50], sum = 0;

	depth.data[20 * 80 + 30] = (float)(0.25 + drop);
	for (int j = 0; j < 50; j++) {
		double phi = 2 * 3.14159265358979323846 * j / 50;
		double dist = 1 / fmax(fabs(cos(phi)), fabs(sin(phi)));

		r[j] = 1 / hypot(1, scale * 80 * drop / dist);
	}
	for (int j = 0; j < 50; j++)
		sum += r[j] * r[(j + 1) % 50];
	ao = bake_one(&depth, scale, &p);
	/* drop itself is rounded to float: 1e-7 of the tangent */
	CHECK_NEAR(ao.data[20 * 80 + 30], sum / 50, 1e-6);
	for (int t = 0; t < 80 * 64; t++)
		CHECK(t == 20 * 80 + 30 || ao.data[t] == 1);
	bake_image_free(&ao);
	bake_image_free(&depth);
}

/* Columns from 40 on stand 1 higher, clamped: from a texels before the edge,
 * of 8 directions 0 and +-45 degrees meet it, at a and sqrt(2) a. */
static void
wall_has_its_closed_form(void)
{
	const double scale = 0.2;
	struct bake_ao_params p = raw_params();
	struct bake_image depth = make_map(70, 90, 1);
	struct bake_image ao, horizons = BAKE_IMAGE_INIT, bent = horizons;
	struct bake_ao_result result = { &ao, &bent, &horizons };
	struct bake_err err = BAKE_ERR_INIT;

	p.ndirs = 8;
	p.wrap.clamp_u = p.wrap.clamp_v = true;
	for (int i = 0; i < 70 * 90; i++)
		depth.data[i] = i % 70 >= 40 ? 0 : 1;
	CHECK_OK(bake_ao(&depth, &scale, 1, &p, &result, &err), err);
	for (int a = 1; a <= 10; a++) {
		const int t = 45 * 70 + 40 - a;
		const double t0 = scale * 70 / a, t1 = t0 / sqrt(2);
		const double r0 = 1 / hypot(1, t0), r1 = 1 / hypot(1, t1);

		CHECK_NEAR(horizons.data[8 * t], t0, 1e-6 * t0);
		CHECK_NEAR(horizons.data[8 * t + 1], t1, 1e-6 * t1);
		CHECK_NEAR(horizons.data[8 * t + 7], t1, 1e-6 * t1);
		CHECK(horizons.data[8 * t + 4] == 0);
		CHECK_NEAR(ao.data[t], (2 * r0 * r1 + 2 * r1 + 4) / 8, 1e-6);
		CHECK(bent.data[3 * t] < 0); /* away from the wall */
	}
	bake_image_free(&ao);
	bake_image_free(&bent);
	bake_image_free(&horizons);
	bake_image_free(&depth);
}

/* One wall above (in row 0's direction) bends the normal down. */
static void
up_is_towards_row_0(void)
{
	struct bake_ao_params p = raw_params();
	struct bake_image depth = make_map(64, 64, 1);
	struct bake_image ao, bent = BAKE_IMAGE_INIT;
	struct bake_ao_result result = { &ao, &bent, NULL };
	struct bake_err err = BAKE_ERR_INIT;
	double scale = 0.2;

	p.wrap.clamp_v = true;
	for (int x = 0; x < 64; x++)
		depth.data[x] = 0;
	CHECK_OK(bake_ao(&depth, &scale, 1, &p, &result, &err), err);
	CHECK(bent.data[3 * (3 * 64 + 5) + 1] < -0.05f);
	CHECK_NEAR(bent.data[3 * (3 * 64 + 5)], 0, 1e-6);
	bake_image_free(&ao);
	bake_image_free(&bent);
	bake_image_free(&depth);
}

static void
bent_and_horizons_equal_the_oracle(void)
{
	static const double scales[] = { 0.05, 0.25 };
	struct bake_ao_params p = raw_params();
	struct bake_image depth = make_noise(50, 34, 8);
	struct bake_image ao[2], bent[2], horizons[2];
	struct bake_ao_result result = { ao, bent, horizons };
	struct bake_err err = BAKE_ERR_INIT;
	double worst_tan = 0, worst_bent = 0;

	for (int m = 0; m < 2; m++) { /* the mean takes another way */
		p.estimator = (enum bake_ao_estimator)m;
		CHECK_OK(bake_ao(&depth, scales, 2, &p, &result, &err), err);
		for (int s = 0; s < 2; s++) {
			struct ao_oracle o = oracle_for(&depth, scales[s], &p);

			for (int t = 0; t < 50 * 34; t++) {
				double tans[50], v[3];

				ao_oracle_tans(&o, t % 50, t / 50, tans);
				ao_oracle_bent(&o, tans, v);
				for (int j = 0; j < 50; j++)
					worst_tan = fmax(worst_tan,
					    fabs(horizons[s].data[t * 50 + j] -
						 tans[j]) /
						fmax(1, tans[j]));
				for (int c = 0; c < 3; c++)
					worst_bent = fmax(worst_bent,
					    fabs(bent[s].data[3 * t + c] -
						 v[c]));
			}
			bake_image_free(&ao[s]);
			bake_image_free(&bent[s]);
			bake_image_free(&horizons[s]);
		}
	}
	/* tan: a few roundings of 2^-24 times S W = 12.5; bent: 50 of them
	 * over a z of at least 0.1 */
	CHECK_NEAR(worst_tan, 0, 5e-6);
	CHECK_NEAR(worst_bent, 0, 2e-5);
	bake_image_free(&depth);
}

static void
plane_bends_nothing(void)
{
	struct bake_ao_params p = BAKE_AO_PARAMS_DEFAULT;
	struct bake_image depth = make_map(40, 20, 0.7f);
	struct bake_image ao, bent = BAKE_IMAGE_INIT;
	struct bake_ao_result result = { &ao, &bent, NULL };
	struct bake_err err = BAKE_ERR_INIT;
	double scale = 0.1;

	CHECK_OK(bake_ao(&depth, &scale, 1, &p, &result, &err), err);
	for (int t = 0; t < 40 * 20; t++)
		CHECK(bent.data[3 * t] == 0 && bent.data[3 * t + 1] == 0 &&
		      bent.data[3 * t + 2] == 1);
	bake_image_free(&ao);
	bake_image_free(&bent);
	bake_image_free(&depth);
}

static bool
same_texels(const struct bake_image *a, const struct bake_image *b)
{
	return memcmp(a->data, b->data,
		   (size_t)a->width * (size_t)a->height * sizeof(float)) == 0;
}

static void
threads_and_instruction_sets_give_the_same_bytes(void)
{
	static const char *const isas[] = { "avx512", "avx2", "baseline" };
	static const int nthreads[] = { 1, 2, 7 };
	struct bake_ao_params p = BAKE_AO_PARAMS_DEFAULT;
	struct bake_image depth = make_noise(150, 70, 6);

	for (int q = 0; q < 3; q++) {
		struct bake_image first = BAKE_IMAGE_INIT;

		p.quality = (enum bake_ao_quality)q;
		for (int i = 0; i < 9; i++) {
			struct bake_image ao;

			setenv("BAKE_ISA", isas[i / 3], 1);
			p.nthreads = nthreads[i % 3];
			ao = bake_one(&depth, 0.1, &p);
			if (i == 0)
				bake_image_swap(&first, &ao);
			else
				CHECK(same_texels(&first, &ao));
			bake_image_free(&ao);
		}
		bake_image_free(&first);
	}
	unsetenv("BAKE_ISA");
	bake_image_free(&depth);
}

/* On a torus: by any shift exactly; fast and preview, by whole blocks of 16
 * texels, in the direction that a block lies in and so in both. */
static void
shifted_map_gives_shifted_result(void)
{
	static const int shifts[][2] = { { 32, 48 }, { 16, 0 }, { 0, 80 },
		{ 1, 0 }, { 0, 1 }, { 37, 51 } };
	const int width = 80, height = 96;
	struct bake_ao_params p = BAKE_AO_PARAMS_DEFAULT;
	struct bake_image depth = make_bricks(width, height);

	p.periods = 4; /* so that fast has blocks of 16 */
	for (int q = 0; q < 3; q++) {
		const int nshifts = q == BAKE_AO_EXACT ? 6 : 3;
		struct bake_image ao;

		p.quality = (enum bake_ao_quality)q;
		ao = bake_one(&depth, 0.1, &p);
		for (int i = 0; i < nshifts; i++) {
			struct bake_image moved = make_map(width, height, 0);
			struct bake_image moved_ao;
			int ndiffer = 0;

			for (int t = 0; t < width * height; t++) {
				int x = (t % width + shifts[i][0]) % width;
				int y = (t / width + shifts[i][1]) % height;

				moved.data[y * width + x] = depth.data[t];
			}
			moved_ao = bake_one(&moved, 0.1, &p);
			for (int t = 0; t < width * height; t++) {
				int x = (t % width + shifts[i][0]) % width;
				int y = (t / width + shifts[i][1]) % height;

				ndiffer +=
				    moved_ao.data[y * width + x] != ao.data[t];
			}
			CHECK(ndiffer == 0);
			bake_image_free(&moved);
			bake_image_free(&moved_ao);
		}
		bake_image_free(&ao);
	}
	bake_image_free(&depth);
}

static void
scales_of_one_march_equal_single_bakes(void)
{
	static const double scales[] = { 0.25, 0, 0.05 };
	struct bake_ao_params p = BAKE_AO_PARAMS_DEFAULT;
	struct bake_image depth = make_noise(70, 33, 4);
	struct bake_image ao[3];
	struct bake_ao_result result = { ao, NULL, NULL };
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_ao(&depth, scales, 3, &p, &result, &err), err);
	for (int s = 0; s < 3; s++) {
		struct bake_image one = bake_one(&depth, scales[s], &p);

		CHECK(same_texels(&one, &ao[s]));
		CHECK(s != 1 || one.data[5] == 1); /* no relief at S = 0 */
		bake_image_free(&one);
		bake_image_free(&ao[s]);
	}
	bake_image_free(&depth);
}

/* Mean errors of the far field as bake_ao's header states them; on bricks,
 * noise and hills, whose horizons lie near, anywhere, and far, and on lone
 * spikes of one texel. */
static void
fast_is_close_to_exact(void)
{
	static const double bounds[][4] = { [BAKE_AO_FAST] = { 2e-3, 2e-3, 2e-3,
						2e-2 },
		[BAKE_AO_PREVIEW] = { 1e-2, 1e-2, 1e-2, 3e-2 } };
	enum { SIDE = 300 };
	struct bake_image maps[4] = { make_bricks(SIDE, SIDE),
		make_map(SIDE, SIDE, 0), make_map(SIDE, SIDE, 0),
		make_spikes(SIDE, SIDE) };
	struct bake_ao_params p = raw_params();
	unsigned seed = 5;

	for (int t = 0; t < SIDE * SIDE; t++) {
		const double a = 2 * 3.14159265358979323846 / SIDE;

		maps[1].data[t] = (float)next_random(&seed) / 16777216.0f;
		maps[2].data[t] = (float)(0.5 + 0.25 * sin(3 * a * (t % SIDE)) +
					  0.25 * cos(2 * a * (t / SIDE)));
	}
	for (int m = 0; m < 4; m++) {
		struct bake_image exact;

		p.quality = BAKE_AO_EXACT;
		exact = bake_one(&maps[m], 0.1, &p);
		for (int q = 1; q < 3; q++) {
			struct bake_image ao;
			double sum = 0;

			p.quality = (enum bake_ao_quality)q;
			ao = bake_one(&maps[m], 0.1, &p);
			for (int t = 0; t < SIDE * SIDE; t++)
				sum += fabs((double)ao.data[t] - exact.data[t]);
			CHECK_NEAR(sum / (SIDE * SIDE), 0, bounds[q][m]);
			bake_image_free(&ao);
		}
		bake_image_free(&exact);
		bake_image_free(&maps[m]);
	}
}

static void
hostile_values_stay_in_range(void)
{
	static const float values[] = { 1e30f, -1e30f, 3e38f, -3e38f, 1e-44f,
		INFINITY, -INFINITY, NAN, 0, 1, -0.0f };
	struct bake_ao_params p = BAKE_AO_PARAMS_DEFAULT;
	double scale = 1e6;

	for (int q = 0; q < 3; q++) {
		struct bake_image depth = make_map(40, 37, 0);
		struct bake_image ao, bent = BAKE_IMAGE_INIT, tans = bent;
		struct bake_ao_result result = { &ao, &bent, &tans };
		struct bake_err err = BAKE_ERR_INIT;
		unsigned seed = 9;

		p.quality = (enum bake_ao_quality)q;
		for (int t = 0; t < 40 * 37; t++)
			depth.data[t] = values[next_random(&seed) % 11];
		CHECK_OK(bake_ao(&depth, &scale, 1, &p, &result, &err), err);
		for (int t = 0; t < 40 * 37; t++) {
			const float *b = bent.data + 3 * t;

			CHECK(ao.data[t] >= 0 && ao.data[t] <= 1);
			/* each component within 2 roundings */
			CHECK_NEAR(hypot(hypot(b[0], b[1]), b[2]), 1, 1e-6);
		}
		for (int i = 0; i < 40 * 37 * 50; i++)
			CHECK(tans.data[i] >= 0 && tans.data[i] <= 1e18f);
		bake_image_free(&ao);
		bake_image_free(&bent);
		bake_image_free(&tans);
		bake_image_free(&depth);
	}
}

/* The blur of bake_ao against its formula, in double, over all texels. */
static void
check_blur(bool occluded, struct bake_wrap wrap)
{
	const int width = 41, height = 23, reach = 6; /* ceil(4 * 1.5) */
	struct bake_ao_params p = raw_params();
	struct bake_image depth = make_map(width, height, 0), raw, ao;
	bool *mask = malloc((size_t)(width * height));

	p.wrap = wrap;
	for (int t = 0; t < width * height; t++) /* a trench in a plane */
		depth.data[t] = t % width > 10 && t % width < 15 ? 0.9f : 0.2f;
	raw = bake_one(&depth, 0.2, &p);
	for (int t = 0; t < width * height; t++)
		mask[t] = t % width > 10 && t % width < 15;
	p.blur = occluded ? BAKE_AO_BLUR_OCCLUDED : BAKE_AO_BLUR_PAPER;
	p.blur_sigma = 1.5;
	ao = bake_one(&depth, 0.2, &p);
	for (int t = 0; t < width * height; t++) {
		double sum = 0, norm = 0;

		for (int y = -reach; y <= reach; y++)
			for (int x = -reach; x <= reach; x++) {
				int i = bake_wrap_index(t % width + x, width,
					    wrap.clamp_u) +
					bake_wrap_index(t / width + y, height,
					    wrap.clamp_v) *
					    width;
				double w = exp(-(x * x + y * y) / 4.5);

				w = occluded && !mask[i] ? 0 : w;
				sum += w * raw.data[i];
				norm += w;
			}
		/* 13 + 13 float roundings */
		CHECK_NEAR(ao.data[t], mask[t] ? sum / norm : 1, 2e-6);
	}
	free(mask);
	bake_image_free(&raw);
	bake_image_free(&ao);
	bake_image_free(&depth);
}

static void
blur_equals_its_formula(void)
{
	for (int i = 0; i < 8; i++) {
		struct bake_wrap wrap = { i & 1, i >> 1 & 1 };

		check_blur(i >> 2, wrap);
	}
}

static void
note_progress(void *arg, double done)
{
	double *last = arg;

	CHECK(done >= *last && done <= 1);
	*last = done;
}

static void
progress_ends_at_1(void)
{
	struct bake_ao_params p = raw_params();
	struct bake_image depth = make_noise(64, 64, 1), ao;
	double last = 0;

	p.progress.report = note_progress;
	p.progress.arg = &last;
	p.nthreads = 2;
	ao = bake_one(&depth, 0.1, &p);
	CHECK(last == 1);
	bake_image_free(&ao);
	bake_image_free(&depth);
}

static void
refuse(const struct bake_image *depth, double scale, int nscales,
    const struct bake_ao_params *p)
{
	struct bake_image ao = BAKE_IMAGE_INIT;
	struct bake_ao_result result = { &ao, NULL, NULL };
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_ao(depth, &scale, nscales, p, &result, &err) == BAKE_EINVAL);
	CHECK(err.code == BAKE_EINVAL && err.msg[0] != 0);
	CHECK(ao.data == NULL);
}

static void
bad_parameters_are_refused(void)
{
	static const struct bake_ao_params good = BAKE_AO_PARAMS_DEFAULT;
	struct bake_image depth = make_map(4, 4, 0);
	struct bake_image two = depth, none = BAKE_IMAGE_INIT;
	struct bake_ao_params p[12];

	two.nchans = 2;
	two.width = 2;
	refuse(&two, 0.1, 1, &good);
	refuse(&none, 0.1, 1, &good);
	refuse(&depth, -0.1, 1, &good);
	refuse(&depth, NAN, 1, &good);
	refuse(&depth, INFINITY, 1, &good);
	refuse(&depth, 0.1, 0, &good);
	refuse(&depth, 0.1, 65, &good);
	for (int i = 0; i < 12; i++)
		p[i] = good;
	p[0].ndirs = 2;
	p[1].ndirs = 1025;
	p[2].radius = -1;
	p[3].radius = NAN;
	p[4].radius = 65;
	p[5].periods = 0;
	p[6].periods = 65;
	p[7].blur_sigma = -1;
	p[8].blur_sigma = NAN;
	p[9].nthreads = -1;
	p[10].quality = (enum bake_ao_quality)3;
	p[11].estimator = (enum bake_ao_estimator)2;
	for (int i = 0; i < 12; i++)
		refuse(&depth, 0.1, 1, &p[i]);
	bake_image_free(&depth);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(equals_the_oracle),
		CASE(equals_the_oracle_at_any_size),
		CASE(equals_the_oracle_at_any_reach),
		CASE(plane_is_exactly_open),
		CASE(plane_bends_nothing),
		CASE(pit_has_its_closed_form),
		CASE(wall_has_its_closed_form),
		CASE(up_is_towards_row_0),
		CASE(bent_and_horizons_equal_the_oracle),
		CASE(threads_and_instruction_sets_give_the_same_bytes),
		CASE(shifted_map_gives_shifted_result),
		CASE(scales_of_one_march_equal_single_bakes),
		CASE(fast_is_close_to_exact),
		CASE(hostile_values_stay_in_range),
		CASE(blur_equals_its_formula),
		CASE(progress_ends_at_1),
		CASE(bad_parameters_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
