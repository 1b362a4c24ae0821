/* Quadrics that osculate a mesh at its vertices: neighbours, lanes, results. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "quadric_priv.h"

enum { LANES = BAKE_QUADRIC_LANES };

/* -- neighbours ----------------------------------------------------------- */

/* Append the neighbours of p that are not in the list, which ends at end; of
 * very many, an even choice. Returns the list's new end. This is a third of all
 * time: without a branch, for which of the points are new cannot be foretold.
 */
static inline unsigned *
append_around(struct bake_quadric_bench *w, const struct bake_points *pts,
    unsigned p, unsigned *end)
{
	const unsigned *around = pts->room + pts->point[p].start;
	const unsigned *stop = pts->room + pts->point[p + 1].start;
	size_t count = (size_t)(stop - around);
	unsigned now = w->gathering, *seen = w->seen;

	if (count > BAKE_QUADRIC_VALENCE_MAX) {
		for (size_t k = 0; k < BAKE_QUADRIC_VALENCE_MAX; k++) {
			unsigned q =
			    around[k * count / BAKE_QUADRIC_VALENCE_MAX];

			*end = q;
			end += seen[q] != now;
			seen[q] = now;
		}
		return end;
	}
	for (; around < stop; around++) {
		unsigned q = *around;

		*end = q;
		end += seen[q] != now;
		seen[q] = now;
	}
	return end;
}

/* List the points within ring edges of p, but p; returns how many. */
static int
gather(struct bake_quadric_bench *w, const struct bake_points *pts, int p,
    int ring)
{
	unsigned *begin = w->list, *end;

	w->gathering++;
	w->seen[p] = w->gathering;
	end = append_around(w, pts, (unsigned)p, begin);
	for (int r = 1; r < ring; r++) {
		unsigned *last = end;

		for (; begin < last; begin++) {
			if (end - w->list >= BAKE_QUADRIC_NEIGHBOURS_MAX)
				return (int)(end - w->list);
			end = append_around(w, pts, *begin, end);
		}
	}
	return (int)(end - w->list);
}

/* Put the listed neighbours of p into a lane, its rows from n to rows 0. */
static void
fill_lane(struct bake_quadric_bench *w, const struct bake_points *pts, int p,
    int lane, int n, int rows)
{
	double *x = w->batch->x + lane, *y = w->batch->y + lane;
	double *z = w->batch->z + lane;
	const double *o = pts->point[p].p;
	double ox = o[0], oy = o[1], oz = o[2];

	for (int k = 0; k < n; k++) {
		const double *q = pts->point[w->list[k]].p;

		x[k * LANES] = q[0] - ox;
		y[k * LANES] = q[1] - oy;
		z[k * LANES] = q[2] - oz;
	}
	for (int k = n; k < rows; k++)
		x[k * LANES] = y[k * LANES] = z[k * LANES] = 0;
}

static void
fill_frame(struct bake_quadric_batch *b, const struct bake_frame *f, int lane)
{
	const double *n = f->normal, *t = f->tangent;
	double hand = f->hand < 0 ? -1 : 1;

	for (int c = 0; c < 3; c++) {
		int c1 = (c + 1) % 3, c2 = (c + 2) % 3;

		b->frame[c][lane] = t[c];
		b->frame[3 + c][lane] = hand * (n[c1] * t[c2] - n[c2] * t[c1]);
		b->frame[6 + c][lane] = -n[c];
	}
}

/* -- results --------------------------------------------------------------- */

/* Whether a lane holds a fit; comparisons with NaN are false. */
static bool
is_determined(const struct bake_quadric_batch *b, int lane)
{
	return b->pivot[lane] >= BAKE_QUADRIC_PIVOT_MIN &&
	       isfinite(b->a[lane] + b->b[lane] + b->c[lane]) &&
	       isfinite(b->residual2[lane]);
}

