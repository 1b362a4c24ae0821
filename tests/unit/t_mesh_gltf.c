/* glTF, and what assimp reads: order, transforms, materials, refusals. */
/* SPDX-License-Identifier: MIT */
#include <unistd.h>

#include "test_mesh.h"

/* Two triangles of a square in the x-y plane, with all attributes, and where
 * each lies in the buffer. */
static const float positions[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 },
	{ 1, 1, 0 } };
static const float normals[4][3] = { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 },
	{ 0.6f, 0, 0.8f } };
static const float uvs[4][2] = { { 0, 1 }, { 1, 1 }, { 0, 0 }, { 1, 0 } };
static const float tangents[4][4] = { { 1, 0, 0, 1 }, { 1, 0, 0, 1 },
	{ 1, 0, 0, 1 }, { 1, 0, 0, 1 } };
static const uint16_t indices[6] = { 0, 1, 2, 2, 1, 3 };
static const unsigned char colors[4][4] = { { 255, 0, 0, 255 },
	{ 0, 51, 0, 255 }, { 0, 0, 255, 0 }, { 0, 0, 0, 255 } };

static struct blob
buffer(void)
{
	struct blob b = { NULL, 0 };

	blob_add(&b, positions, sizeof positions); /* 0 */
	blob_add(&b, normals, sizeof normals);     /* 48 */
	blob_add(&b, uvs, sizeof uvs);             /* 96 */
	blob_add(&b, tangents, sizeof tangents);   /* 128 */
	blob_add(&b, indices, sizeof indices);     /* 192 */
	blob_add(&b, colors, sizeof colors);       /* 204 */
	blob_add(&b, "\x89PNG", 4);                /* 220 */
	return b;                                  /* 224 */
}

static void
base64(struct blob *out, const struct blob *in)
{
	static const char digits[] =
	    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

	for (size_t i = 0; i < in->n; i += 3) {
		unsigned v = (unsigned)in->p[i] << 16;

		v |= i + 1 < in->n ? (unsigned)in->p[i + 1] << 8 : 0;
		v |= i + 2 < in->n ? in->p[i + 2] : 0;
		blob_print(out, "%c%c%c%c", digits[v >> 18],
		    digits[v >> 12 & 63],
		    i + 1 < in->n ? digits[v >> 6 & 63] : '=',
		    i + 2 < in->n ? digits[v & 63] : '=');
	}
}

static const char views[] =
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},"
    "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":48},"
    "{\"buffer\":0,\"byteOffset\":96,\"byteLength\":32,\"byteStride\":8},"
    "{\"buffer\":0,\"byteOffset\":128,\"byteLength\":64},"
    "{\"buffer\":0,\"byteOffset\":192,\"byteLength\":12},"
    "{\"buffer\":0,\"byteOffset\":204,\"byteLength\":16},"
    "{\"buffer\":0,\"byteOffset\":220,\"byteLength\":4}],"
    "\"accessors\":["
    "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
    "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
    "{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
    "{\"bufferView\":3,\"componentType\":5126,\"count\":4,\"type\":\"VEC4\"},"
    "{\"bufferView\":4,\"componentType\":5123,\"count\":6,"
    "\"type\":\"SCALAR\"},"
    "{\"bufferView\":5,\"componentType\":5121,\"count\":4,"
    "\"normalized\":true,\"type\":\"VEC4\"}],";

static const char square[] =
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
    "\"NORMAL\":1,\"TEXCOORD_0\":2,\"TANGENT\":3,\"COLOR_0\":5},"
    "\"indices\":4,\"material\":0},"
    "{\"attributes\":{\"POSITION\":0},\"mode\":0},"
    "{\"attributes\":{\"POSITION\":0},\"mode\":5}]}],"
    "\"materials\":[{\"name\":\"m\",\"alphaMode\":\"MASK\","
    "\"alphaCutoff\":0.25,\"doubleSided\":true,"
    "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.25,1,0.75],"
    "\"baseColorTexture\":{\"index\":0,\"texCoord\":1,\"extensions\":"
    "{\"KHR_texture_transform\":{\"offset\":[0.25,0.5],\"scale\":[2,3],"
    "\"rotation\":1.5707963267948966}}}}},"
    "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1}}}],"
    "\"textures\":[{\"source\":0,\"sampler\":0},{\"source\":1}],"
    "\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648}],"
    "\"images\":[{\"bufferView\":6,\"mimeType\":\"image/png\"},"
    "{\"uri\":\"a%20b.jpg\"}],";

