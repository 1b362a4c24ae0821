/* Tests of shell marching: level meshes, displaced solids, flat ground. */
/* SPDX-License-Identifier: MIT */
#include "shell_march.h"

#include "check.h"
#include "shape.h"
#include "test_march.h"

/* -- scenes ------------------------------------------------------------------
 */

struct scene {
	struct bake_mesh *mesh; /* the shell points to these */
	struct bake_weld *weld;
	struct bake_frames *frames;
	struct bake_shell *shell;
	struct bake_relief_map *map;
	double depth;
};

/* Of a mesh and a map, which it takes. */
static struct scene
scene_of(struct bake_mesh mesh, struct bake_image depth_map, double depth,
    double tile_u, double tile_v, enum bake_normal_source normals)
{
	struct bake_frame_params p = BAKE_FRAME_PARAMS_DEFAULT;
	struct scene s = { .mesh = calloc(1, sizeof *s.mesh),
		.weld = calloc(1, sizeof *s.weld),
		.frames = calloc(1, sizeof *s.frames),
		.depth = depth };
	struct bake_err err = BAKE_ERR_INIT;

	p.normals = normals;
	if (s.mesh == NULL || s.weld == NULL || s.frames == NULL)
		abort();
	*s.mesh = mesh;
	CHECK_OK(bake_mesh_weld(s.mesh, 0, s.weld, &err), err);
	CHECK_OK(
	    bake_mesh_frames(s.mesh, s.weld, NULL, &p, s.frames, &err), err);
	CHECK_OK(bake_shell_open(&s.shell, s.mesh, s.weld, s.frames, depth,
		     tile_u, tile_v, 1, &err),
	    err);
	s.map = open_map(&depth_map, torus);
	bake_image_free(&depth_map);
	if (s.shell == NULL)
		abort();
	return s;
}

static struct bake_mesh
shape(enum bake_shape which, int detail)
{
	struct bake_mesh mesh = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_shape_make(which, detail, &mesh, &err), err);
	return mesh;
}

static void
close_scene(struct scene *s)
{
	bake_relief_map_close(s->map);
	bake_shell_close(s->shell);
	bake_frames_free(s->frames);
	free(s->frames);
	bake_weld_free(s->weld);
	free(s->weld);
	bake_mesh_free(s->mesh);
	free(s->mesh);
}

static struct bake_image
flat(float d)
{
	struct bake_image img = image(3, 2, 1);

	for (int i = 0; i < 6; i++)
		img.data[i] = d;
	return img;
}

static double
frand(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (double)(*state >> 11) / 9007199254740992.0;
}

static void
random_unit(uint64_t *state, double d[3])
{
	double l;

	do {
		l = 0;
		for (int c = 0; c < 3; c++) {
			d[c] = 2 * frand(state) - 1;
			l += d[c] * d[c];
		}
	} while (l > 1 || l < 1e-3);
	for (int c = 0; c < 3; c++)
		d[c] /= sqrt(l);
}

