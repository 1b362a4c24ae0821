/* Reading and writing maps for the tools: warnings, repair, depfile. */
/* SPDX-License-Identifier: MIT */
#include "cmd_image.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cmd_batch.h"
#include "cmd_recipe.h"
#include "dequantize.h"
#include "inspect.h"
#include "output.h"
#include "repair.h"

void
cmd_map_free(struct cmd_map *map)
{
	bake_image_free(&map->img);
}

static void
print_failure(struct cmd *cmd, const struct bake_err *err)
{
	const char *way_out = "";

	if (err->code == BAKE_ELIMIT)
		way_out = "; --max-pixels N allows it";
	cmd_error(cmd, "%s%s", err->msg, way_out);
}

/* What is in the file but is not used. */
static void
warn_unused(
    struct cmd *cmd, const char *path, const struct bake_image_info *info)
{
	if (info->nsubimages > 1)
		cmd_warn(
		    cmd, "%s: has several images; the first is read", path);
	if (info->orientation > 1)
		cmd_warn(cmd,
		    "%s: its orientation tag (%d) is ignored: rows are read "
		    "as stored",
		    path, info->orientation);
	if (info->windowed)
		cmd_warn(cmd,
		    "%s: its data window is not its display window; the "
		    "%dx%d texels of the data window are read",
		    path, info->width, info->height);
}

bool
cmd_open(struct cmd *cmd, const char *path, struct cmd_map *map,
    struct bake_reader **reader)
{
	struct bake_err err = BAKE_ERR_INIT;

	enum bake_status rc;

	cmd_silence_libraries(cmd);
	memset(map, 0, sizeof *map);
	map->path = strcmp(path, "-") == 0 ? "standard input" : path;
	cmd_decode_begin(cmd, 0);
	rc = bake_reader_open(reader, path, &cmd->limits, &map->info, &err);
	cmd_decode_end(cmd);
	if (rc != BAKE_OK) {
		print_failure(cmd, &err);
		return false;
	}
	if (!cmd_claim(cmd, map->path,
		cmd->tool->texel_bytes * map->info.width * map->info.height)) {
		bake_reader_close(*reader);
		return false;
	}
	if (strcmp(path, "-") != 0)
		cmd_list_add(&cmd->read, path);
	else
		cmd_recipe_stdin(cmd, &map->info.stdin_digest);
	bake_relief_meta_from_attrs(&map->meta, &map->info.attrs);
	warn_unused(cmd, map->path, &map->info);
	return true;
}

/* Any n channels in any order; the reader is closed. */
static bool
read_channels(struct cmd *cmd, struct bake_reader *reader, const int *channel,
    int n, struct cmd_map *map)
{
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_status rc;

	cmd_decode_begin(
	    cmd, 4. * map->info.width * map->info.height * map->info.nchans);
	rc = channel == NULL ? bake_reader_read(reader, 0, n, &map->img, &err)
			     : bake_reader_read_channels(
				   reader, channel, n, &map->img, &err);
	cmd_decode_end(cmd);
	if (rc != BAKE_OK)
		print_failure(cmd, &err);
	bake_reader_close(reader);
	return rc == BAKE_OK;
}

static bool
repair(struct cmd *cmd, struct cmd_map *map)
{
	struct bake_err err = BAKE_ERR_INIT;
	size_t n = 0;

	/* integer codes are numbers */
	if (bake_data_format_max(map->info.data_format) != 0)
		return true;
	if (bake_repair_nonfinite(
		&map->img, cmd->wrap, cmd->nthreads, &n, &err) != BAKE_OK) {
		cmd_error(cmd, "%s: %s", map->path, err.msg);
		cmd_map_free(map);
		return false;
	}
	if (n > 0)
		cmd_warn(cmd,
		    "%s: %zu texels are not numbers (or beyond 1e30); filled "
		    "from their neighbours",
		    map->path, n);
	return true;
}

