# Many files in one run: order, failures, crashes, memory, --each.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-aobake rm-info rm-pack rm-combine rm-quadfit
mkdir in one
for n in 1 2 3; do
	for f in woven stone; do
		rm-pack --size 96x96 -q --depth "$DATA/${f}_depth.png" \
		    --ao none -o packed.png
		rm-pack --unpack packed.png --depth-out "in/$f$n.png"
	done
done
inputs=$(echo in/*.png)
for i in $inputs; do
	rm-aobake -q "$i" -o "one/$(basename "$i")"
done

check 'a batch writes the bytes of one run for each file'
for opts in -j1 -j2 -j7 --no-isolate --isolate; do
	mkdir many
	# shellcheck disable=SC2086
	ok rm-aobake -q $opts $inputs -O many
	for i in $inputs; do
		same_bytes "one/$(basename "$i")" "many/$(basename "$i")"
	done
	rm -r many
done
ok rm-aobake -q --isolate in/stone1.png -o o.png
same_bytes one/stone1.png o.png

check 'arguments of a response file, and a depfile of all'
mkdir many
printf '%s\n' -q $inputs -O many -M many.d >args
ok rm-aobake @args
[ "$(ls many)" = "$(ls one)" ] || bad "written: $(ls many)"
for i in $inputs; do
	grep -q "$i" many.d || bad "$i is not in the depfile"
	sed -n 1p many.d | grep -q "many/$(basename "$i")" ||
		bad "the depfile's rule does not make many/$(basename "$i")"
done
rm -r many

check 'a file that fails is one line, and the others are done'
printf 'no picture' >in/bad.png
head -c 300 in/stone1.png >in/short.png
for opts in -j1 -j2 -j7 --no-isolate; do
	mkdir many
	# shellcheck disable=SC2086
	exits 1 rm-aobake -q $opts in/bad.png in/woven1.png in/short.png \
	    in/stone1.png -O many
	[ "$(wc -l <"$PRIV/err")" -eq 3 ] || bad "$(cat "$PRIV/err")"
	sed -n 1p "$PRIV/err" | grep -q '^rm-aobake: in/bad.png: ' ||
		bad "first: $(cat "$PRIV/err")"
	sed -n 2p "$PRIV/err" | grep -q '^rm-aobake: in/short.png: ' ||
		bad "second: $(cat "$PRIV/err")"
	sed -n 3p "$PRIV/err" | grep -q '^rm-aobake: 2 of 4 failed$' ||
		bad "third: $(cat "$PRIV/err")"
	[ "$(ls many)" = "stone1.png
woven1.png" ] || bad "written: $(ls many)"
	rm -r many
done

check 'what is printed comes in the order of the inputs'
# shellcheck disable=SC2086
rm-info --no-isolate --json $inputs in/bad.png one/*.png >info.one 2>&1 || :
for j in 1 2 7; do
	# shellcheck disable=SC2086
	exits 1 rm-info -j$j --json $inputs in/bad.png one/*.png
	grep -v rm-info: info.one | cmp -s - "$PRIV/out" ||
		bad "-j$j: the reports are not those of one process"
	grep rm-info: info.one | cmp -s - "$PRIV/err" ||
		bad "-j$j: the messages are not those of one process"
done

# The processes that a process has started.
children() {
	cat /proc/"$1"/task/*/children 2>/dev/null || :
}

# Run a batch with a pipe that nobody writes to among its inputs; $batch is its
# process and $stuck the worker that waits for the pipe.
start_stuck() {
	rm -rf many
	mkdir many
	[ -p in/pipe.png ] || mkfifo in/pipe.png
	rm-aobake -j2 -q in/woven1.png in/pipe.png in/stone1.png in/stone2.png \
	    -O many 2>stuck.err &
	batch=$!
	for _ in $(seq 200); do
		sleep 0.05
		# the others are done, and one worker has been given no more
		[ -e many/stone2.png ] && [ -e many/stone1.png ] && break
	done
	stuck=
	for c in $(children $batch); do
		# it is within open(), the others wait for a message
		if ! ls -l /proc/"$c"/fd | grep -q 'pipe.png' &&
			grep -q -e fifo -e wait_for_partner /proc/"$c"/wchan \
				2>/dev/null; then
			stuck=$c
		fi
	done
}

check 'a crash of the decoder is one line, and the others are done'
if [ ! -r /proc/self/wchan ] || [ ! -e /proc/self/task/$$/children ]; then
	skip 'the system does not tell what processes wait for'
