/* Orthographic views of a mesh. */
/* SPDX-License-Identifier: MIT */
#include "view.h"

#include <math.h>

enum { MAX_SIDE = 65536 };

const char *
bake_axis_name(enum bake_axis axis)
{
	static const char *const names[] = { "+x", "-x", "+y", "-y", "+z",
		"-z" };

	return names[axis];
}

struct bake_axes
bake_axis_axes(enum bake_axis axis)
{
	static const struct bake_axes axes[] = {
		{ { 2, 1, 0 }, { -1, 1, 1 } },
		{ { 2, 1, 0 }, { 1, 1, -1 } },
		{ { 0, 2, 1 }, { 1, -1, 1 } },
		{ { 0, 2, 1 }, { 1, 1, -1 } },
		{ { 0, 1, 2 }, { 1, 1, 1 } },
		{ { 0, 1, 2 }, { -1, 1, -1 } },
	};

	return axes[axis];
}

static enum bake_status
check_picture(const struct bake_view *view, struct bake_err *err)
{
	if ((unsigned)view->axis > BAKE_AXIS_NEG_Z)
		return bake_fail(err, BAKE_EINVAL,
		    "axis %d is none of the six, 0 to 5", (int)view->axis);
	if (view->width < 1 || view->width > MAX_SIDE || view->height < 1 ||
	    view->height > MAX_SIDE)
		return bake_fail(err, BAKE_EINVAL,
		    "a picture of %dx%d texels: sides are 1 to %d", view->width,
		    view->height, MAX_SIDE);
	return BAKE_OK;
}

enum bake_status
bake_view_check(const struct bake_view *view, struct bake_err *err)
{
	enum bake_status rc;

	if ((rc = check_picture(view, err)) != BAKE_OK)
		return rc;
	/* differences that are finite have finite ends */
	if (!(view->x0 < view->x1) || !isfinite(view->x1 - view->x0) ||
	    !(view->y0 < view->y1) || !isfinite(view->y1 - view->y0))
		return bake_fail(err, BAKE_EINVAL,
		    "the region from (%g, %g) to (%g, %g) is not a rectangle",
		    view->x0, view->y0, view->x1, view->y1);
	if (!(view->far < view->near) || !isfinite(view->near - view->far))
		return bake_fail(err, BAKE_EINVAL,
		    "the depths from near %g to far %g are no range: near is "
		    "the larger, towards the eye",
		    view->near, view->far);
	return BAKE_OK;
}

/* [lo, hi] becomes size wide about its middle, but keeps what it holds: the
 * middle of two neighbouring doubles is one of them. */
static void
widen(double *lo, double *hi, double size)
{
	double middle = *lo + 0.5 * (*hi - *lo);

	*lo = fmin(*lo, middle - 0.5 * size);
	*hi = fmax(*hi, middle + 0.5 * size);
	if (!(*lo < *hi)) {
		*lo = nextafter(*lo, -INFINITY);
		*hi = nextafter(*hi, INFINITY);
	}
}

enum bake_status
bake_view_fit(
    struct bake_view *view, const struct bake_mesh *mesh, struct bake_err *err)
{
	struct bake_err why = BAKE_ERR_INIT;
	enum bake_status rc;
	struct bake_axes axes;
	double lo[3], hi[3], a[3], b[3], size[3], largest = 0, texel;

	if ((rc = check_picture(view, err)) != BAKE_OK)
		return rc;
	if (mesh->ntriangles == 0)
		return bake_fail(
		    err, BAKE_EDATA, "the mesh has no triangle to be seen");
	bake_mesh_bounds(mesh, lo, hi);
	axes = bake_axis_axes(view->axis);
	bake_axes_project(&axes, lo, a);
	bake_axes_project(&axes, hi, b);
	for (int k = 0; k < 3; k++) {
		lo[k] = fmin(a[k], b[k]);
		hi[k] = fmax(a[k], b[k]);
		size[k] = hi[k] - lo[k];
		largest = fmax(largest, size[k]);
	}
	if (!(largest > 0))
		return bake_fail(err, BAKE_EDATA,
		    "all triangles are in one point, (%g, %g, %g)", lo[0],
		    lo[1], lo[2]);
	texel = fmax(size[0] / view->width, size[1] / view->height);
	if (!(texel > 0))
		texel = largest / fmin(view->width, view->height);
	widen(&lo[0], &hi[0], texel * view->width);
	widen(&lo[1], &hi[1], texel * view->height);
	widen(&lo[2], &hi[2], size[2] > 0 ? size[2] : largest);
	view->x0 = lo[0];
	view->x1 = hi[0];
	view->y0 = lo[1];
	view->y1 = hi[1];
	view->far = lo[2];
	view->near = hi[2];
	if (bake_view_check(view, &why) == BAKE_OK)
		return BAKE_OK;
	return bake_fail(err, BAKE_EDATA,
	    "the mesh is too large for a view: an extent of %g", largest);
}
