/* glTF files: a small one, made of a mesh. */
/* SPDX-License-Identifier: MIT */
#include <float.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "gltf_priv.h"
#include "mem.h"

static float
to_float(double v)
{
	return v > (double)FLT_MAX    ? FLT_MAX
	       : v < -(double)FLT_MAX ? -FLT_MAX
				      : (float)v;
}

/* One attribute of a frame. */
struct attribute {
	const char *name, *type;
	int nvalues;
	void (*get)(const struct bake_mesh *mesh, const struct bake_frame *f,
	    float *out);
};

static void
get_position(
    const struct bake_mesh *mesh, const struct bake_frame *f, float *out)
{
	for (int c = 0; c < 3; c++)
		out[c] = to_float(mesh->positions[f->v][c]);
}

static void
get_normal(const struct bake_mesh *mesh, const struct bake_frame *f, float *out)
{
	(void)mesh;
	for (int c = 0; c < 3; c++)
		out[c] = to_float(f->normal[c]);
}

static void
get_tangent(
    const struct bake_mesh *mesh, const struct bake_frame *f, float *out)
{
	(void)mesh;
	for (int c = 0; c < 3; c++)
		out[c] = to_float(f->tangent[c]);
	out[3] = (float)f->hand;
}

static void
get_uv(const struct bake_mesh *mesh, const struct bake_frame *f, float *out)
{
	out[0] = out[1] = 0;
	if (f->vt >= 0) {
		out[0] = to_float(mesh->uvs[f->vt][0]);
		out[1] = to_float(1 - mesh->uvs[f->vt][1]);
	}
}

static const struct attribute attributes[] = {
	{ "POSITION", "VEC3", 3, get_position },
	{ "NORMAL", "VEC3", 3, get_normal },
	{ "TANGENT", "VEC4", 4, get_tangent },
	{ "TEXCOORD_0", "VEC2", 2, get_uv },
};
enum { POSITION, NORMAL, TANGENT, TEXCOORD };

/* An accessor needs the range of its positions. */
static bool
put_bounds(json_t *accessor, const float *values, size_t n)
{
	float lo[3], hi[3];
	json_t *range;

	memcpy(lo, values, sizeof lo);
	memcpy(hi, values, sizeof hi);
	for (size_t i = 0; i < 3 * n; i++) {
		lo[i % 3] = values[i] < lo[i % 3] ? values[i] : lo[i % 3];
		hi[i % 3] = values[i] > hi[i % 3] ? values[i] : hi[i % 3];
	}
	range = json_pack("[fff]", (double)lo[0], (double)lo[1], (double)lo[2]);
	if (json_object_set_new(accessor, "min", range) != 0)
		return false;
	range = json_pack("[fff]", (double)hi[0], (double)hi[1], (double)hi[2]);
	return json_object_set_new(accessor, "max", range) == 0;
}

static bool
add_attribute(struct bake_gltf *g, json_t *primitive, const struct attribute *a,
    const struct bake_mesh *mesh, const struct bake_frames *frames,
    struct bake_err *err)
{
	size_t n = frames->nframes, size = sizeof(float) * (size_t)a->nvalues;
	float *values = bake_alloc(n, size, err);
	json_t *accessor;
	json_int_t i;
	bool ok;

	if (values == NULL)
		return false;
	for (size_t k = 0; k < n; k++)
		a->get(
		    mesh, &frames->frame[k], values + k * (size_t)a->nvalues);
	i = bake_gltf_add_accessor(g,
	    bake_gltf_add_view(g, values, n * size, BAKE_GLTF_ARRAY),
	    BAKE_GLTF_FLOAT, n, a->type, &accessor);
	ok = i >= 0 &&
	     json_object_set_new(json_object_get(primitive, "attributes"),
		 a->name, json_integer(i)) == 0 &&
	     (a != &attributes[POSITION] || put_bounds(accessor, values, n));
	free(values);
	return ok;
}

static bool
add_indices(
    struct bake_gltf *g, json_t *primitive, const struct bake_frames *frames)
{
	size_t n = 3 * frames->ntriangles;
	json_t *accessor;
	json_int_t i;

	/* frame_of is [ntriangles][3] ints, none negative */
	i = bake_gltf_add_accessor(g,
	    bake_gltf_add_view(
		g, frames->frame_of, n * sizeof(uint32_t), BAKE_GLTF_ELEMENTS),
	    BAKE_GLTF_UINT, n, "SCALAR", &accessor);
	return i >= 0 &&
	       json_object_set_new(primitive, "indices", json_integer(i)) == 0;
}

enum bake_status
bake_gltf_make(const struct bake_mesh *mesh, const struct bake_frames *frames,
    struct bake_gltf **gltf, struct bake_err *err)
{
	int nattributes = mesh->nuvs > 0 ? 4 : 3;
	struct bake_gltf *g;
	json_t *primitive;
	bool ok;

	*gltf = NULL;
	if (frames->ntriangles == 0 || frames->nframes >= UINT32_MAX)
		return bake_fail(err, BAKE_EDATA,
		    "%zu triangles and %zu vertices make no glTF primitive",
		    frames->ntriangles, frames->nframes);
	g = bake_zalloc(1, sizeof *g, err);
	if (g == NULL)
		return BAKE_ENOMEM;
	g->folder = strdup("");
	g->root = json_pack("{s{ssss} si s[{s[i]}] s[{si}] s[{s[{s{}}]}]}",
	    "asset", "version", "2.0", "generator", "relief-tools", "scene", 0,
	    "scenes", "nodes", 0, "nodes", "mesh", 0, "meshes", "primitives",
	    "attributes");
	primitive = json_array_get(
	    json_object_get(
		json_array_get(json_object_get(g->root, "meshes"), 0),
		"primitives"),
	    0);
	ok = g->folder != NULL && primitive != NULL;
	for (int i = 0; i < nattributes && ok; i++)
		ok = add_attribute(
		    g, primitive, &attributes[i], mesh, frames, err);
	if (!ok || !add_indices(g, primitive, frames)) {
		bake_gltf_free(g);
		return bake_fail(err, BAKE_ENOMEM, "no memory");
	}
	*gltf = g;
	return BAKE_OK;
}
