/* The packed relief texture: layouts and targets, metadata, stored normals. */
/* SPDX-License-Identifier: MIT */
#include <stdbool.h>

#include "check.h"
#include "codes.h"
#include "relief.h"
#include "test_maps.h"

/*
 * What each renderer reads, typed from INTERFACE ('Packed relief texture',
 * --target) and CONVENTIONS ('Renderers'). Channels: x y z of the normal, a =
 * AO, r = relief, 0 1, h = a half. d, h: depth or height; u, n: y up or down.
 */
static const struct {
	const char *name, *polarity, *normal_y;
	const char *files[3]; /* "suffix:channels" */
} renderers[] = {
	{ "relief", "depth", "up", { ":xyar" } },
	{ "policarpo", "depth", "down", { ":xyar" } },
	{ "quake3", "height", "up", { ":xyzr" } },
	{ "darkplaces", "height", "up", { ":xyzr" } },
	/* mask map: R metal, G AO, B detail, A smoothness */
	{ "unity-hdrp", "height", "up", { ":xyz", "_height:r", "_mask:0a0h" } },
	/* ORM: R AO, G roughness, B metal */
	{ "unreal", "height", "down", { ":xyz", "_height:r", "_orm:a10" } },
	{ "godot", "height", "up", { ":xyz", "_height:r", "_orm:a10" } },
	{ "bevy", "depth", "up", { ":xyz", "_depth:r", "_ao:a" } },
	{ "three", "height", "up", { ":xyz", "_height:r", "_ao:a" } },
	{ "babylon", "height", "up", { ":xyzr", "_ao:a" } },
	{ "gltf", "depth", "up", { ":xyz", "_orm:a10", "_depth:r" } },
};
static const int nrenderers = sizeof renderers / sizeof *renderers;

static bool
file_is(const struct bake_target_file *file, const char *want)
{
	static const char letters[] = "xyzar0h1"; /* by enum bake_source */
	char text[64];
	int n = snprintf(text, sizeof text, "%s:", file->suffix);

	for (int c = 0; c < file->nchans; c++)
		text[n++] = letters[file->source[c]];
	text[n] = '\0';
	return strcmp(text, want) == 0;
}

static void
targets_are_what_renderers_read(void)
{
	int n;
	const struct bake_target *all = bake_targets(&n);

	CHECK(n == nrenderers);
	CHECK(strcmp(all[0].name, "relief") == 0);
	for (int i = 0; i < nrenderers; i++) {
		const struct bake_target *t =
		    bake_target_find(renderers[i].name);
		int nfiles = 0;

		CHECK(t != NULL);
		if (t == NULL)
			continue;
		CHECK(t >= all && t < all + n);
		CHECK(strcmp(t->name, renderers[i].name) == 0);
		CHECK(t->about != NULL && t->about[0] != '\0');
		CHECK(strcmp(bake_polarity_name(t->polarity),
			  renderers[i].polarity) == 0);
		CHECK(strcmp(bake_normal_y_name(t->normal_y),
			  renderers[i].normal_y) == 0);
		while (nfiles < 3 && renderers[i].files[nfiles] != NULL)
			nfiles++;
		CHECK(t->nfiles == nfiles);
		for (int f = 0; f < nfiles && f < t->nfiles; f++)
			CHECK(file_is(&t->file[f], renderers[i].files[f]));
	}
	CHECK(bake_target_find("") == NULL);
	CHECK(bake_target_find("Relief") == NULL);
	CHECK(bake_target_find("relief ") == NULL);
}

