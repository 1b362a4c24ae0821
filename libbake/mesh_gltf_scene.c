/* glTF 2.0: nodes and the triangles of their meshes. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh_gltf_priv.h"

enum mode {
	POINTS,
	LINES,
	LINE_LOOP,
	LINE_STRIP,
	TRIANGLES,
	STRIP,
	FAN,
	NMODES
};

/* A primitive's accessors; values is NULL for one that it lacks. */
enum { POSITION, NORMAL, TANGENT, TEXCOORD, COLOR, INDICES, NACCESSORS };
struct primitive {
	struct gltf_values a[NACCESSORS];
	int mode, material;
	size_t count; /* of vertices to draw */
};

/* What is below a node. */
struct walk {
	struct gltf *g;
	unsigned char *seen; /* of each node */
	size_t nnodes;
};

/* -- primitives ---------------------------------------------------------- */

static enum bake_status
bad_primitive(const struct gltf *g, const char *what, struct bake_err *err)
{
	return bake_fail(
	    err, BAKE_EDATA, "'%s': a primitive %s", g->b->src->name, what);
}

static enum bake_status
read_attribute(struct gltf *g, const json_t *attributes, const char *name,
    int least, int most, struct gltf_values *out, struct bake_err *err)
{
	enum bake_status rc;

	if (json_object_get(attributes, name) == NULL)
		return BAKE_OK;
	rc = bake_mesh_gltf_accessor(
	    g, bake_gltf_size(attributes, name, SIZE_MAX), out, err);
	if (rc == BAKE_OK &&
	    (out->ncomponents < least || out->ncomponents > most))
		return bake_fail(err, BAKE_EDATA,
		    "'%s': %s has %d components, expected %d", g->b->src->name,
		    name, out->ncomponents, least);
	return rc;
}

static enum bake_status
read_attributes(struct gltf *g, const json_t *from, struct primitive *p,
    struct bake_err *err)
{
	const json_t *at = json_object_get(from, "attributes");
	char texcoord[32];
	enum bake_status rc;

	snprintf(texcoord, sizeof texcoord, "TEXCOORD_%d",
	    g->b->src->params->uv_set);
	if ((rc = read_attribute(
		 g, at, "POSITION", 3, 3, &p->a[POSITION], err)) != BAKE_OK ||
	    (rc = read_attribute(g, at, "NORMAL", 3, 3, &p->a[NORMAL], err)) !=
		BAKE_OK ||
	    (rc = read_attribute(
		 g, at, "TANGENT", 4, 4, &p->a[TANGENT], err)) != BAKE_OK ||
	    (rc = read_attribute(
		 g, at, texcoord, 2, 2, &p->a[TEXCOORD], err)) != BAKE_OK ||
	    (rc = read_attribute(g, at, "COLOR_0", 3, 4, &p->a[COLOR], err)) !=
		BAKE_OK ||
	    (rc = read_attribute(
		 g, from, "indices", 1, 1, &p->a[INDICES], err)) != BAKE_OK)
		return rc;
	for (int i = NORMAL; i <= COLOR; i++)
		if (p->a[i].values != NULL &&
		    p->a[i].count != p->a[POSITION].count)
			return bad_primitive(
			    g, "has attributes of different counts", err);
	return BAKE_OK;
}

static enum bake_status
read_primitive(struct gltf *g, const json_t *from, struct primitive *p,
    struct bake_err *err)
{
	size_t mode = bake_gltf_size(from, "mode", TRIANGLES);
	size_t material = bake_gltf_size(from, "material", SIZE_MAX);
	enum bake_status rc;

	memset(p, 0, sizeof *p);
	if (json_object_get(json_object_get(from, "extensions"),
		"KHR_draco_mesh_compression") != NULL)
		return bad_primitive(g,
		    "is compressed by Draco, which cannot be read: export it "
		    "without",
		    err);
	if (mode >= NMODES)
		return bad_primitive(g, "is of an unknown mode", err);
	p->mode = (int)mode;
	p->material = -1;
	if (json_object_get(from, "material") != NULL) {
		if (material >= g->b->mesh->nmaterials)
			return bad_primitive(
			    g, "has a material that is not there", err);
		p->material = (int)material;
	}
	if ((rc = read_attributes(g, from, p, err)) != BAKE_OK)
		return rc;
	p->count = p->a[INDICES].values != NULL ? p->a[INDICES].count
						: p->a[POSITION].count;
	return BAKE_OK;
}

