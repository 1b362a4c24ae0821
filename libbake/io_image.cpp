/* Image files: the shim over OpenImageIO; no exception leaves it. */
/* SPDX-License-Identifier: MIT */
#include "io_image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "image_kind.h"
#include "mem.h"

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::ParamValue;
using OIIO::TypeDesc;
using OIIO::Filesystem::IOProxy;

namespace
{

/* Rows that are converted at a time: small enough to stay in cache. */
const int band_rows = 64;

/* A stream to write to. It remembers the first failure: some of the format
 * writers pass over one. */
class StreamProxy : public OIIO::Filesystem::IOFile {
public:
	StreamProxy(FILE *stream) : IOFile(stream, Write) {}
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

/* OpenImageIO's message on one line, without the path that we put first. */
std::string
one_line(std::string text)
{
	for (char &c : text)
		if ((unsigned char)c < ' ')
			c = ' ';
	while (!text.empty() && (text.back() == ' ' || text.back() == '.'))
		text.pop_back();
	return text.empty() ? "the file is corrupt or not supported" : text;
}

enum bake_status
fail_exception(struct bake_err *err, const std::string &name)
{
	try {
		throw;
	} catch (const std::bad_alloc &) {
		return bake_fail(err, BAKE_ENOMEM, "%s: no memory to decode it",
		    name.c_str());
	} catch (const std::exception &e) {
		return bake_fail(err, BAKE_EDATA, "%s: %s", name.c_str(),
		    one_line(e.what()).c_str());
	} catch (...) {
		return bake_fail(err, BAKE_EDATA,
		    "%s: the image library failed", name.c_str());
	}
}

} // namespace

struct bake_reader {
	std::string name;
	std::vector<unsigned char> slurped; /* standard input's bytes */
	FILE *fp = nullptr;
	std::unique_ptr<IOProxy> proxy;
	std::unique_ptr<ImageInput> in;

