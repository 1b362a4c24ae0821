/* The parts of rm-info: look at files, and print, compare, draw them. */
/* SPDX-License-Identifier: MIT */
#ifndef INFO_H
#define INFO_H

#include "cmd.h"
#include "cmd_image.h"
#include "compare.h"
#include "inspect.h"

struct info_opts {
	const char *channel, *normal, *depth, *sheet;
	bool check, compare, json;
	double tolerance;
	double depth_scale; /* 0: the file's */
};

/* Everything to print about one file or pair; owns its maps. */
struct info_report {
	const char *file; /* as the user named it */
	bool pair;
	struct cmd_map map;           /* the file; of a pair the relief */
	struct cmd_map normal;        /* of a pair */
	struct bake_maps maps;        /* what the texels are, by their layout */
	struct bake_relief_meta said; /* metadata, then options */
	struct bake_inspection found;
	struct bake_contradictions bad;
	struct bake_channel_range *range; /* [map.img.nchans] */
	bool has_layers;                  /* a multilayer depth texture */
	struct bake_layer_check layers;
	const char *part; /* of an EXR file of several, or a deep one; NULL */
	int number;       /* of the part, from 1 */
	bool deep;
	size_t nsamples, nempty, most; /* of a deep part */
};
#define INFO_REPORT_INIT                                                       \
	{                                                                      \
		.file = NULL, .map = CMD_MAP_INIT, .normal = CMD_MAP_INIT,     \
		.maps = BAKE_MAPS_INIT                                         \
	}

void info_report_free(struct info_report *r);

/* Fill the report of the map, or of the pair, that has been read into r. False
 * with the reason printed. */
bool info_look(
    struct cmd *cmd, const struct info_opts *o, struct info_report *r);

/* The name of the layout, of a pair 'pair'; a channel's name, '?' where the
 * file's information had no room for it. */
const char *info_layout(const struct info_report *r);
const char *info_channel(const struct cmd_map *map, int channel);

/* Look at the texels of a multilayer depth texture, whose channels rgba are,
 * and add what contradicts; print what is known of a multilayer texture. */
void info_layers_look(struct info_report *r, const int rgba[4]);
void info_layers_text(const struct info_report *r);

/* Add 'n texels have …' to what contradicts, where n is not 0. */
void info_contradict(struct info_report *r, size_t n, const char *what);

/* Open an EXR file that has several parts or is deep; false for any other file,
 * with nothing said. Then fill the report of a part; false with the reason
 * printed. The report's part belongs to exr. */
struct bake_exr;
bool info_exr_open(struct cmd *cmd, const char *path, struct bake_exr **exr);
bool info_exr_look(struct cmd *cmd, const struct info_opts *o,
    struct bake_exr *exr, int part, struct info_report *r);

/* Print a report on standard output, as lines of text. */
void info_text(const struct info_report *r);

/* Print a report, or how two files differ in codes of code_max (0: values), as
 * one line of JSON. False, the reason printed, where memory runs out. */
bool info_json(struct cmd *cmd, const struct info_report *r);
bool info_json_comparison(struct cmd *cmd, const struct cmd_map map[2],
    const struct bake_comparison *c, int code_max);

/* --compare: false where the two files differ by more than the tolerance, or
 * with the reason printed. */
bool info_compare(
    struct cmd *cmd, const struct info_opts *o, const char *const path[2]);

/* --sheet: a row for each operand, one sheet or, with the reason printed,
 * none. */
bool info_sheet(struct cmd *cmd, const struct info_opts *o);

#endif
