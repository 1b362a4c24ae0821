/* The A-buffer: closed forms, what must not matter, and errors. */
/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include "test_abuffer.h"

static const struct bake_abuffer_params closed = BAKE_ABUFFER_PARAMS_DEFAULT;
static const struct bake_abuffer_params reorient = { 0, true };

static struct bake_view
square(int side, double half)
{
	struct bake_view v = { BAKE_AXIS_POS_Z, side, side, -half, -half, half,
		half, half, -half, false, false };

	return v;
}

static struct layers
make(const struct bake_mesh *m, const struct bake_view *v)
{
	return layers_make(m, v, &closed, BAKE_BAND_ROWS);
}

/* How many texels differ: in number of layers, in anything that is not depth,
 * or by more than tol in depth. */
static size_t
count_different(
    const struct layers *a, const struct layers *b, size_t texels, double tol)
{
	size_t n = 0;

	for (size_t i = 0; i < texels; i++) {
		const struct bake_crossing *c, *d;
		size_t k = layers_at(a, i, &c);
		bool same = k == layers_at(b, i, &d);

		for (; same && k > 0; k--, c++, d++)
			same = fabs(c->depth - d->depth) <= tol &&
			       c->entering == d->entering &&
			       c->triangle == d->triangle &&
			       c->tile_x == d->tile_x && c->tile_y == d->tile_y;
		n += !same;
	}
	return n;
}

static bool
same_stats(
    const struct bake_abuffer_stats *a, const struct bake_abuffer_stats *b)
{
	return a->open == b->open && a->inside_out == b->inside_out &&
	       a->united == b->united && a->crossings == b->crossings &&
	       a->most == b->most;
}

/* A torus that stands askew, so that no edge meets a texel's centre. */
static struct bake_mesh
askew_torus(void)
{
	const double c = 0.5646424733950354, s = 0.8253356149096783;
	const double turn[3][3] = { { c, -s * c, s * s }, { s, c * c, -c * s },
		{ 0, s, c } };
	const double shift[3] = { 0.01234, -0.0213, 0.0071 };
	struct bake_mesh m = solid_torus(1, 0.35, 48, 24);

	solid_map(&m, turn, shift);
	return m;
}

/* -- closed forms -------------------------------------------------------- */

static void
a_cube_through_its_diagonals_is_whole(void)
{
	const double lo[3] = { -1, -1, -1 }, hi[3] = { 1, 1, 1 };
	struct bake_mesh m = solid_box(lo, hi);

	for (int a = 0; a < 6; a++)
		for (int side = 1; side <= 33; side += 4) {
			struct bake_view v = square(side, 1);
			struct layers l;
			size_t bad = 0;

			v.axis = (enum bake_axis)a;
			l = make(&m, &v);
			for (size_t i = 0; i < (size_t)(side * side); i++) {
				const struct bake_crossing *c;

				bad += layers_at(&l, i, &c) != 2 ||
				       c[0].depth != 0 || c[1].depth != 1;
			}
			CHECK(bad == 0);
			CHECK(l.stats.open == 0 && l.stats.inside_out == 0);
			CHECK(l.stats.united == 0 && l.stats.most == 2);
			layers_free(&l);
		}
	bake_mesh_free(&m);
}

/* The least distance of a triangle's plane from 0. */
static double
inner_radius(const struct bake_mesh *m)
{
	double least = INFINITY;

	for (size_t t = 0; t < m->ntriangles; t++) {
		const double *p[3];
		double n[3], d = 0, l2 = 0;

		for (int k = 0; k < 3; k++)
			p[k] = m->positions[m->triangles[t][k].v];
		for (int k = 0; k < 3; k++) {
			int i = (k + 1) % 3, j = (k + 2) % 3;

			n[k] = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) -
			       (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
			l2 += n[k] * n[k];
		}
		for (int k = 0; k < 3; k++)
			d += n[k] * p[0][k];
		least = fmin(least, d / sqrt(l2));
	}
	return least;
}

/* Vertices move by up to 2^-17 texel in x and y. */
static double
snapping(const struct bake_view *v)
{
	return sqrt(2) * (v->x1 - v->x0) / v->width / 131072;
}

static void
place_of(const struct bake_view *v, size_t i, const struct bake_crossing *c,
    double p[3])
{
	size_t x = i % (size_t)v->width, y = i / (size_t)v->width;

	p[0] = v->x0 + ((double)x + 0.5) * (v->x1 - v->x0) / v->width;
	p[1] = v->y1 - ((double)y + 0.5) * (v->y1 - v->y0) / v->height;
	p[2] = v->near - c->depth * (v->near - v->far);
}

