/* Frames: that no order, no thread and no seam where UVs go on changes a bit.
 */
/* SPDX-License-Identifier: MIT */
#include "quadric.h"
#include "test_frame.h"

/* A bent, rough surface with a UV seam; its vertices and triangles in a
 * given order, and the corners of triangles rotated. */
static struct bake_mesh
rough_mesh(uint64_t order)
{
	enum { N = 20 };
	struct bake_mesh m;
	struct bake_err err = BAKE_ERR_INIT;
	uint64_t seed = 1;
	int v_at[N * N], t_at[2 * (N - 1) * (N - 1)], n = 0;

	CHECK_OK(
	    bake_mesh_alloc(&m, N * N, N * N, 0, 2 * (N - 1) * (N - 1), &err),
	    err);
	for (int i = 0; i < N * N; i++)
		v_at[i] = i;
	for (size_t i = 0; i < m.ntriangles; i++)
		t_at[i] = (int)i;
	for (int i = N * N - 1; i > 0 && order != 0; i--) {
		int j = (int)(chance(&order) * (i + 1)), x = v_at[i];

		v_at[i] = v_at[j];
		v_at[j] = x;
	}
	for (int i = (int)m.ntriangles - 1; i > 0 && order != 0; i--) {
		int j = (int)(chance(&order) * (i + 1)), x = t_at[i];

		t_at[i] = t_at[j];
		t_at[j] = x;
	}
	for (int i = 0; i < N * N; i++) {
		double x = i % N + 0.3 * chance(&seed),
		       y = (double)(i / N) + 0.3 * chance(&seed);

		m.positions[v_at[i]][0] = x;
		m.positions[v_at[i]][1] = y;
		m.positions[v_at[i]][2] = chance(&seed);
		m.uvs[v_at[i]][0] = 0.05 * x + 0.01 * chance(&seed);
		m.uvs[v_at[i]][1] = 0.05 * y + 0.01 * chance(&seed);
	}
	for (int j = 0; j + 1 < N; j++)
		for (int i = 0; i + 1 < N; i++)
			for (int k = 0; k < 2; k++, n++) {
				int a = j * N + i;
				const int c[2][3] = { { a, a + 1, a + N },
					{ a + 1, a + N + 1, a + N } };
				int turn =
				    order != 0 ? (int)(chance(&order) * 3) : 0;

				for (int q = 0; q < 3; q++) {
					int v = v_at[c[k][(q + turn) % 3]];
					struct bake_corner at = { v, v, -1 };

					m.triangles[t_at[n]][q] = at;
				}
			}
	return m;
}

static int
by_place(const void *a, const void *b)
{
	const double *p = a, *q = b;

	for (int k = 0; k < 16; k++)
		if (p[k] != q[k])
			return p[k] < q[k] ? -1 : 1;
	return 0;
}

/* All frames as numbers, position first, sorted. */
static double (
    *sorted(const struct bake_mesh *m, const struct bake_frames *f))[16]
{
	double(*x)[16] = malloc(f->nframes * sizeof *x);

	if (x == NULL)
		abort();
	for (size_t i = 0; i < f->nframes; i++) {
		const struct bake_frame *a = &f->frame[i];

		memcpy(x[i], m->positions[a->v], 3 * sizeof(double));
		memcpy(x[i] + 3, a->normal, 3 * sizeof(double));
		memcpy(x[i] + 6, a->tangent, 3 * sizeof(double));
		memcpy(x[i] + 9, a->ps, 3 * sizeof(double));
		memcpy(x[i] + 12, a->pt, 3 * sizeof(double));
		x[i][15] = a->hand;
	}
	qsort(x, f->nframes, sizeof *x, by_place);
	return x;
}

static void
no_order_and_no_number_of_threads_changes_a_bit(void)
{
	struct bake_mesh m = rough_mesh(0);
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_frames f = frames_of(&m, p);
	double(*x)[16] = sorted(&m, &f);

	check_frames(&m, &f);
	for (uint64_t order = 1; order < 6; order++) {
		struct bake_mesh m2 = rough_mesh(order);
		struct bake_frames f2;
		double(*x2)[16];

		p.nthreads = (int)order;
		f2 = frames_of(&m2, p);
		x2 = sorted(&m2, &f2);
		CHECK(f2.nframes == f.nframes);
		CHECK(memcmp(x, x2, f.nframes * sizeof *x) == 0);
		free(x2);
		bake_frames_free(&f2);
		bake_mesh_free(&m2);
	}
	free(x);
	bake_frames_free(&f);
	bake_mesh_free(&m);
}

