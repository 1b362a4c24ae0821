/* Sums around the points of a mesh, in an order of their values. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_frame_priv.h"

/* -- corners ------------------------------------------------------------- */

static const unsigned next_of[3] = { 1, 2, 0 }, prev_of[3] = { 2, 0, 1 };

/* The three corners of a file's triangle, from the given one on. */
struct turned {
	const struct bake_corner *c[3];
	bool has_uvs;
};

static struct turned
corners_of_file(const struct frame_job *job, unsigned corner)
{
	unsigned first = job->pts->triangle[corner / 4].corner;
	const struct bake_corner *t = job->mesh->triangles[first / 4];
	unsigned k = (first % 4 + corner % 4) % 3;

	return (struct turned){ { &t[k], &t[next_of[k]], &t[prev_of[k]] },
		t[0].vt >= 0 && t[1].vt >= 0 && t[2].vt >= 0 };
}

/* UV edges of a corner one of whose UVs its point alone does not give. */
static void
take_uv_edges(
    const struct frame_job *job, unsigned corner, struct frame_batch *b, int l)
{
	const double(*uvs)[2] = (const double(*)[2])job->mesh->uvs;
	struct turned t = corners_of_file(job, corner);

	for (int k = 0; k < 2; k++) {
		b->uv_e[k][l] =
		    t.has_uvs ? uvs[t.c[1]->vt][k] - uvs[t.c[0]->vt][k] : 0.0;
		b->uv_f[k][l] =
		    t.has_uvs ? uvs[t.c[2]->vt][k] - uvs[t.c[0]->vt][k] : 0.0;
	}
}

/* A corner, into lane l: its edges. */
static inline void
take_edges(
    const struct frame_job *job, unsigned corner, struct frame_batch *b, int l)
{
	const struct bake_points *pts = job->pts;
	const struct bake_point_triangle *t = &pts->triangle[corner / 4];
	unsigned k0 = corner % 4;
	unsigned p0 = t->p[k0], p1 = t->p[next_of[k0]], p2 = t->p[prev_of[k0]];
	const double *p = pts->point[p0].p, *uv = pts->uv[p0];
	const double *next = pts->point[p1].p, *uv_next = pts->uv[p1];
	const double *prev = pts->point[p2].p, *uv_prev = pts->uv[p2];
	double sum = 0.0;

	for (int k = 0; k < 3; k++) {
		b->e[k][l] = next[k] - p[k];
		b->f[k][l] = prev[k] - p[k];
	}
	for (int k = 0; k < 2; k++) {
		double e = uv_next[k] - uv[k], f = uv_prev[k] - uv[k];

		b->uv_e[k][l] = e;
		b->uv_f[k][l] = f;
		sum += e + f;
	}
	/* of a point without a UV of its own it is NaN */
	if (isnan(sum))
		take_uv_edges(job, corner, b, l);
}

/* n corners, n at most a batch. */
static void
take_corners(const struct frame_job *job, const unsigned *corner, int n,
    struct frame_bench *bench)
{
	struct frame_batch *b = bench->batch;

	for (int l = 0; l < n; l++)
		take_edges(job, corner[l], b, l);
	job->corners(b, n);
	/* each triangle at its corner 0 in the file */
	for (int l = 0; l < n; l++) {
		unsigned first;

		if (b->flat_uv[l] == 0.0)
			continue;
		first = job->pts->triangle[corner[l] / 4].corner;
		if ((first % 4 + corner[l] % 4) % 3 == 0 &&
		    corners_of_file(job, corner[l]).has_uvs)
			bench->flat_uvs++;
	}
}

/* What the file says of a corner. */
static void
take_file_item(const struct bake_mesh *m, const struct bake_corner *c,
    struct frame_item *it)
{
	it->normal = it->tangent = NULL;
	if (c->vn >= 0) {
		const double *fn = m->normals[c->vn];

		if (frame_dot(fn, fn) > 0.0)
			it->normal = fn;
		if (m->tangents != NULL && m->tangents[c->vn][3] != 0.0)
			it->tangent = m->tangents[c->vn];
	}
	it->has_uv = c->vt >= 0;
	it->uv = it->has_uv ? m->uvs[c->vt] : NULL;
}

