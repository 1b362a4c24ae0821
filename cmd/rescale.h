/* rm-rescale-ao: where a file keeps its AO, and writing it back. */
/* SPDX-License-Identifier: MIT */
#ifndef RESCALE_H
#define RESCALE_H

#include "cmd_image.h"

/* A file and the channels of it that hold AO: one, or a grey picture's. */
struct rescale_file {
	struct cmd_map map; /* as stored, nothing repaired */
	int first, n;       /* the AO's channels, all alike */
	bool has_normals;   /* or a depth: DepthScale is theirs */
	bool has_order;     /* rgba below is not the file's own order */
	int rgba[4];
	double scale; /* that the AO belongs to; < 0: not said */
};

/*
 * Read a file and find its AO: in the channel that `channel` names, else where
 * its layout has it, else in the one called ao or occlusion, else in the only
 * one, else where the texels say. False with the reason printed, and the way
 * out where it holds none. rescale_close frees it either way.
 */
bool rescale_open(struct cmd *cmd, const char *path, const char *channel,
    struct rescale_file *f);
void rescale_close(struct rescale_file *f);

/* The AO alone, 1 channel, numbers from 0 to 1; warns about what was none.
 * The caller's to free. */
bool rescale_take(
    struct cmd *cmd, const struct rescale_file *f, struct bake_image *ao);

/* Put ao in its place and write the file, all else as it was; the AO then
 * belongs to depth scale `scale` (< 0: not known). */
bool rescale_write(struct cmd *cmd, struct rescale_file *f,
    const struct bake_image *ao, double scale, const char *path);

#endif
