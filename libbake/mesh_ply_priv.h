/* What the PLY reader's header and body share. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MESH_PLY_PRIV_H
#define BAKE_MESH_PLY_PRIV_H

#include "mesh_priv.h"

enum { PLY_ELEMENTS = 32, PLY_PROPERTIES = 128, PLY_NAME = 64 };

enum ply_format { PLY_ASCII, PLY_LITTLE, PLY_BIG };

enum ply_type {
	PLY_INT8,
	PLY_UINT8,
	PLY_INT16,
	PLY_UINT16,
	PLY_INT32,
	PLY_UINT32,
	PLY_FLOAT,
	PLY_DOUBLE,
	PLY_NTYPES
};

/* What a property means to us. Those of a vertex are numbered so that they
 * index the array of its values. */
enum ply_role {
	PLY_X,
	PLY_Y,
	PLY_Z,
	PLY_NX,
	PLY_NY,
	PLY_NZ,
	PLY_S,
	PLY_T,
	PLY_U,
	PLY_V,
	PLY_TEXTURE_U,
	PLY_TEXTURE_V,
	PLY_TX,
	PLY_TY,
	PLY_TZ,
	PLY_HAND,
	PLY_RED,
	PLY_GREEN,
	PLY_BLUE,
	PLY_ALPHA,
	PLY_NVERTEX_ROLES,
	PLY_INDICES = PLY_NVERTEX_ROLES,
	PLY_TEXCOORD,
	PLY_TEXNUMBER,
	PLY_UNKNOWN
};

struct ply_property {
	enum ply_type type, count_type;
	bool list;
	enum ply_role role;
};

enum ply_kind { PLY_VERTEX, PLY_FACE, PLY_STRIPS, PLY_EDGE, PLY_OTHER };

struct ply_element {
	enum ply_kind kind;
	char name[PLY_NAME];
	size_t count;
	int nproperties;
	bool has[PLY_UNKNOWN];
	struct ply_property property[PLY_PROPERTIES];
};

struct ply {
	struct mesh_builder *b;
	struct mesh_text t; /* t.p: what is read next, of the body, too */
	enum ply_format format;
	int nelements, nmaterials;
	struct ply_element element[PLY_ELEMENTS];
};

/* Bytes of a value of that type. */
size_t bake_ply_type_size(enum ply_type type);

/* Up to and with end_header. Materials of 'comment TextureFile' are added. */
enum bake_status bake_ply_read_header(struct ply *ply, struct bake_err *err);

#endif
