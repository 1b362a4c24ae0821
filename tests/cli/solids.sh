# The generators of meshes for multilayer relief: closed, outward, periodic.
# SPDX-License-Identifier: MIT
. "$LIB"
need python3
make_solid=$top/scripts/make-solid

cat >"$PRIV/solid.py" <<'PY'
import math, sys


def read(path):
    v, vt, vn, faces = [], [], [], []
    for line in open(path):
        word, *rest = line.split()
        if word == "v":
            v.append(tuple(map(float, rest[:3])))
            assert len(rest) == 6 and all(0 <= float(c) <= 1 for c in rest[3:])
        elif word == "vt":
            vt.append(tuple(map(float, rest)))
        elif word == "vn":
            vn.append(tuple(map(float, rest)))
        elif word == "f":
            face = [tuple(int(i) - 1 for i in c.split("/")) for c in rest]
            assert len(face) == 3
            for c in face:
                assert 0 <= c[0] < len(v) and 0 <= c[1] < len(vt)
                assert 0 <= c[2] < len(vn)
            faces.append(face)
    return v, vt, vn, faces


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0]]


def parts(faces, nv):
    """The faces of each connected part."""
    root = list(range(nv))

    def find(i):
        while root[i] != i:
            root[i] = root[root[i]]
            i = root[i]
        return i

    for f in faces:
        for c in f[1:]:
            root[find(c[0])] = find(f[0][0])
    out = {}
    for f in faces:
        out.setdefault(find(f[0][0]), []).append(f)
    return list(out.values())


def check_closed(v, vt, vn, faces):
    """Each edge twice, in opposite directions; normals outward, unit."""
    edges = set()
    for f in faces:
        p = [v[c[0]] for c in f]
        n = cross(sub(p[1], p[0]), sub(p[2], p[0]))
        assert dot(n, n) > 0, "a triangle without area"
        for k in range(3):
            e = (f[k][0], f[(k + 1) % 3][0])
            assert e not in edges, "an edge is there twice"
            edges.add(e)
            assert dot(vn[f[k][2]], n) > 0, "a normal looks inwards"
    for a, b in edges:
        assert (b, a) in edges, "an edge has one triangle"
    for n in vn:
        # 9 decimals
        assert abs(dot(n, n) - 1) < 4e-9
    assert len(set(v)) == len(v), "two vertices in one place"
    assert {i for f in faces for i in (c[0] for c in f)} == set(range(len(v)))


def volume(v, faces):
    return sum(dot(v[f[0][0]], cross(v[f[1][0]], v[f[2][0]]))
               for f in faces) / 6


