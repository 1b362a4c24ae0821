/* A pinhole camera: from positions to pixels and back to rays. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_CAMERA_H
#define BAKE_CAMERA_H

#include <stdbool.h>

#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Row 0 of the picture is the top; pixel (x, y) covers x .. x + 1 by y .. y +
 * 1, its centre is at + 1/2. Pixels are square. eye, target, up  positions and
 * a direction, of any length, in the scene's length unit, within +-1e100. The
 * picture's upward axis is 'up' made orthogonal to the view. fov_deg the
 * vertical angle of view in degrees, 1 .. 170; 0: orthographic, the picture
 * height_world high height_world     in the scene's length unit, 1e-100 ..
 * 1e100; read only where fov_deg is 0 near             nothing that is nearer,
 * measured along the view, is seen; 1e-100 .. 1e100 width, height    of the
 * picture in pixels, each 1 .. 32768
 */
struct bake_camera {
	double eye[3], target[3], up[3];
	double fov_deg, height_world;
	double near;
	int width, height;
};

/*
 * The camera made ready: a right-handed orthonormal basis, x right, y up, z
 * from the scene towards the eye, and the scale of pixels. A position p with
 * q = (p - eye) in that basis is at the depth w = -q.z and on the picture at
 *     perspective   (cx + pixels q.x / w, cy - pixels q.y / w)
 *     orthographic  (cx + pixels q.x,     cy - pixels q.y)
 */
struct bake_camera_basis {
	double eye[3], x[3], y[3], z[3];
	double pixels; /* per unit of the tangent (orthographic: of length) */
	double cx, cy; /* the picture's centre in pixels */
	double near;
	int orthographic;
};

/*
 * Make a camera ready.
 *   basis  out; not touched on failure
 *
 * BAKE_EINVAL  eye = target, up along the view (to within 1e-6 rad) or 0, a
 *              number that is not finite or outside its range
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_camera_basis(const struct bake_camera *camera,
    struct bake_camera_basis *basis, struct bake_err *err);

/*
 * The ray through the point (px, py) of the picture, in pixels, which may be
 * outside it.
 *   origin     out: where it begins: the eye; orthographic: on the plane
 *              through the eye that is orthogonal to the view
 *   direction  out: of unit length
 *
 * Reentrant.
 */
BAKE_API void bake_camera_ray(const struct bake_camera_basis *basis, double px,
    double py, double origin[3], double direction[3]);

/*
 * Where the picture shows a position.
 *   p      finite
 *   pixel  out: x, y in pixels, as above; may be outside the picture
 *   depth  out: its distance from the eye's plane along the view (the w above,
 *          not the length of the ray)
 *
 * Returns false, and leaves pixel alone, where it is nearer than near.
 * Reentrant.
 */
BAKE_API bool bake_camera_project(const struct bake_camera_basis *basis,
    const double p[3], double pixel[2], double *depth);

#ifdef __cplusplus
}
#endif

#endif
