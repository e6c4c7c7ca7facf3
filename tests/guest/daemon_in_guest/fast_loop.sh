#!/usr/bin/env bash
# Inside the guest, on virtual time: the unchanged daemon with a loop of 1 kHz, the same code and
# another config. No thread misses a deadline; the log is whole and replays.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"

cp -a /mnt/share/machine/. /
cat >move.toml <<'TOML'
name = "move"
duration_s = 5.0
[[move]]
start_s = 0.0
duration_s = 3.0
to_deg = [20.0, -10.0]
TOML
flexarmd --config /usr/local/share/flexarm/config/hil.toml --set loop.period_ms=1 \
  --set loop.acquire_before_ms=0.5 --set loop.step_deadline_ms=0.4 --experiment move.toml \
  --log-dir runs --socket flexarmd.sock 2>daemon.log
check "flexarmd ends with 0" equal $? 0
grep activations daemon.log
for thread in safety control plant; do
  check "$thread missed no deadline and skipped no period" \
    grep -q " $thread: [0-9]* activations, 0 missed deadlines, 0 skipped periods" daemon.log
done
run=$(ls runs/*.flexarm)
check "5000 of 5000 samples" equal \
  "$(flexarm info "$run" --json | jq -c '[.metrics.ticks, .missing_ticks, .trip]')" "[5000,0,null]"
check "it replays" equal \
  "$(flexarm replay "$run" --json | jq -c '[.bit_exact, .safety_exact]')" "[true,true]"
if ((failures > 0)); then tail -n 40 daemon.log; fi
conclude
