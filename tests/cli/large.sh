# shellcheck shell=sh disable=SC2154 # LIB, DATA, PRIV are set by tests/cli/run
# Maps that are read, blended and written in bands: the same bytes for any band,
# tiled files in and out, and what a file type cannot hold. RELIEF_LARGE=WxH
# also makes a map of that size and takes it through all, with its peak memory
# (16384x16384 needs 7 GB and 4 GB of disk).
# SPDX-License-Identifier: MIT
. "$LIB"

stone=$DATA/stone_depth.png
rm-pack -q -d uint16 --quality preview -s 0.1 "--depth=$stone" -o packed.png
rm-pack -q -d half --ao none -s 0.1 "--depth=$stone" -o packed.exr
rm-pack --unpack packed.png --normal-out n.png --ao-out a.png --depth-out d.png

# every_band OUT COMMAND...: the command's output OUT, in bands of a row, of 7,
# of more than there are, is what it is in those that are usual
every_band() {
	out=$1
	shift
	ok "$@"
	mv "$out" "usual_$out"
	for rows in 1 7 5000; do
		BAKE_BAND_ROWS=$rows
		export BAKE_BAND_ROWS
		ok "$@"
		unset BAKE_BAND_ROWS
		same_bytes "$out" "usual_$out"
	done
}

check 'packing in bands of any height gives the same bytes'
for type in png tga tiff exr; do
	every_band "o.$type" rm-pack -q --normal n.png --depth d.png \
	    --ao a.png -o "o.$type"
done
every_band o.png rm-pack -q --depth d.png --quality preview --wrap u -o o.png
every_band o.png rm-pack -q --depth d.png --ao none --size 100x77 -o o.png

check 'so do targets of several files, and heights'
every_band o_height.png rm-pack -q --height --depth d.png --ao none \
    --target unity-hdrp -o o.png

check 'so does taking apart'
every_band p.png rm-pack -q --unpack packed.png --normal-out p.png
every_band p.exr rm-pack -q --unpack packed.exr --depth-out p.exr \
    --output-height

check 'and blending, with every way to place a layer'
every_band o.exr rm-combine -q packed.exr -w 0.5 packed.png -o o.exr
every_band o.png rm-combine -q packed.png -w 0.5 -t 1.5 packed.exr -o o.png
every_band o.png rm-combine -q packed.png -w 0.5 -t 0.3x2.7 \
    --offset 0.37,-0.11 packed.exr -o o.png
every_band o.png rm-combine -q --size 61x190 --filter mitchell \
    packed.png -t 5 packed.png -o o.png
every_band o.png rm-combine -q --wrap clamp --size 500x300 packed.png -o o.png
every_band o.png rm-combine -q --normal-blend from-depth packed.png \
    -t 2 packed.png -o o.png

check '--tiles writes tiles, which hold the same and read the same'
for type in tiff exr; do
	ok rm-pack -q --normal n.png --depth d.png --ao a.png -o "rows.$type"
	# 48 does not divide 256: there are tiles beyond the border
	ok rm-pack -q --normal n.png --depth d.png --ao a.png --tiles 48 \
	    -o "tiles.$type"
	differ "rows.$type" "tiles.$type"
	ok rm-info --compare "rows.$type" "tiles.$type"
	ok rm-combine -q "rows.$type" -w 0.5 -t 1.5 "rows.$type" -o by_rows.png
	ok rm-combine -q "tiles.$type" -w 0.5 -t 1.5 "tiles.$type" \
	    -o by_tiles.png
	ok rm-info --compare by_rows.png by_tiles.png
	ok rm-pack -q --unpack "rows.$type" --depth-out by_rows.png
	ok rm-pack -q --unpack "tiles.$type" --depth-out by_tiles.png
	ok rm-info --compare by_rows.png by_tiles.png
done
if command -v oiiotool >/dev/null; then
	oiiotool --info -v tiles.exr | grep -q 'tile size: 48 x 48' ||
		bad 'the EXR file has no tiles of 48'
	oiiotool --info -v tiles.tiff | grep -q 'tile size: 48 x 48' ||
		bad 'the TIFF file has no tiles of 48'
fi

check '--tiles of an odd size is wrong usage'
exits 2 rm-pack -q --depth d.png --ao none --tiles 40 -o bad.exr
stderr_has "multiple of 16"
absent bad.exr

check 'channels in any order and number are read in bands'
need python3
if command -v oiiotool >/dev/null; then
	oiiotool packed.exr --ch A,G,B,R,A --chnames depth,normal.y,ao,normal.x,x \
	    -o mixed.exr
	ok rm-combine -q -s 0.1 packed.exr -o straight.png
	ok rm-combine -q -s 0.1 mixed.exr -o mixed.png
	ok rm-info --compare straight.png mixed.png
else
	skip 'oiiotool is not there'
fi

check 'what a type cannot hold is an error that names the way out'
test_map ramp 8 70000x1 wide.png 2>/dev/null ||
	rm-pack -q --depth d.png --ao none --size 70000x1 -o wide.png
exits 1 rm-aobake -q -n 3 -r 0.0001 wide.png -o wide.tga
stderr_one_line 'tga holds at most 65535 texels a side, not 70000x1; tiff and exr hold more'
absent wide.tga

check 'a large map goes through all of it'
if [ -z "${RELIEF_LARGE-}" ]; then
	skip 'RELIEF_LARGE=WxH makes it'
else
	B=$B "$top/scripts/bench-large" "$RELIEF_LARGE" >"$PRIV/large" ||
		bad 'scripts/bench-large failed'
	sed 's/^/    /' "$PRIV/large"
	! grep -q FAIL "$PRIV/large" || bad 'a step failed'
fi
