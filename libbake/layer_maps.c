/* Sets of multilayer textures: allocation, and how many layers a texel has. */
/* SPDX-License-Identifier: MIT */
#include "layer_maps.h"

#include <stdlib.h>
#include <string.h>

#include "layer_priv.h"
#include "mem.h"

/* Every texel becomes value, in all its channels. */
static enum bake_status
fill(struct bake_pixels *px, float value, struct bake_err *err)
{
	const size_t row = (size_t)px->width * (size_t)px->nchans *
			   bake_data_format_size(px->format);
	float *texel = bake_alloc((size_t)px->nchans, sizeof *texel, err);

	if (texel == NULL)
		return BAKE_ENOMEM;
	for (int c = 0; c < px->nchans; c++)
		texel[c] = value;
	for (int x = 0; x < px->width; x++)
		bake_pixels_put(px, x, 0, 1, texel);
	for (int y = 1; y < px->height; y++)
		memcpy((char *)px->data + (size_t)y * row, px->data, row);
	free(texel);
	return BAKE_OK;
}

static enum bake_status
make(struct bake_pixels *px, const struct bake_layer_maps *maps, int nchans,
    enum bake_data_format format, float value, struct bake_err *err)
{
	enum bake_status rc = bake_pixels_alloc(
	    px, maps->width, maps->height, nchans, format, err);

	return rc == BAKE_OK ? fill(px, value, err) : rc;
}

enum bake_status
bake_layer_maps_alloc(struct bake_layer_maps *maps, int width, int height,
    int nlayers, enum bake_data_format format, int ncolors, int color_chans,
    enum bake_data_format color_format, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;

	*maps = (struct bake_layer_maps)BAKE_LAYER_MAPS_INIT;
	if (nlayers < 1 || nlayers > BAKE_LAYERS_MAX ||
	    (nlayers > 1 && nlayers % 2 != 0))
		return bake_fail(err, BAKE_EINVAL,
		    "%d layers, expected 1 or an even number up to %d", nlayers,
		    BAKE_LAYERS_MAX);
	if (ncolors < 0 || ncolors > nlayers)
		return bake_fail(err, BAKE_EINVAL,
		    "%d colour maps, expected 0 to %d, one a layer", ncolors,
		    nlayers);
	if (ncolors > 0 && color_chans != 3 && color_chans != 4)
		return bake_fail(err, BAKE_EINVAL,
		    "%d colour channels, expected 3 or 4", color_chans);
	maps->width = width;
	maps->height = height;
	maps->nlayers = nlayers;
	maps->ntextures = (nlayers + 3) / 4;
	maps->ncolors = ncolors;
	maps->color_linear =
	    color_format == BAKE_DATA_HALF || color_format == BAKE_DATA_FLOAT;
	for (int i = 0; i < maps->ntextures && rc == BAKE_OK; i++) {
		rc = make(&maps->depth[i], maps, 4, format, 1, err);
		if (rc == BAKE_OK)
			rc = make(&maps->nx[i], maps, 4, format, 0.5f, err);
		if (rc == BAKE_OK)
			rc = make(&maps->ny[i], maps, 4, format, 0.5f, err);
	}
	for (int i = 0; i < ncolors && rc == BAKE_OK; i++)
		rc = make(
		    &maps->color[i], maps, color_chans, color_format, 0, err);
	if (rc != BAKE_OK)
		bake_layer_maps_free(maps);
	return rc;
}

void
bake_layer_maps_free(struct bake_layer_maps *maps)
{
	for (int i = 0; i < maps->ntextures; i++) {
		bake_pixels_free(&maps->depth[i]);
		bake_pixels_free(&maps->nx[i]);
		bake_pixels_free(&maps->ny[i]);
	}
	for (int i = 0; i < maps->ncolors; i++)
		bake_pixels_free(&maps->color[i]);
	*maps = (struct bake_layer_maps)BAKE_LAYER_MAPS_INIT;
}

int
bake_layer_codes_of(
    const struct bake_layer_maps *maps, size_t t, uint32_t *code)
{
	const uint32_t none = bake_layer_none(maps->depth[0].format);

	for (int i = 0; i < maps->nlayers; i++) {
		const uint32_t c =
		    bake_pixels_code(&maps->depth[i / 4], 4 * t + i % 4);

		if (c >= none)
			return i;
		if (code != NULL)
			code[i] = c;
	}
	return maps->nlayers;
}

int
bake_layer_count(const struct bake_layer_maps *maps, int x, int y)
{
	return bake_layer_codes_of(
	    maps, (size_t)y * (size_t)maps->width + (size_t)x, NULL);
}
