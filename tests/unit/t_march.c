/* Tests of relief marching: closed forms, wrapping, bad maps. */
/* SPDX-License-Identifier: MIT */
#include "march_priv.h"

#include "check.h"
#include "test_march.h"

/* How far the found t may be behind the place, for n steps to t_end: the
 * secant is exact on a plane but for rounding. */
static double
tolerance(const struct bake_march_params *p, double step)
{
	if (p->search == BAKE_SEARCH_EXACT || p->secant)
		return 4e-7;
	return step / (1 << p->nbinary);
}

static struct bake_image
flat(int w, int h, float d)
{
	struct bake_image img = image(w, h, 1);

	for (int i = 0; i < w * h; i++)
		img.data[i] = d;
	return img;
}

static void
flat_ground_is_hit_at_its_depth(void)
{
	struct bake_image img = flat(13, 9, 0.375f);
	struct bake_relief_map *map = open_map(&img, torus);
	struct bake_rays r = fan(100, 0);

	for (int s = 0; s < NSEARCHES; s++) {
		/* TEXEL has no longer steps than these */
		const double step = 1.0 / fmax(1, searches[s].nlinear);

		bake_march(map, &searches[s], &r);
		for (int i = 0; i < r.n; i++)
			CHECK_NEAR(
			    r.hit[i], 0.375, tolerance(&searches[s], step));
	}
	bake_relief_map_close(map);
	bake_image_free(&img);
	free(r.u);
}

/* z = t and d = u - 1/4 cross where t (1 - du) = u - 1/4 */
static void
a_ramp_is_hit_where_lines_cross(void)
{
	struct bake_image img = image(64, 4, 1);
	struct bake_relief_map *map;
	struct bake_rays r = fan(64, 0);

	for (int y = 0; y < 4; y++)
		for (int x = 0; x < 64; x++)
			img.data[y * 64 + x] = ((float)x + 0.5f) / 64 - 0.25f;
	map = open_map(&img, clamped);
	for (int i = 0; i < r.n; i++)
		r.u[i] = 0.45f;
	for (int s = 0; s < NSEARCHES; s++) {
		const double step = 1.0 / fmax(1, searches[s].nlinear);

		bake_march(map, &searches[s], &r);
		for (int i = 0; i < r.n; i++)
			CHECK_NEAR(r.hit[i], 0.2 / (1 - (double)r.du[i]),
			    tolerance(&searches[s], step));
	}
	bake_relief_map_close(map);
	bake_image_free(&img);
	free(r.u);
}

static void
vertical_rays_sample_the_map(void)
{
	struct bake_image img = noise(12, 7, 1);
	struct bake_relief_map *map = open_map(&img, torus);
	struct bake_rays r = fan(200, 0);
	float *d = malloc(200 * sizeof *d);

	for (int i = 0; i < r.n; i++) {
		r.du[i] = r.dv[i] = 0;
		r.t_end[i] = 1 + 0x1p-20f;
	}
	bake_relief_map_sample(map, r.n, r.u, r.v, d);
	for (int s = 0; s < NSEARCHES; s++) {
		const double step = 1.01 / fmax(1, searches[s].nlinear);

		bake_march(map, &searches[s], &r);
		for (int i = 0; i < r.n; i++)
			CHECK_NEAR(
			    r.hit[i], d[i], tolerance(&searches[s], step));
	}
	free(d);
	bake_relief_map_close(map);
	bake_image_free(&img);
	free(r.u);
}

static void
a_ray_that_starts_on_or_below_hits_at_once(void)
{
	struct bake_image img = flat(8, 8, 0.5f);
	struct bake_relief_map *map = open_map(&img, torus);
	struct bake_rays on = fan(40, 0.5f), under = fan(40, 0.75f);

	for (int s = 0; s < NSEARCHES; s++) {
		bake_march(map, &searches[s], &on);
		bake_march(map, &searches[s], &under);
		for (int i = 0; i < 40; i++)
			CHECK(on.hit[i] == 0 && under.hit[i] == 0);
	}
	bake_relief_map_close(map);
	bake_image_free(&img);
	free(on.u);
	free(under.u);
}

