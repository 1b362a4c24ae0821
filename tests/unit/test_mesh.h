/* Meshes in memory, for the unit tests that read and weld them. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_MESH_H
#define TEST_MESH_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>

#include "check.h"
#include "mesh.h"

static const struct bake_mesh_params no_side_files = { 1 << 30, 1 << 24, 0,
	false };

/* A growing text or file of bytes. */
struct blob {
	unsigned char *p;
	size_t n;
};

static inline void
blob_add(struct blob *b, const void *bytes, size_t n)
{
	b->p = realloc(b->p, b->n + n + 1);
	if (b->p == NULL)
		abort();
	memcpy(b->p + b->n, bytes, n);
	b->n += n;
	b->p[b->n] = '\0';
}

static inline void __attribute__((format(printf, 2, 3)))
blob_print(struct blob *b, const char *format, ...)
{
	char line[4096];
	va_list ap;
	int n;

	va_start(ap, format);
	n = vsnprintf(line, sizeof line, format, ap);
	va_end(ap);
	if (n < 0 || n >= (int)sizeof line)
		abort();
	blob_add(b, line, (size_t)n);
}

/* Read a mesh from bytes; the copy is of just that size, so that a sanitizer
 * sees a read beyond it. */
static inline enum bake_status
read_bytes(const void *bytes, size_t n, const char *name, struct bake_mesh *m,
    struct bake_err *err)
{
	unsigned char *copy = malloc(n > 0 ? n : 1);
	enum bake_status rc;

	if (copy == NULL)
		abort();
	memcpy(copy, bytes, n);
	*err = (struct bake_err)BAKE_ERR_INIT;
	rc = bake_mesh_read_memory(copy, n, name, &no_side_files, m, err);
	free(copy);
	CHECK((rc == BAKE_OK) == (m->ntriangles > 0));
	CHECK((rc == BAKE_OK) == (err->msg[0] == '\0'));
	CHECK(strchr(err->msg, '\n') == NULL);
	return rc;
}

static inline enum bake_status
read_text(const char *text, const char *name, struct bake_mesh *m,
    struct bake_err *err)
{
	return read_bytes(text, strlen(text), name, m, err);
}

/* Whether all that mesh.h promises of a mesh holds. */
static inline bool
is_valid(const struct bake_mesh *m)
{
	for (size_t i = 0; i < m->npositions; i++)
		for (int k = 0; k < 3; k++)
			if (!isfinite(m->positions[i][k]))
				return false;
	for (size_t i = 0; i < m->nuvs; i++)
		if (!isfinite(m->uvs[i][0]) || !isfinite(m->uvs[i][1]))
			return false;
	for (size_t i = 0; i < m->nnormals; i++) {
		const double *n = m->normals[i];
		double l2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];

		if (l2 != 0.0 && !(fabs(l2 - 1.0) < 1e-14))
			return false;
	}
	for (size_t i = 0; i < m->ntriangles; i++) {
		const struct bake_corner *t = m->triangles[i];

		for (int k = 0; k < 3; k++)
			if (t[k].v < 0 || t[k].v >= (int)m->npositions ||
			    t[k].vt < -1 || t[k].vt >= (int)m->nuvs ||
			    t[k].vn < -1 || t[k].vn >= (int)m->nnormals)
				return false;
		if (t[0].v == t[1].v || t[1].v == t[2].v || t[2].v == t[0].v)
			return false;
		if (m->material_of[i] < -1 ||
		    m->material_of[i] >= (int)m->nmaterials)
			return false;
	}
	return m->ntriangles > 0;
}

/* Read it, and say whether it is refused with a reason or a valid mesh. */
static inline bool
is_refused_or_valid(const void *bytes, size_t n, const char *name)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	bool ok = true;

	if (read_bytes(bytes, n, name, &m, &err) == BAKE_OK)
		ok = is_valid(&m);
	bake_mesh_free(&m);
	return ok;
}

static inline bool
corner_is(struct bake_corner c, int v, int vt, int vn)
{
	return c.v == v && c.vt == vt && c.vn == vn;
}

/* A number in 0..1 by chance (PCG). */
static inline double
chance(uint64_t *state)
{
	uint64_t x = *state =
	    *state * 6364136223846793005u + 1442695040888963407u;

	x ^= x >> 33;
	x *= 0xff51afd7ed558ccdu;
	x ^= x >> 33;
	return (double)(x >> 11) / 9007199254740992.0;
}

/* The sum of the triangles' areas. */
static inline double
area_of(const struct bake_mesh *m)
{
	double sum = 0.0;

	for (size_t i = 0; i < m->ntriangles; i++) {
		const double *a = m->positions[m->triangles[i][0].v],
			     *b = m->positions[m->triangles[i][1].v],
			     *c = m->positions[m->triangles[i][2].v];
		double n[3];

		for (int k = 0; k < 3; k++) {
			int k1 = (k + 1) % 3, k2 = (k + 2) % 3;

			n[k] = (b[k1] - a[k1]) * (c[k2] - a[k2]) -
			       (b[k2] - a[k2]) * (c[k1] - a[k1]);
		}
		sum += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	}
	return sum;
}

#endif
