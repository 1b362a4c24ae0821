/* OpenEXR files of several parts, and deep ones: the module that knows them. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_IO_EXR_H
#define BAKE_IO_EXR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "attrs.h"
#include "codes.h"
#include "io_image.h"
#include "pixels.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Whether all chunks of all parts of an EXR file just written are there. The
 * library writes their table when it closes the file, and tells nobody where
 * that fails (for want of memory). The stream can be read; it stays where it
 * is.
 */
bool bake_exr_is_whole(FILE *stream, const char *name);

/*
 * Multi-part files. A part is an image of its own, with a name, channels and
 * attributes; its channels come from one or several pixels of one size.
 *
 *   names    [px->nchans]; NULL: Y; Y A; R G B; R G B A. Unique in the part.
 *            A file has them sorted
 *   formats  HALF or FLOAT, each channel that of its pixels
 *   attrs    the relief: attributes, as io_image.h writes them (a number as a
 *            float, else a string); NULL: none
 */
struct bake_exr_channels {
	const struct bake_pixels *px;
	const char *const *names;
};
struct bake_exr_part {
	const char *name; /* unique in the file, not empty */
	int nchannels;    /* how many of channels, >= 1 */
	const struct bake_exr_channels *channels;
	const struct bake_attrs *attrs;
};

/*
 * Write nparts >= 1 parts to a stream that can seek (see output.h), each in
 * rows from the top, ZIP compressed. One part makes an ordinary file. Parts may
 * differ in size; all have the first one's display window, as they must. Values
 * go through bit for bit, NaNs too, without a copy of the picture. Nothing but
 * the parts is in the file (no time, host or maker): the same parts give the
 * same bytes for any number of threads.
 *
 *   nthreads  that compress; 0: all
 *   name      used in messages
 *
 * BAKE_EINVAL  no part; a name is missing or twice there; pixels are neither
 *              half nor float; sizes in a part differ
 * BAKE_EIO     writing failed; what the stream holds is of no use
 * BAKE_ENOMEM  no memory
 *
 * Threads may write different files.
 */
BAKE_API enum bake_status bake_exr_write(const struct bake_exr_part *part,
    int nparts, int nthreads, FILE *stream, const char *name,
    struct bake_err *err);

/*
 * Deep images: any number of samples per texel. Those of a multilayer relief
 * have one sample for each layer, near to far, none where a texel is empty, and
 * these channels, sorted by their names as in any EXR file:
 *     Z              float  distance behind the near plane along the axis, in
 *                           the mesh's unit: (near - far) depth
 *     depth          float  d, 0 at the near plane .. 1 at the far one
 *     A              half   1
 *     N.x N.y N.z    half   normal in the view's axes, y up, z to the eye
 *     R G B          half   colour, scene-linear; where there is one
 * ZIPS compressed, the only one beside RLE that deep images can have.
 */
struct bake_deep_channel {
	const char *name;
	enum bake_data_format format; /* HALF or FLOAT */
};

/* The samples of a channel: value[i * stride] is sample i, texel by texel. */
struct bake_deep_samples {
	const float *value;
	size_t stride;
};

struct bake_deep_writer; /* a deep image that is being written */

/*
 * Begin a deep image on a stream that can seek.
 *
 *   writer   out: to be closed; NULL on failure
 *   channel  [nchans], names unique; copied
 *   attrs    as above; may be NULL
 *
 * BAKE_EINVAL  a size or nchans below 1; a name is missing or twice there; a
 *              format is neither HALF nor FLOAT
 * BAKE_EIO, BAKE_ENOMEM  as above
 */
BAKE_API enum bake_status bake_deep_writer_open(
    struct bake_deep_writer **writer, FILE *stream, const char *name, int width,
    int height, const struct bake_deep_channel *channel, int nchans,
    const struct bake_attrs *attrs, int nthreads, struct bake_err *err);

/*
 * The next nrows rows, from the top.
 *
 *   count    [nrows * width] samples of each texel
 *   samples  [nchans], each of the sum of count; half rounds to nearest even
 *            and clips at +-65504
 *
 * BAKE_EINVAL  more rows than the image has; 2^31 samples in one row or more
 * BAKE_EIO, BAKE_ENOMEM  as above; the writer is then good for closing only
 */
