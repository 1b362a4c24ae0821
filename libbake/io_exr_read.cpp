/* Reading EXR of any sort, part by part: the shim over OpenEXR. */
/* SPDX-License-Identifier: MIT */
#include "io_exr_priv.hpp"

#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>

#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "exr_scan_priv.h"
#include "image_kind.h"
#include "mem.h"

namespace
{

/* A file's bytes, in memory or not. */
class Source : public Imf::IStream
{
      public:
	Source(const char *name) : IStream(name)
	{
	}
	~Source() override
	{
		if (fp != nullptr && !lent)
			fclose(fp);
	}
	/* false, errno set, where it cannot be opened */
	bool
	open(const char *path)
	{
		off_t end;

		fp = fopen(path, "rbe");
		if (fp == nullptr || fseeko(fp, 0, SEEK_END) != 0 ||
		    (end = ftello(fp)) < 0)
			return false;
		size = (size_t)end;
		return true;
	}
	/* a stream that stays the caller's */
	bool
	lend(FILE *stream)
	{
		off_t end =
		    fseeko(stream, 0, SEEK_END) == 0 ? ftello(stream) : -1;

		if (end < 0)
			return false;
		fp = stream;
		lent = true;
		size = (size_t)end;
		return true;
	}
	void
	set(const void *b, size_t n)
	{
		bytes = (const char *)b;
		size = n;
	}
	bool
	get(size_t from, void *to, size_t n)
	{
		if (from > size || n > size - from)
			return false;
		if (fp == nullptr) {
			memcpy(to, bytes + from, n);
			return true;
		}
		errno = 0;
		if (fseeko(fp, (off_t)from, SEEK_SET) == 0 &&
		    fread(to, 1, n, fp) == n)
			return true;
		failure = errno;
		return false;
	}
	bool
	read(char to[], int n) override
	{
		if (n < 0 || !get(at, to, (size_t)n))
			throw Iex::InputExc("the file ends early");
		at += (size_t)n;
		return at < size;
	}
	uint64_t
	tellg() override
	{
		return at;
	}
	void
	seekg(uint64_t to) override
	{
		at = to;
	}
	size_t size = 0;
	int failure = 0; /* of the system, not of the data */

      private:
	FILE *fp = nullptr;
	bool lent = false;
	const char *bytes = nullptr;
	size_t at = 0;
};

bool
get_bytes(void *context, size_t at, void *bytes, size_t n)
{
	return ((Source *)context)->get(at, bytes, n);
}

} // namespace

bool
bake_exr_is_whole(FILE *stream, const char *name)
{
	const off_t at = ftello(stream);
	bool whole = at >= 0;

	try {
		Source source(name);

		whole = whole && source.lend(stream);
		if (whole) {
			Imf::MultiPartInputFile file(source, 0, false);

			for (int i = 0; i < file.parts(); i++)
				whole = whole && file.partComplete(i);
		}
	} catch (...) {
		whole = false;
	}
	return whole && fseeko(stream, at, SEEK_SET) == 0;
}

struct bake_exr {
	std::string name;
	struct bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
	std::unique_ptr<Source> source;
	std::unique_ptr<Imf::MultiPartInputFile> file;
	std::vector<struct bake_exr_part_info> parts;
};