/* A document: the square under the given nodes and scene. */
static struct blob
gltf(const char *body, const char *nodes)
{
	struct blob b = { NULL, 0 }, bin = buffer();

	blob_print(
	    &b, "{\"asset\":{\"version\":\"2.0\"},%s%s%s", views, body, nodes);
	blob_print(&b, "\"buffers\":[{\"byteLength\":224,\"uri\":"
		       "\"data:application/octet-stream;base64,");
	base64(&b, &bin);
	blob_print(&b, "\"}]}");
	free(bin.p);
	return b;
}

/* The same as a .glb. */
static struct blob
glb(const char *body, const char *nodes)
{
	struct blob text = { NULL, 0 }, b = { NULL, 0 }, bin = buffer();
	uint32_t head[3] = { 0x46546c67, 2, 0 }, chunk[2];

	blob_print(&text, "{\"asset\":{\"version\":\"2.0\"},%s%s%s", views,
	    body, nodes);
	blob_print(&text, "\"buffers\":[{\"byteLength\":224}]}");
	while (text.n % 4 != 0)
		blob_print(&text, " ");
	head[2] = (uint32_t)(12 + 8 + text.n + 8 + bin.n);
	blob_add(&b, head, sizeof head);
	chunk[0] = (uint32_t)text.n;
	chunk[1] = 0x4e4f534a;
	blob_add(&b, chunk, sizeof chunk);
	blob_add(&b, text.p, text.n);
	chunk[0] = (uint32_t)bin.n;
	chunk[1] = 0x004e4942;
	blob_add(&b, chunk, sizeof chunk);
	blob_add(&b, bin.p, bin.n);
	free(text.p);
	free(bin.p);
	return b;
}

static const char plain[] =
    "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0,";

static void
check_square(const struct bake_mesh *m)
{
	const struct bake_texture *t;

	CHECK(m->npositions == 8 && m->ntriangles == 4 && is_valid(m));
	CHECK(m->nparts == 2 && m->nuvs == 4 && m->nnormals == 4);
	for (int i = 0; i < 4; i++)
		for (int k = 0; k < 3; k++) {
			CHECK(m->positions[i][k] == (double)positions[i][k]);
			CHECK(
			    m->positions[4 + i][k] == (double)positions[i][k]);
		}
	for (int i = 0; i < 6; i++) {
		int v = indices[i];

		CHECK(corner_is(m->triangles[i / 3][i % 3], v, v, v));
	}
	/* the strip turns its second triangle round */
	CHECK(m->triangles[3][0].v == 5 && m->triangles[3][1].v == 7 &&
	      m->triangles[3][2].v == 6 && m->triangles[3][0].vt == -1);
	CHECK(m->uvs[0][1] == 0.0 && m->uvs[2][1] == 1.0);
	/* of unit length up to the rounding of floats */
	CHECK_NEAR(m->normals[3][0], 0.6, 1e-7);
	CHECK(m->tangents != NULL && m->tangents[3][3] == 1.0);
	CHECK(m->colors_linear && m->y_up);
	CHECK(m->colors[1][1] == 0.2f && m->colors[2][3] == 0.0f);
	CHECK(m->colors[5][1] == 1.0f);
	CHECK(m->dropped.points == 4);
	CHECK(m->material_of[0] == 0 && m->material_of[2] == -1);
	CHECK(m->parts[0].mesh == 0 && m->parts[0].primitive == 0);
	CHECK(m->parts[1].primitive == 2 && m->parts[1].first_position == 4);
	CHECK(m->parts[1].first_triangle == 2 && m->parts[1].ntriangles == 2);
	CHECK(m->parts[0].npositions == 4 && m->parts[0].node == 0);
	CHECK(m->nmaterials == 2 && m->materials[0].linear);
	CHECK(m->materials[0].color[1] == 0.25 && m->materials[0].two_sided);
	CHECK(m->materials[0].alpha_mode == BAKE_ALPHA_MASK);
	CHECK(m->materials[0].alpha_cutoff == 0.25);
	t = &m->materials[0].texture;
	CHECK(t->nbytes == 4 && memcmp(t->bytes, "\x89PNG", 4) == 0);
	CHECK(strcmp(t->path, "image.png") == 0 && t->uv_set == 1);
	CHECK(t->wrap_u == BAKE_TEX_CLAMP && t->wrap_v == BAKE_TEX_MIRROR);
	t = &m->materials[1].texture;
	CHECK(t->bytes == NULL && strcmp(t->path, "dir/a b.jpg") == 0);
}

