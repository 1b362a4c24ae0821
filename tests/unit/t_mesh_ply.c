/* PLY files: every format, type and order; what is refused. */
/* SPDX-License-Identifier: MIT */
#include "test_mesh.h"

enum format { ASCII, LITTLE, BIG };
static const char *const format_names[] = { "ascii", "binary_little_endian",
	"binary_big_endian" };

/* A value in a file: in text, or size bytes in the order of the format. */
static void
put(struct blob *b, enum format format, const char *type, double x)
{
	unsigned char bytes[8];
	size_t n;
	float f = (float)x;
	int64_t i = (int64_t)x;

	if (format == ASCII) {
		blob_print(b, "%.17g ", x);
		return;
	}
	if (strcmp(type, "float") == 0 || strcmp(type, "float32") == 0) {
		n = 4;
		memcpy(bytes, &f, n);
	} else if (strcmp(type, "double") == 0) {
		n = 8;
		memcpy(bytes, &x, n);
	} else {
		n = strstr(type, "char") || strstr(type, "int8")     ? 1
		    : strstr(type, "short") || strstr(type, "int16") ? 2
								     : 4;
		/* the low bytes come first on the machines that we test on */
		memcpy(bytes, &i, n);
	}
	for (size_t k = 0; k < n; k++)
		blob_add(b, &bytes[format == BIG ? n - 1 - k : k], 1);
}

static void
header(struct blob *b, enum format format, const char *elements)
{
	blob_print(b,
	    "ply\nformat %s 1.0\ncomment made by a test\n%s"
	    "end_header\n",
	    format_names[format], elements);
}

/* A pyramid with a square base, all properties, unknown ones among them. */
static struct blob
pyramid(enum format format, const char *position_type)
{
	static const double p[5][3] = { { -1, 0, -1 }, { 1, 0, -1 },
		{ 1, 0, 1 }, { -1, 0, 1 }, { 0.1, 1.5, 0.3 } };
	static const int quad[] = { 0, 1, 2, 3 };
	static const int sides[4][3] = { { 1, 0, 4 }, { 2, 1, 4 }, { 3, 2, 4 },
		{ 0, 3, 4 } };
	struct blob b = { NULL, 0 };
	char text[2048];

	snprintf(text, sizeof text,
	    "element camera 1\nproperty list uchar double view\n"
	    "element vertex 5\nproperty uchar red\nproperty uint8 green\n"
	    "property uchar blue\nproperty %s x\nproperty %s y\n"
	    "property short flags\nproperty %s z\nproperty list int ushort "
	    "things\nproperty float nx\nproperty float ny\nproperty float "
	    "nz\nproperty double u\nproperty double v\nproperty float s\n"
	    "element face 5\nproperty list ushort uint vertex_index\n"
	    "property int8 kind\nelement edge 2\nproperty int vertex1\n"
	    "property int vertex2\nobj_info nothing\n",
	    position_type, position_type, position_type);
	header(&b, format, text);
	put(&b, format, "uchar", 2);
	put(&b, format, "double", 0.5);
	put(&b, format, "double", -1e300);
	for (int i = 0; i < 5; i++) {
		put(&b, format, "uchar", 51 * i);
		put(&b, format, "uchar", 255);
		put(&b, format, "uchar", 0);
		put(&b, format, position_type, p[i][0]);
		put(&b, format, position_type, p[i][1]);
		put(&b, format, "short", -2);
		put(&b, format, position_type, p[i][2]);
		put(&b, format, "int", i % 3);
		for (int k = 0; k < i % 3; k++)
			put(&b, format, "ushort", 7);
		put(&b, format, "float", 0);
		put(&b, format, "float", i == 4 ? 2 : -3);
		put(&b, format, "float", 0);
		put(&b, format, "double", 0.1 * i);
		put(&b, format, "double", 1.0 - 0.3 * i);
		put(&b, format, "float", 99);
	}
	put(&b, format, "ushort", 4);
	for (int k = 0; k < 4; k++)
		put(&b, format, "uint", quad[k]);
	put(&b, format, "int8", -1);
	for (int i = 0; i < 4; i++) {
		put(&b, format, "ushort", 3);
		for (int k = 0; k < 3; k++)
			put(&b, format, "uint", sides[i][k]);
		put(&b, format, "int8", i);
	}
	for (int i = 0; i < 4; i++)
		put(&b, format, "int", i);
	return b;
}

