/* The camera: its basis, rays and projection against each other. */
/* SPDX-License-Identifier: MIT */
#include "camera.h"

#include "check.h"
#include "test_mesh.h"

static const struct bake_camera plain = { .eye = { 0, 0, 5 },
	.up = { 0, 1, 0 },
	.fov_deg = 90,
	.near = 0.1,
	.width = 640,
	.height = 480 };

static double
dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static struct bake_camera_basis
ready(const struct bake_camera *c)
{
	struct bake_camera_basis b;
	struct bake_err err = BAKE_ERR_INIT;

	memset(&b, 0, sizeof b);
	CHECK_OK(bake_camera_basis(c, &b, &err), err);
	return b;
}

static void
plain_camera_is_by_hand(void)
{
	struct bake_camera_basis b = ready(&plain);
	double o[3], d[3], pixel[2], depth;
	const double p[3] = { 1, 2, 1 };

	CHECK(b.x[0] == 1 && b.y[1] == 1 && b.z[2] == 1);
	CHECK(b.cx == 320 && b.cy == 240 && !b.orthographic);
	CHECK_NEAR(b.pixels, 240, 1e-13); /* tan of 45 degrees, to an ulp */
	bake_camera_ray(&b, 320, 240, o, d);
	CHECK(d[0] == 0 && d[1] == 0 && d[2] == -1 && o[2] == 5);
	/* the upper edge's middle is 45 degrees up */
	bake_camera_ray(&b, 320, 0, o, d);
	CHECK_NEAR(d[1], sqrt(0.5), 2e-16);
	CHECK_NEAR(d[2], -sqrt(0.5), 2e-16);
	/* 4 away: 240 / 4 pixels a unit; up is towards row 0 */
	CHECK(bake_camera_project(&b, p, pixel, &depth));
	CHECK_NEAR(pixel[0], 320 + 60, 1e-12);
	CHECK_NEAR(pixel[1], 240 - 120, 1e-12);
	CHECK(depth == 4);
}

static void
orthographic_camera_is_by_hand(void)
{
	struct bake_camera c = plain;
	struct bake_camera_basis b;
	double o[3], d[3], pixel[2], depth;
	const double p[3] = { 1, 2, -7 };

	c.fov_deg = 0;
	c.height_world = 6;
	b = ready(&c);
	CHECK(b.orthographic && b.pixels == 80);
	bake_camera_ray(&b, 400, 80, o, d);
	CHECK(o[0] == 1 && o[1] == 2 && o[2] == 5);
	CHECK(d[0] == 0 && d[1] == 0 && d[2] == -1);
	CHECK(bake_camera_project(&b, p, pixel, &depth));
	CHECK(pixel[0] == 400 && pixel[1] == 80 && depth == 12);
}

static struct bake_camera
some_camera(uint64_t *state, bool orthographic)
{
	struct bake_camera c = plain;

	for (int k = 0; k < 3; k++) {
		c.eye[k] = 20 * chance(state) - 10;
		c.target[k] = 20 * chance(state) - 10;
		c.up[k] = 2 * chance(state) - 1;
	}
	c.fov_deg = orthographic ? 0 : 1 + 169 * chance(state);
	c.height_world = 0.1 + 10 * chance(state);
	c.width = 1 + (int)(2000 * chance(state));
	c.height = 1 + (int)(2000 * chance(state));
	return c;
}

static void
bases_are_orthonormal(void)
{
	uint64_t state = 1;

	for (int i = 0; i < 1000; i++) {
		struct bake_camera c = some_camera(&state, i % 2);
		struct bake_camera_basis b = ready(&c);
		double toward[3];

		/* a few roundings */
		CHECK_NEAR(dot(b.x, b.x), 1, 1e-15);
		CHECK_NEAR(dot(b.y, b.y), 1, 1e-15);
		CHECK_NEAR(dot(b.z, b.z), 1, 1e-15);
		CHECK_NEAR(dot(b.x, b.y), 0, 1e-15);
		CHECK_NEAR(dot(b.y, b.z), 0, 1e-15);
		/* x is a cross product of unit vectors made longer by
		 * 1 / sine, some 1e3 at worst here */
		CHECK_NEAR(dot(b.x, b.z), 0, 1e-12);
		CHECK(b.x[0] * (b.y[1] * b.z[2] - b.y[2] * b.z[1]) +
			  b.x[1] * (b.y[2] * b.z[0] - b.y[0] * b.z[2]) +
			  b.x[2] * (b.y[0] * b.z[1] - b.y[1] * b.z[0]) >
		      0.99);
		for (int k = 0; k < 3; k++)
			toward[k] = c.eye[k] - c.target[k];
		CHECK(dot(toward, b.z) > 0);
		CHECK_NEAR(dot(toward, b.x), 0, 1e-11);
		CHECK(dot(c.up, b.y) > 0);
		CHECK_NEAR(dot(c.up, b.x), 0, 1e-12);
	}
}

