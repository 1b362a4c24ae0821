/* What a texture is: its layout, its maps, and what contradicts its label. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_INSPECT_H
#define BAKE_INSPECT_H

#include "detect.h"
#include "relief.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * What texels say about themselves.
 *   layout      what the channels hold: as said, else guessed (guessed set)
 *   normals     stats are of signed components; has_normals: there are any
 *   has_relief  there is a relief map, in channel relief_channel
 *   seams       of the relief map, else of the normals, else of all channels
 *   nbad        values that are NaN or infinite
 */
struct bake_inspection {
	enum bake_layout layout;
	bool guessed, has_normals, has_relief;
	int relief_channel;
	struct bake_normal_stats normals;
	struct bake_seams seams;
	struct bake_detection detection;
	size_t nbad;
};

/* The maps that an image holds: BAKE_IMAGE_INIT where it has none, the
 * caller's to free with bake_maps_free. normal: 2 or 3 channels, signed, y as
 * stored; relief and ao: 1 channel, as stored. */
struct bake_maps {
	struct bake_image normal, relief, ao;
};
#define BAKE_MAPS_INIT                                                         \
	{                                                                      \
		BAKE_IMAGE_INIT, BAKE_IMAGE_INIT, BAKE_IMAGE_INIT              \
	}

BAKE_API void bake_maps_free(struct bake_maps *maps);

/*
 * What the channels of an image hold, by its texels alone:
 *   4 and more  NORMAL_RELIEF where (R, G, B) are unit normals and A is no
 *               constant; RELIEF where (R, G) alone lie in the unit disc (all
 *               but 0.1 %), A is no constant and half the texels are coloured;
 *               else as with 3
 *   3           NORMAL where (R, G, B) are normals (bake_normals_plausible);
 *               DEPTH where R = G = B within 2/255; else UNKNOWN
 *   1 and 2     DEPTH
 * rgba: the channels' places in R G B A order (cmd: by their names), those
 * that there are. code is not AUTO.
 *
 * BAKE_ENOMEM  a copy of the normals; *layout is then UNKNOWN
 */
BAKE_API enum bake_status bake_layout_guess(const struct bake_image *img,
    const int rgba[4], enum bake_normal_code code, enum bake_layout *layout,
    struct bake_err *err);

/*
 * Take the maps out of an image of the given layout: RELIEF gives all three,
 * NORMAL_RELIEF normal and relief, NORMAL the normal, DEPTH the relief from
 * relief_channel, AO the ao; others give none.
 *
 * BAKE_EDATA   the layout needs more channels than there are
 * BAKE_ENOMEM  no memory; on failure maps is BAKE_MAPS_INIT
 */
BAKE_API enum bake_status bake_maps_extract(struct bake_maps *maps,
    const struct bake_image *img, const int rgba[4], enum bake_layout layout,
    enum bake_normal_code code, int relief_channel, struct bake_err *err);

/* Relief values to a range: v := (v - near) / (far - near), near != far; does
 * nothing where maps has no relief. Reentrant. */
BAKE_API void bake_maps_set_range(
    struct bake_maps *maps, double near, double far);

/*
 * Fill out from maps: normals, detection, and the seams of the relief or of the
 * normals' x, y. A normal map of another size than the relief map is resampled
 * to it, as a torus unless wrap says otherwise. layout, guessed, relief_channel
 * and nbad are left alone, and so are the seams where maps has neither.
 *
 * BAKE_ENOMEM  no memory
 */
BAKE_API enum bake_status bake_inspect_maps(struct bake_inspection *out,
    const struct bake_maps *maps, struct bake_wrap wrap, struct bake_err *err);

/* One line each: 'the maps say height, declared is depth'. */
enum { BAKE_CONTRADICTIONS = 12, BAKE_CONTRADICTION = 128 };
struct bake_contradictions {
	int n;
	char text[BAKE_CONTRADICTIONS][BAKE_CONTRADICTION];
};

/* A declared depth scale contradicts where it lies beyond the interval that
 * the maps imply by this factor. */
#define BAKE_DEPTH_SCALE_FACTOR 2.0

/*
 * What contradicts: a sure polarity or normal Y that is not the declared one;
 * a depth scale off by more than BAKE_DEPTH_SCALE_FACTOR; a relief that does
 * not belong to the normals (pair and curl contradict); normals that are none
 * (more than 5 % with z < 0 or outside the unit disc, or a mean length
 * outside 0.5 .. 1.5); values that are not numbers. What is not declared (0,
 * UNSURE) contradicts nothing. Reentrant, cannot fail.
 */
BAKE_API void bake_contradictions_find(struct bake_contradictions *out,
    const struct bake_inspection *found, const struct bake_relief_meta *said);

#ifdef __cplusplus
}
#endif

#endif