def genus(faces):
    nv = len({c[0] for f in faces for c in f})
    return (2 - (nv - len(faces) // 2)) // 2


CELLS = 32
cells = {}


def cell_of(x):
    return math.floor(x * CELLS)


def fill_cells(v, faces):
    """The triangles over each cell of x and y."""
    for f in faces:
        p = [v[c[0]] for c in f]
        lo, hi = ([cell_of(m(q[k] for q in p)) for k in (0, 1)]
                  for m in (min, max))
        for i in range(lo[0], hi[0] + 1):
            for j in range(lo[1], hi[1] + 1):
                cells.setdefault((i, j), []).append(p)


def layers(x, y, tile_x, tile_y):
    """(z, winding change) along the line through (x, y), from above."""
    if not cells:
        fill_cells(v, faces)
    out = []
    for ox in (-1, 0, 1) if tile_x else (0,):
        for oy in (-1, 0, 1) if tile_y else (0,):
            for p in cells.get((cell_of(x + ox), cell_of(y + oy)), []):
                q = [(a[0] - x - ox, a[1] - y - oy) for a in p]
                e = [q[k - 2][0] * q[k - 1][1] - q[k - 2][1] * q[k - 1][0]
                     for k in range(3)]
                if min(e) > 0 or max(e) < 0:
                    z = sum(w * a[2] for w, a in zip(e, p)) / sum(e)
                    out.append((z, 1 if e[0] > 0 else -1))
    return sorted(out, reverse=True)


def slabs(crossings):
    """What of them are changes between outside and inside."""
    out, w = [], 0
    for z, change in crossings:
        if w == 0 or w + change == 0:
            out.append(z)
        w += change
    assert w == 0
    return out


v, vt, vn, faces = read(sys.argv[1])
exec(sys.stdin.read())
PY

solid() {
	cat >"$PRIV/what.py"
	python3 -B "$PRIV/solid.py" "$1" <"$PRIV/what.py" >"$PRIV/py" 2>&1 || {
		bad "python says of $1:"
		sed 's/^/    | /' "$PRIV/py"
	}
}

check 'each is closed, outward and manifold, at any size'
for args in weave 'weave --count 2 --rings 3 --segments 3 --radius 0.49' \
    'weave --count 6 --flat 1 --radius 0.3 --rings 6' helix \
    'helix --count 3 --rungs 5 --rings 12 --segments 5' 'helix --rungs 0' \
    chain 'chain --count 6 --rings 9 --segments 7 --radius 0.2'; do
	# shellcheck disable=SC2086 # several arguments
	ok "$make_solid" $args -o a.obj
	solid a.obj <<'PY'
check_closed(v, vt, vn, faces)
for part in parts(faces, len(v)):
    assert volume(v, part) > 0
    assert genus(part) == (1 if "chain" in open(sys.argv[1]).readline() else 0)
PY
done

check 'a weave has its strands, over and under in turns, and no seam'
ok "$make_solid" weave --count 4 --rings 12 --segments 16 -o a.obj
solid a.obj <<'PY'
# half the height of a strand, and half the distance of two
b = 0.5 * 0.34 / 4
high = (max(p[2] for p in v) - b)
assert 1.05 * b < high < 1.6 * b
assert len(parts(faces, len(v))) == 8
for i in range(4):
    for j in range(4):
        # a hair beside the middle, where no edge is
        z = slabs(layers((i + .501) / 4, (j + .501) / 4, True, True))
        want = [high + b, high - b, b - high, -b - high]
        # 16 edges round lose 1 - cos(pi / 16) = 2 % of b
        assert len(z) == 4 and all(abs(g - w) < 0.03 * b
                                   for g, w in zip(z, want)), (z, want)
        # beside the middle the strands bend, and stay apart
        for x in (0.37, 0.43, 0.57, 0.63):
            for y in (0.371, 0.631):
                z = layers((i + x) / 4, (j + y) / 4, True, True)
                assert len(z) == 4 and len(slabs(z)) == 4, z
        # the hole between four strands
        assert not layers((i + .999) / 4, (j + .999) / 4, True, True)
# nothing of the ends is seen: two layers all along a strand, at the same height
# as half a period further, but for the sign
for k in range(-4, 5):
    z = slabs(layers(k * 0.0037 + 0.0011, 0.1261, True, True))
    y = slabs(layers(k * 0.0037 + 0.5011, 0.1261, True, True))
    assert len(z) == 2 and len(y) == 2, (k, z, y)
    # coordinates have 9 decimals
    assert all(abs(p - q) < 1e-7 for p, q in zip(z, y)), (k, z, y)
# vertex on vertex: what is beyond the period is its copy
places = {tuple(round(c, 9) for c in p) for p in v}
for axis in (0, 1):
    out = [p for p in v if p[axis] > 1]
    alone = 0
    for p in out:
        q = list(p)
        q[axis] = round(q[axis] - 1, 9)
        alone += tuple(q) not in places
    # the middles of the caps
    assert len(out) > 4 * 16 and alone == 4, (len(out), alone)
PY

check 'a helix has two strands that go round each other, joined by rungs'
ok "$make_solid" helix --rungs 4 --segments 16 -o a.obj
solid a.obj <<'PY'
assert len(parts(faces, len(v))) == 6
r, wide = 0.08, 0.34


def strand(w, half):
    a = 2 * math.pi * (w + half)
    return (0.5 + wide * math.cos(a), w, wide * math.sin(a))


def far(p, half):
    """The distance of a point from the middle of a strand."""
    d = [math.dist(p, strand(p[1] + k / 4096, half))
         for k in range(-1024, 1025)]
    return min(d)


def far_from_rung(p, i):
    w = (i + 0.5) / 4
    a = unit_of(sub(strand(w, 0.5), strand(w, 0)))
    d = sub(p, (0.5, w, 0))
    return math.sqrt(max(0, dot(d, d) - dot(d, a) ** 2))


def unit_of(a):
    return [c / math.sqrt(dot(a, a)) for c in a]


thin = 0.4 * r
hits = rungs = 0
for i in range(12):
    for j in range(12):
        x, y = (i + 0.47) / 12, (j + 0.51) / 12
        for z in slabs(layers(x, y, False, True)):
            d = min(far((x, y, z), 0), far((x, y, z), 0.5))
            g = min(far_from_rung((x, y, z), k) for k in range(-1, 5))
            # 16 edges round lose up to 2 %; 96 a turn shift by 1.8e-4, that
            # is 0.23 % of r
            assert (0.97 * r < d < 1.003 * r or
                    0.97 * thin < g < 1.003 * thin), (x, y, z, d, g)
            hits += 1
            rungs += d > 1.003 * r
assert hits > 100 and rungs > 5, (hits, rungs)
# tiling closes the ends
assert len(slabs(layers(0.5 + wide, 0.0013, False, True))) == 2
PY

check 'the links of a chain go through each other and do not touch'
ok "$make_solid" chain --count 4 -o a.obj
solid a.obj <<'PY'
links = parts(faces, len(v))
assert len(links) == 4
links.sort(key=lambda f: min(v[c[0]][0] for t in f for c in t))
pitch, r = 1 / 4, 0.14 / 4
big = (1.04 * pitch + 2 * r) / 2
for i in range(4):
    p = [v[c[0]] for t in links[i] for c in t]
    x = (min(q[0] for q in p), max(q[0] for q in p))
    assert abs(x[0] - ((i + .5) * pitch - big - r)) < 1e-8
    assert abs(x[1] - ((i + .5) * pitch + big + r)) < 1e-8
    # in planes at half of a right angle, in turns
    c = (-1 if i % 2 == 0 else 1) * math.sqrt(0.5)
    off = [(q[1] - 0.5) * c + q[2] * abs(c) for q in p]
    assert abs(max(off) - r) < 1e-8 and abs(min(off) + r) < 1e-8
    # the next one's nearer end is within this one's hole, and free of it
    assert (pitch - big) + r < big - r and (pitch - big) - r > -(big - r)
# through the end of one, which lies in the hole of the one before
z = layers(1.5 * pitch - big + 1e-4, 0.5001, True, False)
assert len(z) == 2 and abs(z[0][0] + z[1][0]) < 0.1 * r
PY

check 'the same bytes twice, on standard output too'
for kind in weave helix chain; do
	ok "$make_solid" $kind --rings 12 --segments 8 -o a.obj
	ok "$make_solid" $kind --rings 12 --segments 8
	same_bytes a.obj "$PRIV/out"
done
no_litter a.obj

check 'wrong arguments'
for args in '' knot 'weave --count 3' 'chain --count 1' 'weave --count 0' \
    'weave --radius 0.5' 'weave --radius nan' 'helix --rungs -1' \
    'chain --segments 2' 'weave --flat 0'; do
	# shellcheck disable=SC2086 # several arguments
	exits 2 "$make_solid" $args -o bad.obj
done
absent bad.obj

check 'the tools read them'
if command -v rm-quadfit >/dev/null; then
	for kind in weave helix chain; do
		ok "$make_solid" $kind --rings 12 --segments 8 -o a.obj
		ok rm-quadfit --order 2 -o a.tsv a.obj
	done
else
	skip 'rm-quadfit is not there'
fi