namespace
{

/* An exception while reading: the system's failure, else corrupt data. */
enum bake_status
fail_reading(struct bake_exr *exr, struct bake_err *err)
{
	if (exr->source && exr->source->failure != 0)
		return bake_fail(err, BAKE_EIO, "%s: %s", exr->name.c_str(),
		    strerror(exr->source->failure));
	return bake_exr_fail_exception(err, exr->name, BAKE_EDATA);
}

void
get_attrs(const Imf::Header &header, struct bake_attrs *attrs)
{
	bake_attrs_clear(attrs);
	for (auto i = header.begin(); i != header.end(); ++i) {
		const Imf::Attribute *a = &i.attribute();
		const char *name = i.name();

		if (strncmp(name, "relief:", 7) != 0)
			continue;
		if (auto s = dynamic_cast<const Imf::StringAttribute *>(a))
			bake_attrs_set(attrs, name + 7, s->value().c_str());
		else if (auto f = dynamic_cast<const Imf::FloatAttribute *>(a))
			bake_attrs_set_number(
			    attrs, name + 7, (double)f->value());
		else if (auto n = dynamic_cast<const Imf::IntAttribute *>(a))
			bake_attrs_set_number(attrs, name + 7, n->value());
	}
}

/* HALF where all are, else FLOAT. */
enum bake_data_format
deepest(enum bake_data_format format, const Imf::Channel &channel)
{
	return channel.type == Imf::HALF ? format : BAKE_DATA_FLOAT;
}

void
copy_name(char to[BAKE_INFO_NAME], const char *from)
{
	size_t n = strnlen(from, BAKE_INFO_NAME - 1);

	memcpy(to, from, n);
	to[n] = '\0';
}

void
fill_info(struct bake_exr_part_info *part, const Imf::Header &header)
{
	const Imath::Box2i &data = header.dataWindow();
	struct bake_image_info *info = &part->info;
	int c = 0;

	memset(part, 0, sizeof *part);
	if (header.hasName())
		snprintf(
		    part->name, sizeof part->name, "%s", header.name().c_str());
	part->deep = header.hasType() && Imf::isDeepData(header.type());
	part->tiled = header.hasTileDescription();
	info->width = data.max.x - data.min.x + 1;
	info->height = data.max.y - data.min.y + 1;
	info->data_format = BAKE_DATA_HALF;
	for (auto i = header.channels().begin(); i != header.channels().end();
	     ++i, c++) {
		info->data_format = deepest(info->data_format, i.channel());
		if (c < BAKE_INFO_NAMES)
			copy_name(info->names[c], i.name());
	}
	info->nchans = c;
	info->bits = info->data_format == BAKE_DATA_HALF ? 16 : 32;
	snprintf(info->container, sizeof info->container, "openexr");
	info->orientation = 1;
	info->windowed = data != header.displayWindow();
	get_attrs(header, &info->attrs);
}

enum bake_status
open_source(struct bake_exr *exr, struct bake_err *err)
{
	struct bake_exr_source source = { exr->source.get(), exr->source->size,
		get_bytes };
	enum bake_status rc =
	    bake_exr_scan(&source, &exr->limits, exr->name.c_str(), err);

	if (rc != BAKE_OK)
		return rc;
	/* a table that was never written is not made good: the file is not
	 * whole */
	exr->file.reset(new Imf::MultiPartInputFile(
	    *exr->source, Imf::globalThreadCount(), false));
	exr->parts.resize((size_t)exr->file->parts());
	for (size_t i = 0; rc == BAKE_OK && i < exr->parts.size(); i++) {
		struct bake_image_info *info = &exr->parts[i].info;
		struct bake_image_claim claim;

		fill_info(&exr->parts[i], exr->file->header((int)i));
		info->nsubimages = exr->file->parts();
		claim.width = info->width;
		claim.height = info->height;
		claim.nchans = info->nchans;
		claim.file_size = exr->source->size;
		rc = bake_image_claim_check(&claim, BAKE_KIND_EXR, &exr->limits,
		    exr->name.c_str(), err);
	}
	return rc;
}

enum bake_status
open_exr(struct bake_exr **exr, const char *name, const void *bytes,
    size_t size, const struct bake_read_limits *limits, struct bake_err *err)
{
	std::unique_ptr<bake_exr> e(new bake_exr);
	enum bake_status rc;

	e->name = name;
	e->limits = *limits;
	e->source.reset(new Source(name));
	if (bytes != NULL)
		e->source->set(bytes, size);
	else if (!e->source->open(name))
		return bake_fail(
		    err, BAKE_EIO, "%s: %s", name, strerror(errno));
	try {
		rc = open_source(e.get(), err);
	} catch (...) {
		return fail_reading(e.get(), err);
	}
	if (rc == BAKE_OK)
		*exr = e.release();
	return rc;
}

/* The names to read, found in the part. */
enum bake_status
find_channels(struct bake_exr *exr, int part, const char *const *names,
    int nchans, std::vector<std::string> &found, struct bake_err *err)
{
	if (part < 0 || part >= (int)exr->parts.size())
		return bake_fail(err, BAKE_EINVAL, "%s: part %d of %zu",
		    exr->name.c_str(), part, exr->parts.size());
	const Imf::ChannelList &list = exr->file->header(part).channels();

	if (names == NULL)
		for (auto i = list.begin(); i != list.end(); ++i)
			found.push_back(i.name());
	else
		found.assign(names, names + nchans);
	for (const std::string &name : found) {
		const Imf::Channel *channel = list.findChannel(name);

		if (channel == NULL)
			return bake_fail(err, BAKE_EINVAL,
			    "%s: part %d has no channel %s", exr->name.c_str(),
			    part, name.c_str());
		if (channel->xSampling != 1 || channel->ySampling != 1)
			return bake_fail(err, BAKE_EDATA,
			    "%s: channel %s is subsampled, which is not "
			    "supported",
			    exr->name.c_str(), name.c_str());
	}
	if (found.empty())
		return bake_fail(err, BAKE_EINVAL, "%s: no channel to read",
		    exr->name.c_str());
	return BAKE_OK;
}

enum bake_status
read_flat(struct bake_exr *exr, int part, const std::vector<std::string> &names,
    struct bake_pixels *px, struct bake_err *err)
{
	const Imf::Header &header = exr->file->header(part);
	const struct bake_image_info *info = &exr->parts[(size_t)part].info;
	const Imath::Box2i &data = header.dataWindow();
	enum bake_data_format format = BAKE_DATA_HALF;
	Imf::FrameBuffer frame;
	size_t size, step, row;
	enum bake_status rc;