/* The matrix must agree with glTF's own formula, v downwards. */
static void
check_transform(const struct bake_texture *t)
{
	for (int i = 0; i < 5; i++) {
		double u = 0.3 * i, v = 0.7 - 0.1 * i;
		/* a quarter turn: u' = su 0 u + sv v, v' = -su u + 0 v */
		double gu = 3.0 * (1.0 - v) + 0.25, gv = -2.0 * u + 0.5;
		const double *r0 = t->uv_matrix[0], *r1 = t->uv_matrix[1];

		/* cos(pi / 2) is not quite 0 */
		CHECK_NEAR(r0[0] * u + r0[1] * v + r0[2], gu, 1e-14);
		CHECK_NEAR(r1[0] * u + r1[1] * v + r1[2], 1.0 - gv, 1e-14);
	}
}

static void
text_and_binary_read_the_same(void)
{
	struct blob b = gltf(square, plain);
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK_OK(read_bytes(b.p, b.n, "dir/a.gltf", &m, &err), err);
	check_square(&m);
	check_transform(&m.materials[0].texture);
	bake_mesh_free(&m);
	free(b.p);
	b = glb(square, plain);
	/* known by its first bytes */
	CHECK_OK(read_bytes(b.p, b.n, "dir/a.xyz", &m, &err), err);
	check_square(&m);
	bake_mesh_free(&m);
	free(b.p);
}

static void
nodes_move_positions_and_directions(void)
{
	/* scaled by (2, 1, 1), turned by 90 degrees about z, moved; under it
	 * the same once more, mirrored in x by a matrix */
	const char nodes[] =
	    "\"nodes\":[{\"translation\":[10,20,30],"
	    "\"rotation\":[0,0,0.7071067811865476,0.7071067811865476],"
	    "\"scale\":[2,1,1],\"mesh\":0,\"children\":[1]},"
	    "{\"mesh\":0,\"matrix\":[-1,0,0,0,0,1,0,0,0,0,1,0,5,0,0,1]}],"
	    "\"scenes\":[{},{\"nodes\":[0]}],\"scene\":1,";
	struct blob b = gltf(square, nodes);
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	/* n = (0.6, 0, 0.8): the inverse transpose divides x by 2, and the
	 * turn makes it y */
	double l = sqrt(0.3 * 0.3 + 0.8 * 0.8);

	CHECK_OK(read_bytes(b.p, b.n, "a.gltf", &m, &err), err);
	CHECK(m.nparts == 4 && m.npositions == 16 && m.ntriangles == 8);
	/* (1, 1, 0) -> (2, 1, 0) -> (-1, 2, 0); sines are rounded */
	CHECK_NEAR(m.positions[3][0], 9.0, 1e-14);
	CHECK_NEAR(m.positions[3][1], 22.0, 1e-14);
	CHECK(m.positions[3][2] == 30.0);
	/* normals were floats */
	CHECK_NEAR(m.normals[3][1], 0.3 / l, 1e-7);
	CHECK_NEAR(m.normals[3][2], 0.8 / l, 1e-7);
	CHECK_NEAR(m.tangents[0][1], 1.0, 1e-15);
	CHECK(m.tangents[0][3] == 1.0);
	/* mirrored: (1, 1, 0) -> (4, 1, 0) -> (8, 1, 0) -> (-1, 8, 0) */
	CHECK(m.parts[2].node == 1 && m.parts[2].first_position == 8);
	CHECK_NEAR(m.positions[11][0], 9.0, 1e-14);
	CHECK_NEAR(m.positions[11][1], 28.0, 1e-14);
	CHECK_NEAR(m.normals[7][1], -0.3 / l, 1e-7);
	CHECK_NEAR(m.normals[7][2], 0.8 / l, 1e-7);
	CHECK_NEAR(m.tangents[4][1], -1.0, 1e-15);
	CHECK(m.tangents[4][3] == -1.0);
	/* and still counterclockwise from +z */
	CHECK(m.triangles[4][0].v == 8 && m.triangles[4][1].v == 10 &&
	      m.triangles[4][2].v == 9);
	for (size_t i = 0; i < m.ntriangles; i++) {
		const double *p = m.positions[m.triangles[i][0].v],
			     *q = m.positions[m.triangles[i][1].v],
			     *r = m.positions[m.triangles[i][2].v];

		CHECK((q[0] - p[0]) * (r[1] - p[1]) -
			  (q[1] - p[1]) * (r[0] - p[0]) >
		      0.0);
	}
	bake_mesh_free(&m);
	free(b.p);
}

