/* Writing image files: the shim over OpenImageIO; no exception leaves it. */
/* SPDX-License-Identifier: MIT */
#include "io_exr.h"
#include "io_image_priv.hpp"

#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <vector>

using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using OIIO::Filesystem::IOProxy;

namespace
{

/* A stream to write to. It remembers the first failure: some of the format
 * writers pass over one. */
class StreamProxy : public OIIO::Filesystem::IOFile
{
      public:
	StreamProxy(FILE *stream) : IOFile(stream, Write)
	{
	}
	size_t
	write(const void *buf, size_t size) override
	{
		return note(IOFile::write(buf, size), size);
	}
	size_t
	pwrite(const void *buf, size_t size, int64_t offset) override
	{
		return note(IOFile::pwrite(buf, size, offset), size);
	}
	bool
	seek(int64_t offset) override
	{
		/* what was buffered is written now */
		return note(IOFile::seek(offset), 1) != 0;
	}
	int failure = 0;

      private:
	size_t
	note(size_t n, size_t size)
	{
		if (n != size && failure == 0)
			failure = errno != 0 ? errno : EIO;
		return n;
	}
};

const char *
plugin_of(enum bake_file_type type)
{
	static const char *const names[] = { "png", "targa", "tiff",
		"openexr" };

	return names[type];
}

TypeDesc
type_of(enum bake_data_format format)
{
	static const TypeDesc::BASETYPE types[] = { TypeDesc::UINT8,
		TypeDesc::UINT16, TypeDesc::HALF, TypeDesc::FLOAT };

	return TypeDesc(types[format]);
}

/*
 * TGA's comment is 4 lines of 80 characters and one more byte each: no
 * attribute may run across two lines. Those for which no room is left are left
 * out whole, since half a number would be another number.
 */
std::string
tga_comment(const struct bake_attrs *attrs)
{
	const size_t line = 81, nlines = 4;
	std::string text;

	for (int i = 0; i < attrs->n; i++) {
		const struct bake_attr *a = &attrs->attr[i];

		if (strncmp(a->name, "Recipe", 6) == 0)
			continue; /* has a place of its own */
		std::string one =
		    std::string("relief:") + a->name + "=" + a->value + ";";
		size_t used = text.size() % line;
		size_t gap = used == 0                       ? 0
			     : used + 1 + one.size() >= line ? line - used
							     : 1;

		if (one.size() < line &&
		    text.size() + gap + one.size() < nlines * line)
			text += std::string(gap, ' ') + one;
	}
	return text;
}

/* A record stands in fields of 40 characters that nothing else needs: the
 * job's and the software's name. What does not fit is left out. */
void
put_tga_record(ImageSpec &spec, const struct bake_attrs *attrs)
{
	const char *recipe = bake_attrs_get(attrs, "Recipe");
	const char *files = bake_attrs_get(attrs, "RecipeFiles");

	if (recipe != NULL && strlen(recipe) <= 40)
		spec.attribute("DocumentName", recipe);
	if (files != NULL && strlen(files) <= 40)
		spec.attribute("Software", files);
}

void
put_attrs(ImageSpec &spec, const struct bake_write_params *params)
{
	char line[BAKE_ATTRS_MAX * (BAKE_ATTR_NAME + BAKE_ATTR_VALUE + 16)];

	if (params->type == BAKE_FILE_EXR) {
		for (int i = 0; i < params->attrs.n; i++) {
			const struct bake_attr *a = &params->attrs.attr[i];
			std::string name = std::string("relief:") + a->name;

			if (a->number)
				spec.attribute(name, strtof(a->value, NULL));
			else
				spec.attribute(name, a->value);
		}
		return;
	}
	if (params->attrs.n == 0)
		return;
	if (params->type == BAKE_FILE_TGA)
		put_tga_record(spec, &params->attrs);
	bake_attrs_format(&params->attrs, line, sizeof line);
	spec.attribute("ImageDescription", params->type == BAKE_FILE_TGA
					       ? tga_comment(&params->attrs)
					       : std::string(line));
}

/* libpng's PNG_FILTER_PAETH */
const int png_filter_paeth = 0x80;

/* What is written: an image of floats, pixels in a format of their own, or
 * rows that are made when they are asked for. */
struct picture {
	int width, height, nchans;
	const struct bake_image *img; /* one of the three */
	const struct bake_pixels *px;
	const struct bake_row_source *rows;
};

ImageSpec
make_spec(const struct picture &pic, const struct bake_write_params *params)
{
	static const char *const usual[4][4] = { { "Y" }, { "Y", "A" },
		{ "R", "G", "B" }, { "R", "G", "B", "A" } };
	ImageSpec spec(
	    pic.width, pic.height, pic.nchans, type_of(params->data_format));

	for (int c = 0; c < pic.nchans; c++) {
		if (params->names != NULL)
			spec.channelnames[(size_t)c] = params->names[c];
		else if (pic.nchans <= 4)
			spec.channelnames[(size_t)c] = usual[pic.nchans - 1][c];
		else /* numbered so that they sort in order */
			spec.channelnames[(size_t)c] =
			    OIIO::Strutil::fmt::format("c{:06d}", c);
	}
	spec.alpha_channel = pic.nchans == 4 ? 3 : pic.nchans == 2 ? 1 : -1;
	/* EXR knows associated alpha only; to set this would make OpenImageIO
	 * multiply. Everywhere else the absence would make it divide. */
	if (params->type != BAKE_FILE_EXR)
		spec.attribute("oiio:UnassociatedAlpha", 1);
	else
		spec.alpha_channel = -1;
	spec.attribute("oiio:ColorSpace", "Linear");
	spec.attribute("DateTime", "");
	spec.attribute("Software", "");
	spec.attribute("png:compressionLevel", params->png_level);
	spec.attribute("png:filter", png_filter_paeth);
	spec.attribute("oiio:dither", 0);
	if (params->type == BAKE_FILE_TIFF || params->type == BAKE_FILE_EXR)
		spec.attribute("compression", "zip");
	if (params->tile > 0) {
		spec.tile_width = spec.tile_height = params->tile;
		spec.tile_depth = 1;
	}
	/* offsets of 32 bits end at 4 GiB; deflate may add a little */
	if (params->type == BAKE_FILE_TIFF &&
	    spec.image_bytes(true) > (uint64_t)0xff << 24)
		spec.attribute("tiff:bigtiff", 1);
	put_attrs(spec, params);
	return spec;
}

/* Codes of n values into band, as `type`. Returns how many were clipped. */
size_t
band_to_codes(std::vector<unsigned char> &band, const float *in, size_t n,
    enum bake_data_format format)
{
	if (format == BAKE_DATA_UINT8)
		return bake_codes_to_u8(band.data(), in, n);
	return bake_codes_to_u16((uint16_t *)band.data(), in, n);
}

/* Rows y .. end - 1 as floats. */
enum bake_status
band_of_floats(std::vector<float> &rows, const struct picture &pic, int y,
    int end, struct bake_err *err)
{
	size_t row = (size_t)pic.width * (size_t)pic.nchans;

	rows.resize(row * (size_t)(end - y));
	if (pic.rows != NULL)
		return pic.rows->get(
		    pic.rows->arg, y, end - y, rows.data(), err);
	for (int i = y; i < end; i++) {
		float *to = &rows[row * (size_t)(i - y)];

		if (pic.px != NULL)
			bake_pixels_get(pic.px, 0, i, pic.width, to);
		else
			memcpy(to, bake_image_row(pic.img, i),
			    row * sizeof(float));
	}
	return BAKE_OK;
}

/* A row of pixels as they are. */
const void *
pixel_row(const struct bake_pixels *px, int y)
{
	size_t row =
	    (size_t)px->width * (size_t)px->nchans * type_of(px->format).size();

	return (const unsigned char *)px->data + row * (size_t)y;
}

/* Rows y .. end - 1, all of them in one call: whole rows of tiles, or
 * scanlines. */
bool
put_band(ImageOutput *out, int y, int end, TypeDesc type, const void *data)
{
	const ImageSpec &spec = out->spec();

	if (spec.tile_width > 0)
		return out->write_tiles(
		    0, spec.width, y, end, 0, 1, type, data);
	return out->write_scanlines(y, end, 0, type, data);
}

/* BAKE_EIO without a message: what the image library has to say is known to
 * the caller. */
enum bake_status
write_all(ImageOutput *out, const struct picture &pic,
    const struct bake_write_params *params, size_t *nclipped,
    struct bake_err *err)
{
	const enum bake_data_format format = params->data_format;
	const size_t row = (size_t)pic.width * (size_t)pic.nchans;
	const int step = params->tile > 0 ? params->tile : bake_io_band_rows();
	bool codes = bake_data_format_max(format) != 0;
	bool untouched = pic.px != NULL && pic.px->format == format;
	std::vector<unsigned char> band;
	std::vector<float> rows;