/* A coefficient in mesh units: 0 where the height that it stands for is below
 * the rounding of the coordinates. + 0 makes -0 0. */
static double
coefficient(double value, double radius2, double floor, double scale)
{
	return fabs(value) * radius2 < floor ? 0 : value * scale + 0.0;
}

/* fmax() is a call */
static inline double
larger(double a, double b)
{
	return a > b ? a : b;
}

/* Take a lane's fit to n neighbours. */
static void
take(const struct bake_quadric_job *job, const struct bake_quadric_batch *b,
    int lane, int p, int n, struct bake_quadric *q)
{
	const double *o = job->pts.point[p].p;
	double scale = job->pts.scale, radius2 = b->radius2[lane] / n;
	double floor = 0x1p-47 * larger(larger(fabs(o[0]), fabs(o[1])),
				     larger(fabs(o[2]), sqrt(radius2)));

	q->a = coefficient(b->a[lane], radius2, floor, scale);
	q->b = coefficient(b->b[lane], radius2, floor, scale);
	q->c = coefficient(b->c[lane], radius2, floor, scale);
	q->residual = sqrt(b->residual2[lane] / n) / scale;
	q->neighbours = n;
}

/* The sign, and the values in texture space. */
static void
finish(const struct bake_quadric_job *job, const struct bake_frame *f,
    struct bake_quadric *q)
{
	const struct bake_quadric_params *p = job->params;
	double hand = f->hand < 0 ? -1 : 1, s = 0, t = 0, depth;
	double js[2] = { 0, 0 }, jt[2] = { 0, 0 };

	if (p->sign == BAKE_QUADRIC_OUTWARD) {
		q->a = 0 - q->a;
		q->b = 0 - q->b;
		q->c = 0 - q->c;
	}
	for (int c = 0; c < 3; c++) {
		const double *n = f->normal, *u = f->tangent;
		int c1 = (c + 1) % 3, c2 = (c + 2) % 3;
		double b = hand * (n[c1] * u[c2] - n[c2] * u[c1]);

		js[0] += f->ps[c] * u[c];
		js[1] += f->ps[c] * b;
		jt[0] += f->pt[c] * u[c];
		jt[1] += f->pt[c] * b;
		s += f->ps[c] * f->ps[c];
		t += f->pt[c] * f->pt[c];
	}
	q->uvscale[0] = sqrt(s);
	q->uvscale[1] = sqrt(t);
	depth = p->depth > 0 ? p->depth : p->depth_scale * q->uvscale[0];
	q->a_tex = (q->a * js[0] * js[0] + q->c * js[0] * js[1] +
		       q->b * js[1] * js[1]) /
		   depth;
	q->b_tex = (q->a * jt[0] * jt[0] + q->c * jt[0] * jt[1] +
		       q->b * jt[1] * jt[1]) /
		   depth;
	q->c_tex =
	    (2 * q->a * js[0] * jt[0] + q->c * (js[0] * jt[1] + js[1] * jt[0]) +
		2 * q->b * js[1] * jt[1]) /
	    depth;
	if (!isfinite(q->a_tex + q->b_tex + q->c_tex))
		q->a_tex = q->b_tex = q->c_tex = 0;
}

/* -- fits that need more than was asked for ------------------------------- */

/* One fit in lane 0, of the neighbours that are listed. */
static bool
fit_alone(const struct bake_quadric_job *job, struct bake_quadric_bench *w,
    const struct bake_frame *f, int p, int n, int nterms,
    struct bake_quadric *q)
{
	struct bake_quadric_batch *b = w->batch;

	memset(b->x, 0, (size_t)n * LANES * sizeof *b->x);
	memset(b->y, 0, (size_t)n * LANES * sizeof *b->y);
	memset(b->z, 0, (size_t)n * LANES * sizeof *b->z);
	memset(b->frame, 0, sizeof b->frame);
	fill_lane(w, &job->pts, p, 0, n, n);
	fill_frame(b, f, 0);
	b->n = n;
	b->nterms = nterms;
	job->solve(b);
	if (n < nterms || !is_determined(b, 0))
		return false;
	take(job, b, 0, p, n, q);
	q->rank = nterms;
	return true;
}

