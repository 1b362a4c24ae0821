/* Quadric fits: accuracy on analytic surfaces, and what must not matter. */
/* SPDX-License-Identifier: MIT */
#include "quadric.h"

#include "check.h"
#include "test_quadric.h"

/* Fit, or end the program. */
static struct bake_quadric *
fit(const struct bake_mesh *m, const struct bake_weld *weld,
    const struct bake_frames *f, const struct bake_quadric_params *p)
{
	struct bake_quadric *q = test_calloc(f->nframes, sizeof *q);
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_quadric_fit(m, weld, f, p, q, &err) != BAKE_OK) {
		printf("bake_quadric_fit: %s\n", err.msg);
		exit(1);
	}
	return q;
}

static struct bake_quadric_params
params_of(int order)
{
	struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;

	p.order = order;
	return p;
}

/* -- accuracy ---------------------------------------------------------------
 */

struct errors {
	double rms,
	    max; /* of a and b, relative to half the largest curvature */
};

/* Of the vertices that have their two rings. */
static struct errors
measure(const struct test_surface *s, int n, int order)
{
	struct bake_quadric_params p = params_of(order);
	struct errors e = { 0, 0 };
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_quadric *q;
	double kmax = 0, worst = 0, sum = 0;
	int count = 0;

	test_patch(&m, s, n, 0.25);
	test_frames(&f, &m, s, test_pi / 6);
	q = fit(&m, NULL, &f, &p);
	for (int i = 0; i <= n; i++)
		for (int k = 0; k <= n; k++) {
			size_t v = (size_t)(i * (n + 1) + k);
			double x[3], d;

			test_exact(s, m.positions[v], &f.frame[v], x);
			/* the larger principal curvature, halved */
			kmax = fmax(kmax, fabs(x[0] + x[1]) / 2 +
					      hypot(x[0] - x[1], x[2]) / 2);
			if (i < 2 || k < 2 || i > n - 2 || k > n - 2)
				continue;
			d = fmax(fabs(q[v].a - x[0]), fabs(q[v].b - x[1]));
			worst = fmax(worst, d);
			sum += d * d;
			count++;
		}
	e.rms = sqrt(sum / count) / kmax;
	e.max = worst / kmax;
	free(q);
	free(f.frame);
	test_mesh_free(&m);
	return e;
}

/* METHODS 4's table; its figures have one or two digits, so that half a unit of
 * the last one is allowed for. */
static void
errors_are_within_the_table(void)
{
	static const struct errors table[2][5] = {
		{ { 4.5e-4, 1.5e-3 }, { 2.5e-4, 5.5e-4 }, { 2.55e-3, 1.55e-2 },
		    { 2.5e-3, 1.55e-2 }, { 3.5e-3, 2.5e-2 } },
		{ { 3.5e-4, 6.5e-4 }, { 2.5e-4, 4.5e-4 }, { 1.25e-3, 3.5e-3 },
		    { 6.5e-5, 4.5e-4 }, { 6.5e-4, 2.5e-3 } },
	};

	for (int order = 2; order <= 3; order++)
		for (int s = 0; s < 5; s++) {
			struct errors e = measure(&test_surfaces[s], 64, order);

			CHECK(e.rms <= table[order - 2][s].rms);
			CHECK(e.max <= table[order - 2][s].max);
			printf("order %d, %s: rms %.2g, max %.2g\n", order,
			    test_surfaces[s].name, e.rms, e.max);
		}
}

static void
errors_vanish_with_the_spacing(void)
{
	for (int order = 2; order <= 3; order++)
		for (int s = 0; s < 5; s++) {
			struct errors coarse =
			    measure(&test_surfaces[s], 32, order);
			struct errors fine =
			    measure(&test_surfaces[s], 128, order);
			double rate = log2(coarse.rms / fine.rms) / 2;

			CHECK(rate >= (order == 2 ? 0.8 : 1.5));
		}
}

/* -- exact cases --------------------------------------------------------------
 */

