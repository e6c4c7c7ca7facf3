#!/usr/bin/env bash
# Each kind of violation, once: rtguard ends the program and names it; nothing else ends it.
# usage: each_violation.sh RTGUARD VIOLATIONS
set -euo pipefail
guard=$1
program=$2
report=$(mktemp)
trap 'rm -f "$report"' EXIT

guarded() {  # guarded WHAT [THREAD]: its exit status
  local thread=${2:-control} status=0
  : >"$report"
  (ulimit -c 0; RTGUARD_THREADS=$thread RTGUARD_REPORT=$report LD_PRELOAD=$guard \
    exec "$program" "$1" "$thread") 2>/dev/null || status=$?
  echo "$status"
}

status=$(guarded nothing)
if ((status == 77)); then
  echo "skipped: memory cannot be locked here (\`ulimit -l unlimited\`), which rtguard needs to see a page fault"
  exit 77
fi
failed=0

passes() {  # passes WHAT [THREAD]
  local status
  status=$(guarded "$1" "${2:-control}")
  if ((status != 0)) || ! grep -q "^rtguard: ${2:-control}: [1-9][0-9]* activations\$" "$report"; then
    echo "$1: no violation, and it ended with $status:"
    cat "$report"
    failed=1
  fi
}

ends() {  # ends WHAT MESSAGE [THREAD]: aborted, with the message and the place in the program
  local status
  status=$(guarded "$1" "${3:-control}")
  if ((status != 134)) || ! grep -q "^rtguard: ${3:-control}: $2" "$report" ||
    ! grep -q "$(basename "$program")" "$report"; then
    echo "$1: ended with $status, and not with '$2' and a stack trace:"
    cat "$report"
    failed=1
  fi
}
passes nothing
passes switch  # only the thread of the highest priority may not be switched away
passes descriptor vcan0  # a bus thread asks what the descriptor is that it has opened again
ends descriptor 'system call ' control
ends path 'system call 262$' vcan0
ends heap 'malloc of bytes: 4$'
ends system-call 'system call 110$'
ends lock 'system call 202$'
ends page-fault 'page faults: 1$'
ends wait 'waits between two sleeps: 1$'
ends switch 'involuntary switches of the highest priority: [1-9][0-9]*$' safety
ends crash 'signal 11$'
exit $failed
