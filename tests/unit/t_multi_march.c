/* Tests of marching multilayer relief. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "test_multi_march.h"

static const struct bake_march_params exact = { BAKE_SEARCH_EXACT, 0, 0,
	false };

/* -- the oracle: is a point inside? ---------------------------------------- */

struct oracle {
	const struct bake_layer_maps *maps;
	struct bake_wrap wrap;
	double u, v, z, du, dv, dz, q;
};

/* Column or row, from the left or from v = 0; -1 outside. */
static int
cell_of(double u, int side, bool clamp)
{
	if (clamp && !(u >= 0 && u <= 1))
		return -1;
	if (!clamp)
		u -= floor(u);
	return u * side >= side ? side - 1 : (int)(u * side);
}

/* How many of the texel's depths are above z. */
static bool
inside(const struct oracle *o, double t)
{
	const struct bake_layer_maps *m = o->maps;
	const int x = cell_of(o->u + t * o->du, m->width, o->wrap.clamp_u);
	const int y = cell_of(o->v + t * o->dv, m->height, o->wrap.clamp_v);
	const double z = o->z + t * (o->dz - t * o->q);
	int n, above = 0;

	if (x < 0 || y < 0)
		return false;
	n = bake_layer_count(m, x, m->height - 1 - y);
	for (int i = 0; i < n; i++)
		above +=
		    z > (double)(float)bake_layer_depth((double)value_at(
			    &m->depth[i / 4], x, m->height - 1 - y, i % 4));
	return above % 2 != 0;
}

static struct oracle
oracle_of(const struct bake_layer_maps *maps, struct bake_wrap wrap,
    const struct bake_rays *r, int i)
{
	return (struct oracle){ maps, wrap, r->u[i], r->v[i], r->z[i], r->du[i],
		r->dv[i], r->dz[i], r->q[i] };
}

static double
texels_per_t(const struct oracle *o)
{
	return fabs(o->du) * o->maps->width + fabs(o->dv) * o->maps->height;
}

/* The first place inside of steps of 1/64 texel or of 1/1024 of depth, then
 * halved to the last bit; it may miss what is thinner, but finds nothing that
 * is not there. */
static double
brute_force(const struct oracle *o, double t_end)
{
	const double n =
	    ceil(64 * (texels_per_t(o) * t_end + 1) + 1024 * t_end);
	double a = 0, b;

	if (inside(o, 0))
		return 0;
	for (double k = 1; k <= n; k++, a = b) {
		b = k == n ? t_end : t_end * k / n;
		if (!inside(o, b))
			continue;
		for (int i = 0; i < 60; i++) {
			const double t = 0.5 * (a + b);

			*(inside(o, t) ? &b : &a) = t;
		}
		return b;
	}
	return -1;
}

/*
 * Hits are doubles rounded to float: off by 2^-24 of themselves. Just behind
 * the hit, within that and twice as much again, must be solid; a chord of less
 * than that is not looked for.
 */
static void
check_hits(const struct bake_layer_maps *maps, struct bake_wrap wrap,
    const struct bake_rays *r, double least_share)
{
	struct bake_multi_map *map = open_multi(maps, wrap);
	struct bake_multi_hits hits = new_hits(r->n);
	int nhits = 0, nthin = 0;

	bake_multi_march(map, &exact, r, &hits);
	for (int i = 0; i < r->n; i++) {
		const struct oracle o = oracle_of(maps, wrap, r, i);
		const double want = brute_force(&o, r->t_end[i]);
		const double got = r->hit[i], ulp = 0x1p-24 * fabs(got) + 1e-11;

		nhits += got >= 0;
		if (want >= 0) {
			/* no first hit is missed */
			CHECK(got >= 0);
			CHECK(got <= want + ulp);
		}
		/* found between the oracle's steps: it is there */
		if (got >= 0 && (want < 0 || got < want - ulp))
			nthin += !inside(&o, got + ulp) &&
				 !inside(&o, got + 4 * ulp) &&
				 !inside(&o, got - ulp);
	}
	/* chords of 4 ulp: of 1/64 texel none in a thousand */
	CHECK(nthin <= r->n / 1000);
	CHECK(nhits >= least_share * r->n);
	bake_multi_map_close(map);
	free(hits.nx);
}

