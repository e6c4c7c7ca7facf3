#!/usr/bin/env bash
# Installs into an empty folder and checks the installed files. usage: install_check.sh BUILD_FOLDER
set -euo pipefail

build=$1
machine=$(mktemp -d)
trap 'rm -rf "$machine"' EXIT

fail() {
  echo "install check: $*" >&2
  exit 1
}

DESTDIR=$machine cmake --install "$build" >/dev/null
cd "$machine"
find . -type f | sort

for program in flexarmd flexarm flexarm-study; do
  file=$(find . -type f -name "$program" -path '*/bin/*')
  [[ -n $file ]] || fail "$program is not installed"
  "$file" --version
  "$file" --help >/dev/null
done
flexarm=$(find . -type f -name flexarm -path '*/bin/*')

# The installed configs find the files that they extend.
hil=$(find . -name hil.toml)
[[ -n $hil ]] || fail "no configs are installed"
while read -r config; do
  "$flexarm" config check "$config" >/dev/null || fail "$config is refused"
done < <(find "$(dirname "$hil")" -maxdepth 1 -name '*.toml')
"$flexarm" simulate -c "$hil" --json >/dev/null || fail "the installed config does not simulate"
"$flexarm" modes -c "$hil" --json >/dev/null || fail "the installed flexarm does not find flexarm-study"

unit=$(find . -name flexarmd.service)
[[ -n $unit ]] || fail "no service is installed"
for line in 'Type=notify' 'WatchdogSec=' 'LimitRTPRIO=' 'LimitMEMLOCK=' 'ExecStart='; do
  grep -q "^$line" "$unit" || fail "flexarmd.service has no $line"
done
daemon=$(sed -n 's/^ExecStart=[-@:+!]*\([^ ]*\).*/\1/p' "$unit" | head -n 1)
[[ -x .$daemon ]] || fail "the service starts $daemon, which is not installed"
started=$(sed -n 's/^ExecStart=.*--config[ =]\([^ ]*\).*/\1/p' "$unit" | head -n 1)
if [[ -n $started && $started != *[%$]* && ! -e .$started ]]; then
  fail "the service reads $started, which is not installed"
fi

if command -v systemd-analyze >/dev/null; then
  # systemd looks for the program on this machine: the path of the installed one is inserted.
  mkdir verify
  sed "s#^\(ExecStart=[-@:+!]*\)/#\1$machine/#" "$unit" >verify/flexarmd.service
  said=$(systemd-analyze verify --man=no verify/flexarmd.service 2>&1) || fail "the unit: $said"
  # Ignored settings give exit code 0. Messages about other units of this machine are skipped.
  if grep -F flexarmd.service <<<"$said"; then fail "systemd ignores a part of the unit"; fi
else
  echo "systemd-analyze is not installed: the unit was not verified"
fi
echo "install check: complete"