static void
a_sphere_is_where_it_is(void)
{
	const double zero[3] = { 0, 0, 0 };
	struct bake_mesh m = solid_sphere(zero, 1, 512, 256);
	double inside = inner_radius(&m);

	for (int a = 0; a < 6; a++) {
		struct bake_view v = square(100, 1.1);
		struct layers l;
		size_t bad = 0, odd = 0;
		double eps;

		v.axis = (enum bake_axis)a;
		l = make(&m, &v);
		eps = snapping(&v);
		CHECK(eps < 1e-6 * (v.near - v.far));
		for (size_t i = 0; i < 10000; i++) {
			const struct bake_crossing *c, none = { 0 };
			size_t n = layers_at(&l, i, &c);
			double p[3], rho;

			place_of(&v, i, &none, p);
			rho = sqrt(p[0] * p[0] + p[1] * p[1]);
			odd += rho < inside - eps ? n != 2
			       : rho > 1 + eps    ? n != 0
						  : n != 0 && n != 2;
			for (size_t k = 0; k < n; k++) {
				double r;

				place_of(&v, i, &c[k], p);
				r = sqrt(rho * rho + p[2] * p[2]);
				bad += !(r > inside - eps && r < 1 + eps) ||
				       (k == 0) != (p[2] > 0);
			}
		}
		CHECK(bad == 0);
		CHECK(odd == 0);
		CHECK(l.stats.open == 0 && l.stats.inside_out == 0);
		layers_free(&l);
	}
	bake_mesh_free(&m);
}

static void
a_torus_is_where_it_is(void)
{
	const int around = 512, sides = 256;
	struct bake_mesh m = solid_torus(1, 0.35, 512, 256);
	/* chords are as much nearer to the axis, and to the tube's middle */
	const double chords = 1.35 * (1 - cos(SOLID_TURN / 2 / around)) +
			      0.35 * (1 - cos(SOLID_TURN / 2 / sides));

	for (int a = 0; a < 6; a++) {
		struct bake_view v = square(100, 1.4);
		struct bake_axes axes = bake_axis_axes((enum bake_axis)a);
		struct layers l;
		size_t bad = 0;

		v.axis = (enum bake_axis)a;
		l = make(&m, &v);
		for (size_t i = 0; i < 10000; i++) {
			const struct bake_crossing *c;
			size_t n = layers_at(&l, i, &c);

			for (size_t k = 0; k < n; k++) {
				double q[3], p[3], rho;

				place_of(&v, i, &c[k], q);
				for (int j = 0; j < 3; j++)
					p[axes.index[j]] = axes.sign[j] * q[j];
				rho = sqrt(p[0] * p[0] + p[1] * p[1]) - 1;
				bad += !(fabs(sqrt(rho * rho + p[2] * p[2]) -
					      0.35) <= chords + snapping(&v));
			}
		}
		CHECK(bad == 0);
		CHECK(l.stats.open == 0 && l.stats.inside_out == 0);
		CHECK(l.stats.most == (a / 2 == 2 ? 2 : 4));
		layers_free(&l);
	}
	bake_mesh_free(&m);
}

/* A triangle that is far larger than the picture, and its lid. */
static void
huge_triangles_are_exact(void)
{
	const double far_away = 1 << 24;
	struct bake_view v = square(16, 8);
	struct bake_mesh m = solid_alloc(4, 4);
	struct layers l;
	size_t bad = 0;

	for (int side = 0; side < 2; side++) {
		const double at[4][3] = { { -far_away, -far_away, -far_away },
			{ 3 * far_away, -far_away, far_away },
			{ -far_away, 3 * far_away, 1.5 }, { 1, 2, -1e9 } };
		/* z of the plane of the first three */
		const double gx = 0.5, gy = (1.5 + far_away) / (4 * far_away);

		memcpy(m.positions, at, sizeof at);
		solid_triangle(&m, 0, 0, 1, 2);
		solid_triangle(&m, 1, 1, 0, 3);
		solid_triangle(&m, 2, 2, 1, 3);
		solid_triangle(&m, 3, 0, 2, 3);
		v.near = far_away;
		v.far = -far_away;
		v.axis = side ? BAKE_AXIS_NEG_Z : BAKE_AXIS_POS_Z;
		l = make(&m, &v);
		for (size_t i = 0; i < 256; i++) {
			const struct bake_crossing *c;
			double p[3], x, z;

			if (layers_at(&l, i, &c) != 2) {
				bad++;
				continue;
			}
			place_of(&v, i, &c[side], p);
			x = side ? -p[0] : p[0];
			z = -far_away + gx * (x + far_away) +
			    gy * (p[1] + far_away);
			/* a few roundings of numbers of 3 2^24 */
			bad += !(fabs((side ? -p[2] : p[2]) - z) <= 1e-7);
		}
		CHECK(bad == 0);
		CHECK(l.stats.open == 0);
		layers_free(&l);
	}
	bake_mesh_free(&m);
}

/* -- what must not matter ------------------------------------------------ */

