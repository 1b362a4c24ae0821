/* Every allocation fails in turn: meshes, layers, EXR, glTF, rendering. */
/* SPDX-License-Identifier: MIT */
#include <string.h>
#include <unistd.h>

#include "abuffer.h"
#include "gltf.h"
#include "io_exr.h"
#include "layer_maps.h"
#include "layer_surface.h"
#include "multilayer.h"
#include "quadric.h"
#include "render.h"
#include "shape.h"
#include "test_layers.h"
#include "test_maps.h"
#include "test_nomem.h"
#include "test_solid.h"
#include "texture_sample.h"

/* The inputs, made before anything fails: a closed ball, also with a texture,
 * its view, layers of a smaller one, a depth map. */
static struct bake_mesh ball;
static struct bake_weld weld;
static struct bake_frames frames;
static struct bake_quadric *quadrics;
static struct bake_abuffer *rays_of_ball;
static struct bake_color *color;
static struct bake_view view = {
	.axis = BAKE_AXIS_POS_Z, .width = 12, .height = 10
};
static struct bake_layer_maps maps;
static struct bake_image texture, depth_map;
static FILE *sink;
static const struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;

/* -- from a mesh to layers ------------------------------------------------- */

static enum bake_status
resolve(const struct bake_abuffer_params *params, struct bake_err *err)
{
	struct bake_abuffer *ab;
	struct bake_band band = BAKE_BAND_INIT;
	enum bake_status rc =
	    bake_abuffer_open(&ab, &ball, &weld, &view, params, err);

	CHECK((rc == BAKE_OK) == (ab != NULL));
	/* the second band is filled with what the first one grew */
	for (int y = 0; y < 10 && rc == BAKE_OK; y += 5) {
		rc = bake_abuffer_rows(ab, y, 5, &band, err);
		CHECK((rc == BAKE_OK) == (band.start != NULL));
		if (rc != BAKE_OK)
			CHECK(band.crossing == NULL && band.scratch == NULL &&
			      band.nrows == 0);
	}
	bake_band_free(&band);
	bake_abuffer_close(ab);
	return rc;
}

static enum bake_status
run_abuffer(struct bake_err *err)
{
	const struct bake_abuffer_params params = { 0, true };

	return resolve(&params, err);
}

static enum bake_status
run_abuffer_slabs(struct bake_err *err)
{
	const struct bake_abuffer_params params = { 0.1, false };

	return resolve(&params, err);
}

static struct bake_surface_params
surface_params(void)
{
	static const struct bake_image *const textures[] = { &texture };
	struct bake_surface_params params = BAKE_SURFACE_PARAMS_DEFAULT;

	params.normals = BAKE_NORMALS_COMPUTED;
	params.textures = textures;
	params.nthreads = threads;
	return params;
}

static enum bake_status
run_surface(struct bake_err *err)
{
	const struct bake_surface_params params = surface_params();
	struct bake_surface *surface;
	enum bake_status rc = bake_surface_open(
	    &surface, &ball, &weld, rays_of_ball, &view, &params, err);

	CHECK((rc == BAKE_OK) == (surface != NULL));
	bake_surface_close(surface);
	return rc;
}

static enum bake_status
run_sampler(struct bake_err *err)
{
	struct bake_sampler *sampler;
	enum bake_status rc =
	    bake_sampler_open(&sampler, &texture, false, threads, err);

	CHECK((rc == BAKE_OK) == (sampler != NULL));
	bake_sampler_close(sampler);
	return rc;
}

static enum bake_status
open_multilayer(struct bake_multilayer **ml, int nlayers, struct bake_err *err)
{
	struct bake_multilayer_params params = { .view = view,
		.surface = surface_params(),
		.format = BAKE_DATA_UINT8,
		.policy = BAKE_CAP_SMALLEST,
		.nlayers = nlayers,
		.ncolors = 2,
		.coverage = true,
		.color = color,
		.nthreads = threads };
	enum bake_status rc =
	    bake_multilayer_open(ml, &ball, &weld, &params, err);

	CHECK((rc == BAKE_OK) == (*ml != NULL));
	return rc;
}

