/* OBJ files: what is read, what is refused and why. */
/* SPDX-License-Identifier: MIT */
#include <dirent.h>
#include <locale.h>
#include <sys/stat.h>
#include <unistd.h>

#include "test_mesh.h"

static void
all_forms_of_a_corner(void)
{
	const char text[] =
	    "\xef\xbb\xbf# a comment that ends in a backslash \\\n"
	    "v 0 0 0\r\nv\t1 0 0\nv 0 1 0 # and one behind\nv 1 1 .5\r"
	    "vt 0.5\nvt 0.25 0.75\nvt 1 2 3\n"
	    "vn 0 0 2\nvn 0 0 0\nvn nan 0 1\n"
	    "g group\ns 1\no object\nvp 1 2\ncurv 0 1 1 2 \\\n 3 4\n"
	    "f 1 2 3\nf 1/1 2/2 3/3\nf 1//1 2//2 3//3\nf 1/1/1 2/2/2 3/3/3\n"
	    "f -4/-3 -3/-2/ \\\r\n-2/-1/-1\nfo 2 \\\n4 3\nf 1/ 2// 3\n"
	    "p 1 2\nl 1 2 3\n\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK_OK(read_text(text, "dir/a.obj", &m, &err), err);
	CHECK(m.npositions == 4 && m.nuvs == 3 && m.nnormals == 3);
	CHECK(m.ntriangles == 7 && is_valid(&m));
	CHECK(corner_is(m.triangles[0][1], 1, -1, -1));
	CHECK(corner_is(m.triangles[1][1], 1, 1, -1));
	CHECK(corner_is(m.triangles[2][2], 2, -1, 2));
	CHECK(corner_is(m.triangles[3][0], 0, 0, 0));
	CHECK(corner_is(m.triangles[4][0], 0, 0, -1));
	CHECK(corner_is(m.triangles[4][1], 1, 1, -1));
	CHECK(corner_is(m.triangles[4][2], 2, 2, 2));
	CHECK(corner_is(m.triangles[5][1], 3, -1, -1));
	CHECK(corner_is(m.triangles[6][0], 0, -1, -1));
	CHECK(m.positions[3][2] == 0.5 && m.uvs[0][0] == 0.5);
	CHECK(m.uvs[0][1] == 0.0 && m.uvs[1][1] == 0.75);
	CHECK(m.normals[0][2] == 1.0 && m.normals[1][2] == 0.0);
	CHECK(m.dropped.bad_normals == 2 && m.dropped.points == 1);
	CHECK(m.dropped.lines == 1 && m.dropped.missing_uvs == 4);
	CHECK(m.dropped.missing_normals == 5);
	CHECK(m.material_of[0] == -1 && m.nmaterials == 0);
	CHECK(m.nparts == 1 && m.parts[0].npositions == 4);
	CHECK(m.parts[0].ntriangles == 7 && m.colors == NULL);
	CHECK(m.nfiles == 1 && strcmp(m.files[0], "dir/a.obj") == 0);
	CHECK(!m.y_up && m.tangents == NULL);
	bake_mesh_free(&m);
}

/* Every double comes back from its 17 digits, and numbers of other lengths
 * are what strtod says. */
static void
decimals_are_rounded_correctly(void)
{
	struct blob b = { NULL, 0 };
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	enum { N = 3000 };
	static char text[3 * N][64];
	uint64_t seed = 5;
	int nbad = 0;

	for (int i = 0; i < 3 * N; i++) {
		double x = (chance(&seed) - 0.5) *
			   pow(10.0, (int)(chance(&seed) * 60) - 30);

		if (i % 100 == 0)
			x = ldexp(chance(&seed), -1060);
		snprintf(text[i], sizeof text[i], "%.*g",
		    (int)(chance(&seed) * 22) + 1, x);
		if (i % 7 == 0)
			snprintf(text[i], sizeof text[i], "%.*f", i % 25,
			    1e4 * (chance(&seed) - 0.5));
	}
	for (int i = 0; i < N; i++)
		blob_print(&b, "v %s %s %s\n", text[3 * i], text[3 * i + 1],
		    text[3 * i + 2]);
	blob_print(&b, "f 1 2 3\n");
	CHECK_OK(read_bytes(b.p, b.n, "a.obj", &m, &err), err);
	for (int i = 0; i < 3 * N; i++)
		nbad += m.positions[i / 3][i % 3] != strtod(text[i], NULL);
	CHECK(nbad == 0);
	bake_mesh_free(&m);
	free(b.p);
}

