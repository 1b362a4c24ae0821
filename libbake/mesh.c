/* Triangle meshes: their memory, and which reader a file needs. */
/* SPDX-License-Identifier: MIT */
#include "mesh.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "mem.h"
#include "mesh_priv.h"

enum bake_status
bake_mesh_alloc(struct bake_mesh *mesh, size_t npositions, size_t nuvs,
    size_t nnormals, size_t ntriangles, struct bake_err *err)
{
	*mesh = (struct bake_mesh)BAKE_MESH_INIT;
	mesh->positions = bake_alloc(npositions, sizeof *mesh->positions, err);
	mesh->uvs = bake_alloc(nuvs, sizeof *mesh->uvs, err);
	mesh->normals = bake_alloc(nnormals, sizeof *mesh->normals, err);
	mesh->triangles = bake_alloc(ntriangles, sizeof *mesh->triangles, err);
	mesh->material_of =
	    bake_alloc(ntriangles, sizeof *mesh->material_of, err);
	if (err->code != BAKE_OK || mesh->material_of == NULL) {
		bake_mesh_free(mesh);
		return BAKE_ENOMEM;
	}
	mesh->npositions = npositions;
	mesh->nuvs = nuvs;
	mesh->nnormals = nnormals;
	mesh->ntriangles = ntriangles;
	for (size_t i = 0; i < ntriangles; i++)
		mesh->material_of[i] = -1;
	return BAKE_OK;
}

void
bake_mesh_free(struct bake_mesh *mesh)
{
	free(mesh->positions);
	free(mesh->uvs);
	free(mesh->normals);
	free(mesh->tangents);
	free(mesh->colors);
	free(mesh->triangles);
	free(mesh->material_of);
	for (size_t i = 0; i < mesh->nmaterials; i++) {
		free(mesh->materials[i].name);
		free(mesh->materials[i].texture.path);
		free(mesh->materials[i].texture.bytes);
	}
	free(mesh->materials);
	free(mesh->parts);
	for (size_t i = 0; i < mesh->nfiles; i++)
		free(mesh->files[i]);
	free(mesh->files);
	*mesh = (struct bake_mesh)BAKE_MESH_INIT;
}

void
bake_mesh_bounds(const struct bake_mesh *mesh, double lo[3], double hi[3])
{
	for (int k = 0; k < 3; k++) {
		lo[k] = (double)INFINITY;
		hi[k] = -(double)INFINITY;
	}
	for (size_t i = 0; i < mesh->ntriangles; i++)
		for (int j = 0; j < 3; j++) {
			const double *p =
			    mesh->positions[mesh->triangles[i][j].v];

			for (int k = 0; k < 3; k++) {
				lo[k] = fmin(lo[k], p[k]);
				hi[k] = fmax(hi[k], p[k]);
			}
		}
}

/* -- files --------------------------------------------------------------- */

char *
bake_mesh_copy_text(const char *text, size_t length, struct bake_err *err)
{
	char *copy = bake_alloc(length + 1, 1, err);

	if (copy == NULL)
		return NULL;
	memcpy(copy, text, length);
	copy[length] = '\0';
	return copy;
}

char *
bake_mesh_join_path(
    const char *name, const char *relative, size_t length, struct bake_err *err)
{
	const char *slash = strrchr(name, '/');
	size_t folder = slash != NULL ? (size_t)(slash - name) + 1 : 0;
	char *path;

	if (length > 0 && (relative[0] == '/' || relative[0] == '\\'))
		folder = 0;
	if ((path = bake_alloc(folder + length + 1, 1, err)) == NULL)
		return NULL;
	memcpy(path, name, folder);
	memcpy(path + folder, relative, length);
	path[folder + length] = '\0';
	for (char *p = path + folder; *p != '\0'; p++)
		if (*p == '\\')
			*p = '/';
	return path;
}

static enum bake_status
read_all(int fd, const char *path, unsigned char *bytes, size_t n, size_t *got,
    struct bake_err *err)
{
	*got = 0;
	while (*got < n) {
		ssize_t r = read(fd, bytes + *got, n - *got);

		if (r < 0 && errno == EINTR)
			continue;
		if (r < 0)
			return bake_fail(err, BAKE_EIO, "cannot read '%s': %s",
			    path, strerror(errno));
		if (r == 0)
			break;
		*got += (size_t)r;
	}
	return BAKE_OK;
}

