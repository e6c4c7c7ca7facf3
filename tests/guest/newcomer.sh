#!/usr/bin/env bash
# The newcomer's path, in a guest that is a bare Debian with nothing of flexarm but its package: the
# `newcomer` blocks of docs/getting-started.md, as root, in one shell. What they print is compared
# with what the page says. The packages that apt installs come from a folder of the host; the guest
# has no network.
#
# usage: newcomer.sh BUILD_FOLDER [--note FILE] [--keep FILE]
#   BUILD_FOLDER  e.g. build/release, with flexarm, flexarm-study and flexarmd built
#   --keep FILE   also writes the whole transcript there
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
cache=${XDG_CACHE_HOME:+$XDG_CACHE_HOME/flexarm-guest}
cache=${cache:-$root/build/guest}
page=$root/docs/getting-started.md

usage() {
  sed -n '/^# usage: /,/^set /s/^# //p' "${BASH_SOURCE[0]}" >&2
  exit 2
}

(($#)) || usage
build=$1 note=/dev/null keep=/dev/null
shift
while (($#)); do
  case $1 in
    --note) note=$2 ;;
    --keep) keep=$2 ;;
    *) usage ;;
  esac
  shift 2
done

"$here/guest.sh" build --debian
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
packages=$work/share/packages
mkdir -p "$packages/partial" "$work/out"

# What apt would install there beside the package: all that the image has not.
cpack -G DEB --config "$build/CPackConfig.cmake" -B "$work/made" >/dev/null
cp "$work"/made/flexarm_*.deb "$packages"
cp "$cache/debian.dpkg-status" "$work/status"  # apt locks the folder of this file
apt-get -q -o Dir::State::status="$work/status" -o Dir::Cache::archives="$packages" \
  -o APT::Sandbox::User=root --yes --download-only --no-install-recommends \
  install "$packages"/flexarm_*.deb gnuplot-nox >"$work/apt.txt" 2>&1 || { cat "$work/apt.txt"; exit 1; }
(cd "$packages" && dpkg-scanpackages --multiversion . 2>/dev/null >Packages)
echo "$(find "$packages" -name '*.deb' | wc -l) packages, $(du -sm "$packages" | cut -f1) MB"

"$root/tests/docs/run_blocks.py" newcomer --page "$page" --build "$build" --share "$work/share"
# shellcheck disable=SC2016
inside='cd && cp /mnt/share/packages/flexarm_*.deb . &&
  exec setsid --wait timeout 1700 bash /mnt/share/page.sh /mnt/share/pages/docs-getting-started.md'
status=0 since=$SECONDS
"$here/guest.sh" run --debian --systemd --det --timeout 1800 --share "$work/share" \
  --out "$work/out" -- bash -c "$inside" || status=$?
took=$((SECONDS - since))
cp "$work/out/log" "$keep"
# Without the file the guest died: its status has said so.
echo "$took s on the host, $(cat "$work/out/end_s" || true) s in the guest"
if ((status)); then
  tail -n 60 "$work/out/log"
  echo "newcomer: the page ended with $status"
  exit 1
fi
"$root/tests/docs/transcript.py" "$page" "$work/out/log"
echo "the page is what the guest printed; $took s" | tee "$note"