/* z = a (x^2 + y^2), from the neighbours that the batch's lane 0 holds in the
 * frame. */
static bool
fit_isotropic(const struct bake_quadric_job *job, struct bake_quadric_batch *b,
    int p, int n, struct bake_quadric *q)
{
	double zr2 = 0, r4 = 0, a, residual2 = 0;

	for (int k = 0; k < n; k++) {
		double x = b->x[k * LANES], y = b->y[k * LANES];
		double r2 = x * x + y * y;

		zr2 += b->z[k * LANES] * r2;
		r4 += r2 * r2;
	}
	a = zr2 / r4;
	if (!isfinite(a))
		return false;
	for (int k = 0; k < n; k++) {
		double x = b->x[k * LANES], y = b->y[k * LANES];
		double r = b->z[k * LANES] - a * (x * x + y * y);

		residual2 += r * r;
	}
	b->a[0] = b->b[0] = a;
	b->c[0] = 0;
	b->residual2[0] = residual2;
	take(job, b, 0, p, n, q);
	q->rank = 1;
	return isfinite(q->a) && isfinite(q->residual);
}

/* The ring for p, of a fit with so many terms. */
static int
ring_of(const struct bake_quadric_job *job, int p, int nterms)
{
	const struct bake_points *pts = &job->pts;

	if (job->ring > 0)
		return job->ring;
	if (nterms < 9)
		return nterms == 2 ? 1 : 2;
	if (pts->point[p].flags & BAKE_QUADRIC_BOUNDARY)
		return 3;
	for (unsigned k = pts->point[p].start; k < pts->point[p + 1].start; k++)
		if (pts->point[pts->room[k]].flags & BAKE_QUADRIC_BOUNDARY)
			return 3;
	return 2;
}

/* The fit of one frame, by all that METHODS offers for hard cases. */
static void
fit_stubborn(const struct bake_quadric_job *job, struct bake_quadric_bench *w,
    const struct bake_frame *f, int p, struct bake_quadric *q)
{
	int terms[2] = { job->nterms, job->nterms == 9 ? 5 : 0 };
	int n, first = ring_of(job, p, job->nterms);

	for (int k = 0; k < 2 && terms[k] > 0; k++) {
		int last = 0;

		q->ring = ring_of(job, p, terms[k]);
		for (;; q->ring++) {
			n = gather(w, &job->pts, p, q->ring);
			if (n > last &&
			    fit_alone(job, w, f, p, n, terms[k], q)) {
				q->flags |=
				    (q->ring > first ? BAKE_QUADRIC_GROWN : 0) |
				    (k > 0 ? BAKE_QUADRIC_LOWERED : 0);
				return;
			}
			if (n == last || q->ring >= BAKE_QUADRIC_RING_GROWN)
				break;
			last = n;
		}
	}
	q->flags |= BAKE_QUADRIC_LOWERED;
	q->ring = ring_of(job, p, job->nterms == 9 ? 5 : job->nterms);
	n = gather(w, &job->pts, p, q->ring);
	/* for the neighbours in the frame; what it fits does not matter */
	if (n > 0)
		fit_alone(job, w, f, p, n, 2, q);
	if (n == 0 || !fit_isotropic(job, w->batch, p, n, q)) {
		q->a = q->b = q->c = q->residual = 0;
		q->rank = 0;
	}
	q->neighbours = n;
}

/* -- batches -----------------------------------------------------------------
 */

static bool
is_usable(const struct bake_frame *f)
{
	double n = 0, t = 0;

	for (int c = 0; c < 3; c++) {
		n += f->normal[c] * f->normal[c];
		t += f->tangent[c] * f->tangent[c];
	}
	return !(f->flags & BAKE_FRAME_NORMAL_NONE) && n > 0.5 && n < 2 &&
	       t > 0.5 && t < 2;
}

