/* From horizons to ambient occlusion, for one instruction set. */
/* SPDX-License-Identifier: MIT */
#include "ao_priv.h"
#include "isa.h"
#include "vec_priv.h"

static inline vec_f
tangent(const float *slope, vec_f scale)
{
	return vec_min(vec_load(slope) * scale, vec_set(BAKE_AO_TAN_MAX));
}

static inline vec_f
cosine(vec_f tan_e)
{
	const vec_f one = vec_set(1);

	return one / vec_sqrt(one + tan_e * tan_e);
}

static void
add_polygon(const struct bake_ao_add *a)
{
	const vec_f scale = vec_set(a->scale);

	for (size_t t = 0; t < a->n; t += VEC_LANES) {
		vec_f r = cosine(tangent(a->slopes + t, scale));

		if (a->start)
			vec_store(a->sum + t, vec_set(0));
		else if (!a->open)
			vec_store(a->sum + t,
			    vec_load(a->sum + t) + r * vec_load(a->prev + t));
		vec_store(a->prev + t, r);
	}
}

static void
add_mean(const struct bake_ao_add *a)
{
	const vec_f scale = vec_set(a->scale);

	for (size_t t = 0; t < a->n; t += VEC_LANES) {
		vec_f r = cosine(tangent(a->slopes + t, scale));

		if (a->start)
			vec_store(a->sum + t, r * r);
		else
			vec_store(a->sum + t, vec_load(a->sum + t) + r * r);
	}
}

/*
 * sum_j cos phi_j = sum_j sin phi_j = 0, so the cube of direction 0's cosine
 * is subtracted from all: a plane, or the axis of a round pit, then gives
 * x = y = 0 exactly. 1 - s^3 = r^2 (1 + s + s^2) / (1 + s) for s = sin e
 * keeps its digits in a deep pit. The common factor 1/3 drops out.
 */
static void
add_bent(const struct bake_ao_add *a)
{
	const vec_f scale = vec_set(a->scale), one = vec_set(1);
	const vec_f c = vec_set(a->cos_phi), s = vec_set(a->sin_phi);

	for (size_t t = 0; t < a->n; t += VEC_LANES) {
		vec_f tan_e = tangent(a->slopes + t, scale);
		vec_f r = cosine(tan_e), sin_e = tan_e * r;
		vec_f f = a->start ? r : vec_load(a->first + t);
		vec_f xy = r * r * r - f * f * f;
		vec_f z = r * r * (one + sin_e + sin_e * sin_e) / (one + sin_e);

		if (a->start) {
			vec_store(a->first + t, r);
			vec_store(a->bent[0] + t, vec_set(0));
			vec_store(a->bent[1] + t, vec_set(0));
			vec_store(a->bent[2] + t, z);
			continue;
		}
		vec_store(a->bent[0] + t, vec_load(a->bent[0] + t) + xy * c);
		vec_store(a->bent[1] + t, vec_load(a->bent[1] + t) + xy * s);
		vec_store(a->bent[2] + t, vec_load(a->bent[2] + t) + z);
	}
}

void
BAKE_KERNEL(bake_ao_add)(const struct bake_ao_add *a)
{
	if (a->mean)
		add_mean(a);
	else
		add_polygon(a);
	if (a->bent[0] != NULL)
		add_bent(a);
}

void
BAKE_KERNEL(bake_ao_mask)(uint64_t *mask, const float *slopes, size_t n)
{
	for (size_t i = 0; i < n; i += 64) {
		uint64_t bits = 0;

		for (int t = 0; t < 64; t += VEC_LANES)
			bits |= (uint64_t)vec_gt_mask(
				    vec_load(slopes + i + t), vec_set(0))
				<< t;
		mask[i / 64] |= bits;
	}
}
