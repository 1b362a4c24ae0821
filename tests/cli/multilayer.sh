# rm-multilayer: textures of closed meshes, and what it says of others.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-multilayer rm-info python3
cp "$DATA/torus.obj" torus.obj
tool=rm-multilayer

# python with the tests' own image decoder, and the set of PREFIX as
# layers(PREFIX)[y][x] = list of (depth, nx, ny) codes
cat >"$PRIV/layers.py" <<'END'
import os
import sys
sys.path.insert(0, os.environ["top"] + "/tests/cli")
import codes


def image(path):
    data = open(path, "rb").read()
    read = {"png": codes.read_png, "tga": codes.read_tga,
            "tiff": codes.read_tiff, "exr": codes.read_exr}
    width, nchans, bits, rows = read[path.rsplit(".", 1)[1]](data)
    return width, nchans, bits, [
        [row[x * nchans:(x + 1) * nchans] for x in range(width)]
        for row in rows]


def layers(prefix, ext="png", dilated=False):
    found = None
    for t in ["", "2", "3", "4"]:
        name = prefix + "_%s" + t + "." + ext
        if not os.path.exists(name % "depth"):
            break
        width, n, bits, d = image(name % "depth")
        assert n == 4, n
        top = (1 << bits) - 1
        nx, ny = image(name % "nx")[3], image(name % "ny")[3]
        if found is None:
            found = [[[] for _ in row] for row in d]
        for y, row in enumerate(d):
            for x, texel in enumerate(row):
                for c in range(4):
                    if texel[c] < top:
                        found[y][x].append(
                            (texel[c], nx[y][x][c], ny[y][x][c]))
                    elif not dilated:
                        assert nx[y][x][c] == (top + 1) // 2, (x, y)
    return found


def check(l, lo=1, hi=254):
    for y, row in enumerate(l):
        for x, t in enumerate(row):
            c = [s[0] for s in t]
            assert len(c) % 2 == 0, (x, y, c)
            assert all(a < b for a, b in zip(c, c[1:])), (x, y, c)
            assert all(lo <= v <= hi for v in c), (x, y, c)
