# The shells complete what the tools take: every option of every tool's help,
# the very values that it accepts, files by what they may be.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack bash
made=$B/completions

# The completions of a command line for its last word, sorted, one a line.
cat >"$PRIV/try.bash" <<'END'
source "$1"
tool=${1##*/}
shift
COMP_WORDS=("$tool" "$@")
COMP_CWORD=$#
"_${tool//-/_}"
[[ ${#COMPREPLY[@]} -eq 0 ]] || printf '%s\n' "${COMPREPLY[@]}"
END
replies() {
	tool=$1
	shift
	bash "$PRIV/try.bash" "$made/bash/$tool" "$@" 2>&1 | sort
}
# offers 'WORD,WORD' TOOL ARGUMENT...: just these, in any order
offers() {
	want=$(echo "$1" | tr ',' '\n' | sort)
	shift
	replies "$@" >"$PRIV/got"
	equal "$(cat "$PRIV/got")" "$want" "what is offered for '$*'"
}
# differences of two lists of words: those that tools name, those offered
compare_words() {
	cmp -s "$PRIV/named" "$PRIV/got" || {
		bad "$1: named (<) and offered (>) differ:"
		diff "$PRIV/named" "$PRIV/got" | sed -n '/^[<>]/s/^/    | /p'
	}
}

check 'bash: all options of the help are offered, and no others'
for path in "$B"/bin/rm-*; do
	tool=$(basename "$path")
	"$tool" --help | sed -n 's/^  \(...\) \(--[a-z-]*\).*/\1 \2/p' |
		sed 's/^  *//; s/,//' | tr ' ' '\n' | sort >"$PRIV/named"
	[ "$(wc -l <"$PRIV/named")" -gt 10 ] || bad "$tool has few options"
	replies "$tool" - >"$PRIV/got"
	compare_words "$tool"
done

# The tool says itself what it takes when it gets another value: the words
# after 'expected'. Options that tools have in common are tried once.
check 'bash: the values offered are those that the tool names itself'
for path in "$B"/bin/rm-*; do
	"$path" --print-options | awk -F '\t' -v tool="$(basename "$path")" '
		NF == 4 && ($3 ~ /^(NAME|MODE|TYPE|FORMAT|CODE|SIDE)$/ ||
		    $3 ~ /\|/ || $4 ~ /\{/) {
			print tool " " $2 "\t" $3 "\t" $4
		}'
done | sort -u -t ' ' -k 2 | sed 's/	.*//' >"$PRIV/options"
nvalues=0
while read -r tool option; do
	"$tool" "--$option=%no" >/dev/null 2>"$PRIV/message" </dev/null || :
	sed -n "1s/.*: --$option is '%no', expected //p" "$PRIV/message" |
		grep -v -e number -e ' a ' | sed 's/,//g; s/ or / /g' |
		tr ' ' '\n' | sort >"$PRIV/named"
	[ -s "$PRIV/named" ] || continue
	nvalues=$((nvalues + $(wc -l <"$PRIV/named")))
	replies "$tool" "--$option" '' >"$PRIV/got"
	compare_words "$tool --$option"
done <"$PRIV/options"
# of twenty options and more; far fewer means that the sieve above is too fine
[ "$nvalues" -gt 60 ] || bad "only $nvalues values were compared"

check 'bash: what is offered beside numbers and names of files is taken'
for line in 'rm-aobake depth-range auto' 'rm-combine ao none' \
    'rm-combine color-layer blend' 'rm-multilayer layers all' \
    'rm-pack ao none' 'rm-quadfit order 2' 'rm-quadfit order 3' \
    'rm-render quadric none' 'rm-render search exact' \
    'rm-render search texel' 'rm-render shape teapot' 'rm-roughen median auto'
do
	# shellcheck disable=SC2086 # three words
	set -- $line
	replies "$1" "--$2" '' | grep -qx -e "$3" || bad "$1 --$2 lacks $3"
	exits 2 "$1" "--$2=$3" --no-such-option
	stderr_has '--no-such-option'
done
ok rm-pack --list-targets
sed 's/ .*//' "$PRIV/out" | sort >"$PRIV/named"
replies rm-pack --target '' >"$PRIV/got"
compare_words 'rm-pack --target'

check 'bash: files by kind'
mkdir folder 'with space'
touch a.png B.PNG c.exr d.obj e.glb notes.txt 'with space/f.png'
offers 'B.PNG,a.png,c.exr,folder,with space' rm-aobake ''
offers 'd.obj,e.glb,folder,with space' rm-quadfit ''
offers 'folder,with space' rm-aobake -O ''
offers 'none,B.PNG,a.png,c.exr,folder,with space' rm-pack --ao ''
offers 'notes.txt' rm-aobake --depfile n
offers 'a.png' rm-aobake -s 0.1 a
offers '@notes.txt' rm-aobake @no
offers 'a.png' rm-combine -- a
offers '' rm-combine -- --
offers '' rm-aobake -s ''
offers '' rm-multilayer --mip-levels=
offers 'with space/f.png' rm-aobake 'with space/'

check 'bash: --name=value, in one word and in three'
offers 'exact' rm-aobake --quality = e
offers 'exact,fast,preview' rm-aobake --quality =
offers '--quality=exact' rm-aobake --quality=e
offers 'a.png' rm-aobake --bent-normal = a
offers '' rm-aobake --no-blur = ''
offers '' rm-aobake --radius = ''

# A shell in a terminal, typed into; in it rm-aobake prints its arguments.
check 'bash: TAB'
cat >"$PRIV/rc" <<END
source '$made/bash/rm-aobake'
rm-aobake() { printf '<%s>' "\$@"; echo; }
PS1='ready> '
bind 'set enable-bracketed-paste off'
END
# wait_for REGEX: until it was seen, half a minute at most
wait_for() {
	for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
		! grep -q -e "$1" "$PRIV/seen" || return 0
		sleep 1
	done
}
if command -v script >/dev/null; then
	: >"$PRIV/seen"
	{
		wait_for '^ready> '
		printf 'rm-aobake --qual\tprev\t --est\tme\t wi\tf.\t-j\n'
		wait_for '^<--'
		printf 'exit\n'
	} | script -qfc "env TERM=dumb bash --rcfile $PRIV/rc -i" \
	    "$PRIV/seen" >/dev/null 2>&1 || :
	tr -d '\r\007' <"$PRIV/seen" >"$PRIV/plain"
	want='<--quality><preview><--estimator><mean><with space/f.png><-j>'
	grep -q -x -F -e "$want" "$PRIV/plain" || {
		bad "there is no $want in"
		sed 's/^/    | /' "$PRIV/plain"
	}
else
	skip 'script, which makes a terminal, is not there'
fi

check 'zsh: every option of every tool, and TAB'
if ! command -v zsh >/dev/null; then
	skip 'zsh is not there'
	exit 0
fi
for path in "$B"/bin/rm-*; do
	tool=$(basename "$path")
	f=$made/zsh/_$tool
	ok zsh -n "$f"
	equal "$(sed 1q "$f")" "#compdef $tool" "the first line of $f"
	"$tool" --help | sed -n 's/^  ... \(--[a-z-]*\).*/\1/p' |
		while read -r option; do
			grep -q -e "[^a-z-]${option}[^a-z-]" "$f" ||
				echo "$tool $option"
		done >"$PRIV/got"
	equal "$(cat "$PRIV/got")" '' 'options that zsh lacks'
done
cat >"$PRIV/try.zsh" <<'END'
zmodload zsh/zpty
zpty shell 'TERM=dumb zsh -f -i'
seen() {
	local line
	zpty -r -m shell line "*$1*" && print -r -- $line
}
zpty -w shell "fpath=($1 \$fpath); autoload -U compinit; compinit -u -D
rm-aobake() { printf '<%s>' \"\$@\"; print }; unset zle_bracketed_paste
print re''ady"
seen ready
zpty -w shell $'rm-aobake --qual\tprev\t --est\tme\t wi\tf.\t-j'
seen '<-j>'
zpty -d shell
END
timeout 60 zsh -f "$PRIV/try.zsh" "$made/zsh" >"$PRIV/seen" 2>&1 || :
tr -d '\r\007' <"$PRIV/seen" >"$PRIV/plain"
want='<--quality=preview><--estimator=mean><with space/f.png><-j>'
grep -q -F -e "$want" "$PRIV/plain" || {
	bad "there is no $want in"
	sed 's/^/    | /' "$PRIV/plain"
}
