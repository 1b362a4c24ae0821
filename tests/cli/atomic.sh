# Outputs appear whole or not at all, and odd outputs are dealt with sensibly.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-aobake
cp "$DATA/stone_depth.png" depth.png
ok rm-pack -q --depth depth.png --ao none -o good.png

check 'a failed run leaves the old file and no litter'
cp good.png out.png
head -c 40000 depth.png >cut.png
exits 1 rm-pack -q --depth cut.png -o out.png
stderr_one_line cut.png
same_bytes good.png out.png
no_litter depth.png good.png out.png cut.png
exits 1 rm-aobake -q cut.png -o new.png
absent new.png
no_litter depth.png good.png out.png cut.png
rm cut.png

check 'killed at any moment: the old file or the new one, whole, no litter'
ok rm-aobake -q -n30 depth.png -o new.png
for t in 0.01 0.02 0.04 0.06 0.08 0.1 0.13 0.16 0.2 0.25 0.3 0.4; do
	cp good.png out.png
	rm-aobake -q -n30 depth.png -o out.png 2>/dev/null &
	pid=$!
	sleep $t
	kill -9 $pid 2>/dev/null || :
	wait $pid 2>/dev/null || :
	cmp -s out.png good.png || cmp -s out.png new.png ||
		bad "after $t s out.png is neither old nor new"
	no_litter depth.png good.png out.png new.png
done

check 'killed while it waits for its input'
mkfifo pipe
cp good.png out.png
# the writer keeps the pipe open, so that the tool has begun but cannot end
{ head -c 1000 depth.png; sleep 2; } >pipe &
writer=$!
rm-aobake -q - -o out.png <pipe 2>/dev/null &
pid=$!
sleep 0.5
kill -9 $pid 2>/dev/null || :
wait $pid 2>/dev/null || :
kill $writer 2>/dev/null || :
wait $writer 2>/dev/null || :
same_bytes out.png good.png
rm pipe
no_litter depth.png good.png out.png new.png

check 'interrupted politely: the same'
cp good.png out.png
rm-aobake -q -n200 depth.png -o out.png 2>/dev/null &
pid=$!
sleep 0.1
kill -TERM $pid 2>/dev/null || :
wait $pid 2>/dev/null || :
no_litter depth.png good.png out.png new.png

check 'an output that is an input'
cp depth.png both.png
ok rm-aobake -q -n30 both.png -o both.png
same_bytes both.png new.png
cp good.png both.png
ok rm-pack -q --depth both.png --normal both.png -o both.png
rm both.png

check 'a full device is an error'
exits 1 sh -c 'rm-aobake -q -n4 --format png depth.png -o - >/dev/full'
stderr_one_line 'rm-aobake: '
exits 1 rm-aobake -q -n4 --format png depth.png -o /dev/full
stderr_one_line '/dev/full'
[ -c /dev/full ] || bad '/dev/full was replaced'

check 'a device is written directly'
ok rm-aobake -q -n4 --format png depth.png -o /dev/null
[ -c /dev/null ] || bad '/dev/null was replaced'

check 'a pipe with a name is written directly'
mkfifo pipe.png
cat pipe.png >through.png &
reader=$!
ok rm-aobake -q -n30 depth.png -o pipe.png
wait $reader
[ -p pipe.png ] || bad 'the pipe was replaced'
same_bytes through.png new.png
rm pipe.png through.png

check 'a reader that goes away ends the tool, as it ends any other'
# by SIGPIPE (128 + 13), or by an error where that is ignored
exits 0 sh -c '{ rm-aobake -q -n4 -d float --format exr depth.png -o -
	echo $? >status; } | head -c 10 >/dev/null
	until [ -s status ]; do sleep 0.05; done
	case $(cat status) in 1 | 141) ;; *) exit 1 ;; esac'
rm -f status
exits 0 sh -c 'trap "" PIPE
	{ rm-aobake -q -n4 -d float --format exr depth.png -o -
	echo $? >status; } | head -c 10 >/dev/null
	until [ -s status ]; do sleep 0.05; done
	case $(cat status) in 1) ;; *) exit 1 ;; esac'
stderr_one_line 'rm-aobake: '
rm -f status

check 'a symbolic link: what it points to is replaced'
mkdir real
cp good.png real/target.png
ln -s real/target.png link.png
ok rm-aobake -q -n30 depth.png -o link.png
[ -L link.png ] || bad 'the link was replaced'
same_bytes real/target.png new.png
equal "$(ls -A real)" target.png litter
ln -s real/later.png dangling.png
ok rm-aobake -q -n30 depth.png -o dangling.png
[ -L dangling.png ] || bad 'the dangling link was replaced'
same_bytes real/later.png new.png
ln -s loop.png loop.png
exits 1 rm-aobake -q -n4 depth.png -o loop.png
stderr_one_line loop.png
rm -r real link.png dangling.png loop.png

check 'permissions of an old file are kept, a new one follows the umask'
cp good.png out.png
chmod 640 out.png
ok rm-aobake -q -n30 depth.png -o out.png
equal "$(stat -c %a out.png)" 640 mode
rm out.png
(umask 027 && rm-aobake -q -n30 depth.png -o out.png)
equal "$(stat -c %a out.png)" 640 mode

check 'a folder that cannot be written'
mkdir closed
chmod 555 closed
if [ "$(id -u)" -eq 0 ]; then
	# root writes anywhere but where there are no files at all
	exits 1 rm-aobake -q -n4 depth.png -o /proc/relief-test.png
	stderr_one_line /proc/relief-test.png
else
	exits 1 rm-aobake -q -n4 depth.png -o closed/ao.png
	stderr_one_line closed/ao.png
fi
chmod 755 closed
exits 1 rm-aobake -q -n4 --format png depth.png -o closed
stderr_one_line closed
equal "$(ls -A closed)" '' litter
rmdir closed
no_litter depth.png good.png out.png new.png

check 'a limit on the size of files'
# two blocks of 512 bytes: any bake is larger
exits 1 sh -c 'ulimit -f 2; trap "" XFSZ
	exec rm-aobake -q -n4 -d uint16 depth.png -o out.png'
stderr_one_line out.png
same_bytes out.png new.png
no_litter depth.png good.png out.png new.png
