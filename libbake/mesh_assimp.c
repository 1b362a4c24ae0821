/* Mesh files that assimp reads: the one module that knows it. */
/* SPDX-License-Identifier: MIT */
#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "mem.h"
#include "mesh_priv.h"

/* assimp keeps its last error text for the whole process. */
static pthread_mutex_t assimp_lock = PTHREAD_MUTEX_INITIALIZER;

/* -- files, as assimp sees them ------------------------------------------ */

struct io {
	struct mesh_builder *b;
	const char *main_name;
	struct bake_err err; /* why a side file could not be read */
};

/* An open file: all of it in memory. */
struct memory_file {
	const unsigned char *bytes;
	unsigned char *owned;
	size_t n, at;
};

static size_t
file_read(struct aiFile *file, char *out, size_t size, size_t count)
{
	struct memory_file *m = (struct memory_file *)(void *)file->UserData;
	size_t n;

	if (size == 0)
		return 0;
	n = (m->n - m->at) / size;
	if (count < n)
		n = count;
	memcpy(out, m->bytes + m->at, n * size);
	m->at += n * size;
	return n;
}

static size_t
file_write(struct aiFile *file, const char *in, size_t size, size_t count)
{
	(void)file, (void)in, (void)size, (void)count;
	return 0;
}

static size_t
file_tell(struct aiFile *file)
{
	return ((struct memory_file *)(void *)file->UserData)->at;
}

static size_t
file_size(struct aiFile *file)
{
	return ((struct memory_file *)(void *)file->UserData)->n;
}

static enum aiReturn
file_seek(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
	struct memory_file *m = (struct memory_file *)(void *)file->UserData;
	size_t base = origin == aiOrigin_SET   ? 0
		      : origin == aiOrigin_CUR ? m->at
					       : m->n;

	/* offsets backwards are negative numbers in a size_t: they wrap */
	if (base + offset > m->n)
		return aiReturn_FAILURE;
	m->at = base + offset;
	return aiReturn_SUCCESS;
}

static void
file_flush(struct aiFile *file)
{
	(void)file;
}

/* The bytes of a file that assimp asks for. */
static bool
find_bytes(struct io *io, const char *name, struct memory_file *m)
{
	const struct mesh_source *src = io->b->src;

	if (strcmp(name, io->main_name) == 0) {
		m->bytes = src->bytes;
		m->n = src->nbytes;
		return true;
	}
	if (!src->params->side_files ||
	    bake_mesh_load_file(name, src->params->max_bytes, &m->owned, &m->n,
		&io->err) != BAKE_OK)
		return false;
	m->bytes = m->owned;
	return bake_mesh_add_file(io->b, name, &io->err) == BAKE_OK;
}

static struct aiFile *
io_open(struct aiFileIO *file_io, const char *name, const char *mode)
{
	struct io *io = (struct io *)(void *)file_io->UserData;
	struct memory_file *m;
	struct aiFile *file;

	if (mode[0] != 'r' || (m = bake_zalloc(1, sizeof *m, &io->err)) == NULL)
		return NULL;
	file = bake_zalloc(1, sizeof *file, &io->err);
	if (file == NULL || !find_bytes(io, name, m)) {
		free(m->owned);
		free(m);
		free(file);
		return NULL;
	}
	file->ReadProc = file_read;
	file->WriteProc = file_write;
	file->TellProc = file_tell;
	file->FileSizeProc = file_size;
	file->SeekProc = file_seek;
	file->FlushProc = file_flush;
	file->UserData = (aiUserData)(void *)m;
	return file;
}

static void
io_close(struct aiFileIO *file_io, struct aiFile *file)
{
	struct memory_file *m = (struct memory_file *)(void *)file->UserData;

	(void)file_io;
	free(m->owned);
	free(m);
	free(file);
}

/* -- materials ----------------------------------------------------------- */

/* A picture of plain texels becomes an uncompressed TGA file: assimp's texels
 * are b g r a, as TGA's are. */
