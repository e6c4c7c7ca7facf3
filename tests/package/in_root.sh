#!/usr/bin/env bash
# Inside a bare Debian, as root: installs the package, runs the programs and the daemon, upgrades over
# a changed config, removes and purges. usage: in_root.sh FOLDER    of first.deb and next.deb, which
# has a later version and another rig.toml
set -euo pipefail
packages=$(realpath "$1")
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8

fail() {
  echo "package check: $*" >&2
  exit 1
}
check() {  # check WHAT COMMAND..
  "${@:2}" || fail "not so: $1"
  echo "ok: $1"
}
refused() { ! "$@"; }
equal() { [[ $1 == "$2" ]] || { echo "is '$1', should be '$2'" >&2; return 1; }; }
within() {  # within SECONDS COMMAND..
  local end=$((SECONDS + $1))
  until "${@:2}"; do ((SECONDS < end)) || return 1; sleep 0.2; done
}
# dpkg's default answer for a config that both sides changed: the file stays.
apt() { apt-get --quiet --yes -o Dpkg::Options::=--force-confdef --no-install-recommends "$@"; }
# Processes outside this root are seen, too.
daemon_runs() {
  local program
  for program in /proc/[0-9]*/exe; do
    if [[ $program -ef /usr/bin/flexarmd ]]; then return 0; fi
  done
  return 1
}

rig=/etc/flexarm/rig.toml
state=/var/lib/flexarm
link=/etc/systemd/system/multi-user.target.wants/flexarmd.service
version_of() { dpkg-deb --field "$packages/$1.deb" Version; }
installed() { dpkg-query -W -f='${Version} ${db:Status-Status}' flexarm; }

echo "== installed"
apt-get --quiet update
apt install "$packages/first.deb"
check "dpkg has it" equal "$(installed)" "$(version_of first) installed"
check "dpkg finds every file as it was packed" equal "$(dpkg --verify flexarm)" ""
for program in flexarm flexarmd flexarm-study flexarm-web; do
  check "$program runs" "$program" --version
  check "no library of $program is missing" refused grep "not found" <(ldd "/usr/bin/$program")
done
check "the shipped config is accepted" flexarm config check $rig
check "and simulates" flexarm simulate -c $rig --json -o /tmp/first.flexarm >/dev/null
check "flexarm finds flexarm-study" flexarm modes -c $rig --json >/dev/null
check "flexarm finds flexarm-web" flexarm dashboard --help >/dev/null
check "bash completes verbs" grep -q simulate <(bash -c '
  . /usr/share/bash-completion/completions/flexarm
  COMP_WORDS=(flexarm sim) COMP_CWORD=1; _flexarm; printf "%s\n" "${COMPREPLY[@]}"')
check "systemd accepts the unit" systemd-analyze verify --man=no flexarmd.service
# is-enabled fails for what is not enabled; the word that it prints is compared.
check "the service is not enabled" equal "$(systemctl is-enabled flexarmd || true)" disabled
check "the daemon does not run" refused daemon_runs
check "there is the group of observers" getent group flexarm-view
check "the state folder is the daemon's alone" equal "$(stat -c '%U %G %a' $state)" \
  "flexarm flexarm 750"

echo "== one file is edited, and the service enabled"
printf '\n[log]\nkeep_days = 30\n' >>$rig
check "the edited config is accepted" flexarm config check $rig
systemctl enable flexarmd
check "enabled" equal "$(systemctl is-enabled flexarmd)" enabled

echo "== the daemon, as the unit starts it, makes a calibration and a log"
install -d -o flexarm -g flexarm /run/flexarm
read -ra command < <(sed -n 's/^ExecStart=//p' /usr/lib/systemd/system/flexarmd.service)
as_user=(setpriv --reuid=flexarm --regid=flexarm --init-groups --inh-caps=-all)
as_flexarm() { "${as_user[@]}" "$@"; }
"${as_user[@]}" "${command[@]}" --without-realtime </dev/null &
daemon=$!
# It may have ended already.
trap 'kill $daemon 2>/dev/null || true' EXIT
check "it answers" within 20 as_flexarm flexarm status
check "it is found among the processes" daemon_runs
check "tare" within 10 as_flexarm flexarm tare
check "arm" within 10 as_flexarm flexarm arm
check "run" as_flexarm flexarm run --wait /usr/share/flexarm/config/experiments/square-20deg.toml
check "tag" as_flexarm flexarm runs --folder $state
kill $daemon
wait $daemon || fail "the daemon ended with $?"
trap - EXIT
log=$(find $state -name '[!.]*.flexarm' | head -n 1)
check "there is a log" test -s "$log"
as_flexarm flexarm runs tag "$log" keep
touch $state/.next-abcdef.reserved  # as a killed daemon leaves it
check "there is a calibration" test -s $state/calibration.json
kept=("$rig" "$log" "$state/calibration.json")
before=$(sha256sum "${kept[@]}")

# As if systemd ran, with the daemon active: what do the scripts of the package ask it to do?
asked=/tmp/asked
mkdir -p /run/systemd/system
rm -f /usr/sbin/policy-rc.d  # by mmdebstrap: no service is to be started or stopped
rm /usr/bin/systemctl
cat >/usr/bin/systemctl <<'STUB'
#!/bin/sh
echo "$*" >>/tmp/asked
STUB
chmod 755 /usr/bin/systemctl

echo "== upgraded"
: >$asked
apt install "$packages/next.deb" </dev/null 2>&1 | tee /tmp/said
check "dpkg has the next one" equal "$(installed)" "$(version_of next) installed"
check "config, log and calibration are as before" equal "$(sha256sum "${kept[@]}")" "$before"
check "the config that came with it is beside" test -s $rig.dpkg-dist
check "the config is accepted" flexarm config check $rig
check "it is still enabled" test -h $link
check "systemd reads the units again" grep -q daemon-reload $asked
check "the running daemon is left alone" refused grep -wE "start|stop|restart|enable|disable" $asked
check "the operator is told" grep -q "flexarmd still runs" /tmp/said

echo "== removed"
: >$asked
apt remove flexarm
check "the daemon is stopped" grep -q "stop flexarmd.service" $asked
check "no program is left" refused test -e /usr/bin/flexarmd
check "config, log and calibration are as before" equal "$(sha256sum "${kept[@]}")" "$before"

echo "== purged"
apt install "$packages/next.deb" </dev/null
apt purge flexarm 2>&1 | tee /tmp/said
check "the place of the logs is said" grep -q "run logs are left in $state" /tmp/said
check "the logs and their labels are left, and no more" equal \
  "$(find $state -type f | sort | paste -sd' ')" "$log $state/flexarm-labels.json"
check "they are as before" equal "$(sha256sum "$log")" "$(grep flexarm$ <<<"$before")"
check "no config is left" refused test -e /etc/flexarm
check "no link of the service is left" refused test -h $link
check "nothing else is left" equal "$(find /etc /usr /var/lib -xdev -iname '*flexarm*' \
  ! -path "$state*" ! -path '/var/lib/dpkg/*' ! -path '/var/lib/systemd/*')" ""

echo "== purged without a log"
rm -r $state
apt install "$packages/first.deb" </dev/null
apt purge flexarm
check "no state folder is left" refused test -e $state
echo "package check: complete"
