/* rm-render: pictures and buffers to files, and how far they are from others.
 */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"
#include "render_tool.h"

/* The channels of --buffers; sorted by name in the file. */
enum { NBUFFERS = 12 };
static const char *const buffer_names[NBUFFERS] = { "R", "G", "B", "A", "Z",
	"N.x", "N.y", "N.z", "AO", "uv.u", "uv.v", "mask" };

static bool
failed(struct cmd *cmd, const char *path, const struct bake_err *err)
{
	cmd_error(cmd, "%s: %s", path, err->msg);
	return false;
}

/* -- the picture -------------------------------------------------------------
 */

/* Straight colours with alpha where the picture has holes, else r g b. */
static bool
to_display(struct cmd *cmd, const struct render_opts *o,
    const struct bake_color *color, const struct bake_image *in, bool linear,
    struct bake_image *out)
{
	const int n = o->background[3] < 1 ? 4 : 3;
	struct bake_err err = BAKE_ERR_INIT;

	if (bake_image_alloc(out, in->width, in->height, n, &err) != BAKE_OK)
		return failed(cmd, "picture", &err);
	for (int y = 0; y < in->height; y++) {
		const float *a = bake_image_row(in, y);
		float *b = bake_image_row(out, y);

		for (int x = 0; x < in->width; x++, a += 4, b += n)
			for (int c = 0; c < n; c++)
				b[c] = c < 3 && n == 4 && a[3] > 0 ? a[c] / a[3]
								   : a[c];
	}
	return linear ||
	       bake_color_from_linear(
		   color, "sRGB", out, cmd->nthreads, &err) == BAKE_OK ||
	       failed(cmd, "picture", &err);
}

static void
clamp(struct bake_image *img)
{
	for (int y = 0; y < img->height; y++) {
		float *v = bake_image_row(img, y);

		for (int i = 0; i < img->width * img->nchans; i++)
			v[i] = v[i] > 1 ? 1 : v[i] < 0 ? 0 : v[i];
	}
}

static bool
write_picture(struct cmd *cmd, const struct render_opts *o,
    const struct bake_color *color, const struct bake_image *in,
    const char *path)
{
	struct bake_write_params p = { .type = cmd->type,
		.png_level = cmd->png_level };
	struct bake_image out = BAKE_IMAGE_INIT;
	bool ok;

	(void)bake_file_type_from_path(path, &p.type);
	p.data_format = cmd->has_data_format
			    ? cmd->data_format
			    : bake_file_type_nearest(p.type, BAKE_DATA_UINT8);
	ok = to_display(
	    cmd, o, color, in, bake_data_format_max(p.data_format) == 0, &out);
	if (ok && bake_data_format_max(p.data_format) != 0)
		clamp(&out); /* too bright is white: no warning */
	ok = ok && cmd_write_as(cmd, &out, path, &p);
	bake_image_free(&out);
	return ok;
}

/* -- buffers -----------------------------------------------------------------
 */

static bool
write_buffers(
    struct cmd *cmd, const struct bake_render_buffers *b, const char *path)
{
	const struct {
		const struct bake_image *img;
		int nchans;
	} part[] = { { &b->color, 4 }, { &b->distance, 1 }, { &b->normal, 3 },
		{ &b->ao, 1 }, { &b->uv, 2 }, { &b->mask, 1 } };
	struct bake_write_params p = { .type = BAKE_FILE_EXR,
		.data_format = BAKE_DATA_FLOAT,
		.names = buffer_names,
		.png_level = cmd->png_level };
	struct bake_image all = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	int at = 0;
	bool ok = bake_image_alloc(&all, b->color.width, b->color.height,
		      NBUFFERS, &err) == BAKE_OK ||
		  failed(cmd, path, &err);

	for (int i = 0; ok && i < 6; i++)
		for (int c = 0; c < part[i].nchans; c++)
			bake_image_copy_channel(&all, at++, part[i].img, c);
	ok = ok && cmd_write_as(cmd, &all, path, &p);
	bake_image_free(&all);
	return ok;
}

bool
render_write(struct cmd *cmd, const struct render_opts *o,
    const struct bake_color *color, const struct bake_render_buffers *buffers,
    const char *path)
{
	if (path != NULL &&
	    !write_picture(cmd, o, color, &buffers->color, path))
		return false;
	return o->buffers == NULL || write_buffers(cmd, buffers, o->buffers);
}

/* -- comparing ---------------------------------------------------------------
 */

/* What two pictures' pixels have in common. */
struct comparison {
	size_t both, either, pixels;
	double square; /* of encoded colours, over pixels that both hit */
	double depth2, depth_max;
	float *error; /* |depth difference| of each pixel that both hit */
};

