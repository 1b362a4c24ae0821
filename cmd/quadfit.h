/* rm-quadfit: what its parts share. */
/* SPDX-License-Identifier: MIT */
#ifndef QUADFIT_H
#define QUADFIT_H

#include "cmd.h"
#include "gltf.h"
#include "mesh.h"
#include "mesh_frame.h"
#include "quadric.h"

enum quadfit_type {
	QUADFIT_TSV,
	QUADFIT_JSON,
	QUADFIT_PLY,
	QUADFIT_GLB,
	QUADFIT_GLTF,
	QUADFIT_NTYPES
};

extern const char *const quadfit_types[QUADFIT_NTYPES];

/* The options. */
struct quadfit_opts {
	struct bake_quadric_params fit;
	struct bake_frame_params frames;
	struct bake_mesh_params mesh;
	const char *frame; /* its name */
	double weld;
	bool stats, has_type;
	enum quadfit_type type; /* --format */
};

/* A mesh with its quadrics. */
struct quadfit {
	struct bake_mesh mesh;
	struct bake_frames frames;
	struct bake_quadric *quadrics; /* [frames.nframes] */
};
#define QUADFIT_INIT                                                           \
	{                                                                      \
		BAKE_MESH_INIT, BAKE_FRAMES_INIT, NULL                         \
	}

void quadfit_free(struct quadfit *q);

/*
 * Frames and quadrics of q->mesh, which came from path; q's other members are
 * empty before. On failure the reason is printed.
 */
bool quadfit_fit(struct cmd *cmd, const struct quadfit_opts *o,
    const char *path, struct quadfit *q);

/* Fit one file; out is NULL where nothing is to be written. */
bool quadfit_file(struct cmd *cmd, const struct quadfit_opts *o,
    const char *path, const char *out, enum quadfit_type type);

/* Whether a file is glTF: by its first bytes, or its name. */
bool quadfit_is_gltf(const char *path);

/* Fit the meshes of a glTF file, each in its own coordinates, and write it
 * with the attributes added. */
bool quadfit_gltf(struct cmd *cmd, const struct quadfit_opts *o,
    const char *path, const char *out, bool glb);

/* Write a mesh that was no glTF as one. */
bool quadfit_make_gltf(struct cmd *cmd, const struct quadfit_opts *o,
    const char *path, const struct quadfit *q, const char *out, bool glb);

/* Print what the quadrics are like to standard output. */
bool quadfit_print_stats(struct cmd *cmd, const struct quadfit_opts *o,
    const char *path, const struct quadfit *q);

#endif
