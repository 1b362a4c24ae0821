/* Shell marching: which prisms touch, and rays from one to the next. */
/* SPDX-License-Identifier: MIT */
#include "shell_march.h"

#include <stdlib.h>

#include "march_priv.h"
#include "mem.h"
#include "parallel.h"
#include "shell_march_priv.h"

/* Normals at a point that differ by more than this make a crease. */
static const double crease = 1e-3;
/* What a shadow ray may be below the relief, in depths: the rounding of where
 * it starts. */
static const double shadow_bias = 1e-7;
/* A ray gets on in a prism by more than this share of the longest edge. */
static const double stuck = 1e-8;
/* Most prisms, and most cells, that a ray is followed through, and most turns
 * at one place. */
enum { MOST_PRISMS = 1 << 16, MOST_CELLS = 1 << 22, MOST_TURNS = 8 };

/* -- neighbours --------------------------------------------------------------
 */

static int
point_of(const struct bake_shell *s, int triangle, int k)
{
	const int v = s->mesh->triangles[triangle][k].v;

	return s->first != NULL ? s->first[v] : v;
}

static bool
same_normal(const struct bake_shell *s, int t, int k, int other, int l)
{
	const double *n = bake_shell_normal(s, t, k);
	const double *m = bake_shell_normal(s, other, l);
	double d2 = 0;

	for (int c = 0; c < 3; c++)
		d2 += (n[c] - m[c]) * (n[c] - m[c]);
	return d2 <= crease * crease;
}

/*
 * What is beyond side k of a triangle: a search of the corners at that end of
 * its edge where there are fewer.
 */
static int
find_next(
    const struct bake_shell *s, const struct bake_adjacency *adj, int t, int k)
{
	const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
	const int a = point_of(s, t, k1), b = point_of(s, t, k2);
	const int na = adj->start[a + 1] - adj->start[a];
	const int nb = adj->start[b + 1] - adj->start[b];
	const int at = na <= nb ? a : b;
	int found = -1, n = 0;

	for (int i = adj->start[at]; i < adj->start[at + 1]; i++) {
		const int other = adj->corner[i] / 3;

		for (int l = 0; l < 3 && other != t; l++) {
			const int x = point_of(s, other, (l + 1) % 3);
			const int y = point_of(s, other, (l + 2) % 3);

			if (x == a && y == b)
				n = 2; /* wound the other way */
			if (x != b || y != a)
				continue;
			n++;
			if (same_normal(s, t, k1, other, (l + 2) % 3) &&
			    same_normal(s, t, k2, other, (l + 1) % 3))
				found = 3 * other + l;
		}
	}
	return n == 1 ? found : -1;
}

static bool
is_collapsed(const struct bake_shell *s, int t)
{
	const int a = point_of(s, t, 0), b = point_of(s, t, 1);
	const int c = point_of(s, t, 2);

	return a == b || b == c || c == a;
}

static enum bake_status
join(struct bake_shell *s, const struct bake_weld *weld, int nthreads,
    struct bake_err *err)
{
	const int ntriangles = (int)s->mesh->ntriangles;
	struct bake_adjacency adj = BAKE_ADJACENCY_INIT;
	enum bake_status rc;

	rc = bake_mesh_adjacency(s->mesh, weld, false, &adj, err);
	if (rc != BAKE_OK)
		return rc;
#pragma omp parallel for schedule(static) num_threads(bake_threads(nthreads))
	for (int t = 0; t < ntriangles; t++)
		for (int k = 0; k < 3; k++)
			s->next[t][k] =
			    is_collapsed(s, t) ? -1 : find_next(s, &adj, t, k);
	bake_adjacency_free(&adj);
	return BAKE_OK;
}

static enum bake_status
check(const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_frames *frames, const double number[3],
    struct bake_err *err)
{
	static const char *const name[] = { "depth", "tile factor of u",
		"tile factor of v" };