static int
by_size(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

/* Channel of that name in a file of buffers; -1 where there is none. */
static int
channel(const struct cmd_map *map, const char *name)
{
	for (int c = 0; c < map->info.nchans && c < BAKE_INFO_NAMES; c++)
		if (strcmp(map->info.names[c], name) == 0)
			return c;
	return -1;
}

static void
add_pixel(struct comparison *c, const float *rgb, const float *ref_rgb, float z,
    float ref_z, float mask, float ref_mask)
{
	const bool hit = mask > 0.5F, ref_hit = ref_mask > 0.5F;
	double d;

	c->pixels++;
	c->either += hit || ref_hit;
	if (!hit || !ref_hit)
		return;
	for (int k = 0; k < 3; k++) {
		d = (double)rgb[k] - (double)ref_rgb[k];
		c->square += d * d;
	}
	d = fabs((double)z - (double)ref_z);
	c->depth2 += d * d;
	c->depth_max = d > c->depth_max ? d : c->depth_max;
	c->error[c->both++] = (float)d;
}

static void
print_comparison(const struct comparison *c)
{
	const double n = c->both > 0 ? (double)c->both : 1;
	const double mse = c->square / (3 * n);

	printf("pixels\t%zu\nhit by both\t%zu\n", c->pixels, c->both);
	printf("mask IoU\t%.6f\n",
	    c->either > 0 ? (double)c->both / (double)c->either : 1.0);
	if (mse > 0)
		printf("colour PSNR\t%.3f dB\n", -10 * log10(mse));
	else
		printf("colour PSNR\tinf dB\n");
	printf("depth RMS\t%.6g\ndepth max\t%.6g\n", sqrt(c->depth2 / n),
	    c->depth_max);
	qsort(c->error, c->both, sizeof *c->error, by_size);
	for (int p = 50; p <= 99 && c->both > 0; p += p < 90 ? 40 : 9)
		printf("depth %d %%\t%.6g\n", p,
		    (double)c->error[(c->both - 1) * (size_t)p / 100]);
}

/* r g b a of a file of buffers, and where its other channels are. */
static bool
take_reference(struct cmd *cmd, const char *path, struct cmd_map *ref,
    struct bake_image *rgba, int at[2])
{
	static const char *const names[] = { "R", "G", "B", "A" };
	struct bake_err err = BAKE_ERR_INIT;

	if (!cmd_read_raw(cmd, path, ref))
		return false;
	at[0] = channel(ref, "Z");
	at[1] = channel(ref, "mask");
	if (bake_image_alloc(rgba, ref->img.width, ref->img.height, 4, &err) !=
	    BAKE_OK)
		return failed(cmd, path, &err);
	for (int c = 0; c < 4; c++) {
		int from = channel(ref, names[c]);

		if (from < 0 || at[0] < 0 || at[1] < 0) {
			cmd_error(cmd,
			    "%s: has not the channels of --buffers (R G B A Z "
			    "mask)",
			    path);
			return false;
		}
		bake_image_copy_channel(rgba, c, &ref->img, from);
	}
	return true;
}

static bool
write_difference(struct cmd *cmd, const struct bake_image *a,
    const struct bake_image *b, const char *path)
{
	struct bake_write_params p = { .type = BAKE_FILE_PNG,
		.png_level = cmd->png_level };
	struct bake_image out = BAKE_IMAGE_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	bool ok;

	(void)bake_file_type_from_path(path, &p.type);
	p.data_format = bake_file_type_nearest(p.type, BAKE_DATA_UINT8);
	ok = bake_image_alloc(&out, a->width, a->height, 3, &err) == BAKE_OK ||
	     failed(cmd, path, &err);
	for (int y = 0; ok && y < a->height; y++)
		for (int x = 0; x < a->width; x++)
			for (int c = 0; c < 3; c++) {
				const int i = a->nchans * x + c;
				const int k = b->nchans * x + c;
				const float d = bake_image_row(a, y)[i] -
						bake_image_row(b, y)[k];
				float v = 0.5F + 0.5F * d;

				v = v < 0 ? 0 : v > 1 ? 1 : v;
				bake_image_row(&out, y)[3 * x + c] = v;
			}
	ok = ok && cmd_write_as(cmd, &out, path, &p);
	bake_image_free(&out);
	return ok;
}

static bool
compare(struct cmd *cmd, const struct render_opts *o,
    const struct bake_color *color, const struct bake_render_buffers *b,
    const struct cmd_map *ref, const struct bake_image *ref_rgba,
    const int at[2])
{
	const size_t n = (size_t)b->color.width * (size_t)b->color.height;
	struct comparison c = { .error = malloc(n * sizeof *c.error) };
	struct bake_image got = BAKE_IMAGE_INIT, want = BAKE_IMAGE_INIT;
	bool ok = c.error != NULL;

	if (!ok)
		cmd_error(cmd, "%s: no memory", o->compare);
	ok = ok && to_display(cmd, o, color, &b->color, false, &got) &&
	     to_display(cmd, o, color, ref_rgba, false, &want);
	for (int y = 0; ok && y < b->color.height; y++)
		for (int x = 0; x < b->color.width; x++) {
			const float *r =
			    bake_image_row(&ref->img, y) + ref->img.nchans * x;

			add_pixel(&c, bake_image_row(&got, y) + got.nchans * x,
			    bake_image_row(&want, y) + want.nchans * x,
			    bake_image_row(&b->distance, y)[x], r[at[0]],
			    bake_image_row(&b->mask, y)[x], r[at[1]]);
		}
	if (ok)
		print_comparison(&c);
	if (ok && o->difference != NULL)
		ok = write_difference(cmd, &got, &want, o->difference);
	free(c.error);
	bake_image_free(&got);
	bake_image_free(&want);
	return ok;
}

bool
render_compare(struct cmd *cmd, const struct render_opts *o,
    const struct bake_color *color, const struct bake_render_buffers *buffers)
{
	struct cmd_map ref = CMD_MAP_INIT;
	struct bake_image rgba = BAKE_IMAGE_INIT;
	int at[2];
	bool ok = take_reference(cmd, o->compare, &ref, &rgba, at);

	if (ok && (rgba.width != buffers->color.width ||
		      rgba.height != buffers->color.height)) {
		cmd_error(cmd, "%s: is %dx%d, the picture is %dx%d", o->compare,
		    rgba.width, rgba.height, buffers->color.width,
		    buffers->color.height);
		ok = false;
	}
	ok = ok && compare(cmd, o, color, buffers, &ref, &rgba, at);
	bake_image_free(&rgba);
	cmd_map_free(&ref);
	return ok;
}
