/* The rasteriser: coverage against an exact oracle, weights against rays. */
/* SPDX-License-Identifier: MIT */
#include "raster.h"

#include "check.h"
#include "raster_priv.h"
#include "shape.h"
#include "test_mesh.h"
#include "test_solid.h"

enum { N = BAKE_RASTER_TILE };

/* A fragment, where it is in the picture. */
struct fragment {
	int triangle, back, x, y;
	float b1, b2, distance;
};

/* All fragments of a picture, tile by tile. */
struct picture {
	struct bake_raster *raster;
	int width, height, x0, y0;
	struct fragment *f;
	size_t n, cap;
	int run_broken, order_broken, last;
};

static void
take(void *arg, const struct bake_fragments *f)
{
	struct picture *p = arg;

	p->order_broken |= f->triangle < p->last;
	p->last = f->triangle;
	p->run_broken |= f->n < 1 || f->n > N * N;
	for (int i = 0; i < f->n; i++) {
		if (p->n == p->cap) {
			p->cap = p->cap > 0 ? 2 * p->cap : 1024;
			p->f = realloc(p->f, p->cap * sizeof *p->f);
			if (p->f == NULL)
				abort();
		}
		p->run_broken |= i > 0 && f->index[i] <= f->index[i - 1];
		p->f[p->n++] = (struct fragment){ f->triangle, f->back,
			p->x0 + f->index[i] % N, p->y0 + f->index[i] / N,
			f->b1[i], f->b2[i], f->distance[i] };
	}
}

static struct picture
draw(const struct bake_mesh *m, const struct bake_camera *c, int samples,
    enum bake_cull cull, int nthreads)
{
	struct picture p = { .width = c->width * samples,
		.height = c->height * samples };
	struct bake_err err = BAKE_ERR_INIT;
	size_t size = (bake_raster_scratch() + 63) / 64 * 64;
	void *scratch = aligned_alloc(64, size);

	CHECK_OK(
	    bake_raster_open(&p.raster, m, c, samples, cull, nthreads, &err),
	    err);
	if (scratch == NULL || p.raster == NULL)
		abort();
	for (int t = 0; t < bake_raster_ntiles(p.raster); t++) {
		int w, h;

		bake_raster_tile(p.raster, t, &p.x0, &p.y0, &w, &h);
		CHECK(w >= 1 && w <= N && h >= 1 && h <= N);
		p.last = 0;
		bake_raster_fragments(p.raster, t, take, &p, scratch);
	}
	for (size_t i = 0; i < p.n; i++)
		p.run_broken |= p.f[i].x >= p.width || p.f[i].y >= p.height;
	CHECK(!p.run_broken && !p.order_broken);
	bake_raster_close(p.raster);
	free(scratch);
	return p;
}

static struct bake_camera
looking(double x, double y, double z, double fov)
{
	return (struct bake_camera){ .eye = { x, y, z },
		.up = { 0.1, 1, 0.2 },
		.fov_deg = fov,
		.height_world = 3,
		.near = 1e-3,
		.width = 97,
		.height = 70 };
}

static void
direction(uint64_t *state, double v[3])
{
	double l;

	do {
		for (int k = 0; k < 3; k++)
			v[k] = 2 * chance(state) - 1;
		l = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	} while (l > 1 || l < 0.1);
	for (int k = 0; k < 3; k++)
		v[k] /= l;
}

/* Fronts and backs of every sample are equally many; returns how many samples
 * see something. */
static int
check_closed(
    const struct bake_mesh *m, const struct bake_camera *c, int samples)
{
	struct picture p = draw(m, c, samples, BAKE_CULL_NONE, 1);
	size_t n = (size_t)p.width * (size_t)p.height;
	int *sum = calloc(n, sizeof *sum), *any = calloc(n, sizeof *any);
	int odd = 0, seen = 0;

	if (sum == NULL || any == NULL)
		abort();
	for (size_t i = 0; i < p.n; i++) {
		sum[p.f[i].y * p.width + p.f[i].x] += p.f[i].back ? -1 : 1;
		any[p.f[i].y * p.width + p.f[i].x]++;
	}
	for (size_t i = 0; i < n; i++) {
		odd += sum[i] != 0;
		seen += any[i] != 0;
	}
	CHECK(odd == 0);
	free(sum);
	free(any);
	free(p.f);
	return seen;
}

