/* The renderer: objects into tiles, tiles into the picture. */
/* SPDX-License-Identifier: MIT */
#include "render.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "render_priv.h"

/* An object with its rasteriser, and the mesh that is drawn. */
struct drawn {
	const struct bake_render_object *object;
	struct bake_mesh box; /* of an impostor */
	const struct bake_mesh *mesh;
	struct bake_raster *raster;
};

struct render {
	const struct bake_render_params *params;
	struct bake_camera_basis camera;
	struct drawn *drawn;
	int n;
	struct bake_render_buffers *out;
};

void
bake_render_buffers_free(struct bake_render_buffers *b)
{
	bake_image_free(&b->color);
	bake_image_free(&b->distance);
	bake_image_free(&b->normal);
	bake_image_free(&b->ao);
	bake_image_free(&b->uv);
	bake_image_free(&b->mask);
}

/* -- checks ------------------------------------------------------------------
 */

static enum bake_status
check_object(const struct bake_render_object *o, int i, struct bake_err *err)
{
	const char *lacks = NULL;

	if (o->impostor)
		lacks = o->multi == NULL ? "multilayer maps" : NULL;
	else if (o->mesh == NULL || o->frames == NULL)
		lacks = "a mesh with frames";
	else if (o->nlayers > 0 && o->multi != NULL)
		lacks = "either layers or multilayer maps";
	else if (o->silhouette == BAKE_SILHOUETTE_QUADRIC &&
		 o->quadrics == NULL)
		lacks = "quadrics";
	else if (o->silhouette == BAKE_SILHOUETTE_SHELL &&
		 (o->shell == NULL || o->nlayers != 1))
		lacks = "a shell and one layer";
	else if (o->horizons != NULL && o->nlayers != 1)
		lacks = "one layer, which its horizons belong to";
	else if (!(o->depth > 0) || !isfinite(o->depth))
		lacks = "a depth above 0";
	else if (!(o->tile_u > 0) || !(o->tile_v > 0))
		lacks = "tile factors above 0";
	if (lacks != NULL)
		return bake_fail(
		    err, BAKE_EINVAL, "object %d needs %s", i + 1, lacks);
	return BAKE_OK;
}

static enum bake_status
check(const struct bake_render_object *objects, int n,
    const struct bake_render_params *p, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;

	if (n < 1)
		return bake_fail(err, BAKE_EINVAL, "no object");
	if (p->samples != 1 && p->samples != 2 && p->samples != 4)
		return bake_fail(err, BAKE_EINVAL,
		    "%d x %d samples, expected 1, 2 or 4 a side", p->samples,
		    p->samples);
	for (int i = 0; i < n && rc == BAKE_OK; i++)
		rc = check_object(&objects[i], i, err);
	return rc;
}

/* -- opening -----------------------------------------------------------------
 */

/* The box of an impostor, its faces outwards. */
static enum bake_status
make_box(struct drawn *d, struct bake_err *err)
{
	static const int quad[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 },
		{ 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 4, 6, 2 },
		{ 1, 3, 7, 5 } };
	const struct bake_render_object *o = d->object;
	enum bake_status rc = bake_mesh_alloc(&d->box, 8, 0, 0, 12, err);

	if (rc != BAKE_OK)
		return rc;
	for (int i = 0; i < 8; i++)
		for (int c = 0; c < 3; c++) {
			double p = 0;

			for (int k = 0; k < 3; k++)
				p += o->box[i >> k & 1][k] * o->box_axes[k][c];
			d->box.positions[i][c] = p;
		}
	for (int f = 0; f < 6; f++)
		for (int h = 0; h < 2; h++)
			for (int k = 0; k < 3; k++) {
				const int at = k == 0 ? 0 : h + k;
				const struct bake_corner corner = { quad[f][at],
					-1, -1 };

				d->box.triangles[2 * f + h][k] = corner;
			}
	return BAKE_OK;
}

static enum bake_status
open_drawn(struct drawn *d, const struct bake_render_object *o,
    const struct bake_render_params *p, struct bake_err *err)
{
	const struct bake_mesh empty = BAKE_MESH_INIT;
	const bool both = o->two_sided || (o->multi != NULL && !o->impostor);
	enum bake_status rc = BAKE_OK;

	d->object = o;
	d->box = empty;
	d->mesh = o->mesh;
	if (o->impostor) {
		rc = make_box(d, err);
		d->mesh = &d->box;
	}
	if (rc == BAKE_OK)
		rc = bake_raster_open(&d->raster, d->mesh, &p->camera,
		    p->samples, both ? BAKE_CULL_NONE : BAKE_CULL_BACK,
		    p->nthreads, err);
	return rc;
}

