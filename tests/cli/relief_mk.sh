# relief.mk and the example project: what is out of date is made once, and
# nothing else is; what was killed goes on.
# SPDX-License-Identifier: MIT
. "$LIB"
need make pkg-config setsid rm-aobake rm-combine rm-multilayer rm-pack \
    rm-quadfit rm-render rm-rescale-ao rm-roughen
case $(make --version | sed -n '1s/^GNU Make //p') in
[5-9]* | 4.[3-9]* | 4.[1-9][0-9]*) ;;
*)
	check 'all of this script'
	skip 'make is not GNU make 4.3 or later'
	exit 0
	;;
esac

copy_project
mkdir "$PRIV/bin"
out=$PWD/out

# The tools, counted.
for t in aobake combine multilayer pack quadfit render rescale-ao roughen; do
	printf '%s\n' '#!/bin/sh' "echo $t >>'$PRIV/starts'" \
	    "exec '$(command -v rm-$t)' \"\$@\"" >"$PRIV/bin/rm-$t"
	chmod +x "$PRIV/bin/rm-$t"
done
PATH=$PRIV/bin:$PATH

project() {
	make -C project --no-print-directory RELIEF_OUT="$out" "$@"
}

# makes 'LIST' ARGUMENTS...: with these make starts just the tools for these
# outputs (names in OUT, in any order), each once.
makes() {
	list=$(echo "$1" | tr ' ' '\n' | sed '/^$/d' | sort)
	shift
	: >"$PRIV/starts"
	ok project "$@"
	made=$(sed -n "s,^  $PWD/[a-z0-9]*/,,p" "$PRIV/out" | sort)
	[ "$made" = "$list" ] ||
		bad "'$*' makes '$(echo "$made" | tr '\n' ' ')'," \
		    "expected '$(echo "$list" | tr '\n' ' ')'"
	equal "$(grep -c . "$PRIV/starts")" "$(echo "$list" | grep -c .)" \
	    'starts of tools'
}

# The bytes of all outputs, by name.
bytes() {
	(cd "$1" && find . -type f ! -path '*/.relief/*' -exec cksum {} + |
		sort -k 3)
}

wall='wall_relief.png wall_relief_x2.png wall_preview.png'
bricks='bricks_relief.png bricks_relief_x2.png'
stone="stone_relief.png stone_relief_x2.png $wall"
woven="woven_relief.png woven_relief_x2.png"
crate='crate_depth.png crate_preview.png'
all="bricks_ao.png $bricks stone_ao.png $stone woven_ao.png $woven $crate"
all="$all torus_quadric.tsv jeans_lut.png"

check 'a build makes all, each once'
makes "$all"
# shellcheck disable=SC2086 # a list
(cd out && present $all crate_nx.png crate_ny.png crate_color.png \
    crate_mip2_depth.png)
bytes out >"$PRIV/whole"

check 'then nothing is out of date'
makes ''
stdout_has 'Nothing to be done'
ok project -q relief

check 'a build with -j 8 gives the same bytes, each once'
out=$PWD/out8
makes "$all" -j8
bytes out8 >"$PRIV/got"
same_bytes "$PRIV/got" "$PRIV/whole"
makes '' -j8
rm -r out8
out=$PWD/out

check 'a touched input: what depends on it, no more'
while read -r input outputs; do
	touch "$input"
	makes "$(eval echo "$outputs")" -j2
done <<'END'
bricks_depth.png bricks_ao.png $bricks
bricks_normal.png $bricks $crate
stone_depth.png stone_ao.png $stone
stone_normal.png $stone
woven_depth.png woven_ao.png $woven $wall
torus.obj torus_quadric.tsv wall_preview.png
project/crate.obj $crate
project/crate.mtl $crate
project/crate.options $crate
jeans_depth.png jeans_lut.png
END
makes ''
bytes out >"$PRIV/got"
same_bytes "$PRIV/got" "$PRIV/whole"

