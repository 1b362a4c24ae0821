# AO after rescaling: Eq. 6 in its channel, and nothing else in any other.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-rescale-ao rm-combine rm-aobake rm-pack rm-info python3

# is_eq6 FROM TO BITS S CHANNEL WHAT: the channel of TO is that of FROM (one
# channel), each code by the formula in rationals; where that lies on the border
# between two codes but for the rounding of two floats, either of them
is_eq6() {
	codes "$1" >"$PRIV/from"
	codes "$2" "$5" | paste -d ' ' "$PRIV/from" - | python3 -c '
import sys
from fractions import Fraction as F
top, s = (1 << int(sys.argv[1])) - 1, F(sys.argv[2])
slack = F(top, 1 << 25) * (1 + (max(s * s, 1 / (s * s)) if s else 1))
for line in sys.stdin:
    v, got = (int(code, 16) for code in line.split())
    v = F(v, top)
    d = s * s * (1 - v) + v
    if abs((v / d if d else 1) * top - got) > F(1, 2) + slack:
        sys.exit(1)' "$3" "$4" || bad "$6 is not that of Eq. 6"
}

for bits in 8 16; do
	for kind in normal depth; do
		test_map $kind $bits 61x38 "${bits}_$kind.png"
	done
	test_map random $bits 61x38 "${bits}_ao.png"
done

check 'an AO map: each code is that of Eq. 6'
for bits in 8 16; do
	for s in 0 0.5 1 2.5; do
		ok rm-rescale-ao --scale $s "${bits}_ao.png" -o out.png
		is_eq6 "${bits}_ao.png" out.png "$bits" "$s" 0 \
		    "$bits bits, S = $s: a code"
	done
done

# keeps FILE OUT: R, G and A of both are the same, and B is not
keeps() {
	for c in 0 1 3; do
		codes "$1" $c >want
		codes "$2" $c >got
		cmp -s want got || bad "$2: channel $c changed"
	done
	codes "$1" 2 >want
	codes "$2" 2 >got
	! cmp -s want got || bad "$2: B did not change"
}

for to in '8 png uint8' '16 png uint16' '8 tga uint8' '8 tiff uint8' \
    '16 tiff uint16' '8 exr half' '16 exr float'; do
	# shellcheck disable=SC2086 # three words
	set -- $to
	check "a packed $2 of $3: R, G and A keep their bits"
	ok rm-pack -q --normal "$1_normal.png" --depth "$1_depth.png" \
	    --ao "$1_ao.png" -s 0.1 -d "$3" -o "in.$2"
	ok rm-rescale-ao --scale 2 "in.$2" -o "out.$2"
	keeps "in.$2" "out.$2"
	ok rm-info --json "out.$2"
	equal "$(json data_format)" "$3" 'data format'
	equal "$(json layout)" relief layout

	check "a packed $2 of $3: in its place gives the same file"
	cp "in.$2" "same.$2"
	ok rm-rescale-ao --scale 2 "same.$2" -o "same.$2"
	same_bytes "out.$2" "same.$2"

	check "a packed $2 of $3: metadata say what belongs to which scale"
	grep -aq 'AOScale' "out.$2" || bad 'AOScale is missing'
	ok rm-info --json "out.$2"
	equal "$(json declared.depth_scale)" 0.1 'DepthScale, the normals'
	# back to where the normals are: nothing is left to be said
	ok rm-rescale-ao --to 0.1 "out.$2" -o "back.$2"
	! grep -aq 'AOScale' "back.$2" || bad 'AOScale is still there'
	# the next one starts from the AO's scale: 0.2 to 0.2 is none
	ok rm-rescale-ao --to 0.2 "out.$2" -o "again.$2"
	same_result "out.$2" "again.$2"
	rm -f same.* back.* again.*
done

check 'what is no number is kept in other channels, repaired in the AO'
if command -v oiiotool >/dev/null; then
	# uncompressed, so that texels can be patched: rows of A, B, G, R
	oiiotool in.exr --compression none -o nan.exr
	python3 - <<'END'