/* -- maps and rays --------------------------------------------------------- */

/* Texels of 0 to nlayers layers of random depths and normals. */
static struct bake_layer_maps
random_maps(int w, int h, int nlayers, enum bake_data_format format)
{
	struct bake_layer_maps m =
	    layer_maps(w, h, nlayers, format, 0, 0, BAKE_DATA_UINT8);

	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			const uint32_t a = hash((uint32_t)(y * w + x) + 99);
			int n = (int)(a % (uint32_t)(nlayers / 2 + 1)) * 2;
			int code = 1;

			if (nlayers == 1)
				n = (int)(a % 4 != 0);
			for (int i = 0; i < n; i++) {
				const uint32_t b = hash(a + (uint32_t)i);
				const double nx = (b % 201) / 200.0 - 0.5;
				const double ny = (b / 201 % 201) / 200.0 - 0.5;

				/* thin ones too */
				code += 1 + (int)(b >> 8) %
						(b % 3 ? 250 / nlayers : 3);
				set_layer(&m, x, y, i, code / 255.0,
				    (double[3]){ nx, ny, 0 });
			}
		}
	return m;
}

/* In any direction, from before, behind and within; of each eight two are bent,
 * one is along an axis, one vertical, one level. */
static struct bake_rays
some_rays(int n, double reach)
{
	struct bake_rays r = new_rays(n);

	for (int i = 0; i < n; i++) {
		const uint32_t h = hash((uint32_t)i + 31);
		const double angle = (double)(h % 100003) * 1e-3;
		const double far = reach * (1 + (double)(h % 17)) / 17;
		const bool back = h % 3 == 0;

		r.u[i] = (float)(h >> 8) * 0x1p-22f - 2;
		r.v[i] = (float)(hash(h) >> 8) * 0x1p-22f - 2;
		if (h % 2) {
			r.u[i] = r.u[i] / 4 + 0.5f;
			r.v[i] = r.v[i] / 4 + 0.5f;
		}
		r.z[i] = h % 5 ? (back ? 1 : 0) : 0.3f;
		r.dz[i] = back ? -1 : 1;
		r.du[i] = (float)(far * cos(angle));
		r.dv[i] = (float)(far * sin(angle));
		r.t_end[i] = 1.25f;
		if (i % 8 == 1)
			r.q[i] = (0.4f + 0.3f * (float)(h % 4)) * r.dz[i];
		if (i % 8 == 2)
			r.q[i] = -0.6f * r.dz[i];
		if (i % 8 == 3)
			r.dv[i] = 0;
		if (i % 8 == 4)
			r.du[i] = r.dv[i] = 0;
		if (i % 8 == 5)
			r.dz[i] = 0, r.z[i] = (float)(h % 64) / 64;
	}
	return r;
}

static void
check_random(int w, int h, int nlayers, enum bake_data_format format,
    double reach, int n)
{
	struct bake_layer_maps m = random_maps(w, h, nlayers, format);
	struct bake_rays r = some_rays(n, reach);

	check_hits(&m, torus, &r, 0.25);
	check_hits(&m, clamped, &r, 0.05);
	bake_layer_maps_free(&m);
	free(r.u);
}

static void
exact_hits_where_brute_force_does(void)
{
	check_random(16, 16, 4, BAKE_DATA_UINT8, 0.6, 1500);
	check_random(32, 8, 2, BAKE_DATA_UINT16, 0.3, 1500);
	/* no powers of two, and around the torus several times */
	check_random(13, 7, 4, BAKE_DATA_FLOAT, 3, 1000);
	/* more than one quad; a height field */
	check_random(9, 11, 10, BAKE_DATA_HALF, 1, 1000);
	check_random(12, 12, 1, BAKE_DATA_UINT8, 1, 1000);
	check_random(1, 5, 4, BAKE_DATA_UINT8, 2, 300);
	check_random(3, 1, 64, BAKE_DATA_UINT16, 2, 300);
}

