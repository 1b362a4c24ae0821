/* The header of PLY files. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "mesh_ply_priv.h"

/* A line of the header, cut into words. */
enum { MAX_WORDS = 5 };
struct line {
	const char *p;
	size_t n;
	int nwords;
	const char *word[MAX_WORDS];
	size_t length[MAX_WORDS];
};

static const struct {
	const char *name;
	enum ply_type type;
} type_names[] = {
	{ "char", PLY_INT8 },
	{ "int8", PLY_INT8 },
	{ "uchar", PLY_UINT8 },
	{ "uint8", PLY_UINT8 },
	{ "short", PLY_INT16 },
	{ "int16", PLY_INT16 },
	{ "ushort", PLY_UINT16 },
	{ "uint16", PLY_UINT16 },
	{ "int", PLY_INT32 },
	{ "int32", PLY_INT32 },
	{ "uint", PLY_UINT32 },
	{ "uint32", PLY_UINT32 },
	{ "float", PLY_FLOAT },
	{ "float32", PLY_FLOAT },
	{ "double", PLY_DOUBLE },
	{ "float64", PLY_DOUBLE },
};

static const struct {
	const char *name;
	enum ply_role role;
} vertex_roles[] = {
	{ "x", PLY_X },
	{ "y", PLY_Y },
	{ "z", PLY_Z },
	{ "nx", PLY_NX },
	{ "ny", PLY_NY },
	{ "nz", PLY_NZ },
	{ "s", PLY_S },
	{ "t", PLY_T },
	{ "u", PLY_U },
	{ "v", PLY_V },
	{ "texture_u", PLY_TEXTURE_U },
	{ "texture_v", PLY_TEXTURE_V },
	{ "tx", PLY_TX },
	{ "ty", PLY_TY },
	{ "tz", PLY_TZ },
	{ "hand", PLY_HAND },
	{ "red", PLY_RED },
	{ "diffuse_red", PLY_RED },
	{ "green", PLY_GREEN },
	{ "diffuse_green", PLY_GREEN },
	{ "blue", PLY_BLUE },
	{ "diffuse_blue", PLY_BLUE },
	{ "alpha", PLY_ALPHA },
};

static const struct {
	const char *name;
	enum ply_kind kind;
} kinds[] = {
	{ "vertex", PLY_VERTEX },
	{ "face", PLY_FACE },
	{ "tristrips", PLY_STRIPS },
	{ "edge", PLY_EDGE },
};

#define COUNT(a) (sizeof(a) / sizeof *(a))

size_t
bake_ply_type_size(enum ply_type type)
{
	static const size_t sizes[PLY_NTYPES] = { 1, 1, 2, 2, 4, 4, 4, 8 };

	return sizes[type];
}

static bool
is_word(const struct line *l, int i, const char *text)
{
	return i < l->nwords && strlen(text) == l->length[i] &&
	       memcmp(text, l->word[i], l->length[i]) == 0;
}

static enum bake_status
bad_line(const struct ply *ply, const char *what, struct bake_err *err)
{
	return bake_fail(err, BAKE_EDATA, "'%s' line %zu: %s",
	    ply->b->src->name, ply->t.line, what);
}

/* The line at t->p without its end, which may be LF, CR LF or CR; t->p is
 * behind it. False where no line ends. */
static bool
next_line(struct mesh_text *t, struct line *l)
{
	l->p = t->p;
	while (t->p < t->end && *t->p != '\n' && *t->p != '\r')
		t->p++;
	if (t->p == t->end)
		return false;
	l->n = (size_t)(t->p - l->p);
	if (*t->p == '\r' && t->p + 1 < t->end && t->p[1] == '\n')
		t->p++;
	t->p++;
	l->nwords = 0;
	for (const char *p = l->p, *end = l->p + l->n; l->nwords < MAX_WORDS;
	     l->nwords++) {
		while (p < end && (*p == ' ' || *p == '\t'))
			p++;
		if (p == end)
			break;
		l->word[l->nwords] = p;
		while (p < end && *p != ' ' && *p != '\t')
			p++;
		l->length[l->nwords] = (size_t)(p - l->word[l->nwords]);
	}
	return true;
}

static enum bake_status
read_format(struct ply *ply, const struct line *l, struct bake_err *err)
{
	if (is_word(l, 1, "ascii"))
		ply->format = PLY_ASCII;
	else if (is_word(l, 1, "binary_little_endian"))
		ply->format = PLY_LITTLE;
	else if (is_word(l, 1, "binary_big_endian"))
		ply->format = PLY_BIG;
	else
		return bad_line(ply, "unknown format", err);
	if (!is_word(l, 2, "1.0"))
		return bad_line(ply, "the version is not 1.0", err);
	return BAKE_OK;
}

static enum bake_status
read_element(struct ply *ply, const struct line *l, struct bake_err *err)
{
	struct ply_element *e;
	struct mesh_text t = ply->t;
	int64_t count;

	if (ply->nelements == PLY_ELEMENTS)
		return bad_line(ply, "more than 32 elements", err);
	if (l->nwords != 3 || l->length[1] >= PLY_NAME)
		return bad_line(ply, "expected 'element NAME COUNT'", err);
	t.p = l->word[2];
	t.end = l->word[2] + l->length[2];
	if (bake_mesh_scan_int(&t, &count) != MESH_NUMBER || t.p != t.end ||
	    count < 0)
		return bad_line(ply, "an element's count is no number", err);
	e = &ply->element[ply->nelements++];
	e->count = (size_t)count;
	memcpy(e->name, l->word[1], l->length[1]);
	e->kind = PLY_OTHER;
	for (size_t i = 0; i < COUNT(kinds); i++)
		if (is_word(l, 1, kinds[i].name))
			e->kind = kinds[i].kind;
	for (int i = 0; i + 1 < ply->nelements; i++)
		if (e->kind != PLY_OTHER && ply->element[i].kind == e->kind)
			return bad_line(ply, "this element comes twice", err);
	return BAKE_OK;
}