static double
dot3(const double *a, const double *b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Corner k of a triangle at depth z: the formula of the header. */
static void
corner_at(const struct scene *s, int t, int k, double z, double q[3])
{
	const double *p = s->mesh->positions[s->mesh->triangles[t][k].v];
	const double *n = s->frames->frame[s->frames->frame_of[t][k]].normal;

	for (int c = 0; c < 3; c++)
		q[c] = p[c] - z * s->depth * n[c];
}

static void
point_at(
    const struct scene *s, int t, double b1, double b2, double z, double x[3])
{
	const double b[3] = { 1 - b1 - b2, b1, b2 };
	double q[3];

	memset(x, 0, 3 * sizeof *x);
	for (int k = 0; k < 3; k++) {
		corner_at(s, t, k, z, q);
		for (int c = 0; c < 3; c++)
			x[c] += b[k] * q[c];
	}
}

/* Where a line meets the triangle of depth z, t and the weights 1 and 2; the
 * sign of its normal along the line, 0 if it does not (Moeller, Trumbore). */
static int
meet(const struct scene *s, int tri, double z, const double o[3],
    const double d[3], double out[3])
{
	double q[3][3], e[2][3], h[3], r[3], det;

	for (int k = 0; k < 3; k++)
		corner_at(s, tri, k, z, q[k]);
	for (int c = 0; c < 3; c++) {
		e[0][c] = q[1][c] - q[0][c];
		e[1][c] = q[2][c] - q[0][c];
		r[c] = o[c] - q[0][c];
	}
	for (int c = 0; c < 3; c++)
		h[c] = d[(c + 1) % 3] * e[1][(c + 2) % 3] -
		       d[(c + 2) % 3] * e[1][(c + 1) % 3];
	det = dot3(e[0], h);
	if (det == 0)
		return 0;
	out[1] = dot3(r, h) / det;
	for (int c = 0; c < 3; c++)
		h[c] = r[(c + 1) % 3] * e[0][(c + 2) % 3] -
		       r[(c + 2) % 3] * e[0][(c + 1) % 3];
	out[2] = dot3(d, h) / det;
	out[0] = dot3(e[1], h) / det;
	if (out[1] < 0 || out[2] < 0 || out[1] + out[2] > 1)
		return 0;
	/* det = -d . (e0 x e1) */
	return det > 0 ? -1 : 1;
}

/* First meeting with the mesh of depth z after `after`: t, or INFINITY; facing:
 * only triangles whose normal has that sign along the line (0: any). */
static double
first_of_level(const struct scene *s, double z, const double o[3],
    const double d[3], double after, int facing, int *triangle, double b[2])
{
	double first = INFINITY, at[3];

	for (int t = 0; t < (int)s->mesh->ntriangles; t++) {
		const int sign = meet(s, t, z, o, d, at);

		if (sign == 0 || (facing != 0 && sign != facing) ||
		    at[0] <= after || at[0] >= first)
			continue;
		first = at[0];
		*triangle = t;
		b[0] = at[1];
		b[1] = at[2];
	}
	return first;
}

/* A ray from outside, through a random place of the box of half side r, to
 * where it enters the mesh. False if it does not. */
struct ray {
	double origin[3], dir[3], b[2];
	int triangle;
};
static bool
aim(const struct scene *s, uint64_t *state, double r, struct ray *ray)
{
	double from[3], t;

	random_unit(state, ray->dir);
	for (int c = 0; c < 3; c++)
		from[c] = r * (2 * frand(state) - 1) - 10 * ray->dir[c];
	t = first_of_level(s, 0, from, ray->dir, 0, -1, &ray->triangle, ray->b);
	for (int c = 0; c < 3; c++)
		ray->origin[c] = from[c] + t * ray->dir[c];
	return t < INFINITY;
}

static void
march(const struct scene *s, const struct ray *r, struct bake_shell_hit *hit)
{
	bake_shell_march(s->shell, s->map, r->triangle, r->b[0], r->b[1],
	    r->origin, r->dir, hit);
}

/* What holds of every hit: it is on the ray, the formula gives its point, and
 * u, v are those of its triangle. */
static void
check_hit(const struct scene *s, const struct ray *r,
    const struct bake_shell_hit *hit, double tile_u, double tile_v)
{
	const double b[3] = { 1 - hit->b1 - hit->b2, hit->b1, hit->b2 };
	double x[3], u[2] = { 0, 0 };

	if (hit->t < 0) {
		CHECK(hit->t == -1 && hit->triangle == -1);
		return;
	}
	CHECK(b[0] > -1e-9 && b[1] > -1e-9 && b[2] > -1e-9);
	CHECK(hit->z >= 0 && hit->z <= 1);
	point_at(s, hit->triangle, b[1], b[2], hit->z, x);
	for (int c = 0; c < 3; c++)
		CHECK_NEAR(x[c], r->origin[c] + hit->t * r->dir[c], 1e-12);
	for (int k = 0; k < 3; k++)
		for (int a = 0; a < 2; a++)
			u[a] +=
			    b[k] *
			    s->mesh->uvs[s->mesh->triangles[hit->triangle][k]
					     .vt][a];
	CHECK_NEAR(hit->u, u[0] * tile_u, 1e-12);
	CHECK_NEAR(hit->v, u[1] * tile_v, 1e-12);
}

/* -- constant depth: the mesh of that depth, exactly -------------------------
 */

/*
 * The relief of constant depth is the mesh with the corners Q_k(d): t is that
 * of the first of its triangles, if the ray does not leave the outer mesh
 * before. Both are exact, so that only rounding is allowed for: 1e-9 covers
 * rays at 1e-3 to the surface. Rays within 1e-6 of a decision are not counted.
 */
static void
check_level(struct scene *s, double d, double r, int nrays)
{
	uint64_t state = 7;
	int nhits = 0, nmisses = 0;

	for (int i = 0; i < nrays; i++) {
		struct bake_shell_hit hit;
		struct ray ray;
		double leave, want, b[2];
		int t;

		if (!aim(s, &state, r, &ray))
			continue;
		leave =
		    first_of_level(s, 0, ray.origin, ray.dir, 1e-9, 1, &t, b);
		want =
		    first_of_level(s, d, ray.origin, ray.dir, 1e-9, 0, &t, b);
		march(s, &ray, &hit);
		check_hit(s, &ray, &hit, 1, 1);
		if (fabs(want - leave) < 1e-6)
			continue;
		if (want < leave) {
			CHECK_NEAR(hit.t, want, 1e-9);
			CHECK_NEAR(hit.z, d, 1e-7);
			nhits++;
		} else {
			CHECK(hit.t == -1);
			nmisses++;
		}
	}
	CHECK(nhits > nrays / 20);
	CHECK(nmisses > 0);
}

static void
constant_depth_is_a_smaller_sphere(void)
{
	struct scene s = scene_of(shape(BAKE_SHAPE_SPHERE, 12), flat(0.5f), 0.1,
	    1, 1, BAKE_NORMALS_AUTO);
	const double r = 1 - 0.5 * 0.1;
	/* what 48 and 24 segments are inside of the sphere, at most */
	const double inside = r * (1 - cos(M_PI / 48) * cos(M_PI / 48)) * 1.01;
	uint64_t state = 3;

	check_level(&s, 0.5, 1.05, 3000);
	for (int i = 0; i < 2000; i++) {
		struct bake_shell_hit hit;
		struct ray ray;
		double x[3], along, closest;

		if (!aim(&s, &state, 1.05, &ray))
			continue;
		march(&s, &ray, &hit);
		along = dot3(ray.origin, ray.dir);
		closest = sqrt(dot3(ray.origin, ray.origin) - along * along);
		/* the silhouette is that of the smaller sphere */
		if (closest > r)
			CHECK(hit.t < 0);
		if (closest < r - inside)
			CHECK(hit.t >= 0);
		if (hit.t < 0)
			continue;
		for (int c = 0; c < 3; c++)
			x[c] = ray.origin[c] + hit.t * ray.dir[c];
		CHECK_NEAR(sqrt(dot3(x, x)), r - inside / 2, inside / 2);
	}
	close_scene(&s);
}

static void
constant_depth_is_the_level_mesh_of_torus_and_cube(void)
{
	struct scene s = scene_of(shape(BAKE_SHAPE_TORUS, 6), flat(0.625f), 0.1,
	    1, 1, BAKE_NORMALS_AUTO);

	check_level(&s, 0.625, 1.2, 1500);
	close_scene(&s);
	/* normals in common: the sides are no planes */
	s = scene_of(shape(BAKE_SHAPE_CUBE, 3), flat(0.75f), 0.3, 1, 1,
	    BAKE_NORMALS_COMPUTED);
	check_level(&s, 0.75, 1.5, 1500);
	close_scene(&s);
}

/* -- reliefs on curved shapes ------------------------------------------------
 */

enum { WAVES_U = 8, WAVES_V = 6 };
static double
waves(double u, double v)
{
	return 0.5 +
	       0.45 * sin(2 * M_PI * WAVES_U * u) * sin(2 * M_PI * WAVES_V * v);
}

static struct bake_image
wave_map(int side)
{
	struct bake_image img = image(side, side, 1);

	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++)
			img.data[y * side + x] = (float)waves(
			    (x + 0.5) / side, 1 - (y + 0.5) / side);
	return img;
}