	if (codes && !untouched)
		band.resize(row * (size_t)std::min(step, pic.height) *
			    type_of(format).size());
	for (int y = 0; y < pic.height; y += step) {
		int end = std::min(y + step, pic.height);
		const void *data;
		TypeDesc type =
		    codes || untouched ? type_of(format) : TypeDesc::FLOAT;

		if (untouched) {
			data = pixel_row(pic.px, y);
		} else {
			enum bake_status rc =
			    band_of_floats(rows, pic, y, end, err);

			if (rc != BAKE_OK)
				return rc;
			data = rows.data();
		}
		if (codes && !untouched) {
			*nclipped += band_to_codes(
			    band, rows.data(), rows.size(), format);
			data = band.data();
		}
		if (!put_band(out, y, end, type, data))
			return BAKE_EIO;
	}
	return BAKE_OK;
}

/* Whether a TIFF has its directory and its last strip. libtiff writes both when
 * it closes the file, and nobody is told where it fails (for want of memory).
 */
bool
tiff_is_whole(FILE *stream, const char *name)
{
	OIIO::Filesystem::IOFile file(stream, IOProxy::Read);
	IOProxy *pointer = &file;
	std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create("tiff");
	ImageSpec spec, config;
	std::vector<unsigned char> row;

	config.attribute("oiio:ioproxy", TypeDesc::PTR, &pointer);
	rewind(stream);
	if (!in || !in->open(name, spec, config))
		return false;
	if (spec.tile_width > 0) /* tiles are written as they come */
		return true;
	row.resize(spec.scanline_bytes(true));
	return in->read_scanline(
	    spec.y + spec.height - 1, 0, TypeDesc::UNKNOWN, row.data());
}

enum bake_status
write_stream(const struct picture &pic, const struct bake_write_params *params,
    FILE *stream, const char *name, size_t *nclipped, struct bake_err *err)
{
	StreamProxy proxy(stream);
	IOProxy *pointer = &proxy;
	std::unique_ptr<ImageOutput> out =
	    ImageOutput::create(plugin_of(params->type));
	ImageSpec spec = make_spec(pic, params);
	enum bake_status rc = BAKE_EIO;
	bool done;

	if (!out)
		return bake_fail(err, BAKE_EIO,
		    "%s: this OpenImageIO was built without %s", name,
		    plugin_of(params->type));
	spec.attribute("oiio:ioproxy", TypeDesc::PTR, &pointer);
	bake_io_set_exr_threads(spec.image_bytes(true));
	if (out->open(name, spec))
		rc = write_all(out.get(), pic, params, nclipped, err);
	if (rc != BAKE_OK && rc != BAKE_EIO)
		return rc; /* the rows could not be made */
	done = out->close() && rc == BAKE_OK;
	errno = 0;
	if ((fflush(stream) != 0 || ferror(stream)) && proxy.failure == 0)
		proxy.failure = errno != 0 ? errno : EIO;
	if (proxy.failure != 0)
		return bake_fail(
		    err, BAKE_EIO, "%s: %s", name, strerror(proxy.failure));
	if (!done)
		return bake_fail(err, BAKE_EIO, "%s: %s", name,
		    bake_io_one_line(out->geterror()).c_str());
	if ((params->type == BAKE_FILE_TIFF && !tiff_is_whole(stream, name)) ||
	    (params->type == BAKE_FILE_EXR && !bake_exr_is_whole(stream, name)))
		return bake_fail(
		    err, BAKE_ENOMEM, "%s: no memory to write it", name);
	return BAKE_OK;
}

/* What the type cannot hold, said before the image library says it in its own
 * way, or writes what nobody can read. */
enum bake_status
check_picture(const struct picture &pic, const struct bake_write_params *params,
    const char *name, struct bake_err *err)
{
	/* of 16 bits in TGA; libpng's own limit, readers' too; what OpenImageIO
	 * takes of the others */
	static const int sides[] = { 1000000, 65535, 1 << 20, 1 << 20 };
	const char *type = bake_file_type_name(params->type);
	const int side = sides[params->type];
	const bool tiles =
	    params->type == BAKE_FILE_TIFF || params->type == BAKE_FILE_EXR;

	if (!bake_file_type_holds(params->type, params->data_format))
		return bake_fail(err, BAKE_EINVAL, "%s: %s holds no %s values",
		    name, type, bake_data_format_name(params->data_format));
	if (pic.nchans > 4 && !tiles)
		return bake_fail(err, BAKE_EINVAL,
		    "%s: %s holds 4 channels, not %d", name, type, pic.nchans);
	if (pic.width > side || pic.height > side)
		return bake_fail(err, BAKE_EINVAL,
		    "%s: %s holds at most %d texels a side, not %dx%d%s", name,
		    type, side, pic.width, pic.height,
		    tiles ? "" : "; tiff and exr hold more");
	if (params->tile != 0 && !tiles)
		return bake_fail(err, BAKE_EINVAL,
		    "%s: %s has no tiles; tiff and exr have", name, type);
	if (params->tile < 0 || params->tile % 16 != 0)
		return bake_fail(err, BAKE_EINVAL,
		    "%s: tiles of %d texels a side, expected a multiple of 16",
		    name, params->tile);
	return BAKE_OK;
}

enum bake_status
write_picture(const struct picture &pic, const struct bake_write_params *params,
    FILE *stream, const char *name, size_t *nclipped, struct bake_err *err)
{
	size_t clipped = 0;
	enum bake_status rc;

	if ((rc = check_picture(pic, params, name, err)) != BAKE_OK)
		return rc;
	try {
		const BakeMemoryWatch memory;

		rc = write_stream(pic, params, stream, name, &clipped, err);
		if (memory.failed())
			rc = bake_io_no_memory(err, name);
	} catch (...) {
		rc = bake_io_fail_exception(err, name);
	}
	if (nclipped != NULL)
		*nclipped = clipped;
	return rc;
}

} // namespace

enum bake_status
bake_image_write(const struct bake_image *img,
    const struct bake_write_params *params, FILE *stream, const char *name,
    size_t *nclipped, struct bake_err *err)
{
	const struct picture pic = { img->width, img->height, img->nchans, img,
		NULL, NULL };

	return write_picture(pic, params, stream, name, nclipped, err);
}

enum bake_status
bake_pixels_write(const struct bake_pixels *px,
    const struct bake_write_params *params, FILE *stream, const char *name,
    size_t *nclipped, struct bake_err *err)
{
	const struct picture pic = { px->width, px->height, px->nchans, NULL,
		px, NULL };

	return write_picture(pic, params, stream, name, nclipped, err);
}

enum bake_status
bake_rows_write(const struct bake_row_source *rows,
    const struct bake_write_params *params, FILE *stream, const char *name,
    size_t *nclipped, struct bake_err *err)
{
	const struct picture pic = { rows->width, rows->height, rows->nchans,
		NULL, NULL, rows };

	return write_picture(pic, params, stream, name, nclipped, err);
}
