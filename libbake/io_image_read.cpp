/* Reading image files: the shim over OpenImageIO; no exception leaves it. */
/* SPDX-License-Identifier: MIT */
#include "io_image_priv.hpp"

#include <execinfo.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "image_kind.h"
#include "image_scan_priv.h"

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

void
bake_io_set_exr_threads(size_t nbytes)
{
	const size_t many = (size_t)1 << 22;

	OIIO::attribute("exr_threads", nbytes < many ? -1 : 0);
}

enum bake_status
bake_io_no_memory(struct bake_err *err, const char *name)
{
	/* whatever was said before, this is why */
	*err = (struct bake_err)BAKE_ERR_INIT;
	return bake_fail(err, BAKE_ENOMEM, "%s: no memory for it", name);
}

enum bake_status
bake_io_fail_exception(struct bake_err *err, const char *name)
{
	try {
		throw;
	} catch (const std::bad_alloc &) {
		return bake_fail(
		    err, BAKE_ENOMEM, "%s: no memory for it", name);
	} catch (const std::exception &e) {
		return bake_fail(err, BAKE_EDATA, "%s: %s", name, e.what());
	} catch (...) {
		return bake_fail(
		    err, BAKE_EDATA, "%s: the image library failed", name);
	}
}

/*
 * What the C library and OpenImageIO get on first use and end the process
 * where they cannot: the unwinder for frames of C, the thread's list of
 * destructors. Had here, before there is anything to lose.
 */
static const struct prepared {
	prepared()
	{
		void *frame;

		backtrace(&frame, 1);
		OIIO::geterror();
	}
} prepared;

namespace
{

/* A stream to read from. It remembers the first failure, which decoders take
 * for the end of the file. */
class ReadProxy : public OIIO::Filesystem::IOFile
{
      public:
	ReadProxy(FILE *stream) : IOFile(stream, Read)
	{
	}
	size_t
	read(void *buf, size_t size) override
	{
		errno = 0;
		return note(IOFile::read(buf, size), size);
	}
	size_t
	pread(void *buf, size_t size, int64_t offset) override
	{
		errno = 0;
		return note(IOFile::pread(buf, size, offset), size);
	}
	int failure = 0;

      private:
	size_t
	note(size_t n, size_t size)
	{
		if (n < size && failure == 0)
			failure = errno;
		return n;
	}
};

} // namespace

struct bake_reader {
	std::string name;
	std::vector<unsigned char> slurped; /* standard input's bytes */
	FILE *fp = nullptr;
	ReadProxy *file = nullptr; /* proxy, where it is one */
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
	const std::string job = spec.get_string_attribute("DocumentName");
	const std::string made = spec.get_string_attribute("Software");

