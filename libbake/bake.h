/* libbake: the textures of relief rendering, baked. All its headers. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_H
#define BAKE_H

#include "ao.h"
#include "ao_rescale.h"
#include "attrs.h"
#include "codes.h"
#include "color.h"
#include "combine.h"
#include "compare.h"
#include "conventions.h"
#include "dequantize.h"
#include "detect.h"
#include "err.h"
#include "gltf.h"
#include "image.h"
#include "inspect.h"
#include "integrate.h"
#include "io_image.h"
#include "mem.h"
#include "mesh.h"
#include "mesh_frame.h"
#include "normal.h"
#include "output.h"
#include "parallel.h"
#include "quadric.h"
#include "quadric_write.h"
#include "relief.h"
#include "repair.h"
#include "resample.h"
#include "roughen.h"
#include "roughen_picture.h"

#endif
