/* Multilayer relief: what textures and deep rows share. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MULTILAYER_PRIV_H
#define BAKE_MULTILAYER_PRIV_H

#include "multilayer.h"

struct bake_multilayer {
	struct bake_multilayer_params params;
	struct bake_abuffer *rays;
	struct bake_surface *surface;
};

#endif
