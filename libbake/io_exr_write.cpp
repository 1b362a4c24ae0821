/* Writing multi-part and deep EXR: the shim over OpenEXR. */
/* SPDX-License-Identifier: MIT */
#include "io_exr_priv.hpp"

#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <set>
#include <string>
#include <vector>

#include "mem.h"
#include "parallel.h"

namespace
{

/* The library's message on one line. */
std::string
one_line(std::string text)
{
	for (char &c : text)
		if ((unsigned char)c < ' ')
			c = ' ';
	while (!text.empty() && (text.back() == ' ' || text.back() == '.'))
		text.pop_back();
	return text.empty() ? "the EXR library failed" : text;
}

} // namespace

enum bake_status
bake_exr_fail_exception(
    struct bake_err *err, const std::string &name, enum bake_status code)
{
	try {
		throw;
	} catch (const std::bad_alloc &) {
		return bake_fail(
		    err, BAKE_ENOMEM, "%s: no memory for it", name.c_str());
	} catch (const std::exception &e) {
		return bake_fail(err, code, "%s: %s", name.c_str(),
		    one_line(e.what()).c_str());
	} catch (...) {
		return bake_fail(
		    err, code, "%s: the EXR library failed", name.c_str());
	}
}

namespace
{

/* A stream to write to. It remembers the first failure, since the library's
 * destructors pass over one. */
class Stream : public Imf::OStream
{
      public:
	Stream(FILE *f, const char *name) : OStream(name), fp(f)
	{
	}
	void
	write(const char *bytes, int n) override
	{
		errno = 0;
		if (fwrite(bytes, 1, (size_t)n, fp) != (size_t)n)
			note();
	}
	uint64_t
	tellp() override
	{
		off_t at = ftello(fp);

		/* the library's destructor catches nothing here */
		if (at < 0 && failure == 0)
			failure = errno;
		return at < 0 ? 0 : (uint64_t)at;
	}
	void
	seekp(uint64_t at) override
	{
		errno = 0;
		if (fseeko(fp, (off_t)at, SEEK_SET) != 0)
			note();
	}
	/* Write out what is buffered. */
	enum bake_status
	finish(struct bake_err *err)
	{
		errno = 0;
		if ((fflush(fp) != 0 || ferror(fp)) && failure == 0)
			failure = errno != 0 ? errno : EIO;
		if (failure == 0)
			return BAKE_OK;
		return bake_fail(
		    err, BAKE_EIO, "%s: %s", fileName(), strerror(failure));
	}
	/* The same of a file that was closed. */
	enum bake_status
	finish_file(struct bake_err *err)
	{
		enum bake_status rc = finish(err);

		if (rc != BAKE_OK || bake_exr_is_whole(fp, fileName()))
			return rc;
		return bake_fail(
		    err, BAKE_ENOMEM, "%s: no memory to write it", fileName());
	}
	int failure = 0;

      private:
	FILE *fp;

