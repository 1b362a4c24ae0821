/* The renderer: closed forms, and what does not change the picture. */
/* SPDX-License-Identifier: MIT */
#include "render.h"

#include "check.h"
#include "shape.h"
#include "test_maps.h"

/* A relief: normals, AO 1 and depth, and its map. */
struct relief {
	struct bake_image texels;
	struct bake_relief_map *map;
	struct bake_render_layer layer;
};

/* A mesh with frames. */
struct solid {
	struct bake_mesh mesh;
	struct bake_weld weld;
	struct bake_frames frames;
};

static struct bake_err err = BAKE_ERR_INIT;

static void
must(enum bake_status rc)
{
	if (rc == BAKE_OK)
		return;
	printf("%s\n", err.msg);
	abort();
}

/* Takes depth over. */
static void
make_relief(struct relief *r, struct bake_image *depth)
{
	r->texels = image(depth->width, depth->height, 4);
	for (int i = 0; i < depth->width * depth->height; i++) {
		const float d = depth->data[i];

		r->texels.data[4 * i] = 0.3f * d;
		r->texels.data[4 * i + 1] = -0.2f * d;
		r->texels.data[4 * i + 2] = 1 - 0.5f * d;
		r->texels.data[4 * i + 3] = d;
	}
	must(bake_relief_map_open(&r->map, depth, torus, 1, &err));
	r->layer = (struct bake_render_layer){ .map = r->map,
		.texels = &r->texels,
		.tile_u = 1,
		.tile_v = 1,
		.normal_weight = 1,
		.depth_weight = 1,
		.slope = 1,
		.ao_scale = 1 };
	bake_image_free(depth);
}

static void
free_relief(struct relief *r)
{
	bake_relief_map_close(r->map);
	bake_image_free(&r->texels);
}

static struct bake_image
flat(float d)
{
	struct bake_image img = image(8, 8, 1);

	for (int i = 0; i < 64; i++)
		img.data[i] = d;
	return img;
}

/* Hills without kinks. */
static struct bake_image
hills(int side)
{
	struct bake_image img = image(side, side, 1);

	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++)
			img.data[y * side + x] =
			    (float)(0.5 + 0.24 * sin(2 * pi * 2 * x / side) +
				    0.24 * cos(2 * pi * 3 * y / side));
	return img;
}

static void
make_solid(struct solid *s, enum bake_shape shape, int detail)
{
	struct bake_frame_params how = BAKE_FRAME_PARAMS_DEFAULT;

	memset(s, 0, sizeof *s);
	how.tangents = BAKE_TANGENTS_FILE;
	must(bake_shape_make(shape, detail, &s->mesh, &err));
	must(bake_mesh_weld(&s->mesh, 0, &s->weld, &err));
	must(
	    bake_mesh_frames(&s->mesh, &s->weld, NULL, &how, &s->frames, &err));
}

static void
free_solid(struct solid *s)
{
	bake_frames_free(&s->frames);
	bake_weld_free(&s->weld);
	bake_mesh_free(&s->mesh);
}

static struct bake_render_object
object_of(const struct solid *s, const struct bake_render_layer *layers, int n)
{
	return (struct bake_render_object){ .mesh = &s->mesh,
		.frames = &s->frames,
		.depth = 0.2,
		.tile_u = 1,
		.tile_v = 1,
		.layers = layers,
		.nlayers = n,
		.material = { .base = { 0.5f, 0.4f, 0.3f },
		    .specular = 0.1f,
		    .shininess = 7 } };
}

static struct bake_render_params
params_of(int width, int height)
{
	return (struct bake_render_params){ .camera = { .eye = { 0.4, 3, 1.5 },
						.up = { 0, 1, 0 },
						.fov_deg = 30,
						.near = 0.01,
						.width = width,
						.height = height },
		.samples = 1,
		.march = BAKE_MARCH_PARAMS_DEFAULT,
		.light = { .at = { -1, 2, 1.5 }, .color = { 1, 1, 1 } },
		.ambient = { 0.3f, 0.3f, 0.3f },
		.background = { 0.1f, 0.2f, 0.3f, 1 },
		.ao = true,
		.nthreads = 1 };
}

static struct bake_render_buffers
render(const struct bake_render_object *o, int n,
    const struct bake_render_params *p)
{
	struct bake_render_buffers b = { .want = BAKE_BUFFER_ALL };

	must(bake_render(o, n, p, &b, &err));
	return b;
}

