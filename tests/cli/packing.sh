# Packing keeps every code, and unpacking is the way back.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-info python3

# The codes of a packed file are those of the maps: r g of the normal, the
# occlusion, the depth; decoded by a witness that is not ours.
packed_is() {
	codes "$3_normal.png" 0,1 >"$PRIV/n"
	codes "$3_ao.png" >"$PRIV/a"
	codes "$3_depth.png" >"$PRIV/d"
	paste -d ' ' "$PRIV/n" "$PRIV/a" "$PRIV/d" >"$PRIV/want"
	codes "$1" >"$PRIV/got"
	cmp -s "$PRIV/want" "$PRIV/got" ||
		bad "$1 ($2) differs from the maps in $(diff "$PRIV/want" \
		    "$PRIV/got" | grep -c '^>') texels"
}

check 'the test maps: depth 0 in a third of the texels'
for bits in 8 16; do
	for kind in normal ao depth; do
		test_map $kind $bits 61x38 "${bits}_$kind.png"
	done
done
test_map ao 8 61x38 8_ao.png
[ "$(codes 8_depth.png | grep -c '^00$')" -gt 700 ] || bad 'too few'

pack() {
	ok rm-pack -q --normal "$1_normal.png" --depth "$1_depth.png" \
	    --ao "$1_ao.png" -o "$2"
}

for to in '8 png' '8 tga' '8 tiff' '16 png' '16 tiff'; do
	bits=${to% *} type=${to#* }
	check "$type, $bits bits: every code of every channel is kept"
	pack "$bits" "p$bits.$type"
	packed_is "p$bits.$type" "$bits bits" "$bits"

	check "$type, $bits bits: unpacking is the way back"
	ok rm-pack --unpack "p$bits.$type" --normal-out un.png \
	    --ao-out ua.png --depth-out ud.png
	codes ua.png >ua
	codes "${bits}_ao.png" | cmp -s - ua || bad 'occlusion differs'
	codes ud.png >ud
	codes "${bits}_depth.png" | cmp -s - ud || bad 'depth differs'
	codes un.png 0,1 >un
	codes "${bits}_normal.png" 0,1 | cmp -s - un || bad 'normal differs'

	check "$type, $bits bits: packing what was unpacked changes no texel"
	ok rm-pack -q --normal un.png --ao ua.png --depth ud.png \
	    -o "again.$type"
	same_result "p$bits.$type" "again.$type"
done

check 'exr, half: eight-bit codes come back from halves'
ok rm-pack -q -d half --normal 8_normal.png --depth 8_depth.png \
    --ao 8_ao.png -o p.exr
ok rm-pack --unpack p.exr -d uint8 --normal-out un.png --ao-out ua.png \
    --depth-out ud.png
for c in ao:ua depth:ud; do
	codes "8_${c%:*}.png" >want
	codes "${c#*:}.png" >got
	cmp -s want got || bad "${c%:*} differs"
done
codes 8_normal.png 0,1 >want
codes un.png 0,1 >got
cmp -s want got || bad 'normal differs'

check 'exr, half: unpacked and packed again, bit for bit'
ok rm-pack --unpack p.exr --normal-out n.exr --ao-out a.exr --depth-out d.exr
ok rm-pack -q --normal n.exr --ao a.exr --depth d.exr -o again.exr
same_result p.exr again.exr
codes p.exr >want
codes again.exr >got
same_bytes want got

check 'exr, float: 16-bit codes come back'
ok rm-pack -q -d float --normal 16_normal.png --depth 16_depth.png \
    --ao 16_ao.png -o f.exr
ok rm-pack --unpack f.exr -d uint16 --normal-out un.png --ao-out ua.png \
    --depth-out ud.png
codes 16_depth.png >want
codes ud.png >got
same_bytes want got
codes 16_normal.png 0,1 >want
codes un.png 0,1 >got
same_bytes want got

check 'exr names: RGBA by default, telling ones with --exr-names'
ok rm-info p.exr
grep -aq normal.x p.exr && bad 'p.exr has telling names'
ok rm-pack -q --exr-names -d half --normal 8_normal.png \
    --depth 8_depth.png --ao 8_ao.png -o named.exr
for n in normal.x normal.y ao depth; do
	grep -aq "$n" named.exr || bad "named.exr has no $n"
done
ok rm-pack --unpack named.exr -d uint8 --depth-out ud.png --ao-out ua.png \
    --normal-out un.png
codes 8_depth.png >want
codes ud.png >got
same_bytes want got

check 'from type to type: the comparison finds no difference'
pack 8 p.png
pack 8 p.tga
pack 8 p.tiff
ok rm-info --compare p.png p.tga
ok rm-info --compare p.png p.tiff

check 'the comparison sees what is under a depth of 0'
python3 - "$top/tests/cli" 8_normal.png changed_normal.png 8_depth.png <<'END'
import sys
sys.path.insert(0, sys.argv[1])
sys.dont_write_bytecode = True
import codes
w, n, bits, rows = codes.read(sys.argv[2])
_, _, _, depth = codes.read(sys.argv[4])
y, x = next((y, x) for y, r in enumerate(depth) for x, c in enumerate(r)
            if c == 0)
rows[y][3 * x] ^= 4
codes.write_png(sys.argv[3], rows, n, bits)
END
ok rm-pack -q --normal changed_normal.png --depth 8_depth.png --ao 8_ao.png \
    -o changed.png
exits 1 rm-info --compare p.png changed.png
exits 1 rm-info --compare --tolerance 3 p.png changed.png
ok rm-info --compare --tolerance 4 p.png changed.png

check 'oiiotool sees the same codes'
if command -v oiiotool >/dev/null; then
	oiiotool --iconfig oiio:UnassociatedAlpha 1 p.png --ch R,G,B \
	    -o seen.png 2>"$PRIV/err" || bad 'oiiotool failed'
	codes p.png 0,1,2 >want
	codes seen.png >got
	same_bytes want got
else
	skip 'oiiotool is not there'
fi

check 'a height map: white is high'
ok rm-pack -q --height --normal 8_normal.png --depth 8_depth.png \
    --ao 8_ao.png -o h.png
codes p.png 3 | python3 -c '
import sys
for line in sys.stdin:
    print("%02x" % (255 - int(line, 16)))' >want
codes h.png 3 >got
same_bytes want got

check 'normal y: up in, down out, and back'
ok rm-pack -q --output-normal-y down --normal 8_normal.png \
    --depth 8_depth.png --ao 8_ao.png -o down.png
codes p.png 0,2,3 >want
codes down.png 0,2,3 >got
same_bytes want got
ok rm-pack --unpack down.png --normal-out un.png
codes 8_normal.png 0,1 >want
codes un.png 0,1 >got
same_bytes want got

check 'maps of different sizes are resampled to the depth'\''s'
test_map ao 8 122x76 big_ao.png
ok rm-pack -q --normal 8_normal.png --depth 8_depth.png --ao big_ao.png \
    -o r.png
equal "$(python3 "$top/tests/cli/codes.py" size r.png)" '61 38 4 8' size
ok rm-pack -q --size 20x10 --normal 8_normal.png --depth 8_depth.png \
    --ao big_ao.png -o r.png
equal "$(python3 "$top/tests/cli/codes.py" size r.png)" '20 10 4 8' size

check 'a plane: normal straight up, open, everywhere'
test_map plane 8 16x16 plane.png
ok rm-pack -q --depth plane.png -o plane_packed.png
equal "$(codes plane_packed.png | sort -u)" '80 80 ff 55' plane