static bool
find_type(const struct line *l, int word, enum ply_type *type)
{
	for (size_t i = 0; i < COUNT(type_names); i++)
		if (is_word(l, word, type_names[i].name)) {
			*type = type_names[i].type;
			return true;
		}
	return false;
}

static enum ply_role
find_role(
    const struct ply_element *e, const struct line *l, int word, bool list)
{
	if (e->kind == PLY_VERTEX && !list)
		for (size_t i = 0; i < COUNT(vertex_roles); i++)
			if (is_word(l, word, vertex_roles[i].name))
				return vertex_roles[i].role;
	if (e->kind != PLY_FACE && e->kind != PLY_STRIPS)
		return PLY_UNKNOWN;
	if (list && (is_word(l, word, "vertex_indices") ||
			is_word(l, word, "vertex_index")))
		return PLY_INDICES;
	if (list && is_word(l, word, "texcoord"))
		return PLY_TEXCOORD;
	if (!list && is_word(l, word, "texnumber"))
		return PLY_TEXNUMBER;
	return PLY_UNKNOWN;
}

static enum bake_status
read_property(struct ply *ply, const struct line *l, struct bake_err *err)
{
	struct ply_element *e;
	struct ply_property p = { PLY_INT8, PLY_INT8, false, PLY_UNKNOWN };

	if (ply->nelements == 0)
		return bad_line(ply, "a property before any element", err);
	e = &ply->element[ply->nelements - 1];
	if (e->nproperties == PLY_PROPERTIES)
		return bad_line(ply, "more than 128 properties", err);
	p.list = is_word(l, 1, "list");
	if (l->nwords != (p.list ? 5 : 3))
		return bad_line(ply, "expected 'property TYPE NAME'", err);
	if (!find_type(l, p.list ? 3 : 1, &p.type) ||
	    (p.list && !find_type(l, 2, &p.count_type)))
		return bad_line(ply, "unknown type of a property", err);
	if (p.list && p.count_type >= PLY_FLOAT)
		return bad_line(ply, "a list's length is no whole number", err);
	p.role = find_role(e, l, p.list ? 4 : 2, p.list);
	if (p.role != PLY_UNKNOWN && e->has[p.role])
		return bad_line(ply, "this property comes twice", err);
	if (p.role != PLY_UNKNOWN)
		e->has[p.role] = true;
	e->property[e->nproperties++] = p;
	return BAKE_OK;
}

/* 'comment TextureFile NAME' is what MeshLab and Meshroom write. */
static enum bake_status
read_comment(struct ply *ply, const struct line *l, struct bake_err *err)
{
	struct bake_material *mat;
	const char *end = l->p + l->n;
	enum bake_status rc;
	int index;

	if (!is_word(l, 1, "TextureFile") || l->nwords < 3)
		return BAKE_OK;
	while (end > l->word[2] && (end[-1] == ' ' || end[-1] == '\t'))
		end--;
	rc = bake_mesh_add_material(
	    ply->b, l->word[2], (size_t)(end - l->word[2]), &index, err);
	if (rc != BAKE_OK)
		return rc;
	mat = &ply->b->mesh->materials[index];
	mat->texture.path = bake_mesh_join_path(
	    ply->b->src->name, l->word[2], (size_t)(end - l->word[2]), err);
	ply->nmaterials++;
	return mat->texture.path != NULL ? BAKE_OK : BAKE_ENOMEM;
}

static enum bake_status
read_line(struct ply *ply, const struct line *l, bool *has_format,
    struct bake_err *err)
{
	if (is_word(l, 0, "format")) {
		*has_format = true;
		return read_format(ply, l, err);
	}
	if (is_word(l, 0, "element"))
		return read_element(ply, l, err);
	if (is_word(l, 0, "property"))
		return read_property(ply, l, err);
	if (is_word(l, 0, "comment"))
		return read_comment(ply, l, err);
	if (is_word(l, 0, "obj_info") || l->nwords == 0)
		return BAKE_OK;
	return bad_line(ply, "this is no statement of a header", err);
}

enum bake_status
bake_ply_read_header(struct ply *ply, struct bake_err *err)
{
	struct line l;
	bool has_format = false;
	enum bake_status rc;

	if (!next_line(&ply->t, &l) || !is_word(&l, 0, "ply") || l.nwords != 1)
		return bad_line(ply, "this is no PLY file", err);
	for (ply->t.line++; next_line(&ply->t, &l); ply->t.line++) {
		if (is_word(&l, 0, "end_header")) {
			ply->t.line++;
			return has_format ? BAKE_OK
					  : bad_line(ply, "no format", err);
		}
		if ((rc = read_line(ply, &l, &has_format, err)) != BAKE_OK)
			return rc;
	}
	return bake_fail(err, BAKE_EDATA, "'%s' has no end_header: truncated",
	    ply->b->src->name);
}
