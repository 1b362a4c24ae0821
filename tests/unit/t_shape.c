/* Built-in shapes: closed, outward, with the frames that their UVs ask for. */
/* SPDX-License-Identifier: MIT */
#include "shape.h"

#include "check.h"
#include "test_mesh.h"
#include "test_solid.h"

enum { NSHAPES = BAKE_SHAPE_TEAPOT + 1 };

static const double pi = 3.14159265358979323846;
static const int details[] = { 1, 2, 3, 5, 16 };
enum { NDETAILS = sizeof details / sizeof *details };

static struct bake_mesh
make(enum bake_shape shape, int detail)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_shape_make(shape, detail, &m, &err), err);
	return m;
}

static double
dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void
minus(const double a[3], const double b[3], double c[3])
{
	for (int k = 0; k < 3; k++)
		c[k] = a[k] - b[k];
}

static void
cross(const double a[3], const double b[3], double c[3])
{
	for (int k = 0; k < 3; k++) {
		int k1 = (k + 1) % 3, k2 = (k + 2) % 3;

		c[k] = a[k1] * b[k2] - a[k2] * b[k1];
	}
}

static void
names_go_there_and_back(void)
{
	static const char *const names[NSHAPES] = { "plane", "cube", "sphere",
		"cylinder", "torus", "teapot" };
	enum bake_shape shape = BAKE_SHAPE_TORUS;

	for (int s = 0; s < NSHAPES; s++) {
		CHECK(
		    strcmp(bake_shape_name((enum bake_shape)s), names[s]) == 0);
		CHECK(bake_shape_from_name(names[s], &shape));
		CHECK((int)shape == s);
	}
	shape = BAKE_SHAPE_TORUS;
	CHECK(!bake_shape_from_name("Plane", &shape));
	CHECK(!bake_shape_from_name("", &shape));
	CHECK(shape == BAKE_SHAPE_TORUS);
	CHECK(bake_shape_name((enum bake_shape)NSHAPES) == NULL);
}

static void
bad_parameters_are_refused(void)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_shape_make(BAKE_SHAPE_CUBE, -1, &m, &err) == BAKE_EINVAL);
	CHECK(strcmp(err.msg,
		  "detail -1 of a shape: it is 1 to 1024, or 0 for 16") == 0);
	CHECK(bake_shape_make(BAKE_SHAPE_CUBE, 1025, &m, &err) == BAKE_EINVAL);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_shape_make((enum bake_shape)NSHAPES, 1, &m, &err) ==
	      BAKE_EINVAL);
	CHECK(strcmp(err.msg, "shape 6 is none of the 6, 0 to 5") == 0);
	CHECK(m.positions == NULL);
}

/* Euler's characteristic, and edges at which a surface ends, in 'detail's. */
static void
check_topology(enum bake_shape shape, int d)
{
	static const struct {
		int euler, boundary, components;
	} want[NSHAPES] = { { 1, 4, 1 }, { 2, 0, 1 }, { 2, 0, 1 }, { 2, 0, 1 },
		{ 0, 0, 1 },
		/* two discs, two open tubes, one of which touches a disc */
		{ 2 - 1, 6 * 4, 3 } };
	struct bake_mesh m = make(shape, d);
	struct bake_topology t;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(is_valid(&m));
	CHECK_OK(bake_mesh_topology(&m, NULL, &t, &err), err);
	CHECK(
	    (int)(t.points + t.triangles) - (int)t.edges == want[shape].euler);
	CHECK((int)t.boundary == want[shape].boundary * d);
	CHECK((int)t.components == want[shape].components);
	CHECK(t.nonmanifold == 0 && t.flipped == 0 && t.isolated == 0 &&
	      t.collapsed == 0);
	CHECK(m.nparts == 1 && m.parts[0].npositions == m.npositions &&
	      m.parts[0].ntriangles == m.ntriangles);
	CHECK(m.nmaterials == 0 && m.material_of[0] == -1 && m.y_up);
	bake_mesh_free(&m);
}

