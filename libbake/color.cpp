/* Colour spaces: the shim over OpenColorIO; no exception leaves it. */
/* SPDX-License-Identifier: MIT */
#include "color.h"

#include <OpenColorIO/OpenColorIO.h>
#include <omp.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <sstream>
#include <string>
#include <strings.h>
#include <vector>

#include "parallel.h"

namespace OCIO = OCIO_NAMESPACE;

struct bake_color {
	OCIO::ConstConfigRcPtr config;
	std::string path; /* empty: built in */
};

namespace
{

/*
 * The built-in configuration. The matrices are those of the spaces' published
 * primaries and whites to Rec.709, white adapted by Bradford. The curves of
 * sRGB and BT.709 are the library's: the line meets the power smoothly, which
 * the standards' rounded constants miss by 2e-5 of linear light.
 */
const char builtin_head[] = R"(ocio_profile_version: 2
strictparsing: true
roles:
  aces_interchange: ACES2065-1
  color_picking: sRGB
  data: Raw
  default: sRGB
  reference: Linear Rec.709
  scene_linear: Linear Rec.709
  texture_paint: sRGB
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  sRGB:
    - !<View> {name: Raw, colorspace: Raw}
    - !<View> {name: sRGB, colorspace: sRGB}
colorspaces:
)";

const struct {
	const char *name, *aliases;
	const char *transform; /* to the reference; NULL: it itself */
} builtin_spaces[] = {
	{ "Linear Rec.709",
	    "linear, linear_srgb, lin_rec709, lin_rec709_scene, lin_srgb, "
	    "'Linear sRGB', 'Linear Rec.709 (sRGB)', 'Utility - Linear - sRGB',"
	    " 'Utility - Linear - Rec.709', 'scene-linear Rec.709-sRGB'",
	    NULL },
	{ "sRGB",
	    "srgb_texture, srgb_tx, srgb_rec709_scene, 'sRGB - Texture', "
	    "'Utility - sRGB - Texture', 'Input - Generic - sRGB - Texture', "
	    "'sRGB Encoded Rec.709 (sRGB)'",
	    "!<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055}" },
	{ "Rec.709",
	    "Rec709, bt709, camera_rec709, 'Camera Rec.709', "
	    "'Utility - Rec.709 - Camera'",
	    "!<ExponentWithLinearTransform> {gamma: 2.22222222222222, "
	    "offset: 0.099}" },
	{ "Gamma 1.8 Rec.709",
	    "gamma18, g18_rec709, 'Gamma 1.8', "
	    "'Gamma 1.8 Encoded Rec.709', 'Gamma 1.8 Rec.709 - Texture', "
	    "'Utility - Gamma 1.8 - Rec.709 - Texture'",
	    "!<ExponentTransform> {value: 1.8, style: mirror}" },
	{ "Gamma 2.2 Rec.709",
	    "gamma22, g22_rec709, g22_rec709_scene, 'Gamma 2.2', "
	    "'Gamma 2.2 Encoded Rec.709', 'Gamma 2.2 Rec.709 - Texture', "
	    "'Utility - Gamma 2.2 - Rec.709 - Texture'",
	    "!<ExponentTransform> {value: 2.2, style: mirror}" },
	{ "Gamma 2.4 Rec.709",
	    "gamma24, g24_rec709, 'Gamma 2.4', "
	    "'Gamma 2.4 Encoded Rec.709', 'Gamma 2.4 Rec.709 - Texture', "
	    "'Utility - Gamma 2.4 - Rec.709 - Texture', rec1886_rec709",
	    "!<ExponentTransform> {value: 2.4, style: mirror}" },
	{ "Display P3",
	    "srgb_displayp3, srgb_p3d65, p3d65_srgb, "
	    "'sRGB Encoded P3-D65'",
	    "!<GroupTransform> {children: ["
	    "!<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055}, "
	    "!<MatrixTransform> {matrix: ["
	    "1.224940176281, -0.2249401762806, 0, 0, "
	    "-0.04205695470969, 1.04205695471, 0, 0, "
	    "-0.01963755459033, -0.07863604555063, 1.098273600141, 0, "
	    "0, 0, 0, 1]}]}" },
	{ "Linear P3-D65",
	    "lin_p3d65, lin_p3d65_scene, 'Linear P3', "
	    "'Utility - Linear - P3-D65'",
	    "!<MatrixTransform> {matrix: ["
	    "1.224940176281, -0.2249401762806, 0, 0, "
	    "-0.04205695470969, 1.04205695471, 0, 0, "
	    "-0.01963755459033, -0.07863604555063, 1.098273600141, 0, "
	    "0, 0, 0, 1]}" },
	{ "Linear Rec.2020",
	    "lin_rec2020, lin_rec2020_scene, "
	    "'Utility - Linear - Rec.2020'",
	    "!<MatrixTransform> {matrix: ["
	    "1.660491002108, -0.5876411387885, -0.07284986331988, 0, "
	    "-0.1245504745216, 1.132899897126, -0.008349422604369, 0, "
	    "-0.01815076335491, -0.100578898008, 1.118729661363, 0, "
	    "0, 0, 0, 1]}" },
	{ "ACEScg", "lin_ap1, lin_ap1_scene, 'ACES - ACEScg'",
	    "!<MatrixTransform> {matrix: ["
	    "1.705050992658, -0.621792120657, -0.08325887200098, 0, "
	    "-0.130256417507, 1.140804736575, -0.01054831906836, 0, "
	    "-0.02400335680462, -0.128968976065, 1.15297233287, 0, "
	    "0, 0, 0, 1]}" },
	{ "ACES2065-1",
	    "aces2065_1, lin_ap0, lin_ap0_scene, "
	    "'ACES - ACES2065-1'",
	    "!<MatrixTransform> {matrix: ["
	    "2.521686186744, -1.13413098824, -0.3875551985042, 0, "
	    "-0.2764799142299, 1.372719087668, -0.09623917343833, 0, "
	    "-0.01537806496603, -0.1529753358674, 1.168353400833, 0, "
	    "0, 0, 0, 1]}" },
	{ "Raw",
	    "none, non-color, noncolor, 'Non-Color', 'Generic Data', "
	    "'Utility - Raw'",
	    NULL },
};

