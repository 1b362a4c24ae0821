/* Triangle meshes: read from files in the file's own order, and welded. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_MESH_H
#define BAKE_MESH_H

#include <stdbool.h>
#include <stddef.h>

#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * One corner of a triangle: 0-based indices into positions, uvs and normals.
 * v is always valid; vt or vn is -1 where the file has none for this corner.
 */
struct bake_corner {
	int v, vt, vn;
};

/* How a texture goes on beyond 0..1. */
enum bake_tex_wrap { BAKE_TEX_REPEAT, BAKE_TEX_CLAMP, BAKE_TEX_MIRROR };

/* What the alpha of a material's colour means (glTF's alphaMode). */
enum bake_alpha_mode { BAKE_ALPHA_OPAQUE, BAKE_ALPHA_MASK, BAKE_ALPHA_BLEND };

/*
 * A picture that a material names: a file (path, as to be opened: already
 * joined with the folder of the mesh or of its material file), or bytes
 * inside the mesh file (bytes, nbytes, and in path a name whose extension says
 * their type, e.g. 'image.png', or which is empty where the file does not say
 * it). path is NULL where the material has no picture. A data URI counts as
 * bytes inside the file.
 *   uv_matrix  {{a b c} {d e f}}: the picture is looked up at
 *              (a u + b v + c, d u + e v + f); identity unless the file has a
 *              texture transform. v grows towards the picture's row 0.
 *   uv_set     which of the file's UV sets it is meant for, see
 *              bake_mesh_params.uv_set
 */
struct bake_texture {
	char *path;
	unsigned char *bytes;
	size_t nbytes;
	double uv_matrix[2][3];
	enum bake_tex_wrap wrap_u, wrap_v;
	int uv_set;
};

/*
 * color is the base colour factor r g b a, 0..1; the texture's colour, where
 * there is one, is multiplied by it. linear tells that color is scene-linear
 * (glTF), else it is encoded as sRGB (OBJ's Kd, and all others). The texture's
 * own colours are sRGB unless its file says otherwise.
 */
struct bake_material {
	char *name; /* may be empty, never NULL */
	double color[4];
	bool linear;
	enum bake_alpha_mode alpha_mode;
	double alpha_cutoff; /* for BAKE_ALPHA_MASK; 0.5 */
	bool two_sided;
	struct bake_texture texture; /* of the base colour */
};

/*
 * A run of positions and of triangles that belong together. For glTF each
 * part is one primitive under one node: mesh and primitive are its indices in
 * the file, and position first_position + i is element i of the primitive's
 * POSITION accessor (its other accessors alike), so that attributes can be
 * written back. A mesh under two nodes makes two parts. For OBJ and PLY there
 * is one part, 0, 0. For other formats mesh counts assimp's meshes.
 * A primitive that has no triangles makes no part.
 */
struct bake_mesh_part {
	int node, mesh, primitive;
	size_t first_position, npositions;
	size_t first_triangle, ntriangles;
};

/*
 * What a file held that is not in the mesh, or is not as it was.
 *   points, lines     such primitives, dropped
 *   degenerate_faces  faces with less than 3 different indices, dropped
 *   rough_faces       polygons for which no clean triangulation was found
 *                     (they cross themselves): all their
 *                     corners are used, closed stays closed
 *   flat_triangles    triangles that are kept, but whose height is at most
 *                     1e-12 of their longest edge
 *   bad_normals       normals that are not finite or 0: they are (0, 0, 0)
 *   bad_tangents      the same of tangents: (0, 0, 0, 0)
 *   missing_uvs       triangles with at least one corner without UV
 *   missing_normals   triangles with at least one corner without normal
 *   missing_files     material files that could not be read
 */
struct bake_mesh_dropped {
	size_t points, lines, degenerate_faces, rough_faces, flat_triangles;
	size_t bad_normals, bad_tangents, missing_uvs, missing_normals;
	size_t missing_files;
};