static void
shapes_are_closed_where_they_should_be(void)
{
	for (int s = 0; s < NSHAPES; s++)
		for (int i = 0; i < NDETAILS; i++)
			check_topology((enum bake_shape)s, details[i]);
}

static void
detail_0_is_16(void)
{
	for (int s = 0; s < NSHAPES; s++) {
		struct bake_mesh a = make((enum bake_shape)s, 0);
		struct bake_mesh b = make((enum bake_shape)s, 16);

		CHECK(a.npositions == b.npositions);
		CHECK(a.ntriangles == b.ntriangles);
		CHECK(memcmp(a.positions, b.positions,
			  a.npositions * sizeof *a.positions) == 0);
		bake_mesh_free(&a);
		bake_mesh_free(&b);
	}
}

/* The polyhedra are inscribed: their volume grows to the solid's, by a
 * quarter of the distance for each doubling. */
static void
volumes_are_those_of_the_solids(void)
{
	static const struct {
		enum bake_shape shape;
		double volume;
	} of[] = { { BAKE_SHAPE_CUBE, 8 },
		{ BAKE_SHAPE_SPHERE, 4 * 3.14159265358979323846 / 3 },
		{ BAKE_SHAPE_CYLINDER, 2 * 3.14159265358979323846 },
		{ BAKE_SHAPE_TORUS, 2 * 3.14159265358979323846 *
					3.14159265358979323846 * 0.16 } };

	for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
		double missing[2];

		for (int k = 0; k < 2; k++) {
			struct bake_mesh m = make(of[i].shape, 16 << k);

			missing[k] = of[i].volume - solid_volume6(&m) / 6;
			bake_mesh_free(&m);
		}
		if (of[i].shape == BAKE_SHAPE_CUBE) {
			CHECK_NEAR(missing[0], 0, 1e-13);
			continue;
		}
		CHECK(missing[1] > 0);
		/* next order: a part of the angle squared, (pi / 32)^2 = 0.01
		 */
		CHECK_NEAR(missing[0] / missing[1], 4, 0.01);
	}
}

/* Unit frames; a triangle's uv and corners run the same way round, so that
 * all frames are right-handed; normals on the side of the winding. */
static void
check_frames(enum bake_shape shape, int d)
{
	struct bake_mesh m = make(shape, d);
	double worst_unit = 0, worst_skew = 0;

	for (size_t i = 0; i < m.nnormals; i++) {
		const double *n = m.normals[i], *t = m.tangents[i];

		worst_unit = fmax(worst_unit, fabs(dot(n, n) - 1));
		worst_unit = fmax(worst_unit, fabs(dot(t, t) - 1));
		worst_skew = fmax(worst_skew, fabs(dot(n, t)));
		CHECK(t[3] == 1);
	}
	/* a few roundings each */
	CHECK(worst_unit < 1e-15 && worst_skew < 1e-15);
	for (size_t i = 0; i < m.ntriangles; i++) {
		const struct bake_corner *c = m.triangles[i];
		const double *a = m.uvs[c[0].vt], *b = m.uvs[c[1].vt];
		const double *e = m.uvs[c[2].vt];
		double p[3], q[3], n[3];

		CHECK((b[0] - a[0]) * (e[1] - a[1]) >
		      (b[1] - a[1]) * (e[0] - a[0]));
		minus(m.positions[c[1].v], m.positions[c[0].v], p);
		minus(m.positions[c[2].v], m.positions[c[0].v], q);
		cross(p, q, n);
		CHECK(dot(n, n) > 0);
		for (int k = 0; k < 3; k++)
			CHECK(dot(n, m.normals[c[k].vn]) > 0);
	}
	for (size_t i = 0; i < m.nuvs; i++)
		CHECK(m.uvs[i][0] >= 0 && m.uvs[i][0] <= 1 &&
		      m.uvs[i][1] >= 0 && m.uvs[i][1] <= 1);
	bake_mesh_free(&m);
}

