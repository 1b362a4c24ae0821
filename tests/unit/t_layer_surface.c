/* Normals and colours of layers: closed forms, sides, textures, errors. */
/* SPDX-License-Identifier: MIT */
#include "layer_surface.h"

#include "check.h"
#include "mem.h"
#include "test_maps.h"

/* A mesh with all that is made from it. */
struct scene {
	struct bake_mesh mesh;
	struct bake_weld weld;
	struct bake_view view;
	struct bake_abuffer *ab;
	struct bake_surface *surface;
};

static struct bake_mesh
mesh_of(size_t npositions, size_t nuvs, size_t nnormals, size_t ntriangles)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(
	    bake_mesh_alloc(&m, npositions, nuvs, nnormals, ntriangles, &err),
	    err);
	if (m.ntriangles != ntriangles)
		abort();
	return m;
}

static void
set_triangle(struct bake_mesh *m, int i, int a, int b, int c)
{
	const int v[3] = { a, b, c };

	for (int k = 0; k < 3; k++)
		m->triangles[i][k] = (struct bake_corner){ v[k],
			m->nuvs > 0 ? v[k] : -1, m->nnormals > 0 ? v[k] : -1 };
}

/* The rest of a scene whose mesh and view are there. */
static void
open_scene(struct scene *s, const struct bake_surface_params *params)
{
	const struct bake_abuffer_params rays = BAKE_ABUFFER_PARAMS_DEFAULT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_mesh_weld(&s->mesh, 0, &s->weld, &err), err);
	CHECK_OK(bake_abuffer_open(
		     &s->ab, &s->mesh, &s->weld, &s->view, &rays, &err),
	    err);
	CHECK_OK(bake_surface_open(&s->surface, &s->mesh, &s->weld, s->ab,
		     &s->view, params, &err),
	    err);
	if (s->surface == NULL)
		abort();
}

static void
close_scene(struct scene *s)
{
	bake_surface_close(s->surface);
	bake_abuffer_close(s->ab);
	bake_weld_free(&s->weld);
	bake_mesh_free(&s->mesh);
}

static struct bake_view
view_of(enum bake_axis axis, int width, int height, double size)
{
	return (struct bake_view){ .axis = axis,
		.width = width,
		.height = height,
		.x0 = -size,
		.y0 = -size,
		.x1 = size,
		.y1 = size,
		.near = size,
		.far = -size };
}

/* A point of the view's axes as one of the mesh. */
static void
from_view(enum bake_axis axis, const double q[3], double p[3])
{
	const struct bake_axes axes = bake_axis_axes(axis);

	for (int i = 0; i < 3; i++)
		p[axes.index[i]] = axes.sign[i] * q[i];
}

/*
 * Two triangles on the square -1 .. 1 of the view, z = slope x, seen from their
 * front; UV (0, 0) at the lower left and (1, 1) at the upper right. Corners are
 * lower left, lower right, upper right, upper left; 4 normals, (0, 0, 1) of the
 * view, where with_normals. The cut goes along x = y.
 */
static struct bake_mesh
square(enum bake_axis axis, double slope, bool with_normals)
{
	static const double at[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 },
		{ -1, 1 } };
	struct bake_mesh m = mesh_of(4, 4, with_normals ? 4 : 0, 2);

	for (int i = 0; i < 4; i++) {
		const double q[3] = { at[i][0], at[i][1], slope * at[i][0] };
		const double n[3] = { 0, 0, 1 };

		from_view(axis, q, m.positions[i]);
		for (int k = 0; k < 2; k++)
			m.uvs[i][k] = (at[i][k] + 1) / 2;
		if (with_normals)
			from_view(axis, n, m.normals[i]);
	}
	set_triangle(&m, 0, 0, 1, 2);
	set_triangle(&m, 1, 0, 2, 3);
	return m;
}

/* The crossing at a texel of a square of n x n texels. */
static struct bake_crossing
crossing_at(int x, int y, int n, bool entering)
{
	/* above the cut x = y it is the second triangle */
	return (struct bake_crossing){ 0.5, entering, x < n - 1 - y, 0, 0 };
}

