/* Contrast curves as the paper's figure 3 draws them, in pixels or as SVG. */
/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "roughen_draw_priv.h"
#include "roughen_picture.h"

enum {
	WIDTH = 560,
	HEIGHT = 640,
	LEFT = 80,
	RIGHT = 520,
	MARKS = 4 * BAKE_ROUGHEN_ANGLES + 64
};

/* A line, or with text a text whose top left corner is `from`. */
struct mark {
	double from[2], to[2];
	double width;
	float grey;
	char text[72];
};

struct plot {
	int n;
	struct mark mark[MARKS];
};

static const float black = 0, grey = 0.55f, faint = 0.85f;

static void
add_line(struct plot *p, double x0, double y0, double x1, double y1,
    double width, float shade)
{
	struct mark m = { { x0, y0 }, { x1, y1 }, width, shade, "" };

	if (p->n < MARKS)
		p->mark[p->n++] = m;
}

static void
add_text(struct plot *p, double x, double y, float shade, const char *text)
{
	struct mark m = { { x, y }, { x, y }, 0, shade, "" };

	snprintf(m.text, sizeof m.text, "%s", text);
	if (p->n < MARKS)
		p->mark[p->n++] = m;
}

static double
x_of(double angle_deg)
{
	return LEFT + (RIGHT - LEFT) * angle_deg / 90;
}

/* One panel: rows top .. bottom for 0 .. most. */
struct panel {
	double top, bottom, most;
};

static double
y_of(const struct panel *at, double v)
{
	return at->bottom - (at->bottom - at->top) * v / at->most;
}

/* v[i] over the angles; values that are no numbers are gaps. */
static void
add_curve(struct plot *p, const struct panel *at,
    const struct bake_roughen_curve *curve, const double *v, float shade)
{
	for (int i = 0; i + 1 < curve->n; i++)
		if (isfinite(v[i]) && isfinite(v[i + 1]))
			add_line(p, x_of(curve->angle_deg[i]), y_of(at, v[i]),
			    x_of(curve->angle_deg[i + 1]), y_of(at, v[i + 1]),
			    2.5, shade);
	if (curve->n == 1 && isfinite(v[0]))
		add_line(p, x_of(curve->angle_deg[0]) - 3, y_of(at, v[0]),
		    x_of(curve->angle_deg[0]) + 3, y_of(at, v[0]), 2.5, shade);
}

static void
add_axes(struct plot *p, const struct panel *at)
{
	char text[16];

	for (int a = 0; a <= 90; a += 10) {
		add_line(p, x_of(a), at->top, x_of(a), at->bottom, 1, faint);
		snprintf(text, sizeof text, "%d", a);
		add_text(p, x_of(a) - (a < 10 ? 5 : 11), at->bottom + 8, black,
		    text);
	}
	add_line(p, LEFT, at->top, LEFT, at->bottom, 1.5, black);
	add_line(p, LEFT, at->bottom, RIGHT, at->bottom, 1.5, black);
}

static double
largest(const double *v, int n)
{
	double most = 0;

	for (int i = 0; i < n; i++)
		if (isfinite(v[i]) && v[i] > most)
			most = v[i];
	return most > 0 ? most : 1;
}

static void
add_top(struct plot *p, double most, double top, double x, float shade)
{
	char text[16];

	snprintf(text, sizeof text, "%.3g", most);
	add_text(p, x, top - 4, shade, text);
}

static void
make_plot(
    struct plot *p, const struct bake_roughen_curve *curve, const char *title)
{
	struct panel above = { 60, 280, 1 }, median = { 350, 570, 1 };
	struct panel contrast = median;
	double low[BAKE_ROUGHEN_ANGLES], mid[BAKE_ROUGHEN_ANGLES],
	    high[BAKE_ROUGHEN_ANGLES], c[BAKE_ROUGHEN_ANGLES];

	p->n = 0;
	for (int i = 0; i < curve->n; i++) {
		low[i] = curve->stats[i].p05;
		mid[i] = curve->stats[i].p50;
		high[i] = curve->stats[i].p95;
		c[i] = bake_roughen_contrast(&curve->stats[i]);
	}
	above.most = largest(high, curve->n);
	median.most = largest(mid, curve->n);
	contrast.most = largest(c, curve->n);
	add_text(p, LEFT, 12, black, title);
	add_text(p, LEFT, 34, black, "median");
	add_text(p, LEFT + 110, 34, grey, "5 %, 95 %");
	add_axes(p, &above);
	add_curve(p, &above, curve, low, grey);
	add_curve(p, &above, curve, high, grey);
	add_curve(p, &above, curve, mid, black);
	add_top(p, above.most, above.top, 10, black);
	add_text(p, LEFT, 324, black, "median");
	add_text(p, LEFT + 110, 324, grey, "contrast");
	add_axes(p, &median);
	add_curve(p, &contrast, curve, c, grey);
	add_curve(p, &median, curve, mid, black);
	add_top(p, median.most, median.top, 10, black);
	add_top(p, contrast.most, contrast.top + 20, 10, grey);
	add_text(p, LEFT, 608, black, "angle of incidence, degrees");
}

enum bake_status
bake_roughen_plot(const struct bake_roughen_curve *curve, const char *title,
    struct bake_image *img, struct bake_err *err)
{
	struct plot p;
	enum bake_status rc = bake_image_alloc(img, WIDTH, HEIGHT, 1, err);

	if (rc != BAKE_OK)
		return rc;
	make_plot(&p, curve, title);
	bake_draw_fill(img, 1);
	for (int i = 0; i < p.n; i++) {
		const struct mark *m = &p.mark[i];

		if (*m->text != '\0')
			bake_draw_text(img, (int)m->from[0], (int)m->from[1], 2,
			    m->grey, m->text);
		else
			bake_draw_line(img, m->from, m->to, m->width, m->grey);
	}
	return BAKE_OK;
}

static void
put_escaped(const char *text, FILE *stream)
{
	for (; *text != '\0'; text++) {
		if (*text == '<')
			fputs("&lt;", stream);
		else if (*text == '&')
			fputs("&amp;", stream);
		else
			putc(*text, stream);
	}
}

void
bake_roughen_plot_svg(
    const struct bake_roughen_curve *curve, const char *title, FILE *stream)
{
	struct plot p;

	make_plot(&p, curve, title);
	fprintf(stream,
	    "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" "
	    "height=\"%d\" font-family=\"sans-serif\" font-size=\"15\" "
	    "stroke-linecap=\"round\">\n<rect width=\"%d\" height=\"%d\" "
	    "fill=\"white\"/>\n",
	    WIDTH, HEIGHT, WIDTH, HEIGHT);
	for (int i = 0; i < p.n; i++) {
		const struct mark *m = &p.mark[i];
		const int shade = (int)(255 * m->grey + 0.5f);

		if (*m->text == '\0') {
			fprintf(stream,
			    "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" "
			    "y2=\"%.2f\" stroke-width=\"%g\" "
			    "stroke=\"#%02x%02x%02x\"/>\n",
			    m->from[0], m->from[1], m->to[0], m->to[1],
			    m->width, shade, shade, shade);
			continue;
		}
		fprintf(stream,
		    "<text x=\"%.2f\" y=\"%.2f\" fill=\"#%02x%02x%02x\">",
		    m->from[0], m->from[1] + 13, shade, shade, shade);
		put_escaped(m->text, stream);
		fputs("</text>\n", stream);
	}
	fputs("</svg>\n", stream);
}
