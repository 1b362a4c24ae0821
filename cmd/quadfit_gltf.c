/* rm-quadfit: quadrics as attributes of glTF files. */
/* SPDX-License-Identifier: MIT */
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "cmd_batch.h"
#include "cmd_recipe.h"
#include "mem.h"
#include "output.h"
#include "quadfit.h"

/* The two attributes of a run of vertices. */
struct values {
	float (*quadric)[2];
	float (*uvscale)[2];
	size_t n;
};

static float
to_float(double v)
{
	return v > (double)FLT_MAX    ? FLT_MAX
	       : v < -(double)FLT_MAX ? -FLT_MAX
				      : (float)v;
}

static bool
alloc_values(struct values *v, size_t n, struct bake_err *err)
{
	v->n = n;
	v->quadric = bake_zalloc(n, sizeof *v->quadric, err);
	v->uvscale = bake_zalloc(n, sizeof *v->uvscale, err);
	return v->quadric != NULL && v->uvscale != NULL;
}

static void
free_values(struct values *v)
{
	free(v->quadric);
	free(v->uvscale);
}

static void
set_value(struct values *v, size_t i, const struct bake_quadric *q)
{
	v->quadric[i][0] = to_float(q->a);
	v->quadric[i][1] = to_float(q->b);
	v->uvscale[i][0] = to_float(q->uvscale[0]);
	v->uvscale[i][1] = to_float(q->uvscale[1]);
}

static bool
add_values(struct bake_gltf *gltf, const struct quadfit_opts *o, int mesh,
    int primitive, const struct values *v, struct bake_err *err)
{
	const char *sign =
	    o->fit.sign == BAKE_QUADRIC_DEPTH ? "depth" : "outward";
	const struct bake_gltf_attribute quadric = { "_QUADRIC", sign,
		(const float(*)[2])v->quadric, v->n };
	const struct bake_gltf_attribute uvscale = { "_UVSCALE", NULL,
		(const float(*)[2])v->uvscale, v->n };

	return bake_gltf_add(gltf, mesh, primitive, &quadric, err) == BAKE_OK &&
	       bake_gltf_add(gltf, mesh, primitive, &uvscale, err) == BAKE_OK;
}

static bool
write_gltf(struct cmd *cmd, struct bake_gltf *gltf, const char *path, bool glb)
{
	struct bake_output out = BAKE_OUTPUT_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct cmd_record record;
	bool ok;

	if (bake_gltf_has_outside(gltf, glb))
		cmd_recipe_none(cmd);
	(void)cmd_recipe_record(cmd, path, &record);
	ok = bake_gltf_set_record(gltf, record.text, record.list, &err) ==
		 BAKE_OK &&
	     bake_output_open(&out, path, &err) == BAKE_OK &&
	     bake_gltf_write(gltf, out.stream, glb, path, &err) == BAKE_OK &&
	     cmd_recipe_seal(&record, out.stream, &err) == BAKE_OK &&
	     (cmd_same_bytes(cmd, out.stream, path) ||
		 bake_output_commit(&out, &err) == BAKE_OK);

	bake_output_abort(&out);
	if (ok)
		cmd_list_add(&cmd->written, path);
	else
		cmd_error(cmd, "%s", err.msg);
	return ok;
}

bool
quadfit_make_gltf(struct cmd *cmd, const struct quadfit_opts *o,
    const char *path, const struct quadfit *q, const char *out, bool glb)
{
	struct bake_gltf *gltf = NULL;
	struct bake_err err = BAKE_ERR_INIT;
	struct values v = { NULL, NULL, 0 };
	bool ok =
	    bake_gltf_make(&q->mesh, &q->frames, &gltf, &err) == BAKE_OK &&
	    alloc_values(&v, q->frames.nframes, &err);

	for (size_t i = 0; ok && i < v.n; i++)
		set_value(&v, i, &q->quadrics[i]);
	ok = ok && add_values(gltf, o, 0, 0, &v, &err);
	if (!ok)
		cmd_error(cmd, "%s: %s", path, err.msg);
	else
		ok = write_gltf(cmd, gltf, out, glb);
	free_values(&v);
	bake_gltf_free(gltf);
	return ok;
}