/* How deep a point is below the smooth shape, and below the waves on it. */
struct solid {
	double (*below)(const double x[3], double *u, double *v);
	double depth;
};

static double
below_sphere(const double x[3], double *u, double *v)
{
	*u = atan2(x[0], x[2]) / (2 * M_PI) + 0.5;
	*v = atan2(x[1], hypot(x[0], x[2])) / M_PI + 0.5;
	return 1 - sqrt(dot3(x, x));
}

static double
below_torus(const double x[3], double *u, double *v)
{
	const double across = hypot(x[0], x[2]) - 1;

	*u = atan2(x[0], x[2]) / (2 * M_PI) + 0.5;
	*v = atan2(x[1], across) / (2 * M_PI) + 0.5;
	return 0.4 - hypot(across, x[1]);
}

static double
below_waves(const struct solid *s, const double x[3], double *below)
{
	double u, v;

	*below = s->below(x, &u, &v);
	return *below - s->depth * waves(u, v);
}

/*
 * Follow rays through the smooth displaced solid in small steps. The hit is on
 * its surface within eps, and before it, or before the shape is left, no point
 * is deeper than eps in it. eps covers the flat triangles and the bilinear map.
 */
static void
check_solid(
    struct scene *s, const struct solid *solid, double r, double eps, int nrays)
{
	uint64_t state = 11;
	int nhits = 0, nmisses = 0;

	for (int i = 0; i < nrays; i++) {
		struct bake_shell_hit hit;
		struct ray ray;
		double x[3], below, f, step = eps / 4, most = -1;
		bool inside = true;

		if (!aim(s, &state, r, &ray))
			continue;
		march(s, &ray, &hit);
		check_hit(s, &ray, &hit, 1, 1);
		for (double t = 0; inside && (hit.t < 0 || t < hit.t);
		     t += step) {
			for (int c = 0; c < 3; c++)
				x[c] = ray.origin[c] + t * ray.dir[c];
			f = below_waves(solid, x, &below);
			/* just inside, the next one of its triangles may be
			 * outside already */
			inside = below > (hit.t < 0 ? eps : -eps) || t < eps;
			most = inside && f > most ? f : most;
		}
		CHECK(most <= eps);
		if (hit.t < 0) {
			nmisses++;
			continue;
		}
		CHECK(inside);
		for (int c = 0; c < 3; c++)
			x[c] = ray.origin[c] + hit.t * ray.dir[c];
		CHECK_NEAR(below_waves(solid, x, &below), 0, eps);
		nhits++;
	}
	CHECK(nhits > nrays / 20);
	CHECK(nmisses > 0);
}

/*
 * 192 segments are up to 1 - cos(pi / 192) = 1.4e-4 inside of the sphere along
 * one axis, as much along the other; the map's 256 texels cost 0.45 * 0.05 *
 * (pi / 256 * 8)^2 / 2, twice: 2.2e-4; the angles in flat triangles less.
 */
static void
waves_on_a_sphere_are_the_displaced_solid(void)
{
	const struct solid solid = { below_sphere, 0.05 };
	struct scene s = scene_of(shape(BAKE_SHAPE_SPHERE, 48), wave_map(256),
	    0.05, 1, 1, BAKE_NORMALS_AUTO);

	check_solid(&s, &solid, 1.02, 5e-4, 400);
	close_scene(&s);
}

/* 200 segments round the ring, 80 round the tube: 1.4 (pi / 200)^2 / 2 +
 * 0.4 (pi / 80)^2 / 2 = 4.8e-4, and the map as above. */
static void
waves_on_a_torus_are_the_displaced_solid(void)
{
	const struct solid solid = { below_torus, 0.05 };
	struct scene s = scene_of(shape(BAKE_SHAPE_TORUS, 20), wave_map(256),
	    0.05, 1, 1, BAKE_NORMALS_AUTO);

	check_solid(&s, &solid, 1.2, 8e-4, 400);
	close_scene(&s);
}

