#!/usr/bin/env bash
# Installs into an empty folder and checks the installed files. usage: install_check.sh BUILD_FOLDER
set -euo pipefail

build=$(realpath "$1")
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
machine=$(mktemp -d)
trap 'rm -rf "$machine"' EXIT

fail() {
  echo "install check: $*" >&2
  exit 1
}

DESTDIR=$machine cmake --install "$build" >/dev/null
cd "$machine"
find . -type f | sort

for program in flexarmd flexarm flexarm-study flexarm-web; do
  file=$(find . -type f -name "$program" -path '*/bin/*')
  [[ -n $file ]] || fail "$program is not installed"
  "$file" --version
  "$file" --help >/dev/null
  readelf --dynamic "$file" | grep -q 'NOW' || fail "$program looks functions up when they are called"
done
flexarm=$(find . -type f -name flexarm -path '*/bin/*')

# Manual pages and completion.
for page in man1/flexarm.1 man1/flexarm-simulate.1 man1/flexarm-modes.1 man1/flexarm-study.1 man1/flexarm-web.1 man1/flexarm-dashboard.1 man8/flexarmd.8; do
  [[ -s $(find . -path "*/man/$page") ]] || fail "$page is not installed"
done
for program in flexarm flexarmd flexarm-study flexarm-web; do
  [[ -n $(find . -path "*/bash-completion/completions/$program") ]] || fail "no completion of $program"
done
[[ $("$flexarm" --complete modes --js) == --json ]] || fail "the installed flexarm does not complete the verbs of flexarm-study"

# The installed configs find the files that they extend.
hil=$(find . -name hil.toml)
[[ -n $hil ]] || fail "no configs are installed"
while read -r config; do
  "$flexarm" config check "$config" >/dev/null || fail "$config is refused"
done < <(find "$(dirname "$hil")" -maxdepth 1 -name '*.toml')
"$flexarm" simulate -c "$hil" --json >/dev/null || fail "the installed config does not simulate"
"$flexarm" modes -c "$hil" --json >/dev/null || fail "the installed flexarm does not find flexarm-study"

# Experiments bring the files that they name.
while read -r experiment; do
  "$flexarm" simulate -c "$hil" --experiment "$experiment" --json >/dev/null ||
    fail "$experiment is installed and does not run"
done < <(find . -path '*/share/flexarm/*' -name trajectory.toml)
[[ -n $(find . -path '*/share/flexarm/*' -name trajectory.csv) ]] || fail "trajectory.csv is not installed"

client=$(find . -path '*/share/flexarm/python' -type d)
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$client python3 -c 'import flexarm' || fail "the Python client is not installed"
[[ -e $client/flexarm/py.typed && -e $client/examples/series.py ]] ||
  fail "the Python client is not complete"

python3 "$here/installed_links.py" "$machine" || fail "a link of an installed page leads nowhere"

for group in flexarm flexarm-view; do
  grep -qE "^[ug] $group " "$(find . -path '*/sysusers.d/flexarm.conf')" || fail "no group $group"
done
rules=$(find . -path '*/udev/rules.d/60-flexarm.rules')
for device in gpiochip comedi ttyUSB latency_timer cpu_dma_latency; do
  grep -q "^[^#]*$device" "$rules" || fail "no udev rule for $device"
done

unit=$(find . -name flexarmd.service)
[[ -n $unit ]] || fail "no service is installed"
for line in 'Type=notify' 'WatchdogSec=' 'LimitRTPRIO=' 'LimitMEMLOCK=' 'ExecStart=' \
  'ExecStopPost=' 'OOMScoreAdjust=-' 'LimitCORE=0'; do
  grep -q "^$line" "$unit" || fail "flexarmd.service has no $line"
done
daemon=$(sed -n 's/^ExecStart=[-@:+!]*\([^ ]*\).*/\1/p' "$unit" | head -n 1)
[[ -x .$daemon ]] || fail "the service starts $daemon, which is not installed"
started=$(sed -n 's/^ExecStart=.*--config[ =]\([^ ]*\).*/\1/p' "$unit" | head -n 1)
if [[ -n $started && $started != *[%$]* && ! -e .$started ]]; then
  fail "the service reads $started, which is not installed"
fi

awake=$(find . -name flexarm-awake.service)
wanted=$(sed -n 's/^Wants=//p' "$unit")
[[ ${awake##*/} == "$wanted" ]] || fail "the service wants $wanted, which is not installed"
# The command that ends the power after a crash.
stop_post=$(sed -n 's/^ExecStopPost=//p' "$unit")
read -r program verb option config <<<"$stop_post"
[[ $option == --config && -e .$config ]] || fail "ExecStopPost=$stop_post"
# The installed rig.toml extends a file by its path without the folder of this test: $hil is that file.
".$program" "$verb" --config "$hil" || fail "ExecStopPost=$stop_post fails"

if command -v systemd-analyze >/dev/null; then
  # systemd looks for the programs on this machine: the folder of the installed ones is inserted.
  mkdir verify
  sed "s#^\(Exec[A-Za-z]*=[-@:+!]*\)${daemon%/*}/#\1$machine${daemon%/*}/#" "$unit" >verify/flexarmd.service
  cp "$awake" verify
  said=$(systemd-analyze verify --man=no verify/*.service 2>&1) || fail "the unit: $said"
  # Ignored settings give exit code 0. Messages about other units of this machine are skipped.
  if grep -E "flexarm(d|-awake)[.]service" <<<"$said"; then fail "systemd ignores a part of the unit"; fi
  python3 "$here/exposure.py" "$machine" || fail "the unit leaves too much exposed"
else
  echo "systemd-analyze is not installed: the unit was not verified"
fi
echo "install check: complete"
