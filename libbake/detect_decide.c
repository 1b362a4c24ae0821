/* From the statistics of all blur scales to an answer, or to 'unsure'. */
/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "detect_priv.h"

/*
 * What a statistic must reach. Between unrelated maps a value of 0.25 occurs
 * where both have few, large, straight features; then blocks disagree, or
 * random shifts do as well, or the other axis has nothing to say.
 */
static const double corr_least = 0.25, curl_least = 0.35;
/* One scale alone, of several, or one axis alone must be clearer. */
static const double alone_least = 0.6;
/* Where both maps vary along both axes, the weaker correlation is to the
 * stronger, at one and the same scale, at least this. */
static const double balance_least = 0.4;
static const double sigmas_least = 6, share_least = 0.75, chance_most = 0.05;
/* A scale that says the opposite this clearly takes a verdict away. */
static const double against_value = 0.15, against_sigmas = 4;
/* A scale whose slopes or gradients hold less than this share of the largest
 * scale's energy is rounding and aliases. */
static const double energy_least = 0.01;
/* An axis counts as varying with this share of the other axis' energy. */
static const double axis_least = 0.05;
/* a^2 + b^2 of the curl test against all derivatives: below, p depends on x
 * alone and q on y alone, which is right with y up and with y down. */
static const double curl_energy_least = 0.001;
/* Regressions with less correlation leave more than a factor 2 open; scales
 * that differ by more than this factor measure no common depth scale. */
static const double scale_corr = 0.7, scale_spread = 2;

static bool
speaks(const struct bake_evidence *e, double least)
{
	/* a standard error from few blocks is itself uncertain: 9 blocks are
	 * asked for 10 of them, 64 for 6.7 */
	double sigmas = sigmas_least * sqrt(1 + 16.0 / fmax(e->blocks, 1));

	return fabs(e->value) >= least && fabs(e->sigmas) >= sigmas &&
	       e->share >= share_least && e->chance <= chance_most;
}

static bool
speaks_against(const struct bake_evidence *e, int verdict)
{
	return e->value * verdict <= -against_value &&
	       fabs(e->sigmas) >= against_sigmas && e->share >= 0.6;
}

/* The strongest of n scales' evidence, with a verdict where it speaks and no
 * other scale speaks against it. */
static struct bake_evidence
strongest(const struct bake_evidence *const *e, int n, double least)
{
	struct bake_evidence best = { .chance = 1 };
	int nspeak = 0;

	for (int k = 0; k < n; k++) {
		bool now = speaks(e[k], least);

		nspeak += now;
		if ((now && best.verdict == 0) ||
		    (now == (best.verdict != 0) &&
			fabs(e[k]->value) > fabs(best.value))) {
			best = *e[k];
			best.verdict = now ? (best.value > 0 ? 1 : -1) : 0;
		}
	}
	if (nspeak == 1 && n > 1 && fabs(best.value) < alone_least)
		best.verdict = 0;
	for (int k = 0; k < n; k++)
		if (best.verdict != 0 && speaks_against(e[k], best.verdict))
			best.verdict = 0;
	return best;
}

static bool
has_energy(const struct detect_result *result, int n, int k, bool pair)
{
	double slope = 0, gradient = 0;

	for (int i = 0; i < n; i++) {
		slope = fmax(slope, result[i].slope_energy);
		gradient = fmax(gradient, result[i].gradient_energy);
	}
	return result[k].slope_energy > energy_least * slope &&
	       (!pair || result[k].gradient_energy > energy_least * gradient);
}

/*
 * Whether the other axis, at the scale where one axis has its verdict, goes
 * with it: it varies in both maps and correlates as well with its own
 * verdict's sign; or it does not vary, and the one axis is clear alone.
 */
static bool
other_goes_along(const struct detect_result *r, bool x_is_one,
    const struct bake_detection *d)
{
	const struct detect_sums *one = x_is_one ? &r->gain_x : &r->gain_y;
	const struct detect_sums *other = x_is_one ? &r->gain_y : &r->gain_x;
	double value = x_is_one ? r->x.value : r->y.value;
	double other_value = x_is_one ? r->y.value : r->x.value;
	int other_verdict = x_is_one ? d->y.verdict : d->x.verdict;

	if (other->aa > axis_least * one->aa &&
	    other->bb > axis_least * one->bb)
		return other_value * other_verdict >=
		       balance_least * fabs(value);
	return other_verdict != 0 || fabs(value) >= alone_least;
}

static const struct detect_result *
at_scale(const struct detect_result *result, int n, int texels)
{
	for (int k = 0; k < n; k++)
		if (result[k].texels == texels)
			return &result[k];
	return &result[0];
}