static void
nothing_is_hit_beyond_the_end(void)
{
	static const float ends[] = { 0, -1, NAN, 0.49f };
	struct bake_image img = flat(8, 8, 0.5f);
	struct bake_relief_map *map = open_map(&img, torus);
	struct bake_rays r = fan(40, 0);

	for (int s = 0; s < NSEARCHES; s++)
		for (int e = 0; e < 4; e++) {
			for (int i = 0; i < r.n; i++)
				r.t_end[i] = ends[e];
			bake_march(map, &searches[s], &r);
			for (int i = 0; i < r.n; i++)
				CHECK(r.hit[i] < 0);
			bake_march_any(map, &searches[s], 0, &r);
			for (int i = 0; i < r.n; i++)
				CHECK(r.hit[i] == 0);
		}
	/* of an empty segment below the ground, its one point is met */
	for (int i = 0; i < r.n; i++) {
		r.z[i] = 0.75f;
		r.t_end[i] = 0;
	}
	for (int s = 0; s < NSEARCHES; s++) {
		bake_march(map, &searches[s], &r);
		for (int i = 0; i < r.n; i++)
			CHECK(r.hit[i] == 0);
		bake_march_any(map, &searches[s], 0, &r);
		for (int i = 0; i < r.n; i++)
			CHECK(r.hit[i] == 1);
	}
	bake_relief_map_close(map);
	bake_image_free(&img);
	free(r.u);
}

/* t - q t^2 = 1/4: for q = 3/4 at t = 1/3, for q = -3 at 1/6 (sqrt 4 - 1);
 * for q = 2 the ray turns at depth 1/8 and leaves. */
static void
bent_rays_meet_flat_ground(void)
{
	static const double cases[][2] = { { 0.75, 1.0 / 3 }, { -3, 1.0 / 6 },
		{ 2, -1 } };
	struct bake_image img = flat(32, 32, 0.25f);
	struct bake_relief_map *map = open_map(&img, torus);
	struct bake_rays r = fan(50, 0);

	for (int c = 0; c < 3; c++)
		for (int s = 0; s < NSEARCHES; s++) {
			const struct bake_march_params *p = &searches[s];
			const double step = 1.0 / fmax(1, p->nlinear);
			/* of the chord from the parabola q t^2: |q| h^2 / 4
			 * in z, by the slope at the crossing, at least 1/2 */
			const double h = step / (1 << p->nbinary);
			double tol = tolerance(p, step);

			if (p->search == BAKE_SEARCH_TEXEL && p->nlinear == 1)
				tol += 3.0 / 4 / 12 / 12 * 2;
			else if (p->search != BAKE_SEARCH_EXACT && p->secant)
				tol += fabs(cases[c][0]) * h * h / 4 * 2;
			for (int i = 0; i < r.n; i++)
				r.q[i] = (float)cases[c][0];
			bake_march(map, p, &r);
			for (int i = 0; i < r.n; i++)
				CHECK_NEAR(r.hit[i], cases[c][1], tol);
		}
	bake_relief_map_close(map);
	bake_image_free(&img);
	free(r.u);
}

/* The texels' own values at their centres, rows from the top. */
static void
samples_at_centres_are_texels(void)
{
	struct bake_image img = noise(8, 4, 1);

	for (int w = 0; w < 2; w++) {
		struct bake_relief_map *map =
		    open_map(&img, w ? clamped : torus);
		float u[32], v[32], d[32];

		for (int i = 0; i < 32; i++) {
			u[i] = ((float)(i % 8) + 0.5f) / 8;
			v[i] = 1 - ((float)(i / 8) + 0.5f) / 4;
		}
		/* every n, for the rests of vectors */
		for (int n = 0; n <= 32; n++) {
			memset(d, 0, sizeof d);
			bake_relief_map_sample(map, n, u, v, d);
			for (int i = 0; i < 32; i++)
				CHECK(d[i] == (i < n ? img.data[i] : 0));
		}
		bake_relief_map_close(map);
	}
	bake_image_free(&img);
}

/* Halfway between the outermost centres: the mean on a torus, else the
 * border's value, as at any distance. */
