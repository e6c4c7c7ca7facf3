#!/usr/bin/env bash
# tools/cluster/flexarm-shards.sbatch under Slurm: a controller and a node of this machine alone, a task
# that is killed and continues, the parts merged, and the same rows as without Slurm.
#
# usage: tests/cluster/slurm_test.sh BUILD
set -euo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
bin=$(cd "$1" && pwd)/bin
folder=$(mktemp -d "${TMPDIR:-/tmp}/flexarm slurm.XXXXXX")
# Slurm's own paths have no spaces.
slurm=$(mktemp -d /tmp/flexarm-slurm.XXXXXX)
shards=4
daemons=()

finish() {
  local code=$?
  # One that has ended already is no failure of the test.
  for pid in "${daemons[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait
  if ((code != 0)); then
    for log in "$slurm"/*.log "$folder"/slurm-*.out; do
      [[ -f $log ]] && { echo "--- $log"; tail -n 20 "$log"; }
    done
  fi
  rm -rf "$slurm" "$folder"
  exit "$code"
}
trap finish EXIT

free_port() {
  python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

wait_for() {  # wait_for SECONDS COMMAND..: until it succeeds
  local until=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    ((SECONDS < until)) || { echo "slurm_test: timed out: $*" >&2; exit 1; }
    sleep 0.2
  done
}

start_slurm() {
  local host
  host=$(hostname -s)
  export SLURM_CONF=$slurm/slurm.conf
  mkdir -m 700 "$slurm/munge" "$slurm/state" "$slurm/spool"
  head -c 128 /dev/urandom >"$slurm/munge/key"
  chmod 400 "$slurm/munge/key"
  cat >"$SLURM_CONF" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$slurm/munge/socket
CryptoType=crypto/munge
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobRequeue=1
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
  munged --foreground --force --key-file "$slurm/munge/key" --socket "$slurm/munge/socket" \
    --pid-file "$slurm/munge/pid" --log-file "$slurm/munge.log" --seed-file "$slurm/munge/seed" >"$slurm/munged.log" 2>&1 &
  daemons+=($!)
  wait_for 20 munge -n --socket "$slurm/munge/socket"
  slurmctld -D >"$slurm/slurmctld.log" 2>&1 &
  daemons+=($!)
  slurmd -D >"$slurm/slurmd.log" 2>&1 &
  daemons+=($!)
  wait_for 60 node_is_idle
}

node_is_idle() { [[ $(sinfo -h -o %t) == idle ]]; }
has_ended() { [[ -z $(squeue -h -j "$1" -t RUNNING,COMPLETING) ]]; }
none_left() { [[ -z $(squeue -h) ]]; }
has_rows() { [[ -f $1 ]] && (($(sqlite3 "$1" 'SELECT count(*) FROM run') > 0)); }

sweep=(-c "$root/config/hil.toml" --over controller.alpha=0:0.25:5 --seeds 1..8)
points=168
cd "$folder"
export FLEXARM=$bin/flexarm PATH=$bin:$PATH

start_slurm
job=$(sbatch --parsable --array=1-$shards "$root/tools/cluster/flexarm-shards.sbatch" "$folder/parts" \
  sweep "${sweep[@]}")
# A task dies in the middle and is run again: it continues its part.
wait_for 60 has_rows "$folder/parts/part-1.sqlite"
scontrol requeue "${job}_1"
wait_for 60 has_ended "${job}_1"
before=$(sqlite3 "$folder/parts/part-1.sqlite" 'SELECT count(*) FROM run')
((before < points / shards)) || { echo "slurm_test: task 1 ended too early" >&2; exit 1; }
scontrol update jobid="${job}_1" starttime=now
wait_for 240 none_left
grep -qE '[1-9][0-9]* were in the file' "slurm-${job}_1.out"

flexarm sweep merge parts/part-*.sqlite -o all.sqlite
flexarm sweep "${sweep[@]}" -o alone.sqlite >/dev/null
rows() { sqlite3 "$1" 'SELECT point, completed, joint1_rms_error_deg, peak_torque1_nm FROM run ORDER BY point'; }
[[ $(rows all.sqlite | wc -l) == "$points" ]]
cmp <(rows all.sqlite) <(rows alone.sqlite)

# A task that fails leaves no part, and the merge names what is missing.
if sbatch --wait --array=1-2 "$root/tools/cluster/flexarm-shards.sbatch" "$folder/bad" \
  sweep -c "$root/config/missing.toml"; then
  echo "slurm_test: a campaign without its config ended well" >&2
  exit 1
fi
# The summaries of a torture.
sbatch --wait --array=1-2 "$root/tools/cluster/flexarm-shards.sbatch" "$folder/torture" \
  torture -c "$root/config/hil.toml" --seeds 1..20
python3 - "$folder"/torture/part-*.json <<'PY'
import json
import sys
parts = [json.load(open(name, encoding="utf-8")) for name in sys.argv[1:]]
assert len(parts) == 2 and sum(part["scenarios"] for part in parts) == 20, parts
PY
echo "slurm_test: $shards tasks, one requeued after $before of $((points / shards)) runs; $points rows equal to those without Slurm"
