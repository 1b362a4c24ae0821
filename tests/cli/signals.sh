# Signals at any moment: the process dies of it, and leaves nothing behind.
# SPDX-License-Identifier: MIT
. "$LIB"
need rm-pack rm-aobake rm-combine rm-rescale-ao rm-quadfit rm-multilayer \
    rm-roughen rm-info rm-render python3
# SIGQUIT leaves no core here
# shellcheck disable=SC3045
ulimit -S -c 0

# died SIGNAL COMMAND...: sent while it works, it is what the tool dies of
cat >"$PRIV/died.py" <<'END'
import signal
import subprocess
import sys
import time
sig = getattr(signal, sys.argv[1])
tool = subprocess.Popen(sys.argv[3:], stdin=subprocess.DEVNULL)
time.sleep(float(sys.argv[2]))
tool.send_signal(sig)
status = tool.wait()
sys.exit(0 if status == -sig else "status %d" % status)
END
died() {
	ok python3 "$PRIV/died.py" "$@"
}

check 'the status is the signal, the old file whole, nothing left'
cp "$DATA/stone_depth.png" depth.png
echo old >out.png
for signal in SIGINT SIGTERM SIGHUP SIGQUIT SIGUSR1; do
	for threads in 1 4; do
		died $signal 0.6 \
		    rm-aobake -j$threads -n1024 depth.png -o out.png
		equal "$(cat out.png)" old 'the old file'
	done
done
no_litter depth.png out.png

check 'a signal that was ignored stays ignored (nohup)'
died SIGKILL 0.6 sh -c 'trap "" HUP; rm-aobake -n1024 depth.png -o out.png &
	sleep 0.4; kill -HUP $!; sleep 0.1; kill -0 $! || exit 3
	kill -KILL $!; wait; sleep 5'
stderr_empty

check 'a batch and its workers die together'
died SIGTERM 0.6 rm-aobake -j4 -n1024 depth.png "$DATA/woven_depth.png" -O .
sleep 0.2
no_litter depth.png out.png
equal "$(cat out.png)" old 'the old file'

check 'nobody reads the report any more: the end, without a word'
exits 0 sh -c '{ rm-info depth.png depth.png; echo $? >status; } | true
	until [ -s status ]; do sleep 0.05; done
	case $(cat status) in 0 | 141) ;; *) exit 1 ;; esac'
stderr_empty
rm status

check 'the progress bar is taken off the terminal'
cat >"$PRIV/bar.py" <<'END'
import os
import pty
import signal
import sys
import time
pid, fd = pty.fork()
if pid == 0:
    os.execvp(sys.argv[1], sys.argv[1:])
seen = b""
while b"%" not in seen:  # the bar is drawn after a second
    seen += os.read(fd, 4096)
os.kill(pid, signal.SIGTERM)
try:
    while True:
        more = os.read(fd, 4096)
        if not more:
            break
        seen += more
except OSError:
    pass
status = os.waitpid(pid, 0)[1]
if status != signal.SIGTERM or not seen.endswith(b"\r\x1b[K"):
    sys.exit("status %d, the terminal ends in %r" % (status, seen[-20:]))
END
rm-pack -q -d uint16 --size 1024x1024 --ao none --depth depth.png \
    -o "$PRIV/large.png"
ok python3 "$PRIV/bar.py" rm-aobake -n1024 "$PRIV/large.png" -o out.png
no_litter depth.png out.png

shim=$B/tests/fault_shim.so
if [ -e "$shim" ]; then
	mkdir "$PRIV/in"
	(cd "$PRIV/in" && sh "$top/tests/fault/inputs.sh")
fi
for job in kills live; do
	if [ $job = kills ]; then
		check 'signals at every kind of system call'
	else
		check 'SIGKILL by the clock, and signals to the tools themselves'
	fi
	if [ ! -e "$shim" ]; then
		skip 'no preloaded library in this build'
		continue
	fi
	# FAULTS=all: at every call
	fault_sweep $job "$shim" "$PRIV/in"
done