static enum bake_status
take_texels(
    const struct aiTexture *from, struct bake_texture *to, struct bake_err *err)
{
	enum { HEADER = 18 };
	size_t texels, size;

	if (from->mWidth > 65535 || from->mHeight > 65535 ||
	    from->pcData == NULL)
		return BAKE_OK;
	texels = (size_t)from->mWidth * from->mHeight;
	size = HEADER + 4 * texels;
	if ((to->bytes = bake_zalloc(size, 1, err)) == NULL ||
	    (to->path = bake_mesh_copy_text("image.tga", 9, err)) == NULL)
		return BAKE_ENOMEM;
	to->nbytes = size;
	to->bytes[2] = 2; /* true colour */
	to->bytes[12] = (unsigned char)(from->mWidth & 255);
	to->bytes[13] = (unsigned char)(from->mWidth >> 8);
	to->bytes[14] = (unsigned char)(from->mHeight & 255);
	to->bytes[15] = (unsigned char)(from->mHeight >> 8);
	to->bytes[16] = 32;
	to->bytes[17] = 0x28; /* 8 bits of alpha, first row at the top */
	memcpy(to->bytes + HEADER, from->pcData, 4 * texels);
	return BAKE_OK;
}

static enum bake_status
take_embedded(
    const struct aiTexture *from, struct bake_texture *to, struct bake_err *err)
{
	char name[16 + HINTMAXTEXTURELEN] = "image.";

	if (from->mHeight != 0)
		return take_texels(from, to, err);
	if (from->pcData == NULL || from->mWidth == 0)
		return BAKE_OK;
	if ((to->bytes = bake_alloc(from->mWidth, 1, err)) == NULL)
		return BAKE_ENOMEM;
	memcpy(to->bytes, from->pcData, from->mWidth);
	to->nbytes = from->mWidth;
	strncat(name, from->achFormatHint,
	    strnlen(from->achFormatHint, HINTMAXTEXTURELEN));
	if (from->achFormatHint[0] == '\0')
		name[0] = '\0';
	to->path = bake_mesh_copy_text(name, strlen(name), err);
	return to->path != NULL ? BAKE_OK : BAKE_ENOMEM;
}

/* The picture inside the scene that goes by that name, or NULL. */
static const struct aiTexture *
find_embedded(const struct aiScene *scene, const char *name)
{
	if (name[0] == '*') {
		unsigned long i = strtoul(name + 1, NULL, 10);

		return i < scene->mNumTextures ? scene->mTextures[i] : NULL;
	}
	for (unsigned i = 0; i < scene->mNumTextures; i++)
		if (scene->mTextures[i]->mFilename.length > 0 &&
		    strcmp(scene->mTextures[i]->mFilename.data, name) == 0)
			return scene->mTextures[i];
	return NULL;
}

static enum bake_tex_wrap
wrap_of(enum aiTextureMapMode mode)
{
	switch (mode) {
	case aiTextureMapMode_Clamp:
	case aiTextureMapMode_Decal:
		return BAKE_TEX_CLAMP;
	case aiTextureMapMode_Mirror:
		return BAKE_TEX_MIRROR;
	default:
		return BAKE_TEX_REPEAT;
	}
}

static enum bake_status
take_texture(const struct mesh_builder *b, const struct aiScene *scene,
    const struct aiMaterial *from, struct bake_texture *to,
    struct bake_err *err)
{
	static const enum aiTextureType types[] = { aiTextureType_BASE_COLOR,
		aiTextureType_DIFFUSE };
	const struct aiTexture *embedded;
	enum aiTextureMapMode mode[2] = { aiTextureMapMode_Wrap,
		aiTextureMapMode_Wrap };
	struct aiString path;
	unsigned uv_set = 0;

