/* A pinhole camera: from positions to pixels and back to rays. */
/* SPDX-License-Identifier: MIT */
#include "camera.h"

#include <math.h>
#include <string.h>

enum { MAX_SIDE = 32768 };

/* Beyond this squares and products of three would overflow. */
static const double max_length = 1e100;
static const double max_fov = 170;
/* The least sine of the angle between the view and up: 1e-6 of a radian is far
 * from what rounding leaves of a cross product. */
static const double min_sine = 1e-6;

static double
dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void
cross(const double a[3], const double b[3], double c[3])
{
	c[0] = a[1] * b[2] - a[2] * b[1];
	c[1] = a[2] * b[0] - a[0] * b[2];
	c[2] = a[0] * b[1] - a[1] * b[0];
}

/* To length 1; false where there is none to speak of. */
static bool
normalize(double v[3])
{
	double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2]))), length;

	if (!(largest > 0))
		return false;
	/* neither overflow nor underflow of squares */
	for (int i = 0; i < 3; i++)
		v[i] /= largest;
	length = sqrt(dot(v, v));
	for (int i = 0; i < 3; i++)
		v[i] /= length;
	return true;
}

static bool
is_usable(const double v[3])
{
	for (int i = 0; i < 3; i++)
		if (!(fabs(v[i]) <= max_length))
			return false;
	return true;
}

static enum bake_status
check(const struct bake_camera *c, struct bake_err *err)
{
	const struct {
		const char *name;
		const double *v;
	} of[] = { { "eye", c->eye }, { "target", c->target },
		{ "up", c->up } };

	for (size_t i = 0; i < sizeof of / sizeof *of; i++)
		if (!is_usable(of[i].v))
			return bake_fail(err, BAKE_EINVAL,
			    "the camera's %s (%g, %g, %g) has a number beyond "
			    "+-%g",
			    of[i].name, of[i].v[0], of[i].v[1], of[i].v[2],
			    max_length);
	if (c->fov_deg != 0 && !(c->fov_deg >= 1 && c->fov_deg <= max_fov))
		return bake_fail(err, BAKE_EINVAL,
		    "an angle of view of %g degrees: it is 1 to %g, or 0 for "
		    "an orthographic picture",
		    c->fov_deg, max_fov);
	if (c->fov_deg == 0 && !(c->height_world >= 1 / max_length &&
				   c->height_world <= max_length))
		return bake_fail(err, BAKE_EINVAL,
		    "an orthographic picture %g high: it is %g to %g",
		    c->height_world, 1 / max_length, max_length);
	if (!(c->near >= 1 / max_length && c->near <= max_length))
		return bake_fail(err, BAKE_EINVAL,
		    "the camera's near distance is %g: it is %g to %g", c->near,
		    1 / max_length, max_length);
	if (c->width < 1 || c->width > MAX_SIDE || c->height < 1 ||
	    c->height > MAX_SIDE)
		return bake_fail(err, BAKE_EINVAL,
		    "a picture of %dx%d pixels: sides are 1 to %d", c->width,
		    c->height, MAX_SIDE);
	return BAKE_OK;
}

static enum bake_status
set_axes(const struct bake_camera *c, struct bake_camera_basis *b,
    struct bake_err *err)
{
	double up[3], x[3], sine;

	memcpy(up, c->up, sizeof up);
	for (int i = 0; i < 3; i++)
		b->z[i] = c->eye[i] - c->target[i];
	if (!normalize(b->z))
		return bake_fail(err, BAKE_EINVAL,
		    "the camera's eye is its target, (%g, %g, %g)", c->eye[0],
		    c->eye[1], c->eye[2]);
	if (!normalize(up))
		return bake_fail(err, BAKE_EINVAL, "the camera's up is 0");
	cross(up, b->z, x);
	sine = sqrt(dot(x, x));
	if (!(sine >= min_sine))
		return bake_fail(err, BAKE_EINVAL,
		    "the camera's up (%g, %g, %g) is along its view", c->up[0],
		    c->up[1], c->up[2]);
	normalize(x);
	memcpy(b->x, x, sizeof x);
	cross(b->z, b->x, b->y);
	normalize(b->y);
	return BAKE_OK;
}

enum bake_status
bake_camera_basis(const struct bake_camera *camera,
    struct bake_camera_basis *basis, struct bake_err *err)
{
	const double degree = 0.01745329251994329577;
	struct bake_camera_basis b;
	enum bake_status rc;

	if ((rc = check(camera, err)) != BAKE_OK ||
	    (rc = set_axes(camera, &b, err)) != BAKE_OK)
		return rc;
	memcpy(b.eye, camera->eye, sizeof b.eye);
	b.orthographic = camera->fov_deg == 0;
	b.pixels = b.orthographic ? camera->height / camera->height_world
				  : 0.5 * camera->height /
					tan(0.5 * degree * camera->fov_deg);
	b.cx = 0.5 * camera->width;
	b.cy = 0.5 * camera->height;
	b.near = camera->near;
	*basis = b;
	return BAKE_OK;
}

void
bake_camera_ray(const struct bake_camera_basis *b, double px, double py,
    double origin[3], double direction[3])
{
	const double x = (px - b->cx) / b->pixels, y = (b->cy - py) / b->pixels;

	for (int i = 0; i < 3; i++) {
		double across = x * b->x[i] + y * b->y[i];

		origin[i] = b->eye[i] + (b->orthographic ? across : 0);
		direction[i] = (b->orthographic ? 0 : across) - b->z[i];
	}
	normalize(direction);
}

bool
bake_camera_project(const struct bake_camera_basis *b, const double p[3],
    double pixel[2], double *depth)
{
	double from[3], scale;

	for (int i = 0; i < 3; i++)
		from[i] = p[i] - b->eye[i];
	*depth = -dot(from, b->z);
	if (!(*depth >= b->near))
		return false;
	scale = b->orthographic ? b->pixels : b->pixels / *depth;
	pixel[0] = b->cx + scale * dot(from, b->x);
	pixel[1] = b->cy - scale * dot(from, b->y);
	return true;
}
