/* Named attributes: the metadata that travels with an image file. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_ATTRS_H
#define BAKE_ATTRS_H

#include <stdbool.h>
#include <stddef.h>

#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { BAKE_ATTRS_MAX = 20, BAKE_ATTR_NAME = 32, BAKE_ATTR_VALUE = 512 };

/*
 * Attributes `relief:NAME = VALUE`. An EXR file holds each as an attribute of
 * its own (a number as a float, where number is set); PNG, TIFF and TGA hold
 * all of them as one line of text, their ImageDescription:
 *     relief:Layout=relief; relief:DepthScale=0.1
 * In TGA that line is broken into 4 of 80 characters, each with whole
 * attributes; one that finds no room there is left out. Recipe and RecipeFiles
 * (record.h) are its names of the job and of the software.
 * A name is not empty and has no '='; neither has a ';' or a control character.
 * Plain data.
 */
struct bake_attr {
	char name[BAKE_ATTR_NAME];
	char value[BAKE_ATTR_VALUE];
	bool number;
};
struct bake_attrs {
	int n;
	struct bake_attr attr[BAKE_ATTRS_MAX];
};

/* No attribute yet. */
BAKE_API void bake_attrs_clear(struct bake_attrs *attrs);

/* Set an attribute, replacing one of the same name. What does not fit (more
 * than BAKE_ATTRS_MAX, text too long or of other characters) is left out. */
BAKE_API void bake_attrs_set(
    struct bake_attrs *attrs, const char *name, const char *value);
/* The same for a number: the shortest of printf's %.1g to %.9g that reads back
 * as the same float. */
BAKE_API void bake_attrs_set_number(
    struct bake_attrs *attrs, const char *name, double value);

/* Take an attribute away, if it is there. */
BAKE_API void bake_attrs_remove(struct bake_attrs *attrs, const char *name);

/* The value of an attribute; NULL where there is none. Belongs to attrs. */
BAKE_API const char *bake_attrs_get(
    const struct bake_attrs *attrs, const char *name);

/* All attributes as one line, in order; cut at size - 1 characters. */
BAKE_API void bake_attrs_format(
    const struct bake_attrs *attrs, char *line, size_t size);

/* Add the `relief:` attributes that a line of text holds; anything else in
 * the line is passed over. */
BAKE_API void bake_attrs_parse(struct bake_attrs *attrs, const char *line);

#ifdef __cplusplus
}
#endif

#endif
