/* Tests of multilayer searches: kernels, shadows, pictures, arguments. */
/* SPDX-License-Identifier: MIT */
#include "multi_march_priv.h"

#include "check.h"
#include "test_multi_march.h"

static const struct bake_march_params exact = { BAKE_SEARCH_EXACT, 0, 0,
	false };

/* Ten layers in some texels, none in others. */
static struct bake_layer_maps
deep_maps(int w, int h, int nlayers)
{
	struct bake_layer_maps m =
	    layer_maps(w, h, nlayers, BAKE_DATA_UINT8, 0, 0, BAKE_DATA_UINT8);

	for (int i = 0; i < w * h; i++) {
		const int n = (int)(hash((uint32_t)i) % (uint32_t)nlayers) / 2;

		for (int k = 0; k < 2 * n + 2 && i % 3; k++)
			set_layer(&m, i % w, i / w, k,
			    (k * 24 / nlayers * 10 + 5 + i % 7) / 255.0,
			    (double[3]){ 0.1, 0.2, 0 });
	}
	return m;
}

/* In all directions, from before, behind and within; some with numbers that no
 * caller means to give. */
static struct bake_rays
wild_rays(int n, bool odd)
{
	static const float values[] = { NAN, INFINITY, -INFINITY, 1e30f, -1e30f,
		-0.0f, 1e-40f, 1.0f };
	struct bake_rays r = fan(n, 0);

	for (int i = 0; i < n; i++) {
		const uint32_t h = hash((uint32_t)i + 99);
		float *const field[] = { r.u, r.v, r.z, r.du, r.dv, r.dz, r.q,
			r.t_end };

		r.u[i] = r.u[i] / 3 + (float)h * 1e-10f;
		r.v[i] = r.v[i] / 3 + 0.5f;
		r.z[i] = (float)(h % 7) * 0.2f - 0.1f;
		r.dz[i] = (float)(h % 5) * 0.5f - 1;
		r.q[i] = (float)(h % 3) * 0.3f - 0.3f;
		r.t_end[i] = (float)(h % 11) * 0.2f;
		if (odd && h % 4 == 0)
			field[h / 4 % 8][i] = values[h / 32 % 8];
	}
	return r;
}

static const struct bake_march_params kinds[] = {
	{ BAKE_SEARCH_LINEAR, 32, 6, false },
	{ BAKE_SEARCH_LINEAR, 5, 0, false },
	{ BAKE_SEARCH_TEXEL, 1, 6, false },
};

/* Places inside and outside, and shadows; hits are not refined here. */
static void
compare(const struct bake_multi_map *map, const struct bake_rays *r)
{
	const size_t size = (size_t)r->n * sizeof(float);
	const size_t padded = ((size_t)r->n + 15) / 16 * 16;
	struct bake_multi_hits hits = new_hits(r->n);
	float *got = malloc(size), *before = calloc(padded, sizeof(float));

	for (int k = 0; k < 3; k++) {
		bake_multi_march(map, &kinds[k], r, &hits);
		memcpy(got, r->hit, size);
		bake_multi_search_plain(map, &kinds[k], r, before);
		CHECK(memcmp(got, r->hit, size) == 0);
		bake_multi_march_any(map, &kinds[k], 0.1f, r);
		memcpy(got, r->hit, size);
		bake_multi_any_plain(map, &kinds[k], 0.1f, r);
		CHECK(memcmp(got, r->hit, size) == 0);
	}
	free(hits.nx);
	free(got);
	free(before);
}

static void
kernels_give_the_bits_of_the_plain_search(void)
{
	static const char *const isas[] = { "baseline", "avx2", "avx512" };
	struct bake_rays wild = wild_rays(1003, true);

	for (int k = 0; k < 12; k++) {
		struct bake_layer_maps m = deep_maps(19, 13, k % 2 ? 10 : 4);
		struct bake_multi_map *map;

		setenv("BAKE_ISA", isas[k / 4], 1);
		map = open_multi(&m, k / 2 % 2 ? clamped : torus);
		compare(map, &wild);
		bake_multi_map_close(map);
		bake_layer_maps_free(&m);
	}
	unsetenv("BAKE_ISA");
	free(wild.u);
}

/* Searches look at points: what they find is there for EXACT too, no earlier
 * than a bit of rounding, and with small steps they seldom pass by it. The
 * step is 1/4096 of at most 2; slabs are 1/25 thick at least. */