/* -- seams --------------------------------------------------------------- */

static void
shuffle(int *x, int n, uint64_t *order)
{
	for (int i = 0; i < n; i++)
		x[i] = i;
	for (int i = n - 1; i > 0 && *order != 0; i--) {
		int j = (int)(chance(order) * (i + 1)), t = x[i];

		x[i] = x[j];
		x[j] = t;
	}
}

enum { TORUS = 16, TORUS_UVS = (TORUS + 1) * (TORUS + 1) };

/* How UVs are rounded. */
enum { EXACT, FLOATS, DECIMALS };

static double
round_uv(double x, int rounding)
{
	if (rounding == FLOATS)
		return (double)(float)x;
	return rounding == DECIMALS ? floor(x * 1e6 + 0.5) / 1e6 : x;
}

/*
 * A rough torus of n times n quadrangles of which the first column is start,
 * and the first row too: there the UVs have a seam. open leaves out half of the
 * rows; split gives each UV a position of its own; size is the UVs' extent;
 * order that of all, 0 for none.
 */
struct shape {
	int n, start;
	bool open, split;
	double size;
	int rounding;
	uint64_t order;
};

static int *
ints(int n)
{
	int *x = malloc((size_t)n * sizeof *x);

	if (x == NULL)
		abort();
	return x;
}

static void
torus_point(int n, int x, int y, double p[3])
{
	uint64_t seed = (uint64_t)(y * n + x) + 7;
	double a = 2 * pi * (x + 0.3 * chance(&seed)) / n;
	double b = 2 * pi * (y + 0.3 * chance(&seed)) / n;
	double r = 1.0 + chance(&seed) / n;

	p[0] = (3 + r * cos(b)) * cos(a);
	p[1] = (3 + r * cos(b)) * sin(a);
	p[2] = r * sin(b);
}

static struct bake_mesh
torus(struct shape s)
{
	static const int step[2][3][2] = { { { 0, 0 }, { 1, 0 }, { 1, 1 } },
		{ { 0, 0 }, { 1, 1 }, { 0, 1 } } };
	int n = s.n, nt = 2 * n * (s.open ? n / 2 : n);
	int nuvs = (n + 1) * (n + 1), nv = s.split ? nuvs : n * n;
	int *v_at = ints(nv), *uv_at = ints(nuvs), *t_at = ints(nt);
	struct bake_mesh m;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(
	    bake_mesh_alloc(&m, (size_t)nv, (size_t)nuvs, 0, (size_t)nt, &err),
	    err);
	shuffle(v_at, nv, &s.order);
	shuffle(uv_at, nuvs, &s.order);
	shuffle(t_at, nt, &s.order);
	for (int i = 0; i < nv; i++)
		torus_point(n, 0, 0, m.positions[i]);
	for (int i = 0; i < nuvs; i++) {
		double *uv = m.uvs[uv_at[i]];

		uv[0] = round_uv(s.size * (i % (n + 1)) / n, s.rounding);
		uv[1] = round_uv(s.size * (i / (n + 1)) / n, s.rounding);
	}
	for (int i = 0; i < nt; i++) {
		int turn = s.order != 0 ? (int)(chance(&s.order) * 3) : 0;

		for (int k = 0; k < 3; k++) {
			const int *d = step[i % 2][(k + turn) % 3];
			int x = i / 2 % n + d[0], y = i / 2 / n + d[1];
			int px = (x + s.start) % n;
			int py = (y + (s.open ? 0 : s.start)) % n;
			int uv = y * (n + 1) + x;
			int v = v_at[s.split ? uv : py * n + px];

			torus_point(n, px, py, m.positions[v]);
			m.triangles[t_at[i]][k] =
			    (struct bake_corner){ v, uv_at[uv], -1 };
		}
	}
	free(v_at);
	free(uv_at);
	free(t_at);
	return m;
}

/* Whether two frames are the same bits but for v and vt. */
static bool
same_frame(const struct bake_frame *a, const struct bake_frame *b)
{
	return a->flags == b->flags && a->hand == b->hand &&
	       memcmp(a->normal, b->normal, sizeof a->normal) == 0 &&
	       memcmp(a->tangent, b->tangent, sizeof a->tangent) == 0 &&
	       memcmp(a->ps, b->ps, sizeof a->ps) == 0 &&
	       memcmp(a->pt, b->pt, sizeof a->pt) == 0;
}