bool
cmd_read_raw(struct cmd *cmd, const char *path, struct cmd_map *map)
{
	struct bake_reader *reader;

	return cmd_open(cmd, path, map, &reader) &&
	       read_channels(cmd, reader, NULL, map->info.nchans, map);
}

bool
cmd_read(struct cmd *cmd, const char *path, struct cmd_map *map)
{
	return cmd_read_raw(cmd, path, map) && repair(cmd, map);
}

bool
cmd_load(struct cmd *cmd, struct bake_reader *reader, const int *channel, int n,
    struct cmd_map *map)
{
	return read_channels(cmd, reader, channel, n, map) && repair(cmd, map);
}

struct bake_image
cmd_look_at(const struct bake_image *img)
{
	const size_t most = (size_t)1 << 24;
	struct bake_image part = *img;
	int rows = (int)(most / (size_t)img->width);

	rows = rows < 1 ? 1 : rows;
	if (rows >= img->height)
		return part;
	part.height = rows;
	part.data = bake_image_row(img, (img->height - rows) / 2);
	return part;
}

int
cmd_channel_index(const struct bake_image_info *info, const char *name)
{
	static const char usual[] = "RGBA";
	const char *letter = strchr(usual, *name);
	char *end;
	long i;

	for (int c = 0; c < info->nchans && c < BAKE_INFO_NAMES; c++)
		if (strcasecmp(info->names[c], name) == 0)
			return c;
	if (*name != '\0' && name[1] == '\0' && letter != NULL &&
	    letter - usual < info->nchans)
		return (int)(letter - usual);
	i = strtol(name, &end, 10);
	return end != name && *end == '\0' && i >= 0 && i < info->nchans
		   ? (int)i
		   : -1;
}

bool
cmd_packed_channels(const struct bake_image_info *info, int channel[4])
{
	static const char *const own[] = { "normal.x", "normal.y", "ao",
		"depth" };
	static const char *const usual[] = { "R", "G", "B", "A" };

	if (info->nchans < 4)
		return false;
	for (int c = 0; c < 4; c++) {
		channel[c] = cmd_channel_index(info, own[c]);
		if (channel[c] < 0)
			channel[c] = cmd_channel_index(info, usual[c]);
	}
	return channel[0] >= 0 && channel[1] >= 0 && channel[2] >= 0 &&
	       channel[3] >= 0;
}

int
cmd_relief_channel(const struct bake_image_info *info)
{
	static const char *const names[] = { "depth", "height", "depth.Z",
		"displacement", "Z" };

	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		for (int c = 0; c < info->nchans && c < BAKE_INFO_NAMES; c++)
			if (strcasecmp(info->names[c], names[i]) == 0)
				return c;
	return -1;
}

/* The relief's channel where the texels need not be asked; -1 where they do.
 */
static int
relief_by_info(
    const struct bake_image_info *info, const struct bake_relief_meta *meta)
{
	/* a picture this large is not read whole for a warning's sake */
	const long large = 1L << 26;
	int packed[4], named = cmd_relief_channel(info);

	if (named >= 0)
		return named;
	if ((meta->layout == BAKE_LAYOUT_RELIEF ||
		meta->layout == BAKE_LAYOUT_NORMAL_RELIEF) &&
	    cmd_packed_channels(info, packed))
		return packed[3];
	if (meta->layout != BAKE_LAYOUT_UNKNOWN || info->nchans < 3 ||
	    info->nchans > 4 || (long)info->width * info->height > large)
		return 0;
	return -1;
}

/* Keep one channel of a map that was read whole. */
static bool
keep_channel(struct cmd *cmd, struct cmd_map *map, int chan)
{
	struct bake_image one = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_image_alloc(&one, map->img.width, map->img.height, 1, &err) !=
	    BAKE_OK) {
		cmd_error(cmd, "%s: %s", map->path, err.msg);
		cmd_map_free(map);
		return false;
	}
	bake_image_copy_channel(&one, 0, &map->img, chan);
	bake_image_swap(&one, &map->img);
	bake_image_free(&one);
	return true;
}

