/* The A-buffer: vertices to whole numbers, triangles into bins of rows. */
/* SPDX-License-Identifier: MIT */
#include "abuffer.h"

#include <math.h>
#include <stdlib.h>

#include "abuffer_priv.h"
#include "mem.h"

/* -- vertices ------------------------------------------------------------ */

/*
 * v, in 2^-16 texel, to a whole number. In two steps: where v comes out half a
 * unit above a whole number but for rounding, as vertices on dyadic places do,
 * it goes the same way whatever the rounding was, and so on both sides of a
 * tile (which are an even number of units apart; halves go to the even
 * neighbour).
 */
static int64_t
snap(double v)
{
	const double fine = 1024;

	if (!(fabs(v) <= (double)ABUFFER_FARTHEST))
		return ABUFFER_TOO_FAR;
	return (int64_t)rint(rint(v * fine) / fine);
}

static void
snap_points(struct bake_abuffer *ab)
{
	const struct bake_view *view = &ab->view;
	const struct bake_axes axes = bake_axis_axes(view->axis);
	const double unit = 1 << ABUFFER_BITS;
	const double sx = view->width * unit / (view->x1 - view->x0);
	const double sy = view->height * unit / (view->y1 - view->y0);
	const double range = view->near - view->far;

	for (size_t v = 0; v < ab->mesh->npositions; v++) {
		struct abuffer_point *p = &ab->point[v];
		double q[3];

		if (ab->first != NULL && ab->first[v] != (int)v)
			continue;
		bake_axes_project(&axes, ab->mesh->positions[v], q);
		p->x = snap((q[0] - view->x0) * sx);
		p->y = snap((view->y1 - q[1]) * sy);
		p->depth = (view->near - q[2]) / range;
		if (p->y == ABUFFER_TOO_FAR ||
		    !(fabs(p->depth) <= ABUFFER_DEEPEST))
			p->x = ABUFFER_TOO_FAR;
	}
}

/* -- bins ---------------------------------------------------------------- */

/* The bins of one triangle: n from the first on; with tiling bin 0 comes
 * after the last. */
struct bins {
	uint16_t first, n;
};

static struct bins
bins_of_rows(const struct bake_abuffer *ab, int64_t begin, int64_t end)
{
	const int64_t height = ab->view.height;
	int64_t lo, hi;
	int first, last;

	if (!ab->view.tile_y) {
		begin = begin < 0 ? 0 : begin;
		end = end > height ? height : end;
	}
	if (begin >= end)
		return (struct bins){ 0, 0 };
	if (end - begin >= height)
		return (struct bins){ 0, (uint16_t)ab->nbins };
	lo = begin;
	if (ab->view.tile_y)
		lo -= abuffer_floor_div(begin, height) * height;
	hi = lo + (end - begin) - 1;
	first = (int)(lo / BAKE_BAND_ROWS);
	if (hi < height) {
		last = (int)(hi / BAKE_BAND_ROWS);
	} else {
		last = (int)((hi - height) / BAKE_BAND_ROWS);
		last = last < first ? last + ab->nbins : first + ab->nbins - 1;
	}
	return (struct bins){ (uint16_t)first, (uint16_t)(last - first + 1) };
}

/* Whether [lo, hi], in 2^-16 texel, leaves the tiles that can be counted. */
static bool
leaves_tiles(int64_t lo, int64_t hi, int side)
{
	const int64_t most = (int64_t)INT16_MAX * side;

	return lo < -most * (1 << ABUFFER_BITS) ||
	       hi > most * (1 << ABUFFER_BITS);
}

static enum bake_status
bins_of(const struct bake_abuffer *ab, size_t triangle, struct bins *bins,
    struct bake_err *err)
{
	const struct bake_view *view = &ab->view;
	const struct abuffer_point *p[3];
	int64_t lo[2], hi[2], col[2];

