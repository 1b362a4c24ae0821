/* What maps say about themselves: polarity, normal Y, depth scale, seams. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_DETECT_H
#define BAKE_DETECT_H

#include "conventions.h"
#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What one channel holds. min, max and mean are of the finite values, NaN
 * where there is none. */
struct bake_channel_range {
	double min, max, mean;
	size_t nnan, ninf;
};

/*
 * The range of channel chan of img, 0 <= chan < img->nchans. The mean is
 * summed row by row in double. Reentrant, cannot fail.
 */
BAKE_API void bake_channel_range(
    const struct bake_image *img, int chan, struct bake_channel_range *out);

/*
 * The vectors of a normal map, over its texels with finite components.
 * length_mean and length_dev: mean and standard deviation of |n| (3 channels;
 * NaN with 2, where z is not stored). outside: share of texels with
 * x^2 + y^2 > (1 + 2/255)^2, which no unit vector has even after rounding to
 * 8 bits. negative_z: share with z < 0 (0 with 2 channels). NaN where no
 * texel is finite. tilt: |mean (x, y)|, 0 where the map has no slant.
 */
struct bake_normal_stats {
	double length_mean, length_dev;
	double outside, negative_z, tilt;
	size_t nfinite;
};

/*
 * Those figures of normal: 2 or 3 channels, signed components (-1 .. 1).
 * BAKE_EINVAL: another number of channels. Reentrant.
 */
BAKE_API enum bake_status bake_normal_stats(const struct bake_image *normal,
    struct bake_normal_stats *out, struct bake_err *err);

/*
 * Whether those are the vectors of a tangent-space normal map: at most 5 %
 * with z < 0 (2 channels: outside the unit disc), tilt at most 0.35 and, with
 * 3 channels, length 0.5 .. 1.5 in the mean with a deviation below 0.3.
 */
BAKE_API bool bake_normals_plausible(
    const struct bake_normal_stats *stats, int nchans);

/*
 * How the step across the border compares with the steps inside:
 *     d(x) = mean over rows and channels of |v(x + 1, y) - v(x, y)|
 *     u      = d(W - 1) / mean of d(0 .. W - 2)     (x + 1 taken modulo W)
 *     u_peak = d(W - 1) / max of d(0 .. W - 2)
 * and v, v_peak with rows and columns exchanged. About 1 tiles; above 3 is a
 * visible seam, or a joint of the pattern that lies on the border: then
 * u_peak stays below about 1, for the pattern has such joints inside too.
 * 0 where all the steps are 0; NaN along an axis of one texel. Steps with a
 * value that is not finite are left out.
 */
struct bake_seams {
	double u, v, u_peak, v_peak;
};

/*
 * The seams of img, over its channels first_chan .. first_chan + nchans - 1,
 * which exist. BAKE_ENOMEM: two rows of doubles. Reentrant.
 */
BAKE_API enum bake_status bake_seams(const struct bake_image *img,
    int first_chan, int nchans, struct bake_seams *out, struct bake_err *err);

/*
 * The evidence of one statistic, at the blur scale where it is strongest.
 *   verdict  +1, -1, or 0: not enough, or scales that contradict each other
 *   value    the statistic, -1 .. 1 (below)
 *   sigmas   value / its standard error, by a jackknife over blocks; blocks:
 *            how many (at most 8x8)
 *   share    weight of the blocks that by themselves have the value's sign
 *   chance   share of 40 random torus shifts of one map against the other
 *            whose statistic is at least as large: what unrelated maps with
 *            the same patterns would give
 *   scale    the texels of the map that one texel of that scale covers, 1, 2,
 *            4 ...; 0: the map is too small or too empty for any statistic
 */
struct bake_evidence {
	int verdict;
	double value, sigmas, share, chance;
	int scale, blocks;
};

