/* Reading and writing maps for the tools: warnings, repair, depfile. */
/* SPDX-License-Identifier: MIT */
#ifndef CMD_IMAGE_H
#define CMD_IMAGE_H

#include "cmd.h"

/* An input map with what its file said of it. */
struct cmd_map {
	const char *path;
	struct bake_image_info info;
	struct bake_relief_meta meta;
	struct bake_image img;
};
#define CMD_MAP_INIT                                                           \
	{                                                                      \
		.path = NULL                                                   \
	}

void cmd_map_free(struct cmd_map *map);

/*
 * Read a file whole: all channels, texels that are no numbers repaired with a
 * warning. On failure the message is printed and false returned, the map then
 * being empty. The path is noted for the depfile.
 */
bool cmd_read(struct cmd *cmd, const char *path, struct cmd_map *map);

/* The same with no repair (NaN stays), to look at what is there. */
bool cmd_read_raw(struct cmd *cmd, const char *path, struct cmd_map *map);

/*
 * The two halves of cmd_read, for what is chosen by what the file says of
 * itself: open (the caller closes the reader, or loads), then read channel[0]
 * … channel[n - 1] into channels 0 … n - 1, the reader being closed. channel
 * NULL: the first n.
 */
bool cmd_open(struct cmd *cmd, const char *path, struct cmd_map *map,
    struct bake_reader **reader);
bool cmd_load(struct cmd *cmd, struct bake_reader *reader, const int *channel,
    int n, struct cmd_map *map);

/* What is looked at to tell what a map is, for a warning's sake: the image, or
 * of a large one as many rows from its middle as have 2^24 texels. A view. */
struct bake_image cmd_look_at(const struct bake_image *img);

/*
 * Read one channel of a relief map or packed texture, and repair it: the one
 * called chan; with NULL, what the file says (rm-formats(5)): A of a packed
 * layout, else a channel called depth, height or Z, else A where R and G look
 * like a normal's, else the first. Values are as stored.
 */
bool cmd_read_channel(
    struct cmd *cmd, const char *path, const char *chan, struct cmd_map *map);

/* Index of a channel by name (R G B A, the file's own name, or a number from
 * 0); -1 where there is none. */
int cmd_channel_index(const struct bake_image_info *info, const char *name);

/* The channel whose name says that it is a relief (depth, height, Z …); -1
 * where none does. */
int cmd_relief_channel(const struct bake_image_info *info);

/* The channels of a packed texture in R G B A order, whatever their names and
 * order in the file; false where there are fewer than four. */
bool cmd_packed_channels(const struct bake_image_info *info, int channel[4]);

/*
 * Apply --depth-range to a stored relief (1 channel; _of: one of several) and
 * tell what its values
 * then are: depth or height, by the option, else the metadata, else depth.
 * Warns about values outside 0 .. 1, and where option and metadata contradict.
 */
enum bake_polarity cmd_relief_range(struct cmd *cmd, struct cmd_map *map);
enum bake_polarity cmd_relief_range_of(
    struct cmd *cmd, struct cmd_map *map, int chan);

/* The same, and height turned into depth. */
void cmd_to_depth(struct cmd *cmd, struct cmd_map *map);

/*
 * What 8-bit steps do to the horizons and normals of a depth image that came
 * from map: smooth them within half a code where asked to, else warn where
 * they matter. False with the reason printed.
 */
bool cmd_smooth_steps(struct cmd *cmd, const struct cmd_map *map,
    struct bake_image *depth, double scale, struct bake_wrap wrap, bool smooth);

/* How the normals of a map that was read are coded: by the option, else the
 * metadata, else its type, else its values; never AUTO. */
enum bake_normal_code cmd_normal_code(
    const struct cmd *cmd, const struct cmd_map *map);

/* The wrap to use: the option's, else the metadata's, else tile. */
struct bake_wrap cmd_wrap(const struct cmd *cmd, const struct cmd_map *map);

/* Where an output goes: -o, or DIR/STEM+suffix.TYPE with -O (TYPE by --format,
 * else the input's extension where it can be written, else png). NULL, with a
 * usage error, where neither was given. Caller frees. */
char *cmd_output_path(
    const struct cmd *cmd, const char *input, const char *suffix);

/* Whether the outputs of all inputs have different names with -O; otherwise a
 * usage error that names two that do not. */
bool cmd_outputs_differ(const struct cmd *cmd, const struct cmd_list *inputs);

/*
 * Write an image to path in the type and the data format that the options and
 * the path ask for; deepest is the deepest data format of the inputs. On
 * failure the message is printed and false returned; warns about values that
 * an integer format clipped. meta and names (of the channels) may be NULL.
 */
bool cmd_write(struct cmd *cmd, const struct bake_image *img, const char *path,
    enum bake_data_format deepest, const struct bake_relief_meta *meta,
    const char *const *names);

/* The same of rows that are made as they are written. */
bool cmd_write_rows(struct cmd *cmd, const struct bake_row_source *rows,
    const char *path, enum bake_data_format deepest,
    const struct bake_relief_meta *meta, const char *const *names);

/* The same with attributes as they are. */
bool cmd_write_attrs(struct cmd *cmd, const struct bake_image *img,
    const char *path, enum bake_data_format deepest,
    const struct bake_attrs *attrs, const char *const *names);

/* The same with all that the options would say given. */
bool cmd_write_as(struct cmd *cmd, const struct bake_image *img,
    const char *path, const struct bake_write_params *p);
bool cmd_write_pixels(struct cmd *cmd, const struct bake_pixels *px,
    const char *path, const struct bake_write_params *p);

#endif
