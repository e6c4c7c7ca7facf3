# Sourced inside the guest: the machine that `cmake --install` made, a CAN interface and GPIO lines,
# and the programs between them: `flexarm rig`, which emulates the devices, and the unchanged daemon
# with its real drivers.
# shellcheck shell=bash disable=SC2034,SC2154

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

# put_on_serial_line AMPLIFIER: the second one, in wire.toml. The rig creates the line, the daemon
# opens it. It is slower, and needs more of the period.
put_on_serial_line() {
  sed -i -e '/^port = 15022$/d' -e "/^name = \"$1\"$/,/^response/{
    s/^transport = .*/transport = \"rtu\"/
    s#^host = .*#device = \"$PWD/serial\"\nbaud = 230400\nparity = \"even\"\ndata_bits = 8\nstop_bits = 1#
    s/^response.*/response_timeout_ms = 2.0/
  }" wire.toml
  printf '[loop]\nacquire_before_ms = 14.0\nstep_deadline_ms = 4.0\n' >>wire.toml
}

start_rig() {  # start_rig OPTION..: of `flexarm rig`
  failures_before=$failures
  rm -f rig.in rig.out
  mkfifo rig.in
  chrt -f 75 flexarm rig -c wire.toml --json "$@" <rig.in >>rig.out 2>rig.err &
  rig=$!
  exec 3>rig.in
  check "the rig is emulated" within 20 grep -q emulating rig.err
}

stop_rig() {
  if ((failures > failures_before)); then tail -n 40 daemon.log rig.err; fi
  kill $rig
  wait $rig
  exec 3>&-
}

# With a state folder of its own, in which no daemon before it has tripped.
start_daemon() {
  kept=$(mktemp -d "$PWD/state.XXXXXX")
  restart_daemon Idle
}

# restart_daemon STATE: with the state folder of the daemon before; STATE is the safety state in
# which it must start.
restart_daemon() {
  flexarmd --config wire.toml --log-dir runs --state-dir "$kept" --socket "$FLEXARM_SOCKET" \
    2>daemon.log &
  daemon=$!
  check "the daemon starts in $1" within 300 grep -q "Starting -> $1" daemon.log
  sleep 1 # at rest for half a second
}

# The machine is emulated, and its clock is that of its host: it need not be good enough for a rig.
arm_rig() { flexarm arm --override-host "emulated machine"; }

# A person at the rig who proves each switch, as `flexarm prove-switches` asks.
prove_switches() {
  local switch
  flexarm prove-switches >prove.txt &
  local proof=$!
  within 5 grep -q 'step 1 of' prove.txt
  for switch in limit-1-low limit-1-high limit-2-low limit-2-high emergency-stop; do
    operate_switch $switch 0 1  # by hand
    operate_switch $switch 0 1  # the connector
  done
  operate_switch reset-button 1 0
  wait $proof
}
operate_switch() {  # operate_switch LINE AWAY BACK: slower than flexarm asks for the step
  echo "press $1 $2" >&3
  sleep 0.3
  echo "press $1 $3" >&3
  sleep 0.3
}

# With the switches as the proof has left them: a run without one needs an override.
start_run() {
  check "armed" arm_rig
  check "running" flexarm run --override-switches "emulated machine" $experiment
}

# The present outputs at the devices: torque, relay, charge pump.
hardware() {
  : >rig.out
  echo report >&3
  within 5 grep -q torque_nm rig.out
  # jq 1.7 (Debian 13) prints 0.0 as it was read, a sum as 0.
  tail -n 1 rig.out | jq -c '[(.torque_nm | map(. + 0)), .relay_closed, .pump_alive]'
}
dead='[[0,0],false,false]'

# The steps of a reset after a trip.
press_and_reset() {
  echo press reset-button 1 >&3
  sleep 0.1
  echo press reset-button 0 >&3
  within 10 flexarm reset 2>reset.err || { cat reset.err; return 1; }  # when the arm is at rest
}

# The tools of the two generations of libgpiod name chip and line differently.
gpio_get() { if gpio_is_v1; then gpioget "$chip" "$1"; else gpioget -c "$chip" "$1"; fi; }
gpio_set() { if gpio_is_v1; then gpioset "$chip" "$1=1"; else gpioset -t 0 -c "$chip" "$1=1"; fi; }
gpio_is_v1() { gpiodetect --version | grep -q ' v1\.'; }
busy() {  # busy COMMAND..: it must fail because the line is held
  local said
  if said=$("$@" 2>&1); then return 1; fi
  grep -q 'resource busy' <<<"$said" || { echo "  said '$said'"; return 1; }
}

state() { flexarm status --json | jq -r .state; }
bus() { flexarm status --json | jq -r ".buses[] | select(.name == \"$1\") | .$2"; }
bus_is_ok() { [[ $(bus "$1" ok) == true ]]; }
missed_nothing() {  # missed_nothing THREAD..
  local thread
  for thread; do
    check "$thread missed no deadline and skipped no period" \
      grep -q " $thread: [0-9]* activations, 0 missed deadlines, 0 skipped periods" daemon.log
  done
}