static bool
same_image(const struct bake_image *a, const struct bake_image *b)
{
	return memcmp(a->data, b->data, nfloats(a) * sizeof *a->data) == 0;
}

static bool
same(const struct bake_render_buffers *a, const struct bake_render_buffers *b)
{
	return same_image(&a->color, &b->color) &&
	       same_image(&a->distance, &b->distance) &&
	       same_image(&a->normal, &b->normal) &&
	       same_image(&a->ao, &b->ao) && same_image(&a->uv, &b->uv) &&
	       same_image(&a->mask, &b->mask);
}

/* The ray of a pixel's middle. */
static void
ray_of(const struct bake_render_params *p, int x, int y, double from[3],
    double dir[3])
{
	struct bake_camera_basis basis;

	must(bake_camera_basis(&p->camera, &basis, &err));
	bake_camera_ray(&basis, x + 0.5, y + 0.5, from, dir);
}

/* -- closed forms ------------------------------------------------------------
 */

static void
flat_relief_is_the_plane_moved_down(void)
{
	static const enum bake_search searches[] = { BAKE_SEARCH_LINEAR,
		BAKE_SEARCH_TEXEL, BAKE_SEARCH_EXACT };
	const float depths[] = { 0, 0.37f, 1 };
	struct solid s;

	make_solid(&s, BAKE_SHAPE_PLANE, 2);
	for (int k = 0; k < 9; k++) {
		struct bake_image depth = flat(depths[k % 3]);
		struct bake_render_params p = params_of(40, 30);
		struct bake_render_object o;
		struct bake_render_buffers b;
		struct relief r;
		double worst = 0;

		make_relief(&r, &depth);
		o = object_of(&s, &r.layer, 1);
		p.march.search = searches[k / 3];
		b = render(&o, 1, &p);
		for (int i = 0; i < 40 * 30; i++) {
			double from[3], dir[3], t;

			ray_of(&p, i % 40, i / 40, from, dir);
			t = from[1] / -dir[1];
			if (b.mask.data[i] < 1) {
				/* outside the square */
				CHECK(fmax(fabs(from[0] + t * dir[0]),
					  fabs(from[2] + t * dir[2])) > 0.99);
				continue;
			}
			t = (from[1] + 0.2 * (double)depths[k % 3]) / -dir[1];
			worst =
			    fmax(worst, fabs(t - (double)b.distance.data[i]));
		}
		/* some roundings of floats up to 4, and rays' 2^-20 beyond
		 * the bottom, 0.3 long */
		CHECK_NEAR(worst, 0, 4e-6);
		bake_render_buffers_free(&b);
		free_relief(&r);
	}
	free_solid(&s);
}

static void
sphere_is_a_disc(void)
{
	enum { SIDE = 120, DETAIL = 16 };
	struct bake_render_params p = params_of(SIDE, SIDE);
	struct bake_render_object o;
	struct bake_render_buffers b;
	struct solid s;

	make_solid(&s, BAKE_SHAPE_SPHERE, DETAIL);
	o = object_of(&s, NULL, 0);
	b = render(&o, 1, &p);
	for (int i = 0; i < SIDE * SIDE; i++) {
		double from[3], d[3], along = 0, miss2 = 0;

		ray_of(&p, i % SIDE, i / SIDE, from, d);
		for (int k = 0; k < 3; k++)
			along -= from[k] * d[k];
		for (int k = 0; k < 3; k++)
			miss2 += pow(from[k] + along * d[k], 2);
		/* triangles are inside the sphere, by 1 - cos of at most a
		 * step; corners lie on a grid of 1/256 pixel */
		if (miss2 > 1.001)
			CHECK(b.mask.data[i] == 0);
		else if (sqrt(miss2) < cos(pi / (2 * DETAIL)) - 1e-3)
			CHECK(b.mask.data[i] == 1);
	}
	bake_render_buffers_free(&b);
	free_solid(&s);
}

/*
 * A quadric of a = b = 1/2 (a sphere of radius 1) over a bottom D deep: a ray
 * at the angle e to the normal goes z = (t cos e - t^2 sin^2 e / 2) / D, and
 * reaches 1 where cos^2 e >= 2 D sin^2 e: sin e <= (1 + 2 D)^(-1/2). Seen
 * without perspective sin e is the distance from the axis.
 */
