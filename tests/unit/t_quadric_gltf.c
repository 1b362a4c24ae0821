/* glTF files that quadrics are written to: names, data URIs, editing. */
/* SPDX-License-Identifier: MIT */
#include <unistd.h>

#include "check.h"
#include "gltf_priv.h"
#include "test_quadric.h"

static void
data_uris_are_there_and_back(void)
{
	unsigned char data[9] = { 0, 255, 1, 128, 62, 63, 251, 240, 7 };

	for (size_t n = 0; n <= sizeof data; n++) {
		struct bake_err err = BAKE_ERR_INIT;
		unsigned char *back;
		size_t nback;
		char *uri = bake_gltf_encode(data, n);

		CHECK(uri != NULL && strlen(uri) % 4 == 37 % 4);
		CHECK_OK(bake_gltf_decode("x", uri, &back, &nback, &err), err);
		CHECK(nback == n);
		CHECK(n == 0 || memcmp(back, data, n) == 0);
		free(back);
		free(uri);
	}
}

/* RFC 4648, section 10 */
static void
base64_is_the_standard_s(void)
{
	static const char *const pairs[][2] = { { "", "" }, { "f", "Zg==" },
		{ "fo", "Zm8=" }, { "foo", "Zm9v" }, { "foob", "Zm9vYg==" },
		{ "fooba", "Zm9vYmE=" }, { "foobar", "Zm9vYmFy" } };

	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		char *uri = bake_gltf_encode(
		    (const unsigned char *)pairs[i][0], strlen(pairs[i][0]));

		CHECK(strcmp(strchr(uri, ',') + 1, pairs[i][1]) == 0);
		free(uri);
	}
}

static void
bad_data_uris_are_errors(void)
{
	static const char *const bad[] = { "data:application/octet-stream,abc",
		"data:;base64", "data:base64,AAAA",
		"data:application/gltf-buffer;base64,AA*A",
		"data:application/gltf-buffer;base64,AAAAA",
		"data:application/gltf-buffer;base64,AA=A",
		"http://example.org/x.bin" };

	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct bake_err err = BAKE_ERR_INIT;
		unsigned char *bytes;
		size_t n;

		CHECK(bake_gltf_decode("x", bad[i], &bytes, &n, &err) ==
		      BAKE_EDATA);
		CHECK(bytes == NULL && n == 0);
		CHECK(strcmp(err.msg,
			  "'x' has a data URI that is not base64") == 0);
	}
}

static void
names_of_files_are_decoded(void)
{
	static const char *const names[][2] = { { "a.bin", "in/a.bin" },
		{ "a%20b%C3%a9.bin", "in/a b\xc3\xa9.bin" },
		{ "50%25", "in/50%" }, { "x%zz%4", "in/x%zz%4" },
		{ "no%00nul", "in/no%00nul" }, { "/abs", "/abs" },
		{ "../up.png", "in/../up.png" } };

	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		struct bake_err err = BAKE_ERR_INIT;
		char *path = bake_gltf_path("in/x.gltf", names[i][0], &err);

		CHECK(strcmp(path, names[i][1]) == 0);
		free(path);
	}
	CHECK(bake_gltf_is_file("a.bin") && bake_gltf_is_file("1:x"));
	CHECK(bake_gltf_is_file("sub/c:d") && bake_gltf_is_file(""));
	CHECK(!bake_gltf_is_file("data:,x") && !bake_gltf_is_file("http://x"));
}

static void
names_lead_back_from_another_folder(void)
{
	struct bake_err err = BAKE_ERR_INIT;
	char *head;

	CHECK_OK(bake_gltf_relative("", "out.gltf", &head, &err), err);
	CHECK(strcmp(head, "") == 0);
	free(head);
	CHECK_OK(
	    bake_gltf_relative("/usr/bin/", "/usr/bin/x", &head, &err), err);
	CHECK(strcmp(head, "") == 0);
	free(head);
	CHECK_OK(bake_gltf_relative("/usr/", "/usr/bin/x", &head, &err), err);
	CHECK(strcmp(head, "../") == 0);
	free(head);
	CHECK_OK(bake_gltf_relative("/usr/", "/tmp/x", &head, &err), err);
	CHECK(strcmp(head, "../usr/") == 0);
	free(head);
	CHECK(bake_gltf_relative("/usr/", "/no/such/folder/x", &head, &err) ==
	      BAKE_EIO);
	CHECK(head == NULL);
}