	for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
		memset(&path, 0, sizeof path);
		if (aiGetMaterialTexture(from, types[i], 0, &path, NULL,
			&uv_set, NULL, NULL, mode, NULL) != aiReturn_SUCCESS ||
		    path.length == 0)
			continue;
		to->wrap_u = wrap_of(mode[0]);
		to->wrap_v = wrap_of(mode[1]);
		to->uv_set = (int)(uv_set & 7);
		if ((embedded = find_embedded(scene, path.data)) != NULL)
			return take_embedded(embedded, to, err);
		to->path = bake_mesh_join_path(
		    b->src->name, path.data, strlen(path.data), err);
		return to->path != NULL ? BAKE_OK : BAKE_ENOMEM;
	}
	return BAKE_OK;
}

static double
unit(double x)
{
	return x > 0.0 ? x < 1.0 ? x : 1.0 : 0.0;
}

static enum bake_status
take_material(struct mesh_builder *b, const struct aiScene *scene,
    const struct aiMaterial *from, struct bake_err *err)
{
	struct bake_material *to;
	struct aiString name;
	struct aiColor4D c = { 1.0f, 1.0f, 1.0f, 1.0f };
	float opacity = 1.0f;
	int index, two_sided = 0;
	enum bake_status rc;

	memset(&name, 0, sizeof name);
	aiGetMaterialString(from, AI_MATKEY_NAME, &name);
	rc = bake_mesh_add_material(
	    b, name.data, strnlen(name.data, sizeof name.data), &index, err);
	if (rc != BAKE_OK)
		return rc;
	to = &b->mesh->materials[index];
	if (aiGetMaterialColor(from, AI_MATKEY_BASE_COLOR, &c) !=
	    aiReturn_SUCCESS)
		aiGetMaterialColor(from, AI_MATKEY_COLOR_DIFFUSE, &c);
	aiGetMaterialFloat(from, AI_MATKEY_OPACITY, &opacity);
	to->color[0] = unit((double)c.r);
	to->color[1] = unit((double)c.g);
	to->color[2] = unit((double)c.b);
	to->color[3] = unit((double)c.a * (double)opacity);
	if (to->color[3] < 1.0)
		to->alpha_mode = BAKE_ALPHA_BLEND;
	aiGetMaterialInteger(from, AI_MATKEY_TWOSIDED, &two_sided);
	to->two_sided = two_sided != 0;
	return take_texture(b, scene, from, &to->texture, err);
}

/* -- geometry ------------------------------------------------------------ */

/* One of assimp's meshes, its vertices by value: for each vertex the number
 * of the first equal position (with colour), UV and normal, counted from the
 * mesh's first; -1 where it has none. */
struct part {
	const struct aiMesh *mesh;
	const struct aiVector3D *uv;
	int *first, *number; /* scratch, [mNumVertices] */
	int *v, *vt, *vn;
	double *values; /* scratch */
};

static void
part_free(struct part *p)
{
	free(p->first);
	free(p->number);
	free(p->v);
	free(p->vt);
	free(p->vn);
	free(p->values);
}

/* From values[n][dim] to numbers of different values in order of first
 * appearance; first[i] == i marks those. */
static bool
number_values(const struct part *p, int dim, int **out, struct bake_err *err)
{
	size_t n = p->mesh->mNumVertices;
	int next = 0;

	if ((*out = bake_alloc(n, sizeof **out, err)) == NULL ||
	    bake_mesh_first_equal(p->values, n, dim, p->first, err) == 0)
		return false;
	for (size_t i = 0; i < n; i++) {
		if (p->first[i] == (int)i)
			p->number[i] = next++;
		(*out)[i] = p->number[p->first[i]];
	}
	return true;
}

static void
put(double *to, const struct aiVector3D *from)
{
	to[0] = (double)from->x;
	to[1] = (double)from->y;
	to[2] = (double)from->z;
}