static void
quadric_silhouette_ends_where_rays_leave(void)
{
	enum { SIDE = 128 };
	struct bake_image depth = flat(1);
	struct bake_render_params p = params_of(SIDE, SIDE);
	const double rim = 1 / sqrt(1 + 2 * 0.2);
	struct bake_quadric *q;
	struct bake_render_object o;
	struct relief r;
	struct solid s;

	make_relief(&r, &depth);
	make_solid(&s, BAKE_SHAPE_SPHERE, 64);
	q = calloc(s.frames.nframes, sizeof *q);
	if (q == NULL)
		abort();
	for (size_t i = 0; i < s.frames.nframes; i++)
		q[i].a = q[i].b = 0.5;
	o = object_of(&s, &r.layer, 1);
	o.quadrics = q;
	p.camera.fov_deg = 0;
	p.camera.height_world = 2.2;
	p.camera.eye[0] = p.camera.eye[1] = 0;
	for (int bent = 0; bent < 2; bent++) {
		struct bake_render_buffers b;

		o.silhouette =
		    bent ? BAKE_SILHOUETTE_QUADRIC : BAKE_SILHOUETTE_NONE;
		b = render(&o, 1, &p);
		for (int i = 0; i < SIDE * SIDE; i++) {
			const double x = 2.2 * (i % SIDE + 0.5) / SIDE - 1.1;
			const double y = 2.2 * (i / SIDE + 0.5) / SIDE - 1.1;
			const double e = sqrt(x * x + y * y);

			/* normals are those between corners 1.4 degrees apart:
			 * within 1 - cos of half of that, 7.5e-5 / cos e */
			if (e < (bent ? rim : 1) - 2e-3)
				CHECK(b.mask.data[i] == 1);
			if (e > (bent ? rim : 1) + 1e-3)
				CHECK(b.mask.data[i] == 0);
		}
		bake_render_buffers_free(&b);
	}
	free(q);
	free_relief(&r);
	free_solid(&s);
}

/* -- what changes nothing ----------------------------------------------------
 */

static void
same_bytes_for_any_thread_and_instruction_set(void)
{
	static const char *const isas[] = { "baseline", "avx2", "avx512" };
	struct bake_image depth = noise(64, 64, 1);
	struct bake_render_params p = params_of(83, 61);
	struct bake_render_object o[2];
	struct bake_render_buffers first;
	struct bake_render_layer two[2];
	struct relief r;
	struct solid s, plane;

	make_relief(&r, &depth);
	make_solid(&s, BAKE_SHAPE_TORUS, 8);
	make_solid(&plane, BAKE_SHAPE_PLANE, 1);
	two[0] = two[1] = r.layer;
	two[1].tile_u = 3;
	two[1].offset_v = 0.3;
	two[1].ao_scale = 0.7;
	o[0] = object_of(&s, &r.layer, 1);
	o[0].tile_u = 2;
	o[1] = object_of(&plane, two, 2);
	o[1].blend = BAKE_RENDER_PD;
	p.samples = 2;
	p.shadow = BAKE_SHADOW_HARD;
	p.light.point = true;
	first = render(o, 2, &p);
	for (int k = 0; k < 5; k++) {
		struct bake_render_buffers b;

		p.nthreads = k < 2 ? (k == 0 ? 2 : 7) : 1;
		if (k >= 2)
			setenv("BAKE_ISA", isas[k - 2], 1);
		b = render(o, 2, &p);
		unsetenv("BAKE_ISA");
		CHECK(same(&first, &b));
		bake_render_buffers_free(&b);
	}
	bake_render_buffers_free(&first);
	free_relief(&r);
	free_solid(&s);
	free_solid(&plane);
}

/* Of two planes the nearer is seen, whichever comes first; of two at one place
 * the first. */
static void
nearest_is_seen_and_the_first_of_equals(void)
{
	struct bake_render_params p = params_of(20, 15);
	struct solid a, b;
	struct bake_render_object o[2];
	struct bake_render_buffers out, alone;

	make_solid(&a, BAKE_SHAPE_PLANE, 1);
	make_solid(&b, BAKE_SHAPE_PLANE, 3);
	o[0] = object_of(&a, NULL, 0);
	o[1] = object_of(&a, NULL, 0);
	o[1].material.base[0] = 1;
	alone = render(&o[0], 1, &p);
	out = render(o, 2, &p);
	CHECK(same(&out, &alone));
	bake_render_buffers_free(&out);
	bake_render_buffers_free(&alone);
	for (size_t i = 0; i < b.mesh.npositions; i++)
		b.mesh.positions[i][1] += 0.25;
	for (int k = 0; k < 2; k++) {
		o[k] = object_of(&b, NULL, 0);
		o[1 - k] = object_of(&a, NULL, 0);
		out = render(o, 2, &p);
		alone = render(&o[k], 1, &p);
		for (int i = 0; i < 20 * 15; i++)
			CHECK(alone.mask.data[i] == 0 ||
			      out.distance.data[i] == alone.distance.data[i]);
		bake_render_buffers_free(&out);
		bake_render_buffers_free(&alone);
	}
	free_solid(&a);
	free_solid(&b);
}