data = bytearray(open("nan.exr", "rb").read())
data[-4:] = b"\x45\x23\xc1\x7f"             # R of the last texel: NaN
data[-4 * 61 * 4:-4 * 61 * 4 + 4] = b"\0\0\x80\xff"        # -Inf
data[-4 * 61 * 3:-4 * 61 * 3 + 4] = b"\0\0\xc0\x7f"        # B: NaN
open("nan.exr", "wb").write(data)
END
	exits 0 rm-rescale-ao --scale 2 nan.exr -o out.exr
	stderr_one_line 'nan.exr: 1 texels of AO are not numbers'
	equal "$(codes out.exr 0 | tail -n 1)" 7fc12345 'R'
	equal "$(codes out.exr 3 | tail -n 61 | head -n 1)" ff800000 'A'
	codes out.exr 2 | grep -q '^7f[89a-f]' && bad 'B has a NaN'
else
	skip 'oiiotool is not there'
fi

check 'telling names of channels are kept, and put in order elsewhere'
ok rm-pack -q --normal 16_normal.png --depth 16_depth.png --ao 16_ao.png \
    --exr-names -d float -o named.exr
ok rm-rescale-ao --scale 2 named.exr -o renamed.exr
grep -aq normal.x renamed.exr || bad 'the channels lost their names'
ok rm-rescale-ao --scale 2 --from 0.1 named.exr -d uint16 -o renamed.png
ok rm-pack -q --normal 16_normal.png --depth 16_depth.png --ao 16_ao.png \
    -o in.png
keeps in.png renamed.png

