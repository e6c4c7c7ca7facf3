#!/usr/bin/env bash
# Inside the guest, on virtual time: the unchanged daemon under rtguard (tests/rtguard) on a wired
# rig that has two faults, one after the other, in five states and during a command of an operator.
# 49 runs are a covering array: among them is each pair of values of two of first fault, second
# fault, state, command and time between the faults. Each run ends without power at the hardware,
# a trip that names one of its faults, and a reset. guard_six_pairs.sh has every ninth.
#
# usage: guard_pairs.sh 0..3: a quarter of the runs, every fourth from this one on
# shellcheck disable=SC2154
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"
# shellcheck source=tests/guest/daemon_in_guest/rig.sh
. "$(dirname "$0")/rig.sh"
# shellcheck source=tests/guest/daemon_in_guest/guarded_daemon.sh
. "$(dirname "$0")/guarded_daemon.sh"

# Each with its beginning, its end, and what the trip may be called.
begins=("press limit-1-low 0" "press emergency-stop 0" "amplifier strain-amplifier-1 silent"
  "amplifier strain-amplifier-2 wrong-length" "node drive2 silent" "node drive1 emcy 0x2310"
  "bus-off vcan0")
ends=("press limit-1-low 1" "press emergency-stop 1" "amplifier strain-amplifier-1 well"
  "amplifier strain-amplifier-2 well" "node drive2 well" "node drive1 well" "")
names=(limit-switch-1-low emergency-stop "bus-lost: modbus 'strain-amplifier-1'"
  "bus-lost: modbus 'strain-amplifier-2'" "bus-lost: vcan0: node 2" "drive-fault: vcan0: node 1"
  "bus-lost: vcan0")
states=(Idle Armed Running Stopping Tripped)
commands=(status stop disarm arm reset)
gaps_s=(0 0.005 0.2)

start_rig
start_daemon

came_to_state() { [[ $(state) == "$1" ]]; }
buses_are_ok() { flexarm status --json | jq -e 'all(.buses[]; .ok)' >/dev/null; }
run_slow() { flexarm run --override-switches "emulated machine" slow.toml >/dev/null; }

# bring_to STATE: from Idle.
bring_to() {
  case $1 in
    Idle) return ;;
    Tripped) printf 'press emergency-stop 0\n' >&3 && within 5 came_to_state Tripped &&
      echo 'press emergency-stop 1' >&3 ;;
    *) within 20 arm_rig >/dev/null 2>&1 ;;
  esac || return 1
  case $1 in
    Running) run_slow && sleep 0.5 ;;
    Stopping) run_slow && sleep 0.5 && flexarm stop >/dev/null ;;
  esac
}

# Ends the faults; back to Idle with known angles.
recover() {  # recover FAULT FAULT
  local fault
  for fault; do
    if [[ -n ${ends[fault]} ]]; then echo "${ends[fault]}" >&3; fi
  done
  within 20 buses_are_ok || { flexarm status; return 1; }
  case $(state) in
    Tripped) press_and_reset >/dev/null ;;
    Armed) flexarm disarm >/dev/null ;;
  esac
  within 5 came_to_state Idle || return 1
  within 20 flexarm zero >/dev/null 2>&1
}

pair() {  # pair FIRST SECOND STATE COMMAND GAP_S
  local what="${begins[$1]}, after $5 s ${begins[$2]}, $3, flexarm $4" tripped operator
  if ! bring_to "$3"; then check "$what: is $3" false; fi
  tripped=$(count '-> Tripped')
  flexarm "$4" >/dev/null 2>&1 &
  operator=$!
  echo "${begins[$1]}" >&3
  sleep "$5"
  echo "${begins[$2]}" >&3
  sleep 0.5
  wait $operator
  operator=$?
  check "$what: the command is done or refused" [ $operator -le 1 ]
  check "$what: no power" equal "$(hardware)" "$dead"
  case $3 in
    Armed | Running | Stopping)
      # `disarm` may come before the faults.
      if [[ $4 != disarm ]]; then
        check "$what: trips" at_least "$(count '-> Tripped')" $((tripped + 1))
        check "$what: is named" grep -qE -- "-> Tripped: (${names[$1]}|${names[$2]})" \
          <(grep -e '-> Tripped' daemon.log | tail -n 1)
      fi
      ;;
  esac
  check "$what: recovers" recover "$1" "$2"
}

# The orthogonal array of 49 runs: columns a, b and a + kb of the field of 7 elements, of which
# states, commands and gaps use the remainder.
run=0
for a in {0..6}; do
  for b in {0..6}; do
    if ((run % ${every:-4} == ${1:-0})); then
      pair "$a" "$b" "${states[(a + b) % 7 % 5]}" "${commands[(a + 2 * b) % 7 % 5]}" \
        "${gaps_s[(a + 3 * b) % 7 % 3]}"
    fi
    run=$((run + 1))
  done
done
ends 0 safety control vcan0 'strain-a~fier-1' 'strain-a~fier-2'
stop_rig
conclude