static void
odd_decimals(void)
{
	const char text[] =
	    "v +1. .5 -.25\nv 1e2 1E-2 1e+2\nv 00000000000000000000001.5 "
	    "0.000000000000000000000000000001 "
	    "123456789012345678901234567890\nf 1 2 3\n";
	const char *const bad[] = { "v . 0 0\n", "v 1e 0 0\n", "v 1,5 0 0\n",
		"v 0x10 0 0\n", "v 1 2\n", "v 1 2 -\n", "v 1 2 3f\n",
		"v 1e999 0 0\n", "v inf 0 0\n", "v 0 nan 0\n", "v 0 0 -inf\n",
		"vt nan\n", "vt\n", "vt x\n", "vn 1 2\n", "v 1 2 3 4 x\n" };
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK_OK(read_text(text, "a.obj", &m, &err), err);
	CHECK(m.positions[0][0] == 1.0 && m.positions[0][2] == -0.25);
	CHECK(m.positions[1][1] == 0.01 && m.positions[2][0] == 1.5);
	CHECK(m.positions[2][1] == 1e-30);
	CHECK(m.positions[2][2] == 123456789012345678901234567890.0);
	bake_mesh_free(&m);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		CHECK(read_text(bad[i], "a.obj", &m, &err) == BAKE_EDATA);
		CHECK(strstr(err.msg, "'a.obj' line 1: ") == err.msg);
	}
}

static void
a_locale_with_commas_changes_nothing(void)
{
	const char *const names[] = { "de_DE.UTF-8", "de_DE.utf8", "de_DE",
		"fr_FR.UTF-8", "fr_FR", "nl_NL.UTF-8", "ru_RU.UTF-8" };
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	bool found = false;

	for (size_t i = 0; !found && i < sizeof names / sizeof *names; i++)
		found = setlocale(LC_ALL, names[i]) != NULL;
	if (!found) {
		printf("skip t_mesh_obj: a locale with commas is not there\n");
		return;
	}
	CHECK_OK(read_text("v 0.5 1e-40 0.1234567890123456789\nv 1 0 0\n"
			   "v 0 1 0\nf 1 2 3\n",
		     "a.obj", &m, &err),
	    err);
	setlocale(LC_ALL, "C");
	CHECK(m.positions[0][0] == 0.5 && m.positions[0][1] == 1e-40);
	CHECK(m.positions[0][2] == 0.1234567890123456789);
	bake_mesh_free(&m);
}

static void
polygons_become_triangles(void)
{
	const char text[] = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.5 0\nv 0.5 2 0\n"
			    "v 0 2 0\nv 3 0 0\nv 3 2 0\n"
			    "f 1 2 3 4 5 6\nf 2 7 8 3\nf 1 1 2\nf 1 2\nf 1\n"
			    "f\nf 1 2 2 3 1\n";
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK_OK(read_text(text, "a.obj", &m, &err), err);
	/* 4 + 2 + 1; the last has a corner twice, the others are nothing */
	CHECK(m.ntriangles == 7 && m.dropped.degenerate_faces == 4);
	CHECK(m.dropped.rough_faces == 0 && m.dropped.flat_triangles == 0);
	/* the shoelace formula: 2.875 for the 6-gon, 2 for the quad, and the
	 * triangle 1 2 3 is 2 */
	CHECK_NEAR(area_of(&m), 2.875 + 2.0 + 2.0, 1e-15 * 10);
	bake_mesh_free(&m);
}

static void
colours_of_vertices(void)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK_OK(read_text("v 0 0 0\nv 1 0 0 0.25 0.5 2\nv 0 1 0 1 0 0 0.5\n"
			   "v 0 0 1 1.0\nf 1 2 3\n",
		     "a.obj", &m, &err),
	    err);
	CHECK(m.colors != NULL && !m.colors_linear);
	CHECK(m.colors[0][0] == 1.0f && m.colors[0][3] == 1.0f);
	CHECK(m.colors[1][0] == 0.25f && m.colors[1][2] == 1.0f);
	CHECK(m.colors[2][1] == 0.0f && m.colors[2][3] == 0.5f);
	CHECK(m.colors[3][1] == 1.0f);
	bake_mesh_free(&m);
}

static void
refused(const char *text, const char *reason)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK(read_text(text, "a.obj", &m, &err) == BAKE_EDATA);
	CHECK(m.positions == NULL && m.files == NULL);
	if (strcmp(err.msg, reason) != 0) {
		printf("'%s', expected '%s'\n", err.msg, reason);
		CHECK(0);
	}
}