/*
 * All that bake_detect finds. Its statistics, where p = -nx/nz, q = -ny/nz,
 * v the relief map's value, x to the right, y UP the image:
 *   x      corr(dv/dx, p)       > 0: bright is high
 *   y      corr(dv/dy, q)       same sign as x: normal y is up
 *   curl   -2 E[ab] / E[a^2 + b^2], a = dp/d(row), b = dq/dx: 1 where (p, q)
 *          is a gradient with y up, -1 with y down, 0 for unrelated p, q
 *   twist  |the like figure| for a = dp/dx, b = dq/d(row): above curl where
 *          x and y are swapped or the map was turned by 90 degrees
 *   straight, crossed  mean r^2 of (dv/dx, p), (dv/dy, q) and of
 *          (dv/dx, q), (dv/dy, p), at x's scale
 * Figures that need a map that was not given are 0 (scale 0).
 */
struct bake_detection {
	enum bake_polarity polarity;
	enum bake_normal_y normal_y; /* pair and curl combined */
	enum bake_normal_y pair_y, curl_y;
	struct bake_evidence x, y, curl;
	double twist, straight, crossed;
	/* slopes per gradient of v, see bake_detect; NaN where unsure */
	double depth_scale, depth_scale_low, depth_scale_high;
	bool plausible_normals; /* bake_normals_plausible; if not: unsure */
};

/*
 * Decide what a normal map and a relief map say about their conventions.
 *
 *   normal  2 channels (z = sqrt(max(0, 1 - x^2 - y^2))) or 3, signed
 *           components -1 .. 1 of any length, y as stored; or NULL
 *   relief  1 channel, values as stored, any range; or NULL
 *   out     overwritten
 *
 * Both maps have the same size. Texels that are not finite are left out. The
 * border texels are not used, so the result does not depend on the wrap.
 *
 * polarity needs both maps: the sign of x. pair_y is the sign of x * y.
 * curl_y comes from the normal map alone. normal_y is what pair_y and curl_y
 * agree on, or the one that is sure; where they contradict, polarity and
 * normal_y are UNSURE (pair_y and curl_y tell why). Each asks
 * for a value well above 0, more than 6 standard errors, blocks that agree,
 * better than random shifts, and no other blur scale that contradicts. A
 * relief with evidence along one axis only (stripes) gives no pair_y; where
 * both maps vary along an axis and do not agree there, all is unsure. So are
 * maps below 13 texels a side. Any map that follows the relief answers as a
 * relief map does: an AO map, which is dark in pits, says bright is high.
 *
 * depth_scale: S such that the normals are those of the height S v (or
 * S (1 - v), for depth) in texture widths, texel pitch 1/W on both axes. The
 * regression of p, q on dv/dx, dv/dy gives low (noise in v pulls it down),
 * the inverse regression high (noise in the normals pushes it up); the
 * truth lies between if the two errors are independent, and depth_scale is
 * their geometric mean, at the blur scale that correlates best. NaN where the
 * correlation is below 0.7 (high / low > 2), where other scales differ by more
 * than a factor of 2, or where polarity is unsure. Normals below about a code
 * of their 8 bits are rounded up in the mean: then it is too high by up to 20 %
 * and the interval too narrow.
 *
 * Method: p, q (slope limited to 5) and v are taken at full resolution, then
 * low-passed and halved again and again; at each scale a 5x5 Sobel operator
 * and the mean that matches it (Simpson's rule) give gradients and slopes
 * with the same blur. Of maps with more than 2^20 texels, 8 windows along each
 * long axis are looked at, spread evenly.
 *
 * BAKE_EINVAL  no map, or wrong channel counts
 * BAKE_EDATA   maps of different size
 * BAKE_ENOMEM  scratch: at most 32 bytes x 2^20, however large the map is
 * After a failure *out says unsure throughout.
 *
 * Reentrant, single-threaded, deterministic.
 * Source: own derivation; the tests' comments show the statistics at work on
 * closed forms. The curl test is the integrability of a gradient field.
 */
BAKE_API enum bake_status bake_detect(const struct bake_image *normal,
    const struct bake_image *relief, struct bake_detection *out,
    struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
