/* Tests of the exact march against brute force, and the table of errors. */
/* SPDX-License-Identifier: MIT */
#include "march.h"

#include "check.h"
#include "test_march.h"

static const struct bake_march_params exact = { BAKE_SEARCH_EXACT, 0, 0,
	false };

/* The definition of the relief, in double, from the image itself. */
struct oracle {
	const struct bake_image *img;
	struct bake_wrap wrap;
	double u, v, z, du, dv, dz, q;
};

static double
texel(const struct oracle *o, double x, double y)
{
	const int w = o->img->width, h = o->img->height;

	return o->img->data[bake_wrap_index((long)y, h, o->wrap.clamp_v) * w +
			    bake_wrap_index((long)x, w, o->wrap.clamp_u)];
}

static double
depth(const struct oracle *o, double u, double v)
{
	const double x = u * o->img->width - 0.5;
	const double y = (1 - v) * o->img->height - 0.5;
	const double i = floor(x), j = floor(y), fx = x - i, fy = y - j;

	return (1 - fy) *
		   ((1 - fx) * texel(o, i, j) + fx * texel(o, i + 1, j)) +
	       fy * ((1 - fx) * texel(o, i, j + 1) +
			fx * texel(o, i + 1, j + 1));
}

static double
below(const struct oracle *o, double t)
{
	return o->z + t * o->dz - t * t * o->q -
	       depth(o, o->u + t * o->du, o->v + t * o->dv);
}

static struct oracle
oracle_of(const struct bake_image *img, struct bake_wrap wrap,
    const struct bake_rays *r, int i)
{
	return (struct oracle){ img, wrap, r->u[i], r->v[i], r->z[i], r->du[i],
		r->dv[i], r->dz[i], r->q[i] };
}

/* Texels passed along both axes up to t = 1: also a bound for how fast the
 * depth of a map of range 1 changes along the ray. */
static double
texels_per_t(const struct oracle *o)
{
	return fabs(o->du) * o->img->width + fabs(o->dv) * o->img->height;
}

/* Steps of 1/64 texel, then bisection to the last bit of a double. It may miss
 * what is thinner than a step, but finds nothing that is not there. */
static double
brute_force(const struct oracle *o, double t_end)
{
	const double n = ceil(64 * (texels_per_t(o) * t_end + 1));
	double a = 0, b;

	if (below(o, 0) >= 0)
		return 0;
	for (double k = 1; k <= n; k++, a = b) {
		b = k == n ? t_end : t_end * k / n;
		if (below(o, b) < 0)
			continue;
		for (int i = 0; i < 60; i++) {
			const double t = 0.5 * (a + b);

			*(below(o, t) >= 0 ? &b : &a) = t;
		}
		return b;
	}
	return -1;
}

/*
 * A hit is a double rounded to float: it is off by 2^-24 of itself, and by
 * that times the speed of the two depths below or above the relief. Two
 * crossings closer than that are one. Where the ray only touches the relief,
 * rounding of the doubles decides.
 */
static void
check_hits(const struct bake_image *img, struct bake_wrap wrap,
    const struct bake_rays *r)
{
	struct bake_relief_map *map = open_map(img, wrap);
	int nhits = 0;

	bake_march(map, &exact, r);
	for (int i = 0; i < r->n; i++) {
		const struct oracle o = oracle_of(img, wrap, r, i);
		const double want = brute_force(&o, r->t_end[i]);
		const double got = r->hit[i], ulp = fabs(got) * 0x1p-24;
		const double speed =
		    fabs(o.dz) + fabs(2 * o.q * got) + texels_per_t(&o);

		nhits += got >= 0;
		if (want >= 0) {
			/* no first hit is missed */
			CHECK(got >= 0);
			CHECK(got <= want + ulp + 1e-11);
		}
		if (got >= 0 && (want < 0 || got < want - ulp - 1e-11))
			/* found between the oracle's steps: it is there */
			CHECK_NEAR(below(&o, got), 0, ulp * speed + 1e-11);
	}
	/* the test is of something */
	CHECK(nhits > r->n / 4);
	bake_relief_map_close(map);
}

/* Rays that start on the plane or above, in any direction, most of them
 * grazing; of each eight two are bent (many turn upwards before they end), one
 * is along an axis, one vertical. */