static void
closed_meshes_have_as_many_backs_as_fronts(void)
{
	static const enum bake_shape shapes[] = { BAKE_SHAPE_CUBE,
		BAKE_SHAPE_SPHERE, BAKE_SHAPE_CYLINDER, BAKE_SHAPE_TORUS };
	uint64_t state = 3;

	for (int s = 0; s < 4; s++)
		for (int d = 1; d <= 9; d += 4) {
			struct bake_mesh m = BAKE_MESH_INIT;
			struct bake_err err = BAKE_ERR_INIT;

			CHECK_OK(bake_shape_make(shapes[s], d, &m, &err), err);
			for (int i = 0; i < 24; i++) {
				struct bake_camera c;
				double v[3];

				direction(&state, v);
				/* some along the axes: edges through centres */
				if (i < 6)
					for (int k = 0; k < 3; k++)
						v[k] = k == i / 2
							   ? 1 - i % 2 * 2
							   : 0;
				c = looking(4 * v[0], 4 * v[1], 4 * v[2],
				    i % 3 == 0 ? 0 : 40);
				CHECK(check_closed(&m, &c, 1 + i % 4) > 1000);
			}
			bake_mesh_free(&m);
		}
}

/*
 * The eye in the hole of a torus, or between two spheres, sees closed surfaces
 * though they go on behind it: what near plane and guard band cut off lies
 * outside the picture. It is drawn larger and larger: triangles pass the guard
 * band of 2^18 samples.
 */
static void
what_is_cut_stays_closed(void)
{
	uint64_t state = 4;
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_shape_make(BAKE_SHAPE_TORUS, 2, &m, &err), err);
	for (int i = 0; i < 100; i++) {
		struct bake_camera c = looking(0, 0, 0, 20 + i);
		double v[3];

		direction(&state, v);
		for (int k = 0; k < 3; k++) {
			c.eye[k] = 0.1 * chance(&state);
			c.target[k] = c.eye[k] + v[k];
		}
		c.near = pow(10, -2 - i % 7);
		check_closed(&m, &c, 1 + i % 2);
	}
	/* 1e-5 from the wall: edges are 1e7 samples away */
	for (int i = 0; i < 100; i++) {
		struct bake_camera c = looking(0, 0, 0, 100);
		double v[3];

		direction(&state, v);
		c.eye[0] = 1.4 + 1e-5;
		c.eye[1] = 1e-6 * chance(&state);
		for (int k = 0; k < 3; k++)
			c.target[k] = c.eye[k] + v[k];
		c.near = 1e-7;
		check_closed(&m, &c, 1);
	}
	bake_mesh_free(&m);
}

static struct bake_mesh
soup(uint64_t *state, size_t n, double reach, double size)
{
	struct bake_mesh m = solid_alloc(3 * n, n);

	for (size_t t = 0; t < n; t++) {
		double middle[3];

		for (int k = 0; k < 3; k++)
			middle[k] = reach * (2 * chance(state) - 1);
		for (size_t i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++)
				m.positions[3 * t + i][k] =
				    middle[k] + size * (2 * chance(state) - 1);
		solid_triangle(&m, t, 3 * t, 3 * t + 1, 3 * t + 2);
	}
	return m;
}

struct spot {
	int64_t x, y;
};

/* E as the header has it, by its definition: twice the area of a, b, (x, y),
 * and where it is 0 what it is a very small step to the right, and an even
 * smaller one down. */
static bool
is_inside(const struct spot *a, const struct spot *b, int64_t x, int64_t y)
{
	int64_t dx = b->x - a->x, dy = b->y - a->y;
	int64_t e = dx * (y - a->y) - dy * (x - a->x);

	if (e != 0)
		return e > 0;
	return dy != 0 ? -dy > 0 : dx > 0;
}

/* The triangle's corners on the grid; false where one is nearer than near. */
static bool
spots(const struct bake_mesh *m, const struct bake_camera_basis *b, int samples,
    size_t t, struct spot spot[3], int *back)
{
	int64_t area;

	for (int k = 0; k < 3; k++) {
		double pixel[2], depth;

		if (!bake_camera_project(
			b, m->positions[m->triangles[t][k].v], pixel, &depth))
			return false;
		spot[k].x = (int64_t)floor(256 * (samples * pixel[0]) + 0.5);
		spot[k].y = (int64_t)floor(256 * (samples * pixel[1]) + 0.5);
	}
	area = (spot[1].x - spot[0].x) * (spot[2].y - spot[0].y) -
	       (spot[1].y - spot[0].y) * (spot[2].x - spot[0].x);
	*back = area > 0;
	if (area < 0) {
		struct spot s = spot[1];

		spot[1] = spot[2];
		spot[2] = s;
	}
	return true;
}