static enum bake_status
alloc_buffers(const struct bake_render_params *p, struct bake_render_buffers *b,
    struct bake_err *err)
{
	const struct {
		struct bake_image *img;
		int flag, nchans;
	} wanted[] = { { &b->color, 0, 4 },
		{ &b->distance, BAKE_BUFFER_DISTANCE, 1 },
		{ &b->normal, BAKE_BUFFER_NORMAL, 3 },
		{ &b->ao, BAKE_BUFFER_AO, 1 }, { &b->uv, BAKE_BUFFER_UV, 2 },
		{ &b->mask, BAKE_BUFFER_MASK, 1 } };
	enum bake_status rc = BAKE_OK;

	for (int i = 0; i < 6 && rc == BAKE_OK; i++)
		if (wanted[i].flag == 0 || (b->want & wanted[i].flag))
			rc = bake_image_alloc(wanted[i].img, p->camera.width,
			    p->camera.height, wanted[i].nchans, err);
	return rc;
}

/* -- one tile ----------------------------------------------------------------
 */

/* What a tile's fragments go to. */
struct sink {
	const struct render *r;
	const struct drawn *drawn;
	struct render_worker *w;
};

static void
flush(struct sink *s)
{
	struct render_batch *b = &s->w->batch;
	const struct bake_render_params *p = s->r->params;
	const struct bake_render_object *o = s->drawn->object;

	if (b->n == 0)
		return;
	if (o->multi != NULL)
		bake_render_hit_multi(b, p);
	else if (o->nlayers == 0)
		bake_render_hit_plain(b);
	else if (o->silhouette == BAKE_SILHOUETTE_SHELL)
		bake_render_hit_shell(b, p);
	else
		bake_render_hit_layers(b, p);
	if (o->silhouette != BAKE_SILHOUETTE_SHELL || o->nlayers == 0) {
		for (int i = 0; i < b->n; i++)
			b->lit[i] = 1;
		if (p->shadow != BAKE_SHADOW_NONE && o->horizons != NULL)
			bake_render_soft_shadow(b, p);
		else if (p->shadow != BAKE_SHADOW_NONE &&
			 (o->multi != NULL || o->nlayers > 0))
			bake_render_shadow(b, p);
	}
	bake_render_shade(b, p, &s->w->tile);
	b->n = 0;
}

static void
take(void *arg, const struct bake_fragments *f)
{
	struct sink *s = arg;

	if (s->w->batch.n + f->n > RENDER_BATCH)
		flush(s);
	bake_render_append(
	    &s->w->batch, s->drawn->object, s->drawn->mesh, f, &s->r->camera);
}

static void
clear_tile(struct render_tile *t)
{
	for (int i = 0; i < RENDER_TILE; i++)
		t->distance[i] = INFINITY;
}

/* The mean of a pixel's samples into the buffers. */
static void
resolve_pixel(const struct render *r, const struct render_tile *t, int x0,
    int y0, int x, int y)
{
	const int n = r->params->samples;
	const float *ground = r->params->background;
	struct bake_render_buffers *out = r->out;
	float sum[10] = { 0 }, mask, hits = 0;
	float *c = bake_image_row(&out->color, y) + 4 * (size_t)x;

	for (int j = 0; j < n; j++)
		for (int i = 0; i < n; i++) {
			const int s = (y * n + j - y0) * BAKE_RASTER_TILE +
				      x * n + i - x0;

			if (!(t->distance[s] < INFINITY))
				continue;
			hits++;
			for (int k = 0; k < 3; k++) {
				sum[k] += t->color[k][s];
				sum[3 + k] += t->normal[k][s];
			}
			sum[6] += t->distance[s];
			sum[7] += t->ao[s];
			sum[8] += t->u[s];
			sum[9] += t->v[s];
		}
	mask = hits / (float)(n * n);
	for (int k = 0; k < 3; k++)
		c[k] = sum[k] / (float)(n * n) +
		       (1 - mask) * ground[3] * ground[k];
	c[3] = mask + (1 - mask) * ground[3];
	hits = hits > 0 ? 1 / hits : 0;
	if (out->want & BAKE_BUFFER_DISTANCE)
		bake_image_row(&out->distance, y)[x] =
		    hits > 0 ? sum[6] * hits : INFINITY;
	for (int k = 0; k < 3 && (out->want & BAKE_BUFFER_NORMAL); k++)
		bake_image_row(&out->normal, y)[3 * x + k] = sum[3 + k] * hits;
	if (out->want & BAKE_BUFFER_AO)
		bake_image_row(&out->ao, y)[x] = sum[7] * hits;
	for (int k = 0; k < 2 && (out->want & BAKE_BUFFER_UV); k++)
		bake_image_row(&out->uv, y)[2 * x + k] = sum[8 + k] * hits;
	if (out->want & BAKE_BUFFER_MASK)
		bake_image_row(&out->mask, y)[x] = mask;
}