/*
 * A mesh. All arrays are the mesh's own, freed by bake_mesh_free with free();
 * a mesh made by hand takes them from bake_alloc or malloc.
 *
 *   positions    [npositions] x y z in the mesh's own length unit, finite, in
 *                the file's order, those that no face uses included
 *   uvs          [nuvs] u v, finite, any range; v grows upwards: (0, 0) is the
 *                lower left corner of the picture, whatever the file's format
 *                says (glTF's v becomes 1 - v)
 *   normals      [nnormals] of unit length, or (0, 0, 0) where the file's is
 *                unusable
 *   tangents     NULL, or [nnormals], one for each normal: the unit direction
 *                of growing u, and in [3] the handedness +1 or -1: the
 *                bitangent, growing v, is [3] * normal x tangent; all 0 where
 *                there is none
 *   colors       NULL, or [npositions] r g b a, 0..1; a file with colours for
 *                some vertices only has white for the rest
 *   colors_linear  colors are scene-linear (glTF), else sRGB
 *   triangles    [ntriangles] 3 corners, counterclockwise seen from outside;
 *                the 3 v differ. In the file's order, those of a polygon
 *                next to each other
 *   material_of  [ntriangles] index into materials, or -1
 *   files        [nfiles] paths of all files that were read, the mesh's own
 *                first; not the textures
 *   y_up         the format defines that +y is up (glTF); others do not say
 *
 * (glTF itself has v downwards, but means bitangents as here: upwards.)
 *
 * Limits: npositions, nuvs, nnormals and 3 * ntriangles each fit in an int.
 */
struct bake_mesh {
	size_t npositions, nuvs, nnormals, ntriangles;
	double (*positions)[3];
	double (*uvs)[2];
	double (*normals)[3];
	double (*tangents)[4];
	float (*colors)[4];
	bool colors_linear;
	bool y_up;
	struct bake_corner (*triangles)[3];
	int *material_of;
	size_t nmaterials, nparts, nfiles;
	struct bake_material *materials;
	struct bake_mesh_part *parts;
	char **files;
	struct bake_mesh_dropped dropped;
};
#define BAKE_MESH_INIT                                                         \
	{                                                                      \
		0                                                              \
	}

/*
 * How to read.
 *   max_bytes   the largest file to read, in bytes: the mesh's and each
 *               that it names
 *   max_items   the most positions, UVs, normals, corners or triangles, each;
 *               at most INT_MAX
 *   uv_set      which set of UVs, 0 being the first, where the format has
 *               several; a mesh without that set has no UVs
 *   side_files  read other files that the mesh names (mtllib, glTF buffers);
 *               without it a material file is passed over, and a buffer that
 *               is needed is an error
 */
struct bake_mesh_params {
	size_t max_bytes;
	size_t max_items;
	int uv_set;
	bool side_files;
};
#define BAKE_MESH_PARAMS_DEFAULT                                               \
	{                                                                      \
		(size_t)1 << 31, (size_t)1 << 28, 0, true                      \
	}

