# The example project on Slurm, on this machine alone: the same bytes as here,
# also where a job was requeued. As root, with slurm-wlm and munge installed:
#
#	tests/cli/run tests/cli/slurm.sh
# SPDX-License-Identifier: MIT
. "$LIB"
PATH=$PATH:/usr/sbin:/sbin
need make pkg-config munged slurmctld slurmd sbatch srun scontrol squeue \
    sinfo rm-pack rm-combine
if [ "$(id -u)" -ne 0 ]; then
	check 'all of this script'
	skip 'not root'
	exit 0
fi

# All state of the daemons is in here; they listen on loopback alone.
slurm=$PRIV/slurm
run=$slurm/run
stop() {
	for name in slurmd slurmctld munged; do
		pid=$(cat "$run/$name.pid" 2>/dev/null) || continue
		kill "$pid" 2>/dev/null || continue
		n=0
		while [ $n -lt 25 ] && kill -0 "$pid" 2>/dev/null; do
			sleep 0.2
			n=$((n + 1))
		done
		kill -9 "$pid" 2>/dev/null || :
	done
}
ended() {
	status=$?
	stop
	(exit $status)
	finish
}
trap ended EXIT
trap 'exit 1' HUP INT TERM

free_port() {
	python3 -c 'import socket
s = socket.socket()
s.bind(("127.0.0.1", 0))
print(s.getsockname()[1])'
}
# munged wants its folders to be writable by nobody else
chmod 755 "$PRIV/.." "$PRIV"
mkdir -p "$run" "$slurm/state" "$slurm/spool"
host=$(hostname -s)
(umask 077 && head -c 32 /dev/urandom >"$slurm/key")
cat >"$slurm/slurm.conf" <<END
ClusterName=relief
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$run/munge
CommunicationParameters=NoInAddrAny
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$run/slurmctld.pid
SlurmdPidFile=$run/slurmd.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd.log
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
SLURM_CONF=$slurm/slurm.conf
export SLURM_CONF

check 'munged, slurmctld and slurmd start'
exits 0 timeout 20 munged --key-file="$slurm/key" --socket="$run/munge" \
    --pid-file="$run/munged.pid" --log-file="$slurm/munged.log" \
    --seed-file="$slurm/seed"
exits 0 timeout 20 slurmctld -f "$SLURM_CONF" -c
exits 0 timeout 20 slurmd -f "$SLURM_CONF"
n=0
until timeout 5 sinfo -h -o %t 2>/dev/null | grep -q '^idle'; do
	n=$((n + 1))
	if [ $n -eq 20 ]; then
		bad 'no node is idle:' "$(tail -n 5 "$slurm"/*.log)"
		exit 0
	fi
	sleep 1
done

copy_project
mkdir "$PRIV/bin"

# rm-combine's first start takes long: that job is requeued.
rm_combine=$(command -v rm-combine)
cat >"$PRIV/bin/rm-combine" <<END
#!/bin/sh
echo start >>'$PRIV/combines'
[ "\$(grep -c . '$PRIV/combines')" -gt 1 ] || exec sleep 300
exec '$rm_combine' "\$@"
END
chmod +x "$PRIV/bin/rm-combine"

bytes() {
	(cd "$1" && find . -type f ! -path '*/.relief/*' -exec cksum {} + |
		sort -k 3)
}

check 'the project with -j 200 and a requeued job: the same bytes as here'
exits 0 make -C project RELIEF_OUT="$PWD/here" -j2
PATH=$PRIV/bin:$PATH timeout 100 make -C project RELIEF_OUT="$PWD/there" \
    -j200 RELIEF_LAUNCH=slurm >"$PRIV/make.log" 2>&1 &
make=$!
n=0
until [ -s "$PRIV/combines" ] || [ $n -eq 300 ]; do
	sleep 0.2
	n=$((n + 1))
done
job=$(timeout 10 squeue -h -t running -n "relief:$PWD/there/wall_relief.png" \
    -o %i)
exits 0 timeout 10 scontrol requeue "$job"
# Slurm would wait two minutes, until the old run's credential is void
n=0
until timeout 10 squeue -h -t pending -j "$job" -o %i | grep -q . ||
    [ $n -eq 50 ]; do
	sleep 0.2
	n=$((n + 1))
done
exits 0 timeout 10 scontrol update "JobId=$job" StartTime=now
wait "$make" || bad "make fails: $(tail -n 5 "$PRIV/make.log")"
equal "$(grep -c . "$PRIV/combines")" 2 'starts of rm-combine'
equal "$(timeout 10 scontrol show job "$job" | grep -o 'Restarts=[0-9]*')" \
    Restarts=1 'the requeued job'
bytes here >"$PRIV/want"
bytes there >"$PRIV/got"
same_bytes "$PRIV/got" "$PRIV/want"
equal "$(find there -name '*.log' -o -name '*.status.*')" '' litter
exits 0 make -C project RELIEF_OUT="$PWD/there" -q

check 'a job that fails: what its tool says'
exits 2 timeout 60 make -C project RELIEF_OUT="$PWD/there" -j200 \
    RELIEF_LAUNCH=slurm "jeans_ROUGHEN_FLAGS=--frob 'it''s'"
stderr_has 'rm-roughen: .*--frob'

check 'a make that is ended takes its jobs along'
: >"$PRIV/combines"
PATH=$PRIV/bin:$PATH timeout 60 make -C project RELIEF_OUT="$PWD/there" \
    -j200 RELIEF_LAUNCH=slurm wall_COMBINE_FLAGS='-d uint16' \
    >"$PRIV/make.log" 2>&1 &
make=$!
n=0
until [ -s "$PRIV/combines" ] || [ $n -eq 150 ]; do
	sleep 0.2
	n=$((n + 1))
done
# timeout hands it on
kill -TERM "$make"
wait "$make" || :
sleep 1
equal "$(timeout 10 squeue -h -t pending,running -o %j)" '' 'jobs left'

check 'srun'
exits 0 timeout 60 make -C project RELIEF_OUT="$PWD/there" -j200 \
    RELIEF_LAUNCH=srun
bytes there >"$PRIV/got"
same_bytes "$PRIV/got" "$PRIV/want"