	if (exr->parts[(size_t)part].deep)
		return bake_fail(err, BAKE_EDATA,
		    "%s: part %d is deep, expected one value per texel and "
		    "channel",
		    exr->name.c_str(), part);
	for (const std::string &name : names)
		format = deepest(format, header.channels()[name]);
	rc = bake_pixels_alloc(
	    px, info->width, info->height, (int)names.size(), format, err);
	if (rc != BAKE_OK)
		return rc;
	size = bake_data_format_size(format);
	step = size * names.size();
	row = step * (size_t)info->width;
	for (size_t c = 0; c < names.size(); c++)
		frame.insert(names[c],
		    Imf::Slice(bake_exr_type(format),
			bake_exr_row_zero(
			    bake_exr_row_zero(
				(char *)px->data + c * size, data.min.y, row),
			    data.min.x, step),
			step, row));
	Imf::InputPart from(*exr->file, part);

	from.setFrameBuffer(frame);
	from.readPixels(data.min.y, data.max.y);
	return BAKE_OK;
}

/* Counts to starts; the samples must be within the limits, and what a file of
 * this size can hold. */
enum bake_status
sum_counts(struct bake_exr *exr, const unsigned *count,
    struct bake_deep_image *deep, struct bake_err *err)
{
	size_t n = (size_t)deep->width * (size_t)deep->height, sum = 0, values;
	struct bake_image_claim claim = { 1, 1, deep->nchans,
		exr->source->size };

	for (size_t i = 0; i < n; i++) {
		deep->start[i] = sum;
		sum += count[i];
	}
	deep->start[n] = deep->nsamples = sum;
	if (!bake_mul_size(sum, (size_t)deep->nchans, &values) ||
	    values / 4 > exr->limits.max_texels)
		return bake_fail(err, BAKE_ELIMIT,
		    "%s: %zu samples of %d channels are more than the limit of "
		    "%zu texels",
		    exr->name.c_str(), sum, deep->nchans,
		    exr->limits.max_texels);
	claim.width = sum < INT_MAX ? (int)sum : INT_MAX;
	return sum == 0 ? BAKE_OK
			: bake_image_claim_check(&claim, BAKE_KIND_EXR,
			      &exr->limits, exr->name.c_str(), err);
}

enum bake_status
read_samples(struct bake_exr *exr, int part,
    const std::vector<std::string> &names, struct bake_deep_image *deep,
    struct bake_err *err)
{
	const Imath::Box2i data = exr->file->header(part).dataWindow();
	size_t width = (size_t)deep->width, n = width * (size_t)deep->height;
	std::vector<unsigned> count(n);
	std::vector<std::vector<char *>> first(names.size());
	Imf::DeepScanLineInputPart from(*exr->file, part);
	Imf::DeepFrameBuffer frame;
	enum bake_status rc;

	/* the address of texel (0, 0), which need not be there */
	auto origin = [&](void *base, size_t step) {
		return bake_exr_row_zero(
		    bake_exr_row_zero(base, data.min.y, step * width),
		    data.min.x, step);
	};

