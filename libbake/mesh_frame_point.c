/* Sums around the points of a mesh, in an order of their values. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_frame_priv.h"

#define PI 3.14159265358979323846

/* While frames are made: file normals or tangents that differ. */
enum { MIXED_NORMALS = 1 << 16, MIXED_TANGENTS = 1 << 17 };

/* -- vectors ------------------------------------------------------------- */

static double
dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void
cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static void
add_scaled(double sum[3], double w, const double x[3])
{
	for (int k = 0; k < 3; k++)
		sum[k] += w * x[k];
}

static double
larger(double a, double b)
{
	return a > b ? a : b;
}

/* To unit length; false, x as it was, where it has no direction. */
static bool
normalize(double x[3])
{
	double scale, length;

	scale = dot(x, x);
	if (scale > 1e-200 && scale < 1e200) {
		/* the usual case: neither under- nor overflow */
		length = sqrt(scale);
		for (int k = 0; k < 3; k++)
			x[k] /= length;
		return true;
	}
	scale = larger(fabs(x[0]), larger(fabs(x[1]), fabs(x[2])));
	if (!(scale > 0.0) || !isfinite(scale))
		return false;
	for (int k = 0; k < 3; k++)
		x[k] /= scale;
	length = sqrt(dot(x, x));
	for (int k = 0; k < 3; k++)
		x[k] /= length;
	return true;
}

/* atan(t) for 0 <= t <= 1: the angle is halved twice, so that t <= tan(pi/16)
 * and 12 terms leave 0.199^24 / 25 < 1e-18 of it. Even and odd powers are
 * summed apart, which halves the wait. */
static inline double
atan_unit(double t)
{
	double x, xx, even, odd;

	t = t / (1.0 + sqrt(1.0 + t * t));
	t = t / (1.0 + sqrt(1.0 + t * t));
	x = t * t;
	xx = x * x;
	even = 1.0 / 21.0 + xx * (1.0 / 25.0);
	odd = 1.0 / 19.0 + xx * (1.0 / 23.0);
	even = 1.0 / 17.0 + xx * even;
	odd = 1.0 / 15.0 + xx * odd;
	even = 1.0 / 13.0 + xx * even;
	odd = 1.0 / 11.0 + xx * odd;
	even = 1.0 / 9.0 + xx * even;
	odd = 1.0 / 7.0 + xx * odd;
	even = 1.0 / 5.0 + xx * even;
	odd = 1.0 / 3.0 + xx * odd;
	return 4.0 * (t + t * (xx * even - x * odd));
}

/* 2 atan(y / x) for y, x >= 0, not both 0. */
static double
twice_atan(double y, double x)
{
	return y <= x ? 2.0 * atan_unit(y / x) : PI - 2.0 * atan_unit(x / y);
}

double
bake_angle_rad(const double u[3], const double v[3])
{
	double a[3] = { u[0], u[1], u[2] }, b[3] = { v[0], v[1], v[2] };
	double d = 0.0, s = 0.0;

	if (!normalize(a) || !normalize(b))
		return 0.0;
	for (int k = 0; k < 3; k++) {
		d += (a[k] - b[k]) * (a[k] - b[k]);
		s += (a[k] + b[k]) * (a[k] + b[k]);
	}
	return twice_atan(sqrt(d), sqrt(s));
}

/* -- order --------------------------------------------------------------- */

static int
compare_values(const double *a, const double *b, int n)
{
	for (int k = 0; k < n; k++)
		if (a[k] != b[k])
			return a[k] < b[k] ? -1 : 1;
	return 0;
}

static int
compare_file(const double *a, const double *b, int n)
{
	if (a == NULL || b == NULL)
		return (a != NULL) - (b != NULL);
	return compare_values(a, b, n);
}

/* By everything that enters a sum, so that the order of equal ones does not
 * matter. */
static int
compare_items(const struct frame_item *a, const struct frame_item *b)
{
	int c = compare_values(a->wn, b->wn, 3);

	if (c == 0)
		c = compare_values(&a->angle, &b->angle, 1);
	if (c == 0)
		c = compare_values(a->ps, b->ps, 3);
	if (c == 0)
		c = compare_values(a->pt, b->pt, 3);
	if (c == 0)
		c = compare_file(a->normal, b->normal, 3);
	if (c == 0)
		c = compare_file(a->tangent, b->tangent, 4);
	return c;
}

static int
compare_uv(const struct frame_item *a, const struct frame_item *b)
{
	if (a->has_uv != b->has_uv)
		return a->has_uv - b->has_uv;
	return compare_values(a->uv, b->uv, 2);
}

