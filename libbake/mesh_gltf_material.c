/* glTF 2.0: materials and their pictures. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "mem.h"
#include "mesh_gltf_priv.h"

/* A name with the extension of a media type. */
static char *
name_of_type(const char *type, size_t length, struct bake_err *err)
{
	static const struct {
		const char *type, *name;
	} names[] = {
		{ "image/png", "image.png" },
		{ "image/jpeg", "image.jpg" },
		{ "image/webp", "image.webp" },
		{ "image/ktx2", "image.ktx2" },
	};

	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		if (length == strlen(names[i].type) &&
		    strncasecmp(type, names[i].type, length) == 0)
			return bake_mesh_copy_text(
			    names[i].name, strlen(names[i].name), err);
	return bake_mesh_copy_text("", 0, err);
}

static enum bake_status
image_in_view(struct gltf *g, const json_t *image, struct bake_texture *to,
    struct bake_err *err)
{
	const char *type =
	    json_string_value(json_object_get(image, "mimeType"));
	const unsigned char *bytes;
	size_t n, stride;
	enum bake_status rc = bake_mesh_gltf_view(g,
	    bake_gltf_size(image, "bufferView", SIZE_MAX), &bytes, &n, &stride,
	    err);

	if (rc != BAKE_OK)
		return rc;
	if ((to->bytes = bake_alloc(n, 1, err)) == NULL ||
	    (to->path = name_of_type(type != NULL ? type : "",
		 type != NULL ? strlen(type) : 0, err)) == NULL)
		return BAKE_ENOMEM;
	if (n > 0)
		memcpy(to->bytes, bytes, n);
	to->nbytes = n;
	return BAKE_OK;
}

static enum bake_status
take_image(
    struct gltf *g, size_t index, struct bake_texture *to, struct bake_err *err)
{
	json_t *image = bake_mesh_gltf_item(g, "images", index, err);
	const char *uri;
	enum bake_status rc;

	if (image == NULL)
		return BAKE_EDATA;
	uri = json_string_value(json_object_get(image, "uri"));
	if (uri == NULL)
		return image_in_view(g, image, to, err);
	if (!bake_gltf_is_data(uri)) {
		to->path = bake_gltf_path(g->b->src->name, uri, err);
		return to->path != NULL ? BAKE_OK : BAKE_ENOMEM;
	}
	rc = bake_gltf_decode(
	    g->b->src->name, uri, &to->bytes, &to->nbytes, err);
	if (rc != BAKE_OK)
		return rc;
	to->path = name_of_type(uri + 5, strcspn(uri + 5, ";,"), err);
	return to->path != NULL ? BAKE_OK : BAKE_ENOMEM;
}

static enum bake_tex_wrap
wrap_of(const json_t *sampler, const char *key)
{
	switch (bake_gltf_size(sampler, key, 10497)) {
	case 33071:
		return BAKE_TEX_CLAMP;
	case 33648:
		return BAKE_TEX_MIRROR;
	default:
		return BAKE_TEX_REPEAT;
	}
}

/*
 * KHR_texture_transform: with glTF's v, which grows downwards,
 *     u' =  c su u + s sv v + ou,  v' = -s su u + c sv v + ov
 * (a turn of the UVs counterclockwise as they are seen). With v and v' each
 * replaced by 1 - v this becomes:
 */
static void
take_transform(const json_t *info, struct bake_texture *to)
{
	const json_t *t = json_object_get(
	    json_object_get(info, "extensions"), "KHR_texture_transform");
	double offset[2] = { 0.0, 0.0 }, scale[2] = { 1.0, 1.0 };
	double angle_rad, c, s;

	if (t == NULL)
		return;
	bake_mesh_gltf_numbers(t, "offset", offset, 2);
	bake_mesh_gltf_numbers(t, "scale", scale, 2);
	angle_rad = bake_mesh_gltf_number(t, "rotation", 0.0);
	c = cos(angle_rad);
	s = sin(angle_rad);
	to->uv_matrix[0][0] = c * scale[0];
	to->uv_matrix[0][1] = -s * scale[1];
	to->uv_matrix[0][2] = s * scale[1] + offset[0];
	to->uv_matrix[1][0] = s * scale[0];
	to->uv_matrix[1][1] = c * scale[1];
	to->uv_matrix[1][2] = 1.0 - c * scale[1] - offset[1];
	to->uv_set =
	    (int)(bake_gltf_size(t, "texCoord", (size_t)to->uv_set) & 255);
}

