#!/usr/bin/env bash
# Inside the guest, on virtual time: what wire.sh leaves out. The daemon without real time, a silent
# drive, a drive's fault, and a daemon that crashes; the script checks the resulting outputs at the
# devices.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"

# shellcheck source=tests/guest/daemon_in_guest/rig.sh
. "$(dirname "$0")/rig.sh"

echo "== without real time"
start_rig
flexarmd --config wire.toml --log-dir runs --socket "$FLEXARM_SOCKET" --without-realtime \
  2>daemon.log &
daemon=$!
within 30 grep -q 'Starting -> Idle' daemon.log
check "a rig is not armed without real time" refused flexarm arm
check "the status says why" equal \
  "$(flexarm status --json | jq -r '.host | "\(.verdict) \(.findings[0].name)"')" \
  "not-ready real-time"
check "the hardware has no power" equal "$(hardware)" "$dead"
kill -TERM $daemon
wait $daemon
stop_rig

echo "== a drive becomes silent during a run"
start_rig
start_daemon
start_run
sleep 1
echo node drive2 silent >&3
within 5 grep -q -- '-> Tripped' daemon.log
check "the trip names the drive" \
  grep -q -- '-> Tripped: bus-lost: vcan0: node 2 (drive2): does not answer SYNC' daemon.log
check "the status names it too" equal "$(flexarm status --json | jq -r .trip.bus)" \
  'vcan0: node 2 (drive2): does not answer SYNC'
check "the hardware has no power" equal "$(hardware)" "$dead"
kill -TERM $daemon
wait $daemon
stop_rig

echo "== a drive's fault stays until the operator resets"
emergency='vcan0: node 1 (drive1): emergency message 0x2310'
start_rig
start_daemon
echo node drive1 emcy 0x2310 >&3
check "the trip names it" within 5 grep -q -- "-> Tripped: drive-fault: $emergency" daemon.log
sleep 2
check "it is still there" equal "$(bus vcan0 fault)" "$emergency"
check "of a bus that answers" bus_is_ok vcan0
check "reset" press_and_reset
check "it is gone" equal "$(bus vcan0 fault)" null
check "and the angles are known" equal \
  "$(flexarm status --json | jq -c .joint_angle_unknown)" '[null,null]'
start_run
kill -TERM $daemon
wait $daemon
stop_rig

echo "== the daemon crashes during a run"
start_rig
start_daemon
start_run
sleep 1
check "the relay is closed" equal "$(hardware | jq -c '.[1:]')" '[true,true]'
kill -SEGV $daemon
wait $daemon
check "flexarmd ends by the signal" equal $? $((128 + 11))
check "it has taken the power away" grep -q \
  "flexarmd: SIGSEGV in thread '.*': relay and charge pump are off, the daemon ends" daemon.log
sleep 0.2 # drives lose their torque within master_timeout_ms = 100, the pump dies within 5 ms
check "the hardware has no power" equal "$(hardware)" "$dead"
stop_rig
conclude