	for (int k = 0; k < 3; k++)
		if (!(number[k] > 0) || !isfinite(number[k]))
			return bake_fail(err, BAKE_EINVAL,
			    "the %s of a shell is %g, it must be above 0",
			    name[k], number[k]);
	if (frames->ntriangles != mesh->ntriangles)
		return bake_fail(err, BAKE_EINVAL,
		    "the frames are of %zu triangles, the mesh has %zu",
		    frames->ntriangles, mesh->ntriangles);
	if (weld != NULL && weld->npositions != mesh->npositions)
		return bake_fail(err, BAKE_EINVAL,
		    "the weld is of %zu positions, the mesh has %zu",
		    weld->npositions, mesh->npositions);
	if (mesh->nuvs == 0)
		return bake_fail(err, BAKE_EDATA,
		    "the mesh has no UVs, a relief needs them");
	return BAKE_OK;
}

enum bake_status
bake_shell_open(struct bake_shell **shell, const struct bake_mesh *mesh,
    const struct bake_weld *weld, const struct bake_frames *frames,
    double depth, double tile_u, double tile_v, int nthreads,
    struct bake_err *err)
{
	const double number[3] = { depth, tile_u, tile_v };
	struct bake_shell *s;
	enum bake_status rc;

	*shell = NULL;
	if ((rc = check(mesh, weld, frames, number, err)) != BAKE_OK)
		return rc;
	s = bake_zalloc(1, sizeof *s, err);
	if (s == NULL)
		return BAKE_ENOMEM;
	s->mesh = mesh;
	s->first = weld != NULL ? weld->first : NULL;
	s->frames = frames;
	s->depth = depth;
	s->tile[0] = tile_u;
	s->tile[1] = tile_v;
	s->next = bake_alloc(mesh->ntriangles, sizeof *s->next, err);
	rc = s->next == NULL ? BAKE_ENOMEM : join(s, weld, nthreads, err);
	if (rc != BAKE_OK) {
		bake_shell_close(s);
		return rc;
	}
	*shell = s;
	return BAKE_OK;
}

void
bake_shell_close(struct bake_shell *shell)
{
	if (shell == NULL)
		return;
	free(shell->next);
	free(shell);
}

/* -- rays --------------------------------------------------------------------
 */

struct walk {
	const struct bake_shell *shell;
	const struct bake_relief_map *map;
	const double *origin, *dir;
	double bias;
	bool any;
	int triangle, entered; /* the side over which it came, or -1 */
	struct shell_prism prism;
	struct shell_point at;
};

/* Over the side `side` of the prism into the next; false where the mesh ends.
 * Triangles without area are gone through at once. */
static bool
enter_next(struct walk *w, int side, int *nprisms)
{
	const struct bake_shell *s = w->shell;
	double point[3];

	for (int c = 0; c < 3; c++)
		point[c] = w->origin[c] + w->at.t * w->dir[c];
	for (;;) {
		const int next = s->next[w->triangle][side];

		if (next < 0 || --*nprisms < 0)
			return false;
		w->triangle = next / 3;
		w->entered = next % 3;
		if (bake_shell_prism(
			&w->prism, s, w->map, w->triangle, w->origin, w->dir))
			return true;
		side =
		    bake_shell_pass(s, w->triangle, w->entered, point, w->at.z);
	}
}

/*
 * Whether the ray goes to and fro over one side without getting on: on the
 * other side of it the shell is folded. A few such turns may be rounding.
 */
static bool
is_stuck(
    const struct walk *w, const struct shell_point *out, int side, int *nturns)
{
	if (out->t - w->at.t > stuck * w->prism.size)
		*nturns = 0;
	else if (side == w->entered)
		++*nturns;
	return *nturns > MOST_TURNS;
}

