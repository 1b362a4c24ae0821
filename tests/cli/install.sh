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
    lib/pkgconfig/relief.pc include/relief/bake.h share/relief/relief.mk \
    share/bash-completion/completions/rm-pack \
    share/zsh/site-functions/_rm-pack share/man/man1/rm-pack.1 \
    share/man/man3/libbake.3 share/man/man5/rm-formats.5 \
    share/man/man7/relief-tools.7; do
	present "$at/$f"
done
equal "$(ls 'dest dir')" opt 'the top of DESTDIR'
equal "$(find "$at" -name '*_priv.h')" '' 'private headers'
for f in "$at"/bin/*; do
	tool=$(basename "$f")
	present "$at/share/man/man1/$tool.1" \
	    "$at/share/bash-completion/completions/$tool" \
	    "$at/share/zsh/site-functions/_$tool"
done

check 'the installed tools work'
cp "$DATA/woven_depth.png" cloth_depth.png
ok "$at/bin/rm-aobake" -q -n4 cloth_depth.png -o ao.png

check 'a tree that was installed works where it was moved to'
make_at_top install DESTDIR="$PWD/stage" PREFIX=/opt/relief
mv stage/opt/relief moved
for v in prefix mk; do
	ok env PKG_CONFIG_PATH="$PWD/moved/lib/pkgconfig" \
	    pkg-config --variable="$v" relief
	cp "$PRIV/out" "$v"
done
equal "$(realpath "$(cat prefix)")" "$(realpath moved)" 'the prefix'
equal "$(realpath "$(cat mk)")" "$(realpath moved/share/relief/relief.mk)" mk
ok env PKG_CONFIG_PATH="$PWD/moved/lib/pkgconfig" pkg-config --cflags --libs \
    relief
stdout_has 'include/relief'
# a distribution's own library folder has no way back to the prefix
make_at_top install DESTDIR="$PWD/multi" PREFIX=/usr LIBDIR=/usr/lib/any-arch
ok env PKG_CONFIG_PATH="$PWD/multi/usr/lib/any-arch/pkgconfig" \
    pkg-config --variable=mk relief
stdout_has '^/usr/share/relief/relief.mk$'
ok env PKG_CONFIG_PATH="$PWD/multi/usr/lib/any-arch/pkgconfig" \
    pkg-config --variable=libdir relief
stdout_has '^/usr/lib/any-arch$'
present multi/usr/lib/any-arch/libbake.a

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
mv usr elsewhere
PKG_CONFIG_PATH=$PWD/elsewhere/lib/pkgconfig
export PKG_CONFIG_PATH
ok sh -c "${CC:-cc} -std=c11 -Wall -Werror user.c -o user \
    \$(pkg-config --cflags --libs relief)"
ok ./user
stdout_has '^works$'

check 'relief.mk bakes, and rebakes what is out of date'
cp "$DATA/bricks_depth.png" wall_depth.png
cp "$DATA/bricks_normal.png" wall_normal.png
touch -d '1 hour ago' ./*_depth.png wall_normal.png
# shellcheck disable=SC2016 # for make
printf '%s\n' 'include $(shell pkg-config --variable=mk relief)' \
    'all: cloth_relief.png wall_relief.png wall_ao.png' >bake.mk
PATH=$PWD/elsewhere/bin:$PATH
ok make -s -f bake.mk all
present cloth_relief.png wall_relief.png wall_ao.png
ok make -q -f bake.mk all
touch wall_normal.png
exits 1 make -q -f bake.mk all
ok make -s -f bake.mk all
ok make -q -f bake.mk all
touch wall_depth.png
exits 1 make -q -f bake.mk wall_ao.png

check 'the installed example has all that it names'
cp -R elsewhere/share/relief/example example
ok make -n -C example/project
stdout_has 'rm-multilayer'

check 'uninstall takes it all away, and nothing else'
echo mine >"$at/include/relief/mine.h"
echo mine >"$at/share/man/man1/mine.1"
make_at_top uninstall DESTDIR="$PWD/dest dir" PREFIX=/opt/relief
equal "$(cd "$at" && find . -type f | sort | tr '\n' ' ')" \
    './include/relief/mine.h ./share/man/man1/mine.1 ' files
absent "$at/share/relief"
make_at_top uninstall DESTDIR="$PWD/multi" PREFIX=/usr LIBDIR=/usr/lib/any-arch
equal "$(find multi -type f)" '' 'files of another LIBDIR'
