/* glTF 2.0: accessors, the arrays of vertex data. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh_gltf_priv.h"

static size_t
component_size(size_t type)
{
	switch (type) {
	case BAKE_GLTF_INT8:
	case BAKE_GLTF_UINT8:
		return 1;
	case BAKE_GLTF_INT16:
	case BAKE_GLTF_UINT16:
		return 2;
	case BAKE_GLTF_UINT:
	case BAKE_GLTF_FLOAT:
		return 4;
	default:
		return 0;
	}
}

static double
component(const unsigned char *p, size_t type, bool normalized)
{
	uint32_t u = p[0];
	float f;

	if (component_size(type) > 1)
		u |= (uint32_t)p[1] << 8;
	if (component_size(type) > 2)
		u |= (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
	switch (type) {
	case BAKE_GLTF_INT8:
		return normalized ? fmax((int8_t)u / 127.0, -1.0) : (int8_t)u;
	case BAKE_GLTF_UINT8:
		return normalized ? u / 255.0 : u;
	case BAKE_GLTF_INT16:
		return normalized ? fmax((int16_t)u / 32767.0, -1.0)
				  : (int16_t)u;
	case BAKE_GLTF_UINT16:
		return normalized ? u / 65535.0 : u;
	case BAKE_GLTF_UINT:
		return u;
	default:
		memcpy(&f, &u, sizeof f);
		return (double)f;
	}
}

static int
component_count(const json_t *accessor)
{
	static const char *const names[] = { "SCALAR", "VEC2", "VEC3", "VEC4" };
	const char *type = json_string_value(json_object_get(accessor, "type"));

	for (int i = 0; type != NULL && i < 4; i++)
		if (strcmp(type, names[i]) == 0)
			return i + 1;
	return 0;
}

/* How values lie in a view. */
struct layout {
	size_t type, count;
	int ncomponents;
	bool normalized;
};

/* All values of a view from a byte offset on; out [count][ncomponents], NULL
 * to check only that they are there. */
static enum bake_status
read_view(struct gltf *g, size_t index, size_t offset, const struct layout *l,
    double *out, struct bake_err *err)
{
	const unsigned char *bytes;
	size_t n, stride, size = component_size(l->type);
	size_t element = size * (size_t)l->ncomponents;
	enum bake_status rc =
	    bake_mesh_gltf_view(g, index, &bytes, &n, &stride, err);

	if (rc != BAKE_OK)
		return rc;
	if (stride == 0)
		stride = element;
	if (offset > n || (l->count > 0 && element > n - offset) ||
	    (l->count > 1 && (n - offset - element) / stride < l->count - 1))
		return bake_fail(err, BAKE_EDATA,
		    "'%s': %zu values of %zu bytes do not fit into the %zu "
		    "bytes of bufferView %zu",
		    g->b->src->name, l->count, element, n, index);
	for (size_t i = 0; out != NULL && i < l->count; i++)
		for (int k = 0; k < l->ncomponents; k++)
			*out++ = component(
			    bytes + offset + i * stride + (size_t)k * size,
			    l->type, l->normalized);
	return BAKE_OK;
}

/* Values that replace some of the accessor's own. */
static enum bake_status
read_sparse(struct gltf *g, const json_t *sparse, const struct layout *l,
    double *values, struct bake_err *err)
{
	const json_t *at = json_object_get(sparse, "indices");
	const json_t *with = json_object_get(sparse, "values");
	struct layout li = { bake_gltf_size(at, "componentType", 0),
		bake_gltf_size(sparse, "count", SIZE_MAX), 1, false };
	struct layout lv = *l;
	size_t view_at = bake_gltf_size(at, "bufferView", SIZE_MAX);
	size_t view_with = bake_gltf_size(with, "bufferView", SIZE_MAX);
	double *index = NULL, *replaced = NULL;
	size_t nc = (size_t)l->ncomponents;
	enum bake_status rc;

	lv.count = li.count;
	if (li.count > l->count || component_size(li.type) == 0)
		return bake_fail(err, BAKE_EDATA,
		    "'%s' has a sparse accessor that is wrong",
		    g->b->src->name);
	index = bake_alloc(li.count, sizeof *index, err);
	replaced = bake_alloc(li.count, nc * sizeof *replaced, err);
	rc = index == NULL || replaced == NULL ? BAKE_ENOMEM : BAKE_OK;
	if (rc == BAKE_OK)
		rc = read_view(g, view_at, bake_gltf_size(at, "byteOffset", 0),
		    &li, index, err);
	if (rc == BAKE_OK)
		rc = read_view(g, view_with,
		    bake_gltf_size(with, "byteOffset", 0), &lv, replaced, err);
	for (size_t i = 0; rc == BAKE_OK && i < li.count; i++) {
		if (!(index[i] >= 0.0 && index[i] < (double)l->count)) {
			rc = bake_fail(err, BAKE_EDATA,
			    "'%s': a sparse accessor replaces value %g of "
			    "%zu",
			    g->b->src->name, index[i], l->count);
			break;
		}
		memcpy(values + (size_t)index[i] * nc, replaced + i * nc,
		    nc * sizeof *values);
	}
	free(index);
	free(replaced);
	return rc;
}

enum bake_status
bake_mesh_gltf_accessor(
    struct gltf *g, size_t index, struct gltf_values *out, struct bake_err *err)
{
	json_t *a = bake_mesh_gltf_item(g, "accessors", index, err);
	json_t *sparse = json_object_get(a, "sparse");
	struct layout l;
	size_t view, offset;
	enum bake_status rc;

	memset(out, 0, sizeof *out);
	if (a == NULL)
		return BAKE_EDATA;
	l.type = bake_gltf_size(a, "componentType", 0);
	l.count = bake_gltf_size(a, "count", SIZE_MAX);
	l.ncomponents = component_count(a);
	l.normalized = json_is_true(json_object_get(a, "normalized"));
	view = bake_gltf_size(a, "bufferView", SIZE_MAX);
	offset = bake_gltf_size(a, "byteOffset", 0);
	if (component_size(l.type) == 0 || l.ncomponents == 0 ||
	    l.count == SIZE_MAX)
		return bake_fail(err, BAKE_EDATA,
		    "'%s': accessor %zu is of an unknown type or count",
		    g->b->src->name, index);
	if (l.count > g->b->src->params->max_items)
		return bake_fail(err, BAKE_ELIMIT,
		    "'%s': accessor %zu has more than %zu values",
		    g->b->src->name, index, g->b->src->params->max_items);
	/* zeros that nothing in the file stands for are not worth memory */
	if (json_object_get(a, "bufferView") == NULL &&
	    (sparse == NULL || l.count / 16 > g->b->src->nbytes))
		return bake_fail(err, BAKE_EDATA,
		    "'%s': accessor %zu has no data", g->b->src->name, index);
	if (json_object_get(a, "bufferView") != NULL &&
	    (rc = read_view(g, view, offset, &l, NULL, err)) != BAKE_OK)
		return rc;
	out->values = bake_zalloc(
	    l.count, (size_t)l.ncomponents * sizeof *out->values, err);
	if (out->values == NULL)
		return BAKE_ENOMEM;
	out->count = l.count;
	out->ncomponents = l.ncomponents;
	rc = BAKE_OK;
	if (json_object_get(a, "bufferView") != NULL)
		rc = read_view(g, view, offset, &l, out->values, err);
	if (rc == BAKE_OK && sparse != NULL)
		rc = read_sparse(g, sparse, &l, out->values, err);
	return rc;
}