/* The layout that a file of a target declares says what its channels hold. */
static void
layouts_agree_with_channels(void)
{
	static const struct {
		enum bake_layout layout;
		const char *name, *channels;
	} want[] = { { BAKE_LAYOUT_UNKNOWN, "unknown", "" },
		{ BAKE_LAYOUT_RELIEF, "relief", ":xyar" },
		{ BAKE_LAYOUT_NORMAL_RELIEF, "normal-relief", ":xyzr" },
		{ BAKE_LAYOUT_NORMAL, "normal", ":xyz" },
		{ BAKE_LAYOUT_DEPTH, "depth", ":r" },
		{ BAKE_LAYOUT_AO, "ao", ":a" },
		{ BAKE_LAYOUT_ORM, "orm", ":a10" },
		{ BAKE_LAYOUT_MASK, "mask", ":0a0h" },
		{ BAKE_LAYOUT_BENT, "bent", "" },
		{ BAKE_LAYOUT_HORIZONS, "horizons", "" },
		{ BAKE_LAYOUT_ROUGHEN_LUT, "roughen-lut", "" },
		{ BAKE_LAYOUT_LAYER_DEPTH, "layer-depth", "" },
		{ BAKE_LAYOUT_LAYER_NX, "layer-nx", "" },
		{ BAKE_LAYOUT_LAYER_NY, "layer-ny", "" },
		{ BAKE_LAYOUT_LAYER_COLOR, "layer-color", "" } };
	int n;
	const struct bake_target *all = bake_targets(&n);

	for (size_t i = 0; i < sizeof want / sizeof *want; i++)
		CHECK(strcmp(bake_layout_name(want[i].layout), want[i].name) ==
		      0);
	for (int i = 0; i < n; i++)
		for (int f = 0; f < all[i].nfiles; f++) {
			struct bake_target_file file = all[i].file[f];
			bool known = false;

			file.suffix = "";
			for (size_t k = 0; k < sizeof want / sizeof *want; k++)
				if (want[k].layout == file.layout)
					known =
					    file_is(&file, want[k].channels);
			CHECK(known);
		}
}

static bool
same_meta(const struct bake_relief_meta *a, const struct bake_relief_meta *b)
{
	return a->layout == b->layout && a->polarity == b->polarity &&
	       a->normal_y == b->normal_y && a->normal_code == b->normal_code &&
	       (float)a->depth_scale == (float)b->depth_scale &&
	       a->has_wrap == b->has_wrap &&
	       a->wrap.clamp_u == b->wrap.clamp_u &&
	       a->wrap.clamp_v == b->wrap.clamp_v && a->nkeep == b->nkeep &&
	       a->has_ao_scale == b->has_ao_scale &&
	       (float)a->ao_scale == (float)b->ao_scale;
}

/* Every combination, through the attributes and through one line of text. */
static void
metadata_come_back(void)
{
	static const double scales[] = { 0, 0.1, 1e-6, 0.012345678, 10, 1e6 };

	for (int i = 0; i < 10 * 3 * 3 * 3 * 5 * 6; i++) {
		struct bake_relief_meta meta = BAKE_RELIEF_META_INIT, back;
		struct bake_attrs attrs, parsed;
		char line[512];
		int wrap = i / 270 % 5;

		meta.layout = (enum bake_layout)(i % 10);
		meta.has_ao_scale = i % 7 == 0;
		meta.ao_scale = meta.has_ao_scale ? 0.3 : 0;
		meta.polarity = (enum bake_polarity)(i / 10 % 3);
		meta.normal_y = (enum bake_normal_y)(i / 30 % 3);
		meta.normal_code = (enum bake_normal_code)(i / 90 % 3);
		meta.depth_scale = scales[i / 1350];
		meta.has_wrap = wrap > 0;
		meta.wrap.clamp_u = wrap > 0 && (wrap - 1) % 2 != 0;
		meta.wrap.clamp_v = wrap > 0 && (wrap - 1) / 2 != 0;
		bake_attrs_clear(&attrs);
		bake_relief_meta_to_attrs(&meta, &attrs);
		CHECK(attrs.n == (meta.layout != 0) + (meta.polarity != 0) +
				     (meta.normal_y != 0) +
				     (meta.normal_code != 0) +
				     (meta.depth_scale > 0) + meta.has_wrap +
				     meta.has_ao_scale);
		bake_relief_meta_from_attrs(&back, &attrs);
		CHECK(same_meta(&meta, &back));
		bake_attrs_format(&attrs, line, sizeof line);
		bake_attrs_clear(&parsed);
		bake_attrs_parse(&parsed, line);
		bake_relief_meta_from_attrs(&back, &parsed);
		CHECK(same_meta(&meta, &back));
	}
}