/* Newton's method on X(b, z) = x, from the middle of the prism. */
static bool
locate(const struct scene *s, int tri, const double x[3], double bz[3])
{
	double y[3], j[3][3], r[3];
	const double h = 1e-6;

	bz[0] = bz[1] = 1.0 / 3;
	bz[2] = 0.5;
	for (int n = 0; n < 12; n++) {
		double det, step[3], most = 0;

		point_at(s, tri, bz[0], bz[1], bz[2], y);
		for (int k = 0; k < 3; k++) {
			double at[3] = { bz[0], bz[1], bz[2] };

			at[k] += h;
			point_at(s, tri, at[0], at[1], at[2], j[k]);
			for (int c = 0; c < 3; c++)
				j[k][c] = (j[k][c] - y[c]) / h;
		}
		for (int c = 0; c < 3; c++)
			r[c] = x[c] - y[c];
#define DET(a, b, c)                                                           \
	((a)[0] * ((b)[1] * (c)[2] - (b)[2] * (c)[1]) -                        \
	    (a)[1] * ((b)[0] * (c)[2] - (b)[2] * (c)[0]) +                     \
	    (a)[2] * ((b)[0] * (c)[1] - (b)[1] * (c)[0]))
		det = DET(j[0], j[1], j[2]);
		step[0] = DET(r, j[1], j[2]) / det;
		step[1] = DET(j[0], r, j[2]) / det;
		step[2] = DET(j[0], j[1], r) / det;
		for (int k = 0; k < 3; k++) {
			bz[k] += step[k];
			most = fmax(most, fabs(step[k]));
		}
		if (most < 1e-10)
			break;
		if (!(most < 10))
			return false;
	}
	return bz[0] >= 0 && bz[1] >= 0 && bz[0] + bz[1] <= 1 && bz[2] >= 0 &&
	       bz[2] <= 1;
}

/* z - d at a place in the shell, by looking into every prism; 0 outside. */
static double
below_anywhere(const struct scene *s, const struct bake_relief_map *map,
    const double x[3], bool *inside)
{
	double bz[3], mid[3];

	*inside = false;
	for (int t = 0; t < (int)s->mesh->ntriangles; t++) {
		double far = 0, uv[2] = { 0, 0 };
		float u, v, d;

		point_at(s, t, 1.0 / 3, 1.0 / 3, 0.5, mid);
		for (int c = 0; c < 3; c++)
			far += (x[c] - mid[c]) * (x[c] - mid[c]);
		/* no prism of these meshes is larger */
		if (far > 0.6 * 0.6 || !locate(s, t, x, bz))
			continue;
		for (int a = 0; a < 2; a++) {
			const struct bake_corner *c = s->mesh->triangles[t];

			uv[a] = (1 - bz[0] - bz[1]) * s->mesh->uvs[c[0].vt][a] +
				bz[0] * s->mesh->uvs[c[1].vt][a] +
				bz[1] * s->mesh->uvs[c[2].vt][a];
		}
		u = (float)uv[0];
		v = (float)uv[1];
		bake_relief_map_sample(map, 1, &u, &v, &d);
		*inside = true;
		return bz[2] - (double)d;
	}
	return 0;
}

/*
 * Coarse meshes, a map of noise: no walking from prism to prism, but a look
 * into all of them at every step. 1e-4: the map in single precision, 16 texels.
 */
static void
noise_is_met_first_where_all_prisms_say(void)
{
	uint64_t state = 5;
	struct scene s = scene_of(shape(BAKE_SHAPE_SPHERE, 3), noise(16, 16, 1),
	    0.2, 1, 1, BAKE_NORMALS_AUTO);
	int nhits = 0, nwalls = 0;

	for (int i = 0; i < 600; i++) {
		struct bake_shell_hit hit;
		struct ray ray;
		double x[3], most = -1, t = 1e-4;
		bool inside = true;

		if (!aim(&s, &state, 1.0, &ray))
			continue;
		march(&s, &ray, &hit);
		check_hit(&s, &ray, &hit, 1, 1);
		while (inside && (hit.t < 0 || t < hit.t - 1e-6)) {
			double f;

			for (int c = 0; c < 3; c++)
				x[c] = ray.origin[c] + t * ray.dir[c];
			f = below_anywhere(&s, s.map, x, &inside);
			most = inside && f > most ? f : most;
			t += 0.002;
		}
		CHECK(most < 1e-4);
		CHECK(hit.t < 0 || inside);
		if (hit.t < 0)
			continue;
		for (int c = 0; c < 3; c++)
			x[c] = ray.origin[c] + hit.t * ray.dir[c];
		nhits++;
		/* round the poles u is not the same on both sides of an edge:
		 * the relief has a wall there, which may be hit */
		if (fmin(fmin(hit.b1, hit.b2), 1 - hit.b1 - hit.b2) < 1e-9)
			nwalls++;
		else
			CHECK_NEAR(
			    below_anywhere(&s, s.map, x, &inside), 0, 1e-4);
	}
	CHECK(nwalls < 5);
	CHECK(nhits > 200);
	close_scene(&s);
}

/* -- flat ground: the flat march ---------------------------------------------
 */