static void
turning_the_mesh_turns_the_picture(void)
{
	const double turn[3][3] = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 1 } };
	const double zero[3] = { 0, 0, 0 };
	const int side = 96;
	struct bake_view v = square(side, 1.5);
	struct bake_mesh m = askew_torus();
	struct layers l = make(&m, &v), r;
	size_t bad = 0;

	solid_map(&m, turn, zero);
	r = make(&m, &v);
	for (int i = 0; i < side * side; i++) {
		const struct bake_crossing *c, *d;
		/* (x, y) with y upwards goes to (-y, x) */
		int x = i % side, y = i / side;
		size_t n = layers_at(&l, (size_t)i, &c);
		size_t k =
		    layers_at(&r, (size_t)((side - 1 - x) * side + y), &d);

		bad += n != k;
		/* a few roundings, in another order */
		for (k = 0; n == k && k < n; k++)
			bad += !(fabs(c[k].depth - d[k].depth) <= 1e-14) ||
			       c[k].triangle != d[k].triangle;
	}
	CHECK(bad == 0);
	CHECK(l.n == r.n && l.n > 4000 && l.stats.most == 4);
	layers_free(&l);
	layers_free(&r);
	bake_mesh_free(&m);
}

static struct bake_view
mapped(struct bake_view v, double scale, const double shift[3])
{
	v.x0 = scale * v.x0 + shift[0];
	v.x1 = scale * v.x1 + shift[0];
	v.y0 = scale * v.y0 + shift[1];
	v.y1 = scale * v.y1 + shift[1];
	v.near = scale * v.near + shift[2];
	v.far = scale * v.far + shift[2];
	return v;
}

/* By powers of 2 bit by bit; else to rounding, which would move a vertex by
 * 2^-16 texel if it were within 1e-8 of that of half of it. */
static void
scaling_and_moving_change_nothing(void)
{
	static const struct {
		double scale, shift[3], tol;
	} map[] = {
		{ 1024, { 0, 0, 0 }, 0 },
		{ 1. / 4096, { 0, 0, 0 }, 0 },
		{ 1, { 5, -7, 3 }, 1e-13 },
		{ 3.7, { 0, 0, 0 }, 1e-13 },
		{ 0.1, { 1.1, 2.2, 3.3 }, 1e-13 },
	};
	const struct bake_view v = square(96, 1.5);
	struct bake_mesh m = askew_torus();
	struct layers l = make(&m, &v);

	for (size_t i = 0; i < sizeof map / sizeof *map; i++) {
		const double s = map[i].scale;
		const double matrix[3][3] = { { s, 0, 0 }, { 0, s, 0 },
			{ 0, 0, s } };
		struct bake_mesh n = askew_torus();
		struct bake_view w = mapped(v, s, map[i].shift);
		struct layers k;

		solid_map(&n, matrix, map[i].shift);
		k = make(&n, &w);
		CHECK(count_different(&l, &k, 96 * 96, map[i].tol) == 0);
		layers_free(&k);
		bake_mesh_free(&n);
	}
	layers_free(&l);
	bake_mesh_free(&m);
}

static void
bands_and_threads_do_not_matter(void)
{
	const int rows[] = { 1, 7, 63, 65, 150 };
	struct bake_view v = square(150, 1.2);
	struct bake_mesh m = solid_weave(4, 65, 16, 0.2, 0.25);
	struct layers l;

	v.x0 = v.y0 = 0;
	v.x1 = v.y1 = 4;
	v.tile_x = v.tile_y = true;
	l = make(&m, &v);
	CHECK(l.stats.open == 0);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct layers k = layers_make(&m, &v, &closed, rows[i]);

		CHECK(count_different(&l, &k, 150 * 150, 0) == 0);
		CHECK(same_stats(&k.stats, &l.stats));
		layers_free(&k);
	}
	{
		struct bake_abuffer *ab = NULL;
		struct bake_err err = BAKE_ERR_INIT;
		size_t bad = 0;

		CHECK_OK(
		    bake_abuffer_open(&ab, &m, NULL, &v, &closed, &err), err);
#pragma omp parallel for num_threads(4) reduction(+ : bad)
		for (int y = 0; y < 150; y++) {
			struct bake_band band = BAKE_BAND_INIT;
			struct bake_err e = BAKE_ERR_INIT;

			if (bake_abuffer_rows(ab, y, 1, &band, &e) != BAKE_OK)
				abort();
			for (size_t x = 0; x < 150; x++) {
				const struct bake_crossing *c;
				size_t n =
				    layers_at(&l, (size_t)y * 150 + x, &c);

				bad += band.start[x + 1] - band.start[x] != n;
				for (size_t k = 0; k < n; k++)
					bad += !same_crossing(&c[k],
					    &band.crossing[band.start[x] + k]);
			}
			bake_band_free(&band);
		}
		CHECK(bad == 0);
		bake_abuffer_close(ab);
	}
	layers_free(&l);
	bake_mesh_free(&m);
}

