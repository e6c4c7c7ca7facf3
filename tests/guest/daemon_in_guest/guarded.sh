#!/usr/bin/env bash
# Inside the guest, on virtual time: the unchanged daemon under rtguard (tests/rtguard), which ends
# it when a real-time thread uses the heap, waits for a lock, makes a system call outside its list,
# has a page fault, or when the safety thread is switched away. The simulated and the wired rig go
# through every state but those of the test of the power path, with faults of switches, drives and
# amplifiers and, simulated, a limit that is exceeded: docs/guest.md lists them.
# shellcheck disable=SC2154
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"
# shellcheck source=tests/guest/daemon_in_guest/rig.sh
. "$(dirname "$0")/rig.sh"
# shellcheck source=tests/guest/daemon_in_guest/guarded_daemon.sh
. "$(dirname "$0")/guarded_daemon.sh"

came_to() { within "$1" grep -q -- "$2" daemon.log; }
again() { (($(count "$2") > $1)); }

echo "== simulated: every state"
flexarmd --config $configs/hil.toml --log-dir runs --state-dir "$PWD/sim-state" \
  --socket "$FLEXARM_SOCKET" 2>daemon.log &
daemon=$!
check "idle" came_to 300 'Starting -> Idle'
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

echo "== simulated: a fault stop, by a payload that bends the links too far"
cat >too-heavy.toml <<'TOML'
name = "too-heavy"
duration_s = 8.0
[[move]]
start_s = 0.0
duration_s = 1.0
to_deg = [40.0, 0.0]
[[sim_event]]
at_s = 0.5
payload_kg = 6.0
TOML
flexarmd --config $configs/hil.toml --log-dir runs --state-dir "$PWD/sim-state-2" \
  --socket "$FLEXARM_SOCKET" 2>daemon.log &
daemon=$!
check "idle" came_to 300 'Starting -> Idle'
arm_sim
check "a run" flexarm run too-heavy.toml
check "damped" came_to 10 'Running -> FaultStopping'
check "tripped" came_to 10 'FaultStopping -> Tripped'
ends 1 safety control plant

echo "== simulated: a law that plans while it runs"
flexarmd --config $configs/hil.toml --set controller.name=receding-horizon --log-dir runs \
  --state-dir "$PWD/sim-state-3" --socket "$FLEXARM_SOCKET" 2>daemon.log &
daemon=$!
check "idle" came_to 300 'Starting -> Idle'
arm_sim
check "a run" flexarm run $configs/experiments/moves.toml
sleep 4
check "stopped" flexarm stop
ends 0 safety control plant planner

echo "== wired: faults of switches, an amplifier and drives"
start_rig
start_daemon
start_run
sleep 1
check "stopped" flexarm stop
check "armed again" came_to 10 'Stopping -> Armed'
check "disarmed" flexarm disarm

trips() {  # trips WHAT PATTERN FAULT END: while armed; then its end, and a reset
  local before
  arm_rig >/dev/null || check "armed" false
  before=$(count '-> Tripped')
  echo "$3" >&3
  check "$1 trips" within 5 again "$before" '-> Tripped'
  check "$1 is named" grep -q -- "-> Tripped: $2" <(grep -e '-> Tripped' daemon.log | tail -n 1)
  echo "$4" >&3
  sleep 0.5
  check "reset after it" press_and_reset
}
trips "a limit switch" limit-switch-1-low "press limit-1-low 0" "press limit-1-low 1"
trips "the emergency stop" emergency-stop "press emergency-stop 0" "press emergency-stop 1"
for fault in silent "late 30" wrong-length one-behind flood away; do
  trips "an amplifier that is $fault" bus-lost "amplifier strain-amplifier-1 $fault" \
    "amplifier strain-amplifier-1 well"
  within 10 bus_is_ok strain-amplifier-1
done
trips "a drive that is silent" bus-lost "node drive2 silent" "node drive2 well"
trips "a drive in fault" drive-fault "node drive1 emcy 0x2310" "node drive1 well"
ends 0 safety control vcan0 'strain-a~fier-1' 'strain-a~fier-2'  # Linux keeps 15 characters of a name
stop_rig
if ((failures > 0)) && [[ -e $report ]]; then cat "$report"; fi
conclude
