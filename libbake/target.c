/* Targets: what each renderer reads, file by file and channel by channel. */
/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "relief.h"

#define NX BAKE_SOURCE_NORMAL_X
#define NY BAKE_SOURCE_NORMAL_Y
#define NZ BAKE_SOURCE_NORMAL_Z
#define AO BAKE_SOURCE_AO
#define RELIEF BAKE_SOURCE_RELIEF
#define ZERO BAKE_SOURCE_ZERO
#define HALF BAKE_SOURCE_HALF
#define ONE BAKE_SOURCE_ONE

#define FILE_PACKED                                                            \
	{                                                                      \
		"", BAKE_LAYOUT_RELIEF, 4,                                     \
		{                                                              \
			NX, NY, AO, RELIEF                                     \
		}                                                              \
	}
#define FILE_NORMAL_RELIEF                                                     \
	{                                                                      \
		"", BAKE_LAYOUT_NORMAL_RELIEF, 4,                              \
		{                                                              \
			NX, NY, NZ, RELIEF                                     \
		}                                                              \
	}
#define FILE_NORMAL                                                            \
	{                                                                      \
		"", BAKE_LAYOUT_NORMAL, 3,                                     \
		{                                                              \
			NX, NY, NZ                                             \
		}                                                              \
	}
#define FILE_RELIEF(suffix)                                                    \
	{                                                                      \
		suffix, BAKE_LAYOUT_DEPTH, 1,                                  \
		{                                                              \
			RELIEF                                                 \
		}                                                              \
	}
#define FILE_AO                                                                \
	{                                                                      \
		"_ao", BAKE_LAYOUT_AO, 1,                                      \
		{                                                              \
			AO                                                     \
		}                                                              \
	}
/* roughness 1 and metallic 0 where there is nothing to say */
#define FILE_ORM                                                               \
	{                                                                      \
		"_orm", BAKE_LAYOUT_ORM, 3,                                    \
		{                                                              \
			AO, ONE, ZERO                                          \
		}                                                              \
	}

#define DEPTH BAKE_POLARITY_DEPTH
#define HEIGHT BAKE_POLARITY_HEIGHT
#define UP BAKE_NORMAL_Y_UP
#define DOWN BAKE_NORMAL_Y_DOWN

static const struct bake_target targets[] = {
	{ "relief", "RG normal, B AO, A depth; the papers' packed texture",
	    DEPTH, UP, 1, { FILE_PACKED } },
	{ "policarpo", "the same with normal y down, for Policarpo's shaders",
	    DEPTH, DOWN, 1, { FILE_PACKED } },
	{ "quake3", "RGB normal, A height (ioquake3 renderer2)", HEIGHT, UP, 1,
	    { FILE_NORMAL_RELIEF } },
	{ "darkplaces", "RGB normal, A height (_norm textures)", HEIGHT, UP, 1,
	    { FILE_NORMAL_RELIEF } },
	{ "unity-hdrp", "normal, _height, _mask (G = AO)", HEIGHT, UP, 3,
	    { FILE_NORMAL, FILE_RELIEF("_height"),
		{ "_mask", BAKE_LAYOUT_MASK, 4, { ZERO, AO, ZERO, HALF } } } },
	{ "unreal", "normal with y down, _height, _orm (R = AO)", HEIGHT, DOWN,
	    3, { FILE_NORMAL, FILE_RELIEF("_height"), FILE_ORM } },
	{ "godot", "normal, _height, _orm (R = AO)", HEIGHT, UP, 3,
	    { FILE_NORMAL, FILE_RELIEF("_height"), FILE_ORM } },
	{ "bevy", "normal, _depth (black = highest), _ao", DEPTH, UP, 3,
	    { FILE_NORMAL, FILE_RELIEF("_depth"), FILE_AO } },
	{ "three", "normal, _height (displacementMap), _ao (aoMap)", HEIGHT, UP,
	    3, { FILE_NORMAL, FILE_RELIEF("_height"), FILE_AO } },
	{ "babylon", "RGB normal, A height (bump texture), _ao", HEIGHT, UP, 2,
	    { FILE_NORMAL_RELIEF, FILE_AO } },
	{ "gltf", "normal, _orm (R = AO), _depth (for extras)", DEPTH, UP, 3,
	    { FILE_NORMAL, FILE_ORM, FILE_RELIEF("_depth") } },
};

const struct bake_target *
bake_targets(int *n)
{
	*n = (int)(sizeof targets / sizeof *targets);
	return targets;
}

const struct bake_target *
bake_target_find(const char *name)
{
	for (size_t i = 0; i < sizeof targets / sizeof *targets; i++)
		if (strcmp(targets[i].name, name) == 0)
			return &targets[i];
	return NULL;
}
