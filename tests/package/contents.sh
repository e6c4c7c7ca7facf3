#!/usr/bin/env bash
# Makes the Debian package and checks what is in it. usage: contents.sh BUILD_FOLDER PACKAGE
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(realpath "$1")
package=$(realpath -m "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "package contents: $*" >&2
  exit 1
}

cpack -G DEB --config "$build/CPackConfig.cmake" -B "$work/made"
cp "$work"/made/flexarm_*.deb "$package"
dpkg-deb --info "$package"
dpkg-deb --contents "$package"

wrong=$(dpkg-deb --contents "$package" | awk '
  $2 != "root/root" || $1 !~ /^(drwxr-xr-x|-rw-r--r--|lrwxrwxrwx)$/ && $6 !~ "^./usr/bin/flexarm"')
[[ -z $wrong ]] || fail "owner or permissions: $wrong"

dpkg-deb --raw-extract "$package" "$work/root"
cd "$work/root"
for file in usr/bin/{flexarm,flexarmd,flexarm-study,flexarm-web} etc/flexarm/rig.toml \
  usr/share/man/man1/flexarm{,-simulate,-study,-modes}.1.gz usr/share/man/man8/flexarmd.8.gz \
  usr/share/bash-completion/completions/{flexarm,flexarmd,flexarm-study,flexarm-web} \
  usr/share/doc/flexarm/{README.md,CHANGELOG.md,copyright,changelog.gz,docs/commissioning.md} \
  usr/share/flexarm/config/{hil.toml,thesis-rig.toml,experiments/square-30deg.toml} \
  usr/share/flexarm/systemd/{can.conf,can0.network,modbus-tcp.conf,telemetry.conf} \
  usr/lib/systemd/system/flexarm{d,-awake}.service usr/lib/sysusers.d/flexarm.conf \
  usr/lib/tmpfiles.d/flexarm.conf usr/lib/udev/rules.d/60-flexarm.rules; do
  [[ -s $file ]] || fail "$file is not in the package"
done
[[ $(cat DEBIAN/conffiles) == /etc/flexarm/rig.toml ]] || fail "conffiles: $(cat DEBIAN/conffiles)"
[[ -z $(find . -path './etc/*' -type f ! -name rig.toml) ]] || fail "more in /etc than rig.toml"
[[ -z $(find . -type d -empty) ]] || fail "empty folders: $(find . -type d -empty)"
for other in usr/local "$work" "$build" "$(cd "$here/../.." && pwd)"; do
  # grep fails where it finds nothing, which is what is hoped for.
  named=$(grep -rlF -- "$other" usr/lib usr/bin etc usr/share/flexarm DEBIAN || true)
  [[ -z $named ]] || fail "$other is named in $named"
done
grep -q '^Depends: .*libc6 (>= ' DEBIAN/control || fail "no dependencies by dpkg-shlibdeps"
python3 "$here/../e2e/installed_links.py" usr || fail "a link of a page leads nowhere"
echo "package contents: complete"