	~bake_reader()
	{
		in.reset();
		if (fp != nullptr)
			fclose(fp);
	}
};

namespace
{

enum bake_data_format
data_format_of(TypeDesc type)
{
	switch (type.basetype) {
	case TypeDesc::UINT8:
		return BAKE_DATA_UINT8;
	case TypeDesc::UINT16:
		return BAKE_DATA_UINT16;
	case TypeDesc::HALF:
		return BAKE_DATA_HALF;
	default:
		return BAKE_DATA_FLOAT;
	}
}

/* The deepest of the channels' formats, which may differ in EXR. */
TypeDesc
deepest_type(const ImageSpec &spec)
{
	TypeDesc deepest = spec.format;

	for (TypeDesc t : spec.channelformats)
		if (data_format_of(t) > data_format_of(deepest))
			deepest = t;
	return deepest;
}

void
read_attrs(const ImageSpec &spec, struct bake_attrs *attrs)
{
	bake_attrs_clear(attrs);
	bake_attrs_parse(
	    attrs, spec.get_string_attribute("ImageDescription").c_str());
	for (const ParamValue &p : spec.extra_attribs) {
		const char *name = p.name().c_str();

		if (strncmp(name, "relief:", 7) != 0)
			continue;
		if (p.type() == OIIO::TypeString)
			bake_attrs_set(attrs, name + 7, p.get_string().c_str());
		else
			bake_attrs_set_number(attrs, name + 7, p.get_float());
	}
}

void
fill_info(struct bake_image_info *info, const ImageSpec &spec, ImageInput *in)
{
	TypeDesc type = deepest_type(spec);

	memset(info, 0, sizeof *info);
	info->width = spec.width;
	info->height = spec.height;
	info->nchans = spec.nchannels;
	info->data_format = data_format_of(type);
	info->bits = spec.get_int_attribute(
	    "oiio:BitsPerSample", 8 * (int)type.basesize());
	info->is_signed = type.is_signed() && !type.is_floating_point();
	snprintf(
	    info->container, sizeof info->container, "%s", in->format_name());
	for (int c = 0; c < spec.nchannels && c < BAKE_INFO_NAMES; c++)
		snprintf(info->names[c], BAKE_INFO_NAME, "%s",
		    spec.channelnames[(size_t)c].c_str());
	info->orientation = spec.get_int_attribute("Orientation", 1);
	info->windowed = spec.x != spec.full_x || spec.y != spec.full_y ||
			 spec.width != spec.full_width ||
			 spec.height != spec.full_height;
	info->nsubimages = 1;
	read_attrs(spec, &info->attrs);
}

/* Number of pages or parts; 2 stands for 'more than one' where a TIFF does not
 * say. Only there is it safe to look: some readers lose their place. */
int
count_subimages(const ImageSpec &spec, enum bake_image_kind kind,
    ImageInput *in)
{
	int n = spec.get_int_attribute("oiio:subimages", 0);

	if (n > 0 || kind != BAKE_KIND_TIFF)
		return n > 0 ? n : 1;
	n = in->seek_subimage(1, 0) ? 2 : 1;
	in->seek_subimage(0, 0);
	in->geterror(); /* that there is no second one is no error */
	return n;
}

enum bake_status
check_size(const struct bake_reader *r, const ImageSpec &spec,
    enum bake_image_kind kind, size_t file_size,
    const struct bake_read_limits *limits, struct bake_err *err)
{
	struct bake_image_claim claim;

	claim.width = spec.width;
	claim.height = spec.height;
	claim.nchans = spec.nchannels;
	claim.file_size = file_size;
	if (spec.depth > 1)
		return bake_fail(err, BAKE_EDATA,
		    "%s: a volume of %d slices, not an image", r->name.c_str(),
		    spec.depth);
	if (spec.deep)
		return bake_fail(err, BAKE_EDATA,
		    "%s: a deep image, expected one value per texel and "
		    "channel; flatten it first",
		    r->name.c_str());
	return bake_image_claim_check(
	    &claim, kind, limits, r->name.c_str(), err);
}

/* Open with the plugin for the content's kind. Some plugins trust sizes in
 * their open(): only what they report is checked here, before pixels. */
enum bake_status
open_proxy(struct bake_reader *r, const unsigned char *head, size_t nhead,
    const struct bake_read_limits *limits, struct bake_image_info *info,
    struct bake_err *err)
{
	ImageSpec config, spec;
	enum bake_image_kind kind;
	const char *plugin;
	IOProxy *proxy = r->proxy.get();
	enum bake_status rc;

	if (r->proxy->size() == 0)
		return bake_fail(
		    err, BAKE_EDATA, "%s: the file is empty", r->name.c_str());
	kind = bake_image_kind_of(head, nhead, r->name.c_str());
	plugin = bake_image_kind_plugin(kind);
	if (plugin == NULL)
		return bake_fail(err, BAKE_EDATA,
		    "%s: not an image of a known kind", r->name.c_str());
	OIIO::geterror();
	r->in = ImageInput::create(std::string(plugin), false);
	if (!r->in)
		return bake_fail(err, BAKE_EDATA,
		    "%s: this OpenImageIO was built without %s",
		    r->name.c_str(), plugin);
	config.attribute("oiio:UnassociatedAlpha", 1);
	config.attribute("oiio:ioproxy", TypeDesc::PTR, &proxy);
	if (!r->in->open(r->name, spec, config))
		return bake_fail(err, BAKE_EDATA, "%s: %s", r->name.c_str(),
		    one_line(r->in->geterror()).c_str());
	rc = check_size(r, spec, kind, r->proxy->size(), limits, err);
	if (rc != BAKE_OK)
		return rc;
	fill_info(info, spec, r->in.get());
	info->nsubimages = count_subimages(spec, kind, r->in.get());
	return BAKE_OK;
}

enum bake_status
slurp_stdin(struct bake_reader *r, struct bake_err *err)
{
	unsigned char buf[65536];
	size_t n;

	while ((n = fread(buf, 1, sizeof buf, stdin)) > 0)
		r->slurped.insert(r->slurped.end(), buf, buf + n);
	if (ferror(stdin))
		return bake_fail(
		    err, BAKE_EIO, "standard input: %s", strerror(errno));
	r->proxy.reset(new OIIO::Filesystem::IOMemReader(
	    r->slurped.data(), r->slurped.size()));
	return BAKE_OK;
}

enum bake_status
open_file(struct bake_reader *r, struct bake_err *err)
{
	if (r->name == "-") {
		r->name = "standard input";
		return slurp_stdin(r, err);
	}
	r->fp = fopen(r->name.c_str(), "rbe");
	if (r->fp == nullptr)
		return bake_fail(
		    err, BAKE_EIO, "%s: %s", r->name.c_str(), strerror(errno));
	r->proxy.reset(new OIIO::Filesystem::IOFile(r->fp, IOProxy::Read));
	return BAKE_OK;
}

} // namespace

enum bake_status
bake_reader_open(struct bake_reader **reader, const char *path,
    const struct bake_read_limits *limits, struct bake_image_info *info,
    struct bake_err *err)
{
	std::string name;