/* The ray into the plane shape from a place, and the same for bake_march. */
static void
flat_ray(const struct scene *s, uint64_t *state, double tile_u, double tile_v,
    struct ray *ray, struct bake_rays *r)
{
	const double u = 0.1 + 0.8 * frand(state), v = 0.1 + 0.8 * frand(state);
	const double from[3] = { 2 * u - 1, 1, 1 - 2 * v };
	const double down[3] = { 0, -1, 0 };
	double end = 1 / 0.0, at[2] = { u, v }, speed[2];

	random_unit(state, ray->dir);
	ray->dir[1] = -fabs(ray->dir[1]) - 0.02;
	for (int c = 0; c < 3; c++)
		ray->origin[c] = c == 1 ? 0 : from[c];
	first_of_level(s, 0, from, down, 0, 0, &ray->triangle, ray->b);
	speed[0] = ray->dir[0] / 2;
	speed[1] = -ray->dir[2] / 2;
	for (int k = 0; k < 2; k++)
		end = fmin(end, ((speed[k] > 0 ? 1 : 0) - at[k]) / speed[k]);
	end = fmin(end, s->depth / -ray->dir[1] * (1 + 0x1p-20));
	r->u[0] = (float)(u * tile_u);
	r->v[0] = (float)(v * tile_v);
	r->du[0] = (float)(speed[0] * tile_u);
	r->dv[0] = (float)(speed[1] * tile_v);
	r->dz[0] = (float)(-ray->dir[1] / s->depth);
	r->t_end[0] = (float)end;
}

/*
 * The flat march has its rays in single precision: u to 2^-24 of it, in a map
 * of 64 texels of noise some 1e-5 of depth. What it finds for the ray lifted or
 * lowered by a bit more than that holds the exact place between.
 */
static void
check_flat(double tile_u, double tile_v)
{
	const struct bake_march_params exact = { BAKE_SEARCH_EXACT, 0, 0,
		false };
	const double off = 3e-5 * fmax(tile_u, tile_v);
	struct scene s = scene_of(shape(BAKE_SHAPE_PLANE, 5), noise(64, 64, 1),
	    0.2, tile_u, tile_v, BAKE_NORMALS_AUTO);
	struct bake_rays r = new_rays(1);
	uint64_t state = 17;
	int nhits = 0;

	for (int i = 0; i < 4000; i++) {
		struct bake_shell_hit hit;
		double early, late;
		struct ray ray;

		flat_ray(&s, &state, tile_u, tile_v, &ray, &r);
		r.z[0] = (float)off;
		bake_march(s.map, &exact, &r);
		early = (double)r.hit[0];
		r.z[0] = (float)-off;
		bake_march(s.map, &exact, &r);
		late = (double)r.hit[0];
		march(&s, &ray, &hit);
		check_hit(&s, &ray, &hit, tile_u, tile_v);
		if (early < 0 && hit.t >= 0)
			/* at its very end only */
			CHECK_NEAR(hit.t, (double)r.t_end[0], 1e-4);
		if (late >= 0)
			CHECK(hit.t >= 0 && hit.t <= late + 1e-6);
		if (hit.t >= 0 && early >= 0)
			CHECK(hit.t >= early - 1e-6);
		nhits += hit.t >= 0;
	}
	CHECK(nhits > 3000);
	free(r.u);
	close_scene(&s);
}

static void
flat_ground_is_the_flat_march(void)
{
	check_flat(1, 1);
}

static void
tiles_repeat_the_relief(void)
{
	check_flat(3, 2);
	check_flat(0.5, 7);
}

/* -- edges -------------------------------------------------------------------
 */

/* Straight down at every vertex, and along every edge. */
static void
rays_on_vertices_and_edges_arrive(void)
{
	struct scene s = scene_of(shape(BAKE_SHAPE_SPHERE, 6), flat(0.5f), 0.1,
	    1, 1, BAKE_NORMALS_AUTO);

	for (int t = 0; t < (int)s.mesh->ntriangles; t++)
		for (int k = 0; k < 3; k++) {
			const int l = (k + 1) % 3;
			struct bake_shell_hit hit;
			double p[3], q[3], want, b[2], n = 0;
			struct ray ray = { .triangle = t };
			int other;

			corner_at(&s, t, k, 0, p);
			corner_at(&s, t, l, 0.5, q);
			ray.b[0] = k == 1;
			ray.b[1] = k == 2;
			for (int c = 0; c < 3; c++) {
				ray.origin[c] = p[c];
				ray.dir[c] = -p[c];
			}
			march(&s, &ray, &hit);
			CHECK_NEAR(hit.t, 0.05, 1e-12);
			/* in the side, through its diagonal, to a vertex of
			 * the level mesh: where it is met just before or
			 * just behind that, rounding decides */
			for (int c = 0; c < 3; c++)
				ray.dir[c] = q[c] - p[c];
			n = sqrt(dot3(ray.dir, ray.dir));
			for (int c = 0; c < 3; c++)
				ray.dir[c] /= n;
			march(&s, &ray, &hit);
			want = first_of_level(
			    &s, 0.5, ray.origin, ray.dir, 1e-9, 0, &other, b);
			want = fmin(want, n);
			CHECK(hit.t >= 0);
			CHECK_NEAR(hit.t, want, 1e-8);
		}
	close_scene(&s);
}

