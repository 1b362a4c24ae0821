/* A copy of a mesh in an order that keeps neighbours near in memory. */
/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh_frame_priv.h"

/* A point and where it is on a curve that fills space. */
struct place {
	uint32_t code;
	int point;
};

/* Bits of x, each two places apart. */
static uint32_t
spread(uint32_t x)
{
	x = (x | x << 16) & 0x030000ff;
	x = (x | x << 8) & 0x0300f00f;
	x = (x | x << 4) & 0x030c30c3;
	return (x | x << 2) & 0x09249249;
}

/* Sort by the 30 bits of code: three passes of 10. The result is in b. */
static void
sort_places(struct place *a, struct place *b, size_t n)
{
	enum { BITS = 10, SIZE = 1 << BITS };
	size_t at[SIZE];

	for (int shift = 0; shift < 3 * BITS; shift += BITS) {
		struct place *swap = a;
		size_t sum = 0;

		memset(at, 0, sizeof at);
		for (size_t i = 0; i < n; i++)
			at[a[i].code >> shift & (SIZE - 1)]++;
		for (int d = 0; d < SIZE; d++) {
			size_t count = at[d];

			at[d] = sum;
			sum += count;
		}
		for (size_t i = 0; i < n; i++)
			b[at[a[i].code >> shift & (SIZE - 1)]++] = a[i];
		a = b;
		b = swap;
	}
}

static void
bounds(const struct bake_mesh *m, double lo[3], double hi[3])
{
	for (int k = 0; k < 3; k++)
		lo[k] = hi[k] = m->positions[0][k];
	for (size_t i = 1; i < m->npositions; i++)
		for (int k = 0; k < 3; k++) {
			double x = m->positions[i][k];

			lo[k] = x < lo[k] ? x : lo[k];
			hi[k] = x > hi[k] ? x : hi[k];
		}
}

static void
make_codes(const struct bake_mesh *m, struct place *places)
{
	double lo[3], hi[3], scale[3];

	bounds(m, lo, hi);
	for (int k = 0; k < 3; k++)
		scale[k] = 1023.0 / (hi[k] - lo[k]);
	for (size_t i = 0; i < m->npositions; i++) {
		places[i].code = 0;
		places[i].point = (int)i;
		for (int k = 0; k < 3; k++) {
			double x = (m->positions[i][k] - lo[k]) * scale[k];

			/* false where the box has no extent */
			if (x >= 0.0 && x < 1024.0)
				places[i].code |= spread((uint32_t)x) << k;
		}
	}
}

/* Positions and weld along Morton's curve; place[v] is where v goes. */
static enum bake_status
copy_positions(const struct bake_mesh *m, const struct bake_weld *weld,
    struct frame_copy *to, int *place, struct bake_err *err)
{
	size_t n = m->npositions;
	struct place *a = bake_alloc(n, sizeof *a, err);
	struct place *b = bake_alloc(n, sizeof *b, err);
	enum bake_status rc = BAKE_ENOMEM;

	to->mesh.positions = bake_alloc(n, sizeof *to->mesh.positions, err);
	to->position = bake_alloc(n, sizeof *to->position, err);
	to->weld.first = bake_alloc(n, sizeof *to->weld.first, err);
	if (a == NULL || b == NULL || to->mesh.positions == NULL ||
	    to->position == NULL || to->weld.first == NULL)
		goto out;
	make_codes(m, a);
	sort_places(a, b, n);
	for (size_t i = 0; i < n; i++) {
		int v = b[i].point;

		place[v] = (int)i;
		to->position[i] = v;
		memcpy(to->mesh.positions[i], m->positions[v],
		    sizeof to->mesh.positions[i]);
	}
	for (size_t i = 0; i < n; i++)
		to->weld.first[i] =
		    weld != NULL ? place[weld->first[to->position[i]]] : (int)i;
	to->mesh.npositions = to->weld.npositions = n;
	rc = BAKE_OK;
out:
	free(a);
	free(b);
	return rc;
}