	*reader = NULL;
	try {
		std::unique_ptr<bake_reader> r(new bake_reader);
		unsigned char head[BAKE_IMAGE_KIND_BYTES];
		size_t nhead;
		enum bake_status rc;

		r->name = name = path;
		if ((rc = open_file(r.get(), err)) != BAKE_OK)
			return rc;
		errno = 0;
		nhead = r->proxy->read(head, sizeof head);
		if (errno != 0 && nhead == 0)
			return bake_fail(
			    err, BAKE_EIO, "%s: %s", path, strerror(errno));
		r->proxy->seek(0);
		rc = open_proxy(r.get(), head, nhead, limits, info, err);
		if (rc == BAKE_OK)
			*reader = r.release();
		return rc;
	} catch (...) {
		return fail_exception(err, name);
	}
}

enum bake_status
bake_reader_open_memory(struct bake_reader **reader, const void *bytes,
    size_t size, const char *name, const struct bake_read_limits *limits,
    struct bake_image_info *info, struct bake_err *err)
{
	*reader = NULL;
	try {
		std::unique_ptr<bake_reader> r(new bake_reader);
		enum bake_status rc;

		r->name = name;
		/* the reader never writes: the proxy's type is just loose */
		r->proxy.reset(new OIIO::Filesystem::IOMemReader(
		    const_cast<void *>(bytes), size));
		rc = open_proxy(r.get(), (const unsigned char *)bytes, size,
		    limits, info, err);
		if (rc == BAKE_OK)
			*reader = r.release();
		return rc;
	} catch (...) {
		return fail_exception(err, name);
	}
}

namespace
{

/* Rows y0 .. y1 of channels c0 .. c1 in `type`, into buf. Tiled files are read
 * by whole rows of tiles. */
bool
read_rows(ImageInput *in, const ImageSpec &spec, int y0, int y1, int c0, int c1,
    TypeDesc type, void *buf)
{
	if (spec.tile_width > 0)
		return in->read_tiles(0, 0, spec.x, spec.x + spec.width,
		    spec.y + y0, spec.y + y1, spec.z, spec.z + 1, c0, c1, type,
		    buf);
	return in->read_scanlines(
	    0, 0, spec.y + y0, spec.y + y1, spec.z, c0, c1, type, buf);
}

/* A band as read to floats; type is what read_rows was asked for. */
void
band_to_float(
    float *out, const std::vector<unsigned char> &band, TypeDesc type, size_t n)
{
	if (type == TypeDesc::UINT8)
		bake_codes_from_u8(out, band.data(), n);
	else
		bake_codes_from_u16(out, (const uint16_t *)band.data(), n);
}

enum bake_status
read_all(struct bake_reader *r, int first, int nchans, struct bake_image *img,
    struct bake_err *err)
{
	const ImageSpec spec = r->in->spec();
	bool codes =
	    spec.channelformats.empty() &&
	    (spec.format == TypeDesc::UINT8 || spec.format == TypeDesc::UINT16);
	TypeDesc type = codes ? spec.format : TypeDesc(TypeDesc::FLOAT);
	int rows = spec.tile_height > 0 ? spec.tile_height : band_rows;
	size_t row = (size_t)spec.width * (size_t)nchans;
	std::vector<unsigned char> band;