/* Where the ray of a sample meets a triangle's plane (Moeller and Trumbore
 * 1997): true where it does within the triangle, margin away from its edges. */
static bool
trace(const struct bake_mesh *m, const struct bake_camera_basis *b, int samples,
    int triangle, int x, int y, double margin, double at[3])
{
	const struct bake_corner *c = m->triangles[triangle];
	const double *p = m->positions[c[0].v];
	double o[3], d[3], u[3], v[3], h[3], s[3], q[3], det;

	bake_camera_ray(b, (x + 0.5) / samples, (y + 0.5) / samples, o, d);
	for (int k = 0; k < 3; k++) {
		u[k] = m->positions[c[1].v][k] - p[k];
		v[k] = m->positions[c[2].v][k] - p[k];
		s[k] = o[k] - p[k];
	}
	for (int k = 0; k < 3; k++) {
		int k1 = (k + 1) % 3, k2 = (k + 2) % 3;

		h[k] = d[k1] * v[k2] - d[k2] * v[k1];
		q[k] = s[k1] * u[k2] - s[k2] * u[k1];
	}
	det = u[0] * h[0] + u[1] * h[1] + u[2] * h[2];
	at[0] = (s[0] * h[0] + s[1] * h[1] + s[2] * h[2]) / det;
	at[1] = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / det;
	at[2] = (v[0] * q[0] + v[1] * q[1] + v[2] * q[2]) / det;
	return at[0] >= margin && at[1] >= margin &&
	       1 - at[0] - at[1] >= margin;
}

/* Coverage of triangles in front of the eye is the oracle's, sample by sample;
 * what it is of, too. */
static void
check_soup(const struct bake_mesh *m, const struct bake_camera *c, int samples)
{
	struct picture p = draw(m, c, samples, BAKE_CULL_NONE, 2);
	struct bake_camera_basis b;
	struct bake_err err = BAKE_ERR_INIT;
	size_t n = (size_t)p.width * (size_t)p.height;
	unsigned char *got = malloc(n * m->ntriangles);
	size_t wrong = 0;

	if (got == NULL)
		abort();
	memset(got, 0, n * m->ntriangles);
	CHECK_OK(bake_camera_basis(c, &b, &err), err);
	for (size_t i = 0; i < p.n; i++)
		got[(size_t)p.f[i].triangle * n +
		    (size_t)p.f[i].y * (size_t)p.width + (size_t)p.f[i].x] +=
		    (unsigned char)(p.f[i].back ? 16 : 1);
	for (size_t t = 0; t < m->ntriangles; t++) {
		struct spot s[3];
		int back;

		if (!spots(m, &b, samples, t, s, &back))
			continue;
		for (size_t i = 0; i < n; i++) {
			int64_t x = 256 * (int64_t)(i % (size_t)p.width) + 128;
			int64_t y = 256 * (int64_t)(i / (size_t)p.width) + 128;
			bool in = is_inside(&s[0], &s[1], x, y) &&
				  is_inside(&s[1], &s[2], x, y) &&
				  is_inside(&s[2], &s[0], x, y);

			wrong += got[t * n + i] != (in ? back ? 16 : 1 : 0);
		}
	}
	CHECK(wrong == 0);
	free(got);
	free(p.f);
}

static void
coverage_is_exact(void)
{
	static const double sizes[] = { 0.01, 0.1, 1, 4 };
	uint64_t state = 5;

	for (int i = 0; i < 16; i++) {
		struct bake_mesh m = soup(&state, 100, 2, sizes[i % 4]);
		struct bake_camera c = looking(1, 2, 8, i % 2 ? 30 : 0);

		check_soup(&m, &c, 1 + i / 4);
		bake_mesh_free(&m);
	}
}

/* Corners and edges on sample centres: one unit is 16 pixels, the centre of the
 * picture a sample's corner. */
