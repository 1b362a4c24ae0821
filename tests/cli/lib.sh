# Helpers of the command line tests; each script sources this file first.
# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2034,SC2153,SC2154 # set by tests/cli/run
#
#	check 'name'            begin a check; it passes unless a helper of it
#	                        complains or a bare command fails
#	skip 'reason'           the check begun last cannot be made here
#	need TOOL...            skip the rest of the script without these tools
#	ok COMMAND...           exit status 0 and nothing on standard error
#	exits N COMMAND...      exit status N
#	stdout_has, stderr_has REGEX      of the last ok or exits
#	stderr_is LINE          the last command's whole standard error
#	stderr_one_line TEXT    one line on standard error, which holds TEXT
#	stdout_empty, stderr_empty
#	same_bytes A B, differ A B, absent FILE..., present FILE...
#	same_result A B         the same but for the record of their recipes
#	fault_sweep JOB SHIM FOLDER   tests/fault/sweep.py, and what it says
#	copy_project            the example project, which finds relief.mk
#	no_litter NAME...       the working folder holds just these names
set -eu

script=$(basename "$0" .sh)
current=
nbad=0
nfailed=0
skipped=

end_check() {
	[ -n "$current" ] || return 0
	if [ -n "$skipped" ]; then
		echo "skip $script: $current: $skipped"
	elif [ "$nbad" -eq 0 ]; then
		echo "ok $script: $current"
	else
		echo "FAIL $script: $current"
		nfailed=$((nfailed + 1))
	fi
	current=
}

check() {
	end_check
	current=$1
	nbad=0
	skipped=
}

skip() {
	skipped=$1
}

bad() {
	nbad=$((nbad + 1))
	echo "    $current: $*"
}

# A bare command that fails ends the script (set -e): that is a failure.
finish() {
	status=$?
	trap - EXIT
	if [ "$status" -ne 0 ] && [ -n "$current" ]; then
		bad "the script stopped with exit status $status"
	fi
	end_check
	[ "$status" -eq 0 ] && [ "$nfailed" -eq 0 ] || exit 1
	exit 0
}
trap finish EXIT

need() {
	for tool; do
		if ! command -v "$tool" >/dev/null; then
			check 'all of this script'
			skip "$tool is not there"
			exit 0
		fi
	done
}

exits() {
	want=$1
	shift
	got=0
	"$@" >"$PRIV/out" 2>"$PRIV/err" </dev/null || got=$?
	if [ "$got" -ne "$want" ]; then
		bad "'$*' exits $got, expected $want"
		sed 's/^/    | /' "$PRIV/err"
	fi
}

ok() {
	exits 0 "$@"
	if [ -s "$PRIV/err" ] && [ "$got" -eq 0 ]; then
		bad "'$*' says on standard error:"
		sed 's/^/    | /' "$PRIV/err"
	fi
}

stdout_has() {
	grep -q -e "$1" "$PRIV/out" || {
		bad "standard output has no '$1':"
		sed 's/^/    | /' "$PRIV/out"
	}
}

stderr_has() {
	grep -q -e "$1" "$PRIV/err" || {
		bad "standard error has no '$1':"
		sed 's/^/    | /' "$PRIV/err"
	}
}

stderr_is() {
	[ "$(cat "$PRIV/err")" = "$1" ] || {
		bad "standard error is not '$1':"
		sed 's/^/    | /' "$PRIV/err"
	}
}

stderr_one_line() {
	if [ "$(wc -l <"$PRIV/err")" -ne 1 ] ||
	    ! grep -qF -e "$1" "$PRIV/err"; then
		bad "standard error is not one line with '$1':"
		sed 's/^/    | /' "$PRIV/err"
	fi
}

stdout_empty() {
	[ ! -s "$PRIV/out" ] || bad 'standard output is not empty'
}

stderr_empty() {
	[ ! -s "$PRIV/err" ] || {
		bad 'standard error is not empty:'
		sed 's/^/    | /' "$PRIV/err"
	}
}

same_bytes() {
	cmp -s "$1" "$2" || bad "$1 and $2 differ"
}

# The same but for the record of what they were made of, and how
# (rm-formats(5)): two recipes with one result.
same_result() {
	python3 "$top/tests/cli/unrecord.py" "$1" >"$PRIV/one"
	python3 "$top/tests/cli/unrecord.py" "$2" >"$PRIV/two"
	cmp -s "$PRIV/one" "$PRIV/two" ||
		bad "$1 and $2 differ in more than their records"
}

differ() {
	python3 "$top/tests/cli/unrecord.py" "$1" >"$PRIV/one"
	python3 "$top/tests/cli/unrecord.py" "$2" >"$PRIV/two"
	! cmp -s "$PRIV/one" "$PRIV/two" ||
		bad "$1 and $2 are the same but for their records"
}

absent() {
	for f; do
		[ ! -e "$f" ] || bad "$f is there"
	done
}

present() {
	for f; do
		[ -s "$f" ] || bad "$f is missing or empty"
	done
}

no_litter() {
	found=$(find . -mindepth 1 -maxdepth 1 | sed 's/^\.\///' | sort)
	want=$(printf '%s\n' "$@" | sed '/^$/d' | sort)
	[ "$found" = "$want" ] ||
		bad "the folder holds '$(echo "$found" | tr '\n' ' ')'," \
		    "expected '$(echo "$want" | tr '\n' ' ')'"
}

# The codes of an image, one texel a line in hexadecimal, read by a decoder that
# shares nothing with the tools; further argument: which channels (0,1,2).
codes() {
	python3 "$top/tests/cli/codes.py" print "$@"
}

# test_map KIND BITS WxH FILE, see codes.py
test_map() {
	python3 "$top/tests/cli/codes.py" maps "$@"
}

# equal TEXT TEXT WHAT
equal() {
	[ "$1" = "$2" ] || bad "$3: '$1' is not '$2'"
}

# json KEY: the value in the one JSON object that the last command printed; a
# dot goes into an object
json() {
	python3 -c '
import json, sys
try:
    v = json.loads(open(sys.argv[1]).readline())
    for key in sys.argv[2].split("."):
        v = v[key]
except (KeyError, ValueError):
    v = "missing"
print(v if not isinstance(v, float) else "%.6g" % v)' "$PRIV/out" "$1"
}

fault_sweep() {
	[ "${FAULTS-}" != all ] || set -- "$@" --all
	python3 -B "$top/tests/fault/sweep.py" "$@" >"$PRIV/sweep" || {
		status=$?
		if [ $status -eq 77 ]; then
			skip 'the kernel traps no system calls'
		else
			bad 'see below'
		fi
	}
	sed 's/^/    /' "$PRIV/sweep"
}

copy_project() {
	cp "$DATA"/*.png "$DATA/torus.obj" .
	cp -R "$DATA/project" project
	mkdir "$PRIV/pc"
	printf '%s\n' "mk=$top/scripts/relief.mk" 'Name: relief' \
	    'Description: test' 'Version: 1' >"$PRIV/pc/relief.pc"
	PKG_CONFIG_PATH=$PRIV/pc
	export PKG_CONFIG_PATH
}