/*
 * Read a mesh. PLY and glTF binary are known by their first bytes, all others
 * by the name's extension, upper or lower case.
 *
 *   .obj  positions, UVs, normals, faces of any size, usemtl, mtllib (newmtl,
 *         Kd, d, Tr, map_Kd with -s, -o and -clamp), vertex colours behind the
 *         coordinates (x y z r g b); points and lines are counted; curves
 *         and surfaces, groups and smoothing are passed over. Decimals are
 *         rounded correctly to double.
 *   .ply  ascii and binary of either byte order; vertex x y z, nx ny nz,
 *         tx ty tz hand, red green blue alpha, and s t, u v or
 *         texture_u texture_v; face vertex_indices (or vertex_index) and
 *         texcoord, texnumber; 'comment TextureFile NAME'
 *   .gltf, .glb  triangles, strips and fans of the default scene (scene 0
 *         where none is named); node transforms applied; base colour, its
 *         texture, transform and sampler. Skins and morph targets stay at
 *         rest. Compressed meshes (Draco, meshopt) are an error.
 *   others, as far as assimp knows them (.stl, .fbx, .dae, .3ds, ...): in
 *         float; node transforms applied; exactly equal positions, UVs
 *         and normals are made one each, in order of first appearance. Units
 *         and axes are the file's: FBX's UnitScaleFactor is not applied.
 *
 * Under a mirrored node the winding is turned round, so that the outside
 * stays outside, and handedness changes sign; normals go by the inverse
 * transpose. Polygons become triangles: convex ones a fan from their first
 * corner, others by clipping ears in the plane of Newell's normal.
 *
 *   path    the file; '-' is a file of that name, not standard input
 *   params  how to read
 *   mesh    out: BAKE_MESH_INIT before, the caller frees it
 *   err     reason on failure; never NULL
 *
 * BAKE_EINVAL  params->max_items is above INT_MAX, or uv_set below 0
 * BAKE_EIO     a file cannot be opened or read, or is not a regular file
 * BAKE_EDATA   not understood, truncated, an index out of range, a coordinate
 *              not finite, no faces; the message names file and line, where
 *              there are lines
 * BAKE_ELIMIT  larger than params allows
 * BAKE_ENOMEM  no memory; on any failure mesh is BAKE_MESH_INIT
 *
 * Nothing is allocated by a count that the file only claims: what is claimed
 * is compared with the bytes that are there first.
 * Thread safe (calls that need assimp wait for each other). The locale of the
 * process does not matter.
 * Sources: Wavefront OBJ, 'Advanced Visualizer' manual, appendix B1; Turk, 'The
 * PLY Polygon File Format', 1994; Khronos, 'glTF 2.0 Specification';
 * Sutherland, Sproull and Schumacker 1974 for Newell's normal; Meisters,
 * 'Polygons have ears', 1975.
 */
BAKE_API enum bake_status bake_mesh_read(const char *path,
    const struct bake_mesh_params *params, struct bake_mesh *mesh,
    struct bake_err *err);

/*
 * The same for a file that is in memory: name gives the format by its
 * extension, the folder of side files, and the name for messages. bytes need
 * live for the call only.
 */
BAKE_API enum bake_status bake_mesh_read_memory(const void *bytes,
    size_t nbytes, const char *name, const struct bake_mesh_params *params,
    struct bake_mesh *mesh, struct bake_err *err);

/*
 * Arrays for a mesh made by hand: positions, uvs, normals and triangles of the
 * sizes given, contents unspecified; material_of all -1, no part, no material.
 *
 * BAKE_ENOMEM  no memory; mesh is BAKE_MESH_INIT
 */
BAKE_API enum bake_status bake_mesh_alloc(struct bake_mesh *mesh,
    size_t npositions, size_t nuvs, size_t nnormals, size_t ntriangles,
    struct bake_err *err);

/* Free all arrays and reset to BAKE_MESH_INIT, on which it is harmless. */
BAKE_API void bake_mesh_free(struct bake_mesh *mesh);

/*
 * The box around the positions that triangles use. A mesh without triangles
 * gives lo = +INFINITY, hi = -INFINITY.
 */
BAKE_API void bake_mesh_bounds(
    const struct bake_mesh *mesh, double lo[3], double hi[3]);

/*
 * Cut a polygon into n - 2 triangles that keep its winding. Polygons of 3 or 4
 * corners and convex ones become a fan from corner 0 (a concave quadrangle is
 * cut at its reflex corner); others are cut ear by ear in the plane of Newell's
 * normal. A corner that comes twice (the bridge to a hole) is allowed.
 *
 *   points     [n] positions of its corners, finite, in order, n >= 3
 *   triangles  out: [n - 2] corner numbers 0 .. n - 1
 *   rough      out: no ear was left at some step (the polygon crosses
 *              itself), or the search for ears took more than 1024 n tests
 *              (2^20 at least, 2^28 at most): the rest was cut without looking
 *   err        reason on failure; never NULL
 *
 * BAKE_ENOMEM  no memory; triangles is unspecified
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_polygon_triangulate(const double (*points)[3],
    int n, int (*triangles)[3], bool *rough, struct bake_err *err);

/*
 * Which positions are one point of space.
 *   first       [npositions] the lowest index among the positions that are the
 *               same point; first[v] == v for the point's representative
 *   npoints     how many v have first[v] == v
 * A point's coordinates are those of its representative.
 */
