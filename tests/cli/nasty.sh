# Broken, odd and hostile images: a right result, or one line that names the
# file; never a signal, a hang, all of the memory or a leftover.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-aobake rm-info rm-combine rm-rescale-ao rm-roughen

images=$RELIEF_DATA/nasty_images
if [ ! -d "$images" ]; then
	check 'nasty images'
	skip "the shared test images are not there ($images)"
	exit 0
fi

# AddressSanitizer reserves more address space than any limit allows.
# shellcheck disable=SC3045 # sh has it on Linux, if not in POSIX
[ "$MODE" = asan ] || ulimit -v $((12 * 1024 * 1024))

try() {
	status=0
	timeout 30 "$@" >"$PRIV/out" 2>"$PRIV/err" </dev/null || status=$?
	case $status in
	0 | 1) ;;
	124) bad "'$*' takes more than 30 s" ;;
	*) bad "'$*' exits $status: $(tail -n 3 "$PRIV/err")" ;;
	esac
	[ "$status" -ne 1 ] || stderr_one_line "$name"
	[ "$status" -ne 1 ] || [ ! -s "$PRIV/out" ] ||
		bad "'$*' fails and yet prints to standard output"
}

# The output is there if and only if that succeeds.
try_image() {
	try "$@" -o out.png
	[ "$status" -ne 0 ] || present out.png
	[ "$status" -eq 0 ] || absent out.png
	rm -f out.png
}

for path in "$images"/*; do
	name=$(basename "$path")
	check "$name"
	try rm-info -q "$path"
	try_image rm-aobake -n4 -q "$path"
	try_image rm-pack -q --ao none --depth "$path"
	# a start takes a second there
	[ "$MODE" = asan ] || try_image rm-combine -q --size 32x32 \
	    --normal-blend from-depth --ao none --depth "$path"
	no_litter ''
done

# All in one process: the good ones are written, the others named, a line each.
mkdir many
n=100
for path in "$images"/*; do
	n=$((n + 1))
	ln -s "$path" "many/$n-$(basename "$path")"
done
for tool in 'rm-rescale-ao --scale 2' 'rm-roughen --angle 60'; do
	check "${tool%% *}: all in one process"
	# shellcheck disable=SC2086 # words
	mkdir written
	exits 1 timeout 300 $tool -q -O written many/*
	nwritten=$(find written -type f | wc -l)
	nnamed=$(grep -c "^${tool%% *}: many/[12]" "$PRIV/err")
	[ $((nnamed + 1)) -eq "$(wc -l <"$PRIV/err")" ] ||
		bad "not a line for each file and their number:" \
		    "$(cat "$PRIV/err")"
	stderr_has "^${tool%% *}: $nnamed of $((n - 100)) failed\$"
	[ $((nwritten + nnamed)) -eq $((n - 100)) ] ||
		bad "$nwritten written and $nnamed named of $((n - 100))"
	rm -rf written
done
rm -rf many

check 'NaN and infinite texels are counted in a warning and repaired'
exits 0 rm-aobake -n4 "$images/height_nan_inf.exr" -o ao.exr
stderr_has 'height_nan_inf.exr'
exits 1 rm-aobake -n4 "$images/height_allnan.exr" -o none.exr
stderr_one_line 'height_allnan.exr'
absent none.exr

check 'a name with spaces and umlauts'
ok rm-aobake -q -n4 "$images/height näme with späces.png" -o ao.png