static void
metadata_have_their_names(void)
{
	struct bake_relief_meta meta = { BAKE_LAYOUT_RELIEF,
		BAKE_POLARITY_DEPTH, BAKE_NORMAL_Y_DOWN,
		BAKE_NORMAL_CODE_SIGNED, 0.1, true, { true, false }, true, 0.2,
		3, { 0.13, 0.078787878, INFINITY }, { .nlayers = 0 } };
	struct bake_attrs attrs;
	char line[512];

	bake_attrs_clear(&attrs);
	bake_relief_meta_to_attrs(&meta, &attrs);
	bake_attrs_format(&attrs, line, sizeof line);
	CHECK(strcmp(line, "relief:Layout=relief; relief:Polarity=depth; "
			   "relief:NormalY=down; relief:NormalCode=signed; "
			   "relief:DepthScale=0.1; relief:Wrap=clamp-u; "
			   "relief:AOScale=0.2; "
			   "relief:KeepScale=0.13,0.0787879,inf") == 0);
	CHECK(
	    strcmp(bake_normal_code_name(BAKE_NORMAL_CODE_AUTO), "auto") == 0);
	CHECK(strcmp(bake_normal_code_name(BAKE_NORMAL_CODE_UNSIGNED),
		  "unsigned") == 0);
	CHECK(strcmp(bake_polarity_name(BAKE_POLARITY_UNSURE), "unsure") == 0);
	CHECK(strcmp(bake_normal_y_name(BAKE_NORMAL_Y_UNSURE), "unsure") == 0);
}

static struct bake_relief_meta
parsed_meta(const char *line)
{
	struct bake_relief_meta meta;
	struct bake_attrs attrs;

	bake_attrs_clear(&attrs);
	bake_attrs_parse(&attrs, line);
	memset(&meta, 0xa5, sizeof meta);
	bake_relief_meta_from_attrs(&meta, &attrs);
	return meta;
}

static void
hostile_metadata_read_as_not_said(void)
{
	static const char *const nothing[] = { "",
		"relief:Layout=; relief:Polarity=; relief:NormalY=; "
		"relief:NormalCode=; relief:DepthScale=; relief:Wrap=",
		"relief:Layout=Relief; relief:Polarity=DEPTH; "
		"relief:NormalY=upp; "
		"relief:NormalCode=2; relief:Wrap=none",
		"relief:DepthScale=nan", "relief:DepthScale=-nan",
		"relief:DepthScale=inf", "relief:DepthScale=-inf",
		"relief:DepthScale=1e999", "relief:DepthScale=-1",
		"relief:DepthScale=0", "relief:DepthScale=-0",
		"relief:DepthScale=abc", "relief:DepthScale=0.1abc",
		"relief:DepthScale=0.1,5", "relief:DepthScale=1/10",
		"relief:DepthScale=--1", "relief:DepthScale=0.1 0.2",
		"relief:depthscale=0.1", "DepthScale=0.1",
		"relief:Layout=unknown; relief:Polarity=unsure; "
		"relief:NormalY=unsure; relief:NormalCode=auto",
		"relief:KeepScale=", "relief:KeepScale=,",
		"relief:KeepScale=0.1,", "relief:KeepScale=,0.1",
		"relief:KeepScale=0.1,0", "relief:KeepScale=0.1,-1",
		"relief:KeepScale=0.1 0.2", "relief:KeepScale=0.1,nan",
		"relief:KeepScale=1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17",
		/* no attribute takes another's words */
		"relief:Layout=height; relief:Polarity=up; "
		"relief:NormalY=depth; "
		"relief:NormalCode=tile; relief:Wrap=signed" };
	struct bake_relief_meta none = BAKE_RELIEF_META_INIT, meta;
	char line[400];

	for (size_t i = 0; i < sizeof nothing / sizeof *nothing; i++) {
		meta = parsed_meta(nothing[i]);
		if (!same_meta(&meta, &none))
			printf("'%s' was understood\n", nothing[i]);
		CHECK(same_meta(&meta, &none));
	}
	strcpy(line, "relief:DepthScale=");
	memset(line + strlen(line), '1', 300);
	line[318] = '\0';
	meta = parsed_meta(line);
	CHECK(same_meta(&meta, &none));
	meta = parsed_meta("relief:Polarity=depth; relief:Polarity=height");
	CHECK(meta.polarity == BAKE_POLARITY_HEIGHT);
	meta = parsed_meta("relief:DepthScale=2.5e-1; relief:Wrap=clamp-v");
	CHECK(meta.depth_scale == 0.25 && meta.has_wrap && !meta.wrap.clamp_u &&
	      meta.wrap.clamp_v);
}

/* As many digits as there is room for, 6 at most and 3 at least. */
static void
lists_of_keep_scales_come_back(void)
{
	for (int n = 1; n <= BAKE_KEEP_SCALES; n++) {
		struct bake_relief_meta meta = BAKE_RELIEF_META_INIT, back;
		struct bake_attrs attrs;

		meta.nkeep = n;
		for (int i = 0; i < n; i++)
			meta.keep_scale[i] =
			    i % 5 == 4 ? INFINITY : 0.123456789 / (i + 1);
		bake_attrs_clear(&attrs);
		bake_relief_meta_to_attrs(&meta, &attrs);
		bake_relief_meta_from_attrs(&back, &attrs);
		CHECK(back.nkeep == n);
		for (int i = 0; i < n; i++)
			if (isinf(meta.keep_scale[i]))
				CHECK(isinf(back.keep_scale[i]));
			else
				/* half of the last of 6 digits, or of 3 */
				CHECK_NEAR(
				    back.keep_scale[i] / meta.keep_scale[i], 1,
				    n <= 10 ? 5e-6 : 5e-3);
	}
}