/* Take away verdicts of x and y that do not fit each other. */
static void
cross_examine(
    struct bake_detection *out, const struct detect_result *result, int n)
{
	bool x_stands =
	    out->x.verdict == 0 ||
	    other_goes_along(at_scale(result, n, out->x.scale), true, out);
	bool y_stands =
	    out->y.verdict == 0 ||
	    other_goes_along(at_scale(result, n, out->y.scale), false, out);

	/* 1.02: a diagonal stripe has both alike, but for rounding */
	if (!x_stands || !y_stands || out->crossed > 1.02 * out->straight)
		out->x.verdict = out->y.verdict = 0;
}

static void
decide_pair(
    struct bake_detection *out, const struct detect_result *result, int n)
{
	const struct bake_evidence *x[DETECT_SCALES], *y[DETECT_SCALES];
	const struct detect_result *best;
	int count = 0;

	for (int k = 0; k < n; k++) {
		if (!has_energy(result, n, k, true))
			continue;
		x[count] = &result[k].x;
		y[count++] = &result[k].y;
	}
	if (count == 0)
		return;
	out->x = strongest(x, count, corr_least);
	out->y = strongest(y, count, corr_least);
	best = at_scale(
	    result, n, out->x.verdict != 0 ? out->x.scale : out->y.scale);
	out->straight = best->straight;
	out->crossed = best->crossed;
	cross_examine(out, result, n);
	if (!out->plausible_normals)
		return;
	if (out->x.verdict != 0)
		out->polarity = out->x.verdict > 0 ? BAKE_POLARITY_HEIGHT
						   : BAKE_POLARITY_DEPTH;
	if (out->x.verdict * out->y.verdict != 0)
		out->pair_y = out->x.verdict == out->y.verdict
				  ? BAKE_NORMAL_Y_UP
				  : BAKE_NORMAL_Y_DOWN;
}

static void
decide_curl(
    struct bake_detection *out, const struct detect_result *result, int n)
{
	const struct bake_evidence *c[DETECT_SCALES];
	const struct detect_result *best;
	int count = 0;

	for (int k = 0; k < n; k++)
		if (has_energy(result, n, k, false) &&
		    result[k].curl_energy > curl_energy_least)
			c[count++] = &result[k].curl;
	if (count == 0)
		return;
	out->curl = strongest(c, count, curl_least);
	best = at_scale(result, n, out->curl.scale);
	out->twist = best->twist;
	/* 0.9: a diagonal stripe has both 1, and is more likely than maps with
	 * x and y swapped, whose curl is 1/3 for an isotropic relief */
	if (fabs(out->curl.value) < 0.9 * out->twist)
		out->curl.verdict = 0;
	if (out->plausible_normals && out->curl.verdict != 0)
		out->curl_y = out->curl.verdict > 0 ? BAKE_NORMAL_Y_UP
						    : BAKE_NORMAL_Y_DOWN;
}

/* Regressions over both axes at the scale where they correlate best; NaN
 * where other scales say something else. */
static void
decide_scale(struct bake_detection *out, const struct detect_result *result,
    int n, int width)
{
	double best = 0, least = INFINITY, most = 0;

	for (int k = 0; k < n; k++) {
		const struct detect_result *r = &result[k];
		double aa = r->gain_x.aa + r->gain_y.aa;
		double bb = r->gain_x.bb + r->gain_y.bb;
		double ab = r->gain_x.ab * out->x.verdict +
			    r->gain_y.ab * out->y.verdict;
		double unit = (double)r->texels / width, corr, s;

		if (!has_energy(result, n, k, true) || !(ab > 0))
			continue;
		corr = ab / (sqrt(aa) * sqrt(bb));
		if (corr < scale_corr)
			continue;
		s = sqrt(bb / aa) * unit;
		least = fmin(least, s);
		most = fmax(most, s);
		if (corr > best) {
			best = corr;
			out->depth_scale = s;
			out->depth_scale_low = ab / aa * unit;
			out->depth_scale_high = bb / ab * unit;
		}
	}
	if (most > scale_spread * least)
		out->depth_scale = out->depth_scale_low =
		    out->depth_scale_high = NAN;
}

void
bake_detect_decide(struct bake_detection *out,
    const struct detect_result *result, int n, int width)
{
	decide_pair(out, result, n);
	decide_curl(out, result, n);
	if (out->pair_y == BAKE_NORMAL_Y_UNSURE || out->pair_y == out->curl_y)
		out->normal_y = out->curl_y;
	else if (out->curl_y == BAKE_NORMAL_Y_UNSURE)
		out->normal_y = out->pair_y;
	else /* the pair contradicts the normals: not their relief map */
		out->polarity = BAKE_POLARITY_UNSURE;
	if (out->polarity != BAKE_POLARITY_UNSURE)
		decide_scale(out, result, n, width);
}
