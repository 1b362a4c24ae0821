/* A row of a mip level: layers, and the means of their normals and colours. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>

#include "layer_mip_priv.h"
#include "mem.h"

void
bake_mip_row_free(struct bake_mip_row *row)
{
	bake_stack_free(&row->stack);
	free(row->n);
	free(row->layer);
	free(row->color);
	free(row->height);
	free(row->texels);
	*row = (struct bake_mip_row){ .n = NULL };
}

enum bake_status
bake_mip_row_alloc(
    struct bake_mip_row *row, const struct bake_mip *m, struct bake_err *err)
{
	const size_t w = (size_t)m->out->width, full = (size_t)m->maps->width;
	const size_t nlayers = (size_t)m->maps->nlayers;
	const size_t ncolors = (size_t)m->maps->ncolors;
	const size_t nimages = 2 * (size_t)m->maps->ntextures + ncolors;

	*row = (struct bake_mip_row){ .n = NULL };
	row->n = bake_alloc(w, sizeof *row->n, err);
	row->layer = bake_alloc(w, nlayers * sizeof *row->layer, err);
	row->color = bake_alloc(w, ncolors * sizeof *row->color, err);
	row->height = bake_alloc(w, sizeof *row->height, err);
	row->texels = bake_alloc(full, nimages * 4 * sizeof(float), err);
	return row->n == NULL || row->layer == NULL || row->color == NULL ||
		       row->height == NULL || row->texels == NULL
		   ? BAKE_ENOMEM
		   : BAKE_OK;
}

/* Where the values of texel x of the row's image k begin. */
static float *
texel_of(const struct bake_mip_row *row, const struct bake_mip *m, int k, int x)
{
	return row->texels +
	       4 * ((size_t)k * (size_t)m->maps->width + (size_t)x);
}

/* The layers of the level's row, their depths put, nothing summed yet. */
static enum bake_status
solve_row(struct bake_mip_row *row, const struct bake_mip *m, int y,
    struct bake_err *err)
{
	const int most = m->maps->nlayers;
	struct bake_stack *s = &row->stack;
	struct bake_layer_sum *sum = row->layer;
	size_t texel = (size_t)y * (size_t)m->out->width;

	for (int x = 0; x < m->out->width; x++, texel++, sum += most) {
		if (bake_stack_gather(s, m->maps, bake_mip_box(m, x, y), err) !=
			BAKE_OK ||
		    bake_stack_solve(s, m->t, most, err) != BAKE_OK)
			return BAKE_ENOMEM;
		row->n[x] = (int)s->nlayers;
		row->capped += s->capped;
		for (size_t i = 0; i < s->nlayers; i++) {
			const uint32_t code = s->layer[i].code;
			const uint64_t p = bake_layer_place(code, m->format);

			sum[i] = (struct bake_layer_sum){ .code = code,
				.reach = s->reach[i] };
			bake_pixels_set_code(
			    &m->out->depth[i / 4], 4 * texel + i % 4, code);
			/* modulo 2^64, which comes right at the exit */
			row->volume += (i % 2 ? p : -p) * s->ntexels;
		}
	}
	return BAKE_OK;
}

/* -- summing --------------------------------------------------------------- */

/* Row y of level 0 as floats, its colours scene-linear. */
static enum bake_status
read_row(struct bake_mip_row *row, const struct bake_mip *m, int y,
    struct bake_err *err)
{
	const struct bake_layer_maps *maps = m->maps;
	const int w = maps->width;
	enum bake_status rc = BAKE_OK;

	for (int t = 0; t < maps->ntextures; t++) {
		bake_pixels_get(
		    &maps->nx[t], 0, y, w, texel_of(row, m, 2 * t, 0));
		bake_pixels_get(
		    &maps->ny[t], 0, y, w, texel_of(row, m, 2 * t + 1, 0));
	}
	for (int i = 0; i < maps->ncolors && rc == BAKE_OK; i++) {
		struct bake_image img = { w, 1, maps->color[i].nchans,
			(size_t)w * (size_t)maps->color[i].nchans,
			texel_of(row, m, 2 * maps->ntextures + i, 0) };

		bake_pixels_get(&maps->color[i], 0, y, w, img.data);
		if (m->color != NULL)
			rc = bake_color_to_linear(
			    m->color, "sRGB", &img, 1, err);
	}
	return rc;
}

/* Which of a texel's n layers a level-0 layer of that parity has a part in, and
 * its weight there, 0 for none. */
static double
weight_of(const struct bake_layer_sum *sum, int n, int parity, uint32_t code,
    enum bake_data_format format, int *layer)
{
	uint64_t a, b;
	double d;
	int i = parity;

