#!/usr/bin/env bash
# Runs every test of this folder in a guest of its own, and compares the logs of the guests with
# runs on this machine. Installs nothing; builds the guest's image where it is out of date.
#
# usage: run_all.sh BUILD_FOLDER [--note FILE [SCRIPT..]]
#   BUILD_FOLDER  e.g. build/release, with all of it built
#   SCRIPT        instead of those of lane guest: name of one of daemon_in_guest, as wakeup; with
#                 an argument as guard_pairs.0
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)

if (($# < 1 || $# == 2)) || [[ ${2:---note} != --note ]]; then
  sed -n '/^# usage: /,/^set /s/^# //p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi
build=$1
note=${3:-/dev/null}

"$here/guest.sh" build

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/share/guest"
DESTDIR=$work/share/machine cmake --install "$build" >/dev/null
cp -r "$here"/{check.sh,interfaces.sh,daq.sh,gpio.sh,threads.sh,docs.sh,daemon_in_guest} "$work/share/guest"
cp "$build"/tests/{guest/guest_daq_test,guest/guest_gpio_test,hal/canopen/hal_canopen_socketcan_test} \
  "$work/share"
cp "$build/tests/controller/wired_threads/wired_threads_test" "$build/tests/rtguard/librtguard.so" \
  "$work/share"
cp -r "$root/config" "$work/share"
"$root/tests/docs/run_blocks.py" guest --build "$build" --share "$work/share/docs"
echo "$root" >"$work/share/source_folder"  # in which wired_threads_test looks for its config
# Uses the installed programs, which a build in progress cannot change between two comparisons.
bin=$(dirname "$(find "$work/share/machine" -type f -name flexarm -path '*/bin/*')")
[[ -x $bin/flexarmd ]] || { echo "run_all: $build contains no flexarmd" >&2; exit 1; }

failed=()
passed=0
result() {  # result NAME STATUS
  if (($2 == 0)); then
    passed=$((passed + 1))
    echo "== $1: pass"
  else
    failed+=("$1")
    echo "== $1: FAIL"
  fi
}

# in_guest FOLDER NAME[.ARGUMENT] [OPTION..]: leaves its output in $work/NAME[.ARGUMENT]. The longest
# took about a minute on the first machine; a busy machine may be thirty times slower.
in_guest() {
  local name=${2%%.*} out=$work/$2 status=0 since=$SECONDS arguments=()
  if [[ $2 == *.* ]]; then arguments=("${2#*.}"); fi
  mkdir "$out"
  "$here/guest.sh" run --share "$work/share" --out "$out" --timeout 1800 "${@:3}" -- \
    "/mnt/share/guest/$1/$name.sh" "${arguments[@]}" 2>"$out/console.txt" || status=$?
  echo $status $((SECONDS - since)) >"$out/ended"
}

report_guest() {
  local status seconds
  read -r status seconds <"$work/$1/ended"
  echo "== $1"
  cat "$work/$1/log" "$work/$1/console.txt" 2>/dev/null || true
  result "$1 ($seconds s)" "$status"
}

on_host() {  # on_host NAME COMMAND..
  local status=0
  "${@:2}" || status=$?
  result "$1" $status
}

replays() {  # replays RUN: replay is bit exact, with the safety decisions, by the same build
  local told
  told=$("$bin/flexarm" replay "$1" --json)
  python3 -c '
import json, sys
told = json.loads(sys.argv[1])
sys.exit(not all(told[key] is True for key in ("bit_exact", "safety_exact", "same_build")))
' "$told" || { echo "$1: $told"; return 1; }
}

# A guest uses one core, and virtual time makes the guests independent: two at a time, the longest
# first. `threads` has two processors and real time; it asserts no time.
names=(wire guard_six_pairs service docs hostile experiment threads interfaces daq gpio)
if (($# > 3)); then names=("${@:4}"); fi
running=0
for name in "${names[@]}"; do
  if ((running == 2)); then
    wait -n
    running=1
  fi
  case $name in
    service | hardened | refusal) in_guest daemon_in_guest "$name" --det --systemd & ;;
    docs | interfaces | daq | gpio) in_guest . "$name" --det & ;;
    threads) in_guest . "$name" & ;;
    *) in_guest daemon_in_guest "$name" --det & ;;
  esac
  running=$((running + 1))
done
wait
for name in "${names[@]}"; do report_guest "$name"; done

finish() {  # finish NOTE
  echo "$passed passed$1" | tee "$note"
  if ((${#failed[@]})); then
    printf 'FAILED: %s\n' "${failed[@]}"
    exit 1
  fi
}
if (($# > 3)); then
  if [[ -e $work/load ]]; then
    on_host "load replays on this machine" replays "$work/load/loaded.flexarm"
  fi
  finish "$(cat "$work"/*/note 2>/dev/null | sed 's/^/; /' | tr -d '\n')"
  exit 0
fi

# The guest's real-time run must equal a lock-step run with the same seed on this machine, bit for
# bit.
"$bin/flexarm" simulate -c "$root/config/hil.toml" --json -o "$work/lockstep.flexarm" \
  --experiment "$root/config/experiments/square-30deg.toml" >/dev/null
on_host "experiment equals the lock-step run" \
  "$bin/flexarm" diff "$work/lockstep.flexarm" "$work/experiment/guest.flexarm"
on_host "the experiment replays on this machine" replays "$work/experiment/guest.flexarm"
on_host "wire replays on this machine" replays "$work/wire/wire.flexarm"
for name in stop term hung killed; do
  on_host "$name replays on this machine" replays "$work/service/runs/$name.flexarm"
done

finish ""
