/* Meta-relief blends: exact copies, formulas in double, slopes, scales. */
/* SPDX-License-Identifier: MIT */
#include "combine.h"

#include "ao_rescale.h"
#include "check.h"
#include "test_maps.h"

/* A layer as it is given, its maps noise unless they are set. */
struct layer {
	struct bake_combine_layer how;
	struct bake_image maps;
};

static struct layer
new_layer(int w, int h, double weight, uint32_t seed)
{
	struct layer l = { { weight, weight, { 1, 1, 0, 0 }, 0.1, 0 },
		image(w, h, 4) };

	for (int i = 0; i < w * h; i++) {
		const double a = hash(seed + 3 * (uint32_t)i) % 6283 / 1000.0;
		const double r =
		    hash(seed + 3 * (uint32_t)i + 1) % 990 / 1000.0;
		float *t = l.maps.data + 4 * i;

		/* codes of 16 bits, as a file has them */
		t[0] =
		    (float)(floor((r * cos(a) + 1) / 2 * 65535 + 0.5) / 65535);
		t[1] =
		    (float)(floor((r * sin(a) + 1) / 2 * 65535 + 0.5) / 65535);
		t[2] =
		    (float)(hash(seed + 3 * (uint32_t)i + 2) % 65536 / 65535.0);
		t[3] = (float)(hash(seed + 9 * (uint32_t)i) % 65536 / 65535.0);
	}
	return l;
}

static struct bake_image
copy(const struct bake_image *src)
{
	struct bake_image img = image(src->width, src->height, src->nchans);

	memcpy(img.data, src->data, nfloats(src) * sizeof(float));
	return img;
}

static struct bake_combine_params
params_of(const struct layer *l, int n, int w, int h)
{
	struct bake_combine_params p = BAKE_COMBINE_PARAMS_DEFAULT;

	p.width = w;
	p.height = h;
	p.depth_scale = 0.1;
	p.nthreads = 1;
	for (int i = 0; i < n; i++) {
		p.nnormals += l[i].how.normal_weight > 0;
		p.normal_total += l[i].how.normal_weight;
		p.depth_total += l[i].how.depth_weight;
	}
	return p;
}

static struct bake_combined
blend(const struct bake_combine_params *p, const struct layer *l, int n)
{
	struct bake_combined out = BAKE_COMBINED_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_combine *c = NULL;

	CHECK_OK(bake_combine_open(&c, p, &err), err);
	for (int i = 0; i < n; i++) {
		struct bake_image maps = copy(&l[i].maps);

		CHECK_OK(bake_combine_add(c, &l[i].how, &maps, &err), err);
		bake_image_free(&maps);
	}
	CHECK_OK(bake_combine_finish(c, &out, &err), err);
	bake_combine_close(c);
	if (out.depth.data == NULL)
		abort();
	return out;
}

static void
free_layers(struct layer *l, int n)
{
	for (int i = 0; i < n; i++)
		bake_image_free(&l[i].maps);
}

/* -- formulas at equal size, in double ----------------------------------------
 */

struct vec {
	double x, y, z;
};

static struct vec
unit(double x, double y, double z)
{
	const double len = sqrt(x * x + y * y + z * z);
	const struct vec n = { x / len, y / len, z / len };

	return n;
}

static struct vec
normal_at(const struct layer *l, int i)
{
	const double x = 2.0 * l->maps.data[4 * i] - 1;
	const double y = 2.0 * l->maps.data[4 * i + 1] - 1;
	const struct vec n = { x, y, sqrt(1 - x * x - y * y) };

	return n;
}

/* One step of 'Blending in Detail', as the article has it, unpacked. */
static struct vec
published(enum bake_normal_blend how, struct vec a, struct vec b)
{
	if (how == BAKE_NORMAL_RNM) {
		const struct vec t = { a.x, a.y, a.z + 1 };
		const struct vec u = { -b.x, -b.y, b.z };
		const double dot = t.x * u.x + t.y * u.y + t.z * u.z;

		return unit(t.x / t.z * dot - u.x, t.y / t.z * dot - u.y,
		    t.z / t.z * dot - u.z);
	}
	return unit(
	    a.x + b.x, a.y + b.y, how == BAKE_NORMAL_UDN ? a.z : a.z * b.z);
}