	while (i + 1 < n && code >= sum[i + 1].code)
		i += 2;
	if (i >= n || (i > 0 && code < sum[i - 1].code))
		return 0;
	*layer = i;
	a = bake_layer_place(code, format);
	b = bake_layer_place(sum[i].code, format);
	d = (double)(a > b ? a - b : b - a);
	if (d == 0)
		return 1;
	return d < sum[i].reach ? 1 - d / sum[i].reach : 0;
}

/* A normal from its stored x and y; z by the parity. */
static void
normal_of(float nx, float ny, int parity, double normal[3])
{
	const double x = 2 * (double)nx - 1, y = 2 * (double)ny - 1;
	const double zz = 1 - x * x - y * y, z = zz > 0 ? sqrt(zz) : 0;

	normal[0] = x;
	normal[1] = y;
	normal[2] = parity ? -z : z;
}

/* The layers of level-0 texel x, which has n. */
static void
add_layers(const struct bake_mip_row *row, const struct bake_mip *m,
    struct bake_layer_sum *sums, int nsums, int x, const uint32_t *code, int n)
{
	const int colors = 2 * m->maps->ntextures;

	for (int i = 0; i < n; i++) {
		int k = 0;
		const double w =
		    weight_of(sums, nsums, i % 2, code[i], m->format, &k);
		struct bake_layer_sum *sum = &sums[k];
		double normal[3];
		const float *rgb;

		if (w == 0)
			continue;
		normal_of(texel_of(row, m, 2 * (i / 4), x)[i % 4],
		    texel_of(row, m, 2 * (i / 4) + 1, x)[i % 4], i % 2, normal);
		for (int c = 0; c < 3; c++)
			sum->normal[c] += w * normal[c];
		if (m->maps->ncolors < 2 || i >= m->maps->ncolors)
			continue;
		rgb = texel_of(row, m, colors + i, 0) +
		      (size_t)x * (size_t)m->maps->color[i].nchans;
		for (int c = 0; c < 3; c++)
			sum->rgb[c] += w * (double)rgb[c];
		sum->weight += w;
	}
}

/* The colours of level-0 texel x, which has n layers. */
static void
add_colors(const struct bake_mip_row *row, const struct bake_mip *m,
    struct bake_color_sum *sums, int x, int n)
{
	for (int i = 0; i < m->maps->ncolors; i++) {
		const int nchans = m->maps->color[i].nchans;
		const float *v =
		    texel_of(row, m, 2 * m->maps->ntextures + i, 0);

		v += (size_t)x * (size_t)nchans;
		if (nchans == 4)
			sums[i].alpha += (double)v[3];
		if (i >= n)
			continue;
		for (int c = 0; c < 3; c++)
			sums[i].rgb[c] += (double)v[c];
		sums[i].n++;
	}
}

/* The depth and slope of level-0 texel x of a height field. */
static void
add_height(const struct bake_mip_row *row, const struct bake_mip *m,
    struct bake_height_sum *sum, int x, uint32_t code)
{
	const double flattest = 1.0 / 256;
	double n[3];

	normal_of(texel_of(row, m, 0, x)[0], texel_of(row, m, 1, x)[0], 0, n);
	if (n[2] < flattest)
		n[2] = flattest;
	sum->depth += (double)bake_layer_value(code, m->format);
	sum->slope[0] += n[0] / n[2];
	sum->slope[1] += n[1] / n[2];
	sum->n++;
}

/* Add row y0 of level 0. */
static void
add_row(struct bake_mip_row *row, const struct bake_mip *m, int y0)
{
	const struct bake_layer_maps *maps = m->maps;
	const size_t first = (size_t)y0 * (size_t)maps->width;
	uint32_t code[BAKE_LAYERS_MAX];

	for (int x = 0; x < m->out->width; x++) {
		const struct bake_box b = bake_mip_box(m, x, 0);
		const size_t at = (size_t)x;

		for (int x0 = b.x0; x0 < b.x1; x0++) {
			const int n =
			    bake_layer_codes_of(maps, first + (size_t)x0, code);

			add_colors(row, m,
			    row->color + at * (size_t)maps->ncolors, x0, n);
			if (maps->nlayers > 1)
				add_layers(row, m,
				    row->layer + at * (size_t)maps->nlayers,
				    row->n[x], x0, code, n - n % 2);
			else if (n > 0)
				add_height(
				    row, m, &row->height[x], x0, code[0]);
		}
	}
}

/* -- the results ----------------------------------------------------------- */

static void
put_normal(
    const struct bake_mip *m, int layer, int x, int y, const double normal[3])
{
	const size_t at = 4 * ((size_t)y * (size_t)m->out->width + (size_t)x) +
			  (size_t)(layer % 4);
	const double len = sqrt(normal[0] * normal[0] + normal[1] * normal[1] +
				normal[2] * normal[2]);
	struct bake_pixels *const to[2] = { &m->out->nx[layer / 4],
		&m->out->ny[layer / 4] };

	for (int c = 0; c < 2; c++) {
		const float v =
		    len > 0 ? (float)((normal[c] / len + 1) / 2) : 0.5f;
		struct bake_pixels one = *to[c];

		/* a channel by itself: as an image of one channel */
		one.nchans = 1;
		one.width = 1;
		one.data =
		    (char *)one.data + at * bake_data_format_size(one.format);
		bake_pixels_put(&one, 0, 0, 1, &v);
	}
}