/* Frames all alike: normal z, tangent x turned by angle. */
static void
flat_frames(struct bake_frames *f, const struct bake_mesh *m, double angle)
{
	memset(f, 0, sizeof *f);
	f->nframes = m->npositions;
	f->frame = test_calloc(f->nframes, sizeof *f->frame);
	for (size_t v = 0; v < m->npositions; v++) {
		struct bake_frame *w = &f->frame[v];

		w->v = w->vt = (int)v;
		w->hand = 1;
		w->normal[2] = 1;
		w->tangent[0] = w->ps[0] = cos(angle);
		w->tangent[1] = w->ps[1] = sin(angle);
		w->pt[0] = -sin(angle);
		w->pt[1] = cos(angle);
	}
}

enum { SIDE = 8, CENTRE = (SIDE / 2) * (SIDE + 1) + SIDE / 2 };

/* A jittered grid around the origin, with z = -polynomial(x, y). */
static void
graph(struct bake_mesh *m, double (*height)(double x, double y))
{
	unsigned seed = 3;

	test_grid(m, SIDE);
	for (size_t v = 0; v < m->npositions; v++) {
		double jitter = v == CENTRE ? 0 : 0.3;
		double x = (double)(v % (SIDE + 1)) - SIDE / 2;
		double y = (double)(v / (SIDE + 1)) - SIDE / 2;

		x += jitter * (2 * test_random(&seed) - 1);
		y += jitter * (2 * test_random(&seed) - 1);
		m->positions[v][0] = 0.1 * x;
		m->positions[v][1] = 0.1 * y;
		m->positions[v][2] = -height(0.1 * x, 0.1 * y);
	}
}

static double
paraboloid(double x, double y)
{
	return 0.7 * x * x + 0.2 * y * y;
}

static double
cubic(double x, double y)
{
	return 0.7 * x * x + 0.2 * y * y - 0.4 * x * y + 3 * x * x * x -
	       2 * x * x * y + x * y * y - 4 * y * y * y;
}

static void
apex_of_a_paraboloid_is_exact(void)
{
	for (int order = 2; order <= 3; order++) {
		struct bake_quadric_params p = params_of(order);
		struct bake_mesh m;
		struct bake_frames f;
		struct bake_quadric *q;

		graph(&m, order == 2 ? paraboloid : cubic);
		flat_frames(&f, &m, 0);
		q = fit(&m, NULL, &f, &p);
		/* the model holds the surface: only rounding is left */
		CHECK_NEAR(q[CENTRE].a, 0.7, 1e-9);
		CHECK_NEAR(q[CENTRE].b, 0.2, 1e-9);
		CHECK_NEAR(q[CENTRE].c, order == 2 ? 0 : -0.4, 1e-9);
		CHECK(q[CENTRE].rank == (order == 2 ? 5 : 9));
		CHECK(q[CENTRE].residual < 1e-12);
		free(q);
		free(f.frame);
		test_mesh_free(&m);
	}
}

/* The normal of the frame is wrong by 8 degrees: the curvature in the frame's
 * x direction is still that of the surface, to first order in nothing. */
static void
slope_is_corrected(void)
{
	struct bake_quadric_params p = params_of(3);
	const double tilt = 0.14, k = 0.7;
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_quadric *q;

	graph(&m, paraboloid);
	flat_frames(&f, &m, 0);
	f.frame[CENTRE].normal[0] = sin(tilt);
	f.frame[CENTRE].normal[2] = cos(tilt);
	f.frame[CENTRE].tangent[0] = cos(tilt);
	f.frame[CENTRE].tangent[2] = -sin(tilt);
	q = fit(&m, NULL, &f, &p);
	/* the tilted graph is no polynomial: what order 3 leaves out is of the
	 * fourth order, 5/8 (2 k)^3 tan^2 tilt r^4 with r up to 0.35 */
	CHECK_NEAR(q[CENTRE].a, k, 5e-3);
	CHECK_NEAR(q[CENTRE].b, 0.2, 2e-3);
	free(q);
	free(f.frame);
	test_mesh_free(&m);
}

static double
flat(double x, double y)
{
	(void)x;
	(void)y;
	return 0;
}

