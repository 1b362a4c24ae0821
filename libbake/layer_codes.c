/* Multilayer depth as codes: quantising, widening, merging and capping. */
/* SPDX-License-Identifier: MIT */
#include "layer_codes.h"

#include <math.h>
#include <string.h>

#include "layer_priv.h"

double
bake_layer_stored(double d)
{
	return (1 + 253 * d) / 255;
}

double
bake_layer_depth(double stored)
{
	return (255 * stored - 1) / 253;
}

static double
clamped(double d)
{
	/* NaN as 0, so that none becomes a code */
	return !(d > 0) ? 0 : d > 1 ? 1 : d;
}

float
bake_layer_value(uint32_t code, enum bake_data_format format)
{
	uint16_t bits = (uint16_t)code;
	float value;

	switch (format) {
	case BAKE_DATA_UINT8:
		return (float)code / 255.0f;
	case BAKE_DATA_UINT16:
		return (float)code / 65535.0f;
	case BAKE_DATA_HALF:
		bake_codes_from_half(&value, &bits, 1);
		return value;
	default:
		memcpy(&value, &code, sizeof value);
		return value;
	}
}

/* The half nearest to a double of 2^-14 and more. By way of float it would be
 * rounded twice, which matters where the float is in the middle of two halfs
 * and the double is not. */
static uint32_t
half_code(double stored)
{
	const float value = (float)stored;
	uint32_t bits, below, rest;

	memcpy(&bits, &value, sizeof bits);
	bits -= 112u << 23; /* the exponents' biases: 127 and 15 */
	below = bits >> 13;
	rest = bits & 0x1fff;
	if (rest != 0x1000)
		return below + (rest > 0x1000);
	if (stored != (double)value)
		return below + (stored > (double)value);
	return below + below % 2;
}

uint32_t
bake_layer_code(double d, enum bake_data_format format)
{
	uint32_t code;
	float value;

	d = clamped(d);
	switch (format) {
	case BAKE_DATA_UINT8: /* 255 d' */
		return (uint32_t)(1.5 + 253 * d);
	case BAKE_DATA_UINT16: /* 65535 d' */
		return (uint32_t)(257.5 + 65021 * d);
	case BAKE_DATA_HALF:
		return half_code(bake_layer_stored(d));
	default:
		value = (float)bake_layer_stored(d);
		memcpy(&code, &value, sizeof code);
		return code;
	}
}

void
bake_layer_stats_add(
    struct bake_layer_stats *sum, const struct bake_layer_stats *stats)
{
	sum->capped += stats->capped;
	sum->removed += stats->removed;
	sum->merged += stats->merged;
	sum->widened += stats->widened;
	sum->clamped += stats->clamped;
	sum->cut += stats->cut;
	if (stats->max_error > sum->max_error)
		sum->max_error = stats->max_error;
}

/* The depth of a code less the depth that it stands for. */
static double
residual(const struct bake_layer *l, enum bake_data_format format)
{
	return bake_layer_depth((double)bake_layer_value(l->code, format)) -
	       l->depth;
}

static struct bake_layer
round_crossing(const struct bake_crossing *crossing, int i,
    enum bake_data_format format, struct bake_layer_stats *stats)
{
	struct bake_layer l;

	l.crossing = i;
	l.depth = clamped(crossing[i].depth);
	l.code = bake_layer_code(l.depth, format);
	stats->clamped += l.depth != crossing[i].depth;
	return l;
}

/* All slabs within the range, rounded; those that no code parts are one. */
static int
round_slabs(const struct bake_crossing *crossing, int n,
    enum bake_data_format format, struct bake_layer *layer,
    struct bake_layer_stats *stats)
{
	int m = 0;

	for (int i = 0; i + 1 < n; i += 2) {
		struct bake_layer exit;

		if (crossing[i + 1].depth < 0 || crossing[i].depth > 1) {
			stats->cut++;
			continue;
		}
		layer[m] = round_crossing(crossing, i, format, stats);
		exit = round_crossing(crossing, i + 1, format, stats);
		if (m > 0 && layer[m].code <= layer[m - 1].code) {
			stats->merged++;
			layer[m - 1] = exit;
		} else {
			layer[m + 1] = exit;
			m += 2;
		}
	}
	return m;
}

/*
 * Slab i has one code c for both ends. Its exit becomes c + 1 where the two
 * residuals together say that the slab's middle lies behind c, else its entry
 * c - 1: which is the end with the larger residual, and the smaller error.
 * Where that code is taken, the other; where both are, the slab is joined with
 * the neighbour on the better side. What is before slab i is final. Returns
 * how many layers are left.
 */
static int
widen_slab(struct bake_layer *layer, int n, int i, enum bake_data_format format,
    struct bake_layer_stats *stats)
{
	struct bake_layer *entry = &layer[i], *exit = &layer[i + 1];
	const uint32_t c = entry->code;
	const bool before = c > bake_layer_code(0, format);
	const bool after = c < bake_layer_code(1, format);
	const bool free_before = before && (i == 0 || c - 1 > entry[-1].code);
	const bool free_after = after && (i + 2 == n || c + 1 < exit[1].code);
	const bool behind =
	    residual(entry, format) + residual(exit, format) <= 0;

	if (free_after && (behind || !free_before)) {
		exit->code = c + 1;
		stats->widened++;
		return n;
	}
	if (free_before) {
		entry->code = c - 1;
		stats->widened++;
		return n;
	}
	/* a range of two codes or more: one of the sides is a neighbour */
	stats->merged++;
	if (i + 2 < n && (behind || i == 0))
		i++; /* the gap behind; else that before */
	else
		i--;
	memmove(&layer[i], &layer[i + 2], (size_t)(n - i - 2) * sizeof *layer);
	return n - 2;
}

int
bake_layer_quantize(const struct bake_crossing *crossing, int n,
    const struct bake_layer_params *params, struct bake_layer *layer,
    struct bake_layer_stats *stats)
{
	const enum bake_data_format format = params->format;
	int m = round_slabs(crossing, n, format, layer, stats);

	for (int i = 0; i < m;) {
		const int was = m;

		if (layer[i].code == layer[i + 1].code)
			m = widen_slab(layer, m, i, format, stats);
		/* joined with the one before, i is the next slab */
		if (m == was || layer[i].code < layer[i + 1].code)
			i += 2;
	}
	if (params->nlayers > 0 && m > params->nlayers) {
		stats->capped++;
		stats->removed += (size_t)(m - params->nlayers);
		m = params->policy == BAKE_CAP_NEAREST
			? params->nlayers
			: (int)bake_layer_cap(
			      layer, (size_t)m, (size_t)params->nlayers);
	}
	for (int i = 0; i < m; i++) {
		const double e = fabs(residual(&layer[i], format));

		if (e > stats->max_error)
			stats->max_error = e;
	}
	return m;
}