/* n materials, white, opaque, with the identity as UV matrix. */
static void
add_materials(struct bake_mesh *m, size_t n)
{
	struct bake_err err = BAKE_ERR_INIT;

	m->materials = bake_zalloc(n, sizeof *m->materials, &err);
	if (m->materials == NULL)
		abort();
	m->nmaterials = n;
	for (size_t i = 0; i < n; i++)
		m->materials[i].texture.uv_matrix[0][0] =
		    m->materials[i].texture.uv_matrix[1][1] = 1;
	for (size_t i = 0; i < m->ntriangles; i++)
		m->material_of[i] = 0;
}

static void
check_vector(const float got[3], double x, double y, double z, double tol)
{
	CHECK_NEAR(got[0], x, tol);
	CHECK_NEAR(got[1], y, tol);
	CHECK_NEAR(got[2], z, tol);
}

/* -- normals ------------------------------------------------------------- */

/* A sphere of rings x 2 rings quadrangles, without normals, or with its own. */
static struct bake_mesh
sphere(int rings, bool with_normals)
{
	const int n = 2 * rings;
	const size_t nv = (size_t)((rings + 1) * n);
	struct bake_mesh m =
	    mesh_of(nv, 0, with_normals ? nv : 0, (size_t)(2 * rings * n));

	for (int i = 0; i <= rings; i++)
		for (int j = 0; j < n; j++) {
			const double a = pi * i / rings, b = 2 * pi * j / n;
			/* the poles' copies are welded */
			const double r = i % rings == 0 ? 0 : sin(a);
			const double p[3] = { r * cos(b), r * sin(b), cos(a) };

			memcpy(m.positions[i * n + j], p, sizeof p);
			if (with_normals)
				memcpy(m.normals[i * n + j], p, sizeof p);
		}
	for (int i = 0; i < rings; i++)
		for (int j = 0; j < n; j++) {
			const int k = (j + 1) % n, t = 2 * (i * n + j);

			set_triangle(
			    &m, t, i * n + j, (i + 1) * n + j, (i + 1) * n + k);
			set_triangle(
			    &m, t + 1, i * n + j, (i + 1) * n + k, i * n + k);
		}
	return m;
}

/* The largest angle in degrees to the sphere's normals over all crossings. */
static double
sphere_error(struct scene *s, int *nwrong)
{
	struct bake_band band = BAKE_BAND_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	const int n = s->view.width;
	double worst = 0;

	CHECK_OK(bake_abuffer_rows(s->ab, 0, n, &band, &err), err);
	CHECK(band.stats.open == 0);
	for (int i = 0; i < n * n; i++)
		for (size_t c = band.start[i]; c < band.start[i + 1]; c++) {
			const struct bake_crossing *at = &band.crossing[c];
			double want[3] = { -1.1 + 2.2 * (i % n + 0.5) / n,
				1.1 - 2.2 * (i / n + 0.5) / n, 0 };
			double z2 = 1 - want[0] * want[0] - want[1] * want[1];
			double dot = 0, length = 0;
			float got[3];

			z2 = z2 > 0 ? z2 : 0;
			want[2] = sqrt(z2) * (at->entering ? 1 : -1);
			bake_surface_normal(s->surface, at, i % n, i / n, got);
			for (int k = 0; k < 3; k++) {
				dot += want[k] * got[k];
				length += (double)got[k] * got[k];
			}
			*nwrong += !(fabs(sqrt(length) - 1) <= 2e-7) ||
				   (at->entering ? got[2] < 0 : got[2] > 0);
			/* at the limb the facets' own depth is off */
			if (z2 > 0.05 && acos(fmin(dot, 1)) > worst)
				worst = acos(fmin(dot, 1));
		}
	CHECK(band.start[n * n] > 1000);
	bake_band_free(&band);
	return worst * 180 / pi;
}