static void
primitive_free(struct primitive *p)
{
	for (int i = 0; i < NACCESSORS; i++)
		free(p->a[i].values);
}

/* Where the primitive's first vertex is in the mesh. */
struct base {
	int v, vt, vn;
};

/* The corner of the i-th vertex to draw; its number is checked later. */
static struct bake_corner
corner_at(const struct primitive *p, const struct base *base, size_t i)
{
	const double *index = p->a[INDICES].values;
	int k = index != NULL ? (int)fmin(index[i], 2147483647.0) : (int)i;
	struct bake_corner c = { base->v + k, -1, -1 };

	if (p->a[TEXCOORD].values != NULL)
		c.vt = base->vt + k;
	if (p->a[NORMAL].values != NULL)
		c.vn = base->vn + k;
	return c;
}

static enum bake_status
add_vertices(struct mesh_builder *b, const struct primitive *p,
    const struct mesh_affine *m, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;
	double x[4];

	for (size_t i = 0; rc == BAKE_OK && i < p->a[POSITION].count; i++) {
		bake_mesh_affine_point(m, p->a[POSITION].values + 3 * i, x);
		rc = bake_mesh_add_position(b, x, err);
		if (rc == BAKE_OK && p->a[TEXCOORD].values != NULL) {
			x[0] = p->a[TEXCOORD].values[2 * i];
			x[1] = 1.0 - p->a[TEXCOORD].values[2 * i + 1];
			rc = bake_mesh_add_uv(b, x, err);
		}
		if (rc == BAKE_OK && p->a[NORMAL].values != NULL) {
			bake_mesh_affine_normal(
			    m, p->a[NORMAL].values + 3 * i, x);
			rc = bake_mesh_add_normal(b, x, err);
		}
		if (rc == BAKE_OK && p->a[NORMAL].values != NULL &&
		    p->a[TANGENT].values != NULL) {
			bake_mesh_affine_tangent(
			    m, p->a[TANGENT].values + 4 * i, x);
			rc = bake_mesh_set_tangent(
			    b, b->mesh->nnormals - 1, x, err);
		}
		if (rc == BAKE_OK && p->a[COLOR].values != NULL) {
			int nc = p->a[COLOR].ncomponents;
			const double *c = p->a[COLOR].values + i * (size_t)nc;
			float rgba[4] = { (float)c[0], (float)c[1], (float)c[2],
				nc == 4 ? (float)c[3] : 1.0f };

			rc = bake_mesh_set_color(
			    b, b->mesh->npositions - 1, rgba, err);
		}
	}
	return rc;
}

static enum bake_status
check_indices(
    const struct gltf *g, const struct primitive *p, struct bake_err *err)
{
	for (size_t i = 0; i < p->a[INDICES].count; i++) {
		double index = p->a[INDICES].values[i];

		if (!(index >= 0.0 && index < (double)p->a[POSITION].count))
			return bake_fail(err, BAKE_EDATA,
			    "'%s': a primitive uses vertex %g, it has %zu",
			    g->b->src->name, index, p->a[POSITION].count);
	}
	return BAKE_OK;
}

static enum bake_status
add_triangles(struct mesh_builder *b, const struct primitive *p,
    const struct base *base, const struct mesh_affine *m, struct bake_err *err)
{
	size_t step = p->mode == TRIANGLES ? 3 : 1;
	enum bake_status rc = BAKE_OK;

	for (size_t i = 0; rc == BAKE_OK && i + 2 < p->count; i += step) {
		/* every other triangle of a strip is turned round */
		size_t odd = p->mode == STRIP ? i & 1 : 0;
		size_t first = p->mode == FAN ? 0 : i;

		rc = bake_mesh_add_triangle(b, m, corner_at(p, base, first),
		    corner_at(p, base, i + 1 + odd),
		    corner_at(p, base, i + 2 - odd), p->material, err);
	}
	return rc;
}