struct bake_weld {
	size_t npositions, npoints;
	int *first;
};
#define BAKE_WELD_INIT                                                         \
	{                                                                      \
		0, 0, NULL                                                     \
	}

/*
 * Weld positions. eps = 0: those whose coordinates are equal (-0 = 0). eps > 0:
 * the connected parts of the graph that joins any two at a distance of at most
 * eps, which does not depend on the positions' order (only on which is the
 * first of a part does); a chain of near points becomes one.
 *
 *   mesh  not modified
 *   eps   in the mesh's length unit, finite, >= 0
 *   weld  out: BAKE_WELD_INIT before, the caller frees it
 *   err   reason on failure; never NULL
 *
 * BAKE_EINVAL  eps is negative or not finite
 * BAKE_ENOMEM  no memory; on any failure weld is BAKE_WELD_INIT
 *
 * Time is linear on average. Reentrant.
 */
BAKE_API enum bake_status bake_mesh_weld(const struct bake_mesh *mesh,
    double eps, struct bake_weld *weld, struct bake_err *err);

BAKE_API void bake_weld_free(struct bake_weld *weld);

/*
 * Which corners of triangles meet at a point: those of point p (a position with
 * weld->first[p] == p) are
 *     corner[start[p]] .. corner[start[p + 1] - 1]
 * in ascending order, each 3 * triangle + k; every corner is in one list.
 * Positions that are not their own representative, or in no triangle, have
 * empty lists. Triangles two of whose corners are one point are left out
 * altogether where collapsed is false.
 */
struct bake_adjacency {
	size_t npositions, ncorners;
	int *start;  /* [npositions + 1] */
	int *corner; /* [ncorners] */
};
#define BAKE_ADJACENCY_INIT                                                    \
	{                                                                      \
		0, 0, NULL, NULL                                               \
	}

/*
 * Build it.
 *   weld       of the same mesh; NULL: every position is a point of its own
 *   collapsed  list triangles that welding made degenerate, too
 *
 * BAKE_EINVAL  weld is of another number of positions
 * BAKE_ENOMEM  no memory; on any failure adj is BAKE_ADJACENCY_INIT
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_mesh_adjacency(const struct bake_mesh *mesh,
    const struct bake_weld *weld, bool collapsed, struct bake_adjacency *adj,
    struct bake_err *err);

BAKE_API void bake_adjacency_free(struct bake_adjacency *adj);

/*
 * The topology of a welded mesh, collapsed triangles aside.
 *   edges            undirected edges
 *   boundary         edges with one triangle
 *   nonmanifold      edges with more than two
 *   flipped          directed edges that more than one triangle uses (a
 *                    neighbour wound the other way, or a nonmanifold edge)
 *   isolated         points that no triangle uses
 *   collapsed        triangles that are left out
 *   components       of triangles joined through points
 */
struct bake_topology {
	size_t points, triangles, edges, boundary, nonmanifold, flipped;
	size_t isolated, collapsed, components;
};

/*
 * Count it. weld may be NULL, as above.
 *
 * BAKE_EINVAL  weld is of another number of positions
 * BAKE_ENOMEM  no memory; topology is all 0
 *
 * Reentrant.
 */
BAKE_API enum bake_status bake_mesh_topology(const struct bake_mesh *mesh,
    const struct bake_weld *weld, struct bake_topology *topology,
    struct bake_err *err);

#ifdef __cplusplus
}
#endif

#endif
