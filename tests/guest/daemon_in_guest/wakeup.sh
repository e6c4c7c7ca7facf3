#!/usr/bin/env bash
# Inside the guest, on virtual time: how late the control thread of the unchanged daemon wakes,
# beside cyclictest in the same boot, one after the other, with its priority, its period and 10,000
# cycles each. Bar: 99.9th percentile and maximum at most 1.2 times those of cyclictest.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/../check.sh"

cycles=10000
cp -a /mnt/share/machine/. /
cyclictest -q -m -t 1 -p 80 -i 20000 -l $cycles -N -h 100000 >cyclictest.txt
cat >rest-and-move.toml <<'TOML'
name = "rest-and-move"
duration_s = 200.0
[[move]]
start_s = 0.0
duration_s = 4.0
to_deg = [20.0, -10.0]
[[move]]
start_s = 100.0
duration_s = 4.0
to_deg = [-20.0, 10.0]
TOML
# On a rig no thread is due when control is. The simulated arm is, every millisecond: control comes
# half a millisecond later than in the shipped config.
flexarmd --config /usr/local/share/flexarm/config/hil.toml --set loop.acquire_before_ms=10.5 \
  --experiment rest-and-move.toml --log-dir runs --socket flexarmd.sock 2>daemon.log
check "flexarmd ends with 0" equal $? 0
grep activations daemon.log
run=$(ls runs/*.flexarm)
# The samples of the experiment, ns.
sqlite3 "$run" "SELECT CAST(1000 * late_us AS INTEGER) FROM timing ORDER BY tick DESC LIMIT $cycles" |
  sort -n >ours.txt
check "$cycles samples" equal "$(wc -l <ours.txt)" $cycles
# cyclictest's histogram as a list: LATENESS COUNT in each line that is not a comment.
awk '/^[0-9]/ { for (i = 0; i < $2; i++) print $1 + 0 }' cyclictest.txt >theirs.txt
check "$cycles cycles" equal "$(wc -l <theirs.txt)" $cycles

at_rank() { sed -n "$2p" "$1"; }
for what in "99.9th percentile:$((cycles * 999 / 1000))" "maximum:$cycles"; do
  rank=${what#*:}
  ours=$(at_rank ours.txt "$rank") theirs=$(at_rank theirs.txt "$rank")
  echo "wake-up, ${what%:*}: control $ours ns, cyclictest $theirs ns, ratio $(awk "BEGIN { printf \"%.2f\", $ours / $theirs }")" |
    tee -a /mnt/out/note
  check "${what%:*} at most 1.2 times" at_least $((theirs * 12)) $((ours * 10))
done
conclude
