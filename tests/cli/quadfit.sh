# rm-quadfit: tables, PLY and glTF of quadrics, and what it says of bad meshes.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-quadfit python3
cp "$DATA/torus.obj" torus.obj
names='v vt x y z nx ny nz tx ty tz hand a b c uvscale_s uvscale_t a_tex b_tex c_tex rank residual'
tool=rm-quadfit

# python with what all these checks need
py() {
	cat - >"$PRIV/script.py"
	python3 -B "$PRIV/script.py" "$@" >"$PRIV/py" 2>&1 || {
		bad 'python says:'
		sed 's/^/    | /' "$PRIV/py"
	}
}

usage_error() {
	exits 2 "$@"
	stdout_empty
	$tool --help | sed -n '/^usage: /p' >"$PRIV/usage"
	sed 1d "$PRIV/err" | cmp -s - "$PRIV/usage" &&
		sed -n 1p "$PRIV/err" | grep -q "^$tool: " ||
		bad "'$*': not one reason and the usage:" "$(cat "$PRIV/err")"
}

check 'it loads no image library'
if command -v ldd >/dev/null; then
	ldd "$(command -v rm-quadfit)" | grep -i openimageio && bad 'it does'
else
	skip 'ldd is not there'
fi

check 'help, version and wrong usage'
ok rm-quadfit --help
stdout_has '^usage: rm-quadfit '
sed -n 's/^  ... --\([a-z-]*\).*/\1/p' "$PRIV/out" | sort -c || bad 'not sorted'
ok rm-quadfit -V
usage_error rm-quadfit
usage_error rm-quadfit torus.obj
usage_error rm-quadfit torus.obj -o out
usage_error rm-quadfit torus.obj -o -
usage_error rm-quadfit torus.obj --format ply -o out.tsv
usage_error rm-quadfit torus.obj -o out.tsv -O .
usage_error rm-quadfit torus.obj torus.obj -o out.tsv
usage_error rm-quadfit torus.obj torus.obj -O .
usage_error rm-quadfit --stats --format tsv torus.obj -o -
usage_error rm-quadfit --no-such torus.obj -o out.tsv
for o in --ring=two --ring=0 --ring=9 --order=1 --order=4 --model=x --sign=up \
    --frame=x --normals=x -s0 -s-1 -snan --depth=0 --depth=inf --weld=-1 \
    --weld=nan --format=png --uv-set=-1 -j0; do
	usage_error rm-quadfit $o -o out.tsv torus.obj
done
no_litter torus.obj

check 'the table: its columns, its rows in order'
ok rm-quadfit -o t.tsv torus.obj
stdout_empty
equal "$(head -n 1 t.tsv)" "$(echo "$names" | tr ' ' '\t')" header
equal "$(wc -l <t.tsv)" 562 lines
tail -n +2 t.tsv | cut -f 1,2 | LC_ALL=C sort -n -k 1,1 -k 2,2 >sorted
tail -n +2 t.tsv | cut -f 1,2 | cmp -s - sorted || bad 'not in order'
rm sorted