static bool
same_layers(const struct bake_layer_meta *a, const struct bake_layer_meta *b)
{
	double range = 1e-9 * fabs(a->one - a->zero);
	double side =
	    fmax(a->region[2] - a->region[0], a->region[3] - a->region[1]);

	/* as precise as the header says; numbers are floats */
	for (int i = 0; i < 4; i++)
		if (!(fabs(a->region[i] - b->region[i]) <= 1e-7 * side))
			return false;
	return a->nlayers == b->nlayers && a->texture == b->texture &&
	       a->ntextures == b->ntextures && a->has_range == b->has_range &&
	       fabs(a->zero - b->zero) <= range &&
	       fabs(a->one - b->one) <= range &&
	       strcmp(a->axis, b->axis) == 0 &&
	       a->has_region == b->has_region && a->mip_level == b->mip_level &&
	       a->has_tau == b->has_tau && (float)a->tau == (float)b->tau &&
	       a->has_plane == b->has_plane &&
	       (float)a->plane == (float)b->plane;
}

static struct bake_layer_meta
some_layers(int i)
{
	static const double origin[] = { 0, -0.3, 1e-6, 12345.678, -1e9,
		1e-30 };
	static const double size[] = { 1, 1.0 / 3, 1e-6, 4096.1, 1e12 };
	double o = origin[i % 6], s = size[i / 6 % 5];
	struct bake_layer_meta m = { .nlayers = 1 + 3 * (i % 7) };

	m.texture = i / 30 % 2;
	m.ntextures = m.texture * 16;
	if (i % 4 != 0)
		bake_layer_meta_set_range(&m, o + s, o);
	if (i % 5 != 0)
		m.axis[0] = "+-"[i % 2], m.axis[1] = (char)('x' + i % 3);
	m.has_region = i % 3 != 0;
	for (int k = 0; m.has_region && k < 4; k++)
		m.region[k] = k < 2 ? o - s : o + s * k / 3;
	m.mip_level = i % 9;
	m.has_tau = i % 9 > 4;
	m.tau = m.has_tau ? 0.123456789 * (i % 8) : 0;
	m.has_plane = i % 11 == 0;
	m.plane = m.has_plane ? 0.5 : 0;
	return m;
}

/* Through the attributes, and through one line of text. */
static void
layers_come_back(void)
{
	for (int i = 0; i < 60 * 7 * 11; i++) {
		struct bake_relief_meta meta = BAKE_RELIEF_META_INIT, back;
		struct bake_attrs attrs, parsed;
		char line[1024];

		meta.layout = BAKE_LAYOUT_LAYER_DEPTH;
		meta.normal_y = BAKE_NORMAL_Y_DOWN;
		meta.depth_scale = 0.1;
		meta.layer = some_layers(i);
		bake_attrs_clear(&attrs);
		bake_relief_meta_to_attrs(&meta, &attrs);
		CHECK(attrs.n <= 13);
		memset(&back, 0xa5, sizeof back);
		bake_relief_meta_from_attrs(&back, &attrs);
		CHECK(same_meta(&meta, &back));
		CHECK(same_layers(&meta.layer, &back.layer));
		bake_attrs_format(&attrs, line, sizeof line);
		bake_attrs_clear(&parsed);
		bake_attrs_parse(&parsed, line);
		bake_relief_meta_from_attrs(&back, &parsed);
		CHECK(same_layers(&meta.layer, &back.layer));
	}
}