static void
bad_files_are_refused_with_a_reason(void)
{
	refused("", "'a.obj' is empty");
	refused("v 0 0 0\n", "'a.obj' has no faces");
	refused("v 0 0 0\nf 1 1 1\nf 1\n",
	    "'a.obj' has no faces but degenerate ones, 2 of them");
	refused("f\nf # nothing\n",
	    "'a.obj' has no faces but degenerate ones, 2 of them");
	refused("v 0 0 0\nf 1 1 0\n",
	    "'a.obj' line 2: index 0 is out of range, 1 are defined");
	refused("v 0 0 0\nf 1 1 -2\n",
	    "'a.obj' line 2: index -2 is out of range, 1 are defined");
	refused("v 0 0 0\n\nf 1 1 2\n",
	    "'a.obj' line 3: a face uses vertex 2, the file has 1");
	refused("v 0 0 0\nf 1/1 1/1 1/1\n",
	    "'a.obj' line 2: a face uses UV 1, the file has 0");
	refused("v 0 0 0\nf 1//7 1 1\n",
	    "'a.obj' line 2: a face uses normal 7, the file has 0");
	refused("v 0 0 0\nf 1 1 99999999999\n",
	    "'a.obj' line 2: index 99999999999 is out of range, 1 are "
	    "defined");
	refused("f 1.5 2 3\n", "'a.obj' line 1: an index is no whole number");
	refused("f /1 2 3\n", "'a.obj' line 1: a corner has no vertex");
	refused("v 0 0 0\nf 1/1/1/1 2 3\n",
	    "'a.obj' line 2: a corner has more than 3 indices");
	refused("\x7f"
		"ELF\n",
	    "'a.obj' line 1: a statement begins with a word");
}

static void
a_face_may_come_before_its_vertices(void)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;

	CHECK_OK(read_text(
		     "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", "a.obj", &m, &err),
	    err);
	CHECK(m.ntriangles == 1);
	bake_mesh_free(&m);
}

static void
limits_hold(void)
{
	const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n";
	struct bake_mesh_params p = { sizeof text, 3, 0, false };
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK(bake_mesh_read_memory(
		  text, sizeof text - 1, "a.obj", &p, &m, &err) == BAKE_ELIMIT);
	CHECK(strcmp(err.msg, "'a.obj' has more than 3 positions") == 0);
	err = (struct bake_err)BAKE_ERR_INIT;
	p.max_items = 4;
	CHECK_OK(
	    bake_mesh_read_memory(text, sizeof text - 1, "a.obj", &p, &m, &err),
	    err);
	bake_mesh_free(&m);
	p.max_bytes = 10;
	CHECK(bake_mesh_read_memory(
		  text, sizeof text - 1, "a.obj", &p, &m, &err) == BAKE_ELIMIT);
	err = (struct bake_err)BAKE_ERR_INIT;
	p.max_items = (size_t)1 << 31;
	CHECK(bake_mesh_read_memory(text, 3, "a.obj", &p, &m, &err) ==
	      BAKE_EINVAL);
	CHECK(m.positions == NULL);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_mesh_read("/nowhere/a.obj", &no_side_files, &m, &err) ==
	      BAKE_EIO);
	err = (struct bake_err)BAKE_ERR_INIT;
	CHECK(bake_mesh_read("/", &no_side_files, &m, &err) == BAKE_EIO);
}

static void
every_prefix_is_refused_or_valid(void)
{
	const char text[] =
	    "mtllib none.mtl\nv 0 0 0 1 0 0\nv 1e0 0 0\nv 0 1.5 0\nv 1 1 1\n"
	    "vt 0 0\nvt 1 0.5\nvn 0 0 1\nusemtl a b\nf 1/1/1 2/2/1 \\\n"
	    "3/1/1 4/1/1\nusemtl\nf -1 -2 -3\nl 1 2\nf 1//1 2//1 3//1\n";

	for (size_t n = 0; n <= sizeof text - 1; n++)
		CHECK(is_refused_or_valid(text, n, "a.obj"));
}

/* -- materials ----------------------------------------------------------- */

static char folder[] = "/tmp/relief-mesh.XXXXXX";

static void
put_file(const char *name, const char *text)
{
	char path[256];
	FILE *f;

	snprintf(path, sizeof path, "%s/%s", folder, name);
	f = fopen(path, "w");
	if (f == NULL || fputs(text, f) < 0 || fclose(f) != 0)
		abort();
}