/* Frames are visited along the curve, which is not the order in which they lie
 * in memory: fetch what a later batch needs. */
static inline void
fetch_ahead(const struct bake_quadric_job *job, const struct bake_site *site)
{
	const char *f = (const char *)&job->frames->frame[site->frame];
	const char *q = (const char *)&job->out[site->frame];

	__builtin_prefetch(f);
	__builtin_prefetch(f + sizeof(struct bake_frame) - 1);
	__builtin_prefetch(q, 1);
	__builtin_prefetch(q + sizeof(struct bake_quadric) - 1, 1);
}

/* By its members: see mesh_frame_point.c. */
static inline void
clear(struct bake_quadric *q)
{
	q->a = q->b = q->c = q->a_tex = q->b_tex = q->c_tex = 0;
	q->uvscale[0] = q->uvscale[1] = q->residual = 0;
	q->rank = q->ring = q->neighbours = q->flags = 0;
}

/* Put a site's neighbours and frame into a lane; returns how many there are,
 * 0 also where the site cannot be fitted. */
static int
start_lane(const struct bake_quadric_job *job, struct bake_quadric_bench *w,
    const struct bake_site *site, int lane, int rows, struct bake_quadric *q)
{
	const struct bake_frame *f = &job->frames->frame[site->frame];
	struct bake_quadric_batch *b = w->batch;
	int p = site->point, n;

	clear(q);
	if (p < 0 || !is_usable(f))
		return 0;
	q->ring = ring_of(job, p, job->nterms);
	q->flags = (int)job->pts.point[p].flags;
	if (w->creased[(size_t)p - w->first])
		q->flags |= BAKE_QUADRIC_CREASE;
	n = gather(w, &job->pts, p, q->ring);
	/* rows that no lane had before */
	for (int k = rows; k < n; k++) {
		memset(b->x + k * LANES, 0, LANES * sizeof *b->x);
		memset(b->y + k * LANES, 0, LANES * sizeof *b->y);
		memset(b->z + k * LANES, 0, LANES * sizeof *b->z);
	}
	fill_lane(w, &job->pts, p, lane, n, rows);
	fill_frame(b, f, lane);
	return n;
}

void
bake_quadric_fit_batch(const struct bake_quadric_job *job,
    struct bake_quadric_bench *w, const struct bake_site *site, int count,
    const struct bake_site *end)
{
	struct bake_quadric_batch *b = w->batch;
	/* complete before they go to where memory is slow */
	struct bake_quadric out[LANES];
	int n[LANES], rows = 0;

	for (int l = 0; l < count; l++) {
		if (end - site > LANES + l)
			fetch_ahead(job, site + LANES + l);
		n[l] = start_lane(job, w, site + l, l, rows, &out[l]);
		/* what a lane without neighbours holds does not matter */
		rows = n[l] > rows ? n[l] : rows;
	}
	b->n = rows;
	b->nterms = job->nterms;
	if (rows > 0)
		job->solve(b);
	for (int l = 0; l < count; l++) {
		if (n[l] < job->nterms || !is_determined(b, l))
			continue;
		take(job, b, l, site[l].point, n[l], &out[l]);
		out[l].rank = job->nterms;
	}
	/* these use the batch themselves */
	for (int l = 0; l < count; l++) {
		const struct bake_frame *f = &job->frames->frame[site[l].frame];
		struct bake_quadric *q = &out[l];

		if (q->rank == 0 && n[l] > 0)
			fit_stubborn(job, w, f, site[l].point, q);
		else if (q->rank == 0)
			q->flags |= BAKE_QUADRIC_LOWERED;
		finish(job, f, q);
		job->out[site[l].frame] = *q;
	}
}