std::string
builtin_text()
{
	std::string text = builtin_head;

	for (const auto &s : builtin_spaces) {
		text += "  - !<ColorSpace>\n    name: ";
		text += s.name;
		text += std::string("\n    aliases: [") + s.aliases + "]\n";
		text += "    bitdepth: 32f\n";
		if (strcmp(s.name, "Raw") == 0)
			text += "    isdata: true\n";
		if (s.transform != NULL)
			text += std::string("    to_reference: ") +
				s.transform + "\n";
	}
	return text;
}

std::string
one_line(std::string text)
{
	std::replace_if(
	    text.begin(), text.end(),
	    [](char c) { return (unsigned char)c < ' '; }, ' ');
	while (!text.empty() && (text.back() == ' ' || text.back() == '.'))
		text.pop_back();
	return text;
}

/* To be called in a catch block. */
enum bake_status
fail_exception(struct bake_err *err, const std::string &what)
{
	try {
		throw;
	} catch (const std::bad_alloc &) {
		return bake_fail(
		    err, BAKE_ENOMEM, "%s: no memory", what.c_str());
	} catch (const std::exception &e) {
		return bake_fail(err, BAKE_EDATA, "%s: %s", what.c_str(),
		    one_line(e.what()).c_str());
	} catch (...) {
		return bake_fail(
		    err, BAKE_EDATA, "%s: OpenColorIO failed", what.c_str());
	}
}

/* What to call the configuration in a message. */
std::string
title(const struct bake_color *color)
{
	return color->path.empty()
		   ? "the built-in colour configuration"
		   : "the OCIO configuration '" + color->path + "'";
}

/* Whether a file can be read, else errno: the system's own reason is better
 * than the library's, which also loses memory over a folder. Names such as
 * ocio://default are no files. */
