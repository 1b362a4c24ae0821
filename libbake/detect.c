/* What a normal map and a relief map say: the scales, and the conclusion. */
/* SPDX-License-Identifier: MIT */
#include "detect.h"

#include <math.h>

#include "detect_priv.h"

static enum bake_status
check_maps(const struct bake_image *normal, const struct bake_image *relief,
    struct bake_err *err)
{
	if (normal == NULL && relief == NULL)
		return bake_fail(err, BAKE_EINVAL, "no map to look at");
	if (normal != NULL && normal->nchans != 2 && normal->nchans != 3)
		return bake_fail(err, BAKE_EINVAL,
		    "a normal map has 2 or 3 channels, this one has %d",
		    normal->nchans);
	if (relief != NULL && relief->nchans != 1)
		return bake_fail(err, BAKE_EINVAL,
		    "a relief map has 1 channel, this one has %d",
		    relief->nchans);
	if (normal != NULL && relief != NULL &&
	    (normal->width != relief->width ||
		normal->height != relief->height))
		return bake_fail(err, BAKE_EDATA,
		    "the normal map is %dx%d, the relief map %dx%d",
		    normal->width, normal->height, relief->width,
		    relief->height);
	return BAKE_OK;
}

bool
bake_normals_plausible(const struct bake_normal_stats *s, int nchans)
{
	if (s->nfinite == 0 || s->negative_z > 0.05 || s->tilt > 0.35)
		return false;
	if (nchans == 2)
		return s->outside < 0.05;
	return s->length_mean > 0.5 && s->length_mean < 1.5 &&
	       s->length_dev < 0.3;
}

/* Measure every scale whose interior has at least 3x3 blocks. */
static enum bake_status
measure_scales(struct detect_result result[DETECT_SCALES], int *n,
    const struct bake_image *normal, const struct bake_image *relief,
    struct bake_err *err)
{
	struct detect_scale s = DETECT_SCALE_INIT, half;
	enum bake_status rc;

	*n = 0;
	if ((rc = bake_detect_scale_load(&s, normal, relief, err)) != BAKE_OK)
		goto out;
	while (*n < DETECT_SCALES && s.width >= DETECT_LEAST &&
	       s.height >= DETECT_LEAST) {
		rc = bake_detect_scale_measure(&result[*n], &s, err);
		if (rc != BAKE_OK)
			goto out;
		(*n)++;
		if ((rc = bake_detect_scale_halve(&half, &s, err)) != BAKE_OK)
			goto out;
		bake_detect_scale_free(&s);
		s = half;
	}
out:
	bake_detect_scale_free(&s);
	return rc;
}

enum bake_status
bake_detect(const struct bake_image *normal, const struct bake_image *relief,
    struct bake_detection *out, struct bake_err *err)
{
	struct detect_result result[DETECT_SCALES];
	struct bake_normal_stats stats;
	enum bake_status rc;
	int n;

	*out = (struct bake_detection){ .depth_scale = NAN,
		.depth_scale_low = NAN,
		.depth_scale_high = NAN };
	if ((rc = check_maps(normal, relief, err)) != BAKE_OK)
		return rc;
	if (normal == NULL)
		return BAKE_OK; /* a relief map alone says nothing */
	if ((rc = bake_normal_stats(normal, &stats, err)) != BAKE_OK)
		return rc;
	rc = measure_scales(result, &n, normal, relief, err);
	if (rc != BAKE_OK)
		return rc;
	out->plausible_normals = bake_normals_plausible(&stats, normal->nchans);
	bake_detect_decide(out, result, n, normal->width);
	return BAKE_OK;
}