static int
by_value(const void *a, const void *b)
{
	return compare_items(
	    *(struct frame_item *const *)a, *(struct frame_item *const *)b);
}

static int
by_uv(const void *a, const void *b)
{
	const struct frame_item *x = *(struct frame_item *const *)a;
	const struct frame_item *y = *(struct frame_item *const *)b;
	int c = compare_uv(x, y);

	return c != 0 ? c : compare_items(x, y);
}

static void
sort_items(struct frame_item **items, int n,
    int (*compare)(const void *, const void *))
{
	enum { FEW = 24 };

	if (n > FEW) {
		qsort(items, (size_t)n, sizeof *items, compare);
		return;
	}
	for (int i = 1; i < n; i++) {
		struct frame_item *it = items[i];
		int k = i;

		for (; k > 0 && compare(&items[k - 1], &it) > 0; k--)
			items[k] = items[k - 1];
		items[k] = it;
	}
}

/* -- one corner ---------------------------------------------------------- */

static const double *
position_of(const struct frame_job *job, const struct bake_corner *c)
{
	int p = job->weld != NULL ? job->weld->first[c->v] : c->v;

	return job->mesh->positions[p];
}

/* What n = e x f is multiplied by. */
static double
normal_weight(enum bake_normal_weight weight, const struct frame_item *it)
{
	switch (weight) {
	case BAKE_WEIGHT_AREA:
		return 1.0;
	case BAKE_WEIGHT_SPHERE:
		return 1.0 / (it->ee * it->ff);
	default:
		return it->angle / it->area;
	}
}

/* Angles from the tangents of their halves; negative ones are those of the
 * angles that are left to pi. */
static void
to_angles(double *t, int n)
{
	for (int i = 0; i < n; i++) {
		double angle = 2.0 * atan_unit(fabs(t[i]));

		t[i] = t[i] < 0.0 ? PI - angle : angle;
	}
}

/* dP/ds and dP/dt from the edges that leave the corner. */
static void
gradients(struct frame_item *it, const double e[3], const double f[3],
    const double *uv, const double *uv_next, const double *uv_prev)
{
	double es = uv_next[0] - uv[0], et = uv_next[1] - uv[1];
	double fs = uv_prev[0] - uv[0], ft = uv_prev[1] - uv[1];
	double det = es * ft - fs * et;
	double size = (es * es + et * et) * (fs * fs + ft * ft);
	double scale = 1.0 / det;

	if (!(det * det > FLAT * FLAT * size) || !isfinite(size))
		return;
	for (int k = 0; k < 3; k++) {
		it->ps[k] = (e[k] * ft - f[k] * et) * scale;
		it->pt[k] = (f[k] * es - e[k] * fs) * scale;
	}
	if (isfinite(dot(it->ps, it->ps) + dot(it->pt, it->pt))) {
		it->side = det > 0.0 ? 1 : -1;
		return;
	}
	memset(it->ps, 0, sizeof it->ps);
	memset(it->pt, 0, sizeof it->pt);
}

/* What the file says of a corner. */
static void
take_file_item(const struct bake_mesh *m, const struct bake_corner *c,
    struct frame_item *it)
{
	if (c->vn >= 0) {
		const double *fn = m->normals[c->vn];

		if (dot(fn, fn) > 0.0)
			it->normal = fn;
		if (m->tangents != NULL && m->tangents[c->vn][3] != 0.0)
			it->tangent = m->tangents[c->vn];
	}
	it->has_uv = c->vt >= 0;
	if (it->has_uv) {
		it->uv[0] = m->uvs[c->vt][0];
		it->uv[1] = m->uvs[c->vt][1];
	}
}

/* All of a corner but its angle. Returns the tangent of half the angle, for
 * to_angles. wn is not weighted yet. */