static void
every_format_reads_the_same(void)
{
	static const char *const types[] = { "float", "double" };
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	for (int format = ASCII; format <= BIG; format++)
		for (int type = 0; type < 2; type++) {
			struct blob b = pyramid(format, types[type]);
			/* text has all digits, whatever the type is called */
			double x =
			    format != ASCII && type == 0 ? (double)0.1f : 0.1;

			CHECK_OK(read_bytes(b.p, b.n, "a.ply", &m, &err), err);
			CHECK(m.npositions == 5 && m.ntriangles == 6);
			CHECK(is_valid(&m) && m.positions[4][0] == x);
			CHECK(m.positions[4][1] == 1.5);
			CHECK(m.nuvs == 5 && m.uvs[4][0] == 0.1 * 4);
			CHECK(m.uvs[4][1] == 1.0 - 0.3 * 4);
			CHECK(m.nnormals == 5 && m.normals[4][1] == 1.0);
			CHECK(m.normals[0][1] == -1.0);
			CHECK(m.colors != NULL && m.colors[2][0] == 0.4f);
			CHECK(m.colors[2][1] == 1.0f && m.colors[2][3] == 1.0f);
			CHECK(corner_is(m.triangles[0][0], 0, 0, 0));
			CHECK(corner_is(m.triangles[1][2], 3, 3, 3));
			CHECK(corner_is(m.triangles[2][0], 1, 1, 1));
			CHECK(m.dropped.lines == 2 && !m.colors_linear);
			CHECK(m.tangents == NULL && m.nmaterials == 0);
			bake_mesh_free(&m);
			free(b.p);
		}
}

static void
every_prefix_is_refused_or_valid_(enum format format)
{
	struct blob b = pyramid(format, "float");

	for (size_t n = 0; n <= b.n; n++)
		CHECK(is_refused_or_valid(b.p, n, "a.ply"));
	free(b.p);
}

static void
every_prefix_is_refused_or_valid(void)
{
	for (int format = ASCII; format <= BIG; format++)
		every_prefix_is_refused_or_valid_(format);
}

static void
texcoords_of_corners(void)
{
	const char text[] =
	    "ply\r\nformat ascii 1.0\r\ncomment TextureFile a picture.png \r\n"
	    "comment TextureFile b.png\r\nelement vertex 4\r\n"
	    "property float x\r\nproperty float y\r\nproperty float z\r\n"
	    "element face 3\r\nproperty list uchar int vertex_indices\r\n"
	    "property list uchar float texcoord\r\nproperty int texnumber\r\n"
	    "end_header\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n1 1 0\r\n"
	    "3 0 1 2 6 0 0 1 0 0 1 0\r\n3 2 1 3 6 0 1 1 0 1 1 1\r\n"
	    "3 0 1 3 0 -1\r\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK_OK(read_text(text, "dir/a.ply", &m, &err), err);
	CHECK(m.nuvs == 6 && m.ntriangles == 3);
	/* equal UVs are the first of them */
	CHECK(corner_is(m.triangles[0][1], 1, 1, -1));
	CHECK(corner_is(m.triangles[1][0], 2, 2, -1));
	CHECK(corner_is(m.triangles[1][1], 1, 1, -1));
	CHECK(corner_is(m.triangles[1][2], 3, 5, -1));
	CHECK(corner_is(m.triangles[2][0], 0, -1, -1));
	CHECK(m.material_of[0] == 0 && m.material_of[1] == 1);
	CHECK(m.material_of[2] == -1 && m.nmaterials == 2);
	CHECK(strcmp(m.materials[0].texture.path, "dir/a picture.png") == 0);
	CHECK(strcmp(m.materials[1].texture.path, "dir/b.png") == 0);
	bake_mesh_free(&m);
}