static void
frames_are_orthonormal_and_right_handed(void)
{
	for (int s = 0; s < NSHAPES; s++)
		for (int i = 0; i < NDETAILS; i++) {
			/* coarser, the lip of the spout, which is round with
			 * a radius of some 0.01, is a fold */
			if (s == BAKE_SHAPE_TEAPOT && details[i] < 10)
				continue;
			check_frames((enum bake_shape)s, details[i]);
		}
}

/*
 * How far frames are from what the triangles say.
 *   normal   (n0 + n1) . e / |e| for edges e: 0 on a sphere or a cylinder's
 *            ends, O(length^3 / length) on any smooth surface
 *   tangent  the angle's sine between the triangle's direction of u and its
 *            corners' mean tangent: O(length^2) in the middle of a triangle
 *            whose edges are half a diagonal off, so O(length)
 */
static void
measure_frames(const struct bake_mesh *m, double *normal, double *tangent)
{
	*normal = *tangent = 0;
	for (size_t i = 0; i < m->ntriangles; i++) {
		const struct bake_corner *c = m->triangles[i];
		double e[3][3], du[3], mean[3] = { 0, 0, 0 }, x[3], uv[2][2];

		for (int k = 0; k < 3; k++) {
			const double *n0 = m->normals[c[k].vn],
				     *n1 = m->normals[c[(k + 1) % 3].vn];

			minus(m->positions[c[(k + 1) % 3].v],
			    m->positions[c[k].v], e[k]);
			*normal =
			    fmax(*normal, fabs(dot(n0, e[k]) + dot(n1, e[k])) /
					      sqrt(dot(e[k], e[k])));
			for (int j = 0; j < 3; j++)
				mean[j] += m->tangents[c[k].vn][j];
		}
		for (int k = 0; k < 2; k++)
			for (int j = 0; j < 2; j++)
				uv[k][j] =
				    m->uvs[c[k + 1].vt][j] - m->uvs[c[k].vt][j];
		/* of right-handed uvs: the positive factor is left out */
		for (int j = 0; j < 3; j++)
			du[j] = uv[1][1] * e[0][j] - uv[0][1] * e[1][j];
		cross(du, mean, x);
		CHECK(dot(du, mean) > 0);
		*tangent = fmax(*tangent,
		    sqrt(dot(x, x) / (dot(du, du) * dot(mean, mean))));
	}
}

static void
frames_agree_with_differences(void)
{
	for (int s = 0; s < NSHAPES; s++) {
		double normal[2], tangent[2];

		for (int k = 0; k < 2; k++) {
			struct bake_mesh m = make((enum bake_shape)s, 32 << k);

			measure_frames(&m, &normal[k], &tangent[k]);
			bake_mesh_free(&m);
		}
		if (s == BAKE_SHAPE_PLANE || s == BAKE_SHAPE_CUBE) {
			CHECK(normal[1] == 0 && tangent[1] == 0);
			continue;
		}
		/* second order, nearly so round the spout's lip; 1e-13: what
		 * rounding does to edges 0.01 long */
		CHECK(normal[1] < normal[0] / 3 || normal[1] < 1e-13);
		/* first order */
		CHECK(tangent[1] < tangent[0] / 1.8 || tangent[1] < 1e-13);
		CHECK(normal[1] < (s == BAKE_SHAPE_TEAPOT ? 0.03 : 1e-3));
		CHECK(tangent[1] < 0.03);
	}
}

/* Corners that meet at a point of a smooth shape have one normal, and but at
 * the sphere's poles one tangent, whichever side of a seam they are of. */