END
export top PYTHONPATH="$PRIV"
py() {
	{
		echo 'from layers import *'
		cat -
	} >"$PRIV/script.py"
	python3 -B "$PRIV/script.py" >"$PRIV/py" 2>&1 || {
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

# a box X0 Y0 Z0 X1 Y1 Z1 [N]: OBJ with outward faces, indices from N (1)
box() {
	awk -v x0="$1" -v y0="$2" -v z0="$3" -v x1="$4" -v y1="$5" -v z1="$6" \
	    -v n="${7:-1}" 'BEGIN {
		for (i = 0; i < 8; i++)
			print "v", (i % 2) ? x1 : x0, (int(i / 2) % 2) ? y1 : y0,
			    (i > 3) ? z1 : z0
		split("1 3 4 2  5 6 8 7  1 2 6 5  3 7 8 4  1 5 7 3  2 4 8 6", f)
		for (i = 1; i <= 24; i += 4)
			print "f", f[i] + n - 1, f[i + 1] + n - 1,
			    f[i + 2] + n - 1, f[i + 3] + n - 1
	}'
}

check 'help, version and wrong usage'
ok rm-multilayer --help
stdout_has '^usage: rm-multilayer '
stdout_has '\[=N\]'
sed -n 's/^  ... --\([a-z-]*\).*/\1/p' "$PRIV/out" | sort -c || bad 'not sorted'
ok rm-multilayer -V
usage_error rm-multilayer
usage_error rm-multilayer torus.obj
usage_error rm-multilayer -o t
usage_error rm-multilayer torus.obj -o t.png
stderr_has 'format png'
usage_error rm-multilayer torus.obj torus.obj -o t
usage_error rm-multilayer torus.obj torus.obj -O .
usage_error rm-multilayer torus.obj -o t -O .
usage_error rm-multilayer torus.obj --from-depth d.png -o t
usage_error rm-multilayer --mip-levels torus.obj -o -
usage_error rm-multilayer --views 3 torus.obj -o -
for o in --layers=3 --layers=0 --layers=66 --layers=x --axis=w --axis=+xy \
    --tile=z --region=0,0,1 --region=1,0,0,1 --region=0,0,nan,1 \
    --depth-range=1 --depth-range=1,1 --weld=-1 --solidify=0 --solidify=-1 \
    --views=2 --size=0x4 --size=4 --cap-policy=best --dilate=-1 --format=tsv \
    --target=unreal --mip-levels=x --mip-threshold=0.5 --normals=none \
    '--deep --mip-levels' '--deep --multi-part' '--impostor --region=0,0,1,1' \
    '--no-color --all-colors' '--format=png --multi-part' '-d half' \
    '-d float --format tga'; do
	# shellcheck disable=SC2086 # several words
	usage_error rm-multilayer $o -o t torus.obj
done
no_litter torus.obj

check 'a torus: files, parity, order, metadata'
ok rm-multilayer torus.obj -o t
no_litter torus.obj t_depth.png t_nx.png t_ny.png t_color.png
py <<'END'
l = layers("t")
check(l)
# edge-on: both sides of the ring beside its hole
assert {len(t) for row in l for t in row} == {0, 2, 4}
assert image("t_color.png")[1] == 3
END
ok rm-info --json t_depth.png
equal "$(json layout)" layer-depth layout
equal "$(json width)" 256 width
ok rm-info t_nx.png t_ny.png t_color.png

check 'a cube: the whole range, whole through its diagonals'
box -1 -1 -1 1 1 1 >cube.obj
for size in 2x2 16x16 17x17; do
	ok rm-multilayer --flat --size $size cube.obj -o c
	py <<'END'
for row in layers("c"):
    for t in row:
        assert t == [(1, 128, 128), (254, 128, 128)], t
END
done
ok rm-multilayer -d uint16 cube.obj --flat -o c
py <<'END'
for row in layers("c"):
    for t in row:
        assert t == [(257, 32768, 32768), (65278, 32768, 32768)], t
END

check 'a ball: depths and normals of the closed form'
python3 - >ball.obj <<'END'
import math
n, m = 256, 128
print("v 0 -1 0")
for i in range(1, m):
    for k in range(n):
        t, p = math.pi * i / m, 2 * math.pi * k / n
        print("v", math.sin(t) * math.sin(p), -math.cos(t),
              math.sin(t) * math.cos(p))
print("v 0 1 0")
at = lambda i, k: 2 + (i - 1) * n + k % n
for k in range(n):
    print("f", 1, at(1, k + 1), at(1, k))
    for i in range(1, m - 1):
        print("f", at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k))
    print("f", at(m - 1, k), at(m - 1, k + 1), 2 + (m - 1) * n)
END
ok rm-multilayer --size 64x64 -d uint16 ball.obj -o b
py <<'END'
import math
l = layers("b")
check(l, 257, 65278)
# the facets' sagitta: 1 - cos of half their angle
sag = 1 - math.cos(math.pi / 128 / 2) ** 2
for y in range(64):
    for x in range(64):
        X, Y = (x + .5) / 32 - 1, 1 - (y + .5) / 32
        r2 = X * X + Y * Y
        if r2 > 0.98:
            continue
        assert len(l[y][x]) == 2, (x, y)
        z = math.sqrt(1 - r2)
        for i, s in enumerate((1, -1)):
            code, nx, ny = l[y][x][i]
            d = (255 * code / 65535 - 1) / 253
            # a facet lies up to sag below the ball, along the normal
            assert abs(d - (1 - s * z) / 2) < sag / z / 2 + 1e-5, (x, y, d)
            n = (nx * 2 / 65535 - 1, ny * 2 / 65535 - 1)
            # 0.5 degrees
            assert math.hypot(n[0] - X, n[1] - Y) < 0.0088, (x, y, n, X, Y)
END

check 'from the side that was asked for'
box 0 0 0 4 2 1 >slab.obj
box 0 0 1 1 1 3 9 >>slab.obj
for axis in +x -x +y -y +z -z z; do
	ok rm-multilayer --axis $axis --size 32x32 --flat slab.obj -o "s$axis"