	void
	note()
	{
		if (failure == 0)
			failure = errno != 0 ? errno : EIO;
		throw Iex::IoExc(strerror(failure));
	}
};

/* How many threads compress so many texels, see bake_io_set_exr_threads. They
 * belong to the process, not to the file: the library has one pool, which only
 * grows here. */
int
use_threads(int nthreads, double ntexels)
{
	int n = bake_threads(nthreads);
	/* makes the pool: where the first task does and there is no memory for
	 * it, that task is waited for forever */
	int nthere = Imf::globalThreadCount();

	if (n <= 1 || ntexels < 1 << 19)
		return 0; /* in the calling one */
	if (nthere < n)
		Imf::setGlobalThreadCount(n);
	return n;
}

void
put_attrs(Imf::Header &header, const struct bake_attrs *attrs)
{
	for (int i = 0; attrs != NULL && i < attrs->n; i++) {
		const struct bake_attr *a = &attrs->attr[i];
		std::string name = std::string("relief:") + a->name;

		if (a->number)
			header.insert(
			    name, Imf::FloatAttribute(strtof(a->value, NULL)));
		else
			header.insert(name, Imf::StringAttribute(a->value));
	}
}

/* Add a channel; false, with a failure, where it has no name or another's. */
enum bake_status
put_channel(Imf::Header &header, const char *channel,
    enum bake_data_format format, const char *file, struct bake_err *err)
{
	if (format != BAKE_DATA_HALF && format != BAKE_DATA_FLOAT)
		return bake_fail(err, BAKE_EINVAL, "%s: exr holds no %s values",
		    file, bake_data_format_name(format));
	if (channel == NULL || channel[0] == '\0')
		return bake_fail(
		    err, BAKE_EINVAL, "%s: a channel has no name", file);
	if (header.channels().findChannel(channel) != NULL)
		return bake_fail(err, BAKE_EINVAL,
		    "%s: two channels are called %s", file, channel);
	header.channels().insert(channel, Imf::Channel(bake_exr_type(format)));
	return BAKE_OK;
}

/* The names of n channels where none are given. */
const char *
usual_name(int nchans, int c)
{
	static const char *const usual[4][4] = { { "Y" }, { "Y", "A" },
		{ "R", "G", "B" }, { "R", "G", "B", "A" } };

	return nchans <= 4 ? usual[nchans - 1][c] : NULL;
}

const char *
channel_name(const struct bake_exr_channels *channels, int c)
{
	if (channels->names != NULL)
		return channels->names[c];
	return usual_name(channels->px->nchans, c);
}

enum bake_status
make_header(Imf::Header &header, const struct bake_exr_part *part,
    const char *file, struct bake_err *err)
{
	const struct bake_pixels *first = part->channels[0].px;
	enum bake_status rc = BAKE_OK;

	for (int i = 0; i < part->nchannels; i++) {
		const struct bake_exr_channels *ch = &part->channels[i];

		if (ch->px->width != first->width ||
		    ch->px->height != first->height)
			return bake_fail(err, BAKE_EINVAL,
			    "%s: pixels of part %s are %dx%d, expected %dx%d",
			    file, part->name, ch->px->width, ch->px->height,
			    first->width, first->height);
		for (int c = 0; rc == BAKE_OK && c < ch->px->nchans; c++)
			rc = put_channel(header, channel_name(ch, c),
			    ch->px->format, file, err);
	}
	header.setName(part->name);
	header.setType(Imf::SCANLINEIMAGE);
	header.compression() = Imf::ZIP_COMPRESSION;
	put_attrs(header, part->attrs);
	return rc;
}

enum bake_status
make_headers(std::vector<Imf::Header> &headers,
    const struct bake_exr_part *part, int nparts, const char *file,
    struct bake_err *err)
{
	std::set<std::string> names;
	enum bake_status rc = BAKE_OK;

	if (nparts < 1)
		return bake_fail(err, BAKE_EINVAL, "%s: no part", file);
	for (int i = 0; rc == BAKE_OK && i < nparts; i++) {
		const struct bake_exr_part *p = &part[i];

		if (p->name == NULL || p->name[0] == '\0')
			return bake_fail(
			    err, BAKE_EINVAL, "%s: a part has no name", file);
		if (!names.insert(p->name).second)
			return bake_fail(err, BAKE_EINVAL,
			    "%s: two parts are called %s", file, p->name);
		if (p->nchannels < 1)
			return bake_fail(err, BAKE_EINVAL,
			    "%s: part %s has no channel", file, p->name);
		headers.emplace_back(
		    p->channels[0].px->width, p->channels[0].px->height);
		/* which all parts of a file share */
		headers.back().displayWindow() = headers[0].displayWindow();
		rc = make_header(headers.back(), p, file, err);
	}
	return rc;
}

void
write_part(
    Imf::MultiPartOutputFile &out, const struct bake_exr_part *part, int number)
{
	Imf::OutputPart to(out, number);
	Imf::FrameBuffer frame;

	for (int i = 0; i < part->nchannels; i++) {
		const struct bake_exr_channels *ch = &part->channels[i];
		size_t size = bake_data_format_size(ch->px->format);
		size_t step = size * (size_t)ch->px->nchans;

		for (int c = 0; c < ch->px->nchans; c++)
			frame.insert(channel_name(ch, c),
			    Imf::Slice(bake_exr_type(ch->px->format),
				(char *)ch->px->data + size * (size_t)c, step,
				step * (size_t)ch->px->width));
	}
	to.setFrameBuffer(frame);
	to.writePixels(part->channels[0].px->height);
}

enum bake_status
write_parts(const struct bake_exr_part *part, int nparts, int nthreads,
    Stream &stream, struct bake_err *err)
{
	std::vector<Imf::Header> headers;
	double ntexels = 0;
	enum bake_status rc =
	    make_headers(headers, part, nparts, stream.fileName(), err);

	if (rc != BAKE_OK)
		return rc;
	for (int i = 0; i < nparts; i++)
		ntexels += (double)part[i].channels[0].px->width *
			   part[i].channels[0].px->height;
	{
		/* its end writes the tables */
		Imf::MultiPartOutputFile out(stream, headers.data(), nparts,
		    false, use_threads(nthreads, ntexels));

		for (int i = 0; i < nparts; i++)
			write_part(out, &part[i], i);
	}
	return stream.finish_file(err);
}

} // namespace

