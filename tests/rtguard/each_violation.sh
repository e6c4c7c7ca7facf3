#!/usr/bin/env bash
# Each kind of violation, once: rtguard ends the program and names it; nothing else ends it.
# usage: each_violation.sh RTGUARD VIOLATIONS
set -euo pipefail
guard=$1
program=$2
report=$(mktemp)
trap 'rm -f "$report"' EXIT

guarded() {  # guarded WHAT: its exit status
  : >"$report"
  local status=0
  (ulimit -c 0; RTGUARD_THREADS=control RTGUARD_REPORT=$report LD_PRELOAD=$guard exec "$program" "$1") \
    2>/dev/null || status=$?
  echo "$status"
}

status=$(guarded nothing)
if ((status == 77)); then exit 77; fi
failed=0
if ((status != 0)) || ! grep -q '^rtguard: control: [1-9][0-9]* activations$' "$report"; then
  echo "without a violation it ended with $status:"
  cat "$report"
  failed=1
fi

ends() {  # ends WHAT MESSAGE: aborted, with the message and the place in the program
  local status
  status=$(guarded "$1")
  if ((status != 134)) || ! grep -q "^rtguard: control: $2" "$report" ||
    ! grep -q "$(basename "$program")" "$report"; then
    echo "$1: ended with $status, and not with '$2' and a stack trace:"
    cat "$report"
    failed=1
  fi
}
ends heap 'malloc of bytes: 4$'
ends system-call 'system call 110$'
ends lock 'system call 202$'
ends page-fault 'page faults: 1$'
ends wait 'waits between two sleeps: 1$'
ends crash 'signal 11$'
exit $failed
