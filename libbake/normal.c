/* Normals from a depth map, and normals brought to unit length. */
/* SPDX-License-Identifier: MIT */
#include "normal.h"

#include <math.h>

#include "parallel.h"

/* The three rows that an operator sees, and the weights across them. */
struct slopes {
	const float *up, *mid, *down;
	double k; /* depth difference -> tangent, W S / 2 */
	bool scharr;
};

/*
 * The normal at column x, whose neighbours are columns l and r. Depth grows
 * downwards, so that -p = k (d(r) - d(l)): no sign is left to turn a 0 to -0
 * but k's own, which the + 0.0 undoes.
 */
static inline void
put_normal(float *n, const struct slopes *s, int l, int x, int r)
{
	double nx, ny, len;

	if (s->scharr) {
		nx = (3 * ((double)s->up[r] - s->up[l]) +
			 10 * ((double)s->mid[r] - s->mid[l]) +
			 3 * ((double)s->down[r] - s->down[l])) /
		     16;
		ny = (3 * ((double)s->up[l] - s->down[l]) +
			 10 * ((double)s->up[x] - s->down[x]) +
			 3 * ((double)s->up[r] - s->down[r])) /
		     16;
	} else {
		nx = (double)s->mid[r] - s->mid[l];
		ny = (double)s->up[x] - s->down[x];
	}
	nx = s->k * nx + 0.0;
	ny = s->k * ny + 0.0;
	len = sqrt(nx * nx + ny * ny + 1);
	n[0] = (float)(nx / len);
	n[1] = (float)(ny / len);
	n[2] = (float)(1 / len);
}

static enum bake_status
check_depth(const struct bake_image *depth, double depth_scale,
    enum bake_slope_op op, struct bake_err *err)
{
	if (depth->data == NULL || depth->nchans != 1)
		return bake_fail(err, BAKE_EINVAL,
		    "a depth map has 1 channel, this image has %d",
		    depth->nchans);
	if (!isfinite(depth_scale))
		return bake_fail(
		    err, BAKE_EINVAL, "the depth scale is not finite");
	if (op != BAKE_SLOPE_CENTRAL && op != BAKE_SLOPE_SCHARR)
		return bake_fail(
		    err, BAKE_EINVAL, "%d is no slope operator", (int)op);
	return BAKE_OK;
}

enum bake_status
bake_normal_rows_from_depth(const struct bake_image *depth, double depth_scale,
    struct bake_wrap wrap, enum bake_slope_op op, int nthreads, int first,
    struct bake_image *rows, struct bake_err *err)
{
	const int w = depth->width, h = depth->height;
	enum bake_status rc;

	if ((rc = check_depth(depth, depth_scale, op, err)) != BAKE_OK)
		return rc;
	if (rows->data == NULL || rows->nchans != 3 || rows->width != w ||
	    first < 0 || rows->height > h - first)
		return bake_fail(err, BAKE_EINVAL,
		    "rows %d to %d of %d texels do not fit a depth map of "
		    "%dx%d",
		    first, first + rows->height - 1, rows->width, w, h);
#pragma omp parallel for schedule(static) num_threads(bake_threads(nthreads))
	for (int i = 0; i < rows->height; i++) {
		const long y = (long)first + i;
		const int yu = bake_wrap_index(y - 1, h, wrap.clamp_v);
		const int yd = bake_wrap_index(y + 1, h, wrap.clamp_v);
		const struct slopes s = { bake_image_row(depth, yu),
			bake_image_row(depth, (int)y),
			bake_image_row(depth, yd), 0.5 * w * depth_scale,
			op == BAKE_SLOPE_SCHARR };
		float *n = bake_image_row(rows, i);
		const int last = w - 1;

		put_normal(n, &s, bake_wrap_index(-1, w, wrap.clamp_u), 0,
		    bake_wrap_index(1, w, wrap.clamp_u));
		for (int x = 1; x < last; x++)
			put_normal(n + (size_t)x * 3, &s, x - 1, x, x + 1);
		if (last > 0)
			put_normal(n + (size_t)last * 3, &s, last - 1, last,
			    bake_wrap_index(w, w, wrap.clamp_u));
	}
	return BAKE_OK;
}

enum bake_status
bake_normal_from_depth(const struct bake_image *depth, double depth_scale,
    struct bake_wrap wrap, enum bake_slope_op op, int nthreads,
    struct bake_image *normal, struct bake_err *err)
{
	struct bake_image out = BAKE_IMAGE_INIT;
	enum bake_status rc;

	if ((rc = check_depth(depth, depth_scale, op, err)) != BAKE_OK ||
	    (rc = bake_image_alloc(
		 &out, depth->width, depth->height, 3, err)) != BAKE_OK)
		return rc;
	rc = bake_normal_rows_from_depth(
	    depth, depth_scale, wrap, op, nthreads, 0, &out, err);
	if (rc == BAKE_OK)
		*normal = out;
	return rc;
}

/* Returns 1 where the vector had to be replaced. */
static inline int
normalize3(float *n)
{
	const double x = n[0], y = n[1], z = n[2];
	const double len = sqrt(x * x + y * y + z * z);

	if (!(len >= 1e-18 && len <= 1e18)) {
		n[0] = n[1] = 0;
		n[2] = 1;
		return 1;
	}
	n[0] = (float)(x / len);
	n[1] = (float)(y / len);
	n[2] = (float)(z / len);
	return 0;
}

static inline int
complete2(float *n, const float *xy)
{
	const double x = xy[0], y = xy[1], r2 = x * x + y * y;
	double len;

	n[0] = xy[0];
	n[1] = xy[1];
	if (r2 <= 1) {
		n[2] = (float)sqrt(1 - r2);
		return 0;
	}
	len = sqrt(r2);
	if (len <= 1e18) {
		n[0] = (float)(x / len);
		n[1] = (float)(y / len);
		n[2] = 0;
	} else { /* not finite either */
		n[0] = n[1] = 0;
		n[2] = 1;
	}
	return 1;
}

enum bake_status
bake_normal_normalize(struct bake_image *normal, int nthreads,
    size_t *nreplaced, struct bake_err *err)
{
	struct bake_image out = BAKE_IMAGE_INIT;
	const int w = normal->width, h = normal->height;
	size_t count = 0;
	enum bake_status rc;

	if (normal->data == NULL ||
	    (normal->nchans != 2 && normal->nchans != 3))
		return bake_fail(err, BAKE_EINVAL,
		    "a normal map has 2 or 3 channels, this image has %d",
		    normal->nchans);
	if (normal->nchans == 2 &&
	    (rc = bake_image_alloc(&out, w, h, 3, err)) != BAKE_OK)
		return rc;
		/* a sum of whole numbers does not depend on its order */
#pragma omp parallel for schedule(static) reduction(+ : count) \
    num_threads(bake_threads(nthreads))
	for (int y = 0; y < h; y++) {
		float *src = bake_image_row(normal, y);
		float *dst = out.data ? bake_image_row(&out, y) : src;

		for (size_t x = 0; x < (size_t)w; x++)
			count += (size_t)(out.data ? complete2(dst + 3 * x,
							 src + 2 * x)
						   : normalize3(dst + 3 * x));
	}
	if (out.data != NULL) {
		bake_image_swap(normal, &out);
		bake_image_free(&out);
	}
	if (nreplaced != NULL)
		*nreplaced = count;
	return BAKE_OK;
}