/* Turn and move a mesh and its frames. */
static void
move(struct bake_mesh *m, struct bake_frames *f, const double r[3][3],
    const double by[3])
{
	for (size_t v = 0; v < m->npositions; v++) {
		double p[3], n[3], t[3];

		for (int c = 0; c < 3; c++) {
			p[c] = test_dot(r[c], m->positions[v]) + by[c];
			n[c] = test_dot(r[c], f->frame[v].normal);
			t[c] = test_dot(r[c], f->frame[v].tangent);
		}
		memcpy(m->positions[v], p, sizeof p);
		memcpy(f->frame[v].normal, n, sizeof n);
		memcpy(f->frame[v].tangent, t, sizeof t);
	}
}

/* A rotation about an axis through the origin, by Rodrigues. */
static void
rotation(double r[3][3], double x, double y, double z, double angle)
{
	double a[3] = { x, y, z };

	test_normalize(a);
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		r[i][i] = cos(angle) + (1 - cos(angle)) * a[i] * a[i];
		r[i][j] = (1 - cos(angle)) * a[i] * a[j] - sin(angle) * a[k];
		r[j][i] = (1 - cos(angle)) * a[i] * a[j] + sin(angle) * a[k];
	}
}

static void
plane_is_exactly_zero(void)
{
	for (int i = 0; i < 400; i++) {
		struct bake_quadric_params p = params_of(2 + i % 2);
		double by[3] = { 3.3 * i, -1e4 * (i / 8), 0.1 }, r[3][3];
		struct bake_mesh m;
		struct bake_frames f;
		struct bake_quadric *q;

		rotation(r, 1, 0.3 * i, -0.2, 0.37 * i);
		graph(&m, flat);
		flat_frames(&f, &m, 0.5);
		move(&m, &f, (const double(*)[3])r, by);
		q = fit(&m, NULL, &f, &p);
		for (size_t v = 0; v < f.nframes; v++) {
			CHECK(q[v].a == 0 && q[v].b == 0 && q[v].c == 0);
			CHECK(!signbit(q[v].a) && !signbit(q[v].b));
			CHECK(q[v].a_tex == 0 && q[v].b_tex == 0);
		}
		free(q);
		free(f.frame);
		test_mesh_free(&m);
	}
}

/* -- what must not matter, or in a known way ------------------------------ */

static void
turning_and_moving_changes_nothing(void)
{
	const struct test_surface *s = &test_surfaces[2];
	struct bake_quadric_params p = params_of(2);
	const double by[3] = { 1, -2, 3 };
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_quadric *q, *moved;
	double r[3][3];

	test_patch(&m, s, 12, 0.25);
	test_frames(&f, &m, s, test_pi / 6);
	q = fit(&m, NULL, &f, &p);
	rotation(r, 1, 2, 3, 1.1);
	move(&m, &f, (const double(*)[3])r, by);
	moved = fit(&m, NULL, &f, &p);
	/* coordinates of 4 have 4e-16 of rounding, over r^2 = 0.005 */
	for (size_t v = 0; v < f.nframes; v++) {
		CHECK_NEAR(moved[v].a, q[v].a, 1e-11);
		CHECK_NEAR(moved[v].b, q[v].b, 1e-11);
		CHECK_NEAR(moved[v].c, q[v].c, 1e-11);
	}
	free(q);
	free(moved);
	free(f.frame);
	test_mesh_free(&m);
}

static void
scaling_by_k_divides_by_k(void)
{
	static const double scales[] = { 0.25, 1e-30, 1e-9, 3, 1e7, 1e30,
		1e-120, 1e120 };
	const struct test_surface *s = &test_surfaces[4];

	for (int order = 2; order <= 3; order++) {
		struct bake_quadric_params p = params_of(order);
		struct bake_mesh m;
		struct bake_frames f;
		struct bake_quadric *q, *scaled;

		test_patch(&m, s, 10, 0.25);
		test_frames(&f, &m, s, test_pi / 6);
		q = fit(&m, NULL, &f, &p);
		for (int i = 0; i < 8; i++) {
			double k = scales[i];

			for (size_t v = 0; v < m.npositions; v++)
				for (int c = 0; c < 3; c++)
					m.positions[v][c] *= k;
			scaled = fit(&m, NULL, &f, &p);
			for (size_t v = 0; v < f.nframes; v++) {
				/* a power of two scales exactly; else
				 * rounding of 2e-16 over r^2 = 0.005 */
				double tol = i == 0 ? 0 : 1e-10;

				CHECK_NEAR(scaled[v].a * k, q[v].a, tol);
				CHECK_NEAR(scaled[v].b * k, q[v].b, tol);
				CHECK_NEAR(scaled[v].residual / k,
				    q[v].residual, i == 0 ? 0 : 1e-13);
			}
			free(scaled);
			for (size_t v = 0; v < m.npositions; v++)
				for (int c = 0; c < 3; c++)
					m.positions[v][c] /= k;
		}
		free(q);
		free(f.frame);
		test_mesh_free(&m);
	}
}