static struct vec
expected(enum bake_normal_blend how, const struct bake_combine_params *p,
    const struct layer *l, int n, int i)
{
	struct vec sum = { 0, 0, 0 };

	for (int k = 0; k < n; k++) {
		const double w = l[k].how.normal_weight;
		struct vec v = normal_at(&l[k], i);

		if (how == BAKE_NORMAL_SEED) {
			sum.x += w * v.x;
			sum.y += w * v.y;
			sum.z += w * v.z;
		} else if (how == BAKE_NORMAL_PD) {
			const double s = p->depth_scale / l[k].how.depth_scale *
					 w / p->normal_total;

			sum.x += s * v.x / v.z;
			sum.y += s * v.y / v.z;
			sum.z = 1;
		} else {
			v = unit(w * v.x, w * v.y, v.z);
			sum = k == 0 ? v : published(how, sum, v);
		}
	}
	return unit(sum.x, sum.y, sum.z);
}

/*
 * Sums are kept as floats: a few ulps of 1 in each component, 3 codes of 65535
 * are asked for, and a tenth of one is held. A slope's error is that of a unit
 * vector's times at most its square: 1/z^2 = 50 here (r < 0.99).
 */
static void
normals_follow_their_formulas(void)
{
	enum { N = 3, W = 23, H = 17 };
	struct layer l[N] = { new_layer(W, H, 1, 1),
		new_layer(W, H, 0.3, 77777), new_layer(W, H, 0.55, 4242) };

	l[1].how.depth_scale = 0.04;
	l[2].how.depth_scale = 0.3;
	for (int b = BAKE_NORMAL_SEED; b <= BAKE_NORMAL_WHITEOUT; b++) {
		struct bake_combine_params p = params_of(l, N, W, H);
		struct bake_combined out;
		double worst = 0;

		p.normal_blend = (enum bake_normal_blend)b;
		p.depth_scale = 0.17;
		out = blend(&p, l, N);
		for (int i = 0; i < W * H; i++) {
			const float *got = out.normal.data + 3 * i;
			const struct vec n =
			    expected(p.normal_blend, &p, l, N, i);

			worst = fmax(worst, fabs(2.0 * got[0] - 1 - n.x));
			worst = fmax(worst, fabs(2.0 * got[1] - 1 - n.y));
			worst = fmax(worst, fabs(2.0 * got[2] - 1 - n.z));
		}
		CHECK_NEAR(worst, 0, 0.1 * 2 / 65535);
		bake_combined_free(&out);
	}
	free_layers(l, N);
}

static void
depth_and_occlusion_follow_their_formulas(void)
{
	enum { N = 3, W = 19, H = 8 };
	struct layer l[N] = { new_layer(W, H, 1, 5), new_layer(W, H, 0.3, 999),
		new_layer(W, H, 0, 31) };
	struct bake_combine_params p;
	struct bake_combined out;

	l[2].how.depth_weight = 0.7; /* depth alone: AO still counts */
	for (int b = 0; b < 2; b++) {
		p = params_of(l, N, W, H);
		p.ao_blend = b == 0 ? BAKE_AO_MULTIPLY : BAKE_AO_MIN;
		out = blend(&p, l, N);
		for (int i = 0; i < W * H; i++) {
			double d = 0, product = 1, least = 1;

			for (int k = 0; k < N; k++) {
				const float *t = l[k].maps.data + 4 * i;

				d += l[k].how.depth_weight * t[3];
				product *= t[2];
				least = fmin(least, t[2]);
			}
			/* two roundings of floats below 1 */
			CHECK_NEAR(out.depth.data[i], d / 2.0, 1.3e-7);
			CHECK_NEAR(
			    out.ao.data[i], b == 0 ? product : least, 1.3e-7);
		}
		bake_combined_free(&out);
	}
	free_layers(l, N);
}

/* -- copies --------------------------------------------------------------- */