static double
make_item(const struct frame_job *job, int corner, struct frame_item *it)
{
	const struct bake_mesh *m = job->mesh;
	int triangle = corner / 3, k0 = corner - 3 * triangle;
	const struct bake_corner *t = m->triangles[triangle], *c = &t[k0];
	const struct bake_corner *next = &t[k0 == 2 ? 0 : k0 + 1];
	const struct bake_corner *prev = &t[k0 == 0 ? 2 : k0 - 1];
	const double *p = position_of(job, c), *pn = position_of(job, next),
		     *pp = position_of(job, prev);
	double e[3], f[3], ef, longest, area2;

	it->angle = it->area = 0.0;
	it->uv[0] = it->uv[1] = 0.0;
	memset(it->ps, 0, sizeof it->ps);
	memset(it->pt, 0, sizeof it->pt);
	it->side = 0;
	it->normal = it->tangent = NULL;
	it->frame = &job->frames->frame[job->frames->frame_of[triangle][k0]];
	take_file_item(m, c, it);
	for (int k = 0; k < 3; k++) {
		e[k] = pn[k] - p[k];
		f[k] = pp[k] - p[k];
	}
	cross(e, f, it->wn);
	area2 = dot(it->wn, it->wn);
	it->ee = dot(e, e);
	it->ff = dot(f, f);
	ef = dot(e, f);
	longest = larger(it->ee + it->ff - 2.0 * ef, larger(it->ee, it->ff));
	/* false for what is not finite, too */
	if (!(area2 > FLAT * FLAT * longest * longest &&
		area2 < (double)INFINITY)) {
		memset(it->wn, 0, sizeof it->wn);
		return 0.0;
	}
	it->area = sqrt(area2);
	if (it->has_uv && next->vt >= 0 && prev->vt >= 0)
		gradients(it, e, f, it->uv, m->uvs[next->vt], m->uvs[prev->vt]);
	/* tan(angle / 2) = sin / (1 + cos), of the acute angle; ee ff is no
	 * smaller than area2, which has not underflowed */
	return it->area / (ef < 0.0 ? ef - sqrt(it->ee * it->ff)
				    : ef + sqrt(it->ee * it->ff));
}

/* -- one point ----------------------------------------------------------- */

/* The file's vectors of a frame: as they are where all its corners have the
 * same, else their mean by angles. Not yet of unit length then. */
static void
take_file_vectors(
    const struct frame_job *job, struct frame_item *const *items, int n)
{
	bool tangents = job->params->tangents == BAKE_TANGENTS_FILE;
	bool normals = job->params->normals != BAKE_NORMALS_COMPUTED;

	for (int i = 0; i < n; i++) {
		struct bake_frame *f = items[i]->frame;
		const double *fn = items[i]->normal, *ft = items[i]->tangent;

		if (normals && fn != NULL &&
		    !(f->flags & BAKE_FRAME_NORMAL_FILE)) {
			memcpy(f->normal, fn, sizeof f->normal);
			f->flags |= BAKE_FRAME_NORMAL_FILE;
		} else if (normals && fn != NULL &&
			   compare_values(f->normal, fn, 3) != 0) {
			f->flags |= MIXED_NORMALS;
		}
		if (tangents && ft != NULL &&
		    !(f->flags & BAKE_FRAME_TANGENT_FILE)) {
			memcpy(f->tangent, ft, sizeof f->tangent);
			f->hand = ft[3] < 0.0 ? -1 : 1;
			f->flags |= BAKE_FRAME_TANGENT_FILE;
		} else if (tangents && ft != NULL &&
			   compare_values(f->tangent, ft, 3) != 0) {
			f->flags |= MIXED_TANGENTS;
		}
	}
}

static void
mix_file_vectors(struct frame_item *const *items, int n)
{
	for (int pass = 0; pass < 2; pass++)
		for (int i = 0; i < n; i++) {
			struct bake_frame *f = items[i]->frame;
			const struct frame_item *it = items[i];

			if (it->normal != NULL && f->flags & MIXED_NORMALS) {
				if (pass == 0)
					memset(f->normal, 0, sizeof f->normal);
				else
					add_scaled(
					    f->normal, it->angle, it->normal);
			}
			if (it->tangent != NULL && f->flags & MIXED_TANGENTS) {
				if (pass == 0)
					memset(
					    f->tangent, 0, sizeof f->tangent);
				else
					add_scaled(
					    f->tangent, it->angle, it->tangent);
			}
		}
}

/* Items of one UV: their mean gradients, into all their frames. */
static void
take_gradients(struct frame_item *const *items, int n)
{
	double weight[2] = { 0.0, 0.0 }, ps[3] = { 0.0 }, pt[3] = { 0.0 };
	int side, flags = 0;

	for (int i = 0; i < n; i++)
		if (items[i]->side != 0)
			weight[items[i]->side < 0] += items[i]->angle;
	side = weight[1] > weight[0] ? -1 : 1;
	for (int i = 0; i < n; i++) {
		if (items[i]->side != side)
			continue;
		add_scaled(ps, items[i]->angle, items[i]->ps);
		add_scaled(pt, items[i]->angle, items[i]->pt);
	}
	if (weight[0] > 0.0 && weight[1] > 0.0)
		flags |= BAKE_FRAME_MIRROR_MIXED;
	for (int i = 0; i < n; i++) {
		struct bake_frame *f = items[i]->frame;

		f->flags |= flags;
		if (!(f->flags & BAKE_FRAME_TANGENT_FILE))
			f->hand = side;
		for (int k = 0; k < 3; k++) {
			/* stays 0 where there is no weight */
			double w = weight[side < 0];

			f->ps[k] = w > 0.0 ? ps[k] / w : 0.0;
			f->pt[k] = w > 0.0 ? pt[k] / w : 0.0;
		}
	}
}

