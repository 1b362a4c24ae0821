/* rm-quadfit: what the quadrics of a mesh are like, printed. */
/* SPDX-License-Identifier: MIT */
#include "quadfit.h"

static void
print_ranges(const struct bake_quadric_stats *s)
{
	static const char *const names[] = { "a", "b", "c", "uvscale s",
		"uvscale t" };

	for (int i = 0; i < 5; i++)
		printf("%s\t%.9g\t%.9g\n", names[i], s->lo[i], s->hi[i]);
}

static void
print_fits(const struct bake_quadric_stats *s)
{
	for (int r = 9; r >= 0; r--)
		if (s->rank[r] > 0)
			printf("rank %d\t%zu\n", r, s->rank[r]);
	printf("ring grown\t%zu\nterms lowered\t%zu\n", s->grown, s->lowered);
	printf("boundary corners\t%zu\ncrease corners\t%zu\n", s->boundary,
	    s->crease);
	for (int i = 0; i < BAKE_QUADRIC_NPERCENTILES; i++)
		printf("residual %g %%\t%.9g\n", bake_quadric_percentiles[i],
		    s->residual[i]);
}

static void
print_mesh(
    const char *path, const struct quadfit *q, const struct bake_topology *t)
{
	printf("file\t%s\n", path);
	printf("positions\t%zu\npoints\t%zu\ncorners\t%zu\ntriangles\t%zu\n",
	    q->mesh.npositions, t->points, q->frames.nframes, t->triangles);
	printf("boundary edges\t%zu\nnonmanifold edges\t%zu\n", t->boundary,
	    t->nonmanifold);
	printf("flipped edges\t%zu\nisolated points\t%zu\n", t->flipped,
	    t->isolated);
	printf("without normal\t%zu\nwithout tangent\t%zu\n",
	    q->frames.normal_none, q->frames.tangent_none);
}

bool
quadfit_print_stats(struct cmd *cmd, const struct quadfit_opts *o,
    const char *path, const struct quadfit *q)
{
	struct bake_weld weld = BAKE_WELD_INIT;
	struct bake_quadric_stats s;
	struct bake_topology t;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok = bake_mesh_weld(&q->mesh, o->weld, &weld, &err) == BAKE_OK &&
		  bake_mesh_topology(&q->mesh, &weld, &t, &err) == BAKE_OK &&
		  bake_quadric_count(
		      q->quadrics, q->frames.nframes, &s, &err) == BAKE_OK;

	bake_weld_free(&weld);
	if (!ok) {
		cmd_error(cmd, "%s: %s", path, err.msg);
		return false;
	}
	print_mesh(path, q, &t);
	print_fits(&s);
	print_ranges(&s);
	return true;
}