/* Whole tile factors and offsets of whole texels: bits, not values. */
static void
texels_come_out_as_they_are(void)
{
	static const enum bake_normal_blend blends[] = { BAKE_NORMAL_SEED,
		BAKE_NORMAL_RNM, BAKE_NORMAL_UDN, BAKE_NORMAL_WHITEOUT };
	enum { W = 12, H = 10 };
	struct layer l = new_layer(W, H, 0.37, 11);

	l.maps.data[0] = l.maps.data[1] = 0.1234567f; /* no 16-bit code */
	for (int tile = 1; tile <= 3; tile++)
		for (int b = 0; b < 4; b++) {
			struct bake_combine_params p =
			    params_of(&l, 1, tile * W, tile * H);
			struct bake_combined out;
			size_t nbad = 0;

			/* RNM …: w k = 1 keeps the slopes */
			l.how.normal_weight = l.how.depth_weight = 1.0 / tile;
			p = params_of(&l, 1, tile * W, tile * H);
			p.normal_blend = blends[b];
			l.how.place =
			    (struct bake_placement){ tile, tile, 0.25, -0.3 };
			out = blend(&p, &l, 1);
			for (int y = 0; y < tile * H; y++)
				for (int x = 0; x < tile * W; x++) {
					/* right by 3 texels, down by 3 */
					const int u = (x + W - 3) % W;
					const int v = (y + H - 3) % H;
					const float *t =
					    l.maps.data + 4 * (v * W + u);
					const int i = y * tile * W + x;

					nbad += t[0] != out.normal.data[3 * i];
					nbad +=
					    t[1] != out.normal.data[3 * i + 1];
					nbad += t[2] != out.ao.data[i];
					nbad += t[3] != out.depth.data[i];
				}
			CHECK(nbad == 0);
			bake_combined_free(&out);
		}
	free_layers(&l, 1);
}

/* A layer of weight 0 changes no bit, whatever it holds and wherever it is. */
static void
weight_0_removes_a_layer(void)
{
	struct layer l[3] = { new_layer(9, 9, 1, 1), new_layer(5, 7, 0, 2),
		new_layer(9, 9, 0.4, 3) };
	struct layer two[2] = { l[0], l[2] };

	l[1].how.place.tile_u = 3.7;
	for (int b = BAKE_NORMAL_SEED; b <= BAKE_NORMAL_FROM_DEPTH; b++) {
		struct bake_combine_params p = params_of(l, 3, 9, 9);
		struct bake_combined with, without;

		p.normal_blend = (enum bake_normal_blend)b;
		with = blend(&p, l, 3);
		without = blend(&p, two, 2);
		CHECK(memcmp(with.normal.data, without.normal.data,
			  9 * 9 * 3 * 4) == 0);
		CHECK(memcmp(with.ao.data, without.ao.data, 9 * 9 * 4) == 0);
		CHECK(memcmp(with.depth.data, without.depth.data, 9 * 9 * 4) ==
		      0);
		bake_combined_free(&with);
		bake_combined_free(&without);
	}
	free_layers(l, 3);
}

/* -- slopes -----------------------------------------------------------------
 */

/* depth = 1/2 + a cos(2 pi m u) cos(2 pi n v), u to the right and v up, of a
 * square layer: slope of h = (1 - depth) S by u and by v. */
struct wave {
	double a;
	int m, n;
};

static double
wave_depth(const struct wave *w, double u, double v)
{
	return 0.5 + w->a * cos(2 * pi * w->m * u) * cos(2 * pi * w->n * v);
}

static void
wave_slopes(const struct wave *w, double scale, double u, double v, double *p,
    double *q)
{
	const double k = 2 * pi * w->a * scale;

	*p = k * w->m * sin(2 * pi * w->m * u) * cos(2 * pi * w->n * v);
	*q = k * w->n * cos(2 * pi * w->m * u) * sin(2 * pi * w->n * v);
}

static struct layer
wave_layer(const struct wave *w, int size, double weight, double scale)
{
	struct layer l = { { weight, weight, { 1, 1, 0, 0 }, scale, 0 },
		image(size, size, 4) };

	for (int y = 0; y < size; y++)
		for (int x = 0; x < size; x++) {
			const double u = (x + 0.5) / size;
			const double v = 1 - (y + 0.5) / size;
			float *t = l.maps.data + 4 * (y * size + x);
			double p, q;
			struct vec n;

			wave_slopes(w, scale, u, v, &p, &q);
			n = unit(-p, -q, 1);
			t[0] = (float)((n.x + 1) / 2);
			t[1] = (float)((n.y + 1) / 2);
			t[2] = 1;
			t[3] = (float)wave_depth(w, u, v);
		}
	return l;
}

