/* The damping that suits a quantised normal map of unknown origin. */
/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "integrate.h"

/* Mean squared chord between two maps of vectors, of any length in a and of
 * unit length in b; vectors without a direction are left out. */
static double
mean_chord2(const struct bake_image *a, const struct bake_image *b)
{
	double sum = 0;
	size_t n = 0;

	for (int y = 0; y < a->height; y++) {
		const float *u = bake_image_row(a, y);
		const float *v = bake_image_row(b, y);
		double row = 0;

		for (int x = 0; x < a->width; x++, u += 3, v += 3) {
			double len =
			    sqrt((double)u[0] * u[0] + (double)u[1] * u[1] +
				 (double)u[2] * u[2]);
			double dot = (double)u[0] * v[0] + (double)u[1] * v[1] +
				     (double)u[2] * v[2];

			if (!(len > 1e-6 && len < 1e6))
				continue;
			row += 2 - 2 * dot / len;
			n++;
		}
		sum += row;
	}
	return n > 0 ? sum / (double)n : 0;
}

enum bake_status
bake_integrate_damping(const struct bake_image *normal,
    const struct bake_integrate_params *params, double *damping,
    struct bake_err *err)
{
	/* one degree, as a chord: rounding to 8 bits turns a normal by 0.2 to
	 * 0.4 degrees, another operator by 2 and more */
	const double same_operator = 0.01745 * 0.01745;
	struct bake_integrate_params exact = *params;
	struct bake_image h = BAKE_IMAGE_INIT, again = BAKE_IMAGE_INIT;
	enum bake_status rc;

	exact.damping = 0;
	rc = bake_integrate(normal, &exact, &h, NULL, err);
	if (rc == BAKE_OK) {
		for (int y = 0; y < h.height; y++)
			for (int x = 0; x < h.width; x++)
				bake_image_row(&h, y)[x] *= -1.0f;
		/* depth -h at scale 1 has height 1 + h */
		rc = bake_normal_from_depth(&h, 1, params->wrap, params->op,
		    params->nthreads, &again, err);
	}
	if (rc == BAKE_OK)
		*damping =
		    mean_chord2(normal, &again) < same_operator ? 0.03 : 0.3;
	bake_image_free(&h);
	bake_image_free(&again);
	return rc;
}