static enum bake_status
add_positions(struct mesh_builder *b, struct part *p,
    const struct mesh_affine *a, struct bake_err *err)
{
	const struct aiColor4D *colors = p->mesh->mColors[0];
	int dim = colors != NULL ? 7 : 3;
	enum bake_status rc = BAKE_OK;

	for (size_t i = 0; i < p->mesh->mNumVertices; i++) {
		double *x = p->values + i * (size_t)dim;

		put(x, &p->mesh->mVertices[i]);
		if (colors != NULL) {
			x[3] = (double)colors[i].r;
			x[4] = (double)colors[i].g;
			x[5] = (double)colors[i].b;
			x[6] = (double)colors[i].a;
		}
	}
	if (!number_values(p, dim, &p->v, err))
		return BAKE_ENOMEM;
	for (size_t i = 0; rc == BAKE_OK && i < p->mesh->mNumVertices; i++) {
		const double *x = p->values + i * (size_t)dim;
		double at[3];

		if (p->first[i] != (int)i)
			continue;
		bake_mesh_affine_point(a, x, at);
		rc = bake_mesh_add_position(b, at, err);
		if (rc == BAKE_OK && colors != NULL) {
			float rgba[4] = { (float)x[3], (float)x[4], (float)x[5],
				(float)x[6] };

			rc = bake_mesh_set_color(
			    b, b->mesh->npositions - 1, rgba, err);
		}
	}
	return rc;
}

static enum bake_status
add_uvs(struct mesh_builder *b, struct part *p, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;

	for (size_t i = 0; i < p->mesh->mNumVertices; i++) {
		p->values[2 * i] = (double)p->uv[i].x;
		p->values[2 * i + 1] = (double)p->uv[i].y;
	}
	if (!number_values(p, 2, &p->vt, err))
		return BAKE_ENOMEM;
	for (size_t i = 0; rc == BAKE_OK && i < p->mesh->mNumVertices; i++)
		if (p->first[i] == (int)i)
			rc = bake_mesh_add_uv(b, &p->values[2 * i], err);
	return rc;
}

/* Normals, with tangents where there are; a bitangent tells the handedness. */
static enum bake_status
add_normals(struct mesh_builder *b, struct part *p, const struct mesh_affine *a,
    struct bake_err *err)
{
	const struct aiMesh *mesh = p->mesh;
	bool tangents = mesh->mTangents != NULL && mesh->mBitangents != NULL;
	int dim = tangents ? 7 : 3;
	enum bake_status rc = BAKE_OK;

	for (size_t i = 0; i < mesh->mNumVertices; i++) {
		double *x = p->values + i * (size_t)dim, bi[3];

		put(x, &mesh->mNormals[i]);
		if (!tangents)
			continue;
		put(x + 3, &mesh->mTangents[i]);
		put(bi, &mesh->mBitangents[i]);
		x[6] = (x[1] * x[5] - x[2] * x[4]) * bi[0] +
				   (x[2] * x[3] - x[0] * x[5]) * bi[1] +
				   (x[0] * x[4] - x[1] * x[3]) * bi[2] <
			       0.0
			   ? -1.0
			   : 1.0;
	}
	if (!number_values(p, dim, &p->vn, err))
		return BAKE_ENOMEM;
	for (size_t i = 0; rc == BAKE_OK && i < mesh->mNumVertices; i++) {
		const double *x = p->values + i * (size_t)dim;
		double n[3], t[4];

		if (p->first[i] != (int)i)
			continue;
		bake_mesh_affine_normal(a, x, n);
		rc = bake_mesh_add_normal(b, n, err);
		if (rc == BAKE_OK && tangents) {
			bake_mesh_affine_tangent(a, x + 3, t);
			rc = bake_mesh_set_tangent(
			    b, b->mesh->nnormals - 1, t, err);
		}
	}
	return rc;
}

/* Where the part's elements begin in the whole mesh. */
struct offsets {
	int v, vt, vn;
};

