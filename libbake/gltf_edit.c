/* glTF files: attributes added, and meshes looked at on their own. */
/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "gltf_priv.h"

/* Set a member to a new value, which may be NULL for lack of memory. */
static bool
put(json_t *object, const char *key, json_t *value)
{
	return json_object_set_new(object, key, value) == 0;
}

json_t *
bake_gltf_array(json_t *object, const char *member)
{
	json_t *array = json_object_get(object, member);

	if (json_is_array(array))
		return array;
	array = json_array();
	return put(object, member, array) ? array : NULL;
}

/* Append an empty object; its index, or -1. */
static json_int_t
append_object(json_t *array, json_t **object)
{
	*object = json_object();
	if (array == NULL || json_array_append_new(array, *object) != 0)
		return -1;
	return (json_int_t)json_array_size(array) - 1;
}

json_int_t
bake_gltf_add_view(struct bake_gltf *g, const void *data, size_t n, int target)
{
	size_t at = g->added.n;
	json_t *view;
	json_int_t i =
	    append_object(bake_gltf_array(g->root, "bufferViews"), &view);

	if (i < 0 || !bake_gltf_append(&g->added, data, n) ||
	    !bake_gltf_pad(&g->added, 0) ||
	    !put(view, "buffer", json_integer((json_int_t)g->nbuffers)) ||
	    !put(view, "byteOffset", json_integer((json_int_t)at)) ||
	    !put(view, "byteLength", json_integer((json_int_t)n)) ||
	    !put(view, "target", json_integer(target)))
		return -1;
	return i;
}

json_int_t
bake_gltf_add_accessor(struct bake_gltf *g, json_int_t view, int component_type,
    size_t count, const char *type, json_t **accessor)
{
	json_int_t i =
	    append_object(bake_gltf_array(g->root, "accessors"), accessor);

	if (view < 0 || i < 0 ||
	    !put(*accessor, "bufferView", json_integer(view)) ||
	    !put(*accessor, "componentType", json_integer(component_type)) ||
	    !put(*accessor, "count", json_integer((json_int_t)count)) ||
	    !put(*accessor, "type", json_string(type)))
		return -1;
	return i;
}

static json_t *
primitive_of(const struct bake_gltf *g, int mesh, int primitive)
{
	json_t *m =
	    json_array_get(json_object_get(g->root, "meshes"), (size_t)mesh);

	return mesh < 0 || primitive < 0
		   ? NULL
		   : json_array_get(
			 json_object_get(m, "primitives"), (size_t)primitive);
}

/* The file's own attributes; those of applications begin with '_'. */
static bool
own_attributes_equal(json_t *a, json_t *b)
{
	const char *key;
	json_t *value;
	size_t na = 0, nb = 0;

	json_object_foreach(a, key, value)
	{
		na += *key != '_';
		if (*key != '_' && !json_equal(value, json_object_get(b, key)))
			return false;
	}
	json_object_foreach(b, key, value) nb += *key != '_';
	return na == nb;
}

bool
bake_gltf_same_vertices(
    const struct bake_gltf *g, int mesh, int primitive, int other)
{
	json_t *a = primitive_of(g, mesh, primitive);
	json_t *b = primitive_of(g, mesh, other);

	return a != NULL && b != NULL &&
	       own_attributes_equal(json_object_get(a, "attributes"),
		   json_object_get(b, "attributes"));
}

/* How many vertices a primitive has; SIZE_MAX where it cannot be told. */
static size_t
count_vertices(const struct bake_gltf *g, const json_t *primitive)
{
	json_t *attributes = json_object_get(primitive, "attributes");

	return bake_gltf_size(
	    json_array_get(json_object_get(g->root, "accessors"),
		bake_gltf_size(attributes, "POSITION", SIZE_MAX)),
	    "count", SIZE_MAX);
}

enum bake_status
bake_gltf_add(struct bake_gltf *g, int mesh, int primitive,
    const struct bake_gltf_attribute *a, struct bake_err *err)
{
	json_t *p = primitive_of(g, mesh, primitive), *accessor, *extras;
	size_t k, n = count_vertices(g, p);
	json_int_t i;
	json_t *all;

	if (n == SIZE_MAX)
		return bake_fail(err, BAKE_EINVAL,
		    "there is no primitive %d of mesh %d with positions",
		    primitive, mesh);
	if (n != a->n)
		return bake_fail(err, BAKE_EINVAL,
		    "%zu values for the %zu vertices of primitive %d of mesh "
		    "%d",
		    a->n, n, primitive, mesh);
	i = bake_gltf_add_accessor(g,
	    bake_gltf_add_view(
		g, a->values, a->n * sizeof *a->values, BAKE_GLTF_ARRAY),
	    BAKE_GLTF_FLOAT, a->n, "VEC2", &accessor);
	if (i < 0)
		goto no_memory;
	if (a->sign != NULL) {
		extras = json_object();
		if (!put(accessor, "extras", extras) ||
		    !put(extras, "sign", json_string(a->sign)))
			goto no_memory;
	}
	all = json_object_get(
	    json_array_get(json_object_get(g->root, "meshes"), (size_t)mesh),
	    "primitives");
	for (k = 0; k < json_array_size(all); k++) {
		json_t *other = json_array_get(all, k);

		if (bake_gltf_same_vertices(g, mesh, primitive, (int)k) &&
		    !put(json_object_get(other, "attributes"), a->name,
			json_integer(i)))
			goto no_memory;
	}
	return BAKE_OK;
no_memory:
	return bake_fail(err, BAKE_ENOMEM, "no memory");
}