static void
coverage_on_centres_is_exact(void)
{
	uint64_t state = 6;

	for (int i = 0; i < 8; i++) {
		struct bake_mesh m = soup(&state, 300, 2, 1);
		struct bake_camera c = { .eye = { 0, 0, 8 },
			.up = { 0, 1, 0 },
			.near = 1,
			.height_world = 4,
			.width = 64,
			.height = 64 };

		for (size_t v = 0; v < m.npositions; v++)
			for (int k = 0; k < 3; k++)
				m.positions[v][k] =
				    (floor(8 * m.positions[v][k]) + 0.5) / 16;
		check_soup(&m, &c, 1 + i % 3);
		bake_mesh_free(&m);
	}
}

/* Weights and distance are those of the sample's ray. */
static void
check_values(
    const struct bake_mesh *m, const struct bake_camera *c, int samples)
{
	struct picture p = draw(m, c, samples, BAKE_CULL_NONE, 1);
	struct bake_camera_basis b;
	struct bake_err err = BAKE_ERR_INIT;
	double worst_weight = 0, worst_distance = 0;
	size_t outside = 0;

	CHECK_OK(bake_camera_basis(c, &b, &err), err);
	for (size_t i = 0; i < p.n; i++) {
		const struct fragment *f = &p.f[i];
		double at[3];

		outside += !(f->b1 >= 0 && f->b1 <= 1 && f->b2 >= 0 &&
			     f->b2 <= 1 && f->b1 + f->b2 <= 1.0000002f &&
			     f->distance >= (float)c->near);
		if (!trace(m, &b, samples, f->triangle, f->x, f->y, 0, at))
			continue;
		worst_weight = fmax(worst_weight, fabs(f->b1 - at[0]));
		worst_weight = fmax(worst_weight, fabs(f->b2 - at[1]));
		worst_distance =
		    fmax(worst_distance, fabs(f->distance - at[2]) / at[2]);
	}
	CHECK(p.n > 50 && outside == 0);
	/* half an ulp of a float below 1, 2^-25, and what is lost in double
	 * to triangles nearly edge-on */
	CHECK(worst_weight < 3.1e-8);
	/* roundings of 2^-24: the depth, two for the length, the product */
	CHECK(worst_distance < 4.01 * 5.97e-8);
	free(p.f);
}

static void
weights_and_distances_are_those_of_rays(void)
{
	uint64_t state = 7;

	for (int i = 0; i < 12; i++) {
		struct bake_mesh m = soup(&state, 200, 2, i % 2 ? 0.3 : 2);
		struct bake_camera c =
		    looking(1, 2, 8, i % 3 == 0 ? 0 : 14 * i);

		c.near = 0.5;
		check_values(&m, &c, 1 + i % 4);
		bake_mesh_free(&m);
	}
}

/* 1: the sample's ray meets the triangle, and beyond near; 0: it does not; -1:
 * close to an edge. Snapping moves edges by 2^-9 samples, some 0.01 of a
 * triangle that is 1 / 5 of a sample wide. */
static int
is_met(const struct bake_mesh *m, const struct bake_camera_basis *b,
    int triangle, int x, int y)
{
	double at[3], o[3], d[3], depth = 0;
	bool in = trace(m, b, 1, triangle, x, y, 0.02, at);
	bool out = !trace(m, b, 1, triangle, x, y, -0.02, at);

	bake_camera_ray(b, x + 0.5, y + 0.5, o, d);
	for (int j = 0; j < 3; j++)
		depth -= at[2] * d[j] * b->z[j];
	if (out || depth < 0.98 * b->near)
		return 0;
	return in && depth > 1.02 * b->near ? 1 : -1;
}

static void
check_cut(const struct bake_mesh *m, const struct bake_camera *c)
{
	struct picture p = draw(m, c, 1, BAKE_CULL_NONE, 1);
	size_t n = (size_t)p.width * (size_t)p.height, wrong = 0, cut = 0;
	unsigned char *got = calloc(n, m->ntriangles);
	struct bake_camera_basis b;
	struct bake_err err = BAKE_ERR_INIT;

	if (got == NULL)
		abort();
	CHECK_OK(bake_camera_basis(c, &b, &err), err);
	for (size_t k = 0; k < p.n; k++)
		got[(size_t)p.f[k].triangle * n +
		    (size_t)(p.f[k].y * p.width + p.f[k].x)]++;
	for (size_t k = 0; k < n * m->ntriangles; k++) {
		int met = is_met(m, &b, (int)(k / n), (int)(k % n) % p.width,
		    (int)(k % n) / p.width);

		wrong += met >= 0 ? got[k] != met : got[k] > 1;
	}
	for (size_t v = 0; v < m->npositions; v++) {
		double pixel[2], depth;

		cut += !bake_camera_project(&b, m->positions[v], pixel, &depth);
	}
	CHECK(wrong == 0 && cut > 10);
	free(got);
	free(p.f);
}

