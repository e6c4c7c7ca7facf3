#!/usr/bin/env bash
# Inside the guest, on virtual time: strain amplifiers that do everything wrong, one on TCP and one
# on a serial line, while the arm is armed or runs. Each way ends in a trip that names the device
# or in failures that are counted; the bus comes back without a restart; and the control thread
# misses nothing in all of it.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"
# shellcheck source=tests/guest/daemon_in_guest/rig.sh
. "$(dirname "$0")/rig.sh"

tcp=strain-amplifier-1 rtu=strain-amplifier-2
# The second amplifier moves to a serial line: the rig makes it, the daemon opens it. The line's own
# time takes more of the period.
sed -i -e '/^port = 15022$/d' -e "/^name = \"$rtu\"$/,/^response/{
  s/^transport = .*/transport = \"rtu\"/
  s#^host = .*#device = \"$PWD/serial\"\nbaud = 230400\nparity = \"even\"\ndata_bits = 8\nstop_bits = 1#
  s/^response.*/response_timeout_ms = 2.0/
}" wire.toml
printf '[loop]\nacquire_before_ms = 14.0\nstep_deadline_ms = 4.0\n' >>wire.toml
check "the config is one" flexarm config check wire.toml
start_rig || exit 1
check "the serial line is there" test -c serial
start_daemon

# What the journal says is looked at, not asked for: to start a program takes longer than to trip.
said() { (($(grep -cE -- "$2" daemon.log) >= $1)); }

# misbehaves NAME HOW PATTERN: armed, then mended and reset.
round=0
misbehaves() {
  round=$((round + 1))
  flexarm arm >/dev/null || check "armed" false
  echo "amplifier $1 $2" >&3
  check "$1 $2: trips" within 5 said $round 'Armed -> Tripped'
  check "$1 $2: named" grep -qE -- "-> Tripped: bus-lost: modbus '$1' .*: $3\. " \
    <(grep -e '-> Tripped' daemon.log | tail -n 1)
  echo "amplifier $1 well" >&3
  check "$1 $2: back without a restart" within 10 said $round ' back, after'
  press_and_reset >/dev/null
  check "$1 $2: idle" within 2 said $round 'Tripped -> Idle'
}

late='no answer in time' wrong='(an answer that is none|connection lost)' gone='connection lost'
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

echo "== one late reply in mid-run is survived and counted"
start_run
failed=$(bus $tcp failed)
# Well within a period, so that it meets one exchange or none: until it has met one.
for _ in $(seq 50); do
  echo "amplifier $tcp late 10" >&3
  sleep 0.004
  echo "amplifier $tcp well" >&3
  sleep 0.1
  if [ "$(bus $tcp failed)" -gt "$failed" ]; then break; fi
done
sleep 1
check "the run goes on" refused grep -q 'Running -> ' daemon.log
check "counted" at_least "$(bus $tcp failed)" $((failed + 1))
check "told" grep -q "$tcp: [0-9]* failed exchanges, survived" daemon.log

echo "== silent in mid-run"
echo "amplifier $tcp silent" >&3
check "tripped" within 5 said $((round + 1)) '-> Tripped'
check "the hardware is dead" equal "$(hardware)" "$dead"

kill -TERM $daemon
wait $daemon
grep 'activations' daemon.log
missed_nothing safety control vcan0
run=$(ls -t runs/*.flexarm | head -n 1)
check "the last run replays" equal \
  "$(flexarm replay "$run" --json | jq -c '[.bit_exact, .safety_exact]')" "[true,true]"
stop_rig
conclude
