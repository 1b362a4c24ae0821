# Files of other kinds and other programs are read for what they are.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-info oiiotool python3

# convert TYPE TOLERANCE [OIIOTOOL OPTION]...: the map through oiiotool, compared
convert() {
	type=$1 tolerance=$2
	shift 2
	check "$type: codes within $tolerance of what was written"
	if ! oiiotool map.png "$@" -o "map.$type" >"$PRIV/out" 2>&1 ||
	    [ ! -s "map.$type" ]; then
		skip "this oiiotool writes no $type"
		return
	fi
	ok rm-info --compare --tolerance "$tolerance" map.png "map.$type"
	ok rm-info --json "map.$type"
	equal "$(json width)x$(json height)x$(json channels)" 256x256x3 size
}

cp "$DATA/stone_normal.png" map.png
convert tiff 0
convert tga 0
convert bmp 0
convert ppm 0
convert sgi 0
convert dpx 0 -d uint8
# half floats: relative rounding error 2^-11 at most, of values up to 1
convert exr 0.00049 -d half
convert jpg 4 --quality 100 --attrib jpeg:subsampling 4:4:4
# its colour is subsampled and goes through YUV
convert webp 80 --quality 100

check 'the kind is found by the content, not by the name'
cp map.tiff lies.png
ok rm-info --compare map.png lies.png

check 'an sRGB mark, a gamma and a profile change nothing'
oiiotool map.png --iscolorspace sRGB --attrib oiio:Gamma 2.2 -o srgb.png \
    2>"$PRIV/err"
ok rm-info --compare map.png srgb.png

check 'alpha is data: what oiiotool writes unassociated is read as it is'
test_map random 8 32x32 r.png
python3 - "$top/tests/cli" <<'END'
import sys
sys.path.insert(0, sys.argv[1])
sys.dont_write_bytecode = True
import codes
_, _, _, rows = codes.read("r.png")
flat = [c for row in rows for c in row]
out = [[flat[(4 * (32 * y + x) + k) * 7 % 1024] if k < 3 or x % 3 else 0
        for x in range(32) for k in range(4)] for y in range(32)]
codes.write_png("rgba.png", out, 4, 8)
END
for type in tiff tga; do
	ok rm-pack --unpack rgba.png --depth-out a.png --ao-out b.png
	oiiotool --iconfig oiio:UnassociatedAlpha 1 rgba.png \
	    --attrib oiio:UnassociatedAlpha 1 -o "rgba.$type" 2>"$PRIV/err"
	ok rm-info --compare rgba.png "rgba.$type"
done