BAKE_API enum bake_status bake_deep_writer_rows(struct bake_deep_writer *writer,
    int nrows, const unsigned *count, const struct bake_deep_samples *samples,
    struct bake_err *err);

/*
 * Finish the file and free the writer; does nothing on NULL. To give up, call
 * it and drop what the stream holds.
 *
 * BAKE_EINVAL  not all rows were written
 * BAKE_EIO     as above
 */
BAKE_API enum bake_status bake_deep_writer_close(
    struct bake_deep_writer *writer, struct bake_err *err);

/*
 * What a part of a file says of itself. info is as io_image.h has it, its names
 * in the file's order (sorted); nsubimages is the number of parts.
 */
struct bake_exr_part_info {
	char name[BAKE_INFO_NAME]; /* "" where it has none */
	bool deep, tiled;
	struct bake_image_info info;
};

struct bake_exr; /* an open EXR file */

/*
 * Open an EXR file of any sort: one part or several, flat or deep. The
 * limits hold for each part, before anything is allocated (so do those of what
 * a file of its size can hold, as in io_image.h).
 *
 *   exr  out: the caller closes it with bake_exr_close; NULL on failure
 *
 * BAKE_EIO     the file cannot be opened or read
 * BAKE_EDATA   it is no EXR file, or a corrupt one
 * BAKE_ELIMIT  it is larger than the limits
 * BAKE_ENOMEM  no memory
 *
 * Thread safety: different files may be used by different threads.
 */
BAKE_API enum bake_status bake_exr_open(struct bake_exr **exr, const char *path,
    const struct bake_read_limits *limits, struct bake_err *err);

/* The same from memory, which must outlive exr; name is used in messages. */
BAKE_API enum bake_status bake_exr_open_memory(struct bake_exr **exr,
    const void *bytes, size_t size, const char *name,
    const struct bake_read_limits *limits, struct bake_err *err);

/* Close and free; harmless on NULL. */
BAKE_API void bake_exr_close(struct bake_exr *exr);

/* How many parts there are, at least 1; what one says, which belongs to exr;
 * the index of the first of that name, -1 where there is none. */
BAKE_API int bake_exr_nparts(const struct bake_exr *exr);
BAKE_API const struct bake_exr_part_info *bake_exr_info(
    const struct bake_exr *exr, int part);
BAKE_API int bake_exr_find_part(const struct bake_exr *exr, const char *name);

/*
 * Read channels of a flat part, row 0 the top of its data window. Half and
 * float come bit for bit; pixels are HALF where all of these channels are, else
 * FLOAT, to which half and integers are converted.
 *
 *   names  [nchans], in the order that px is to have; NULL: all, in the order
 *          of info.names (nchans does not count)
 *   px     out: BAKE_PIXELS_INIT before; the caller's to free
 *
 * BAKE_EINVAL  no such part or channel
 * BAKE_EDATA   the part is deep; a channel is subsampled; texels are corrupt or
 *              missing
 * BAKE_EIO, BAKE_ELIMIT, BAKE_ENOMEM  as above
 */
BAKE_API enum bake_status bake_exr_read(struct bake_exr *exr, int part,
    const char *const *names, int nchans, struct bake_pixels *px,
    struct bake_err *err);

/*
 * A deep image: texel (x, y) has the samples start[i] .. start[i + 1] - 1, i =
 * y width + x; sample k of channel c is value[c * nsamples + k].
 */
struct bake_deep_image {
	int width, height, nchans;
	size_t nsamples;
	size_t *start; /* [width * height + 1] */
	float *value;  /* [nchans][nsamples] */
};
#define BAKE_DEEP_IMAGE_INIT                                                   \
	{                                                                      \
		0, 0, 0, 0, NULL, NULL                                         \
	}
BAKE_API void bake_deep_image_free(struct bake_deep_image *deep);

/*
 * Read channels of a deep part. Samples are limited as texels are: 4 for each
 * texel that limits.max_texels allows, of all channels together.
 *
 *   deep  out: BAKE_DEEP_IMAGE_INIT before; the caller's to free
 *
 * Errors as bake_exr_read has them; BAKE_EDATA where the part is flat, or both
 * deep and tiled.
 */
BAKE_API enum bake_status bake_exr_read_deep(struct bake_exr *exr, int part,
    const char *const *names, int nchans, struct bake_deep_image *deep,
    struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