static bool
is_empty(const struct bake_layer_maps *m)
{
	static const struct bake_layer_maps none = BAKE_LAYER_MAPS_INIT;
	bool empty = m->width == 0 && m->height == 0 && m->nlayers == 0 &&
		     m->ntextures == 0 && m->ncolors == 0;

	for (int i = 0; i < BAKE_LAYER_TEXTURES; i++)
		empty = empty && m->depth[i].data == none.depth[i].data &&
			m->nx[i].data == NULL && m->ny[i].data == NULL;
	for (int i = 0; i < BAKE_LAYERS_MAX; i++)
		empty = empty && m->color[i].data == NULL;
	return empty;
}

static enum bake_status
done_maps(enum bake_status rc, struct bake_layer_maps *m)
{
	CHECK((rc == BAKE_OK) != is_empty(m));
	bake_layer_maps_free(m);
	return rc;
}

static enum bake_status
bake_layers(int nlayers, struct bake_err *err)
{
	struct bake_layer_maps out = BAKE_LAYER_MAPS_INIT;
	struct bake_multilayer_stats stats;
	struct bake_multilayer *ml;
	enum bake_status rc = open_multilayer(&ml, nlayers, err);

	if (rc == BAKE_OK)
		rc = bake_multilayer_maps(ml, &out, &stats, err);
	bake_multilayer_close(ml);
	return done_maps(rc, &out);
}

static enum bake_status
run_multilayer(struct bake_err *err)
{
	return bake_layers(2, err);
}

static enum bake_status
run_multilayer_as_deep_as_it_is(struct bake_err *err)
{
	return bake_layers(0, err);
}

static enum bake_status
run_multilayer_deep(struct bake_err *err)
{
	struct bake_deep_rows rows = BAKE_DEEP_ROWS_INIT;
	struct bake_multilayer_stats stats;
	struct bake_multilayer *ml;
	enum bake_status rc = open_multilayer(&ml, 2, err);

	memset(&stats, 0, sizeof stats);
	if (rc == BAKE_OK)
		rc = bake_multilayer_deep(ml, 2, 6, &rows, &stats, err);
	CHECK((rc == BAKE_OK) == (rows.count != NULL));
	if (rc != BAKE_OK)
		CHECK(rows.depth == NULL && rows.normal == NULL &&
		      rows.color == NULL && rows.nsamples == 0);
	bake_deep_rows_free(&rows);
	bake_multilayer_close(ml);
	return rc;
}

/* -- layers as images ------------------------------------------------------ */

static enum bake_status
run_layer_maps_alloc(struct bake_err *err)
{
	struct bake_layer_maps out = { .width = 7 };

	return done_maps(bake_layer_maps_alloc(&out, 4, 3, 6, BAKE_DATA_HALF, 2,
			     4, BAKE_DATA_FLOAT, err),
	    &out);
}

static enum bake_status
run_layer_mip(struct bake_err *err)
{
	struct bake_layer_maps out = BAKE_LAYER_MAPS_INIT;
	struct bake_layer_mip mip;

	return done_maps(
	    bake_layer_mip(&maps, 2, false, color, threads, &out, &mip, err),
	    &out);
}

static enum bake_status
run_layer_dilate(struct bake_err *err)
{
	struct bake_layer_maps work, before;
	enum bake_status rc;
	long at = fail_at;

	fail_at = -1; /* the input is not to fail */
	work = layer_maps(9, 7, 2, BAKE_DATA_UINT16, 1, 3, BAKE_DATA_UINT8);
	before = layer_maps(9, 7, 2, BAKE_DATA_UINT16, 1, 3, BAKE_DATA_UINT8);
	draw_ball(&work, 4.5, 3.5, 2.5, 8);
	draw_ball(&before, 4.5, 3.5, 2.5, 8);
	nallocs = 0;
	fail_at = at;
	rc = bake_layer_dilate(&work, 3, true, false, threads, err);
	CHECK((rc == BAKE_OK) != same_maps(&work, &before));
	bake_layer_maps_free(&work);
	bake_layer_maps_free(&before);
	return rc;
}

