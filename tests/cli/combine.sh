# rm-combine: layers and their options, metadata, colour, bad input.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-combine rm-pack rm-info python3

# Small layers: a base and a detail of half its size, packed and as maps.
test_map normal 16 32x32 n.png
test_map ao 16 32x32 a.png
test_map depth 16 32x32 d.png
test_map normal 16 16x16 n2.png
test_map ao 16 16x16 a2.png
test_map depth 16 16x16 d2.png
rm-pack -q --no-check --normal n.png --ao a.png --depth d.png -s 0.1 -o base.png
rm-pack -q --no-check --normal n2.png --ao a2.png --depth d2.png -s 0.02 \
    -o detail.png

# same_codes A B [CHANNELS]
same_codes() {
	codes "$1" ${3+"$3"} >"$PRIV/one"
	codes "$2" ${3+"$3"} >"$PRIV/other"
	cmp -s "$PRIV/one" "$PRIV/other" || bad "$1 and $2 have other codes"
}

check 'one layer comes out as it is'
ok rm-combine base.png -o one.png
same_codes base.png one.png
ok rm-combine -w 0.4 base.png -o one.png
same_codes base.png one.png
ok rm-combine -t 2 detail.png --size 32x32 -o two.png
codes two.png >two
codes detail.png >one
python3 - two one <<'EOF' || bad 'the repeated layer has other codes'
import sys
two, one = ([l.split() for l in open(f)] for f in sys.argv[1:])
sys.exit(any(two[y * 32 + x] != one[y % 16 * 16 + x % 16]
             for y in range(32) for x in range(32)))
EOF

check 'a layer of plain maps is the same as the packed one'
ok rm-combine --layer-depth-scale 0.1 --normal n.png --depth d.png --ao a.png \
    -o plain.png
same_codes base.png plain.png
ok rm-combine base.png -w 0.3 -t 2 detail.png -o both.png
ok rm-combine --layer-depth-scale 0.1 --normal n.png --depth d.png \
    --ao a.png -w 0.3 -t 2 --layer-depth-scale 0.02 --depth d2.png \
    --ao a2.png --normal n2.png -o plain.png
same_result both.png plain.png

check 'a second map of a kind begins a layer, and so does a packed texture'
exits 0 rm-combine -v --normal n.png --depth d.png --ao a.png --depth d2.png \
    --normal n2.png --ao a2.png base.png -o three.png
[ "$(grep -c 'keeps it at' "$PRIV/err")" -eq 3 ] || bad 'there are not 3 layers'

check 'options belong to the layer that they precede, and end with it'
ok rm-combine base.png -w 0.3 -t 2 detail.png -o a1.png
ok rm-combine -o a2.out.png base.png --tile=2x2 --weight 0.3 detail.png
same_result a1.png a2.out.png
rm a2.out.png
ok rm-combine -w 0.3 -t 2 base.png detail.png -o b.png
differ a1.png b.png
ok rm-combine -w 0.3 base.png -w 0.3 detail.png -o b.png
ok rm-combine base.png detail.png -o c.png
same_codes b.png c.png
ok rm-combine -o d.out.png -- base.png detail.png
same_bytes c.png d.out.png
rm d.out.png
ok rm-combine -w 2 --normal-weight 1 --depth-weight 1 base.png detail.png \
    -o b.png
same_codes b.png c.png

check 'arguments from a response file keep their order'
printf '%s\n' base.png -w 0.3 -t 2 detail.png >args
ok rm-combine @args -o b.png
same_bytes a1.png b.png

check 'a layer comes from standard input, the result goes to standard output'
ok sh -c 'rm-combine --format png - -w 0.3 -t 2 detail.png -o - <base.png >b.png'
same_bytes a1.png b.png

check 'the order of layers is the order of what is said of them'
ok rm-combine --normal-blend rnm base.png -w 0.3 detail.png -o b.png
ok rm-combine --normal-blend rnm -w 0.3 detail.png base.png --size 32x32 \
    -o c.png
differ b.png c.png

check 'weight 0 removes a layer, but the first still gives the size'
ok rm-combine base.png -w 0 missing.png -o b.png
same_codes base.png b.png
ok rm-combine -w 0 base.png -t 2 detail.png -o b.png
same_codes two.png b.png
equal "$(python3 "$top/tests/cli/codes.py" size b.png)" '32 32 4 16' size

check 'depth is the weighted mean, AO the product, of the codes'
codes base.png >base
ok rm-combine base.png -w 0.3 -t 2 detail.png -o b.png
codes b.png >b
python3 - one base b <<'EOF' || bad 'they are not'
import sys
def read(f):
    return [[int(v, 16) / 65535 for v in l.split()] for l in open(f)]