enum bake_status
bake_exr_write(const struct bake_exr_part *part, int nparts, int nthreads,
    FILE *stream, const char *name, struct bake_err *err)
{
	try {
		Stream out(stream, name);

		try {
			return write_parts(part, nparts, nthreads, out, err);
		} catch (...) {
			if (out.failure != 0)
				return out.finish(err);
			throw;
		}
	} catch (...) {
		return bake_exr_fail_exception(err, name, BAKE_EIO);
	}
}

struct bake_deep_writer {
	bake_deep_writer(FILE *f, const char *n) : stream(f, n), name(n)
	{
	}
	Stream stream;
	std::string name;
	int width = 0, height = 0, y = 0;
	bool failed = false;
	std::vector<std::string> names;
	std::vector<enum bake_data_format> formats;
	std::unique_ptr<Imf::DeepScanLineOutputFile> out;
};

namespace
{

enum bake_status
open_deep(struct bake_deep_writer *w, const struct bake_deep_channel *channel,
    int nchans, const struct bake_attrs *attrs, int nthreads,
    struct bake_err *err)
{
	Imf::Header header(w->width, w->height);
	enum bake_status rc = BAKE_OK;

	for (int c = 0; rc == BAKE_OK && c < nchans; c++) {
		rc = put_channel(header, channel[c].name, channel[c].format,
		    w->name.c_str(), err);
		if (rc != BAKE_OK)
			return rc;
		w->names.push_back(channel[c].name);
		w->formats.push_back(channel[c].format);
	}
	header.setType(Imf::DEEPSCANLINE);
	header.compression() = Imf::ZIPS_COMPRESSION;
	put_attrs(header, attrs);
	w->out.reset(new Imf::DeepScanLineOutputFile(w->stream, header,
	    use_threads(nthreads, (double)w->width * w->height)));
	return BAKE_OK;
}

/* The values of a channel, side by side as they are stored. */
void
gather(std::vector<unsigned char> &to, enum bake_data_format format,
    const struct bake_deep_samples *from, size_t n)
{
	to.resize(n * bake_data_format_size(format) +
		  1); /* never without an address */
	for (size_t i = 0; i < n; i++) {
		const float *v = &from->value[i * from->stride];

		if (format == BAKE_DATA_HALF)
			bake_codes_to_half((uint16_t *)to.data() + i, v, 1);
		else
			memcpy(to.data() + i * sizeof *v, v, sizeof *v);
	}
}

/* How many samples there are; false where a row has too many to be stored. */
bool
count_samples(const unsigned *count, int width, int nrows, size_t *n)
{
	*n = 0;
	for (int y = 0; y < nrows; y++) {
		size_t row = 0;

		for (int x = 0; x < width; x++)
			row += count[(size_t)y * (size_t)width + (size_t)x];
		if (row > INT_MAX)
			return false;
		*n += row;
	}
	return true;
}

void
write_rows(struct bake_deep_writer *w, int nrows, const unsigned *count,
    const struct bake_deep_samples *samples, size_t n)
{
	size_t ntexels = (size_t)w->width * (size_t)nrows;
	size_t nchans = w->names.size();
	std::vector<std::vector<unsigned char>> values(nchans);
	std::vector<std::vector<char *>> first(nchans);
	Imf::DeepFrameBuffer frame;

	frame.insertSampleCountSlice(Imf::Slice(Imf::UINT,
	    bake_exr_row_zero(count, w->y, sizeof *count * (size_t)w->width),
	    sizeof *count, sizeof *count * (size_t)w->width));
	for (size_t c = 0; c < nchans; c++) {
		size_t size = bake_data_format_size(w->formats[c]), at = 0;

		gather(values[c], w->formats[c], &samples[c], n);
		first[c].resize(ntexels);
		for (size_t i = 0; i < ntexels; i++) {
			first[c][i] = (char *)values[c].data() + at * size;
			at += count[i];
		}
		frame.insert(
		    w->names[c], Imf::DeepSlice(bake_exr_type(w->formats[c]),
				     bake_exr_row_zero(first[c].data(), w->y,
					 sizeof(char *) * (size_t)w->width),
				     sizeof(char *),
				     sizeof(char *) * (size_t)w->width, size));
	}
	w->out->setFrameBuffer(frame);
	w->out->writePixels(nrows);
	w->y += nrows;
}

} // namespace