/* -- a glTF's own meshes ------------------------------------------------------
 */

/* The parts of one mesh: a run of the parts, positions and triangles. */
struct run {
	size_t part, nparts;
	size_t position, npositions, triangle, ntriangles;
};

static struct run
find_run(const struct bake_mesh *all, size_t part)
{
	struct run r = { part, 0, all->parts[part].first_position, 0,
		all->parts[part].first_triangle, 0 };

	while (part + r.nparts < all->nparts &&
	       all->parts[part + r.nparts].mesh == all->parts[part].mesh) {
		const struct bake_mesh_part *p = &all->parts[part + r.nparts];

		r.npositions = p->first_position + p->npositions - r.position;
		r.ntriangles = p->first_triangle + p->ntriangles - r.triangle;
		r.nparts++;
	}
	return r;
}

/* A mesh of a run alone, positions numbered from 0. It borrows the arrays of
 * all but triangles, which the caller frees, and has neither UVs nor normals
 * that its triangles do not use. */
static bool
cut_out(const struct bake_mesh *all, const struct run *r,
    struct bake_mesh *mesh, struct bake_err *err)
{
	bool uvs = false, normals = false;

	*mesh = *all;
	mesh->positions = all->positions + r->position;
	mesh->npositions = r->npositions;
	mesh->ntriangles = r->ntriangles;
	mesh->material_of = all->material_of + r->triangle;
	mesh->nparts = mesh->nfiles = 0;
	mesh->triangles =
	    bake_alloc(r->ntriangles, sizeof *mesh->triangles, err);
	if (mesh->triangles == NULL)
		return false;
	for (size_t t = 0; t < r->ntriangles; t++)
		for (int k = 0; k < 3; k++) {
			struct bake_corner c =
			    all->triangles[r->triangle + t][k];

			uvs |= c.vt >= 0;
			normals |= c.vn >= 0;
			c.v -= (int)r->position;
			mesh->triangles[t][k] = c;
		}
	if (!uvs)
		mesh->nuvs = 0;
	if (!normals) {
		mesh->nnormals = 0;
		mesh->tangents = NULL;
	}
	return true;
}

/* The values of one primitive's vertices; those of another that has the same
 * vertices count where it has none itself. of is the frame of each position
 * of the run, or -1. */
static bool
add_part(struct bake_gltf *gltf, const struct quadfit_opts *o,
    const struct bake_mesh *all, const struct run *r, size_t part,
    const struct quadfit *q, const int *of, struct bake_err *err)
{
	const struct bake_mesh_part *p = &all->parts[part];
	struct values v = { NULL, NULL, 0 };
	bool ok = alloc_values(&v, p->npositions, err);

	for (size_t i = 0; ok && i < v.n; i++)
		for (size_t k = part; k < r->part + r->nparts; k++) {
			const struct bake_mesh_part *other = &all->parts[k];
			int f;

			if (other->npositions != v.n ||
			    (k > part && !bake_gltf_same_vertices(gltf, p->mesh,
					     p->primitive, other->primitive)))
				continue;
			f = of[other->first_position - r->position + i];
			if (f < 0)
				continue;
			set_value(&v, i, &q->quadrics[f]);
			break;
		}
	ok = ok && add_values(gltf, o, p->mesh, p->primitive, &v, err);
	free_values(&v);
	return ok;
}

/* An earlier primitive with the same vertices has written this one's. */
static bool
is_done(const struct bake_gltf *gltf, const struct bake_mesh *all,
    const struct run *r, size_t part)
{
	for (size_t k = r->part; k < part; k++)
		if (bake_gltf_same_vertices(gltf, all->parts[part].mesh,
			all->parts[part].primitive, all->parts[k].primitive))
			return true;
	return false;
}