static int
first_place(const struct bake_corner t[3], const int *place)
{
	int a = place[t[0].v], b = place[t[1].v], c = place[t[2].v];

	a = b < a ? b : a;
	return c < a ? c : a;
}

/* Triangles by the first of their positions: a counting sort. */
static enum bake_status
copy_triangles(const struct bake_mesh *m, struct frame_copy *to,
    const int *place, struct bake_err *err)
{
	size_t n = m->ntriangles, sum = 0;
	int *at = bake_zalloc(m->npositions, sizeof *at, err);

	to->mesh.triangles = bake_alloc(n, sizeof *to->mesh.triangles, err);
	to->triangle = bake_alloc(n, sizeof *to->triangle, err);
	if (at == NULL || to->mesh.triangles == NULL || to->triangle == NULL) {
		free(at);
		return BAKE_ENOMEM;
	}
	for (size_t i = 0; i < n; i++)
		at[first_place(m->triangles[i], place)]++;
	for (size_t p = 0; p < m->npositions; p++) {
		int count = at[p];

		at[p] = (int)sum;
		sum += (size_t)count;
	}
	for (size_t i = 0; i < n; i++)
		to->triangle[at[first_place(m->triangles[i], place)]++] =
		    (int)i;
	/* far reads, which need not wait for each other, not far writes */
	for (size_t i = 0; i < n; i++) {
		const struct bake_corner *t = m->triangles[to->triangle[i]];

		for (int c = 0; c < 3; c++)
			to->mesh.triangles[i][c] =
			    (struct bake_corner){ place[t[c].v], t[c].vt,
				    t[c].vn };
	}
	to->mesh.ntriangles = n;
	free(at);
	return BAKE_OK;
}

/* UVs in the order of their first use. */
static enum bake_status
copy_uvs(const struct bake_mesh *m, struct frame_copy *to, struct bake_err *err)
{
	int *place = bake_alloc(m->nuvs, sizeof *place, err), n = 0;

	to->mesh.uvs = bake_alloc(m->nuvs, sizeof *to->mesh.uvs, err);
	to->uv = bake_alloc(m->nuvs, sizeof *to->uv, err);
	if (place == NULL || to->mesh.uvs == NULL || to->uv == NULL) {
		free(place);
		return BAKE_ENOMEM;
	}
	memset(place, 0xff, m->nuvs * sizeof *place);
	for (size_t i = 0; i < m->ntriangles; i++)
		for (int k = 0; k < 3; k++) {
			struct bake_corner *c = &to->mesh.triangles[i][k];
			int vt = c->vt;

			if (vt < 0)
				continue;
			if (place[vt] < 0) {
				place[vt] = n;
				to->uv[n] = vt;
				memcpy(to->mesh.uvs[n++], m->uvs[vt],
				    sizeof *m->uvs);
			}
			c->vt = place[vt];
		}
	to->mesh.nuvs = (size_t)n;
	free(place);
	return BAKE_OK;
}

enum bake_status
bake_frame_copy(const struct bake_mesh *m, const struct bake_weld *weld,
    struct frame_copy *to, struct bake_err *err)
{
	int *place = bake_alloc(m->npositions, sizeof *place, err);
	enum bake_status rc = BAKE_ENOMEM;

	memset(to, 0, sizeof *to);
	if (place != NULL &&
	    (rc = copy_positions(m, weld, to, place, err)) == BAKE_OK &&
	    (rc = copy_triangles(m, to, place, err)) == BAKE_OK)
		rc = copy_uvs(m, to, err);
	/* used once for each corner, and often absent: left where they are */
	to->mesh.normals = m->normals;
	to->mesh.nnormals = m->nnormals;
	to->mesh.tangents = m->tangents;
	free(place);
	return rc;
}

