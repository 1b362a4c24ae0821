# Pictures of materials: shared, inside the file, missing, broken, too large.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-multilayer python3

# png FILE WxH RRGGBB[AA]: one colour, or GG: grey
cat >"$PRIV/png.py" <<'END'
import struct
import sys
import zlib

name, size, code = sys.argv[1:]
w, h = map(int, size.split("x"))
texel = bytes.fromhex(code)


def chunk(tag, data):
    crc = zlib.crc32(tag + data)
    return struct.pack(">I", len(data)) + tag + data + struct.pack(">I", crc)


kind = {1: 0, 2: 4, 3: 2, 4: 6}[len(texel)]
open(name, "wb").write(
    b"\x89PNG\r\n\x1a\n" +
    chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, 8, kind, 0, 0, 0)) +
    chunk(b"IDAT", zlib.compress((b"\0" + texel * w) * h, 0)) +
    chunk(b"IEND", b""))
END
png() {
	python3 "$PRIV/png.py" "$@"
}

# Four boxes in a row, seen from +z, of the materials a, b, c and d.
boxes() {
	echo "mtllib $1"
	awk 'BEGIN {
		split("1 3 4 2  5 6 8 7  1 2 6 5  3 7 8 4  1 5 7 3  2 4 8 6", f)
		print "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1"
		for (b = 0; b < 4; b++) {
			for (i = 0; i < 8; i++)
				print "v", b + i % 2, int(i / 2) % 2, (i > 3)
			print "usemtl", substr("abcd", b + 1, 1)
			for (i = 1; i <= 24; i += 4) {
				printf "f"
				for (k = 0; k < 4; k++)
					printf " %d/%d", f[i + k] + 8 * b, k + 1
				print ""
			}
		}
	}'
}

# bake MESH: the first texel of each box into the file got
bake() {
	rm-multilayer --size 16x4 -o t "$@" 2>"$PRIV/err" || bad "fails: $*"
	codes t_color.png 0,1,2 | sed -n '1p;5p;9p;13p' | tr -d ' ' >got
}

colors_are() {
	printf '%s\n' "$@" | cmp -s - got ||
		bad "'$*' expected, not '$(tr '\n' ' ' <got)'"
}

png red.png 4x4 c81020
png grey.png 3x5 60
png clear.png 2x2 0a84f060

check 'each material has its own; grey is grey; alpha of an opaque one is not'
cat >four.mtl <<'END'
newmtl a
map_Kd red.png
newmtl b
map_Kd grey.png
newmtl c
map_Kd clear.png
newmtl d
Kd 0.2 0.4 0.6
END
boxes four.mtl >four.obj
bake four.obj
stderr_empty
colors_are c81020 606060 0a84f0 336699

check 'all files that are read are in the depfile, once'
ok rm-multilayer --size 16x4 -M deps -o t four.obj
for f in four.obj four.mtl red.png grey.png clear.png; do
	grep -qw "$f" deps || bad "$f is not there"
done
sed 's/map_Kd.*/map_Kd red.png/' four.mtl >same.mtl
boxes same.mtl >same.obj
ok rm-multilayer --size 16x4 -M deps -o t same.obj
equal "$(grep -ow red.png deps | wc -l)" 2 'red.png, as a name and as a rule'

check 'a picture that is missing, broken or too large: a warning, the factor'
head -c 70 red.png >cut.png
echo 'no picture' >text.png
png large.png 64x64 ffffff
cat >bad.mtl <<'END'
newmtl a
Kd 0.2 0.4 0.6
map_Kd nothere.png
newmtl b
Kd 1 1 0
map_Kd cut.png
newmtl c
Kd 0 1 1
map_Kd text.png
newmtl d
Kd 1 0 1
map_Kd large.png
END
boxes bad.mtl >bad.obj
bake --max-pixels 1000 bad.obj
colors_are 336699 ffff00 00ffff ff00ff
stderr_has "bad.obj: material 'a' is without its picture: .*nothere.png"
stderr_has "material 'b' is without its picture: .*cut.png"
stderr_has "material 'c' is without its picture: .*text.png: not an image"
stderr_has "material 'd' .*large.png.*--max-pixels"
equal "$(wc -l <"$PRIV/err")" 4 'lines of warnings'