/* True with the hit in w->at and w->triangle. */
static bool
follow(struct walk *w, double z)
{
	struct shell_budget budget = { MOST_CELLS };
	int nprisms = MOST_PRISMS, nturns = 0;

	w->entered = -1;
	if (!bake_shell_prism(
		&w->prism, w->shell, w->map, w->triangle, w->origin, w->dir) ||
	    !bake_shell_solve(&w->prism, 0, z, &w->at))
		return false;
	for (;;) {
		const int triangle = w->triangle;
		struct shell_point out;
		bool ground;
		int side;

		side = bake_shell_leave(&w->prism, &w->at, w->entered, &out);
		if (bake_shell_search(&w->prism, w->map, &w->at, &out, w->bias,
			w->any, &budget, &w->at))
			return true;
		ground = side == SHELL_BOTTOM || side == SHELL_FOLD ||
			 is_stuck(w, &out, side, &nturns);
		w->at = out;
		if (ground)
			return true;
		if (side == SHELL_TOP || !enter_next(w, side, &nprisms))
			return false;
		if (!bake_shell_solve(&w->prism, out.t, out.z, &w->at)) {
			/* folded: the ground, where it was seen last */
			w->triangle = triangle;
			w->at = out;
			return true;
		}
	}
}

static bool
can_follow(const struct bake_shell *shell, int triangle, double b1, double b2,
    const double origin[3], const double dir[3])
{
	bool moves = false;

	if (triangle < 0 || (size_t)triangle >= shell->mesh->ntriangles ||
	    !isfinite(b1) || !isfinite(b2))
		return false;
	for (int c = 0; c < 3; c++) {
		if (!isfinite(origin[c]) || !isfinite(dir[c]))
			return false;
		moves = moves || dir[c] != 0;
	}
	return moves;
}

/* The relief's u or v at the hit. */
static double
uv_of(const struct walk *w, const double b[3], int axis)
{
	const struct bake_corner *corner =
	    w->shell->mesh->triangles[w->triangle];
	double u = 0;

	for (int k = 0; k < 3; k++)
		if (corner[k].vt >= 0)
			u += b[k] * w->shell->mesh->uvs[corner[k].vt][axis];
	return u * w->shell->tile[axis];
}

void
bake_shell_march(const struct bake_shell *shell,
    const struct bake_relief_map *map, int triangle, double b1, double b2,
    const double origin[3], const double dir[3], struct bake_shell_hit *hit)
{
	struct walk w = { .shell = shell,
		.map = map,
		.origin = origin,
		.dir = dir,
		.triangle = triangle };

	*hit = (struct bake_shell_hit){ .t = -1, .triangle = -1 };
	if (!can_follow(shell, triangle, b1, b2, origin, dir) || !follow(&w, 0))
		return;
	hit->t = w.at.t;
	hit->triangle = w.triangle;
	hit->b1 = w.at.b[1];
	hit->b2 = w.at.b[2];
	hit->z = w.at.z > 0 ? w.at.z < 1 ? w.at.z : 1 : 0;
	hit->u = uv_of(&w, w.at.b, 0);
	hit->v = uv_of(&w, w.at.b, 1);
}

int
bake_shell_march_any(const struct bake_shell *shell,
    const struct bake_relief_map *map, const struct bake_shell_hit *from,
    const double dir[3])
{
	const double b[3] = { 1 - from->b1 - from->b2, from->b1, from->b2 };
	double origin[3] = { 0, 0, 0 };
	struct walk w = { .shell = shell,
		.map = map,
		.origin = origin,
		.dir = dir,
		.bias = shadow_bias,
		.any = true,
		.triangle = from->triangle };

	if (!can_follow(shell, from->triangle, b[1], b[2], origin, dir))
		return 0;
	for (int k = 0; k < 3; k++) {
		const double *p = bake_shell_position(shell, w.triangle, k);
		const double *n = bake_shell_normal(shell, w.triangle, k);

		for (int c = 0; c < 3; c++)
			origin[c] +=
			    b[k] * (p[c] - from->z * shell->depth * n[c]);
	}
	return follow(&w, from->z) ? 1 : 0;
}
