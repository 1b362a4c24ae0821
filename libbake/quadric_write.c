/* Tables of quadrics: TSV, JSON and PLY. */
/* SPDX-License-Identifier: MIT */
#include "quadric_write.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "quadric_text_priv.h"

enum kind { INT, CHAR, UCHAR, DOUBLE };

static const struct {
	const char *name;
	enum kind kind;
} columns[] = {
	{ "v", INT },
	{ "vt", INT },
	{ "x", DOUBLE },
	{ "y", DOUBLE },
	{ "z", DOUBLE },
	{ "nx", DOUBLE },
	{ "ny", DOUBLE },
	{ "nz", DOUBLE },
	{ "tx", DOUBLE },
	{ "ty", DOUBLE },
	{ "tz", DOUBLE },
	{ "hand", CHAR },
	{ "a", DOUBLE },
	{ "b", DOUBLE },
	{ "c", DOUBLE },
	{ "uvscale_s", DOUBLE },
	{ "uvscale_t", DOUBLE },
	{ "a_tex", DOUBLE },
	{ "b_tex", DOUBLE },
	{ "c_tex", DOUBLE },
	{ "rank", UCHAR },
	{ "residual", DOUBLE },
};

enum {
	NCOLUMNS = sizeof columns / sizeof *columns,
	ROW_TEXT = NCOLUMNS * (BAKE_NUMBER_TEXT + 16) + 16
};

/* The values of a row; whole numbers are exact in a double. */
static void
get_row(const struct bake_quadric_table *t, size_t i, double v[NCOLUMNS])
{
	const struct bake_frame *f = &t->frames->frame[i];
	const struct bake_quadric *q = &t->quadrics[i];
	const double *p = t->mesh->positions[f->v];
	const double row[NCOLUMNS] = { f->v, f->vt, p[0], p[1], p[2],
		f->normal[0], f->normal[1], f->normal[2], f->tangent[0],
		f->tangent[1], f->tangent[2], f->hand, q->a, q->b, q->c,
		q->uvscale[0], q->uvscale[1], q->a_tex, q->b_tex, q->c_tex,
		q->rank, q->residual };

	/* + 0: no -0 */
	for (int c = 0; c < NCOLUMNS; c++)
		v[c] = row[c] + 0.0;
}

static const char *
sign_name(const struct bake_quadric_table *t)
{
	return t->params->sign == BAKE_QUADRIC_DEPTH ? "depth" : "outward";
}

static const char *
model_name(const struct bake_quadric_table *t)
{
	return t->params->model == BAKE_QUADRIC_FULL ? "full" : "ab";
}

static bool
is_text(const char *text)
{
	return text != NULL && text[0] != '\0';
}

/* -- text ------------------------------------------------------------------ */

enum bake_status
bake_quadric_write_tsv(
    FILE *fp, const struct bake_quadric_table *table, struct bake_err *err)
{
	(void)err;
	for (int c = 0; c < NCOLUMNS; c++)
		fprintf(fp, "%s%s", c > 0 ? "\t" : "", columns[c].name);
	putc('\n', fp);
	for (size_t i = 0; i < table->frames->nframes; i++) {
		double v[NCOLUMNS];
		char text[ROW_TEXT], *at = text;

		get_row(table, i, v);
		for (int c = 0; c < NCOLUMNS; c++) {
			at = bake_number_text(at, v[c]);
			*at++ = c + 1 < NCOLUMNS ? '\t' : '\n';
		}
		fwrite(text, 1, (size_t)(at - text), fp);
	}
	return BAKE_OK;
}

static void
put_number(FILE *fp, const char *key, double v)
{
	char text[BAKE_NUMBER_TEXT];

	fprintf(fp, "\"%s\": %.*s,\n", key,
	    (int)(bake_number_text(text, v) - text), text);
}

static void
put_number_or_null(FILE *fp, const char *key, double v)
{
	if (v > 0)
		put_number(fp, key, v);
	else
		fprintf(fp, "\"%s\": null,\n", key);
}

enum bake_status
bake_quadric_write_json(
    FILE *fp, const struct bake_quadric_table *table, struct bake_err *err)
{
	const struct bake_quadric_params *p = table->params;

	(void)err;
	fprintf(fp, "{\"sign\": \"%s\",\n\"model\": \"%s\",\n",
	    sign_name(table), model_name(table));
	put_number(fp, "order", p->order);
	put_number_or_null(fp, "ring", p->ring);
	fprintf(fp, "\"frame\": \"%s\",\n", table->frame);
	put_number(fp, "depth_scale", p->depth_scale);
	put_number_or_null(fp, "depth", p->depth);
	if (is_text(table->record))
		fprintf(fp, "\"relief:Recipe\": \"%s\",\n", table->record);
	if (is_text(table->record_list))
		fprintf(fp, "\"relief:RecipeFiles\": \"%s\",\n",
		    table->record_list);
	fputs("\"corners\": [", fp);
	for (size_t i = 0; i < table->frames->nframes; i++) {
		double v[NCOLUMNS];
		char text[ROW_TEXT], *at = text;

		get_row(table, i, v);
		at = stpcpy(at, i > 0 ? ",\n{" : "\n{");
		for (int c = 0; c < NCOLUMNS; c++) {
			at = stpcpy(at, c > 0 ? ", \"" : "\"");
			at = stpcpy(at, columns[c].name);
			at = stpcpy(at, "\": ");
			at = bake_number_text(at, v[c]);
		}
		*at++ = '}';
		fwrite(text, 1, (size_t)(at - text), fp);
	}
	fputs("\n]}\n", fp);
	return BAKE_OK;
}