static enum bake_status
run_layer_picture(struct bake_err *err)
{
	struct bake_image picture = BAKE_IMAGE_INIT;

	return done(bake_layer_picture(&maps, color, &picture, err), &picture);
}

/* -- EXR files ------------------------------------------------------------- */

static enum bake_status
run_exr_write(struct bake_err *err)
{
	static const char *const names[] = { "a", "b", "c", "d" };
	static struct bake_pixels px;
	static float values[5 * 3 * 4];
	const struct bake_exr_channels channels = { &px, names };
	const struct bake_exr_part parts[] = { { "one", 1, &channels, NULL },
		{ "two", 1, &channels, NULL } };

	px = (struct bake_pixels){ 5, 3, 4, BAKE_DATA_FLOAT, values };
	rewind(sink);
	return bake_exr_write(parts, 2, threads, sink, "sink", err);
}

static enum bake_status
run_exr_write_deep(struct bake_err *err)
{
	static const struct bake_deep_channel channel[] = {
		{ "Z", BAKE_DATA_FLOAT }, { "A", BAKE_DATA_HALF }
	};
	static const unsigned count[] = { 1, 0, 2, 0, 0, 1 };
	static const float values[4] = { 1, 2, 3, 4 };
	static const struct bake_deep_samples samples[] = { { values, 1 },
		{ values, 1 } };
	struct bake_deep_writer *writer;
	struct bake_err ignored = BAKE_ERR_INIT;
	enum bake_status rc;

	rewind(sink);
	rc = bake_deep_writer_open(
	    &writer, sink, "sink", 3, 2, channel, 2, NULL, threads, err);
	CHECK((rc == BAKE_OK) == (writer != NULL));
	if (rc == BAKE_OK)
		rc = bake_deep_writer_rows(writer, 2, count, samples, err);
	if (rc == BAKE_OK)
		return bake_deep_writer_close(writer, err);
	bake_deep_writer_close(writer, &ignored);
	return rc;
}

/* Files that are made before anything fails. */
static unsigned char flat_exr[65536], deep_exr[65536];
static size_t nflat_exr, ndeep_exr;

static size_t
keep(unsigned char *bytes)
{
	size_t n = (size_t)ftell(sink);

	rewind(sink);
	CHECK(n < 65536 && fread(bytes, 1, n, sink) == n);
	return n;
}

static enum bake_status
run_exr_read(struct bake_err *err)
{
	static const char *const names[] = { "b", "d" };
	struct bake_pixels px = BAKE_PIXELS_INIT;
	struct bake_exr *exr;
	enum bake_status rc = bake_exr_open_memory(
	    &exr, flat_exr, nflat_exr, "flat.exr", &limits, err);

	CHECK((rc == BAKE_OK) == (exr != NULL));
	if (rc == BAKE_OK)
		rc = bake_exr_read(exr, 1, names, 2, &px, err);
	CHECK((rc == BAKE_OK) == (px.data != NULL));
	CHECK((rc == BAKE_OK) == (px.width == 5));
	bake_pixels_free(&px);
	bake_exr_close(exr);
	return rc;
}

static enum bake_status
run_exr_read_deep(struct bake_err *err)
{
	struct bake_deep_image deep = BAKE_DEEP_IMAGE_INIT;
	struct bake_exr *exr;
	enum bake_status rc = bake_exr_open_memory(
	    &exr, deep_exr, ndeep_exr, "deep.exr", &limits, err);

	CHECK((rc == BAKE_OK) == (exr != NULL));
	if (rc == BAKE_OK)
		rc = bake_exr_read_deep(exr, 0, NULL, 0, &deep, err);
	CHECK((rc == BAKE_OK) == (deep.start != NULL && deep.nsamples == 4));
	if (rc != BAKE_OK)
		CHECK(deep.value == NULL && deep.width == 0);
	bake_deep_image_free(&deep);
	bake_exr_close(exr);
	return rc;
}

/* -- meshes ---------------------------------------------------------------- */

