#!/usr/bin/env bash
# kiln build --execute slurm:FOLDER against a Slurm of our own on loopback: a controller and two nodes, ended by their ids.
# usage: slurm_test.sh KILN
set -euo pipefail
kiln=$(realpath "$1")
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
for tool in slurmctld slurmd sbatch munged; do
  command -v "$tool" >/dev/null || { echo "SKIP: no $tool (Debian's slurm-wlm and munge)"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "SKIP: slurmd needs root"; exit 77; }
t=$(mktemp -d /tmp/kiln-slurm-XXXXXX)
pids=()
finish() {
  for p in "${pids[@]}"; do kill "$p" 2>/dev/null || true; done
  for p in "${pids[@]}"; do
    for _ in $(seq 50); do kill -0 "$p" 2>/dev/null || break; sleep 0.1; done
    kill -9 "$p" 2>/dev/null || true
  done
  rm -rf "$t"
}
trap finish EXIT
fail() { echo "FAILED: $*" >&2; tail -n 20 "$t"/*.log >&2 || true; exit 1; }

# A port that nobody has at this moment, three times.
ports=($(python3 -c '
import socket
held = [socket.socket() for _ in range(3)]
for s in held: s.bind(("127.0.0.1", 0))
print(*(s.getsockname()[1] for s in held))'))
host=$(hostname -s)
mkdir "$t/state" "$t/spool1" "$t/spool2" "$t/shared"
head -c 1024 /dev/urandom >"$t/key" && chmod 600 "$t/key"
chmod 755 "$t"
munged --foreground --force --socket="$t/munge.socket" --key-file="$t/key" --pid-file="$t/munge.pid" --seed-file="$t/seed" \
  --log-file="$t/munged.log" 2>"$t/munge.err.log" &
pids+=($!)
cat >"$t/slurm.conf" <<EOF
ClusterName=kiln
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports[0]}
AuthType=auth/munge
AuthInfo=socket=$t/munge.socket
CryptoType=crypto/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
ReturnToService=2
SchedulerType=sched/builtin
SelectType=select/cons_tres
SlurmUser=root
StateSaveLocation=$t/state
SlurmdSpoolDir=$t/spool-%n
SlurmdPidFile=$t/slurmd-%n.pid
SlurmctldPidFile=$t/slurmctld.pid
SlurmctldLogFile=$t/slurmctld.log
SlurmdLogFile=$t/slurmd-%n.log
SwitchType=switch/none
MinJobAge=60
NodeName=nd1 NodeHostname=$host NodeAddr=127.0.0.1 Port=${ports[1]} CPUs=1
NodeName=nd2 NodeHostname=$host NodeAddr=127.0.0.1 Port=${ports[2]} CPUs=1
PartitionName=all Nodes=nd1,nd2 Default=YES MaxTime=INFINITE State=UP
EOF
export SLURM_CONF=$t/slurm.conf
slurmctld -D -c -f "$SLURM_CONF" >/dev/null 2>&1 &
pids+=($!)
for n in nd1 nd2; do
  mkdir -p "$t/spool-$n"
  slurmd -D -f "$SLURM_CONF" -N "$n" >/dev/null 2>&1 &
  pids+=($!)
done
for _ in $(seq 300); do
  [ "$(timeout 5 sinfo -h -t idle -o %D 2>/dev/null)" = 2 ] && break
  sleep 0.2
done
[ "$(timeout 5 sinfo -h -t idle -o %D)" = 2 ] || fail "the two nodes do not come up"
# The control: Slurm itself runs an array here.
printf '#!/bin/sh\necho done > "%s/control.$SLURM_ARRAY_TASK_ID"\n' "$t" >"$t/control.sh"
timeout 60 sbatch --wait --output=/dev/null --array=0-1 "$t/control.sh" >/dev/null || fail "an array of Slurm's own"
[ -e "$t/control.0" ] && [ -e "$t/control.1" ] || fail "the array ran, and left nothing"

export XDG_CACHE_HOME=$t/cache
cd "$root"
"$kiln" build manifests/sky_light.yaml -o "$t/home.kiln" --cache none >/dev/null
timeout 200 "$kiln" build manifests/sky_light.yaml -o "$t/away.kiln" --cache none --execute "slurm:$t/shared,--partition=all" --report-json "$t/r.json"
cmp "$t/home.kiln" "$t/away.kiln" || fail "another table"
cmp "$t/home.kiln.proof" "$t/away.kiln.proof" || fail "another proof"
python3 - "$t/r.json" <<'EOF' || fail "the array did not do the work"
import json, sys
d = json.load(open(sys.argv[1]))
e = d["execution"]
assert e["failed_batches"] == 0 and e["batches"] >= 2 and e["answered"] == e["questions"] > 0, e
assert d["work"]["compiled"] == d["work"]["translated"] == 0, d["work"]
EOF
[ -z "$(ls "$t/shared")" ] || fail "files were left in the shared folder"

# The same table with one warning, whatever becomes of tasks: they fail, are killed, are lost with their array or their time, and a
# cluster that is not there.
real_worker=$(dirname "$kiln")/kiln-worker
worker() { printf '#!/bin/sh\necho $$ >"%s/started"\n%s\n' "$t" "$1" >"$t/worker"; chmod +x "$t/worker"; rm -f "$t/started" "$t/err"; }
build() { KILN_WORKER=$t/worker timeout 200 "$kiln" build manifests/sky_light.yaml -o "$t/away.kiln" --cache none --execute "slurm:$t/shared$1" "${@:2}" >"$t/out" 2>"$t/err"; }
started() { for _ in $(seq 200); do [ -s "$t/started" ] && return; sleep 0.1; done; fail 'no worker was started'; }
same() {
  cmp "$t/home.kiln" "$t/away.kiln" || fail "$1: another table"
  [ "$(grep -c 'warning: ' "$t/err")" = 1 ] && grep -q -- "$2" "$t/err" || fail "$1: not one warning that says '$2': $(cat "$t/err")"
  rm "$t/away.kiln"
}
idle() {
  for _ in $(seq 100); do [ -z "$(squeue -h)" ] && break; sleep 0.1; done
  [ -z "$(squeue -h)" ] || fail "$1: still queued: $(squeue -h)"
  [ -z "$(ls "$t/shared")" ] || fail "$1: files were left in the shared folder"
}
# The first step's task alone: what the other answered is used.
once() { worker "test -e '$t/$1' || { : >'$t/$1'; $2; }; exec '$real_worker' \"\$@\""; }
once failing 'echo no such thing >&2; exit 9'
build '' --report-json "$t/r.json"
same 'failing once' 'ended with 9: no such thing'
python3 -c 'import json, sys; d = json.load(open(sys.argv[1])); assert d["work"]["compiled"] > 0 == d["work"]["translated"], d["work"]' "$t/r.json" || fail 'failing once'
once killed 'kill -9 $PPID; exec sleep 600'
build ''
same 'a killed task' 'was lost before it ended'
idle 'a killed task'
# Somebody ends the array.
once ended 'exec sleep 600'
build '' &
pid=$!
started
scancel --name=kiln
wait $pid || fail 'a killed array'
same 'a killed array' 'was lost before it ended'
idle 'a killed array'
once late 'exec sleep 600'
build '' --execute-timeout 3
same 'no time left' 'in time'
idle 'no time left'
# Ctrl-C: the array goes with the build.
worker 'exec sleep 600'
KILN_WORKER=$t/worker python3 -c '
import os, signal, subprocess, sys, time
p = subprocess.Popen(sys.argv[2:])
while not os.path.exists(sys.argv[1]): time.sleep(0.1)
p.send_signal(signal.SIGINT)
sys.exit(0 if p.wait(60) == -signal.SIGINT else 1)' "$t/started" "$kiln" build manifests/sky_light.yaml -o "$t/away.kiln" --cache none --execute "slurm:$t/shared" 2>"$t/err" || fail 'interrupted: another end'
[ ! -e "$t/away.kiln" ] || fail 'interrupted: a table'
idle 'interrupted'
worker 'exit 0'
build ',--partition=nowhere'
same 'no cluster' 'sbatch took no array.*nvalid partition'
echo PASS