/* Points and lines are counted by what they would draw. */
static void
count_others(struct bake_mesh *mesh, const struct primitive *p)
{
	switch (p->mode) {
	case POINTS:
		mesh->dropped.points += p->count;
		break;
	case LINES:
		mesh->dropped.lines += p->count / 2;
		break;
	case LINE_LOOP:
		mesh->dropped.lines += p->count;
		break;
	default:
		mesh->dropped.lines += p->count > 0 ? p->count - 1 : 0;
	}
}

static enum bake_status
add_primitive(struct gltf *g, const json_t *from, const int number[3],
    const struct mesh_affine *m, struct bake_err *err)
{
	const struct base base = { (int)g->b->mesh->npositions,
		(int)g->b->mesh->nuvs, (int)g->b->mesh->nnormals };
	struct primitive p;
	enum bake_status rc = read_primitive(g, from, &p, err);

	if (rc == BAKE_OK && p.mode < TRIANGLES) {
		count_others(g->b->mesh, &p);
	} else if (rc == BAKE_OK && p.a[POSITION].values != NULL &&
		   p.count > 2) {
		if ((rc = check_indices(g, &p, err)) == BAKE_OK &&
		    (rc = bake_mesh_begin_part(g->b, number[0], number[1],
			 number[2], err)) == BAKE_OK &&
		    (rc = add_vertices(g->b, &p, m, err)) == BAKE_OK)
			rc = add_triangles(g->b, &p, &base, m, err);
	}
	primitive_free(&p);
	return rc;
}

/* -- nodes --------------------------------------------------------------- */

/* The node's own map: its matrix, by columns, or scale, then rotation, then
 * translation. */
static void
own_transform(const json_t *node, double m[3][4])
{
	double c[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
	double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 };
	double length, x, y, z, w;

	if (json_object_get(node, "matrix") != NULL) {
		bake_mesh_gltf_numbers(node, "matrix", c, 16);
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 4; j++)
				m[i][j] = c[4 * j + i];
		return;
	}
	bake_mesh_gltf_numbers(node, "translation", t, 3);
	bake_mesh_gltf_numbers(node, "rotation", q, 4);
	bake_mesh_gltf_numbers(node, "scale", s, 3);
	length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	if (!(length > 0.0))
		q[3] = length = 1.0;
	x = q[0] / length;
	y = q[1] / length;
	z = q[2] / length;
	w = q[3] / length;
	{
		const double r[3][3] = {
			{ 1 - 2 * (y * y + z * z), 2 * (x * y - w * z),
			    2 * (x * z + w * y) },
			{ 2 * (x * y + w * z), 1 - 2 * (x * x + z * z),
			    2 * (y * z - w * x) },
			{ 2 * (x * z - w * y), 2 * (y * z + w * x),
			    1 - 2 * (x * x + y * y) },
		};

		for (int i = 0; i < 3; i++) {
			for (int j = 0; j < 3; j++)
				m[i][j] = r[i][j] * s[j];
			m[i][3] = t[i];
		}
	}
}

static enum bake_status
add_mesh(struct gltf *g, int node, size_t mesh, const struct mesh_affine *m,
    struct bake_err *err)
{
	const json_t *object = bake_mesh_gltf_item(g, "meshes", mesh, err);
	const json_t *list = json_object_get(object, "primitives");
	enum bake_status rc = object != NULL ? BAKE_OK : BAKE_EDATA;

	for (size_t i = 0; rc == BAKE_OK && i < json_array_size(list); i++) {
		const int number[3] = { node, (int)mesh, (int)i };

		rc = add_primitive(g, json_array_get(list, i), number, m, err);
	}
	return rc;
}

static enum bake_status
add_node(struct walk *w, size_t index, const double parent[3][4], int depth,
    struct bake_err *err)
{
	enum { MAX_DEPTH = 1000 };
	const json_t *node = bake_mesh_gltf_item(w->g, "nodes", index, err);
	const json_t *children = json_object_get(node, "children");
	struct mesh_affine m;
	double own[3][4];
	enum bake_status rc = BAKE_OK;

