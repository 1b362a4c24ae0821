/* Built-in shapes: meshes with UVs and normals for reliefs to be shown on. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_SHAPE_H
#define BAKE_SHAPE_H

#include <stdbool.h>

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * All are closed but PLANE and TEAPOT, wound counterclockwise seen from
 * outside, with +y up, around the origin. UVs are 0..1; for who looks at the
 * outside with +y up, u grows to the right and v upwards: the normal is tangent
 * x bitangent everywhere, all handedness is +1.
 *   PLANE     the square -1..1 in x and z at y = 0, seen from +y; u along +x,
 *             v along -z
 *   CUBE      -1..1, each face with UVs 0..1: v along +y on the sides, along
 *             -z on +y, along +z on -y
 *   SPHERE    radius 1; u once round the y axis, v from the south pole to the
 *             north, in equal angles: (cos b sin a, sin b, cos b cos a) with
 *             a = 2 pi (u - 1/2), b = pi (v - 1/2); the seam is at -z
 *   CYLINDER  radius 1, y from -1 to 1; on its side u as on the sphere, v from
 *             -1 to 1; on the caps the picture lies flat, as on the cube
 *   TORUS     radii 1 and 0.4 round the y axis; u as on the sphere, v once
 *             round the tube, 0 on its inner side, 1/2 on its outer:
 *             ((1 + 0.4 cos b) sin a, 0.4 sin b, (1 + 0.4 cos b) cos a),
 *             b = 2 pi (v - 1/2)
 *   TEAPOT    the Utah teapot: Newell's 28 bicubic patches and the bottom's 4,
 *             each with UVs 0..1, so that a relief that tiles goes on from
 *             one to the next. On body, rim, lid and knob u goes a quarter
 *             round the y axis, counterclockwise seen from above, v up the
 *             profile: from the middle of the bottom over body and rim into
 *             the mouth, and from the lid's edge to the top of its knob. On
 *             spout and handle u goes half round the tube, counterclockwise
 *             seen from its upper end, from its upper to its lower or its
 *             outer to its inner side and back; v goes along it, upwards.
 *             Patches are not square, nor of one size: a relief is stretched
 *             as they are.
 *             Half the published size, y from -0.7875 to 0.7875, the body of
 *             radius 1, spout towards +x. Four surfaces, in this order: body
 *             with rim and bottom, lid, spout, handle. As published, the
 *             mouth is 0.05 wider than the lid; spout and handle go through
 *             the body's side and are open at their ends; the handle's lower
 *             end touches the body in one point, (-1, -0.3375, 0), which is
 *             one position.
 * Sources: Newell, 'The Utilization of Procedure Models in Digital Image
 * Synthesis', thesis, University of Utah, 1975; Crow, 'The Origins of the
 * Teapot', IEEE CG&A 7(1), 1987, whose points these are.
 */
enum bake_shape {
	BAKE_SHAPE_PLANE,
	BAKE_SHAPE_CUBE,
	BAKE_SHAPE_SPHERE,
	BAKE_SHAPE_CYLINDER,
	BAKE_SHAPE_TORUS,
	BAKE_SHAPE_TEAPOT
};

/* "plane", "cube", ...: static text; NULL for what is no shape. Reentrant. */
BAKE_API const char *bake_shape_name(enum bake_shape shape);

/* The shape of that name, in lower case. Returns false, and leaves *shape
 * alone, where there is none. Reentrant. */
BAKE_API bool bake_shape_from_name(const char *name, enum bake_shape *shape);

/*
 * Make one: vertices on the surface, in a grid of equal steps of u and v.
 *   detail  1 .. 1024: segments along a face, a patch's quarter turn or side
 *           (of the torus a quarter of the tube; of the ring 5/2 as many), a
 *           quarter of the sphere's height; 0: one at which flat triangles
 *           do not show (16)
 *   mesh    out: BAKE_MESH_INIT before, the caller frees it. Each corner has
 * its UV, unit normal and tangent, from the surface's own derivatives. A point
 * of space is one position, on seams as well. A pole's triangles have the
 * pole's normal, and the u and tangent of their middle. One part, no material;
 * y_up is set. err     reason on failure; never NULL
 *
 * BAKE_EINVAL  no such shape, or detail outside its range
 * BAKE_ENOMEM  no memory; on any failure mesh is BAKE_MESH_INIT
 *
 * Triangles at detail d: 2 d^2, 12 d^2, 16 d^2 - 8 d, 24 d^2 - 8 d, 80 d^2
 * (even d), 80 d^2 - 8 d. Reentrant.
 */
BAKE_API enum bake_status bake_shape_make(enum bake_shape shape, int detail,
    struct bake_mesh *mesh, struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
