# What a file's metadata say comes back from every type of file.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-aobake rm-info python3
cp "$DATA/bricks_depth.png" depth.png
cp "$DATA/bricks_normal.png" normal.png

for type in png tga tiff exr; do
	check "$type: layout, polarity, normal y and depth scale come back"
	ok rm-pack -q -s 0.04 --normal normal.png --depth depth.png \
	    -o "p.$type"
	ok rm-info --json "p.$type"
	equal "$(json declared.layout)" relief layout
	equal "$(json declared.polarity)" depth polarity
	equal "$(json declared.normal_y)" up normal_y
	equal "$(json declared.depth_scale)" 0.04 depth_scale
	equal "$(json width)x$(json height)" 256x256 size
	equal "$(json channels)" 4 channels

	check "$type: a target's other conventions come back"
	ok rm-pack -q -s 0.04 --normal normal.png --depth depth.png \
	    --target policarpo -o "d.$type"
	ok rm-info --json "d.$type"
	equal "$(json declared.normal_y)" down normal_y
	equal "$(json declared.polarity)" depth polarity
	ok rm-pack -q -s 0.04 --normal normal.png --depth depth.png \
	    --target quake3 -o "q.$type"
	ok rm-info --json "q.$type"
	equal "$(json declared.layout)" normal-relief layout
	equal "$(json declared.polarity)" height polarity
	equal "$(json declared.normal_y)" up normal_y

	check "$type: the depth scale of the metadata is used"
	ok rm-aobake -q -n8 "p.$type" -o ao_meta.exr
	ok rm-aobake -q -n8 -s 0.04 "p.$type" -o ao_given.exr
	same_result ao_meta.exr ao_given.exr

	check "$type: no time, host, user or path is written"
	here=$(basename "$(dirname "$PWD")")
	host=$(uname -n)
	# a short name turns up in compressed data by chance
	[ ${#host} -ge 5 ] || host=$here
	for word in "$here" "$host" "$(date +%Y:%m)" "$(date +%Y-%m)" \
	    depth.png; do
		! grep -aqF -e "$word" "p.$type" ||
			bad "p.$type holds '$word'"
	done
done