static struct bake_rays
some_rays(int n, double reach)
{
	struct bake_rays r = new_rays(n);

	for (int i = 0; i < n; i++) {
		const uint32_t h = hash((uint32_t)i + 31);
		const double angle = (double)(h % 100003) * 1e-3;
		const double far = reach * (1 + (double)(h % 17)) / 17;

		r.u[i] = (float)(h >> 8) * 0x1p-22f - 2;
		r.v[i] = (float)(hash(h) >> 8) * 0x1p-22f - 2;
		r.z[i] = h % 5 ? 0 : -0.3f;
		r.du[i] = (float)(far * cos(angle));
		r.dv[i] = (float)(far * sin(angle));
		r.t_end[i] = 1.25f;
		if (i % 8 == 1)
			r.q[i] = 0.4f + 0.3f * (float)(h % 4);
		if (i % 8 == 2)
			r.q[i] = -0.6f;
		if (i % 8 == 3)
			r.dv[i] = 0;
		if (i % 8 == 4)
			r.du[i] = r.dv[i] = 0;
	}
	return r;
}

static void
check_map(struct bake_image img, double reach, int n)
{
	struct bake_rays r = some_rays(n, reach);

	check_hits(&img, torus, &r);
	check_hits(&img, clamped, &r);
	bake_image_free(&img);
	free(r.u);
}

static void
exact_hits_noise_where_brute_force_does(void)
{
	check_map(noise(64, 64, 1), 0.6, 3000);
	/* no powers of two, and rays around the torus several times */
	check_map(noise(37, 19, 1), 3, 2000);
	check_map(noise(1, 5, 1), 2, 300);
	check_map(noise(3, 1, 1), 2, 300);
}

static void
exact_hits_walls_where_brute_force_does(void)
{
	check_map(brick_map(64), 1, 2000);
}

static void
exact_hits_smooth_ground_where_brute_force_does(void)
{
	check_map(smooth_map(96), 1, 2000);
}

static void
exact_hits_stone_where_brute_force_does(void)
{
	check_map(read_depth("testdata/stone_depth.png", false), 0.3, 1000);
}

/* Rays through texel centres and along the lines between them, where cells
 * meet: all places are multiples of half a texel, exact in float. */
static void
exact_hits_along_borders_of_cells(void)
{
	struct bake_image img = noise(32, 32, 1);
	struct bake_rays r = new_rays(4096);

	for (int i = 0; i < r.n; i++) {
		const uint32_t h = hash((uint32_t)i);

		r.u[i] = (float)(h % 256) / 64 - 2;
		r.v[i] = (float)(h / 256 % 256) / 64 - 2;
		r.du[i] = (float)((int)(h / 65536 % 5) - 2) / 2;
		r.dv[i] = (float)((int)(h / 65536 / 5 % 5) - 2) / 2;
		r.t_end[i] = 1.0f;
		/* some start on the relief itself */
		if (i % 16 == 0) {
			const struct oracle o = oracle_of(&img, torus, &r, i);

			r.z[i] = (float)depth(&o, o.u, o.v);
		}
	}
	check_hits(&img, torus, &r);
	check_hits(&img, clamped, &r);
	bake_image_free(&img);
	free(r.u);
}

/* Something is in the way where brute force, or the exact hit, finds it; a
 * touch closer than 1e-9 may go either way. */
static void
exact_shadows_are_those_of_brute_force(void)
{
	struct bake_image img = noise(48, 40, 1);
	struct bake_relief_map *map = open_map(&img, torus);
	struct bake_rays r = some_rays(3000, 0.4);
	const double bias = 0.01;
	int nhidden = 0;

	for (int i = 0; i < r.n; i++) {
		const struct oracle o = oracle_of(&img, torus, &r, i);

		/* upwards from the relief */
		r.z[i] = (float)depth(&o, o.u, o.v);
		r.dz[i] = -r.z[i];
		r.q[i] = 0;
		r.t_end[i] = 1;
	}
	bake_march_any(map, &exact, (float)bias, &r);
	for (int i = 0; i < r.n; i++) {
		const struct oracle o = oracle_of(&img, torus, &r, i);
		const double n = ceil(64 * (texels_per_t(&o) + 1));
		double most = -INFINITY;

		for (double k = 0; k <= n; k++)
			most = fmax(most, below(&o, k / n));
		if (most > bias + 1e-9)
			CHECK(r.hit[i] == 1);
		/* a maximum lies within half a step of 1/64 texel, over which
		 * the noise changes by at most 1/128 */
		if (most < bias - 1.0 / 128)
			CHECK(r.hit[i] == 0);
		nhidden += r.hit[i] == 1;
	}
	CHECK(nhidden > r.n / 10 && nhidden < r.n * 9 / 10);
	bake_relief_map_close(map);
	bake_image_free(&img);
	free(r.u);
}

