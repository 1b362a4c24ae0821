/* 2 1/2 D texture mapping: luminance remapped with the angle of the light. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_ROUGHEN_H
#define BAKE_ROUGHEN_H

#include "color.h"
#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A texture lit at the angle of incidence theta (0: along the normal) is
 *     t' = t g,   g = g(t, theta)
 * t the luminance of a texel; its r, g and b are all multiplied by g, so that
 * its chromaticity stays. With m the texture's median, p5 and p95 its 5 % and
 * 95 % points, s the strength, (x)+ = max(0, x):
 *
 *   FLAT       g = (cos theta)+
 *   PAPER      g = (cos(theta - s sign(t - m) arccos d))+,
 *              d = (t - m) / m clamped to -1 .. 1; sign(0) = 0
 *   FACET      g = (cos(theta - D d))+,   D = s pi / 2,
 *              d = (t - m) / (t > m ? p95 - m : m - p5) clamped to -1 .. 1
 *   BLACKSHOT  g = 0 where t cos theta < m sin D sin theta, D as above, else
 *              (cos theta)+: texels that are darker than what a facet turned
 *              away by D loses are in shadow
 *
 * g is never above 1 and, light being never negative, never below 0: the paper
 * clamps too. Beyond 90 degrees facets turned to the light are still lit. Any
 * finite t gives a number, also t <= 0 and t > 2m.
 *
 * Source: Pont, Sen, Hanrahan, '2 1/2 D texture mapping', APGV 2007, section
 * 2; FACET: own reading of its micro-facet model, METHODS 5; BLACKSHOT: own
 * choice of the threshold that the paper leaves open.
 */
enum bake_roughen_model {
	BAKE_ROUGHEN_PAPER,
	BAKE_ROUGHEN_FACET,
	BAKE_ROUGHEN_BLACKSHOT,
	BAKE_ROUGHEN_FLAT
};
enum { BAKE_ROUGHEN_MODELS = 4 };

/* "paper", "facet", "blackshot", "flat". Static text. */
BAKE_API const char *bake_roughen_name(enum bake_roughen_model model);

/*
 * The 5 %, 50 % and 95 % points of a distribution of n values, interpolated
 * linearly between the sorted values at rank q (n - 1): the median is the mean
 * of the two middle ones.
 */
struct bake_roughen_stats {
	double p05, p50, p95;
};

/* (p95 - p05) / (2 p50), the texture contrast; infinite where p50 is 0. */
BAKE_API double bake_roughen_contrast(const struct bake_roughen_stats *stats);

/* A remap; plain data. low and high are the denominators of d. */
struct bake_roughen {
	enum bake_roughen_model model;
	double strength; /* s, 0 .. 1 */
	double median;   /* m */
	double low, high;
};

/*
 * The remap of a texture. low = m - p5 and high = p95 - m, at least m / 2^20,
 * for FACET; m both for the others.
 *
 *   stats   of the texture's luminance; p50 may be a value of the caller's
 *
 * BAKE_EINVAL  strength outside 0 .. 1, or an unknown model
 * BAKE_EDATA   p50 is not above 0 (a black texture), and the model is not FLAT
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_roughen_init(struct bake_roughen *r,
    enum bake_roughen_model model, double strength,
    const struct bake_roughen_stats *stats, struct bake_err *err);

/*
 * g(t, theta) of the formulas above. (cos_theta, sin_theta) is a unit vector,
 * sin_theta >= 0. Within 1e-14 of the formula, and the same bits on every
 * machine: + - * / and sqrt alone. Reentrant.
 */
BAKE_API double bake_roughen_gain(
    const struct bake_roughen *r, double t, double cos_theta, double sin_theta);

/* cos and sin of an angle in degrees, 0 .. 180, exact at 0, 90 and 180, within
 * 2e-16 elsewhere and the same bits on every machine. */
BAKE_API void bake_roughen_angle(double angle_deg, double *c, double *s);

/*
 * Luminance: the grey value of an image of 1 or 2 channels, else
 * weight[0] r + weight[1] g + weight[2] b in double, rounded to float; grey
 * texels (r = g = b) give that grey where the weights sum to 1.
 *
 *   img  1 or more channels
 *   lum  out: 1 channel; BAKE_IMAGE_INIT before, the caller's
 *
 * BAKE_ENOMEM  no memory; lum stays BAKE_IMAGE_INIT
 * Same bytes for every thread count.
 */
