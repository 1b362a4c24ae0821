# rm-render as a user sees it: pictures, buffers, comparisons, bad use.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-render rm-pack rm-combine rm-multilayer rm-quadfit python3
cp "$DATA/torus.obj" torus.obj
rm-pack --normal "$DATA/stone_normal.png" --depth "$DATA/stone_depth.png" \
    -s 0.08 -o stone.png
rm-pack --depth "$DATA/woven_depth.png" -s 0.02 -o woven.png
test_map plane 8 8x8 third.png
test_map random 8 8x8 tiles.png
inputs='stone.png third.png tiles.png torus.obj woven.png'
small='--size 80x60'

rm-render --help | sed -n '/^usage: /p' >"$PRIV/usage"
usage_error() {
	exits 2 "$@"
	stdout_empty
	sed 1d "$PRIV/err" | cmp -s - "$PRIV/usage" &&
		sed -n 1p "$PRIV/err" | grep -q '^rm-render: ' ||
		bad "'$*': not one reason and the usage:" "$(cat "$PRIV/err")"
}

# python with the tests' own decoder: codes(PNG)[y][x] and buffers(EXR)[y][x],
# the latter as floats by the channel's name
cat >"$PRIV/pictures.py" <<'END'
import math
import os
import struct
import sys
sys.path.insert(0, os.environ["top"] + "/tests/cli")
import codes as decoder

NAMES = ["R", "G", "B", "A", "AO", "N.x", "N.y", "N.z", "Z", "mask", "uv.u",
         "uv.v"]


def codes(path):
    w, n, bits, rows = decoder.read(path)
    return [[tuple(r[n * x:n * x + n]) for x in range(w)] for r in rows]


def buffers(path):
    head = decoder.exr_header(open(path, "rb").read())[0]
    for name in NAMES:
        assert name.encode() + b"\0" in head["channels"][1], name
    w, n, bits, rows = decoder.read(path)
    assert (n, bits) == (12, 32), (n, bits)
    return [[dict(zip(NAMES, struct.unpack("<12f", struct.pack(
        "<12I", *r[12 * x:12 * x + 12])))) for x in range(w)] for r in rows]


def srgb(v):
    return 255 * (12.92 * v if v <= 0.0031308
                  else 1.055 * v ** (1 / 2.4) - 0.055)


def near(a, b, tolerance):
    assert abs(a - b) <= tolerance, (a, b)
END
export top PYTHONPATH="$PRIV"
py() {
	{
		echo 'from pictures import *'
		cat -
	} >"$PRIV/script.py"
	python3 -B "$PRIV/script.py" >"$PRIV/py" 2>&1 || {
		bad 'python says:'
		sed 's/^/    | /' "$PRIV/py"
	}
}

# compared KEY: the value that --compare printed
compared() {
	sed -n "s/^$1	//p" "$PRIV/out"
}

# holds CONDITION: of numbers, in awk
holds() {
	awk "BEGIN { exit !($1) }" || bad "not so: $1"
}

