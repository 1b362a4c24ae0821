# libbake(3): its table names every header, and its example, as it stands in the
# page, builds against an installed library and does what the page says.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-aobake rm-info make pkg-config python3
page=$top/man/libbake.3

check 'libbake(3) names each header of bake.h, and no other'
sed -n 's/^#include "\(.*\)"/\1/p' "$top/libbake/bake.h" | sort >headers
sed -n 's/^\.It Pa \(.*\.h\)$/\1/p' "$page" | sort >named
same_bytes headers named

[ "$MODE" = release ] || {
	check 'the example of libbake(3)'
	skip "only a release build is installed, this is $MODE"
	exit 0
}

check 'the example of libbake(3) builds with what pkg-config says'
sed -n '/^\.Bd/,/^\.Ed/{ /^\./d; s/\\e/\\/g; p; }' "$page" >example.c
exits 0 env MAKEFLAGS="$OUTER_MAKEFLAGS" make -C "$top" B="${B#"$top"/}" \
    MODE="$MODE" install DESTDIR="$PWD/dest" PREFIX=/opt/relief
PKG_CONFIG_PATH=$PWD/dest/opt/relief/lib/pkgconfig
export PKG_CONFIG_PATH
for flags in '' '-std=c11 -Wall -Wextra -Werror'; do
	ok sh -c "${CC:-cc} $flags example.c -o example \
	    \$(pkg-config --cflags --libs relief)"
done
present example

check 'a flat map is open: exactly 1'
printf 'P5\n8 8\n255\n%064d' 0 >flat.pgm
ok ./example flat.pgm 0.1 flat.png
equal "$(codes flat.png | sort -u)" ffff 'the codes of a flat map'

check 'it gives what rm-aobake gives'
ok ./example "$DATA/stone_depth.png" 0.1 stone.png
ok rm-aobake -q -s 0.1 -d uint16 "$DATA/stone_depth.png" -o tool.png
ok rm-info --compare stone.png tool.png
codes stone.png >stone.codes
codes tool.png >tool.codes
same_bytes stone.codes tool.codes
[ "$(sort -u stone.codes | wc -l)" -gt 100 ] || bad 'hardly a code in it'

check 'its errors are whole messages'
exits 1 ./example missing.png 0.1 out.png
stderr_one_line "missing.png"
exits 1 ./example flat.pgm -1 out.png
stderr_one_line 'scale'
exits 2 ./example flat.pgm
absent out.png
