# Each call that can fail, failing: no crash, no damaged file, a reason.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-aobake rm-combine rm-rescale-ao rm-quadfit rm-multilayer \
    rm-roughen rm-info rm-render python3
# a library that crashes for want of memory is told of, with exit status 1
# shellcheck disable=SC3045
ulimit -S -c 0

check 'a full disk, as a device, as standard output and as a limit'
mkdir "$PRIV/in"
(cd "$PRIV/in" && sh "$top/tests/fault/inputs.sh")
in=$PRIV/in

# each tool writes to what its first argument says
for command in "rm-pack --depth $in/d.png --ao none --format png" \
    "rm-aobake -n4 $in/d.png --format tiff" \
    "rm-combine $in/p.png $in/p.exr --format exr" \
    "rm-rescale-ao --scale 2 $in/p.png --format tga" \
    "rm-quadfit $in/t.obj --format ply" \
    "rm-roughen --angle 60 $in/c.png --format png" \
    "rm-render --size 8x8 $in/p.png --format png"; do
	# shellcheck disable=SC2086 # a command and its words
	exits 1 $command -o /dev/full
	stderr_one_line /dev/full
	exits 1 sh -c "$command -o - >/dev/full"
	stderr_one_line 'standard output'
	echo old >out.bin
	# the limit is not for what is said
	exits 0 sh -c "{ (ulimit -f 0; exec $command -o out.bin) 2>&1
		echo \$? >'$PRIV/status'; } | cat >&2"
	equal "$(cat "$PRIV/status")" 1 'the exit status'
	stderr_one_line ': File too large'
	equal "$(cat out.bin)" old 'the old file'
	no_litter out.bin
	rm out.bin
done
exits 1 sh -c "rm-info $in/p.png >/dev/full"
stderr_one_line 'standard output'

check 'a full disk: a small file system'
mkdir small
if mount -t tmpfs -o size=12k,nr_inodes=20 relief-test small 2>/dev/null; then
	echo old >small/out.png
	exits 1 rm-aobake -n4 "$DATA/stone_depth.png" -o small/out.png
	stderr_one_line small/out.png
	equal "$(cat small/out.png)" old 'the old file'
	equal "$(ls -A small)" out.png litter
	exits 1 rm-multilayer --size 64x64 "$DATA/torus.obj" -o small/m.exr
	stderr_one_line small/m.exr
	exits 1 rm-quadfit "$DATA/torus.obj" -o small/q.ply
	stderr_one_line 'No space left on device'
	equal "$(ls -A small)" out.png litter
	umount small
else
	skip 'mounting takes root'
fi
rmdir small

check 'each call of each kind fails, by a preloaded library'
shim=$B/tests/fault_shim.so
if [ ! -e "$shim" ]; then
	skip 'there is none in this build'
else
	# FAULTS=all is the full sweep, of half an hour
	fault_sweep faults "$shim" "$in"
fi
no_litter ''
