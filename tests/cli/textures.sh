# rm-info tells the truth about real textures, or says that it is unsure.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-info python3

table=$RELIEF_DATA/textures/ground_truth.tsv
if [ ! -e "$table" ]; then
	check 'real textures'
	skip "the shared textures are not there ($table)"
	exit 0
fi

tab=$(printf '\t')
nsure=0
# agree WHAT GOT WANT
agree() {
	case $2 in
	"$3") nsure=$((nsure + 1)) ;;
	unsure) ;;
	*) bad "$1 is '$2', the truth is '$3'" ;;
	esac
}

tail -n +2 "$table" >"$PRIV/table"
while IFS=$tab read -r name normal height channel polarity normal_y _; do
	check "$name: $normal and $height"
	folder=$RELIEF_DATA/textures/$name
	case $channel in
	first) channel=0 ;;
	esac
	exits 0 rm-info --json --channel "$channel" \
	    --normal "$folder/$normal" --depth "$folder/$height"
	case $polarity in
	*high*) agree polarity "$(json polarity)" height ;;
	*) agree polarity "$(json polarity)" depth ;;
	esac
	case $normal_y in
	Y+*) agree 'normal y' "$(json normal_y)" up ;;
	*) agree 'normal y' "$(json normal_y)" down ;;
	esac
done <"$PRIV/table"

check 'it is sure of most of them'
total=$((2 * $(wc -l <"$PRIV/table")))
[ $nsure -ge $((total * 4 / 5)) ] || bad "sure of $nsure of $total"

check 'it is sure of the project'\''s own test maps'
for m in bricks cushion stone; do
	ok rm-info --json --normal "$DATA/${m}_normal.png" \
	    --depth "$DATA/${m}_depth.png"
	equal "$(json polarity)/$(json normal_y)" depth/up "$m"
done