static void
many_steps_come_to_the_exact_hit(void)
{
	static const struct bake_march_params fine = { BAKE_SEARCH_LINEAR, 4096,
		12, true };
	struct bake_layer_maps m = deep_maps(19, 13, 10);
	struct bake_rays r = wild_rays(1500, false);
	struct bake_multi_hits hits = new_hits(r.n);

	for (int k = 0; k < 2; k++) {
		struct bake_multi_map *map =
		    open_multi(&m, k ? clamped : torus);
		float *want = malloc((size_t)r.n * sizeof *want);
		int nmissed = 0;

		bake_multi_march(map, &exact, &r, &hits);
		memcpy(want, r.hit, (size_t)r.n * sizeof *want);
		bake_multi_march(map, &fine, &r, &hits);
		for (int i = 0; i < r.n; i++) {
			if (r.hit[i] >= 0)
				CHECK(want[i] >= 0 &&
				      want[i] <= r.hit[i] + 1e-5f);
			nmissed += fabsf(want[i] - r.hit[i]) > 1e-5f;
		}
		/* corners of texels: chords shorter than a step, of which one
		 * ray in 100 meets some */
		CHECK(nmissed <= r.n / 100);
		free(want);
		bake_multi_map_close(map);
	}
	bake_layer_maps_free(&m);
	free(r.u);
	free(hits.nx);
}

/* A plate from 1/4 to 3/4 in the right half: from within it, up and out; under
 * it, through it; and what is skipped. */
static void
shadows_begin_where_the_ray_left_its_own(void)
{
	static const struct {
		float u, z, du, dz, skip, want;
	} cases[] = { { 0.7f, 0.5f, 0, -1, 0, 0 }, { 0.7f, 1, 0, -1, 0, 1 },
		{ 0.7f, 1, 0, -1, 0.5f, 0 }, { 0.2f, 0.5f, 0, -1, 0, 0 },
		{ 0.2f, 0.5f, 0.5f, 0, 0, 1 }, { 0.2f, 0.5f, 0.1f, 0, 0, 0 },
		{ 0.9f, 0.5f, 0.8f, 0, 0, 1 }, { 0.7f, 0, 0, -1, 0, 0 } };
	static const struct bake_march_params steps = { BAKE_SEARCH_LINEAR, 64,
		0, false };
	struct bake_layer_maps m =
	    layer_maps(4, 1, 2, BAKE_DATA_FLOAT, 0, 0, BAKE_DATA_UINT8);
	struct bake_multi_map *map;
	struct bake_rays r = new_rays(1);

	for (int x = 2; x < 4; x++)
		for (int k = 0; k < 2; k++)
			set_layer(&m, x, 0, k,
			    bake_layer_stored(0.25 + 0.5 * k),
			    (double[3]){ 0, 0, 0 });
	map = open_multi(&m, torus);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		r.u[0] = cases[i].u;
		r.v[0] = 0.5f;
		r.z[0] = cases[i].z;
		r.du[0] = cases[i].du;
		r.dz[0] = cases[i].dz;
		bake_multi_march_any(map, &exact, cases[i].skip, &r);
		CHECK_NEAR(r.hit[0], cases[i].want, 0);
		bake_multi_march_any(map, &steps, cases[i].skip, &r);
		CHECK_NEAR(r.hit[0], cases[i].want, 0);
	}
	bake_multi_map_close(map);
	bake_layer_maps_free(&m);
	free(r.u);
}

/* -- pictures of solids ---------------------------------------------------- */

static double
iou(const struct solid *s, const struct bake_multi_map *map,
    const struct eye *e, const struct bake_march_params *params)
{
	struct bake_rays r = rays_of_eye(s, e);
	struct bake_multi_hits hits = new_hits(r.n);
	int both = 0, either = 0;

	bake_multi_march(map, params, &r, &hits);
	for (int i = 0; i < r.n; i++) {
		double at[3];
		const bool want = trace(s, e, i, at) >= 0, got = r.hit[i] >= 0;

		both += want && got;
		either += want || got;
	}
	free(r.u);
	free(hits.nx);
	return (double)both / either;
}

/* 0.99 from every direction by the searches. EXACT sees every stair that the
 * nearest texels have: 0.99 for the torus, and at 512 texels for the thin
 * weave.
 */
