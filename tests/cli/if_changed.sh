# --if-changed: what is up to date is left alone, whatever its time and folder.
# SPDX-License-Identifier: MIT
. "$LIB"
need python3 cmp

long_ago=200001010000

# A bake with --if-changed and -v: its messages are in $PRIV/err.
again() {
	"$@" --if-changed -v >"$PRIV/out" 2>"$PRIV/err" </dev/null ||
		bad "'$*' --if-changed exits $?"
}

# skips OUT... -- COMMAND...: every output keeps its bytes and is new.
skips() {
	outs=
	while [ "$1" != -- ]; do
		outs="$outs $1"
		shift
	done
	shift
	for out in $outs; do
		cp "$out" "$PRIV/keep.$(basename "$out")"
		touch -t $long_ago "$out"
	done
	again "$@"
	stderr_has 'up to date'
	for out in $outs; do
		same_bytes "$out" "$PRIV/keep.$(basename "$out")"
		[ -z "$(find "$out" -newermt 2000-01-02)" ] &&
			bad "$out has its old time"
	done
	:
}

# bakes COMMAND...: it is made anew, not skipped.
bakes() {
	again "$@"
	! grep -q 'up to date' "$PRIV/err" || bad "'$*' was skipped"
}

# small ones, for there are many runs
test_map depth 16 32x32 stone.png
test_map plane 16 32x32 cushion.png
test_map normal 8 32x32 normal.png
test_map normal 8 16x16 normal3.png
cp "$DATA/torus.obj" torus.obj

for type in png tga tiff exr; do
	check "$type: rm-aobake skips what is as it would be"
	ok rm-aobake -q -n8 stone.png -o "ao.$type"
	skips "ao.$type" -- rm-aobake -q -n8 stone.png -o "ao.$type"

	check "$type: the option changes no byte"
	ok rm-aobake -q --if-changed -n8 stone.png -o "other.$type"
	same_bytes "ao.$type" "other.$type"

	check "$type: another input, option or tool is no match"
	bakes rm-aobake -q -n8 cushion.png -o "other.$type"
	differ "ao.$type" "other.$type"
	bakes rm-aobake -q -n9 stone.png -o "other.$type"
	skips "other.$type" -- rm-aobake -q -n9 stone.png -o "other.$type"
	bakes rm-aobake -q -n8 stone.png -o "other.$type"
	same_bytes "ao.$type" "other.$type"

	check "$type: a damaged or a cut output is made anew"
	python3 - "other.$type" <<-'P'
	import sys
	data = bytearray(open(sys.argv[1], "rb").read())
	data[len(data) // 2] ^= 1
	open(sys.argv[1], "wb").write(data)
	P
	bakes rm-aobake -q -n8 stone.png -o "other.$type"
	same_bytes "ao.$type" "other.$type"
	head -c $(($(wc -c <"ao.$type") / 2)) "ao.$type" >"other.$type"
	bakes rm-aobake -q -n8 stone.png -o "other.$type"
	same_bytes "ao.$type" "other.$type"
	: >"other.$type"
	bakes rm-aobake -q -n8 stone.png -o "other.$type"
	same_bytes "ao.$type" "other.$type"

	check "$type: standard input and output make the same bytes"
	rm-aobake -q -n8 -o - --format "$type" - <stone.png >piped
	same_bytes "ao.$type" piped

	for tool in rm-pack rm-combine rm-rescale-ao rm-roughen rm-render; do
		check "$type: $tool skips, and sees another option"
		case $tool in
		rm-pack) set -- rm-pack -q --ao none --normal normal.png \
			--depth stone.png -o "$tool.$type" ;;
		rm-combine) set -- rm-combine -q "rm-pack.$type" -t 2 \
			"rm-pack.$type" -o "$tool.$type" ;;
		rm-rescale-ao) set -- rm-rescale-ao -q --scale 0.5 "ao.$type" \
			-o "$tool.$type" ;;
		rm-roughen) set -- rm-roughen -q --angle 30 stone.png \
			-o "$tool.$type" ;;
		*) set -- rm-render -q --size 32x24 --relief "rm-pack.$type" \
			-o "$tool.$type" ;;
		esac
		ok "$@"
		skips "$tool.$type" -- "$@"
		[ "$type" = png ] || continue
		cp "$tool.$type" "was.$type"
		case $tool in
		rm-pack) bakes "$@" --renormalize ;;
		rm-combine) bakes "$@" --repeat 1 ;;
		rm-rescale-ao) bakes "$@" --channel R ;;
		rm-roughen) bakes "$@" --strength 0.2 ;;
		*) bakes "$@" --ambient 0.5 ;;
		esac
		bakes "$@"
		same_bytes "$tool.$type" "was.$type"
	done

	check "$type: rm-multilayer's set is skipped as one"
	set -- rm-multilayer -q --size 24x24 --mip-levels=2 torus.obj -o set \
		--format "$type"
	ok "$@"
	# shellcheck disable=SC2046 # names without blanks
	skips $(ls set_*."$type") -- "$@"
	cp "set_mip1_ny.$type" was
	rm "set_mip1_ny.$type"
	bakes "$@"
	same_bytes "set_mip1_ny.$type" was
	rm -f set_*