/* What the texels say of three or four channels that nothing else tells of. */
static enum bake_layout
guess_layout(struct cmd *cmd, const struct cmd_map *map)
{
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_layout layout = BAKE_LAYOUT_UNKNOWN;
	int rgba[4] = { 0, 1, 2, 3 };

	cmd_packed_channels(&map->info, rgba);
	if (bake_layout_guess(&map->img, rgba, BAKE_NORMAL_CODE_UNSIGNED,
		&layout, &err) != BAKE_OK)
		cmd_warn(cmd, "%s: %s", map->path, err.msg);
	return layout;
}

static bool
read_unknown(struct cmd *cmd, struct bake_reader *reader, struct cmd_map *map)
{
	enum bake_layout layout;
	int rgba[4] = { 0, 1, 2, 3 };
	bool packed;

	if (!read_channels(cmd, reader, NULL, map->info.nchans, map))
		return false;
	layout = guess_layout(cmd, map);
	packed =
	    layout == BAKE_LAYOUT_RELIEF || layout == BAKE_LAYOUT_NORMAL_RELIEF;
	if (packed)
		cmd_warn(cmd,
		    "%s: read as a packed texture, with the relief in A; "
		    "--channel R reads R",
		    map->path);
	else if (layout != BAKE_LAYOUT_DEPTH)
		cmd_warn(cmd,
		    "%s: its channels differ, as those of a colour or a normal "
		    "map do; R is read as the relief",
		    map->path);
	cmd_packed_channels(&map->info, rgba);
	return keep_channel(cmd, map, rgba[packed ? 3 : 0]);
}

bool
cmd_read_channel(
    struct cmd *cmd, const char *path, const char *chan, struct cmd_map *map)
{
	struct bake_reader *reader;
	int c;

	if (!cmd_open(cmd, path, map, &reader))
		return false;
	c = chan != NULL ? cmd_channel_index(&map->info, chan)
			 : relief_by_info(&map->info, &map->meta);
	if (c >= 0)
		return cmd_load(cmd, reader, &c, 1, map);
	if (chan == NULL)
		return read_unknown(cmd, reader, map) && repair(cmd, map);
	cmd_error(cmd, "%s: has no channel %s (it has %d)", map->path, chan,
	    map->info.nchans);
	bake_reader_close(reader);
	return false;
}

/* v := (v - near) / (far - near) for all texels of one channel. */
static void
apply_range(struct bake_image *img, int chan, double near, double far)
{
	const size_t nc = (size_t)img->nchans;

	for (int y = 0; y < img->height; y++) {
		float *v = bake_image_row(img, y) + chan;

		for (int x = 0; x < img->width; x++, v += nc)
			*v = (float)((*v - near) / (far - near));
	}
}

static void
value_range(const struct bake_image *img, int chan, double *lo, double *hi)
{
	const size_t nc = (size_t)img->nchans;

	*lo = *hi = img->data[chan];
	for (int y = 0; y < img->height; y++) {
		const float *v = bake_image_row(img, y) + chan;

		for (int x = 0; x < img->width; x++, v += nc) {
			*lo = *v < *lo ? *v : *lo;
			*hi = *v > *hi ? *v : *hi;
		}
	}
}

enum bake_polarity
cmd_relief_range_of(struct cmd *cmd, struct cmd_map *map, int chan)
{
	enum bake_polarity said = map->meta.polarity;
	bool height = cmd->has_polarity ? cmd->polarity == BAKE_POLARITY_HEIGHT
					: said == BAKE_POLARITY_HEIGHT;
	double lo, hi;

	if (cmd->has_polarity && said == BAKE_POLARITY_DEPTH)
		cmd_warn(cmd, "%s: its metadata say depth, --height is taken",
		    map->path);
	value_range(&map->img, chan, &lo, &hi);
	if (cmd->has_depth_range) {
		apply_range(&map->img, chan, cmd->depth_near, cmd->depth_far);
		value_range(&map->img, chan, &lo, &hi);
		height = false;
	} else if (cmd->normalize && hi > lo) {
		apply_range(&map->img, chan, lo, hi);
		lo = 0;
		hi = 1;
	}
	if (lo < -1e-6 || hi > 1 + 1e-6)
		cmd_warn(cmd,
		    "%s: values run from %.6g to %.6g, expected 0 to 1; "
		    "--depth-range NEAR,FAR or auto maps them",
		    map->path, lo, hi);
	return height ? BAKE_POLARITY_HEIGHT : BAKE_POLARITY_DEPTH;
}