done
same_result s+z_depth.png sz_depth.png
py <<'END'
def mask(axis):
    l = layers("s" + axis)
    check(l)
    return [[len(t) > 0 for t in row] for row in l]


def extent(axis):
    m = mask(axis)
    xs = [x for row in m for x, v in enumerate(row) if v]
    return (max(xs) - min(xs) + 1, sum(any(r) for r in m))


assert extent("+z") == (32, 16), extent("+z")
# 3 : 2, the edge of a texel may go either way
assert extent("+x") in ((32, 21), (32, 22)), extent("+x")
assert extent("+y") == (32, 24), extent("+y")
# seen from the other side it is mirrored: left and right for x and z
for a, b in (("+x", "-x"), ("+z", "-z")):
    assert mask(a) == [row[::-1] for row in mask(b)], a
assert mask("+y") == mask("-y")[::-1]
END

check 'region, range and tiling'
ok rm-multilayer --region 0,0,4,4 --size 32x32 --flat slab.obj -o r
ok rm-multilayer --region -1,1,3,5 --tile xy --size 32x32 --flat slab.obj -o w
ok rm-multilayer --region 0,0,4,4 --tile xy --size 32x32 --flat slab.obj -o v
ok rm-info --compare r_depth.png v_depth.png
py <<'END'
a, b = layers("r"), layers("w")
# 1 unit is 8 texels: moved 8 to the right and 8 down
assert all(b[(y + 8) % 32][(x + 8) % 32] == a[y][x]
           for y in range(32) for x in range(32))
END
ok rm-multilayer --depth-range 4,0 --size 8x8 --flat slab.obj -o d
py <<'END'
top = {t[0][0] for row in layers("d") for t in row if t}
# Z = 1 and 3 of 4..0
assert top == {round(1 + 253 * .25), round(1 + 253 * .75)}, top
END
exits 0 rm-multilayer --depth-range 0,4 --size 8x8 --flat slab.obj -o e
stderr_one_line 'is taken as 4,0'
same_result d_depth.png e_depth.png
exits 0 rm-multilayer --depth-range 2,0 --size 8x8 --flat slab.obj -o e
stderr_one_line 'outside the depth range'
exits 0 rm-multilayer --region 10,10,11,11 --size 8x8 slab.obj -o e
stderr_one_line 'all is empty'

check 'more layers than four: further textures, all, or a cap'
for i in 0 1 2 3 4; do
	t=$((i % 4 ? 1 : 4))
	box 0 0 $((6 * i)) 9 9 $((6 * i + t)) $((8 * i + 1))
done >pile.obj
ok rm-multilayer --layers all --size 8x8 --flat pile.obj -o p
present p_depth.png p_depth2.png p_depth3.png p_nx3.png p_ny3.png
ok rm-multilayer --layers 10 --size 8x8 --flat pile.obj -o q
same_result p_depth3.png q_depth3.png
exits 0 rm-multilayer --size 8x8 --flat pile.obj -o c4
stderr_one_line '64 of 64 texels have more than 4 layers'
exits 0 rm-multilayer --size 8x8 --cap-policy nearest --flat pile.obj -o n4
py <<'END'
full, cap, near = layers("p"), layers("c4"), layers("n4")
for l in full, cap, near:
    check(l)
assert all(len(t) == 10 for row in full for t in row)
assert all(len(t) == 4 for row in cap for t in row)
assert near[0][0] == full[0][0][:4], near[0][0]
# the outermost surfaces stay
assert (cap[0][0][0], cap[0][0][3]) == (full[0][0][0], full[0][0][9])
END

check 'parts that overlap are one solid'
box 0 0 0 2 2 2 >two.obj
box 1 1 1 3 3 3 9 >>two.obj
ok rm-multilayer --size 12x12 --flat two.obj -o u
py <<'END'
l = layers("u")
check(l)
assert all(len(t) in (0, 2) for row in l for t in row)
END
ok rm-multilayer --size 12x12 --stats two.obj
stdout_has '^texels united	16$'
stdout_has '^texels with 2 layers	112$'

