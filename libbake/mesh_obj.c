/* A strict reader of Wavefront OBJ files. */
/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh_obj_priv.h"

enum { MAX_LIBRARIES = 64 };

/* The largest index that was used, and where: an index may come before what
 * it names. */
struct seen {
	int64_t largest;
	size_t line;
};

struct obj {
	struct mesh_builder *b;
	struct mesh_text t;
	struct obj_names names;
	int material, nlibraries;
	struct seen v, vt, vn;
};

/* -- words --------------------------------------------------------------- */

static bool
is_newline(char c)
{
	return c == '\n' || c == '\r';
}

/* Past one line end: LF, CR LF or CR. */
static void
pass_newline(struct mesh_text *t)
{
	if (*t->p == '\r' && t->p + 1 < t->end && t->p[1] == '\n')
		t->p++;
	t->p++;
	t->line++;
}

static bool
at_continuation(const struct mesh_text *t)
{
	return *t->p == '\\' && t->p + 1 < t->end && is_newline(t->p[1]);
}

void
bake_obj_skip_space(struct mesh_text *t)
{
	while (t->p < t->end) {
		if (*t->p == ' ' || *t->p == '\t' || *t->p == '\v' ||
		    *t->p == '\f') {
			t->p++;
		} else if (at_continuation(t)) {
			t->p++;
			pass_newline(t);
		} else {
			break;
		}
	}
}

bool
bake_obj_at_end(const struct mesh_text *t)
{
	return t->p >= t->end || is_newline(*t->p) || *t->p == '#';
}

void
bake_obj_next_line(struct mesh_text *t)
{
	bool comment = false;

	for (; t->p < t->end && !is_newline(*t->p); t->p++) {
		comment = comment || *t->p == '#';
		/* a drawing in a comment may well end in a backslash */
		if (!comment && at_continuation(t)) {
			t->p++;
			pass_newline(t);
			t->p--;
		}
	}
	if (t->p < t->end)
		pass_newline(t);
}

static bool
ends_word(const struct mesh_text *t)
{
	return bake_obj_at_end(t) || *t->p == ' ' || *t->p == '\t' ||
	       *t->p == '\v' || *t->p == '\f' || at_continuation(t);
}

struct obj_word
bake_obj_next_word(struct mesh_text *t)
{
	struct obj_word w;

	bake_obj_skip_space(t);
	w.p = t->p;
	while (!ends_word(t))
		t->p++;
	w.n = (size_t)(t->p - w.p);
	return w;
}

struct obj_word
bake_obj_rest(struct mesh_text *t)
{
	struct obj_word w;

	bake_obj_skip_space(t);
	w.p = t->p;
	while (t->p < t->end && !is_newline(*t->p))
		t->p++;
	w.n = (size_t)(t->p - w.p);
	while (w.n > 0 && (w.p[w.n - 1] == ' ' || w.p[w.n - 1] == '\t'))
		w.n--;
	return w;
}

bool
bake_obj_is(struct obj_word word, const char *text)
{
	return strlen(text) == word.n && memcmp(word.p, text, word.n) == 0;
}

int
bake_obj_numbers(struct mesh_text *t, double *x, int max)
{
	int n = 0;
	double ignored;

	for (bake_obj_skip_space(t); !bake_obj_at_end(t);
	     bake_obj_skip_space(t)) {
		if (bake_mesh_scan_double(t, n < max ? &x[n] : &ignored) !=
			MESH_NUMBER ||
		    !ends_word(t))
			return -1;
		if (n < max)
			n++;
	}
	return n;
}

/* -- materials ----------------------------------------------------------- */

static size_t
hash_word(struct obj_word w)
{
	/* FNV-1a */
	uint64_t h = 0xcbf29ce484222325u;

	for (size_t i = 0; i < w.n; i++)
		h = (h ^ (unsigned char)w.p[i]) * 0x100000001b3u;
	return (size_t)(h ^ h >> 32);
}

static size_t
find_name(const struct bake_mesh *m, const struct obj_names *names,
    struct obj_word name)
{
	size_t mask = names->size - 1, s = hash_word(name) & mask;

