/* What a welded mesh is: edges, boundaries, components. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh.h"

/* Around one point: a neighbour, and which way the edge runs. */
struct spoke {
	int point;
	int inward; /* 1: towards the point in its triangle, 0: away */
};

static int
by_point(const void *a, const void *b)
{
	const struct spoke *s = a, *t = b;

	return s->point != t->point ? s->point < t->point ? -1 : 1
				    : s->inward - t->inward;
}

static int
point_at(const struct bake_mesh *mesh, const struct bake_weld *weld, int corner)
{
	int v = mesh->triangles[corner / 3][corner % 3].v;

	return weld != NULL ? weld->first[v] : v;
}

/* The spokes of point p that lead to higher points: each edge is counted at
 * its lower end. */
static size_t
gather(const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_adjacency *adj, int p, struct spoke *spokes)
{
	size_t n = 0;

	for (int i = adj->start[p]; i < adj->start[p + 1]; i++) {
		int c = adj->corner[i], base = c - c % 3;
		int next = point_at(mesh, weld, base + (c + 1) % 3);
		int prev = point_at(mesh, weld, base + (c + 2) % 3);

		if (next > p)
			spokes[n++] = (struct spoke){ next, 0 };
		if (prev > p)
			spokes[n++] = (struct spoke){ prev, 1 };
	}
	return n;
}

static void
count_edges(struct bake_topology *topology, struct spoke *spokes, size_t n)
{
	qsort(spokes, n, sizeof *spokes, by_point);
	for (size_t i = 0, end; i < n; i = end) {
		size_t inward = 0, total;

		for (end = i; end < n && spokes[end].point == spokes[i].point;
		     end++)
			inward += (size_t)spokes[end].inward;
		total = end - i;
		topology->edges++;
		topology->boundary += total == 1;
		topology->nonmanifold += total > 2;
		topology->flipped += inward > 1;
		topology->flipped += total - inward > 1;
	}
}

static int
root(int *parent, int i)
{
	while (parent[i] != i) {
		parent[i] = parent[parent[i]];
		i = parent[i];
	}
	return i;
}

static void
count_components(const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_adjacency *adj, int *parent,
    struct bake_topology *topology)
{
	size_t n = mesh->npositions;

	for (size_t i = 0; i < n; i++)
		parent[i] = (int)i;
	for (size_t p = 0; p < n; p++)
		for (int i = adj->start[p]; i < adj->start[p + 1]; i++) {
			int c = adj->corner[i], base = c - c % 3;
			int a = root(parent, (int)p);
			int b = root(
			    parent, point_at(mesh, weld, base + (c + 1) % 3));

			parent[a > b ? a : b] = a > b ? b : a;
		}
	for (size_t p = 0; p < n; p++)
		topology->components +=
		    adj->start[p] < adj->start[p + 1] && parent[p] == (int)p;
}

enum bake_status
bake_mesh_topology(const struct bake_mesh *mesh, const struct bake_weld *weld,
    struct bake_topology *topology, struct bake_err *err)
{
	struct bake_adjacency adj = BAKE_ADJACENCY_INIT;
	struct spoke *spokes = NULL;
	int *parent = NULL, most = 0;
	enum bake_status rc;

	memset(topology, 0, sizeof *topology);
	rc = bake_mesh_adjacency(mesh, weld, false, &adj, err);
	if (rc != BAKE_OK)
		goto out;
	for (size_t p = 0; p < mesh->npositions; p++)
		if (adj.start[p + 1] - adj.start[p] > most)
			most = adj.start[p + 1] - adj.start[p];
	spokes = bake_alloc((size_t)most, 2 * sizeof *spokes, err);
	parent = bake_alloc(mesh->npositions, sizeof *parent, err);
	if (spokes == NULL || parent == NULL) {
		rc = BAKE_ENOMEM;
		goto out;
	}
	topology->triangles = adj.ncorners / 3;
	topology->collapsed = mesh->ntriangles - topology->triangles;
	for (size_t p = 0; p < mesh->npositions; p++) {
		bool is_point = weld == NULL || weld->first[p] == (int)p;

		topology->points += is_point;
		topology->isolated +=
		    is_point && adj.start[p] == adj.start[p + 1];
		count_edges(
		    topology, spokes, gather(mesh, weld, &adj, (int)p, spokes));
	}
	count_components(mesh, weld, &adj, parent, topology);
out:
	bake_adjacency_free(&adj);
	free(spokes);
	free(parent);
	return rc;
}