enum bake_status
bake_mesh_load_file(const char *path, size_t max_bytes, unsigned char **bytes,
    size_t *nbytes, struct bake_err *err)
{
	struct stat st;
	enum bake_status rc;
	/* a named pipe without a writer must not hold us up */
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);

	*bytes = NULL;
	if (fd < 0 || fstat(fd, &st) != 0) {
		rc = bake_fail(err, BAKE_EIO, "cannot open '%s': %s", path,
		    strerror(errno));
		goto out;
	}
	if (!S_ISREG(st.st_mode)) {
		rc = bake_fail(
		    err, BAKE_EIO, "'%s' is not a regular file", path);
		goto out;
	}
	if ((uintmax_t)st.st_size > max_bytes) {
		rc = bake_fail(err, BAKE_ELIMIT,
		    "'%s' is of %jd bytes, the limit is %zu", path,
		    (intmax_t)st.st_size, max_bytes);
		goto out;
	}
	if ((*bytes = bake_alloc((size_t)st.st_size + 1, 1, err)) == NULL) {
		rc = BAKE_ENOMEM;
		goto out;
	}
	rc = read_all(fd, path, *bytes, (size_t)st.st_size, nbytes, err);
	(*bytes)[*nbytes] = '\0';
out:
	if (fd >= 0)
		close(fd);
	if (rc != BAKE_OK) {
		free(*bytes);
		*bytes = NULL;
	}
	return rc;
}

/* -- which reader -------------------------------------------------------- */

/* The name's extension without its dot; "" where there is none. */
static const char *
extension_of(const char *name)
{
	const char *slash = strrchr(name, '/');
	const char *dot = strrchr(slash != NULL ? slash : name, '.');

	return dot != NULL ? dot + 1 : "";
}

static bool
begins(const struct mesh_source *src, const char *mark)
{
	size_t n = strlen(mark);

	return src->nbytes >= n && memcmp(src->bytes, mark, n) == 0;
}

static enum bake_status
read_any(struct mesh_builder *b, struct bake_err *err)
{
	const char *ext = extension_of(b->src->name);

	if (begins(b->src, "ply\n") || begins(b->src, "ply\r") ||
	    strcasecmp(ext, "ply") == 0)
		return bake_mesh_read_ply(b, err);
	if (begins(b->src, "glTF") || strcasecmp(ext, "gltf") == 0 ||
	    strcasecmp(ext, "glb") == 0)
		return bake_mesh_read_gltf(b, err);
	if (strcasecmp(ext, "obj") == 0)
		return bake_mesh_read_obj(b, err);
	return bake_mesh_read_assimp(b, ext, err);
}

enum bake_status
bake_mesh_read_memory(const void *bytes, size_t nbytes, const char *name,
    const struct bake_mesh_params *params, struct bake_mesh *mesh,
    struct bake_err *err)
{
	struct mesh_source src = { name, bytes, nbytes, params };
	struct mesh_builder b;
	enum bake_status rc;

	*mesh = (struct bake_mesh)BAKE_MESH_INIT;
	if (params->max_items > INT_MAX || params->uv_set < 0)
		return bake_fail(err, BAKE_EINVAL,
		    "limit of %zu items and UV set %d, expected at most %d "
		    "and at least 0",
		    params->max_items, params->uv_set, INT_MAX);
	if (nbytes > params->max_bytes)
		return bake_fail(err, BAKE_ELIMIT,
		    "'%s' is of %zu bytes, the limit is %zu", name, nbytes,
		    params->max_bytes);
	bake_mesh_builder_init(&b, mesh, &src);
	rc = bake_mesh_add_file(&b, name, err);
	if (rc == BAKE_OK && nbytes == 0)
		rc = bake_fail(err, BAKE_EDATA, "'%s' is empty", name);
	if (rc == BAKE_OK)
		rc = read_any(&b, err);
	if (rc == BAKE_OK)
		rc = bake_mesh_finish(&b, err);
	bake_mesh_builder_free(&b);
	if (rc != BAKE_OK)
		bake_mesh_free(mesh);
	return rc;
}

enum bake_status
bake_mesh_read(const char *path, const struct bake_mesh_params *params,
    struct bake_mesh *mesh, struct bake_err *err)
{
	unsigned char *bytes;
	size_t nbytes;
	enum bake_status rc;

	*mesh = (struct bake_mesh)BAKE_MESH_INIT;
	rc = bake_mesh_load_file(path, params->max_bytes, &bytes, &nbytes, err);
	if (rc != BAKE_OK)
		return rc;
	rc = bake_mesh_read_memory(bytes, nbytes, path, params, mesh, err);
	free(bytes);
	return rc;
}