/* A glTF of a small patch, whose frames are its positions. */
static struct bake_gltf *
make(struct bake_mesh *m, struct bake_frames *f)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_gltf *g = NULL;

	test_patch(m, &test_surfaces[0], 3, 0.2);
	test_frames(f, m, &test_surfaces[0], 0.3);
	f->ntriangles = m->ntriangles;
	f->frame_of = test_calloc(m->ntriangles, sizeof *f->frame_of);
	for (size_t t = 0; t < m->ntriangles; t++)
		for (int k = 0; k < 3; k++)
			f->frame_of[t][k] = m->triangles[t][k].v;
	for (size_t v = 0; v < f->nframes; v++)
		f->frame[v].vt = -1;
	CHECK_OK(bake_gltf_make(m, f, &g, &err), err);
	return g;
}

static void
what_is_written_is_read(void)
{
	char path[] = "/tmp/t_quadric_gltf.XXXXXX";
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_gltf *g, *back = NULL;
	float values[16][2];
	struct bake_gltf_attribute a = { "_QUADRIC", "depth",
		(const float(*)[2])values, 16 };
	struct bake_mesh m, read = BAKE_MESH_INIT;
	struct bake_mesh_params mp = BAKE_MESH_PARAMS_DEFAULT;
	struct bake_frames f;
	unsigned char *bytes;
	size_t n;
	FILE *fp;

	for (int i = 0; i < 32; i++)
		values[i / 2][i % 2] = (float)i;
	g = make(&m, &f);
	CHECK_OK(bake_gltf_add(g, 0, 0, &a, &err), err);
	fp = fdopen(mkstemp(path), "wb");
	CHECK_OK(bake_gltf_write(g, fp, true, path, &err), err);
	fclose(fp);
	CHECK_OK(bake_gltf_read(path, 1 << 20, &back, &err), err);
	CHECK(bake_gltf_nmeshes(back) == 1);
	CHECK(strcmp(bake_gltf_files(back, &n)[0], path) == 0 && n == 1);
	CHECK(bake_gltf_same_vertices(back, 0, 0, 0));
	CHECK(!bake_gltf_same_vertices(back, 0, 0, 1));
	/* its positions, as floats, in its own coordinates */
	CHECK_OK(bake_gltf_local(back, &bytes, &n, &err), err);
	CHECK_OK(
	    bake_mesh_read_memory(bytes, n, "x.glb", &mp, &read, &err), err);
	CHECK(read.npositions == 16 && read.ntriangles == 18);
	for (size_t v = 0; v < read.npositions; v++)
		for (int c = 0; c < 3; c++)
			CHECK(read.positions[v][c] ==
			      (double)(float)m.positions[v][c]);
	/* limits and truncation */
	bake_gltf_free(back);
	CHECK(bake_gltf_read(path, 100, &back, &err) == BAKE_ELIMIT);
	CHECK(back == NULL);
	CHECK(truncate(path, 1000) == 0);
	CHECK(bake_gltf_read(path, 1 << 20, &back, &err) == BAKE_EDATA);
	CHECK(bake_gltf_read("/nowhere.glb", 100, &back, &err) == BAKE_EIO);
	unlink(path);
	free(bytes);
	bake_mesh_free(&read);
	bake_gltf_free(g);
	free(f.frame);
	free(f.frame_of);
	test_mesh_free(&m);
}

static void
attributes_must_fit(void)
{
	struct bake_err err = BAKE_ERR_INIT;
	float values[16][2] = { { 0 } };
	struct bake_gltf_attribute a = { "_QUADRIC", NULL,
		(const float(*)[2])values, 15 };
	struct bake_mesh m;
	struct bake_frames f;
	struct bake_gltf *g = make(&m, &f);

	CHECK(bake_gltf_add(g, 0, 0, &a, &err) == BAKE_EINVAL);
	a.n = 16;
	CHECK(bake_gltf_add(g, 1, 0, &a, &err) == BAKE_EINVAL);
	CHECK(bake_gltf_add(g, 0, 1, &a, &err) == BAKE_EINVAL);
	CHECK(bake_gltf_add(g, -1, 0, &a, &err) == BAKE_EINVAL);
	CHECK(bake_gltf_add(g, 0, -1, &a, &err) == BAKE_EINVAL);
	f.ntriangles = 0;
	bake_gltf_free(g);
	CHECK(bake_gltf_make(&m, &f, &g, &err) == BAKE_EDATA && g == NULL);
	bake_gltf_free(NULL);
	free(f.frame);
	free(f.frame_of);
	test_mesh_free(&m);
}

static const struct check_case cases[] = {
	CASE(data_uris_are_there_and_back),
	CASE(base64_is_the_standard_s),
	CASE(bad_data_uris_are_errors),
	CASE(names_of_files_are_decoded),
	CASE(names_lead_back_from_another_folder),
	CASE(what_is_written_is_read),
	CASE(attributes_must_fit),
};

int
main(int argc, char **argv)
{
	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
