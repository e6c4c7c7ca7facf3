#!/usr/bin/env bash
# The Debian package: two builds give the same bytes, lintian has nothing to say, and dpkg installs,
# upgrades and removes it in a bare Debian. usage: package_check.sh BUILD_FOLDER
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "package check: $*" >&2
  exit 1
}

umask 022
share=$work/share
mkdir "$share"
tests/package/contents.sh "$build" "$share/first.deb"

echo "== the same from another folder, without the compiler cache"
clone=$work/a/clone/with/a/longer/path
git clone --quiet --no-hardlinks . "$clone"
git diff --binary HEAD | git -C "$clone" apply --allow-empty --whitespace=nowarn
options=$(sed -n 's/^FLEXARM_WERROR:BOOL=/-DFLEXARM_WERROR=/p' "$build/CMakeCache.txt")
(
  cd "$clone"
  export CCACHE_DISABLE=1
  cmake --preset release -DBUILD_TESTING=OFF "$options"
  cmake --build --preset release
  cpack --preset release
)
cmp "$share/first.deb" "$clone"/build/package/flexarm_*.deb || fail "two builds differ"
# With another umask the files of the package are the same; the archive around them stores it.
(umask 077 && tests/package/contents.sh "$clone/build/release" "$work/umask.deb" >/dev/null)

echo "== lintian"
lintian --fail-on error,warning --tag-display-limit 0 "$share/first.deb"

echo "== in a bare Debian"
next=$work/next
dpkg-deb --raw-extract "$share/first.deb" "$next"
sed -i 's/^Version: .*/&.1/' "$next/DEBIAN/control"
echo "# a later version" >>"$next/etc/flexarm/rig.toml"
(cd "$next" && find usr etc -type f -print0 | xargs -0 md5sum >DEBIAN/md5sums)
dpkg-deb --root-owner-group --build "$next" "$share/next.deb"
tests/clean_root.sh --share "$share" "$(. /etc/os-release && echo "$VERSION_CODENAME")" \
  'tests/package/in_root.sh ../share'
