# Small maps and meshes for the tools to fail on, in the working folder.
# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154 # top is set by tests/cli/run
set -eu
test_map() {
	python3 "$top/tests/cli/codes.py" maps "$@"
}
test_map plane 8 16x16 d.png
test_map normal 8 16x16 n.png
test_map random 8 16x16 c.png
cat >t.obj <<'END'
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
vt 0 0
vt 1 0
vt 0 1
f 1/1 3/3 2/2
f 1/1 2/2 4/3
f 1/1 4/2 3/3
f 2/1 3/2 4/3
END
cat >t.ply <<'END'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
END
for type in png exr tga tiff; do
	rm-pack --depth d.png --normal n.png --ao none -s0.1 \
	    -o "p.$type"
done
rm-pack --unpack p.exr --normal-out n.exr --depth-out d.exr
rm-pack --unpack p.tga --depth-out d.tga
rm-multilayer --size 8x8 t.obj -o m.exr
rm-quadfit t.obj -o t.glb