/* Lane l as an item. */
static void
make_item(const struct frame_job *job, unsigned corner,
    const struct frame_batch *b, int l, struct frame_item *it)
{
	const struct bake_mesh *m = job->mesh;
	const struct bake_point_triangle *p = &job->pts->triangle[corner / 4];
	const struct turned t = corners_of_file(job, corner);
	unsigned k0 = corner % 4, triangle = p->corner / 4;
	ptrdiff_t in_file = t.c[0] - m->triangles[triangle];

	take_file_item(m, t.c[0], it);
	it->frame =
	    &job->frames->frame[job->frames->frame_of[triangle][in_file]];
	it->next = (int)p->p[next_of[k0]];
	it->prev = (int)p->p[prev_of[k0]];
	it->uv_next = t.has_uvs ? m->uvs[t.c[1]->vt] : NULL;
	it->uv_prev = t.has_uvs ? m->uvs[t.c[2]->vt] : NULL;
	for (int k = 0; k < 3; k++) {
		it->wn[k] = b->wn[k][l];
		it->ps[k] = b->ps[k][l];
		it->pt[k] = b->pt[k][l];
	}
	it->angle = b->angle[l];
	it->side = (int)b->side[l];
}

/* -- the usual point ------------------------------------------------------ */

enum { FEW = 8 };

/*
 * The order of up to FEW values, which differ: without branches, for which is
 * the larger cannot be foretold, and that takes as long as all else. False
 * where two are equal. x must be readable up to FEW, whatever is there.
 */
static inline bool
rank(const double *x, int n, unsigned char order[FEW])
{
	long long place[FEW] = { 0 };
	unsigned places = 0;

	for (int k = 0; k < n; k++)
		for (int i = 0; i < FEW; i++)
			place[i] += x[k] < x[i];
	for (int i = 0; i < n; i++) {
		order[place[i]] = (unsigned char)i;
		places |= 1u << place[i];
	}
	return places == (1u << n) - 1;
}

/* The one vector of the file that all corners have, or NULL; false where they
 * have several. */
static bool
find_file_vectors(const struct frame_job *job, const unsigned *corner, int n,
    struct frame_item *it)
{
	const struct bake_corner *first = corners_of_file(job, corner[0]).c[0];

	for (int i = 1; i < n; i++)
		if (corners_of_file(job, corner[i]).c[0]->vn != first->vn)
			return false;
	take_file_item(job->mesh, first, it);
	return true;
}

/* bake_frame_items() for corners of one frame whose order their normals' first
 * components give, from lane l on; false where it is not so. */
static bool
do_plain(const struct frame_job *job, const unsigned *corner, int n,
    const struct frame_batch *b, int l, struct bake_frame *f, double normal[3])
{
	unsigned char order[FEW];
	double weight[2] = { 0.0, 0.0 }, ps[3] = { 0.0 }, pt[3] = { 0.0 };
	double w, unit = 1.0 / job->pts->scale;
	int side;

	if (!rank(&b->wn[0][l], n, order))
		return false;
	if (job->has_file_vectors && n > 0) {
		struct frame_item it;
		struct frame_item *items = &it;

		if (!find_file_vectors(job, corner, n, &it))
			return false;
		it.frame = f;
		bake_frame_take_file(job, &items, 1);
	}
	memset(normal, 0, 3 * sizeof *normal);
	for (int i = 0; i < n; i++) {
		int k = l + order[i];

		for (int c = 0; c < 3; c++)
			normal[c] += b->wn[c][k];
		/* either, or none */
		weight[0] += b->side[k] > 0.0 ? b->angle[k] : 0.0;
		weight[1] += b->side[k] < 0.0 ? b->angle[k] : 0.0;
	}
	bake_frame_normalize(normal);
	side = weight[1] > weight[0] ? -1 : 1;
	for (int i = 0; i < n; i++) {
		int k = l + order[i];
		double angle = b->side[k] == side ? b->angle[k] : 0.0;

		for (int c = 0; c < 3; c++) {
			ps[c] += angle * b->ps[c][k];
			pt[c] += angle * b->pt[c][k];
		}
	}
	if (weight[0] > 0.0 && weight[1] > 0.0)
		f->flags |= BAKE_FRAME_MIRROR_MIXED;
	if (!(f->flags & BAKE_FRAME_TANGENT_FILE))
		f->hand = side;
	w = weight[side < 0];
	for (int c = 0; c < 3 && w > 0.0; c++) {
		f->ps[c] = ps[c] / w * unit;
		f->pt[c] = pt[c] / w * unit;
	}
	return true;
}