check 'the table: the torus has the curvatures of a torus'
ok rm-quadfit --order 3 -o t3.tsv torus.obj
py t.tsv t3.tsv <<'END'
import math, sys
# 16 edges round the tube: neighbours are up to 45 degrees away, where the depth
# of a circle is (1 - cos 45) / (sin^2 45 / 2) = 1.17 times its parabola's; the
# fit is between that and 1
tol = 0.175
for path, rank in zip(sys.argv[1:], (5, 9)):
    rows = [l.rstrip("\n").split("\t") for l in open(path)]
    for r in rows[1:]:
        d = dict(zip(rows[0], map(float, r)))
        rho = math.hypot(d["x"], d["z"])
        cosw = (rho - 1) / 0.35
        a, b = cosw / (2 * rho), 1 / 0.7
        assert abs(d["a"] - a) < tol / 0.7, (path, d, a)
        assert abs(d["b"] - b) < tol / 0.7, (path, d, b)
        assert d["hand"] == 1 and d["rank"] == rank
        n = [d["nx"], d["ny"], d["nz"]]
        t = [d["tx"], d["ty"], d["tz"]]
        assert abs(sum(x * x for x in n) - 1) < 1e-12
        assert abs(sum(x * y for x, y in zip(n, t))) < 1e-12
        # u goes round the axis in 32 chords, at this radius or at that of a
        # neighbour; v round the tube in 16
        chord = 64 * math.sin(math.pi / 32)
        assert abs(d["uvscale_s"] / chord - rho) < 0.35 * math.sin(math.pi / 8)
        # that of a triangle's mean: at most that of its chord
        assert 0.97 < d["uvscale_t"] / (11.2 * math.sin(math.pi / 16)) < 1.01
        k = d["uvscale_s"] ** 2 / (0.1 * d["uvscale_s"])
        assert abs(d["a_tex"] - d["a"] * k) < 0.02 * abs(k), d
        # shortest decimals
        assert all(repr(float(x)) == repr(float(x)) for x in r)
END

check 'a seam changes nothing where both sides have the same tangent'
# every UV twice: the faces of one half take the second
awk '/^vt/ { uv[++n] = $0; print; next }
	/^vn/ && !done { for (i = 1; i <= n; i++) print uv[i]; done = 1 }
	/^f/ && ++nf > 200 { for (i = 2; i <= NF; i++) {
		split($i, c, "/"); $i = c[1] "/" c[2] + n "/" c[3] } }
	{ print }' torus.obj >twice.obj
ok rm-quadfit -o twice.tsv twice.obj
[ "$(wc -l <twice.tsv)" -gt 562 ] || bad 'no seam'
cut -f 1,3- t.tsv | sort -u >want
cut -f 1,3- twice.tsv | sort -u >got
same_bytes want got
rm -f want got

check 'the same bytes for any number of threads and any processor'
for type in tsv json ply glb gltf; do
	ok rm-quadfit -j1 -o "one.$type" torus.obj
	ok rm-quadfit -j7 -o "many.$type" torus.obj
	same_bytes "one.$type" "many.$type"
	ok env BAKE_ISA=baseline rm-quadfit -o "many.$type" torus.obj
	same_bytes "one.$type" "many.$type"
	ok env LC_ALL=de_DE.UTF-8 rm-quadfit -o "many.$type" torus.obj
	same_bytes "one.$type" "many.$type"
done
rm -f many.*

check 'a mesh in another order has the same values'
py torus.obj shuffled.obj <<'END'
import random, sys
random.seed(5)
lines = open(sys.argv[1]).read().split("\n")
out, maps = [], {}
for kind in ("v", "vt", "vn"):
    items = [l for l in lines if l.startswith(kind + " ")]
    order = list(range(len(items)))
    random.shuffle(order)
    out += [items[i] for i in order]
    maps[kind] = {old + 1: new + 1 for new, old in enumerate(order)}
faces = [l.split()[1:] for l in lines if l.startswith("f ")]
random.shuffle(faces)
for f in faces:
    k = random.randrange(len(f))
    # the first corner is where a quadrangle is cut
    f = [c.split("/") for c in f]
    out.append("f " + " ".join("%d/%d/%d" % tuple(
        maps[m][int(i)] for m, i in zip(("v", "vt", "vn"), c)) for c in f))
open(sys.argv[2], "w").write("\n".join(out) + "\n")
END
ok rm-quadfit -o shuffled.tsv shuffled.obj
cut -f 3- t.tsv | sort >want
cut -f 3- shuffled.tsv | sort >got
same_bytes want got
rm -f want got

check 'sign, depth and depth scale'
ok rm-quadfit --sign outward -o out.tsv torus.obj
ok rm-quadfit -s 0.05 -o s.tsv torus.obj
ok rm-quadfit --depth 0.25 -o d.tsv torus.obj
py t.tsv out.tsv s.tsv d.tsv <<'END'
import sys
def table(path):
    rows = [l.rstrip("\n").split("\t") for l in open(path)]
    return [dict(zip(rows[0], map(float, r))) for r in rows[1:]]
