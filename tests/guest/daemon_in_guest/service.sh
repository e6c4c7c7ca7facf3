#!/usr/bin/env bash
# Inside the guest, with systemd: the daemon as the shipped service. A member of the group operates
# it, others are refused; it is stopped, hung and killed during a run. The logs go to /mnt/out/runs.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"
# shellcheck source=tests/guest/daemon_in_guest/install.sh
. "$(dirname "$0")/install.sh"

logs=/var/lib/flexarm
mkdir /mnt/out/runs kept

# Copies the newest log, for this script and for the host, so that it is checked as the daemon left
# it.
keep_log() {  # keep_log NAME
  local newest
  newest=$(find $logs -name '[!.]*.flexarm' -printf '%T@ %p\n' | sort -n | tail -n 1 |
    cut -d' ' -f2)
  log=kept/$1.flexarm
  cp "$newest" "$log"
  cp "$newest" "/mnt/out/runs/$1.flexarm"
  closed=$(flexarm info "$log" --json | jq .closed)
}
states() {  # the states of the log, in order
  sqlite3 "$log" 'SELECT state_after FROM safety WHERE state_before <> state_after
    ORDER BY number' | paste -sd' '
}
replays() {
  equal "$(flexarm replay "$log" --json | jq -c '[.bit_exact, .safety_exact]')" "[true,true]"
}

echo "== start"
check "the service starts" systemctl start flexarmd
check "it is active after its ready notification" equal "$(service ActiveState)" active
main=$(service MainPID)
check "it runs as flexarm" equal "$(ps -o user= -p "$main")" flexarm
check "the kernel ends it last when memory runs out" equal "$(cat "/proc/$main/oom_score_adj")" -900
check "it writes no core dump" equal \
  "$(awk '/^Max core file size/ { print $5, $6 }' "/proc/$main/limits")" "0 0"
check "it has only the capability that restarts a CAN interface" \
  grep -q '^CapEff:\s*0000000000001000$' "/proc/$main/status"  # bit 12, CAP_NET_ADMIN
check "its control thread still runs as FIFO 80" equal \
  "$(ps -L -o comm=,cls=,rtprio= -p "$main" | awk '$1 == "control" { print $2, $3 }')" "FF 80"
locked=$(awk '$1 == "VmLck:" { print $2 }' "/proc/$main/status")
check "its memory is locked ($locked kB)" at_least "$locked" 20000  # of about 170000

echo "== permissions"
check "a member of the group sees the state" within 5 in_state Idle
check "systemd shows the state too" within 5 equal "$(service StatusText)" Idle
for verb in status arm stop; do
  check "a stranger may not $verb" refused as stranger flexarm $verb
done
as stranger flexarm arm >said.txt 2>&1
check "a stranger is told why" grep -q "stranger may not operate the arm.*the group flexarm" said.txt
check "the stranger armed nothing" in_state Idle
check "a stranger may not read the logs" refused as stranger ls $logs
check "an observer sees the state" as observer flexarm status
check "an observer may not arm" refused as observer flexarm arm
check "the observer armed nothing" in_state Idle

echo "== a run, stopped by an observer"
start_moving
check "the arm runs" in_state Running
check "stop is accepted" as observer flexarm stop
check "the arm comes to rest" within 4 in_state Armed
check "disarm is accepted" operate disarm
check "the relay is open" within 2 in_state Idle
sleep 1  # the recorder closes the log
keep_log stop
check "state by state" equal "$(states)" "Running Stopping Armed Disarming Idle"
check "the log is closed" equal "$closed" true
check "the log replays" replays

echo "== systemctl stop during a run"
start_moving
check "systemctl stop succeeds" systemctl stop flexarmd
check "exit status 0" equal "$(service Result) $(service ExecMainCode) $(service ExecMainStatus)" \
  "success 1 0"  # 1 is CLD_EXITED
keep_log term
check "a controlled stop, state by state" equal "$(states)" "Running Stopping Armed Disarming Idle"
check "the log is closed" equal "$closed" true
check "the log replays" replays

# Checks the log of a killed process. The recorder commits every half second, and one row may be in
# flight: the last row is at most 26 samples older than the last sample in the status.
left_behind() {  # left_behind NAME LAST_TICK
  keep_log "$1"
  check "the log was not closed" equal "$closed" false
  check "the log replays as it is" replays
  check "it is recovered" flexarm log recover "$log"
  check "it lost half a second at most" at_least \
    "$(sqlite3 "$log" 'SELECT max(tick) FROM tick')" $(($2 - 26))
  check "the arm was running in it" equal "$(states)" Running
  check "the log replays" replays
}
tick() { operate status --json | jq .tick; }

echo "== hung"
systemctl start flexarmd
start_moving
seen=$(tick)
signal_service STOP
since=$SECONDS
check "systemd's watchdog kills it" within 20 service_is failed
echo "after $((SECONDS - since)) s"
check "with this reason" equal "$(service Result)" watchdog
left_behind hung "$seen"
sleep 2
check "it is not started again" equal "$(service ActiveState) $(service NRestarts)" "failed 0"

# A daemon that ended while the arm was armed: the next one starts tripped.
press_and_reset() {
  check "it starts tripped" within 5 in_state Tripped
  check "because of that" equal "$(operate status --json | jq -r .trip.name)" ended-while-armed
  check "it cannot be armed" refused operate arm
  operate sim reset-button 1
  sleep 0.1  # 50 ms count as a press
  operate sim reset-button 0
  check "after the button it can be reset" within 5 operate reset
}

echo "== killed"
systemctl start flexarmd
press_and_reset
start_moving
seen=$(tick)
signal_service KILL
check "systemd sees it" within 5 service_is failed
check "with this reason" equal "$(service Result) $(service ExecMainStatus)" "signal 9"
left_behind killed "$seen"
check "the command that ends the power ran after it" equal "$(service ExecStopPost |
  sed -n 's/.*argv\[\]=[^ ]* \([^ ]*\) .*code=\([a-z]*\) ; status=\([0-9]*\).*/\1 \2 \3/p')" "lines-off exited 0"
sleep 2
check "it is not started again" equal "$(service ActiveState) $(service NRestarts)" "failed 0"

echo "== restart"
systemctl start flexarmd
press_and_reset
check "idle" within 5 in_state Idle
sleep 2
check "nothing arms by itself" in_state Idle
check "the old logs are all there" equal "$(find $logs -name '*.flexarm' | wc -l)" 4
systemctl stop flexarmd
check "it also stops from Idle" equal "$(service Result)" success
conclude