check 'a mesh that does not close is an error, and the way out helps'
sed '$d' cube.obj >open.obj
exits 1 rm-multilayer --size 8x8 --axis +x open.obj -o bad
stderr_one_line '64 of 64 texels do not close'
stderr_has 'solidify'
absent bad_depth.png
exits 1 rm-multilayer --size 8x8 --axis +x --deep open.obj -o bad
stderr_one_line '64 of 64 texels do not close'
absent bad.exr
ok rm-multilayer --size 8x8 --axis +x --solidify 0.1 open.obj -o ok
py <<'END'
check(layers("ok"))
END
awk '$1 == "f" { print "f", $5, $4, $3, $2; next } { print }' cube.obj >in.obj
exits 1 rm-multilayer --size 8x8 in.obj -o bad
stderr_one_line 'inside out'
stderr_has 'reorient'
ok rm-multilayer --size 8x8 --flat --reorient in.obj -o ok
ok rm-multilayer --size 8x8 --flat cube.obj -o right
same_result ok_depth.png right_depth.png
same_result ok_nx.png right_nx.png
# one of two parts is inside out: solid all the same
{
	box 0 0 0 1 1 1
	box 2 0 0 2.5 0.5 1 9 | awk '$1 == "f" {
		print "f", $5, $4, $3, $2; next } { print }'
} >mixed.obj
{
	box 0 0 0 1 1 1
	box 2 0 0 2.5 0.5 1 9
} >both.obj
exits 0 rm-multilayer --size 20x20 --flat mixed.obj -o mixed
stderr_one_line 'enter the solid through its inside'
ok rm-multilayer --size 20x20 --flat both.obj -o both
same_result mixed_depth.png both_depth.png
same_result mixed_nx.png both_nx.png
ok rm-multilayer --size 20x20 --flat --reorient mixed.obj -o mixed
same_result mixed_depth.png both_depth.png

# each face has corners of its own, some moved by a little
awk '$1 == "v" { p[++n] = $2 " " $3 " " $4 }
    $1 == "f" {
	for (i = 2; i <= 5; i++) {
		split(p[$i], c, " ")
		print "v", c[1] * (1 + 0.02 * (++m % 3)), c[2], c[3]
	}
	print "f -4 -3 -2 -1"
    }' cube.obj >cracked.obj
exits 1 rm-multilayer --size 99x99 cracked.obj -o bad
stderr_has 'weld'
ok rm-multilayer --size 99x99 --weld 0.1 cracked.obj -o ok

check 'colours: a texture through its UVs, in the right place'
cat >quad.mtl <<'END'
newmtl m
Kd 1 1 1
map_Kd quad.png
END
test_map normal 8 8x8 quad.png
{
	echo 'mtllib quad.mtl'
	box 0 0 0 1 1 1 | grep '^v'
	echo 'vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl m
f 5/1 6/2 8/3 7/4
f 1/1 3/4 4/3 2/2
f 1/1 2/1 6/1 5/1
f 3/1 7/1 8/1 4/1
f 1/1 5/1 7/1 3/1
f 2/1 4/1 8/1 6/1'
} >quad.obj
ok rm-multilayer --size 8x8 -M quad.d quad.obj -o quad
grep -q 'quad.png' quad.d || bad "the depfile has no texture: $(cat quad.d)"
codes quad_color.png 0,1,2 >got
codes quad.png 0,1,2 >want
same_bytes got want
ok rm-multilayer --size 8x8 --all-colors quad.obj -o all
present all_color.png all_color2.png all_color3.png all_color4.png
ok rm-multilayer --size 8x8 --no-color quad.obj -o none
absent none_color.png
sed '/mtllib/d; /usemtl/d' quad.obj >bare.obj
ok rm-multilayer --size 8x8 --texture quad.png bare.obj -o bare
same_result quad_color.png bare_color.png
rm quad.png
exits 0 rm-multilayer --size 8x8 quad.obj -o quad
stderr_one_line 'quad.png'

check 'every type and format holds the same layers'
ok rm-multilayer --size 32x32 torus.obj -o t
for type in tga tiff; do
	ok rm-multilayer --size 32x32 --format $type torus.obj -o t
	py <<END
