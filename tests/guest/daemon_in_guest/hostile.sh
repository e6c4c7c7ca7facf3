#!/usr/bin/env bash
# Inside the guest, on virtual time: faulty strain amplifiers, one on TCP and one on a serial line,
# while the arm is armed or runs. Each fault causes a trip that names the device, or counted
# failures; the bus recovers without a restart; the control thread misses no deadline.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"
# shellcheck source=tests/guest/daemon_in_guest/rig.sh
. "$(dirname "$0")/rig.sh"

tcp=strain-amplifier-1 rtu=strain-amplifier-2
put_on_serial_line $rtu
check "the config is valid" flexarm config check wire.toml
start_rig
check "the serial line exists" test -c serial
start_daemon

# Reads the journal, because starting `flexarm status` takes longer than a trip.
said() { (($(grep -cE -- "$2" daemon.log) >= $1)); }

# misbehaves NAME FAULT PATTERN: the fault while armed, then its end and a reset.
round=0
misbehaves() {
  round=$((round + 1))
  arm_rig >/dev/null || check "armed" false
  echo "amplifier $1 $2" >&3
  check "$1 $2: trips" within 5 said $round 'Armed -> Tripped'
  check "$1 $2: named" grep -qE -- "-> Tripped: bus-lost: modbus '$1' .*: $3\. " \
    <(grep -e '-> Tripped' daemon.log | tail -n 1)
  echo "amplifier $1 well" >&3
  check "$1 $2: reconnects without a restart" within 10 said $round ': reconnected after'
  press_and_reset >/dev/null
  check "$1 $2: idle" within 2 said $round 'Tripped -> Idle'
}

late='no answer in time' wrong='(malformed reply|connection lost)' gone='connection lost'
misbehaves $tcp "late 30" "$late"
misbehaves $tcp wrong-length "$wrong"
misbehaves $tcp one-behind "$wrong"
misbehaves $tcp flood "$wrong"
misbehaves $tcp away "$gone"
misbehaves $rtu byte-by-byte "$late"
misbehaves $rtu half-frame "$late"
misbehaves $rtu wrong-unit "$wrong"
misbehaves $rtu garbage "$wrong"
misbehaves $rtu away "$gone"

echo "== one late reply during a run is tolerated and counted"
start_run
failed=$(bus $tcp failed)
# The fault is shorter than a period and affects at most one exchange: repeated, at each phase of the
# period, until it affects one. `bus` waits for the daemon's answer, and so for its period.
for phase in $(seq 0 3 119); do
  sleep "0.0$(printf %02d $((phase % 20)))"
  echo "amplifier $tcp late 10" >&3
  sleep 0.004
  echo "amplifier $tcp well" >&3
  sleep 0.06
  if [ "$(bus $tcp failed)" -gt "$failed" ]; then break; fi
done
sleep 1
check "the run continues" refused grep -q 'Running -> ' daemon.log
check "counted" at_least "$(bus $tcp failed)" $((failed + 1))
check "reported" grep -q "$tcp: [0-9]* failed exchanges without loss of the bus" daemon.log

echo "== silent during a run"
echo "amplifier $tcp silent" >&3
check "tripped" within 5 said $((round + 1)) '-> Tripped'
check "the hardware has no power" equal "$(hardware)" "$dead"

kill -TERM $daemon
wait $daemon
grep 'activations' daemon.log
missed_nothing safety control vcan0
run=$(ls -t runs/*.flexarm | head -n 1)
check "the last run replays" equal \
  "$(flexarm replay "$run" --json | jq -c '[.bit_exact, .safety_exact]')" "[true,true]"
stop_rig
conclude