	frame.insertSampleCountSlice(
	    Imf::Slice(Imf::UINT, origin(count.data(), sizeof(unsigned)),
		sizeof(unsigned), sizeof(unsigned) * width));
	for (size_t c = 0; c < names.size(); c++) {
		first[c].resize(n);
		frame.insert(names[c],
		    Imf::DeepSlice(Imf::FLOAT,
			origin(first[c].data(), sizeof(char *)), sizeof(char *),
			sizeof(char *) * width, sizeof(float)));
	}
	/* once: another one would forget the counts */
	from.setFrameBuffer(frame);
	from.readPixelSampleCounts(data.min.y, data.max.y);
	if ((rc = sum_counts(exr, count.data(), deep, err)) != BAKE_OK)
		return rc;
	deep->value = (float *)bake_zalloc(
	    deep->nsamples, names.size() * sizeof(float), err);
	if (deep->value == NULL)
		return BAKE_ENOMEM;
	for (size_t c = 0; c < names.size(); c++)
		for (size_t i = 0; i < n; i++)
			first[c][i] =
			    (char *)(deep->value + c * deep->nsamples +
				     deep->start[i]);
	from.readPixels(data.min.y, data.max.y);
	return BAKE_OK;
}

enum bake_status
read_deep(struct bake_exr *exr, int part, const std::vector<std::string> &names,
    struct bake_deep_image *deep, struct bake_err *err)
{
	const struct bake_exr_part_info *info = &exr->parts[(size_t)part];

	if (!info->deep || info->tiled)
		return bake_fail(err, BAKE_EDATA,
		    "%s: part %d is %s, expected a deep one of scan lines",
		    exr->name.c_str(), part, info->deep ? "tiled" : "flat");
	deep->width = info->info.width;
	deep->height = info->info.height;
	deep->nchans = (int)names.size();
	deep->start =
	    (size_t *)bake_alloc((size_t)deep->width * (size_t)deep->height + 1,
		sizeof *deep->start, err);
	if (deep->start == NULL)
		return BAKE_ENOMEM;
	return read_samples(exr, part, names, deep, err);
}

} // namespace

enum bake_status
bake_exr_open(struct bake_exr **exr, const char *path,
    const struct bake_read_limits *limits, struct bake_err *err)
{
	*exr = NULL;
	try {
		return open_exr(exr, path, NULL, 0, limits, err);
	} catch (...) {
		return bake_exr_fail_exception(err, path, BAKE_EDATA);
	}
}

enum bake_status
bake_exr_open_memory(struct bake_exr **exr, const void *bytes, size_t size,
    const char *name, const struct bake_read_limits *limits,
    struct bake_err *err)
{
	*exr = NULL;
	try {
		return open_exr(exr, name, bytes, size, limits, err);
	} catch (...) {
		return bake_exr_fail_exception(err, name, BAKE_EDATA);
	}
}

void
bake_exr_close(struct bake_exr *exr)
{
	try {
		delete exr;
	} catch (...) {
		/* nothing is left to report to */
	}
}

int
bake_exr_nparts(const struct bake_exr *exr)
{
	return (int)exr->parts.size();
}

const struct bake_exr_part_info *
bake_exr_info(const struct bake_exr *exr, int part)
{
	return &exr->parts[(size_t)part];
}

int
bake_exr_find_part(const struct bake_exr *exr, const char *name)
{
	for (size_t i = 0; i < exr->parts.size(); i++)
		if (strcmp(exr->parts[i].name, name) == 0)
			return (int)i;
	return -1;
}

enum bake_status
bake_exr_read(struct bake_exr *exr, int part, const char *const *names,
    int nchans, struct bake_pixels *px, struct bake_err *err)
{
	const struct bake_pixels init = BAKE_PIXELS_INIT;
	enum bake_status rc;

	*px = init;
	try {
		std::vector<std::string> found;

		rc = find_channels(exr, part, names, nchans, found, err);
		if (rc == BAKE_OK)
			rc = read_flat(exr, part, found, px, err);
	} catch (...) {
		rc = fail_reading(exr, err);
	}
	if (rc != BAKE_OK)
		bake_pixels_free(px);
	return rc;
}

void
bake_deep_image_free(struct bake_deep_image *deep)
{
	const struct bake_deep_image init = BAKE_DEEP_IMAGE_INIT;

	free(deep->start);
	free(deep->value);
	*deep = init;
}

enum bake_status
bake_exr_read_deep(struct bake_exr *exr, int part, const char *const *names,
    int nchans, struct bake_deep_image *deep, struct bake_err *err)
{
	const struct bake_deep_image init = BAKE_DEEP_IMAGE_INIT;
	enum bake_status rc;

	*deep = init;
	try {
		std::vector<std::string> found;

		rc = find_channels(exr, part, names, nchans, found, err);
		if (rc == BAKE_OK)
			rc = read_deep(exr, part, found, deep, err);
	} catch (...) {
		rc = fail_reading(exr, err);
	}
	if (rc != BAKE_OK)
		bake_deep_image_free(deep);
	return rc;
}
