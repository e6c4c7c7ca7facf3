#!/usr/bin/env bash
# Inside the guest, on virtual time: the unchanged daemon under rtguard (tests/rtguard), which ends
# it when a real-time thread uses the heap, waits for a lock, makes a system call outside its list,
# has a page fault, or when the safety thread is switched away. The simulated rig goes through its
# states, with each switch that opens in mid move and a limit that is exceeded. guard_faults.sh has
# the wired rig.
# shellcheck disable=SC2154
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"
# shellcheck source=tests/guest/daemon_in_guest/rig.sh
. "$(dirname "$0")/rig.sh"
# shellcheck source=tests/guest/daemon_in_guest/guarded_daemon.sh
. "$(dirname "$0")/guarded_daemon.sh"

came_to() { within "$1" grep -q -- "$2" daemon.log; }

start_simulated() {  # start_simulated STATE_FOLDER OPTION..
  flexarmd --config $configs/hil.toml --log-dir runs --socket "$FLEXARM_SOCKET" \
    --state-dir "$PWD/$1" "${@:2}" 2>daemon.log &
  daemon=$!
  check "started" came_to 300 'Starting -> '
}

event() {  # event EXPERIMENT WHAT: that experiment, in which it happens
  cat "$1"
  printf '[[sim_event]]\nat_s = 0.5\n%s\n' "$2"
}

echo "== every state"
start_simulated state
press_sim() { flexarm sim reset-button 1 >/dev/null; sleep 0.1; flexarm sim reset-button 0 >/dev/null; }
reset_sim() { press_sim; within 20 flexarm reset 2>/dev/null; }
arm_sim() { within 10 flexarm arm 2>/dev/null; }
arm_sim
check "a run" flexarm run $experiment
sleep 1
check "stopped" flexarm stop
check "armed again" came_to 10 'Stopping -> Armed'
check "disarmed" flexarm disarm
for line in limit-1-low limit-1-high limit-2-low limit-2-high emergency-stop; do
  arm_sim
  flexarm run slow.toml >/dev/null
  sleep 1
  flexarm sim $line 0 >/dev/null
  check "$line trips in mid-move" within 5 grep -q -- "Running -> Tripped: ${line/limit-/limit-switch-}" daemon.log
  flexarm sim $line 1 >/dev/null
  check "reset after $line" reset_sim
done
check "tare" within 20 flexarm tare  # refused while the links still vibrate
check "zero" within 20 flexarm zero
ends 0 safety control plant

echo "== a fault stop, by a payload that bends the links too far"
event quick.toml "payload_kg = 6.0" >too-heavy.toml
start_simulated state-2
arm_sim
check "a run" flexarm run too-heavy.toml
check "damped" came_to 10 'Running -> FaultStopping'
check "tripped" came_to 10 'FaultStopping -> Tripped'
ends 1 safety control plant

for fault in "plant \(stale-frame\|no-counter-reading\)" "control control-heartbeat-lost"; do
  echo "== the thread ${fault% *} stands still"
  event slow.toml "freeze = \"${fault% *}\"" >frozen.toml
  start_simulated "state-${fault% *}"
  arm_sim
  check "a run" flexarm run frozen.toml
  check "tripped" came_to 10 "Running -> Tripped: ${fault#* }"
  ends 1 safety control plant
done

echo "== a daemon that is killed, and the next one"
event slow.toml "kill = true" >killed.toml
start_simulated state-killed
arm_sim
check "a run" flexarm run killed.toml
wait $daemon
check "flexarmd is killed" equal $? $((128 + 9))
start_simulated state-killed
check "it starts tripped" grep -q -- 'Starting -> Tripped: ended-while-armed' daemon.log
check "reset" reset_sim
ends 0 safety control plant

echo "== a law that plans while it runs"
start_simulated state-3 --set controller.name=receding-horizon
arm_sim
check "a run" flexarm run $configs/experiments/moves.toml
sleep 4
check "stopped" flexarm stop
ends 0 safety control plant planner

if ((failures > 0)) && [[ -e $report ]]; then cat "$report"; fi
conclude