/* How many frames differ from the one before them at the same position. */
static int
differences(const struct bake_frames *f)
{
	int n = 0;

	for (size_t i = 1; i < f->nframes; i++)
		n += f->frame[i].v == f->frame[i - 1].v &&
		     !same_frame(&f->frame[i], &f->frame[i - 1]);
	return n;
}

static void
a_seam_where_uvs_go_on_changes_no_bit(void)
{
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;

	for (int open = 0; open < 2; open++)
		for (int rounding = EXACT; rounding <= DECIMALS; rounding++) {
			/* sixteenths are exact: the UV edges, too, wherever
			 * the seam is; 0.7 / 16 is not */
			struct shape shape = { .n = TORUS,
				.open = open != 0,
				.size = rounding == EXACT ? 1.0 : 0.7,
				.rounding = rounding };
			struct bake_mesh m = torus(shape);
			struct bake_frames f = frames_of(&m, p), g;
			struct bake_mesh other;

			shape.start = 5;
			other = torus(shape);
			g = frames_of(&other, p);
			check_frames(&m, &f);
			CHECK(f.nframes == (open ? (TORUS + 1) * (TORUS / 2 + 1)
						 : TORUS_UVS));
			CHECK(f.mirror_mixed == 0 && f.tangent_none == 0);
			CHECK(differences(&f) == 0 && differences(&g) == 0);
			/* a position is inside the one, at the other's seam */
			for (size_t i = 0, k = 0;
			     i < f.nframes && rounding == EXACT; i++) {
				for (k = 0; k < g.nframes &&
					    g.frame[k].v != f.frame[i].v;
				     k++)
					;
				CHECK(k < g.nframes &&
				      same_frame(&f.frame[i], &g.frame[k]));
			}
			bake_frames_free(&f);
			bake_frames_free(&g);
			bake_mesh_free(&m);
			bake_mesh_free(&other);
		}
}

/* Small ones are done in their own order, large ones are put in another. */
static void
a_shuffled_seam_is_the_same_bits(void)
{
	static const struct shape shapes[] = {
		{ .n = TORUS, .size = 0.7, .rounding = FLOATS },
		{ .n = TORUS, .size = 0.7, .rounding = FLOATS, .split = true },
		{ .n = 200, .size = 0.7, .rounding = FLOATS },
		{ .n = 200, .size = 0.7, .rounding = FLOATS, .split = true },
	};

	for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
		struct shape shape = shapes[i];
		struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
		struct bake_mesh m = torus(shape);
		struct bake_frames f = frames_of(&m, p);
		double(*x)[16] = sorted(&m, &f);

		for (shape.order = 1; shape.order < 4; shape.order++) {
			struct bake_mesh m2 = torus(shape);
			struct bake_frames f2;
			double(*x2)[16];

			p.nthreads = (int)shape.order;
			f2 = frames_of(&m2, p);
			check_frames(&m2, &f2);
			x2 = sorted(&m2, &f2);
			CHECK(f2.nframes == f.nframes && differences(&f2) == 0);
			CHECK(memcmp(x, x2, f.nframes * sizeof *x) == 0);
			free(x2);
			bake_frames_free(&f2);
			bake_mesh_free(&m2);
		}
		free(x);
		bake_frames_free(&f);
		bake_mesh_free(&m);
	}
}

static void
a_seam_changes_no_bit_of_a_and_b(void)
{
	struct bake_mesh m = torus(
	    (struct shape){ .n = TORUS, .size = 0.7, .rounding = FLOATS });
	struct bake_frame_params fp = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_frames f = frames_of(&m, fp);

	for (int order = 2; order <= 3; order++) {
		struct bake_quadric_params p = BAKE_QUADRIC_PARAMS_DEFAULT;
		struct bake_quadric *q = malloc(f.nframes * sizeof *q);
		struct bake_err err = BAKE_ERR_INIT;

		if (q == NULL)
			abort();
		p.order = order;
		CHECK_OK(bake_quadric_fit(&m, NULL, &f, &p, q, &err), err);
		for (size_t i = 1; i < f.nframes; i++)
			if (f.frame[i].v == f.frame[i - 1].v) {
				CHECK(q[i].a == q[i - 1].a);
				CHECK(q[i].b == q[i - 1].b);
				CHECK(q[i].uvscale[0] == q[i - 1].uvscale[0]);
				CHECK(q[i].uvscale[1] == q[i - 1].uvscale[1]);
			}
		free(q);
	}
	bake_frames_free(&f);
	bake_mesh_free(&m);
}