static bool
add_run(struct cmd *cmd, const struct quadfit_opts *o, const char *path,
    struct bake_gltf *gltf, const struct bake_mesh *all, const struct run *r,
    const struct quadfit *q)
{
	struct bake_err err = BAKE_ERR_INIT;
	int *of = bake_alloc(r->npositions, sizeof *of, &err);
	bool ok = of != NULL;

	if (ok)
		memset(of, 0xff, r->npositions * sizeof *of);
	for (size_t i = q->frames.nframes; ok && i-- > 0;)
		of[q->frames.frame[i].v] = (int)i;
	for (size_t k = r->part; ok && k < r->part + r->nparts; k++)
		if (!is_done(gltf, all, r, k))
			ok = add_part(gltf, o, all, r, k, q, of, &err);
	if (!ok)
		cmd_error(cmd, "%s: %s", path, err.msg);
	free(of);
	return ok;
}

/* Fit one mesh of the file and add what came out. */
static bool
fit_run(struct cmd *cmd, const struct quadfit_opts *o, const char *path,
    struct bake_gltf *gltf, const struct bake_mesh *all, const struct run *r)
{
	struct quadfit q = QUADFIT_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_corner(*triangles)[3];
	char name[1024];
	bool ok;

	snprintf(
	    name, sizeof name, "%s, mesh %d", path, all->parts[r->part].mesh);
	if (bake_gltf_nmeshes(gltf) == 1)
		snprintf(name, sizeof name, "%s", path);
	if (!cut_out(all, r, &q.mesh, &err)) {
		cmd_error(cmd, "%s: %s", name, err.msg);
		return false;
	}
	ok = quadfit_fit(cmd, o, name, &q) &&
	     add_run(cmd, o, name, gltf, all, r, &q) &&
	     (!o->stats || quadfit_print_stats(cmd, o, name, &q));
	triangles = q.mesh.triangles;
	q.mesh = (struct bake_mesh)BAKE_MESH_INIT;
	free(triangles);
	quadfit_free(&q);
	return ok;
}

static bool
read_local(struct cmd *cmd, const struct quadfit_opts *o, const char *path,
    struct bake_gltf **gltf, struct bake_mesh *mesh)
{
	struct bake_err err = BAKE_ERR_INIT;
	unsigned char *bytes = NULL;
	size_t nbytes;
	bool ok;

	cmd_decode_begin(cmd, 0);
	ok = bake_gltf_read(path, o->mesh.max_bytes, gltf, &err) == BAKE_OK &&
	     bake_gltf_local(*gltf, &bytes, &nbytes, &err) == BAKE_OK &&
	     bake_mesh_read_memory(bytes, nbytes, path, &o->mesh, mesh, &err) ==
		 BAKE_OK;
	cmd_decode_end(cmd);
	free(bytes);
	if (!ok)
		cmd_error(cmd, "%s", err.msg);
	return ok;
}

static void
note_files(struct cmd *cmd, const struct bake_gltf *gltf)
{
	size_t n;
	const char *const *files = bake_gltf_files(gltf, &n);

	for (size_t i = 0; i < n; i++)
		cmd_list_add(&cmd->read, files[i]);
}

bool
quadfit_gltf(struct cmd *cmd, const struct quadfit_opts *o, const char *path,
    const char *out, bool glb)
{
	struct bake_mesh all = BAKE_MESH_INIT;
	struct bake_gltf *gltf = NULL;
	bool ok = read_local(cmd, o, path, &gltf, &all);

	for (size_t part = 0; ok && part < all.nparts;) {
		struct run r = find_run(&all, part);

		ok = fit_run(cmd, o, path, gltf, &all, &r);
		part += r.nparts;
	}
	if (ok)
		note_files(cmd, gltf);
	ok = ok && write_gltf(cmd, gltf, out, glb);
	if (ok) /* and what was read for writing */
		note_files(cmd, gltf);
	bake_mesh_free(&all);
	bake_gltf_free(gltf);
	return ok;
}