static void
remove_folder(void)
{
	DIR *d = opendir(folder);
	struct dirent *e;
	char path[512];

	while (d != NULL && (e = readdir(d)) != NULL) {
		snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
		remove(path);
	}
	if (d != NULL)
		closedir(d);
	rmdir(folder);
}

static void
materials_of_a_library(void)
{
	const struct bake_mesh_params p = BAKE_MESH_PARAMS_DEFAULT;
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	const struct bake_texture *t;
	char path[256], picture[300];

	if (mkdtemp(folder) == NULL)
		abort();
	put_file("a b.mtl",
	    "# materials\nKd 9 9 9\nnewmtl red\nKd 1 0.5 0\nd 0.25\n"
	    "newmtl with picture\nKd 0 0 0\nKa 1 1 1\n"
	    "map_Kd -s 2 3 1 -o 0.5 -clamp on tex\\my picture.png\n"
	    "newmtl third\nKd 0.5\nTr 0\nmap_Kd -blendu off 2d.png\n");
	put_file("a.obj",
	    "mtllib a b.mtl\nmtllib missing.mtl other.mtl\nmtllib a b.mtl\n"
	    "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl with picture\n"
	    "f 1 2 3\nusemtl unknown\nf 1 2 3\nusemtl red\nf 1 2 3\n");
	snprintf(path, sizeof path, "%s/a.obj", folder);
	CHECK_OK(bake_mesh_read(path, &p, &m, &err), err);
	CHECK(m.nmaterials == 4 && m.nfiles == 2);
	CHECK(m.dropped.missing_files == 2);
	CHECK(m.material_of[0] == -1 && m.material_of[1] == 1);
	CHECK(m.material_of[2] == 3 && m.material_of[3] == 0);
	CHECK(strcmp(m.materials[3].name, "unknown") == 0);
	CHECK(m.materials[3].color[2] == 1.0);
	CHECK(
	    m.materials[0].color[1] == 0.5 && m.materials[0].color[3] == 0.25);
	CHECK(m.materials[0].alpha_mode == BAKE_ALPHA_BLEND);
	CHECK(!m.materials[0].linear && m.materials[0].texture.path == NULL);
	t = &m.materials[1].texture;
	snprintf(picture, sizeof picture, "%s/tex/my picture.png", folder);
	CHECK(t->path != NULL && strcmp(t->path, picture) == 0);
	CHECK(t->uv_matrix[0][0] == 2.0 && t->uv_matrix[1][1] == 3.0);
	CHECK(t->uv_matrix[0][2] == 0.5 && t->uv_matrix[1][2] == 0.0);
	CHECK(t->wrap_u == BAKE_TEX_CLAMP && t->bytes == NULL);
	/* black beside a picture */
	CHECK(m.materials[1].color[0] == 1.0);
	t = &m.materials[2].texture;
	CHECK(t->path != NULL && strstr(t->path, "/2d.png") != NULL);
	CHECK(t->wrap_u == BAKE_TEX_REPEAT && t->uv_matrix[0][0] == 1.0);
	CHECK(m.materials[2].color[0] == 0.5 && m.materials[2].color[2] == 0.5);
	CHECK(m.materials[2].alpha_mode == BAKE_ALPHA_OPAQUE);
	bake_mesh_free(&m);
	CHECK_OK(bake_mesh_read(path, &no_side_files, &m, &err), err);
	CHECK(m.nfiles == 1 && m.dropped.missing_files == 3);
	bake_mesh_free(&m);
	remove_folder();
}

static void
many_materials_take_no_long_time(void)
{
	struct blob b = { NULL, 0 };
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_err err;
	enum { N = 20000 };

	blob_print(&b, "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
	for (int i = 0; i < 2 * N; i++)
		blob_print(&b, "usemtl m%d\nf 1 2 3\n", i % N);
	CHECK_OK(read_bytes(b.p, b.n, "a.obj", &m, &err), err);
	CHECK(m.nmaterials == N && m.material_of[N + 7] == 7);
	bake_mesh_free(&m);
	free(b.p);
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(all_forms_of_a_corner),
		CASE(decimals_are_rounded_correctly),
		CASE(odd_decimals),
		CASE(a_locale_with_commas_changes_nothing),
		CASE(polygons_become_triangles),
		CASE(colours_of_vertices),
		CASE(bad_files_are_refused_with_a_reason),
		CASE(a_face_may_come_before_its_vertices),
		CASE(limits_hold),
		CASE(every_prefix_is_refused_or_valid),
		CASE(materials_of_a_library),
		CASE(many_materials_take_no_long_time),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
