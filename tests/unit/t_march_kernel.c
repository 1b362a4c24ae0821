/* Tests of the kernels of relief marching: their bits, and odd rays. */
/* SPDX-License-Identifier: MIT */
#include "march_priv.h"

#include "check.h"
#include "test_march.h"

/* Rays of every kind, among them what no caller means to give. */
static struct bake_rays
wild_rays(int n)
{
	static const float odd[] = { NAN, INFINITY, -INFINITY, 1e30f, -1e30f,
		-0.0f, 1e-40f, 8388609.5f };
	struct bake_rays r = fan(n, 0);

	for (int i = 0; i < n; i++) {
		const uint32_t h = hash((uint32_t)i + 99);
		float *const field[] = { r.u, r.v, r.z, r.du, r.dv, r.dz, r.q,
			r.t_end };

		r.u[i] += (float)h * 1e-9f;
		r.z[i] = (float)(h % 7) * 0.1f - 0.2f;
		r.dz[i] = (float)(h % 5) * 0.5f - 0.5f;
		r.q[i] = (float)(h % 3) * 0.3f - 0.3f;
		r.t_end[i] = (float)(h % 11) * 0.3f;
		if (h % 4 == 0)
			field[h / 4 % 8][i] = odd[h / 32 % 8];
	}
	return r;
}

/* The last bit of every hit is that of the plain search; of a NaN only that
 * it is one. */
static bool
same_bits(const float *a, const float *b, int n)
{
	for (int i = 0; i < n; i++)
		if (memcmp(&a[i], &b[i], sizeof *a) != 0 &&
		    !(isnan(a[i]) && isnan(b[i])))
			return false;
	return true;
}

static void
compare_kernels(const struct bake_relief_map *map, const struct bake_rays *r)
{
	const size_t size = (size_t)r->n * sizeof(float);
	float *got = malloc(size);

	for (int s = 0; s < NSEARCHES; s++) {
		if (searches[s].search == BAKE_SEARCH_EXACT)
			continue;
		bake_march(map, &searches[s], r);
		memcpy(got, r->hit, size);
		bake_march_plain(map, &searches[s], r);
		CHECK(same_bits(got, r->hit, r->n));
		bake_march_any(map, &searches[s], 1e-3f, r);
		memcpy(got, r->hit, size);
		bake_march_any_plain(map, &searches[s], 1e-3f, r);
		CHECK(same_bits(got, r->hit, r->n));
	}
	bake_relief_map_sample(map, r->n, r->u, r->v, got);
	for (int i = 0; i < r->n; i++)
		r->hit[i] = bake_march_depth(map, r->u[i], r->v[i]);
	CHECK(same_bits(got, r->hit, r->n));
	free(got);
}

static void
kernels_give_the_bits_of_the_plain_search(void)
{
	static const char *const isas[] = { "baseline", "avx2", "avx512" };
	static const struct bake_wrap wraps[] = { { false, false },
		{ true, true }, { true, false }, { false, true } };
	struct bake_image img = noise(37, 23, 1);
	/* not a multiple of a vector */
	struct bake_rays wild = wild_rays(1003), usual;
	const struct view view = { 64, 48, 20, 0.1 };

	usual = rays_of_view(&view);
	for (int i = 0; i < 3; i++)
		for (int w = 0; w < 4; w++) {
			struct bake_relief_map *map;

			setenv("BAKE_ISA", isas[i], 1);
			map = open_map(&img, wraps[w]);
			compare_kernels(map, &wild);
			compare_kernels(map, &usual);
			bake_relief_map_close(map);
		}
	unsetenv("BAKE_ISA");
	bake_image_free(&img);
	free(wild.u);
	free(usual.u);
}

/* Whatever a ray holds, each search ends, and says something of the sort that
 * it may. */
static void
wild_rays_come_to_an_end(void)
{
	struct bake_image img = noise(5, 3, 1);
	struct bake_rays r = wild_rays(2000);

	for (int w = 0; w < 2; w++) {
		struct bake_relief_map *map =
		    open_map(&img, w ? clamped : torus);

		for (int s = 0; s < NSEARCHES; s++) {
			bake_march(map, &searches[s], &r);
			for (int i = 0; i < r.n; i++)
				CHECK(
				    r.hit[i] == -1 ||
				    (r.hit[i] >= 0 && r.hit[i] <= r.t_end[i]));
			bake_march_any(map, &searches[s], 0, &r);
			for (int i = 0; i < r.n; i++)
				CHECK(r.hit[i] == 0 || r.hit[i] == 1);
		}
		bake_relief_map_close(map);
	}
	bake_image_free(&img);
	free(r.u);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(kernels_give_the_bits_of_the_plain_search),
		CASE(wild_rays_come_to_an_end),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