# shellcheck disable=SC2086 # $small is several words
{
check 'help, version and wrong usage'
ok rm-render --help
stdout_has '^usage: rm-render '
sed -n 's/^  ... --\([a-z-]*\).*/\1/p' "$PRIV/out" | sort -c || bad 'not sorted'
ok rm-render -V
usage_error rm-render
usage_error rm-render stone.png
usage_error rm-render -O . stone.png
stderr_has '^rm-render: -O means nothing'
usage_error rm-render -o out.jpg
usage_error rm-render -o -
usage_error rm-render --compare x.exr --format png -o -
for o in --ambient=-1 --ao=yes --ao-blend=bake --background=0,0 \
    --base-color=1,1 --camera=0 --camera=0,91 --camera=0,0,0 \
    --camera=0,0,1,1 --depth=0 --depth-scale=0 --detail=0 --detail=1025 \
    --difference=d.png --fov=0 --fov=171 --light=0,0,0 --light=1,2 \
    --model=rough --normal-blend=rnm --orthographic=0 --paint=c \
    --point-light=1 --repeat=0 --repeat=1x --repeat=1x2x3 --rotate=1,2 \
    --roughen=2 --samples=2 --scale=0 --search=fast --search=0,1 \
    --search=1,65 --search=1.5,2 --search=8 --shininess=-1 --shininess=2.5 \
    --silhouette=yes --size=80 --size=0x60 --specular=nan --target=1 \
    --translate=x --turntable=0 '-w -1 stone.png' '-t 0 stone.png' \
    '--offset 1 stone.png' '--layer-depth-scale 0 stone.png' \
    '--depth-weight=-1 stone.png' '--normal-weight=inf stone.png' \
    '-d half' '--turntable 2 --buffers b.exr' '--turntable 2 --compare x.exr' \
    'stone.png --multilayer m' '--impostor m stone.png' \
    'stone.png woven.png --silhouette shell'; do
	usage_error rm-render $o -o out.png
done
for o in '-w 1' '-t 2' '--offset 0,0' '--depth-weight 1' '--normal-weight 1' \
    '--layer-depth-scale 1'; do
	usage_error rm-render stone.png $o -o out.png
	stderr_has 'none follows'
done
many=$(yes -- '--shape cube' | head -17)
usage_error rm-render $many -o out.png
stderr_has '16 objects'
many=$(yes stone.png | head -17)
usage_error rm-render $many -o out.png
stderr_has '16 layers'
no_litter $inputs

check 'bad input leaves one line and no file'
for o in 'none.png' '--color none.png' '--shape none.obj' \
    '--shape torus.obj --silhouette quadric --quadric none.tsv stone.png' \
    '--multilayer none' '--impostor none' '--impostor none.exr' \
    '--multilayer stone.png --ground none.png' '--compare none.exr' \
    '--impostor stone' 'torus.obj' '--shape stone.png'; do
	exits 1 rm-render $small $o -o out.png
	stderr_one_line 'rm-render: '
	absent out.png
done
exits 1 rm-render third.png -o out.png
stderr_one_line 'third.png'
exits 1 rm-render -w 0 stone.png -o out.png
stderr_one_line 'weight'
exits 1 rm-render stone.png -o nowhere/out.png
stderr_one_line 'nowhere'
exits 1 rm-render --camera 1,1,1,1,1,1 -o out.png
stderr_one_line 'rm-render: '
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >bare.obj
exits 1 rm-render $small --shape bare.obj stone.png -o out.png
stderr_one_line 'bare.obj'
ok rm-render $small --shape bare.obj -o out.png
printf 'v\tvt\tx\tnonsense\n1 2 3\n' >bad.tsv
exits 1 rm-render $small --shape sphere --quadric bad.tsv --paint a -o bad.png
stderr_one_line 'bad.tsv'
ok rm-render $small stone.png --buffers b.exr
exits 1 rm-render --size 81x60 stone.png --compare b.exr
stderr_one_line '80x60'
exits 1 rm-render $small stone.png --compare woven.png
stderr_one_line 'woven.png'
rm -f b.exr bare.obj bad.tsv out.png
no_litter $inputs

check 'every shape is there, whole, with the mask of its outline'
for s in plane cube sphere cylinder torus teapot; do
	ok rm-render --size 64x64 --shape $s --buffers $s.exr -o $s.png
done
py <<'END'
for s in "plane cube sphere cylinder torus teapot".split():
    b, c = buffers(s + ".exr"), codes(s + ".png")
    hit = sum(p["mask"] for r in b for p in r)
    assert hit > 200, (s, hit)
    for x in range(64):
        for p in b[0][x], b[63][x], b[x][0], b[x][63]:
            assert p["mask"] == 0 and p["Z"] == math.inf, (s, x)
    for row, line in zip(b, c):
        for p, q in zip(row, line):
            n = math.hypot(p["N.x"], p["N.y"], p["N.z"])
            near(n, p["mask"], 1e-6)  # 1, or 0 with it
            for k in range(3):  # half a code, and the standard's constants
                near(srgb(min(1, p["RGB"[k]])), q[k], 0.51)
# the sphere fills a cone of asin(1/3) of 20 degrees
hit = sum(p["mask"] for r in buffers("sphere.exr") for p in r)
r = 32 * math.tan(math.asin(1 / 3)) / math.tan(math.radians(20))
near(hit, math.pi * r * r, 2 * math.pi * r / 4)
END
rm -- *.exr plane.png cube.png sphere.png cylinder.png torus.png teapot.png

check 'a white plane lit head on has the code of its light'
for v in '0.25 0.5' '0 0.0025' '0.3 0.9'; do
	set -- $v
	ok rm-render $small --camera 0,90 --base-color "$2,$2,$2" \
	    --ambient "$1" --specular 0 --light 0,1,0 -o w.png
	py <<END
want = srgb(min(1, $2 * (1 + $1)))
for k in range(3):
    near(codes("w.png")[30][40][k], want, 0.51)
END
done
ok rm-render $small --camera 0,90 --base-color 1,0.5,0.25 --ambient 0 \
    --specular 0 --light 0,1,1.7320508 -d float -o w.exr
py <<'END'
w, n, bits, rows = decoder.read("w.exr")
rgb = struct.unpack("<3f", struct.pack("<3I", *rows[30][120:123]))
for got, want in zip(rgb, (0.5, 0.25, 0.125)):  # cos 60 degrees
    near(got, want, 1e-6)
END
rm w.png w.exr

check 'a background, and holes in it'
ok rm-render $small --shape sphere --background 0,0.5,1 -o b.png
ok rm-render $small --shape sphere --background 0,0,0,0 --samples 4 -o a.png
ok rm-render $small --shape sphere --background 0,0.5,1,0 --samples 4 -o c.png
same_result a.png c.png
py <<'END'
b, a = codes("b.png"), codes("a.png")
for got, want in zip(b[0][0], (0, srgb(0.5), 255)):
    near(got, want, 0.51)
assert a[0][0] == (0, 0, 0, 0) and a[30][40][3] == 255
edge = {p[3] for r in a for p in r}
assert edge <= {0, 64, 128, 191, 255} and len(edge) > 3, edge
# straight colours: not darker where the edge is thin
for r in a:
    for p in r:
        assert p[3] == 0 or min(p[:3]) > 40, p
END
rm a.png b.png c.png

check 'buffers of a plane seen from above'
ok rm-render --size 65x65 --camera 0,5,0,0,0,-0.0001 --light 0,1,0 \
    --buffers p.exr
ok rm-render --size 64x64 --camera 0,90,2 --orthographic 4 --buffers o.exr
# a third of the depth range, 0.6, below the plane: 0.2
rm-pack --depth third.png -s 0.3 -o floor.png
ok rm-render --size 64x64 --camera 0,90,2 --orthographic 4 floor.png \
    --search exact --buffers f.exr
ok rm-render --size 64x64 --camera 0,90,2 --orthographic 4 floor.png \
    --buffers g.exr
py <<'END'
p = buffers("p.exr")
tan = math.tan(math.radians(20))
for y in range(65):
    for x in range(65):
        X = (x - 32) / 32.5 * tan * 5
        Y = (32 - y) / 32.5 * tan * 5
        q = p[y][x]
        if max(abs(X), abs(Y)) > 1.01:
            assert q["mask"] == 0, (x, y)
        elif max(abs(X), abs(Y)) < 0.99:
            # the eye is 2e-5 off the vertical: 1e-4 at this distance
            near(q["Z"], math.sqrt(25 + X * X + Y * Y), 1e-4)
            near(q["uv.u"], (1 + X) / 2, 1e-4)
            near(q["uv.v"], (1 + Y) / 2, 1e-4)
            near(q["N.y"], 1, 1e-6)
            assert q["mask"] == q["A"] == q["AO"] == 1, q
# the ball round the plane has radius sqrt 2; pixels are 1/16
deep = 0.6 * 85 / 255
for name, below, tolerance in (("o", 0, 1e-6), ("f", deep, 1e-5),
                               ("g", deep, 1e-5)):
    b = buffers(name + ".exr")
    for y in range(64):
        for x in range(64):
            X, Y = (x + .5) / 16 - 2, 2 - (y + .5) / 16
            q = b[y][x]
            assert q["mask"] == (max(abs(X), abs(Y)) < 1), (x, y)
            if q["mask"]:
                near(q["Z"], 2 * math.sqrt(2) + below, tolerance)
                near(q["uv.u"], (1 + X) / 2, 1e-5)
                near(q["uv.v"], (1 + Y) / 2, 1e-5)
END
rm floor.png -- *.exr

check 'compared with itself, with a coarser search, and the difference'
ok rm-render $small stone.png --search exact --camera 0,20 --buffers ref.exr
ok rm-render $small stone.png --search exact --camera 0,20 --compare ref.exr \
    --difference same.png
equal "$(compared 'mask IoU')" 1.000000 IoU
equal "$(compared 'colour PSNR')" 'inf dB' PSNR
equal "$(compared 'depth max')" 0 'largest depth error'
equal "$(compared pixels)" 4800 pixels
ok rm-render $small stone.png --search 4,0 --camera 0,20 --compare ref.exr \
    --difference other.png
psnr=$(compared 'colour PSNR')
rms=$(compared 'depth RMS')
holds "${psnr% dB} < 40 && $rms > 1e-4"
ok rm-render $small stone.png --search 64,10 --camera 0,20 --compare ref.exr
fine=$(compared 'colour PSNR')
holds "${fine% dB} > ${psnr% dB} && $(compared 'depth RMS') < $rms"
ok rm-render $small --shape sphere --compare ref.exr
holds "$(compared 'mask IoU') < 0.9"
py <<'END'
assert {p for r in codes("same.png") for p in r} == {(128, 128, 128)}
assert len({p for r in codes("other.png") for p in r}) > 10
END
rm ref.exr same.png other.png

check 'the same bytes at any -j and BAKE_ISA, anywhere'
mkdir sub
cp stone.png woven.png sub
for o in 'stone.png --shape teapot --silhouette quadric --shadow' \
    'stone.png --search exact --samples 4' \
    'stone.png --search texel --camera 0,10' \
    '--shape sphere stone.png --silhouette shell' \
    '--shape cube stone.png -w 0.3 -t 4.5 woven.png --shadow' \
    '--shape torus --paint mean-curvature'; do
	ok rm-render -j1 $small $o -o one.png --buffers one.exr
	ok env BAKE_ISA=baseline rm-render -j3 $small $o -o two.png \
	    --buffers two.exr
	same_bytes one.png two.png
	same_bytes one.exr two.exr
	ok sh -c "cd sub && rm-render -j7 $small $o -o 'a name.png'"
	same_bytes one.png 'sub/a name.png'
done
rm -r sub one.png two.png one.exr two.exr

check 'a turntable, the depfile, standard output'
ok rm-render $small --shape teapot --turntable 4 -o t.png
present t_0001.png t_0002.png t_0003.png t_0004.png
absent t.png t_0000.png t_0005.png
ok rm-render $small --shape teapot --camera 120,25 -o yaw.png
same_result t_0002.png yaw.png
ok rm-render $small --shape torus.obj stone.png --color tiles.png -M r.d \
    -o r.png
for f in torus.obj stone.png tiles.png; do
	grep -q "$f" r.d || bad "the depfile has no $f: $(cat r.d)"
done
grep -q '^r.png' r.d || bad "r.png is no target: $(cat r.d)"
ok sh -c "rm-render $small --shape torus.obj stone.png --color tiles.png \
    --format png -o - >piped.png"
same_bytes r.png piped.png
rm t_*.png yaw.png r.d r.png piped.png

check 'objects in front of each other, through each other, moved'
ok rm-render $small --shape sphere --shape cube --scale 0.5 --buffers in.exr
ok rm-render $small --shape sphere --compare in.exr
# the ball round both is the sphere's
equal "$(compared 'depth max')" 0 'a cube inside the sphere'
ok rm-render --size 64x64 --orthographic 4 --camera 0,0,9,0,0,0 \
    --shape cube --scale 0.5 --translate 0.5,0,0 --base-color 1,0,0 \
    --shape cube --rotate 0,90,0 --scale 0.25 --translate 0,0,0.5 \
    --base-color 0,1,0 --specular 0 --light 0,0,1 --camera 0,0,8,0,0,0 \
    --buffers two.exr
py <<'END'
b = buffers("two.exr")
for y in range(64):
    for x in range(64):
        X, Y, q = (x + .5) / 16 - 2, 2 - (y + .5) / 16, b[y][x]
        green = max(abs(X), abs(Y)) < 0.25
        red = abs(X - 0.5) < 0.5 and abs(Y) < 0.5
        assert q["mask"] == (red or green), (x, y)
        if red or green:
            near(q["Z"], 8 - (0.75 if green else 0.5), 1e-6)
            assert (q["G"] > 0) == green and (q["R"] > 0) != green
END
ok rm-render $small --shape plane stone.png --shape plane --translate 0,-0.08,0 \
    --base-color 1,0,0 --search exact -o water.png
py <<'END'
red = [p[0] > 2 * p[1] for r in codes("water.png") for p in r if p[0] > 60]
# half way down there is some of each
assert 0.02 < sum(red) / len(red) < 0.98, sum(red) / len(red)
END
rm in.exr two.exr water.png

check 'live layers agree with the texture that rm-combine bakes'
ok rm-combine -q -d float stone.png -w 0.3 -t 2 woven.png --size 512x512 \
    --normal-blend pd -o meta.exr
ok rm-render $small meta.exr --search exact --buffers baked.exr
ok rm-render $small stone.png -w 0.3 -t 2 woven.png --search exact \
    --compare baked.exr
# one code of 8 bits of the range, 0.08 * 2 mesh units, at 1/sin of the slant;
# the base is filtered to twice its size by another kernel
holds "$(compared 'depth 90 %') < 0.16 / 255 * 3"
ok rm-render $small stone.png -o one.png
ok rm-render $small stone.png -w 0 woven.png -o none.png
same_result one.png none.png
ok rm-render $small stone.png -w 1 woven.png --offset 0.5,0 woven.png \
    --normal-blend seed --ao-blend min -o three.png
differ one.png three.png
rm meta.exr baked.exr one.png none.png three.png

check 'depth scale, repeats, occlusion and shadow do what they say'
ok rm-render $small stone.png -s 0.08 -o a.png
ok rm-render $small stone.png --depth 0.16 -o b.png
same_result a.png b.png
ok rm-render $small stone.png --repeat 3 -s 0.08 -o a.png
ok rm-render $small -t 3 stone.png -s 0.0266666666666666667 -o b.png
py <<'END'
# the same ground; the normals are steeper with -t, which keeps the range
a, b = codes("a.png"), codes("b.png")
assert [[max(p) > 45 for p in r] for r in a] == \
    [[max(p) > 45 for p in r] for r in b]
END
ok rm-render $small stone.png -o a.png
for o in --shadow '--ao off' '--search 8,2' '-s 0.02' '--specular 0.9' \
    '--shininess 2' '--point-light 0,1,0' '--ambient 0.1' '--fov 60'; do
	ok rm-render $small stone.png $o -o b.png
	differ a.png b.png
done
ok rm-render $small stone.png --shadow --light -2,0.7,0 --buffers s.exr
ok rm-render $small stone.png --light -2,0.7,0 --buffers l.exr
py <<'END'
s, l = buffers("s.exr"), buffers("l.exr")
dark = 0
for r, t in zip(s, l):
    for p, q in zip(r, t):
        assert p["Z"] == q["Z"] and p["G"] <= q["G"], (p, q)
        dark += p["G"] < q["G"]
assert dark > 20, dark
END
rm a.png b.png s.exr l.exr

check 'silhouettes: quadrics carve, a table says the same, shell as well'
ball='--shape sphere --repeat 4x2 stone.png -s 0.2 --search exact'
ok rm-render $small $ball --silhouette shell --buffers shell.exr
ok rm-render $small $ball --compare shell.exr
flat=$(compared 'mask IoU')
ok rm-render $small $ball --silhouette quadric --compare shell.exr
holds "$(compared 'mask IoU') > $flat"
ok rm-quadfit torus.obj -o torus.tsv
ok rm-render $small --shape torus.obj stone.png --silhouette quadric -o a.png
ok rm-render $small --shape torus.obj stone.png --silhouette quadric \
    --quadric torus.tsv -o b.png
ok rm-render $small --shape torus.obj stone.png --silhouette quadric \
    --quadric none -o none.png
differ a.png none.png
py <<'END'
# the table's numbers have 9 digits: a ray may just stay, or just leave
a, b = codes("a.png"), codes("b.png")
off = sum(p != q for r, s in zip(a, b) for p, q in zip(r, s))
assert off <= 4, off
END
rm shell.exr torus.tsv a.png b.png none.png

check 'paint: signs are colours'
ok rm-render $small --shape sphere --paint a --specular 0 -o s.png
ok rm-render $small --shape torus --paint mean-curvature --specular 0 -o t.png
py <<'END'
s = codes("s.png")
assert s[30][40][0] > s[30][40][2] + 30, s[30][40]  # convex: red
END
ok rm-render $small --shape plane --paint b --specular 0 -o s.png
py <<'END'
p = codes("s.png")[30][40]
assert p[0] == p[1] == p[2], p  # flat: white
END
rm s.png t.png

check 'colours through the UVs, and 2.5D texture mapping'
ok rm-render --size 64x64 --camera 0,90,2 --orthographic 2 --ambient 0 \
    --specular 0 --light 0,1,0 --color tiles.png -o c.png
py <<'END'
c, t = codes("c.png"), codes("tiles.png")


def light(c):
    c /= 255
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4


for y in range(8):
    for x in range(8):
        # four pixels, 1/16 beside the texel's centre: so much of its
        # neighbours is in each, in scene-linear light
        got = [light(c[8 * y + j][8 * x + i][0])
               for i in (3, 4) for j in (3, 4)]
        about = [light(t[(y + j) % 8][(x + i) % 8][0])
                 for i in (-1, 0, 1) for j in (-1, 0, 1)]
        part = 1 - (15 / 16) ** 2
        for g in got:  # and a code's rounding, at most 2.4 / 255 / 2
            near(g, about[4], part * (max(about) - min(about)) + 0.005)
END
ok rm-render $small --color tiles.png --roughen 0.1 --model flat -o f.png
ok rm-render $small --color tiles.png -o g.png
py <<'END'
a, b = codes("f.png"), codes("g.png")
# flat is Lambert's law in other words: one code
assert all(abs(u - v) <= 1 for r, s in zip(a, b) for p, q in zip(r, s)
           for u, v in zip(p, q))
END
for m in facet paper blackshot; do
	ok rm-render $small --color tiles.png --roughen 0.1 --model $m \
	    --light -3,1,0 -o g.png
	differ f.png g.png
done
rm c.png f.png g.png

check 'soft shadows from horizons: of a small light they are the hard ones'
rm-aobake -q --no-blur --directions 64 -s 0.08 --horizons horizons.exr \
    "$DATA/stone_depth.png" -o ao.png
view='--size 128x128 --camera 0,90,2 --orthographic 1.9 --light 2,1,0 --specular 0'
# shellcheck disable=SC2086 # several words
{
	ok rm-render $view stone.png -o none.png
	ok rm-render $view stone.png --shadow -o hard.png
	ok rm-render $view stone.png --shadow --horizons horizons.exr \
	    --light-size 0.1 -o small.png
	ok rm-render $view stone.png --shadow --horizons horizons.exr \
	    --light-size 20 -o large.png
	usage_error rm-render $view --horizons horizons.exr -o bad.png
	exits 1 rm-render $view stone.png --horizons ao.png -o bad.png
	stderr_one_line 'ao.png: holds no horizons'
}
py <<'END'
none, hard, small, large = (codes(f + ".png")
                            for f in ("none", "hard", "small", "large"))


def off(a, b):
    return sum(abs(p[0] - q[0]) > 16 for r, s in zip(a, b)
               for p, q in zip(r, s)) / 128 ** 2


# pixels are 1.1 texels wide: only along the edges of shadows, where a texel's
# horizon is that of its centre, the two differ
assert off(none, hard) > 0.05, off(none, hard)
assert off(small, hard) < off(none, hard) / 4, (off(small, hard),
                                                off(none, hard))
# a large light's shadows are between
assert 0.02 < off(large, small), off(large, small)
END
rm ao.png horizons.exr none.png hard.png small.png large.png

check 'multilayer relief, its ground, and impostors from every side'
ok rm-multilayer --impostor --size 128x128 torus.obj -o m
ok rm-multilayer --impostor --size 128x128 torus.obj -o m.exr
ok rm-render --size 96x96 --camera 30,25,3 --impostor m --search exact -o a.png
ok rm-render --size 96x96 --camera 30,25,3 --impostor m.exr --search exact \
    -o b.png
equal "$(codes a.png | wc -l)" 9216 pixels
exits 1 rm-render --impostor m.exr --color none.png -o c.png
for yaw in 0 45 90 180 270; do
	ok rm-render --size 96x96 --camera 0,0,6,0,0,0 --fov 30 \
	    --shape torus.obj --rotate 20,$yaw,0 --buffers mesh.exr
	ok rm-render --size 96x96 --camera 0,0,6,0,0,0 --fov 30 --search exact \
	    --impostor m --rotate 20,$yaw,0 --compare mesh.exr
	# texels are 1/64 of the radius, the outline of the ring is 4 % of it
	holds "$(compared 'mask IoU') > 0.95"
done
ok rm-render $small --multilayer m --samples 4 --background 0,0,0,0 -o a.png
ok rm-render $small --multilayer m --ground tiles.png --background 0,0,0,0 \
    --samples 4 -o b.png
ok rm-render $small --multilayer m --shadow --depth-bias -o c.png
py <<'END'
a, b = codes("a.png"), codes("b.png")
cover = [sum(p[3] for r in c for p in r) for c in (a, b)]
assert 0 < cover[0] < cover[1], cover
END
# one layer is solid below its depth: seen from above, each pixel is there
ok rm-multilayer --from-depth third.png -s 0.3 -o h
ok rm-render --size 64x64 --camera 0,90,2 --orthographic 1.9 --multilayer h \
    --buffers mesh.exr
py <<'END'
# 0.6 deep; the axes' range is that of rm-multilayer, 253 of 255 codes
for r in buffers("mesh.exr"):
    for p in r:
        assert p["mask"] == 1
        near(p["Z"], 2 * math.sqrt(2) + 0.6 * 85 / 255, 0.6 / 253)
END
rm -f h_* m m_* m.exr mesh.exr a.png b.png c.png

check 'every nasty image is an error that names it, or a picture'
if [ -d "$RELIEF_DATA/nasty_images" ]; then
	n=0
	for f in "$RELIEF_DATA"/nasty_images/*; do
		[ $((n += 1)) -le 25 ] || break
		got=0
		rm-render -q --size 16x16 --max-pixels 4000000 "$f" \
		    -o nasty.png >"$PRIV/out" 2>"$PRIV/err" || got=$?
		case $got in
		0) present nasty.png ;;
		1) stderr_one_line "$(basename "$f")" ;;
		*) bad "$f: exit status $got" ;;
		esac
		rm -f nasty.png
	done
else
	skip "the shared images are not there ($RELIEF_DATA)"
fi
no_litter $inputs
}
