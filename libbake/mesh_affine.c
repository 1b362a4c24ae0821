/* Affine maps of positions, normals and tangents. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "mesh_priv.h"

void
bake_mesh_affine_multiply(
    double out[3][4], const double a[3][4], const double b[3][4])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 4; j++)
			out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] +
				    a[i][2] * b[2][j] +
				    (j == 3 ? a[i][3] : 0.0);
}

void
bake_mesh_affine_prepare(struct mesh_affine *a)
{
	double(*m)[4] = a->m, det = 0.0;

	/* the cofactor matrix exists where the inverse does not */
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
			int j1 = (j + 1) % 3, j2 = (j + 2) % 3;

			a->cofactor[i][j] =
			    m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
		}
	for (int j = 0; j < 3; j++)
		det += m[0][j] * a->cofactor[0][j];
	a->mirrored = det < 0.0;
	for (int i = 0; i < 3 && a->mirrored; i++)
		for (int j = 0; j < 3; j++)
			a->cofactor[i][j] = -a->cofactor[i][j];
}

void
bake_mesh_affine_point(
    const struct mesh_affine *a, const double p[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a->m[i][0] * p[0] + a->m[i][1] * p[1] +
			 a->m[i][2] * p[2] + a->m[i][3];
}

void
bake_mesh_affine_normal(
    const struct mesh_affine *a, const double n[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a->cofactor[i][0] * n[0] + a->cofactor[i][1] * n[1] +
			 a->cofactor[i][2] * n[2];
}

void
bake_mesh_affine_tangent(
    const struct mesh_affine *a, const double t[4], double out[4])
{
	for (int i = 0; i < 3; i++)
		out[i] =
		    a->m[i][0] * t[0] + a->m[i][1] * t[1] + a->m[i][2] * t[2];
	/* n and t turn the other way round in a mirror */
	out[3] = a->mirrored ? -t[3] : t[3];
}

enum bake_status
bake_mesh_add_triangle(struct mesh_builder *b, const struct mesh_affine *a,
    struct bake_corner c0, struct bake_corner c1, struct bake_corner c2,
    int material, struct bake_err *err)
{
	enum bake_status rc;

	if ((rc = bake_mesh_add_corner(b, c0, err)) != BAKE_OK ||
	    (rc = bake_mesh_add_corner(b, a->mirrored ? c2 : c1, err)) !=
		BAKE_OK ||
	    (rc = bake_mesh_add_corner(b, a->mirrored ? c1 : c2, err)) !=
		BAKE_OK)
		return rc;
	return bake_mesh_end_face(b, material, err);
}