	abuffer_corners(ab, triangle, p);
	lo[0] = hi[0] = p[0]->x;
	lo[1] = hi[1] = p[0]->y;
	for (int k = 1; k < 3; k++) {
		lo[0] = p[k]->x < lo[0] ? p[k]->x : lo[0];
		hi[0] = p[k]->x > hi[0] ? p[k]->x : hi[0];
		lo[1] = p[k]->y < lo[1] ? p[k]->y : lo[1];
		hi[1] = p[k]->y > hi[1] ? p[k]->y : hi[1];
	}
	if (hi[0] == ABUFFER_TOO_FAR)
		return bake_fail(err, BAKE_EDATA,
		    "triangle %zu reaches farther than %d texels from the "
		    "region, or %g times the depth range",
		    triangle, 1 << 30, ABUFFER_DEEPEST);
	if ((view->tile_x && leaves_tiles(lo[0], hi[0], view->width)) ||
	    (view->tile_y && leaves_tiles(lo[1], hi[1], view->height)))
		return bake_fail(err, BAKE_EDATA,
		    "triangle %zu reaches over more than %d tiles", triangle,
		    INT16_MAX);
	/* columns end before the centre that is at hi: edges on the right, and
	 * rows at the bottom, are open */
	col[0] = abuffer_ceil(lo[0]);
	col[1] = abuffer_ceil(hi[0]);
	if (!view->tile_x) {
		col[0] = col[0] < 0 ? 0 : col[0];
		col[1] = col[1] > view->width ? view->width : col[1];
	}
	*bins = (struct bins){ 0, 0 };
	if (col[0] < col[1] && abuffer_ceil(lo[1]) < abuffer_ceil(hi[1]))
		*bins =
		    bins_of_rows(ab, abuffer_ceil(lo[1]), abuffer_ceil(hi[1]));
	return BAKE_OK;
}

/* i modulo n, 0 <= i < 2 n */
static inline int
wrapped(int i, int n)
{
	return i < n ? i : i - n;
}

/* bin's counts become where each starts; the sum is returned. */
static size_t
sum_up(struct bake_abuffer *ab)
{
	size_t sum = 0;

	for (int b = 0; b <= ab->nbins; b++) {
		size_t n = ab->bin[b];

		ab->bin[b] = sum;
		sum += n;
	}
	return sum;
}

static enum bake_status
fill_bins(struct bake_abuffer *ab, struct bins *of, struct bake_err *err)
{
	const size_t n = ab->mesh->ntriangles;
	enum bake_status rc;

	for (size_t t = 0; t < n; t++) {
		if ((rc = bins_of(ab, t, &of[t], err)) != BAKE_OK)
			return rc;
		for (int i = 0; i < of[t].n; i++)
			ab->bin[wrapped(of[t].first + i, ab->nbins)]++;
	}
	ab->item = bake_alloc(sum_up(ab), sizeof *ab->item, err);
	if (ab->item == NULL)
		return BAKE_ENOMEM;
	for (size_t t = 0; t < n; t++)
		for (int i = 0; i < of[t].n; i++) {
			int b = wrapped(of[t].first + i, ab->nbins);

			ab->item[ab->bin[b]++] = (uint32_t)t;
		}
	/* each bin's start is now the next one's */
	for (int b = ab->nbins; b > 0; b--)
		ab->bin[b] = ab->bin[b - 1];
	ab->bin[0] = 0;
	return BAKE_OK;
}

static enum bake_status
make_bins(struct bake_abuffer *ab, struct bake_err *err)
{
	struct bins *of;
	enum bake_status rc = BAKE_ENOMEM;

	ab->nbins = (ab->view.height + BAKE_BAND_ROWS - 1) / BAKE_BAND_ROWS;
	ab->bin = bake_zalloc((size_t)ab->nbins + 1, sizeof *ab->bin, err);
	of = bake_alloc(ab->mesh->ntriangles, sizeof *of, err);
	if (ab->bin != NULL && of != NULL)
		rc = fill_bins(ab, of, err);
	free(of);
	return rc;
}

/* -- opening and closing ------------------------------------------------- */

static enum bake_status
make_ready(struct bake_abuffer *ab, const struct bake_abuffer_params *params,
    struct bake_err *err)
{
	const struct bake_mesh *mesh = ab->mesh;
	enum bake_status rc;

	ab->point = bake_alloc(mesh->npositions, sizeof *ab->point, err);
	if (ab->point == NULL)
		return BAKE_ENOMEM;
	snap_points(ab);
	if (params->reorient) {
		ab->turned = bake_alloc(mesh->ntriangles, 1, err);
		if (ab->turned == NULL)
			return BAKE_ENOMEM;
		rc = bake_abuffer_turn(mesh, ab->first, ab->turned, err);
		if (rc != BAKE_OK)
			return rc;
	}
	return make_bins(ab, err);
}

static enum bake_status
check(const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_view *view, const struct bake_abuffer_params *params,
    struct bake_err *err)
{
	enum bake_status rc;