static enum bake_status
run_quadric_fit_mesh(struct bake_err *err)
{
	const struct bake_frame_params frame_params = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_quadric_params params = BAKE_QUADRIC_PARAMS_DEFAULT;
	struct bake_frames f = BAKE_FRAMES_INIT;
	struct bake_quadric *q;
	enum bake_status rc;

	params.creases = true;
	params.nthreads = threads;
	rc = bake_quadric_fit_mesh(
	    &ball, 1e-9, &frame_params, &params, &f, &q, err);
	CHECK((rc == BAKE_OK) == (q != NULL));
	CHECK((rc == BAKE_OK) == (f.frame != NULL && f.frame_of != NULL));
	CHECK((rc == BAKE_OK) == (f.nframes > 0));
	bake_frames_free(&f);
	free(q);
	return rc;
}

static enum bake_status
make_shape(enum bake_shape shape, struct bake_err *err)
{
	struct bake_mesh m = BAKE_MESH_INIT;
	enum bake_status rc = bake_shape_make(shape, 2, &m, err);

	CHECK((rc == BAKE_OK) == (m.npositions > 0 && m.positions != NULL));
	if (rc != BAKE_OK)
		CHECK(m.triangles == NULL && m.uvs == NULL &&
		      m.normals == NULL && m.tangents == NULL &&
		      m.parts == NULL);
	bake_mesh_free(&m);
	return rc;
}

static enum bake_status
run_shape_torus(struct bake_err *err)
{
	return make_shape(BAKE_SHAPE_TORUS, err);
}

static enum bake_status
run_shape_teapot(struct bake_err *err)
{
	return make_shape(BAKE_SHAPE_TEAPOT, err);
}

static const char gltf_text[] =
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
    "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
    "{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":"
    "5126,\"count\":3,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,"
    "\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":"
    "\"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}";
static char gltf_path[] = "/tmp/t_nomem_layers.XXXXXX";

/* Read, looked at, added to and written both ways. */
static enum bake_status
run_gltf(struct bake_err *err)
{
	static const float values[3][2] = { { 0 } };
	const struct bake_gltf_attribute a = { "_QUADRIC", "depth", values, 3 };
	unsigned char *local = NULL;
	struct bake_gltf *g;
	size_t nlocal;
	enum bake_status rc = bake_gltf_read(gltf_path, 4096, &g, err);

	CHECK((rc == BAKE_OK) == (g != NULL));
	rewind(sink);
	if (rc != BAKE_OK)
		return rc;
	rc = bake_gltf_local(g, &local, &nlocal, err);
	CHECK((rc == BAKE_OK) == (local != NULL));
	if (rc == BAKE_OK &&
	    (rc = bake_gltf_add(g, 0, 0, &a, err)) == BAKE_OK &&
	    (rc = bake_gltf_write(g, sink, true, "-", err)) == BAKE_OK)
		rc = bake_gltf_write(g, sink, false, "-", err);
	bake_gltf_free(g);
	free(local);
	return rc;
}

static enum bake_status
run_gltf_make(struct bake_err *err)
{
	struct bake_gltf *g;
	enum bake_status rc = bake_gltf_make(&ball, &frames, &g, err);

	CHECK((rc == BAKE_OK) == (g != NULL));
	bake_gltf_free(g);
	return rc;
}

static enum bake_status
run_mesh_gltf(struct bake_err *err)
{
	const struct bake_mesh_params params = BAKE_MESH_PARAMS_DEFAULT;
	struct bake_mesh m = BAKE_MESH_INIT;
	enum bake_status rc =
	    bake_mesh_read_memory((const unsigned char *)gltf_text,
		sizeof gltf_text - 1, "a.gltf", &params, &m, err);

	CHECK((rc == BAKE_OK) == (m.ntriangles == 1));
	if (rc != BAKE_OK)
		CHECK(m.positions == NULL && m.triangles == NULL &&
		      m.files == NULL && m.parts == NULL);
	bake_mesh_free(&m);
	return rc;
}

/* -- rendering ------------------------------------------------------------- */

