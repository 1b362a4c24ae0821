# What every tool does with its common options, good and bad.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-aobake rm-info rm-combine rm-rescale-ao rm-roughen
cp "$DATA/woven_depth.png" depth.png

# Exit status 2, one reason, then the usage as --help has it, no more.
usage_error() {
	exits 2 "$@"
	stdout_empty
	$tool --help | sed -n '/^usage: /p; /^       rm-/p' >"$PRIV/usage"
	sed 1d "$PRIV/err" | cmp -s - "$PRIV/usage" &&
		sed -n 1p "$PRIV/err" | grep -q "^$tool: " ||
		bad "'$*': not one reason and the usage:" "$(cat "$PRIV/err")"
}

for tool in rm-pack rm-aobake rm-info rm-combine rm-rescale-ao rm-roughen; do
	check "$tool --help goes to standard output"
	ok $tool --help
	stdout_has "^usage: $tool "
	stdout_has '-h, --help'
	cp "$PRIV/out" "$PRIV/help"
	ok $tool -h
	same_bytes "$PRIV/help" "$PRIV/out"

	check "$tool --version"
	ok $tool --version
	stdout_has "^$tool [0-9]*\\.[0-9]*\\.[0-9]*\$"
	ok $tool -V

	check "$tool lists its options in order"
	sed -n 's/^  ... --\([a-z-]*\).*/\1/p' "$PRIV/help" >"$PRIV/names"
	[ -s "$PRIV/names" ] || bad 'the help text has no options'
	sort -c "$PRIV/names" || bad 'the help text is not sorted'

	check "$tool refuses wrong usage with a reason and its usage"
	usage_error $tool
	usage_error $tool --no-such-option depth.png
	stderr_has 'no-such-option'
	usage_error $tool -j
	usage_error $tool -j 0 depth.png
	usage_error $tool -j two depth.png
	stderr_has 'two'
	usage_error $tool -j '' depth.png
	usage_error $tool -j ' 1' depth.png
	usage_error $tool --threads=1x depth.png
	usage_error $tool --threads=99999999999999999999 depth.png
	usage_error $tool --max-pixels nan depth.png
	usage_error $tool --help=yes

	check "$tool fails when its standard output is full"
	exits 1 sh -c "$tool --help >/dev/full"
done

check 'bad numbers are errors, not clamped'
tool=rm-aobake comma=,
for bad_option in -n0 -n2 -n1e9 -n50.5 -nNaN -n0x10 -s-1 -sinf -snan -s0.1x \
    "-s0.1$comma" -r-1 -rNaN --periods=0 --periods=1.5 --blur=-1 --blur=x \
    --data-format=int --format=gif --wrap=both --png-level=0 --png-level=10; do
	usage_error rm-aobake "$bad_option" depth.png -o ao.png
	absent ao.png
done

check 'an output must be named'
usage_error rm-aobake depth.png
usage_error rm-aobake depth.png -o ao
usage_error rm-aobake depth.png -o -
usage_error rm-aobake -o ao.png -O dir depth.png
tool=rm-pack
usage_error rm-pack --depth depth.png
usage_error rm-pack -o out.png
usage_error rm-pack --depth depth.png -d half -o out.png
no_litter depth.png

check 'a missing file is named'
for c in 'rm-aobake -o ao.png' 'rm-pack -o p.png --depth' \
    'rm-pack -o p.png --normal' 'rm-info'; do
	# shellcheck disable=SC2086 # a command and its options
	exits 1 $c 'no such file.png'
	stderr_one_line 'no such file.png: '
	stdout_empty
done
exits 1 rm-aobake depth.png -o nowhere/ao.png
stderr_one_line 'nowhere'
no_litter depth.png

check 'an empty file and a folder are errors'
: >empty.png
mkdir folder.png
for c in 'rm-aobake -o ao.png' 'rm-pack -o p.png --depth' rm-info; do
	for f in empty.png folder.png; do
		# shellcheck disable=SC2086 # a command and its options
		exits 1 $c $f
		stderr_one_line "$f"
	done
done
rm -r empty.png folder.png
no_litter depth.png

check 'arguments come from a response file'
printf '%s\n' -n 4 --no-blur '' depth.png -o 'with space.png' >args
ok rm-aobake @args
ok rm-aobake -n4 --no-blur depth.png -o direct.png
same_bytes 'with space.png' direct.png
exits 1 rm-aobake @missing
stderr_one_line missing
exits 1 rm-aobake -o x.png -- @args
stderr_one_line '@args'
absent x.png

check 'two dashes end the options'
cp depth.png ./-depth.png
ok rm-aobake -n4 --no-blur -o dashed.png -- -depth.png
same_bytes dashed.png direct.png

check 'options may follow operands, long ones may be cut short'
ok rm-aobake depth.png --no-bl --dir=4 -o late.png
same_bytes late.png direct.png

check 'standard input and output'
ok sh -c 'rm-aobake -n4 --no-blur --format png - -o - <depth.png >pipe.png'
same_bytes pipe.png direct.png
ok sh -c 'cat depth.png | rm-aobake -n4 --no-blur --format=png - -o - |
	cat >pipe2.png'
same_bytes pipe2.png direct.png
ok sh -c 'cat depth.png | rm-info - >info.txt'
present info.txt

check 'the depfile names the output and all that was read'
ok rm-pack --depth depth.png --normal "$DATA/stone_normal.png" -q \
    -M dep.d -o packed.png
grep -q '^packed.png:' dep.d || bad "dep.d has no rule: $(cat dep.d)"
grep -qF 'depth.png' dep.d || bad 'dep.d lacks the depth map'
grep -qF 'stone_normal.png' dep.d || bad 'dep.d lacks the normal map'
printf 'all: packed.png\ninclude dep.d\n' >test.mk
ok make -q -f test.mk packed.png
rm -f dep.d packed.png
exits 1 rm-pack --depth missing.png -M dep.d -o packed.png
absent dep.d packed.png

check 'many inputs in one call'
mkdir out
ok rm-aobake -n4 --no-blur -O out depth.png -- -depth.png
same_bytes out/depth.png direct.png
same_bytes out/-depth.png direct.png
exits 1 rm-aobake -n4 --no-blur -O out missing.png depth.png
stderr_has missing.png