check 'a removed output, and only a further one of many'
rm out/crate_mip1_ny.png
makes "$crate"
rm out/stone_relief.png
makes "$stone"
rm out/.relief/jeans_lut.png.d
makes jeans_lut.png
makes ''
bytes out >"$PRIV/got"
same_bytes "$PRIV/got" "$PRIV/whole"

check 'a changed option: what it affects; and back'
while read -r outputs; do
	read -r change
	makes "$(eval echo "$outputs")" -j2 "$change"
	makes '' -j2 "$change"
done <<'END'
$stone
stone_PACK_FLAGS=--slope scharr
$stone crate_preview.png
RM_RENDER_FLAGS=--size 120x160
crate_preview.png wall_preview.png woven_relief_x3.png bricks_relief_x3.png stone_relief_x3.png wall_relief_x3.png
RELIEF_RESCALE=3
bricks_ao.png $bricks
bricks_DEPTH_SCALE=0.05
bricks_ao.png $bricks $wall
wall_LAYERS=stone woven -w 0.5 bricks
END
makes "$wall"
bytes out | grep -v _x3 >"$PRIV/got"
same_bytes "$PRIV/got" "$PRIV/whole"
# what is on no list any more is not clean-relief's
rm out/*_x3.png out/.relief/*_x3.*
makes "$all" -j2 RELIEF_STAMP=other
makes "$all" -j2

check 'only what was asked for, and what it needs'
makes 'bricks_ao.png bricks_relief.png' RELIEF_OUT="$PWD/one" \
    "$PWD/one/bricks_relief.png"
rm -r one

# Start anew or go on, and end it all after a while by a signal.
ended() {
	env --default-signal=INT setsid make -C project \
	    --no-print-directory RELIEF_OUT="$out" -j2 >/dev/null 2>&1 &
	pid=$!
	sleep "$2"
	kill "-$1" -- "-$pid" 2>/dev/null || :
	wait "$pid" 2>/dev/null || :
}

check 'killed at 24 moments: it goes on and ends with the same bytes'
for round in 1 2 3; do
	if [ $round = 1 ]; then
		out=$PWD/killed
	else
		# half-way to another command, and back
		touch stone_depth.png bricks_normal.png
	fi
	for t in 0.05 0.2 0.4 0.1 0.7 0.3 0.9 0.5; do
		ended KILL $t
	done
	ok project -j2
	bytes killed >"$PRIV/got"
	same_bytes "$PRIV/got" "$PRIV/whole"
	makes ''
done
equal "$(find killed -name '*.tmp*' -o -name '.*.??????')" '' litter

check 'interrupted: the same'
touch stone_depth.png bricks_normal.png
for t in 0.1 0.5 1; do
	ended INT $t
	ended TERM $t
done
ok project -j2
bytes killed >"$PRIV/got"
same_bytes "$PRIV/got" "$PRIV/whole"
makes ''

check 'killed on the way to other options, which are then taken back'
for t in 0.1 0.3 0.5 0.7; do
	setsid make -C project RELIEF_OUT="$out" stone_PACK_FLAGS='-d uint16' \
	    >/dev/null 2>&1 &
	pid=$!
	sleep $t
	kill -KILL -- "-$pid" 2>/dev/null || :
	wait "$pid" 2>/dev/null || :
	ok project
	bytes killed >"$PRIV/got"
	same_bytes "$PRIV/got" "$PRIV/whole"
done

check 'a tool that fails: its message, and the next make starts it again'
exits 2 project jeans_ROUGHEN_FLAGS=--frob
stderr_has 'rm-roughen: .*--frob'
makes jeans_lut.png
makes ''

check 'a missing input is named'
mv stone_depth.png hidden.png
exits 2 project RELIEF_NAMES='stone cork' RELIEF_OUT="$PWD/new"
stderr_has "No rule to make target '../cork_depth.png'"
exits 2 project crate_MESH=gone.obj
stderr_has "No rule to make target 'gone.obj'"
mv hidden.png stone_depth.png
# one that only a depfile names: no wedge; the tool bakes without it, and
# does not name what it did not read
mv project/crate.mtl hidden.mtl
exits 0 project
mv hidden.mtl project/crate.mtl
touch project/crate.obj
makes "$crate"
bytes killed >"$PRIV/got"
same_bytes "$PRIV/got" "$PRIV/whole"
rm -rf new

check 'clean-relief removes what was made, and nothing else'
: >killed/mine.png
ok project clean-relief
equal "$(ls -A killed)" mine.png 'what is left'
rm -r killed
out=$PWD/out
ok project -j8 clean-relief
absent out

check 'inputs and outputs in one folder, other names and kinds'
mkdir flat
cp bricks_depth.png flat/up_height.png
cp woven_depth.png flat/cloth_depth.png
cp cushion_normal.png flat/pad_normal.png
cp stone_depth.png flat/dark_depth.png
cp woven_depth.png flat/dark_ao.png
printf '%s\n' 'RELIEF_NAMES = up cloth pad dark' "include $top/scripts/relief.mk" \
    >flat/Makefile
exits 0 make -C flat --no-print-directory
equal "$(sed -n 's/^  //p' "$PRIV/out" | sort | tr '\n' ' ')" 'cloth_ao.png '\
'cloth_relief.png dark_relief.png pad_relief.png up_ao.png up_relief.png ' made
same_bytes flat/dark_ao.png woven_depth.png
exits 0 make -C flat -q
touch flat/cloth_depth.png
exits 0 make -C flat --no-print-directory
equal "$(sed -n 's/^  //p' "$PRIV/out" | tr '\n' ' ')" \
    'cloth_ao.png cloth_relief.png ' made
exits 0 rm-pack -q --height --depth bricks_depth.png -o up.png
same_result up.png flat/up_relief.png
exits 0 make -C flat clean-relief
equal "$(cd flat && find . -mindepth 1 | sort | tr '\n' ' ')" './Makefile ./cloth_depth.png '\
'./dark_ao.png ./dark_depth.png ./pad_normal.png ./up_height.png ' 'what is left'

check 'every target: relief.mk knows what rm-pack writes'
for target in $(rm-pack --list-targets | sed 's/ .*//'); do
	exits 0 make -C flat RELIEF_TARGET="$target" RELIEF_NAMES=dark \
	    RELIEF_OUT="$PWD/t"
	exits 0 make -C flat -n -p RELIEF_TARGET="$target" RELIEF_NAMES=dark \
	    RELIEF_OUT="$PWD/t"
	sed -n 's/^relief_outs\.[^ ]*dark_relief.png := //p' "$PRIV/out" |
		tr ' ' '\n' | sed '/^$/d' | sort >"$PRIV/want"
	find "$PWD/t" -name "dark_*" ! -path "*/.relief/*" | sort >"$PRIV/got"
	same_bytes "$PRIV/got" "$PRIV/want"
	case $target in
	quake3 | darkplaces) ;;
	*)
		exits 0 make -C flat RELIEF_TARGET="$target" \
		    RELIEF_NAMES=dark RELIEF_OUT="$PWD/t" RELIEF_RESCALE=2
		;;
	esac
	rm -rf t
done

check 'two makers of one file are refused'
exits 2 make -C flat RELIEF_NAMES=dark RELIEF_META=dark
stderr_has "relief.mk: 'dark_relief.png' would be made for 'dark'"

check 'without lists: pattern rules'
mkdir old
cp bricks_depth.png old/wall_depth.png
cp bricks_normal.png old/wall_normal.png
printf '%s\n' "include $top/scripts/relief.mk" \
    'all: wall_relief.png wall_ao.png' >old/Makefile
exits 0 make -C old
present old/wall_relief.png old/wall_ao.png
exits 0 make -C old -q
touch old/wall_normal.png
exits 1 make -C old -q wall_relief.png
exits 0 make -C old -q wall_ao.png