plain, out, s, d = map(table, sys.argv[1:])
for p, o, q, r in zip(plain, out, s, d):
    for k in ("a", "b", "c", "a_tex", "b_tex", "c_tex"):
        assert o[k] == -p[k]
    for k in ("a_tex", "b_tex", "c_tex"):
        assert abs(q[k] - 2 * p[k]) <= 1e-12 * abs(p[k])
        want = p[k] * 0.1 * p["uvscale_s"] / 0.25
        assert abs(r[k] - want) <= 1e-12 * abs(want)
    assert q["a"] == p["a"] and r["b"] == p["b"]
END

check 'json and ply hold what the table holds'
ok rm-quadfit --format json torus.obj -o -
cp "$PRIV/out" stdout.json
same_bytes stdout.json one.json
py t.tsv one.json one.ply <<'END'
import json, struct, sys
rows = [l.rstrip("\n").split("\t") for l in open(sys.argv[1])]
table = [dict(zip(rows[0], map(float, r))) for r in rows[1:]]
doc = json.load(open(sys.argv[2]))
assert doc["sign"] == "depth" and doc["model"] == "full" and doc["order"] == 2
assert doc["ring"] is None and doc["depth_scale"] == 0.1 and doc["frame"] == "uv"
assert doc["corners"] == table
data = open(sys.argv[3], "rb").read()
head, body = data.split(b"end_header\n", 1)
lines = head.decode().split("\n")
assert "comment quadric sign depth" in lines
assert "element vertex 561" in lines and "element face 1024" in lines
props = [l.split()[1:] for l in lines if l.startswith("property ") and
         "list" not in l]
assert [p[1] for p in props] == rows[0] + ["s", "t"]
form = "<" + "".join({"int": "i", "char": "b", "uchar": "B",
                      "double": "d"}[p[0]] for p in props)
for i, want in enumerate(table):
    got = struct.unpack_from(form, body, i * struct.calcsize(form))
    assert list(got[:22]) == [want[k] for k in rows[0]], i
faces = body[561 * struct.calcsize(form):]
assert len(faces) == 1024 * 13
assert all(faces[13 * i] == 3 for i in range(1024))
assert max(struct.unpack("<3i", faces[13 * i + 1:13 * i + 13])[k]
           for i in range(1024) for k in range(3)) == 560
END
ok rm-quadfit --frame file one.ply -o again.tsv
cut -f 13-15 t.tsv >want
cut -f 13-15 again.tsv >got
equal "$(wc -l <got)" 562 'rows of the PLY read again'

check 'every type goes to standard output, too'
for type in tsv json ply glb gltf; do
	ok rm-quadfit --format $type torus.obj -o -
	same_bytes "$PRIV/out" one.$type
done

check 'a mesh on standard input'
for f in torus.obj one.ply one.glb; do
	rm-quadfit -o want.tsv $f
	rm-quadfit -o got.tsv - <$f || bad "$f"
	same_bytes want.tsv got.tsv
done
rm-quadfit -o got.glb - <torus.obj || bad 'no GLB'
same_bytes one.glb got.glb
exits 1 sh -c 'rm-quadfit -o bad.glb - <one.glb'
stderr_one_line 'standard input'
exits 1 rm-quadfit -o bad.tsv -
stderr_one_line 'standard input'
absent bad.glb bad.tsv

# -- glTF --------------------------------------------------------------------

