/* Horizons of a height field: the rays and the plain march. */
/* SPDX-License-Identifier: MIT */
#include "horizon_priv.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static void
turn_round(struct bake_horizon_dir *dir)
{
	dir->cos_phi = 0 - dir->cos_phi; /* not -0 */
	dir->sin_phi = 0 - dir->sin_phi;
	dir->major = -dir->major;
	dir->minor = 0 - dir->minor;
}

void
bake_horizon_dir_init(struct bake_horizon_dir *dir, int j, int n, int width,
    int height, double radius, int periods)
{
	/* opposite directions are so to the last bit */
	const bool turned = n % 2 == 0 && j >= n / 2;
	const double phi = 2 * pi * (turned ? j - n / 2 : j) / n;
	double c = cos(phi), s = sin(phi);

	if (fabs(c) < 1e-12)
		c = 0;
	if (fabs(s) < 1e-12)
		s = 0;
	dir->cos_phi = c;
	dir->sin_phi = s;
	dir->x_major = fabs(c) >= fabs(s);
	if (dir->x_major) {
		dir->major = c > 0 ? 1 : -1;
		dir->minor = -s / fabs(c);
	} else {
		dir->major = s > 0 ? -1 : 1;
		dir->minor = c / fabs(s);
	}
	dir->pitch = sqrt(1 + dir->minor * dir->minor);
	if (radius > 0)
		dir->nsteps = (long)floor(radius * width / dir->pitch);
	else
		dir->nsteps = (long)periods * (dir->x_major ? width : height);
	if (turned)
		turn_round(dir);
}

struct bake_horizon_step
bake_horizon_step(const struct bake_horizon_dir *dir, long k)
{
	struct bake_horizon_step st;
	double minor = (double)k * dir->minor, whole = floor(minor);
	double frac = minor - whole, dist = (double)k * dir->pitch;

	/* a sample within rounding of a texel is at the texel: the tables of
	 * the fast march then hold all texels that have a weight */
	if (frac > 1 - BAKE_HORIZON_SNAP) {
		whole++;
		frac = 0;
	} else if (frac < BAKE_HORIZON_SNAP) {
		frac = 0;
	}
	st.dx = dir->x_major ? k * dir->major : (long)whole;
	st.dy = dir->x_major ? (long)whole : k * dir->major;
	st.w0 = (float)((1 - frac) / dist);
	st.w1 = (float)(frac / dist);
	return st;
}

static float
height_at(
    const struct bake_image *heights, struct bake_wrap wrap, long x, long y)
{
	return bake_image_row(heights,
	    bake_wrap_index(y, heights->height, wrap.clamp_v))[bake_wrap_index(
	    x, heights->width, wrap.clamp_u)];
}

float
bake_horizon_march(const struct bake_image *heights, struct bake_wrap wrap,
    const struct bake_horizon_dir *dir, int x, int y)
{
	const float h = height_at(heights, wrap, x, y);
	float best = 0;

	for (long k = 1; k <= dir->nsteps; k++) {
		const struct bake_horizon_step st = bake_horizon_step(dir, k);
		const long px = x + st.dx, py = y + st.dy;
		const float h0 = height_at(heights, wrap, px, py);
		const float h1 = height_at(
		    heights, wrap, px + !dir->x_major, py + dir->x_major);
		const float slope = st.w0 * (h0 - h) + st.w1 * (h1 - h);

		if (slope > best)
			best = slope;
	}
	return best;
}