/* -- PLY ---------------------------------------------------------------------
 */

static unsigned char *
put_u32(unsigned char *at, uint32_t v)
{
	for (int i = 0; i < 4; i++)
		*at++ = (unsigned char)(v >> 8 * i);
	return at;
}

static unsigned char *
put_double(unsigned char *at, double v)
{
	uint64_t u;

	memcpy(&u, &v, sizeof u);
	return put_u32(put_u32(at, (uint32_t)u), (uint32_t)(u >> 32));
}

static void
put_ply_header(FILE *fp, const struct bake_quadric_table *t)
{
	static const char *const kinds[] = { "int", "char", "uchar", "double" };
	const struct bake_quadric_params *p = t->params;
	char text[BAKE_NUMBER_TEXT];

	fputs("ply\nformat binary_little_endian 1.0\n", fp);
	fprintf(fp, "comment quadric sign %s\ncomment quadric model %s\n",
	    sign_name(t), model_name(t));
	fprintf(fp, "comment quadric order %d\ncomment quadric frame %s\n",
	    p->order, t->frame);
	if (p->ring > 0)
		fprintf(fp, "comment quadric ring %d\n", p->ring);
	fprintf(fp, "comment quadric %s %.*s\n",
	    p->depth > 0 ? "depth" : "depth_scale",
	    (int)(bake_number_text(
		      text, p->depth > 0 ? p->depth : p->depth_scale) -
		  text),
	    text);
	if (is_text(t->record))
		fprintf(fp, "comment relief:Recipe=%s\n", t->record);
	if (is_text(t->record_list))
		fprintf(fp, "comment relief:RecipeFiles=%s\n", t->record_list);
	fprintf(fp, "element vertex %zu\n", t->frames->nframes);
	for (int c = 0; c < NCOLUMNS; c++)
		fprintf(fp, "property %s %s\n", kinds[columns[c].kind],
		    columns[c].name);
	if (t->mesh->nuvs > 0)
		fputs("property double s\nproperty double t\n", fp);
	fprintf(fp,
	    "element face %zu\n"
	    "property list uchar int vertex_indices\nend_header\n",
	    t->frames->ntriangles);
}

static void
put_ply_vertex(FILE *fp, const struct bake_quadric_table *t, size_t i)
{
	const double none[2] = { 0, 0 };
	const double *uv = none;
	unsigned char row[8 * (NCOLUMNS + 2)], *at = row;
	double v[NCOLUMNS];

	get_row(t, i, v);
	for (int c = 0; c < NCOLUMNS; c++)
		if (columns[c].kind == INT)
			at = put_u32(at, (uint32_t)(int32_t)v[c]);
		else if (columns[c].kind == DOUBLE)
			at = put_double(at, v[c]);
		else
			*at++ = (unsigned char)(int)v[c];
	if (t->mesh->nuvs > 0) {
		if (t->frames->frame[i].vt >= 0)
			uv = t->mesh->uvs[t->frames->frame[i].vt];
		at = put_double(put_double(at, uv[0]), uv[1]);
	}
	fwrite(row, 1, (size_t)(at - row), fp);
}

enum bake_status
bake_quadric_write_ply(
    FILE *fp, const struct bake_quadric_table *table, struct bake_err *err)
{
	const struct bake_frames *f = table->frames;

	if (f->nframes > INT32_MAX || f->ntriangles > INT32_MAX)
		return bake_fail(err, BAKE_EDATA,
		    "%zu vertices and %zu faces are too many for PLY",
		    f->nframes, f->ntriangles);
	put_ply_header(fp, table);
	for (size_t i = 0; i < f->nframes; i++)
		put_ply_vertex(fp, table, i);
	for (size_t i = 0; i < f->ntriangles; i++) {
		unsigned char row[13], *at = row;

		*at++ = 3;
		for (int k = 0; k < 3; k++)
			at = put_u32(at, (uint32_t)f->frame_of[i][k]);
		fwrite(row, 1, sizeof row, fp);
	}
	return BAKE_OK;
}