bool
is_readable(const char *path)
{
	FILE *fp;
	int reason = 0;

	if (strstr(path, "://") != NULL)
		return true;
	fp = fopen(path, "re");
	if (fp == NULL)
		return false;
	if (fgetc(fp) == EOF && ferror(fp))
		reason = errno;
	fclose(fp);
	errno = reason;
	return reason == 0;
}

enum bake_status
open_config(struct bake_color *color, const char *path, struct bake_err *err)
{
	std::istringstream text;

	if (path == NULL) {
		text.str(builtin_text());
		color->config = OCIO::Config::CreateFromStream(text);
		return BAKE_OK;
	}
	color->path = path;
	if (!is_readable(path))
		return bake_fail(err, BAKE_EIO, "%s: %s", title(color).c_str(),
		    strerror(errno));
	color->config = OCIO::Config::CreateFromFile(path);
	if (!color->config->hasRole(OCIO::ROLE_SCENE_LINEAR))
		return bake_fail(err, BAKE_EDATA,
		    "%s has no role scene_linear, in which colours are blended",
		    title(color).c_str());
	return BAKE_OK;
}

/* "a, b, c" as far as there is room. */
std::string
list_spaces(const OCIO::ConstConfigRcPtr &config, size_t room)
{
	const int n = config->getNumColorSpaces();
	std::string list;

	for (int i = 0; i < n; i++) {
		std::string name = config->getColorSpaceNameByIndex(i);

		if (list.size() + name.size() + 2 > room)
			return list + " and " + std::to_string(n - i) + " more";
		list += (i > 0 ? ", " : "") + name;
	}
	return list;
}

/* Whether a colour space, an alias or a role is called name. The library by
 * itself takes the default space for an unknown one where a configuration is
 * not strict. */
bool
knows(const OCIO::ConstConfigRcPtr &config, const char *name)
{
	OCIO::ConstColorSpaceRcPtr space = config->getColorSpace(name);

	if (!space || config->hasRole(name) ||
	    strcasecmp(space->getName(), name) == 0)
		return (bool)space;
	for (size_t i = 0; i < space->getNumAliases(); i++)
		if (strcasecmp(space->getAlias(i), name) == 0)
			return true;
	return false;
}

/* The conversion of `space` to scene-linear light, or back. */
enum bake_status
make_processor(const struct bake_color *color, const char *space,
    bool to_linear, OCIO::ConstCPUProcessorRcPtr &processor,
    struct bake_err *err)
{
	const char *linear = OCIO::ROLE_SCENE_LINEAR;
	const std::string about = title(color);

	if (!knows(color->config, space)) {
		std::string what = std::string("'") + space +
				   "' is no colour space of " + about;
		size_t used = std::min<size_t>(what.size() + 64, BAKE_ERR_MSG);

		return bake_fail(err, BAKE_EINVAL, "%s, which has %s",
		    what.c_str(),
		    list_spaces(color->config, BAKE_ERR_MSG - used).c_str());
	}
	/* lossless: no fast powers, no tables in place of formulas */
	processor = color->config
			->getProcessor(to_linear ? space : linear,
			    to_linear ? linear : space)
			->getOptimizedCPUProcessor(OCIO::BIT_DEPTH_F32,
			    OCIO::BIT_DEPTH_F32, OCIO::OPTIMIZATION_LOSSLESS);
	return BAKE_OK;
}

/* One row by way of RGBA texels with alpha 0, so that no operator sees, or
 * changes, what is no colour. */
void
convert_row(const OCIO::ConstCPUProcessorRcPtr &processor, float *row,
    int width, int nchans, float *rgba)
{
	const int n = nchans < 3 ? 1 : 3;
	const int last = nchans < 3 ? 0 : 2;
	OCIO::PackedImageDesc desc(rgba, width, 1, 4);

	for (int x = 0; x < width; x++) {
		const float *in = row + (size_t)x * (size_t)nchans;

		rgba[4 * (size_t)x] = in[0];
		rgba[4 * (size_t)x + 1] = in[std::min(1, last)];
		rgba[4 * (size_t)x + 2] = in[last];
		rgba[4 * (size_t)x + 3] = 0;
	}
	processor->apply(desc);
	for (int x = 0; x < width; x++) {
		float *out = row + (size_t)x * (size_t)nchans;
		const float *in = rgba + 4 * (size_t)x;

		if (n == 1)
			out[0] = in[1];
		for (int c = 0; n == 3 && c < 3; c++)
			out[c] = in[c];
	}
}