BAKE_API enum bake_status bake_roughen_luminance(const struct bake_image *img,
    const double weight[3], int nthreads, struct bake_image *lum,
    struct bake_err *err);

/*
 * The percentiles of all texels of a 1-channel image, exact: by counting, in
 * two passes. No NaN.
 *
 * BAKE_ENOMEM  512 KiB a thread and some; stats is then unspecified
 * Same result for every thread count.
 */
BAKE_API enum bake_status bake_roughen_measure(const struct bake_image *lum,
    int nthreads, struct bake_roughen_stats *stats, struct bake_err *err);

/* The light on a texture: one angle, or cos theta at each texel. */
struct bake_roughen_light {
	double cos_theta, sin_theta;      /* where cos_map is NULL */
	const struct bake_image *cos_map; /* 1 channel, clamped to -1 .. 1 */
};

/*
 * Remap an image in place: its first three channels, or one where it has fewer
 * than three, times g; alpha and any other channel keep their bits.
 *
 *   lum    its luminance, as bake_roughen_luminance gives it; the image may
 *          be lum itself
 *   light  cos_map of the image's size
 *
 * BAKE_EINVAL  sizes that differ
 * Same bytes for every thread count and machine.
 */
BAKE_API enum bake_status bake_roughen_apply(const struct bake_roughen *r,
    const struct bake_roughen_light *light, const struct bake_image *lum,
    struct bake_image *img, int nthreads, struct bake_err *err);

/* The percentiles of t' at one angle; errors as bake_roughen_measure, and
 * scratch of one float a texel. */
BAKE_API enum bake_status bake_roughen_lit_stats(const struct bake_roughen *r,
    double angle_deg, const struct bake_image *lum, int nthreads,
    struct bake_roughen_stats *stats, struct bake_err *err);

/* -- cos theta at each texel ---------------------------------------------- */

/*
 * In place: cos theta = n . l / (|n| |l|) into channel 0 of a map of signed
 * normals, x, y, z in 3 channels; a normal without length is (0, 0, 1).
 * light, not zero, points from the surface to the light, in the normals' axes.
 */
BAKE_API void bake_roughen_cos_from_normals(
    struct bake_image *normal, const double light[3], int nthreads);

/* In place: angles in degrees in channel 0, clamped to 0 .. 180, to cosines. */
BAKE_API void bake_roughen_cos_from_angles(
    struct bake_image *angle, int nthreads);

/* -- the remap as a table -------------------------------------------------- */

/*
 * g as a texture of width columns over d and height rows over theta, of
 * (g + 1) / 2 without (.)+, so that a linear filter does not round off the
 * edge of the light. With M = floor(width / 2) - 1 and texels counted from 0 at
 * their centres, a texel (t, theta) is found at
 *     column = M + sign(d) (1 + (M - 1) (1 - sqrt(1 - |d|)))
 *     row    = (height - 1) sqrt((1 - cos theta) / 2)
 *     g      = max(0, 2 tex - 1)
 * Column M holds d = 0 alone, since PAPER jumps there; the square roots give
 * arccos and the sine room where they are steep. Row 0 is theta = 0, the last
 * theta = 180 degrees. Columns beyond 2 M repeat it. BLACKSHOT has a jump that
 * moves with theta, and no table.
 *
 *   lut  out: 1 channel, 0 .. 1; BAKE_IMAGE_INIT before, the caller's
 *
 * BAKE_EINVAL  BLACKSHOT, or a side outside 8 .. 4096
 * BAKE_ENOMEM  no memory
 *
 * A linear filter on 64 x 64 entries errs by less than 6e-4 in g at s = 0.09
 * (PAPER and FACET), and by less than 1/255 up to s = 0.5.
 * Source: own derivation.
 */
enum { BAKE_ROUGHEN_LUT_MIN = 8, BAKE_ROUGHEN_LUT_MAX = 4096 };
BAKE_API enum bake_status bake_roughen_lut(const struct bake_roughen *r,
    int width, int height, struct bake_image *lut, struct bake_err *err);

/* g by a table, filtered linearly as a renderer does; in double. */
BAKE_API double bake_roughen_lut_gain(const struct bake_roughen *r,
    const struct bake_image *lut, double t, double cos_theta);