static enum bake_status
run_relief_map(struct bake_err *err)
{
	struct bake_relief_map *map;
	enum bake_status rc =
	    bake_relief_map_open(&map, &depth_map, torus, threads, err);

	CHECK((rc == BAKE_OK) == (map != NULL));
	bake_relief_map_close(map);
	return rc;
}

static enum bake_status
run_multi_map(struct bake_err *err)
{
	struct bake_multi_map *map;
	enum bake_status rc =
	    bake_multi_map_open(&map, &maps, torus, threads, err);

	CHECK((rc == BAKE_OK) == (map != NULL));
	bake_multi_map_close(map);
	return rc;
}

static enum bake_status
run_shell(struct bake_err *err)
{
	struct bake_shell *shell;
	enum bake_status rc = bake_shell_open(
	    &shell, &ball, &weld, &frames, 0.1, 1, 1, threads, err);

	CHECK((rc == BAKE_OK) == (shell != NULL));
	bake_shell_close(shell);
	return rc;
}

static const struct bake_camera camera = { .eye = { 0, 0, 4 },
	.up = { 0, 1, 0 },
	.fov_deg = 40,
	.near = 0.1,
	.width = 20,
	.height = 16 };

static enum bake_status
run_raster(struct bake_err *err)
{
	struct bake_raster *raster;
	enum bake_status rc = bake_raster_open(
	    &raster, &ball, &camera, 2, BAKE_CULL_BACK, threads, err);

	CHECK((rc == BAKE_OK) == (raster != NULL));
	bake_raster_close(raster);
	return rc;
}

static struct bake_relief_map *relief;
static struct bake_image relief_texels;

static enum bake_status
run_render(struct bake_err *err)
{
	const struct bake_render_layer layer = { .map = relief,
		.texels = &relief_texels,
		.tile_u = 1,
		.tile_v = 1,
		.normal_weight = 1,
		.depth_weight = 1,
		.slope = 1,
		.ao_scale = 1 };
	const struct bake_render_object object = { .mesh = &ball,
		.frames = &frames,
		.quadrics = quadrics,
		.silhouette = BAKE_SILHOUETTE_QUADRIC,
		.depth = 0.1,
		.tile_u = 1,
		.tile_v = 1,
		.layers = &layer,
		.nlayers = 1,
		.material = { .color_tile_u = 1,
		    .color_tile_v = 1,
		    .base = { 1, 1, 1 } } };
	const struct bake_render_params params = { .camera = camera,
		.samples = 2,
		.march = BAKE_MARCH_PARAMS_DEFAULT,
		.light = { .at = { 1, 1, 1 }, .color = { 1, 1, 1 } },
		.shadow = BAKE_SHADOW_HARD,
		.nthreads = threads };
	struct bake_render_buffers b = { .want = BAKE_BUFFER_ALL };
	struct bake_image *const all[] = { &b.color, &b.distance, &b.normal,
		&b.ao, &b.uv, &b.mask };
	enum bake_status rc = bake_render(&object, 1, &params, &b, err);

	for (int i = 0; i < 6; i++)
		CHECK((rc == BAKE_OK) != is_init(all[i]));
	bake_render_buffers_free(&b);
	return rc;
}

CASE_OF(abuffer)
CASE_OF(abuffer_slabs)
CASE_OF(surface)
CASE_OF(sampler)
CASE_OF(multilayer)
CASE_OF(multilayer_as_deep_as_it_is)
CASE_OF(multilayer_deep)
CASE_OF(layer_maps_alloc)
CASE_OF(layer_mip)
CASE_OF(layer_dilate)
CASE_OF(layer_picture)
CASE_OF(exr_write)
CASE_OF(exr_write_deep)
CASE_OF(exr_read)
CASE_OF(exr_read_deep)
CASE_OF(quadric_fit_mesh)
CASE_OF(shape_torus)
CASE_OF(shape_teapot)
CASE_OF(gltf)
CASE_OF(gltf_make)
CASE_OF(mesh_gltf)
CASE_OF(relief_map)
CASE_OF(multi_map)
CASE_OF(shell)
CASE_OF(raster)
CASE_OF(render)