	bake_attrs_clear(attrs);
	bake_attrs_parse(
	    attrs, spec.get_string_attribute("ImageDescription").c_str());
	/* where TGA has room for it (io_image_write.cpp) */
	if (job.compare(0, 4, "rm1:") == 0)
		bake_attrs_set(attrs, "Recipe", job.c_str());
	if (made.compare(0, 7, "files:|") == 0)
		bake_attrs_set(attrs, "RecipeFiles", made.c_str());
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

/* What the decoder says, or why it could not read on. */
enum bake_status
fail_decoding(struct bake_reader *r, struct bake_err *err)
{
	if (r->file != nullptr && r->file->failure != 0)
		return bake_fail(err, BAKE_EIO, "%s: %s", r->name.c_str(),
		    strerror(r->file->failure));
	return bake_fail(err, BAKE_EDATA, "%s: %s", r->name.c_str(),
	    bake_io_one_line(r->in->geterror()).c_str());
}

/* Some of the file's bytes: scans want a few at a time. */
struct Window {
	IOProxy *proxy;
	size_t from, n;
	char bytes[4096];
};

bool
read_window(void *context, size_t at, void *bytes, size_t n)
{
	Window *w = (Window *)context;

	if (n > sizeof w->bytes)
		return false;
	if (at < w->from || at - w->from > w->n || n > w->n - (at - w->from)) {
		w->from = at;
		w->n = w->proxy->pread(w->bytes, sizeof w->bytes, (int64_t)at);
		if (n > w->n)
			return false;
	}
	memcpy(bytes, w->bytes + (at - w->from), n);
	return true;
}

enum bake_status
scan(struct bake_reader *r, enum bake_image_kind kind,
    const struct bake_read_limits *limits, struct bake_err *err)
{
	Window window = { r->proxy.get(), 0, 0, {} };
	struct bake_exr_source source = { &window, r->proxy->size(),
		read_window };
	struct bake_err found = BAKE_ERR_INIT;
	enum bake_status rc =
	    bake_image_scan(kind, &source, limits, r->name.c_str(), &found);

	if (rc == BAKE_OK)
		return rc;
	if (r->file != nullptr && r->file->failure != 0)
		return bake_fail(err, BAKE_EIO, "%s: %s", r->name.c_str(),
		    strerror(r->file->failure));
	return bake_fail(err, rc, "%s", found.msg);
}

/* Open with the plugin for the content's kind. Some plugins trust sizes in
 * their open(): those that give way to it are looked through before, of the
 * others what they report is checked, before pixels. */
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
	if ((rc = scan(r, kind, limits, err)) != BAKE_OK)
		return rc;
	OIIO::geterror();
	r->in = ImageInput::create(std::string(plugin), false);
	if (!r->in)
		return bake_fail(err, BAKE_EDATA,
		    "%s: this OpenImageIO was built without %s",
		    r->name.c_str(), plugin);
	config.attribute("oiio:UnassociatedAlpha", 1);
	config.attribute("oiio:ioproxy", TypeDesc::PTR, &proxy);
	bake_io_set_exr_threads(r->proxy->size());
	if (!r->in->open(r->name, spec, config))
		return fail_decoding(r, err);
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
	r->file = new ReadProxy(r->fp);
	r->proxy.reset(r->file);
	return BAKE_OK;
}

} // namespace

