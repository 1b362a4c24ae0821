/* rm-quadfit: one mesh, from reading to writing. */
/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "cmd_mesh.h"
#include "cmd_recipe.h"
#include "output.h"
#include "quadfit.h"
#include "quadric_write.h"

void
quadfit_free(struct quadfit *q)
{
	bake_mesh_free(&q->mesh);
	bake_frames_free(&q->frames);
	free(q->quadrics);
	q->quadrics = NULL;
}

bool
quadfit_is_gltf(const char *path)
{
	const char *dot = strrchr(path, '.');
	char magic[4] = "";
	struct stat st;
	/* a pipe would wait, and lose what is read */
	FILE *fp = stat(path, &st) == 0 && S_ISREG(st.st_mode)
		       ? fopen(path, "rbe")
		       : NULL;
	bool binary = fp != NULL && fread(magic, 1, 4, fp) == 4 &&
		      memcmp(magic, "glTF", 4) == 0;

	if (fp != NULL)
		fclose(fp);
	return binary || (dot != NULL && (strcasecmp(dot, ".gltf") == 0 ||
					     strcasecmp(dot, ".glb") == 0));
}

/* Whether tangents can be made as was asked for. */
static bool
has_tangents(struct cmd *cmd, const struct quadfit_opts *o, const char *path,
    const struct bake_mesh *mesh)
{
	if (mesh->nuvs > 0 || o->frames.tangents == BAKE_TANGENTS_AUTO ||
	    (o->frames.tangents == BAKE_TANGENTS_FILE &&
		mesh->tangents != NULL))
		return true;
	cmd_error(cmd,
	    "%s: has no UVs%s, which tangents follow: use --frame auto for "
	    "tangents of any direction",
	    path, o->mesh.uv_set > 0 ? " in that set" : "");
	return false;
}

/* What was wrong with the mesh, but can be worked with. */
static void
warn_frames(struct cmd *cmd, const struct quadfit_opts *o, const char *path,
    const struct bake_frames *f)
{
	if (f->normal_none > 0)
		cmd_warn(cmd,
		    "%s: %zu corners are in triangles without an area only: "
		    "their quadrics are 0",
		    path, f->normal_none);
	if (f->tangent_none > f->normal_none &&
	    o->frames.tangents != BAKE_TANGENTS_AUTO)
		cmd_warn(cmd,
		    "%s: %zu corners have no UVs, or UVs without an area: "
		    "their tangents are of any direction",
		    path, f->tangent_none);
	if (f->mirror_mixed > 0)
		cmd_note(cmd,
		    "%s: %zu corners are in mirrored and in "
		    "unmirrored UVs",
		    path, f->mirror_mixed);
}

bool
quadfit_fit(struct cmd *cmd, const struct quadfit_opts *o, const char *path,
    struct quadfit *q)
{
	struct bake_quadric_params fit = o->fit;
	struct bake_err err = BAKE_ERR_INIT;
	struct cmd_progress bar;
	bool ok;

	if (!has_tangents(cmd, o, path, &q->mesh))
		return false;
	fit.nthreads = cmd->nthreads;
	fit.progress = cmd_progress_start(cmd, &bar);
	ok = bake_quadric_fit_mesh(&q->mesh, o->weld, &o->frames, &fit,
		 &q->frames, &q->quadrics, &err) == BAKE_OK;
	cmd_progress_end(&bar);
	if (ok)
		warn_frames(cmd, o, path, &q->frames);
	else
		cmd_error(cmd, "%s: %s", path, err.msg);
	return ok;
}

static bool
write_table(struct cmd *cmd, const struct quadfit_opts *o,
    const struct quadfit *q, const char *path, enum quadfit_type type)
{
	struct cmd_record record;
	const struct bake_quadric_table table = { &q->mesh, &q->frames,
		q->quadrics, &o->fit, o->frame, record.text, record.list };
	struct bake_output out = BAKE_OUTPUT_INIT;
	struct bake_err err = BAKE_ERR_INIT;
	enum bake_status rc = bake_output_open(&out, path, &err);

	(void)cmd_recipe_record(cmd, path, &record);
	if (rc == BAKE_OK) {
		rc = type == QUADFIT_TSV
			 ? bake_quadric_write_tsv(out.stream, &table, &err)
		     : type == QUADFIT_JSON
			 ? bake_quadric_write_json(out.stream, &table, &err)
			 : bake_quadric_write_ply(out.stream, &table, &err);
		if (rc == BAKE_OK && type != QUADFIT_TSV)
			rc = cmd_recipe_seal(&record, out.stream, &err);
		if (rc == BAKE_OK && !cmd_same_bytes(cmd, out.stream, path))
			rc = bake_output_commit(&out, &err);
	}
	bake_output_abort(&out);
	if (rc != BAKE_OK) {
		cmd_error(cmd, "%s", err.msg);
		return false;
	}
	cmd_list_add(&cmd->written, path);
	return true;
}

static bool
read_mesh(struct cmd *cmd, const struct quadfit_opts *o, const char *path,
    bool to_gltf, struct bake_mesh *mesh)
{
	if (!cmd_read_mesh(cmd, path, &o->mesh, mesh))
		return false;
	/* only glTF says which way is up */
	if (!to_gltf || strcmp(path, "-") != 0 || !mesh->y_up)
		return true;
	cmd_error(cmd, "standard input: glTF that is to be written as glTF "
		       "must be a file");
	return false;
}

bool
quadfit_file(struct cmd *cmd, const struct quadfit_opts *o, const char *path,
    const char *out, enum quadfit_type type)
{
	struct quadfit q = QUADFIT_INIT;
	bool gltf = type == QUADFIT_GLB || type == QUADFIT_GLTF, ok;

	if (out != NULL && gltf && quadfit_is_gltf(path))
		return quadfit_gltf(cmd, o, path, out, type == QUADFIT_GLB);
	if (!read_mesh(cmd, o, path, out != NULL && gltf, &q.mesh)) {
		quadfit_free(&q);
		return false;
	}
	ok = quadfit_fit(cmd, o, path, &q);
	if (ok && out != NULL)
		ok = gltf ? quadfit_make_gltf(
				cmd, o, path, &q, out, type == QUADFIT_GLB)
			  : write_table(cmd, o, &q, out, type);
	if (ok && o->stats)
		ok = quadfit_print_stats(cmd, o, path, &q);
	quadfit_free(&q);
	return ok;
}
