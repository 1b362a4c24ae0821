/* Image files: the only module that knows OpenImageIO. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_IO_IMAGE_H
#define BAKE_IO_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "attrs.h"
#include "codes.h"
#include "digest.h"
#include "image.h"
#include "pixels.h"

#ifdef __cplusplus
extern "C" {
#endif

enum bake_file_type {
	BAKE_FILE_PNG,
	BAKE_FILE_TGA,
	BAKE_FILE_TIFF,
	BAKE_FILE_EXR
};

enum { BAKE_INFO_NAMES = 64, BAKE_INFO_NAME = 64 };

/* What a file says of itself, before a texel is read. Plain data. */
struct bake_image_info {
	int width, height, nchans;
	enum bake_data_format data_format; /* that holds its values */
	int bits;           /* significant bits of the file's own samples */
	bool is_signed;     /* signed integers, read as -1 .. 1 */
	char container[16]; /* "png", "openexr", "jpeg" … */
	char names[BAKE_INFO_NAMES][BAKE_INFO_NAME]; /* of the channels */
	int nsubimages;  /* further pages, parts or layers are not read */
	int orientation; /* EXIF/TIFF, 1 = upright; never applied */
	bool windowed;   /* the EXR data window is not the display window:
			  * the data window's texels are the image */
	struct bake_attrs attrs;         /* the relief: attributes */
	struct bake_digest stdin_digest; /* of standard input's bytes, where
					  * they are what was opened */
};

/* Limits that hold before anything is allocated. */
struct bake_read_limits {
	size_t max_texels; /* width * height; four times as many values */
	bool trust_size;   /* no look at what the file's own size allows */
};
#define BAKE_READ_LIMITS_DEFAULT                                               \
	{                                                                      \
		(size_t)1 << 30, false                                         \
	}

struct bake_reader; /* an open image file */

/*
 * Open an image file of any kind that OpenImageIO knows, recognised by its
 * content (by its name only where the content has no mark), and tell what it
 * holds. path "-" is standard input, read to its end into memory.
 *
 *   reader  out: the caller closes it with bake_reader_close; NULL on failure
 *   info    out
 *
 * Refused before any allocation: sizes beyond the limits; sizes that a file
 * this small cannot hold (256 times less than a byte's worth of RLE, 1032
 * times of deflate …), as a decompression bomb claims; deep images.
 *
 * BAKE_EIO     the file cannot be opened or read; err names it and the reason
 * BAKE_EDATA   it is no image, or a corrupt or an unsupported one
 * BAKE_ELIMIT  it is larger than the limits
 *
 * Values are never colour-managed, and alpha is data: RGB is never multiplied
 * or divided by it.
 * Thread safety: different readers may be used by different threads.
 */
BAKE_API enum bake_status bake_reader_open(struct bake_reader **reader,
    const char *path, const struct bake_read_limits *limits,
    struct bake_image_info *info, struct bake_err *err);

/* The same from memory, which must outlive the reader; name is used in
 * messages and for its extension. */
BAKE_API enum bake_status bake_reader_open_memory(struct bake_reader **reader,
    const void *bytes, size_t size, const char *name,
    const struct bake_read_limits *limits, struct bake_image_info *info,
    struct bake_err *err);

/*
 * Read nchans channels from channel first on into a new image, row 0 the top.
 * uint8 and uint16 codes become code / max, correctly rounded; half and float
 * values are themselves; other types are scaled by OpenImageIO.
 *
 *   img  out: BAKE_IMAGE_INIT before; the caller's to free
 *
 * BAKE_EDATA   the texels are corrupt or end early, also where the image
 *              library calls it success
 * BAKE_ENOMEM  no memory
 */
BAKE_API enum bake_status bake_reader_read(struct bake_reader *reader,
    int first, int nchans, struct bake_image *img, struct bake_err *err);

/*
 * The same of any n channels in any order, n >= 1: channel
 * c of the image is the file's channel[c]. Beside the image there is a band of
 * rows in memory, or of one row of tiles; never the file's other channels.
 */