# One mesh of two primitives over one set of vertices and one of its own, under
# two nodes that move it, with a buffer and a picture beside it.
check 'a glTF file with all that glTF files have'
mkdir -p in out
py one.glb in <<'END'
import json, struct, sys, zlib
data = open(sys.argv[1], "rb").read()
n = struct.unpack_from("<I", data, 12)[0]
doc = json.loads(data[20:20 + n])
bin = bytearray(data[28 + n:])
p = doc["meshes"][0]["primitives"][0]
count = doc["accessors"][p["indices"]]["count"]
view = doc["bufferViews"][doc["accessors"][p["indices"]]["bufferView"]]
doc["accessors"].append(dict(doc["accessors"][p["indices"]]))
doc["accessors"][p["indices"]]["count"] = count // 2
doc["accessors"][-1].update(byteOffset=count // 2 * 4, count=count - count // 2)
for k in ("_QUADRIC", "_UVSCALE"):
    del p["attributes"][k]
q = json.loads(json.dumps(p))
q["indices"] = len(doc["accessors"]) - 1
doc["meshes"][0]["primitives"].append(q)
doc["meshes"].append(json.loads(json.dumps(doc["meshes"][0])))
doc["meshes"][1]["primitives"] = [p]
doc["nodes"] = [{"mesh": 0, "scale": [2, 2, 2], "translation": [0.1, 0, 0]},
                {"mesh": 0, "rotation": [0, 1, 0, 0]}, {"mesh": 1}]
doc["scenes"] = [{"nodes": [0, 1]}]
doc["images"] = [{"uri": "a%20picture.png", "name": "0.10000000000000001"}]
doc["textures"] = [{"source": 0}]
doc["materials"] = [{"pbrMetallicRoughness": {
    "baseColorTexture": {"index": 0}, "roughnessFactor": 0.1,
    "metallicFactor": 1.0 / 3, "baseColorFactor": [1, 0.5, 0.25, 1]}}]
for m in doc["meshes"]:
    for r in m["primitives"]:
        r["material"] = 0
doc["extras"] = {"kept": [1, 1.5, "é\"\\"], "0.30000000000000004": 1e300}
doc["buffers"] = [{"uri": "data%20%C3%A9.bin", "byteLength": len(bin)}]
open(sys.argv[2] + "/data é.bin", "wb").write(bin)
def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(
        ">I", zlib.crc32(kind + body))
open(sys.argv[2] + "/a picture.png", "wb").write(
    b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(
        ">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)) + chunk(
        b"IDAT", zlib.compress(b"\0\x10\x20\x30")) + chunk(b"IEND", b""))
json.dump(doc, open(sys.argv[2] + "/m.gltf", "w"))
END
ok rm-quadfit in/m.gltf -o in/same.gltf
ok rm-quadfit in/m.gltf -o out/other.gltf
ok rm-quadfit -M out/m.d in/m.gltf -o out/whole.glb
ok rm-quadfit out/whole.glb -o out/back.gltf
for f in 'in/data' 'in/a\ picture.png' 'in/m.gltf' 'out/whole.glb:'; do
	grep -qF "$f" out/m.d || bad "the depfile has no $f"
done

cat >"$PRIV/gltf.py" <<'END'
import base64, json, os, struct, urllib.parse
def load(path):
    data = open(path, "rb").read()
    chunk = None
    if data[:4] == b"glTF":
        version, size, n = struct.unpack_from("<III", data, 4)
        assert version == 2 and size == len(data) and n % 4 == 0
        doc = json.loads(data[20:20 + n])
        if len(data) > 20 + n:
            m, kind = struct.unpack_from("<I4s", data, 20 + n)
            assert kind == b"BIN\0" and m % 4 == 0
            chunk = data[28 + n:28 + n + m]
            assert len(chunk) == m
    else:
        doc = json.loads(data)
    buffers = []
    for b in doc["buffers"]:
        uri = b.get("uri")
        if uri is None:
            raw = chunk
        elif uri.startswith("data:"):
            raw = base64.b64decode(uri.split(",", 1)[1], validate=True)
        else:
            raw = open(os.path.join(os.path.dirname(path),
                                    urllib.parse.unquote(uri)), "rb").read()
        assert len(raw) >= b["byteLength"]
        buffers.append(raw)
    return doc, buffers
def values(doc, buffers, i):
    a = doc["accessors"][i]
    v = doc["bufferViews"][a["bufferView"]]
    n = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[a["type"]]
    code, size = {5126: ("f", 4), 5125: ("I", 4)}[a["componentType"]]
    at = v.get("byteOffset", 0) + a.get("byteOffset", 0)
    assert at % 4 == 0 and a["count"] * n * size <= v["byteLength"]
    flat = struct.unpack_from("<%d%s" % (a["count"] * n, code),
                              buffers[v["buffer"]], at)
    return [flat[k:k + n] for k in range(0, len(flat), n)]
END

check 'glTF: the attributes are those of the table, in its own coordinates'
cp "$PRIV/gltf.py" gltf.py
for f in in/same.gltf out/other.gltf out/whole.glb out/back.gltf one.glb \
    one.gltf; do
	py "$f" t.tsv <<'END'
import struct, sys
sys.path.insert(0, ".")
import gltf
doc, buffers = gltf.load(sys.argv[1])
rows = [l.rstrip("\n").split("\t") for l in open(sys.argv[2])]
table = [dict(zip(rows[0], map(float, r))) for r in rows[1:]]
for m in doc["meshes"]:
    shared = set()
    for p in m["primitives"]:
        at = p["attributes"]
        shared.add((at["_QUADRIC"], at["_UVSCALE"]))
        assert doc["accessors"][at["_QUADRIC"]]["extras"] == {"sign": "depth"}
        q = gltf.values(doc, buffers, at["_QUADRIC"])
        u = gltf.values(doc, buffers, at["_UVSCALE"])
        pos = gltf.values(doc, buffers, at["POSITION"])
        assert len(q) == len(u) == len(pos) == len(table)
        used = {i[0] for i in gltf.values(doc, buffers, p["indices"])}
        # float positions and 16-bit UVs: 1e-7 of 1, over h^2 = 0.02; half a
        # mesh has other neighbours at its edge
        whole = len(used) == len(table) or len(m["primitives"]) == 2
        for i in used if whole else ():
            assert abs(q[i][0] - table[i]["a"]) < 1e-4, (i, q[i], table[i])
            assert abs(q[i][1] - table[i]["b"]) < 1e-4, (i, q[i], table[i])
            assert abs(u[i][0] - table[i]["uvscale_s"]) < 1e-4 * u[i][0]
            assert abs(u[i][1] - table[i]["uvscale_t"]) < 1e-4 * u[i][1]
    assert len(shared) == 1  # one pair of accessors for one set of vertices
END
done

check 'glTF: all else is as it was'
py <<'END'
import json, os, sys
sys.path.insert(0, ".")
import gltf
was, old = gltf.load("in/m.gltf")
for path in ("in/same.gltf", "out/other.gltf", "out/whole.glb"):
    doc, buffers = gltf.load(path)
    # but for the record of what it was made of
    for asset in (doc["asset"], was["asset"]):
        for k in ("relief:Recipe", "relief:RecipeFiles"):
            asset.get("extras", {}).pop(k, None)
        if not asset.get("extras"):
            asset.pop("extras", None)
    for k in was:
        if k not in ("accessors", "bufferViews", "buffers", "meshes",
                     "images"):
            assert doc[k] == was[k], (path, k)
    assert list(doc) == list(was), (path, list(doc))
    n = len(was["accessors"])
    assert doc["accessors"][:n] == was["accessors"]
    assert len(doc["accessors"]) == n + 4  # two meshes
    for m, w in zip(doc["meshes"], was["meshes"]):
        for p in m["primitives"]:
            del p["attributes"]["_QUADRIC"], p["attributes"]["_UVSCALE"]
        assert m == w
    for i in range(n):
        if was["accessors"][i]["componentType"] in (5125, 5126):
            assert gltf.values(doc, buffers, i) == gltf.values(was, old, i)
    image = doc["images"][0]
    if path.endswith(".glb"):
        v = doc["bufferViews"][image["bufferView"]]
        got = buffers[0][v["byteOffset"]:v["byteOffset"] + v["byteLength"]]
        assert got == open("in/a picture.png", "rb").read()
        assert image["mimeType"] == "image/png" and "uri" not in image
        assert len(doc["buffers"]) == 1
    else:
        import urllib.parse
        uri = urllib.parse.unquote(image["uri"])
        assert os.path.samefile(os.path.join(os.path.dirname(path), uri),
                                "in/a picture.png"), uri
        assert not os.path.isabs(uri)
text = open("in/same.gltf", encoding="utf-8").read()
assert '"roughnessFactor": 0.1,' in text and "0.3333333333333333" in text
END

check 'glTF: valid by the validator of Khronos'
module=$B/gltf-validator
if ! command -v node >/dev/null; then
	skip 'node is not there'
elif [ ! -d "$module/node_modules/gltf-validator" ] &&
    ! { command -v npm >/dev/null &&
	npm install --silent --no-audit --no-fund --prefix "$module" \
	    gltf-validator >"$PRIV/npm" 2>&1; }; then
	skip 'gltf-validator is not there, and npm cannot fetch it'
else
	NODE_PATH=$module/node_modules node - one.glb one.gltf in/same.gltf \
	    out/other.gltf out/whole.glb out/back.gltf >"$PRIV/js" 2>&1 <<'END' ||
const validator = require('gltf-validator');
const fs = require('fs'), path = require('path');
(async () => {
	let bad = 0;
	for (const file of process.argv.slice(2)) {
		const report = await validator.validateBytes(
		    new Uint8Array(fs.readFileSync(file)), {
			uri: file,
			externalResourceFunction: async uri => new Uint8Array(
			    fs.readFileSync(path.resolve(path.dirname(file),
			    decodeURIComponent(uri)))),
		});
		const n = report.issues.numErrors + report.issues.numWarnings;
		bad += n;
		if (n > 0)
			console.log(file, JSON.stringify(
			    report.issues.messages.slice(0, 5)));
	}
	process.exit(bad > 0 ? 1 : 0);
})();
END
		bad "$(cat "$PRIV/js")"
fi

check 'an output over its input'
cp out/whole.glb over.glb
ok rm-quadfit over.glb -o over.glb
py over.glb <<'END'
import sys
sys.path.insert(0, ".")
import gltf
doc, buffers = gltf.load(sys.argv[1])
assert len(doc["buffers"]) == 1
END

check 'missing and corrupt glTF files are errors'
sed 's/data%20/gone%20/' in/m.gltf >in/gone.gltf
exits 1 rm-quadfit in/gone.gltf -o out/x.glb
stderr_one_line 'gone'
head -c 3000 out/whole.glb >short.glb
exits 1 rm-quadfit short.glb -o out/x.glb
stderr_one_line 'short.glb'
echo '{"asset": {"version": "2.0"}' >bad.gltf
exits 1 rm-quadfit bad.gltf -o out/x.glb
stderr_one_line 'bad.gltf'
echo '{"asset": {"version": "1.0"}}' >old.gltf
exits 1 rm-quadfit old.gltf -o out/x.glb
stderr_one_line '1.0'
echo '{"asset": {"version": "2.0"}}' >none.gltf
exits 1 rm-quadfit none.gltf -o out/x.glb
stderr_one_line 'no mesh'
sed 's/{"asset"/{"extensionsUsed": ["KHR_draco_mesh_compression"], "asset"/' \
    in/m.gltf >in/draco.gltf
exits 1 rm-quadfit in/draco.gltf -o out/x.glb
stderr_one_line 'KHR_draco_mesh_compression'
mkfifo in/pipe
sed 's/data%20%C3%A9.bin/pipe/' in/m.gltf >in/pipe.gltf
exits 1 timeout 10 rm-quadfit in/pipe.gltf -o out/x.glb
stderr_one_line 'in/pipe'
absent out/x.glb

# -- meshes that are not as they should be ---------------------------------

check 'without UVs: an error that names the way out'
grep -v '^vt' torus.obj | sed '/^f/s,/[0-9]*/,//,g' >plain.obj
exits 1 rm-quadfit plain.obj -o x.tsv
stderr_one_line '--frame auto'
exits 1 rm-quadfit --frame file plain.obj -o x.tsv
stderr_one_line '--frame auto'
exits 1 rm-quadfit plain.obj -o x.glb
absent x.tsv x.glb
ok rm-quadfit --frame auto plain.obj -o x.tsv
equal "$(wc -l <x.tsv)" 513 'one row a position'
equal "$(cut -f 2 x.tsv | sort -u | tr '\n' ' ')" '-1 vt ' 'no UV'
ok rm-quadfit --frame auto plain.obj -o x.glb

check 'one triangle, a point that nothing uses, a triangle without area'
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nvt 0 0\nvt 1 0\nvt 0 1\n%s\n' \
    'f 1/1 2/2 3/3' >one.obj
ok rm-quadfit one.obj -o one.tsv
equal "$(cut -f 13-15,21 one.tsv | tail -n +2 | sort -u | tr '\t' ' ')" \
    '0 0 0 1' 'a flat triangle'
printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n' \
    >flat.obj
exits 0 rm-quadfit flat.obj -o flat.tsv
stderr_one_line 'without an area'
grep -qiE 'nan|inf' flat.tsv && bad 'nan'
equal "$(cut -f 13-15,21 flat.tsv | tail -n +2 | sort -u | tr '\t' ' ')" \
    '0 0 0 0' 'a triangle without an area'

check 'statistics, with no output and with one'
ok rm-quadfit --stats torus.obj
stdout_has "^triangles$(printf '\t')1024\$"
stdout_has "^rank 5$(printf '\t')561\$"
stdout_has "^boundary corners$(printf '\t')0\$"
ok rm-quadfit --stats torus.obj -o st.tsv
same_bytes st.tsv t.tsv

check 'many inputs, one folder, a depfile'
mkdir many
ok rm-quadfit -M many/deps -O many torus.obj shuffled.obj
same_bytes many/torus.tsv t.tsv
same_bytes many/shuffled.tsv shuffled.tsv
equal "$(head -n 1 many/deps | sed 's/ .$//')" \
    'many/torus.tsv many/shuffled.tsv:' depfile
exits 1 rm-quadfit -O many torus.obj nowhere.obj --format ply
present many/torus.ply
absent many/nowhere.ply
stderr_has '^rm-quadfit: .*nowhere.obj'
stderr_has '^rm-quadfit: 1 of 2 failed$'

check 'a model and a ring of one'\''s own'
ok rm-quadfit --model ab -o ab.tsv torus.obj
equal "$(cut -f 21 ab.tsv | sort -u | tr '\n' ' ')" '2 rank ' rank
equal "$(cut -f 15 ab.tsv | sort -u | tr '\n' ' ')" '0 c ' c
ok rm-quadfit --ring 4 -o ring.tsv torus.obj
differ ring.tsv t.tsv

check 'the nasty meshes: an error of one line, or a file without NaN'
if [ -d "$RELIEF_DATA/meshes/nasty" ]; then
	for f in "$RELIEF_DATA"/meshes/nasty/*; do
		for type in tsv glb; do
			rm -f nasty.*
			got=0
			timeout 20 rm-quadfit -q --frame auto --stats "$f" \
			    -o nasty.$type >"$PRIV/out" 2>"$PRIV/err" || got=$?
			case $got in
			0)
				grep -qiE 'nan|inf' "$PRIV/out" && bad "$f: nan"
				[ $type != tsv ] || ! cut -f 3- nasty.tsv |
				    grep -qiE 'nan|inf' || bad "$f: nan"
				present nasty.$type
				;;
			1)
				stderr_one_line "$(basename "$f")"
				absent nasty.$type
				;;
			*) bad "$f: exit status $got" ;;
			esac
		done
	done
else
	skip "the shared meshes are not there ($RELIEF_DATA/meshes/nasty)"
fi
