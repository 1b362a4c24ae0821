/* Frames of a mesh, and what holds for all of them, for the unit tests. */
/* SPDX-License-Identifier: MIT */
#ifndef TEST_FRAME_H
#define TEST_FRAME_H

#include "mesh_frame.h"
#include "test_mesh.h"

static const double pi = 3.14159265358979323846;

static inline double
dot(const double *a, const double *b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline struct bake_frames
frames_of(const struct bake_mesh *m, struct bake_frame_params p)
{
	struct bake_frames f = BAKE_FRAMES_INIT;
	struct bake_weld w = BAKE_WELD_INIT;
	struct bake_err err = BAKE_ERR_INIT;

	CHECK_OK(bake_mesh_weld(m, 0.0, &w, &err), err);
	CHECK_OK(bake_mesh_frames(m, &w, NULL, &p, &f, &err), err);
	bake_weld_free(&w);
	return f;
}

/* What mesh_frame.h promises of every frame. */
static inline void
check_frames(const struct bake_mesh *m, const struct bake_frames *f)
{
	CHECK(f->ntriangles == m->ntriangles);
	for (size_t i = 0; i < f->nframes; i++) {
		const struct bake_frame *a = &f->frame[i];

		/* a handful of roundings each */
		CHECK_NEAR(dot(a->normal, a->normal), 1.0, 1e-15 * 4);
		CHECK_NEAR(dot(a->tangent, a->tangent), 1.0, 1e-15 * 4);
		CHECK_NEAR(dot(a->tangent, a->normal), 0.0, 1e-15 * 4);
		CHECK(a->hand == 1 || a->hand == -1);
		CHECK((a->flags & ~31) == 0);
		for (int k = 0; k < 3; k++)
			CHECK(isfinite(a->ps[k]) && isfinite(a->pt[k]));
		if (i > 0)
			CHECK(a->v > a[-1].v ||
			      (a->v == a[-1].v && a->vt > a[-1].vt));
	}
	for (size_t i = 0; i < m->ntriangles; i++)
		for (int k = 0; k < 3; k++) {
			const struct bake_frame *a =
			    &f->frame[f->frame_of[i][k]];

			CHECK(a->v == m->triangles[i][k].v);
			CHECK(a->vt == m->triangles[i][k].vt);
		}
}

#endif
