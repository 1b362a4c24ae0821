/* What relief.c and relief_layers.c share: the metadata of layers. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_RELIEF_PRIV_H
#define BAKE_RELIEF_PRIV_H

#include "relief.h"

/* The part of bake_relief_meta_to_attrs and _from_attrs that is about layers:
 * nothing where there are none. */
void bake_layer_meta_to_attrs(
    const struct bake_layer_meta *meta, struct bake_attrs *attrs);
void bake_layer_meta_from_attrs(
    struct bake_layer_meta *meta, const struct bake_attrs *attrs);

#endif