static enum bake_status
add_faces(struct mesh_builder *b, const struct part *p,
    const struct offsets *base, bool mirrored, struct bake_err *err)
{
	const struct aiMesh *mesh = p->mesh;
	enum bake_status rc = BAKE_OK;

	for (size_t f = 0; rc == BAKE_OK && f < mesh->mNumFaces; f++) {
		const struct aiFace *face = &mesh->mFaces[f];
		unsigned n = face->mNumIndices;

		if (n < 3) {
			b->mesh->dropped.points += n == 1;
			b->mesh->dropped.lines += n == 2;
			continue;
		}
		for (unsigned k = 0; rc == BAKE_OK && k < n; k++) {
			unsigned i = face->mIndices[mirrored ? n - 1 - k : k];
			struct bake_corner c;

			if (i >= mesh->mNumVertices)
				return bake_fail(err, BAKE_EDATA,
				    "'%s': a face uses vertex %u, its mesh "
				    "has %u",
				    b->src->name, i, mesh->mNumVertices);
			c.v = base->v + p->v[i];
			c.vt = p->vt != NULL ? base->vt + p->vt[i] : -1;
			c.vn = p->vn != NULL ? base->vn + p->vn[i] : -1;
			rc = bake_mesh_add_corner(b, c, err);
		}
		if (rc == BAKE_OK)
			rc = bake_mesh_end_face(
			    b, (int)mesh->mMaterialIndex, err);
	}
	return rc;
}

static enum bake_status
add_part(struct mesh_builder *b, const struct aiMesh *mesh, int number,
    const struct mesh_affine *a, struct bake_err *err)
{
	const struct offsets base = { (int)b->mesh->npositions,
		(int)b->mesh->nuvs, (int)b->mesh->nnormals };
	int uv_set = b->src->params->uv_set;
	struct part p = { .mesh = mesh };
	size_t n = mesh->mNumVertices;
	enum bake_status rc;

	if (mesh->mVertices == NULL || mesh->mFaces == NULL || n == 0)
		return BAKE_OK;
	if (n > b->src->params->max_items)
		return bake_fail(err, BAKE_ELIMIT,
		    "'%s' has more than %zu positions", b->src->name,
		    b->src->params->max_items);
	if (uv_set < AI_MAX_NUMBER_OF_TEXTURECOORDS)
		p.uv = mesh->mTextureCoords[uv_set];
	p.first = bake_alloc(n, sizeof *p.first, err);
	p.number = bake_alloc(n, sizeof *p.number, err);
	p.values = bake_alloc(n, 7 * sizeof *p.values, err);
	rc = p.first == NULL || p.number == NULL || p.values == NULL
		 ? BAKE_ENOMEM
		 : bake_mesh_begin_part(b, 0, number, 0, err);
	if (rc == BAKE_OK)
		rc = add_positions(b, &p, a, err);
	if (rc == BAKE_OK && p.uv != NULL)
		rc = add_uvs(b, &p, err);
	if (rc == BAKE_OK && mesh->mNormals != NULL)
		rc = add_normals(b, &p, a, err);
	if (rc == BAKE_OK)
		rc = add_faces(b, &p, &base, a->mirrored, err);
	part_free(&p);
	return rc;
}

/* -- the scene ----------------------------------------------------------- */

static void
node_transform(const struct aiNode *node, struct mesh_affine *a)
{
	double m[3][4];

	memset(a, 0, sizeof *a);
	for (int k = 0; k < 3; k++)
		a->m[k][k] = 1.0;
	/* parents' maps come last */
	for (; node != NULL; node = node->mParent) {
		const struct aiMatrix4x4 *t = &node->mTransformation;
		const double own[3][4] = {
			{ (double)t->a1, (double)t->a2, (double)t->a3,
			    (double)t->a4 },
			{ (double)t->b1, (double)t->b2, (double)t->b3,
			    (double)t->b4 },
			{ (double)t->c1, (double)t->c2, (double)t->c3,
			    (double)t->c4 },
		};

		bake_mesh_affine_multiply(m, own, (const double(*)[4])a->m);
		memcpy(a->m, m, sizeof m);
	}
	bake_mesh_affine_prepare(a);
}

