# rm-info on textures of multilayer relief, and on files that only say they are.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-info rm-multilayer python3

"$top/scripts/make-solid" weave --count 2 --rings 12 --segments 12 -o weave.obj
set -- --size 64x64 --tile xy --region 0,0,1,1
usual='file width height channels format layout polarity normal_y depth_scale seam_u seam_v'

check 'every type of file says what it holds'
for type in png tga tiff; do
	ok rm-multilayer "$@" --format $type weave.obj -o w
	for kind in depth nx ny color; do
		ok rm-info "w_$kind.$type"
		stdout_has "^  layout      layer-$kind\$"
		stdout_has '^  layers      4'
		stdout_has '^  depth range [0-9.]* (near) to -[0-9.]* (far), mesh units along +z$'
		stdout_has '^  region      0, 0 to 1, 1$'
		ok rm-info --check "w_$kind.$type"
		stdout_empty
	done
	ok rm-info "w_depth.$type"
	stdout_has '^  texels      [0-9]* empty, [0-9]* with 2, [0-9]* with 4$'
	ok rm-info "w_ny.$type"
	stdout_has '^  normal y    up  (declared)$'
done

check 'an EXR file of several parts'
ok rm-multilayer "$@" weave.obj -o w.exr
ok rm-info w.exr
n=0
for kind in depth nx ny color; do
	n=$((n + 1))
	stdout_has "^  layout      layer-$kind\$"
	stdout_has "^  part        $kind, $n of 4\$"
done
sed -n 's/^  texels //p' "$PRIV/out" >exr.txt
ok rm-multilayer "$@" -d half --format exr weave.obj -o one
ok rm-info one_depth.exr
sed -n 's/^  texels //p' "$PRIV/out" | same_bytes - exr.txt
ok rm-info --check w.exr
stdout_empty
ok rm-info --json w.exr
equal "$(wc -l <"$PRIV/out")" 4 lines
equal "$(json part) $(json parts) $(json layers)" 'depth 4 4' part

check 'a deep EXR file'
ok rm-multilayer "$@" --deep weave.obj -o d.exr
ok rm-info d.exr
stdout_has '^  size        64x64, .* openexr deep float$'
stdout_has '^  samples     [0-9]*; [0-9]* texels have none, the deepest 4$'
stdout_has '^  channel A   1 to 1, mean 1$'
ok rm-info --check d.exr
stdout_empty
ok rm-info --json d.exr
for key in $usual; do
	[ "$(json "$key")" != missing ] || bad "no $key"
done
equal "$(json deep) $(json part)" 'True None' deep
equal "$(json layers) $(json layer.axis)" '4 +z' layers

check 'JSON: the usual fields, and the layers'
ok rm-info --json w_depth.png
for key in $usual; do
	[ "$(json "$key")" != missing ] || bad "no $key"
done
equal "$(json layout)" layer-depth layout
equal "$(json layers)" 4 layers
equal "$(json polarity) $(json normal_y)" 'unsure unsure' conventions
equal "$(json layer.axis)" +z axis
equal "$(json layer.region)" '[0.0, 0.0, 1.0, 1.0]' region
equal "$(json layer.texture) of $(json layer.textures)" '1 of 1' texture
equal "$(json layer.mip_level) $(json layer.tau)" '0 None' 'mip level'
equal "$(json contradictions)" '[]' contradictions
python3 - "$PRIV/out" <<'END' || bad 'the numbers are wrong'
import json, sys
r = json.load(open(sys.argv[1]))["layer"]
assert sum(r["texels"]) == 64 * 64 and r["texels"][1] == r["texels"][3] == 0
# a weave's upper and lower half are alike
assert r["depth_zero"] > 0 and abs(r["depth_zero"] + r["depth_one"]) < 1e-8
END
ok rm-info --json w_color.png
equal "$(json layer.texels)" None texels

check 'textures have their numbers'
"$top/scripts/make-solid" helix --rungs 9 --rings 24 --segments 8 -o helix.obj
ok rm-multilayer -q --layers all --tile y --region 0,0,1,1 --size 64x64 \
    helix.obj -o h
ok rm-info --json h_depth2.png
equal "$(json layer.texture) of $(json layer.textures)" '2 of 2' texture
[ "$(json layers)" -gt 4 ] || bad "only $(json layers) layers"
ok rm-info --check h_depth.png h_depth2.png
stdout_empty

check 'what does not lie behind each other contradicts'
png() {
	python3 - "$@" <<'END'
import struct, sys, zlib


def chunk(kind, data):
    return (struct.pack(">I", len(data)) + kind + data +
            struct.pack(">I", zlib.crc32(kind + data)))


path, said, *texels = sys.argv[1:]
rows = b"\0" + b"".join(bytes(map(int, t.split(","))) for t in texels)
open(path, "wb").write(
    b"\x89PNG\r\n\x1a\n" +
    chunk(b"IHDR", struct.pack(">IIBBBBB", len(texels), 1, 8, 6, 0, 0, 0)) +
    chunk(b"tEXt", b"Description\0" + said.encode()) +
    chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
END
}
said='relief:Layout=layer-depth; relief:Layers=4'
png good.png "$said" 255,255,255,255 1,254,255,255 10,20,30,40
ok rm-info --check good.png
stdout_empty
png bad.png "$said" 10,255,255,255 20,10,255,255 255,255,10,20 0,10,255,255
exits 1 rm-info --check bad.png
stdout_has '^bad.png: 1 texels have an odd number of layers$'
stdout_has '^bad.png: 2 texels have layers that do not lie behind each other$'
stdout_has "^bad.png: 1 values are neither a depth nor 'no layer'\$"
png field.png 'relief:Layout=layer-depth; relief:Layers=1' 9,255,255,255 \
    200,255,255,255
ok rm-info --check field.png
stdout_empty
ok rm-info field.png
stdout_has '^  texels      0 empty, 2 with 1$'

check 'hostile numbers are not believed'
png odd.png 'relief:Layout=layer-depth; relief:Layers=-3; relief:Region=1,2' \
    255,255,255,255 9,10,255,255
ok rm-info --json odd.png
equal "$(json layers) $(json layer.region)" 'None None' layers