BAKE_API enum bake_status bake_reader_read_channels(struct bake_reader *reader,
    const int *channel, int n, struct bake_image *img, struct bake_err *err);

/* Close and free; harmless on NULL. */
BAKE_API void bake_reader_close(struct bake_reader *reader);

/* How to write a file. */
struct bake_write_params {
	enum bake_file_type type;
	enum bake_data_format data_format; /* must be one that the type holds */
	/* nchans channel names, which EXR sorts; NULL: Y, YA, RGB, RGBA, and
	 * c000000, c000001 … of more than 4 */
	const char *const *names;
	struct bake_attrs attrs;
	int png_level; /* deflate level, 1 .. 9 */
	int tile; /* TIFF and EXR: the side of a tile in texels, a multiple of
		   * 16; 0: whole rows */
};

/* PNG files are written with the Paeth filter and this deflate level: on a
 * packed 2048x2048 rock 14 % larger than level 6 with the filter chosen row by
 * row, at a sixth of its time. */
enum { BAKE_PNG_LEVEL = 2 };

/* Whether the type can hold the data format (PNG: uint8, uint16; TGA: uint8;
 * TIFF: all but half; EXR: half and float). */
BAKE_API bool bake_file_type_holds(
    enum bake_file_type type, enum bake_data_format format);

/* The nearest data format that the type holds: format itself, else the next
 * deeper one, else the deepest. */
BAKE_API enum bake_data_format bake_file_type_nearest(
    enum bake_file_type type, enum bake_data_format format);

/* The type that a name's extension (png tga tif tiff exr) or a type's name
 * says; false where it says none. */
BAKE_API bool bake_file_type_from_path(
    const char *path, enum bake_file_type *type);
BAKE_API bool bake_file_type_from_name(
    const char *name, enum bake_file_type *type);
BAKE_API const char *bake_file_type_name(enum bake_file_type type);

/*
 * Write an image to a stream that can seek (see output.h). The same image and
 * parameters give the same bytes. Alpha is data: stored as it is.
 *
 *   name      used in messages
 *   nclipped  out: values that an integer format clipped; may be NULL
 *
 * A TIFF file of more than 4 GB of texels is a BigTIFF.
 *
 * BAKE_EINVAL  the type does not hold the data format, the channels, the size
 *              (PNG: 1,000,000 texels a side, TGA 65,535, the others 2^20) or
 *              tiles
 * BAKE_EIO     writing failed; what the stream holds is of no use
 */
BAKE_API enum bake_status bake_image_write(const struct bake_image *img,
    const struct bake_write_params *params, FILE *stream, const char *name,
    size_t *nclipped, struct bake_err *err);

/*
 * The same of pixels in a data format of their own: the bytes are those of
 * bake_image_write of the same values. Where px->format is params->data_format
 * values go through as they are, bit for bit (the NaNs of half and float too);
 * otherwise by way of floats. Never a copy of the whole picture.
 */
BAKE_API enum bake_status bake_pixels_write(const struct bake_pixels *px,
    const struct bake_write_params *params, FILE *stream, const char *name,
    size_t *nclipped, struct bake_err *err);

/* Rows of a picture that are made when the file wants them. */
struct bake_row_source {
	int width, height, nchans;
	/*
	 * Rows y .. y + n - 1 as n * width * nchans floats. The rows are asked
	 * for once each, in order, on the calling thread; get may use several.
	 * A failure ends the writing and is what bake_rows_write returns; it is
	 * not BAKE_EIO.
	 */
	enum bake_status (*get)(
	    void *arg, int y, int n, float *rows, struct bake_err *err);
	void *arg;
};

/* bake_image_write of an image that is nowhere whole: the bytes are the same.
 * A band of rows, or one row of tiles, is in memory. */
BAKE_API enum bake_status bake_rows_write(const struct bake_row_source *rows,
    const struct bake_write_params *params, FILE *stream, const char *name,
    size_t *nclipped, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
