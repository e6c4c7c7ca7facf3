# Sourced by the scripts that run inside the guest.
# shellcheck shell=bash

failures=0

# check WHAT COMMAND..: reports whether COMMAND succeeded; continues in both cases.
check() {
  local what=$1
  shift
  if "$@"; then
    echo "PASS $what"
  else
    echo "FAIL $what    ($*)"
    failures=$((failures + 1))
  fi
}

refused() { ! "$@"; }  # for a command that must fail
equal() { [[ $1 == "$2" ]] || { echo "  got '$1', expected '$2'"; return 1; }; }
at_least() { (($1 >= $2)) || { echo "  got $1, expected at least $2"; return 1; }; }

# holds FILTER FILE: whether jq's FILTER gives true for each object in FILE; not for an empty FILE.
holds() { equal "$(jq "$1" "$2" | sort -u)" true; }

# within SECONDS COMMAND..: repeats COMMAND until it succeeds; 1 when the time is over.
within() {
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    if ((SECONDS >= end)); then return 1; fi
    sleep 0.1
  done
}

# Ends the script: 0 if every check passed.
conclude() {
  echo "$failures failed"
  exit $((failures > 0))
}
