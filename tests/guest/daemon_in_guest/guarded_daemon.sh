# Sourced inside the guest, after rig.sh: the daemon under rtguard (tests/rtguard), which ends it when
# a real-time thread does what it must not.
# shellcheck shell=bash disable=SC2154

report=$PWD/rtguard.txt
# A function, because rig.sh starts `flexarmd`; exec, so that its number is that of the daemon.
# `flexarm rig` takes the kernel's lock of the simulated chip, too.
flexarmd() {
  exec env RTGUARD_REPORT="$report" RTGUARD_SHARED_LINES=1 LD_PRELOAD=/mnt/share/librtguard.so \
    /usr/local/bin/flexarmd "$@"
}
# grep fails where it counts 0, which is an answer here.
count() { grep -c -- "$1" daemon.log || true; }

# ends STATUS THREAD..: the daemon ends in order (1: tripped), and each of its threads was watched.
ends() {
  local thread failures_before=$failures status=$1
  shift
  kill -TERM $daemon
  wait $daemon
  check "flexarmd ends with $status" equal $? "$status"
  check "no violation" equal "$(grep -v ' activations$' "$report")" ""
  for thread; do
    check "$thread was watched" grep -q "^rtguard: $thread: [0-9]* activations$" "$report"
  done
  cat "$report"
  if ((failures > failures_before)); then tail -n 40 daemon.log; fi
  rm -f "$report"
}

# Slow: after a trip the arm coasts a few degrees and reaches no switch.
cat >slow.toml <<'TOML'
name = "slow"
duration_s = 30.0
[[move]]
start_s = 0.0
duration_s = 8.0
to_deg = [4.0, -4.0]
TOML
# So fast that a payload of 6 kg bends the links too far.
cat >quick.toml <<'TOML'
name = "quick"
duration_s = 8.0
[[move]]
start_s = 0.0
duration_s = 1.0
to_deg = [40.0, 0.0]
TOML