/* -- tiles --------------------------------------------------------------- */

/* Copies of a mesh, width and height apart: -n .. n along x (and y); copy
 * (i, j) is number (j + n) (2 n + 1) + i + n. */
static struct bake_mesh
repeated(const struct bake_mesh *m, double width, double height, int nx, int ny)
{
	struct bake_mesh all = BAKE_MESH_INIT;

	for (int j = -ny; j <= ny; j++)
		for (int i = -nx; i <= nx; i++) {
			struct bake_mesh one =
			    solid_alloc(m->npositions, m->ntriangles);

			for (size_t v = 0; v < m->npositions; v++) {
				const double *p = m->positions[v];

				one.positions[v][0] = p[0] + i * width;
				one.positions[v][1] = p[1] + j * height;
				one.positions[v][2] = p[2];
			}
			memcpy(one.triangles, m->triangles,
			    m->ntriangles * sizeof *m->triangles);
			if (all.ntriangles == 0)
				all = one;
			else
				solid_add(&all, &one);
		}
	return all;
}

/* The same layers; the copy a crossing is on is the tile it is in. */
static void
check_tiles(const struct bake_mesh *m, struct bake_view v, int nx, int ny)
{
	double width = v.x1 - v.x0, height = v.y1 - v.y0;
	struct bake_mesh many = repeated(m, width, height, nx, ny);
	size_t texels = (size_t)v.width * (size_t)v.height, bad = 0, far = 0;
	struct layers l, k;

	v.tile_x = v.tile_y = false;
	k = make(&many, &v);
	v.tile_x = nx > 0;
	v.tile_y = ny > 0;
	l = make(m, &v);
	for (size_t i = 0; i < texels; i++) {
		const struct bake_crossing *c, *d;
		size_t n = layers_at(&l, i, &c);

		if (layers_at(&k, i, &d) != n) {
			bad++;
			continue;
		}
		for (size_t j = 0; j < n; j++) {
			/* a copy to the right is met in a tile to the left,
			 * and rows go downwards where y goes up */
			int at = (c[j].tile_y + ny) * (2 * nx + 1) + nx -
				 c[j].tile_x;
			size_t t = (size_t)at * m->ntriangles + c[j].triangle;

			bad += t != d[j].triangle || c[j].depth != d[j].depth ||
			       c[j].entering != d[j].entering;
			far += c[j].tile_x != 0 || c[j].tile_y != 0;
		}
	}
	CHECK(bad == 0);
	CHECK(far > 0);
	CHECK(l.stats.crossings == k.stats.crossings);
	CHECK(l.stats.open == k.stats.open);
	layers_free(&l);
	layers_free(&k);
	bake_mesh_free(&many);
}

static void
a_tiled_mesh_is_the_repeated_one(void)
{
	struct bake_view v = { BAKE_AXIS_POS_Z, 80, 50, -0.75, -0.5, 0.75, 0.5,
		1.5, -1.5, false, false };
	struct bake_mesh m = askew_torus();

	check_tiles(&m, v, 2, 2);
	check_tiles(&m, v, 2, 0);
	check_tiles(&m, v, 0, 2);
	/* a period that is far less than the mesh, and not of whole bins */
	v.x0 = v.y0 = 0;
	v.x1 = 0.25;
	v.y1 = 0.5;
	v.width = 40;
	v.height = 80;
	check_tiles(&m, v, 7, 5);
	bake_mesh_free(&m);
}

static void
a_woven_tile_closes(void)
{
	const double sizes[] = { 1, 0.1, 1. / 3, 123.456 };

	for (int i = 0; i < 4; i++) {
		double s = sizes[i];
		const double matrix[3][3] = { { s, 0, 0 }, { 0, s, 0 },
			{ 0, 0, s } };
		const double shift[3] = { 0.7 * i, -0.3 * i, 0 };
		struct bake_view v = square(128, 1);
		struct bake_mesh m = solid_weave(4, 65, 16, 0.2, 0.25);
		struct layers l;

		v.x0 = v.y0 = 0;
		v.x1 = v.y1 = 4;
		v = mapped(v, s, shift);
		solid_map(&m, matrix, shift);
		v.tile_x = v.tile_y = true;
		l = make(&m, &v);
		CHECK(l.stats.open == 0 && l.stats.inside_out == 0);
		CHECK(l.stats.most == 4);
		layers_free(&l);
		for (int k = 0; i == 0 && k < 2; k++) {
			v.x0 += 0.4375;
			v.x1 += 0.4375;
			v.y0 -= 0.25;
			v.y1 -= 0.25;
			check_tiles(&m, v, 1, 1);
		}
		bake_mesh_free(&m);
	}
}

/* -- winding ------------------------------------------------------------- */

