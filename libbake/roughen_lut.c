/* 2 1/2 D texture mapping: the remap as a small texture for renderers. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "roughen_priv.h"

/* The column that holds d = 0. */
static int
middle(const struct bake_image *lut)
{
	return lut->width / 2 - 1;
}

/* d, and its side, of a column. */
static double
column_deviation(const struct bake_image *lut, int x, double *side)
{
	const int m = middle(lut), k = x < 2 * m ? x - m : m;
	const double w = 1 - ((double)abs(k) - 1) / (m - 1);

	*side = k > 0 ? 1 : k < 0 ? -1 : 0;
	return *side * (1 - w * w);
}

enum bake_status
bake_roughen_lut(const struct bake_roughen *r, int width, int height,
    struct bake_image *lut, struct bake_err *err)
{
	enum bake_status rc;

	if (r->model == BAKE_ROUGHEN_BLACKSHOT)
		return bake_fail(err, BAKE_EINVAL,
		    "blackshot's edge moves with the angle, which no table of "
		    "this kind holds");
	if (width < BAKE_ROUGHEN_LUT_MIN || height < BAKE_ROUGHEN_LUT_MIN ||
	    width > BAKE_ROUGHEN_LUT_MAX || height > BAKE_ROUGHEN_LUT_MAX)
		return bake_fail(err, BAKE_EINVAL,
		    "a table of %dx%d, expected %d to %d entries a side", width,
		    height, BAKE_ROUGHEN_LUT_MIN, BAKE_ROUGHEN_LUT_MAX);
	rc = bake_image_alloc(lut, width, height, 1, err);
	if (rc != BAKE_OK)
		return rc;
	for (int y = 0; y < height; y++) {
		/* sin of half the angle */
		const double h = (double)y / (height - 1);
		const double c = 1 - 2 * h * h, s = 2 * h * sqrt(1 - h * h);

		for (int x = 0; x < width; x++) {
			double side;
			const double d = column_deviation(lut, x, &side);

			bake_image_row(lut, y)[x] =
			    (float)((bake_roughen_facing(r, d, side, c, s) +
					1) /
				    2);
		}
	}
	return BAKE_OK;
}

/* A linear filter between texel centres, clamped to the edge. */
static double
filtered(const struct bake_image *lut, double column, double row)
{
	const int x = (int)column, y = (int)row;
	const int x1 = x + 1 < lut->width ? x + 1 : x;
	const int y1 = y + 1 < lut->height ? y + 1 : y;
	const double fx = column - x, fy = row - y;
	const float *a = bake_image_row(lut, y), *b = bake_image_row(lut, y1);

	return (1 - fy) * ((1 - fx) * a[x] + fx * a[x1]) +
	       fy * ((1 - fx) * b[x] + fx * b[x1]);
}

double
bake_roughen_lut_gain(const struct bake_roughen *r,
    const struct bake_image *lut, double t, double cos_theta)
{
	const double d = bake_roughen_deviation(r, t);
	const double m = middle(lut);
	const double column = m + bake_roughen_side(r, t) *
				      (1 + (m - 1) * (1 - sqrt(1 - fabs(d))));
	const double row = (lut->height - 1) * sqrt((1 - cos_theta) / 2);
	const double g = 2 * filtered(lut, column, row) - 1;

	return g > 0 ? g : 0;
}

double
bake_roughen_lut_error(
    const struct bake_roughen *r, const struct bake_image *lut, double t_max)
{
	enum { N = 512 };
	double worst = 0;

	for (int i = 0; i <= N; i++) {
		/* half of the points between black and the median, where d
		 * runs from -1 to 0 */
		const double u = 2.0 * i / N - 1;
		double t = u <= 0 ? r->median + u * r->low
				  : r->median + u * (t_max - r->median);

		t = t > t_max ? t_max : t;
		for (int k = 0; k <= N; k++) {
			double c, s, e;

			bake_roughen_angle(180.0 * k / N, &c, &s);
			e = t * (bake_roughen_lut_gain(r, lut, t, c) -
				    bake_roughen_gain(r, t, c, s));
			worst = fabs(e) > worst ? fabs(e) : worst;
		}
	}
	return worst;
}