static double
angle(const float *code, struct vec n)
{
	const double x = 2.0 * code[0] - 1, y = 2.0 * code[1] - 1,
		     z = 2.0 * code[2] - 1;
	const double cx = y * n.z - z * n.y, cy = z * n.x - x * n.z,
		     cz = x * n.y - y * n.x;

	return atan2(sqrt(cx * cx + cy * cy + cz * cz),
		   x * n.x + y * n.y + z * n.z) *
	       180 / pi;
}

/*
 * Two waves of other scales, tile factors and sizes, the second once copied
 * and once magnified: pd against the derivative of the blended depth at S in
 * closed form (0.2 degrees, as asked for; a copy is as good as a float), and
 * from-depth against the same within its own second-order error.
 */
static void
pd_is_the_slope_of_the_blended_depth(void)
{
	static const struct wave coarse = { 0.4, 2, 1 }, fine = { 0.3, 1, 2 };
	static const int sizes[] = { 64, 48 };
	static const double bounds[] = { 1e-3, 0.2 };
	const double S = 0.13, s0 = 0.1, s1 = 0.02, w0 = 1, w1 = 0.3, sum = 1.3;
	enum { SIZE = 256, TILE = 4 };

	for (int c = 0; c < 2; c++) {
		struct layer l[2] = { wave_layer(&coarse, SIZE, w0, s0),
			wave_layer(&fine, sizes[c], w1, s1) };
		struct bake_combine_params p = params_of(l, 2, SIZE, SIZE);
		double worst[2] = { 0, 0 };

		l[1].how.place = (struct bake_placement){ TILE, TILE, 0.5, 0 };
		p.depth_scale = S;
		for (int b = 0; b < 2; b++) {
			struct bake_combined out;

			p.normal_blend =
			    b == 0 ? BAKE_NORMAL_PD : BAKE_NORMAL_FROM_DEPTH;
			out = blend(&p, l, 2);
			for (int i = 0; i < SIZE * SIZE; i++) {
				const double u = (i % SIZE + 0.5) / SIZE;
				const double v = 1 - (i / SIZE + 0.5) / SIZE;
				double px, py, qx, qy;

				wave_slopes(&coarse, S, u, v, &px, &py);
				wave_slopes(&fine, S, TILE * u - 0.5, TILE * v,
				    &qx, &qy);
				px = (w0 * px + w1 * TILE * qx) / sum;
				py = (w0 * py + w1 * TILE * qy) / sum;
				worst[b] = fmax(
				    worst[b], angle(out.normal.data + 3 * i,
						  unit(-px, -py, 1)));
			}
			bake_combined_free(&out);
		}
		CHECK_NEAR(worst[0], 0, bounds[c]);
		CHECK_NEAR(worst[1], 0, 0.5);
		free_layers(l, 2);
	}
}

/* -- scales -----------------------------------------------------------------
 */

static void
scales_are_those_of_the_note(void)
{
	struct layer l[2] = { new_layer(8, 8, 1, 1), new_layer(8, 4, 0.3, 2) };
	struct bake_combine_params p = params_of(l, 2, 64, 64);
	struct bake_layer_scales s;

	p.depth_scale = 0.2;
	l[0].how.depth_scale = 0.1;
	s = bake_combine_scales(&p, &l[0].how, 8, 8);
	CHECK_NEAR(s.s, 0.2 / 0.1 / 1.3, 1e-15);
	CHECK_NEAR(s.keep, 0.1 * 1.3, 1e-15);
	/* 5.5 repeats along u and 11 along v keep its texels square */
	l[1].how.place = (struct bake_placement){ 5.5, 11, 0.1, 0.2 };
	l[1].how.depth_scale = 0.02;
	s = bake_combine_scales(&p, &l[1].how, 8, 4);
	CHECK_NEAR(s.s, 5.5 * 0.2 * 0.3 / (0.02 * 1.3), 1e-14);
	CHECK_NEAR(s.keep, 0.02 * 1.3 / (0.3 * 5.5), 1e-15);
	/* stretched: the geometric mean of 5.5 and 5.5 * 4 */
	l[1].how.place.tile_v = 44;
	s = bake_combine_scales(&p, &l[1].how, 8, 4);
	CHECK_NEAR(s.s, 11 * 0.2 * 0.3 / (0.02 * 1.3), 1e-14);
	l[1].how.depth_weight = 0;
	s = bake_combine_scales(&p, &l[1].how, 8, 4);
	CHECK(s.s == 0 && isinf(s.keep));
	free_layers(l, 2);
}