static void
check_meeting(enum bake_shape shape, int d)
{
	struct bake_mesh m = make(shape, d);
	int *first = malloc(m.npositions * sizeof *first);
	double normal = 0, tangent = 0;

	if (first == NULL)
		abort();
	memset(first, 0xff, m.npositions * sizeof *first);
	for (size_t i = 0; i < 3 * m.ntriangles; i++) {
		struct bake_corner c = m.triangles[i / 3][i % 3];
		const double *p = m.positions[c.v];
		double n[3], t[3];

		/* where the teapot's handle touches its body */
		if (shape == BAKE_SHAPE_TEAPOT && p[0] == -1 && p[2] == 0 &&
		    p[1] == 0.45 - 0.7875)
			continue;
		if (first[c.v] < 0)
			first[c.v] = c.vn;
		minus(m.normals[c.vn], m.normals[first[c.v]], n);
		normal = fmax(normal, sqrt(dot(n, n)));
		minus(m.tangents[c.vn], m.tangents[first[c.v]], t);
		if (shape == BAKE_SHAPE_TORUS || fabs(p[1]) < 1)
			tangent = fmax(tangent, sqrt(dot(t, t)));
	}
	CHECK(normal < 1e-14);
	if (shape != BAKE_SHAPE_TEAPOT)
		CHECK(tangent == 0);
	free(first);
	bake_mesh_free(&m);
}

static void
seams_have_one_frame(void)
{
	for (int i = 0; i < NDETAILS; i++) {
		check_meeting(BAKE_SHAPE_SPHERE, details[i]);
		check_meeting(BAKE_SHAPE_TORUS, details[i]);
		check_meeting(BAKE_SHAPE_TEAPOT, details[i]);
	}
}

/* Positions, normals and the meaning of u and v, by formula. */
static void
surfaces_are_where_they_should_be(void)
{
	struct bake_mesh m = make(BAKE_SHAPE_SPHERE, 7);

	for (size_t i = 0; i < 3 * m.ntriangles; i++) {
		struct bake_corner c = m.triangles[i / 3][i % 3];
		const double *p = m.positions[c.v], *n = m.normals[c.vn];
		const double *uv = m.uvs[c.vt], *t = m.tangents[c.vn];
		double a = 2 * pi * (uv[0] - 0.5), b = pi * (uv[1] - 0.5);

		for (int k = 0; k < 3; k++)
			CHECK_NEAR(n[k], p[k], 4e-16);
		/* u = 1/2 in front, growing to the right */
		CHECK_NEAR(p[0], cos(b) * sin(a), 1e-15);
		CHECK_NEAR(p[1], sin(b), 1e-15);
		CHECK_NEAR(p[2], cos(b) * cos(a), 1e-15);
		CHECK_NEAR(t[0], cos(a), 2e-15);
		CHECK_NEAR(t[1], 0, 0);
		CHECK_NEAR(t[2], -sin(a), 2e-15);
	}
	bake_mesh_free(&m);
	m = make(BAKE_SHAPE_TORUS, 3);
	for (size_t i = 0; i < 3 * m.ntriangles; i++) {
		struct bake_corner c = m.triangles[i / 3][i % 3];
		const double *p = m.positions[c.v], *n = m.normals[c.vn];
		const double *uv = m.uvs[c.vt];
		double a = 2 * pi * (uv[0] - 0.5), b = 2 * pi * (uv[1] - 0.5);

		CHECK_NEAR(p[0], (1 + 0.4 * cos(b)) * sin(a), 2e-15);
		CHECK_NEAR(p[1], 0.4 * sin(b), 2e-15);
		CHECK_NEAR(p[2], (1 + 0.4 * cos(b)) * cos(a), 2e-15);
		CHECK_NEAR(n[0], cos(b) * sin(a), 2e-15);
		CHECK_NEAR(n[1], sin(b), 2e-15);
		CHECK_NEAR(n[2], cos(b) * cos(a), 2e-15);
	}
	bake_mesh_free(&m);
	m = make(BAKE_SHAPE_PLANE, 4);
	for (size_t i = 0; i < 3 * m.ntriangles; i++) {
		struct bake_corner c = m.triangles[i / 3][i % 3];
		const double *p = m.positions[c.v], *uv = m.uvs[c.vt];

		CHECK(p[0] == 2 * uv[0] - 1 && p[1] == 0 &&
		      p[2] == 1 - 2 * uv[1]);
		CHECK(m.normals[c.vn][1] == 1 && m.tangents[c.vn][0] == 1);
	}
	bake_mesh_free(&m);
}