/* A face of the cube is alone: rays end where its box does, 0.3 deep. */
static void
creases_end_the_shell(void)
{
	struct scene s = scene_of(shape(BAKE_SHAPE_CUBE, 4), flat(0.5f), 0.6, 1,
	    1, BAKE_NORMALS_AUTO);
	uint64_t state = 23;
	int nhits = 0, nmisses = 0;

	for (int i = 0; i < 2000; i++) {
		struct bake_shell_hit hit;
		double x[3], t;
		struct ray ray;
		int axis = 0;

		if (!aim(&s, &state, 1.2, &ray))
			continue;
		for (int c = 1; c < 3; c++)
			if (fabs(ray.origin[c]) > fabs(ray.origin[axis]))
				axis = c;
		t = 0.3 / fabs(ray.dir[axis]);
		for (int c = 0; c < 3; c++)
			x[c] = ray.origin[c] + t * ray.dir[c];
		march(&s, &ray, &hit);
		check_hit(&s, &ray, &hit, 1, 1);
		if (fabs(x[(axis + 1) % 3]) < 1 &&
		    fabs(x[(axis + 2) % 3]) < 1) {
			CHECK_NEAR(hit.t, t, 1e-9);
			nhits++;
		} else {
			CHECK(hit.t == -1);
			nmisses++;
		}
	}
	CHECK(nhits > 300 && nmisses > 100);
	close_scene(&s);
}

/* The unit square of 2 x 1 quads as in the picture, whose upper right quad's
 * diagonal has a further point on it; bad: with the triangle without area that
 * closes the gap, whose neighbours are cut, and one with two equal corners. */
static struct bake_mesh
square(bool bad)
{
	/* 3 - 4 - 5
	 * | / | / |      6 in the middle of 1 5, 7 = 1
	 * 0 - 1 - 2 */
	static const double at[8][2] = { { 0, 0 }, { 1, 0 }, { 2, 0 }, { 0, 1 },
		{ 1, 1 }, { 2, 1 }, { 1.5, 0.5 }, { 1, 0 } };
	static const int good[4][3] = { { 0, 1, 4 }, { 0, 4, 3 }, { 1, 2, 5 },
		{ 1, 5, 4 } };
	/* 1 2 5 keeps the long edge; above it is cut at 6 */
	static const int broken[7][3] = { { 0, 1, 4 }, { 0, 4, 3 }, { 1, 2, 5 },
		{ 1, 6, 4 }, { 6, 5, 4 }, { 1, 5, 6 }, { 1, 7, 4 } };
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	const size_t n = bad ? 7 : 4;

	CHECK_OK(bake_mesh_alloc(&m, 8, 16, 2, n, &err), err);
	m.normals[0][0] = m.normals[0][1] = 0;
	m.normals[0][2] = 1;
	m.normals[1][0] = -1;
	m.normals[1][1] = m.normals[1][2] = 0;
	for (int i = 0; i < 8; i++) {
		for (int c = 0; c < 2; c++) {
			m.positions[i][c] = at[i][c];
			m.uvs[i][c] = m.uvs[i + 8][c] = at[i][c] / 2;
		}
		m.positions[i][2] = 0;
	}
	for (size_t t = 0; t < n; t++)
		for (int k = 0; k < 3; k++) {
			const int v = bad ? broken[t][k] : good[t][k];

			m.triangles[t][k] = (struct bake_corner){ v, v, 0 };
		}
	return m;
}

/* The square's right half turned up by 90 degrees, with its own normals and
 * UVs: behind the left half's end nothing is to be hit, as the shells of the
 * two do not touch. */
static void
a_valley_with_a_crease_ends_the_shell(void)
{
	struct bake_mesh m = square(false);
	struct ray ray = { { 0.9, 0.4, 0 }, { 0.995, 0, -0.0998 }, { 0.5, 0.4 },
		0 };
	struct bake_shell_hit hit;
	struct scene s;

	for (int i = 2; i < 6; i += 3) {
		m.positions[i][0] = 1;
		m.positions[i][2] = 1;
	}
	for (int t = 2; t < 4; t++)
		for (int k = 0; k < 3; k++) {
			m.triangles[t][k].vn = 1;
			m.triangles[t][k].vt += 8;
		}
	s = scene_of(m, flat(0.5f), 0.5, 1, 1, BAKE_NORMALS_FILE);
	march(&s, &ray, &hit);
	CHECK(hit.t == -1);
	ray.dir[2] = -5;
	march(&s, &ray, &hit);
	CHECK_NEAR(hit.t, 0.05, 1e-12);
	close_scene(&s);
}

static void
triangles_without_area_are_passed(void)
{
	struct scene a = scene_of(
	    square(false), noise(32, 32, 1), 0.5, 1, 1, BAKE_NORMALS_FILE);
	struct scene b = scene_of(
	    square(true), noise(32, 32, 1), 0.5, 1, 1, BAKE_NORMALS_FILE);
	uint64_t state = 29;
	int ncrossings = 0;

	for (int i = 0; i < 3000; i++) {
		struct bake_shell_hit ha, hb;
		struct ray ray = { .triangle = 2 };
		double w = frand(&state);

		/* from right below, or from left above the diagonal */
		random_unit(&state, ray.dir);
		ray.dir[2] = -fabs(ray.dir[2]) / 8 - 1e-3;
		if (i % 2 == 0) {
			ray.origin[0] = 1.9;
			ray.origin[1] = 0.05 + 0.5 * w;
		} else {
			ray.triangle = 0;
			ray.origin[0] = 0.6 + 0.3 * w;
			ray.origin[1] = 0.1;
		}
		ray.origin[2] = 0;
		march(&a, &ray, &ha);
		march(&b, &ray, &hb);
		CHECK((ha.t < 0) == (hb.t < 0));
		CHECK_NEAR(hb.t, ha.t, 1e-9);
		ncrossings += ha.triangle == 3 || (i % 2 && ha.triangle == 2);
		/* a start in one is no start */
		ray.triangle = 5;
		march(&b, &ray, &hb);
		CHECK(hb.t == -1);
	}
	CHECK(ncrossings > 50);
	close_scene(&a);
	close_scene(&b);
}