/*
 * Facets of angle h = pi / 64 at the centre: the interpolated normal at a point
 * of a facet is that of the sphere point in its direction but for the
 * interpolation's third-order part, h^3 / 10 at most; the ray is at the facet
 * and not on the sphere, off by its sagitta h^2 / 4 (half a quadrangle's
 * diagonal is h / sqrt 2), which on a slope of tan t is h^2 / 4 tan t of
 * direction; z2 > 0.05 is tan t < 4.4: 0.152 degrees. Computed normals are off
 * by less than that again on a mesh this regular.
 */
static void
sphere_has_its_normals(void)
{
	for (int k = 0; k < 4; k++) {
		struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
		struct scene s = { .mesh = sphere(64, k % 2),
			.view = view_of((enum bake_axis)(k + 1), 96, 96, 1.1) };
		int nwrong = 0;

		params.nthreads = k + 1;
		if (k == 3)
			params.normals = BAKE_NORMALS_COMPUTED;
		open_scene(&s, &params);
		CHECK(sphere_error(&s, &nwrong) < (k == 1 ? 0.17 : 0.32));
		CHECK(nwrong == 0);
		close_scene(&s);
	}
}

/* Weighted by angles as mesh_frame.h does it: two ways to one result. */
static void
computed_normals_are_those_of_the_frames(void)
{
	const struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
	struct bake_frame_params fp = BAKE_FRAME_PARAMS_DEFAULT;
	struct scene s = { .mesh = sphere(7, false),
		.view = view_of(BAKE_AXIS_POS_Y, 64, 64, 1.5) };
	struct bake_frames frames = BAKE_FRAMES_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_band band = BAKE_BAND_INIT;
	size_t n = 0;

	/* no sphere: every angle and area is another */
	for (size_t i = 0; i < s.mesh.npositions; i++)
		for (int k = 0; k < 3; k++)
			s.mesh.positions[i][k] *=
			    1 + 0.3 * sin(3 * s.mesh.positions[i][(k + 1) % 3]);
	open_scene(&s, &params);
	fp.tangents = BAKE_TANGENTS_AUTO;
	CHECK_OK(
	    bake_mesh_frames(&s.mesh, &s.weld, NULL, &fp, &frames, &err), err);
	CHECK_OK(bake_abuffer_rows(s.ab, 0, 64, &band, &err), err);
	for (int i = 0; i < 64 * 64; i++)
		for (size_t c = band.start[i]; c < band.start[i + 1]; c++) {
			const struct bake_crossing *at = &band.crossing[c];
			double w[3], sum[3] = { 0 }, q[3], length;
			float got[3];

			bake_abuffer_weights(s.ab, at, i % 64, i / 64, w);
			for (int k = 0; k < 3; k++) {
				const int f = frames.frame_of[at->triangle][k];

				for (int d = 0; d < 3; d++)
					sum[d] +=
					    w[k] * frames.frame[f].normal[d];
			}
			length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] +
				      sum[2] * sum[2]);
			/* +y: x, -z, y; those that the rule of signs turns are
			 * not compared */
			q[0] = sum[0] / length;
			q[1] = -sum[2] / length;
			q[2] = sum[1] / length;
			if (at->entering ? q[2] < 0 : q[2] > 0)
				continue;
			bake_surface_normal(s.surface, at, i % 64, i / 64, got);
			/* the corners' and the result's rounding to float */
			check_vector(got, q[0], q[1], q[2], 2.5e-7);
			n++;
		}
	CHECK(n > 1000);
	bake_band_free(&band);
	bake_frames_free(&frames);
	close_scene(&s);
}