	while (names->slots[s] >= 0 &&
	       !bake_obj_is(name, m->materials[names->slots[s]].name))
		s = (s + 1) & mask;
	return s;
}

static enum bake_status
grow_names(
    const struct bake_mesh *m, struct obj_names *names, struct bake_err *err)
{
	size_t size = names->size > 0 ? 2 * names->size : 64;
	int *slots = bake_alloc(size, sizeof *slots, err);

	if (slots == NULL)
		return BAKE_ENOMEM;
	memset(slots, 0xff, size * sizeof *slots);
	free(names->slots);
	names->slots = slots;
	names->size = size;
	for (size_t i = 0; i < m->nmaterials; i++) {
		struct obj_word w = { m->materials[i].name,
			strlen(m->materials[i].name) };

		slots[find_name(m, names, w)] = (int)i;
	}
	return BAKE_OK;
}

enum bake_status
bake_obj_material(struct mesh_builder *b, struct obj_names *names,
    struct obj_word name, int *index, struct bake_err *err)
{
	enum bake_status rc;
	size_t s;

	if (2 * names->used >= names->size &&
	    (rc = grow_names(b->mesh, names, err)) != BAKE_OK)
		return rc;
	s = find_name(b->mesh, names, name);
	if (names->slots[s] < 0) {
		rc = bake_mesh_add_material(b, name.p, name.n, index, err);
		if (rc != BAKE_OK)
			return rc;
		names->slots[s] = *index;
		names->used++;
	}
	*index = names->slots[s];
	return BAKE_OK;
}

/* Read one material file. *found tells whether it could be opened: a missing
 * one is counted, not an error. */
static enum bake_status
read_library(
    struct obj *o, struct obj_word name, bool *found, struct bake_err *err)
{
	const struct mesh_source *src = o->b->src;
	struct bake_err why = BAKE_ERR_INIT;
	unsigned char *bytes = NULL;
	size_t nbytes = 0;
	char *path = bake_mesh_join_path(src->name, name.p, name.n, err);
	enum bake_status rc = BAKE_OK;

	*found = false;
	if (path == NULL)
		return BAKE_ENOMEM;
	for (size_t i = 0; i < o->b->mesh->nfiles; i++)
		if (strcmp(o->b->mesh->files[i], path) == 0) {
			*found = true;
			goto out;
		}
	rc = bake_mesh_load_file(
	    path, src->params->max_bytes, &bytes, &nbytes, &why);
	if (rc != BAKE_OK) {
		rc = rc == BAKE_ENOMEM ? bake_fail(err, rc, "%s", why.msg)
				       : BAKE_OK;
		goto out;
	}
	*found = true;
	if ((rc = bake_mesh_add_file(o->b, path, err)) == BAKE_OK)
		rc = bake_obj_read_materials(
		    o->b, &o->names, path, bytes, nbytes, err);
out:
	free(bytes);
	free(path);
	return rc;
}

/* One name that may hold spaces, or several that do not. */
static enum bake_status
read_mtllib(struct obj *o, struct bake_err *err)
{
	struct mesh_text words = o->t;
	struct obj_word name;
	enum bake_status rc;
	bool found;

	bake_obj_skip_space(&words);
	name = bake_obj_rest(&o->t);
	if (name.n == 0)
		return BAKE_OK;
	if (!o->b->src->params->side_files ||
	    o->nlibraries++ >= MAX_LIBRARIES) {
		o->b->mesh->dropped.missing_files++;
		return BAKE_OK;
	}
	rc = read_library(o, name, &found, err);
	if (rc != BAKE_OK || found)
		return rc;
	words.end = name.p + name.n;
	name = bake_obj_next_word(&words);
	if (words.p >= words.end) {
		o->b->mesh->dropped.missing_files++;
		return BAKE_OK;
	}
	for (; name.n > 0 && o->nlibraries++ < MAX_LIBRARIES;
	     name = bake_obj_next_word(&words)) {
		if ((rc = read_library(o, name, &found, err)) != BAKE_OK)
			return rc;
		o->b->mesh->dropped.missing_files += !found;
	}
	return BAKE_OK;
}

