#!/usr/bin/env bash
# Inside the guest, on virtual time: the unchanged daemon with its real drivers (CANopen over
# SocketCAN, Modbus/TCP, GPIO lines) against `flexarm rig`, which plays the devices. A whole
# experiment, then a limit switch, a silenced drive and a killed daemon; what the rig's hardware saw
# afterwards is the test. Leaves the experiment's log as /mnt/out/wire.flexarm.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"

cp -a /mnt/share/machine/. /
configs=/usr/local/share/flexarm/config
experiment=$configs/experiments/square-30deg.toml
export FLEXARM_SOCKET=$PWD/flexarmd.sock

modprobe -a vcan can-raw gpio-sim
ip link add vcan0 type vcan
ip link set vcan0 txqueuelen 10 up  # the driver refuses a long queue
mountpoint -q /sys/kernel/config || mount -t configfs none /sys/kernel/config
mkdir -p /sys/kernel/config/gpio-sim/rig/bank
echo 8 >/sys/kernel/config/gpio-sim/rig/bank/num_lines
echo 1 >/sys/kernel/config/gpio-sim/rig/live
chip=$(cat /sys/kernel/config/gpio-sim/rig/bank/chip_name)
sed "s/^chip = .*/chip = \"$chip\"/" $configs/hil-wire.toml >wire.toml
sed -i "s#^extends = .*#extends = \"$configs/thesis-rig.toml\"#" wire.toml

start_rig() {
  rm -f rig.in rig.out
  mkfifo rig.in
  chrt -f 75 flexarm rig -c wire.toml --json <rig.in >rig.out 2>rig.err &
  rig=$!
  exec 3>rig.in
  within 20 grep -q playing rig.err
}

stop_rig() {
  kill $rig
  wait $rig
  exec 3>&-
}

start_daemon() {
  flexarmd --config wire.toml --log-dir runs --socket "$FLEXARM_SOCKET" 2>daemon.log &
  daemon=$!
  within 30 grep -q 'Starting -> Idle' daemon.log
  sleep 1 # at rest for half a second
}

start_run() {
  check "armed" flexarm arm
  check "running" flexarm run $experiment
}

# What the hardware sees now: torque, relay, charge pump.
hardware() {
  : >rig.out
  echo report >&3
  within 5 grep -q torque_nm rig.out
  tail -n 1 rig.out | jq -c '[.torque_nm, .relay_closed, .pump_alive]'
}
dead='[[0,0],false,false]'

echo "== a whole experiment"
start_rig
start_daemon
start_run
within 30 grep -q 'Stopping -> Armed' daemon.log
check "disarmed" flexarm disarm
check "the hardware is dead after it" equal "$(hardware)" "$dead"
kill -TERM $daemon
wait $daemon
check "flexarmd ends with 0" equal $? 0
grep 'activations' daemon.log
for thread in safety control vcan0 strain-amplifier-1 strain-amplifier-2; do
  check "$thread missed and skipped nothing" \
    grep -q " $thread: [0-9]* activations, 0 missed deadlines, 0 skipped periods" daemon.log
done
run=$(ls runs/*.flexarm)
flexarm info "$run" --json >info.json
check "300 of 300 samples" equal "$(jq -c '[.metrics.ticks, .missing_ticks, .trip]' info.json)" \
  "[300,0,null]"
# The in-process backend has 0.75 and 1.09 deg (medians over seeds 1 to 11): within 10 % of that.
check "joint 1 tracks as in process: $(jq -c .metrics.joint_rms_error_deg info.json)" \
  jq -e '.metrics.joint_rms_error_deg[0] < 0.83' info.json
check "joint 2 tracks as in process" jq -e '.metrics.joint_rms_error_deg[1] < 1.20' info.json
check "replays to the bit" equal \
  "$(flexarm replay "$run" --json | jq -c '[.bit_exact, .safety_exact]')" "[true,true]"
cp "$run" /mnt/out/wire.flexarm
stop_rig

echo "== a limit switch opens in mid-run"
start_rig
start_daemon
start_run
sleep 1
echo press limit-1-high 0 >&3
within 5 grep -q 'limit-switch-1-high' daemon.log
check "the hardware is dead" equal "$(hardware)" "$dead"
check "the trip is latched" equal "$(flexarm status --json | jq -r .state)" Tripped
kill -TERM $daemon
wait $daemon
stop_rig

echo "== a drive falls silent in mid-run"
start_rig
start_daemon
start_run
sleep 1
echo node drive2 silent >&3
within 5 grep -q -- '-> Tripped' daemon.log
check "the trip names the drive" \
  grep -q -- '-> Tripped: bus-lost: vcan0: node 2 (drive2): answers no SYNC' daemon.log
check "so does the status" equal "$(flexarm status --json | jq -r .trip.bus)" \
  'vcan0: node 2 (drive2): answers no SYNC'
check "the hardware is dead" equal "$(hardware)" "$dead"
kill -TERM $daemon
wait $daemon
stop_rig

echo "== the daemon is killed in mid-run"
start_rig
start_daemon
start_run
sleep 1
kill -KILL $daemon
sleep 0.2 # drives lose their torque within master_timeout_ms = 100, the pump dies within 5 ms
# The relay keeps its last level when the process dies; the charge pump is what stops.
check "no torque and no pump" equal "$(hardware | jq -c '[.[0], .[2]]')" '[[0,0],false]'
left=$(ls -t runs/*.flexarm | head -n 1)
check "the log left behind replays" equal \
  "$(flexarm replay "$left" --json | jq -c '[.bit_exact, .safety_exact]')" "[true,true]"
stop_rig
conclude