static void
meshes_without_scene_are_read(void)
{
	struct blob b = gltf(square, "");
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK_OK(read_bytes(b.p, b.n, "dir/a.gltf", &m, &err), err);
	CHECK(m.parts[0].node == -1 && m.ntriangles == 4);
	bake_mesh_free(&m);
	free(b.p);
	b = gltf(square, "\"nodes\":[{\"mesh\":0},{\"children\":[0]}],");
	CHECK_OK(read_bytes(b.p, b.n, "dir/a.gltf", &m, &err), err);
	CHECK(m.nparts == 2 && m.parts[0].node == 0);
	bake_mesh_free(&m);
	free(b.p);
}

static void
sparse_values_replace_others(void)
{
	/* the position of vertex 2 is that of tangent 1, read as VEC3 */
	const char body[] =
	    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":6},"
	    "\"mode\":6}]}],";
	struct blob b = { NULL, 0 }, bin = buffer();
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	size_t cut = strlen(views) - 2;

	blob_print(&b, "{\"asset\":{\"version\":\"2.0\"},");
	blob_add(&b, views, cut);
	blob_print(&b,
	    ",{\"bufferView\":0,\"componentType\":5126,\"count\":4,"
	    "\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":"
	    "{\"bufferView\":4,\"byteOffset\":4,\"componentType\":5123},"
	    "\"values\":{\"bufferView\":3,\"byteOffset\":16}}}],%s",
	    body);
	blob_print(&b, "\"buffers\":[{\"byteLength\":224,\"uri\":"
		       "\"data:;base64,");
	base64(&b, &bin);
	blob_print(&b, "\"}]}");
	CHECK_OK(read_bytes(b.p, b.n, "a.gltf", &m, &err), err);
	CHECK(m.positions[2][0] == 1.0 && m.positions[2][1] == 0.0);
	CHECK(m.positions[3][1] == 1.0 && m.ntriangles == 2);
	CHECK(m.triangles[1][0].v == 0 && m.triangles[1][1].v == 2);
	bake_mesh_free(&m);
	free(b.p);
	free(bin.p);
}

static void
refused(const char *from, const char *to, const char *reason)
{
	struct blob b = gltf(square, plain), c = { NULL, 0 };
	char *at = strstr((char *)b.p, from);
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK(at != NULL);
	blob_add(&c, b.p, (size_t)(at - (char *)b.p));
	blob_print(&c, "%s", to);
	blob_add(&c, at + strlen(from), strlen(at) - strlen(from));
	CHECK(read_bytes(c.p, c.n, "a.gltf", &m, &err) == BAKE_EDATA);
	if (strstr(err.msg, reason) == NULL) {
		printf("'%s', expected '%s'\n", err.msg, reason);
		CHECK(0);
	}
	free(b.p);
	free(c.p);
}