static struct bake_mesh
two_spheres(double distance, double r, double s)
{
	const double a[3] = { 0, 0, 0 }, b[3] = { 0, 0, -distance };
	struct bake_mesh m = solid_sphere(a, r, 64, 32);
	struct bake_mesh n = solid_sphere(b, s, 63, 31);

	solid_add(&m, &n);
	return m;
}

static void
overlapping_parts_are_their_union(void)
{
	struct bake_view v = square(65, 3);
	struct bake_mesh m = two_spheres(1, 1, 1), n = two_spheres(2.5, 1, 1);
	struct layers l = make(&m, &v);
	const struct bake_crossing *c;
	/* the texel in the middle */
	const size_t i = 32 * 65 + 32;

	CHECK(layers_at(&l, i, &c) == 2);
	/* z = 1 and -2, but for how flat the poles' caps are */
	CHECK_NEAR(c[0].depth, 2. / 6, 1e-3);
	CHECK_NEAR(c[1].depth, 5. / 6, 1e-3);
	CHECK(l.stats.most == 4 && l.stats.open == 0);
	CHECK(l.stats.united > 200 && l.stats.inside_out == 0);
	layers_free(&l);
	l = make(&n, &v);
	CHECK(layers_at(&l, i, &c) == 4);
	CHECK(l.stats.united == 0);
	layers_free(&l);
	bake_mesh_free(&m);
	bake_mesh_free(&n);
}

static void
a_cavity_is_hollow(void)
{
	struct bake_view v = square(65, 3);
	struct bake_mesh m = two_spheres(0, 1, 0.5);
	struct layers l;
	const struct bake_crossing *c;

	/* the inner one, with a winding the other way */
	for (size_t t = 64 * 31 * 2; t < m.ntriangles; t++) {
		struct bake_corner k = m.triangles[t][0];

		m.triangles[t][0] = m.triangles[t][1];
		m.triangles[t][1] = k;
	}
	l = make(&m, &v);
	CHECK(layers_at(&l, 32 * 65 + 32, &c) == 4);
	CHECK_NEAR(c[1].depth, 2.5 / 6, 1e-3);
	CHECK_NEAR(c[2].depth, 3.5 / 6, 1e-3);
	CHECK(l.stats.open == 0 && l.stats.inside_out == 0);
	layers_free(&l);
	bake_mesh_free(&m);
}

static size_t
count_occupied(const struct layers *l, size_t texels)
{
	size_t n = 0;

	for (size_t i = 0; i < texels; i++)
		n += l->start[i + 1] > l->start[i];
	return n;
}

static void
what_is_inside_out_is_counted_and_turned(void)
{
	const size_t texels = 65 * 65;
	struct bake_view v = square(65, 4);

	for (size_t every = 1; every <= 3; every++) {
		struct bake_mesh m = two_spheres(2.5, 1, 1);
		struct layers right = make(&m, &v), l;

		solid_turn(&m, every);
		l = make(&m, &v);
		if (every == 1) {
			CHECK(l.stats.inside_out == count_occupied(&l, texels));
			CHECK(l.stats.open == 0);
			/* it is a solid all the same */
			CHECK(count_different(&right, &l, texels, 0) == 0);
		} else {
			CHECK(l.stats.open > 0);
		}
		layers_free(&l);
		l = layers_make(&m, &v, &reorient, 64);
		CHECK(l.stats.inside_out == 0 && l.stats.open == 0);
		CHECK(count_different(&right, &l, texels, 0) == 0);
		layers_free(&l);
		layers_free(&right);
		bake_mesh_free(&m);
	}
}

static void
one_part_of_two_is_turned(void)
{
	struct bake_view v = square(65, 4);
	struct bake_mesh m = two_spheres(1, 1, 1);
	struct layers right = make(&m, &v), l;

	for (size_t t = 0; t < 64 * 31 * 2; t++) {
		struct bake_corner k = m.triangles[t][0];

		m.triangles[t][0] = m.triangles[t][1];
		m.triangles[t][1] = k;
	}
	l = make(&m, &v);
	CHECK(l.stats.inside_out > 0);
	layers_free(&l);
	l = layers_make(&m, &v, &reorient, 64);
	CHECK(l.stats.inside_out == 0 && l.stats.open == 0);
	CHECK(count_different(&right, &l, 65 * 65, 0) == 0);
	layers_free(&l);
	layers_free(&right);
	bake_mesh_free(&m);
}

/* Tubes that end at the tile's edge, half of their triangles turned round. */
static void
a_woven_tile_is_turned(void)
{
	struct bake_view v = square(96, 1);
	struct bake_mesh m = solid_weave(4, 33, 16, 0.2, 0.25);
	struct layers right, l;

	v.x0 = v.y0 = 0;
	v.x1 = v.y1 = 4;
	v.tile_x = v.tile_y = true;
	right = make(&m, &v);
	for (size_t every = 1; every <= 3; every++) {
		solid_turn(&m, every);
		l = layers_make(&m, &v, &reorient, 64);
		CHECK(l.stats.inside_out == 0 && l.stats.open == 0);
		CHECK(count_different(&right, &l, 96 * 96, 0) == 0);
		layers_free(&l);
	}
	layers_free(&right);
	bake_mesh_free(&m);
}

