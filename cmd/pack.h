/* The pipeline of rm-pack: read, convert, derive, write. */
/* SPDX-License-Identifier: MIT */
#ifndef PACK_H
#define PACK_H

#include "ao.h"
#include "cmd.h"
#include "cmd_image.h"
#include "normal.h"

struct pack_opts {
	const struct bake_target *target;
	int width, height;  /* 0: the depth's, else the normal's */
	double depth_scale; /* 0: the files', else the default */
	bool no_ao, no_check, exr_names, renormalize, dequantize;
	enum bake_slope_op slope;
	double damping; /* of the integration; below 0: by the normals */
	struct bake_ao_params ao;
	const char *depth_channel, *ao_channel;
};

/* The maps of one packed texture; a missing one is NULL. */
struct pack_inputs {
	const char *normal, *depth, *ao;
};

/* Pack one set into out and the files beside it that the target has. False
 * with the reason printed. */
bool pack_set(struct cmd *cmd, const struct pack_opts *o,
    const struct pack_inputs *in, const char *out);

/* Take a packed texture apart; an output that is NULL is not written. */
struct unpack_outputs {
	const char *normal, *ao, *depth;
	bool height; /* write depth as height */
};
bool unpack_file(
    struct cmd *cmd, const char *in, const struct unpack_outputs *out);

#endif
