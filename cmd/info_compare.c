/* rm-info --compare: how far two files differ, and where. */
/* SPDX-License-Identifier: MIT */
#include "info.h"

#include <math.h>

/* Codes to compare in: the shallower file's; 0 where one holds floats. */
static int
common_codes(const struct cmd_map map[2])
{
	int a = bake_data_format_max(map[0].info.data_format);
	int b = bake_data_format_max(map[1].info.data_format);

	return a < b ? a : b;
}

/* A value as the comparison sees it: its code where there are codes. */
static double
compared(float v, int code_max)
{
	return code_max > 0 ? round((double)v * code_max) : (double)v;
}

static void
print(const struct cmd_map *map, const struct bake_comparison *c, int code_max,
    double tolerance)
{
	const struct bake_difference *d = &c->all;

	if (d->ndifferent == 0) {
		puts("equal");
		return;
	}
	printf("worst %.9g %sin channel %s at (%d, %d): %.9g and %.9g\n",
	    d->worst, code_max > 0 ? "codes " : "",
	    info_channel(map, d->channel), d->x, d->y, compared(d->a, code_max),
	    compared(d->b, code_max));
	for (int k = 0; k < c->nchans; k++) {
		d = &c->channel[k];
		printf("channel %-3s worst %.9g, mean %.4g, %zu differ, %zu "
		       "beyond %.9g\n",
		    info_channel(map, k), d->worst, d->mean, d->ndifferent,
		    d->nbeyond, tolerance);
	}
}

static bool
compare(struct cmd *cmd, const struct info_opts *o, const struct cmd_map map[2])
{
	struct bake_comparison c;
	struct bake_err err = BAKE_ERR_INIT;
	int codes = common_codes(map);

	if (bake_compare(&map[0].img, &map[1].img, codes, o->tolerance, &c,
		&err) != BAKE_OK) {
		cmd_error(cmd, "%s, %s: %s", map[0].path, map[1].path, err.msg);
		return false;
	}
	if (o->json) {
		if (!info_json_comparison(cmd, map, &c, codes))
			return false;
	} else if (!cmd->quiet) {
		print(&map[0], &c, codes, o->tolerance);
	}
	return c.all.nbeyond == 0;
}

bool
info_compare(
    struct cmd *cmd, const struct info_opts *o, const char *const path[2])
{
	struct cmd_map map[2] = { CMD_MAP_INIT, CMD_MAP_INIT };
	bool ok = cmd_read_raw(cmd, path[0], &map[0]) &&
		  cmd_read_raw(cmd, path[1], &map[1]) && compare(cmd, o, map);

	cmd_map_free(&map[0]);
	cmd_map_free(&map[1]);
	return ok;
}