static void
mirrored_uvs_change_no_a_or_b(void)
{
	const struct test_surface *s = &test_surfaces[3];
	struct bake_quadric_params p = params_of(2);
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_quadric *q, *mirrored;

	test_patch(&m, s, 10, 0.25);
	test_frames(&f, &m, s, test_pi / 6);
	q = fit(&m, NULL, &f, &p);
	for (size_t v = 0; v < f.nframes; v++) {
		f.frame[v].hand = -1;
		for (int c = 0; c < 3; c++) {
			f.frame[v].tangent[c] *= -1;
			f.frame[v].ps[c] *= -1;
		}
	}
	mirrored = fit(&m, NULL, &f, &p);
	for (size_t v = 0; v < f.nframes; v++) {
		CHECK(mirrored[v].a == q[v].a && mirrored[v].b == q[v].b);
		CHECK(mirrored[v].c == -q[v].c);
		CHECK(mirrored[v].a_tex == q[v].a_tex);
		CHECK(mirrored[v].c_tex == -q[v].c_tex);
	}
	free(q);
	free(mirrored);
	free(f.frame);
	test_mesh_free(&m);
}

static void
outward_negates(void)
{
	const struct test_surface *s = &test_surfaces[2];
	struct bake_quadric_params p = params_of(2);
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_quadric *q, *out;

	test_patch(&m, s, 8, 0.25);
	test_frames(&f, &m, s, 0);
	q = fit(&m, NULL, &f, &p);
	p.sign = BAKE_QUADRIC_OUTWARD;
	out = fit(&m, NULL, &f, &p);
	for (size_t v = 0; v < f.nframes; v++) {
		CHECK(q[v].b > 0); /* along the tube, convex */
		CHECK(out[v].a == -q[v].a && out[v].b == -q[v].b);
		CHECK(out[v].a_tex == -q[v].a_tex);
	}
	free(q);
	free(out);
	free(f.frame);
	test_mesh_free(&m);
}

/* Cut the grid in two along a column: its vertices are there twice. */
static void
cut(struct bake_mesh *cut, const struct bake_mesh *m, int n, int column)
{
	size_t side = (size_t)n + 1;

	memset(cut, 0, sizeof *cut);
	cut->npositions = m->npositions + side;
	cut->ntriangles = m->ntriangles;
	cut->positions = test_calloc(cut->npositions, sizeof *cut->positions);
	cut->triangles = test_calloc(cut->ntriangles, sizeof *cut->triangles);
	memcpy(
	    cut->positions, m->positions, m->npositions * sizeof *m->positions);
	memcpy(
	    cut->triangles, m->triangles, m->ntriangles * sizeof *m->triangles);
	for (size_t row = 0; row < side; row++)
		memcpy(cut->positions[m->npositions + row],
		    m->positions[row * side + (size_t)column],
		    sizeof *m->positions);
	for (size_t t = 0; t < m->ntriangles; t++)
		for (int k = 0; k < 3; k++) {
			int *v = &cut->triangles[t][k].v;

			if ((int)(t / 2) % n >= column &&
			    *v % (n + 1) == column)
				*v = (int)m->npositions + *v / (n + 1);
		}
}

