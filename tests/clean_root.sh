#!/usr/bin/env bash
# Runs a command in a clone of this project inside a bare Debian, as after a new installation:
# mmdebstrap makes it in a temporary folder and removes it at the end. The clone has the last commit
# and the differences of tracked files. Needs root, or unprivileged user namespaces. With --share,
# the folder DIR is copied to ../share before the command, and back after it.
#
# usage: clean_root.sh [--share DIR] RELEASE COMMAND
#   e.g. clean_root.sh trixie './tools/run-hil && ./tools/run-tests --lane release'
set -euo pipefail

share=() share_back=()
if [[ ${1:-} == --share && -d ${2:-} ]]; then
  CLEAN_ROOT_SHARE=$(realpath "$2")
  export CLEAN_ROOT_SHARE
  # shellcheck disable=SC2016
  share=(--customize-hook='cp -r "$CLEAN_ROOT_SHARE" "$1/root/share"')
  # shellcheck disable=SC2016
  share_back=(--customize-hook='cp -r "$1/root/share/." "$CLEAN_ROOT_SHARE"')
  shift 2
fi
if (($# != 2)); then
  sed -n '/^# usage: /,/^set/s/^# //p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi
release=$1
export CLEAN_ROOT_COMMAND=$2
CLEAN_ROOT_SOURCE=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export CLEAN_ROOT_SOURCE

# In mmdebstrap's shell, with the new root as $1. Its output is that of the lane.
# shellcheck disable=SC2016
clone='
git clone --quiet --no-hardlinks "$CLEAN_ROOT_SOURCE" "$1/root/flexarm"
git -C "$CLEAN_ROOT_SOURCE" diff --binary HEAD |
  git -C "$1/root/flexarm" apply --allow-empty --whitespace=nowarn
'
# shellcheck disable=SC2016
run='
chroot "$1" /usr/bin/env -i HOME=/root TERM=dumb PATH=/usr/sbin:/usr/bin:/sbin:/bin \
  bash -c "cd /root/flexarm && $CLEAN_ROOT_COMMAND"
'
mmdebstrap --quiet --variant=minbase --include=ca-certificates,git \
  --customize-hook="$clone" "${share[@]}" --customize-hook="$run" "${share_back[@]}" \
  "$release" /dev/null