/* Each layer's AO by eq. 6 at its s, before the product. */
static void
occlusion_follows_the_scales(void)
{
	struct layer l[2] = { new_layer(8, 6, 1, 1), new_layer(4, 3, 0.3, 2) };
	struct bake_combine_params p = params_of(l, 2, 8, 6);
	struct bake_combined out;

	p.ao_rescale = true;
	p.depth_scale = 0.25;
	l[1].how.place = (struct bake_placement){ 2, 2, 0, 0 };
	out = blend(&p, l, 2);
	for (int y = 0; y < 6; y++)
		for (int x = 0; x < 8; x++) {
			const int i[2] = { y * 8 + x, y % 3 * 4 + x % 4 };
			const double s[2] = { 2.5 / 1.3, 2 * 2.5 * 0.3 / 1.3 };
			double ao = 1;

			for (int k = 0; k < 2; k++) {
				const double a = l[k].maps.data[4 * i[k] + 2];

				ao *= a / (s[k] * s[k] * (1 - a) + a);
			}
			CHECK_NEAR(out.ao.data[i[0]], ao, 1.3e-7);
		}
	bake_combined_free(&out);
	free_layers(l, 2);
}

/* AO of the blended depth is bake_ao's. */
static void
baked_occlusion_is_that_of_the_depth(void)
{
	struct layer l[2] = { new_layer(16, 16, 1, 1),
		new_layer(16, 16, 0.3, 2) };
	struct bake_combine_params p = params_of(l, 2, 16, 16);
	struct bake_ao_params ao = BAKE_AO_PARAMS_DEFAULT;
	struct bake_image want = BAKE_IMAGE_INIT;
	struct bake_ao_result result = { &want, NULL, NULL };
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_combined out;

	p.ao_blend = BAKE_AO_BAKE;
	out = blend(&p, l, 2);
	CHECK_OK(
	    bake_ao(&out.depth, &p.depth_scale, 1, &ao, &result, &err), err);
	CHECK(memcmp(want.data, out.ao.data, 16 * 16 * 4) == 0);
	bake_image_free(&want);
	bake_combined_free(&out);
	free_layers(l, 2);
}

/* -- sampling -----------------------------------------------------------------
 */

/*
 * 58 texels to one, as 4096 tiled 14.5 times over 1024. A wave of 8 texels has
 * 7.25 periods a texel of the result: sampled at points it would be a moire of
 * a quarter period a texel and full amplitude. White noise keeps its mean, and
 * of its variance the share (sum of squared weights)^2 = (int k^2 / 58)^2.
 */
static double
kernel_energy(void)
{
	const int n = 1 << 14;
	double sum = 0;

	for (int i = 0; i < 2 * n; i++) {
		const double t = (i + 0.5) / n;
		const double k =
		    t < 1 ? 1.5 * t * t * t - 2.5 * t * t + 1
			  : -0.5 * t * t * t + 2.5 * t * t - 4 * t + 2;

		sum += k * k;
	}
	return 2 * sum / n;
}

static void
minified_layers_show_no_moire(void)
{
	enum { SRC = 512, DST = 128 };
	struct layer l = new_layer(SRC, SRC, 1, 1);
	struct bake_combine_params p = params_of(&l, 1, DST, DST);
	struct bake_combined out;
	double sum = 0, square = 0, mean = 0, energy, amplitude = 0;

	for (int i = 0; i < SRC * SRC; i++) {
		mean += l.maps.data[4 * i + 3] / ((double)SRC * SRC);
		l.maps.data[4 * i + 2] =
		    (float)(0.5 + 0.5 * sin(2 * pi * (i % SRC) / 8));
	}
	l.how.place.tile_u = l.how.place.tile_v = 14.5;
	out = blend(&p, &l, 1);
	for (int i = 0; i < DST * DST; i++) {
		sum += out.depth.data[i];
		square += pow(out.depth.data[i] - mean, 2);
		amplitude = fmax(amplitude, fabs(out.ao.data[i] - 0.5));
	}
	sum /= DST * DST;
	square /= DST * DST;
	/* each texel is seen 14.5^2 times: the weights of all sum to a little
	 * more or less than they should, by the share that the last half
	 * repeat has, 1 / 29, of the mean's own deviation there */
	CHECK_NEAR(sum, mean, 5e-4);
	/* a variance of 128^2 values, of which neighbours share texels: 10 % */
	energy = kernel_energy() / 58;
	CHECK_NEAR(square / (energy * energy / 12), 1, 0.1);
	/* Catmull-Rom's side lobes beyond 7 periods */
	CHECK(amplitude < 0.5 * 2e-3);
	bake_combined_free(&out);
	free_layers(&l, 1);
}