/* In the axes of every view; entries and exits of all facets. */
static void
flat_normals_are_the_planes(void)
{
	for (int axis = 0; axis < 6; axis++)
		for (int flat = 0; flat < 2; flat++) {
			struct bake_surface_params params =
			    BAKE_SURFACE_PARAMS_DEFAULT;
			struct scene s = { .mesh = square((enum bake_axis)axis,
					       0.75, false),
				.view =
				    view_of((enum bake_axis)axis, 8, 8, 1) };
			struct bake_crossing at = crossing_at(2, 6, 8, true);
			float got[3];

			params.flat = flat;
			open_scene(&s, &params);
			/* z = 3/4 x has the normal (-3, 0, 4) / 5 */
			bake_surface_normal(s.surface, &at, 2, 6, got);
			check_vector(got, -0.6, 0, 0.8, 2e-7);
			/* left through its front: turned round */
			at.entering = false;
			bake_surface_normal(s.surface, &at, 2, 6, got);
			check_vector(got, 0.6, 0, -0.8, 2e-7);
			close_scene(&s);
		}
}

static void
set_normals(struct bake_mesh *m, double x, double y, double z)
{
	const double length = sqrt(x * x + y * y + z * z);

	for (size_t i = 0; i < m->nnormals; i++) {
		m->normals[i][0] = x / length;
		m->normals[i][1] = y / length;
		m->normals[i][2] = z / length;
	}
}

/* What the file says of a square of the given slope becomes what. */
static void
check_rule(double slope, const double file[3], bool entering, double x,
    double y, double z)
{
	const struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
	struct scene s = { .mesh = square(BAKE_AXIS_POS_Z, slope, true),
		.view = view_of(BAKE_AXIS_POS_Z, 8, 8, 1) };
	const struct bake_crossing at = crossing_at(5, 1, 8, entering);
	float got[3];

	set_normals(&s.mesh, file[0], file[1], file[2]);
	open_scene(&s, &params);
	bake_surface_normal(s.surface, &at, 5, 1, got);
	check_vector(got, x, y, z, 2e-7);
	close_scene(&s);
}

static void
signs_follow_the_side(void)
{
	static const double toward[3] = { 0, 0.6, 0.8 },
			    away[3] = { 0.3, 0.4, -1 },
			    straight_away[3] = { 0, 0, -1 };

	check_rule(0, toward, true, 0, 0.6, 0.8);
	/* into the plane of the picture */
	check_rule(0, away, true, 0.6, 0.8, 0);
	/* nothing left: along the slope, which falls to the left */
	check_rule(0.75, straight_away, true, -1, 0, 0);
	check_rule(-2, straight_away, true, 1, 0, 0);
	/* nor of the slope */
	check_rule(0, straight_away, true, 0, 0, 1);
	/* an exit through the front is the other side of a slab */
	check_rule(0, toward, false, 0, -0.6, -0.8);
	check_rule(0, away, false, -0.6, -0.8, 0);
	check_rule(0.75, straight_away, false, 1, 0, 0);
	check_rule(0, straight_away, false, 0, 0, -1);
}

/* Normals that oppose each other leave the triangle's own. */
static void
opposed_normals_fall_back_to_the_plane(void)
{
	const struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
	struct scene s = { .mesh = square(BAKE_AXIS_POS_Z, 0.75, true),
		.view = view_of(BAKE_AXIS_POS_Z, 8, 8, 1) };
	/* one texel: its centre is the middle of the cut */
	const struct bake_crossing at = { 0.5, true, 0, 0, 0 };
	float got[3];

	s.view.width = s.view.height = 1;
	set_normals(&s.mesh, 0.6, 0, 0.8);
	for (int k = 0; k < 3; k++)
		s.mesh.normals[2][k] = -s.mesh.normals[0][k];
	open_scene(&s, &params);
	bake_surface_normal(s.surface, &at, 0, 0, got);
	check_vector(got, -0.6, 0, 0.8, 2e-7);
	close_scene(&s);
}