else
	start_stuck
	if [ -z "$stuck" ]; then
		kill $batch
		wait $batch || :
		skip 'the system does not tell which process waits for a pipe'
	else
		status=0
		kill -SEGV "$stuck"
		wait $batch || status=$?
		[ $status -eq 1 ] || bad "exit status $status"
		[ "$(wc -l <stuck.err)" -eq 2 ] || bad "$(cat stuck.err)"
		# a sanitizer makes an exit of the signal
		grep -q -e 'rm-aobake: in/pipe.png: .*crashed.*Segmentation' \
		    -e 'rm-aobake: in/pipe.png: .*crashed.*ended the process' \
		    stuck.err || bad "$(cat stuck.err)"
		[ "$(ls many)" = "stone1.png
stone2.png
woven1.png" ] || bad "written: $(ls many)"
	fi
fi

check 'files that assimp 5.2 cannot stand, and the others'
rm -rf many
mkdir many
exits 1 rm-quadfit --format ply -O many "$DATA/fuzz/lib/far_face.ase" \
    "$DATA/torus.obj" "$DATA/fuzz/lib/no_corner.md5mesh" \
    "$DATA/fuzz/lib/bad_crc.3mf"
present many/torus.ply
for f in far_face.ase no_corner.md5mesh bad_crc.3mf; do
	[ "$(grep -c "^rm-quadfit: .*$f" "$PRIV/err")" -eq 1 ] ||
		bad "not one line of $f: $(cat "$PRIV/err")"
done
stderr_has '^rm-quadfit: 3 of 4 failed$'
[ "$(wc -l <"$PRIV/err")" -eq 4 ] || bad "$(cat "$PRIV/err")"
rm -r many

# a shell's background process ignores SIGINT
check 'a signal ends a batch and its workers'
for sig in TERM HUP; do
	start_stuck
	workers=$(children $batch)
	status=0
	kill -$sig $batch
	wait $batch || status=$?
	[ "$(kill -l $status)" = $sig ] || bad "$sig: exit status $status"
	for w in $workers; do
		! kill -0 "$w" 2>/dev/null || bad "$sig: worker $w goes on"
	done
	same_bytes one/stone2.png many/stone2.png
done
rm -rf many in/pipe.png

check 'memory is bounded'
mkdir many
# shellcheck disable=SC2086
ok rm-aobake -q --memory 300K $inputs -O many
same_bytes one/stone1.png many/stone1.png
exits 1 rm-aobake -q --memory 100K in/stone1.png in/woven1.png -O many
stderr_has 'in/stone1.png: needs about .* --memory'
stderr_has 'in/woven1.png: needs about .* --memory'
exits 1 rm-aobake -q --memory 100K in/stone1.png -o o2.png
stderr_one_line 'in/stone1.png: needs about'
absent o2.png
for size in 0 -1 1X G 1GB nan 8g8; do
	exits 2 rm-aobake --memory $size in/stone1.png -o o2.png
done
rm -r many

check '--each runs once for each name'
mkdir many
printf '%s\n' stone1 '' woven2 >names
for opts in -j1 -j7 --no-isolate; do
	ok rm-pack -q $opts --each names --depth in/%.png --ao one/%.png \
	    -o many/%_relief.png -M many/%.d
	for n in stone1 woven2; do
		ok rm-pack -q --depth in/$n.png --ao one/$n.png -o o.png
		same_bytes o.png many/${n}_relief.png
		grep -q "^many/${n}_relief.png:" many/$n.d ||
			bad "$(cat many/$n.d)"
	done
	rm many/*
done
cp packed.png detail_stone1.png
cp packed.png detail_woven2.png
ok rm-combine -q packed.png --each=names -t 2 detail_%.png -o many/%.png
[ "$(ls many)" = "stone1.png
woven2.png" ] || bad "written: $(ls many)"
echo stone3 >names
ok sh -c 'rm-aobake -q --each - in/%.png -o many/100%%%.png <names'
present many/100%stone3.png

check '--each goes on after a name that fails'
printf '%s\n' none stone1 >names
rm many/*
exits 1 rm-aobake -q -j2 --each names in/%.png -o many/%.png
[ "$(wc -l <"$PRIV/err")" -eq 2 ] || bad "$(cat "$PRIV/err")"
stderr_has '1 of 2 failed'
present many/stone1.png

check '--each needs a place for the names'
exits 2 rm-aobake --each names in/%.png -o o.png
stderr_has 'o.png: .*%'
exits 2 rm-aobake --each names in/%.png -o many/%.png -M m.d
stderr_has 'm.d: .*%'
exits 1 rm-aobake --each no_such_file in/%.png -o many/%.png
stderr_one_line no_such_file

check 'one thread under a parallel make'
cat >Makefile <<'END'
all: a b
a b: ; @rm-aobake -v -q in/stone1.png -o $@.png
END
ok make -s -j2
same_bytes one/stone1.png a.png