/* Normals that agree with a depth before they are minified do so afterwards. */
static void
minified_normals_stay_those_of_the_depth(void)
{
	static const struct wave w = { 0.4, 3, 2 };
	struct layer l = wave_layer(&w, 256, 1, 0.3);
	struct bake_combine_params p = params_of(&l, 1, 64, 64);
	struct bake_combined slopes, derived;
	double worst = 0;

	p.depth_scale = 0.3;
	p.normal_blend = BAKE_NORMAL_PD;
	slopes = blend(&p, &l, 1);
	p.normal_blend = BAKE_NORMAL_FROM_DEPTH;
	derived = blend(&p, &l, 1);
	for (int i = 0; i < 64 * 64; i++) {
		const float *d = derived.normal.data + 3 * i;
		const struct vec n = { 2.0 * d[0] - 1, 2.0 * d[1] - 1,
			2.0 * d[2] - 1 };

		worst = fmax(worst, angle(slopes.normal.data + 3 * i, n));
	}
	/* central differences of 21 texels a period: (2 pi / 21)^2 / 6 of a
	 * slope of 2.3 at most */
	CHECK_NEAR(worst, 0, 1.0);
	bake_combined_free(&slopes);
	bake_combined_free(&derived);
	free_layers(&l, 1);
}

static void
threads_change_no_byte(void)
{
	struct layer l[2] = { new_layer(40, 30, 1, 1),
		new_layer(17, 23, 0.3, 2) };

	l[1].how.place = (struct bake_placement){ 2.5, 1.3, 0.1, 0.7 };
	for (int b = BAKE_NORMAL_SEED; b <= BAKE_NORMAL_FROM_DEPTH; b++) {
		struct bake_combine_params p = params_of(l, 2, 61, 47);
		struct bake_combined one;

		p.normal_blend = (enum bake_normal_blend)b;
		p.ao_rescale = true;
		one = blend(&p, l, 2);
		for (p.nthreads = 2; p.nthreads <= 7; p.nthreads += 5) {
			struct bake_combined many = blend(&p, l, 2);

			CHECK(memcmp(one.normal.data, many.normal.data,
				  61 * 47 * 3 * 4) == 0);
			CHECK(memcmp(one.ao.data, many.ao.data, 61 * 47 * 4) ==
			      0);
			CHECK(memcmp(one.depth.data, many.depth.data,
				  61 * 47 * 4) == 0);
			bake_combined_free(&many);
		}
		bake_combined_free(&one);
	}
	free_layers(l, 2);
}

/* A clamped result: a layer that covers it once does not wrap around. */
static void
clamped_results_do_not_wrap(void)
{
	struct layer l = new_layer(8, 8, 1, 1);
	struct bake_combine_params p = params_of(&l, 1, 16, 16);
	struct bake_combined out;

	for (int i = 0; i < 64; i++)
		l.maps.data[4 * i + 3] = i % 8 < 4 ? 0 : 1;
	out = blend(&p, &l, 1);
	CHECK(out.depth.data[0] > 0.1f);
	bake_combined_free(&out);
	p.wrap.clamp_u = p.wrap.clamp_v = true;
	out = blend(&p, &l, 1);
	CHECK(out.depth.data[0] == 0);
	bake_combined_free(&out);
	free_layers(&l, 1);
}

/* -- colour -----------------------------------------------------------------
 */