enum bake_status
bake_deep_writer_open(struct bake_deep_writer **writer, FILE *stream,
    const char *name, int width, int height,
    const struct bake_deep_channel *channel, int nchans,
    const struct bake_attrs *attrs, int nthreads, struct bake_err *err)
{
	*writer = NULL;
	if (width < 1 || height < 1 || nchans < 1)
		return bake_fail(err, BAKE_EINVAL,
		    "%s: a deep image of %dx%d texels and %d channels", name,
		    width, height, nchans);
	try {
		std::unique_ptr<bake_deep_writer> w(
		    new bake_deep_writer(stream, name));
		enum bake_status rc;

		w->width = width;
		w->height = height;
		try {
			rc = open_deep(
			    w.get(), channel, nchans, attrs, nthreads, err);
		} catch (...) {
			if (w->stream.failure != 0)
				return w->stream.finish(err);
			throw;
		}
		if (rc == BAKE_OK)
			*writer = w.release();
		return rc;
	} catch (...) {
		return bake_exr_fail_exception(err, name, BAKE_EIO);
	}
}

enum bake_status
bake_deep_writer_rows(struct bake_deep_writer *w, int nrows,
    const unsigned *count, const struct bake_deep_samples *samples,
    struct bake_err *err)
{
	size_t n;

	if (nrows < 1 || nrows > w->height - w->y || w->failed)
		return bake_fail(err, BAKE_EINVAL, "%s: %d rows after %d of %d",
		    w->name.c_str(), nrows, w->y, w->height);
	if (!count_samples(count, w->width, nrows, &n))
		return bake_fail(err, BAKE_EINVAL,
		    "%s: more than %d samples in a row", w->name.c_str(),
		    INT_MAX);
	try {
		write_rows(w, nrows, count, samples, n);
		return BAKE_OK;
	} catch (...) {
		w->failed = true;
		if (w->stream.failure != 0)
			return w->stream.finish(err);
		return bake_exr_fail_exception(err, w->name, BAKE_EIO);
	}
}

enum bake_status
bake_deep_writer_close(struct bake_deep_writer *w, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;

	if (w == NULL)
		return BAKE_OK;
	try {
		w->out.reset(); /* writes the table */
		if (w->y < w->height && w->stream.failure == 0)
			rc = bake_fail(err, BAKE_EINVAL,
			    "%s: only %d of %d rows were written",
			    w->name.c_str(), w->y, w->height);
		else
			rc = w->stream.finish_file(err);
		delete w;
	} catch (...) {
		rc = bake_fail(err, BAKE_EIO, "the EXR library failed");
	}
	return rc;
}