static void
layers_have_their_names(void)
{
	struct bake_relief_meta meta = { .layout = BAKE_LAYOUT_LAYER_NX,
		.normal_y = BAKE_NORMAL_Y_UP,
		.layer = { .nlayers = 10,
		    .texture = 2,
		    .ntextures = 3,
		    .has_range = true,
		    .zero = 1.0 / 3,
		    .one = -2,
		    .axis = "-y",
		    .has_region = true,
		    .region = { -1, -0.25, 1, 2.0 / 3 },
		    .mip_level = 3,
		    .has_tau = true,
		    .tau = 0.375,
		    .has_plane = true,
		    .plane = 0.5 } };
	struct bake_attrs attrs;
	char line[512];

	bake_attrs_clear(&attrs);
	bake_relief_meta_to_attrs(&meta, &attrs);
	bake_attrs_format(&attrs, line, sizeof line);
	CHECK(strcmp(line, "relief:Layout=layer-nx; relief:Layers=10; "
			   "relief:Texture=2/3; "
			   "relief:DepthZero=0.333333333; relief:DepthOne=-2; "
			   "relief:Axis=-y; "
			   "relief:Region=-1,-0.25,1,0.6666667; "
			   "relief:MipLevel=3; relief:Tau=0.375; "
			   "relief:Plane=0.5; relief:NormalY=up") == 0);
	CHECK(bake_layout_is_layered(BAKE_LAYOUT_LAYER_DEPTH));
	CHECK(bake_layout_is_layered(BAKE_LAYOUT_LAYER_COLOR));
	CHECK(!bake_layout_is_layered(BAKE_LAYOUT_ROUGHEN_LUT));
	CHECK(!bake_layout_is_layered(BAKE_LAYOUT_UNKNOWN));
}

/* A coordinate far from the origin keeps what counts: its place within the
 * range, which a float would lose. */
static void
layer_ranges_far_away_are_kept(void)
{
	struct bake_relief_meta meta = BAKE_RELIEF_META_INIT, back;
	struct bake_attrs attrs;

	meta.layout = BAKE_LAYOUT_LAYER_DEPTH;
	meta.layer.nlayers = 4;
	bake_layer_meta_set_range(&meta.layer, 1e8 + 1.125, 1e8 + 1);
	bake_attrs_clear(&attrs);
	bake_relief_meta_to_attrs(&meta, &attrs);
	bake_relief_meta_from_attrs(&back, &attrs);
	/* 1e-9 of the range is below the steps of a double there, 1.5e-8 */
	CHECK_NEAR(back.layer.zero, meta.layer.zero, 0);
	CHECK_NEAR(back.layer.one, meta.layer.one, 0);
}

/* d' = (1 + 253 d) / 255 is at Z = near + d (far - near). */
static void
layer_ranges_are_those_of_stored_depths(void)
{
	static const double ranges[][2] = { { 1, 0 }, { 2, -3 }, { -1, -1.5 },
		{ 0, 1 } };

	for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
		double near = ranges[i][0], far = ranges[i][1], back[2];
		struct bake_layer_meta m = { .nlayers = 2 };

		bake_layer_meta_set_range(&m, near, far);
		CHECK(m.has_range);
		for (int k = 0; k <= 8; k++) {
			double d = k / 8.0, stored = (1 + 253 * d) / 255;

			/* a few roundings of numbers up to 5 */
			CHECK_NEAR(m.zero + (m.one - m.zero) * stored,
			    near + d * (far - near), 0x1p-49);
		}
		bake_layer_meta_range(&m, &back[0], &back[1]);
		CHECK_NEAR(back[0], near, 0x1p-49);
		CHECK_NEAR(back[1], far, 0x1p-49);
	}
}

static void
hostile_layers_read_as_not_said(void)
{
	static const char *const none[] = {
		"relief:Layers=0", "relief:Layers=-4", "relief:Layers=4.5",
		"relief:Layers=nan", "relief:Layers=65537",
		"relief:Layers=1e99", "relief:Layers=", "relief:Layers=4x",
		"relief:Layers=4,4", "relief:Axis=+z",
		"relief:Region=0,0,1,1; relief:DepthZero=1; relief:DepthOne=0"
	};
	static const char *const nothing_else[] = {
		"relief:Texture=0/1; relief:DepthZero=1; relief:Axis=z",
		"relief:Texture=3/2; relief:DepthOne=1; relief:Axis=+w",
		"relief:Texture=1; relief:DepthZero=1; relief:DepthOne=1",
		"relief:Texture=1/; relief:DepthZero=inf; relief:DepthOne=0",
		"relief:Texture=/1; relief:DepthZero=nan; relief:DepthOne=0",
		"relief:Texture=1/70000; relief:DepthZero=; relief:DepthOne=0",
		"relief:Texture=1.5/2; relief:Axis=+zz; relief:Region=",
		"relief:Region=0,0,1; relief:Plane=half; relief:Tau=2",
		"relief:Region=0,0,1,1,; relief:Tau=-1; relief:MipLevel=-1",
		"relief:Region=0,0,0,1; relief:Tau=nan; relief:MipLevel=31",
		"relief:Region=0,1,1,0; relief:Plane=inf; relief:MipLevel=0.5",
		"relief:Region=0,0,1,inf; relief:Axis=; relief:MipLevel=x",
		"relief:Region=0;0;1;1; relief:Axis=zx"
	};
	struct bake_layer_meta empty = { .nlayers = 0 };
	struct bake_relief_meta meta;
	char line[256];

	for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
		meta = parsed_meta(none[i]);
		CHECK(memcmp(&meta.layer, &empty, sizeof empty) == 0);
	}
	for (size_t i = 0; i < sizeof nothing_else / sizeof *nothing_else;
	     i++) {
		snprintf(
		    line, sizeof line, "relief:Layers=4; %s", nothing_else[i]);
		meta = parsed_meta(line);
		CHECK(meta.layer.nlayers == 4);
		meta.layer.nlayers = 0;
		if (memcmp(&meta.layer, &empty, sizeof empty) != 0)
			printf("'%s' was understood\n", nothing_else[i]);
		CHECK(memcmp(&meta.layer, &empty, sizeof empty) == 0);
	}
}

