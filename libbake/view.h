/* Orthographic views of a mesh: which side, which rectangle, which depths. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_VIEW_H
#define BAKE_VIEW_H

#include <stdbool.h>

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The side of the mesh that is seen: +Z is seen by an eye far away on the
 * positive z axis. */
enum bake_axis {
	BAKE_AXIS_POS_X,
	BAKE_AXIS_NEG_X,
	BAKE_AXIS_POS_Y,
	BAKE_AXIS_NEG_Y,
	BAKE_AXIS_POS_Z,
	BAKE_AXIS_NEG_Z
};

/* "+x", "-x", "+y", "-y", "+z" or "-z": static text. Reentrant. */
BAKE_API const char *bake_axis_name(enum bake_axis axis);

/*
 * The axes of a view, right-handed: X to the right and Y to the top of the
 * picture, Z towards the eye, as signed axes of the mesh.
 *
 *     side   X   Y   Z          side   X   Y   Z
 *     +x    -z  +y  +x          -x    +z  +y  -x
 *     +y    +x  -z  +y          -y    +x  +z  -y
 *     +z    +x  +y  +z          -z    -x  +y  -z
 *
 *   index  which of the mesh's coordinates X, Y and Z are
 *   sign   +1 or -1
 *
 * Z is the side that is named; y is up, but for the views from above and
 * below, which have x to the right. Reentrant.
 */
struct bake_axes {
	int index[3];
	double sign[3];
};
BAKE_API struct bake_axes bake_axis_axes(enum bake_axis axis);

/* A position of the mesh in the axes of the view: sign[i] * p[index[i]]. */
static inline void
bake_axes_project(const struct bake_axes *axes, const double p[3], double q[3])
{
	for (int i = 0; i < 3; i++)
		q[i] = axes->sign[i] * p[axes->index[i]];
}

/*
 * A view: width x height texels on the rectangle x0 <= X <= x1, y0 <= Y <= y1,
 * depth 0 at Z = near and 1 at Z = far, all in the view's axes and in the
 * mesh's length unit (Z grows towards the eye, so that near > far):
 *     texel (x, y)'s centre: X = x0 + (x + 1/2) (x1 - x0) / width
 *                            Y = y1 - (y + 1/2) (y1 - y0) / height
 *     d = (near - Z) / (near - far)
 * Row 0 is the top. tile_x, tile_y: the geometry goes on with the region's
 * width or height as its period; otherwise what lies outside is cut off.
 * Depths are never cut off.
 */
struct bake_view {
	enum bake_axis axis;
	int width, height;
	double x0, y0, x1, y1;
	double near, far;
	bool tile_x, tile_y;
};

/*
 * The view of a whole mesh: the smallest rectangle of the texture's aspect
 * (width : height texels, which are square) that holds it, centred on it, and
 * its own depths, so that the middle of its box has d = 1/2: the plane of a
 * relief impostor (Policarpo and Oliveira 2006, section 4). The box is that of
 * the positions that triangles use. A mesh that is flat along the axis gets a
 * range of its largest extent, itself in the middle; one that is a line along
 * the axis, texels that make the shorter side as long as the line.
 *
 *   view  in: axis, width, height; out: region and depths. tile_x and tile_y
 *         are left alone; on failure all is
 *   mesh  not modified
 *   err   reason on failure; never NULL
 *
 * BAKE_EINVAL  axis, width or height is not valid
 * BAKE_EDATA   the mesh has no triangle, all its triangles are in one point,
 *              or its extent is not finite
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_view_fit(
    struct bake_view *view, const struct bake_mesh *mesh, struct bake_err *err);

/*
 * Check a view: an axis, sides of 1 .. 65536 texels, x0 < x1, y0 < y1, far <
 * near, and the three differences finite.
 *
 * BAKE_EINVAL  it is not so; the message names what and the values
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_view_check(
    const struct bake_view *view, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