static void
doubled_faces(void)
{
	const size_t texels = 96 * 96;
	struct bake_view v = square(96, 1.5);
	struct bake_mesh m = askew_torus(), again = askew_torus();
	struct bake_mesh thin = askew_torus(), back = askew_torus();
	struct layers one = make(&m, &v), l;

	solid_add(&m, &again);
	l = make(&m, &v);
	/* of two that leave, the last */
	for (size_t i = 0; i < l.n; i++)
		l.crossing[i].triangle %= m.ntriangles / 2;
	CHECK(count_different(&one, &l, texels, 0) == 0);
	CHECK(l.stats.crossings == 2 * one.stats.crossings);
	CHECK(l.stats.open == 0 && l.stats.inside_out == 0);
	layers_free(&l);
	/* each face once more, turned round: sheets of no thickness */
	solid_turn(&back, 1);
	solid_add(&thin, &back);
	l = make(&thin, &v);
	CHECK(l.stats.open == 0 && l.stats.inside_out == 0);
	CHECK(l.stats.united == 0 && l.n == 2 * one.n);
	for (size_t i = 0; i + 1 < l.n; i += 2)
		if (l.crossing[i].depth != l.crossing[i + 1].depth)
			CHECK(!"a sheet has a thickness");
	layers_free(&l);
	layers_free(&one);
	bake_mesh_free(&m);
	bake_mesh_free(&thin);
}

/* Boxes that stand on each other, their common faces slanted and cut along
 * either diagonal, so that rounding decides which comes first. */
static void
touching_sheets_stay_balanced(void)
{
	const double shear[3][3] = { { 1, 0, 0 }, { 0, 1, 0 },
		{ 0.37, -0.21, 1 } };
	const double zero[3] = { 0, 0, 0 };
	struct bake_view v = square(101, 3);
	struct bake_mesh all = BAKE_MESH_INIT;
	struct layers l;
	size_t bad = 0;

	for (int i = 0; i < 4; i++) {
		const double lo[3] = { -1.1, -1.3, 0.3 * i - 0.6 };
		const double hi[3] = { 1.1, 1.3, 0.3 * i - 0.3 };
		const double at[2] = { 0.6 - 0.3 * i, 0.3 - 0.3 * i };
		struct bake_mesh b = solid_box(lo, hi);

		for (size_t k = 0; k < 8; k++)
			b.positions[k][2] = -at[b.positions[k][2] == hi[2]];
		/* the lid's other diagonal */
		solid_triangle(&b, 10, 5, 7, 4);
		solid_triangle(&b, 11, 7, 6, 4);
		if (i == 0)
			all = b;
		else
			solid_add(&all, &b);
	}
	solid_map(&all, shear, zero);
	l = make(&all, &v);
	CHECK(l.stats.open == 0 && l.stats.inside_out == 0);
	CHECK(l.stats.crossings > 8 * 30 * 30);
	for (size_t i = 0; i < 101 * 101; i++) {
		const struct bake_crossing *c;
		size_t n = layers_at(&l, i, &c);

		/* gaps that rounding left have no width */
		for (size_t k = 1; k + 1 < n; k += 2)
			bad += !(c[k + 1].depth - c[k].depth < 1e-14);
	}
	CHECK(bad == 0);
	layers_free(&l);
	bake_mesh_free(&all);
}

static void
deep_texels(void)
{
	const int nplates = 300;
	struct bake_view v = square(9, 1);
	struct bake_mesh plates = BAKE_MESH_INIT, nested = BAKE_MESH_INIT;
	struct layers l;
	size_t bad = 0;

	for (int i = 0; i < nplates; i++) {
		/* in any order */
		double z = (i * 77 % nplates) / 1024.;
		const double lo[3] = { -2, -2, z };
		const double hi[3] = { 2, 2, z + 1. / 2048 };
		const double in[3] = { -2, -2, -z }, out[3] = { 2, 2, z + 0.1 };
		struct bake_mesh a = solid_box(lo, hi), b = solid_box(in, out);

		if (i == 0) {
			plates = a;
			nested = b;
		} else {
			solid_add(&plates, &a);
			solid_add(&nested, &b);
		}
	}
	l = make(&plates, &v);
	CHECK(l.n == 81 * 2 * (size_t)nplates && l.stats.united == 0);
	CHECK(l.stats.most == 2 * nplates);
	for (size_t i = 0; i < l.n; i++) {
		size_t k = i % (2 * (size_t)nplates);
		double z = (nplates - 1 - (double)(k / 2)) / 1024. +
			   (k % 2 == 0) / 2048.;

		bad += l.crossing[i].depth != (1 - z) / 2;
	}
	CHECK(bad == 0);
	layers_free(&l);
	l = make(&nested, &v);
	CHECK(l.n == 81 * 2 && l.stats.united == 81);
	layers_free(&l);
	bake_mesh_free(&plates);
	bake_mesh_free(&nested);
}