/* A relief of depth 1/2 of one object and a plain plane as deep as 0.4 of it:
 * the plane is in front; at 0.6 the relief. */
static void
reliefs_interpenetrate_plain_geometry(void)
{
	struct bake_image depth = flat(0.5f);
	struct bake_render_params p = params_of(20, 15);
	struct solid plane, deep;
	struct bake_render_object o[2];
	struct relief r;

	make_relief(&r, &depth);
	make_solid(&plane, BAKE_SHAPE_PLANE, 1);
	o[0] = object_of(&plane, &r.layer, 1);
	p.camera.eye[0] = 0;
	p.camera.eye[2] = 0.5;
	p.camera.fov_deg = 10; /* nothing but plane */
	for (int k = 0; k < 2; k++) {
		const double at = k == 0 ? 0.4 : 0.6;
		struct bake_render_buffers b;

		make_solid(&deep, BAKE_SHAPE_PLANE, 1);
		for (size_t i = 0; i < deep.mesh.npositions; i++)
			deep.mesh.positions[i][1] = -0.2 * at;
		o[1] = object_of(&deep, NULL, 0);
		b = render(o, 2, &p);
		for (int i = 0; i < 20 * 15; i++) {
			double from[3], dir[3];

			ray_of(&p, i % 20, i / 20, from, dir);
			CHECK_NEAR((double)b.distance.data[i],
			    (from[1] + 0.2 * fmin(at, 0.5)) / -dir[1], 4e-6);
		}
		bake_render_buffers_free(&b);
		free_solid(&deep);
	}
	free_relief(&r);
	free_solid(&plane);
}

/* Two layers of which one has no weight, or which are the same, are the single
 * one. */
static void
blend_of_one_is_that_one(void)
{
	struct bake_image depth = hills(64);
	struct bake_render_params p = params_of(64, 48);
	struct bake_render_layer two[2];
	struct bake_render_buffers one;
	struct bake_render_object o;
	struct relief r;
	struct solid s;

	make_relief(&r, &depth);
	make_solid(&s, BAKE_SHAPE_PLANE, 1);
	o = object_of(&s, &r.layer, 1);
	one = render(&o, 1, &p);
	for (int k = 0; k < 2; k++) {
		struct bake_render_buffers b;

		two[0] = two[1] = r.layer;
		for (int i = 0; i < 2; i++) {
			const double w = k == 0 ? i == 0 : 0.5;

			two[i].normal_weight = two[i].depth_weight = w;
		}
		o = object_of(&s, two, 2);
		o.blend = BAKE_RENDER_SEED;
		o.ao_min = true;
		b = render(&o, 1, &p);
		for (int i = 0; i < 64 * 48; i++) {
			const bool hit = one.mask.data[i] > 0;

			CHECK((b.mask.data[i] > 0) == hit);
			if (!hit)
				continue;
			/* the same places looked at, rounded otherwise: some
			 * 2^-22 of depth, over slopes against rays */
			CHECK_NEAR((double)b.distance.data[i],
			    (double)one.distance.data[i], 1e-5);
			for (int c = 0; c < 3; c++)
				CHECK_NEAR((double)b.color.data[4 * i + c],
				    (double)one.color.data[4 * i + c], 1e-4);
		}
		bake_render_buffers_free(&b);
	}
	bake_render_buffers_free(&one);
	free_relief(&r);
	free_solid(&s);
}