/* Triangles that the near plane cuts are seen once where a ray meets them
 * beyond it, and nowhere else. */
static void
near_plane_cuts(void)
{
	uint64_t state = 8;

	for (int i = 0; i < 20; i++) {
		struct bake_mesh m = soup(&state, 40, 1.5, 2);
		struct bake_camera c = looking(0.3, 0.1, 0.2, 20 + 6 * i);

		c.near = i % 2 ? 0.25 : 1e-4;
		c.fov_deg = i % 5 == 0 ? 0 : c.fov_deg;
		check_cut(&m, &c);
		bake_mesh_free(&m);
	}
}

/* A grid over the whole picture and far beyond: each sample once. */
static void
shared_edges_are_covered_once(void)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	uint64_t state = 9;

	CHECK_OK(bake_shape_make(BAKE_SHAPE_PLANE, 50, &m, &err), err);
	for (int i = 0; i < 50; i++) {
		struct bake_camera c = looking(0, 0, 0, 40);
		struct picture p;
		size_t n;
		unsigned char *got;
		size_t wrong = 0;

		for (int k = 0; k < 3; k++) {
			c.eye[k] = 0.2 * chance(&state) + 0.3 * (k == 1);
			c.target[k] = 0.2 * chance(&state) - (k == 1);
		}
		p = draw(&m, &c, 2, BAKE_CULL_BACK, 1);
		n = (size_t)p.width * (size_t)p.height;
		if ((got = calloc(n, 1)) == NULL)
			abort();
		for (size_t k = 0; k < p.n; k++)
			got[p.f[k].y * p.width + p.f[k].x]++;
		for (size_t k = 0; k < n; k++)
			wrong += got[k] != 1;
		CHECK(wrong == 0);
		free(got);
		free(p.f);
	}
	bake_mesh_free(&m);
}

static bool
same(const struct picture *a, const struct picture *b)
{
	return a->n == b->n &&
	       (a->n == 0 || memcmp(a->f, b->f, a->n * sizeof *a->f) == 0);
}

/* The same bytes in the same order. */
static void
threads_and_instruction_sets_do_not_matter(void)
{
	static const char *const isas[] = { "baseline", "avx2", "avx512" };
	uint64_t state = 10;
	struct bake_mesh m = soup(&state, 20000, 2, 0.1);
	struct bake_mesh large = soup(&state, 50, 1, 2);

	solid_add(&m, &large);
	for (int i = 0; i < 4; i++) {
		struct bake_camera c = looking(0.5, 0.2, 1.5, i ? 70 : 0);
		struct picture a, b;

		c.width = 300;
		c.height = 200;
		setenv("BAKE_ISA", "baseline", 1);
		a = draw(&m, &c, 1, (enum bake_cull)(i % 3), 1);
		for (int k = 0; k < 3; k++) {
			setenv("BAKE_ISA", isas[k], 1);
			b = draw(&m, &c, 1, (enum bake_cull)(i % 3), 2 + 3 * k);
			CHECK(same(&a, &b));
			free(b.f);
		}
		unsetenv("BAKE_ISA");
		CHECK(a.n > 10000);
		free(a.f);
	}
	bake_mesh_free(&m);
}

/* The kernel's plain meaning, one sample after the other. */
static void
plain_rows(const struct raster_rows *r, float *b1, float *b2, float *distance)
{
	int n = 0;

	for (int y = r->y0; y <= r->y1; y++)
		for (int x = r->begin[y]; x < r->end[y]; x++, n++) {
			double s = (r->s[0] + r->s[2] * y) + r->s[1] * x;
			double e1 = (r->e1[0] + r->e1[2] * y) + r->e1[1] * x;
			double e2 = (r->e2[0] + r->e2[2] * y) + r->e2[1] * x;
			double inv = 1 / s, p = e1 * inv, q = e2 * inv, w;

			p = p > 0 ? p < 1 ? p : 1 : 0;
			q = q > 0 ? q < 1 - p ? q : 1 - p : 0;
			w = r->w0 + p * r->w1 + q * r->w2;
			w = w > r->near ? w : r->near;
			b1[n] = (float)p;
			b2[n] = (float)q;
			distance[n] = (float)w * r->length[y * N + x];
		}
}