/* A point on a pixel's ray is projected to that pixel, at the ray's depth. */
static void
rays_and_projection_are_inverse(void)
{
	uint64_t state = 2;

	for (int i = 0; i < 2000; i++) {
		struct bake_camera c = some_camera(&state, i % 2);
		struct bake_camera_basis b = ready(&c);
		double px = (3 * chance(&state) - 1) * c.width;
		double py = (3 * chance(&state) - 1) * c.height;
		double t = 1000 * (chance(&state) + 0.001), o[3], d[3], p[3];
		double pixel[2], depth;

		bake_camera_ray(&b, px, py, o, d);
		CHECK_NEAR(dot(d, d), 1, 1e-15);
		for (int k = 0; k < 3; k++)
			p[k] = o[k] + t * d[k];
		if (-t * dot(d, b.z) < c.near)
			continue;
		CHECK(bake_camera_project(&b, p, pixel, &depth));
		CHECK_NEAR(depth, -t * dot(d, b.z), 1e-11);
		/* p is off by some 1e-15 of 1000, here for perspective at
		 * depth 0.1 at least, for both by the pixels of a unit */
		CHECK_NEAR(pixel[0], px, 1e-9 + 1e-14 * fabs(b.pixels) * t);
		CHECK_NEAR(pixel[1], py, 1e-9 + 1e-14 * fabs(b.pixels) * t);
	}
}

static void
nearer_than_near_is_not_seen(void)
{
	struct bake_camera_basis b = ready(&plain);
	const double on[3] = { 0, 0, 4.875 }, before[3] = { 0, 0, 4.95 };
	const double behind[3] = { 0, 0, 6 };
	double pixel[2] = { -1, -2 }, depth;

	CHECK(bake_camera_project(&b, on, pixel, &depth));
	CHECK(depth == 0.125);
	pixel[0] = -1;
	CHECK(!bake_camera_project(&b, before, pixel, &depth));
	CHECK(!bake_camera_project(&b, behind, pixel, &depth));
	CHECK(pixel[0] == -1 && depth == -1);
}

static void
refused(const struct bake_camera *c, const char *message)
{
	struct bake_camera_basis b;
	struct bake_err err = BAKE_ERR_INIT;

	memset(&b, 7, sizeof b);
	CHECK(bake_camera_basis(c, &b, &err) == BAKE_EINVAL);
	CHECK(strncmp(err.msg, message, strlen(message)) == 0);
	CHECK(((unsigned char *)&b)[0] == 7);
}

static void
bad_cameras_are_refused(void)
{
	struct bake_camera c = plain;

	c.target[2] = 5;
	refused(&c, "the camera's eye is its target, (0, 0, 5)");
	c = plain;
	c.up[1] = 0;
	refused(&c, "the camera's up is 0");
	c.up[2] = -3;
	refused(&c, "the camera's up (0, 0, -3) is along its view");
	c.up[1] = 1e-6;
	refused(&c, "the camera's up (0, 1e-06, -3) is along its view");
	c.up[1] = 1e-5;
	ready(&c);
	c = plain;
	c.eye[0] = NAN;
	refused(&c, "the camera's eye (nan, 0, 5) has a number beyond");
	c = plain;
	c.target[1] = INFINITY;
	refused(&c, "the camera's target (0, inf, 0)");
	c = plain;
	c.up[0] = 1e101;
	refused(&c, "the camera's up");
	c = plain;
	c.fov_deg = 0.5;
	refused(&c, "an angle of view of 0.5 degrees");
	c.fov_deg = 171;
	refused(&c, "an angle of view of 171 degrees");
	c.fov_deg = NAN;
	refused(&c, "an angle of view of nan degrees");
	c.fov_deg = 0;
	refused(&c, "an orthographic picture 0 high");
	c = plain;
	c.near = 0;
	refused(&c, "the camera's near distance is 0");
	c.near = NAN;
	refused(&c, "the camera's near distance is nan");
	c = plain;
	c.width = 0;
	refused(&c, "a picture of 0x480 pixels: sides are 1 to 32768");
	c.width = 32769;
	refused(&c, "a picture of 32769x480 pixels");
	c = plain;
	c.height = 32769;
	refused(&c, "a picture of 640x32769 pixels");
}

/* Neither squares of large numbers nor of small ones spoil it. */
static void
scale_does_not_matter(void)
{
	const double scale[] = { 1e-90, 1e90 };

	for (int i = 0; i < 2; i++) {
		struct bake_camera c = plain;
		struct bake_camera_basis b;

		c.eye[2] *= scale[i];
		c.eye[0] = 5 * scale[i];
		c.up[1] *= scale[1 - i];
		b = ready(&c);
		CHECK_NEAR(b.z[0], sqrt(0.5), 2e-16);
		CHECK_NEAR(b.x[0], sqrt(0.5), 2e-16);
		CHECK_NEAR(b.x[2], -sqrt(0.5), 2e-16);
		CHECK(b.y[1] == 1);
	}
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(plain_camera_is_by_hand),
		CASE(orthographic_camera_is_by_hand),
		CASE(bases_are_orthonormal),
		CASE(rays_and_projection_are_inverse),
		CASE(nearer_than_near_is_not_seen),
		CASE(bad_cameras_are_refused),
		CASE(scale_does_not_matter),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