enum bake_status
bake_reader_open(struct bake_reader **reader, const char *path,
    const struct bake_read_limits *limits, struct bake_image_info *info,
    struct bake_err *err)
{
	*reader = NULL;
	try {
		const BakeMemoryWatch memory;
		std::unique_ptr<bake_reader> r(new bake_reader);
		unsigned char head[BAKE_IMAGE_KIND_BYTES];
		size_t nhead;
		enum bake_status rc;

		r->name = path;
		if ((rc = open_file(r.get(), err)) != BAKE_OK)
			return rc;
		errno = 0;
		nhead = r->proxy->read(head, sizeof head);
		if (errno != 0 && nhead == 0)
			return bake_fail(
			    err, BAKE_EIO, "%s: %s", path, strerror(errno));
		r->proxy->seek(0);
		rc = open_proxy(r.get(), head, nhead, limits, info, err);
		if (memory.failed())
			rc = bake_io_no_memory(err, path);
		if (rc == BAKE_OK)
			info->stdin_digest = bake_digest_of(
			    r->slurped.data(), r->slurped.size());
		if (rc == BAKE_OK)
			*reader = r.release();
		return rc;
	} catch (...) {
		return bake_io_fail_exception(err, path);
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

/* Which of a file's channels are wanted, and how. */
struct wanted {
	const int *channel;
	int n;
	int first, count; /* the file's channels that hold all of them */
	bool straight;    /* these are they, in order */
};

struct wanted
find_wanted(const int *channel, int n)
{
	struct wanted w = { channel, n, channel[0], 0, true };
	int last = channel[0];

	for (int c = 0; c < n; c++) {
		w.first = std::min(w.first, channel[c]);
		last = std::max(last, channel[c]);
		w.straight = w.straight && channel[c] == channel[0] + c;
	}
	w.count = last - w.first + 1;
	return w;
}

/* n values as read to floats; type is what read_rows was asked for. */
void
to_float(float *out, const unsigned char *in, TypeDesc type, size_t n)
{
	if (type == TypeDesc::UINT8)
		bake_codes_from_u8(out, in, n);
	else if (type == TypeDesc::UINT16)
		bake_codes_from_u16(out, (const uint16_t *)in, n);
	else
		memcpy(out, in, n * sizeof *out);
}

/* Rows y .. end - 1 of the image from a band of all channels between. */
void
take_band(struct bake_image *img, int y, int end, const struct wanted &w,
    const std::vector<unsigned char> &band, TypeDesc type,
    std::vector<float> &all)
{
	const size_t width = (size_t)img->width, n = (size_t)w.n;
	const size_t values = width * (size_t)w.count;

	for (int i = y; i < end; i++) {
		const unsigned char *in =
		    &band[(size_t)(i - y) * values * type.size()];
		float *out = bake_image_row(img, i);

		if (w.straight) {
			to_float(out, in, type, values);
			continue;
		}
		to_float(all.data(), in, type, values);
		for (size_t c = 0; c < n; c++) {
			const float *from =
			    &all[(size_t)(w.channel[c] - w.first)];

			for (size_t x = 0; x < width; x++)
				out[x * n + c] = from[x * (size_t)w.count];
		}
	}
}

enum bake_status
read_all(struct bake_reader *r, const struct wanted &w, struct bake_image *img,
    struct bake_err *err)
{
	const ImageSpec spec = r->in->spec();
	bool codes =
	    spec.channelformats.empty() &&
	    (spec.format == TypeDesc::UINT8 || spec.format == TypeDesc::UINT16);
	const bool direct = w.straight && !codes;
	TypeDesc type = codes ? spec.format : TypeDesc(TypeDesc::FLOAT);
	int rows =
	    spec.tile_height > 0 ? spec.tile_height : bake_io_band_rows();
	const size_t row = (size_t)spec.width * (size_t)w.count;
	std::vector<unsigned char> band;
	std::vector<float> all;

	if (!direct)
		band.resize(
		    row * (size_t)std::min(rows, spec.height) * type.size());
	if (!w.straight)
		all.resize(row);
	for (int y = 0; y < spec.height; y += rows) {
		int end = std::min(y + rows, spec.height);
		void *to = direct ? (void *)bake_image_row(img, y)
				  : (void *)band.data();

		if (!read_rows(r->in.get(), spec, y, end, w.first,
			w.first + w.count, type, to) ||
		    r->in->has_error())
			return fail_decoding(r, err);
		if (!direct)
			take_band(img, y, end, w, band, type, all);
	}
	return BAKE_OK;
}

} // namespace

int
bake_io_band_rows(void)
{
	const char *wish = getenv("BAKE_BAND_ROWS");
	const int rows = wish != NULL ? (int)strtol(wish, NULL, 10) : 0;

	return rows > 0 && rows <= 1 << 16 ? rows : 64;
}

enum bake_status
bake_reader_read_channels(struct bake_reader *r, const int *channel, int n,
    struct bake_image *img, struct bake_err *err)
{
	struct bake_image read = BAKE_IMAGE_INIT;
	enum bake_status rc;

	try {
		const ImageSpec &spec = r->in->spec();

		for (int c = 0; c < n; c++)
			if (channel[c] < 0 || channel[c] >= spec.nchannels)
				return bake_fail(err, BAKE_EINVAL,
				    "%s: channel %d was asked for, it has %d",
				    r->name.c_str(), channel[c],
				    spec.nchannels);
		rc = bake_image_alloc(&read, spec.width, spec.height, n, err);
		if (rc == BAKE_OK)
			rc = read_all(r, find_wanted(channel, n), &read, err);
	} catch (...) {
		rc = bake_io_fail_exception(err, r->name.c_str());
	}
	if (rc == BAKE_OK)
		bake_image_swap(img, &read);
	bake_image_free(&read);
	return rc;
}

enum bake_status
bake_reader_read(struct bake_reader *r, int first, int nchans,
    struct bake_image *img, struct bake_err *err)
{
	try {
		const int all = r->in->spec().nchannels;
		std::vector<int> channel;

		if (first < 0 || nchans < 1 || nchans > all - first)
			return bake_fail(err, BAKE_EINVAL,
			    "%s: %d channels from %d on were asked for, it has "
			    "%d",
			    r->name.c_str(), nchans, first, all);
		for (int c = 0; c < nchans; c++)
			channel.push_back(first + c);
		return bake_reader_read_channels(
		    r, channel.data(), nchans, img, err);
	} catch (...) {
		return bake_io_fail_exception(err, r->name.c_str());
	}
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