done

check "a PNG file's check sums are right after its seal"
python3 - ao.png rm-pack.png <<'P' || bad 'a check sum is wrong'
import sys
import zlib
for name in sys.argv[1:]:
    data, at = open(name, "rb").read(), 8
    while at < len(data):
        n = int.from_bytes(data[at:at + 4], "big")
        crc = int.from_bytes(data[at + 8 + n:at + 12 + n], "big")
        assert zlib.crc32(data[at + 4:at + 8 + n]) == crc
        at += 12 + n
P

for type in json ply glb gltf; do
	check "$type: rm-quadfit skips, and sees another option and mesh"
	ok rm-quadfit -q torus.obj -o "q.$type"
	skips "q.$type" -- rm-quadfit -q torus.obj -o "q.$type"
	cp "q.$type" was
	bakes rm-quadfit -q --ring 3 torus.obj -o "q.$type"
	{ cat torus.obj && echo '# more'; } >longer.obj
	bakes rm-quadfit -q longer.obj -o "q.$type"
	bakes rm-quadfit -q torus.obj -o "q.$type"
	same_bytes "q.$type" was
done

check 'tsv: the same table is left alone'
ok rm-quadfit -q torus.obj -o q.tsv
skips q.tsv -- rm-quadfit -q torus.obj -o q.tsv
bakes rm-quadfit -q --ring 3 torus.obj -o q.tsv

check 'one EXR of parts, and a deep one'
ok rm-multilayer -q --size 24x24 torus.obj -o parts.exr
skips parts.exr -- rm-multilayer -q --size 24x24 torus.obj -o parts.exr
ok rm-multilayer -q --deep --size 24x24 torus.obj -o deep.exr
skips deep.exr -- rm-multilayer -q --deep --size 24x24 torus.obj -o deep.exr
bakes rm-multilayer -q --deep --size 25x24 torus.obj -o deep.exr

check 'views and a preview belong to the set'
set -- rm-multilayer -q --size 24x24 --views 3 --preview pic.png torus.obj -o v
ok "$@"
# shellcheck disable=SC2046
skips $(ls v_*.png pic_*.png) -- "$@"
rm pic_y.png
bakes "$@"
present pic_y.png

check 'all outputs of a run must be there'
set -- rm-aobake -q -n8 -s 0.1,0.2 --bent-normal bent.png --horizons hor.exr \
	stone.png -o two.png
ok "$@"
skips two_s0.1.png two_s0.2.png bent_s0.1.png bent_s0.2.png hor_s0.1.exr \
	hor_s0.2.exr -- "$@"
rm bent_s0.2.png
bakes "$@"
present bent_s0.2.png
set -- rm-pack -q --normal normal.png --depth stone.png --target godot -o g.png
ok "$@"
# shellcheck disable=SC2046
skips $(ls g*.png) -- "$@"
set -- rm-pack -q --unpack rm-pack.png --normal-out n.png --ao-out a.png
ok "$@"
skips n.png a.png -- "$@"
set -- rm-render -q --size 32x24 --buffers buf.exr -o shot.png
ok "$@"
skips shot.png buf.exr -- "$@"
set -- rm-render -q --size 16x12 --turntable 3 -o turn.png
ok "$@"
skips turn_0001.png turn_0002.png turn_0003.png -- "$@"
set -- rm-roughen -q --angle 30 --lut lut.png --sheet sheet.png stone.png \
	-o rough.png
ok "$@"
skips rough.png lut.png sheet.png -- "$@"
cp stone.png color.png
set -- rm-combine -q --color color.png rm-pack.png --color-out c.png -o m.png
ok "$@"
skips c.png m.png -- "$@"
cp cushion.png color.png
bakes "$@"

check 'outputs that changed their places are no match'
ok rm-aobake -q -n8 --bent-normal b.png stone.png -o a.png
mv a.png x.png && mv b.png a.png && mv x.png b.png
bakes rm-aobake -q -n8 --bent-normal b.png stone.png -o a.png

check 'a checkout elsewhere, with other names and times, is up to date'
mkdir -p there/deep/in
cp ao.png there/deep/in/result.png
cp stone.png there/renamed.png
touch there/renamed.png
(cd there/deep && skips in/result.png -- rm-aobake -q -n8 ../renamed.png \
	-o in/result.png)

check 'the same at any number of threads and with other ways to say nothing'
skips ao.png -- rm-aobake -n8 stone.png -j 3 -o ao.png --memory 1G
skips ao.png -- rm-aobake --directions=8 stone.png --output ao.png --isolate

check 'a batch decides for each input'
mkdir many sets
ok rm-aobake -q -n8 stone.png cushion.png -O many
cp many/stone.png was
cp stone.png first.png
cp normal.png stone.png
bakes_one() {
	again rm-aobake -q -n8 stone.png cushion.png -O many
	[ "$(grep -c 'up to date' "$PRIV/err")" = 1 ] ||
		bad "not one of two was skipped"
	stderr_has 'many/cushion.png: up to date'
}
bakes_one
cp first.png stone.png
bakes_one
same_bytes many/stone.png was
skips many/stone.png many/cushion.png -- rm-aobake -q -n8 stone.png \
	cushion.png -O many