/* The image of a texture; SIZE_MAX where it has none that we know of. */
static size_t
image_of(const json_t *texture)
{
	const json_t *webp = json_object_get(
	    json_object_get(texture, "extensions"), "EXT_texture_webp");
	size_t source = bake_gltf_size(texture, "source", SIZE_MAX);

	return source != SIZE_MAX ? source
				  : bake_gltf_size(webp, "source", SIZE_MAX);
}

static enum bake_status
take_texture(struct gltf *g, const json_t *info, struct bake_texture *to,
    struct bake_err *err)
{
	json_t *texture, *sampler;
	size_t image;

	if (!json_is_object(info))
		return BAKE_OK;
	texture = bake_mesh_gltf_item(
	    g, "textures", bake_gltf_size(info, "index", SIZE_MAX), err);
	if (texture == NULL)
		return BAKE_EDATA;
	to->uv_set = (int)(bake_gltf_size(info, "texCoord", 0) & 255);
	take_transform(info, to);
	if (json_object_get(texture, "sampler") != NULL) {
		sampler = bake_mesh_gltf_item(g, "samplers",
		    bake_gltf_size(texture, "sampler", SIZE_MAX), err);
		if (sampler == NULL)
			return BAKE_EDATA;
		to->wrap_u = wrap_of(sampler, "wrapS");
		to->wrap_v = wrap_of(sampler, "wrapT");
	}
	image = image_of(texture);
	return image != SIZE_MAX ? take_image(g, image, to, err) : BAKE_OK;
}

static void
take_alpha(const json_t *from, struct bake_material *to)
{
	const char *mode =
	    json_string_value(json_object_get(from, "alphaMode"));

	if (mode != NULL && strcmp(mode, "MASK") == 0)
		to->alpha_mode = BAKE_ALPHA_MASK;
	else if (mode != NULL && strcmp(mode, "BLEND") == 0)
		to->alpha_mode = BAKE_ALPHA_BLEND;
	to->alpha_cutoff = bake_mesh_gltf_number(from, "alphaCutoff", 0.5);
	to->two_sided = json_is_true(json_object_get(from, "doubleSided"));
}

static enum bake_status
take_material(struct gltf *g, const json_t *from, struct bake_err *err)
{
	const char *name = json_string_value(json_object_get(from, "name"));
	const json_t *pbr = json_object_get(from, "pbrMetallicRoughness");
	const json_t *old = json_object_get(json_object_get(from, "extensions"),
	    "KHR_materials_pbrSpecularGlossiness");
	struct bake_material *to;
	int index;
	enum bake_status rc;

	if (name == NULL)
		name = "";
	rc = bake_mesh_add_material(g->b, name, strlen(name), &index, err);
	if (rc != BAKE_OK)
		return rc;
	to = &g->b->mesh->materials[index];
	to->linear = true;
	take_alpha(from, to);
	if (pbr == NULL && old != NULL) {
		bake_mesh_gltf_numbers(old, "diffuseFactor", to->color, 4);
		rc = take_texture(g, json_object_get(old, "diffuseTexture"),
		    &to->texture, err);
	} else {
		bake_mesh_gltf_numbers(pbr, "baseColorFactor", to->color, 4);
		rc = take_texture(g, json_object_get(pbr, "baseColorTexture"),
		    &to->texture, err);
	}
	for (int k = 0; k < 4; k++)
		to->color[k] = fmin(fmax(to->color[k], 0.0), 1.0);
	return rc;
}

enum bake_status
bake_mesh_gltf_materials(struct gltf *g, struct bake_err *err)
{
	const json_t *list = json_object_get(g->root, "materials");
	enum bake_status rc = BAKE_OK;

	for (size_t i = 0; rc == BAKE_OK && i < json_array_size(list); i++)
		rc = take_material(g, json_array_get(list, i), err);
	return rc;
}