/* A corner without a usable normal gets a computed one. */
static void
missing_normals_are_computed(void)
{
	const struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
	struct scene s = { .mesh = square(BAKE_AXIS_POS_Z, 0.75, true),
		.view = view_of(BAKE_AXIS_POS_Z, 1, 1, 1) };
	const struct bake_crossing at = { 0.5, true, 0, 0, 0 };
	const double n[3] = { 1 - 0.6, 0, 0.8 };
	const double length = hypot(n[0], n[2]);
	float got[3];

	/* the cut's middle: half of (1, 0, 0), half of (-3, 0, 4) / 5 */
	set_normals(&s.mesh, 1, 0, 0);
	memset(s.mesh.normals[0], 0, sizeof s.mesh.normals[0]);
	s.mesh.triangles[1][0].vn = -1;
	open_scene(&s, &params);
	bake_surface_normal(s.surface, &at, 0, 0, got);
	check_vector(got, n[0] / length, 0, n[2] / length, 2e-7);
	close_scene(&s);
}

/* Seen all but edge on there is no side that could be wrong. */
static void
slivers_are_not_turned_round(void)
{
	/* texels are 1 wide: 2^-15, and what is beyond 2^-14 */
	static const double widths[] = { 1.0 / 32768, 1e-3 };
	const struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;

	for (int i = 0; i < 2; i++) {
		struct scene s = { .mesh = mesh_of(3, 0, 3, 1),
			.view = view_of(BAKE_AXIS_POS_Z, 8, 8, 4) };
		const double p[3][3] = { { 0.5, -3, 0 },
			{ 0.5 + widths[i], 0, 1 }, { 0.5, 3, -1 } };
		struct bake_crossing at = { 0.5, true, 0, 0, 0 };
		float got[3];

		memcpy(s.mesh.positions, p, sizeof p);
		set_normals(&s.mesh, 0.8, 0, 0.6);
		set_triangle(&s.mesh, 0, 0, 1, 2);
		open_scene(&s, &params);
		/* all corners have one normal: weights do not matter but for
		 * their rounding, at 1e5 times the triangle's width from it */
		bake_surface_normal(s.surface, &at, 4, 4, got);
		check_vector(got, 0.8, 0, 0.6, 2e-7);
		at.entering = false;
		bake_surface_normal(s.surface, &at, 4, 4, got);
		if (i == 0)
			check_vector(got, 1, 0, 0, 2e-7);
		else
			check_vector(got, -0.8, 0, -0.6, 2e-7);
		close_scene(&s);
	}
}

/* -- colours ------------------------------------------------------------- */

static void
check_color(const float got[4], const double want[4], double tol)
{
	for (int k = 0; k < 4; k++)
		CHECK_NEAR(got[k], want[k], tol);
}

static void
factor_and_vertex_colours_multiply(void)
{
	struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
	static const float factors[2][4] = { { 0.5f, 1, 0.25f, 0.5f },
		{ 1, 1, 1, 1 } };
	/* red grows to the right, green to the top */
	static const float colors[4][4] = { { 0, 0, 1, 1 }, { 1, 0, 1, 1 },
		{ 1, 1, 1, 1 }, { 0, 1, 1, 1 } };

	for (int mode = 0; mode < 3; mode++) {
		struct scene s = { .mesh = square(BAKE_AXIS_NEG_X, 0.3, false),
			.view = view_of(BAKE_AXIS_NEG_X, 16, 16, 1) };
		float got[4];

		add_materials(&s.mesh, 2);
		s.mesh.materials[0].alpha_mode = (enum bake_alpha_mode)mode;
		s.mesh.materials[0].alpha_cutoff = 0.6;
		s.mesh.material_of[1] = -1;
		params.factors = factors;
		params.vertex_colors = colors;
		open_scene(&s, &params);
		for (int y = 0; y < 16; y++)
			for (int x = 0; x < 16; x++) {
				const struct bake_crossing at =
				    crossing_at(x, y, 16, true);
				const float *f = factors[at.triangle];
				const double want[4] = { f[0] * (x + 0.5) / 16,
					f[1] * (15.5 - y) / 16, f[2],
					at.triangle == 1            ? 1
					: mode == BAKE_ALPHA_OPAQUE ? 1
					: mode == BAKE_ALPHA_MASK   ? 0
								    : 0.5 };

				bake_surface_color(s.surface, &at, x, y, got);
				/* one rounding to float */
				check_color(got, want, 6e-8);
			}
		close_scene(&s);
	}
}