	if ((rc = bake_view_check(view, err)) != BAKE_OK)
		return rc;
	if (!(params->solidify >= 0) || !isfinite(params->solidify))
		return bake_fail(err, BAKE_EINVAL,
		    "a slab of thickness %g: it is 0 or more",
		    params->solidify);
	if (weld != NULL && weld->npositions != mesh->npositions)
		return bake_fail(err, BAKE_EINVAL,
		    "welding of %zu positions for a mesh of %zu",
		    weld->npositions, mesh->npositions);
	if (mesh->ntriangles == 0)
		return bake_fail(
		    err, BAKE_EDATA, "the mesh has no triangle to be seen");
	if (!(params->solidify / 2 <=
		ABUFFER_DEEPEST * (view->near - view->far)))
		return bake_fail(err, BAKE_EINVAL,
		    "a slab of thickness %g for a depth range of %g",
		    params->solidify, view->near - view->far);
	return BAKE_OK;
}

enum bake_status
bake_abuffer_open(struct bake_abuffer **out, const struct bake_mesh *mesh,
    const struct bake_weld *weld, const struct bake_view *view,
    const struct bake_abuffer_params *params, struct bake_err *err)
{
	struct bake_abuffer *ab;
	enum bake_status rc;

	*out = NULL;
	if ((rc = check(mesh, weld, view, params, err)) != BAKE_OK)
		return rc;
	if ((ab = bake_zalloc(1, sizeof *ab, err)) == NULL)
		return BAKE_ENOMEM;
	ab->mesh = mesh;
	ab->first = weld != NULL ? weld->first : NULL;
	ab->view = *view;
	ab->half = 0.5 * params->solidify / (view->near - view->far);
	if ((rc = make_ready(ab, params, err)) != BAKE_OK)
		bake_abuffer_close(ab);
	else
		*out = ab;
	return rc;
}

void
bake_abuffer_close(struct bake_abuffer *ab)
{
	if (ab == NULL)
		return;
	free(ab->point);
	free(ab->turned);
	free(ab->bin);
	free(ab->item);
	free(ab);
}

/* -- weights ------------------------------------------------------------- */

/* a x b */
static abuffer_wide
cross(const int64_t a[2], const int64_t b[2])
{
	return (abuffer_wide)a[0] * b[1] - (abuffer_wide)a[1] * b[0];
}

static int64_t
cross_small(const int64_t a[2], const int64_t b[2])
{
	return a[0] * b[1] - a[1] * b[0];
}

/* Whether x + 2^30 has no bit from 2^31 on; of several, or them first. */
static uint64_t
magnitude(const int64_t a[2])
{
	return (uint64_t)(a[0] + ABUFFER_SMALL) |
	       (uint64_t)(a[1] + ABUFFER_SMALL);
}

void
bake_abuffer_weights(const struct bake_abuffer *ab,
    const struct bake_crossing *crossing, int x, int y, double weight[3])
{
	const struct abuffer_point *p[3];
	int64_t cx =
	    abuffer_centre(x + (int64_t)crossing->tile_x * ab->view.width);
	int64_t cy =
	    abuffer_centre(y + (int64_t)crossing->tile_y * ab->view.height);
	int64_t u[2], e[2][2];
	double n[3], area;

	abuffer_corners(ab, crossing->triangle, p);
	u[0] = cx - p[0]->x;
	u[1] = cy - p[0]->y;
	for (int k = 0; k < 2; k++) {
		e[k][0] = p[k + 1]->x - p[0]->x;
		e[k][1] = p[k + 1]->y - p[0]->y;
	}
	if ((magnitude(u) | magnitude(e[0]) | magnitude(e[1])) <
	    2 * (uint64_t)ABUFFER_SMALL) {
		int64_t all = cross_small(e[0], e[1]);
		int64_t n1 = cross_small(u, e[1]), n2 = cross_small(e[0], u);

		area = (double)all;
		n[0] = (double)(all - n1 - n2);
		n[1] = (double)n1;
		n[2] = (double)n2;
	} else {
		abuffer_wide all = cross(e[0], e[1]);
		abuffer_wide n1 = cross(u, e[1]), n2 = cross(e[0], u);

		area = (double)all;
		n[0] = (double)(all - n1 - n2);
		n[1] = (double)n1;
		n[2] = (double)n2;
	}
	for (int k = 0; k < 3; k++)
		weight[k] = n[k] / area;
}