static struct bake_layer_check
checked(float *v, int n, int nlayers, int code_max)
{
	static const int rgba[4] = { 0, 1, 2, 3 };
	struct bake_image img = { n, 1, 4, (size_t)n * 4, v };
	struct bake_layer_check c;

	bake_layer_check(&img, rgba, nlayers, code_max, &c);
	return c;
}

static void
layers_are_checked(void)
{
	const float lo = 1 / 255.0f, hi = 254 / 255.0f;
	float good[] = { 1, 1, 1, 1, lo, hi, 1, 1, 0.1f, 0.2f, 0.3f, 0.4f };
	float field[] = { 0.5f, 1, 1, 1, lo, 1, 1, 1 };
	float bad[] = { 0.5f, 1, 1, 1, /* odd */
		0.5f, 0.5f, 1, 1,      /* not increasing */
		1, 1, 0.5f, 0.6f,      /* after an empty one */
		0, 0.5f, 1, 1,         /* no stored depth */
		0.5f, NAN, 1, 1,       /* odd, and no depth */
		0.3f, 1.5f, 0.4f, 1 };
	struct bake_layer_check c = checked(good, 3, 4, 255);

	CHECK(c.texels[0] == 1 && c.texels[2] == 1 && c.texels[4] == 1);
	CHECK(c.texels[1] == 0 && c.texels[3] == 0);
	CHECK(c.odd == 0 && c.unordered == 0 && c.outside == 0);
	CHECK(c.min == lo && c.max == hi);
	c = checked(field, 2, 1, 0);
	CHECK(c.texels[1] == 2 && c.odd == 0 && c.unordered == 0);
	c = checked(bad, 6, 4, 65535);
	CHECK(c.texels[1] == 2 && c.texels[2] == 4);
	CHECK(c.odd == 2 && c.unordered == 3 && c.outside == 3);
	c = checked(good, 1, 4, 255);
	CHECK(isnan(c.min) && isnan(c.max) && c.texels[0] == 1);
}

/* Each channel of each file of each target, bit for bit. */
static void
pack_puts_planes_in_channels(void)
{
	struct bake_image normal = noise(7, 5, 3), ao = image(7, 5, 1);
	struct bake_image relief = image(7, 5, 1);
	int n;
	const struct bake_target *all = bake_targets(&n);

	for (int i = 0; i < 35; i++) {
		ao.data[i] = (float)i / 255.0f;
		relief.data[i] = (float)(35 - i) / 65535.0f;
	}
	for (int i = 0; i < n * 3; i++) {
		const struct bake_target_file *f = &all[i / 3].file[i % 3];
		struct bake_image out = BAKE_IMAGE_INIT;
		struct bake_err err = BAKE_ERR_INIT;

		if (i % 3 >= all[i / 3].nfiles)
			continue;
		CHECK_OK(bake_relief_pack(f, &normal, &ao, &relief, &out, &err),
		    err);
		CHECK(out.width == 7 && out.height == 5 &&
		      out.nchans == f->nchans);
		for (int k = 0; k < 35 * f->nchans; k++) {
			int t = k / f->nchans;
			const float of[] = { normal.data[3 * t],
				normal.data[3 * t + 1], normal.data[3 * t + 2],
				ao.data[t], relief.data[t], 0.0f, 0.5f, 1.0f };

			CHECK(
			    memcmp(&out.data[k], &of[f->source[k % f->nchans]],
				sizeof(float)) == 0);
		}
		bake_image_free(&out);
	}
	bake_image_free(&normal);
	bake_image_free(&ao);
	bake_image_free(&relief);
}