static void
seams_change_nothing(void)
{
	enum { N = 12 };
	const struct test_surface *s = &test_surfaces[2];

	for (int order = 2; order <= 3; order++) {
		struct bake_quadric_params p = params_of(order);
		struct bake_weld weld = BAKE_WELD_INIT;
		struct bake_err err = BAKE_ERR_INIT;
		struct bake_mesh m, seamed;
		struct bake_frames f, g;
		struct bake_quadric *q, *r;

		test_patch(&m, s, N, 0.25);
		test_frames(&f, &m, s, test_pi / 6);
		q = fit(&m, NULL, &f, &p);
		cut(&seamed, &m, N, 5);
		test_frames(&g, &seamed, s, test_pi / 6);
		CHECK_OK(bake_mesh_weld(&seamed, 0, &weld, &err), err);
		CHECK(weld.npoints == m.npositions);
		r = fit(&seamed, &weld, &g, &p);
		/* the same points and neighbours: the same bits */
		for (size_t v = 0; v < g.nframes; v++) {
			size_t same = v < m.npositions
					  ? v
					  : (v - m.npositions) * (N + 1) + 5;

			CHECK(memcmp(&r[v], &q[same], sizeof *r) == 0);
		}
		bake_weld_free(&weld);
		free(q);
		free(r);
		free(f.frame);
		free(g.frame);
		test_mesh_free(&m);
		test_mesh_free(&seamed);
	}
}

/* place[v] is where vertex v goes */
static void
shuffle(struct bake_mesh *to, const struct bake_mesh *m, int *place)
{
	unsigned seed = 99;

	memset(to, 0, sizeof *to);
	to->npositions = m->npositions;
	to->ntriangles = m->ntriangles;
	to->positions = test_calloc(m->npositions, sizeof *m->positions);
	to->triangles = test_calloc(m->ntriangles, sizeof *m->triangles);
	for (size_t v = 0; v < m->npositions; v++)
		place[v] = (int)v;
	for (size_t v = m->npositions - 1; v > 0; v--) {
		size_t k = (size_t)(test_random(&seed) * (double)(v + 1));
		int t = place[v];

		place[v] = place[k];
		place[k] = t;
	}
	for (size_t v = 0; v < m->npositions; v++)
		memcpy(to->positions[place[v]], m->positions[v],
		    sizeof *m->positions);
	for (size_t t = 0; t < m->ntriangles; t++)
		for (size_t k = 0; k < 3; k++) {
			size_t other = m->ntriangles - 1 - t;

			to->triangles[other][(k + t) % 3].v =
			    place[m->triangles[t][k].v];
		}
}

static void
order_of_vertices_changes_nothing(void)
{
	const struct test_surface *s = &test_surfaces[2];

	for (int order = 2; order <= 3; order++) {
		struct bake_quadric_params p = params_of(order);
		struct bake_mesh m, shuffled;
		struct bake_frames f, g;
		struct bake_quadric *q, *r;
		int *place;

		test_patch(&m, s, 20, 0.25);
		test_frames(&f, &m, s, test_pi / 6);
		q = fit(&m, NULL, &f, &p);
		place = test_calloc(m.npositions, sizeof *place);
		shuffle(&shuffled, &m, place);
		test_frames(&g, &shuffled, s, test_pi / 6);
		r = fit(&shuffled, NULL, &g, &p);
		for (size_t v = 0; v < f.nframes; v++)
			CHECK(memcmp(&r[place[v]], &q[v], sizeof *q) == 0);
		free(place);
		free(q);
		free(r);
		free(f.frame);
		free(g.frame);
		test_mesh_free(&m);
		test_mesh_free(&shuffled);
	}
}

static void
threads_and_processors_change_nothing(void)
{
	static const char *const isas[] = { "baseline", "avx2", "avx512" };
	const struct test_surface *s = &test_surfaces[4];

	for (int order = 2; order <= 3; order++) {
		struct bake_quadric_params p = params_of(order);
		struct bake_mesh m;
		struct bake_frames f;
		struct bake_quadric *q, *r;

		/* small meshes get one thread, whatever is asked for */
		test_patch(&m, s, 90, 0.25);
		test_frames(&f, &m, s, 0.3);
		p.nthreads = 1;
		setenv("BAKE_ISA", "baseline", 1);
		q = fit(&m, NULL, &f, &p);
		for (int i = 0; i < 3; i++) {
			setenv("BAKE_ISA", isas[i], 1);
			p.nthreads = 1 + 3 * i;
			r = fit(&m, NULL, &f, &p);
			CHECK(memcmp(r, q, f.nframes * sizeof *q) == 0);
			free(r);
		}
		unsetenv("BAKE_ISA");
		free(q);
		free(f.frame);
		test_mesh_free(&m);
	}
}