static void *
test_zalloc(size_t n)
{
	void *p = calloc(1, n);

	if (p == NULL)
		abort();
	return p;
}

static bool
set_up(struct bake_err *err)
{
	const struct bake_frame_params frame_params = BAKE_FRAME_PARAMS_DEFAULT;
	const struct bake_quadric_params params = BAKE_QUADRIC_PARAMS_DEFAULT;
	const struct bake_abuffer_params rays = BAKE_ABUFFER_PARAMS_DEFAULT;
	int fd = mkstemp(gltf_path);

	sink = tmpfile();
	if (fd < 0 || sink == NULL ||
	    write(fd, gltf_text, sizeof gltf_text - 1) < 0)
		return false;
	close(fd);
	texture = noise(9, 7, 3);
	depth_map = noise(24, 20, 1);
	relief_texels = noise(24, 20, 4);
	maps = layer_maps(9, 7, 2, BAKE_DATA_UINT8, 1, 4, BAKE_DATA_UINT8);
	draw_ball(&maps, 4.5, 3.5, 2.5, 8);
	if (bake_shape_make(BAKE_SHAPE_SPHERE, 2, &ball, err) != BAKE_OK)
		return false;
	ball.nmaterials = 1;
	ball.materials = test_zalloc(sizeof *ball.materials);
	ball.materials[0].texture.uv_matrix[0][0] = 1;
	ball.materials[0].texture.uv_matrix[1][1] = 1;
	free(ball.material_of);
	ball.material_of = test_zalloc(ball.ntriangles * sizeof(int));
	return bake_mesh_weld(&ball, 0, &weld, err) == BAKE_OK &&
	       bake_quadric_fit_mesh(&ball, 0, &frame_params, &params, &frames,
		   &quadrics, err) == BAKE_OK &&
	       bake_view_fit(&view, &ball, err) == BAKE_OK &&
	       bake_color_open(NULL, &color, err) == BAKE_OK &&
	       bake_abuffer_open(
		   &rays_of_ball, &ball, &weld, &view, &rays, err) == BAKE_OK &&
	       bake_relief_map_open(&relief, &depth_map, torus, 1, err) ==
		   BAKE_OK &&
	       run_exr_write(err) == BAKE_OK &&
	       (nflat_exr = keep(flat_exr)) > 0 &&
	       run_exr_write_deep(err) == BAKE_OK &&
	       (ndeep_exr = keep(deep_exr)) > 0;
}

static void
tear_down(void)
{
	bake_relief_map_close(relief);
	bake_abuffer_close(rays_of_ball);
	bake_color_close(color);
	bake_frames_free(&frames);
	free(quadrics);
	bake_weld_free(&weld);
	bake_mesh_free(&ball);
	bake_layer_maps_free(&maps);
	bake_image_free(&texture);
	bake_image_free(&depth_map);
	bake_image_free(&relief_texels);
	fclose(sink);
	remove(gltf_path);
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(abuffer),
		CASE(abuffer_slabs),
		CASE(surface),
		CASE(sampler),
		CASE(multilayer),
		CASE(multilayer_as_deep_as_it_is),
		CASE(multilayer_deep),
		CASE(layer_maps_alloc),
		CASE(layer_mip),
		CASE(layer_dilate),
		CASE(layer_picture),
		CASE(exr_write),
		CASE(exr_write_deep),
		CASE(exr_read),
		CASE(exr_read_deep),
		CASE(quadric_fit_mesh),
		CASE(shape_torus),
		CASE(shape_teapot),
		CASE(gltf),
		CASE(gltf_make),
		CASE(mesh_gltf),
		CASE(relief_map),
		CASE(multi_map),
		CASE(shell),
		CASE(raster),
		CASE(render),
	};
	struct bake_err err = BAKE_ERR_INIT;
	int status;

	threads = 1;
	if (!set_up(&err)) {
		fprintf(stderr, "t_nomem_layers: set-up: %s\n", err.msg);
		return 1;
	}
	status = check_main(argc, argv, cases, sizeof cases / sizeof *cases);
	tear_down();
	return status;
}
