#!/usr/bin/env bash
# Inside the guest, on virtual time: the default experiment on the simulated arm, in real time,
# without missed deadlines. Leaves the log as /mnt/out/guest.flexarm for the host to compare.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"

cp -a /mnt/share/machine/. /
configs=/usr/local/share/flexarm/config

ldd /usr/local/bin/flexarm /usr/local/bin/flexarmd >libraries.txt
check "the image contains every library (guest_packages of guest.sh)" refused \
  grep 'not found' libraries.txt

policy_of() {  # policy_of THREAD: as "FIFO 90"
  ps -L -o comm=,cls=,rtprio= -p "$daemon" | awk -v name="$1" '$1 == name { print $2, $3 }'
}

flexarmd --config $configs/hil.toml --experiment $configs/experiments/square-30deg.toml \
  --log-dir runs --socket flexarmd.sock 2>daemon.log &
daemon=$!
within 30 grep -q 'Armed -> Running' daemon.log
check "safety runs as FIFO 90" equal "$(policy_of safety)" "FF 90"
check "control runs as FIFO 80" equal "$(policy_of control)" "FF 80"
check "the plant runs as FIFO 60" equal "$(policy_of plant)" "FF 60"
check "the recorder is an ordinary thread" equal "$(policy_of recorder)" "TS -"
# The daemon maps about 20 MB; MCL_FUTURE locks all of it.
locked=$(awk '$1 == "VmLck:" { print $2 }' "/proc/$daemon/status")
mapped=$(awk '$1 == "VmRSS:" { print $2 }' "/proc/$daemon/status")
check "its memory is locked ($locked kB, $mapped kB present)" at_least "$locked" "$mapped"
wait $daemon
check "flexarmd ends with 0" equal $? 0
cat daemon.log
check "it recognises a PREEMPT_RT kernel" grep -q 'kernel: .*(PREEMPT_RT)' daemon.log
for thread in safety control plant operator; do  # the recorder writes the run's file at its end
  check "$thread missed no deadline and skipped no period" \
    grep -q " $thread: [0-9]* activations, 0 missed deadlines, 0 skipped periods" daemon.log
done

run=$(ls runs/*.flexarm)
flexarm info "$run" --json >info.json
check "300 of 300 samples" equal "$(jq -c '[.metrics.ticks, .missing_ticks, .trip]' info.json)" \
  "[300,0,null]"
check "the relay is open at the end" equal "$(jq -r .final_state info.json)" Idle
# The deadline of the step: 5 ms after it is due (loop.step_deadline_ms - loop.acquire_before_ms).
check "no step was finished late" equal \
  "$(sqlite3 "$run" 'SELECT count(*) FROM timing WHERE finished_ns - due_ns > 5000000')" 0
check "replay in the guest is bit exact" equal \
  "$(flexarm replay "$run" --json | jq -c '[.bit_exact, .safety_exact]')" "[true,true]"
check "obeys the safety and consistency rules" flexarm check "$run"
sqlite3 "$run" "SELECT 'lateness of control: worst', max(late_us), 'us, longest step', max(took_us),
  'us' FROM timing" -separator ' '
cp "$run" /mnt/out/guest.flexarm
conclude
