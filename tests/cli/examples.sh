# The examples of the man pages and of the README run as they are printed.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-aobake rm-info

# The literal blocks of a page's EXAMPLES section, as a script: a line that
# begins with '$ ' is a command, with those after it that end in a backslash.
examples() {
	sed -n '/^\.Sh EXAMPLES/,/^\.Sh [^E]/p' "$1" |
		sed -n '/^\.Bd/,/^\.Ed/p' | sed '/^\./d; s/\\e/\\/g; s/\\&//g' |
		commands
}

# The README: indented lines that begin with '$ rm-'.
readme_examples() {
	sed -n 's/^    //p' "$1" | commands | grep '^rm-' || :
}

commands() {
	awk '/^\$ / { print substr($0, 3); more = /\\$/; next }
		more { print; more = /\\$/ }'
}

# $1: what; the script is $PRIV/script. Each command on its own must succeed.
run_all() {
	check "$1: its examples run"
	[ -s "$PRIV/script" ] || bad 'it has no example'
	rm -rf folder
	mkdir folder
	for f in "$DATA"/*.png "$DATA"/*.obj; do
		cp -R "$f" folder
	done
	(cd folder && sh -eu "$PRIV/script") >"$PRIV/out" 2>"$PRIV/err" || {
		bad "a command failed; the script is"
		sed 's/^/    | /' "$PRIV/script"
		sed 's/^/    ! /' "$PRIV/err"
	}
}

for page in "$top"/man/*.[0-9]; do
	examples "$page" >"$PRIV/script"
	case $page in
	*.1) run_all "$(basename "$page")" ;;
	*) [ ! -s "$PRIV/script" ] || run_all "$(basename "$page")" ;;
	esac
done
readme_examples "$top/README.md" | sed 's,testdata/,,g' >"$PRIV/script"
run_all README.md