static void
cylinder_and_cube_have_sharp_edges(void)
{
	struct bake_mesh m = make(BAKE_SHAPE_CYLINDER, 6);

	for (size_t i = 0; i < 3 * m.ntriangles; i++) {
		struct bake_corner c = m.triangles[i / 3][i % 3];
		const double *p = m.positions[c.v], *n = m.normals[c.vn];

		if (fabs(n[1]) > 0.5) {
			CHECK(n[1] == p[1] && fabs(p[1]) == 1);
			CHECK_NEAR(p[0], 2 * m.uvs[c.vt][0] - 1, 4e-16);
			CHECK_NEAR(
			    p[2], p[1] * (1 - 2 * m.uvs[c.vt][1]), 4e-16);
		} else {
			CHECK_NEAR(n[0], p[0], 4e-16);
			CHECK_NEAR(n[1], 0, 0);
			CHECK_NEAR(n[2], p[2], 4e-16);
			CHECK_NEAR(p[1], 2 * m.uvs[c.vt][1] - 1, 4e-16);
		}
	}
	bake_mesh_free(&m);
	m = make(BAKE_SHAPE_CUBE, 3);
	CHECK(m.npositions == 56); /* 4^3 - 2^3 */
	for (size_t i = 0; i < 3 * m.ntriangles; i++) {
		struct bake_corner c = m.triangles[i / 3][i % 3];

		CHECK(dot(m.positions[c.v], m.normals[c.vn]) == 1);
	}
	bake_mesh_free(&m);
}

/* The parts of the teapot's mesh, found by their triangles' numbers: 24 patches
 * of quarters before 8 of tubes. */
static int
teapot_part(size_t t, int d)
{
	size_t n = (size_t)(d * d), quarters = 48 * n - 8 * (size_t)d;

	if (t >= quarters)
		return t < quarters + 16 * n ? 2 : 3;
	/* bottom, two of the body, rim: a pole in the first */
	return t < 32 * n - 4 * (size_t)d ? 0 : 1;
}

static double
cubic(double a, double b, double c, double d, double t)
{
	double s = 1 - t;

	return a * s * s * s + 3 * b * s * s * t + 3 * c * s * t * t +
	       d * t * t * t;
}

/* The sum of r^2 dz up the published profile, from the bottom to the rim's
 * inner side, times the area of Newell's round of radius 1; in halves of his
 * unit. */
static double
body_volume(void)
{
	static const double r[4][4] = { { 0, 1.425, 1.5, 1.5 },
		{ 1.5, 1.5, 2, 2 }, { 2, 2, 1.75, 1.5 },
		{ 1.5, 1.4375, 1.3375, 1.4 } };
	static const double z[4][4] = { { 0, 0, 0.075, 0.15 },
		{ 0.15, 0.225, 0.45, 0.9 }, { 0.9, 1.35, 1.875, 2.4 },
		{ 2.4, 2.53125, 2.53125, 2.4 } };
	enum { N = 10000 };
	double area = 0, sum = 0;

	for (int i = 0; i < N; i++) {
		double t = (double)i / N, t1 = (double)(i + 1) / N;
		double x = cubic(1, 1, 0.56, 0, t),
		       x1 = cubic(1, 1, 0.56, 0, t1);
		double y = cubic(0, 0.56, 1, 1, t),
		       y1 = cubic(0, 0.56, 1, 1, t1);

		area += 4 * 0.5 * (x * y1 - y * x1);
		for (int k = 0; k < 4; k++) {
			const double *a = r[k], *b = z[k];
			double m = cubic(a[0], a[1], a[2], a[3], (t + t1) / 2);

			sum += m * m *
			       (cubic(b[0], b[1], b[2], b[3], t1) -
				   cubic(b[0], b[1], b[2], b[3], t));
		}
	}
	return area * sum / 8;
}