static void
welding_closes_cracks(void)
{
	struct bake_view v = square(96, 1.5);
	struct bake_mesh m = askew_torus(), soup;
	struct bake_weld weld = BAKE_WELD_INIT;
	struct bake_band band = BAKE_BAND_INIT;
	struct bake_abuffer *ab = NULL;
	struct bake_err err = BAKE_ERR_INIT;
	struct layers l, one = make(&m, &v);

	soup = solid_alloc(3 * m.ntriangles, m.ntriangles);
	for (size_t c = 0; c < 3 * m.ntriangles; c++) {
		int w = m.triangles[c / 3][c % 3].v;

		for (int k = 0; k < 3; k++)
			soup.positions[c][k] = m.positions[w][k];
	}
	for (size_t t = 0; t < m.ntriangles; t++)
		solid_triangle(&soup, t, 3 * t, 3 * t + 1, 3 * t + 2);
	l = make(&soup, &v);
	CHECK(count_different(&one, &l, 96 * 96, 0) == 0);
	layers_free(&l);
	/* torn by a hundredth of a texel: welding at a tenth mends it */
	for (size_t c = 0; c < 3 * m.ntriangles; c++)
		for (int k = 0; k < 3; k++)
			soup.positions[c][k] +=
			    1e-4 * ((double)(c * 7919 % 101) / 50 - 1);
	l = make(&soup, &v);
	CHECK(l.stats.open > 0);
	layers_free(&l);
	CHECK_OK(bake_mesh_weld(&soup, 1e-3, &weld, &err), err);
	CHECK_OK(bake_abuffer_open(&ab, &soup, &weld, &v, &closed, &err), err);
	CHECK_OK(bake_abuffer_rows(ab, 0, 96, &band, &err), err);
	CHECK(band.stats.open == 0 && band.stats.crossings > 4000);
	bake_band_free(&band);
	bake_abuffer_close(ab);
	bake_weld_free(&weld);
	layers_free(&one);
	bake_mesh_free(&m);
	bake_mesh_free(&soup);
}

/* -- slabs --------------------------------------------------------------- */

static void
open_sheets_become_slabs(void)
{
	const double lo[3] = { -1, -1, -0.5 }, hi[3] = { 1, 1, 0.25 };
	struct bake_abuffer_params p = { 0.125, false };
	struct bake_view v = square(33, 1);
	struct bake_mesh box = solid_box(lo, hi);
	struct layers l;
	const struct bake_crossing *c;
	size_t bad = 0;

	/* without its sides it is open, but not along z; of one face the
	 * winding is turned round: it does not matter */
	memmove(box.triangles, box.triangles + 8, 4 * sizeof *box.triangles);
	box.ntriangles = 4;
	solid_turn(&box, 3);
	l = layers_make(&box, &v, &p, 64);
	for (size_t i = 0; i < 33 * 33; i++) {
		bad += layers_at(&l, i, &c) != 4 ||
		       c[0].depth != (1 - 0.3125) / 2 ||
		       c[1].depth != (1 - 0.1875) / 2 ||
		       c[2].depth != (1 + 0.4375) / 2 ||
		       c[3].depth != (1 + 0.5625) / 2;
	}
	CHECK(bad == 0);
	CHECK(l.stats.open == 0 && l.stats.united == 0 && l.stats.most == 4);
	layers_free(&l);
	/* slabs that touch are one */
	p.solidify = 0.75;
	l = layers_make(&box, &v, &p, 64);
	for (size_t i = 0; i < 33 * 33; i++)
		bad += layers_at(&l, i, &c) != 2 ||
		       c[0].depth != (1 - 0.625) / 2 ||
		       c[1].depth != (1 + 0.875) / 2 ||
		       c[0].triangle / 2 == c[1].triangle / 2;
	CHECK(bad == 0);
	CHECK(l.stats.united == 33 * 33);
	layers_free(&l);
	bake_mesh_free(&box);
}

/* -- errors -------------------------------------------------------------- */

static void
check_refused(const struct bake_mesh *m, const struct bake_weld *weld,
    const struct bake_view *v, const struct bake_abuffer_params *p,
    enum bake_status status, const char *begin)
{
	struct bake_abuffer *ab = (struct bake_abuffer *)1;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_abuffer_open(&ab, m, weld, v, p, &err) == status);
	CHECK(ab == NULL);
	if (strncmp(err.msg, begin, strlen(begin)) != 0) {
		printf("message: %s\n", err.msg);
		CHECK(!"the message begins otherwise");
	}
}

