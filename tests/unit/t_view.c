/* Views: axes, what a fitted view holds, and what is refused. */
/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "test_solid.h"
#include "view.h"

static const struct bake_view good = { BAKE_AXIS_POS_Z, 4, 3, 0, 0, 1, 1, 1, 0,
	false, false };

static void
axes_are_right_handed_and_look_at_their_side(void)
{
	static const char *const names[] = { "+x", "-x", "+y", "-y", "+z",
		"-z" };

	for (int a = 0; a < 6; a++) {
		struct bake_axes axes = bake_axis_axes((enum bake_axis)a);
		double m[3][3] = { { 0 } }, det, p[3] = { 2, 3, 5 }, q[3];

		for (int i = 0; i < 3; i++) {
			CHECK(fabs(axes.sign[i]) == 1);
			m[i][axes.index[i]] = axes.sign[i];
		}
		det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) +
		      m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
		      m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
		CHECK(det == 1);
		/* Z is towards the eye */
		CHECK(axes.index[2] == a / 2);
		CHECK(axes.sign[2] == (a % 2 == 0 ? 1 : -1));
		/* seen from the sides, y is up; from above and below, x right
		 */
		if (a / 2 == 1)
			CHECK(m[0][0] == 1);
		else
			CHECK(m[1][1] == 1);
		bake_axes_project(&axes, p, q);
		for (int i = 0; i < 3; i++)
			CHECK(q[i] ==
			      m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2]);
		CHECK(strcmp(bake_axis_name((enum bake_axis)a), names[a]) == 0);
	}
}

static void
a_fitted_view_is_the_smallest_with_square_texels(void)
{
	const double lo[3] = { 1, -2, 10 }, hi[3] = { 4, 0, 11 };
	struct bake_mesh m = solid_box(lo, hi);

	for (int a = 0; a < 6; a++) {
		struct bake_view v = good;
		struct bake_err err = BAKE_ERR_INIT;
		struct bake_axes axes = bake_axis_axes((enum bake_axis)a);
		double p[3], q[3], ex, ey;

		v.axis = (enum bake_axis)a;
		v.width = 100;
		v.height = 50;
		CHECK_OK(bake_view_fit(&v, &m, &err), err);
		bake_axes_project(&axes, lo, p);
		bake_axes_project(&axes, hi, q);
		ex = fabs(p[0] - q[0]);
		ey = fabs(p[1] - q[1]);
		/* numbers of 53 bits, a few operations each */
		CHECK_NEAR(v.x0 + v.x1, p[0] + q[0], 1e-14);
		CHECK_NEAR(v.y0 + v.y1, p[1] + q[1], 1e-13);
		CHECK_NEAR(v.x1 - v.x0, fmax(ex, 2 * ey), 1e-14);
		CHECK_NEAR(v.y1 - v.y0, fmax(ey, ex / 2), 1e-14);
		CHECK(v.near == fmax(p[2], q[2]));
		CHECK(v.far == fmin(p[2], q[2]));
		CHECK_OK(bake_view_check(&v, &err), err);
	}
	bake_mesh_free(&m);
}

static void
flat_meshes_have_a_range_about_them(void)
{
	struct bake_mesh m = solid_alloc(3, 1);
	struct bake_view v = good;
	struct bake_err err = BAKE_ERR_INIT;

	memset(m.positions, 0, 3 * sizeof *m.positions);
	m.positions[1][0] = 6;
	m.positions[2][1] = 2;
	m.positions[0][2] = m.positions[1][2] = m.positions[2][2] = 7;
	solid_triangle(&m, 0, 0, 1, 2);
	CHECK_OK(bake_view_fit(&v, &m, &err), err);
	CHECK(v.near == 10 && v.far == 4);
	/* along z it is a line */
	v.axis = BAKE_AXIS_POS_X;
	CHECK_OK(bake_view_fit(&v, &m, &err), err);
	CHECK(v.near == 6 && v.far == 0);
	CHECK(v.x0 < -7 && v.x1 > -7 && v.y0 <= 0 && v.y1 >= 2);
	/* a line along the axis */
	m.positions[2][1] = 0;
	m.positions[2][0] = 3;
	CHECK_OK(bake_view_fit(&v, &m, &err), err);
	CHECK(v.near == 6 && v.far == 0 && v.x1 - v.x0 >= 6);
	/* neighbouring doubles far from 0 */
	for (int i = 0; i < 3; i++)
		m.positions[i][0] = m.positions[i][1] = 1e9;
	m.positions[1][0] = nextafter(1e9, INFINITY);
	v.axis = BAKE_AXIS_POS_Z;
	CHECK_OK(bake_view_fit(&v, &m, &err), err);
	CHECK(v.x0 <= 1e9 && v.x1 >= m.positions[1][0]);
	CHECK(v.y0 < v.y1 && v.far < v.near);
	bake_mesh_free(&m);
}

static void
what_cannot_be_seen_is_refused(void)
{
	struct bake_mesh none = BAKE_MESH_INIT, m = solid_alloc(3, 1);
	struct bake_view v = good;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_view_fit(&v, &none, &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "the mesh has no triangle to be seen") == 0);
	memset(m.positions, 0, 3 * sizeof *m.positions);
	solid_triangle(&m, 0, 0, 1, 2);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_view_fit(&v, &m, &err) == BAKE_EDATA);
	CHECK(
	    strcmp(err.msg, "all triangles are in one point, (0, 0, 0)") == 0);
	m.positions[0][0] = -1.5e308;
	m.positions[1][0] = 1.5e308;
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_view_fit(&v, &m, &err) == BAKE_EDATA);
	CHECK(strncmp(err.msg, "the mesh is too large for a view", 32) == 0);
	v.height = 0;
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_view_fit(&v, &m, &err) == BAKE_EINVAL);
	bake_mesh_free(&m);
}

static void
check_bad(struct bake_view v, const char *begin)
{
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_view_check(&v, &err) == BAKE_EINVAL);
	CHECK(strncmp(err.msg, begin, strlen(begin)) == 0);
}

static void
bad_views_are_refused(void)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_view v = good;

	CHECK_OK(bake_view_check(&v, &err), err);
	v.width = 65536;
	CHECK_OK(bake_view_check(&v, &err), err);
	v.width = 65537;
	check_bad(v, "a picture of 65537x3 texels");
	v = good;
	v.height = 0;
	check_bad(v, "a picture of 4x0 texels");
	v = good;
	v.axis = (enum bake_axis)6;
	check_bad(v, "axis 6 is none of the six");
	v = good;
	v.x1 = v.x0;
	check_bad(v, "the region from (0, 0) to (0, 1)");
	v = good;
	v.y1 = -1;
	check_bad(v, "the region from (0, 0) to (1, -1)");
	v.y1 = NAN;
	check_bad(v, "the region");
	v.y1 = INFINITY;
	check_bad(v, "the region");
	v = good;
	v.x0 = -1e308;
	v.x1 = 1e308;
	check_bad(v, "the region");
	v = good;
	v.near = v.far;
	check_bad(v, "the depths from near 0 to far 0");
	v.far = 1;
	check_bad(v, "the depths from near 0 to far 1");
	v.far = -INFINITY;
	check_bad(v, "the depths");
	v.far = NAN;
	check_bad(v, "the depths");
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(axes_are_right_handed_and_look_at_their_side),
		CASE(a_fitted_view_is_the_smallest_with_square_texels),
		CASE(flat_meshes_have_a_range_about_them),
		CASE(what_cannot_be_seen_is_refused),
		CASE(bad_views_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
