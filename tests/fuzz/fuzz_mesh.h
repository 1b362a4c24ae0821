/* What the fuzz targets of mesh readers share. */
/* SPDX-License-Identifier: MIT */
#ifndef FUZZ_MESH_H
#define FUZZ_MESH_H

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "fuzz.h"
#include "mesh_frame.h"

/* Coordinates for which frames are promised to be finite. */
static inline int
is_moderate(const struct bake_mesh *m)
{
	for (size_t i = 0; i < m->npositions; i++)
		for (int k = 0; k < 3; k++) {
			if (!isfinite(m->positions[i][k]))
				abort();
			if (fabs(m->positions[i][k]) > 1e100)
				return 0;
		}
	for (size_t i = 0; i < m->nuvs; i++)
		if (!(fabs(m->uvs[i][0]) < 1e100 && fabs(m->uvs[i][1]) < 1e100))
			return 0;
	return 1;
}

static inline void
check_triangles(const struct bake_mesh *m)
{
	for (size_t i = 0; i < m->ntriangles; i++)
		for (int k = 0; k < 3; k++) {
			const struct bake_corner *c = &m->triangles[i][k];

			if (c->v < 0 || c->v >= (int)m->npositions ||
			    c->vt < -1 || c->vt >= (int)m->nuvs || c->vn < -1 ||
			    c->vn >= (int)m->nnormals ||
			    m->material_of[i] < -1 ||
			    m->material_of[i] >= (int)m->nmaterials ||
			    c->v == m->triangles[i][(k + 1) % 3].v)
				abort();
		}
}

/* Read it, then do with it all that tools begin with. */
static inline void
fuzz_mesh(const uint8_t *bytes, size_t size, const char *name, bool side_files)
{
	const struct bake_mesh_params params = { 1 << 20, 1 << 16, 0,
		side_files };
	struct bake_frame_params fp = BAKE_FRAME_PARAMS_DEFAULT;
	struct bake_mesh m = BAKE_MESH_INIT;
	struct bake_weld w = BAKE_WELD_INIT;
	struct bake_frames f = BAKE_FRAMES_INIT;
	struct bake_topology t;
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_status rc;
	int moderate;

	rc = bake_mesh_read_memory(bytes, size, name, &params, &m, &err);
	fuzz_note("", err.msg);
	if ((rc == BAKE_OK) != (err.msg[0] == '\0') ||
	    (rc == BAKE_OK) != (m.ntriangles > 0))
		abort();
	if (rc != BAKE_OK)
		return;
	check_triangles(&m);
	moderate = is_moderate(&m);
	fp.nthreads = 1;
	fp.tangents = BAKE_TANGENTS_AUTO;
	if (bake_mesh_weld(&m, size % 2 * 0.125, &w, &err) != BAKE_OK ||
	    bake_mesh_topology(&m, &w, &t, &err) != BAKE_OK ||
	    bake_mesh_frames(&m, &w, NULL, &fp, &f, &err) != BAKE_OK)
		abort();
	for (size_t i = 0; moderate && i < f.nframes; i++)
		for (int k = 0; k < 3; k++)
			if (!isfinite(f.frame[i].normal[k]) ||
			    !isfinite(f.frame[i].tangent[k]) ||
			    !isfinite(f.frame[i].ps[k]) ||
			    !isfinite(f.frame[i].pt[k]))
				abort();
	bake_frames_free(&f);
	bake_weld_free(&w);
	bake_mesh_free(&m);
}

#endif
