/* Relief marching: where rays meet a depth map, by search or exactly. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MARCH_H
#define BAKE_MARCH_H

#include <stddef.h>

#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Rays in texture space, t being the length from where they start:
 *     u(t) = u + t du,  v(t) = v + t dv       in texture widths and heights;
 *                                             v grows upwards
 *     z(t) = z + t (dz - t q)                 depth, 0 surface .. 1 deepest
 * q = 0 on flat ground; else the quadric's bend (METHODS 4). A ray is followed
 * from t = 0 to t_end, where the caller has it leave the relief; both ends
 * count. Nothing is special about z = 0 and z = 1: a ray may start above the
 * surface or inside.
 *
 * Whoever sets t_end to where z = 1 lets it be a little more (1 + 2^-20 times
 * that): else z(t_end), rounded, can stay a bit below a floor of depth 1, and
 * the ray finds no ground. Beyond depth 1 nothing else can be hit.
 *
 * All arrays are the caller's, [n], aligned to BAKE_ALIGN and padded to a
 * multiple of 16 values (what the padding holds does not matter; that of hit
 * may be written). n >= 0.
 *   u, v      any; a float holds a place to 2^-24 of its size, so that near 0
 *             texels are divided more finely than many tiles away
 *   t_end     < 0 or NaN: the ray hits nothing; 0: only its start is looked at
 *   hit       out, see bake_march and bake_march_any
 * A ray with a number that is not finite gives some result of the sort that is
 * allowed.
 */
struct bake_rays {
	int n;
	float *u, *v, *z, *du, *dv, *dz, *q, *t_end;
	float *hit;
};

/*
 * A depth map made ready for marching: bilinear between texel centres, which
 * lie at u = (x + 1/2) / W, v = 1 - (y + 1/2) / H, row 0 at the top. It is
 * never changed once it is open: any number of threads may use it.
 */
struct bake_relief_map;

/*
 * Copy a depth map, as floats, 8 bytes a texel and a third of 4 for the least
 * depths of blocks (2 x 2 cells, 4 x 4, ...).
 *
 *   map    out: the caller's, freed by bake_relief_map_close; NULL on failure
 *   depth  1 channel, 0 .. 1 (others are taken as they are), sides 1 .. 2^22
 *   wrap   beyond 0 .. 1: a torus, or the border's value
 *
 * The kernels' instruction set (isa.h) is chosen here.
 *
 * BAKE_EINVAL  not one channel, or a side out of range
 * BAKE_EDATA   a texel is not finite; err says which
 * BAKE_ENOMEM  no memory, or (W + 2)(H + 1) does not fit in 32 bits
 *
 * Reentrant. The same for every nthreads (0: all processors).
 */
BAKE_API enum bake_status bake_relief_map_open(struct bake_relief_map **map,
    const struct bake_image *depth, struct bake_wrap wrap, int nthreads,
    struct bake_err *err);
BAKE_API void bake_relief_map_close(struct bake_relief_map *map); /* NULL: ok */

/*
 * d at n places: in single precision, as LINEAR and TEXEL see it.
 *
 *   u, v  [n], as in bake_rays; of any alignment, without padding
 *   d     out: [n] depths; it may be u or v
 *
 * Reentrant. The same bits for every instruction set.
 */
BAKE_API void bake_relief_map_sample(const struct bake_relief_map *map, int n,
    const float *u, const float *v, float *d);

/*
 * How to search. f(t) = z(t) - d(u(t), v(t)); the ray is below the relief where
 * f >= 0.
 *
 *   LINEAR  f at t = 0 and at the ends of n = nlinear equal steps,
 *           t_k = k (t_end / n), t_n = t_end, up to the first k where f >= 0;
 *           then nbinary times the half of (t_(k-1), t_k) in which f changes
 *           its sign; then, where `secant` is set, the place in what is left,
 *           (a, b), where the chord of f is 0: a + (b - a) f(a) / (f(a) -
 * f(b)); else b, which is in the relief. Misses what lies between two steps.
 *   TEXEL   the same with the t_k where the ray's faster axis passes the lines
 *           between texel centres, on which a bilinear map has its ridges. A
 *           ray that passes less than nlinear texels has n = nlinear equal
 *           steps; one that passes more than 65534, 65536 of them
 *   EXACT   the least t with f >= 0 in double precision, rounded to float:
 *           d is bilinear and the ray's way in (u, v) straight, so that f is
 *           quadratic in each cell between texel centres; cells are gone
 *           through in the ray's order, and blocks of them are passed at once
 *           where the ray is above their least depth. A touch without crossing
 *           counts if rounding lets it. A ray that passes more than 2^24
 *           texels is cut there. The parameters below are not used.
 *
 *   nlinear  1 .. 65536 (what is outside is taken as the nearer of them)
 *   nbinary  0 or more; below 0 is taken as 0
 *
 * Errors against EXACT, a plane with 1 / 10 of a width of relief seen at 35
 * degrees (bench_march; stone and bricks of testdata): another feature for
 * 32,6 at 0.5 to 0.7 % of the pixels, for TEXEL at 0.001 to 0.006 %; on the
 * same feature the 99th percentile of the depth error is 4.8e-4 (the last
 * interval) for 32,6 without the secant and 4e-6 with it, 6e-7 for TEXEL,6.
 *
 * Source: Policarpo, Oliveira, Comba 2005 (linear and binary search); EXACT:
 * own derivation, march_exact.c. METHODS 6.
 */
enum bake_search { BAKE_SEARCH_LINEAR, BAKE_SEARCH_TEXEL, BAKE_SEARCH_EXACT };
struct bake_march_params {
	enum bake_search search;
	int nlinear, nbinary;
	bool secant;
};
#define BAKE_MARCH_PARAMS_DEFAULT                                              \
	{                                                                      \
		BAKE_SEARCH_LINEAR, 32, 6, true                                \
	}

/*
 * First hits. rays->hit: t of the first place, as the search finds it, where
 * f(t) >= 0, in 0 .. t_end; 0 where the ray starts on or below the relief; -1
 * where there is none.
 *
 * Runs on the calling thread alone; threads may march different rays of one
 * map at once. The same bits for every instruction set, and for every way in
 * which rays are shared out among calls.
 */
BAKE_API void bake_march(const struct bake_relief_map *map,
    const struct bake_march_params *params, const struct bake_rays *rays);

/*
 * Whether the ray is below the relief anywhere: shadow rays, which begin on
 * the relief and go up (dz < 0) to t_end, where they leave it. rays->hit: 1
 * where f(t) > bias at one of the places that the search looks at (EXACT: at
 * any), t = 0 and t_end among them, else 0.
 *
 *   bias  depth by which z(t) may be below the map without being hidden. It
 *         covers the rounding of the start, 2^-24 |u| W texels times what d
 *         changes from one to the next, and the error of the search that
 *         found it: 1e-4 for EXACT or a secant on 1024 texels, 1e-3 without
 *
 * nbinary and secant are not used. Otherwise as bake_march.
 * Source: Policarpo et al. 2005; multilayer paper, section 3.1, light rays.
 */
BAKE_API void bake_march_any(const struct bake_relief_map *map,
    const struct bake_march_params *params, float bias,
    const struct bake_rays *rays);

#ifdef __cplusplus
}
#endif

#endif
