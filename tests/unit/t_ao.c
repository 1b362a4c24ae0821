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
			int joint = y % 12 < 2 ||
			    (x + y / 12 % 2 * 10) % 20 < 2;

			img.data[y * width + x] = joint
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
			want = ao_oracle_ao(&o, scaled,
			    p->estimator == BAKE_AO_MEAN);
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
			CHECK_NEAR(oracle_error(make_noise(sizes[i][0],
						    sizes[i][1], 5),
				       &p),
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
			CHECK_NEAR(oracle_error(make_spikes(45, 30), &p), 0,
			    tol);
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

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(equals_the_oracle),
		CASE(equals_the_oracle_at_any_size),
		CASE(equals_the_oracle_at_any_reach),
		CASE(plane_is_exactly_open),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