static void
colours_are_weighted_means(void)
{
	static const struct bake_placement once = { 1, 1, 0, 0 };
	struct bake_combine_params p = BAKE_COMBINE_PARAMS_DEFAULT;
	struct bake_image rgb = noise(6, 4, 3), grey = noise(3, 2, 2);
	struct bake_image sum = image(6, 4, 4);
	struct bake_placement twice = { 2, 2, 0, 0 };
	struct bake_err err = BAKE_ERR_INIT;

	memset(sum.data, 0, nfloats(&sum) * sizeof(float));
	CHECK_OK(bake_combine_add_map(&sum, &rgb, &once, 0.25, &p, &err), err);
	CHECK_OK(
	    bake_combine_add_map(&sum, &grey, &twice, 0.75, &p, &err), err);
	for (int i = 0; i < 24; i++) {
		const float *g = grey.data + 2 * (i / 6 % 2 * 3 + i % 6 % 3);

		for (int c = 0; c < 3; c++)
			CHECK_NEAR(sum.data[4 * i + c],
			    0.25 * rgb.data[3 * i + c] + 0.75 * g[0], 1e-7);
		/* without alpha is opaque */
		CHECK_NEAR(sum.data[4 * i + 3], 0.25 + 0.75 * g[1], 1e-7);
	}
	CHECK(bake_combine_add_map(&rgb, &sum, &once, -1, &p, &err) ==
	      BAKE_EINVAL);
	CHECK(bake_combine_add_map(&grey, &sum, &once, 1, &p, &err) ==
	      BAKE_EINVAL);
	bake_image_free(&rgb);
	bake_image_free(&grey);
	bake_image_free(&sum);
}

/* -- errors -----------------------------------------------------------------
 */

static void
bad_parameters_are_errors(void)
{
	struct layer l = new_layer(4, 4, 1, 1);
	const struct bake_combine_params good = params_of(&l, 1, 4, 4);
	struct bake_combine_params p[8];
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_combine *c = NULL;

	for (int i = 0; i < 8; i++)
		p[i] = good;
	p[0].width = 0;
	p[1].depth_scale = 0;
	p[2].depth_scale = NAN;
	p[3].depth_total = 0;
	p[4].normal_total = 0;
	p[5].normal_blend = (enum bake_normal_blend)6;
	p[6].ao_blend = (enum bake_ao_blend) - 1;
	p[7].depth_total = INFINITY;
	for (int i = 0; i < 8; i++) {
		err = (struct bake_err)BAKE_ERR_INIT;
		CHECK(bake_combine_open(&c, &p[i], &err) == BAKE_EINVAL);
		CHECK(c == NULL && err.msg[0] != '\0');
	}
	p[4].normal_blend = BAKE_NORMAL_FROM_DEPTH; /* needs no normals */
	CHECK_OK(bake_combine_open(&c, &p[4], &err), err);
	bake_combine_close(c);
	bake_combine_close(NULL);
	free_layers(&l, 1);
}

static void
bad_layers_are_errors(void)
{
	struct layer l = new_layer(4, 4, 1, 1);
	const struct bake_combine_params p = params_of(&l, 1, 4, 4);
	struct bake_combine_layer bad[8];
	struct bake_image three = image(4, 4, 3);
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_combine *c = NULL;

	CHECK_OK(bake_combine_open(&c, &p, &err), err);
	for (int i = 0; i < 8; i++)
		bad[i] = l.how;
	bad[0].normal_weight = -1;
	bad[1].depth_weight = NAN;
	bad[2].depth_scale = 0;
	bad[3].place.tile_u = 0;
	bad[4].place.tile_v = -2;
	bad[5].place.tile_u = INFINITY;
	bad[6].place.offset_u = NAN;
	bad[7].place.offset_v = INFINITY;
	for (int i = 0; i < 8; i++) {
		err = (struct bake_err)BAKE_ERR_INIT;
		CHECK(
		    bake_combine_add(c, &bad[i], &l.maps, &err) == BAKE_EINVAL);
		CHECK(err.msg[0] != '\0');
	}
	CHECK(bake_combine_add(c, &l.how, &three, &err) == BAKE_EINVAL);
	bake_combine_close(c);
	bake_image_free(&three);
	free_layers(&l, 1);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(normals_follow_their_formulas),
		CASE(depth_and_occlusion_follow_their_formulas),
		CASE(texels_come_out_as_they_are),
		CASE(weight_0_removes_a_layer),
		CASE(pd_is_the_slope_of_the_blended_depth),
		CASE(scales_are_those_of_the_note),
		CASE(occlusion_follows_the_scales),
		CASE(baked_occlusion_is_that_of_the_depth),
		CASE(minified_layers_show_no_moire),
		CASE(minified_normals_stay_those_of_the_depth),
		CASE(threads_change_no_byte),
		CASE(clamped_results_do_not_wrap),
		CASE(colours_are_weighted_means),
		CASE(bad_parameters_are_errors),
		CASE(bad_layers_are_errors),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
