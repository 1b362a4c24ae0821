/* Contact sheets: relief textures as pictures for people to look at. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_SHEET_H
#define BAKE_SHEET_H

#include "image.h"
#include "inspect.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Largest width of a panel; the gap around panels, in pixels. */
enum { BAKE_SHEET_PANEL = 512, BAKE_SHEET_GAP = 4 };

/*
 * One row of a contact sheet: the normals with z as colours (n + 1) / 2, the
 * AO, the relief map as stored, and the relief lit from the upper left
 *     L = (0.2 + 0.8 max(0, n . l)) AO,  l = (-1, 1, 1.2) / |.|
 * shown as sqrt(L), for a display's gamma. A map that is missing leaves its
 * panel grey; without AO L has AO = 1.
 *
 *   maps    at least one map; all maps are brought to the size of the panels:
 *           that of the relief (else normal, else AO) map, reduced to
 *           BAKE_SHEET_PANEL wide where it is wider, in proportion
 *   y_down  the normals' y points down
 *   row     out: 3 channels 0 .. 1; BAKE_IMAGE_INIT before, the caller's
 *
 * BAKE_EINVAL  no map
 * BAKE_ENOMEM  no memory; row is then BAKE_IMAGE_INIT
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_sheet_row(const struct bake_maps *maps,
    bool y_down, struct bake_image *row, struct bake_err *err);

/*
 * n rows, 3 channels each, one below the other on a dark ground.
 * BAKE_EINVAL: no row; BAKE_ENOMEM: no memory. sheet as row above.
 */
BAKE_API enum bake_status bake_sheet_stack(const struct bake_image *row, int n,
    struct bake_image *sheet, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