void
bake_frame_point(
    const struct frame_job *job, int p, const struct frame_bench *bench)
{
	const struct bake_adjacency *adj = job->adj;
	int n = adj->start[p + 1] - adj->start[p];
	struct frame_item **order = bench->order;
	double *normal = job->point_normal[p];
	bool one_uv = true;
	int mixed = 0;

	memset(normal, 0, sizeof job->point_normal[p]);
	for (int i = 0; i < n; i++) {
		order[i] = &bench->items[i];
		bench->angle[i] =
		    make_item(job, adj->corner[adj->start[p] + i], order[i]);
		one_uv = one_uv && compare_uv(order[i], order[0]) == 0;
	}
	to_angles(bench->angle, n);
	for (int i = 0; i < n; i++) {
		struct frame_item *it = order[i];
		double w;

		if (it->area == 0.0)
			continue;
		it->angle = bench->angle[i];
		w = normal_weight(job->params->weight, it);
		for (int k = 0; k < 3; k++)
			it->wn[k] *= w;
	}
	sort_items(order, n, by_value);
	for (int i = 0; i < n; i++)
		add_scaled(normal, 1.0, order[i]->wn);
	normalize(normal);
	take_file_vectors(job, order, n);
	for (int i = 0; i < n; i++)
		mixed |= order[i]->frame->flags;
	if (mixed & (MIXED_NORMALS | MIXED_TANGENTS))
		mix_file_vectors(order, n);
	if (!one_uv)
		sort_items(order, n, by_uv);
	for (int i = 0, end; i < n; i = end) {
		for (end = i + 1;
		     end < n && compare_uv(order[i], order[end]) == 0; end++)
			;
		take_gradients(order + i, end - i);
	}
}

/* -- one frame ----------------------------------------------------------- */

static bool
make_orthogonal(double x[3], const double normal[3])
{
	double size = sqrt(dot(x, x)), along = dot(x, normal);

	add_scaled(x, -along, normal);
	return sqrt(dot(x, x)) > 1e-9 * size && normalize(x);
}

/* Any direction in the plane: of the axis that is farthest from the normal. */
static void
any_tangent(struct bake_frame *f)
{
	int k = 0;

	for (int i = 1; i < 3; i++)
		if (fabs(f->normal[i]) < fabs(f->normal[k]))
			k = i;
	memset(f->tangent, 0, sizeof f->tangent);
	f->tangent[k] = 1.0;
	make_orthogonal(f->tangent, f->normal);
	f->hand = 1;
	f->flags &= ~BAKE_FRAME_TANGENT_FILE;
	f->flags |= BAKE_FRAME_TANGENT_NONE;
	memcpy(f->ps, f->tangent, sizeof f->ps);
	cross(f->normal, f->tangent, f->pt);
}

void
bake_frame_finish(const struct frame_job *job, struct bake_frame *f)
{
	int p = job->weld != NULL ? job->weld->first[f->v] : f->v;
	double b[3], side;
	bool has_gradients = dot(f->ps, f->ps) > 0.0;

	if (!(f->flags & BAKE_FRAME_NORMAL_FILE) || !normalize(f->normal)) {
		f->flags &= ~BAKE_FRAME_NORMAL_FILE;
		memcpy(f->normal, job->point_normal[p], sizeof f->normal);
	}
	if (!(dot(f->normal, f->normal) > 0.0)) {
		f->flags |= BAKE_FRAME_NORMAL_NONE;
		f->normal[0] = f->normal[1] = 0.0;
		f->normal[2] = 1.0;
	}
	f->flags &= ~(MIXED_NORMALS | MIXED_TANGENTS);
	if (f->flags & BAKE_FRAME_TANGENT_FILE &&
	    make_orthogonal(f->tangent, f->normal)) {
		if (has_gradients)
			return;
		/* a direction, but no length */
		memcpy(f->ps, f->tangent, sizeof f->ps);
		cross(f->normal, f->tangent, f->pt);
		for (int k = 0; k < 3; k++)
			f->pt[k] *= f->hand;
		return;
	}
	f->flags &= ~BAKE_FRAME_TANGENT_FILE;
	memcpy(f->tangent, f->ps, sizeof f->tangent);
	if (!has_gradients || !make_orthogonal(f->tangent, f->normal)) {
		any_tangent(f);
		return;
	}
	cross(f->normal, f->tangent, b);
	side = dot(b, f->pt);
	if (side != 0.0)
		f->hand = side < 0.0 ? -1 : 1;
}