/* Four samples a pixel are four pixels of a picture twice as large. */
static void
samples_are_means(void)
{
	enum { W = 37, H = 29 };
	struct bake_image depth = noise(32, 32, 1);
	struct bake_render_params p = params_of(W, H);
	struct bake_render_buffers mean, big;
	struct bake_render_object o;
	struct relief r;
	struct solid s;

	make_relief(&r, &depth);
	make_solid(&s, BAKE_SHAPE_SPHERE, 8);
	o = object_of(&s, &r.layer, 1);
	p.samples = 2;
	mean = render(&o, 1, &p);
	p = params_of(2 * W, 2 * H);
	big = render(&o, 1, &p);
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			double color = 0, mask = 0, away = 0;

			for (int k = 0; k < 4; k++) {
				const int i =
				    (2 * y + k / 2) * 2 * W + 2 * x + k % 2;

				color += (double)big.color.data[4 * i] / 4;
				mask += (double)big.mask.data[i] / 4;
				if (big.mask.data[i] > 0)
					away += (double)big.distance.data[i];
			}
			CHECK_NEAR((double)mean.color.data[4 * (y * W + x)],
			    color, 1e-6);
			CHECK_NEAR((double)mean.mask.data[y * W + x], mask, 0);
			away /= mask > 0 ? 4 * mask : 1;
			/* four roundings of 2^-24 */
			if (mask > 0)
				CHECK_NEAR(
				    (double)mean.distance.data[y * W + x], away,
				    0x1p-22 * away);
			else
				CHECK(isinf(mean.distance.data[y * W + x]));
		}
	bake_render_buffers_free(&mean);
	bake_render_buffers_free(&big);
	free_relief(&r);
	free_solid(&s);
}

/* -- errors ------------------------------------------------------------------
 */

static void
refused(const struct bake_render_object *o, int n,
    const struct bake_render_params *p, const char *why)
{
	struct bake_render_buffers b = { .want = BAKE_BUFFER_ALL };
	struct bake_err e = BAKE_ERR_INIT;

	CHECK(bake_render(o, n, p, &b, &e) == BAKE_EINVAL);
	CHECK(strstr(e.msg, why) != NULL);
	if (strstr(e.msg, why) == NULL)
		printf("'%s', expected '%s'\n", e.msg, why);
	CHECK(b.color.data == NULL && b.mask.data == NULL);
}

static void
bad_scenes_are_refused(void)
{
	struct bake_image depth = flat(0.5f);
	struct bake_render_params p = params_of(8, 8), bad;
	struct bake_render_object good, o;
	struct relief r;
	struct solid s;

	make_relief(&r, &depth);
	make_solid(&s, BAKE_SHAPE_PLANE, 1);
	good = object_of(&s, &r.layer, 1);
	refused(&good, 0, &p, "no object");
	bad = p;
	bad.samples = 3;
	refused(&good, 1, &bad, "3 x 3 samples");
	bad = p;
	memcpy(bad.camera.target, bad.camera.eye, sizeof bad.camera.eye);
	refused(&good, 1, &bad, "");
	bad = p;
	bad.camera.width = 0;
	refused(&good, 1, &bad, "");
	o = good;
	o.mesh = NULL;
	refused(&o, 1, &p, "a mesh with frames");
	o = good;
	o.frames = NULL;
	refused(&o, 1, &p, "a mesh with frames");
	o = good;
	o.silhouette = BAKE_SILHOUETTE_QUADRIC;
	refused(&o, 1, &p, "object 1 needs quadrics");
	o.silhouette = BAKE_SILHOUETTE_SHELL;
	refused(&o, 1, &p, "a shell and one layer");
	o = good;
	o.impostor = true;
	refused(&o, 1, &p, "multilayer maps");
	o = good;
	o.depth = 0;
	refused(&o, 1, &p, "a depth above 0");
	o.depth = NAN;
	refused(&o, 1, &p, "a depth above 0");
	o.depth = INFINITY;
	refused(&o, 1, &p, "a depth above 0");
	o = good;
	o.tile_v = 0;
	refused(&o, 1, &p, "tile factors above 0");
	free_relief(&r);
	free_solid(&s);
}

int
main(int argc, char **argv)
{
	static const struct check_case cases[] = {
		CASE(flat_relief_is_the_plane_moved_down),
		CASE(sphere_is_a_disc),
		CASE(quadric_silhouette_ends_where_rays_leave),
		CASE(same_bytes_for_any_thread_and_instruction_set),
		CASE(nearest_is_seen_and_the_first_of_equals),
		CASE(reliefs_interpenetrate_plain_geometry),
		CASE(blend_of_one_is_that_one),
		CASE(samples_are_means),
		CASE(bad_scenes_are_refused),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