/* The largest |t'| error of a table, for t up to the given luminance, over
 * 512 x 512 points that include d = 0. */
BAKE_API double bake_roughen_lut_error(
    const struct bake_roughen *r, const struct bake_image *lut, double t_max);

/* -- fitting ----------------------------------------------------------------
 */

enum { BAKE_ROUGHEN_ANGLES = 64 };

/* What a fit brings together: contrasts at angles. */
struct bake_roughen_target {
	int n; /* 1 .. 64 */
	double angle_deg[BAKE_ROUGHEN_ANGLES];
	/* not finite: left out */
	double contrast[BAKE_ROUGHEN_ANGLES];
};

/*
 * The strength at which a model's contrast comes nearest to the target's:
 * smallest mean of |c - c_target| / c_target. Searched in 0 .. 1 on a grid of
 * 1/64 and then by golden section, on 2048 evenly spaced quantiles of the
 * luminance.
 *
 *   r         its model, median, low and high count; strength is set
 *   lum       the texture's luminance
 *   error     out: that mean, of the quantiles
 *   contrast  out: [target->n] of all texels at the strength found; may be
 *             NULL
 *
 * BAKE_EDATA   no contrast of the target is finite and above 0
 * BAKE_ENOMEM  no memory
 * Same result for every thread count.
 */
BAKE_API enum bake_status bake_roughen_fit(struct bake_roughen *r,
    const struct bake_image *lum, const struct bake_roughen_target *target,
    int nthreads, double *error, double *contrast, struct bake_err *err);

/*
 * A matte height field as it is lit at angle_deg from the direction azimuth:
 *     L = (n . l)+ where no horizon hides the light, else 0
 * n as bake_normal_from_depth has it (central differences), l = (sin theta
 * cos azimuth, sin theta sin azimuth, cos theta), y up. The light is hidden
 * where the tangent of the horizon towards it (ao.h, exact, one period) is
 * above cot theta. Albedo 1, no light from elsewhere.
 *
 *   depth    1 channel, 0 = surface, 1 = deepest
 *   scale    depth range / texture width, 0 .. 1e6
 *   angles   [n] degrees, 0 .. 90
 *   lit      out: [n] 1-channel images, BAKE_IMAGE_INIT before
 *
 * BAKE_EINVAL  a parameter out of its range
 * BAKE_ENOMEM  no memory; on failure all of lit are BAKE_IMAGE_INIT
 * Same bytes for every thread count and instruction set.
 */
struct bake_roughen_scene {
	double scale;
	double azimuth_deg; /* 0 from the right, 90 from the top; whole 1/100 */
	struct bake_wrap wrap;
	int nthreads;
};
BAKE_API enum bake_status bake_roughen_render(const struct bake_image *depth,
    const struct bake_roughen_scene *scene, const double *angles, int n,
    struct bake_image *lit, struct bake_err *err);

/* -- colour spaces by tables ------------------------------------------------
 */

/*
 * The conversions of color.h for images of integer codes, by tables: the same
 * results where the space's curves work on each channel alone, at a quarter of
 * the time. Colour spaces that mix channels have none.
 */
struct bake_tones;

/*
 * Make the tables of a space: code_max is 255 or 65535, of the image that is
 * decoded and of the codes that it is encoded to.
 *
 *   tones  out: NULL where the space mixes channels or is no rising curve,
 *          which is tried out on 4096 colours, bit for bit
 *
 * Errors are those of bake_color_to_linear. bake_tones_close frees it.
 */
BAKE_API enum bake_status bake_tones_open(struct bake_tones **tones,
    const struct bake_color *color, const char *space, int code_max,
    struct bake_err *err);
BAKE_API void bake_tones_close(struct bake_tones *tones);

/* bake_color_to_linear of an image that holds code / code_max. */
BAKE_API void bake_tones_to_linear(
    const struct bake_tones *tones, struct bake_image *img, int nthreads);

/* bake_color_from_linear, rounded to the nearest code, of an image whose
 * values are those of codes or between them. */
BAKE_API void bake_tones_from_linear(
    const struct bake_tones *tones, struct bake_image *img, int nthreads);

#ifdef __cplusplus
}
#endif

#endif