check 'a half picture is scene-linear'
ok rm-multilayer --size 16x4 --format exr -d half -o h four.obj
# each box looks at the middle of its own quarter
for i in 'a 0.0625' 'b 0.3125' 'c 0.5625' 'd 0.8125'; do
	echo "newmtl ${i% *}"
	echo "map_Kd -s 0.125 1 1 -o ${i#* } 0 0 h_color.exr"
done >quarters.mtl
boxes quarters.mtl >half.obj
bake half.obj
stderr_empty
colors_are c81020 606060 0a84f0 336699

check 'pictures inside the file'
python3 - four.obj <<'END'
import base64
import json
import struct

png = open("red.png", "rb").read(), open("clear.png", "rb").read()
points, triangles = [], []
face = [1, 3, 4, 2, 5, 6, 8, 7, 1, 2, 6, 5, 3, 7, 8, 4, 1, 5, 7, 3, 2, 4, 8, 6]
uv = []
for i in range(24):
    p = face[i] - 1
    points += [p % 2, p // 2 % 2, p // 4]
    uv += [(0, 0), (1, 0), (1, 1), (0, 1)][i % 4]
for i in range(0, 24, 4):
    triangles += [i, i + 1, i + 2, i, i + 2, i + 3]
data = struct.pack("<72f48f36H", *points, *uv, *triangles)
views = [{"buffer": 0, "byteOffset": 0, "byteLength": 288},
         {"buffer": 0, "byteOffset": 288, "byteLength": 192},
         {"buffer": 0, "byteOffset": 480, "byteLength": 72}]
data += b"\0" * (-len(data) % 4)
views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(png[0])})
data += png[0]
uri = "data:image/png;base64," + base64.b64encode(png[1]).decode()
accessors = [
    {"bufferView": 0, "componentType": 5126, "count": 24, "type": "VEC3",
     "min": [0, 0, 0], "max": [1, 1, 1]},
    {"bufferView": 1, "componentType": 5126, "count": 24, "type": "VEC2"},
    {"bufferView": 2, "componentType": 5123, "count": 36, "type": "SCALAR"}]
factors = [None, None, [1, 0, 1, 1], [0.25, 0.5, 0.75, 1]]
pictures = [0, 1, 0, None]
materials = []
for factor, picture in zip(factors, pictures):
    base = {}
    if factor:
        base["baseColorFactor"] = factor
    if picture is not None:
        base["baseColorTexture"] = {"index": picture}
    materials.append({"name": "m", "pbrMetallicRoughness": base})
doc = {
    "asset": {"version": "2.0"}, "scene": 0,
    "scenes": [{"nodes": [0, 1, 2, 3]}],
    "nodes": [{"mesh": i, "translation": [i, 0, 0]} for i in range(4)],
    "meshes": [{"primitives": [{
        "attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2,
        "material": i}]} for i in range(4)],
    "materials": materials, "accessors": accessors, "bufferViews": views,
    "images": [{"bufferView": 3, "mimeType": "image/png"}, {"uri": uri}],
    "textures": [{"source": 0}, {"source": 1}],
    "buffers": [{"byteLength": len(data)}]}
text = json.dumps(doc).encode()
text += b" " * (-len(text) % 4)
data += b"\0" * (-len(data) % 4)
open("in.glb", "wb").write(
    struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(data), len(text),
                0x4E4F534A) + text +
    struct.pack("<II", len(data), 0x004E4942) + data)
END
bake in.glb
stderr_empty
# factors are scene-linear: 0.25, 0.5 and 0.75 are 89, bc and e1 as sRGB
colors_are c81020 0a84f0 c80020 89bce1
