#!/usr/bin/env bash
# Inside the guest, on virtual time: the unchanged daemon under rtguard (tests/rtguard) on a wired
# rig that has each fault of `flexarm rig` once. Each trips and is named, and a reset follows.
#
# usage: guard_faults.sh tcp|serial|readings|can|power
#   tcp       a run and a stop; each switch, and replies of an amplifier on Modbus/TCP, while armed
#   serial    replies of an amplifier on a serial line, while armed
#   readings  wrong readings of an amplifier, in a move
#   can       drives and encoders, and bus-off, while armed
#   power     the test of the power path, with drives that the relay feeds, and FaultStopping
# shellcheck disable=SC2154
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"
# shellcheck source=tests/guest/daemon_in_guest/rig.sh
. "$(dirname "$0")/rig.sh"
# shellcheck source=tests/guest/daemon_in_guest/guarded_daemon.sh
. "$(dirname "$0")/guarded_daemon.sh"

amplifier1=strain-amplifier-1 amplifier2=strain-amplifier-2

# Of the journal: starting `flexarm status` takes longer than a trip.
last_change() { grep -oE '[A-Za-z]+ -> [A-Za-z]+.*' daemon.log | tail -n 1; }
came_to() { [[ $(last_change) == *"-> $1"* ]]; }
armed() { check "armed" within 20 arm_quietly; }
arm_quietly() { arm_rig >/dev/null 2>&1; }
zero_quietly() { flexarm zero >/dev/null 2>&1; }
more_than() { (($(count "$2") > $1)); }

# fault FAULT END PATTERN: in the present state; its trip, its end, and a reset.
fault() {
  local before
  before=$(count '-> Tripped')
  echo "$1" >&3
  within 5 more_than "$before" '-> Tripped'
  check "$1: trips as $3" grep -qE -- "-> Tripped: $3" <(last_change)
  if ! kill -0 "$daemon"; then
    check "$1: the daemon goes on" false
    ends 0
    conclude
  fi
  echo "$2" >&3
  if came_to Tripped; then check "$1: reset" within 20 press_and_reset; fi
}

replies() {  # replies AMPLIFIER FAULT..: each means that the bus is lost
  local what
  for what in "${@:2}"; do
    armed
    fault "amplifier $1 $what" "amplifier $1 well" "bus-lost: modbus '$1' "
  done
}

to_and_fro() {  # to_and_fro DEG SECONDS: a run of moves
  local i
  {
    printf 'name = "to-and-fro"\nduration_s = 30.0\n'
    for i in {0..13}; do
      printf '[[move]]\nstart_s = %d.0\nduration_s = %s\nto_deg = [%d, %d]\n' $((2 * i)) "$2" \
        $((i % 2 ? -$1 : $1)) $((i % 2 ? $1 : -$1))
    done
  } >to-and-fro.toml
  armed
  check "running" flexarm run --override-switches "emulated machine" to-and-fro.toml
}

tcp() {
  start_rig
  start_daemon
  start_run
  sleep 1
  check "stopped" flexarm stop
  check "armed again" within 10 came_to Armed
  check "disarmed" flexarm disarm
  local line
  for line in limit-1-low limit-1-high limit-2-low limit-2-high emergency-stop; do
    armed
    fault "press $line 0" "press $line 1" "${line/limit-/limit-switch-}"
  done
  replies $amplifier1 silent "late 30" one-behind byte-by-byte wrong-transaction wrong-protocol \
    wrong-length wrong-unit wrong-function long-payload short-payload huge-payload garbage \
    three-bytes half-frame half-frame-then-close exception flood reset close never-reads away
  armed  # each second reply comes unasked: an exchange fails now and then
  fault "amplifier $amplifier1 twice" "amplifier $amplifier1 well" "bus-unreliable: $amplifier1: "
}

serial() {
  put_on_serial_line $amplifier2
  start_rig
  start_daemon
  replies $amplifier2 silent "late 30" bad-checksum byte-by-byte half-frame wrong-unit \
    wrong-function short-payload garbage exception away
}

readings() {
  local what
  start_rig
  start_daemon
  for what in frozen "stuck 0" "inverted 0" "scaled 0 3"; do
    to_and_fro 6 1.5
    sleep 0.7
    fault "amplifier $amplifier1 $what" "amplifier $amplifier1 well" strain-
  done
  # Fast enough for the readings of the two gauges to differ by 0.9e-3: a channel may be 0.4e-3 from
  # the fit. After the trip the arm coasts to its switches: no reset.
  to_and_fro 15 1.0
  echo "amplifier $amplifier1 swapped 0 9" >&3
  check "swapped: trips" within 5 came_to "Tripped: strain-"
}

can() {
  local node
  start_rig
  start_daemon
  node() {  # node ROLE FAULT NAME
    armed
    fault "node $1 $2" "node $1 well" "$3"
    check "$1 $2: zero" within 20 zero_quietly  # an encoder that was lost does not know its angle
  }
  for node in "drive1 drive-fault: vcan0: node 1" "rotor2 bus-lost: vcan0: node 14"; do
    set -- "${node%% *}" "${node#* }"
    node "$1" silent "bus-lost: vcan0: "
    node "$1" power-cycle "$2"
    node "$1" no-answer "bus-lost: vcan0: "
    node "$1" no-heartbeat "$2"
    node "$1" short-pdo "bus-lost: vcan0: "
    node "$1" "emcy 0x2310" "$2"
    echo "node $1 another-product" >&3
    node "$1" power-cycle "$2"  # what comes back is another product
  done
  armed
  fault "bus-off vcan0" "" "bus-lost: vcan0: the CAN controller has left the bus"
}

power() {
  local test
  printf '[hal.gpiod.drive_voltage]\nrise_ms = 500\nfall_ms = 1000\n' >>wire.toml
  start_rig --relay-feeds-drives --payload-kg 6  # too heavy for its links
  start_daemon
  for test in Pump Relay Power; do
    arm_quietly &  # it answers when the arm is armed
    check "in the test" within 20 came_to "Testing$test"
    fault "press emergency-stop 0" "press emergency-stop 1" emergency-stop
    wait $!
  done
  armed
  check "the power path is tested, channel by channel" equal "$(grep -oE '[A-Za-z]+ -> [A-Za-z]+' daemon.log | tail -n 4)" \
    'Idle -> TestingPump
TestingPump -> TestingRelay
TestingRelay -> TestingPower
TestingPower -> Armed'
  check "a run" flexarm run --override-switches "emulated machine" quick.toml
  check "damped" within 10 grep -q -- 'Running -> FaultStopping: bending-strain-2' daemon.log
  check "tripped" within 10 came_to Tripped
  check "the hardware has no power" equal "$(hardware)" "$dead"
  # The arm has coasted beyond its switches: no reset.
}

case $1 in
  tcp) tcp ;;
  serial) serial ;;
  readings) readings ;;
  can) can ;;
  power) power ;;
esac
# Linux keeps 15 characters of a name.
ends "$(came_to Tripped && echo 1 || echo 0)" safety control vcan0 'strain-a~fier-1' 'strain-a~fier-2'
stop_rig
conclude