/* A texture of 4 x 4 texels, red a ramp in u, green one in v, blue 1/4. */
static struct bake_image
ramps(int nchans)
{
	struct bake_image img = image(4, 4, nchans);

	for (int i = 0; i < 16; i++) {
		const float rgba[4] = { (float)(i % 4 + 0.5) / 4,
			(float)(3.5 - i / 4) / 4, 0.25f, 0.5f };

		memcpy(
		    img.data + i * nchans, rgba, (size_t)nchans * sizeof *rgba);
	}
	return img;
}

/* In every view, on a slope: (u, v) is where the texel is. */
static void
texture_is_looked_up_at_the_uv(void)
{
	for (int axis = 0; axis < 6; axis++) {
		struct bake_image tex = ramps(4);
		const struct bake_image *textures[1] = { &tex };
		struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
		struct scene s = { .mesh =
				       square((enum bake_axis)axis, 0.4, false),
			.view = view_of((enum bake_axis)axis, 32, 16, 1) };
		float got[4];

		add_materials(&s.mesh, 1);
		s.mesh.materials[0].alpha_mode = BAKE_ALPHA_BLEND;
		params.textures = textures;
		open_scene(&s, &params);
		CHECK(bake_surface_missing_uvs(s.surface) == 0);
		/* between the outermost texel centres of the texture */
		for (int y = 2; y < 14; y++)
			for (int x = 4; x < 28; x++) {
				const double u = (x + 0.5) / 32;
				const double v = (15.5 - y) / 16;
				const struct bake_crossing at = { 0.5, true,
					u < v, 0, 0 };
				const double want[4] = { u, v, 0.25, 0.5 };

				bake_surface_color(s.surface, &at, x, y, got);
				/* a ramp in float, then one rounding */
				check_color(got, want, 1.2e-7);
			}
		close_scene(&s);
		bake_image_free(&tex);
	}
}

/* Turned by 90 degrees and moved: u' = 1 - v, v' = u; and opaque. */
static void
uv_matrix_and_wrap_are_the_materials(void)
{
	struct bake_image tex = ramps(4);
	const struct bake_image *textures[1] = { &tex };
	struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
	static const double turn[2][3] = { { 0, -1, 1 }, { 1, 0, 0 } };
	static const double far[2][3] = { { 1, 0, 7 }, { 0, 1, 0 } };

	params.textures = textures;
	for (int k = 0; k < 2; k++) {
		struct scene s = { .mesh = square(BAKE_AXIS_POS_Z, 0, false),
			.view = view_of(BAKE_AXIS_POS_Z, 16, 16, 1) };
		const struct bake_crossing at = crossing_at(5, 8, 16, true);
		const double u = 5.5 / 16, v = 7.5 / 16;
		const double turned[4] = { 1 - v, u, 0.25, 1 };
		const double beyond[4] = { 3.5 / 4, v, 0.25, 1 };
		float got[4];

		add_materials(&s.mesh, 1);
		memcpy(s.mesh.materials[0].texture.uv_matrix,
		    k == 0 ? turn : far, sizeof turn);
		s.mesh.materials[0].texture.wrap_u =
		    k == 0 ? BAKE_TEX_REPEAT : BAKE_TEX_CLAMP;
		open_scene(&s, &params);
		bake_surface_color(s.surface, &at, 5, 8, got);
		check_color(got, k == 0 ? turned : beyond, 1.2e-7);
		close_scene(&s);
	}
	bake_image_free(&tex);
}

