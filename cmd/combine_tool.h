/* The parts of rm-combine: its layers as asked for, read, blended, coloured. */
/* SPDX-License-Identifier: MIT */
#ifndef COMBINE_TOOL_H
#define COMBINE_TOOL_H

#include "cmd.h"
#include "cmd_image.h"
#include "color.h"
#include "combine.h"

/* One layer as the command line has it: a packed texture, or plain maps. */
struct combine_layer {
	const char *packed;
	const char *normal, *depth, *ao;
	bool no_ao; /* --ao none */
	double weight, normal_weight, depth_weight, color_weight; /* < 0: not
								   * given */
	struct bake_placement place; /* as given: in repeats of the base */
	double depth_scale;          /* 0: the file's, else the default */
	enum bake_polarity polarity; /* UNSURE, AUTO: as the other options or
				      * the file say */
	enum bake_normal_y normal_y;
	enum bake_normal_code normal_code;
	const char *color;
};
#define COMBINE_LAYER_INIT                                                     \
	{                                                                      \
		.weight = -1, .normal_weight = -1, .depth_weight = -1,         \
		.color_weight = -1, .place = {                                 \
			1,                                                     \
			1,                                                     \
			0,                                                     \
			0                                                      \
		}                                                              \
	}

struct combine_opts {
	struct combine_layer *layer;
	int n;
	struct combine_layer next; /* being put together */
	bool has_maps;             /* it has plain maps already */
	const char *pending;       /* the layer option given last, or NULL */
	const struct bake_target *target;
	bool list_targets, ao_rescale, dequantize, exr_names, no_check;
	double depth_scale; /* 0: the base's */
	int width, height;  /* 0: the first layer's */
	int repeat;
	enum bake_normal_blend normal_blend;
	enum bake_ao_blend ao_blend;
	enum bake_ao_quality quality;
	enum bake_filter filter;
	enum bake_slope_op slope;
	int color_layer; /* from 1; 0: blend */
	int color_width, color_height;
	const char *color_out, *color_space;
};

/* The options; set_option of the tool, operands included. */
extern const struct cmd_option combine_options[];
extern const struct cmd_mark combine_marks[];
bool combine_set(struct cmd *cmd, int key, const char *arg);
/* The layer that is being put together is whole; the next one begins. */
void combine_end_layer(struct combine_opts *o);
/* The last layer is whole, and what was asked for makes sense: a usage error
 * otherwise. */
bool combine_args_are_clear(struct cmd *cmd, struct combine_opts *o);

/* The weights that hold: the layer's own, else -w's, else 1. */
double combine_normal_weight(const struct combine_layer *l);
double combine_depth_weight(const struct combine_layer *l);
double combine_color_weight(const struct combine_layer *l);
/* Whether neither its normals nor its depth are in the blend. */
bool combine_is_removed(const struct combine_layer *l);
/* What messages call it: its first file. */
const char *combine_name(const struct combine_layer *l);

/* A layer that was read. maps: normal x, y as unsigned codes with y up, AO,
 * depth; the caller frees it. */
struct combine_read {
	struct bake_image maps;
	enum bake_data_format deepest;
	double depth_scale;
	double ao_scale; /* of the AO that was given; 0: depth_scale */
	struct bake_wrap wrap;
};

/* Read one layer, with the AO baked that it lacks. False with the reason
 * printed. */
bool combine_read_layer(struct cmd *cmd, const struct combine_opts *o,
    const struct combine_layer *l, struct combine_read *r);

/* Blend the layers' colour maps at the size of the relief, or --color-size's;
 * *deepest is the data format of the deepest. False with the reason printed. */
bool combine_colors(struct cmd *cmd, const struct combine_opts *o,
    const struct bake_color *color, const struct bake_combine_params *params,
    struct bake_image *out, enum bake_data_format *deepest);

#endif