static void
check_kernel(raster_rows_fn *kernel, uint64_t *state)
{
	static float got[3][RASTER_PADDED], want[3][RASTER_PADDED];
	static float length[RASTER_PADDED];
	struct raster_rows r = { .y0 = (int)(N * chance(state)),
		.b1 = got[0],
		.b2 = got[1],
		.distance = got[2],
		.length = length,
		.near = 0.1,
		.w0 = chance(state),
		.w1 = chance(state) - 0.5,
		.w2 = chance(state) - 0.5 };
	size_t n = 0;

	r.y1 = r.y0 + (int)((N - r.y0) * chance(state));
	for (int y = 0; y < N; y++) {
		r.begin[y] = (int)(N * chance(state));
		r.end[y] = (int)((N + 1) * chance(state));
		if (y >= r.y0 && y <= r.y1 && r.end[y] > r.begin[y])
			n += (size_t)(r.end[y] - r.begin[y]);
	}
	for (int i = 0; i < 3; i++) {
		r.e1[i] = chance(state) - 0.5;
		r.e2[i] = chance(state) - 0.5;
		/* now and then 0 all over: inf, and 0 / 0 where e1 is 0 */
		r.s[i] = chance(state) < 0.1 ? 0 : chance(state) - 0.5;
	}
	if (chance(state) < 0.1)
		memset(r.s, 0, sizeof r.s);
	if (chance(state) < 0.1)
		memset(r.e1, 0, sizeof r.e1);
	for (int i = 0; i < RASTER_SAMPLES; i++)
		length[i] = (float)(1 + chance(state));
	kernel(&r);
	plain_rows(&r, want[0], want[1], want[2]);
	for (int i = 0; i < 3; i++)
		CHECK(memcmp(got[i], want[i], n * sizeof **got) == 0);
}

static void
check_lengths(raster_lengths_fn *lengths, uint64_t *state)
{
	float got[RASTER_SAMPLES];
	double x0 = chance(state) - 0.5, y0 = chance(state) - 0.5;
	double d = 0.01 * chance(state), worst = 0;
	int wrong = 0;

	lengths(got, x0, y0, d);
	for (int i = 0; i < RASTER_SAMPLES; i++) {
		double x = x0 + i % N * d, y = y0 - i / N * d;
		float sum = (float)(x * x) + (float)(1 + y * y);
		double exact = sqrt(1 + x * x + y * y);

		wrong += got[i] != sqrtf(sum);
		worst = fmax(worst, fabs(got[i] / exact - 1));
	}
	CHECK(wrong == 0);
	/* half of the sum's two roundings and one of the root's own */
	CHECK(worst < 2.01 * 5.97e-8);
}

static void
kernels_are_the_plain_formula(void)
{
	static raster_rows_fn *const kernels[] =
	    BAKE_KERNEL_TABLE(bake_raster_rows);
	static raster_lengths_fn *const lengths[] =
	    BAKE_KERNEL_TABLE(bake_raster_lengths);

	for (int isa = 0; isa <= (int)bake_isa_pick(); isa++) {
		uint64_t state = 11;

		for (int i = 0; i < 2000; i++)
			check_kernel(kernels[isa], &state);
		for (int i = 0; i < 50; i++)
			check_lengths(lengths[isa], &state);
	}
}

static void
culling_takes_one_side(void)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_camera c = looking(1, 2, 3, 40);
	struct picture p[3];
	size_t wrong = 0;

	CHECK_OK(bake_shape_make(BAKE_SHAPE_SPHERE, 8, &m, &err), err);
	for (int i = 0; i < 3; i++)
		p[i] = draw(&m, &c, 1, (enum bake_cull)i, 1);
	CHECK(p[0].n > 1000 && p[0].n == p[1].n);
	CHECK(p[2].n == p[0].n + p[1].n);
	for (size_t i = 0; i < p[0].n; i++)
		wrong += p[0].f[i].back;
	for (size_t i = 0; i < p[1].n; i++)
		wrong += !p[1].f[i].back;
	CHECK(wrong == 0);
	/* a front is nearer than the sphere's middle */
	for (size_t i = 0; i < p[0].n; i++)
		wrong += !(p[0].f[i].distance < sqrt(14));
	CHECK(wrong == 0);
	for (int i = 0; i < 3; i++)
		free(p[i].f);
	bake_mesh_free(&m);
}

