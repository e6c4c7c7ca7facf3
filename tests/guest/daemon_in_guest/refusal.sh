#!/usr/bin/env bash
# Inside the guest, with systemd: without the resource limits that real time needs, the daemon
# refuses to start, names the missing limit and the remedy, and leaves no files.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"
# shellcheck source=tests/guest/daemon_in_guest/install.sh
. "$(dirname "$0")/install.sh"

configs=/usr/local/share/flexarm/config
folder=/tmp/plain
install -d -o stranger $folder
cd $folder || exit

# A plain user's daemon under given limits; message in said.txt, status in status.
plain() {  # plain RTPRIO MEMLOCK_BYTES [OPTION..]
  status=0
  prlimit --rtprio="$1" --memlock="$2" setpriv --reuid=stranger --regid=nogroup --clear-groups \
    flexarmd --config $configs/hil.toml --log-dir $folder/runs \
    --socket $folder/socket "${@:3}" >said.txt 2>&1 || status=$?
  cat said.txt
}
says() { grep -q -- "$1" said.txt; }

echo "== a plain user without limits for real time"
plain 0 65536 --experiment $configs/experiments/square-30deg.toml
check "exit status 1" equal $status 1
check "names the priority" says 'SCHED_FIFO priority 90 is refused'
check "names its limit" says 'RLIMIT_RTPRIO is 0'
check "names the remedy" says 'set LimitRTPRIO=.* or use --without-realtime'
check "names the memory and its limit" says 'locking the memory is refused.*RLIMIT_MEMLOCK is 65536'
check "names the remedy for the memory" says 'set LimitMEMLOCK=infinity'
check "leaves no log and no socket" equal "$(find runs socket 2>/dev/null | wc -l)" 0

echo "== only one of the two is missing"
plain 0 unlimited --experiment $configs/experiments/square-30deg.toml
check "exit status 1" equal $status 1
check "blames the priority" says 'SCHED_FIFO priority 90 is refused'
check "does not blame the memory" refused says 'locking the memory is refused'
plain 95 65536 --experiment $configs/experiments/square-30deg.toml
check "exit status 1" equal $status 1
check "blames the memory" says 'locking the memory is refused'
check "does not blame the priority" refused says 'SCHED_FIFO priority 90 is refused'
# The highest priority of the threads is 90: a limit of 89 must be refused.
plain 89 unlimited --experiment $configs/experiments/square-30deg.toml
check "a limit of 89 is too low for safety's 90" equal $status 1

echo "== no limit is missing, or --without-realtime is given"
plain 90 unlimited --run-for 1
check "with both limits it runs as a plain user" equal $status 0
plain 0 65536 --run-for 1 --without-realtime
check "with --without-realtime it runs" equal $status 0
check "and reports the consequences" says 'ordinary scheduling, unlocked memory'

# What flexarm check-host says of one check: found CHECK KEY
found() { jq -r ".checks[] | select(.name == \"$1\") | .$2" host.json; }
judge() {  # judge RTPRIO MEMLOCK_BYTES: as a plain user
  status=0
  prlimit --rtprio="$1" --memlock="$2" setpriv --reuid=stranger --regid=nogroup --clear-groups \
    flexarm check-host --json >host.json || status=$?
}

echo "== check-host"
judge 0 65536
jq -r '.checks[] | [.ok, .name, .value] | @tsv' host.json
check "a plain user is not ready" equal "$status $(jq -r .verdict host.json)" "1 not-ready"
check "the kernel is PREEMPT_RT" equal "$(found preempt-rt ok)" true
check "the priority is missing" equal "$(found fifo-priority ok)" false
check "with its limit" equal "$(found fifo-priority value | grep -o 'RLIMIT_RTPRIO is 0')" \
  'RLIMIT_RTPRIO is 0'
check "and its remedy" equal "$(found fifo-priority remedy | grep -o LimitRTPRIO)" LimitRTPRIO
check "the memory is missing" equal "$(found memory-lock value)" '65536 bytes'
judge 95 unlimited
check "with both limits they are there" equal \
  "$(found fifo-priority ok) $(found memory-lock ok)" "true true"
check "the emulated machine's clock is named" equal "$(found clock-source value)" \
  "$(cat /sys/devices/system/clocksource/clocksource0/current_clocksource)"

echo "== the service without its limits"
mkdir -p /run/systemd/system/flexarmd.service.d
printf '[Service]\nLimitRTPRIO=0\nLimitMEMLOCK=64K\n' \
  >/run/systemd/system/flexarmd.service.d/poor.conf
systemctl daemon-reload
check "does not start" refused systemctl start flexarmd
check "exit status 1" equal "$(service Result) $(service ExecMainStatus)" "exit-code 1"
journalctl -u flexarmd --no-pager -o cat >said.txt
cat said.txt
check "the journal names the remedy" says 'set LimitRTPRIO=.*systemd unit'
check "leaves no log" equal "$(find /var/lib/flexarm -name '*.flexarm' | wc -l)" 0
rm /run/systemd/system/flexarmd.service.d/poor.conf
systemctl daemon-reload
check "with them it starts" systemctl start flexarmd
conclude