static void
bad_files_are_refused_with_a_reason(void)
{
	refused("\"2.0\"", "\"1.0\"", "is glTF of version 1.0, expected 2.0");
	refused("{\"asset\"", "{asset", "line 1: ");
	refused("\"byteLength\":224", "\"byteLength\":225",
	    "is truncated: buffer 0 has 224 bytes, expected 225");
	refused("\"byteLength\":224", "\"byteLength\":-1", "is truncated");
	refused("base64,", "base64,!", "a data URI that is not base64");
	refused("data:application/octet-stream;base64,", "x.bin?",
	    "needs the file 'x.bin?");
	refused("\"byteOffset\":204", "\"byteOffset\":209",
	    "bufferView 5 is beyond the 224 bytes");
	refused("\"byteOffset\":204", "\"byteOffset\":1e30",
	    "bufferView 5 is beyond");
	refused("\"count\":4", "\"count\":5",
	    "5 values of 12 bytes do not fit into the 48 bytes of "
	    "bufferView 0");
	refused(
	    "\"count\":4,", "", "accessor 0 is of an unknown type or count");
	refused("\"componentType\":5126", "\"componentType\":5124",
	    "accessor 0 is of an unknown type");
	refused("\"VEC3\"", "\"MAT4\"", "accessor 0 is of an unknown type");
	refused("\"VEC3\"", "\"VEC2\"", "POSITION has 2 components");
	refused(
	    "{\"bufferView\":0,\"comp", "{\"comp", "accessor 0 has no data");
	refused("\"count\":6", "\"count\":600", "do not fit");
	refused("\"indices\":4", "\"indices\":9",
	    "accessors 9 is used, the file has 6");
	refused("\"byteOffset\":192", "\"byteOffset\":206",
	    "a primitive uses vertex");
	refused("\"material\":0", "\"material\":2",
	    "a primitive has a material that is not there");
	refused("\"mode\":5", "\"mode\":7", "is of an unknown mode");
	refused("\"POSITION\":0},\"mode\":5",
	    "\"POSITION\":0},\"extensions\":"
	    "{\"KHR_draco_mesh_compression\":{}}",
	    "compressed by Draco");
	refused("\"nodes\":[{\"mesh\":0}]",
	    "\"nodes\":[{\"mesh\":0,\"children\":[0]}]",
	    "node 0 has two parents");
	refused("\"nodes\":[0]", "\"nodes\":[1]",
	    "nodes 1 is used, the file has 1");
	refused(
	    "\"scene\":0", "\"scene\":3", "scenes 3 is used, the file has 1");
	refused("\"mesh\":0", "\"mesh\":1", "meshes 1 is used");
	refused("\"nodes\":[0]", "\"nodes\":[]", "has no faces");
	refused("\"source\":0", "\"source\":2", "images 2 is used");
}

static void
every_prefix_is_refused_or_valid(void)
{
	struct blob b = glb(square, plain);

	for (size_t n = 0; n < b.n; n++)
		CHECK(is_refused_or_valid(b.p, n, "a.glb"));
	/* and with any byte of the JSON or the header another */
	for (size_t i = 0; i < b.n; i++) {
		unsigned char was = b.p[i];

		b.p[i] ^= (unsigned char)(1 + i % 255);
		CHECK(is_refused_or_valid(b.p, b.n, "a.glb"));
		b.p[i] = was;
	}
	free(b.p);
}

/* -- through assimp ------------------------------------------------------ */

static void
stl_points_are_one_position(void)
{
	struct blob b = { NULL, 0 };
	const float tetra[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 },
		{ 0, 0, 1 } };
	const int faces[4][3] = { { 0, 2, 1 }, { 0, 1, 3 }, { 1, 2, 3 },
		{ 0, 3, 2 } };
	char head[84] = "made by a test";
	const uint32_t n = 4;
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_topology t;
	struct bake_err err;

	memcpy(head + 80, &n, 4);
	blob_add(&b, head, sizeof head);
	for (int i = 0; i < 4; i++) {
		const float normal[3] = { 0, 0, 1 };

		blob_add(&b, normal, sizeof normal);
		for (int k = 0; k < 3; k++)
			blob_add(&b, tetra[faces[i][k]], sizeof tetra[0]);
		blob_add(&b, "\0\0", 2);
	}
	CHECK_OK(read_bytes(b.p, b.n, "a.STL", &m, &err), err);
	CHECK(m.ntriangles == 4 && m.npositions == 4 && is_valid(&m));
	CHECK(m.nnormals == 1 && m.nuvs == 0);
	/* in order of first appearance: 0 2 1 3 */
	CHECK(m.positions[1][1] == 1.0 && m.positions[2][0] == 1.0);
	CHECK_OK(bake_mesh_topology(&m, NULL, &t, &err), err);
	CHECK(t.edges == 6 && t.boundary == 0 && t.flipped == 0);
	bake_mesh_free(&m);
	for (size_t i = 0; i < b.n; i += 7)
		CHECK(is_refused_or_valid(b.p, i, "a.stl"));
	free(b.p);
}