enum bake_polarity
cmd_relief_range(struct cmd *cmd, struct cmd_map *map)
{
	return cmd_relief_range_of(cmd, map, 0);
}

void
cmd_to_depth(struct cmd *cmd, struct cmd_map *map)
{
	if (cmd_relief_range(cmd, map) == BAKE_POLARITY_HEIGHT)
		bake_relief_flip(&map->img, 0);
}

bool
cmd_smooth_steps(struct cmd *cmd, const struct cmd_map *map,
    struct bake_image *depth, double scale, struct bake_wrap wrap, bool smooth)
{
	struct bake_err err = BAKE_ERR_INIT;
	int bits =
	    map->info.bits > 0 && map->info.bits < 8 ? map->info.bits : 8;
	int max = (1 << bits) - 1;
	double step, share;

	if (map->info.data_format != BAKE_DATA_UINT8)
		return true;
	if (smooth) {
		if (bake_dequantize(depth, max, wrap, cmd->nthreads, &err) ==
		    BAKE_OK)
			return true;
		cmd_error(cmd, "%s: %s", map->path, err.msg);
		return false;
	}
	bake_quantization_matters(depth, max, scale, &step, &share);
	if (step * share > 0.02)
		cmd_warn(cmd,
		    "%s: %d-bit depth makes steps of %.2g texels at %.0f %% "
		    "of the texels, which tilt horizons and normals; use a "
		    "16-bit map or --dequantize",
		    map->path, bits, step, 100 * share);
	return true;
}

enum bake_normal_code
cmd_normal_code(const struct cmd *cmd, const struct cmd_map *map)
{
	if (cmd->normal_code != BAKE_NORMAL_CODE_AUTO)
		return cmd->normal_code;
	if (map->meta.normal_code != BAKE_NORMAL_CODE_AUTO)
		return map->meta.normal_code;
	if (bake_data_format_max(map->info.data_format) != 0 ||
	    map->img.nchans < 2)
		return BAKE_NORMAL_CODE_UNSIGNED;
	return bake_normal_code_of(&map->img);
}

struct bake_wrap
cmd_wrap(const struct cmd *cmd, const struct cmd_map *map)
{
	return cmd->has_wrap || map == NULL || !map->meta.has_wrap
		   ? cmd->wrap
		   : map->meta.wrap;
}

char *
cmd_output_path(const struct cmd *cmd, const char *input, const char *suffix)
{
	enum bake_file_type type = cmd->type;
	char ext[16];

	if (cmd->output != NULL)
		return cmd_path_derive(cmd->output, NULL, suffix, NULL);
	if (cmd->output_dir == NULL) {
		cmd_usage_error(cmd, "no output: give -o FILE or -O DIR");
		return NULL;
	}
	if (!cmd->has_type && !bake_file_type_from_path(input, &type))
		type = BAKE_FILE_PNG;
	snprintf(ext, sizeof ext, ".%s", bake_file_type_name(type));
	return cmd_path_derive(input, cmd->output_dir, suffix, ext);
}

static char *
plain_output_path(const struct cmd *cmd, const char *input, const void *arg)
{
	(void)arg;
	return cmd_output_path(cmd, input, "");
}

bool
cmd_outputs_differ(const struct cmd *cmd, const struct cmd_list *inputs)
{
	return cmd_paths_differ(cmd, inputs, plain_output_path, NULL);
}