assert layers("t") == layers("t", "$type")
END
done
ok rm-multilayer --size 32x32 -d half --format exr torus.obj -o h
ok rm-multilayer --size 32x32 -d float --format exr torus.obj -o f
py <<'END'
import struct
a = layers("t")
for prefix, fmt in ("h", "<eH"), ("f", "<fI"):
    d = image(prefix + "_depth.exr")[3]
    for y, row in enumerate(d):
        for x, texel in enumerate(row):
            v = [struct.unpack("<" + fmt[1],
                               struct.pack("<" + fmt[2], c))[0]
                 for c in texel]
            got = [u for u in v if u < 1]
            assert len(got) == len(a[y][x]), (x, y)
            for u, s in zip(got, a[y][x]):
                assert abs(u - s[0] / 255) <= 0.5 / 255 + 2 ** -12, (u, s)
END

check 'policarpo: y is down'
ok rm-multilayer --size 32x32 --target policarpo torus.obj -o y
same_result t_depth.png y_depth.png
ok rm-info --compare t_nx.png y_nx.png
py <<'END'
a, b = image("t_ny.png")[3], image("y_ny.png")[3]
d = image("t_depth.png")[3]
assert all(w == 255 - v if e < 255 else v == w == 128
           for r, s, f in zip(a, b, d) for p, q, g in zip(r, s, f)
           for v, w, e in zip(p, q, g))
END
ok rm-info --json y_ny.png
equal "$(json declared.normal_y)" down y
ok rm-multilayer --size 32x32 --output-normal-y down torus.obj -o z
same_result y_ny.png z_ny.png

check 'mip levels are sets of their own, without skins'
ok rm-multilayer --size 32x16 --mip-levels torus.obj -o m
present m_mip1_depth.png m_mip5_color.png
absent m_mip6_depth.png
ok rm-multilayer --size 32x16 --mip-levels 2 torus.obj -o n
present n_mip2_ny.png
absent n_mip3_depth.png
ok rm-multilayer --size 32x16 torus.obj --mip-levels=2 -o o
same_result m_mip2_depth.png n_mip2_depth.png
same_result o_mip2_depth.png n_mip2_depth.png
py <<'END'
base = layers("m")
for k in range(1, 6):
    l = layers("m_mip%d" % k)
    check(l)
    assert len(l) == max(1, 16 >> k) and len(l[0]) == max(1, 32 >> k)
    known = {s[0] for row in base for t in row for s in t}
    assert all(s[0] in known for row in l for t in row for s in t)
END

check 'dilation changes normals and colours of empty layers alone'
ok rm-multilayer --size 32x32 --dilate 3 torus.obj -o g
same_result t_depth.png g_depth.png
differ t_nx.png g_nx.png
differ t_color.png g_color.png

check 'impostors: alpha, the middle, three views'
ok rm-multilayer --impostor --views 3 --size 32x32 torus.obj -o i
for v in x y z; do
	present i_${v}_depth.png i_${v}_color.png
done
py <<'END'
for v in "xyz":
    l = layers("i_" + v, dilated=True)
    w, n, bits, c = image("i_%s_color.png" % v)
    assert n == 4
    for y in range(32):
        for x in range(32):
            assert c[y][x][3] == (255 if l[y][x] else 0), (x, y)
            if x in (0, 31) or y in (0, 31):
                assert not l[y][x], (x, y)
END

check 'one EXR of parts, and a deep one'
ok rm-multilayer --size 32x32 torus.obj -o t.exr
ok rm-multilayer --size 32x32 --multi-part --mip-levels torus.obj -O .
same_bytes torus.exr torus.exr
ok rm-multilayer --size 32x32 --deep torus.obj -o deep.exr
ok sh -c 'rm-multilayer --size 32x32 torus.obj -o - >piped.exr'
same_bytes t.exr piped.exr
ok rm-info -q t.exr
stdout_has 'layer-depth'
if command -v oiiotool >/dev/null; then
	oiiotool --info -a t.exr >"$PRIV/info"
	grep -q 'ny' "$PRIV/info" || grep -q '4 subimages' "$PRIV/info" ||
		bad "$(cat "$PRIV/info")"
	oiiotool --info deep.exr | grep -q deep || bad 'it is not deep'
