# make install: all is there, it works from its new place, uninstall takes all
# of it away.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-aobake make pkg-config
[ "$MODE" = release ] || {
	check 'installing'
	skip "only a release build is installed, this is $MODE"
	exit 0
}

# With the very variables of the build under test: nothing may be built anew
# while other tests use it.
make_at_top() {
	exits 0 env MAKEFLAGS="$OUTER_MAKEFLAGS" make -C "$top" \
	    V=1 B="${B#"$top"/}" MODE="$MODE" "$@"
	! grep -q -e '-c -o' "$PRIV/out" || bad 'something was built anew'
}

check 'install puts everything below DESTDIR and PREFIX'
make_at_top install DESTDIR="$PWD/dest dir" PREFIX=/opt/relief
at="dest dir/opt/relief"
for f in bin/rm-pack bin/rm-aobake bin/rm-info lib/libbake.a \
    lib/pkgconfig/relief.pc include/relief/bake.h \
    share/relief/relief.mk share/man/man1/rm-pack.1 \
    share/man/man5/rm-formats.5 share/man/man7/relief-tools.7; do
	present "$at/$f"
done
equal "$(ls 'dest dir')" opt 'the top of DESTDIR'
equal "$(find "$at" -name '*_priv.h')" '' 'private headers'

check 'the installed tools work'
cp "$DATA/woven_depth.png" cloth_depth.png
ok "$at/bin/rm-aobake" -q -n4 cloth_depth.png -o ao.png

check 'a program builds against the installed library'
make_at_top install PREFIX="$PWD/usr"
cat >user.c <<'END'
#include <bake.h>
#include <stdio.h>

int
main(void)
{
	struct bake_err err = BAKE_ERR_INIT;
	struct bake_image img = BAKE_IMAGE_INIT;

	if (bake_image_alloc(&img, 4, 4, 1, &err) != BAKE_OK) {
		fprintf(stderr, "%s\n", err.msg);
		return 1;
	}
	bake_image_free(&img);
	puts("works");
	return 0;
}
END
PKG_CONFIG_PATH=$PWD/usr/lib/pkgconfig
export PKG_CONFIG_PATH
ok sh -c "${CC:-cc} -std=c11 -Wall -Werror user.c -o user \
    \$(pkg-config --cflags --libs relief)"
ok ./user
stdout_has '^works$'

check 'relief.mk bakes, and rebakes what is out of date'
cp "$DATA/bricks_depth.png" wall_depth.png
cp "$DATA/bricks_normal.png" wall_normal.png
touch -d '1 hour ago' ./*_depth.png wall_normal.png
printf '%s\n' "include $PWD/usr/share/relief/relief.mk" \
    'all: cloth_relief.png wall_relief.png wall_ao.png' >bake.mk
PATH=$PWD/usr/bin:$PATH
ok make -s -f bake.mk all
present cloth_relief.png wall_relief.png wall_ao.png
ok make -q -f bake.mk all
touch wall_normal.png
exits 1 make -q -f bake.mk all
ok make -s -f bake.mk all
ok make -q -f bake.mk all
touch wall_depth.png
exits 1 make -q -f bake.mk wall_ao.png

check 'uninstall takes it all away'
make_at_top uninstall DESTDIR="$PWD/dest dir" PREFIX=/opt/relief
equal "$(find 'dest dir' -type f)" '' files
