/* Reading meshes for the tools: warnings, standard input, depfile. */
/* SPDX-License-Identifier: MIT */
#include "cmd_mesh.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cmd_batch.h"
#include "cmd_recipe.h"

static void
warn_count(struct cmd *cmd, const char *path, size_t n, const char *what)
{
	if (n > 0)
		cmd_warn(cmd, "%s: %zu %s", path, n, what);
}

static void
warn_dropped(struct cmd *cmd, const char *path, const struct bake_mesh *mesh)
{
	const struct bake_mesh_dropped *d = &mesh->dropped;

	warn_count(cmd, path, d->degenerate_faces,
	    "faces have less than 3 different corners and are left out");
	warn_count(cmd, path, d->rough_faces,
	    "polygons cross themselves or have no area");
	warn_count(cmd, path, d->bad_normals,
	    "normals are not finite or 0 and are computed");
	warn_count(cmd, path, d->bad_tangents,
	    "tangents are not finite or 0 and follow from UVs");
	if (mesh->nuvs > 0)
		warn_count(cmd, path, d->missing_uvs, "triangles have no UVs");
	if (d->points + d->lines > 0)
		cmd_note(cmd, "%s: %zu points and %zu lines are left out", path,
		    d->points, d->lines);
}

/* All of standard input; NULL with the reason printed. */
static char *
read_stdin(struct cmd *cmd, size_t max_bytes, size_t *n)
{
	char *bytes = NULL;
	size_t room = 0, got = 1;

	for (*n = 0; got > 0 && *n <= max_bytes; *n += got) {
		if (room - *n < 65536) {
			char *more = realloc(bytes, room = 2 * room + 65536);

			if (more == NULL) {
				cmd_error(cmd, "standard input: no memory");
				free(bytes);
				return NULL;
			}
			bytes = more;
		}
		got = fread(bytes + *n, 1, room - *n, stdin);
	}
	if (!ferror(stdin) && *n <= max_bytes)
		return bytes;
	cmd_error(cmd, "standard input: %s",
	    ferror(stdin) ? "cannot be read" : "is too large");
	free(bytes);
	return NULL;
}

/* A mesh on standard input says itself what it is; OBJ files begin with
 * anything. */
static bool
read_mesh_stdin(struct cmd *cmd, const struct bake_mesh_params *params,
    struct bake_mesh *mesh)
{
	struct bake_err err = BAKE_ERR_INIT;
	size_t n;
	char *bytes = read_stdin(cmd, params->max_bytes, &n);
	bool gltf = bytes != NULL && n >= 4 &&
		    (*bytes == '{' || memcmp(bytes, "glTF", 4) == 0);
	bool ok = bytes != NULL;
	struct bake_digest digest;

	if (ok) {
		digest = bake_digest_of(bytes, n);
		cmd_recipe_stdin(cmd, &digest);
	}
	if (ok && bake_mesh_read_memory(bytes, n, gltf ? "-.gltf" : "-.obj",
		      params, mesh, &err) != BAKE_OK) {
		cmd_error(cmd, "standard input: %s", err.msg);
		ok = false;
	}
	free(bytes);
	return ok;
}

static bool
read_mesh_file(struct cmd *cmd, const char *path,
    const struct bake_mesh_params *params, struct bake_mesh *mesh)
{
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_status rc;
	struct stat st;

	if (stat(path, &st) != 0)
		st.st_size = 0; /* the reader says what is wrong */
	if (!cmd_claim(cmd, path, cmd->tool->texel_bytes * (double)st.st_size))
		return false;
	cmd_silence_libraries(cmd);
	cmd_decode_begin(cmd, 16. * (double)st.st_size);
	rc = bake_mesh_read(path, params, mesh, &err);
	cmd_decode_end(cmd);
	if (rc != BAKE_OK)
		cmd_error(cmd, "%s", err.msg);
	return rc == BAKE_OK;
}

bool
cmd_read_mesh(struct cmd *cmd, const char *path,
    const struct bake_mesh_params *params, struct bake_mesh *mesh)
{
	bool standard = strcmp(path, "-") == 0;

	if (standard ? !read_mesh_stdin(cmd, params, mesh)
		     : !read_mesh_file(cmd, path, params, mesh))
		return false;
	if (mesh->dropped.missing_files > 0)
		cmd_recipe_none(cmd); /* they may be there the next time */
	for (size_t i = standard; i < mesh->nfiles; i++)
		cmd_list_add(&cmd->read, mesh->files[i]);
	warn_dropped(cmd, path, mesh);
	return true;
}
