/* Horizon ambient occlusion by brute force in double precision. */
/* SPDX-License-Identifier: MIT */
#ifndef AO_ORACLE_H
#define AO_ORACLE_H

/* Written from the definition alone (libbake/ao.h, top comment), shares no
 * code with libbake, and makes no attempt at speed. */
#include <math.h>

struct ao_oracle {
	const float *depth; /* [height][width] */
	int width, height;
	int clamp_u, clamp_v;
	int ndirs;
	double scale, radius; /* radius 0: by periods */
	int periods;
};

static inline double
ao_oracle_height(const struct ao_oracle *o, long x, long y)
{
	if (o->clamp_u)
		x = x < 0 ? 0 : x >= o->width ? o->width - 1 : x;
	if (o->clamp_v)
		y = y < 0 ? 0 : y >= o->height ? o->height - 1 : y;
	x = (x % o->width + o->width) % o->width;
	y = (y % o->height + o->height) % o->height;
	return 1 - (double)o->depth[y * o->width + x];
}

/* tan e_j of texel (x, y) */
static inline double
ao_oracle_tan(const struct ao_oracle *o, int j, int x, int y)
{
	const double phi = 2 * 3.14159265358979323846 * j / o->ndirs;
	double dx = cos(phi), dy = -sin(phi), best = 0; /* rows go down */

	dx = fabs(dx) < 1e-12 ? 0 : dx;
	dy = fabs(dy) < 1e-12 ? 0 : dy;
	const int x_major = fabs(dx) >= fabs(dy);
	const double major = fmax(fabs(dx), fabs(dy));
	const double step_x = dx / major, step_y = dy / major; /* one is +-1 */
	const double pitch = sqrt(step_x * step_x + step_y * step_y);
	const long nsteps =
	    o->radius > 0 ? (long)floor(o->radius * o->width / pitch)
			  : (long)o->periods * (x_major ? o->width : o->height);

	for (long k = 1; k <= nsteps; k++) {
		/* the sign alone, so that the major axis stays on texels */
		double px = x + (x_major ? (dx > 0 ? k : -k) : k * step_x);
		double py = y + (x_major ? k * step_y : (dy > 0 ? k : -k));
		long ix = (long)floor(px), iy = (long)floor(py);
		double f = x_major ? py - iy : px - ix;
		double h = (1 - f) * ao_oracle_height(o, ix, iy) +
			   f * ao_oracle_height(o, ix + !x_major, iy + x_major);

		best =
		    fmax(best, (h - ao_oracle_height(o, x, y)) / (k * pitch));
	}
	return o->scale * o->width * best;
}

/* tans[ndirs] of texel (x, y); returns whether one is above 0 */
static inline int
ao_oracle_tans(const struct ao_oracle *o, int x, int y, double *tans)
{
	int any = 0;

	for (int j = 0; j < o->ndirs; j++)
		any |= (tans[j] = ao_oracle_tan(o, j, x, y)) > 0;
	return any;
}

static inline double
ao_oracle_ao(const struct ao_oracle *o, const double *tans, int mean)
{
	double sum = 0;

	for (int j = 0; j < o->ndirs; j++) {
		double a = tans[j], b = mean ? a : tans[(j + 1) % o->ndirs];

		sum += 1 / sqrt(1 + a * a) / sqrt(1 + b * b);
	}
	return sum / o->ndirs;
}

static inline void
ao_oracle_bent(const struct ao_oracle *o, const double *tans, double v[3])
{
	double len;

	v[0] = v[1] = v[2] = 0;
	for (int j = 0; j < o->ndirs; j++) {
		double phi = 2 * 3.14159265358979323846 * j / o->ndirs;
		double e = atan(tans[j]);

		v[0] += pow(cos(e), 3) / 3 * cos(phi);
		v[1] += pow(cos(e), 3) / 3 * sin(phi);
		v[2] += (1 - pow(sin(e), 3)) / 3;
	}
	len = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	for (int c = 0; c < 3; c++)
		v[c] /= len;
}

#endif