/* One scene with a node for each mesh, and nothing that moves it. */
static bool
lay_out(json_t *root, size_t nmeshes)
{
	json_t *nodes = json_array(), *scenes = json_array();
	json_t *scene, *all;

	json_object_del(root, "animations");
	json_object_del(root, "skins");
	json_object_del(root, "cameras");
	if (!put(root, "nodes", nodes) || !put(root, "scenes", scenes) ||
	    !put(root, "scene", json_integer(0)) ||
	    append_object(scenes, &scene) < 0 ||
	    (all = bake_gltf_array(scene, "nodes")) == NULL)
		return false;
	for (size_t i = 0; i < nmeshes; i++) {
		json_t *node;

		if (append_object(nodes, &node) < 0 ||
		    !put(node, "mesh", json_integer((json_int_t)i)) ||
		    json_array_append_new(all, json_integer((json_int_t)i)) !=
			0)
			return false;
	}
	return true;
}

enum bake_status
bake_gltf_local(const struct bake_gltf *g, unsigned char **bytes,
    size_t *nbytes, struct bake_err *err)
{
	struct bake_gltf_bytes buffer = { NULL, 0, 0 };
	json_t *root = NULL;
	enum bake_status rc;
	char *out = NULL;
	FILE *fp = NULL;

	*bytes = NULL;
	*nbytes = 0;
	if (bake_gltf_nmeshes(g) == 0)
		return bake_fail(
		    err, BAKE_EDATA, "%s: has no meshes", g->files[0]);
	if ((rc = bake_gltf_merge(g, &root, &buffer, err)) != BAKE_OK)
		goto out;
	fp = lay_out(root, bake_gltf_nmeshes(g)) ? open_memstream(&out, nbytes)
						 : NULL;
	if (fp == NULL) {
		rc = bake_fail(err, BAKE_ENOMEM, "no memory");
		goto out;
	}
	rc = bake_gltf_put_glb(fp, root, &buffer, err);
	if (fclose(fp) != 0 && rc == BAKE_OK)
		rc = bake_fail(err, BAKE_ENOMEM, "no memory");
	if (rc == BAKE_OK)
		*bytes = (unsigned char *)out;
	else
		free(out);
out:
	json_decref(root);
	free(buffer.data);
	return rc;
}

/* -- records ---------------------------------------------------------------
 */

/* Set a member, or take it away. */
static bool
put_text(json_t *object, const char *key, const char *text)
{
	if (text != NULL && text[0] != '\0')
		return put(object, key, json_string(text));
	json_object_del(object, key);
	return true;
}

enum bake_status
bake_gltf_set_record(struct bake_gltf *g, const char *text, const char *list,
    struct bake_err *err)
{
	json_t *asset = json_object_get(g->root, "asset");
	json_t *extras = json_object_get(asset, "extras");
	bool none = text == NULL || text[0] == '\0';

	if (extras == NULL && !none) {
		extras = json_object();
		if (!put(asset, "extras", extras))
			return bake_fail(err, BAKE_ENOMEM, "no memory");
	}
	if (!json_is_object(extras))
		return BAKE_OK;
	if (!put_text(extras, "relief:Recipe", text) ||
	    !put_text(extras, "relief:RecipeFiles", list))
		return bake_fail(err, BAKE_ENOMEM, "no memory");
	return BAKE_OK;
}

/* Whether one of the array's objects names a file. */
static bool
names_files(const json_t *array)
{
	json_t *item;
	size_t i;

	json_array_foreach(array, i, item)
	{
		const char *uri =
		    json_string_value(json_object_get(item, "uri"));

		if (uri != NULL && strncmp(uri, "data:", 5) != 0)
			return true;
	}
	return false;
}

bool
bake_gltf_has_outside(const struct bake_gltf *g, bool glb)
{
	return names_files(json_object_get(g->root, "images")) ||
	       (!glb && names_files(json_object_get(g->root, "buffers")));
}