fi

check 'a height field in the same layout'
cp "$DATA/bricks_depth.png" bricks.png
ok rm-multilayer --from-depth bricks.png -o hf
py <<'END'
w, n, bits, a = image("bricks.png")
w2, n2, bits2, b = image("hf_depth.png")
top, top2 = (1 << bits) - 1, (1 << bits2) - 1
assert (w, n2, bits) == (w2, 4, bits2)
for r, s in zip(a, b):
    for p, q in zip(r, s):
        want = (1 + 253 * p[0] / top) / 255 * top2
        # to the nearest, but for a float's last bit
        assert abs(q[0] - want) <= 0.5 + 65535 * 2 ** -24, (p, q)
        assert q[1:] == [top2] * 3, q
END
absent hf_color.png
cp bricks.png own_depth.png
exits 1 rm-multilayer --from-depth own_depth.png -o own
stderr_one_line 'choose another PREFIX'
same_bytes bricks.png own_depth.png
ok rm-multilayer --height --from-depth bricks.png -o hg
py <<'END'
a, b = image("hf_depth.png"), image("hg_depth.png")
top = (1 << a[2]) - 1
# codes that lie half way may both be rounded to the same side
assert all(abs(p[0] + q[0] - top) <= 1 for r, s in zip(a[3], b[3])
           for p, q in zip(r, s))
END

check 'a preview'
ok rm-multilayer --size 64x64 --preview look.png torus.obj -o t
py <<'END'
w, n, bits, rows = image("look.png")
assert n == 3 and w > 128, (w, n)
END

check 'the same bytes for any number of threads, anywhere'
ok rm-multilayer -j1 --size 100x75 --mip-levels --dilate 2 torus.obj -o one
mkdir -p sub
cp torus.obj 'sub/other name.obj'
ok sh -c "cd sub && rm-multilayer -j7 --size 100x75 --mip-levels --dilate 2 \
    'other name.obj' -o two"
for f in depth nx ny color mip1_depth mip3_nx mip6_color; do
	same_bytes one_$f.png sub/two_$f.png
done
for o in --multi-part --deep; do
	ok rm-multilayer -j1 --size 100x75 $o torus.obj -o p1
	ok rm-multilayer -j7 --size 100x75 $o torus.obj -o p7
	same_bytes p1.exr p7.exr
done

check 'scaled and turned meshes'
awk '$1 == "v" { print "v", $2 * 8, $3 * 8, $4 * 8; next } { print }' \
    torus.obj >big.obj
ok rm-multilayer --size 40x40 torus.obj -o t
ok rm-multilayer --size 40x40 big.obj -o big
for f in depth nx ny; do
	ok rm-info --compare t_$f.png big_$f.png
done
awk '$1 == "v" || $1 == "vn" { print $1, -$3, $2, $4; next } { print }' \
    torus.obj >turned.obj
ok rm-multilayer --size 40x40 turned.obj -o turned
py <<'END'
a, b = layers("t"), layers("turned")
# x of the one is -y of the other: turned to the left
assert all([s[0] for s in b[39 - x][y]] == [s[0] for s in a[y][x]]
           for y in range(40) for x in range(40))
END

check 'every nasty mesh is an error that names it, or a whole result'
if [ -d "$RELIEF_DATA/meshes/nasty" ]; then
	n=0
	for f in "$RELIEF_DATA"/meshes/nasty/*; do
		got=0
		rm-multilayer -q --size 64x64 "$f" -o nasty >"$PRIV/out" \
		    2>"$PRIV/err" || got=$?
		n=$((n + 1))
		case $got in
		0) echo "check(layers('nasty'))" | py ;;
		1) stderr_one_line "$(basename "$f")" ;;
		*) bad "$f: exit status $got" ;;
		esac
		rm -f nasty_*
	done
	[ "$n" -gt 20 ] || bad "just $n files"
else
	skip "the shared meshes are not there ($RELIEF_DATA)"
fi
