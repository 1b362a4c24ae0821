/* rm-roughen: what was asked for, and a texture on its way. */
/* SPDX-License-Identifier: MIT */
#ifndef ROUGHEN_TOOL_H
#define ROUGHEN_TOOL_H

#include "cmd_image.h"
#include "color.h"
#include "roughen.h"

/* What the values of an angle map are. */
enum roughen_unit { ROUGHEN_QUARTER, ROUGHEN_DEGREES, ROUGHEN_COSINE };

struct roughen_opts {
	bool has_angle, has_light, has_luma, has_model, has_strength, has_at;
	bool has_angles, has_unit, has_azimuth, has_lut_size;
	double angle, at, azimuth;
	const char *angle_map, *normal_map;
	enum roughen_unit unit;
	double light[3], luma[3];
	enum bake_roughen_model model;
	double strength, median; /* median 0: auto */
	bool encoded;
	const char *space; /* NULL: by the data format */
	bool contrast;
	double angles[BAKE_ROUGHEN_ANGLES];
	int nangles;
	const char *lut, *plot, *sheet, *cylinder, *render;
	int lut_width, lut_height;
	const char *fit, *fit_depth;
	double depth_scale; /* < 0: the file's, else 0.1 */
};

extern const struct cmd_option roughen_options[];
extern const struct cmd_mark roughen_marks[];
bool roughen_set(struct cmd *cmd, int key, const char *arg);
/* Whether the options make sense together; otherwise a usage error. */
bool roughen_args_are_clear(
    const struct cmd *cmd, const struct roughen_opts *o);

/* Whether something of the one texture is asked for beside the image. */
bool roughen_reports(const struct roughen_opts *o);

/* A texture in the values that are remapped, and what they say. */
struct roughen_texture {
	struct cmd_map map; /* img: light, or encoded values */
	enum bake_data_format deepest, out_format;
	struct bake_tones *tones; /* of input and output; may be NULL */
	struct bake_image lum;
	struct bake_roughen_stats stats; /* p50 is the median to use */
	struct bake_roughen remap;
};

struct roughen_job {
	struct cmd *cmd;
	const struct roughen_opts *o;
	struct bake_color *color; /* NULL: --encoded */
	double strength;          /* the option's, or fitted */
};

/* Print the reason after the file's name; returns false. */
bool roughen_failed(
    struct cmd *cmd, const char *path, const struct bake_err *err);

/* Read a texture, convert and measure it. False with the reason printed;
 * roughen_close frees it either way. */
bool roughen_open(struct roughen_job *job, const char *path,
    const char *out_path, struct roughen_texture *t);
/* The same of a grey image that was rendered, in light; takes it over. */
bool roughen_take(struct roughen_job *job, const char *name,
    struct bake_image *grey, struct roughen_texture *t);
void roughen_close(struct roughen_texture *t);
/* Make t->remap of the job's strength. */
bool roughen_prepare(const struct roughen_job *job, struct roughen_texture *t);
/* Remap the texture by the light that was asked for, and write it. */
bool roughen_write(
    const struct roughen_job *job, struct roughen_texture *t, const char *path);
/* Write a picture in the space of t's light, at 8 bits unless the type holds
 * more alone. */
bool roughen_write_picture(
    const struct roughen_job *job, struct bake_image *img, const char *path);

/* --fit and --fit-depth: find job->strength, and print how well it fits. */
bool roughen_fit(struct roughen_job *job, struct roughen_texture *t);
/* --fit-depth: the relief at all angles and at --at; without a texture, the
 * latter becomes it. */
bool roughen_fit_depth(struct roughen_job *job, struct roughen_texture *t);
/* --contrast, --plot, --sheet, --cylinder, --lut */
bool roughen_report(struct roughen_job *job, struct roughen_texture *t);
bool roughen_write_lut(
    const struct roughen_job *job, const struct roughen_texture *t);

#endif
