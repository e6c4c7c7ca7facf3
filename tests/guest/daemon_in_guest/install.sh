# Sourced inside the guest: installs the files of `cmake --install` as the README describes, and
# adds three user accounts: one may operate the arm, one may see its state and stop it.
# shellcheck shell=bash

cp -a /mnt/share/machine/. /
systemd-sysusers
systemctl -q add-wants guest.target flexarmd  # without it systemd forgets how the unit ended
systemctl daemon-reload
useradd --groups flexarm member
useradd --groups flexarm-view observer
useradd stranger

experiment=/usr/local/share/flexarm/config/experiments/square-30deg.toml

as() { setpriv --reuid="$1" --regid="$(id -g "$1")" --init-groups -- "${@:2}"; }
operate() { as member flexarm "$@"; }
state() { operate status --json | jq -r .state; }
in_state() { [[ $(state) == "$1" ]]; }
service() { systemctl show flexarmd --value -p "$1"; }
# Without a process its number is 0, and kill would end this script's own group: the guest would
# run on, without a result.
signal_service() {
  local pid
  pid=$(service MainPID)
  if ((pid > 0)); then kill "-$1" "$pid"; else check "the service has a process for SIG$1" false; fi
}
service_is() { [[ $(service ActiveState) == "$1" ]]; }

# The arm must have been at rest for half a second before it may be armed.
start_moving() {
  within 5 operate arm 2>/dev/null
  within 5 in_state Armed
  operate run "$experiment"
  within 5 in_state Running
  sleep 0.6  # both joints are at their fastest
}
