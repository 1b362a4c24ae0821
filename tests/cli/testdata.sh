# testdata/ is what its script makes.
# SPDX-License-Identifier: MIT
. "$LIB"
need python3
[ "$MODE" = release ] || {
	check 'test data'
	skip "once is enough, and this is $MODE"
	exit 0
}

check 'the script remakes testdata, pixel for pixel'
ok python3 -B "$top/scripts/make-testdata" --check "$DATA"
[ "$(grep -c '^ok ' "$PRIV/out")" -ge 8 ] || bad 'less than eight files'

check 'the test data stay small'
size=$(find "$DATA" -type f -exec cat {} + | wc -c)
[ "$size" -le 1572864 ] || bad "testdata/ has $size bytes, more than 1.5 MiB"