static void
missing_uvs_leave_the_factor_and_are_counted(void)
{
	static const float factors[3][4] = { { 1, 1, 1, 1 },
		{ 0.5f, 0.25f, 1, 1 }, { 1, 1, 1, 1 } };
	struct bake_image tex = ramps(3), grey = image(1, 1, 1);
	const struct bake_image *textures[3] = { &tex, &grey, &tex };
	struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
	struct scene s = { .mesh = square(BAKE_AXIS_POS_Z, 0, false),
		.view = view_of(BAKE_AXIS_POS_Z, 16, 16, 1) };
	struct bake_crossing at = crossing_at(5, 5, 16, true);
	const double factor[4] = { 0.5, 0.25, 1, 1 };
	const double ramp[4] = { 9.5 / 16, 4.5 / 16, 0.25, 1 };
	float got[4];

	grey.data[0] = 0.125f;
	add_materials(&s.mesh, 3);
	s.mesh.material_of[0] = 2;
	s.mesh.material_of[1] = 1;
	s.mesh.triangles[1][2].vt = -1;
	params.textures = textures;
	params.factors = factors;
	open_scene(&s, &params);
	CHECK(bake_surface_missing_uvs(s.surface) == 1);
	CHECK(at.triangle == 1);
	bake_surface_color(s.surface, &at, 5, 5, got);
	check_color(got, factor, 0);
	at = crossing_at(9, 11, 16, true);
	CHECK(at.triangle == 0);
	bake_surface_color(s.surface, &at, 9, 11, got);
	check_color(got, ramp, 1.2e-7);
	bake_surface_close(s.surface);
	bake_abuffer_close(s.ab);
	bake_weld_free(&s.weld);
	/* and with its UV the other material's picture, which is grey */
	s.mesh.triangles[1][2].vt = 3;
	open_scene(&s, &params);
	CHECK(bake_surface_missing_uvs(s.surface) == 0);
	at = crossing_at(5, 5, 16, true);
	bake_surface_color(s.surface, &at, 5, 5, got);
	CHECK(got[0] == 0.0625f && got[1] == 0.03125f && got[2] == 0.125f);
	close_scene(&s);
	bake_image_free(&tex);
	bake_image_free(&grey);
}

/* A board of 512 x 512 fields on 16 x 16 texels is grey, however steep. */
static void
footprint_follows_the_view(void)
{
	static const double slopes[] = { 0, 1, 5, 1e3, 1e9 };
	struct bake_image board = image(512, 512, 1);
	const struct bake_image *textures[1] = { &board };
	struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;

	for (int i = 0; i < 512 * 512; i++)
		board.data[i] = (float)((i % 512 + i / 512) % 2);
	params.textures = textures;
	for (int k = 0; k < 5; k++) {
		struct scene s = { .mesh = square(
				       BAKE_AXIS_POS_Z, slopes[k], false),
			.view = view_of(BAKE_AXIS_POS_Z, 16, 16, 1) };

		add_materials(&s.mesh, 1);
		open_scene(&s, &params);
		for (int i = 0; i < 256; i++) {
			const struct bake_crossing at =
			    crossing_at(i % 16, i / 16, 16, true);
			float got[4];

			bake_surface_color(s.surface, &at, i % 16, i / 16, got);
			/* the pyramid's levels are 1/2 exactly */
			CHECK(got[0] == 0.5f && got[3] == 1);
		}
		close_scene(&s);
	}
	bake_image_free(&board);
}

/* Texels of the view that are as wide as the texture's and 8 times as high. */
static void
footprint_is_the_texels(void)
{
	struct bake_image stripes = image(64, 64, 1);
	const struct bake_image *textures[1] = { &stripes };
	struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
	struct scene s = { .mesh = square(BAKE_AXIS_POS_Z, 0, false),
		.view = view_of(BAKE_AXIS_POS_Z, 64, 8, 1) };
	float lo = 1, hi = 0;

	/* columns alternate */
	for (int i = 0; i < 64 * 64; i++)
		stripes.data[i] = (float)(i % 2);
	add_materials(&s.mesh, 1);
	params.textures = textures;
	open_scene(&s, &params);
	for (int x = 10; x < 50; x++) {
		const struct bake_crossing at = { 0.5, true,
			(x + 0.5) / 64 < 4.5 / 8, 0, 0 };
		float got[4];

		bake_surface_color(s.surface, &at, x, 3, got);
		lo = got[0] < lo ? got[0] : lo;
		hi = got[0] > hi ? got[0] : hi;
	}
	/* a footprint as wide as it is high would be grey */
	CHECK(lo < 0.35f && hi > 0.65f);
	close_scene(&s);
	bake_image_free(&stripes);
}