static void
pack_wants_what_it_needs(void)
{
	struct bake_image normal = noise(4, 3, 3), two = noise(4, 3, 2);
	struct bake_image ao = noise(4, 3, 1), wide = noise(5, 3, 1);
	struct bake_image high = noise(4, 4, 1), out = BAKE_IMAGE_INIT;
	const struct bake_target_file *packed =
	    &bake_target_find("relief")->file[0];
	const struct bake_target_file *flat =
	    &bake_target_find("bevy")->file[0];
	const struct bake_target_file *alone =
	    &bake_target_find("bevy")->file[2];
	const struct {
		const struct bake_target_file *file;
		const struct bake_image *normal, *ao, *relief;
	} bad[] = { { packed, NULL, NULL, NULL }, { packed, NULL, &ao, &ao },
		{ packed, &normal, NULL, &ao }, { packed, &normal, &ao, NULL },
		{ packed, &normal, &wide, &ao },
		{ packed, &normal, &ao, &high }, { flat, &two, NULL, NULL },
		{ alone, &normal, NULL, &ao } };

	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct bake_err err = BAKE_ERR_INIT;

		CHECK(bake_relief_pack(bad[i].file, bad[i].normal, bad[i].ao,
			  bad[i].relief, &out, &err) == BAKE_EINVAL);
		CHECK(err.msg[0] != '\0' && out.data == NULL);
	}
	for (int i = 0; i < 3; i++) {
		struct bake_err err = BAKE_ERR_INIT;

		/* x and y are enough for the packed one */
		CHECK_OK(bake_relief_pack(i == 0 ? packed : alone,
			     i == 0 ? &two : NULL, &ao, i < 2 ? &ao : NULL,
			     &out, &err),
		    err);
		bake_image_free(&out);
	}
	{
		struct bake_err err = BAKE_ERR_INIT;

		/* the message tells what is wrong, not that 4x3 is not 4x3 */
		bake_relief_pack(flat, &two, NULL, NULL, &out, &err);
		CHECK(strstr(err.msg, "channel") != NULL);
	}
	bake_image_free(&normal);
	bake_image_free(&two);
	bake_image_free(&ao);
	bake_image_free(&wide);
	bake_image_free(&high);
}

/* All codes of one width, as one row of `nchans` channels. */
static struct bake_image
all_codes(int max, int nchans)
{
	struct bake_image img = image(max + 1, 1, nchans);

	for (int c = 0; c <= max; c++)
		for (int k = 0; k < nchans; k++)
			img.data[c * nchans + k] = (float)c / (float)max;
	return img;
}

static int
code_of(float v, int max)
{
	uint8_t c8;
	uint16_t c16;

	if (max == 255)
		bake_codes_to_u8(&c8, &v, 1);
	else
		bake_codes_to_u16(&c16, &v, 1);
	return max == 255 ? c8 : c16;
}

static void
flip_mirrors_every_code(void)
{
	for (int max = 255; max <= 65535; max += 65280) {
		struct bake_image img = all_codes(max, 3);

		bake_relief_flip(&img, 1);
		for (int c = 0; c <= max; c++) {
			CHECK(code_of(img.data[3 * c + 1], max) == max - c);
			CHECK(code_of(img.data[3 * c], max) == c);
			CHECK(code_of(img.data[3 * c + 2], max) == c);
		}
		bake_relief_flip(&img, 1);
		for (int c = 0; c <= max; c++)
			CHECK(code_of(img.data[3 * c + 1], max) == c);
		bake_image_free(&img);
	}
}

static void
normals_decode_and_encode(void)
{
	for (int k = 0; k < 2 * 3 * 2; k++) {
		int max = k % 2 == 0 ? 255 : 65535, nc = 2 + k / 2 % 3;
		bool flip = k / 6 != 0;
		struct bake_image img = all_codes(max, nc);

		bake_normal_decode(&img, BAKE_NORMAL_CODE_UNSIGNED, flip);
		for (int c = 0; c <= max; c++) {
			double n = (2.0 * c - max) / max;
			float *v = &img.data[c * nc];

			/* v is off by 2^-25 at most, and 2 v - 1 is rounded
			 * once more, to half an ulp of 1 */
			CHECK_NEAR((double)v[0], n, 0x1p-24 + 0x1p-25);
			CHECK_NEAR(
			    (double)v[1], flip ? -n : n, 0x1p-24 + 0x1p-25);
			/* the fourth is no part of the normal */
			CHECK(nc < 4 || code_of(v[3], max) == c);
		}
		bake_normal_encode(&img, flip);
		for (int i = 0; i < (max + 1) * nc; i++)
			CHECK(code_of(img.data[i], max) == i / nc);
		bake_image_free(&img);
	}
}