static void
borders_wrap_or_repeat(void)
{
	static const float data[4] = { 0.25f, 0.5f, 1, 0.125f };
	struct bake_image img = { 2, 2, 1, 2, NULL };
	float u[4] = { 0, 1, -7, 8 }, v[4] = { 0.75f, 0.75f, 0.25f, 0.25f };
	float rows[2] = { 0, 1 }, cols[2] = { 0.25f, 0.25f }, d[4];
	struct bake_relief_map *map;

	img.data = malloc(sizeof data);
	memcpy(img.data, data, sizeof data);
	map = open_map(&img, torus);
	bake_relief_map_sample(map, 4, u, v, d);
	CHECK(d[0] == 0.375f && d[1] == 0.375f);
	CHECK(d[2] == 0.5625f && d[3] == 0.5625f);
	bake_relief_map_sample(map, 2, cols, rows, d);
	CHECK(d[0] == 0.625f && d[1] == 0.625f);
	bake_relief_map_close(map);
	map = open_map(&img, clamped);
	bake_relief_map_sample(map, 4, u, v, d);
	CHECK(d[0] == 0.25f && d[1] == 0.5f);
	CHECK(d[2] == 1 && d[3] == 0.125f);
	bake_relief_map_sample(map, 2, cols, rows, d);
	CHECK(d[0] == 1 && d[1] == 0.25f);
	bake_relief_map_close(map);
	free(img.data);
}

/* Whole tiles further the picture is the same; u and v are multiples of
 * 1/1024, so that no bit is lost. */
static void
a_torus_repeats(void)
{
	struct bake_image img = noise(16, 32, 1);
	struct bake_relief_map *map = open_map(&img, torus);
	struct bake_rays r = fan(300, 0);
	float *first = malloc(300 * sizeof *first);

	for (int i = 0; i < r.n; i++) {
		r.du[i] = ldexpf(roundf(ldexpf(r.du[i], 6)), -6);
		r.dv[i] = ldexpf(roundf(ldexpf(r.dv[i], 6)), -6);
	}
	for (int s = 0; s < NSEARCHES; s++) {
		struct bake_march_params p = searches[s];

		/* steps of a power of two, so that places are exact */
		p.nlinear = p.nlinear > 8 ? 32 : 8;
		p.nbinary = 0;
		if (p.search == BAKE_SEARCH_TEXEL)
			p.nlinear = 16;
		bake_march(map, &p, &r);
		memcpy(first, r.hit, 300 * sizeof *first);
		for (int i = 0; i < r.n; i++) {
			r.u[i] += 3;
			r.v[i] -= 5;
		}
		bake_march(map, &p, &r);
		CHECK(memcmp(first, r.hit, 300 * sizeof *first) == 0);
		for (int i = 0; i < r.n; i++) {
			r.u[i] -= 3;
			r.v[i] += 5;
		}
	}
	free(first);
	bake_relief_map_close(map);
	bake_image_free(&img);
	free(r.u);
}

/* A wall of height 1/2, two texels wide, on flat ground: it stops what leaves
 * the relief beyond its crest. */
static void
a_wall_hides_low_light(void)
{
	struct bake_image img = flat(64, 64, 0.5f);
	struct bake_relief_map *map;
	struct bake_rays r = new_rays(16);

	for (int y = 0; y < 64; y++)
		img.data[y * 64 + 32] = img.data[y * 64 + 33] = 0;
	map = open_map(&img, torus);
	for (int i = 0; i < r.n; i++) {
		/* from the ground */
		r.u[i] = 17.0f / 64;
		r.v[i] = 0.5f;
		r.z[i] = 0.5f;
		r.dz[i] = -0.5f;
		/* the surface is reached at t = 1, after 3 to 33 texels: the
		 * crest begins after 15.5 */
		r.du[i] = (float)(2 * i + 3) / 64;
	}
	for (int s = 0; s < NSEARCHES; s++) {
		bake_march_any(map, &searches[s], 1e-5f, &r);
		for (int i = 0; i < r.n; i++) {
			/* 7 and 10 long steps may pass over the wall */
			if (searches[s].search == BAKE_SEARCH_LINEAR &&
			    searches[s].nlinear < 32)
				continue;
			CHECK(r.hit[i] == (2 * i + 3 > 15));
		}
	}
	bake_relief_map_close(map);
	bake_image_free(&img);
	free(r.u);
}

/* Flat ground does not hide itself even without a bias; a ray that is below it
 * by less than the bias is not hidden, by more it is. */