enum bake_status
convert(const OCIO::ConstCPUProcessorRcPtr &processor, struct bake_image *img,
    int nthreads)
{
	const size_t line = 4 * (size_t)img->width;
	std::vector<float> lines(line * (size_t)nthreads);
	std::exception_ptr failure;

#pragma omp parallel for num_threads(nthreads) schedule(static)
	for (int y = 0; y < img->height; y++) {
		try {
			convert_row(processor, bake_image_row(img, y),
			    img->width, img->nchans,
			    &lines[line * (size_t)omp_get_thread_num()]);
		} catch (...) {
#pragma omp critical(bake_color_failure)
			failure = std::current_exception();
		}
	}
	if (failure)
		std::rethrow_exception(failure);
	return BAKE_OK;
}

enum bake_status
convert_image(const struct bake_color *color, const char *space, bool to_linear,
    struct bake_image *img, int nthreads, struct bake_err *err)
{
	OCIO::ConstCPUProcessorRcPtr processor;
	enum bake_status rc;

	if (img->data == NULL || img->width < 1 || img->height < 1 ||
	    img->nchans < 1 || nthreads < 0)
		return bake_fail(err, BAKE_EINVAL,
		    "a colour image of %dx%d texels and %d channels, on %d "
		    "threads",
		    img->width, img->height, img->nchans, nthreads);
	try {
		rc = make_processor(color, space, to_linear, processor, err);
		if (rc != BAKE_OK || processor->isIdentity())
			return rc;
		return convert(processor, img,
		    std::min(bake_threads(nthreads), img->height));
	} catch (...) {
		return fail_exception(
		    err, title(color) + ", colour space '" + space + "'");
	}
}

} // namespace

enum bake_status
bake_color_open(
    const char *path, struct bake_color **color, struct bake_err *err)
{
	const char *env = getenv("OCIO");
	struct bake_color *c;
	enum bake_status rc;

	*color = NULL;
	if (path == NULL && env != NULL && *env != '\0')
		path = env;
	c = new (std::nothrow) bake_color;
	if (c == NULL)
		return bake_fail(
		    err, BAKE_ENOMEM, "no memory for a colour configuration");
	try {
		rc = open_config(c, path, err);
	} catch (const std::bad_alloc &) { /* nor for a name in a message */
		rc = bake_fail(
		    err, BAKE_ENOMEM, "no memory for a colour configuration");
	} catch (...) {
		rc = fail_exception(err, title(c));
	}
	if (rc != BAKE_OK) {
		delete c;
		return rc;
	}
	*color = c;
	return BAKE_OK;
}

void
bake_color_close(struct bake_color *color)
{
	delete color;
}

const char *
bake_color_path(const struct bake_color *color)
{
	return color->path.empty() ? NULL : color->path.c_str();
}

enum bake_status
bake_color_check(
    const struct bake_color *color, const char *space, struct bake_err *err)
{
	OCIO::ConstCPUProcessorRcPtr processor;
	enum bake_status rc;

	try {
		rc = make_processor(color, space, true, processor, err);
		if (rc == BAKE_OK)
			rc =
			    make_processor(color, space, false, processor, err);
		return rc;
	} catch (...) {
		return fail_exception(
		    err, title(color) + ", colour space '" + space + "'");
	}
}

enum bake_status
bake_color_to_linear(const struct bake_color *color, const char *space,
    struct bake_image *img, int nthreads, struct bake_err *err)
{
	return convert_image(color, space, true, img, nthreads, err);
}

enum bake_status
bake_color_from_linear(const struct bake_color *color, const char *space,
    struct bake_image *img, int nthreads, struct bake_err *err)
{
	return convert_image(color, space, false, img, nthreads, err);
}