static enum bake_status
add_nodes(struct mesh_builder *b, const struct aiScene *scene,
    const struct aiNode *node, int depth, struct bake_err *err)
{
	enum { MAX_DEPTH = 1000 };
	struct mesh_affine a;
	enum bake_status rc = BAKE_OK;

	if (depth > MAX_DEPTH)
		return bake_fail(err, BAKE_ELIMIT,
		    "'%s' has nodes more than %d deep", b->src->name,
		    MAX_DEPTH);
	if (node->mNumMeshes > 0)
		node_transform(node, &a);
	for (unsigned i = 0; rc == BAKE_OK && i < node->mNumMeshes; i++)
		if (node->mMeshes[i] < scene->mNumMeshes)
			rc = add_part(b, scene->mMeshes[node->mMeshes[i]],
			    (int)node->mMeshes[i], &a, err);
	for (unsigned i = 0; rc == BAKE_OK && i < node->mNumChildren; i++)
		rc = add_nodes(b, scene, node->mChildren[i], depth + 1, err);
	return rc;
}

static enum bake_status
take_scene(
    struct mesh_builder *b, const struct aiScene *scene, struct bake_err *err)
{
	enum bake_status rc = BAKE_OK;

	for (unsigned i = 0; rc == BAKE_OK && i < scene->mNumMaterials; i++)
		rc = take_material(b, scene, scene->mMaterials[i], err);
	if (rc == BAKE_OK && scene->mRootNode != NULL)
		rc = add_nodes(b, scene, scene->mRootNode, 0, err);
	return rc;
}

/* assimp's reason on one line. */
static enum bake_status
fail_import(const struct io *io, struct bake_err *err)
{
	const char *text = aiGetErrorString();
	char line[512];
	size_t n = 0;

	/* why a side file was refused says more than assimp does */
	if (io->err.code != BAKE_OK)
		return bake_fail(err, io->err.code, "'%s': %s",
		    io->b->src->name, io->err.msg);
	for (; text[n] != '\0' && n + 1 < sizeof line; n++)
		line[n] = (unsigned char)text[n] < ' ' ? ' ' : text[n];
	while (n > 0 && (line[n - 1] == ' ' || line[n - 1] == '.'))
		n--;
	line[n] = '\0';
	return bake_fail(err, BAKE_EDATA, "'%s': %s", io->b->src->name,
	    n > 0 ? line : "not understood");
}

static const struct aiScene *
import(struct io *io)
{
	struct aiFileIO file_io = { io_open, io_close, (aiUserData)(void *)io };
	struct aiPropertyStore *props = aiCreatePropertyStore();
	const struct aiScene *scene;

	if (props == NULL)
		return NULL;
	aiSetImportPropertyInteger(
	    props, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
	aiSetImportPropertyInteger(
	    props, AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, 0);
	/* no step that reorders, joins or splits */
	scene = aiImportFileExWithProperties(io->main_name, 0, &file_io, props);
	aiReleasePropertyStore(props);
	return scene;
}

enum bake_status
bake_mesh_read_assimp(
    struct mesh_builder *b, const char *extension, struct bake_err *err)
{
	struct io io = { b, b->src->name, BAKE_ERR_INIT };
	char dotted[32] = ".";
	const struct aiScene *scene;
	enum bake_status rc;

	if (strlen(extension) + 2 > sizeof dotted || extension[0] == '\0' ||
	    !aiIsExtensionSupported(strcat(dotted, extension)))
		return bake_fail(err, BAKE_EDATA,
		    "'%s': '%s' is not the name of a mesh format that can be "
		    "read",
		    b->src->name, extension);
	pthread_mutex_lock(&assimp_lock);
	scene = import(&io);
	rc = scene != NULL ? BAKE_OK : fail_import(&io, err);
	pthread_mutex_unlock(&assimp_lock);
	if (scene == NULL)
		return rc;
	/* without memory assimp may go on as if a file were not there */
	rc = io.err.code == BAKE_ENOMEM
		 ? bake_fail(err, BAKE_ENOMEM, "%s", io.err.msg)
		 : take_scene(b, scene, err);
	aiReleaseImport(scene);
	return rc;
}