void
bake_frame_copy_free(struct frame_copy *c)
{
	free(c->mesh.positions);
	free(c->mesh.uvs);
	free(c->mesh.triangles);
	free(c->weld.first);
	free(c->position);
	free(c->uv);
	free(c->triangle);
	memset(c, 0, sizeof *c);
}

bool
bake_frame_is_local(const struct bake_mesh *m)
{
	const double far = 8192.0 * (double)m->ntriangles;
	double corners = 0.0, uvs = 0.0, triangles = 0.0;

	for (size_t i = 0; i < m->ntriangles; i++) {
		const struct bake_corner *t = m->triangles[i];

		corners += abs(t[0].v - t[1].v);
		uvs += abs(t[0].vt - t[1].vt);
		if (i > 0)
			triangles += abs(t[0].v - m->triangles[i - 1][0].v);
	}
	return corners < far && uvs < far && triangles < far;
}

/* -- back ---------------------------------------------------------------- */

/* A frame of the copy and the vt it has in the file. */
struct former {
	int vt, frame;
};

static int
by_vt(const void *pa, const void *pb)
{
	const struct former *a = pa, *b = pb;

	return (a->vt > b->vt) - (a->vt < b->vt);
}

/* place[i]: where the copy's frame i goes, and its v and vt those of the file;
 * source: the reverse. start: [npositions + 1] zeros, former: scratch,
 * [nframes]. */
static void
find_places(const struct frame_copy *c, struct bake_frames *from, int *place,
    int *source, int *start, struct former *former)
{
	struct bake_frame *f = from->frame;

	for (size_t i = 0; i < from->nframes; i++) {
		f[i].v = c->position[f[i].v];
		f[i].vt = f[i].vt < 0 ? -1 : c->uv[f[i].vt];
		start[f[i].v + 1]++;
	}
	for (size_t v = 0; v < c->mesh.npositions; v++)
		start[v + 1] += start[v];
	for (size_t i = 0, n; i < from->nframes; i += n) {
		for (n = 0; i + n < from->nframes && f[i + n].v == f[i].v; n++)
			former[n] =
			    (struct former){ f[i + n].vt, (int)(i + n) };
		if (n > 1)
			qsort(former, n, sizeof *former, by_vt);
		for (size_t k = 0; k < n; k++) {
			int to = start[f[i].v] + (int)k;

			place[former[k].frame] = to;
			source[to] = former[k].frame;
		}
	}
}

enum bake_status
bake_frame_put_back(const struct frame_copy *c, struct bake_frames *from,
    struct bake_frames *to, struct bake_err *err)
{
	size_t n = from->nframes;
	int *place = bake_alloc(n, sizeof *place, err);
	int *source = bake_alloc(n, sizeof *source, err);
	int *triangle = bake_alloc(from->ntriangles, sizeof *triangle, err);
	int *start = bake_zalloc(c->mesh.npositions + 1, sizeof *start, err);
	struct former *former = bake_alloc(n, sizeof *former, err);
	enum bake_status rc = BAKE_ENOMEM;

	*to = *from;
	to->frame = bake_alloc(n, sizeof *to->frame, err);
	to->frame_of = bake_alloc(from->ntriangles, sizeof *to->frame_of, err);
	if (place == NULL || source == NULL || triangle == NULL ||
	    start == NULL || former == NULL || to->frame == NULL ||
	    to->frame_of == NULL)
		goto out;
	find_places(c, from, place, source, start, former);
	for (size_t i = 0; i < n; i++)
		to->frame[i] = from->frame[source[i]];
	for (size_t i = 0; i < from->ntriangles; i++)
		triangle[c->triangle[i]] = (int)i;
	for (size_t i = 0; i < from->ntriangles; i++)
		for (int k = 0; k < 3; k++)
			to->frame_of[i][k] =
			    place[from->frame_of[triangle[i]][k]];
	rc = BAKE_OK;
out:
	free(place);
	free(source);
	free(triangle);
	free(start);
	free(former);
	return rc;
}
