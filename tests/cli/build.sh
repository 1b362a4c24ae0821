# The Makefile never mixes objects that were built in different ways.
# SPDX-License-Identifier: MIT
. "$LIB"
need make "${CC:-cc}"
[ "$MODE" = release ] || {
	check 'building'
	skip "once is enough, and this is $MODE"
	exit 0
}

unset WERROR CFLAGS CXXFLAGS LDFLAGS || :
object=$PWD/b/libbake/err.c.o
# whether make, called with these variables, builds the object anew
rebuilds() {
	exits 0 make -C "$top" V=1 B="$PWD/b" "$@" "$object"
	grep -q -e '-c -o' "$PRIV/out" || return 1
}

check 'nothing is compiled twice'
rebuilds || bad 'it was not built at all'
rebuilds && bad 'it was built again'

check 'header dependencies hold however B is spelt'
grep -q '^\$(B)/libbake/err.c.o:.*libbake/err.h' b/libbake/err.c.d ||
	bad "b/libbake/err.c.d begins $(head -n 1 b/libbake/err.c.d)"

check 'other flags, another compiler, another version: built anew'
rebuilds CFLAGS=-DSOMETHING || bad 'not with other CFLAGS'
rebuilds CFLAGS=-DSOMETHING && bad 'again with the same CFLAGS'
rebuilds WERROR=1 || bad 'not with WERROR'
rebuilds VERSION=9.9.9 || bad 'not with another version'
rebuilds CC="${CC:-cc} -pipe" || bad 'not with another compiler'

check 'CFLAGS of the user do not replace a flag that the code needs'
rebuilds CFLAGS=-O0
grep -q -e '-ffp-contract=off' "$PRIV/out" || bad 'fp-contract is lost'
grep -q -e '-fvisibility=hidden' "$PRIV/out" || bad 'visibility is lost'

check 'an unknown MODE is refused'
exits 2 make -C "$top" B="$PWD/b" MODE=fast all
stderr_has 'MODE is fast'