	if (node == NULL)
		return BAKE_EDATA;
	if (w->seen[index]++ != 0)
		return bake_fail(err, BAKE_EDATA,
		    "'%s': node %zu has two parents", w->g->b->src->name,
		    index);
	if (depth > MAX_DEPTH)
		return bake_fail(err, BAKE_ELIMIT,
		    "'%s' has nodes more than %d deep", w->g->b->src->name,
		    MAX_DEPTH);
	own_transform(node, own);
	bake_mesh_affine_multiply(m.m, parent, (const double(*)[4])own);
	bake_mesh_affine_prepare(&m);
	if (json_object_get(node, "mesh") != NULL)
		rc = add_mesh(w->g, (int)index,
		    bake_gltf_size(node, "mesh", SIZE_MAX), &m, err);
	for (size_t i = 0; rc == BAKE_OK && i < json_array_size(children);
	     i++) {
		const json_t *c = json_array_get(children, i);

		/* -1 becomes a number that no list has */
		rc = add_node(w,
		    json_is_integer(c) ? (size_t)json_integer_value(c)
				       : SIZE_MAX,
		    (const double(*)[4])m.m, depth + 1, err);
	}
	return rc;
}

static const double identity[3][4] = { { 1, 0, 0, 0 }, { 0, 1, 0, 0 },
	{ 0, 0, 1, 0 } };

/* Without scenes: the nodes that are nobody's children, and without nodes the
 * meshes. */
static enum bake_status
add_all(struct walk *w, struct bake_err *err)
{
	const json_t *nodes = json_object_get(w->g->root, "nodes");
	const json_t *meshes = json_object_get(w->g->root, "meshes");
	unsigned char *is_child = bake_zalloc(w->nnodes, 1, err);
	enum bake_status rc = is_child != NULL ? BAKE_OK : BAKE_ENOMEM;

	for (size_t i = 0; rc == BAKE_OK && i < w->nnodes; i++) {
		const json_t *children =
		    json_object_get(json_array_get(nodes, i), "children");

		for (size_t k = 0; k < json_array_size(children); k++) {
			json_int_t c =
			    json_integer_value(json_array_get(children, k));

			if (c >= 0 && (size_t)c < w->nnodes)
				is_child[c] = 1;
		}
	}
	for (size_t i = 0; rc == BAKE_OK && i < w->nnodes; i++)
		if (!is_child[i])
			rc = add_node(w, i, identity, 0, err);
	for (size_t i = 0;
	     rc == BAKE_OK && w->nnodes == 0 && i < json_array_size(meshes);
	     i++) {
		struct mesh_affine m;

		memcpy(m.m, identity, sizeof m.m);
		bake_mesh_affine_prepare(&m);
		rc = add_mesh(w->g, -1, i, &m, err);
	}
	free(is_child);
	return rc;
}

enum bake_status
bake_mesh_gltf_scene(struct gltf *g, struct bake_err *err)
{
	struct walk w = { g, NULL, 0 };
	const json_t *roots;
	json_t *scene;
	enum bake_status rc = BAKE_OK;

	w.nnodes = json_array_size(json_object_get(g->root, "nodes"));
	if ((w.seen = bake_zalloc(w.nnodes, 1, err)) == NULL)
		return BAKE_ENOMEM;
	if (json_array_size(json_object_get(g->root, "scenes")) == 0) {
		rc = add_all(&w, err);
		goto out;
	}
	scene = bake_mesh_gltf_item(
	    g, "scenes", bake_gltf_size(g->root, "scene", 0), err);
	roots = json_object_get(scene, "nodes");
	if (scene == NULL)
		rc = BAKE_EDATA;
	for (size_t i = 0; rc == BAKE_OK && i < json_array_size(roots); i++) {
		const json_t *r = json_array_get(roots, i);

		rc = add_node(&w,
		    json_is_integer(r) ? (size_t)json_integer_value(r)
				       : SIZE_MAX,
		    identity, 0, err);
	}
out:
	free(w.seen);
	return rc;
}
