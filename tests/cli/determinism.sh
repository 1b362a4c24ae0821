# The same bytes whatever the threads, the processor, the folder, the time.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-aobake rm-combine rm-rescale-ao
cp "$DATA/stone_depth.png" depth.png
cp "$DATA/stone_normal.png" normal.png

for type in png tga tiff exr; do
	check "$type: the same bytes for any number of threads"
	ok rm-pack -j1 -q --normal normal.png --depth depth.png -o "1.$type"
	ok rm-aobake -q -n12 -j1 depth.png -o "a1.$type"
	for j in 2 7; do
		ok rm-pack -j$j -q --normal normal.png --depth depth.png \
		    -o "$j.$type"
		same_bytes "1.$type" "$j.$type"
		ok rm-aobake -q -n12 -j$j depth.png -o "a$j.$type"
		same_bytes "a1.$type" "a$j.$type"
	done

	check "$type: the same bytes on any processor"
	for isa in baseline avx2; do
		ok env BAKE_ISA=$isa rm-pack -q --normal normal.png \
		    --depth depth.png -o "i.$type"
		same_bytes "1.$type" "i.$type"
		ok env BAKE_ISA=$isa rm-aobake -q -n12 depth.png \
		    -o "ai.$type"
		same_bytes "a1.$type" "ai.$type"
	done

	check "$type: the same bytes in another folder, a second later"
	mkdir -p "sub $type"
	cp depth.png "sub $type/other name.png"
	cp normal.png "sub $type"
	sleep 1.1
	ok env TZ=Asia/Tokyo USER=someone LC_ALL=de_DE.UTF-8 \
	    sh -c "cd 'sub $type' && rm-pack -q --normal normal.png \
	    --depth 'other name.png' -o 'x y.$type'"
	same_bytes "1.$type" "sub $type/x y.$type"
	ok sh -c "cd 'sub $type' && rm-aobake -q -n12 'other name.png' \
	    -o 'x y.$type'"
	same_bytes "a1.$type" "sub $type/x y.$type"
done

check 'every quality and estimator is deterministic'
for o in --quality=fast --quality=preview --estimator=mean \
    --blur-mode=occluded --wrap=clamp --periods=2 --radius=0.1; do
	ok rm-aobake -q -n7 -j1 $o depth.png -o one.exr
	ok env BAKE_ISA=baseline rm-aobake -q -n7 -j7 $o depth.png -o many.exr
	same_bytes one.exr many.exr
done

check 'depth integrated from normals'
ok rm-pack -q -j1 --normal normal.png --ao none -d float -o one.exr
ok env BAKE_ISA=baseline rm-pack -q -j7 --normal normal.png --ao none \
    -d float -o many.exr
same_bytes one.exr many.exr

check 'blends and rescaled occlusion'
ok rm-pack -q --normal normal.png --depth depth.png -d uint16 -o base.png
for o in seed pd rnm udn whiteout from-depth; do
	ok rm-combine -q -j1 --normal-blend $o --ao-rescale base.png \
	    -w 0.3 -t 2.5 base.png -o one.exr
	ok env BAKE_ISA=baseline rm-combine -q -j7 --normal-blend $o \
	    --ao-rescale base.png -w 0.3 -t 2.5 base.png -o many.exr
	same_bytes one.exr many.exr
done
ok rm-rescale-ao -q -j1 --scale 2 base.png -o one.png
ok env BAKE_ISA=baseline rm-rescale-ao -q -j7 --scale 2 base.png -o many.png
same_bytes one.png many.png

check 'an unknown instruction set is not taken silently for another'
exits 0 env BAKE_ISA=nonsense rm-aobake -q -n7 depth.png -o isa.exr
ok rm-aobake -q -n7 depth.png -o plain.exr
same_bytes isa.exr plain.exr