static void
collada_nodes_and_materials(void)
{
	const char text[] =
	    "<?xml version=\"1.0\"?><COLLADA version=\"1.4.1\" "
	    "xmlns=\"http://www.collada.org/2005/11/COLLADASchema\">"
	    "<asset><up_axis>Y_UP</up_axis></asset>"
	    "<library_geometries><geometry id=\"g\"><mesh>"
	    "<source id=\"p\"><float_array id=\"pa\" count=\"12\">0 0 0 1 0 0 "
	    "1 1 0 0 1 0</float_array><technique_common><accessor "
	    "source=\"#pa\" count=\"4\" stride=\"3\"><param name=\"X\" "
	    "type=\"float\"/><param name=\"Y\" type=\"float\"/><param "
	    "name=\"Z\" type=\"float\"/></accessor></technique_common>"
	    "</source><vertices id=\"v\"><input semantic=\"POSITION\" "
	    "source=\"#p\"/></vertices><polylist count=\"1\"><input "
	    "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><vcount>4"
	    "</vcount><p>0 1 2 3</p></polylist></mesh></geometry>"
	    "</library_geometries><library_visual_scenes><visual_scene "
	    "id=\"s\"><node><matrix>-2 0 0 5  0 3 0 0  0 0 1 0  0 0 0 1"
	    "</matrix><instance_geometry url=\"#g\"/></node></visual_scene>"
	    "</library_visual_scenes><scene><instance_visual_scene "
	    "url=\"#s\"/></scene></COLLADA>";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	double lo[3], hi[3];

	CHECK_OK(read_text(text, "a.dae", &m, &err), err);
	CHECK(m.npositions == 4 && m.ntriangles == 2 && is_valid(&m));
	bake_mesh_bounds(&m, lo, hi);
	CHECK(lo[0] == 3.0 && hi[0] == 5.0 && hi[1] == 3.0 && hi[2] == 0.0);
	/* mirrored, and still seen from +z */
	for (int i = 0; i < 2; i++) {
		const double *p = m.positions[m.triangles[i][0].v],
			     *q = m.positions[m.triangles[i][1].v],
			     *r = m.positions[m.triangles[i][2].v];

		CHECK((q[0] - p[0]) * (r[1] - p[1]) -
			  (q[1] - p[1]) * (r[0] - p[0]) >
		      0.0);
	}
	CHECK_NEAR(area_of(&m), 6.0, 1e-15 * 6);
	bake_mesh_free(&m);
}

static void
unknown_formats_are_refused(void)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK(read_text("x", "a.nonsense", &m, &err) == BAKE_EDATA);
	CHECK(strcmp(err.msg, "'a.nonsense': 'nonsense' is not the name of a "
			      "mesh format that can be read") == 0);
	CHECK(read_text("x", "a", &m, &err) == BAKE_EDATA);
	CHECK(read_text("x", "a.b/c", &m, &err) == BAKE_EDATA);
	CHECK(read_text("nothing of use", "a.dae", &m, &err) == BAKE_EDATA);
	CHECK(strncmp(err.msg, "'a.dae': ", 9) == 0);
	CHECK(read_text("nothing of use", "a.fbx", &m, &err) == BAKE_EDATA);
	CHECK(read_text("nothing of use", "a.stl", &m, &err) == BAKE_EDATA);
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(text_and_binary_read_the_same),
		CASE(nodes_move_positions_and_directions),
		CASE(meshes_without_scene_are_read),
		CASE(sparse_values_replace_others),
		CASE(bad_files_are_refused_with_a_reason),
		CASE(every_prefix_is_refused_or_valid),
		CASE(stl_points_are_one_position),
		CASE(collada_nodes_and_materials),
		CASE(unknown_formats_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