/* The conventions of the stored codes: n = 2c - 1, c = n, y negated. */
static void
decode_follows_the_code(void)
{
	for (int k = 0; k < 6; k++) {
		float v[4] = { 0.25f, 0.75f, 1.0f, 0.125f };
		struct bake_image img = { 1, 1, 4, 4, v };
		enum bake_normal_code code = (enum bake_normal_code)(k / 2);
		bool is_signed = code == BAKE_NORMAL_CODE_SIGNED;
		float y = is_signed ? 0.75f : 0.5f;

		bake_normal_decode(&img, code, k % 2 != 0);
		CHECK(v[0] == (is_signed ? 0.25f : -0.5f));
		CHECK(v[1] == (k % 2 != 0 ? -y : y));
		CHECK(v[2] == 1.0f && v[3] == 0.125f);
	}
}

/* Unit normals leaning every way up to `lean`, signed or stored as (n + 1)/2.
 */
static struct bake_image
dome(int nchans, bool is_signed, double from, double lean)
{
	struct bake_image img = image(16, 16, nchans);

	for (int i = 0; i < 256; i++) {
		double t = from + (lean - from) * (i / 16) / 15.0;
		double a = 2 * pi * (i % 16) / 16;
		double n[3] = { sin(t) * cos(a), sin(t) * sin(a), cos(t) };

		for (int c = 0; c < nchans; c++)
			img.data[i * nchans + c] =
			    (float)(is_signed ? n[c] : (n[c] + 1) / 2);
	}
	return img;
}

static void
code_is_told_by_the_values(void)
{
	for (int nc = 2; nc <= 3; nc++) {
		struct bake_image s = dome(nc, true, 0, 1);
		struct bake_image u = dome(nc, false, 0, 1);

		CHECK(bake_normal_code_of(&s) == BAKE_NORMAL_CODE_SIGNED);
		CHECK(bake_normal_code_of(&u) == BAKE_NORMAL_CODE_UNSIGNED);
		bake_image_free(&s);
		bake_image_free(&u);
	}
	for (int is_signed = 0; is_signed < 2; is_signed++) {
		enum bake_normal_code want = is_signed
						 ? BAKE_NORMAL_CODE_SIGNED
						 : BAKE_NORMAL_CODE_UNSIGNED;
		/* flat: (0, 0, 1) or (0.5, 0.5, 1); no sign tells */
		struct bake_image flat = dome(3, is_signed != 0, 0, 0);
		/* x, y >= 0 throughout: the length alone tells */
		struct bake_image quarter = dome(3, is_signed != 0, 0, 1);

		CHECK(bake_normal_code_of(&flat) == want);
		for (int i = 0; i < 256 * 3; i++) {
			float n = quarter.data[i];

			quarter.data[i] = is_signed  ? fabsf(n)
					  : n < 0.5f ? 1.0f - n
						     : n;
		}
		CHECK(bake_normal_code_of(&quarter) == want);
		bake_image_free(&flat);
		bake_image_free(&quarter);
	}
}

int
main(int argc, char *argv[])
{
	static const struct check_case cases[] = {
		CASE(targets_are_what_renderers_read),
		CASE(layouts_agree_with_channels),
		CASE(metadata_come_back),
		CASE(metadata_have_their_names),
		CASE(hostile_metadata_read_as_not_said),
		CASE(lists_of_keep_scales_come_back),
		CASE(layers_come_back),
		CASE(layers_have_their_names),
		CASE(layer_ranges_far_away_are_kept),
		CASE(layer_ranges_are_those_of_stored_depths),
		CASE(hostile_layers_read_as_not_said),
		CASE(layers_are_checked),
		CASE(pack_puts_planes_in_channels),
		CASE(pack_wants_what_it_needs),
		CASE(flip_mirrors_every_code),
		CASE(normals_decode_and_encode),
		CASE(decode_follows_the_code),
		CASE(code_is_told_by_the_values),
	};

	return check_main(argc, argv, cases, sizeof cases / sizeof *cases);
}
