/* What rm-info says of EXR files of several parts, and of deep ones. */
/* SPDX-License-Identifier: MIT */
#include "info.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd_batch.h"
#include "io_exr.h"
#include "mem.h"

bool
info_exr_open(struct cmd *cmd, const char *path, struct bake_exr **exr)
{
	struct bake_err ignored = BAKE_ERR_INIT;
	enum bake_status rc;

	cmd_silence_libraries(cmd);
	*exr = NULL;
	if (strcmp(path, "-") == 0)
		return false;
	cmd_decode_begin(cmd, 0);
	rc = bake_exr_open(exr, path, &cmd->limits, &ignored);
	cmd_decode_end(cmd);
	/* the other reader may come further, and see only one part */
	if (rc == BAKE_ENOMEM || rc == BAKE_EIO) {
		cmd_error(cmd, "%s", ignored.msg);
		return true;
	}
	if (rc != BAKE_OK) /* whatever is wrong, the other reader says it */
		return false;
	if (bake_exr_nparts(*exr) > 1 || bake_exr_info(*exr, 0)->deep)
		return true;
	bake_exr_close(*exr);
	*exr = NULL;
	return false;
}

/* The part's channels, R G B A before others as in files of one part. */
static int
order_channels(const struct bake_image_info *info,
    const char *names[BAKE_INFO_NAMES], struct bake_image_info *ordered)
{
	static const char *const usual[] = { "R", "G", "B", "A" };
	bool taken[BAKE_INFO_NAMES] = { false };
	int n = 0, nchans = info->nchans;

	if (nchans > BAKE_INFO_NAMES)
		nchans = BAKE_INFO_NAMES; /* those whose names are known */
	for (int i = 0; i < 4 + nchans; i++)
		for (int c = 0; c < nchans; c++)
			if (!taken[c] &&
			    (i < 4 ? strcmp(info->names[c], usual[i]) == 0
				   : c == i - 4)) {
				taken[c] = true;
				names[n++] = info->names[c];
			}
	*ordered = *info;
	ordered->nchans = n;
	for (int c = 0; c < n; c++)
		memcpy(ordered->names[c], names[c], BAKE_INFO_NAME);
	return n;
}

/* The report's map, from a flat part. */
static enum bake_status
read_flat(
    struct bake_exr *exr, int part, struct info_report *r, struct bake_err *err)
{
	struct bake_image_info *info = &r->map.info;
	const char *names[BAKE_INFO_NAMES];
	int n = order_channels(&bake_exr_info(exr, part)->info, names, info);
	struct bake_pixels px = BAKE_PIXELS_INIT;
	enum bake_status rc = bake_exr_read(exr, part, names, n, &px, err);

	if (rc == BAKE_OK)
		rc = bake_image_alloc(
		    &r->map.img, info->width, info->height, n, err);
	for (int y = 0; rc == BAKE_OK && y < info->height; y++)
		bake_pixels_get(
		    &px, 0, y, info->width, bake_image_row(&r->map.img, y));
	bake_pixels_free(&px);
	return rc;
}

/* The channel of the samples' depth; -1 where there is none. */
static int
depth_channel(const struct bake_image_info *info)
{
	int c = cmd_channel_index(info, "depth");

	return c >= 0 ? c : cmd_relief_channel(info);
}

/* How many samples the texels have, and whether they lie behind each other. */
static void
count_samples(struct info_report *r, const struct bake_deep_image *deep)
{
	const size_t ntexels = (size_t)deep->width * (size_t)deep->height;
	const int chan = depth_channel(&r->map.info);
	const float *z =
	    chan < 0 ? NULL : deep->value + (size_t)chan * deep->nsamples;
	size_t odd = 0, unordered = 0;

	r->nsamples = deep->nsamples;
	for (size_t i = 0; i < ntexels; i++) {
		size_t first = deep->start[i], end = deep->start[i + 1];
		bool ordered = true;

		for (size_t k = first + 1; z != NULL && k < end; k++)
			ordered = ordered && z[k] > z[k - 1];
		r->nempty += first == end;
		odd += (end - first) % 2;
		unordered += !ordered;
		if (end - first > r->most)
			r->most = end - first;
	}
	if (r->said.layer.nlayers > 1) {
		info_contradict(r, odd, "texels have an odd number of layers");
		info_contradict(r, unordered,
		    "texels have layers that do not lie behind each other");
	}
}

/* A deep part has no picture: only its channels are counted in the map. */
static enum bake_status
look_deep(
    struct bake_exr *exr, int part, struct info_report *r, struct bake_err *err)
{
	struct bake_deep_image deep = BAKE_DEEP_IMAGE_INIT;
	enum bake_status rc =
	    bake_exr_read_deep(exr, part, NULL, 0, &deep, err);

	r->map.info = bake_exr_info(exr, part)->info;
	r->said = r->map.meta;
	r->found.layout = r->map.meta.layout;
	r->found.detection.depth_scale = NAN;
	r->found.seams = (struct bake_seams){ NAN, NAN, NAN, NAN };
	if (rc == BAKE_OK) {
		r->range =
		    bake_alloc((size_t)deep.nchans, sizeof *r->range, err);
		rc = r->range != NULL ? BAKE_OK : BAKE_ENOMEM;
	}
	for (int c = 0; rc == BAKE_OK && c < deep.nchans; c++) {
		struct bake_image view = { (int)deep.nsamples, 1, 1,
			deep.nsamples, deep.value + (size_t)c * deep.nsamples };

		if (deep.nsamples > INT_MAX)
			view.width = INT_MAX;
		bake_channel_range(&view, 0, &r->range[c]);
		r->found.nbad += r->range[c].nnan + r->range[c].ninf;
	}
	if (rc == BAKE_OK) {
		r->map.img.nchans = deep.nchans;
		bake_contradictions_find(&r->bad, &r->found, &r->said);
		count_samples(r, &deep);
	}
	bake_deep_image_free(&deep);
	return rc;
}

bool
info_exr_look(struct cmd *cmd, const struct info_opts *o, struct bake_exr *exr,
    int part, struct info_report *r)
{
	const struct bake_exr_part_info *p = bake_exr_info(exr, part);
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_status rc;

	r->map.path = r->file;
	r->part = p->name[0] != '\0' ? p->name : NULL;
	r->number = part + 1;
	r->deep = p->deep;
	bake_relief_meta_from_attrs(&r->map.meta, &p->info.attrs);
	cmd_decode_begin(cmd, 1e9);
	if (p->deep)
		rc = look_deep(exr, part, r, &err);
	else
		rc = read_flat(exr, part, r, &err);
	cmd_decode_end(cmd);
	if (rc != BAKE_OK) {
		cmd_error(cmd, "%s", err.msg);
		return false;
	}
	return p->deep || info_look(cmd, o, r);
}
