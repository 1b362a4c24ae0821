/* Reading image files: the shim over OpenImageIO; no exception leaves it. */
/* SPDX-License-Identifier: MIT */
#include "io_image_priv.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "image_kind.h"

using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::ParamValue;
using OIIO::TypeDesc;
using OIIO::Filesystem::IOProxy;

std::string
bake_io_one_line(std::string text)
{
	for (char &c : text)
		if ((unsigned char)c < ' ')
			c = ' ';
	while (!text.empty() && (text.back() == ' ' || text.back() == '.'))
		text.pop_back();
	return text.empty() ? "the file is corrupt or not supported" : text;
}

enum bake_status
bake_io_fail_exception(struct bake_err *err, const std::string &name)
{
	try {
		throw;
	} catch (const std::bad_alloc &) {
		return bake_fail(err, BAKE_ENOMEM, "%s: no memory to decode it",
		    name.c_str());
	} catch (const std::exception &e) {
		return bake_fail(err, BAKE_EDATA, "%s: %s", name.c_str(),
		    bake_io_one_line(e.what()).c_str());
	} catch (...) {
		return bake_fail(err, BAKE_EDATA,
		    "%s: the image library failed", name.c_str());
	}
}

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
count_subimages(
    const ImageSpec &spec, enum bake_image_kind kind, ImageInput *in)
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
		    bake_io_one_line(r->in->geterror()).c_str());
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
		return bake_io_fail_exception(err, name);
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
		return bake_io_fail_exception(err, name);
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
	int rows = spec.tile_height > 0 ? spec.tile_height : BAKE_IO_BAND_ROWS;
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
			    bake_io_one_line(r->in->geterror()).c_str());
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
		rc = bake_io_fail_exception(err, r->name);
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