/* -- points ---------------------------------------------------------------- */

static void
count_flags(struct frame_bench *bench, int flags)
{
	bench->normal_none += (flags & BAKE_FRAME_NORMAL_NONE) != 0;
	bench->tangent_none += (flags & BAKE_FRAME_TANGENT_NONE) != 0;
	bench->mirror_mixed += (flags & BAKE_FRAME_MIRROR_MIXED) != 0;
}

/* By its members: compilers clear a whole struct of this size by an
 * instruction that waits for all stores before it, here to far memory. */
static inline void
clear(struct bake_frame *f, const struct bake_site *site)
{
	f->v = site->v;
	f->vt = site->vt;
	f->flags = 0;
	f->hand = 1;
	for (int k = 0; k < 3; k++)
		f->normal[k] = f->tangent[k] = f->ps[k] = f->pt[k] = 0.0;
}

/* Point p, whose corners begin at lane l of the batch, or which has more of
 * them than a batch. */
static void
do_point(
    const struct frame_job *job, size_t p, int l, struct frame_bench *bench)
{
	const struct bake_points *pts = job->pts;
	const unsigned *corner = pts->corner + pts->first[p];
	int n = (int)(pts->first[p + 1] - pts->first[p]);
	const struct bake_site *site = pts->site + pts->first_site[p];
	int nsites = pts->first_site[p + 1] - pts->first_site[p];
	struct bake_frame *frames = job->frames->frame;
	double normal[3];

	if (nsites == 1 && n <= FEW) {
		/* complete before it goes to where memory is slow */
		struct bake_frame f;

		clear(&f, site);
		if (do_plain(job, corner, n, bench->batch, l, &f, normal)) {
			bake_frame_finish(&f, normal);
			count_flags(bench, f.flags);
			frames[site->frame] = f;
			return;
		}
	}
	for (int i = 0; i < nsites; i++)
		clear(&frames[site[i].frame], &site[i]);
	for (int i = 0; i < n; i++) {
		int at = i % BAKE_FRAME_BATCH, rest = n - i;

		if (n > BAKE_FRAME_BATCH && at == 0)
			take_corners(job, corner + i,
			    rest < BAKE_FRAME_BATCH ? rest : BAKE_FRAME_BATCH,
			    bench);
		make_item(job, corner[i], bench->batch,
		    n > BAKE_FRAME_BATCH ? at : l + i, &bench->items[i]);
	}
	bake_frame_items(job, n, bench, normal);
	for (int i = 0; i < nsites; i++) {
		bake_frame_finish(&frames[site[i].frame], normal);
		count_flags(bench, frames[site[i].frame].flags);
	}
}

/* What points a little later need and what lies in the file's order. */
static void
fetch_ahead(const struct frame_job *job, size_t first, size_t last)
{
	const struct bake_points *pts = job->pts;

	for (int i = pts->first_site[first]; i < pts->first_site[last]; i++) {
		const char *f =
		    (const char *)&job->frames->frame[pts->site[i].frame];

		__builtin_prefetch(f, 1);
		__builtin_prefetch(f + 64, 1);
		__builtin_prefetch(f + sizeof(struct bake_frame) - 1, 1);
	}
}

void
bake_frame_points(const struct frame_job *job, size_t first, size_t end,
    struct frame_bench *bench)
{
	const unsigned *start = job->pts->first;

	while (first < end) {
		size_t last = first + 1, ahead;
		int n;

		/* whole points, as many as there is room for */
		while (last < end &&
		       start[last + 1] - start[first] <= BAKE_FRAME_BATCH)
			last++;
		ahead = last + (last - first);
		fetch_ahead(job, last, ahead < end ? ahead : end);
		n = (int)(start[last] - start[first]);
		if (n <= BAKE_FRAME_BATCH)
			take_corners(
			    job, job->pts->corner + start[first], n, bench);
		for (size_t p = first; p < last; p++)
			do_point(job, p, (int)(start[p] - start[first]), bench);
		first = last;
	}
}