/* -- statements ---------------------------------------------------------- */

static enum bake_status
bad_line(const struct obj *o, struct bake_err *err, const char *what)
{
	return bake_fail(err, BAKE_EDATA, "'%s' line %zu: %s", o->b->src->name,
	    o->t.line, what);
}

static bool
all_finite(const double *x, int n)
{
	for (int k = 0; k < n; k++)
		if (!isfinite(x[k]))
			return false;
	return true;
}

static enum bake_status
read_vertex(struct obj *o, struct bake_err *err)
{
	double x[8];
	int n = bake_obj_numbers(&o->t, x, 8);
	enum bake_status rc;

	if (n < 3)
		return bad_line(o, err, "a vertex needs 3 numbers");
	if (!all_finite(x, 3))
		return bad_line(o, err, "a coordinate is not finite");
	rc = bake_mesh_add_position(o->b, x, err);
	/* x y z r g b, and with an alpha; a lone fourth number is a weight */
	if (rc == BAKE_OK && (n == 6 || n == 7)) {
		float rgba[4] = { (float)x[3], (float)x[4], (float)x[5],
			n == 7 ? (float)x[6] : 1.0f };

		rc = bake_mesh_set_color(
		    o->b, o->b->mesh->npositions - 1, rgba, err);
	}
	return rc;
}

static enum bake_status
read_uv(struct obj *o, struct bake_err *err)
{
	double x[3] = { 0.0, 0.0, 0.0 };
	int n = bake_obj_numbers(&o->t, x, 3);

	if (n < 1)
		return bad_line(o, err, "a UV needs 1 to 3 numbers");
	if (!all_finite(x, 2))
		return bad_line(o, err, "a UV is not finite");
	return bake_mesh_add_uv(o->b, x, err);
}

static enum bake_status
read_normal(struct obj *o, struct bake_err *err)
{
	double x[3];

	if (bake_obj_numbers(&o->t, x, 3) < 3)
		return bad_line(o, err, "a normal needs 3 numbers");
	return bake_mesh_add_normal(o->b, x, err);
}

/* One index of a corner, where it is there: -1 where not. */
static enum bake_status
read_index(struct obj *o, size_t count, struct seen *seen, int *index,
    struct bake_err *err)
{
	int64_t i;

	*index = -1;
	if (ends_word(&o->t) || *o->t.p == '/')
		return BAKE_OK;
	if (bake_mesh_scan_int(&o->t, &i) != MESH_NUMBER ||
	    (!ends_word(&o->t) && *o->t.p != '/'))
		return bad_line(o, err, "an index is no whole number");
	/* from the end of those so far; 0 is none */
	if (i < 0 ? -i > (int64_t)count : i == 0 || i > INT_MAX)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' line %zu: index %jd is out of range, %zu are defined",
		    o->b->src->name, o->t.line, (intmax_t)i, count);
	i = i < 0 ? (int64_t)count + i + 1 : i;
	if (i > seen->largest) {
		seen->largest = i;
		seen->line = o->t.line;
	}
	*index = (int)(i - 1);
	return BAKE_OK;
}

static enum bake_status
read_corner(struct obj *o, struct bake_corner *c, struct bake_err *err)
{
	const struct bake_mesh *m = o->b->mesh;
	enum bake_status rc;

	c->vt = c->vn = -1;
	rc = read_index(o, m->npositions, &o->v, &c->v, err);
	if (rc == BAKE_OK && c->v < 0)
		rc = bad_line(o, err, "a corner has no vertex");
	if (rc != BAKE_OK || ends_word(&o->t))
		return rc;
	o->t.p++;
	rc = read_index(o, m->nuvs, &o->vt, &c->vt, err);
	if (rc != BAKE_OK || ends_word(&o->t))
		return rc;
	o->t.p++;
	rc = read_index(o, m->nnormals, &o->vn, &c->vn, err);
	if (rc == BAKE_OK && !ends_word(&o->t))
		rc = bad_line(o, err, "a corner has more than 3 indices");
	return rc;
}

