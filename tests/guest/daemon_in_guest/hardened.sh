#!/usr/bin/env bash
# Inside the guest, with systemd: the shipped unit takes no function away from a rig. First it opens
# each kind of device itself; then it runs a wired rig, CAN, Modbus/TCP and GPIO lines of
# `flexarm rig`, with the installed drop-in file: a run, bus-off, a crash.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"
# shellcheck source=tests/guest/daemon_in_guest/install.sh
. "$(dirname "$0")/install.sh"
# shellcheck source=tests/guest/daemon_in_guest/rig.sh
. "$(dirname "$0")/rig.sh"
unset FLEXARM_SOCKET  # the one of the config, as the service

dropins=/run/systemd/system/flexarmd.service.d
mkdir -p $dropins
: >daemon.log  # the last lines are shown after a failure
cat >$dropins/log.conf <<CONF
[Service]
StandardError=append:$PWD/daemon.log
CONF
as_the_unit_shows() { sed -n "s/^$1:\s*//p" "/proc/$(service MainPID)/status"; }
in_state() { [[ $(flexarm status --json 2>/dev/null | jq -r .state) == "$1" ]]; }

echo "== each kind of device"
modprobe comedi_test  # one board; without legacy minors it is comedi0
devices=("/dev/$chip" /dev/comedi0 /dev/ttyS0 /dev/cpu_dma_latency)
for device in "${devices[@]}"; do
  check "$device exists" test -c "$device"
  chown flexarm "$device"  # as the udev rules do; udev does not run here
done
chmod 666 /dev/kmsg  # not of a rig: refused by the unit alone
cat >$dropins/devices.conf <<CONF
[Service]
ExecStartPre=/bin/sh -c 'for d in ${devices[*]}; do true <\$\$d || exit 1; done'
ExecStartPre=/bin/sh -c '! (true </dev/kmsg) 2>/dev/null'
CONF
systemctl daemon-reload
check "the unit may open them, and no other" systemctl start flexarmd
check "it runs" within 10 in_state Idle
check "no new privileges, and a filter of system calls" equal \
  "$(as_the_unit_shows NoNewPrivs) $(as_the_unit_shows Seccomp)" "1 2"
systemctl stop flexarmd
if ((failures > 0)); then tail -n 20 daemon.log; fi
rm $dropins/devices.conf

echo "== a wired rig"
config=$(service ExecStart | sed -n 's/.*--config \([^ ]*\).*/\1/p')
cp wire.toml "$config"
sed -e 's/^IPAddressAllow=.*/IPAddressAllow=localhost/' -e "s#/dev/gpiochip0#/dev/$chip#" \
  /usr/local/share/flexarm/systemd/modbus-tcp.conf >$dropins/modbus-tcp.conf
systemctl daemon-reload
start_rig
check "the service starts" systemctl start flexarmd
check "it is idle" within 20 in_state Idle
in_state Idle || { tail -n 30 daemon.log; systemctl status --no-pager flexarmd; }
check "it sees no other device" refused test -e "/proc/$(service MainPID)/root/dev/comedi0"
check "all buses answer" equal "$(flexarm status --json | jq -c '[.buses[].ok] | unique')" "[true]"
judged() { [[ $(flexarm status --json | jq -r .host.verdict) == "$1" ]]; }
check "the daemon judges the machine as it does without the confinement" within 10 \
  judged "$(flexarm check-host -c wire.toml --json | jq -r .verdict)"
sleep 1 # at rest for half a second
start_run
check "it runs" within 5 in_state Running
check "it comes to its end" within 30 in_state Armed
check "disarmed" flexarm disarm
check "the hardware has no power after it" equal "$(hardware)" "$dead"

echo "== the CAN controller leaves the bus during a run"
start_run
sleep 1
echo bus-off vcan0 >&3
check "it trips" within 5 in_state Tripped
check "when disarmed, the bus recovers without a restart" within 5 bus_is_ok vcan0
check "reset" press_and_reset
check "it is idle" within 5 in_state Idle
check "stopped" systemctl stop flexarmd
check "a trip that was reset is no failure" equal "$(service Result) $(service ExecMainStatus)" "success 0"
stop_rig

echo "== a crash"
start_rig
systemctl start flexarmd
check "it is idle" within 20 in_state Idle
sleep 1
start_run
sleep 1
check "the relay is closed" equal "$(hardware | jq -c '.[1:]')" '[true,true]'
signal_service SEGV
check "systemd sees it" within 10 service_is failed
check "with this reason" equal "$(service Result) $(service ExecMainStatus)" "signal 11"
check "the hardware has no power" equal "$(hardware)" "$dead"
check "the command that ends the power ran after it" equal "$(service ExecStopPost |
  sed -n 's/.*argv\[\]=[^ ]* \([^ ]*\) .*code=\([a-z]*\) ; status=\([0-9]*\).*/\1 \2 \3/p')" "lines-off exited 0"
stop_rig
conclude