static void
put_height(struct bake_mip_row *row, const struct bake_mip *m, int x, int y)
{
	const struct bake_height_sum *sum = &row->height[x];
	const uint64_t ntexels = bake_box_texels(bake_mip_box(m, x, y));
	const size_t at = 4 * ((size_t)y * (size_t)m->out->width + (size_t)x);
	const uint32_t none = bake_layer_none(m->format);
	float texel[4] = { 1, 1, 1, 1 };
	double n = (double)sum->n;

	row->n[x] = 0;
	if (2 * sum->n < ntexels)
		return;
	row->n[x] = 1;
	texel[0] = (float)(sum->depth / n);
	bake_pixels_put(&m->out->depth[0], x, y, 1, texel);
	/* up to rounding, a mean is not above what it is the mean of */
	if (bake_pixels_code(&m->out->depth[0], at) >= none)
		bake_pixels_set_code(&m->out->depth[0], at, none - 1);
	row->volume +=
	    ntexels *
	    (bake_layer_place(none, m->format) -
		bake_layer_place(
		    bake_pixels_code(&m->out->depth[0], at), m->format));
	put_normal(
	    m, 0, x, y, (double[3]){ sum->slope[0] / n, sum->slope[1] / n, 1 });
}

/* Colour image i of the row, in place of the first level-0 colours. */
static enum bake_status
put_colors(struct bake_mip_row *row, const struct bake_mip *m, int i, int y,
    struct bake_err *err)
{
	const struct bake_layer_maps *maps = m->maps;
	const int w = m->out->width, nchans = maps->color[i].nchans;
	struct bake_image img = { w, 1, nchans, (size_t)w * (size_t)nchans,
		texel_of(row, m, 2 * maps->ntextures, 0) };
	enum bake_status rc = BAKE_OK;

	for (int x = 0; x < w; x++) {
		const struct bake_color_sum *all =
		    row->color + (size_t)x * (size_t)maps->ncolors + i;
		const struct bake_layer_sum *own =
		    row->layer + (size_t)x * (size_t)maps->nlayers + i;
		float *v = img.data + (size_t)x * (size_t)nchans;
		const bool weighted =
		    maps->ncolors > 1 && i < row->n[x] && own->weight > 0;

		for (int c = 0; c < 3; c++)
			v[c] = weighted ? (float)(own->rgb[c] / own->weight)
			       : all->n > 0
				   ? (float)(all->rgb[c] / (double)all->n)
				   : 0;
		if (nchans == 4)
			v[3] = (float)(all->alpha / (double)bake_box_texels(
							bake_mip_box(m, x, y)));
	}
	if (m->color != NULL)
		rc = bake_color_from_linear(m->color, "sRGB", &img, 1, err);
	bake_pixels_put(&m->out->color[i], 0, y, w, img.data);
	return rc;
}

static void
clear(struct bake_mip_row *row, const struct bake_mip *m)
{
	const size_t w = (size_t)m->out->width;

	memset(
	    row->layer, 0, w * (size_t)m->maps->nlayers * sizeof *row->layer);
	memset(
	    row->color, 0, w * (size_t)m->maps->ncolors * sizeof *row->color);
	memset(row->height, 0, w * sizeof *row->height);
}

enum bake_status
bake_mip_row_make(struct bake_mip_row *row, const struct bake_mip *m, int y,
    struct bake_err *err)
{
	const struct bake_box b = bake_mip_box(m, 0, y);
	const bool height = m->maps->nlayers == 1;
	enum bake_status rc;

	clear(row, m);
	rc = height ? BAKE_OK : solve_row(row, m, y, err);
	for (int y0 = b.y0; y0 < b.y1 && rc == BAKE_OK; y0++) {
		rc = read_row(row, m, y0, err);
		if (rc == BAKE_OK)
			add_row(row, m, y0);
	}
	if (rc != BAKE_OK)
		return rc;
	for (int x = 0; x < m->out->width; x++) {
		const struct bake_layer_sum *sum =
		    row->layer + (size_t)x * (size_t)m->maps->nlayers;

		if (height)
			put_height(row, m, x, y);
		for (int i = 0; !height && i < row->n[x]; i++)
			put_normal(m, i, x, y, sum[i].normal);
	}
	for (int i = 0; i < m->maps->ncolors && rc == BAKE_OK; i++)
		rc = put_colors(row, m, i, y, err);
	return rc;
}