/* Depth 0.6 on a torus of radius 0.4: prisms turn inside out. No more is
 * asked than an end, and numbers. */
static void
folded_shells_end(void)
{
	struct scene s = scene_of(shape(BAKE_SHAPE_TORUS, 4), noise(16, 16, 1),
	    0.6, 1, 1, BAKE_NORMALS_AUTO);
	uint64_t state = 31;

	for (int i = 0; i < 3000; i++) {
		struct bake_shell_hit hit;
		struct ray ray;

		if (!aim(&s, &state, 1.4, &ray))
			continue;
		march(&s, &ray, &hit);
		CHECK(hit.t == -1 || (hit.t >= 0 && hit.t < 4));
		CHECK(isfinite(hit.u) && isfinite(hit.v));
		CHECK(hit.z >= 0 && hit.z <= 1);
	}
	close_scene(&s);
}

static void
the_bottom_is_solid(void)
{
	/* deeper than the bottom: the map is not as it should be */
	struct scene s = scene_of(shape(BAKE_SHAPE_SPHERE, 6), flat(1.5f), 0.1,
	    1, 1, BAKE_NORMALS_AUTO);
	const double o[3] = { 0, 0, 1 }, d[3] = { 0, 0, -1 };
	struct bake_shell_hit hit;
	double b[2] = { 0, 0 };
	int t = -1;

	CHECK(first_of_level(&s, 0, (double[3]){ 0, 0, 2 }, d, 0, -1, &t, b) ==
	      1);
	bake_shell_march(s.shell, s.map, t, b[0], b[1], o, d, &hit);
	CHECK_NEAR(hit.t, 0.1, 1e-11);
	CHECK(hit.z == 1);
	close_scene(&s);
}

/* -- shadows -----------------------------------------------------------------
 */

/* On constant depth there is shadow where the light is behind the triangle. */
static void
a_bare_sphere_shades_itself_alone(void)
{
	struct scene s = scene_of(shape(BAKE_SHAPE_SPHERE, 8), flat(0.5f), 0.2,
	    1, 1, BAKE_NORMALS_AUTO);
	uint64_t state = 37;
	int n[2] = { 0, 0 };

	for (int i = 0; i < 4000; i++) {
		const int t = (int)(frand(&state) * (double)s.mesh->ntriangles);
		struct bake_shell_hit hit = { 0.1, t, 0.2, 0.3, 0.5, 0, 0 };
		double e[2][3], q[3][3], normal[3], l[3], up;

		for (int k = 0; k < 3; k++)
			corner_at(&s, t, k, 0.5, q[k]);
		for (int c = 0; c < 3; c++) {
			e[0][c] = q[1][c] - q[0][c];
			e[1][c] = q[2][c] - q[0][c];
		}
		for (int c = 0; c < 3; c++)
			normal[c] = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] -
				    e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
		random_unit(&state, l);
		up = dot3(normal, l) / sqrt(dot3(normal, normal));
		if (fabs(up) < 1e-3)
			continue;
		n[up > 0]++;
		CHECK(
		    bake_shell_march_any(s.shell, s.map, &hit, l) == (up < 0));
	}
	CHECK(n[0] > 500 && n[1] > 500);
	close_scene(&s);
}

/*
 * From 0.002 above the relief, so that what is next to the start does not
 * matter: as the flat march says for rays a bit lower or higher, see above.
 */
static void
shadows_on_flat_ground_are_the_flat_ones(void)
{
	const struct bake_march_params exact = { BAKE_SEARCH_EXACT, 0, 0,
		false };
	struct scene s = scene_of(shape(BAKE_SHAPE_PLANE, 5), noise(16, 16, 1),
	    0.2, 1, 1, BAKE_NORMALS_AUTO);
	struct bake_rays r = new_rays(1);
	uint64_t state = 41;
	int n[2] = { 0, 0 };

	for (int i = 0; i < 4000; i++) {
		struct bake_shell_hit hit;
		struct ray ray;
		double l[3], end;
		int hidden;

		flat_ray(&s, &state, 1, 1, &ray, &r);
		march(&s, &ray, &hit);
		hit.z -= 2e-3;
		random_unit(&state, l);
		l[1] = fabs(l[1]) + 0.05;
		end = hit.z * s.depth / l[1];
		/* not over the border of the plane, where the map goes on */
		if (hit.t < 0 || hit.z < 0 ||
		    fabs(hit.u + end * l[0] / 2 - 0.5) > 0.5 ||
		    fabs(hit.v - end * l[2] / 2 - 0.5) > 0.5)
			continue;
		r.u[0] = (float)hit.u;
		r.v[0] = (float)hit.v;
		r.du[0] = (float)(l[0] / 2);
		r.dv[0] = (float)(-l[2] / 2);
		r.dz[0] = (float)(-l[1] / s.depth);
		r.t_end[0] = (float)end;
		hidden = bake_shell_march_any(s.shell, s.map, &hit, l);
		n[hidden]++;
		r.z[0] = (float)(hit.z - 3e-5);
		bake_march_any(s.map, &exact, 0, &r);
		CHECK(hidden || r.hit[0] == 0);
		r.z[0] = (float)(hit.z + 3e-5);
		bake_march_any(s.map, &exact, 0, &r);
		CHECK(!hidden || r.hit[0] > 0);
	}
	CHECK(n[0] > 300 && n[1] > 300);
	free(r.u);
	close_scene(&s);
}