static void
impostors_cover_what_the_solid_does(void)
{
	static const struct bake_march_params linear = { BAKE_SEARCH_LINEAR, 32,
		6, true };
	static const struct bake_march_params texel = { BAKE_SEARCH_TEXEL, 32,
		6, true };

	for (int k = 0; k < 2; k++) {
		const struct solid *s = k ? &weave_solid : &torus_solid;
		struct bake_layer_maps m = layers_of(s, 256, BAKE_DATA_UINT8);
		struct bake_layer_maps fine =
		    layers_of(s, k ? 512 : 256, BAKE_DATA_UINT8);
		struct bake_multi_map *map = open_multi(&m, clamped);
		struct bake_multi_map *more = open_multi(&fine, clamped);

		for (int yaw = 0; yaw <= 180; yaw += 15) {
			const struct eye e = eye_at(s, 256, yaw, 0);

			CHECK(iou(s, map, &e, &linear) >= 0.99);
			CHECK(iou(s, map, &e, &texel) >= 0.99);
			CHECK(iou(s, more, &e, &exact) >= 0.99);
		}
		bake_multi_map_close(map);
		bake_multi_map_close(more);
		bake_layer_maps_free(&m);
		bake_layer_maps_free(&fine);
	}
}

/* A ball of 100 texels radius, seen from any side. Its rim in the map is up to
 * a texel inside of the ball's, where the normal is off by acos(1 - 1 / 100) =
 * 8.1 degrees; half a texel elsewhere, and a byte's rounding, are less than
 * one. Of the pixels within 0.95 of the radius, which leaves out the picture's
 * rim, 99 % are as near as that. */
static double
ball_distance(const double p[3])
{
	return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 100.0 / 128;
}

static void
hits_of_a_ball_have_its_normals(void)
{
	static const struct solid ball = { { 1, 1, 1 }, 1, ball_distance, NULL,
		NULL };
	struct bake_layer_maps m =
	    layer_maps(256, 256, 2, BAKE_DATA_UINT16, 0, 0, BAKE_DATA_UINT8);
	struct bake_multi_map *map;

	draw_ball(&m, 128, 128, 100, 256);
	map = open_multi(&m, clamped);
	for (int yaw = 0; yaw <= 180; yaw += 30) {
		const struct eye e = eye_at(&ball, 96, yaw, 10);
		struct bake_rays r = rays_of_eye(&ball, &e);
		struct bake_multi_hits h = new_hits(r.n);
		int n = 0, nwrong = 0;

		bake_multi_march(map, &exact, &r, &h);
		for (int i = 0; i < r.n; i++) {
			double p[3], dot, face;

			if (trace(&ball, &e, i, p) < 0)
				continue;
			face = -(p[0] * e.dir[0] + p[1] * e.dir[1] +
				   p[2] * e.dir[2]) *
			       1.28;
			/* sqrt(1 - 0.95^2) */
			if (face < 0.3123)
				continue;
			CHECK(r.hit[i] >= 0);
			dot = (p[0] * (double)h.nx[i] + p[1] * (double)h.ny[i] +
				  p[2] * (double)h.nz[i]) *
			      1.28;
			n++;
			nwrong += !(dot > cos(9 * pi / 180));
		}
		CHECK(nwrong * 100 <= n);
		if (nwrong * 100 > n)
			printf("yaw %d: %d of %d\n", yaw, nwrong, n);
		free(r.u);
		free(h.nx);
	}
	bake_multi_map_close(map);
	bake_layer_maps_free(&m);
}

static void
wrong_sets_are_refused(void)
{
	struct bake_layer_maps m =
	    layer_maps(2, 2, 2, BAKE_DATA_UINT8, 0, 0, BAKE_DATA_UINT8);
	struct bake_layer_maps bad = m;
	struct bake_multi_map *map = (struct bake_multi_map *)&bad;
	struct bake_err err = BAKE_ERR_INIT;

	bad.nlayers = 3;
	CHECK(bake_multi_map_open(&map, &bad, torus, 1, &err) == BAKE_EINVAL);
	CHECK(map == NULL);
	CHECK(strcmp(err.msg, "3 layers, expected 1 or an even number up to "
			      "64") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	bad = m;
	bad.width = 0;
	CHECK(bake_multi_map_open(&map, &bad, torus, 1, &err) == BAKE_EINVAL);
	bake_multi_map_close(NULL);
	bake_layer_maps_free(&m);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(kernels_give_the_bits_of_the_plain_search),
		CASE(many_steps_come_to_the_exact_hit),
		CASE(shadows_begin_where_the_ray_left_its_own),
		CASE(impostors_cover_what_the_solid_does),
		CASE(hits_of_a_ball_have_its_normals),
		CASE(wrong_sets_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