static bool
write_params(struct cmd *cmd, const char *path, enum bake_data_format deepest,
    struct bake_write_params *p)
{
	p->type = cmd->type;
	p->png_level = cmd->png_level;
	if (!bake_file_type_from_path(path, &p->type) && !cmd->has_type) {
		cmd_error(cmd, CMD_NO_TYPE, path);
		return false;
	}
	if (p->type == BAKE_FILE_TIFF || p->type == BAKE_FILE_EXR)
		p->tile = cmd->tile;
	p->data_format = cmd->has_data_format
			     ? cmd->data_format
			     : bake_file_type_nearest(p->type, deepest);
	return true;
}

/* What is to be written: one of the three. */
struct picture {
	const struct bake_image *img;
	const struct bake_pixels *px;
	const struct bake_row_source *rows;
};

static enum bake_status
write_picture(const struct picture *pic, const struct bake_write_params *p,
    FILE *stream, const char *path, size_t *nclipped, struct bake_err *err)
{
	if (pic->img != NULL)
		return bake_image_write(
		    pic->img, p, stream, path, nclipped, err);
	if (pic->px != NULL)
		return bake_pixels_write(
		    pic->px, p, stream, path, nclipped, err);
	return bake_rows_write(pic->rows, p, stream, path, nclipped, err);
}

/* A picture to a file that appears whole. */
static bool
write_whole(struct cmd *cmd, const struct picture *pic, const char *path,
    const struct bake_write_params *p)
{
	struct bake_output out = BAKE_OUTPUT_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_write_params with = *p;
	struct cmd_record record;
	size_t nclipped = 0;
	enum bake_status rc = bake_output_open(&out, path, &err);

	cmd_recipe_attrs(cmd, path, &with.attrs, &record);
	if (rc == BAKE_OK)
		rc = write_picture(
		    pic, &with, out.stream, path, &nclipped, &err);
	if (rc == BAKE_OK)
		rc = cmd_recipe_seal(&record, out.stream, &err);
	if (rc != BAKE_OK || bake_output_commit(&out, &err) != BAKE_OK) {
		bake_output_abort(&out);
		cmd_error(cmd, "%s", err.msg);
		return false;
	}
	if (nclipped > 0)
		cmd_warn(cmd,
		    "%s: %zu values outside 0 to 1 were clipped; -d float "
		    "keeps them",
		    path, nclipped);
	cmd_flush_warnings(cmd);
	cmd_list_add(&cmd->written, path);
	return true;
}

bool
cmd_write_as(struct cmd *cmd, const struct bake_image *img, const char *path,
    const struct bake_write_params *p)
{
	const struct picture pic = { .img = img };

	return write_whole(cmd, &pic, path, p);
}

bool
cmd_write_pixels(struct cmd *cmd, const struct bake_pixels *px,
    const char *path, const struct bake_write_params *p)
{
	const struct picture pic = { .px = px };

	return write_whole(cmd, &pic, path, p);
}

bool
cmd_write_attrs(struct cmd *cmd, const struct bake_image *img, const char *path,
    enum bake_data_format deepest, const struct bake_attrs *attrs,
    const char *const *names)
{
	struct bake_write_params p = { .names = names, .attrs = *attrs };

	return write_params(cmd, path, deepest, &p) &&
	       cmd_write_as(cmd, img, path, &p);
}

bool
cmd_write(struct cmd *cmd, const struct bake_image *img, const char *path,
    enum bake_data_format deepest, const struct bake_relief_meta *meta,
    const char *const *names)
{
	struct bake_write_params p = { .names = NULL };

	if (meta != NULL)
		bake_relief_meta_to_attrs(meta, &p.attrs);
	return cmd_write_attrs(cmd, img, path, deepest, &p.attrs, names);
}

bool
cmd_write_rows(struct cmd *cmd, const struct bake_row_source *rows,
    const char *path, enum bake_data_format deepest,
    const struct bake_relief_meta *meta, const char *const *names)
{
	const struct picture pic = { .rows = rows };
	struct bake_write_params p = { .names = names };

	bake_relief_meta_to_attrs(meta, &p.attrs);
	return write_params(cmd, path, deepest, &p) &&
	       write_whole(cmd, &pic, path, &p);
}