/* -- errors -------------------------------------------------------------- */

static void
bad_input_is_refused(void)
{
	struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
	struct scene s = { .mesh = square(BAKE_AXIS_POS_Z, 0, false),
		.view = view_of(BAKE_AXIS_POS_Z, 8, 8, 1) };
	struct bake_image empty = BAKE_IMAGE_INIT;
	const struct bake_image *textures[1] = { &empty };
	struct bake_weld other = { 3, 3, NULL };
	struct bake_mesh none = BAKE_MESH_INIT;
	struct bake_surface *got = (struct bake_surface *)&s;
	struct bake_err err = BAKE_ERR_INIT;

	add_materials(&s.mesh, 1);
	open_scene(&s, &params);
	CHECK(bake_surface_open(&got, &none, NULL, s.ab, &s.view, &params,
		  &err) == BAKE_EDATA);
	CHECK(got == NULL);
	CHECK(strcmp(err.msg, "the mesh has no triangles") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_surface_open(&got, &s.mesh, &other, s.ab, &s.view, &params,
		  &err) == BAKE_EINVAL);
	CHECK(got == NULL);
	CHECK(strcmp(err.msg, "a weld of 3 positions, the mesh has 4") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	params.normals = BAKE_NORMALS_FILE;
	CHECK(bake_surface_open(&got, &s.mesh, &s.weld, s.ab, &s.view, &params,
		  &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "the mesh has no normals of its own") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	params.normals = BAKE_NORMALS_AUTO;
	params.textures = textures;
	CHECK(bake_surface_open(&got, &s.mesh, &s.weld, s.ab, &s.view, &params,
		  &err) == BAKE_EINVAL);
	CHECK(got == NULL);
	CHECK(strstr(err.msg, "0x0 texels") != NULL);
	bake_surface_close(NULL);
	close_scene(&s);
}

/* The same bits for any number of threads, without a weld as well. */
static void
threads_do_not_matter(void)
{
	struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;
	struct scene s = { .mesh = sphere(40, false),
		.view = view_of(BAKE_AXIS_NEG_Y, 64, 64, 1.1) };
	struct bake_surface *many;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_band band = BAKE_BAND_INIT;
	int differ = 0;

	params.nthreads = 1;
	open_scene(&s, &params);
	params.nthreads = 6;
	CHECK_OK(bake_surface_open(
		     &many, &s.mesh, &s.weld, s.ab, &s.view, &params, &err),
	    err);
	CHECK_OK(bake_abuffer_rows(s.ab, 0, 64, &band, &err), err);
	for (int i = 0; i < 64 * 64; i++)
		for (size_t c = band.start[i]; c < band.start[i + 1]; c++) {
			float a[3], b[3];

			bake_surface_normal(
			    s.surface, &band.crossing[c], i % 64, i / 64, a);
			bake_surface_normal(
			    many, &band.crossing[c], i % 64, i / 64, b);
			differ += memcmp(a, b, sizeof a) != 0;
		}
	CHECK(differ == 0);
	bake_surface_close(many);
	bake_band_free(&band);
	close_scene(&s);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(sphere_has_its_normals),
		CASE(computed_normals_are_those_of_the_frames),
		CASE(flat_normals_are_the_planes),
		CASE(signs_follow_the_side),
		CASE(opposed_normals_fall_back_to_the_plane),
		CASE(missing_normals_are_computed),
		CASE(slivers_are_not_turned_round),
		CASE(factor_and_vertex_colours_multiply),
		CASE(texture_is_looked_up_at_the_uv),
		CASE(uv_matrix_and_wrap_are_the_materials),
		CASE(missing_uvs_leave_the_factor_and_are_counted),
		CASE(footprint_follows_the_view),
		CASE(footprint_is_the_texels),
		CASE(bad_input_is_refused),
		CASE(threads_do_not_matter),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