static void
the_bias_is_a_depth(void)
{
	struct bake_image img = flat(16, 16, 0.5f);
	struct bake_relief_map *map = open_map(&img, torus);
	struct bake_rays r = fan(64, 0.5f);

	for (int i = 0; i < r.n; i++)
		r.dz[i] = -0.5f;
	for (int s = 0; s < NSEARCHES; s++) {
		bake_march_any(map, &searches[s], 0, &r);
		for (int i = 0; i < r.n; i++)
			CHECK(r.hit[i] == 0);
	}
	for (int i = 0; i < r.n; i++)
		r.z[i] = i % 2 ? 0.515f : 0.505f;
	for (int s = 0; s < NSEARCHES; s++) {
		bake_march_any(map, &searches[s], 0.01f, &r);
		for (int i = 0; i < r.n; i++)
			CHECK(r.hit[i] == i % 2);
	}
	bake_relief_map_close(map);
	bake_image_free(&img);
	free(r.u);
}

static void
maps_of_one_texel_and_odd_sizes(void)
{
	static const int sizes[][2] = { { 1, 1 }, { 1, 5 }, { 2, 1 }, { 3, 17 },
		{ 65, 1 } };

	for (int k = 0; k < 10; k++) {
		const int w = sizes[k / 2][0], h = sizes[k / 2][1];
		struct bake_image img = flat(w, h, 0.25f);
		struct bake_relief_map *map =
		    open_map(&img, k % 2 ? clamped : torus);
		struct bake_rays r = fan(48, 0);

		for (int s = 0; s < NSEARCHES; s++) {
			bake_march(map, &searches[s], &r);
			for (int i = 0; i < r.n; i++)
				CHECK_NEAR(r.hit[i], 0.25, 1.0 / 16);
		}
		bake_relief_map_close(map);
		bake_image_free(&img);
		free(r.u);
	}
}

static void
maps_do_not_depend_on_threads(void)
{
	struct bake_image img = noise(61, 40, 1);
	struct bake_relief_map *a = open_map(&img, torus), *b;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_relief_map_open(&b, &img, torus, 7, &err), err);
	CHECK(a->top == b->top);
	CHECK(memcmp(a->cells, b->cells,
		  2 * (size_t)a->stride * 41 * sizeof *a->cells) == 0);
	for (int level = 1; level <= a->top; level++) {
		const size_t ny = (size_t)(40 >> level) + 1;

		CHECK(memcmp(a->lows[level], b->lows[level],
			  ny * (size_t)a->low_stride[level] * sizeof(float)) ==
		      0);
	}
	bake_relief_map_close(a);
	bake_relief_map_close(b);
	bake_image_free(&img);
}

static void
bad_maps_are_refused(void)
{
	struct bake_image img = flat(4, 4, 0), two = image(4, 4, 2), none;
	struct bake_relief_map *map;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_relief_map_open(&map, &two, torus, 1, &err) == BAKE_EINVAL);
	CHECK(map == NULL);
	CHECK(strcmp(err.msg, "a depth map has 1 channel, not 2") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	none = img;
	none.height = 0;
	CHECK(bake_relief_map_open(&map, &none, torus, 1, &err) == BAKE_EINVAL);
	err = (struct bake_err)BAKE_ERR_INIT;
	none.width = 1 << 23;
	none.height = 1;
	CHECK(bake_relief_map_open(&map, &none, torus, 1, &err) == BAKE_EINVAL);
	err = (struct bake_err)BAKE_ERR_INIT;
	none.width = none.height = 1 << 17;
	CHECK(bake_relief_map_open(&map, &none, torus, 1, &err) == BAKE_ENOMEM);
	err = (struct bake_err)BAKE_ERR_INIT;
	img.data[6] = NAN;
	CHECK(bake_relief_map_open(&map, &img, torus, 1, &err) == BAKE_EDATA);
	CHECK(map == NULL);
	CHECK(strcmp(err.msg, "the depth at (2, 1) is not finite") == 0);
	bake_relief_map_close(NULL);
	bake_image_free(&img);
	bake_image_free(&two);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(flat_ground_is_hit_at_its_depth),
		CASE(a_ramp_is_hit_where_lines_cross),
		CASE(vertical_rays_sample_the_map),
		CASE(a_ray_that_starts_on_or_below_hits_at_once),
		CASE(nothing_is_hit_beyond_the_end),
		CASE(bent_rays_meet_flat_ground),
		CASE(samples_at_centres_are_texels),
		CASE(borders_wrap_or_repeat),
		CASE(a_torus_repeats),
		CASE(a_wall_hides_low_light),
		CASE(the_bias_is_a_depth),
		CASE(maps_of_one_texel_and_odd_sizes),
		CASE(maps_do_not_depend_on_threads),
		CASE(bad_maps_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