static void
strips_and_tangents(void)
{
	const char text[] =
	    "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n"
	    "property float y\nproperty float z\nproperty float nx\n"
	    "property float ny\nproperty float nz\nproperty float tx\n"
	    "property float ty\nproperty float tz\nproperty char hand\n"
	    "property float v\nelement tristrips 1\n"
	    "property list int int vertex_indices\nend_header\n"
	    "0 0 0 0 0 1 2 0 0 -1 3\n1 0 0 0 0 1 1 0 0 1 3\n"
	    "0 1 0 0 0 1 0 0 0 1 3\n1 1 0 0 0 1 1 0 0 1 3\n"
	    "0 2 0 0 0 1 1 0 0 1 3\n9 0 1 2 3 4 -1 0 1 3\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK_OK(read_text(text, "a.ply", &m, &err), err);
	CHECK(m.ntriangles == 4 && m.nuvs == 0);
	for (size_t i = 0; i < m.ntriangles; i++) {
		const struct bake_corner *t = m.triangles[i];
		const double *a = m.positions[t[0].v], *b = m.positions[t[1].v],
			     *c = m.positions[t[2].v];

		/* all are seen from the same side */
		CHECK((b[0] - a[0]) * (c[1] - a[1]) -
			  (b[1] - a[1]) * (c[0] - a[0]) >
		      0.0);
	}
	CHECK(m.tangents != NULL && m.tangents[0][0] == 1.0);
	CHECK(m.tangents[0][3] == -1.0 && m.tangents[1][3] == 1.0);
	CHECK(m.tangents[2][3] == 0.0 && m.dropped.bad_tangents == 0);
	bake_mesh_free(&m);
}

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define FACES "property list uchar int vertex_indices\n"

static void
refused(const char *text, const char *reason)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK(read_text(text, "a.ply", &m, &err) == BAKE_EDATA);
	CHECK(m.positions == NULL && m.files == NULL);
	if (strstr(err.msg, reason) == NULL) {
		printf("'%s', expected '%s'\n", err.msg, reason);
		CHECK(0);
	}
}

static void
bad_files_are_refused_with_a_reason(void)
{
#define HEAD "ply\nformat ascii 1.0\n"
#define TWO HEAD "element vertex 3\n" XYZ "element face 1\n" FACES
#define V3 "end_header\n0 0 0\n1 0 0\n0 1 0\n"
	refused("plyx\n", "line 1: this is no PLY file");
	refused("ply\nformat ascii 2.0\n", "the version is not 1.0");
	refused("ply\nformat utf8 1.0\n", "unknown format");
	refused("ply\nend_header\n", "no format");
	refused(HEAD, "has no end_header: truncated");
	refused(HEAD "property float x\n", "a property before any element");
	refused(HEAD "element vertex -1\n", "count is no number");
	refused(HEAD "element vertex 1e3\n", "count is no number");
	refused(HEAD "element vertex\n", "expected 'element NAME COUNT'");
	refused(HEAD "element vertex 1\nproperty half x\n", "unknown type");
	refused(HEAD "element vertex 1\nproperty float x\nproperty float x\n",
	    "line 5: this property comes twice");
	refused(HEAD "element vertex 1\n" XYZ "element vertex 1\n",
	    "this element comes twice");
	refused(HEAD "element face 1\nproperty list float int x\n",
	    "a list's length is no whole number");
	refused(HEAD "nonsense\n", "this is no statement of a header");
	refused(HEAD "element vertex 1\nproperty float x\nend_header\n1\n",
	    "has vertices without x, y and z");
	refused(HEAD "element vertex 1\n" XYZ "end_header\n1 2 3\n",
	    "has no faces");
	refused(HEAD "element vertex 4000000000\n" XYZ "end_header\n1 2 3\n",
	    "is truncated: 4000000000 elements 'vertex' of at least 6 bytes "
	    "do not fit into the 6 that are left");
	refused(HEAD "element vertex 9223372036854775807\nend_header\n",
	    "has vertices without x, y and z");
	refused(TWO V3 "3 0 1 3\n", "a face uses position 3, the file has 3");
	refused(TWO V3 "3 0 1 -1\n", "a face uses vertex -1, which cannot be");
	refused(TWO V3 "3 0 1 1.5\n", "a face uses vertex 1.5");
	refused(TWO V3 "-3 0 1 1\n", "has -3 entries");
	refused(TWO V3 "300000 0 1 1\n", "is truncated");
	refused(TWO V3 "3 0 x 1\n", "line 13: expected a number");
	refused(TWO "end_header\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n",
	    "position 1 is not finite");
	refused(TWO V3 "2 0 1\n", "has no faces but degenerate ones, 1");
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(every_format_reads_the_same),
		CASE(every_prefix_is_refused_or_valid),
		CASE(texcoords_of_corners),
		CASE(strips_and_tangents),
		CASE(bad_files_are_refused_with_a_reason),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
