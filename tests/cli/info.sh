# rm-info: contradictions, comparisons, JSON, contact sheets.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-info python3
n=$DATA/bricks_normal.png
d=$DATA/bricks_depth.png

check 'a pair that agrees with what is declared is silent'
ok rm-info --check --normal-y up --normal "$n" --depth "$d"
stdout_empty
ok rm-info --check --normal "$n" --depth "$d"
stdout_empty

check 'each contradiction is a line'
exits 1 rm-info --check --normal-y down --height -s 5 \
    --normal "$n" --depth "$d"
stderr_empty
stdout_has 'bricks_depth.png: polarity: the maps say depth, declared is height'
stdout_has 'bricks_depth.png: normal y: the maps say up, declared is down'
stdout_has 'bricks_depth.png: depth scale: the normals imply .*, declared is 5$'
[ "$(wc -l <"$PRIV/out")" -eq 3 ] || bad "not three lines"
exits 1 rm-info --check --json --normal-y down --normal "$n" --depth "$d"
[ "$(json normal_y)" = up ] || bad 'the JSON does not say up'

check 'metadata that are wrong contradict'
ok rm-pack -q -s 0.04 --height --normal "$n" --depth "$d" -o wrong.png
exits 1 rm-info --check wrong.png
stdout_has 'wrong.png: polarity: '

check 'a depth range turns a height map round and scales it'
ok rm-info --json --normal "$n" --depth "$d"
s=$(json depth_scale)
ok rm-info --json --depth-range 2,0 --normal "$n" --depth "$d"
[ "$(json polarity)" = height ] || bad 'it is not turned round'
python3 -c "import sys; sys.exit(not abs($(json depth_scale) / $s - 2) < 1e-3)" ||
	bad 'the depth scale does not double'

check 'half a pair, or too much of it, is wrong usage'
exits 2 rm-info --normal "$n"
exits 2 rm-info --depth "$d"
exits 2 rm-info --normal "$n" --depth "$d" "$d"
exits 2 rm-info --compare "$d"
exits 2 rm-info --compare "$d" "$d" "$d"
exits 2 rm-info --compare --tolerance=-1 "$d" "$d"

check 'a comparison names the worst channel and place'
ok rm-info --compare "$d" "$d"
stdout_has '^equal$'
printf 'P2\n3 2\n255\n1 2 3\n4 5 6\n' >a.pgm
printf 'P2\n3 2\n255\n1 2 3\n4 9 5\n' >b.pgm
exits 1 rm-info --compare a.pgm b.pgm
stdout_has '^worst 4 codes in channel . at (1, 1): 5 and 9$'
stdout_has 'worst 4, mean 0.8333, 2 differ, 2 beyond 0$'
exits 1 rm-info --compare --tolerance 3 a.pgm b.pgm
ok rm-info --compare --tolerance 4 a.pgm b.pgm
exits 1 rm-info --compare --json a.pgm b.pgm
[ "$(json worst) $(json x) $(json y)" = '4 1 1' ] || bad 'JSON'
printf 'P2\n2 2\n255\n1 2 3 4\n' >small.pgm
exits 1 rm-info --compare a.pgm small.pgm
stderr_one_line 'one image is 3x2, the other 2x2'

check 'several files, one of them missing'
exits 1 rm-info --json "$d" missing.png "$n"
stderr_has '^rm-info: missing.png: '
stderr_has '^rm-info: 1 of 3 failed$'
[ "$(wc -l <"$PRIV/out")" -eq 2 ] || bad 'not two lines of JSON'

check 'a name that is no UTF-8 is still JSON'
cp "$d" "$(printf 'a\377b.png')"
ok rm-info --json "$(printf 'a\377b.png')"
[ "$(json file)" = 'a?b.png' ] || bad "the name is $(json file)"

check 'a contact sheet has a row for each file, or is not there'
ok rm-pack -q --normal "$n" --depth "$d" -o packed.png
ok rm-info --sheet sheet.png packed.png "$n" "$d"
ok rm-info --json sheet.png
[ "$(json width)x$(json height)" = 1044x792 ] ||
	bad "the sheet is $(json width)x$(json height)"
exits 1 rm-info --sheet none.png packed.png missing.png
absent none.png
