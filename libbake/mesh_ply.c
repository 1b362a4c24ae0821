/* A strict reader of PLY files. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh_ply_priv.h"

/* -- values -------------------------------------------------------------- */

static enum bake_status
truncated(
    const struct ply *ply, const struct ply_element *e, struct bake_err *err)
{
	return bake_fail(err, BAKE_EDATA,
	    "'%s' is truncated: it ends inside its %zu elements '%s'",
	    ply->b->src->name, e->count, e->name);
}

static bool
is_space(char c)
{
	return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static enum bake_status
read_ascii(struct ply *ply, const struct ply_element *e, double *x,
    struct bake_err *err)
{
	struct mesh_text *t = &ply->t;

	for (; t->p < t->end && is_space(*t->p); t->p++)
		t->line += *t->p == '\n';
	if (t->p == t->end)
		return truncated(ply, e, err);
	if (bake_mesh_scan_double(t, x) != MESH_NUMBER ||
	    (t->p < t->end && !is_space(*t->p)))
		return bake_fail(err, BAKE_EDATA,
		    "'%s' line %zu: expected a number of element '%s'",
		    ply->b->src->name, t->line, e->name);
	return BAKE_OK;
}

static double
decode(enum ply_type type, const unsigned char *p)
{
	union {
		int8_t i8;
		uint8_t u8;
		int16_t i16;
		uint16_t u16;
		int32_t i32;
		uint32_t u32;
		float f;
		double d;
	} v;

	memcpy(&v, p, bake_ply_type_size(type));
	switch (type) {
	case PLY_INT8:
		return v.i8;
	case PLY_UINT8:
		return v.u8;
	case PLY_INT16:
		return v.i16;
	case PLY_UINT16:
		return v.u16;
	case PLY_INT32:
		return v.i32;
	case PLY_UINT32:
		return v.u32;
	case PLY_FLOAT:
		return (double)v.f;
	default:
		return v.d;
	}
}

static bool
is_foreign(enum ply_format format)
{
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
	return format == PLY_BIG;
#else
	return format == PLY_LITTLE;
#endif
}

static enum bake_status
read_value(struct ply *ply, const struct ply_element *e, enum ply_type type,
    double *x, struct bake_err *err)
{
	size_t n = bake_ply_type_size(type);
	unsigned char bytes[8];

	if (ply->format == PLY_ASCII)
		return read_ascii(ply, e, x, err);
	if ((size_t)(ply->t.end - ply->t.p) < n)
		return truncated(ply, e, err);
	memcpy(bytes, ply->t.p, n);
	ply->t.p += n;
	if (is_foreign(ply->format))
		for (size_t i = 0; i < n / 2; i++) {
			unsigned char b = bytes[i];

			bytes[i] = bytes[n - 1 - i];
			bytes[n - 1 - i] = b;
		}
	*x = decode(type, bytes);
	return BAKE_OK;
}

/* The fewest bytes that n values of a type can be written with: a digit and a
 * separator for each in text. */
static size_t
least_bytes(const struct ply *ply, enum ply_type type)
{
	return ply->format == PLY_ASCII ? 2 : bake_ply_type_size(type);
}

/* Whether the file is long enough for count times size bytes; the last
 * separator of a text may be missing. */
static bool
can_hold(const struct ply *ply, size_t count, size_t size)
{
	size_t left = (size_t)(ply->t.end - ply->t.p) +
		      (ply->format == PLY_ASCII ? 1 : 0);

	return size == 0 || count <= left / size;
}

static enum bake_status
read_length(struct ply *ply, const struct ply_element *e,
    const struct ply_property *p, size_t *n, struct bake_err *err)
{
	double x;
	enum bake_status rc = read_value(ply, e, p->count_type, &x, err);

	if (rc != BAKE_OK)
		return rc;
	if (!(x >= 0.0) || x > UINT32_MAX || x != floor(x))
		return bake_fail(err, BAKE_EDATA,
		    "'%s': a list of element '%s' has %g entries",
		    ply->b->src->name, e->name, x);
	*n = (size_t)x;
	if (!can_hold(ply, *n, least_bytes(ply, p->type)))
		return truncated(ply, e, err);
	return BAKE_OK;
}

static enum bake_status
skip_property(struct ply *ply, const struct ply_element *e,
    const struct ply_property *p, struct bake_err *err)
{
	double x;
	size_t n = 1;
	enum bake_status rc = BAKE_OK;

	if (p->list)
		rc = read_length(ply, e, p, &n, err);
	while (rc == BAKE_OK && n-- > 0)
		rc = read_value(ply, e, p->type, &x, err);
	return rc;
}

/* -- vertices ------------------------------------------------------------ */

/* The first of the three pairs of names for UVs that is complete; -1 where
 * none is. */
static int
uv_roles(const struct ply_element *e)
{
	static const int pairs[] = { PLY_S, PLY_U, PLY_TEXTURE_U };

	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
		if (e->has[pairs[i]] && e->has[pairs[i] + 1])
			return pairs[i];
	return -1;
}

static bool
has_all(const struct ply_element *e, int role, int n)
{
	for (int i = 0; i < n; i++)
		if (!e->has[role + i])
			return false;
	return true;
}

/* Whole numbers are codes of 0..1. */
static double
color_scale(enum ply_type type)
{
	switch (type) {
	case PLY_FLOAT:
	case PLY_DOUBLE:
		return 1.0;
	case PLY_INT16:
	case PLY_UINT16:
		return 65535.0;
	default:
		return 255.0;
	}
}

static enum bake_status
add_vertex(struct ply *ply, const struct ply_element *e, const double *x,
    struct bake_err *err)
{
	struct mesh_builder *b = ply->b;
	int uv = uv_roles(e);
	enum bake_status rc = bake_mesh_add_position(b, &x[PLY_X], err);

	if (rc == BAKE_OK && uv >= 0)
		rc = bake_mesh_add_uv(b, &x[uv], err);
	if (rc == BAKE_OK && has_all(e, PLY_NX, 3)) {
		rc = bake_mesh_add_normal(b, &x[PLY_NX], err);
		if (rc == BAKE_OK && has_all(e, PLY_TX, 4))
			rc = bake_mesh_set_tangent(
			    b, b->mesh->nnormals - 1, &x[PLY_TX], err);
	}
	if (rc == BAKE_OK && has_all(e, PLY_RED, 3)) {
		float rgba[4];

		for (int k = 0; k < 4; k++)
			rgba[k] = (float)x[PLY_RED + k];
		rc = bake_mesh_set_color(b, b->mesh->npositions - 1, rgba, err);
	}
	return rc;
}

static enum bake_status
read_vertices(
    struct ply *ply, const struct ply_element *e, struct bake_err *err)
{
	double x[PLY_NVERTEX_ROLES] = { 0.0 };
	enum bake_status rc = BAKE_OK;

	if (!has_all(e, PLY_X, 3))
		return bake_fail(err, BAKE_EDATA,
		    "'%s' has vertices without x, y and z", ply->b->src->name);
	x[PLY_ALPHA] = 1.0;
	for (size_t i = 0; rc == BAKE_OK && i < e->count; i++) {
		for (int k = 0; rc == BAKE_OK && k < e->nproperties; k++) {
			const struct ply_property *p = &e->property[k];

			if (p->role == PLY_UNKNOWN) {
				rc = skip_property(ply, e, p, err);
				continue;
			}
			rc = read_value(ply, e, p->type, &x[p->role], err);
			if (p->role >= PLY_RED && rc == BAKE_OK)
				x[p->role] /= color_scale(p->type);
		}
		if (rc == BAKE_OK)
			rc = add_vertex(ply, e, x, err);
	}
	return rc;
}

/* -- faces --------------------------------------------------------------- */

/* What faces need to know of the vertices. */
struct shared {
	bool uvs, normals;
};

/* One face's lists; they grow to the largest. */
struct face {
	double *index, *uv;
	size_t nindices, nuvs, cap_index, cap_uv;
	double texnumber;
};

static enum bake_status
read_list(struct ply *ply, const struct ply_element *e,
    const struct ply_property *p, double **list, size_t *n, size_t *cap,
    struct bake_err *err)
{
	enum bake_status rc = read_length(ply, e, p, n, err);

	if (rc != BAKE_OK)
		return rc;
	if (*n > *cap) {
		/* as long as the file has bytes for it */
		free(*list);
		*cap = 2 * *n;
		if ((*list = bake_alloc(*cap, sizeof **list, err)) == NULL) {
			*cap = 0;
			return BAKE_ENOMEM;
		}
	}
	for (size_t i = 0; rc == BAKE_OK && i < *n; i++)
		rc = read_value(ply, e, p->type, &(*list)[i], err);
	return rc;
}

static enum bake_status
read_face(struct ply *ply, const struct ply_element *e, struct face *f,
    struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;

	f->nindices = f->nuvs = 0;
	for (int k = 0; rc == BAKE_OK && k < e->nproperties; k++) {
		const struct ply_property *p = &e->property[k];

		if (p->role == PLY_INDICES)
			rc = read_list(ply, e, p, &f->index, &f->nindices,
			    &f->cap_index, err);
		else if (p->role == PLY_TEXCOORD)
			rc = read_list(
			    ply, e, p, &f->uv, &f->nuvs, &f->cap_uv, err);
		else if (p->role == PLY_TEXNUMBER)
			rc = read_value(ply, e, p->type, &f->texnumber, err);
		else
			rc = skip_property(ply, e, p, err);
	}
	return rc;
}

static enum bake_status
corner_of(const struct ply *ply, const struct shared *shared, double index,
    struct bake_corner *c, struct bake_err *err)
{
	if (!(index >= 0.0) || index > INT_MAX || index != floor(index))
		return bake_fail(err, BAKE_EDATA,
		    "'%s': a face uses vertex %.10g, which cannot be",
		    ply->b->src->name, index);
	c->v = (int)index;
	c->vt = shared->uvs ? c->v : -1;
	c->vn = shared->normals ? c->v : -1;
	return BAKE_OK;
}

static int
material_of(const struct ply *ply, const struct face *f)
{
	if (ply->nmaterials == 0)
		return -1;
	return f->texnumber >= 0.0 && f->texnumber < ply->nmaterials
		   ? (int)f->texnumber
		   : -1;
}

static enum bake_status
add_face(struct ply *ply, const struct shared *shared, const struct face *f,
    struct bake_err *err)
{
	struct bake_corner c;
	enum bake_status rc;
	bool wedge = f->nuvs > 0;

	if (wedge && f->nuvs != 2 * f->nindices)
		return bake_fail(err, BAKE_EDATA,
		    "'%s': a face of %zu corners has %zu texcoords, "
		    "expected %zu",
		    ply->b->src->name, f->nindices, f->nuvs, 2 * f->nindices);
	for (size_t i = 0; i < f->nindices; i++) {
		rc = corner_of(ply, shared, f->index[i], &c, err);
		if (rc == BAKE_OK && wedge) {
			c.vt = (int)ply->b->mesh->nuvs;
			rc = bake_mesh_add_uv(ply->b, &f->uv[2 * i], err);
		}
		if (rc != BAKE_OK ||
		    (rc = bake_mesh_add_corner(ply->b, c, err)) != BAKE_OK)
			return rc;
	}
	return bake_mesh_end_face(ply->b, material_of(ply, f), err);
}

/* A strip: every triangle shares two corners with the one before, and every
 * other is turned round; -1 begins a new one. */
static enum bake_status
add_strip(struct ply *ply, const struct shared *shared, const struct face *f,
    struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;
	struct bake_corner c[3] = { { -1, -1, -1 }, { -1, -1, -1 },
		{ -1, -1, -1 } };
	size_t run = 0;

	for (size_t i = 0; rc == BAKE_OK && i < f->nindices; i++) {
		if (f->index[i] == -1.0) {
			run = 0;
			continue;
		}
		c[0] = c[1];
		c[1] = c[2];
		rc = corner_of(ply, shared, f->index[i], &c[2], err);
		if (rc != BAKE_OK || ++run < 3)
			continue;
		for (size_t k = 0; k < 3 && rc == BAKE_OK; k++)
			rc = bake_mesh_add_corner(
			    ply->b, c[run % 2 == 1 || k == 0 ? k : 3 - k], err);
		if (rc == BAKE_OK)
			rc = bake_mesh_end_face(ply->b, -1, err);
	}
	return rc;
}

static enum bake_status
read_faces(struct ply *ply, const struct ply_element *e,
    const struct shared *shared, struct bake_err *err)
{
	struct face f = { NULL, NULL, 0, 0, 0, 0, 0.0 };
	enum bake_status rc = BAKE_OK;

	if (!e->has[PLY_INDICES] && e->count > 0)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' has faces without vertex_indices", ply->b->src->name);
	for (size_t i = 0; rc == BAKE_OK && i < e->count; i++) {
		rc = read_face(ply, e, &f, err);
		if (rc != BAKE_OK)
			break;
		rc = e->kind == PLY_FACE ? add_face(ply, shared, &f, err)
					 : add_strip(ply, shared, &f, err);
	}
	free(f.index);
	free(f.uv);
	return rc;
}

/* -- the file ------------------------------------------------------------ */

static enum bake_status
read_element(struct ply *ply, const struct ply_element *e,
    const struct shared *shared, struct bake_err *err)
{
	size_t least = 0;
	enum bake_status rc = BAKE_OK;

	for (int k = 0; k < e->nproperties; k++)
		least += least_bytes(ply, e->property[k].list
					      ? e->property[k].count_type
					      : e->property[k].type);
	if (!can_hold(ply, e->count, least))
		return bake_fail(err, BAKE_EDATA,
		    "'%s' is truncated: %zu elements '%s' of at least %zu "
		    "bytes do not fit into the %zu that are left",
		    ply->b->src->name, e->count, e->name, least,
		    (size_t)(ply->t.end - ply->t.p));
	if (e->kind == PLY_VERTEX)
		return read_vertices(ply, e, err);
	if (e->kind == PLY_FACE || e->kind == PLY_STRIPS)
		return read_faces(ply, e, shared, err);
	if (e->kind == PLY_EDGE)
		ply->b->mesh->dropped.lines += e->count;
	/* an element without properties has no bytes, however many there are */
	for (size_t i = 0; rc == BAKE_OK && e->nproperties > 0 && i < e->count;
	     i++)
		for (int k = 0; rc == BAKE_OK && k < e->nproperties; k++)
			rc = skip_property(ply, e, &e->property[k], err);
	return rc;
}

/* UVs of corners come once for each face: make equal ones the same, so that
 * what meets in a vertex is one. */
static enum bake_status
merge_wedges(struct mesh_builder *b, struct bake_err *err)
{
	struct bake_mesh *m = b->mesh;
	int *first;

	if (m->nuvs == 0)
		return BAKE_OK;
	for (size_t i = 0; i < m->nuvs; i++)
		if (!isfinite(m->uvs[i][0]) || !isfinite(m->uvs[i][1]))
			return bake_fail(err, BAKE_EDATA,
			    "'%s': UV %zu is not finite", b->src->name, i);
	if ((first = bake_alloc(m->nuvs, sizeof *first, err)) == NULL)
		return BAKE_ENOMEM;
	if (bake_mesh_first_equal(
		(const double *)m->uvs, m->nuvs, 2, first, err) == 0) {
		free(first);
		return BAKE_ENOMEM;
	}
	for (size_t i = 0; i < b->ncorners; i++)
		if (b->corner[i].vt >= 0 && (size_t)b->corner[i].vt < m->nuvs)
			b->corner[i].vt = first[b->corner[i].vt];
	free(first);
	return BAKE_OK;
}

static enum bake_status
read_body(struct ply *ply, struct bake_err *err)
{
	struct shared shared = { false, false };
	bool wedges = false;
	enum bake_status rc = BAKE_OK;

	for (int i = 0; i < ply->nelements; i++) {
		const struct ply_element *e = &ply->element[i];

		if (e->kind == PLY_VERTEX) {
			shared.normals = has_all(e, PLY_NX, 3);
			shared.uvs = uv_roles(e) >= 0;
		}
		wedges = wedges || e->has[PLY_TEXCOORD];
	}
	for (int i = 0; rc == BAKE_OK && i < ply->nelements; i++) {
		/* with both, vertices come first, so that their UVs keep
		 * their numbers; everybody writes them so */
		if (wedges && shared.uvs && i > 0 &&
		    ply->element[i].kind == PLY_VERTEX)
			return bake_fail(err, BAKE_EDATA,
			    "'%s' has vertices with UVs after faces with "
			    "texcoord",
			    ply->b->src->name);
		rc = read_element(ply, &ply->element[i], &shared, err);
	}
	if (rc == BAKE_OK && wedges)
		rc = merge_wedges(ply->b, err);
	return rc;
}

enum bake_status
bake_mesh_read_ply(struct mesh_builder *b, struct bake_err *err)
{
	struct ply *ply = bake_zalloc(1, sizeof *ply, err);
	enum bake_status rc;

	if (ply == NULL)
		return BAKE_ENOMEM;
	ply->b = b;
	if ((rc = bake_mesh_text_init(
		 &ply->t, b->src->bytes, b->src->nbytes, err)) == BAKE_OK &&
	    (rc = bake_mesh_begin_part(b, 0, 0, 0, err)) == BAKE_OK &&
	    (rc = bake_ply_read_header(ply, err)) == BAKE_OK)
		rc = read_body(ply, err);
	bake_mesh_text_free(&ply->t);
	free(ply);
	return rc;
}