struct errors {
	double wrong; /* share of pixels on another feature: off by > 0.01 */
	double p99;   /* of the depth errors on the same one */
};

static int
by_size(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static struct errors
measure(const struct bake_relief_map *map, const struct bake_rays *rays,
    const float *truth, const struct bake_march_params *params)
{
	double *e = malloc((size_t)rays->n * sizeof *e);
	int nwrong = 0, n = 0;
	struct errors errors;

	bake_march(map, params, rays);
	for (int i = 0; i < rays->n; i++) {
		const double d = fabs((double)rays->hit[i] - truth[i]);

		CHECK(rays->hit[i] >= 0);
		if (d > 0.01)
			nwrong++;
		else
			e[n++] = d;
	}
	qsort(e, (size_t)n, sizeof *e, by_size);
	errors.wrong = (double)nwrong / rays->n;
	errors.p99 = e[(size_t)n * 99 / 100];
	free(e);
	return errors;
}

/*
 * METHODS 6 on the project's own maps, the relief 0.1 deep. A step of 1/32
 * halved 6 times is 4.9e-4 long; the secant is wrong by the curvature and the
 * kinks within it. Bounds are METHODS' figures (0.7 % at 35 degrees) with half
 * as much again for other maps and another camera; for a step a texel they are
 * this camera's, whose upper rows are at 8 degrees where it looks at 14.
 */
static void
check_errors(const char *path)
{
	static const struct bake_march_params plain = { BAKE_SEARCH_LINEAR, 32,
		6, false };
	static const struct bake_march_params secant = { BAKE_SEARCH_LINEAR, 32,
		6, true };
	static const struct bake_march_params fine = { BAKE_SEARCH_TEXEL, 1, 6,
		true };
	struct bake_image img = read_depth(path, false);
	struct bake_relief_map *map = open_map(&img, torus);

	for (int k = 0; k < 2; k++) {
		const struct view view = { 160, 120, k ? 14 : 35, 0.1 };
		struct bake_rays r = rays_of_view(&view);
		float *truth = malloc((size_t)r.n * sizeof *truth);
		struct errors a, b, c;

		bake_march(map, &exact, &r);
		memcpy(truth, r.hit, (size_t)r.n * sizeof *truth);
		a = measure(map, &r, truth, &plain);
		b = measure(map, &r, truth, &secant);
		c = measure(map, &r, truth, &fine);
		CHECK(a.p99 > 2e-4 && a.p99 < 5e-4);
		CHECK(b.p99 < (k ? 6e-5 : 6e-6));
		CHECK(c.p99 < 4e-6);
		CHECK(b.wrong < (k ? 0.05 : 0.0105));
		CHECK(c.wrong < (k ? 0.0105 : 0.0075));
		CHECK(c.wrong <= b.wrong);
		free(truth);
		free(r.u);
	}
	bake_relief_map_close(map);
	bake_image_free(&img);
}

static void
searches_err_as_much_as_is_said(void)
{
	check_errors("testdata/stone_depth.png");
	check_errors("testdata/bricks_depth.png");
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(exact_hits_noise_where_brute_force_does),
		CASE(exact_hits_walls_where_brute_force_does),
		CASE(exact_hits_smooth_ground_where_brute_force_does),
		CASE(exact_hits_stone_where_brute_force_does),
		CASE(exact_hits_along_borders_of_cells),
		CASE(exact_shadows_are_those_of_brute_force),
		CASE(searches_err_as_much_as_is_said),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
