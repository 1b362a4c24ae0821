/* rm-info's reports as text for people. */
/* SPDX-License-Identifier: MIT */
#include "info.h"

#include <math.h>
#include <string.h>

static void
evidence(const char *what, const struct bake_evidence *e)
{
	if (e->scale == 0)
		printf("  %s none", what);
	else
		printf("  %s %+.3f (%.3g sigma, blur %d)", what, e->value,
		    fmin(fabs(e->sigmas), 9999), e->scale);
}

static void
declared(const char *said)
{
	if (strcmp(said, "unsure") != 0)
		printf("  (declared: %s)", said);
}

static void
polarity(const struct info_report *r)
{
	const struct bake_detection *d = &r->found.detection;

	printf("  polarity    %s", bake_polarity_name(d->polarity));
	evidence("corr x", &d->x);
	declared(bake_polarity_name(r->said.polarity));
	putchar('\n');
}

static void
normal_y(const struct info_report *r)
{
	const struct bake_detection *d = &r->found.detection;

	printf("  normal y    %s", bake_normal_y_name(d->normal_y));
	if (r->found.has_relief)
		evidence("corr y", &d->y);
	evidence("curl", &d->curl);
	declared(bake_normal_y_name(r->said.normal_y));
	putchar('\n');
}

static void
depth_scale(const struct info_report *r)
{
	const struct bake_detection *d = &r->found.detection;

	if (isnan(d->depth_scale))
		printf("  depth scale unsure");
	else
		printf("  depth scale %.4g (%.4g to %.4g)", d->depth_scale,
		    d->depth_scale_low, d->depth_scale_high);
	if (r->said.depth_scale > 0)
		printf("  (declared: %.4g)", r->said.depth_scale);
	putchar('\n');
}

static void
ao_scale(const struct bake_relief_meta *said)
{
	if (said->has_ao_scale)
		printf("  ao scale    %.4g  (declared)\n", said->ao_scale);
}

/* Of a blend: at which depth scale each of its layers is as it was. */
static void
keep_scale(const struct bake_relief_meta *said)
{
	if (said->nkeep == 0)
		return;
	printf("  keep scale ");
	for (int i = 0; i < said->nkeep; i++)
		printf("%s %.4g", i > 0 ? "," : "", said->keep_scale[i]);
	printf("  (declared, by layer)\n");
}

static void
normals(const struct info_report *r)
{
	const struct bake_normal_stats *n = &r->found.normals;

	/* two channels have no length */
	if (!isnan(n->length_mean))
		printf(
		    "  normals     length %.3f +- %.3f, %.2g %% with z < 0\n",
		    n->length_mean, n->length_dev, 100 * n->negative_z);
	if (r->found.has_relief)
		polarity(r);
	normal_y(r);
	if (r->found.has_relief)
		depth_scale(r);
}

static void
channels(const struct info_report *r)
{
	for (int c = 0; c < r->map.img.nchans; c++) {
		const struct bake_channel_range *v = &r->range[c];

		printf("  channel %-3s %.6g to %.6g, mean %.4g",
		    info_channel(&r->map, c), v->min, v->max, v->mean);
		if (v->nnan + v->ninf > 0)
			printf(", %zu NaN, %zu infinite", v->nnan, v->ninf);
		putchar('\n');
	}
}

void
info_text(const struct info_report *r)
{
	const struct bake_image_info *info = &r->map.info;
	const struct bake_inspection *f = &r->found;

	if (r->pair)
		printf("%s + %s\n", r->normal.path, r->map.path);
	else
		printf("%s\n", r->file);
	printf("  size        %dx%d, %d %s, %s %s%s\n", info->width,
	    info->height, info->nchans,
	    info->nchans == 1 ? "channel" : "channels", info->container,
	    r->deep ? "deep " : "", bake_data_format_name(info->data_format));
	printf("  layout      %s%s\n", info_layout(r),
	    f->guessed ? " (by its texels)" : "");
	if (r->part != NULL && info->nsubimages > 1)
		printf("  part        %s, %d of %d\n", r->part, r->number,
		    info->nsubimages);
	channels(r);
	info_layers_text(r);
	if (r->deep)
		printf("  samples     %zu; %zu texels have none, the deepest "
		       "%zu\n",
		    r->nsamples, r->nempty, r->most);
	if (f->has_normals)
		normals(r);
	ao_scale(&r->said);
	keep_scale(&r->said);
	if (!r->deep)
		printf(
		    "  seams       u %.2f, v %.2f; to the largest step inside "
		    "%.2f, %.2f\n",
		    f->seams.u, f->seams.v, f->seams.u_peak, f->seams.v_peak);
	for (int i = 0; i < r->bad.n; i++)
		printf("  contradicts %s\n", r->bad.text[i]);
}