skips many/stone.png -- rm-aobake -q -n8 stone.png -o many/stone.png

check 'sets of rm-pack, each with its own maps'
cp normal.png normal2.png
set -- rm-pack -q --ao none --no-check --normal normal.png --depth stone.png \
	--normal normal2.png --depth cushion.png -O sets
ok "$@"
skips sets/stone.png sets/cushion.png -- "$@"
cp normal3.png normal2.png
again "$@"
stderr_has 'sets/stone.png: up to date'
[ "$(grep -c 'up to date' "$PRIV/err")" = 1 ] || bad "a changed set was skipped"

check 'a mesh with its materials and pictures'
mkdir -p mesh/tex
cp stone.png mesh/tex/wood.png
{ echo 'mtllib a.mtl' && echo 'usemtl m' && cat torus.obj; } >mesh/a.obj
printf 'newmtl m\nKd 1 1 1\nmap_Kd tex/wood.png\n' >mesh/a.mtl
set -- rm-multilayer -q --size 24x24 mesh/a.obj -o m -M m.d
ok "$@"
cp m.d was.d
skips m_depth.png m_nx.png m_ny.png m_color.png -- "$@"
for f in mesh/a.obj mesh/a.mtl mesh/tex/wood.png; do
	grep -qF "$f" m.d || bad "the depfile of a skipped run has no $f"
done
cmp -s m.d was.d || bad 'the depfile of a skipped run is another one'
mkdir else
cp -r mesh else/moved
mv else/moved/a.obj else/moved/b.obj
cp m_*.png else
(cd else && skips m_depth.png m_nx.png m_ny.png m_color.png -- rm-multilayer \
	-q --size 24x24 moved/b.obj -o m)
cp cushion.png mesh/tex/wood.png
bakes "$@"
skips m_depth.png m_color.png -- "$@"
printf 'newmtl m\nKd 1 0 0\nmap_Kd tex/wood.png\n' >mesh/a.mtl
bakes "$@"

check 'a picture that is missing may come'
rm mesh/tex/wood.png
bakes "$@"
bakes "$@"
cp stone.png mesh/tex/wood.png
bakes "$@"
skips m_depth.png m_color.png -- "$@"

check "what rm-multilayer wrote, under the names that begin with PREFIX"
set -- rm-render -q --size 24x18 --impostor m -o imp.png
ok "$@"
skips imp.png -- "$@"
ok rm-multilayer -q --size 25x24 mesh/a.obj -o m
bakes "$@"

check 'standard input, standard output and $OCIO are never skipped'
rm-aobake -q -n8 - -o ao.png --if-changed -v <stone.png 2>err
! grep -q 'up to date' err || bad 'standard input was skipped'
rm-aobake -q -n8 stone.png -o - --format png --if-changed >piped
same_bytes piped ao.png
ok rm-roughen -q --angle 30 stone.png -o rough.png
OCIO=nothing.ocio rm-roughen -q --angle 30 stone.png -o rough.png --if-changed \
	-v 2>err || : # there is no such file
! grep -q 'up to date' err || bad 'another colour configuration was skipped'

check 'an output in the place of its input stays what a second run makes it'
ok rm-pack -q --normal normal.png --depth stone.png -o place.png
ok rm-aobake -q -n8 --in-place-channel B place.png
cp place.png once.png
bakes rm-aobake -q -n8 --in-place-channel B place.png
same_bytes place.png once.png

check 'runs that print are made'
ok rm-quadfit -q torus.obj -o q.json
again rm-quadfit -q --stats torus.obj -o q.json
grep -q residual "$PRIV/out" || bad 'nothing was printed'

check 'a record of another version is no match'
ok rm-quadfit -q torus.obj -o q.ply
LC_ALL=C sed 's/rm1:.\{4\}/rm1:abcd/' q.ply >other.ply
bakes rm-quadfit -q torus.obj -o other.ply
same_bytes q.ply other.ply

check 'an output that cannot be touched is no success'
if [ "$(id -u)" = 0 ]; then
	skip 'root may touch all'
else
	chmod a-w ao.png
	exits 1 rm-aobake -q -n8 --if-changed cushion.png -o ao.png
fi

check 'every option that names files is marked'
# An option that is not marked counts with its text: a path would make the
# bytes depend on the folder. So each bakes the same from two folders.
grep -hE '^	\{ (KEY_[A-Z_]*|.[a-zA-Z].), "[a-z-]*", "(FILE|PREFIX|REFERENCE|DEPTHMAP|D)"' \
	"$top"/cmd/*.c | sed 's/.*, "\([a-z-]*\)", .*/\1/' | sort -u >named
sed -n 's/^	{ "\([a-z-]*\)", CMD_ARG_.*/\1/p' "$top"/cmd/*.c |
	sort -u >marked
grep -qx bent-normal named || bad 'found no options'
while read -r option; do
	case $option in
	depfile | each | output) continue ;;
	esac
	grep -qx "$option" marked || bad "--$option is not marked"
done <named