/*
 * Each part is wound outwards: its volume, where boundaries, all of them about
 * the plane or axis through their middle, are closed by a fan, is that of a
 * thing of its size. A tube of cross-section A and length L holds A L.
 */
static void
teapot_is_wound_outwards(void)
{
	enum { D = 24 };
	struct bake_mesh m = make(BAKE_SHAPE_TEAPOT, D);
	double volume[4] = { 0, 0, 0, 0 };
	double middle[4][3] = { { 0, 0.4125, 0 }, { 0, 0.4125, 0 },
		{ 0.85, -0.28125, 0 }, { -0.975, -0.4125, 0 } };
	double least = 1, most = -1, x0 = 0, x1 = 0;

	for (size_t t = 0; t < m.ntriangles; t++) {
		const struct bake_corner *c = m.triangles[t];
		int part = teapot_part(t, D);
		double p[3][3], n[3];

		for (int k = 0; k < 3; k++) {
			const double *q = m.positions[c[k].v];

			minus(q, middle[part], p[k]);
			least = fmin(least, q[1]);
			most = fmax(most, q[1]);
			x0 = fmin(x0, q[0]);
			x1 = fmax(x1, q[0]);
		}
		cross(p[1], p[2], n);
		volume[part] += dot(p[0], n) / 6;
	}
	/* the mouth's ring is flat about middle: just the body's and the
	 * lid's own */
	CHECK_NEAR(volume[0], body_volume(), 0.005 * body_volume());
	CHECK(volume[1] > 0.1 && volume[1] < 0.3);
	/* their lower ends are flat about middle, too; the upper ends add or
	 * take a cone that is small against the tube */
	CHECK(volume[2] > 0.05 && volume[2] < 0.3);
	CHECK(volume[3] > 0.01 && volume[3] < 0.1);
	CHECK(least == -0.7875 && most == 0.7875);
	CHECK(x0 == -1.5); /* the handle's outer side */
	/* the lip: max of the cubic 3.3, 3.525, 3.45, 3.2, halved */
	CHECK(x1 > 1.71 && x1 < 1.72);
	bake_mesh_free(&m);
}

/* A ring of the body is Newell's quarter (r, 0), (r, .56 r), (.56 r, r), (0,
 * r): at 45 degrees it is (r + 3 (r + .56 r)) / 8 away on both axes. */
static void
teapot_is_newells(void)
{
	struct bake_mesh m = make(BAKE_SHAPE_TEAPOT, 2);
	const double diagonal = (1 + 3 * 1.56) / 8;
	int nfound = 0, njoin = 0;

	for (size_t i = 0; i < m.npositions; i++) {
		const double *p = m.positions[i];

		if (fabs(p[1] - (0.45 - 0.7875)) > 1e-15)
			continue;
		if (fabs(fabs(p[0]) - diagonal) < 1e-15 &&
		    fabs(fabs(p[2]) - diagonal) < 1e-15)
			nfound++;
		if (fabs(p[0]) + fabs(p[2]) == 1)
			njoin++;
	}
	CHECK(nfound == 4 && njoin == 4);
	bake_mesh_free(&m);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(names_go_there_and_back),
		CASE(bad_parameters_are_refused),
		CASE(shapes_are_closed_where_they_should_be),
		CASE(detail_0_is_16),
		CASE(volumes_are_those_of_the_solids),
		CASE(frames_are_orthonormal_and_right_handed),
		CASE(frames_agree_with_differences),
		CASE(seams_have_one_frame),
		CASE(surfaces_are_where_they_should_be),
		CASE(cylinder_and_cube_have_sharp_edges),
		CASE(teapot_is_wound_outwards),
		CASE(teapot_is_newells),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