check 'AO in R of an ORM texture, in G of a mask map'
for target in gltf:_orm:0 unity-hdrp:_mask:1; do
	name=${target%%:*} rest=${target#*:}
	ok rm-pack -q --target "$name" --normal 8_normal.png \
	    --depth 8_depth.png --ao 8_ao.png -s 0.1 -o t.png
	ok rm-rescale-ao --to 0.3 "t${rest%:*}.png" -o o.png
	is_eq6 8_ao.png o.png 8 3 "${rest#*:}" "$name: the AO"
	# the channels beside it are constants of the target
	for c in 0 1 2; do
		[ $c = "${rest#*:}" ] || {
			codes "t${rest%:*}.png" $c >want
			codes o.png $c >got
			cmp -s want got || bad "$name: channel $c changed"
		}
	done
	rm -f t*.png
done

check 'an AO map as a grey RGB picture stays grey'
ok rm-pack -q --target gltf --normal 8_normal.png --depth 8_depth.png \
    --ao 8_ao.png -o t.png
if command -v oiiotool >/dev/null; then
	oiiotool 8_ao.png --ch 0,0,0 --chnames R,G,B -o grey.png
	ok rm-rescale-ao --scale 2 grey.png -o out.png
	ok rm-rescale-ao --scale 2 8_ao.png -o one.png
	codes one.png >want
	for c in 0 1 2; do
		codes out.png $c >got
		same_bytes want got
	done
	# the noise of a conversion: one code in one channel
	oiiotool grey.png --box:color=0.5,0.5,0.503922:fill=1 5,5,9,9 \
	    -d uint8 -o noisy.png
	exits 0 rm-rescale-ao --scale 2 noisy.png -o out.png
	stderr_one_line 'noisy.png: is grey but for 25 texels; R is taken'
else
	skip 'oiiotool is not there'
fi
rm -f t.png t_*.png

check 'there by 2 in floats and back: 16-bit codes return'
ok rm-rescale-ao --scale 2 16_ao.png -d float -o f.exr
ok rm-rescale-ao --scale 0.5 f.exr -d uint16 -o back.png
codes 16_ao.png >want
codes back.png >got
same_bytes want got

# -- horizons ---------------------------------------------------------------

check 'horizons give what rm-aobake gives at the other scale'
ok rm-aobake -s 0.1 "$DATA/stone_depth.png" -d float -o ao.exr \
    --horizons h.exr
for b in 0.05 0.3; do
	ok rm-aobake -s $b "$DATA/stone_depth.png" -d float -o want.exr
	ok rm-rescale-ao --to $b --horizons h.exr ao.exr -o got.exr
	# roundings of floats, see t_ao_rescale.c
	ok rm-info --compare want.exr got.exr --tolerance 2e-6
done
ok rm-aobake -s 0.3 --no-blur --estimator mean "$DATA/stone_depth.png" \
    -d float -o want.exr
ok rm-rescale-ao --to 0.3 --no-blur --estimator mean --horizons h.exr ao.exr \
    -o got.exr
ok rm-info --compare want.exr got.exr --tolerance 2e-6
ok rm-rescale-ao --scale 3 --no-blur --estimator mean --horizons h.exr ao.exr \
    -o scale.exr
ok rm-info --compare want.exr scale.exr --tolerance 2e-6

check 'horizons in a packed texture: R, G and A keep their bits'
ok rm-pack -q --depth "$DATA/stone_depth.png" -s 0.1 -o in.png
ok rm-rescale-ao --to 0.3 --horizons h.exr in.png -o out.png
keeps in.png out.png

check 'the comparison: Eq. 6 is too dark at 0.3, horizons are exact'
ok rm-rescale-ao --to 0.3 ao.exr --compare "$DATA/stone_depth.png" \
    --error-out e.exr
stdout_has '^ao.exr: depth scale 0.3: mean error 0\.[01][0-9]*, .*bias -0'
present e.exr
ok rm-rescale-ao --to 0.3 ao.exr --horizons h.exr \
    --compare "$DATA/stone_depth.png"
stdout_has 'mean error 0.0000, 99 % within 0.0000, largest 0.0000'

check 'threads change no byte'
ok rm-rescale-ao -j 1 --to 0.3 --horizons h.exr in.png -o one.png
ok rm-rescale-ao -j 5 --to 0.3 --horizons h.exr in.png -o many.png
same_bytes one.png many.png
ok rm-rescale-ao -j 1 --to 0.3 in.png -o one.png
ok rm-rescale-ao -j 5 --to 0.3 in.png -o many.png
same_bytes one.png many.png

# -- files ------------------------------------------------------------------

check 'many inputs, a depfile, standard output'
mkdir dir
ok rm-rescale-ao --scale 2 8_ao.png 16_ao.png -O dir -M d.mk
present dir/8_ao.png dir/16_ao.png
tr -d '\\\n' <d.mk | grep -q \
    '^dir/8_ao.png dir/16_ao.png:  *8_ao.png  *16_ao.png' ||
	bad "the depfile is '$(cat d.mk)'"
ok rm-rescale-ao --scale 2 8_ao.png -o - --format png
same_bytes "$PRIV/out" dir/8_ao.png
rm -r dir d.mk

check 'a texture without metadata is read as packed, with a warning'
cp in.png bare.png
python3 - <<'END'
import struct
data, out, at = open("in.png", "rb").read(), b"", 8
out = data[:8]
while at < len(data):
    n, kind = struct.unpack(">I4s", data[at:at + 8])
    if kind not in (b"tEXt", b"iTXt", b"zTXt"):
        out += data[at:at + 12 + n]
    at += 12 + n
open("bare.png", "wb").write(out)
END
exits 0 rm-rescale-ao --scale 2 bare.png -o out.png
stderr_one_line 'bare.png: read as a packed texture, with the AO in B'
keeps bare.png out.png

rm -f ./*
check 'what holds no AO is refused, with the way out; nothing is written'
for kind in normal depth random; do
	test_map $kind 8 61x38 $kind.png
done
ok rm-aobake depth.png -o ao.png --bent-normal bent.png --horizons h.exr
ok rm-pack -q --target quake3 --normal normal.png --depth depth.png \
    -o q.png
rm depth.png
test_map depth 8 61x38 depth.png
ok rm-pack --unpack q.png --depth-out relief.png
exits 1 rm-rescale-ao --scale 2 normal.png -o out.png
stderr_one_line 'normal.png: is a normal map'
exits 1 rm-rescale-ao --scale 2 bent.png -o out.png
stderr_one_line 'rm-aobake -s S --bent-normal'
exits 1 rm-rescale-ao --scale 2 h.exr -o out.exr
stderr_one_line 'give it as --horizons'
exits 1 rm-rescale-ao --scale 2 q.png -o out.png
stderr_one_line 'no AO'
exits 1 rm-rescale-ao --scale 2 relief.png -o out.png
stderr_one_line 'rm-aobake -s S bakes its AO'
exits 1 rm-rescale-ao --scale 2 --channel Q ao.png -o out.png
stderr_one_line 'has no channel Q'
exits 1 rm-rescale-ao --scale 2 missing.png -o out.png
stderr_one_line 'missing.png: '
exits 1 rm-rescale-ao --to 2 random.png -o out.png
stderr_is 'rm-rescale-ao: random.png: does not say which depth scale its AO belongs to; give --from A'
exits 1 rm-rescale-ao --to 0.2 --horizons ao.png ao.png -o out.png
stderr_one_line 'holds no horizons'
test_map random 8 60x38 other.png
exits 1 rm-rescale-ao --to 0.2 --horizons h.exr other.png -o out.png
stderr_one_line 'h.exr: is 61x38, expected 60x38 as other.png'
exits 1 rm-rescale-ao --to 0.2 --compare other.png ao.png
stderr_one_line 'ao.png: AO of 61x38 texels against 60x38'
absent out.png out.exr

check 'the scale of the AO travels through the other tools'
ok rm-pack -q --depth depth.png -s 0.1 -d uint16 -o scaled.png
ok rm-aobake -q -n12 --no-blur -s 0.2 --in-place-channel B scaled.png
ok rm-info scaled.png
stdout_has 'declared: 0.1)'
stdout_has 'ao scale *0.2 '
ok rm-info --json scaled.png
stdout_has '"ao_scale": *0.2'
ok rm-pack -q --unpack scaled.png --ao-out scaled_ao.png \
    --normal-out scaled_n.png --depth-out scaled_d.png
grep -aq 'DepthScale=0.2' scaled_ao.png || bad 'the AO lost its scale'
grep -aq 'DepthScale=0.1' scaled_n.png || bad 'the normals lost theirs'
ok rm-pack -q --normal scaled_n.png --depth scaled_d.png --ao scaled_ao.png \
    -o scaled2.png
ok rm-info --compare scaled.png scaled2.png
grep -aq 'AOScale=0.2' scaled2.png || bad 'AOScale is missing'
# alone, at its own scale: Eq. 6 brings the AO from 0.2 back to 0.1
ok rm-combine -q --ao-rescale scaled.png -o combined.exr -d float
ok rm-rescale-ao -q --to 0.1 scaled.png -o back.exr -d float
ok rm-info --compare combined.exr back.exr
rm -f scaled.png scaled_ao.png scaled_n.png scaled_d.png scaled2.png \
    combined.exr back.exr

check 'the old file stays where a run fails'
cp ao.png keep.png
exits 1 rm-rescale-ao --scale 2 normal.png -o ao.png
same_bytes ao.png keep.png

check 'wrong usage'
for bad in '' '--scale 2 --to 3' '--scale two' '--scale -1' '--scale nan' \
    '--to 1e7' '--from 0 --to 1' '--scale 2 --blur 1' \
    '--scale 2 --error-out e.png' '--scale 2 --channel' '--frob' \
    '--scale 2 -O .'; do
	# shellcheck disable=SC2086 # words
	exits 2 rm-rescale-ao $bad ao.png -o out.png
	stderr_has '^usage: rm-rescale-ao '
done
exits 2 rm-rescale-ao --scale 2
exits 2 rm-rescale-ao --scale 2 ao.png
exits 2 rm-rescale-ao --scale 2 ao.png normal.png -o out.png
exits 2 rm-rescale-ao --scale 2 --compare depth.png ao.png -o - --format png
exits 2 rm-rescale-ao --scale 2 --compare depth.png ao.png ao.png
absent out.png e.png
no_litter ao.png bent.png depth.png h.exr keep.png normal.png other.png q.png \
    random.png relief.png