/* Two quadrangles with a common edge x = 1, bent there by a right angle; the
 * second's UVs are map times (x - 1, y), moved by (5, 7). */
static struct bake_frames
bent_strip(const double map[4])
{
	struct blob b = { NULL, 0 };
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_frames f;

	blob_print(&b, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 -1\n"
		       "v 1 1 -1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n");
	for (int i = 0; i < 4; i++) {
		double x = i == 1 || i == 2, y = i >= 2;

		blob_print(&b, "vt %.17g %.17g\n", 5 + map[0] * x + map[1] * y,
		    7 + map[2] * x + map[3] * y);
	}
	blob_print(&b, "f 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n");
	CHECK_OK(read_bytes(b.p, b.n, "bent.obj", &m, &err), err);
	f = frames_of(&m, p);
	check_frames(&m, &f);
	free(b.p);
	bake_mesh_free(&m);
	return f;
}

static void
charts_are_joined_by_translation_only(void)
{
	static const double same[4] = { 1, 0, 0, 1 };
	/* turned by 90 degrees, by a little, mirrored across and along the
	 * edge, larger, a little larger */
	static const double others[][4] = { { 0, -1, 1, 0 },
		{ 1, -0.02, 0.02, 1 }, { -1, 0, 0, 1 }, { 1, 0, 0, -1 },
		{ 2, 0, 0, 2 }, { 1.01, 0, 0, 1.0001 } };
	struct bake_frames f = bent_strip(same);

	/* frames 1 and 2 are of position 2, the first at the bend: one mean
	 * of (1, 0, 0) by 90 degrees and (0, 0, -1) by 90 (a corner of each
	 * quadrangle, however it is cut) */
	CHECK(f.frame[1].v == 1 && f.frame[2].v == 1 && f.nframes == 8);
	CHECK(differences(&f) == 0);
	CHECK_NEAR(f.frame[1].ps[0], 0.5, 1e-15);
	CHECK_NEAR(f.frame[1].ps[2], -0.5, 1e-15);
	bake_frames_free(&f);
	for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
		const double *o = others[i];
		double det = o[0] * o[3] - o[1] * o[2];

		f = bent_strip(o);
		/* each side has its own, exactly: the first x, the second the
		 * inverse of its map, whose edges are (0, 0, -1) and y; UVs
		 * near 7 are rounded to 9e-16 */
		CHECK(differences(&f) == 2);
		CHECK_NEAR(f.frame[1].ps[0], 1.0, 1e-15);
		CHECK_NEAR(f.frame[1].ps[2], 0.0, 1e-15);
		CHECK_NEAR(f.frame[2].ps[0], 0.0, 1e-14);
		CHECK_NEAR(f.frame[2].ps[1], -o[2] / det, 1e-14);
		CHECK_NEAR(f.frame[2].ps[2], -o[3] / det, 1e-14);
		CHECK(f.frame[2].hand == (det < 0.0 ? -1 : 1));
		CHECK(f.mirror_mixed == 0);
		bake_frames_free(&f);
	}
}

static void
a_third_triangle_at_an_edge_ends_the_walk(void)
{
	/* the two sides of a seam, and a fin on it without UVs */
	const char text[] =
	    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 0 -1\nv 1 0 1\nvt 0 0\nvt 1 0\n"
	    "vt 1 1\nvt 2 0\nvt 3 0\nvt 2 1\nf 1/1 2/2 3/3\nf 2/4 4/5 3/6\n"
	    "f 2 5 3\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;

	for (size_t n = 3; n >= 2; n--) {
		struct bake_frames f;

		CHECK_OK(read_text(text, "a.obj", &m, &err), err);
		m.ntriangles = n;
		f = frames_of(&m, p);
		check_frames(&m, &f);
		CHECK((differences(&f) == 0) == (n == 2));
		bake_frames_free(&f);
		bake_mesh_free(&m);
	}
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(no_order_and_no_number_of_threads_changes_a_bit),
		CASE(a_seam_where_uvs_go_on_changes_no_bit),
		CASE(a_shuffled_seam_is_the_same_bits),
		CASE(a_seam_changes_no_bit_of_a_and_b),
		CASE(charts_are_joined_by_translation_only),
		CASE(a_third_triangle_at_an_edge_ends_the_walk),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