/* -- what cannot be done -----------------------------------------------------
 */

static void
rays_that_are_none_hit_nothing(void)
{
	struct scene s = scene_of(shape(BAKE_SHAPE_SPHERE, 3), flat(0.5f), 0.1,
	    1, 1, BAKE_NORMALS_AUTO);
	const double o[3] = { 0, 0, 1 }, d[3] = { 0, 0, -1 };
	const double none[3] = { 0, 0, 0 }, nan3[3] = { NAN, 0, 0 };
	const double far[3] = { 0, 0, 1e300 }, out[3] = { 0, 0, 1 };
	const struct bake_shell_hit miss = { -1, -1, 0, 0, 0, 0, 0 };
	const struct bake_shell_hit bad = { 0, 0, NAN, 0, 0, 0, 0 };
	struct bake_shell_hit hit;
	const int n = (int)s.mesh->ntriangles;

#define NOTHING(tri, b1, b2, origin, dir)                                      \
	do {                                                                   \
		bake_shell_march(                                              \
		    s.shell, s.map, tri, b1, b2, origin, dir, &hit);           \
		CHECK(hit.t == -1 && hit.triangle == -1);                      \
	} while (0)
	NOTHING(-1, 0, 0, o, d);
	NOTHING(n, 0, 0, o, d);
	for (int t = 0; t < n; t++) {
		NOTHING(t, 0, 0, o, none);
		NOTHING(t, 0, 0, o, nan3);
		NOTHING(t, 0, 0, nan3, d);
		NOTHING(t, NAN, 0, o, d);
		NOTHING(t, 0, INFINITY, o, d);
		NOTHING(t, 0, 0, far, d);
	}
	/* outwards from where the sphere is seen, up to the edges there */
	for (int t = 0; t < n; t++) {
		double x[3], b[3];

		if (meet(&s, t, 0, o, d, b) == 0)
			continue;
		point_at(&s, t, b[1], b[2], 0, x);
		if (x[2] > 0)
			NOTHING(t, b[1], b[2], x, out);
	}
	CHECK(bake_shell_march_any(s.shell, s.map, &miss, d) == 0);
	CHECK(bake_shell_march_any(s.shell, s.map, &bad, d) == 0);
	close_scene(&s);
}

static void
shells_that_cannot_be_are_refused(void)
{
	struct scene s = scene_of(shape(BAKE_SHAPE_CUBE, 1), flat(0.5f), 0.1, 1,
	    1, BAKE_NORMALS_AUTO);
	const double bad[] = { 0, -1, NAN, INFINITY };
	struct bake_shell *shell;
	struct bake_frames few = *s.frames;
	struct bake_weld small = *s.weld;
	struct bake_mesh bare = *s.mesh;

#define REFUSED(code, mesh, weld, frames, d, tu, tv)                           \
	do {                                                                   \
		struct bake_err err = BAKE_ERR_INIT;                           \
                                                                               \
		shell = s.shell;                                               \
		CHECK(bake_shell_open(&shell, mesh, weld, frames, d, tu, tv,   \
			  1, &err) == code);                                   \
		CHECK(shell == NULL && err.msg[0] != '\0');                    \
	} while (0)
	for (int i = 0; i < 4; i++) {
		REFUSED(BAKE_EINVAL, s.mesh, s.weld, s.frames, bad[i], 1, 1);
		REFUSED(BAKE_EINVAL, s.mesh, s.weld, s.frames, 1, bad[i], 1);
		REFUSED(BAKE_EINVAL, s.mesh, s.weld, s.frames, 1, 1, bad[i]);
	}
	few.ntriangles--;
	REFUSED(BAKE_EINVAL, s.mesh, s.weld, &few, 1, 1, 1);
	small.npositions--;
	REFUSED(BAKE_EINVAL, s.mesh, &small, s.frames, 1, 1, 1);
	bare.nuvs = 0;
	REFUSED(BAKE_EDATA, &bare, s.weld, s.frames, 1, 1, 1);
	bake_shell_close(NULL);
	close_scene(&s);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(constant_depth_is_a_smaller_sphere),
		CASE(constant_depth_is_the_level_mesh_of_torus_and_cube),
		CASE(waves_on_a_sphere_are_the_displaced_solid),
		CASE(waves_on_a_torus_are_the_displaced_solid),
		CASE(noise_is_met_first_where_all_prisms_say),
		CASE(flat_ground_is_the_flat_march),
		CASE(tiles_repeat_the_relief),
		CASE(rays_on_vertices_and_edges_arrive),
		CASE(creases_end_the_shell),
		CASE(a_valley_with_a_crease_ends_the_shell),
		CASE(triangles_without_area_are_passed),
		CASE(folded_shells_end),
		CASE(the_bottom_is_solid),
		CASE(a_bare_sphere_shades_itself_alone),
		CASE(shadows_on_flat_ground_are_the_flat_ones),
		CASE(rays_that_are_none_hit_nothing),
		CASE(shells_that_cannot_be_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