/* -- texture space, and the renderer ----------------------------------------
 */

static void
texture_space_is_the_same_surface(void)
{
	const double s = 0.3, t = -0.2, depth = 0.05;
	struct bake_quadric_params p = params_of(2);
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_frame *w;
	struct bake_quadric *q, *r;
	double x = 0, y = 0, z;

	graph(&m, cubic);
	flat_frames(&f, &m, 0.4);
	w = &f.frame[CENTRE];
	/* skewed and stretched UVs */
	for (int c = 0; c < 3; c++) {
		const double b[3] = { -w->tangent[1], w->tangent[0], 0 };

		w->ps[c] = 2 * w->tangent[c] - 0.1 * b[c];
		w->pt[c] = 0.7 * w->tangent[c] + 1.3 * b[c];
		x += (s * w->ps[c] + t * w->pt[c]) * w->tangent[c];
		y += (s * w->ps[c] + t * w->pt[c]) * b[c];
	}
	q = fit(&m, NULL, &f, &p);
	p.depth = depth;
	r = fit(&m, NULL, &f, &p);
	z = q[CENTRE].a * x * x + q[CENTRE].b * y * y + q[CENTRE].c * x * y;
	CHECK_NEAR(q[CENTRE].uvscale[0], sqrt(4.01), 1e-12);
	CHECK_NEAR(q[CENTRE].uvscale[1], sqrt(0.49 + 1.69), 1e-12);
	/* all figures are around 1: rounding */
	CHECK_NEAR(r[CENTRE].a_tex * s * s + r[CENTRE].b_tex * t * t +
		       r[CENTRE].c_tex * s * t,
	    z / depth, 1e-12);
	CHECK_NEAR(q[CENTRE].a_tex,
	    r[CENTRE].a_tex * depth / (0.1 * sqrt(4.01)), 1e-12);
	free(q);
	free(r);
	free(f.frame);
	test_mesh_free(&m);
}

/*
 * A ray that enters a sphere of radius 1 at p and runs along v leaves it after
 * t = 2 vz. The renderer's ray leaves the quadric at t = vz / q, where q =
 * a vx^2 + b vy^2 = (1 - vz^2) / 2: the two differ by the factor 1 - vz^2, and
 * agree where it matters, at the silhouette.
 */
static void
renderer_leaves_a_sphere_where_rays_do(void)
{
	const struct test_surface *s = &test_surfaces[0];
	struct bake_quadric_params p = params_of(2);
	struct errors e = measure(s, 64, 2);
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_quadric *q;

	test_patch(&m, s, 64, 0.25);
	test_frames(&f, &m, s, test_pi / 6);
	q = fit(&m, NULL, &f, &p);
	for (int i = 0; i < 64; i++) {
		size_t v = 32 * 65 + 32;
		double phi = i * test_pi / 32, vz = 0.02 + 0.9 * i / 64;
		double vx = sqrt(1 - vz * vz) * cos(phi);
		double vy = sqrt(1 - vz * vz) * sin(phi);
		double curve =
		    q[v].a * vx * vx + q[v].b * vy * vy + q[v].c * vx * vy;
		double leaves = vz / curve;

		/* c is as wrong as a and b are */
		CHECK_NEAR(leaves * (1 - vz * vz) / (2 * vz), 1, 2 * e.max);
	}
	free(q);
	free(f.frame);
	test_mesh_free(&m);
}

static const struct check_case cases[] = {
	CASE(errors_are_within_the_table),
	CASE(errors_vanish_with_the_spacing),
	CASE(apex_of_a_paraboloid_is_exact),
	CASE(slope_is_corrected),
	CASE(plane_is_exactly_zero),
	CASE(turning_and_moving_changes_nothing),
	CASE(scaling_by_k_divides_by_k),
	CASE(mirrored_uvs_change_no_a_or_b),
	CASE(outward_negates),
	CASE(seams_change_nothing),
	CASE(order_of_vertices_changes_nothing),
	CASE(threads_and_processors_change_nothing),
	CASE(texture_space_is_the_same_surface),
	CASE(renderer_leaves_a_sphere_where_rays_do),
};

int
main(int argc, char **argv)
{
	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