static void
do_tile(const struct render *r, struct render_worker *w, void *scratch, int t)
{
	const int n = r->params->samples;
	int x0, y0, width, height;

	bake_raster_tile(r->drawn[0].raster, t, &x0, &y0, &width, &height);
	clear_tile(&w->tile);
	for (int i = 0; i < r->n; i++) {
		struct sink s = { r, &r->drawn[i], w };

		w->batch.n = 0;
		bake_raster_fragments(r->drawn[i].raster, t, take, &s, scratch);
		flush(&s);
	}
	for (int y = y0 / n; y < (y0 + height) / n; y++)
		for (int x = x0 / n; x < (x0 + width) / n; x++)
			resolve_pixel(r, &w->tile, x0, y0, x, y);
}

/* -- all tiles ---------------------------------------------------------------
 */

static struct render_worker *
make_worker(struct bake_err *err)
{
	struct render_worker *w = bake_zalloc(1, sizeof *w, err);
	struct render_batch *b;

	if (w == NULL)
		return NULL;
	b = &w->batch;
	b->kernels = bake_render_pick_kernels();
	b->rays = (struct bake_rays){ 0, b->u, b->v, b->z, b->du, b->dv, b->dz,
		b->q, b->t_end, b->hit };
	b->shadow = (struct bake_rays){ 0, b->su, b->sv, b->sz, b->sdu, b->sdv,
		b->sdz, b->sq, b->st_end, b->shit };
	return w;
}

static enum bake_status
do_tiles(struct render *r, struct bake_err *err)
{
	const struct bake_progress *progress = &r->params->progress;
	const int ntiles = bake_raster_ntiles(r->drawn[0].raster);
	enum bake_status rc = BAKE_OK;
	int done = 0;

#pragma omp parallel num_threads(bake_threads(r->params->nthreads))
	{
		struct bake_err own = BAKE_ERR_INIT;
		struct render_worker *w = make_worker(&own);
		void *scratch = bake_alloc(1, bake_raster_scratch(), &own);

		if (w == NULL || scratch == NULL) {
#pragma omp critical(bake_render)
			{
				rc = BAKE_ENOMEM;
				*err = own;
			}
		}
#pragma omp for schedule(dynamic, 1)
		for (int t = 0; t < ntiles; t++) {
			int so_far;

			if (w == NULL || scratch == NULL)
				continue;
			do_tile(r, w, scratch, t);
#pragma omp atomic capture
			so_far = ++done;
			if (progress->report != NULL &&
			    omp_get_thread_num() == 0)
				progress->report(
				    progress->arg, (double)so_far / ntiles);
		}
		free(w);
		free(scratch);
	}
	return rc;
}

enum bake_status
bake_render(const struct bake_render_object *objects, int nobjects,
    const struct bake_render_params *params,
    struct bake_render_buffers *buffers, struct bake_err *err)
{
	struct render r = { .params = params, .n = nobjects, .out = buffers };
	enum bake_status rc = check(objects, nobjects, params, err);

	if (rc == BAKE_OK)
		rc = bake_camera_basis(&params->camera, &r.camera, err);
	if (rc != BAKE_OK)
		return rc;
	r.drawn = bake_zalloc((size_t)nobjects, sizeof *r.drawn, err);
	if (r.drawn == NULL)
		return BAKE_ENOMEM;
	rc = alloc_buffers(params, buffers, err);
	for (int i = 0; i < nobjects && rc == BAKE_OK; i++)
		rc = open_drawn(&r.drawn[i], &objects[i], params, err);
	if (rc == BAKE_OK)
		rc = do_tiles(&r, err);
	for (int i = 0; i < nobjects; i++) {
		bake_raster_close(r.drawn[i].raster);
		bake_mesh_free(&r.drawn[i].box);
	}
	free(r.drawn);
	if (rc != BAKE_OK)
		bake_render_buffers_free(buffers);
	return rc;
}