/* A few texels with much nothing between them, over several blocks. */
static void
exact_passes_empty_blocks_rightly(void)
{
	struct bake_layer_maps m =
	    layer_maps(75, 50, 2, BAKE_DATA_UINT8, 0, 0, BAKE_DATA_UINT8);
	struct bake_rays r = some_rays(1500, 2);

	for (int i = 0; i < 75 * 50; i++) {
		const uint32_t h = hash((uint32_t)i);

		if (h % 11 != 0)
			continue;
		set_layer(&m, i % 75, i / 75, 0, (10 + h / 11 % 100) / 255.0,
		    (double[3]){ 0, 0, 1 });
		set_layer(&m, i % 75, i / 75, 1, (115 + h / 1100 % 9) / 255.0,
		    (double[3]){ 0, 0, -1 });
	}
	check_hits(&m, torus, &r, 0.25);
	check_hits(&m, clamped, &r, 0.05);
	bake_layer_maps_free(&m);
	free(r.u);
}

/* Rays through corners and along borders; all numbers are exact. Borders
 * belong to the texel on their right and above where rays go along them. */
static struct bake_rays
border_rays(int n)
{
	struct bake_rays r = new_rays(n);

	for (int i = 0; i < n; i++) {
		const uint32_t h = hash((uint32_t)i);

		r.u[i] = (float)(h % 256) / 32 - 3;
		r.v[i] = (float)(h / 256 % 256) / 32 - 3;
		if (i % 2) {
			r.u[i] = (float)(h % 32) / 32;
			r.v[i] = (float)(h / 256 % 32) / 32;
		}
		r.du[i] = (float)((int)(h / 65536 % 9) - 4) / 4;
		r.dv[i] = (float)((int)(h / 65536 / 9 % 9) - 4) / 4;
		r.z[i] = (float)(h / 7 % 3) / 2;
		r.dz[i] = (float)((int)(h / 31 % 3) - 1);
	}
	return r;
}

/* Corners may be solid for the oracle alone, which sees points: it is asked a
 * little behind them. */
static void
exact_goes_along_borders(void)
{
	struct bake_layer_maps m = random_maps(16, 8, 4, BAKE_DATA_UINT8);
	struct bake_rays r = border_rays(4000);
	struct bake_multi_hits hits = new_hits(r.n);

	for (int k = 0; k < 2; k++) {
		const struct bake_wrap wrap = k ? clamped : torus;
		struct bake_multi_map *map = open_multi(&m, wrap);
		int nhits = 0;

		bake_multi_march(map, &exact, &r, &hits);
		for (int i = 0; i < r.n; i++) {
			struct oracle o = oracle_of(&m, wrap, &r, i);
			double first = -1;

			/* middles of 1024 steps: never on a border that is
			 * crossed (texels of 1/16, steps of 1/4 of u) */
			for (int s = 0; s < 1024 && first < 0; s++)
				if (inside(&o, (s + 0.5) / 1024))
					first = (s + 0.5) / 1024;
			nhits += r.hit[i] >= 0;
			if (first >= 0) {
				CHECK(r.hit[i] >= 0);
				CHECK((double)r.hit[i] <= first);
			}
			if (r.hit[i] >= 0 &&
			    (first < 0 ||
				(double)r.hit[i] < first - 1.0 / 1024))
				CHECK(inside(&o, (double)r.hit[i] + 1e-6) ||
				      inside(&o, (double)r.hit[i] - 1e-6));
		}
		CHECK(nhits > r.n / (k ? 20 : 8));
		bake_multi_map_close(map);
	}
	bake_layer_maps_free(&m);
	free(r.u);
	free(hits.nx);
}

/* The same line from its other end hits where that does: starts and directions
 * are exact, so that it is the same line. */