	if (codes)
		band.resize(
		    row * (size_t)std::min(rows, spec.height) * type.size());
	for (int y = 0; y < spec.height; y += rows) {
		int end = std::min(y + rows, spec.height);
		float *out = bake_image_row(img, y);

		if (!read_rows(r->in.get(), spec, y, end, first, first + nchans,
			type, codes ? (void *)band.data() : (void *)out) ||
		    r->in->has_error())
			return bake_fail(err, BAKE_EDATA, "%s: %s",
			    r->name.c_str(),
			    one_line(r->in->geterror()).c_str());
		if (codes)
			band_to_float(out, band, type, row * (size_t)(end - y));
	}
	return BAKE_OK;
}

} // namespace

enum bake_status
bake_reader_read(struct bake_reader *r, int first, int nchans,
    struct bake_image *img, struct bake_err *err)
{
	struct bake_image read = BAKE_IMAGE_INIT;
	enum bake_status rc;

	try {
		const ImageSpec &spec = r->in->spec();

		if (first < 0 || nchans < 1 || nchans > spec.nchannels - first)
			return bake_fail(err, BAKE_EINVAL,
			    "%s: %d channels from %d on were asked for, it has "
			    "%d",
			    r->name.c_str(), nchans, first, spec.nchannels);
		rc = bake_image_alloc(
		    &read, spec.width, spec.height, nchans, err);
		if (rc == BAKE_OK)
			rc = read_all(r, first, nchans, &read, err);
	} catch (...) {
		rc = fail_exception(err, r->name);
	}
	if (rc == BAKE_OK)
		bake_image_swap(img, &read);
	bake_image_free(&read);
	return rc;
}

void
bake_reader_close(struct bake_reader *reader)
{
	try {
		delete reader;
	} catch (...) {
		/* nothing is left to report to */
	}
}

namespace
{

const char *
plugin_of(enum bake_file_type type)
{
	static const char *const names[] = {"png", "targa", "tiff", "openexr"};

	return names[type];
}

TypeDesc
type_of(enum bake_data_format format)
{
	static const TypeDesc::BASETYPE types[] = {
	    TypeDesc::UINT8, TypeDesc::UINT16, TypeDesc::HALF, TypeDesc::FLOAT};

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
		std::string one =
		    std::string("relief:") + a->name + "=" + a->value + ";";
		size_t used = text.size() % line;
		size_t gap = used == 0			     ? 0
			     : used + 1 + one.size() >= line ? line - used
							     : 1;

		if (one.size() < line &&
		    text.size() + gap + one.size() < nlines * line)
			text += std::string(gap, ' ') + one;
	}
	return text;
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
	bake_attrs_format(&params->attrs, line, sizeof line);
	spec.attribute("ImageDescription",
	    params->type == BAKE_FILE_TGA ? tga_comment(&params->attrs)
					  : std::string(line));
}

/* libpng's PNG_FILTER_PAETH */
const int png_filter_paeth = 0x80;

ImageSpec
make_spec(const struct bake_image *img, const struct bake_write_params *params)
{
	static const char *const usual[4][4] = {
	    {"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
	ImageSpec spec(
	    img->width, img->height, img->nchans, type_of(params->data_format));

	for (int c = 0; c < img->nchans; c++) {
		if (params->names != NULL)
			spec.channelnames[(size_t)c] = params->names[c];
		else if (img->nchans <= 4)
			spec.channelnames[(size_t)c] =
			    usual[img->nchans - 1][c];
		else /* numbered so that they sort in order */
			spec.channelnames[(size_t)c] =
			    OIIO::Strutil::fmt::format("c{:06d}", c);
	}
	spec.alpha_channel = img->nchans == 4 ? 3 : img->nchans == 2 ? 1 : -1;
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

bool
write_all(ImageOutput *out, const struct bake_image *img,
    enum bake_data_format format, size_t *nclipped)
{
	size_t row = (size_t)img->width * (size_t)img->nchans;
	bool codes = bake_data_format_max(format) != 0;
	std::vector<unsigned char> band;
	std::vector<float> rows;

	if (codes)
		band.resize(row * (size_t)band_rows * type_of(format).size());
	for (int y = 0; y < img->height; y += band_rows) {
		int end = std::min(y + band_rows, img->height);
		const void *data;
		TypeDesc type = TypeDesc(TypeDesc::FLOAT);

		rows.resize(row * (size_t)(end - y));
		for (int i = y; i < end; i++)
			memcpy(&rows[row * (size_t)(i - y)],
			    bake_image_row(img, i), row * sizeof(float));
		data = rows.data();
		if (codes) {
			*nclipped += band_to_codes(
			    band, rows.data(), rows.size(), format);
			data = band.data();
			type = type_of(format);
		}
		if (!out->write_scanlines(y, end, 0, type, data))
			return false;
	}
	return true;
}

enum bake_status
write_stream(const struct bake_image *img,
    const struct bake_write_params *params, FILE *stream, const char *name,
    size_t *nclipped, struct bake_err *err)
{
	StreamProxy proxy(stream);
	IOProxy *pointer = &proxy;
	std::unique_ptr<ImageOutput> out =
	    ImageOutput::create(plugin_of(params->type));
	ImageSpec spec = make_spec(img, params);
	bool done;

	if (!out)
		return bake_fail(err, BAKE_EIO,
		    "%s: this OpenImageIO was built without %s", name,
		    plugin_of(params->type));
	spec.attribute("oiio:ioproxy", TypeDesc::PTR, &pointer);
	done = out->open(name, spec) &&
	       write_all(out.get(), img, params->data_format, nclipped);
	done = out->close() && done;
	errno = 0;
	if ((fflush(stream) != 0 || ferror(stream)) && proxy.failure == 0)
		proxy.failure = errno != 0 ? errno : EIO;
	if (proxy.failure != 0)
		return bake_fail(
		    err, BAKE_EIO, "%s: %s", name, strerror(proxy.failure));
	if (!done)
		return bake_fail(err, BAKE_EIO, "%s: %s", name,
		    one_line(out->geterror()).c_str());
	return BAKE_OK;
}

} // namespace

enum bake_status
bake_image_write(const struct bake_image *img,
    const struct bake_write_params *params, FILE *stream, const char *name,
    size_t *nclipped, struct bake_err *err)
{
	size_t clipped = 0;
	enum bake_status rc;

	if (!bake_file_type_holds(params->type, params->data_format))
		return bake_fail(err, BAKE_EINVAL, "%s: %s holds no %s values",
		    name, bake_file_type_name(params->type),
		    bake_data_format_name(params->data_format));
	if (img->nchans > 4 && params->type != BAKE_FILE_EXR &&
	    params->type != BAKE_FILE_TIFF)
		return bake_fail(err, BAKE_EINVAL,
		    "%s: %s holds 4 channels, not %d", name,
		    bake_file_type_name(params->type), img->nchans);
	try {
		rc = write_stream(img, params, stream, name, &clipped, err);
	} catch (...) {
		rc = fail_exception(err, name);
	}
	if (nclipped != NULL)
		*nclipped = clipped;
	return rc;
}
