/* File types that are written: their names and what they hold. */
/* SPDX-License-Identifier: MIT */
#include <string.h>
#include <strings.h>

#include "io_image.h"

static const char *const type_names[] = { "png", "tga", "tiff", "exr" };

static const struct {
	const char *ext;
	enum bake_file_type type;
} extensions[] = {
	{ "png", BAKE_FILE_PNG },
	{ "tga", BAKE_FILE_TGA },
	{ "tif", BAKE_FILE_TIFF },
	{ "tiff", BAKE_FILE_TIFF },
	{ "exr", BAKE_FILE_EXR },
};

bool
bake_file_type_holds(enum bake_file_type type, enum bake_data_format format)
{
	switch (type) {
	case BAKE_FILE_PNG:
		return format <= BAKE_DATA_UINT16;
	case BAKE_FILE_TGA:
		return format == BAKE_DATA_UINT8;
	case BAKE_FILE_TIFF:
		return format != BAKE_DATA_HALF;
	case BAKE_FILE_EXR:
		return format >= BAKE_DATA_HALF;
	}
	return false;
}

enum bake_data_format
bake_file_type_nearest(enum bake_file_type type, enum bake_data_format format)
{
	/* half has too few bits for 16-bit codes */
	if (type == BAKE_FILE_EXR && format == BAKE_DATA_UINT16)
		return BAKE_DATA_FLOAT;
	for (int f = format; f <= BAKE_DATA_FLOAT; f++)
		if (bake_file_type_holds(type, (enum bake_data_format)f))
			return (enum bake_data_format)f;
	for (int f = BAKE_DATA_FLOAT; f > BAKE_DATA_UINT8; f--)
		if (bake_file_type_holds(type, (enum bake_data_format)f))
			return (enum bake_data_format)f;
	return BAKE_DATA_UINT8;
}

bool
bake_file_type_from_name(const char *name, enum bake_file_type *type)
{
	for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++) {
		if (strcasecmp(name, extensions[i].ext) != 0)
			continue;
		*type = extensions[i].type;
		return true;
	}
	return false;
}

bool
bake_file_type_from_path(const char *path, enum bake_file_type *type)
{
	const char *slash = strrchr(path, '/');
	const char *dot = strrchr(slash != NULL ? slash : path, '.');

	return dot != NULL && bake_file_type_from_name(dot + 1, type);
}

const char *
bake_file_type_name(enum bake_file_type type)
{
	return type_names[type];
}