static void
front_and_back_see_one_hull(void)
{
	struct bake_layer_maps m = random_maps(24, 20, 4, BAKE_DATA_UINT8);
	struct bake_rays a = new_rays(4000), b = new_rays(a.n);
	struct bake_multi_hits hits = new_hits(a.n);

	for (int i = 0; i < a.n; i++) {
		const uint32_t h = hash((uint32_t)i), g = hash(h);

		a.u[i] = (float)(h % 4096) / 2048;
		a.v[i] = (float)(h / 4096 % 4096) / 2048;
		a.du[i] = (float)((int)(g % 1024) - 512) / 2048;
		a.dv[i] = (float)((int)(g / 1024 % 1024) - 512) / 2048;
		a.q[i] = i % 3 ? 0 : (float)(h % 8) / 8;
		b.u[i] = a.u[i] + a.du[i];
		b.v[i] = a.v[i] + a.dv[i];
		b.du[i] = -a.du[i];
		b.dv[i] = -a.dv[i];
		/* z(1 - s) */
		b.z[i] = a.z[i] + a.dz[i] - a.q[i];
		b.dz[i] = 2 * a.q[i] - a.dz[i];
		b.q[i] = a.q[i];
	}
	for (int k = 0; k < 2; k++) {
		struct bake_multi_map *map =
		    open_multi(&m, k ? clamped : torus);
		int nhits = 0;

		bake_multi_march(map, &exact, &a, &hits);
		bake_multi_march(map, &exact, &b, &hits);
		for (int i = 0; i < a.n; i++) {
			CHECK((a.hit[i] >= 0) == (b.hit[i] >= 0));
			nhits += a.hit[i] >= 0;
			if (a.hit[i] >= 0)
				CHECK(a.hit[i] <= 1 - b.hit[i] + 0x1p-23f);
		}
		CHECK(nhits > a.n / 10 && nhits < a.n);
		bake_multi_map_close(map);
	}
	bake_layer_maps_free(&m);
	free(a.u);
	free(b.u);
	free(hits.nx);
}

/* -- closed forms ---------------------------------------------------------- */

/* A plate between depths 1/4 and 3/4 of columns 2 and 3 of four. */
static struct bake_layer_maps
plate(void)
{
	struct bake_layer_maps m =
	    layer_maps(4, 1, 2, BAKE_DATA_FLOAT, 0, 0, BAKE_DATA_UINT8);

	for (int x = 2; x < 4; x++) {
		set_layer(&m, x, 0, 0, bake_layer_stored(0.25),
		    (double[3]){ 0, 0.6, 0.8 });
		set_layer(&m, x, 0, 1, bake_layer_stored(0.75),
		    (double[3]){ 0.6, 0, -0.8 });
	}
	return m;
}

static void
a_plate_is_hit_where_it_is(void)
{
	/* u, z, du, dz; t, layer: 1e-7 is what d' in float leaves */
	static const double cases[][6] = {
		{ 0.6, 0, 0, 1, 0.25, 0 },  /* from before */
		{ 0.6, 1, 0, -1, 0.25, 1 }, /* from behind */
		{ 0.6, 0.4, 0, 1, 0, 0 },   /* within */
		{ 0.6, 0.7, 0, -1, 0, 1 },
		{ 0, 0.3, 1, 0, 0.5, 0 }, /* its wall */
		{ 0, 0.7, 1, 0, 0.5, 1 },
		{ 0.25, 0.7, -1, 0, 0.25, 1 }, /* across the torus' border */
		{ 0, 0.1, 1, 0, -1, 0 },       /* over it */
		{ 0, 0.8, 1, 0, -1, 0 },       /* under it */
		{ 0.1, 0, 0, 1, -1, 0 },       /* beside it */
		{ 0.25, 0, 1, 0.5, 0.5, 0 },   /* to its edge and in */
	};
	enum { N = sizeof cases / sizeof *cases };
	static const struct bake_march_params all[] = {
		{ BAKE_SEARCH_EXACT, 0, 0, false },
		{ BAKE_SEARCH_TEXEL, 8, 24, false },
		{ BAKE_SEARCH_LINEAR, 64, 20, false },
		{ BAKE_SEARCH_LINEAR, 64, 20, true },
	};
	struct bake_layer_maps m = plate();
	struct bake_multi_map *map = open_multi(&m, torus);
	struct bake_rays r = new_rays(N);
	struct bake_multi_hits h = new_hits(N);

	for (int i = 0; i < N; i++) {
		r.u[i] = (float)cases[i][0];
		r.z[i] = (float)cases[i][1];
		r.du[i] = (float)cases[i][2];
		r.dz[i] = (float)cases[i][3];
		r.v[i] = 0.5f;
	}
	for (int k = 0; k < 4; k++) {
		bake_multi_march(map, &all[k], &r, &h);
		for (int i = 0; i < N; i++) {
			CHECK_NEAR(r.hit[i], cases[i][4], 3e-7);
			if (r.hit[i] < 0)
				continue;
			CHECK(h.layer[i] == (int)cases[i][5]);
			CHECK_NEAR(h.nx[i], h.layer[i] ? 0.6 : 0, 1e-6);
			CHECK_NEAR(h.ny[i], h.layer[i] ? 0 : 0.6, 1e-6);
			CHECK_NEAR(h.nz[i], h.layer[i] ? -0.8 : 0.8, 1e-6);
			CHECK(h.u[i] == 0.625f || h.u[i] == 0.875f);
			CHECK(h.v[i] == 0.5f);
		}
	}
	bake_multi_map_close(map);
	bake_layer_maps_free(&m);
	free(r.u);
	free(h.nx);
}

