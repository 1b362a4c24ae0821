/* The blends of normals, occlusion and depth, a row at a time. */
/* SPDX-License-Identifier: MIT */
#include "combine_priv.h"

#include <math.h>

struct vec {
	double x, y, z;
};

static inline struct vec
unit(struct vec n)
{
	const double len = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
	const struct vec up = { 0, 0, 1 };
	const struct vec v = { n.x / len, n.y / len, n.z / len };

	return len > 0 ? v : up;
}

/* A normal from its codes; x, y outside the unit circle come back to it. */
static inline struct vec
from_codes(const float *t)
{
	struct vec n = { 2.0 * t[0] - 1, 2.0 * t[1] - 1, 0 };
	const double r2 = n.x * n.x + n.y * n.y;
	const double k = r2 > 1 ? 1 / sqrt(r2) : 1;

	n.x *= k;
	n.y *= k;
	n.z = r2 < 1 ? sqrt(1 - r2) : 0;
	return n;
}

/* And from its projection; filtering may leave the unit circle. */
static inline struct vec
from_projection(const float *t)
{
	const double x = t[0], y = t[1], r2 = x * x + y * y;
	const double k = r2 < 1 ? 2 / (1 + r2) : 1 / sqrt(r2);
	const struct vec n = { k * x, k * y, r2 < 1 ? k - 1 : 0 };

	return n;
}

static inline struct vec
layer_normal(const struct bake_combine_op *op, const float *t)
{
	return op->projected ? from_projection(t) : from_codes(t);
}

/* n.xy / n.z, of a normal no steeper than can be told. */
static inline struct vec
tangents(struct vec n)
{
	const double k =
	    n.z * BAKE_TANGENT_MAX > 1 ? 1 / n.z : BAKE_TANGENT_MAX;
	const struct vec t = { k * n.x, k * n.y, 0 };

	return t;
}

void
bake_combine_project(float *row, int width)
{
	for (int x = 0; x < width; x++, row += 4) {
		const struct vec n = from_codes(row);

		row[0] = (float)(n.x / (1 + n.z));
		row[1] = (float)(n.y / (1 + n.z));
	}
}

static void
add_seed(
    const struct bake_combine_op *op, const float *row, int width, float *sum)
{
	for (int x = 0; x < width; x++, row += 4, sum += 3) {
		const struct vec n = layer_normal(op, row);

		sum[0] = (float)(sum[0] + op->normal * n.x);
		sum[1] = (float)(sum[1] + op->normal * n.y);
		sum[2] = (float)(sum[2] + op->normal * n.z);
	}
}

static void
add_pd(
    const struct bake_combine_op *op, const float *row, int width, float *sum)
{
	for (int x = 0; x < width; x++, row += 4, sum += 3) {
		const struct vec t = tangents(layer_normal(op, row));

		sum[0] = (float)(sum[0] + op->su * t.x);
		sum[1] = (float)(sum[1] + op->sv * t.y);
	}
}

/* b over a, see the header. */
static inline struct vec
fold(enum bake_normal_blend blend, struct vec a, struct vec b)
{
	struct vec n = { a.x + b.x, a.y + b.y, a.z };

	if (blend == BAKE_NORMAL_WHITEOUT) {
		n.z = a.z * b.z;
	} else if (blend == BAKE_NORMAL_RNM) {
		/* a.z >= 0, so that t.z >= 1 */
		const double tz = a.z + 1;
		const double k = (tz * b.z - a.x * b.x - a.y * b.y) / tz;

		n.x = a.x * k + b.x;
		n.y = a.y * k + b.y;
		n.z = tz * k - b.z;
	}
	return unit(n);
}

static void
add_fold(
    const struct bake_combine_op *op, const float *row, int width, float *sum)
{
	for (int x = 0; x < width; x++, row += 4, sum += 3) {
		struct vec b = layer_normal(op, row);

		b.x *= op->su;
		b.y *= op->sv;
		b = unit(b);
		if (!op->first) {
			const struct vec a = { sum[0], sum[1], sum[2] };

			b = fold(op->normal_blend, a, b);
		}
		sum[0] = (float)b.x;
		sum[1] = (float)b.y;
		sum[2] = (float)b.z;
	}
}

static void
add_normals(
    const struct bake_combine_op *op, const float *row, int width, float *sum)
{
	if (op->copy)
		for (int x = 0; x < width; x++) {
			sum[3 * x] = row[4 * x];
			sum[3 * x + 1] = row[4 * x + 1];
		}
	else if (op->normal_blend == BAKE_NORMAL_SEED)
		add_seed(op, row, width, sum);
	else if (op->normal_blend == BAKE_NORMAL_PD)
		add_pd(op, row, width, sum);
	else
		add_fold(op, row, width, sum);
}

void
bake_combine_row(const struct bake_combine_op *op, const float *row, int width,
    float *normal, float *ao, float *depth)
{
	if (normal != NULL && op->normal > 0)
		add_normals(op, row, width, normal);
	if (ao != NULL && op->ao_blend == BAKE_AO_MULTIPLY)
		for (int x = 0; x < width; x++)
			ao[x] *= row[4 * x + 2];
	else if (ao != NULL)
		for (int x = 0; x < width; x++)
			ao[x] = row[4 * x + 2] < ao[x] ? row[4 * x + 2] : ao[x];
	if (op->depth > 0)
		for (int x = 0; x < width; x++)
			depth[x] =
			    (float)(depth[x] + op->depth * row[4 * x + 3]);
}

void
bake_combine_unit(
    enum bake_normal_blend blend, bool copied, float *normal, int width)
{
	for (int x = 0; x < width; x++, normal += 3) {
		struct vec n = { normal[0], normal[1], normal[2] };

		if (copied) {
			n = from_codes(normal);
		} else {
			if (blend == BAKE_NORMAL_PD)
				n.z = 1;
			n = unit(n);
			normal[0] = (float)((n.x + 1) / 2);
			normal[1] = (float)((n.y + 1) / 2);
		}
		normal[2] = (float)((n.z + 1) / 2);
	}
}