detail, base, got = (read(f) for f in sys.argv[1:])
worst = 0
for i in range(1024):
    d = detail[i // 32 % 16 * 16 + i % 16]
    worst = max(worst, abs(got[i][3] - (base[i][3] + 0.3 * d[3]) / 1.3),
                abs(got[i][2] - base[i][2] * d[2]))
# half a code, and rounding of floats
sys.exit(worst * 65535 > 0.51)
EOF

check 'both depth scales travel, and rm-info shows them'
ok rm-combine base.png -w 0.3 -t 2 detail.png -s 0.2 -o m.png
exits 0 rm-info --json m.png
equal "$(json declared.depth_scale)" 0.2 'depth scale'
# S_i sum w / (w_i k_i): 0.1 1.3 / 1, 0.02 1.3 / (0.3 2)
equal "$(json declared.keep_scale)" '[0.13, 0.0433333]' 'keep scale'
ok rm-info m.png
stdout_has 'keep scale  0.13, 0.04333'
for type in tga tiff exr; do
	ok rm-combine base.png -w 0.3 -t 2 detail.png -s 0.2 -o "m.$type"
	exits 0 rm-info --json "m.$type"
	equal "$(json declared.keep_scale)" '[0.13, 0.0433333]' "$type"
done
ok rm-combine base.png --depth-weight 0 detail.png --size 32x32 -o m.png
exits 0 rm-info --json m.png
equal "$(json declared.keep_scale)" '[0.1, None]' 'no depth'

check 'a scale that nothing says is warned of'
exits 0 rm-combine --normal n.png --depth d.png --ao a.png -o m.png
stderr_one_line 'd.png: nothing says its depth scale; 0.1 is taken'
ok rm-combine --layer-depth-scale 0.1 --normal n.png --depth d.png \
    --ao a.png -o m.png

check 'plain maps that contradict what is said of them are warned of'
cp "$DATA/stone_normal.png" "$DATA/stone_depth.png" .
maps='--normal stone_normal.png --depth stone_depth.png --ao none'
# shellcheck disable=SC2086 # a list of arguments
exits 0 rm-combine --layer-depth-scale 0.08 --layer-normal-y down $maps -o m.png
stderr_has 'normal y: the maps say up, declared is down'
# shellcheck disable=SC2086 # a list of arguments
ok rm-combine --no-check --layer-depth-scale 0.08 --layer-normal-y down $maps \
    -o m.png
# shellcheck disable=SC2086 # a list of arguments
ok rm-combine --layer-depth-scale 0.08 $maps -o m.png

check 'fractional tile factors are warned of; --repeat makes them tile'
exits 0 rm-combine base.png -t 5.5 detail.png -o m.png
stderr_one_line '--repeat 2 makes it tile'
ok rm-combine base.png -t 5.5 detail.png --repeat 2 -o m.png
equal "$(python3 "$top/tests/cli/codes.py" size m.png)" '64 64 4 16' size
exits 0 rm-info --json m.png
equal "$(json declared.depth_scale)" 0.05 'depth scale'
exits 0 rm-combine base.png -t 5.25x5.5 detail.png -o m.png
stderr_has '--repeat 4 makes'
exits 0 rm-combine base.png -t 5.01234 detail.png -o m.png
stderr_one_line 'no --repeat up to 64'
ok rm-combine --wrap clamp base.png -t 5.5 detail.png -o m.png

check 'an offset by whole texels moves them'
ok rm-combine --offset 0.25,0.5 base.png -o m.png
codes m.png >got
python3 - base got <<'EOF' || bad 'they are elsewhere'
import sys
one, got = ([l for l in open(f)] for f in sys.argv[1:])
sys.exit(any(got[y * 32 + x] != one[(y + 16) % 32 * 32 + (x - 8) % 32]
             for y in range(32) for x in range(32)))
EOF

check 'what a layer holds: by its metadata, or by its own options'
ok rm-pack -q --no-check --normal n.png --ao a.png --depth d.png -s 0.1 \
    --target policarpo -o down.png
ok rm-combine down.png -o m.png
same_codes base.png m.png
ok rm-pack --unpack down.png --output-normal-y down --normal-out ny.png
ok rm-pack --unpack base.png --output-height --depth-out h.png
maps='--ao a.png --normal ny.png --depth h.png'
# shellcheck disable=SC2086 # a list of arguments
ok rm-combine $maps -o m.png
same_codes base.png m.png
# shellcheck disable=SC2086 # a list of arguments
ok rm-combine --layer-normal-y up --layer-polarity depth $maps -o m.png
differ base.png m.png
# shellcheck disable=SC2086 # a list of arguments
ok rm-combine --layer-normal-y down --layer-polarity height $maps -t 2 \
    --layer-depth-scale 0.02 --normal n2.png --depth d2.png --ao a2.png \
    -o m.png
ok rm-combine base.png -t 2 detail.png -o b.png
# 1 - v of a code's float, and back, may round a mean another way
ok rm-info --compare --tolerance 1 m.png b.png

check 'a target'\''s files'
ok rm-combine --target unreal base.png -t 2 detail.png -o u.png
present u.png u_height.png u_orm.png
ok rm-combine --list-targets
stdout_has '^unreal'
rm u.png u_height.png u_orm.png

check 'a missing occlusion is baked, or open'
ok rm-pack -q --no-check --normal n.png --depth d.png -s 0.1 -o baked.png
ok rm-combine --layer-depth-scale 0.1 --normal n.png --depth d.png -o m.png
same_codes baked.png m.png
ok rm-combine --layer-depth-scale 0.1 --normal n.png --depth d.png --ao none \
    -o m.png
equal "$(codes m.png 2 | sort -u)" ffff 'open'

check 'from-depth and bake need depth alone'
ok rm-combine --normal-blend from-depth --ao-blend bake \
    --layer-depth-scale 0.1 --depth d.png -o m.png
ok rm-pack -q --depth d.png -s 0.1 -o want.png
same_codes want.png m.png

check 'the same bytes for any number of threads, in any folder'
for blend in seed pd rnm from-depth; do
	set -- -q --normal-blend "$blend" base.png -w 0.3 -t 5.5 detail.png
	ok rm-combine "$@" -j1 -o 1.png
	for j in 2 7; do
		ok rm-combine "$@" -j$j -o j.png
		same_bytes 1.png j.png
	done
	ok env BAKE_ISA=baseline rm-combine "$@" -o j.png
	same_bytes 1.png j.png
done

# PPM maps of one colour: NAME LEVEL
flat() {
	python3 -c '
import sys
sys.stdout.buffer.write(b"P6 8 8 255 " + bytes([int(sys.argv[1])] * 192))
' "$1"
}
flat 0 >black.ppm
flat 255 >white.ppm

check 'half of black and white is 188 of 255 in sRGB'
ok rm-combine --color black.ppm base.png --color white.ppm detail.png \
    --color-out c.png -o m.png
equal "$(codes c.png | sort -u)" 'bc bc bc' colour
ok rm-combine --color-space Raw --color black.ppm base.png --color white.ppm \
    detail.png --color-out c.png -o m.png
equal "$(codes c.png | sort -u)" '80 80 80' colour
ok rm-combine --color black.ppm base.png --color-weight 0 --color white.ppm \
    detail.png --color-out c.png -o m.png
equal "$(codes c.png | sort -u)" '00 00 00' colour

check 'the relief is the same whatever the colour'
ok rm-combine base.png detail.png -o b.png
ok rm-combine --color black.ppm base.png detail.png --color-out c.png -o m.png
same_result b.png m.png

check 'the colour of one layer, at its own size, with its alpha'
test_map ao 8 16x16 c8.png
ok rm-combine --color c8.png base.png --color black.ppm detail.png \
    --color-layer 1 --color-size 16x16 --color-out c.png -o m.png
equal "$(codes c.png 0 | cksum)" "$(codes c8.png | cksum)" 'codes'
ok rm-combine --color base.png base.png --color-out c.png -o m.png
same_codes base.png c.png

check 'the depfile names every file that was read'
ok rm-combine --color black.ppm base.png --layer-depth-scale 1 --normal n2.png \
    --depth d2.png --ao a2.png --color-out c.png -o m.png -M dep.d
for f in black.ppm base.png n2.png d2.png a2.png; do
	grep -qF "$f" dep.d || bad "dep.d lacks $f"
done
grep -q '^m.png c.png:' dep.d || bad "dep.d has no rule: $(cat dep.d)"

check 'an output that is an input is safe'
cp base.png over.png
ok rm-combine over.png -t 2 detail.png -o over.png
ok rm-combine base.png -t 2 detail.png -o b.png
same_bytes over.png b.png

# bad WANT_STATUS TEXT ARGUMENT...: one reason, nothing written
mkdir bad
refused() {
	status=$1 text=$2
	shift 2
	exits "$status" rm-combine "$@" -o bad/out.png
	sed -n 1p "$PRIV/err" | grep -qF -e "$text" ||
		bad "'$*' does not say '$text': $(cat "$PRIV/err")"
	[ "$status" -ne 1 ] || stderr_one_line "$text"
	[ -z "$(ls bad)" ] || bad "'$*' leaves $(ls bad)"
}

check 'bad weights'
refused 2 'weights are not negative' -w -1 base.png
refused 2 "--weight is 'x', expected a number" -w x base.png
refused 2 "--weight is '0.3x'" -w 0.3x base.png
refused 2 "--weight is ''" -w '' base.png
refused 2 "--normal-weight is 'nan'" --normal-weight nan base.png
refused 2 "--depth-weight is 'inf'" --depth-weight inf base.png
refused 2 'all depth weights are 0' -w 0 base.png -w 0 detail.png
refused 2 'all normal weights are 0' --normal-weight 0 base.png

check 'bad tile factors, offsets, sizes, scales'
for t in 0 -1 x 2x 2x0 x2 nan 2,2 1e9; do
	refused 2 "--tile is '" -t "$t" base.png
done
for t in 1 1,2,3 a,b; do
	refused 2 "--offset is '$t'" --offset "$t" base.png
done
for t in 0x0 0x16 16x0 16 -1x4 x; do
	refused 2 "--size is '$t'" --size "$t" base.png
done
refused 2 "--depth-scale is '0'" -s 0 base.png
refused 2 "--layer-depth-scale is '-1'" --layer-depth-scale -1 base.png
refused 2 "--repeat is '0'" --repeat 0 base.png
refused 1 '--max-pixels' --size 100000x100000 base.png

check 'bad layers'
refused 2 'no input'
refused 2 'has no normals' --depth d.png
refused 2 'has no depth' --normal n.png
refused 2 'has no depth' --ao a.png
refused 2 'has no depth' -w 0 --ao a.png base.png
refused 1 'n.png: has 3 channels, a packed texture has 4' n.png
refused 1 'missing.png: ' base.png missing.png
refused 1 'missing.png: ' base.png --normal missing.png --depth d.png
refused 1 'missing.png: ' base.png --normal n.png --depth d.png \
    --ao missing.png
ok rm-pack -q --depth d.png -s 0.1 --target three -o t.tiff
refused 1 'its layout is normal' t.tiff
: >empty.png
refused 1 'empty.png' base.png empty.png

check 'bad options'
refused 2 'unknown or unclear option --tilez' base.png --tilez 2
refused 2 'is followed by no layer' base.png -t 2
refused 2 'is followed by no layer' --normal n.png --depth d.png --color x.png
refused 2 "--normal-blend is 'add'" --normal-blend add base.png
refused 2 "--ao-blend is 'max'" --ao-blend max base.png
refused 2 "--filter is 'nearest'" --filter nearest base.png
refused 2 "--target is 'x'" --target x base.png
exits 2 rm-combine base.png -O bad
stderr_has '-O means nothing here'
exits 2 rm-combine base.png
stderr_has 'no output'
exits 2 rm-combine --target unreal --format png base.png -o -
stderr_has 'writes 3 files'

check 'bad colours'
refused 1 'sRGB' --color black.ppm base.png --color-space nonsense \
    --color-out bad/c.png
refused 1 'missing.ppm' --color missing.ppm base.png --color-out bad/c.png
refused 2 'where to write it' --color black.ppm base.png
refused 2 'no layer has a --color' base.png --color-out bad/c.png
refused 2 'layer 2 has no --color' --color black.ppm base.png detail.png \
    --color-layer 2 --color-out bad/c.png
refused 2 '--color-layer is 3 of 1' --color black.ppm base.png \
    --color-layer 3 --color-out bad/c.png
refused 2 'all colour weights are 0' --color-weight 0 --color black.ppm \
    base.png --color-out bad/c.png
refused 2 'does not say what to write' --color black.ppm base.png \
    --color-out bad/c
refused 2 'both name' --color black.ppm base.png --color-out bad/out.png

check 'four layers of 1024 texels square take at most 64 bytes a texel'
if [ "${MODE-}" = asan ]; then
	skip 'sanitizers take memory of their own'
	exit 0
fi
ok rm-pack -q --ao none --depth "$DATA/stone_depth.png" -d uint16 \
    --size 1024x1024 -o big.png
python3 - <<'EOF' || bad 'they take more'
import os, resource, subprocess, sys
def peak(args):
    pid = os.spawnvp(os.P_NOWAIT, args[0], args)
    _, status, usage = os.wait4(pid, 0)
    if status:
        sys.exit(1)
    return usage.ru_maxrss * 1024
layers = ["big.png", "-w", "0.3", "-t", "5.5", "big.png", "-w", "0.5", "-t",
          "2.25", "big.png", "-w", "0.2", "big.png"]
small = peak(["rm-combine", "-q", "--size", "64x64", "base.png",
              "-o", "small.png"])
big = peak(["rm-combine", "-q", "--size", "1024x1024"] + layers +
           ["-o", "blend.png"])
per_texel = (big - small) / 1024 ** 2
if per_texel > 64:
    sys.exit("%g bytes a texel" % per_texel)
EOF