/* Paper, figure 6: into the bottom of a U, whose inner sides only the texel
 * outside has; and layers of a steep sheet, which the wall stands for. */
static void
walls_have_the_layer_that_they_join(void)
{
	/* stored depths of two texels; then z, and which texel and layer */
	static const double from[][4] = { { 0.1, 0.3, 0.6, 0.8 },
		{ 0.45, 0.9, 1, 1 }, { 0.05, 0.4, 1, 1 }, { 1, 1, 1, 1 },
		{ 0.7, 0.9, 1, 1 } };
	static const double to[][2] = { { 0.1, 0.8 }, { 0.2, 0.55 },
		{ 0.3, 0.8 }, { 0.4, 0.6 }, { 0.2, 0.5 } };
	static const struct {
		int set;
		double z;
		int x, layer;
	} want[] = { { 0, 0.4, 0, 1 }, { 0, 0.5, 0, 2 },
		/* the entry's sheet, though the exit, 0.55, is nearer to it
		 * than the entry of the texel that is hit, 0.2 */
		{ 1, 0.4, 0, 0 }, { 1, 0.3, 1, 0 },
		/* the exit's sheet */
		{ 2, 0.45, 0, 1 }, { 2, 0.7, 1, 1 },
		/* a rim, and one with another body behind */
		{ 3, 0.45, 1, 0 }, { 3, 0.55, 1, 1 }, { 4, 0.45, 1, 1 } };

	for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
		struct bake_layer_maps m =
		    layer_maps(2, 1, 4, BAKE_DATA_FLOAT, 0, 0, BAKE_DATA_UINT8);
		struct bake_rays r = new_rays(1);
		struct bake_multi_hits h = new_hits(1);
		struct bake_multi_map *map;

		for (int k = 0; k < 4; k++)
			set_value(
			    &m.depth[0], 0, 0, k, (float)from[want[i].set][k]);
		for (int k = 0; k < 2; k++)
			set_value(
			    &m.depth[0], 1, 0, k, (float)to[want[i].set][k]);
		map = open_multi(&m, clamped);
		r.u[0] = 0.25f;
		r.v[0] = 0.5f;
		r.z[0] = (float)bake_layer_depth(want[i].z);
		r.du[0] = 1;
		r.dz[0] = 0;
		bake_multi_march(map, &exact, &r, &h);
		CHECK_NEAR(r.hit[0], 0.25, 0);
		CHECK(h.u[0] == (want[i].x ? 0.75f : 0.25f));
		CHECK(h.layer[0] == want[i].layer);
		bake_multi_map_close(map);
		bake_layer_maps_free(&m);
		free(r.u);
		free(h.nx);
	}
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(exact_hits_where_brute_force_does),
		CASE(exact_passes_empty_blocks_rightly),
		CASE(exact_goes_along_borders),
		CASE(front_and_back_see_one_hull),
		CASE(a_plate_is_hit_where_it_is),
		CASE(walls_have_the_layer_that_they_join),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