/* Nothing but finite numbers in their ranges, whatever the triangles. */
static void
extreme_triangles_do_no_harm(void)
{
	uint64_t state = 12;

	for (int i = 0; i < 60; i++) {
		struct bake_mesh m = soup(&state, 300, 1, 1);
		struct bake_camera c = looking(0.1, 0.2, 3, i % 4 ? 5 * i : 0);
		struct picture p;
		size_t wrong = 0;

		c.fov_deg = fmin(c.fov_deg, 170);
		c.near = pow(10, -(double)(i % 20));
		for (size_t v = 0; v < m.npositions; v++) {
			double scale = pow(10, 80 * chance(&state) - 40);

			for (int k = 0; k < 3; k++)
				if (chance(&state) < 0.3)
					m.positions[v][k] *= scale;
			/* slivers, points, and all in one plane */
			if (v % 3 == 2 && chance(&state) < 0.3)
				for (int k = 0; k < 3; k++)
					m.positions[v][k] =
					    m.positions[v - 1][k] *
					    (1 + 1e-15 * (i % 3));
			if (chance(&state) < 0.01)
				m.positions[v][0] = 1.7e308;
		}
		p = draw(&m, &c, 1 + i % 4, BAKE_CULL_NONE, 1);
		for (size_t k = 0; k < p.n; k++) {
			const struct fragment *f = &p.f[k];

			wrong += !(f->b1 >= 0 && f->b2 >= 0 &&
				   f->b1 + f->b2 <= 1.0000002f &&
				   f->distance >= (float)c.near &&
				   f->distance < 1e33f);
		}
		CHECK(wrong == 0);
		free(p.f);
		bake_mesh_free(&m);
	}
}

static void
tiles_cover_the_picture(void)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_camera c = looking(0, 0, 3, 40);
	struct bake_raster *r;
	struct bake_err err = BAKE_ERR_INIT;
	int x0, y0, w, h;

	CHECK_OK(bake_raster_open(&r, &m, &c, 1, BAKE_CULL_NONE, 1, &err), err);
	CHECK(bake_raster_ntiles(r) == 4 * 3);
	bake_raster_tile(r, 5, &x0, &y0, &w, &h);
	CHECK(x0 == 32 && y0 == 32 && w == 32 && h == 32);
	bake_raster_tile(r, 11, &x0, &y0, &w, &h);
	CHECK(x0 == 96 && y0 == 64 && w == 1 && h == 6);
	bake_raster_close(r);
	CHECK_OK(bake_raster_open(&r, &m, &c, 4, BAKE_CULL_NONE, 1, &err), err);
	CHECK(bake_raster_ntiles(r) == 13 * 9);
	bake_raster_close(r);
	bake_raster_close(NULL);
}

static void
bad_parameters_are_refused(void)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_camera c = looking(0, 0, 3, 40);
	struct bake_raster *r = (struct bake_raster *)&c;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_raster_open(&r, &m, &c, 0, BAKE_CULL_NONE, 1, &err) ==
	      BAKE_EINVAL);
	CHECK(strcmp(err.msg, "0 x 0 samples a pixel: it is 1 to 4 each way") ==
	      0);
	CHECK(r == NULL);
	CHECK(bake_raster_open(&r, &m, &c, 5, BAKE_CULL_NONE, 1, &err) ==
	      BAKE_EINVAL);
	CHECK(bake_raster_open(&r, &m, &c, 1, (enum bake_cull)3, 1, &err) ==
	      BAKE_EINVAL);
	CHECK(bake_raster_open(&r, &m, &c, 1, BAKE_CULL_NONE, -1, &err) ==
	      BAKE_EINVAL);
	c.near = -1;
	CHECK(bake_raster_open(&r, &m, &c, 1, BAKE_CULL_NONE, 1, &err) ==
	      BAKE_EINVAL);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(closed_meshes_have_as_many_backs_as_fronts),
		CASE(what_is_cut_stays_closed),
		CASE(coverage_is_exact),
		CASE(coverage_on_centres_is_exact),
		CASE(weights_and_distances_are_those_of_rays),
		CASE(near_plane_cuts),
		CASE(shared_edges_are_covered_once),
		CASE(threads_and_instruction_sets_do_not_matter),
		CASE(kernels_are_the_plain_formula),
		CASE(culling_takes_one_side),
		CASE(extreme_triangles_do_no_harm),
		CASE(tiles_cover_the_picture),
		CASE(bad_parameters_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
