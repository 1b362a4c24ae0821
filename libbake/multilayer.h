/* Multilayer relief: a closed mesh as depth, normal and colour textures. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MULTILAYER_H
#define BAKE_MULTILAYER_H

#include "abuffer.h"
#include "color.h"
#include "layer_codes.h"
#include "layer_maps.h"
#include "layer_surface.h"
#include "parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 *   nlayers    the most layers of a texel, 2 .. BAKE_LAYERS_MAX, even; 0: as
 *              many as the deepest texel has
 *   ncolors    how many layers get a colour, 0 .. nlayers
 *   coverage   colours have a fourth channel: 1 where the texel has a layer
 *   color      for encoding colours as sRGB in integer formats; half and float
 *              colours are scene-linear. Not NULL where ncolors > 0
 */
struct bake_multilayer_params {
	struct bake_view view;
	struct bake_abuffer_params rays;
	struct bake_surface_params surface;
	enum bake_data_format format;
	enum bake_cap_policy policy;
	int nlayers, ncolors;
	bool coverage;
	const struct bake_color *color;
	int nthreads; /* 0 = all processors */
	struct bake_progress progress;
};

/*
 * What was found, in texels of the picture.
 *   histogram  [n] how many texels have n layers; those with more than
 *              BAKE_LAYERS_MAX (of an uncapped picture) in the last
 *   nlayers    the most layers that a texel may have in the maps
 */
struct bake_multilayer_stats {
	struct bake_abuffer_stats rays;
	struct bake_layer_stats codes;
	size_t histogram[BAKE_LAYERS_MAX + 1];
	int nlayers;
};

struct bake_multilayer; /* a mesh made ready */

/*
 * Make a mesh ready to be sampled: orthographic rays through texel centres,
 * entry, exit, entry, exit … of the solid that the closed mesh bounds.
 *
 *   mesh, weld  not modified, must outlive it; so must what params points to
 *   ml          out: the caller closes it; NULL on failure
 *
 * Errors: those of bake_abuffer_open and bake_surface_open, and
 * BAKE_EINVAL  nlayers or ncolors is outside its range
 *
 * Source: Policarpo and Oliveira, 'Relief Mapping of Non-Height-Field Surface
 * Details', 2006, sections 3 and 5.
 */
BAKE_API enum bake_status bake_multilayer_open(struct bake_multilayer **ml,
    const struct bake_mesh *mesh, const struct bake_weld *weld,
    const struct bake_multilayer_params *params, struct bake_err *err);
BAKE_API void bake_multilayer_close(struct bake_multilayer *ml); /* NULL: ok */

/*
 * Sample all texels into textures. A mesh that does not close is no error
 * here: stats->rays.open and .inside_out count the texels, and the maps are
 * then of no use.
 *
 *   maps   out: BAKE_LAYER_MAPS_INIT before, the caller frees it
 *   stats  out
 *
 * BAKE_ELIMIT  nlayers is 0 and a texel has more than BAKE_LAYERS_MAX
 * BAKE_ENOMEM  no memory; on any failure maps is BAKE_LAYER_MAPS_INIT
 *
 * Memory beyond mesh and maps: a few MiB for each thread's band of
 * BAKE_BAND_ROWS rows. The same bytes for every thread count.
 */
BAKE_API enum bake_status bake_multilayer_maps(struct bake_multilayer *ml,
    struct bake_layer_maps *maps, struct bake_multilayer_stats *stats,
    struct bake_err *err);

/* Triangles whose material has a texture, but which have no UVs: they have the
 * material's colour alone. */
BAKE_API size_t bake_multilayer_missing_uvs(const struct bake_multilayer *ml);

/* The most layers of a texel, none capped. BAKE_ENOMEM: no memory. */
BAKE_API enum bake_status bake_multilayer_deepest(
    struct bake_multilayer *ml, int *nlayers, struct bake_err *err);

/*
 * Every layer of a band of rows, neither capped nor quantised, as a deep image
 * wants them: texel by texel, near to far. Depths are d, clamped to 0 .. 1, and
 * strictly increasing as floats in a texel; slabs that touch or overlap as
 * floats have become one.
 *
 *   count   [nrows * width] layers of each texel
 *   depth, normal, color  [nsamples]; normals in the view's axes; colours r g b
 *           a in scene-linear light, NULL where params.ncolors is 0
 */
struct bake_deep_rows {
	int y0, nrows;
	size_t nsamples;
	unsigned *count;
	float *depth;
	float (*normal)[3];
	float (*color)[4];
};
#define BAKE_DEEP_ROWS_INIT                                                    \
	{                                                                      \
		.count = NULL                                                  \
	}
BAKE_API void bake_deep_rows_free(struct bake_deep_rows *rows);

/*
 * Fill rows y0 .. y0 + nrows - 1. rows: BAKE_DEEP_ROWS_INIT before. stats:
 * added to. Threads may do different bands, with stats of their own.
 *
 * BAKE_ENOMEM  no memory; rows is then BAKE_DEEP_ROWS_INIT
 */
BAKE_API enum bake_status bake_multilayer_deep(const struct bake_multilayer *ml,
    int y0, int nrows, struct bake_deep_rows *rows,
    struct bake_multilayer_stats *stats, struct bake_err *err);

/* Add the counts of one part of the picture to those of another. */
BAKE_API void bake_multilayer_stats_add(struct bake_multilayer_stats *sum,
    const struct bake_multilayer_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
