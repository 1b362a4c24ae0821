# rm-roughen as a user sees it: what is kept, tables, fits, bad input.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-roughen python3

# wrong COMMAND...: exit 2, a reason and the usage, nothing written
wrong() {
	exits 2 "$@"
	stdout_empty
	stderr_has '^rm-roughen: '
	stderr_has '^usage: rm-roughen '
	absent out.png
}

# fails TEXT COMMAND...: exit 1 and one line that holds TEXT, nothing written
fails() {
	text=$1
	shift
	exits 1 "$@"
	stderr_one_line "$text"
	absent out.png
}

# Textures as text: kind, bits, and what the tests calculate with them.
cat >"$PRIV/texture.py" <<'END'
import struct, sys, zlib


def write(name, width, rows, nchans, bits=8):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(
            ">I", zlib.crc32(kind + data))
    body = b"".join(b"\0" + b"".join(
        v.to_bytes(bits // 8, "big") for v in row) for row in rows)
    colour = {1: 0, 2: 4, 3: 2, 4: 6}[nchans]
    open(name, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(
        b"IHDR", struct.pack(">IIBBBBB", width, len(rows), bits, colour, 0, 0,
                             0)) + chunk(b"IDAT", zlib.compress(body)) +
        chunk(b"IEND", b""))


def noise(n, state=[1]):
    for _ in range(n):
        total = 0
        for _ in range(12):
            state[0] = (state[0] * 1664525 + 1013904223) % 2 ** 32
            total += state[0] >> 8
        yield total / 2 ** 24 - 6


kind, name = sys.argv[1:]
w, h = 96, 64
if kind == "grey":  # mean 0.5, standard deviation 0.07
    g = [round(65535 * (0.5 + 0.07 * v)) for v in noise(w * h)]
    write(name, w, [g[y * w:y * w + w] for y in range(h)], 1, 16)
elif kind == "angle":  # 60 of 90 degrees
    write(name, w, [[43690] * w] * h, 1, 16)
elif kind == "black":
    write(name, w, [[0] * w] * h, 1)
else:  # colours and an alpha of all codes, 0 among them
    n = {"rgb": 3, "rgba": 4}[kind]
    g = [min(255, max(0, round(128 + 30 * v))) for v in noise(w * h * n)]
    if n == 4:
        g[3::4] = [i % 256 for i in range(w * h)]
    write(name, w, [g[y * w * n:(y + 1) * w * n] for y in range(h)], n)
END
texture() {
	python3 "$PRIV/texture.py" "$@"
}
texture grey grey.png
texture rgba rgba.png
texture rgb rgb.png
texture black black.png
texture angle angle.png
inputs='angle.png black.png grey.png rgb.png rgba.png'

check 'the same bytes at any -j and BAKE_ISA'
for model in paper facet blackshot flat; do
	ok rm-roughen -j1 --model $model --angle 70 rgb.png -o one.png
	ok rm-roughen -j7 --model $model --angle 70 rgb.png -o many.png
	same_bytes one.png many.png
	ok env BAKE_ISA=baseline rm-roughen --model $model --angle 70 rgb.png \
	    -o plain.png
	same_bytes one.png plain.png
done
rm one.png many.png plain.png

check 'alpha keeps its bits in every format, also where it is 0'
for format in png tga tiff; do
	ok rm-roughen --angle 60 rgba.png -o out.$format
	ok rm-info --compare out.$format out.$format
	[ "$format" = tga ] || [ "$format" = tiff ] || {
		codes rgba.png 3 >a
		codes out.png 3 >b
		same_bytes a b
		rm a b
	}
	rm out.$format
done
ok rm-roughen --angle 60 --encoded -d float rgba.png -o out.exr
ok rm-roughen --angle 0 --model flat --encoded -d uint8 out.exr -o out.png
codes rgba.png 3 >a
codes out.png 3 >b
same_bytes a b
rm a b out.exr out.png

check 'flat at angle 0 changes nothing'
for f in rgb rgba grey; do
	ok rm-roughen --model flat --angle 0 $f.png -o out.png
	codes $f.png >a
	codes out.png >b
	same_bytes a b
	ok rm-roughen --encoded --model flat --angle 0 $f.png -o out.png
	codes out.png >b
	same_bytes a b
	rm a b out.png
done

check 'flat at 60 degrees halves light: encoded values, or sRGB'
ok rm-roughen --encoded --model flat --angle 60 rgb.png -o enc.png
ok rm-roughen --model flat --angle 60 rgb.png -o lin.png
for f in rgb enc lin; do
	codes $f.png >$f.txt
done
python3 - >"$PRIV/out" <<'END'
def values(name):
    text = "".join(open(name).read().split())
    return [int(text[i:i + 2], 16) for i in range(0, len(text), 2)]


def light(v):
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def code(v):
    return 255 * (12.92 * v if v <= 0.0031308
                  else 1.055 * v ** (1 / 2.4) - 0.055)


worst = [0, 0]
for a, b, c in zip(values("rgb.txt"), values("enc.txt"), values("lin.txt")):
    worst[0] = max(worst[0], abs(a / 2 - b))
    worst[1] = max(worst[1], abs(code(light(a / 255) / 2) - c))
print(worst)
# half a code of rounding; the standard's rounded constants add 0.01
print("good" if worst[0] <= 0.5 and worst[1] <= 0.51 else "bad")
END
stdout_has good
rm enc.png lin.png rgb.txt enc.txt lin.txt

check 'the contrast table is the closed form'
ok rm-roughen --contrast --model facet --encoded --angles 0,10,40,70,80,82 \
    grey.png
cp "$PRIV/out" facet.tsv
ok rm-roughen --contrast --model flat --encoded --angles 0,10,40,70,80,82 \
    grey.png
cp "$PRIV/out" flat.tsv
ok rm-roughen --contrast --model paper --encoded --angles 0,10,40,70,80,82 \
    grey.png
cp "$PRIV/out" paper.tsv
python3 - >"$PRIV/out" <<'END'
import math


def table(name):
    lines = [l.split("\t") for l in open(name).read().splitlines()]
    assert lines[0] == ["angle", "p05", "p50", "p95", "contrast"], lines[0]
    return [[float(v) for v in l] for l in lines[1:]]


flat, facet, paper = (table(n + ".tsv") for n in ("flat", "facet", "paper"))
_, p5, m, p95, c0 = flat[0]
big = 0.09 * math.pi / 2
for f in flat:
    assert abs(f[4] - c0) < 1e-3 and abs(
        f[2] / (m * math.cos(math.radians(f[0]))) - 1) < 0.01, f
for f in facet[:-1]:
    a = math.radians(f[0])
    want = c0 * math.cos(big) + math.sin(big) * math.tan(a) * (p95 + p5) / 2 / m
    # 5 % is asked for
    assert abs(f[4] / want - 1) < 0.01, (f, want)
    assert abs(f[2] / (m * math.cos(a)) - 1) < 0.01, f
for t, times in (facet, 4), (paper, 3):
    assert all(a[4] < b[4] for a, b in zip(t, t[1:])), t
    assert t[-1][4] >= times * t[1][4], t
print("good")
END
stdout_has good
rm flat.tsv facet.tsv paper.tsv

check 'a table gives what the direct result is, by its own three lines'
for model in facet paper flat; do
	ok rm-roughen --model $model --encoded --lut lut.png grey.png
	ok rm-roughen --model $model --encoded --angle 75 grey.png -o out.png
	ok rm-info lut.png
	codes lut.png >lut.txt
	codes grey.png >in.txt
	codes out.png >out.txt
	python3 - >"$PRIV/out" <<'END'
import math, re, struct

data, at, text = open("lut.png", "rb").read(), 8, ""
while at < len(data):
    n, kind = struct.unpack(">I4s", data[at:at + 8])
    if kind == b"tEXt":
        text += data[at + 8:at + 8 + n].decode("latin-1") + ";"
    at += 12 + n
said = dict(re.findall(r"relief:(\w+)=([^;]*)", text))
Median, Low, High = (float(said[k]) for k in ("Median", "Low", "High"))
m, steps, rows, w, h = map(int, re.match(
    r"uv = \(vec2\((\d+) \+ sign\(d\) \* \(1 \+ (\d+) \* \(1 - sqrt\(1 - "
    r"abs\(d\)\)\)\), (\d+) \* sqrt\(0\.5 - 0\.5 \* c\)\) \+ 0\.5\) / "
    r"vec2\((\d+), (\d+)\)$", said["Decode2"]).groups())
assert said["Decode1"] == \
    "d = clamp((t - Median) / (t > Median ? High : Low), -1, 1)", said
assert said["Decode3"] == "rgb *= max(0, 2 * texture(lut, uv).r - 1)", said
assert (w, h) == (64, 64) and said["Layout"] == "roughen-lut", said


def values(name):
    return [int(v, 16) / 65535 for v in open(name).read().split()]


lut, c, worst = values("lut.txt"), math.cos(math.radians(75)), 0


def texture(u, v):
    x, y = u * w - 0.5, v * h - 0.5
    i, j = int(x), int(y)
    fx, fy = x - i, y - j
    at = lambda a, b: lut[min(b, h - 1) * w + min(a, w - 1)]
    return ((1 - fy) * ((1 - fx) * at(i, j) + fx * at(i + 1, j)) +
            fy * ((1 - fx) * at(i, j + 1) + fx * at(i + 1, j + 1)))


for t, want in zip(values("in.txt"), values("out.txt")):
    d = max(-1, min(1, (t - Median) / (High if t > Median else Low)))
    # Median is written with the digits of a float: a texel at it may lie
    # 3e-8 beside
    if abs(t - Median) < 1e-7:
        continue
    sign = (d > 0) - (d < 0)
    u = (m + sign * (1 + steps * (1 - math.sqrt(1 - abs(d)))) + 0.5) / w
    v = (rows * math.sqrt(0.5 - 0.5 * c) + 0.5) / h
    worst = max(worst, abs(t * max(0, 2 * texture(u, v) - 1) - want))
print(worst, "good" if worst < 1 / 255 else "bad")
END
	stdout_has good
	rm lut.png out.png lut.txt in.txt out.txt
done
ok rm-roughen --model facet --lut lut.exr --lut-size 32x16 grey.png
ok rm-info lut.exr
stdout_has '32x16'
rm lut.exr

check 'a coarse table warns'
exits 0 rm-roughen --model paper --strength 0.5 --lut lut.png --lut-size 8x8 \
    grey.png
stderr_one_line 'lut.png: reproduces the remap within'
rm lut.png

check 'maps of one angle are that angle'
for f in rgb rgba grey; do
	for model in facet paper flat; do
		ok rm-roughen --model $model --angle 60 $f.png -o one.png
		ok rm-roughen --model $model --angle-map angle.png $f.png -o map.png
		# 60 degrees as a code is not 60 in the last bit
		ok rm-info --compare one.png map.png --tolerance 1
	done
done
stone=$DATA/stone_depth.png normal=$DATA/stone_normal.png
ok rm-roughen --normal-map "$normal" --light 0,0,9 --model flat "$stone" \
    -o front.png
ok rm-roughen --normal-map "$normal" --light 0,1,1 "$stone" -o up.png
ok rm-roughen --normal-map "$normal" --light 0,-1,1 --normal-y down "$stone" \
    -o down.png
same_result up.png down.png
differ up.png front.png
exits 0 rm-roughen --angle-map "$stone" rgb.png -o out.png
stderr_one_line '256x256 is stretched to 96x64'
rm one.png map.png front.png up.png down.png out.png

check 'a texture remapped by s is fitted with s'
ok rm-roughen --encoded --angle 70 --strength 0.15 grey.png -o ref.png
ok rm-roughen --encoded --fit ref.png --at 70 grey.png
awk -F '\t' 'NR == 2 && $1 == "facet" && $2 > 0.148 && $2 < 0.152 &&
    $3 > 13.3 && $3 < 13.7 && $7 < 0.01 { print "good" }' "$PRIV/out" >fit
[ -s fit ] || bad "$(cat "$PRIV/out")"
exits 0 rm-roughen --encoded --fit grey.png --at 70 ref.png
stderr_one_line 'meets the contrast within'
rm ref.png fit

check 'real reliefs are nearer to facet and paper than to flat'
for s in 0.0125 0.0425; do
	python3 "$top/scripts/make-random-surface" --size 256 surface.png
	ok rm-roughen --fit-depth surface.png --height -s $s --render r.png
	cp "$PRIV/out" fit.tsv
	awk -F '\t' '{ e[$1] = $4 } END {
		if (e["facet"] < 0.4 * e["flat"] && e["paper"] < 0.4 * e["flat"] &&
		    e["facet"] > 0 && e["facet"] < e["paper"])
			print "good"
	}' fit.tsv >"$PRIV/out"
	stdout_has good
	equal "$(wc -l <fit.tsv)" 6 'lines'
	ok rm-roughen --fit-depth surface.png --height -s $s -j1 --render one.png
	same_bytes "$PRIV/out" fit.tsv
	same_bytes r.png one.png
done
ok rm-roughen --fit-depth surface.png --height -s 0.0425 --lut lut.png grey.png
present lut.png
rm surface.png r.png one.png fit.tsv lut.png

check 'the surface generator gives the same bytes'
python3 "$top/scripts/make-random-surface" --size 64 --seed 3 a.png
python3 "$top/scripts/make-random-surface" --size 64 --seed 3 b.png
same_bytes a.png b.png
python3 "$top/scripts/make-random-surface" --size 64 --seed 4 b.png
differ a.png b.png
rm a.png b.png

check 'pictures'
ok rm-roughen --sheet sheet.png --cylinder cylinder.png --plot plot.png rgba.png
ok rm-roughen --plot plot.svg --model paper grey.png
for f in sheet cylinder plot; do
	ok rm-info $f.png
	ok rm-info --compare $f.png $f.png
done
python3 -c 'import sys, xml.dom.minidom as x; x.parse("plot.svg")'
rm sheet.png cylinder.png plot.png plot.svg

check 'many inputs, the depfile, standard streams'
mkdir out
ok rm-roughen --angle 30 -O out -M dep.d rgb.png grey.png
ok rm-roughen --angle 30 grey.png -o grey30.png
same_bytes out/grey.png grey30.png
grep -q 'rgb.png' dep.d || bad 'dep.d lacks an input'
ok sh -c 'rm-roughen --angle 30 --format png - -o - <grey.png >pipe.png'
same_bytes pipe.png grey30.png
cp grey.png self.png
ok rm-roughen --angle 30 self.png -o self.png
same_bytes self.png grey30.png
rm -r out dep.d grey30.png pipe.png self.png

check 'light beyond the horizon leaves nothing, and no model a NaN'
for model in flat paper facet blackshot; do
	ok rm-roughen --model $model --angle 180 rgb.png -o dark.png
	codes dark.png | grep -qv '^[0 ]*$' && bad "$model is lit at 180 degrees"
	rm dark.png
	ok rm-roughen --model $model --angle 90 --median 0.01 -d float \
	    --encoded rgb.png -o out.tiff
	rm out.tiff
done

check 'float values beyond 1 are kept, and clipped ones counted'
python3 - <<'END'
import struct
open("bright.pfm", "wb").write(b"Pf\n4 1\n-1.0\n" +
                               struct.pack("<4f", 0.25, 0.5, 1.5, 3))
END
ok rm-roughen --encoded --angle 60 --model flat bright.pfm -o half.exr
# 0.125, 0.25, 0.75 and 1.5
equal "$(codes half.exr | tr '\n' ' ')" \
    '3e000000 3e800000 3f400000 3fc00000 ' 'half of it'
exits 0 rm-roughen --encoded --angle 60 --model flat bright.pfm -d uint8 \
    -o half.png
stderr_one_line '1 values outside 0 to 1 were clipped'
ok rm-roughen --angle 60 --model flat bright.pfm -o light.exr
same_result light.exr half.exr
rm bright.pfm half.exr half.png light.exr

check 'wrong usage'
wrong rm-roughen
wrong rm-roughen rgb.png
wrong rm-roughen rgb.png -o out.png
wrong rm-roughen --angle 30 rgb.png
wrong rm-roughen --angle 181 rgb.png -o out.png
wrong rm-roughen --angle -1 rgb.png -o out.png
wrong rm-roughen --angle nan rgb.png -o out.png
wrong rm-roughen --angle 30 --angle-map grey.png rgb.png -o out.png
wrong rm-roughen --angle 30 --normal-map grey.png --light 0,0,1 rgb.png -o out.png
wrong rm-roughen --normal-map grey.png rgb.png -o out.png
wrong rm-roughen --angle 30 --light 0,0,1 rgb.png -o out.png
wrong rm-roughen --normal-map grey.png --light 0,0,0 rgb.png -o out.png
wrong rm-roughen --normal-map grey.png --light 0,1 rgb.png -o out.png
wrong rm-roughen --angle 30 --angle-unit degrees rgb.png -o out.png
wrong rm-roughen --angle 30 --model rough rgb.png -o out.png
wrong rm-roughen --angle 30 --strength 1.1 rgb.png -o out.png
wrong rm-roughen --angle 30 --strength -0.1 rgb.png -o out.png
wrong rm-roughen --angle 30 --median 0 rgb.png -o out.png
wrong rm-roughen --angle 30 --median some rgb.png -o out.png
wrong rm-roughen --angle 30 --luma 1,2 rgb.png -o out.png
wrong rm-roughen --angle 30 --luma 0,0,0 rgb.png -o out.png
wrong rm-roughen --angle 30 rgb.png grey.png -o out.png
wrong rm-roughen --contrast rgb.png grey.png
wrong rm-roughen --contrast
wrong rm-roughen --contrast --angles 10,90 rgb.png
wrong rm-roughen --contrast --angles , rgb.png
wrong rm-roughen --contrast --angle 30 rgb.png -o -
wrong rm-roughen --fit grey.png rgb.png
wrong rm-roughen --fit grey.png --at 90 rgb.png
wrong rm-roughen --at 30 rgb.png
wrong rm-roughen --fit grey.png --at 30 --strength 0.1 rgb.png
wrong rm-roughen --fit grey.png --at 30 --model flat rgb.png
wrong rm-roughen --fit grey.png --at 30 --fit-depth grey.png rgb.png
wrong rm-roughen --contrast --fit grey.png --at 30 rgb.png
wrong rm-roughen --render out.png --contrast rgb.png
wrong rm-roughen --contrast -s 0.1 rgb.png
wrong rm-roughen --lut out.png --model blackshot rgb.png
stderr_has 'blackshot'
wrong rm-roughen --lut out.png --lut-size 7x64 rgb.png
wrong rm-roughen --lut-size 64x64 --contrast rgb.png
wrong rm-roughen --encoded --color-space sRGB --contrast rgb.png

check 'files that cannot be used'
fails 'no such.png' rm-roughen --angle 30 'no such.png' -o out.png
fails 'median luminance is 0' rm-roughen --angle 30 black.png -o out.png
fails 'median luminance is 0' rm-roughen --model paper --lut out.png black.png
fails 'median luminance is 0' rm-roughen --model flat --contrast black.png
fails 'black.png' rm-roughen --fit black.png --at 40 rgb.png
fails 'no such.png' rm-roughen --fit 'no such.png' --at 40 rgb.png
fails 'no such.png' rm-roughen --fit-depth 'no such.png' rgb.png
fails 'no such.png' rm-roughen --angle-map 'no such.png' rgb.png -o out.png
fails 'black.png: has 1 channel' rm-roughen --normal-map black.png \
    --light 0,0,1 rgb.png -o out.png
fails 'no colour space' rm-roughen --color-space nowhere --angle 3 rgb.png \
    -o out.png
fails 'lut.dat' rm-roughen --lut lut.dat rgb.png
fails 'sheet.dat' rm-roughen --sheet sheet.dat rgb.png
fails 'plot.dat' rm-roughen --plot plot.dat rgb.png
fails 'nowhere' rm-roughen --plot nowhere/plot.svg rgb.png
head -c 2000 rgb.png >short.png
fails 'short.png' rm-roughen --angle 30 short.png -o out.png
rm short.png
ok rm-roughen --model flat --angle 30 black.png -o out.png
rm out.png
# shellcheck disable=SC2086 # a list of names
no_litter $inputs
