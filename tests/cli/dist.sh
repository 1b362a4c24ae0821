# make dist: the same archive from the same commit, and from the archive itself;
# make deb's files name what is installed.
# SPDX-License-Identifier: MIT
. "$LIB"
need make tar gzip

# scripts/dist of a tree, into a folder of that name beside it
dist_of() {
	(cd "$1" && B="$2" VERSION=1 scripts/dist)
}

check 'make dist: twice the same bytes, and again from what it holds'
if [ -e "$top/.git" ] && command -v git >/dev/null &&
    git -c safe.directory='*' -C "$top" cat-file -e HEAD:scripts/dist 2>/dev/null
then
	# a clone: what is being worked on is no part of the archive
	ok git -c safe.directory='*' clone -q "$top" tree
else
	mkdir tree
	(cd "$top" && tar -cf - --exclude=./build --exclude=./.git .) |
		tar -xf - -C tree
fi
ok dist_of tree build/one
umask 077
ok dist_of tree build/two
umask 022
archive=tree/build/one/relief-tools-1.tar.gz
same_bytes $archive tree/build/two/relief-tools-1.tar.gz
tar -xzf $archive
present relief-tools-1/Makefile relief-tools-1/scripts/dist \
    relief-tools-1/testdata/stone_depth.png
ok dist_of relief-tools-1 build/three
same_bytes $archive relief-tools-1/build/three/relief-tools-1.tar.gz
if [ -e tree/.git ]; then
	(cd tree && git ls-files) | sort >files
	tar -tzf $archive | sed -n 's,^relief-tools-1/\(.*[^/]\)$,\1,p' |
		sort >archived
	same_bytes files archived
fi

check 'make dist: nothing of whom, when or where'
tar -tvzf $archive --numeric-owner | awk '$2 != "0/0"' >"$PRIV/got"
equal "$(cat "$PRIV/got")" '' 'files of another owner'
equal "$(tar -tvzf $archive --full-time | awk '{ print $4, $5 }' | sort -u |
	wc -l)" 1 'the number of times'
# after the magic and the method: no name, no time
equal "$(od -An -tx1 -j3 -N5 $archive | tr -d ' ')" 0000000000 'the gzip head'

check 'the Debian packages need what scripts/bootstrap installs to build'
sed -n "/^packages='/,/'\$/p" "$top/scripts/bootstrap" |
	grep -o 'lib[a-z0-9]*-dev' | sort >wanted
[ -s wanted ] || bad 'scripts/bootstrap names no library'
for part in Build-Depends: 'Package: libbake-dev'; do
	sed -n "/^$part/,/^\(Recommends\|Standards\)/p" "$top/scripts/debian/control" |
		grep -o '^ lib[a-z0-9]*-dev' | tr -d ' ' | sort >needed
	same_bytes wanted needed
done

check 'every file that is installed is in one Debian package'
[ "$MODE" = release ] || skip "only a release build is installed, this is $MODE"
if [ "$MODE" = release ]; then
	exits 0 env MAKEFLAGS="$OUTER_MAKEFLAGS" make -C "$top" \
	    B="${B#"$top"/}" MODE="$MODE" install DESTDIR="$PWD/dest" \
	    PREFIX=/usr LIBDIR=/usr/lib/any-arch \
	    ZSHDIR=/usr/share/zsh/vendor-completions
	(cd dest && find . -type f | sed 's,^\./,,' | sort) >installed
	for p in relief-tools libbake-dev; do
		(cd dest && while read -r f; do
			# shellcheck disable=SC2086 # a pattern
			find $f -type f
		done <"$top/scripts/debian/$p.install") >$p.files
		[ -s $p.files ] || bad "$p is empty"
	done
	sort relief-tools.files libbake-dev.files >packaged
	same_bytes installed packaged
fi