static void
what_cannot_be_done_is_refused(void)
{
	const double lo[3] = { -1, -1, -1 }, hi[3] = { 1, 1, 1 };
	struct bake_view v = square(16, 1);
	struct bake_mesh none = BAKE_MESH_INIT, m = solid_box(lo, hi);
	struct bake_weld weld = BAKE_WELD_INIT;
	struct bake_abuffer_params p = closed;

	check_refused(&none, NULL, &v, &p, BAKE_EDATA,
	    "the mesh has no triangle to be seen");
	check_refused(&m, &weld, &v, &p, BAKE_EINVAL,
	    "welding of 0 positions for a mesh of 8");
	p.solidify = -1;
	check_refused(
	    &m, NULL, &v, &p, BAKE_EINVAL, "a slab of thickness -1: it is");
	p.solidify = NAN;
	check_refused(&m, NULL, &v, &p, BAKE_EINVAL, "a slab of thickness");
	p.solidify = INFINITY;
	check_refused(&m, NULL, &v, &p, BAKE_EINVAL, "a slab of thickness");
	p.solidify = 1e300;
	check_refused(&m, NULL, &v, &p, BAKE_EINVAL,
	    "a slab of thickness 1e+300 for a depth range of 2");
	p = closed;
	v.width = 0;
	check_refused(
	    &m, NULL, &v, &p, BAKE_EINVAL, "a picture of 0x16 texels");
	v = square(16, 1e-9);
	check_refused(&m, NULL, &v, &p, BAKE_EDATA,
	    "triangle 0 reaches farther than 1073741824 texels");
	v = square(16, 1);
	v.x1 = v.x0 + 1e-5;
	v.tile_x = true;
	check_refused(&m, NULL, &v, &p, BAKE_EDATA,
	    "triangle 2 reaches over more than 32767 tiles");
	bake_mesh_free(&m);
}

static void
rows_that_are_not_there_are_refused(void)
{
	const double lo[3] = { -1, -1, -1 }, hi[3] = { 1, 1, 1 };
	static const int rows[][2] = { { -1, 2 }, { 0, 0 }, { 0, 17 },
		{ 16, 1 }, { 10, INT32_MAX } };
	struct bake_view v = square(16, 1);
	struct bake_mesh m = solid_box(lo, hi);
	struct bake_band band = BAKE_BAND_INIT;
	struct bake_abuffer *ab = NULL;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_abuffer_open(&ab, &m, NULL, &v, &closed, &err), err);
	CHECK_OK(bake_abuffer_rows(ab, 0, 16, &band, &err), err);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		err = (struct bake_err)BAKE_ERR_INIT;
		CHECK(bake_abuffer_rows(ab, rows[i][0], rows[i][1], &band,
			  &err) == BAKE_EINVAL);
		CHECK(strstr(err.msg, "of a picture of 16") != NULL);
		CHECK(band.start == NULL && band.nrows == 0);
	}
	bake_abuffer_close(ab);
	bake_abuffer_close(NULL);
	bake_mesh_free(&m);
}

/* Far outside the region, but within what can be counted. */
static void
what_is_outside_is_cut_off(void)
{
	struct bake_view v = square(16, 1);
	struct bake_mesh m = askew_torus();
	struct layers l;

	v.x0 = 7;
	v.x1 = 8;
	l = make(&m, &v);
	CHECK(l.n == 0 && l.stats.crossings == 0);
	layers_free(&l);
	/* a thousandth of a texel wide, depths beyond the range */
	v = square(16, 1e-6);
	v.x0 += 1;
	v.x1 += 1;
	v.near = 1e-3;
	v.far = 0;
	l = make(&m, &v);
	CHECK(l.stats.open == 0 && l.n == 2 * 256);
	CHECK(fabs(l.crossing[0].depth) > 1 && fabs(l.crossing[1].depth) > 1);
	layers_free(&l);
	bake_mesh_free(&m);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(a_cube_through_its_diagonals_is_whole),
		CASE(a_sphere_is_where_it_is),
		CASE(a_torus_is_where_it_is),
		CASE(huge_triangles_are_exact),
		CASE(turning_the_mesh_turns_the_picture),
		CASE(scaling_and_moving_change_nothing),
		CASE(bands_and_threads_do_not_matter),
		CASE(a_tiled_mesh_is_the_repeated_one),
		CASE(a_woven_tile_closes),
		CASE(overlapping_parts_are_their_union),
		CASE(a_cavity_is_hollow),
		CASE(what_is_inside_out_is_counted_and_turned),
		CASE(one_part_of_two_is_turned),
		CASE(a_woven_tile_is_turned),
		CASE(doubled_faces),
		CASE(touching_sheets_stay_balanced),
		CASE(deep_texels),
		CASE(welding_closes_cracks),
		CASE(open_sheets_become_slabs),
		CASE(what_cannot_be_done_is_refused),
		CASE(rows_that_are_not_there_are_refused),
		CASE(what_is_outside_is_cut_off),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