static enum bake_status
read_face(struct obj *o, struct bake_err *err)
{
	struct bake_corner c;
	enum bake_status rc;

	for (bake_obj_skip_space(&o->t); !bake_obj_at_end(&o->t);
	     bake_obj_skip_space(&o->t)) {
		if ((rc = read_corner(o, &c, err)) != BAKE_OK ||
		    (rc = bake_mesh_add_corner(o->b, c, err)) != BAKE_OK)
			return rc;
	}
	return bake_mesh_end_face(o->b, o->material, err);
}

static enum bake_status
read_usemtl(struct obj *o, struct bake_err *err)
{
	struct obj_word name = bake_obj_rest(&o->t);

	o->material = -1;
	if (name.n == 0)
		return BAKE_OK;
	return bake_obj_material(o->b, &o->names, name, &o->material, err);
}

static enum bake_status
read_statement(struct obj *o, struct bake_err *err)
{
	struct obj_word w = bake_obj_next_word(&o->t);

	if (bake_obj_is(w, "v"))
		return read_vertex(o, err);
	if (bake_obj_is(w, "f") || bake_obj_is(w, "fo"))
		return read_face(o, err);
	if (bake_obj_is(w, "vt"))
		return read_uv(o, err);
	if (bake_obj_is(w, "vn"))
		return read_normal(o, err);
	if (bake_obj_is(w, "usemtl"))
		return read_usemtl(o, err);
	if (bake_obj_is(w, "mtllib"))
		return read_mtllib(o, err);
	if (bake_obj_is(w, "p"))
		o->b->mesh->dropped.points++;
	else if (bake_obj_is(w, "l"))
		o->b->mesh->dropped.lines++;
	else if (w.n > 0 && !((*w.p >= 'a' && *w.p <= 'z') ||
				(*w.p >= 'A' && *w.p <= 'Z')))
		/* other words are statements of curves, display, vendors */
		return bad_line(o, err, "a statement begins with a word");
	return BAKE_OK;
}

static enum bake_status
check_seen(const struct obj *o, const struct seen *seen, size_t count,
    const char *what, struct bake_err *err)
{
	if (seen->largest <= (int64_t)count)
		return BAKE_OK;
	return bake_fail(err, BAKE_EDATA,
	    "'%s' line %zu: a face uses %s %jd, the file has %zu",
	    o->b->src->name, seen->line, what, (intmax_t)seen->largest, count);
}

static enum bake_status
check_text(const struct mesh_source *src, struct bake_err *err)
{
	const unsigned char *nul = memchr(src->bytes, 0, src->nbytes);

	if (nul == NULL)
		return BAKE_OK;
	return bake_fail(err, BAKE_EDATA,
	    "'%s' is no OBJ file: byte %zu is 0, expected text", src->name,
	    (size_t)(nul - src->bytes));
}

enum bake_status
bake_mesh_read_obj(struct mesh_builder *b, struct bake_err *err)
{
	struct obj o;
	const struct bake_mesh *m = b->mesh;
	enum bake_status rc;

	memset(&o, 0, sizeof o);
	o.b = b;
	o.material = -1;
	if ((rc = check_text(b->src, err)) != BAKE_OK ||
	    (rc = bake_mesh_text_init(
		 &o.t, b->src->bytes, b->src->nbytes, err)) != BAKE_OK ||
	    (rc = bake_mesh_begin_part(b, 0, 0, 0, err)) != BAKE_OK)
		goto out;
	/* a byte order mark */
	if (b->src->nbytes >= 3 && memcmp(o.t.p, "\xef\xbb\xbf", 3) == 0)
		o.t.p += 3;
	while (o.t.p < o.t.end) {
		if ((rc = read_statement(&o, err)) != BAKE_OK)
			goto out;
		bake_obj_next_line(&o.t);
	}
	if ((rc = check_seen(&o, &o.v, m->npositions, "vertex", err)) !=
		BAKE_OK ||
	    (rc = check_seen(&o, &o.vt, m->nuvs, "UV", err)) != BAKE_OK)
		goto out;
	rc = check_seen(&o, &o.vn, m->nnormals, "normal", err);
out:
	bake_mesh_text_free(&o.t);
	free(o.names.slots);
	return rc;
}
